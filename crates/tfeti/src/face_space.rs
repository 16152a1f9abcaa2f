//! The coarse space as the face method of `signorini-qp` sees it.

use crate::coarse::{Coarse, CoarseScratch};
use crate::coarse_factor::{CoarseFactor, Factor};
use crate::contact_fronts::ContactWeights;
use crate::error::TfetiError;
use crate::row_weights::{LineWeight, RowWeights};
use crate::split_factor::{Fronts, SplitBase, SplitFactor};
use crate::split_solve::Digits;
use signorini_qp::internal::LooseMode;
use signorini_qp::{EqualityProjector, QpError};
use std::sync::Arc;

/// How `G W G^T` is factored when the face changes.
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
}

/// `G x = e` with projectors weighted by the free rows of the current face, see [`EqualityProjector`].
///
/// Repairs use the interface and support rows only, so they never touch a contact row. Motions of bodies that these rows do
/// not stop are [loose](EqualityProjector::loose).
#[derive(Debug)]
pub struct ActiveSetProjector {
    coarse: Coarse,
    /// Factor with the weights of always free rows.
    always: CoarseFactor,
    /// What these do not hold.
    loose: Vec<LooseMode>,
    face: CoarseFactor,
    weights: Vec<f64>,
    /// Directions of the last face besides its weights.
    lines: Vec<LineWeight>,
    contact_rows: usize,
    split: Option<Arc<SplitBase>>,
    /// Memory of the last but one factor.
    spare: Option<SplitFactor>,
    fronts: Fronts,
    contact: ContactWeights,
    /// Weight of each row where it is free; `None` means 1.
    metric: Option<Vec<f64>>,
    rhs: Vec<f64>,
    alpha: Vec<f64>,
    scratch: CoarseScratch,
    /// What the steps of an iteration read.
    digits: Digits,
}

/// Largest relative error in the equality of a solve with a factor in single precision with which steps are projected.
const ROUNDED: f64 = 1e-4;

/// Work on a free motion above this fraction of the norm of `e` makes a face deficient.
const WORK: f64 = 1e-9;

impl ActiveSetProjector {
    /// For the coarse space of a system; `contact_rows` is the number of leading rows with constraints.
    ///
    /// `metric` gives free rows another weight than 1, see [`Tfeti::row_weights`](crate::Tfeti::row_weights).
    ///
    /// # Errors
    /// [`TfetiError::Setting`] if there are fewer contact rows or a weight is not usable, [`TfetiError::Length`] if
    /// `metric` is not as long as dual vectors, others if a factorisation fails.
    pub fn new(
        coarse: &Coarse,
        contact_rows: usize,
        metric: Option<Vec<f64>>,
    ) -> Result<Self, TfetiError> {
        Self::with_factor(coarse, contact_rows, metric, ActiveSetFactor::Auto)
    }

