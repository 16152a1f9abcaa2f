//! A picture of any result in one call: the deformed body, coloured, as SVG.

use signorini::contact::StepResult;
use signorini::fem_mesh::fields::von_mises;

use crate::surface::{Panel, Style, picture};

/// Largest displacement as it is drawn, over the longest side of the box around the body.
const DRAWN: f64 = 0.05;

/// What colours show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// Length of the displacement.
    Displacement,
    /// Von Mises stress, the mean of the tetrahedra around a node.
    VonMises,
    /// Contact pressure of all surfaces; zero elsewhere.
    ContactPressure,
}

/// The body of a result after its step, seen from `eye`, with displacements enlarged so that they are seen. Units are
/// those of the scene; values far above all others (in sharp corners) take the scale with them.
pub fn result(result: &StepResult, shown: Shown, eye: [f64; 3]) -> String {
    let mesh = result.scene().mesh();
    let (places, displacement) = (mesh.points(), result.displacement());
    let triangles: Vec<[u32; 3]> = mesh.boundary_facets().iter().map(|f| f.nodes).collect();
    let length = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let largest = displacement.iter().map(length).fold(0.0, f64::max);
    let side = |c: usize| {
        let values = || places.iter().map(|p| p[c]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    let extent = (0..3).map(side).fold(0.0, f64::max);
    let by = if largest > 0.0 { DRAWN * extent / largest } else { 0.0 };
    let moved = places.iter().zip(&displacement);
    let points = moved.map(|(x, u)| [0, 1, 2].map(|c| x[c] + by * u[c])).collect();
    let (title, scale, values) = match shown {
        Shown::Displacement => ("displacement", "length", displacement.iter().map(length).collect()),
        Shown::VonMises => ("von Mises stress", "stress", mises(result)),
        Shown::ContactPressure => ("contact pressure", "stress", pressure(result)),
    };
    let panel = Panel {
        title: format!("{title} at t = {}", result.time()),
        note: format!("displacements {by:.3} times as large; the largest is {largest:.3e}"),
        points,
        triangles: &triangles,
        values: &values,
        behind: Vec::new(),
        before: Vec::new(),
    };
    let style = Style {
        eye,
        flat: false,
        scale,
        factor: 1.0,
        unit: "",
    };
    picture(&style, &[panel])
}

fn mises(result: &StepResult) -> Vec<f64> {
    let mesh = result.scene().mesh();
    let (mut sums, mut counts) = (vec![0.0; mesh.points().len()], vec![0.0; mesh.points().len()]);
    for (tet, stress) in mesh.tets().iter().zip(result.stress()) {
        for &node in tet {
            sums[node as usize] += von_mises(&stress);
            counts[node as usize] += 1.0;
        }
    }
    sums.iter().zip(&counts).map(|(sum, count)| sum / count).collect()
}

fn pressure(result: &StepResult) -> Vec<f64> {
    let mut values = vec![0.0_f64; result.scene().mesh().points().len()];
    for (k, surface) in result.surfaces().iter().enumerate() {
        let own = result.contact_pressure(k).unwrap_or_default();
        for (&node, pressure) in surface.nodes().iter().zip(own) {
            let value = &mut values[node as usize];
            *value = value.max(pressure);
        }
    }
    values
}
