//! Scenes of shafts, tubes and rings in one another: with interference that may grow, with clearance, or touching; on
//! arbors, cones and in bores that are displaced and turn at once; slit rings, whose ends meet. They are held about
//! their axis, along normals or by springs, twisted by moments, heated, and rub by direction. Steps may be halved.

mod supports;

use super::bodies::side;
use super::round::{area, close};
use super::{Frame, bare, material, settings};
use crate::apart::{Apart, Bed, Pair, Rest, Rock, Shape};
use crate::dice::Dice;
use crate::recipe::{Course, Density, Elastic, Law, Push, Recipe, Solver};
use crate::vec3::{Vec3, add, dot, norm, scale, sub};
use signorini::prelude::*;
use std::f64::consts::TAU;

/// A body about the axis, before the whole is turned.
#[derive(Clone, Copy)]
struct Ring {
    /// The inner one is zero of a solid shaft.
    radii: [f64; 2],
    heights: [f64; 2],
    phase: f64,
    /// Width of a slit; zero for none.
    slit: f64,
    cells: [usize; 3],
}

impl Ring {
    fn solid(&self) -> bool {
        self.radii[0] == 0.0
    }

    /// The place of a point of the unit cube.
    fn place(&self, [x, y, z]: Vec3) -> Vec3 {
        let ([low, high], [below, above]) = (self.radii, self.heights);
        let (sin, cos) = self.phase.sin_cos();
        let [x, y] = if self.solid() {
            let [s, t] = [2.0 * x - 1.0, 2.0 * y - 1.0];
            let bulge = |a: f64, b: f64| high * a * (1.0 - 0.5 * b * b).sqrt();
            [bulge(s, t), bulge(t, s)]
        } else {
            let r = low + x * (high - low);
            // sides of a slit are parallel
            let half = (0.5 * self.slit / r).asin();
            let (sin, cos) = (half + y * (TAU - 2.0 * half)).sin_cos();
            [r * cos, r * sin]
        };
        [cos * x - sin * y, sin * x + cos * y, below + z * (above - below)]
    }

    /// Its mesh, with the tags of a body of this number: sides of a solid shaft are all outside.
    fn mesh(&self, order: usize, body: usize, near: f64, turned: impl Fn(Vec3) -> Vec3) -> TetMesh {
        let own = Brick::new([1.0; 3], self.cells).build().expect("brick");
        let own = if order == 2 { own.raise_order().expect("order 2") } else { own };
        let place = |p| turned(self.place(p));
        let own = if self.solid() {
            let outside = [brick::X_MIN, brick::Y_MIN, brick::Y_MAX];
            let own = own.map_points(place).expect("places");
            own.map_tags(|t| if outside.contains(&t) { brick::X_MAX } else { t })
        } else if self.slit > 0.0 {
            own.map_points(place).expect("places")
        } else {
            close(&own, place, near)
        };
        let own = own.map_tags(|t| side(body, t));
        let tets = own.tets().len();
        own.with_regions(vec![body as u32; tets]).expect("regions")
    }
}

/// What a scene is made of while it is written.
struct Bench<'d> {
    dice: &'d mut Dice,
    frame: Frame,
    rings: Vec<Ring>,
    recipe: Recipe,
    rocks: Vec<Rock>,
    axis: Vec3,
    centre: Vec3,
}

