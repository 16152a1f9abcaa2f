//! Linear equations between displacements: what supports leave of them, and which of them say something new.
//!
//! Equations are eliminated one after another, behind what holds places and the rows of ties that they touch, by sparse
//! rows with a pivot in the column that the fewest of the others have. One of which nothing is left says what others
//! say, or contradicts them. So are contact rows behind all equations: where nothing is left of one, its force is not
//! determined.

use super::contact::{AllRows, PointRows};
use super::rigid::RigidSupport;
use super::side::ContactConstraint;
use super::supports::{MergedSupports, check_node};
use crate::error::TfetiError;
use crate::linalg::entry;
use crate::rows::contact::contact_rows;
use crate::tolerances::{AGREEING, ALMOST, CASES, COEFFICIENTS, FIXED, PIVOTAL};
use signorini_fem_mesh::internal::DisjointSets;
use signorini_fem_mesh::vec3::{add, cross, dot, is_finite, norm, scale, sub};
use signorini_fem_mesh::{Decomposition, TetMesh};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Most other equations that an error names.
const NAMED: usize = 5;

/// A linear equation `sum a . u = value` between displacements.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NodalEquation {
    /// Mesh nodes, with what multiplies their displacements.
    pub terms: Vec<(u32, [f64; 3])>,
    /// [Subdomains of places](signorini_fem_mesh::decomposition::Rigid::Places), with what multiplies their
    /// displacements. Nothing but equations may act on these, and [rigid supports](RigidSupport) hold their rotations.
    pub places: Vec<(u32, [f64; 3])>,
    /// The value by displacement case, zero in others.
    pub values: Vec<(u32, f64)>,
}

/// What supports leave of an equation times a factor, with which its largest coefficient is one.
#[derive(Debug)]
pub(super) struct FreeEquation {
    /// Its position in the list.
    pub(super) equation: usize,
    pub(super) terms: Vec<(u32, [f64; 3])>,
    pub(super) places: Vec<(u32, [f64; 3])>,
    pub(super) values: Vec<(u32, f64)>,
    pub(super) factor: f64,
    /// What the values are made of.
    size: f64,
}

/// The sum of what is given for each key, over the largest.
fn sums(terms: &[(u32, [f64; 3])], largest: f64) -> BTreeMap<u32, [f64; 3]> {
    let mut out: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
    for (key, vector) in terms {
        let sum = out.entry(*key).or_default();
        (0..3).for_each(|c| sum[c] += vector[c] / largest);
    }
    out
}

impl FreeEquation {
    pub(super) fn new(
        (equation, given): (usize, &NodalEquation),
        decomposition: &Decomposition,
        supports: &MergedSupports,
    ) -> Result<Self, TfetiError> {
        let refuse = |reason| Err(refused(equation, None, reason));
        let all = || given.terms.iter().chain(&given.places);
        let largest = all().flat_map(|t| t.1).fold(0.0_f64, |most, v| most.max(v.abs()));
        if largest > 0.0 && !(COEFFICIENTS[0]..=COEFFICIENTS[1]).contains(&largest) {
            return refuse("its largest coefficient must be finite, from 1e-200 to 1e200; multiply all by a factor");
        }
        let largest = if largest > 0.0 { largest } else { 1.0 };
        let values = given.values.iter().map(|(case, value)| (*case, value / largest));
        let values: Vec<(u32, f64)> = values.collect();
        let finite = all().all(|(_, vector)| is_finite(*vector));
        if !(finite && values.iter().all(|v| v.1.is_finite())) {
            return refuse("its coefficients and its value over the largest of them must be finite");
        }
        if given.values.iter().any(|v| v.0 >= CASES) {
            return refuse("its displacement case is too large; number the cases from 0 without gaps");
        }
        let subdomains = decomposition.subdomains();
        let is_place = |s: &u32| {
            subdomains
                .get(*s as usize)
                .is_some_and(|own| own.is_relative && !own.nodes.is_empty())
        };
        if !given.places.iter().all(|(subdomain, _)| is_place(subdomain)) {
            return refuse("there is no subdomain of places of this number");
        }
        let mut out = Self {
            equation,
            terms: Vec::with_capacity(given.terms.len()),
            places: sums(&given.places, largest)
                .into_iter()
                .filter(|p| p.1 != [0.0; 3])
                .collect(),
            values,
            factor: largest.recip(),
            size: 0.0,
        };
        let mut said = !out.places.is_empty();
        for (node, vector) in sums(&given.terms, largest) {
            check_node(node, decomposition.nodes(), || format!("equation {equation}"))?;
            said |= vector != [0.0; 3];
            let mut left = vector;
            for fixed in supports.directions(node) {
                let along = dot(vector, fixed.direction);
                left = sub(left, scale(along, fixed.direction));
                for &(case, value) in &fixed.values {
                    *entry(&mut out.values, case, 0.0) -= along * value;
                    out.size = out.size.max((along * value).abs());
                }
            }
            if norm(left) > FIXED * norm(vector) {
                out.terms.push((node, left));
            }
        }
        out.size = out.values.iter().fold(out.size, |most, v| most.max(v.1.abs()));
        if said {
            Ok(out)
        } else {
            refuse(
                "its coefficients are zero, or add up to zero, so that it says nothing; correct them, or leave it out",
            )
        }
    }

