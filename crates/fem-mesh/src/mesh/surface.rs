//! Surfaces with nodal normals, frames and areas, flat or curved.

use crate::quadrature;
use crate::tables::{Lists, distinct};
use crate::tolerances::{NEARLY_PARALLEL, NO_NORMAL, NO_WEIGHT};
use crate::vec3::{self, Vec3, add, cross, dot, norm, scale, sub};

use super::curved::{curved_facet, facet_normals, facet_shape};
use super::tet_mesh::{FacetTag, TetMesh, tag_list};

/// An orthonormal frame on a surface: the outward normal nu and two tangents T1, T2.
///
/// T1 is the x axis projected into the tangent plane (the y axis where the normal is within 0.6
/// degrees of the x axis), and T2 = T1 x nu. So (T1, nu, T2) is right-handed, and the normal
/// (0, 0, -1) has T1 = (1, 0, 0), T2 = (0, 1, 0), as the paper uses it on the brick.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SurfaceFrame {
    /// Outward unit normal.
    pub normal: [f64; 3],
    /// Unit tangents T1, T2.
    pub tangents: [[f64; 3]; 2],
}

impl SurfaceFrame {
    /// The frame of a normal of any length; `None` if it is zero or not finite.
    pub fn from_normal(normal: [f64; 3]) -> Option<Self> {
        let normal = unit(normal)?;
        let axis = if normal[1].hypot(normal[2]) > NEARLY_PARALLEL {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        let first = unit(sub(axis, scale(dot(axis, normal), normal)))?;
        let second = unit(cross(first, normal))?;
        Some(Self {
            normal,
            tangents: [first, second],
        })
    }

    /// Normal component of a vector.
    pub fn normal_part(&self, v: [f64; 3]) -> f64 {
        dot(self.normal, v)
    }

    /// Components along T1 and T2.
    pub fn tangential_part(&self, v: [f64; 3]) -> [f64; 2] {
        self.tangents.map(|t| dot(t, v))
    }

    /// The vector with the given components.
    pub fn vector(&self, normal: f64, tangential: [f64; 2]) -> [f64; 3] {
        let [t1, t2] = self.tangents;
        add(
            scale(normal, self.normal),
            add(scale(tangential[0], t1), scale(tangential[1], t2)),
        )
    }
}

/// The unit vector of a direction, with positive zeros.
fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let largest = v.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    if !vec3::is_finite(v) || largest == 0.0 {
        return None;
    }
    let v = v.map(|x| x / largest);
    let length = norm(v);
    Some(v.map(|x| x / length + 0.0))
}

errors! {
    /// A surface that cannot be used.
    #[derive(Clone, PartialEq, Eq)]
    SurfaceError {
        NoTags = "the surface has no tag; name at least one part of the boundary";
        UnknownTag { tag: FacetTag, known: Vec<FacetTag> } =
            "no facet has {tag}; the mesh has {}", tag_list(known);
        RepeatedTag { tag: FacetTag } = "{tag} is named twice; name it once";
        NoNormal { node: u32 } =
            "node {node} has no normal: those of its triangles cancel, as on a blade tagged on both sides; tag one \
            side only, or split the surface there";
    }
}

/// A part of the boundary with what contact needs at its nodes, the corners of its triangles.
///
/// The area of a node is a third of the triangles around it. Its normal is the mean of theirs, each weighted by the sine
/// of its angle over the lengths of both edges: exact on spheres and, at rims too, on cylinders in grids (N. Max, J.
/// Graphics Tools 4, 1999). In a mesh of order 2 the area is the integral of the linear hat function of the node, the
/// same where edges are straight, and the normal on curved facets the mean that displacements have ([`Surface::mean`]),
/// in which mid-nodes have a share: that where the force of the node acts, at a rim, too.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    facets: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    nodes: Vec<u32>,
    areas: Vec<f64>,
    frames: Vec<SurfaceFrame>,
    /// Integrals over each triangle in a mesh of order 2.
    integrals: Vec<FacetIntegrals>,
    /// Nodes of the mesh.
    mesh_nodes: usize,
}

/// The share of dual functions in the weights of means (docs/theory.md, section 8).
const HALF: f64 = 0.5;

/// Integrals over a quadratic facet.
#[derive(Debug, Clone, PartialEq)]
struct FacetIntegrals {
    nodes: [u32; 6],
    /// Of the weight of each corner times the normal, in plane facets of its hat function.
    normals: [Vec3; 3],
    /// Of the hat function of each corner.
    areas: [f64; 3],
    /// Of the weight of each corner ([`Surface::mean`]) times the shape function of each node.
    products: [[f64; 6]; 3],
}

