//! The projector of the active set method of `signorini-qp`: `G` weighted by the rows that are free.

use crate::coarse::space::{Coarse, CoarseScratch};
use crate::coarse::weights::RowWeights;
use crate::error::TfetiError;
use crate::linalg::tiles::Digits;
use crate::projector::factor::{CoarseFactor, Factor};
use crate::projector::levels::{Basis, row_weights};
use crate::projector::split::factor::SplitFactor;
use crate::projector::split::front::Front;
use crate::projector::split::fronts::ContactWeights;
use crate::tolerances::{MOVING, ROUNDED_STEP, SHORT_ROWS, SOFT_SPRING, WORK};
use signorini_qp::internal::{LineWeight, LooseMode};
use signorini_qp::vector::{dot, norm};
use signorini_qp::{EqualityProjector, QpError};

/// How `G W G^T` is factored when the active set changes.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum ActiveSetFactor {
    /// The cheaper of the others by size.
    #[default]
    Auto,
    /// A sparse factor of the whole matrix each time.
    Sparse,
    /// What no subdomain with contact rows leads to is eliminated once; the rest of the tree is factored each time.
    Split,
    /// A factor that stays, and one of clusters of subdomains that is made each time.
    Levels,
}

/// `G x = e` with projectors weighted by the free rows of the current active set, see [`EqualityProjector`].
///
/// Repairs use the interface and support rows only, so they never touch a contact row. Motions of bodies that these
/// rows do not stop are [loose](EqualityProjector::loose).
#[derive(Debug)]
pub struct ActiveSetProjector {
    coarse: Coarse,
    /// Factor with the weights of always free rows.
    always: CoarseFactor,
    /// What these do not hold.
    loose: Vec<LooseMode>,
    /// Rows of springs that are too soft to hold; none where others hold what they do.
    soft: Vec<usize>,
    /// Factor of the last active set.
    active: CoarseFactor,
    /// Of the rows that may have another weight than 1.
    weights: Vec<f64>,
    /// Directions of the last active set besides its weights.
    lines: Vec<LineWeight>,
    parts: SplitParts,
    /// Memory of the last but one factor.
    spare: Option<SplitFactor>,
    /// Weight of each row where it is free; `None` means 1.
    metric: Option<Vec<f64>>,
    coarse_rhs: Vec<f64>,
    alpha: Vec<f64>,
    /// Amplitudes of the last gradient of this problem, and what the model took of them; empty before the first, and
    /// with one level.
    known: Vec<f64>,
    taken: Vec<f64>,
    scratch: CoarseScratch,
    /// What the steps of an iteration read.
    digits: Digits,
}

/// What split factors are made from.
#[derive(Debug)]
struct SplitParts {
    basis: Option<Basis>,
    /// Leading rows with constraints.
    contact_rows: usize,
    /// Work memory of factorisations.
    fronts: Vec<Front>,
    contact: ContactWeights,
}

impl ActiveSetProjector {
    /// For the coarse space of a system; `contact_rows` is the number of leading rows with constraints.
    ///
    /// `metric` gives free rows another weight than 1, see [`Tfeti::row_weights`](crate::Tfeti::row_weights).
    ///
    /// # Errors
    /// [`TfetiError::Setting`] if there are fewer contact rows or a weight is not usable, [`TfetiError::Length`] if
    /// `metric` is not as long as dual vectors, others if a factorisation fails.
    pub fn new(coarse: &Coarse, contact_rows: usize, metric: Option<Vec<f64>>) -> Result<Self, TfetiError> {
        Self::with_factor(coarse, contact_rows, metric, ActiveSetFactor::Auto)
    }

