//! Faces of elements that surfaces and pressures name, and their tags.
//!
//! A facet of a mesh has one tag, a face of a deck may be in several surfaces and under pressure besides. Faces
//! with the same surfaces and the same pressure get one tag, so that a surface is a list of tags: one where
//! nothing overlaps.

use std::collections::{BTreeSet, HashMap, HashSet};

use signorini_fem_mesh::internal::{TET_FACES, ascending, distinct};
use signorini_fem_mesh::mesh::divide_face;
use signorini_fem_mesh::vec3::Vec3;
use signorini_fem_mesh::{Facet, FacetTag};

use super::boundary::Boundary;
use super::known::Known;
use super::mesh::Raw;
use super::rigid_face::RigidFace;
use crate::error::{DeckError, Fault, Word};
use crate::model::{Faces, Ignored, Kind, Model, Names, Side, Target};

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

impl FaceTable {
    /// The position of a face (1 to 4) of a tetrahedron, noted at its first appearance.
    fn face(&mut self, raw: &Raw, tet: u32, number: u8, word: &Word) -> u32 {
        let nodes = raw.face(tet, number);
        let next = self.list.len() as u32;
        let position = *self.places.entry(ascending(nodes)).or_insert(next);
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
            if known.raw.tets_of(element).is_empty() {
                return Err(word.cannot("a pressure on what is not elastic acts on nothing; load elastic elements"));
            }
            let own = known.face_of(element, number, word)?;
            faces.extend(own.map(|(tet, number)| self.face(known.raw, tet, number, word)));
        }
        Ok(faces)
    }

    /// Notes the faces of all surfaces, and gives the elastic ones surface by surface. One inside the body that no card
    /// uses (a cut of which forces are printed) is left out.
    pub(super) fn surfaces(&mut self, known: Known, ignored: &mut Vec<Ignored>) -> Result<Vec<Vec<u32>>, DeckError> {
        let mut out = Vec::new();
        let mut boundary = None;
        let used = known.model.used_surfaces();
        for (index, (name, lines)) in (0..).zip(known.model.surfaces.iter()) {
            let mut chosen = if known.sections.is_across(index as usize) {
                Chosen::default()
            } else {
                known.chosen(lines, &mut boundary, ignored)?
            };
            if !used.contains(name) && !chosen.is_outside(known.raw, &mut boundary) {
                let why = "the surface has faces between two elements, and no card that is read uses it";
                ignored.push(Ignored::new(&lines[0].word, why));
                chosen = Chosen::default();
            }
            let add = |(face, word): ((u32, u8), &Word)| self.add(known.raw, face, index, word);
            out.push(chosen.faces.into_iter().filter_map(add).collect());
            self.rigid.push(chosen.rigid);
        }
        Ok(out)
    }

    /// Notes a face of a surface; its position, unless it is in it already.
    fn add(&mut self, raw: &Raw, (tet, number): (u32, u8), surface: u32, word: &Word) -> Option<u32> {
        let face = self.face(raw, tet, number, word);
        let surfaces = &mut self.list[face as usize].surfaces;
        let new = surfaces.last() != Some(&surface);
        new.then(|| surfaces.push(surface)).map(|()| face)
    }

    /// Refuses faces between two elements.
    pub(super) fn check_outside(&self, raw: &Raw) -> Result<(), DeckError> {
        let mut owners = vec![0_u8; self.list.len()];
        for tet in &raw.tets {
            for face in TET_FACES {
                if let Some(&at) = self.places.get(&ascending(face.map(|i| tet[i]))) {
                    owners[at as usize] = owners[at as usize].saturating_add(1);
                }
            }
        }
        match self.list.iter().zip(owners).find(|(_, owners)| *owners > 1) {
            Some((face, _)) => Err(face.word.fault(Fault::FaceInside {
                element: raw.element_labels[face.tet as usize],
                face: raw.face_of_element(face.tet, face.number),
            })),
            None => Ok(()),
        }
    }

    pub(super) fn of_surface(&self, surface: u32) -> impl Iterator<Item = &Face> {
        self.list.iter().filter(move |f| f.surfaces.contains(&surface))
    }

    /// Where the corners of a surface are.
    pub(super) fn places_of(&self, raw: &Raw, surface: u32) -> Vec<[f64; 3]> {
        let nodes = distinct(self.of_surface(surface).flat_map(|face| face.nodes));
        nodes.into_iter().map(|n| raw.points[n as usize]).collect()
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
        let mut lists = vec![Vec::new(); model.surfaces.len()];
        for (face, tag) in self.list.iter().zip(tags) {
            for &surface in &face.surfaces {
                lists[surface as usize].push(*tag);
            }
        }
        let mut names = Names::default();
        for ((name, _), list) in model.surfaces.iter().zip(lists) {
            names.add(name.to_owned(), distinct(list));
        }
        names
    }
}

