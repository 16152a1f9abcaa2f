//! One to three bodies: bricks, graded, perturbed, sheared, bent, turned, one on the other.

use crate::dice::Dice;
use crate::vec3::{Vec3, add, cross, dot, norm, scale, sub, unit};
use signorini::prelude::*;

/// The bodies and what the rest of a scene is measured by.
pub(crate) struct World {
    pub(crate) mesh: TetMesh,
    /// Number of bodies; tags of body `b` are those of a brick and 10 `b`.
    pub(crate) count: usize,
    /// The body below each body but the first.
    pub(crate) below: Vec<usize>,
    /// Size of the bodies, m, and of what strains them.
    pub(crate) length: f64,
    pub(crate) strain: f64,
    /// Young's modulus, Pa.
    pub(crate) young: f64,
    /// Whether sides are plane.
    pub(crate) flat: bool,
    /// Whether the lower side of the first body has two tags, the second one [`SPLIT`].
    pub(crate) split: bool,
    pub(crate) words: Vec<String>,
}

/// Tag of a part of the lower side of the first body.
pub(crate) const SPLIT: FacetTag = FacetTag(7);

/// A side of a body.
pub(crate) fn side(body: usize, tag: FacetTag) -> FacetTag {
    FacetTag(tag.0 + 10 * body as u32)
}

impl World {
    /// Vector of the area of all facets with a tag.
    fn vector(&self, tag: FacetTag) -> Vec3 {
        let facets = (0..self.mesh.facets().len()).filter(|k| self.mesh.facets()[*k].tag == tag);
        facets.fold([0.0; 3], |sum, k| {
            let [a, b, c] = self.mesh.facet_points(k);
            add(sum, scale(0.5, cross(sub(b, a), sub(c, a))))
        })
    }

    /// Mean outward normal of a side.
    pub(crate) fn normal(&self, tag: FacetTag) -> Vec3 {
        let n = unit(self.vector(tag));
        // what is along an axis is so to the last digit
        n.map(|c| if c.abs() < 1e-12 { 0.0 } else { c })
    }

    pub(crate) fn area(&self, tag: FacetTag) -> f64 {
        norm(self.vector(tag))
    }

    /// Mean place of the nodes of a side.
    pub(crate) fn centre(&self, tag: FacetTag) -> Vec3 {
        let nodes = self.mesh.nodes_on(tag);
        let sum = nodes
            .iter()
            .fold([0.0; 3], |s, n| add(s, self.mesh.points()[*n as usize]));
        scale(1.0 / nodes.len() as f64, sum)
    }

    /// A unit vector along a side.
    pub(crate) fn along(&self, dice: &mut Dice, tag: FacetTag) -> Vec3 {
        let n = self.normal(tag);
        loop {
            let v = dice.vector();
            let t = sub(v, scale(dot(v, n), n));
            if norm(t) > 0.1 {
                return unit(t);
            }
        }
    }

    pub(crate) fn stress(&self) -> f64 {
        self.young * self.strain
    }

    /// A displacement that strains the bodies as much as loads do.
    pub(crate) fn way(&self) -> f64 {
        self.strain * self.length
    }
}

pub(crate) fn world(dice: &mut Dice) -> World {
    let length = if dice.chance(0.7) { 1.0 } else { dice.decades(1e-3, 1e2) };
    let young = if dice.chance(0.5) { 1e9 } else { dice.decades(1e4, 1e12) };
    let strain = dice.decades(1e-4, 1e-2);
    let count = match dice.whole(0, 9) {
        0..=4 => 1,
        5..=7 => 2,
        _ => 3,
    };
    let sizes = [dice.between(0.8, 3.0), dice.between(0.6, 1.5), dice.between(0.4, 1.5)].map(|l| l * length);
    let most = if count == 1 { 5 } else { 4 };
    let cells = [dice.whole(2, most), dice.whole(1, 3), dice.whole(1, 3)];
    let mut words = vec![format!("bodies={count}")];
    let mut first = Brick::new(sizes, cells);
    if count == 1 && dice.chance(0.25) {
        first = first.graded([0, 1, 2].map(|_| dice.between(0.5, 2.0)));
        words.push("graded".into());
    }
    if dice.chance(0.4) {
        first = first.perturbed(dice.between(0.02, 0.15), dice.seed());
    }
    let mut mesh = first.build().expect("brick");
    let bent = dice.chance(0.1);
    // "curved parts"
    let split = count == 1 && cells[0] >= 2 && !bent && dice.chance(0.12);
    if split {
        mesh = split_floor(mesh, sizes[0] * 0.5);
        words.push("split".into());
    }
    // where each body stands: on which one, from which cell along x, over how many
    let mut below = vec![0];
    let (mut tops, mut feet) = (vec![sizes[2]], vec![(0, cells[0])]);
    // sum of the numbers along x and y, in cells of the first body, of the nodes in which diagonals of its upper side
    // meet: even or odd
    let mut upper = vec![cells[2]];
    let twins = count == 3 && cells[0] >= 3 && dice.chance(0.4);
    for body in 1..count {
        let on = if twins { 0 } else { body - 1 };
        let (start, width) = feet[on];
        let (from, wide) = match (twins, body) {
            (true, 1) => (0, cells[0] / 2),
            (true, _) => (cells[0] - cells[0] / 2, cells[0] / 2),
            _ => (start, dice.whole(1, width)),
        };
        let gap = if bent || dice.chance(0.5) { 0.0 } else { dice.between(0.0, 0.5) * strain * length };
        let height = sizes[2] * dice.between(0.4, 1.0);
        let cell = sizes[0] / cells[0] as f64;
        let lengths = [wide as f64 * cell, sizes[1], height];
        let mut layers = dice.whole(1, 2);
        // facets match where diagonals do; upside down and of an odd number of layers it has the others below
        let over = !(from + upper[on]).is_multiple_of(2);
        if over {
            layers |= 1;
            words.push("upside down".into());
        }
        let brick = Brick::new(lengths, [wide, cells[1], layers]);
        let brick = brick
            .with_origin([from as f64 * cell, 0.0, 0.0])
            .build()
            .expect("brick");
        let brick = if over { upside_down(&brick, height) } else { brick };
        upper.push(if over { from } else { from + layers });
        let lifted = brick
            .map_points(|[x, y, z]| [x, y, tops[on] + gap + z])
            .expect("lifted");
        mesh = mesh.append(&lifted.map_tags(|t| side(body, t))).expect("bodies");
        below.push(on);
        tops.push(tops[on] + gap + height);
        feet.push((from, wide));
    }
    let scales = (length, young, strain);
    finish(dice, (mesh, below), scales, (bent, split), words, sizes)
}

