//! Rigid motions of whole bodies that no row of `B` stops.
//!
//! The rank of `G W G^T` is decided here and not by small pivots: the interface rows join subdomains to bodies, and a
//! vector of its null space is a rigid motion of bodies that all other rows of positive weight leave alone. That is an
//! eigenvalue problem of six unknowns a body, with a clear gap however long or finely divided the body is. Subdomains
//! that share an edge or a node only are bodies of their own: the rows between them leave a hinge free.

use crate::coarse::joints::{joint_rows, rigid_pairs};
use crate::linalg::entry;
use crate::rows::gluing::{CopyEntry, Gluing};
use crate::subdomain::kernel::{Kernel, displacement, mean};
use crate::subdomain::matrices::Subdomains;
use crate::tolerances::{FREE, MOVING, NO_ACTION};
use nalgebra::{Cholesky, DMatrix, SymmetricEigen};
use signorini_fem_mesh::internal::{DisjointSets, Lists, count_of};
use signorini_fem_mesh::vec3::{dot, sub};
use std::fmt;
use std::sync::Arc;

/// A rigid motion of the bodies that the rows of positive weight do not stop.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FreeMotion {
    /// For each body that moves: its number, the translation of its centre and the rotation vector, in units in which
    /// the largest nodal displacement is about one.
    pub bodies: Vec<BodyMotion>,
    /// The motion as a vector of coarse amplitudes, six per subdomain.
    pub amplitudes: Vec<f64>,
}

/// Rigid motion of one body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct BodyMotion {
    /// Body number; bodies are numbered by their first subdomain. Parts of a body that hinges join move each in their
    /// way.
    pub body: usize,
    /// The first subdomain of the body, or of its part.
    pub subdomain: usize,
    /// Translation of the centre.
    pub translation: [f64; 3],
    /// Rotation about the centre, times the radius of the body.
    pub rotation: [f64; 3],
    /// Radius of the body, m: root mean square distance of its nodes from the centre (mean over subdomains).
    pub radius: f64,
}

impl fmt::Display for FreeMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, m) in self.bodies.iter().enumerate() {
            let [t, r] = [m.translation, m.rotation];
            let separator = if k > 0 { "; " } else { "" };
            write!(f, "{separator}body {} (with subdomain {}): ", m.body, m.subdomain)?;
            write!(f, "translation ({:.3}, {:.3}, {:.3}), ", t[0], t[1], t[2])?;
            write!(f, "rotation ({:.3}, {:.3}, {:.3})", r[0], r[1], r[2])?;
        }
        Ok(())
    }
}

/// Bodies and how the rows act on their rigid motions.
#[derive(Debug)]
pub(crate) struct Mobility {
    /// Rigid part of each subdomain.
    pub(crate) part_of: Vec<u32>,
    /// Body of each subdomain: parts that hinges join are of one.
    pub(crate) body_of: Vec<u32>,
    bodies: Vec<Body>,
    centres: Vec<[f64; 3]>,
    subdomains: Arc<Subdomains>,
    /// Interface rows between bodies (hinges): what they do to their motions.
    joints: Vec<Vec<(usize, [f64; 6])>>,
}

/// Bodies that rows join, and the Gram matrix of the actions of the rows on them.
#[derive(Debug, Default)]
struct Group {
    bodies: Vec<usize>,
    gram: DMatrix<f64>,
}

impl Group {
    /// Whether all eigenvalues are larger than those of free motions, for certain.
    fn is_held(&self) -> bool {
        let least = (FREE * self.gram.trace()).max(NO_ACTION);
        let mut left = self.gram.clone();
        (0..left.nrows()).for_each(|k| left[(k, k)] -= least);
        Cholesky::new(left).is_some()
    }
}

#[derive(Debug)]
struct Body {
    centre: [f64; 3],
    radius: f64,
    first: usize,
}

