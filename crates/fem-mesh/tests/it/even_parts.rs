//! The cut of a mesh that comes without one: connected parts of similar size, boxes where boxes are best.

use signorini_fem_mesh::decomposition::{PartCount, even_parts, volumes_and_surfaces};
use signorini_fem_mesh::{Brick, Decomposition, DecompositionError, TetMesh};

fn brick(cells: [usize; 3]) -> TetMesh {
    Brick::new([3.0, 1.0, 1.0], cells).build().expect("a brick")
}

fn sizes(parts: &[u32]) -> Vec<usize> {
    let mut sizes = vec![0; parts.iter().max().map_or(0, |&p| p as usize + 1)];
    parts.iter().for_each(|&part| sizes[part as usize] += 1);
    sizes
}

fn turned([x, y, z]: [f64; 3]) -> [f64; 3] {
    [
        0.8 * x - 0.48 * y - 0.36 * z,
        0.6 * x + 0.64 * y + 0.48 * z,
        0.8 * z - 0.6 * y,
    ]
}

/// One cut for the whole mesh, whatever its tetrahedra are made of.
fn even(mesh: &TetMesh, count: usize) -> Vec<u32> {
    even_parts(mesh, &vec![0; mesh.tets().len()], PartCount::Exactly(count)).expect("parts")
}

#[test]
fn a_brick_falls_into_its_boxes() {
    for (cells, boxes) in [
        ([15, 5, 5], [3, 1, 1]),
        ([24, 8, 8], [6, 2, 2]),
        ([45, 15, 15], [9, 3, 3]),
    ] {
        let mesh = brick(cells);
        let parts = even(&mesh, boxes.iter().product());
        let grid = Decomposition::boxes(&mesh, boxes).expect("boxes");
        let same = (0..parts.len()).all(|a| {
            let b = (a + 1) % parts.len();
            (parts[a] == parts[b]) == (grid.parts()[a] == grid.parts()[b])
        });
        assert!(same, "{boxes:?}: {:?}", sizes(&parts));
    }
}

#[test]
fn about_so_many_is_the_grid_nearest_by() {
    let labels = |mesh: &TetMesh| vec![0; mesh.tets().len()];
    for (cells, about, boxes) in [
        ([15, 5, 5], 3, 3),
        ([30, 10, 10], 21, 24),
        ([30, 10, 10], 27, 24),
        ([45, 15, 15], 72, 81),
        ([45, 15, 15], 90, 81),
    ] {
        let mesh = brick(cells);
        let parts = even_parts(&mesh, &labels(&mesh), PartCount::About(about)).expect("parts");
        assert_eq!(
            sizes(&parts),
            vec![parts.len() / boxes; boxes],
            "{cells:?} about {about}"
        );
    }
}

/// Straight, oblique and bent by half a circle; other bodies are not cut for their shape.
#[test]
fn rods_fall_into_lengths_of_about_twice_their_thickness() {
    let rod = |long: f64, wide: f64, cells| Brick::new([long, wide, 1.0], cells).build().expect("a rod");
    let straight = rod(30.0, 1.0, [60, 2, 2]);
    let oblique = straight.map_points(turned).expect("turned");
    let about = |turn: f64| move |[x, y, z]: [f64; 3]| ((x * turn / 30.0).sin_cos(), 30.0 / turn - y, z);
    let bent = |turn| {
        let place = about(turn);
        straight.map_points(move |p| {
            let ((sin, cos), radius, z) = place(p);
            [radius * sin, -radius * cos, z]
        })
    };
    let half = bent(std::f64::consts::PI).expect("bent");
    let count = |mesh: &TetMesh| {
        let parts = even_parts(mesh, &vec![0; mesh.tets().len()], PartCount::About(1)).expect("parts");
        sizes(&parts).len()
    };
    for rod in [straight.clone(), oblique, half] {
        let count = count(&rod);
        assert!((12..=16).contains(&count), "{count}");
    }
    let nearly_a_ring = bent(6.2).expect("bent");
    let strip = rod(16.0, 4.0, [32, 8, 2]);
    assert!((9..=18).contains(&count(&strip)));
    for whole in [nearly_a_ring, rod(6.0, 1.0, [12, 2, 2]), rod(30.0, 30.0, [12, 12, 1])] {
        assert_eq!(count(&whole), 1);
    }
    // not more than their tetrahedra allow
    for (cells, most) in [(8, 1), (20, 3), (100, 16)] {
        let wire = rod(300.0, 1.0, [cells, 1, 1]);
        let quadratic = wire.raise_order().expect("order 2");
        let found = [&wire, &quadratic].map(count);
        assert!(
            found[0] <= most && found[1] <= cells / 2,
            "{found:?} of {} tetrahedra",
            5 * cells
        );
    }
    // a rod beside a block
    let beside = straight.map_points(|[x, y, z]| [x, y + 5.0, z]).expect("moved");
    assert_eq!(
        count(&rod(4.0, 4.0, [4, 4, 2]).append(&beside).expect("two")),
        1 + count(&straight)
    );
}

