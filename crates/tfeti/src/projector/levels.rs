//! The projector of an active set by two levels: what changes is a small model, what is exact does not change.
//!
//! The factor of `G W G^T` that follows the contact rows grows with the third power of the number of subdomains that
//! touch. Here its place is taken by a [`Model`], an approximation `N` of the inverse: contact rows take `W G^T N g`,
//! and the rows that are always free, with a factor `A^-1` that never changes, what is left of the equality: `P x = x -
//! W_c G^T N g - W_f G^T A^-1 (g - G W_c G^T N g)`, `g = G x`. `P` is a projector to the kernel of `G`, exact whatever
//! `N` is; iterations need the more steps the worse it is. Where contact alone holds bodies, `A` has springs: what `N`
//! leaves is in balance on each body and does not load them.

use crate::coarse::clusters::Clusters;
use crate::coarse::matrix::ModeTable;
use crate::coarse::mobility::FreeMotion;
use crate::coarse::space::{Coarse, CoarseScratch};
use crate::coarse::weights::RowWeights;
use crate::processes::exchange::Exchange;
use crate::projector::factor::{CoarseFactor, Factor};
use crate::projector::model::Model;
use crate::projector::split::factor::SplitBase;
use crate::projector::split::fronts::ContactWeights;
use crate::projector::split::order::grid_of;
use crate::projector::split::tree::{CoarseTree, cheapest_tree};
use crate::rows::gluing::Gluing;
use crate::tolerances::{FEW, GROWTH, MANY, OPERATION, ROW, SOLVES};
use std::sync::Arc;

/// What the factors of all active sets have in common.
#[derive(Debug)]
pub(super) enum Basis {
    /// What stays of the whole factor.
    Split(Arc<SplitBase>),
    /// A model of it, and the factor of the rows that are always free, with springs where these leave motions free.
    Model(Arc<Model>, CoarseFactor),
}

/// Weights of leading rows that are `free`, and of others; of contact rows only where all others weigh one.
pub(super) fn row_weights(coarse: &Coarse, free: &[f64], metric: Option<&[f64]>) -> RowWeights {
    let contact = coarse.0.gluing.ranges().contact().end;
    RowWeights::diagonal(match metric {
        Some(metric) => {
            let mut weights = metric.to_vec();
            weights.iter_mut().zip(free).for_each(|(m, w)| *m *= w);
            weights
        }
        None => {
            let mut weights = free.to_vec();
            weights.resize(free.len().max(contact), 1.0);
            weights
        }
    })
}

/// A factor in which nothing changes.
fn steady(base: Arc<SplitBase>) -> Option<Factor> {
    let factor = base.factor(&ContactWeights::default(), None, &mut Vec::new());
    Some(Factor::Split(base, factor.ok()?))
}

/// Whether two levels pay for subdomains of which those that are `touching` have contact rows, with so many `rows` of
/// `B` in all: a change of the active set with one level factors a dense matrix of those that touch. Where none do
/// there is one level, in which equal regions are stored once.
pub(super) fn two_levels_pay(touching: &[bool], rows: usize) -> bool {
    let dense = 6.0 * touching.iter().filter(|t| **t).count() as f64;
    let slower = GROWTH * 0.5 * SOLVES * ROW * rows as f64;
    let pays = OPERATION * dense.powi(3) / 3.0 > slower;
    touching.len() > MANY || touching.len() >= FEW && (pays || dense == 0.0)
}

/// The same for the rows of `B`.
pub(crate) fn has_two_levels(gluing: &Gluing, subdomains: usize) -> bool {
    let touching = touched(gluing, gluing.ranges().contact().end, subdomains);
    two_levels_pay(&touching, gluing.ranges().total())
}

/// Which subdomains the first `rows` rows touch, contact rows.
fn touched(gluing: &Gluing, rows: usize, subdomains: usize) -> Vec<bool> {
    let mut touched = vec![false; subdomains];
    for e in (0..rows).flat_map(|row| gluing.nodal(row)) {
        touched[e.subdomain as usize] = true;
    }
    touched
}

impl Coarse {
    /// What factors for changing weights of the first `rows` rows have in common, if these are contact rows and the
    /// factor can be split; by `levels` if that is told, or worth it. `metric` is the weight of each row where it
    /// counts, one if `None`.
    pub(super) fn basis(&self, rows: usize, metric: Option<&[f64]>, levels: Option<bool>) -> Option<Basis> {
        let data = &self.0;
        let gluing = &data.gluing;
        let ones = || vec![1.0; self.dim()];
        let mut weights = RowWeights::diagonal(metric.map_or_else(ones, <[f64]>::to_vec));
        let all = metric.is_some().then_some(&weights);
        if rows > gluing.ranges().interface.start || !data.free_motions(all).is_empty() {
            return None;
        }
        let changing = touched(gluing, rows, data.subdomains.count());
        let graph = data.matrix.graph();
        let modes = ModeTable::new(&data.subdomains);
        weights.diagonal[..rows].fill(0.0);
        let values = data.matrix.assemble(gluing, &modes, Some(&weights)).values;
        let write = |nodal: usize, out: &mut Vec<(u32, [f64; 6])>| modes.row(gluing, nodal, 1.0, out);
        let wanted = levels.unwrap_or_else(|| two_levels_pay(&changing, gluing.ranges().total()));
        if wanted && rows > 0 && rows == gluing.ranges().contact().end {
            let free = data.free_motions(Some(&weights));
            let none = row_weights(self, &vec![0.0; rows], metric);
            let levels = self.two_levels(rows, &graph, &changing, (&values, free), &modes, none);
            if levels.is_some() {
                return levels;
            }
        }
        let tree = cheapest_tree(&graph, data.mobility.centres(), &changing, None)?;
        let entries = data.matrix.entries(&graph, &values);
        let rank_of = |s: u32| data.subdomains.rank_of(s as usize);
        let base = SplitBase::new(tree, entries, rows, &write, false, Some((self.exchange(), &rank_of))).ok()?;
        Some(Basis::Split(Arc::new(base)))
    }

