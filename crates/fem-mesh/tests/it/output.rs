//! Written files, read back by vtkio, which shares no code with the writer.

use approx::assert_abs_diff_eq;
use signorini_fem_mesh::brick::{Brick, X_MAX, Z_MIN};
use signorini_fem_mesh::output::{Field, OutputError, PvdSeries, write_surfaces_vtu, write_vtu};
use signorini_fem_mesh::{Surface, TetMesh};
use vtkio::model::{Attribute, CellType, DataSet, Piece, UnstructuredGridPiece, Vtk};

fn pieces(path: &std::path::Path) -> Vec<UnstructuredGridPiece> {
    let DataSet::UnstructuredGrid { pieces, .. } = Vtk::import(path).unwrap().data else {
        panic!("not an unstructured grid");
    };
    let load = |piece: Piece<_>| piece.into_loaded_piece_data(None).unwrap();
    pieces.into_iter().map(load).collect()
}

pub(crate) fn values(attributes: &[Attribute], name: &str) -> Vec<f64> {
    let found = attributes.iter().find_map(|a| match a {
        Attribute::DataArray(array) if array.name == name => array.data.cast_into::<f64>(),
        _ => None,
    });
    found.unwrap_or_else(|| panic!("no field {name}"))
}

pub(crate) fn mesh() -> TetMesh {
    Brick::new([3.0, 1.0, 1.0], [6, 2, 2])
        .perturbed(0.1, 1)
        .build()
        .unwrap()
}

pub(crate) fn fields(mesh: &TetMesh) -> (Vec<Field>, Vec<Field>) {
    let u: Vec<[f64; 3]> = mesh.points().iter().map(|p| p.map(|x| 0.1 * x)).collect();
    let heights = mesh.points().iter().map(|p| p[2]).collect();
    let stress: Vec<[f64; 6]> = (0..mesh.tets().len())
        .map(|t| [0.0, 1.0, 2.0, 3.0, 4.0, 5.0 + t as f64])
        .collect();
    (
        vec![Field::vector("displacement", &u), Field::scalar("height", heights)],
        vec![Field::symmetric_tensor("stress", &stress)],
    )
}

#[test]
fn one_piece() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("block.vtu");
    let mesh = mesh();
    let (points, cells) = fields(&mesh);
    write_vtu(&path, &mesh, &points, &cells).unwrap();
    let [piece] = &pieces(&path)[..] else {
        panic!("one piece is expected")
    };
    let coordinates = piece.points.cast_into::<f64>().unwrap();
    assert_eq!(coordinates, mesh.points().concat());
    assert!(piece.cells.types.iter().all(|&t| t == CellType::Tetra));
    let (connectivity, offsets) = piece.cells.cell_verts.clone().into_xml();
    let tets: Vec<u64> = mesh.tets().iter().flatten().map(|&n| n.into()).collect();
    assert_eq!(connectivity, tets);
    assert_eq!(*offsets.last().unwrap() as usize, 4 * mesh.tets().len());
    let heights = values(&piece.data.point, "height");
    assert!(heights.iter().zip(mesh.points()).all(|(h, p)| *h == p[2]));
    let displacement = values(&piece.data.point, "displacement");
    assert_eq!(displacement[4], 0.1 * mesh.points()[1][1]);
    let stress = values(&piece.data.cell, "stress");
    assert_eq!(stress[6..12], [0.0, 1.0, 2.0, 6.0, 3.0, 4.0]);
}

#[test]
fn surface() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("contact.vtu");
    let mesh = mesh();
    let surface = Surface::new(&mesh, &[Z_MIN]).unwrap();
    let area = Field::scalar("area", surface.areas().to_vec());
    write_surfaces_vtu(&path, &mesh, &[(&surface, &[area], &[])]).unwrap();
    let [piece] = &pieces(&path)[..] else {
        panic!("one piece is expected")
    };
    assert_eq!(piece.cells.num_cells(), surface.triangles().len());
    assert_abs_diff_eq!(
        values(&piece.data.point, "area").iter().sum::<f64>(),
        3.0,
        epsilon = 1e-13
    );
    // of a smaller mesh, and of a larger one, which has all nodes of the surface
    for cells in [[1; 3], [7, 2, 2]] {
        let other = Brick::new([1.0; 3], cells).build().unwrap();
        assert!(matches!(
            write_surfaces_vtu(&path, &other, &[(&surface, &[], &[])]),
            Err(OutputError::Foreign { what: "surface" })
        ));
    }
}

