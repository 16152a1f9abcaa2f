//! Contact between bodies whose meshes do not match.

use crate::common::*;

pub(crate) const PRESSURE: f64 = 2.5e7;
pub(crate) const YOUNG: f64 = 2e9;
pub(crate) const POISSON: f64 = 0.3;

/// Two blocks of unit size in units of length `unit`, one on the other, of so many cells each; tags of the upper one
/// are those of the [`second`] body.
pub(crate) fn blocks(lower: [usize; 3], upper: [usize; 3], unit: f64) -> TetMesh {
    let below = block([unit; 3], lower);
    let above = block([unit; 3], upper)
        .map_points(|[x, y, z]| [x, y, z + unit])
        .expect("lifted");
    with_second(&below, &above)
}

/// Supports along x, y at the planes of symmetry of both, along z below; pressure on top.
fn pressed_blocks(mesh: TetMesh, unit: f64) -> Scene {
    let axis = |c: usize| [c == 0, c == 1, c == 2];
    let sides = [
        (brick::X_MIN, 0),
        (second(brick::X_MIN), 0),
        (brick::Y_MIN, 1),
        (second(brick::Y_MIN), 1),
    ];
    let scene = Scene::new(mesh, uniform(YOUNG / unit.powi(2), POISSON));
    let scene = scene.with_support(Support::components(brick::Z_MIN, axis(2)));
    sides
        .into_iter()
        .fold(scene, |scene, (tag, c)| {
            scene.with_support(Support::components(tag, axis(c)))
        })
        .with_load(Load::pressure(second(brick::Z_MAX), PRESSURE / unit.powi(2)))
}

/// Largest error of a displacement of uniform compression along z, relative.
fn patch_error(mesh: &TetMesh, displacement: &[f64], unit: f64) -> f64 {
    let strain = PRESSURE / YOUNG;
    let error = mesh.points().iter().zip(displacement.chunks(3)).map(|([x, y, z], u)| {
        let exact = [POISSON * strain * x, POISSON * strain * y, -strain * z];
        (0..3).map(|c| (u[c] - exact[c]).abs()).fold(0.0, f64::max)
    });
    error.fold(0.0, f64::max) / (strain * unit)
}

/// Uniform pressure passes exactly, for any ratio of meshes, the same nodes with other diagonals among them, either
/// order of sides, with friction and without, any cut, in metres and millimetres.
#[test]
fn uniform_pressure_passes_exactly() {
    let both = |x: FacetTag, y: FacetTag, swap: bool| {
        if swap { Contact::between(y, x) } else { Contact::between(x, y) }
    };
    for (lower, upper, boxes, unit) in [
        ([2, 2, 2], [6, 6, 2], [1, 1, 2], 1.0),
        ([6, 6, 2], [2, 2, 2], [2, 1, 2], 1.0),
        ([3, 4, 2], [4, 3, 2], [2, 2, 2], 1000.0),
        ([3, 3, 3], [4, 4, 2], [3, 2, 2], 1.0),
        ([5, 5, 2], [2, 3, 2], [1, 1, 1], 1e-3),
        // other diagonals on the same nodes
        ([5, 5, 1], [5, 5, 2], [1, 1, 2], 1.0),
    ] {
        for swap in [false, true] {
            for friction in [Friction::None, Friction::coulomb(0.3)] {
                let mesh = blocks(lower, upper, unit);
                let contact = both(second(brick::Z_MIN), brick::Z_MAX, swap).with_friction(friction.clone());
                let scene = pressed_blocks(mesh.clone(), unit)
                    .with_contact(contact)
                    .with_boxes(boxes);
                let result = solve(scene, tight());
                let what = format!("{lower:?} {upper:?} {swap} {friction:?}");
                let error = patch_error(&mesh, &result.displacement, unit);
                assert!(error < 1e-9, "{what}: {error:e}");
                let force: f64 = result.points.iter().map(|p| p.normal_force).sum();
                assert!((force + PRESSURE).abs() < 1e-9 * PRESSURE, "{what}: {force}");
                let area: f64 = result.points.iter().map(|p| p.area).sum();
                assert!((area / unit.powi(2) - 1.0).abs() < 1e-12, "{what}: {area}");
                for point in &result.points {
                    let pressure = -point.normal_force / point.area * unit.powi(2);
                    assert!((pressure - PRESSURE).abs() < 1e-7 * PRESSURE, "{what}: {pressure}");
                    let friction = point.friction_force.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
                    assert!(point.gap.abs() < 1e-9 * unit, "{what}: {:e}", point.gap);
                    // at nodes that supports hold friction may be anything that cancels on the other side
                    let [x, y, _] = mesh.points()[point.node as usize];
                    let free = x > 0.0 && y > 0.0;
                    assert!(
                        !free || friction < 1e-6 * PRESSURE * point.area / area,
                        "{what}: {friction:e}"
                    );
                }
            }
        }
    }
}

