//! What a set-up will need, from counts alone: classes are found, no matrix is assembled.

use crate::error::TfetiError;
use crate::linalg::dense;
use crate::linalg::elimination::patterns;
use crate::linalg::sparse::minimum_degree;
use crate::subdomain::class::Classes;
use crate::subdomain::cost::{InverseSettings, Size, choose};
use signorini_fem_mesh::{Decomposition, Materials, TetMesh};
use std::time::Instant;

/// Numbers in the sparse factor of a subdomain with `n` unknowns, over `n^(4/3)`: nested dissection of a cube.
const FACTOR: f64 = 7.3;
/// Bytes of the gather tables an entry of `B`.
const TABLE: f64 = 14.0;

/// Forecast of one class of translates.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ClassForecast {
    /// Number of members.
    pub members: usize,
    /// Unknowns of a member.
    pub unknowns: usize,
    /// Unknowns on nodes that rows of `B` touch in some member.
    pub boundary: usize,
    /// Whether products will use a dense matrix.
    pub dense: bool,
    /// Bytes of the inverses; the sparse factor is estimated.
    pub bytes: u64,
    /// Operations of a product with all members.
    pub flops: f64,
    /// Operations to form the inverses.
    pub setup_flops: f64,
}

/// Forecast of memory and work of a T-FETI system, beside which [`SetupReport`](crate::SetupReport) gives the truth.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Forecast {
    /// The classes; exact but for the sizes of sparse factors.
    pub classes: Vec<ClassForecast>,
    /// Bytes of all inverses.
    pub inverse_bytes: u64,
    /// Bytes of the coarse factor.
    pub coarse_bytes: u64,
    /// Operations to factor the coarse matrix.
    pub coarse_flops: f64,
    /// Bytes of the gather tables.
    pub table_bytes: u64,
}

impl Forecast {
    /// Counts. `touched` tells of a mesh node whether a support or contact row acts on it; the interface is known from the
    /// decomposition.
    ///
    /// # Errors
    /// [`TfetiError::Material`] for elements without material. A memory limit that seems too low is no error: the
    /// set-up, which knows exactly, reports it.
    pub fn new(
        mesh: &TetMesh,
        decomposition: &Decomposition,
        materials: &Materials,
        share_translates: bool,
        settings: &InverseSettings,
        touched: impl Fn(u32) -> bool,
    ) -> Result<Self, TfetiError> {
        let classes = Classes::find(mesh, decomposition, materials, share_translates)?;
        let subdomains = decomposition.subdomains();
        let mut sizes = Vec::with_capacity(classes.classes().len());
        let mut entries = 0;
        for class in classes.classes() {
            let mut boundary = vec![false; class.nodes];
            for &s in &class.members {
                for (mark, &node) in boundary.iter_mut().zip(&subdomains[s as usize].nodes) {
                    let copies = decomposition.copies(node as usize).len();
                    let own = usize::from(touched(node));
                    *mark |= copies > 1 || own > 0;
                    // rows of a node touch about all of its copies
                    entries += 3 * (copies - 1 + own);
                }
            }
            let dim = 3 * class.nodes;
            sizes.push(Size {
                dim,
                boundary: 3 * boundary.iter().filter(|b| **b).count(),
                members: class.members.len(),
                factor: dense_or((FACTOR * (dim as f64).powf(4.0 / 3.0)) as usize, dim),
            });
        }
        let dense = choose(&sizes, settings).unwrap_or_else(|_| vec![false; sizes.len()]);
        let forecast = |(size, dense): (&Size, bool)| {
            let members = size.members as f64;
            let (square, factor) = ((size.boundary * size.boundary) as f64, size.factor as f64);
            let formed = if dense { size.boundary } else { 0 } as f64;
            ClassForecast {
                members: size.members,
                unknowns: size.dim,
                boundary: size.boundary,
                dense,
                bytes: if dense {
                    size.dense_bytes()
                } else {
                    size.sparse_bytes()
                },
                flops: members * if dense { 2.0 * square } else { 4.0 * factor },
                // solves with few columns run at less than half the speed of dense products
                setup_flops: factor * factor / size.dim.max(1) as f64 + 10.0 * factor * formed,
            }
        };
        let classes: Vec<ClassForecast> = sizes.iter().zip(dense).map(forecast).collect();
        let (stored, coarse_flops) = coarse_factor(decomposition);
        Ok(Self {
            inverse_bytes: classes.iter().map(|c| c.bytes).sum(),
            coarse_bytes: 8 * stored,
            coarse_flops,
            table_bytes: (TABLE * entries as f64) as u64,
            classes,
        })
    }

