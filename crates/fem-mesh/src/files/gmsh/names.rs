//! Names of physical groups.

use std::collections::BTreeMap;

use super::GmshError;
use crate::mesh::FacetTag;

/// Names of the physical groups of surfaces and volumes of a file: what to look tags and regions up by.
///
/// A group that the file names need not have elements.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct GroupNames {
    surfaces: BTreeMap<String, u32>,
    volumes: BTreeMap<String, u32>,
}

impl GroupNames {
    /// Tag of the facets in the surface group of this name.
    ///
    /// # Errors
    /// [`GmshError::UnknownName`] with the names that there are.
    pub fn surface(&self, name: &str) -> Result<FacetTag, GmshError> {
        look_up("surface", &self.surfaces, name).map(FacetTag)
    }

    /// Region of the tetrahedra in the volume group of this name.
    ///
    /// # Errors
    /// [`GmshError::UnknownName`] with the names that there are.
    pub fn volume(&self, name: &str) -> Result<u32, GmshError> {
        look_up("volume", &self.volumes, name)
    }

    /// All named surface groups, by name.
    pub fn surfaces(&self) -> impl Iterator<Item = (&str, FacetTag)> {
        self.surfaces.iter().map(|(n, &tag)| (&n[..], FacetTag(tag)))
    }

    /// All named volume groups, by name.
    pub fn volumes(&self) -> impl Iterator<Item = (&str, u32)> {
        self.volumes.iter().map(|(n, &region)| (&n[..], region))
    }

    /// Takes names as the file lists them; those of points and curves are of no use here.
    pub(super) fn insert(&mut self, dimension: i32, group: i32, name: String) -> Result<(), GmshError> {
        let groups = match dimension {
            2 => &mut self.surfaces,
            3 => &mut self.volumes,
            _ => return Ok(()),
        };
        let group = group.unsigned_abs();
        match groups.insert(name.clone(), group) {
            Some(other) if other != group => Err(GmshError::RepeatedName {
                name,
                groups: [other, group],
            }),
            _ => Ok(()),
        }
    }
}

fn look_up(what: &'static str, groups: &BTreeMap<String, u32>, name: &str) -> Result<u32, GmshError> {
    let unknown = || GmshError::UnknownName {
        what,
        name: name.into(),
        known: groups.keys().cloned().collect(),
    };
    groups.get(name).copied().ok_or_else(unknown)
}
