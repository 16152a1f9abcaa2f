//! The model: everything that is computed once from a scene and read-only afterwards.

use super::bodies::Bodies;
use super::contact_point::{ConstrainedPoint, constrained_points};
use crate::discrete::{ContactPoint, DiscreteScene};
use crate::error::ContactError;
use crate::hash::{hash, number};
use crate::plan::Plan;
use crate::scene::{Friction, Load, Scene};
use crate::settings::Settings;
use crate::tolerances::NO_LOAD;
use signorini_fem_mesh::vec3::{moved, norm, sub};
use signorini_qp::vector::dot;
use signorini_qp::{ProductSet, Segment};
use signorini_tfeti::internal::Dependency;
use signorini_tfeti::{FreeMotion, LoadResponse, RowWeights, Tfeti, TfetiBuilder, TfetiError, TiedRows};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// Segment numbers of the feasible set.
pub(crate) const DISCS: usize = 1;
/// Intervals of points with one tangential direction.
pub(crate) const INTERVALS: usize = 2;

/// Everything that is computed once. With other loads the rest is shared.
#[derive(Debug, Clone)]
pub(crate) struct Model {
    pub(crate) scene: Scene,
    pub(crate) plan: Plan,
    pub(crate) discrete: Arc<DiscreteScene>,
    pub(crate) tfeti: Arc<Tfeti>,
    pub(crate) bodies: Arc<Bodies>,
    pub(crate) loads: Vec<LoadResponse>,
    /// Size of the factor of each load up to which it is none.
    no_load: Vec<f64>,
    /// Of each load what tells its nodal forces from those of others.
    marks: Vec<u64>,
    /// Of each load that is an eigenstrain the squares of its nodal forces on each body, N²; empty of others.
    pub(crate) strained: Vec<Vec<f64>>,
    /// Without contact, multipliers of supports and gluing that [balance each load](Self::balance_loads); solvers find
    /// what is left. Empty with contact.
    pub(crate) balancing: Vec<Vec<f64>>,
    pub(crate) points: Arc<[ConstrainedPoint]>,
    /// The point with rows that stands for each condition of a contact; none where supports hold the node, which was
    /// judged before anything is solved.
    pub(crate) standing: Vec<Option<usize>>,
    /// Set with zero radii.
    pub(crate) set: ProductSet,
    /// Stiffness of the rows of supports, ties, equations and couplings that move.
    moved_stiffness: OnceLock<Vec<f64>>,
    /// Rows that depend on one another.
    dependencies: OnceLock<Vec<Dependency>>,
    /// Rigid motions that supports leave to the bodies.
    loose_motions: OnceLock<Vec<FreeMotion>>,
}

impl Model {
    /// What prescribed displacements in `offset` (row units), and eigenstrains with these `factors` of the loads, would
    /// do to their nodes with all others held: for each body the norm of these forces, N. Empty if no support, no tie
    /// and no coupling moves, and where there is no eigenstrain.
    pub(crate) fn prescribed_force(&self, offset: &[f64], factors: &[f64]) -> Vec<f64> {
        let ranges = self.tfeti.gluing().ranges();
        let supports = (!self.discrete.supports.motions.is_empty()).then(|| ranges.dirichlet.clone());
        let ties = self.plan.effects.moving_ties.then(|| ranges.tied.clone());
        let couplings = !self
            .discrete
            .couplings
            .supports
            .iter()
            .all(|held| held.values.is_empty());
        let couplings = couplings.then(|| ranges.rigid.clone());
        let equations = Some(ranges.equations.clone()).filter(|rows| supports.is_some() && !rows.is_empty());
        let moved = [supports, ties, equations, couplings.clone()].into_iter().flatten();
        if moved.clone().next().is_none() && self.strained.iter().all(Vec::is_empty) {
            return Vec::new();
        }
        let stiffness = self.moved_stiffness.get_or_init(|| {
            let of = |rows: Range<usize>| {
                let mut out = vec![0.0; rows.len()];
                if couplings.as_ref() == Some(&rows) {
                    self.coupling_stiffness(&mut out)
                } else {
                    self.tfeti.row_stiffness(rows, &mut out)
                }
                out
            };
            moved.clone().flat_map(of).collect()
        });
        let mut out = vec![0.0; self.bodies.count().max(1)];
        for (row, k) in moved.flatten().zip(stiffness) {
            out[self.bodies.of_row(row)] += (k * offset[row]).powi(2);
        }
        for (factor, forces) in factors.iter().zip(&self.strained) {
            out.iter_mut()
                .zip(forces)
                .for_each(|(v, square)| *v += factor * factor * square);
        }
        out.iter_mut().for_each(|v| *v = v.sqrt());
        out
    }

