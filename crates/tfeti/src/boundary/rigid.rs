//! Products with `G = R^T B^T` straight from the tables, without vectors on the boundary.
//!
//! The rows of `R` at a node follow from its position (its *arm*), so both products compute them again: reading them, or
//! writing forces and motions of all boundary nodes, would take longer.

use super::{BLOCKS, BoundaryMap, Panel};
use crate::cost::PANEL;
use crate::gluing::Gluing;
use crate::kernel::{Kernel, displacement};
use crate::matrices::ClassBase;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Arms of the boundary nodes of all classes, and the copies of the entries of `B`.
#[derive(Debug)]
pub(crate) struct RigidTables {
    arms: Vec<[f64; 3]>,
    /// First arm of each class.
    first: Vec<u32>,
    /// Column and arm of each entry of the interface blocks.
    block_copies: Vec<[u32; 2]>,
    /// The same for the other rows.
    row_copies: Vec<[u32; 2]>,
}

impl RigidTables {
    pub(crate) fn new(map: &BoundaryMap, bases: &[ClassBase], gluing: &Gluing) -> Self {
        let (mut arms, mut first, mut places) = (Vec::new(), Vec::new(), Vec::new());
        for (class, base) in map.classes.iter().zip(bases) {
            first.push(arms.len() as u32);
            let mut place = vec![u32::MAX; base.kernel.nodes()];
            for &node in &class.nodes {
                place[node as usize] = arms.len() as u32;
                arms.push(*base.kernel.arm(node as usize));
            }
            places.push(place);
        }
        let mut class_of = vec![0; map.column_of.len()];
        for (k, class) in map.classes.iter().enumerate() {
            class.members.iter().for_each(|&s| class_of[s as usize] = k);
        }
        let copy = |subdomain: u32, local: u32| {
            let s = subdomain as usize;
            [map.column_of[s], places[class_of[s]][local as usize]]
        };
        let blocks = (0..gluing.blocks()).flat_map(|b| gluing.block(b));
        let rows = (0..gluing.specials()).flat_map(|k| gluing.special(k));
        Self {
            block_copies: blocks.map(|e| copy(e.subdomain, e.local)).collect(),
            row_copies: rows.map(|e| copy(e.subdomain, e.local)).collect(),
            arms,
            first,
        }
    }
}

/// The wrenches of one panel, for the dispatcher to vector instructions.
struct PanelWrenches<'a> {
    map: &'a BoundaryMap,
    x: &'a [f64],
    weights: Option<&'a [f64]>,
    panel: &'a Panel,
    arms: &'a [[f64; 3]],
    kernel: &'a Kernel,
    out: &'a mut [f64],
}

