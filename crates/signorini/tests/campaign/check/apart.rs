//! The same check for bodies meshed apart. Of a contact point it takes from the library which nodes it is made of, and
//! judges these, too: weights of either side sum to one, leave no moment where sides are flat, and areas are those of
//! the sides where they face each other; where that is all of both, uniform pressure is at each node of either side the
//! area of that node.
//!
//! | condition | relative to |
//! |---|---|
//! | equilibrium at nodes that no tie has: strained tetrahedra = loads + contact forces times weights + reactions | forces |
//! | the rest at tied sides: no force and no moment in all, and no work | forces; forces times displacements |
//! | gap, sign, complementarity, cone (an ellipse), direction (its normal), as for matching meshes | as there |
//! | forces of a foundation: stiffness times displacement | forces |
//!
//! Where contact gives way, the gap counts compliance times pressure, and slips are without compliance times friction
//! stress. Forces between curved sides act where facets are, not where sides are, and a couple on one of them makes up
//! for it: it is taken from the library, for moments must balance; so are gaps at the start, as far as the bumps allow
//! them.

mod points;

use super::{Judge, Report, Size, Violation, Worst};
use crate::apart::{Apart, Pair, Rock};
use crate::mechanics::groups;
use crate::recipe::{Clock, Law};
use crate::vec3::{Vec3, add, at, cross, dot, norm, scale, sub, unit};
use signorini::contact::ConstrainedPoint;
use signorini::prelude::*;
use std::collections::{HashMap, HashSet};

/// The judge of a run.
pub(crate) struct ApartJudge<'a> {
    pub(super) base: Judge<'a>,
    pub(super) scene: &'a Apart,
    /// As in the other judge, for the points of the library.
    ways: [Vec<Vec3>; 2],
    rates: Vec<f64>,
    /// Nodes of both sides of each pair.
    sides: Vec<[HashSet<u32>; 2]>,
    /// Whether these are known: what lies between levels, where steps are halved, is not.
    known: Known,
}

/// What is known at a level: slips, and those before it.
#[derive(Debug, Clone, Copy)]
struct Known {
    slips: bool,
    rates: bool,
    /// Whether the step was taken as a whole.
    whole: bool,
}

/// A point at a level.
struct At {
    way: Vec3,
    gap: f64,
    slip: Vec3,
}

impl<'a> ApartJudge<'a> {
    pub(crate) fn new(scene: &'a Apart) -> Self {
        let mut base = Judge::new(&scene.recipe);
        let nodes = base.mechanics.points.len();
        let node = |tag: FacetTag| base.mechanics.sides.iter().find(|s| s.tag == tag).map(|s| s.nodes[0]);
        let bodies = (0..).zip(&base.mechanics.body).map(|(n, b)| (n, *b as u32));
        let pairs = scene
            .pairs
            .iter()
            .filter_map(|p| Some((node(p.sides[0])?, node(p.sides[1])?)));
        let coupled = scene
            .grips
            .iter()
            .flat_map(|g| g.nodes.windows(2).map(|w| (w[0], w[1])));
        base.group = groups(nodes, bodies.chain(pairs).chain(coupled));
        let on = |tag: FacetTag| {
            let sides = base.mechanics.sides.iter().filter(move |s| s.tag == tag);
            sides
                .flat_map(|s| s.nodes.into_iter().chain(s.loaded))
                .collect::<HashSet<u32>>()
        };
        Self {
            sides: scene.pairs.iter().map(|p| p.sides.map(on)).collect(),
            base,
            scene,
            ways: [Vec::new(), Vec::new()],
            rates: Vec::new(),
            known: Known {
                slips: true,
                rates: true,
                whole: true,
            },
        }
    }

