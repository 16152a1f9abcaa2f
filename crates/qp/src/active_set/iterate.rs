//! The iterate on its present active set: what conjugate gradients, and the moves between sets, work on.

use crate::error::QpError;
use crate::problem::{Constrained, EqualityProjector, ProductSet, SymmetricOperator, for_constrained};
use crate::tolerances::SLID;
use crate::vector;

use super::balance::Search;
use super::blocks::ActiveSet;
use super::compliance::Compliance;
use super::natural_map::NaturalMap;
use super::problem::ActiveSetProblem;
use super::settings::ActiveSetReport;
use super::view::ActiveSetPreconditioner;
use super::workspace::ActiveSetWorkspace;

/// A length of a vector and that of its constrained part.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lengths {
    pub(crate) all: f64,
    pub(crate) constrained: f64,
}

impl Lengths {
    pub(crate) const INFINITE: Self = Self {
        all: f64::INFINITY,
        constrained: f64::INFINITY,
    };

    /// Both lengths from their two values.
    pub(crate) fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            all: f(self.all, other.all),
            constrained: f(self.constrained, other.constrained),
        }
    }

    /// Whether both are at most those of `limits`.
    pub(crate) fn within(self, limits: Self) -> bool {
        self.all <= limits.all && self.constrained <= limits.constrained
    }
}

/// What a preconditioning is asked for besides `rho`: `z · ap`, or `x · x`.
pub(crate) enum Wanted {
    Nothing,
    Along,
    Size,
}

/// A problem, its iterate and the active set it is on. Between two methods `ax` is `A x` but for changes of `x` since
/// [`mark`](Iterate::mark).
pub(crate) struct Iterate<'s, A: SymmetricOperator, C, M: SymmetricOperator> {
    pub(crate) problem: &'s ActiveSetProblem<'s, A, M>,
    pub(crate) projector: &'s mut C,
    pub(crate) set: &'s mut ProductSet,
    pub(crate) x: &'s mut [f64],
    pub(crate) ax: &'s mut [f64],
    pub(crate) work: &'s mut ActiveSetWorkspace<A, M>,
    pub(crate) report: ActiveSetReport,
    /// Springs in series with the constrained components; `A` and `ax` are with them.
    pub(crate) compliance: Compliance,
    /// Step of the natural map.
    pub(crate) step: f64,
    /// Whether `x` is a start that has left the point whose product is known, by `t`.
    pub(crate) ahead: bool,
    /// Whether the last balance took springs that stop loose modes.
    pub(crate) on_springs: bool,
}

