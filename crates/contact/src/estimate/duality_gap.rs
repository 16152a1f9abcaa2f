//! The algebraic error of a step by the duality gap; docs/theory.md derives it.
//!
//! The recovered torn displacement `u` is in equilibrium with the multipliers, but only nearly continuous and
//! admissible. From it a continuous, admissible `v` is made: the mean of the copies of each node weighted by
//! stiffness, moved at contact nodes ([`admissible`](super::admissible)), set to the supports. With slip bounds `r`,
//! gaps `g` and rest positions `z`
//!
//! ```text
//! gap = 1/2 |v - u|² + sum lambda_nu (v_nu - g) + sum ( r |v_T - z| + lambda_T . (v_T - z) )
//! ```
//!
//! is at least `1/2 |v - u*|² + 1/2 |u - u*|²`, `u*` the solution of the discrete problem with the slip bounds `r`.

use super::admissible::{AdmissibleNode, Correction};
use super::dependent::Agreement;
use super::shared::{SharedNodes, Target};
use super::sprung::SprungNodes;
use crate::model::Model;
use crate::report::AlgebraicError;
use crate::result::{Lengths, PointState, Recovered};
use crate::step::StepProblem;
use crate::tolerances::{FREEDOM_TAKEN, NO_STRAIN, PARALLEL, REST, ROUNDING};
use crate::vec3::dot;
use nalgebra::{DMatrix, DVector};
use signorini_fem_mesh::recovery::StrainRecovery;
use signorini_fem_mesh::vec3::{Vec3, moved, sub};
use signorini_qp::vector;
use signorini_tfeti::{CoarseFactor, RowWeights, Tfeti};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// Moves out of one obstacle after another, for nodes in edges; one is enough between perpendicular ones.
const SWEEPS: usize = 10;

/// Stiffnesses that weigh contact nodes, computed once when first needed.
#[derive(Debug)]
pub(crate) struct Weights {
    /// Stiffness in the direction of the contact rows, N/m, by row.
    rows: Vec<f64>,
    /// What moves at each contact point.
    nodes: Vec<AdmissibleNode>,
    /// Where points share the nodes that move.
    pub(super) shared: Option<SharedNodes>,
    /// Where springs pull at nodes that move.
    sprung: SprungNodes,
    /// Made where a step needs it: the active-set method leaves nothing to balance.
    interior: OnceLock<Option<CoarseFactor>>,
}

impl Weights {
    pub(super) fn new(model: &Model) -> Self {
        let contact = model.contact_rows().end;
        let mut rows = vec![0.0; contact];
        model.tfeti.row_stiffness(0..contact, &mut rows);
        let nodes: Vec<_> = model.points.iter().map(|p| AdmissibleNode::new(model, p)).collect();
        let stiffness = || {
            let mut sums = vec![0.0; model.discrete.decomposition.nodes()];
            for (k, node) in model.discrete.decomposition.torn_nodes().enumerate() {
                if let Some(node) = node {
                    sums[node as usize] += model.tfeti.all_copy_stiffness().weight(k);
                }
            }
            sums
        };
        let sprung = SprungNodes::new(model, stiffness);
        Self {
            rows,
            shared: SharedNodes::new(model, &nodes, &sprung, stiffness),
            sprung,
            nodes,
            interior: OnceLock::new(),
        }
    }

    /// Coarse problem of gluing and supports alone; `None` if contact is needed to hold the body.
    fn interior(&self, tfeti: &Tfeti) -> Option<&CoarseFactor> {
        let factor = || {
            let mut weights = vec![1.0; tfeti.dual_dim()];
            weights[..self.rows.len()].fill(0.0);
            let factor = tfeti.coarse().factor_weighted(RowWeights::diagonal(weights));
            factor.ok().filter(|f| f.free_motions().is_empty())
        };
        self.interior.get_or_init(factor).as_ref()
    }
}

/// What estimates need of a model, made when it is first asked for.
#[derive(Debug, Default)]
pub(crate) struct Caches {
    pub(super) weights: OnceLock<Weights>,
    /// Whether ties reach contact points.
    pub(super) ties_meet_points: OnceLock<bool>,
    /// Where rows along surfaces depend on others.
    pub(super) agreements: OnceLock<Vec<Agreement>>,
    /// Patches of the estimate of the discretisation error.
    pub(crate) recovery: OnceLock<StrainRecovery>,
    /// Lengths that results are compared with.
    pub(crate) lengths: OnceLock<Lengths>,
}

