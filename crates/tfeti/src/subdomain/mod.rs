pub(crate) mod class;
pub(crate) mod copy_stiffness;
pub(crate) mod cost;
pub(crate) mod forecast;
pub(crate) mod inverse;
pub(crate) mod kernel;
pub(crate) mod matrices;
pub(crate) mod packed;
