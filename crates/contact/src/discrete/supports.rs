//! Supports at the nodes of the mesh.

use crate::error::ContactError;
use crate::scene::{Scene, Support};
use crate::tolerances::{HELD_ALREADY, LEFT_OFF, NOT_MOVED, ROUNDING};
use signorini_fem_mesh::History;
use signorini_fem_mesh::internal::cylindrical;
use signorini_fem_mesh::vec3::{Vec3, combine, dot, is_finite, norm, scale, sub, unit};
use signorini_tfeti::internal::MergedSupports;
use signorini_tfeti::{Directions, Motion, NodeSupport};
use std::ops::Range;

/// The supports of a scene, node by node.
#[derive(Debug)]
pub(crate) struct Supports {
    /// One a support of the scene.
    pub(crate) nodes: Vec<NodeSupport>,
    /// History of each displacement case. Equal histories are one case, so that equal displacements of a node that two
    /// supports share are recognised as equal.
    pub(crate) motions: Vec<History>,
    /// Cases of nodes that are held where earlier steps have left them.
    pub(super) left: Range<usize>,
    /// What all of them fix at each node.
    pub(crate) merged: MergedSupports,
}

impl Supports {
    pub(super) fn new(scene: &Scene) -> Result<Self, ContactError> {
        let mut motions: Vec<History> = Vec::new();
        let mut nodes = Vec::with_capacity(scene.supports.len());
        let mut started = Vec::new();
        for (index, support) in scene.supports.iter().enumerate() {
            let own = scene.support_nodes(index)?;
            check_motion(index, support, &own)?;
            if !scene.acts(support.span) {
                nodes.push(NodeSupport::partial(own, Directions::Nothing));
                continue;
            }
            if scene.has_started(index) {
                started.push(index);
            }
            let (directions, values) = match support.axis {
                None => (support.directions.clone(), None),
                Some(axis) => about_axis(scene, index, axis, &own)?,
            };
            let mut one = NodeSupport::partial(own, directions);
            if let Some((given, history)) = &support.motion {
                let values = values.unwrap_or_else(|| given.clone());
                one = one.with_motion(Motion::new(case_of(&mut motions, history), values));
            }
            nodes.push(one);
        }
        let given = motions.len();
        hold_where_they_are(scene, started, &mut nodes, &mut motions)?;
        Ok(Self {
            left: given..motions.len(),
            merged: MergedSupports::new(&nodes, scene.mesh.points().len())?,
            nodes,
            motions,
        })
    }

    /// Takes nodes, ascending, out of all supports.
    pub(super) fn release(&mut self, nodes: &[u32]) {
        if nodes.iter().any(|node| !self.merged.directions(*node).is_empty()) {
            self.merged.release(nodes);
            self.nodes.iter_mut().for_each(|support| support.release(nodes));
        }
    }

    /// The displacement case of a history.
    pub(super) fn case(&mut self, history: &History) -> u32 {
        case_of(&mut self.motions, history)
    }
}

/// Refuses a motion along x, y or z, or along one of those of an axis, of which no held direction has a part: it would
/// not take place. Directions of each node, such as normals of a curved surface, take what is along them.
fn check_motion(index: usize, support: &Support, nodes: &[u32]) -> Result<(), ContactError> {
    let each = matches!(support.directions, Directions::EachNode(_));
    let Some((values, _)) = support.motion.as_ref().filter(|_| !each) else {
        return Ok(());
    };
    let size = |v: &Vec3| v.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    let directions = support.directions.vectors();
    // those that are not finite are told with the others
    let nothing = |c: usize| directions.iter().all(|d| d[c].abs() <= ROUNDING * size(d));
    let free = [0, 1, 2].map(nothing);
    let least = NOT_MOVED * values.iter().map(size).fold(0.0, f64::max);
    let lost = |v: &Vec3| (0..3).find(|&c| free[c] && v[c].abs() > least).map(|c| (c, v[c]));
    let first = values.iter().zip(nodes).find_map(|(v, &node)| Some((node, lost(v)?)));
    first.map_or(Ok(()), |(node, (component, value))| {
        let names = match support.axis {
            None => ["along x", "along y", "along z"],
            Some(_) => ["radially", "tangentially", "along its axis"],
        };
        Err(ContactError::MotionNotHeld {
            support: index,
            node,
            value,
            along: names[component],
        })
    })
}