    /// The first of its nodes, if one is left.
    fn node(&self) -> Option<u32> {
        self.terms.first().map(|t| t.0)
    }
}

fn refused(equation: usize, node: Option<u32>, reason: &'static str) -> TfetiError {
    let others = Vec::new();
    TfetiError::Equation {
        equation,
        node,
        others,
        reason,
    }
}

/// The equations whose rows are needed, by their positions: others say what these and the supports say, too.
///
/// # Errors
/// [`TfetiError`] as of a set-up: contradictions, and contact or ties that say what equations say.
pub fn independent_equations(
    equations: &[NodalEquation],
    (mesh, decomposition): (&TetMesh, &Decomposition),
    (supports, rigid): (&MergedSupports, &[RigidSupport]),
    contact: &[ContactConstraint],
) -> Result<Vec<usize>, TfetiError> {
    if equations.is_empty() {
        return Ok(Vec::new());
    }
    let rows = contact_rows(contact, supports, |_| 1.0)?;
    let all = equations.iter().enumerate();
    let all = all.map(|given| FreeEquation::new(given, decomposition, supports));
    let all: Vec<FreeEquation> = all.collect::<Result<_, _>>()?;
    let lines = lines(&all, (mesh, decomposition), rigid, (contact, &rows));
    let mut elimination = Elimination::new(&lines);
    let mut needed = Vec::with_capacity(all.len());
    for line in &lines {
        let left = elimination.reduce(line);
        let most = left.largest();
        match line.kind {
            Kind::Equation(k) if most <= FIXED * left.size => left.check(&all[k], supports)?,
            Kind::Equation(k) if most <= ALMOST * left.size => {
                let reason = "it depends on others but for a millionth of its coefficients; give these more digits, or \
                    leave it out";
                return Err(left.refused(&all[k], reason));
            }
            Kind::Contact(node) if most <= ALMOST * left.size => {
                // what contact points say of one another is judged elsewhere
                if let Some(&equation) = left.equations.first() {
                    let reason = "it says how a node moves that may touch something, so that the contact force, or the \
                        friction, is not determined; leave the node out of one of them";
                    return Err(refused(equation, Some(node), reason));
                }
            }
            Kind::Held | Kind::Tied if most <= ALMOST * left.size => {}
            kind => {
                if let Kind::Equation(k) = kind {
                    needed.push(k);
                }
                elimination.add(kind, left);
            }
        }
    }
    Ok(needed)
}

/// What a row that is eliminated is.
#[derive(Debug, Clone, Copy)]
enum Kind {
    /// What holds places.
    Held,
    Tied,
    /// By its place.
    Equation(usize),
    /// With the node of the point.
    Contact(u32),
}

/// A row over the displacements of nodes and places, and the motions of one part relative to another.
#[derive(Debug)]
struct Line {
    kind: Kind,
    entries: Vec<(usize, f64)>,
    values: Vec<(u32, f64)>,
    /// What the values are made of.
    size: f64,
}

