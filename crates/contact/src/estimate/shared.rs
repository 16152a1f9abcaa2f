//! Moves of nodes that several contact points share, as in meshes of order 2, and beside couplings: all at once.
//!
//! The change of the displacement that gives all contact and tied rows the values wanted, and is smallest in a norm
//! weighted by stiffness, is `C Pᵀ y` with `P C Pᵀ y` what is missing: rows `P`, compliances `C`. The matrix is like a
//! mass matrix of the surface, so that conjugate gradients need few iterations.

use super::admissible::AdmissibleNode;
use super::sprung::SprungNodes;
use crate::discrete::{ContactPoint, Couplings};
use crate::model::{ConstrainedPoint, Model};
use crate::tolerances::{FREEDOM_TAKEN, SETTLE_STOP, SHARED_MOVES, SHARED_ROUNDS, SHARED_STOP};
use crate::vec3::dot;
use signorini_fem_mesh::vec3::Vec3;
use signorini_qp::active_set::{ActiveSetPoint, ActiveSetProblem, ActiveSetWorkspace};
use signorini_qp::problem::Diagonal;
use signorini_qp::{
    ActiveSetSettings, DenseProjector, MovingSet, ProductSet, Segment, SymmetricOperator, active_set, vector,
};
use std::collections::{BTreeMap, HashSet};

/// Coefficients on components of the displacement.
type Row = Vec<(usize, f64)>;

/// What a row has to measure, m.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Target {
    At(f64),
    /// At most that.
    Below(f64),
    Any,
}

/// The rows of points that share nodes.
#[derive(Debug)]
pub(crate) struct SharedNodes {
    /// Coefficients of each row on the displacement of the nodes, in metres: the normal row of each point and those
    /// along the surface, point by point, then fixed rows. Displacements of couplings that are points stand behind
    /// those of nodes, along the axes of the coupling.
    pub(super) rows: Vec<Row>,
    /// The numbers of the rows of ties and equations, and of supports along which rows of points move their nodes.
    pub(super) fixed: Vec<usize>,
    /// Rows of each point.
    pub(super) counts: Vec<usize>,
    /// Of each displacement component of a node, relative.
    compliance: Vec<f64>,
    /// Inverse of the diagonal of the matrix.
    pub(super) inverse: Diagonal,
    /// Whether there may be more points than nodes that can move, or fixed rows may want what points do not.
    is_scarce: bool,
}

impl SharedNodes {
    /// `None` where each point has a node of its own that can move, and there are no equations.
    pub(crate) fn new(
        model: &Model,
        nodes: &[AdmissibleNode],
        sprung: &SprungNodes,
        stiffness: impl Fn() -> Vec<f64>,
    ) -> Option<Self> {
        let (gluing, discrete) = (model.tfeti.gluing(), &model.discrete);
        let equations = gluing.ranges().equations.clone();
        let (couplings, count) = (&discrete.couplings, discrete.decomposition.nodes());
        let is_coupled = |node: u32| couplings.has(node);
        let several = |point: &ContactPoint| point.sides.own.nodes().len() > 1;
        // of a single partner the node moves in the place of one that is coupled, but not where both are tied
        let stays = |point: &ContactPoint, others: usize| {
            let partner = point.sides.partner.iter().map(|side| side.nodes().len());
            is_coupled(point.node()) && partner.max().is_some_and(|count| count > others)
        };
        let points = || model.points.iter().map(|p| &p.contact);
        let mut is_scarce = points().any(|p| stays(p, 1))
            || ties_meet_points(model)
            || nodes.iter().any(AdmissibleNode::shares)
            || discrete.ties.iter().any(|tie| stays(tie, 0));
        if !is_scarce && equations.is_empty() && !points().chain(&discrete.ties).any(several) {
            return None;
        }
        let row = |row: usize, scale: f64| -> Row {
            let mut sums: BTreeMap<usize, f64> = BTreeMap::new();
            for (node, c, coefficient) in model.row(row) {
                *sums.entry(3 * node as usize + c).or_insert(0.0) += coefficient / scale;
            }
            for (k, axes) in couplings.axes.iter().enumerate().filter(|_| equations.contains(&row)) {
                let own = gluing.row(row).into_iter().filter(|e| e.0 == couplings.first + k);
                for (_, dof, coefficient) in own.filter(|_| model.scene.couplings[k].is_point()) {
                    for (c, axis) in axes.iter().enumerate() {
                        *sums.entry(3 * (count + k) + c).or_insert(0.0) +=
                            couplings.unit[k] * coefficient * axis[dof % 3];
                    }
                }
            }
            sums.into_iter().collect()
        };
        let counts = model.points.iter().map(|p| p.isotropic().count()).collect();
        let of_points = model.points.iter().flat_map(ConstrainedPoint::isotropic);
        let mut rows: Vec<_> = of_points.map(|own| row(own.row, own.scale)).collect();
        let mut fixed: Vec<usize> = (gluing.ranges().tied.start..equations.end).collect();
        let dragging = dragging(model, &rows);
        is_scarce |= !dragging.is_empty();
        fixed.extend(dragging);
        let mut stiffness = stiffness();
        sprung.stiffness().for_each(|(node, k)| stiffness[node as usize] += k);
        // couplings stay as they are
        let own = |(node, s): (u32, &f64)| if is_coupled(node) { 0.0 } else { 1.0 / s };
        let mut compliance: Vec<f64> = (0..).zip(&stiffness).flat_map(|node| [own(node); 3]).collect();
        if !equations.is_empty() {
            let stiffest = stiffness.iter().fold(0.0, |most: f64, s| most.max(*s));
            for (coupling, unit) in model.scene.couplings.iter().zip(&couplings.unit) {
                let (holds, own) = (coupling.holds(), 1.0 / (stiffest * unit * unit));
                compliance.extend((0..3).map(|c| if holds[c] { 0.0 } else { own }));
            }
        }
        let square = |row: &Row| row.iter().map(|&(at, v)| v * v * compliance[at]).sum::<f64>();
        // those of coupled nodes alone move nothing
        fixed.retain(|&number| square(&row(number, 1.0)) > 0.0);
        rows.extend(fixed.iter().map(|&number| row(number, 1.0)));
        let inverse = Diagonal::new(rows.iter().map(square).map(f64::recip).collect()).ok()?;
        Some(Self {
            rows,
            fixed,
            counts,
            compliance,
            inverse,
            is_scarce,
        })
    }

