//! Hooke's law with a general elasticity tensor.

use crate::tolerances::{ASYMMETRY, ELLIPTICITY, INCOMPRESSIBLE};
use crate::vec3::skewed;
use nalgebra::SMatrix;

errors! {
    /// An elastic law that is not admissible.
    #[derive(Clone, PartialEq)]
    HookeError {
        Young(f64) = "Young's modulus is {0}; it must be positive and finite";
        Poisson(f64) =
            "Poisson's ratio is {0}; it must lie between -1 and 1/2, both excluded and not closer than about 1e-12 \
            (with linear elements bodies lock long before; raise_order)";
        NotFinite { row: usize, column: usize, value: f64 } =
            "entry ({row}, {column}) of the elasticity matrix is {value}; all entries must be finite";
        NotSymmetric { left: [usize; 4], left_value: f64, right: [usize; 4], right_value: f64 } =
            "c{left:?} = {left_value} but c{right:?} = {right_value}; (2.8) asks for c_ijkl = c_jikl = c_klij \
            (indices here from 0)";
        Axes { first: usize, second: usize, product: f64 } =
            "the axes {first} and {second} (from 0) of a material have the scalar product {product}; give unit vectors \
            at right angles";
        NotElliptic { smallest: f64, largest: f64 } =
            "the elasticity tensor is not elliptic: its smallest eigenvalue is {smallest:e}, its largest \
            {largest:e}; (2.8) asks for a positive one, so check signs and moduli";
    }
}

/// Hooke's law tau_ij = c_ijkl e_kl with the symmetries and the ellipticity of (2.8).
///
/// Stored as the 6 x 6 matrix that maps the strains (e_xx, e_yy, e_zz, 2 e_yz, 2 e_xz, 2 e_xy) to
/// the stresses in the same order (Voigt with engineering shear). Units: those of stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hooke {
    voigt: [[f64; 6]; 6],
    largest: f64,
    nearly_incompressible: bool,
}

impl Hooke {
    /// The isotropic law with Young's modulus and Poisson's ratio.
    ///
    /// # Errors
    /// [`HookeError::Young`] unless 0 < young, [`HookeError::Poisson`] unless -1 < poisson < 1/2,
    /// by more than about 1e-12.
    pub fn isotropic(young: f64, poisson: f64) -> Result<Self, HookeError> {
        if !(young > 0.0 && young.is_finite()) {
            return Err(HookeError::Young(young));
        }
        if !(poisson > -1.0 && poisson < 0.5) {
            return Err(HookeError::Poisson(poisson));
        }
        let shear = young / (2.0 * (1.0 + poisson));
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        let mut c = [[0.0; 6]; 6];
        for i in 0..3 {
            for j in 0..3 {
                c[i][j] = lambda;
            }
            c[i][i] += 2.0 * shear;
            c[3 + i][3 + i] = shear;
        }
        // The eigenvalues are 2 mu and 3 K; their ratio tells whether Poisson's ratio is to blame.
        let ratio = (1.0 - 2.0 * poisson) / (1.0 + poisson);
        let extreme = ratio.min(1.0 / ratio) < 2.0 * ELLIPTICITY;
        Self::from_voigt(&c).map_err(|error| if extreme { HookeError::Poisson(poisson) } else { error })
    }

    /// Poisson's ratio of an isotropic law, however it was given; `None` of another one.
    pub fn poisson(&self) -> Option<f64> {
        let (lambda, shear) = (self.voigt[0][1], self.voigt[3][3]);
        let expected = |i: usize, j: usize| match (i < 3 && j < 3, i == j) {
            (true, true) => lambda + 2.0 * shear,
            (true, false) => lambda,
            (false, true) => shear,
            (false, false) => 0.0,
        };
        let near = |(i, j): (usize, usize)| (self.voigt[i][j] - expected(i, j)).abs() <= ASYMMETRY * self.largest;
        let isotropic = (0..36).map(|k| (k / 6, k % 6)).all(near);
        isotropic.then(|| lambda / (2.0 * (lambda + shear)))
    }

    /// Whether Poisson's ratio is above 0.4: quadratic elements then take the mean of the volume strain of each
    /// element.
    pub fn is_nearly_incompressible(&self) -> bool {
        self.nearly_incompressible
    }

    /// Poisson's ratio where it is above 0.4 by more than rounding: a ratio of 0.4 is not, in whatever unit of stress.
    fn incompressible(&self) -> Option<f64> {
        self.poisson().filter(|p| *p > INCOMPRESSIBLE * (1.0 + ASYMMETRY))
    }

