pub(crate) mod builder;
pub(crate) mod recovery;
pub(crate) mod report;
pub(crate) mod row_stiffness;
pub(crate) mod tfeti;
pub(crate) mod torn;
