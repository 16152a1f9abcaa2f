//! Faces on the boundary, for surfaces that are given by elements or by nodes only.

use signorini_fem_mesh::internal::{TET_FACES, ascending};
use std::collections::BTreeMap;

use super::mesh::Raw;

/// Tetrahedra and numbers of the faces that no two of them share.
#[derive(Debug)]
pub(super) struct Boundary {
    /// Ascending.
    faces: Vec<(u32, u8)>,
    of_corners: BTreeMap<[u32; 3], (u32, u8)>,
}

impl Boundary {
    pub(super) fn new(raw: &Raw) -> Self {
        let mut of_corners: BTreeMap<[u32; 3], Option<(u32, u8)>> = BTreeMap::new();
        for (tet, corners) in (0..).zip(&raw.tets) {
            for (number, face) in (1..).zip(TET_FACES) {
                let corners = ascending(face.map(|i| corners[i]));
                let first = of_corners.entry(corners).and_modify(|face| *face = None);
                first.or_insert(Some((tet, number)));
            }
        }
        let outside = of_corners.into_iter().filter_map(|(key, face)| Some((key, face?)));
        let of_corners: BTreeMap<_, _> = outside.collect();
        let mut faces: Vec<_> = of_corners.values().copied().collect();
        faces.sort_unstable();
        Self { faces, of_corners }
    }

    /// That which is kept, made where it is first asked for.
    pub(super) fn of<'a>(kept: &'a mut Option<Self>, raw: &Raw) -> &'a Self {
        kept.get_or_insert_with(|| Self::new(raw))
    }

    /// That with some corners.
    pub(super) fn of_corners(&self, corners: [u32; 3]) -> Option<(u32, u8)> {
        self.of_corners.get(&ascending(corners)).copied()
    }

    /// Those of some tetrahedra, ascending as these.
    pub(super) fn of_tets(&self, tets: impl Iterator<Item = u32>) -> Vec<(u32, u8)> {
        let of = |tet: u32| {
            let start = self.faces.partition_point(|face| face.0 < tet);
            self.faces[start..].iter().take_while(move |face| face.0 == tet)
        };
        tets.flat_map(of).copied().collect()
    }

    /// Those whose corners are all among some nodes, ascending, and a node, if there is one, that none of them uses.
    pub(super) fn of_nodes(&self, raw: &Raw, nodes: &[u32]) -> (Vec<(u32, u8)>, Option<u32>) {
        let among = |node: &u32| nodes.binary_search(node).is_ok();
        // a face of an element as a whole
        let is_among = |&(tet, number): &(u32, u8)| {
            let mut parts = raw.parts_of_face(tet, number);
            parts.all(|(tet, number)| raw.face(tet, number).iter().all(among))
        };
        let faces: Vec<_> = self.faces.iter().copied().filter(is_among).collect();
        let mut used: Vec<u32> = Vec::new();
        for &(tet, number) in &faces {
            let corners = raw.face(tet, number);
            used.extend(corners.into_iter().chain(raw.loaded(tet, corners)));
        }
        used.sort_unstable();
        let alone = nodes.iter().find(|node| used.binary_search(node).is_err());
        (faces, alone.copied())
    }
}
