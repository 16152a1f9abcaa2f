//! Which facets of the other side cover a facet.

use super::cover::Cover;
use super::distances::{curve, gaps};
use super::opening::Rim;
use super::pieces::{Flat, Laid, Piece, Way, barycentric};
use crate::tolerances::{BENT, FACING, LAYERS, OVERLAP};
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use signorini_fem_mesh::internal::{ascending, facet_normals, shape_gradients};
use signorini_fem_mesh::vec3::{add, area_vector, centroid, dot, norm, scale, sub, unit};
use signorini_fem_mesh::{Surface, SurfaceFrame, TetMesh};
use std::collections::HashMap;

/// Distance over the size of a facet up to which others are looked for first: gaps are mostly small.
const NEAR: f64 = 2.0;
/// Factor by which that grows.
const FARTHER: f64 = 4.0;

type Corners = [[f64; 3]; 3];

/// Heights of a curve over the edges of facets, by their nodes, ascending, m; not a number where they are not known.
pub(crate) type Arcs = HashMap<[u32; 2], f64>;

/// A triangle of a surface: mesh nodes of its corners, and in a mesh of order 2 those on its edges 01, 12, 20.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Triangle {
    pub(super) nodes: [u32; 3],
    mids: Option<[u32; 3]>,
    /// The tetrahedron behind it.
    tet: u32,
}

impl Triangle {
    fn corners(&self, mesh: &TetMesh) -> Corners {
        self.nodes.map(|n| mesh.points()[n as usize])
    }

    /// All nodes in a mesh of order 2.
    fn quadratic(&self) -> Option<[u32; 6]> {
        let ([a, b, c], [ab, bc, ca]) = (self.nodes, self.mids?);
        Some([a, b, c, ab, bc, ca])
    }

    fn normals(&self, mesh: &TetMesh, plane: &Plane) -> Normals {
        let places = self.quadratic().map(|nodes| nodes.map(|n| mesh.points()[n as usize]));
        let curved = places.and_then(|places| facet_normals(&places));
        curved.map_or(Normals::Plane(plane.frame.normal), Normals::Curved)
    }

    /// Itself in its own plane.
    fn flat(&self, mesh: &TetMesh, plane: &Plane) -> Flat {
        let height = |n: u32| plane.lay(mesh.points()[n as usize]).1;
        Flat {
            corners: plane.corners,
            nodes: self.quadratic(),
            bend: self.bend(mesh, plane, &plane.corners),
            heights: self.mids.map_or([0.0; 3], |mids| mids.map(height)),
        }
    }

    /// The way to a facet in a plane; `None` if both are in it.
    fn way(&self, mesh: &TetMesh, plane: &Plane, (own, heights): (&Flat, &[f64; 6])) -> Option<Way> {
        let mut nodes: Vec<u32> = self.nodes.into_iter().chain(self.mids.into_iter().flatten()).collect();
        if heights.iter().chain(&own.heights).all(|h| h.abs() <= BENT * plane.size) {
            return None;
        }
        let tet = self.tet as usize;
        let corners = mesh.tets()[tet];
        let all: Vec<u32> = corners
            .into_iter()
            .chain(mesh.mids().get(tet).copied().into_iter().flatten())
            .collect();
        let behind: Vec<u32> = all.iter().copied().filter(|n| !nodes.contains(n)).collect();
        let mut others = [0; 4];
        others.iter_mut().zip(&behind).for_each(|(other, node)| *other = *node);
        nodes.extend(behind);
        let slopes = self.nodes.map(|corner| {
            let at = corners.map(|n| f64::from(u8::from(n == corner)));
            let gradients = shape_gradients(mesh, tet, &at);
            let mut slopes = [0.0; 10];
            for (slope, node) in slopes.iter_mut().zip(&nodes) {
                let place = all.iter().position(|n| n == node).unwrap_or(0);
                *slope = dot(gradients[place], plane.frame.normal);
            }
            slopes
        });
        Some(Way { nodes: others, slopes })
    }

