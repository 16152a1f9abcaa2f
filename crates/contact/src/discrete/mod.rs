//! The scene at the nodes of its mesh, made and checked once: contact points with their sides, supports node by node.
//!
//! A node of a contact surface becomes a contact point for each direction in which it meets an obstacle (`points`,
//! `creases`, `normals`; the scene says the gap) or a node of another body (`partners`, with the gap, together for
//! contacts that go on in one another: `united`); in a mesh of order 2 it is a mean around the node (`means`); bodies
//! that overlap only because their facets are straight touch (`faceted`), and where contacts cross one of them may hand
//! its conditions on (`crossing`). Scenes that make no sense are refused here, before any stiffness is assembled
//! (`scene`, `overflow`, `penetration`, `parted`, `turn`). `side` has the nodes and weights of a contact point; what is
//! tied does not touch as well (`bonded`).
//!
//! Rigid couplings are subdomains of their own (`couplings`); `equations` may have some that are points.
//!
//! Uses: `scene`, `mortar`. In: a scene. Out: a [`DiscreteScene`], borrowed by plan, model and reactions.

mod bonded;
mod chords;
mod couplings;
mod creases;
mod crossing;
mod equations;
mod extents;
mod faceted;
mod free_points;
mod means;
mod normals;
mod overflow;
mod parted;
mod partners;
mod penetration;
mod points;
mod scene;
mod side;
mod springs;
mod supports;
mod turn;
mod united;

pub(crate) use couplings::Couplings;
pub(crate) use creases::{SurfaceSide, area_vector, creases};
pub(crate) use extents::Extents;
pub(crate) use faceted::FacetedOverlaps;
pub(crate) use free_points::power_of_two;
pub(crate) use points::{ContactPoint, of_contact};
pub(crate) use scene::DiscreteScene;
pub(crate) use side::{mean_place, rounded};
pub(crate) use supports::Supports;
pub(crate) use turn::{beside, turned, turned_to};