    /// The same with a given kind of factor: for benches, and for tests of one kind against the other.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    #[doc(hidden)]
    pub fn with_factor(
        coarse: &Coarse,
        contact_rows: usize,
        metric: Option<Vec<f64>>,
        kind: ActiveSetFactor,
    ) -> Result<Self, TfetiError> {
        let ranges = coarse.0.gluing.ranges();
        if contact_rows > ranges.contact().end {
            return Err(TfetiError::Setting {
                name: "contact rows of a projector",
                value: contact_rows as f64,
                range: "at most the contact rows of the system",
            });
        }
        if let Some(metric) = &metric {
            TfetiError::check_length("row weights", metric.len(), coarse.dim())?;
            RowWeights::diagonal(metric.clone()).validate(ranges)?;
        }
        let weights = vec![0.0; contact_rows];
        let pays = |basis: &Basis| match basis {
            Basis::Split(base) => base.pays(coarse.rows(), coarse.factor_size()),
            Basis::Model(..) => true,
        };
        let basis = match kind {
            ActiveSetFactor::Sparse => None,
            ActiveSetFactor::Auto => coarse.basis(contact_rows, metric.as_deref(), None).filter(pays),
            _ => coarse.basis(contact_rows, metric.as_deref(), Some(kind == ActiveSetFactor::Levels)),
        };
        let mut parts = SplitParts {
            basis,
            contact_rows,
            fronts: Vec::new(),
            contact: ContactWeights::default(),
        };
        let always = row_weights(coarse, &weights, metric.as_deref());
        let mut soft = soft_springs(coarse, contact_rows, metric.as_deref());
        // unless others hold what they do
        let leaves_free = |weights: &RowWeights| !coarse.0.free_motions(Some(weights)).is_empty();
        let unsprung = (!soft.is_empty()).then(|| without(&always, &soft));
        let factor = if let Some(unsprung) = unsprung.filter(leaves_free) {
            // soft springs would take what contact balances, and throw the body far off
            coarse.factor_weighted(unsprung)?
        } else {
            soft.clear();
            match &parts.basis {
                Some(Basis::Model(_, always)) => always.clone(),
                _ => parts.factor(coarse, always, None)?,
            }
        };
        let mut scratch = factor.scratch();
        let motions = factor.free_motions().iter();
        let mut loose: Vec<_> = motions
            .map(|motion| coarse.loose_mode(&motion.amplitudes, contact_rows, &soft))
            .collect();
        // a motion that no contact row holds must not ask for a balance by what rounding leaves of its row; rows are of
        // length one, and displacements of a motion, too
        let largest = |mode: &LooseMode| mode.row.iter().fold(0.0, |most: f64, (_, c)| most.max(c.abs()));
        let held_by_none = loose.iter_mut().filter(|mode| largest(mode) <= MOVING);
        held_by_none.for_each(|mode| mode.row.clear());
        // weights that are added to those that hold every body leave the matrix better conditioned
        let large = coarse.rows() >= SHORT_ROWS;
        let single =
            large && loose.is_empty() && factor.has_short() && factor.single_error(&mut scratch) <= ROUNDED_STEP;
        Ok(Self {
            digits: if single { Digits::Single } else { Digits::Double },
            scratch,
            coarse: coarse.clone(),
            always: factor.clone(),
            loose,
            active: factor,
            // the first set has springs
            weights: if soft.is_empty() { weights } else { Vec::new() },
            soft,
            lines: Vec::new(),
            parts,
            spare: None,
            metric,
            coarse_rhs: vec![0.0; coarse.rows()],
            alpha: vec![0.0; coarse.rows()],
            known: Vec::new(),
            taken: Vec::new(),
        })
    }

    /// Whether it has two levels.
    #[doc(hidden)]
    pub fn has_levels(&self) -> bool {
        matches!(self.parts.basis, Some(Basis::Model(..)))
    }

    /// Whether a factor that is much larger than vectors are is stored in single precision, too: then what changes
    /// between two active sets is projected with that.
    fn rounds_levels(&self) -> bool {
        self.has_levels() && self.rounds_steps()
    }

    /// The factor of the last active set.
    pub fn factor(&self) -> &CoarseFactor {
        &self.active
    }

    /// Tells the right side `e` of the next problem: rigid motions that no free row stops are harmless as long as `e`
    /// does no work on them.
    ///
    /// # Panics
    /// If `e` does not have one entry for each row of `G`.
    pub fn set_coarse_rhs(&mut self, e: &[f64]) {
        self.coarse_rhs.copy_from_slice(e);
        self.known.clear();
    }

    /// Amplitudes of the rigid motions, `-(G W G^T)^-1 G W r`, with the weights of the last active set.
    pub fn amplitudes(&mut self, residual: &[f64], alpha: &mut [f64]) {
        self.active.amplitudes(residual, alpha, &mut self.scratch);
    }

