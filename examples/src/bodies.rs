//! Two elastic bodies: a pad is pressed on a rail and then pulled along it.
//!
//! The pad shears, its surface begins to slide at the back, and in the end all of it slides: the friction force is then the
//! coefficient times the normal force.

use std::io::Write;
use std::path::Path;

use signorini::prelude::*;

use crate::app::{save, strict};
use crate::error::ExampleError;
use crate::files::RunFiles;
use crate::options::BodiesOptions;
use crate::pictures;
use crate::progress::Progress;
use crate::record::{RunRecord, write_json};
use crate::run::{Header, Outcome, Sink, pool, run};
use crate::table::warnings;

/// Young's modulus of the rail, Pa, and Poisson's ratio of both.
const RAIL: f64 = 2.1e11;
const POISSON: f64 = 0.3;

/// The coefficient of friction.
pub const COEFFICIENT: f64 = 0.3;

/// How far the back of the pad is pressed down and pulled along, m.
const DOWN: f64 = 1e-3;
const ALONG: f64 = 2e-3;

/// Most cells along the edge of a subdomain.
const CELLS: usize = 5;

/// What is added to the tags of the pad.
const PAD: u32 = 100;

/// A tag of the pad, from that of the brick it is.
#[must_use]
pub fn pad(tag: FacetTag) -> FacetTag {
    FacetTag(tag.0 + PAD)
}

/// A cube on a rail of three by one by one half metres, with `cells` along its edges (even); `softness` is Young's modulus of
/// the rail over that of the pad.
///
/// # Errors
/// [`Error`] for sizes and moduli that cannot be.
pub fn scene(cells: usize, steps: usize, softness: f64) -> Result<Scene, Error> {
    let rail = Brick::new([3.0, 1.0, 0.5], [3 * cells, cells, cells.div_ceil(2)]).build()?;
    let cube = Brick::new([1.0, 1.0, 1.0], [cells; 3])
        .build()?
        .map_points(|[x, y, z]| [x + 1.0, y, z + 0.5])?
        .map_tags(pad);
    let mesh = rail.append(&cube)?;
    let regions = mesh.components();
    let materials = Materials::new(vec![
        (0, Hooke::isotropic(RAIL, POISSON)?),
        (1, Hooke::isotropic(RAIL / softness, POISSON)?),
    ])?;
    let back = pad(brick::Z_MAX);
    let cut = cells.div_ceil(CELLS);
    let press = History::table(vec![(0.0, 0.0), (0.2, 1.0), (1.0, 1.0)])?;
    let pull = History::table(vec![(0.0, 0.0), (0.2, 0.0), (1.0, 1.0)])?;
    let scene = Scene::new(mesh.with_regions(regions)?, materials)
        .with_support(Support::fixed(brick::Z_MIN))
        .with_support(
            Support::components(back, [false, true, true]).with_motion([0.0, 0.0, -DOWN], press),
        )
        .with_support(
            Support::components(back, [true, false, false]).with_motion([ALONG, 0.0, 0.0], pull),
        )
        .with_contact(
            Contact::between(pad(brick::Z_MIN), brick::Z_MAX)
                .with_friction(Friction::coulomb(COEFFICIENT)),
        )
        .with_boxes([3 * cut, cut, 3 * cut]);
    Ok(scene.with_analysis(
        Analysis::quasistatic(1.0, steps).with_formula(DifferenceFormula::BACKWARD_EULER),
    ))
}

/// Runs the scene and prints level by level what the contact does.
///
/// # Errors
/// [`ExampleError`] of the library, or if a file cannot be written.
pub fn execute(options: &BodiesOptions, out: &mut impl Write) -> Result<Outcome, ExampleError> {
    let scene = scene(options.common.cells, options.steps, options.softness)?;
    let header = Header {
        n: 1,
        loading: "bodies".to_owned(),
        cells: options.common.cells,
        formula: "backward-euler".to_owned(),
        it_name: options.common.method.iterations().to_owned(),
    };
    let mut progress = Progress::default();
    let mut files = options
        .out
        .as_deref()
        .map(|folder: &Path| RunFiles::new(folder, 1));
    let mut sinks: Vec<&mut dyn Sink> = Vec::new();
    if !options.common.quiet {
        sinks.push(&mut progress);
    }
    if let Some(files) = &mut files {
        sinks.push(files);
    }
    let settings = options.common.settings();
    let pool = pool(options.common.threads)?;
    let outcome = pool.install(|| run(scene, settings, &header, &mut sinks))?;
    print(&outcome.record, out)?;
    if let Some(folder) = &options.out {
        let picture = folder.join(header.label()).join("steps.svg");
        save(&picture, &pictures::steps(&outcome.record)?)?;
    }
    if let Some(path) = &options.common.json {
        write_json(path, std::iter::once(&outcome.record))?;
    }
    strict(options.common.strict, std::iter::once(&outcome.record))?;
    Ok(outcome)
}

/// Friction force over normal force at the end.
#[must_use]
pub fn final_ratio(run: &RunRecord) -> f64 {
    run.steps.last().map_or(f64::NAN, |s| {
        s.tangential_force[0].hypot(s.tangential_force[1]) / s.normal_force
    })
}

fn print(run: &RunRecord, out: &mut impl Write) -> Result<(), ExampleError> {
    writeln!(
        out,
        "     t s  products  stick  slip   normal N  friction N  friction / normal  certificate"
    )?;
    for s in &run.steps {
        writeln!(
            out,
            "{:>8.3} {:>9} {:>6} {:>5} {:>10.3e} {:>11.3e} {:>18.4} {:>12.1e}",
            s.t,
            s.n_m,
            s.stick,
            s.slip,
            s.normal_force,
            s.tangential_force[0],
            s.tangential_force[0] / s.normal_force,
            s.certificate
        )?;
    }
    writeln!(
        out,
        "at the end friction is {:.4} times the normal force; the coefficient is {COEFFICIENT}",
        final_ratio(run)
    )?;
    writeln!(out, "{}", warnings(&[run]))?;
    Ok(())
}
