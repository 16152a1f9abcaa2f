//! Quadratic programming without mechanics: only the crate `signorini-qp`.
//!
//! Two problems: a string over an obstacle (bounds, 100 unknowns) by KPRGP, and three unknowns with a disc and an equality
//! by SMALSE. Both are checked by the conditions of optimality, with code that the solvers do not share.

use std::f64::consts::PI;
use std::io::Write;

use signorini_qp::{
    BlockState, ConvexSet, DenseEquality, DenseOperator, Expansion, KprgpSettings, KprgpWorkspace,
    ProductSet, QpError, Segment, SmalseSettings, SmalseWorkspace, Steps, SymmetricOperator,
    Tolerance, kkt, kprgp, smalse,
};

use crate::error::ExampleError;

/// Unknowns of the string.
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
        let last = NODES - 1;
        y[0] = x[0];
        y[last] = x[last];
        for i in 1..last {
            let left = if i > 1 { x[i - 1] } else { 0.0 };
            let right = if i + 1 < last { x[i + 1] } else { 0.0 };
            y[i] = 2.0 * x[i] - left - right;
        }
    }
}

/// Result of the string.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StringResult {
    /// Cost at the end.
    pub cost: f64,
    /// Nodes that rest on the obstacle.
    pub resting: usize,
    /// Products with the stiffness.
    pub products: usize,
    /// Steps by kind.
    pub steps: Steps,
    /// Relative distance from optimality.
    pub kkt: f64,
}

/// Solves the string to 1e-5 with the given expansion.
///
/// # Errors
/// [`QpError`] never for this problem.
pub fn string(expansion: Expansion) -> Result<StringResult, QpError> {
    let h = 1.0 / (NODES as f64 - 1.0);
    let mut load = vec![-30.0 * h * h; NODES];
    let obstacle = |i: usize| (4.0 * PI * i as f64 * h - PI / 6.0).sin() / 2.0 - 2.0;
    let mut lower: Vec<f64> = (0..NODES).map(obstacle).collect();
    for end in [0, NODES - 1] {
        load[end] = 0.0;
        lower[end] = 0.0;
    }
    let set = ProductSet::new(vec![Segment::lower(lower)])?;
    // the largest eigenvalue is known here; `norm_estimate` finds it otherwise
    let norm = 2.0 + 2.0 * (PI * h).cos();
    let settings = KprgpSettings::default().with_expansion(expansion);
    let mut x = vec![0.0; NODES];
    let mut work = KprgpWorkspace::new(&Stiffness);
    let tolerance = Tolerance::Relative(1e-5);
    let report = kprgp(
        &Stiffness, &load, &set, norm, tolerance, &settings, &mut x, &mut work,
    )?;
    let mut resting = 0;
    set.for_each_block(&x, &mut |block| {
        resting += usize::from(block.state == BlockState::AtLower);
    });
    Ok(StringResult {
        cost: report.cost,
        resting,
        products: report.products.total(),
        steps: report.steps,
        kkt: kkt::check(&Stiffness, &load, &set, &x, norm)?.relative(),
    })
}

/// Result of the problem with a disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiscResult {
    /// The minimiser; exactly (0.6, 0.8, 0.2).
    pub x: [f64; 3],
    /// Multiplier of the equality; exactly -0.2.
    pub multiplier: f64,
    /// Products with the matrix.
    pub products: usize,
    /// Outer steps.
    pub outer: usize,
    /// Relative distance from optimality.
    pub kkt: f64,
}

/// Minimises `|x|^2 / 2 - 1.8 x0 - 2.2 x1` over the disc `|(x0, x1)| <= 1` and `x2` free, with `x1 + x2 = 1`.
///
/// # Errors
/// [`QpError`] never for this problem.
pub fn disc() -> Result<DiscResult, QpError> {
    let a = DenseOperator::new(3, vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])?;
    let b = [1.8, 2.2, 0.0];
    let mut set = ProductSet::new(vec![Segment::discs(vec![1.0]), Segment::Free(1)])?;
    let c = DenseEquality::orthonormal(1, 3, &[0.0, 1.0, 1.0])?;
    let e = c.right_side(&[1.0])?;
    let settings = SmalseSettings::default()
        .with_tolerance(Tolerance::Relative(1e-10))
        .with_equality(1e-10);
    let (mut x, mut multiplier) = ([0.0; 3], [0.0]);
    let mut work = SmalseWorkspace::new(&a, &c);
    let report = smalse(
        &a,
        &b,
        &c,
        &e,
        &mut set,
        1.0,
        &settings,
        &mut |_, _| false,
        &mut x,
        &mut multiplier,
        &mut work,
    )?;
    let mu = work.equality_multiplier();
    let equality = kkt::EqualityPart {
        c: &c,
        e: &e,
        multiplier: mu,
    };
    let check = kkt::check_with(&a, &b, &set, Some(equality), &x, 1.0)?;
    Ok(DiscResult {
        x,
        multiplier: c
            .original_multiplier(mu)?
            .first()
            .copied()
            .unwrap_or(f64::NAN),
        products: report.products.total(),
        outer: report.outer,
        kkt: check.relative(),
    })
}

/// Solves both and prints counts and checks.
///
/// # Errors
/// [`ExampleError`] if it cannot print.
pub fn execute(out: &mut impl Write) -> Result<(), ExampleError> {
    writeln!(out, "string over an obstacle, {NODES} unknowns, to 1e-5")?;
    writeln!(
        out,
        "expansion          products    cg  expand  release  resting             cost      KKT"
    )?;
    for expansion in [
        Expansion::FixedStep,
        Expansion::ProjectedCg,
        Expansion::Optimal,
        Expansion::BarzilaiBorwein,
    ] {
        let r = string(expansion)?;
        writeln!(
            out,
            "{:<16} {:>10} {:>5} {:>7} {:>8} {:>8} {:>16.12} {:>8.1e}",
            format!("{expansion:?}"),
            r.products,
            r.steps.cg,
            r.steps.expansion,
            r.steps.proportioning,
            r.resting,
            r.cost,
            r.kkt
        )?;
    }
    let d = disc()?;
    writeln!(out, "\ndisc and equality, 3 unknowns, to 1e-10")?;
    writeln!(
        out,
        "x = ({:.9}, {:.9}, {:.9}), multiplier {:.9}, {} products in {} outer steps, KKT {:.1e}",
        d.x[0], d.x[1], d.x[2], d.multiplier, d.products, d.outer, d.kkt
    )?;
    Ok(())
}
