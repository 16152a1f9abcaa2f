//! Contact that gives way: closed forms, a penalty method with Newton's method as the other route, the limit of the
//! exact law, any cut, states, estimates, refusals.

use crate::common::*;
use nalgebra::{DMatrix, DVector, Vector3};
use signorini_fem_mesh::assemble_stiffness;

const YOUNG: f64 = 1e9;
const PRESSURE: f64 = 1e6;
/// m/Pa; a cube of unit size has 1e-9.
const GIVES: f64 = 4e-10;

fn contact_floor() -> Contact {
    Contact::rigid(brick::Z_MIN).with_normal_compliance(GIVES)
}

/// A column under pressure, of linear or quadratic elements, on a floor or on another block, meshed alike or not.
fn columns() -> Vec<(&'static str, Scene)> {
    let held = |mesh: TetMesh, top: FacetTag, contact: Contact, tags: &[FacetTag]| {
        let scene = Scene::new(mesh, uniform(YOUNG, 0.3));
        let sides = tags
            .iter()
            .flat_map(|x| [(FacetTag(x.0), 0), (FacetTag(x.0 - brick::X_MIN.0 + brick::Y_MIN.0), 1)]);
        sides
            .fold(scene, |scene, (tag, c)| {
                scene.with_support(Support::components(tag, [c == 0, c == 1, false]))
            })
            .with_load(Load::pressure(top, PRESSURE))
            .with_contact(contact)
    };
    let cells = |n: usize| block([1.0; 3], [n, n, 2]);
    let single = |mesh: TetMesh| held(mesh, brick::Z_MAX, contact_floor(), &[brick::X_MIN]);
    let pair = |lower: TetMesh, upper: TetMesh| {
        let mesh = with_second(&lower, &lifted(&upper, 1.0));
        let contact = Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_normal_compliance(GIVES);
        let tags = [brick::X_MIN, second(brick::X_MIN)];
        held(mesh, second(brick::Z_MAX), contact, &tags)
            .with_support(Support::components(brick::Z_MIN, [false, false, true]))
    };
    let raised = |mesh: TetMesh| mesh.raise_order().expect("order 2");
    vec![
        ("floor", single(cells(3))),
        ("floor, order 2", single(raised(cells(2)))),
        ("pair", pair(cells(3), cells(3))),
        ("pair, order 2", pair(raised(cells(2)), raised(cells(2)))),
        ("apart", pair(cells(2), cells(3))),
        ("apart, order 2", pair(raised(cells(2)), raised(cells(3)))),
    ]
}

/// Uniform pressure closes the gap by compliance times pressure, everywhere, whatever touches and whoever solves.
#[test]
fn a_column_sinks_in_by_its_pressure() {
    for (what, scene) in columns() {
        for method in methods() {
            for boxes in [[1, 1, 1], [2, 1, 2]] {
                let loose = !matches!(method, Method::ActiveSet(_));
                if loose && what.contains("order") {
                    continue;
                }
                let settings = by(method.clone()).with_tolerance(if loose { 1e-7 } else { 1e-10 });
                let result = solve(scene.clone().with_boxes(boxes), settings);
                let near = if loose { 1e-4 } else { 1e-7 };
                for point in &result.points {
                    let pressure = -point.normal_force / point.area;
                    assert!((pressure - PRESSURE).abs() < near * PRESSURE, "{what}: {pressure}");
                    let depth = GIVES * PRESSURE;
                    assert!((point.gap + depth).abs() < near * depth, "{what}: {:e}", point.gap);
                }
                assert!((result.summary.max_penetration - GIVES * PRESSURE).abs() < near * GIVES * PRESSURE);
            }
        }
    }
}

