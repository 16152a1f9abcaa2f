//! Nodes and elements as a mesh.

use std::collections::BTreeMap;
use std::path::Path;

use signorini_contact::{ContactError, Part};
use signorini_fem_mesh::internal::EDGES;
use signorini_fem_mesh::vec3::{add, area_vector, scale, sub, tet_volume};
use signorini_fem_mesh::{Facet, TetMesh};

use super::numbers::{Numbers, Sets};
use super::rigid::RigidBodies;
use crate::error::{DeckError, Fault, Word};
use crate::model::{FACES, Kind, Model};

/// The mesh before its facets are known: elastic tetrahedra, without nodes that none of them uses.
#[derive(Debug)]
pub(super) struct Raw {
    pub(super) points: Vec<[f64; 3]>,
    pub(super) tets: Vec<[u32; 4]>,
    /// Nodes on the edges of each; empty if they are of first order.
    pub(super) mids: Vec<[u32; 6]>,
    /// Number in the mesh of each node and element of the deck, by position.
    of_node: Vec<Option<u32>>,
    of_element: Vec<Option<u32>>,
    /// Numbers in the deck of the nodes of the mesh.
    pub(super) node_labels: Vec<u32>,
    /// Copies of nodes where the mesh is cut; its tetrahedra here do not know of them.
    copies: BTreeMap<u32, Vec<u32>>,
    /// Positions and numbers in the deck of the tetrahedra.
    pub(super) elements: Vec<u32>,
    pub(super) element_labels: Vec<u32>,
}

impl Raw {
    pub(super) fn new(path: &Path, sets: &Sets, bodies: &RigidBodies) -> Result<Self, DeckError> {
        let model = sets.model;
        let (mut tets, mut mids, mut elements) = (Vec::new(), Vec::new(), Vec::new());
        let mut of_element = vec![None; model.elements.len()];
        let mut used = vec![false; model.nodes.len()];
        for (position, element) in model.elements.iter().enumerate() {
            let nodes = sets.corners(element)?;
            if element.kind.is_mark() || bodies.of_element(position as u32).is_some() {
                continue;
            }
            if element.kind != Kind::Solid {
                let why = "the facet is in no rigid body; put it into the ELSET of a *RIGID BODY";
                return Err(element.word().cannot(why));
            }
            let volume = tet_volume(&nodes.map(|n| model.nodes[n as usize].point));
            if !(volume > 0.0 && volume.is_finite()) {
                return Err(element.word().fault(Fault::Volume));
            }
            let own = sets.mids(element)?;
            if !tets.is_empty() && own.is_some() == mids.is_empty() {
                let why = "the deck has elastic elements of first and of second order; mesh all in one order";
                return Err(element.word().cannot(why));
            }
            nodes
                .iter()
                .chain(own.iter().flatten())
                .for_each(|&n| used[n as usize] = true);
            mids.extend(own);
            of_element[position] = Some(tets.len() as u32);
            tets.push(nodes);
            elements.push(position as u32);
        }
        if tets.is_empty() {
            let path = path.to_owned();
            return Err(DeckError::NoElements { path });
        }
        bodies.check_apart(sets, &used)?;
        let (mut points, mut node_labels) = (Vec::new(), Vec::new());
        let mut of_node = vec![None; used.len()];
        for ((node, used), number) in model.nodes.iter().zip(used).zip(&mut of_node) {
            if used {
                *number = Some(points.len() as u32);
                points.push(node.point);
                node_labels.push(node.label);
            }
        }
        let number = |n: u32| of_node[n as usize].unwrap_or(0);
        let label = |&e: &u32| model.elements[e as usize].label;
        Ok(Self {
            points,
            tets: tets.into_iter().map(|tet: [u32; 4]| tet.map(number)).collect(),
            mids: mids.into_iter().map(|mids: [u32; 6]| mids.map(number)).collect(),
            of_node,
            of_element,
            node_labels,
            copies: BTreeMap::new(),
            element_labels: elements.iter().map(label).collect(),
            elements,
        })
    }

    /// The tetrahedron of an element of the deck, by its position; `None` if it is rigid, or a triangle or line.
    pub(super) fn tet(&self, element: u32) -> Option<u32> {
        self.of_element[element as usize]
    }

    /// Adds copies of nodes behind the others, as cuts make them.
    pub(super) fn copy(&mut self, nodes: &[u32]) {
        for &node in nodes {
            let copy = self.points.len() as u32;
            // a copy of a copy is one of the node
            let first = self.copies.iter().find(|(_, copies)| copies.contains(&node));
            let first = first.map_or(node, |(first, _)| *first);
            self.copies.entry(first).or_default().push(copy);
            self.points.push(self.points[node as usize]);
            self.node_labels.push(self.node_labels[node as usize]);
        }
    }

    /// A node of the mesh and its copies.
    pub(super) fn with_copies(&self, node: u32) -> impl Iterator<Item = u32> {
        let copies = self.copies.get(&node).into_iter().flatten();
        std::iter::once(node).chain(copies.copied())
    }

    /// The number in the mesh of a node of the deck, by its position; `None` if no elastic element uses it.
    pub(super) fn in_mesh(&self, node: u32) -> Option<u32> {
        self.of_node[node as usize]
    }

    /// Nodes of the mesh by their numbers in the deck.
    pub(super) fn mesh_numbers(&self) -> Numbers {
        let nodes = self.node_labels.iter().copied().take(self.uncut());
        Numbers::new(nodes.zip(0..).collect()).unwrap_or_default()
    }

    /// Nodes without copies.
    fn uncut(&self) -> usize {
        self.points.len() - self.copies.values().map(Vec::len).sum::<usize>()
    }

