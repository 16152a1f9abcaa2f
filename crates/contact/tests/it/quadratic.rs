//! Contact of quadratic tetrahedra.

use crate::common::*;
use crate::estimates::estimated;

fn quadratic(lengths: [f64; 3], cells: [usize; 3]) -> TetMesh {
    block(lengths, cells).raise_order().expect("quadratic")
}

/// The brick at half load on a floor with coefficient 0.2, one static step.
fn half_loaded(mesh: TetMesh) -> Scene {
    let q = 0.5e8;
    Scene::new(mesh, steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -30.0 * q]))
        .with_load(Load::traction(brick::X_MAX, [9.0 * q, 0.0, -15.0 * q]))
        .with_contact(foundation(Friction::coulomb(0.2)))
}

/// Normal and friction force of the floor on the brick, N.
fn floor_forces(result: &Solved) -> [f64; 2] {
    let sum = |c: usize| result.points.iter().map(|p| p.force()[c]).sum();
    [sum(2), sum(0)]
}

/// Limits of meshes that get finer and finer: N, T of shared/calculix.md.
const LIMITS: [f64; 2] = [2.6228e9, -8.38e7];

fn errors(result: &Solved) -> [f64; 2] {
    let found = floor_forces(result);
    [0, 1].map(|k| (found[k] / LIMITS[k] - 1.0).abs())
}

/// Linear elements need some 35 cells a metre for 0.1 % in the normal force.
#[test]
fn forces_of_the_brick_come_near_their_limits() {
    let [coarse, fine] = [4, 7].map(|k| {
        let mesh = quadratic([3.0, 1.0, 1.0], [3 * k, k, k]);
        solve(half_loaded(mesh).with_subdomains(24), tight())
    });
    println!("{:?} {:?}", errors(&coarse), errors(&fine));
    println!("{} {}", coarse.report.counters.products, fine.report.counters.products);
    assert!(errors(&coarse)[0] < 3.5e-3 && errors(&fine)[0] < 1e-3 && errors(&fine)[1] < 3.5e-2);
}

/// Cells that get smaller towards edges and rims.
#[test]
fn a_graded_mesh_reaches_a_per_mille_and_a_per_cent() {
    let towards = |s: f64| {
        let half = |s: f64| 0.5 * (2.0 * s).powf(1.5);
        if s < 0.5 { half(s) } else { 1.0 - half(1.0 - s) }
    };
    let mesh = block([3.0, 1.0, 1.0], [18, 6, 6]);
    let mesh = mesh.map_points(|[x, y, z]| [3.0 * towards(x / 3.0), towards(y), towards(z)]);
    let mesh = mesh.expect("graded").raise_order().expect("quadratic");
    let result = solve(half_loaded(mesh).with_subdomains(24), tight());
    println!("{:?} {}", errors(&result), result.report.counters.products);
    assert!(
        errors(&result)[0] < 1e-3 && errors(&result)[1] < 1e-2,
        "{:?}",
        errors(&result)
    );
}

#[test]
fn cuts_and_methods_agree() {
    let mesh = quadratic([3.0, 1.0, 1.0], [6, 2, 2]);
    let scene = half_loaded(mesh);
    let whole = solve(scene.clone().with_boxes([1, 1, 1]), at(1e-11));
    let cut = solve(scene.clone().with_boxes([3, 2, 1]), at(1e-11));
    assert_close(&cut.displacement, &whole.displacement, 1e-8, "cut");
    for method in methods() {
        let other = solve(
            scene.clone().with_boxes([3, 1, 1]),
            at(1e-9).with_method(method.clone()),
        );
        assert_close(
            &other.displacement,
            &whole.displacement,
            1e-5,
            &method.kind().to_string(),
        );
    }
}

