//! Solves with a split factor, in double or in single precision.
//!
//! A solve waits for the factor, which is read twice. Steps of an iteration, whose errors are relative to the step,
//! read one that is rounded to single precision: half of the bytes. Arithmetic is in double precision, so that such a
//! solve is symmetric and exact for a matrix next to the one given.

use crate::linalg::supernodes::{Supernodes, Way};
use crate::linalg::tiles::{Digits, HALF, LANES, ShortTile, Stored, Tile};
use crate::projector::split::alike::Bunch;
use crate::projector::split::branches::{Branch, Pass};
use crate::projector::split::factor::{SplitBase, SplitFactor};
use crate::projector::split::tiles::Reads;

impl SplitBase {
    /// `y = (G W G^T)^-1 y`; `work` has the length [`SplitBase::work`] at least. If `changing`, `y` is zero but for
    /// blocks that change, and nothing steady is read on the way up.
    pub(crate) fn solve(&self, factor: &SplitFactor, y: &mut [f64], work: &mut [f64], changing: bool, digits: Digits) {
        match digits {
            Digits::Double => self.solve_with::<Tile>(factor, y, work, changing),
            Digits::Single => self.solve_with::<ShortTile>(factor, y, work, changing),
        }
    }

    fn solve_with<T: Reads>(&self, factor: &SplitFactor, y: &mut [f64], work: &mut [f64], changing: bool) {
        let (work, rest) = work.split_at_mut(self.bunches.work());
        self.eliminate::<T>(factor, y, work, rest, changing);
        self.substitute::<T>(factor, work);
        self.scatter(work, y, rest);
    }

    /// Several processes tell one another the unknowns of their branches.
    fn complete(&self, y: &mut [f64], message: &mut [f64]) {
        let Some(branches) = &self.branches else { return };
        let (message, _) = message.as_chunks_mut::<6>();
        let places = |branch: &Branch| {
            let blocks = &self.tree.blocks[branch.blocks.clone()];
            (branch.unknowns.start / 6..).zip(blocks.iter().map(|&block| 6 * block as usize))
        };
        for (k, start) in branches.of(true).flat_map(places) {
            message[k].copy_from_slice(&y[start..start + 6]);
        }
        branches.exchange.gather(message.as_flattened_mut(), &branches.unknowns);
        for (k, start) in branches.of(false).flat_map(places) {
            y[start..start + 6].copy_from_slice(&message[k]);
        }
    }

    /// `out = L^-1 y` where nothing changes, `L` Cholesky's factor in its order of the unknowns, which keep their
    /// places.
    pub(crate) fn half_solve(&self, factor: &SplitFactor, y: &mut [f64], out: &mut [f64], work: &mut [f64]) {
        let (work, rest) = work.split_at_mut(self.bunches.work());
        self.eliminate::<Tile>(factor, y, work, rest, false);
        self.apply_roots(work, false);
        self.scatter(work, out, rest);
    }

    /// `out = L^-T y`, likewise.
    pub(crate) fn half_solve_transpose(&self, factor: &SplitFactor, y: &[f64], out: &mut [f64], work: &mut [f64]) {
        let (work, rest) = work.split_at_mut(self.bunches.work());
        for bunch in &self.bunches.all {
            self.gather(bunch, y, &mut work[bunch.numbers.clone()]);
        }
        self.apply_roots(work, true);
        self.substitute::<Tile>(factor, work);
        self.scatter(work, out, rest);
    }

    fn apply_roots(&self, work: &mut [f64], before: bool) {
        for bunch in self.bunches.all.iter().filter(|bunch| self.is_here(bunch)) {
            let piece = &self.pieces[bunch.regions[0] as usize];
            let own = &mut work[bunch.numbers.start..][..bunch.own * bunch.width];
            piece.steady.apply_roots(&piece.tiles.exact, own, bunch.width, before);
        }
    }

    /// Whether a bunch is worked on by this process in a pass.
    fn does_bunch(&self, bunch: &Bunch, pass: Pass) -> bool {
        match &self.branches {
            Some(branches) => branches.is_done(bunch.rank, pass),
            None => pass == Pass::Branches,
        }
    }

    fn is_here(&self, bunch: &Bunch) -> bool {
        self.does_bunch(bunch, Pass::Branches) || self.does_bunch(bunch, Pass::Top)
    }

    /// All bunches, each after those within, from `y`. If only blocks that are `changing` differ from zero, steady ones
    /// are left out.
    fn eliminate<T: Reads>(
        &self,
        factor: &SplitFactor,
        y: &mut [f64],
        work: &mut [f64],
        message: &mut [f64],
        changing: bool,
    ) {
        let bunches = &self.bunches;
        let eliminate = |pass: Pass, y: &[f64], work: &mut [f64]| {
            for height in &bunches.heights {
                bunches.over_height(height, work, true, &|bunch, part, below| {
                    if self.does_bunch(bunch, pass) {
                        self.gather(bunch, y, part);
                        if !(changing && self.pieces[bunch.regions[0] as usize].is_steady) {
                            self.take_sums(bunch, below, part);
                            self.eliminate_one::<T>(bunch, factor, part, changing);
                        }
                    }
                });
            }
        };
        eliminate(Pass::Branches, y, work);
        let Some(branches) = &self.branches else { return };
        let places = |branch: &Branch| {
            let [k, column] = bunches.of[branch.root];
            let bunch = &bunches.all[k as usize];
            let first = bunch.numbers.start + bunch.own * bunch.width + column as usize;
            (first..).step_by(bunch.width).take(bunch.behind)
        };
        for branch in branches.of(true) {
            let sums = &mut message[branch.sums.clone()];
            sums.iter_mut().zip(places(branch)).for_each(|(sum, k)| *sum = work[k]);
        }
        branches.gather_sums(y, message);
        for branch in branches.of(false) {
            let sums = &message[branch.sums.clone()];
            sums.iter().zip(places(branch)).for_each(|(sum, k)| work[k] = *sum);
        }
        eliminate(Pass::Top, y, work);
    }