    /// The law with a Poisson's ratio of 0.4 and the same Young's modulus, of one that is nearly incompressible: for
    /// preconditioners.
    pub fn compressible(&self) -> Option<Self> {
        let poisson = self.incompressible()?;
        let young = 2.0 * self.voigt[3][3] * (1.0 + poisson);
        Self::isotropic(young, INCOMPRESSIBLE).ok()
    }

    /// A general law from its 6 x 6 matrix (Voigt order xx, yy, zz, yz, xz, xy with engineering
    /// shear): the entry of (xx, yz) is c_xxyz; see (2.8) for the conditions. Deviations from symmetry at rounding
    /// level are averaged away.
    ///
    /// # Errors
    /// [`HookeError`] if an entry is not finite, a symmetry is missing by more than 1e-9 of the
    /// largest entry, or the tensor is not elliptic.
    pub fn from_voigt(c: &[[f64; 6]; 6]) -> Result<Self, HookeError> {
        let mut scale: f64 = 0.0;
        for (row, entries) in c.iter().enumerate() {
            for (column, &value) in entries.iter().enumerate() {
                if !value.is_finite() {
                    return Err(HookeError::NotFinite { row, column, value });
                }
                scale = scale.max(value.abs());
            }
        }
        let mut voigt = *c;
        for i in 0..6 {
            for j in 0..i {
                if (c[i][j] - c[j][i]).abs() > ASYMMETRY * scale {
                    return Err(HookeError::NotSymmetric {
                        left: tensor_indices(i, j),
                        left_value: c[i][j],
                        right: tensor_indices(j, i),
                        right_value: c[j][i],
                    });
                }
                voigt[i][j] = 0.5 * (c[i][j] + c[j][i]);
                voigt[j][i] = voigt[i][j];
            }
        }
        let (smallest, largest) = eigenvalue_range(&voigt);
        if !(largest > 0.0 && smallest > ELLIPTICITY * largest) {
            return Err(HookeError::NotElliptic { smallest, largest });
        }
        let mut law = Self {
            voigt,
            largest,
            nearly_incompressible: false,
        };
        law.nearly_incompressible = law.incompressible().is_some();
        Ok(law)
    }

    /// The law of the same material with these unit vectors, at right angles, in place of the axes x, y and z.
    ///
    /// # Errors
    /// [`HookeError::Axes`] if they are no such vectors.
    pub fn rotated(&self, axes: [[f64; 3]; 3]) -> Result<Self, HookeError> {
        if let Some((first, second, product)) = skewed(axes, ASYMMETRY) {
            return Err(HookeError::Axes { first, second, product });
        }
        // strain along the axes from that along x, y, z
        let of = |row: usize, column: usize| {
            let ([i, j], [p, q]) = (PAIRS[row], PAIRS[column]);
            let (a, b) = (axes[i], axes[j]);
            let part = if p == q { a[p] * b[p] } else { 0.5 * (a[p] * b[q] + a[q] * b[p]) };
            if i == j { part } else { 2.0 * part }
        };
        let strain: [[f64; 6]; 6] = std::array::from_fn(|row| std::array::from_fn(|column| of(row, column)));
        let columns: [[f64; 6]; 6] = std::array::from_fn(|c| self.stress(&strain.map(|row| row[c])));
        let entry = |r: usize, c: usize| (0..6).map(|k| strain[k][r] * columns[c][k]).sum::<f64>();
        Self::from_voigt(&std::array::from_fn(|r| std::array::from_fn(|c| entry(r, c))))
    }

    /// The 6 x 6 matrix in Voigt order xx, yy, zz, yz, xz, xy with engineering shear.
    pub fn voigt(&self) -> &[[f64; 6]; 6] {
        &self.voigt
    }

    /// The smallest bound of c_ijkl x_ij x_kl / (x_ij x_ij). A scale of the stiffness of the material.
    pub fn bound(&self) -> f64 {
        self.largest
    }

    /// Stress of a strain, both in Voigt order, the strain with engineering shear.
    pub fn stress(&self, strain: &[f64; 6]) -> [f64; 6] {
        // column by column: symmetric, and all six sums side by side
        let mut stress = [0.0; 6];
        for (column, e) in self.voigt.iter().zip(strain) {
            stress = std::array::from_fn(|i| stress[i] + column[i] * e);
        }
        stress
    }

