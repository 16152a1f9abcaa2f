//! Hexahedra, prisms and pyramids become tetrahedra that fill them and fit together.

use crate::grid;
use proptest::prelude::*;
use signorini_fem_mesh::mesh::{Cell, CellShape, Division, drop_unused_nodes};
use signorini_fem_mesh::{MeshError, TetMesh};

/// A cell that owns its nodes.
type OwnCell = (CellShape, Vec<u32>);

/// A box of `n` cells along each side, of hexahedra or each of them as two prisms, whose nodes are numbered as `number`
/// says; `order` 2 has nodes on edges, 3 also in faces and in the middle.
fn cells(n: [usize; 3], prisms: bool, order: usize, number: &[u32]) -> (Vec<[f64; 3]>, Vec<OwnCell>) {
    let shape = if prisms { CellShape::Prism } else { CellShape::Hexahedron };
    let places = grid::cells(shape, order, n);
    let mut used: Vec<usize> = places.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    // the nodes in the order of the wanted numbers
    let wish = |place: &usize| (number[*place % number.len()], *place);
    used.sort_unstable_by_key(wish);
    let points = used.iter().map(|&number| grid::place(n, number));
    let new = |place: &usize| used.binary_search_by_key(&wish(place), wish).unwrap() as u32;
    let cells = places.iter().map(|nodes| (shape, nodes.iter().map(new).collect()));
    (points.collect(), cells.collect())
}

fn divide(points: &mut Vec<[f64; 3]>, cells: &[OwnCell]) -> Division {
    let cells: Vec<Cell> = cells
        .iter()
        .map(|(shape, nodes)| Cell { shape: *shape, nodes })
        .collect();
    Division::new(points, &cells).unwrap()
}

fn mesh(points: Vec<[f64; 3]>, division: &Division) -> Result<TetMesh, MeshError> {
    if division.mids.is_empty() {
        return TetMesh::new(points, division.tets.clone(), Vec::new());
    }
    let tets = division.tets.iter().zip(&division.mids);
    let whole = tets.map(|(tet, mids)| std::array::from_fn(|k| if k < 4 { tet[k] } else { mids[k - 4] }));
    TetMesh::quadratic(points, whole.collect(), Vec::new())
}

/// A polynomial of second degree, which elements of second order represent.
fn bent([x, y, z]: [f64; 3]) -> [f64; 3] {
    [
        x + 0.1 * y * z - 0.05 * x * x,
        y + 0.08 * x * z + 0.06 * z * z,
        z - 0.07 * x * y + 0.05 * y * y,
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn whatever_the_numbers_of_nodes(
        n in prop::array::uniform3(1_usize..4),
        prisms: bool,
        order in 1_usize..4,
        number in prop::collection::vec(0_u32..1000, 1..60),
    ) {
        let (mut points, cells) = cells(n, prisms, order, &number);
        let given = points.len();
        let division = divide(&mut points, &cells);
        prop_assert_eq!(division.added().len() == 0, order != 2);
        prop_assert_eq!(points.len(), given + division.added().len());
        // the checks of a mesh see gaps and overlaps
        let mesh = mesh(points.clone(), &division).unwrap();
        prop_assert!((mesh.total_volume() - 1.0).abs() < 1e-12);
        prop_assert_eq!(mesh.components().into_iter().max(), Some(0));
        for ((shape, nodes), tets) in cells.iter().zip(&division.of_cell) {
            prop_assert_eq!(tets.len(), if prisms { 3 } else { 6 });
            let mut triangles = vec![0; shape.faces().len() + 1];
            for tet in tets.clone() {
                let corners = division.tets[tet as usize];
                for (face, on) in [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]].iter().zip(division.faces[tet as usize]) {
                    triangles[on as usize] += 1;
                    let within = |k: &usize| (on as usize).checked_sub(1).is_none_or(|on| {
                        shape.faces()[on].iter().any(|&c| nodes[c] == corners[*k])
                    });
                    prop_assert!(face.iter().all(within));
                }
            }
            for (face, found) in shape.faces().iter().zip(&triangles[1..]) {
                prop_assert_eq!(*found, face.len() - 2);
            }
        }
        if order == 1 {
            let mut points = points[..given].to_vec();
            let cells: Vec<Cell> = cells.iter().map(|(shape, nodes)| Cell { shape: *shape, nodes }).collect();
            let raised = Division::raised(&mut points, &cells).unwrap();
            prop_assert_eq!(&raised.tets, &division.tets);
            // in the middle of each edge
            let straight = mesh.raise_order().unwrap();
            let same = |a: &[f64; 3], b: &[f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-14);
            let mids = raised.mids.iter().zip(straight.mids()).flat_map(|(a, b)| a.iter().zip(b));
            for (a, b) in mids {
                prop_assert!(same(&points[*a as usize], &straight.points()[*b as usize]));
            }
            let whole = self::mesh(points, &raised).unwrap();
            prop_assert_eq!(whole.points().len(), straight.points().len());
        }
        if order > 1 {
            // new nodes are where the shape functions of the cell have the middle
            let (mut curved, straight) = (points[..given].iter().map(|p| bent(*p)).collect::<Vec<_>>(), points);
            divide(&mut curved, &cells);
            for (curved, straight) in curved.iter().zip(&straight) {
                let off = (0..3).map(|i| (curved[i] - bent(*straight)[i]).abs()).fold(0.0, f64::max);
                prop_assert!(off < 1e-14, "{} {:?} {:?}", off, curved, straight);
            }
        }
    }
}

