//! Points without elements: what they may have, how equations measure them, and where these say nothing.

use crate::error::ContactError;
use crate::scene::{Equation, LoadKind, Scene};
use crate::tolerances::ALONG;
use signorini_fem_mesh::vec3::{Vec3, add, dot, is_finite, norm, scale, sub, unit};
use std::collections::BTreeMap;

/// Refuses what a point alone does not have: moments and rotations.
pub(super) fn check_point(scene: &Scene, index: usize) -> Result<(), ContactError> {
    let turned = scene.couplings[index]
        .motions
        .iter()
        .any(|(way, _)| way[3..] != [0.0; 3]);
    let moments = scene.loads.iter().any(|load| match &load.kind {
        LoadKind::Coupling(own) => own.coupling == index && own.moment != [0.0; 3],
        LoadKind::Density(_) | LoadKind::Eigenstrain(_) => false,
    });
    if turned || moments {
        Err(ContactError::coupling(
            index,
            None,
            "a point has no rotations, and takes no moments; give it displacements and forces",
        ))
    } else {
        Ok(())
    }
}

/// How much nodes move per displacement of each point, by the equation in which it counts most, a power of two; of
/// points that equations join to other points only, by these.
pub(super) fn sizes(scene: &Scene) -> Vec<f64> {
    let length = |sum: f64, vector: Vec3| vector.into_iter().fold(sum, f64::hypot);
    let count = scene.couplings.len();
    let own = |equation: &Equation| {
        let mut own: BTreeMap<usize, f64> = BTreeMap::new();
        for (point, vector) in equation.points.iter().filter(|p| p.0 < count) {
            let sum = own.entry(*point).or_default();
            *sum = length(*sum, *vector);
        }
        own
    };
    let equations: Vec<(f64, BTreeMap<usize, f64>)> = (scene.equations.iter())
        .map(|e| (e.terms.iter().fold(0.0, |sum, t| length(sum, t.1)), own(e)))
        .collect();
    let mut sizes = vec![0.0_f64; count];
    let known = |ratio: &f64| ratio.is_finite() && *ratio > 0.0;
    for (nodes, points) in &equations {
        for (point, own) in points {
            sizes[*point] = Some(own / nodes)
                .filter(known)
                .map_or(sizes[*point], |r| r.max(sizes[*point]));
        }
    }
    loop {
        let mut found = Vec::new();
        for (_, points) in &equations {
            let told = points.iter().map(|(point, own)| own / sizes[*point]).filter(known);
            let most = told.fold(0.0, f64::max);
            let new = points.iter().filter(|p| sizes[*p.0] == 0.0);
            found.extend(new.map(|(point, own)| (*point, own / most)).filter(|f| known(&f.1)));
        }
        if found.is_empty() {
            break;
        }
        found
            .into_iter()
            .for_each(|(point, ratio)| sizes[point] = ratio.max(sizes[point]));
    }
    sizes.into_iter().map(power_of_two).collect()
}

/// The power of two next to a size; 1 for what has none.
pub(crate) fn power_of_two(size: f64) -> f64 {
    if size > 0.0 && size.is_finite() {
        size.log2().round().clamp(-900.0, 900.0).exp2()
    } else {
        1.0
    }
}

/// The directions of a point of which neither an equation nor the coupling itself says anything: it stays there.
pub(super) fn idle(scene: &Scene, index: usize, axes: &[Vec3; 3]) -> Result<Vec<Vec3>, ContactError> {
    let holds = scene.couplings[index].holds();
    let mut known: Vec<Vec3> = (0..3).filter(|&c| holds[c]).map(|c| axes[c]).collect();
    let rest = |known: &[Vec3], vector: Vec3| {
        let all = [known, known].concat();
        let rest = all.iter().fold(vector, |rest, d| sub(rest, scale(dot(rest, *d), *d)));
        let is_left = norm(rest) > ALONG * norm(vector);
        is_left.then(|| unit(rest))
    };
    for equation in &scene.equations {
        let own = equation.points.iter().filter(|term| term.0 == index);
        let sum = own.fold([0.0; 3], |sum, term| add(sum, term.1));
        if is_finite(sum) {
            known.extend(rest(&known, sum));
        }
    }
    let told = known.len();
    for axis in axes {
        known.extend(rest(&known, *axis));
    }
    let idle = known.split_off(told);
    let pushed = scene.loads.iter().any(|load| match &load.kind {
        LoadKind::Coupling(own) => {
            let along = |d: &Vec3| dot(own.force, *d).abs() > ALONG * norm(own.force);
            own.coupling == index && idle.iter().any(along)
        }
        LoadKind::Density(_) | LoadKind::Eigenstrain(_) => false,
    });
    if pushed {
        Err(ContactError::coupling(
            index,
            None,
            "a load pushes the point in a direction of which no equation says anything, so that it acts on \
                nothing; give it an equation, or leave the load out",
        ))
    } else {
        Ok(idle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_powers_of_two() {
        for (size, unit) in [(0.0, 1.0), (f64::NAN, 1.0), (3.1, 4.0), (1e-3, 0.5f64.powi(10))] {
            assert_eq!(power_of_two(size), unit);
        }
    }
}
