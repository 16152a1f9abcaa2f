//! Strain, stress and energy of a displacement of the mesh.

use crate::element::{Piece, over_quadratic};
use crate::material::{Hooke, MaterialError, Materials};
use crate::mesh::{NODES, TetMesh};
use crate::quadrature::FOUR_POINTS;
use nalgebra::Matrix3;
use rayon::prelude::*;

errors! {
    /// A field that cannot be evaluated.
    #[derive(Clone, PartialEq)]
    FieldError from { Material(MaterialError) } {
        Length { what: &'static str, given: usize, expected: usize } =
            "the {what} has {given} entries; the mesh needs {expected}";
        NotFinite { node: usize, value: [f64; 3] } =
            "the displacement of node {node} is {value:?}; it must be finite, so look at the solver that computed it";
        Target { value: f64 } = "the error that is wanted, relative to the displacement, is {value}; it must be positive, as 0.05";
    }
}

const CENTROID: [f64; 4] = [0.25; 4];

/// Checks the length of a table.
pub(crate) fn expect_entries(what: &'static str, given: usize, expected: usize) -> Result<(), FieldError> {
    if given == expected {
        return Ok(());
    }
    Err(FieldError::Length { what, given, expected })
}

/// The displacement of each node as a vector.
pub(crate) fn nodal_vectors(mesh: &TetMesh, u: &[f64]) -> Result<Vec<[f64; 3]>, FieldError> {
    expect_entries("displacement", u.len(), 3 * mesh.points().len())?;
    let vectors: Vec<_> = u.chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect();
    match vectors.iter().position(|v| v.iter().any(|x| !x.is_finite())) {
        Some(node) => Err(FieldError::NotFinite {
            node,
            value: vectors[node],
        }),
        None => Ok(vectors),
    }
}

/// Strain of each tetrahedron, of a quadratic one at its centroid.
///
/// # Errors
/// [`FieldError`] if the displacement has the wrong length or is not finite.
pub fn strains(mesh: &TetMesh, u: &[f64]) -> Result<Vec<[f64; 6]>, FieldError> {
    let u = nodal_vectors(mesh, u)?;
    let strain = |tet: usize| Piece::new(mesh, tet, &u).strain(&CENTROID);
    Ok((0..mesh.tets().len()).into_par_iter().map(strain).collect())
}

/// Strain of a displacement that makes stress in a tetrahedron, at barycentric coordinates.
fn elastic(
    mesh: &TetMesh,
    materials: &Materials,
    law: &Hooke,
    (tet, piece): (usize, &Piece),
    l: &[f64; 4],
) -> [f64; 6] {
    let place = (mesh.regions()[tet], &mesh.tets()[tet]);
    materials.elastic(law, place, l, &piece.strain(l))
}

/// Stress of each tetrahedron, of a quadratic one at its centroid.
///
/// # Errors
/// [`FieldError`] as [`strains`], and if a region has no material.
pub fn stresses(mesh: &TetMesh, materials: &Materials, u: &[f64]) -> Result<Vec<[f64; 6]>, FieldError> {
    let laws = materials.of_tets(mesh.regions())?;
    let u = nodal_vectors(mesh, u)?;
    let stress = |(tet, law): (usize, &&Hooke)| {
        let piece = Piece::new(mesh, tet, &u).with_law(law);
        law.stress(&elastic(mesh, materials, law, (tet, &piece), &CENTROID))
    };
    Ok(laws.par_iter().enumerate().map(stress).collect())
}

/// Elastic energy, half of stress times elastic strain, integrated over the mesh: without eigenstrain that of
/// the stiffness matrix.
///
/// # Errors
/// [`FieldError`] as [`stresses`].
pub fn strain_energy(mesh: &TetMesh, materials: &Materials, u: &[f64]) -> Result<f64, FieldError> {
    let laws = materials.of_tets(mesh.regions())?;
    let u = nodal_vectors(mesh, u)?;
    let rule = FOUR_POINTS.map(|l| (l, 0.25));
    let energy = |tet: usize| {
        let piece = Piece::new(mesh, tet, &u).with_law(laws[tet]);
        let density = |l: &[f64; 4]| laws[tet].energy_density(&elastic(mesh, materials, laws[tet], (tet, &piece), l));
        match mesh.order() {
            1 => mesh.volume(tet) * density(&CENTROID),
            _ => over_quadratic(mesh, tet, &rule, density),
        }
    };
    let energies: Vec<f64> = (0..mesh.tets().len()).into_par_iter().map(energy).collect();
    Ok(energies.iter().sum())
}

/// The von Mises stress sqrt(3/2 s : s), with s the stress deviator.
pub fn von_mises(stress: &[f64; 6]) -> f64 {
    let [xx, yy, zz, yz, xz, xy] = *stress;
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * normal + 3.0 * (yz * yz + xz * xz + xy * xy)).sqrt()
}

