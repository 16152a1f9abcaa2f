//! Products with `G = R^T B^T` straight from the tables, without vectors on the boundary.
//!
//! Interface rows are worked on glob by glob, the others by the position of their node (its *arm*).

use super::globs::{GlobTables, Wrench};
use super::points::PointTables;
use super::{BoundaryMap, LANES, over_lanes};
use crate::class::Classes;
use crate::gluing::Gluing;
use crate::kernel::{Kernel, add_wrench};
use crate::matrices::ClassBase;
use signorini_fem_mesh::internal::buckets;
use std::ops::Range;

/// Arms of the boundary nodes of all classes in metres, and the rows of `B` grouped by nodes.
#[derive(Debug)]
pub(crate) struct RigidTables {
    arms: Vec<[f64; 3]>,
    contact: PointTables,
    supports: PointTables,
    globs: GlobTables,
    /// Copies of each subdomain with rows that are no interface rows: place among those of the map, and arm.
    special_pointers: Vec<u32>,
    specials: Vec<[u32; 2]>,
    /// Consecutive subdomains with about equal work.
    tasks: Vec<Range<usize>>,
}

/// Least work of a task, in entries of tables: some microseconds.
const TASK: usize = 512;

impl RigidTables {
    pub(crate) fn new(
        map: &BoundaryMap,
        bases: &[ClassBase],
        classes: &Classes,
        gluing: &Gluing,
    ) -> Self {
        let (mut arms, mut first, mut places) = (Vec::new(), Vec::new(), Vec::new());
        for (class, base) in map.classes.iter().zip(bases) {
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
            let (class, _) = classes.place(subdomain as usize);
            [subdomain, places[class][local as usize]]
        };
        let contact = gluing.ranges().interface.start;
        let kernel = |subdomain: u32| {
            let (class, _) = classes.place(subdomain as usize);
            (class, &bases[class].kernel)
        };
        let points = |specials| PointTables::new(gluing, specials, copy);
        let (globs, (contact, supports)) = rayon::join(
            || GlobTables::new(gluing, classes.subdomains(), kernel),
            || (points(0..contact), points(contact..gluing.specials())),
        );
        let (special_pointers, specials) = special_copies(map, &first, classes.subdomains());
        let mut out = Self {
            arms,
            contact,
            supports,
            globs,
            special_pointers,
            specials,
            tasks: Vec::new(),
        };
        out.cut(classes.subdomains());
        out
    }

    /// Cuts the subdomains into tasks; the cuts depend on the problem only.
    fn cut(&mut self, count: usize) {
        let work = |s: usize| 4 * self.specials_of(s).len() + self.globs.sides_of(s).len() + 4;
        let total: usize = (0..count).map(work).sum();
        let tasks = (total / TASK).clamp(1, LANES);
        let (mut list, mut done, mut start) = (Vec::new(), 0, 0);
        for s in 0..count {
            done += work(s);
            if done * tasks >= total * (list.len() + 1) || s + 1 == count {
                list.push(start..s + 1);
                start = s + 1;
            }
        }
        self.tasks = list;
    }

    fn specials_of(&self, subdomain: usize) -> &[[u32; 2]] {
        let pointers = &self.special_pointers;
        &self.specials[pointers[subdomain] as usize..pointers[subdomain + 1] as usize]
    }

    /// Length of the work memory of [`BoundaryMap::wrenches`].
    pub(crate) fn work(&self) -> usize {
        self.globs.len()
    }
}

/// Copies with rows that are no interface rows by subdomain, in the order of the map, with their arms.
fn special_copies(
    map: &BoundaryMap,
    first: &[usize],
    subdomains: usize,
) -> (Vec<u32>, Vec<[u32; 2]>) {
    let (mut owners, mut copies) = (Vec::new(), Vec::new());
    for panel in &map.panels {
        let members = &map.classes[panel.class].members[panel.columns.clone()];
        for k in panel.specials.clone() {
            let copy = map.special_copies[k] as usize - panel.copies.start;
            let arm = first[panel.class] + copy / members.len();
            owners.push(members[copy % members.len()]);
            copies.push([k as u32, arm as u32]);
        }
    }
    let (pointers, order) = buckets(subdomains, &owners);
    let sorted = order.iter().map(|&k| copies[k as usize]).collect();
    (pointers, sorted)
}

