//! Contact nodes whose normal displacement is prescribed by supports.
//!
//! They have no contact row, since no contact force can change their displacement. That is right only as long as they
//! stay outside the obstacle, which is known before anything is solved: prescribed displacement and gap are data.

use super::points::ContactPoint;
use super::supports::Supports;
use crate::error::ContactError;
use crate::scene::{Pose, Scene};
use crate::tolerances::DEPTH;
use signorini_qp::vector;
use signorini_tfeti::internal::{FixedDirection, PrescribedPoint};

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
    let slack = |p| slack(scene, points, p, (supports, poses));
    let slack: Vec<Option<f64>> = prescribed.iter().map(slack).collect::<Result<_, _>>()?;
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
        let mut deepest: Option<(f64, &PrescribedPoint, f64, f64)> = None;
        for (fixed, slack) in prescribed.iter().zip(&slack) {
            // where an earlier step will leave it nobody knows
            let Some(slack) = slack else {
                continue;
            };
            let point = &points[fixed.point];
            let gap = point.gap_after(scene, poses[point.surface].get(step).unwrap_or(&rest))?;
            let displacement = displacement(fixed, |case| factors[case]);
            let depth = displacement - gap;
            let allowed = rounding + slack + DEPTH * gap.abs().max(displacement.abs());
            if depth > allowed && deepest.is_none_or(|d| depth > d.0) {
                deepest = Some((depth, fixed, displacement, gap));
            }
        }
        if let Some((depth, fixed, displacement, gap)) = deepest {
            let (contact, _, position) = points[fixed.point].at();
            let normal = points[fixed.point].frame.normal;
            // of several the one that holds most of the normal
            let along = |held: &&FixedDirection| vector::dot(&held.direction, &normal).abs();
            let held = supports.merged.directions(fixed.node).iter();
            let most = held.max_by(|a, b| along(a).total_cmp(&along(b)));
            return Err(ContactError::SupportInObstacle {
                support: most.map_or(0, |held| held.support),
                contact,
                node: fixed.node,
                position,
                depth,
                time,
                displacement,
                gap,
            });
        }
    }
    Ok(())
}

/// How deep a point is because an earlier step left it there, m, as far as solvers do, or as the last step had it: with
/// compliance a point is deep, and so may be a mean of which supports held a good part. `None` where that step is not
/// solved yet.
fn slack(
    scene: &Scene,
    points: &[ContactPoint],
    fixed: &PrescribedPoint,
    (supports, poses): (&Supports, &[Vec<Pose>]),
) -> Result<Option<f64>, ContactError> {
    let point = &points[fixed.point];
    let nodes = point.sides.nodes();
    let held = nodes.flat_map(|(node, _)| supports.merged.directions(node));
    let started = held.map(|h| h.support).filter(|&support| scene.has_started(support));
    let mut most = 0.0_f64;
    for support in started {
        if scene.supports[support].left.is_empty() {
            return Ok(None);
        }
        let off = supports.nodes[support].motions.iter().map(|motion| motion.off);
        most = off.fold(most, f64::max);
    }
    if most == 0.0 {
        return Ok(Some(0.0));
    }
    let before = scene.stage_steps().start.checked_sub(1);
    let pose = before.and_then(|step| poses[point.surface].get(step));
    let gap = point.gap_after(scene, pose.unwrap_or(&Pose::default()))?;
    let is_left = |case: usize| supports.left.contains(&case);
    let left = displacement(fixed, |case| f64::from(u8::from(is_left(case)))) - gap;
    let slack = left.clamp(0.0, most);
    // as deep as it was, with others that moved then, if the contact acted: that step was judged
    let time = before.and_then(|step| scene.analysis.time(step));
    let acted = time.filter(|time| scene.contacts[point.surface].span.has(*time));
    let was = acted.map(|time| {
        let factor = |case| if is_left(case) { 1.0 } else { supports.motions[case].value(time) };
        displacement(fixed, factor) - gap
    });
    Ok(Some(was.map_or(slack, |was| was.max(slack))))
}

/// How far a point is displaced along its normal, m, where the motions have these factors.
fn displacement(fixed: &PrescribedPoint, factor: impl Fn(usize) -> f64) -> f64 {
    let along = fixed.normal.iter();
    along.map(|&(case, value)| factor(case as usize) * value).sum()
}
