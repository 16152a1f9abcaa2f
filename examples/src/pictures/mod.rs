//! Pictures of the results as SVG: the counterparts of the paper's figures 6.4 to 6.7, and what the solver did and cost.
//!
//! Each function gives the text of a file. Nothing depends on installed fonts: text stays text in the SVG.

mod bands;
mod colour;
mod contact_map;
mod deformed;
mod growth;
mod ladder;
mod steps;
mod svg;

pub use contact_map::{friction, slip_rate};
pub use deformed::deformed;
pub use growth::growth;
pub use ladder::ladder;
pub use steps::steps;

/// What stands above a picture of a loading.
fn caption(loading: &str, time: f64) -> String {
    let text = match loading {
        "b" => crate::brick::Loading::B.caption(),
        "c" => crate::brick::Loading::C.caption(),
        other => other,
    };
    format!("{text}, t = {time} s")
}