    /// The displacements of couplings behind those of the nodes, as far as rows know of them.
    pub(crate) fn with_points(&self, couplings: &Couplings, motions: &[[Vec3; 2]], v: &mut Vec<f64>) {
        if self.compliance.len() > v.len() {
            let along = motions
                .iter()
                .enumerate()
                .map(|(k, motion)| couplings.along(k, *motion));
            v.extend(along.flat_map(|along| [along[0], along[1], along[2]]));
        }
    }

    pub(crate) fn is_scarce(&self) -> bool {
        self.is_scarce
    }

    /// Moves the displacement `v` such that rows of points meet their targets, and fixed rows their `offset`.
    pub(crate) fn reach(&self, mut targets: Vec<Target>, offset: &[f64], v: &mut [f64]) {
        targets.extend(self.fixed.iter().map(|&row| Target::At(offset[row])));
        self.reach_all(&targets, v);
    }

    fn reach_all(&self, targets: &[Target], v: &mut [f64]) {
        let value = |row: &Row, v: &[f64]| row.iter().map(|&(at, c)| c * v[at]).sum::<f64>();
        let largest = targets.iter().filter_map(|target| match target {
            Target::At(value) | Target::Below(value) => Some(value.abs()),
            Target::Any => None,
        });
        let size = largest.fold(vector::max_abs(v), f64::max);
        let n = self.dim();
        let (mut moved, mut sum) = (vec![0.0; v.len()], vec![0.0; n]);
        for _ in 0..SHARED_ROUNDS {
            let rows = self.rows.iter().zip(targets);
            let missing = rows.map(|(row, target)| match target {
                Target::At(at) | Target::Below(at) => at - value(row, v),
                Target::Any => 0.0,
            });
            let missing: Vec<f64> = missing.collect();
            let known = targets.iter().zip(&missing).zip(&sum);
            let off = known.map(|((target, off), sum)| match target {
                // room is left
                Target::Below(_) if *sum == 0.0 => (-off).max(0.0),
                _ => off.abs(),
            });
            let off = off.fold(0.0, f64::max);
            if off <= SHARED_STOP * size {
                return;
            }
            // forces of rows push towards their targets only
            let [lower, upper] = [f64::NEG_INFINITY, f64::INFINITY].map(|end| {
                let bound = |(target, sum): (&Target, &f64)| match target {
                    Target::Any => 0.0,
                    Target::Below(_) if end > 0.0 => -sum,
                    _ => end,
                };
                targets.iter().zip(&sum).map(bound).collect()
            });
            let Ok(mut set) = ProductSet::new(vec![Segment::bounds(lower, upper)]) else {
                return;
            };
            // as far as rows depend on one another the result is one of many
            let mut y = vec![0.0; n];
            if self.solve(&missing, &mut set, &mut y).is_none() {
                return;
            }
            self.spread(&y, &mut moved);
            vector::axpy(1.0, &moved, v);
            vector::axpy(1.0, &y, &mut sum);
        }
    }