    /// All bunches, each before those within.
    fn substitute<T: Reads>(&self, factor: &SplitFactor, work: &mut [f64]) {
        if self.branches.is_some() {
            self.substitute_in::<T>(Pass::Top, factor, work);
        }
        self.substitute_in::<T>(Pass::Branches, factor, work);
    }

    fn substitute_in<T: Reads>(&self, pass: Pass, factor: &SplitFactor, work: &mut [f64]) {
        let (tree, bunches) = (&self.tree, &self.bunches);
        let end = work.len();
        for height in bunches.heights.iter().rev() {
            bunches.over_height(height, work, false, &|bunch, part, above| {
                if !self.does_bunch(bunch, pass) {
                    return;
                }
                let before = end - above.len();
                for (lane, &r) in bunch.regions.iter().enumerate() {
                    let Some(around) = bunches.around[r as usize] else {
                        continue;
                    };
                    let [k, column] = bunches.of[around as usize];
                    let other = &bunches.all[k as usize];
                    let from = &above[other.numbers.start - before..];
                    for (i, &place) in tree.regions[r as usize].lift.iter().enumerate() {
                        for c in 0..6 {
                            let value = from[(6 * place as usize + c) * other.width + column as usize];
                            part[(bunch.own + 6 * i + c) * bunch.width + lane] = value;
                        }
                    }
                }
                self.substitute_one::<T>(bunch, factor, part);
            });
        }
    }

    /// Own unknowns of all regions to `y`; several processes tell one another theirs.
    fn scatter(&self, work: &[f64], y: &mut [f64], memory: &mut [f64]) {
        for bunch in self.bunches.all.iter().filter(|bunch| self.is_here(bunch)) {
            let part = &work[bunch.numbers.clone()];
            for (lane, &r) in bunch.regions.iter().enumerate() {
                let blocks = &self.tree.blocks[self.tree.regions[r as usize].own.clone()];
                for (i, &block) in blocks.iter().enumerate() {
                    for c in 0..6 {
                        y[6 * block as usize + c] = part[(6 * i + c) * bunch.width + lane];
                    }
                }
            }
        }
        self.complete(y, memory);
    }

    /// Own unknowns from `y`, zero behind them.
    fn gather(&self, bunch: &Bunch, y: &[f64], part: &mut [f64]) {
        part[..bunch.rows() * bunch.width].fill(0.0);
        for (lane, &r) in bunch.regions.iter().enumerate() {
            let blocks = &self.tree.blocks[self.tree.regions[r as usize].own.clone()];
            for (i, &block) in blocks.iter().enumerate() {
                for c in 0..6 {
                    part[(6 * i + c) * bunch.width + lane] = y[6 * block as usize + c];
                }
            }
        }
    }

    /// Adds what the regions within leave.
    fn take_sums(&self, bunch: &Bunch, below: &[f64], part: &mut [f64]) {
        let bunches = &self.bunches;
        for (lane, &r) in bunch.regions.iter().enumerate() {
            for child in self.tree.regions[r as usize].children.into_iter().flatten() {
                let [k, column] = bunches.of[child];
                let other = &bunches.all[k as usize];
                let from = &below[other.numbers.start..];
                for (i, &place) in self.tree.regions[child].lift.iter().enumerate() {
                    for c in 0..6 {
                        let sum = from[(other.own + 6 * i + c) * other.width + column as usize];
                        part[(6 * place as usize + c) * bunch.width + lane] += sum;
                    }
                }
            }
        }
    }

    fn eliminate_one<T: Reads>(&self, bunch: &Bunch, factor: &SplitFactor, part: &mut [f64], changing: bool) {
        let (r, [own, behind, buffer]) = (bunch.regions[0] as usize, bunch.divide(part));
        let (piece, steady) = (&self.pieces[r], T::of(&self.pieces[r].tiles));
        if bunch.width > 1 {
            return together(bunch.width, Way::Forward, &piece.steady, steady, [own, behind, buffer]);
        }
        if !changing {
            piece
                .steady
                .solve(Way::Forward, steady, [&mut *own, &mut *behind, &mut *buffer]);
        }
        let changing = T::of(&factor.tiles[r]);
        piece.changing.solve(Way::Forward, changing, [own, behind, buffer]);
    }

    fn substitute_one<T: Reads>(&self, bunch: &Bunch, factor: &SplitFactor, part: &mut [f64]) {
        let (r, [own, behind, buffer]) = (bunch.regions[0] as usize, bunch.divide(part));
        let (piece, steady) = (&self.pieces[r], T::of(&self.pieces[r].tiles));
        if bunch.width > 1 {
            return together(bunch.width, Way::Backward, &piece.steady, steady, [own, behind, buffer]);
        }
        let changing = T::of(&factor.tiles[r]);
        piece
            .changing
            .solve(Way::Backward, changing, [&mut *own, &mut *behind, &mut *buffer]);
        piece.steady.solve(Way::Backward, steady, [own, behind, buffer]);
    }
}

/// So many right sides at once.
fn together<T: Stored>(width: usize, way: Way, factor: &Supernodes, tiles: &[T], parts: [&mut [f64]; 3]) {
    match width {
        HALF => factor.solve(way, tiles, parts.map(|part| part.as_chunks_mut::<HALF>().0)),
        _ => factor.solve(way, tiles, parts.map(|part| part.as_chunks_mut::<LANES>().0)),
    }
}
