//! How far motions of obstacles may turn normals, which stay those of the start.

use super::creases::area_vector;
use super::points::ContactPoint;
use crate::error::ContactError;
use crate::scene::{ContactNormal, Pose, Scene, Seen};
use crate::tolerances::{FACING, TURN};
use signorini_fem_mesh::{Surface, vec3};
use signorini_qp::vector;

/// Refuses motions that turn the normals of obstacles, and gap fields that move far along a curved surface, on which
/// the field and the normals of the nodes part. `own` are the conditions of the contact, `poses` those of its obstacle
/// while it acts, with the times, s.
pub(super) fn check_turn(
    scene: &Scene,
    index: usize,
    surface: &Surface,
    own: &[ContactPoint],
    poses: &[(&Pose, f64)],
) -> Result<(), ContactError> {
    let contact = &scene.contacts[index];
    match (&contact.shape, contact.normal) {
        (Some(_), ContactNormal::Obstacle) => return check_shape(scene, (index, surface), own, poses),
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
    let mut poses: Vec<&Pose> = poses.iter().map(|(pose, _)| *pose).collect();
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

/// Refuses motions that turn the obstacle's normal at a node, of those without a condition such as bring it there.
fn check_shape(
    scene: &Scene,
    (index, surface): (usize, &Surface),
    own: &[ContactPoint],
    poses: &[(&Pose, f64)],
) -> Result<(), ContactError> {
    let mut worst = (0.0, 0, 0.0);
    let beside: Vec<_> = beside(surface, own).collect();
    for &(pose, time) in poses {
        let met = own
            .iter()
            .map(|point| (point.node(), turned(scene, point, pose, &point.centre)));
        let brought = beside.iter().map(|&(node, normal)| {
            let place = &scene.mesh.points()[node as usize];
            (node, turned_to(scene, (index, node, normal), pose, place))
        });
        for (node, turn) in met.chain(brought) {
            if turn > worst.0 {
                worst = (turn, node, time);
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

/// The nodes of a surface that have none of its conditions, with the normals of the body.
pub(crate) fn beside(surface: &Surface, own: &[ContactPoint]) -> impl Iterator<Item = (u32, [f64; 3])> {
    let nodes = surface.nodes().iter().zip(surface.frames());
    let without = nodes.filter(|(node, _)| own.binary_search_by_key(*node, ContactPoint::node).is_err());
    without.map(|(&node, frame)| (node, frame.normal))
}

/// The angle between the normal of a point and that of its obstacle at a place, radians; zero without a shape.
pub(crate) fn turned(scene: &Scene, point: &ContactPoint, pose: &Pose, place: &[f64; 3]) -> f64 {
    let normal = point.frame.normal;
    let now = see(scene, point.surface, pose, place, &normal);
    now.map_or(0.0, |now| angle(now.gradient, normal.map(|c| -c)))
}

/// The same of a node of a contact that does not face the obstacle, with the normal of the body: by how much that of
/// the obstacle has turned where it does; zero elsewhere.
pub(crate) fn turned_to(
    scene: &Scene,
    (contact, node, normal): (usize, u32, [f64; 3]),
    pose: &Pose,
    place: &[f64; 3],
) -> f64 {
    let faces = |now: &Seen| !now.has_ended() && vec3::dot(now.gradient, normal) < -FACING;
    let now = see(scene, contact, pose, place, &normal).filter(faces);
    let (Some(shape), Some(now)) = (&scene.contacts[contact].shape, now) else {
        return 0.0;
    };
    let start = scene.mesh.points()[node as usize];
    let first = shape.see(start, normal);
    // where a side has ended it has no direction
    let first = if first.has_ended() { shape.distance(start).1 } else { first.gradient };
    angle(first, now.gradient)
}

/// What a place sees of the obstacle of a contact, if it has a shape, where that is.
fn see(scene: &Scene, contact: usize, pose: &Pose, place: &[f64; 3], against: &[f64; 3]) -> Option<Seen> {
    let shape = scene.contacts[contact].shape.as_ref()?;
    let seen = shape.see(pose.origin(place), pose.back(against));
    let gradient = pose.forth(&seen.gradient);
    Some(Seen { gradient, ..seen })
}

fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    vec3::norm(vec3::cross(a, b)).atan2(vec3::dot(a, b))
}