/// The rows in the order of elimination: equations, before them what else says something of their nodes and places,
/// ties with the motion that their sides have against each other, and behind them contact rows that are connected with
/// them.
fn lines(
    equations: &[FreeEquation],
    (mesh, decomposition): (&TetMesh, &Decomposition),
    rigid: &[RigidSupport],
    (contact, rows): (&[ContactConstraint], &AllRows),
) -> Vec<Line> {
    let nodes = decomposition.nodes();
    let columns = |at: usize, vector: &[f64; 3]| {
        let vector = *vector;
        (0..3)
            .filter(move |c| vector[*c] != 0.0)
            .map(move |c| (3 * at + c, vector[c]))
    };
    let subdomains = decomposition.subdomains().len();
    // displacement and rotation of a subdomain
    let moving = |subdomain: u32, [shift, turn]: &[[f64; 3]; 2]| {
        let at = nodes + subdomain as usize;
        columns(at, shift)
            .chain(columns(at + subdomains, turn))
            .collect::<Vec<_>>()
    };
    let points: HashMap<u32, [f64; 3]> = rigid.iter().rev().map(|held| (held.subdomain, held.point)).collect();
    let about = |subdomain: u32| points.get(&subdomain).copied().unwrap_or_default();
    let mut sets = DisjointSets::new(nodes + subdomains);
    let of_point = |point: &PointRows| contact[point.point].nodes().map(|n| n.0 as usize).collect::<Vec<_>>();
    let places = |e: &FreeEquation| -> Vec<usize> {
        let own = e.places.iter().map(|p| nodes + p.0 as usize);
        e.terms.iter().map(|t| t.0 as usize).chain(own).collect()
    };
    equations.iter().for_each(|e| sets.join_all(places(e)));
    let points = rows.tied.iter().chain(&rows.rows);
    points.for_each(|point| sets.join_all(of_point(point)));
    let touched: BTreeSet<usize> = equations.iter().flat_map(places).map(|at| sets.first(at)).collect();
    let mut own = |points: &[PointRows], kind: &dyn Fn(u32) -> Kind| -> Vec<Line> {
        let mut out = Vec::new();
        for point in points {
            let all = of_point(point);
            if !touched.contains(&sets.first(all[0])) {
                continue;
            }
            for row in std::iter::once(&point.normal).chain(&point.tangential) {
                let own = all.iter().zip(&row.parts).flat_map(|(at, v)| columns(*at, v));
                let of = &contact[point.point];
                let relative = of.relative.map_or_else(Vec::new, |(subdomain, factor)| {
                    let mut motion = [[0.0; 3]; 2];
                    for (node, vector) in of.on_side(row.direction) {
                        let vector = scale(-factor * row.scale, vector);
                        let arm = sub(mesh.points()[node as usize], about(subdomain));
                        motion = [add(motion[0], vector), add(motion[1], cross(arm, vector))];
                    }
                    moving(subdomain, &motion)
                });
                out.push(Line {
                    kind: kind(all[0] as u32),
                    entries: own.chain(relative).collect(),
                    values: Vec::new(),
                    size: 0.0,
                });
            }
        }
        out
    };
    let (tied, touching) = (own(&rows.tied, &|_| Kind::Tied), own(&rows.rows, &Kind::Contact));
    let held = rigid.iter().map(|held| {
        let [shift, turn] = held.direction;
        let arm = sub(held.point, about(held.subdomain));
        Line {
            kind: Kind::Held,
            entries: moving(held.subdomain, &[shift, add(turn, cross(arm, shift))]),
            values: held.values.clone(),
            size: held.values.iter().fold(0.0, |most, v| most.max(v.1.abs())),
        }
    });
    let equation = |(k, e): (usize, &FreeEquation)| {
        let terms = e.terms.iter().flat_map(|(node, v)| columns(*node as usize, v));
        let places = e.places.iter().flat_map(|(s, v)| columns(nodes + *s as usize, v));
        Line {
            kind: Kind::Equation(k),
            entries: terms.chain(places).collect(),
            values: e.values.clone(),
            size: e.size,
        }
    };
    let equations = equations.iter().enumerate().map(equation);
    held.chain(tied).chain(equations).chain(touching).collect()
}

/// What is left of a row, its largest entry one before.
#[derive(Debug, Default)]
struct Left {
    entries: BTreeMap<usize, f64>,
    values: Vec<(u32, f64)>,
    /// The largest entry and value on the way.
    size: f64,
    value_size: f64,
    /// Equations that were taken out, or one of those that a row is made of that was.
    equations: BTreeSet<usize>,
    /// Whether ties were taken out.
    tied: bool,
}

