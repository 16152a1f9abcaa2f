//! Nearly incompressible materials and jumps of stiffness.

use signorini::prelude::*;
use signorini_studies::Failure;
use signorini_studies::brick::{Block, by_centre};

use super::case::{Case, Setup, ToSetup};

fn jump(block: &Block, ratio: f64, soft: impl Fn([f64; 3]) -> bool) -> Result<Setup, Failure> {
    let mesh = block.mesh()?;
    let regions = by_centre(&mesh, |x| u32::from(soft(x)));
    let soft = Hooke::isotropic(block.young / ratio, block.poisson)?;
    let materials = Materials::new(vec![(0, block.material()?), (1, soft)])?;
    block.setup_on(mesh.with_regions(regions)?, materials)
}

/// Poisson's ratios and stiffness jumps.
pub(crate) fn cases() -> Vec<Case> {
    const JUMP: &str = "Stiffness jumps";
    let mut cases = Vec::new();
    for poisson in [0.0, 0.45, 0.49, 0.499, 0.49999] {
        let hard = match poisson {
            0.0 => "no coupling of directions",
            p if p < 0.46 => "rubber-like",
            _ => "nearly incompressible: P1 locks, the condition grows like 1/(1 - 2 nu)",
        };
        let block = Block {
            poisson,
            ..Block::default()
        };
        cases.push(Case::brick("Poisson's ratio", format!("nu {poisson}"), hard, block));
    }
    for ratio in [1e3, 1e6, 1e9] {
        let lying = Block {
            gap: 0.0,
            ..Block::default()
        };
        let between = Block {
            cells: [3; 3],
            steps: 2,
            ..lying.clone()
        };
        let layered = Block {
            top: lying.top.map(|v| v / ratio),
            end: lying.end.map(|v| v / ratio),
            ..lying.clone()
        };
        cases.extend([
            Case::new(
                JUMP,
                format!("between subdomains {ratio:e}"),
                "the middle subdomain is soft, the jump falls on an interface; its contact nodes belong to stiff and \
                 soft parts",
                move || jump(&between, ratio, |x| x[0] > 1.0 && x[0] < 2.0),
            ),
            Case::new(
                JUMP,
                format!("inside subdomains {ratio:e}"),
                "soft inclusions inside every subdomain: K+ itself is badly conditioned",
                move || {
                    let inside = |v: f64| (v.rem_euclid(1.0) - 0.5).abs() < 0.26;
                    jump(&lying, ratio, |x| x.into_iter().all(inside))
                },
            ),
            Case::new(
                JUMP,
                format!("soft contact layer {ratio:e}"),
                "the layer that touches is soft: contact rows are that much more flexible than glued ones",
                move || jump(&layered, ratio, |x| x[2] < 0.25),
            ),
        ]);
    }
    cases
}