/// The faces of a surface of nodes.
fn of_nodes(
    known: Known,
    boundary: &Boundary,
    lines: &[Faces],
    ignored: &mut Vec<Ignored>,
) -> Result<Vec<(u32, u8)>, DeckError> {
    let word = &lines[0].word;
    let mut nodes = Vec::new();
    // how many they are behind each line
    let mut ends = Vec::with_capacity(lines.len());
    for line in lines {
        for node in known.sets.nodes.find(&line.target, &line.word)? {
            nodes.push(known.raw.in_mesh(node).ok_or_else(|| {
                let label = known.model.nodes[node as usize].label;
                (line.word).cannot(format!(
                    "no elastic element uses node {label}; leave it out of the surface"
                ))
            })?);
        }
        ends.push(nodes.len());
    }
    let (faces, alone) = boundary.of_nodes(known.raw, &distinct(nodes.clone()));
    if let Some(node) = alone {
        let named = nodes.iter().take_while(|n| **n != node).count();
        let line = &lines[ends.partition_point(|end| *end <= named)];
        return Err(line.word.cannot(format!(
            "node {} is on no face of the boundary whose corners are all in this surface of nodes, and forces act on \
            faces here; add its neighbours, or leave it out",
            known.raw.node_labels[node as usize]
        )));
    }
    let why = format!(
        "the surface is that of the {} faces of the boundary whose corners are all in it",
        faces.len()
    );
    ignored.push(Ignored::new(&word.part("TYPE=NODE"), why));
    Ok(faces)
}

/// The faces of tetrahedra that a triangle or quadrilateral of the deck, by its position, lies on.
fn of_flat(
    known: Known,
    boundary: &Boundary,
    element: u32,
    (side, word): (Side, &Word),
) -> Result<Vec<(u32, u8)>, DeckError> {
    let element = &known.model.elements[element as usize];
    if element.kind != Kind::Flat || side != Side::Outside {
        return Err(word.expected("solid elements, or triangles without a number of a face"));
    }
    let of_triangle = |corners: [u32; 3]| {
        let [a, b, c] = corners.map(|n| known.raw.in_mesh(n));
        boundary.of_corners([a?, b?, c?])
    };
    let nodes = known.sets.nodes_of(element)?;
    let faces: Option<Vec<_>> = divide_face(&nodes).map(of_triangle).collect();
    faces.ok_or_else(|| {
        let why = "no face of a solid element on the boundary has the corners of the flat element";
        word.cannot(format!("{why} {}; leave it out of the surface", element.label))
    })
}

/// The faces of a surface.
#[derive(Default)]
struct Chosen<'a> {
    /// Of tetrahedra, with the words that name them.
    faces: Vec<((u32, u8), &'a Word)>,
    rigid: Vec<RigidFace>,
}

impl Chosen<'_> {
    /// Whether all are on the boundary.
    fn is_outside(&self, raw: &Raw, boundary: &mut Option<Boundary>) -> bool {
        let is_outside = |((tet, number), _): &((u32, u8), &Word)| {
            Boundary::of(boundary, raw)
                .of_corners(raw.face(*tet, *number))
                .is_some()
        };
        self.faces.iter().all(is_outside)
    }
}

