//! The conditions at contact points: gap, sign, complementarity, cone, direction of friction, and what is reported of
//! them.

use super::{Judge, ROUNDED, Report, SAME, Size, Worst};
use crate::recipe::{Clock, Recipe, Touch};
use crate::spots::Spot;
use crate::vec3::{Vec3, across, add, at, dot, norm, scale, sub, unit};
use signorini::prelude::*;

impl Judge<'_> {
    /// Where the spots are now and how they have slid.
    pub(super) fn slips(&self, report: &Report<'_>) -> Vec<Slip> {
        let [a, b, c] = match self.recipe.clock {
            Clock::Static(_) => [1.0, 0.0, 0.0],
            Clock::Steps { weights, .. } => weights,
        };
        let slip = |(k, spot): (usize, &Spot)| {
            let touch = &self.recipe.touches[spot.contact];
            let mut way = sub(at(&report.u, spot.node), touch.carried(report.time));
            if let Some(partner) = spot.partner.filter(|p| *p != u32::MAX) {
                way = sub(way, at(&report.u, partner));
            }
            let sum = add(scale(a, way), add(scale(b, self.ways[0][k]), scale(c, self.ways[1][k])));
            Slip {
                way,
                gap: spot.gap - dot(spot.normal, way),
                slip: across(sum, spot.normal),
            }
        };
        self.spots.iter().enumerate().map(slip).collect()
    }

    /// The spot of each reported point.
    pub(super) fn assign(&self, points: &[PointState]) -> Vec<Option<usize>> {
        let same = |p: &PointState, s: &Spot| {
            s.contact == p.surface && s.node == p.node && s.partner == p.partner && dot(s.normal, p.normal) > SAME
        };
        let of = |p: &PointState| self.spots.iter().position(|s| same(p, s));
        points.iter().map(of).collect()
    }

    /// Whether two spots are one point that the nearer obstacle makes: the first of those as near.
    fn gives_way(&self, spot: &Spot) -> bool {
        self.spots.iter().any(|s| {
            let same = s.node == spot.node && s.partner == spot.partner;
            let nearer = s.gap < spot.gap - self.rounding(spot);
            let first = s.contact < spot.contact && self.as_near(s, spot);
            same && dot(s.normal, spot.normal) > SAME && (nearer || first)
        })
    }

    /// What of a gap may be rounding.
    fn rounding(&self, spot: &Spot) -> f64 {
        1e-12 * (self.extent + norm(self.mechanics.points[spot.node as usize]))
    }

    fn as_near(&self, a: &Spot, b: &Spot) -> bool {
        (a.gap - b.gap).abs() <= self.rounding(a)
    }

    /// Area that a reported point stands for: surfaces that meet a node along one direction are one point, of the
    /// nearer obstacle, or of both if they are as near.
    fn area(&self, points: &[PointState], spot: &Spot) -> f64 {
        let own = |node: u32, partner: Option<u32>, normal: Vec3| {
            node == spot.node && partner == spot.partner && dot(normal, spot.normal) > SAME
        };
        let reported = points.iter().filter(|p| own(p.node, p.partner, p.normal));
        if reported.count() > 1 {
            return spot.area;
        }
        let all = self
            .spots
            .iter()
            .filter(|s| own(s.node, s.partner, s.normal) && self.as_near(s, spot));
        let tags = |s: &Spot| &self.recipe.touches[s.contact].tags;
        let mut known: Vec<&Spot> = Vec::new();
        for s in all {
            if !known.iter().any(|k| tags(k).iter().any(|t| tags(s).contains(t))) {
                known.push(s);
            }
        }
        known.iter().map(|s| s.area).sum()
    }

    pub(super) fn contact(
        &self,
        report: &Report<'_>,
        of: &[Option<usize>],
        slips: &[Slip],
        sizes: &[Size],
        worst: &mut Worst,
    ) {
        for (spot, slip) in self.spots.iter().zip(slips) {
            worst.add("gap", -slip.gap, self.size(sizes, spot.node).displacement);
        }
        for (point, spot) in report.points.iter().zip(of) {
            let Some(k) = *spot else {
                worst.add("a point that no contact of the scene has", 1.0, 1.0);
                continue;
            };
            let (spot, slip) = (&self.spots[k], &slips[k]);
            let farther = self.gives_way(spot);
            worst.add("surface of the point", f64::from(u8::from(farther)), 1.0);
            let size = self.size(sizes, spot.node);
            let (f, u) = (size.contact, size.displacement);
            let (force, friction) = (point.normal_force, point.friction_force);
            worst.add("sign", force, f);
            worst.add("complementarity", (force * slip.gap.max(0.0)).abs(), f * u);
            worst.add("friction off the surface", dot(friction, spot.normal).abs(), f);
            let law = &self.recipe.touches[spot.contact].law;
            let area = self.area(report.points, spot);
            let x = self.mechanics.points[spot.node as usize];
            let bound = law.bound(x, area, (-force).max(0.0), self.rates[k]);
            worst.add("cone", norm(friction) - bound, f);
            // a node held by a support along its normal has neither
            if law.is_some() && force != 0.0 {
                let off = add(scale(bound, slip.slip), scale(norm(slip.slip), friction));
                worst.add("direction", norm(off), f.max(bound) * u);
                let none = self.stuck[k] && point.slip_bound == 0.0;
                let said = if none { bound } else { point.slip_bound };
                worst.add("reported bound", (said - bound).abs(), f.max(bound));
            }
            self.reported(point, spot, slip, size, worst);
            worst.add("reported area", (point.area - area).abs(), 1e4 * area);
        }
    }

    /// What is reported of a point is what follows from the displacement.
    fn reported(&self, point: &PointState, spot: &Spot, slip: &Slip, size: &Size, worst: &mut Worst) {
        // where nothing moves, coordinates are the scale
        let u = size.displacement.max(ROUNDED * self.extent);
        worst.add("reported gap", (point.gap - slip.gap).abs(), u.max(spot.gap.abs()));
        let open = point.state == ContactState::Open;
        let wrong = open != (point.normal_force >= 0.0);
        worst.add("reported state", f64::from(u8::from(wrong)), 1.0);
        if self.recipe.touches[spot.contact].law.is_some() && point.slip_bound > 0.0 {
            let off = norm(sub(point.difference, slip.slip));
            worst.add("reported slip", off, u);
        }
    }

    /// The sums of the frame.
    pub(super) fn sums(&self, frame: &StepResult, of: &[Option<usize>], sizes: &[Size], worst: &mut Worst) {
        let said = frame.summary();
        let contact = sizes.iter().map(|s| s.contact).sum::<f64>();
        let (mut active, mut pressed, mut sum, mut work, mut way) = (0, 0.0, [0.0; 3], 0.0, 0.0);
        for (point, spot) in frame.points().iter().zip(of) {
            active += usize::from(point.normal_force < 0.0);
            pressed -= point.normal_force;
            sum = add(sum, point.force());
            let Some(k) = spot else { continue };
            let touch = &self.recipe.touches[self.spots[*k].contact];
            let (now, before) = (touch.carried(frame.time()), self.carried_before(touch));
            work += dot(point.force(), sub(now, before));
            way += norm(point.force()) * (norm(now) + norm(before));
        }
        let size = pressed.abs().max(contact);
        worst.add("summary", f64::from(u8::from(active != said.active)), 1.0);
        worst.add("summary", (pressed - said.normal_force).abs(), size);
        worst.add("summary", norm(sub(sum, said.resultant)), size);
        worst.add(
            "obstacle work",
            (work - said.obstacle_work).abs(),
            way.max(f64::MIN_POSITIVE),
        );
    }

    fn carried_before(&self, touch: &Touch) -> Vec3 {
        if self.before == 0.0 { [0.0; 3] } else { touch.carried(self.before) }
    }
}

