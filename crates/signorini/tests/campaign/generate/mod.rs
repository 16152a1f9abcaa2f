//! Random scenes over what the public interface can say.
//!
//! What is known to go wrong, and is not said for that reason, stands in [`KNOWN`].

pub(crate) mod apart;
mod bodies;
mod contacts;
pub(crate) mod fit;
pub(crate) mod grip;
mod laws;
mod loads;
mod material;
pub(crate) mod round;
mod settings;
mod supports;

use crate::dice::Dice;
use crate::recipe::{Clock, Course, Density, Elastic, Fixed, Hold, Law, Push, Recipe, Where};
use crate::vec3::{Vec3, add, cross, dot, scale, unit};
use signorini::prelude::{FacetTag, TetMesh};

/// Known faults and limits that the generator stays clear of. An entry goes when its fault is mended.
pub(crate) const KNOWN: [(&str, &str); 4] = [
    (
        "acute edges",
        "sides of two contacts that meet at an edge by less than the angle of a crease are one point with the mean normal: \
         sides lean by at most 0.3",
    ),
    (
        "curved parts",
        "parts of one curved side that are two contacts have the mean normal at their border: only plane sides are split",
    ),
    (
        "moved fields",
        "the check does not know how an obstacle given by a gap field moves along the surface: it is moved along its normal only",
    ),
    (
        "stiff foundations",
        "certificates measure springs by lengths: by the methods of the paper forces of a foundation that is much stiffer than \
         the bodies are off by 5e-4; beside couplings it is solved by the default one",
    ),
];

/// Bodies without supports, loads and contact.
fn bare(dice: &mut Dice, (mesh, elastic): (TetMesh, Vec<Elastic>), clock: Clock, words: Vec<String>) -> Recipe {
    Recipe {
        pieces: settings::pieces(dice, &mesh),
        mesh,
        elastic,
        holds: Vec::new(),
        pushes: Vec::new(),
        touches: Vec::new(),
        how: settings::how(dice, clock.times().len()),
        clock,
        words,
    }
}

/// The scene with a number.
pub(crate) fn recipe(seed: u64, number: u64) -> Recipe {
    let mut dice = Dice::new(seed, number);
    let dice = &mut dice;
    let world = bodies::world(dice);
    let clock = settings::clock(dice);
    let (mesh, elastic, material) = material::materials(dice, &world);
    let mut recipe = bare(dice, (mesh, elastic), clock, world.words.clone());
    recipe.words.push(material);
    let shaft = Shaft::new(&recipe.clock);
    contacts::contacts(dice, &world, &shaft, &mut recipe);
    supports::supports(dice, &world, &shaft, &mut recipe);
    loads::loads(dice, &world, &shaft, &mut recipe);
    settings::describe(&mut recipe);
    recipe
}

/// The same scene, warmer or colder: with strain without stress.
pub(crate) fn warm(seed: u64, number: u64) -> Recipe {
    let mut recipe = recipe(seed, number);
    let dice = &mut Dice::new(!seed, number);
    let size = dice.decades(1e-5, 3e-3);
    let strain = if dice.chance(0.6) {
        [size, size, size, 0.0, 0.0, 0.0]
    } else {
        std::array::from_fn(|_| size * dice.either())
    };
    let (points, slope) = (recipe.mesh.points(), dice.vector());
    let length = points.iter().flatten().fold(f64::MIN_POSITIVE, |l, x| l.max(x.abs()));
    let uneven = dice.chance(0.5);
    let factor = |x: &Vec3| if uneven { dot(slope, *x) / length } else { 1.0 };
    let factors = points.iter().map(factor).collect();
    let regions = recipe.mesh.distinct_regions();
    let region = dice.chance(0.3).then(|| regions[dice.whole(0, regions.len() - 1)]);
    let end = recipe.clock.times().last().copied().unwrap_or(1.0);
    let course = if dice.chance(0.3) {
        Course::Constant(dice.either())
    } else {
        Course::Table(vec![(0.0, 0.0), (0.7 * end, 1.0), (end, dice.either())])
    };
    recipe.words.push("eigenstrain".into());
    let density = Density::Eigenstrain(strain, region, factors);
    recipe.pushes.push(Push { density, course });
    recipe
}

/// A rotation and a translation of the whole.
struct Turn {
    axes: [Vec3; 3],
    by: Vec3,
}

impl Turn {
    fn new(dice: &mut Dice, length: f64) -> Self {
        if dice.chance(0.4) {
            let z = unit(add([0.0, 0.0, 1.5], dice.vector()));
            let x = unit(cross([0.3, 1.0, 0.0], z));
            Self {
                axes: [x, cross(z, x), z],
                by: scale(length, dice.vector()),
            }
        } else {
            Self {
                axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                by: [0.0; 3],
            }
        }
    }

