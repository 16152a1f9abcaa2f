//! Quadrature on tetrahedra and triangles in barycentric coordinates. Weights sum up to one.

/// Degree 2 on the tetrahedron, four points of equal weight: what the stiffness of a quadratic tetrahedron takes.
pub(crate) const FOUR_POINTS: [[f64; 4]; 4] = {
    // (5 + 3 sqrt 5) / 20 and (5 - sqrt 5) / 20
    const A: f64 = 0.585_410_196_624_968_5;
    const B: f64 = 0.138_196_601_125_010_5;
    [[A, B, B, B], [B, A, B, B], [B, B, A, B], [B, B, B, A]]
};

/// Degree 5 on the tetrahedron, 15 points (Keast).
pub(crate) fn tetrahedron() -> Vec<([f64; 4], f64)> {
    let mut rule = vec![([0.25; 4], 16.0 / 135.0)];
    let root = 15f64.sqrt();
    for sign in [-1.0, 1.0] {
        let a = (7.0 + sign * root) / 34.0;
        let weight = (2665.0 - sign * 14.0 * root) / 37800.0;
        for i in 0..4 {
            let mut point = [a; 4];
            point[i] = 1.0 - 3.0 * a;
            rule.push((point, weight));
        }
    }
    let a = (10.0 - 2.0 * root) / 40.0;
    for i in 0..4 {
        for j in 0..i {
            let mut point = [a; 4];
            point[i] = 0.5 - a;
            point[j] = 0.5 - a;
            rule.push((point, 10.0 / 189.0));
        }
    }
    rule
}

/// Degree 5 on the triangle, 7 points (Radon).
pub fn triangle() -> Vec<([f64; 3], f64)> {
    let mut rule = vec![([1.0 / 3.0; 3], 9.0 / 40.0)];
    let root = 15f64.sqrt();
    for sign in [-1.0, 1.0] {
        let a = (6.0 + sign * root) / 21.0;
        let weight = (155.0 + sign * root) / 1200.0;
        for i in 0..3 {
            let mut point = [a; 3];
            point[i] = 1.0 - 2.0 * a;
            rule.push((point, weight));
        }
    }
    rule
}

/// The mean of points with the given weights: barycentric coordinates, or values of shape functions.
pub(crate) fn at<const N: usize>(nodes: &[[f64; 3]; N], weights: &[f64; N]) -> [f64; 3] {
    std::array::from_fn(|d| (0..N).map(|a| weights[a] * nodes[a][d]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factorial(n: u32) -> f64 {
        (1..=n).map(f64::from).product()
    }

    /// The mean of l0^a l1^b l2^c over a simplex of dimension d is a! b! c! d! / (a + b + c + d)!.
    fn mean(powers: [u32; 3], d: u32) -> f64 {
        let product: f64 = powers.iter().map(|&p| factorial(p)).product();
        product * factorial(d) / factorial(powers.iter().sum::<u32>() + d)
    }

    #[test]
    fn rules_are_exact_up_to_degree_five() {
        for powers in (0..216u32).map(|n| [n / 36, n / 6 % 6, n % 6]) {
            if powers.iter().sum::<u32>() > 5 {
                continue;
            }
            let monomial = |l: &[f64]| -> f64 { powers.iter().zip(l).map(|(&p, x)| x.powi(p as i32)).product() };
            let tet: f64 = tetrahedron().iter().map(|(l, w)| w * monomial(l)).sum();
            let tri: f64 = triangle().iter().map(|(l, w)| w * monomial(l)).sum();
            assert!((tet - mean(powers, 3)).abs() < 1e-15, "tetrahedron {powers:?}");
            assert!((tri - mean(powers, 2)).abs() < 1e-15, "triangle {powers:?}");
        }
    }
}
