//! Quadratic facets on edges: a gap that opens linearly from the rim of a side is felt where it is.

use crate::common::*;

/// What comes down by 0.08 with its upper side: forces on the floor, and by how much nodes are inside it and are told
/// to be.
fn come_down(mesh: TetMesh, steps: usize) -> (Vec<f64>, f64, Option<(f64, f64)>) {
    let down = Support::fixed(brick::Z_MAX).with_motion([0.0, 0.0, -0.08], ramp());
    let scene = Scene::new(mesh, steel())
        .with_support(down)
        .with_contact(Contact::half_space(brick::Z_MIN, [0.0; 3], [0.0, 0.0, 1.0]))
        .with_analysis(Analysis::quasistatic(1.0, steps));
    let (simulation, results) = run(scene, Settings::default());
    let last = simulation.result().expect("a step");
    let places = simulation.scene().mesh().points().iter();
    let heights = last.displacement().into_iter().zip(places).map(|(u, x)| u[2] + x[2]);
    let deepest = -heights.fold(f64::INFINITY, f64::min);
    let narrow = last.warnings().into_iter().find_map(|warning| match warning.plain() {
        Warning::NarrowContact { overlap, way, .. } => Some((*overlap, *way)),
        _ => None,
    });
    let force = |result: &Solved| result.points.iter().map(|p| -p.normal_force).sum();
    let forces: Vec<f64> = results.iter().map(force).collect();
    println!("{forces:?}, {deepest:.3e} inside, {narrow:?}");
    (forces, deepest, narrow)
}

/// A block 12 by 6 by 3 whose lower side is `height` over the floor.
fn raised(cells: [usize; 3], order: usize, height: impl Fn([f64; 3]) -> f64) -> TetMesh {
    let block = block([12.0, 6.0, 3.0], cells).map_points(|x| [x[0], x[1], x[2] + height(x)]);
    match order {
        2 => block.expect("raised").raise_order().expect("quadratic"),
        _ => block.expect("raised"),
    }
}

/// A block whose lower side is inclined comes down on its edge. Quadratic facets feel the floor at once, where the gap
/// that they see is that of the edge: forces grow with the way from the start, as far as only the edge is pressed, and
/// come down to those of fine meshes.
#[test]
fn quadratic_facets_feel_an_edge_at_once() {
    let forces = |n: usize, order: usize| {
        let mesh = raised([4 * n, 2 * n, n], order, |x| 0.0894 * x[0]);
        let (forces, deepest, narrow) = come_down(mesh, 4);
        assert!(narrow.is_none() && deepest < 1e-3, "{narrow:?}, {deepest:e}");
        (0..4).for_each(|k| {
            let part = forces[k] / forces[3] * 4.0 / (k + 1) as f64;
            assert!((part - 1.0).abs() < 1e-3, "step {k}: {part}");
        });
        forces[3]
    };
    let [coarse, fine] = [1, 2].map(|n| forces(n, 2));
    let linear = forces(2, 1);
    // a line load sinks in by the logarithm of its width: finer meshes by about a fourth
    assert!(fine < coarse && coarse < 1.6 * fine, "{coarse}, {fine}");
    assert!(fine < linear && linear < 1.6 * fine, "{linear}, {fine}");
}

/// The same between two blocks, of matching and of other meshes, whichever is named first.
#[test]
fn quadratic_facets_of_two_bodies_feel_an_edge_at_once() {
    let first = |under: ([f64; 2], [usize; 2]), swapped: bool| {
        let ([x, y], cells) = under;
        let upper = raised([4, 2, 1], 2, |x| 0.0894 * x[0]);
        let lower = block([12.0 - 2.0 * x, 6.0 - 2.0 * y, 3.0], [cells[0], cells[1], 1]);
        let lower = lower.map_points(|p| [p[0] + x, p[1] + y, p[2] - 3.0]).expect("below");
        let lower = lower
            .raise_order()
            .expect("quadratic")
            .map_tags(|t| FacetTag(t.0 + 100));
        let below = |tag: FacetTag| FacetTag(tag.0 + 100);
        let contact = if swapped {
            Contact::between(below(brick::Z_MAX), brick::Z_MIN)
        } else {
            Contact::between(brick::Z_MIN, below(brick::Z_MAX))
        };
        let scene = Scene::new(upper.append(&lower).expect("both"), steel())
            .with_support(Support::fixed(brick::Z_MAX).with_motion([0.0, 0.0, -0.08], ramp()))
            .with_support(Support::fixed(below(brick::Z_MIN)))
            .with_contact(contact)
            .with_analysis(Analysis::quasistatic(1.0, 4));
        let results = run(scene, Settings::default()).1;
        let force = |k: usize| results[k].points.iter().map(|p| p.normal_force.abs()).sum::<f64>();
        let part = 4.0 * force(0) / force(3);
        println!("{under:?}, {swapped}: {part}");
        assert!((part - 1.0).abs() < 1e-3, "{part}");
        force(0)
    };
    let matching = first(([0.0; 2], [4, 2]), false);
    let other = first(([-1.0; 2], [5, 3]), false);
    assert!(matching > 1e3 && (other / first(([-1.0; 2], [5, 3]), true) - 1.0).abs() < 1e-6);
}

/// Dual functions pass uniform pressure on, too: a block that is hardly inclined is pressed flat.
#[test]
fn an_inclined_side_that_lies_flat_is_pressed_evenly() {
    let slope = 2e-3;
    let mesh = raised([4, 2, 2], 2, |x| slope * x[0] * (1.0 - x[2] / 3.0));
    let scene = Scene::new(mesh, uniform(1.0, 0.0))
        .with_support(Support::components(brick::Z_MAX, [true, true, false]))
        .with_load(Load::pressure(brick::Z_MAX, 0.1))
        .with_contact(Contact::half_space(brick::Z_MIN, [0.0; 3], [0.0, 0.0, 1.0]))
        .with_analysis(Analysis::quasistatic(1.0, 1));
    let result = solve(scene, at(1e-9));
    // the load is 25 times what closes the gap in the mean
    for point in &result.points {
        let pressure = -point.normal_force / point.area;
        assert!((pressure / 0.1 - 1.0).abs() < 0.05, "{pressure}");
    }
}

/// A flat ridge is no rim: facets on both sides of it feel the floor late, and say so, with an overlap near the one
/// there is: that of the ridge but for what the block gives way. Linear ones do not.
#[test]
fn quadratic_facets_tell_that_a_ridge_is_inside() {
    let ridge = |slope: f64| move |x: [f64; 3]| slope * (x[0] - 6.0).abs();
    assert_eq!(come_down(raised([8, 4, 2], 1, ridge(0.0894)), 1).2, None);
    assert_eq!(come_down(raised([8, 4, 2], 2, ridge(0.0)), 1).2, None);
    let (_, deepest, narrow) = come_down(raised([8, 4, 2], 2, ridge(0.0894)), 1);
    let (overlap, way) = narrow.expect("told");
    assert!((0.5..2.0).contains(&(overlap / deepest)), "{overlap:e}, {deepest:e}");
    assert!(overlap > 0.1 * way && way <= 0.09);
}