    /// Operations of a product with `F`.
    #[must_use]
    pub fn product_flops(&self) -> f64 {
        self.classes.iter().map(|c| c.flops).sum()
    }

    /// Operations to form all inverses.
    #[must_use]
    pub fn setup_flops(&self) -> f64 {
        self.classes.iter().map(|c| c.setup_flops).sum()
    }
}

/// Numbers and operations of the factor of the coarse matrix, by elimination of its blocks of six: subdomains that share a node
/// are coupled, be it by a corner only.
fn coarse_factor(decomposition: &Decomposition) -> (u64, f64) {
    let count = decomposition.subdomains().len();
    let mut graph: Vec<Vec<u32>> = vec![Vec::new(); count];
    let mut before: Vec<u32> = Vec::new();
    for node in 0..decomposition.nodes() {
        let copies = decomposition.copies(node).iter();
        let own: Vec<u32> = copies.map(|copy| copy.subdomain).collect();
        // nodes of a face follow one another
        if own.len() > 1 && own != before {
            for &a in &own {
                graph[a as usize].extend(own.iter().filter(|b| **b != a));
            }
            before = own;
        }
    }
    let (mut pointers, mut rows) = (vec![0], Vec::new());
    for list in &mut graph {
        list.sort_unstable();
        list.dedup();
        rows.extend(list.iter().map(|b| *b as usize));
        pointers.push(rows.len());
    }
    let Ok(order) = minimum_degree(&pointers, &rows) else {
        return (0, 0.0);
    };
    let order: Vec<u32> = order.into_iter().map(|b| b as u32).collect();
    let columns = patterns(&graph, &order);
    let border = columns.iter().map(|below| 6.0 * below.len() as f64);
    let sums = border.map(|b| [6.0 * b + 21.0, 6.0 * b * b + 36.0 * b + 72.0]);
    let [stored, flops] = sums.fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
    (stored as u64, flops)
}

/// A factor is at most a full triangle.
fn dense_or(sparse: usize, dim: usize) -> usize {
    sparse.min(dim * (dim + 1) / 2)
}

/// What a processor does a second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// Operations of dense products.
    pub flops: f64,
    /// Numbers that a vector operation reads and writes.
    pub numbers: f64,
}

impl Default for Rate {
    /// One core of a desktop processor with 256 bit vectors.
    fn default() -> Self {
        Self {
            flops: 6e10,
            numbers: 5e9,
        }
    }
}