/// The scene with a number.
pub(crate) fn fit(seed: u64, number: u64) -> Apart {
    let mut dice = Dice::new(seed ^ 0x0f17, number);
    let dice = &mut dice;
    let frame = Frame::new(dice);
    let order = if dice.chance(0.25) { 2 } else { 1 };
    let mut words = vec![format!("order {order}")];
    let (rings, clear) = rings(dice, &frame, order, &mut words);
    let (mut mesh, mut elastic, mut meshes) = (None::<TetMesh>, Vec::new(), Vec::new());
    for (body, ring) in rings.iter().enumerate() {
        let own = ring.mesh(order, body, 1e-9 * frame.length, |p| frame.turn.place(p));
        mesh = Some(mesh.map_or_else(|| own.clone(), |m| m.append(&own).expect("bodies")));
        meshes.push(own);
        let mut law = frame.elastic(dice, body, 0.4, &mut words);
        if let (true, Elastic::Isotropic(young, poisson)) = (dice.chance(0.15), &law) {
            words.push("anisotropic".into());
            law = Elastic::Matrix(Box::new(material::anisotropic(dice, *young, *poisson)));
        }
        elastic.push(law);
    }
    let mesh = mesh.expect("a body");
    let mut recipe = bare(dice, (mesh, elastic), frame.clock.clone(), words);
    if recipe.how.solver != Solver::Face && (order == 2 || rings.len() > 1) {
        // the paper's methods take thousands of products there
        recipe.how.solver = Solver::Face;
    }
    let mut bench = Bench {
        axis: frame.turn.way([0.0, 0.0, 1.0]),
        centre: frame.turn.place([0.0; 3]),
        dice,
        frame,
        rings,
        recipe,
        rocks: Vec::new(),
    };
    let mut pairs = Vec::new();
    for body in 1..bench.rings.len() {
        let sides = [side(body, brick::X_MIN), side(body - 1, brick::X_MAX)];
        let common = area(&meshes[body], sides[0]).min(area(&meshes[body - 1], sides[1]));
        pairs.push(bench.between(sides, clear[body - 1], [1.001, 1.25][order - 1] * common));
    }
    for body in 0..bench.rings.len() {
        let slit = bench.rings[body].slit;
        if slit > 0.0 {
            let sides = [side(body, brick::Y_MIN), side(body, brick::Y_MAX)];
            let common = 1.001 * area(&meshes[body], sides[0]);
            let mut pair = bench.between(sides, slit, common);
            (pair.rest, pair.tied) = (Rest::Measured(slit), false);
            pairs.push(pair);
        }
    }
    bench.obstacles();
    bench.supports();
    bench.loads();
    bench.halving();
    let bumps = if bench.rings.len() > 1 { bench.bumps() } else { 0.0 };
    let ground = bench.springs();
    let Bench { mut recipe, rocks, .. } = bench;
    settings::describe(&mut recipe);
    Apart {
        recipe,
        pairs,
        rocks,
        bumps,
        ground,
        grips: Vec::new(),
    }
}

/// One to three bodies, from the axis outward, and how far each is from the next.
fn rings(dice: &mut Dice, frame: &Frame, order: usize, words: &mut Vec<String>) -> (Vec<Ring>, Vec<f64>) {
    let count = [1, 2, 2, 2, 4 - order][dice.whole(0, 4)];
    let outer = frame.length * dice.between(0.3, 0.8);
    let solid = count > 1 && dice.chance(0.5);
    let around = |dice: &mut Dice| 2 * dice.whole(4, 8 / order + 2);
    let mut rings = vec![Ring {
        radii: [if solid { 0.0 } else { outer * dice.between(0.4, 0.85) }, outer],
        heights: [0.0, frame.length * dice.between(0.3, 1.2)],
        phase: 0.0,
        slit: if !solid && dice.chance(0.2) { frame.way * dice.between(0.2, 2.0) } else { 0.0 },
        cells: if solid {
            let n = dice.whole(2, 4 - order / 2);
            [n, n, dice.whole(1, 4 - order)]
        } else {
            [dice.whole(1, 3 - order), around(dice), dice.whole(1, 4 - order)]
        },
    }];
    words.push(if solid { "shaft" } else { "tube" }.into());
    let mut clear = Vec::new();
    for body in 1..count {
        let under = rings[body - 1];
        let far = match dice.whole(0, 9) {
            0 | 1 => frame.way * dice.between(0.05, 1.0),
            2 => -frame.way * dice.between(0.05, 0.5),
            _ => 0.0,
        };
        words.push(
            ["overlap", "ring", "clearance"][if far == 0.0 {
                1
            } else if far > 0.0 {
                2
            } else {
                0
            }]
            .into(),
        );
        let mut own = under;
        own.slit = if dice.chance(0.15) { frame.way * dice.between(0.2, 2.0) } else { 0.0 };
        own.radii = [under.radii[1] + far, (under.radii[1] + far) * dice.between(1.2, 1.8)];
        let same = dice.chance(0.3);
        let height = under.heights[1] - under.heights[0];
        if !same {
            own.phase = dice.between(0.0, 1.0);
            let (from, to) = (dice.between(-0.3, 0.6), dice.between(0.3, 1.0));
            own.heights = [from, from + to].map(|h| under.heights[0] + h * height);
        }
        let below = if under.solid() { 4 * under.cells[0] } else { under.cells[1] };
        let ratio = if same { 1.0 } else { dice.decades(0.5, 2.0) };
        let about = ((2.0 * (0.5 * below as f64 * ratio).round()) as usize).clamp(8, 18 - 4 * order);
        own.cells = [dice.whole(1, 3 - order), about, dice.whole(1, 4 - order)];
        if same && dice.chance(0.5) {
            own.cells[2] = under.cells[2];
        }
        rings.push(own);
        clear.push(far);
    }
    for ring in &rings {
        if ring.slit > 0.0 {
            words.push("slit".into());
        }
    }
    (rings, clear)
}