    /// What the motions that rows of couplings hold do to the nodes, over the values of the rows, N/m: these reach
    /// three places of a subdomain without stiffness.
    fn coupling_stiffness(&self, out: &mut [f64]) {
        let (gluing, couplings) = (self.tfeti.gluing(), &self.discrete.couplings);
        let subdomains = self.discrete.decomposition.subdomains();
        for ((out, row), held) in out
            .iter_mut()
            .zip(gluing.ranges().rigid.clone())
            .zip(&couplings.supports)
        {
            let nodes = &subdomains[held.subdomain as usize].nodes;
            let at = |node: u32| moved(held.direction, sub(self.scene.mesh.points()[node as usize], held.point));
            let entries = gluing.row(row).into_iter();
            let value: f64 = entries
                .map(|(_, dof, coefficient)| coefficient * at(nodes[dof / 3])[dof % 3])
                .sum();
            let square = |&node: &u32| {
                let copies = self.discrete.decomposition.copies(node as usize).iter();
                let elastic = copies.filter(|copy| (copy.subdomain as usize) < couplings.first);
                let stiffness: f64 = elastic.map(|copy| self.tfeti.all_copy_stiffness().of(copy)).sum();
                (stiffness * norm(at(node))).powi(2)
            };
            *out = nodes.iter().map(square).sum::<f64>().sqrt() / value.abs();
        }
    }

    /// The factor of a load at a time; 0 where it has no forces, or only those that rounding leaves.
    pub(crate) fn factor(&self, load: usize, time: f64) -> f64 {
        let factor = self.scene.loads[load].history.value(time);
        if factor.abs() <= self.no_load[load] { 0.0 } else { factor }
    }

    /// Those of all loads.
    pub(crate) fn factors(&self, time: f64) -> Vec<f64> {
        (0..self.loads.len()).map(|load| self.factor(load, time)).collect()
    }

    /// The rows of tied contacts, each with its point.
    pub(crate) fn tied(&self) -> impl Iterator<Item = (&TiedRows, &ContactPoint)> {
        let points = self.discrete.points.len();
        let tied = self.tfeti.gluing().tied().iter();
        tied.filter_map(move |t| Some((t, self.discrete.ties.get(t.point.checked_sub(points)?)?)))
    }

    /// The entries of a row on nodes: mesh node, component and coefficient.
    pub(crate) fn row(&self, row: usize) -> impl Iterator<Item = (u32, usize, f64)> {
        let subdomains = self.discrete.decomposition.subdomains();
        let entries = self.tfeti.gluing().row(row).into_iter();
        let entries = entries.filter(|entry| !subdomains[entry.0].is_relative);
        entries.map(|(subdomain, dof, value)| (subdomains[subdomain].nodes[dof / 3], dof % 3, value))
    }

    /// The motions of couplings in a torn displacement: of the reference point, m, and the rotation.
    pub(crate) fn coupling_motions(&self, torn: &[f64]) -> Vec<[[f64; 3]; 2]> {
        let subdomains = self.discrete.couplings.first..;
        let couplings = &self.discrete.couplings;
        let own = subdomains.zip(&couplings.about).zip(&couplings.unit);
        own.map(|((subdomain, about), unit)| {
            let [displacement, rotation] = self.tfeti.rigid_motion(subdomain, torn, *about);
            [displacement.map(|u| u / unit), rotation]
        })
        .collect()
    }

    /// A rigid motion at a node.
    pub(crate) fn moved_by(&self, motion: &FreeMotion, node: u32) -> [f64; 3] {
        let copies = self.discrete.decomposition.copies(node as usize);
        copies.first().map_or([0.0; 3], |copy| {
            let subdomain = copy.subdomain as usize;
            let amplitudes = &motion.amplitudes[6 * subdomain..6 * (subdomain + 1)];
            let modes = self.tfeti.kernel(subdomain).node_modes(copy.local as usize);
            modes.map(|row| dot(&row, amplitudes))
        })
    }

