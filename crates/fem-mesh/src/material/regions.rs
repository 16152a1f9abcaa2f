//! Which material fills which region.

use super::eigenstrain::Eigenstrain;
use super::hooke::Hooke;

errors! {
    /// A region without a material, or with two.
    #[derive(Clone, PartialEq, Eq)]
    MaterialError {
        Unknown { region: u32, known: Vec<u32> } =
            "region {region} has no material; materials are given for the regions {known:?}";
        Repeated { region: u32 } = "region {region} is given two materials; keep one of them";
    }
}

/// Hooke's law of each material region, and its eigenstrains.
#[derive(Debug, Clone, PartialEq)]
pub struct Materials {
    laws: Laws,
    eigenstrains: Vec<(f64, Eigenstrain)>,
}

#[derive(Debug, Clone, PartialEq)]
enum Laws {
    Uniform(Box<Hooke>),
    /// Sorted by region.
    Table(Vec<(u32, Hooke)>),
}

impl Materials {
    /// The same law in all regions.
    pub fn uniform(hooke: Hooke) -> Self {
        Self::of(Laws::Uniform(Box::new(hooke)))
    }

    /// A law for each region listed.
    ///
    /// # Errors
    /// [`MaterialError::Repeated`] if a region is listed twice.
    pub fn new(mut table: Vec<(u32, Hooke)>) -> Result<Self, MaterialError> {
        table.sort_by_key(|(region, _)| *region);
        match table.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            Some(pair) => Err(MaterialError::Repeated { region: pair[0].0 }),
            None => Ok(Self::of(Laws::Table(table))),
        }
    }

    fn of(laws: Laws) -> Self {
        Self {
            laws,
            eigenstrains: Vec::new(),
        }
    }

    /// Adds an eigenstrain times a factor; several add up. [`fields`](crate::fields) and
    /// [`recovery`](crate::recovery) subtract it from the strain before they compute stress. The stiffness does not
    /// change; the forces are those of [`assemble_eigenstrain`](crate::assemble_eigenstrain).
    #[must_use]
    pub fn with_eigenstrain(mut self, factor: f64, strain: Eigenstrain) -> Self {
        self.eigenstrains.push((factor, strain));
        self
    }

    /// Removes and returns the eigenstrains with their factors.
    #[doc(hidden)]
    pub fn take_eigenstrains(&mut self) -> Vec<(f64, Eigenstrain)> {
        std::mem::take(&mut self.eigenstrains)
    }

    /// What of a strain makes stress, in a tetrahedron of this law with its region and corners at barycentric
    /// coordinates.
    pub(crate) fn elastic(&self, law: &Hooke, tet: (u32, &[u32; 4]), l: &[f64; 4], strain: &[f64; 6]) -> [f64; 6] {
        let mut elastic = *strain;
        for (factor, strain) in &self.eigenstrains {
            let strain = strain.at(law, tet, l);
            (0..6).for_each(|i| elastic[i] -= factor * strain[i]);
        }
        elastic
    }

    /// Energy per volume of all of a strain or of what of it makes stress, whichever is larger, J/m³.
    pub(crate) fn larger_energy(&self, law: &Hooke, tet: (u32, &[u32; 4]), l: &[f64; 4], strain: &[f64; 6]) -> f64 {
        let all = law.energy_density(strain);
        if self.eigenstrains.is_empty() {
            return all;
        }
        all.max(law.energy_density(&self.elastic(law, tet, l, strain)))
    }

    /// The regions that a law is listed for, ascending; none where one law fills all regions.
    pub fn listed(&self) -> Vec<u32> {
        match &self.laws {
            Laws::Uniform(_) => Vec::new(),
            Laws::Table(table) => table.iter().map(|(region, _)| *region).collect(),
        }
    }

    /// The law of a region.
    ///
    /// # Errors
    /// [`MaterialError::Unknown`] if the region has none.
    pub fn get(&self, region: u32) -> Result<&Hooke, MaterialError> {
        match &self.laws {
            Laws::Uniform(hooke) => Ok(hooke),
            Laws::Table(table) => match table.binary_search_by_key(&region, |(r, _)| *r) {
                Ok(place) => Ok(&table[place].1),
                Err(_) => {
                    let known = table.iter().map(|(r, _)| *r).collect();
                    Err(MaterialError::Unknown { region, known })
                }
            },
        }
    }

    /// Looks up the law of every tetrahedron, so that loops over elements cannot fail.
    ///
    /// # Errors
    /// [`MaterialError::Unknown`] names the first region that has no law.
    pub fn of_tets(&self, regions: &[u32]) -> Result<Vec<&Hooke>, MaterialError> {
        regions.iter().map(|&region| self.get(region)).collect()
    }
}

impl From<Hooke> for Materials {
    fn from(hooke: Hooke) -> Self {
        Self::uniform(hooke)
    }
}
