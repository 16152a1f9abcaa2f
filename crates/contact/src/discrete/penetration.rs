//! Contact nodes whose normal displacement is prescribed by supports.
//!
//! They have no contact row, since no contact force can change their displacement. That is right only as long as they stay
//! outside the obstacle, which is known before anything is solved: prescribed displacement and gap are data.

use super::points::ContactPoint;
use super::rounding::rounding;
use super::supports::contact_constraints;
use crate::error::ContactError;
use crate::scene::Scene;
use signorini_fem_mesh::History;
use signorini_tfeti::{NodeSupport, PrescribedPoint, prescribed_points};

/// Depth above this share of the displacement or the gap counts.
const RELATIVE: f64 = 1e-9;

/// Refuses supports that hold contact nodes inside the obstacle, wherever it has moved, at some time level.
pub(crate) fn check_penetration(
    scene: &Scene,
    candidates: &[ContactPoint],
    supports: &[NodeSupport],
    motions: &[History],
) -> Result<(), ContactError> {
    let points = scene.mesh.points();
    let nodes = contact_constraints(scene, candidates.iter());
    let held: Vec<(PrescribedPoint, &ContactPoint)> =
        prescribed_points(&nodes, supports, points.len())?
            .into_iter()
            .map(|point| {
                let candidate = &candidates[point.point];
                (point, candidate)
            })
            .collect();
    if held.is_empty() {
        return Ok(());
    }
    let rounding = rounding(&scene.mesh);
    let times = (0..scene.analysis.steps()).filter_map(|level| scene.analysis.time(level));
    for time in times {
        let factors: Vec<f64> = motions.iter().map(|h| h.value(time)).collect();
        let mut deepest: Option<(f64, u32, f64, f64)> = None;
        for (point, candidate) in &held {
            let contact = &scene.contacts[candidate.surface];
            let gap = candidate.gap_after(scene, &contact.obstacle_at(time))?;
            let displacement: f64 = point
                .normal
                .iter()
                .map(|&(case, value)| factors[case as usize] * value)
                .sum();
            let depth = displacement - gap;
            let allowed = rounding + RELATIVE * gap.abs().max(displacement.abs());
            if depth > allowed && deepest.is_none_or(|d| depth > d.0) {
                deepest = Some((depth, point.node, displacement, gap));
            }
        }
        if let Some((depth, node, displacement, gap)) = deepest {
            return Err(ContactError::SupportInObstacle {
                node,
                depth,
                time,
                displacement,
                gap,
            });
        }
    }
    Ok(())
}