    /// How rigid motions move the sides of a point relative to each other.
    pub(crate) fn ways(&self, point: &ConstrainedPoint, motions: &[&FreeMotion]) -> Vec<[f64; 3]> {
        const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let way = |motion: &&FreeMotion| {
            let along = |node: u32, d: &[f64; 3]| dot(&self.moved_by(motion, node), d);
            AXES.map(|axis| point.contact.sides.way(&axis, along))
        };
        motions.iter().map(way).collect()
    }

    /// The rigid motions that supports leave to the bodies.
    pub(crate) fn loose_motions(&self) -> Result<&[FreeMotion], ContactError> {
        if let Some(known) = self.loose_motions.get() {
            return Ok(known);
        }
        let found = self.motions_left_by(|_| false)?;
        Ok(self.loose_motions.get_or_init(|| found))
    }

    /// The rigid motions that neither supports nor these contact rows stop.
    pub(crate) fn motions_left_by(&self, holds: impl Fn(usize) -> bool) -> Result<Vec<FreeMotion>, ContactError> {
        let coarse = self.tfeti.coarse();
        let mut weights = vec![1.0; coarse.dim()];
        for (row, weight) in weights[self.contact_rows()].iter_mut().enumerate() {
            *weight = f64::from(u8::from(holds(row)));
        }
        Ok(coarse.free_motions(Some(&RowWeights::diagonal(weights)))?)
    }

    pub(crate) fn dependencies(&self) -> &[Dependency] {
        self.dependencies.get_or_init(|| self.tfeti.gluing().dependencies())
    }

    pub(crate) fn new(scene: Scene, settings: &Settings) -> Result<Self, ContactError> {
        let mut discrete = DiscreteScene::new(&scene)?;
        let (plan, forecast) = Plan::of(&scene, &discrete, settings)?;
        let tfeti = TfetiBuilder::of_forecast(&forecast)
            .with_supports(&discrete.supports.nodes)
            .with_rigid_supports(&discrete.couplings.supports)
            .with_equations(&discrete.equations)
            .with_springs(&discrete.springs.nodal)
            .with_contact(&discrete.constraints)
            .with_communicator(&settings.communicator)
            .build()?;
        let forces = std::mem::take(&mut discrete.loads);
        let points = constrained_points(&discrete.points, tfeti.gluing());
        let mut with_rows = vec![None; discrete.points.len()];
        let rows = tfeti.gluing().contact().iter().enumerate();
        rows.for_each(|(k, rows)| with_rows[rows.point] = Some(k));
        let ranges = tfeti.gluing().ranges();
        let zeros = |count: usize| vec![0.0; count];
        let set = ProductSet::new(vec![
            Segment::upper(zeros(ranges.normal.len())),
            Segment::discs(zeros(ranges.discs.len() / 2)),
            Segment::bounds(zeros(ranges.intervals.len()), zeros(ranges.intervals.len())),
            Segment::Free(ranges.total() - ranges.interface.start),
        ])
        .map_err(signorini_qp::QpError::from)?;
        let mut model = Self {
            bodies: Arc::new(Bodies::new(&tfeti, &discrete)),
            standing: discrete.stands.iter().map(|&point| with_rows[point]).collect(),
            scene,
            plan,
            discrete: Arc::new(discrete),
            tfeti: Arc::new(tfeti),
            loads: Vec::new(),
            no_load: Vec::new(),
            marks: Vec::new(),
            strained: Vec::new(),
            balancing: Vec::new(),
            points: points.into(),
            set,
            moved_stiffness: OnceLock::new(),
            dependencies: OnceLock::new(),
            loose_motions: OnceLock::new(),
        };
        model.respond(forces)?;
        Ok(model)
    }

    /// The same model with other loads; what is wrong with them is refused as in a new scene.
    pub(crate) fn with_loads(&self, loads: Vec<Load>) -> Result<Self, ContactError> {
        let mut model = self.clone();
        model.scene.set_loads(loads);
        let forces = model.discrete.forces(&model.scene)?;
        model.plan.set_loads([self.loads.len(), forces.len()]);
        model.respond(forces)?;
        Ok(model)
    }