/// A stiff block on a rough floor, pressed and moved to and fro by its top.
fn to_and_fro(method: Method) -> (Vec<f64>, Vec<Solved>) {
    let points = vec![(0.0, 0.0), (1.0, 3.0), (3.0, -3.0), (4.0, 0.5), (5.0, 0.0)];
    let way = History::table(points).expect("history");
    let steps = 20;
    let held = Support::fixed(brick::Z_MAX);
    let contact = contact_floor()
        .with_friction(Friction::coulomb(0.4))
        .with_tangential_compliance(2.0 * GIVES);
    // at rest pressed in already
    let scene = Scene::new(block([1.0; 3], [2, 2, 2]), uniform(1e7 * YOUNG, 0.0))
        .with_support(held.with_motion([GIVES * PRESSURE, 0.0, 0.0], way.clone()))
        .with_contact(contact.with_gap(-GIVES * PRESSURE))
        .with_boxes([2, 1, 1])
        .with_analysis(Analysis::quasistatic(5.0, steps));
    let (_, results) = run(scene, by(method).with_tolerance(1e-8));
    let ways = results.iter().map(|r| way.value(r.time) * GIVES * PRESSURE);
    (ways.collect(), results)
}

/// Friction follows the displacement as a spring, slides at its bound, and goes back along the spring: a loop, whose
/// area is the work of friction.
#[test]
fn elastic_slip_comes_back_and_the_rest_is_lost() {
    for method in [Method::default(), Method::paper()] {
        let (ways, results) = to_and_fro(method);
        let (bound, stiffness) = (0.4 * PRESSURE, 1.0 / (2.0 * GIVES));
        let mut lost = 0.0_f64;
        let mut kinds = [0; 2];
        for (way, result) in ways.into_iter().zip(&results) {
            let trial = stiffness * (way - lost);
            let stress = trial.clamp(-bound, bound);
            let slid = (way - stress / stiffness) - lost;
            lost += slid;
            let friction = result.summary.friction_force[0];
            assert!((friction + stress).abs() < 1e-5 * bound, "{friction} {stress}");
            let work = stress * slid;
            assert!((result.summary.friction_work - work).abs() < 1e-5 * bound * GIVES * PRESSURE);
            assert!((result.summary.dissipation - work).abs() < 1e-5 * bound * GIVES * PRESSURE);
            for point in &result.points {
                let moved = point.tangential_displacement[0];
                assert!((moved - way).abs() < 1e-5 * GIVES * PRESSURE, "{moved} {way}");
                assert!((point.difference[0] - slid).abs() < 1e-5 * GIVES * PRESSURE);
                let slides = point.state == ContactState::Slip;
                kinds[usize::from(slides)] += 1;
                assert_eq!(slides, slid.abs() > 1e-9 * GIVES * PRESSURE, "{trial} {bound}");
            }
        }
        assert!(kinds.iter().all(|k| *k > 50), "{kinds:?}");
    }
}

const STEPS: usize = 6;
const COEFFICIENT: f64 = 0.3;

fn gap(x: [f64; 3]) -> f64 {
    8e-4 * (x[0] - 1.0).powi(2) - 1e-4 * x[1]
}

/// A block that is pressed on a curved rough floor and pulled to and fro: points open, stick and slide.
fn rubbing(compliance: [f64; 2]) -> Scene {
    let mesh = Brick::new([2.0, 1.0, 1.0], [4, 2, 2]).perturbed(0.1, 5).build();
    let contact = Contact::rigid(brick::Z_MIN)
        .with_normal([0.0, 0.0, -1.0])
        .with_gap_field(gap);
    let [pressed, pulled] = histories();
    Scene::new(mesh.expect("brick"), uniform(YOUNG, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, PUSH).with_history(pressed))
        .with_load(Load::traction(brick::X_MAX, PULL).with_history(pulled))
        .with_contact(
            contact
                .with_friction(Friction::coulomb(COEFFICIENT))
                .with_normal_compliance(compliance[0])
                .with_tangential_compliance(compliance[1]),
        )
        .with_analysis(Analysis::quasistatic(1.0, STEPS))
}

const PUSH: [f64; 3] = [0.0, 1e5, -1e6];
const PULL: [f64; 3] = [1e6, 3e5, 0.0];

fn histories() -> [History; 2] {
    let table = |points: &[(f64, f64)]| History::table(points.to_vec()).expect("history");
    [
        table(&[(0.0, 0.0), (0.3, 1.0), (0.8, 1.2), (1.0, 0.2)]),
        table(&[(0.0, 0.0), (0.2, 0.0), (0.5, 1.0), (1.0, -1.0)]),
    ]
}

