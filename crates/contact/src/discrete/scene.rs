//! The discrete scene: a scene at the nodes of its mesh, made and checked once.

use super::bonded::{leave_bonded, tie_once};
use super::couplings::Couplings;
use super::equations::equations;
use super::faceted::{FacetedOverlaps, close_faceted};
use super::overflow::{check_compliance, check_gaps, check_materials, check_motions, nodal_loads};
use super::parted::check_parted;
use super::penetration::check_penetration;
use super::points::{ContactPoint, HandedOn, conditions, handed_on, of_contact, points};
use super::springs::Springs;
use super::supports::Supports;
use super::turn::check_turn;
use super::united::pair;
use crate::error::ContactError;
use crate::scene::{Pose, Scene, check_laws};
use crate::tolerances::ROUNDING;
use signorini_fem_mesh::{Decomposition, Surface};
use signorini_tfeti::internal::{independent_equations, prescribed_points};
use signorini_tfeti::{ContactConstraint, NodalEquation};
use std::time::{Duration, Instant};

/// A scene lowered to nodes.
#[derive(Debug)]
pub(crate) struct DiscreteScene {
    /// How the body is cut.
    pub(crate) decomposition: Decomposition,
    pub(crate) supports: Supports,
    pub(crate) springs: Springs,
    pub(crate) couplings: Couplings,
    pub(crate) equations: Vec<NodalEquation>,
    /// How many of them have rows.
    pub(crate) equation_rows: usize,
    /// The sides that have the contact points, in the order of the contacts, fixed nodes included.
    pub(crate) surfaces: Vec<Surface>,
    /// What the contacts say: each of their nodes with each of its normals.
    pub(crate) conditions: Vec<ContactPoint>,
    /// The contact points that stand for them, and for each condition which one does.
    pub(crate) points: Vec<ContactPoint>,
    /// Which of them have rows: those that supports do not hold along their normal.
    has_rows: Vec<bool>,
    pub(crate) stands: Vec<usize>,
    /// The nodes of tied contacts.
    pub(crate) ties: Vec<ContactPoint>,
    /// Both as `tfeti` wants them.
    pub(crate) constraints: Vec<ContactConstraint>,
    /// Nodal forces of each load with factor one, subdomain by subdomain, N; the model takes them.
    pub(crate) loads: Vec<Vec<Vec<f64>>>,
    /// Where the obstacle of each contact is at each step; none of those that rest.
    pub(crate) poses: Vec<Vec<Pose>>,
    /// What of a gap may be rounding, m.
    pub(crate) rounding: f64,
    /// Contacts whose meshes do not match, and whether the other side than the scene names first has the points.
    pub(crate) apart: Vec<(usize, bool)>,
    /// Nodes of theirs that other contacts cross.
    pub(crate) handed_on: Vec<HandedOn>,
    /// Their overlaps about as deep as facets are beside their curve.
    pub(crate) faceted: FacetedOverlaps,
    /// How long it took to find the sides of the contacts.
    pub(crate) search: Duration,
}