impl Left {
    fn largest(&self) -> f64 {
        self.entries.values().fold(0.0, |most, v| most.max(v.abs()))
    }

    fn refused(&self, equation: &FreeEquation, reason: &'static str) -> TfetiError {
        TfetiError::Equation {
            equation: equation.equation,
            node: equation.node(),
            others: self.equations.iter().copied().take(NAMED).collect(),
            reason,
        }
    }

    /// Refuses an equation of which nothing is left unless it agrees with the others.
    fn check(&self, equation: &FreeEquation, supports: &MergedSupports) -> Result<(), TfetiError> {
        if self.tied {
            return Err(self.refused(
                equation,
                "it says what a tied contact says, too; leave its nodes out of one of them",
            ));
        }
        let agrees = |(case, value): &(u32, f64)| {
            value.abs() <= (AGREEING * self.value_size).max(self.size * supports.off(*case))
        };
        if self.values.iter().all(agrees) {
            Ok(())
        } else {
            Err(self.refused(
                equation,
                "it contradicts what supports and other equations say of its nodes; correct its value or the history of \
                that, or leave it out",
            ))
        }
    }
}

#[derive(Debug)]
struct Pivot {
    column: usize,
    row: Left,
    /// The equation that it is, or one that it is made of.
    equation: Option<usize>,
}

/// Rows that are independent, none with the pivot of one before it.
#[derive(Debug)]
struct Elimination {
    pivots: Vec<Pivot>,
    of_column: HashMap<usize, usize>,
    /// How many of the rows to come have a column.
    users: HashMap<usize, usize>,
}

impl Elimination {
    fn new(lines: &[Line]) -> Self {
        let mut users = HashMap::new();
        for (column, _) in lines.iter().flat_map(|line| &line.entries) {
            *users.entry(*column).or_insert(0) += 1;
        }
        Self {
            pivots: Vec::new(),
            of_column: HashMap::new(),
            users,
        }
    }

    fn reduce(&mut self, line: &Line) -> Left {
        let unit = line.entries.iter().fold(0.0_f64, |most, e| most.max(e.1.abs()));
        let unit = if unit > 0.0 { unit } else { 1.0 };
        let mut left = Left {
            entries: line.entries.iter().map(|(column, v)| (*column, v / unit)).collect(),
            values: line.values.iter().map(|(case, v)| (*case, v / unit)).collect(),
            size: 1.0,
            value_size: line.size / unit,
            ..Left::default()
        };
        for (column, _) in &line.entries {
            self.users.entry(*column).and_modify(|count| *count -= 1);
        }
        let known = left.entries.keys().filter_map(|column| self.of_column.get(column));
        let mut known: BTreeSet<usize> = known.copied().collect();
        while let Some(next) = known.pop_first() {
            let Pivot { column, row, equation } = &self.pivots[next];
            let factor = left.entries.remove(column).unwrap_or(0.0) / row.entries[column];
            if factor == 0.0 {
                continue;
            }
            for (other, value) in row.entries.iter().filter(|e| e.0 != column) {
                let sum = left.entries.entry(*other).or_insert(0.0);
                *sum -= factor * value;
                left.size = left.size.max((factor * value).abs());
                known.extend(self.of_column.get(other));
            }
            for (case, value) in &row.values {
                *entry(&mut left.values, *case, 0.0) -= factor * value;
            }
            left.value_size = left.value_size.max(factor.abs() * row.value_size);
            left.equations.extend(*equation);
            left.tied |= row.tied;
        }
        left
    }

    /// Adds what is left of a row, with the pivot where the fewest of the others have an entry.
    fn add(&mut self, kind: Kind, mut row: Left) {
        let large = PIVOTAL * row.largest();
        let users = |column: &usize| self.users.get(column).copied().unwrap_or(0);
        let large = row.entries.iter().filter(|e| e.1.abs() >= large);
        let Some((&column, _)) = large.min_by_key(|e| users(e.0)) else {
            return;
        };
        row.entries.retain(|_, value| *value != 0.0);
        row.tied |= matches!(kind, Kind::Tied);
        let equation = match kind {
            Kind::Equation(k) => Some(k),
            Kind::Held | Kind::Tied | Kind::Contact(_) => row.equations.first().copied(),
        };
        row.equations.clear();
        self.of_column.insert(column, self.pivots.len());
        self.pivots.push(Pivot { column, row, equation });
    }
}
