//! Products with `G = R^T B^T` straight from the tables, without vectors on the boundary.
//!
//! Interface rows are worked on glob by glob, the others by the position of their node (its *arm*).

use super::globs::{GlobTables, Wrench};
use super::points::PointTables;
use super::{BoundaryMap, Panel};
use crate::class::Classes;
use crate::gluing::Gluing;
use crate::kernel::{Kernel, add_wrench};
use crate::matrices::ClassBase;

/// Arms of the boundary nodes of all classes in metres, and the rows of `B` grouped by nodes.
#[derive(Debug)]
pub(crate) struct RigidTables {
    arms: Vec<[f64; 3]>,
    /// First arm of each class.
    first: Vec<u32>,
    contact: PointTables,
    supports: PointTables,
    globs: GlobTables,
}

impl RigidTables {
    pub(crate) fn new(
        map: &BoundaryMap,
        bases: &[ClassBase],
        classes: &Classes,
        gluing: &Gluing,
    ) -> Self {
        let (mut arms, mut first, mut places) = (Vec::new(), Vec::new(), Vec::new());
        for (class, base) in map.classes.iter().zip(bases) {
            first.push(arms.len() as u32);
            let mut place = vec![u32::MAX; base.kernel.nodes()];
            for &node in &class.nodes {
                place[node as usize] = arms.len() as u32;
                let radius = base.kernel.radius();
                arms.push(base.kernel.arm(node as usize).map(|a| a * radius));
            }
            places.push(place);
        }
        let class_of = |subdomain: u32| classes.place(subdomain as usize).0;
        let copy = |subdomain: u32, local: u32| {
            let place = places[class_of(subdomain)][local as usize];
            [map.column_of[subdomain as usize], place]
        };
        let contact = gluing.ranges().interface.start;
        let kernel = |subdomain: u32| {
            let class = class_of(subdomain);
            (class, &bases[class].kernel)
        };
        let points = |specials| PointTables::new(gluing, specials, copy);
        let (globs, (contact, supports)) = rayon::join(
            || GlobTables::new(gluing, &map.column_of, kernel),
            || (points(0..contact), points(contact..gluing.specials())),
        );
        Self {
            arms,
            first,
            contact,
            supports,
            globs,
        }
    }

    /// Length of the work memory of [`BoundaryMap::wrenches`].
    pub(crate) fn work(&self) -> usize {
        self.globs.len()
    }
}

impl BoundaryMap {
    /// `R^T B^T W x`, six numbers a column; `W` is one on interface rows and given by `weights` on the others.
    pub(crate) fn wrenches(
        &self,
        tables: &RigidTables,
        bases: &[ClassBase],
        x: &[f64],
        weights: Option<&[f64]>,
        columns: &mut [f64],
        sides: &mut [Wrench],
    ) {
        let interface = &x[self.interface.clone()];
        tables.globs.wrenches(interface, sides, self.is_large());
        let sides = &*sides;
        self.for_columns(columns, &|lane, part| {
            let mut rest = part;
            let mut column = lane.column;
            for panel in &self.panels[lane.panels.clone()] {
                let (own, tail) = std::mem::take(&mut rest).split_at_mut(6 * panel.columns.len());
                rest = tail;
                for target in own.chunks_exact_mut(6) {
                    target.copy_from_slice(&tables.globs.column_wrench(column, sides));
                    column += 1;
                }
                let arms = &tables.arms[tables.first[panel.class] as usize..];
                self.row_wrenches(panel, arms, x, weights, own);
                let kernel = &bases[panel.class].kernel;
                for target in own.as_chunks_mut().0 {
                    *target = on_modes(kernel, target);
                }
            }
        });
    }

    /// The same for the contact rows `x` alone, where most are zero.
    pub(crate) fn contact_wrenches(
        &self,
        tables: &RigidTables,
        bases: &[ClassBase],
        x: &[f64],
        columns: &mut [f64],
    ) {
        let (columns, _) = columns.as_chunks_mut();
        columns.fill([0.0; 6]);
        tables.contact.add_wrenches(&tables.arms, x, columns);
        let mut rest = columns;
        for panel in &self.panels {
            let (own, tail) = std::mem::take(&mut rest).split_at_mut(panel.columns.len());
            rest = tail;
            let kernel = &bases[panel.class].kernel;
            for target in own.iter_mut().filter(|w| **w != [0.0; 6]) {
                *target = on_modes(kernel, target);
            }
        }
    }

    /// Adds the wrenches of the rows that are no interface rows on the columns of a panel.
    fn row_wrenches(
        &self,
        panel: &Panel,
        arms: &[[f64; 3]],
        x: &[f64],
        weights: Option<&[f64]>,
        out: &mut [f64],
    ) {
        let width = panel.columns.len();
        for k in panel.specials.clone() {
            let copy = self.special_copies[k] as usize - panel.copies.start;
            let mut force = [0.0; 3];
            for e in self.special_pointers[k] as usize..self.special_pointers[k + 1] as usize {
                let row = self.special_rows[e] as usize;
                let value = x[row] * weights.map_or(1.0, |w| w[row]);
                for c in 0..3 {
                    force[c] += self.special_vectors[e][c] * value;
                }
            }
            let mut sum = [0.0; 6];
            add_wrench(&mut sum, &arms[copy / width], force);
            for (w, s) in out[6 * (copy % width)..][..6].iter_mut().zip(sum) {
                *w += s;
            }
        }
    }

    /// Six numbers a subdomain from six numbers a column.
    pub(crate) fn sort_columns(&self, columns: &[f64], out: &mut [f64]) {
        for (&column, target) in self.column_of.iter().zip(out.chunks_exact_mut(6)) {
            target.copy_from_slice(&columns[6 * column as usize..][..6]);
        }
    }

    /// Hands `B R alpha` to `interface(x, value)` and `other(row, x, value)`, row by row, with the entries of `x`.
    /// `motions` are those of the columns, about their means, rotations in radians.
    pub(crate) fn for_motions(
        &self,
        tables: &RigidTables,
        motions: &[[f64; 6]],
        x: &mut [f64],
        interface: impl Fn(&mut f64, f64) + Sync,
        other: impl Fn(usize, &mut f64, f64) + Sync,
    ) {
        let (contact, rest) = x.split_at_mut(self.interface.start);
        let (inner, dirichlet) = rest.split_at_mut(self.interface.len());
        let second = self.interface.end;
        let others = |contact: &mut [f64], dirichlet: &mut [f64]| {
            let arms = &tables.arms;
            tables.contact.motions(motions, arms, contact, &other);
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
