//! Which material fills which region.

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

/// Hooke's law of each material region.
#[derive(Debug, Clone, PartialEq)]
pub struct Materials(Kind);

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Uniform(Box<Hooke>),
    /// Sorted by region.
    Table(Vec<(u32, Hooke)>),
}

impl Materials {
    /// The same law in all regions.
    pub fn uniform(hooke: Hooke) -> Self {
        Self(Kind::Uniform(Box::new(hooke)))
    }

    /// A law for each region listed.
    ///
    /// # Errors
    /// [`MaterialError::Repeated`] if a region is listed twice.
    pub fn new(mut table: Vec<(u32, Hooke)>) -> Result<Self, MaterialError> {
        table.sort_by_key(|(region, _)| *region);
        match table.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            Some(pair) => Err(MaterialError::Repeated { region: pair[0].0 }),
            None => Ok(Self(Kind::Table(table))),
        }
    }

    /// The regions that a law is listed for, ascending; none where one law fills all regions.
    pub fn listed(&self) -> Vec<u32> {
        match &self.0 {
            Kind::Uniform(_) => Vec::new(),
            Kind::Table(table) => table.iter().map(|(region, _)| *region).collect(),
        }
    }

    /// The law of a region.
    ///
    /// # Errors
    /// [`MaterialError::Unknown`] if the region has none.
    pub fn get(&self, region: u32) -> Result<&Hooke, MaterialError> {
        match &self.0 {
            Kind::Uniform(hooke) => Ok(hooke),
            Kind::Table(table) => match table.binary_search_by_key(&region, |(r, _)| *r) {
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
