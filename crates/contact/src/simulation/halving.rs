//! The way through a step: whole, or in increments that are halved where they fail and joined again.

use crate::scene::Increment;
use crate::status::StepStatus;

use super::result::StepResult;
use crate::report::StepReport;
use signorini_fem_mesh::vec3::add;

/// Where in a step a simulation is. Increments are `1, 1/2, 1/4, ...` of the step, and begin at multiples of their
/// length.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    whole: Increment,
    /// How often the increment to come is halved, and how often it may be.
    halved: u32,
    most: u32,
    /// The same of the one before; `None` from rest.
    last: Option<u32>,
    /// What is passed, in shortest increments.
    passed: u64,
    /// Whether a shortest increment failed: nothing is halved any more.
    failed: bool,
}

impl Way {
    /// At the beginning of a step; what was halved before it is so once less.
    pub(super) fn new(whole: Increment, most: u32, last: Option<u32>) -> Self {
        let most = if whole.length.is_some() { most } else { 0 };
        Self {
            whole,
            halved: last.map_or(0, |last| last.saturating_sub(1).min(most)),
            most,
            last,
            passed: 0,
            failed: false,
        }
    }

    /// In shortest increments.
    fn length(&self) -> u64 {
        1 << (self.most - self.halved)
    }

    fn end(&self) -> u64 {
        1 << self.most
    }

    /// The increment to come.
    pub(super) fn increment(&self) -> Increment {
        let fraction = |passed: u64| passed as f64 / self.end() as f64;
        let [from, to] = [self.passed, self.passed + self.length()].map(fraction);
        self.whole.part([from, to], self.ratio())
    }

    /// Its length over that of the one before; 1 from rest.
    pub(super) fn ratio(&self) -> f64 {
        let power = |halved: u32| 0.5_f64.powi(halved as i32);
        let whole = if self.passed == 0 { self.whole.ratio } else { 1.0 };
        self.last.map_or(1.0, |last| whole * power(self.halved) / power(last))
    }

    /// How often it is halved.
    pub(super) fn halved(&self) -> u32 {
        self.halved
    }

    /// Whether the step goes on after it.
    pub(super) fn goes_on(&self) -> bool {
        self.passed + self.length() < self.end()
    }

    /// After a failure, halves it. Where it is the shortest there may be, what is left of the step is taken in the
    /// longest increments. `false` if the failed one stays.
    pub(super) fn retry(&mut self) -> bool {
        if self.failed {
            return false;
        }
        self.failed = self.halved == self.most;
        if !self.failed {
            self.halved += 1;
            return true;
        }
        let shortest = self.halved;
        while self.halved > 0 && self.may_grow() {
            self.halved -= 1;
        }
        self.halved < shortest
    }

    fn may_grow(&self) -> bool {
        self.passed.is_multiple_of(2 * self.length())
    }

    /// Takes it. The next one is twice as long where it may begin.
    pub(super) fn pass(&mut self) {
        self.passed += self.length();
        self.last = Some(self.halved);
        if self.halved > 0 && self.may_grow() {
            self.halved -= 1;
        }
    }
}

/// What came before the last increment of a step: its cost, works, and what did not converge.
#[derive(Debug, Default)]
pub(super) struct Before {
    report: Option<StepReport>,
    /// Of each summary those of friction, its dissipation, of obstacles, J.
    works: Vec<[f64; 3]>,
    /// Of each contact point the sum of its tangential differences, m.
    differences: Vec<[f64; 3]>,
    refused: Option<StepStatus>,
}

impl Before {
    /// An increment that failed and was replaced, by halves or longer ones; `None` where its solver broke down.
    pub(super) fn enter_failed(&mut self, failed: Option<StepReport>, halved: bool) {
        let mut report = failed.unwrap_or_default();
        report.counters.halvings += usize::from(halved);
        self.enter(report);
    }

    /// One on whose end the step goes on.
    pub(super) fn enter_between(&mut self, mut result: StepResult) {
        result.report.counters.between += 1;
        self.works.resize(result.summaries.len(), [0.0; 3]);
        for (sum, s) in self.works.iter_mut().zip(&result.summaries) {
            *sum = add(*sum, [s.friction_work, s.dissipation, s.obstacle_work]);
        }
        let points = &result.recovered.points;
        self.differences.resize(points.len(), [0.0; 3]);
        for (sum, point) in self.differences.iter_mut().zip(points) {
            *sum = add(*sum, point.difference);
        }
        let status = result.report.status;
        let depends = result.model.plan.effects.history && !status.converged();
        self.refused = self.refused.or(depends.then_some(status));
        self.enter(result.report);
    }

