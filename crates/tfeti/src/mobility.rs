//! Rigid motions of whole bodies that no row of `B` stops.
//!
//! The rank of `G W G^T` is decided here and not by small pivots: the interface rows join subdomains to bodies, and a
//! vector of its null space is a rigid motion of bodies that all other rows of positive weight leave alone. That is an
//! eigenvalue problem of six unknowns a body, with a clear gap however long or finely divided the body is. Subdomains that
//! share an edge or a node only are bodies of their own: the rows between them leave a hinge free.

use crate::class::Classes;
use crate::gluing::{CopyEntry, Gluing};
use crate::joints::{joint_rows, rigid_pairs};
use crate::kernel::{Kernel, displacement};
use crate::matrices::ClassBase;
use nalgebra::{DMatrix, SymmetricEigen};
use signorini_fem_mesh::internal::DisjointSets;
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
    /// Body number; bodies are numbered by their first subdomain. Parts of a body that hinges join move each in their way.
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
            write!(
                f,
                "{separator}body {} (with subdomain {}): ",
                m.body, m.subdomain
            )?;
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
    part_of: Vec<u32>,
    /// Body of each subdomain: parts that hinges join are of one.
    body_of: Vec<u32>,
    bodies: Vec<Body>,
    centres: Vec<[f64; 3]>,
    classes: Arc<Classes>,
    bases: Arc<Vec<ClassBase>>,
    /// Interface rows between bodies (hinges): what they do to their motions.
    joints: Vec<Vec<(usize, [f64; 6])>>,
}

/// Bodies that rows join, and the Gram matrix of the actions of the rows on them.
#[derive(Debug, Default)]
struct Group {
    bodies: Vec<usize>,
    gram: DMatrix<f64>,
}

#[derive(Debug)]
struct Body {
    centre: [f64; 3],
    radius: f64,
    first: usize,
}

/// Eigenvalues below this share of the largest belong to free motions. A support of extent `h` on a body of length `L`
/// gives about `(h/L)^2`.
const FREE: f64 = 1e-11;

impl Mobility {
    /// `centres` are the means of the nodes of the subdomains.
    pub(crate) fn new(
        classes: Arc<Classes>,
        bases: Arc<Vec<ClassBase>>,
        gluing: &Gluing,
        centres: Vec<[f64; 3]>,
    ) -> Self {
        let mut sets = DisjointSets::new(centres.len());
        let position = |s: usize, local: usize| {
            let kernel = &bases[classes.place(s).0].kernel;
            let arm = kernel.arm(local);
            std::array::from_fn(|c| centres[s][c] + kernel.radius() * arm[c])
        };
        for (a, b) in rigid_pairs(gluing, position) {
            sets.join(a as usize, b as usize);
        }
        let mut bodies: Vec<Body> = Vec::new();
        let mut part_of = vec![0; centres.len()];
        let mut members: Vec<Vec<usize>> = Vec::new();
        for s in 0..centres.len() {
            let first = sets.first(s);
            if first == s {
                part_of[s] = bodies.len() as u32;
                bodies.push(Body {
                    centre: [0.0; 3],
                    radius: 1.0,
                    first: s,
                });
                members.push(vec![s]);
            } else {
                part_of[s] = part_of[first];
                members[part_of[s] as usize].push(s);
            }
        }
        for (body, members) in bodies.iter_mut().zip(&members) {
            body.centre = crate::kernel::mean(members.iter().map(|&s| centres[s]));
            let square: f64 = members
                .iter()
                .map(|&s| {
                    let own = bases[classes.place(s).0].kernel.radius();
                    (0..3)
                        .map(|c| (centres[s][c] - body.centre[c]).powi(2))
                        .sum::<f64>()
                        + own * own
                })
                .sum();
            body.radius = (square / members.len() as f64).sqrt();
        }
        let joints = joint_rows(gluing, &part_of);
        for row in &joints {
            for pair in row.windows(2) {
                sets.join(pair[0].subdomain as usize, pair[1].subdomain as usize);
            }
        }
        let mut out = Self {
            part_of,
            body_of: sets.numbers(),
            bodies,
            centres,
            classes,
            bases,
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
        self.body_of.iter().max().map_or(0, |b| *b as usize + 1)
    }

    /// Body of each subdomain.
    pub(crate) fn body_of(&self) -> &[u32] {
        &self.body_of
    }

    fn kernel(&self, subdomain: usize) -> &Kernel {
        &self.bases[self.classes.place(subdomain).0].kernel
    }

    /// Motion of a subdomain about its own centre when its body moves by `motion` about the body's.
    fn restrict(&self, subdomain: usize, motion: &[f64; 6]) -> [f64; 6] {
        let body = &self.bodies[self.part_of[subdomain] as usize];
        let c = self.centres[subdomain];
        let arm = std::array::from_fn(|k| (c[k] - body.centre[k]) / body.radius);
        let [x, y, z] = displacement(motion, &arm);
        let ratio = self.kernel(subdomain).radius() / body.radius;
        [
            x,
            y,
            z,
            motion[3] * ratio,
            motion[4] * ratio,
            motion[5] * ratio,
        ]
    }

    /// Adds what a row (entries times `factor`) does to the motions of the bodies.
    pub(crate) fn act(&self, entries: &[CopyEntry], factor: f64, out: &mut Vec<(usize, [f64; 6])>) {
        for e in entries {
            let s = e.subdomain as usize;
            let body = self.part_of[s] as usize;
            let at = match out.iter().position(|v| v.0 == body) {
                Some(at) => at,
                None => {
                    out.push((body, [0.0; 6]));
                    out.len() - 1
                }
            };
            for mode in 0..6 {
                let mut motion = [0.0; 6];
                motion[mode] = 1.0;
                let u = displacement(
                    &self.restrict(s, &motion),
                    self.kernel(s).arm(e.local as usize),
                );
                out[at].1[mode] += factor * (0..3).map(|c| e.vector[c] * u[c]).sum::<f64>();
            }
        }
    }

    /// Motions that the rows leave free; each row is the list of its actions on bodies, times the root of its weight.
    ///
    /// Bodies that no row joins are judged one by one: what is little is little for a body, not for all of them.
    pub(crate) fn free(
        &self,
        rows: impl Iterator<Item = Vec<(usize, [f64; 6])>>,
    ) -> Vec<FreeMotion> {
        let rows: Vec<_> = rows.chain(self.joints.iter().cloned()).collect();
        let mut sets = DisjointSets::new(self.bodies.len());
        for row in &rows {
            for pair in row.windows(2) {
                sets.join(pair[0].0, pair[1].0);
            }
        }
        let mut groups: Vec<Group> = (0..self.bodies.len()).map(|_| Group::default()).collect();
        let mut place = vec![0; self.bodies.len()];
        for body in 0..self.bodies.len() {
            let group = &mut groups[sets.first(body)];
            place[body] = group.bodies.len();
            group.bodies.push(body);
        }
        groups.retain(|group| !group.bodies.is_empty());
        let mut of = vec![0; self.bodies.len()];
        for (k, group) in groups.iter_mut().enumerate() {
            let dim = 6 * group.bodies.len();
            group.gram = DMatrix::zeros(dim, dim);
            for &body in &group.bodies {
                of[body] = k;
            }
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
        for group in groups {
            let eigen = SymmetricEigen::new(group.gram);
            let largest = eigen.eigenvalues.iter().fold(0.0_f64, |m, v| m.max(*v));
            for (k, value) in eigen.eigenvalues.iter().enumerate() {
                if *value <= FREE * largest {
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
        let moving = |body: &usize| part(*body).iter().any(|v| v.abs() > 1e-9);
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
