//! Files that several processes write together, read back by vtkio.

use crate::output::{fields, mesh, values};
use signorini_fem_mesh::output::{OutputError, PvdSeries};
use vtkio::model::{DataSet, Vtk};

/// Processes write a piece each, also of quadratic cells: together every tetrahedron once, with its nodes and fields.
#[test]
fn processes_write_their_pieces() {
    let linear = mesh();
    for mesh in [linear.clone().raise_order().unwrap(), linear] {
        let folder = tempfile::tempdir().unwrap();
        let (points, cells) = fields(&mesh);
        // process 1 has no tetrahedron
        let owners: Vec<u32> = (0..mesh.tets().len()).map(|t| [0, 2, 3][(t + t / 7) % 3]).collect();
        let mut series: Vec<PvdSeries> = (0..4)
            .map(|_| PvdSeries::create(folder.path(), "shared").unwrap())
            .collect();
        series[0].write(0.0, &mesh, &[], &[]).unwrap();
        series[1..].iter_mut().for_each(|own| {
            let resumed = PvdSeries::open_before(folder.path(), "shared", 0.5).unwrap();
            *own = resumed;
        });
        for (rank, own) in (0..).zip(&mut series) {
            own.write_part(0.5, &mesh, (&owners, rank), &points, &cells).unwrap();
        }
        let short = series[0].write_part(0.6, &mesh, (&owners[1..], 0), &points, &cells);
        assert!(matches!(short, Err(OutputError::Foreign { .. })));
        assert_eq!(PvdSeries::open(folder.path(), "shared").unwrap().times(), [0.0, 0.5]);
        let list = std::fs::read_to_string(folder.path().join("shared.pvd")).unwrap();
        assert!(
            list.contains("\"shared_0000.vtu\"") && list.contains("\"shared_0001.pvtu\""),
            "{list}"
        );
        let path = folder.path().join("shared_0001.pvtu");
        let mut file = Vtk::import(&path).unwrap();
        file.load_all_pieces().unwrap();
        let DataSet::UnstructuredGrid { pieces, .. } = file.data else {
            panic!("not an unstructured grid");
        };
        assert_eq!(pieces.len(), 3);
        let at = |p: &[f64]| [0, 1, 2].map(|c| p[c].to_bits());
        let mut found = Vec::new();
        for (piece, rank) in pieces.into_iter().zip([0, 2, 3]) {
            let piece = piece.into_loaded_piece_data(None).unwrap();
            let coordinates = piece.points.cast_into::<f64>().unwrap();
            let heights = values(&piece.data.point, "height");
            assert!(heights.iter().zip(coordinates.chunks(3)).all(|(h, p)| *h == p[2]));
            let numbers: Vec<usize> = values(&piece.data.cell, "stress")
                .chunks(6)
                .map(|s| s[3] as usize - 5)
                .collect();
            assert!(numbers.iter().all(|&t| owners[t] == rank));
            let (nodes, _) = piece.cells.cell_verts.into_xml();
            let corners = nodes.chunks(nodes.len() / numbers.len());
            for (t, corners) in numbers.into_iter().zip(corners) {
                let places = corners.iter().map(|&n| at(&coordinates[3 * n as usize..]));
                let expected: Vec<u32> = match mesh.order() {
                    1 => mesh.tets()[t].to_vec(),
                    _ => mesh.quadratic_tets()[t].to_vec(),
                };
                assert!(places.eq(expected.iter().map(|&n| at(&mesh.points()[n as usize]))));
                found.push(t);
            }
        }
        found.sort_unstable();
        assert!(found.into_iter().eq(0..mesh.tets().len()), "every tetrahedron once");
    }
}