impl Mobility {
    /// `centres` are the means of the nodes of the subdomains.
    pub(crate) fn new(subdomains: Arc<Subdomains>, gluing: &Gluing, centres: Vec<[f64; 3]>) -> Self {
        let mut sets = DisjointSets::new(centres.len());
        let position = |s: usize, local: usize| {
            let kernel = subdomains.kernel(s);
            let arm = kernel.arm(local);
            std::array::from_fn(|c| centres[s][c] + kernel.radius() * arm[c])
        };
        for (a, b) in rigid_pairs(gluing, position) {
            sets.join(a as usize, b as usize);
        }
        let part_of = sets.numbers();
        let members = Lists::by_number(&part_of);
        let body = |members: &[u32]| {
            let own = || members.iter().map(|&s| s as usize);
            let centre = mean(own().map(|s| centres[s]));
            let square = |s: usize| {
                let (own, off) = (subdomains.kernel(s).radius(), sub(centres[s], centre));
                dot(off, off) + own * own
            };
            let square: f64 = own().map(square).sum();
            let radius = (square / members.len() as f64).sqrt();
            Body {
                centre,
                radius,
                first: members[0] as usize,
            }
        };
        let bodies = members.iter().map(body).collect();
        let joints = joint_rows(gluing, &part_of);
        for row in &joints {
            sets.join_all(row.iter().map(|entry| entry.subdomain as usize));
        }
        let mut out = Self {
            part_of,
            body_of: sets.numbers(),
            bodies,
            centres,
            subdomains,
            joints: Vec::new(),
        };
        let acts = |row: &Vec<CopyEntry>| {
            let mut actions = Vec::new();
            out.act(row, 1.0, &mut actions);
            actions
        };
        out.joints = joints.iter().map(acts).collect();
        out
    }

    /// Means of the nodes of the subdomains.
    pub(crate) fn centres(&self) -> &[[f64; 3]] {
        &self.centres
    }

    pub(crate) fn bodies(&self) -> usize {
        count_of(&self.body_of)
    }

    fn kernel(&self, subdomain: usize) -> &Kernel {
        self.subdomains.kernel(subdomain)
    }

    /// Motion of a subdomain about its own centre when its body moves by `motion` about the body's.
    fn restrict(&self, subdomain: usize, motion: &[f64; 6]) -> [f64; 6] {
        let body = &self.bodies[self.part_of[subdomain] as usize];
        let c = self.centres[subdomain];
        let arm = std::array::from_fn(|k| (c[k] - body.centre[k]) / body.radius);
        let [x, y, z] = displacement(motion, &arm);
        let ratio = self.kernel(subdomain).radius() / body.radius;
        let [.., a, b, c] = motion.map(|m| m * ratio);
        [x, y, z, a, b, c]
    }

    /// Adds what a row (entries times `factor`) does to the motions of the bodies.
    pub(crate) fn act(&self, entries: &[CopyEntry], factor: f64, out: &mut Vec<(usize, [f64; 6])>) {
        for e in entries {
            let s = e.subdomain as usize;
            let body = self.part_of[s] as usize;
            let sum = entry(out, body, [0.0; 6]);
            let arm = self.kernel(s).arm(e.local as usize);
            for (mode, sum) in sum.iter_mut().enumerate() {
                let mut motion = [0.0; 6];
                motion[mode] = 1.0;
                let u = displacement(&self.restrict(s, &motion), arm);
                *sum += factor * dot(e.vector, u);
            }
        }
    }

