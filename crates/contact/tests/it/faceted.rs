//! Straight facets that stand for a curve: overlaps that they make press nothing, and those that are meant press.

use crate::common::*;

/// A quarter of a ring, in meshes of order 2 with mid-nodes on the circle where it is bent.
fn arc(radii: [f64; 2], cells: usize, order: usize, bent: bool) -> TetMesh {
    let place = |[x, y, z]: [f64; 3]| {
        let (radius, angle) = (radii[0] + x * (radii[1] - radii[0]), 0.5 * std::f64::consts::PI * y);
        [radius * angle.cos(), radius * angle.sin(), z]
    };
    let raised = |mesh: TetMesh| {
        if order == 2 { mesh.raise_order().expect("order 2") } else { mesh }
    };
    let straight = block([1.0; 3], [1, cells, 1]);
    if bent {
        raised(straight).map_points(place).expect("arc")
    } else {
        raised(straight.map_points(place).expect("arc"))
    }
}

/// A ring pressed on a shaft by 0.02 m: facets of the shaft are as far within its circle, which is told of straight
/// quadratic ones. Not where the gap is told, where mid-nodes are on the circle, where facets are small against the
/// overlap, and where they match; linear ones are measured to the circle.
#[test]
fn overlaps_of_facets_are_no_interference() {
    let plan = |cells: [usize; 2], order, bent, overlap: f64, told: bool| {
        let rings = [([4.0, 10.0], 0), ([if told { 10.0 } else { 10.0 - overlap }, 14.0], 1)];
        let [shaft, sleeve] = rings.map(|(radii, k)| arc(radii, cells[k], order, bent));
        let fit = Contact::between(brick::X_MAX, second(brick::X_MIN));
        let scene = Scene::new(with_second(&shaft, &sleeve), uniform(1e3, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_support(Support::fixed(second(brick::X_MAX)))
            .with_contact(if told { fit.with_gap(-overlap) } else { fit });
        Plan::new(&scene, &Settings::default())
            .expect("plan")
            .warnings()
            .to_vec()
    };
    let warnings = plan([12, 20], 2, false, 0.02, false);
    let [
        warning @ Warning::FacetedOverlap {
            contact: 0,
            overlap,
            sagitta,
            ..
        },
    ] = &warnings[..]
    else {
        panic!("{warnings:?}");
    };
    // at the rim normals are those of one facet, and differ half as much
    let expected = 10.0 * (1.0 - (std::f64::consts::PI / 48.0).cos());
    assert!(
        (0.49..1.01).contains(&(sagitta / expected)) && *overlap > 0.0,
        "{warning}"
    );
    assert!(warning.to_string().contains("with_gap, 0"), "{warning}");
    assert_eq!(plan([12, 20], 1, false, 0.02, false), []);
    for order in [1, 2] {
        assert_eq!(plan([12, 20], order, false, 0.02, true), []);
        assert_eq!(plan([12, 12], order, false, 0.02, false), []);
        // so much is told for itself
        let deep = plan([12, 20], order, false, 0.4, false);
        assert!(matches!(deep[..], [Warning::LargeOverlap { .. }]), "{deep:?}");
    }
    assert_eq!(plan([12, 20], 2, true, 0.02, false), []);
}

/// Force between a shaft of this radius and a sleeve of radius 10 that are held, and warnings, as `with` changes the
/// contact.
fn pressed(radius: f64, meshes: [TetMesh; 2], with: impl Fn(Contact) -> Contact) -> (f64, Vec<Warning>) {
    let [shaft, sleeve] = meshes;
    let shaft = shaft
        .map_points(|[x, y, z]| [0.1 * radius * x, 0.1 * radius * y, z])
        .expect("radius");
    let fit = Contact::between(brick::X_MAX, second(brick::X_MIN)).with_friction(Friction::coulomb(0.3));
    let scene = Scene::new(with_second(&shaft, &sleeve), uniform(1e3, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_support(Support::fixed(second(brick::X_MAX)))
        .with_contact(with(fit));
    let mut simulation = Simulation::new(scene, Settings::default()).expect("simulation");
    let force = simulation.step().expect("step").summary().normal_force;
    (force, simulation.plan().warnings().to_vec())
}

/// A shaft in a sleeve of its own radius, or of one a little smaller: overlaps of straight hollow facets press nothing,
/// unless they are meant. A fit of half a sagitta presses.
#[test]
fn facets_of_a_hollow_side_do_not_press() {
    let touching = |w: &Warning| matches!(w, Warning::ClosedOverlaps { contacts: 1, .. });
    for (order, radius, closes) in [(2, 10.0, true), (2, 10.002, true), (2, 10.011, false)] {
        let meshes = || [arc([4.0, 10.0], 20, order, false), arc([10.0, 14.0], 12, order, false)];
        let (force, warnings) = pressed(radius, meshes(), |fit| fit);
        assert_eq!(force < 1e-9, closes, "{order} {radius}: {force}");
        let found = warnings.iter().find(|w| touching(w)).map(Warning::to_string);
        assert_eq!(
            found.is_some_and(|w| w.contains("because straight facets")),
            closes,
            "{warnings:?}"
        );
        let grown = |fit: Contact| fit.with_gap_history(History::ramp(1.0, 1.0).expect("ramp"));
        for (force, warnings) in [
            pressed(radius, meshes(), Contact::with_measured_overlaps),
            pressed(radius, meshes(), grown),
        ] {
            assert!(force > 1.0 && !warnings.iter().any(touching), "{force} {warnings:?}");
            assert!(
                warnings.iter().any(|w| matches!(w, Warning::FacetedOverlap { .. })),
                "{warnings:?}"
            );
        }
    }
}

/// The same between linear meshes, measured to the circle: radii that are the same touch, and interference presses as
/// if it was told, by the mesh of either side.
#[test]
fn linear_facets_press_as_their_circle_does() {
    for cells in [[20, 12], [12, 20], [30, 31]] {
        let meshes = || {
            [
                arc([4.0, 10.0], cells[0], 1, false),
                arc([10.0, 14.0], cells[1], 1, false),
            ]
        };
        for with in [|fit| fit, Contact::with_measured_overlaps] {
            let (force, _) = pressed(10.0, meshes(), with);
            let (unit, _) = pressed(10.01, meshes(), |fit| fit.with_gap(-0.01));
            assert!(force < 1e-2 * unit, "{cells:?}: {force}, {unit}");
        }
        for over in [0.002, 0.01, 0.05] {
            for with in [|fit| fit, Contact::with_measured_overlaps] {
                let (force, warnings) = pressed(10.0 + over, meshes(), with);
                let (told, _) = pressed(10.0 + over, meshes(), |fit| fit.with_gap(-over));
                println!("{cells:?}, {over}: {force} of {told}");
                assert!((force / told - 1.0).abs() < 0.05, "{cells:?}, {over}: {force}, {told}");
                assert_eq!(warnings, []);
            }
        }
    }
}

/// So do uneven ones: cells in turn one and two long.
#[test]
fn uneven_linear_facets_press_as_their_circle_does() {
    let uneven = |radii: [f64; 2], cells: usize| {
        let place = |[x, y, z]: [f64; 3]| {
            let cell = (y * cells as f64).round();
            let angle = (cell - if cell % 2.0 == 0.0 { 0.0 } else { 1.0 / 3.0 }) / cells as f64;
            let (radius, angle) = (radii[0] + x * (radii[1] - radii[0]), 0.5 * std::f64::consts::PI * angle);
            [radius * angle.cos(), radius * angle.sin(), z]
        };
        block([1.0; 3], [1, cells, 1]).map_points(place).expect("arc")
    };
    for cells in [[12, 20], [20, 12]] {
        let meshes = || [uneven([4.0, 10.0], cells[0]), uneven([10.0, 14.0], cells[1])];
        let (told, _) = pressed(10.01, meshes(), |fit| fit.with_gap(-0.01));
        let [touching, over] = [10.0, 10.01].map(|radius| pressed(radius, meshes(), |fit| fit).0);
        println!("{cells:?}: {touching}, {over} of {told}");
        assert!(touching < 0.02 * told, "{cells:?}: {touching}, {told}");
        assert!((over / told - 1.0).abs() < 0.1, "{cells:?}: {over}, {told}");
    }
}

/// A cell of 36 degrees among short ones may be that of a prism: where a shaft ends inside its facets it pressed four
/// times as much as an interference of 0.01 m, and no warning told.
#[test]
fn a_long_cell_among_short_ones_presses_nothing() {
    let along = |y: f64| 0.75 * y + 1.25 * (y - 0.4).clamp(0.0, 0.2);
    let sleeve = block([1.0; 3], [1, 5, 4]).map_points(|[x, y, z]| {
        let (radius, angle) = (10.0 + 4.0 * x, 0.5 * std::f64::consts::PI * along(y));
        [radius * angle.cos(), radius * angle.sin(), 2.0 * z - 1.2]
    });
    let meshes = || [arc([4.0, 10.0], 20, 1, false), sleeve.clone().expect("arc")];
    let (force, warnings) = pressed(10.0, meshes(), |fit| fit);
    let (told, _) = pressed(10.01, meshes(), |fit| fit.with_gap(-0.01));
    assert!(force < 1e-2 * told, "{force}, {told} {warnings:?}");
}

/// A land of one cell between two chamfers is no arc: it lies on a plate of other cells without a force.
#[test]
fn a_land_between_chamfers_is_flat() {
    for slope in [0.1_f64, 0.36, 0.55] {
        let chamfered = |[x, y, z]: [f64; 3]| [x, y, z + slope * ((x - 1.5).abs() - 0.5).max(0.0) * (1.0 - z)];
        let upper = block([3.0, 1.0, 1.0], [3, 2, 2])
            .map_points(chamfered)
            .expect("chamfered");
        let lower = block([3.0, 1.0, 1.0], [8, 3, 2])
            .map_points(|[x, y, z]| [x, y, z - 1.0])
            .expect("plate");
        let scene = Scene::new(with_second(&upper, &lower), uniform(1e3, 0.3))
            .with_support(Support::fixed(brick::Z_MAX))
            .with_support(Support::fixed(second(brick::Z_MIN)))
            .with_contact(Contact::between(brick::Z_MIN, second(brick::Z_MAX)));
        let force = solve(scene, at(1e-8)).summary.normal_force;
        assert!(force < 1e-9, "{slope}: {force}");
    }
}

/// A pin in a bore that is a little wider (Persson, 1964): half of it touches, and pressure is smooth, where facets of
/// both sides are as far from their circles as the sides are apart. With the gap told it is the same.
#[test]
fn a_pin_presses_its_bore_as_circles_do() {
    let mesh = |radii: [f64; 2], cells: usize| {
        let place = |[x, y, z]: [f64; 3]| {
            let (radius, angle) = (radii[0] + x * (radii[1] - radii[0]), std::f64::consts::PI * (y - 0.5));
            [radius * angle.sin(), -radius * angle.cos(), z]
        };
        block([1.0; 3], [4, cells, 1]).map_points(place).expect("half a ring")
    };
    let press = |cells: [usize; 2], told: bool| {
        let [pin, bore] = [mesh([2.0, 10.0], cells[0]), mesh([10.02, 30.0], cells[1])];
        let contact = Contact::between(brick::X_MAX, second(brick::X_MIN));
        let scene = Scene::new(with_second(&pin, &bore), uniform(200.0, 0.3))
            .with_support(Support::fixed(second(brick::X_MAX)))
            .with_support(Support::fixed(brick::X_MIN).with_motion([0.0, -0.05, 0.0], ramp()))
            .with_contact(if told { contact.with_gap(0.02) } else { contact });
        let result = solve(scene, at(1e-8));
        let area: f64 = result
            .points
            .iter()
            .filter(|p| p.normal_force < 0.0)
            .map(|p| p.area)
            .sum();
        let pressure = result
            .points
            .iter()
            .map(|p| -p.normal_force / p.area)
            .fold(0.0, f64::max);
        (area, pressure)
    };
    for cells in [[20, 24], [24, 20], [40, 47]] {
        let [(area, pressure), (expected, smooth)] = [false, true].map(|told| press(cells, told));
        println!("{cells:?}: {area} of {expected}, {pressure} of {smooth}");
        // a row of nodes at each end
        assert!((area / expected - 1.0).abs() < 0.15, "{cells:?}: {area}, {expected}");
        assert!(
            (pressure / smooth - 1.0).abs() < 0.05,
            "{cells:?}: {pressure}, {smooth}"
        );
    }
}

/// Half a pin in half a bore, cut into patches with a contact each, or one for each two of them, as CAD cuts a circle:
/// forces are those of one contact, whatever faces what across a seam, and friction is that of the patch.
#[test]
fn a_curve_in_patches_presses_as_one() {
    let mesh = |radii: [f64; 2], (cells, order): (usize, usize), outer: f64, patches: usize| {
        let place = |[x, y, z]: [f64; 3]| {
            let (radius, angle) = (radii[0] + x * (radii[1] - radii[0]), std::f64::consts::PI * (y - 0.5));
            [radius * angle.sin(), -radius * angle.cos(), z]
        };
        let tag = |[_, y, _]: [f64; 3], [normal, ..]: [f64; 3]| match outer * normal {
            n if n > 0.5 => Some(FacetTag(10 + (patches as f64 * y) as u32)),
            n if n < -0.5 => Some(brick::X_MIN),
            _ => None,
        };
        let straight = block([1.0; 3], [4, cells, 1]).tag_boundary(tag);
        let straight = match order {
            2 => straight.raise_order().expect("order 2"),
            _ => straight,
        };
        straight.map_points(place).expect("half a ring")
    };
    let press = |cells: [usize; 2], order, patches: [usize; 2], rough: bool, fit: bool| {
        let pin = mesh([2.0, 10.0], (cells[0], order), 1.0, patches[0]);
        let bore = mesh([10.02, 30.0], (cells[1], order), -1.0, patches[1]);
        let law = |k: usize| if rough && 2 * k < patches[0] { Friction::coulomb(0.3) } else { Friction::None };
        let scene = Scene::new(with_second(&pin, &bore), uniform(200.0, 0.3))
            .with_support(Support::fixed(second(brick::X_MIN)))
            .with_support(Support::fixed(brick::X_MIN).with_motion([0.0, -0.05, 0.0], ramp()));
        let tag = |k: usize| FacetTag(10 + k as u32);
        let pairs = (0..patches[0]).flat_map(|k| (0..patches[1]).map(move |j| [k, j]));
        let met = pairs.filter(|[k, j]| patches[0] != patches[1] || k == j);
        let contact = |[k, j]: [usize; 2]| {
            let contact = Contact::between(tag(k), second(tag(j))).with_friction(law(k));
            if fit { contact.with_gap(-0.02).with_gap_history(ramp()) } else { contact }
        };
        let scene = met.fold(scene, |scene, pair| scene.with_contact(contact(pair)));
        let places = scene.mesh().points().to_vec();
        let result = solve(scene, at(1e-9));
        let place = |node: u32| places[node as usize][0];
        let sheared = result.points.iter().filter(|p| norm(&p.friction_force) > 0.0);
        let sheared: Vec<f64> = sheared.map(|p| place(p.node)).collect();
        let mut forces: Vec<(u32, f64)> = result.points.iter().map(|p| (p.node, p.normal_force)).collect();
        forces.sort_by_key(|force| force.0);
        (forces, sheared)
    };
    for (cells, order, fit) in [
        ([20, 24], 1, false),
        ([24, 20], 1, false),
        ([24, 20], 1, true),
        ([23, 36], 1, false),
        ([12, 16], 2, false),
    ] {
        let (expected, _) = press(cells, order, [1, 1], false, fit);
        let most = expected.iter().map(|force| force.1.abs()).fold(0.0, f64::max);
        for patches in [[2, 2], [4, 4], [1, 2], [3, 2]] {
            let (forces, _) = press(cells, order, patches, false, fit);
            assert_eq!(forces.len(), expected.len());
            for (own, one) in forces.iter().zip(&expected) {
                let off = (own.1 - one.1).abs() / most;
                assert!(own.0 == one.0 && off < 1e-6, "{cells:?} {patches:?}: {own:?} {one:?}");
            }
        }
    }
    let (_, sheared) = press([20, 24], 1, [2, 2], true, false);
    assert!(!sheared.is_empty() && sheared.iter().all(|x| *x < 1e-9), "{sheared:?}");
}

/// Two flats of an octagon, of few cells each, are no curve: their interference presses.
#[test]
fn flats_that_meet_in_a_kink_press() {
    let flat = |mesh: TetMesh| {
        let place = |[x, y, z]: [f64; 3]| {
            let eighth = 0.25 * std::f64::consts::PI;
            let stretch = 1.0 / (y.atan2(x).rem_euclid(eighth) - 0.5 * eighth).cos();
            [stretch * x, stretch * y, z]
        };
        mesh.map_points(place).expect("octagon")
    };
    for cells in [[4, 6], [6, 4]] {
        let meshes = [([4.0, 10.0], 0), ([10.0, 14.0], 1)].map(|(radii, k)| flat(arc(radii, cells[k], 1, false)));
        let (force, warnings) = pressed(10.02, meshes.clone(), |fit| fit);
        let (expected, _) = pressed(10.02, meshes, |fit| fit.with_gap(-0.02));
        assert!(
            (force / expected - 1.0).abs() < 0.1,
            "{cells:?}: {force} {expected} {warnings:?}"
        );
    }
}

/// Half a ring of straight quadratic elements around a rigid shaft of its radius, upon which nothing acts: mid-nodes
/// lie within the shaft and pressed, without a warning, three times as hard as a fit of a thousandth of the radius. The
/// shaft may turn, or move and press.
#[test]
fn straight_quadratic_elements_around_an_obstacle_press_nothing() {
    let pressed = |radius: f64, bent: bool, with: &dyn Fn(Contact) -> Contact| {
        let straight = Brick::new([std::f64::consts::PI, 0.2, 0.3], [16, 2, 2])
            .build()
            .expect("brick");
        let raised = |mesh: TetMesh| mesh.raise_order().expect("order 2");
        let place = |[a, r, z]: [f64; 3]| [-(0.8 + r) * a.cos(), (0.8 + r) * a.sin(), z];
        let ring = if bent {
            raised(straight).map_points(place).expect("ring")
        } else {
            raised(straight.map_points(place).expect("ring"))
        };
        let shaft = Obstacle::cylinder([0.0; 3], [0.0, 0.0, 1.0], radius);
        let contact = Contact::obstacle(brick::Y_MIN, shaft).with_friction(Friction::coulomb(0.3));
        let scene = Scene::new(ring, uniform(1e9, 0.3))
            .with_support(Support::components(brick::Z_MIN, [false, false, true]))
            .with_support(Support::components(brick::X_MIN, [false, true, false]))
            .with_support(Support::components(brick::X_MAX, [false, true, false]))
            .with_contact(with(contact))
            .with_analysis(Analysis::quasistatic(1.0, 2));
        let (simulation, results) = run(scene, Settings::default());
        (results[1].summary.normal_force, simulation.plan().warnings().to_vec())
    };
    let closed = |warnings: &[Warning]| warnings.iter().any(|w| matches!(w, Warning::ClosedOverlaps { .. }));
    let as_it_is = |contact: Contact| contact;
    let ramp = |value: f64| History::ramp(1.0, value).expect("ramp");
    let moved = |contact: Contact| contact.with_motion([0.0, 1e-3, 0.0], ramp(1.0));
    let turned = |contact: Contact| moved(contact).with_rotation([0.0; 3], [0.0, 0.0, 1.0], ramp(0.1));
    let (meant, told) = pressed(0.8, false, &Contact::with_measured_overlaps);
    assert!(meant > 5e5 && !closed(&told), "{meant} {told:?}");
    let (force, told) = pressed(0.8, false, &as_it_is);
    assert!(force < 1e-6 * meant && closed(&told), "{force} {told:?}");
    // what presses does so as with mid-nodes on the circle
    for with in [&moved as &dyn Fn(Contact) -> Contact, &turned] {
        let (force, told) = pressed(0.8, false, with);
        let (expected, curved) = pressed(0.8, true, with);
        println!("{meant:e} {force:e} {expected:e}");
        assert!(closed(&told) && !closed(&curved), "{told:?} {curved:?}");
        assert!((force / expected - 1.0).abs() < 0.1, "{force} {expected}");
    }
    // a fit as deep as facets are beside the circle is told
    let (_, told) = pressed(0.81, false, &as_it_is);
    let told_of = told.iter().find(|w| matches!(w, Warning::FacetedOverlap { .. }));
    assert!(told_of.is_some(), "{told:?}");
}

/// A quarter bore of few straight quadratic elements around a rigid shaft of its radius: nothing presses where its tag
/// is cut in two, each with a contact of its own, nor where another contact of the tag is further away, at rest or
/// with motions of no length.
#[test]
fn overlaps_of_facets_do_not_depend_on_how_contacts_are_written() {
    const UPPER: FacetTag = FacetTag(50);
    let force = |cut: Option<usize>, away: bool, moves: bool| {
        let bore = Brick::new([1.0; 3], [2, 4, 2]).build().expect("brick");
        let upper = |x: [f64; 3], n: [f64; 3]| cut.is_some_and(|c| n[0] < -0.9 && x[c] > 0.5).then_some(UPPER);
        let sides = |x: [f64; 3], n: [f64; 3]| {
            let of = |k: usize| match n[k] {
                low if low < -0.9 => Some([brick::X_MIN, brick::Y_MIN, brick::Z_MIN][k]),
                high if high > 0.9 => Some([brick::X_MAX, brick::Y_MAX, brick::Z_MAX][k]),
                _ => None,
            };
            upper(x, n).or_else(|| (0..3).find_map(of))
        };
        let place = |[r, a, z]: [f64; 3]| {
            let angle = a * (0.4 + 0.6 * a) * std::f64::consts::FRAC_PI_2;
            [(1.0 + r) * angle.cos(), (1.0 + r) * angle.sin(), z]
        };
        let bore = bore.tag_boundary(sides).map_points(place).expect("bore");
        let contact = |tag: FacetTag, radius: f64| {
            let contact = Contact::obstacle(tag, Obstacle::cylinder([0.0; 3], [0.0, 0.0, 1.0], radius));
            if moves {
                contact.with_motion([0.0; 3], History::ramp(1.0, 1.0).expect("ramp"))
            } else {
                contact
            }
        };
        let mut scene = Scene::new(bore.raise_order().expect("order 2"), uniform(2e11, 0.3))
            .with_support(Support::components(brick::Y_MIN, [false, true, false]))
            .with_support(Support::components(brick::Y_MAX, [true, false, false]))
            .with_support(Support::components(brick::Z_MIN, [false, false, true]))
            .with_analysis(Analysis::quasistatic(1.0, 1));
        if away {
            scene = scene.with_contact(contact(brick::X_MIN, 0.9));
        }
        scene = scene.with_contact(contact(brick::X_MIN, 1.0));
        if cut.is_some() {
            scene = scene.with_contact(contact(UPPER, 1.0));
        }
        let (_, results) = run(scene, Settings::default());
        results[0].summary.normal_force
    };
    for moves in [false, true] {
        for (cut, away) in [(None, false), (None, true), (Some(1), false), (Some(2), false)] {
            let force = force(cut, away, moves);
            assert!(force < 1.0, "{cut:?} {away} {moves}: {force:e}");
        }
    }
}

/// A quarter of a sleeve on a post, pressed evenly and pushed along the axis. On a cylinder of plane facets only friction
/// holds it; where nodes are shifted along the circle, facets are tilted and hold it, which is told.
#[test]
fn what_tilted_facets_hold_is_told() {
    let solve = |shift: f64, order: usize, coefficient: f64| {
        let part = |radii: [f64; 2], cells: [usize; 3]| {
            let place = |[r, a, z]: [f64; 3]| {
                let layer = (z * cells[2] as f64).round() as i64;
                let inside = (a * (1.0 - a)).min(0.05) * 20.0;
                let angle = 0.5 * std::f64::consts::PI * (a + inside * shift * if layer % 2 == 0 { 1.0 } else { -1.0 });
                let radius = radii[0] + r * (radii[1] - radii[0]);
                [radius * angle.cos(), radius * angle.sin(), 8.0 * z]
            };
            let straight = block([1.0; 3], cells);
            let mesh = straight.map_points(place).expect("quarter");
            if order == 2 { mesh.raise_order().expect("order 2") } else { mesh }
        };
        let (post, sleeve) = (part([4.0, 10.0], [2, 9, 4]), part([10.0, 13.0], [1, 8, 4]));
        let touch = Contact::between(brick::X_MAX, second(brick::X_MIN)).with_closed_gaps(0.1);
        let touch = match coefficient {
            0.0 => touch,
            _ => touch.with_friction(Friction::coulomb(coefficient)),
        };
        let scene = Scene::new(with_second(&post, &sleeve), uniform(2e5, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_support(Support::components(second(brick::Y_MIN), [false, true, false]))
            .with_support(Support::components(second(brick::Y_MAX), [true, false, false]))
            .with_load(Load::pressure(second(brick::X_MAX), 10.0))
            .with_load(Load::force(second(brick::Z_MAX), [0.0, 0.0, 20.0]))
            .with_contact(touch);
        let mut simulation = Simulation::new(scene, Settings::default())?;
        Ok::<_, ContactError>(simulation.step()?.warnings())
    };
    let told = |warnings: &[Warning]| {
        let share = |w: &Warning| match w {
            Warning::HeldByTilt { share, .. } => Some(*share),
            _ => None,
        };
        warnings.iter().find_map(share)
    };
    for order in [1, 2] {
        let refused = solve(0.0, order, 0.0);
        assert!(
            matches!(refused, Err(ContactError::NotHeld { .. })),
            "{order} {refused:?}"
        );
        let frictionless = told(&solve(0.02, order, 0.0).expect("held"));
        assert!(
            frictionless.is_some_and(|share| (share - 1.0).abs() < 1e-3),
            "{frictionless:?}"
        );
        let rough = solve(0.02, order, 0.3).expect("held");
        assert_eq!(told(&rough), None, "{rough:?}");
    }
    // where all friction is spent the rest alone decides
    for (coefficient, expected) in [(0.014, true), (0.02, false)] {
        let share = told(&solve(0.02, 1, coefficient).expect("held"));
        assert_eq!(share.is_some_and(|share| share < 0.15), expected, "{share:?}");
    }
}
