//! Friction coefficients, sets of contact nodes, and ways of sliding.

use super::block::Block;
use super::case::{Case, Expect, Failure, Setup};
use signorini::prelude::*;

/// What a problem without a certified solution may end with.
const UNSOLVED: &[StepStatus] = &[
    StepStatus::NotContractive,
    StepStatus::IterationLimit,
    StepStatus::Stagnated,
];

/// Coefficients from 0 to beyond the range in which the Coulomb map contracts.
#[must_use]
pub fn friction() -> Vec<Case> {
    const GROUP: &str = "Friction coefficients";
    let mut cases = Vec::new();
    for coefficient in [0.0, 0.05, 0.3, 1.0, 3.0, 10.0, 1e3] {
        let hard = match coefficient {
            0.0 => "tangential rows with slip bounds 0: discs of radius 0",
            c if c < 0.2 => "sliding nearly without resistance: large curvature of the discs",
            c if c < 1.0 => "the benchmark's coefficient",
            c if c < 2.0 => "coupling of normal and tangential forces grows",
            _ => "beyond what is known to contract; several solutions may exist",
        };
        let block = Block {
            friction: Friction::coulomb(coefficient),
            ..Block::default()
        };
        let case = Case::new(
            GROUP,
            format!("coefficient {coefficient}"),
            hard,
            move || block.setup(),
        );
        cases.push(if coefficient > 100.0 {
            case.expect(Expect::CertifiedOr(1e-4, UNSOLVED))
        } else if coefficient == 0.0 {
            case.same_as("no friction", 1e-5)
        } else {
            case
        });
    }
    let none = Block {
        friction: Friction::None,
        ..Block::default()
    };
    cases.push(Case::new(
        GROUP,
        "no friction",
        "no tangential rows at all",
        move || none.setup(),
    ));
    let paper = Block {
        friction: Friction::coulomb(3.0),
        settings: Settings::default().with_method(Method::paper()),
        steps: 2,
        cells: [2; 3],
        ..Block::default()
    };
    cases.push(Case::new(
        GROUP,
        "coefficient 3, paper's method",
        "successive approximations without a contraction",
        move || paper.setup(),
    ));
    let weak = Block {
        friction: Friction::Coulomb(Coefficient::Exponential {
            fixed: 1.0,
            kinetic: 0.02,
            decay: 1e-4,
        }),
        steps: 20,
        formula: DifferenceFormula::THREE_STEP,
        ..Block::default()
    };
    cases.push(Case::new(
        GROUP,
        "strong rate weakening",
        "the coefficient falls from 1 to 0.02 within 0.1 mm/s: nodes stick and tear loose",
        move || weak.setup(),
    ));
    let jump = Block {
        friction: Friction::Coulomb(Coefficient::Table(vec![(0.0, 0.8), (1e-12, 0.0)])),
        steps: 10,
        ..Block::default()
    };
    cases.push(Case::new(
        GROUP,
        "coefficient 0.8 or 0",
        "a law that jumps: any slip in the last step takes all friction away",
        move || jump.setup(),
    ));
    cases
}

fn with_gap(gap: impl Fn([f64; 3]) -> f64 + Send + Sync + 'static) -> Result<Setup, Failure> {
    let block = Block::default();
    let contact = Contact::rigid(brick::Z_MIN)
        .with_gap_field(gap)
        .with_friction(block.friction.clone());
    Ok(block
        .setup()?
        .map(|scene| scene.replace_contact(Some(contact))))
}

