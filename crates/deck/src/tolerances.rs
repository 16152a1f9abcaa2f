//! The numerical judgements of the crate, in one table: what each is relative to, and why.

/// Difference of increments, over the period, that is rounding; and deviation from a plane, and of a node from the rim
/// of a surface, over its size.
pub(crate) const ROUNDING: f64 = 1e-9;

/// The least increment of a step that gives none, over its period, and how often an increment is cut back, as CalculiX
/// and Abaqus have both.
pub(crate) const LEAST_INCREMENT: f64 = 1e-5;
pub(crate) const CUT_BACKS: u32 = 5;

/// Difference of unit vectors, and of places over their distance from the origin, that is rounding of what a deck
/// writes.
pub(crate) const TURNED: f64 = 1e-5;

/// What cut edges of rigid faces may be off the curved ones, over their lengths before; the most parts of one, and the
/// most squares of them on a surface, of which each is two triangles in a tree of 0.3 kB each.
pub(crate) const SAGITTA: f64 = 5e-4;
pub(crate) const MOST_PARTS: f64 = 8.0;
pub(crate) const MOST_SQUARES: f64 = 3e5;

/// Part of the area of a face that is none.
pub(crate) const NO_AREA: f64 = 1e-12;

/// The tolerance of a tie where a deck has none, over the mean radius of the circles in the faces of the second
/// surface: what CalculiX takes for its 2.5 % of a typical element size, to within 15 %.
pub(crate) const TIE: f64 = 0.025;

/// Smaller tolerances of ties are none, as in CalculiX.
pub(crate) const NO_TIE: f64 = 1e-10;

/// Distance of tied sides, over the same radius, that is rounding of what a deck writes.
pub(crate) const TOGETHER: f64 = 1e-3;

/// Cosine from which on a node lies before the other surface and not beside it.
pub(crate) const BEFORE: f64 = 0.7;
/// Cosine of the angle between the normal of a section that is given and that of its faces, below which its sides would
/// slide rather than part.
pub(crate) const ALONG_SECTION: f64 = 0.1;

/// Value of a mid-node off the mean of those at the ends of its edge, over the largest value, that is told.
pub(crate) const BENT: f64 = 1e-3;
