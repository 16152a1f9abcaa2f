//! Tresca friction against an interior point method (clarabel) that shares no code with this workspace.

use crate::common::*;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use signorini_qp::SymmetricOperator;
use signorini_tfeti::TangentialRows;

const GAP: f64 = 1e-3;

struct Case {
    loads: Vec<LoadDensity>,
    bound: f64,
    /// The bound vanishes on half of the surface.
    half: bool,
}

fn case(seed: u64) -> Case {
    let mut random = random(seed);
    let mut vector = |scale: f64, shift: f64| {
        let [x, y, z] = [0; 3].map(|_| random.random_range(-scale..scale));
        [x, y, z + shift]
    };
    // pushed down, except for the seeds divisible by 5
    let lift = if seed.is_multiple_of(5) { 3.0 } else { -3.0 };
    let loads = vec![
        LoadDensity::Traction(brick::Z_MAX, vector(2.0, lift)),
        LoadDensity::Traction(brick::X_MAX, vector(1.0, 0.0)),
        LoadDensity::Body(vector(1.0, 0.0)),
    ];
    let bound = [0.0, 0.05, 0.5, 50.0][(seed % 4) as usize];
    Case {
        loads,
        bound,
        half: seed % 3 == 1,
    }
}

fn bound_at(case: &Case, x: [f64; 3]) -> f64 {
    if case.half && x[0] > 1.6 { 0.0 } else { case.bound }
}

fn scene(case: &Case) -> Scene {
    let (bound, half) = (case.bound, case.half);
    let field = move |x: [f64; 3]| if half && x[0] > 1.6 { 0.0 } else { bound };
    scene_with(case, Friction::Tresca(SlipBound::field(field)))
}

