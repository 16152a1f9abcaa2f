//! A system for solvers that keep only a part of each dual vector on a rank.

use crate::coarse::space::Coarse;
use crate::dual::boundary::BoundaryMap;
use crate::dual::operator::DualOperator;
use crate::dual::part::RowPart;
use crate::system::tfeti::Tfeti;
use std::sync::Arc;

/// Operators for vectors of which each rank keeps a part: all contact rows, which stand first, and the rows of its
/// subdomains. Solvers that ask the operator for sums get the bits of whole vectors.
#[doc(hidden)]
#[derive(Debug)]
pub struct SystemPart {
    pub(crate) rows: Arc<RowPart>,
    pub(crate) map: Arc<BoundaryMap>,
    /// `F = B K+ B^T`.
    pub dual: DualOperator,
    /// `G = R^T B^T`.
    pub coarse: Coarse,
}

impl Tfeti {
    /// The part of this rank. `None` of one process, and where rows have weights, give way or depend on others, for
    /// which vectors are whole.
    #[doc(hidden)]
    pub fn part(&self) -> Option<SystemPart> {
        let (gluing, exchange) = (self.gluing(), self.dual.map.exchange());
        let plain = gluing.is_aligned && self.copy_stiffness().is_plain() && !gluing.is_compliant();
        if exchange.ranks() == 1 || !plain || !gluing.dependent_nodes().is_empty() || self.row_weights().is_some() {
            return None;
        }
        let subdomains = &self.dual.subdomains;
        let rank_of = |s: u32| self.rank_of(s as usize);
        let (rows, own) = RowPart::new(gluing, subdomains.ownership.exchange.clone(), &rank_of);
        let rows = Arc::new(rows);
        let map = self.dual.map.of_part(&subdomains.classes, gluing, (&rows, &own));
        let map = Arc::new(map);
        Some(SystemPart {
            coarse: self.coarse().of_part(map.clone(), &own),
            dual: self.dual().of_part(map.clone(), rows.clone()),
            rows,
            map,
        })
    }
}

impl SystemPart {
    /// Numbers in the part.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// The part of a whole vector.
    pub fn take(&self, whole: &[f64]) -> Vec<f64> {
        self.rows.take(whole)
    }

    /// The whole of a vector; one exchange.
    pub fn complete(&self, part: &[f64], whole: &mut [f64]) {
        self.rows.complete(part, whole);
    }
}
