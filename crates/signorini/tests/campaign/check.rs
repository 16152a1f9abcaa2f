//! The check of one level: displacement, contact forces and reactions that the library reports, against all conditions
//! of the recipe. It shares no code with the library's model.
//!
//! | condition | relative to |
//! |---|---|
//! | equilibrium at nodes: strained tetrahedra = loads + contact forces + reactions | norm of the nodal forces of strained subdomains and of the loads |
//! | forces and moments of the whole | the same; moments: times the size of the mesh |
//! | copies of a node, supports, penetration, reported gaps and slips | largest displacement |
//! | pulling, cone, friction off the surface, reported slip bounds | largest contact force at a node |
//! | force times open gap; slip and friction that are not opposite (`abs(r s + abs(s) t)`) | the product of both |
//!
//! Sizes are those of the bodies that may touch each other, at the level. The displacement is at least what the load of
//! a node would do to it with all others held, the contact force at least 1e-4 of all forces, and both at least a
//! thousandth of those at earlier levels; forces are at least 1e-8 of displacements times stiffness, below which they
//! are rounding.

pub(crate) mod apart;
mod contact;
mod grip;

use crate::mechanics::{Mechanics, groups};
use crate::recipe::{Clock, Recipe};
use crate::spots::{Spot, spots};
use crate::vec3::{Vec3, across, add, at, cross, dot, norm, scale, sub, unit};
use signorini::contact::result::Reactions;
use signorini::prelude::*;

/// A condition and how much it is violated, relative.
pub(crate) type Violation = (&'static str, f64);

/// Directions closer than this are one.
const SAME: f64 = 1.0 - 1e-9;
/// Sizes of earlier levels count by this part, contact forces by that part of all forces.
const REST: f64 = 1e-3;
const SMALL_PART: f64 = 1e-4;
/// Forces below this part of displacement times stiffness are rounding.
const ROUNDED: f64 = 1e-8;

/// What violations of bodies that may touch each other are relative to.
#[derive(Debug, Clone, Copy, Default)]
struct Size {
    displacement: f64,
    contact: f64,
    forces: f64,
}

/// The judge of a run: it keeps the history of slips by itself.
pub(crate) struct Judge<'a> {
    recipe: &'a Recipe,
    mechanics: Mechanics,
    spots: Vec<Spot>,
    /// Whether supports fix all directions along the surface of each spot: then there is no friction.
    stuck: Vec<bool>,
    /// Group of bodies of each node.
    group: Vec<usize>,
    /// Displacement of each spot relative to its obstacle or partner at the last level and the one before.
    ways: [Vec<Vec3>; 2],
    /// Slip rate of each spot at the last level.
    rates: Vec<f64>,
    before: f64,
    peaks: Vec<Size>,
    /// Extent of the mesh.
    extent: f64,
}

/// One level as the library reports it.
struct Report<'f> {
    points: &'f [PointState],
    u: Vec<f64>,
    reactions: Reactions,
    time: f64,
}

/// Collects the worst of each condition.
#[derive(Default)]
pub(crate) struct Worst(pub(crate) Vec<Violation>);

impl Worst {
    pub(crate) fn add(&mut self, name: &'static str, value: f64, size: f64) {
        let relative = if value <= 0.0 { 0.0 } else { value / size };
        match self.0.iter_mut().find(|v| v.0 == name) {
            Some(v) if relative > v.1 || relative.is_nan() => v.1 = relative,
            Some(_) => {}
            None => self.0.push((name, relative)),
        }
    }
}

impl<'a> Judge<'a> {
    pub(crate) fn new(recipe: &'a Recipe) -> Self {
        let mechanics = Mechanics::new(recipe);
        let spots = spots(recipe, &mechanics);
        let nodes = mechanics.points.len();
        let bodies = (0..).zip(&mechanics.body).map(|(n, b)| (n, *b as u32));
        let touching = spots.iter().filter_map(|s| Some((s.node, s.partner?)));
        let touching = touching.filter(|p| p.1 != u32::MAX);
        let group = groups(nodes, bodies.chain(touching));
        let extent = (0..3).map(|c| {
            let values = || mechanics.points.iter().map(move |p| p[c]);
            values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
        });
        Self {
            ways: [vec![[0.0; 3]; spots.len()], vec![[0.0; 3]; spots.len()]],
            rates: vec![0.0; spots.len()],
            peaks: vec![Size::default(); nodes],
            extent: extent.fold(0.0, f64::max),
            before: 0.0,
            stuck: contact::stuck(recipe, &spots, nodes),
            recipe,
            mechanics,
            spots,
            group,
        }
    }

