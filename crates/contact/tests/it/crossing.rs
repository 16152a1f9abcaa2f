//! Contacts that cross: bodies side by side on one floor, where nodes of a joint are nodes of the floor, too.

use crate::common::*;

/// Two cubes side by side on a rough floor, of so many cells an edge, pressed down and together, to and fro.
fn side_by_side(cells: [usize; 2], friction: [f64; 2]) -> Scene {
    of_blocks(cells.map(|n| block([1.0; 3], [n; 3])), friction)
}

fn of_blocks([left, right]: [TetMesh; 2], friction: [f64; 2]) -> Scene {
    let right = right.map_points(|[x, y, z]| [x + 1.0, y, z]).expect("moved");
    let mesh = with_second(&left, &right);
    let swing = |by: f64| {
        let times = (0..=8).map(f64::from);
        History::table(times.map(|k| (k / 8.0, (by * k).sin())).collect()).expect("history")
    };
    let [joint, floor] = friction.map(|mu| match mu {
        0.0 => Friction::None,
        _ => Friction::coulomb(mu),
    });
    Scene::new(mesh, uniform(2.1e11, 0.3))
        .with_load(Load::pressure(brick::Z_MAX, 1e7).with_history(ramp()))
        .with_load(Load::pressure(second(brick::Z_MAX), 1e7).with_history(ramp()))
        .with_load(Load::traction(brick::X_MIN, [1e6, 3e5, 0.0]).with_history(swing(1.0)))
        .with_load(Load::traction(second(brick::X_MAX), [-8e5, 1e5, 0.0]).with_history(swing(1.7)))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(floor.clone()))
        .with_contact(Contact::rigid(second(brick::Z_MIN)).with_friction(floor))
        .with_contact(Contact::between(brick::X_MAX, second(brick::X_MIN)).with_friction(joint))
        .with_analysis(Analysis::quasistatic(1.0, 8))
}

/// Displacement at the upper corner of the joint, m, and the force through it, N.
fn at_joint(result: &Solved, scene: &Scene) -> ([f64; 3], f64) {
    let corner = [1.0, 1.0, 1.0];
    let found = scene.mesh().points().iter().position(|p| distance(p, &corner) < 1e-9);
    let u = result.displacement.as_chunks().0[found.expect("a corner")];
    let joint = result.points.iter().filter(|p| p.surface == 2);
    (u, joint.map(|p| p.normal_force).sum())
}

/// With conditions of both contacts at their common nodes a step took up to 24,000 products where meshes do not match.
#[test]
fn a_joint_on_a_rough_floor_costs_what_others_do() {
    for cells in [[4, 5], [6, 4], [5, 7]] {
        for friction in [[0.3, 0.3], [0.0, 0.3], [0.6, 0.6]] {
            let what = format!("{cells:?} {friction:?}");
            let (_, results) = run(side_by_side(cells, friction), Settings::default());
            for result in &results {
                assert_certified(result, &what);
                let products = result.report.counters.products;
                assert!(products <= 45, "{what}: {products}");
            }
        }
    }
}

/// The finer the meshes, the less they differ, whether they match or not.
#[test]
fn meshes_apart_tend_to_what_matching_ones_do() {
    let last = |cells: [usize; 2]| {
        let scene = side_by_side(cells, [0.3, 0.3]);
        let (_, mut results) = run(scene.clone(), Settings::default());
        at_joint(&results.swap_remove(6), &scene)
    };
    let (exact, force) = last([12, 12]);
    let mut before = f64::INFINITY;
    for (cells, within) in [([4, 5], 0.03), ([8, 9], 0.01)] {
        let (u, through) = last(cells);
        let off = distance(&u, &exact);
        assert!(off < within && off < before, "{cells:?}: {off:e}");
        assert!((through / force - 1.0).abs() < 0.1, "{cells:?}: {through:e} {force:e}");
        before = off;
    }
}

/// Squeezed by so much between ends that are held, the joint open by so much at its top.
fn squeezed(cells: [usize; 2], by: f64, open: f64, lift: f64) -> Scene {
    let [left, right] = cells.map(|n| block([1.0; 3], [n; 3]));
    let right = right.map_points(|[x, y, z]| [x + 1.0 + open * z * (1.0 - x), y, z]);
    let push = |tag, by| Support::fixed(tag).with_motion([by, 0.0, 0.0], ramp());
    let rough = |contact: Contact| contact.with_friction(Friction::coulomb(0.3));
    Scene::new(with_second(&left, &right.expect("moved")), uniform(2.1e11, 0.3))
        .with_support(push(brick::X_MIN, by))
        .with_support(push(second(brick::X_MAX), -by))
        .with_load(Load::pressure(brick::Z_MAX, -lift).with_history(ramp()))
        .with_load(Load::pressure(second(brick::Z_MAX), -lift).with_history(ramp()))
        .with_contact(rough(Contact::rigid(brick::Z_MIN)))
        .with_contact(rough(Contact::rigid(second(brick::Z_MIN))))
        .with_contact(rough(Contact::between(brick::X_MAX, second(brick::X_MIN))))
        .with_analysis(Analysis::quasistatic(1.0, 1))
}

