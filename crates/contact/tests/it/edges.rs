//! Edges and corners: nodes that meet several obstacles, and scenes with several contact surfaces.

use crate::common::*;

const YOUNG: f64 = 1e6;
const POISSON: f64 = 0.3;

fn cube(cells: usize) -> TetMesh {
    block([1.0; 3], [cells; 3])
}

fn worst(u: &[f64], mesh: &TetMesh, exact: impl Fn([f64; 3]) -> [f64; 3]) -> f64 {
    let size = |v: [f64; 3]| v.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    let exact: Vec<[f64; 3]> = mesh.points().iter().map(|x| exact(*x)).collect();
    let largest = exact.iter().map(|v| size(*v)).fold(0.0, f64::max);
    let off = u
        .as_chunks::<3>()
        .0
        .iter()
        .zip(&exact)
        .map(|(u, e)| size([0, 1, 2].map(|c| u[c] - e[c])));
    off.fold(0.0, f64::max) / largest
}

/// A cube pressed into a corner of three walls, all without friction: hydrostatic pressure. Nothing else holds it.
fn cornered(contacts: &[Contact], cells: usize) -> Scene {
    let mut scene = Scene::new(cube(cells), uniform(YOUNG, POISSON));
    for contact in contacts {
        scene = scene.with_contact(contact.clone());
    }
    for tag in [brick::X_MAX, brick::Y_MAX, brick::Z_MAX] {
        scene = scene.with_load(Load::pressure(tag, 1e3));
    }
    scene
}

fn hydrostatic(contacts: &[Contact], boxes: [usize; 3], method: Method) {
    let cells = 2;
    let strain = -(1.0 - 2.0 * POISSON) * 1e3 / YOUNG;
    let scene = cornered(contacts, cells).with_boxes(boxes);
    let mesh = scene.mesh().clone();
    let (simulation, results) = run(scene, at(1e-9).with_method(method));
    let gluing = simulation.tfeti().gluing();
    assert_eq!(gluing.ranges().normal.len(), 3 * (cells + 1).pow(2));
    assert_eq!(simulation.plan().normal_rows, gluing.ranges().normal.len());
    // three perpendicular normals are orthonormal rows
    assert!(orthonormal(gluing));
    let off = worst(&results[0].displacement, &mesh, |x| x.map(|c| strain * c));
    assert!(off < 1e-6, "{off:e}");
    for point in &results[0].points {
        let pressure = -point.normal_force / point.area;
        assert!((pressure / 1e3 - 1.0).abs() < 1e-6, "{pressure}");
    }
    let corner = results[0].points.iter().filter(|p| p.node == 0).count();
    assert_eq!(corner, 3);
    let error = simulation.result().expect("a step").algebraic_error().relative();
    assert!(error < 1e-5, "estimate {error:e}");
}

const CORNER: [FacetTag; 3] = [brick::X_MIN, brick::Y_MIN, brick::Z_MIN];

fn hydrostatic_by_all_methods(boxes: [usize; 3]) {
    let [x, y, z] = CORNER;
    let one = [Contact::rigid(x).with_tag(y).with_tag(z)];
    for method in methods() {
        hydrostatic(&one, boxes, method.clone());
        hydrostatic(&CORNER.map(Contact::rigid), boxes, method);
    }
}

#[test]
fn a_cube_in_a_corner_is_under_hydrostatic_pressure() {
    hydrostatic_by_all_methods([1, 1, 1]);
}

#[test]
fn a_cube_in_a_corner_cut_in_two_is_under_hydrostatic_pressure() {
    hydrostatic_by_all_methods([2, 1, 1]);
}

#[test]
fn a_cube_in_a_corner_cut_in_eight_is_under_hydrostatic_pressure() {
    hydrostatic_by_all_methods([2, 2, 2]);
}

/// A cube in a box of five walls, pressed from above: uniaxial strain.
#[test]
fn a_cube_in_a_box_is_under_uniaxial_strain() {
    let pressure = 1e3;
    let strain = -pressure * (1.0 + POISSON) * (1.0 - 2.0 * POISSON) / (YOUNG * (1.0 - POISSON));
    for boxes in [[1, 1, 1], [2, 2, 1]] {
        let contact = Contact::rigid(brick::Z_MIN)
            .with_tag(brick::X_MIN)
            .with_tag(brick::X_MAX)
            .with_tag(brick::Y_MIN)
            .with_tag(brick::Y_MAX);
        let scene = Scene::new(cube(3), uniform(YOUNG, POISSON))
            .with_contact(contact)
            .with_load(Load::pressure(brick::Z_MAX, pressure))
            .with_boxes(boxes);
        let mesh = scene.mesh().clone();
        let result = solve(scene, at(1e-9));
        let off = worst(&result.displacement, &mesh, |x| [0.0, 0.0, strain * x[2]]);
        assert!(off < 1e-6, "{boxes:?}: {off:e}");
    }
}