#[test]
fn series() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = mesh();
    let mut series = PvdSeries::create(folder.path().join("new"), "a&b").unwrap();
    for step in 0..3 {
        let time = Field::scalar("time", vec![f64::from(step); mesh.points().len()]);
        series.write(0.5 * f64::from(step), &mesh, &[time], &[]).unwrap();
    }
    series.write(2.0, &mesh, &[], &[]).unwrap();
    assert_eq!(series.times(), [0.0, 0.5, 1.0, 2.0]);
    let list = std::fs::read_to_string(series.path()).unwrap();
    assert_eq!(list.matches("<DataSet").count(), 4);
    assert!(list.contains("timestep=\"0.5\"") && list.contains("file=\"a&amp;b_0001.vtu\""));
    let last = pieces(&folder.path().join("new/a&b_0002.vtu"));
    assert!(values(&last[0].data.point, "time").iter().all(|&t| t == 2.0));
    for time in [2.0, 1.0, f64::NAN, f64::INFINITY] {
        let error = series.write(time, &mesh, &[], &[]).unwrap_err();
        assert!(matches!(error, OutputError::Time { before, .. } if before == 2.0));
    }
}

#[test]
fn a_series_is_continued() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, path) = (mesh(), folder.path());
    let write = |series: &mut PvdSeries, time: f64| {
        let field = Field::scalar("time", vec![time; mesh.points().len()]);
        series.write(time, &mesh, &[field], &[]).unwrap();
    };
    let written = |step: usize| {
        let file = path.join(format!("a&b_{step:04}.vtu"));
        values(&pieces(&file)[0].data.point, "time")[0]
    };
    // times whose decimals do not end, and a small one
    let times = [-1.0, 1e-300, 0.1 + 0.2, 1.0 / 3.0];
    let mut series = PvdSeries::create(path, "a&b").unwrap();
    times.iter().for_each(|&t| write(&mut series, t));
    let list = std::fs::read_to_string(series.path()).unwrap();

    let mut series = PvdSeries::open(path, "a&b").unwrap();
    assert_eq!(series.times(), times);
    let error = series.write(times[3], &mesh, &[], &[]).unwrap_err();
    assert!(matches!(error, OutputError::Time { .. }));
    write(&mut series, 2.0);
    assert_eq!((written(0), written(4)), (-1.0, 2.0));
    assert_eq!(PvdSeries::open(path, "a&b").unwrap().times(), series.times());

    // the third time again, computed otherwise
    let mut series = PvdSeries::open_before(path, "a&b", 0.3).unwrap();
    assert_eq!(series.times(), &times[..2]);
    for time in [0.3, 1.0 / 3.0] {
        write(&mut series, time);
    }
    assert_eq!((written(1), written(2)), (times[1], 0.3));
    let rewritten = std::fs::read_to_string(series.path()).unwrap();
    assert_eq!(rewritten, list.replace("0.30000000000000004", "0.3"));
    let opened = |time| PvdSeries::open_before(path, "a&b", time);
    assert_eq!(opened(9.0).unwrap().times(), series.times());
    assert!(opened(-1.0).unwrap().times().is_empty());
    assert!(matches!(opened(f64::NAN), Err(OutputError::Time { .. })));
}

#[test]
fn a_step_whose_list_failed_is_written_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut series = PvdSeries::create(folder.path(), "block").unwrap();
    series.write(0.0, &mesh(), &[], &[]).unwrap();
    let before = std::fs::read_to_string(series.path()).unwrap();
    // the list cannot be written, and the old one stays whole
    let beside = folder.path().join("block.pvd.tmp");
    std::fs::create_dir(&beside).unwrap();
    let error = series.write(1.0, &mesh(), &[], &[]).unwrap_err();
    assert!(matches!(error, OutputError::Io { path, .. } if path == beside));
    assert_eq!(series.times(), [0.0]);
    assert_eq!(std::fs::read_to_string(series.path()).unwrap(), before);
    std::fs::remove_dir(&beside).unwrap();
    series.write(1.0, &mesh(), &[], &[]).unwrap();
    let opened = PvdSeries::open(folder.path(), "block").unwrap();
    assert_eq!(opened.times(), [0.0, 1.0]);
    assert!(!beside.exists() && !folder.path().join("block_0002.vtu").exists());
}

