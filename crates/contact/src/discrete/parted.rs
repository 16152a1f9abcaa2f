//! Tied sides that supports hold on both sides.
//!
//! No row ties them there, so that they move as supports say. That is right only where these say what the tie says,
//! which is known before anything is solved.

use super::points::ContactPoint;
use super::supports::Supports;
use crate::error::ContactError;
use crate::scene::Scene;
use crate::tolerances::PARTED;
use crate::vec3::dot;
use signorini_tfeti::ContactConstraint;
use signorini_tfeti::internal::{FixedDirection, HeldTie, held_ties};

/// Refuses supports that move tied sides apart, or hold those that are to move, at some step of the stage. `ties` are
/// the last of the constraints.
pub(super) fn check_parted(
    scene: &Scene,
    ties: &[ContactPoint],
    constraints: &[ContactConstraint],
    supports: &Supports,
    rounding: f64,
) -> Result<(), ContactError> {
    let first = constraints.len() - ties.len();
    for HeldTie {
        point,
        direction,
        values,
        ..
    } in held_ties(constraints, &supports.merged)
    {
        let (Some(tie), Some(values)) = (point.checked_sub(first).and_then(|k| ties.get(k)), values) else {
            continue;
        };
        let held = tie.sides.nodes().flat_map(|(node, _)| supports.merged.directions(node));
        let held: Vec<&FixedDirection> = held.collect();
        let along = |held: &FixedDirection| dot(&held.direction, &direction).abs();
        // couplings say how sides move that are relative; where an earlier step leaves them is not said
        let has_started = |held: &&FixedDirection| along(held) > PARTED && scene.has_started(held.support);
        if constraints[point].relative.is_some() || held.iter().any(has_started) {
            continue;
        }
        let first_most = held.iter().min_by(|a, b| along(b).total_cmp(&along(a)));
        let support = first_most.map_or(0, |held| held.support);
        for &time in &scene.analysis.times()[scene.stage_steps()] {
            let prescribed = values
                .iter()
                .map(|&(case, value)| supports.motions[case as usize].value(time) * value);
            let ways = [
                prescribed.sum::<f64>(),
                tie.sides.sign() * dot(&scene.contacts[tie.surface].shift(time), &direction),
            ];
            let apart = ways[0] - ways[1];
            if apart.abs() > rounding + PARTED * ways[0].abs().max(ways[1].abs()) {
                let (contact, node, position) = tie.at();
                return Err(ContactError::PartedTie {
                    support,
                    contact,
                    node,
                    position,
                    apart,
                    along: direction,
                    time,
                });
            }
        }
    }
    Ok(())
}
