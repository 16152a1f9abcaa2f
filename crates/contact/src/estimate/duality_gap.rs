//! Estimate of the algebraic error of a level by the duality gap.
//!
//! Let `K` be the stiffness, `f` the load, `g` the gaps, `z` the tangential positions of rest, `r` the slip
//! bounds, `u*` the solution of the discrete problem with given bounds `r`: the minimiser of
//!
//! ```text
//! J(v) = 1/2 vᵀ K v - fᵀ v + sum r |v_T - z|      over continuous v that obey the supports and v_nu <= g.
//! ```
//!
//! The recovered displacement `u` of the torn body is in equilibrium with the multipliers, `K u = f + Bᵀ lambda`
//! (5.26), but only nearly continuous and only nearly admissible. Make from it a continuous, admissible `v`: the
//! mean of the copies of each node weighted by their stiffness, moved at contact nodes (below), set to the supports.
//! Then `fᵀ v = uᵀ K v - lambdaᵀ B v`, gluing and supports drop out of `lambdaᵀ (B v - c)`, and
//!
//! ```text
//! J(v) = 1/2 |v - u|² - 1/2 |u|² + lambdaᵀ B v + sum r |v_T - z|,        |w|² = wᵀ K w, torn
//! D    = inf over v of the Lagrangian = -1/2 |u|² + lambdaᵀ c            (dual value of lambda)
//! gap  = J(v) - D
//!      = 1/2 |v - u|² + sum lambda_nu (v_nu - g) + sum ( r |v_T - z| + lambda_T . (v_T - z) )  >= 0.
//! ```
//!
//! All three terms are non-negative if `lambda_nu <= 0` and `|lambda_T| <= r`. `J` grows at least quadratically from
//! its minimum, `J(v) - J(u*) >= 1/2 |v - u*|²`, and so does `-D`, `J(u*) - D >= 1/2 |u - u*|²`. Their sum is the gap:
//!
//! ```text
//! 1/2 |v - u*|² + 1/2 |u - u*|² <= gap.
//! ```
//!
//! This bounds the errors of `v` and of the torn displacement at once, without any constant.
//!
//! **The mean that is handed out** ([`StepResult::displacement`](crate::StepResult::displacement)), the plain one of the copies, is neither: it is not moved, and does not
//! obey the supports better than the copies do. Subdomains that are off as a whole strain nothing while they are torn, and much in the
//! mean; its error was up to four times the bound. So the estimate is at least `1/2 |mean - v|²`. By the triangle inequality it is
//! then no less than half the error of the mean, as a norm.
//!
//! **The move at contact nodes.** Every admissible `v` gives a bound; a good one costs little. At a node with
//! stiffness `k` in the direction of the row, the move that minimises the gap with all other nodes held is
//! `v_nu - g <- min(0, v_nu - g - lambda_nu / k)`, and `v_T - z` goes to `w = v_T - z - lambda_T / k` shortened by
//! `r / k`. Pressed nodes come to lie on the obstacle, sticking ones at rest, sliding ones move against their friction.
//!
//! **What is not exact.**
//! - *Pulling forces* (`lambda_nu > 0`, by the tolerance) enter as `|lambda_nu (v_nu - g)|`.
//! - *Friction off its bound.* Solvers stop with `|lambda_T|` a little above or below the `r` of a sliding node: slip
//!   bounds still move. First order in `r - |lambda_T|`, the gap would overrate this. Where they differ by less than a
//!   hundredth the bound belongs
//!   to the problem with `r' = |lambda_T|`, and the way from `r'` to `r` adds, as an error norm, that of the force
//!   `r - r'` on the node with its own stiffness `k`: `sqrt(sum (r - r')² / (2 k))`. The body is softer than one node;
//!   this part is an estimate.
//! - *Equilibrium of subdomains as rigid bodies* holds to rounding with the face method, to the tolerance with SMALSE. The
//!   unbalanced rest is then carried by gluing and support forces, `lambda' = lambda + W Gᵀ (G W Gᵀ)⁻¹ (e - G lambda)` with
//!   weights `W` that leave contact forces alone, and `u' = u + K+ Bᵀ (lambda' - lambda)` takes the place of `u`: one
//!   more product. If contact alone holds the body, the rest `q = K u - f - Bᵀ lambda` adds its norm times that of `v - u`.
//! - *Coulomb friction.* `r = F |lambda_nu|` is taken from the level's own `lambda_nu`, so `u*` is the solution of
//!   *its* given-friction problem, one evaluation of the map (3.15) away. With contraction rate `q` of the map the distance
//!   to its fixed point is at most `1 / (1 - q)` times the estimate; `q` is about 0.06 on the benchmark. Where the
//!   map is not contractive the estimate says nothing about the Coulomb problem.
//! - *Nodes in edges* of obstacles are moved out of one after the other, ten times. Between obstacles that are not
//!   perpendicular a small depth may be left.
//! - *The level before* is taken as it is: errors of old tangential positions are not in the estimate.
//!   [`AccumulatedError`](crate::AccumulatedError) adds them up.
//!
//! # At rest
//!
//! A relative error needs something to compare with. Where nothing is strained (loads on supported nodes, a body that is
//! unloaded again, one that only moves with its supports) the elastic energy is rounding, and an error relative to it
//! would be about one whatever is done. [`AlgebraicError::scale`] therefore is the largest of
//!
//! - the elastic energy,
//! - `1/2 sum |f|² / k`: what the load of each node would do to it with all others held. A body that is free to give way
//!   has more elastic energy than a quarter of this,
//! - `1e-6 / 2` times the largest norm of the multipliers times the largest displacement of the levels before: a thousandth of
//!   both,
//! - `1e-12 / 2 sum k |u|²`: below it elastic energies are rounding.
//!
//! With no load, no displacement and no level before there is nothing wrong either, and the relative error is 0.

