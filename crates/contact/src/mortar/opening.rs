//! Quadratic facets on which a gap opens linearly from the rim of their side, as under an inclined edge: their
//! multipliers are dual functions alone, which see such a gap as it is at the rim (docs/theory.md, section 8).

use crate::tolerances::{LINEAR, OPENING, SAME_NORMAL, TO_CREASE};
use crate::vec3::edge_cosine;
use signorini_fem_mesh::internal::facet_normals;
use signorini_fem_mesh::vec3::{area_vector, dot, norm, unit};
use signorini_fem_mesh::{Surface, TetMesh};
use std::collections::HashSet;

/// The rim of a side: its nodes where it ends, or its facets meet at a crease.
pub(crate) struct Rim<'a> {
    mesh: &'a TetMesh,
    surface: &'a Surface,
    nodes: HashSet<u32>,
}

impl<'a> Rim<'a> {
    /// `crease` in degrees.
    pub(crate) fn new(mesh: &'a TetMesh, surface: &'a Surface, crease: f64) -> Self {
        let vector = |nodes: &[u32; 3]| area_vector(&nodes.map(|n| mesh.points()[n as usize]));
        let facets: Vec<[u32; 3]> = surface
            .facets()
            .iter()
            .map(|f| mesh.facets()[*f as usize].nodes)
            .collect();
        let around = surface.around();
        let crease = crease.to_radians().cos() + TO_CREASE;
        // an edge goes on if some other facet around its first node has both ends and does not meet it at a crease
        let goes_on = |own: usize, [from, to]: [usize; 2]| {
            let others = around.of(surface.triangles()[own][from] as usize).iter();
            others
                .map(|&other| other as usize)
                .filter(|&other| other != own)
                .any(|other| {
                    let pair = [&facets[own], &facets[other]];
                    let shares = [from, to].iter().all(|&end| facets[other].contains(&facets[own][end]));
                    shares && edge_cosine(pair, pair.map(vector)).is_some_and(|cosine| cosine > crease)
                })
        };
        let mut nodes = HashSet::new();
        for own in 0..facets.len() {
            for ends in [[0, 1], [1, 2], [2, 0]] {
                if !goes_on(own, ends) {
                    nodes.extend(ends.map(|end| facets[own][end]));
                }
            }
        }
        Self { mesh, surface, nodes }
    }

    /// Whether gaps at the nodes of a quadratic facet (corners, then those on its edges 01, 12, 20; `None` where they
    /// are not known) open linearly from the rim. Plane facets of a curved side seem to, but the side does not: normals
    /// around them tell.
    pub(crate) fn opens(&self, nodes: [u32; 6], gaps: impl FnOnce() -> Option<[f64; 6]>) -> bool {
        let is_rim = [0, 1, 2].map(|k| self.nodes.contains(&nodes[k]));
        let Some(gaps) = is_rim.contains(&true).then(gaps).flatten() else {
            return false;
        };
        let [corners, mids] = [[0, 1, 2], [3, 4, 5]].map(|part| part.map(|k| gaps[k]));
        let least = corners.into_iter().fold(f64::INFINITY, f64::min);
        let range = corners.into_iter().fold(f64::NEG_INFINITY, f64::max) - least;
        let places = nodes.map(|n| self.mesh.points()[n as usize]);
        let vector = area_vector(&[places[0], places[1], places[2]]);
        let bends = (0..3).any(|k| (mids[k] - 0.5 * (corners[k] + corners[(k + 1) % 3])).abs() > LINEAR * range);
        let from_rim = (0..3).any(|k| is_rim[k] && corners[k] - least <= LINEAR * range);
        let rises = range > OPENING * norm(vector).sqrt();
        if !rises || bends || !from_rim {
            return false;
        }
        let normal = unit(vector);
        let is_plane = |k: usize| {
            let local = self.surface.local(nodes[k]);
            local.is_none_or(|local| dot(self.surface.frames()[local].normal, normal) > SAME_NORMAL)
        };
        facet_normals(&places).is_some() || (0..3).all(|k| is_rim[k] || is_plane(k))
    }
}
