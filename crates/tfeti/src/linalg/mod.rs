pub(crate) mod block_rows;
pub(crate) mod dense;
pub(crate) mod elimination;
pub(crate) mod sparse;
pub(crate) mod supernodes;
pub(crate) mod tiles;
pub(crate) mod vec3;

/// Both, at the same time if that is `worth` it.
pub(crate) fn both<A: Send, B: Send>(
    worth: bool,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if worth { rayon::join(a, b) } else { (a(), b()) }
}
