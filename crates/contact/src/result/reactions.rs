//! Reactions: what the supports do to the body, and what contact and loads do. Computed when asked for.
//!
//! A support row of `B` with multiplier `lambda` pushes each copy of its node with `lambda` times its coefficients;
//! their sum is the force on the node. A direction that several supports fix has one row, and belongs to the first of
//! them.

use super::recovered::Recovered;
use crate::discrete::{ContactPoint, Supports};
use crate::model::{ConstrainedPoint, Model, PointRow};
use crate::scene::LoadKind;
use crate::step::StepProblem;
use crate::tolerances::{NO_SPRING, ROUNDING};
use crate::vec3::dot;
use nalgebra::{Matrix3, Vector3};
use signorini_fem_mesh::internal::distinct;
use signorini_fem_mesh::vec3::{Vec3, cross, scale, sub};
use signorini_tfeti::internal::FixedDirection;
use signorini_tfeti::{NodeSupport, TiedRows};
use std::collections::BTreeMap;

/// A force and its moment about a point.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Resultant {
    /// Sum of the forces, N.
    pub force: [f64; 3],
    /// Sum of their moments about the point, N m, in the undeformed state.
    pub moment: [f64; 3],
}

impl Resultant {
    fn add(&mut self, arm: [f64; 3], force: [f64; 3]) {
        let moment = cross(arm, force);
        *self += Self { force, moment };
    }
}

impl std::ops::AddAssign for Resultant {
    fn add_assign(&mut self, other: Self) {
        for c in 0..3 {
            self.force[c] += other.force[c];
            self.moment[c] += other.moment[c];
        }
    }
}

/// The force at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct NodalForce {
    /// Mesh node.
    pub node: u32,
    /// Force on the body, N.
    pub force: [f64; 3],
}

/// The reaction of one support on the body.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct SupportReaction {
    /// Force on the body and its moment.
    pub resultant: Resultant,
    /// The same node by node, without nodes at which earlier supports already fix all its directions.
    pub nodes: Vec<NodalForce>,
}

impl SupportReaction {
    fn add(&mut self, node: u32, arm: [f64; 3], force: [f64; 3]) {
        self.resultant.add(arm, force);
        self.nodes.push(NodalForce { node, force });
    }
}

/// The motion of a [coupling](crate::Coupling).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct CouplingMotion {
    /// Displacement of its reference point, m.
    pub displacement: [f64; 3],
    /// Rotation about x, y, z, radians.
    pub rotation: [f64; 3],
}

/// The force of a linear equation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct EquationForce {
    /// Each node, and point, is pushed by this, N, times its coefficients in the equation. Zero of equations that say
    /// what others, or supports, say already.
    pub multiplier: f64,
    /// All of these forces together.
    pub resultant: Resultant,
}

/// Forces on the body at the end of a step, and their moments about a point.
///
/// Each force is counted once: if several supports fix a direction at a node, its reaction belongs to the first, and
/// later ones have only what they add at right angles. If a support fixes the normal of a contact node, its reaction
/// includes the force of the obstacle.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Reactions {
    /// The point of all moments, m.
    pub point: [f64; 3],
    /// Reactions of the supports, in the order of the scene.
    pub supports: Vec<SupportReaction>,
    /// Reactions of the [elastic foundations](crate::Spring), in the order of the scene.
    pub springs: Vec<SupportReaction>,
    /// Reactions of what holds the [couplings](crate::Coupling), in the order of the scene; zero of relative ones,
    /// whose forces are those of their contacts.
    pub couplings: Vec<Resultant>,
    /// Forces of the [linear equations](crate::Equation), in the order of the scene, on nodes and points.
    pub equations: Vec<EquationForce>,
    /// Contact pressure and friction of obstacles. Forces between bodies cancel; so do their moments, except that of
    /// friction across an initial gap between matching or plane sides, because moments use the undeformed state.
    pub contact: Resultant,
    /// The same for each contact surface, in the order of the scene. Between bodies it is the action of the partner on
    /// the body with the first tag ([`Contact::between`](crate::Contact::between),
    /// [`Contact::tied`](crate::Contact::tied)), with the opposite on the partner.
    pub contacts: Vec<Resultant>,
    /// The loads.
    pub loads: Resultant,
}