/// A history with a coefficient that depends on the slip rate: certificates and reactions.
#[test]
fn a_history_is_certified_and_in_equilibrium() {
    let mesh = quadratic([3.0, 1.0, 1.0], [6, 2, 2]);
    let scene = loaded_brick(mesh, up_down_up())
        .with_contact(foundation(weakening()))
        .with_analysis(paper_steps(1.0, 8))
        .with_boxes([3, 1, 1]);
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    while !simulation.is_finished() {
        let result = simulation.step().expect("step");
        assert!(result.certificate().largest() <= 1e-6 && result.report().status.converged());
        let reactions = result.reactions();
        let load = reactions.loads.force;
        let supports: Vec<[f64; 3]> = reactions.supports.iter().map(|s| s.resultant.force).collect();
        for c in 0..3 {
            let contact: f64 = result.contact_force_field().iter().map(|f| f[c]).sum();
            let sum = load[c] + contact + supports.iter().map(|f| f[c]).sum::<f64>();
            assert!(sum.abs() < 1e-6 * norm(&load), "{sum:e}");
        }
        let pressure = result.contact_pressure(0).expect("a surface");
        let areas = result.surfaces()[0].areas();
        let force: f64 = pressure.iter().zip(areas).map(|(p, a)| p * a).sum();
        let expected: f64 = result.points().iter().map(|p| -p.normal_force).sum();
        assert!(
            (force - expected).abs() < 1e-9 * expected.abs().max(1.0),
            "{force} {expected}"
        );
    }
}

#[test]
fn estimates_hold_where_points_share_nodes() {
    for friction in [Friction::None, Friction::coulomb(0.2), Friction::tresca(2e8)] {
        let scene = loaded_brick(quadratic([3.0, 1.0, 1.0], [6, 2, 2]), ramp())
            .with_contact(foundation(friction.clone()))
            .with_analysis(Analysis::quasistatic(1.0, 2))
            .with_boxes([3, 1, 2]);
        let exact = estimated(&scene, at(1e-12));
        for tolerance in [1e-2, 1e-4, 1e-6] {
            let own = &estimated(&scene, at(tolerance))[0];
            let truth = energy_distance(&scene, &own.0.displacement, &exact[0].0.displacement);
            let index = own.1.energy.sqrt() / truth;
            println!("{friction:?}, {tolerance:e}: {index:.2}, {truth:e}");
            assert!((0.99..10.0).contains(&index), "{index}");
        }
        let settings = Settings::default().with_accuracy(Accuracy::balanced());
        let (result, error, _) = &estimated(&scene, settings)[1];
        let report = result.report.accuracy.expect("a report");
        assert!(report.reached && report.certified, "{friction:?}: {error:?}");
    }
}

/// Two blocks, the second on the first, whose edges match: uniaxial stress, and exact pressure at each point.
#[test]
fn pressure_passes_between_quadratic_bodies() {
    let (young, poisson, pressure) = (2e9, 0.3, 1e6);
    // an even number of cells: diagonals of both sides are in the same place
    let lower = block([1.0; 3], [2, 2, 2]);
    let mesh = with_second(&lower, &lifted(&lower, 1.0))
        .raise_order()
        .expect("quadratic");
    for (contact, tied) in [
        (Contact::between(second(brick::Z_MIN), brick::Z_MAX), false),
        (Contact::tied(second(brick::Z_MIN), brick::Z_MAX), true),
    ] {
        let mut scene = Scene::new(mesh.clone(), uniform(young, poisson))
            .with_support(Support::components(brick::Z_MIN, [false, false, true]))
            .with_load(Load::pressure(second(brick::Z_MAX), pressure))
            .with_contact(if tied { contact } else { contact.with_friction(Friction::coulomb(0.3)) })
            .with_boxes([2, 1, 2]);
        for tag in [brick::X_MIN, second(brick::X_MIN)] {
            scene = scene.with_support(Support::components(tag, [true, false, false]));
        }
        for tag in [brick::Y_MIN, second(brick::Y_MIN)] {
            scene = scene.with_support(Support::components(tag, [false, true, false]));
        }
        let result = solve(scene, tight());
        let strain = pressure / young;
        let exact: Vec<f64> = mesh
            .points()
            .iter()
            .flat_map(|[x, y, z]| [poisson * strain * x, poisson * strain * y, -strain * z])
            .collect();
        assert_close(&result.displacement, &exact, 1e-7, "column");
        assert_eq!(result.points.is_empty(), tied);
        assert_pressure(&result.points, pressure, 1e-6, "column");
    }
}

