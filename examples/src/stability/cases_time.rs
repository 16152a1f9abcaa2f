//! Steps in time, cells in a subdomain, number of subdomains.

use super::block::Block;
use super::case::Case;
use signorini::prelude::*;

/// Steps, H/h, subdomains.
#[must_use]
pub fn cases() -> Vec<Case> {
    const STEPS: &str = "Time steps";
    const CELLS: &str = "Cells in a subdomain";
    const PARTS: &str = "Number of subdomains";
    let mut cases = Vec::new();
    for steps in [0, 1, 3, 100, 1000] {
        let hard = match steps {
            0 => "no history: one state of equilibrium",
            1 => "everything happens in one step",
            1000 => "errors must not build up",
            _ => "ordinary steps",
        };
        for formula in [DifferenceFormula::BACKWARD_EULER, DifferenceFormula::PAPER] {
            if steps == 0 && formula == DifferenceFormula::PAPER {
                continue;
            }
            let block = Block {
                cells: [2; 3],
                steps,
                formula,
                ..Block::default()
            };
            let name = if formula == DifferenceFormula::PAPER {
                "3/2 -2 1/2"
            } else {
                "backward Euler"
            };
            let case = Case::new(STEPS, format!("{steps} steps, {name}"), hard, move || {
                block.setup()
            });
            cases.push(if steps == 1000 { case.long() } else { case });
        }
    }
    for cells in [1, 2, 4, 8, 16] {
        let block = Block {
            cells: [cells; 3],
            steps: if cells == 16 { 1 } else { 3 },
            ..Block::default()
        };
        let case = Case::new(
            CELLS,
            format!("H/h {cells}"),
            if cells == 1 {
                "hardly any inner node; every node is glued or on the surface"
            } else {
                "the condition of F grows like H/h"
            },
            move || block.setup(),
        );
        cases.push(if cells > 8 { case.long() } else { case });
    }
    for boxes in [[1, 1, 1], [3, 1, 1], [6, 2, 2], [12, 4, 4]] {
        let block = Block {
            boxes,
            cells: [12 / boxes[0], 4 / boxes[1], 4 / boxes[2]],
            steps: 3,
            ..Block::default()
        };
        let n = boxes.iter().product::<usize>();
        let case = Case::new(
            PARTS,
            format!("{n} subdomains of one mesh"),
            "the cut must not show in the result",
            move || block.setup(),
        );
        cases.push(if n == 1 {
            case
        } else {
            case.same_as("1 subdomains of one mesh", 1e-5)
        });
    }
    let many = Block {
        boxes: [27, 9, 9],
        cells: [2; 3],
        steps: 1,
        ..Block::default()
    };
    cases.push(
        Case::new(
            PARTS,
            "2187 subdomains",
            "a coarse problem of 13122 unknowns",
            move || many.setup(),
        )
        .long(),
    );
    cases
}