impl Reactions {
    /// All supports together.
    pub fn of_supports(&self) -> Resultant {
        let mut sum = Resultant::default();
        self.supports.iter().for_each(|s| sum += s.resultant);
        sum
    }

    /// Supports, springs, couplings, equations, contact and loads together; zero in equilibrium.
    pub fn imbalance(&self) -> Resultant {
        let mut sum = self.of_supports();
        self.springs.iter().for_each(|s| sum += s.resultant);
        self.couplings.iter().for_each(|c| sum += *c);
        self.equations.iter().for_each(|e| sum += e.resultant);
        sum += self.contact;
        sum += self.loads;
        sum
    }
}

/// Forces of all supports by node, from the multipliers of the support rows.
///
/// Rows of contact and of equations leave out what supports fix, so that multipliers of supports have the part of their
/// forces along it; it is taken out here.
pub(crate) fn nodal_reactions(
    model: &Model,
    recovered: &Recovered,
    ties: &[(&ContactPoint, [f64; 3])],
) -> BTreeMap<u32, [f64; 3]> {
    let gluing = model.tfeti.gluing();
    let mut forces: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
    for row in gluing.ranges().dirichlet.start..gluing.spring_rows().start {
        let Some(node) = gluing.node(row) else {
            continue;
        };
        let (force, lambda) = (forces.entry(node).or_default(), recovered.multiplier(row));
        for (_, dof, coefficient) in gluing.row(row) {
            force[dof % 3] += lambda * coefficient;
        }
    }
    for (state, point) in recovered.points.iter().zip(model.points.iter()) {
        let whole = state.force();
        let size = whole.iter().map(|f| f.abs()).fold(0.0, f64::max);
        for (node, own) in point.contact.sides.forces(whole) {
            let Some(force) = forces.get_mut(&node) else {
                continue;
            };
            let mut rest = own;
            take_rows(model, point, &whole, node, &mut rest);
            if rest.iter().any(|f| f.abs() > ROUNDING * size) {
                (0..3).for_each(|c| force[c] -= rest[c]);
            }
        }
    }
    let mut take = |node: u32, factor: f64, whole: &[f64; 3]| {
        if let Some(force) = forces.get_mut(&node) {
            for FixedDirection { direction, .. } in model.discrete.supports.merged.directions(node) {
                let along = factor * dot(whole, direction);
                (0..3).for_each(|c| force[c] -= along * direction[c]);
            }
        }
    };
    for (tie, whole) in ties {
        tie.sides.nodes().for_each(|(node, weight)| take(node, weight, whole));
    }
    for (equation, multiplier) in equation_multipliers(model, recovered) {
        let terms = model.discrete.equations[equation].terms.iter();
        terms.for_each(|(node, vector)| take(*node, multiplier, vector));
    }
    forces
}

/// The equations that have rows, with their multipliers, N.
fn equation_multipliers<'a>(model: &'a Model, recovered: &'a Recovered) -> impl Iterator<Item = (usize, f64)> {
    let gluing = model.tfeti.gluing();
    let rows = gluing.ranges().equations.clone().zip(gluing.equations());
    rows.map(|(row, own)| (own.equation, own.scale * recovered.multiplier(row)))
}

/// The force on each point of tied contacts, N, along the directions that its rows have.
pub(crate) fn tied_forces<'a>(model: &'a Model, recovered: &Recovered) -> Vec<(&'a ContactPoint, [f64; 3])> {
    let force = |(tied, tie): (&TiedRows, &'a ContactPoint)| {
        let mut force = [0.0; 3];
        for (row, (direction, scale)) in tied.rows.clone().zip(&tied.directions) {
            let lambda = recovered.multiplier(row);
            (0..3).for_each(|c| force[c] += lambda * scale * direction[c]);
        }
        (tie, force)
    };
    model.tied().map(force).collect()
}

