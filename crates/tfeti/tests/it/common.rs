//! The brick of the benchmark, for the tests.

use signorini_fem_mesh::{Decomposition, Hooke, LoadDensity, Materials, SurfaceFrame, TetMesh, assemble_load, brick};
use signorini_qp::SymmetricOperator;
use signorini_tfeti::internal::InverseKind;
use signorini_tfeti::{ContactConstraint, Gluing, InverseSettings, NodeSupport, Tfeti, TfetiBuilder, TfetiError};

pub(crate) struct Brick {
    pub(crate) mesh: TetMesh,
    pub(crate) decomposition: Decomposition,
    pub(crate) materials: Materials,
    pub(crate) fixed: Vec<u32>,
    pub(crate) bottom: Vec<u32>,
    pub(crate) frames: Vec<SurfaceFrame>,
}

pub(crate) fn steel() -> Materials {
    Materials::uniform(Hooke::isotropic(211.9e9, 0.277).unwrap())
}

impl Brick {
    /// `3n x n x n` subdomains of `cells^3` cubes.
    pub(crate) fn new(n: usize, cells: usize) -> Self {
        Self::of(n, cells, 0.0)
    }

    pub(crate) fn of(n: usize, cells: usize, perturbation: f64) -> Self {
        let mut builder = brick::Brick::new([3.0, 1.0, 1.0], [3 * n * cells, n * cells, n * cells]);
        if perturbation > 0.0 {
            builder = builder.perturbed(perturbation, 7);
        }
        let mesh = builder.build().unwrap();
        let decomposition = Decomposition::boxes(&mesh, [3 * n, n, n]).unwrap();
        let fixed = mesh.nodes_on(brick::X_MIN);
        let bottom = mesh.nodes_on(brick::Z_MIN);
        let frame = SurfaceFrame {
            normal: [0.0, 0.0, -1.0],
            tangents: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        };
        let frames = vec![frame; bottom.len()];
        Self {
            mesh,
            decomposition,
            materials: steel(),
            fixed,
            bottom,
            frames,
        }
    }

    /// A system of this body, still without contact.
    pub(crate) fn builder<'a>(&'a self, supports: &'a [NodeSupport]) -> TfetiBuilder<'a> {
        TfetiBuilder::new(&self.mesh, &self.decomposition, &self.materials).with_supports(supports)
    }

    /// The body with its supports and frictional contact.
    pub(crate) fn system(&self) -> Tfeti {
        build(self, InverseKind::Auto, true)
    }

    pub(crate) fn supports(&self) -> Vec<NodeSupport> {
        vec![NodeSupport::fixed(self.fixed.clone())]
    }

    pub(crate) fn contact(&self, friction: bool) -> Vec<ContactConstraint> {
        rigid(&self.bottom, &self.frames, friction)
    }

    pub(crate) fn loads(&self) -> Vec<Vec<f64>> {
        let top = LoadDensity::Traction(brick::Z_MAX, [0.0, 0.0, -3.0e7]);
        let side = LoadDensity::Traction(brick::X_MAX, [9.0e6, 1.0e6, -1.5e7]);
        let mut loads = assemble_load(&self.mesh, &self.decomposition, &top).unwrap();
        let more = assemble_load(&self.mesh, &self.decomposition, &side).unwrap();
        for (a, b) in loads.iter_mut().zip(&more) {
            a.iter_mut().zip(b).for_each(|(x, y)| *x += y);
        }
        loads
    }
}

/// A reproducible vector without structure.
pub(crate) fn noise(n: usize, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    (0..n)
        .map(|_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
        })
        .collect()
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt()
}

/// The brick with its supports and frictional contact.
pub(crate) fn build(b: &Brick, kind: InverseKind, share_translates: bool) -> Tfeti {
    let (supports, contact) = (b.supports(), b.contact(true));
    b.builder(&supports)
        .with_contact(&contact)
        .with_share_translates(share_translates)
        .with_inverse(InverseSettings::default().with_kind(kind))
        .build()
        .unwrap()
}

/// `B` alone.
pub(crate) fn gluing(b: &Brick, supports: &[NodeSupport], contact: &[ContactConstraint]) -> Result<Gluing, TfetiError> {
    let system = b.builder(supports).with_contact(contact).build()?;
    Ok(system.gluing().clone())
}

/// Row `row` of `G^T`: what the rigid motions of each subdomain do to it.
pub(crate) fn column(system: &Tfeti, row: usize) -> Vec<(usize, [f64; 6])> {
    let of_entry = |(s, dof, value): (usize, usize, f64)| {
        let modes = system.kernel(s).node_modes(dof / 3)[dof % 3];
        (s, modes.map(|m| value * m))
    };
    system.gluing().row(row).into_iter().map(of_entry).collect()
}

/// Dense `B B^T` of all rows.
pub(crate) fn gram(g: &Gluing) -> Vec<Vec<f64>> {
    let rows: Vec<std::collections::BTreeMap<(usize, usize), f64>> = (0..g.ranges().total())
        .map(|r| {
            let mut map = std::collections::BTreeMap::new();
            g.row(r)
                .into_iter()
                .for_each(|(s, d, v)| *map.entry((s, d)).or_insert(0.0) += v);
            map
        })
        .collect();
    rows.iter()
        .map(|a| {
            rows.iter()
                .map(|b| a.iter().filter_map(|(k, v)| b.get(k).map(|w| v * w)).sum())
                .collect()
        })
        .collect()
}

/// `F x`.
pub(crate) fn product(system: &Tfeti, x: &[f64]) -> Vec<f64> {
    let f = system.dual();
    let mut y = vec![0.0; f.dim()];
    f.apply(x, &mut y, &mut f.scratch());
    y
}

/// Smallest eigenvalue of a dense symmetric matrix.
pub(crate) fn smallest_eigenvalue(gram: &[Vec<f64>]) -> f64 {
    let n = gram.len();
    let matrix = nalgebra::DMatrix::from_fn(n, n, |i, j| gram[i][j]);
    nalgebra::SymmetricEigen::new(matrix).eigenvalues.min()
}

/// Points against a rigid obstacle, one frame a node.
pub(crate) fn rigid(nodes: &[u32], frames: &[SurfaceFrame], friction: bool) -> Vec<ContactConstraint> {
    let point = |(&node, frame): (&u32, &SurfaceFrame)| ContactConstraint::new(node, *frame).with_friction(friction);
    nodes.iter().zip(frames).map(point).collect()
}

/// Whether `B B^T` is the identity.
pub(crate) fn is_orthonormal(g: &Gluing) -> bool {
    let gram = gram(g);
    let expected = |i, j| f64::from(u8::from(i == j));
    (0..gram.len()).all(|i| (0..gram.len()).all(|j| (gram[i][j] - expected(i, j)).abs() < 1e-12))
}
