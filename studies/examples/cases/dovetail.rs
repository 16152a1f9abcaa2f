//! The root of a blade in a slot whose flanks slope, pulled outwards and let go.
//!
//! Both halves are alike, with the normal `(nx, ny)` of a flank, `ny` along the pull. While the root slides outwards
//! friction helps to hold it, and half the pull `P` is `N (ny + mu nx)`; while it slides back, `N (ny - mu nx)`. So the
//! normal force `N` of a flank is `P / (2 (ny + mu nx))` under a growing pull, and `P / (2 (ny - mu nx))` under a
//! falling one once all of it slides. Half of it is meshed, in plane strain.

use super::{Failure, Finding, second, solve};
use signorini::prelude::*;

const PULL: f64 = 1e6;

/// Half a root, whose width narrows by `slope` times its height of 1, and half a slot around it. The flanks are the
/// greatest x of the root and the least x of the slot.
fn mesh(n: usize, slope: f64) -> Result<TetMesh, Failure> {
    let flank = move |y: f64| 1.6 - slope * y;
    let root = Brick::new([1.0; 3], [n, n, 1]).build()?;
    let root = root.map_points(|[x, y, z]| [x * flank(y), y, 0.2 * z])?;
    let slot = Brick::new([1.0, 1.4, 1.0], [n, 2 * n - 1, 2]).build()?;
    let slot = slot.map_points(|[x, y, z]| {
        let (y, z) = (y - 0.2, 0.2 * z);
        [flank(y) + x * (3.2 - flank(y)), y, z]
    })?;
    Ok(root.append(&slot.map_tags(second))?)
}

/// The normal force of a flank over the pull, at its end and when it has fallen to a tenth.
pub fn findings(short: bool) -> Result<Vec<Finding>, Failure> {
    let n = if short { 4 } else { 10 };
    let mut all = Vec::new();
    for (degrees, coefficient) in [(30.0_f64, 0.3), (45.0, 0.2)] {
        // of the flank to the pull
        let (ny, nx) = degrees.to_radians().sin_cos();
        let mesh = mesh(n, ny / nx)?;
        let pulls = History::table(vec![(0.0, 0.0), (1.0, 1.0), (2.0, 0.1)])?;
        let mut scene = Scene::new(mesh, Hooke::isotropic(2e11, 0.3)?.into())
            .with_support(Support::fixed(second(brick::X_MAX)))
            .with_support(Support::components(brick::X_MIN, [true, false, false]))
            .with_load(Load::force(brick::Y_MAX, [0.0, PULL / 2.0, 0.0]).with_history(pulls))
            .with_contact(
                Contact::between(brick::X_MAX, second(brick::X_MIN)).with_friction(Friction::coulomb(coefficient)),
            )
            .with_analysis(Analysis::quasistatic(2.0, 8));
        for tag in [brick::Z_MIN, brick::Z_MAX] {
            for tag in [tag, second(tag)] {
                scene = scene.with_support(Support::components(tag, [false, false, true]));
            }
        }
        let mut ratios = Vec::new();
        let run = solve(scene, Settings::default(), |result| {
            ratios.push(result.summary().normal_force);
        })?;
        let finding = |quantity, force: f64, pull: f64, across: f64| Finding {
            case: format!("dovetail, flanks at {degrees} degrees, coefficient {coefficient}"),
            quantity,
            value: force / pull,
            target: 0.5 / across,
            asked: 1e-6,
            run,
        };
        let help = coefficient * nx;
        all.push(finding("normal force over pull, pulled", ratios[3], PULL, ny + help));
        all.push(finding(
            "normal force over pull, let go",
            ratios[7],
            0.1 * PULL,
            ny - help,
        ));
    }
    Ok(all)
}