impl DiscreteScene {
    /// Refuses all that can be wrong with a scene but two things, which only the set-up can judge: subdomains that
    /// cannot be factored, and loads that neither supports nor contact hold.
    pub(crate) fn new(scene: &Scene) -> Result<Self, ContactError> {
        scene.validate()?;
        let decomposition = scene.decompose()?;
        let mut supports = Supports::new(scene)?;
        let (decomposition, couplings) = Couplings::new(scene, decomposition, &mut supports)?;
        let equations = equations(scene, &couplings, &mut supports)?;
        let springs = Springs::new(scene, &supports)?;
        let largest = |m: f64, v: &f64| m.max(v.abs());
        let rounding = ROUNDING * scene.mesh.points().iter().flatten().fold(0.0, largest);
        let started = Instant::now();
        let paired = pair(scene, rounding)?;
        let search = started.elapsed();
        let mortar = paired.iter().enumerate().filter(|(_, p)| p.is_mortar());
        let apart = mortar.map(|(index, p)| (index, p.swapped)).collect();
        let times = scene.analysis.times();
        let poses: Vec<Vec<Pose>> = scene.contacts.iter().map(|c| c.poses(times)).collect();
        let mut conditions = conditions(scene, (&paired, &poses), rounding)?;
        let mut ties: Vec<ContactPoint> = conditions.extract_if(.., |c| scene.contacts[c.surface].tied).collect();
        if !ties.is_empty() {
            tie_once(scene, &couplings, &mut ties);
            leave_bonded(scene, &decomposition, &ties, &mut conditions);
        }
        let faceted = close_faceted(scene, &paired, &mut conditions, rounding)?;
        let handed_on = handed_on(&paired);
        let surfaces: Vec<Surface> = paired.into_iter().map(|p| p.surface).collect();
        for (index, own) in surfaces.iter().enumerate() {
            let own_conditions = &conditions[of_contact(&conditions, index)];
            let acting: Vec<_> = scene.contacts[index].acting(&poses[index], times).collect();
            check_turn(scene, index, own, own_conditions, &acting)?;
        }
        let (points, stands) = points(scene, &conditions, rounding)?;
        couplings.check_contact(points.iter().chain(&ties), &supports)?;
        let [softest, stiffest] = check_materials(scene)?;
        check_motions(scene, stiffest)?;
        check_gaps(scene, &conditions, &poses)?;
        check_compliance(&points)?;
        let constraints = constraints(scene, &points, &ties, &couplings);
        couplings.check_ties(scene, (&points, rounding), &constraints, &supports)?;
        let held = (&supports.merged, &couplings.supports[..]);
        let equation_rows = independent_equations(&equations, (&scene.mesh, &decomposition), held, &constraints)?.len();
        let prescribed = prescribed_points(&constraints, &supports.merged)?;
        check_penetration(scene, &points, &prescribed, (&supports, &poses), rounding)?;
        check_parted(scene, &ties, &constraints, &supports, rounding)?;
        let loads = nodal_loads(scene, (&decomposition, &couplings), softest)?;
        // both in the order of the points
        let mut without = prescribed.iter().map(|p| p.point).peekable();
        let has_rows: Vec<bool> = (0..points.len()).map(|k| without.next_if_eq(&k).is_none()).collect();
        let with_rows = points.iter().zip(&has_rows).filter(|(_, has)| **has);
        check_laws(with_rows.map(|(p, _)| (scene.contacts[p.surface].friction(), p.at())))?;
        // those that no point asks, now or at all
        let mut bounds = (scene.contacts.iter().enumerate()).filter_map(|(k, c)| Some((k, c.friction().bad_bound()?)));
        if let Some((contact, value)) = bounds.next() {
            let what = "slip bound";
            return Err(ContactError::Coefficient { contact, what, value });
        }
        Ok(Self {
            decomposition,
            supports,
            springs,
            couplings,
            equations,
            equation_rows,
            surfaces,
            handed_on,
            conditions,
            points,
            has_rows,
            stands,
            ties,
            constraints,
            loads,
            poses,
            rounding,
            apart,
            faceted,
            search,
        })
    }

    /// The nodal forces of the loads of a scene that differs in nothing else.
    pub(crate) fn forces(&self, scene: &Scene) -> Result<Vec<Vec<Vec<f64>>>, ContactError> {
        scene.validate()?;
        self.couplings.check_loads(scene)?;
        let [softest, _] = check_materials(scene)?;
        nodal_loads(scene, (&self.decomposition, &self.couplings), softest)
    }

    /// The contact points that have rows.
    pub(crate) fn with_rows(&self) -> impl Iterator<Item = &ContactPoint> {
        self.points.iter().zip(&self.has_rows).filter(|p| *p.1).map(|p| p.0)
    }
}

/// The contact points as `tfeti` wants them, and behind them the tied ones.
fn constraints(
    scene: &Scene,
    points: &[ContactPoint],
    ties: &[ContactPoint],
    couplings: &Couplings,
) -> Vec<ContactConstraint> {
    let point = |p: &ContactPoint| {
        let contact = &scene.contacts[p.surface];
        ContactConstraint {
            partner: p.sides.partner.clone(),
            friction: contact.friction().is_some(),
            moving: contact.moves() && !contact.tied,
            tied: contact.tied,
            relative: couplings
                .relative(p.surface)
                .map(|subdomain| (subdomain, p.sides.sign())),
            stretch: p.stretch,
            compliance: p.compliance.map(|c| c / p.area),
            ..ContactConstraint::new(p.sides.own.clone(), p.frame)
        }
    };
    points.iter().chain(ties).map(point).collect()
}
