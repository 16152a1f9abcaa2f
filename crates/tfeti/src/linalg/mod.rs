pub(crate) mod block_rows;
pub(crate) mod dense;
pub(crate) mod sparse;
pub(crate) mod supernodes;
pub(crate) mod tiles;
