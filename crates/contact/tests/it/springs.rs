//! Elastic foundations: closed forms, a dense solution of the stiffness with springs, reactions, refusals.

use crate::common::*;
use signorini_fem_mesh::assemble_stiffness;

const YOUNG: f64 = 2e11;
const GROUND: f64 = 3e11;
const PRESSURE: f64 = 1e8;

/// Nodes, areas and normals of a tag, from the coordinates alone.
pub(crate) fn facets(mesh: &TetMesh, tag: FacetTag) -> Vec<([u32; 3], f64, [f64; 3])> {
    let surface = Surface::new(mesh, &[tag]).expect("surface");
    let triangles = surface.triangles().iter();
    triangles
        .map(|t| {
            let nodes = t.map(|k| surface.nodes()[k as usize]);
            let [a, b, c] = nodes.map(|n| mesh.points()[n as usize]);
            let [u, v] = [b, c].map(|x| [0, 1, 2].map(|k| x[k] - a[k]));
            let cross = [0, 1, 2].map(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
            let length = cross.iter().map(|x| x * x).sum::<f64>().sqrt();
            (nodes, length / 2.0, cross.map(|x| x / length))
        })
        .collect()
}

/// A block on springs: some supports, oblique loads, two foundations that share an edge.
fn block_on_springs(factor: f64) -> Scene {
    let mesh = Brick::new([2.0, 1.0, 1.0], [4, 2, 2])
        .perturbed(0.1, 3)
        .build()
        .expect("brick");
    Scene::new(mesh, uniform(YOUNG, 0.3))
        .with_support(Support::components(brick::X_MIN, [false, true, false]))
        .with_spring(Spring::components(
            brick::Z_MIN,
            [GROUND, 0.5 * GROUND, 2.0 * GROUND].map(|k| factor * k),
        ))
        .with_spring(Spring::normal(brick::X_MIN, factor * GROUND))
        .with_load(Load::traction(brick::Z_MAX, [3e7, 1e7, -1e8]))
        .with_load(Load::traction(brick::X_MAX, [2e7, -4e7, 1e7]))
}

/// The dense stiffness with springs and supports, solved: another route.
fn direct(factor: f64) -> Vec<f64> {
    let scene = block_on_springs(factor);
    let mesh = scene.mesh();
    let hooke = Hooke::isotropic(YOUNG, 0.3).expect("Hooke");
    let whole = Decomposition::whole(mesh);
    let n = 3 * mesh.points().len();
    let mut force = vec![0.0; n];
    for (tag, traction) in [(brick::Z_MAX, [3e7, 1e7, -1e8]), (brick::X_MAX, [2e7, -4e7, 1e7])] {
        let local = assemble_load(mesh, &whole, &LoadDensity::Traction(tag, traction));
        force
            .iter_mut()
            .zip(&local.expect("load")[0])
            .for_each(|(f, l)| *f += l);
    }
    let mut matrix = vec![vec![0.0; n]; n];
    let stiffness = assemble_stiffness(mesh.points(), mesh.tets(), |_| &hooke).expect("stiffness");
    for (&value, (i, j)) in stiffness.iter() {
        matrix[i][j] += value;
    }
    let ground = factor * GROUND;
    for (nodes, area, _) in facets(mesh, brick::Z_MIN) {
        for node in nodes {
            for (c, k) in [ground, 0.5 * ground, 2.0 * ground].into_iter().enumerate() {
                matrix[3 * node as usize + c][3 * node as usize + c] += k * area / 3.0;
            }
        }
    }
    for (nodes, area, normal) in facets(mesh, brick::X_MIN) {
        for node in nodes {
            for (a, b) in (0..3).flat_map(|a| (0..3).map(move |b| (a, b))) {
                let k = ground * area / 3.0 * normal[a] * normal[b];
                matrix[3 * node as usize + a][3 * node as usize + b] += k;
            }
        }
    }
    // held sideways: the rows of those unknowns are replaced
    for node in mesh.nodes_on(brick::X_MIN) {
        let i = 3 * node as usize + 1;
        for j in 0..n {
            (matrix[i][j], matrix[j][i]) = (0.0, 0.0);
        }
        matrix[i][i] = YOUNG;
        force[i] = 0.0;
    }
    cholesky_solve(matrix, &force)
}

/// Soft and stiff springs, any cut and both preconditioners: the solution of the dense system, in few products.
#[test]
fn springs_are_part_of_the_stiffness() {
    for (factor, most) in [(1e-6, 90), (1.0, 90), (1e6, 90)] {
        let exact = direct(factor);
        for boxes in [[1, 1, 1], [4, 1, 1], [4, 2, 2]] {
            for preconditioner in [Preconditioner::Lumped, Preconditioner::Dirichlet] {
                let what = format!("{factor} {boxes:?} {preconditioner:?}");
                let settings = at(1e-10).with_preconditioner(preconditioner);
                let result = solve(block_on_springs(factor).with_boxes(boxes), settings);
                assert_close(&result.displacement, &exact, 1e-8, &what);
                let products = result.report.counters.products;
                assert!(products <= most, "{what}: {products} products");
            }
        }
    }
}

/// Forces of each foundation are its stiffness times the displacement, also where two share an edge.
#[test]
fn reactions_are_those_of_each_foundation() {
    let mut simulation = Simulation::new(block_on_springs(1.0).with_boxes([2, 1, 1]), at(1e-10)).expect("set-up");
    let result = simulation.step().expect("step");
    let (u, mesh) = (result.displacement(), result.scene().mesh());
    let reactions = result.reactions();
    let mut expected = [[0.0; 3]; 2];
    for (nodes, area, _) in facets(mesh, brick::Z_MIN) {
        for node in nodes {
            for (c, k) in [1.0, 0.5, 2.0].into_iter().enumerate() {
                // held sideways along y at x = 0
                let free = c != 1 || mesh.points()[node as usize][0] > 0.0;
                let force = if free { k * GROUND * area / 3.0 * u[node as usize][c] } else { 0.0 };
                expected[0][c] -= force;
            }
        }
    }
    for (nodes, area, _) in facets(mesh, brick::X_MIN) {
        for node in nodes {
            expected[1][0] -= GROUND * area / 3.0 * u[node as usize][0];
        }
    }
    for (reaction, expected) in reactions.springs.iter().zip(expected) {
        for (a, b) in reaction.resultant.force.iter().zip(expected) {
            assert!((a - b).abs() < 1e-6 * PRESSURE, "{a} {b}");
        }
    }
    assert!(reactions.imbalance().force.iter().all(|f| f.abs() < 1e-6 * PRESSURE));
}

/// A column on springs is pressed through them and along itself; it is lifted as well.
#[test]
fn a_column_stands_on_its_foundation() {
    for sign in [1.0, -1.0] {
        let mesh = Brick::new([1.0, 1.0, 2.0], [2, 2, 4]).build().expect("brick");
        let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.3))
            .with_support(Support::components(brick::X_MIN, [true, false, false]))
            .with_support(Support::components(brick::Y_MIN, [false, true, false]))
            .with_spring(Spring::normal(brick::Z_MIN, GROUND))
            .with_load(Load::pressure(brick::Z_MAX, sign * PRESSURE))
            .with_boxes([1, 1, 2]);
        let mut simulation = Simulation::new(scene, tight()).expect("set-up");
        assert!(simulation.plan().effects.springs && simulation.plan().to_string().contains("with springs"));
        assert_eq!(simulation.plan().dual(), simulation.tfeti().dual_dim());
        let result = simulation.step().expect("step");
        let exact = |z: f64| -sign * PRESSURE * (1.0 / GROUND + z / YOUNG);
        for (u, x) in result.displacement().iter().zip(mesh.points()) {
            assert!((u[2] - exact(x[2])).abs() < 1e-8 * exact(2.0).abs(), "{u:?} at {x:?}");
        }
        let reactions = result.reactions_about([0.5, 0.5, 0.0]);
        let ground = reactions.springs[0].resultant;
        assert!((ground.force[2] - sign * PRESSURE).abs() < 1e-7 * PRESSURE);
        assert!(ground.moment.iter().all(|m| m.abs() < 1e-7 * PRESSURE));
        let left = reactions.imbalance();
        assert!(
            left.force.iter().chain(&left.moment).all(|f| f.abs() < 1e-7 * PRESSURE),
            "{left:?}"
        );
        assert_eq!(reactions.springs[0].nodes.len(), 9);
    }
}

