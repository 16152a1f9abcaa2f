//! Two blocks whose meshes do not match: the patch test, what the ratio of the meshes and of the stiffnesses costs, how
//! products grow with the number of subdomains, and what the search for facets takes.

use super::{Failure, Finding, RunFacts, below, second, solve};
use signorini::prelude::*;

/// A block on another of the same size, of so many cells. Those of as many cells are images of each other: their meshes
/// match.
fn blocks(size: [f64; 3], lower: [usize; 3], upper: [usize; 3]) -> Result<TetMesh, Failure> {
    let lowest = Brick::new(size, lower).build()?;
    let above = if lower == upper {
        let image = below(&lowest)?.map_points(|[x, y, z]| [x, y, z + 2.0 * size[2]])?;
        image.map_tags(|tag| match tag {
            tag if tag == second(brick::Z_MIN) => second(brick::Z_MAX),
            tag if tag == second(brick::Z_MAX) => second(brick::Z_MIN),
            tag => tag,
        })
    } else {
        let above = Brick::new(size, upper).build()?;
        above.map_points(|[x, y, z]| [x, y, z + size[2]])?.map_tags(second)
    };
    let mesh = lowest.append(&above)?;
    let bodies = mesh.components();
    Ok(mesh.with_regions(bodies)?)
}

/// A unit cube on a unit cube, of so many cells an edge.
fn cubes(lower: usize, upper: usize) -> Result<TetMesh, Failure> {
    blocks([1.0; 3], [lower; 3], [upper; 3])
}

fn materials(young: [f64; 2]) -> Result<Materials, Failure> {
    let [below, above] = young.map(|young| Hooke::isotropic(young, 0.3));
    Ok(Materials::new(vec![(0, below?), (1, above?)])?)
}

/// Uniform pressure: the largest error of pressure, relative.
fn patch([lower, upper]: [usize; 2]) -> Result<Finding, Failure> {
    let pressure = 25.0;
    let axis = |c: usize| [c == 0, c == 1, c == 2];
    let mut scene = Scene::new(cubes(lower, upper)?, materials([2000.0; 2])?)
        .with_support(Support::components(brick::Z_MIN, axis(2)))
        .with_load(Load::pressure(second(brick::Z_MAX), pressure))
        .with_contact(Contact::between(second(brick::Z_MIN), brick::Z_MAX));
    for (tag, c) in [(brick::X_MIN, 0), (brick::Y_MIN, 1)] {
        for tag in [tag, second(tag)] {
            scene = scene.with_support(Support::components(tag, axis(c)));
        }
    }
    let mut worst = 0.0;
    let run = solve(scene, Settings::default().with_tolerance(1e-10), |result| {
        let off = |p: &PointState| (-p.normal_force / p.area / pressure - 1.0).abs();
        worst = result.points().iter().map(off).fold(0.0, f64::max);
    })?;
    Ok(Finding {
        case: format!("patch test, {lower} on {upper} cells"),
        quantity: "pressure, error",
        value: worst,
        target: 0.0,
        asked: 1e-9,
        run,
    })
}

/// How the blocks are cut.
#[derive(Clone, Copy)]
enum Cut {
    /// As the library does of itself.
    Own,
    Boxes([usize; 3]),
}

/// Pressed and pulled, with friction 0.2.
fn pulled(case: String, mesh: TetMesh, area: f64, ratio: f64, cut: Cut) -> Result<Finding, Failure> {
    let scene = Scene::new(mesh, materials([1e9, 1e9 * ratio])?)
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(Load::traction(second(brick::Z_MAX), [1e5, 0.0, -1e6]))
        .with_contact(Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(Friction::coulomb(0.2)));
    let scene = match cut {
        Cut::Own => scene,
        Cut::Boxes(boxes) => scene.with_boxes(boxes),
    };
    let mut force = 0.0;
    let run = solve(scene, Settings::default(), |result| {
        force = result.summary().resultant[0]
    })?;
    Ok(Finding {
        case: format!("pulled, {case}, {} subdomains", run.subdomains),
        quantity: "friction force, N",
        value: force,
        target: -1e5 * area,
        asked: 1e-6,
        run,
    })
}

