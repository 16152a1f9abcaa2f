//! What is allowed but hardly meant: results and scenes that an engineer should look at.

use std::path::PathBuf;

/// Something that is allowed and computed, and that is rather a mistake or outside what small strain can tell. Its
/// sentence has the figure, the place and the remedy.
///
/// [`Plan::warnings`](crate::Plan::warnings) has those of the scene alone;
/// [`RunReport::warnings`](crate::RunReport::warnings) has them and those of the results, each kind once, where it was
/// first met. An [`Observer`](crate::Observer::warning) is told as soon as they are known.
///
/// The thresholds are a tenth of the body for displacements, 5 % for strains, an edge of a facet for slips, 0.1 for the
/// turn of normals, the body for gaps, 3 for coefficients, 0.45 for Poisson's ratios of linear tetrahedra and 10 % for
/// the error of the mesh. A body is as long as the longest side of the box around it. By them the brick of the
/// benchmark, pressed down by 0.1 m and 3 m long, does not warn of its displacement, as it would from a thirtieth on; it
/// does of its strain, 6 % at the free corner, and of its mesh. Strain is judged tetrahedron by tetrahedron: at clamped
/// edges that of linear theory grows without bound as the mesh is refined.
///
/// Fields: `step` from 0; `node`, `tet` and `contact` are numbers in mesh and scene; `place` in m.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "fields that the sentence of their variant explains have none"
)]
#[non_exhaustive]
pub enum Warning {
    /// The displacement is of the size of the body.
    #[error(
        "step {step}: the displacement of node {node} at {} is {displacement:.3e}, the body is {extent:.3e} \
        long; displacements count as small here, so from a tenth of the body on shapes and forces are wrong: \
        look at the units of loads, material and gaps, and at the supports",
        at(place)
    )]
    LargeDisplacement {
        step: usize,
        node: u32,
        place: [f64; 3],
        /// Its length, m.
        displacement: f64,
        /// Longest side of the box around the body, m.
        extent: f64,
    },
    /// The strain is not small.
    #[error(
        "step {step}: the strain of tetrahedron {tet} at {} is {:.1} %; strains count as small here, up to 5 %: \
        look at the units of loads and material; where it is a corner or a clamped edge alone, its neighbourhood \
        is not to be trusted",
        at(place),
        100.0 * strain
    )]
    LargeStrain {
        step: usize,
        tet: usize,
        /// Its centroid, m.
        place: [f64; 3],
        /// The root of the sum of the squares of all nine strains; at least the largest principal one.
        strain: f64,
    },
    /// A contact point with friction slides past its facets within a step.
    #[error(
        "step {step}: node {node} of contact {contact} at {} slides by {slip:.3e}, its facets are {edge:.3e} \
        long; it keeps the normal and the partner that it began with: take smaller steps, and where the other \
        side is not plane a shorter way",
        at(place)
    )]
    LongSlip {
        step: usize,
        contact: usize,
        node: u32,
        place: [f64; 3],
        /// Way relative to the obstacle or the partner, m.
        slip: f64,
        /// The longest edge of the facets at the node, m.
        edge: f64,
    },
    /// At a point that touches, the displacement has turned the normal of its obstacle.
    #[error(
        "step {step}: node {node} of contact {contact} at {} is displaced to where the normal of its obstacle \
        is another one by {turn:.1} degrees; it keeps the one that it began with, so forces point a little \
        aside there: make the way along the obstacle small against its radius of curvature",
        at(place)
    )]
    TurnedNormal {
        step: usize,
        contact: usize,
        node: u32,
        place: [f64; 3],
        /// Angle between the obstacle's normals at the node's place and at its displaced place, degrees.
        turn: f64,
    },
    /// All of a contact begins further from its obstacle, or deeper inside it, than the body is long.
    #[error(
        "contact {contact} begins {:.3e} {} its obstacle even at the nearest node, {node} at {}, and the body \
        is {extent:.3e} long; look at the unit of the gap and at the places of the bodies",
        gap.abs(),
        if *gap < 0.0 { "inside" } else { "from" },
        at(place)
    )]
    LargeGap {
        contact: usize,
        /// The nearest point.
        node: u32,
        place: [f64; 3],
        /// Of that point, m; negative inside the obstacle.
        gap: f64,
        /// Longest side of the box around the body, m.
        extent: f64,
    },
    /// The coefficient of friction is one that no pair of materials has.
    #[error(
        "friction of contact {contact}: the coefficient at node {node}, {}, is {coefficient}; no pair of \
        materials has so much: {coefficient} in per cent is {}",
        at(place),
        0.01 * coefficient
    )]
    LargeCoefficient {
        contact: usize,
        node: u32,
        place: [f64; 3],
        coefficient: f64,
    },
    /// Materials are listed for regions that the mesh does not have.
    #[error(
        "materials are given for the regions {regions:?}, which the mesh does not have; it has {present:?}: look \
        at the numbers, or leave them out"
    )]
    UnusedMaterials {
        regions: Vec<u32>,
        /// Those that the mesh has.
        present: Vec<u32>,
    },
    /// Linear tetrahedra of a nearly incompressible material bend too little.
    #[error(
        "region {region} has a Poisson's ratio of {poisson} and linear tetrahedra, which hardly bend without a change of \
         volume: displacements come out too small; take quadratic ones (TetMesh::raise_order)"
    )]
    Locking {
        /// Region of the material.
        region: u32,
        /// Its Poisson's ratio.
        poisson: f64,
    },
    /// The estimated error of the mesh is large at the end of a run.
    #[error(
        "step {step}: the mesh leaves an estimated error of {:.0} % in the energy norm, most of it at tetrahedron \
        {tet}, {}; elements are too stiff there, in bending above all linear ones: refine there, and compare",
        100.0 * error,
        at(place)
    )]
    CoarseMesh {
        step: usize,
        /// Estimated error over the displacement, both in the energy norm.
        error: f64,
        /// The tetrahedron with the largest part of it.
        tet: usize,
        /// Its centroid, m.
        place: [f64; 3],
    },
    /// A checkpoint is damaged; the run goes on from the one before.
    #[error(
        "the newest checkpoint is damaged ({reason}); the run goes on from the one before, {}, and the damaged \
        one is kept as {}: look at the disk",
        taken.display(),
        path.display()
    )]
    DamagedCheckpoint {
        /// The damaged file, under the name that it now has.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
        /// The one that was taken.
        taken: PathBuf,
    },
}

/// A place in words.
fn at([x, y, z]: &[f64; 3]) -> String {
    format!("({x:.4e}, {y:.4e}, {z:.4e})")
}
