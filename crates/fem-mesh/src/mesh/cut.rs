//! Meshes that are cut open inside.

use crate::tables::{DisjointSets, distinct};
use std::collections::BTreeMap;

use super::cells::EDGES;
use super::check;
use super::error::MeshError;
use super::faces::{NONE, face_nodes};
use super::tet_mesh::{Facet, FacetTag, TetMesh};

impl TetMesh {
    /// Cuts the mesh open along all faces between tetrahedra of which `is_first(tet)` is `Some(true)` and
    /// `Some(false)`; those with `None` stay joined with both. The facets of the first side get the first tag, those of
    /// the other the second one, beside those that have them already. Nodes of the cut stay with the first side; the
    /// other side has copies of them, numbered behind all nodes, which have the list of these nodes in this order. What
    /// of a side hangs together by an edge or a node only still does.
    ///
    /// ```
    /// use signorini_fem_mesh::{Brick, FacetTag, vec3};
    ///
    /// let bar = Brick::new([2.0, 1.0, 1.0], [2, 1, 1]).build()?;
    /// let (halves, copied) = bar.cut(|tet| Some(vec3::centroid(&bar.tet_points(tet))[0] < 1.0), [7, 8].map(FacetTag))?;
    /// assert_eq!(halves.points().len(), bar.points().len() + copied.len());
    /// assert_eq!(halves.nodes_on(FacetTag(7)), copied);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::NoCut`] if there is no such face, [`MeshError::CutEnds`] if the cut ends inside a body,
    /// [`MeshError::TooLarge`].
    pub fn cut(
        &self,
        is_first: impl Fn(usize) -> Option<bool>,
        tags: [FacetTag; 2],
    ) -> Result<(Self, Vec<u32>), MeshError> {
        let sides: Vec<Option<bool>> = (0..self.tets.len()).map(is_first).collect();
        let is_cut = |tet: usize, other: usize| sides[tet].is_some_and(|first| sides[other] == Some(!first));
        self.open(
            &sides,
            self.inner_faces(|tet, _, other| is_cut(tet, other)),
            tags,
            false,
        )
    }

    /// Cuts a body open along faces inside it that need not lead through: a crack, the tip of which stays joined. It
    /// has all faces between two tetrahedra of which `is_on(corners)` holds, asked once each, as the tetrahedron with the
    /// smaller number has them; `is_first(tet)` tells on which side of them a tetrahedron is. Tags, nodes and copies are as those of [`cut`](Self::cut). A face with all
    /// corners at the tip stays closed. Branches are cracks of their own.
    ///
    /// Gmsh's plugin `Crack` does the same to a surface inside a volume, with `NewPhysicalGroup` for the other side:
    /// one run a branch, and the order of elements set before.
    ///
    /// ```
    /// use signorini_fem_mesh::{Brick, FacetTag, vec3};
    ///
    /// let block = Brick::new([2.0, 1.0, 1.0], [4, 2, 2]).build()?;
    /// let is_on = |face: [[f64; 3]; 3]| face.iter().all(|[x, _, z]| *x <= 1.0 && *z == 0.5);
    /// let is_below = |tet| vec3::centroid(&block.tet_points(tet))[2] < 0.5;
    /// let (cracked, copied) = block.crack(is_on, is_below, [7, 8].map(FacetTag))?;
    /// // the tip is at x = 1
    /// assert!(copied.iter().all(|node| block.points()[*node as usize][0] < 1.0));
    /// assert_eq!(cracked.components(), block.components());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::NoCut`] if nothing opens, [`MeshError::CrackSides`] if both tetrahedra at a face are said to be on
    /// one side, [`MeshError::TooLarge`].
    pub fn crack(
        &self,
        is_on: impl Fn([[f64; 3]; 3]) -> bool,
        is_first: impl Fn(usize) -> bool,
        tags: [FacetTag; 2],
    ) -> Result<(Self, Vec<u32>), MeshError> {
        let corners = |tet: usize, face: usize| face_nodes(&self.tets[tet], face).map(|n| self.points[n as usize]);
        // each is asked for once, and then taken from both sides
        let once = self.inner_faces(|tet, face, other| tet < other && is_on(corners(tet, face)));
        let across = |&(tet, face): &(usize, usize)| (tet, self.neighbours[tet][face] as usize);
        let chosen = distinct(once.iter().map(across));
        let faces = self.inner_faces(|tet, _, other| chosen.binary_search(&(tet.min(other), tet.max(other))).is_ok());
        let mut sides = vec![None; self.tets.len()];
        faces.iter().for_each(|&(tet, _)| sides[tet] = Some(is_first(tet)));
        if let Some(&(first, second)) = chosen.iter().find(|(a, b)| sides[*a] == sides[*b]) {
            return Err(MeshError::CrackSides { first, second });
        }
        self.open(&sides, faces, tags, true)
    }

    /// Faces between tetrahedra of which `is_chosen(tet, face, other)` holds, from both sides.
    fn inner_faces(&self, is_chosen: impl Fn(usize, usize, usize) -> bool) -> Vec<(usize, usize)> {
        let chosen = |tet: usize| {
            let faces = self.neighbours(tet).into_iter().enumerate();
            let faces = faces.filter_map(|(face, other)| Some((face, other?)));
            faces
                .filter_map(|(face, other)| is_chosen(tet, face, other).then_some((tet, face)))
                .collect::<Vec<_>>()
        };
        (0..self.tets.len()).flat_map(chosen).collect()
    }

