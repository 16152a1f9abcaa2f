pub(crate) mod active_set;
pub(crate) mod factor;
pub(crate) mod orthonormal;
pub(crate) mod split;
