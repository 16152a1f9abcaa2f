//! Rigid couplings: subdomains without elements behind the others.

use super::free_points::{check_point, idle, sizes};
use super::points::ContactPoint;
use super::supports::Supports;
use crate::error::ContactError;
use crate::part::Part;
use crate::scene::{Coupled, Coupling, CouplingLoad, Place, Scene};
use crate::tolerances::{ALONG, FAR};
use signorini_fem_mesh::decomposition::Rigid;
use signorini_fem_mesh::internal::distinct;
use signorini_fem_mesh::vec3::{Vec3, add, cross, dot, is_finite, norm, scale, sub};
use signorini_fem_mesh::{Decomposition, History, LoadError, SurfaceFrame};
use signorini_tfeti::internal::{FixedDirection, HeldTie, forces_at_three, held_ties};
use signorini_tfeti::{ContactConstraint, Directions, NodeSupport, RigidSupport, Side};
use std::collections::{BTreeMap, BTreeSet};

/// The couplings of a scene.
#[derive(Debug, Default)]
pub(crate) struct Couplings {
    /// Subdomain of the first one: the number of those with elements.
    pub(crate) first: usize,
    /// What is held, with the coupling and the component, one a row.
    pub(crate) supports: Vec<RigidSupport>,
    /// The coupling of each node that has one.
    of_node: BTreeMap<u32, usize>,
    /// Of tied contacts whose sides move relative to each other the coupling that says how.
    relative: BTreeMap<usize, usize>,
    /// Of each coupling, along and about which it is told what is held.
    pub(crate) axes: Vec<[Vec3; 3]>,
    /// The point of each whose displacement is told: its reference point, or of a point alone the mean of its places,
    /// any of which has the displacement.
    pub(crate) about: Vec<Vec3>,
    /// Displacement of the nodes per unit displacement of the point, so that both are of one size; 1 for others.
    pub(crate) unit: Vec<f64>,
}

impl Couplings {
    /// With the decomposition of all subdomains; `supports` get the histories of their motions.
    pub(super) fn new(
        scene: &Scene,
        decomposition: Decomposition,
        supports: &mut Supports,
    ) -> Result<(Decomposition, Self), ContactError> {
        let mut out = Self {
            first: decomposition.subdomains().len(),
            ..Self::default()
        };
        if scene.couplings.is_empty() {
            return Ok((decomposition, out));
        }
        let mut rigid = Vec::with_capacity(scene.couplings.len());
        for (index, unit) in sizes(scene).into_iter().enumerate() {
            let nodes = out.nodes_of(scene, index)?;
            let placed = Placed::new(scene, index, &nodes)?;
            let relative = !matches!(placed.coupling.coupled, Coupled::Nodes(_));
            if !relative {
                out.take(scene, &placed, &nodes, supports)?;
            }
            out.hold(scene, &placed, unit, supports)?;
            rigid.push(if relative { Rigid::Places(nodes) } else { Rigid::Nodes(nodes) });
            out.axes.push(placed.axes);
            out.about.push(placed.point);
            out.unit.push(unit);
        }
        Ok((decomposition.with_rigid(rigid)?, out))
    }

    /// Takes the nodes that a coupling moves out of the supports, which must say the same of them.
    fn take(
        &mut self,
        scene: &Scene,
        placed: &Placed<'_>,
        nodes: &[u32],
        supports: &mut Supports,
    ) -> Result<(), ContactError> {
        let &Placed { index, coupling, .. } = placed;
        let refuse = |node, reason| Err(ContactError::coupling(index, node, reason));
        for &node in nodes {
            if self.of_node.insert(node, index).is_some() {
                let why = "it is in another coupling, too; give it to one of them, or make one coupling of both";
                return refuse(Some(node), why);
            }
            let arm = sub(scene.mesh.points()[node as usize], coupling.reference);
            let is_said = |held: &FixedDirection| {
                let rests = scene.supports[held.support].motion.is_none() && !scene.has_started(held.support);
                rests && stays(coupling, &placed.axes, arm, placed.extent, held.direction)
            };
            if !supports.merged.directions(node).iter().all(is_said) {
                let why = "a support holds it in a direction that the coupling leaves free, or moves it; hold the \
                    coupling so (with_held), or leave the node out of one of them";
                return refuse(Some(node), why);
            }
        }
        supports.release(nodes);
        let holds = |s: &NodeSupport| s.directions != Directions::Nothing;
        if supports.nodes.iter().any(|s| s.nodes.is_empty() && holds(s)) {
            let why = "a support holds nothing but some of its nodes, and says the same; leave the support out";
            return refuse(nodes.first().copied(), why);
        }
        Ok(())
    }