/// Whether supports fix all directions along the surface, at the node and its partner.
pub(super) fn stuck(recipe: &Recipe, spots: &[Spot], nodes: usize) -> Vec<bool> {
    let mut held: Vec<Vec<Vec3>> = vec![Vec::new(); nodes];
    for hold in &recipe.holds {
        for (place, node) in hold.nodes(&recipe.mesh).into_iter().enumerate() {
            for v in hold.fixed.vectors(place, recipe.mesh.points()[node as usize]) {
                let held = &mut held[node as usize];
                let rest = held.iter().fold(unit(v), |d, e| across(d, *e));
                if norm(rest) > 1e-6 {
                    held.push(unit(rest));
                }
            }
        }
    }
    let fixes = |node: u32, normal: Vec3| {
        // what is left of space without normal and held directions
        let mut basis = vec![normal];
        for d in &held[node as usize] {
            let rest = basis.iter().fold(*d, |d, e| across(d, *e));
            if norm(rest) > 1e-6 {
                basis.push(unit(rest));
            }
        }
        basis.len() == 3
    };
    let both = |s: &Spot| {
        let partner = s.partner.filter(|p| *p != u32::MAX);
        fixes(s.node, s.normal) && partner.is_none_or(|p| fixes(p, s.normal))
    };
    spots.iter().map(both).collect()
}

/// A spot at a level.
pub(super) struct Slip {
    /// Displacement relative to the obstacle or the partner.
    pub(super) way: Vec3,
    gap: f64,
    /// The tangential difference.
    pub(super) slip: Vec3,
}
