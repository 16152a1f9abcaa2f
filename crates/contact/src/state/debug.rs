//! What a state shows of itself.

use super::state::State;
use std::fmt;

/// How far it is and how large; with `{:#?}` all of its numbers.
impl fmt::Debug for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if f.alternate() {
            // every field has to be named
            let Self {
                level,
                lambda,
                f_lambda,
                multiplier,
                trace,
                rate,
                sliding,
                controller,
                peaks,
                unconverged,
                origin,
                seals,
            } = self;
            return f
                .debug_struct("State")
                .field("level", level)
                .field("lambda", lambda)
                .field("f_lambda", f_lambda)
                .field("multiplier", multiplier)
                .field("trace", trace)
                .field("rate", rate)
                .field("sliding", sliding)
                .field("controller", controller)
                .field("peaks", peaks)
                .field("unconverged", unconverged)
                .field("origin", origin)
                .field("seals", seals)
                .finish();
        }
        f.debug_struct("State")
            .field("level", &self.level)
            .field("bytes", &self.memory())
            .field("unconverged_history", &self.unconverged)
            .finish_non_exhaustive()
    }
}
