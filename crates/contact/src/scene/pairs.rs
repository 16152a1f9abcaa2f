//! Surfaces of different bodies that face each other, found by their distance.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use signorini_fem_mesh::internal::{DisjointSets, ascending};
use signorini_fem_mesh::vec3::{Vec3, add, area_vector, combine, cross, dot, scale, sub, unit};
use signorini_fem_mesh::{FacetTag, TetMesh};

use super::contact::{CREASE, Contact};
use crate::error::ContactError;
use crate::tolerances::{COVERED, FACING, TO_CREASE};

/// Places in a facet from which others are looked for, in barycentric coordinates: its middle, and near its corners and
/// the middles of its edges.
const FROM: [[f64; 3]; 7] = [
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
    [0.96, 0.02, 0.02],
    [0.02, 0.96, 0.02],
    [0.02, 0.02, 0.96],
    [0.49, 0.49, 0.02],
    [0.02, 0.49, 0.49],
    [0.49, 0.02, 0.49],
];

/// Two surfaces of different bodies that face each other.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ContactPair {
    /// The bodies, as [`TetMesh::components`] counts them, ascending.
    pub bodies: [u32; 2],
    /// Tags of the surface of each. A facet that faces several bodies is in several pairs, by a tag of its own.
    pub tags: [Vec<FacetTag>; 2],
    /// The smallest and the largest distance along the normals that was measured, m; negative in each other, also where
    /// [contact closes overlaps](Contact::with_measured_overlaps).
    pub gaps: [f64; 2],
}

impl ContactPair {
    /// Finds all pairs of a mesh of several bodies: facets of the boundary **without a tag** that others face within a
    /// distance of `reach` (m), in front of them or in each other. They get tags that are not in use; facets with a
    /// tag, of supports and loads, stay as they are; [`TetMesh::without_tags`] takes those of whole surfaces off. Sides
    /// that meet at a crease of 60 degrees make pairs of their own.
    ///
    /// ```
    /// # use signorini_contact::{ContactPair, Friction};
    /// # use signorini_fem_mesh::{Brick, FacetTag, brick};
    /// // a cube 0.1 mm above a plate, both with tags only where they are held and loaded
    /// let plate = Brick::new([3.0, 3.0, 0.5], [6, 6, 1]).build()?;
    /// let plate = plate.tag_boundary(|_, normal| (normal[2] < -0.5).then_some(FacetTag(1)));
    /// let cube = Brick::new([1.0; 3], [3; 3]).with_origin([1.0, 1.0, 0.5001]).build()?;
    /// let cube = cube.tag_boundary(|_, normal| (normal[2] > 0.5).then_some(FacetTag(2)));
    /// let (mesh, pairs) = ContactPair::find(plate.append(&cube)?, 1e-3)?;
    /// assert_eq!((pairs.len(), pairs[0].bodies), (1, [0, 1]));
    /// let contacts = pairs.iter().map(|pair| pair.contact().with_friction(Friction::coulomb(0.2)));
    /// # assert_eq!((contacts.count(), mesh.tags().len()), (1, 4));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ContactError::Setting`] unless `reach` is positive and finite; [`ContactError::TaggedSides`] if no two of
    /// several bodies have facets without a tag, as those of [`Brick`](signorini_fem_mesh::Brick), which all have one.
    pub fn find(mesh: TetMesh, reach: f64) -> Result<(TetMesh, Vec<Self>), ContactError> {
        ContactError::check(reach.is_finite() && reach > 0.0, "reach", reach, "(0, inf)")?;
        let boundary = Boundary::new(&mesh);
        let bodies = boundary.bodies.iter().copied().collect::<BTreeSet<u32>>().len();
        let open = boundary.bodies.iter().zip(&boundary.tags);
        let open: BTreeSet<u32> = open.filter_map(|(body, tag)| tag.is_none().then_some(*body)).collect();
        if bodies > 1 && open.len() < 2 {
            return Err(ContactError::TaggedSides { bodies });
        }
        let seen: Vec<Vec<(u32, f64)>> = (0..boundary.corners.len())
            .into_par_iter()
            .map(|facet| boundary.seen_from(facet, reach))
            .collect();
        let mut of_bodies: BTreeMap<[u32; 2], Vec<([u32; 2], f64)>> = BTreeMap::new();
        for (facet, others) in (0..).zip(&seen) {
            for &(other, gap) in others {
                let mut both = [facet, other];
                both.sort_by_key(|f| boundary.body(*f));
                let bodies = both.map(|f| boundary.body(f));
                of_bodies.entry(bodies).or_default().push((both, gap));
            }
        }
        let mut pairs = Vec::new();
        let mut members: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); boundary.corners.len()];
        for (bodies, seen) in of_bodies {
            let sets = boundary.sides(&seen);
            let first = pairs.len();
            for ([own, other], gap) in seen {
                let pair = first + sets[&own] as usize;
                if pair == pairs.len() {
                    pairs.push(Self {
                        bodies,
                        tags: Default::default(),
                        gaps: [gap; 2],
                    });
                }
                let gaps = &mut pairs[pair].gaps;
                *gaps = [gaps[0].min(gap), gaps[1].max(gap)];
                members[own as usize].insert(pair);
                members[other as usize].insert(pair);
            }
        }
        let known = mesh.tags();
        let mut unused = (1..=u32::MAX)
            .map(FacetTag)
            .filter(|tag| known.binary_search(tag).is_err());
        let mut tags: BTreeMap<(u32, &BTreeSet<usize>), FacetTag> = BTreeMap::new();
        let mut given = boundary.tags.clone();
        for ((facet, of), tag) in (0..)
            .zip(&members)
            .zip(&mut given)
            .filter(|((_, of), _)| !of.is_empty())
        {
            let body = boundary.body(facet);
            // a mesh has fewer faces than there are tags
            let new = tags
                .entry((body, of))
                .or_insert_with(|| unused.next().unwrap_or_default());
            *tag = Some(*new);
        }
        for ((body, of), tag) in tags {
            for &pair in of {
                let side = usize::from(pairs[pair].bodies[0] != body);
                pairs[pair].tags[side].push(tag);
            }
        }
        let mut given = given.into_iter();
        Ok((mesh.tag_boundary(|_, _| given.next().flatten()), pairs))
    }

    /// A contact of the two sides.
    pub fn contact(&self) -> Contact {
        let [own, partner] = &self.tags;
        let mut contact = Contact::between(FacetTag::default(), FacetTag::default());
        contact.tags.clone_from(own);
        contact.partner.clone_from(partner);
        contact
    }
}

