//! Products of bodies meshed apart: planes of symmetry, thin cells and stiff bodies cost none of their own.

use crate::common::*;
use crate::mortar::{POISSON, PRESSURE, YOUNG, blocks};

/// Planes of symmetry that cut both bodies cost nothing, though the coarser side has a finer edge there: with a row for
/// how the other side bends along the plane the blocks took 360 products.
#[test]
fn planes_of_symmetry_cost_no_products() {
    let partial = |tag, axis: usize| Support::partial(tag, Directions::Components([0, 1, 2].map(|c| c == axis)));
    let products = |tied: bool, symmetric: bool| {
        let contact = if tied {
            Contact::tied(second(brick::Z_MIN), brick::Z_MAX)
        } else {
            Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(Friction::coulomb(0.3))
        };
        let mut scene = Scene::new(blocks([6, 6, 4], [4, 8, 4], 1.0), uniform(YOUNG, POISSON))
            .with_contact(contact)
            .with_support(Support::fixed(brick::Z_MIN))
            .with_load(Load::traction(
                second(brick::Z_MAX),
                [0.1 * PRESSURE, 0.05 * PRESSURE, -PRESSURE],
            ))
            .with_boxes([2, 2, 2]);
        for axis in if symmetric { 0..2 } else { 0..0 } {
            let tag = [brick::X_MIN, brick::Y_MIN][axis];
            scene = scene
                .with_support(partial(tag, axis))
                .with_support(partial(second(tag), axis));
        }
        let (_, results) = run(scene, at(1e-6));
        results[0].report.counters.products
    };
    for tied in [true, false] {
        let [free, symmetric] = [false, true].map(|s| products(tied, s));
        println!("tied {tied}: {free} products, with planes of symmetry {symmetric}");
        assert!(10 * symmetric <= 13 * free, "{tied}: {free}, {symmetric}");
    }
}

/// A pad between plates of as many cells that reach beyond it: had the plates the points, several of them would press
/// the rim of the pad alone, in 12,765 products, and it would not be held.
#[test]
fn a_soft_pad_between_plates_that_reach_beyond_costs_few_products() {
    let plate = |z: f64| {
        let plate = Brick::new([2.2, 1.9, 0.5], [7, 6, 1])
            .with_origin([-0.2, -0.3, z])
            .build()
            .expect("plate");
        plate
            .map_points(|[x, y, z]| [x + 0.04 * (5.0 * y).sin(), y + 0.03 * (7.0 * x).sin(), z])
            .expect("plate")
    };
    let pad = Brick::new([1.5, 1.2, 0.4], [5, 4, 2])
        .with_origin([0.0, 0.0, 0.5])
        .build()
        .expect("pad");
    let (under, over) = (
        |tag: FacetTag| FacetTag(tag.0 + 200),
        |tag: FacetTag| FacetTag(tag.0 + 100),
    );
    let mesh = pad.append(&plate(0.0).map_tags(under)).expect("plate");
    let mesh = mesh.append(&plate(0.9).map_tags(over)).expect("plates");
    let regions = mesh.components().iter().map(|body| u32::from(*body > 0)).collect();
    let rubber = Hooke::isotropic(6e6, 0.45).expect("rubber");
    let steel = Hooke::isotropic(2.1e11, 0.3).expect("steel");
    let rough = Friction::coulomb(0.5);
    let scene = Scene::new(
        mesh.with_regions(regions).expect("regions"),
        Materials::new(vec![(0, rubber), (1, steel)]).expect("materials"),
    )
    .with_support(Support::fixed(under(brick::Z_MIN)))
    .with_support(Support::fixed(over(brick::Z_MAX)).with_motion([0.01, 0.0, -0.02], ramp()))
    .with_contact(Contact::between(brick::Z_MIN, under(brick::Z_MAX)).with_friction(rough.clone()))
    .with_contact(Contact::between(brick::Z_MAX, over(brick::Z_MIN)).with_friction(rough));
    let (_, results) = run(scene, Settings::default());
    let products = results[0].report.counters.products;
    println!("{products} products");
    assert!(products <= 130, "{products} products");
}

