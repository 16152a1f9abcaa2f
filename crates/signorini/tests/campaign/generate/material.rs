//! Elasticity: isotropic or not, the same everywhere or by region.

use super::bodies::World;
use crate::dice::Dice;
use crate::recipe::Elastic;
use crate::vec3::{Vec3, add, scale};
use signorini::prelude::*;

pub(crate) fn materials(dice: &mut Dice, world: &World) -> (TetMesh, Vec<Elastic>, String) {
    let mesh = world.mesh.clone();
    let tets = mesh.tets().len();
    let regions: Option<Vec<u32>> = match dice.whole(0, 9) {
        0..=5 => None,
        6 | 7 if world.count > 1 => Some(mesh.components()),
        _ => {
            // on both sides of a plane
            let centre = |t: usize| {
                let corners = mesh.tet_points(t);
                corners.into_iter().fold([0.0; 3], |s: Vec3, p| add(s, scale(0.25, p)))
            };
            let axis = dice.whole(0, 2);
            let all: Vec<f64> = (0..tets).map(|t| centre(t)[axis]).collect();
            let mean = all.iter().sum::<f64>() / tets as f64;
            let mut regions: Vec<u32> = all.iter().map(|x| u32::from(*x > mean)).collect();
            if !regions.contains(&1) {
                regions[0] = 1;
            }
            Some(regions)
        }
    };
    let count = regions.iter().flatten().max().map_or(1, |m| *m as usize + 1);
    let contrast = if dice.chance(0.8) { 5.0 } else { 300.0 };
    let mut word = String::from("isotropic");
    let mut elastic = Vec::new();
    for region in 0..count {
        let factor = if region == 0 { 1.0 } else { dice.decades(1.0 / contrast, contrast) };
        let (young, poisson) = (factor * world.young, dice.between(-0.1, 0.45));
        elastic.push(if dice.chance(0.25) {
            word = "anisotropic".into();
            Elastic::Matrix(Box::new(anisotropic(dice, young, poisson)))
        } else {
            Elastic::Isotropic(young, poisson)
        });
    }
    if count > 1 {
        word += &format!(" x{count}");
    }
    let mesh = match regions {
        Some(regions) => mesh.with_regions(regions).expect("regions"),
        None => mesh,
    };
    (mesh, elastic, word)
}

/// An isotropic law and some stiffness along a few directions of strain.
pub(super) fn anisotropic(dice: &mut Dice, young: f64, poisson: f64) -> [[f64; 6]; 6] {
    let shear = young / (2.0 * (1.0 + poisson));
    let lambda = 2.0 * shear * poisson / (1.0 - 2.0 * poisson);
    let mut c = [[0.0; 6]; 6];
    for i in 0..3 {
        c[i][..3].fill(lambda);
        c[i][i] += 2.0 * shear;
        c[i + 3][i + 3] = shear;
    }
    for _ in 0..3 {
        let v: [f64; 6] = std::array::from_fn(|_| dice.either());
        let size = young * dice.between(0.1, 0.6);
        for i in 0..6 {
            for j in 0..6 {
                c[i][j] += size * v[i] * v[j];
            }
        }
    }
    c
}
