//! How much the final state depends on the loading history.

use signorini_studies::run::Outcome;

/// Compares two runs of the same brick under the same final loads, in words; `None` if the meshes differ or a run
/// has no step.
pub(crate) fn dependence(first: &Outcome, second: &Outcome) -> Option<String> {
    let (a, b) = (&first.snapshot, &second.snapshot);
    let (x, y) = (first.record.steps.last()?, second.record.steps.last()?);
    if a.points != b.points || a.contact.nodes != b.contact.nodes {
        return None;
    }
    let flat = |u: &[[f64; 3]]| u.iter().flatten().copied().collect::<Vec<f64>>();
    let [pull, other] = [x, y].map(|s| s.tangential_force[0]);
    Some(format!(
        "n = {}: friction force along x1 {pull:.4e} N ({}), {other:.4e} N ({}): {:+.2} %; normal force {:.4e} N, \
         {:+.2} %; \
         fields, difference over the first: |lambda_T| {:.2} %, lambda_nu {:.2} %, u {:.3} %",
        first.record.n,
        a.loading,
        b.loading,
        100.0 * (other - pull) / pull,
        x.normal_force,
        100.0 * (y.normal_force - x.normal_force) / x.normal_force,
        percent(&a.contact.friction(), &b.contact.friction()),
        percent(&a.contact.normal_force, &b.contact.normal_force),
        percent(&flat(&a.displacement), &flat(&b.displacement)),
    ))
}

/// Euclidean norm of `a - b` over that of `a`, in percent; 0 if both vanish.
fn percent(a: &[f64], b: &[f64]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum();
    let own: f64 = a.iter().map(|x| x * x).sum();
    if squares == 0.0 { 0.0 } else { 100.0 * (squares / own).sqrt() }
}
