//! What a set-up will need, from counts alone: classes are found, no matrix is assembled.

use crate::error::TfetiError;
use crate::linalg::elimination::patterns;
use crate::linalg::sparse::{Columns, FactorError, Symbolic};
use crate::subdomain::class::Classes;
use crate::subdomain::cost::{ClassReport, InverseSettings, Size, choose};
use crate::subdomain::packed;
use rayon::prelude::*;
use signorini_fem_mesh::internal::distinct;
use signorini_fem_mesh::{Decomposition, Materials, TetMesh};

/// Forecast of memory and work of a T-FETI system: what [`SetupReport`](crate::SetupReport) will say.
///
/// It keeps what it found, and the set-up takes it from there
/// ([`TfetiBuilder::of_forecast`](crate::TfetiBuilder::of_forecast)).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Forecast<'a> {
    /// The classes.
    pub classes: Vec<ClassReport>,
    /// Bytes of all inverses.
    pub inverse_bytes: u64,
    /// The coarse factor, once it is counted: of two levels by [`forecast_levels`](crate::internal::forecast_levels),
    /// else by [`count_coarse`](Self::count_coarse).
    pub coarse: Option<CoarseForecast>,
    /// Bytes of the gather tables, if there are three rows at each node that is touched.
    pub table_bytes: u64,
    pub(crate) mesh: &'a TetMesh,
    pub(crate) decomposition: &'a Decomposition,
    pub(crate) materials: &'a Materials,
    pub(crate) share_translates: bool,
    pub(crate) settings: InverseSettings,
    pub(crate) found: Classes,
    /// Of each class that of its stiffness.
    pub(crate) symbolic: Vec<Symbolic>,
}

/// What coarse factors store and cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoarseForecast {
    /// Bytes, but for what contact pairs add to them.
    pub bytes: u64,
    /// Operations to make them.
    pub flops: f64,
}

impl<'a> Forecast<'a> {
    /// Counts all but the coarse factor. Supports hold mesh nodes, ascending, `at_zero` in some directions. `touched`
    /// tells of a mesh node whether a support or contact row acts on it; the interface is known from the decomposition.
    ///
    /// # Errors
    /// [`TfetiError::Material`] for elements without material, and those of patterns too large to be analysed. A memory
    /// limit that is too low is left to the set-up.
    pub fn new(
        mesh: &'a TetMesh,
        decomposition: &'a Decomposition,
        materials: &'a Materials,
        share_translates: bool,
        settings: &InverseSettings,
        at_zero: &[(u32, [f64; 3])],
        touched: impl Fn(u32) -> bool,
    ) -> Result<Self, TfetiError> {
        let found = Classes::find(mesh, decomposition, materials, share_translates)?.with_held(decomposition, at_zero);
        let subdomains = decomposition.subdomains();
        let list = found.classes();
        let analysed = list.par_iter().map(|class| {
            let s = class.members[0] as usize;
            let subdomain = &subdomains[s];
            let pattern = if subdomain.mids.is_empty() {
                nodal_pattern(class.nodes, &subdomain.tets)
            } else {
                nodal_pattern(class.nodes, &subdomain.quadratic_tets())
            };
            let symbolic = Symbolic::new(&pattern, 3).map_err(|e| TfetiError::pattern(e, s))?;
            Ok::<_, TfetiError>((pattern, symbolic))
        });
        let analysed: Vec<(Columns, Symbolic)> = analysed.collect::<Result<_, _>>()?;
        let (mut sizes, mut copies, mut others) = (Vec::with_capacity(list.len()), 0, 0);
        for (class, (pattern, symbolic)) in list.iter().zip(&analysed) {
            let mut boundary = vec![false; class.nodes];
            for &s in &class.members {
                for (mark, &node) in boundary.iter_mut().zip(&subdomains[s as usize].nodes) {
                    let own = touched(node);
                    *mark |= own || decomposition.copies(node as usize).len() > 1;
                    others += usize::from(own);
                }
            }
            let boundary = boundary.iter().filter(|b| **b).count();
            copies += class.members.len() * boundary;
            sizes.push(Size::new(class, boundary, packed::counts(class, pattern, symbolic)));
        }
        let dense = choose(&sizes, settings)?;
        let classes: Vec<ClassReport> = sizes
            .iter()
            .zip(dense)
            .map(|(size, dense)| size.report(dense))
            .collect();
        // interface blocks and their entries: k - 1 Helmert rows over 2 to k copies
        let counts = (0..decomposition.nodes()).map(|n| decomposition.copies(n).len());
        let (blocks, entries) = counts.filter(|k| *k > 1).fold((0, 0), |(blocks, entries), k| {
            (blocks + k - 1, entries + (k - 1) * (k + 2) / 2)
        });
        let words = copies + blocks + 2 + 3 * entries;
        Ok(Self {
            inverse_bytes: classes.iter().map(|c| c.bytes).sum(),
            coarse: None,
            table_bytes: (4 * words + 16 * entries + 56 * 3 * others) as u64,
            classes,
            mesh,
            decomposition,
            materials,
            share_translates,
            settings: *settings,
            symbolic: analysed.into_iter().map(|(_, symbolic)| symbolic).collect(),
            found,
        })
    }