/// Force of a node of the penalty method on the body, and where it sticks afterwards: `u` its displacement, `old` where
/// it stuck.
fn penalty(u: Vector3<f64>, gap: f64, old: [f64; 2], stiffness: [f64; 2]) -> (Vector3<f64>, [f64; 2]) {
    let normal = stiffness[0] * (-u[2] - gap).max(0.0);
    let trial = [0, 1].map(|c| -stiffness[1] * (u[c] - old[c]));
    let (size, bound) = (trial[0].hypot(trial[1]), COEFFICIENT * normal);
    let share = if size > bound { bound / size } else { 1.0 };
    let friction = trial.map(|t| share * t);
    let stuck = [0, 1].map(|c| u[c] + friction[c] / stiffness[1]);
    (Vector3::new(friction[0], friction[1], normal), stuck)
}

/// The same scene as a code with penalties solves it: dense, primal, Newton's method with return mapping. Displacements
/// of each step.
fn by_penalties(compliance: [f64; 2]) -> Vec<Vec<f64>> {
    let scene = rubbing(compliance);
    let mesh = scene.mesh();
    let n = 3 * mesh.points().len();
    let hooke = Hooke::isotropic(YOUNG, 0.3).expect("Hooke");
    let mut matrix = DMatrix::zeros(n, n);
    let stiffness = assemble_stiffness(mesh.points(), mesh.tets(), |_| &hooke).expect("stiffness");
    for (&value, (i, j)) in stiffness.iter() {
        matrix[(i, j)] += value;
    }
    let whole = Decomposition::whole(mesh);
    let load = |tag, traction| {
        let local = assemble_load(mesh, &whole, &LoadDensity::Traction(tag, traction)).expect("load");
        DVector::from_vec(local[0].clone())
    };
    let loads = [load(brick::Z_MAX, PUSH), load(brick::X_MAX, PULL)];
    let fixed = mesh.nodes_on(brick::X_MIN);
    let surface = Surface::new(mesh, &[brick::Z_MIN]).expect("surface");
    let nodes: Vec<(usize, f64)> = surface
        .nodes()
        .iter()
        .map(|n| *n as usize)
        .zip(surface.areas().iter().copied())
        .collect();
    let mut stuck = vec![[0.0; 2]; nodes.len()];
    let mut u = DVector::zeros(n);
    let mut out = Vec::new();
    for step in 1..=STEPS {
        let time = step as f64 / STEPS as f64;
        let factors = histories().map(|h| h.value(time));
        let force = &loads[0] * factors[0] + &loads[1] * factors[1];
        let at = |u: &DVector<f64>, k: usize| {
            let (node, area) = nodes[k];
            let own: Vector3<f64> = u.fixed_rows::<3>(3 * node).into();
            move |by: Vector3<f64>, old| penalty(own + by, gap(mesh.points()[node]), old, compliance.map(|c| area / c))
        };
        let unbalanced = |u: &DVector<f64>, stuck: &[[f64; 2]]| {
            let mut residual = &force - &matrix * u;
            for (k, &(node, _)) in nodes.iter().enumerate() {
                let own = at(u, k)(Vector3::zeros(), stuck[k]).0;
                (0..3).for_each(|c| residual[3 * node + c] += own[c]);
            }
            for &node in &fixed {
                (0..3).for_each(|c| residual[3 * node as usize + c] = 0.0);
            }
            residual
        };
        let mut rounds = 0;
        loop {
            let residual = unbalanced(&u, &stuck);
            let mut tangent = matrix.clone();
            for (k, &(node, _)) in nodes.iter().enumerate() {
                let here = at(&u, k);
                let base = here(Vector3::zeros(), stuck[k]).0;
                for c in 0..3 {
                    let by = 1e-12;
                    let slope = (here(Vector3::ith(c, by), stuck[k]).0 - base) / by;
                    (0..3).for_each(|i| tangent[(3 * node + i, 3 * node + c)] -= slope[i]);
                }
            }
            for &node in &fixed {
                for c in 3 * node as usize..3 * node as usize + 3 {
                    tangent.row_mut(c).fill(0.0);
                    tangent[(c, c)] = 1.0;
                }
            }
            if residual.norm() < 1e-10 * force.norm() {
                break;
            }
            rounds += 1;
            assert!(rounds < 60, "step {step}: Newton's method does not converge");
            let whole = tangent.lu().solve(&residual).expect("a tangent");
            // shorter where the residual would grow
            let left = |share: f64| norm(unbalanced(&(&u + &whole * share), &stuck).as_slice());
            let shares = (0..12).map(|k| 0.5_f64.powi(k));
            let before = norm(residual.as_slice());
            let share = shares.clone().find(|&s| left(s) < (1.0 - 1e-3 * s) * before);
            u += whole * share.unwrap_or(1.0);
        }
        for k in 0..nodes.len() {
            stuck[k] = at(&u, k)(Vector3::zeros(), stuck[k]).1;
        }
        out.push(u.as_slice().to_vec());
    }
    out
}