fn rough_corner(friction: Friction) -> Scene {
    let contact = Contact::rigid(brick::X_MIN)
        .with_tag(brick::Y_MIN)
        .with_tag(brick::Z_MIN)
        .with_friction(friction);
    cornered(&[contact], 3)
        .with_load(Load::traction(brick::Z_MAX, [400.0, 100.0, 0.0]))
        .with_analysis(Analysis::quasistatic(1.0, 2))
}

/// Rows of a node depend on one another with friction: forces are not unique, displacements with given bounds are.
#[test]
fn a_corner_with_friction_does_not_depend_on_the_cut() {
    let scene = rough_corner(Friction::tresca(150.0));
    let reference = run(scene.clone(), at(1e-9)).1;
    for boxes in [[1, 1, 1], [3, 1, 1], [2, 2, 2]] {
        let results = run(scene.clone().with_boxes(boxes), at(1e-9)).1;
        for (a, b) in results.iter().zip(&reference) {
            let off = distance(&a.displacement, &b.displacement);
            assert!(off < 1e-5, "{boxes:?}: {off:e}");
            assert!(!a.report.fallback, "{boxes:?}");
        }
        // with Coulomb's law bounds follow the forces: one of several solutions, certified
        let scene = rough_corner(Friction::coulomb(0.3)).with_boxes(boxes);
        for result in run(scene, at(1e-9)).1 {
            assert!(!result.report.fallback, "{boxes:?}");
        }
    }
}

/// A block in a V-groove of two planes at 45 degrees: each takes W / sqrt 2, and pulling takes sqrt 2 mu W.
#[test]
fn a_block_slides_along_a_groove() {
    let about_x = rotation([1.0, 0.0, 0.0], std::f64::consts::FRAC_PI_4);
    let mesh = block([2.0, 1.0, 1.0], [4, 2, 2])
        .map_points(|p| turn(&about_x, p))
        .expect("mesh");
    let coefficient = 0.25;
    let groove = Contact::rigid(brick::Y_MIN)
        .with_tag(brick::Z_MIN)
        .with_friction(Friction::coulomb(coefficient));
    // nodes at the end that touch neither plane: the grid has 5 x 3 x 3 nodes
    let back: Vec<u32> = (0..45)
        .filter(|n| n % 5 == 4 && (n / 5) % 3 > 0 && n / 15 > 0)
        .collect();
    for boxes in [[1, 1, 1], [2, 1, 1]] {
        for method in methods() {
            let scene = Scene::new(mesh.clone(), uniform(1e5, 0.3))
                .with_contact(groove.clone())
                .with_load(Load::body([0.0, 0.0, -0.5]))
                .with_boxes(boxes)
                .with_support(
                    Support::components(back.clone(), [true, false, false])
                        .with_motion([0.1, 0.0, 0.0], History::constant(1.0)),
                );
            let result = solve(scene, at(1e-9).with_method(method.clone()));
            let found = -result.summary.friction_force[0];
            let expected = 2.0_f64.sqrt() * coefficient;
            assert!(
                (found / expected - 1.0).abs() < 1e-5,
                "{}: {found} {expected}",
                method.kind()
            );
            let up = result.summary.resultant[2];
            assert!((up - 1.0).abs() < 1e-6, "{up}");
        }
    }
}

