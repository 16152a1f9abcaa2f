//! Classes of subdomains that are translations of one another.
//!
//! Translates with the same local mesh and material have the same stiffness matrix, kernel and inverse. They are found
//! by a cheap key and then compared entry by entry: a class is never formed because two hashes agree.

use crate::error::TfetiError;
use crate::tolerances::{THIN, THIN_NODES, TRANSLATE};
use rayon::prelude::*;
use signorini_fem_mesh::decomposition::Subdomain;
use signorini_fem_mesh::{Decomposition, Hooke, Materials, TetMesh};
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Subdomains that share one set of matrices.
#[derive(Debug, Clone, PartialEq)]
pub struct Class {
    /// Subdomain numbers, ascending. The first is the representative from which the matrices are computed.
    pub members: Vec<u32>,
    /// Nodes of each member.
    pub nodes: usize,
    /// Whether they have no elements, and no matrices: nothing but rigid motions moves them.
    pub is_rigid: bool,
    /// Local nodes with unit directions in which supports hold them at zero, where springs stand for that.
    pub held: Vec<HeldDirection>,
}

/// A local node and a unit direction.
pub(crate) type HeldDirection = (u32, [f64; 3]);

/// Partition of the subdomains into classes.
#[derive(Debug, Clone, PartialEq)]
pub struct Classes {
    classes: Vec<Class>,
    /// Of each subdomain: class and position among its members.
    place: Vec<(u32, u32)>,
}

impl Classes {
    /// The classes, in order of their first member.
    pub fn classes(&self) -> &[Class] {
        &self.classes
    }

    /// Class of a subdomain and its position among the members.
    pub fn place(&self, subdomain: usize) -> (usize, usize) {
        let (class, member) = self.place[subdomain];
        (class as usize, member as usize)
    }

    pub(crate) fn subdomains(&self) -> usize {
        self.place.len()
    }

    /// Finds the classes: each subdomain its own, or those of translates. Two subdomains share one if their local
    /// connectivity is identical, their elements have equal Hooke tensors, and their node positions agree up to a
    /// translation within `1e-12` of their size (plus the rounding of the coordinates themselves).
    ///
    /// # Errors
    /// [`TfetiError::Material`] if a region has none.
    pub fn find(
        mesh: &TetMesh,
        decomposition: &Decomposition,
        materials: &Materials,
        share_translates: bool,
    ) -> Result<Self, TfetiError> {
        let subdomains = decomposition.subdomains();
        let candidates: Vec<Candidate<'_>> = subdomains
            .par_iter()
            .map(|s| Candidate::new(mesh, s, materials))
            .collect::<Result<_, _>>()?;
        let mut classes: Vec<Class> = Vec::new();
        let mut place = Vec::with_capacity(subdomains.len());
        // Per key: (signature, class), sorted by the signature.
        let mut buckets: HashMap<u64, Vec<(f64, usize)>> = HashMap::new();
        for (s, candidate) in candidates.iter().enumerate() {
            let mut home = None;
            if share_translates {
                let bucket = buckets.entry(candidate.key).or_default();
                let slack = candidate.tolerance * SIGNATURE_SLACK;
                let from = bucket.partition_point(|&(v, _)| v < candidate.signature - slack);
                let close = bucket[from..]
                    .iter()
                    .take_while(|(v, _)| *v <= candidate.signature + slack);
                let same = |class: usize| candidate.is_translate_of(&candidates[classes[class].members[0] as usize]);
                home = close.map(|&(_, class)| class).find(|&class| same(class));
                if home.is_none() {
                    let at = bucket.partition_point(|&(v, _)| v < candidate.signature);
                    bucket.insert(at, (candidate.signature, classes.len()));
                }
            }
            let class = home.unwrap_or_else(|| {
                classes.push(Class {
                    members: Vec::new(),
                    nodes: subdomains[s].nodes.len(),
                    is_rigid: subdomains[s].is_rigid(),
                    held: Vec::new(),
                });
                classes.len() - 1
            });
            place.push((class as u32, classes[class].members.len() as u32));
            classes[class].members.push(s as u32);
        }
        Ok(Self { classes, place })
    }

