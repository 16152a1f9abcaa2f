//! The numerical judgements of the crate, in one table: what each is relative to, and why. Numbers of rounds and
//! weights of a cost stand where they are used.

// ---- all folders ----

/// What was computed twice, or from data of this size, differs by rounding only: directions, positions, lengths of
/// loads, forces of subdomains in balance, sums of a difference formula. Relative to the larger one; of positions, to
/// the largest coordinate.
pub(crate) const ROUNDING: f64 = 1e-12;

/// Forces are measured against this part of displacement times stiffness at least: what is left of a rigid motion are
/// rounding errors, 1e-16 of that product.
pub(crate) const FORCE_ROUNDING: f64 = 1e-8;

/// Rounding of forces over displacement times stiffness, below which no solver gets: what it is asked for is not
/// smaller.
pub(crate) const REACHED: f64 = 1e-14;

/// Gap of contacts that are not to close, over the largest displacement that loads and supports make in rows.
pub(crate) const OPENED: f64 = 1e6;

/// Part of the earlier sizes that a vanishing quantity is measured against.
pub(crate) const REST: f64 = 1e-3;

// ---- steps in time (scene, model) ----

/// Factor of a load, over its largest at any step, up to which it is what rounding leaves of zero: a sine has 1e-16 of
/// its amplitude where it vanishes. Forces that small have no size that a solver could be accurate to.
pub(crate) const NO_LOAD: f64 = 1e-12;

/// Steps are equal whose lengths differ by less, relative to the longer one.
pub(crate) const UNEQUAL: f64 = 1e-9;

// ---- contact points, partners, supports, sizes (discrete) ----

/// Largest force in N, displacement and gap in m. The squares of their products are formed (friction times slip): at
/// most 1e308, so this leaves 28 digits for stiffness and sums.
pub(crate) const LARGEST: f64 = 1e70;

/// Cosine to the outward normal below which a direction counts as along the surface.
pub(crate) const ALONG: f64 = 1e-9;

/// Distance of the reference point of a coupling over that of its nodes from one another up to which its motions are
/// told apart: what rounding leaves of a rotation is 1e-10 there.
pub(crate) const FAR: f64 = 1e6;

/// Cosine above which two directions of contact are one: 1.4e-6 radians. Rows of larger angles are solved for apart, at
/// any angle. Within smaller ones a node would have twice the same row, and one condition keeps the other to 1.4e-6 of
/// the way along the surface, which the certificate sees.
pub(crate) const SAME_NORMAL: f64 = 1.0 - 1e-12;

/// Cosine over that of the angle of a crease up to which facets meet at one: hexagons do at the default one.
pub(crate) const TO_CREASE: f64 = 1e-9;

/// Steps of Newton's method from a node to an obstacle along the normal: those of a smooth shape take ten.
pub(crate) const NEWTON: usize = 50;

/// Rounding of a distance to an obstacle, over the distances and lengths that it is made of.
pub(crate) const RAY: f64 = 1e-13;

/// Distance from an edge of the surface of an obstacle, over the edge of its facet, up to which a place is on it: files
/// have nine digits.
pub(crate) const RIM: f64 = 1e-9;

/// Cosine between two facets of an obstacle, or the normals of two contacts at a node, below which their edge is sharp:
/// beyond it their sides end.
pub(crate) const SHARP: f64 = 0.9;

/// Cosine between a direction and the way to an obstacle of a function below which the place is taken to be beside it.
pub(crate) const SIDEWAYS: f64 = 0.9;

/// What the mean of a gap that is given goes beyond its values at the nodes, and what it is off the value in the
/// middle, over the range of the former, from which on the gap jumps between nodes.
pub(crate) const OVERSHOT: f64 = 0.02;
pub(crate) const JUMP: f64 = 0.25;

/// Distance to the continuation of a side over that to the obstacle, up to which nothing of the obstacle is met there.
pub(crate) const ENDED: f64 = 0.9;

/// Distance that is left of the way to an obstacle, over the shortest one, up to which the way that led there is better
/// than the shortest distance: rounding of coordinates may leave more than [`RAY`] of a small gap.
pub(crate) const RAY_END: f64 = 0.01;

