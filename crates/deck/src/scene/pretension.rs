//! Sections across which bolts are tightened: the mesh is cut there, and its sides are tied but for a motion along the
//! normal.

use std::collections::BTreeMap;

use signorini_contact::{Contact, Coupling};
use signorini_fem_mesh::internal::{TET_FACES, ascending};
use signorini_fem_mesh::vec3::{Vec3, add, centroid, dot, norm, scale};
use signorini_fem_mesh::{FacetTag, MeshError, SurfaceFrame, TetMesh};

use super::couplings::Coupling as Node;
use super::mesh::Raw;
use super::numbers::Sets;
use crate::error::{DeckError, Word};
use crate::model::{CouplingLaw, Side};
use crate::tolerances::ALONG_SECTION;

/// Why other components are refused.
pub(super) const ONE: &str = "the node of a *PRE-TENSION SECTION has component 1 only, along the normal; give that";

/// Where the mesh is cut.
#[derive(Debug)]
pub(super) struct Section {
    /// Its node and its surface, by position in the deck.
    pub(super) node: u32,
    pub(super) surface: usize,
    word: Word,
    /// Whether a tetrahedron at the cut is one of the surface, or on the other side.
    sides: BTreeMap<u32, bool>,
    /// Along which it is tightened: the normal that is given, or the mean one out of the elements of the surface.
    axis: Vec3,
    centre: Vec3,
}

/// The faces of a section.
struct Faces {
    /// The tetrahedron of the surface at each.
    own: BTreeMap<[u32; 3], u32>,
    /// Out of these tetrahedra.
    area_vector: Vec3,
    area: f64,
    centre: Vec3,
}

impl Faces {
    fn new(surface: usize, sets: &Sets, raw: &Raw) -> Result<Self, DeckError> {
        let (mut own, mut area_vector, mut area, mut centre) = (BTreeMap::new(), [0.0; 3], 0.0, [0.0; 3]);
        for faces in sets.model.surfaces.at(surface) {
            let Side::Face(number) = faces.side else {
                let what = "faces S1 to S6 of solid elements, all on one side of the section";
                return Err(faces.word.expected(what));
            };
            for element in sets.elements.find(&faces.target, &faces.word)? {
                let mut faces_there = raw.faces_of(element, number).peekable();
                if faces_there.peek().is_none() {
                    return Err(faces
                        .word
                        .cannot("a section is across elastic elements, and on faces that they have"));
                }
                for (tet, number) in faces_there {
                    let nodes = raw.face(tet, number);
                    let out = raw.area_vector(tet, nodes);
                    area_vector = add(area_vector, out);
                    area += norm(out);
                    let middle = centroid(&nodes.map(|n| raw.points[n as usize]));
                    centre = add(centre, scale(norm(out), middle));
                    own.insert(ascending(nodes), tet);
                }
            }
        }
        Ok(Self {
            own,
            area_vector,
            area,
            centre: scale(1.0 / area, centre),
        })
    }

    /// Whether a tetrahedron at a face is one of the surface, or on the other side.
    fn sides(&self, word: &Word, raw: &Raw) -> Result<BTreeMap<u32, bool>, DeckError> {
        let mut sides: BTreeMap<u32, bool> = self.own.values().map(|tet| (*tet, true)).collect();
        let mut found = 0;
        for (tet, corners) in (0..).zip(&raw.tets) {
            let keys = TET_FACES.map(|face| ascending(face.map(|i| corners[i])));
            let own = keys.iter().filter_map(|face| self.own.get(face));
            for _ in own.filter(|own| **own != tet) {
                found += 1;
                if sides.insert(tet, false) == Some(true) {
                    let label = raw.element_labels[tet as usize];
                    let why = format!(
                        "element {label} of the section lies behind another face of it, too; give faces of elements on \
                        one side"
                    );
                    return Err(word.cannot(why));
                }
            }
        }
        if found < self.own.len() {
            Err(word.cannot("a face of the section is on the boundary; give faces between elements, across the bolt"))
        } else {
            Ok(sides)
        }
    }