    /// Motions that the rows leave free; each row is the list of its actions on bodies, times the root of its weight.
    ///
    /// Bodies that no row joins are judged one by one: what is little is little for a body, not for all of them.
    pub(crate) fn free(&self, rows: impl Iterator<Item = Vec<(usize, [f64; 6])>>) -> Vec<FreeMotion> {
        let rows: Vec<_> = rows.chain(self.joints.iter().cloned()).collect();
        let mut sets = DisjointSets::new(self.bodies.len());
        for row in &rows {
            sets.join_all(row.iter().map(|action| action.0));
        }
        let of = sets.numbers();
        let mut groups: Vec<Group> = (0..count_of(&of)).map(|_| Group::default()).collect();
        let of: Vec<usize> = of.into_iter().map(|group| group as usize).collect();
        let mut place = vec![0; of.len()];
        for (body, &group) in of.iter().enumerate() {
            place[body] = groups[group].bodies.len();
            groups[group].bodies.push(body);
        }
        for group in &mut groups {
            let dim = 6 * group.bodies.len();
            group.gram = DMatrix::zeros(dim, dim);
        }
        for row in &rows {
            for (a, ga) in row {
                let gram = &mut groups[of[*a]].gram;
                for (b, gb) in row {
                    for i in 0..6 {
                        for j in 0..6 {
                            gram[(6 * place[*a] + i, 6 * place[*b] + j)] += ga[i] * gb[j];
                        }
                    }
                }
            }
        }
        let mut out = Vec::new();
        // most groups are held, which a factor tells sooner than eigenvalues
        for group in groups.into_iter().filter(|group| !group.is_held()) {
            let eigen = SymmetricEigen::new(group.gram);
            let largest = eigen.eigenvalues.iter().fold(0.0_f64, |m, v| m.max(*v));
            for (k, value) in eigen.eigenvalues.iter().enumerate() {
                if *value <= (FREE * largest).max(NO_ACTION) {
                    let mut vector = vec![0.0; 6 * self.bodies.len()];
                    for (c, v) in eigen.eigenvectors.column(k).iter().enumerate() {
                        vector[6 * group.bodies[c / 6] + c % 6] = *v;
                    }
                    out.push(self.describe(&vector));
                }
            }
        }
        out
    }

    fn describe(&self, vector: &[f64]) -> FreeMotion {
        let part = |body: usize| -> [f64; 6] { std::array::from_fn(|k| vector[6 * body + k]) };
        let moving = |body: &usize| part(*body).iter().any(|v| v.abs() > MOVING);
        let bodies = (0..self.bodies.len()).filter(moving).map(|body| {
            let [a, b, c, d, e, f] = part(body);
            let subdomain = self.bodies[body].first;
            BodyMotion {
                body: self.body_of[subdomain] as usize,
                subdomain,
                translation: [a, b, c],
                rotation: [d, e, f],
                radius: self.bodies[body].radius,
            }
        });
        let mut amplitudes = Vec::with_capacity(6 * self.part_of.len());
        for s in 0..self.part_of.len() {
            let motion = self.restrict(s, &part(self.part_of[s] as usize));
            amplitudes.extend(self.kernel(s).amplitudes(&motion));
        }
        FreeMotion {
            bodies: bodies.collect(),
            amplitudes,
        }
    }

    /// As many springs on coarse amplitudes as there are free motions, such that no free motion escapes them:
    /// `(subdomain, six coefficients)`.
    pub(crate) fn springs(&self, free: &[FreeMotion]) -> Vec<(usize, [f64; 6])> {
        // Gaussian elimination with full pivoting on the amplitudes of each body's first subdomain.
        let mut rows: Vec<Vec<f64>> = free
            .iter()
            .map(|m| {
                self.bodies
                    .iter()
                    .flat_map(|b| m.amplitudes[6 * b.first..6 * b.first + 6].to_vec())
                    .collect()
            })
            .collect();
        let mut springs = Vec::with_capacity(free.len());
        for k in 0..rows.len() {
            let mut best = (k, 0, 0.0);
            for (i, row) in rows.iter().enumerate().skip(k) {
                for (j, v) in row.iter().enumerate() {
                    if v.abs() > best.2 {
                        best = (i, j, v.abs());
                    }
                }
            }
            let (pivot_row, column, _) = best;
            rows.swap(k, pivot_row);
            let pivot = rows[k].clone();
            for row in rows.iter_mut().skip(k + 1) {
                let factor = row[column] / pivot[column];
                for (v, p) in row.iter_mut().zip(&pivot) {
                    *v -= factor * p;
                }
            }
            let mut spring = [0.0; 6];
            spring[column % 6] = 1.0;
            springs.push((self.bodies[column / 6].first, spring));
        }
        springs
    }
}