/// Where nodes are the same a tie is exact, as a cut that is tied again shows: straight, bent, and two that cross. Tied
/// in the mean of their facets the sides would be 1.2 to 1.6 % off.
#[test]
fn tied_cuts_are_the_whole_body() {
    let straight = Brick::new([2.0, 1.0, 1.0], [6, 4, 3]).perturbed(0.1, 3).build();
    let linear = straight.expect("brick");
    let straight = linear.raise_order().expect("quadratic");
    let bent = straight.map_points(|[x, y, z]| [x, y, z + 0.15 * x * x]).expect("bent");
    let sides = [71, 72, 73, 74].map(FacetTag);
    let cut_below = |mesh: &TetMesh, axis: usize, at: f64, sides: [FacetTag; 2]| {
        let middle = |tet: usize| mesh.tet_points(tet).iter().map(|p| 0.25 * p[axis]).sum::<f64>();
        mesh.cut(|tet| Some(middle(tet) < at), sides).expect("cut")
    };
    for (what, mesh, crossing) in [
        ("straight", &straight, false),
        ("bent", &bent, false),
        ("crossing", &bent, true),
        ("linear, crossing", &linear, true),
    ] {
        let known = mesh.points().len();
        let (mut cut, mut of) = cut_below(mesh, 0, 0.9, [sides[0], sides[1]]);
        if crossing {
            let (twice, more) = cut_below(&cut, 1, 0.5, [sides[2], sides[3]]);
            let original = |&n: &u32| of.get((n as usize).wrapping_sub(known)).copied().unwrap_or(n);
            let more: Vec<u32> = more.iter().map(original).collect();
            of.extend(more);
            cut = twice;
        }
        // beside the cut
        let off = |&n: &usize| {
            (0..3)
                .map(|c| (mesh.points()[n][c] - [0.9, 0.5, 1.0][c]).abs())
                .sum::<f64>()
        };
        let node = (0..known).min_by(|a, b| off(a).total_cmp(&off(b))).expect("a node");
        let loaded = |mesh: &TetMesh| {
            Scene::new(mesh.clone(), uniform(2e9, 0.3))
                .with_support(Support::fixed(brick::X_MIN))
                .with_load(Load::traction(brick::X_MAX, [1e6, 2e5, -1e6]))
                .with_load(Load::new(LoadDensity::NodalForces(vec![(
                    node as u32,
                    [0.0, 3e5, -4e5],
                )])))
                .with_boxes([4, 2, 2])
        };
        let whole = solve(loaded(mesh), tight());
        let ties = sides.chunks(2).take(1 + usize::from(crossing));
        let scene = ties.fold(loaded(&cut), |s, tie| s.with_contact(Contact::tied(tie[0], tie[1])));
        let tied = solve(scene, tight());
        let expected: Vec<f64> = (0..known as u32)
            .chain(of)
            .flat_map(|n| whole.displacement[3 * n as usize..][..3].to_vec())
            .collect();
        assert_close(&tied.displacement, &expected, 1e-7, what);
        let [one, other] = [&whole, &tied].map(|r| r.report.counters.products);
        println!("{what}: {one} products, {other} tied");
        assert!(5 * other <= 6 * one, "{what}: {one} products, {other} tied");
    }
}