    /// Judges a level and takes it into the history.
    pub(crate) fn step(&mut self, frame: &StepResult) -> Result<Vec<Violation>, Error> {
        let report = Report {
            points: frame.points(),
            u: frame.displacement().into_flattened(),
            reactions: frame.reactions(),
            time: frame.time(),
        };
        let mut worst = Worst::default();
        let load = self.mechanics.load_at(self.recipe, report.time);
        let torn = self.mechanics.torn(frame);
        let sizes = self.sizes(&report, &load, &torn);
        self.copies(frame, &report.u, &sizes, &mut worst);
        self.equilibrium(&report, &load, &torn.0, &sizes, &mut worst);
        self.balance(&report, &load, &sizes, &mut worst);
        self.supports(&report, &sizes, &mut worst);
        let slips = self.slips(&report);
        let of = self.assign(report.points);
        self.contact(&report, &of, &slips, &sizes, &mut worst);
        self.sums(frame, &of, &sizes, &mut worst);
        // history
        let step = report.time - self.before;
        let quasistatic = matches!(self.recipe.clock, Clock::Steps { .. });
        self.rates = slips
            .iter()
            .map(|s| if quasistatic { norm(s.slip) / step } else { 0.0 })
            .collect();
        self.ways.swap(0, 1);
        self.ways[0] = slips.iter().map(|s| s.way).collect();
        self.remember(&report, frame, &sizes);
        Ok(worst.0)
    }

    /// Sizes of a level count at later ones.
    fn remember(&mut self, report: &Report<'_>, frame: &StepResult, sizes: &[Size]) {
        self.before = report.time;
        if frame.report().status.converged() {
            for (peak, size) in self.peaks.iter_mut().zip(sizes) {
                peak.displacement = peak.displacement.max(size.displacement);
                peak.contact = peak.contact.max(size.contact);
                peak.forces = peak.forces.max(size.forces);
            }
        }
    }

    fn sizes(&self, report: &Report<'_>, load: &[f64], torn: &(Vec<f64>, Vec<f64>)) -> Vec<Size> {
        let nodes = self.mechanics.points.len();
        let mut sizes = vec![Size::default(); nodes];
        let mut rounding = vec![0.0; nodes];
        for node in 0..nodes {
            let group = self.group[node];
            let (u, f) = (at(&report.u, node as u32), at(load, node as u32));
            let k = self.mechanics.stiffness[node];
            let size = &mut sizes[group];
            size.displacement = size.displacement.max(norm(u)).max(norm(f) / k);
            size.forces += torn.1[node] + dot(f, f);
            rounding[group] += k * k * dot(u, u);
        }
        for point in report.points {
            let size = &mut sizes[self.group[point.node as usize]];
            size.contact = size.contact.max(norm(point.force()));
        }
        for ((size, peak), rounding) in sizes.iter_mut().zip(&self.peaks).zip(rounding) {
            let rounding = ROUNDED * rounding.sqrt();
            size.displacement = size.displacement.max(REST * peak.displacement);
            size.forces = size.forces.sqrt().max(REST * peak.forces).max(rounding);
            let least = (SMALL_PART * size.forces).max(REST * peak.contact);
            size.contact = size.contact.max(least).max(rounding);
        }
        sizes
    }