use super::admissible::{Movable, Moved};
use crate::model::{ConstrainedPoint, Model};
use crate::report::AlgebraicError;
use crate::result::{Certificate, PointState};
use crate::step::StepProblem;
use crate::tolerances::REST;
use crate::vec3::dot;
use nalgebra::{DMatrix, DVector};
use signorini_fem_mesh::StrainRecovery;
use signorini_qp::vector;
use signorini_tfeti::{CoarseFactor, CopyStiffness, RowWeights, Tfeti};
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// Moves out of one obstacle after another, for nodes in edges; one is enough between perpendicular ones.
const SWEEPS: usize = 10;

/// Planes of one node count as parallel below this singular value over the largest.
const PARALLEL: f64 = 1e-6;

/// Relative imbalance that counts as rounding.
const BALANCED: f64 = 1e-12;

/// Elastic energy that may be rounding, relative to that of all nodes moved alone: elastic energies of bodies that move without
/// strain are differences of numbers this much larger, or more.
const ROUNDED: f64 = 1e-12;

/// Stiffnesses that weigh contact nodes, computed once when first needed.
#[derive(Debug)]
pub(crate) struct Weights {
    /// Stiffness in the direction of the contact rows, N/m, by row.
    rows: Vec<f64>,
    /// What moves at each contact point.
    movable: Vec<Movable>,
    /// Made where a level needs it: solvers of the face method leave nothing to balance.
    interior: OnceLock<Option<CoarseFactor>>,
}

impl Weights {
    pub(crate) fn new(model: &Model) -> Self {
        let contact = model.tfeti.gluing().ranges().contact().end;
        let mut rows = vec![0.0; contact];
        model.tfeti.row_stiffness(0..contact, &mut rows);
        Self {
            rows,
            movable: model
                .points
                .iter()
                .map(|p| Movable::new(model, p))
                .collect(),
            interior: OnceLock::new(),
        }
    }

