//! Helpers of the integration tests: scenes, runs, and small linear algebra of their own.

pub(crate) use rand::RngExt;
use rand_pcg::Pcg64Mcg;
pub(crate) use signorini_contact::report::{AccumulatedError, AlgebraicError, Counters, StepReport};
pub(crate) use signorini_contact::result::{ContactSummary, Reactions, Resultant};
pub(crate) use signorini_contact::*;
pub(crate) use signorini_fem_mesh::{
    Brick, Decomposition, Facet, FacetTag, History, Hooke, LoadDensity, Materials, Surface, TetMesh, assemble_load,
    brick, fields,
};
use signorini_tfeti::Gluing;
use std::collections::BTreeMap;

/// Solves the next step.
pub(crate) fn step(simulation: &mut Simulation) -> Solved {
    let result = simulation.step().expect("step");
    Solved {
        time: result.time(),
        report: result.report().clone(),
        certificate: *result.certificate(),
        summary: *result.summary(),
        points: result.points().to_vec(),
        displacement: result.displacement().into_flattened(),
        torn: result.torn_displacement().to_vec(),
        load: result.reactions().loads.force,
    }
}

/// A result with its fields at hand.
#[derive(Debug, Clone)]
pub(crate) struct Solved {
    pub(crate) time: f64,
    pub(crate) report: StepReport,
    pub(crate) certificate: Certificate,
    pub(crate) summary: ContactSummary,
    pub(crate) points: Vec<PointState>,
    pub(crate) displacement: Vec<f64>,
    pub(crate) torn: Vec<f64>,
    pub(crate) load: [f64; 3],
}

/// Solves all steps that are left.
pub(crate) fn rest(simulation: &mut Simulation) -> Vec<Solved> {
    let mut results = Vec::new();
    while !simulation.is_finished() {
        results.push(step(simulation));
    }
    results
}

/// Solves all steps, each of which must converge with a certificate of at most 1e-6.
pub(crate) fn run(scene: Scene, settings: Settings) -> (Simulation, Vec<Solved>) {
    let mut simulation = Simulation::new(scene, settings).expect("set-up");
    let results = rest(&mut simulation);
    for (k, result) in results.iter().enumerate() {
        assert_certified(result, &format!("step {k}"));
    }
    (simulation, results)
}

/// Solves a scene of one step.
pub(crate) fn solve(scene: Scene, settings: Settings) -> Solved {
    let (_, mut results) = run(scene, settings);
    assert_eq!(results.len(), 1);
    results.remove(0)
}

pub(crate) fn assert_certified(result: &Solved, what: &str) {
    assert!(
        result.report.status.converged() && result.certificate.largest() <= 1e-6,
        "{what}: {:?}, {:?}",
        result.report,
        result.certificate.parts().map(|(n, v)| (n, v.relative()))
    );
}

/// Every point has this pressure, to a relative error.
pub(crate) fn assert_pressure(points: &[PointState], pressure: f64, within: f64, what: &str) {
    for point in points {
        let found = -point.normal_force / point.area;
        assert!(
            (found / pressure - 1.0).abs() < within,
            "{what}: {found:.6e} at {}",
            point.node
        );
    }
}

/// The default method, the paper's and its one inexact loop.
pub(crate) fn methods() -> [Method; 3] {
    [Method::default(), Method::paper(), Method::one_loop()]
}

/// Steps with the paper's difference formula.
pub(crate) fn paper_steps(end: f64, steps: usize) -> Analysis {
    Analysis::quasistatic(end, steps).with_formula(DifferenceFormula::PAPER)
}

/// Random numbers that depend on the seed alone, the same on every machine.
pub(crate) fn random(seed: u64) -> Pcg64Mcg {
    Pcg64Mcg::new(u128::from(seed))
}

pub(crate) fn at(tolerance: f64) -> Settings {
    Settings::default().with_tolerance(tolerance)
}

pub(crate) fn by(method: Method) -> Settings {
    Settings::default().with_method(method)
}

pub(crate) fn tight() -> Settings {
    Settings::default().with_tolerance(1e-10)
}

pub(crate) fn ramp() -> History {
    History::ramp(1.0, 1.0).expect("ramp")
}

/// phi_c of the benchmark.
pub(crate) fn up_down_up() -> History {
    History::table(vec![(0.0, 0.0), (0.4, 1.0), (0.7, 0.0), (1.0, 1.0)]).expect("table")
}