/// Supports that started later hold what those before them leave free, where it is.
fn hold_where_they_are(
    scene: &Scene,
    mut started: Vec<usize>,
    nodes: &mut [NodeSupport],
    motions: &mut Vec<History>,
) -> Result<(), ContactError> {
    let start = |index: &usize| scene.supports[*index].span.start.unwrap_or(0.0);
    started.sort_by(|a, b| start(a).total_cmp(&start(b)));
    let mut before = nodes.to_vec();
    started
        .iter()
        .for_each(|&index| before[index].directions = Directions::Nothing);
    for index in started {
        let (support, own) = (&scene.supports[index], &mut nodes[index]);
        let held = MergedSupports::new(&before, scene.mesh.points().len())?;
        if own.nodes.iter().any(|node| !held.directions(*node).is_empty()) {
            own.directions = left_free(own, &held);
        }
        if !support.left.is_empty() {
            if support.left.len() != own.nodes.len() {
                let (known, count) = (support.left.len(), own.nodes.len());
                let reason = format!("it says where {known} nodes of support {index} are, which has {count}");
                return Err(ContactError::Checkpoint { reason });
            }
            let fading = support.fading.clone().unwrap_or_else(|| History::constant(1.0));
            // a case of its own: it says how far what solves have left may be off
            motions.push(fading);
            let largest = support.left.iter().map(|u| norm(*u)).fold(0.0, f64::max);
            own.motions.push(Motion {
                off: LEFT_OFF * largest,
                left: support.fading.is_none(),
                ..Motion::new(motions.len() as u32 - 1, support.left.clone())
            });
        }
        before[index] = own.clone();
    }
    Ok(())
}

/// The directions of a support that others do not hold, node by node: as they are given, so that what it prescribes is
/// along these, or, where it holds what others hold in part, what is left of them.
fn left_free(support: &NodeSupport, held: &MergedSupports) -> Directions {
    let given = match &support.directions {
        Directions::EachNode(lists) if lists.len() == support.nodes.len() => lists.clone(),
        // another number than that of the nodes is refused with the others
        Directions::EachNode(_) => return support.directions.clone(),
        others => vec![others.vectors(); support.nodes.len()],
    };
    let lists = support.nodes.iter().zip(given);
    let lists = lists.map(|(node, list)| left_of(list, held.directions(*node).iter().map(|other| other.direction)));
    let lists: Vec<Vec<Vec3>> = lists.collect();
    if lists.iter().all(Vec::is_empty) {
        Directions::Nothing
    } else {
        Directions::EachNode(lists)
    }
}

/// The same at one node.
fn left_of(mut given: Vec<Vec3>, held: impl Iterator<Item = Vec3>) -> Vec<Vec3> {
    let mut basis: Vec<Vec3> = held.collect();
    let rest = |direction: Vec3, others: &[Vec3]| {
        let rest = others
            .iter()
            .fold(direction, |rest, other| sub(rest, scale(dot(rest, *other), *other)));
        // what is no direction is told with the others
        let gone = norm(rest) <= HELD_ALREADY * norm(direction) && norm(direction) > 0.0;
        (!gone).then_some(rest)
    };
    given.retain(|direction| rest(*direction, &basis).is_some());
    let left: Vec<Vec3> = given.iter().filter_map(|direction| rest(*direction, &basis)).collect();
    let is_independent = |direction: &Vec3| match rest(*direction, &basis) {
        Some(rest) => {
            basis.push(unit(rest));
            true
        }
        None => false,
    };
    if given.iter().all(is_independent) { given } else { left }
}

/// The case of a history, which is a new one if it is not known.
fn case_of(motions: &mut Vec<History>, history: &History) -> u32 {
    let known = motions.iter().position(|known| known == history);
    known.unwrap_or_else(|| {
        motions.push(history.clone());
        motions.len() - 1
    }) as u32
}

/// Directions of a support, and its displacements if it moves.
type Given = (Directions, Option<Vec<[f64; 3]>>);

/// What is radial, tangential and axial along x, y, z, node by node.
fn about_axis(
    scene: &Scene,
    index: usize,
    (point, axis): ([f64; 3], [f64; 3]),
    nodes: &[u32],
) -> Result<Given, ContactError> {
    let support = &scene.supports[index];
    let along = unit(axis);
    if !is_finite(along) || !is_finite(point) {
        let support = index;
        return Err(ContactError::SupportAxis { support, point, axis });
    }
    let arms = nodes.iter().map(|&n| sub(scene.mesh.points()[n as usize], point));
    let arms: Vec<_> = arms.collect();
    let size = arms.iter().map(|arm| norm(*arm)).fold(0.0, f64::max);
    let given = support.directions.vectors();
    let only_axial = given.iter().all(|d| d[..2] == [0.0; 2]);
    let mut frames = Vec::with_capacity(nodes.len());
    for (&node, arm) in nodes.iter().zip(arms) {
        frames.push(match cylindrical(arm, along, size) {
            Some(frame) => frame,
            None if only_axial => [[0.0; 3], [0.0; 3], along],
            None => return Err(ContactError::OnAxis { support: index, node }),
        });
    }
    let lists = match &support.directions {
        Directions::EachNode(lists) => lists,
        _ => &vec![given; nodes.len()],
    };
    // as many lists as were given: another number than that of the nodes is refused with the others
    let of_node = |(own, frame): (&Vec<_>, _)| own.iter().map(|v| combine(frame, *v)).collect();
    let directions = lists.iter().zip(frames.iter().cycle()).map(of_node).collect();
    let values = support.motion.as_ref().map(|(values, _)| {
        let value = |(frame, v): (_, &[f64; 3])| combine(frame, *v);
        frames.iter().zip(values.iter().cycle()).map(value).collect()
    });
    Ok((Directions::EachNode(directions), values))
}
