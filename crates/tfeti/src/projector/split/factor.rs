//! The factorisation along a tree of dense *fronts*: the columns of a node and what their elimination does to later
//! unknowns.
//!
//! Fronts that no changing block leads to are eliminated once; of the others the sum of what is steady is kept, and a
//! new active set adds `sum_r w_r g_r g_r^T` over the contact rows `r` and eliminates them. Both sides of each cut run
//! on different threads. Sums have the order of the tree, so results do not depend on the number of threads.

use crate::coarse::matrix::Entries;
use crate::linalg::both;
use crate::linalg::supernodes::Supernodes;
use crate::linalg::tiles::Tile;
use crate::projector::split::alike::Bunches;
use crate::projector::split::branches::{Branches, Pass, Processes};
use crate::projector::split::front::{Front, extend, load_columns};
use crate::projector::split::fronts::{ContactRow, ContactTerms, ContactWeights};
use crate::projector::split::shared::{bits, share, shared_tiles};
use crate::projector::split::tiles::Tiles;
use crate::projector::split::tree::{CoarseTree, TreeRegion};
use crate::tolerances::{OPERATIONS, READ, SINGULAR, SOLVES, SPARSE};
use signorini_qp::internal::LineWeight;
use std::collections::HashSet;
use std::sync::Arc;

/// What does not depend on the weights of contact rows.
#[derive(Debug)]
pub(crate) struct SplitBase {
    pub(crate) tree: CoarseTree,
    /// For each region of the tree.
    pub(crate) pieces: Vec<Piece>,
    /// Steady part of the columns of each node that changes; empty for the others.
    base: Vec<Vec<f64>>,
    contact: ContactTerms,
    /// Regions that are solved together.
    pub(super) bunches: Bunches,
    /// Of several processes, if each has a branch.
    pub(super) branches: Option<Branches>,
    /// Numbers stored, by all processes together.
    stored: usize,
    /// Leading rows whose weights change.
    rows: usize,
    /// Pivots up to this size count as zero.
    threshold: f64,
}

/// Storage of one region.
#[derive(Debug, Clone)]
pub(crate) struct Piece {
    pub(crate) steady: Arc<Supernodes>,
    pub(crate) tiles: Arc<Tiles>,
    pub(crate) changing: Supernodes,
    /// Whether nothing changes in the region and those within.
    pub(crate) is_steady: bool,
    /// Operations of a change of the active set in the region and those within.
    operations: f64,
}

/// A factor for certain weights of the contact rows: tiles of each region.
#[derive(Debug)]
pub(crate) struct SplitFactor {
    pub(crate) tiles: Vec<Tiles>,
}

impl SplitBase {
    /// From the matrix without its first `contact` rows, contact rows that `write` tells. Equal regions
    /// are stored once and solved together if it `shares` or nothing changes. Of the processes that are told each has a
    /// branch of the tree.
    pub(crate) fn new(
        mut tree: CoarseTree,
        entries: Entries<'_>,
        contact: usize,
        write: &ContactRow<'_>,
        shares: bool,
        processes: Option<Processes<'_>>,
    ) -> Result<Self, usize> {
        let steady = !tree.changes();
        let first = if steady {
            share(&mut tree, entries.graph, &bits(entries))
        } else {
            (0..tree.regions.len()).collect()
        };
        let mut pieces: Vec<Piece> = Vec::with_capacity(tree.regions.len());
        for (r, region) in tree.regions.iter().enumerate() {
            pieces.push(match pieces.get(first[r]) {
                Some(equal) => equal.clone(),
                None => Piece::new(&tree, region, &pieces),
            });
        }
        let mut out = Self {
            threshold: 0.0,
            base: Vec::new(),
            pieces,
            contact: ContactTerms::new(tree.nodes.len(), contact, &|a, b| tree.front(a, b), write),
            bunches: Bunches::default(),
            branches: processes.and_then(|processes| Branches::new(&tree, processes)),
            stored: 0,
            rows: contact,
            tree,
        };
        if steady {
            let steady: Vec<_> = out.pieces.iter().map(|p| p.steady.clone()).collect();
            let tiles = shared_tiles(&out.tree, &steady, entries, &first)?;
            for (piece, tiles) in out.pieces.iter_mut().zip(tiles) {
                piece.tiles = tiles;
            }
            out.bunches = out.bunch(&first);
            out.stored = out.count_stored();
            let branches = out.branches.as_ref();
            let elsewhere = |r: usize| branches.is_some_and(|branches| !branches.is_here(r));
            for (_, piece) in out.pieces.iter_mut().enumerate().filter(|(r, _)| elsewhere(*r)) {
                piece.tiles = Arc::default();
            }
            return Ok(out);
        }
        let mut fronts = vec![Front::default(); out.tree.nodes.len()];
        let mut tiles = vec![Tiles::default(); out.pieces.len()];
        let load = |k: usize, front: &mut Front| {
            let node = &out.tree.nodes[k];
            let (width, height) = (node.width(), node.height());
            front.columns.resize(width * height, 0.0);
            front.update.resize((height - width) * (height - width), 0.0);
            load_columns(entries, &out.tree, k, &mut front.columns);
        };
        let work = Growth {
            base: &out,
            changing: false,
            load: &load,
        };
        work.run(&mut fronts, &mut tiles)?;
        out.base = fronts.into_iter().map(|f| f.columns).collect();
        for (piece, tiles) in out.pieces.iter_mut().zip(tiles) {
            piece.tiles = Arc::new(tiles);
        }
        let diagonal = entries.matrix.diagonal(entries.values).fold(0.0_f64, f64::max);
        out.threshold = SINGULAR * diagonal;
        let first = if shares { share(&mut out.tree, entries.graph, &bits(entries)) } else { first };
        for (r, &equal) in first.iter().enumerate().filter(|(r, equal)| r != *equal) {
            out.pieces[r] = out.pieces[equal].clone();
        }
        out.bunches = out.bunch(&first);
        out.stored = out.count_stored();
        Ok(out)
    }

