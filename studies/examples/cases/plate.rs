//! A plate pressed on a rigid plane and pushed along it, with a coefficient of one (GRECO; Code_Aster SSNV128).
//!
//! Half of a plate of 80 x 40 mm in plane strain, E 130 GPa, nu 0.2, pressure 50 MPa above and 150 MPa on the free
//! side. Asked are displacements along the plane at some distances from the free side, those of the finest plane model
//! of Code_Aster. Its quadratic tetrahedra, one over the thickness as here, have 2.87187e-5 and 2.28971e-5 m at 0 and
//! 5 mm.

use super::{Failure, Finding, solve};
use signorini::prelude::*;

const SIZE: f64 = 0.04;

/// The displacements, on a mesh of quadratic elements.
pub fn findings(short: bool) -> Result<Vec<Finding>, Failure> {
    let cells = if short { 16 } else { 32 };
    let mesh = Brick::new([SIZE, SIZE, 1e-3], [cells, cells, 1])
        .build()?
        .raise_order()?;
    let axis = |c: usize| [c == 0, c == 1, c == 2];
    let scene = Scene::new(mesh, Hooke::isotropic(1.3e11, 0.2)?.into())
        .with_support(Support::components(brick::X_MAX, axis(0)))
        .with_support(Support::components(brick::Z_MIN, axis(2)))
        .with_support(Support::components(brick::Z_MAX, axis(2)))
        .with_load(Load::pressure(brick::Y_MAX, 5e7))
        .with_load(Load::pressure(brick::X_MIN, 15e7))
        .with_contact(Contact::rigid(brick::Y_MIN).with_friction(Friction::coulomb(1.0)));
    let targets = [
        (0.0, "displacement at 0 mm, m", 2.85985e-5),
        (1.25e-3, "displacement at 1.25 mm, m", 2.72076e-5),
        (5e-3, "displacement at 5 mm, m", 2.28269e-5),
        (7.5e-3, "displacement at 7.5 mm, m", 1.97916e-5),
        (11.25e-3, "displacement at 11.25 mm, m", 1.54064e-5),
    ];
    let mut found = [0.0; 5];
    let run = solve(scene, Settings::default(), |result| {
        let points = result.scene().mesh().points();
        found = targets.map(|(x, ..)| {
            let on = |p: &[f64; 3]| (p[0] - x).abs() < 1e-9 && p[1] == 0.0;
            let there = (0..points.len()).filter(|&n| on(&points[n]));
            let moved: Vec<f64> = there.map(|n| result.displacement()[n][0]).collect();
            moved.iter().sum::<f64>() / moved.len() as f64
        });
    })?;
    let all = targets.into_iter().zip(found);
    let all = all.map(|((_, quantity, target), value)| Finding {
        case: "plate, coefficient 1".to_owned(),
        quantity,
        value,
        target,
        asked: 5e-3,
        run,
    });
    Ok(all.collect())
}
