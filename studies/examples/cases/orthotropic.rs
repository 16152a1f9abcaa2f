//! A block on a floor whose friction differs by direction: 0.3 along one axis, 0.6 across it.
//!
//! Pulled at 30, 45 and 60 degrees to the axis it slides where the friction stress reaches the ellipse, at 0.332820,
//! 0.379473 and 0.453557 of the pressure, and along the normal of the ellipse, at 8.2132, 14.0362 and 23.4132 degrees.
//! The stress is uniform: complementary shear on the sides, Poisson's ratio 0.

use super::{Failure, Finding, solve};
use signorini::prelude::*;

const YOUNG: f64 = 1000.0;
const PRESSURE: f64 = 10.0;
const COEFFICIENTS: [f64; 2] = [0.3, 0.6];
/// Of the axis to x, radians.
const TURN: f64 = 0.4;
/// Way of sliding.
const SLIP: f64 = 1e-4;

/// The top is moved by what shears the block up to the threshold, and a little more in the direction of slip.
pub fn findings(short: bool) -> Result<Vec<Finding>, Failure> {
    let cells = if short { 2 } else { 6 };
    let [a, b] = COEFFICIENTS;
    let mut all = Vec::new();
    for degrees in [30.0_f64, 45.0, 60.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let threshold = (cos / a).hypot(sin / b).recip();
        let along = (sin / (b * b)).atan2(cos / (a * a));
        let (pull, slip) = (degrees.to_radians() + TURN, along + TURN);
        let stress = threshold * PRESSURE;
        let (tx, ty) = (stress * pull.cos(), stress * pull.sin());
        let shear = YOUNG / 2.0;
        let top = [
            tx / shear + SLIP * slip.cos(),
            ty / shear + SLIP * slip.sin(),
            -PRESSURE / YOUNG,
        ];
        let floor = Contact::rigid(brick::Z_MIN)
            .with_friction(Friction::coulomb(a))
            .with_friction_axis([TURN.cos(), TURN.sin(), 0.0], b / a);
        let mesh = Brick::new([1.0; 3], [cells; 3]).build()?;
        let mut scene = Scene::new(mesh, Hooke::isotropic(YOUNG, 0.0)?.into())
            .with_support(Support::fixed(brick::Z_MAX).with_motion(top, History::constant(1.0)))
            .with_contact(floor)
            .with_boxes([2, 2, 2]);
        for (tag, traction) in [
            (brick::X_MAX, tx),
            (brick::X_MIN, -tx),
            (brick::Y_MAX, ty),
            (brick::Y_MIN, -ty),
        ] {
            scene = scene.with_load(Load::traction(tag, [0.0, 0.0, traction]));
        }
        let (mut found, mut direction) = ([0.0; 2], 0.0);
        // of all points those that are farthest off
        let worse = |old: f64, new: f64, target: f64| {
            if (new - target).abs() > (old - target).abs() { new } else { old }
        };
        let run = solve(scene, Settings::default().with_tolerance(1e-10), |result| {
            let of = |p: &PointState| {
                let [x, y, _] = p.friction_force.map(|f| -f / p.area);
                (
                    [x.hypot(y) / PRESSURE, y.atan2(x) - TURN],
                    p.difference[1].atan2(p.difference[0]) - TURN,
                )
            };
            ([found[0], found[1]], direction) = of(&result.points()[0]);
            for p in result.points() {
                let ([size, angle], way) = of(p);
                found = [
                    worse(found[0], size, threshold),
                    worse(found[1], angle, degrees.to_radians()),
                ];
                direction = worse(direction, way, along);
            }
        })?;
        let finding = |quantity, value, target| Finding {
            case: format!("orthotropic block, pulled at {degrees} degrees"),
            quantity,
            value,
            target,
            asked: 1e-6,
            run,
        };
        all.push(finding("threshold over pressure", found[0], threshold));
        all.push(finding(
            "direction of friction, degrees",
            found[1].to_degrees(),
            degrees,
        ));
        all.push(finding(
            "direction of slip, degrees",
            direction.to_degrees(),
            along.to_degrees(),
        ));
    }
    Ok(all)
}
