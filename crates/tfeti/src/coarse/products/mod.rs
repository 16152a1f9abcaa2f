mod globs;
mod points;
mod rigid;

pub(crate) use globs::Wrench;
pub(crate) use rigid::RigidTables;
