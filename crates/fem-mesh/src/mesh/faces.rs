//! Which tetrahedra meet at which face, in linear time.

use crate::tables::Lists;

use crate::tolerances::FACING;
use crate::vec3::{Vec3, dot};

use super::error::MeshError;

/// Faces of a tetrahedron, each opposite to the node of its number and numbered counter-clockwise
/// seen from outside.
pub(crate) const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// Stands for "no tetrahedron" in the table of neighbours.
pub(crate) const NONE: u32 = u32::MAX;

/// Nodes of the face `face` of `tet`, outward.
pub(crate) fn face_nodes(tet: &[u32; 4], face: usize) -> [u32; 3] {
    FACES[face].map(|i| tet[i])
}

/// The three nodes in ascending order, and whether an odd permutation brought them there.
fn sorted(mut f: [u32; 3]) -> ([u32; 3], bool) {
    let mut odd = false;
    for (i, j) in [(0, 1), (1, 2), (0, 1)] {
        if f[i] > f[j] {
            f.swap(i, j);
            odd = !odd;
        }
    }
    (f, odd)
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Entry {
    middle: u32,
    largest: u32,
    /// Four times the tetrahedron plus the face.
    slot: u32,
    odd: bool,
}

/// All faces, in lists by their smallest node, sorted inside.
pub(crate) struct FaceTable(Lists<Entry>);

impl FaceTable {
    /// Expects node numbers below `nodes`.
    pub(crate) fn new(nodes: usize, tets: &[[u32; 4]]) -> Self {
        let faces = tets.iter().flat_map(|tet| (0..4).map(|face| face_nodes(tet, face)));
        let smallest: Vec<u32> = faces.map(|[a, b, c]| a.min(b).min(c)).collect();
        let entry = |slot: u32| {
            let nodes = face_nodes(&tets[slot as usize / 4], slot as usize % 4);
            let ([_, middle, largest], odd) = sorted(nodes);
            Entry {
                middle,
                largest,
                slot,
                odd,
            }
        };
        let mut entries = Lists::by_key(nodes, &smallest).map(entry);
        (0..nodes).for_each(|node| entries.of_mut(node).sort_unstable());
        Self(entries)
    }

    /// The neighbour of each tetrahedron across each face, [`NONE`] at the boundary.
    pub(crate) fn neighbours(&self, tets: usize) -> Result<Vec<[u32; 4]>, MeshError> {
        let mut neighbours = vec![[NONE; 4]; tets];
        for smallest in 0..self.0.count() {
            let faces = self.0.of(smallest);
            for group in faces.chunk_by(|a, b| (a.middle, a.largest) == (b.middle, b.largest)) {
                let face = [smallest as u32, group[0].middle, group[0].largest];
                match group {
                    [_] => {}
                    [a, b] => {
                        let (first, second) = (a.slot / 4, b.slot / 4);
                        if a.odd == b.odd {
                            return Err(MeshError::OverlappingTets {
                                first: first as usize,
                                second: second as usize,
                                face,
                            });
                        }
                        neighbours[first as usize][(a.slot % 4) as usize] = second;
                        neighbours[second as usize][(b.slot % 4) as usize] = first;
                    }
                    _ => {
                        return Err(MeshError::FaceShared {
                            face,
                            count: group.len(),
                            first: (group[0].slot / 4) as usize,
                        });
                    }
                }
            }
        }
        Ok(neighbours)
    }

    /// The tetrahedra that have the three nodes as a face, and the number of this. Expects valid node numbers.
    pub(crate) fn sides(&self, nodes: [u32; 3]) -> impl Iterator<Item = (usize, usize)> {
        let ([smallest, middle, largest], _) = sorted(nodes);
        let faces = self.0.of(smallest as usize);
        let key = (middle, largest);
        let begin = faces.partition_point(|e| (e.middle, e.largest) < key);
        let found = faces[begin..].iter().take_while(move |e| (e.middle, e.largest) == key);
        found.map(|e| ((e.slot / 4) as usize, (e.slot % 4) as usize))
    }
}

/// Labels tetrahedra by the connected set they belong to, connected through faces across which
/// `joined(tet, neighbour)` holds. Labels follow the smallest tetrahedron of each set.
pub(crate) fn connected_sets(neighbours: &[[u32; 4]], joined: impl Fn(usize, usize) -> bool) -> Vec<u32> {
    let mut label = vec![NONE; neighbours.len()];
    let mut stack = Vec::new();
    let mut sets = 0;
    for seed in 0..neighbours.len() {
        if label[seed] != NONE {
            continue;
        }
        label[seed] = sets;
        stack.push(seed);
        while let Some(tet) = stack.pop() {
            for &other in &neighbours[tet] {
                if other != NONE && label[other as usize] == NONE && joined(tet, other as usize) {
                    label[other as usize] = sets;
                    stack.push(other as usize);
                }
            }
        }
        sets += 1;
    }
    label
}

/// Whether some of these unit normals and some of the others face each other, as those on both sides of a crack do.
pub(crate) fn face_each_other(normals: &[Vec3], others: &[Vec3]) -> bool {
    normals.iter().any(|a| others.iter().any(|b| dot(*a, *b) < -FACING))
}