/// Part of the way along a normal that must lead towards an obstacle to reach it.
pub(crate) const STEEP: f64 = 0.05;

/// How far the gradient of a signed distance may be from a unit vector: that of a distance which is interpolated is a
/// little, that of another function is not near.
pub(crate) const GRADIENT: f64 = 1e-3;

/// How far the change of what is given as a distance may be from the way along its gradient, over that: of one that is
/// interpolated, or nearly one, it is a little; squares, multiples and other units are not near.
pub(crate) const DISTANCE: f64 = 0.1;

/// That way, over the root of the area of the contact: less than a facet, and much more than the errors of distances
/// that are found by iteration.
pub(crate) const DISTANCE_WAY: f64 = 1e-3;

/// What a step along a distance leaves of the part that the one before left, at most, if they are Newton's: a half at
/// twice the radius from a sphere, of a multiple all; and how many steps are looked at: each halves a large distance.
pub(crate) const FASTER: f64 = 0.7;
pub(crate) const FEW_STEPS: usize = 10;

/// Part of an axis of friction that must lie along the surface to give a direction there.
pub(crate) const AXIS: f64 = 1e-3;

/// Angle by which normals may turn over the way of a gap field along a surface, radians: the gap is then known to a
/// twentieth of the way.
pub(crate) const TURN: f64 = 0.1;

/// Distance of a partner from the normal that is allowed, over the size of the facets (the root of the area of a node).
pub(crate) const BESIDE: f64 = 0.02;

/// What is allowed more, over the gap: the normals of curved surfaces are those of facets.
pub(crate) const TILT: f64 = 0.1;

/// The most of that, over the size of the facets.
pub(crate) const MOST_TILT: f64 = 0.2;

/// Cosine between a normal and that of the other side, or of an obstacle, reversed above which they face each other.
pub(crate) const FACING: f64 = 0.1;

/// Mean area of the facets of a side over that of the other from which on it is the coarser one.
pub(crate) const COARSER: f64 = 1.1;

/// Shear modulus of a body over that of the other from which on it leaves the points to the other where it reaches
/// beyond that: thousands of products otherwise.
pub(crate) const HARDER: f64 = 10.0;

/// Part of the area of a facet or node below which what covers it counts as nothing.
pub(crate) const COVERED: f64 = 1e-10;

/// The same of a node whose shape function others have instead: the other side ends within a tenth of a facet beside
/// them, and rows there nearly depend on one another; SMALSE took ten thousand products.
pub(crate) const SLIVER: f64 = 0.05;

/// How much the pieces that cover a facet may overlap, over its area: those of a curved surface do a little.
pub(crate) const OVERLAP: f64 = 0.05;

/// How far a gap rises over a quadratic facet, over the root of its area, from which on it opens; and how far it is
/// from linear at mid-nodes, over that rise, up to which it does so linearly.
pub(crate) const OPENING: f64 = 1e-3;
pub(crate) const LINEAR: f64 = 0.05;

/// Second moment of a covered part below which it has no extent, over that along it.
pub(crate) const NO_EXTENT: f64 = 1e-13;

/// Distance from the border of what covers a facet, over the length of the way there, up to which a place is on it.
pub(crate) const AT_BORDER: f64 = 1e-9;

/// Distance of a mid-node from the middle of its edge, over the size of the facet, from which on the edge is bent.
pub(crate) const BENT: f64 = 1e-9;

/// Steps of Newton's method to a place in a facet with bent edges: quadratic, from an edge that is bent by a fifth.
pub(crate) const BENT_STEPS: usize = 6;

/// Weight of a node in a side that counts as none, over the largest.
pub(crate) const NO_WEIGHT: f64 = 1e-13;

/// Square of the distance of nodes from the axis that they are turned about, over that of the way to the other side,
/// from which on they carry the couple: its forces are no larger than the one that it is of.
pub(crate) const SHORT_LEVER: f64 = 1.0;

/// Depth of a supported node in an obstacle that counts, over its displacement or gap; what supports may say differently
/// of the sides of a tie, likewise: data of others have few digits.
pub(crate) const DEPTH: f64 = 1e-9;
pub(crate) const PARTED: f64 = 1e-4;