    fn size<'s>(&self, sizes: &'s [Size], node: u32) -> &'s Size {
        &sizes[self.group[node as usize]]
    }

    /// Copies of a node are where their mean is.
    fn copies(&self, frame: &StepResult, u: &[f64], sizes: &[Size], worst: &mut Worst) {
        let mut start = 0;
        for subdomain in frame.decomposition().subdomains() {
            for (local, &node) in (0..).zip(&subdomain.nodes) {
                let own = at(&frame.torn_displacement()[start..], local);
                let off = norm(sub(own, at(u, node)));
                worst.add("continuity", off, self.size(sizes, node).displacement);
            }
            start += 3 * subdomain.nodes.len();
        }
    }

    fn equilibrium(&self, report: &Report<'_>, load: &[f64], strained: &[f64], sizes: &[Size], worst: &mut Worst) {
        let mut rest: Vec<Vec3> = (0..self.mechanics.points.len() as u32)
            .map(|n| sub(at(strained, n), at(load, n)))
            .collect();
        for point in report.points {
            let force = point.force();
            let own = &mut rest[point.node as usize];
            *own = sub(*own, force);
            if let Some(partner) = point.partner {
                let other = &mut rest[partner as usize];
                *other = add(*other, force);
            }
        }
        for reaction in report.reactions.supports.iter().flat_map(|s| &s.nodes) {
            let own = &mut rest[reaction.node as usize];
            *own = sub(*own, reaction.force);
        }
        let mut squares = vec![0.0; rest.len()];
        for (node, rest) in rest.iter().enumerate() {
            squares[self.group[node]] += dot(*rest, *rest);
        }
        for (group, square) in squares.iter().enumerate() {
            worst.add("equilibrium", square.sqrt(), sizes[group].forces);
        }
    }

    /// Loads, contact and supports as the library sums them up.
    fn balance(&self, report: &Report<'_>, load: &[f64], sizes: &[Size], worst: &mut Worst) {
        let places = &self.mechanics.points;
        let forces = sizes.iter().map(|s| s.forces.powi(2)).sum::<f64>().sqrt();
        let far = places.iter().map(|x| norm(*x)).fold(self.extent, f64::max);
        let mut sums = [[[0.0; 3]; 2]; 3];
        let mut put = |which: usize, node: u32, force: Vec3| {
            let moment = cross(places[node as usize], force);
            sums[which][0] = add(sums[which][0], force);
            sums[which][1] = add(sums[which][1], moment);
        };
        (0..places.len() as u32).for_each(|n| put(0, n, at(load, n)));
        for point in report.points {
            put(1, point.node, point.force());
            if let Some(partner) = point.partner {
                put(1, partner, scale(-1.0, point.force()));
            }
        }
        for support in &report.reactions.supports {
            let mut own = [[0.0; 3]; 2];
            for node in &support.nodes {
                put(2, node.node, node.force);
                own[0] = add(own[0], node.force);
                own[1] = add(own[1], cross(places[node.node as usize], node.force));
            }
            let said = [support.resultant.force, support.resultant.moment];
            worst.add("reaction sums", norm(sub(own[0], said[0])), forces);
            worst.add("reaction sums", norm(sub(own[1], said[1])), far * forces);
        }
        let said = [&report.reactions.loads, &report.reactions.contact];
        for (own, said) in sums.iter().zip(said) {
            worst.add("reaction sums", norm(sub(own[0], said.force)), forces);
            worst.add("reaction sums", norm(sub(own[1], said.moment)), far * forces);
        }
        let [force, moment] = [0, 1].map(|k| norm(add(sums[0][k], add(sums[1][k], sums[2][k]))));
        worst.add("balance", force, forces);
        worst.add("balance", moment, far * forces);
    }

    /// Supports move as they are told, and push along what they fix only.
    fn supports(&self, report: &Report<'_>, sizes: &[Size], worst: &mut Worst) {
        let mut held: Vec<Vec<Vec3>> = vec![Vec::new(); self.mechanics.points.len()];
        let supports = self.recipe.holds.iter().zip(&report.reactions.supports);
        for (hold, reaction) in supports {
            for (place, node) in hold.nodes(&self.recipe.mesh).into_iter().enumerate() {
                let size = self.size(sizes, node);
                let x = self.mechanics.points[node as usize];
                let told = hold.displacement(place, x, report.time);
                let off = sub(at(&report.u, node), told);
                let force = reaction.nodes.iter().find(|n| n.node == node);
                let force = force.map_or([0.0; 3], |n| n.force);
                // an earlier support has what it fixes
                let earlier = &mut held[node as usize];
                for d in earlier.iter() {
                    worst.add("reaction direction", dot(force, *d).abs(), size.forces);
                }
                for v in hold.fixed.vectors(place, x) {
                    let d = unit(v);
                    worst.add("support", dot(off, d).abs(), size.displacement);
                    let rest = earlier.iter().fold(d, |d, e| across(d, *e));
                    if norm(rest) > 1e-6 {
                        earlier.push(unit(rest));
                    }
                }
                let free = earlier.iter().fold(force, |f, e| across(f, *e));
                worst.add("reaction direction", norm(free), size.forces);
            }
        }
    }
}
