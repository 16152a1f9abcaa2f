//! Names of the parts of a scene from those of the groups of its mesh file.

use super::contact::Contact;
use super::load::{Kind, Load};
use super::scene::Scene;
use super::support::{Place, Support};
use crate::part::Part;
use signorini_fem_mesh::{FacetTag, LoadDensity};
use std::collections::HashMap;

/// Names by the numbers of the scene.
struct Groups {
    surfaces: HashMap<FacetTag, String>,
    volumes: HashMap<u32, String>,
    contacts: Vec<Option<String>>,
    supports: Vec<Option<String>>,
    loads: Vec<Option<String>>,
    /// The region around each node, and of each tetrahedron.
    nodes: Vec<Option<u32>>,
    tets: Vec<u32>,
}

impl Scene {
    /// Names from the groups of a mesh file, as `GroupNames` of a Gmsh file lists them: errors and warnings then begin
    /// with those of the contacts, supports, loads, regions and nodes concerned. What is added to the scene later has
    /// none. They take the place of names that were [given before](Self::with_names); of two names of a tag the last
    /// counts.
    ///
    /// ```
    /// use signorini_contact::{Contact, Plan, Scene, Settings};
    /// # use signorini_fem_mesh::{Brick, Hooke, Materials, brick};
    /// # let mesh = Brick::new([1.0; 3], [1; 3]).build()?;
    /// # let steel = Materials::uniform(Hooke::isotropic(2e11, 0.3)?);
    /// let scene = Scene::new(mesh, steel)
    ///     .with_contact(Contact::rigid(brick::Z_MIN).with_normal([0.0; 3]))
    ///     .with_groups([("floor", brick::Z_MIN)], [("pad", 0)]);
    /// let error = Plan::new(&scene, &Settings::default()).unwrap_err();
    /// assert!(error.to_string().starts_with("contact 0 is that of floor: contact 0: the obstacle's normal"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_groups<'a>(
        self,
        surfaces: impl IntoIterator<Item = (&'a str, FacetTag)>,
        volumes: impl IntoIterator<Item = (&'a str, u32)>,
    ) -> Self {
        let surfaces: HashMap<_, _> = surfaces.into_iter().map(|(name, tag)| (tag, name.to_owned())).collect();
        let on = |tags: &[FacetTag]| {
            let names: Vec<&str> = tags.iter().filter_map(|t| surfaces.get(t)).map(|n| &**n).collect();
            (!names.is_empty()).then(|| names.join(", "))
        };
        let contact = |contact: &Contact| {
            let sides = [&contact.tags, &contact.partner]
                .into_iter()
                .filter_map(|tags| on(tags));
            let sides: Vec<String> = sides.collect();
            (!sides.is_empty()).then(|| format!("that of {}", sides.join(" and ")))
        };
        let support = |support: &Support| match &support.place {
            Place::Tag(tag) => on(&[*tag]).map(|name| format!("that of {name}")),
            Place::Nodes(_) => None,
        };
        let load = |load: &Load| match &load.kind {
            Kind::Density(density) => on(&loaded(density)).map(|name| format!("that on {name}")),
            Kind::Eigenstrain(_) | Kind::Coupling(_) => None,
        };
        let mut nodes = vec![None; self.mesh.points().len()];
        let mids = (0..self.mesh.tets().len()).map(|tet| self.mesh.mids().get(tet).into_iter().flatten());
        let corners = self.mesh.tets().iter().zip(mids).zip(self.mesh.regions());
        for ((corners, mids), region) in corners {
            corners
                .iter()
                .chain(mids)
                .for_each(|&n| nodes[n as usize] = Some(*region));
        }
        let groups = Groups {
            contacts: self.contacts.iter().map(contact).collect(),
            supports: self.supports.iter().map(support).collect(),
            loads: self.loads.iter().map(load).collect(),
            nodes,
            tets: self.mesh.regions().to_vec(),
            volumes: volumes
                .into_iter()
                .map(|(name, region)| (region, name.to_owned()))
                .collect(),
            surfaces,
        };
        self.with_names(move |part| groups.name(part))
    }
}

/// The facets that a load acts on.
fn loaded(density: &LoadDensity) -> Vec<FacetTag> {
    match density {
        LoadDensity::Traction(tag, _)
        | LoadDensity::TractionField(tag, _)
        | LoadDensity::Pressure(tag, _)
        | LoadDensity::Force(tag, _)
        | LoadDensity::Moment(tag, _) => vec![*tag],
        _ => Vec::new(),
    }
}

impl Groups {
    fn name(&self, part: Part) -> Option<String> {
        let within = |region: &u32| self.volumes.get(region).map(|name| format!("in {name}"));
        match part {
            Part::Contact(index) => self.contacts.get(index)?.clone(),
            Part::Support(index) => self.supports.get(index)?.clone(),
            Part::Load(index) => self.loads.get(index)?.clone(),
            Part::Node(node) => self.nodes.get(node as usize)?.as_ref().and_then(within),
            Part::Tet(tet) => self.tets.get(tet).and_then(within),
            Part::Region(region) => self.volumes.get(&region).cloned(),
            Part::Tag(tag) => self.surfaces.get(&tag).cloned(),
            Part::Spring(_) | Part::Coupling(_) | Part::Equation(_) | Part::Step(_) => None,
        }
    }
}