/// How far nodes that a support holds where an earlier step has left them may be off, over their largest displacement:
/// what solvers with large tolerances leave.
pub(crate) const LEFT_OFF: f64 = 1e-3;

/// What is left of a direction that other supports hold already: sine of the angle up to which two normals of facets in
/// one plane are one, as in `signorini-tfeti`.
pub(crate) const HELD_ALREADY: f64 = 1e-4;

/// Motion in a direction that a support does not hold, over its largest one, that is no mistake but what is left of
/// turned axes.
pub(crate) const NOT_MOVED: f64 = 1e-9;

// ---- equilibrium of free bodies (model) ----

/// Work on a free motion below this part of the size of the loads, or of a contact force, is rounding.
pub(crate) const FREE_WORK: f64 = 1e-9;

/// Length of the motion of a body, over that of the body that slides away, from which on a report names it as moving
/// with that body.
pub(crate) const ALONGSIDE: f64 = 0.5;

/// Motion that a coupling leaves free, over the largest of them, from which on a report names it.
pub(crate) const LEFT_FREE: f64 = 0.1;

/// What contact forces leave of loads of length one, below which it is rounding.
pub(crate) const WRENCH_RESIDUAL: f64 = 1e-8;

/// By how much a point that stays closed along a motion of the cone may miss to open by the coefficient times the slip,
/// relative to the motion, which is found to [`LEVERAGE`].
pub(crate) const SLIDING: f64 = 1e-3;

/// Least length that is left of a motion of length one when its opening part is taken out, or of forces that lack for
/// balance when pressure is: a shorter rest does not tell where the body slides.
pub(crate) const SLIDES: f64 = 0.5;

/// Singular values below this part of the largest count as zero where contact forces are found.
pub(crate) const WRENCH_RANK: f64 = 1e-13;

/// Columns of contact forces that differ from those before them by less than this part of the largest are left to
/// singular values: QR loses the digits that differences of such columns lack.
pub(crate) const WRENCH_APART: f64 = 1e-8;

/// Contact forces below this part of the largest leave.
pub(crate) const WRENCH_FACTOR: f64 = 1e-14;

/// Loads that would need contact forces that many times their own size count as not held.
pub(crate) const LEVERAGE: f64 = 1e5;

/// Part by which loads must exceed Tresca friction to count.
pub(crate) const TRESCA_EXCESS: f64 = 1e-6;

/// Largest factor on friction that a remedy names.
pub(crate) const MOST_FRICTION: f64 = 1e3;

/// Accuracy of the factor of friction that is named, relative.
pub(crate) const FRICTION_FACTOR: f64 = 1e-4;

// ---- the duality gap (estimate) ----

/// Freedom of a node (3 without supports) that supports take counts above this.
pub(crate) const FREEDOM_TAKEN: f64 = 1e-8;

/// Relative change of a slip bound that is judged by the stiffness of the node. Larger ones move the whole body, and
/// the gap, which overrates small changes, is the safer measure.
pub(crate) const NEAR_BOUND: f64 = 0.01;

/// Planes of one node are parallel below this singular value over the largest.
pub(crate) const PARALLEL: f64 = 1e-6;

/// Elastic energy that may be rounding, relative to that of all nodes moved alone: that of a body that moves without
/// strain is a difference of numbers this much larger, or more.
pub(crate) const NO_STRAIN: f64 = 1e-12;

// ---- tolerances chosen by estimates (state, simulation) ----

/// Tolerance of the first solve of the first step where estimates choose. A looser one saves little and may end before
/// slip bounds have settled.
pub(crate) const LOOSEST: f64 = 1e-3;

/// The smallest tolerance a solver is asked for there.
pub(crate) const TIGHTEST: f64 = 1e-12;

/// Solves of one step there.
pub(crate) const ROUNDS: usize = 8;

/// What is missing is exceeded by this factor there, so that one more round is usually enough.
pub(crate) const MARGIN: f64 = 0.5;

/// Range of the factor by which a tolerance is tightened there.
pub(crate) const TIGHTENING: [f64; 2] = [1e-3, 0.3];

/// A smaller discretisation error, relative, counts as this.
pub(crate) const EXACT_MESH: f64 = 1e-6;

