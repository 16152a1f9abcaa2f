//! A column under cyclic shear, uniform in space, against the same law at one point.

use crate::common::*;

const YOUNG: f64 = 2000.0;
const SHEAR: f64 = 1000.0;
const PRESSURE: f64 = 10.0;
const COEFFICIENT: f64 = 0.3;
const AMPLITUDE: f64 = 0.01;

/// Top displacement at time t: 0 to 1, to -1, to 1 times the amplitude, one unit of time a unit of way.
fn top(t: f64) -> f64 {
    let value = if t <= 1.0 {
        t
    } else if t <= 3.0 {
        2.0 - t
    } else {
        t - 4.0
    };
    AMPLITUDE * value
}

struct Point {
    stress: Vec<f64>,
    slip: Vec<f64>,
}

impl Point {
    /// Work against friction in the steps after `from`, per area.
    fn loss(&self, from: usize) -> f64 {
        (from..self.slip.len())
            .map(|i| self.stress[i] * (self.slip[i] - if i > 0 { self.slip[i - 1] } else { 0.0 }))
            .sum()
    }
}

/// The law at one point: shear stress G (d - s), bounded by F p, s = z where it is inside.
fn one_point(steps: usize, formula: DifferenceFormula) -> Point {
    let limit = COEFFICIENT * PRESSURE;
    let (mut last, mut before) = (0.0, 0.0);
    let (mut stress, mut slip) = (Vec::new(), Vec::new());
    for i in 1..=5 * steps {
        let d = top(i as f64 / steps as f64);
        let trial = SHEAR * (d - formula.offset(last, before));
        let tau = trial.clamp(-limit, limit);
        before = last;
        last = d - tau / SHEAR;
        stress.push(tau);
        slip.push(last);
    }
    Point { stress, slip }
}

/// The column of finite elements; the sides carry the complementary shear of the exact solution.
fn column(steps: usize, formula: DifferenceFormula, exact: &Point) -> Scene {
    let time = |i: usize| (i + 1) as f64 / steps as f64;
    let table = exact.stress.iter().enumerate().map(|(i, &s)| (time(i), s));
    let shear = History::table(std::iter::once((0.0, 0.0)).chain(table).collect()).expect("table");
    let side = |tag, sign: f64| Load::traction(tag, [0.0, 0.0, sign]).with_history(shear.clone());
    Scene::new(block([1.0, 0.5, 1.0], [2, 1, 2]), uniform(YOUNG, 0.0))
        .with_support(
            Support::components(brick::Z_MAX, [true, true, false]).with_motion([1.0, 0.0, 0.0], History::function(top)),
        )
        .with_load(Load::pressure(brick::Z_MAX, PRESSURE))
        .with_load(side(brick::X_MAX, 1.0))
        .with_load(side(brick::X_MIN, -1.0))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(COEFFICIENT)))
        .with_boxes([2, 1, 1])
        .with_analysis(Analysis::quasistatic(5.0, 5 * steps).with_formula(formula))
}

/// Runs the column, compares every step with the one-point law, and returns loss and dissipation of the last cycle.
fn compare(steps: usize, formula: DifferenceFormula, method: Method) -> (f64, f64) {
    let exact = one_point(steps, formula);
    let settings = at(1e-9).with_method(method);
    let (_, results) = run(column(steps, formula, &exact), settings);
    let area = 0.5;
    let (mut loss, mut dissipation) = (0.0, 0.0);
    for (i, result) in results.iter().enumerate() {
        for p in &result.points {
            let (slip, force) = (p.tangential_displacement[0], -p.friction_force[0] / p.area);
            assert!((slip - exact.slip[i]).abs() < 1e-8 * AMPLITUDE, "step {i}: {slip}");
            assert!(
                (force - exact.stress[i]).abs() < 1e-7 * COEFFICIENT * PRESSURE,
                "step {i}"
            );
            assert!((p.normal_force / (-PRESSURE * p.area) - 1.0).abs() < 1e-7);
        }
        assert!(result.summary.dissipation >= -1e-12);
        if i >= steps {
            loss += result.summary.friction_work / area;
            dissipation += result.summary.dissipation / area;
        }
    }
    // the last cycle, from +1 over -1 to +1
    assert!((loss - exact.loss(steps)).abs() < 1e-7 * loss);
    (loss, dissipation)
}

#[test]
fn backward_euler_is_exact_at_the_steps() {
    let steps = 10;
    let exact = one_point(steps, DifferenceFormula::BACKWARD_EULER);
    // slip starts at 3e-3, is 7e-3 after loading, and stays until the top is back at 4e-3
    assert!(exact.slip[2].abs() < 1e-15 && (exact.slip[3] - 1e-3).abs() < 1e-15);
    assert!((exact.slip[steps - 1] - 7e-3).abs() < 1e-15);
    assert!((exact.slip[steps + 5] - 7e-3).abs() < 1e-15 && exact.slip[steps + 6] < 7e-3 - 1e-4);
    let (loss, dissipation) = compare(steps, DifferenceFormula::BACKWARD_EULER, Method::default());
    assert!((loss / 0.084 - 1.0).abs() < 1e-6, "{loss}");
    assert!((dissipation - loss).abs() < 1e-9 * loss);
}

#[test]
fn the_papers_formula_has_a_first_order_signature() {
    let formula = DifferenceFormula::PAPER;
    let error = |steps: usize| one_point(steps, formula).loss(steps) / 0.1 - 0.84;
    // the finite elements repeat the one-point law, which is then refined
    let (loss, _) = compare(40, formula, Method::default());
    assert!((loss / 0.1 - 0.85383).abs() < 1e-5, "{}", loss / 0.1);
    for steps in [40, 80, 160] {
        let order = (error(steps) / error(2 * steps)).log2();
        assert!((0.9..1.1).contains(&order), "order {order} at {steps} steps");
    }
}

#[test]
fn every_method_follows_the_cycle() {
    for method in methods() {
        compare(5, DifferenceFormula::PAPER, method.clone());
        compare(5, DifferenceFormula::BACKWARD_EULER, method);
    }
}
