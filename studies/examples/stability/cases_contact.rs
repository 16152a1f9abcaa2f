//! Friction coefficients, sets of contact nodes, and ways of sliding.

use signorini::prelude::*;
use signorini_studies::Failure;
use signorini_studies::brick::{Block, PAPER_FORMULA, RAMP};

use super::case::{Case, Expect, Setup, ToSetup};

/// What a problem without a certified solution may end with.
const UNSOLVED: &[StepStatus] = &[
    StepStatus::NotContractive,
    StepStatus::IterationLimit,
    StepStatus::Stagnated,
];

/// Coefficients from 0 to beyond the range in which the Coulomb map contracts.
pub(crate) fn friction() -> Vec<Case> {
    let case = |name: &str, hard, block| Case::brick("Friction coefficients", name, hard, block);
    let block = |friction| Block {
        floor: Some(friction),
        ..Block::default()
    };
    let mut cases = Vec::new();
    for coefficient in [0.0, 0.05, 0.3, 1.0, 3.0, 10.0, 1e3] {
        let hard = match coefficient {
            0.0 => "tangential rows with slip bounds 0: discs of radius 0",
            c if c < 0.2 => "sliding nearly without resistance: large curvature of the discs",
            c if c < 1.0 => "the benchmark's coefficient",
            c if c < 2.0 => "coupling of normal and tangential forces grows",
            _ => "beyond what is known to contract; several solutions may exist",
        };
        let name = format!("coefficient {coefficient}");
        let case = case(&name, hard, block(Friction::coulomb(coefficient)));
        cases.push(if coefficient > 100.0 {
            case.expect(Expect::CertifiedOr(1e-4, UNSOLVED))
        } else if coefficient == 0.0 {
            case.same_as("no friction", 1e-5)
        } else {
            case
        });
    }
    cases.push(case("no friction", "no tangential rows at all", block(Friction::None)));
    let paper = Block {
        steps: 2,
        cells: [2; 3],
        ..block(Friction::coulomb(3.0))
    };
    cases.push(Case::new(
        "Friction coefficients",
        "coefficient 3, paper's method",
        "successive approximations without a contraction",
        move || {
            let settings = Settings::default().with_method(Method::paper());
            Ok(Setup {
                settings,
                ..paper.setup()?
            })
        },
    ));
    let (fixed, kinetic, decay) = (1.0, 0.02, 1e-4);
    let weak = Coefficient::Exponential { fixed, kinetic, decay };
    cases.push(case(
        "strong rate weakening",
        "the coefficient falls from 1 to 0.02 within 0.1 mm/s: nodes stick and tear loose",
        Block {
            steps: 20,
            formula: PAPER_FORMULA,
            ..block(Friction::Coulomb(weak))
        },
    ));
    let jump = Coefficient::Table(vec![(0.0, 0.8), (1e-12, 0.0)]);
    cases.push(case(
        "coefficient 0.8 or 0",
        "a law that jumps: any slip in the last step takes all friction away",
        Block {
            steps: 10,
            ..block(Friction::Coulomb(jump))
        },
    ));
    cases
}

fn with_gap(gap: impl Fn([f64; 3]) -> f64 + Send + Sync + 'static) -> Result<Setup, Failure> {
    let block = Block {
        floor: None,
        ..Block::default()
    };
    let contact = Contact::rigid(brick::Z_MIN).with_gap_field(gap);
    let contact = contact.with_friction(Friction::coulomb(0.3));
    Ok(block.setup()?.map(|scene| scene.with_contact(contact)))
}

/// All nodes, one node, no node in contact.
pub(crate) fn sets() -> Vec<Case> {
    const GROUP: &str = "Contact sets";
    let face = Block {
        gap: 1e-3,
        end: [0.0; 3],
        top: [0.0; 3],
        clamped: false,
        steps: 1,
        ..Block::default()
    };
    vec![
        Case::brick(
            GROUP,
            "all nodes",
            "no gap and a load that presses everywhere",
            Block {
                gap: 0.0,
                end: [1e8, 0.0, 0.0],
                ..Block::default()
            },
        ),
        Case::new(
            GROUP,
            "one node",
            "one corner can touch: one disc carries all friction",
            || with_gap(|x| if x[0] > 2.99 && x[1] < 0.01 { 0.1 } else { 10.0 }),
        ),
        Case::brick(
            GROUP,
            "no node",
            "the floor is out of reach: contact forces vanish and have no scale",
            Block {
                gap: 10.0,
                ..Block::default()
            },
        ),
        Case::new(
            GROUP,
            "whole face at once",
            "every node of the face touches and slides in one step",
            move || {
                let top = Support::fixed(brick::Z_MAX);
                let top = top.with_motion([2e-3, 0.0, -2e-3], History::constant(1.0));
                Ok(face.setup()?.map(|scene| scene.with_support(top)))
            },
        ),
        Case::new(
            GROUP,
            "starts inside the obstacle",
            "negative gap: the first step must push the body out",
            || with_gap(|x| -1e-3 * x[0]),
        ),
        Case::new(
            GROUP,
            "gap of rounding size",
            "gaps of 1e-18 m: contact and open differ by rounding only",
            || with_gap(|x| 1e-18 * (x[0] * 1e3).sin().abs()),
        ),
    ]
}

