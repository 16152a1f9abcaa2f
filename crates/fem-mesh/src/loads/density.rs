//! Where a load acts, and how much.

use std::sync::Arc;

use crate::errors::place as told;
use crate::material::MaterialError;
use crate::mesh::{FacetTag, tag_list};

use super::function::Function;

/// A vector that depends on the point.
type PointField = Function<dyn Fn([f64; 3]) -> [f64; 3] + Send + Sync>;

/// A vector that depends on the point and the outward unit normal there.
type SurfaceField = Function<dyn Fn([f64; 3], [f64; 3]) -> [f64; 3] + Send + Sync>;

/// A load in space; a [`History`](crate::History) says how it changes in time.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum LoadDensity {
    /// The same force per volume, N/m³, everywhere (F of the paper).
    Body([f64; 3]),
    /// Force per volume, N/m³, that depends on the point, m.
    BodyField(PointField),
    /// The same force per volume, N/m³, in a region.
    BodyIn(u32, [f64; 3]),
    /// Force per volume, N/m³, that depends on the point, m, in a region.
    BodyFieldIn(u32, PointField),
    /// The same force per area, Pa, on all facets of a tag (P of the paper).
    Traction(FacetTag, [f64; 3]),
    /// Force per area, Pa, at a point, m, with its outward unit normal, on all facets of a tag.
    TractionField(FacetTag, SurfaceField),
    /// Pressure, Pa, on all facets of a tag: the force per area is -value times the outward normal, so
    /// a positive pressure pushes into the body.
    Pressure(FacetTag, f64),
    /// A force, N, spread evenly over all facets of a tag: a uniform traction whose resultant on the discrete facets is
    /// this force. Facets inscribed in a curved surface have less area than it, so a given traction would lose a part.
    Force(FacetTag, [f64; 3]),
    /// A moment, N m, without a force: the traction on all facets of a tag grows linearly from their centroid, as the
    /// displacement of a rigid rotation does, and its resultant on the discrete facets is this moment.
    Moment(FacetTag, [f64; 3]),
    /// Forces, N, at single nodes (global numbers); forces at the same node add up.
    NodalForces(Vec<(u32, [f64; 3])>),
}

impl LoadDensity {
    /// Force per volume that depends on the point.
    pub fn body_field(value: impl Fn([f64; 3]) -> [f64; 3] + Send + Sync + 'static) -> Self {
        Self::BodyField(Function(Arc::new(value)))
    }

    /// Force per volume that depends on the point, in a region.
    pub fn body_field_in(region: u32, value: impl Fn([f64; 3]) -> [f64; 3] + Send + Sync + 'static) -> Self {
        Self::BodyFieldIn(region, Function(Arc::new(value)))
    }

    /// Force per area that depends on the point and the outward unit normal.
    pub fn traction_field(
        tag: FacetTag,
        value: impl Fn([f64; 3], [f64; 3]) -> [f64; 3] + Send + Sync + 'static,
    ) -> Self {
        Self::TractionField(tag, Function(Arc::new(value)))
    }

    /// The facets that it acts on; `None` for volumes and nodes.
    pub fn tag(&self) -> Option<FacetTag> {
        match self {
            Self::Traction(tag, _)
            | Self::TractionField(tag, _)
            | Self::Pressure(tag, _)
            | Self::Force(tag, _)
            | Self::Moment(tag, _) => Some(*tag),
            Self::Body(_) | Self::BodyField(_) | Self::BodyIn(..) | Self::BodyFieldIn(..) | Self::NodalForces(_) => {
                None
            }
        }
    }
}

errors! {
    /// A load that cannot be applied.
    #[derive(Clone, PartialEq)]
    LoadError from { Material(MaterialError) } {
        ForeignDecomposition { decomposed: usize, meshed: usize } =
            "the decomposition has {decomposed} tetrahedra and the mesh {meshed}; decompose the mesh that is loaded";
        UnknownTag { tag: FacetTag, known: Vec<FacetTag> } =
            "a load is given on {tag}, but no facet has it; the mesh has {}", tag_list(known);
        UnknownRegion { region: u32, known: Vec<u32> } =
            "a load is given in region {region}, but no tetrahedron is in it; the mesh has the regions {known:?}";
        UnknownNode { node: u32, nodes: usize } =
            "a force is given at node {node}, but there are only {nodes} nodes, numbered from 0";
        NotFinite { place: [f64; 3], value: [f64; 3] } =
            "the load at {} is {value:?}; it must be finite", told(place);
        Eigenstrain { strain: [f64; 6] } = "an eigenstrain is {strain:?}; it must be finite";
        StrainRegion { region: u32, known: Vec<u32> } =
            "an eigenstrain is given in region {region}, but no tetrahedron is in it; the mesh has the regions {known:?}";
        StrainFactors { given: usize, nodes: usize } =
            "an eigenstrain has {given} factors for {nodes} nodes; give one for each node";
        StrainFactor { node: usize, value: f64 } =
            "the factor of an eigenstrain at node {node} is {value}; it must be finite";
    }
}
