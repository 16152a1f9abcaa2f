//! Two plates and a bolt: it is tightened by 10 kN, keeps its length from then on, and the plates are pulled apart.
//!
//! Of the force that pulls, the bolt takes a small part; the rest relieves the plates, until they part and the bolt
//! takes all of it.

use signorini::fem_mesh::mesh::drop_unused_nodes;
use signorini::fem_mesh::vec3::centroid;
use signorini::prelude::*;

/// Edge of a cell, m.
const CELL: f64 = 0.0025;

fn main() -> Result<(), Error> {
    println!("  t in s  pull in kN  bolt in kN  plates in kN  shortened by in um");
    for [time, pull, bolt, plates, shortened] in rows()? {
        println!("{time:>8.2} {pull:>11.2} {bolt:>11.3} {plates:>13.3} {shortened:>19.3}");
    }
    Ok(())
}

/// Of each step the time, s, the forces that pull, in the bolt and between the plates, kN, and by how much the bolt has
/// been shortened, micrometres.
pub fn rows() -> Result<Vec<[f64; 5]>, Error> {
    let mut simulation = Simulation::new(scene()?, Settings::default())?;
    let mut rows = Vec::new();
    while !simulation.is_finished() {
        let result = simulation.step()?;
        result.require_converged()?;
        let reactions = result.reactions();
        let [pull, bolt, plates] =
            [reactions.loads, reactions.contacts[0], reactions.contacts[1]].map(|r| r.force[2] / 1e3);
        let shortened = result.couplings()[0].displacement[2] * 1e6;
        rows.push([result.time(), pull, bolt, plates, shortened]);
    }
    Ok(rows)
}

/// The part of a block of cells about the origin whose places `is_inside` says, with the tags of its faces across z.
fn part(cells: [usize; 3], z: f64, first: u32, is_inside: impl Fn([f64; 3]) -> bool) -> Result<TetMesh, Error> {
    let lengths = cells.map(|n| n as f64 * CELL);
    let block = Brick::new(lengths, cells).build()?;
    let (mut points, mut tets) = (block.points().to_vec(), block.tets().to_vec());
    for x in &mut points {
        *x = [x[0] - lengths[0] / 2.0, x[1] - lengths[1] / 2.0, x[2] + z];
    }
    tets.retain(|tet| is_inside(centroid(&tet.map(|n| points[n as usize]))));
    drop_unused_nodes(&mut points, &mut tets, &mut []);
    // inner faces of the bolt apart from its ends
    let layer = |x: [f64; 3]| u32::from(x[2].abs() < 4.5 * CELL);
    let tag = |x, n: [f64; 3]| (n[2].abs() > 0.5).then(|| FacetTag(first + 2 * layer(x) + u32::from(n[2] > 0.0)));
    Ok(TetMesh::new(points, tets, Vec::new())?.tag_boundary(tag))
}

/// Plates of 10 mm with a hole of 10 mm, a bolt of 5 mm in it.
fn scene() -> Result<Scene, Error> {
    let hole = |x: [f64; 3]| x[0].abs().max(x[1].abs()) > 2.0 * CELL;
    let bolt = |x: [f64; 3]| x[2].abs() > 4.0 * CELL || x[0].abs().max(x[1].abs()) < CELL;
    let lower = part([16, 16, 4], -4.0 * CELL, 10, hole)?;
    let upper = part([16, 16, 4], 0.0, 20, hole)?;
    let bolt = part([6, 6, 12], -6.0 * CELL, 30, bolt)?;
    // faces across z with these tags: below and above of each part, and of the bolt under its head and above its nut
    let [bottom, seam_below, seam_above, top, head, nut] = [12, 13, 22, 23, 32, 33].map(FacetTag);
    let is_below = |tet: usize| Some(centroid(&bolt.tet_points(tet))[2] < 0.0);
    let cut = [FacetTag(1), FacetTag(2)];
    let (bolt, _) = bolt.cut(is_below, cut)?;
    let mesh = lower.append(&upper)?.append(&bolt)?;

    let rough = |a, b| Contact::between(a, b).with_friction(Friction::coulomb(0.2));
    let along = Coupling::relative(0, [0.0; 3]).with_axis([0.0, 0.0, 1.0]);
    let along = along.with_held([false, true, true, true, true, true]);
    let tighten = History::table(vec![(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)])?;
    let pull = History::table(vec![(0.0, 0.0), (1.0, 0.0), (2.0, 1.0)])?;
    Ok(Scene::new(mesh, Materials::uniform(Hooke::isotropic(2.1e11, 0.3)?))
        .with_support(Support::fixed(bottom))
        .with_contact(Contact::tied(cut[0], cut[1]))
        .with_contact(rough(seam_above, seam_below))
        .with_contact(rough(head, top))
        .with_contact(rough(nut, bottom))
        .with_coupling(along.with_lock([true, false, false, false, false, false], 1.0))
        .with_load(Load::on_coupling(0, [0.0, 0.0, 1e4], [0.0; 3]).with_history(tighten))
        .with_load(Load::force(top, [0.0, 0.0, 15e3]).with_history(pull))
        .with_analysis(Analysis::quasistatic(2.0, 12)))
}
