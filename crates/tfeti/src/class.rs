//! Classes of subdomains that are translations of one another.
//!
//! Translates with the same local mesh and material have the same stiffness matrix, kernel and inverse. They are found
//! by a cheap key and then compared entry by entry: a class is never formed because two hashes agree.

use crate::error::TfetiError;
use signorini_fem_mesh::{Decomposition, Hooke, Materials, TetMesh};
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Whether translates share their matrices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Sharing {
    /// Subdomains that are translations of one another share one stiffness matrix, kernel and inverse.
    #[default]
    Translates,
    /// Every subdomain has its own; for measuring what generality costs.
    Never,
}

/// Subdomains that share one set of matrices.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Class {
    /// Subdomain numbers, ascending. The first is the representative from which the matrices are computed.
    pub members: Vec<u32>,
    /// Nodes of each member.
    pub nodes: usize,
    /// Tetrahedra of each member.
    pub elements: usize,
}

/// Partition of the subdomains into classes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Classes {
    classes: Vec<Class>,
    /// Of each subdomain: class and position among its members.
    place: Vec<(u32, u32)>,
}

impl Classes {
    /// The classes, in order of their first member.
    #[must_use]
    pub fn classes(&self) -> &[Class] {
        &self.classes
    }

    /// Class of a subdomain and its position among the members.
    #[must_use]
    pub fn place(&self, subdomain: usize) -> (usize, usize) {
        let (class, member) = self.place[subdomain];
        (class as usize, member as usize)
    }

    /// Number of subdomains.
    #[must_use]
    pub fn subdomains(&self) -> usize {
        self.place.len()
    }

    /// Finds the classes. Two subdomains share one if their local connectivity is identical, their elements have equal
    /// Hooke tensors, and their node positions agree up to a translation within `1e-12` of their size (plus the
    /// rounding of the coordinates themselves).
    pub fn find(
        mesh: &TetMesh,
        decomposition: &Decomposition,
        materials: &Materials,
        sharing: Sharing,
    ) -> Result<Self, TfetiError> {
        let mut classes: Vec<Class> = Vec::new();
        let mut place = Vec::with_capacity(decomposition.subdomains().len());
        // Per key: (signature, class), sorted by the signature.
        let mut buckets: HashMap<u64, Vec<(f64, usize)>> = HashMap::new();
        for (s, subdomain) in decomposition.subdomains().iter().enumerate() {
            let candidate = Candidate::new(
                mesh,
                &subdomain.nodes,
                &subdomain.tets,
                &subdomain.elements,
                materials,
            )?;
            let mut home = None;
            if sharing == Sharing::Translates {
                let bucket = buckets.entry(candidate.key()).or_default();
                let slack = candidate.tolerance * SIGNATURE_SLACK;
                let from = bucket.partition_point(|&(v, _)| v < candidate.signature - slack);
                for &(value, class) in &bucket[from..] {
                    if value > candidate.signature + slack {
                        break;
                    }
                    let other = &decomposition.subdomains()[classes[class].members[0] as usize];
                    let other = Candidate::new(
                        mesh,
                        &other.nodes,
                        &other.tets,
                        &other.elements,
                        materials,
                    )?;
                    if candidate.is_translate_of(&other) {
                        home = Some(class);
                        break;
                    }
                }
                if home.is_none() {
                    let at = bucket.partition_point(|&(v, _)| v < candidate.signature);
                    bucket.insert(at, (candidate.signature, classes.len()));
                }
            }
            let class = home.unwrap_or_else(|| {
                classes.push(Class {
                    members: Vec::new(),
                    nodes: subdomain.nodes.len(),
                    elements: subdomain.tets.len(),
                });
                classes.len() - 1
            });
            place.push((class as u32, classes[class].members.len() as u32));
            classes[class].members.push(s as u32);
        }
        Ok(Self { classes, place })
    }
}

/// The signature is a weighted sum of relative positions with weights of modulus at most one: this bounds the change
/// per unit of position error, by the number of coordinates.
const SIGNATURE_SLACK: f64 = 4.0;

struct Candidate<'a> {
    mesh: &'a TetMesh,
    nodes: &'a [u32],
    tets: &'a [[u32; 4]],
    hooke: Vec<&'a Hooke>,
    tolerance: f64,
    signature: f64,
}

impl<'a> Candidate<'a> {
    fn new(
        mesh: &'a TetMesh,
        nodes: &'a [u32],
        tets: &'a [[u32; 4]],
        elements: &'a [u32],
        materials: &'a Materials,
    ) -> Result<Self, TfetiError> {
        let mut hooke = Vec::with_capacity(elements.len());
        for &element in elements {
            let region = mesh.regions()[element as usize];
            hooke.push(
                materials
                    .get(region)
                    .map_err(|error| TfetiError::Material {
                        element: element as usize,
                        message: error.to_string(),
                    })?,
            );
        }
        let points = mesh.points();
        let origin = nodes.first().map_or([0.0; 3], |&n| points[n as usize]);
        let (mut size, mut largest, mut signature) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (k, &n) in nodes.iter().enumerate() {
            let p = points[n as usize];
            for c in 0..3 {
                let relative = p[c] - origin[c];
                size = size.max(relative.abs());
                largest = largest.max(p[c].abs());
                // Any fixed weights do; these are spread over [-1, 1] and do not repeat.
                let weight = ((3 * k + c) as f64 * 0.754_877_666_246_692_8).fract() * 2.0 - 1.0;
                signature += weight * relative;
            }
        }
        let tolerance = 1e-12 * size + 4.0 * f64::EPSILON * largest;
        let signature = signature / (3 * nodes.len().max(1)) as f64;
        Ok(Self {
            mesh,
            nodes,
            tets,
            hooke,
            tolerance,
            signature,
        })
    }

    fn key(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.nodes.len().hash(&mut hasher);
        self.tets.hash(&mut hasher);
        for pair in self.hooke.chunk_by(|a, b| std::ptr::eq(*a, *b)) {
            pair.len().hash(&mut hasher);
            for row in pair[0].voigt() {
                for value in row {
                    value.to_bits().hash(&mut hasher);
                }
            }
        }
        hasher.finish()
    }

    fn is_translate_of(&self, other: &Self) -> bool {
        if self.nodes.len() != other.nodes.len() || self.tets != other.tets {
            return false;
        }
        let same = |(a, b): (&&Hooke, &&Hooke)| std::ptr::eq(*a, *b) || a.voigt() == b.voigt();
        if !self.hooke.iter().zip(&other.hooke).all(same) {
            return false;
        }
        let points = self.mesh.points();
        let tolerance = self.tolerance.max(other.tolerance);
        let (Some(&first), Some(&other_first)) = (self.nodes.first(), other.nodes.first()) else {
            return true;
        };
        let (origin, other_origin) = (points[first as usize], points[other_first as usize]);
        self.nodes.iter().zip(other.nodes).all(|(&a, &b)| {
            let (p, q) = (points[a as usize], points[b as usize]);
            (0..3).all(|c| ((p[c] - origin[c]) - (q[c] - other_origin[c])).abs() <= tolerance)
        })
    }
}