/// The principal stresses, the largest first; NaN where the stress is not finite.
pub fn principal(stress: &[f64; 6]) -> [f64; 3] {
    // the iteration would not end
    if !stress.iter().all(|s| s.is_finite()) {
        return [f64::NAN; 3];
    }
    let [xx, yy, zz, yz, xz, xy] = *stress;
    let mut values: [f64; 3] = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
        .symmetric_eigenvalues()
        .into();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// Stress at the nodes: the mean of what it is there in the tetrahedra around each, weighted by volume. Where two
/// materials meet the mean blurs the jump of the stress.
///
/// # Errors
/// [`FieldError`] as [`stresses`].
pub fn nodal_stresses(mesh: &TetMesh, materials: &Materials, u: &[f64]) -> Result<Vec<[f64; 6]>, FieldError> {
    let laws = materials.of_tets(mesh.regions())?;
    if mesh.order() == 1 {
        return nodal_average(mesh, &stresses(mesh, materials, u)?);
    }
    let u = nodal_vectors(mesh, u)?;
    let at_nodes = |tet: usize| {
        let piece = Piece::new(mesh, tet, &u).with_law(laws[tet]);
        NODES.map(|l| laws[tet].stress(&elastic(mesh, materials, laws[tet], (tet, &piece), &l)))
    };
    let values: Vec<[[f64; 6]; 10]> = (0..mesh.tets().len()).into_par_iter().map(at_nodes).collect();
    Ok(average(mesh, |tet, k| values[tet][k]))
}

/// Recovers values at the nodes as the mean of the tetrahedra around each, weighted by volume.
/// Where two materials meet the mean blurs the jump of the stress.
///
/// # Errors
/// [`FieldError::Length`] unless there is one value for each tetrahedron.
pub fn nodal_average<const N: usize>(mesh: &TetMesh, values: &[[f64; N]]) -> Result<Vec<[f64; N]>, FieldError> {
    expect_entries("table of tetrahedra", values.len(), mesh.tets().len())?;
    Ok(average(mesh, |tet, _| values[tet]))
}

/// Mean of the values of each node number in the tetrahedra around each node.
fn average<const N: usize>(mesh: &TetMesh, value: impl Fn(usize, usize) -> [f64; N]) -> Vec<[f64; N]> {
    let mut sums = vec![[0.0; N]; mesh.points().len()];
    let mut volumes = vec![0.0; mesh.points().len()];
    for (tet, corners) in mesh.tets().iter().enumerate() {
        let volume = mesh.volume(tet);
        let mids = mesh.mids().get(tet).map_or(&[][..], |mids| mids);
        for (k, &node) in corners.iter().chain(mids).enumerate() {
            volumes[node as usize] += volume;
            let (sum, value) = (&mut sums[node as usize], value(tet, k));
            (0..N).for_each(|i| sum[i] += volume * value[i]);
        }
    }
    sums.iter()
        .zip(&volumes)
        .map(|(sum, volume)| sum.map(|s| s / volume))
        .collect()
}
