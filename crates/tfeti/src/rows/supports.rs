//! Supports: which directions of which nodes are fixed, and by how much they are moved.

use crate::error::TfetiError;
use crate::linalg::entry;
use crate::tolerances::{AGREEING, FIXED, ONE_DIRECTION};
use signorini_fem_mesh::vec3::{dot, norm};
use std::collections::BTreeMap;

/// Directions fixed by a support.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Directions {
    /// All three components.
    All,
    /// Single components x, y, z.
    Components([bool; 3]),
    /// Any directions; they are normalised, and dependent ones are left out.
    Vectors(Vec<[f64; 3]>),
    /// The same with a list for each node of the support, in their order, for instance the normals of a curved surface.
    EachNode(Vec<Vec<[f64; 3]>>),
    /// Nothing: a support that holds no more, or not yet, and keeps its place among the others.
    Nothing,
}

impl Directions {
    /// The directions as vectors, not normalised; those of all nodes where each has its own.
    pub fn vectors(&self) -> Vec<[f64; 3]> {
        const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        match self {
            Self::All => AXES.to_vec(),
            Self::Components(on) => (0..3).filter(|&c| on[c]).map(|c| AXES[c]).collect(),
            Self::Vectors(vectors) => vectors.clone(),
            Self::EachNode(vectors) => vectors.concat(),
            Self::Nothing => Vec::new(),
        }
    }
}

/// Prescribed displacement of a support.
///
/// The displacement of a node at time `t` is the sum over cases of `factor(case, t) * value`; only its part along the
/// fixed directions counts.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Number of the displacement case. Cases are numbered from 0, below the number of supports and their motions;
    /// several may belong to one case.
    pub case: u32,
    /// Displacement vectors in metres: one for all nodes, or one for each node of the support.
    pub values: Vec<[f64; 3]>,
    /// How far they may be off, m: where a solve has left nodes. Equations that supports say, too, then need not agree
    /// with them better. Zero for given ones.
    pub off: f64,
    /// Whether a solve has left the nodes there, and they go on from it. Then contact that the support meets in part
    /// keeps its rows, and its forces.
    pub left: bool,
}

impl Motion {
    /// Given displacements.
    pub fn new(case: u32, values: Vec<[f64; 3]>) -> Self {
        Self {
            case,
            values,
            off: 0.0,
            left: false,
        }
    }

    fn check(&self, support: usize, nodes: usize, supports: usize) -> Result<(), TfetiError> {
        let (found, case) = (self.values.len(), self.case);
        if found != 1 && found != nodes {
            return Err(TfetiError::MotionLength { support, found, nodes });
        }
        if (case as usize) < supports {
            Ok(())
        } else {
            Err(TfetiError::CaseNumber {
                support,
                case,
                supports,
            })
        }
    }

    /// Displacement of the node `k` of the support.
    fn of(&self, k: usize) -> [f64; 3] {
        self.values[if self.values.len() == 1 { 0 } else { k }]
    }
}

/// Nodes with fixed directions.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeSupport {
    /// Mesh nodes.
    pub nodes: Vec<u32>,
    /// The directions in which they are fixed.
    pub directions: Directions,
    /// Prescribed displacements, which add up; none means zero.
    pub motions: Vec<Motion>,
}

impl NodeSupport {
    /// Fixes all components of the nodes at zero.
    pub fn fixed(nodes: Vec<u32>) -> Self {
        Self::partial(nodes, Directions::All)
    }

    /// Fixes some directions of the nodes at zero.
    pub fn partial(nodes: Vec<u32>, directions: Directions) -> Self {
        Self {
            nodes,
            directions,
            motions: Vec::new(),
        }
    }

    /// Takes some nodes, ascending, out, with what is said of each alone.
    pub fn release(&mut self, nodes: &[u32]) {
        let count = self.nodes.len();
        let kept: Vec<bool> = self.nodes.iter().map(|n| nodes.binary_search(n).is_err()).collect();
        self.nodes = keep(std::mem::take(&mut self.nodes), &kept);
        if let Directions::EachNode(lists) = &mut self.directions
            && lists.len() == count
        {
            *lists = keep(std::mem::take(lists), &kept);
        }
        for motion in &mut self.motions {
            if motion.values.len() == count && count > 1 {
                motion.values = keep(std::mem::take(&mut motion.values), &kept);
            }
        }
    }

    /// The same support, moved, by this beside what moves it already.
    #[must_use]
    pub fn with_motion(mut self, motion: Motion) -> Self {
        self.motions.push(motion);
        self
    }
}

/// Those of a list that are kept.
fn keep<T>(list: Vec<T>, kept: &[bool]) -> Vec<T> {
    list.into_iter()
        .zip(kept)
        .filter(|(_, kept)| **kept)
        .map(|(item, _)| item)
        .collect()
}

