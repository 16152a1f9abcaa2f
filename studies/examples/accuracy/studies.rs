//! The five studies.

use signorini::contact::Accuracy;
use signorini::contact::MethodKind;
use signorini::prelude::*;
use signorini::qp::ActiveSetSettings;
use signorini_studies::Failure;
use signorini_studies::brick::{Block, EULER, Loading, PAPER_FORMULA, weakening};

use super::measure::{Solution, orders, solve};
use super::{Curve, Sample, Study};

/// Runs a study.
pub(super) fn run(study: Study, short: bool) -> Result<Vec<Curve>, Failure> {
    match study {
        Study::Tolerance => tolerance(short),
        Study::Mesh => mesh(short),
        Study::Time => time(short),
        Study::Method => method(short),
        Study::Effects => effects(short),
    }
}

fn at(tolerance: f64) -> Settings {
    Settings::default().with_tolerance(tolerance)
}

fn curve(
    study: Study,
    name: impl Into<String>,
    parameter: &'static str,
    reference: impl Into<String>,
    samples: Vec<Sample>,
) -> Curve {
    Curve {
        study,
        name: name.into(),
        parameter,
        reference: reference.into(),
        orders: orders(&samples),
        samples,
    }
}

/// The benchmark with fewer steps.
fn benchmark(n: usize, short: bool) -> Block {
    Block {
        cells: [if short { 3 } else { 5 }; 3],
        steps: if short { 5 } else { 10 },
        ..Block::benchmark(n, Loading::C)
    }
}

/// A reference for the solver's error: the same discrete problem on another path, as tightly as possible.
fn discrete_reference(variant: &Block) -> Result<(Solution, String), Failure> {
    let settings = at(1e-12)
        .with_preconditioner(Preconditioner::Dirichlet)
        .with_extrapolation(false);
    let solution = solve(&variant.scene()?, &settings)?;
    let text = format!(
        "same mesh and steps, tolerance 1e-12, Dirichlet preconditioner, no extrapolation (certificate {:.0e})",
        solution.certificate
    );
    Ok((solution, text))
}

fn along_tolerances(
    study: Study,
    name: &str,
    variant: &Block,
    settings: &Settings,
    tolerances: &[f64],
    reference: &(Solution, String),
) -> Result<Curve, Failure> {
    let scene = variant.scene()?;
    let mut samples = Vec::new();
    for &tolerance in tolerances {
        let solution = solve(&scene, &settings.clone().with_tolerance(tolerance))?;
        samples.push(solution.sample(tolerance, &reference.0, Some(solution.algebraic))?);
    }
    Ok(curve(study, name, "tolerance", reference.1.clone(), samples))
}

fn tolerance(short: bool) -> Result<Vec<Curve>, Failure> {
    let variant = benchmark(1, short);
    let reference = discrete_reference(&variant)?;
    let tolerances: &[f64] = if short {
        &[1e-2, 1e-4, 1e-6]
    } else {
        &[1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12]
    };
    let mut curves = Vec::new();
    for method in [Method::default(), Method::paper(), Method::one_loop()] {
        let kind = method.kind();
        let settings = Settings::default().with_method(method);
        // the paper's methods are slow: every other tolerance
        let chosen: Vec<f64> = match kind {
            MethodKind::ActiveSet => tolerances.to_vec(),
            _ => tolerances.iter().copied().step_by(2).collect(),
        };
        curves.push(along_tolerances(
            Study::Tolerance,
            &kind.to_string(),
            &variant,
            &settings,
            &chosen,
            &reference,
        )?);
    }
    Ok(curves)
}

fn method(short: bool) -> Result<Vec<Curve>, Failure> {
    let variant = benchmark(if short { 1 } else { 2 }, short);
    let reference = discrete_reference(&variant)?;
    let tolerances: &[f64] = if short { &[1e-3, 1e-5] } else { &[1e-2, 1e-4, 1e-6, 1e-8, 1e-10] };
    let default = Settings::default;
    let mut choices = vec![
        ("active set, lumped", default()),
        (
            "active set, Dirichlet",
            default().with_preconditioner(Preconditioner::Dirichlet),
        ),
        ("active set, no extrapolation", default().with_extrapolation(false)),
        (
            "active set, forcing 0.02",
            default().with_method(Method::ActiveSet(ActiveSetSettings::default().with_forcing(0.02))),
        ),
        ("one-loop", default().with_method(Method::one_loop())),
    ];
    if !short {
        choices.push(("paper", default().with_method(Method::paper())));
    }
    let study = Study::Method;
    choices
        .iter()
        .map(|(name, s)| along_tolerances(study, name, &variant, s, tolerances, &reference))
        .collect()
}

