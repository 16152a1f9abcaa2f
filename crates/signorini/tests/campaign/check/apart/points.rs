//! Contact points of bodies meshed apart: what they are made of, and the conditions at them.

use super::{ApartJudge, At};
use crate::apart::{Pair, Rest};
use crate::check::{Report, SAME, Size, Worst};
use crate::recipe::{Clock, Law};
use crate::vec3::{Vec3, across, add, at, cross, dot, norm, scale, sub, unit};
use signorini::contact::ConstrainedPoint;
use signorini::prelude::*;
use std::collections::HashMap;

impl ApartJudge<'_> {
    /// Whether a node is on the side of a pair that a point's own node is not on.
    fn is_opposite(&self, point: &ConstrainedPoint, node: u32) -> bool {
        self.sides.get(point.surface()).is_some_and(|[first, second]| {
            let opposite = if first.contains(&point.node()) { second } else { first };
            opposite.contains(&node)
        })
    }

    /// Weights and areas.
    pub(super) fn weights(&self, points: &[ConstrainedPoint], worst: &mut Worst) {
        let places = &self.base.mechanics.points;
        let mut areas = vec![0.0; self.scene.pairs.len()];
        for point in points {
            let (mut own, mut other, mut arm) = (0.0, 0.0, [0.0; 3]);
            for (node, weight) in point.nodes() {
                let opposite = self.is_opposite(point, node);
                *(if opposite { &mut other } else { &mut own }) += weight;
                arm = add(arm, scale(weight, sub(places[node as usize], point.position())));
            }
            worst.add("weights", (own - 1.0).abs(), 1e-6);
            let Some(area) = areas.get_mut(point.surface()) else {
                continue;
            };
            *area += point.area();
            worst.add("weights", (other + 1.0).abs(), 1e-6);
            // of a node that is covered by little only, weights are rounding over that part
            let apart = self.scene.pairs[point.surface()].apart();
            let off = (norm(arm) - self.scene.bumps - apart).max(0.0);
            worst.add("moment of weights", off, 1e-5 * self.base.extent);
        }
        for (index, pair) in self.scene.pairs.iter().enumerate().filter(|p| !p.1.tied) {
            let area = areas[index];
            // where supports take points away there is more at their neighbours
            if pair.whole && self.scene.bumps == 0.0 && area > (1.0 - 1e-9) * pair.common {
                self.uniform(index, pair, points, worst);
            }
            let steep = 1.0 + (4.0 * self.scene.bumps / pair.common.sqrt()).powi(2);
            worst.add("area", area - pair.common * steep, 1e-4 * pair.common);
        }
    }

    /// What uniform pressure is at nodes of both sides, m²: their areas, outward on the side with the points.
    fn uniform(&self, index: usize, pair: &Pair, points: &[ConstrainedPoint], worst: &mut Worst) {
        let mut rest: HashMap<u32, f64> = HashMap::new();
        for point in points.iter().filter(|p| p.surface() == index) {
            for (node, weight) in point.nodes() {
                *rest.entry(node).or_default() += weight * point.area();
            }
        }
        let first = points.iter().find(|p| p.surface() == index);
        for side in self.base.mechanics.sides.iter().filter(|s| pair.sides.contains(&s.tag)) {
            for node in side.loaded {
                let opposite = first.is_some_and(|p| self.is_opposite(p, node));
                let sign = if opposite { 1.0 } else { -1.0 };
                *rest.entry(node).or_default() += sign * norm(side.vector) / 3.0;
            }
        }
        for off in rest.into_values() {
            worst.add("uniform pressure", off.abs(), 1e-4 * pair.common);
        }
    }

    pub(super) fn at(&self, k: usize, point: &ConstrainedPoint, report: &Report<'_>) -> At {
        let [a, b, c] = match self.base.recipe.clock {
            Clock::Static(_) => [1.0, 0.0, 0.0],
            Clock::Steps { weights, .. } => weights,
        };
        let state = &report.points[k];
        let moved = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            .map(|axis| point.forces(axis).map(|(n, force)| dot(force, at(&report.u, n))).sum());
        let normal = point.frame().normal;
        let (way, gap) = match self.rock(point) {
            Some(rock) => {
                let mut carried =
                    (rock.motion.as_ref()).map_or([0.0; 3], |(v, course)| scale(course.value(report.time), *v));
                let places = &self.base.mechanics.points;
                let (shifted, place) = (carried, self.mean(point));
                if let Some((centre, axis, course)) = &rock.turn {
                    // past a place that stays, about a centre that has been on the way there
                    let arm = sub(place, add(*centre, scale(0.5, shifted)));
                    carried = add(carried, scale(course.value(report.time), cross(*axis, arm)));
                }
                let mut opened = [0.0; 3];
                // a quadratic point has the mean of the gaps at its nodes
                let gaps = point.nodes().map(|(node, weight)| {
                    let first = places[node as usize];
                    let mut place = sub(first, shifted);
                    if let Some((centre, axis, course)) = &rock.turn {
                        let (arm, angle) = (sub(place, *centre), course.value(report.time));
                        let along = scale(dot(arm, *axis), *axis);
                        let (sin, cos) = angle.sin_cos();
                        // the place is turned back, and dragged along the surface
                        let off = sub(arm, along);
                        let back = add(scale(cos, off), scale(-sin, cross(*axis, off)));
                        place = add(*centre, add(along, back));
                    }
                    opened = add(opened, scale(weight, sub(first, place)));
                    weight * rock.shape.distance(place).0
                });
                let mut gap = gaps.sum::<f64>();
                if let Some(course) = &rock.growth {
                    // what motions open does not grow
                    let opened = dot(opened, normal);
                    gap = course.value(report.time) * (gap - opened) + opened;
                }
                (sub(moved, carried), gap - dot(normal, moved))
            }
            None => {
                let pair = &self.scene.pairs[point.surface()];
                let rest = match pair.rest {
                    Rest::Given(gap) => gap,
                    Rest::Measured(gap) if self.scene.bumps == 0.0 => gap,
                    Rest::Measured(_) => point.gap(),
                };
                let factor = pair.growth.as_ref().map_or(1.0, |course| course.value(report.time));
                (moved, factor * rest - dot(normal, moved))
            }
        };
        // the place where it sticks
        let along = self.compliance(point)[1] / point.area();
        let way = add(way, scale(along, state.friction_force));
        let sum = add(scale(a, way), add(scale(b, self.ways[0][k]), scale(c, self.ways[1][k])));
        At {
            way,
            gap,
            slip: across(sum, normal),
        }
    }

    /// Where the force of a point acts that one body has.
    fn mean(&self, point: &ConstrainedPoint) -> Vec3 {
        let places = &self.base.mechanics.points;
        (point.nodes()).fold([0.0; 3], |s, (n, w)| add(s, scale(w, places[n as usize])))
    }

    fn compliance(&self, point: &ConstrainedPoint) -> [f64; 2] {
        match (self.rock(point), self.scene.pairs.get(point.surface())) {
            (Some(rock), _) => rock.compliance,
            (_, Some(pair)) => pair.compliance,
            _ => [0.0; 2],
        }
    }

    pub(super) fn point(
        &self,
        (k, point): (usize, &ConstrainedPoint),
        state: &PointState,
        now: &At,
        size: &Size,
        worst: &mut Worst,
    ) {
        // where nothing moves, coordinates are the scale
        let (f, u) = (size.contact, size.displacement.max(1e-11 * self.base.extent));
        let normal = point.frame().normal;
        let least = if self.scene.bumps > 0.0 { 0.7 } else { SAME };
        let expected = match self.rock(point) {
            Some(rock) => scale(-1.0, rock.shape.distance(self.mean(point)).1),
            None => {
                let own = |s: &&crate::mechanics::Side| {
                    s.nodes.contains(&point.node()) && dot(unit(s.vector), normal) > least
                };
                self.base
                    .mechanics
                    .sides
                    .iter()
                    .find(own)
                    .map_or([0.0; 3], |s| unit(s.vector))
            }
        };
        let least = if self.rock(point).is_some() { SAME } else { least };
        worst.add("normal", f64::from(u8::from(dot(expected, normal) < least)), 1.0);
        let (force, friction) = (state.normal_force, state.friction_force);
        if self.rock(point).is_none() {
            worst.add(
                "gap at the start",
                match self.scene.pairs[point.surface()].rest {
                    Rest::Given(gap) => (point.gap() - gap).abs(),
                    Rest::Measured(gap) => ((point.gap() - gap).abs() - self.scene.bumps).max(0.0),
                },
                1e-6 * self.base.extent,
            );
        }
        worst.add("reported gap", (state.gap - now.gap).abs(), u.max(point.gap().abs()));
        let let_in = self.compliance(point)[0] * -force / point.area();
        let gap = now.gap + let_in;
        worst.add("gap", -gap, u);
        worst.add("sign", force, f);
        worst.add("complementarity", (force * gap.max(0.0)).abs(), f * u);
        worst.add("friction off the surface", dot(friction, normal).abs(), f);
        let (law, axis) = self.law(point);
        let bound = law.bound(point.position(), point.area(), (-force).max(0.0), self.rates[k]);
        // lengths in which the ellipse is a disc
        let (along, ratio) = axis.map_or((point.frame().tangents[0], 1.0), |(a, r)| (unit(across(a, normal)), r));
        let other = cross(normal, along);
        let g = [dot(friction, along), dot(friction, other) / ratio];
        let s = [dot(now.slip, along), dot(now.slip, other) * ratio];
        let (push, slide) = (g[0].hypot(g[1]), s[0].hypot(s[1]));
        if !self.known.rates && matches!(law, Law::Exponential { .. } | Law::Table(_) | Law::RateField(..)) {
            return;
        }
        let recipe = &self.base.recipe;
        let held = || {
            recipe
                .holds
                .iter()
                .any(|h| h.nodes(&recipe.mesh).contains(&point.node()))
        };
        let excess = match axis.is_some() && push > bound && held() {
            // what the ellipse has across the way of the node is a support's, which stops it there
            true => {
                let way = unit(friction);
                norm(friction) - bound * dot(way, along).hypot(ratio * dot(way, other))
            }
            false => push - bound,
        };
        worst.add("cone", excess, f);
        let stuck = law.is_some() && state.slip_bound == 0.0;
        if law.is_some() && force != 0.0 && !stuck {
            let off = [0, 1].map(|c| bound * s[c] + slide * g[c]);
            worst.add("reported bound", (state.slip_bound - bound).abs(), f.max(bound));
            if !self.known.slips {
                return;
            }
            worst.add("direction", off[0].hypot(off[1]), f.max(bound) * u * ratio.max(1.0));
            worst.add("reported slip", norm(sub(state.difference, now.slip)), u);
        }
    }
}