    /// Counts a factor of the whole coarse matrix.
    ///
    /// # Errors
    /// [`TfetiError::TooLarge`] if it can have none.
    pub fn count_coarse(&mut self) -> Result<CoarseForecast, TfetiError> {
        let (what, count) = ("coarse unknowns", 6 * self.decomposition.subdomains().len());
        let counted = coarse_factor(self.decomposition);
        let (stored, flops) = counted.map_err(|_| TfetiError::TooLarge { what, count })?;
        let bytes = 8 * stored as u64;
        Ok(*self.coarse.insert(CoarseForecast { bytes, flops }))
    }

    /// Operations of a product with `F`.
    pub fn product_flops(&self) -> f64 {
        self.classes.iter().map(|c| c.members as f64 * c.flops()).sum()
    }

    /// Operations to form all inverses.
    pub fn setup_flops(&self) -> f64 {
        // solves with few columns run at less than half the speed of dense products
        let of = |c: &ClassReport| {
            let (square, columns) = if c.dense { (c.boundary.pow(2), c.boundary) } else { (0, 0) };
            let factor = c.bytes as f64 / 8.0 - square as f64;
            factor * factor / c.unknowns.max(1) as f64 + 10.0 * factor * columns as f64
        };
        self.classes.iter().map(of).sum()
    }
}

/// Pattern of the stiffness of some tetrahedra: full blocks for all pairs of nodes of an element.
fn nodal_pattern<const N: usize>(nodes: usize, tets: &[[u32; N]]) -> Columns {
    let mut graph: Vec<Vec<u32>> = (0..nodes as u32).map(|n| vec![n]).collect();
    for tet in tets {
        tet.iter().for_each(|&n| graph[n as usize].extend(tet));
    }
    Columns::of_blocks(&mut graph, 3)
}

/// The subdomains with which each shares a node, be it a corner only, ascending.
pub(crate) fn coarse_graph(decomposition: &Decomposition) -> Vec<Vec<u32>> {
    let mut graph: Vec<Vec<u32>> = vec![Vec::new(); decomposition.subdomains().len()];
    let mut before: Vec<u32> = Vec::new();
    for node in 0..decomposition.nodes() {
        let copies = decomposition.copies(node);
        // nodes of a facet follow one another
        let own = || copies.iter().map(|copy| copy.subdomain);
        if copies.len() > 1 && !before.iter().copied().eq(own()) {
            before = own().collect();
            for &a in &before {
                graph[a as usize].extend(before.iter().filter(|b| **b != a));
            }
        }
    }
    graph.into_iter().map(distinct).collect()
}

/// Numbers and operations of the factor of the coarse matrix.
fn coarse_factor(decomposition: &Decomposition) -> Result<(usize, f64), FactorError> {
    let graph = coarse_graph(decomposition);
    // the lower triangle, as the matrix is stored
    let lower = |(a, list): (u32, &Vec<u32>)| [a].into_iter().chain(list.iter().copied().filter(|b| *b > a)).collect();
    let pattern = Columns::of_blocks(&mut (0..).zip(&graph).map(lower).collect::<Vec<_>>(), 6);
    let symbolic = Symbolic::new(&pattern, 6)?;
    let order: Vec<u32> = symbolic.order().iter().step_by(6).map(|k| k / 6).collect();
    let columns = patterns(&graph, &order);
    let border = columns.iter().map(|below| 6.0 * below.len() as f64);
    Ok((symbolic.stored(), border.map(|b| 6.0 * b * b + 36.0 * b + 72.0).sum()))
}