    /// How far its mid-nodes are from the middles of its corners in a plane; `None` if they are there.
    fn bend(&self, mesh: &TetMesh, plane: &Plane, corners: &[[f64; 2]; 3]) -> Option<[[f64; 2]; 3]> {
        let mids = self.mids?.map(|n| plane.lay(mesh.points()[n as usize]).0);
        let bend = [0, 1, 2].map(|k| {
            let ends = [corners[k], corners[(k + 1) % 3]];
            [0, 1].map(|c| mids[k][c] - 0.5 * (ends[0][c] + ends[1][c]))
        });
        let is_bent = bend.iter().flatten().any(|d| d.abs() > BENT * plane.size);
        is_bent.then_some(bend)
    }
}

/// The triangles of a surface, each from its smallest node on, ascending: whatever the order of the facets in a file,
/// sums have the same bits.
pub(super) fn in_order(mesh: &TetMesh, surface: &Surface) -> Vec<Triangle> {
    let turned = surface.facets().iter().map(|&facet| {
        let nodes = mesh.facets()[facet as usize].nodes;
        let first = (0..3).min_by_key(|&k| nodes[k]).unwrap_or(0);
        let turn = |of: [u32; 3]| [0, 1, 2].map(|k| of[(first + k) % 3]);
        Triangle {
            nodes: turn(nodes),
            mids: mesh.facet_mids(facet as usize).map(turn),
            tet: mesh.facet_owner(facet as usize) as u32,
        }
    });
    let mut triangles: Vec<Triangle> = turned.collect();
    triangles.sort_unstable();
    triangles
}

/// The facets of the other side in a tree of their boxes.
struct OtherSide<'a> {
    triangles: Vec<Triangle>,
    tree: RTree<GeomWithData<Rectangle<[f64; 3]>, u32>>,
    corners: Vec<Corners>,
    normals: Vec<[f64; 3]>,
    /// Heights of the curves over edges of both sides, by their nodes, m.
    arcs: &'a Arcs,
}

/// A facet in its own plane: origin in the middle.
struct Plane {
    origin: [f64; 3],
    frame: SurfaceFrame,
    corners: [[f64; 2]; 3],
    /// Root of its area, m.
    size: f64,
}

/// The normal of a plane facet, or those of a curved one at all its nodes.
#[derive(Debug, Clone)]
pub(super) enum Normals {
    Plane([f64; 3]),
    Curved([[f64; 3]; 6]),
}

/// The rim of the first side, from which gaps may open, and the arcs over edges of both.
pub(crate) type Bends<'a> = (Option<&'a Rim<'a>>, &'a Arcs);

/// What a facet sees of the other side.
#[derive(Debug, Clone)]
pub(super) struct Seen {
    pub(super) cover: Cover,
    pub(super) normals: Normals,
    /// Distances of the corners from the curve that facets of the other side stand for, m, where these are bent.
    pub(super) curve: Option<[f64; 3]>,
}