    /// An error if the right side does work on a free motion of a factor.
    fn check(&self, factor: &CoarseFactor) -> Result<(), QpError> {
        let size = norm(&self.coarse_rhs);
        let works = |a: &[f64]| dot(a, &self.coarse_rhs).abs() > WORK * size * norm(a);
        match factor.free_motions().iter().find(|motion| works(&motion.amplitudes)) {
            Some(motion) => Err(QpError::CoarseDeficient {
                motion: motion.to_string(),
            }),
            None => Ok(()),
        }
    }

    /// Work of a step, with its digits.
    fn step(&mut self, work: impl FnOnce(&mut Self)) {
        self.scratch.digits = self.digits;
        work(self);
        self.scratch.digits = Digits::Double;
    }
}

/// Rows of springs that are soft beside the stiffest rows, where contact may hold what they do.
fn soft_springs(coarse: &Coarse, contact_rows: usize, metric: Option<&[f64]>) -> Vec<usize> {
    let Some(metric) = metric.filter(|_| contact_rows > 0) else {
        return Vec::new();
    };
    let gluing = &coarse.0.gluing;
    let rows = gluing.spring_rows().zip(gluing.springs());
    let soft = rows.filter(|(row, spring)| metric[*row] * spring.scale.powi(2) < SOFT_SPRING);
    soft.map(|(row, _)| row).collect()
}

/// Weights of which these rows have none.
fn without(weights: &RowWeights, rows: &[usize]) -> RowWeights {
    let mut out = weights.clone();
    rows.iter().for_each(|&row| out.diagonal[row] = 0.0);
    out
}

impl SplitParts {
    /// The factor for `weights` on this basis; of the whole matrix if there is no basis, if free motions ask for a
    /// generalised inverse, or if the matrix is singular to working precision.
    fn factor(
        &mut self,
        coarse: &Coarse,
        weights: RowWeights,
        spare: Option<SplitFactor>,
    ) -> Result<CoarseFactor, TfetiError> {
        weights.validate(coarse.0.gluing.ranges())?;
        let allows = |basis: &Basis| match basis {
            Basis::Split(base) => base.allows(&weights.lines),
            Basis::Model(model, _) => model.allows(&weights.lines),
        };
        let free = coarse.0.free_motions(Some(&weights));
        let usable = |basis: &&Basis| allows(basis) && free.is_empty();
        if let Some(basis) = self.basis.as_ref().filter(usable) {
            self.contact.set(&weights.diagonal[..self.contact_rows], &weights.lines);
            let (contact, fronts) = (&self.contact, &mut self.fronts);
            let factor = match basis {
                Basis::Split(base) => {
                    let factor = base.factor(contact, spare, fronts);
                    factor.map(|factor| Factor::Split(base.clone(), factor))
                }
                Basis::Model(model, always) => {
                    let factor = model.factor(contact, spare, fronts);
                    factor.map(|factor| Factor::Model(model.clone(), factor, always.clone()))
                }
            };
            if let Ok(factor) = factor {
                return Ok(CoarseFactor::new(coarse.clone(), factor, Some(weights), free));
            }
        }
        coarse.factor_with(Some(weights), free)
    }
}

impl EqualityProjector for ActiveSetProjector {
    fn dim(&self) -> usize {
        self.coarse.dim()
    }

    fn rows(&self) -> usize {
        self.coarse.rows()
    }

    fn set_weights(&mut self, w: &[f64]) -> Result<bool, QpError> {
        let (expected, found) = (self.coarse.dim(), w.len());
        if found != expected {
            let what = "the weights of an active set";
            return Err(QpError::Length { what, found, expected });
        }
        self.set_weights_and_lines(w, &[])
    }

