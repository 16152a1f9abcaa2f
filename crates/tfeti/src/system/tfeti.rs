//! The T-FETI system of a body, built once and immutable.

use crate::coarse::space::Coarse;
use crate::dual::operator::DualOperator;
use crate::error::TfetiError;
use crate::processes::exchange::{Exchange, Traffic};
use crate::projector::factor::CoarseFactor;
use crate::rows::gluing::Gluing;
use crate::subdomain::class::Classes;
use crate::subdomain::copy_stiffness::CopyStiffness;
use crate::subdomain::kernel::Kernel;
use crate::subdomain::ownership::pieces;
use crate::system::report::SetupReport;
use crate::tolerances::{PANEL, SUBDOMAINS};
use rayon::prelude::*;
use signorini_fem_mesh::Decomposition;
use std::ops::Range;
use std::sync::OnceLock;

/// A T-FETI system: the rows of `B`, the dual operator `F`, the coarse space `G` and what is needed to recover
/// displacements. Immutable, and shared freely between threads.
///
/// *Torn* vectors hold the unknowns of all subdomains one after another (`3 local node + component`).
#[derive(Debug)]
pub struct Tfeti {
    /// With all that operators share.
    pub(crate) dual: DualOperator,
    coarse: Coarse,
    factor: OnceLock<CoarseFactor>,
    report: SetupReport,
    stiffness: CopyStiffness,
    /// Where copies of a node count alike, in the place of their stiffness.
    alike: Option<CopyStiffness>,
    /// Rank that works on the part of torn vectors of each subdomain; empty of one process.
    pub(super) torn_ranks: Vec<u32>,
    /// The ranks of consecutive numbers of torn vectors; none of one process.
    pub(super) torn_pieces: Vec<(usize, Range<usize>)>,
    /// First unknown of each subdomain in torn vectors, and their length.
    offsets: Vec<usize>,
    /// Mesh node of each node copy, in torn order; none of places.
    pub(super) node_of: Vec<Option<u32>>,
    /// Mesh nodes.
    pub(super) nodes: usize,
}

impl Tfeti {
    pub(super) fn new(
        dual: DualOperator,
        coarse: Coarse,
        report: SetupReport,
        decomposition: &Decomposition,
        (stiffness, counts): (CopyStiffness, bool),
    ) -> Self {
        let mut offsets = vec![0];
        for subdomain in decomposition.subdomains() {
            offsets.push(offsets[offsets.len() - 1] + subdomain.dofs());
        }
        let nodes = decomposition.nodes();
        let (classes, ownership) = (&dual.subdomains.classes, &dual.subdomains.ownership);
        // some members of a class at a time, cut otherwise than panels
        let rank = |s: usize| {
            let (class, member) = classes.place(s);
            ownership.rank_of(class, member / PANEL * PANEL) as u32
        };
        let spread = ownership.exchange.ranks() > 1;
        let torn_ranks: Vec<u32> = (0..if spread { dual.subdomains.count() } else { 0 })
            .map(rank)
            .collect();
        let torn_pieces = pieces(&torn_ranks, 1).into_iter();
        Self {
            torn_pieces: torn_pieces
                .map(|(rank, own)| (rank, offsets[own.start]..offsets[own.end]))
                .collect(),
            torn_ranks,
            dual,
            coarse,
            factor: OnceLock::new(),
            report,
            stiffness,
            alike: (!counts).then(CopyStiffness::default),
            offsets,
            node_of: decomposition.torn_nodes().collect(),
            nodes,
        }
    }

    /// The rows of `B`.
    pub fn gluing(&self) -> &Gluing {
        &self.dual.gluing
    }

    /// How the copies of a node count in contact and support rows: by their stiffness in a body of several materials,
    /// and where that of the copies of a node differs by more than a factor of four, as in ragged cuts; alike
    /// otherwise.
    #[doc(hidden)]
    pub fn copy_stiffness(&self) -> &CopyStiffness {
        self.alike.as_ref().unwrap_or(&self.stiffness)
    }

    /// The stiffness of the copies of each node, whether or not they differ.
    #[doc(hidden)]
    pub fn all_copy_stiffness(&self) -> &CopyStiffness {
        &self.stiffness
    }

    /// The classes of subdomains.
    #[doc(hidden)]
    pub fn classes(&self) -> &Classes {
        &self.dual.subdomains.classes
    }

    /// `F = B K+ B^T`.
    pub fn dual(&self) -> &DualOperator {
        &self.dual
    }

