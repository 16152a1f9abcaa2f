//! All numbers of the crate that are judgements: what counts as zero, and what work is worth.
//!
//! The first part decides results, the second speed only.

// ---- what counts as zero, alike or singular ----

/// Unit vectors given by a user: largest error of their lengths and of right angles between them.
pub(crate) const UNIT: f64 = 1e-10;
/// Unit vectors and unit rows: up to this they are one, or at right angles.
pub(crate) const SAME: f64 = 1e-12;
/// Translates: largest difference of positions, relative to the size of a subdomain.
pub(crate) const TRANSLATE: f64 = 1e-12;
/// Directions: the share that is left of one that depends on others, or that supports fix.
pub(crate) const FIXED: f64 = 1e-8;
/// Directions that supports fix at a node, and a contact normal there: sine of the angle up to which two are one. Of
/// coordinates with six or seven digits normals of facets in one plane differ by up to 1e-5; facets of a round surface
/// meet at more.
pub(crate) const ONE_DIRECTION: f64 = 1e-4;
/// Share of the mean of a side of several nodes from which on supports hold that side.
pub(crate) const HELD: f64 = 0.25;
/// The same where both sides are means, in a mesh of order 2: of a corner on a plane that supports hold it is a quarter
/// or a half, of one beside the plane a tenth at most.
pub(crate) const HELD_MEANS: f64 = 0.2;
/// The same of the other side, where the plane cuts the own one: smaller facets have less of a mean on it.
pub(crate) const HELD_OF_OTHER: f64 = 0.02;
/// Prescribed displacements in one direction: relative difference that supports may have.
pub(crate) const AGREEING: f64 = 1e-7;
/// Nodes of a rigid subdomain: largest distance from a line, relative to its length, on which they lie. At 3e-6 loads
/// about the line took all products allowed, from 1e-5 on they were solved.
pub(crate) const ON_A_LINE: f64 = 1e-5;
/// Largest coefficient of an equation: beyond, forces over coefficients leave the range of numbers.
pub(crate) const COEFFICIENTS: [f64; 2] = [1e-200, 1e200];
/// Linear equations: part of the coefficients of one that others leave which is too little to be meant, where it is
/// more than rounding: decks have six or seven digits.
pub(crate) const ALMOST: f64 = 1e-6;
/// Entry of an equation over its largest up to which others may be taken out by it.
pub(crate) const PIVOTAL: f64 = 0.1;
/// Sine of an angle that counts as none: a direction in a plane, nodes on a line.
pub(crate) const ANGLE: f64 = 1e-6;
/// Pivots and eigenvalues of small matrices, relative to the largest.
pub(crate) const PIVOT: f64 = 1e-13;
/// Smallest pivot of a stiffness over the largest, and over the diagonal entry that it was, up to which it means a
/// motion without strain beside the rigid ones. Rounding left less than that in quadratic tetrahedra at Poisson's
/// ratios from 0.49 to 0.4999; of 3,300 random bodies solved right none had less than 9e-10 and 1e-9.
pub(crate) const FURTHER_MOTION: f64 = 1e-12;
pub(crate) const LEFT_OF_IT: f64 = 1e-10;
/// Largest over smallest diagonal entry of a stiffness that is singular, above which rounding is the reason, not a
/// motion without strain: about what double precision has left beside the condition of a mesh of one material.
pub(crate) const CONTRAST: f64 = 1e8;
/// Pivots of coarse factors and of matrices from which directions are taken out, relative to the largest diagonal
/// entry.
pub(crate) const SINGULAR: f64 = 1e-14;
/// Eigenvalues of free motions, relative to the largest: a support of extent `h` on a body of length `L` gives
/// `(h/L)^2`.
pub(crate) const FREE: f64 = 1e-11;
/// The same of bodies whose rows, of length about one, cancel: contact of a body with itself leaves the squares of
/// rounding, up to 1e-28.
pub(crate) const NO_ACTION: f64 = 1e-20;
/// The same of springs where supports hold a subdomain, from which on a motion is held: eigenvalues between the two
/// make no matrix that is safe to invert.
pub(crate) const HELD_MOTION: f64 = 1e-3;
/// Layers of a grid: largest difference of positions within one, relative to the extent.
pub(crate) const LAYER: f64 = 1e-6;
/// Components of a free motion that is described, or that contact rows stop, relative to its length.
pub(crate) const MOVING: f64 = 1e-9;
/// Work on a free motion, relative to the norms of both, above which a load is not in balance with it.
pub(crate) const WORK: f64 = 1e-9;
/// Weight of support rows that leaves the question alone whether they hold the bodies.
pub(crate) const SUPPORTED: f64 = 0.01;
/// Error in the equality of a solve with a factor in single precision with which steps are projected, relative.
pub(crate) const ROUNDED_STEP: f64 = 1e-4;
/// Rows of the equality from which on such a factor is read instead of the exact one: a smaller one takes no time worth
/// mentioning, and where conjugate gradients are long its rounding lets directions forget one another. From there on
/// rows also weigh one where nothing but the shape of a mesh tells them apart.
pub(crate) const SHORT_ROWS: usize = 500;
/// Stiffness of a copy over that of another one of its node up to which all count alike: 1 where boxes cut a regular
/// mesh, 2.5 where its nodes are displaced by 0.15 of a cell, 17 and more in cuts that follow no plane of the mesh.
pub(crate) const ALIKE: f64 = 4.0;
/// Stiffness of a copy in a rigid subdomain over that of the other copies of its node, and squared length of the rows
/// that hold it: the mean of a node follows it, and products are those of a support. With 1e6 the best certificates
/// were 1e-10.
pub const RIGID: f64 = 1e3;
/// Largest weight of the rows of a body over that of another one down to which both are told apart. Beyond, what
/// rounding leaves of the soft body in the coarse problem was seen, from 1e-4 on by thousands of products where bodies
/// touch, at 1e-8 by certificates of 1e-4 where they do not.
pub(crate) const SOFT_BODY: f64 = 1e-3;
/// Added to the matrix of a group whose rows may depend on one another, relative. Vectors of its null space come out
/// large, but `B^T` takes them to zero.
pub(crate) const DEPENDENT: f64 = 0.3;
/// Weight of `Gᵀ G` beside `F`, by their traces: the inverse of the sum is that of `F` on the kernel of `G` to about
/// its inverse.
pub(crate) const EXPLICIT_WEIGHT: f64 = 1e4;
/// Most solves with it until `G x = e`, and what may be left of that beside `x`.
pub(crate) const BALANCES: usize = 12;
pub(crate) const BALANCED: f64 = 1e-10;
/// Solves in a row that leave no less, after which the best one is taken.
pub(crate) const UNBALANCED: usize = 2;
/// Part of a change that is not in those before, below which it tells nothing new.
pub(crate) const SECANT: f64 = 1e-3;
/// Pivot of a row in such an `F`, over its largest entry, up to which the row depends on others.
pub(crate) const LEFT_OF_ROW: f64 = 1e-11;
/// Added to the diagonal of a matrix until it can be factored, relative to its largest entry.
pub(crate) const SHIFTS: [f64; 4] = [1e-13, 1e-9, 1e-6, 1e-4];
/// Rows up to which a group has few: a node in a corner of three rough obstacles has nine, and the gluing of its
/// copies.
pub(crate) const DEPENDENT_FEW: usize = 30;
/// The same in a group of many rows, where contact points share nodes: on few is there a null space, and what is added
/// makes long waves along a thin body stiff.
pub(crate) const DEPENDENT_JOINED: f64 = 0.03;
/// The same without contact rows, as of ties that cross: 0.3 takes three times as many products.
pub(crate) const DEPENDENT_TIED: f64 = 1e-3;
/// Nodes of a class without dense inverse at which it is asked for its compliance.
pub(crate) const SAMPLE: usize = 3;
/// Pivots of the Gram matrix of rows from which on they are independent, relative to the largest.
pub(crate) const INDEPENDENT: f64 = 1e-9;
/// Rows of one group up to which its null space is looked for.
pub(crate) const EXCHANGED_ROWS: usize = 1000;
/// Rows of one group up to which its matrix is dense; beyond, where contact points share nodes, it is sparse.
pub(crate) const GROUP_ROWS: usize = 120;
/// Weight of the rows that an active set holds in the matrix of such a group, relative to their own entry.
pub(crate) const HELD_ROWS: f64 = 1e8;

