//! Cuts triangles with linear values into bands of one colour.

use super::colour::Scale;

/// The polygons of a triangle in each band it reaches: (band, polygon).
pub(super) fn bands(
    corners: [[f64; 2]; 3],
    values: [f64; 3],
    scale: &Scale,
) -> Vec<(usize, Vec<[f64; 2]>)> {
    let mut out = Vec::new();
    let values = values.map(|v| {
        if v.is_finite() {
            v.clamp(0.0, scale.max)
        } else {
            0.0
        }
    });
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, 0.0), |(l, h): (f64, f64), &v| {
            (l.min(v), h.max(v))
        });
    let band = |v: f64| ((v / scale.max * scale.bands as f64) as usize).min(scale.bands - 1);
    for k in band(low)..=band(high) {
        let triangle: Vec<_> = corners.into_iter().zip(values).collect();
        let upper = if k + 1 == scale.bands {
            f64::INFINITY
        } else {
            scale.level(k + 1)
        };
        let above = clip(&triangle, |v| v - scale.level(k));
        let inside = clip(&above, |v| upper - v);
        if inside.len() > 2 {
            out.push((k, inside.into_iter().map(|(p, _)| p).collect()));
        }
    }
    out
}

/// The part of a polygon with values where `keep` is not negative.
fn clip(polygon: &[([f64; 2], f64)], keep: impl Fn(f64) -> f64) -> Vec<([f64; 2], f64)> {
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for (i, &(p, v)) in polygon.iter().enumerate() {
        let (q, w) = polygon[(i + 1) % polygon.len()];
        let (a, b) = (keep(v), keep(w));
        if a >= 0.0 {
            out.push((p, v));
        }
        if (a < 0.0) != (b < 0.0) && a != 0.0 && b != 0.0 {
            let t = a / (a - b);
            let between = [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])];
            out.push((between, v + t * (w - v)));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(p: &[[f64; 2]]) -> f64 {
        let cross = |i: usize| {
            let (a, b) = (p[i], p[(i + 1) % p.len()]);
            a[0] * b[1] - a[1] * b[0]
        };
        (0..p.len()).map(cross).sum::<f64>() / 2.0
    }

    #[test]
    fn the_bands_fill_the_triangle() {
        let scale = Scale { max: 1.0, bands: 7 };
        let corners = [[0.0, 0.0], [4.0, 1.0], [1.0, 3.0]];
        for values in [
            [0.0, 1.0, 0.35],
            [0.2, 0.2, 0.2],
            [0.0, 0.0, 0.0],
            [1.0, 1.0, 0.5],
            [2.0 / 7.0; 3],
        ] {
            let parts = bands(corners, values, &scale);
            let sum: f64 = parts.iter().map(|(_, p)| area(p)).sum();
            assert!((sum - area(&corners)).abs() < 1e-12, "{values:?}: {sum}");
        }
        assert_eq!(bands(corners, [f64::NAN, 0.0, 0.0], &scale).len(), 1);
    }
}
