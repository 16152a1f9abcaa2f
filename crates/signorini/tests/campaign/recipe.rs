//! What a scene of the campaign says, in data of its own: the library's scene is made from it in `say`, and the check
//! computes from it. Neither sees what the other makes of it.

use crate::vec3::{Vec3, across, add, cross, dot, scale, sub, unit};
use signorini::fem_mesh::{FacetTag, TetMesh};

/// A polynomial of second degree of the place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Poly {
    pub(crate) at: Vec3,
    pub(crate) value: f64,
    pub(crate) slope: Vec3,
    pub(crate) bend: f64,
    pub(crate) along: Vec3,
}

impl Poly {
    pub(crate) fn value(&self, x: Vec3) -> f64 {
        let way = sub(x, self.at);
        self.value + dot(self.slope, way) + self.bend * dot(self.along, way).powi(2)
    }
}

/// A factor in time.
#[derive(Debug, Clone)]
pub(crate) enum Course {
    Constant(f64),
    /// Straight lines through points, constant outside.
    Table(Vec<(f64, f64)>),
    /// `size * sin(pace t + phase)`.
    Wave {
        size: f64,
        pace: f64,
        phase: f64,
    },
}

impl Course {
    pub(crate) fn value(&self, time: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Table(points) => line(points, time),
            Self::Wave { size, pace, phase } => size * (pace * time + phase).sin(),
        }
    }
}

impl Course {
    /// So many times as much.
    pub(crate) fn times(self, factor: f64) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(factor * value),
            Self::Table(points) => Self::Table(points.into_iter().map(|(t, v)| (t, factor * v)).collect()),
            Self::Wave { size, pace, phase } => Self::Wave {
                size: factor * size,
                pace,
                phase,
            },
        }
    }
}

/// Straight lines through points of ascending first numbers, constant outside.
pub(crate) fn line(points: &[(f64, f64)], x: f64) -> f64 {
    let (first, last) = (points[0], points[points.len() - 1]);
    if x <= first.0 {
        return first.1;
    }
    for pair in points.windows(2) {
        let [(a, p), (b, q)] = [pair[0], pair[1]];
        if x <= b {
            return p + (q - p) * (x - a) / (b - a);
        }
    }
    last.1
}

/// A load in space.
#[derive(Debug, Clone)]
pub(crate) enum Density {
    Body(Vec3),
    BodyField([Poly; 3]),
    Traction(FacetTag, Vec3),
    /// A vector field, and a pull along the normal.
    TractionField(FacetTag, [Poly; 3], Poly),
    Pressure(FacetTag, f64),
    Nodes(Vec<(u32, Vec3)>),
    /// Strain without stress, in a region or everywhere, times a factor at each node.
    Eigenstrain([f64; 6], Option<u32>, Vec<f64>),
    /// A force, the same on each area of a tag.
    Force(FacetTag, Vec3),
    /// A moment without a force, as a traction that grows from the centroid of a tag.
    Moment(FacetTag, Vec3),
}

#[derive(Debug, Clone)]
pub(crate) struct Push {
    pub(crate) density: Density,
    pub(crate) course: Course,
}

/// Directions that a support fixes.
#[derive(Debug, Clone)]
pub(crate) enum Fixed {
    All,
    Components([bool; 3]),
    Vectors(Vec<Vec3>),
    /// Of the radial, tangential and axial direction about an axis through a point, a unit vector, along which
    /// displacements are given, too.
    About(Vec3, Vec3, [bool; 3]),
    /// Vectors of each node.
    Each(Vec<Vec<Vec3>>),
}

impl Fixed {
    /// As vectors, not of length one, of the node with a place in the list that is at `x`.
    pub(crate) fn vectors(&self, place: usize, x: Vec3) -> Vec<Vec3> {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        match self {
            Self::All => axes.to_vec(),
            Self::Components(on) => (0..3).filter(|&c| on[c]).map(|c| axes[c]).collect(),
            Self::Vectors(list) => list.clone(),
            Self::About(point, axis, on) => {
                let axes = around(*point, *axis, x);
                (0..3).filter(|&c| on[c]).map(|c| axes[c]).collect()
            }
            Self::Each(lists) => lists[place].clone(),
        }
    }
}

/// The radial, tangential and axial direction at a place.
pub(crate) fn around(point: Vec3, axis: Vec3, x: Vec3) -> [Vec3; 3] {
    let radial = unit(across(sub(x, point), axis));
    [radial, cross(axis, radial), axis]
}

#[derive(Debug, Clone)]
pub(crate) enum Where {
    Tag(FacetTag),
    Nodes(Vec<u32>),
}

/// A support.
#[derive(Debug, Clone)]
pub(crate) struct Hold {
    pub(crate) place: Where,
    pub(crate) fixed: Fixed,
    /// One displacement, or one a node, and their factor in time.
    pub(crate) motion: Option<(Vec<Vec3>, Course)>,
}

impl Hold {
    /// Its nodes, those of a tag ascending.
    pub(crate) fn nodes(&self, mesh: &TetMesh) -> Vec<u32> {
        match &self.place {
            Where::Nodes(nodes) => nodes.clone(),
            Where::Tag(tag) => {
                let facets = mesh.facets().iter().enumerate().filter(|f| f.1.tag == *tag);
                let of = |(k, f): (usize, &signorini::fem_mesh::Facet)| {
                    f.nodes.into_iter().chain(mesh.facet_mids(k).into_iter().flatten())
                };
                let mut nodes: Vec<u32> = facets.flat_map(of).collect();
                nodes.sort_unstable();
                nodes.dedup();
                nodes
            }
        }
    }