/// Where a body lies does not matter.
#[test]
fn oblique_bodies_are_cut_as_straight_ones() {
    let graded = brick([18, 6, 6])
        .map_points(|[x, y, z]| [x * x, y, z * z])
        .expect("graded");
    let cube = Brick::new([1.0; 3], [8; 3]).build().expect("a cube");
    let plate = Brick::new([4.0, 3.0, 0.1], [16, 12, 1]).build().expect("a plate");
    let strap = Brick::new([2.0, 1.5, 0.1], [40, 6, 1]).build().expect("a strap");
    let strap = strap
        .map_points(|[x, y, z]| [(1.0 + z) * x.sin(), y, (1.0 + z) * x.cos()])
        .expect("bent");
    let both = cube
        .append(
            &brick([15, 5, 5])
                .map_points(|[x, y, z]| [x, y, z + 2.0])
                .expect("moved"),
        )
        .expect("two");
    for mesh in [
        brick([15, 5, 5]),
        graded,
        cube,
        plate.raise_order().expect("order 2"),
        both,
        strap,
    ] {
        let oblique = mesh.map_points(turned).expect("turned");
        for count in [PartCount::Exactly(8), PartCount::About(27), PartCount::About(1)] {
            let cut = |mesh: &TetMesh| even_parts(mesh, &vec![0; mesh.tets().len()], count).expect("parts");
            let parts = [&mesh, &oblique].map(cut);
            let numbers = parts.each_ref().map(|parts| sizes(parts).len());
            let surface = |k: usize| {
                let surfaces = volumes_and_surfaces([&mesh, &oblique][k], &parts[k]);
                surfaces.iter().map(|[_, surface]| surface).sum::<f64>()
            };
            let ratio = surface(1) / surface(0);
            assert_eq!(numbers[0], numbers[1], "{count:?}");
            assert!((ratio - 1.0).abs() < 0.05, "{count:?} {numbers:?}: {ratio}");
        }
    }
}

/// Parts that cut through long cells, and flat ones, take up to fifty times the iterations.
#[test]
fn graded_bricks_fall_into_boxes_that_are_not_flat() {
    for grading in [1.5, 1.8, 2.2] {
        for cells in [[12, 4, 4], [18, 6, 6], [30, 10, 10]] {
            let towards = |s: f64| {
                if s < 0.5 {
                    0.5 * (2.0 * s).powf(grading)
                } else {
                    1.0 - 0.5 * (2.0 - 2.0 * s).powf(grading)
                }
            };
            let mesh = brick(cells);
            let mesh = mesh
                .map_points(|[x, y, z]| [3.0 * towards(x / 3.0), towards(y), towards(z)])
                .expect("graded");
            let labels = vec![0; mesh.tets().len()];
            let about = PartCount::About(mesh.tets().len() / 120);
            let linear = sizes(&even_parts(&mesh, &labels, about).expect("parts")).len();
            assert_eq!(
                linear < 40,
                mesh.tets().len() < 40 * 120,
                "{cells:?} {grading}: {linear}"
            );
            let mesh = mesh.raise_order().expect("order 2");
            let parts = even_parts(&mesh, &labels, about).expect("parts");
            let count = sizes(&parts).len();
            // between quadratic cells fifty times as long as thick they are six times larger
            let strongly = grading == 2.2 && cells[0] == 30;
            assert_eq!(
                count < 40,
                strongly || mesh.tets().len() < 40 * 120,
                "{cells:?} {grading}: {count}"
            );
            for part in 0..count as u32 {
                let own: Vec<usize> = (0..parts.len()).filter(|&tet| parts[tet] == part).collect();
                let points = || own.iter().flat_map(|&tet| mesh.tet_points(tet));
                let lengths = [0, 1, 2].map(|d| {
                    let along = || points().map(|p| p[d]);
                    along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min)
                });
                let volume: f64 = own.iter().map(|&tet| mesh.volume(tet)).sum();
                let full = lengths.iter().product::<f64>();
                assert!(
                    volume > (1.0 - 1e-9) * full,
                    "{cells:?} {grading}: part {part} is ragged"
                );
                let (long, short) = (
                    lengths.into_iter().fold(0.0, f64::max),
                    lengths.into_iter().fold(9.0, f64::min),
                );
                assert!(
                    long < 8.0 * short,
                    "{cells:?} {grading}: part {part} is flat, {lengths:?}"
                );
            }
        }
    }
}

