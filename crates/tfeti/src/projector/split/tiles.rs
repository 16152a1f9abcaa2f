//! The tiles of a factor, in double and in single precision.

use crate::linalg::tiles::{ShortTile, Stored, Tile};

/// The tiles of a region, exact and rounded.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tiles {
    pub(crate) exact: Vec<Tile>,
    short: Vec<ShortTile>,
}

impl Tiles {
    pub(crate) fn clear(&mut self) {
        self.exact.clear();
        self.short.clear();
    }

    /// Numbers stored; a rounded tile is half a tile.
    pub(crate) fn numbers(&self) -> usize {
        Tile::NUMBERS * (2 * self.exact.len() + self.short.len()) / 2
    }

    /// Rounds what has been packed.
    pub(crate) fn round(&mut self) {
        self.short.clear();
        self.short.extend(self.exact.iter().map(ShortTile::from));
    }
}

/// Which tiles of a region a solve reads.
pub(super) trait Reads: Stored {
    fn of(tiles: &Tiles) -> &[Self];
}

impl Reads for Tile {
    fn of(tiles: &Tiles) -> &[Self] {
        &tiles.exact
    }
}

impl Reads for ShortTile {
    fn of(tiles: &Tiles) -> &[Self] {
        &tiles.short
    }
}
