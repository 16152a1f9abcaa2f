//! Decompositions of the brick: counts, copies, translates.

use signorini_fem_mesh::{Brick, Decomposition};

fn brick(n: usize) -> (signorini_fem_mesh::TetMesh, Decomposition) {
    let mesh = Brick::new([3.0, 1.0, 1.0], [15 * n, 5 * n, 5 * n])
        .build()
        .unwrap();
    let parts = Decomposition::boxes(&mesh, [3 * n, n, n]).unwrap();
    (mesh, parts)
}

#[test]
fn torn_unknowns_are_those_of_table_6_1() {
    for (n, expected) in [(1, 1944), (2, 15552), (3, 52488)] {
        let (mesh, parts) = brick(n);
        assert_eq!(parts.subdomains().len(), 3 * n * n * n);
        assert_eq!(parts.torn_dofs(), expected);
        let copies: usize = (0..mesh.points().len())
            .map(|i| parts.copies(i).len())
            .sum();
        assert_eq!(3 * copies, expected);
    }
}