    fn enter(&mut self, report: StepReport) {
        self.report = Some(match self.report.take() {
            Some(before) => before.resumed(report),
            None => report,
        });
    }

    /// The result of the step from that of its last increment.
    pub(super) fn complete(self, result: &mut StepResult) {
        let Some(before) = self.report else {
            return;
        };
        let mut report = before.resumed(result.report.clone());
        if let Some(status) = self.refused.filter(|_| report.status.converged()) {
            report.status = status;
        }
        result.report = report;
        for (s, sum) in result.summaries.iter_mut().zip(self.works) {
            let works = [s.friction_work, s.dissipation, s.obstacle_work];
            [s.friction_work, s.dissipation, s.obstacle_work] = add(works, sum);
        }
        for (point, sum) in result.recovered.points.iter_mut().zip(self.differences) {
            point.difference = add(point.difference, sum);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Analysis, DifferenceFormula};

    /// Ends of the increments of a step of length 1, failing where `fails` says so.
    fn walk(most: u32, last: Option<u32>, fails: impl Fn(f64, f64) -> bool) -> (Vec<f64>, Way) {
        let whole = Analysis::quasistatic(1.0, 1).increment(0).expect("a step");
        let mut way = Way::new(whole, most, last);
        let mut ends = Vec::new();
        loop {
            let increment = way.increment();
            let length = increment.length.expect("a length");
            if fails(increment.end, length) && way.retry() {
                continue;
            }
            ends.push(increment.end);
            let goes_on = way.goes_on();
            way.pass();
            if !goes_on {
                return (ends, way);
            }
        }
    }

    #[test]
    fn increments_shrink_where_they_fail_and_grow_again() {
        assert_eq!(walk(0, None, |_, _| true).0, [1.0]);
        assert_eq!(walk(3, None, |_, _| false).0, [1.0]);
        // nothing longer than an eighth gets over 0.3
        let hard = |end: f64, length: f64| end > 0.3 && end - length < 0.3 && length > 0.125;
        let (ends, way) = walk(3, None, hard);
        assert_eq!(ends, [0.25, 0.375, 0.5, 0.75, 1.0]);
        assert_eq!((way.last, way.halved), (Some(2), 1));
        // limits hold
        assert_eq!(walk(2, None, |_, _| true).0, [1.0]);
        assert_eq!(walk(3, None, |end, _| end > 0.3).0, [0.25, 0.5, 1.0]);
        // the next step begins twice as long as the last one ended, and goes on growing
        assert_eq!(walk(3, Some(3), |_, _| false).0, [0.25, 0.5, 1.0]);
        assert_eq!(walk(1, Some(3), |_, _| false).0, [0.5, 1.0]);
    }

    #[test]
    fn ratios_are_those_of_neighbours() {
        let whole = Analysis::quasistatic(1.0, 1).increment(0).expect("a step");
        let mut way = Way::new(whole, 2, Some(2));
        let mut ratios = vec![way.ratio()];
        while way.goes_on() {
            way.pass();
            ratios.push(way.ratio());
        }
        assert_eq!(ratios, [2.0, 1.0]);
        assert_eq!(Way::new(whole, 2, None).ratio(), 1.0);
        // of unequal steps the first increment only
        let (times, formula) = (vec![0.5, 1.0, 1.125], DifferenceFormula::BACKWARD_EULER);
        let unequal = Analysis::Quasistatic { times, formula };
        let steps = (0..3).map(|step| unequal.increment(step).expect("a step"));
        let ratios: Vec<f64> = steps.map(|step| Way::new(step, 0, Some(0)).ratio()).collect();
        assert_eq!(ratios, [1.0, 1.0, 0.25]);
        let mut way = Way::new(unequal.increment(2).expect("a step"), 1, Some(1));
        assert_eq!((way.ratio(), way.increment().length), (0.5, Some(0.125)));
        way = Way::new(way.whole, 1, Some(2));
        let first = way.ratio();
        way.pass();
        assert_eq!([first, way.ratio()], [0.5, 1.0]);
    }
}