/// The plate of the GRECO comparison (Code_Aster SSNV128): friction 1, one quadratic element over the thickness.
/// Displacements on the foundation at 0 and 5 mm.
#[test]
fn plate_with_a_coefficient_of_one() {
    let cells = 24;
    let mesh = quadratic([0.04, 0.04, 0.001], [cells, cells, 1]);
    let scene = Scene::new(mesh.clone(), uniform(1.3e11, 0.2))
        .with_support(Support::components(brick::X_MAX, [true, false, false]))
        .with_support(Support::components(brick::Z_MIN, [false, false, true]))
        .with_support(Support::components(brick::Z_MAX, [false, false, true]))
        .with_load(Load::pressure(brick::Y_MAX, 5e7))
        .with_load(Load::pressure(brick::X_MIN, 15e7))
        .with_contact(Contact::rigid(brick::Y_MIN).with_friction(Friction::coulomb(1.0)));
    let result = solve(scene, Settings::default());
    for (x, expected) in [(0.0, 2.87187e-5), (0.005, 2.28971e-5)] {
        let on = |p: &[f64; 3]| (p[0] - x).abs() < 1e-9 && p[1] == 0.0;
        let nodes: Vec<usize> = (0..mesh.points().len()).filter(|&n| on(&mesh.points()[n])).collect();
        let found = nodes.iter().map(|&n| result.displacement[3 * n]).sum::<f64>() / nodes.len() as f64;
        println!("{x}: {found:e} {:.2} %", 100.0 * (found / expected - 1.0));
        assert!((found / expected - 1.0).abs() < 5e-3, "{x}: {found:e}");
    }
}

/// A mean over the facets of three contacts was judged by each of them: no step was certified.
#[test]
fn a_floor_told_in_three_contacts_is_that_told_in_one() {
    let third = |k: u32| FacetTag(90 + k);
    let cut = |[x, ..]: [f64; 3], [east, _, up]: [f64; 3]| match (east.round(), up.round()) {
        (_, -1.0) => Some(third(x as u32)),
        (_, 1.0) => Some(brick::Z_MAX),
        (-1.0, _) => Some(brick::X_MIN),
        (1.0, _) => Some(brick::X_MAX),
        _ => None,
    };
    let mesh = quadratic([3.0, 1.0, 1.0], [6, 2, 2]).tag_boundary(cut);
    for friction in [Friction::None, Friction::coulomb(0.2)] {
        let scene = |floor: &[&[u32]]| {
            let clamped = Scene::new(mesh.clone(), steel())
                .with_support(Support::fixed(brick::X_MIN))
                .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e8]))
                .with_load(Load::traction(brick::X_MAX, [3e8, 0.0, -5e8]));
            floor.iter().fold(clamped, |scene, tags| {
                let contact = Contact::rigid(third(tags[0])).with_friction(friction.clone());
                scene.with_contact(tags[1..].iter().fold(contact, |c, k| c.with_tag(third(*k))))
            })
        };
        let [one, three, two] = [&[&[0, 1, 2][..]][..], &[&[0], &[1], &[2]], &[&[0], &[1, 2]]]
            .map(|floor| solve(scene(floor), Settings::default()));
        for (told, what) in [(&three, "in three"), (&two, "in two")] {
            assert_certified(told, what);
            assert_close(&told.displacement, &one.displacement, 1e-6, what);
            assert_eq!(told.report.counters.products, one.report.counters.products);
        }
    }
}

/// A clamped bar that bends under its end load: it neither locks nor needs many products as it becomes incompressible.
#[test]
fn a_bar_of_rubber_bends_as_it_should() {
    let mut deflections = Vec::new();
    for poisson in [0.3, 0.499, 0.4999] {
        let mesh = quadratic([4.0, 1.0, 1.0], [8, 2, 2]);
        let tip = mesh
            .points()
            .iter()
            .position(|p| *p == [4.0, 1.0, 1.0])
            .expect("a corner");
        let scene = Scene::new(mesh, uniform(1e9, poisson))
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::X_MAX, [0.0, 0.0, -1e5]))
            .with_boxes([4, 1, 1]);
        let result = solve(scene, at(1e-6));
        deflections.push((
            poisson,
            -result.displacement[3 * tip + 2],
            result.report.counters.products,
        ));
    }
    println!("{deflections:?}");
    let [(_, soft, few), rubber @ ..] = &deflections[..] else {
        panic!()
    };
    for (poisson, deflection, products) in rubber {
        // bending does not depend on Poisson's ratio, clamping and shear by some per cent
        assert!(
            (deflection / soft - 1.0).abs() < 0.05,
            "{poisson}: {deflection:e} {soft:e}"
        );
        assert!(*products as f64 <= 2.5 * *few as f64, "{poisson}: {products} {few}");
    }
}