fn scene_with(case: &Case, friction: Friction) -> Scene {
    let mut scene = Scene::new(block([3.0, 1.0, 1.0], [6, 2, 2]), uniform(1000.0, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        // one edge moves along x only, so that one-directional friction occurs, too
        .with_support(Support::components(vec![6], [false, true, false]))
        .with_contact(Contact::rigid(brick::Z_MIN).with_gap(GAP).with_friction(friction))
        .with_boxes([3, 1, 1]);
    for load in &case.loads {
        scene = scene.with_load(Load::new(load.clone()));
    }
    scene
}

/// The constraints of the dual problem, row by row, for clarabel's form A x + s = b, s in a product of cones.
#[derive(Default)]
struct Cones {
    rows: Vec<Vec<(usize, f64)>>,
    right: Vec<f64>,
    kinds: Vec<SupportedConeT<f64>>,
}

impl Cones {
    fn add(&mut self, rows: Vec<Vec<(usize, f64)>>, right: &[f64], kind: SupportedConeT<f64>) {
        self.rows.extend(rows);
        self.right.extend(right);
        self.kinds.push(kind);
    }
}

fn csc(rows: &[Vec<(usize, f64)>], n: usize) -> CscMatrix<f64> {
    let mut columns = vec![Vec::new(); n];
    for (i, row) in rows.iter().enumerate() {
        for &(j, v) in row {
            columns[j].push((i, v));
        }
    }
    let (mut colptr, mut rowval, mut nzval) = (vec![0], vec![], vec![]);
    for column in columns {
        for (i, v) in column {
            rowval.push(i);
            nzval.push(v);
        }
        colptr.push(rowval.len());
    }
    CscMatrix::new(rows.len(), n, colptr, rowval, nzval)
}

/// Multipliers by clarabel: minimise 1/2 l F l - l d with G l = e, normal forces that press, friction in its bounds.
fn reference(case: &Case, simulation: &Simulation) -> Vec<f64> {
    let tfeti = simulation.tfeti();
    let n = tfeti.dual_dim();
    let mut d = vec![0.0; n];
    let mut e = vec![0.0; 6 * tfeti.subdomains()];
    let mesh = simulation.scene().mesh();
    for load in &case.loads {
        let local = assemble_load(mesh, simulation.decomposition(), load).expect("load");
        let response = tfeti.load_response(&local).expect("response");
        d.iter_mut().zip(&response.dual).for_each(|(d, v)| *d -= v);
        e.iter_mut().zip(&response.coarse).for_each(|(e, v)| *e += v);
    }
    let mut cones = Cones::default();
    for (k, right) in e.iter().enumerate() {
        let coarse = tfeti.coarse();
        let (mut unit, mut values) = (vec![0.0; coarse.rows()], vec![0.0; n]);
        unit[k] = 1.0;
        coarse.apply_transpose(&unit, &mut values, &mut coarse.scratch());
        let entries = values.into_iter().enumerate();
        let row = entries.filter(|(_, v)| *v != 0.0).collect();
        cones.add(vec![row], &[*right], SupportedConeT::ZeroConeT(1));
    }
    for (info, point) in tfeti.gluing().contact().iter().zip(simulation.constrained_points()) {
        d[info.row] += info.scale * GAP;
        cones.add(vec![vec![(info.row, 1.0)]], &[0.0], SupportedConeT::NonnegativeConeT(1));
        let bound = bound_at(case, point.position()) * point.area();
        match info.tangential {
            TangentialRows::Disc { row, scale } => cones.add(
                vec![vec![], vec![(row, -1.0)], vec![(row + 1, -1.0)]],
                &[bound / scale, 0.0, 0.0],
                SupportedConeT::SecondOrderConeT(3),
            ),
            TangentialRows::Interval { row, scale, .. } => cones.add(
                vec![vec![(row, 1.0)], vec![(row, -1.0)]],
                &[bound / scale; 2],
                SupportedConeT::NonnegativeConeT(2),
            ),
            _ => {}
        }
    }
    // scaled so that the largest entry of F is one: clarabel's tolerances are absolute
    let dual = tfeti.dual();
    let (mut scratch, mut unit) = (dual.scratch(), vec![0.0; n]);
    let mut f = vec![vec![0.0; n]; n];
    for j in 0..n {
        unit[j] = 1.0;
        dual.apply(&unit, &mut f[j], &mut scratch);
        unit[j] = 0.0;
    }
    let largest = f.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
    let upper: Vec<Vec<(usize, f64)>> = (0..n)
        .map(|i| (i..n).map(|j| (j, f[i][j] / largest)).collect())
        .collect();
    let q: Vec<f64> = d.iter().map(|v| -v / largest).collect();
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: 1e-12,
        tol_gap_rel: 1e-12,
        tol_feas: 1e-12,
        ..DefaultSettings::default()
    };
    let (p, a) = (csc(&upper, n), csc(&cones.rows, n));
    let mut solver = DefaultSolver::new(&p, &q, &a, &cones.right, &cones.kinds, settings).expect("clarabel");
    solver.solve();
    assert!(
        matches!(
            solver.solution.status,
            SolverStatus::Solved | SolverStatus::AlmostSolved
        ),
        "{:?}",
        solver.solution.status
    );
    solver.solution.x.clone()
}

/// Nodal forces in space from multipliers.
fn nodal_forces(lambda: &[f64], simulation: &Simulation) -> Vec<f64> {
    let mut out = Vec::new();
    let rows = simulation.tfeti().gluing().contact().iter();
    for (info, point) in rows.zip(simulation.constrained_points()) {
        out.push(info.scale * lambda[info.row]);
        out.extend(match info.tangential {
            TangentialRows::Disc { row, scale } => point
                .frame()
                .vector(0.0, [scale * lambda[row], scale * lambda[row + 1]]),
            TangentialRows::Interval { row, direction, scale } => direction.map(|c| c * scale * lambda[row]),
            _ => [0.0; 3],
        });
    }
    out
}

#[test]
fn all_methods_agree_with_clarabel() {
    let (mut open, mut sliding, mut sticking) = (0, 0, 0);
    for seed in 0..12 {
        let case = case(seed);
        for method in methods() {
            let what = format!("seed {seed}, {}", method.kind());
            let settings = at(1e-8).with_method(method);
            let mut simulation = Simulation::new(scene(&case), settings).expect("set-up");
            let result = step(&mut simulation);
            assert_certified(&result, &what);
            let expected = nodal_forces(&reference(&case, &simulation), &simulation);
            let found = forces(&result.points);
            // no contact force at all: measured against the loads, which are of the order of one
            let size = norm(&expected).max(1.0);
            let difference: Vec<f64> = found.iter().zip(&expected).map(|(a, b)| a - b).collect();
            let error = norm(&difference) / size;
            assert!(error <= 1e-6, "{what}: {error:e}");
            open += usize::from(result.summary.active == 0);
            sliding += result.summary.slip;
            sticking += result.summary.stick;
        }
    }
    // the cases must reach everything that they are meant to reach
    assert!(open > 0 && sliding > 0 && sticking > 0, "{open} {sliding} {sticking}");
}

/// The rows of the dual problem are the ones that the certificate measures: no slip bound, no friction.
#[test]
fn a_zero_bound_is_no_friction() {
    let mut case = case(1);
    case.bound = 0.0;
    let with = solve(scene(&case), tight());
    let without = solve(scene_with(&case, Friction::None), tight());
    assert_close(&with.displacement, &without.displacement, 1e-8, "displacement");
    assert_eq!(with.summary.friction_norm, 0.0);
    assert_eq!(with.summary.active, without.summary.active);
}
