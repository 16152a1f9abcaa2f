//! The plan: which effects a scene has, how large each is, and what is left out. Made before any work.

use super::cost::Estimate;
use super::effects::Effects;
use super::{mesh_error, sanity};
use crate::discrete::{ContactPoint, DiscreteScene, Supports};
use crate::error::ContactError;
use crate::report::Warning;
use crate::scene::{Scene, Stage};
use crate::settings::{MethodKind, Preconditioner, Settings};
use signorini_tfeti::internal::{Forecast, Rate, RowGroups, forecast_levels, may_be_formed};
use std::collections::BTreeSet;

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
    /// Smallest and largest gap of the contact points at the start, m; a negative one is inside the obstacle or the
    /// partner. `None` without points.
    pub gaps: Option<[f64; 2]>,
    /// Contacts with non-matching meshes, and whether the side named second has the points
    /// ([which side has](crate::Contact::between)).
    pub apart: Vec<(usize, bool)>,
    /// Rows of `N`: contact points that can touch, nodes in edges and corners once for each normal (nodes whose normal
    /// displacement is fixed by supports are left out).
    pub normal_rows: usize,
    /// Rows of `T`.
    pub tangential_rows: usize,
    /// Rows of `B_int`.
    pub interface_rows: usize,
    /// Rows of `B_Dir`, and those that hold couplings.
    pub dirichlet_rows: usize,
    /// Rows of tied contacts.
    pub tied_rows: usize,
    /// Rows of linear equations: those that say something new.
    pub equation_rows: usize,
    /// Number of this process among those that solve the scene together, from 0; see
    /// [`Settings::with_communicator`].
    pub rank: usize,
    /// How many they are.
    pub ranks: usize,
    /// Unknowns of the coarse problem.
    pub coarse: usize,
    /// Time steps.
    pub steps: usize,
    /// Stages: one more than there are steps before which supports or contacts start or end, or couplings are locked.
    /// Sizes are those of one of them, of [`Plan::new`] of the largest.
    pub stages: usize,
    /// The method that will be used.
    pub method: MethodKind,
    /// Bytes of the vectors that stay allocated (multipliers, displacements, loads).
    pub vector_bytes: u64,
    /// Bytes that are needed beside those where a step is so hard that `F` is formed; 0 if it never is.
    pub formed_bytes: u64,
    /// Expected relative error of the mesh in the energy norm, from the number of cells over the thickness of the
    /// bodies: accurate to a factor of two and a half on the studies' parts; too large if cells are finer at edges.
    /// After a run [`discretisation_error`](crate::StepResult::discretisation_error) estimates it. `None` if nothing is
    /// known.
    pub mesh_error: Option<f64>,
    /// Memory, and expected products and times.
    pub estimate: Estimate,
    warnings: Vec<Warning>,
}

impl Plan {
    /// Plans a scene. It refuses what [`Simulation::new`](crate::Simulation::new) would refuse, except loads that
    /// nothing can hold, motions that nothing determines, and subdomains that cannot be factored, since that takes the
    /// set-up.
    ///
    /// # Errors
    /// [`ContactError`] naming what is wrong with the scene or the settings.
    pub fn new(scene: &Scene, settings: &Settings) -> Result<Self, ContactError> {
        let plan = |scene: &Scene| DiscreteScene::new(scene).and_then(|own| Ok(Self::of(scene, &own, settings)?.0));
        let all = || {
            let locked = scene.couplings.iter().any(|c| c.locked != [None; 6]);
            if scene.stages().len() == 1 && !locked {
                return plan(scene);
            }
            let mut scene = scene.clone();
            scene.enter(&Stage::default());
            let mut largest = plan(&scene)?;
            for stage in scene.later_stages().collect::<Vec<_>>() {
                scene.enter(&stage);
                let mut other = plan(&scene)?;
                if other.bytes() > largest.bytes() {
                    std::mem::swap(&mut largest, &mut other);
                }
                largest.warn(&[other]);
            }
            Ok(largest)
        };
        all().map_err(|error| scene.names.tell(error))
    }

    /// Counts the vectors of other loads.
    pub(crate) fn set_loads(&mut self, [before, loads]: [usize; 2]) {
        let each = self.primal + self.dual() + self.coarse;
        let of = |loads: usize| (8 * loads * each) as u64;
        self.vector_bytes = self.vector_bytes - of(before) + of(loads);
    }