    /// Holds what a coupling says is held, and what of a point nothing says anything of.
    fn hold(
        &mut self,
        scene: &Scene,
        placed: &Placed<'_>,
        unit: f64,
        supports: &mut Supports,
    ) -> Result<(), ContactError> {
        let &Placed {
            index, coupling, axes, ..
        } = placed;
        let support = |direction, values| RigidSupport {
            subdomain: (self.first + index) as u32,
            point: placed.point,
            direction,
            values,
        };
        let cases: Vec<u32> = coupling.motions.iter().map(|(_, h)| supports.case(h)).collect();
        let locked = coupling.locked.iter().any(Option::is_some);
        let still = locked.then(|| supports.case(&History::constant(1.0)));
        let holds = coupling.holds();
        let held = (0..6).filter(|&c| holds[c]).map(|component| {
            let mut direction = [[0.0; 3]; 2];
            direction[component / 3] = axes[component % 3];
            let values = cases.iter().zip(&coupling.motions);
            let values = values.map(|(&case, (motion, _))| (case, motion[component]));
            let values = values.chain(still.zip(coupling.locked[component]));
            let values = values.map(|(case, value)| (case, unit * value));
            support(direction, values.filter(|v| v.1 != 0.0).collect())
        });
        self.supports.extend(held);
        if coupling.is_point() {
            let idle = idle(scene, index, &axes)?.into_iter();
            self.supports
                .extend(idle.map(|along| support([along, [0.0; 3]], Vec::new())));
        }
        Ok(())
    }

    /// Refuses loads that points cannot take.
    pub(super) fn check_loads(&self, scene: &Scene) -> Result<(), ContactError> {
        let points = scene.couplings.iter().zip(&self.axes).enumerate();
        for (index, (_, axes)) in points.filter(|(_, (coupling, _))| coupling.is_point()) {
            check_point(scene, index)?;
            idle(scene, index, axes)?;
        }
        Ok(())
    }

    /// The subdomain of the motion that the sides of a tied contact have relative to each other, if they have.
    pub(crate) fn relative(&self, contact: usize) -> Option<u32> {
        self.relative
            .get(&contact)
            .map(|coupling| (self.first + coupling) as u32)
    }

    /// Nodes of a coupling, ascending; of a relative one those of both sides, of a point any that are not on a line.
    fn nodes_of(&mut self, scene: &Scene, coupling: usize) -> Result<Vec<u32>, ContactError> {
        let count = scene.mesh.points().len();
        let refuse = |node, reason| ContactError::coupling(coupling, node, reason);
        match &scene.couplings[coupling].coupled {
            Coupled::Nodes(Place::Tag(tag)) => match scene.mesh.nodes_on(*tag) {
                nodes if nodes.is_empty() => Err(scene.unknown_tag(Part::Coupling(coupling), *tag)),
                nodes => Ok(nodes),
            },
            Coupled::Nodes(Place::Nodes(nodes)) => match nodes.iter().find(|n| **n as usize >= count) {
                None => Ok(distinct(nodes.iter().copied())),
                Some(&node) => Err(refuse(
                    Some(node),
                    "the mesh has no such node; they are numbered from 0",
                )),
            },
            Coupled::Point => {
                let places = scene.mesh.points();
                let chosen = forces_at_three(places, places[0], [0.0; 3], [0.0; 3]);
                Ok(distinct(chosen.into_iter().flatten().map(|(node, _)| node as u32)))
            }
            Coupled::Tied(contact) => {
                let tied = scene.contacts.get(*contact).filter(|c| c.tied);
                let tied = tied.ok_or_else(|| {
                    refuse(
                        None,
                        "there is no tied contact of its number; they are numbered from 0, with the others",
                    )
                })?;
                if tied.start().or(tied.end()).is_some() {
                    return Err(refuse(
                        None,
                        "its contact starts or ends, and without it no motion of one side relative to the other is \
                        there; let the contact act at all steps",
                    ));
                }
                if self.relative.insert(*contact, coupling).is_some() {
                    return Err(refuse(
                        None,
                        "another coupling says how the sides of its contact move, too",
                    ));
                }
                Ok(distinct(tied.side_tags().flat_map(|tag| scene.mesh.nodes_on(tag))))
            }
        }
    }

    /// The components along its axes of the motion of a coupling: displacement and rotation.
    pub(crate) fn along(&self, coupling: usize, motion: [Vec3; 2]) -> [f64; 6] {
        let axes = &self.axes[coupling];
        std::array::from_fn(|c| dot(axes[c % 3], motion[c / 3]))
    }

    /// Whether a node is in a coupling.
    pub(crate) fn has(&self, node: u32) -> bool {
        self.of_node.contains_key(&node)
    }

