//! `*TEMPERATURE` of all steps as eigenstrains: what nodes are warmer than at first, times the coefficients of
//! expansion of each section.

use std::collections::BTreeMap;

use signorini_contact::Load;
use signorini_fem_mesh::Eigenstrain;
use signorini_fem_mesh::vec3::Vec3;

use super::history::{Histories, Track};
use super::known::Known;
use crate::error::{DeckError, Word};
use crate::model::{Given, Ignored, Model, Section};

/// Rises by history: the first track that asks for them, and nodes.
#[derive(Default)]
struct Fields {
    histories: Histories,
    groups: BTreeMap<usize, (Track, Vec<(u32, f64)>)>,
}

impl Fields {
    fn new(known: Known, tracks: impl Iterator<Item = (u32, Track)>) -> Result<Self, DeckError> {
        let mut fields = Self::default();
        for (node, track) in tracks {
            let Some((rise, history)) = fields.histories.add(known.timeline, &track)? else {
                continue;
            };
            let group = fields.groups.entry(history);
            let (first, nodes) = group.or_insert_with(|| (track.clone(), Vec::new()));
            nodes.push((node, rise));
            if track.order < first.order {
                *first = track;
            }
        }
        Ok(fields)
    }
}

/// What each node is warmer than at first, step by step.
fn tracks(Known { model, sets, raw, .. }: Known) -> Result<BTreeMap<u32, Track>, DeckError> {
    let mut first = vec![0.0; raw.node_labels.len()];
    for line in &model.initial {
        for node in sets.nodes.find(&line.target, &line.word)? {
            if let Some(node) = raw.in_mesh(node) {
                first[node as usize] = line.given.value;
            }
        }
    }
    let mut tracks: BTreeMap<u32, Track> = BTreeMap::new();
    let mut lines = model.steps.iter().flat_map(|step| &step.temperatures.lines);
    let absolute = lines.any(|line| line.given.amplitude.is_some());
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
                let (value, base) =
                    if absolute { (line.given.value, initial) } else { (line.given.value - initial, 0.0) };
                let track = tracks
                    .entry(node)
                    .or_insert_with(|| Track::new(order, &line.word).above(base));
                track.set(step, Given { value, ..line.given });
            }
        }
    }
    Ok(tracks)
}

/// The strain of each section by a rise of one; `None` without *EXPANSION.
fn expansions(model: &Model) -> Result<Vec<Option<[f64; 6]>>, DeckError> {
    let of_section = |section: &Section| {
        let Some((_, law @ [x, y, z])) = model.material(section)?.expansion else {
            return Ok(None);
        };
        let along = |axes: [Vec3; 3]| {
            let of = |p: usize, q: usize| (0..3).map(|k| law[k] * axes[k][p] * axes[k][q]).sum::<f64>();
            let [shear_yz, shear_xz, shear_xy] = [(1, 2), (0, 2), (0, 1)].map(|(p, q)| 2.0 * of(p, q));
            [of(0, 0), of(1, 1), of(2, 2), shear_yz, shear_xz, shear_xy]
        };
        let axes = model.axes(section, x == y && y == z)?;
        Ok(Some(axes.map_or([x, y, z, 0.0, 0.0, 0.0], along)))
    };
    model.sections.iter().map(of_section).collect()
}

/// The loads, each with the first word that asks for it.
pub(super) fn temperatures(known: Known, ignored: &mut Vec<Ignored>) -> Result<Vec<(Load, Word)>, DeckError> {
    let Known { model, raw, .. } = known;
    let tracks = tracks(known)?;
    let mut fields = Fields::new(known, tracks.iter().map(|(node, track)| (*node, track.clone())))?;
    // nodes that do not change in proportion would have a load each; what the steps give makes a few for all
    if fields.groups.len() > model.steps.len() + 1 {
        let all = tracks.iter();
        let parts = all.flat_map(|(node, track)| track.parts().map(move |part| (*node, part)));
        fields = Fields::new(known, parts)?;
    }
    let laws = expansions(model)?;
    if laws.iter().all(Option::is_none) {
        let why = "no material of a section has *EXPANSION";
        ignored.extend(fields.groups.values().map(|(track, _)| Ignored::new(&track.word, why)));
    }
    let (mut out, mut told) = (Vec::new(), None);
    for (history, (track, nodes_of)) in &fields.groups {
        let mut rises = vec![0.0; raw.node_labels.len()];
        for (node, rise) in nodes_of {
            raw.with_copies(*node).for_each(|node| rises[node as usize] += rise);
        }
        if told.is_none() && raw.is_bent(&rises) {
            told = Some(&track.word);
        }
        let warm = |strain: [f64; 6]| Eigenstrain::new(strain).with_factors(rises.clone());
        let strains: Vec<Eigenstrain> = match laws[..] {
            [Some(law), ref others @ ..] if others.iter().all(|other| *other == Some(law)) => vec![warm(law)],
            _ => {
                let each = (0..).zip(&laws);
                each.filter_map(|(region, law)| Some(warm((*law)?).in_region(region)))
                    .collect()
            }
        };
        let load = |strain| Load::eigenstrain(strain).with_history(fields.histories.at(*history));
        out.extend(strains.into_iter().map(|strain| (load(strain), track.word.clone())));
    }
    let why = "temperatures on edges that are not the mean of those at their ends: they are linear along edges here, as in \
        C3D10T";
    ignored.extend(told.map(|word| Ignored::new(word, why)));
    Ok(out)
}
