//! Products with `G = R^T B^T` straight from the tables, without vectors on the boundary.
//!
//! Interface rows are worked on glob by glob, the others by the position of their node (its *arm*).

use super::globs::{GlobTables, Wrench};
use super::points::PointTables;
use crate::dual::boundary::{BoundaryMap, over_tasks, shares};
use crate::linalg::both;
use crate::rows::gluing::Gluing;
use crate::subdomain::kernel::{Kernel, add_wrench};
use crate::subdomain::matrices::Subdomains;
use crate::subdomain::ownership::pieces;
use crate::tolerances::{PARTS, SUBDOMAIN_TASK};
use signorini_fem_mesh::internal::Lists;
use std::ops::Range;
use std::sync::Arc;

/// Arms of the boundary nodes of all classes in metres, and the rows of `B` grouped by nodes.
#[derive(Debug)]
pub(crate) struct RigidTables {
    subdomains: Arc<Subdomains>,
    arms: Vec<[f64; 3]>,
    contact: PointTables,
    supports: PointTables,
    globs: GlobTables,
    /// Copies of each subdomain with rows that are no interface rows: place among those of the map, and arm.
    nodal: Lists<[u32; 2]>,
    /// Consecutive subdomains with about equal work.
    tasks: Vec<Range<usize>>,
    /// Where ranks keep parts of vectors: the rank of each subdomain, and the ranks of consecutive entries of `G x`.
    ranks: Vec<u32>,
    pieces: Vec<(usize, Range<usize>)>,
}

impl RigidTables {
    /// Of all rows, or of those of a rank's part; the latter with the rank of each subdomain.
    pub(crate) fn new(map: &BoundaryMap, subdomains: Arc<Subdomains>, gluing: &Gluing, ranks: Vec<u32>) -> Self {
        let (mut arms, mut first, mut places) = (Vec::new(), Vec::new(), Vec::new());
        for (class, base) in map.classes.iter().zip(&subdomains.bases) {
            first.push(arms.len());
            let mut place = vec![u32::MAX; base.kernel.nodes()];
            for &node in &class.nodes {
                place[node as usize] = arms.len() as u32;
                let radius = base.kernel.radius();
                arms.push(base.kernel.arm(node as usize).map(|a| a * radius));
            }
            places.push(place);
        }
        let copy = |subdomain: u32, local: u32| {
            let class = subdomains.class(subdomain as usize);
            [subdomain, places[class][local as usize]]
        };
        let contact = gluing.ranges().interface.start;
        let kernel = |subdomain: u32| {
            let class = subdomains.class(subdomain as usize);
            (class, &subdomains.bases[class].kernel)
        };
        let points = |nodal| PointTables::new(gluing, nodal, copy);
        let (globs, (contact, supports)) = rayon::join(
            || GlobTables::new(gluing, subdomains.count(), kernel),
            || (points(0..contact), points(contact..gluing.nodal_rows())),
        );
        let nodal = nodal_copies(map, &first, subdomains.count());
        let mut out = Self {
            subdomains,
            arms,
            contact,
            supports,
            globs,
            nodal,
            tasks: vec![],
            pieces: pieces(&ranks, 6),
            ranks,
        };
        let work = |s: usize| 4 * out.nodal.of(s).len() + out.globs.sides_of(s).len() + 4;
        let work: Vec<u64> = (0..out.subdomains.count()).map(|s| work(s) as u64).collect();
        out.tasks = shares(&work, SUBDOMAIN_TASK, PARTS);
        out
    }

    /// Length of the work memory of [`wrenches`](Self::wrenches).
    pub(crate) fn work(&self) -> usize {
        self.globs.len()
    }
}

/// Copies with rows that are no interface rows by subdomain, in the order of the map, with their arms.
fn nodal_copies(map: &BoundaryMap, first: &[usize], subdomains: usize) -> Lists<[u32; 2]> {
    let (mut owners, mut copies) = (Vec::new(), Vec::new());
    for panel in &map.panels {
        let members = &map.classes[panel.class].members[panel.columns.clone()];
        for k in panel.nodal.clone() {
            let copy = map.nodal_copies[k] as usize - panel.copies.start;
            let arm = first[panel.class] + copy / members.len();
            owners.push(members[copy % members.len()]);
            copies.push([k as u32, arm as u32]);
        }
    }
    Lists::by_key(subdomains, &owners).map(|k| copies[k as usize])
}