    /// Coarse problem of gluing and supports alone; `None` if contact is needed to hold the body.
    fn interior(&self, tfeti: &Tfeti) -> Option<&CoarseFactor> {
        let factor = || {
            let mut weights = vec![1.0; tfeti.dual_dim()];
            weights[..self.rows.len()].fill(0.0);
            let factor = tfeti
                .coarse()
                .factor_weighted(RowWeights::diagonal(weights));
            factor.ok().filter(|f| f.free_motions().is_empty())
        };
        self.interior.get_or_init(factor).as_ref()
    }
}

/// What estimates need of a model, made when it is first asked for.
#[derive(Debug, Default)]
pub(crate) struct Caches {
    weights: OnceLock<Weights>,
    /// Patches of the estimate of the discretisation error.
    pub(crate) recovery: OnceLock<StrainRecovery>,
}

/// What the estimate needs of a solved level.
pub(crate) struct Solved<'a> {
    pub(crate) model: &'a Model,
    pub(crate) caches: &'a Caches,
    pub(crate) level: &'a StepProblem,
    pub(crate) points: &'a [PointState],
    pub(crate) certificate: &'a Certificate,
    pub(crate) torn: &'a [f64],
    /// `K u - f - Bᵀ lambda`, torn, N.
    pub(crate) residual: &'a [f64],
}

