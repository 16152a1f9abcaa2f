//! The numerical judgements of this crate, in one table: what each is relative to, and why it has this value.

// Meshes

/// Six times the volume over the cube of the longest edge, below which a tetrahedron is flat. Coordinates carry about
/// 16 digits, so less than this is mostly rounding.
pub(crate) const FLAT_TET: f64 = 1e-10;
/// Distance over the diagonal of the mesh below which two nodes are one, and over the last digit of its largest
/// coordinate.
pub(crate) const COINCIDENT: f64 = 1e-12;
pub(crate) const LAST_DIGIT: f64 = 4.0 * f64::EPSILON;
/// Sine of the angle between normal and x axis below which the y axis is projected for the first tangent.
pub(crate) const NEARLY_PARALLEL: f64 = 0.01;
/// Length of the mean normal of the triangles around a node, over one for a plane, below which it has no normal.
pub(crate) const NO_NORMAL: f64 = 1e-6;
/// Distance of a mid-node from the middle of its edge, over the edge's length, above which it is off: at a quarter
/// along the edge the map of the tetrahedron is singular at a corner.
pub(crate) const MID_OFF: f64 = 0.25;
/// Least volume of a curved tetrahedron per volume of the straight one of its corners, where it is looked at: less is
/// inside out, or nearly so.
pub(crate) const CURVED: f64 = 1e-3;
/// How far outside of a tetrahedron a point may be, in barycentric coordinates, and still count.
pub(crate) const OUTSIDE: f64 = 1e-9;
/// Newton steps to the coordinates of a place in a curved tetrahedron, the change of coordinates that is none, and that
/// up to which the method has converged: far from the origin rounding leaves some, where it runs in circles a tenth.
pub(crate) const PLACINGS: usize = 20;
pub(crate) const PLACED: f64 = 1e-13;
pub(crate) const CONVERGED: f64 = 1e-6;

// Materials

/// Deviation from symmetry over the largest entry that is rounding.
pub(crate) const ASYMMETRY: f64 = 1e-9;
/// Smallest over largest eigenvalue below which a tensor is not elliptic.
pub(crate) const ELLIPTICITY: f64 = 1e-12;

/// Poisson's ratio above which quadratic elements take the mean of the volume strain: at 0.45 plain ones begin to lock
/// and need more products.
pub(crate) const INCOMPRESSIBLE: f64 = 0.4;

// Parts made compact

/// Most sweeps, and the share of tetrahedra that a sweep has to move for another one. What moves last is at plane
/// interfaces.
pub(crate) const MOST_SWEEPS: usize = 40;
pub(crate) const SWEEP_MOVES: f64 = 1e-3;
/// Part of a slab's tetrahedra by which its end may move to a gap between layers of tetrahedra.
pub(crate) const SNAP: f64 = 0.15;
/// Part of its box that a body fills at least to be cut into a grid of about so many cubes, and the edges of cubes that
/// are tried: so many steps of two per cent more and less than the edge that the number asks for.
pub(crate) const FILLED: f64 = 0.98;
pub(crate) const EDGE_STEPS: i32 = 6;
/// Volume of a box around a body over that of its box along the axes of coordinates below which it is cut along the
/// former, and the part of its longest edge below which coordinates there are equal.
pub(crate) const OBLIQUE: f64 = 0.9;
pub(crate) const SAME_PLACE: f64 = 1e-9;
/// Components of unit normals that are one, of facets that make a plane face: files have nine digits.
pub(crate) const ONE_FACE: f64 = 1e-6;
/// Part of its box that a part fills which is a box but for rounding.
pub(crate) const BOX: f64 = 1.0 - 1e-6;
/// How much longer some cells are along an axis than others, each relative to itself, where a mesh is graded along it:
/// the ratio of the quantiles at 0.95 and 0.05. Meshes of Gmsh have 1.8 to 2.1.
pub(crate) const GRADED: f64 = 2.5;
/// The same ratio along all three axes above which the parts of a box are so many times larger: between flat cells many
/// parts are flat, too, and take ten times the iterations.
pub(crate) const STRONGLY: f64 = 10.0;
pub(crate) const LARGER: usize = 6;
/// How many times as long as thick a rod is that is cut in lengths. Beams on floors, clamped and pulled, of 35, 20, 15
/// and 7 take 1/10, 1/10, 1/7 and 1/3 of the products in lengths of one and a half to two, plates hardly fewer.
pub(crate) const ROD: f64 = 8.0;
/// Tetrahedra that lengths of rods have at least, linear and quadratic ones. Leaves of a spring two cells wide take a
/// quarter of the products in lengths of 20 as in those of 10.
pub(crate) const ROD_TETS: usize = 30;
pub(crate) const ROD_QUADRATIC: usize = 20;
/// Volume of a rod over the square of its thickness and the longest edge of its box up to which it is one, for bent
/// rods, oblique ones, and such as are wider than thick: where the box is about as wide as long, and else. Rings have
/// three; to cut them gains nothing.
pub(crate) const ROD_BEND: f64 = 2.5;
pub(crate) const STRAP_BEND: f64 = 6.0;
/// Width of a box over its length from which on it may be that of a ring.
pub(crate) const ROUND: f64 = 0.75;
/// Part of a slab by which its end may move to a plane between layers of graded cells: a ragged cut through long cells
/// costs more than parts of unequal size.
pub(crate) const PLANE: f64 = 0.5;