    /// What is solved together where `first` is the first equal region of each.
    fn bunch(&self, first: &[usize]) -> Bunches {
        let need = |r: usize| {
            let Piece { steady, changing, .. } = &self.pieces[r];
            let reads = Tile::NUMBERS * (steady.tiles() + changing.tiles());
            [steady.buffer().max(changing.buffer()), reads]
        };
        let rank = |r: usize| self.branches.as_ref().and_then(|branches| branches.rank_of(r));
        Bunches::new(&self.tree, first, need, rank)
    }

    /// Whether a solve completes its right side, of which each process has what belongs to its subdomains.
    pub(crate) fn completes(&self) -> bool {
        self.branches.as_ref().is_some_and(Branches::completes)
    }

    /// Whether [`half_solve`](Self::half_solve) does something.
    pub(crate) fn has_halves(&self) -> bool {
        self.rows == 0
    }

    /// Length of the work memory of a solve.
    pub(crate) fn work(&self) -> usize {
        let message = self.branches.as_ref().map_or(0, Branches::message);
        message + self.bunches.work()
    }

    /// Leading rows whose weights change: others do not lead to blocks that change.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// Numbers stored, by all processes together.
    pub(crate) fn stored(&self) -> usize {
        self.stored
    }

    /// Numbers that this process holds of a factor.
    pub(crate) fn held(&self, factor: &SplitFactor) -> usize {
        let mut known: HashSet<*const Tiles> = HashSet::new();
        let own = self
            .pieces
            .iter()
            .filter(|piece| known.insert(Arc::as_ptr(&piece.tiles)));
        let tiles = own.map(|piece| &*piece.tiles).chain(&factor.tiles);
        tiles.map(Tiles::numbers).sum::<usize>() + self.base.iter().map(Vec::len).sum::<usize>()
    }

    fn count_stored(&self) -> usize {
        // equal regions share theirs
        let mut known: HashSet<*const Tiles> = HashSet::new();
        let pieces = self.pieces.iter();
        self.tree
            .stored(pieces.map(|piece| known.insert(Arc::as_ptr(&piece.tiles))))
    }

    /// Whether a split factor is cheaper than a sparse factor of the whole matrix with `stored` numbers for `rows`
    /// unknowns, counted for one change of the active set and the solves until the next.
    pub(crate) fn pays(&self, rows: usize, stored: usize) -> bool {
        let whole = stored as f64;
        self.tree.cost() < SOLVES * READ * whole + SPARSE * whole * whole / rows.max(1) as f64
    }

    /// Whether pairs of contact rows may stand in these lines.
    pub(crate) fn allows(&self, lines: &[LineWeight]) -> bool {
        self.contact.allow(lines)
    }

    /// Whether regions of a pass are within this one, and whether it is one.
    fn enters(&self, r: usize, pass: Pass) -> bool {
        let branches = self.branches.as_ref();
        branches.is_none_or(|branches| branches.is_entered(r, pass))
    }

