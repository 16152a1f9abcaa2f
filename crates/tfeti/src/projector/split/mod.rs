pub(crate) mod factor;
pub(crate) mod fronts;
pub(crate) mod order;
pub(crate) mod solve;
pub(crate) mod tiles;
pub(crate) mod tree;
