//! Contact nodes whose normal displacement is prescribed by supports.
//!
//! They have no contact row, since no contact force can change their displacement. That is right only as long as they
//! stay outside the obstacle, which is known before anything is solved: prescribed displacement and gap are data.

use super::points::ContactPoint;
use super::supports::Supports;
use crate::error::ContactError;
use crate::scene::{Pose, Scene};
use crate::tolerances::{DEPTH, LEFT_DEPTH};
use signorini_fem_mesh::vec3::norm;
use signorini_tfeti::internal::PrescribedPoint;

/// Refuses supports that hold contact nodes inside the obstacle, wherever it has moved, at some step of the stage.
pub(super) fn check_penetration(
    scene: &Scene,
    points: &[ContactPoint],
    prescribed: &[PrescribedPoint],
    (supports, poses): (&Supports, &[Vec<Pose>]),
    rounding: f64,
) -> Result<(), ContactError> {
    if prescribed.is_empty() {
        return Ok(());
    }
    let rest = Pose::default();
    let slack: Vec<Option<f64>> = prescribed
        .iter()
        .map(|p| slack(scene, &points[p.point], supports))
        .collect();
    let steps = scene.stage_steps();
    for (step, &time) in scene
        .analysis
        .times()
        .iter()
        .enumerate()
        .skip(steps.start)
        .take(steps.len())
    {
        let factors: Vec<f64> = supports.motions.iter().map(|h| h.value(time)).collect();
        let mut deepest: Option<(f64, u32, f64, f64)> = None;
        for (fixed, slack) in prescribed.iter().zip(&slack) {
            // where an earlier step will leave it nobody knows
            let Some(slack) = slack else {
                continue;
            };
            let point = &points[fixed.point];
            let gap = point.gap_after(scene, poses[point.surface].get(step).unwrap_or(&rest))?;
            let along = fixed.normal.iter();
            let displacement: f64 = along.map(|&(case, value)| factors[case as usize] * value).sum();
            let depth = displacement - gap;
            let allowed = rounding + slack + DEPTH * gap.abs().max(displacement.abs());
            if depth > allowed && deepest.is_none_or(|d| depth > d.0) {
                deepest = Some((depth, fixed.node, displacement, gap));
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

/// How deep a point may be because an earlier step left it there, m; `None` where that step is not solved yet.
fn slack(scene: &Scene, point: &ContactPoint, supports: &Supports) -> Option<f64> {
    let nodes = point.sides.nodes();
    let held = nodes.flat_map(|(node, _)| supports.directions.get(&node).into_iter().flatten());
    let started = held.map(|h| h.support).filter(|&support| scene.has_started(support));
    started
        .map(|support| &scene.supports[support].left)
        .try_fold(0.0, |slack: f64, left| {
            let largest = left.iter().map(|u| norm(*u)).reduce(f64::max)?;
            Some(slack.max(LEFT_DEPTH * largest))
        })
}
