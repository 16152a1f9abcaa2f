//! Forces, moments and energy of every step, from the mesh, the nodal displacements and the reported contact forces
//! only: nothing of the solver is used.
//!
//! With nodal internal forces `K u`, loads `f`, contact forces `c` and reactions `R` (at supported nodes only),
//! `K u = f + c + R` at every node. What is reported:
//!
//! - *force*: norm of the sum of `f + c + R` over all nodes, relative to the sum of the norms of these forces;
//! - *moment*: the same for moments about the centre of the body, with the half diagonal as lever;
//! - *energy*: `E1 - E0` against the work of the mean forces `(f + c + R)` of the two steps in the step `u1 - u0`.
//!   For linear elasticity this is an identity, so it measures the forces, not the step;
//! - *dissipation*: friction force of the new step times the tangential difference; never negative;
//! - *surplus*: what a step loses beyond friction because forces of its end do the work. It is
//!   `(u1 - u0) K (u1 - u0) / 2` exactly: loads and reactions of the end do the work `E1 - E0 + D_n + D_t +
//!   surplus`, with `D_t = -c_t (u1 - u0)` and `D_n = -c_n (u1 - u0) >= 0` (nodes that close do it once). It is of
//!   first order in the step.

use signorini::fem_mesh::{Decomposition, assemble_load, assemble_stiffness};
use signorini::prelude::*;
use signorini_studies::Failure;

/// Largest relative errors of the balances over all steps so far; see the [module](self).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Balance {
    /// Forces.
    pub(crate) force: f64,
    /// Moments.
    pub(crate) moment: f64,
    /// Energy of a step.
    pub(crate) energy: f64,
    /// Most negative dissipation of a step, relative to the energy turned over so far; positive when violated.
    pub(crate) negative_dissipation: f64,
    /// Dissipation so far, J.
    pub(crate) dissipation: f64,
    /// Surplus so far, J.
    pub(crate) surplus: f64,
}

/// Part of displacement times stiffness below which forces are measured against it.
const ROUNDED: f64 = 1e-8;
/// The same for energies.
const ROUNDED_WORK: f64 = 1e-10;

impl Balance {
    /// The largest of the errors.
    pub(crate) fn largest(&self) -> f64 {
        [self.moment, self.energy, self.negative_dissipation]
            .into_iter()
            .fold(self.force, worse)
    }
}

/// Keeps what the balances of successive steps need.
pub(crate) struct Ledger {
    rows: Vec<Vec<(usize, f64)>>,
    diagonal: Vec<f64>,
    loads: Vec<(Vec<f64>, History)>,
    supported: Vec<bool>,
    arms: Vec<[f64; 3]>,
    before: Option<Kept>,
    turnover: f64,
    /// Nodes of each contact point with their weights.
    points: Vec<Vec<(u32, f64)>>,
    /// The step before the first one entered is not known.
    resumed: bool,
    /// The result.
    pub(crate) balance: Balance,
}

struct Kept {
    u: Vec<f64>,
    force: Vec<f64>,
    energy: f64,
}

impl Ledger {
    /// Prepares the stiffness and the loads of a scene.
    pub(crate) fn new(
        scene: &Scene,
        loads: &[(LoadDensity, History)],
        simulation: &Simulation,
    ) -> Result<Self, Failure> {
        let mesh = scene.mesh();
        let hookes = scene.materials().of_tets(mesh.regions())?;
        let stiffness = assemble_stiffness(mesh.points(), mesh.tets(), |t| hookes[t])?;
        let diagonal = (0..stiffness.rows()).map(|i| stiffness.get(i, i).copied().unwrap_or(0.0));
        let diagonal = diagonal.collect();
        let rows = stiffness
            .outer_iterator()
            .map(|row| row.iter().map(|(j, v)| (j, *v)).collect())
            .collect();
        let whole = Decomposition::whole(mesh);
        let mut nodal = Vec::with_capacity(loads.len());
        for (density, history) in loads {
            let local = assemble_load(mesh, &whole, density)?;
            let mut force = vec![0.0; 3 * mesh.points().len()];
            for (part, f) in whole.subdomains().iter().zip(&local) {
                for (&node, v) in part.nodes.iter().zip(f.chunks_exact(3)) {
                    let at = 3 * node as usize;
                    force[at..at + 3].iter_mut().zip(v).for_each(|(f, v)| *f += v);
                }
            }
            nodal.push((force, history.clone()));
        }
        let mut supported = vec![false; mesh.points().len()];
        let gluing = simulation.tfeti().gluing();
        for row in gluing.ranges().dirichlet.clone() {
            if let Some(node) = gluing.node(row) {
                supported[node as usize] = true;
            }
        }
        let (low, high) = mesh.extent();
        let half = 0.5 * (0..3).map(|c| (high[c] - low[c]).powi(2)).sum::<f64>().sqrt();
        let arm = |p: &[f64; 3]| std::array::from_fn(|c| (p[c] - 0.5 * (low[c] + high[c])) / half);
        Ok(Self {
            rows,
            diagonal,
            loads: nodal,
            supported,
            arms: mesh.points().iter().map(arm).collect(),
            before: None,
            points: simulation
                .constrained_points()
                .iter()
                .map(|p| p.nodes().collect())
                .collect(),
            turnover: 0.0,
            resumed: false,
            balance: Balance::default(),
        })
    }