/// Violation of the contact conditions that is accepted, over the target, and the range of it.
pub(crate) const CONTACT_LIMIT: f64 = 5.0;
pub(crate) const CONTACT_LIMITS: [f64; 2] = [1e-8, 1e-2];

/// Factor in the elastic energy from which on the discretisation error is estimated again.
pub(crate) const CHANGED: f64 = 4.0;

// ---- rounds of a step and orders in time (simulation) ----

/// Largest certificate of a converged step over the tolerance.
pub(crate) const CERTIFIED: f64 = 30.0;

/// Aim of a second round, as a fraction of the tolerance.
pub(crate) const NEXT_AIM: f64 = 0.3;

/// Most by which the tolerance of a round falls below that of the round before.
pub(crate) const NEXT_TOLERANCE: f64 = 0.01;

/// Smallest tolerance that is tried for a certificate, and the certificate that rounding leaves.
pub(crate) const LEAST_TOLERANCE: f64 = 1e-10;

/// Differences of runs are time error, and not the solver's, from this many times the solver's errors on.
pub(crate) const ABOVE_SOLVER: f64 = 3.0;

/// Orders of the time steps that are believed: below, the steps have not settled into a sequence of sticking and
/// sliding, and no more than the upper one is in the formulas.
pub(crate) const ORDERS: [f64; 2] = [0.5, 2.5];

// ---- solvers (solve) ----

/// Estimated error of the multipliers, over the tolerance of a step, at which conjugate gradients stop without contact:
/// no condition but continuity is left to them, and what copies differ by, over the largest displacement, is a
/// thirtieth of that error and less in compact bodies. The certificate tells where it is not, as in thin ones.
pub(crate) const LINEAR_SLACK: f64 = 15.0;
/// The most that it may be: beyond, nothing is solved.
pub(crate) const LINEAR_AT_MOST: f64 = 0.5;

/// Products of a step that never count as effort: with the inverse of a formed F a step with hard contact takes as
/// many.
pub(crate) const EASY: usize = 200;
/// Products beyond those for which forming F does not pay, however small it is.
pub(crate) const LITTLE: usize = 300;
/// Complementarity to which interior points are followed for a start of active sets: rounding of a load that holds the
/// weight of the equality.
pub(crate) const INSIDE: f64 = 1e-18;
/// What forming F and a step with its inverse may cost, in products, to be tried as soon as predictions run in circles.
pub(crate) const AT_ONCE: usize = 3000;
/// Active sets without progress from which on predictions run in circles, and from which on, with that inverse,
/// interior points look for another start: at once where these cost few products.
pub(crate) const CIRCLES: usize = 12;
pub(crate) const BEFORE_INSIDE: usize = 3;
/// Products of a step with that inverse after which it does not help: a set takes two or three.
pub(crate) const EXPLICIT_PRODUCTS: usize = 1000;

/// Stiffness of a row with all other unknowns held over that with its subdomain free, above which the natural map takes
/// this multiple of the latter. In well shaped, compressible bodies it is 1 to 4; a natural map that is much too stiff
/// predicts active sets from gradients alone.
pub(crate) const STIFF_ROWS: f64 = 5.0;
/// The same in a linear mesh that is strongly graded along all axes: above 3 active sets ran in circles there, from 1
/// to 3 products are much the same.
pub(crate) const STIFF_GRADED: f64 = 2.5;
/// The same in a mesh of order 2, where points are means that share nodes and move one another. From 1 to 2.5 products
/// are much the same on equal cells; on graded ones they grow with it.
pub(crate) const STIFF_MEANS: f64 = 1.0;

/// Difference of the distances of facets over one place, over the size of the facet that sees them, from which on they
/// are layers, of which the nearest counts.
pub(crate) const LAYERS: f64 = 1e-3;

/// Largest ratio of friction along and across its axis: beyond, solves were seen to break down.
pub(crate) const MOST_STRETCH: f64 = 1e3;

/// Part of the stiffness that the natural map takes at rows that may depend on others of their node: two rows along one
/// direction move it twice.
pub(crate) const SHARED_ROWS: f64 = 0.5;

/// Part of the largest displacement from which on an overlap at nodes that contacts hand on is told.
pub(crate) const EDGE_OVERLAP: f64 = 0.01;

