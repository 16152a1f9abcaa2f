//! Where contact may happen, computed anew from facets: nodes of each contact with mean normals, areas, gaps, partners.
//!
//! Every contact of the scene is taken by itself: what the library makes of surfaces that share nodes is judged by what
//! each obstacle demands.

use crate::mechanics::{Mechanics, groups};
use crate::recipe::{Distance, Recipe, Touch};
use crate::vec3::{Vec3, add, dot, norm, scale, sub, unit};
use std::collections::BTreeMap;

/// Angle of a crease, degrees: facets that meet at an edge by more are different sides (documented default).
const CREASE: f64 = 60.0;

/// A node at an obstacle, along one direction.
#[derive(Debug, Clone)]
pub(crate) struct Spot {
    pub(crate) contact: usize,
    pub(crate) node: u32,
    pub(crate) partner: Option<u32>,
    /// Into the obstacle.
    pub(crate) normal: Vec3,
    pub(crate) area: f64,
    /// At rest.
    pub(crate) gap: f64,
}

/// The spots of all contacts.
pub(crate) fn spots(recipe: &Recipe, mechanics: &Mechanics) -> Vec<Spot> {
    let mut out = Vec::new();
    for (contact, touch) in recipe.touches.iter().enumerate() {
        let mut around: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (k, side) in mechanics.sides.iter().enumerate() {
            if touch.tags.contains(&side.tag) {
                side.nodes.iter().for_each(|n| around.entry(*n).or_default().push(k));
            }
        }
        for (node, facets) in around {
            let whole =
                touch.direction.is_some() || touch.partner.is_some() || matches!(touch.distance, Distance::Plane(..));
            let parts = if whole { vec![facets] } else { split(mechanics, &facets) };
            for part in parts {
                let sum = (part.iter()).fold([0.0; 3], |v, k| add(v, weighted(mechanics, *k, node)));
                let area = part.iter().map(|k| norm(mechanics.sides[*k].vector)).sum::<f64>() / 3.0;
                let normal = match (touch.direction, &touch.distance) {
                    (Some(direction), _) => direction,
                    (None, Distance::Plane(_, outward)) => scale(-1.0, *outward),
                    _ => unit(sum),
                };
                let found = touch
                    .partner
                    .map(|tag| partner(mechanics, tag, node, normal, area.sqrt()));
                let x = mechanics.points[node as usize];
                out.push(Spot {
                    contact,
                    node,
                    partner: found.map(|f| f.0),
                    normal,
                    area,
                    gap: gap(touch, x, found.map_or(0.0, |f| f.1)),
                });
            }
        }
    }
    out
}

/// The normal of a facet, as long as the sine of its angle at a node over the lengths of both edges there, but for a
/// factor that all facets have.
fn weighted(mechanics: &Mechanics, facet: usize, node: u32) -> Vec3 {
    let side = &mechanics.sides[facet];
    let place = |n: u32| mechanics.points[n as usize];
    let edges = side
        .nodes
        .iter()
        .filter(|n| **n != node)
        .map(|n| sub(place(*n), place(node)));
    edges.fold(side.vector, |v, edge| scale(1.0 / dot(edge, edge), v))
}

fn gap(touch: &Touch, x: Vec3, measured: f64) -> f64 {
    match &touch.distance {
        Distance::Touching => 0.0,
        Distance::Constant(gap) => *gap,
        Distance::Field(field) => field.value(x),
        Distance::Plane(point, outward) => dot(sub(x, *point), *outward),
        Distance::Measured => measured,
    }
}

/// Facets around a node, told apart where they meet at a crease.
fn split(mechanics: &Mechanics, facets: &[usize]) -> Vec<Vec<usize>> {
    let limit = CREASE.to_radians().cos();
    let mut pairs = Vec::new();
    for (i, a) in facets.iter().enumerate() {
        for (j, b) in facets.iter().enumerate().skip(i + 1) {
            let [p, q] = [a, b].map(|k| &mechanics.sides[*k]);
            let shared = p.nodes.iter().filter(|n| q.nodes.contains(n)).count();
            if shared == 2 && dot(unit(p.vector), unit(q.vector)) > limit {
                pairs.push((i as u32, j as u32));
            }
        }
    }
    let mut sides: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (k, group) in groups(facets.len(), pairs.into_iter()).iter().enumerate() {
        sides.entry(*group).or_default().push(facets[k]);
    }
    sides.into_values().collect()
}

/// The node of the other side on the normal of a node, and how far it is along it.
fn partner(
    mechanics: &Mechanics,
    tag: signorini::fem_mesh::FacetTag,
    node: u32,
    normal: Vec3,
    size: f64,
) -> (u32, f64) {
    let x = mechanics.points[node as usize];
    let sides = mechanics.sides.iter().filter(|s| s.tag == tag);
    let nodes = sides.flat_map(|s| s.nodes);
    let seen = nodes.map(|n| {
        let way = sub(mechanics.points[n as usize], x);
        let along = dot(way, normal);
        (n, along, norm(sub(way, scale(along, normal))))
    });
    // the nearest of those that lie about on the normal
    let near = seen.filter(|s| s.2 < 0.25 * size);
    let best = near.min_by(|a, b| a.1.hypot(a.2).total_cmp(&b.1.hypot(b.2)));
    best.map_or((u32::MAX, 0.0), |s| {
        // coordinates that coincide do so up to rounding
        let rounding = 1e-13 * norm(x).max(size);
        (s.0, if s.1.abs() > rounding { s.1 } else { 0.0 })
    })
}
