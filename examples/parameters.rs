//! A study over a parameter: a block on a floor is pressed and pulled, for several coefficients of friction.
//!
//! Scenes share their mesh, and a run that ends otherwise than it should is told apart by its error. Results go to
//! other programs as a line of JSON each.

use signorini::prelude::*;
use std::error::Error as StdError;
use std::sync::Arc;

/// What comes of a coefficient.
#[derive(Debug)]
pub enum Outcome {
    /// Friction holds the block: what its contact does.
    Held(Arc<StepResult>),
    /// It slides away, and would be held from this coefficient on.
    Slides(f64),
}

fn main() -> Result<(), Box<dyn StdError>> {
    let block = block()?;
    for coefficient in [0.1, 0.2, 0.26, 0.3, 0.5, 1.0] {
        match solve(&block, coefficient)? {
            Outcome::Held(result) => println!(
                "{{\"coefficient\": {coefficient}, \"contact\": {}, \"certificate\": {}}}",
                serde_json::to_string(result.summary())?,
                serde_json::to_string(result.certificate())?
            ),
            Outcome::Slides(needed) => {
                println!("{{\"coefficient\": {coefficient}, \"needed\": {needed:.6}}}");
            }
        }
    }
    Ok(())
}

/// A steel block of 3 x 1 x 1 m, pressed on its top by 1 MPa and pulled at one end with a quarter of that force.
pub fn block() -> Result<Scene, Error> {
    let mesh = Brick::new([3.0, 1.0, 1.0], [12, 4, 4]).build()?;
    let steel = Materials::uniform(Hooke::isotropic(2.1e11, 0.3)?);
    Ok(Scene::new(mesh, steel)
        .with_load(Load::pressure(brick::Z_MAX, 1e6))
        .with_load(Load::traction(brick::X_MAX, [0.75e6, 0.0, 0.0])))
}

/// Solves the one step of a scene to which a floor is added.
pub fn solve(block: &Scene, coefficient: f64) -> Result<Outcome, Error> {
    let floor = Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(coefficient));
    let scene = block.clone().with_contact(floor);
    let made = Simulation::new(scene, Settings::default());
    // the set-up knows by which factor friction is too small; `plain` is the error without names that a scene may have
    if let Err(ContactError::NotHeld {
        friction: Some(factor), ..
    }) = made.as_ref().map_err(ContactError::plain)
    {
        return Ok(Outcome::Slides(factor * coefficient));
    }
    let mut simulation = made?;
    let result = simulation.step()?;
    // any other end is an error that says what to do
    result.require_converged()?;
    Ok(Outcome::Held(result))
}
