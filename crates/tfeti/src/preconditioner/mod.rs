pub(crate) mod operator;
pub(crate) mod scaling;
