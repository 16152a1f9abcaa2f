//! Bodies meshed apart: what a recipe does not say of them, and its words in the library.

use crate::grip::Grip;
use crate::recipe::{Course, Law, Recipe};
use crate::vec3::{Vec3, across, dot, norm, scale, sub, unit};
use signorini::prelude::*;

/// The gap of two sides at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Rest {
    /// What coordinates say: so far from each other, m; negative where they overlap.
    Measured(f64),
    /// As given, whatever they say, m.
    Given(f64),
}

/// Two sides that face each other.
#[derive(Debug, Clone)]
pub(crate) struct Pair {
    pub(crate) sides: [FacetTag; 2],
    pub(crate) tied: bool,
    pub(crate) rest: Rest,
    /// Factor of the gap in time.
    pub(crate) growth: Option<Course>,
    pub(crate) law: Law,
    /// Direction of the law, and friction across it over that along it.
    pub(crate) axis: Option<(Vec3, f64)>,
    /// Area where both sides face each other, seen from above, m².
    pub(crate) common: f64,
    /// Whether that is all of both.
    pub(crate) whole: bool,
    pub(crate) compliance: [f64; 2],
    /// How the first side moves against the second where they are tied.
    pub(crate) motion: Option<(Vec3, Course)>,
}

impl Pair {
    /// How far the sides are from each other, or overlap, as coordinates say, m; beside bumps.
    pub(crate) fn apart(&self) -> f64 {
        match self.rest {
            Rest::Measured(gap) => gap.abs(),
            Rest::Given(_) => 0.0,
        }
    }
}

/// The shape of a rigid obstacle.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Shape {
    /// A point and the normal out of it, of length one.
    Plane(Vec3, Vec3),
    /// Centre and radius.
    Ball(Vec3, f64),
    /// A point and the direction of the axis, of length one, and the radius.
    Roll(Vec3, Vec3, f64),
    /// The same, hollow: bodies are inside.
    Bore(Vec3, Vec3, f64),
    /// A cone: the radius is that at the point, and grows by the last number along the axis.
    Taper(Vec3, Vec3, f64, f64),
}

/// A rigid obstacle.
#[derive(Debug, Clone)]
pub(crate) struct Rock {
    pub(crate) side: FacetTag,
    pub(crate) shape: Shape,
    pub(crate) motion: Option<(Vec3, Course)>,
    /// A point, the direction of an axis, of length one, and the angle in time. What turns and moves does both in
    /// proportion.
    pub(crate) turn: Option<(Vec3, Vec3, Course)>,
    /// Factor of the gap in time.
    pub(crate) growth: Option<Course>,
    pub(crate) law: Law,
    pub(crate) axis: Option<(Vec3, f64)>,
    pub(crate) compliance: [f64; 2],
}

/// Stiffness of an elastic foundation, N/m³.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Bed {
    Components(Vec3),
    /// Along the normals.
    Normal(f64),
}

impl Bed {
    /// Of a displacement the stress that it causes, where the normal is this unit vector.
    pub(crate) fn stress(&self, normal: Vec3, u: Vec3) -> Vec3 {
        match self {
            Self::Components(k) => [0, 1, 2].map(|c| -k[c] * u[c]),
            Self::Normal(k) => scale(-k * dot(normal, u), normal),
        }
    }
}

/// What a recipe does not say.
#[derive(Debug, Clone)]
pub(crate) struct Apart {
    /// Mesh, elasticity, supports, loads, times and settings.
    pub(crate) recipe: Recipe,
    /// In the order of the scene's contacts.
    pub(crate) pairs: Vec<Pair>,
    /// Behind the pairs.
    pub(crate) rocks: Vec<Rock>,
    /// Height of the bumps of sides that face each other, m; zero for plane ones.
    pub(crate) bumps: f64,
    /// Side and stiffness of an elastic foundation.
    pub(crate) ground: Option<(FacetTag, Bed)>,
    pub(crate) grips: Vec<Grip>,
}

