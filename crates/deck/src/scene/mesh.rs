//! Nodes and elements as a mesh.

use std::path::Path;

use signorini_fem_mesh::{Facet, TetMesh};

use super::numbers::Numbers;
use crate::error::{DeckError, Fault};
use crate::model::Model;

/// The mesh before its facets are known. Nodes and elements are those of the deck, by position; `tets` are in the numbers of the
/// mesh, without nodes that no element uses.
#[derive(Debug)]
pub(super) struct Raw {
    pub(super) nodes: Numbers,
    pub(super) elements: Numbers,
    pub(super) points: Vec<[f64; 3]>,
    pub(super) tets: Vec<[u32; 4]>,
    /// Number in the mesh of each node of the deck.
    in_mesh: Vec<Option<u32>>,
    labels: Vec<u32>,
    element_labels: Vec<u32>,
}

impl Raw {
    pub(super) fn new(path: &Path, model: &Model) -> Result<Self, DeckError> {
        if model.elements.is_empty() {
            let path = path.to_owned();
            return Err(DeckError::NoElements { path });
        }
        let pairs = model.nodes.iter().map(|n| n.label).zip(0..).collect();
        let nodes = Numbers::new(pairs).map_err(|[first, second]| {
            let [first, second] = [first, second].map(|at| &model.nodes[at as usize]);
            let remedy = "give each node a number of its own";
            let first = first.place.line;
            let fault = Fault::Repeated { first, remedy };
            DeckError::at(&second.place, &second.label.to_string(), fault)
        })?;
        let pairs = model.elements.iter().map(|e| e.label).zip(0..).collect();
        let elements = Numbers::new(pairs).map_err(|[first, second]| {
            let [first, second] = [first, second].map(|at| &model.elements[at as usize]);
            let remedy = "give each element a number of its own";
            let first = first.place.line;
            let fault = Fault::Repeated { first, remedy };
            DeckError::at(&second.place, &second.label.to_string(), fault)
        })?;
        let mut tets = Vec::with_capacity(model.elements.len());
        let mut used = vec![false; model.nodes.len()];
        for element in &model.elements {
            let mut tet = [0; 4];
            for (position, label) in tet.iter_mut().zip(element.nodes) {
                *position = nodes.get(label).ok_or_else(|| {
                    let fault = Fault::UnknownNumber("node");
                    DeckError::at(&element.place, &label.to_string(), fault)
                })?;
                used[*position as usize] = true;
            }
            let volume = volume(&tet.map(|n| model.nodes[n as usize].point));
            if !(volume > 0.0 && volume.is_finite()) {
                let word = element.label.to_string();
                return Err(DeckError::at(&element.place, &word, Fault::Volume));
            }
            tets.push(tet);
        }
        let (mut points, mut labels) = (Vec::new(), Vec::new());
        let mut in_mesh = vec![None; used.len()];
        for ((node, used), number) in model.nodes.iter().zip(used).zip(&mut in_mesh) {
            if used {
                *number = Some(points.len() as u32);
                points.push(node.point);
                labels.push(node.label);
            }
        }
        let number = |n: u32| in_mesh[n as usize].unwrap_or(0);
        let tets = tets.into_iter().map(|tet| tet.map(number)).collect();
        Ok(Self {
            nodes,
            elements,
            points,
            tets,
            in_mesh,
            labels,
            element_labels: model.elements.iter().map(|e| e.label).collect(),
        })
    }

    /// The number in the mesh of a node of the deck, by its position; `None` if no element uses it.
    pub(super) fn in_mesh(&self, node: u32) -> Option<u32> {
        self.in_mesh[node as usize]
    }

    /// The number in the deck of each node of the mesh.
    pub(super) fn node_labels(&self) -> &[u32] {
        &self.labels
    }

    /// The number in the deck of each tetrahedron.
    pub(super) fn element_labels(&self) -> &[u32] {
        &self.element_labels
    }

    /// Nodes of the mesh by their numbers in the deck.
    pub(super) fn mesh_numbers(&self) -> Numbers {
        Numbers::new(self.labels.iter().copied().zip(0..).collect()).unwrap_or_default()
    }

    pub(super) fn tet_points(&self, tet: u32) -> [[f64; 3]; 4] {
        self.tets[tet as usize].map(|n| self.points[n as usize])
    }

    pub(super) fn volume(&self, tet: u32) -> f64 {
        volume(&self.tet_points(tet))
    }

    pub(super) fn mesh(
        &self,
        path: &Path,
        facets: Vec<Facet>,
        regions: Vec<u32>,
    ) -> Result<TetMesh, DeckError> {
        let mesh = TetMesh::new(self.points.clone(), self.tets.clone(), facets);
        let mesh = mesh.and_then(|mesh| mesh.with_regions(regions));
        mesh.map_err(|source| DeckError::Mesh {
            path: path.to_owned(),
            source,
        })
    }
}

/// Half of the cross product of two sides: the area of a triangle along its normal.
pub(super) fn area_vector([a, b, c]: &[[f64; 3]; 3]) -> [f64; 3] {
    let [u, v] = [b, c].map(|p| [0, 1, 2].map(|i| p[i] - a[i]));
    [
        0.5 * (u[1] * v[2] - u[2] * v[1]),
        0.5 * (u[2] * v[0] - u[0] * v[2]),
        0.5 * (u[0] * v[1] - u[1] * v[0]),
    ]
}

fn volume([a, b, c, d]: &[[f64; 3]; 4]) -> f64 {
    let n = area_vector(&[*a, *b, *c]);
    (0..3).map(|i| n[i] * (d[i] - a[i])).sum::<f64>() / 3.0
}
