//! `*DLOAD` in the volume of elements: gravity, forces per volume, centrifugal forces.

use std::collections::{BTreeMap, HashMap};

use signorini_fem_mesh::LoadDensity;
use signorini_fem_mesh::vec3::{Vec3, dot, norm, scale, sub, unit};

use super::history::{Histories, Track, Tracks};
use super::known::Known;
use super::materials::sections;
use crate::error::{DeckError, Word};
use crate::model::{Given, Target, VolumeLaw};
use crate::tolerances::TURNED;

/// A point of an axis, and its direction, of length 1; of gravity the origin.
type Axis = [Vec3; 2];

/// What acts in elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Force,
    /// Along an axis, by its position.
    Gravity(usize),
    /// About an axis.
    Centrifugal(usize),
}

/// Loads of the volume by elements, what they are, and the component.
pub(super) struct Volume {
    /// The largest distance of a node from the origin.
    reach: f64,
    tracks: Tracks<(Target, Kind, usize)>,
    axes: Vec<Axis>,
    /// Gravity and centrifugal forces that stand.
    standing: [BTreeMap<Target, usize>; 2],
}

impl Volume {
    pub(super) fn new(points: &[Vec3]) -> Self {
        Self {
            reach: points.iter().map(|x| norm(*x)).fold(0.0, f64::max),
            tracks: Tracks::default(),
            axes: Vec::new(),
            standing: [BTreeMap::new(), BTreeMap::new()],
        }
    }

    /// The position of an axis: with another point or sense it is another one, as in CalculiX.
    fn axis(&mut self, [point, along]: Axis) -> usize {
        let is_same = |[other, direction]: &Axis| {
            let reach = self.reach.max(norm(point)).max(norm(*other));
            norm(sub(along, *direction)) <= TURNED && norm(sub(point, *other)) <= TURNED * reach
        };
        self.axes.iter().position(is_same).unwrap_or_else(|| {
            self.axes.push([point, along]);
            self.axes.len() - 1
        })
    }

    pub(super) fn remove(&mut self, step: usize) {
        self.tracks.remove(step);
        self.standing.iter_mut().for_each(BTreeMap::clear);
    }

    /// Notes what a line gives; `when` are the step and its place among all.
    pub(super) fn set(
        &mut self,
        target: &Target,
        law: &VolumeLaw,
        when: (usize, usize, bool),
        given: Given,
        word: &Word,
    ) -> Result<(), DeckError> {
        match law {
            VolumeLaw::Force(component) => {
                let key = (target.clone(), Kind::Force, *component);
                self.tracks.set(key, when, given, word)
            }
            VolumeLaw::Gravity(direction) => {
                let length = norm(*direction);
                let axis = self.axis([[0.0; 3], unit(*direction)]);
                if self.standing[0]
                    .insert(target.clone(), axis)
                    .is_some_and(|before| before != axis)
                {
                    return Err(word.cannot(
                        "gravity along another direction stands there, which CalculiX keeps beside this and Abaqus \
                        replaces; give one vector, in a later step with OP=NEW",
                    ));
                }
                for (c, d) in direction.iter().enumerate() {
                    let value = given.value * (d / length);
                    let key = (target.clone(), Kind::Gravity(axis), c);
                    self.tracks.set(key, when, Given { value, ..given }, word)?;
                }
                Ok(())
            }
            VolumeLaw::Centrifugal([point, along]) => {
                let axis = self.axis([*point, unit(*along)]);
                if self.standing[1]
                    .insert(target.clone(), axis)
                    .is_some_and(|before| before != axis)
                {
                    return Err(word.cannot(
                        "centrifugal forces about another axis stand there, or about this one by another point or in the \
                        other sense, beside which CalculiX puts these; give the same point and direction, or OP=NEW in \
                        a later step",
                    ));
                }
                let key = (target.clone(), Kind::Centrifugal(axis), 0);
                self.tracks.set(key, when, given, word)
            }
        }
    }