    /// Takes over warnings of other stages, each kind once; that nothing acts stands only where it does in none.
    pub(crate) fn warn(&mut self, others: &[Self]) {
        let idle = |w: &Warning| matches!(w.plain(), Warning::NothingActs { .. });
        if others.iter().any(|other| !other.warnings.iter().any(idle)) {
            self.warnings.retain(|warning| !idle(warning));
        }
        for warning in others.iter().flat_map(|other| &other.warnings).filter(|w| !idle(w)) {
            let kind = |w: &Warning| std::mem::discriminant(w.plain());
            if !self.warnings.iter().any(|known| kind(known) == kind(warning)) {
                self.warnings.push(warning.clone());
            }
        }
    }

    fn bytes(&self) -> u64 {
        self.vector_bytes + self.estimate.setup_bytes()
    }

    /// The same plan with times for a machine; [`Rate::measure`] measures this one.
    #[must_use]
    pub fn with_machine(mut self, rate: Rate) -> Self {
        self.estimate.times = Some(self.estimate.times_on(rate));
        self
    }

    /// Warnings about the scene, each kind once. [`Display`](std::fmt::Display) prints them, too.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// All rows that are solved for: n_d of full rank, but for nodes with several normals or that supports hold in
    /// part.
    pub fn dual(&self) -> usize {
        self.normal_rows
            + self.tangential_rows
            + self.interface_rows
            + self.tied_rows
            + self.equation_rows
            + self.dirichlet_rows
    }

    /// The plan of a discrete scene, and the forecast that it is made from.
    pub(crate) fn of<'a>(
        scene: &'a Scene,
        discrete: &'a DiscreteScene,
        settings: &Settings,
    ) -> Result<(Self, Forecast<'a>), ContactError> {
        settings.validate()?;
        let effects = Effects::of(scene, discrete);
        let decomposition = &discrete.decomposition;
        let (elements, nodes) = (scene.mesh.tets().len(), scene.mesh.points().len());
        let (subdomains, primal) = (decomposition.subdomains().len(), decomposition.torn_dofs());
        let fixed = &discrete.supports.merged;
        let free = |point: &ContactPoint| free_directions(point, &discrete.supports);
        let points: Vec<&ContactPoint> = discrete.with_rows().collect();
        let rough = |p: &&&ContactPoint| scene.contacts[p.surface].friction().is_some();
        let gap = |range: Option<[f64; 2]>, p: &&ContactPoint| {
            let [low, high] = range.unwrap_or([p.gap; 2]);
            Some([p.gap.min(low), p.gap.max(high)])
        };
        let nodes_of = |p: &&ContactPoint| p.sides.nodes().map(|n| n.0).collect::<Vec<u32>>();
        let touching = points.iter().copied().chain(&discrete.ties);
        let mut touching: BTreeSet<u32> = touching.flat_map(|p| nodes_of(&p)).collect();
        touching.extend(discrete.springs.nodal.iter().map(|s| s.node));
        touching.extend(discrete.equations.iter().flat_map(|e| &e.terms).map(|t| t.0));
        let find = || {
            Forecast::new(
                &scene.mesh,
                decomposition,
                &scene.materials,
                settings.share_translates,
                &settings.inverse,
                &fixed.at_zero(),
                |node| !fixed.directions(node).is_empty() || touching.contains(&node),
            )
        };
        let judge = || {
            let warnings = sanity::warnings(scene, discrete);
            let error = mesh_error::expected(scene, discrete, &warnings);
            (error, warnings.into_iter().map(|w| w.told(&scene.names)).collect())
        };
        let (forecast, (mesh_error, warnings)) = rayon::join(find, judge);
        let mut forecast = forecast?;
        let mut plan = Self {
            effects,
            elements,
            nodes,
            subdomains,
            primal,
            gaps: points.iter().fold(None, gap),
            apart: discrete.apart.clone(),
            normal_rows: points.len(),
            tangential_rows: points.iter().filter(rough).map(|p| free(p).saturating_sub(1)).sum(),
            // each copy of a node but one is glued
            interface_rows: 3 * (decomposition.torn_nodes().flatten().count() - nodes),
            dirichlet_rows: fixed.fixed().map(|held| held.directions.len()).sum::<usize>()
                + discrete.springs.nodal.len()
                + discrete.couplings.supports.len(),
            equation_rows: discrete.equation_rows,
            tied_rows: discrete.ties.iter().map(free).sum(),
            rank: settings.communicator.rank(),
            ranks: settings.communicator.size(),
            coarse: 6 * subdomains,
            steps: scene.analysis.steps(),
            stages: scene.stages().len(),
            method: if effects.contact { settings.method.kind() } else { MethodKind::Linear },
            vector_bytes: 0,
            formed_bytes: 0,
            mesh_error,
            estimate: Estimate::default(),
            warnings,
        };
        let nodes: BTreeSet<u32> = points.iter().flat_map(nodes_of).collect();
        let (supported, rows) = (fixed.fixed().map(|held| held.node), plan.dual());
        let active_sets = plan.method == MethodKind::ActiveSet;
        forecast.coarse = forecast_levels(&forecast, nodes.into_iter(), supported, rows, active_sets);
        let coarse = forecast.coarse.map_or_else(|| forecast.count_coarse(), Ok)?;
        let vectors = match settings.method.kind() {
            MethodKind::Linear | MethodKind::ActiveSet => 16,
            MethodKind::SuccessiveApproximations | MethodKind::OneLoop => 18,
        };
        // displacements, and residuals that leave what subdomains do not agree on
        plan.vector_bytes = 8 * (vectors * plan.dual() + 2 * primal) as u64;
        plan.set_loads([0, scene.loads.len()]);
        let contact = plan.normal_rows + plan.tangential_rows;
        let formed = active_sets && settings.preconditioner != Preconditioner::None;
        if formed && may_be_formed(plan.dual(), contact, subdomains) {
            let largest = forecast.classes.iter().map(|class| class.boundary).max();
            plan.formed_bytes = row_groups(scene, discrete, &points).bytes(largest.unwrap_or(0));
        }
        let sizes = [plan.dual(), primal, plan.steps];
        let tets = elements as f64 / subdomains.max(1) as f64;
        plan.estimate = Estimate::new(sizes, tets, plan.method, settings, &forecast, coarse);
        Ok((plan, forecast))
    }
}

