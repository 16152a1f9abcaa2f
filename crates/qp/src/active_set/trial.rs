//! Trials of another prediction, beside a run that takes long.
//!
//! Sets of bodies that constraints alone hold may run in circles though their bounds have settled: on a solved set,
//! points that stick are beyond their circles by many radii, a move cuts them all off at once, and what goes with them
//! then seems to turn round. A semismooth Newton step does not ask the point moved to: discs slide where, and as far
//! as, the solved set tells. That ends such circles, but is no better elsewhere, so it is tried with a part of the
//! products spent so far. A run whose trial fails goes on as if there had been none.

use crate::error::QpError;
use crate::problem::{EqualityProjector, MovingSet, Segment, SymmetricOperator};
use crate::report::Status;
use crate::tolerances::{PATIENCE, TRIAL_AGAIN, TRIAL_PART};

use super::problem::ActiveSetPoint;
use super::run::Run;
use super::solver::solve;
use super::view::ActiveSetPreconditioner;
use super::workspace::ActiveSetWorkspace;

impl<A: SymmetricOperator, C: EqualityProjector, M: ActiveSetPreconditioner> Run<'_, A, C, M> {
    /// Whether this is a trial, and discs are foreseen from the solved set with their slips.
    pub(crate) fn is_slipping(&self) -> bool {
        self.is_trial && self.has_settled()
    }

    /// Whether discs of bodies that constraints alone hold take long though bounds have settled.
    pub(crate) fn wants_trial(&self) -> bool {
        let at = &self.at;
        let long = at.report.products() >= self.next_trial && !self.is_trial;
        let discs = || at.set.segments().iter().any(|s| matches!(s, Segment::Discs { .. }));
        long && !self.repairs_suffice && at.compliance.c == 0.0 && self.has_settled() && discs()
    }

    /// Tries slips from the present point. Whether that solved the problem: the run then has the solution.
    pub(crate) fn try_slips(&mut self) -> Result<bool, QpError> {
        let at = &mut self.at;
        let products = at.report.products();
        self.next_trial = TRIAL_AGAIN * products;
        let part = (TRIAL_PART * products as f64) as usize;
        let settings = self.settings.clone().limited_to(part.max(1)).with_patience(PATIENCE);
        let (mut set, mut x, mut ax) = (at.set.clone(), at.x.to_vec(), at.ax.to_vec());
        let mut work = ActiveSetWorkspace::new(at.problem.operator, at.problem.preconditioner);
        work.set_slopes(at.work.coupling.slopes());
        let hook = self.hook.as_mut().map(|hook| &mut **hook as _);
        let moving = MovingSet { set: &mut set, hook };
        let point = ActiveSetPoint {
            x: &mut x,
            ax: &mut ax,
            known: false,
        };
        let mut trial = Run::new(at.problem, at.projector, moving, point, &settings, &mut work)?;
        trial.is_trial = true;
        let status = match solve(&mut trial) {
            // it ran away, or its sets do not hold every mode
            Err(QpError::CoarseDeficient { .. } | QpError::NotFinite { .. }) => Status::Stagnated,
            outcome => outcome?,
        };
        let report = trial.finish(status);
        self.tried.add(&report);
        let (at, solved) = (&mut self.at, status == Status::Converged);
        if solved {
            *at.set = set;
            at.x.copy_from_slice(&x);
            at.ax.copy_from_slice(&ax);
            *at.work = work;
            at.report.error = report.error;
            at.report.constrained_error = report.constrained_error;
        } else {
            // the next set is foreseen with the weights of the last one
            at.projector.set_weights_and_lines(&at.work.w, &at.work.lines)?;
        }
        Ok(solved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::active_set::problem::ActiveSetProblem;
    use crate::active_set::settings::ActiveSetSettings;
    use crate::active_set::solver::go_on;
    use crate::problem::{DenseOperator, DenseProjector, Identity, ProductSet};

    /// A chain with discs, bounds and free components, and an equality, solved with a pause after so many products, in
    /// which slips may be tried with half as many: the solution, and the products of the run.
    fn chain(pause: usize, tries: bool) -> (Vec<f64>, usize) {
        const N: usize = 20;
        let entry = |k: usize| match (k / N).abs_diff(k % N) {
            0 => 1.0,
            1 => -0.49,
            _ => 0.0,
        };
        let a = DenseOperator::new(N, (0..N * N).map(entry).collect()).expect("symmetric");
        let b: Vec<f64> = (0..N).map(|k| (1.7 * k as f64).sin()).collect();
        let segments = vec![
            Segment::upper(vec![0.0; 4]),
            Segment::discs(vec![0.3, 0.1, 0.5, 0.2]),
            Segment::Free(N - 12),
        ];
        let mut set = ProductSet::new(segments).expect("a set");
        let mut projector = DenseProjector::new(1, N, vec![1.0; N]).expect("a row");
        let identity = Identity(N);
        let problem = ActiveSetProblem {
            operator: &a,
            preconditioner: &identity,
            scale: &[1.0; N],
            linear: &b,
            rhs: &[0.2],
        };
        let (mut x, mut ax) = (vec![0.0; N], vec![0.0; N]);
        let mut work = ActiveSetWorkspace::new(&a, &identity);
        let whole = ActiveSetSettings::default().with_tolerance(1e-12);
        let few = whole.clone().limited_to(pause);
        let point = ActiveSetPoint {
            x: &mut x,
            ax: &mut ax,
            known: true,
        };
        let moving = MovingSet::fixed(&mut set);
        let mut run = Run::new(&problem, &mut projector, moving, point, &few, &mut work).expect("slopes");
        run.start().expect("a start");
        assert_eq!(go_on(&mut run).expect("a limit"), Status::IterationLimit);
        if tries {
            assert!(!run.try_slips().expect("a trial"));
        }
        run.settings = &whole;
        assert_eq!(go_on(&mut run).expect("solved"), Status::Converged);
        let spent = run.tried.products();
        assert_eq!(spent > 0, tries);
        let products = run.finish(Status::Converged).products() - spent;
        (x, products)
    }

    #[test]
    fn a_run_goes_on_after_a_trial_as_if_there_had_been_none() {
        for pause in 2..26 {
            assert_eq!(chain(pause, true), chain(pause, false), "{pause}");
        }
    }
}
