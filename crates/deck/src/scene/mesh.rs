//! Nodes and elements as a mesh.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::path::Path;

use signorini_contact::{ContactError, Part};
use signorini_fem_mesh::internal::{EDGES, Lists, TET_FACES, distinct, facet_area_shares, facet_shares, tet_forces};
use signorini_fem_mesh::mesh::{Cell, CellShape, Division};
use signorini_fem_mesh::vec3::{Vec3, add, area_vector, dot, norm, scale, tet_volume};
use signorini_fem_mesh::{Facet, LoadError, MeshError, TetMesh};

use super::numbers::{Numbers, Sets};
use super::rigid::RigidBodies;
use crate::error::{DeckError, Fault, Word};
use crate::model::{Ignored, Kind, Model};
use crate::tolerances::{BENT, NO_AREA};

/// The mesh before its facets are known: elastic tetrahedra, without nodes that none of them uses. Where it is to be
/// cut, tetrahedra and faces have the nodes before the cut, and all that acts on these those of their side.
#[derive(Debug)]
pub(super) struct Raw {
    pub(super) points: Vec<[f64; 3]>,
    pub(super) tets: Vec<[u32; 4]>,
    /// Nodes on the edges of each; empty if they are of first order.
    pub(super) mids: Vec<[u32; 6]>,
    /// Of the faces 1 to 4 of each tetrahedron the number of the face of its element; 0 inside.
    faces: Vec<[u8; 4]>,
    /// Number in the mesh of each node of the deck, by position, and the tetrahedra of each element.
    of_node: Vec<Option<u32>>,
    of_element: Vec<Range<u32>>,
    /// Numbers in the deck of the nodes of the mesh; those behind them are added between others and have that of the
    /// first.
    pub(super) node_labels: Vec<u32>,
    /// The nodes around each node that is added, with their shares in it, and which these are by the first of them.
    added: Lists<(u32, f64)>,
    by_first: Lists<u32>,
    /// Copies of nodes where the mesh is cut; its tetrahedra here do not know of them.
    copies: BTreeMap<u32, Vec<u32>>,
    /// The node of each copy.
    first_of: HashMap<u32, u32>,
    /// What tetrahedra behind cuts have, by their number and the node before the cut.
    behind: HashMap<(u32, u32), u32>,
    /// Positions and numbers in the deck of the elements of the tetrahedra.
    pub(super) elements: Vec<u32>,
    pub(super) element_labels: Vec<u32>,
}

/// Elastic elements: position in the deck, shape, positions of the nodes.
fn elastic_cells(sets: &Sets, bodies: &RigidBodies) -> Result<Vec<(u32, CellShape, Vec<u32>)>, DeckError> {
    let mut cells = Vec::new();
    for (position, element) in (0..).zip(&sets.model.elements) {
        let nodes = sets.nodes_of(element)?;
        if element.kind.is_mark() || bodies.of_element(position).is_some() {
            continue;
        }
        let Kind::Solid(shape) = element.kind else {
            let why = "the facet is in no rigid body; put it into the ELSET of a *RIGID BODY";
            return Err(element.word().cannot(why));
        };
        cells.push((position, shape, nodes));
    }
    Ok(cells)
}