/// Floor with friction, wall without: pulling along both takes the floor's friction alone.
#[test]
fn each_surface_has_its_own_law() {
    let (weight, side, coefficient) = (2.0, 1.0, 0.3);
    let scene = |wall: Friction| {
        let back: Vec<u32> = (0..45)
            .filter(|n| n % 5 == 4 && (n / 5) % 3 > 0 && n / 15 > 0)
            .collect();
        Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e6, 0.3))
            .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(coefficient)))
            .with_contact(Contact::rigid(brick::Y_MIN).with_friction(wall))
            .with_load(Load::body([0.0, -side / 2.0, -weight / 2.0]))
            .with_boxes([2, 1, 1])
            .with_support(
                Support::components(back, [true, false, false]).with_motion([0.1, 0.0, 0.0], History::constant(1.0)),
            )
    };
    let walls = [
        (Friction::None, 0.0),
        (Friction::coulomb(0.1), 0.1 * side),
        (Friction::tresca(0.05), 0.05 * 2.0),
    ];
    for (wall, own) in walls {
        let (simulation, results) = run(scene(wall.clone()), at(1e-9));
        let result = &results[0];
        let found = -result.summary.friction_force[0];
        let expected = coefficient * weight + own;
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
        let of = |surface: usize| {
            let points = result.points.iter().filter(move |p| p.surface == surface);
            points.map(|p| p.normal_force).sum::<f64>()
        };
        assert!((of(0) + weight).abs() < 1e-6 && (of(1) + side).abs() < 1e-6);
        assert_eq!(simulation.scene().contacts().len(), 2);
        assert_eq!(simulation.result().map(|f| f.surfaces().len()), Some(2));
    }
}

/// Two parts of one floor with different coefficients: border nodes are one point, of the first part.
#[test]
fn parts_of_a_floor_share_their_nodes() {
    let mesh = block([2.0, 1.0, 1.0], [4, 2, 2]);
    let slick = FacetTag(77);
    let points = mesh.points().to_vec();
    let facets = mesh
        .facets()
        .iter()
        .map(|f| {
            let mut f = *f;
            let x = f.nodes.iter().map(|n| points[*n as usize][0]).sum::<f64>() / 3.0;
            if f.tag == brick::Z_MIN && x > 1.0 {
                f.tag = slick;
            }
            f
        })
        .collect();
    let mesh = TetMesh::new(points, mesh.tets().to_vec(), facets).expect("mesh");
    let law = |tag, mu| Contact::rigid(tag).with_friction(Friction::coulomb(mu));
    let scene = Scene::new(mesh, uniform(1e6, 0.3))
        .with_contact(law(brick::Z_MIN, 0.4))
        .with_contact(law(slick, 0.1))
        .with_support(Support::fixed(brick::Z_MAX).with_motion([1e-2, 0.0, -1e-3], History::constant(1.0)));
    let result = solve(scene, at(1e-9));
    assert_eq!(result.points.len(), 15);
    let area: f64 = result.points.iter().map(|p| p.area).sum();
    assert!((area - 2.0).abs() < 1e-12);
    for point in &result.points {
        let mu = if point.surface == 0 { 0.4 } else { 0.1 };
        assert!((point.slip_bound + mu * point.normal_force).abs() < 1e-9);
        assert_eq!(point.state, ContactState::Slip);
    }
    assert_eq!(result.points.iter().filter(|p| p.surface == 0).count(), 9);
}

/// A block that sticks on the floor, slides, and runs against a wall within one step: there floor and wall want the
/// edge at different places.
#[test]
fn a_sliding_block_runs_against_a_wall() {
    let gap = 1e-3;
    let scene = |steps: usize, boxes: [usize; 3]| {
        Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e6, 0.3))
            .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.4)))
            .with_contact(Contact::rigid(brick::X_MAX).with_gap(gap))
            .with_load(Load::pressure(brick::Z_MAX, 1e3))
            .with_load(Load::pressure(brick::X_MIN, 2e3).with_history(History::ramp(1.0, 1.0).expect("ramp")))
            .with_boxes(boxes)
            .with_analysis(Analysis::quasistatic(1.0, steps))
    };
    for steps in [1, 3, 8] {
        for boxes in [[1, 1, 1], [2, 1, 1]] {
            let (_, results) = run(scene(steps, boxes), Settings::default());
            for result in &results {
                assert!(!result.report.fallback, "{steps} {boxes:?}");
            }
            let last = &results[results.len() - 1];
            let wall: f64 = last
                .points
                .iter()
                .filter(|p| p.surface == 1)
                .map(|p| p.normal_force)
                .sum();
            let friction = last.summary.friction_force[0];
            assert!((2e3 + wall + friction).abs() < 1e-4, "{wall} {friction}");
            assert!(wall < -1e3, "{wall}");
        }
    }
}