pub(crate) fn uniform(young: f64, poisson: f64) -> Materials {
    Materials::uniform(Hooke::isotropic(young, poisson).expect("Hooke"))
}

pub(crate) fn steel() -> Materials {
    uniform(211.9e9, 0.277)
}

pub(crate) fn block(lengths: [f64; 3], cells: [usize; 3]) -> TetMesh {
    Brick::new(lengths, cells).build().expect("brick")
}

/// The law of the benchmark.
pub(crate) fn weakening() -> Friction {
    Friction::Coulomb(Coefficient::Exponential {
        fixed: 0.3,
        kinetic: 0.1,
        decay: 0.05,
    })
}

/// The benchmark's contact surface with another friction law.
pub(crate) fn foundation(friction: Friction) -> Contact {
    Contact::rigid(brick::Z_MIN).with_gap(0.1).with_friction(friction)
}

/// The brick of the benchmark on a mesh, without contact and analysis.
pub(crate) fn loaded_brick(mesh: TetMesh, traction: History) -> Scene {
    let q = 1e8;
    Scene::new(mesh, steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -30.0 * q]).with_history(ramp()))
        .with_load(Load::traction(brick::X_MAX, [9.0 * q, 0.0, -15.0 * q]).with_history(traction))
}

/// Three steps of the brick with displaced nodes, so that no two subdomains share matrices, on a foundation.
pub(crate) fn perturbed() -> Scene {
    let mesh = Brick::new([3.0, 1.0, 1.0], [12, 4, 4]).perturbed(0.1, 2);
    loaded_brick(mesh.build().expect("brick"), up_down_up())
        .with_contact(foundation(weakening()))
        .with_analysis(paper_steps(1.0, 3))
}

/// A clamped brick pressed and pulled on a rough floor, one step.
pub(crate) fn pressed(cells: usize, friction: Friction) -> Scene {
    pressed_on(block([3.0, 1.0, 1.0], [3 * cells, cells, cells]), friction)
}

pub(crate) fn pressed_on(mesh: TetMesh, friction: Friction) -> Scene {
    Scene::new(mesh, steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 1e8))
        .with_load(Load::traction(brick::X_MAX, [2e8, 0.0, 0.0]))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction))
        .with_boxes([3, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, 1))
}

/// A clamped brick under a light load, for contacts to be added.
pub(crate) fn clamped() -> Scene {
    Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e9, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e5]))
}

/// Tags of a second body.
pub(crate) fn second(tag: FacetTag) -> FacetTag {
    FacetTag(tag.0 + 100)
}

/// A mesh higher up, or lower down.
pub(crate) fn lifted(mesh: &TetMesh, by: f64) -> TetMesh {
    let lift = |[x, y, z]: [f64; 3]| [x, y, z + by];
    mesh.clone().map_points(lift).expect("lifted")
}

/// A second body behind the first, with tags of its own.
pub(crate) fn with_second(first: &TetMesh, other: &TetMesh) -> TetMesh {
    first.append(&other.clone().map_tags(second)).expect("two bodies")
}

/// Why a scene is refused: the plan says the same before any work.
pub(crate) fn refused(scene: &Scene) -> ContactError {
    let planned = Plan::new(scene, &Settings::default()).expect_err("refused by the plan");
    let found = Simulation::new(scene.clone(), Settings::default()).expect_err("refused");
    assert_eq!(planned.to_string(), found.to_string());
    found
}

/// The benchmark with n = 1.
pub(crate) fn benchmark(traction: History, steps: usize) -> Scene {
    loaded_brick(block([3.0, 1.0, 1.0], [15, 5, 5]), traction)
        .with_contact(foundation(weakening()))
        .with_boxes([3, 1, 1])
        .with_analysis(paper_steps(1.0, steps))
}

/// A coarse relative of the benchmark, solved in milliseconds.
pub(crate) fn small_benchmark(friction: Friction, steps: usize) -> Scene {
    loaded_brick(block([3.0, 1.0, 1.0], [6, 2, 2]), up_down_up())
        .with_contact(foundation(friction))
        .with_boxes([3, 1, 1])
        .with_analysis(paper_steps(1.0, steps))
}

/// Normal and friction forces of all points, N.
pub(crate) fn forces(points: &[PointState]) -> Vec<f64> {
    points
        .iter()
        .flat_map(|p| std::iter::once(p.normal_force).chain(p.friction_force))
        .collect()
}

