//! The plan: which effects a scene has, how large each is, and what is left out. Made before any work.

use super::cost::{Estimate, PlanSizes, stiffness_ratio};
use super::effects::{Effects, FrictionKind};
use super::slenderness::slenderness;
use crate::discrete::{ContactPoint, Found, check_scene};
use crate::error::ContactError;
use crate::scene::{Analysis, Friction, Gap, Scene};
use crate::settings::{Method, Settings};
use signorini_fem_mesh::Decomposition;
use signorini_tfeti::{Directions, Forecast, Rate};
use std::collections::{BTreeMap, BTreeSet};

/// Sizes of a scene and the method chosen for it.
///
/// `Display` prints it as a short table.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Plan {
    /// The effects.
    pub effects: Effects,
    /// Tetrahedra.
    pub elements: usize,
    /// Mesh nodes.
    pub nodes: usize,
    /// Subdomains, n_s of the paper.
    pub subdomains: usize,
    /// Unknown displacements of all torn subdomains, n_p of the paper.
    pub primal: usize,
    /// Largest over smallest extent of a subdomain: the mean, weighted by tetrahedra, over 64 of them at most.
    pub slenderness: f64,
    /// Contact points that can touch: nodes, those in edges and corners counted once for each normal (nodes whose normal
    /// displacement is fixed by supports are left out).
    pub contact_nodes: usize,
    /// Smallest and largest gap of these points at the start, m; a negative one is inside the obstacle or the partner. `None`
    /// without points.
    pub gaps: Option<[f64; 2]>,
    /// Rows of `N`.
    pub normal_rows: usize,
    /// Rows of `T`.
    pub tangential_rows: usize,
    /// Rows of `B_int`.
    pub interface_rows: usize,
    /// Rows of `B_Dir`.
    pub dirichlet_rows: usize,
    /// Unknowns of the coarse problem.
    pub coarse: usize,
    /// Time levels.
    pub levels: usize,
    /// The method that will be used.
    pub method: &'static str,
    /// Bytes of the vectors that stay allocated (multipliers, displacements, loads).
    pub vector_bytes: u64,
    /// Estimated memory, products and time.
    pub estimate: Estimate,
}

impl Plan {
    /// Judges a scene. It refuses what [`Simulation::new`](crate::Simulation::new) would refuse, but for loads that nothing can
    /// hold: that takes a set-up.
    ///
    /// # Errors
    /// [`ContactError`] naming what is wrong with the scene or the settings.
    pub fn new(scene: &Scene, settings: &Settings) -> Result<Self, ContactError> {
        scene.validate()?;
        settings.validate()?;
        let decomposition = scene.decompose()?;
        let (plan, found) = Self::with_decomposition(scene, settings, &decomposition)?;
        check_scene(scene, &decomposition, &found)?;
        Ok(plan)
    }

    /// The same plan with times for another machine; [`Rate::measure`] measures this one.
    #[must_use]
    pub fn with_machine(mut self, rate: Rate) -> Self {
        self.estimate.rate = rate;
        self
    }

    /// All rows that are solved for: n_d of full rank, but for nodes with several normals or in the grip of a support.
    #[must_use]
    pub fn dual(&self) -> usize {
        self.normal_rows + self.tangential_rows + self.interface_rows + self.dirichlet_rows
    }