/// Share of the nodes of a subdomain that supports hold in one or two directions, from which on it is thin between
/// planes; the nodes that it has at least, for random bodies of fewer gain and lose alike; and stiffness of its springs
/// there over that of the node. Slices of cylinders on blocks, of one to ten layers of cells, take a half to an eighth
/// of the products; with 0.25 a slice held on one side takes thrice as many, with springs of 10 a third more, of 0.1
/// the same.
pub(crate) const THIN: f64 = 0.2;
pub(crate) const THIN_NODES: usize = 30;
pub(crate) const PLANE_SPRINGS: f64 = 1.0;
/// Shear modulus over that of softer subdomains from which on conjugate gradients suit those first: of an error there
/// is a thirtieth of the energy.
pub(crate) const STIFFER: f64 = 30.0;
/// Steps of Lanczos' method for the largest eigenvalue that a lumped block leaves: it is 1 % short at most on boxes of
/// 4 to 12 cells.
pub(crate) const LANCZOS: usize = 8;
/// Stiffness of a spring over that of the stiffest node from which on it holds: below, contact is to balance what it can
/// (softer by ten it took 4 times the products of a stiff one, softer by 100 the limit).
pub(crate) const SOFT_SPRING: f64 = 1e-4;
/// The same from which on it is in the projector: below, a factor would find it singular.
pub(crate) const NO_HOLD: f64 = 1e-13;
/// Least scale of the row of a spring: softer ones are still seen as holding.
pub(crate) const SOFTEST: f64 = 1e-3;
/// Part of a direction of a row beside those of the same node, over its length, below which it is one of them.
pub(crate) const SAME_DIRECTION: f64 = 1e-9;
/// Displacement cases from which on a number is none: they are numbered without gaps, and tables have a list for each.
pub(crate) const CASES: u32 = 1 << 20;