impl FacetIntegrals {
    /// `share` is that of the dual functions in the weight of each corner, the other one that of hat functions.
    fn new(mesh: &TetMesh, facet: usize, share: f64) -> Self {
        let points = mesh.quadratic_facet_points(facet);
        let mut out = Self {
            nodes: mesh.quadratic_facet(facet),
            normals: [[0.0; 3]; 3],
            areas: [0.0; 3],
            products: [[0.0; 6]; 3],
        };
        let (mut mass, mut hats) = ([[0.0; 3]; 3], [[0.0; 6]; 3]);
        for (l, weight) in quadrature::triangle() {
            let ((_, normal), shape) = (curved_facet(&points, &l), facet_shape(&l));
            for i in 0..3 {
                let hat = weight * l[i];
                out.normals[i] = add(out.normals[i], scale(hat, normal));
                out.areas[i] += hat * norm(normal);
                (0..3).for_each(|k| mass[i][k] += hat * norm(normal) * l[k]);
                (0..6).for_each(|k| hats[i][k] += hat * norm(normal) * shape[k]);
            }
        }
        // the dual functions are the rows of diag(areas) mass^-1 times the hat functions
        let [a, b, c] = mass;
        let inverse = [cross(b, c), cross(c, a), cross(a, b)].map(|v| scale(1.0 / dot(a, cross(b, c)), v));
        let (plane, [u, v, w]) = (facet_normals(&points).is_none(), out.normals);
        for i in 0..3 {
            let dual = inverse.map(|row| out.areas[i] * row[i]);
            if !plane {
                let sum = add(scale(dual[0], u), add(scale(dual[1], v), scale(dual[2], w)));
                out.normals[i] = add(scale(1.0 - share, out.normals[i]), scale(share, sum));
            }
            let product = |k: usize| (0..3).map(|j| dual[j] * hats[j][k]).sum::<f64>();
            out.products[i] = std::array::from_fn(|k| (1.0 - share) * hats[i][k] + share * product(k));
        }
        out
    }
}

impl Surface {
    /// The surface of all facets with one of the tags.
    ///
    /// # Errors
    /// [`SurfaceError`] if a tag is unknown or repeated, or a node has no normal.
    pub fn new(mesh: &TetMesh, tags: &[FacetTag]) -> Result<Self, SurfaceError> {
        check_tags(mesh, tags)?;
        let facets: Vec<u32> = (0..mesh.facets().len() as u32)
            .filter(|&f| tags.contains(&mesh.facets()[f as usize].tag))
            .collect();
        let global = |&f: &u32| mesh.facets()[f as usize].nodes;
        let nodes = distinct(facets.iter().flat_map(global));
        let local = |n: u32| nodes.partition_point(|&m| m < n) as u32;
        let triangles = facets.iter().map(|f| global(f).map(local)).collect();
        let curved = mesh.order() == 2;
        let integrals = (facets.iter().filter(|_| curved))
            .map(|&facet| FacetIntegrals::new(mesh, facet as usize, HALF))
            .collect();
        let mut surface = Self {
            facets,
            triangles,
            nodes,
            areas: Vec::new(),
            frames: Vec::new(),
            integrals,
            mesh_nodes: mesh.points().len(),
        };
        surface.measure(mesh)?;
        Ok(surface)
    }

    /// The same where, on some triangles of a mesh of order 2, dual functions alone are the weight of the
    /// [means](Self::mean).
    ///
    /// # Errors
    /// [`SurfaceError::NoNormal`] if a node then has none.
    pub fn with_dual(mut self, mesh: &TetMesh, triangles: &[usize]) -> Result<Self, SurfaceError> {
        for &t in triangles {
            if let Some(own) = self.integrals.get_mut(t) {
                *own = FacetIntegrals::new(mesh, self.facets[t] as usize, 1.0);
            }
        }
        if !triangles.is_empty() {
            self.measure(mesh)?;
        }
        Ok(self)
    }

    /// Areas and frames of the nodes.
    fn measure(&mut self, mesh: &TetMesh) -> Result<(), SurfaceError> {
        let nodes = &self.nodes;
        let mut areas = vec![0.0; nodes.len()];
        let mut normals = vec![([0.0; 3], 0.0); nodes.len()];
        for (t, triangle) in self.triangles.iter().enumerate() {
            for (corner, n) in triangle.iter().map(|&n| n as usize).enumerate() {
                let (area, normal) = self.corner(mesh, t, corner);
                areas[n] += area;
                normals[n] = (add(normals[n].0, normal), normals[n].1 + norm(normal));
            }
        }
        let frame = |n: usize| {
            let (normal, all) = normals[n];
            let clear = norm(normal) > NO_NORMAL * all;
            let frame = if clear { SurfaceFrame::from_normal(normal) } else { None };
            frame.ok_or(SurfaceError::NoNormal { node: nodes[n] })
        };
        self.frames = (0..nodes.len()).map(frame).collect::<Result<_, _>>()?;
        self.areas = areas;
        Ok(())
    }

