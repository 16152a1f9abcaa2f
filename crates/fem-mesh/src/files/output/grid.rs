//! Points and cells of a piece, encoded once for all files that have them.

use super::xml::File;

/// Points and cells, and how they stand in a file.
#[derive(Debug)]
pub(super) struct Grid {
    points: Vec<[f64; 3]>,
    /// Nodes of the cells one after the other, and how many each has.
    cells: Vec<u32>,
    corners: usize,
    text: Vec<u8>,
}

impl Grid {
    /// The grid with this number, which is that of the file before if it has the same points and cells.
    pub(super) fn of<const N: usize>(
        grids: &mut Vec<Self>,
        number: usize,
        points: Vec<[f64; 3]>,
        cells: Vec<[u32; N]>,
    ) -> &Self {
        let same = |g: &Self| g.corners == N && g.cells == cells.as_flattened() && g.points == points;
        if !grids.get(number).is_some_and(same) {
            let text = encoded(&points, &cells);
            let cells = cells.into_flattened();
            grids.truncate(number);
            grids.push(Self {
                points,
                cells,
                corners: N,
                text,
            });
        }
        &grids[number]
    }

    /// Of points and of cells.
    pub(super) fn counts(&self) -> [usize; 2] {
        [self.points.len(), self.cells.len() / self.corners]
    }

    pub(super) fn text(&self) -> &[u8] {
        &self.text
    }
}

fn encoded<const N: usize>(points: &[[f64; 3]], cells: &[[u32; N]]) -> Vec<u8> {
    let mut file = File(Vec::new());
    file.open("Points", "");
    file.array("Float64", "Points", 3, points.as_flattened(), f64::to_le_bytes);
    file.close("Points");
    file.open("Cells", "");
    integers(&mut file, "connectivity", points.len(), cells.as_flattened());
    let offsets: Vec<u64> = (1..=cells.len()).map(|n| (N * n) as u64).collect();
    integers(&mut file, "offsets", N * cells.len(), &offsets);
    // triangle, tetrahedron or quadratic tetrahedron, whose nodes VTK has in the same order
    let kind = match N {
        3 => 5,
        4 => 10,
        _ => 24,
    };
    file.array("UInt8", "types", 1, &vec![kind; cells.len()], u8::to_le_bytes);
    file.close("Cells");
    file.0
}

/// Integers up to the largest one, in 32 bits where these hold it.
fn integers<T: Copy + Sync + Into<u64>>(file: &mut File, name: &str, largest: usize, values: &[T]) {
    if i32::try_from(largest).is_ok() {
        file.array("Int32", name, 1, values, |v| (v.into() as i32).to_le_bytes());
    } else {
        file.array("Int64", name, 1, values, |v| v.into().to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_that_32_bits_do_not_hold_take_64() {
        let kind = |largest: usize| {
            let mut file = File(Vec::new());
            integers(&mut file, "offsets", largest, &[largest as u64]);
            String::from_utf8(file.0).expect("text")
        };
        // one block of 4 and of 8 bytes
        assert!(
            kind(i32::MAX as usize).contains("Int32") && kind(i32::MAX as usize).contains("AQAAAAAAAAAAgAAAAAAAAAQ")
        );
        assert!(kind(1 << 31).contains("Int64") && kind(1 << 31).contains("AQAAAAAAAAAAgAAAAAAAAAg"));
    }
}
