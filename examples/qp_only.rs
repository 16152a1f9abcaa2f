//! Quadratic programming without mechanics: only the crate `signorini-qp`.
//!
//! A string over an obstacle (bounds) by KPRGP, and three unknowns with a disc and an equality by SMALSE. `kkt` checks the
//! conditions of optimality with code that the solvers do not share.

use signorini_qp::{
    BlockState, ConvexSet, DenseEquality, DenseOperator, Expansion, KprgpSettings, KprgpWorkspace,
    ProductSet, QpError, Segment, SmalseSettings, SmalseWorkspace, SymmetricOperator, Tolerance,
    kkt, kprgp, smalse,
};

/// Nodes of the string, the two fixed ends included.
const NODES: usize = 100;

/// Stiffness of the string: -1, 2, -1 inside, unit rows at both ends.
struct Stiffness;

impl SymmetricOperator for Stiffness {
    type Scratch = ();

    fn dim(&self) -> usize {
        NODES
    }

    fn scratch(&self) {}

    fn apply(&self, x: &[f64], y: &mut [f64], _: &mut ()) {
        let inner = |i: usize| if i > 0 && i + 1 < NODES { x[i] } else { 0.0 };
        for i in 0..NODES {
            let end = i == 0 || i + 1 == NODES;
            y[i] = if end {
                x[i]
            } else {
                2.0 * x[i] - inner(i - 1) - inner(i + 1)
            };
        }
    }
}

fn main() -> Result<(), QpError> {
    for expansion in [Expansion::FixedStep, Expansion::ProjectedCg] {
        let (cost, resting, products, kkt) = string(expansion)?;
        println!(
            "string, {expansion:?}: {products} products, {resting} nodes rest, cost {cost:.9}, KKT {kkt:.1e}"
        );
    }
    let (x, multiplier, kkt) = disc()?;
    println!("disc and equality: x = {x:.9?}, multiplier {multiplier:.9}, KKT {kkt:.1e}");
    Ok(())
}

/// Solves the string to 1e-5: its cost, the nodes on the obstacle, products with the stiffness, distance from optimality.
pub fn string(expansion: Expansion) -> Result<(f64, usize, usize, f64), QpError> {
    let h = 1.0 / (NODES as f64 - 1.0);
    let pi = std::f64::consts::PI;
    let inside = |i: usize| i > 0 && i + 1 < NODES;
    let obstacle = |i: usize| (4.0 * pi * i as f64 * h - pi / 6.0).sin() / 2.0 - 2.0;
    let load: Vec<f64> = (0..NODES)
        .map(|i| if inside(i) { -30.0 * h * h } else { 0.0 })
        .collect();
    let lower = (0..NODES)
        .map(|i| if inside(i) { obstacle(i) } else { 0.0 })
        .collect();
    let set = ProductSet::new(vec![Segment::lower(lower)])?;
    // the largest eigenvalue is known here; `norm_estimate` finds it otherwise
    let norm = 2.0 + 2.0 * (pi * h).cos();
    let settings = KprgpSettings::default().with_expansion(expansion);
    let (mut x, mut work) = (vec![0.0; NODES], KprgpWorkspace::new(&Stiffness));
    let report = kprgp(
        &Stiffness,
        &load,
        &set,
        norm,
        Tolerance::Relative(1e-5),
        &settings,
        &mut x,
        &mut work,
    )?;
    let mut resting = 0;
    set.for_each_block(&x, &mut |block| {
        resting += usize::from(block.state == BlockState::AtLower)
    });
    let kkt = kkt::check(&Stiffness, &load, &set, &x, norm)?.relative();
    Ok((report.cost, resting, report.products.total(), kkt))
}

/// Minimises `|x|^2 / 2 - 1.8 x0 - 2.2 x1` with `|(x0, x1)| <= 1`, `x2` free and `x1 + x2 = 1`: exactly (0.6, 0.8, 0.2) with
/// the multiplier -0.2 of the equality. The last number is the distance from optimality.
pub fn disc() -> Result<([f64; 3], f64, f64), QpError> {
    let a = DenseOperator::new(3, vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])?;
    let b = [1.8, 2.2, 0.0];
    let mut set = ProductSet::new(vec![Segment::discs(vec![1.0]), Segment::Free(1)])?;
    let c = DenseEquality::orthonormal(1, 3, &[0.0, 1.0, 1.0])?;
    let e = c.right_side(&[1.0])?;
    let settings = SmalseSettings::default()
        .with_tolerance(Tolerance::Relative(1e-10))
        .with_equality(1e-10);
    let (mut x, mut start, mut work) = ([0.0; 3], [0.0], SmalseWorkspace::new(&a, &c));
    smalse(
        &a,
        &b,
        &c,
        &e,
        &mut set,
        1.0,
        &settings,
        &mut (),
        &mut x,
        &mut start,
        &mut work,
    )?;
    let multiplier = work.equality_multiplier();
    let equality = kkt::EqualityPart {
        c: &c,
        e: &e,
        multiplier,
    };
    let kkt = kkt::check_with(&a, &b, &set, Some(equality), &x, 1.0)?.relative();
    Ok((x, c.original_multiplier(multiplier)?[0], kkt))
}