    /// Elastic energy per volume, half of stress times strain.
    pub fn energy_density(&self, strain: &[f64; 6]) -> f64 {
        let stress = self.stress(strain);
        0.5 * (0..6).map(|i| stress[i] * strain[i]).sum::<f64>()
    }
}

/// Tensor indices of an entry of the 6 x 6 matrix.
fn tensor_indices(row: usize, column: usize) -> [usize; 4] {
    let ([i, j], [k, l]) = (PAIRS[row], PAIRS[column]);
    [i, j, k, l]
}

/// Indices of the entries of strains and stresses.
const PAIRS: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [1, 2], [0, 2], [0, 1]];

/// Smallest and largest eigenvalue of the tensor on symmetric second-order tensors. The scaling
/// by sqrt(2) of the shear rows and columns makes the 6-vectors carry the tensor norm.
fn eigenvalue_range(voigt: &[[f64; 6]; 6]) -> (f64, f64) {
    let weight = |i: usize| if i < 3 { 1.0 } else { std::f64::consts::SQRT_2 };
    let matrix = SMatrix::<f64, 6, 6>::from_fn(|i, j| weight(i) * weight(j) * voigt[i][j]);
    let eigenvalues = matrix.symmetric_eigenvalues();
    (eigenvalues.min(), eigenvalues.max())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wood of which energies do not depend on the axes that one looks along.
    #[test]
    fn energies_are_those_along_the_axes_of_the_material() {
        let mut c = [[0.0; 6]; 6];
        for (i, row) in c.iter_mut().enumerate().take(3) {
            row[..3].copy_from_slice(&[[9.0, 1.0, 2.0], [1.0, 5.0, 0.5], [2.0, 0.5, 3.0]][i]);
        }
        (3..6).for_each(|k| c[k][k] = [0.7, 0.9, 1.3][k - 3]);
        let wood = Hooke::from_voigt(&c).expect("a law");
        // a third of a turn about the diagonal, and another one
        let cyclic = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
        let turned = wood.rotated(cyclic).expect("axes");
        assert!((turned.voigt()[1][1] - 9.0).abs() < 1e-14 && (turned.voigt()[4][4] - 0.7).abs() < 1e-14);
        let (s, t) = (0.6, 0.8);
        let axes = [[s, t, 0.0], [-t * s, s * s, t], [t * t, -s * t, s]];
        let turned = wood.rotated(axes).expect("axes");
        let global = [0.3, -0.2, 0.5, 0.7, -0.4, 0.1];
        let tensor = |p: usize, q: usize| {
            let at = PAIRS
                .iter()
                .position(|pair| *pair == [p.min(q), p.max(q)])
                .expect("a pair");
            if p == q { global[at] } else { 0.5 * global[at] }
        };
        let local = PAIRS.map(|[i, j]| {
            let all = (0..9).map(|k| (k / 3, k % 3));
            let sum: f64 = all.map(|(p, q)| axes[i][p] * axes[j][q] * tensor(p, q)).sum();
            if i == j { sum } else { 2.0 * sum }
        });
        let [a, b] = [turned.energy_density(&global), wood.energy_density(&local)];
        assert!((a - b).abs() < 1e-13 * b, "{a} {b}");
        let skew = [[1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]];
        let error = wood.rotated(skew).expect_err("skew");
        assert!(
            matches!(
                error,
                HookeError::Axes {
                    first: 0,
                    second: 1,
                    ..
                }
            ),
            "{error}"
        );
        let steel = Hooke::isotropic(2e11, 0.3).expect("steel");
        let turned = steel.rotated(axes).expect("axes");
        assert!(turned.poisson().is_some_and(|p| (p - 0.3).abs() < 1e-9));
    }

    /// The ratio is found from the stiffness, with rounding that depends on the unit of stress.
    #[test]
    fn a_ratio_of_two_fifths_is_not_nearly_incompressible() {
        let law = |young: f64, poisson| Hooke::isotropic(young, poisson).expect("a law");
        let laws: Vec<Hooke> = (1..200).map(|k| law(1.7e5 * f64::from(k).powi(3), 0.4)).collect();
        assert!(laws.iter().any(|l| l.poisson().is_some_and(|p| p > INCOMPRESSIBLE)));
        assert!(laws.iter().all(|l| !l.is_nearly_incompressible()));
        assert!(law(1e6, 0.400_001).is_nearly_incompressible());
    }
}
