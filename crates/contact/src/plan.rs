//! The plan: which effects a scene has, how large each is, and what is left out. Made before any work.

use crate::candidates::{ContactPoint, Found};
use crate::clock::Analysis;
use crate::contact_surface::Gap;
use crate::error::ContactError;
use crate::estimate::{Estimate, SLENDER, Sizes, stiffness_ratio};
use crate::law::Friction;
use crate::precheck;
use crate::scene::Scene;
use crate::settings::{Method, Settings};
use crate::slender::slenderness;
use signorini_fem_mesh::Decomposition;
use signorini_tfeti::internal::{Forecast, Rate};
use signorini_tfeti::Directions;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// What kind of friction a scene has; of several the one with the most effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FrictionKind {
    /// No tangential rows.
    None,
    /// One quadratic program a level.
    Tresca,
    /// Slip bounds follow the contact forces.
    Coulomb,
    /// The coefficient follows the slip rate, too.
    RateDependent,
}

/// Which effects a scene has; what is `false` here is neither allocated nor computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct Effects {
    /// Inequalities: a contact surface.
    pub contact: bool,
    /// A gap: offsets of the normal rows.
    pub gap: bool,
    /// Contact between elastic bodies.
    pub partners: bool,
    /// Friction.
    pub friction: FrictionKind,
    /// History: old tangential displacements.
    pub history: bool,
    /// Gluing of several subdomains.
    pub gluing: bool,
    /// Supports.
    pub supports: bool,
    /// Supports that move.
    pub motion: bool,
    /// Obstacles that move.
    pub moving_obstacle: bool,
}

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
        precheck::check(scene, &decomposition, &found)?;
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
            settings.share_translates,
            &settings.inverse,
            touched,
        )?;
        let sizes = Sizes {
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

/// Unknowns of a subdomain from which on cutting it further pays: about ten cells an edge.
const LARGE: usize = 4000;

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let e = &self.effects;
        let yes = |on: bool, text: String, absent: &str| {
            if on { text } else { format!("none ({absent})") }
        };
        writeln!(f, "plan")?;
        writeln!(
            f,
            "  mesh        {} tetrahedra, {} nodes",
            self.elements, self.nodes
        )?;
        writeln!(
            f,
            "  subdomains  {} ({} torn unknowns)",
            self.subdomains, self.primal
        )?;
        if self.primal > LARGE * self.subdomains {
            writeln!(
                f,
                "              large ones: 4 to 6 cells an edge each are faster (with_boxes, with_parts)"
            )?;
        }
        if self.estimate.is_mostly_coarse() {
            writeln!(
                f,
                "              too small ones: their {} rigid motions take most of the time; some hundred tetrahedra each are faster",
                self.coarse
            )?;
        }
        // the estimate of a brick of 3 : 1 has no part for bending
        if e.contact && self.slenderness > 1.2 * SLENDER {
            writeln!(
                f,
                "              slender ones, {:.0} : 1: such as are as long as thick need far fewer products",
                self.slenderness
            )?;
        }
        let gluing = format!("{} rows", self.interface_rows);
        writeln!(
            f,
            "  gluing      {}",
            yes(e.gluing, gluing, "one subdomain")
        )?;
        let moving = if e.motion { ", moving" } else { "" };
        writeln!(
            f,
            "  supports    {}",
            yes(
                e.supports,
                format!("{} rows{moving}", self.dirichlet_rows),
                "free body"
            )
        )?;
        let gap = match self.gaps.filter(|_| e.gap) {
            None => "no gap: zero offset".to_owned(),
            Some([low, high]) => {
                let inside = if low < 0.0 { ", starts inside" } else { "" };
                format!("gaps {low:.3e} to {high:.3e} m{inside}")
            }
        };
        let moving = if e.moving_obstacle {
            ", moving obstacle"
        } else {
            ""
        };
        let partners = if e.partners { ", between bodies" } else { "" };
        let contact = format!("{} nodes, {gap}{moving}{partners}", self.contact_nodes);
        writeln!(
            f,
            "  contact     {}",
            yes(e.contact, contact, "no inequality solver")
        )?;
        let friction = match e.friction {
            FrictionKind::None => "none (no tangential rows)".to_owned(),
            FrictionKind::Tresca => format!("given, {} rows, no outer loop", self.tangential_rows),
            FrictionKind::Coulomb => {
                format!("Coulomb, {} rows, no slip rate", self.tangential_rows)
            }
            FrictionKind::RateDependent => {
                format!("Coulomb, rate dependent, {} rows", self.tangential_rows)
            }
        };
        writeln!(f, "  friction    {friction}")?;
        let history = format!("{} levels, old traces kept", self.levels);
        writeln!(
            f,
            "  history     {}",
            yes(e.history, history, "each level stands alone")
        )?;
        writeln!(
            f,
            "  dual        {} rows, coarse {}",
            self.dual(),
            self.coarse
        )?;
        writeln!(f, "  method      {}", self.method)?;
        let mb = |bytes: u64| bytes as f64 / 1e6;
        let e = &self.estimate;
        writeln!(
            f,
            "  memory      vectors {:.1} MB; estimated: inverses {:.1} MB ({} classes), coarse {:.1} MB, tables {:.1} MB",
            mb(self.vector_bytes),
            mb(e.inverse_bytes),
            e.classes,
            mb(e.coarse_bytes),
            mb(e.table_bytes)
        )?;
        write!(
            f,
            "  estimate    {} products ({} to {}) of {:.2} ms, set-up {:.2} s, all levels {:.2} s ({:.2} to {:.2}) on one processor",
            e.products,
            e.fewest_products,
            e.most_products,
            1e3 * e.product_seconds(),
            e.setup_seconds(),
            e.solve_seconds(),
            e.solve_seconds_range()[0],
            e.solve_seconds_range()[1]
        )
    }
}
