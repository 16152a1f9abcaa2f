//! Two elastic bodies: a pad is pressed on a rail and then pulled along it.
//!
//! The pad shears, begins to slide at its back, and in the end all of it slides: friction is then the coefficient
//! times the normal force.

use signorini::prelude::*;

/// The coefficient of friction.
pub const COEFFICIENT: f64 = 0.3;

fn main() -> Result<(), Error> {
    let mut simulation = Simulation::new(scene(4, 10, 10.0)?, Settings::default())?;
    println!("  t in s  stick  slip  normal in N  friction in N  friction / normal");
    while !simulation.is_finished() {
        let result = simulation.step()?;
        result.require_converged()?;
        let sum = result.summary();
        let (normal, friction) = (sum.normal_force, sum.friction_force[0]);
        println!(
            "{:>8.2} {:>6} {:>5} {normal:>12.3e} {friction:>14.3e} {:>18.4}",
            result.time(),
            sum.stick,
            sum.slip,
            friction / normal
        );
    }
    Ok(())
}

/// A cube on a rail of 3 x 1 x 0.5 m, with `cells` cells along a metre (even). The rail is steel, the cube
/// `softness` times softer.
pub fn scene(cells: usize, steps: usize, softness: f64) -> Result<Scene, Error> {
    let (young, poisson) = (2.1e11, 0.3);
    // facets of the pad get tags of their own: those of a brick, plus 100
    let pad = |tag: FacetTag| FacetTag(tag.0 + 100);
    let rail = Brick::new([3.0, 1.0, 0.5], [3 * cells, cells, cells.div_ceil(2)]).build()?;
    let cube = Brick::new([1.0, 1.0, 1.0], [cells; 3])
        .build()?
        .map_points(|[x, y, z]| [x + 1.0, y, z + 0.5])?
        .map_tags(pad);
    let mesh = rail.append(&cube)?;
    // one region, and so one material, a body
    let regions = mesh.components();
    let materials = Materials::new(vec![
        (0, Hooke::isotropic(young, poisson)?),
        (1, Hooke::isotropic(young / softness, poisson)?),
    ])?;
    // the back of the pad goes down by 1 mm, then along by 2 mm
    let press = Support::components(pad(brick::Z_MAX), [false, true, true]);
    let drag = Support::components(pad(brick::Z_MAX), [true, false, false]);
    let down = History::table(vec![(0.0, 0.0), (0.2, 1.0), (1.0, 1.0)])?;
    let along = History::table(vec![(0.0, 0.0), (0.2, 0.0), (1.0, 1.0)])?;
    let contact = Contact::between(pad(brick::Z_MIN), brick::Z_MAX);
    // subdomains of at most five cells an edge
    let boxes = cells.div_ceil(5);
    Ok(Scene::new(mesh.with_regions(regions)?, materials)
        .with_support(Support::fixed(brick::Z_MIN))
        .with_support(press.with_motion([0.0, 0.0, -1e-3], down))
        .with_support(drag.with_motion([2e-3, 0.0, 0.0], along))
        .with_contact(contact.with_friction(Friction::coulomb(COEFFICIENT)))
        .with_boxes([3 * boxes, boxes, 3 * boxes])
        .with_analysis(Analysis::quasistatic(1.0, steps)))
}