    /// The same with a given kind of factor.
    ///
    /// # Errors
    /// [`TfetiError::Setting`] if there are fewer contact rows or a weight is not usable, [`TfetiError::Length`] if
    /// `metric` is not as long as dual vectors, others if a factorisation fails.
    pub fn with_factor(
        coarse: &Coarse,
        contact_rows: usize,
        metric: Option<Vec<f64>>,
        kind: ActiveSetFactor,
    ) -> Result<Self, TfetiError> {
        let most = coarse.0.gluing.ranges().contact().end;
        if contact_rows > most {
            return Err(TfetiError::Setting {
                name: "contact rows of a face space",
                value: contact_rows as f64,
                range: "at most the contact rows of the system",
            });
        }
        if let Some(metric) = &metric {
            RowWeights::diagonal(metric.clone()).validate(coarse.0.gluing.ranges())?;
        }
        let mut weights = vec![1.0; coarse.dim()];
        weights[..contact_rows].fill(0.0);
        let split = match kind {
            ActiveSetFactor::Sparse => None,
            ActiveSetFactor::Split => coarse.split(contact_rows, metric.as_deref()),
            ActiveSetFactor::Auto => coarse
                .split(contact_rows, metric.as_deref())
                .filter(|split| split.pays(coarse.rows(), coarse.factor_size())),
        };
        let split = split.map(Arc::new);
        let row_weights = RowWeights::diagonal(weighted(&weights, metric.as_deref()));
        let (mut fronts, mut contact) = (Fronts::default(), ContactWeights::default());
        let (own, rows) = (split.as_ref(), contact_rows);
        let work = (&mut fronts, &mut contact);
        let factor = factor(coarse, own, row_weights, rows, None, work.0, work.1)?;
        let mut scratch = factor.scratch();
        let loose: Vec<_> = factor
            .free_motions()
            .iter()
            .map(|motion| coarse.loose_mode(&motion.amplitudes, contact_rows))
            .collect();
        // weights that are added to those that hold every body leave the matrix better conditioned
        let single =
            loose.is_empty() && factor.has_short() && factor.single_error(&mut scratch) <= ROUNDED;
        Ok(Self {
            digits: if single {
                Digits::Single
            } else {
                Digits::Double
            },
            scratch,
            coarse: coarse.clone(),
            always: factor.clone(),
            loose,
            face: factor,
            weights,
            lines: Vec::new(),
            contact_rows,
            split,
            spare: None,
            fronts,
            contact,
            metric,
            rhs: vec![0.0; coarse.rows()],
            alpha: vec![0.0; coarse.rows()],
        })
    }

    /// The factor of the last face.
    #[must_use]
    pub fn factor(&self) -> &CoarseFactor {
        &self.face
    }

    /// Projects the steps of iterations in double precision even where single precision is good enough.
    #[must_use]
    pub fn exact_steps(mut self) -> Self {
        self.digits = Digits::Double;
        self
    }

    /// Tells the right side `e` of the next problem: rigid motions that no free row stops are harmless as long as `e` does
    /// no work on them.
    ///
    /// # Panics
    /// If `e` does not have one entry for each row of `G`.
    pub fn set_rhs(&mut self, e: &[f64]) {
        self.rhs.copy_from_slice(e);
    }

    /// Amplitudes of the rigid motions, `-(G W G^T)^-1 G W r`, with the weights of the last face.
    pub fn amplitudes(&mut self, residual: &[f64], alpha: &mut [f64]) {
        self.face.amplitudes(residual, alpha, &mut self.scratch);
    }

    fn deficiency(&self, factor: &CoarseFactor) -> Option<String> {
        let size = self.rhs.iter().map(|v| v * v).sum::<f64>().sqrt();
        factor.free_motions().iter().find_map(|motion| {
            let work: f64 = motion
                .amplitudes
                .iter()
                .zip(&self.rhs)
                .map(|(a, e)| a * e)
                .sum();
            let length = motion.amplitudes.iter().map(|v| v * v).sum::<f64>().sqrt();
            (work.abs() > WORK * size * length).then(|| motion.to_string())
        })
    }
}

/// The factor for `weights` on the basis of `split`; of the whole matrix if there is no such basis, if free motions ask for
/// a generalised inverse, or if the matrix is singular to working precision.
fn factor(
    coarse: &Coarse,
    split: Option<&Arc<SplitBase>>,
    weights: RowWeights,
    contact_rows: usize,
    spare: Option<SplitFactor>,
    fronts: &mut Fronts,
    contact: &mut ContactWeights,
) -> Result<CoarseFactor, TfetiError> {
    weights.validate(coarse.0.gluing.ranges())?;
    let usable = |base: &&Arc<SplitBase>| {
        base.allows(&weights.lines) && coarse.0.free_motions(Some(&weights)).is_empty()
    };
    if let Some(base) = split.filter(usable) {
        contact.set(&weights.diagonal[..contact_rows], &weights.lines);
        if let Ok(factor) = base.factor(contact, spare, fronts) {
            let factor = Factor::Split(base.clone(), factor);
            return Ok(CoarseFactor::new(
                coarse.clone(),
                factor,
                Some(weights),
                Vec::new(),
            ));
        }
    }
    coarse.factor_weighted(weights)
}