/// A joint that is open but for its edge on the floor touches there: its force was lost.
#[test]
fn an_edge_that_alone_touches_keeps_its_conditions() {
    let force = |cells: [usize; 2]| {
        let scene = squeezed(cells, 1e-4, 1e-3, 0.0);
        at_joint(&solve(scene.clone(), Settings::default()), &scene).1
    };
    let (apart, matching) = (force([4, 5]), force([4, 4]));
    assert!(
        matching < -1e6 && (apart / matching - 1.0).abs() < 0.1,
        "{apart:e} {matching:e}"
    );
}

/// Where a joint opens from the floor on as it is loaded, its edge is inside the other side between meshes apart: told.
#[test]
fn an_overlap_where_conditions_were_handed_on_is_told() {
    let warned = |cells: [usize; 2]| {
        let scene = squeezed(cells, 1e-5, 0.0, 3e7);
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        let warnings = simulation.step().expect("step").warnings();
        warnings.into_iter().find(|w| matches!(w, Warning::EdgeOverlap { .. }))
    };
    let told = warned([4, 5]).expect("a warning");
    assert!(
        told.to_string()
            .contains("take smaller facets there, or meshes that match"),
        "{told}"
    );
    assert_eq!(warned([4, 4]), None);
}

/// The pressure of a joint goes on to where the floor has the nodes.
#[test]
fn pressure_goes_on_to_nodes_of_the_floor() {
    let [left, right] = [4, 5].map(|n| block([1.0; 3], [n; 3]));
    let right = right.map_points(|[x, y, z]| [x + 1.0, y, z]).expect("moved");
    let smooth = |contact: Contact| contact.with_friction(Friction::coulomb(1e-6));
    let scene = Scene::new(with_second(&left, &right), uniform(2.1e11, 0.0))
        .with_load(Load::pressure(brick::Z_MAX, 1e6))
        .with_load(Load::pressure(second(brick::Z_MAX), 1e6))
        .with_load(Load::pressure(brick::X_MIN, 1e7))
        .with_load(Load::pressure(second(brick::X_MAX), 1e7))
        .with_contact(smooth(Contact::rigid(brick::Z_MIN)))
        .with_contact(smooth(Contact::rigid(second(brick::Z_MIN))))
        .with_contact(smooth(Contact::between(brick::X_MAX, second(brick::X_MIN))));
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    let result = simulation.step().expect("step");
    let pressure = result.contact_pressure(2).expect("a surface");
    let areas = result.surfaces()[2].areas();
    assert!(pressure.iter().all(|p| (p / 1e7 - 1.0).abs() < 1e-4), "{pressure:?}");
    let force: f64 = pressure.iter().zip(areas).map(|(p, a)| p * a).sum();
    assert!((force / 1e7 - 1.0).abs() < 1e-4, "{force:e}");
    assert!(result.points().iter().filter(|p| p.surface == 2).count() < pressure.len());
}

/// Positions at which friction sticks came from rows that hold to the tolerance only: where they depend on one another
/// no displacement was in all of them, the estimate had a floor, and a step took 42,000 products.
#[test]
fn estimates_see_no_contradiction_between_contacts() {
    // in a narrow strip nothing is handed on
    let flat = || block([1.0, 1.0, 0.25], [4, 4, 1]);
    let scene = of_blocks([flat(), flat()], [0.6, 0.6]);
    for target in [1e-3, 1e-5] {
        let settings = Settings::default().with_accuracy(Accuracy::Relative(target));
        let mut simulation = Simulation::new(scene.clone(), settings).expect("set-up");
        for result in rest(&mut simulation) {
            let report = result.report.accuracy.expect("a report");
            assert!(result.report.status.converged() && report.reached, "{report:?}");
            let products = result.report.counters.products;
            println!("{target:e}: {products}");
            assert!(products <= 2000, "{target:e}: {products}");
        }
    }
}