impl BoundaryMap {
    /// `R^T B^T W x`, six numbers a subdomain; `W` is one on interface rows and given by `weights` on the others.
    pub(crate) fn wrenches<'k>(
        &self,
        tables: &RigidTables,
        kernel: impl Fn(usize) -> &'k Kernel + Sync,
        x: &[f64],
        weights: Option<&[f64]>,
        out: &mut [f64],
        sides: &mut [Wrench],
    ) {
        let (interface, parallel) = (&x[self.interface.clone()], self.is_large());
        tables.globs.wrenches(interface, sides, parallel);
        let (out, _) = out.as_chunks_mut();
        let mut none = [(); LANES];
        let work = &mut none[..tables.tasks.len()];
        let offset = |task: &Range<usize>| task.start;
        over_lanes(
            &tables.tasks,
            work,
            out,
            &offset,
            parallel,
            &|task, (), out| {
                for (s, target) in task.clone().zip(out) {
                    let mut wrench = tables.globs.wrench(s, sides);
                    for &[special, arm] in tables.specials_of(s) {
                        let force = self.special_force(special as usize, x, weights);
                        add_wrench(&mut wrench, &tables.arms[arm as usize], force);
                    }
                    *target = on_modes(kernel(s), &wrench);
                }
            },
        );
    }

    /// The same for the contact rows `x` alone, where most are zero.
    pub(crate) fn contact_wrenches<'k>(
        &self,
        tables: &RigidTables,
        kernel: impl Fn(usize) -> &'k Kernel,
        x: &[f64],
        out: &mut [f64],
    ) {
        let (out, _) = out.as_chunks_mut();
        out.fill([0.0; 6]);
        tables.contact.add_wrenches(&tables.arms, x, out);
        for (s, target) in out.iter_mut().enumerate().filter(|(_, w)| **w != [0.0; 6]) {
            *target = on_modes(kernel(s), target);
        }
    }

    /// Force of the rows that are no interface rows on one copy.
    #[inline]
    fn special_force(&self, special: usize, x: &[f64], weights: Option<&[f64]>) -> [f64; 3] {
        let mut force = [0.0; 3];
        let pointers = &self.special_pointers[special..special + 2];
        for e in pointers[0] as usize..pointers[1] as usize {
            let row = self.special_rows[e] as usize;
            let value = x[row] * weights.map_or(1.0, |w| w[row]);
            for c in 0..3 {
                force[c] += self.special_vectors[e][c] * value;
            }
        }
        force
    }

    /// Hands `B R alpha` to `interface(x, value)` and `other(row, x, value)`, row by row, with the entries of `x`;
    /// contact rows are left out on demand.
    /// `motions` are those of the subdomains, about their means, rotations in radians.
    pub(crate) fn for_motions(
        &self,
        tables: &RigidTables,
        motions: &[[f64; 6]],
        x: &mut [f64],
        with_contact: bool,
        interface: impl Fn(&mut f64, f64) + Sync,
        other: impl Fn(usize, &mut f64, f64) + Sync,
    ) {
        let (contact, rest) = x.split_at_mut(self.interface.start);
        let (inner, dirichlet) = rest.split_at_mut(self.interface.len());
        let second = self.interface.end;
        let others = |contact: &mut [f64], dirichlet: &mut [f64]| {
            let arms = &tables.arms;
            if with_contact {
                tables.contact.motions(motions, arms, contact, &other);
            }
            let other = |row, x: &mut f64, v| other(second + row, x, v);
            tables.supports.motions(motions, arms, dirichlet, &other);
        };
        if self.is_large() {
            rayon::join(
                || tables.globs.motions(motions, inner, true, &interface),
                || others(contact, dirichlet),
            );
        } else {
            tables.globs.motions(motions, inner, false, &interface);
            others(contact, dirichlet);
        }
    }
}

/// `R^T` of a wrench in metres about the mean of the nodes.
fn on_modes(kernel: &Kernel, wrench: &[f64; 6]) -> [f64; 6] {
    let [.., x, y, z] = wrench.map(|m| m / kernel.radius());
    kernel.project_wrench(&[wrench[0], wrench[1], wrench[2], x, y, z])
}