/// Hexahedra with corners that are one node are the prisms that they look like.
#[test]
fn collapsed_hexahedra() {
    const CORNERS: [usize; 8] = [0, 1, 2, 2, 3, 4, 5, 5];
    for order in [1, 2] {
        let (points, prisms) = cells([2, 2, 2], true, order, &[5, 1, 7, 3, 3, 8]);
        let collapsed = |nodes: &Vec<u32>| {
            let mut out: Vec<u32> = CORNERS.iter().map(|&k| nodes[k]).collect();
            if order == 2 {
                let mid = |ends: &[usize; 2]| {
                    let ends = ends.map(|k| CORNERS[k]);
                    let is = |edge: &[usize; 2]| edge.iter().all(|k| ends.contains(k));
                    let edge = CellShape::Prism.edges().iter().position(is);
                    edge.map_or(nodes[ends[0]], |edge| nodes[6 + edge])
                };
                out.extend(CellShape::Hexahedron.edges().iter().map(mid));
            }
            (CellShape::Hexahedron, out)
        };
        let hexahedra: Vec<OwnCell> = prisms.iter().map(|(_, nodes)| collapsed(nodes)).collect();
        let [mut first, mut second] = [points.clone(), points];
        let [plain, other] = [divide(&mut first, &prisms), divide(&mut second, &hexahedra)];
        let sorted = |division: &Division| {
            let mut tets = division.tets.clone();
            tets.iter_mut().for_each(|tet| tet.sort_unstable());
            tets.sort_unstable();
            tets
        };
        assert_eq!((sorted(&plain), first.len()), (sorted(&other), second.len()));
        let [plain, other] = [(first, plain), (second, other)].map(|(points, own)| mesh(points, &own).unwrap());
        let sorted = |mesh: &TetMesh| {
            let mut points = mesh.points().to_vec();
            points.sort_by(|a, b| a.partial_cmp(b).unwrap());
            points
        };
        assert_eq!(sorted(&plain), sorted(&other));
        assert!((other.total_volume() - 1.0).abs() < 1e-12);
    }
}

/// An edge of one cell on the diagonal of another one, in whatever order they are.
#[test]
fn edges_come_before_diagonals() {
    let mut points: Vec<[f64; 3]> = Vec::new();
    for z in [0.0, 1.0, 2.0] {
        points.extend([[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]]);
    }
    points.pop();
    let cube = Cell {
        shape: CellShape::Hexahedron,
        nodes: &[0, 1, 2, 3, 4, 5, 6, 7],
    };
    let prism = Cell {
        shape: CellShape::Prism,
        nodes: &[4, 5, 6, 8, 9, 10],
    };
    for cells in [[cube, prism], [prism, cube]] {
        let mut points = points.clone();
        let division = Division::raised(&mut points, &cells).unwrap();
        let between: Vec<usize> = division
            .added()
            .filter(|around| [4, 6].iter().all(|n| around.iter().any(|a| a.0 == *n && a.1 != 0.0)))
            .map(<[_]>::len)
            .collect();
        assert_eq!(between, [2]);
        assert!((mesh(points, &division).unwrap().total_volume() - 1.5).abs() < 1e-12);
    }
    // the other diagonal does not fit
    let across = Cell {
        shape: CellShape::Prism,
        nodes: &[5, 6, 7, 8, 9, 10],
    };
    assert!(matches!(
        Division::new(&mut points, &[across, cube]),
        Err(MeshError::CellsCross { first: 1, second: 0 })
    ));
}

/// Hexahedra with nodes on edges only beside those with nodes in faces, too: the common face has one node.
#[test]
fn cells_of_20_and_27_nodes_fit() {
    for small in [0, 1] {
        let (mut points, mut cells) = cells([2, 1, 1], false, 3, &[5, 1, 7, 3, 3, 8]);
        cells[small].1.truncate(20);
        let division = divide(&mut points, &cells);
        let tets = division.tets.iter().zip(&division.mids);
        let whole =
            |(tet, mids): (&[u32; 4], &[u32; 6])| std::array::from_fn(|k| if k < 4 { tet[k] } else { mids[k - 4] });
        let mut tets: Vec<[u32; 10]> = tets.map(whole).collect();
        drop_unused_nodes(&mut points, &mut tets, &mut []);
        let mesh = TetMesh::quadratic(points, tets, Vec::new()).unwrap();
        assert_eq!(mesh.components().into_iter().max(), Some(0));
    }
}