    /// Takes the loads of the scene, of these nodal forces.
    fn respond(&mut self, forces: Vec<Vec<Vec<f64>>>) -> Result<(), ContactError> {
        let Self {
            scene, tfeti, bodies, ..
        } = &*self;
        let no_load = |(load, forces): (&Load, &Vec<Vec<f64>>)| {
            if forces.iter().flatten().all(|f| *f == 0.0) {
                f64::INFINITY
            } else {
                NO_LOAD * scene.analysis.largest_factor(&load.history).0
            }
        };
        let no_load = scene.loads.iter().zip(&forces).map(no_load).collect();
        let mark = |forces: &Vec<Vec<f64>>| hash(forces.iter().flatten().map(|f| number(*f)));
        let marks = forces.iter().map(mark).collect();
        let response = |(load, forces): (&Load, Vec<Vec<f64>>)| {
            let mut response = if self.discrete.points.is_empty() {
                tfeti.torn_load(&forces)?
            } else {
                tfeti.load_response(&forces)?
            };
            // strain that makes no stress is in balance, and no rounding is to push a body that nothing holds
            if load.is_eigenstrain() {
                response.coarse.fill(0.0);
            }
            Ok::<_, TfetiError>(response)
        };
        let loads = scene.loads.iter().zip(forces).map(response);
        let loads = loads.collect::<Result<Vec<_>, _>>()?;
        tfeti.check_processes()?;
        let strained = loads.iter().zip(&scene.loads).map(|(response, load)| {
            if load.is_eigenstrain() {
                bodies.torn_squares(tfeti, &response.force)
            } else {
                Vec::new()
            }
        });
        (self.strained, self.no_load, self.marks) = (strained.collect(), no_load, marks);
        (self.loads, self.balancing) = (loads, Vec::new());
        Ok(())
    }

    /// Without contact: `balance` gives multipliers that balance each load on every subdomain, and its response is that
    /// of both. One pass over the inverses does what the load and a first product would take one each for.
    pub(crate) fn balance_loads(&mut self, mut balance: impl FnMut(&[f64]) -> Vec<f64>) {
        for load in &mut self.loads {
            let lambda = balance(&load.coarse);
            self.tfeti.balance_loads(load, &lambda);
            self.balancing.push(lambda);
        }
    }

    /// The feasible set with so many components that are free.
    pub(crate) fn set_with(&self, free: usize) -> Result<ProductSet, ContactError> {
        let mut segments = self.set.segments().to_vec();
        segments.pop();
        segments.push(Segment::Free(free));
        Ok(ProductSet::new(segments).map_err(signorini_qp::QpError::from)?)
    }

    /// Friction law of a point.
    pub(crate) fn law(&self, point: &ConstrainedPoint) -> &Friction {
        self.scene.contacts[point.contact.surface].friction()
    }

    /// What tells loads with these factors from others; 0 if none acts.
    pub(crate) fn mark(&self, factors: &[f64]) -> u64 {
        let acting = factors.iter().zip(&self.marks).filter(|(factor, _)| **factor != 0.0);
        let mut words = acting.flat_map(|(factor, mark)| [number(*factor), *mark]).peekable();
        if words.peek().is_some() { hash(words).max(1) } else { 0 }
    }

    /// Whether the law of some contact surface is such.
    pub(crate) fn any_law(&self, such: impl Fn(&Friction) -> bool) -> bool {
        self.scene.contacts.iter().any(|c| such(c.friction()))
    }

    /// How deep a point is let into its obstacle or partner by normal compliance, m.
    pub(crate) fn given_way(&self, point: usize, lambda: &[f64]) -> f64 {
        if !self.plan.effects.compliance {
            return 0.0;
        }
        let point = &self.points[point];
        let pressure = -point.scale * lambda[point.row] / point.area();
        point.contact.compliance[0] * pressure
    }

    /// Contact rows.
    pub(crate) fn contact_rows(&self) -> Range<usize> {
        self.tfeti.gluing().ranges().contact()
    }

    /// Those of them that are tangential.
    pub(crate) fn tangential_rows(&self) -> Range<usize> {
        self.tfeti.gluing().ranges().tangential()
    }
}
