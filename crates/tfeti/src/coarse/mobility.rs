//! Rigid motions of whole bodies that no row of `B` stops.
//!
//! The rank of `G W G^T` is decided here and not by small pivots: the interface rows join subdomains to bodies, and a
//! vector of its null space is a rigid motion of bodies that all other rows of positive weight leave alone. That is an
//! eigenvalue problem of six unknowns a body, with a clear gap however long or finely divided the body is. Subdomains
//! that share an edge or a node only are bodies of their own: the rows between them leave a hinge free.

use crate::coarse::joints::{joint_rows, rigid_pairs};
use crate::coarse::matrix::CoarseMatrix;
use crate::linalg::entry;
use crate::linalg::sparse::{Columns, SolveMemory, SparseCholesky, Symbolic};
use crate::rows::gluing::{CopyEntry, Gluing};
use crate::subdomain::kernel::{Kernel, displacement, mean};
use crate::subdomain::matrices::Subdomains;
use crate::tolerances::{FREE, INVERSE_STEPS, LARGE_GROUP, MOVING, NO_ACTION};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use signorini_fem_mesh::internal::{DisjointSets, Lists, count_of, distinct};
use signorini_fem_mesh::vec3::{dot, sub};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

/// What a row does to the motions of bodies.
type Row = Vec<(usize, [f64; 6])>;

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
    joints: Vec<Row>,
}

/// Gram matrix of the actions of rows on bodies that they join.
struct Gram(Columns);