/// A block driven from its top, pressed and moved along the floor.
fn driven(down: f64, along: Vec<(f64, f64)>, steps: usize, friction: Friction) -> Result<Setup, Failure> {
    let block = Block {
        lengths: [2.0, 1.0, 1.0],
        boxes: [2, 1, 1],
        gap: 0.0,
        top: [0.0; 3],
        end: [0.0; 3],
        clamped: false,
        floor: Some(friction),
        steps,
        ..Block::default()
    };
    let top = |held| Support::components(brick::Z_MAX, held);
    let press = top([false, true, true]).with_motion([0.0, 0.0, -down], History::constant(1.0));
    let drag = top([true, false, false]).with_motion([1.0, 0.0, 0.0], History::table(along)?);
    Ok(block.setup()?.map(|scene| scene.with_support(press).with_support(drag)))
}

/// A cube without supports, pressed on its top and sheared all around: everywhere the same stress.
fn patch(shear: f64) -> Result<Setup, Failure> {
    let block = Block {
        lengths: [1.0; 3],
        boxes: [1; 3],
        poisson: 0.0,
        gap: 0.0,
        top: [shear, 0.0, -1e6],
        end: [0.0, 0.0, shear],
        end_history: RAMP.to_vec(),
        clamped: false,
        steps: 2,
        ..Block::default()
    };
    let side = LoadDensity::Traction(brick::X_MIN, [0.0, 0.0, -shear]);
    Ok(block.setup()?.with_load(side, History::table(RAMP.to_vec())?))
}

/// Sticking, sliding, reversal.
pub(crate) fn sliding() -> Vec<Case> {
    let zigzag = |n: usize, size: f64| -> Vec<(f64, f64)> {
        let at = |k: usize| [-size, size][k % 2] * f64::from(u8::from(k > 0));
        (0..=n).map(|k| (k as f64 / n as f64, at(k))).collect()
    };
    type Drive = (f64, Vec<(f64, f64)>, usize, Friction);
    let case = |name: &str, hard, (down, along, steps, friction): Drive| {
        Case::new("Stick and slip", name, hard, move || {
            driven(down, along.clone(), steps, friction.clone())
        })
    };
    let threshold = |name: &str, hard, shear: f64| Case::new("Stick and slip", name, hard, move || patch(shear));
    let to = |end: f64| vec![(0.0, 0.0), (1.0, end)];
    let half = || Friction::coulomb(0.5);
    let one_half = Coefficient::field(|x| if x[0] < 1.0 { 0.0 } else { 0.5 });
    vec![
        case(
            "pure sticking",
            "all discs free; friction far below the bound",
            (1e-3, to(1e-5), 4, half()),
        ),
        case(
            "pure sliding",
            "every node slides a thousand times the elastic shear",
            (1e-3, to(1.0), 4, half()),
        ),
        case(
            "reversal at every step",
            "each step slides against the one before; extrapolation is wrong every time",
            (1e-3, zigzag(8, 1e-2), 8, half()),
        ),
        Case::new(
            "Stick and slip",
            "reversal, 3/2 -2 1/2",
            "the same with the paper's formula, whose difference overshoots",
            move || {
                let analysis = Analysis::quasistatic(1.0, 8).with_formula(PAPER_FORMULA);
                let setup = driven(1e-3, zigzag(8, 1e-2), 8, Friction::coulomb(0.5))?;
                Ok(setup.map(|scene| scene.with_analysis(analysis)))
            },
        ),
        case(
            "slip bounds exactly 0, given",
            "Tresca friction with bound 0 is no friction",
            (1e-3, to(1e-2), 3, Friction::tresca(0.0)),
        ),
        case(
            "slip bounds 0 on one half",
            "discs of radius 0 beside others",
            (1e-3, to(1e-2), 3, Friction::Coulomb(one_half)),
        ),
        case(
            "Tresca friction",
            "bounds that do not follow the pressure: friction at open nodes too",
            (
                1e-4,
                vec![(0.0, 0.0), (0.5, 1e-2), (1.0, 0.0)],
                4,
                Friction::tresca(1e7),
            ),
        ),
        threshold(
            "just below the threshold",
            "friction patch, shear 0.3 (1 - 1e-6) of the pressure, coefficient 0.3; nothing else holds the block",
            0.3 * (1.0 - 1e-6) * 1e6,
        ),
        threshold(
            "exactly at the threshold",
            "friction patch, shear 0.3 of the pressure: one admissible force, and slip not determined",
            0.3 * 1e6,
        ),
        threshold(
            "just above the threshold",
            "friction patch, shear 0.3 (1 + 1e-5) of the pressure: no equilibrium",
            0.3 * (1.0 + 1e-5) * 1e6,
        )
        .expect(Expect::Refused("cannot be in equilibrium")),
    ]
}
