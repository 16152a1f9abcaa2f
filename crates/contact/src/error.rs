//! What can be wrong with a scene.

use crate::part::Part;
use crate::status::FreeCoupling;
use signorini_fem_mesh as fem;
use signorini_fem_mesh::internal::{number, place};
use signorini_qp::QpError;
use signorini_tfeti::TfetiError;

/// What does not hold a body.
fn held_by(friction: Option<f64>) -> &'static str {
    match friction {
        Some(_) => "beyond what friction can hold",
        None => "held neither by supports nor by contact",
    }
}

/// What would hold a body.
fn held_remedy(step: usize, friction: Option<f64>, coupling: Option<&FreeCoupling>) -> String {
    // as many digits as tell the factor from 1
    let prec = friction.map_or(0, |factor| (3.0 - (factor - 1.0).log10().min(0.0)).min(15.0) as usize);
    let digits = 10.0_f64.powi(prec as i32);
    let others = match friction {
        Some(factor) => format!(
            "friction would have to be more than {:.prec$} times as large: press harder, pull less, add a support, or \
             move the body by its supports if it is to slide",
            (digits * factor).floor() / digits
        ),
        None => "add a support, contact or friction, merge its nodes with those of a body that it is a part of \
            (mesh::merge_nodes), or balance the loads; where they tip it just within its edge, make the facets there \
            smaller, or linear"
            .to_owned(),
    };
    let before = match step {
        0 => "",
        _ => "; the steps before this one are not refused: end the analysis there to see them",
    };
    others + &freed_remedy(coupling) + before
}

/// What a coupling could hold.
fn freed_remedy(coupling: Option<&FreeCoupling>) -> String {
    coupling.map_or_else(String::new, |coupling| format!("; or hold {coupling}"))
}

impl ContactError {
    /// The error itself, without the names before it.
    pub fn plain(&self) -> &Self {
        match self {
            Self::Named { source, .. } => source.plain(),
            _ => self,
        }
    }

    /// Refuses a setting unless it is good.
    pub(crate) fn check(good: bool, name: &'static str, value: f64, range: &'static str) -> Result<(), Self> {
        let error = Self::Setting { name, value, range };
        good.then_some(()).ok_or(error)
    }

    pub(crate) fn coupling(coupling: usize, node: Option<u32>, reason: &'static str) -> Self {
        Self::Coupling { coupling, node, reason }
    }
}

