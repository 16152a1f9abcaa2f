//! The tables, in Markdown. Two figures with a bar between them are prediction and truth.

use std::io::Write;

use signorini::contact::Rate;

use signorini_studies::Failure;

use super::Line;

pub(super) fn effects(lines: &[Line], out: &mut impl Write) -> Result<(), Failure> {
    writeln!(
        out,
        "Rows, factorisations, bytes, products and seconds: plan / truth.\n\n\
         | effect | steps | rows N | rows T | glue | supports | factorisations | set-up KB | state KB | products \
         | inequality solves | slip bounds | rates | set-up ms | steps ms | extra ms |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
    )?;
    for l in lines {
        let (p, t) = (&l.plan, &l.truth);
        writeln!(
            out,
            "| {} | {} | {} | {} | {} | {} | {} | {:.0} / {:.0} | {:.0} | {} | {} | {} | {} | {:.0} / {:.0} | {:.0} / \
             {:.0} | {:.1} |",
            l.name,
            l.steps,
            pair(p.normal_rows, t.normal_rows),
            pair(p.tangential_rows, t.tangential_rows),
            pair(p.interface_rows, t.interface_rows),
            pair(p.support_rows, t.support_rows),
            pair(p.factorisations, t.factorisations),
            p.bytes as f64 / 1e3,
            t.bytes as f64 / 1e3,
            l.state_bytes as f64 / 1e3,
            pair(p.products, t.products),
            l.inequality_solves,
            l.slip_bound_updates,
            l.rate_updates,
            1e3 * p.setup_seconds,
            1e3 * t.setup_seconds,
            1e3 * p.solve_seconds,
            1e3 * t.solve_seconds,
            1e3 * l.extra_seconds,
        )?;
    }
    Ok(())
}

pub(super) fn estimates(lines: &[Line], rate: Rate, out: &mut impl Write) -> Result<(), Failure> {
    writeln!(
        out,
        "\nThe benchmark, loading c: plan / truth. This machine: {:.0} GFLOPS, {:.1} numbers a nanosecond.\n\n\
         | size | rows | factorisations | set-up MB | products | set-up s | steps s |\n|---|---|---|---|---|---|---|",
        rate.flops / 1e9,
        rate.numbers / 1e9
    )?;
    for l in lines {
        let (p, t) = (&l.plan, &l.truth);
        writeln!(
            out,
            "| {} | {} | {} | {:.2} / {:.2} | {} / {} | {:.3} / {:.3} | {:.2} / {:.2} |",
            l.name,
            pair(p.rows(), t.rows()),
            pair(p.factorisations, t.factorisations),
            p.bytes as f64 / 1e6,
            t.bytes as f64 / 1e6,
            p.products,
            t.products,
            p.setup_seconds,
            t.setup_seconds,
            p.solve_seconds,
            t.solve_seconds,
        )?;
    }
    Ok(())
}

pub(super) fn shapes(lines: &[Line], out: &mut impl Write) -> Result<(), Failure> {
    writeln!(
        out,
        "\nOther scenes: the plan's products and the truth.\n\n\
         | scene | steps | rows | likely | truth | truth / likely | steps that fell back \
         |\n|---|---|---|---|---|---|---|"
    )?;
    for l in lines {
        let truth = l.truth.products;
        writeln!(
            out,
            "| {} | {} | {} | {} | {truth} | {:.2} | {} |",
            l.name,
            l.steps,
            l.truth.rows(),
            l.plan.products,
            truth as f64 / l.plan.products as f64,
            l.fallbacks,
        )?;
    }
    Ok(())
}

/// One figure if the plan is exact.
fn pair(plan: usize, truth: usize) -> String {
    if plan == truth { truth.to_string() } else { format!("{plan} / {truth}") }
}
