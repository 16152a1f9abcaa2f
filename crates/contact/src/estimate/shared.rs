//! Moves of nodes that several contact points share, as in meshes of order 2: all at once.
//!
//! The change of the displacement that gives all contact and tied rows the values wanted, and is smallest in a norm
//! weighted by stiffness, is `C Pᵀ y` with `P C Pᵀ y` what is missing: rows `P`, compliances `C`. The matrix is like a
//! mass matrix of the surface, so that conjugate gradients need few iterations.

use crate::model::Model;
use crate::tolerances::{SHARED_MOVES, SHARED_ROUNDS, SHARED_STOP};
use signorini_qp::vector;
use std::collections::BTreeMap;

/// The rows of points that share nodes.
#[derive(Debug)]
pub(crate) struct SharedNodes {
    /// Coefficients of each row on the displacement of the nodes, in metres: the normal row of each point and those
    /// along the surface, point by point, then tied rows.
    rows: Vec<Vec<(usize, f64)>>,
    /// The rows of tied contacts.
    tied: std::ops::Range<usize>,
    /// Of each displacement component of a node, relative.
    compliance: Vec<f64>,
    /// Diagonal of the matrix.
    diagonal: Vec<f64>,
}

impl SharedNodes {
    /// `None` where each point has a node of its own.
    pub(crate) fn new(model: &Model) -> Option<Self> {
        let (gluing, discrete) = (model.tfeti.gluing(), &model.discrete);
        let own = |k: usize| model.points[k].contact.sides.own.nodes().len();
        let tied = gluing.ranges().tied.clone();
        if (0..model.points.len()).all(|k| own(k) < 2) && discrete.ties.iter().all(|t| t.sides.own.nodes().len() < 2) {
            return None;
        }
        let subdomains = discrete.decomposition.subdomains();
        let row = |row: usize, scale: f64| -> Vec<(usize, f64)> {
            let mut sums: BTreeMap<usize, f64> = BTreeMap::new();
            for (subdomain, dof, coefficient) in gluing.row(row) {
                let node = subdomains[subdomain].nodes[dof / 3] as usize;
                *sums.entry(3 * node + dof % 3).or_insert(0.0) += coefficient / scale;
            }
            sums.into_iter().collect()
        };
        let of_points = (model.points.iter()).flat_map(|p| p.directions().take(1).chain(p.isotropic()));
        let mut rows: Vec<_> = of_points.map(|(_, number, scale)| row(number, scale)).collect();
        rows.extend(tied.clone().map(|number| row(number, 1.0)));
        let mut stiffness = vec![0.0; discrete.decomposition.nodes()];
        let copies = subdomains.iter().flat_map(|s| &s.nodes);
        for (k, &node) in copies.enumerate() {
            stiffness[node as usize] += model.copies().weight(k);
        }
        let compliance: Vec<f64> = stiffness.iter().flat_map(|s| [1.0 / s; 3]).collect();
        let square = |row: &Vec<(usize, f64)>| row.iter().map(|&(at, v)| v * v * compliance[at]).sum();
        let diagonal = rows.iter().map(square).collect();
        Some(Self {
            rows,
            tied,
            compliance,
            diagonal,
        })
    }

    /// Moves the displacement `v` such that rows of points have these values, m, and tied rows their `offset`.
    pub(crate) fn reach(&self, mut targets: Vec<f64>, offset: &[f64], v: &mut [f64]) {
        targets.extend_from_slice(&offset[self.tied.clone()]);
        let value = |row: &Vec<(usize, f64)>, v: &[f64]| row.iter().map(|&(at, c)| c * v[at]).sum::<f64>();
        let size = vector::max_abs(&targets).max(vector::max_abs(v));
        let mut moved = vec![0.0; v.len()];
        for _ in 0..SHARED_ROUNDS {
            let missing = self
                .rows
                .iter()
                .zip(&targets)
                .map(|(row, target)| target - value(row, v));
            let missing: Vec<f64> = missing.collect();
            if vector::max_abs(&missing) <= SHARED_STOP * size {
                return;
            }
            let y = self.solve(missing, &mut moved);
            self.spread(&y, &mut moved);
            vector::axpy(1.0, &moved, v);
        }
    }

    /// `C Pᵀ y`
    fn spread(&self, y: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (row, y) in self.rows.iter().zip(y) {
            row.iter().for_each(|&(at, c)| out[at] += c * y * self.compliance[at]);
        }
    }

    /// Conjugate gradients, scaled by the diagonal; as far as rows depend on one another the result is one of many.
    fn solve(&self, mut r: Vec<f64>, work: &mut [f64]) -> Vec<f64> {
        let n = r.len();
        let scaled = |r: &[f64]| -> Vec<f64> { r.iter().zip(&self.diagonal).map(|(r, d)| r / d).collect() };
        let (mut y, mut z, mut image) = (vec![0.0; n], scaled(&r), vec![0.0; n]);
        let (mut p, mut rz) = (z.clone(), vector::dot(&r, &z));
        let stop = SHARED_STOP * SHARED_STOP * rz;
        for _ in 0..SHARED_MOVES {
            if rz <= stop || rz.is_nan() {
                break;
            }
            self.spread(&p, work);
            for (row, image) in self.rows.iter().zip(&mut image) {
                *image = row.iter().map(|&(at, c)| c * work[at]).sum();
            }
            let step = rz / vector::dot(&p, &image);
            vector::axpy(step, &p, &mut y);
            vector::axpy(-step, &image, &mut r);
            z = scaled(&r);
            let next = vector::dot(&r, &z);
            let turn = next / rz;
            p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + turn * *p);
            rz = next;
        }
        y
    }
}