    /// Refuses contact points between what is rigid on both sides, of a mean in a good part: coupled, an obstacle, or
    /// held along the normal.
    pub(super) fn check_contact<'a>(
        &self,
        points: impl Iterator<Item = &'a ContactPoint>,
        supports: &Supports,
    ) -> Result<(), ContactError> {
        if self.of_node.is_empty() {
            return Ok(());
        }
        let is_held = |node: u32, normal: Vec3| {
            let held = supports.merged.directions(node).iter();
            held.map(|d| dot(d.direction, normal).powi(2)).sum::<f64>() >= 1.0 - ALONG
        };
        for point in points {
            let sides = &point.sides;
            let Some((node, coupling)) = sides.nodes().find_map(|(n, _)| Some((n, *self.of_node.get(&n)?))) else {
                continue;
            };
            let stiff = |side: &Side| -> f64 {
                let stiff = side.nodes().iter();
                let stiff = stiff.filter(|(n, _)| self.has(*n) || is_held(*n, point.frame.normal));
                stiff.map(|(_, weight)| weight).sum()
            };
            let least = match sides.partner {
                None => 1.0 - ALONG,
                Some(_) => sides.own.held_from(),
            };
            if stiff(&sides.own) >= least && sides.partner.as_ref().is_none_or(|partner| stiff(partner) >= least) {
                let reason = "what it could touch is rigid or held, too, so that no contact force is determined; leave \
                    the nodes that may touch out of the coupling";
                return Err(ContactError::coupling(coupling, Some(node), reason));
            }
        }
        Ok(())
    }

    /// Refuses ties whose sides supports hold both where their relative motion is not held at zero: no row would say
    /// what it is there. Likewise where both sides rub on obstacles from the start: how they share the normal force is
    /// not determined, nor then their friction. The points are those of the first constraints.
    pub(super) fn check_ties(
        &self,
        scene: &Scene,
        (points, rounding): (&[ContactPoint], f64),
        constraints: &[ContactConstraint],
        supports: &Supports,
    ) -> Result<(), ContactError> {
        if self.relative.is_empty() {
            return Ok(());
        }
        let coupling = |tied: &ContactConstraint| Some(tied.relative?.0 as usize - self.first);
        let touching = points
            .iter()
            .zip(constraints)
            .filter(|(point, _)| point.gap <= rounding);
        let rough = touching.filter(|(_, c)| c.friction && c.partner.is_none());
        let rough: BTreeSet<u32> = rough.flat_map(|(_, c)| c.side.nodes()).map(|n| n.0).collect();
        for tied in constraints {
            let (Some(coupling), Some(partner)) = (coupling(tied), &tied.partner) else {
                continue;
            };
            let rubs = |side: &Side| side.nodes().iter().map(|n| n.0).find(|node| rough.contains(node));
            if let (Some(node), Some(_)) = (rubs(&tied.side), rubs(partner)) {
                let reason = "both sides of the cut touch obstacles with friction there, and how they share the force is not \
                    determined; cut the body where it touches nothing, or leave one side out of the contact";
                return Err(ContactError::coupling(coupling, Some(node), reason));
            }
        }
        for HeldTie { point, direction, .. } in held_ties(constraints, &supports.merged) {
            let (tied, node) = (&constraints[point], constraints[point].side.nodes()[0].0);
            let Some(index) = coupling(tied) else {
                continue;
            };
            let coupling = &scene.couplings[index];
            let arm = sub(scene.mesh.points()[node as usize], coupling.reference);
            if !stays(coupling, &self.axes[index], arm, norm(arm), direction) {
                let reason = "supports hold both sides in a direction in which they may move relative to each other; \
                    leave the nodes of one side out of the supports, or let the coupling hold this motion at zero";
                return Err(ContactError::coupling(index, Some(node), reason));
            }
        }
        Ok(())
    }

    /// The nodal forces of a load on one of them, subdomain by subdomain.
    pub(super) fn forces(
        &self,
        scene: &Scene,
        decomposition: &Decomposition,
        (index, load): (usize, &CouplingLoad),
    ) -> Result<Vec<Vec<f64>>, ContactError> {
        let &CouplingLoad {
            coupling,
            force,
            moment,
        } = load;
        let subdomains = decomposition.subdomains();
        let mut out: Vec<Vec<f64>> = subdomains.iter().map(|s| vec![0.0; s.dofs()]).collect();
        let rigid = out.iter_mut().zip(subdomains).skip(self.first);
        let Some((target, nodes)) = rigid.take(scene.couplings.len()).nth(coupling) else {
            let couplings = scene.couplings.len();
            return Err(ContactError::UnknownCoupling {
                load: index,
                coupling,
                couplings,
            });
        };
        let place = scene.couplings[coupling].reference;
        if let Some(value) = [force, moment].into_iter().find(|v| !is_finite(*v)) {
            let source = LoadError::NotFinite { place, value };
            return Err(ContactError::Load { index, source });
        }
        let places = nodes.points(&scene.mesh);
        let (about, unit) = (self.about[coupling], self.unit[coupling]);
        // nodes are not on a line: that is checked
        for (node, force) in forces_at_three(&places, about, force, moment).into_iter().flatten() {
            target[3 * node..3 * node + 3].copy_from_slice(&force.map(|f| f / unit));
        }
        Ok(out)
    }
}

