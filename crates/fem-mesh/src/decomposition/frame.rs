//! The directions along which a body is cut.

use crate::mesh::{TetMesh, extent};
use crate::tolerances::{FILLED, OBLIQUE, ONE_FACE, SAME_PLACE};
use crate::vec3::{self, Vec3};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use std::collections::BTreeMap;

/// Axes of a body that lies obliquely in space, so that it is cut as if it lay along those of coordinates.
pub(super) struct Frame {
    axes: [Vec3; 3],
    /// Coordinates are multiples of this power of two: those of a layer of nodes are equal.
    unit: f64,
}

impl Frame {
    /// The frame of a group of tetrahedra: that of its plane faces or of its moments of inertia, whichever has the
    /// smaller box around it. `None` if the box along the axes of coordinates is hardly larger.
    pub(super) fn new(mesh: &TetMesh, groups: &[u32], tets: &[u32]) -> Option<Self> {
        let edges = |axes: &[Vec3; 3]| {
            let points = tets.iter().flat_map(|&tet| mesh.tet_points(tet as usize));
            let (low, high) = extent(points.map(|p| axes.map(|axis| vec3::dot(axis, p))));
            vec3::sub(high, low)
        };
        let size = |edges: &Vec3| edges.iter().product::<f64>();
        let plain = size(&edges(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]));
        let volume: f64 = tets.iter().map(|&tet| mesh.volume(tet as usize)).sum();
        if volume >= FILLED * plain {
            return None;
        }
        let [by_faces, by_inertia] = [faces(mesh, groups, tets), inertia(mesh, tets)].map(|axes| (edges(&axes), axes));
        let (edges, axes) = if size(&by_faces.0) <= size(&by_inertia.0) { by_faces } else { by_inertia };
        let longest = edges.into_iter().fold(0.0, f64::max);
        (size(&edges) < OBLIQUE * plain).then(|| Self {
            axes,
            unit: (SAME_PLACE * longest).log2().ceil().exp2(),
        })
    }

    /// Coordinates of a place along the axes.
    pub(super) fn place(&self, p: Vec3) -> Vec3 {
        self.axes
            .map(|axis| (vec3::dot(axis, p) / self.unit).round() * self.unit)
    }
}

/// Normals of the plane faces with most area.
fn faces(mesh: &TetMesh, groups: &[u32], tets: &[u32]) -> [Vec3; 3] {
    let mut areas: BTreeMap<[i64; 3], (f64, Vec3)> = BTreeMap::new();
    for tet in tets.iter().map(|&tet| tet as usize) {
        let corners = mesh.tet_points(tet);
        for (face, other) in mesh.neighbours(tet).into_iter().enumerate() {
            if other.is_none_or(|other| groups[other] != groups[tet]) {
                let vector = vec3::area_vector(&[1, 2, 3].map(|k| corners[(face + k) % 4]));
                let area = vec3::norm(vector);
                let normal = vec3::scale(area.recip(), vector);
                let key = normal.map(|n| (n / ONE_FACE).round() as i64);
                // both sides of a plate are one face
                let turned = key.map(|k| -k);
                let (key, normal) = if turned > key { (turned, vec3::scale(-1.0, normal)) } else { (key, normal) };
                areas.entry(key).or_insert((0.0, normal)).0 += area;
            }
        }
    }
    let most = |of: &dyn Fn(Vec3) -> f64| {
        let largest = areas.values().map(|(area, normal)| (area * of(*normal), *normal));
        largest
            .fold(
                (0.0, [0.0; 3]),
                |best, found| if found.0 > best.0 { found } else { best },
            )
            .1
    };
    let first = most(&|_| 1.0);
    let across = |normal| 1.0 - vec3::dot(first, normal).powi(2);
    let second = most(&across);
    let second = vec3::unit(vec3::sub(second, vec3::scale(vec3::dot(first, second), first)));
    [first, second, vec3::cross(first, second)]
}

/// Axes of the moments of inertia of centres.
fn inertia(mesh: &TetMesh, tets: &[u32]) -> [Vec3; 3] {
    let centres = || {
        let parts = tets.iter().map(|&tet| tet as usize);
        parts.map(|tet| (mesh.volume(tet), Vector3::from(vec3::centroid(&mesh.tet_points(tet)))))
    };
    let (volume, first) = centres().fold((0.0, Vector3::zeros()), |(v, m), (w, c)| (v + w, m + c * w));
    let middle = first / volume;
    let second: Matrix3<f64> = centres()
        .map(|(w, c)| (c - middle) * (c - middle).transpose() * w)
        .sum();
    let axes = SymmetricEigen::new(second).eigenvectors;
    [0, 1, 2].map(|k| axes.column(k).into_owned().into())
}