impl RigidTables {
    /// `R^T B^T W x`, six numbers a subdomain; `W` is one on interface rows and given by `weights` on the others. Where
    /// ranks keep parts of vectors, on the subdomains of this one.
    pub(crate) fn wrenches(
        &self,
        map: &BoundaryMap,
        x: &[f64],
        weights: Option<&[f64]>,
        out: &mut [f64],
        sides: &mut [Wrench],
    ) {
        let (interface, parallel) = (&x[map.interface.clone()], map.is_large());
        self.globs.wrenches(interface, sides, parallel);
        let (out, _) = out.as_chunks_mut();
        let offset = |task: &Range<usize>| task.start;
        over_tasks(&self.tasks, out, &offset, parallel, &|task, out| {
            for (s, target) in task.clone().zip(out).filter(|(s, _)| self.is_here(map, *s)) {
                let mut wrench = self.globs.wrench(s, sides);
                for &[nodal, arm] in self.nodal.of(s) {
                    let force = nodal_force(map, nodal as usize, x, weights);
                    add_wrench(&mut wrench, &self.arms[arm as usize], force);
                }
                *target = on_modes(self.subdomains.kernel(s), &wrench);
            }
        });
    }

    /// Brings what each rank has of them to all.
    pub(crate) fn complete(&self, map: &BoundaryMap, out: &mut [f64]) {
        if !self.pieces.is_empty() {
            map.exchange().complete(out, &self.pieces);
        }
    }

    fn is_here(&self, map: &BoundaryMap, subdomain: usize) -> bool {
        let rank = self.ranks.get(subdomain);
        rank.is_none_or(|rank| *rank as usize == map.exchange().rank())
    }

    /// The same for the contact rows `x` alone, where most are zero.
    pub(crate) fn contact_wrenches(&self, x: &[f64], out: &mut [f64]) {
        let (out, _) = out.as_chunks_mut();
        out.fill([0.0; 6]);
        self.contact.add_wrenches(&self.arms, x, out);
        for (s, target) in out.iter_mut().enumerate().filter(|(_, w)| **w != [0.0; 6]) {
            *target = on_modes(self.subdomains.kernel(s), target);
        }
    }

    /// `B R alpha` on the contact rows, from the motions of the subdomains.
    pub(crate) fn contact_motions(&self, motions: &[[f64; 6]], x: &mut [f64]) {
        self.contact.motions(motions, &self.arms, x, &|_, x, v| *x = v);
    }

    /// Hands `B R alpha` to `interface(x, value)` and `other(row, x, value)`, row by row, with the entries of `x`;
    /// contact rows are left out on demand.
    /// `motions` are those of the subdomains, about their means, rotations in radians.
    pub(crate) fn for_motions(
        &self,
        map: &BoundaryMap,
        motions: &[[f64; 6]],
        x: &mut [f64],
        with_contact: bool,
        interface: impl Fn(&mut f64, f64) + Sync,
        other: impl Fn(usize, &mut f64, f64) + Sync,
    ) {
        let (contact, rest) = x.split_at_mut(map.interface.start);
        let (inner, dirichlet) = rest.split_at_mut(map.interface.len());
        let second = map.interface.end;
        let others = |contact: &mut [f64], dirichlet: &mut [f64]| {
            let arms = &self.arms;
            if with_contact {
                self.contact.motions(motions, arms, contact, &other);
            }
            let other = |row, x: &mut f64, v| other(second + row, x, v);
            self.supports.motions(motions, arms, dirichlet, &other);
        };
        let large = map.is_large();
        both(
            large,
            || self.globs.motions(motions, inner, large, &interface),
            || others(contact, dirichlet),
        );
    }
}

/// Force of the rows that are no interface rows on one copy.
#[inline]
fn nodal_force(map: &BoundaryMap, nodal: usize, x: &[f64], weights: Option<&[f64]>) -> [f64; 3] {
    let mut force = [0.0; 3];
    let pointers = &map.nodal_pointers[nodal..nodal + 2];
    for e in pointers[0] as usize..pointers[1] as usize {
        let row = map.nodal_rows[e] as usize;
        let value = x[row] * weights.and_then(|w| w.get(row)).copied().unwrap_or(1.0);
        for c in 0..3 {
            force[c] += map.nodal_vectors[e][c] * value;
        }
    }
    force
}

/// `R^T` of a wrench in metres about the mean of the nodes.
fn on_modes(kernel: &Kernel, wrench: &[f64; 6]) -> [f64; 6] {
    let [.., x, y, z] = wrench.map(|m| m / kernel.radius());
    kernel.project_wrench(&[wrench[0], wrench[1], wrench[2], x, y, z])
}