    /// The number of nodes of its mesh.
    #[cfg(feature = "vtu")]
    pub(crate) fn mesh_nodes(&self) -> usize {
        self.mesh_nodes
    }

    /// Global numbers of the nodes, ascending.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Place of a global node in [`Surface::nodes`], if it is there.
    pub fn local(&self, node: u32) -> Option<usize> {
        self.nodes.binary_search(&node).ok()
    }

    /// Area of each node, m²: a third of the triangles around it; of curved ones the integral of its linear hat
    /// function.
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// Frame of each node.
    pub fn frames(&self) -> &[SurfaceFrame] {
        &self.frames
    }

    /// Numbers of the facets in the mesh, ascending.
    pub fn facets(&self) -> &[u32] {
        &self.facets
    }

    /// The triangles by places in [`Surface::nodes`], outward, in the order of
    /// [`Surface::facets`].
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The triangles around each node, ascending.
    #[doc(hidden)]
    pub fn around(&self) -> Lists<u32> {
        Lists::by_key(self.nodes.len(), self.triangles.as_flattened()).map(|corner| corner / 3)
    }

    /// The mean of a displacement around a node, as mesh nodes with weights that sum to one, over those triangles
    /// around it that are chosen (all of its own side, at a crease): the node alone in a mesh of order 1. In a mesh of
    /// order 2 the displacement is weighted by half the sum of the linear hat function `l` of the node and the linear
    /// function of each triangle that is dual to the hat functions, `4 l - 1` where edges are straight, or by that
    /// alone ([`Self::with_dual`]). The node comes first, the others ascend.
    pub fn mean(&self, local: usize, triangles: impl Iterator<Item = usize>) -> Vec<(u32, f64)> {
        let own = self.nodes[local];
        let mut entries: Vec<(u32, f64)> = Vec::new();
        for t in triangles.filter(|&t| t < self.integrals.len()) {
            let facet = &self.integrals[t];
            let corners = self.triangles[t].iter().zip(&facet.products);
            for (_, products) in corners.filter(|(n, _)| **n as usize == local) {
                entries.extend(facet.nodes.iter().copied().zip(products.iter().copied()));
            }
        }
        entries.sort_by_key(|e| (e.0 != own, e.0));
        let mut mean: Vec<(u32, f64)> = Vec::with_capacity(entries.len());
        for (node, weight) in entries {
            match mean.last_mut().filter(|last| last.0 == node) {
                Some(last) => last.1 += weight,
                None => mean.push((node, weight)),
            }
        }
        let total: f64 = mean.iter().map(|e| e.1).sum();
        mean.iter_mut().for_each(|e| e.1 /= total);
        mean.retain(|e| e.1.abs() > NO_WEIGHT);
        if mean.is_empty() { vec![(own, 1.0)] } else { mean }
    }

    /// Area of the hat function of a corner of a triangle, a third of a straight one's, and the normal of the triangle
    /// as long as its weight in that of the node; in a mesh of order 2 the integral of the normal with the hat function,
    /// on curved facets with the weight of [`Surface::mean`].
    pub fn corner(&self, mesh: &TetMesh, triangle: usize, corner: usize) -> (f64, [f64; 3]) {
        if let Some(facet) = self.integrals.get(triangle) {
            return (facet.areas[corner], facet.normals[corner]);
        }
        let points = mesh.facet_points(self.facets[triangle] as usize);
        let [u, v] = [1, 2].map(|k| sub(points[(corner + k) % 3], points[corner]));
        let normal = cross(u, v);
        (norm(normal) / 6.0, scale(1.0 / (dot(u, u) * dot(v, v)), normal))
    }

    /// Area of the whole surface.
    pub fn total_area(&self) -> f64 {
        self.areas.iter().sum()
    }
}

fn check_tags(mesh: &TetMesh, tags: &[FacetTag]) -> Result<(), SurfaceError> {
    if tags.is_empty() {
        return Err(SurfaceError::NoTags);
    }
    for (i, &tag) in tags.iter().enumerate() {
        if !mesh.facets().iter().any(|facet| facet.tag == tag) {
            return Err(SurfaceError::UnknownTag {
                tag,
                known: mesh.tags(),
            });
        }
        if tags[..i].contains(&tag) {
            return Err(SurfaceError::RepeatedTag { tag });
        }
    }
    Ok(())
}
