//! Names of physical groups.

use super::GmshError;
use super::reader::Name;
use crate::mesh::FacetTag;
use crate::tables::distinct;

/// Names of the physical groups of surfaces and volumes of a file: what to look tags and regions up by.
///
/// A group that the file names need not have elements.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct GroupNames {
    surfaces: Vec<(String, u32)>,
    volumes: Vec<(String, u32)>,
}

impl GroupNames {
    /// Tag of the facets in the surface group of this name.
    ///
    /// # Errors
    /// [`GmshError::UnknownName`] with the names that there are, [`GmshError::RepeatedName`] if two groups have this
    /// one.
    pub fn surface(&self, name: &str) -> Result<FacetTag, GmshError> {
        look_up("surface", &self.surfaces, name).map(FacetTag)
    }

    /// Region of the tetrahedra in the volume group of this name.
    ///
    /// # Errors
    /// [`GmshError::UnknownName`] with the names that there are, [`GmshError::RepeatedName`] if two groups have this
    /// one.
    pub fn volume(&self, name: &str) -> Result<u32, GmshError> {
        look_up("volume", &self.volumes, name)
    }

    /// All named surface groups, by name.
    pub fn surfaces(&self) -> impl Iterator<Item = (&str, FacetTag)> {
        self.surfaces.iter().map(|(n, tag)| (&n[..], FacetTag(*tag)))
    }

    /// All named volume groups, by name.
    pub fn volumes(&self) -> impl Iterator<Item = (&str, u32)> {
        self.volumes.iter().map(|(n, region)| (&n[..], *region))
    }

    /// From names as the file lists them; those of points and curves are of no use here, nor those of surfaces or
    /// volumes that are in no groups, since tags and regions are the numbers of these then.
    pub(super) fn new(list: &[Name], are_groups: [bool; 2]) -> Self {
        let of = |wanted: i32| {
            let own = list.iter().filter(|(dimension, ..)| *dimension == wanted);
            let own = own.filter(|_| are_groups[(wanted - 2) as usize]);
            distinct(own.map(|(_, group, name)| (name.clone(), group.unsigned_abs())))
        };
        Self {
            surfaces: of(2),
            volumes: of(3),
        }
    }
}

fn look_up(what: &'static str, groups: &[(String, u32)], name: &str) -> Result<u32, GmshError> {
    let found: Vec<u32> = groups.iter().filter(|g| g.0 == name).map(|g| g.1).collect();
    match found[..] {
        [] => Err(GmshError::UnknownName {
            what,
            name: name.into(),
            known: groups.iter().map(|g| g.0.clone()).collect(),
        }),
        [group] => Ok(group),
        [first, second, ..] => Err(GmshError::RepeatedName {
            name: name.into(),
            groups: [first, second],
        }),
    }
}
