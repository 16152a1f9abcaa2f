//! Scenes of round bodies meshed apart: discs and washers on one another, whose rims quadratic edges follow, and
//! sleeves around one another, whose sides are curved out of their plane. They are tied or touch, and may be carried
//! along or turned as a whole.

use super::bodies::side;
use super::{Frame, bare, settings};
use crate::apart::{Apart, Pair, Rest, Rock, Shape};
use crate::dice::Dice;
use crate::recipe::{Fixed, Hold, Law, Where};
use crate::vec3::{Vec3, add, cross, scale};
use signorini::fem_mesh::mesh::{drop_unused_nodes, merge_nodes};
use signorini::prelude::*;
use std::f64::consts::TAU;

#[derive(Clone, Copy, PartialEq)]
enum Form {
    Discs,
    Washers,
    Sleeves,
}

/// Where a body is, before the whole is turned: radii, heights, centre.
#[derive(Clone, Copy)]
struct Round {
    radii: [f64; 2],
    heights: [f64; 2],
    centre: [f64; 2],
    phase: f64,
}

impl Round {
    /// The place of a point of the unit cube: radius, angle, height; in a disc the cube's square is bulged.
    fn place(&self, form: Form, [x, y, z]: Vec3) -> Vec3 {
        let ([low, high], [below, above]) = (self.radii, self.heights);
        let (sin, cos) = self.phase.sin_cos();
        let [x, y] = if form == Form::Discs {
            let [s, t] = [2.0 * x - 1.0, 2.0 * y - 1.0];
            let bulge = |a: f64, b: f64| high * a * (1.0 - 0.35 * b * b).sqrt();
            [bulge(s, t), bulge(t, s)]
        } else {
            let (r, (sin, cos)) = (low + x * (high - low), (TAU * y).sin_cos());
            [r * cos, r * sin]
        };
        let [x, y] = [cos * x - sin * y, sin * x + cos * y];
        [x + self.centre[0], y + self.centre[1], below + z * (above - below)]
    }
}

/// Makes a ring of a bent bar: nodes at both ends are the same ones.
pub(super) fn close(mesh: &TetMesh, place: impl Fn(Vec3) -> Vec3, near: f64) -> TetMesh {
    let open = |f: &&Facet| f.tag != brick::Y_MIN && f.tag != brick::Y_MAX;
    let mut facets: Vec<Facet> = mesh.facets().iter().filter(open).copied().collect();
    let mut points: Vec<Vec3> = mesh.points().iter().map(|p| place(*p)).collect();
    if mesh.order() == 2 {
        let mut tets = mesh.quadratic_tets();
        merge_nodes(&points, &mut tets, &mut facets, near);
        drop_unused_nodes(&mut points, &mut tets, &mut facets);
        return TetMesh::quadratic(points, tets, facets).expect("ring");
    }
    let mut tets = mesh.tets().to_vec();
    merge_nodes(&points, &mut tets, &mut facets, near);
    drop_unused_nodes(&mut points, &mut tets, &mut facets);
    TetMesh::new(points, tets, facets).expect("ring")
}

/// Area of a side, of straight facets.
pub(super) fn area(mesh: &TetMesh, tag: FacetTag) -> f64 {
    let facets = (0..mesh.facets().len()).filter(|k| mesh.facets()[*k].tag == tag);
    let one = |k| {
        let [a, b, c] = mesh.facet_points(k);
        0.5 * crate::vec3::norm(cross(crate::vec3::sub(b, a), crate::vec3::sub(c, a)))
    };
    facets.map(one).sum()
}