impl Solved<'_> {
    pub(crate) fn algebraic_error(&self) -> AlgebraicError {
        let model = self.model;
        let tfeti = &model.tfeti;
        let weights = self.caches.weights.get_or_init(|| Weights::new(model));
        let mut v = self.mean(model.copies());
        let mean = (tfeti.subdomains() > 1).then(|| tfeti.nodal_mean(self.torn));
        let places = || self.points.iter().zip(&model.points).zip(&weights.movable);
        let moved: Vec<Moved> = places()
            .map(|((point, touch), movable)| {
                Moved::new(touch, point, (self.level, movable), &weights.rows, &mut v)
            })
            .collect();
        self.support(&mut v);
        self.agree(&moved, &weights.movable, &mut v);
        let (mut terms, mut change) = (0.0, 0.0);
        for (((point, touch), movable), moved) in places().zip(&moved) {
            let place = movable.place(self.level, touch, &v);
            terms += moved.gap(point, &place, movable.value(&mut v));
            change += moved.change;
        }
        // torn difference and its energy
        let balanced = self.balanced(weights);
        let torn = balanced.as_deref().unwrap_or(self.torn);
        let subdomains = model.decomposition.subdomains();
        let nodes = || subdomains.iter().flat_map(|s| &s.nodes);
        let mut difference = torn.to_vec();
        for (d, &node) in difference.chunks_exact_mut(3).zip(nodes()) {
            (0..3).for_each(|c| d[c] -= v[3 * node as usize + c]);
        }
        let energy = |u: &[f64]| {
            let mut force = vec![0.0; u.len()];
            tfeti.stiffness_times(u, &mut force);
            vector::dot(u, &force)
        };
        // from v to the mean that is handed out
        let beside = mean.map_or(0.0, |mean| {
            let off = |&node: &u32| {
                let at = 3 * node as usize;
                [0, 1, 2].map(|c| mean[at + c] - v[at + c])
            };
            let off: Vec<f64> = nodes().flat_map(off).collect();
            0.5 * energy(&off)
        });
        let (elastic, energy) = (energy(torn), energy(&difference));
        if balanced.is_none() && !self.is_balanced() {
            terms += vector::norm(self.residual) * vector::norm(&difference);
        }
        let distance = 0.5 * energy.max(0.0);
        let gap = distance + terms;
        let elastic = 0.5 * elastic.max(0.0);
        AlgebraicError {
            // the square of the sum of two norms
            energy: (gap + change + 2.0 * gap.sqrt() * change.sqrt()).max(beside),
            distance,
            elastic,
            scale: elastic.max(self.scale_at_rest(torn)),
        }
    }

    /// What an energy is compared with where the body is at rest, J.
    fn scale_at_rest(&self, torn: &[f64]) -> f64 {
        let (model, copies) = (self.model, self.model.copies());
        let force = self.level.forces(model);
        let (mut alone, mut moved) = (0.0_f64, 0.0);
        for (k, (f, u)) in force.chunks_exact(3).zip(torn.chunks_exact(3)).enumerate() {
            let stiffness = copies.weight(k);
            alone += dot(f, f) / stiffness;
            moved += dot(u, u) * stiffness;
        }
        let works = self.level.peaks.iter();
        let before = REST * REST * works.map(|p| p.multipliers * p.displacement).sum::<f64>();
        0.5 * alone.max(before).max(ROUNDED * moved)
    }

    fn is_balanced(&self) -> bool {
        self.certificate.equilibrium.relative() < BALANCED
    }

    /// The torn displacement with rigid forces balanced by gluing and supports; `None` if they are balanced already.
    fn balanced(&self, weights: &Weights) -> Option<Vec<f64>> {
        if self.is_balanced() {
            return None;
        }
        let tfeti = &self.model.tfeti;
        let interior = weights.interior(tfeti)?;
        // Rᵀ (K u - f - Bᵀ lambda) = e - G lambda
        let missing: Vec<f64> = (0..tfeti.subdomains())
            .flat_map(|s| {
                tfeti
                    .kernel(s)
                    .transpose_times(&self.residual[tfeti.torn_range(s)])
            })
            .collect();
        let mut lambda = vec![0.0; tfeti.dual_dim()];
        interior.particular(&missing, &mut lambda, &mut interior.scratch());
        let mut force = vec![0.0; tfeti.torn_dim()];
        tfeti.add_rows_transposed(&lambda, &mut force);
        let mut u = vec![0.0; tfeti.torn_dim()];
        tfeti.generalised_inverse(&force, &mut u);
        u.iter_mut().zip(self.torn).for_each(|(u, t)| *u += t);
        Some(u)
    }

    fn mean(&self, weights: &CopyStiffness) -> Vec<f64> {
        let nodes = self.model.scene.mesh.points().len();
        let (mut v, mut total) = (vec![0.0; 3 * nodes], vec![0.0; nodes]);
        let copies = self
            .model
            .decomposition
            .subdomains()
            .iter()
            .flat_map(|s| s.nodes.iter().copied());
        for ((k, node), u) in copies.enumerate().zip(self.torn.chunks_exact(3)) {
            let (node, weight) = (node as usize, weights.weight(k));
            total[node] += weight;
            (0..3).for_each(|c| v[3 * node + c] += weight * u[c]);
        }
        for (value, total) in v.chunks_exact_mut(3).zip(&total) {
            value.iter_mut().for_each(|x| *x /= total);
        }
        v
    }

    /// Moves nodes whose contact and support rows depend on one another to where all of them hold: the move for one may undo
    /// another. Points that touch stay at their obstacles, others are moved out of theirs.
    fn agree(&self, moved: &[Moved], movable: &[Movable], v: &mut [f64]) {
        let gluing = self.model.tfeti.gluing();
        if gluing.dependent_nodes().is_empty() {
            return;
        }
        let mut planes: BTreeMap<u32, Vec<([f64; 3], f64)>> = BTreeMap::new();
        for row in gluing.ranges().dirichlet.clone() {
            if let Some(node) = gluing.node(row).filter(|n| gluing.is_dependent(*n)) {
                let plane = (self.direction(row), self.level.offset[row]);
                planes.entry(node).or_default().push(plane);
            }
        }
        let dependent = |t: &(&ConstrainedPoint, &Movable)| gluing.is_dependent(t.0.node);
        let places = self.model.points.iter().zip(movable);
        for ((touch, movable), moved) in places.clone().zip(moved).filter(|p| dependent(&p.0)) {
            let place = movable.place(self.level, touch, v);
            let planes = planes.entry(movable.node).or_default();
            if moved.touches() {
                planes.push((place.normal, place.offset));
            }
            // with given friction also where the contact is open
            if moved.sticks() {
                planes.extend_from_slice(place.along());
            }
        }
        let on_planes = |v: &mut [f64]| {
            for (&node, planes) in &planes {
                meet(planes, &mut v[3 * node as usize..][..3]);
            }
        };
        on_planes(v);
        for _ in 0..SWEEPS {
            for (touch, movable) in places.clone().filter(dependent) {
                movable.push_out(self.level, touch, v);
            }
        }
        on_planes(v);
    }

    /// The direction that a support row fixes, times the scale of the row.
    fn direction(&self, row: usize) -> [f64; 3] {
        let mut direction = [0.0; 3];
        for (_, dof, coefficient) in self.model.tfeti.gluing().row(row) {
            direction[dof % 3] += coefficient;
        }
        direction
    }

    /// Sets supported directions to their prescribed values.
    fn support(&self, v: &mut [f64]) {
        let gluing = self.model.tfeti.gluing();
        for row in gluing.ranges().dirichlet.clone() {
            let Some(node) = gluing.node(row) else {
                continue;
            };
            let direction = self.direction(row);
            let value = &mut v[3 * node as usize..][..3];
            let off =
                (self.level.offset[row] - dot(&direction, value)) / dot(&direction, &direction);
            for c in 0..3 {
                value[c] += off * direction[c];
            }
        }
    }
}