/// A penalty method is this law: the same displacements, for any cut and method, from soft to stiff.
#[test]
fn a_penalty_method_solves_the_same_problem() {
    for compliance in [[3e-11, 3e-11], [1e-9, 2e-10], [2e-10, 3e-9]] {
        let known = by_penalties(compliance);
        let mut kinds = [0; 3];
        for boxes in [[1, 1, 1], [3, 1, 1], [4, 2, 2]] {
            let (_, results) = run(rubbing(compliance).with_boxes(boxes), at(1e-9));
            for (k, (result, known)) in results.iter().zip(&known).enumerate() {
                let what = format!("{compliance:?} {boxes:?} step {k}");
                assert_close(&result.displacement, known, 1e-6, &what);
                for (count, state) in
                    kinds
                        .iter_mut()
                        .zip([ContactState::Open, ContactState::Stick, ContactState::Slip])
                {
                    *count += self::count(&result.points, state);
                }
            }
        }
        assert!(kinds.iter().all(|k| *k > 10), "{kinds:?}");
        let (_, paper) = run(
            rubbing(compliance).with_boxes([2, 1, 1]),
            by(Method::paper()).with_tolerance(1e-8),
        );
        assert_close(&paper[STEPS - 1].displacement, &known[STEPS - 1], 1e-5, "paper");
    }
}

/// As compliances go to zero forces come to those of the exact law, in proportion.
#[test]
fn the_limit_is_the_exact_law() {
    let exact = run(rubbing([0.0; 2]).with_boxes([2, 1, 1]), at(1e-10)).1;
    let error = |c: f64| {
        let soft = run(rubbing([c, c]).with_boxes([2, 1, 1]), at(1e-10)).1;
        distance(&soft[2].displacement, &exact[2].displacement)
    };
    let errors = [2e-13, 1e-13, 5e-14].map(error);
    println!("{errors:?}");
    assert!(errors[0] < 5e-3);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 1.0).abs() < 0.1, "{order}");
    }
}

/// Compliances from nothing to far above that of the body cost no more products, in one body and between two whose
/// stiffness differs.
#[test]
fn products_do_not_depend_on_the_compliance() {
    let apart = |compliance: f64| {
        let mesh = with_second(
            &block([1.5, 1.0, 0.5], [6, 4, 2]),
            &lifted(&block([1.0; 3], [3, 3, 3]), 0.5),
        );
        let regions = (0..mesh.tets().len()).map(|t| u32::from(mesh.tet_points(t).iter().all(|p| p[2] >= 0.5)));
        let regions = regions.collect();
        let laws = [(0, 1e3 * YOUNG), (1, YOUNG)].map(|(k, young)| (k, Hooke::isotropic(young, 0.3).expect("Hooke")));
        Scene::new(
            mesh.with_regions(regions).expect("regions"),
            Materials::new(laws.to_vec()).expect("laws"),
        )
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(Load::traction(second(brick::Z_MAX), [2e5, 0.0, -1e6]))
        .with_contact(
            Contact::between(second(brick::Z_MIN), brick::Z_MAX)
                .with_friction(Friction::coulomb(COEFFICIENT))
                .with_normal_compliance(compliance)
                .with_tangential_compliance(compliance),
        )
        .with_boxes([3, 2, 2])
    };
    let alone = |compliance: f64| rubbing([compliance; 2]).with_boxes([4, 2, 2]);
    for (what, scene) in [("one", &alone as &dyn Fn(f64) -> Scene), ("two", &apart)] {
        let counts = [0.0, 1e-14, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-6].map(|c| {
            let (simulation, results) = run(scene(c), at(1e-7));
            assert!(results.iter().all(|r| !r.report.fallback), "{what} {c:e}");
            simulation.counters().products
        });
        println!("{what} {counts:?}");
        assert!(counts.iter().all(|n| 4 * n <= 5 * counts[0] + 20), "{what} {counts:?}");
    }
}