    /// By two levels, if they exist; `weights` are those of the rows that are always free.
    fn two_levels(
        &self,
        rows: usize,
        graph: &[Vec<u32>],
        changing: &[bool],
        (values, free): (&[f64], Vec<FreeMotion>),
        modes: &ModeTable<'_>,
        weights: RowWeights,
    ) -> Option<Basis> {
        let data = &self.0;
        let (mobility, matrix) = (&data.mobility, &data.matrix);
        let grid = grid_of(mobility.centres());
        let clusters = Clusters::new(mobility, &data.subdomains, grid.as_deref());
        let model = || {
            Model::new(
                clusters,
                (&data.gluing, modes),
                (matrix, values),
                changing,
                rows,
                self.exchange(),
            )
        };
        let always = || {
            let mut values = values.to_vec();
            data.hold(&free, &mut values);
            self.fixed_base(graph, &values)
        };
        let (model, always) = rayon::join(model, always);
        let (model, always) = (Arc::new(model?), steady(always?)?);
        Some(Basis::Model(
            model,
            CoarseFactor::new(self.clone(), always, Some(weights), free),
        ))
    }

    fn exchange(&self) -> &Arc<Exchange> {
        &self.0.subdomains.ownership.exchange
    }

    /// The factor of the matrix with these values, in which nothing changes: equal regions are stored once.
    fn fixed_base(&self, graph: &[Vec<u32>], values: &[f64]) -> Option<Arc<SplitBase>> {
        let data = &self.0;
        let centres = data.mobility.centres();
        let nothing = vec![false; graph.len()];
        let tree = CoarseTree::new(graph, centres, &nothing, 0, grid_of(centres).as_deref()).ok()?;
        let entries = data.matrix.entries(graph, values);
        let rank_of = |s: u32| data.subdomains.rank_of(s as usize);
        let base = SplitBase::new(tree, entries, 0, &|_, _| {}, true, Some((self.exchange(), &rank_of)));
        base.ok().map(Arc::new)
    }

    /// The factor of `G G^T`, with these values, where subdomains are as many as for two levels, and the factor does
    /// without springs.
    pub(super) fn shared_factor(&self, values: &[f64]) -> Option<Factor> {
        let data = &self.0;
        if !has_two_levels(&data.gluing, data.subdomains.count()) {
            return None;
        }
        steady(self.fixed_base(&data.matrix.graph(), values)?)
    }
}

/// Methods of a model.
impl CoarseFactor {
    /// `x = x - W_c G^T N g`, `g` the side in the memory, which becomes what is left of it.
    pub(super) fn take_by_contact(&self, x: &mut [f64], s: &mut CoarseScratch) {
        let data = &self.coarse().0;
        s.kept.copy_from_slice(&s.side);
        self.solve_side(s, false);
        let contact = data.gluing.ranges().contact().end;
        data.contact_transpose(&s.side, &mut s.dual[..contact], &mut s.motions);
        self.weigh(&mut s.dual[..contact]);
        x.iter_mut().zip(&s.dual[..contact]).for_each(|(x, c)| *x -= c);
        data.contact_product(&s.dual[..contact], &mut s.side);
        s.side.iter_mut().zip(&s.kept).for_each(|(v, g)| *v = g - *v);
    }

    /// `r = P^T r` for an `r` that other weights of the contact rows have projected, with what their model has `taken`;
    /// returns in `alpha` what is added, and what this model takes. `-A^-1 G W_f r` is `taken` then.
    pub(super) fn project_again(&self, r: &mut [f64], taken: &mut [f64], alpha: &mut [f64], s: &mut CoarseScratch) {
        alpha.copy_from_slice(taken);
        self.take_from(r, alpha, s);
        taken.copy_from_slice(&s.side);
        self.coarse().0.add_transpose(alpha, r, &mut s.motions);
    }

    /// `alpha = alpha - N G W_c (r + G^T alpha)`; what the model takes is then the side in the memory.
    pub(super) fn take_from(&self, r: &[f64], alpha: &mut [f64], s: &mut CoarseScratch) {
        let data = &self.coarse().0;
        let contact = data.gluing.ranges().contact().end;
        data.contact_transpose(alpha, &mut s.dual[..contact], &mut s.motions);
        s.dual.iter_mut().zip(&r[..contact]).for_each(|(v, r)| *v += r);
        self.weigh(&mut s.dual[..contact]);
        data.contact_product(&s.dual[..contact], &mut s.side);
        self.solve_side(s, false);
        alpha.iter_mut().zip(&s.side).for_each(|(a, v)| *a -= v);
    }
}