    fn does(&self, r: usize, pass: Pass) -> bool {
        let branches = self.branches.as_ref();
        branches.is_none_or(|branches| branches.is_done(branches.rank_of(r), pass))
    }

    /// Factor for other weights of the contact rows; reuses the memory of `old`, and `fronts` as work memory.
    pub(crate) fn factor(
        &self,
        weights: &ContactWeights,
        old: Option<SplitFactor>,
        fronts: &mut Vec<Front>,
    ) -> Result<SplitFactor, usize> {
        let mut tiles = old.map(|old| old.tiles).unwrap_or_default();
        tiles.resize(self.pieces.len(), Tiles::default());
        tiles.iter_mut().for_each(Tiles::clear);
        fronts.resize(self.tree.nodes.len(), Front::default());
        let load = |k: usize, front: &mut Front| {
            let node = &self.tree.nodes[k];
            let behind = node.height() - node.width();
            front.columns.clear();
            front.columns.extend_from_slice(&self.base[k]);
            front.update.clear();
            front.update.resize(behind * behind, 0.0);
            self.contact.add(k, node.height(), weights, &mut front.columns);
        };
        let work = Growth {
            base: self,
            changing: true,
            load: &load,
        };
        work.run(fronts, &mut tiles)?;
        Ok(SplitFactor { tiles })
    }
}

impl Piece {
    fn new(tree: &CoarseTree, region: &TreeRegion, before: &[Self]) -> Self {
        let group = |nodes: std::ops::Range<usize>| {
            let mut out = Supernodes::new(6);
            for node in &tree.nodes[nodes] {
                let first = region.own.start;
                let columns = 6 * (node.columns.start - first)..6 * (node.columns.end - first);
                out.push(columns, node.border.iter().map(|&p| region.local(p)));
            }
            out
        };
        let (steady, changing) = (group(region.steady.clone()), group(region.changing.clone()));
        let children = || region.children.into_iter().flatten().map(|k| &before[k]);
        let own = tree.nodes[region.changing.clone()].iter();
        Self {
            is_steady: region.changing.is_empty() && children().all(|c| c.is_steady),
            operations: own.map(|n| n.operations()).sum::<f64>() + children().map(|c| c.operations).sum::<f64>(),
            tiles: Arc::default(),
            steady: Arc::new(steady),
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
    /// Works on all regions; of several processes on those of this one, and on what all work on.
    fn run(&self, fronts: &mut [Front], tiles: &mut [Tiles]) -> Result<(), usize> {
        let root = self.base.pieces.len().wrapping_sub(1);
        let Some(branches) = &self.base.branches else {
            return self.grow(root, Pass::Branches, fronts, tiles);
        };
        let own = self.grow(root, Pass::Branches, fronts, tiles);
        branches.gather_updates(own, &self.base.tree, self.changing, fronts)?;
        self.grow(root, Pass::Top, fronts, tiles)
    }

    /// Works on a region after those within, as far as they belong to a `pass`. `fronts` and `tiles` are those of the
    /// regions within and its own.
    fn grow(&self, r: usize, pass: Pass, fronts: &mut [Front], tiles: &mut [Tiles]) -> Result<(), usize> {
        let (tree, pieces) = (&self.base.tree, &self.base.pieces);
        let Some(region) = tree.regions.get(r).filter(|_| self.base.enters(r, pass)) else {
            return Ok(());
        };
        if let Some([left, right]) = region.children {
            let nodes = tree.regions[right].first_node - region.first_node;
            let own = region.steady.start - region.first_node;
            let (a, b) = fronts[..own].split_at_mut(nodes);
            let (s, rest) = tiles.split_at_mut(left + 1 - region.first_region);
            let t = &mut rest[..right - left];
            let worth = !self.changing || pieces[r].operations >= OPERATIONS;
            let (a, b) = both(worth, || self.grow(left, pass, a, s), || self.grow(right, pass, b, t));
            a?;
            b?;
        }
        if !self.base.does(r, pass) {
            return Ok(());
        }
        let nodes = if self.changing {
            region.changing.clone()
        } else {
            region.steady.start..region.changing.end
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
            front.eliminate(node, self.base.threshold)?;
            let (group, first) = if self.changing {
                (&pieces[r].changing, region.changing.start)
            } else {
                (&*pieces[r].steady, region.steady.start)
            };
            let tiles = &mut tiles[r - region.first_region];
            group.pack(k - first, &front.columns, &mut tiles.exact);
            if !self.changing {
                front.columns = Vec::new();
            }
        }
        tiles[r - region.first_region].round();
        Ok(())
    }
}