/// A coupling that makes sense by itself.
struct Placed<'a> {
    index: usize,
    coupling: &'a Coupling,
    axes: [Vec3; 3],
    /// The point whose displacement is told, see [`Couplings::about`].
    point: Vec3,
    /// How far its nodes are from one another, m.
    extent: f64,
}

impl<'a> Placed<'a> {
    fn new(scene: &'a Scene, index: usize, nodes: &[u32]) -> Result<Self, ContactError> {
        let coupling = &scene.couplings[index];
        let refuse = |reason| Err(ContactError::coupling(index, None, reason));
        let Some(axes) = axes(coupling) else {
            return refuse("its axis has no direction; give it one of finite length, not zero");
        };
        let motions = || coupling.motions.iter().flat_map(|m| m.0.iter().zip(&coupling.held));
        if !is_finite(coupling.reference) || motions().any(|(way, _)| !way.is_finite()) {
            return refuse("its reference point and its motions must be finite");
        }
        if coupling.is_point() {
            check_point(scene, index)?;
        }
        if motions().any(|(way, held)| *way != 0.0 && !held) {
            return refuse("a motion that it does not hold is prescribed; hold it (with_held), or make it zero");
        }
        let is_time = |time: f64| time.is_finite() && time >= 0.0;
        if coupling.lock.is_some_and(|(_, time)| !is_time(time)) {
            return refuse("the time from which it is locked must be finite and not negative");
        }
        let places: Vec<_> = nodes.iter().map(|&n| scene.mesh.points()[n as usize]).collect();
        let point = if coupling.is_point() {
            // not far from them, wherever it is said to be
            scale(1.0 / places.len() as f64, places.iter().copied().fold([0.0; 3], add))
        } else {
            coupling.reference
        };
        if forces_at_three(&places, point, [0.0; 3], [0.0; 3]).is_none() {
            return refuse("its nodes lie on one line, or are less than three; give it nodes that do not");
        }
        let far = |from| places.iter().map(|x| norm(sub(*x, from))).fold(0.0, f64::max);
        let extent = far(places[0]);
        if far(point) > FAR * extent {
            return refuse(
                "its reference point is a million times as far away as its nodes are from one another, where \
                    rounding is all that its motions tell; give it a nearer one",
            );
        }
        Ok(Self {
            index,
            coupling,
            axes,
            point,
            extent,
        })
    }
}

/// Along and about which it is told what is held; `None` if its axis has no direction.
fn axes(coupling: &Coupling) -> Option<[Vec3; 3]> {
    let Some(axis) = coupling.axis else {
        return Some([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    };
    let SurfaceFrame {
        normal,
        tangents: [t1, t2],
    } = SurfaceFrame::from_normal(axis)?;
    Some([normal, t1, t2])
}

/// Whether what is held of a coupling, whose nodes are so far from one another, keeps a node at an arm from its
/// reference point where it is along a direction.
fn stays(coupling: &Coupling, axes: &[Vec3; 3], arm: Vec3, extent: f64, direction: Vec3) -> bool {
    // what each motion of the coupling does to the node along the direction
    let parts = [direction, cross(arm, direction)].map(|part| axes.map(|axis| dot(axis, part)));
    let parts = parts.as_flattened();
    let size = |c: usize| if c < 3 { 1.0 } else { extent };
    let holds = coupling.holds();
    let rests = |motion: &[f64; 6]| {
        let all = || (0..6).map(|c| (motion[c] * parts[c], (motion[c] * size(c)).abs()));
        let (way, most) = all().fold((0.0, 0.0_f64), |(way, most), (own, size)| (way + own, most.max(size)));
        way.abs() <= ALONG * most
    };
    (0..6).all(|c| holds[c] || parts[c].abs() <= ALONG * size(c))
        && coupling.motions.iter().all(|(motion, _)| rests(motion))
        && rests(&coupling.locked.map(|value| value.unwrap_or(0.0)))
}
