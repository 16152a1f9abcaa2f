//! Factor of `G W G^T` of which only the part that follows the weights of the contact rows is done anew.
//!
//! Weights of contact rows change with every face, and only the blocks of the subdomains that carry them change with
//! them. The matrix is factored along a tree of dense *fronts* (the columns of a node and what their elimination does to
//! later unknowns). Fronts that no changing block leads to are eliminated once; of the others the sum of what is steady is
//! kept, and a new face adds `sum_r w_r g_r g_r^T` over the contact rows `r` and eliminates them. Both sides of each cut
//! run on different threads. Sums have the order of the tree, so results do not depend on the number of threads.

use crate::coarse_matrix::{CoarseMatrix, ModeTable};
use crate::coarse_tree::{CoarseTree, TreeRegion};
use crate::contact_fronts::{ContactFronts, ContactWeights};
use crate::dense;
use crate::gluing::Gluing;
use crate::panels::Tile;
use crate::row_weights::LineWeight;
use crate::supernodes::Supernodes;

/// What does not depend on the weights of contact rows.
#[derive(Debug)]
pub(crate) struct SplitBase {
    tree: CoarseTree,
    /// For each region of the tree.
    pieces: Vec<Piece>,
    /// Steady part of the columns of each node that changes; empty for the others.
    base: Vec<Vec<f64>>,
    contact: ContactFronts,
    /// Leading rows whose weights change.
    rows: usize,
    /// Pivots up to this size count as zero.
    threshold: f64,
}

/// Storage of one region.
#[derive(Debug)]
struct Piece {
    steady: Supernodes,
    tiles: Vec<Tile>,
    changing: Supernodes,
    /// Whether nothing changes in the region and those within.
    is_steady: bool,
    /// Length of its own work memory, behind that of the regions within.
    slot: usize,
    /// Length of the work memory with that of the regions within.
    work: usize,
    /// Numbers that a solve reads in the region and those within.
    reads: usize,
    /// Operations of a change of the face in the region and those within.
    operations: f64,
}

/// A factor for certain weights of the contact rows: tiles of each region.
#[derive(Debug)]
pub(crate) struct SplitFactor {
    tiles: Vec<Vec<Tile>>,
}

/// Work memory of factorisations.
#[derive(Debug, Default)]
pub(crate) struct Fronts(Vec<Front>);

/// Columns of a node, and what is subtracted from the later unknowns of its border: lower triangles.
#[derive(Debug, Clone, Default)]
struct Front {
    columns: Vec<f64>,
    update: Vec<f64>,
}

/// Pivots below this share of the largest diagonal entry count as zero.
const SINGULAR: f64 = 1e-14;
/// Fewest numbers a solve reads that are worth a second thread, and fewest operations of a factorisation.
const READS: usize = 25_000;
const OPERATIONS: f64 = 3e5;
/// Solves with the factor of one face; seconds for a number that they read; seconds for an operation of a change.
const SOLVES: f64 = 12.0;
const READ: f64 = 0.6e-9;
const OPERATION: f64 = 0.04e-9;
/// Most levels of cuts through blocks that change.
const CUTS: usize = 4;

/// The cheapest tree for changes of the face and the solves between them.
pub(crate) fn cheapest_tree(
    graph: &[Vec<u32>],
    centres: &[[f64; 3]],
    changing: &[bool],
) -> Option<CoarseTree> {
    let mut best = CoarseTree::new(graph, centres, changing, 0).ok()?;
    for cuts in 1..=CUTS {
        let next = CoarseTree::new(graph, centres, changing, cuts).ok()?;
        if cost(&next) >= cost(&best) {
            break;
        }
        best = next;
    }
    Some(best)
}

/// Seconds on two threads.
fn cost(tree: &CoarseTree) -> f64 {
    tree.longest(|node| {
        let change = if node.changing {
            node.operations()
        } else {
            0.0
        };
        SOLVES * READ * node.stored() + OPERATION * change
    })
}