#[test]
fn any_count_gives_connected_parts_of_similar_size() {
    let mesh = brick([18, 6, 6]);
    for count in [1, 2, 5, 7, 13, 20, 31, 50] {
        let parts = even(&mesh, count);
        let sizes = sizes(&parts);
        let (least, most) = (*sizes.iter().min().unwrap(), *sizes.iter().max().unwrap());
        assert_eq!(sizes.len(), count);
        assert!(most <= 3 * least, "{count} parts: {least} to {most} tetrahedra");
        Decomposition::from_parts(&mesh, &parts).expect("connected parts");
    }
}

#[test]
fn no_part_reaches_into_another_body_or_group() {
    let one = brick([6, 2, 2]);
    let far = one.map_points(|p| [p[0] + 10.0, p[1], p[2]]).expect("moved");
    let mesh = one.append(&far).expect("two bodies");
    let half: Vec<u32> = (0..mesh.tets().len())
        .map(|tet| u32::from(mesh.tet_points(tet).iter().map(|p| p[2]).sum::<f64>() > 2.0))
        .collect();
    for count in [1, 4, 9, 30] {
        let parts = even_parts(&mesh, &half, PartCount::Exactly(count)).expect("parts");
        let bodies = mesh.components();
        let mut seen = vec![None; sizes(&parts).len()];
        for (tet, &part) in parts.iter().enumerate() {
            let own = (bodies[tet], half[tet]);
            assert_eq!(*seen[part as usize].get_or_insert(own), own);
        }
        assert!(
            seen.len() >= 4 && seen.len().abs_diff(count.max(4)) <= 2,
            "{} for {count}",
            seen.len()
        );
        Decomposition::from_parts(&mesh, &parts).expect("connected parts");
    }
}

#[test]
fn more_parts_than_tetrahedra_are_as_many_as_there_are() {
    let mesh = brick([1, 1, 1]);
    let tets = mesh.tets().len();
    assert_eq!(sizes(&even(&mesh, 1000)), vec![1; tets]);
}

#[test]
fn bad_input_is_refused() {
    let mesh = brick([2, 1, 1]);
    let labels = vec![0; mesh.tets().len()];
    assert_eq!(
        even_parts(&mesh, &labels, PartCount::About(0)),
        Err(DecompositionError::NoParts)
    );
    let short = even_parts(&mesh, &labels[1..], PartCount::Exactly(2));
    assert!(matches!(short, Err(DecompositionError::PartCount { .. })));
}

/// Cells graded along all axes are told from those that are so along one, and from equal ones.
#[test]
fn strong_grading_is_along_all_axes() {
    let graded = |powers: [f64; 3]| {
        let mesh = Brick::new([1.0; 3], [8; 3]).build().expect("brick");
        let mesh = mesh
            .map_points(|p| [0, 1, 2].map(|d| p[d].powf(powers[d])))
            .expect("graded");
        signorini_fem_mesh::decomposition::is_strongly_graded(&mesh)
    };
    assert!(!graded([1.0; 3]) && !graded([3.0, 1.0, 1.0]) && graded([3.0; 3]));
}

/// Where a body is cut does not depend on others.
#[test]
fn bodies_are_cut_as_if_alone() {
    let plain = brick([18, 6, 6]);
    let flat = plain.map_points(|[x, y, z]| [x, y, 0.05 * z - 1.0]).expect("flat");
    let graded = plain
        .map_points(|[x, y, z]| [x * x, y * y, z * z + 2.0])
        .expect("graded");
    for (first, second) in [(&plain, &flat), (&graded, &flat)] {
        for oblique in [false, true] {
            let both = first.append(second).expect("two");
            let place = |mesh: &TetMesh| if oblique { mesh.map_points(turned).expect("turned") } else { mesh.clone() };
            for count in [5, 7] {
                let (both, alone) = (even(&place(&both), 2 * count), even(&place(first), count));
                assert!(both[..alone.len()] == alone, "{oblique} {count}");
            }
        }
    }
}