impl Raw {
    pub(super) fn new(
        path: &Path,
        sets: &Sets,
        bodies: &RigidBodies,
        notes: &mut Vec<Ignored>,
    ) -> Result<Self, DeckError> {
        let model = sets.model;
        let cells = elastic_cells(sets, bodies)?;
        if cells.is_empty() {
            let path = path.to_owned();
            return Err(DeckError::NoElements { path });
        }
        let element = |cell: usize| &model.elements[cells[cell].0 as usize];
        let whole: Vec<Cell> = (cells.iter().map(|(_, shape, nodes)| Cell { shape: *shape, nodes })).collect();
        // linear tetrahedra among themselves stay what they are
        let coarse = whole.iter().position(|cell| cell.nodes.len() == cell.shape.corners());
        let coarse = coarse.filter(|_| whole.iter().any(|cell| cell.nodes.len() != 4));
        let mut points: Vec<_> = model.nodes.iter().map(|node| node.point).collect();
        let division = match coarse {
            Some(_) => Division::raised(&mut points, &whole),
            None => Division::new(&mut points, &whole),
        };
        let division = division.map_err(|source| match source {
            MeshError::CellFlat { cell } => element(cell).word().fault(Fault::Volume),
            MeshError::CellsCross { first, second } => element(second).word().cannot(format!(
                "element {} has a face of four corners here, which this cuts into triangles along the other diagonal; mesh both \
                alike, or join them as separate bodies with *TIE",
                element(first).label
            )),
            source => DeckError::Mesh {
                path: path.to_owned(),
                source,
            },
        })?;
        if let Some(cell) = coarse {
            let why = format!(
                "the elements of first order become quadratic tetrahedra, and {} nodes are added; linear ones would be far too \
                stiff. Forces at corners are no pressure on these: give it by *DLOAD or *DSLOAD, not by *CLOAD",
                division.added().len()
            );
            notes.push(Ignored::new(&element(cell).word(), why));
        }
        let mut added = Lists::default();
        division.added().for_each(|around| added.push(around.iter().copied()));
        let mut out = Self {
            points: Vec::new(),
            tets: division.tets,
            mids: division.mids,
            faces: division.faces,
            of_node: vec![None; model.nodes.len()],
            of_element: vec![0..0; model.elements.len()],
            node_labels: Vec::new(),
            added,
            by_first: Lists::default(),
            copies: BTreeMap::new(),
            first_of: HashMap::new(),
            behind: HashMap::new(),
            elements: Vec::new(),
            element_labels: Vec::new(),
        };
        for ((position, ..), tets) in cells.iter().zip(division.of_cell) {
            let element = &model.elements[*position as usize];
            for tet in tets.clone() {
                let volume = tet_volume(&out.tets[tet as usize].map(|n| points[n as usize]));
                if !(volume > 0.0 && volume.is_finite()) {
                    return Err(element.word().fault(Fault::Volume));
                }
                out.elements.push(*position);
                out.element_labels.push(element.label);
            }
            out.of_element[*position as usize] = tets;
        }
        let mut used = vec![false; points.len()];
        let nodes = out.tets.iter().flatten().chain(out.mids.iter().flatten());
        nodes.for_each(|&n| used[n as usize] = true);
        bodies.check_apart(sets, &used)?;
        out.number(model, &points, &used);
        Ok(out)
    }

    /// From positions in the deck to numbers in the mesh: the used nodes, and behind them the added ones.
    fn number(&mut self, model: &Model, points: &[[f64; 3]], used: &[bool]) {
        let mut numbers = vec![0; points.len()];
        for (position, place) in points.iter().enumerate() {
            let node = model.nodes.get(position);
            if used[position] || node.is_none() {
                numbers[position] = self.points.len() as u32;
                self.points.push(*place);
            }
            if let (true, Some(node)) = (used[position], node) {
                self.of_node[position] = Some(numbers[position]);
                self.node_labels.push(node.label);
            }
        }
        let number = |n: &mut u32| *n = numbers[*n as usize];
        self.tets.iter_mut().flatten().for_each(number);
        self.mids.iter_mut().flatten().for_each(number);
        let added = std::mem::take(&mut self.added);
        self.added = added.map(|(node, share)| (numbers[node as usize], share));
        let first: Vec<u32> = self.added.iter().map(|around| around[0].0).collect();
        self.by_first = Lists::by_key(self.node_labels.len(), &first);
        let labels: Vec<u32> = first.iter().map(|n| self.node_labels[*n as usize]).collect();
        self.node_labels.extend(labels);
    }

    /// The tetrahedra of an element of the deck, by its position; none if it is rigid, or a triangle or line.
    pub(super) fn tets_of(&self, element: u32) -> Range<u32> {
        self.of_element[element as usize].clone()
    }

    /// The faces of tetrahedra that a face, from 1, of an element is, with their numbers there.
    pub(super) fn faces_of(&self, element: u32, number: u8) -> impl Iterator<Item = (u32, u8)> {
        let of_tet = move |tet: u32| {
            let faces = (1..).zip(self.faces[tet as usize]);
            faces
                .filter(move |face| face.1 == number)
                .map(move |face| (tet, face.0))
        };
        self.tets_of(element).flat_map(of_tet)
    }

    /// The faces of tetrahedra that make up the face of an element of which one is given.
    pub(super) fn parts_of_face(&self, tet: u32, number: u8) -> impl Iterator<Item = (u32, u8)> {
        let position = self.elements[tet as usize];
        self.faces_of(position, self.face_of_element(tet, number))
    }

