//! A crack inside a plate: it is pressed shut, and then sheared to and fro.
//!
//! Faces of a closed crack slide by the shear stress that friction leaves. So they slide once that exceeds `mu p`, and
//! back only after it has fallen by twice as much: slip lags behind the load, and work is lost in every cycle.

use signorini::fem_mesh::vec3;
use signorini::prelude::*;

/// Tags of the faces of the crack.
const LOWER: FacetTag = FacetTag(11);
const UPPER: FacetTag = FacetTag(12);

/// Friction over the largest shear stress.
pub const FRICTION: f64 = 0.3;

fn main() -> Result<(), Error> {
    println!("  load   slip in m");
    for (load, slip) in SHEAR.into_iter().zip(slips(4)?) {
        println!("{load:>6.2} {slip:>11.3e}");
    }
    Ok(())
}

/// The mean slip at the end of each step, m.
pub fn slips(cells: usize) -> Result<Vec<f64>, Error> {
    let mut simulation = Simulation::new(scene(cells)?, Settings::default())?;
    let faces = [UPPER, LOWER].map(|tag| simulation.scene().mesh().nodes_on(tag));
    let mut slips = Vec::new();
    while !simulation.is_finished() {
        let result = simulation.step()?;
        result.require_converged()?;
        let u = result.displacement();
        let [upper, lower] = [&faces[0], &faces[1]].map(|nodes| nodes.iter().map(|n| u[*n as usize][0]).sum::<f64>());
        slips.push((upper - lower) / faces[0].len() as f64);
    }
    Ok(slips)
}

/// The shear at the end of each step, over the largest.
pub const SHEAR: [f64; 6] = [0.0, 1.0, 0.2, -1.0, -0.6, 1.0];

/// A plate of 4 m x 4 m in plane strain, `cells` cells along a metre (even), with a crack of 2 m in its middle.
pub fn scene(cells: usize) -> Result<Scene, Error> {
    let (young, poisson, strain) = (1e9, 0.25, 1e-3);
    let n = 4 * cells;
    let plate = Brick::new([4.0, 4.0 / n as f64, 4.0], [n, 1, n])
        .with_origin([-2.0, 0.0, -2.0])
        .build()?;
    let is_on = |face: [[f64; 3]; 3]| face.iter().all(|[x, _, z]| x.abs() < 1.01 && *z == 0.0);
    let is_lower = |tet: usize| vec3::centroid(&plate.tet_points(tet))[2] < 0.0;
    let (mesh, _) = plate.crack(is_on, is_lower, [LOWER, UPPER])?;
    let mesh = mesh.raise_order()?;
    // a uniform strain across the crack and one along it
    let outer = [brick::X_MIN, brick::X_MAX, brick::Z_MIN, brick::Z_MAX];
    let mut outer: Vec<u32> = outer.into_iter().flat_map(|tag| mesh.nodes_on(tag)).collect();
    outer.sort_unstable();
    outer.dedup();
    let height = |node: &u32| strain * mesh.points()[*node as usize][2];
    let across: Vec<[f64; 3]> = outer.iter().map(|node| [0.0, 0.0, -height(node)]).collect();
    let along: Vec<[f64; 3]> = outer.iter().map(|node| [height(node), 0.0, 0.0]).collect();
    let press = History::constant(1.0);
    let shear = (0..).map(|k| f64::from(k) + 1.0).zip(SHEAR);
    let shear = History::table([(0.0, 0.0)].into_iter().chain(shear).collect())?;
    // shear modulus over the modulus of a strain without others
    let ratio = (1.0 - 2.0 * poisson) / (2.0 * (1.0 - poisson));
    Ok(Scene::new(mesh, Materials::uniform(Hooke::isotropic(young, poisson)?))
        .with_support(Support::components(outer.clone(), [false, false, true]).with_motions(across, press))
        .with_support(Support::components(outer, [true, false, false]).with_motions(along, shear))
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        .with_support(Support::components(brick::Y_MAX, [false, true, false]))
        .with_contact(Contact::between(LOWER, UPPER).with_friction(Friction::coulomb(FRICTION * ratio)))
        .with_analysis(Analysis::quasistatic(SHEAR.len() as f64, SHEAR.len())))
}
