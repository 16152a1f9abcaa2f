//! Rigid couplings: subdomains without elements behind the others.

use super::points::ContactPoint;
use super::supports::Supports;
use crate::error::ContactError;
use crate::scene::{Coupling, CouplingLoad, Place, Scene};
use crate::tolerances::{ALONG, FAR};
use signorini_fem_mesh::Decomposition;
use signorini_fem_mesh::internal::distinct;
use signorini_fem_mesh::vec3::{Vec3, cross, dot, is_finite, norm, sub};
use signorini_tfeti::RigidSupport;
use signorini_tfeti::internal::{PrescribedDirection, forces_at_three};
use std::collections::BTreeMap;

/// The couplings of a scene.
#[derive(Debug)]
pub(crate) struct Couplings {
    /// Subdomain of the first one: the number of those with elements.
    pub(crate) first: usize,
    /// What is held, with the coupling and the component, one a row.
    pub(crate) supports: Vec<RigidSupport>,
    /// The coupling of each node that has one.
    of_node: BTreeMap<u32, usize>,
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
            supports: Vec::new(),
            of_node: BTreeMap::new(),
        };
        if scene.couplings.is_empty() {
            return Ok((decomposition, out));
        }
        let mut rigid = Vec::with_capacity(scene.couplings.len());
        for (index, coupling) in scene.couplings.iter().enumerate() {
            let nodes = nodes_of(scene, index)?;
            let point = coupling.reference;
            let places: Vec<_> = nodes.iter().map(|&n| scene.mesh.points()[n as usize]).collect();
            let refuse = |node, reason| {
                let coupling = index;
                Err(ContactError::Coupling { coupling, node, reason })
            };
            let motions = || coupling.motions.iter().flat_map(|m| m.0.iter().zip(&coupling.held));
            if !is_finite(point) || motions().any(|(way, _)| !way.is_finite()) {
                return refuse(None, "its reference point and its motions must be finite");
            }
            if motions().any(|(way, held)| *way != 0.0 && !held) {
                return refuse(
                    None,
                    "a motion that it does not hold is prescribed; hold it (with_held), or make it zero",
                );
            }
            if forces_at_three(&places, point, [0.0; 3], [0.0; 3]).is_none() {
                return refuse(
                    None,
                    "its nodes lie on one line, or are less than three; give it nodes that do not",
                );
            }
            let far = |from| places.iter().map(|x| norm(sub(*x, from))).fold(0.0, f64::max);
            let extent = far(places[0]);
            if far(point) > FAR * extent {
                let why = "its reference point is a million times as far away as its nodes are from one another, where \
                    rounding is all that its motions tell; give it a nearer one";
                return refuse(None, why);
            }
            for &node in &nodes {
                if out.of_node.insert(node, index).is_some() {
                    let why = "it is in another coupling, too; give it to one of them, or make one coupling of both";
                    return refuse(Some(node), why);
                }
                if !says_the_same(scene, coupling, (node, extent), supports) {
                    let why = "a support holds it in a direction that the coupling leaves free, or moves it; hold the \
                        coupling so (with_held), or leave the node out of one of them";
                    return refuse(Some(node), why);
                }
            }
            supports.release(&nodes);
            if supports.nodes.iter().any(|s| s.nodes.is_empty()) {
                let why = "a support holds nothing but some of its nodes, and says the same; leave the support out";
                return refuse(nodes.first().copied(), why);
            }
            let subdomain = (out.first + index) as u32;
            let cases: Vec<u32> = coupling.motions.iter().map(|(_, h)| supports.case(h)).collect();
            for component in (0..6).filter(|&c| coupling.held[c]) {
                let values = cases.iter().zip(&coupling.motions);
                let values = values.map(|(&case, (motion, _))| (case, motion[component]));
                out.supports.push(RigidSupport {
                    subdomain,
                    point,
                    component,
                    values: values.filter(|v| v.1 != 0.0).collect(),
                });
            }
            rigid.push(nodes);
        }
        Ok((decomposition.with_rigid(rigid)?, out))
    }

    /// Whether a node is in a coupling.
    pub(crate) fn has(&self, node: u32) -> bool {
        self.of_node.contains_key(&node)
    }

    /// Refuses contact points between what is rigid on both sides: coupled, an obstacle, or held along the normal.
    pub(super) fn check_contact<'a>(
        &self,
        points: impl Iterator<Item = &'a ContactPoint>,
        supports: &Supports,
    ) -> Result<(), ContactError> {
        if self.of_node.is_empty() {
            return Ok(());
        }
        let is_held = |node: u32, normal: Vec3| {
            let held = supports.directions.get(&node).into_iter().flatten();
            held.map(|d| dot(d.direction, normal).powi(2)).sum::<f64>() >= 1.0 - ALONG
        };
        for point in points {
            let nodes = || point.sides.nodes().map(|n| n.0);
            let coupled = nodes().find(|node| self.has(*node));
            if let Some(node) = coupled
                && let Some(&coupling) = self.of_node.get(&node)
                && nodes().all(|node| self.has(node) || is_held(node, point.frame.normal))
            {
                let reason = "what it could touch is rigid or held, too, so that no contact force is determined; leave \
                    the nodes that may touch out of the coupling";
                return Err(ContactError::Coupling {
                    coupling,
                    node: Some(node),
                    reason,
                });
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
        let Some((own, (target, nodes))) = scene.couplings.iter().zip(rigid).nth(coupling) else {
            let couplings = scene.couplings.len();
            return Err(ContactError::UnknownCoupling {
                load: index,
                coupling,
                couplings,
            });
        };
        let places = nodes.points(&scene.mesh);
        // nodes are not on a line: that is checked
        for (node, force) in forces_at_three(&places, own.reference, force, moment)
            .into_iter()
            .flatten()
        {
            target[3 * node..3 * node + 3].copy_from_slice(&force);
        }
        Ok(out)
    }
}

/// Nodes of a coupling, ascending.
fn nodes_of(scene: &Scene, coupling: usize) -> Result<Vec<u32>, ContactError> {
    let count = scene.mesh.points().len();
    match &scene.couplings[coupling].place {
        Place::Tag(tag) => match scene.mesh.nodes_on(*tag) {
            nodes if nodes.is_empty() => Err(scene.unknown_tag("coupling", coupling, *tag)),
            nodes => Ok(nodes),
        },
        Place::Nodes(nodes) => match nodes.iter().find(|n| **n as usize >= count) {
            None => Ok(distinct(nodes.iter().copied())),
            Some(&node) => Err(ContactError::Coupling {
                coupling,
                node: Some(node),
                reason: "the mesh has no such node; they are numbered from 0",
            }),
        },
    }
}

/// Whether supports hold a node only where what is held of a coupling, whose nodes are so far from one another, holds it,
/// too, and neither moves it there.
fn says_the_same(scene: &Scene, coupling: &Coupling, (node, extent): (u32, f64), supports: &Supports) -> bool {
    let Some(held) = supports.directions.get(&node) else {
        return true;
    };
    let arm = sub(scene.mesh.points()[node as usize], coupling.reference);
    held.iter().all(|PrescribedDirection { direction, support, .. }| {
        // what each motion of the coupling does to the node along the direction
        let parts: Vec<f64> = [*direction, cross(arm, *direction)].concat();
        let size = |c: usize| if c < 3 { 1.0 } else { extent };
        let stays = |motion: &[f64; 6]| {
            let all = || (0..6).map(|c| (motion[c] * parts[c], (motion[c] * size(c)).abs()));
            let (way, most) = all().fold((0.0, 0.0_f64), |(way, most), (own, size)| (way + own, most.max(size)));
            way.abs() <= ALONG * most
        };
        scene.supports[*support].motion.is_none()
            && (0..6).all(|c| coupling.held[c] || parts[c].abs() <= ALONG * size(c))
            && coupling.motions.iter().all(|(motion, _)| stays(motion))
    })
}