impl<A: SymmetricOperator, C: EqualityProjector, M: ActiveSetPreconditioner> Iterate<'_, A, C, M> {
    /// Components up to the last constrained one.
    pub(crate) fn constrained(&self) -> usize {
        self.work.restricted.len()
    }

    /// Notes the point whose product is known in `t`: `x`, or what it has left.
    pub(crate) fn mark(&mut self) {
        if std::mem::take(&mut self.ahead) {
            vector::axpby(1.0, self.x, -1.0, &mut self.work.t)
        } else {
            vector::copy(self.x, &mut self.work.t)
        }
    }

    /// Whether `x` has moved from the [mark](Iterate::mark) by more than a `length`; `t` becomes that move.
    pub(crate) fn moved(&mut self, length: f64) -> bool {
        let constrained = self.constrained();
        let t = &mut self.work.t;
        vector::axpby(1.0, self.x, -1.0, t);
        // a sum of all processes is asked for only where constrained components, which each has, do not tell
        let tells = length == 0.0 && t[..constrained].iter().any(|t| t.abs() > 0.0);
        tells || self.problem.operator.norm(t) > length
    }

    /// The product follows `x` from the [mark](Iterate::mark), if it has moved by more than `length`. Whether it does.
    pub(crate) fn correct(&mut self, length: f64) -> bool {
        let follows = self.moved(length);
        if follows {
            self.catch_up();
        }
        follows
    }

    /// The same after a move that was too short: `ax += A t`, where `t` is that move.
    pub(crate) fn catch_up(&mut self) {
        let work = &mut *self.work;
        let part = work.restricted.len();
        self.compliance
            .apply(self.problem, part, &work.t, &mut work.ap, &mut work.operator);
        vector::axpy(1.0, &work.ap, self.ax);
        self.ahead = false;
        self.report.corrections += 1;
    }

    /// `ax = A x`.
    pub(crate) fn multiply(&mut self) {
        let part = self.constrained();
        self.compliance
            .apply(self.problem, part, self.x, self.ax, &mut self.work.operator);
        self.ahead = false;
        self.report.corrections += 1;
    }

    /// `residual = P_Wᵀ (A x - b)`; of what a start has moved, each constrained component tells its own answer.
    pub(crate) fn residual(&mut self) {
        let constrained = self.constrained();
        let ActiveSetWorkspace { residual, t, .. } = &mut *self.work;
        vector::difference(self.ax, self.problem.linear, residual);
        if self.ahead {
            Compliance { c: 1.0 }.add(self.problem.scale, &t[..constrained], residual);
        }
        self.projector.project_gradient(residual);
    }

    /// Another compliance of the constrained components; the product follows.
    pub(crate) fn set_compliance(&mut self, c: f64) {
        let (before, constrained) = (self.compliance, self.constrained());
        let change = Compliance { c: c - before.c };
        change.add(self.problem.scale, &self.x[..constrained], self.ax);
        self.compliance = Compliance { c };
        self.step *= self.compliance.share() / before.share();
    }

    /// Tells the active set what the natural map makes of the blocks here.
    pub(crate) fn tell_map(&mut self, tell: fn(&mut ActiveSet, &ProductSet, &[f64], &NaturalMap<'_>)) {
        let map = natural_map(self.problem, &self.work.residual, self.step);
        tell(&mut self.work.active, self.set, self.x, &map);
    }

    /// The residual on the active set from `residual`.
    pub(crate) fn start_residual(&mut self) {
        let work = &mut *self.work;
        let constrained = work.restricted.len();
        work.restricted.copy_from_slice(&work.residual[..constrained]);
        work.active.restrict(self.set, &mut work.restricted);
    }

    /// `z` from the residual on the active set, with its norm. Returns `rho`, and what else is wanted, or zero.
    pub(crate) fn precondition(&mut self, wanted: Wanted) -> (f64, f64) {
        let ActiveSetWorkspace {
            residual,
            restricted,
            saved,
            z,
            ap,
            z_norm,
            active,
            preconditioner: scratch,
            ..
        } = &mut *self.work;
        let (set, constrained) = (&*self.set, restricted.len());
        saved.copy_from_slice(&residual[..constrained]);
        residual[..constrained].copy_from_slice(restricted);
        let damps = !self.problem.preconditioner.knows_added();
        if damps {
            active.damp(set, &mut residual[..constrained]);
            self.compliance.damp(&mut residual[..constrained]);
        }
        self.problem.preconditioner.apply(residual, z, scratch);
        let part = &mut z[..constrained];
        active.restrict(set, part);
        if damps {
            active.damp(set, part);
            self.compliance.damp(part);
            self.compliance.add_own(self.problem.scale, restricted, part);
            active.add_own(set, restricted, part);
        }
        self.projector.project_step(z);
        self.report.preconditionings += 1;
        residual[..constrained].copy_from_slice(restricted);
        let operator = self.problem.operator;
        let [rho, square, other] = match wanted {
            Wanted::Along => operator.dots([(residual, z), (z, z), (z, ap)]),
            Wanted::Size => operator.dots([(residual, z), (z, z), (self.x, self.x)]),
            Wanted::Nothing => {
                let [rho, square] = operator.dots([(residual, z), (z, z)]);
                [rho, square, 0.0]
            }
        };
        residual[..constrained].copy_from_slice(saved);
        *z_norm = square.sqrt();
        (rho, other)
    }

    /// Moves `x` to the point of the set next to it whose constrained components balance what nothing else does, in
    /// the metric of the preconditioner; where they cannot, with the springs of loose modes. Where there is none, which
    /// is returned as false, the equality comes first.
    pub(crate) fn project(&mut self) -> bool {
        let from = self.x[..self.constrained()].to_vec();
        self.on_springs = false;
        if self.approach(&from, false) {
            return true;
        }
        let sprung = self.projector.loose().iter().any(|mode| !mode.springs.is_empty());
        self.on_springs = sprung && self.approach(&from, true);
        if !self.on_springs {
            self.projector.balance(self.x, self.problem.rhs);
        }
        self.on_springs
    }

    /// The same from `y`, with springs only if these `give`, but for the equality where there is no such point:
    /// constrained components then balance as far as they can.
    fn approach(&mut self, y: &[f64], give: bool) -> bool {
        let (point, balances, amplitudes) = self.balanced(y, &self.problem.scale[..y.len()], give);
        self.x[..y.len()].copy_from_slice(&point);
        let springs = (self.projector.loose().iter().zip(&amplitudes)).filter(|_| balances && give);
        for (mode, b) in springs {
            mode.springs.iter().for_each(|&(i, c, a)| self.x[i] -= a * c * b);
        }
        balances
    }

    /// [`project_start`](Iterate::project_start), and where that moves nothing [`project`](Iterate::project) with the
    /// set of the start: the projector may still have that of another solve.
    pub(crate) fn begin(&mut self) -> Result<(), QpError> {
        if self.project_start() {
            return Ok(());
        }
        let from = self.x[..self.constrained()].to_vec();
        if self.approach(&from, false) {
            return Ok(());
        }
        if self.set_weights()?.is_none() {
            self.set_all_free()?;
        }
        self.projector.balance(self.x, self.problem.rhs);
        Ok(())
    }

    /// The same for the start of a solve: components at their bounds stay there, and points on their circles stay on
    /// them. Leaves `x` alone and returns false if the others do not suffice.
    pub(crate) fn project_start(&mut self) -> bool {
        let constrained = self.constrained();
        let mut y = self.x[..constrained].to_vec();
        let mut lengths = self.problem.scale[..constrained].to_vec();
        for_constrained(self.set, |block| match block {
            Constrained::Bound { i, lower, upper, .. } => {
                if y[i] <= lower || y[i] >= upper {
                    lengths[i] = 0.0;
                }
            }
            Constrained::Disc { i, radius, .. } => {
                if y[i].hypot(y[i + 1]) >= radius * (1.0 - SLID) {
                    y[i..i + 2].iter_mut().for_each(|y| *y *= 2.0);
                }
            }
        });
        let (point, balances, _) = self.balanced(&y, &lengths, false);
        self.take(&point, balances)
    }

    /// Moves the constrained components of `x` to where bodies that are rigid balance on springs of this part of the
    /// preconditioner's stiffness, with `A x` left out of the gradient. Returns false and leaves `x` if there is no
    /// such point.
    pub(crate) fn sink(&mut self, stiffness: f64) -> bool {
        let constrained = self.constrained();
        let lengths: Vec<f64> = self.problem.scale[..constrained]
            .iter()
            .map(|a| stiffness * a)
            .collect();
        let y: Vec<f64> = lengths.iter().zip(self.problem.linear).map(|(a, b)| a * b).collect();
        let (point, balances, _) = self.balanced(&y, &lengths, false);
        self.take(&point, balances)
    }

    fn balanced(&self, y: &[f64], lengths: &[f64], give: bool) -> (Vec<f64>, bool, Vec<f64>) {
        let (modes, rhs) = (self.projector.loose(), self.problem.rhs);
        Search::new(modes, self.set, (rhs, self.x), (y, lengths), give).run()
    }

    /// Moves to a point if that balances; whether it does.
    fn take(&mut self, point: &[f64], balances: bool) -> bool {
        if balances {
            self.x[..point.len()].copy_from_slice(point);
        }
        balances
    }

    /// Estimated errors: the lengths of `z`.
    pub(crate) fn errors(&self) -> Lengths {
        let constrained = &self.work.z[..self.constrained()];
        Lengths {
            all: self.work.z_norm,
            constrained: vector::norm(constrained),
        }
    }

    /// An error for something that is not a number.
    pub(crate) fn not_finite(&self, quantity: &'static str) -> QpError {
        QpError::NotFinite {
            quantity,
            products: self.report.products(),
        }
    }
}

/// The natural map with this gradient.
pub(crate) fn natural_map<'a, A, M>(
    problem: &ActiveSetProblem<'a, A, M>,
    gradient: &'a [f64],
    step: f64,
) -> NaturalMap<'a> {
    NaturalMap {
        gradient,
        scale: problem.scale,
        step,
    }
}