    /// Splits the classes by what supports hold `at_zero`: nodes of the mesh, ascending, with unit directions at right
    /// angles. Subdomains that are not thin between planes stay together.
    pub(crate) fn with_held(self, decomposition: &Decomposition, at_zero: &[(u32, [f64; 3])]) -> Self {
        if at_zero.is_empty() {
            return self;
        }
        let directions = |node: u32| {
            let from = at_zero.partition_point(|held| held.0 < node);
            at_zero[from..].iter().take_while(move |held| held.0 == node)
        };
        let (mut classes, mut place) = (Vec::<Class>::new(), Vec::with_capacity(self.place.len()));
        let mut known: HashMap<(u32, Vec<u64>), usize> = HashMap::new();
        for (s, (&(old, _), subdomain)) in self.place.iter().zip(decomposition.subdomains()).enumerate() {
            let (mut held, mut partly) = (Vec::<HeldDirection>::new(), 0);
            for (&node, k) in subdomain.nodes.iter().zip(0..) {
                let before = held.len();
                held.extend(directions(node).map(|held| (k, held.1)));
                partly += usize::from(matches!(held.len() - before, 1 | 2));
            }
            // alone it has a preconditioner that is nearly the inverse
            let is_alone = |&n: &u32| decomposition.copies(n as usize).len() == 1;
            let alone = || subdomain.nodes.iter().all(is_alone);
            let size = subdomain.nodes.len();
            let few = size < THIN_NODES || (partly as f64) < THIN * size as f64;
            if few || subdomain.is_rigid() || alone() {
                held.clear();
            }
            let bits = |(k, n): &HeldDirection| [u64::from(*k), n[0].to_bits(), n[1].to_bits(), n[2].to_bits()];
            let key = held.iter().flat_map(bits).collect();
            let class = *known.entry((old, key)).or_insert_with(|| {
                let Class { nodes, is_rigid, .. } = self.classes[old as usize];
                let members = Vec::new();
                classes.push(Class {
                    members,
                    nodes,
                    is_rigid,
                    held,
                });
                classes.len() - 1
            });
            place.push((class as u32, classes[class].members.len() as u32));
            classes[class].members.push(s as u32);
        }
        Self { classes, place }
    }
}

/// The signature is a weighted sum of relative positions with weights of modulus at most one: this bounds the change
/// per unit of position error, by the number of coordinates.
const SIGNATURE_SLACK: f64 = 4.0;

/// What decides whether a subdomain belongs to a class.
struct Candidate<'a> {
    points: &'a [[f64; 3]],
    subdomain: &'a Subdomain,
    /// Runs of elements with one material.
    hooke: Vec<(usize, &'a Hooke)>,
    tolerance: f64,
    signature: f64,
    key: u64,
}

impl<'a> Candidate<'a> {
    fn new(mesh: &'a TetMesh, subdomain: &'a Subdomain, materials: &'a Materials) -> Result<Self, TfetiError> {
        let mut hooke: Vec<(usize, &Hooke)> = Vec::new();
        let mut last = None;
        for &element in &subdomain.elements {
            let region = mesh.regions()[element as usize];
            if last != Some(region) {
                last = Some(region);
                let law = materials.get(region).map_err(|error| TfetiError::Material {
                    element: element as usize,
                    message: error.to_string(),
                })?;
                if hooke.last().is_none_or(|run| run.1.voigt() != law.voigt()) {
                    hooke.push((0, law));
                }
            }
            if let Some(run) = hooke.last_mut() {
                run.0 += 1;
            }
        }
        let points = mesh.points();
        let origin = subdomain.nodes.first().map_or([0.0; 3], |&n| points[n as usize]);
        let (mut size, mut largest, mut signature) = (0.0_f64, 0.0_f64, 0.0_f64);
        // Any fixed weights do; these are spread over [-1, 1] and do not repeat.
        let mut weight = 0.5_f64;
        for &n in &subdomain.nodes {
            let p = points[n as usize];
            for c in 0..3 {
                let relative = p[c] - origin[c];
                size = size.max(relative.abs());
                largest = largest.max(p[c].abs());
                weight += 0.754_877_666_246_692_8;
                if weight > 1.0 {
                    weight -= 2.0;
                }
                signature += weight * relative;
            }
        }
        let tolerance = TRANSLATE * size + 4.0 * f64::EPSILON * largest;
        let signature = signature / (3 * subdomain.nodes.len().max(1)) as f64;
        let mut hasher = DefaultHasher::new();
        subdomain.nodes.len().hash(&mut hasher);
        for tet in subdomain.tets.iter().step_by(8) {
            tet.hash(&mut hasher);
        }
        for (count, law) in &hooke {
            count.hash(&mut hasher);
            law.voigt().iter().flatten().for_each(|v| v.to_bits().hash(&mut hasher));
        }
        Ok(Self {
            points,
            subdomain,
            hooke,
            tolerance,
            signature,
            key: hasher.finish(),
        })
    }

    fn is_translate_of(&self, other: &Self) -> bool {
        let (nodes, other_nodes) = (&self.subdomain.nodes, &other.subdomain.nodes);
        if nodes.len() != other_nodes.len()
            || self.subdomain.tets != other.subdomain.tets
            || self.subdomain.mids != other.subdomain.mids
        {
            return false;
        }
        let same = |(a, b): (&(usize, &Hooke), &(usize, &Hooke))| a.0 == b.0 && a.1.voigt() == b.1.voigt();
        if self.hooke.len() != other.hooke.len() || !self.hooke.iter().zip(&other.hooke).all(same) {
            return false;
        }
        let tolerance = self.tolerance.max(other.tolerance);
        let (Some(&first), Some(&other_first)) = (nodes.first(), other_nodes.first()) else {
            return true;
        };
        let (origin, other_origin) = (self.points[first as usize], self.points[other_first as usize]);
        nodes.iter().zip(other_nodes).all(|(&a, &b)| {
            let (p, q) = (self.points[a as usize], self.points[b as usize]);
            (0..3).all(|c| ((p[c] - origin[c]) - (q[c] - other_origin[c])).abs() <= tolerance)
        })
    }
}
