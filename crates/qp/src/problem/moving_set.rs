//! Sets that follow the solution.

/// A set, and how it follows the solution (Coulomb friction: slip bounds follow normal forces).
pub struct MovingSet<'a, S: ?Sized> {
    pub(crate) set: &'a mut S,
    pub(crate) hook: Option<&'a mut Hook<'a, S>>,
}

/// Is told the iterate, and may change the set; whether it did anything that matters.
pub(crate) type Hook<'a, S> = dyn FnMut(&[f64], &mut S) -> bool + 'a;

impl<'a, S: ?Sized> MovingSet<'a, S> {
    /// A set that stays as it is.
    pub fn fixed(set: &'a mut S) -> Self {
        Self { set, hook: None }
    }

    /// A set that `hook` may change when it is told an iterate, which is feasible for the set as it is; it answers
    /// whether it did anything that matters. Of a [`ProductSet`](crate::ProductSet) bounds and radii may change,
    /// segments not.
    pub fn new(set: &'a mut S, hook: &'a mut dyn FnMut(&[f64], &mut S) -> bool) -> Self {
        let hook = Some(hook as _);
        Self { set, hook }
    }
}
