//! The check of rigid couplings.
//!
//! | condition | relative to |
//! |---|---|
//! | nodes move as a rigid body, that which is reported, and what is held as it is told | displacement |
//! | what is left at the nodes is load and reported reaction, in force and moment; no reaction where nothing is held | forces; times distance |

use super::apart::ApartJudge;
use super::{Report, SMALL_PART, Size, Worst};
use crate::vec3::{Vec3, add, at, cross, norm, sub};
use signorini::prelude::*;

impl ApartJudge<'_> {
    /// `rest` is what couplings and ties do at the nodes.
    pub(super) fn grips(
        &self,
        frame: &StepResult,
        rest: &[Vec3],
        report: &Report<'_>,
        sizes: &[Size],
        worst: &mut Worst,
    ) {
        let points = &self.base.mechanics.points;
        let both = frame.couplings().into_iter().zip(&report.reactions.couplings);
        worst.add(
            "couplings",
            (both.len() as f64 - self.scene.grips.len() as f64).abs(),
            1.0,
        );
        for (grip, (found, reaction)) in self.scene.grips.iter().zip(both) {
            let size = self.base.size(sizes, grip.nodes[0]);
            let (far, [force, moment]) = (grip.far(points), grip.applied(report.time));
            let forces = size.forces;
            let motion = [found.displacement, found.rotation];
            let mut sums = [[0.0; 3]; 2];
            for &node in &grip.nodes {
                let x = points[node as usize];
                let off = sub(at(&report.u, node), grip.moved(motion, x));
                worst.add("coupled nodes", norm(off), size.displacement);
                sums[0] = add(sums[0], rest[node as usize]);
                sums[1] = add(sums[1], cross(sub(x, grip.reference), rest[node as usize]));
            }
            let about = cross(sub(report.reactions.point, grip.reference), reaction.force);
            let held = [reaction.force, add(reaction.moment, about)];
            let told = grip.told(report.time);
            for c in 0..6 {
                let (which, axis) = (c / 3, c % 3);
                let length = if which == 0 { 1.0 } else { far };
                if grip.held[c] {
                    let off = (motion[which][axis] - told[c]).abs() * length;
                    worst.add("held coupling", off, size.displacement);
                } else {
                    worst.add("reaction of a free coupling", held[which][axis].abs(), length * forces);
                }
            }
            worst.add("force of a coupling", norm(sub(sums[0], add(force, held[0]))), forces);
            worst.add(
                "moment of a coupling",
                norm(sub(sums[1], add(moment, held[1]))),
                far * forces,
            );
        }
    }

    /// Loads on couplings count as those on nodes do.
    pub(super) fn add_grips(&self, time: f64, sizes: &mut [Size]) {
        let mechanics = &self.base.mechanics;
        for grip in &self.scene.grips {
            let [force, moment] = grip.applied(time);
            let force = norm(force).max(norm(moment) / grip.far(&mechanics.points));
            let stiffness = grip.nodes.iter().map(|n| mechanics.stiffness[*n as usize]);
            let size = &mut sizes[self.base.group[grip.nodes[0] as usize]];
            size.displacement = size.displacement.max(force / stiffness.fold(f64::INFINITY, f64::min));
            size.forces = size.forces.max(force);
            size.contact = size.contact.max(SMALL_PART * size.forces);
        }
    }

    /// Force and moment about the origin of loads on couplings and of what holds them.
    pub(super) fn gripped(&self, report: &Report<'_>) -> [Vec3; 2] {
        let point = report.reactions.point;
        let mut sum = [[0.0; 3]; 2];
        for (grip, held) in self.scene.grips.iter().zip(&report.reactions.couplings) {
            let [force, moment] = grip.applied(report.time);
            sum[0] = add(sum[0], add(force, held.force));
            sum[1] = add(sum[1], add(moment, cross(grip.reference, force)));
            sum[1] = add(sum[1], add(held.moment, cross(point, held.force)));
        }
        sum
    }
}
