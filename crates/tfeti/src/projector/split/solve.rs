//! Solves with a split factor, in double or in single precision.
//!
//! A solve waits for the factor, which is read twice. Steps of an iteration, whose errors are relative to the step,
//! read one that is rounded to single precision: half of the bytes. Arithmetic is in double precision, so that such a
//! solve is symmetric and exact for a matrix next to the one given.

use crate::linalg::both;
use crate::linalg::tiles::{Digits, LANES, ShortTile, Tile};
use crate::projector::split::alike::{Bunch, Bunches};
use crate::projector::split::branches::{Branch, Pass};
use crate::projector::split::factor::{SplitBase, SplitFactor};
use crate::projector::split::tiles::Reads;
use crate::tolerances::SOLVE_READS;
use std::ops::Range;

impl SplitBase {
    /// `y = (G W G^T)^-1 y`; `work` has the length [`SplitBase::work`] at least. If `changing`, `y` is zero but for
    /// blocks that change, and nothing steady is read on the way up.
    pub(crate) fn solve(&self, factor: &SplitFactor, y: &mut [f64], work: &mut [f64], changing: bool, digits: Digits) {
        match (&self.bunches, digits) {
            (Some(bunches), Digits::Double) => self.solve_bunches::<Tile>(bunches, factor, y, work),
            (Some(bunches), Digits::Single) => self.solve_bunches::<ShortTile>(bunches, factor, y, work),
            (None, Digits::Double) => self.solve_with::<Tile>(factor, y, work, changing),
            (None, Digits::Single) => self.solve_with::<ShortTile>(factor, y, work, changing),
        }
    }

    fn solve_with<T: Reads>(&self, factor: &SplitFactor, y: &mut [f64], work: &mut [f64], changing: bool) {
        let Some(root) = self.pieces.len().checked_sub(1) else {
            return;
        };
        let (x, rest) = work.split_at_mut(self.tree.dim());
        for (x, &block) in x.chunks_exact_mut(6).zip(&self.tree.blocks) {
            x.copy_from_slice(&y[6 * block as usize..][..6]);
        }
        let (rest, message) = rest.split_at_mut(self.pieces[root].work);
        match &self.branches {
            None => {
                self.forward::<T>(root, None, factor, x, rest, changing);
                self.backward::<T>(root, None, factor, x, rest);
            }
            Some(branches) => {
                self.forward::<T>(root, Some(Pass::Branches), factor, x, rest, changing);
                for branch in branches.of(true) {
                    let sums = &rest[self.behind(branch)];
                    message[branch.sums.clone()].copy_from_slice(sums);
                }
                branches.gather_sums(message);
                for branch in branches.of(false) {
                    rest[self.behind(branch)].copy_from_slice(&message[branch.sums.clone()]);
                }
                self.forward::<T>(root, Some(Pass::Top), factor, x, rest, changing);
                self.backward::<T>(root, Some(Pass::Top), factor, x, rest);
                self.backward::<T>(root, Some(Pass::Branches), factor, x, rest);
            }
        }
        for (x, &block) in x.chunks_exact(6).zip(&self.tree.blocks) {
            y[6 * block as usize..][..6].copy_from_slice(x);
        }
        self.complete(y, message);
    }

    /// The sums of a branch in the work memory, where the slots of the regions follow one another.
    fn behind(&self, branch: &Branch) -> Range<usize> {
        let start = self.pieces[..branch.root].iter().map(|piece| piece.slot).sum::<usize>();
        start..start + branch.sums.len()
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
        branches.gather_unknowns(message.as_flattened_mut());
        for (k, start) in branches.of(false).flat_map(places) {
            y[start..start + 6].copy_from_slice(&message[k]);
        }
    }