    fn way(&self, v: Vec3) -> Vec3 {
        (0..3).fold([0.0; 3], |s, k| add(s, scale(v[k], self.axes[k])))
    }

    fn place(&self, x: Vec3) -> Vec3 {
        add(self.way(x), self.by)
    }
}

/// How fast things go.
pub(crate) struct Shaft {
    pub(crate) duration: f64,
    static_: bool,
}

impl Shaft {
    fn new(clock: &Clock) -> Self {
        let times = clock.times();
        Self {
            duration: times.last().copied().unwrap_or(1.0),
            static_: times.len() == 1,
        }
    }

    /// A factor in time of about one at most.
    pub(crate) fn course(&self, dice: &mut Dice) -> Course {
        let end = self.duration;
        match dice.whole(0, 9) {
            _ if self.static_ && dice.chance(0.5) => Course::Constant(1.0),
            0 => Course::Constant(1.0),
            1..=3 => Course::Table(vec![(0.0, 0.0), (end, 1.0)]),
            4 | 5 => Course::Table(vec![
                (0.0, 0.0),
                (0.4 * end, 1.0),
                (0.7 * end, dice.between(-0.2, 0.5)),
                (end, 1.0),
            ]),
            6 | 7 => Course::Table(vec![
                (0.0, dice.between(0.0, 1.0)),
                (0.5 * end, 1.0),
                (end, dice.between(0.0, 1.0)),
            ]),
            _ => Course::Wave {
                size: 1.0,
                pace: dice.between(1.0, 8.0) / end,
                phase: dice.between(0.0, 1.0),
            },
        }
    }
}

/// Sizes and times of a scene of bodies meshed apart.
struct Frame {
    length: f64,
    young: f64,
    strain: f64,
    stress: f64,
    /// How far things move, m.
    way: f64,
    clock: Clock,
    shaft: Shaft,
    turn: Turn,
}

impl Frame {
    fn new(dice: &mut Dice) -> Self {
        let length = if dice.chance(0.7) { 1.0 } else { dice.decades(1e-3, 1e2) };
        let young = if dice.chance(0.5) { 1e9 } else { dice.decades(1e4, 1e12) };
        let strain = dice.decades(1e-4, 1e-2);
        let clock = settings::clock(dice);
        Self {
            length,
            young,
            strain,
            stress: young * strain,
            way: strain * length,
            shaft: Shaft::new(&clock),
            clock,
            turn: Turn::new(dice, length),
        }
    }

    /// The material of a body, with Poisson's ratio up to `poisson`.
    fn elastic(&self, dice: &mut Dice, body: usize, poisson: f64, words: &mut Vec<String>) -> Elastic {
        let stiff = match dice.whole(0, 3) {
            _ if body == 0 => 1.0,
            0 | 1 => 1.0,
            2 => dice.decades(0.1, 10.0),
            _ => dice.decades(1e-3, 1e3),
        };
        words.push(format!("stiffness {stiff:.1e}"));
        Elastic::Isotropic(stiff * self.young, dice.between(0.0, poisson))
    }

    fn law(&self, dice: &mut Dice) -> Law {
        match dice.whole(0, 9) {
            0..=1 => Law::None,
            2 => Law::Given(dice.between(0.05, 0.5) * self.stress),
            3 => Law::Exponential {
                fixed: dice.between(0.3, 0.6),
                kinetic: dice.between(0.1, 0.3),
                decay: dice.decades(0.1, 10.0) * self.way / self.shaft.duration,
            },
            _ => Law::Coulomb(dice.between(0.05, 0.8)),
        }
    }

    /// Moves a side as a whole.
    fn moved(&self, dice: &mut Dice, side: FacetTag, down: Vec3, recipe: &mut Recipe) {
        recipe.words.push("moved".into());
        recipe.holds.push(Hold {
            place: Where::Tag(side),
            fixed: Fixed::All,
            motion: Some((vec![scale(self.way, down)], self.shaft.course(dice))),
        });
    }

    /// Presses on a side of a body that nothing holds.
    fn loaded(&self, dice: &mut Dice, side: FacetTag, down: Vec3, recipe: &mut Recipe) {
        recipe.words.push("loose, loaded".into());
        let course = if dice.chance(0.5) { Course::Constant(1.0) } else { self.shaft.course(dice) };
        let density = Density::Traction(side, scale(dice.between(0.2, 1.0) * self.stress, down));
        recipe.pushes.push(Push { density, course });
    }
}