/// The cover of each facet of a surface, by the nodes of the other one; the normals of the facets beside it.
///
/// What is farther away than four times the largest distance found anywhere is not looked for, unless nothing is found:
/// behind bodies other sides face each other, too. Displacements of the other side are those where they are, or [on the
/// facet](Way) if it is `tied`. Facets on which a gap opens from the `rim` have dual functions, multipliers of those
/// `within` stay within their cover; facets of the other side are chords of `arcs`.
pub(super) fn covers(
    mesh: &TetMesh,
    triangles: &[Triangle],
    other: &Surface,
    (tied, within): (bool, &(dyn Fn([u32; 3]) -> bool + Sync)),
    (rim, arcs): Bends<'_>,
) -> Vec<Option<Seen>> {
    let other = OtherSide::new(mesh, other, arcs);
    let planes: Vec<Option<Plane>> = triangles.iter().map(|t| Plane::new(&t.corners(mesh))).collect();
    let size = planes.iter().flatten().map(|p| p.size).fold(0.0, f64::max);
    let most = other.farthest(planes.iter().flatten());
    let mut out: Vec<Option<Seen>> = vec![None; planes.len()];
    let mut reach = NEAR * size;
    loop {
        let found: Vec<_> = (0..planes.len())
            .into_par_iter()
            .filter(|&k| out[k].is_none())
            .filter_map(|k| {
                let plane = planes[k].as_ref()?;
                let own = triangles[k].flat(mesh, plane);
                // a steep facet may go on beyond
                let reaches = [reach, reach + FARTHER * plane.size];
                let pieces = other.pieces(mesh, (plane, tied.then_some(&own)), reaches);
                let farthest = pieces.iter().map(|p| p.1.abs()).fold(0.0, f64::max);
                let pieces: Vec<Piece> = pieces.into_iter().map(|p| p.0).collect();
                let opens = |rim: &Rim<'_>| Some(rim.opens(own.nodes?, || gaps(&own, &pieces)));
                let within = Some(triangles[k].nodes).filter(|nodes| within(*nodes));
                let cover = Cover::new(&own, &pieces, rim.and_then(opens) == Some(true), within);
                let seen = cover.map(|cover| Seen {
                    cover,
                    normals: triangles[k].normals(mesh, plane),
                    curve: curve(&own.corners, other.arcs_of(triangles[k].nodes), &pieces),
                });
                Some((k, seen, farthest))
            })
            .collect();
        let mut farthest = None::<f64>;
        for (k, cover, distance) in found {
            if cover.is_some() {
                out[k] = cover;
                farthest = Some(farthest.map_or(distance, |f| f.max(distance)));
            }
        }
        let any = out.iter().any(Option::is_some);
        let next = match farthest {
            // the next facets may be a little farther away
            Some(farthest) => FARTHER * farthest.max(size),
            None if !any => FARTHER * reach,
            None => return out,
        };
        if reach >= most {
            return out;
        }
        reach = next.max(reach * NEAR).min(most);
    }
}

impl Plane {
    fn new(corners: &Corners) -> Option<Self> {
        let vector = area_vector(corners);
        let frame = SurfaceFrame::from_normal(vector)?;
        let mut plane = Self {
            origin: centroid(corners),
            frame,
            corners: [[0.0; 2]; 3],
            size: norm(vector).sqrt(),
        };
        plane.corners = corners.map(|c| plane.lay(c).0);
        Some(plane)
    }

    /// A point in the plane, and its distance from it along the normal.
    fn lay(&self, point: [f64; 3]) -> ([f64; 2], f64) {
        let way = sub(point, self.origin);
        // (T2, T1, nu) is right-handed
        let [first, second] = self.frame.tangential_part(way);
        ([second, first], dot(way, self.frame.normal))
    }

    fn space(&self, [second, first]: [f64; 2]) -> [f64; 3] {
        add(self.origin, self.frame.vector(0.0, [first, second]))
    }
}

impl<'a> OtherSide<'a> {
    fn new(mesh: &TetMesh, surface: &Surface, arcs: &'a Arcs) -> Self {
        let triangles = in_order(mesh, surface);
        let corners: Vec<Corners> = triangles.iter().map(|t| t.corners(mesh)).collect();
        let boxes = corners.iter().zip(0..);
        let boxes = boxes.map(|(c, k)| GeomWithData::new(Rectangle::from_aabb(AABB::from_points(c)), k));
        Self {
            tree: RTree::bulk_load(boxes.collect()),
            normals: corners.iter().map(|c| unit(area_vector(c))).collect(),
            corners,
            triangles,
            arcs,
        }
    }

    /// Those of the edges 01, 12, 20 of a facet.
    fn arcs_of(&self, [a, b, c]: [u32; 3]) -> [f64; 3] {
        [[a, b], [b, c], [c, a]].map(|edge| self.arcs.get(&ascending(edge)).copied().unwrap_or(0.0))
    }