// ---- what is worth a table, a cut or a thread; seconds are those of one core ----

/// Members worked on at once: the height of the fastest dense kernels.
pub(crate) const PANEL: usize = 24;
/// Members of a class from which on preconditioners form dense matrices, and products use blocks.
pub(crate) const SHARED: usize = 4;
/// Operations a second of dense products, and bytes a second of matrices in cache and in memory.
pub(crate) const FLOPS: f64 = 8e10;
pub(crate) const BANDWIDTH: [f64; 2] = [6e10, 1.2e10];
/// Products with `F` that a dense inverse has to pay for itself in.
pub(crate) const PRODUCTS: usize = 2000;
/// Bytes of dense matrices that still stay in the caches of one processor.
pub(crate) const CACHE: u64 = 16 << 20;
/// Most bytes of an `F` that is formed, with the factor of what is eliminated, and most contact rows of it; factors of
/// interior points and active sets of a step with its inverse.
pub(crate) const EXPLICIT_BYTES: f64 = 3.2e9;
pub(crate) const EXPLICIT_CONTACT: usize = 8000;
pub(crate) const INTERIOR_FACTORS: f64 = 100.0;
pub(crate) const EXPLICIT_SETS: f64 = 20.0;
/// Time of an operation of a product with `F` over that of a dense factor, and operations of such a factor in the time
/// that a solve takes for a row beside that product: 3 to 4 ms a product of 5700 to 8300 rows, where dense factors run
/// at 3.4e10 a second.
pub(crate) const STREAMED: f64 = 8.0;
pub(crate) const ROW_OPERATIONS: f64 = 20_000.0;
/// Columns solved at once when a dense block is formed, at least six.
pub(crate) const COLUMNS: usize = 48;
/// Node copies of a loop, operations of a product with `F`, numbers of a coarse solve and operations of a coarse factor
/// that are worth a second thread.
pub(crate) const LARGE: usize = 8000;
pub(crate) const PRODUCT: u64 = 1_500_000;
pub(crate) const SOLVE_READS: usize = 25_000;
pub(crate) const OPERATIONS: f64 = 3e5;
/// Unknowns of bodies that rows join from which on their free motions are looked for by inverse iteration, and its
/// steps: each leaves a thousandth of a motion that rows stop by a ten-millionth of the largest.
pub(crate) const LARGE_GROUP: usize = 300;
pub(crate) const INVERSE_STEPS: usize = 4;
/// Operations from which on a front of a coarse factor is eliminated in parts, numbers of an update from which on it is
/// added in parts, and columns of a part: whole blocks of six.
pub(crate) const LARGE_FRONT: f64 = 1e8;
pub(crate) const LARGE_UPDATE: usize = 1_000_000;
pub(crate) const PART: usize = 192;
/// Most parts of a loop over subdomains: bounds work memory and useful threads. Blocks, motions of subdomains and
/// entries of a part.
pub(crate) const PARTS: usize = 64;
pub(crate) const BLOCKS: usize = 2048;
pub(crate) const MOTIONS: usize = 512;
pub(crate) const GLOB_TASK: u64 = 4096;
pub(crate) const SUBDOMAIN_TASK: u64 = 512;
/// Coarse solves between two changes of the active set; seconds for a number that they read, for an operation of a
/// change and for a number of a sparse factor over its mean column.
pub(crate) const SOLVES: f64 = 12.0;
pub(crate) const READ: f64 = 0.4e-9;
pub(crate) const OPERATION: f64 = 0.04e-9;
pub(crate) const SPARSE: f64 = 0.1e-9;
/// Most levels of cuts through coarse blocks that change, and fewest blocks worth a cut.
pub(crate) const CUTS: usize = 4;
pub(crate) const CUT: usize = 36;
/// Subdomains from which on two levels may pay, and from which on a factor of the whole matrix that follows the contact
/// rows is out of the question.
pub(crate) const FEW: usize = 1000;
pub(crate) const MANY: usize = 4000;
/// Most subdomains of a cluster. What products grow by with clusters, and seconds of a product and what belongs to it a
/// row.
pub(crate) const CLUSTER: usize = 12;
pub(crate) const GROWTH: f64 = 0.2;
pub(crate) const ROW: f64 = 2e-8;
/// Sweeps of the model of the coarse matrix that relax each subdomain by itself, and by how much: two copies of a node
/// make the matrix up to twice its diagonal blocks.
pub(crate) const SWEEPS: usize = 3;
pub(crate) const RELAXED: f64 = 0.9;
/// Least subdomains that a thread measures at a time.
pub(crate) const SUBDOMAINS: usize = 16;
/// Most branches of a coarse factor on a rank.
pub(crate) const BRANCHES: usize = 4;
/// Equal regions of a coarse factor from which on they are solved together: fewer take as long one by one, and of
/// several processes, each with some of them, less.
pub(crate) const ALIKE_REGIONS: usize = 5;
/// Cuts of a grid of blocks stand in every fourth layer, so that the pieces between them are equal.
pub(crate) const PERIOD: u32 = 4;
/// What a node of the coarse factor costs a solve besides its numbers, in numbers: the node, and a block of its border.
pub(crate) const NODE: usize = 90;
pub(crate) const BORDER: usize = 12;
/// What a group of a subdomain's factor costs a solve besides its tiles, in tiles.
pub(crate) const GROUP: usize = 4;