/// A block that is pressed and pulled on a larger one, with other cells; the contact covers facets in part.
fn pulled(swap: bool, boxes: [usize; 3]) -> Scene {
    let below = block([1.5, 1.0, 0.5], [7, 5, 2]);
    let above = block([0.8, 0.7, 0.6], [3, 3, 2])
        .map_points(|[x, y, z]| [x + 0.31, y + 0.17, z + 0.5])
        .expect("lifted");
    let (upper, lower) = (second(brick::Z_MIN), brick::Z_MAX);
    let contact = if swap { Contact::between(lower, upper) } else { Contact::between(upper, lower) };
    Scene::new(with_second(&below, &above), uniform(1e9, 0.3))
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(Load::traction(second(brick::Z_MAX), [2e5, 1e5, -1e6]))
        .with_contact(contact.with_friction(Friction::coulomb(0.28)))
        .with_boxes(boxes)
}

/// Forces balance, their moments too, whatever the cut, the order of the sides and the threads; the estimate of the
/// algebraic error is small, and every method finds the same.
#[test]
fn results_do_not_depend_on_the_cut_the_method_nor_on_which_side_comes_first() {
    let (mut reference, results) = run(pulled(false, [1, 1, 1]), tight());
    let whole = &results[0];
    assert!(whole.summary.slip > 0 && whole.summary.stick > 0, "{:?}", whole.summary);
    let area: f64 = whole.points.iter().map(|p| p.area).sum();
    assert!((area - 0.56).abs() < 1e-12, "{area}");
    assert!((whole.summary.normal_force - 0.56e6).abs() < 1.0, "{:?}", whole.summary);
    for (swap, boxes) in [(true, [1, 1, 1]), (false, [2, 2, 2]), (true, [3, 2, 3])] {
        for method in methods() {
            let scene = pulled(swap, boxes);
            let (_, results) = run(scene.clone(), tight().with_method(method));
            let distance = relative_distance(&scene, &results[0].displacement, &whole.displacement);
            assert!(distance < 1e-6, "{swap} {boxes:?}: {distance:e}");
            // the force on the side that is named first
            let sign = if swap { -1.0 } else { 1.0 };
            let resultant = results[0].summary.resultant.map(|f| sign * f);
            assert_close(&resultant, &whole.summary.resultant, 1e-6, "resultant");
        }
    }
    reference = Simulation::new(reference.scene().clone(), tight()).expect("set-up");
    let result = reference.step().expect("step");
    let reactions = result.reactions();
    let sum = reactions.contact;
    assert!(sum.force.iter().chain(&sum.moment).all(|f| f.abs() < 1e-3), "{sum:?}");
    let imbalance = reactions.imbalance();
    assert!(imbalance.moment.iter().all(|m| m.abs() < 1.0), "{imbalance:?}");
    let upper = reactions.contacts[0];
    assert!((upper.force[2] - 0.56e6).abs() < 1.0, "{upper:?}");
    let error = result.algebraic_error();
    assert!(error.relative() < 1e-4, "{error:?}");
}

