//! Arithmetic of short vectors, summed in order: the same bits wherever it is asked.

/// Scalar product.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Cosine of the angle between triangles that share an edge, of their nodes and their area vectors.
pub(crate) fn edge_cosine([p, q]: [&[u32; 3]; 2], [v, w]: [[f64; 3]; 2]) -> Option<f64> {
    let shared = p.iter().filter(|n| q.contains(n)).count();
    (shared == 2).then(|| dot(&v, &w) / (norm(&v) * norm(&w)))
}

/// Length.
pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
