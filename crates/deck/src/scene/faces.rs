//! Faces of elements that surfaces and pressures name, and their tags.
//!
//! A facet of a mesh has one tag, a face of a deck may be in several surfaces and under pressure besides. Faces
//! with the same surfaces and the same pressure get one tag, so that a surface is a list of tags: one where
//! nothing overlaps.

use std::collections::HashMap;

use signorini_fem_mesh::internal::distinct;
use signorini_fem_mesh::{Facet, FacetTag, vec3};

use super::couplings::Couplings;
use super::mesh::Raw;
use super::numbers::Sets;
use super::rigid::{RigidBodies, RigidFace};
use super::timeline::Timeline;
use super::transforms::Transforms;
use crate::error::{DeckError, Fault, Word};
use crate::model::{FACES, Model, Names, Side, Target};

#[derive(Debug)]
pub(super) struct Face {
    pub(super) nodes: [u32; 3],
    /// The tetrahedron that names it first, and the number of the face there.
    tet: u32,
    number: u8,
    word: Word,
    /// Positions of the surfaces that it is in, ascending.
    surfaces: Vec<u32>,
    /// Its pressure, if it has one.
    pub(super) pressure: Option<u32>,
}

/// All faces that are named, in the order in which they are.
#[derive(Debug, Default)]
pub(super) struct FaceTable {
    pub(super) list: Vec<Face>,
    places: HashMap<[u32; 3], u32>,
    /// Rigid faces of each surface.
    pub(super) rigid: Vec<Vec<RigidFace>>,
}

/// What is known of the model where faces are looked up and conditions followed.
#[derive(Clone, Copy)]
pub(super) struct Known<'a> {
    pub(super) model: &'a Model,
    pub(super) sets: &'a Sets<'a>,
    pub(super) bodies: &'a RigidBodies,
    pub(super) raw: &'a Raw,
    pub(super) timeline: &'a Timeline<'a>,
    pub(super) couplings: &'a Couplings,
    pub(super) transforms: &'a Transforms,
}

fn key(mut nodes: [u32; 3]) -> [u32; 3] {
    nodes.sort_unstable();
    nodes
}

impl FaceTable {
    /// The position of a face (1 to 4) of a tetrahedron, noted at its first appearance.
    fn face(&mut self, raw: &Raw, tet: u32, number: u8, word: &Word) -> u32 {
        let corners = raw.tets[tet as usize];
        let nodes = FACES[usize::from(number) - 1].map(|i| corners[i]);
        let next = self.list.len() as u32;
        let position = *self.places.entry(key(nodes)).or_insert(next);
        if position == next {
            self.list.push(Face {
                nodes,
                tet,
                number,
                word: word.clone(),
                surfaces: Vec::new(),
                pressure: None,
            });
        }
        position
    }

    /// Positions of the faces with a number, of the elements of a target, none of which may be rigid.
    pub(super) fn of_target(
        &mut self,
        known: Known,
        (target, number): (&Target, u8),
        word: &Word,
    ) -> Result<Vec<u32>, DeckError> {
        let mut faces = Vec::new();
        for element in known.sets.elements.find(target, word)? {
            let Some(tet) = known.raw.tet(element) else {
                return Err(word.cannot("a pressure on a rigid body acts on nothing; load elastic elements"));
            };
            faces.push(self.face(known.raw, tet, number, word));
        }
        Ok(faces)
    }

    /// Notes the faces of all surfaces, and gives the elastic ones surface by surface.
    pub(super) fn surfaces(&mut self, known: Known) -> Result<Vec<Vec<u32>>, DeckError> {
        let mut out = Vec::new();
        for (index, (_, faces)) in known.model.surfaces.iter().enumerate() {
            let (mut all, mut rigid) = (Vec::new(), Vec::new());
            for faces in faces {
                let word = &faces.word;
                for element in known.sets.elements.find(&faces.target, word)? {
                    let Some(tet) = known.raw.tet(element) else {
                        let side = (element, faces.side);
                        rigid.push(known.bodies.face(known.sets, side, word)?);
                        continue;
                    };
                    let Side::Face(number) = faces.side else {
                        return Err(word.expected("faces S1 to S4 of solid elements"));
                    };
                    let face = self.face(known.raw, tet, number, word);
                    let surfaces = &mut self.list[face as usize].surfaces;
                    if surfaces.last() != Some(&(index as u32)) {
                        surfaces.push(index as u32);
                        all.push(face);
                    }
                }
                if !all.is_empty() && !rigid.is_empty() {
                    return Err(word.cannot("the surface has rigid and elastic faces; make two surfaces of them"));
                }
            }
            out.push(all);
            self.rigid.push(rigid);
        }
        Ok(out)
    }

