//! The paper's Table 6.1.

use crate::brick::Loading;

/// A line of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaperRow {
    /// Subdomains along the short edges.
    pub n: usize,
    /// Subdomains.
    pub n_s: usize,
    /// Unknown displacements.
    pub n_p: usize,
    /// Multipliers as the paper counts them.
    pub n_d: usize,
    /// Auxiliary problems, products with F and seconds, for loading b and c.
    costs: [(usize, usize, f64); 2],
}

impl PaperRow {
    /// Auxiliary problems, products with F and seconds for one loading.
    pub fn costs(&self, loading: Loading) -> (usize, usize, f64) {
        self.costs[usize::from(loading == Loading::C)]
    }
}

type Costs = (usize, usize, f64);

const fn line(n: usize, [n_s, n_p, n_d]: [usize; 3], b: Costs, c: Costs) -> PaperRow {
    let costs = [b, c];
    PaperRow {
        n,
        n_s,
        n_p,
        n_d,
        costs,
    }
}

/// All lines.
pub const TABLE: [PaperRow; 5] = [
    line(1, [3, 1944, 612], (563, 17_798, 2.2e2), (908, 18_194, 2.1e2)),
    line(2, [24, 15_552, 5685], (639, 23_612, 2.0e3), (1101, 35_279, 2.9e3)),
    line(3, [81, 52_488, 20_136], (743, 29_763, 9.7e3), (1342, 33_444, 1.2e4)),
    line(4, [192, 124_416, 48_879], (835, 29_252, 2.1e4), (1627, 33_950, 2.4e4)),
    line(5, [375, 243_000, 96_828], (913, 29_741, 4.7e4), (1876, 39_369, 6.1e4)),
];

/// The line for `n`, if the paper has it.
pub fn row(n: usize) -> Option<&'static PaperRow> {
    TABLE.iter().find(|r| r.n == n)
}