/// Between a floor that rises and its foundation a column has the force of both compliances.
#[test]
fn a_column_between_a_floor_and_springs() {
    for method in [Method::default(), Method::paper()] {
        let mesh = Brick::new([1.0, 1.0, 2.0], [2, 2, 4]).build().expect("brick");
        let scene = Scene::new(mesh, uniform(YOUNG, 0.3))
            .with_support(Support::components(brick::X_MIN, [true, false, false]))
            .with_support(Support::components(brick::Y_MIN, [false, true, false]))
            .with_spring(Spring::components(brick::Z_MAX, [0.0, 0.0, GROUND]))
            .with_contact(Contact::rigid(brick::Z_MIN).with_gap(-1e-3).with_gap_history(ramp()))
            .with_boxes([1, 1, 2])
            .with_analysis(Analysis::quasistatic(1.0, 2));
        let (_, results) = run(scene, by(method).with_tolerance(1e-8));
        for (result, fit) in results.iter().zip([0.5e-3, 1e-3]) {
            let force = fit / (1.0 / GROUND + 2.0 / YOUNG);
            assert!((result.summary.normal_force - force).abs() < 1e-6 * force);
        }
    }
}

/// A brick pressed on a rough floor and pulled along it, on springs at `tag`.
fn rubbing(tag: FacetTag, ground: f64) -> Scene {
    rough().with_spring(Spring::components(tag, [ground; 3]))
}