/// Takes from `rest` what the rows of a point do to a node, where `whole` is the force of the point.
fn take_rows(model: &Model, point: &ConstrainedPoint, whole: &[f64; 3], node: u32, rest: &mut [f64; 3]) {
    for PointRow { direction, row, scale } in point.rows() {
        let lambda = dot(whole, &direction) / scale;
        for (_, c, coefficient) in model.row(row).filter(|e| e.0 == node) {
            rest[c] -= lambda * coefficient;
        }
    }
}

/// All resultants about a point.
pub(crate) fn reactions_about(
    model: &Model,
    problem: &StepProblem,
    recovered: &Recovered,
    about: [f64; 3],
) -> Reactions {
    let places = model.scene.mesh.points();
    let arm = |node: u32| {
        let place = places[node as usize];
        [0, 1, 2].map(|c| place[c] - about[c])
    };
    let mut contact = Resultant::default();
    let mut contacts = vec![Resultant::default(); model.scene.contacts.len()];
    for (state, point) in recovered.points.iter().zip(model.points.iter()) {
        let sides = &point.contact.sides;
        sides
            .forces(state.force())
            .for_each(|(node, f)| contact.add(arm(node), f));
        let first = sides.first(state.force());
        first.for_each(|(node, f)| contacts[state.surface].add(arm(node), f));
    }
    let ties = tied_forces(model, recovered);
    for (tie, force) in &ties {
        let first = tie.sides.first(*force);
        first.for_each(|(node, f)| contacts[tie.surface].add(arm(node), f));
    }
    let forces = nodal_reactions(model, recovered, &ties);
    Reactions {
        point: about,
        supports: by_support(&model.discrete.supports, &forces, arm),
        springs: by_spring(model, recovered, arm),
        couplings: by_coupling(model, recovered, (arm, about)),
        equations: by_equation(model, recovered, (arm, about)),
        contact,
        contacts,
        loads: loads(model, problem, (arm, about)),
    }
}

/// What the loads do.
fn loads(model: &Model, problem: &StepProblem, (arm, about): (impl Fn(u32) -> Vec3, Vec3)) -> Resultant {
    let mut sum = Resultant::default();
    for ((factor, load), given) in problem.factors.iter().zip(&model.loads).zip(&model.scene.loads) {
        if let LoadKind::Coupling(given) = &given.kind
            && let Some(arm) = point_arm(model, given.coupling, about)
        {
            sum.add(arm, given.force.map(|f| factor * f));
        }
        let nodes = model.discrete.decomposition.torn_nodes();
        for (node, force) in nodes.zip(load.force.as_chunks::<3>().0) {
            // most loads act on a surface; those between two sides have no resultant
            if let Some(node) = node.filter(|_| *force != [0.0; 3]) {
                sum.add(arm(node), force.map(|f| factor * f));
            }
        }
    }
    sum
}

/// The arm of a coupling that is a point.
fn point_arm(model: &Model, coupling: usize, about: Vec3) -> Option<Vec3> {
    let coupling = model.scene.couplings.get(coupling).filter(|c| c.is_point());
    coupling.map(|point| sub(point.reference(), about))
}

/// What equations do to nodes and points.
fn by_equation(model: &Model, recovered: &Recovered, (arm, about): (impl Fn(u32) -> Vec3, Vec3)) -> Vec<EquationForce> {
    let mut out = vec![EquationForce::default(); model.scene.equations.len()];
    for (equation, multiplier) in equation_multipliers(model, recovered) {
        let (own, given) = (&mut out[equation], &model.scene.equations[equation]);
        own.multiplier = multiplier;
        let nodes = given.terms.iter().map(|(node, vector)| (arm(*node), vector));
        let points = given.points.iter();
        let points = points.filter_map(|(k, vector)| Some((point_arm(model, *k, about)?, vector)));
        nodes
            .chain(points)
            .for_each(|(arm, v)| own.resultant.add(arm, scale(multiplier, *v)));
    }
    out
}