    /// Refuses faces between two elements.
    pub(super) fn check_outside(&self, raw: &Raw) -> Result<(), DeckError> {
        let mut owners = vec![0_u8; self.list.len()];
        for tet in &raw.tets {
            for face in FACES {
                if let Some(&at) = self.places.get(&key(face.map(|i| tet[i]))) {
                    owners[at as usize] = owners[at as usize].saturating_add(1);
                }
            }
        }
        match self.list.iter().zip(owners).find(|(_, owners)| *owners > 1) {
            Some((face, _)) => Err(face.word.fault(Fault::FaceInside {
                element: raw.element_labels[face.tet as usize],
                face: face.number,
            })),
            None => Ok(()),
        }
    }

    pub(super) fn of_surface(&self, surface: u32) -> impl Iterator<Item = &Face> {
        self.list.iter().filter(move |f| f.surfaces.contains(&surface))
    }

    /// The nodes of a surface: their numbers in the deck and places.
    pub(super) fn nodes_of(&self, raw: &Raw, surface: u32) -> Vec<(u32, [f64; 3])> {
        let nodes = distinct(self.of_surface(surface).flat_map(|face| face.nodes));
        let place = |n: u32| (raw.node_labels[n as usize], raw.points[n as usize]);
        nodes.into_iter().map(place).collect()
    }

    /// The triangles of a surface, the faces of quadratic elements as four each.
    pub(super) fn triangles_of(&self, raw: &Raw, surface: u32) -> Vec<[u32; 3]> {
        let on = self.of_surface(surface);
        on.flat_map(|face| raw.triangles(face.tet, face.nodes)).collect()
    }

    /// The tag of each face, from 1 in the order of the faces.
    pub(super) fn tags(&self) -> Vec<FacetTag> {
        let mut known = HashMap::new();
        let faces = self.list.iter().map(|face| {
            let next = known.len() as u32 + 1;
            let kind = (face.surfaces.as_slice(), face.pressure);
            FacetTag(*known.entry(kind).or_insert(next))
        });
        faces.collect()
    }

    pub(super) fn facets(&self, tags: &[FacetTag]) -> Vec<Facet> {
        let pairs = self.list.iter().zip(tags);
        let facet = |(face, tag): (&Face, &FacetTag)| Facet {
            nodes: face.nodes,
            tag: *tag,
        };
        pairs.map(facet).collect()
    }

    /// The tags of each surface, ascending.
    pub(super) fn tags_of(&self, tags: &[FacetTag], model: &Model) -> Names<Vec<FacetTag>> {
        let mut lists = vec![Vec::new(); model.surfaces.names().len()];
        for (face, tag) in self.list.iter().zip(tags) {
            for &surface in &face.surfaces {
                lists[surface as usize].push(*tag);
            }
        }
        let mut names = Names::default();
        for (name, list) in model.surfaces.names().into_iter().zip(lists) {
            names.add(name, distinct(list));
        }
        names
    }
}

impl Face {
    /// The nodes that share the force of a constant pressure evenly.
    pub(super) fn loaded(&self, raw: &Raw) -> [u32; 3] {
        raw.loaded(self.tet, self.nodes)
    }

    /// Its area along the outward normal.
    pub(super) fn area_vector(&self, raw: &Raw) -> [f64; 3] {
        let [a, b, c] = self.nodes.map(|n| raw.points[n as usize]);
        let area = vec3::area_vector(&[a, b, c]);
        let inside = raw.tet_points(self.tet);
        let centre = [0, 1, 2].map(|i| inside.iter().map(|p| p[i]).sum::<f64>() / 4.0);
        let out: f64 = (0..3).map(|i| area[i] * (a[i] - centre[i])).sum();
        if out < 0.0 { area.map(|x| -x) } else { area }
    }
}
