//! Whether supports and contact can hold the body against its loads, judged before anything is solved.

use crate::error::ContactError;
use crate::model::Model;

/// Work on a free motion above this fraction of the size of the loads counts.
const WORK: f64 = 1e-9;

/// Refuses loads that push the body along a rigid motion that no row stops.
pub(crate) fn check(model: &Model) -> Result<(), ContactError> {
    let factor = model.tfeti.coarse_factor();
    if factor.free_motions().is_empty() {
        return Ok(());
    }
    let analysis = &model.scene.analysis;
    for level in 0..analysis.levels() {
        let Some(time) = analysis.time(level) else {
            break;
        };
        for motion in factor.free_motions() {
            let (mut work, mut size) = (0.0, 0.0_f64);
            for (load, response) in model.scene.loads.iter().zip(&model.loads) {
                let h = load.history.value(time);
                let part: f64 = motion
                    .amplitudes
                    .iter()
                    .zip(&response.coarse)
                    .map(|(a, e)| a * e)
                    .sum();
                work -= h * part;
                size += (h * signorini_qp::vector::norm(&response.coarse)).abs();
            }
            let length = signorini_qp::vector::norm(&motion.amplitudes);
            if work.abs() > WORK * size * length {
                let body = motion.bodies.first().map_or(0, |b| b.body);
                return Err(ContactError::NotHeld {
                    level,
                    body,
                    mode: motion.to_string(),
                    force: work,
                });
            }
        }
    }
    Ok(())
}