/// The boundary of all bodies.
struct Boundary {
    nodes: Vec<[u32; 3]>,
    corners: Vec<[Vec3; 3]>,
    normals: Vec<Vec3>,
    bodies: Vec<u32>,
    tags: Vec<Option<FacetTag>>,
    tree: RTree<GeomWithData<Rectangle<Vec3>, u32>>,
}

impl Boundary {
    fn new(mesh: &TetMesh) -> Self {
        let (facets, components) = (mesh.boundary_facets(), mesh.components());
        let tagged = mesh.facets().iter().map(|f| (ascending(f.nodes), f.tag));
        let tagged: HashMap<[u32; 3], FacetTag> = tagged.collect();
        let nodes: Vec<[u32; 3]> = facets.iter().map(|f| f.nodes).collect();
        let tags: Vec<Option<FacetTag>> = nodes.iter().map(|f| tagged.get(&ascending(*f)).copied()).collect();
        let corners: Vec<[Vec3; 3]> = nodes.iter().map(|f| f.map(|n| mesh.points()[n as usize])).collect();
        let boxes = (0..).zip(&corners);
        let boxes = boxes.map(|(k, c)| GeomWithData::new(Rectangle::from_aabb(AABB::from_points(c)), k));
        Self {
            normals: corners.iter().map(|c| unit(area_vector(c))).collect(),
            bodies: facets.iter().map(|f| components[f.tet as usize]).collect(),
            tree: RTree::bulk_load(boxes.collect()),
            nodes,
            corners,
            tags,
        }
    }

    fn body(&self, facet: u32) -> u32 {
        self.bodies[facet as usize]
    }

    /// The facets of other bodies that a facet without a tag faces, the nearest at each place, with their distance.
    fn seen_from(&self, facet: usize, reach: f64) -> Vec<(u32, f64)> {
        let normal = self.normals[facet];
        let from = FROM.iter().filter(|_| self.tags[facet].is_none());
        from.filter_map(|at| {
            let place = combine(&self.corners[facet], *at);
            let seen = [reach, -reach].into_iter().filter_map(|reach| {
                let end = add(place, scale(reach, normal));
                let near = self
                    .tree
                    .locate_in_envelope_intersecting(&AABB::from_corners(place, end));
                let others = near.filter(|other| other.data as usize != facet);
                let seen = others.filter_map(|other| Some((other.data, self.distance(place, normal, other.data)?)));
                let within = seen.filter(|(_, distance)| (0.0..=1.0).contains(&(distance / reach)));
                // the body's own far side, and what has a tag, hides what lies behind
                let nearest = within.min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()).then(a.0.cmp(&b.0)));
                nearest.filter(|(other, _)| {
                    self.bodies[*other as usize] != self.bodies[facet] && self.tags[*other as usize].is_none()
                })
            });
            seen.min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        })
        .collect()
    }

    /// How far a facet is from a place along a normal that it faces.
    fn distance(&self, place: Vec3, normal: Vec3, facet: u32) -> Option<f64> {
        let (corners, own) = (&self.corners[facet as usize], self.normals[facet as usize]);
        let facing = -dot(own, normal);
        if facing < FACING {
            return None;
        }
        let distance = dot(sub(place, corners[0]), own) / facing;
        let there = add(place, scale(distance, normal));
        let whole = dot(area_vector(corners), own);
        let is_over = [[0, 1], [1, 2], [2, 0]].iter().all(|&[a, b]| {
            let part = 0.5 * dot(cross(sub(corners[a], there), sub(corners[b], there)), own);
            part >= -COVERED * whole
        });
        is_over.then_some(distance)
    }

    /// The side that each facet belongs to: those that see each other, and neighbours that do not meet at a crease.
    fn sides(&self, seen: &[([u32; 2], f64)]) -> HashMap<u32, u32> {
        let mut places: HashMap<u32, usize> = HashMap::new();
        let mut facets = Vec::new();
        for facet in seen.iter().flat_map(|(both, _)| both) {
            places.entry(*facet).or_insert_with(|| {
                facets.push(*facet);
                facets.len() - 1
            });
        }
        let mut sets = DisjointSets::new(facets.len());
        for ([own, other], _) in seen {
            sets.join(places[own], places[other]);
        }
        let limit = CREASE.to_radians().cos() + TO_CREASE;
        let mut edges: HashMap<[u32; 2], usize> = HashMap::new();
        for (place, facet) in facets.iter().enumerate() {
            let [a, b, c] = ascending(self.nodes[*facet as usize]);
            for edge in [[a, b], [b, c], [a, c]] {
                let Some(&before) = edges.get(&edge) else {
                    edges.insert(edge, place);
                    continue;
                };
                let normals = [facets[before], *facet].map(|f| self.normals[f as usize]);
                if dot(normals[0], normals[1]) > limit {
                    sets.join(before, place);
                }
            }
        }
        facets.into_iter().zip(sets.numbers()).collect()
    }
}
