//! Building a T-FETI system.

use crate::coarse::space::Coarse;
use crate::dual::boundary::BoundaryMap;
use crate::dual::inverses::invert;
use crate::dual::operator::DualOperator;
use crate::error::TfetiError;
use crate::processes::communicator::Communicator;
use crate::processes::exchange::Exchange;
use crate::projector::levels::has_two_levels;
use crate::rows::equations::{NodalEquation, independent_equations};
use crate::rows::gluing::Gluing;
use crate::rows::rigid::{RigidRow, RigidSupport};
use crate::rows::side::ContactConstraint;
use crate::rows::supports::{MergedSupports, NodalSpring, NodeSupport};
use crate::subdomain::class::Classes;
use crate::subdomain::copy_stiffness::CopyStiffness;
use crate::subdomain::cost::InverseSettings;
use crate::subdomain::forecast::Forecast;
use crate::subdomain::kernel::mean;
use crate::subdomain::matrices::Subdomains;
use crate::subdomain::ownership::Ownership;
use crate::system::report::SetupReport;
use crate::system::tfeti::Tfeti;
use signorini_fem_mesh::{Decomposition, Materials, TetMesh};
use std::sync::Arc;
use std::time::Instant;

/// What a T-FETI system is built from. All fields are borrowed while it is built only.
#[derive(Debug, Clone, Copy)]
pub struct TfetiBuilder<'a> {
    mesh: &'a TetMesh,
    decomposition: &'a Decomposition,
    materials: &'a Materials,
    supports: &'a [NodeSupport],
    rigid: &'a [RigidSupport],
    contact: &'a [ContactConstraint],
    equations: &'a [NodalEquation],
    springs: &'a [NodalSpring],
    share_translates: bool,
    inverse: InverseSettings,
    forecast: Option<&'a Forecast<'a>>,
    communicator: Option<&'a Arc<dyn Communicator>>,
}

impl<'a> TfetiBuilder<'a> {
    /// A body without supports and contact.
    pub fn new(mesh: &'a TetMesh, decomposition: &'a Decomposition, materials: &'a Materials) -> Self {
        Self {
            mesh,
            decomposition,
            materials,
            supports: &[],
            rigid: &[],
            contact: &[],
            equations: &[],
            springs: &[],
            share_translates: true,
            inverse: InverseSettings::default(),
            forecast: None,
            communicator: None,
        }
    }

    /// The body of a forecast, without supports and contact. What the forecast found of mesh, decomposition and
    /// materials is not looked for again; sharing and inverses are as it was told.
    #[doc(hidden)]
    pub fn of_forecast(forecast: &'a Forecast<'a>) -> Self {
        Self {
            share_translates: forecast.share_translates,
            inverse: forecast.settings,
            forecast: Some(forecast),
            ..Self::new(forecast.mesh, forecast.decomposition, forecast.materials)
        }
    }

    /// Sets the supports.
    #[must_use]
    pub fn with_supports(mut self, supports: &'a [NodeSupport]) -> Self {
        self.supports = supports;
        self
    }

    /// Sets what is held of the motions of rigid subdomains.
    #[must_use]
    pub fn with_rigid_supports(mut self, rigid: &'a [RigidSupport]) -> Self {
        self.rigid = rigid;
        self
    }

    /// Sets the contact constraints.
    #[must_use]
    pub fn with_contact(mut self, contact: &'a [ContactConstraint]) -> Self {
        self.contact = contact;
        self
    }

    /// Sets the linear equations. Those that say nothing new get no row.
    #[must_use]
    pub fn with_equations(mut self, equations: &'a [NodalEquation]) -> Self {
        self.equations = equations;
        self
    }

    /// Sets the springs to the ground.
    #[must_use]
    pub fn with_springs(mut self, springs: &'a [NodalSpring]) -> Self {
        self.springs = springs;
        self
    }

    /// Sets whether subdomains that are translations of one another share their matrices. Default: they do.
    #[must_use]
    pub fn with_share_translates(mut self, share: bool) -> Self {
        // classes are others then
        self.forecast = self.forecast.filter(|f| f.share_translates == share);
        self.share_translates = share;
        self
    }

    /// Sets how the generalised inverses are chosen.
    #[must_use]
    pub fn with_inverse(mut self, settings: InverseSettings) -> Self {
        self.inverse = settings;
        self
    }

    /// Sets the processes that solve the problem together; each builds the system and holds its part of the matrices.
    /// Default: this one alone.
    #[must_use]
    pub fn with_communicator(mut self, communicator: &'a Arc<dyn Communicator>) -> Self {
        self.communicator = Some(communicator);
        self
    }