impl WithSimd for PanelWrenches<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let map = self.map;
        let Self {
            x,
            weights,
            panel,
            arms,
            kernel,
            out,
            ..
        } = self;
        match panel.columns.len() {
            1 => map.panel_wrenches::<1>(x, weights, panel, arms, kernel, out),
            2..=8 => map.panel_wrenches::<8>(x, weights, panel, arms, kernel, out),
            _ => map.panel_wrenches::<PANEL>(x, weights, panel, arms, kernel, out),
        }
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
    ) {
        self.for_columns(columns, &|lane, part| {
            let mut rest = part;
            for panel in &self.panels[lane.panels.clone()] {
                let width = panel.columns.len();
                let (own, tail) = std::mem::take(&mut rest).split_at_mut(6 * width);
                rest = tail;
                let first = tables.first[panel.class] as usize;
                let arms = &tables.arms[first..][..self.classes[panel.class].nodes.len()];
                let kernel = &bases[panel.class].kernel;
                Arch::new().dispatch(PanelWrenches {
                    map: self,
                    x,
                    weights,
                    panel,
                    arms,
                    kernel,
                    out: own,
                });
            }
        });
    }

    #[inline(always)]
    fn panel_wrenches<const N: usize>(
        &self,
        x: &[f64],
        weights: Option<&[f64]>,
        panel: &Panel,
        arms: &[[f64; 3]],
        kernel: &Kernel,
        out: &mut [f64],
    ) {
        let interface = &x[self.interface.clone()];
        let width = panel.columns.len();
        let pointers = &self.spread_pointers[panel.copies.start..=panel.copies.end];
        let (mut wrench, mut force) = ([[0.0; N]; 6], [[0.0; N]; 3]);
        for (node, arm) in arms.iter().enumerate() {
            self.node_forces(interface, &pointers[node * width..], width, &mut force);
            let [rx, ry, rz] = *arm;
            let [fx, fy, fz] = &force;
            let [w0, w1, w2, w3, w4, w5] = &mut wrench;
            for m in 0..N {
                w0[m] += fx[m];
                w1[m] += fy[m];
                w2[m] += fz[m];
                w3[m] += ry * fz[m] - rz * fy[m];
                w4[m] += rz * fx[m] - rx * fz[m];
                w5[m] += rx * fy[m] - ry * fx[m];
            }
        }
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
            crate::kernel::add_wrench(&mut sum, &arms[copy / width], force);
            for (w, s) in wrench.iter_mut().zip(sum) {
                w[copy % width] += s;
            }
        }
        for (m, target) in out.chunks_exact_mut(6).enumerate() {
            target.copy_from_slice(&kernel.project_wrench(&std::array::from_fn(|k| wrench[k][m])));
        }
    }

    /// Forces of the interface rows on the copies of one node.
    #[inline(always)]
    fn node_forces<const N: usize>(
        &self,
        interface: &[f64],
        pointers: &[u32],
        width: usize,
        force: &mut [[f64; N]; 3],
    ) {
        for m in 0..width {
            let range = pointers[m] as usize..pointers[m + 1] as usize;
            let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
            let blocks = self.spread_blocks[range.clone()].iter();
            for (&block, &weight) in blocks.zip(&self.spread_weights[range]) {
                let value = &interface[3 * block as usize..][..3];
                a += weight * value[0];
                b += weight * value[1];
                c += weight * value[2];
            }
            force[0][m] = a;
            force[1][m] = b;
            force[2][m] = c;
        }
    }

    /// Hands `B R alpha` to `interface(x, value)` and `other(row, x, value)`, row by row, with the entries of `x`.
    /// `motions` are those of the columns, about their means.
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
        let blocks = |k: usize, part: &mut [f64]| {
            self.block_motions(tables, motions, k * BLOCKS, part, &interface);
        };
        let second = self.interface.end;
        let others = |contact: &mut [f64], dirichlet: &mut [f64]| {
            self.row_motions(tables, motions, 0, 0, contact, &other);
            self.row_motions(tables, motions, contact.len(), second, dirichlet, &other);
        };
        if self.is_large() {
            let inner = inner.par_chunks_mut(3 * BLOCKS).enumerate();
            rayon::join(
                || inner.for_each(|(k, part)| blocks(k, part)),
                || others(contact, dirichlet),
            );
        } else {
            blocks(0, inner);
            others(contact, dirichlet);
        }
    }

    /// Sets the contact rows (the leading part of `out`) to `B R alpha`.
    pub(crate) fn contact_motions(
        &self,
        tables: &RigidTables,
        motions: &[[f64; 6]],
        out: &mut [f64],
    ) {
        let contact = &mut out[..self.interface.start];
        self.row_motions(tables, motions, 0, 0, contact, &|_, x: &mut f64, v| *x = v);
    }

    fn block_motions(
        &self,
        tables: &RigidTables,
        motions: &[[f64; 6]],
        first: usize,
        out: &mut [f64],
        each: &impl Fn(&mut f64, f64),
    ) {
        let pointers = &self.block_pointers[first..=first + out.len() / 3];
        for (pair, target) in pointers.windows(2).zip(out.chunks_exact_mut(3)) {
            let range = pair[0] as usize..pair[1] as usize;
            let copies = tables.block_copies[range.clone()].iter();
            let mut sum = [0.0; 3];
            for (&[column, arm], &weight) in copies.zip(&self.block_weights[range]) {
                let u = displacement(&motions[column as usize], &tables.arms[arm as usize]);
                for c in 0..3 {
                    sum[c] += weight * u[c];
                }
            }
            for c in 0..3 {
                each(&mut target[c], sum[c]);
            }
        }
    }

    /// Rows from the special row `special` on, which is row `row` of `B`.
    fn row_motions(
        &self,
        tables: &RigidTables,
        motions: &[[f64; 6]],
        special: usize,
        row: usize,
        out: &mut [f64],
        each: &impl Fn(usize, &mut f64, f64),
    ) {
        for (k, target) in out.iter_mut().enumerate() {
            let pointers = &self.row_pointers[special + k..][..2];
            let range = pointers[0] as usize..pointers[1] as usize;
            let copies = tables.row_copies[range.clone()].iter();
            let terms = copies
                .zip(&self.row_vectors[range])
                .map(|(&[column, arm], v)| {
                    let u = displacement(&motions[column as usize], &tables.arms[arm as usize]);
                    v[0] * u[0] + v[1] * u[1] + v[2] * u[2]
                });
            each(row + k, target, terms.sum());
        }
    }
}