impl SplitBase {
    /// From the `values` of the matrix without its first `contact` rows, which are contact rows.
    pub(crate) fn new(
        tree: CoarseTree,
        matrix: &CoarseMatrix,
        graph: &[Vec<u32>],
        values: &[f64],
        gluing: &Gluing,
        modes: &ModeTable<'_>,
        contact: usize,
    ) -> Result<Self, usize> {
        let mut pieces = Vec::with_capacity(tree.regions.len());
        for region in &tree.regions {
            pieces.push(Piece::new(&tree, region, &pieces));
        }
        let mut out = Self {
            threshold: 0.0,
            base: Vec::new(),
            pieces,
            contact: ContactFronts::new(&tree, gluing, modes, contact),
            rows: contact,
            tree,
        };
        let mut fronts = vec![Front::default(); out.tree.nodes.len()];
        let mut tiles: Vec<Vec<Tile>> = vec![Vec::new(); out.pieces.len()];
        let load = |k: usize, front: &mut Front| {
            let node = &out.tree.nodes[k];
            let (width, height) = (node.width(), node.height());
            front.columns.resize(width * height, 0.0);
            front
                .update
                .resize((height - width) * (height - width), 0.0);
            matrix.load(&out.tree, graph, k, values, &mut front.columns);
        };
        let work = Growth {
            base: &out,
            changing: false,
            load: &load,
        };
        work.grow(out.pieces.len().wrapping_sub(1), &mut fronts, &mut tiles)?;
        out.base = fronts.into_iter().map(|f| f.columns).collect();
        for (piece, tiles) in out.pieces.iter_mut().zip(tiles) {
            piece.tiles = tiles;
        }
        let diagonal = matrix.diagonal(values).fold(0.0_f64, f64::max);
        out.threshold = SINGULAR * diagonal;
        Ok(out)
    }

    /// Length of the work memory of a solve.
    pub(crate) fn work(&self) -> usize {
        self.tree.dim() + self.pieces.last().map_or(0, |p| p.work)
    }

    /// Leading rows whose weights change: others do not lead to blocks that change.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// Numbers stored.
    pub(crate) fn stored(&self) -> usize {
        let tiles = |p: &Piece| Tile::NUMBERS * (p.steady.tiles() + p.changing.tiles());
        self.pieces.iter().map(tiles).sum::<usize>() + self.base.iter().map(Vec::len).sum::<usize>()
    }

    /// Whether a split factor is cheaper than a sparse factor of the whole matrix with `stored` numbers for `rows` unknowns,
    /// counted for one change of the face and the solves until the next.
    pub(crate) fn pays(&self, rows: usize, stored: usize) -> bool {
        const SPARSE: f64 = 0.1e-9;
        let whole = stored as f64;
        let sparse = SOLVES * READ * whole + SPARSE * whole * whole / rows.max(1) as f64;
        cost(&self.tree) < sparse
    }

    /// Whether pairs of contact rows may stand in these lines.
    pub(crate) fn allows(&self, lines: &[LineWeight]) -> bool {
        self.contact.allow(lines)
    }

    /// Factor for other weights of the contact rows; reuses the memory of `old`.
    pub(crate) fn factor(
        &self,
        weights: &ContactWeights,
        old: Option<SplitFactor>,
        fronts: &mut Fronts,
    ) -> Result<SplitFactor, usize> {
        let mut tiles = old.map(|old| old.tiles).unwrap_or_default();
        tiles.resize(self.pieces.len(), Vec::new());
        tiles.iter_mut().for_each(Vec::clear);
        fronts.0.resize(self.tree.nodes.len(), Front::default());
        let load = |k: usize, front: &mut Front| {
            let node = &self.tree.nodes[k];
            let behind = node.height() - node.width();
            front.columns.clear();
            front.columns.extend_from_slice(&self.base[k]);
            front.update.clear();
            front.update.resize(behind * behind, 0.0);
            self.contact
                .add(k, node.height(), weights, &mut front.columns);
        };
        let work = Growth {
            base: self,
            changing: true,
            load: &load,
        };
        work.grow(self.pieces.len().wrapping_sub(1), &mut fronts.0, &mut tiles)?;
        Ok(SplitFactor { tiles })
    }

    /// `y = (G W G^T)^-1 y`; `work` has the length [`SplitBase::work`] at least.
    pub(crate) fn solve(&self, factor: &SplitFactor, y: &mut [f64], work: &mut [f64]) {
        self.solve_from(factor, y, work, false);
    }

    /// The same for `y` that is zero but for blocks that change: nothing steady is read on the way up.
    pub(crate) fn solve_changing(&self, factor: &SplitFactor, y: &mut [f64], work: &mut [f64]) {
        self.solve_from(factor, y, work, true);
    }

    fn solve_from(&self, factor: &SplitFactor, y: &mut [f64], work: &mut [f64], changing: bool) {
        let Some(root) = self.pieces.len().checked_sub(1) else {
            return;
        };
        let (x, rest) = work.split_at_mut(self.tree.dim());
        for (x, &block) in x.chunks_exact_mut(6).zip(&self.tree.blocks) {
            x.copy_from_slice(&y[6 * block as usize..][..6]);
        }
        let rest = &mut rest[..self.pieces[root].work];
        self.forward(root, factor, x, rest, changing);
        self.backward(root, factor, x, rest);
        for (x, &block) in x.chunks_exact(6).zip(&self.tree.blocks) {
            y[6 * block as usize..][..6].copy_from_slice(x);
        }
    }