fn rough() -> Scene {
    Scene::new(block([3.0, 1.0, 1.0], [6, 2, 2]), uniform(YOUNG, 0.3))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
        .with_load(Load::body([0.0, 0.0, -PRESSURE]).with_history(ramp()))
        .with_load(Load::traction(brick::X_MAX, [0.6 * PRESSURE, 0.0, 0.0]).with_history(ramp()))
        .with_analysis(Analysis::quasistatic(1.0, 3))
}

/// Springs away from the contact, soft and stiff, and beside it, where nodes in the edge have both: any cut gives the
/// same, in balance.
#[test]
fn springs_and_rough_contact() {
    let far = [1e-4, 1.0, 1e5].map(|factor| (brick::Z_MAX, factor));
    let beside = [1e-2, 1.0, 10.0].map(|factor| (brick::X_MIN, factor));
    for (tag, factor) in far.into_iter().chain(beside) {
        let mut known: Option<Vec<f64>> = None;
        for boxes in [[1, 1, 1], [3, 1, 1], [6, 2, 2]] {
            let (simulation, results) = run(rubbing(tag, factor * GROUND).with_boxes(boxes), at(1e-9));
            let last = results.last().expect("steps");
            let what = format!("{tag:?} {factor:e} {boxes:?}");
            assert!(last.summary.slip > 0 && last.summary.active > 10, "{what}");
            let products = simulation.counters().products;
            assert!(products < 250, "{what}: {products}");
            let u = &last.displacement;
            match &known {
                Some(known) => assert_close(u, known, 1e-5, &what),
                None => known = Some(u.clone()),
            }
            let result = simulation.result().expect("a step");
            let left = result.reactions().imbalance().force;
            assert!(left.iter().all(|f| f.abs() < 1e-6 * PRESSURE), "{what} {left:?}");
        }
    }
}

/// Bodies meshed apart on a foundation whose nodes contact has, too: any cut gives the same.
#[test]
fn springs_beside_bodies_meshed_apart() {
    for factor in [1.0, 1e3] {
        let mut known: Option<Vec<f64>> = None;
        for boxes in [[1, 1, 2], [2, 2, 2]] {
            let mesh = with_second(&block([1.0; 3], [4; 3]), &lifted(&block([1.0; 3], [3; 3]), 1.0));
            let scene = Scene::new(mesh, uniform(YOUNG, 0.3))
                .with_support(Support::fixed(brick::Z_MIN))
                .with_spring(Spring::components(second(brick::X_MIN), [factor * GROUND; 3]))
                .with_load(Load::traction(second(brick::Z_MAX), [0.2 * PRESSURE, 0.0, -PRESSURE]))
                .with_contact(
                    Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(Friction::coulomb(0.3)),
                )
                .with_boxes(boxes);
            let result = solve(scene, at(1e-9));
            let what = format!("{factor:e} {boxes:?}");
            let u = &result.displacement;
            match &known {
                Some(known) => assert_close(u, known, 1e-6, &what),
                None => known = Some(u.clone()),
            }
        }
    }
}