    /// Densities of the whole mesh, each with its place among all and its history; what is not given in all elements
    /// alike goes to `force` as forces at nodes, with history and place.
    pub(super) fn lower(
        &self,
        known: Known,
        histories: &mut Histories,
        mut force: impl FnMut(usize, usize, u32, Vec3),
    ) -> Result<Vec<(usize, LoadDensity, usize)>, DeckError> {
        self.check_forces(known)?;
        let mut sections = None;
        let mut bodies = Vec::new();
        type Group = (Target, Kind, usize);
        let mut groups: BTreeMap<Group, (usize, Vec3, &Track)> = BTreeMap::new();
        for ((target, kind, component), track) in &self.tracks.0 {
            let found = histories.add(known.timeline, track)?;
            if let Some((value, history)) = found {
                let key = (target.clone(), *kind, history);
                let group = groups.entry(key).or_insert((track.order, [0.0; 3], track));
                group.1[*component] = value;
            }
        }
        for ((target, kind, history), (order, value, track)) in groups {
            let Known { sets, raw, .. } = known;
            let elements = sets.elements.find(&target, &track.word)?;
            // rigid ones are held, whatever pulls them
            let elements: Vec<u32> = elements.into_iter().flat_map(|e| raw.tets_of(e)).collect();
            if elements.is_empty() {
                continue;
            }
            let densities = match kind {
                Kind::Force => vec![1.0; elements.len()],
                Kind::Gravity(_) | Kind::Centrifugal(_) => known.densities(&mut sections, &elements, track)?,
            };
            let pulls_in = |(_, factor): &(f64, f64)| value[0] * factor < 0.0;
            if matches!(kind, Kind::Centrifugal(_)) && histories.at(history).points().iter().any(pulls_in) {
                let why = "the square of an angular velocity is not negative, but its amplitude makes it so";
                return Err(track.word.cannot(why));
            }
            let same = densities.iter().all(|d| *d == densities[0]);
            let whole = same && elements.len() == raw.tets.len();
            if whole {
                let density = densities[0];
                let density = match kind {
                    Kind::Centrifugal(axis) => {
                        let (axis, factor) = (self.axes[axis], density * value[0]);
                        LoadDensity::body_field(move |x| scale(factor, arm(x, axis)))
                    }
                    Kind::Force | Kind::Gravity(_) => LoadDensity::Body(value.map(|v| density * v)),
                };
                bodies.push((order, density, history));
                continue;
            }
            for (&element, density) in elements.iter().zip(densities) {
                let forces = match kind {
                    Kind::Centrifugal(axis) => {
                        let (axis, factor) = (self.axes[axis], density * value[0]);
                        raw.tet_forces(element, move |x| scale(factor, arm(x, axis)))
                    }
                    Kind::Force | Kind::Gravity(_) => raw.tet_forces(element, |_| scale(density, value)),
                };
                for (node, part) in forces.map_err(|error| track.word.cannot(error.to_string()))? {
                    force(history, order, node, part);
                }
            }
        }
        Ok(bodies)
    }

    /// Forces per volume add up within a step; CalculiX replaces those of earlier steps element by element, which are
    /// those of the same target here.
    fn check_forces(&self, Known { sets, .. }: Known) -> Result<(), DeckError> {
        let mut of_element: HashMap<(u32, usize), &Track> = HashMap::new();
        for ((target, kind, component), track) in &self.tracks.0 {
            if *kind != Kind::Force {
                continue;
            }
            for element in sets.elements.find(target, &track.word)? {
                let before = of_element.insert((element, *component), track);
                if let Some(before) = before.filter(|before| before.first_step() != track.first_step()) {
                    let later = if before.order < track.order { track } else { before };
                    return Err(later.word.cannot(
                        "some of these elements have such a force from another step, by another set; name the same set \
                        in both steps, or give sets without common elements",
                    ));
                }
            }
        }
        Ok(())
    }
}

/// From an axis to a place, at right angles to the axis.
fn arm(x: Vec3, [point, along]: Axis) -> Vec3 {
    let from = sub(x, point);
    sub(from, scale(dot(from, along), along))
}

impl Known<'_> {
    /// Densities of elements, that of the material of their section; `known` are the sections, once they are asked for.
    fn densities(self, known: &mut Option<Vec<u32>>, elements: &[u32], track: &Track) -> Result<Vec<f64>, DeckError> {
        let Known { model, raw, sets, .. } = self;
        if known.is_none() {
            *known = sections(raw, sets)?;
        }
        let sections = (known.as_ref())
            .ok_or_else(|| (track.word).cannot("forces of the mass need materials; give *SOLID SECTION"))?;
        let mut of_section = Vec::with_capacity(model.sections.len());
        for section in &model.sections {
            of_section.push((model.material(section)?.density, &section.material.name));
        }
        let density = |&element: &u32| {
            let (density, name) = of_section[sections[element as usize] as usize];
            density.ok_or_else(|| {
                let why = format!("forces of the mass need a density; give material {name} *DENSITY");
                track.word.cannot(why)
            })
        };
        elements.iter().map(density).collect()
    }
}