/// Tied blocks move as one, pulled as well as pressed and sheared, for any ratio of meshes, either order, any cut;
/// without contact the solver is the linear one. Reactions balance though supports hold nodes of the tie.
#[test]
fn tied_blocks_are_one() {
    for (lower, upper, boxes) in [
        ([2, 2, 2], [6, 6, 2], [1, 1, 2]),
        ([5, 5, 2], [2, 3, 2], [2, 1, 2]),
        ([3, 3, 2], [3, 3, 2], [1, 2, 2]),
        ([3, 3, 3], [3, 3, 2], [1, 2, 2]),
    ] {
        for (a, b) in [
            (second(brick::Z_MIN), brick::Z_MAX),
            (brick::Z_MAX, second(brick::Z_MIN)),
        ] {
            let mesh = blocks(lower, upper, 1.0);
            let pulled = pressed_blocks(mesh.clone(), 1.0)
                .with_load(Load::pressure(second(brick::Z_MAX), -2.0 * PRESSURE))
                .with_contact(Contact::tied(a, b))
                .with_boxes(boxes);
            let (simulation, results) = run(pulled, tight());
            let what = format!("{lower:?} {upper:?} {a}");
            let effects = simulation.plan().effects;
            assert!(effects.ties && !effects.contact && !effects.partners, "{what}");
            assert_eq!(simulation.plan().method, MethodKind::Linear, "{what}");
            assert!(results[0].points.is_empty(), "{what}");
            let rows = simulation.tfeti().gluing().ranges();
            assert!(!rows.tied.is_empty() && rows.contact().is_empty(), "{what}");
            assert_eq!(simulation.plan().dual(), rows.total(), "{what}");
            let pulled: Vec<f64> = results[0].displacement.iter().map(|u| -u).collect();
            let error = patch_error(&mesh, &pulled, 1.0);
            assert!(error < 1e-9, "{what}: {error:e}");
        }
    }
    // sheared: the same reactions as those of one block, and the force through the tie
    let mesh = blocks([3, 3, 3], [4, 5, 4], 1.0);
    let load = [1e5, 3e4, 2e5];
    let scene = Scene::new(mesh, uniform(YOUNG, POISSON))
        .with_support(Support::fixed(brick::X_MIN))
        .with_support(Support::components(second(brick::X_MIN), [true, false, true]))
        .with_load(Load::traction(second(brick::Z_MAX), load))
        .with_contact(Contact::tied(second(brick::Z_MIN), brick::Z_MAX))
        .with_boxes([1, 2, 2]);
    let mut simulation = Simulation::new(scene, tight()).expect("set-up");
    let result = simulation.step().expect("step");
    let reactions = result.reactions();
    let imbalance = reactions.imbalance();
    let parts = imbalance.force.iter().chain(&imbalance.moment);
    assert!(parts.clone().all(|f| f.abs() < 1e-3), "{imbalance:?}");
    let upper = [0, 1, 2]
        .map(|c| reactions.contacts[0].force[c] + reactions.supports[1].resultant.force[c] + reactions.loads.force[c]);
    assert!(upper.iter().all(|f| f.abs() < 1e-3), "{upper:?}");
    let error = result.algebraic_error();
    assert!(error.relative() < 1e-5, "{error:?}");
}

/// A bolt: tied parts that are pulled together between walls carry the stress of the way over their length, step by
/// step, linear and quadratic, whatever side is named first; supports may hold nodes of the tie.
#[test]
fn tied_parts_that_move_against_each_other_are_a_tightened_bolt() {
    let way = 1e-4;
    let walls = [
        (brick::X_MIN, 0),
        (second(brick::X_MIN), 0),
        (brick::Y_MIN, 1),
        (second(brick::Y_MIN), 1),
        (brick::Z_MIN, 2),
        (second(brick::Z_MAX), 2),
    ];
    for (order, a, b, sign) in [
        (1, second(brick::Z_MIN), brick::Z_MAX, -1.0),
        (1, brick::Z_MAX, second(brick::Z_MIN), 1.0),
        (2, second(brick::Z_MIN), brick::Z_MAX, -1.0),
    ] {
        let mut mesh = blocks([3, 3, 2], [2, 4, 2], 1.0);
        if order == 2 {
            mesh = mesh.raise_order().expect("quadratic");
        }
        let tie = Contact::tied(a, b).with_motion([0.0, 0.0, sign * way], History::ramp(1.0, 1.0).expect("ramp"));
        let scene = Scene::new(mesh, uniform(YOUNG, POISSON))
            .with_contact(tie)
            .with_boxes([1, 1, 2])
            .with_analysis(Analysis::quasistatic(1.0, 2));
        let scene = walls.iter().fold(scene, |scene, &(tag, axis)| {
            scene.with_support(Support::partial(
                tag,
                Directions::Components([0, 1, 2].map(|c| c == axis)),
            ))
        });
        let (simulation, results) = run(scene, at(1e-8));
        assert!(simulation.plan().effects.moving_ties && !simulation.plan().effects.moving_obstacle);
        for (k, result) in results.iter().enumerate() {
            let stress = YOUNG * 0.5 * way * (k + 1) as f64 / 2.0;
            let size = stress / YOUNG;
            for (place, u) in simulation
                .scene()
                .mesh()
                .points()
                .iter()
                .zip(result.displacement.as_chunks::<3>().0)
            {
                let upper = f64::from(place[2] > 1.0) * 2.0;
                assert!(
                    (place[2] - 1.0).abs() < 1e-9 || (u[2] - size * (place[2] - upper)).abs() < 1e-7 * way,
                    "{place:?} {u:?}"
                );
                assert!((u[0] + POISSON * size * place[0]).abs() < 1e-7 * way, "{place:?} {u:?}");
            }
        }
        // the upper part is pulled down
        let force = simulation.result().expect("step").reactions().contacts[0].force[2];
        assert!((force - sign * YOUNG * 0.5 * way).abs() < 1e-7 * YOUNG * way, "{force}");
        let error = simulation.result().expect("step").algebraic_error();
        assert!(error.relative() < 1e-5, "{error:?}");
    }
}

