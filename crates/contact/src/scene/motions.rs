//! How the obstacles of contacts move, and gaps with them.

use super::contact::Contact;
use super::pose::{Pose, Rotation};
use signorini_fem_mesh::vec3::{add, scale};

impl Contact {
    /// Whether the obstacle moves or turns.
    pub(crate) fn moves(&self) -> bool {
        !self.motions.is_empty() || self.rotation.is_some()
    }

    /// How far the obstacle is displaced at a time, m; of tied sides the first one against the other.
    pub(crate) fn shift(&self, time: f64) -> [f64; 3] {
        let ways = self
            .motions
            .iter()
            .map(|(way, history)| scale(history.value(time), *way));
        ways.reduce(add).unwrap_or_default()
    }

    /// Where the obstacle is at some times, and what has become of the gap; none if it rests and the gap stays.
    pub(crate) fn poses(&self, times: &[f64]) -> Vec<Pose> {
        let all = times.iter().copied();
        let mut poses: Vec<Pose> = match &self.rotation {
            Some(rotation) => {
                let mut way = self.kinks(rotation, times);
                way.extend(all);
                way.sort_by(f64::total_cmp);
                way.dedup();
                let poses = Pose::turning(rotation, way.iter().map(|&t| (self.shift(t), rotation.angle.value(t))));
                let reached = |time: &f64| times.binary_search_by(|t| t.total_cmp(time)).is_ok();
                let reached = way.iter().zip(poses).filter(|(time, _)| reached(time));
                reached.map(|(_, pose)| pose).collect()
            }
            None if self.moves() => all.map(|t| Pose::shifted(self.shift(t))).collect(),
            None if self.gap_history.is_some() => vec![Pose::default(); times.len()],
            None => Vec::new(),
        };
        if let Some(history) = &self.gap_history {
            let with_times = poses.iter_mut().zip(times);
            with_times.for_each(|(pose, time)| pose.factor = history.value(*time));
        }
        poses
    }

    /// Those of its [poses](Self::poses) at some times at which it acts, with these.
    pub(crate) fn acting<'a>(&self, poses: &'a [Pose], times: &'a [f64]) -> impl Iterator<Item = (&'a Pose, f64)> {
        let span = self.span;
        let all = poses.iter().zip(times.iter().copied());
        all.filter(move |(_, time)| span.has(*time))
    }

    /// Times up to the last one at which an obstacle that is displaced and turns changes its way: points of its tables.
    fn kinks(&self, rotation: &Rotation, times: &[f64]) -> Vec<f64> {
        let Some(&last) = times.last().filter(|_| !self.motions.is_empty()) else {
            return Vec::new();
        };
        let courses = self.motions.iter().flat_map(|(_, course)| course.points());
        let points = courses.chain(rotation.angle.points());
        points.map(|p| p.0).filter(|t| (0.0..last).contains(t)).collect()
    }

    /// The same before the first step.
    pub(crate) fn pose_at_rest(&self) -> Pose {
        let mut pose = Pose::default();
        pose.factor = self.gap_history.as_ref().map_or(1.0, |h| h.value(0.0));
        pose
    }
}