/// A spring between a node and the ground: it pushes the body by `-stiffness` times its displacement along the
/// direction, less that at which it is at rest. Springs of a node stand at right angles to one another and to what
/// supports fix.
#[derive(Debug, Clone, PartialEq)]
pub struct NodalSpring {
    /// Mesh node.
    pub node: u32,
    /// Unit direction.
    pub direction: [f64; 3],
    /// N/m, positive.
    pub stiffness: f64,
    /// `(case, displacement in metres)` at which it is at rest for a factor of one, as where supports move the node
    /// across an inclined spring; zero in other cases. Cases are those of supports.
    pub rest: Vec<(u32, f64)>,
}

/// A direction that supports fix at a node.
#[derive(Debug, Clone)]
pub struct FixedDirection {
    /// Of length one, at right angles to the other ones of the node.
    pub direction: [f64; 3],
    /// `(case, value in metres)` along the direction, cases ascending, no zeros.
    pub(super) values: Vec<(u32, f64)>,
    /// Whether it is held from where a solve has left it.
    pub left: bool,
    /// Position in the list of the first support that fixes it.
    pub support: usize,
}

/// What all supports together fix at one node.
#[derive(Debug, Clone, Default)]
pub struct FixedNode {
    /// Mesh node.
    pub node: u32,
    /// The directions.
    pub directions: Vec<FixedDirection>,
}

impl FixedNode {
    /// Prescribed displacement vector of each case: the sum of value times direction.
    pub(super) fn prescribed(&self) -> Vec<(u32, [f64; 3])> {
        let mut out: Vec<(u32, [f64; 3])> = Vec::new();
        for fixed in &self.directions {
            for &(case, value) in &fixed.values {
                let sum = entry(&mut out, case, [0.0; 3]);
                (0..3).for_each(|c| sum[c] += value * fixed.direction[c]);
            }
        }
        out
    }
}

/// All supports merged by node.
#[derive(Debug, Clone, Default)]
pub struct MergedSupports {
    /// Nodes that supports name, ascending (each counts three rows in the paper).
    pub(super) nodes: Vec<FixedNode>,
    /// Number of nodes of the mesh.
    pub(super) mesh_nodes: usize,
    pub(super) cases: usize,
    /// How far displacements of each case may be off, m.
    off: Vec<f64>,
}

pub(super) fn check_node(node: u32, nodes: usize, place: impl FnOnce() -> String) -> Result<(), TfetiError> {
    if (node as usize) < nodes {
        Ok(())
    } else {
        Err(TfetiError::UnknownNode {
            place: place(),
            node,
            nodes,
        })
    }
}

impl MergedSupports {
    /// How far displacements of a case may be off, m.
    pub(super) fn off(&self, case: u32) -> f64 {
        self.off.get(case as usize).copied().unwrap_or(0.0)
    }

    pub(super) fn at(&self, node: u32) -> Option<&FixedNode> {
        let at = self.nodes.binary_search_by_key(&node, |n| n.node);
        at.ok().map(|k| &self.nodes[k])
    }

    /// The directions that supports fix at a node.
    pub fn directions(&self, node: u32) -> &[FixedDirection] {
        self.at(node).map_or(&[], |fixed| &fixed.directions)
    }

    /// The displacement that supports prescribe at a node, by case, m.
    pub fn prescribed(&self, node: u32) -> Vec<(u32, [f64; 3])> {
        self.at(node).map_or_else(Vec::new, FixedNode::prescribed)
    }

    /// Nodes with at least one fixed direction, ascending.
    pub fn fixed(&self) -> impl Iterator<Item = &FixedNode> {
        self.nodes.iter().filter(|fixed| !fixed.directions.is_empty())
    }