#[test]
fn wrong_cells() {
    let mut points = vec![[0.0; 3]; 8];
    let nodes = [0, 1, 2, 3, 4, 5, 6, 7];
    let mut error = |shape, nodes: &[u32]| Division::new(&mut points, &[Cell { shape, nodes }]).unwrap_err();
    assert!(matches!(
        error(CellShape::Prism, &nodes),
        MeshError::CellNodes { cell: 0, nodes: 8, .. }
    ));
    assert!(matches!(
        error(CellShape::Hexahedron, &[1, 2, 3, 4, 5, 6, 7, 8]),
        MeshError::CellNode {
            cell: 0,
            node: 8,
            nodes: 8
        }
    ));
    let cube = Cell {
        shape: CellShape::Hexahedron,
        nodes: &nodes,
    };
    assert!(matches!(
        error(CellShape::Hexahedron, &[0, 1, 2, 2, 0, 1, 2, 2]),
        MeshError::CellFlat { cell: 0 }
    ));
    let ten = [0, 1, 2, 3, 4, 5, 6, 7, 0, 1];
    let second = Cell {
        shape: CellShape::Tetrahedron,
        nodes: &ten,
    };
    let mixed = Division::new(&mut points, &[cube, second]).unwrap_err();
    assert!(matches!(mixed, MeshError::MixedOrder { first: 1, second: 2 }));
    assert!(Division::new(&mut points, &[]).is_ok_and(|none| none.tets.is_empty() && none.added().len() == 0));
}

/// Files of Gmsh 4.15: their volume, area of the boundary with names and order.
#[cfg(feature = "gmsh")]
#[test]
fn files_of_gmsh() {
    use signorini_fem_mesh::Surface;
    use signorini_fem_mesh::gmsh::read_gmsh;
    let ring = std::f64::consts::PI * 0.75;
    // side faces of the ring: straight quadrilaterals, and arcs
    let whole = 2.0 * ring + 2.0 + 3.0 * std::f64::consts::FRAC_PI_2;
    let polygon = 6.0 * (std::f64::consts::PI / 8.0).sin();
    for (name, order, tets, volume, area, error) in [
        ("hand_o1", 1, 12, 11.0 / 6.0, 1.935_414_346_693, 1e-11),
        ("hand_o2", 2, 12, 11.0 / 6.0, 1.935_414_346_693, 1e-11),
        ("hand_o2inc", 2, 12, 11.0 / 6.0, 1.935_414_346_693, 1e-11),
        ("mixed_o1", 1, 162, 2.0, 10.0, 1e-12),
        ("mixed_o2_bin", 2, 162, 2.0, 10.0, 1e-12),
        ("mixed_o2inc_bin", 2, 162, 2.0, 10.0, 1e-12),
        ("plate_prism6", 1, 132, 2.0, 10.0, 1e-12),
        ("plate_prism15", 2, 132, 2.0, 10.0, 1e-12),
        ("plate_prism18_bin", 2, 132, 2.0, 10.0, 1e-12),
        ("warped_hexprism_o2inc_bin", 2, 324, 2.0, 10.0, 1e-12),
        ("ring_hex8", 1, 96, polygon, 11.274_368_916_77, 1e-11),
        ("ring_hex20", 2, 96, ring, whole, 1e-3),
        ("ring_hex27_bin", 2, 96, ring, whole, 1e-3),
    ] {
        let path = format!("{}/tests/data/{name}.msh", env!("CARGO_MANIFEST_DIR"));
        let (mesh, names) = read_gmsh(path).unwrap();
        assert_eq!((mesh.order(), mesh.tets().len()), (order, tets), "{name}");
        let off = mesh.total_volume() / volume - 1.0;
        assert!(off.abs() < error, "{name}: volume {} off {off:e}", mesh.total_volume());
        let tags: Vec<_> = names.surfaces().map(|(_, tag)| tag).collect();
        let found: f64 = tags
            .iter()
            .map(|tag| Surface::new(&mesh, &[*tag]).unwrap().total_area())
            .sum();
        assert!((found / area - 1.0).abs() < error, "{name}: area {found} for {area}");
        assert_eq!(mesh.components().iter().max(), Some(&0), "{name}");
        if name.starts_with("mixed") {
            let hexahedra = names.volume("HEXES").unwrap();
            let inside = (0..tets).filter(|&t| mesh.regions()[t] == hexahedra);
            let volume: f64 = inside.map(|t| mesh.volume(t)).sum();
            assert!((volume - 1.0).abs() < 1e-12);
        }
    }
}