/// Pairs of meshes in the ratios 1/3 to 3, beside matching ones of the finer side: products of each pair over those.
/// The rows of the pairs are left out of long lists where all blocks have the same boxes.
fn ratios(n: usize, ratio: f64, cut: Cut, short: bool, all: &mut Vec<Finding>) -> Result<(), Failure> {
    let mut worst: (f64, RunFacts) = (0.0, RunFacts::default());
    let finer = [n + 1, 3 * n / 2, 2 * n, 3 * n];
    for &finer in if short { &finer[1..3] } else { &finer[..] } {
        let mut of = |[lower, upper]: [usize; 2]| {
            let case = format!("{lower} below {upper} cells, stiffness 1 : {ratio}");
            let finding = pulled(case, cubes(lower, upper)?, 1.0, ratio, cut)?;
            let run = finding.run;
            if short || matches!(cut, Cut::Own) {
                all.push(finding);
            }
            Ok::<_, Failure>(run)
        };
        let matching = of([finer, finer])?;
        for pair in [[n, finer], [finer, n]] {
            let run = of(pair)?;
            let over = run.products as f64 / matching.products as f64;
            if over > worst.0 {
                worst = (over, run);
            }
        }
    }
    let how = match cut {
        Cut::Own => "as the library cuts",
        Cut::Boxes(_) => "in 2 x 2 x 2 boxes each, whatever their cells",
    };
    all.push(Finding {
        case: format!("pairs over matching meshes, stiffness 1 : {ratio}, {how}"),
        quantity: "products beyond those of matching meshes, most, share",
        value: (worst.0 - 1.0).max(0.0),
        target: 0.0,
        asked: 0.3,
        run: worst.1,
    });
    Ok(())
}

/// Blocks of 2.5 x 1 x 1, so many cells an edge of a subdomain in both, 40 subdomains and 8 and 64 times as many.
fn growth([lower, upper]: [usize; 2], most: usize, all: &mut Vec<Finding>) -> Result<(), Failure> {
    let mut products = Vec::new();
    let mut last = RunFacts::default();
    for fine in [1, 2, 4].into_iter().filter(|f| *f <= most) {
        let cells = |n: usize| [5, 2, 2].map(|k| k * n * fine);
        let mesh = blocks([2.5, 1.0, 1.0], cells(lower), cells(upper))?;
        let case = format!("{lower} below {upper} cells a subdomain");
        let finding = pulled(case, mesh, 2.5, 1.0, Cut::Boxes([5 * fine, 2 * fine, 4 * fine]))?;
        products.push(finding.run.products as f64);
        last = finding.run;
        all.push(finding);
    }
    if let [first, .., end] = products[..] {
        all.push(Finding {
            case: format!(
                "{lower} below {upper} cells a subdomain, from 40 to {}",
                last.subdomains
            ),
            quantity: "growth of products, share",
            value: (end / first - 1.0).max(0.0),
            target: 0.0,
            asked: 0.1,
            run: last,
        });
    }
    Ok(())
}

/// Seconds of the search, which is a part of the set-up, over those that assemble the bodies (none of whose subdomains
/// share matrices), and over those of the set-up.
fn search(n: usize) -> Result<[Finding; 2], Failure> {
    let mesh = blocks([1.0, 1.0, 0.1], [n, n, 7], [n + 1, n + 1, 7])?;
    let facets = [n, n + 1].map(|n| 2 * n * n);
    let scene = Scene::new(mesh, materials([1e9; 2])?)
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(Load::traction(second(brick::Z_MAX), [0.0, 0.0, -1e6]))
        .with_contact(Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(Friction::coulomb(0.2)));
    let run = RunFacts {
        tets: scene.mesh().tets().len(),
        ..RunFacts::default()
    };
    let simulation = Simulation::new(scene, Settings::default().with_share_translates(false))?;
    let seconds = simulation.search_time().as_secs_f64();
    let of = |quantity, whole: f64| Finding {
        case: format!("search, {} facets below {}", facets[0], facets[1]),
        quantity,
        value: seconds / whole,
        target: 0.0,
        // seconds depend on the machine
        asked: 0.0,
        run,
    };
    Ok([
        of(
            "seconds over those of assembly",
            simulation.tfeti().report().assembly_seconds,
        ),
        of("share of the set-up", simulation.setup_time().as_secs_f64()),
    ])
}

/// All of them, for several ratios.
pub fn findings(short: bool) -> Result<Vec<Finding>, Failure> {
    let n = if short { 4 } else { 8 };
    let mut all = Vec::new();
    for [a, b] in [[n, 3 * n], [3 * n, n], [n, n + 1], [3 * n / 2, n]] {
        if !short || a.max(b) < 3 * n {
            all.push(patch([a, b])?);
        }
    }
    if short {
        ratios(n, 1.0, Cut::Boxes([2, 2, 4]), true, &mut all)?;
    } else {
        for cut in [Cut::Own, Cut::Boxes([2, 2, 4])] {
            for ratio in [1.0, 1e3, 1e-3] {
                ratios(n, ratio, cut, false, &mut all)?;
            }
        }
    }
    for pair in [[4, 4], [4, 6], [6, 4]] {
        let pair = if short { pair.map(|c| c / 2) } else { pair };
        growth(pair, if short { 1 } else { 4 }, &mut all)?;
    }
    all.extend(search(if short { 20 } else { 71 })?);
    Ok(all)
}