/// Shears, bends, turns and moves all bodies together.
fn finish(
    dice: &mut Dice,
    (mesh, below): (TetMesh, Vec<usize>),
    (length, young, strain): (f64, f64, f64),
    (bent, split): (bool, bool),
    mut words: Vec<String>,
    sizes: Vec3,
) -> World {
    let count = below.len();
    let lean = if dice.chance(0.3) { 0.3 } else { 0.0 };
    // partners stay on their normals: bodies that touch shear along the surface only
    let up = if count == 1 { lean } else { 0.0 };
    let [a, b, c] = [lean, up, up].map(|l| l * dice.either());
    let radius = dice.between(2.0, 5.0) * sizes[0];
    let turn = if dice.chance(0.35) {
        rotation(dice.vector(), dice.between(0.2, 3.0))
    } else {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    };
    let shift = if dice.chance(0.2) { scale(10.0 * length, dice.vector()) } else { [0.0; 3] };
    let map = |[x, y, z]: Vec3| {
        let p = [x + a * y + b * z, y + c * z, z];
        let p = if bent {
            let (r, angle) = (radius + p[2], (p[0] - 0.5 * sizes[0]) / radius);
            [r * angle.sin(), p[1], r * angle.cos() - radius]
        } else {
            p
        };
        add(turn.map(|row| dot(row, p)), shift)
    };
    for (word, on) in [
        ("sheared", lean > 0.0),
        ("bent", bent),
        ("turned", turn[0][0] != 1.0),
        ("far", shift != [0.0; 3]),
    ] {
        if on {
            words.push(word.into());
        }
    }
    World {
        mesh: mesh.map_points(map).expect("mapped"),
        count,
        below,
        length,
        strain,
        young,
        flat: !bent,
        split,
        words,
    }
}

/// The image of a brick of a height in its middle plane.
fn upside_down(brick: &TetMesh, height: f64) -> TetMesh {
    let points = brick.points().iter().map(|[x, y, z]| [*x, *y, height - z]);
    let tets = brick.tets().iter().map(|[a, b, c, d]| [*b, *a, *c, *d]);
    let image = TetMesh::new(points.collect(), tets.collect(), brick.facets().to_vec());
    image.expect("image").map_tags(|tag| match tag {
        brick::Z_MIN => brick::Z_MAX,
        brick::Z_MAX => brick::Z_MIN,
        other => other,
    })
}

/// Gives the part of the lower side beyond `x` a tag of its own.
fn split_floor(mesh: TetMesh, x: f64) -> TetMesh {
    let facets = mesh.facets().iter().map(|f| {
        let centre: f64 = f.nodes.iter().map(|n| mesh.points()[*n as usize][0] / 3.0).sum();
        let tag = if f.tag == brick::Z_MIN && centre > x { SPLIT } else { f.tag };
        Facet { nodes: f.nodes, tag }
    });
    let facets: Vec<Facet> = facets.collect();
    // one side of it may be all
    let has = |tag| facets.iter().any(|f| f.tag == tag);
    assert!(has(SPLIT) && has(brick::Z_MIN));
    TetMesh::new(mesh.points().to_vec(), mesh.tets().to_vec(), facets).expect("mesh")
}

fn rotation(axis: Vec3, angle: f64) -> [Vec3; 3] {
    let k = unit(axis);
    let (sin, cos) = angle.sin_cos();
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|e| {
        let turned = add(scale(cos, e), scale(sin, cross(e, k)));
        add(turned, scale((1.0 - cos) * dot(k, e), k))
    })
}
