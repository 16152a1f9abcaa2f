//! Radii that follow other components, inside conjugate gradients.
//!
//! A hook moves the radii between active sets. Where the caller tells how (Coulomb friction: the radius of a disc is
//! a coefficient times the normal force), conjugate gradients take it along: a step `p` on the set becomes `q = E p`,
//! in which a sliding disc also grows along its normal by `slope * p`, and unconstrained components restore `G q =
//! 0`. The matrix is then `A E` instead of `A`, not symmetric, but by a small part only: lengths of steps are those
//! that make `pᵀ r` vanish, and directions are kept conjugate by the product just made (Polak and Ribière). What is
//! left for the move to the next set is of second order, so that nearly nothing is lost by it.

use crate::error::QpError;
use crate::problem::{Constrained, ConvexSet, EqualityProjector, ProductSet, for_constrained, for_discs};
use crate::tolerances::{COUPLED_GROWTH, COUPLED_LEAST, COUPLED_LOST, COUPLED_NEAR, COUPLED_STEPS, COUPLED_WAIT};

use super::blocks::ActiveSet;
use super::disc::Disc;

/// The radius of a disc changes by `slope` times the change of another component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RadiusSlope {
    /// First component of the disc; [`interior_point()`](crate::interior_point()) takes intervals, too.
    pub disc: usize,
    /// Component that its radius follows.
    pub component: usize,
    /// Derivative of the radius.
    pub slope: f64,
}

/// By component: which one the radius of the block that begins there follows, and how. No slope is as good as zero.
///
/// # Errors
/// [`QpError::Slope`] for one that is not finite, or of or after nothing, or the second of a block.
pub(crate) fn slope_table(set: &ProductSet, slopes: &[RadiusSlope]) -> Result<Vec<Option<(usize, f64)>>, QpError> {
    let mut has_radius = vec![false; set.constrained()];
    for_constrained(set, |block| match block {
        Constrained::Disc { i, .. } => has_radius[i] = true,
        Constrained::Bound { i, lower, upper, .. } => has_radius[i] = lower == -upper,
    });
    let mut table = vec![None; has_radius.len()];
    for &RadiusSlope { disc, component, slope } in slopes {
        let valid = has_radius.get(disc) == Some(&true) && component < set.dim() && slope.is_finite();
        if !valid || table[disc].is_some() {
            return Err(QpError::Slope { disc, component, slope });
        }
        table[disc] = Some((component, slope));
    }
    Ok(table
        .into_iter()
        .map(|entry| entry.filter(|(_, slope)| *slope != 0.0))
        .collect())
}

/// The slopes of one problem, and memory for the coupled step.
#[derive(Debug, Default)]
pub(crate) struct Coupling {
    slopes: Vec<RadiusSlope>,
    /// Slope and component by disc, in the order of the set; rebuilt when a solve starts.
    by_disc: Vec<Option<(usize, f64)>>,
    /// `q`.
    pub(crate) step: Vec<f64>,
    /// What its constrained components have more than `p`.
    growth: Vec<f64>,
    /// Whether conjugate gradients use it now.
    pub(crate) on: bool,
    /// Whether they got on badly with it in this solve.
    pub(crate) failed: bool,
}

impl Coupling {
    pub(crate) fn set(&mut self, slopes: &[RadiusSlope]) {
        self.slopes.clear();
        self.slopes.extend_from_slice(slopes);
    }

    /// Makes ready for a solve with so many `constrained` components.
    pub(crate) fn start(&mut self, set: &ProductSet, constrained: usize) -> Result<(), QpError> {
        (self.on, self.failed) = (false, self.slopes.is_empty());
        if self.failed {
            return Ok(());
        }
        let n = set.dim();
        if self.step.len() != n {
            // of which pages become real where several threads write them first
            self.step = vec![0.0; n];
        }
        self.growth.resize(constrained, 0.0);
        let table = slope_table(set, &self.slopes)?;
        self.by_disc.clear();
        for_discs(set, |first, _, _| self.by_disc.push(table[first]));
        self.failed = self.by_disc.iter().all(Option::is_none);
        Ok(())
    }

    /// Whether a radius follows a component that is not zero.
    pub(crate) fn follows(&self, set: &ProductSet, x: &[f64]) -> bool {
        let mut found = false;
        if !self.slopes.is_empty() {
            for_discs(set, |_, k, _| {
                found |= self.by_disc[k].is_some_and(|(component, _)| x[component] != 0.0)
            });
        }
        found
    }