    /// The face of its element that a face of a tetrahedron lies on.
    pub(super) fn face_of_element(&self, tet: u32, number: u8) -> u8 {
        self.faces[tet as usize][usize::from(number) - 1]
    }

    /// Nodes of the mesh, ascending, with the added ones all of whose neighbours are among them.
    fn with_added(&self, nodes: Vec<u32>) -> Vec<u32> {
        if self.added.count() == 0 {
            return nodes;
        }
        let nodes = distinct(nodes);
        let known = nodes.iter().filter(|n| (**n as usize) < self.by_first.count());
        let near = known.flat_map(|&n| self.by_first.of(n as usize));
        let is_known = |around: &(u32, f64)| nodes.binary_search(&around.0).is_ok();
        let is_inside = |k: &u32| self.added.of(*k as usize).iter().all(is_known);
        let first = self.first_added();
        let inside: Vec<u32> = near.copied().filter(is_inside).map(|k| first + k).collect();
        distinct(nodes.into_iter().chain(inside))
    }

    fn first_added(&self) -> u32 {
        (self.uncut() - self.added.count()) as u32
    }

    /// The nodes that are added, each with its neighbours and their shares.
    pub(super) fn added(&self) -> impl Iterator<Item = (u32, &[(u32, f64)])> {
        (self.first_added()..).zip(self.added.iter())
    }

    /// The neighbours of one of them.
    pub(super) fn around(&self, added: u32) -> &[(u32, f64)] {
        self.added.of((added - self.first_added()) as usize)
    }

    /// Nodes of the deck, by position, as nodes of the mesh, those that are in it, those between them, and copies.
    pub(super) fn all_in_mesh(&self, nodes: &[u32]) -> Vec<u32> {
        let mut all = self.with_added(nodes.iter().filter_map(|n| self.in_mesh(*n)).collect());
        let copies: Vec<u32> = all.iter().flat_map(|n| self.with_copies(*n).skip(1)).collect();
        // those of all nodes lie behind these
        all.extend(distinct(copies));
        all
    }

    /// Adds copies of nodes behind the others, as cuts made them of a mesh.
    pub(super) fn copy(&mut self, nodes: &[u32], cut: &TetMesh) {
        for &node in nodes {
            let copy = self.points.len() as u32;
            // a copy of a copy is one of the node
            let first = *self.first_of.get(&node).unwrap_or(&node);
            self.first_of.insert(copy, first);
            self.copies.entry(first).or_default().push(copy);
            self.points.push(self.points[node as usize]);
            self.node_labels.push(self.node_labels[node as usize]);
        }
        for (tet, corners) in cut.tets().iter().enumerate() {
            for node in corners.iter().chain(cut.mids().get(tet).into_iter().flatten()) {
                if let Some(first) = self.first_of.get(node) {
                    self.behind.insert((tet as u32, *first), *node);
                }
            }
        }
    }

    /// The node that a tetrahedron has, of those before the cuts, on its side of these.
    pub(super) fn own(&self, tet: u32, node: u32) -> u32 {
        *self.behind.get(&(tet, node)).unwrap_or(&node)
    }

    /// A node of the mesh and its copies.
    pub(super) fn with_copies(&self, node: u32) -> impl Iterator<Item = u32> {
        let copies = self.copies.get(&node).into_iter().flatten();
        std::iter::once(node).chain(copies.copied())
    }

    /// Refuses a node with two displacements.
    pub(super) fn single(&self, node: u32, word: &Word) -> Result<(), DeckError> {
        let label = self.node_labels[node as usize];
        if self.copies.contains_key(&node) {
            Err(word.cannot(format!(
                "node {label} lies where a *PRE-TENSION SECTION cuts the body, and has two displacements; name another one"
            )))
        } else {
            Ok(())
        }
    }

    /// The number in the mesh of a node of the deck, by its position; `None` if no elastic element uses it.
    pub(super) fn in_mesh(&self, node: u32) -> Option<u32> {
        self.of_node[node as usize]
    }

    /// Nodes of the mesh by their numbers in the deck.
    pub(super) fn mesh_numbers(&self) -> Numbers {
        let nodes = self.node_labels.iter().copied().take(self.first_added() as usize);
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
        TET_FACES[usize::from(number) - 1].map(|i| corners[i])
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
        let label = self.node_labels[node as usize];
        // each is of a node of the deck
        let position = model.nodes.iter().position(|node| node.label == label);
        Word::new(&model.nodes[position.unwrap_or(0)].location, label.to_string())
    }

