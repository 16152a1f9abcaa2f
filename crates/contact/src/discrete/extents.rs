//! How large the bodies are.

use signorini_fem_mesh::TetMesh;

/// The size of each body of a mesh.
#[derive(Debug)]
pub(crate) struct Extents {
    /// Body of each node; of a hinge the one that comes last.
    body: Vec<u32>,
    /// Longest side of the box around each body, m.
    extents: Vec<f64>,
}

impl Extents {
    pub(crate) fn new(mesh: &TetMesh) -> Self {
        let of_tet = mesh.components();
        let bodies = of_tet.iter().max().map_or(0, |last| *last as usize + 1);
        let mut body = vec![0; mesh.points().len()];
        let mut boxes = vec![[[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]; bodies];
        for (tet, &number) in mesh.tets().iter().zip(&of_tet) {
            let [low, high] = &mut boxes[number as usize];
            for &node in tet {
                body[node as usize] = number;
                for (c, x) in mesh.points()[node as usize].iter().enumerate() {
                    low[c] = low[c].min(*x);
                    high[c] = high[c].max(*x);
                }
            }
        }
        let longest = |[low, high]: &[[f64; 3]; 2]| (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max);
        Self {
            body,
            extents: boxes.iter().map(longest).collect(),
        }
    }

    /// Longest side of the box around the body of a node, m.
    pub(crate) fn at(&self, node: u32) -> f64 {
        self.extents[self.body[node as usize] as usize]
    }
}