#[test]
fn a_tied_contact_has_no_friction() {
    let scene = pressed_blocks(blocks([2; 3], [3; 3], 1.0), 1.0);
    let contact = Contact::tied(second(brick::Z_MIN), brick::Z_MAX);
    let turn = History::ramp(1.0, 1.0).expect("ramp");
    for contact in [
        contact.clone().with_friction(Friction::coulomb(0.1)),
        contact.with_rotation([0.0; 3], [0.0, 0.0, 1.0], turn),
    ] {
        let error = refused(&scene.clone().with_contact(contact));
        assert!(matches!(error, ContactError::Tied { contact: 0 }), "{error}");
    }
}

/// Two blocks side by side on one, the joint between them inside its facets: facets covered in part, and nodes with a
/// point for either block, in one contact or in two, pass uniform pressure exactly.
#[test]
fn facets_covered_in_part_pass_uniform_pressure() {
    let third = |tag: FacetTag| FacetTag(tag.0 + 200);
    let strain = PRESSURE / YOUNG;
    let below = block([2.0, 1.0, 1.0], [5, 3, 2]);
    let left = lifted(&block([0.87, 1.0, 1.0], [2, 2, 2]), 1.0);
    let right = block([1.13, 1.0, 1.0], [7, 5, 2]).map_points(|[x, y, z]| [x + 0.87, y, z + 1.0]);
    let right = right.expect("right").map_tags(third);
    let mesh = with_second(&below, &left).append(&right).expect("three");
    let top = brick::Z_MAX;
    let [a, b] = [second(brick::Z_MIN), third(brick::Z_MIN)];
    let ways: [Vec<Contact>; 3] = [
        vec![Contact::between(top, a), Contact::between(top, b)],
        vec![Contact::between(a, top), Contact::between(b, top)],
        vec![Contact::between(top, a).with_partner(b)],
    ];
    for (k, contacts) in ways.into_iter().enumerate() {
        let axis = |c: usize| [c == 0, c == 1, c == 2];
        let mut scene = Scene::new(mesh.clone(), uniform(YOUNG, POISSON))
            .with_support(Support::components(brick::Z_MIN, axis(2)))
            .with_support(Support::components(brick::X_MIN, axis(0)))
            .with_support(Support::components(second(brick::X_MIN), axis(0)))
            .with_support(
                Support::components(third(brick::X_MAX), axis(0))
                    .with_motion([2.0 * POISSON * strain, 0.0, 0.0], ramp()),
            )
            .with_load(Load::pressure(second(brick::Z_MAX), PRESSURE))
            .with_load(Load::pressure(third(brick::Z_MAX), PRESSURE))
            .with_boxes([2, 1, 2]);
        for tag in [brick::Y_MIN, second(brick::Y_MIN), third(brick::Y_MIN)] {
            scene = scene.with_support(Support::components(tag, axis(1)));
        }
        let scene = contacts.into_iter().fold(scene, Scene::with_contact);
        let scene = scene.with_analysis(Analysis::quasistatic(1.0, 1));
        let result = solve(scene, tight());
        let error = patch_error(&mesh, &result.displacement, 1.0);
        assert!(error < 1e-9, "way {k}: {error:e}");
        let area: f64 = result.points.iter().map(|p| p.area).sum();
        assert!((area - 2.0).abs() < 1e-12, "way {k}: {area}");
        for point in &result.points {
            let pressure = -point.normal_force / point.area;
            assert!((pressure - PRESSURE).abs() < 1e-6 * PRESSURE, "way {k}: {pressure:e}");
        }
    }
}