    fn set_weights_and_lines(&mut self, w: &[f64], lines: &[LineWeight]) -> Result<bool, QpError> {
        let rows = self.parts.contact_rows;
        let fixed = w.iter().skip(rows).all(|w| *w == 1.0);
        let w = if fixed { &w[..rows.min(w.len())] } else { w };
        if w == self.weights && lines == self.lines {
            return self.check(&self.active).map(|()| false);
        }
        let mut weights = row_weights(&self.coarse, w, self.metric.as_deref());
        let metric = |row: usize| {
            let metric = self.metric.as_ref();
            metric.and_then(|m| m.get(row)).copied().unwrap_or(1.0)
        };
        weights.lines.extend_from_slice(lines);
        for line in &mut weights.lines {
            line.weight *= metric(line.row);
        }
        let factor = if fixed {
            self.parts.factor(&self.coarse, weights, self.spare.take())
        } else {
            self.coarse.factor_weighted(weights)
        };
        let motion = |error: TfetiError| QpError::CoarseDeficient {
            motion: error.to_string(),
        };
        let factor = factor.map_err(motion)?;
        self.check(&factor)?;
        self.weights.clear();
        self.weights.extend_from_slice(w);
        self.lines.clear();
        self.lines.extend_from_slice(lines);
        let last = std::mem::replace(&mut self.active, factor);
        self.spare = last.into_split();
        Ok(true)
    }

    fn balances(&mut self, x: &[f64], e: &[f64]) -> bool {
        if self.active.free_motions().is_empty() {
            return true;
        }
        self.coarse.apply(x, &mut self.alpha, &mut self.scratch);
        let size = norm(e).max(norm(x));
        let off = |a: &[f64]| -> f64 {
            let both = self.alpha.iter().zip(e);
            a.iter().zip(both).map(|(a, (g, e))| a * (g - e)).sum()
        };
        let mut motions = self.active.free_motions().iter().map(|m| &m.amplitudes);
        motions.all(|a| off(a).abs() <= WORK * size * norm(a))
    }

    fn project(&mut self, x: &mut [f64]) {
        self.active.project(x, None, &mut self.scratch);
    }

    fn project_transpose(&mut self, g: &mut [f64]) {
        self.active.project_transpose(g, &mut self.alpha, &mut self.scratch);
    }

    fn rounds_steps(&self) -> bool {
        self.digits == Digits::Single
    }

    fn project_step(&mut self, x: &mut [f64]) {
        self.step(|space| space.project(x));
    }

    fn project_gradient(&mut self, g: &mut [f64]) {
        let is_model = self.active.always().is_some();
        if self.known.is_empty() || !is_model {
            self.project_transpose(g);
            self.known.clear();
            if self.rounds_levels() && is_model {
                self.known.extend_from_slice(&self.alpha);
                self.taken.clone_from(&self.scratch.side);
            }
            return;
        }
        self.coarse.0.add_transpose(&self.known, g, &mut self.scratch.motions);
        self.step(|space| space.project_transpose(g));
        self.known.iter_mut().zip(&self.alpha).for_each(|(k, a)| *k += a);
        self.taken.copy_from_slice(&self.scratch.side);
    }

    fn project_gradient_again(&mut self, g: &mut [f64]) -> bool {
        if self.known.is_empty() || self.active.always().is_none() {
            return false;
        }
        self.step(|space| {
            let (taken, alpha) = (&mut space.taken, &mut space.alpha);
            space.active.project_again(g, taken, alpha, &mut space.scratch);
        });
        self.known.iter_mut().zip(&self.alpha).for_each(|(k, a)| *k += a);
        true
    }

    fn repair_step(&mut self, x: &mut [f64], e: &[f64]) {
        if self.rounds_levels() {
            self.step(|space| space.repair(x, e))
        } else {
            self.repair(x, e)
        }
    }

    fn project_step_transpose(&mut self, g: &mut [f64]) {
        self.step(|space| space.project_transpose(g));
    }

    fn loose(&self) -> &[LooseMode] {
        &self.loose
    }

    fn holds_without_springs(&mut self) -> bool {
        let weights = self.active.weights().filter(|_| !self.soft.is_empty());
        weights.is_none_or(|weights| {
            let unsprung = without(weights, &self.soft);
            // beside what springs leave free as well
            self.coarse.0.free_motions(Some(&unsprung)).len() == self.active.free_motions().len()
        })
    }

    fn balance(&mut self, x: &mut [f64], e: &[f64]) {
        self.active.project(x, Some(e), &mut self.scratch);
    }

    fn compensate(&mut self, from: &[f64], change: &[f64], to: &mut [f64]) {
        self.step(|space| space.always.compensate(from, change, to, &mut space.scratch));
    }

    fn repair(&mut self, x: &mut [f64], e: &[f64]) {
        self.always.project(x, Some(e), &mut self.scratch);
    }
}