    /// `G = R^T B^T`.
    pub fn coarse(&self) -> &Coarse {
        &self.coarse
    }

    /// The factor of `G G^T`, made when it is first asked for. If its free motions are not empty, no row stops the body
    /// from moving that way.
    ///
    /// # Errors
    /// Those of [`Coarse::factor`].
    pub fn coarse_factor(&self) -> Result<&CoarseFactor, TfetiError> {
        if let Some(factor) = self.factor.get() {
            return Ok(factor);
        }
        let factor = self.coarse.factor()?;
        Ok(self.factor.get_or_init(|| factor))
    }

    /// What was built, how large it is and how long it took.
    pub fn report(&self) -> &SetupReport {
        &self.report
    }

    /// The process that works with the matrices of a subdomain, by its rank.
    pub fn rank_of(&self, subdomain: usize) -> usize {
        self.dual.subdomains.rank_of(subdomain)
    }

    /// Whether this process works on the part of torn vectors of a subdomain.
    pub(super) fn is_here(&self, subdomain: usize) -> bool {
        let rank = self.torn_ranks.get(subdomain);
        rank.is_none_or(|rank| *rank as usize == self.exchange().rank())
    }

    /// The numbers of torn vectors that this process works on.
    pub(super) fn torn_here(&self) -> impl Iterator<Item = Range<usize>> {
        let all = (self.torn_pieces.is_empty()).then_some(0..self.torn_dim());
        let (pieces, rank) = (self.torn_pieces.iter(), self.exchange().rank());
        let own = pieces.filter(move |piece| piece.0 == rank).map(|piece| piece.1.clone());
        all.into_iter().chain(own)
    }

    /// Brings what each process has set of a torn vector, that of its subdomains, to all; one exchange.
    #[doc(hidden)]
    pub fn complete_torn(&self, x: &mut [f64]) {
        self.exchange().complete(x, &self.torn_pieces);
    }

    /// What is measured of torn vectors, subdomain by subdomain, each by the process that works on it; one exchange.
    #[doc(hidden)]
    pub fn of_subdomains<const K: usize>(&self, measure: impl Fn(usize) -> [f64; K] + Sync) -> Vec<[f64; K]> {
        let mut out = vec![[0.0; K]; self.subdomains()];
        let own = out.par_iter_mut().with_min_len(SUBDOMAINS).enumerate();
        own.filter(|(s, _)| self.is_here(*s))
            .for_each(|(s, own)| *own = measure(s));
        let pieces = pieces(&self.torn_ranks, K);
        self.exchange().complete(out.as_flattened_mut(), &pieces);
        out
    }

    /// What this process has exchanged with those that solve the problem with it.
    pub fn traffic(&self) -> Traffic {
        self.exchange().traffic()
    }

    /// Whether all processes are still there. Vectors exchanged after one is lost are not numbers.
    ///
    /// # Errors
    /// [`TfetiError::Communication`] if one was lost.
    pub fn check_processes(&self) -> Result<(), TfetiError> {
        Ok(self.exchange().check()?)
    }

    /// The value that each process gives, by rank. All must ask.
    ///
    /// # Errors
    /// [`TfetiError::Communication`].
    pub fn gather(&self, value: f64) -> Result<Vec<f64>, TfetiError> {
        let exchange = self.exchange();
        let mut values = vec![value; exchange.ranks()];
        let parts: Vec<Range<usize>> = (0..values.len()).map(|rank| rank..rank + 1).collect();
        exchange.gather(&mut values, &parts);
        self.check_processes()?;
        Ok(values)
    }

    pub(super) fn exchange(&self) -> &Exchange {
        &self.dual.subdomains.ownership.exchange
    }

    /// Number of subdomains.
    pub fn subdomains(&self) -> usize {
        self.dual.subdomains.count()
    }

    /// Length of dual vectors.
    pub fn dual_dim(&self) -> usize {
        self.dual.gluing.ranges().total()
    }

    /// Length of torn vectors: the paper's `n_p`.
    pub fn torn_dim(&self) -> usize {
        3 * self.node_of.len()
    }

    /// Unknowns of a subdomain in torn vectors.
    pub fn torn_range(&self, subdomain: usize) -> Range<usize> {
        self.offsets[subdomain]..self.offsets[subdomain + 1]
    }

    /// Rigid motions of a subdomain.
    #[doc(hidden)]
    pub fn kernel(&self, subdomain: usize) -> &Kernel {
        self.dual.subdomains.kernel(subdomain)
    }
}