signorini_fem_mesh::errors! {
    /// A scene or a setting is wrong, or a solver broke down. Each message names the place and the remedy.
    ///
    /// Fields are what their variant speaks of: `contact`, `support` and `index` positions in the scene, `node` and
    /// `partner` mesh nodes, steps from 0; in s, m, m/s, N and Pa. A body is a part of the mesh that hangs together.
    /// `friction` is the factor above which larger friction would hold it, `None` where not a thousandfold could.
    /// [`parts`](Self::parts) lists them. Where a scene [has names](crate::Scene::with_names) what is said of it is
    /// `Named`: match on [`plain`](Self::plain).
    ContactError from {
        Mesh(fem::MeshError),
        Material(fem::MaterialError),
        Decomposition(fem::DecompositionError),
        Surface(fem::SurfaceError),
        Field(fem::FieldError),
        Tfeti(TfetiError),
        Qp(QpError),
        #[cfg(feature = "vtu")]
        Output(fem::output::OutputError),
    } {
        Coefficient { contact: usize, what: &'static str, value: f64 } =
            "friction of contact {contact}: the {what} is {}; it must be finite and not negative (a decay rate \
            positive)", number(*value);
        ContactValue { contact: usize, name: &'static str, value: f64, range: &'static str } =
            "contact {contact}: {name} = {} is outside its range {range}", number(*value);
        Compliance { contact: usize, value: f64 } =
            "contact {contact}: its compliance is {}; it must be finite and not negative, a length over a stress, \
            0 for the exact law", number(*value);
        EmptyTable { contact: usize } =
            "friction of contact {contact}: the table of coefficients has no entries; give at least one slip rate \
            with its coefficient";
        TableRate { contact: usize, entry: usize, rate: f64 } =
            "friction of contact {contact}: the slip rate of entry {entry} (from 0) of the table is {}, which \
            is not finite or out of order; give finite slip rates, each larger than the one before", number(*rate);
        CoefficientAt { contact: usize, node: u32, position: [f64; 3], rate: f64, value: f64 } =
            "friction of contact {contact} at node {node}, {}: the law gives the coefficient {} at slip rate {}; it \
            must be finite and not negative", place(position), number(*value), number(*rate);
        SlipBound { contact: usize, node: u32, position: [f64; 3], value: f64 } =
            "friction of contact {contact} at node {node}, {}: the slip bound {} must be finite and not negative",
            place(position), number(*value);
        Formula { alpha: f64, beta: f64, gamma: f64, rule: &'static str } =
            "difference formula {alpha}, {beta}, {gamma}: {rule}; use PAPER or BACKWARD_EULER";
        NoSteps = "the analysis has no step or more than a hundred million; ask for one to that many";
        Time { step: usize, time: f64 } =
            "step {step}: its time {time} s is not finite or not above the one before (the first must be above 0)";
        UnequalSteps { step: usize, length: f64, first: f64 } =
            "step {step}: its length is {length} s, but that of the first is {first} s; the three-step formula needs \
            equal steps, backward Euler does not";
        UnknownTag { part: Part, tag: u32, known: String } =
            "{part}: no facet has the tag {tag}; the mesh has {known}";
        Spring { spring: usize, reason: &'static str } = "spring {spring}: {reason}";
        SpringStiffness { spring: usize, value: f64 } =
            "spring {spring}: its stiffness is {}; it must be finite and not negative, and some component \
            positive", number(*value);
        Coupling { coupling: usize, node: Option<u32>, reason: &'static str } =
            "coupling {coupling}{}: {reason}", node.map_or(String::new(), |n| format!(", node {n}"));
        UnknownCoupling { load: usize, coupling: usize, couplings: usize } =
            "load {load}: coupling {coupling} does not exist, the scene has {couplings}, numbered from 0";
        UnknownNode { support: usize, node: u32, nodes: usize } =
            "support {support}: node {node} does not exist, the mesh has {nodes} nodes, numbered from 0";
        ValueCount { support: usize, values: usize, nodes: usize } =
            "support {support}: {values} displacements for {nodes} nodes; give one for all, or one a node";
        SupportAxis { support: usize, point: [f64; 3], axis: [f64; 3] } =
            "support {support}: its axis through {} along {axis:?} must be finite, and the direction not zero",
            place(point);
        OnAxis { support: usize, node: u32 } =
            "support {support}: node {node} lies on its axis, where no direction is radial or tangential; leave it out, \
            or hold it along x, y, z by a support of its own";
        MotionNotHeld { support: usize, node: u32, value: f64, along: &'static str } =
            "support {support}: it is to move node {node} by {} {along}, a direction that it does not hold; hold this \
            direction, too (Support::components), or make this part of the motion zero", number(*value);
        Gap { contact: usize, node: u32, position: [f64; 3], value: f64 } =
            "contact {contact}: the gap at node {node}, {}, is {value}; it must be finite at every node of the surface",
            place(position);
        SupportInObstacle {
            support: usize, contact: usize, node: u32, position: [f64; 3], depth: f64, time: f64, displacement: f64,
            gap: f64
        } =
            "support {support} holds node {node}, {}, at time {time} s {depth} inside the obstacle of contact \
            {contact} (normal displacement {displacement}, gap {gap}); shorten the motion of the support, correct the \
            gap or the place of the obstacle, or leave the node free along the normal", place(position);
        PartedTie {
            support: usize, contact: usize, node: u32, position: [f64; 3], apart: f64, along: [f64; 3], time: f64
        } =
            "support {support}: it holds node {node}, {}, of tied contact {contact}, and with others the other side, \
            so that at time {time} s the sides are {apart} m along {along:.4?} from where the tie has them; move both \
            alike, give the tie the motion (Contact::with_motion), or leave the nodes of one side out of the supports",
            place(position);
        ObstacleNormal { contact: usize, normal: [f64; 3] } =
            "contact {contact}: the obstacle's normal {normal:?} must be finite and not zero";
        ObstacleSide { contact: usize, direction: [f64; 3], nodes: usize } =
            "contact {contact}: the direction into the obstacle {direction:?} is not on the outer side of the body at \
            any of its {nodes} contact nodes, so the body would pass through; turn the direction round (a half-space \
            needs the normal that points out of the obstacle, up for a floor)";
        NoPartner { contact: usize, distance: f64 } =
            "contact {contact}: no facet of the first side faces one of the other side (their nearest nodes are \
            {distance:.3e} apart); name sides that look at each other";
        Overlap { contact: usize, node: u32, partner: u32, depth: f64, size: f64 } =
            "contact {contact}: node {node} lies {depth:.3e} inside the other body, seen from its partner \
            {partner}, deeper than its facets are large ({size:.3e}); give sides that face each other across the \
            gap (ContactPair::find finds them on hooked bodies); where Contact::between is to press them apart, tell how \
            far by with_gap";
        SameSide { contact: usize, tag: u32 } =
            "contact {contact}: the tag {tag} is on both sides; give each side its own (TetMesh::map_tags before \
            append keeps those of two bodies apart, NewPhysicalGroup of Gmsh's plugin Crack those of a crack)";
        SamePair { first: usize, second: usize, tags: [u32; 2] } =
            "contacts {first} and {second} have, tied or not, the same sides with the tags {} and {}; give each pair of sides once", tags[0], tags[1];
        Tied { contact: usize } =
            "contact {contact} is tied: its sides move alike, and friction, gap, compliance, direction and rotation mean \
            nothing; leave them out, or use Contact::between";
        MovedPartner { contact: usize } =
            "contact {contact} is between two bodies, and has no obstacle that could move or have a shape; move a body by \
            its supports instead, and give the obstacle a contact of its own";
        MovedField { contact: usize, node: u32, turn: f64, most: f64 } =
            "contact {contact}: its obstacle moves or turns by {turn:.1} degrees against the normal of the body at node \
            {node}, along which the gap is known for less than {most:.1} degrees: give the obstacle a shape \
            (Contact::obstacle), which is measured where it is, or what does not turn one direction (with_normal), for \
            which any way is exact";
        ObstacleGradient { contact: usize, node: u32, position: [f64; 3], gradient: [f64; 3] } =
            "contact {contact}: at node {node}, {}, the gradient of the distance to the obstacle is \
            {gradient:?}, which is no unit vector; give a signed distance in m, positive outside, with its gradient, \
            or leave facets far from the obstacle out of the contact", place(position);
        ObstacleDistance { contact: usize, node: u32, position: [f64; 3], slope: f64 } =
            "contact {contact}: at node {node}, {}, what is given as distance to the obstacle changes by {slope:.2e} m \
            per m along its gradient, a distance by 1; give the distance in m, of another function its value over the \
            length of its gradient", place(position);
        FrictionAxis { contact: usize, node: u32, axis: [f64; 3] } =
            "contact {contact}: the axis of friction {axis:?} gives no direction along the surface at node {node}; it \
            must be finite, not zero and not normal to the surface: give curved sides in several contacts";
        ObstacleFacet { facet: usize, reason: &'static str } =
            "facet {facet} of the surface of an obstacle {reason}; give triangles with area, whose nodes turn \
            counter-clockwise seen from outside";
        TurnedNormal { contact: usize, node: u32, time: f64, turn: f64, most: f64 } =
            "contact {contact}: at time {time} s the obstacle has moved so far that its normal at node {node} has \
            turned by {turn:.1} degrees; normals stay those of the start, which is good for less than {most:.1} \
            degrees: move it less, start from where it is, or give the direction of contact (with_normal or \
            with_body_normals), along which any gap is measured";
        SharedNode { node: u32, first: usize, second: usize } =
            "contact: at node {node} surfaces {first} and {second} have one direction, but their obstacles move \
            differently, give way differently or bring other gaps, so that either may become the nearer one; leave the \
            facets around it out of one of the surfaces, or give both the same motion, compliance and gap";
        HistoryValue { part: Part, time: f64, value: f64 } =
            "{part}: its history gives {} at time {time} s", number(*value);
        Span { part: Part, start: f64, end: f64 } =
            "{part}: it is to act from {start} s to {end} s; give finite times, not negative, the end later than \
            the start";
        Idle { part: Part, setting: &'static str, needs: &'static str } =
            "{part}: {setting} says nothing without {needs}; give both, or leave it out";
        TwoGaps { contact: usize } =
            "contact {contact}: with_gap and with_gap_field each give its gap, and only one can count; leave one out, \
            or let the field contain the constant";
        TaggedSides { bodies: usize } =
            "pairs are looked for where the boundary has no tags, and that of {bodies} bodies has some everywhere but \
            on one body at most; take the tags off the sides that may touch (TetMesh::without_tags), or name them \
            (Contact::between)";
        TooLarge { part: Part, place: String, value: f64, unit: &'static str, most: f64 } =
            "{part}{place}: {value:e} {unit} are too much, squares of what follows from it would overflow (at most {most:e}); check \
            its units and its history";
        Stiffness { region: u32, value: f64, least: f64, most: f64 } =
            "region {region}: its material has a stiffness of {value:e}, and squares of what follows from it would \
            overflow or vanish (at least {least:e}, at most {most:e}); check the units of its material";
        NotHeld {
            step: usize, body: usize, node: u32, mode: String, force: f64, friction: Option<f64>,
            coupling: Option<Box<FreeCoupling>>
        } =
            "step {step}: body {body} (with node {node}) cannot be in equilibrium: {mode} is {}, and the loads push \
            along it with a force of {force:.3e}; {}",
            held_by(*friction), held_remedy(*step, *friction, coupling.as_deref());
        NotDetermined {
            body: usize, node: u32, count: usize, motions: String, coupling: Option<Box<FreeCoupling>>, in_contact: bool
        } =
            "the place of body {body} (with node {node}) is not determined: the loads are in balance, but {count} rigid motion(s) are \
            held neither by supports nor by contact ({motions}); add supports that stop them{}{}",
            freed_remedy(coupling.as_deref()), if *in_contact { ", or take the default method" } else { "" };
        Setting { name: &'static str, value: f64, range: &'static str } =
            "setting {name} = {} is outside its range {range}", number(*value);
        Doubling { reason: &'static str } = "step doubling: {reason}";
        Finished { steps: usize } = "the scene has {steps} steps and all are solved";
        Observer { step: usize, r#source: Box<dyn std::error::Error + Send + Sync> } =
            "observer, after step {step}: {}", fem::with_sources(source.as_ref());
        NotConverged(Box<crate::status::StepFailure>) = "{0}";
        UnconvergedHistory { step: usize } =
            "step {step} did not converge, and the slip of later steps depends on it; continue from a state before \
            it, with smaller steps or other settings";
        Checkpoint { reason: String } = "checkpoint: {reason}";
        UnreadableCheckpoint { reason: String } = "checkpoint: {reason}";
        CheckpointFile { what: &'static str, path: std::path::PathBuf, r#source: std::io::Error } =
            "checkpoint: cannot {what} {}: {source}; {}", path.display(), match source.kind() {
                std::io::ErrorKind::NotFound => "there is none at this path: look for the folder",
                _ => "those stored before stay: make room, correct the rights of the folder or give another one, then \
                    go on",
            };
        Probe { node: u32, nodes: usize } =
            "probe: node {node} does not exist, the mesh has {nodes} nodes, numbered from 0";
        ResultTable { path: std::path::PathBuf, line: usize, found: String, expected: String } =
            "cannot continue {}: line {line} is {found:?}, but {expected} is needed; a run that is resumed goes on with \
            the table of a writer with the same choices: give it those, or another folder", path.display();
        Named { names: String, r#source: Box<Self> } = "{names}: {source}";
        Load { index: usize, r#source: fem::LoadError } = "load {index}: {source}";
    }
}
