//! The plan as a table.

use super::effects::FrictionKind;
use super::plan::Plan;
use std::fmt;

/// Unknowns of a subdomain from which on cutting it further pays: about ten cells an edge.
const LARGE: usize = 4000;

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cost = &self.estimate;
        let mb = |bytes: u64| bytes as f64 / 1e6;
        macro_rules! line {
            ($name:literal, $($text:tt)+) => {
                write!(f, "\n  {:<11} {}", $name, format_args!($($text)+))?
            };
        }
        write!(f, "plan")?;
        line!("mesh", "{} tetrahedra, {} nodes", self.elements, self.nodes);
        if let Some(error) = self.mesh_error {
            let percent = (100.0 * error).round();
            line!(
                "",
                "error of strains about {percent} %, mostly within a factor of 3; discretisation_error() measures it"
            );
        }
        line!("subdomains", "{} ({} torn unknowns)", self.subdomains, self.primal);
        if self.primal > LARGE * self.subdomains {
            line!("", "large ones: 4 to 6 cells an edge each are faster (with_subdomains)");
        }
        if cost.is_mostly_coarse() {
            line!(
                "",
                "too small ones: their {} rigid motions take most of the time; some hundred tetrahedra each are faster",
                self.coarse
            );
        }
        if self.effects.gluing {
            line!("gluing", "{} rows", self.interface_rows);
        } else {
            line!("gluing", "none (one subdomain)");
        }
        line!("supports", "{}", self.supports_text());
        if self.effects.ties {
            let moving = if self.effects.moving_ties { ", moving" } else { "" };
            line!("ties", "{} rows{moving}", self.tied_rows);
        }
        if self.effects.equations {
            line!("equations", "{} rows", self.equation_rows);
        }
        line!("contact", "{}", self.contact_text());
        for (contact, second) in &self.apart {
            let side = if *second { "second" } else { "first" };
            line!("", "contact {contact}: meshes do not match, points on its {side} side");
        }
        let rows = self.tangential_rows;
        match self.effects.friction {
            FrictionKind::None => line!("friction", "none (no tangential rows)"),
            FrictionKind::Tresca => line!("friction", "Tresca, {rows} rows, no outer loop"),
            FrictionKind::Coulomb => line!("friction", "Coulomb, {rows} rows, no slip rate"),
            FrictionKind::RateDependent => line!("friction", "Coulomb, rate dependent, {rows} rows"),
        }
        if self.effects.history {
            line!("history", "{} steps, old traces kept", self.steps);
        } else {
            line!("history", "none (each step stands alone)");
        }
        if self.stages > 1 {
            line!(
                "stages",
                "{}, set up one after another, the next beside the last",
                self.stages
            );
        }
        line!("dual", "{} rows, coarse {}", self.dual(), self.coarse);
        line!("method", "{}", self.method);
        let hard = match self.formed_bytes {
            0 => String::new(),
            bytes => format!("; {:.1} MB more for a hard step", mb(bytes)),
        };
        let [vectors, inverses] = [self.vector_bytes, cost.inverse_bytes].map(mb);
        let [coarse, tables] = [cost.coarse_bytes, cost.table_bytes].map(mb);
        line!(
            "memory",
            "vectors {vectors:.1} MB, inverses {inverses:.1} MB ({} classes), coarse {coarse:.1} MB, tables {tables:.1} MB{hard}",
            cost.classes
        );
        line!("products", "{} are likely", cost.products);
        if let Some(t) = &cost.times {
            let (setup, steps, product) = (t.setup, t.steps, 1e3 * t.product);
            line!(
                "time",
                "set-up {setup:.2} s, steps {steps:.2} s, a product {product:.2} ms, on one processor"
            );
        }
        for warning in self.warnings() {
            line!("warning", "{warning}");
        }
        Ok(())
    }
}

impl Plan {
    fn supports_text(&self) -> String {
        let e = &self.effects;
        let moving = if e.motion { ", moving" } else { "" };
        let others = [(e.springs, "springs"), (e.couplings, "couplings")];
        let others: Vec<&str> = others.into_iter().filter(|o| o.0).map(|o| o.1).collect();
        let with = match (e.supports, &others[..]) {
            (false, []) => return "none (free body)".to_owned(),
            (true, []) => String::new(),
            (true, others) => format!(", with {}", others.join(" and ")),
            (false, others) => format!(", {} only", others.join(" and ")),
        };
        format!("{} rows{moving}{with}", self.dirichlet_rows)
    }

    fn contact_text(&self) -> String {
        let e = &self.effects;
        if !e.contact {
            return "none (no inequality solver)".to_owned();
        }
        let gap = match self.gaps.filter(|_| e.gap) {
            None => "no gap: zero offset".to_owned(),
            Some([low, high]) => {
                let inside = if low < 0.0 { ", starts inside" } else { "" };
                let changing = if e.gap_history { ", with a history" } else { "" };
                format!("gaps {low:.3e} to {high:.3e}{inside}{changing}")
            }
        };
        let moving = if e.moving_obstacle { ", moving obstacle" } else { "" };
        let partners = if e.partners { ", between bodies" } else { "" };
        let compliant = if e.compliance { ", gives way" } else { "" };
        format!("{} nodes, {gap}{moving}{partners}{compliant}", self.normal_rows)
    }
}
