//! Materials, loads, motions and gaps whose squares would overflow are refused with their place before anything is solved: solvers would
//! only see norms that are infinite or vanish, and blame their tolerance.

use super::points::Found;
use crate::error::ContactError;
use crate::scene::{Analysis, Scene};
use signorini_fem_mesh::History;
use signorini_qp::vector;
use std::collections::BTreeSet;

/// Largest force in N, displacement and gap in m. The squares of their products are formed (friction times slip): at most 1e308,
/// so this leaves 28 digits for stiffness and sums.
const MOST: f64 = 1e70;

/// Materials of the regions in use.
pub(crate) fn check_materials(scene: &Scene) -> Result<(), ContactError> {
    for (region, stiffness) in stiffnesses(scene)? {
        if !(1.0 / MOST..=MOST).contains(&stiffness) {
            return Err(ContactError::Stiffness {
                region,
                value: stiffness,
                least: 1.0 / MOST,
                most: MOST,
            });
        }
    }
    Ok(())
}

/// Regions in use and the largest stiffness of each, Pa.
fn stiffnesses(scene: &Scene) -> Result<Vec<(u32, f64)>, ContactError> {
    let regions: BTreeSet<u32> = scene.mesh.regions().iter().copied().collect();
    let bound = |region| Ok((region, scene.materials.get(region)?.bound()));
    regions.into_iter().map(bound).collect()
}

/// The least and the largest stiffness of a region times the extent of the mesh, N/m.
fn springs(scene: &Scene) -> Result<[f64; 2], ContactError> {
    let (low, high) = scene.mesh.extent();
    let extent = (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max);
    let stiffnesses = stiffnesses(scene)?;
    let ends = stiffnesses
        .iter()
        .fold([f64::INFINITY, 0.0], |[a, b], s| [a.min(s.1), b.max(s.1)]);
    Ok(ends.map(|s| s * extent))
}

/// Refuses what is too large; what is not a number is left to others.
fn expect(value: f64, unit: &'static str, place: impl Fn() -> String) -> Result<(), ContactError> {
    if value > MOST {
        return Err(ContactError::TooLarge {
            place: place(),
            value,
            unit,
            most: MOST,
        });
    }
    Ok(())
}

/// The largest size of a history at the levels, and its time.
pub(crate) fn largest_factor(analysis: &Analysis, history: &History) -> (f64, f64) {
    let times = (0..analysis.steps()).filter_map(|level| analysis.time(level));
    times.fold((0.0, 0.0), |worst: (f64, f64), time| {
        let value = history.value(time).abs();
        if value > worst.0 {
            (value, time)
        } else {
            worst
        }
    })
}

/// Motions of supports and obstacles.
pub(crate) fn check_motions(scene: &Scene) -> Result<(), ContactError> {
    for (index, support) in scene.supports.iter().enumerate() {
        if let Some((values, history)) = &support.motion {
            let (factor, time) = largest_factor(&scene.analysis, history);
            let size = vector::max_abs(values.as_flattened());
            let place = || format!("support {index} at time {time} s: its displacement");
            expect(factor * size, "m", place)?;
            let place = || {
                format!("support {index} at time {time} s: its displacement times the stiffness")
            };
            expect(factor * size * springs(scene)?[1], "N", place)?;
        }
    }
    for (index, contact) in scene.contacts.iter().enumerate() {
        if let Some((value, history)) = &contact.motion {
            let (factor, time) = largest_factor(&scene.analysis, history);
            let place = || format!("obstacle {index} at time {time} s: its displacement");
            expect(factor * vector::max_abs(value), "m", place)?;
        }
    }
    Ok(())
}

/// A load, by its largest nodal force with factor one, N.
pub(crate) fn check_load(scene: &Scene, index: usize, size: f64) -> Result<(), ContactError> {
    let (factor, time) = largest_factor(&scene.analysis, &scene.loads[index].history);
    let place = || format!("load {index} at time {time} s: its largest nodal force");
    expect(factor * size, "N", place)?;
    let place =
        || format!("load {index} at time {time} s: its largest nodal force over the stiffness");
    expect(factor * size / springs(scene)?[0], "m", place)
}

/// Gaps at the start, and those that obstacles bring with them at the levels.
pub(crate) fn check_gaps(scene: &Scene, found: &Found) -> Result<(), ContactError> {
    for c in &found.conditions {
        let place = || format!("contact at node {}: the gap", c.node);
        expect(c.gap.abs(), "m", place)?;
        let contact = &scene.contacts[c.surface];
        if contact.carries_field() {
            let times = (0..scene.analysis.steps()).filter_map(|l| scene.analysis.time(l));
            for time in times {
                expect(
                    c.gap_after(scene, &contact.obstacle_at(time))?.abs(),
                    "m",
                    place,
                )?;
            }
        }
    }
    Ok(())
}