/// Differences of gaps around a node, over the root of its area, up to which sides are flush there.
pub(crate) const FLUSH: f64 = 1e-6;

/// Part of the way by which sides have closed from which on an overlap of nodes of quadratic facets is told.
pub(crate) const NARROW: f64 = 0.1;

/// What a release would change, over the error of a solved active set, from which on it is worth it.
pub(crate) const CONTRADICTION: f64 = 10.0;

/// Safety factor between the tolerance of a step and those of SMALSE.
pub(crate) const SMALSE_SAFETY: f64 = 0.05;

/// Tolerance of a Tresca problem over the last relative change of the fixed point, and the loosest one.
pub(crate) const INNER_FACTOR: f64 = 0.1;
pub(crate) const INNER_LOOSEST: f64 = 1e-3;

/// Relative changes below this one that do not halve are put down to the inner solve.
pub(crate) const INNER_STALL: f64 = 1e-4;

/// A point within rounding of its bound.
pub(crate) const AT_BOUND: f64 = 1.0 - 1e-9;

/// Singular values below this part of one count as zero.
pub(crate) const NULL_RANK: f64 = 1e-9;

/// Parts of the last loads that tell where bodies stand that nothing loads any more, each a tenth of the one before.
pub(crate) const PARTS_LEFT: [f64; 3] = [1e-2, 1e-3, 1e-4];

/// What a tenth of the loads leaves of contact forces that vanish with them is a tenth, but for sets that change.
pub(crate) const VANISHING: f64 = 0.15;

/// What a tenth of the loads leaves at least of contact forces that friction locks.
pub(crate) const LOCKED: f64 = 0.5;

/// What no target of a place determines counts as determined this little, over what they determine best.
pub(crate) const WEAKLY_PLACED: f64 = 1e-4;

/// Products of the fall-back between two looks at the balance of bodies that friction does not seem to hold; what may
/// be left after two of the imbalance before them to go on. Where other normal forces hold them 1e-4 of the loads is
/// left after the first, where none do 0.01 to 0.7 in the end.
pub(crate) const BALANCING: usize = 100;
pub(crate) const IMBALANCE_FALLS: f64 = 0.9;
/// Imbalance over the loads below which forces hold the bodies.
pub(crate) const NEAR_BALANCE: f64 = 1e-3;

/// Length over thickness of a subdomain from which on its bending costs products: of a strap on a drum parts of 6
/// took 784, of 11 and 16 up to 19,000, and one of 22 all that there were.
pub(crate) const SLENDER: f64 = 10.0;

// ---- points and accumulated errors (result, report) ----

/// Part of all forces that a vanishing contact force is measured against.
pub(crate) const SMALL_FORCE: f64 = 1e-4;

/// Part of the slip bound from which friction counts as on it.
pub(crate) const ON_BOUND: f64 = 1.0 - 1e-5;

/// Smallest share of a step in the square of the error, relative to an equal share.
pub(crate) const LEAST_SHARE: f64 = 0.25;

// ---- warnings (plan, result) ----

/// Displacement over the longest side of the box around the body from which on it is not small.
pub(crate) const LARGE_DISPLACEMENT: f64 = 0.1;

/// Rotation of a body, radians, from which on it is not small: forces keep directions that turn by it, and lengths err
/// by half its square. A shaft of 60 cells around rolls so far until the next nodes touch.
pub(crate) const LARGE_TURN: f64 = 0.05;

/// Strain from which on it is not small: what is left out is its square, 0.25 %, and more where bodies turn.
pub(crate) const LARGE_STRAIN: f64 = 0.05;

/// Slip of a step, between bodies of all, over the longest edge of the facets at the node from which on the point is
/// past them.
pub(crate) const LONG_SLIP: f64 = 1.0;

/// Part of what loads do along a motion, over what they do along all of the body, below which it does not matter; and of
/// the former from which on it is told that normal forces hold it by the tilt of facets, or from the first one on where
/// all pressed points slide.
pub(crate) const TILT_MATTERS: f64 = 0.01;
pub(crate) const HELD_BY_TILT: f64 = 0.2;

