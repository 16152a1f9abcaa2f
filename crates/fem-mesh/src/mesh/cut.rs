//! Meshes that are cut open inside.

use crate::tables::DisjointSets;
use std::collections::BTreeMap;

use super::check;
use super::error::MeshError;
use super::faces::{NONE, face_nodes};
use super::tet_mesh::{Facet, FacetTag, TetMesh};

impl TetMesh {
    /// Cuts the mesh open along all faces between tetrahedra of which `is_first(tet)` is `Some(true)` and `Some(false)`;
    /// those with `None` stay joined with both. The facets of the first side get the first tag, those of the other the
    /// second one, beside those that have them already. Nodes of the cut stay with the first side; the other side has copies of
    /// them, numbered behind all nodes, which have the list of these nodes in this order. What of a side hangs together by an
    /// edge or a node only still does.
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
        let mut out = self.clone();
        // tetrahedra around the nodes of the cut
        let mut around: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (tet, side) in sides.iter().enumerate() {
            let Some(first) = *side else {
                continue;
            };
            for (face, other) in self.neighbours(tet).into_iter().enumerate() {
                if other.is_none_or(|other| sides[other] != Some(!first)) {
                    continue;
                }
                let nodes = face_nodes(&self.tets[tet], face);
                let tag = tags[usize::from(!first)];
                out.neighbours[tet][face] = NONE;
                out.facets.push(Facet { nodes, tag });
                out.owners.push(tet as u32);
                around.extend(nodes.map(|node| (node, Vec::new())));
                if self.order() == 2 {
                    around.extend(self.mids_of(tet, nodes).map(|node| (node, Vec::new())));
                }
            }
        }
        if around.is_empty() {
            return Err(MeshError::NoCut);
        }
        for tet in 0..self.tets.len() {
            for node in self.nodes_of(tet) {
                if let Some(tets) = around.get_mut(&node) {
                    tets.push(tet);
                }
            }
        }
        let mut copied = Vec::new();
        let mut copies: BTreeMap<(usize, u32), u32> = BTreeMap::new();
        for (&node, tets) in &around {
            let mut sets = DisjointSets::new(tets.len());
            for (k, &tet) in tets.iter().enumerate() {
                for other in out.neighbours(tet).into_iter().flatten() {
                    if let Ok(other) = tets.binary_search(&other) {
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
                return Err(MeshError::CutEnds { node });
            }
            let copy = (self.points.len() + copied.len()) as u32;
            for (k, &tet) in tets.iter().enumerate() {
                if found.get(&sets.first(k)) == Some(&[false, true]) {
                    copies.insert((tet, node), copy);
                }
            }
            copied.push(node);
            out.points.push(self.points[node as usize]);
        }
        check::sizes(out.points.len(), out.tets.len())?;
        for (&(tet, node), &copy) in &copies {
            let mids = out.mids.get_mut(tet).into_iter().flatten();
            let places = out.tets[tet].iter_mut().chain(mids);
            places.filter(|place| **place == node).for_each(|place| *place = copy);
        }
        for (facet, &owner) in out.facets.iter_mut().zip(&out.owners) {
            let copy = |node: u32| copies.get(&(owner as usize, node)).copied();
            facet.nodes = facet.nodes.map(|node| copy(node).unwrap_or(node));
        }
        Ok((out, copied))
    }

    /// All nodes of a tetrahedron.
    fn nodes_of(&self, tet: usize) -> impl Iterator<Item = u32> {
        let mids = self.mids.get(tet).into_iter().flatten();
        self.tets[tet].iter().chain(mids).copied()
    }
}