    /// Its displacement at the node with a place in the list.
    pub(crate) fn displacement(&self, place: usize, x: Vec3, time: f64) -> Vec3 {
        let Some((values, course)) = &self.motion else {
            return [0.0; 3];
        };
        let value = if values.len() == 1 { values[0] } else { values[place] };
        let value = value.map(|v| v * course.value(time));
        match &self.fixed {
            Fixed::About(point, axis, _) => {
                let axes = around(*point, *axis, x);
                (0..3).fold([0.0; 3], |sum, c| add(sum, scale(value[c], axes[c])))
            }
            _ => value,
        }
    }
}

/// How far the obstacle is.
#[derive(Debug, Clone)]
pub(crate) enum Distance {
    Touching,
    Constant(f64),
    Field(Poly),
    /// A point of a plane and the normal out of the obstacle, of length one.
    Plane(Vec3, Vec3),
    /// What coordinates say, between bodies.
    Measured,
}

/// A friction law.
#[derive(Debug, Clone)]
pub(crate) enum Law {
    None,
    Given(f64),
    GivenField(Poly),
    Coulomb(f64),
    CoulombField(Poly),
    Exponential {
        fixed: f64,
        kinetic: f64,
        decay: f64,
    },
    Table(Vec<(f64, f64)>),
    /// A coefficient of the place that falls to its half at a slip rate.
    RateField(Poly, f64),
}

impl Law {
    pub(crate) fn is_some(&self) -> bool {
        !matches!(self, Self::None)
    }

    /// Slip bound in newtons of a node at `x` with an area, pressed by `force`, that slid at a rate before.
    pub(crate) fn bound(&self, x: Vec3, area: f64, force: f64, rate: f64) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Given(stress) => stress * area,
            Self::GivenField(stress) => stress.value(x) * area,
            Self::Coulomb(value) => value * force,
            Self::CoulombField(field) => field.value(x) * force,
            Self::Exponential { fixed, kinetic, decay } => {
                (kinetic + (fixed - kinetic) * (-rate / decay).exp()) * force
            }
            Self::Table(points) => line(points, rate) * force,
            Self::RateField(field, half) => field.value(x) / (1.0 + rate / half) * force,
        }
    }
}

/// A contact surface.
#[derive(Debug, Clone)]
pub(crate) struct Touch {
    pub(crate) tags: Vec<FacetTag>,
    pub(crate) partner: Option<FacetTag>,
    pub(crate) distance: Distance,
    /// One direction for all nodes, of length one, into the obstacle.
    pub(crate) direction: Option<Vec3>,
    pub(crate) motion: Option<(Vec3, Course)>,
    pub(crate) law: Law,
}

impl Touch {
    /// Displacement of the obstacle.
    pub(crate) fn carried(&self, time: f64) -> Vec3 {
        match &self.motion {
            Some((way, course)) => way.map(|v| v * course.value(time)),
            None => [0.0; 3],
        }
    }
}

#[derive(Debug, Clone)]
pub(crate) enum Pieces {
    Whole,
    Boxes([usize; 3]),
    Parts(Vec<u32>),
}

/// Time levels; `weights` are those of the new level, the last and the one before.
#[derive(Debug, Clone)]
pub(crate) enum Clock {
    Static(f64),
    Steps { times: Vec<f64>, weights: Vec3 },
}

impl Clock {
    pub(crate) fn times(&self) -> Vec<f64> {
        match self {
            Self::Static(time) => vec![*time],
            Self::Steps { times, .. } => times.clone(),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Solver {
    Face,
    Paper,
    OneLoop,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Ending {
    Tolerance(f64),
    Relative(f64),
    Balanced(f64),
}

/// How it is to be solved.
#[derive(Debug, Clone)]
pub(crate) struct How {
    pub(crate) solver: Solver,
    pub(crate) ending: Ending,
    /// 0 lumped, 1 Dirichlet, 2 none.
    pub(crate) preconditioner: usize,
    pub(crate) extrapolate: bool,
    pub(crate) share: bool,
    /// After so many levels the run goes on in another simulation.
    pub(crate) resume: Option<usize>,
    /// Products after which a step fails, and how often it may be halved then.
    pub(crate) halving: Option<(usize, u32)>,
}

impl How {
    pub(crate) fn is_default(&self) -> bool {
        self.solver == Solver::Face
            && self.ending == Ending::Tolerance(1e-6)
            && self.preconditioner == 0
            && self.extrapolate
            && self.share
            && self.resume.is_none()
            && self.halving.is_none()
    }
}

/// Elasticity of a region: the isotropic law by its two numbers, or the matrix (xx, yy, zz, yz, xz, xy).
#[derive(Debug, Clone)]
pub(crate) enum Elastic {
    Isotropic(f64, f64),
    Matrix(Box<[[f64; 6]; 6]>),
}

/// A scene and how it is to be solved.
#[derive(Debug, Clone)]
pub(crate) struct Recipe {
    pub(crate) mesh: TetMesh,
    /// Elasticity of each region; one for all if there is one only.
    pub(crate) elastic: Vec<Elastic>,
    pub(crate) holds: Vec<Hold>,
    pub(crate) pushes: Vec<Push>,
    pub(crate) touches: Vec<Touch>,
    pub(crate) pieces: Pieces,
    pub(crate) clock: Clock,
    pub(crate) how: How,
    /// Features in words.
    pub(crate) words: Vec<String>,
}
