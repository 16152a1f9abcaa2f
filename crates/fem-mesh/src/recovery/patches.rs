//! The recovered strain: linear in each tetrahedron, continuous inside a region of equal material.
//!
//! A linear polynomial is fitted to the strains at the centroids of the tetrahedra around a node (its patch) and
//! evaluated there. Where a patch is too small for a fit, at corners and edges, the patches of its neighbours join.

use nalgebra::{Matrix4, Vector4};
use rayon::prelude::*;

use crate::mesh::TetMesh;
use crate::tables::{Lists, distinct};
use crate::tolerances::{FIT_PIVOT, SMALL_PATCH};
use crate::vec3::{centroid, sub};

use super::quadratic::Fit;

/// The recovery of strains at the nodes of a mesh, to be used for many displacements: the fits
/// depend on the mesh only, so that each recovered strain is a fixed combination of strains.
#[derive(Debug, Clone)]
pub struct StrainRecovery {
    /// Nodes of the mesh.
    pub(super) nodes: usize,
    /// The tetrahedra of the patch of each (node, region), with their weights.
    pub(super) patches: Vec<Vec<(u32, f64)>>,
    /// Patches of the corners of each tetrahedron.
    pub(super) corners: Vec<[u32; 4]>,
    /// The patches in a mesh of order 2, instead of their weights.
    pub(super) fits: Vec<Fit>,
}

/// What a fit needs of a tetrahedron.
struct Cell {
    centroid: [f64; 3],
    volume: f64,
}

/// The tetrahedra around each node, those of each region apart.
struct Around {
    patches: Lists<u32>,
    /// Node and region of each patch, ascending.
    nodes: Vec<u32>,
    regions: Vec<u32>,
    /// First patch of each node, and the end of the last.
    first: Vec<u32>,
}

impl Around {
    fn new(mesh: &TetMesh) -> Self {
        let corners = mesh.tets().as_flattened();
        let mut tets = Lists::by_key(mesh.points().len(), corners).map(|p| p / 4);
        let mut out = Self {
            patches: Lists::default(),
            nodes: Vec::new(),
            regions: Vec::new(),
            first: vec![0],
        };
        let region = |tet: u32| mesh.regions()[tet as usize];
        for node in 0..tets.count() {
            let own = tets.of_mut(node);
            own.sort_by_key(|&tet| region(tet));
            for patch in own.chunk_by(|&a, &b| region(a) == region(b)) {
                out.patches.push(patch.iter().copied());
                out.nodes.push(node as u32);
                out.regions.push(region(patch[0]));
            }
            out.first.push(out.nodes.len() as u32);
        }
        out
    }

    /// A patch and those of its neighbours, ascending.
    fn wide(&self, mesh: &TetMesh, k: usize) -> Vec<u32> {
        let around = |&tet: &u32| mesh.tets()[tet as usize].map(|node| self.place(mesh, node, tet));
        let patches = self.patches.of(k).iter().flat_map(around);
        distinct(patches.flat_map(|k| self.patches.of(k)).copied())
    }

    /// Patches of the corners of each tetrahedron.
    fn corners(&self, mesh: &TetMesh) -> Vec<[u32; 4]> {
        let corner = |(tet, nodes): (usize, &[u32; 4])| nodes.map(|node| self.place(mesh, node, tet as u32) as u32);
        mesh.tets().iter().enumerate().map(corner).collect()
    }

    /// The patch around `node` that `tet`, one of its tetrahedra, belongs to.
    fn place(&self, mesh: &TetMesh, node: u32, tet: u32) -> usize {
        let own = self.first[node as usize] as usize..self.first[node as usize + 1] as usize;
        let region = mesh.regions()[tet as usize];
        let after = self.regions[own.clone()].partition_point(|&r| r < region);
        own.start + after
    }
}

impl StrainRecovery {
    /// Fits all patches of a mesh.
    pub fn new(mesh: &TetMesh) -> Self {
        let around = Around::new(mesh);
        if mesh.order() == 2 {
            return Self::quadratic(mesh, &around);
        }
        let cells: Vec<Cell> = (0..mesh.tets().len())
            .into_par_iter()
            .map(|tet| Cell {
                centroid: centroid(&mesh.tet_points(tet)),
                volume: mesh.volume(tet),
            })
            .collect();
        let patch = |k: usize| -> Vec<(u32, f64)> {
            let own = around.patches.of(k);
            let centre = mesh.points()[around.nodes[k] as usize];
            let with = |tets: &[u32], weights: Vec<f64>| tets.iter().copied().zip(weights).collect();
            if own.len() >= SMALL_PATCH
                && let Some(weights) = fit(&cells, own, centre)
            {
                return with(own, weights);
            }
            let wide = around.wide(mesh, k);
            match fit(&cells, &wide, centre) {
                Some(weights) => with(&wide, weights),
                None => with(own, mean(&cells, own)),
            }
        };
        Self {
            nodes: mesh.points().len(),
            patches: (0..around.nodes.len()).into_par_iter().map(patch).collect(),
            corners: around.corners(mesh),
            fits: Vec::new(),
        }
    }

    fn quadratic(mesh: &TetMesh, around: &Around) -> Self {
        let patch = |k: usize| {
            let (own, centre) = (around.patches.of(k), mesh.points()[around.nodes[k] as usize]);
            let first = Some(own).filter(|own| own.len() >= SMALL_PATCH);
            let fit = first.and_then(|own| Fit::quadratic(mesh, own, centre));
            fit.unwrap_or_else(|| Fit::best(mesh, &around.wide(mesh, k), centre))
        };
        Self {
            nodes: mesh.points().len(),
            patches: Vec::new(),
            corners: around.corners(mesh),
            fits: (0..around.nodes.len()).into_par_iter().map(patch).collect(),
        }
    }
}

/// Weights of the mean by volume.
fn mean(cells: &[Cell], tets: &[u32]) -> Vec<f64> {
    let volumes = || tets.iter().map(|&t| cells[t as usize].volume);
    let total: f64 = volumes().sum();
    volumes().map(|v| v / total).collect()
}

/// Weights of the value at `centre` of the linear polynomial that fits values at the centroids best
/// (least squares, weighted by volume); `None` if the centroids do not determine it.
fn fit(cells: &[Cell], tets: &[u32], centre: [f64; 3]) -> Option<Vec<f64>> {
    let patch = || tets.iter().map(|&tet| &cells[tet as usize]);
    let mut size = [0.0_f64; 3];
    let mut volume = 0.0;
    for cell in patch() {
        let x = sub(cell.centroid, centre);
        (0..3).for_each(|d| size[d] = size[d].max(x[d].abs()));
        volume += cell.volume;
    }
    if size.contains(&0.0) {
        return None;
    }
    let polynomial = |cell: &Cell| {
        let x = sub(cell.centroid, centre);
        Vector4::new(1.0, x[0] / size[0], x[1] / size[1], x[2] / size[2])
    };
    let mut normal = Matrix4::<f64>::zeros();
    for cell in patch() {
        let p = polynomial(cell);
        normal.ger(cell.volume / volume, &p, &p, 1.0);
    }
    let factor = normal.cholesky()?;
    let pivots = factor.l_dirty().diagonal();
    if pivots.min().powi(2) < FIT_PIVOT * pivots.max().powi(2) {
        return None;
    }
    let first = factor.solve(&Vector4::new(1.0, 0.0, 0.0, 0.0));
    let weight = |cell: &Cell| cell.volume / volume * polynomial(cell).dot(&first);
    Some(patch().map(weight).collect())
}