/// The rows by the subdomains that they touch.
fn row_groups(scene: &Scene, discrete: &DiscreteScene, points: &[&ContactPoint]) -> RowGroups {
    let (decomposition, supports) = (&discrete.decomposition, &discrete.supports);
    let mut groups = RowGroups::of_interface(decomposition);
    let near = |node: u32| decomposition.copies(node as usize).iter().map(|copy| copy.subdomain);
    for point in points {
        let rough = scene.contacts[point.surface].friction().is_some();
        let rows = if rough { free_directions(point, supports) } else { 1 };
        groups.add(true, rows, point.sides.nodes().flat_map(|n| near(n.0)));
    }
    for tie in &discrete.ties {
        let nodes = tie.sides.nodes();
        groups.add(false, free_directions(tie, supports), nodes.flat_map(|n| near(n.0)));
    }
    for held in supports.merged.fixed() {
        groups.add(false, held.directions.len(), near(held.node));
    }
    discrete
        .springs
        .nodal
        .iter()
        .for_each(|spring| groups.add(false, 1, near(spring.node)));
    for equation in &discrete.equations {
        groups.add(false, 1, equation.terms.iter().flat_map(|term| near(term.0)));
    }
    let held = discrete.couplings.supports.iter();
    held.for_each(|held| groups.add(false, 1, std::iter::once(held.subdomain)));
    groups
}

/// Number of directions of a point that supports leave free: an estimate at nodes with one or two fixed directions; the
/// set-up counts exactly.
fn free_directions(point: &ContactPoint, supports: &Supports) -> usize {
    let sides = &point.sides;
    // a side of several nodes is held where a good part of it is, not from where a solve has left it
    let enough = sides.own.held_from();
    let of_side = |nodes: &[(u32, f64)]| {
        let held = |node: u32| {
            let directions = supports.merged.directions(node).iter();
            directions.filter(|d| nodes.len() == 1 || !d.left).count()
        };
        let part = |least: usize| {
            let nodes = nodes.iter().filter(|n| held(n.0) >= least);
            nodes.map(|n| n.1).sum::<f64>()
        };
        (1..=3).rev().find(|&least| part(least) >= enough).unwrap_or(0)
    };
    let partner = sides.partner.as_ref().map_or(3, |partner| of_side(partner.nodes()));
    3 - of_side(sides.own.nodes()).min(partner)
}