    /// The `y` in the set, from that given on, with the smallest `1/2 yᵀ P C Pᵀ y - yᵀ linear`.
    pub(super) fn solve(&self, linear: &[f64], set: &mut ProductSet, y: &mut [f64]) -> Option<()> {
        let problem = ActiveSetProblem {
            operator: self,
            preconditioner: &self.inverse,
            scale: self.inverse.entries(),
            linear,
            rhs: &[],
        };
        // no equality
        let mut projector = DenseProjector::new(0, self.dim(), Vec::new()).ok()?;
        let settings = ActiveSetSettings::default().with_tolerance(SETTLE_STOP);
        let settings = settings.with_max_products(SHARED_MOVES);
        // the product of zero is known
        let known = y.iter().all(|y| *y == 0.0);
        let (x, ax) = (y, &mut vec![0.0; self.dim()][..]);
        let (set, point) = (MovingSet::fixed(set), ActiveSetPoint { x, ax, known });
        let mut work = ActiveSetWorkspace::new(self, &self.inverse);
        let solved = active_set(&problem, &mut projector, set, point, &settings, &mut work);
        solved.ok().map(drop)
    }

    /// The smallest change of a displacement by which rows of ties grow by so much, of those from the `first` on.
    pub(super) fn change_of_ties(&self, first: usize, growth: &[f64]) -> Vec<f64> {
        let mut change = vec![0.0; self.compliance.len()];
        let points = self.rows.len() - self.fixed.len();
        let mut targets = vec![Target::Any; points];
        let growth = |row: &usize| row.checked_sub(first).and_then(|tie| growth.get(tie)).copied();
        targets.extend(self.fixed.iter().map(|row| Target::At(growth(row).unwrap_or(0.0))));
        self.reach_all(&targets, &mut change);
        change
    }

    /// `C Pᵀ y`
    pub(super) fn spread(&self, y: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (row, y) in self.rows.iter().zip(y) {
            row.iter().for_each(|&(at, c)| out[at] += c * y * self.compliance[at]);
        }
    }
}

/// Whether nodes of ties are nodes of contact points.
pub(super) fn ties_meet_points(model: &Model) -> bool {
    let tied = model.discrete.ties.iter().flat_map(|tie| tie.sides.nodes());
    let tied: HashSet<u32> = tied.map(|(node, _)| node).collect();
    let mut points = model.points.iter().map(|p| &p.contact.sides);
    !tied.is_empty() && points.any(|sides| sides.nodes().any(|(node, _)| tied.contains(&node)))
}

/// Rows of supports along which rows of points move their nodes: where supports drag points along, no row is without
/// what they fix.
fn dragging(model: &Model, rows: &[Row]) -> Vec<usize> {
    let gluing = model.tfeti.gluing();
    if gluing.dependent_nodes().is_empty() {
        return Vec::new();
    }
    let mut parts: BTreeMap<usize, Vec<[f64; 3]>> = BTreeMap::new();
    for row in rows {
        for same in row.chunk_by(|a, b| a.0 / 3 == b.0 / 3) {
            let mut part = [0.0; 3];
            same.iter().for_each(|&(at, c)| part[at % 3] = c);
            parts.entry(same[0].0 / 3).or_default().push(part);
        }
    }
    let supports = gluing.ranges().dirichlet.start..gluing.spring_rows().start;
    let drags = |row: &usize| {
        let direction = gluing.direction(*row);
        let along = |part: &[f64; 3]| dot(part, &direction).powi(2) > FREEDOM_TAKEN * dot(&direction, &direction);
        let moves = |node: &u32| gluing.is_dependent(*node) && !model.discrete.couplings.has(*node);
        let node = gluing.node(*row).filter(moves);
        let own = node.and_then(|node| parts.get(&(node as usize)));
        own.is_some_and(|parts| parts.iter().any(along))
    };
    supports.filter(drags).collect()
}

/// `P C Pᵀ`
impl SymmetricOperator for SharedNodes {
    type Scratch = Vec<f64>;

    fn dim(&self) -> usize {
        self.rows.len()
    }

    fn scratch(&self) -> Vec<f64> {
        vec![0.0; self.compliance.len()]
    }

    fn apply(&self, x: &[f64], y: &mut [f64], moved: &mut Vec<f64>) {
        self.spread(x, moved);
        for (row, y) in self.rows.iter().zip(y) {
            *y = row.iter().map(|&(at, c)| c * moved[at]).sum();
        }
    }
}
