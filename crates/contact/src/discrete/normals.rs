//! Directions of contact that the scene gives: one for all nodes, or those of an obstacle.

use crate::error::ContactError;
use crate::scene::{Contact, ContactNormal};
use crate::tolerances::{ALONG, GRADIENT};
use signorini_fem_mesh::vec3::norm;
use signorini_fem_mesh::{Surface, SurfaceFrame, TetMesh};

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
    check_side(index, surface, normal, |_| frame)?;
    Ok(Some(frame))
}

/// Refuses directions that point out of the body nowhere; `normal` is told.
fn check_side(
    index: usize,
    surface: &Surface,
    normal: [f64; 3],
    frame: impl Fn(usize) -> SurfaceFrame,
) -> Result<(), ContactError> {
    let mut own = surface.frames().iter().enumerate();
    if own.any(|(local, own)| frame(local).normal_part(own.normal) > ALONG) {
        return Ok(());
    }
    Err(ContactError::ObstacleSide {
        contact: index,
        direction: normal,
        nodes: surface.nodes().len(),
    })
}

/// The frame at each node of a contact with the normals of its obstacle; empty for all others.
pub(super) fn shape_frames(
    mesh: &TetMesh,
    index: usize,
    contact: &Contact,
    surface: &Surface,
) -> Result<Vec<SurfaceFrame>, ContactError> {
    let (Some(shape), ContactNormal::Obstacle) = (contact.shape(), contact.normal) else {
        return Ok(Vec::new());
    };
    let frame = |&node: &u32| {
        let position = mesh.points()[node as usize];
        let (distance, gradient) = shape.distance(position);
        if !distance.is_finite() {
            let (contact, value) = (index, distance);
            return Err(ContactError::Gap {
                contact,
                node,
                position,
                value,
            });
        }
        let is_unit = (norm(gradient) - 1.0).abs() <= GRADIENT;
        let frame = SurfaceFrame::from_normal(gradient.map(|c| -c)).filter(|_| is_unit);
        frame.ok_or(ContactError::ObstacleGradient {
            contact: index,
            node,
            position,
            gradient,
        })
    };
    let frames: Vec<SurfaceFrame> = surface.nodes().iter().map(frame).collect::<Result<_, _>>()?;
    let first = frames.first().map_or([0.0; 3], |f| f.normal);
    check_side(index, surface, first, |local| frames[local])?;
    Ok(frames)
}
