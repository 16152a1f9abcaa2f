//! What can be wrong with a scene.

use signorini_fem_mesh as fem;
use signorini_qp::QpError;
use signorini_tfeti::TfetiError;
use std::fmt;
use thiserror::Error;

/// How far from the normal of a node the nearest node of the other side is, in words.
fn beside_words(beside: f64, limit: f64) -> String {
    if beside.is_finite() {
        format!("the nearest node that faces it lies {beside:.3e} m beside its normal, {limit:.3e} m are allowed")
    } else {
        "no node of the other side faces it (their normals have to be opposite)".to_owned()
    }
}

/// What would hold a body.
fn held_remedy(friction: Option<f64>) -> String {
    match friction {
        Some(factor) => format!(
            "friction would have to be more than {:.3} times as large: press harder, pull less, add a support, or \
             move the body by its supports if it is to slide",
            (1e3 * factor).floor() / 1e3
        ),
        None => "add a support, contact or friction, or balance the loads".to_owned(),
    }
}

/// A scene or a setting is wrong, or a solver broke down. Each message names the place and the remedy.
///
/// Fields are what their variant speaks of: `contact`, `support` and `index` positions in the scene, `node` and
/// `partner` mesh nodes, steps from 0; in s, m, m/s, N and Pa.
#[derive(Error)]
#[allow(
    missing_docs,
    reason = "fields that the sentence of their variant explains have none"
)]
#[non_exhaustive]
pub enum ContactError {
    /// A coefficient of friction or a datum of its law.
    #[error(
        "friction of contact {contact}: the {what} is {value}; it must be finite and not negative (a decay rate \
         positive)"
    )]
    Coefficient {
        contact: usize,
        what: &'static str,
        value: f64,
    },
    /// A table of coefficients without entries.
    #[error(
        "friction of contact {contact}: the table of coefficients has no entries; give at least one slip rate with \
         its coefficient"
    )]
    EmptyTable { contact: usize },
    /// A slip rate of a table of coefficients is not finite or not larger than the one before.
    #[error(
        "friction of contact {contact}: the slip rate of entry {entry} (from 0) of the table is {rate} m/s, which is \
         not finite or out of order; give finite slip rates, each larger than the one before"
    )]
    TableRate { contact: usize, entry: usize, rate: f64 },
    /// A law gave an inadmissible coefficient.
    #[error(
        "friction at node {node}: the law gives the coefficient {value} at slip rate {rate} m/s; it must be finite \
         and not negative"
    )]
    CoefficientAt { node: u32, rate: f64, value: f64 },
    /// A given slip bound is negative or not finite.
    #[error("friction at node {node}: the slip bound {value} Pa must be finite and not negative")]
    SlipBound { node: u32, value: f64 },
    /// A difference formula is not consistent.
    #[error("difference formula {alpha}, {beta}, {gamma}: {rule}; use PAPER or BACKWARD_EULER")]
    Formula {
        alpha: f64,
        beta: f64,
        gamma: f64,
        rule: &'static str,
    },
    /// No step, or more than can be meant.
    #[error("the analysis has no step or more than a hundred million; ask for at least one step")]
    NoSteps,
    /// A time out of order or not finite.
    #[error("step {step}: its time {time} s is not finite or not above the one before (the first must be above 0)")]
    Time { step: usize, time: f64 },
    /// Unequal steps with a formula that needs equal ones.
    #[error(
        "step {step}: its length is {length} s, but that of the first is {first} s; the three-step formula needs \
         equal steps, backward Euler does not"
    )]
    UnequalSteps { step: usize, length: f64, first: f64 },
    /// A tag of a support or contact surface is on no facet.
    #[error("{what} {index}: no facet has the tag {tag}; the mesh has {known}")]
    UnknownTag {
        /// Support or contact.
        what: &'static str,
        index: usize,
        tag: u32,
        /// Tags of the mesh in words: `"the tags 1, 2"` or `"no tags"`.
        known: String,
    },
    /// A node number beyond the mesh.
    #[error("support {support}: node {node} does not exist, the mesh has {nodes} nodes, numbered from 0")]
    UnknownNode { support: usize, node: u32, nodes: usize },
    /// The nodes of a support and its displacements differ in number.
    #[error("support {support}: {values} displacements for {nodes} nodes; give one for all, or one a node")]
    ValueCount {
        support: usize,
        values: usize,
        nodes: usize,
    },
    /// A gap is not finite.
    #[error(
        "contact {contact}: the gap at node {node}, at {position:?}, is {value} m; it must be finite at every node \
         of the surface"
    )]
    Gap {
        contact: usize,
        node: u32,
        position: [f64; 3],
        value: f64,
    },
    /// A support holds a contact node inside the obstacle, where no contact force can stop it.
    #[error(
        "support at node {node}: at time {time} s it holds this contact node {depth} m inside the obstacle (normal \
         displacement {displacement} m, gap {gap} m); shorten the motion of the support, correct the gap or the \
         place of the obstacle, or leave the node free along the normal"
    )]
    SupportInObstacle {
        /// Mesh node, the deepest one.
        node: u32,
        /// How far the node is inside the obstacle, m.
        depth: f64,
        /// Time in s, the first at which a node is inside.
        time: f64,
        /// Prescribed displacement along the normal into the obstacle, m.
        displacement: f64,
        /// Distance to the obstacle at that time without the displacement, m.
        gap: f64,
    },
    /// An obstacle has no usable normal.
    #[error("contact {contact}: the obstacle's normal {normal:?} must be finite and not zero")]
    ObstacleNormal { contact: usize, normal: [f64; 3] },
    /// The direction into the obstacle points into the body.
    #[error(
        "contact {contact}: the direction into the obstacle {direction:?} is not on the outer side of the body at \
         any of its {nodes} contact nodes, so the body would pass through; turn the direction round (a half-space \
         needs the normal that points out of the obstacle, up for a floor)"
    )]
    ObstacleSide {
        contact: usize,
        direction: [f64; 3],
        nodes: usize,
    },
    /// A contact node has no node of the other body on its normal.
    #[error(
        "contact {contact}: node {node} has no partner on the other body: {}; meshes of both sides have to match, \
         and the first side must not reach beyond the other one nor be finer (name the smaller or coarser side \
         first)",
        beside_words(*beside, *limit)
    )]
    NoPartner {
        contact: usize,
        node: u32,
        /// Distance from the normal, m; infinite if no node faces it.
        beside: f64,
        limit: f64,
    },
    /// Two bodies overlap by more than their facets.
    #[error(
        "contact {contact}: node {node} lies {depth:.3e} m inside the other body, seen from its partner {partner}, \
         deeper than its facets are large ({size:.3e} m); give sides that face each other across the gap, or, if \
         they are to be pressed apart, tell how far by with_gap"
    )]
    Overlap {
        contact: usize,
        node: u32,
        partner: u32,
        /// Depth along the normal of the node, m.
        depth: f64,
        /// Root of the area of the node, m.
        size: f64,
    },
    /// Two contact nodes have the same partner.
    #[error(
        "contact {contact}: node {partner} is the partner of both node {first} and node {second}; meshes of both \
         sides have to match node by node, and no tag may be on both sides (TetMesh::map_tags before append keeps \
         those of two bodies apart)"
    )]
    SharedPartner {
        contact: usize,
        partner: u32,
        first: u32,
        second: u32,
    },
    /// A contact between bodies has an obstacle that moves.
    #[error(
        "contact {contact} is between two bodies, and has no obstacle that could move; move a body by its supports \
         instead"
    )]
    MovedPartner { contact: usize },
    /// A gap field moves far along a curved surface.
    #[error(
        "contact {contact}: its gap field moves with the obstacle along a curved surface, whose normal turns by \
         {turn:.1} degrees on that way at node {node}; along the body's normals the gap is known for ways of less \
         than {most:.1} degrees; give one direction (with_normal), for which any way is exact, or a shorter way"
    )]
    MovedField {
        contact: usize,
        /// Mesh node at which the surface is most curved.
        node: u32,
        /// Angle by which the normal turns on the way of the obstacle, degrees.
        turn: f64,
        /// What is allowed, degrees.
        most: f64,
    },
    /// Two contact surfaces meet a node along one direction, and which obstacle is nearer changes with time.
    #[error(
        "contact: at node {node} surfaces {first} and {second} have one direction, but their obstacles move \
         differently or bring other gaps, so that either may become the nearer one; leave the facets around it out \
         of one of the surfaces, or give both the same motion"
    )]
    SharedNode { node: u32, first: usize, second: usize },
    /// A load or support history gave a value that is not finite.
    #[error("{what} {index}: its history gives {value} at time {time} s")]
    HistoryValue {
        /// Load, support or contact.
        what: &'static str,
        index: usize,
        time: f64,
        value: f64,
    },
    /// A load, a gap or the motion of a support is so large that squares of what follows from it overflow.
    #[error(
        "{place}: {value:e} {unit} is too large, squares of what follows from it would overflow (at most {most:e} \
         {unit}); check its units and its history"
    )]
    TooLarge {
        /// Load, support or contact node, and when.
        place: String,
        /// Its size: the largest nodal force, displacement or gap.
        value: f64,
        unit: &'static str,
        most: f64,
    },
    /// A material is so stiff or so soft that squares of forces or displacements overflow or vanish.
    #[error(
        "region {region}: its material has a stiffness of {value:e} Pa, and squares of what follows from it would \
         overflow or vanish (at least {least:e} Pa, at most {most:e} Pa); check the units of its material"
    )]
    Stiffness {
        region: u32,
        /// Largest eigenvalue of its law on symmetric tensors, Pa.
        value: f64,
        least: f64,
        most: f64,
    },
    /// Loads that nothing can balance.
    #[error(
        "step {step}: body {body} (with node {node}) cannot be in equilibrium: {mode} is {}, and the loads push \
         along it with {force:.3e} N; {}",
        if friction.is_some() { "beyond what friction can hold" } else { "held neither by supports nor by contact" },
        held_remedy(*friction)
    )]
    NotHeld {
        step: usize,
        /// The body (part of the mesh that hangs together; of bodies that may touch each other the one that moves
        /// most).
        body: usize,
        /// One of its mesh nodes.
        node: u32,
        /// The rigid motion, in words: translation of the centre of the body, and rotation in metres at its radius.
        mode: String,
        /// Work of the loads per metre of the motion, N. For a translation it is the force along it, for a rotation the
        /// moment divided by the radius.
        force: f64,
        /// By more than which factor friction (coefficients and given bounds) would have to be larger to hold the
        /// body; `None` where no friction on its contact surfaces could.
        friction: Option<f64>,
    },
    /// Loads in balance, or none, on a body that nothing holds.
    #[error(
        "the place of body {body} is not determined: the loads are in balance, but {count} rigid motion(s) are held \
         neither by supports nor by contact ({motions}); add supports that stop them"
    )]
    NotDetermined {
        /// The first such body (part of the mesh that hangs together).
        body: usize,
        /// Number of free rigid motions of all bodies.
        count: usize,
        motions: String,
    },
    /// A setting is out of range.
    #[error("setting {name} = {value} is outside its range {range}")]
    Setting {
        name: &'static str,
        value: f64,
        range: &'static str,
    },
    /// Steps that cannot be doubled.
    #[error("step doubling: {reason}")]
    Doubling { reason: &'static str },
    /// All steps are solved.
    #[error("the scene has {steps} steps and all are solved")]
    Finished { steps: usize },
    /// An observer failed; the step before is solved and kept.
    #[error("observer, after step {step}: {source}")]
    Observer {
        step: usize,
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A step did not converge, where that was required.
    #[error("{0}")]
    NotConverged(crate::status::StepFailure),
    /// An earlier step did not converge, on whose displacement later ones depend, where that was required.
    #[error(
        "step {step} did not converge, and the slip of later steps depends on it; continue from a state before it, \
         with smaller steps or other settings"
    )]
    UnconvergedHistory { step: usize },
    /// A checkpoint does not belong to this scene or is damaged.
    #[error("checkpoint: {reason}")]
    Checkpoint { reason: String },
    /// The file of a checkpoint cannot be read or written.
    #[error("checkpoint: cannot {what} {}: {source}", path.display())]
    CheckpointFile {
        /// `"read"` or `"write"`.
        what: &'static str,
        path: std::path::PathBuf,
        source: std::io::Error,
    },
    /// A probe of a result writer is no node.
    #[error("probe: node {node} does not exist, the mesh has {nodes} nodes, numbered from 0")]
    Probe { node: u32, nodes: usize },
    /// The table of a result writer cannot be continued.
    #[error(
        "cannot continue {}: line {line} is {found:?}, but {expected} is needed; a run that is resumed goes on with the \
         table of a writer with the same choices: give it those, or another folder",
        path.display()
    )]
    ResultTable {
        path: std::path::PathBuf,
        line: usize,
        found: String,
        expected: String,
    },
    /// Result files.
    #[cfg(feature = "vtu")]
    #[error(transparent)]
    Output(#[from] fem::output::OutputError),
    /// Mesh.
    #[error(transparent)]
    Mesh(#[from] fem::MeshError),
    /// Material.
    #[error(transparent)]
    Material(#[from] fem::MaterialError),
    /// Decomposition.
    #[error(transparent)]
    Decomposition(#[from] fem::DecompositionError),
    /// Load.
    #[error("load {index}: {source}")]
    Load { index: usize, source: fem::LoadError },
    /// Contact surface.
    #[error(transparent)]
    Surface(#[from] fem::SurfaceError),
    /// Fields derived from a solution.
    #[error(transparent)]
    Field(#[from] fem::FieldError),
    /// Domain decomposition.
    #[error(transparent)]
    Tfeti(#[from] TfetiError),
    /// Quadratic programming.
    #[error(transparent)]
    Qp(#[from] QpError),
}

/// Prints its sentence, as with `{}`, and what its sources add to it: that is what a user sees of a `main` that
/// returns it.
impl fmt::Debug for ContactError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut said = self.to_string();
        f.write_str(&said)?;
        let mut next = std::error::Error::source(self);
        while let Some(source) = next {
            let text = source.to_string();
            if !said.contains(&text) {
                write!(f, "\n  because {text}")?;
                said.push_str(&text);
            }
            next = source.source();
        }
        Ok(())
    }
}