/// A continued series replaces files that its old list names: each is whole at any moment.
#[test]
fn files_of_a_continued_series_are_whole_where_writing_fails() {
    let folder = tempfile::tempdir().unwrap();
    let field = |value: f64| Field::scalar("height", vec![value; mesh().points().len()]);
    let mut series = PvdSeries::create(folder.path(), "block").unwrap();
    for time in [0.0, 1.0, 2.0] {
        series.write(time, &mesh(), &[field(time)], &[]).unwrap();
    }
    let file = folder.path().join("block_0001.vtu");
    let beside = folder.path().join("block_0001.vtu.tmp");
    let before = std::fs::read(&file).unwrap();
    // the new file cannot be written
    std::fs::create_dir(&beside).unwrap();
    let mut again = PvdSeries::open_before(folder.path(), "block", 1.0).unwrap();
    let error = again.write(1.5, &mesh(), &[field(7.0)], &[]).unwrap_err();
    assert!(matches!(error, OutputError::Io { path, .. } if path == beside));
    assert_eq!(std::fs::read(&file).unwrap(), before);
    let list = PvdSeries::open(folder.path(), "block").unwrap();
    assert_eq!(list.times(), [0.0, 1.0, 2.0]);
    std::fs::remove_dir(&beside).unwrap();
    // half a file that a kill left is no part of the series, and is taken over
    std::fs::write(&beside, &before[..before.len() / 2]).unwrap();
    again.write(1.5, &mesh(), &[field(7.0)], &[]).unwrap();
    assert!(!beside.exists());
    let [piece] = &pieces(&file)[..] else {
        panic!("one piece is expected")
    };
    assert!(values(&piece.data.point, "height").iter().all(|&h| h == 7.0));
    let list = PvdSeries::open(folder.path(), "block").unwrap();
    assert_eq!(list.times(), [0.0, 1.5]);
}

#[test]
fn broken_lists_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let open = || PvdSeries::open(folder.path(), "block").unwrap_err();
    let error = open();
    assert!(matches!(error, OutputError::NoSeries { .. }));
    let text = error.to_string();
    assert!(text.contains("block.pvd") && text.contains("PvdSeries::create"));
    assert!(matches!(
        PvdSeries::open(folder.path(), "a/b"),
        Err(OutputError::SeriesName { .. })
    ));

    let mut series = PvdSeries::create(folder.path(), "block").unwrap();
    for time in [0.0, 1.0] {
        series.write(time, &mesh(), &[], &[]).unwrap();
    }
    let good = std::fs::read_to_string(series.path()).unwrap();
    let end = good.find("</VTKFile>").unwrap();
    for (list, at) in [
        (String::new(), 1),
        (good[..end - 5].into(), 6),
        (good[..end].into(), 7),
        (format!("{good}more"), 8),
        (good.replace("\"1\"", "\"0\""), 5),
        (good.replace("\"1\"", "\"one\""), 5),
        (good.replace("\"1\"", "\"NaN\""), 5),
        (good.replace("_0001", "_0002"), 5),
        (good.replace("LittleEndian", "BigEndian"), 2),
    ] {
        std::fs::write(series.path(), &list).unwrap();
        let error = open();
        assert!(
            matches!(error, OutputError::BrokenSeries { line, .. } if line == at),
            "{error}"
        );
        let text = error.to_string();
        assert!(text.contains("block.pvd") && text.contains("PvdSeries::create"));
    }
    // the ends of lines that an editor may leave
    std::fs::write(series.path(), good.replace('\n', "\r\n")).unwrap();
    let opened = PvdSeries::open(folder.path(), "block").unwrap();
    assert_eq!(opened.times(), [0.0, 1.0]);
}

#[test]
fn series_of_a_surface() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = mesh();
    let surface = Surface::new(&mesh, &[Z_MIN]).unwrap();
    let mut series = PvdSeries::create(folder.path(), "contact").unwrap();
    for step in 0..2 {
        let gap = Field::scalar("gap", vec![f64::from(step); surface.nodes().len()]);
        series
            .write_surfaces(f64::from(step), &mesh, &[(&surface, &[gap], &[])])
            .unwrap();
    }
    assert_eq!(series.times(), [0.0, 1.0]);
    let list = std::fs::read_to_string(series.path()).unwrap();
    assert!(list.contains("file=\"contact_0001.vtu\""));
    let [piece] = &pieces(&folder.path().join("contact_0001.vtu"))[..] else {
        panic!("one piece is expected")
    };
    assert_eq!(piece.cells.num_cells(), surface.triangles().len());
    assert!(values(&piece.data.point, "gap").iter().all(|&g| g == 1.0));
    let error = series.write_surfaces(1.0, &mesh, &[(&surface, &[], &[])]);
    assert!(matches!(error, Err(OutputError::Time { .. })));
    let short = [Field::scalar("gap", vec![0.0])];
    let error = series.write_surfaces(2.0, &mesh, &[(&surface, &short, &[])]);
    assert!(matches!(error, Err(OutputError::FieldLength { .. })));
    assert_eq!(series.times().len(), 2);
}