/// What the estimate needs of a solved step.
#[derive(Clone, Copy)]
pub(crate) struct Solved<'a> {
    pub(crate) model: &'a Model,
    pub(crate) caches: &'a Caches,
    pub(crate) problem: &'a StepProblem,
    pub(crate) recovered: &'a Recovered,
}

impl Solved<'_> {
    pub(crate) fn algebraic_error(&self) -> AlgebraicError {
        let (model, tfeti) = (self.model, &self.model.tfeti);
        let weights = self.caches.weights.get_or_init(|| Weights::new(model));
        let motions = self.motions();
        let offset = &*self.offset(&motions);
        let mut v = tfeti.mean_by(model.tfeti.all_copy_stiffness(), &self.recovered.torn);
        let mean = (tfeti.subdomains() > 1).then(|| tfeti.nodal_mean(&self.recovered.torn));
        self.couple(&motions, &mut v);
        weights.sprung.begin(offset, &mut v);
        let points = || self.recovered.points.iter().zip(&weights.nodes);
        let moved: Vec<Correction> = match &weights.shared {
            None => points()
                .map(|(state, node)| Correction::new(node, state, offset, &weights.rows, &mut v))
                .collect(),
            Some(shared) => {
                self.support(weights, offset, &mut v);
                shared.with_points(&model.discrete.couplings, &motions, &mut v);
                let planned = |(state, node): (&PointState, &AdmissibleNode)| {
                    let at = |node: u32| 3 * node as usize..3 * node as usize + 3;
                    let before: Vec<(u32, [f64; 3])> =
                        node.moving().map(|n| (n, [0, 1, 2].map(|c| v[at(n)][c]))).collect();
                    let planned = Correction::new(node, state, offset, &weights.rows, &mut v);
                    before.iter().for_each(|(n, value)| v[at(*n)].copy_from_slice(value));
                    planned
                };
                let planned: Vec<Correction> = points().map(planned).collect();
                let targets = if shared.is_scarce() {
                    let forces = points()
                        .zip(&planned)
                        .map(|((state, _), planned)| planned.forces(state));
                    let rest = weights.nodes.iter().flat_map(|node| node.touching(offset));
                    shared.settle(forces.collect(), rest.collect(), offset, &mut v)
                } else {
                    let targets = weights.nodes.iter().zip(&planned);
                    let targets = targets.flat_map(|(node, planned)| node.targets(offset, planned));
                    targets.map(Target::At).collect()
                };
                shared.reach(targets, offset, &mut v);
                planned
            }
        };
        self.support(weights, offset, &mut v);
        if weights.shared.is_none() {
            self.agree(&moved, &weights.nodes, offset, &mut v);
            self.tie(offset, &mut v);
        }
        let (mut terms, mut change) = (weights.sprung.energy(offset, &v), 0.0);
        for ((state, node), moved) in points().zip(&moved) {
            let conditions = node.conditions(offset, &v);
            terms += moved.gap(state, &conditions, node.value(&mut v));
            change += moved.change;
        }
        // torn difference and its energy
        let balanced = self.balanced(weights);
        let torn = balanced.as_deref().unwrap_or(&self.recovered.torn);
        let subdomains = model.discrete.decomposition.subdomains();
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
            terms += vector::norm(&self.residual()) * vector::norm(&difference);
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
        let (model, copies) = (self.model, self.model.tfeti.all_copy_stiffness());
        let force = self.problem.forces(model);
        let (mut alone, mut moved) = (0.0_f64, 0.0);
        let rigid = (model.tfeti.torn_range(model.discrete.couplings.first - 1)).end / 3;
        for (k, (f, u)) in force.chunks_exact(3).zip(torn.chunks_exact(3)).enumerate() {
            let stiffness = copies.weight(k);
            alone += dot(f, f) / stiffness;
            if k < rigid {
                moved += dot(u, u) * stiffness;
            }
        }
        let works = self.problem.peaks.iter();
        let before = REST * REST * works.map(|p| p.multipliers * p.displacement).sum::<f64>();
        0.5 * alone.max(before).max(NO_STRAIN * moved)
    }

    fn is_balanced(&self) -> bool {
        self.recovered.certificate.equilibrium.relative() < ROUNDING
    }

    /// The residual of all processes.
    fn residual(&self) -> Vec<f64> {
        let mut residual = self.recovered.residual.clone();
        self.model.tfeti.complete_torn(&mut residual);
        residual
    }

    /// The torn displacement with rigid forces balanced by gluing and supports; `None` if they are balanced already.
    fn balanced(&self, weights: &Weights) -> Option<Vec<f64>> {
        if self.is_balanced() {
            return None;
        }
        let tfeti = &self.model.tfeti;
        let interior = weights.interior(tfeti)?;
        // Rᵀ (K u - f - Bᵀ lambda) = e - G lambda
        let residual = self.residual();
        let own = |s: usize| &residual[tfeti.torn_range(s)];
        let missing = (0..tfeti.subdomains()).map(|s| tfeti.kernel(s).transpose_times(own(s)));
        let missing: Vec<f64> = missing.flatten().collect();
        let mut lambda = vec![0.0; tfeti.dual_dim()];
        interior.particular(&missing, &mut lambda, &mut interior.scratch());
        let mut force = vec![0.0; tfeti.torn_dim()];
        tfeti.add_rows_transposed(&lambda, &mut force);
        let mut u = vec![0.0; tfeti.torn_dim()];
        tfeti.generalised_inverse(&force, &mut u);
        vector::axpy(1.0, &self.recovered.torn, &mut u);
        Some(u)
    }

    /// Moves nodes whose contact and support rows depend on one another to where all of them hold: the move for one
    /// may undo another. Points that touch stay at their obstacles, others are moved out of theirs.
    fn agree(&self, moved: &[Correction], nodes: &[AdmissibleNode], offset: &[f64], v: &mut [f64]) {
        let gluing = self.model.tfeti.gluing();
        if gluing.dependent_nodes().is_empty() {
            return;
        }
        let mut planes: BTreeMap<u32, Vec<([f64; 3], f64)>> = BTreeMap::new();
        for row in gluing.ranges().dirichlet.clone() {
            if let Some(node) = gluing.node(row).filter(|n| gluing.is_dependent(*n)) {
                let plane = (gluing.direction(row), offset[row]);
                planes.entry(node).or_default().push(plane);
            }
        }
        let points = self.model.points.iter().zip(nodes).zip(moved);
        let dependent = points.filter(|((point, _), _)| gluing.is_dependent(point.node()));
        let dependent: Vec<_> = dependent.map(|((_, node), moved)| (node, moved)).collect();
        for (node, moved) in &dependent {
            let conditions = node.conditions(offset, v);
            let planes = planes.entry(node.node).or_default();
            if moved.touches() {
                planes.push(conditions.obstacle());
            }
            // with Tresca friction also where the contact is open
            if moved.sticks() {
                planes.extend_from_slice(conditions.along());
            }
        }
        let on_planes = |v: &mut [f64]| {
            for (&node, planes) in &planes {
                meet(planes, &mut v[3 * node as usize..][..3]);
            }
        };
        on_planes(v);
        for _ in 0..SWEEPS {
            dependent.iter().for_each(|(node, _)| node.push_out(offset, v));
        }
        on_planes(v);
    }

    /// What rows have to measure of an admissible displacement, in row units. Springs and compliant contact are held
    /// where their multipliers put them: they then add nothing to the gap. Likewise sides that move relative to each
    /// other where they moved.
    fn offset(&self, motions: &[[Vec3; 2]]) -> Cow<'_, [f64]> {
        let (offset, gives_way) = (&self.problem.offset, &self.recovered.gives_way);
        let mut out: Cow<'_, [f64]> = match &gives_way[..] {
            [] => offset.into(),
            _ => offset.iter().zip(gives_way).map(|(c, given)| c - given).collect(),
        };
        let model = self.model;
        for (tied, tie) in model.tied() {
            if let Some(subdomain) = model.discrete.couplings.relative(tie.surface) {
                let subdomain = subdomain as usize;
                let motion = motions[subdomain - model.discrete.couplings.first];
                for row in tied.rows.clone() {
                    out.to_mut()[row] -= self.acts(row, subdomain, motion);
                }
            }
        }
        out
    }

    /// What a motion of the subdomain of a coupling does to a row.
    fn acts(&self, row: usize, subdomain: usize, motion: [Vec3; 2]) -> f64 {
        let (scene, discrete) = (&self.model.scene, &self.model.discrete);
        let coupling = subdomain - discrete.couplings.first;
        let (point, unit) = (discrete.couplings.about[coupling], discrete.couplings.unit[coupling]);
        let nodes = &discrete.decomposition.subdomains()[subdomain].nodes;
        let own = self.model.tfeti.gluing().row(row).into_iter();
        let own = own.filter(|entry| entry.0 == subdomain).map(|(_, dof, coefficient)| {
            let arm = sub(scene.mesh.points()[nodes[dof / 3] as usize], point);
            unit * coefficient * moved(motion, arm)[dof % 3]
        });
        own.sum()
    }

    /// Moves the nodes of tied contacts to where their partners want them.
    fn tie(&self, offset: &[f64], v: &mut [f64]) {
        let gluing = self.model.tfeti.gluing();
        for row in gluing.ranges().tied.clone() {
            let Some(own) = gluing.node(row) else {
                continue;
            };
            let (mut part, mut value) = ([0.0; 3], 0.0);
            for (node, c, coefficient) in self.model.row(row) {
                value += coefficient * v[3 * node as usize + c];
                if node == own {
                    part[c] += coefficient;
                }
            }
            let square = dot(&part, &part);
            if square > FREEDOM_TAKEN {
                let by = (offset[row] - value) / square;
                (0..3).for_each(|c| v[3 * own as usize + c] += by * part[c]);
            }
        }
    }

    /// The motions of couplings, of which what is held has its prescribed values.
    fn motions(&self) -> Vec<[Vec3; 2]> {
        let (model, couplings) = (self.model, &self.model.discrete.couplings);
        let mut motions = model.coupling_motions(&self.recovered.torn);
        let rows = model.tfeti.gluing().ranges().rigid.clone();
        for (row, held) in rows.zip(&couplings.supports) {
            let subdomain = held.subdomain as usize;
            let value = self.problem.offset[row] / self.acts(row, subdomain, held.direction);
            let motion = &mut motions[subdomain - couplings.first];
            // one of the two directions is zero
            let off = value - dot(&motion[0], &held.direction[0]) - dot(&motion[1], &held.direction[1]);
            for (motion, direction) in motion.iter_mut().zip(held.direction) {
                (0..3).for_each(|c| motion[c] += off * direction[c]);
            }
        }
        motions
    }

    /// Moves the nodes of couplings as rigid bodies.
    fn couple(&self, motions: &[[Vec3; 2]], v: &mut [f64]) {
        let model = self.model;
        let subdomains = &model.discrete.decomposition.subdomains()[model.discrete.couplings.first..];
        let own = motions.iter().zip(&model.discrete.couplings.about).zip(subdomains);
        for ((motion, about), rigid) in own.filter(|(_, rigid)| !rigid.is_relative) {
            for &node in &rigid.nodes {
                let arm = sub(model.scene.mesh.points()[node as usize], *about);
                v[3 * node as usize..][..3].copy_from_slice(&moved(*motion, arm));
            }
        }
    }

    /// Sets supported directions to their prescribed values, and nodes to where springs are but for those that move.
    fn support(&self, weights: &Weights, offset: &[f64], v: &mut [f64]) {
        let gluing = self.model.tfeti.gluing();
        let supports = gluing.ranges().dirichlet.clone();
        for row in supports.filter(|row| !weights.sprung.has(*row)) {
            let Some(node) = gluing.node(row) else {
                continue;
            };
            let direction = gluing.direction(row);
            let value = &mut v[3 * node as usize..][..3];
            let missing = offset[row] - dot(&direction, value);
            let off = missing / dot(&direction, &direction);
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
        let scene = block(0.0, Friction::coulomb(0.3)).with_load(Load::traction(brick::Z_MIN, [4e3, 0.0, -4e3]));
        let settings = Settings::default().with_tolerance(1e-11);
        let mut simulation = Simulation::new(scene, settings).expect("set-up");
        simulation.step().expect("step");
        let (model, caches) = (&simulation.model, &simulation.caches);
        let (problem, result) = (&simulation.problem, simulation.result().expect("a result"));
        let estimate = |recovered: &Recovered| {
            let solved = Solved {
                model,
                caches,
                problem,
                recovered,
            };
            solved.algebraic_error()
        };
        let gap = estimate(&result.recovered).energy;
        let mut recovered = result.recovered.clone();
        let mut change = 0.0;
        let weights = caches.weights.get().expect("made by the estimate");
        for (point, touch) in recovered.points.iter_mut().zip(model.points.iter()) {
            if point.state != crate::ContactState::Slip {
                continue;
            }
            let more = 4e-3 * point.slip_bound;
            point.slip_bound += more;
            let own = touch.along().next().expect("friction");
            change += 0.5 * more.powi(2) / (own.scale.powi(2) * weights.rows[own.row]);
        }
        assert!(change > 1e4 * gap, "{change:e} {gap:e}");
        let found = estimate(&recovered).energy;
        let expected = (gap.sqrt() + change.sqrt()).powi(2);
        assert!((found - expected).abs() <= 1e-2 * expected, "{found:e} {expected:e}");
    }
}
