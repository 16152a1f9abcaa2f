//! Springs in series with the constrained components, those of a [`path`](super::path).
//!
//! They add `c / scale` to the diagonal of `A`. All that belongs to a constrained component changes with its spring:
//! the preconditioner and the weight of the projector by the share `1 / (1 + c)`, as with the curvature of a disc, and
//! the step of the natural map.

use crate::problem::SymmetricOperator;
use crate::vector;

use super::problem::ActiveSetProblem;

/// Springs in series with the constrained components.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Compliance {
    /// `c`, in units of `1 / scale`; zero for none.
    pub(crate) c: f64,
}

impl Compliance {
    /// Part of a constrained component's own compliance in that with its spring.
    pub(crate) fn share(self) -> f64 {
        1.0 / (1.0 + self.c)
    }

    /// `av = A v` with the springs of the first so many components.
    pub(crate) fn apply<A: SymmetricOperator, M>(
        self,
        problem: &ActiveSetProblem<'_, A, M>,
        constrained: usize,
        v: &[f64],
        av: &mut [f64],
        scratch: &mut A::Scratch,
    ) {
        problem.operator.apply(v, av, scratch);
        self.add(problem.scale, &v[..constrained], av);
    }

    /// `av += c / scale * v`.
    pub(crate) fn add(self, scale: &[f64], v: &[f64], av: &mut [f64]) {
        if self.c != 0.0 {
            for ((av, v), scale) in av.iter_mut().zip(v).zip(scale) {
                if *scale > 0.0 {
                    *av += self.c / scale * v;
                }
            }
        }
    }

    /// Scales by the share.
    pub(crate) fn damp(self, v: &mut [f64]) {
        if self.c != 0.0 {
            vector::scale(self.share(), v);
        }
    }

    /// What the preconditioner has on the constrained components besides the damped one: `v += own r`, see
    /// [`add_own`](super::blocks::ActiveSet::add_own).
    pub(crate) fn add_own(self, scale: &[f64], r: &[f64], v: &mut [f64]) {
        if self.c != 0.0 {
            let own = self.c * self.share().powi(2);
            for ((v, r), scale) in v.iter_mut().zip(r).zip(scale) {
                *v += own * scale * r;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With a preconditioner that is diagonal, and exact without springs, damping and own part invert the sum of both.
    #[test]
    fn what_a_diagonal_preconditioner_inverts_it_inverts_with_springs() {
        let (scale, v) = ([2.0, 0.5, 0.0], [3.0, -1.0, 4.0]);
        for c in [0.0, 0.3, 1e5] {
            let springs = Compliance { c };
            let mut av = [v[0] / scale[0], v[1] / scale[1], 7.0];
            springs.add(&scale, &v, &mut av);
            assert_eq!(av[2], 7.0, "no spring where nothing moves");
            let mut z = av;
            springs.damp(&mut z);
            z.iter_mut().zip(&scale).for_each(|(z, m)| *z *= m);
            springs.damp(&mut z);
            springs.add_own(&scale, &av, &mut z);
            for k in 0..2 {
                assert!((z[k] - v[k]).abs() <= 1e-14 * v[k].abs(), "c = {c}: {z:?}");
            }
        }
    }
}
