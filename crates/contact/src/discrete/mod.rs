//! The scene at the nodes of its mesh: contact points with normals and partners, supports node by node, and all checks.
//!
//! A node of a contact surface becomes a contact point for each direction in which it meets an obstacle (`points`,
//! `creases`) or a node of another body (`partners`). Supports become lists of nodes (`supports`). What cannot be meant is
//! refused here, before any stiffness is made (`check`, `overflow`, `penetration`).
//!
//! Uses: `scene`.
//! In: a scene and its decomposition. Out: what plan and model are made of.

mod check;
mod creases;
mod overflow;
mod partners;
mod penetration;
mod points;
mod rounding;
mod supports;

pub(crate) use check::{check_scene, largest_force};
pub(crate) use overflow::{check_gaps, check_load, check_materials, check_motions};
pub(crate) use penetration::check_penetration;
pub(crate) use points::{ContactPoint, Found};
pub(crate) use supports::{contact_constraints, lower_supports};