impl Gram {
    /// Rows act on bodies by their places among `count`.
    fn new<'a>(count: usize, place: &[u32], rows: impl Iterator<Item = &'a Row> + Clone) -> Self {
        let mut lower: Vec<Vec<u32>> = (0..count as u32).map(|k| vec![k]).collect();
        let pairs = |row: &'a Row| row.iter().flat_map(move |a| row.iter().map(move |b| (a, b)));
        let places = rows.clone().flat_map(pairs).map(|(a, b)| [place[a.0], place[b.0]]);
        places
            .filter(|[a, b]| a > b)
            .for_each(|[a, b]| lower[b as usize].push(a));
        let columns = lower.into_iter().map(|list| (distinct(list), Vec::new()));
        let matrix = CoarseMatrix::of_columns(columns);
        let mut values = vec![0.0; matrix.pattern().rows.len()];
        for ((a, ga), (b, gb)) in rows.flat_map(pairs).filter(|(a, b)| place[a.0] >= place[b.0]) {
            matrix.add_block(place[*a], place[*b], &ga.map(|v| gb.map(|w| v * w)), &mut values);
        }
        let pattern = matrix.pattern().clone();
        Self(Columns { values, ..pattern })
    }

    fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let column = |j| {
            let (rows, values) = self.0.column(j);
            rows.iter().zip(values).map(move |(&i, &v)| (i, j, v))
        };
        (0..self.0.dim).flat_map(column)
    }

    /// The largest sum of a row: no eigenvalue is larger.
    fn bound(&self) -> f64 {
        let mut sums = vec![0.0; self.0.dim];
        for (i, j, v) in self.entries() {
            sums[j] += v.abs();
            if i / 6 != j / 6 {
                sums[i] += v.abs();
            }
        }
        sums.into_iter().fold(0.0, f64::max)
    }

    /// A factor of the matrix with more on its diagonal.
    fn factor(&self, more: f64) -> Option<SparseCholesky> {
        let mut matrix = self.0.clone();
        let diagonal = (0..matrix.dim).filter_map(|k| self.0.find(k, k));
        diagonal.for_each(|k| matrix.values[k] += more);
        let pattern = Symbolic::new(&matrix, 6).ok()?;
        SparseCholesky::new(&pattern, &matrix).ok()
    }

    /// Orthonormal motions that the rows leave free.
    fn free(&self) -> Vec<DVector<f64>> {
        // most are held, which a factor tells sooner than eigenvalues
        let (dim, bound) = (self.0.dim, self.bound());
        if self.factor(-(FREE * bound).max(NO_ACTION)).is_some() {
            return Vec::new();
        }
        if let Some(found) = (dim > LARGE_GROUP).then(|| self.few_free(bound)).flatten() {
            return found;
        }
        let mut dense = DMatrix::zeros(dim, dim);
        for (i, j, v) in self.entries() {
            (dense[(i, j)], dense[(j, i)]) = (v, v);
        }
        let eigen = SymmetricEigen::new(dense);
        let least = (FREE * eigen.eigenvalues.max()).max(NO_ACTION);
        let free = (0..dim).filter(|&k| eigen.eigenvalues[k] <= least);
        free.map(|k| eigen.eigenvectors.column(k).into()).collect()
    }

    /// The same by inverse iteration, where they are few among many bodies.
    fn few_free(&self, bound: f64) -> Option<Vec<DVector<f64>>> {
        let (dim, least) = (self.0.dim, FREE * bound);
        let factor = self.factor(10.0 * least)?;
        let mut count = 8;
        while 8 * count <= dim {
            let mut memory = SolveMemory::new(factor.need(count));
            // without structure
            let mut x = DMatrix::from_fn(dim, count, |i, j| (1e4 * ((i * count + j + 1) as f64).sin()).fract());
            for _ in 0..INVERSE_STEPS {
                factor.solve(x.as_mut_slice(), count, &mut memory);
                x = x.qr().q();
            }
            let mut product = DMatrix::zeros(dim, count);
            for (i, j, v) in self.entries() {
                let both = [(i, j), (j, i)];
                for &(i, j) in &both[..if i / 6 == j / 6 { 1 } else { 2 }] {
                    (0..count).for_each(|k| product[(i, k)] += v * x[(j, k)]);
                }
            }
            let small = SymmetricEigen::new(x.tr_mul(&product));
            let free: Vec<usize> = (0..count).filter(|&k| small.eigenvalues[k] <= least).collect();
            if free.len() < count {
                let way = |k: &usize| small.eigenvectors.column(*k);
                let found = free.iter().all(|k| (&product * way(k)).norm() <= 10.0 * least);
                return found.then(|| free.iter().map(|k| &x * way(k)).collect());
            }
            count *= 4;
        }
        None
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
    pub(crate) fn free(&self, rows: impl Iterator<Item = Row>) -> Vec<FreeMotion> {
        let rows = rows.chain(self.joints.iter().cloned()).filter(|row| !row.is_empty());
        let rows: Vec<Row> = rows.collect();
        let mut sets = DisjointSets::new(self.bodies.len());
        for row in &rows {
            sets.join_all(row.iter().map(|action| action.0));
        }
        let of = sets.numbers();
        let groups = Lists::by_number(&of);
        let mut place = vec![0; of.len()];
        for (&body, k) in groups.iter().flat_map(|group| group.iter().zip(0..)) {
            place[body as usize] = k;
        }
        let keys: Vec<u32> = rows.iter().map(|row| of[row[0].0]).collect();
        let rows_of = Lists::by_key(groups.count(), &keys);
        let mut out = Vec::new();
        for (g, group) in groups.iter().enumerate() {
            let gram = Gram::new(
                group.len(),
                &place,
                rows_of.of(g).iter().map(|&row| &rows[row as usize]),
            );
            for own in gram.free() {
                let mut vector = vec![0.0; 6 * self.bodies.len()];
                for (c, v) in own.iter().enumerate() {
                    vector[6 * group[c / 6] as usize + c % 6] = *v;
                }
                out.push(self.describe(&vector));
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
        let moved = |m: &FreeMotion| m.bodies.iter().map(|b| self.part_of[b.subdomain]).collect::<Vec<u32>>();
        let mut sets = DisjointSets::new(self.bodies.len());
        for motion in free {
            sets.join_all(moved(motion).into_iter().map(|body| body as usize));
        }
        let of = sets.numbers();
        // the motions, and the bodies, of each set
        let mut groups: BTreeMap<u32, (Vec<&FreeMotion>, Vec<u32>)> = BTreeMap::new();
        for motion in free {
            let bodies = moved(motion);
            let group = groups.entry(bodies.first().map_or(0, |body| of[*body as usize]));
            let group = group.or_default();
            group.0.push(motion);
            group.1.extend(bodies);
        }
        let of_group = |(motions, bodies): &(Vec<&FreeMotion>, Vec<u32>)| self.springs_of(motions, bodies);
        groups.values().flat_map(of_group).collect()
    }

    /// The same for motions of some bodies: Gaussian elimination with full pivoting on the amplitudes of each body's
    /// first subdomain.
    fn springs_of(&self, free: &[&FreeMotion], bodies: &[u32]) -> Vec<(usize, [f64; 6])> {
        let bodies = distinct(bodies.iter().copied()).into_iter();
        let first: Vec<usize> = bodies.map(|body| self.bodies[body as usize].first).collect();
        let row = |m: &&FreeMotion| first.iter().flat_map(|s| m.amplitudes[6 * s..][..6].to_vec()).collect();
        let mut rows: Vec<Vec<f64>> = free.iter().map(row).collect();
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
            springs.push((first[column / 6], spring));
        }
        springs
    }
}
