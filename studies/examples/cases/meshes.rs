//! Graded meshes.

use super::Failure;
use signorini::fem_mesh::mesh::{drop_unused_nodes, merge_nodes, orient_tets};
use signorini::prelude::*;
use std::f64::consts::TAU;

/// The sum of the first `count` cells of a geometric series that starts with `first` and has `all` cells in `length`.
pub fn series(first: f64, all: usize, length: f64) -> impl Fn(f64) -> f64 + Copy {
    let sum = move |q: f64, k: f64| first * (q.powf(k) - 1.0) / (q - 1.0);
    let (mut low, mut high) = (1.0 + 1e-9, 10.0);
    for _ in 0..60 {
        let q = 0.5 * (low + high);
        if sum(q, all as f64) < length {
            low = q;
        } else {
            high = q;
        }
    }
    move |count| sum(low, count)
}

/// Places of so many cells of one size, then so many in a geometric series.
pub fn graded([part, whole]: [f64; 2], [near, far]: [usize; 2]) -> impl Fn(f64) -> f64 + Copy {
    let first = part / near as f64;
    let beyond = series(first, far + 1, whole - part + first);
    move |k| {
        let over = k - near as f64;
        if over > 0.0 { part - first + beyond(over + 1.0) } else { k * first }
    }
}

/// A slice of a body of revolution about z, `angle` radians wide and a cell thick: `grid[i][j]` are the radius and z of
/// its nodes, the radius 0 for the first `i`. Tags are those of a brick along radius, angle and z.
pub fn slice(grid: &[Vec<[f64; 2]>], angle: f64) -> Result<TetMesh, Failure> {
    let rows = grid[0].len();
    let node = |i: usize, j: usize, k: usize| match i {
        0 => j as u32,
        _ => (rows + 2 * ((i - 1) * rows + j) + k) as u32,
    };
    let axis = grid[0].iter().map(|[_, z]| [0.0, 0.0, *z]);
    let beside = grid[1..].iter().flatten().flat_map(|[r, z]| {
        let (sin, cos) = angle.sin_cos();
        [[*r, 0.0, *z], [r * cos, r * sin, *z]]
    });
    let points: Vec<[f64; 3]> = axis.chain(beside).collect();
    let mut tets = Vec::new();
    for i in 0..grid.len() - 1 {
        for j in 0..rows - 1 {
            for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
                let mut at = [i, j, 0];
                let mut tet = [node(i, j, 0); 4];
                for (step, axis) in order.into_iter().enumerate() {
                    at[axis] += 1;
                    tet[step + 1] = node(at[0], at[1], at[2]);
                }
                // nothing is left of some at the axis
                if tet.windows(2).all(|pair| pair[0] != pair[1]) {
                    tets.push(tet);
                }
            }
        }
    }
    orient_tets(&points, &mut tets);
    let mesh = TetMesh::new(points, tets, Vec::new())?;
    Ok(mesh.tag_boundary(|_, [x, y, z]| {
        let across = |angle: f64| y * angle.cos() - x * angle.sin();
        Some(match (across(0.0), across(angle), z) {
            (y, ..) if y < -0.999 => brick::Y_MIN,
            (_, y, _) if y > 0.999 => brick::Y_MAX,
            (.., z) if z < -0.8 => brick::Z_MIN,
            (.., z) if z > 0.8 => brick::Z_MAX,
            _ => brick::X_MAX,
        })
    }))
}

/// Supports of a slice: it stays between its planes.
pub fn symmetric(scene: Scene, angle: f64, tags: impl Fn(FacetTag) -> FacetTag) -> Scene {
    let normal = [-angle.sin(), angle.cos(), 0.0];
    scene
        .with_support(Support::components(tags(brick::Y_MIN), [false, true, false]))
        .with_support(Support::partial(tags(brick::Y_MAX), Directions::Vectors(vec![normal])))
}

/// A whole tube of quadratic elements about z: x of the brick is the radius, y goes round, and both ends are one.
pub fn ring([inner, outer]: [f64; 2], width: f64, cells: [usize; 3]) -> Result<TetMesh, Failure> {
    let brick = Brick::new([outer - inner, TAU, width], cells).build()?.raise_order()?;
    let round = |[x, y, z]: &[f64; 3]| [(inner + x) * y.cos(), (inner + x) * y.sin(), *z];
    let mut points: Vec<[f64; 3]> = brick.points().iter().map(round).collect();
    let open = |f: &&Facet| f.tag != brick::Y_MIN && f.tag != brick::Y_MAX;
    let mut facets: Vec<Facet> = brick.facets().iter().filter(open).copied().collect();
    let mut tets = brick.quadratic_tets();
    merge_nodes(&points, &mut tets, &mut facets, 1e-9 * outer);
    drop_unused_nodes(&mut points, &mut tets, &mut facets);
    Ok(TetMesh::quadratic(points, tets, facets)?)
}