    /// Eliminates a region and those within; the sums for the blocks behind stand first in its slot of the memory. If
    /// only blocks that are `changing` differ from zero, steady ones are left out. Only regions of the `pass` are.
    fn forward<T: Reads>(
        &self,
        r: usize,
        pass: Option<Pass>,
        factor: &SplitFactor,
        x: &mut [f64],
        work: &mut [f64],
        changing: bool,
    ) {
        if !self.enters(r, pass) {
            return;
        }
        let (region, piece) = (&self.tree.regions[r], &self.pieces[r]);
        let (x, own) = x.split_at_mut(6 * (region.region.own.start - region.region.start));
        let (work, slot) = work.split_at_mut(piece.work - piece.slot);
        let (behind, buffer) = slot.split_at_mut(6 * region.behind.len());
        let own_too = self.does(r, pass);
        if own_too {
            behind.fill(0.0);
        }
        if changing && piece.is_steady {
            return;
        }
        if let Some([left, right]) = region.region.children {
            let (x, y) = self.divide(left, x);
            let (a, b) = work.split_at_mut(self.pieces[left].work);
            both(
                piece.reads >= SOLVE_READS,
                || self.forward::<T>(left, pass, factor, x, a, changing),
                || self.forward::<T>(right, pass, factor, y, b, changing),
            );
            for (child, memory) in [(left, &*a), (right, &*b)].into_iter().filter(|_| own_too) {
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
        if !own_too {
            return;
        }
        if !changing {
            piece.steady.forward(T::of(&piece.tiles), own, behind, buffer);
        }
        piece.changing.forward(T::of(&factor.tiles[r]), own, behind, buffer);
    }

    /// Back substitution in a region and those within; the blocks behind stand first in its slot of the memory. Only in
    /// regions of the `pass`.
    fn backward<T: Reads>(&self, r: usize, pass: Option<Pass>, factor: &SplitFactor, x: &mut [f64], work: &mut [f64]) {
        if !self.enters(r, pass) {
            return;
        }
        let (region, piece) = (&self.tree.regions[r], &self.pieces[r]);
        let (x, own) = x.split_at_mut(6 * (region.region.own.start - region.region.start));
        let (work, slot) = work.split_at_mut(piece.work - piece.slot);
        let (behind, buffer) = slot.split_at_mut(6 * region.behind.len());
        let own_too = self.does(r, pass);
        if own_too {
            piece.changing.backward(T::of(&factor.tiles[r]), own, behind, buffer);
            piece.steady.backward(T::of(&piece.tiles), own, behind, buffer);
        }
        if let Some([left, right]) = region.region.children {
            let (x, y) = self.divide(left, x);
            let (a, b) = work.split_at_mut(self.pieces[left].work);
            for (child, memory) in [(left, &mut *a), (right, &mut *b)].into_iter().filter(|_| own_too) {
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
            both(
                piece.reads >= SOLVE_READS,
                || self.backward::<T>(left, pass, factor, x, a),
                || self.backward::<T>(right, pass, factor, y, b),
            );
        }
    }

    /// The unknowns of both sides of a cut.
    fn divide<'a>(&self, left: usize, x: &'a mut [f64]) -> (&'a mut [f64], &'a mut [f64]) {
        let region = &self.tree.regions[left].region;
        x.split_at_mut(6 * (region.own.end - region.start))
    }

    /// The same by bunches.
    fn solve_bunches<T: Reads>(&self, bunches: &Bunches, factor: &SplitFactor, y: &mut [f64], work: &mut [f64]) {
        let (work, rest) = work.split_at_mut(bunches.work());
        self.eliminate_bunches::<T>(bunches, factor, y, work, rest);
        self.substitute_bunches::<T>(bunches, factor, work);
        self.scatter(bunches, work, y, rest);
    }

    /// `out = L^-1 y` where nothing changes, `L` Cholesky's factor in its order of the unknowns, which keep their places;
    /// else nothing.
    pub(crate) fn half_solve(&self, factor: &SplitFactor, y: &[f64], out: &mut [f64], work: &mut [f64]) {
        if let Some(bunches) = &self.bunches {
            let (work, rest) = work.split_at_mut(bunches.work());
            self.eliminate_bunches::<Tile>(bunches, factor, y, work, rest);
            self.apply_roots(bunches, work, false);
            self.scatter(bunches, work, out, rest);
        }
    }

    /// `out = L^-T y`, likewise.
    pub(crate) fn half_solve_transpose(&self, factor: &SplitFactor, y: &[f64], out: &mut [f64], work: &mut [f64]) {
        if let Some(bunches) = &self.bunches {
            let (work, rest) = work.split_at_mut(bunches.work());
            for bunch in &bunches.all {
                self.gather(bunch, y, &mut work[bunch.numbers.clone()]);
            }
            self.apply_roots(bunches, work, true);
            self.substitute_bunches::<Tile>(bunches, factor, work);
            self.scatter(bunches, work, out, rest);
        }
    }

    fn apply_roots(&self, bunches: &Bunches, work: &mut [f64], before: bool) {
        for bunch in bunches.all.iter().filter(|bunch| self.is_here(bunch)) {
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

    fn eliminate_bunches<T: Reads>(
        &self,
        bunches: &Bunches,
        factor: &SplitFactor,
        y: &[f64],
        work: &mut [f64],
        message: &mut [f64],
    ) {
        let eliminate = |pass: Pass, work: &mut [f64]| {
            for height in &bunches.heights {
                bunches.over_height(height, work, true, &|bunch, part, below| {
                    if self.does_bunch(bunch, pass) {
                        self.gather(bunch, y, part);
                        self.take_sums(bunches, bunch, below, part);
                        self.solve_bunch::<T>(bunch, factor, part, true);
                    }
                });
            }
        };
        eliminate(Pass::Branches, work);
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
        branches.gather_sums(message);
        for branch in branches.of(false) {
            let sums = &message[branch.sums.clone()];
            sums.iter().zip(places(branch)).for_each(|(sum, k)| work[k] = *sum);
        }
        eliminate(Pass::Top, work);
    }

    fn substitute_bunches<T: Reads>(&self, bunches: &Bunches, factor: &SplitFactor, work: &mut [f64]) {
        if self.branches.is_some() {
            self.substitute::<T>(bunches, Pass::Top, factor, work);
        }
        self.substitute::<T>(bunches, Pass::Branches, factor, work);
    }

    fn substitute<T: Reads>(&self, bunches: &Bunches, pass: Pass, factor: &SplitFactor, work: &mut [f64]) {
        let tree = &self.tree;
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
                self.solve_bunch::<T>(bunch, factor, part, false);
            });
        }
    }

    /// Own unknowns of all regions to `y`; several processes tell one another theirs.
    fn scatter(&self, bunches: &Bunches, work: &[f64], y: &mut [f64], memory: &mut [f64]) {
        for bunch in bunches.all.iter().filter(|bunch| self.is_here(bunch)) {
            let part = &work[bunch.numbers.clone()];
            for (lane, &r) in bunch.regions.iter().enumerate() {
                let blocks = &self.tree.blocks[self.tree.regions[r as usize].region.own.clone()];
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
            let blocks = &self.tree.blocks[self.tree.regions[r as usize].region.own.clone()];
            for (i, &block) in blocks.iter().enumerate() {
                for c in 0..6 {
                    part[(6 * i + c) * bunch.width + lane] = y[6 * block as usize + c];
                }
            }
        }
    }

    /// Adds what the regions within leave.
    fn take_sums(&self, bunches: &Bunches, bunch: &Bunch, below: &[f64], part: &mut [f64]) {
        for (lane, &r) in bunch.regions.iter().enumerate() {
            for child in self.tree.regions[r as usize].region.children.into_iter().flatten() {
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

    /// Elimination or back substitution.
    fn solve_bunch<T: Reads>(&self, bunch: &Bunch, factor: &SplitFactor, part: &mut [f64], forward: bool) {
        let piece = &self.pieces[bunch.regions[0] as usize];
        let tiles = T::of(&piece.tiles);
        let (own, rest) = part.split_at_mut(bunch.own * bunch.width);
        let (behind, buffer) = rest.split_at_mut(bunch.behind * bunch.width);
        if bunch.width == 1 {
            let changing = T::of(&factor.tiles[bunch.regions[0] as usize]);
            match forward {
                true => {
                    piece.steady.forward(tiles, own, behind, buffer);
                    piece.changing.forward(changing, own, behind, buffer);
                }
                false => {
                    piece.changing.backward(changing, own, behind, buffer);
                    piece.steady.backward(tiles, own, behind, buffer);
                }
            }
            return;
        }
        let [own, behind, buffer] = [own, behind, buffer].map(|part| part.as_chunks_mut::<LANES>().0);
        piece.steady.solve(tiles, own, behind, buffer, forward);
    }
}