#[test]
fn bad_fields() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.vtu");
    let mesh = mesh();
    let (nodes, cells) = (mesh.points().len(), mesh.tets().len());
    let point = |field| write_vtu(&path, &mesh, &[field], &[]).unwrap_err();
    let error = point(Field::vector("u", &vec![[0.0; 3]; nodes - 1]));
    assert!(matches!(error, OutputError::FieldLength { what: "nodes", .. }));
    let error = point(Field::scalar("", vec![0.0; nodes]));
    assert!(matches!(error, OutputError::Unnamed { what: "nodes" }));
    let mut values = vec![0.0; cells];
    values[3] = f64::NAN;
    let error = write_vtu(&path, &mesh, &[], &[Field::scalar("s", values)]).unwrap_err();
    assert!(matches!(
        error,
        OutputError::NotFinite {
            what: "cells",
            index: 3,
            ..
        }
    ));
    assert!(!path.exists());
    let nowhere = folder.path().join("absent/x.vtu");
    assert!(matches!(
        write_vtu(nowhere, &mesh, &[], &[]),
        Err(OutputError::Io { .. })
    ));
    for name in ["", "a/b", "..", "a\\b"] {
        let error = PvdSeries::create(folder.path(), name).unwrap_err();
        assert!(matches!(error, OutputError::SeriesName { .. }), "{name}");
    }
}

#[test]
fn arrays_that_fill_their_last_block() {
    // 4096 nodes: coordinates and displacements are multiples of the block of compression.
    let mesh = Brick::new([1.0; 3], [15; 3]).build().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("full.vtu");
    write_vtu(&path, &mesh, &[Field::vector("u", mesh.points())], &[]).unwrap();
    assert_eq!(values(&pieces(&path)[0].data.point, "u"), mesh.points().concat());
    let smaller = Brick::new([1.0; 3], [14; 3]).build().unwrap();
    write_vtu(&path, &smaller, &[Field::vector("u", smaller.points())], &[]).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("vtkZLibDataCompressor"));
    assert_eq!(values(&pieces(&path)[0].data.point, "u"), smaller.points().concat());
}

#[test]
fn surfaces_are_pieces_with_the_same_fields() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("surfaces.vtu");
    let mesh = mesh();
    let [floor, wall] = [Z_MIN, X_MAX].map(|tag| Surface::new(&mesh, &[tag]).unwrap());
    let heights = |s: &Surface| {
        let values = s.nodes().iter().map(|&n| mesh.points()[n as usize][2]);
        [Field::scalar("height", values.collect())]
    };
    let (a, b) = (heights(&floor), heights(&wall));
    write_surfaces_vtu(&path, &mesh, &[(&floor, &a, &[]), (&wall, &b, &[])]).unwrap();
    let pieces = pieces(&path);
    assert_eq!(pieces.len(), 2);
    for (piece, surface) in pieces.iter().zip([&floor, &wall]) {
        assert_eq!(piece.cells.types.len(), surface.triangles().len());
        let coordinates = piece.points.cast_into::<f64>().unwrap();
        let heights: Vec<f64> = coordinates.chunks(3).map(|p| p[2]).collect();
        assert_eq!(values(&piece.data.point, "height"), heights);
    }
    let before = std::fs::read(&path).unwrap();
    let error = write_surfaces_vtu(&path, &mesh, &[(&floor, &a, &[]), (&wall, &[], &[])]).unwrap_err();
    assert!(matches!(error, OutputError::PieceFields { number: 1 }) && error.to_string().contains("surface 1"));
    assert_eq!(std::fs::read(&path).unwrap(), before);
}

