pub(crate) mod boundary;
pub(crate) mod build;
pub(crate) mod inverses;
pub(crate) mod operator;
