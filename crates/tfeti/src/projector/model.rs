//! An approximation `N` of the inverse of `G W G^T` that is cheap to make anew for other weights of the contact rows.
//!
//! Clusters `Z` of subdomains move as one, `C = Z (Z^T G W G^T Z)^-1 Z^T`. Between two such solves come sweeps that
//! relax each subdomain by itself, `J = omega diag(G W G^T)^-1`. With `A = G W G^T`
//! `I - N A = (I - C A) (I - J A)^k (I - C A)`: `N` is symmetric, and what it leaves is in balance on each cluster. The
//! latter counts more than what is left: rows that are always free carry it, the further the smoother it is.

use crate::coarse::blocks::{BLOCK, BlockTable, table_of};
use crate::coarse::clusters::Clusters;
use crate::coarse::matrix::{CoarseMatrix, ModeTable};
use crate::linalg::tiles::{Digits, LANES};
use crate::processes::exchange::Exchange;
use crate::projector::split::factor::{SplitBase, SplitFactor};
use crate::projector::split::front::Front;
use crate::projector::split::fronts::{ContactTerms, ContactWeights};
use crate::projector::split::order::grid_of;
use crate::projector::split::tree::cheapest_tree;
use crate::rows::gluing::Gluing;
use crate::subdomain::kernel::Block;
use crate::tolerances::{MOTIONS, RELAXED, SWEEPS};
use nalgebra::Matrix6;
use rayon::prelude::*;
use signorini_qp::internal::LineWeight;
use signorini_qp::vector;
use std::ops::Range;
use std::sync::Arc;

/// What does not depend on the weights of contact rows.
#[derive(Debug)]
pub(super) struct Model {
    clusters: Clusters,
    of_clusters: SplitBase,
    /// Of the rows that are always free.
    steady: (BlockTable, Vec<f64>),
    /// Inverses of its diagonal blocks, relaxed.
    inverses: Vec<Block>,
    contact: ContactTerms,
    table: BlockTable,
    spread: Spread,
    /// Subdomains of this process with contact rows, and the places of their diagonal blocks.
    touching: Vec<(u32, u32)>,
    diagonal: Vec<Block>,
}

/// Which process sweeps over which subdomains.
#[derive(Debug)]
struct Spread {
    exchange: Arc<Exchange>,
    /// Subdomains of each rank.
    rows: Vec<Range<usize>>,
    /// By rank: those of them that others read, and their numbers in the message of all.
    told: Vec<Vec<u32>>,
    parts: Vec<Range<usize>>,
}

impl Spread {
    /// Rows of these tables, about as many blocks on each rank.
    fn new(exchange: &Arc<Exchange>, tables: [&BlockTable; 2], count: usize) -> Self {
        let ranks = exchange.ranks();
        let blocks = |s: usize| tables.iter().map(|table| table.columns(s..s + 1).len()).sum::<usize>();
        let mut ends = vec![0];
        (0..count).for_each(|s| ends.push(ends[s] + 1 + blocks(s)));
        let start = |r: usize| ends.partition_point(|end| end * ranks < ends[count] * r);
        let rows: Vec<Range<usize>> = (0..ranks).map(|r| start(r)..start(r + 1)).collect();
        let mut read = vec![false; count];
        for own in rows.iter().filter(|_| ranks > 1) {
            let columns = tables.iter().flat_map(|table| table.columns(own.clone()));
            let others = columns.map(|&s| s as usize).filter(|s| !own.contains(s));
            others.for_each(|s| read[s] = true);
        }
        let told = |own: &Range<usize>| own.clone().filter(|&s| read[s]).map(|s| s as u32).collect();
        let told: Vec<Vec<u32>> = rows.iter().map(told).collect();
        let mut end = 0;
        let part = |list: &Vec<u32>| {
            end += 6 * list.len();
            end - 6 * list.len()..end
        };
        Self {
            parts: told.iter().map(part).collect(),
            exchange: exchange.clone(),
            rows,
            told,
        }
    }

    /// Subdomains of this rank.
    fn own(&self) -> Range<usize> {
        self.rows[self.exchange.rank()].clone()
    }

    /// Length of the longest message.
    fn message(&self) -> usize {
        match self.rows.len() {
            1 => 0,
            _ => 12 * self.rows.last().map_or(0, |rows| rows.end),
        }
    }

    /// Brings what other ranks read of a vector to them.
    fn tell(&self, x: &mut [f64], message: &mut [f64]) {
        let (x, message) = (x.as_chunks_mut::<6>().0, message.as_chunks_mut::<6>().0);
        let rank = self.exchange.rank();
        let places = |r: usize| (self.parts[r].start / 6..).zip(self.told[r].iter().map(|&s| s as usize));
        places(rank).for_each(|(k, s)| message[k] = x[s]);
        self.exchange.gather(message.as_flattened_mut(), &self.parts);
        let others = (0..self.rows.len()).filter(|&r| r != rank);
        others.flat_map(places).for_each(|(k, s)| x[s] = message[k]);
    }

