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
    spread: Padded,
}

/// Interface blocks of the copies of each node of a panel: layers of one block a member, filled up with weights of zero,
/// so that the loops over members have no branches.
#[derive(Debug, Default)]
struct Padded {
    /// First node of each panel.
    nodes: Vec<usize>,
    /// First entry of each node.
    starts: Vec<u32>,
    blocks: Vec<u32>,
    weights: Vec<f64>,
}

impl Padded {
    fn new(map: &BoundaryMap) -> Self {
        let mut out = Self::default();
        for panel in &map.panels {
            let width = panel.columns.len();
            out.nodes.push(out.starts.len());
            for first in panel.copies.clone().step_by(width) {
                out.starts.push(out.blocks.len() as u32);
                let entries = |m: usize| {
                    let pair = &map.spread_pointers[first + m..][..2];
                    pair[0] as usize..pair[1] as usize
                };
                let layers = (0..width).map(|m| entries(m).len()).max().unwrap_or(0);
                for (layer, m) in (0..layers).flat_map(|l| (0..width).map(move |m| (l, m))) {
                    let entry = entries(m).nth(layer);
                    out.blocks.push(entry.map_or(0, |e| map.spread_blocks[e]));
                    out.weights
                        .push(entry.map_or(0.0, |e| map.spread_weights[e]));
                }
            }
        }
        out.starts.push(out.blocks.len() as u32);
        out
    }
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
            spread: Padded::new(map),
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
    spread: &'a Padded,
    /// First of the starts of the panel's nodes.
    node: usize,
    kernel: &'a Kernel,
    out: &'a mut [f64],
}

impl WithSimd for PanelWrenches<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        match self.panel.columns.len() {
            1 => self.run::<1>(),
            2..=8 => self.run::<8>(),
            _ => self.run::<PANEL>(),
        }
    }
}

impl PanelWrenches<'_> {
    #[inline(always)]
    fn run<const N: usize>(self) {
        let (map, panel, arms) = (self.map, self.panel, self.arms);
        let (x, weights) = (self.x, self.weights);
        let interface = &x[map.interface.clone()];
        let width = panel.columns.len();
        let mut wrench = [[0.0; N]; 6];
        for (node, arm) in arms.iter().enumerate() {
            let force = self.node_forces::<N>(interface, self.node + node, width);
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
            let copy = map.special_copies[k] as usize - panel.copies.start;
            let mut force = [0.0; 3];
            for e in map.special_pointers[k] as usize..map.special_pointers[k + 1] as usize {
                let row = map.special_rows[e] as usize;
                let value = x[row] * weights.map_or(1.0, |w| w[row]);
                for c in 0..3 {
                    force[c] += map.special_vectors[e][c] * value;
                }
            }
            let mut sum = [0.0; 6];
            crate::kernel::add_wrench(&mut sum, &arms[copy / width], force);
            for (w, s) in wrench.iter_mut().zip(sum) {
                w[copy % width] += s;
            }
        }
        for (m, target) in self.out.chunks_exact_mut(6).enumerate() {
            let own = std::array::from_fn(|k| wrench[k][m]);
            target.copy_from_slice(&self.kernel.project_wrench(&own));
        }
    }

    /// Forces of the interface rows on the copies of one node.
    #[inline(always)]
    fn node_forces<const N: usize>(
        &self,
        interface: &[f64],
        node: usize,
        width: usize,
    ) -> [[f64; N]; 3] {
        let mut force = [[0.0; N]; 3];
        let spread = self.spread;
        let range = spread.starts[node] as usize..spread.starts[node + 1] as usize;
        let blocks = spread.blocks[range.clone()].chunks_exact(width);
        for (blocks, weights) in blocks.zip(spread.weights[range].chunks_exact(width)) {
            let [fx, fy, fz] = &mut force;
            let targets = fx.iter_mut().zip(fy).zip(fz);
            for ((&block, &weight), ((fx, fy), fz)) in blocks.iter().zip(weights).zip(targets) {
                let value = &interface[3 * block as usize..][..3];
                *fx += weight * value[0];
                *fy += weight * value[1];
                *fz += weight * value[2];
            }
        }
        force
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
            for number in lane.panels.clone() {
                let panel = &self.panels[number];
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
                    spread: &tables.spread,
                    node: tables.spread.nodes[number],
                    kernel,
                    out: own,
                });
            }
        });
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