/// Of a motion of bodies that slide wherever they are pressed: what normals and slip across it block, over what they
/// block of others, up to which it is neutral (elastic slip turns by a thousandth); and the least way that it has, over
/// the longest slip, from which on it is told.
pub(crate) const NEUTRAL: f64 = 1e-4;
pub(crate) const NEUTRAL_WAY: f64 = 0.5;

/// Distance of the nearest point of a contact, over the longest side of the box around the body, above which it is
/// rather a mistake in units.
pub(crate) const LARGE_GAP: f64 = 1.0;

/// Overlap of bodies that nobody told, over that, above which it is rather one of their places: press fits have a
/// thousandth, and steel yields before it is strained by a hundredth.
pub(crate) const LARGE_OVERLAP: f64 = 0.01;

/// Overlaps over [`ROUNDING`] that coordinates written with eleven digits make; they are closed without a word.
pub(crate) const DIGITS: f64 = 30.0;

/// Distance of facets from the curve that they stand for, over an overlap measured between them, above which that is
/// not known: with a tenth a ring of 40 on a shaft of 60 cells around has 4 % too much pressure, and up to 70 % at
/// points.
pub(crate) const FACETED: f64 = 0.1;

/// How far sides may be inside one another in the mean, over what facets of a hollow side make of their gaps, so that
/// they touch but for these; and how deep the deepest point may be over that at the worst place. Of 72 touching rings
/// of cells uneven by 10 to 30 % 70 are closed, and so are bores, cones, tori and sockets as Gmsh meshes them; round
/// fits press from a quarter of a sagitta on.
pub(crate) const TOUCHING: f64 = 0.35;
pub(crate) const DEEP: f64 = 3.0;
/// Height of an arc over the edge that stands for it below which gaps are measured to it: of eleven edges around a
/// circle and more; fewer are those of a prism.
pub(crate) const FLAT_ARC: f64 = 0.075;
/// Error of an arc that the normals of uneven facets tell, over the arc.
pub(crate) const ARC_ERROR: f64 = 0.1;
/// Tilt of the normal at one end of an edge over that at the other end, below which the edge is between flat sides.
pub(crate) const KINK: f64 = 0.3;
/// Square of what a coefficient of a paraboloid adds to the others, over all that it is, above which nodes tell it.
pub(crate) const TOLD: f64 = 1e-3;

/// Poisson's ratio above which linear tetrahedra lock: at 0.45 a clamped brick of four cells across has lost a tenth of
/// its deflection. Also that of rubber, which gives way along the surface between points on another side.
pub(crate) const LOCKING: f64 = 0.45;

/// Coefficient of friction above which it is rather one in per cent. Rubber has up to 2.
pub(crate) const LARGE_COEFFICIENT: f64 = 3.0;

/// Estimated error of the mesh, relative in the energy norm, above which it is large.
pub(crate) const COARSE_MESH: f64 = 0.1;

/// Error of a mesh of order 1 and 2, relative in the energy norm, with one cell over the thickness of the body, and the
/// power of the number of cells with which it falls: the means of the studies' parts.
pub(crate) const ERROR_OF_ONE: [f64; 2] = [0.6, 0.18];
pub(crate) const ERROR_FALLS: f64 = 0.85;

/// What supports leave of the normal of a facet that they hold, at most.
pub(crate) const HELD_FACET: f64 = 1e-6;

/// Strain over displacement by size below which it may be what the solver left of a rigid motion.
pub(crate) const RIGID_STRAIN: f64 = 1e-6;

// ---- steps (settings, simulation) ----

/// Most halvings of a step: a millionth of it is no step any more.
pub(crate) const MOST_HALVINGS: u32 = 20;

/// Stiffness of springs at a node, over the largest there, below which there is none: what projections leave.
pub(crate) const NO_SPRING: f64 = 1e-12;

// Estimates where contact points share nodes

/// Most rounds of conjugate gradients, and iterations of each, by which points are moved together.
pub(crate) const SHARED_ROUNDS: usize = 3;
pub(crate) const SHARED_MOVES: usize = 300;
/// Tolerance of each round, and of the contact problem that finds which points touch where nodes that can move are too
/// few.
pub(crate) const SETTLE_STOP: f64 = 1e-10;
/// Distance from its place, over the displacement, from which on a point is there.
pub(crate) const SHARED_STOP: f64 = 1e-14;