    /// Completes two vectors.
    fn complete(&self, vectors: [&mut [f64]; 2], message: &mut [f64]) {
        if self.rows.len() == 1 {
            return;
        }
        let rank = self.exchange.rank();
        let parts: Vec<Range<usize>> = self.rows.iter().map(|r| 12 * r.start..12 * r.end).collect();
        let places = |r: usize, k: usize| {
            let (length, first) = (6 * self.rows[r].len(), parts[r].start);
            first + k * length..first + (k + 1) * length
        };
        let unknowns = |r: usize| 6 * self.rows[r].start..6 * self.rows[r].end;
        for (k, x) in vectors.iter().enumerate() {
            message[places(rank, k)].copy_from_slice(&x[unknowns(rank)]);
        }
        self.exchange.gather(message, &parts);
        for (k, x) in vectors.into_iter().enumerate() {
            for r in (0..self.rows.len()).filter(|&r| r != rank) {
                x[unknowns(r)].copy_from_slice(&message[places(r, k)]);
            }
        }
    }
}

/// What follows the weights.
#[derive(Debug)]
pub(super) struct ModelFactor {
    pub(super) clusters: SplitFactor,
    /// Blocks of the contact rows on subdomains of this process.
    contact: Vec<f64>,
    /// Inverses of diagonal blocks of subdomains with contact rows.
    inverses: Vec<Block>,
}

