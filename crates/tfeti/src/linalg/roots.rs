//! Halves of a factor `L D L^T`: what makes solves in one direction those with the Cholesky factor `L D^1/2`.
//!
//! Tiles hold the blocks `D^-1 = W W^T`, of which `W` is computed anew each time: a panel is small beside its rows.

use super::supernodes::Supernodes;
use super::tiles::{LANES, PANEL, Tile};

type Root = [[f64; PANEL]; PANEL];

/// `W`, lower triangular, from the first rows of a panel of so many columns.
fn root(tiles: &[Tile], count: usize) -> Root {
    let mut w = [[0.0; PANEL]; PANEL];
    for j in 0..count {
        for i in j..count {
            let known: f64 = (0..j).map(|k| w[i][k] * w[j][k]).sum();
            let left = tiles[(i / LANES) * count + j].0[i % LANES] - known;
            w[i][j] = if i == j { left.max(0.0).sqrt() } else { left / w[j][j] };
        }
    }
    w
}

impl Supernodes {
    /// `x = W^-1 x`, after elimination, or `x = W x`, `before` substitution, for the columns' unknowns of right sides
    /// side by side, so many `lanes`.
    pub(crate) fn apply_roots(&self, tiles: &[Tile], x: &mut [f64], lanes: usize, before: bool) {
        for node in &self.nodes {
            let (width, mut tile) = (node.columns.len(), node.tiles.start);
            let height = width + self.unit * node.rows.len();
            for start in (0..width).step_by(PANEL) {
                let count = PANEL.min(width - start);
                let w = root(&tiles[tile..], count);
                tile += count * (height - start).div_ceil(LANES);
                let own = &mut x[lanes * (node.columns.start + start)..][..lanes * count];
                for lane in 0..lanes {
                    for k in 0..count {
                        let i = if before { count - 1 - k } else { k };
                        let known: f64 = (0..i).map(|j| w[i][j] * own[j * lanes + lane]).sum();
                        let value = &mut own[i * lanes + lane];
                        *value = if before { w[i][i] * *value + known } else { (*value - known) / w[i][i] };
                    }
                }
            }
        }
    }
}