/// All nodes, one node, no node in contact.
#[must_use]
pub fn sets() -> Vec<Case> {
    const GROUP: &str = "Contact sets";
    let all = Block {
        gap: 0.0,
        end: [1e8, 0.0, 0.0],
        ..Block::default()
    };
    let none = Block {
        gap: 10.0,
        ..Block::default()
    };
    let face = Block {
        gap: 1e-3,
        end: [0.0; 3],
        top: [0.0; 3],
        clamped: false,
        steps: 1,
        ..Block::default()
    };
    vec![
        Case::new(
            GROUP,
            "all nodes",
            "no gap and a load that presses everywhere",
            move || all.setup(),
        ),
        Case::new(
            GROUP,
            "one node",
            "one corner can touch: one disc carries all friction",
            || {
                with_gap(|x| {
                    if x[0] > 2.99 && x[1] < 0.01 {
                        0.1
                    } else {
                        10.0
                    }
                })
            },
        ),
        Case::new(
            GROUP,
            "no node",
            "the floor is out of reach: contact forces vanish and have no scale",
            move || none.setup(),
        ),
        Case::new(
            GROUP,
            "whole face at once",
            "every node of the face touches and slides in one step",
            move || {
                let down = [2e-3, 0.0, -2e-3];
                Ok(face.setup()?.map(|scene| {
                    scene.with_support(
                        Support::fixed(brick::Z_MAX).with_motion(down, History::constant(1.0)),
                    )
                }))
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
fn driven(
    down: f64,
    along: Vec<(f64, f64)>,
    steps: usize,
    friction: Friction,
) -> Result<Setup, Failure> {
    let block = Block {
        lengths: [2.0, 1.0, 1.0],
        boxes: [2, 1, 1],
        gap: 0.0,
        top: [0.0; 3],
        end: [0.0; 3],
        clamped: false,
        friction,
        steps,
        ..Block::default()
    };
    let along = History::table(along)?;
    Ok(block.setup()?.map(|scene| {
        scene
            .with_support(
                Support::components(brick::Z_MAX, [false, true, true])
                    .with_motion([0.0, 0.0, -down], History::constant(1.0)),
            )
            .with_support(
                Support::components(brick::Z_MAX, [true, false, false])
                    .with_motion([1.0, 0.0, 0.0], along),
            )
    }))
}

/// Sticking, sliding, reversal.
#[must_use]
pub fn sliding() -> Vec<Case> {
    const GROUP: &str = "Stick and slip";
    let zigzag = |n: usize, size: f64| -> Vec<(f64, f64)> {
        (0..=n)
            .map(|k| {
                let sign = if k % 2 == 1 { 1.0 } else { -1.0 };
                (k as f64 / n as f64, if k == 0 { 0.0 } else { sign * size })
            })
            .collect()
    };
    let patch = |shear: f64, pressed: f64| {
        move || {
            let block = Block {
                lengths: [1.0; 3],
                boxes: [1; 3],
                poisson: 0.0,
                gap: 0.0,
                top: [shear, 0.0, -pressed],
                end: [0.0, 0.0, shear],
                end_history: vec![(0.0, 0.0), (1.0, 1.0)],
                clamped: false,
                steps: 2,
                ..Block::default()
            };
            let side = LoadDensity::traction(brick::X_MIN, [0.0, 0.0, -shear]);
            Ok(block
                .setup()?
                .with_load(side, History::table(vec![(0.0, 0.0), (1.0, 1.0)])?))
        }
    };
    vec![
        Case::new(
            GROUP,
            "pure sticking",
            "all discs free; friction far below the bound",
            || {
                driven(
                    1e-3,
                    vec![(0.0, 0.0), (1.0, 1e-5)],
                    4,
                    Friction::coulomb(0.5),
                )
            },
        ),
        Case::new(
            GROUP,
            "pure sliding",
            "every node slides a thousand times the elastic shear",
            || {
                driven(
                    1e-3,
                    vec![(0.0, 0.0), (1.0, 1.0)],
                    4,
                    Friction::coulomb(0.5),
                )
            },
        ),
        Case::new(
            GROUP,
            "reversal at every step",
            "each step slides against the one before; extrapolation is wrong every time",
            move || driven(1e-3, zigzag(8, 1e-2), 8, Friction::coulomb(0.5)),
        ),
        Case::new(
            GROUP,
            "reversal, 3/2 -2 1/2",
            "the same with the paper's formula, whose difference overshoots",
            move || {
                Ok(
                    driven(1e-3, zigzag(8, 1e-2), 8, Friction::coulomb(0.5))?.map(|scene| {
                        scene.with_analysis(
                            Analysis::quasistatic(1.0, 8)
                                .with_formula(DifferenceFormula::THREE_STEP),
                        )
                    }),
                )
            },
        ),
        Case::new(
            GROUP,
            "slip bounds exactly 0, given",
            "Tresca friction with bound 0 is no friction",
            || {
                driven(
                    1e-3,
                    vec![(0.0, 0.0), (1.0, 1e-2)],
                    3,
                    Friction::tresca(0.0),
                )
            },
        ),
        Case::new(
            GROUP,
            "slip bounds 0 on one half",
            "discs of radius 0 beside others",
            || {
                let law = Coefficient::field(|x| if x[0] < 1.0 { 0.0 } else { 0.5 });
                driven(
                    1e-3,
                    vec![(0.0, 0.0), (1.0, 1e-2)],
                    3,
                    Friction::Coulomb(law),
                )
            },
        ),
        Case::new(
            GROUP,
            "Tresca friction",
            "bounds that do not follow the pressure: friction at open nodes too",
            || {
                driven(
                    1e-4,
                    vec![(0.0, 0.0), (0.5, 1e-2), (1.0, 0.0)],
                    4,
                    Friction::tresca(1e7),
                )
            },
        ),
        Case::new(
            GROUP,
            "just below the threshold",
            "friction patch, shear 0.3 (1 - 1e-6) of the pressure, coefficient 0.3; nothing else holds the block",
            patch(0.3 * (1.0 - 1e-6) * 1e6, 1e6),
        ),
        Case::new(
            GROUP,
            "exactly at the threshold",
            "friction patch, shear 0.3 of the pressure: one admissible force, and slip not determined",
            patch(0.3 * 1e6, 1e6),
        ),
        Case::new(
            GROUP,
            "just above the threshold",
            "friction patch, shear 0.3 (1 + 1e-5) of the pressure: no equilibrium",
            patch(0.3 * (1.0 + 1e-5) * 1e6, 1e6),
        )
        .expect(Expect::Refused("cannot be in equilibrium")),
    ]
}