/// The scene with a number.
pub(crate) fn round(seed: u64, number: u64) -> Apart {
    let mut dice = Dice::new(seed ^ 0x0f1e, number);
    let dice = &mut dice;
    let frame = Frame::new(dice);
    let form = [Form::Discs, Form::Washers, Form::Sleeves][dice.whole(0, 2)];
    let order = if dice.chance(0.4) { 2 } else { 1 };
    let mut words = vec![
        ["discs", "washers", "sleeves"][form as usize].into(),
        format!("order {order}"),
    ];
    let count = if dice.chance(0.75) { 2 } else { 3 };
    let soft = frame.way / frame.stress;

    let outer = frame.length * dice.between(0.5, 1.0);
    let mut bodies = vec![Round {
        radii: [outer * dice.between(0.3, 0.7), outer],
        heights: [0.0, frame.length * dice.between(0.2, 0.8)],
        centre: [0.0; 2],
        phase: 0.0,
    }];
    let mut cells = vec![match form {
        Form::Discs => [dice.whole(2, 4), dice.whole(2, 4), dice.whole(1, 2)],
        _ => [dice.whole(1, 2), 2 * dice.whole(4, 8 / order + 2), dice.whole(1, 2)],
    }];
    for body in 1..count {
        let under = bodies[body - 1];
        let mut own = under;
        let same = dice.chance(0.3);
        own.phase = if same { 0.0 } else { dice.between(0.0, 1.0) };
        let height = under.heights[1] - under.heights[0];
        if form == Form::Sleeves {
            own.radii = [under.radii[1], under.radii[1] * dice.between(1.2, 1.6)];
            if !same {
                own.heights = [dice.between(-0.2, 0.3), dice.between(0.6, 1.2)].map(|h| under.heights[0] + h * height);
            }
        } else {
            own.heights = [
                under.heights[1],
                under.heights[1] + frame.length * dice.between(0.2, 0.6),
            ];
            if !same {
                own.radii[0] *= dice.between(0.7, 1.1);
                own.radii[1] = (own.radii[1] * dice.between(0.7, 1.2)).max(1.2 * own.radii[0].max(under.radii[0]));
                let far = 0.3 * (own.radii[1] - own.radii[0]).min(under.radii[1] - under.radii[0]);
                own.centre = own.centre.map(|c| c + far * dice.either());
            }
        }
        words.push(if same { "alike" } else { "other" }.into());
        bodies.push(own);
        let ratio = dice.decades(0.5, 2.0);
        let below = cells[body - 1];
        let scaled = |n: usize, most: usize| ((n as f64 * ratio).round() as usize).clamp(1, most);
        cells.push(match form {
            _ if same && dice.chance(0.5) => below,
            Form::Discs => [scaled(below[0], 5), scaled(below[1], 5), dice.whole(1, 2)],
            _ => [
                scaled(below[0], 2),
                (2 * scaled(below[1] / 2, 12 / order)).max(8),
                dice.whole(1, 2),
            ],
        });
    }
    let (mut mesh, mut elastic, mut meshes) = (None::<TetMesh>, Vec::new(), Vec::new());
    for (body, (round, cells)) in bodies.iter().zip(&cells).enumerate() {
        let own = Brick::new([1.0; 3], *cells).build().expect("brick");
        let own = if order == 2 { own.raise_order().expect("order 2") } else { own };
        let place = |p| frame.turn.place(round.place(form, p));
        let own = match form {
            Form::Discs => own.map_points(place).expect("places"),
            _ => close(&own, place, 1e-9 * frame.length),
        };
        let own = own.map_tags(|t| side(body, t));
        let tets = own.tets().len();
        let own = own.with_regions(vec![body as u32; tets]).expect("regions");
        mesh = Some(mesh.map_or_else(|| own.clone(), |m| m.append(&own).expect("bodies")));
        meshes.push(own);
        elastic.push(frame.elastic(dice, body, 0.4, &mut words));
    }
    let gives_way = |dice: &mut Dice, words: &mut Vec<String>| {
        if !dice.chance(0.2) {
            return [0.0; 2];
        }
        let compliance = [0, 1].map(|_| if dice.chance(0.7) { soft * dice.decades(1e-3, 10.0) } else { 0.0 });
        words.push(format!("gives way {:.0e} {:.0e}", compliance[0], compliance[1]));
        compliance
    };
    let (inner, outer) = match form {
        Form::Sleeves => (brick::X_MIN, brick::X_MAX),
        _ => (brick::Z_MIN, brick::Z_MAX),
    };
    let mut pairs = Vec::new();
    for body in 1..count {
        let mut sides = [side(body, inner), side(body - 1, outer)];
        let common = area(&meshes[body], sides[0]).min(area(&meshes[body - 1], sides[1]));
        if dice.chance(0.5) {
            sides.swap(0, 1);
        }
        let tied = dice.chance(0.4);
        words.push(if tied { "tied" } else { "touching" }.into());
        let law = if tied { Law::None } else { frame.law(dice) };
        pairs.push(Pair {
            sides,
            tied,
            rest: Rest::Measured(0.0),
            growth: None,
            law,
            axis: None,
            // edges that are bent outward hold more
            common: [1.001, 1.25][order - 1] * common,
            whole: false,
            compliance: if tied { [0.0; 2] } else { gives_way(dice, &mut words) },
            motion: (tied && dice.chance(0.4)).then(|| {
                words.push("moving tie".into());
                (scale(0.3 * frame.way, dice.vector()), frame.shaft.course(dice))
            }),
        });
    }
    let mesh = mesh.expect("a body");
    let mut recipe = bare(dice, (mesh, elastic), frame.clock.clone(), words);
    let mut rocks = Vec::new();
    // the first body is held below, which may carry it along or turn it, or lies on a plane
    let tag = |body: usize, tag: FacetTag| Where::Tag(side(body, tag));
    let free = pairs.iter().all(|p| !p.tied);
    if form == Form::Sleeves || dice.chance(0.7) {
        let mut hold = Hold {
            place: tag(
                0,
                if form == Form::Washers && dice.chance(0.5) { brick::X_MIN } else { brick::Z_MIN },
            ),
            fixed: Fixed::All,
            motion: None,
        };
        if dice.chance(0.4) {
            let (by, spin) = (
                scale(frame.way * dice.decades(0.1, 30.0), dice.vector()),
                scale(frame.strain * dice.decades(0.1, 30.0), dice.vector()),
            );
            let places = hold
                .nodes(&recipe.mesh)
                .into_iter()
                .map(|n| recipe.mesh.points()[n as usize]);
            let values = if dice.chance(0.5) || !free {
                recipe.words.push("carried and turned".into());
                places.map(|x| add(by, cross(spin, x))).collect()
            } else {
                recipe.words.push("carried".into());
                vec![by]
            };
            hold.motion = Some((values, frame.shaft.course(dice)));
        }
        recipe.holds.push(hold);
    } else {
        let law = if dice.chance(0.3) { Law::None } else { Law::Coulomb(dice.between(0.2, 0.8)) };
        recipe
            .words
            .push(if law.is_some() { "on a plane" } else { "on a smooth plane" }.into());
        rocks.push(Rock {
            side: side(0, brick::Z_MIN),
            shape: Shape::Plane(frame.turn.place([0.0; 3]), frame.turn.way([0.0, 0.0, 1.0])),
            motion: None,
            turn: None,
            growth: None,
            axis: None,
            law,
            compliance: gives_way(dice, &mut recipe.words),
        });
    }
    let last = count - 1;
    let top = side(last, brick::Z_MAX);
    let slant = if dice.chance(0.4) { 0.0 } else { 0.4 };
    let down = frame.turn.way([slant * dice.either(), slant * dice.either(), -1.0]);
    match dice.whole(0, 9) {
        0..=2 => frame.moved(dice, top, down, &mut recipe),
        3..=6 => frame.loaded(dice, top, down, &mut recipe),
        _ => {
            recipe.words.push("loose, plane above".into());
            let place = frame.turn.place([0.0, 0.0, bodies[last].heights[1]]);
            rocks.push(Rock {
                side: top,
                shape: Shape::Plane(place, frame.turn.way([0.0, 0.0, -1.0])),
                motion: Some((scale(frame.way, down), frame.shaft.course(dice))),
                turn: None,
                growth: None,
                axis: None,
                law: frame.law(dice),
                compliance: gives_way(dice, &mut recipe.words),
            });
        }
    }
    let side_step = bodies.iter().zip(&cells).map(|(b, c)| match form {
        Form::Sleeves => b.radii[1] * (1.0 - (0.5 * TAU / c[1] as f64).cos()),
        _ => 0.0,
    });
    let bumps = 2.0 * side_step.fold(0.0, f64::max);
    settings::describe(&mut recipe);
    Apart {
        recipe,
        pairs,
        rocks,
        bumps,
        ground: None,
        grips: Vec::new(),
    }
}
