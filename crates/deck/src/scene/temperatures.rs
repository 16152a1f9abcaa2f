//! `*TEMPERATURE` of all steps as eigenstrains: what nodes are warmer than at first, times the coefficients of expansion
//! of each section.

use std::collections::BTreeMap;

use signorini_contact::Load;
use signorini_fem_mesh::Eigenstrain;

use super::faces::Known;
use super::history::{Histories, Track};
use crate::error::{DeckError, Word};
use crate::model::{Given, Ignored};

/// The loads, each with the first word that asks for it.
pub(super) fn temperatures(known: Known, ignored: &mut Vec<Ignored>) -> Result<Vec<(Load, Word)>, DeckError> {
    let Known { model, sets, raw, .. } = known;
    let nodes = raw.node_labels.len();
    let mut first = vec![0.0; nodes];
    for line in &model.initial {
        for node in sets.nodes.find(&line.target, &line.word)? {
            if let Some(node) = raw.in_mesh(node) {
                first[node as usize] = line.given.value;
            }
        }
    }
    let mut tracks: BTreeMap<u32, Track> = BTreeMap::new();
    let lines = model.steps.iter().flat_map(|step| &step.temperatures.lines);
    let absolute = lines.into_iter().any(|line| line.given.amplitude.is_some());
    let mut order = 0;
    for (step, given) in model.steps.iter().enumerate() {
        if given.temperatures.removes() {
            tracks.values_mut().for_each(|track| track.remove(step));
        }
        for line in &given.temperatures.lines {
            order += 1;
            for node in sets.nodes.find(&line.target, &line.word)? {
                let Some(node) = raw.in_mesh(node) else { continue };
                let initial = first[node as usize];
                // an amplitude multiplies the temperature, not its rise
                let (value, base) = if absolute {
                    (line.given.value, initial)
                } else {
                    (line.given.value - initial, 0.0)
                };
                let track = tracks
                    .entry(node)
                    .or_insert_with(|| Track::new(order, &line.word).above(base));
                track.set(step, Given { value, ..line.given });
            }
        }
    }
    let mut histories = Histories::default();
    let mut groups: BTreeMap<usize, (&Track, Vec<f64>)> = BTreeMap::new();
    for (&node, track) in &tracks {
        if let Some((rise, history)) = histories.add(known.timeline, track)? {
            let group = groups.entry(history).or_insert_with(|| (track, vec![0.0; nodes]));
            group.1[node as usize] = rise;
            if track.order < group.0.order {
                group.0 = track;
            }
        }
    }
    let mut laws = Vec::with_capacity(model.sections.len());
    for section in &model.sections {
        laws.push(model.material(section)?.expansion.as_ref().map(|law| law.1));
    }
    if laws.iter().all(Option::is_none) {
        let why = "no material of a section has *EXPANSION";
        ignored.extend(groups.values().map(|(track, _)| Ignored::new(&track.word, why)));
    }
    let mut out = Vec::new();
    for (history, (track, rises)) in groups {
        let warm = |[x, y, z]: [f64; 3]| Eigenstrain::new([x, y, z, 0.0, 0.0, 0.0]).with_factors(rises.clone());
        let strains: Vec<Eigenstrain> = match laws[..] {
            [Some(law), ref others @ ..] if others.iter().all(|other| *other == Some(law)) => vec![warm(law)],
            _ => {
                let each = (0..).zip(&laws);
                each.filter_map(|(region, law)| Some(warm((*law)?).in_region(region)))
                    .collect()
            }
        };
        let load = |strain| Load::eigenstrain(strain).with_history(histories.at(history));
        out.extend(strains.into_iter().map(|strain| (load(strain), track.word.clone())));
    }
    Ok(out)
}