    /// `step = E p`.
    pub(crate) fn extend<C: EqualityProjector>(
        &mut self,
        projector: &mut C,
        set: &ProductSet,
        active: &ActiveSet,
        p: &[f64],
    ) {
        self.growth.fill(0.0);
        let (growth, by_disc) = (&mut self.growth, &self.by_disc);
        for_discs(set, |i, k, _| {
            if let (Disc::Sliding { tau, .. }, Some((component, slope))) = (active.discs[k], by_disc[k]) {
                let radius = slope * p[component];
                growth[i] = radius * tau[1];
                growth[i + 1] = -radius * tau[0];
            }
        });
        projector.compensate(p, &self.growth, &mut self.step);
    }

    /// Decides for the next set, if it is `free` to couple: its relative `error`, and sets without progress so far.
    pub(crate) fn begin(&mut self, free: bool, error: f64, waited: usize) {
        let near = error <= COUPLED_NEAR || waited >= COUPLED_WAIT;
        self.on = free && near && !self.failed;
    }

    /// Whether the iteration goes badly after that many steps: the estimate was `start` and is `now`.
    pub(crate) fn too_strong(&mut self, steps: usize, start: f64, now: f64) -> bool {
        self.failed |= self.on && (steps >= COUPLED_STEPS || now.is_nan() || now > COUPLED_GROWTH * start);
        self.on && self.failed
    }

    /// The decrease asked for on this set: as far as the move after it lets the error fall. That move is of second
    /// order, so what it brought back of the error `first_error` of the last set bounds what it will bring back now.
    pub(crate) fn forcing(&self, forcing: f64, jump: f64, first_error: f64) -> f64 {
        if !self.on {
            return forcing;
        }
        (COUPLED_LOST * jump / first_error).max(COUPLED_LEAST).min(forcing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Segment;

    #[test]
    fn couples_near_the_solution_and_where_sets_go_in_circles() {
        let mut coupling = Coupling::default();
        let mut begins = |free, error, waited| {
            coupling.begin(free, error, waited);
            coupling.on
        };
        assert!(!begins(true, 0.5, 0) && !begins(true, 0.5, COUPLED_WAIT - 1));
        assert!(begins(true, 0.5, COUPLED_WAIT), "far, but nothing else helps");
        assert!(!begins(false, 0.01, 0) && begins(true, 0.05, 0));
        assert!(coupling.too_strong(COUPLED_STEPS, 1.0, 1.0));
        coupling.begin(true, 1e-9, 0);
        assert!(!coupling.on, "for the rest of the solve");
    }

    /// Discs are found in any order; those without a slope stand alone, and slopes that mean nothing are refused.
    #[test]
    fn discs_follow_the_components_that_slopes_name() {
        let segments = vec![Segment::upper(vec![0.0; 2]), Segment::discs(vec![1.0; 3])];
        let set = ProductSet::new(segments).expect("set");
        let slope = |disc, component, slope| RadiusSlope { disc, component, slope };
        let mut coupling = Coupling::default();
        coupling.start(&set, 8).expect("slopes");
        assert!(coupling.failed, "nothing follows");
        for (slopes, expected) in [
            (
                vec![slope(2, 0, -0.3), slope(6, 1, -0.4)],
                [Some((0, -0.3)), None, Some((1, -0.4))],
            ),
            (
                vec![slope(4, 1, -0.4), slope(2, 0, -0.3)],
                [Some((0, -0.3)), Some((1, -0.4)), None],
            ),
            (vec![slope(4, 7, -0.3)], [None, Some((7, -0.3)), None]),
        ] {
            coupling.set(&slopes);
            coupling.start(&set, 8).expect("slopes");
            assert!(!coupling.failed);
            assert_eq!(coupling.by_disc, expected);
        }
        for bad in [slope(2, 8, -0.3), slope(3, 0, -0.3), slope(6, 0, f64::NAN)] {
            coupling.set(&[slope(4, 7, -0.3), bad]);
            assert!(matches!(coupling.start(&set, 8), Err(QpError::Slope { .. })));
        }
    }

    #[test]
    fn the_decrease_asked_for_is_what_the_move_can_keep() {
        let mut coupling = Coupling::default();
        assert_eq!(coupling.forcing(0.1, 1e-3, 1.0), 0.1, "not coupled");
        coupling.on = true;
        for (jump, expected) in [(1e-3, COUPLED_LEAST), (5e-3, 0.05), (0.5, 0.1)] {
            assert_eq!(coupling.forcing(0.1, jump, 1.0), expected);
        }
        assert_eq!(coupling.forcing(0.1, 1e-2, 2.0), 0.05);
    }
}
