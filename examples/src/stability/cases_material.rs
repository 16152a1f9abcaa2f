//! Nearly incompressible materials and jumps of stiffness.

use super::block::Block;
use super::case::{Case, Failure, Setup};
use signorini::prelude::*;

fn jump(block: &Block, ratio: f64, soft: impl Fn([f64; 3]) -> bool) -> Result<Setup, Failure> {
    let mesh = block.mesh()?;
    let regions = (0..mesh.tets().len())
        .map(|t| {
            let p = mesh.tet_points(t);
            let centre = std::array::from_fn(|c| p.iter().map(|p| p[c]).sum::<f64>() / 4.0);
            u32::from(soft(centre))
        })
        .collect();
    let soft = Hooke::isotropic(block.young / ratio, block.poisson)?;
    let materials = Materials::new(vec![(0, block.material()?), (1, soft)])?;
    block.setup_on(mesh.with_regions(regions)?, materials)
}

/// Poisson's ratios and stiffness jumps.
#[must_use]
pub fn cases() -> Vec<Case> {
    const NU: &str = "Poisson's ratio";
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
        cases.push(Case::new(NU, format!("nu {poisson}"), hard, move || {
            block.setup()
        }));
    }
    for ratio in [1e3, 1e6, 1e9] {
        let between = Block {
            cells: [3; 3],
            steps: 2,
            gap: 0.0,
            ..Block::default()
        };
        cases.push(
            Case::new(
                JUMP,
                format!("between subdomains {ratio:e}"),
                "the middle subdomain is soft, the jump falls on an interface; its contact nodes belong to stiff and soft parts",
                move || jump(&between, ratio, |x| x[0] > 1.0 && x[0] < 2.0),
            ),
        );
        let inside = Block {
            boxes: [3, 1, 1],
            gap: 0.0,
            ..Block::default()
        };
        cases.push(Case::new(
            JUMP,
            format!("inside subdomains {ratio:e}"),
            "soft inclusions inside every subdomain: K+ itself is badly conditioned",
            move || {
                jump(&inside, ratio, |x| {
                    (0..3).all(|c| (x[c].rem_euclid(1.0) - 0.5).abs() < 0.26)
                })
            },
        ));
        let layered = Block {
            boxes: [3, 1, 1],
            gap: 0.0,
            ..Block::default()
        };
        cases.push(Case::new(
            JUMP,
            format!("soft contact layer {ratio:e}"),
            "the layer that touches is soft: contact rows are that much more flexible than glued ones",
            move || {
                let block = Block {
                    top: layered.top.map(|v| v / ratio),
                    end: layered.end.map(|v| v / ratio),
                    ..layered.clone()
                };
                jump(&block, ratio, |x| x[2] < 0.25)
            },
        ));
    }
    cases
}