fn weighted(free: &[f64], metric: Option<&[f64]>) -> Vec<f64> {
    match metric {
        Some(metric) => free.iter().zip(metric).map(|(w, m)| w * m).collect(),
        None => free.to_vec(),
    }
}

fn deficient(error: TfetiError) -> QpError {
    QpError::CoarseDeficient {
        motion: error.to_string(),
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
        self.set_weights_and_lines(w, &[])
    }

    fn set_weights_and_lines(&mut self, w: &[f64], lines: &[LineWeight]) -> Result<bool, QpError> {
        if w == self.weights && lines == self.lines {
            return match self.deficiency(&self.face) {
                Some(motion) => Err(QpError::CoarseDeficient { motion }),
                None => Ok(false),
            };
        }
        let (expected, found) = (self.coarse.dim(), w.len());
        if found != expected {
            return Err(QpError::Length {
                what: "the weights of a face",
                found,
                expected,
            });
        }
        let mut weights = RowWeights::diagonal(weighted(w, self.metric.as_deref()));
        let metric = |row: usize| {
            let metric = self.metric.as_ref();
            metric.and_then(|m| m.get(row)).copied().unwrap_or(1.0)
        };
        weights.lines.extend(lines.iter().map(|line| LineWeight {
            row: line.row,
            direction: line.direction,
            weight: line.weight * metric(line.row),
        }));
        let fixed = w[self.contact_rows..].iter().all(|w| *w == 1.0);
        let split = self.split.as_ref().filter(|_| fixed);
        let spare = self.spare.take();
        let (rows, fronts, contact) = (self.contact_rows, &mut self.fronts, &mut self.contact);
        let base = &self.coarse;
        let factor =
            factor(base, split, weights, rows, spare, fronts, contact).map_err(deficient)?;
        if let Some(motion) = self.deficiency(&factor) {
            return Err(QpError::CoarseDeficient { motion });
        }
        self.weights.copy_from_slice(w);
        self.lines.clear();
        self.lines.extend_from_slice(lines);
        self.spare = std::mem::replace(&mut self.face, factor).into_split();
        Ok(true)
    }

    fn balances(&mut self, x: &[f64], e: &[f64]) -> bool {
        if self.face.free_motions().is_empty() {
            return true;
        }
        self.coarse.apply(x, &mut self.alpha, &mut self.scratch);
        let norm = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let size = norm(e).max(norm(x));
        let off = |a: &[f64]| -> f64 {
            let both = self.alpha.iter().zip(e);
            a.iter().zip(both).map(|(a, (g, e))| a * (g - e)).sum()
        };
        let motions = self.face.free_motions().iter();
        motions
            .map(|m| (off(&m.amplitudes), norm(&m.amplitudes)))
            .all(|(work, length)| work.abs() <= WORK * size * length)
    }

    fn project(&mut self, x: &mut [f64]) {
        self.face.project(x, None, &mut self.scratch);
    }

    fn project_transpose(&mut self, g: &mut [f64]) {
        self.face
            .project_transpose(g, &mut self.alpha, &mut self.scratch);
    }

    fn rounds_steps(&self) -> bool {
        self.digits == Digits::Single
    }

    fn project_step(&mut self, x: &mut [f64]) {
        self.face
            .project_to(self.digits, x, None, &mut self.scratch);
    }

    fn project_step_transpose(&mut self, g: &mut [f64]) {
        self.face
            .project_transpose_to(self.digits, g, &mut self.alpha, &mut self.scratch);
    }

    fn loose(&self) -> &[LooseMode] {
        &self.loose
    }

    fn balance(&mut self, x: &mut [f64], e: &[f64]) {
        self.face.project(x, Some(e), &mut self.scratch);
    }

    fn compensate(&mut self, from: &[f64], change: &[f64], to: &mut [f64]) {
        self.always
            .compensate_to(self.digits, from, change, to, &mut self.scratch);
    }

    fn repair(&mut self, x: &mut [f64], e: &[f64]) {
        self.always.project(x, Some(e), &mut self.scratch);
    }
}
