//! Arithmetic of short vectors, summed in order: the same bits wherever it is asked.

/// Scalar product.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Length.
pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
