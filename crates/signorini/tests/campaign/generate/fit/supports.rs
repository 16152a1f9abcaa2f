//! Supports of fitted bodies: about the axis, along directions of each node, all, moved or turned.

use super::Bench;
use crate::generate::bodies::side;
use crate::recipe::{Course, Fixed, Hold, Where, around};
use crate::vec3::{Vec3, across, add, cross, norm, scale, sub};
use signorini::prelude::*;

impl Bench<'_> {
    /// Whether an obstacle or another body meets a side.
    fn is_met(&self, body: usize, tag: FacetTag) -> bool {
        let inner = tag == brick::X_MIN && body > 0;
        let outer = tag == brick::X_MAX && body + 1 < self.rings.len();
        inner || outer || self.rocks.iter().any(|r| r.side == side(body, tag))
    }

    pub(super) fn supports(&mut self) {
        for body in 0..self.rings.len() {
            let kind = self.dice.whole(0, 9);
            let likely = if body == 0 { 0.85 } else { 0.3 };
            if !self.dice.chance(likely) {
                self.say("loose");
                continue;
            }
            let solid = self.rings[body].solid();
            let mut tag = if self.dice.chance(0.5) { brick::Z_MAX } else { brick::Z_MIN };
            if self.is_met(body, tag) {
                tag = brick::Z_MAX;
            }
            let free: Vec<FacetTag> = [brick::X_MIN, brick::X_MAX]
                .into_iter()
                .filter(|t| !(self.is_met(body, *t) || solid && *t == brick::X_MIN))
                .collect();
            if let (true, false) = (self.dice.chance(0.35), free.is_empty()) {
                tag = free[self.dice.whole(0, free.len() - 1)];
            }
            let along = tag == brick::X_MIN || tag == brick::X_MAX;
            let place = Where::Tag(side(body, tag));
            let on = match self.dice.whole(0, 4) {
                0 => [true, false, true],
                1 => [false, true, true],
                2 => [true, true, false],
                3 => [true, false, false],
                _ => [true; 3],
            };
            let mut hold = Hold {
                place,
                fixed: Fixed::All,
                motion: None,
            };
            match kind {
                // on the axis there is no radial direction
                3..=6 if !solid || along => {
                    self.say("about the axis");
                    hold.fixed = Fixed::About(self.centre, self.axis, on);
                }
                7 | 8 => {
                    self.say("each node");
                    hold.fixed = Fixed::Each(self.normals(&hold, solid && !along));
                }
                _ => self.say("fixed"),
            }
            if self.dice.chance(0.4) {
                self.say("moved");
                hold.motion = Some(self.motion(&hold));
            }
            self.recipe.holds.push(hold);
        }
        self.tidy();
    }

    /// Radial directions, or axial ones, or two of them, by turns.
    fn normals(&mut self, hold: &Hold, axial: bool) -> Vec<Vec<Vec3>> {
        let points = self.recipe.mesh.points().to_vec();
        let nodes = hold.nodes(&self.recipe.mesh);
        let kind = self.dice.whole(0, 2);
        nodes
            .into_iter()
            .enumerate()
            .map(|(k, node)| {
                if axial {
                    return vec![self.axis];
                }
                let [radial, tangential, axis] = around(self.centre, self.axis, points[node as usize]);
                match kind {
                    0 => vec![radial],
                    1 => vec![add(radial, scale(0.3, axis)), tangential],
                    _ if k % 3 == 0 => vec![tangential],
                    _ if k % 3 == 1 => Vec::new(),
                    _ => vec![axis, radial],
                }
            })
            .collect()
    }

    /// A displacement of a support in its own directions, or of each node: a turn about the axis.
    fn motion(&mut self, hold: &Hold) -> (Vec<Vec3>, Course) {
        let course = self.frame.shaft.course(self.dice);
        let (centre, axis, way) = (self.centre, self.axis, self.frame.way);
        // about the axis what is not held must not be moved
        let held = |v: Vec3| match hold.fixed {
            Fixed::About(_, _, on) => [0, 1, 2].map(|c| if on[c] { v[c] } else { 0.0 }),
            _ => v,
        };
        if self.dice.chance(0.5) {
            let by = scale(0.5 * way, self.dice.vector());
            return (vec![held(by)], course);
        }
        let angle = self.frame.strain * self.dice.between(0.1, 2.0);
        let rise = way * self.dice.either();
        let mesh = &self.recipe.mesh;
        let values = hold.nodes(mesh).into_iter().map(|n| {
            let arm = across(sub(mesh.points()[n as usize], centre), axis);
            match hold.fixed {
                Fixed::About(..) => held([0.2 * rise, angle * norm(arm), rise]),
                _ => add(scale(angle, cross(axis, arm)), scale(rise, axis)),
            }
        });
        (values.collect(), course)
    }

    /// Supports leave out the nodes of sides that are met: forces there have no room.
    fn tidy(&mut self) {
        let mesh = &self.recipe.mesh;
        let mut met: Vec<u32> = self.rocks.iter().flat_map(|r| mesh.nodes_on(r.side)).collect();
        for body in 1..self.rings.len() {
            for tag in [side(body, brick::X_MIN), side(body - 1, brick::X_MAX)] {
                met.extend(mesh.nodes_on(tag));
            }
        }
        let mids = |facets: &[Facet]| -> Vec<u32> {
            let sides: Vec<FacetTag> = self.rocks.iter().map(|r| r.side).collect();
            let is_met = |t: FacetTag| {
                sides.contains(&t)
                    || (1..self.rings.len()).any(|b| t == side(b, brick::X_MIN) || t == side(b - 1, brick::X_MAX))
            };
            let own = facets.iter().enumerate().filter(|(_, f)| is_met(f.tag));
            own.filter_map(|(k, _)| mesh.facet_mids(k)).flatten().collect()
        };
        if mesh.order() == 2 {
            met.extend(mids(mesh.facets()));
        }
        let mut holds = std::mem::take(&mut self.recipe.holds);
        for hold in &mut holds {
            let nodes = hold.nodes(&self.recipe.mesh);
            let kept: Vec<usize> = (0..nodes.len()).filter(|k| !met.contains(&nodes[*k])).collect();
            if kept.len() == nodes.len() || kept.is_empty() {
                continue;
            }
            hold.place = Where::Nodes(kept.iter().map(|k| nodes[*k]).collect());
            if let Fixed::Each(lists) = &mut hold.fixed {
                *lists = kept.iter().map(|k| lists[*k].clone()).collect();
            }
            if let Some((values, _)) = hold.motion.as_mut().filter(|m| m.0.len() > 1) {
                *values = kept.iter().map(|k| values[*k]).collect();
            }
        }
        self.recipe.holds = holds;
    }
}