/// What holds the couplings, from the multipliers of their rows.
fn by_coupling(model: &Model, recovered: &Recovered, (arm, about): (impl Fn(u32) -> Vec3, Vec3)) -> Vec<Resultant> {
    let mut out = vec![Resultant::default(); model.scene.couplings.len()];
    let couplings = &model.discrete.couplings;
    let rows = model.tfeti.gluing().ranges().rigid.clone();
    for (row, held) in rows.zip(&couplings.supports) {
        let lambda = recovered.multiplier(row);
        let coupling = held.subdomain as usize - couplings.first;
        if let Some(arm) = point_arm(model, coupling, about) {
            let whole = model.tfeti.gluing().direction(row);
            out[coupling].add(arm, scale(lambda * couplings.unit[coupling], whole));
        }
        for (node, c, coefficient) in model.row(row) {
            let mut force = [0.0; 3];
            force[c] = lambda * coefficient;
            out[coupling].add(arm(node), force);
        }
    }
    out
}

/// What springs do, from the multipliers of their rows; several at a node have the parts that their stiffness has, also
/// of the pull of an inclined one that a support moves the node across.
fn by_spring(model: &Model, recovered: &Recovered, arm: impl Fn(u32) -> [f64; 3]) -> Vec<SupportReaction> {
    let springs = &model.discrete.springs.by_spring;
    let gluing = model.tfeti.gluing();
    let rows = gluing.ranges().dirichlet.clone().rev();
    let mut forces: BTreeMap<u32, Vector3<f64>> = BTreeMap::new();
    for row in rows.take(gluing.springs().len()) {
        if let Some(node) = gluing.node(row) {
            *forces.entry(node).or_default() += Vector3::from(gluing.direction(row)) * recovered.multiplier(row);
        }
    }
    let own = springs.iter().map(|nodes| {
        let mut reaction = SupportReaction::default();
        for (&node, stiffness) in nodes {
            let Some(&whole) = forces.get(&node) else {
                continue;
            };
            let sharing = springs.iter().filter_map(|other| other.get(&node));
            let part = match sharing.clone().count() {
                1 => whole,
                _ => {
                    let sum: Matrix3<f64> = sharing.sum();
                    let inverse = sum.pseudo_inverse(NO_SPRING * sum.amax()).unwrap_or_default();
                    stiffness * inverse * whole
                }
            };
            reaction.add(node, arm(node), part.into());
        }
        reaction
    });
    own.collect()
}

/// Splits nodal forces among the supports: each has the part along the directions that it is the first to fix.
fn by_support(
    supports: &Supports,
    forces: &BTreeMap<u32, [f64; 3]>,
    arm: impl Fn(u32) -> [f64; 3],
) -> Vec<SupportReaction> {
    let reaction = |(index, support): (usize, &NodeSupport)| {
        let mut reaction = SupportReaction::default();
        // a node may be named more than once
        for node in &distinct(support.nodes.iter().copied()) {
            let Some(whole) = forces.get(node) else {
                continue;
            };
            let held = supports.merged.directions(*node).iter();
            let mut own = held.filter(|h| h.support == index).peekable();
            if own.peek().is_none() {
                continue;
            }
            let mut force = [0.0; 3];
            for FixedDirection { direction, .. } in own {
                let along = dot(whole, direction);
                (0..3).for_each(|c| force[c] += along * direction[c]);
            }
            reaction.add(*node, arm(*node), force);
        }
        reaction
    };
    supports.nodes.iter().enumerate().map(reaction).collect()
}
