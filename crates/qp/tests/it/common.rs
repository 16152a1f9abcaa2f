//! Random problems from a fixed sequence.
use signorini_qp::active_set::{ActiveSetPoint, ActiveSetProblem, ActiveSetReport, ActiveSetWorkspace, RadiusSlope};
use signorini_qp::kprgp::KprgpWorkspace;
use signorini_qp::problem::Diagonal;
use signorini_qp::smalse::{SmalseReport, SmalseWorkspace};
use signorini_qp::{
    ActiveSetSettings, DenseEquality, DenseOperator, EqualityProjector, KprgpSettings, MovingSet, ProductSet,
    Projected, QpError, QuadraticCost, Segment, SmalseSettings, Status, SymmetricOperator, active_set, kprgp,
    norm_estimate, smalse, vector,
};

/// Reproducible numbers.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        let mut r = Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x1234_5678_9abc_def1);
        for _ in 0..4 {
            r.bits();
        }
        r
    }
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
    /// In [-1, 1).
    pub(crate) fn real(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.bits() >> 20) as usize % n
    }
    pub(crate) fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.real()).collect()
    }
}

/// Symmetric positive definite with condition number about `10^decades`; returns the largest eigenvalue.
pub(crate) fn spd(n: usize, decades: f64, r: &mut Random) -> (DenseOperator, f64) {
    let q = orthogonal(n, r);
    let eig: Vec<f64> = (0..n)
        .map(|i| 10f64.powf(-decades * i as f64 / n.max(2) as f64))
        .collect();
    let mut a = vec![0.0; n * n];
    for (k, &lambda) in eig.iter().enumerate() {
        for i in 0..n {
            for j in 0..n {
                a[i * n + j] += lambda * q[k][i] * q[k][j];
            }
        }
    }
    for i in 0..n {
        for j in 0..i {
            a[i * n + j] = a[j * n + i];
        }
    }
    (DenseOperator::new(n, a).expect("symmetric"), 1.0)
}

fn orthogonal(n: usize, r: &mut Random) -> Vec<Vec<f64>> {
    let mut q: Vec<Vec<f64>> = Vec::new();
    while q.len() < n {
        let mut v = r.vector(n);
        for _ in 0..2 {
            for u in &q {
                let s = vector::dot(u, &v);
                vector::axpy(-s, u, &mut v);
            }
        }
        let s = vector::norm(&v);
        if s > 1e-3 {
            vector::scale(1.0 / s, &mut v);
            q.push(v);
        }
    }
    q
}

/// A product of all kinds of segments with all kinds of degenerate blocks.
pub(crate) fn set(r: &mut Random) -> ProductSet {
    let mut segments = Vec::new();
    for _ in 0..2 + r.below(4) {
        let n = r.below(7);
        segments.push(match r.below(5) {
            0 => Segment::Free(n),
            1 => Segment::lower((0..n).map(|_| 0.5 * r.real() - 0.3).collect()),
            2 => Segment::upper((0..n).map(|_| 0.5 * r.real() + 0.3).collect()),
            3 => {
                let lower: Vec<f64> = (0..n).map(|_| r.real()).collect();
                let upper = lower
                    .iter()
                    .map(|l| if r.below(4) == 0 { *l } else { l + 0.5 * r.real().abs() })
                    .collect();
                Segment::bounds(lower, upper)
            }
            _ => Segment::discs(
                (0..n)
                    .map(|_| if r.below(4) == 0 { 0.0 } else { 10f64.powf(2.0 * r.real() - 1.5) })
                    .collect(),
            ),
        });
    }
    ProductSet::new(segments).expect("valid set")
}

/// Feasible equality: `C x = e` holds at a point of the set.
pub(crate) fn equality(n: usize, rows: usize, set: &ProductSet, r: &mut Random) -> (DenseEquality, Vec<f64>) {
    use signorini_qp::{ConvexSet, Equality};
    let g: Vec<f64> = r.vector(rows * n);
    let c = DenseEquality::orthonormal(rows, n, &g).expect("independent rows");
    // the mean of several points of the set is inside where the set has an inside: multipliers exist
    let mut x = vec![0.0; n];
    for _ in 0..8 {
        let mut y = r.vector(n);
        set.project(&mut y);
        vector::axpy(0.125, &y, &mut x);
    }
    let mut e = vec![0.0; rows];
    c.apply(&x, &mut e, &mut ());
    (c, e)
}

