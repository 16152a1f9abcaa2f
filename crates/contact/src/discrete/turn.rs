//! How far motions of obstacles may turn normals, which stay those of the start.

use super::creases::area_vector;
use super::points::ContactPoint;
use crate::error::ContactError;
use crate::scene::{ContactNormal, Pose, Scene};
use crate::tolerances::TURN;
use signorini_fem_mesh::{Surface, vec3};
use signorini_qp::vector;

/// Refuses motions that turn the normals of obstacles, and gap fields that move far along a curved surface, on which
/// the field and the normals of the nodes part. `own` are the conditions of the contact, `poses` those of its obstacle.
pub(super) fn check_turn(
    scene: &Scene,
    index: usize,
    surface: &Surface,
    own: &[ContactPoint],
    poses: &[Pose],
) -> Result<(), ContactError> {
    let contact = &scene.contacts[index];
    match (&contact.shape, contact.normal) {
        (Some(_), ContactNormal::Obstacle) => return check_shape(scene, index, own, poses),
        // measured along the normals of the nodes at each step
        (Some(_), _) => return Ok(()),
        (None, normal) => {
            let along_body = normal == ContactNormal::Body && contact.carries_field();
            if !along_body && contact.rotation.is_none() {
                return Ok(());
            }
        }
    }
    // a motion in one direction is worst where it is largest
    let mut poses: Vec<&Pose> = poses.iter().collect();
    if contact.rotation.is_none() {
        let size = |pose: &&Pose| vec3::norm(pose.small(&[0.0; 3]));
        let largest = poses.iter().copied().max_by(|a, b| size(a).total_cmp(&size(b)));
        poses = largest.into_iter().collect();
    }
    let mut worst = (0.0, 0);
    for (pose, triangle) in poses
        .iter()
        .flat_map(|p| surface.triangles().iter().map(move |t| (p, t)))
    {
        let flat = area_vector(&scene.mesh, surface, triangle);
        let nodes = triangle.map(|n| surface.nodes()[n as usize]);
        let places = nodes.map(|n| scene.mesh.points()[n as usize]);
        let edge = |a: usize| {
            let [from, to] = [1, 2].map(|k| places[(a + k) % 3]);
            vec3::sub(to, from)
        };
        // of a node in a crease the side that the facet belongs to
        let along = |node: u32| {
            let from = own.partition_point(|c| c.node() < node);
            let sides = own[from..].iter().take_while(|c| c.node() == node);
            let facing = |c: &&ContactPoint| c.frame.normal_part(flat);
            let side = sides.max_by(|a, b| facing(a).total_cmp(&facing(b)));
            side.map_or(0.0, |c| c.frame.normal_part(pose.small(&c.position)))
        };
        // length of the gradient of `n . small` on the facet
        let mut sum = [0.0; 3];
        for (a, &node) in nodes.iter().enumerate() {
            vector::axpy(along(node), &edge(a), &mut sum);
        }
        let turn = vector::norm(&sum) / (2.0 * vec3::norm(flat));
        if turn > worst.0 {
            worst = (turn, nodes[0]);
        }
    }
    if worst.0 > TURN {
        return Err(ContactError::MovedField {
            contact: index,
            node: worst.1,
            turn: worst.0.to_degrees(),
            most: TURN.to_degrees(),
        });
    }
    Ok(())
}

/// Refuses motions that turn the obstacle's normal at a node.
fn check_shape(scene: &Scene, index: usize, own: &[ContactPoint], poses: &[Pose]) -> Result<(), ContactError> {
    let mut worst = (0.0, 0, 0.0);
    for (pose, &time) in poses.iter().zip(scene.analysis.times()) {
        for point in own {
            let turn = turned(scene, point, pose, &point.position);
            if turn > worst.0 {
                worst = (turn, point.node(), time);
            }
        }
    }
    let (turn, node, time) = worst;
    if turn > TURN {
        return Err(ContactError::TurnedNormal {
            contact: index,
            node,
            time,
            turn: turn.to_degrees(),
            most: TURN.to_degrees(),
        });
    }
    Ok(())
}

/// The angle between the normal of a point and that of its obstacle at a place, radians; zero without a shape.
pub(crate) fn turned(scene: &Scene, point: &ContactPoint, pose: &Pose, place: &[f64; 3]) -> f64 {
    let Some(shape) = &scene.contacts[point.surface].shape else {
        return 0.0;
    };
    let (_, gradient) = shape.distance(pose.origin(place));
    let now = pose.forth(&gradient);
    let normal = point.frame.normal;
    let sine = vec3::norm(vec3::cross(now, normal));
    sine.atan2(-vec3::dot(now, normal))
}
