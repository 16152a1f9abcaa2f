//! Loads, motions and gaps whose squares would overflow are refused with their place before anything is solved: solvers would
//! only see norms that are infinite, and blame their tolerance.

use crate::candidates::Found;
use crate::clock::Analysis;
use crate::error::ContactError;
use crate::scene::Scene;
use signorini_fem_mesh::{History, TetMesh};
use signorini_qp::vector;
use signorini_tfeti::LoadResponse;

/// Largest force in N, displacement and gap in m. The squares of their products are formed (friction times slip): at most 1e308,
/// so this leaves 28 digits for stiffness and sums.
const MOST: f64 = 1e70;

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
pub(crate) fn largest(analysis: &Analysis, history: &History) -> (f64, f64) {
    let times = (0..analysis.levels()).filter_map(|level| analysis.time(level));
    times.fold((0.0, 0.0), |worst: (f64, f64), time| {
        let value = history.value(time).abs();
        if value > worst.0 {
            (value, time)
        } else {
            worst
        }
    })
}

/// Distances below this share of the largest coordinate are rounding errors of what was computed from coordinates.
const ROUNDING: f64 = 1e-12;

/// What of a distance between points of a mesh may be rounding, m.
pub(crate) fn rounding(mesh: &TetMesh) -> f64 {
    let largest = |m: f64, v: &f64| m.max(v.abs());
    ROUNDING * mesh.points().iter().flatten().fold(0.0, largest)
}

/// Motions of supports and obstacles.
pub(crate) fn check_motions(scene: &Scene) -> Result<(), ContactError> {
    for (index, support) in scene.supports.iter().enumerate() {
        if let Some((values, history)) = &support.motion {
            let (factor, time) = largest(&scene.analysis, history);
            let size = vector::max_abs(values.as_flattened());
            let place = || format!("support {index} at time {time} s: its displacement");
            expect(factor * size, "m", place)?;
        }
    }
    for (index, contact) in scene.contacts.iter().enumerate() {
        if let Some((value, history)) = &contact.motion {
            let (factor, time) = largest(&scene.analysis, history);
            let place = || format!("obstacle {index} at time {time} s: its displacement");
            expect(factor * vector::max_abs(value), "m", place)?;
        }
    }
    Ok(())
}

/// Loads, by their nodal forces.
pub(crate) fn check_loads(scene: &Scene, loads: &[LoadResponse]) -> Result<(), ContactError> {
    for (index, (load, response)) in scene.loads.iter().zip(loads).enumerate() {
        let (factor, time) = largest(&scene.analysis, &load.history);
        let size = vector::max_abs(&response.force);
        let place = || format!("load {index} at time {time} s: its largest nodal force");
        expect(factor * size, "N", place)?;
    }
    Ok(())
}

/// Gaps at the start, and those that obstacles bring with them at the levels.
pub(crate) fn check_gaps(scene: &Scene, found: &Found) -> Result<(), ContactError> {
    for c in &found.conditions {
        let place = || format!("contact at node {}: the gap", c.node);
        expect(c.gap.abs(), "m", place)?;
        let contact = &scene.contacts[c.surface];
        if contact.carries_field() {
            let times = (0..scene.analysis.levels()).filter_map(|l| scene.analysis.time(l));
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
