//! The lumped blocks of subdomains that are much stiffer than others, brought to the spectrum of the softer ones.
//!
//! A lumped block leaves eigenvalues that grow with the number of elements across its subdomain. Conjugate gradients
//! weigh errors by energy, and a body that is a thousand times stiffer has a thousandth of it: their polynomials suit
//! the soft bodies first, and grow on what the spectrum of the stiff one has beyond. Errors there then appear late, and
//! the iteration begins anew. Blocks of stiff subdomains are therefore scaled down to the largest eigenvalue of softer
//! ones.

use crate::dual::boundary::BoundaryMap;
use crate::linalg::block_rows::BlockRows;
use crate::linalg::sparse::SolveMemory;
use crate::system::tfeti::Tfeti;
use crate::tolerances::{LANCZOS, PIVOT, STIFFER};
use nalgebra::{DMatrix, SymmetricEigen};
use rayon::prelude::*;
use signorini_qp::vector;

/// Scales the lumped blocks of classes all of whose elements are much stiffer than any of others; `None` for those
/// with a Schur complement, which leaves eigenvalues near one, and those that another rank holds.
pub(super) fn even_out(system: &Tfeti, map: &BoundaryMap, mut classes: Vec<Option<&mut BlockRows>>) {
    let subdomains = &system.dual.subdomains;
    let moduli = || subdomains.bases.iter().map(|base| base.moduli);
    let [soft, stiff] = [1, 0].map(|k| moduli().flatten().map(move |r| r[k]));
    let (softest, stiffest) = (soft.fold(f64::INFINITY, f64::min), stiff.fold(0.0, f64::max));
    if stiffest <= STIFFER * softest {
        return;
    }
    // rigid ones come last, and have no block
    let ranges: Vec<[f64; 2]> = moduli().map(|r| r.unwrap_or([f64::INFINITY; 2])).collect();
    let mut largest: Vec<f64> = (0..classes.len())
        .into_par_iter()
        .map(|k| {
            classes[k]
                .as_ref()
                .map_or(1.0, |own| largest_eigenvalue(system, map, k, own))
        })
        .collect();
    subdomains.ownership.complete(&mut largest);
    // softer ones first, with the largest eigenvalue of all up to each
    let mut order: Vec<usize> = (0..classes.len()).collect();
    order.sort_by(|&a, &b| ranges[a][1].total_cmp(&ranges[b][1]).then(a.cmp(&b)));
    let mut up_to: Vec<f64> = Vec::new();
    for &class in &order {
        let softer = order[..up_to.len()].partition_point(|&k| STIFFER * ranges[k][1] < ranges[class][0]);
        let known = softer.checked_sub(1).map(|last| up_to[last]);
        let factor = known.map_or(1.0, |known| (known / largest[class]).min(1.0));
        if let Some(block) = classes[class].as_mut().filter(|_| factor < 1.0) {
            block.scale(factor);
        }
        let own = factor * largest[class];
        up_to.push(up_to.last().map_or(own, |last| own.max(*last)));
    }
}

/// The largest eigenvalue of the inverse of a class times its block, by some steps of Lanczos.
fn largest_eigenvalue(system: &Tfeti, map: &BoundaryMap, class: usize, block: &BlockRows) -> f64 {
    let Some(inverse) = &system.dual.inverses[class] else {
        return 1.0;
    };
    let (kernel, nodes) = (&system.dual.subdomains.bases[class].kernel, &map.classes[class].nodes);
    let places = || nodes.iter().flat_map(|&n| [0, 1, 2].map(|c| 3 * n as usize + c));
    let mut memory = SolveMemory::new(inverse.full.need(1));
    let mut full = vec![0.0; 3 * kernel.nodes()];
    let dim = block.dim();
    // any vector, without a pattern
    let mut next: Vec<f64> = (0..dim).map(|k| ((k * k) as f64 * 0.618 + 0.3).fract() - 0.5).collect();
    let (mut x, mut before, mut image) = (vec![0.0; dim], vec![0.0; dim], vec![0.0; dim]);
    let mut matrix = DMatrix::zeros(LANCZOS, LANCZOS);
    // orthogonal in the block
    for k in 0..LANCZOS {
        block.apply(&next, &mut image, 1);
        let size = vector::dot(&next, &image).max(0.0).sqrt();
        if size <= PIVOT * matrix[(0, 0)] {
            break;
        }
        if k > 0 {
            (matrix[(k - 1, k)], matrix[(k, k - 1)]) = (size, size);
        }
        std::mem::swap(&mut before, &mut x);
        x.iter_mut().zip(&next).for_each(|(x, v)| *x = v / size);
        full.fill(0.0);
        places().zip(&image).for_each(|(place, v)| full[place] = v / size);
        inverse.full.apply(kernel, &mut full, 1, &mut memory);
        places().zip(&mut next).for_each(|(place, v)| *v = full[place]);
        matrix[(k, k)] = vector::dot(&next, &image) / size;
        let (along, back) = (matrix[(k, k)], if k > 0 { size } else { 0.0 });
        for ((next, x), before) in next.iter_mut().zip(&x).zip(&before) {
            *next -= along * x + back * before;
        }
    }
    SymmetricEigen::new(matrix).eigenvalues.max().max(1.0)
}