    /// Judges a level and takes it into the history.
    pub(crate) fn step(&mut self, points: &[ConstrainedPoint], frame: &StepResult) -> Result<Vec<Violation>, Error> {
        let report = Report {
            points: frame.points(),
            u: frame.displacement().into_flattened(),
            reactions: frame.reactions(),
            time: frame.time(),
        };
        if self.rates.is_empty() {
            self.rates = vec![0.0; points.len()];
            self.ways = [vec![[0.0; 3]; points.len()], vec![[0.0; 3]; points.len()]];
        }
        let whole = frame.report().counters.between == 0;
        let one_step = match self.base.recipe.clock {
            Clock::Static(_) => true,
            Clock::Steps { weights, .. } => weights[2] == 0.0,
        };
        self.known = Known {
            slips: whole && (one_step || self.known.whole),
            rates: whole && self.known.slips,
            whole,
        };
        let mut worst = Worst::default();
        let load = self.base.mechanics.load_at(self.base.recipe, report.time);
        let torn = self.base.mechanics.torn(frame);
        let mut sizes = self.base.sizes(&report, &load, &torn);
        self.add_grips(report.time, &mut sizes);
        self.base.copies(frame, &report.u, &sizes, &mut worst);
        self.base.supports(&report, &sizes, &mut worst);
        let rest = self.equilibrium(points, &report, (&load, &torn.0), &sizes, &mut worst);
        self.grips(frame, &rest, &report, &sizes, &mut worst);
        self.balance(points, &report, &load, &sizes, &mut worst);
        self.weights(points, &mut worst);
        self.ground(&report, &sizes, &mut worst);
        let now: Vec<At> = points.iter().enumerate().map(|(k, p)| self.at(k, p, &report)).collect();
        worst.add("points", (points.len() as f64 - report.points.len() as f64).abs(), 1.0);
        for (k, (point, state)) in points.iter().zip(report.points).enumerate() {
            let size = self.base.size(&sizes, point.node());
            self.point((k, point), state, &now[k], size, &mut worst);
        }
        let step = report.time - self.base.before;
        let quasistatic = matches!(self.base.recipe.clock, Clock::Steps { .. });
        self.rates = now
            .iter()
            .map(|a| if quasistatic { norm(a.slip) / step } else { 0.0 })
            .collect();
        self.ways.swap(0, 1);
        self.ways[0] = now.iter().map(|a| a.way).collect();
        self.base.remember(&report, frame, &sizes);
        Ok(worst.0)
    }

    fn rock(&self, point: &ConstrainedPoint) -> Option<&Rock> {
        let place = point.surface().checked_sub(self.scene.pairs.len())?;
        self.scene.rocks.get(place)
    }

    fn law(&self, point: &ConstrainedPoint) -> (&Law, Option<(Vec3, f64)>) {
        match (self.rock(point), self.scene.pairs.get(point.surface())) {
            (Some(rock), _) => (&rock.law, rock.axis),
            (_, Some(pair)) => (&pair.law, pair.axis),
            _ => (&Law::None, None),
        }
    }

