//! Strain that makes no stress.

use super::hooke::Hooke;

/// Stress-free strain: thermal expansion, shrinkage, the pretension of a bolt. Hooke's law applies to the difference
/// between strain and eigenstrain.
///
/// ```
/// use signorini_fem_mesh::Eigenstrain;
///
/// // steel, 80 K warmer
/// let warm = Eigenstrain::expansion(12e-6 * 80.0);
/// // a shank along z, region 2, tightened by a thousandth of its length
/// let tightened = Eigenstrain::new([0.0, 0.0, -1e-3, 0.0, 0.0, 0.0]).in_region(2);
/// # let _ = (warm, tightened);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Eigenstrain {
    pub(crate) strain: [f64; 6],
    pub(crate) region: Option<u32>,
    pub(crate) factors: Option<Vec<f64>>,
}

impl Eigenstrain {
    /// The same strain everywhere: xx, yy, zz, yz, xz, xy with engineering shear.
    pub fn new(strain: [f64; 6]) -> Self {
        Self {
            strain,
            region: None,
            factors: None,
        }
    }

    /// The same elongation in all directions: coefficient of thermal expansion times temperature rise.
    pub fn expansion(elongation: f64) -> Self {
        Self::new([elongation, elongation, elongation, 0.0, 0.0, 0.0])
    }

    /// Restricts it to one region.
    pub fn in_region(mut self, region: u32) -> Self {
        self.region = Some(region);
        self
    }

    /// Multiplies it by a factor for each node of the mesh, linear between the corners of a tetrahedron: temperature
    /// rises, if the strain is that of one kelvin.
    pub fn with_factors(mut self, factors: Vec<f64>) -> Self {
        self.factors = Some(factors);
        self
    }

    /// The strain in a tetrahedron of this law with its region and corners, at barycentric coordinates; zero in other
    /// regions. Where the volume strain counts by its mean in the element, so does this one's.
    pub(crate) fn at(&self, law: &Hooke, (region, corners): (u32, &[u32; 4]), l: &[f64; 4]) -> [f64; 6] {
        if self.region.is_some_and(|own| own != region) {
            return [0.0; 6];
        }
        let here = self.factor(corners, l);
        let mut strain = self.strain.map(|e| here * e);
        if law.is_nearly_incompressible() {
            let more = (self.factor(corners, &[0.25; 4]) - here) / 3.0;
            let volume: f64 = self.strain[..3].iter().sum();
            strain[..3].iter_mut().for_each(|e| *e += more * volume);
        }
        strain
    }

    fn factor(&self, corners: &[u32; 4], l: &[f64; 4]) -> f64 {
        let Some(factors) = &self.factors else {
            return 1.0;
        };
        let of = |node: u32| factors.get(node as usize).copied().unwrap_or(f64::NAN);
        corners.iter().zip(l).map(|(&node, l)| l * of(node)).sum()
    }
}