#[test]
fn stiff_springs_hold_like_supports() {
    let (_, held) = run(rough().with_support(Support::fixed(brick::Z_MAX)), at(1e-9));
    let (_, stiff) = run(rubbing(brick::Z_MAX, 1e7 * GROUND), at(1e-9));
    assert_close(&stiff[2].displacement, &held[2].displacement, 1e-4, "stiff springs");
}

/// The estimate of the algebraic error holds, and a run continues with the same bits.
#[test]
fn estimates_and_states_know_springs() {
    let exact = run(rubbing(brick::X_MIN, GROUND).with_boxes([3, 1, 1]), at(1e-10)).1;
    let loose = Settings::default().with_accuracy(Accuracy::Relative(1e-3));
    let new = || Simulation::new(rubbing(brick::X_MIN, GROUND).with_boxes([3, 1, 1]), loose.clone()).expect("set-up");
    let mut simulation = new();
    let mut states = Vec::new();
    for exact in &exact {
        states.push(simulation.state().clone());
        let result = simulation.step().expect("step");
        assert!(result.report().status.converged());
        let error = result.algebraic_error();
        assert!(error.relative() < 1e-2, "{error:?}");
        let scene = result.scene();
        let u = result.displacement().into_flattened();
        let difference: Vec<f64> = u.iter().zip(&exact.displacement).map(|(a, b)| a - b).collect();
        let energy = fields::strain_energy(scene.mesh(), scene.materials(), &difference).expect("energy");
        let whole = fields::strain_energy(scene.mesh(), scene.materials(), &u).expect("energy");
        assert!((energy / whole).sqrt() < 3e-3, "{}", (energy / whole).sqrt());
    }
    let mut again = new();
    again.resume(states[2].clone()).expect("resume");
    let _ = again.run(&mut Silent).expect("run");
    assert!(again.state() == simulation.state());
}

#[test]
fn wrong_springs_are_refused() {
    let refused = |spring: Spring| {
        let scene = block_on_springs(1.0).with_spring(spring);
        Simulation::new(scene, Settings::default())
            .map(|_| ())
            .expect_err("refused")
            .to_string()
    };
    for bad in [-1.0, f64::NAN, f64::INFINITY, 0.0] {
        let text = refused(Spring::normal(brick::Y_MAX, bad));
        assert!(text.contains("spring 2: its stiffness"), "{text}");
    }
    assert!(refused(Spring::components(brick::Y_MAX, [1.0, -2.0, 1.0])).contains("stiffness is -2;"));
    let text = refused(Spring::along(vec![3], [1.0, 0.0, 0.0], 1e200));
    assert!(text.contains("spring 2 at node 3: its stiffness: 1e200"), "{text}");
    let text = refused(Spring::normal(FacetTag(99), 1.0));
    assert!(text.contains("spring 2: no facet has the tag 99"), "{text}");
    // along the normal alone it can turn
    let loose = Scene::new(block([1.0; 3], [2; 3]), uniform(YOUNG, 0.3))
        .with_spring(Spring::normal(brick::Z_MIN, GROUND))
        .with_load(Load::traction(brick::Z_MAX, [1e5, 0.0, 0.0]));
    let error = Simulation::new(loose, Settings::default())
        .map(|_| ())
        .expect_err("not held");
    assert!(matches!(error, ContactError::NotHeld { .. }), "{error}");
}

/// Uniform stress passes into the ground exactly, in meshes of either order.
#[test]
fn a_column_stands_evenly() {
    let linear = block([1.0, 1.0, 2.0], [3, 2, 2]);
    let quadratic = linear.raise_order().expect("order 2");
    for mesh in [linear, quadratic] {
        let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.0))
            .with_spring(Spring::components(brick::Z_MIN, [GROUND; 3]))
            .with_load(Load::pressure(brick::Z_MAX, PRESSURE))
            .with_boxes([1, 1, 2]);
        let result = solve(scene, tight());
        for (place, u) in mesh.points().iter().zip(result.displacement.chunks(3)) {
            let exact = -PRESSURE / GROUND - PRESSURE / YOUNG * place[2];
            assert!((u[2] - exact).abs() < 1e-8 * exact.abs(), "{} {exact}", u[2]);
        }
    }
}