    /// The first step entered continues one that is not known: its step has no energy balance.
    pub(crate) fn skip_first_step(&mut self) {
        self.resumed = true;
    }

    /// Sum of the nodal loads at a time, N.
    pub(crate) fn load(&self, time: f64) -> Vec<f64> {
        let mut f = vec![0.0; 3 * self.arms.len()];
        for (force, history) in &self.loads {
            let h = history.value(time);
            for (f, v) in f.iter_mut().zip(force) {
                *f += h * v;
            }
        }
        f
    }

    /// Enters a step.
    pub(crate) fn enter(&mut self, result: &StepResult) {
        let u = result.displacement().into_flattened();
        let internal: Vec<f64> = self
            .rows
            .iter()
            .map(|row| row.iter().map(|&(j, v)| v * u[j]).sum())
            .collect();
        let mut applied = self.load(result.time());
        for (state, nodes) in result.points().iter().zip(&self.points) {
            let force = state.force();
            for (node, weight) in nodes {
                for c in 0..3 {
                    applied[3 * *node as usize + c] += weight * force[c];
                }
            }
        }
        for (node, supported) in self.supported.iter().enumerate() {
            if *supported {
                let at = 3 * node;
                applied[at..at + 3].copy_from_slice(&internal[at..at + 3]);
            }
        }
        let (mut sum, mut moment, mut size) = ([0.0; 3], [0.0; 3], 0.0);
        for (f, r) in applied.chunks_exact(3).zip(&self.arms) {
            for c in 0..3 {
                sum[c] += f[c];
                let (a, b) = ((c + 1) % 3, (c + 2) % 3);
                moment[c] += r[a] * f[b] - r[b] * f[a];
            }
            size += length(f);
        }
        // rounding errors of K u, where the body moves without strain
        let (mut stiff, mut worked) = (0.0, 0.0);
        for (k, u) in self.diagonal.iter().zip(&u) {
            stiff += k * u.abs();
            worked += k * u * u;
        }
        size = size.max(ROUNDED * stiff);
        let b = &mut self.balance;
        b.force = worse(b.force, ratio(length(&sum), size));
        b.moment = worse(b.moment, ratio(length(&moment), size));
        let energy = 0.5 * dot(&u, &internal);
        let zero = Kept {
            u: vec![0.0; u.len()],
            force: vec![0.0; u.len()],
            energy: 0.0,
        };
        let known = self.before.is_some() || !self.resumed;
        let before = self.before.take().unwrap_or(zero);
        let (mut work, mut surplus, mut turned) = (0.0, 0.0, 0.0);
        for (i, row) in self.rows.iter().enumerate() {
            let du = u[i] - before.u[i];
            work += 0.5 * (applied[i] + before.force[i]) * du;
            turned += (0.5 * (applied[i] + before.force[i]) * du).abs();
            surplus += 0.5 * du * row.iter().map(|&(j, v)| v * (u[j] - before.u[j])).sum::<f64>();
        }
        if known {
            self.turnover += turned;
            let scale = self.turnover.max(energy).max(ROUNDED_WORK * worked);
            b.energy = worse(b.energy, ratio((energy - before.energy - work).abs(), scale));
            let dissipation = result.summary().dissipation;
            b.negative_dissipation = worse(b.negative_dissipation, ratio(-dissipation, scale));
            b.dissipation += dissipation;
            b.surplus += surplus;
        }
        self.before = Some(Kept {
            u,
            force: applied,
            energy,
        });
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn length(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}

/// The larger one; not a number if one is none.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

fn ratio(a: f64, b: f64) -> f64 {
    if a <= 0.0 { 0.0 } else { a / b }
}
