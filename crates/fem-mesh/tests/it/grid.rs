//! Boxes cut into cells of one shape, for tests here and of decks, and for the beam of the study `calculix`.

use super::CellShape;

const CUBE: [[usize; 3]; 8] = [
    [0, 0, 0],
    [2, 0, 0],
    [2, 2, 0],
    [0, 2, 0],
    [0, 0, 2],
    [2, 0, 2],
    [2, 2, 2],
    [0, 2, 2],
];

/// Corners of the cells of a box that is two steps wide.
fn corners(shape: CellShape) -> Vec<Vec<[usize; 3]>> {
    match shape {
        CellShape::Prism => [[0, 1, 3, 4, 5, 7], [1, 2, 3, 5, 6, 7]]
            .map(|cell| cell.map(|k| CUBE[k]).to_vec())
            .to_vec(),
        // between the middle and the sides
        CellShape::Pyramid => {
            let side = |face: &&[usize]| face.iter().map(|&k| CUBE[k]).chain([[1, 1, 1]]).collect();
            CellShape::Hexahedron.faces().iter().map(side).collect()
        }
        CellShape::Hexahedron | CellShape::Tetrahedron => vec![CUBE.to_vec()],
    }
}

/// The cells of `n` boxes along each side by numbers of places, from 0, along x, y and z in half boxes; `order` 2 has
/// nodes on edges, 3 also in faces and in the middle.
pub(crate) fn cells(shape: CellShape, order: usize, n: [usize; 3]) -> Vec<Vec<usize>> {
    let along = n.map(|n| 2 * n + 1);
    let number = |p: [usize; 3]| (p[2] * along[1] + p[1]) * along[0] + p[0];
    let mut out = Vec::new();
    for k in 0..n[0] * n[1] * n[2] {
        let at = [k % n[0], k / n[0] % n[1], k / n[0] / n[1]];
        for corners in corners(shape) {
            let corner = |k: usize| [0, 1, 2].map(|i| 2 * at[i] + corners[k][i]);
            let middle = |of: &[usize]| {
                let sum = |i: usize| of.iter().map(|&k| corner(k)[i]).sum::<usize>();
                number([0, 1, 2].map(|i| sum(i) / of.len()))
            };
            let mut nodes: Vec<usize> = (0..corners.len()).map(|k| number(corner(k))).collect();
            if order > 1 {
                nodes.extend(shape.edges().iter().map(|ends| middle(ends)));
            }
            if order > 2 {
                nodes.extend(shape.faces().iter().filter(|f| f.len() == 4).map(|f| middle(f)));
                nodes.extend((shape == CellShape::Hexahedron).then(|| middle(&[0, 6])));
            }
            out.push(nodes);
        }
    }
    out
}

/// Where a number is in the unit cube.
pub(crate) fn place(n: [usize; 3], number: usize) -> [f64; 3] {
    let along = n.map(|n| 2 * n + 1);
    let p = [
        number % along[0],
        number / along[0] % along[1],
        number / along[0] / along[1],
    ];
    [0, 1, 2].map(|i| p[i] as f64 / (along[i] - 1) as f64)
}
