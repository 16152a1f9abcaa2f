//! Warnings: scenes and results that are allowed but suspicious.

use crate::names::Names;
use crate::part::Part;
use signorini_fem_mesh::internal::{number, place as told};
use std::path::PathBuf;

signorini_fem_mesh::errors! {
    /// Something that is allowed and computed, but is likely a mistake or beyond small-strain theory. The message has
    /// the figure, the place and the remedy.
    ///
    /// [`Plan::warnings`](crate::Plan::warnings) has those of the scene alone;
    /// [`RunReport::warnings`](crate::RunReport::warnings) adds those of the results, each kind once, where it first
    /// occurred. An [`Observer`](crate::Observer::warning) receives them as soon as they are known. If the scene
    /// [has names](crate::Scene::with_names), warnings about its [parts](Self::parts) are `Named` and contain the
    /// [plain](Self::plain) one.
    ///
    /// The thresholds are a tenth of the body for displacements, 0.05 for its rotation, 5 % for strains, an edge of a
    /// facet for slips, 0.1 for the turn of normals, the angle of a crease, a fifth of the loads for what tilted facets
    /// hold, the body for gaps, a hundredth of it for overlaps, a tenth of an overlap for the distance of facets from
    /// their curve, 3 for coefficients, 0.45 for Poisson's ratios of linear tetrahedra and 10 % for the error of the
    /// mesh. A body is as long as the longest side of the box around it; its rotation is that which fits the
    /// displacements of its nodes best. Strain is measured per tetrahedron by the Frobenius norm; at clamped edges the
    /// strain of linear theory grows without bound as the mesh is refined.
    ///
    /// Fields: `step` from 0; `node`, `tet`, `contact` and `region` are numbers in mesh and scene; `place` and lengths
    /// in m (of a tetrahedron its centroid), `turn` in degrees, other figures relative, `mode` a motion in words.
    /// `extent` is the length of the body, `edge` the longest one of the facets at the node, `part` what never acts,
    /// `present` what the mesh has; `path` is the damaged checkpoint under its new name, `taken` the one in its place.
    #[derive(Clone, PartialEq)]
    Warning {
        LargeDisplacement { step: usize, node: u32, place: [f64; 3], displacement: f64, extent: f64 } =
            "step {step}: the displacement of node {node} at {} is {displacement:.3e}, the body is {extent:.3e} long; \
            displacements count as small here, so from a tenth of the body on shapes and forces are wrong, unless it only moves \
            along flat sides: look at the units of loads, material and gaps, and at the supports", told(place);
        LargeRotation { step: usize, node: u32, place: [f64; 3], turn: f64 } =
            "step {step}: the body of node {node} at {} turns by {turn:.1} degrees; rotations count as small here, so that \
            normals, places of contact and lengths are those of the start: support the body against it, or reduce the \
            loads or motions that turn it", told(place);
        LargeStrain { step: usize, tet: usize, place: [f64; 3], strain: f64 } =
            "step {step}: the strain of tetrahedron {tet} at {} is {:.1} %; strains count as small here, up to 5 %: \
            look at the units of loads and material; where it is a corner or a clamped edge alone, its neighbourhood is \
            not to be trusted", told(place), 100.0 * strain;
        LongSlip { step: usize, contact: usize, node: u32, place: [f64; 3], slip: f64, edge: f64 } =
            "step {step}: node {node} of contact {contact} at {} slides by {slip:.3e}, its facets are {edge:.3e} long; \
            it keeps the normal and the partner that it began with: take smaller steps along an obstacle, and begin with bodies \
            nearer to where they slide", told(place);
        EdgeOverlap { step: usize, contact: usize, node: u32, place: [f64; 3], overlap: f64, largest: f64 } =
            "step {step}: the sides of contact {contact} are {overlap:.3e} inside each other at node {node}, {}, where \
            another contact has a condition and this one, between meshes that do not match, has none (displacements are up \
            to {largest:.3e}): take smaller facets there, or meshes that match, or name this contact before the other one if it \
            is the one that presses there", told(place);
        TurnedNormal { step: usize, contact: usize, node: u32, place: [f64; 3], turn: f64 } =
            "step {step}: node {node} of contact {contact} at {} is displaced to where the normal of its obstacle is \
            another one by {turn:.1} degrees; it keeps the one that it began with, so forces are missing or \
            point aside there: make the way along the obstacle small against its radius of curvature", told(place);
        HeldByTilt { step: usize, body: usize, node: u32, mode: String, share: f64 } =
            "step {step}: normal forces hold {:.0} % of what pushes body {body} (with node {node}) along {mode}, by the tilt \
            of facets that stand for a curve: smooth sides would slide there, and the finer the mesh the less they hold; \
            support the body against it, give it friction that suffices, or give one side as an Obstacle to see what \
            holds", 100.0 * share;
        NeutralPlace { step: usize, body: usize, node: u32, mode: String, range: f64 } =
            "step {step}: body {body} (with node {node}) slides wherever it is pressed, and along {mode} nothing decides \
            its place: any other on a way of {range:.3e} has the same forces; look at these and at the other bodies, or give \
            its sides unlike coefficients, of which the larger one keeps it";
        NarrowContact { step: usize, contact: usize, node: u32, place: [f64; 3], overlap: f64, way: f64 } =
            "step {step}: at node {node}, {}, the sides of contact {contact} are about {overlap:.3e} inside each other, beside \
            a way of {way:.3e}: quadratic facets feel contact in the mean over the facets around a node, so \
            forces on a ridge, or a place narrower than they are, come late and are too small; take smaller facets \
            there, or linear elements", told(place);
        IdleContact { contact: usize } =
            "contact {contact} has no point: supports hold its nodes, or other contacts have the same points and are \
            nearer or come first, so it never acts; leave it out, or give it other tags";
        LargeGap { contact: usize, node: u32, place: [f64; 3], gap: f64, extent: f64 } =
            "contact {contact} begins {:.3e} {} its obstacle even at the nearest node, {node} at {}, and the body is \
            {extent:.3e} long; look at the unit of the gap and at the places of the bodies",
            gap.abs(), if *gap < 0.0 { "inside" } else { "from" }, told(place);
        LargeOverlap { contact: usize, node: u32, place: [f64; 3], overlap: f64, extent: f64 } =
            "contact {contact} begins {overlap:.3e} inside what it touches at node {node}, {}, {:.1} % of the {extent:.3e} that \
            the body there is long; so measured, it presses, whatever the loads are: look at the places of the bodies, or \
            tell the gap (with_gap, 0 for sides that touch, negative for a press fit)",
            told(place), 100.0 * overlap / extent;
        FacetedOverlap { contact: usize, node: u32, place: [f64; 3], overlap: f64, sagitta: f64 } =
            "contact {contact} begins {overlap:.3e} inside what it touches at node {node}, {}, between facets that are \
            {sagitta:.3e} beside the curve that they stand for, which is measured with it and presses all the same: tell \
            the gap (with_gap, 0 for sides that touch), or take smaller facets, or mid-nodes on the curve",
            told(place);
        ClosedOverlaps { contact: usize, node: u32, place: [f64; 3], overlap: f64, points: usize, contacts: usize } =
            "{points} point(s) of {contacts} contact(s) begin inside what they touch, most by {overlap:.3e} at node {node} of \
            contact {contact}, {}, because straight facets stand for a hollow side; in the mean the sides touch, and so \
            do these points: to press, tell the gap (with_gap, negative), or take Contact::with_measured_overlaps",
            told(place);
        CreaseBetween { contact: usize, node: u32, place: [f64; 3], angle: f64 } =
            "contact {contact}: flat sides meet at {angle:.0} degrees at node {node}, {}, and the other body is before both; \
            between bodies a node has one normal, there the mean of theirs, so that edges slide and press \
            along neither side: give each side a contact of its own", told(place);
        LargeCoefficient { contact: usize, node: u32, place: [f64; 3], coefficient: f64 } =
            "friction of contact {contact}: the coefficient at node {node}, {0}, is {1}; hardly any pair of \
            materials has so much: {1} in per cent is {2}",
            told(place), number(*coefficient), number(coefficient / 100.0);
        NothingActs { held: bool } =
            "no load acts, no support moves and nothing overlaps at any step, so that all results are zero{}: look for \
            loads, or supports that move, that are missing, and at ways and tags of obstacles",
            if *held { "" } else { "; no support or spring holds a body either" };
        BetweenSteps { part: Part, start: f64, end: Option<f64>, last: f64 } =
            "{part} is to act from {start} s {}, but no step ends then, so that it never does (the last one ends at \
            {last} s): take more steps, or times of steps that end then (Analysis::Quasistatic), or correct the span",
            end.map_or_else(|| "on".to_owned(), |end| format!("to {end} s"));
        ZeroAtSteps { part: Part, time: f64, factor: f64 } =
            "{part} never acts: its history is zero at the end of each step, and only these count, though it is \
            {factor} at {time} s; take more steps, or times of steps at which it is not zero (Analysis::Quasistatic)";
        Unmerged { node: u32, partner: u32, place: [f64; 3], nodes: usize } =
            "{nodes} node(s) of the body of node {node} coincide with nodes of the body of node {partner}, these two at \
            {}, and nothing acts between the bodies, so that they pass through each other: merge the nodes \
            (mesh::merge_nodes) if the bodies are one, tie their sides (Contact::tied), or let them touch \
            (Contact::between)", told(place);
        UnusedMaterials { regions: Vec<u32>, present: Vec<u32> } =
            "materials are given for the regions {regions:?}, which the mesh does not have; it has {present:?}: look at \
            the numbers, or leave them out";
        Locking { region: u32, poisson: f64 } =
            "region {region} has a Poisson's ratio of {poisson} and linear tetrahedra, which hardly bend without a \
            change of volume: displacements come out too small; take quadratic ones (TetMesh::raise_order)";
        CoarseMesh { step: usize, error: f64, tet: usize, place: [f64; 3] } =
            "step {step}: the mesh leaves an estimated error of {:.0} % in the energy norm, most of it at tetrahedron \
            {tet}, {}; elements are too stiff there, in bending above all linear ones: refine there, and compare",
            100.0 * error, told(place);
        DamagedCheckpoint { path: PathBuf, reason: String, taken: PathBuf } =
            "the newest checkpoint is damaged ({reason}); the run goes on from the one before, {}, and the damaged one \
            is kept as {}: look at the disk", taken.display(), path.display();
        Named { names: String, r#source: Box<Self> } = "{names}: {source}";
    }
}

impl Warning {
    /// The parts of the scene that it speaks of.
    pub fn parts(&self) -> Vec<Part> {
        match self.plain() {
            Self::LargeDisplacement { step, node, .. }
            | Self::LargeRotation { step, node, .. }
            | Self::HeldByTilt { step, node, .. }
            | Self::NeutralPlace { step, node, .. } => {
                vec![Part::Step(*step), Part::Node(*node)]
            }
            Self::LargeStrain { step, tet, .. } | Self::CoarseMesh { step, tet, .. } => {
                vec![Part::Step(*step), Part::Tet(*tet)]
            }
            Self::LongSlip {
                step, contact, node, ..
            }
            | Self::EdgeOverlap {
                step, contact, node, ..
            }
            | Self::NarrowContact {
                step, contact, node, ..
            }
            | Self::TurnedNormal {
                step, contact, node, ..
            } => {
                vec![Part::Step(*step), Part::Node(*node), Part::Contact(*contact)]
            }
            Self::LargeGap { contact, node, .. }
            | Self::LargeOverlap { contact, node, .. }
            | Self::FacetedOverlap { contact, node, .. }
            | Self::ClosedOverlaps { contact, node, .. }
            | Self::CreaseBetween { contact, node, .. }
            | Self::LargeCoefficient { contact, node, .. } => {
                vec![Part::Contact(*contact), Part::Node(*node)]
            }
            Self::Unmerged { node, partner, .. } => vec![Part::Node(*node), Part::Node(*partner)],
            Self::BetweenSteps { part, .. } | Self::ZeroAtSteps { part, .. } => vec![*part],
            Self::UnusedMaterials { regions, .. } => regions.iter().copied().map(Part::Region).collect(),
            Self::Locking { region, .. } => vec![Part::Region(*region)],
            Self::IdleContact { contact } => vec![Part::Contact(*contact)],
            Self::NothingActs { .. } | Self::DamagedCheckpoint { .. } | Self::Named { .. } => Vec::new(),
        }
    }

    /// What a result shows of it, in a few words; nothing of what a scene shows.
    pub(crate) fn brief(&self) -> Option<String> {
        Some(match self.plain() {
            Self::LargeDisplacement { displacement, .. } => format!("displacement of {displacement:.1e}"),
            Self::LargeRotation { turn, .. } => format!("rotation by {turn:.1} degrees"),
            Self::LargeStrain { strain, .. } => format!("strain of {:.1} %", 100.0 * strain),
            Self::LongSlip { slip, .. } => format!("slip of {slip:.1e}"),
            Self::EdgeOverlap { overlap, .. } => format!("overlap of {overlap:.1e}"),
            Self::NarrowContact { overlap, .. } => format!("overlap at an edge of {overlap:.1e}"),
            Self::HeldByTilt { share, .. } => format!("{:.0} % held by the tilt of facets", 100.0 * share),
            Self::NeutralPlace { range, .. } => format!("a place not determined on {range:.1e}"),
            Self::TurnedNormal { turn, .. } => format!("normal turned by {turn:.1} degrees"),
            _ => return None,
        })
    }

    /// It behind the names of what it speaks of.
    pub(crate) fn told(self, names: &Names) -> Self {
        match names.of(self.parts()) {
            Some(names) => Self::Named {
                names,
                source: Box::new(self),
            },
            None => self,
        }
    }

    /// The warning itself, without the names before it.
    pub fn plain(&self) -> &Self {
        match self {
            Self::Named { source, .. } => source.plain(),
            _ => self,
        }
    }
}
