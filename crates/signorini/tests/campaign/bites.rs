//! The check bites: judged by a recipe that differs by a few per cent in one thing, solved levels violate something.

use crate::apart::{Apart, Bed, Rest, Shape};
use crate::check::Judge;
use crate::check::apart::ApartJudge;
use crate::generate;
use crate::recipe::{Clock, Course, Density, Distance, Elastic, Fixed, Law, Recipe};
use crate::run::{LIMIT, each_apart_level, each_level};
use signorini::prelude::StepResult;

/// Share by which a datum is changed.
const MORE: f64 = 1.02;

/// Scenes in which each change has to be seen.
const ENOUGH: usize = 4;

fn scaled(course: &Course) -> Course {
    match course {
        Course::Constant(value) => Course::Constant(MORE * value),
        Course::Table(points) => Course::Table(points.iter().map(|(t, v)| (*t, MORE * v)).collect()),
        Course::Wave { size, pace, phase } => Course::Wave {
            size: MORE * size,
            pace: *pace,
            phase: *phase,
        },
    }
}

type Change = (&'static str, fn(&mut Recipe));

/// What is changed, and how.
const CHANGES: [Change; 8] = [
    ("stiffness", |r| {
        for elastic in &mut r.elastic {
            match elastic {
                Elastic::Isotropic(young, _) => *young *= MORE,
                Elastic::Matrix(m) => m.iter_mut().flatten().for_each(|c| *c *= MORE),
            }
        }
    }),
    ("Poisson's ratio", |r| {
        for elastic in &mut r.elastic {
            if let Elastic::Isotropic(_, poisson) = elastic {
                *poisson -= 0.02;
            }
        }
    }),
    ("loads", |r| {
        r.pushes.iter_mut().for_each(|p| p.course = scaled(&p.course));
    }),
    ("motions of supports", |r| {
        let motions = r.holds.iter_mut().filter_map(|h| h.motion.as_mut());
        motions.for_each(|m| m.1 = scaled(&m.1));
    }),
    ("motions of obstacles", |r| {
        let motions = r.touches.iter_mut().filter_map(|t| t.motion.as_mut());
        motions.for_each(|m| m.1 = scaled(&m.1));
    }),
    ("gaps", |r| {
        for touch in &mut r.touches {
            match &mut touch.distance {
                Distance::Constant(gap) => *gap *= MORE,
                Distance::Field(field) => field.value *= MORE,
                _ => {}
            }
        }
    }),
    ("friction", |r| {
        for touch in &mut r.touches {
            match &mut touch.law {
                Law::Given(value) | Law::Coulomb(value) => *value *= MORE,
                Law::GivenField(field) | Law::CoulombField(field) | Law::RateField(field, _) => {
                    field.value *= MORE;
                }
                Law::Exponential { decay, .. } => *decay *= MORE,
                Law::Table(points) => points.iter_mut().for_each(|p| p.0 *= MORE),
                Law::None => {}
            }
        }
    }),
    ("difference formula", |r| {
        if let Clock::Steps { weights, .. } = &mut r.clock {
            let [_, _, last] = *weights;
            let other = last + 0.02;
            *weights = [1.0 + other, -1.0 - 2.0 * other, other];
        }
    }),
];

/// What is not said to be solved violates conditions of its own recipe, too.
fn is_solved(frame: &StepResult) -> bool {
    frame.report().status.converged() && frame.report().unconverged_history.is_none()
}

#[test]
fn other_recipes_do_not_fit() {
    let mut found = [0; CHANGES.len()];
    let mut number = 0;
    let mut ran = 0;
    while ran < 40 {
        number += 1;
        let recipe = generate::recipe(crate::SEED, number);
        if !recipe.how.is_default() || recipe.words.iter().any(|w| w.starts_with("loose")) {
            continue;
        }
        ran += 1;
        let changed = CHANGES.map(|(_, change)| {
            let mut other = recipe.clone();
            change(&mut other);
            other
        });
        let mut judges = changed.each_ref().map(Judge::new);
        let mut worst = [0.0_f64; CHANGES.len()];
        let outcome = each_level(&recipe, |frame| {
            for (judge, worst) in judges.iter_mut().zip(&mut worst) {
                let violations = judge.step(frame)?;
                if is_solved(frame) {
                    *worst = violations.iter().map(|v| v.1).fold(*worst, f64::max);
                }
            }
            Ok(())
        });
        outcome.expect("scene");
        for (found, worst) in found.iter_mut().zip(worst) {
            *found += usize::from(worst > 3.0 * LIMIT);
        }
    }
    let list: Vec<_> = CHANGES.iter().map(|c| c.0).zip(found).collect();
    assert!(found.iter().all(|f| *f >= ENOUGH), "of {ran} scenes: {list:?}");
}

type ApartChange = (&'static str, fn(&mut Apart));

/// What only bodies meshed apart and obstacles of any shape have.
const APART_CHANGES: [ApartChange; 9] = [
    ("stiffness of the upper body", |a| {
        if let Elastic::Isotropic(young, _) = &mut a.recipe.elastic[1] {
            *young *= MORE;
        }
    }),
    ("friction between bodies", |a| {
        for pair in &mut a.pairs {
            if let Law::Given(value) | Law::Coulomb(value) = &mut pair.law {
                *value *= MORE;
            }
        }
    }),
    ("friction across the axis", |a| {
        let axes = a.pairs.iter_mut().filter_map(|p| p.axis.as_mut());
        axes.for_each(|axis| axis.1 *= 1.1);
    }),
    ("radius", |a| {
        for rock in &mut a.rocks {
            if let Shape::Ball(_, radius) | Shape::Roll(.., radius) = &mut rock.shape {
                *radius *= MORE;
            }
        }
    }),
    ("common area", |a| a.pairs.iter_mut().for_each(|p| p.common /= MORE)),
    ("normal compliance", |a| {
        a.pairs.iter_mut().for_each(|p| p.compliance[0] *= MORE);
        a.rocks.iter_mut().for_each(|r| r.compliance[0] *= MORE);
    }),
    ("tangential compliance", |a| {
        a.pairs.iter_mut().for_each(|p| p.compliance[1] *= MORE);
        a.rocks.iter_mut().for_each(|r| r.compliance[1] *= MORE);
    }),
    ("angle of obstacles", |a| {
        let turns = a.rocks.iter_mut().filter_map(|r| r.turn.as_mut());
        turns.for_each(|turn| turn.2 = turn.2.clone().times(1.1));
    }),
    ("foundation", |a| {
        if let Some((_, Bed::Components(stiffness))) = &mut a.ground {
            stiffness[0] *= MORE;
        }
    }),
];

/// What only fitted bodies have.
const FIT_CHANGES: [ApartChange; 8] = [
    ("moments", |a| {
        for push in &mut a.recipe.pushes {
            if let Density::Moment(_, value) = &mut push.density {
                *value = value.map(|m| MORE * m);
            }
        }
    }),
    ("forces", |a| {
        for push in &mut a.recipe.pushes {
            if let Density::Force(_, value) = &mut push.density {
                *value = value.map(|f| MORE * f);
            }
        }
    }),
    ("interference", |a| {
        for pair in &mut a.pairs {
            if let Rest::Given(gap) = &mut pair.rest {
                *gap *= MORE;
            }
        }
    }),
    ("growth of gaps", |a| {
        let growths = a.pairs.iter_mut().filter_map(|p| p.growth.as_mut());
        growths.for_each(|growth| *growth = scaled(growth));
    }),
    ("growth of gaps to obstacles", |a| {
        let growths = a.rocks.iter_mut().filter_map(|r| r.growth.as_mut());
        growths.for_each(|growth| *growth = scaled(growth));
    }),
    ("motions about the axis", |a| {
        let held = a.recipe.holds.iter_mut();
        let about = held.filter(|h| matches!(h.fixed, Fixed::About(..)));
        let motions = about.filter_map(|h| h.motion.as_mut());
        motions.for_each(|m| m.1 = scaled(&m.1));
    }),
    ("foundation along normals", |a| {
        if let Some((_, Bed::Normal(stiffness))) = &mut a.ground {
            *stiffness *= MORE;
        }
    }),
    ("angle of what is displaced, too", |a| {
        let both = a.rocks.iter_mut().filter(|r| r.motion.is_some());
        let turns = both.filter_map(|r| r.turn.as_mut());
        turns.for_each(|turn| turn.2 = turn.2.clone().times(1.1));
    }),
];

#[test]
fn other_pairs_do_not_fit() {
    bite(&APART_CHANGES, 0..250, generate::apart::apart);
}

#[test]
fn other_rings_do_not_fit() {
    let small = |number: &u64| generate::fit::fit(crate::SEED, *number).recipe.mesh.points().len() < 130;
    bite(&FIT_CHANGES, (0..600).filter(small), generate::fit::fit);
}

/// Of each change, enough scenes in which it is seen.
fn bite(changes: &[ApartChange], numbers: impl Iterator<Item = u64>, generate: impl Fn(u64, u64) -> Apart) {
    let mut found = vec![0; changes.len()];
    for number in numbers {
        let scene = generate(crate::SEED, number);
        if !scene.recipe.how.is_default() {
            continue;
        }
        let mut other: Vec<Apart> = vec![scene.clone(); changes.len()];
        other
            .iter_mut()
            .zip(changes)
            .for_each(|(other, change)| change.1(other));
        let mut judges: Vec<ApartJudge<'_>> = other.iter().map(ApartJudge::new).collect();
        let mut worst = vec![0.0_f64; changes.len()];
        let outcome = each_apart_level(&scene, |simulation, frame| {
            for (judge, worst) in judges.iter_mut().zip(&mut worst) {
                let violations = judge.step(simulation.constrained_points(), frame)?;
                if is_solved(frame) {
                    *worst = violations.iter().map(|v| v.1).fold(*worst, f64::max);
                }
            }
            Ok(())
        });
        outcome.expect("scene");
        for (found, worst) in found.iter_mut().zip(worst) {
            *found += usize::from(worst > 3.0 * LIMIT);
        }
        if found.iter().all(|f| *f >= ENOUGH) {
            return;
        }
    }
    let list: Vec<_> = changes.iter().map(|c| c.0).zip(found).collect();
    panic!("{list:?}");
}
