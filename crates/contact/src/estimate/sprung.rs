//! Springs at nodes that contact, a tie or a coupling moves.
//!
//! Other nodes with springs are held where the multipliers put them, so that springs add nothing to the gap. These
//! cannot be in two places: they begin at the mean of both, weighted by stiffness, but for those of couplings, which
//! stay. What the springs are extended beside their multipliers is energy: `1/2 k (d . v - s)²`.

use crate::model::Model;
use crate::vec3::dot;
use std::collections::HashSet;

/// One of these springs: its row is a direction, with a length, on the displacement of its node.
#[derive(Debug)]
struct Sprung {
    node: u32,
    row: usize,
    direction: [f64; 3],
    /// Of the row, N/m.
    stiffness: f64,
    /// That along the direction over what it is together with that of the node; 0 in a coupling.
    share: f64,
}

/// All of them, rows ascending.
#[derive(Debug)]
pub(crate) struct SprungNodes(Vec<Sprung>);

impl SprungNodes {
    /// `stiffness` is that of nodes, N/m.
    pub(crate) fn new(model: &Model, stiffness: impl Fn() -> Vec<f64>) -> Self {
        let (gluing, discrete) = (model.tfeti.gluing(), &model.discrete);
        let springs = gluing.springs();
        if springs.is_empty() {
            return Self(Vec::new());
        }
        let (stiffness, couplings) = (stiffness(), &discrete.couplings);
        let points = model.points.iter().map(|point| &point.contact);
        let moving = points.chain(&discrete.ties).flat_map(|point| point.sides.nodes());
        let moving: HashSet<u32> = moving.map(|(node, _)| node).collect();
        let sprung = |(row, compliance): (usize, f64)| {
            let node = gluing.node(row)?;
            let is_coupled = couplings.has(node);
            if !is_coupled && !moving.contains(&node) {
                return None;
            }
            let direction = gluing.direction(row);
            let own = dot(&direction, &direction) / compliance;
            let share = own / (own + stiffness[node as usize]);
            Some(Sprung {
                node,
                row,
                direction,
                stiffness: compliance.recip(),
                share: if is_coupled { 0.0 } else { share },
            })
        };
        let rows = gluing.spring_rows().zip(springs.iter().map(|spring| spring.compliance));
        Self(rows.filter_map(sprung).collect())
    }

    /// Whether the row is one of such a spring.
    pub(crate) fn has(&self, row: usize) -> bool {
        self.0.binary_search_by_key(&row, |s| s.row).is_ok()
    }

    /// Nodes, with the stiffness of a spring there, N/m.
    pub(crate) fn stiffness(&self) -> impl Iterator<Item = (u32, f64)> {
        let own = |s: &Sprung| s.stiffness * dot(&s.direction, &s.direction);
        self.0.iter().map(move |s| (s.node, own(s)))
    }

    /// Moves them from a displacement to where they begin.
    pub(crate) fn begin(&self, offset: &[f64], v: &mut [f64]) {
        for s in &self.0 {
            let by = s.share * s.missing(offset, v) / dot(&s.direction, &s.direction);
            (0..3).for_each(|c| v[3 * s.node as usize + c] += by * s.direction[c]);
        }
    }

    /// Energy of the springs beside that of their multipliers, J.
    pub(crate) fn energy(&self, offset: &[f64], v: &[f64]) -> f64 {
        let energy = |s: &Sprung| 0.5 * s.stiffness * s.missing(offset, v).powi(2);
        self.0.iter().map(energy).sum()
    }
}

impl Sprung {
    fn missing(&self, offset: &[f64], v: &[f64]) -> f64 {
        offset[self.row] - dot(&self.direction, &v[3 * self.node as usize..][..3])
    }
}
