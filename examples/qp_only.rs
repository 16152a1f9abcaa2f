//! Quadratic programming without mechanics: only the crate `signorini-qp`.
//!
//! A string over an obstacle (bounds) by KPRGP, and three unknowns with a disc and an equality by SMALSE. `kkt`
//! checks the conditions of optimality with code that the solvers do not share.

use std::f64::consts::PI;

use signorini_qp::kprgp::{Expansion, KprgpReport, KprgpWorkspace};
use signorini_qp::problem::BlockState;
use signorini_qp::smalse::SmalseWorkspace;
use signorini_qp::*;

/// Stiffness of a string of 98 nodes between two fixed ends: -1, 2, -1.
struct Stiffness;

impl SymmetricOperator for Stiffness {
    type Scratch = ();

    fn dim(&self) -> usize {
        98
    }

    fn scratch(&self) {}

    fn apply(&self, x: &[f64], y: &mut [f64], _: &mut ()) {
        let at = |i: usize| x.get(i).unwrap_or(&0.0);
        for i in 0..98 {
            y[i] = 2.0 * x[i] - at(i.wrapping_sub(1)) - at(i + 1);
        }
    }
}

fn main() -> Result<(), QpError> {
    for expansion in [Expansion::FixedStep, Expansion::ProjectedCg] {
        let (report, resting, kkt) = string(expansion)?;
        let (products, cost) = (report.products.total(), report.cost);
        println!("{expansion:?}: {products} products, {resting} nodes rest, cost {cost:.9}, KKT {kkt:.0e}");
    }
    let (x, multiplier, kkt) = disc()?;
    println!("disc and equality: {x:.9?}, multiplier {multiplier:.9}, KKT {kkt:.0e}");
    Ok(())
}

/// Solves the string to 1e-5: the report, the nodes on the obstacle, the distance from optimality.
pub fn string(expansion: Expansion) -> Result<(KprgpReport, usize, f64), QpError> {
    let h = 1.0 / 99.0;
    let load = [-30.0 * h * h; 98];
    let obstacle = |i: usize| (4.0 * PI * i as f64 * h - PI / 6.0).sin() / 2.0 - 2.0;
    let set = ProductSet::new(vec![Segment::lower((1..99).map(obstacle).collect())])?;
    // the largest eigenvalue is known here; `norm_estimate` finds it otherwise
    let (norm, limit) = (2.0 + 2.0 * (PI * h).cos(), 1e-5);
    let settings = KprgpSettings::default().with_expansion(expansion);
    let (mut x, mut work) = ([0.0; 98], KprgpWorkspace::new(&Stiffness));
    let cost = QuadraticCost::new(&Stiffness, &load, norm);
    let report = kprgp(&cost, &set, limit, &settings, &mut x, &mut work)?;
    let mut resting = 0;
    set.for_each_block(&x, &mut |block| {
        resting += usize::from(block.state == BlockState::AtLower);
    });
    let kkt = kkt::check(&cost, &set, &x)?.relative();
    Ok((report, resting, kkt))
}

/// Minimises `|x|^2 / 2 - 1.8 x0 - 2.2 x1` with `|(x0, x1)| <= 1`, `x2` free and `x1 + x2 = 1`: exactly (0.6, 0.8,
/// 0.2) with the multiplier -0.2 of the equality. The last number is the distance from optimality.
pub fn disc() -> Result<([f64; 3], f64, f64), QpError> {
    let a = DenseOperator::new(3, vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])?;
    let b = [1.8, 2.2, 0.0];
    let mut set = ProductSet::new(vec![Segment::discs(vec![1.0]), Segment::Free(1)])?;
    let c = DenseEquality::orthonormal(1, 3, &[0.0, 1.0, 1.0])?;
    let e = c.right_side(&[1.0])?;
    let settings = SmalseSettings::default().with_tolerance(1e-10).with_equality(1e-10);
    let (mut x, mut mu, mut work) = ([0.0; 3], [0.0], SmalseWorkspace::new(&a, &c));
    let cost = QuadraticCost::new(&a, &b, 1.0).with_equality(&c, &e);
    let report = smalse(&cost, MovingSet::fixed(&mut set), &mut x, &mut mu, &settings, &mut work)?;
    assert!(report.status.converged(), "{report:?}");
    let multiplier = work.equality_multiplier();
    let kkt = kkt::check_with(&cost, &set, &x, multiplier)?.relative();
    Ok((x, c.original_multiplier(multiplier)?[0], kkt))
}
