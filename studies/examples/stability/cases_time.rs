//! Steps in time, cells in a subdomain, number of subdomains.

use signorini_studies::brick::{Block, EULER, PAPER_FORMULA};

use super::case::Case;

/// Steps, H/h, subdomains.
pub(crate) fn cases() -> Vec<Case> {
    const PARTS: &str = "Number of subdomains";
    let mut cases = Vec::new();
    for steps in [0, 1, 3, 100, 1000] {
        let hard = match steps {
            0 => "no history: one state of equilibrium",
            1 => "everything happens in one step",
            1000 => "errors must not build up",
            _ => "ordinary steps",
        };
        for (name, formula) in [("backward Euler", EULER), ("3/2 -2 1/2", PAPER_FORMULA)] {
            if steps == 0 && formula == PAPER_FORMULA {
                continue;
            }
            let block = Block {
                cells: [2; 3],
                steps,
                formula,
                ..Block::default()
            };
            let case = Case::brick("Time steps", format!("{steps} steps, {name}"), hard, block);
            cases.push(if steps == 1000 { case.long() } else { case });
        }
    }
    for cells in [1, 2, 4, 8, 16] {
        let hard = match cells {
            1 => "hardly any inner node; every node is glued or on the surface",
            _ => "the condition of F grows like H/h",
        };
        let steps = if cells == 16 { 1 } else { 3 };
        let block = Block {
            cells: [cells; 3],
            steps,
            ..Block::default()
        };
        let case = Case::brick("Cells in a subdomain", format!("H/h {cells}"), hard, block);
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
        let name = format!("{n} subdomains of one mesh");
        let case = Case::brick(PARTS, name, "the cut must not show in the result", block);
        cases.push(match n {
            1 => case,
            _ => case.same_as("1 subdomains of one mesh", 1e-5),
        });
    }
    let many = Block {
        boxes: [27, 9, 9],
        cells: [2; 3],
        steps: 1,
        ..Block::default()
    };
    let hard = "a coarse problem of 13122 unknowns";
    cases.push(Case::brick(PARTS, "2187 subdomains", hard, many).long());
    cases
}