/// Bits do not hang on threads, and the answer not on units: half loaded, in millimetres and with forces in kN.
#[test]
fn threads_and_units_change_nothing() {
    let run_with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("pool");
        pool.install(|| {
            solve(
                half_loaded(quadratic([3.0, 1.0, 1.0], [6, 2, 2])).with_boxes([3, 1, 1]),
                at(1e-9),
            )
        })
    };
    let one = run_with(1);
    let bits = |result: &Solved| result.displacement.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&one), bits(&run_with(3)));
    let (length, force) = (1e3, 1e-3);
    let stress = force / (length * length);
    let q = 0.5e8 * stress;
    let floor = Contact::rigid(brick::Z_MIN).with_gap(0.1 * length);
    let scene = Scene::new(
        quadratic([3.0 * length, length, length], [6, 2, 2]),
        uniform(211.9e9 * stress, 0.277),
    )
    .with_support(Support::fixed(brick::X_MIN))
    .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -30.0 * q]))
    .with_load(Load::traction(brick::X_MAX, [9.0 * q, 0.0, -15.0 * q]))
    .with_contact(floor.with_friction(Friction::coulomb(0.2)))
    .with_boxes([3, 1, 1]);
    let other = solve(scene, at(1e-9));
    let metres: Vec<f64> = other.displacement.iter().map(|v| v / length).collect();
    assert_close(&metres, &one.displacement, 1e-7, "units");
    let newtons = floor_forces(&other).map(|f| f / force);
    assert_close(&newtons, &floor_forces(&one), 1e-7, "units");
}

/// Pressed into a corner of three walls, which alone hold it: hydrostatic pressure at each point, edges and the corner
/// too, with tetrahedra a hundred times as long as thick as well.
#[test]
fn corners_edges_and_slivers_pass_hydrostatic_pressure() {
    let (young, poisson, pressure) = (1e6, 0.3, 1e3);
    let strain = -(1.0 - 2.0 * poisson) * pressure / young;
    for thin in [1.0, 0.01] {
        let mesh = block([1.0; 3], [2; 3]);
        // the middle layer of nodes goes down to the floor
        let mesh = mesh.map_points(|[x, y, z]| [x, y, if z == 0.5 { 0.5 * thin } else { z }]);
        let mesh = mesh.expect("flat").raise_order().expect("quadratic");
        let mut scene = Scene::new(mesh.clone(), uniform(young, poisson));
        for (wall, loaded) in [
            (brick::X_MIN, brick::X_MAX),
            (brick::Y_MIN, brick::Y_MAX),
            (brick::Z_MIN, brick::Z_MAX),
        ] {
            scene = scene.with_contact(Contact::rigid(wall));
            scene = scene.with_load(Load::pressure(loaded, pressure));
        }
        let result = solve(scene, at(1e-10));
        let exact: Vec<f64> = mesh.points().iter().flatten().map(|c| strain * c).collect();
        assert_close(&result.displacement, &exact, 1e-6, "displacement");
        assert_eq!(result.points.iter().filter(|p| p.node == 0).count(), 3);
        assert_pressure(&result.points, pressure, 1e-5, &thin.to_string());
    }
}

