//! The plan as a table.

use super::cost::SLENDER;
use super::effects::FrictionKind;
use super::plan::Plan;
use std::fmt;

/// Unknowns of a subdomain from which on cutting it further pays: about ten cells an edge.
const LARGE: usize = 4000;

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let e = &self.effects;
        let yes = |on: bool, text: String, absent: &str| {
            if on { text } else { format!("none ({absent})") }
        };
        writeln!(f, "plan")?;
        writeln!(
            f,
            "  mesh        {} tetrahedra, {} nodes",
            self.elements, self.nodes
        )?;
        writeln!(
            f,
            "  subdomains  {} ({} torn unknowns)",
            self.subdomains, self.primal
        )?;
        if self.primal > LARGE * self.subdomains {
            writeln!(
                f,
                "              large ones: 4 to 6 cells an edge each are faster (leave the partition to the library, or with_subdomains)"
            )?;
        }
        if self.estimate.is_mostly_coarse() {
            writeln!(
                f,
                "              too small ones: their {} rigid motions take most of the time; some hundred tetrahedra each are faster",
                self.coarse
            )?;
        }
        // the estimate of a brick of 3 : 1 has no part for bending
        if e.contact && self.slenderness > 1.2 * SLENDER {
            writeln!(
                f,
                "              slender ones, {:.0} : 1: such as are as long as thick need far fewer products",
                self.slenderness
            )?;
        }
        let gluing = format!("{} rows", self.interface_rows);
        writeln!(
            f,
            "  gluing      {}",
            yes(e.gluing, gluing, "one subdomain")
        )?;
        let moving = if e.motion { ", moving" } else { "" };
        writeln!(
            f,
            "  supports    {}",
            yes(
                e.supports,
                format!("{} rows{moving}", self.dirichlet_rows),
                "free body"
            )
        )?;
        let gap = match self.gaps.filter(|_| e.gap) {
            None => "no gap: zero offset".to_owned(),
            Some([low, high]) => {
                let inside = if low < 0.0 { ", starts inside" } else { "" };
                format!("gaps {low:.3e} to {high:.3e} m{inside}")
            }
        };
        let moving = if e.moving_obstacle {
            ", moving obstacle"
        } else {
            ""
        };
        let partners = if e.partners { ", between bodies" } else { "" };
        let contact = format!("{} nodes, {gap}{moving}{partners}", self.contact_nodes);
        writeln!(
            f,
            "  contact     {}",
            yes(e.contact, contact, "no inequality solver")
        )?;
        let friction = match e.friction {
            FrictionKind::None => "none (no tangential rows)".to_owned(),
            FrictionKind::Tresca => format!("given, {} rows, no outer loop", self.tangential_rows),
            FrictionKind::Coulomb => {
                format!("Coulomb, {} rows, no slip rate", self.tangential_rows)
            }
            FrictionKind::RateDependent => {
                format!("Coulomb, rate dependent, {} rows", self.tangential_rows)
            }
        };
        writeln!(f, "  friction    {friction}")?;
        let history = format!("{} levels, old traces kept", self.levels);
        writeln!(
            f,
            "  history     {}",
            yes(e.history, history, "each level stands alone")
        )?;
        writeln!(
            f,
            "  dual        {} rows, coarse {}",
            self.dual(),
            self.coarse
        )?;
        writeln!(f, "  method      {}", self.method)?;
        let mb = |bytes: u64| bytes as f64 / 1e6;
        let e = &self.estimate;
        writeln!(
            f,
            "  memory      vectors {:.1} MB; estimated: inverses {:.1} MB ({} classes), coarse {:.1} MB, tables {:.1} MB",
            mb(self.vector_bytes),
            mb(e.inverse_bytes),
            e.classes,
            mb(e.coarse_bytes),
            mb(e.table_bytes)
        )?;
        write!(
            f,
            "  estimate    {} products ({} to {}) of {:.2} ms, set-up {:.2} s, all levels {:.2} s ({:.2} to {:.2}) on one processor",
            e.products,
            e.fewest_products,
            e.most_products,
            1e3 * e.product_seconds(),
            e.setup_seconds(),
            e.solve_seconds(),
            e.solve_seconds_range()[0],
            e.solve_seconds_range()[1]
        )
    }
}