pub(crate) fn product(a: &DenseOperator, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    a.apply(x, &mut y, &mut ());
    y
}

pub(crate) fn pair() -> DenseOperator {
    DenseOperator::new(2, vec![2.0, -1.0, -1.0, 2.0]).expect("symmetric")
}

/// KPRGP to 1e-10, from `x`.
pub(crate) fn run(
    a: &DenseOperator,
    b: &[f64],
    set: &ProductSet,
    x: &mut [f64],
    s: &KprgpSettings,
) -> Result<Status, QpError> {
    let mut work = KprgpWorkspace::new(a);
    kprgp(&QuadraticCost::new(a, b, 3.0), set, 1e-10, s, x, &mut work).map(|r| r.status)
}

/// A problem with an equality.
pub(crate) struct Quadratic {
    pub(crate) a: DenseOperator,
    pub(crate) b: Vec<f64>,
    pub(crate) c: DenseEquality,
    pub(crate) e: Vec<f64>,
    pub(crate) set: ProductSet,
    /// Of `PAP`.
    pub(crate) norm: f64,
}

impl Quadratic {
    pub(crate) fn new(a: DenseOperator, b: Vec<f64>, (c, e): (DenseEquality, Vec<f64>), set: ProductSet) -> Self {
        let projected = Projected::new(&a, &c).expect("dimensions");
        let norm = norm_estimate(&projected).expect("norm");
        let norm = norm.upper.max(1e-3);
        Self { a, b, c, e, set, norm }
    }

    /// SMALSE: its report, `A y - b` and the multiplier of the equality.
    pub(crate) fn smalse(
        &mut self,
        settings: &SmalseSettings,
        hook: &mut dyn FnMut(&[f64], &mut ProductSet) -> bool,
        x: &mut [f64],
        beta: &mut [f64],
    ) -> (SmalseReport, Vec<f64>, Vec<f64>) {
        let Self { a, b, c, e, set, norm } = self;
        let mut work = SmalseWorkspace::new(a, c);
        let cost = QuadraticCost::new(a, b, *norm).with_equality(c, e);
        let report = smalse(&cost, MovingSet::new(set, hook), x, beta, settings, &mut work);
        let (residual, multiplier) = (work.residual().to_vec(), work.equality_multiplier().to_vec());
        (report.expect("solve"), residual, multiplier)
    }
}

/// What the active-set method found.
pub(crate) struct Solved {
    pub(crate) x: Vec<f64>,
    pub(crate) ax: Vec<f64>,
    pub(crate) residual: Vec<f64>,
    pub(crate) report: ActiveSetReport,
}

/// The active-set method from zero without a preconditioner.
pub(crate) fn from_zero(
    a: &DenseOperator,
    projector: &mut impl EqualityProjector,
    set: MovingSet<'_, ProductSet>,
    (linear, rhs): (&[f64], &[f64]),
    settings: &ActiveSetSettings,
    (ax_known, slopes): (bool, &[RadiusSlope]),
) -> Result<Solved, QpError> {
    let n = a.dim();
    let identity = Diagonal::new(vec![1.0; n]).unwrap();
    let mut work = ActiveSetWorkspace::new(a, &identity);
    work.set_slopes(slopes);
    let problem = ActiveSetProblem {
        operator: a,
        preconditioner: &identity,
        scale: &vec![1.0; n],
        linear,
        rhs,
    };
    let (mut x, mut ax) = (vec![0.0; n], vec![0.0; n]);
    let point = ActiveSetPoint {
        x: &mut x,
        ax: &mut ax,
        known: ax_known,
    };
    let report = active_set(&problem, projector, set, point, settings, &mut work)?;
    let residual = work.residual().to_vec();
    Ok(Solved {
        x,
        ax,
        residual,
        report,
    })
}
