//! Bodies that friction alone holds.

use super::case::{Case, Setup};
use signorini::prelude::*;
use signorini_studies::Failure;
use signorini_studies::brick::{EULER, by_nearest};

const GROUP: &str = "Held by friction alone";

/// Young's modulus and pressure on the top, Pa.
const YOUNG: f64 = 2.1e11;
const PRESSURE: f64 = 1e8;

/// Direction of the side force along x and y.
const ASIDE: [f64; 2] = [0.957_826_285_221_151_4, 0.287_347_885_566_345_4];

/// How the body is cut.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Cut {
    /// Into boxes.
    Boxes([usize; 3]),
    /// By the nearest of so many scattered points.
    Scattered(usize),
}

/// A unit cube pressed on a rough floor, without supports, and pushed aside; or on another cube, which is fixed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sliding {
    /// Cells along an edge.
    pub(crate) cells: usize,
    /// Coefficient of friction.
    pub(crate) coefficient: f64,
    /// Side force over what friction holds.
    pub(crate) aside: f64,
    /// The subdomains.
    pub(crate) cut: Cut,
    /// Whether it lies on another cube.
    pub(crate) on_cube: bool,
    /// Pushed to and fro in so many steps; 0 for a static scene.
    pub(crate) steps: usize,
}

impl Default for Sliding {
    fn default() -> Self {
        Self {
            cells: 8,
            coefficient: 0.05,
            aside: 0.05,
            cut: Cut::Boxes([1; 3]),
            on_cube: false,
            steps: 0,
        }
    }
}

impl Sliding {
    /// Scene, settings and loads.
    pub(crate) fn setup(self) -> Result<Setup, Failure> {
        let cube = Brick::new([1.0; 3], [self.cells; 3]).build()?;
        let upper = |tag: FacetTag| FacetTag(tag.0 + 100);
        let (mesh, top, contact) = if self.on_cube {
            let below = cube.map_points(|[x, y, z]| [x, y, z - 1.0])?;
            let contact = Contact::between(upper(brick::Z_MIN), brick::Z_MAX);
            (below.append(&cube.map_tags(upper))?, upper(brick::Z_MAX), contact)
        } else {
            (cube, brick::Z_MAX, Contact::rigid(brick::Z_MIN))
        };
        // low enough not to tip the upper cube, as a body force on the cube alone is
        let push = self.aside * self.coefficient * PRESSURE;
        let aside = [push * ASIDE[0], push * ASIDE[1], 0.0];
        let aside = if self.on_cube { LoadDensity::Traction(top, aside) } else { LoadDensity::Body(aside) };
        let (ramp, wave) = if self.steps == 0 {
            (History::constant(1.0), History::constant(1.0))
        } else {
            let up = History::table(vec![(0.0, 0.5), (0.2, 1.0), (1.0, 1.0)])?;
            (up, History::function(|t| (6.0 * t).sin()))
        };
        let loads = vec![(LoadDensity::Traction(top, [0.0, 0.0, -PRESSURE]), ramp), (aside, wave)];
        let parts = match self.cut {
            Cut::Boxes(_) => Vec::new(),
            Cut::Scattered(count) => scattered(&mesh, count)?,
        };
        let mut scene = Scene::new(mesh, Materials::uniform(Hooke::isotropic(YOUNG, 0.3)?))
            .with_contact(contact.with_friction(Friction::coulomb(self.coefficient)));
        if self.on_cube {
            scene = scene.with_support(Support::fixed(brick::Z_MIN));
        }
        scene = match self.cut {
            Cut::Boxes(boxes) => scene.with_boxes(boxes),
            Cut::Scattered(_) => scene.with_parts_as_given(parts),
        };
        if self.steps > 0 {
            scene = scene.with_analysis(Analysis::quasistatic(1.0, self.steps).with_formula(EULER));
        }
        Ok(Setup::new(scene, loads))
    }
}

/// Parts by the nearest of `count` scattered points, in connected pieces.
fn scattered(mesh: &TetMesh, count: usize) -> Result<Vec<u32>, Failure> {
    let (low, high) = mesh.extent();
    // additive recurrence of Roberts, which fills a box evenly
    let step = [
        0.819_172_513_396_164_5,
        0.671_043_606_703_789_3,
        0.549_700_477_901_970_2,
    ];
    let seeds: Vec<[f64; 3]> = (1..=count)
        .map(|k| std::array::from_fn(|c| low[c] + (high[c] - low[c]) * (k as f64 * step[c]).fract()))
        .collect();
    let parts = by_nearest(mesh, &seeds);
    Ok(signorini::fem_mesh::decomposition::split_disconnected(mesh, &parts)?)
}

/// Cubes that slide nearly everywhere.
pub(crate) fn cases() -> Vec<Case> {
    let case = |name: &str, hard: &'static str, at_most: usize, sliding: Sliding| {
        Case::new(GROUP, name, hard, move || sliding.setup()).at_most(at_most)
    };
    let base = Sliding::default();
    let mut cases = Vec::new();
    for (name, cut) in [
        ("whole", Cut::Boxes([1; 3])),
        ("2 x 2 x 2", Cut::Boxes([2; 3])),
        ("4 x 4 x 4", Cut::Boxes([4; 3])),
        ("8 x 8 x 8", Cut::Boxes([8; 3])),
        ("20 scattered parts", Cut::Scattered(20)),
    ] {
        cases.push(case(
            &format!("slides everywhere, {name}"),
            "nothing but the curvature of the discs holds its place",
            40,
            Sliding { cut, ..base },
        ));
    }
    cases.extend([
        case(
            "slides everywhere, pushed at 95 %",
            "directions of sliding turn by up to a right angle on the way",
            50,
            Sliding {
                aside: 0.95,
                coefficient: 0.01,
                ..base
            },
        ),
        case(
            "slides everywhere, pushed at 99.9 %",
            "the slip it needs is many times the elastic displacement",
            100,
            Sliding { aside: 0.999, ..base },
        ),
        case(
            "pushed at 99.9 %, nearly tipping",
            "a coefficient of 1: it stands on one edge and slides there",
            100,
            Sliding {
                aside: 0.999,
                coefficient: 1.0,
                ..base
            },
        ),
        case(
            "slides everywhere, 16 cells",
            "a finer mesh",
            50,
            Sliding {
                cells: 16,
                cut: Cut::Boxes([4; 3]),
                ..base
            },
        )
        .long(),
        case(
            "slides on a cube, pushed at 95 %",
            "the same on an elastic body",
            80,
            Sliding {
                aside: 0.95,
                on_cube: true,
                cut: Cut::Boxes([2, 2, 4]),
                ..base
            },
        ),
        case(
            "slides on a cube, pushed at 99.9 %",
            "the same, nearly not held",
            100,
            Sliding {
                aside: 0.999,
                on_cube: true,
                cut: Cut::Boxes([2, 2, 4]),
                ..base
            },
        ),
        case(
            "slides and sticks in turn, 50 steps",
            "comes to rest and starts again twice, held by friction alone",
            20,
            Sliding {
                aside: 0.9,
                coefficient: 0.3,
                steps: 50,
                cut: Cut::Boxes([4; 3]),
                ..base
            },
        ),
        case(
            "slides and sticks in turn, whole",
            "the same in one piece",
            20,
            Sliding {
                aside: 0.9,
                coefficient: 0.3,
                steps: 50,
                ..base
            },
        ),
    ]);
    cases
}