/// Springs at nodes that have their shares of the areas are the foundation; each has a reaction of its own.
#[test]
fn springs_at_nodes_are_the_foundation() {
    let foundation = block_on_springs(1.0);
    let mut springs = Vec::new();
    for (nodes, area, normal) in facets(foundation.mesh(), brick::Z_MIN) {
        assert!(normal[2] < 0.0);
        for (k, stiffness) in [GROUND, 0.5 * GROUND, 2.0 * GROUND].into_iter().enumerate() {
            // of any length
            let mut direction = [0.0; 3];
            direction[k] = -3.0;
            springs.push(Spring::along(nodes.to_vec(), direction, stiffness * area / 3.0));
        }
    }
    let mut scene = Scene::new(foundation.mesh().clone(), uniform(YOUNG, 0.3))
        .with_support(Support::components(brick::X_MIN, [false, true, false]))
        .with_spring(Spring::normal(brick::X_MIN, GROUND))
        .with_load(Load::traction(brick::Z_MAX, [3e7, 1e7, -1e8]))
        .with_load(Load::traction(brick::X_MAX, [2e7, -4e7, 1e7]));
    scene = springs.into_iter().fold(scene, Scene::with_spring);
    let solved = |scene: Scene| {
        let (simulation, mut results) = run(scene.with_boxes([2, 1, 2]), tight());
        let reactions = simulation.result().expect("a step").reactions();
        (results.remove(0), reactions)
    };
    let ((own, sprung), (expected, founded)) = (solved(scene), solved(foundation));
    assert_eq!(own.report.counters, expected.report.counters);
    assert_close(&own.displacement, &expected.displacement, 1e-9, "displacement");
    // the first is that at the other face
    let mut sum = Resultant::default();
    sprung.springs[1..].iter().for_each(|spring| sum += spring.resultant);
    assert_close(&sum.force, &founded.springs[0].resultant.force, 1e-7, "force");
    assert_close(&sum.moment, &founded.springs[0].resultant.moment, 1e-7, "moment");
    for (bad, text) in [
        (Spring::along(vec![], [1.0, 0.0, 0.0], 1.0), "no nodes"),
        (Spring::along(vec![99_999], [1.0, 0.0, 0.0], 1.0), "numbered from 0"),
        (Spring::along(vec![0], [0.0; 3], 1.0), "no length"),
        (Spring::along(vec![0], [f64::NAN, 0.0, 0.0], 1.0), "no length"),
        (Spring::along(vec![0], [1.0, 0.0, 0.0], -1.0), "stiffness is -1"),
    ] {
        let scene = block_on_springs(1.0).with_spring(bad);
        let error = Simulation::new(scene, Settings::default())
            .expect_err("refused")
            .to_string();
        assert!(error.starts_with("spring 2:") && error.contains(text), "{error}");
    }
}

