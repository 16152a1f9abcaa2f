pub(crate) mod joints;
pub(crate) mod matrix;
pub(crate) mod mobility;
pub(crate) mod products;
pub(crate) mod space;
pub(crate) mod weights;
