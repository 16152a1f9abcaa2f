//! Meshes from meshes: tagging, moving and joining, and repair of raw tables.

use crate::tables::DisjointSets;
use crate::vec3;

use super::check;
use super::curved;
use super::error::MeshError;
use super::faces::NONE;
use super::tet_mesh::{Facet, FacetTag, TetMesh};

impl TetMesh {
    /// Replaces all facets: every triangle of the boundary for which `tag(centroid, normal)` gives
    /// a tag gets it. The normal has unit length and points outward.
    #[must_use]
    pub fn tag_boundary(mut self, mut tag: impl FnMut([f64; 3], [f64; 3]) -> Option<FacetTag>) -> Self {
        self.facets.clear();
        self.owners.clear();
        for facet in self.boundary_facets() {
            let p = facet.nodes.map(|n| self.points[n as usize]);
            if let Some(tag) = tag(vec3::centroid(&p), vec3::unit(vec3::area_vector(&p))) {
                self.facets.push(Facet {
                    nodes: facet.nodes,
                    tag,
                });
                self.owners.push(facet.tet);
            }
        }
        self
    }

    /// Renames tags, for instance to keep those of two bodies apart before [`TetMesh::append`].
    #[must_use]
    pub fn map_tags(mut self, mut rename: impl FnMut(FacetTag) -> FacetTag) -> Self {
        for facet in &mut self.facets {
            facet.tag = rename(facet.tag);
        }
        self
    }

    /// Takes these tags off the boundary.
    #[must_use]
    pub fn without_tags(mut self, tags: &[FacetTag]) -> Self {
        let (facets, owners) = (std::mem::take(&mut self.facets), std::mem::take(&mut self.owners));
        let left = facets
            .into_iter()
            .zip(owners)
            .filter(|(facet, _)| !tags.contains(&facet.tag));
        (self.facets, self.owners) = left.unzip();
        self
    }

    /// Moves every node, including mid-nodes, to `map(point)`; connectivity, tags and regions stay. A nonlinear map
    /// makes curved edges. Nodes that coincide, as those of cracks, may still do so.
    ///
    /// # Errors
    /// [`MeshError`] if the mapped mesh is not valid, for instance inverted by a reflection.
    pub fn map_points(&self, map: impl FnMut([f64; 3]) -> [f64; 3]) -> Result<Self, MeshError> {
        let mut moved = self.clone();
        moved.points = self.points.iter().copied().map(map).collect();
        check::coordinates(&moved.points)?;
        check::shapes(&moved.points, &moved.tets)?;
        curved::check(&moved.points, &moved.tets, &moved.mids)?;
        check::no_coincident(&moved.points, &moved.tets, &moved.mids, |pairs| {
            moved.leave_cracks_out(pairs);
            let mut before = Vec::new();
            check::close_pairs(&self.points, 0.0, |pair| before.push(pair));
            before.sort_unstable();
            pairs.retain(|pair| before.binary_search(pair).is_err());
        })?;
        Ok(moved)
    }

    /// This mesh and `other`, numbered after it, as separate bodies. Tags and regions stay; node numbers of `other`
    /// increase by the number of nodes here. Whether bodies penetrate one another is not checked.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the sum is too large to be numbered, [`MeshError::MixedOrder`] of meshes of different
    /// orders.
    pub fn append(&self, other: &Self) -> Result<Self, MeshError> {
        let nodes = self.points.len() + other.points.len();
        let tets = self.tets.len() + other.tets.len();
        check::sizes(nodes, tets)?;
        let (first, second) = (self.order(), other.order());
        if first != second {
            return Err(MeshError::MixedOrder { first, second });
        }
        let (by_node, by_tet) = (self.points.len() as u32, self.tets.len() as u32);
        let mut sum = self.clone();
        sum.points.extend(&other.points);
        sum.tets.extend(other.tets.iter().map(|t| t.map(|n| n + by_node)));
        sum.mids.extend(other.mids.iter().map(|t| t.map(|n| n + by_node)));
        sum.facets.extend((other.facets.iter()).map(|f| Facet {
            nodes: f.nodes.map(|n| n + by_node),
            ..*f
        }));
        sum.owners.extend(other.owners.iter().map(|t| t + by_tet));
        sum.regions.extend(&other.regions);
        let shift = |n: u32| if n == NONE { n } else { n + by_tet };
        sum.neighbours.extend(other.neighbours.iter().map(|t| t.map(shift)));
        Ok(sum)
    }
}