/// One tag between two obstacles: each node of the floor may also meet the wall.
#[test]
fn one_tag_may_meet_two_obstacles() {
    let floor = Contact::half_space(brick::Z_MIN, [0.0; 3], [0.0, 0.0, 1.0]).with_friction(Friction::coulomb(0.2));
    // a slope without friction that begins under the edge of the block
    let wall = Contact::half_space(brick::Z_MIN, [1.0, 0.0, 0.0], [-1.0, 0.0, 1.0]);
    let scene = Scene::new(cube(2), uniform(YOUNG, POISSON))
        .with_contact(floor.clone())
        .with_contact(wall)
        .with_load(Load::body([500.0, 0.0, -1000.0]));
    let result = solve(scene, at(1e-9));
    assert_eq!(result.points.len(), 18);
    let wall: f64 = result
        .points
        .iter()
        .filter(|p| p.surface == 1)
        .map(|p| p.normal_force)
        .sum();
    let along = 500.0 + wall / 2.0_f64.sqrt() + result.summary.friction_force[0];
    assert!(along.abs() < 1e-4, "{along}");
    assert!(wall < -100.0, "{wall}");
    let same = Scene::new(cube(2), uniform(YOUNG, POISSON))
        .with_contact(floor.clone())
        .with_contact(floor)
        .with_load(Load::body([0.0, 0.0, -1000.0]));
    let points = solve(same, at(1e-9)).points;
    assert_eq!(points.len(), 9);
    let area: f64 = points.iter().map(|p| p.area).sum();
    assert!((area - 1.0).abs() < 1e-12, "the same facets count once: {area}");
}

#[test]
fn the_angle_of_a_crease_is_checked_and_can_be_chosen() {
    let contact = |degrees| Contact::rigid(brick::X_MIN).with_tag(brick::Z_MIN).with_crease(degrees);
    for bad in [0.0, -1.0, 181.0, f64::NAN] {
        let scene = cornered(&[contact(bad)], 2);
        assert!(matches!(
            Simulation::new(scene, at(1e-9)),
            Err(ContactError::ContactValue { name: "crease", .. })
        ));
    }
    let rows = |degrees| {
        let scene =
            cornered(&[contact(degrees)], 2).with_support(Support::components(brick::Y_MIN, [false, true, false]));
        let simulation = Simulation::new(scene, at(1e-9)).expect("set-up");
        simulation.constrained_points().len()
    };
    assert_eq!((rows(60.0), rows(89.0), rows(91.0), rows(180.0)), (18, 18, 15, 15));
}

/// Dependent rows or not: the number of threads changes no bit.
#[test]
fn a_rough_corner_has_the_same_bits_on_any_number_of_threads() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("pool");
        pool.install(|| {
            let scene = rough_corner(Friction::coulomb(0.3)).with_boxes([2, 2, 2]);
            run(scene, Settings::default()).1
        })
    };
    let one = on(1);
    for threads in [2, 3] {
        for (a, b) in one.iter().zip(&on(threads)) {
            assert_eq!(bits(a), bits(b), "{threads}");
        }
    }
}

/// A wall pushes a block along a floor, and the nodes in the edge with it, however friction wants to hold them. Planes
/// of symmetry leave some of them one direction along each.
#[test]
fn a_wall_pushes_a_rough_edge_along_a_floor() {
    let ramp = History::ramp(1.0, 1.0).expect("ramp");
    let contact = |tag, bound| Contact::rigid(tag).with_friction(Friction::tresca(bound));
    for (bound, push) in [(50.0, 1e-4), (150.0, 3e-4), (1e3, 1e-3)] {
        for shear in [0.0, 200.0, 400.0] {
            for planes in [&[brick::Y_MIN][..], &[brick::Y_MAX, brick::Y_MIN]] {
                for boxes in [[1, 1, 1], [2, 1, 2], [3, 3, 3]] {
                    let wall = contact(brick::X_MIN, bound);
                    let mut scene = Scene::new(cube(3), uniform(YOUNG, POISSON))
                        .with_contact(contact(brick::Z_MIN, bound))
                        .with_contact(wall.with_motion([push, 0.0, 0.0], ramp.clone()))
                        .with_load(Load::pressure(brick::X_MAX, 1e3))
                        .with_load(Load::traction(brick::Z_MAX, [shear, 0.0, -1e3]))
                        .with_boxes(boxes)
                        .with_analysis(Analysis::quasistatic(1.0, 2));
                    for &tag in planes {
                        let held = Support::components(tag, [false, true, false]);
                        scene = scene.with_support(held);
                    }
                    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
                    while !simulation.is_finished() {
                        let frame = simulation.step().expect("step");
                        let found = frame.certificate().largest();
                        assert!(
                            frame.report().status.converged() && found < 3e-6,
                            "{bound} {push} {shear} {planes:?} {boxes:?}: {found:e}"
                        );
                    }
                }
            }
        }
    }
}
