//! How a load changes in time.

use super::function::Function;
use std::sync::Arc;

errors! {
    /// A history that cannot be used.
    #[derive(Clone, PartialEq)]
    HistoryError {
        Empty = "the history has no points; give at least one (time, value)";
        NotFinite { index: usize, time: f64, value: f64 } =
            "point {index} of the history is ({time}, {value}); both must be finite";
        NotIncreasing { index: usize, before: f64, time: f64 } =
            "point {index} of the history has time {time}, not later than {before} of the point before; sort the \
            points by time and give each time once (a jump needs a short ramp)";
    }
}

/// A factor that depends on time. Equal tables are equal; a function is equal to its clones only.
///
/// ```
/// use signorini_fem_mesh::History;
///
/// let phi_c = History::table(vec![(0.0, 0.0), (0.4, 1.0), (0.7, 0.0), (1.0, 1.0)])?;
/// assert_eq!(phi_c.value(0.2), 0.5);
/// # Ok::<(), signorini_fem_mesh::HistoryError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct History(Kind);

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Table(Vec<(f64, f64)>),
    Function(Function<dyn Fn(f64) -> f64 + Send + Sync>),
}

impl History {
    /// The same value at all times.
    pub fn constant(value: f64) -> Self {
        Self(Kind::Table(vec![(0.0, value)]))
    }

    /// Linear from 0 at time 0 to `value` at time `duration`, then constant.
    ///
    /// # Errors
    /// [`HistoryError`] unless 0 < duration and both numbers are finite.
    pub fn ramp(duration: f64, value: f64) -> Result<Self, HistoryError> {
        Self::table(vec![(0.0, 0.0), (duration, value)])
    }

    /// Linear interpolation between (time, value) points; constant before the first and after the last.
    ///
    /// # Errors
    /// [`HistoryError`] if there is no point, a number is not finite, or the times do not
    /// increase strictly.
    pub fn table(points: Vec<(f64, f64)>) -> Result<Self, HistoryError> {
        if points.is_empty() {
            return Err(HistoryError::Empty);
        }
        for (index, &(time, value)) in points.iter().enumerate() {
            if !(time.is_finite() && value.is_finite()) {
                return Err(HistoryError::NotFinite { index, time, value });
            }
            if index > 0 && points[index - 1].0 >= time {
                let before = points[index - 1].0;
                return Err(HistoryError::NotIncreasing { index, before, time });
            }
        }
        Ok(Self(Kind::Table(points)))
    }

    /// Any function of time. Whoever evaluates it must reject values that are not finite.
    pub fn function(value: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Self {
        Self(Kind::Function(Function(Arc::new(value))))
    }

    /// The (time, value) points of a table; none of a function.
    pub fn points(&self) -> &[(f64, f64)] {
        match &self.0 {
            Kind::Table(points) => points,
            Kind::Function(_) => &[],
        }
    }

    /// The value at a time. At the points of a table it is exactly the value given.
    pub fn value(&self, time: f64) -> f64 {
        match &self.0 {
            Kind::Table(points) => interpolate(points, time),
            Kind::Function(value) => value(time),
        }
    }
}

/// Straight lines through points of ascending first numbers, constant before the first and after the last; NaN
/// without any. At the points it is exactly the value given.
pub fn interpolate(points: &[(f64, f64)], x: f64) -> f64 {
    let after = points.partition_point(|p| p.0 <= x);
    let before = after.checked_sub(1).and_then(|i| points.get(i));
    match (before, points.get(after)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * ((x - a.0) / (b.0 - a.0)),
        (Some(p), None) | (None, Some(p)) => p.1,
        (None, None) => f64::NAN,
    }
}
