//! Thin bodies that are not to bend as such: slices between planes, most of whose nodes supports hold in one direction,
//! and rods.

use crate::common::*;

/// A slice of some layers, slid over a floor. Where the planes are moved, even by next to nothing, no springs of the
/// set-up stand for what they hold.
fn slid(layers: usize, order: usize, planes_move: bool) -> Scene {
    let slice = Brick::new([12.0, 0.5, 3.0], [24, layers, 6]).perturbed(0.12, 7);
    let slice = slice.build().expect("slice");
    let slice = if order == 2 { slice.raise_order().expect("order 2") } else { slice };
    let plane = |tag| {
        let plane = Support::components(tag, [false, true, false]);
        if planes_move {
            plane.with_motion([0.0, 1e-200, 0.0], History::constant(1.0))
        } else {
            plane
        }
    };
    let pressed = Load::traction(brick::Z_MAX, [1e6, 0.0, -5e6]);
    let floor = Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3));
    Scene::new(slice, uniform(2.1e11, 0.3))
        .with_support(plane(brick::Y_MIN))
        .with_support(plane(brick::Y_MAX))
        .with_support(Support::components(brick::X_MIN, [true, false, false]))
        .with_load(pressed)
        .with_contact(floor)
        .with_analysis(Analysis::quasistatic(1.0, 2))
}

#[test]
fn a_slice_is_no_plate_that_bends() {
    for (layers, order, parts) in [(2, 1, 6), (3, 1, 6), (2, 2, 12)] {
        let found = [false, true].map(|planes_move| {
            let scene = slid(layers, order, planes_move).with_subdomains(parts);
            let (simulation, results) = run(scene, Settings::default());
            (simulation.counters().products, results[1].displacement.clone())
        });
        let [(held, u), (free, other)] = &found;
        println!("{layers} {order}: {held} {free}");
        assert_close(u, other, 1e-5, "the same solution");
        assert!(
            2 * held <= *free,
            "{layers} layers, order {order}: {held} products, {free}"
        );
    }
}

/// A strap on a floor, pulled at its end: a mesh so small that other bodies stay in one piece.
#[test]
fn a_rod_is_cut_in_lengths() {
    let scene = || {
        let strap = Brick::new([69.0, 2.0, 2.0], [69, 2, 2]).build().expect("strap");
        let floor = Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3));
        Scene::new(strap, uniform(2.1e5, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::pressure(brick::Z_MAX, 1.0))
            .with_load(Load::traction(brick::X_MAX, [1.0, 0.3, 0.0]))
            .with_contact(floor)
    };
    let found = [scene(), scene().without_subdomains()].map(|scene| {
        let (simulation, results) = run(scene, Settings::default());
        (simulation.counters().products, results[0].displacement.clone())
    });
    let [(cut, u), (whole, other)] = &found;
    println!("{cut} {whole}");
    assert_close(u, other, 1e-5, "the same solution");
    assert!(5 * cut <= 2 * whole, "{cut} products, {whole}");
}