    /// Nodes and directions that are held at zero, since no case prescribes more; nodes ascending.
    pub fn at_zero(&self) -> Vec<(u32, [f64; 3])> {
        let of = |fixed: &'_ FixedNode| {
            let node = fixed.node;
            let rest = fixed.directions.iter().filter(|d| d.values.is_empty());
            rest.map(move |d| (node, d.direction)).collect::<Vec<_>>()
        };
        self.nodes.iter().flat_map(of).collect()
    }

    /// Leaves out nodes, ascending.
    pub fn release(&mut self, nodes: &[u32]) {
        self.nodes.retain(|fixed| nodes.binary_search(&fixed.node).is_err());
    }

    /// Merges the supports of a mesh with so many nodes.
    ///
    /// # Errors
    /// [`TfetiError`] as of a set-up: wrong or contradictory supports, unknown nodes.
    pub fn new(supports: &[NodeSupport], nodes: usize) -> Result<Self, TfetiError> {
        let mut fixed: BTreeMap<u32, FixedNode> = BTreeMap::new();
        let mut merged = Self {
            mesh_nodes: nodes,
            ..Self::default()
        };
        let holding = |support: &NodeSupport| support.directions != Directions::Nothing;
        let motions: usize = supports.iter().map(|s| s.motions.len()).sum();
        let cases = supports.len().max(motions);
        for (s, support) in supports.iter().enumerate().filter(|(_, support)| holding(support)) {
            let of_nodes = unit_directions(s, support)?;
            let left = support.motions.iter().any(|m| m.left);
            for motion in &support.motions {
                motion.check(s, support.nodes.len(), cases)?;
                merged.cases = merged.cases.max(motion.case as usize + 1);
                merged.off.resize(merged.cases, 0.0);
                let off = &mut merged.off[motion.case as usize];
                *off = off.max(motion.off);
            }
            for (k, &node) in support.nodes.iter().enumerate() {
                check_node(node, nodes, || format!("support {s}"))?;
                let motions: Vec<(u32, [f64; 3])> = support.motions.iter().map(|m| (m.case, m.of(k))).collect();
                if !motions.iter().flat_map(|m| m.1).all(f64::is_finite) {
                    return Err(TfetiError::BadMotion { support: s, node });
                }
                let new = || FixedNode {
                    node,
                    ..FixedNode::default()
                };
                let entry = fixed.entry(node).or_insert_with(new);
                let directions = if of_nodes.len() == 1 { &of_nodes[0] } else { &of_nodes[k] };
                for direction in directions {
                    add_direction(entry, (s, left), *direction, &motions)?;
                }
            }
        }
        merged.nodes = fixed.into_values().collect();
        Ok(merged)
    }
}

/// Unit directions of a support: one list for all nodes, or one for each.
fn unit_directions(s: usize, support: &NodeSupport) -> Result<Vec<Vec<[f64; 3]>>, TfetiError> {
    let mut of_nodes = match &support.directions {
        Directions::EachNode(lists) => lists.clone(),
        other => vec![other.vectors()],
    };
    let (found, nodes) = (of_nodes.len(), support.nodes.len());
    for (none, what) in [
        (nodes == 0, "nodes"),
        (of_nodes.iter().all(Vec::is_empty), "directions"),
    ] {
        if none {
            return Err(TfetiError::EmptySupport { support: s, what });
        }
    }
    let of_each = matches!(support.directions, Directions::EachNode(_));
    if of_each && found != nodes {
        return Err(TfetiError::DirectionLists {
            support: s,
            found,
            nodes,
        });
    }
    for (at, list) in of_nodes.iter_mut().enumerate() {
        let node = of_each.then(|| support.nodes[at]);
        for (k, direction) in list.iter_mut().enumerate() {
            *direction = unit_direction(*direction).ok_or(TfetiError::BadDirection {
                support: s,
                node,
                direction: k,
            })?;
        }
    }
    Ok(of_nodes)
}

/// `None` if it is zero or not finite.
fn unit_direction(direction: [f64; 3]) -> Option<[f64; 3]> {
    // scaled first, so that neither tiny nor huge vectors lose their length
    let largest = direction.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let scaled = direction.map(|v| v / largest);
    let length = norm(scaled);
    length.is_finite().then(|| scaled.map(|v| v / length))
}

/// Orthonormalises a direction against those already fixed, and adds it if something is left.
fn add_direction(
    fixed_node: &mut FixedNode,
    (support, left): (usize, bool),
    direction: [f64; 3],
    motions: &[(u32, [f64; 3])],
) -> Result<(), TfetiError> {
    let mut rest = direction;
    let mut values: Vec<(u32, f64)> = Vec::new();
    let mut size = 0.0_f64;
    for &(case, vector) in motions {
        size = size.max(norm(vector));
        *entry(&mut values, case, 0.0) += dot(direction, vector);
    }
    let mut first = support;
    // Twice, so that rounding leaves the new direction orthogonal; the second pass changes no value noticeably.
    for _ in 0..2 {
        for fixed in &fixed_node.directions {
            let along = dot(rest, fixed.direction);
            for c in 0..3 {
                rest[c] -= along * fixed.direction[c];
            }
            if along.abs() > FIXED {
                first = fixed.support;
            }
            for &(case, value) in &fixed.values {
                size = size.max(value.abs());
                *entry(&mut values, case, 0.0) -= along * value;
            }
        }
    }
    let length = norm(rest);
    if length > ONE_DIRECTION {
        values.sort_by_key(|v| v.0);
        values.retain(|v| v.1.abs() > f64::EPSILON * size);
        for value in &mut values {
            value.1 /= length;
        }
        let direction = rest.map(|v| v / length);
        fixed_node.directions.push(FixedDirection {
            direction,
            values,
            left,
            support,
        });
        return Ok(());
    }
    // what is left of it has its part in the value
    let agreeing = (AGREEING + length) * size;
    if let Some(&(case, difference)) = values.iter().find(|v| v.1.abs() > agreeing) {
        return Err(TfetiError::ContradictorySupports {
            node: fixed_node.node,
            first,
            second: support,
            case,
            difference,
        });
    }
    Ok(())
}