    /// Eliminates a region and those within; the sums for the blocks behind stand first in its slot of the memory. If only
    /// blocks that are `changing` differ from zero, steady ones are left out.
    fn forward(
        &self,
        r: usize,
        factor: &SplitFactor,
        x: &mut [f64],
        work: &mut [f64],
        changing: bool,
    ) {
        let (region, piece) = (&self.tree.regions[r], &self.pieces[r]);
        let (x, own) = x.split_at_mut(6 * (region.region.own.start - region.region.start));
        let (work, slot) = work.split_at_mut(piece.work - piece.slot);
        let (behind, buffer) = slot.split_at_mut(6 * region.behind.len());
        behind.fill(0.0);
        if changing && piece.is_steady {
            return;
        }
        if let Some([left, right]) = region.region.children {
            let (x, y) = self.divide(left, x);
            let (a, b) = work.split_at_mut(self.pieces[left].work);
            self.both(
                piece,
                || self.forward(left, factor, x, a, changing),
                || self.forward(right, factor, y, b, changing),
            );
            for (child, memory) in [(left, &*a), (right, &*b)] {
                let sums = &memory[memory.len() - self.pieces[child].slot..];
                let lift = &self.tree.regions[child].lift;
                for (&place, sum) in lift.iter().zip(sums.chunks_exact(6)) {
                    let start = 6 * place as usize;
                    let target = match start < own.len() {
                        true => &mut own[start..][..6],
                        false => &mut behind[start - own.len()..][..6],
                    };
                    for k in 0..6 {
                        target[k] += sum[k];
                    }
                }
            }
        }
        if !changing {
            piece.steady.forward(&piece.tiles, own, behind, buffer);
        }
        piece
            .changing
            .forward(&factor.tiles[r], own, behind, buffer);
    }

    /// Back substitution in a region and those within; the blocks behind stand first in its slot of the memory.
    fn backward(&self, r: usize, factor: &SplitFactor, x: &mut [f64], work: &mut [f64]) {
        let (region, piece) = (&self.tree.regions[r], &self.pieces[r]);
        let (x, own) = x.split_at_mut(6 * (region.region.own.start - region.region.start));
        let (work, slot) = work.split_at_mut(piece.work - piece.slot);
        let (behind, buffer) = slot.split_at_mut(6 * region.behind.len());
        piece
            .changing
            .backward(&factor.tiles[r], own, behind, buffer);
        piece.steady.backward(&piece.tiles, own, behind, buffer);
        if let Some([left, right]) = region.region.children {
            let (x, y) = self.divide(left, x);
            let (a, b) = work.split_at_mut(self.pieces[left].work);
            for (child, memory) in [(left, &mut *a), (right, &mut *b)] {
                let start = memory.len() - self.pieces[child].slot;
                let lift = &self.tree.regions[child].lift;
                for (&place, v) in lift.iter().zip(memory[start..].chunks_exact_mut(6)) {
                    let start = 6 * place as usize;
                    v.copy_from_slice(match start < own.len() {
                        true => &own[start..][..6],
                        false => &behind[start - own.len()..][..6],
                    });
                }
            }
            self.both(
                piece,
                || self.backward(left, factor, x, a),
                || self.backward(right, factor, y, b),
            );
        }
    }

    /// The unknowns of both sides of a cut.
    fn divide<'a>(&self, left: usize, x: &'a mut [f64]) -> (&'a mut [f64], &'a mut [f64]) {
        let region = &self.tree.regions[left].region;
        x.split_at_mut(6 * (region.own.end - region.start))
    }

    fn both(&self, piece: &Piece, a: impl FnOnce() + Send, b: impl FnOnce() + Send) {
        if piece.reads >= READS {
            rayon::join(a, b);
        } else {
            a();
            b();
        }
    }
}

