pub(crate) mod build;
pub(crate) mod contact;
pub(crate) mod dependencies;
pub(crate) mod gluing;
pub(crate) mod kinds;
pub(crate) mod side;
pub(crate) mod supports;