/// Moves a point as little as possible onto planes `(n, d)`, `n . x = d`; next to all of them where they do not meet.
fn meet(planes: &[([f64; 3], f64)], x: &mut [f64]) {
    if planes.is_empty() {
        return;
    }
    let rows = DMatrix::from_fn(planes.len(), 3, |i, c| planes[i].0[c]);
    let off = DVector::from_fn(planes.len(), |i, _| planes[i].1 - dot(&planes[i].0, x));
    let svd = rows.svd(true, true);
    let cut = PARALLEL * svd.singular_values.max();
    if let Ok(by) = svd.solve(&off, cut) {
        x.iter_mut().zip(by.iter()).for_each(|(x, b)| *x += b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Friction;
    use crate::step::example::block;
    use crate::{Load, Settings, Simulation};
    use signorini_fem_mesh::brick;

    /// Where slip bounds are a little larger than the friction, what lies between is in the estimate.
    #[test]
    fn a_changed_slip_bound_is_worth_its_energy() {
        let scene = block(0.0, Friction::coulomb(0.3))
            .with_load(Load::traction(brick::Z_MIN, [4e3, 0.0, -4e3]));
        let settings = Settings::default().with_tolerance(1e-11);
        let mut simulation = Simulation::new(scene, settings).expect("set-up");
        let frame = simulation.step().expect("step");
        let estimate = |points: &[PointState]| {
            let solved = Solved {
                model: frame.model,
                caches: frame.caches,
                level: frame.level,
                points,
                certificate: frame.certificate,
                torn: frame.torn,
                residual: frame.residual,
            };
            solved.algebraic_error()
        };
        let gap = estimate(frame.points).energy;
        let mut points = frame.points.to_vec();
        let mut change = 0.0;
        let weights = frame.caches.weights.get().expect("made by the estimate");
        for (point, touch) in points.iter_mut().zip(&frame.model.points) {
            if point.state != crate::ContactState::Slip {
                continue;
            }
            let more = 4e-3 * point.slip_bound;
            point.slip_bound += more;
            let (_, row, scale) = touch.along().next().expect("friction");
            change += 0.5 * more.powi(2) / (scale.powi(2) * weights.rows[row]);
        }
        assert!(change > 1e4 * gap, "{change:e} {gap:e}");
        let found = estimate(&points).energy;
        let expected = (gap.sqrt() + change.sqrt()).powi(2);
        assert!(
            (found - expected).abs() <= 1e-2 * expected,
            "{found:e} {expected:e}"
        );
    }
}
