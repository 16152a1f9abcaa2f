//! Rigid couplings: subdomains without elements behind the others.

use super::points::ContactPoint;
use super::supports::Supports;
use crate::error::ContactError;
use crate::scene::{Coupling, CouplingLoad, Place, Scene};
use crate::tolerances::ALONG;
use signorini_fem_mesh::Decomposition;
use signorini_fem_mesh::internal::distinct;
use signorini_fem_mesh::vec3::{cross, is_finite, norm, sub};
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
            let nodes = out.nodes(scene, index, supports)?;
            let point = coupling.reference;
            let places: Vec<_> = nodes.iter().map(|&n| scene.mesh.points()[n as usize]).collect();
            let refuse = |reason| {
                let (coupling, node) = (index, None);
                Err(ContactError::Coupling { coupling, node, reason })
            };
            if !is_finite(point) || coupling.motions.iter().any(|m| m.0.iter().any(|v| !v.is_finite())) {
                return refuse("its reference point and its motions must be finite");
            }
            if forces_at_three(&places, point, [0.0; 3], [0.0; 3]).is_none() {
                return refuse("its nodes lie on one line, or are less than three; give it nodes that do not");
            }
            if supports.nodes.iter().any(|s| s.nodes.is_empty()) {
                return refuse("a support has no other nodes, and says the same; leave the support out");
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

    /// Nodes of a coupling, checked; supports that say the same of them are left out.
    fn nodes(&mut self, scene: &Scene, index: usize, supports: &mut Supports) -> Result<Vec<u32>, ContactError> {
        let count = scene.mesh.points().len();
        let coupling = &scene.couplings[index];
        let nodes = match &coupling.place {
            Place::Tag(tag) => match scene.mesh.nodes_on(*tag) {
                nodes if nodes.is_empty() => return Err(scene.unknown_tag("coupling", index, *tag)),
                nodes => nodes,
            },
            Place::Nodes(nodes) => distinct(nodes.iter().copied()),
        };
        for &node in &nodes {
            let reason = match () {
                () if node as usize >= count => "the mesh has no such node; they are numbered from 0",
                () if self.of_node.contains_key(&node) => {
                    "it is in another coupling, too; give it to one of them, or make one coupling of both"
                }
                () if !says_the_same(scene, coupling, node, supports) => {
                    "a support holds it in a direction that the coupling leaves free, or moves it; hold the coupling \
                        so (with_held), or leave the node out of one of them"
                }
                () => {
                    supports.release(node);
                    self.of_node.insert(node, index);
                    continue;
                }
            };
            return Err(ContactError::Coupling {
                coupling: index,
                node: Some(node),
                reason,
            });
        }
        Ok(nodes)
    }

    /// Refuses contact points between what is rigid on both sides.
    pub(super) fn check_contact<'a>(&self, points: impl Iterator<Item = &'a ContactPoint>) -> Result<(), ContactError> {
        if self.of_node.is_empty() {
            return Ok(());
        }
        for point in points {
            let mut nodes = point.sides.nodes().map(|n| self.of_node.get(&n.0));
            if let Some(&coupling) = self.of_node.get(&point.node())
                && nodes.all(|c| c.is_some())
            {
                let reason = "what it could touch is rigid, too, so that no contact force is determined; leave the \
                    nodes that may touch out of the coupling";
                return Err(ContactError::Coupling {
                    coupling,
                    node: Some(point.node()),
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

/// Whether supports hold a node only where what is held of a coupling holds it, too, and neither moves it there.
fn says_the_same(scene: &Scene, coupling: &Coupling, node: u32, supports: &Supports) -> bool {
    let Some(held) = supports.directions.get(&node) else {
        return true;
    };
    let arm = sub(scene.mesh.points()[node as usize], coupling.reference);
    held.iter().all(|PrescribedDirection { direction, support, .. }| {
        // what each motion of the coupling does to the node along the direction
        let parts: Vec<f64> = [*direction, cross(arm, *direction)].concat();
        let size = |c: usize| if c < 3 { 1.0 } else { norm(arm) };
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