impl Bench<'_> {
    fn say(&mut self, word: &str) {
        self.recipe.words.push(word.into());
    }

    fn growing(&mut self) -> Option<Course> {
        self.dice.chance(0.5).then(|| {
            self.say("growing");
            let end = self.frame.shaft.duration;
            match self.dice.whole(0, 2) {
                0 => Course::Table(vec![(0.0, 0.0), (0.5 * end, 1.0)]),
                1 => Course::Table(vec![(0.0, 0.2), (0.4 * end, 1.0), (end, self.dice.between(-0.5, 1.0))]),
                _ => self.frame.shaft.course(self.dice),
            }
        })
    }

    fn law(&mut self) -> (Law, Option<(Vec3, f64)>) {
        let law = self.frame.law(self.dice);
        if !law.is_some() || !self.dice.chance(0.4) {
            return (law, None);
        }
        self.say("axis");
        // along the axis, or anywhere but along no normal
        let lean = if self.dice.chance(0.5) { 0.0 } else { 0.3 };
        let way = add(self.axis, scale(lean, self.dice.vector()));
        let ratio = self.dice.decades(0.3, 3.0);
        (law, Some((way, ratio)))
    }

    fn gives_way(&mut self) -> [f64; 2] {
        if !self.dice.chance(0.15) {
            return [0.0; 2];
        }
        self.say("gives way");
        let soft = self.frame.way / self.frame.stress;
        [0, 1].map(
            |_| {
                if self.dice.chance(0.7) { soft * self.dice.decades(1e-3, 10.0) } else { 0.0 }
            },
        )
    }

    /// Two sides, so far from each other.
    fn between(&mut self, mut sides: [FacetTag; 2], far: f64, common: f64) -> Pair {
        if self.dice.chance(0.5) {
            sides.swap(0, 1);
        }
        let tied = far == 0.0 && self.dice.chance(0.12);
        let (mut law, mut axis) = self.law();
        let mut rest = Rest::Measured(far);
        let mut growth = None;
        if tied {
            self.say("tied");
            (law, axis) = (Law::None, None);
        } else {
            if far == 0.0 && self.dice.chance(0.6) {
                self.say("interference");
                rest = Rest::Given(-self.frame.way * self.dice.between(0.05, 0.7));
            }
            growth = self.growing();
        }
        Pair {
            sides,
            tied,
            rest,
            growth,
            law,
            axis,
            common,
            whole: false,
            compliance: if tied { [0.0; 2] } else { self.gives_way() },
            motion: None,
        }
    }

    /// An arbor or a cone inside, a bore outside, a plane below.
    fn obstacles(&mut self) {
        let last = self.rings.len() - 1;
        let (first, outmost) = (self.rings[0], self.rings[last]);
        let tight = |dice: &mut Dice, strain: f64| match dice.whole(0, 3) {
            0 => 0.0,
            1 => -strain * dice.unit(),
            _ => 0.5 * strain * dice.unit(),
        };
        if !first.solid() && self.dice.chance(0.5) {
            let radius = first.radii[0] * (1.0 + tight(self.dice, self.frame.strain));
            let shape = if self.dice.chance(0.5) {
                self.say("arbor");
                Shape::Roll(self.centre, self.axis, radius)
            } else {
                self.say("cone");
                let slope =
                    self.dice.either() * self.frame.strain * first.radii[0] / (first.heights[1] - first.heights[0]);
                Shape::Taper(self.centre, self.axis, radius, slope)
            };
            self.rock(side(0, brick::X_MIN), shape);
        }
        if self.dice.chance(0.25) {
            self.say("bore");
            let radius = outmost.radii[1] * (1.0 - tight(self.dice, self.frame.strain));
            self.rock(side(last, brick::X_MAX), Shape::Bore(self.centre, self.axis, radius));
        }
        if self.dice.chance(0.2) {
            self.say("plane");
            let body = self.dice.whole(0, last);
            let point = self.frame.turn.place([0.0, 0.0, self.rings[body].heights[0]]);
            self.rock(side(body, brick::Z_MIN), Shape::Plane(point, self.axis));
        }
    }

    fn rock(&mut self, side: FacetTag, shape: Shape) {
        let (law, axis) = match shape {
            Shape::Plane(..) => (self.frame.law(self.dice), None),
            _ => self.law(),
        };
        let mut rock = Rock {
            side,
            shape,
            motion: None,
            turn: None,
            growth: self.growing(),
            law,
            axis,
            compliance: self.gives_way(),
        };
        // one course for both
        let course = self.frame.shaft.course(self.dice);
        let (moves, turns) = (self.dice.chance(0.4), self.dice.chance(0.4));
        if moves {
            self.say("displaced");
            let across = if self.dice.chance(0.3) { 0.3 } else { 0.0 };
            let way = add(scale(self.dice.either(), self.axis), scale(across, self.dice.vector()));
            rock.motion = Some((scale(self.frame.way, way), course.clone()));
        }
        if turns {
            self.say("turns");
            let angle = self.frame.strain * self.dice.decades(0.3, 30.0);
            rock.turn = Some((shape.point(), self.axis, course.times(angle)));
        }
        self.rocks.push(rock);
    }

    fn push(&mut self, word: &str, density: Density) {
        self.say(word);
        let course = self.frame.shaft.course(self.dice);
        self.recipe.pushes.push(Push { density, course });
    }

    fn loads(&mut self) {
        let last = self.rings.len() - 1;
        let stress = self.frame.stress;
        for body in 0..=last {
            let ring = self.rings[body];
            let top = side(body, if self.dice.chance(0.7) { brick::Z_MAX } else { brick::Z_MIN });
            let [low, high] = ring.radii;
            if self.dice.chance(0.4) {
                let size = stress * (high.powi(4) - low.powi(4)) / high * self.dice.between(0.05, 0.5);
                let way = add(scale(self.dice.either(), self.axis), scale(0.3, self.dice.vector()));
                // integrands on facets with bent edges are beyond the degree of the library's rule
                if self.recipe.mesh.order() == 1 {
                    self.push("moment", Density::Moment(top, scale(size, way)));
                }
            }
            if self.dice.chance(0.3) {
                let size = stress * (high.powi(2) - low.powi(2)) * self.dice.between(0.1, 1.0);
                let way = add(scale(self.dice.either(), self.axis), scale(0.3, self.dice.vector()));
                self.push("force", Density::Force(top, scale(size, way)));
            }
            if self.dice.chance(0.12) {
                let size = 0.2 * stress * high * high * high;
                let moment = scale(size, self.dice.vector());
                // the same, and areas of bent facets are no polynomials
                if self.recipe.mesh.order() == 1 {
                    self.push("moment outside", Density::Moment(side(body, brick::X_MAX), moment));
                }
            }
            if self.dice.chance(0.2) {
                let size = self.frame.strain * self.dice.either();
                let nodes = self.recipe.mesh.points().len();
                let strain = [size, size, size, 0.0, 0.0, 0.0];
                self.push(
                    "heat",
                    Density::Eigenstrain(strain, Some(body as u32), vec![1.0; nodes]),
                );
            }
        }
        if self.dice.chance(0.35) {
            let size = stress * self.dice.between(-0.3, 1.0);
            self.push("pressure outside", Density::Pressure(side(last, brick::X_MAX), size));
        }
        if !self.rings[0].solid() && self.dice.chance(0.25) {
            let size = stress * self.dice.between(0.0, 0.8);
            self.push("pressure inside", Density::Pressure(side(0, brick::X_MIN), size));
        }
    }

    fn springs(&mut self) -> Option<(FacetTag, Bed)> {
        if !self.dice.chance(0.25) {
            return None;
        }
        let last = self.rings.len() - 1;
        let tag = [brick::X_MAX, brick::Z_MAX, brick::X_MAX][self.dice.whole(0, 2)];
        // of one much stiffer than the body, forces are small displacements magnified
        let young = match &self.recipe.elastic[last] {
            Elastic::Isotropic(young, _) => *young,
            Elastic::Matrix(matrix) => matrix[3][3],
        };
        let size = young / self.frame.length * self.dice.decades(1e-3, 1e1);
        self.say("foundation");
        let bed = if self.dice.chance(0.6) {
            self.say("normal");
            Bed::Normal(size)
        } else {
            Bed::Components([0, 1, 2].map(|_| size * self.dice.between(0.1, 1.0)))
        };
        Some((side(last, tag), bed))
    }

    /// Few products, after which steps are halved.
    fn halving(&mut self) {
        let steps = self.recipe.clock.times().len();
        if steps > 1 && self.recipe.how.solver == Solver::Face && self.dice.chance(0.15) {
            self.recipe.how.halving = Some((self.dice.whole(15, 60), self.dice.whole(1, 4) as u32));
        }
    }

    /// Twice the depth of the chords of all curved sides that meet.
    fn bumps(&self) -> f64 {
        let mesh = &self.recipe.mesh;
        let mut deepest = 0.0_f64;
        for (body, ring) in self.rings.iter().enumerate() {
            for (tag, radius) in [brick::X_MIN, brick::X_MAX].into_iter().zip(ring.radii) {
                let facets = mesh
                    .facets()
                    .iter()
                    .filter(|f| f.tag == side(body, tag) && radius > 0.0);
                for facet in facets {
                    for k in 0..3 {
                        let [a, b] = [k, (k + 1) % 3].map(|k| mesh.points()[facet.nodes[k] as usize]);
                        let arm = sub(scale(0.5, add(a, b)), self.centre);
                        let off = sub(arm, scale(dot(arm, self.axis), self.axis));
                        deepest = deepest.max(radius - norm(off));
                    }
                }
            }
        }
        2.0 * deepest
    }
}
