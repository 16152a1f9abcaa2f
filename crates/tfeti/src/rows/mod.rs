//! The rows of `B`: gluing, supports, contact.
//!
//! Uses `linalg` and `subdomain::copy_stiffness`. In go the decomposition, supports and contact constraints, whose
//! sides are lists of nodes with weights (`side`). Out comes a `gluing`: interface blocks and nodal rows by their
//! copies, where each kind stands (`ranges`), and prescribed offsets.
//!
//! `supports` merges what is prescribed at a node, `contact` reduces each constraint to the directions that are left,
//! `build` spreads all over the copies, `dependencies` finds rows whose forces may replace one another,
//! `rigid` holds motions of rigid subdomains, `equations` judges linear equations, `part` takes some of the rows.

pub(crate) mod build;
pub(crate) mod contact;
pub(crate) mod dependencies;
pub(crate) mod equations;
pub(crate) mod gluing;
pub(crate) mod part;
pub(crate) mod ranges;
pub(crate) mod rigid;
pub(crate) mod side;
pub(crate) mod supports;