    /// What ties and couplings do is left at the nodes; it is nothing elsewhere.
    fn equilibrium(
        &self,
        points: &[ConstrainedPoint],
        report: &Report<'_>,
        (load, strained): (&[f64], &[f64]),
        sizes: &[Size],
        worst: &mut Worst,
    ) -> Vec<Vec3> {
        let mechanics = &self.base.mechanics;
        let mut rest: Vec<Vec3> = (0..mechanics.points.len() as u32)
            .map(|n| sub(at(strained, n), at(load, n)))
            .collect();
        for (point, state) in points.iter().zip(report.points) {
            for (node, force) in point.forces(state.force()) {
                let own = &mut rest[node as usize];
                *own = sub(*own, force);
            }
        }
        let reactions = &report.reactions;
        for reaction in reactions
            .supports
            .iter()
            .chain(&reactions.springs)
            .flat_map(|s| &s.nodes)
        {
            let own = &mut rest[reaction.node as usize];
            *own = sub(*own, reaction.force);
        }
        let ties: Vec<&Pair> = self.scene.pairs.iter().filter(|p| p.tied).collect();
        for (index, pair) in self.scene.pairs.iter().enumerate().filter(|p| p.1.tied) {
            let first = self.tied(index, pair, &rest, report, sizes, worst);
            let said = &report.reactions.contacts[index];
            // ties of curved sides share nodes behind them
            if self.scene.bumps == 0.0 || ties.len() == 1 {
                worst.add("reported tie", norm(sub(first[0], said.force)), first[2][0]);
                worst.add("reported tie", norm(sub(first[1], said.moment)), first[2][1]);
            }
        }
        let tags: Vec<FacetTag> = ties.iter().flat_map(|p| p.sides).collect();
        let mut nodes = self.tied_nodes(&tags);
        nodes.extend(self.scene.grips.iter().flat_map(|g| &g.nodes));
        let tied = |n: u32| nodes.contains(&n);
        let mut squares = vec![0.0; rest.len()];
        for (node, rest) in (0..).zip(&rest).filter(|r| !tied(r.0)) {
            squares[self.base.group[node as usize]] += dot(*rest, *rest);
        }
        for (group, square) in squares.iter().enumerate() {
            worst.add("equilibrium", square.sqrt(), sizes[group].forces);
        }
        rest
    }