    /// Along which the section is tightened: a given normal, or the mean one.
    fn axis(&self, normal: Option<Vec3>, word: &Word) -> Result<Vec3, DeckError> {
        let frame = SurfaceFrame::from_normal(normal.unwrap_or(self.area_vector));
        let why = "the section has no normal; give one below *PRE-TENSION SECTION";
        let axis = frame.ok_or_else(|| word.cannot(why))?.normal;
        if dot(axis, self.area_vector).abs() < ALONG_SECTION * self.area {
            Err(word.cannot(
                "the normal lies in the section, or its faces look to both sides, so that it would not be tightened; \
                give one across it, and faces of one side",
            ))
        } else {
            Ok(axis)
        }
    }
}

impl Section {
    fn new(node: &Node, normal: Option<Vec3>, sets: &Sets, raw: &Raw) -> Result<Self, DeckError> {
        let word = &node.word;
        let faces = Faces::new(node.surface, sets, raw)?;
        Ok(Self {
            node: node.node,
            surface: node.surface,
            word: word.clone(),
            sides: faces.sides(word, raw)?,
            axis: faces.axis(normal, word)?,
            centre: faces.centre,
        })
    }

    /// Cuts a mesh here, whose copies of nodes so far are those of these.
    fn cut(
        &self,
        (mesh, copied): (&TetMesh, &[u32]),
        tags: [FacetTag; 2],
        raw: &Raw,
    ) -> Result<(TetMesh, Vec<u32>), DeckError> {
        let cut = mesh.cut(|tet| self.sides.get(&(tet as u32)).copied(), tags);
        cut.map_err(|error| match error {
            MeshError::CutEnds { mut node } => {
                let uncut = mesh.points().len() - copied.len();
                while let Some(of) = (node as usize).checked_sub(uncut) {
                    node = copied[of];
                }
                let label = raw.node_labels[node as usize];
                let why = format!("the section ends inside the body, at node {label}; give all faces across the bolt");
                self.word.cannot(why)
            }
            MeshError::NoCut => (self.word).cannot("another section has these faces; give each bolt its own"),
            other => self.word.cannot(other.to_string()),
        })
    }

    /// The motion of one side of a contact relative to the other.
    pub(super) fn coupling(&self, contact: usize) -> Coupling {
        Coupling::relative(contact, self.centre).with_axis(self.axis)
    }

    /// A force that tightens it.
    pub(super) fn force(&self, value: f64) -> Vec3 {
        scale(value, self.axis)
    }
}

/// All sections.
#[derive(Debug, Default)]
pub(super) struct Sections(pub(super) Vec<Section>);

impl Sections {
    pub(super) fn new(nodes: &[Node], sets: &Sets, raw: &Raw) -> Result<Self, DeckError> {
        let mut list: Vec<Section> = Vec::new();
        for node in nodes {
            let CouplingLaw::Pretension { normal } = node.law else {
                continue;
            };
            if list.iter().any(|section| section.surface == node.surface) {
                return Err(node
                    .word
                    .cannot("another section is at this surface; give it a surface of its own"));
            }
            list.push(Section::new(node, normal, sets, raw)?);
        }
        Ok(Self(list))
    }

    /// Whether a surface is one of them.
    pub(super) fn is_across(&self, surface: usize) -> bool {
        self.0.iter().any(|section| section.surface == surface)
    }

    /// Refuses one where a surface at the boundary is meant.
    pub(super) fn check_outside(&self, surface: usize, word: &Word) -> Result<(), DeckError> {
        if self.is_across(surface) {
            Err(word.cannot("this is a *PRE-TENSION SECTION, inside the body; name a surface at the boundary"))
        } else {
            Ok(())
        }
    }

    /// That of a node.
    pub(super) fn of(&self, node: u32) -> Option<&Section> {
        self.0.iter().find(|section| section.node == node)
    }

    /// The mesh cut at each, with two tags for each from `next` on; the nodes that were copied.
    pub(super) fn cut(&self, mut mesh: TetMesh, next: u32, raw: &Raw) -> Result<(TetMesh, Vec<u32>), DeckError> {
        let mut copied = Vec::new();
        for (section, tag) in self.0.iter().zip((next..).step_by(2)) {
            let (cut, own) = section.cut((&mesh, &copied), [FacetTag(tag), FacetTag(tag + 1)], raw)?;
            mesh = cut;
            copied.extend(own);
        }
        Ok((mesh, copied))
    }
}

/// The tie of the sides of a cut, of which the first one has this tag.
pub(super) fn tie(tag: u32) -> Contact {
    Contact::tied(FacetTag(tag), FacetTag(tag + 1))
}
