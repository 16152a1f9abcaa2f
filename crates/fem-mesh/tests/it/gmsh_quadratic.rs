//! Gmsh files of order 2.

use signorini_fem_mesh::FacetTag;
use signorini_fem_mesh::gmsh::{GmshError, parse_gmsh};

/// A mesh of order 2 as Gmsh writes it: lines, triangles and tetrahedra with their mid-nodes, the last two of a
/// tetrahedron swapped.
fn quadratic_text(mesh: &signorini_fem_mesh::TetMesh, groups: bool) -> String {
    let group = if groups { "1 3" } else { "0" };
    let volume = if groups { "1 7" } else { "0" };
    let mut text = format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 1\n1 0 0 0 1 1 1 {group} 0\n\
         1 0 0 0 1 1 1 {volume} 0\n$EndEntities\n$Nodes\n1 {n} 1 {n}\n3 1 0 {n}\n",
        n = mesh.points().len()
    );
    (1..=mesh.points().len()).for_each(|n| text += &format!("{n}\n"));
    mesh.points()
        .iter()
        .for_each(|[x, y, z]| text += &format!("{x} {y} {z}\n"));
    let (facets, tets) = (mesh.facets(), mesh.quadratic_tets());
    let count = 1 + facets.len() + tets.len();
    text += &format!(
        "$EndNodes\n$Elements\n3 {count} 1 {count}\n1 1 8 1\n1 1 2 3\n2 1 9 {}\n",
        facets.len()
    );
    let mut number = 1;
    for (k, facet) in facets.iter().enumerate() {
        number += 1;
        text += &number.to_string();
        for node in facet.nodes.into_iter().chain(mesh.facet_mids(k).unwrap()) {
            text += &format!(" {}", node + 1);
        }
        text += "\n";
    }
    text += &format!("3 1 11 {}\n", tets.len());
    for mut tet in tets {
        number += 1;
        tet.swap(8, 9);
        text += &number.to_string();
        tet.iter().for_each(|node| text += &format!(" {}", node + 1));
        text += "\n";
    }
    text + "$EndElements\n"
}

#[test]
fn elements_of_second_order_keep_their_nodes() {
    use signorini_fem_mesh::brick::{Brick, SIDES};
    let straight = Brick::new([1.0; 3], [2, 1, 1]).build().unwrap().raise_order().unwrap();
    let mesh = straight.map_points(|[x, y, z]| [x, y + 0.1 * x * x, z]).unwrap();
    for groups in [true, false] {
        let read = parse_gmsh(quadratic_text(&mesh, groups).as_bytes()).unwrap().0;
        assert_eq!(read.points(), mesh.points());
        assert_eq!(read.quadratic_tets(), mesh.quadratic_tets());
        assert_eq!(
            read.facets().len(),
            SIDES
                .iter()
                .flatten()
                .map(|&t| mesh.facets().iter().filter(|f| f.tag == t).count())
                .sum()
        );
        assert_eq!(read.tags(), [FacetTag(if groups { 3 } else { 1 })]);
    }
    let text = quadratic_text(&mesh, true);
    let count = mesh.tets().len();
    let linear = text.replace(&format!("3 1 11 {count}"), &format!("3 1 11 {}", count - 1));
    let last = linear.trim_end().rsplit('\n').nth(1).unwrap().to_owned();
    let corners: Vec<&str> = last.split(' ').take(5).collect();
    let mixed = linear
        .replace(&last, &format!("3 1 4 1\n{}", corners.join(" ")))
        .replacen("$Elements\n3", "$Elements\n4", 1);
    match parse_gmsh(mixed.as_bytes()) {
        Err(GmshError::MixedOrder { linear: 1, quadratic }) => assert_eq!(quadratic + 1, count),
        other => panic!("{other:?}"),
    }
}
