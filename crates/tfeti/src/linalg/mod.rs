//! Linear algebra of single matrices, independent of subdomains and `B`.
//!
//! Uses no other folder. `dense` and `sparse` are the only files that name the library behind them (faer). In go
//! matrices by columns, out come factors, inverses and products with work memory of the caller. Large factors are made by
//! several threads, with the bits of one.
//!
//! `elimination` finds the pattern of a factor, `supernodes` and `tiles` store one for solves with one right-hand side
//! (see `projector/split` for what they are worth) or, in `lanes`, with several, `block_rows` multiplies one matrix
//! with many vectors.

pub(crate) mod block_rows;
pub(crate) mod dense;
pub(crate) mod elimination;
mod gram;
pub(crate) mod lanes;
pub(crate) mod roots;
pub(crate) mod sparse;
pub(crate) mod supernodes;
pub(crate) mod tiles;

/// Both, at the same time if that is `worth` it.
pub(crate) fn both<A: Send, B: Send>(
    worth: bool,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if worth { rayon::join(a, b) } else { (a(), b()) }
}

/// Zeros, in old memory if there is enough: pages that are new cost more than all else that is done with them.
pub fn zeros(mut old: Vec<f64>, length: usize) -> Vec<f64> {
    if old.capacity() < length {
        // of which only those that are written become real
        return vec![0.0; length];
    }
    old.clear();
    old.resize(length, 0.0);
    old
}

/// An old vector as it is, to be overwritten, if it has this length, else a new one.
pub fn of_length(old: Vec<f64>, length: usize) -> Vec<f64> {
    if old.len() == length { old } else { vec![0.0; length] }
}

/// The value of a key in a short list; `new` if it is not there yet.
pub(crate) fn entry<K: PartialEq, V>(list: &mut Vec<(K, V)>, key: K, new: V) -> &mut V {
    let at = list.iter().position(|v| v.0 == key).unwrap_or(list.len());
    if at == list.len() {
        list.push((key, new));
    }
    &mut list[at].1
}