/// Quadratic tetrahedra meshed apart: uniform pressure passes exactly, touching and tied; the estimate is small.
#[test]
fn quadratic_bodies_meshed_apart_pass_uniform_pressure() {
    for (lower, upper, boxes) in [
        ([2, 2, 1], [3, 3, 1], [1, 1, 2]),
        ([3, 2, 1], [1, 1, 1], [2, 1, 2]),
        ([2, 2, 2], [2, 3, 1], [1, 1, 1]),
        ([2, 2, 1], [2, 2, 2], [1, 1, 2]),
    ] {
        for tied in [false, true] {
            for (a, b) in [
                (second(brick::Z_MIN), brick::Z_MAX),
                (brick::Z_MAX, second(brick::Z_MIN)),
            ] {
                let mesh = blocks(lower, upper, 1.0).raise_order().expect("order 2");
                let contact = if tied {
                    Contact::tied(a, b)
                } else {
                    Contact::between(a, b).with_friction(Friction::coulomb(0.3))
                };
                let scene = pressed_blocks(mesh.clone(), 1.0)
                    .with_contact(contact)
                    .with_boxes(boxes);
                let mut simulation = Simulation::new(scene, tight()).expect("set-up");
                let what = format!("{lower:?} {upper:?} {tied} {a}");
                let result = step(&mut simulation);
                assert_certified(&result, &what);
                let error = patch_error(&mesh, &result.displacement, 1.0);
                assert!(error < 1e-8, "{what}: {error:e}");
                let area: f64 = result.points.iter().map(|p| p.area).sum();
                assert!(tied || (area - 1.0).abs() < 1e-12, "{what}: {area}");
                for point in &result.points {
                    let pressure = -point.normal_force / point.area;
                    assert!((pressure / PRESSURE - 1.0).abs() < 1e-6, "{what}: {pressure:e}");
                }
                let error = simulation.result().expect("a step").algebraic_error();
                assert!(error.relative() < 1e-5, "{what}: {error:?}");
            }
        }
    }
}

/// Sides with bent edges in their plane, as a disc has at its rim: a body tied there turns with the other one, and
/// balances it, though no node of one side is one of the other.
#[test]
fn quadratic_sides_with_bent_edges_turn_together() {
    let bulged = |[x, y, z]: [f64; 3]| {
        let [u, v] = [2.0 * x - 1.0, 2.0 * y - 1.0];
        [u * (1.1 - 0.1 * v * v), v * (1.1 - 0.1 * u * u), z]
    };
    let mesh = blocks([2, 2, 1], [3, 3, 1], 1.0).raise_order().expect("order 2");
    let mesh = mesh.map_points(bulged).expect("bulged");
    let turned = |[x, y, z]: [f64; 3]| [2.0 * z - 3.0 * y, 3.0 * x - z, y - 2.0 * x].map(|u| 1e-3 * u);
    let held = mesh.nodes_on(brick::Z_MIN);
    let turns = held.iter().map(|&n| turned(mesh.points()[n as usize])).collect();
    let scene = Scene::new(mesh.clone(), uniform(YOUNG, POISSON))
        .with_support(Support::fixed(held).with_motions(turns, History::constant(1.0)))
        .with_contact(Contact::tied(second(brick::Z_MIN), brick::Z_MAX))
        .with_boxes([1, 1, 2]);
    let (_, results) = run(scene.clone(), Settings::default());
    for (&x, u) in mesh.points().iter().zip(results[0].displacement.as_chunks::<3>().0) {
        let error = turned(x).iter().zip(u).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-10, "{x:?}: {error:e}");
    }
    let pulled = scene.with_load(Load::traction(second(brick::X_MAX), [PRESSURE, 2.0 * PRESSURE, 0.0]));
    let mut simulation = Simulation::new(pulled, tight()).expect("set-up");
    let imbalance = simulation.step().expect("step").reactions().imbalance();
    let parts = imbalance.force.iter().chain(&imbalance.moment);
    assert!(parts.clone().all(|f| f.abs() < 1e-8 * PRESSURE), "{imbalance:?}");
}