    /// Numbers of the nodes that are added.
    pub(super) fn new_nodes(&self) -> Range<usize> {
        self.first_added() as usize..self.uncut()
    }

    /// Forces of the nodes of a tetrahedron under a force per volume.
    pub(super) fn tet_forces(
        &self,
        tet: u32,
        density: impl Fn(Vec3) -> Vec3 + Sync,
    ) -> Result<Vec<(u32, Vec3)>, LoadError> {
        let at = |node: u32| self.points[node as usize];
        let (corners, mids) = (self.tets[tet as usize], self.mids.get(tet as usize));
        let forces = tet_forces(&corners.map(at), mids.map(|mids| mids.map(at)).as_ref(), density)?;
        let nodes = corners.into_iter().chain(mids.into_iter().flatten().copied());
        Ok(nodes.map(|n| self.own(tet, n)).zip(forces).collect())
    }

    /// Whether values of nodes are not linear along edges of tetrahedra whose mid-nodes the deck has.
    pub(super) fn is_bent(&self, values: &[f64]) -> bool {
        let largest = values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let at = |node: u32| values[node as usize];
        let mut edges = self.tets.iter().zip(&self.mids).flat_map(|(corners, mids)| {
            let ends = EDGES.iter().map(|edge| edge.map(|end| corners[end]));
            ends.zip(mids.iter().copied())
        });
        edges.any(|([a, b], mid)| {
            let bent = (at(mid) - 0.5 * (at(a) + at(b))).abs();
            bent > BENT * largest && !self.new_nodes().contains(&(mid as usize))
        })
    }

    /// Nodes that share the force on a face of a tetrahedron evenly: its corners, or the nodes on its edges.
    pub(super) fn loaded(&self, tet: u32, face: [u32; 3]) -> [u32; 3] {
        self.mids_of(tet, face).unwrap_or(face)
    }

    /// The nodes of a face that carry a constant traction on it, each with its area.
    pub(super) fn areas(&self, tet: u32, face: [u32; 3]) -> Vec<(u32, f64)> {
        let (all, points) = match self.quadratic_face(tet, face) {
            Some(quadratic) => quadratic,
            None => {
                let third = norm(self.area_vector(tet, face)) / 3.0;
                return face.map(|node| (self.own(tet, node), third)).into();
            }
        };
        let areas = facet_shares(&points);
        // corners of straight ones have none but rounding
        let least = NO_AREA * areas.iter().sum::<f64>();
        let carries = |(_, area): &(u32, f64)| area.abs() > least;
        let all = all.into_iter().map(|node| self.own(tet, node));
        all.zip(areas).filter(carries).collect()
    }

    /// The same along the outward normal.
    pub(super) fn area_vectors(&self, tet: u32, face: [u32; 3]) -> Vec<(u32, Vec3)> {
        let out = self.area_vector(tet, face);
        let Some((all, points)) = self.quadratic_face(tet, face) else {
            return face.map(|node| (self.own(tet, node), scale(1.0 / 3.0, out))).into();
        };
        let areas = facet_area_shares(&points);
        let sign = dot(areas.into_iter().fold([0.0; 3], add), out).signum();
        let all = all.into_iter().map(|node| self.own(tet, node));
        all.zip(areas.map(|area| scale(sign, area))).collect()
    }

    /// Corners and mid-nodes of a face of a quadratic tetrahedron, and where they are.
    fn quadratic_face(&self, tet: u32, face: [u32; 3]) -> Option<([u32; 6], [Vec3; 6])> {
        let ([a, b, c], [d, e, f]) = (face, self.mids_of(tet, face)?);
        let nodes = [a, b, c, d, e, f];
        Some((nodes, nodes.map(|n| self.points[n as usize])))
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
            let divided = |tet: usize| {
                let element = &model.elements[self.elements[tet] as usize];
                let is_whole = element.kind == Kind::Solid(CellShape::Tetrahedron);
                (!is_whole).then(|| element.word())
            };
            let tet = error.parts().into_iter().find_map(|part| match part {
                Part::Tet(tet) => Some(tet),
                _ => None,
            });
            if let Some(word) = tet.and_then(divided) {
                return word.fault(Fault::Distorted { source });
            }
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