/// Estimates bound the error; a run continues with the same bits, and with another compliance from where it is.
#[test]
fn estimates_and_states_know_compliance() {
    let new = |c: f64, settings: &Settings| {
        Simulation::new(rubbing([c, 2.0 * c]).with_boxes([3, 1, 1]), settings.clone()).expect("set-up")
    };
    let exact = run(rubbing([GIVES, 2.0 * GIVES]).with_boxes([3, 1, 1]), at(1e-11)).1;
    let loose = at(1e-3);
    let mut simulation = new(GIVES, &loose);
    assert!(simulation.plan().effects.compliance && simulation.plan().to_string().contains("gives way"));
    let mut states = Vec::new();
    for (k, exact) in exact.iter().enumerate() {
        states.push(simulation.state().clone());
        let result = simulation.step().expect("step");
        let error = result.algebraic_error();
        let found = energy_distance(
            result.scene(),
            &result.displacement().into_flattened(),
            &exact.displacement,
        );
        let scale = error.scale.sqrt();
        if k == 0 {
            // later steps inherit errors
            assert!(
                found <= error.energy.sqrt() * 1.001 + 1e-7 * scale,
                "{found:e} {:e}",
                error.energy.sqrt()
            );
        }
        assert!(found < 2e-2 * scale && error.relative() < 2e-2, "{error:?}");
    }
    let mut again = new(GIVES, &loose);
    again.resume(states[3].clone()).expect("resume");
    let _ = again.run(&mut Silent).expect("run");
    assert!(again.state() == simulation.state());
    // products that were stored belong to another F
    let mut other = new(2.0 * GIVES, &at(1e-9));
    other.resume(states[3].clone()).expect("resume");
    let _ = other.run(&mut Silent).expect("run").require_converged();
    assert!(other.result().expect("a step").certificate().largest() < 1e-6);
}

#[test]
fn wrong_compliances_are_refused() {
    let with = |contact: Contact| clamped().with_contact(contact);
    for bad in [-1e-9, f64::NAN, f64::INFINITY] {
        for contact in [
            Contact::rigid(brick::Z_MIN).with_normal_compliance(bad),
            Contact::rigid(brick::Z_MIN).with_tangential_compliance(bad),
        ] {
            let text = refused(&with(contact)).to_string();
            assert!(text.starts_with("contact 0: its compliance is"), "{text}");
        }
    }
    let text = refused(&with(Contact::rigid(brick::Z_MIN).with_normal_compliance(1e300))).to_string();
    assert!(
        text.starts_with("contact 0 at node") && text.contains("its compliance"),
        "{text}"
    );
    let tied = Contact::tied(brick::Z_MIN, brick::Z_MAX).with_normal_compliance(1e-9);
    assert!(matches!(refused(&with(tied)), ContactError::Tied { contact: 0 }));
    // one floor, twice
    let two = with(contact_floor()).with_contact(contact_floor().with_normal_compliance(2.0 * GIVES));
    assert!(matches!(refused(&two), ContactError::SharedNode { .. }));
    let two = with(contact_floor()).with_contact(contact_floor().with_gap(1e-3));
    assert!(matches!(refused(&two), ContactError::SharedNode { .. }));
    let two = with(contact_floor()).with_contact(contact_floor());
    assert!(Plan::new(&two, &Settings::default()).is_ok());
}
