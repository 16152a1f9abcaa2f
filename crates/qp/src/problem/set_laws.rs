//! Laws of products of free components, bounds and discs: projection, parts of the gradient, feasible step.

use super::{BlockState, ProductSet, Segment};
use crate::vector;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Rounding, relative to the vectors; wider where a point next to a circle counts as on it.
const LAW: f64 = 1e-10;
const ON_CIRCLE: f64 = 1e-6;

/// Components of all kinds, degenerate ones among them; `scale` is the size of typical points.
fn segment(scale: f64) -> impl Strategy<Value = Segment> {
    let list = |from: f64, to: f64| prop::collection::vec(from * scale..to * scale, 0..7);
    let width = prop_oneof![1 => Just(0.0), 3 => 0.0..0.5 * scale];
    let radius = prop_oneof![1 => Just(0.0), 3 => (-3.5..0.5_f64).prop_map(move |e| 10f64.powf(e) * scale)];
    prop_oneof![
        (0_usize..7).prop_map(Segment::Free),
        list(-0.8, 0.2).prop_map(Segment::lower),
        list(-0.2, 0.8).prop_map(Segment::upper),
        prop::collection::vec((-scale..scale, width), 0..7).prop_map(|ends| {
            let (lower, upper) = ends.into_iter().map(|(low, width)| (low, low + width)).unzip();
            Segment::bounds(lower, upper)
        }),
        prop::collection::vec(radius, 0..7).prop_map(Segment::discs),
    ]
}

/// A set, two points anywhere, a gradient and a step length.
fn case() -> impl Strategy<Value = (ProductSet, [Vec<f64>; 2], Vec<f64>, f64)> {
    let set = (-9_i32..9).prop_flat_map(|decade| {
        let scale = 10f64.powi(decade);
        let set = prop::collection::vec(segment(scale), 2..6);
        (set.prop_map(|all| ProductSet::new(all).expect("valid")), Just(scale))
    });
    (set, prop::bool::ANY, 0.1..0.9_f64).prop_flat_map(|((set, scale), is_wide, step)| {
        let wide = if is_wide { 10.0 * scale } else { scale };
        let vector = |size: f64| prop::collection::vec(-size..size, set.dim());
        let points = [vector(wide), vector(wide)];
        (points, vector(scale)).prop_map(move |(points, g)| (set.clone(), points, g, step))
    })
}

