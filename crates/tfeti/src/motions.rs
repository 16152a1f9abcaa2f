//! Rigid motions of whole panels: the two products between boundary vectors and rigid amplitudes.

use crate::boundary::BoundaryMap;
use crate::cost::PANEL;
use crate::kernel::Kernel;

/// `R^T` times the forces of a panel: six amplitudes for each column.
pub(crate) fn amplitudes_of_forces(
    kernel: &Kernel,
    nodes: &[u32],
    forces: &[f64],
    out: &mut [f64],
) {
    let width = out.len() / 6;
    let mut wrench = [[0.0; PANEL]; 6];
    for (&node, f) in nodes.iter().zip(forces.chunks_exact(3 * width)) {
        let [x, y, z] = *kernel.arm(node as usize);
        let (fx, rest) = f.split_at(width);
        let (fy, fz) = rest.split_at(width);
        let [w0, w1, w2, w3, w4, w5] = &mut wrench;
        for m in 0..width {
            w0[m] += fx[m];
            w1[m] += fy[m];
            w2[m] += fz[m];
            w3[m] += y * fz[m] - z * fy[m];
            w4[m] += z * fx[m] - x * fz[m];
            w5[m] += x * fy[m] - y * fx[m];
        }
    }
    for (m, target) in out.chunks_exact_mut(6).enumerate() {
        target.copy_from_slice(&kernel.project_wrench(&std::array::from_fn(|k| wrench[k][m])));
    }
}

/// `R alpha` on the boundary nodes of a panel.
pub(crate) fn motions_of_amplitudes(
    kernel: &Kernel,
    nodes: &[u32],
    alpha: &[f64],
    out: &mut [f64],
) {
    let width = alpha.len() / 6;
    let mut motion = [[0.0; PANEL]; 6];
    for (m, amplitudes) in alpha.chunks_exact(6).enumerate() {
        for (k, value) in kernel.motion(amplitudes).into_iter().enumerate() {
            motion[k][m] = value;
        }
    }
    let [tx, ty, tz, wx, wy, wz] = &motion;
    for (&node, u) in nodes.iter().zip(out.chunks_exact_mut(3 * width)) {
        let [x, y, z] = *kernel.arm(node as usize);
        let (ux, rest) = u.split_at_mut(width);
        let (uy, uz) = rest.split_at_mut(width);
        for m in 0..width {
            ux[m] = tx[m] + wy[m] * z - wz[m] * y;
            uy[m] = ty[m] + wz[m] * x - wx[m] * z;
            uz[m] = tz[m] + wx[m] * y - wy[m] * x;
        }
    }
}

/// Copies amplitudes in the order of columns into the order of subdomains, or back.
pub(crate) fn to_subdomains(map: &BoundaryMap, columns: &[f64], subdomains: &mut [f64]) {
    for (&column, target) in map.column_of.iter().zip(subdomains.chunks_exact_mut(6)) {
        target.copy_from_slice(&columns[6 * column as usize..][..6]);
    }
}

/// The inverse of [`to_subdomains`].
pub(crate) fn to_columns(map: &BoundaryMap, subdomains: &[f64], columns: &mut [f64]) {
    for (&column, source) in map.column_of.iter().zip(subdomains.chunks_exact(6)) {
        columns[6 * column as usize..][..6].copy_from_slice(source);
    }
}
