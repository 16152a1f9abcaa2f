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
    /// Auxiliary problems, for loading b and c.
    pub it: [usize; 2],
    /// Products with F, for loading b and c.
    pub n_m: [usize; 2],
    /// Seconds, for loading b and c.
    pub seconds: [f64; 2],
}

impl PaperRow {
    /// Auxiliary problems, products and seconds for one loading.
    #[must_use]
    pub fn costs(&self, loading: Loading) -> (usize, usize, f64) {
        let k = match loading {
            Loading::B => 0,
            Loading::C => 1,
        };
        (self.it[k], self.n_m[k], self.seconds[k])
    }
}

/// All lines.
pub const TABLE: [PaperRow; 5] = [
    PaperRow {
        n: 1,
        n_s: 3,
        n_p: 1944,
        n_d: 612,
        it: [563, 908],
        n_m: [17_798, 18_194],
        seconds: [2.2e2, 2.1e2],
    },
    PaperRow {
        n: 2,
        n_s: 24,
        n_p: 15_552,
        n_d: 5685,
        it: [639, 1101],
        n_m: [23_612, 35_279],
        seconds: [2.0e3, 2.9e3],
    },
    PaperRow {
        n: 3,
        n_s: 81,
        n_p: 52_488,
        n_d: 20_136,
        it: [743, 1342],
        n_m: [29_763, 33_444],
        seconds: [9.7e3, 1.2e4],
    },
    PaperRow {
        n: 4,
        n_s: 192,
        n_p: 124_416,
        n_d: 48_879,
        it: [835, 1627],
        n_m: [29_252, 33_950],
        seconds: [2.1e4, 2.4e4],
    },
    PaperRow {
        n: 5,
        n_s: 375,
        n_p: 243_000,
        n_d: 96_828,
        it: [913, 1876],
        n_m: [29_741, 39_369],
        seconds: [4.7e4, 6.1e4],
    },
];

/// The line for `n`, if the paper has it.
#[must_use]
pub fn row(n: usize) -> Option<&'static PaperRow> {
    TABLE.iter().find(|r| r.n == n)
}
