//! Rows along surfaces that depend on others, and what has to change for them to agree.

use crate::tolerances::NULL_RANK;
use nalgebra::DMatrix;
use signorini_tfeti::internal::Dependency;
use std::ops::Range;

/// A dependency with rows along surfaces.
#[derive(Debug)]
pub(super) struct Agreement {
    pub(super) rows: Vec<usize>,
    /// Its vectors, one a row.
    pub(super) null: DMatrix<f64>,
    /// Changes of the rows along surfaces, zero of others, by what the vectors find.
    pub(super) change: DMatrix<f64>,
}

impl Agreement {
    /// `None` where nothing that depends on others is along a surface.
    pub(super) fn new(along: &Range<usize>, dependency: &Dependency) -> Option<Self> {
        let (rows, vectors) = (dependency.rows.clone(), &dependency.vectors);
        let null = DMatrix::from_fn(vectors.len(), rows.len(), |i, k| vectors[i][k]);
        let own = |i, k| if along.contains(&rows[k]) { null[(i, k)] } else { 0.0 };
        let own = DMatrix::from_fn(null.nrows(), null.ncols(), own);
        let change = own.pseudo_inverse(NULL_RANK).ok()?;
        (change.amax() > 0.0).then_some(Self { rows, null, change })
    }
}