impl Rate {
    /// Measures this machine with one small dense product and one vector operation, in about ten milliseconds.
    #[must_use]
    pub fn measure() -> Self {
        const SIZE: usize = 240;
        const COLUMNS: usize = 48;
        const LENGTH: usize = 1 << 18;
        let a: Vec<f64> = (0..SIZE * SIZE).map(|i| (i % 17) as f64).collect();
        let b: Vec<f64> = (0..SIZE * COLUMNS).map(|i| (i % 13) as f64).collect();
        let mut c = vec![0.0; SIZE * COLUMNS];
        let best = |work: &mut dyn FnMut()| {
            let time = |_| {
                let start = Instant::now();
                work();
                start.elapsed().as_secs_f64().max(1e-9)
            };
            (0..6).map(time).fold(f64::INFINITY, f64::min)
        };
        let product = best(&mut || dense::multiply(&mut c, &a, &b, SIZE, SIZE, COLUMNS));
        let x: Vec<f64> = (0..LENGTH).map(|i| (i % 11) as f64).collect();
        let mut y = vec![0.0; LENGTH];
        let stream = best(&mut || y.iter_mut().zip(&x).for_each(|(y, x)| *y += 1.5 * x));
        Self {
            flops: (2 * SIZE * SIZE * COLUMNS) as f64 / product,
            numbers: 3.0 * LENGTH as f64 / stream,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NodeSupport, TfetiBuilder};
    use signorini_fem_mesh::{Hooke, brick};

    #[test]
    fn classes_are_those_of_the_set_up_and_bytes_are_near() {
        for (cells, boxes) in [([15, 5, 5], [3, 1, 1]), ([12, 8, 8], [3, 2, 2])] {
            let mesh = brick::Brick::new([3.0, 1.0, 1.0], cells).build().unwrap();
            let decomposition = Decomposition::boxes(&mesh, boxes).unwrap();
            let materials = Materials::uniform(Hooke::isotropic(2e11, 0.3).unwrap());
            let held = mesh.nodes_on(brick::X_MIN);
            let supports = [NodeSupport::fixed(held.clone())];
            let forecast = Forecast::new(
                &mesh,
                &decomposition,
                &materials,
                true,
                &InverseSettings::default(),
                |node| held.contains(&node),
            )
            .unwrap();
            let system = TfetiBuilder::new(&mesh, &decomposition, &materials)
                .with_supports(&supports)
                .build()
                .unwrap();
            let truth = system.report();
            assert_eq!(forecast.classes.len(), truth.classes.len());
            for (f, t) in forecast.classes.iter().zip(&truth.classes) {
                assert_eq!((f.members, f.unknowns), (t.members, t.unknowns));
                assert_eq!(f.boundary, t.boundary);
            }
            let near = |a: u64, b: u64| a < 2 * b && b < 2 * a;
            assert!(
                near(forecast.inverse_bytes, truth.inverse_bytes),
                "{forecast:?} {truth:?}"
            );
            assert!(
                near(forecast.table_bytes, truth.table_bytes),
                "{forecast:?} {truth:?}"
            );
            assert!(
                near(forecast.coarse_bytes / 2, truth.coarse_bytes)
                    || near(2 * forecast.coarse_bytes, truth.coarse_bytes),
                "{forecast:?} {truth:?}"
            );
        }
    }

    /// Every tetrahedron a subdomain: a node couples up to thirty of them.
    #[test]
    fn the_coarse_factor_of_very_small_subdomains_is_counted() {
        let mut last = 0.0;
        for n in [2, 3] {
            let mesh = brick::Brick::new([3.0, 1.0, 1.0], [3 * n, n, n]).build();
            let mesh = mesh.unwrap();
            let count = mesh.tets().len() as u32;
            let decomposition =
                Decomposition::from_parts(&mesh, &(0..count).collect::<Vec<_>>()).unwrap();
            let materials = Materials::uniform(Hooke::isotropic(2e11, 0.3).unwrap());
            let system = TfetiBuilder::new(&mesh, &decomposition, &materials).build();
            let truth = system.unwrap().report().coarse_bytes as f64;
            let (stored, flops) = coarse_factor(&decomposition);
            let ratio = 8.0 * stored as f64 / truth;
            assert!((0.5..2.0).contains(&ratio), "{n}: {ratio}");
            // a dense matrix would be an upper bound
            let dim = 6.0 * f64::from(count);
            assert!(flops < dim.powi(3) / 3.0 && flops > 10.0 * last, "{flops}");
            last = flops;
        }
    }

    #[test]
    fn this_machine_has_a_rate() {
        let rate = Rate::measure();
        assert!(rate.flops > 1e7 && rate.numbers > 1e6, "{rate:?}");
    }
}