impl Known<'_> {
    /// The faces that the lines of a surface name.
    fn chosen<'a>(
        self,
        lines: &'a [Faces],
        boundary: &mut Option<Boundary>,
        ignored: &mut Vec<Ignored>,
    ) -> Result<Chosen<'a>, DeckError> {
        let mut chosen = Chosen::default();
        if lines.iter().any(|line| line.side == Side::Nodes) {
            let faces = of_nodes(self, Boundary::of(boundary, self.raw), lines, ignored)?;
            chosen
                .faces
                .extend(faces.into_iter().map(|face| (face, &lines[0].word)));
            return Ok(chosen);
        }
        // the first line that names elements without their faces
        let mut whole = None;
        // lines may say the same many times
        let (mut said, mut known) = (BTreeSet::new(), HashSet::new());
        for Faces { target, side, word } in lines.iter().filter(|line| said.insert((&line.target, line.side))) {
            let mut add = |face| {
                if known.insert(face) {
                    chosen.faces.push((face, word))
                }
            };
            let (mut solids, mut flat) = (Vec::new(), Vec::new());
            for element in self.sets.elements.find(target, word)? {
                match (self.raw.tets_of(element).is_empty(), self.bodies.of_element(element)) {
                    (false, _) => solids.push(element),
                    (true, None) => flat.push(element),
                    (true, Some(body)) => {
                        (chosen.rigid).push(RigidFace::new(self.sets, (body, element), *side, word)?);
                    }
                }
            }
            match side {
                Side::Face(number) => {
                    for element in solids {
                        self.face_of(element, *number, word)?.for_each(&mut add);
                    }
                }
                _ if solids.is_empty() => {}
                Side::Outside => {
                    whole.get_or_insert(word);
                    let tets = solids.into_iter().flat_map(|e| self.raw.tets_of(e));
                    Boundary::of(boundary, self.raw)
                        .of_tets(tets)
                        .into_iter()
                        .for_each(&mut add);
                }
                Side::Facet { .. } | Side::Nodes => return Err(word.expected("faces S1 to S6 of solid elements")),
            }
            for element in flat {
                of_flat(self, Boundary::of(boundary, self.raw), element, (*side, word))?
                    .into_iter()
                    .for_each(&mut add);
            }
            if !chosen.faces.is_empty() && !chosen.rigid.is_empty() {
                return Err(word.cannot("the surface has rigid and elastic faces; make two surfaces of them"));
            }
        }
        match (whole, chosen.faces.is_empty()) {
            (Some(word), true) => Err(word.cannot("none of these elements is at the boundary")),
            _ => Ok(chosen),
        }
    }

    /// The faces of tetrahedra that a face of an elastic element, by its position, is.
    fn face_of(&self, element: u32, number: u8, word: &Word) -> Result<impl Iterator<Item = (u32, u8)>, DeckError> {
        let mut faces = self.raw.faces_of(element, number).peekable();
        match faces.peek() {
            Some(_) => Ok(faces),
            None => Err(word.cannot(self.model.elements[element as usize].no_face(number))),
        }
    }
}

impl Face {
    /// Its corners, on its side of a cut.
    pub(super) fn corners(&self, raw: &Raw) -> [u32; 3] {
        self.nodes.map(|node| raw.own(self.tet, node))
    }

    /// The nodes that carry a constant traction, each with its area.
    pub(super) fn areas(&self, raw: &Raw) -> Vec<(u32, f64)> {
        raw.areas(self.tet, self.nodes)
    }

    /// The nodes that carry a constant pressure, each with its area along the outward normal.
    pub(super) fn area_vectors(&self, raw: &Raw) -> Vec<(u32, Vec3)> {
        raw.area_vectors(self.tet, self.nodes)
    }
}