/// Quadratic cells between planes that hold them: no point has a row across, whatever share of its mean the planes
/// hold, so that products grow like the root of length over thickness. With rows of half of the points they grew like
/// that ratio, to the iteration limit.
#[test]
fn thin_quadratic_cells_between_planes_cost_few_products() {
    let solved = |thick: f64, tied: bool| {
        let mesh = blocks([6, 1, 4], [4, 1, 4], 1.0).map_points(|[x, y, z]| [x, thick * y, z]);
        let mesh = mesh.expect("mapped").raise_order().expect("order 2");
        let contact = if tied {
            Contact::tied(second(brick::Z_MIN), brick::Z_MAX)
        } else {
            Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(Friction::coulomb(0.3))
        };
        let mut scene = Scene::new(mesh, uniform(YOUNG, POISSON))
            .with_contact(contact)
            .with_support(Support::fixed(brick::Z_MIN))
            .with_load(Load::traction(second(brick::Z_MAX), [0.1 * PRESSURE, 0.0, -PRESSURE]))
            .with_subdomains(2);
        for tag in [brick::Y_MIN, brick::Y_MAX] {
            for tag in [tag, second(tag)] {
                scene = scene.with_support(Support::components(tag, [false, true, false]));
            }
        }
        let (simulation, results) = run(scene, at(1e-6));
        let ranges = simulation.tfeti().gluing().ranges();
        let (plan, points) = (simulation.plan(), 2 * 5);
        if tied {
            assert_eq!([ranges.tied.len(), plan.tied_rows], [2 * points; 2]);
        } else {
            assert_eq!((ranges.normal.len(), ranges.tangential().len()), (points, points));
            assert_eq!([plan.normal_rows, plan.tangential_rows], [points; 2]);
        }
        results[0].report.counters.products
    };
    for tied in [true, false] {
        let [thick, thin] = [0.5, 0.01].map(|t| solved(t, tied));
        println!("tied {tied}: {thick} products, {thin} where cells are fifty times thinner");
        assert!(thin <= 6 * thick, "{tied}: {thick}, {thin}");
    }
}

/// A stiff body takes no more products with more cells than the soft one it stands on, in as many boxes, than where
/// meshes match. With lumped blocks as they are it took 35 instead of 26.
#[test]
fn a_stiff_body_with_more_cells_costs_no_products() {
    let products = |lower: usize, upper: usize, stiffer: f64| {
        let mesh = blocks([lower; 3], [upper; 3], 1.0);
        let bodies = mesh.components();
        let hooke = |young: f64| Hooke::isotropic(young, POISSON).expect("a law");
        let materials = Materials::new(vec![(0, hooke(YOUNG)), (1, hooke(YOUNG * stiffer))]);
        let mesh = mesh.with_regions(bodies).expect("regions");
        let contact = Contact::between(second(brick::Z_MIN), brick::Z_MAX);
        let scene = Scene::new(mesh, materials.expect("materials"))
            .with_contact(contact.with_friction(Friction::coulomb(0.2)))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_load(Load::traction(second(brick::Z_MAX), [1e5, 0.0, -1e6]))
            .with_boxes([2, 2, 4]);
        run(scene, Settings::default()).1[0].report.counters.products
    };
    for (lower, upper, stiffer) in [(8, 12, 1e3), (12, 8, 1e-3)] {
        let (pair, matching) = (products(lower, upper, stiffer), products(12, 12, stiffer));
        assert!(5 * pair <= 6 * matching, "{lower} {upper}: {pair}, {matching}");
    }
}

/// Two quadratic leaves of a spring, clamped together at one end: twice as stiff as one, by few products, whichever way
/// they point. In lengths of one cell it took 349 products.
#[test]
fn leaves_of_a_spring_cost_few_products() {
    let [length, width, thickness] = [1.0, 0.1, 0.02];
    let leaf = block([length, width, thickness], [20, 2, 1]);
    let both = with_second(&leaf, &lifted(&leaf, thickness));
    let both = both.raise_order().expect("order 2");
    let end = both.points().iter().rposition(|p| p[0] == length).expect("an end");
    let (sin, cos) = 0.7_f64.sin_cos();
    let oblique = |[x, y, z]: [f64; 3]| {
        let [x, y] = [cos * x - sin * y, sin * x + cos * y];
        [x, 0.8 * y - 0.6 * z, 0.6 * y + 0.8 * z]
    };
    for turned in [false, true] {
        let turn = |p| if turned { oblique(p) } else { p };
        let both = both.map_points(turn).expect("turned");
        let down = turn([0.0, 0.0, -1.0]);
        let scene = Scene::new(both, uniform(1e9, 0.0))
            .with_support(Support::fixed(brick::X_MIN))
            .with_support(Support::fixed(second(brick::X_MIN)))
            .with_contact(Contact::between(brick::Z_MAX, second(brick::Z_MIN)))
            .with_load(Load::force(second(brick::X_MAX), down));
        let (_, results) = run(scene, Settings::default());
        let moved: f64 = (0..3).map(|c| results[0].displacement[3 * end + c] * down[c]).sum();
        let second_moment = 2.0 * width * thickness.powi(3) / 12.0;
        let expected = length.powi(3) / (3.0 * 1e9 * second_moment);
        let products = results[0].report.counters.products;
        println!("turned {turned}: {products} products, {moved} of {expected}");
        assert!((moved - expected).abs() < 1e-3 * expected, "{moved}, {expected}");
        assert!(products <= if turned { 170 } else { 80 }, "{products}");
    }
}