/// A spring that is soft beside another one of the scene is there all the same: one of less than 1e-12 of the stiffest
/// had no row, and a block that it alone held was said not to be held.
#[test]
fn soft_springs_count_beside_stiff_ones() {
    let solved = |link: f64| {
        let mesh = with_second(&block([1.0; 3], [1; 3]), &lifted(&block([1.0; 3], [1; 3]), 5.0));
        let scene = Scene::new(mesh, uniform(1e3, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_spring(Spring::components(brick::Z_MAX, [link; 3]))
            .with_spring(Spring::components(second(brick::Z_MIN), [1e-3; 3]))
            .with_load(Load::force(second(brick::Z_MAX), [0.0, 0.0, 1e-6]));
        solve(scene, Settings::default())
    };
    let [near, far] = [1e-3, 1e10].map(solved);
    let mean = |of: &Solved| of.displacement[3 * 8..].chunks_exact(3).map(|u| u[2]).sum::<f64>() / 8.0;
    assert!((mean(&near) / 1e-3 - 1.0).abs() < 1e-2, "{}", mean(&near));
    assert!((mean(&far) / mean(&near) - 1.0).abs() < 1e-6, "{}", mean(&far));
}

/// What springs pull is no reaction of supports.
#[test]
fn fields_of_reactions_have_no_springs() {
    let scene = block_on_springs(1.0).with_support(Support::components(vec![0, 1], [true, false, false]));
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    let result = simulation.step().expect("step");
    let mut at_supports = vec![[0.0; 3]; result.displacement().len()];
    for support in &result.reactions().supports {
        for node in &support.nodes {
            (0..3).for_each(|c| at_supports[node.node as usize][c] += node.force[c]);
        }
    }
    let size = norm(at_supports.as_flattened());
    assert!(size > 0.0 && distance(result.reaction_field().as_flattened(), at_supports.as_flattened()) < 1e-9);
}

/// A block with inclined springs at an edge, where a support holds z.
fn inclined(support: impl Fn(Vec<u32>) -> Support, steps: usize) -> (Scene, Vec<u32>) {
    let mesh = block([1.0; 3], [2; 3]);
    let place = |n: &u32| mesh.points()[*n as usize];
    let edge: Vec<u32> = mesh
        .nodes_on(brick::X_MAX)
        .into_iter()
        .filter(|n| place(n)[2] == 1.0)
        .collect();
    let scene = Scene::new(mesh, uniform(YOUNG, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_support(support(edge.clone()))
        .with_spring(Spring::along(edge.clone(), [1.0, 0.0, 1.0], YOUNG))
        .with_load(Load::traction(brick::X_MAX, [1e8, 0.0, 5e7]).with_history(ramp()))
        .with_analysis(Analysis::quasistatic(steps as f64, steps));
    (scene, edge)
}

/// A spring that is inclined pulls along x by what a support moves along z, too: beside the dense system.
#[test]
fn inclined_springs_feel_what_supports_move() {
    let (lift, half) = (1e-3, 0.5 * YOUNG);
    let up = |edge| Support::components(edge, [false, false, true]).with_motion([0.0, 0.0, lift], ramp());
    let (scene, edge) = inclined(up, 1);
    let mesh = scene.mesh().clone();
    let n = 3 * mesh.points().len();
    let load = LoadDensity::Traction(brick::X_MAX, [1e8, 0.0, 5e7]);
    let mut force = assemble_load(&mesh, &Decomposition::whole(&mesh), &load)
        .expect("load")
        .remove(0);
    let mut matrix = vec![vec![0.0; n]; n];
    let hooke = Hooke::isotropic(YOUNG, 0.3).expect("Hooke");
    let stiffness = assemble_stiffness(mesh.points(), mesh.tets(), |_| &hooke).expect("stiffness");
    stiffness.iter().for_each(|(&value, (i, j))| matrix[i][j] += value);
    for x in edge.iter().map(|n| 3 * *n as usize) {
        for (i, j) in [(x, x), (x, x + 2), (x + 2, x), (x + 2, x + 2)] {
            matrix[i][j] += half;
        }
    }
    let held = mesh
        .nodes_on(brick::X_MIN)
        .into_iter()
        .flat_map(|n| [0, 1, 2].map(|c| (3 * n as usize + c, 0.0)));
    let held: Vec<(usize, f64)> = held.chain(edge.iter().map(|n| (3 * *n as usize + 2, lift))).collect();
    for &(i, value) in &held {
        for j in 0..n {
            force[j] -= matrix[j][i] * value;
            (matrix[i][j], matrix[j][i]) = (0.0, 0.0);
        }
        matrix[i][i] = YOUNG;
    }
    held.iter().for_each(|&(i, value)| force[i] = YOUNG * value);
    let exact = cholesky_solve(matrix, &force);
    for boxes in [[1, 1, 1], [2, 1, 2]] {
        let mut simulation = Simulation::new(scene.clone().with_boxes(boxes), tight()).expect("set-up");
        let result = simulation.step().expect("step");
        assert_close(&result.displacement().into_flattened(), &exact, 1e-8, "dense");
        let reactions = result.reactions();
        let way: f64 = edge.iter().map(|n| exact[3 * *n as usize] + lift).sum();
        let pull = reactions.springs[0].resultant.force;
        assert!((pull[0] / (-half * way) - 1.0).abs() < 1e-7, "{pull:?}");
        assert!(norm(&reactions.imbalance().force) < 1e-6 * norm(&pull));
        let error = result.algebraic_error();
        assert!(error.relative() < 1e-6, "{error:?}");
    }
}

/// The spring pulls on where the support takes over its node: its force along x fell by half.
#[test]
fn inclined_springs_pull_on_where_supports_start() {
    let (scene, _) = inclined(
        |edge| Support::components(edge, [false, false, true]).with_start(1.0),
        2,
    );
    let (_, steps) = run(scene, tight());
    assert_close(&steps[1].displacement, &steps[0].displacement, 1e-7, "held where it is");
}