pub(crate) fn count(points: &[PointState], state: ContactState) -> usize {
    points.iter().filter(|p| p.state == state).count()
}

pub(crate) fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Root of the energy of the difference of two displacements.
pub(crate) fn energy_distance(scene: &Scene, a: &[f64], b: &[f64]) -> f64 {
    let off: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    fields::strain_energy(scene.mesh(), scene.materials(), &off)
        .expect("energy")
        .sqrt()
}

/// The same relative to the second.
pub(crate) fn relative_distance(scene: &Scene, own: &[f64], reference: &[f64]) -> f64 {
    let zero = vec![0.0; reference.len()];
    energy_distance(scene, own, reference) / energy_distance(scene, reference, &zero)
}

/// `|a - b| / |b|`; 0 for two zeros.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let d: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let d = norm(&d);
    if d == 0.0 { 0.0 } else { d / norm(b) }
}

pub(crate) fn assert_close(a: &[f64], b: &[f64], tolerance: f64, what: &str) {
    let d = distance(a, b);
    assert!(d <= tolerance, "{what}: relative distance {d:e}");
}

/// All bits of a step's numbers.
pub(crate) fn bits(result: &Solved) -> Vec<u64> {
    result
        .torn
        .iter()
        .chain(&result.displacement)
        .chain(&forces(&result.points))
        .map(|v| v.to_bits())
        .collect()
}

/// Bits of all steps, and the state at the end.
pub(crate) fn fingerprint(scene: Scene, settings: Settings) -> (Vec<Vec<u64>>, State) {
    let mut simulation = Simulation::new(scene, settings).expect("set-up");
    let steps = rest(&mut simulation).iter().map(bits).collect();
    (steps, simulation.state().clone())
}

/// `axis` and `angle` to a rotation matrix.
pub(crate) fn rotation(axis: [f64; 3], angle: f64) -> [[f64; 3]; 3] {
    let n = norm(&axis);
    let k = axis.map(|v| v / n);
    let (s, c) = angle.sin_cos();
    let cross = [[0.0, -k[2], k[1]], [k[2], 0.0, -k[0]], [-k[1], k[0], 0.0]];
    let mut r = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            r[i][j] = f64::from(u8::from(i == j)) * c + s * cross[i][j] + (1.0 - c) * k[i] * k[j];
        }
    }
    r
}

pub(crate) fn turn(r: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (0..3).map(|j| r[i][j] * v[j]).sum())
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Solves `A x = b` for a symmetric positive definite matrix given by rows (dense Cholesky).
pub(crate) fn cholesky_solve(mut a: Vec<Vec<f64>>, b: &[f64]) -> Vec<f64> {
    let n = b.len();
    for j in 0..n {
        let (done, below) = a.split_at_mut(j + 1);
        let row = &mut done[j];
        let pivot = row[j] - row[..j].iter().map(|v| v * v).sum::<f64>();
        assert!(pivot > 0.0, "pivot {j} is {pivot:e}");
        row[j] = pivot.sqrt();
        for other in below {
            let sum: f64 = other[..j].iter().zip(&row[..j]).map(|(x, y)| x * y).sum();
            other[j] = (other[j] - sum) / row[j];
        }
    }
    let mut x = b.to_vec();
    for i in 0..n {
        let sum: f64 = a[i][..i].iter().zip(&x).map(|(l, y)| l * y).sum();
        x[i] = (x[i] - sum) / a[i][i];
    }
    for i in (0..n).rev() {
        x[i] /= a[i][i];
        let value = x[i];
        for (j, y) in x[..i].iter_mut().enumerate() {
            *y -= a[i][j] * value;
        }
    }
    x
}

/// Whether the rows of `B` are orthonormal.
pub(crate) fn orthonormal(gluing: &Gluing) -> bool {
    let mut entries: BTreeMap<(usize, usize), Vec<(usize, f64)>> = BTreeMap::new();
    for row in 0..gluing.ranges().total() {
        for (subdomain, dof, value) in gluing.row(row) {
            entries.entry((subdomain, dof)).or_default().push((row, value));
        }
    }
    let mut gram: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for rows in entries.values() {
        for (a, v) in rows {
            rows.iter()
                .for_each(|(b, w)| *gram.entry((*a, *b)).or_default() += v * w);
        }
    }
    gram.iter()
        .all(|((a, b), v)| (v - f64::from(u8::from(a == b))).abs() < 1e-12)
}
