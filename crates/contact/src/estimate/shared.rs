//! Moves of nodes that several contact points share, as in meshes of order 2: all at once.
//!
//! The change of the displacement that gives all contact and tied rows the values wanted, and is smallest in a norm
//! weighted by stiffness, is `C Pᵀ y` with `P C Pᵀ y` what is missing: rows `P`, compliances `C`. The matrix is like a
//! mass matrix of the surface, so that conjugate gradients need few iterations.

use crate::model::Model;
use crate::tolerances::{SHARED_MOVES, SHARED_ROUNDS, SHARED_STOP};
use signorini_qp::active_set::{ActiveSetPoint, ActiveSetProblem, ActiveSetWorkspace};
use signorini_qp::problem::Diagonal;
use signorini_qp::{ActiveSetSettings, DenseProjector, MovingSet, ProductSet, SymmetricOperator, active_set, vector};
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
    /// Inverse of the diagonal of the matrix.
    inverse: Diagonal,
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
        let row = |row: usize, scale: f64| -> Vec<(usize, f64)> {
            let mut sums: BTreeMap<usize, f64> = BTreeMap::new();
            for (node, c, coefficient) in model.row(row) {
                *sums.entry(3 * node as usize + c).or_insert(0.0) += coefficient / scale;
            }
            sums.into_iter().collect()
        };
        let of_points = (model.points.iter()).flat_map(|p| p.directions().take(1).chain(p.isotropic()));
        let mut rows: Vec<_> = of_points.map(|(_, number, scale)| row(number, scale)).collect();
        rows.extend(tied.clone().map(|number| row(number, 1.0)));
        let mut stiffness = vec![0.0; discrete.decomposition.nodes()];
        for (k, node) in discrete.decomposition.torn_nodes().enumerate() {
            if let Some(node) = node {
                stiffness[node as usize] += model.copies().weight(k);
            }
        }
        let compliance: Vec<f64> = stiffness.iter().flat_map(|s| [1.0 / s; 3]).collect();
        let square = |row: &Vec<(usize, f64)>| row.iter().map(|&(at, v)| v * v * compliance[at]).sum::<f64>();
        let inverse = Diagonal::new(rows.iter().map(square).map(f64::recip).collect()).ok()?;
        Some(Self {
            rows,
            tied,
            compliance,
            inverse,
        })
    }

    /// Moves the displacement `v` such that rows of points have these values, m, and tied rows their `offset`.
    pub(crate) fn reach(&self, mut targets: Vec<f64>, offset: &[f64], v: &mut [f64]) {
        targets.extend_from_slice(&offset[self.tied.clone()]);
        let value = |row: &Vec<(usize, f64)>, v: &[f64]| row.iter().map(|&(at, c)| c * v[at]).sum::<f64>();
        let size = vector::max_abs(&targets).max(vector::max_abs(v));
        // neither a set nor an equality
        let (n, mut set) = (self.dim(), ProductSet::free(self.dim()));
        let Ok(mut projector) = DenseProjector::new(0, n, Vec::new()) else {
            return;
        };
        let settings = ActiveSetSettings::default().with_tolerance(SHARED_STOP);
        let settings = settings.with_max_products(SHARED_MOVES);
        let mut work = ActiveSetWorkspace::new(self, &self.inverse);
        let mut moved = vec![0.0; v.len()];
        for _ in 0..SHARED_ROUNDS {
            let rows = self.rows.iter().zip(&targets);
            let missing: Vec<f64> = rows.map(|(row, target)| target - value(row, v)).collect();
            if vector::max_abs(&missing) <= SHARED_STOP * size {
                return;
            }
            let problem = ActiveSetProblem {
                operator: self,
                preconditioner: &self.inverse,
                scale: self.inverse.entries(),
                linear: &missing,
                rhs: &[],
            };
            let (mut y, mut product) = (vec![0.0; n], vec![0.0; n]);
            // as far as rows depend on one another the result is one of many
            let (x, ax, known) = (&mut y[..], &mut product[..], true);
            let (set, point) = (MovingSet::fixed(&mut set), ActiveSetPoint { x, ax, known });
            let solved = active_set(&problem, &mut projector, set, point, &settings, &mut work);
            if solved.is_err() {
                return;
            }
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
}

/// `P C Pᵀ`
impl SymmetricOperator for SharedNodes {
    type Scratch = Vec<f64>;

    fn dim(&self) -> usize {
        self.rows.len()
    }

    fn scratch(&self) -> Vec<f64> {
        vec![0.0; self.compliance.len()]
    }

    fn apply(&self, x: &[f64], y: &mut [f64], moved: &mut Vec<f64>) {
        self.spread(x, moved);
        for (row, y) in self.rows.iter().zip(y) {
            *y = row.iter().map(|&(at, c)| c * moved[at]).sum();
        }
    }
}