    /// A distance beyond which no facet can be.
    fn farthest<'p>(&self, planes: impl Iterator<Item = &'p Plane>) -> f64 {
        let envelope = self.tree.root().envelope();
        let (mut low, mut high) = (envelope.lower(), envelope.upper());
        for plane in planes {
            for c in 0..3 {
                low[c] = low[c].min(plane.origin[c] - plane.size);
                high[c] = high[c].max(plane.origin[c] + plane.size);
            }
        }
        norm(sub(high, low))
    }

    /// The parts of facets that lie over a facet within the distance `far`, with their signed distance, each place
    /// once; none where none is within `near`.
    fn pieces(
        &self,
        mesh: &TetMesh,
        (plane, tied): (&Plane, Option<&Flat>),
        [near, far]: [f64; 2],
    ) -> Vec<(Piece, f64)> {
        let own = plane.corners.map(|c| plane.space(c));
        let ways = [far, -far].map(|by| scale(by, plane.frame.normal));
        let swept: Vec<[f64; 3]> = ways.iter().flat_map(|&way| own.map(|c| add(c, way))).collect();
        let boxes = self.tree.locate_in_envelope_intersecting(&AABB::from_points(&swept));
        let mut numbers: Vec<u32> = boxes.map(|found| found.data).collect();
        numbers.sort_unstable();
        let mut found: Vec<(Piece, f64)> = numbers
            .iter()
            .filter_map(|&k| self.piece(mesh, (plane, tied), k, far))
            .collect();
        if found.iter().all(|(_, distance)| distance.abs() > near) {
            return Vec::new();
        }
        // of several layers the nearest
        let whole = plane.size * plane.size;
        let is_over = |(a, near): &(Piece, f64), (b, far): &(Piece, f64)| {
            let apart = (near - far).abs() > LAYERS * plane.size;
            apart && (a.closest(b.middle()).0 == 0.0 || b.closest(a.middle()).0 == 0.0)
        };
        let several = (1..found.len()).any(|k| found[..k].iter().any(|other| is_over(other, &found[k])));
        if !several && found.iter().map(|(piece, _)| piece.area).sum::<f64>() <= whole * (1.0 + OVERLAP) {
            return found;
        }
        found.sort_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let mut covered = 0.0;
        let mut kept: Vec<(Piece, f64)> = Vec::with_capacity(found.len());
        for one in found {
            let fits = covered + one.0.area <= whole * (1.0 + OVERLAP);
            if fits && !kept.iter().any(|other| is_over(other, &one)) {
                covered += one.0.area;
                kept.push(one);
            }
        }
        kept
    }

    fn piece(
        &self,
        mesh: &TetMesh,
        (plane, tied): (&Plane, Option<&Flat>),
        facet: u32,
        reach: f64,
    ) -> Option<(Piece, f64)> {
        let facet = facet as usize;
        if -dot(self.normals[facet], plane.frame.normal) < FACING {
            return None;
        }
        // seen from the other side it turns the other way round
        let [a, b, c] = self.corners[facet];
        let seen = [a, c, b].map(|corner| plane.lay(corner));
        let [i, j, k] = self.triangles[facet].nodes;
        let mut laid = Laid {
            corners: seen.map(|s| s.0),
            nodes: [i, k, j],
            mids: self.triangles[facet].mids.map(|[ij, jk, ki]| [ki, jk, ij]),
            bend: None,
            heights: [seen[0].1, seen[1].1, seen[2].1, 0.0, 0.0, 0.0],
            arcs: self.arcs_of([i, k, j]),
            way: None,
        };
        for (height, mid) in laid.heights[3..].iter_mut().zip(laid.mids.into_iter().flatten()) {
            *height = plane.lay(mesh.points()[mid as usize]).1;
        }
        let seen_from = Triangle {
            nodes: laid.nodes,
            mids: laid.mids,
            tet: self.triangles[facet].tet,
        };
        laid.bend = seen_from.bend(mesh, plane, &laid.corners);
        laid.way = tied.and_then(|own| seen_from.way(mesh, plane, (own, &laid.heights)));
        let piece = Piece::new(&plane.corners, laid)?;
        let shape = barycentric(&laid.corners, piece.middle());
        let distance: f64 = shape.iter().zip(&seen).map(|(l, s)| l * s.1).sum();
        (distance.abs() <= reach).then_some((piece, distance))
    }
}