fn mesh(short: bool) -> Result<Vec<Curve>, Failure> {
    let variant = |n, cells| Block {
        cells: [cells; 3],
        steps: 10,
        formula: EULER,
        floor: Some(Friction::coulomb(0.3)),
        ..Block::benchmark(n, Loading::B)
    };
    let (ratio, sizes, fine) = if short { (2, 1..=2, variant(4, 2)) } else { (4, 1..=4, variant(8, 4)) };
    let reference = solve(&fine.scene()?, &at(1e-8))?;
    let text = format!("cells of 1/{} m, tolerance 1e-8", fine.boxes[1] * fine.cells[1]);
    let balanced = Settings::default().with_accuracy(Accuracy::balanced());
    let kinds = [
        (format!("H/h = {ratio}, 1e-6"), true, at(1e-6)),
        ("H = 1 m, 1e-6".to_owned(), false, at(1e-6)),
        (format!("H/h = {ratio}, balanced"), true, balanced),
    ];
    let mut curves = Vec::new();
    for (name, fixed_ratio, settings) in kinds {
        let mut samples = Vec::new();
        for k in sizes.clone() {
            let v = if fixed_ratio { variant(k, ratio) } else { variant(1, k * ratio) };
            let cell = 1.0 / (v.boxes[1] * v.cells[1]) as f64;
            let solution = solve(&v.scene()?, &settings)?;
            samples.push(solution.sample(cell, &reference, Some(solution.discretisation))?);
        }
        curves.push(curve(Study::Mesh, name, "cell m", text.clone(), samples));
    }
    Ok(curves)
}

fn time(short: bool) -> Result<Vec<Curve>, Failure> {
    let variant = |steps, formula| Block {
        cells: [if short { 2 } else { 4 }; 3],
        steps,
        formula,
        floor: Some(Friction::coulomb(0.3)),
        ..Block::benchmark(1, Loading::C)
    };
    let steps: &[usize] = if short { &[10, 20] } else { &[10, 20, 40, 80, 160] };
    let most = 16 * steps[steps.len() - 1];
    let reference = solve(&variant(most, EULER).scene()?, &at(1e-9))?;
    let text = format!("same mesh, backward Euler, {most} steps, tolerance 1e-9");
    let formulas = [("backward Euler", EULER), ("3/2, -2, 1/2", PAPER_FORMULA)];
    let mut curves = Vec::new();
    for (name, formula) in formulas {
        let mut samples: Vec<Sample> = Vec::new();
        let mut last: Option<Solution> = None;
        for &count in steps {
            let solution = solve(&variant(count, formula).scene()?, &at(1e-8))?;
            // steps doubled: the run with twice the steps estimates the error of the one before
            if let (Some(sample), Some(before)) = (samples.last_mut(), &last) {
                sample.estimate = Some(before.distance(&solution)?.u);
            }
            samples.push(solution.sample(1.0 / count as f64, &reference, None)?);
            last = Some(solution);
        }
        curves.push(curve(Study::Time, name, "step s", text.clone(), samples));
    }
    Ok(curves)
}

fn effects(short: bool) -> Result<Vec<Curve>, Failure> {
    let variant = |floor| Block {
        floor,
        steps: if short { 5 } else { 20 },
        ..benchmark(1, short)
    };
    let floors = [
        ("elastic only", None),
        ("contact", Some(Friction::None)),
        ("Tresca friction", Some(Friction::tresca(1e8))),
        ("Coulomb friction", Some(Friction::coulomb(0.3))),
        ("rate-dependent friction", Some(weakening())),
    ];
    let reference = solve(&variant(Some(weakening())).scene()?, &at(1e-10))?;
    let text = "all effects, same mesh and steps, tolerance 1e-10: the error is what leaving out costs";
    let mut curves = Vec::new();
    for (name, floor) in floors {
        let solution = solve(&variant(floor).scene()?, &at(1e-6))?;
        let sample = solution.sample(1e-6, &reference, Some(solution.algebraic))?;
        curves.push(curve(Study::Effects, name, "tolerance", text, vec![sample]));
    }
    Ok(curves)
}
