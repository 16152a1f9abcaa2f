//! A state carried over to another stage of its scene: rows and points that stay keep what they have; new points stick
//! where they are.

use super::state::{Peak, State};
use crate::error::ContactError;
use crate::hash::hash;
use crate::model::{ConstrainedPoint, Model, PointRow};
use crate::vec3::dot;
use signorini_tfeti::Gluing;
use std::collections::HashMap;

impl State {
    /// From the rows and points of one model to those of another.
    pub(crate) fn carry_over(&mut self, old: &Model, new: &Model) -> Result<(), ContactError> {
        let rows = same_rows(old.tfeti.gluing(), new.tfeti.gluing());
        let vectors = self.lambda.iter_mut().chain(&mut self.f_lambda);
        for vector in vectors.filter(|v| !v.is_empty()) {
            *vector = carried(&rows, vector, 0.0);
        }
        let points = same_points(old, new);
        if !self.sliding.is_empty() {
            self.sliding = carried(&points, &self.sliding, false);
        }
        if !self.rate.is_empty() {
            self.rate = carried(&points, &self.rate, 0.0);
        }
        if self.step() > 0 && new.plan.effects.history {
            self.carry_traces(old, new, &points)?;
        }
        let mut peaks = vec![Peak::default(); new.bodies.count().max(1)];
        for subdomain in (0..new.tfeti.subdomains()).filter(|_| !self.peaks.is_empty()) {
            let before = self.peaks.get(old.bodies.of_subdomain(subdomain));
            let peak = &mut peaks[new.bodies.of_subdomain(subdomain)];
            *peak = peak.or(before.copied().unwrap_or_default());
        }
        self.peaks = peaks;
        Ok(())
    }

    /// Points that stay keep where they stick; new ones stick where they are.
    fn carry_traces(&mut self, old: &Model, new: &Model, points: &[Option<usize>]) -> Result<(), ContactError> {
        let starts = [old, new].map(|model| model.tangential_rows().start);
        let mut traces = [(); 2].map(|()| vec![0.0; new.tangential_rows().len()]);
        for (point, before) in new.points.iter().zip(points) {
            let before: Vec<PointRow> = before.iter().flat_map(|k| old.points[*k].along()).collect();
            let same = before
                .iter()
                .map(|b| b.direction)
                .eq(point.along().map(|own| own.direction));
            for (k, PointRow { direction, row, .. }) in point.along().enumerate() {
                let own = if same {
                    self.traces(before[k].row - starts[0]).into()
                } else {
                    // where it is, less what it had given way elastically along the directions that it had
                    let mut own = [self.way(new, point, direction)?; 2];
                    for PointRow {
                        direction: known, row, ..
                    } in &before
                    {
                        let (way, (last, older)) = (self.way(new, point, *known)?, self.traces(row - starts[0]));
                        let along = dot(&direction, known);
                        own = [own[0] - along * (way - last), own[1] - along * (way - older)];
                    }
                    own
                };
                (0..2).for_each(|k| traces[k][row - starts[1]] = own[k]);
            }
        }
        self.trace = traces;
        Ok(())
    }

    /// Displacements of so many nodes at the last step, m.
    pub(crate) fn places(&self, nodes: usize) -> Result<&[[f64; 3]], ContactError> {
        let places: &[[f64; 3]] = self.displacement.as_chunks().0;
        if places.len() == nodes {
            return Ok(places);
        }
        let reason =
            "it does not say where the nodes were when a support or a contact starts or ends; continue from a \
            state of a scene in which it does"
                .to_owned();
        Err(ContactError::Checkpoint { reason })
    }

    /// Displacement of a point along a direction at the last step, relative to its obstacle or partner, m.
    fn way(&self, model: &Model, point: &ConstrainedPoint, direction: [f64; 3]) -> Result<f64, ContactError> {
        let nodes = self.places(model.scene.mesh.points().len())?;
        let along = |node: u32, direction: &[f64; 3]| dot(&nodes[node as usize], direction);
        let poses = &model.discrete.poses[point.surface()];
        let pose = self.step().checked_sub(1).and_then(|last| poses.get(last));
        let carried = pose.map_or(0.0, |pose| dot(&pose.drag(&point.contact.centre), &direction));
        Ok(point.contact.sides.way(&direction, along) - carried)
    }
}

/// What is carried over of a list; what is new has this value.
fn carried<T: Copy>(from: &[Option<usize>], list: &[T], new: T) -> Vec<T> {
    from.iter()
        .map(|k| k.and_then(|k| list.get(k)).copied().unwrap_or(new))
        .collect()
}

/// For each row of one gluing the row of another that is the same; of equal ones the first stands for the first.
fn same_rows(old: &Gluing, new: &Gluing) -> Vec<Option<usize>> {
    let mut rows = vec![None; new.ranges().total()];
    let [old, new] = [old, new].map(hashed_rows);
    let mut known = old.into_iter().peekable();
    for (hash, row) in new {
        while known.next_if(|other| other.0 < hash).is_some() {}
        rows[row] = known.next_if(|other| other.0 == hash).map(|other| other.1);
    }
    rows
}

/// What each row says, in a number, with the row; ascending.
fn hashed_rows(gluing: &Gluing) -> Vec<(u64, usize)> {
    let ranges = gluing.ranges();
    let kinds = [
        &ranges.normal,
        &ranges.discs,
        &ranges.intervals,
        &ranges.interface,
        &ranges.tied,
        &ranges.equations,
        &ranges.rigid,
        &ranges.dirichlet,
    ];
    let hashed = |(kind, row): (u64, usize)| {
        let entries = gluing.row(row).into_iter();
        let entries = entries.flat_map(|(subdomain, dof, c)| [subdomain as u64, dof as u64, c.to_bits()]);
        (hash(std::iter::once(kind).chain(entries)), row)
    };
    let rows = (0..).zip(kinds);
    let rows = rows.flat_map(|(kind, rows)| rows.clone().map(move |row| (kind, row)));
    let mut hashed: Vec<(u64, usize)> = rows.map(hashed).collect();
    hashed.sort_unstable();
    hashed
}

/// For each point of one model the point of another with the same sides and normal that stood for one of its
/// conditions: which of the contacts of a seam has the point depends on which of them act.
fn same_points(old: &Model, new: &Model) -> Vec<Option<usize>> {
    let standing = |model: &'_ Model| {
        let all = model.discrete.conditions.iter().zip(&model.standing);
        let known = all.filter_map(|(condition, point)| Some(((condition.surface, condition.node()), (*point)?)));
        known.collect::<Vec<_>>()
    };
    let mut known: HashMap<(usize, u32), Vec<usize>> = HashMap::new();
    for (condition, point) in standing(old) {
        known.entry(condition).or_default().push(point);
    }
    let mut out = vec![None; new.points.len()];
    for (condition, point) in standing(new) {
        let own = &new.points[point];
        let same = |k: &&usize| {
            let other = &old.points[**k];
            other.contact.sides == own.contact.sides && other.frame().normal == own.frame().normal
        };
        let before = known.get(&condition).into_iter().flatten().find(same);
        out[point] = out[point].or(before.copied());
    }
    out
}
