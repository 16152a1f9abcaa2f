//! Rows that hold motions of rigid subdomains.

use super::gluing::CopyEntry;
use crate::error::TfetiError;
use crate::tolerances::{CASES, ON_A_LINE, RIGID, UNIT};
use nalgebra::{SMatrix, SVector};
use signorini_fem_mesh::vec3::{Vec3, add, cross, dot, far_apart, norm, sub};
use signorini_fem_mesh::{Decomposition, TetMesh};

/// A motion of a [rigid subdomain](Decomposition::with_rigid) that is held: the displacement of a point, which need not
/// be one of its nodes, or a rotation.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidSupport {
    /// Number of the subdomain.
    pub subdomain: u32,
    /// The point, m.
    pub point: [f64; 3],
    /// A unit vector along its displacement, or, as the second, the axis of a rotation; the other one is zero.
    pub direction: [[f64; 3]; 2],
    /// Prescribed values by displacement case, m or radians; zero in others.
    pub values: Vec<(u32, f64)>,
}

/// Its row.
#[derive(Debug)]
pub(crate) struct RigidRow {
    pub(super) entries: Vec<CopyEntry>,
    /// A mesh node of the subdomain.
    pub(super) node: u32,
    /// The row is `scale` times the motion.
    pub(super) scale: f64,
    pub(super) values: Vec<(u32, f64)>,
}

/// Forces at three of some points, far from one another, with this force at a place and this moment: the smallest
/// ones. `None` if all points lie on a line.
pub fn forces_at_three(points: &[Vec3], place: Vec3, force: Vec3, moment: Vec3) -> Option<[(usize, Vec3); 3]> {
    let (chosen, _) = far_apart(points).filter(|far| far.1 > ON_A_LINE)?;
    let about = points[chosen[0]];
    let arms = chosen.map(|k| sub(points[k], about));
    let size = arms.iter().map(|arm| norm(*arm)).fold(0.0, f64::max);
    let moment = add(moment, cross(sub(place, about), force));
    let target: SVector<f64, 6> = SVector::from_fn(|k, _| match k {
        0..3 => force[k],
        _ => moment[k - 3] / size,
    });
    let wrenches: SMatrix<f64, 6, 9> = SMatrix::from_fn(|row, column| {
        let unit: Vec3 = [0, 1, 2].map(|c| f64::from(u8::from(c == column % 3)));
        match row {
            0..3 => unit[row],
            _ => cross(arms[column / 3], unit)[row - 3] / size,
        }
    });
    let gram = (wrenches * wrenches.transpose()).cholesky()?;
    let forces = wrenches.transpose() * gram.solve(&target);
    Some([0, 1, 2].map(|k| (chosen[k], [0, 1, 2].map(|c| forces[3 * k + c]))))
}

impl RigidSupport {
    /// A row at three nodes of the subdomain, long, so that it takes what the others of the subdomain leave.
    pub(crate) fn row(&self, mesh: &TetMesh, decomposition: &Decomposition) -> Result<RigidRow, TfetiError> {
        let subdomain = self.subdomain as usize;
        let own = decomposition.subdomains().get(subdomain).filter(|s| s.is_rigid());
        let own = own.ok_or(TfetiError::RigidSupport { subdomain })?;
        let [force, moment] = self.direction;
        let forces = forces_at_three(&own.points(mesh), self.point, force, moment);
        let forces = forces.ok_or(TfetiError::Collinear { subdomain })?;
        let square: f64 = forces.iter().map(|(_, f)| dot(*f, *f)).sum();
        let scale = (RIGID / square).sqrt();
        let good = |v: &(u32, f64)| v.0 < CASES && v.1.is_finite();
        // one is a unit vector, the other one zero
        let sizes = (norm(force) - 1.0).abs().min((norm(moment) - 1.0).abs());
        let one = sizes <= UNIT && (force == [0.0; 3] || moment == [0.0; 3]);
        if !(one && self.values.iter().all(good) && scale.is_finite() && scale > 0.0) {
            return Err(TfetiError::RigidSupport { subdomain });
        }
        let entry = |(local, force): (usize, Vec3)| CopyEntry {
            subdomain: self.subdomain,
            local: local as u32,
            vector: force.map(|f| scale * f),
        };
        Ok(RigidRow {
            entries: forces.map(entry).to_vec(),
            node: own.nodes[forces[0].0],
            scale,
            values: self.values.clone(),
        })
    }
}
