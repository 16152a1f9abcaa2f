//! Friction laws and fields.

use super::Shaft;
use super::bodies::World;
use crate::dice::Dice;
use crate::recipe::{Law, Poly};
use crate::vec3::{Vec3, scale, unit};

/// A field between about `low` and `high` on the bodies.
pub(crate) fn field(dice: &mut Dice, world: &World, centre: Vec3, low: f64, high: f64) -> Poly {
    // three lengths from the centre at most
    let reach = 3.0 * world.length;
    let spread = 0.25 * (high - low) / reach;
    Poly {
        at: centre,
        value: 0.5 * (low + high),
        slope: scale(spread, dice.vector()),
        bend: 0.25 * dice.either() * (high - low) / (reach * reach),
        along: unit(dice.vector()),
    }
}

fn coefficient(dice: &mut Dice) -> f64 {
    if dice.chance(0.1) { dice.between(0.5, 1.0) } else { dice.between(0.05, 0.5) }
}

pub(crate) fn law(dice: &mut Dice, world: &World, shaft: &Shaft, centre: Vec3) -> Law {
    let rate = world.way() / shaft.duration * dice.decades(0.1, 10.0);
    let stress = world.stress() * dice.between(0.0, 0.3);
    match dice.whole(0, 19) {
        0..=3 => Law::None,
        4 | 5 => Law::Given(stress),
        6 => Law::GivenField(field(dice, world, centre, 0.2 * stress, stress)),
        7..=13 => Law::Coulomb(coefficient(dice)),
        14 => {
            let high = coefficient(dice);
            Law::CoulombField(field(dice, world, centre, 0.3 * high, high))
        }
        15 | 16 => {
            let fixed = coefficient(dice);
            Law::Exponential {
                fixed,
                kinetic: fixed * dice.between(0.2, 1.2),
                decay: rate,
            }
        }
        17 | 18 => {
            let [a, b] = [coefficient(dice), coefficient(dice)];
            Law::Table(vec![(0.0, a), (rate, 0.7 * a), (3.0 * rate, 0.5 * b)])
        }
        _ => {
            let high = coefficient(dice);
            Law::RateField(field(dice, world, centre, 0.3 * high, high), rate)
        }
    }
}

/// A law in a word.
pub(crate) fn word(law: &Law) -> String {
    match law {
        Law::None => "none".into(),
        Law::Given(_) => "given".into(),
        Law::GivenField(_) => "given-field".into(),
        Law::Coulomb(c) => format!("coulomb {c:.2}"),
        Law::CoulombField(f) => format!("coulomb-field {:.2}", f.value),
        Law::Exponential { fixed, kinetic, .. } => format!("exponential {fixed:.2}-{kinetic:.2}"),
        Law::Table(points) => format!("table {:.2}-{:.2}", points[0].1, points[2].1),
        Law::RateField(f, _) => format!("rate-field {:.2}", f.value),
    }
}
