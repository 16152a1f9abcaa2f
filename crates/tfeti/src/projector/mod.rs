pub(crate) mod active_set;
pub(crate) mod factor;
pub(crate) mod split;
