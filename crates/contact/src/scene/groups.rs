//! Names of the parts of a scene from those of the groups of its mesh file.

use super::contact::Contact;
use super::coupling::{Coupled, Coupling};
use super::load::{Kind, Load};
use super::scene::Scene;
use super::support::Place;
use crate::part::Part;
use signorini_fem_mesh::FacetTag;
use std::collections::HashMap;

/// Names by the numbers of the scene.
struct Groups {
    surfaces: HashMap<FacetTag, String>,
    volumes: HashMap<u32, String>,
    /// Of what acts on surfaces, their names.
    own: HashMap<Part, String>,
    /// The region around each node, and of each tetrahedron.
    nodes: Vec<Option<u32>>,
    tets: Vec<u32>,
}

impl Scene {
    /// Names from the groups of a mesh file, as `GroupNames` of a Gmsh file lists them: errors and warnings then begin
    /// with those of the contacts, supports, springs, couplings, loads, regions and nodes concerned. What is added to
    /// the scene later has none. They take the place of names that were [given before](Self::with_names); of two names
    /// of a tag the last counts.
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
        let in_place = |place: &Place| match place {
            Place::Tag(tag) => on(&[*tag]),
            Place::Nodes(_) => None,
        };
        let contact = |contact: &Contact| {
            let sides = [&contact.tags, &contact.partner].map(|tags| on(tags));
            let sides: Vec<String> = sides.into_iter().flatten().collect();
            (!sides.is_empty()).then(|| sides.join(" and "))
        };
        let coupling = |coupling: &Coupling| match &coupling.coupled {
            Coupled::Nodes(place) => in_place(place),
            Coupled::Tied(index) => contact(self.contacts.get(*index)?),
            Coupled::Point => None,
        };
        let load = |load: &Load| match &load.kind {
            Kind::Density(density) => on(&[density.tag()?]),
            Kind::Coupling(load) => coupling(self.couplings.get(load.coupling)?),
            Kind::Eigenstrain(_) => None,
        };
        let mut own = HashMap::new();
        let mut note = |part, on: Option<String>| on.and_then(|on| own.insert(part, on));
        for (k, c) in self.contacts.iter().enumerate() {
            note(Part::Contact(k), contact(c));
        }
        for (k, s) in self.supports.iter().enumerate() {
            note(Part::Support(k), in_place(&s.place));
        }
        for (k, s) in self.springs.iter().enumerate() {
            note(Part::Spring(k), in_place(&s.place));
        }
        for (k, c) in self.couplings.iter().enumerate() {
            note(Part::Coupling(k), coupling(c));
        }
        for (k, l) in self.loads.iter().enumerate() {
            note(Part::Load(k), load(l));
        }
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
            own,
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

impl Groups {
    fn name(&self, part: Part) -> Option<String> {
        let within = |region: &u32| self.volumes.get(region).map(|name| format!("in {name}"));
        match part {
            Part::Load(_) => self.own.get(&part).map(|on| format!("that on {on}")),
            Part::Contact(_) | Part::Support(_) | Part::Spring(_) | Part::Coupling(_) => {
                self.own.get(&part).map(|of| format!("that of {of}"))
            }
            Part::Node(node) => self.nodes.get(node as usize)?.as_ref().and_then(within),
            Part::Tet(tet) => self.tets.get(tet).and_then(within),
            Part::Region(region) => self.volumes.get(&region).cloned(),
            Part::Tag(tag) => self.surfaces.get(&tag).cloned(),
            Part::Equation(_) | Part::Step(_) => None,
        }
    }
}