/// A file that was cut is named before anything is written; one of a step that is dropped, or that its owner has put
/// elsewhere, is not missed.
#[test]
fn a_short_file_is_refused() {
    let directory = tempfile::tempdir().expect("a folder");
    let (folder, mesh) = (directory.path(), mesh());
    let mut series = PvdSeries::create(folder, "cut").expect("a series");
    for time in [0.0, 1.0, 2.0] {
        series.write(time, &mesh, &[], &[]).expect("a step");
    }
    let path = folder.join("cut_0001.vtu");
    let whole = std::fs::read(&path).expect("a file");
    for length in [whole.len() - 1, whole.len() / 2, 5, 0] {
        std::fs::write(&path, &whole[..length]).expect("a short file");
        for opened in [
            PvdSeries::open(folder, "cut"),
            PvdSeries::open_before(folder, "cut", 2.0),
        ] {
            let error = opened.expect_err("short");
            assert!(
                matches!(&error, OutputError::ShortFile { path: p } if *p == path),
                "{error}"
            );
            assert!(error.to_string().contains("cut_0001.vtu is cut short; put a copy"));
        }
        let series = PvdSeries::open_before(folder, "cut", 1.0).expect("written again");
        assert_eq!(series.times(), [0.0]);
    }
    std::fs::remove_file(&path).expect("elsewhere");
    assert_eq!(
        PvdSeries::open(folder, "cut").expect("a series").times(),
        [0.0, 1.0, 2.0]
    );
}

/// Cells of type 24, whose mid-nodes VTK has on the edges 01, 12, 20, 03, 13, 23.
#[test]
fn meshes_of_order_two_are_quadratic_cells() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = mesh().raise_order().unwrap();
    let (points, cells) = fields(&mesh);
    let whole = folder.path().join("whole.vtu");
    write_vtu(&whole, &mesh, &points, &cells).unwrap();
    for piece in pieces(&whole) {
        assert!(piece.cells.types.iter().all(|&t| t == CellType::QuadraticTetra));
        let places = piece.points.cast_into::<f64>().unwrap();
        let (connectivity, offsets) = piece.cells.cell_verts.clone().into_xml();
        assert_eq!(offsets.last().copied(), Some(connectivity.len() as u64));
        for cell in connectivity.chunks_exact(10) {
            for (mid, (a, b)) in cell[4..].iter().zip([(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]) {
                let at = |node: u64, c: usize| places[3 * node as usize + c];
                (0..3).for_each(|c| {
                    assert_abs_diff_eq!(2.0 * at(*mid, c), at(cell[a], c) + at(cell[b], c), epsilon = 1e-14)
                });
            }
        }
        let field = values(&piece.data.point, "height");
        assert_eq!(field.len(), places.len() / 3);
    }
}

/// Each file of a series is as it would be alone, also where points and cells are those of the file before, or change.
#[test]
fn files_of_a_series_are_as_alone() {
    let folder = tempfile::tempdir().unwrap();
    let (first, alone) = (mesh(), folder.path().join("alone.vtu"));
    let moved = Brick::new([3.0, 1.0, 1.0], [6, 2, 2])
        .perturbed(0.1, 2)
        .build()
        .unwrap();
    let quadratic = first.clone().raise_order().unwrap();
    let mut series = PvdSeries::create(folder.path(), "block").unwrap();
    let mut walls = PvdSeries::create(folder.path(), "walls").unwrap();
    for (step, mesh) in [&first, &first, &moved, &first, &quadratic].into_iter().enumerate() {
        let (points, cells) = fields(mesh);
        series.write(step as f64, mesh, &points, &cells).unwrap();
        write_vtu(&alone, mesh, &points, &cells).unwrap();
        let written = |name: &str| std::fs::read(folder.path().join(format!("{name}_{step:04}.vtu"))).unwrap();
        assert_eq!(written("block"), std::fs::read(&alone).unwrap(), "{step}");
        // one, two, and one more surface
        let tags = if step == 1 { &[X_MAX, Z_MIN][..] } else { &[Z_MIN] };
        let surfaces: Vec<Surface> = tags.iter().map(|&t| Surface::new(mesh, &[t]).unwrap()).collect();
        let pieces: Vec<_> = surfaces.iter().map(|s| (s, &[][..], &[][..])).collect();
        walls.write_surfaces(step as f64, mesh, &pieces).unwrap();
        write_surfaces_vtu(&alone, mesh, &pieces).unwrap();
        assert_eq!(written("walls"), std::fs::read(&alone).unwrap(), "{step}");
    }
}

#[test]
fn files_do_not_depend_on_the_number_of_threads() {
    let mesh = Brick::new([1.0; 3], [14; 3]).perturbed(0.1, 1).build().unwrap();
    let (points, cells) = fields(&mesh);
    let folder = tempfile::tempdir().unwrap();
    let file = |threads: usize| {
        let path = folder.path().join(format!("{threads}.vtu"));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| write_vtu(&path, &mesh, &points, &cells)).unwrap();
        std::fs::read(path).unwrap()
    };
    assert_eq!(file(1), file(3));
}