impl Shape {
    /// A point of it, or of its axis.
    pub(crate) fn point(&self) -> Vec3 {
        match *self {
            Self::Plane(point, _)
            | Self::Ball(point, _)
            | Self::Roll(point, ..)
            | Self::Bore(point, ..)
            | Self::Taper(point, ..) => point,
        }
    }

    /// Distance and gradient.
    pub(crate) fn distance(&self, x: Vec3) -> (f64, Vec3) {
        let from = |arm: Vec3, radius: f64| (norm(arm) - radius, unit(arm));
        match *self {
            Self::Plane(point, outward) => (dot(sub(x, point), outward), outward),
            Self::Ball(centre, radius) => from(sub(x, centre), radius),
            Self::Roll(point, axis, radius) => {
                let arm = sub(x, point);
                from(sub(arm, scale(dot(arm, axis), axis)), radius)
            }
            Self::Bore(point, axis, radius) => {
                let (distance, outward) = Self::Roll(point, axis, radius).distance(x);
                (-distance, scale(-1.0, outward))
            }
            Self::Taper(point, axis, radius, slope) => {
                let arm = sub(x, point);
                let (along, off) = (dot(arm, axis), across(arm, axis));
                let cosine = 1.0 / 1.0_f64.hypot(slope);
                let outward = scale(cosine, sub(unit(off), scale(slope, axis)));
                (cosine * (norm(off) - radius - slope * along), outward)
            }
        }
    }
}

impl Apart {
    /// The contacts in the words of the library.
    pub(crate) fn scene(&self, mut scene: Scene) -> Result<Scene, Error> {
        if let Some((tag, stiffness)) = self.ground {
            scene = scene.with_spring(match stiffness {
                Bed::Components(stiffness) => Spring::components(tag, stiffness),
                Bed::Normal(stiffness) => Spring::normal(tag, stiffness),
            });
        }
        let rough = |contact: Contact, law: &Law, axis: &Option<(Vec3, f64)>, [normal, along]: [f64; 2]| {
            let contact = contact.with_friction(crate::say::friction(law));
            let contact = contact.with_normal_compliance(normal).with_tangential_compliance(along);
            axis.map_or(contact.clone(), |(axis, ratio)| contact.with_friction_axis(axis, ratio))
        };
        let grown = |contact: Contact, growth: &Option<Course>| -> Result<Contact, Error> {
            Ok(match growth {
                Some(course) => contact.with_gap_history(crate::say::history(course)?),
                None => contact,
            })
        };
        for pair in &self.pairs {
            let [a, b] = pair.sides;
            scene = scene.with_contact(if pair.tied {
                let tie = Contact::tied(a, b);
                match &pair.motion {
                    Some((way, course)) => tie.with_motion(*way, crate::say::history(course)?),
                    None => tie,
                }
            } else {
                let contact = match pair.rest {
                    Rest::Measured(_) => Contact::between(a, b),
                    Rest::Given(gap) => Contact::between(a, b).with_gap(gap),
                };
                rough(grown(contact, &pair.growth)?, &pair.law, &pair.axis, pair.compliance)
            });
        }
        for rock in &self.rocks {
            let shape = match rock.shape {
                Shape::Plane(point, outward) => Obstacle::half_space(point, outward),
                Shape::Ball(centre, radius) => Obstacle::sphere(centre, radius),
                Shape::Roll(point, axis, radius) => Obstacle::cylinder(point, axis, radius),
                Shape::Bore(point, axis, radius) => Obstacle::cylinder(point, axis, radius).hollow(),
                shape @ Shape::Taper(..) => {
                    Obstacle::from_distance(move |x| shape.distance(x).0, move |x| shape.distance(x).1)
                }
            };
            let mut contact = Contact::obstacle(rock.side, shape);
            if let Some((way, course)) = &rock.motion {
                contact = contact.with_motion(*way, crate::say::history(course)?);
            }
            if let Some((point, axis, course)) = &rock.turn {
                contact = contact.with_rotation(*point, *axis, crate::say::history(course)?);
            }
            let contact = grown(contact, &rock.growth)?;
            scene = scene.with_contact(rough(contact, &rock.law, &rock.axis, rock.compliance));
        }
        crate::grip::scene(&self.grips, scene)
    }
}