fn projected(set: &ProductSet, x: &[f64]) -> Vec<f64> {
    let mut p = x.to_vec();
    set.project(&mut p);
    p
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 2000,
        rng_seed: RngSeed::Fixed(11),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn projections_are_the_nearest_points((set, [u, w], ..) in case()) {
        let size = (vector::norm(&u) + vector::norm(&w)).max(f64::MIN_POSITIVE);
        let (x, y) = (projected(&set, &u), projected(&set, &w));
        prop_assert_eq!(&projected(&set, &x), &x);
        prop_assert!(set.violation(&x) <= 1e-15 * size);
        prop_assert!((vector::distance(&u, &x) - set.violation(&u)).abs() <= LAW * size);
        // it does not expand
        prop_assert!(vector::distance(&x, &y) - vector::distance(&u, &w) <= LAW * size);
        let cone: f64 = (0..x.len()).map(|i| (u[i] - x[i]) * (y[i] - x[i])).sum();
        prop_assert!(cone <= LAW * size * size);
    }

    #[test]
    fn gradients_fall_apart((set, [u, w], g, step) in case()) {
        let (x, y) = (projected(&set, &u), projected(&set, &w));
        let (n, size) = (x.len(), (vector::norm(&u) + vector::norm(&w)).max(f64::MIN_POSITIVE));
        let (mut free, mut chopped) = (vec![f64::NAN; n], vec![f64::NAN; n]);
        let norms = set.split(&x, &g, step, &mut free);
        set.chopped(&x, &g, &mut chopped);
        let gg = vector::dot(&g, &g).max(f64::MIN_POSITIVE);
        prop_assert!((0..n).all(|i| free[i] * chopped[i] == 0.0));
        prop_assert!((norms.free - vector::dot(&free, &free)).abs() <= LAW * gg);
        prop_assert!((norms.chopped - vector::dot(&chopped, &chopped)).abs() <= LAW * gg);
        // Moreau: g = projected gradient + normal part, orthogonal; the normal part is in minus the normal cone
        let tangent: Vec<f64> = free.iter().zip(&chopped).map(|(a, b)| a + b).collect();
        let normal: Vec<f64> = g.iter().zip(&tangent).map(|(a, b)| a - b).collect();
        prop_assert!(vector::dot(&normal, &tangent).abs() <= LAW * gg);
        let outward: f64 = (0..n).map(|i| -normal[i] * (y[i] - x[i])).sum();
        prop_assert!(outward <= ON_CIRCLE * gg.sqrt() * size);
        // the reduced gradient is (x - P(x - a g)) / a, and no longer
        let target: Vec<f64> = (0..n).map(|i| x[i] - step * g[i]).collect();
        let expected = vector::distance(&x, &projected(&set, &target)) / step;
        let reduced = (norms.reduced_free + norms.reduced_chopped).sqrt();
        prop_assert!((reduced - expected).abs() <= 1e-8 * gg.sqrt());
        prop_assert!(reduced - norms.projected() <= ON_CIRCLE * gg.sqrt());
        prop_assert!(norms.reduced_free - norms.reduced_free_dot <= 1e-12 * gg);
    }

    /// The feasible step along the free gradient stays inside, cannot be longer, and ends on the boundary.
    #[test]
    fn feasible_steps_end_on_the_boundary((set, [u, _], g, step) in case()) {
        let x = projected(&set, &u);
        let mut free = vec![f64::NAN; x.len()];
        set.split(&x, &g, step, &mut free);
        let t = set.feasible_step(&x, &free);
        if t.is_finite() && t > 0.0 {
            let (mut on, mut beyond, mut part) = (x.clone(), x.clone(), free.clone());
            set.advance(&mut on, &free, t);
            prop_assert!(set.violation(&on) <= 1e-15 * vector::norm(&u));
            vector::axpy(-t * (1.0 + 1e-6), &free, &mut beyond);
            prop_assert!(set.violation(&beyond) > 0.0);
            set.split(&on, &g, step, &mut part);
            prop_assert!((0..x.len()).any(|i| free[i] != 0.0 && part[i] == 0.0 && g[i] != 0.0));
        }
    }

    #[test]
    fn a_step_to_the_circle_is_seen_as_active(
        x in -1.0..1.0f64, y in -1.0..1.0f64, p in -1.0..1.0f64, q in -1.0..1.0f64, e in -12_i32..12,
    ) {
        let s = 10f64.powi(e);
        let set = ProductSet::new(vec![Segment::discs(vec![1.5 * s])]).expect("valid");
        let mut z = [s * x, s * y];
        let p = [p, q];
        prop_assume!(p[0].abs() + p[1].abs() > 1e-3);
        let t = set.feasible_step(&z, &p);
        set.advance(&mut z, &p, t);
        let mut state = BlockState::Free;
        set.for_each_block(&z, &mut |b| state = b.state);
        prop_assert_eq!(state, BlockState::Boundary);
        prop_assert!(z[0].hypot(z[1]) <= 1.5 * s);
    }

    #[test]
    fn a_bound_that_stops_a_step_is_met_exactly(l in -1.0..0.0f64, x in 0.0..1.0f64, p in 1e-6..10.0f64) {
        let set = ProductSet::new(vec![Segment::lower(vec![l])]).expect("valid");
        let mut z = [x];
        let t = set.feasible_step(&z, &[p]);
        set.advance(&mut z, &[p], t);
        prop_assert_eq!(z[0], l);
    }
}