impl Model {
    /// With the leading contact `rows`; `values` are those of the matrix without them. The processes of an `exchange`
    /// sweep over their part of the subdomains each.
    pub(super) fn new(
        clusters: Clusters,
        (gluing, modes): (&Gluing, &ModeTable<'_>),
        (matrix, values): (&CoarseMatrix, &[f64]),
        changing: &[bool],
        rows: usize,
        exchange: &Arc<Exchange>,
    ) -> Option<Self> {
        let of_row = |nodal: usize, out: &mut Vec<(u32, [f64; 6])>| modes.row(gluing, nodal, 1.0, out);
        let on_clusters = |nodal: usize, out: &mut Vec<(u32, [f64; 6])>| {
            let mut row = Vec::new();
            of_row(nodal, &mut row);
            clusters.join(&row, out);
        };
        let (sums, sum_values) = clusters.matrix(matrix, values);
        let (graph, grid) = (sums.graph(), grid_of(clusters.centres()));
        let tree = cheapest_tree(&graph, clusters.centres(), &clusters.marks(changing), grid.as_deref())?;
        let entries = sums.entries(&graph, &sum_values);
        let of_clusters = SplitBase::new(tree, entries, rows, &on_clusters, true, None).ok()?;
        let mut partners: Vec<Vec<u32>> = vec![Vec::new(); changing.len()];
        let mut row = Vec::new();
        for nodal in 0..rows {
            row.clear();
            of_row(nodal, &mut row);
            for (a, b) in row.iter().flat_map(|(a, _)| row.iter().map(move |(b, _)| (a, b))) {
                if !partners[*a as usize].contains(b) {
                    partners[*a as usize].push(*b);
                }
            }
        }
        let mut starts = vec![0];
        for list in &mut partners {
            list.sort_unstable();
            starts.push(starts[starts.len() - 1] + list.len() as u32);
        }
        let place = |a: u32, b: u32| {
            let within = partners[a as usize].partition_point(|&other| other < b);
            starts[a as usize] + within as u32
        };
        let table = BlockTable::new(
            partners
                .iter()
                .zip(&starts)
                .map(|(list, &start)| list.iter().copied().zip(start..)),
        );
        let mut blocks = vec![[[0.0; 6]; 6]; changing.len()];
        matrix.for_blocks(values, |i, j, block| {
            if i == j {
                blocks[i as usize] = *block;
            }
        });
        let steady = table_of(matrix, changing.len(), values);
        let spread = Spread::new(exchange, [&steady.0, &table], changing.len());
        let own = |s: u32| spread.own().contains(&(s as usize));
        let touching = (0..changing.len() as u32).filter(|&s| own(s) && !partners[s as usize].is_empty());
        let touching: Vec<(u32, u32)> = touching.map(|s| (s, place(s, s))).collect();
        let at = |a: u32, b: u32| own(a).then(|| (0, BLOCK * place(a, b) as usize));
        let contact = ContactTerms::new(1, rows, &at, &of_row);
        Some(Self {
            of_clusters,
            spread,
            steady,
            inverses: blocks.iter().map(relaxed).collect(),
            contact,
            table,
            diagonal: touching.iter().map(|(s, _)| blocks[*s as usize]).collect(),
            touching,
            clusters,
        })
    }

    /// Factors for other weights of the contact rows; reuses the memory of `old`.
    pub(super) fn factor(
        &self,
        weights: &ContactWeights,
        old: Option<SplitFactor>,
        fronts: &mut Vec<Front>,
    ) -> Result<ModelFactor, usize> {
        let mut contact = vec![0.0; BLOCK * self.table.blocks()];
        self.contact.add(0, LANES, weights, &mut contact);
        let inverse = |((_, place), steady): (&(u32, u32), &Block)| {
            let own = &contact[BLOCK * *place as usize..];
            relaxed(&std::array::from_fn(|r| {
                std::array::from_fn(|c| steady[r][c] + own[c * LANES + r])
            }))
        };
        Ok(ModelFactor {
            clusters: self.of_clusters.factor(weights, old, fronts)?,
            inverses: self.touching.iter().zip(&self.diagonal).map(inverse).collect(),
            contact,
        })
    }

    /// Whether pairs of contact rows may stand in these lines.
    pub(super) fn allows(&self, lines: &[LineWeight]) -> bool {
        self.contact.allow(lines)
    }

    /// Numbers stored, by all processes together.
    pub(super) fn stored(&self) -> usize {
        let touching = (0..self.inverses.len()).filter(|&s| !self.table.columns(s..s + 1).is_empty());
        let inverses = self.inverses.len() + 2 * touching.count();
        self.of_clusters.stored() + self.steady.1.len() + 36 * inverses + BLOCK * self.table.blocks()
    }

    /// Length of the work memory of a solve.
    pub(super) fn work(&self) -> usize {
        let vectors = 6 * (self.clusters.count() + 2 * self.inverses.len());
        vectors + self.of_clusters.work() + self.spread.message()
    }

    /// `y = N y`.
    pub(super) fn solve(&self, factor: &ModelFactor, y: &mut [f64], work: &mut [f64], digits: Digits) {
        let (sums, work) = work.split_at_mut(6 * self.clusters.count());
        let (rest, work) = work.split_at_mut(y.len());
        let (step, work) = work.split_at_mut(y.len());
        let (work, message) = work.split_at_mut(self.of_clusters.work());
        let own = self.spread.own();
        let unknowns = 6 * own.start..6 * own.end;
        rest.copy_from_slice(y);
        let cluster = |rest: &[f64], step: &mut [f64], sums: &mut [f64], work: &mut [f64]| {
            self.clusters.restrict(rest, sums);
            self.of_clusters.solve(&factor.clusters, sums, work, false, digits);
            self.clusters.prolong(sums, step);
        };
        cluster(rest, y, sums, work);
        self.subtract(factor, own.clone(), y, rest);
        for _ in 0..SWEEPS {
            self.relax(factor, own.clone(), rest, step);
            vector::axpy(1.0, &step[unknowns.clone()], &mut y[unknowns.clone()]);
            self.spread.tell(step, message);
            self.subtract(factor, own.clone(), step, rest);
        }
        self.spread.complete([y, rest], message);
        cluster(rest, step, sums, work);
        vector::axpy(1.0, step, y);
    }

    /// `y = y - G W G^T x` on some subdomains.
    fn subtract(&self, factor: &ModelFactor, own: Range<usize>, x: &[f64], y: &mut [f64]) {
        self.steady.0.subtract(&self.steady.1, own.clone(), x, y);
        self.table.subtract(&factor.contact, own, x, y);
    }

    /// `out = J rest` on some subdomains.
    fn relax(&self, factor: &ModelFactor, own: Range<usize>, rest: &[f64], out: &mut [f64]) {
        let (rest, (out, _)) = (rest.as_chunks::<6>().0, out.as_chunks_mut::<6>());
        let all = out[own.clone()].par_iter_mut().with_min_len(MOTIONS);
        let each = all.zip(&self.inverses[own.clone()]).zip(&rest[own.clone()]);
        each.for_each(|((out, inverse), rest)| *out = times(inverse, rest));
        for ((s, _), inverse) in self.touching.iter().zip(&factor.inverses) {
            out[*s as usize] = times(inverse, &rest[*s as usize]);
        }
    }
}

fn times(a: &Block, x: &[f64; 6]) -> [f64; 6] {
    std::array::from_fn(|r| (0..6).map(|c| a[r][c] * x[c]).sum())
}

/// The relaxed inverse of a diagonal block; zero if there is none.
fn relaxed(block: &Block) -> Block {
    let inverse = Matrix6::from_fn(|r, c| block[r][c]).cholesky();
    let inverse = inverse.map_or_else(Matrix6::zeros, |c| c.inverse());
    std::array::from_fn(|r| std::array::from_fn(|c| RELAXED * inverse[(r, c)]))
}