    /// Opens faces, which are listed from both of their tetrahedra, those of which have a side. Nodes around which both
    /// sides are still joined stay so, if that `may_end` inside a body.
    fn open(
        &self,
        sides: &[Option<bool>],
        mut faces: Vec<(usize, usize)>,
        tags: [FacetTag; 2],
        may_end: bool,
    ) -> Result<(Self, Vec<u32>), MeshError> {
        let mut neighbours = self.neighbours.clone();
        // tetrahedra around the corners of the cut
        let mut around: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for &(tet, face) in &faces {
            neighbours[tet][face] = NONE;
            around.extend(face_nodes(&self.tets[tet], face).map(|node| (node, Vec::new())));
        }
        for (tet, corners) in self.tets.iter().enumerate() {
            for node in corners {
                if let Some(tets) = around.get_mut(node) {
                    tets.push(tet);
                }
            }
        }
        // each corner that opens, with the tetrahedra of the second side
        let mut opened: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (&node, tets) in &around {
            let mut sets = DisjointSets::new(tets.len());
            for (k, &tet) in tets.iter().enumerate() {
                for other in neighbours[tet].into_iter().filter(|other| *other != NONE) {
                    if let Ok(other) = tets.binary_search(&(other as usize)) {
                        sets.join(k, other);
                    }
                }
            }
            let mut found: BTreeMap<usize, [bool; 2]> = BTreeMap::new();
            for (k, &tet) in tets.iter().enumerate() {
                if let Some(first) = sides[tet] {
                    found.entry(sets.first(k)).or_default()[usize::from(!first)] = true;
                }
            }
            if found.values().any(|sides| *sides == [true; 2]) {
                if may_end { continue } else { return Err(MeshError::CutEnds { node }) }
            }
            let is_second = |k: &usize| found.get(&sets.first(*k)) == Some(&[false, true]);
            opened.insert(node, (0..tets.len()).filter(is_second).map(|k| tets[k]).collect());
        }
        // a face with all corners at the tip stays
        faces.retain(|&(tet, face)| {
            let mut corners = face_nodes(&self.tets[tet], face).into_iter();
            let opens = corners.any(|node| opened.contains_key(&node));
            if !opens {
                neighbours[tet][face] = self.neighbours[tet][face];
            }
            opens
        });
        if faces.is_empty() {
            return Err(MeshError::NoCut);
        }
        let mids = match self.order() {
            2 => self.copies_of_mids(&opened),
            _ => Vec::new(),
        };
        let mut copies: Vec<(u32, Vec<usize>)> = opened.into_iter().chain(mids).collect();
        copies.sort_by_key(|copy| copy.0);
        let copied: Vec<u32> = copies.iter().map(|copy| copy.0).collect();
        check::numbered("nodes", self.points.len() + copied.len())?;
        let mut out = Self {
            neighbours,
            ..self.clone()
        };
        for &(tet, face) in &faces {
            let tag = tags[usize::from(sides[tet] == Some(false))];
            let nodes = face_nodes(&self.tets[tet], face);
            out.facets.push(Facet { nodes, tag });
            out.owners.push(tet as u32);
        }
        let mut numbers: BTreeMap<(usize, u32), u32> = BTreeMap::new();
        for (node, tets) in copies {
            let number = out.points.len() as u32;
            numbers.extend(tets.into_iter().map(|tet| ((tet, node), number)));
            out.points.push(self.points[node as usize]);
        }
        for (&(tet, node), &number) in &numbers {
            let mids = out.mids.get_mut(tet).into_iter().flatten();
            let places = out.tets[tet].iter_mut().chain(mids);
            places.filter(|place| **place == node).for_each(|place| *place = number);
        }
        for (facet, &owner) in out.facets.iter_mut().zip(&out.owners) {
            let number = |node: u32| numbers.get(&(owner as usize, node)).copied();
            facet.nodes = facet.nodes.map(|node| number(node).unwrap_or(node));
        }
        Ok((out, copied))
    }

    /// The copies of mid-nodes, each with its tetrahedra, from the corners that have a copy: where the ends of an edge
    /// become different nodes, its mid-node does. The first keeps it, an edge that stays if there is one.
    fn copies_of_mids(&self, corners: &BTreeMap<u32, Vec<usize>>) -> Vec<(u32, Vec<usize>)> {
        let is_copied = |tet: usize, node: u32| corners.get(&node).is_some_and(|tets| tets.binary_search(&tet).is_ok());
        let ends = |tet: usize, edge: usize| EDGES[edge].map(|k| is_copied(tet, self.tets[tet][k]));
        let mut edges: BTreeMap<u32, BTreeMap<[bool; 2], Vec<usize>>> = BTreeMap::new();
        for &tet in corners.values().flatten() {
            let mids = self.mids[tet].iter().enumerate();
            let moved = mids.filter(|(edge, _)| ends(tet, *edge) != [false; 2]);
            edges.extend(moved.map(|(_, mid)| (*mid, BTreeMap::new())));
        }
        for (tet, mids) in self.mids.iter().enumerate() {
            for (edge, mid) in mids.iter().enumerate() {
                if let Some(found) = edges.get_mut(mid) {
                    // ends in one order in all tetrahedra
                    let [a, b] = EDGES[edge].map(|k| self.tets[tet][k]);
                    let [first, second] = ends(tet, edge);
                    let ends = if a < b { [first, second] } else { [second, first] };
                    found.entry(ends).or_default().push(tet);
                }
            }
        }
        let all = edges.into_iter();
        all.flat_map(|(mid, found)| found.into_values().skip(1).map(move |tets| (mid, tets)))
            .collect()
    }
}