    pub(super) fn tet_points(&self, tet: u32) -> [[f64; 3]; 4] {
        self.tets[tet as usize].map(|n| self.points[n as usize])
    }

    /// The corners of a face (1 to 4) of a tetrahedron.
    pub(super) fn face(&self, tet: u32, number: u8) -> [u32; 3] {
        let corners = self.tets[tet as usize];
        FACES[usize::from(number) - 1].map(|i| corners[i])
    }

    /// The area of a face of a tetrahedron along the outward normal.
    pub(super) fn area_vector(&self, tet: u32, face: [u32; 3]) -> [f64; 3] {
        let [a, b, c] = face.map(|n| self.points[n as usize]);
        let area = area_vector(&[a, b, c]);
        let inside = self.tet_points(tet);
        let centre = [0, 1, 2].map(|i| inside.iter().map(|p| p[i]).sum::<f64>() / 4.0);
        let out: f64 = (0..3).map(|i| area[i] * (a[i] - centre[i])).sum();
        if out < 0.0 { area.map(|x| -x) } else { area }
    }

    /// The number of a node of the mesh in the deck, where it is defined.
    fn node_word(&self, model: &Model, node: u32) -> Word {
        let position = self.of_node.iter().position(|n| *n == Some(node));
        let label = self.node_labels[node as usize].to_string();
        Word::new(&model.nodes[position.unwrap_or(0)].location, label)
    }

    /// Shares of a tetrahedron in a force per volume that is constant in it, as far as its edges are straight.
    pub(super) fn shares(&self, tet: u32) -> Vec<(u32, f64)> {
        let corners = self.tets[tet as usize];
        match self.mids.get(tet as usize) {
            None => corners.map(|n| (n, 0.25)).into(),
            Some(mids) => {
                let corners = corners.into_iter().map(|n| (n, -0.05));
                corners.chain(mids.iter().map(|&n| (n, 0.2))).collect()
            }
        }
    }

    /// The same of one that grows linearly, given at the corners.
    pub(super) fn linear_shares(&self, tet: u32, given: [[f64; 3]; 4]) -> Vec<(u32, [f64; 3])> {
        let corners = self.tets[tet as usize];
        let sum = given.into_iter().fold([0.0; 3], add);
        let own = corners.into_iter().zip(given);
        match self.mids.get(tet as usize) {
            None => own.map(|(n, f)| (n, scale(0.05, add(sum, f)))).collect(),
            Some(mids) => {
                let corners = own.map(|(n, f)| (n, scale(1.0 / 60.0, sub(f, sum))));
                let ends = |[a, b]: [usize; 2]| add(given[a], given[b]);
                let mids = mids.iter().zip(EDGES);
                let mids = mids.map(|(&n, edge)| (n, scale(1.0 / 30.0, add(sum, ends(edge)))));
                corners.chain(mids).collect()
            }
        }
    }

    /// Nodes that share the force on a face of a tetrahedron evenly: its corners, or the nodes on its edges.
    pub(super) fn loaded(&self, tet: u32, face: [u32; 3]) -> [u32; 3] {
        self.mids_of(tet, face).unwrap_or(face)
    }

    /// A face of a tetrahedron as triangles between neighbouring nodes.
    pub(super) fn triangles(&self, tet: u32, face: [u32; 3]) -> Vec<[u32; 3]> {
        let Some([ab, bc, ca]) = self.mids_of(tet, face) else {
            return vec![face];
        };
        let [a, b, c] = face;
        vec![[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    }

    /// The nodes on the edges of a face, from each corner to the next, of a quadratic tetrahedron.
    fn mids_of(&self, tet: u32, [a, b, c]: [u32; 3]) -> Option<[u32; 3]> {
        let mids = self.mids.get(tet as usize)?;
        let corners = self.tets[tet as usize];
        let between = |ends: [u32; 2]| {
            let is = |edge: &[usize; 2]| edge.iter().all(|&k| ends.contains(&corners[k]));
            EDGES.iter().position(is).map_or(ends[0], |edge| mids[edge])
        };
        Some([[a, b], [b, c], [c, a]].map(between))
    }

    pub(super) fn volume(&self, tet: u32) -> f64 {
        tet_volume(&self.tet_points(tet))
    }

    /// The mesh; `name` says what a part is in the deck.
    pub(super) fn mesh(
        &self,
        path: &Path,
        model: &Model,
        facets: Vec<Facet>,
        regions: Vec<u32>,
        name: impl Fn(Part) -> Option<String>,
    ) -> Result<TetMesh, DeckError> {
        let whole =
            |(tet, mids): (&[u32; 4], &[u32; 6])| std::array::from_fn(|k| if k < 4 { tet[k] } else { mids[k - 4] });
        let points = self.points[..self.uncut()].to_vec();
        let mesh = match self.mids[..] {
            [] => TetMesh::new(points, self.tets.clone(), facets),
            _ => {
                let tets = self.tets.iter().zip(&self.mids).map(whole);
                TetMesh::quadratic(points, tets.collect(), facets)
            }
        };
        let mesh = mesh.and_then(|mesh| mesh.with_regions(regions));
        mesh.map_err(|source| {
            let error = ContactError::from(source.clone());
            let word = error.parts().into_iter().find_map(|part| match part {
                Part::Tet(tet) => Some(model.elements[self.elements[tet] as usize].word()),
                Part::Node(node) => Some(self.node_word(model, node)),
                _ => None,
            });
            let Some(word) = word else {
                let path = path.to_owned();
                return DeckError::Mesh { path, source };
            };
            let names = error.names(name);
            word.fault(Fault::Mesh { names, source })
        })
    }
}
