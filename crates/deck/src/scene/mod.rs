//! The deck as a mesh and a scene of the library.
//!
//! In goes a [`Model`], out comes a [`Translated`]: names are looked up, numbers of the deck become numbers of
//! the mesh, faces get tags, the conditions of all steps become one history each. What cannot be said to the
//! solver is refused here, with its place. May use `model`, `lexer`, `error`.

mod between;
mod boundary;
mod changes;
mod contacts;
mod couplings;
mod equations;
mod faces;
mod flats;
mod held;
mod history;
mod known;
mod loads;
mod materials;
mod mesh;
mod numbers;
mod parts;
mod points;
mod pretension;
mod rigid;
mod rigid_face;
mod spread;
mod supports;
mod temperatures;
mod ties;
mod timeline;
mod transforms;
mod volume;

use std::path::Path;

use signorini_contact::Scene;
use signorini_fem_mesh::{FacetTag, TetMesh};

use crate::error::{DeckError, Word};
use crate::model::{Ignored, Model, Names};

pub(crate) use numbers::Numbers;

/// A deck as the library sees it.
#[derive(Debug)]
pub(crate) struct Translated {
    pub(crate) mesh: TetMesh,
    /// None where the elements have no material.
    pub(crate) scene: Option<Scene>,
    /// Nodes and tetrahedra of the mesh by their numbers in the deck, and back.
    pub(crate) nodes: Numbers,
    pub(crate) node_labels: Vec<u32>,
    pub(crate) element_labels: Vec<u32>,
    pub(crate) surfaces: Names<Vec<FacetTag>>,
    pub(crate) node_sets: Names<Vec<u32>>,
    pub(crate) element_sets: Names<Vec<u32>>,
    /// The set that each support of the scene is given on.
    pub(crate) support_names: Vec<String>,
    /// What each coupling of the scene is in the deck.
    pub(crate) coupling_names: Vec<String>,
    pub(crate) halvings: u32,
    pub(crate) ignored: Vec<Ignored>,
}

/// The mesh and the scene of a model.
pub(crate) fn translate(path: &Path, model: &Model) -> Result<Translated, DeckError> {
    let sets = numbers::Sets::new(model)?;
    let bodies = rigid::RigidBodies::new(&sets)?;
    let mut notes = Vec::new();
    let mut raw = mesh::Raw::new(path, &sets, &bodies, &mut notes)?;
    let timeline = timeline::Timeline::new(model)?;
    let couplings = couplings::Couplings::new(&sets, &bodies, &raw)?;
    let sections = pretension::Sections::new(&couplings.0, &sets, &raw)?;
    if !sections.0.is_empty() {
        let regions = vec![0; raw.tets.len()];
        let whole = raw.mesh(path, model, Vec::new(), regions, |_| None)?;
        let (cut, copied) = sections.cut(whole, 0, &raw)?;
        raw.copy(&copied, &cut);
    }
    let points = points::Points::new(&sets, &bodies, &couplings, &raw)?;
    let transforms = transforms::Transforms::new(&sets, &bodies, (&couplings, &points), &raw)?;
    let known = known::Known {
        model,
        sets: &sets,
        bodies: &bodies,
        raw: &raw,
        timeline: &timeline,
        couplings: &couplings,
        points: &points,
        transforms: &transforms,
        sections: &sections,
    };
    let mut faces = faces::FaceTable::default();
    let surfaces = faces.surfaces(known, &mut notes)?;
    let loads = loads::Loads::new(known, &surfaces, &mut faces)?;
    faces.check_outside(&raw)?;
    let tags = faces.tags();
    let (regions, materials) = materials::materials(&raw, &sets)?;
    let mut parts = parts::Parts::new(&raw, &sets, &regions);
    let mesh = raw.mesh(path, model, faces.facets(&tags), regions, |part| parts.name(part))?;
    let next = tags.iter().max().map_or(1, |last| last.0 + 1);
    let (mesh, _) = sections.cut(mesh, next, &raw)?;
    let surfaces = faces.tags_of(&tags, model);

    let mut supports = supports::supports(known, &faces, &loads.on_rigid(), model.pairs.len())?;
    supports.ignored.append(&mut notes);
    let contacts::Contacts {
        first: mut contacts,
        later,
    } = contacts::contacts(known, &faces, &surfaces, &supports.leads, &mut supports.ignored)?;
    contacts.extend((next..).step_by(2).take(sections.0.len()).map(pretension::tie));
    parts.come_back(contacts.len(), later.iter().map(|own| own.0));
    contacts.extend(later.into_iter().map(|own| own.1));
    let warm = temperatures::temperatures(known, &mut supports.ignored)?;
    let (equations, words): (Vec<_>, Vec<_>) = equations::equations(known, &supports)?.into_iter().unzip();
    parts.equations = words.iter().map(Word::told).collect();
    let loads = loads
        .lower(&faces, &tags, (&supports.rigid, &sections))
        .into_iter()
        .chain(warm);
    let (loads, words): (Vec<_>, Vec<_>) = loads.unzip();
    let (support_names, held): (Vec<_>, Vec<_>) = supports.names.into_iter().unzip();
    parts.steps = timeline.steps();
    parts.tagged(&surfaces);
    parts.loads = words.iter().map(Word::told).collect();
    parts.supports = held.iter().map(Word::told).collect();
    let coupling_names = supports.rigid.iter().map(|r| r.word.text.clone()).collect();
    parts.couplings = supports.rigid.iter().map(|r| r.word.told()).collect();
    let scene = materials.map(|materials| {
        let scene = Scene::new(mesh.clone(), materials).with_analysis(timeline.analysis());
        let scene = supports.list.into_iter().fold(scene, Scene::with_support);
        let couplings = supports.rigid.into_iter().map(|r| r.coupling);
        let scene = couplings.fold(scene, Scene::with_coupling);
        let scene = equations.into_iter().fold(scene, Scene::with_equation);
        let scene = loads.into_iter().fold(scene, Scene::with_load);
        let scene = contacts.into_iter().fold(scene, Scene::with_contact);
        scene.with_names(move |part| parts.name(part))
    });
    Ok(Translated {
        mesh,
        scene,
        nodes: raw.mesh_numbers(),
        node_sets: sets.nodes.named(|set| raw.all_in_mesh(&set)),
        element_sets: sets.elements.named(|set| {
            let mut tets: Vec<u32> = set.into_iter().flat_map(|e| raw.tets_of(e)).collect();
            tets.shrink_to_fit();
            tets
        }),
        node_labels: raw.node_labels,
        element_labels: raw.element_labels,
        surfaces,
        support_names,
        coupling_names,
        halvings: timeline.halvings(),
        ignored: supports.ignored,
    })
}
