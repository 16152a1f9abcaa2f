//! Subdomains, time levels, method and accuracy; a scene in words.

use crate::dice::Dice;
use crate::recipe::{Clock, Ending, How, Pieces, Recipe, Solver};
use signorini::prelude::*;

pub(crate) fn clock(dice: &mut Dice) -> Clock {
    let end = if dice.chance(0.6) { 1.0 } else { dice.decades(0.1, 100.0) };
    if dice.chance(0.15) {
        return Clock::Static(end);
    }
    let steps = dice.whole(1, 5);
    let mut times: Vec<f64> = (1..=steps).map(|i| end * i as f64 / steps as f64).collect();
    let weights = match dice.whole(0, 9) {
        0..=3 => [1.5, -2.0, 0.5],
        4..=8 => {
            if dice.chance(0.3) {
                // any steps
                let step = end / steps as f64;
                (0..steps - 1).for_each(|i| times[i] += 0.4 * step * dice.either());
            }
            [1.0, -1.0, 0.0]
        }
        _ => {
            let c = dice.between(0.05, 0.5);
            [1.0 + c, -1.0 - 2.0 * c, c]
        }
    };
    Clock::Steps { times, weights }
}

pub(crate) fn pieces(dice: &mut Dice, mesh: &TetMesh) -> Pieces {
    match dice.whole(0, 3) {
        0 => Pieces::Whole,
        1 | 2 => Pieces::Boxes([dice.whole(1, 3), dice.whole(1, 2), dice.whole(1, 2)]),
        _ => Pieces::Parts(grown(dice, mesh)),
    }
}

/// Parts that grow from seeds through faces, at least one in each body.
fn grown(dice: &mut Dice, mesh: &TetMesh) -> Vec<u32> {
    let tets = mesh.tets().len();
    let mut parts = vec![u32::MAX; tets];
    let mut queue = std::collections::VecDeque::new();
    let mut next = 0;
    for _ in 0..dice.whole(2, 4) {
        let seed = dice.whole(0, tets - 1);
        if parts[seed] == u32::MAX {
            parts[seed] = next;
            queue.push_back(seed);
            next += 1;
        }
    }
    loop {
        while let Some(tet) = queue.pop_front() {
            for other in mesh.neighbours(tet).into_iter().flatten() {
                if parts[other] == u32::MAX {
                    parts[other] = parts[tet];
                    queue.push_back(other);
                }
            }
        }
        let Some(seed) = parts.iter().position(|p| *p == u32::MAX) else {
            return parts;
        };
        parts[seed] = next;
        queue.push_back(seed);
        next += 1;
    }
}

/// Mostly the default, which users see.
pub(crate) fn how(dice: &mut Dice, levels: usize) -> How {
    let mut how = How {
        solver: Solver::Face,
        ending: Ending::Tolerance(1e-6),
        preconditioner: 0,
        extrapolate: true,
        share: true,
        resume: None,
        halving: None,
    };
    if dice.chance(0.55) {
        return how;
    }
    how.solver = match dice.whole(0, 9) {
        0 | 1 => Solver::Paper,
        2 => Solver::OneLoop,
        _ => Solver::Face,
    };
    how.ending = match dice.whole(0, 9) {
        0 => Ending::Relative(dice.decades(1e-7, 1e-5)),
        1 => Ending::Balanced(dice.between(0.02, 0.3)),
        2 | 3 => Ending::Tolerance(dice.decades(1e-9, 1e-6)),
        _ => Ending::Tolerance(1e-6),
    };
    if dice.chance(0.3) {
        // drawn for a setting that is gone: numbers of cases keep their scenes
        let _ = dice.between(0.0, 0.3);
    }
    how.preconditioner = [0, 0, 1, 1, 2][dice.whole(0, 4)];
    dice.chance(0.1); // keeps what earlier seeds give
    how.extrapolate = dice.chance(0.8);
    how.share = dice.chance(0.8);
    if levels > 1 && dice.chance(0.3) {
        how.resume = Some(dice.whole(1, levels - 1));
    }
    how
}

/// Puts into words what is not yet.
pub(crate) fn describe(recipe: &mut Recipe) {
    let how = &recipe.how;
    let mut words = vec![match &recipe.pieces {
        Pieces::Whole => "whole".to_owned(),
        Pieces::Boxes([x, y, z]) => format!("boxes {x}{y}{z}"),
        Pieces::Parts(parts) => format!("parts {}", parts.iter().max().map_or(0, |m| m + 1)),
    }];
    words.push(match &recipe.clock {
        Clock::Static(_) => "static".into(),
        Clock::Steps { times, weights } => {
            format!("{} steps weight {:.2}", times.len(), weights[0])
        }
    });
    if how.is_default() {
        words.push("default".into());
    } else {
        words.push(format!("{:?}", how.solver));
        words.push(format!("{:?}", how.ending));
        words.push(["lumped", "dirichlet", "no preconditioner"][how.preconditioner].into());
        for (word, on) in [
            ("no extrapolation", !how.extrapolate),
            ("no sharing", !how.share),
            ("resumed", how.resume.is_some()),
            ("halved", how.halving.is_some()),
        ] {
            if on {
                words.push(word.into());
            }
        }
    }
    words.push(format!("nodes {}", recipe.mesh.points().len()));
    recipe.words.extend(words);
}