    /// Nodes that ties of these sides may move: those on them, and where facets are apart those behind them.
    fn tied_nodes(&self, tags: &[FacetTag]) -> Vec<u32> {
        let mechanics = &self.base.mechanics;
        if self.scene.bumps > 0.0 {
            return mechanics.behind(tags);
        }
        let of = mechanics.sides.iter().filter(|s| tags.contains(&s.tag));
        let mut nodes: Vec<u32> = of.flat_map(|s| s.nodes.into_iter().chain(s.loaded)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Force and moment of a tie on its first side, and the sizes they are relative to. Sides that two ties share are
    /// judged together.
    fn tied(
        &self,
        index: usize,
        pair: &Pair,
        rest: &[Vec3],
        report: &Report<'_>,
        sizes: &[Size],
        worst: &mut Worst,
    ) -> [Vec3; 3] {
        let mechanics = &self.base.mechanics;
        let nodes = |tags: &[FacetTag]| self.tied_nodes(tags);
        let sum = |nodes: &[u32]| {
            let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
            for n in nodes {
                let f = rest[*n as usize];
                force = add(force, f);
                moment = add(moment, cross(mechanics.points[*n as usize], f));
            }
            (force, moment)
        };
        let size = self.base.size(sizes, nodes(&pair.sides)[0]);
        let far = mechanics
            .points
            .iter()
            .map(|x| norm(*x))
            .fold(self.base.extent, f64::max);
        // all sides that hang together by ties
        let mut tags = pair.sides.to_vec();
        let ties = self.scene.pairs.iter().filter(|p| p.tied);
        for other in ties.clone() {
            if self.scene.bumps > 0.0 || other.sides.iter().any(|t| pair.sides.contains(t)) {
                tags.extend(other.sides);
            }
        }
        let all = nodes(&tags);
        let (force, moment) = sum(&all);
        worst.add("force of ties", norm(force), size.forces);
        worst.add("moment of ties", norm(moment), far * size.forces);
        // but where one moves the other
        let moved = (pair.motion.as_ref()).map_or([0.0; 3], |(way, course)| scale(course.value(report.time), *way));
        let work: f64 = all.iter().map(|n| dot(rest[*n as usize], at(&report.u, *n))).sum();
        let work = work - dot(sum(&nodes(&pair.sides[..1])).0, moved);
        if ties.clone().count() == 1 || ties.clone().all(|p| p.motion.is_none()) {
            worst.add("work of ties", work.abs(), size.forces * size.displacement);
        }
        // the side that only this tie has
        let shared = |tag: FacetTag| ties.clone().filter(|p| p.sides.contains(&tag)).count() > 1;
        let (own, sign) = if shared(pair.sides[0]) { (1, -1.0) } else { (0, 1.0) };
        let (force, moment) = sum(&nodes(&pair.sides[own..=own]));
        let whole = [size.forces, far * size.forces, index as f64];
        [scale(sign, force), scale(sign, moment), whole]
    }

    /// Loads, supports and obstacles: forces between bodies cancel.
    fn balance(
        &self,
        points: &[ConstrainedPoint],
        report: &Report<'_>,
        load: &[f64],
        sizes: &[Size],
        worst: &mut Worst,
    ) {
        let places = &self.base.mechanics.points;
        let forces = sizes.iter().map(|s| s.forces.powi(2)).sum::<f64>().sqrt();
        let far = places.iter().map(|x| norm(*x)).fold(self.base.extent, f64::max);
        let mut sum = self.gripped(report);
        let mut put = |node: u32, force: Vec3| {
            sum[0] = add(sum[0], force);
            sum[1] = add(sum[1], cross(places[node as usize], force));
        };
        (0..places.len() as u32).for_each(|n| put(n, at(load, n)));
        for (point, state) in points.iter().zip(report.points).filter(|p| p.1.partner.is_none()) {
            point
                .nodes()
                .for_each(|(n, weight)| put(n, scale(weight, state.force())));
        }
        let supports = report.reactions.supports.iter().chain(&report.reactions.springs);
        supports.flat_map(|s| &s.nodes).for_each(|n| put(n.node, n.force));
        let said = report.reactions.imbalance();
        worst.add("balance", norm(sum[0]), forces);
        worst.add("reported imbalance", norm(said.force), forces);
        // friction across a distance between sides is a couple, and bumps leave one where few nodes make up for them
        let couple = |(point, state): (&ConstrainedPoint, &PointState)| {
            let pair = self.scene.pairs.get(point.surface());
            let most = pair.map_or(0.0, |pair| pair.apart() + self.scene.bumps);
            let at_node = |(n, force): (u32, Vec3)| cross(sub(places[n as usize], point.position()), force);
            let moment = point.forces(state.force()).map(at_node).fold([0.0; 3], add);
            norm(moment).min(most * norm(state.force()))
        };
        let couples: f64 = points.iter().zip(report.points).map(couple).sum();
        worst.add("balance", norm(sum[1]) - couples, far * forces);
        worst.add("reported imbalance", norm(said.moment) - couples, far * forces);
    }

    /// Forces of the foundation, but for nodes that a support holds.
    fn ground(&self, report: &Report<'_>, sizes: &[Size], worst: &mut Worst) {
        let Some((tag, stiffness)) = self.scene.ground else {
            return;
        };
        let held: Vec<u32> = (self.base.recipe.holds.iter())
            .flat_map(|h| h.nodes(&self.base.recipe.mesh))
            .collect();
        let mut expected: HashMap<u32, Vec3> = HashMap::new();
        for side in self.base.mechanics.sides.iter().filter(|s| s.tag == tag) {
            for node in side.loaded.into_iter().filter(|n| !held.contains(n)) {
                let u = at(&report.u, node);
                let own = expected.entry(node).or_default();
                let stress = stiffness.stress(unit(side.vector), u);
                *own = add(*own, scale(norm(side.vector) / 3.0, stress));
            }
        }
        let said = report.reactions.springs.iter().flat_map(|s| &s.nodes);
        for said in said.filter(|n| !held.contains(&n.node)) {
            let force = expected.remove(&said.node).unwrap_or_default();
            let size = self.base.size(sizes, said.node);
            worst.add("foundation", norm(sub(force, said.force)), size.forces);
        }
        for (node, force) in expected {
            worst.add("foundation", norm(force), self.base.size(sizes, node).forces);
        }
    }
}