/// Where all loads have gone a block lay where it was at first, and its slips were lost. A millionth of the loads moves
/// it by 7e-4 of its displacement, and by less when they return.
#[test]
fn without_loads_a_block_stays_where_it_slid() {
    let of = |least: f64| {
        let table = |rows: Vec<(f64, f64)>| History::table(rows).expect("history");
        let press = table(vec![(0.0, 0.0), (0.5, 1.0), (1.0, 1.0), (2.0, least), (3.0, 1.0)]);
        let push = table(vec![(0.0, 0.0), (0.5, 0.0), (1.0, 1.0), (2.0, least), (3.0, 1.0)]);
        let floor = Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3));
        let scene = Scene::new(block([1.0; 3], [3; 3]), uniform(2e11, 0.3))
            .with_load(Load::pressure(brick::Z_MAX, 1e8).with_history(press))
            .with_load(Load::traction(brick::Z_MAX, [1.8e7, 0.0, 0.0]).with_history(push))
            .with_contact(floor)
            .with_analysis(Analysis::quasistatic(3.0, 12));
        run(scene, Settings::default()).1
    };
    let (exact, nearly) = (of(0.0), of(1e-6));
    let off = distance(&exact[7].displacement, &nearly[7].displacement);
    assert!(exact[7].points.iter().all(|p| p.normal_force == 0.0));
    assert!(off < 2e-3, "{off:e}");
    for step in 8..12 {
        let off = distance(&exact[step].displacement, &nearly[step].displacement);
        assert!(off < 1e-3, "{step}: {off:e}");
    }
}

/// A plate on blocks apart, each in a contact of its own with the lower side of the plate: nodes of that side were
/// taken for those of a crossing, and which contact came first decided where the plate rests, and with how much.
#[test]
fn contacts_of_one_flat_side_do_not_cross() {
    let on_blocks = |order: [u32; 3]| {
        let mut mesh = block([1.2, 1.2, 0.08], [4, 4, 1]);
        for (k, [x, y]) in (1..).zip([[0.0, 0.0], [0.96, 0.0], [0.48, 0.96]]) {
            let own = Brick::new([0.24, 0.24, 0.15], [2, 2, 1]).with_origin([x, y, -0.15]);
            let own = own.build().expect("a block").map_tags(|t| FacetTag(t.0 + 10 * k));
            mesh = mesh.append(&own).expect("a plate on blocks");
        }
        let side = |tag: FacetTag, k: u32| FacetTag(tag.0 + 10 * k);
        let mut scene = Scene::new(mesh, uniform(2.1e11, 0.3))
            .with_load(Load::pressure(brick::Z_MAX, 5e5))
            .with_load(Load::force(brick::X_MAX, [3e4, 0.0, 0.0]));
        for k in order {
            let contact = Contact::between(brick::Z_MIN, side(brick::Z_MAX, k));
            scene = scene
                .with_support(Support::fixed(side(brick::Z_MIN, k)))
                .with_contact(contact.with_friction(Friction::coulomb(0.2)));
        }
        solve(scene, at(1e-9)).displacement
    };
    let reference = on_blocks([1, 2, 3]);
    for order in [[3, 2, 1], [2, 3, 1], [3, 1, 2]] {
        assert_close(&on_blocks(order), &reference, 1e-6, &format!("{order:?}"));
    }
}

/// One block is tied on the left half of a base, another one lies on its right half: it rests on the seam, too,
/// whichever side is named first.
#[test]
fn a_bond_leaves_what_touches_another_body() {
    let base = block([2.0, 1.0, 1.0], [2, 1, 1]);
    let (left, right) = (FacetTag(61), FacetTag(62));
    let facets: Vec<Facet> = base
        .facets()
        .iter()
        .map(|facet| {
            let middle = facet.nodes.iter().map(|n| base.points()[*n as usize][0]).sum::<f64>() / 3.0;
            let side = if middle < 1.0 { left } else { right };
            let tag = if facet.tag == brick::Z_MAX { side } else { facet.tag };
            Facet { tag, ..*facet }
        })
        .collect();
    let base = TetMesh::new(base.points().to_vec(), base.tets().to_vec(), facets).expect("base");
    let placed = |x: f64, tags: u32| {
        let cube = block([1.0; 3], [1; 3])
            .map_points(|[a, b, c]| [a + x, b, c + 1.0])
            .expect("cube");
        cube.map_tags(|tag| FacetTag(tag.0 + tags))
    };
    let mesh = base
        .append(&placed(0.0, 100))
        .and_then(|m| m.append(&placed(1.0, 200)))
        .expect("three");
    let third = |tag: FacetTag| FacetTag(tag.0 + 200);
    for swap in [false, true] {
        let [a, b] = if swap { [third(brick::Z_MIN), right] } else { [right, third(brick::Z_MIN)] };
        let scene = Scene::new(mesh.clone(), uniform(1e9, 0.0))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_support(Support::components(third(brick::Y_MIN), [false, true, false]))
            .with_support(Support::components(third(brick::X_MAX), [true, false, false]))
            .with_contact(Contact::tied(left, second(brick::Z_MIN)))
            .with_contact(Contact::between(a, b))
            .with_load(Load::force(third(brick::Z_MAX), [0.0, 0.0, -1.0]));
        let found = solve(scene, Settings::default());
        assert_eq!(found.summary.active, 4, "{swap}");
        assert!((found.summary.normal_force - 1.0).abs() < 1e-6);
    }
}
