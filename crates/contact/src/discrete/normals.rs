//! Directions of contact that the scene gives: one for all nodes, or those of an obstacle.

use crate::error::ContactError;
use crate::scene::{Contact, ContactNormal, Gap, Obstacle, Pose, Scene, Seen};
use crate::tolerances::{ALONG, AXIS, DISTANCE_WAY, FACING, GRADIENT, SAME_NORMAL};
use signorini_fem_mesh::vec3::{cross, dot, norm, scale, sub, unit};
use signorini_fem_mesh::{Surface, SurfaceFrame};

/// Whether directions are not all one.
pub(super) fn differ(mut normals: impl Iterator<Item = [f64; 3]>) -> bool {
    let first = normals.next().unwrap_or_default();
    normals.any(|n| dot(n, first) <= SAME_NORMAL)
}

/// The one frame of all nodes of a contact with a fixed direction.
pub(super) fn fixed_frame(
    index: usize,
    contact: &Contact,
    surface: &Surface,
) -> Result<Option<SurfaceFrame>, ContactError> {
    let ContactNormal::Fixed(normal) = contact.normal else {
        return Ok(None);
    };
    let frame = SurfaceFrame::from_normal(normal).ok_or(ContactError::ObstacleNormal { contact: index, normal })?;
    check_side(index, surface, normal, |_| Some(frame))?;
    Ok(Some(frame))
}

/// The frame with its first tangent along the axis of friction, if the contact has one.
pub(super) fn along_axis(
    index: usize,
    contact: &Contact,
    node: u32,
    frame: SurfaceFrame,
) -> Result<SurfaceFrame, ContactError> {
    let Some((axis, _)) = contact.friction_axis else {
        return Ok(frame);
    };
    let normal = frame.normal;
    let first = sub(axis, scale(dot(axis, normal), normal));
    let length = norm(first);
    if length.is_nan() || length <= AXIS * norm(axis) {
        let contact = index;
        return Err(ContactError::FrictionAxis { contact, node, axis });
    }
    // twice, against rounding where the axis is nearly normal
    let first = scale(1.0 / length, first);
    let first = unit(sub(first, scale(dot(first, normal), normal)));
    let tangents = [first, cross(first, normal)];
    Ok(SurfaceFrame { normal, tangents })
}

/// Refuses directions that point out of the body nowhere; `normal` is told.
fn check_side(
    index: usize,
    surface: &Surface,
    normal: [f64; 3],
    frame: impl Fn(usize) -> Option<SurfaceFrame>,
) -> Result<(), ContactError> {
    let mut own = surface.frames().iter().enumerate();
    if own.any(|(local, own)| frame(local).is_some_and(|f| f.normal_part(own.normal) > ALONG)) {
        return Ok(());
    }
    Err(ContactError::ObstacleSide {
        contact: index,
        direction: normal,
        nodes: surface.nodes().len(),
    })
}

fn is_unit(gradient: [f64; 3]) -> bool {
    (norm(gradient) - 1.0).abs() <= GRADIENT
}

/// The obstacle of a contact whose gap is measured by a function of the user.
fn user_distance(contact: &Contact) -> Option<&Obstacle> {
    let measured = |shape: &&Obstacle| shape.is_own() && matches!(contact.gap, Gap::Obstacle);
    contact.shape.as_ref().filter(measured)
}

/// Refuses what is measured as a distance and is none, by how it changes over a way.
fn check_distance(
    scene: &Scene,
    contact: usize,
    (node, position): (u32, [f64; 3]),
    found: (f64, [f64; 3]),
    way: f64,
) -> Result<(), ContactError> {
    match user_distance(&scene.contacts[contact]).and_then(|shape| shape.steep(position, found, way)) {
        Some(slope) => Err(ContactError::ObstacleDistance {
            contact,
            node,
            position,
            slope,
        }),
        None => Ok(()),
    }
}

/// The same of all nodes that face an obstacle whose distance is measured along other directions than its own.
fn check_along(
    scene: &Scene,
    index: usize,
    surface: &Surface,
    place: impl Fn(usize) -> [f64; 3],
    way: f64,
) -> Result<(), ContactError> {
    let contact = &scene.contacts[index];
    let Some(shape) = user_distance(contact) else {
        return Ok(());
    };
    for (local, (&node, own)) in surface.nodes().iter().zip(surface.frames()).enumerate() {
        let position = place(local);
        let found = shape.distance(position);
        let along = match contact.normal {
            ContactNormal::Fixed(normal) => unit(normal),
            _ => own.normal,
        };
        if dot(found.1, along) < -FACING && is_unit(found.1) {
            check_distance(scene, index, (node, position), found, way)?;
        }
    }
    Ok(())
}

/// The frame at each node of a contact with the normals of its obstacle, none where the body does not face it or the
/// side of the obstacle that it faces has ended, in all `poses`; empty for all others. `place` is where the force of a
/// node acts.
pub(super) fn shape_frames(
    scene: &Scene,
    index: usize,
    surface: &Surface,
    place: impl Fn(usize) -> [f64; 3],
    poses: &[Pose],
) -> Result<Vec<Option<SurfaceFrame>>, ContactError> {
    let contact = &scene.contacts[index];
    let Some(shape) = &contact.shape else {
        return Ok(Vec::new());
    };
    let way = DISTANCE_WAY * surface.total_area().sqrt();
    if contact.normal != ContactNormal::Obstacle {
        check_along(scene, index, surface, place, way)?;
        return Ok(Vec::new());
    }
    let frame = |(local, (&node, own)): (usize, (&u32, &SurfaceFrame))| {
        let position = place(local);
        let seen = shape.see(position, own.normal);
        let Seen { distance, gradient, .. } = seen;
        if !distance.is_finite() {
            let (contact, value) = (index, distance);
            return Err(ContactError::Gap {
                contact,
                node,
                position,
                value,
            });
        }
        let frame = SurfaceFrame::from_normal(gradient.map(|c| -c)).filter(|_| is_unit(gradient));
        let frame = frame.ok_or(ContactError::ObstacleGradient {
            contact: index,
            node,
            position,
            gradient,
        })?;
        let after = |pose: &Pose| shape.see(pose.origin(&position), pose.back(&own.normal)).has_ended();
        let is_never_met = seen.has_ended() && poses.iter().all(after);
        if frame.normal_part(own.normal) <= FACING || is_never_met {
            return Ok(None);
        }
        check_distance(scene, index, (node, position), (distance, gradient), way)?;
        Ok(Some(frame))
    };
    let nodes = surface.nodes().iter().zip(surface.frames());
    let frames: Vec<Option<SurfaceFrame>> = nodes.enumerate().map(frame).collect::<Result<_, _>>()?;
    let first = (surface.nodes().first()).map_or([0.0; 3], |_| shape.distance(place(0)).1.map(|c| -c));
    check_side(index, surface, first, |local| frames[local])?;
    Ok(frames)
}