    /// Builds the system. A body that nothing holds is no error: see [`Coarse::free_motions`].
    ///
    /// # Errors
    /// Any of [`TfetiError`]: bad supports or contact constraints, unknown materials, subdomains whose stiffness is
    /// singular beyond the rigid motions, not enough memory, a process lost.
    pub fn build(self) -> Result<Tfeti, TfetiError> {
        let (mesh, decomposition) = (self.mesh, self.decomposition);
        let check = |what, found, expected| {
            if found == expected {
                Ok(())
            } else {
                Err(TfetiError::DecompositionMismatch { what, found, expected })
            }
        };
        check("nodes", decomposition.nodes(), mesh.points().len())?;
        check("elements", decomposition.parts().len(), mesh.tets().len())?;
        let supports = MergedSupports::new(self.supports, mesh.points().len())?;
        let classes = match self.forecast {
            Some(forecast) => forecast.found.clone(),
            None => Classes::find(mesh, decomposition, self.materials, self.share_translates)?
                .with_held(decomposition, &supports.at_zero()),
        };
        let exchange = Arc::new(self.communicator.cloned().map_or_else(Exchange::default, Exchange::new));
        exchange.check()?;
        let ownership = Ownership::new(&classes, exchange.clone());
        let started = Instant::now();
        let subdomains = Subdomains::assemble(mesh, decomposition, self.materials, classes, ownership)?;
        let subdomains = Arc::new(subdomains);
        let assembly_seconds = started.elapsed().as_secs_f64();
        let (gluing, stiffness) = self.glue(&subdomains, &supports)?;
        let map = Arc::new(BoundaryMap::new(&subdomains.classes, &gluing, &subdomains.ownership));
        let points = mesh.points();
        let centre = |nodes: &[u32]| mean(nodes.iter().map(|&n| points[n as usize]));
        let all = decomposition.subdomains().iter();
        let centres = all.map(|s| centre(&s.nodes)).collect();
        let known = self.forecast.map(|f| f.symbolic.as_slice());
        let levels = has_two_levels(&gluing, subdomains.count());
        let (inverses, coarse) = rayon::join(
            || invert(&subdomains, &map, &self.inverse, known),
            || {
                let (map, gluing) = (map.clone(), gluing.clone());
                Coarse::new(map, subdomains.clone(), gluing, centres, !levels)
            },
        );
        let ((inverses, classes), coarse) = (inverses?, coarse?);
        exchange.check()?;
        let coarse_bytes = if levels {
            self.forecast.and_then(|f| f.coarse).map_or(0, |found| found.bytes)
        } else {
            8 * coarse.0.symbolic()?.stored() as u64
        };
        let factors = inverses.iter().flatten().count();
        let report = SetupReport {
            inverse_bytes: classes.iter().map(|class| class.bytes).sum(),
            classes,
            coarse_bytes,
            table_bytes: map.bytes(),
            factorisations: 1 + factors,
            analysed: known.map_or(factors, |_| 0),
            assembly_seconds,
        };
        let dual = DualOperator::new(map, subdomains, Arc::new(inverses), gluing);
        Ok(Tfeti::new(dual, coarse, report, decomposition, stiffness))
    }

    /// The rows, and the stiffness of copies, with whether rows weigh copies by it.
    fn glue(
        &self,
        subdomains: &Subdomains,
        supports: &MergedSupports,
    ) -> Result<(Arc<Gluing>, (CopyStiffness, bool)), TfetiError> {
        let all = CopyStiffness::new(subdomains, self.decomposition.torn_nodes());
        let counts = has_several_laws(self.mesh, self.materials) || all.differs(self.decomposition);
        let alike = CopyStiffness::default();
        let (stiffness, springs) = (if counts { &all } else { &alike }, (self.springs, &all));
        let rigid = self
            .rigid
            .iter()
            .map(|support| support.row(self.mesh, self.decomposition));
        let rigid: Vec<RigidRow> = rigid.collect::<Result<_, _>>()?;
        let held = (supports, self.rigid);
        let needed = independent_equations(self.equations, (self.mesh, self.decomposition), held, self.contact)?;
        let needed: Vec<_> = needed.into_iter().map(|k| (k, &self.equations[k])).collect();
        let (supports, contact) = ((supports, &rigid[..]), (self.contact, &needed[..]));
        let gluing = Gluing::new(self.decomposition, supports, contact, stiffness, springs)?;
        Ok((Arc::new(gluing), (all, counts)))
    }
}

/// Whether regions in use have different Hooke tensors.
fn has_several_laws(mesh: &TetMesh, materials: &Materials) -> bool {
    let law = |region: u32| materials.get(region).ok().map(|h| *h.voigt());
    let regions = mesh.distinct_regions();
    regions.windows(2).any(|pair| law(pair[0]) != law(pair[1]))
}