/// What a moving support does to mid-nodes beside a contact point is part of its slip, in the memory of the process,
/// too.
#[test]
fn slip_beside_a_moving_support_is_that_of_the_displacement() {
    let pull = History::table(vec![(0.0, 0.0), (0.5, 1.0), (1.0, -0.5)]).expect("a table");
    let scene = Scene::new(quadratic([3.0, 1.0, 1.0], [6, 2, 2]), steel())
        .with_support(Support::fixed(brick::X_MIN).with_motion([2e-3, 1e-3, 0.0], pull))
        .with_load(Load::pressure(brick::Z_MAX, 1e8))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.2)))
        .with_analysis(Analysis::quasistatic(1.0, 4));
    let mut simulation = Simulation::new(scene, tight()).expect("model");
    let mut last = vec![[0.0; 3]; simulation.scene().mesh().points().len()];
    while !simulation.is_finished() {
        let result = simulation.step().expect("step");
        assert!(result.report().status.converged());
        let now = result.displacement();
        for (state, point) in result.points().iter().zip(simulation.constrained_points()) {
            let slip = |c: usize| -> f64 {
                let nodes = point.nodes();
                nodes.map(|(n, w)| w * (now[n as usize][c] - last[n as usize][c])).sum()
            };
            let along = |c: usize| -> f64 {
                let nodes = point.nodes();
                nodes.map(|(n, w)| w * now[n as usize][c]).sum()
            };
            for c in [0, 1] {
                assert!(
                    (state.difference[c] - slip(c)).abs() < 1e-9,
                    "{:?} {:?}",
                    point.position(),
                    state
                );
                assert!((state.tangential_displacement[c] - along(c)).abs() < 1e-9, "{state:?}");
            }
            let loss = (0..2).map(|c| state.friction_force[c] * slip(c)).sum::<f64>();
            assert!(loss <= 1e-12 * state.normal_force.abs(), "{loss:e}");
        }
        last = now;
    }
}

/// An obstacle that turns is, for each point, where it is for the nodes that the point is the mean of: gaps to a floor
/// that tilts, the way past a disc.
#[test]
fn obstacles_turn_past_the_nodes_of_a_point() {
    let (angle, height) = (2e-3, 0.01);
    let turned = |axis: [f64; 3], gap: f64| {
        let floor = Obstacle::half_space([0.0, 0.0, -gap], [0.0, 0.0, 1.0]);
        let contact = Contact::obstacle(brick::Z_MIN, floor).with_friction(Friction::coulomb(0.3));
        let scene = Scene::new(quadratic([3.0, 1.0, 1.0], [6, 2, 2]), steel())
            .with_support(Support::fixed(brick::Z_MAX))
            .with_contact(contact.with_rotation([0.0; 3], axis, History::constant(angle)));
        let mut simulation = Simulation::new(scene, tight()).expect("model");
        (simulation.step().expect("step"), simulation)
    };
    let mean = |simulation: &Simulation, k: usize, f: &dyn Fn([f64; 3]) -> f64| -> f64 {
        let places = simulation.scene().mesh().points();
        let nodes = simulation.constrained_points()[k].nodes();
        nodes.map(|(n, w)| w * f(places[n as usize])).sum()
    };
    let (tilted, simulation) = turned([0.0, 1.0, 0.0], height);
    assert_eq!(tilted.summary().active, 0);
    let distance = |[x, _, z]: [f64; 3]| z * angle.cos() + x * angle.sin() + height;
    for (k, point) in tilted.points().iter().enumerate() {
        assert!((point.gap - mean(&simulation, k, &distance)).abs() < 1e-12, "{point:?}");
    }
    let (dragged, simulation) = turned([0.0, 0.0, 1.0], 1.0);
    for (k, point) in dragged.points().iter().enumerate() {
        let way = [
            mean(&simulation, k, &|x| angle * x[1]),
            -mean(&simulation, k, &|x| angle * x[0]),
        ];
        let found = point.difference;
        assert!((0..2).all(|c| (found[c] - way[c]).abs() < 1e-12), "{found:?} {way:?}");
    }
}

/// Without contact conjugate gradients have one set only, and do not begin anew: that took 4,789 products.
#[test]
fn a_thin_plate_of_tiny_parts_does_not_begin_anew() {
    let mesh = block([12.0, 12.0, 0.05], [12, 12, 1]).raise_order().expect("order 2");
    let scene = Scene::new(mesh, uniform(1e9, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 1.0))
        .with_subdomains(72);
    let result = solve(scene, Settings::default());
    let products = result.report.counters.products;
    assert!(products < 4000, "{products}");
}