    /// The plan, and what it has found of contact.
    pub(crate) fn with_decomposition(
        scene: &Scene,
        settings: &Settings,
        decomposition: &Decomposition,
    ) -> Result<(Self, Found), ContactError> {
        let fixed = fixed_directions(scene)?;
        let nodes = scene.mesh.points().len();
        let torn_nodes: usize = decomposition
            .subdomains()
            .iter()
            .map(|s| s.nodes.len())
            .sum();
        let interface_rows = 3 * (torn_nodes - nodes);
        let dirichlet_rows: usize = fixed.values().copied().sum();
        let found = Found::new(scene)?;
        let candidates = &found.points;
        // an estimate at nodes with one or two fixed directions: the set-up counts exactly
        let held = |node: u32| fixed.get(&node).copied().unwrap_or(0).min(3);
        let free = |p: &ContactPoint| 3 - held(p.node).min(p.partner.map_or(3, held));
        let points = candidates.iter().filter(|point| free(point) > 0);
        let points: Vec<&ContactPoint> = points.collect();
        let both = |p: &&ContactPoint| std::iter::once(p.node).chain(p.partner);
        let touching: BTreeSet<u32> = points.iter().flat_map(both).collect();
        let normal_rows = points.len();
        let rough = |p: &&&ContactPoint| scene.contacts[p.surface].friction().is_some();
        let tangential_rows = points.iter().filter(rough).map(|p| free(p) - 1).sum();
        let kind = |friction: &Friction| match friction {
            Friction::None => FrictionKind::None,
            Friction::Tresca(_) => FrictionKind::Tresca,
            Friction::Coulomb(c) if c.depends_on_rate() => FrictionKind::RateDependent,
            Friction::Coulomb(_) => FrictionKind::Coulomb,
        };
        let kinds = scene.contacts.iter().map(|c| kind(c.friction()));
        let kind = kinds.max_by_key(|k| *k as u8).unwrap_or(FrictionKind::None);
        let effects = Effects {
            contact: !scene.contacts.is_empty(),
            gap: (0..scene.contacts.len()).any(|k| has_gap(scene, k, candidates)),
            partners: candidates.iter().any(|p| p.partner.is_some()),
            friction: kind,
            history: kind != FrictionKind::None
                && matches!(scene.analysis, Analysis::Quasistatic { .. }),
            gluing: decomposition.subdomains().len() > 1,
            supports: !scene.supports.is_empty(),
            motion: scene.supports.iter().any(|s| s.motion.is_some()),
            moving_obstacle: scene.contacts.iter().any(|c| c.motion.is_some()),
        };
        let method = if effects.contact {
            settings.method.name()
        } else {
            "linear"
        };
        let primal = decomposition.torn_dofs();
        let dual = normal_rows + tangential_rows + interface_rows + dirichlet_rows;
        let vectors = match settings.method {
            Method::ActiveSet(_) => 16,
            _ => 18,
        };
        let touched = |node: u32| fixed.contains_key(&node) || touching.contains(&node);
        let forecast = Forecast::new(
            &scene.mesh,
            decomposition,
            &scene.materials,
            settings.sharing,
            &settings.inverse,
            touched,
        )?;
        let sizes = PlanSizes {
            rows: dual,
            primal,
            elements: scene.mesh.tets().len(),
            subdomains: decomposition.subdomains().len(),
            ratio: largest_ratio(scene)?,
            slenderness: slenderness(&scene.mesh, decomposition),
        };
        let estimate = Estimate::new(&effects, settings, &scene.analysis, &forecast, sizes);
        let plan = Self {
            effects,
            elements: scene.mesh.tets().len(),
            nodes,
            subdomains: decomposition.subdomains().len(),
            primal,
            slenderness: sizes.slenderness,
            contact_nodes: normal_rows,
            gaps: points.iter().map(|p| p.gap).fold(None, |range, gap| {
                let [low, high] = range.unwrap_or([gap; 2]);
                Some([gap.min(low), gap.max(high)])
            }),
            normal_rows,
            tangential_rows,
            interface_rows,
            dirichlet_rows,
            coarse: 6 * decomposition.subdomains().len(),
            levels: scene.analysis.steps(),
            method,
            vector_bytes: 8 * (vectors * dual + (1 + scene.loads.len()) * primal) as u64,
            estimate,
        };
        Ok((plan, found))
    }
}

/// Whether the rows of a contact surface have offsets.
fn has_gap(scene: &Scene, surface: usize, candidates: &[ContactPoint]) -> bool {
    match scene.contacts[surface].gap {
        Gap::None => false,
        Gap::Measured => candidates
            .iter()
            .any(|p| p.surface == surface && p.gap != 0.0),
        _ => true,
    }
}

/// Largest ratio of compressional to shear stiffness in the mesh.
fn largest_ratio(scene: &Scene) -> Result<f64, ContactError> {
    let mut regions = scene.mesh.regions().to_vec();
    regions.sort_unstable();
    regions.dedup();
    regions.into_iter().try_fold(0.0_f64, |most, region| {
        Ok(most.max(stiffness_ratio(scene.materials.get(region)?)))
    })
}

/// Number of directions fixed at each node.
fn fixed_directions(scene: &Scene) -> Result<BTreeMap<u32, usize>, ContactError> {
    let mut axes: BTreeMap<u32, ([bool; 3], usize)> = BTreeMap::new();
    for (index, support) in scene.supports.iter().enumerate() {
        for node in scene.support_nodes(index)? {
            let entry = axes.entry(node).or_insert(([false; 3], 0));
            match &support.directions {
                Directions::All => entry.0 = [true; 3],
                Directions::Components(on) => (0..3).for_each(|c| entry.0[c] |= on[c]),
                Directions::Vectors(vectors) => entry.1 += vectors.len(),
                _ => {}
            }
        }
    }
    let count = |(on, more): ([bool; 3], usize)| (on.iter().filter(|&&b| b).count() + more).min(3);
    Ok(axes
        .into_iter()
        .map(|(node, entry)| (node, count(entry)))
        .collect())
}