impl Piece {
    fn new(tree: &CoarseTree, region: &TreeRegion, before: &[Self]) -> Self {
        let group = |nodes: std::ops::Range<usize>| {
            let mut out = Supernodes::new(6);
            for node in &tree.nodes[nodes] {
                let first = region.region.own.start;
                let columns = 6 * (node.columns.start - first)..6 * (node.columns.end - first);
                out.push(columns, node.border.iter().map(|&p| region.local(p)));
            }
            out
        };
        let (steady, changing) = (group(region.steady.clone()), group(region.changing.clone()));
        let children = || {
            region
                .region
                .children
                .into_iter()
                .flatten()
                .map(|k| &before[k])
        };
        let slot = 6 * region.behind.len() + steady.buffer().max(changing.buffer());
        let own = tree.nodes[region.changing.clone()].iter();
        Self {
            is_steady: region.changing.is_empty() && children().all(|c| c.is_steady),
            slot,
            work: slot + children().map(|c| c.work).sum::<usize>(),
            reads: Tile::NUMBERS * (steady.tiles() + changing.tiles())
                + children().map(|c| c.reads).sum::<usize>(),
            operations: own.map(|n| n.operations()).sum::<f64>()
                + children().map(|c| c.operations).sum::<f64>(),
            tiles: Vec::new(),
            steady,
            changing,
        }
    }
}

/// A factorisation of the steady or of the changing nodes. `load` begins a front.
struct Growth<'a, L: Fn(usize, &mut Front) + Sync> {
    base: &'a SplitBase,
    changing: bool,
    load: &'a L,
}

impl<L: Fn(usize, &mut Front) + Sync> Growth<'_, L> {
    /// Works on a region after those within. `fronts` and `tiles` are those of the regions within and its own.
    fn grow(&self, r: usize, fronts: &mut [Front], tiles: &mut [Vec<Tile>]) -> Result<(), usize> {
        let (tree, pieces) = (&self.base.tree, &self.base.pieces);
        let Some(region) = tree.regions.get(r) else {
            return Ok(());
        };
        if let Some([left, right]) = region.region.children {
            let nodes = tree.regions[right].first_node - region.first_node;
            let own = region.steady.start - region.first_node;
            let (a, b) = fronts[..own].split_at_mut(nodes);
            let (s, rest) = tiles.split_at_mut(left + 1 - region.first_region);
            let t = &mut rest[..right - left];
            if self.changing && pieces[r].operations < OPERATIONS {
                self.grow(left, a, s)?;
                self.grow(right, b, t)?;
            } else {
                let (a, b) = rayon::join(|| self.grow(left, a, s), || self.grow(right, b, t));
                a?;
                b?;
            }
        }
        let nodes = match self.changing {
            true => region.changing.clone(),
            false => region.steady.start..region.changing.end,
        };
        for k in nodes {
            let node = &tree.nodes[k];
            let (width, height) = (node.width(), node.height());
            let (before, rest) = fronts.split_at_mut(k - region.first_node);
            let front = &mut rest[0];
            (self.load)(k, front);
            for &child in &node.children {
                if self.changing && !tree.nodes[child].changing {
                    continue;
                }
                let update = &mut before[child - region.first_node].update;
                extend(update, &tree.nodes[child].into, front, width, height);
                if !self.changing {
                    *update = Vec::new();
                }
            }
            if node.changing != self.changing {
                continue;
            }
            let threshold = self.base.threshold;
            dense::cholesky_columns(&mut front.columns, height, width, threshold)
                .map_err(|pivot| 6 * node.columns.start + pivot)?;
            dense::subtract_columns(&mut front.update, &front.columns, height, width);
            let (group, first) = match self.changing {
                true => (&pieces[r].changing, region.changing.start),
                false => (&pieces[r].steady, region.steady.start),
            };
            let tiles = &mut tiles[r - region.first_region];
            group.pack(k - first, &front.columns, tiles);
            if !self.changing {
                front.columns = Vec::new();
            }
        }
        Ok(())
    }
}

/// Adds the update of a child, whose border blocks stand at the places `into`, to a front.
fn extend(update: &[f64], into: &[u32], front: &mut Front, width: usize, height: usize) {
    let (size, behind) = (6 * into.len(), height - width);
    for (j, &column) in into.iter().enumerate() {
        for c in 0..6 {
            let source = &update[(6 * j + c) * size..][..size];
            let start = 6 * column as usize + c;
            let target = match start < width {
                true => &mut front.columns[start * height..][..height],
                false => &mut front.update[(start - width) * behind..][..behind],
            };
            let skip = if start < width { 0 } else { width };
            let mut i = j;
            while i < into.len() {
                let first = i;
                i += 1;
                while i < into.len() && into[i] == into[i - 1] + 1 {
                    i += 1;
                }
                let target = &mut target[6 * into[first] as usize - skip..][..6 * (i - first)];
                for (t, s) in target.iter_mut().zip(&source[6 * first..6 * i]) {
                    *t += s;
                }
            }
        }
    }
}