/// Swaps the last two corners of every tetrahedron of negative volume, of ten nodes with the mid-nodes that go with
/// them, and returns how many there were. Tetrahedra that name unknown nodes are left for [`TetMesh::new`] to report.
pub fn orient_tets<const N: usize>(points: &[[f64; 3]], tets: &mut [[u32; N]]) -> usize {
    let mut turned = 0;
    for tet in tets {
        let Some(corners) = tet.first_chunk::<4>() else {
            continue;
        };
        let known = corners.iter().all(|&n| (n as usize) < points.len());
        if known && vec3::tet_volume(&corners.map(|n| points[n as usize])) < 0.0 {
            tet.swap(2, 3);
            if N == 10 {
                tet.swap(5, 8);
                tet.swap(6, 7);
            }
            turned += 1;
        }
    }
    turned
}

/// Merges nodes that are at most `distance` (m) apart, coincident ones with 0, to make one body of parts that were
/// meshed separately. Returns the number of merged nodes. Tetrahedra and facets then use the first node of each group;
/// the others stay in the table for [`drop_unused_nodes`].
///
/// The meshes of the parts must match where they meet. Leave out the facets there, which are now inside. Do not merge
/// bodies that are to slide on one another. Without a distance (negative, not a number) nothing is merged.
///
/// ```
/// use signorini_fem_mesh::{Brick, TetMesh};
/// use signorini_fem_mesh::mesh::{drop_unused_nodes, merge_nodes};
///
/// let lower = Brick::new([1.0; 3], [2, 2, 2]).build()?;
/// let upper = lower.map_points(|[x, y, z]| [x, y, z + 1.0])?;
/// let both = lower.append(&upper)?;
/// assert!(both.components().contains(&1));
///
/// let (mut points, mut tets) = (both.points().to_vec(), both.tets().to_vec());
/// assert_eq!(merge_nodes(&points, &mut tets, &mut [], 1e-9), 9);
/// drop_unused_nodes(&mut points, &mut tets, &mut []);
/// let one = TetMesh::new(points, tets, Vec::new())?.with_regions(both.regions().to_vec())?;
/// assert!(!one.components().contains(&1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn merge_nodes<const N: usize>(
    points: &[[f64; 3]],
    tets: &mut [[u32; N]],
    facets: &mut [Facet],
    distance: f64,
) -> usize {
    // what is not a number is no distance either
    if distance.is_nan() || distance < 0.0 {
        return 0;
    }
    let mut sets = DisjointSets::new(points.len());
    let (low, high) = check::extent(points.iter().copied());
    let is_all = distance >= vec3::norm(vec3::sub(high, low)) && points.iter().all(|p| vec3::is_finite(*p));
    if is_all {
        (1..points.len()).for_each(|node| sets.join(0, node));
    } else {
        check::close_pairs(points, distance, |(a, b)| sets.join(a, b));
    }
    let first: Vec<u32> = (0..points.len()).map(|n| sets.first(n) as u32).collect();
    // numbers out of range are left for TetMesh::new to report
    let renumber = |node: u32| first.get(node as usize).copied().unwrap_or(node);
    tets.iter_mut().for_each(|t| *t = t.map(renumber));
    facets.iter_mut().for_each(|f| f.nodes = f.nodes.map(renumber));
    (0..first.len()).filter(|&n| first[n] as usize != n).count()
}

/// Removes nodes that no tetrahedron uses and renumbers the others in the same order. Returns,
/// for each node that stays, its old number. Facets that use a removed node, and numbers out of
/// range, are left with a number out of range for [`TetMesh::new`] to report.
pub fn drop_unused_nodes<const N: usize>(
    points: &mut Vec<[f64; 3]>,
    tets: &mut [[u32; N]],
    facets: &mut [Facet],
) -> Vec<u32> {
    const GONE: u32 = u32::MAX;
    let mut new_number = vec![GONE; points.len()];
    for &node in tets.iter().flatten() {
        if let Some(number) = new_number.get_mut(node as usize) {
            *number = 0;
        }
    }
    let mut kept = Vec::new();
    for (old, number) in new_number.iter_mut().enumerate() {
        if *number != GONE {
            *number = kept.len() as u32;
            kept.push(old as u32);
        }
    }
    let renumber = |node: u32| new_number.get(node as usize).copied().unwrap_or(GONE);
    tets.iter_mut().for_each(|t| *t = t.map(renumber));
    facets.iter_mut().for_each(|f| f.nodes = f.nodes.map(renumber));
    *points = kept.iter().map(|&old| points[old as usize]).collect();
    kept
}