/// Combs whose shelves lie on one another, the upper ones half beyond the lower: in one contact each sees the nearest
/// shelf only, as with a contact a shelf. Pieces of the next shelf had a share where the nearest covered half a facet.
#[test]
fn layers_of_one_contact_are_told_apart() {
    let shelves = 3;
    let shelf = Brick::new([8.0, 4.0, 0.6], [6, 4, 1]).build().expect("brick");
    let tag = |k: usize, tag: FacetTag| FacetTag(100 * (k as u32 + 1) + tag.0);
    let at = |k: usize, offset: [f64; 3]| {
        let moved = shelf.map_points(|x| [0, 1, 2].map(|c| x[c] + offset[c]));
        moved.expect("moved").map_tags(|t| tag(k, t))
    };
    let places = (0..shelves).flat_map(|k| {
        let height = 1.5 * k as f64;
        [at(2 * k, [0.0, 0.0, height]), at(2 * k + 1, [2.0, 0.0, height + 0.6])]
    });
    let mesh = places
        .reduce(|all, one| all.append(&one).expect("appended"))
        .expect("a mesh");
    let base = (0..shelves).fold(Scene::new(mesh, uniform(YOUNG, POISSON)), |scene, k| {
        let guide = Support::components(tag(2 * k + 1, brick::X_MAX), [true, true, false]);
        scene
            .with_support(Support::fixed(tag(2 * k, brick::X_MIN)))
            .with_support(guide)
            .with_load(Load::pressure(tag(2 * k + 1, brick::Z_MAX), 1e-4 * YOUNG))
    });
    let sides = |k: usize| (tag(2 * k, brick::Z_MAX), tag(2 * k + 1, brick::Z_MIN));
    let each = (0..shelves).fold(base.clone(), |scene, k| {
        scene.with_contact(Contact::between(sides(k).0, sides(k).1))
    });
    let whole = (1..shelves).fold(Contact::between(sides(0).0, sides(0).1), |contact, k| {
        contact.with_tag(sides(k).0).with_partner(sides(k).1)
    });
    let [each, whole] = [each, base.with_contact(whole)].map(|scene| solve(scene, Settings::default()).displacement);
    assert_close(&whole, &each, 1e-6, "displacements");
}

/// Sides that do not face each other, a tag on both sides, bodies inside each other: refused as where meshes match. The
/// plan says which side has the points: that with the larger facets, or the first of those that are alike.
#[test]
fn bad_pairs_are_named_and_the_plan_tells_whose_points_they_are() {
    let scene = |lower: usize, upper: usize, contact: Contact| {
        Scene::new(blocks([lower; 3], [upper; 3], 1.0), uniform(YOUNG, POISSON))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_contact(contact)
    };
    let joint = || Contact::between(second(brick::Z_MIN), brick::Z_MAX);
    let refused = |contact| Plan::new(&scene(3, 2, contact), &Settings::default()).expect_err("refused");
    let error = refused(Contact::between(second(brick::Z_MIN), brick::X_MIN));
    assert!(matches!(error, ContactError::NoPartner { contact: 0, .. }), "{error}");
    let error = refused(joint().with_partner(second(brick::Z_MIN)));
    assert!(matches!(error, ContactError::SameSide { contact: 0, .. }), "{error}");
    for outer in [Contact::between, Contact::tied] {
        let error = refused(outer(second(brick::Z_MAX), brick::Z_MIN));
        let ContactError::Overlap {
            node, partner, depth, ..
        } = error
        else {
            panic!("{error}")
        };
        let mesh = blocks([3; 3], [2; 3], 1.0);
        let [above, below] = [node, partner].map(|n| mesh.points()[n as usize][2]);
        assert!(
            (above - below - 2.0).abs() < 1e-9 && (depth - 2.0).abs() < 1e-9,
            "{above} {below} {depth}"
        );
    }
    for (lower, upper, apart) in [
        (2, 2, vec![]),
        (3, 2, vec![(0, false)]),
        (2, 3, vec![(0, true)]),
        // with other diagonals
        (3, 3, vec![(0, false)]),
    ] {
        let plan = Plan::new(&scene(lower, upper, joint()), &Settings::default()).expect("a plan");
        assert_eq!(plan.apart, apart);
        let said = plan.to_string().contains("meshes do not match, points on its");
        assert_eq!(said, !apart.is_empty(), "{plan}");
    }
}