// Parts of a mesh

/// Most tables of local numbers, each as long as the mesh has nodes: useful threads.
pub(crate) const TABLES: usize = 16;

/// Cosine of the angle, with the sign turned, from which normals of facets face each other, as on both sides of a
/// crack. A bend of a thin body has less.
pub(crate) const FACING: f64 = 0.7;
/// Distance of facets that face each other, over the size of a facet, up to which they are a crack: a slot as thin as
/// that makes a neck as well.
pub(crate) const CRACK: f64 = 0.5;
/// The same behind a facet, where rounding may put the other one.
pub(crate) const BEHIND: f64 = 1e-6;
/// Tetrahedra of a piece over those of its part up to which it joins a neighbour.
pub(crate) const SMALL_PIECE: f64 = 0.1;
/// Area of a crack within a part, over that of the neck around its tip, from which the part is split. A penny-shaped
/// crack in a block of 1 to 100 parts: with 0.1 to 0.25 34 to 88 products, never split 621 in 27 parts, always split 48
/// in one.
pub(crate) const NECK: f64 = 0.2;

// Means on surfaces

/// Sine of the angles between the normals of a facet below which it is plane: files have nine digits.
pub(crate) const PLANE_FACET: f64 = 1e-9;
/// Weight of a node in a mean that counts as none.
pub(crate) const NO_WEIGHT: f64 = 1e-13;

// Recovered strains

/// Tetrahedra below which a patch is joined with those of the neighbours: a linear polynomial has four coefficients.
pub(crate) const SMALL_PATCH: usize = 8;
/// Smallest over largest pivot below which a fit is not trusted.
pub(crate) const FIT_PIVOT: f64 = 1e-6;

// Wanted sizes

/// Most by which one estimate makes tetrahedra smaller, and larger. Farther the estimate of a coarse mesh does not
/// reach.
pub(crate) const REFINED: f64 = 4.0;
pub(crate) const COARSENED: f64 = 2.0;
/// Most by which wanted edges grow over a distance, relative to it. Tetrahedra twice as large as their neighbours are
/// slivers.
pub(crate) const EDGE_GROWTH: f64 = 0.5;

// Series of files

/// Difference of times over the time below which a step of a series is the one asked for.
#[cfg(feature = "vtu")]
pub(crate) const SAME_TIME: f64 = 1e-9;

/// Distance from an axis, over that from a point of the axis, up to which a place lies on the axis, and has no radial
/// direction: files have nine digits.
pub(crate) const ON_AXIS: f64 = 1e-9;
