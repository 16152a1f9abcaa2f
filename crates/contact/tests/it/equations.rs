//! Linear equations: against ties and supports that say the same, closed forms, periodic cells, levers.

use crate::common::*;
use crate::couplings::YOUNG;
use signorini_contact::result::EquationForce;
use signorini_fem_mesh::vec3;
use std::collections::BTreeMap;

pub(crate) const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

pub(crate) fn minus(v: [f64; 3]) -> [f64; 3] {
    v.map(|c| -c)
}

/// Equations that let two nodes move alike.
pub(crate) fn alike(a: u32, b: u32) -> impl Iterator<Item = Equation> {
    AXES.into_iter().map(move |e| Equation::new([(a, e), (b, minus(e))]))
}

/// Nodes by their places.
pub(crate) fn by_place(mesh: &TetMesh, nodes: impl IntoIterator<Item = u32>) -> BTreeMap<[i64; 3], u32> {
    let key = |n: u32| mesh.points()[n as usize].map(|c| (c * 1e6).round() as i64);
    nodes.into_iter().map(|n| (key(n), n)).collect()
}

pub(crate) struct Found {
    pub(crate) one: Solved,
    pub(crate) reactions: Reactions,
    pub(crate) points: Vec<[f64; 3]>,
}

/// Solves a step, whose forces must be in balance.
pub(crate) fn solved(scene: Scene, settings: Settings, what: &str) -> Found {
    let mut simulation = Simulation::new(scene, settings).expect("set-up");
    let one = step(&mut simulation);
    assert_certified(&one, what);
    let result = simulation.result().expect("a step");
    let reactions = result.reactions_about([0.3, -0.2, 0.7]);
    let out = reactions.imbalance();
    let parts = reactions.supports.iter().map(|s| s.resultant);
    let parts = parts.chain(reactions.equations.iter().map(|e| e.resultant));
    let size: f64 = parts.chain([reactions.loads]).map(|r| norm(&r.force)).sum();
    let left = norm(&out.force) + norm(&out.moment);
    assert!(left < 1e-6 * size, "{what}: {out:?} of {size:e}");
    let points = result.couplings().iter().map(|c| c.displacement).collect();
    Found { one, reactions, points }
}

fn total(forces: &[EquationForce]) -> [f64; 3] {
    [0, 1, 2].map(|c| forces.iter().map(|e| e.resultant.force[c]).sum())
}

/// The sides of a cut.
pub(crate) const LOWER: FacetTag = FacetTag(31);
pub(crate) const UPPER: FacetTag = FacetTag(32);

/// A column that is cut across the middle.
pub(crate) fn column(cells: usize) -> Scene {
    let mesh = block([1.0, 1.0, 2.0], [cells, cells, 2 * cells]);
    let is_lower = |tet: usize| Some(vec3::centroid(&mesh.tet_points(tet))[2] < 1.0);
    let mesh = mesh.cut(is_lower, [LOWER, UPPER]).expect("cut").0;
    Scene::new(mesh, uniform(YOUNG, 0.3))
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(Load::traction(brick::Z_MAX, [1e6, 2e6, -3e6]))
}

/// Nodes of the upper side with those of the lower one at their places.
pub(crate) fn pairs(scene: &Scene) -> Vec<(u32, u32)> {
    let mesh = scene.mesh();
    let below = by_place(mesh, mesh.nodes_on(LOWER));
    let above = by_place(mesh, mesh.nodes_on(UPPER));
    let mut pairs: Vec<_> = above.iter().map(|(place, node)| (*node, below[place])).collect();
    pairs.sort_unstable();
    pairs
}

#[test]
fn nodes_that_move_alike_are_tied() {
    for boxes in [[1, 1, 2], [2, 2, 4]] {
        let tied = column(3).with_contact(Contact::tied(UPPER, LOWER));
        let expected = solved(tied.with_boxes(boxes), tight(), "tied");
        let joined = pairs(&column(3));
        let equations = joined.iter().flat_map(|(a, b)| alike(*a, *b));
        let found = solved(
            equations.fold(column(3), Scene::with_equation).with_boxes(boxes),
            tight(),
            "alike",
        );
        assert_close(
            &found.one.displacement,
            &expected.one.displacement,
            1e-8,
            "displacement",
        );
        let [own, tied] = [&found, &expected].map(|f| f.one.report.counters.products);
        assert!(own <= tied + 2, "{own} products, tied {tied}");
        // what the upper block gets from the lower one
        let forces = found.reactions.equations.chunks_exact(3);
        let sum = forces.fold([0.0; 3], |sum, own| [0, 1, 2].map(|c| sum[c] + own[c].multiplier));
        assert_close(&sum, &expected.reactions.contacts[0].force, 1e-8, "force");
        assert!(norm(&total(&found.reactions.equations)) < 1e-6 * norm(&sum));
    }
}

/// Sides that jump by equations are ties that move.
#[test]
fn values_are_those_of_ties_that_move() {
    let jump = [1e-4, -2e-4, 5e-5];
    let tie = Contact::tied(UPPER, LOWER).with_motion(jump, ramp());
    let expected = solved(column(3).with_contact(tie).with_boxes([2, 1, 2]), tight(), "tied");
    let parted = |(a, b)| {
        let all = alike(a, b).zip(jump);
        all.map(|(equation, jump)| equation.with_value(jump, ramp()))
    };
    let equations = pairs(&column(3)).into_iter().flat_map(parted);
    let scene = equations.fold(column(3), Scene::with_equation).with_boxes([2, 1, 2]);
    let found = solved(scene, tight(), "parted");
    assert_close(
        &found.one.displacement,
        &expected.one.displacement,
        1e-8,
        "displacement",
    );
}

/// A plane of symmetry askew, by equations and by a support.
#[test]
fn equations_of_single_nodes_are_supports() {
    let normal = [0.6, 0.0, -0.8];
    let mesh = Brick::new([1.0; 3], [3; 3]).perturbed(0.1, 5).build().expect("brick");
    for order in [1, 2] {
        let mesh = match order {
            1 => mesh.clone(),
            _ => mesh.raise_order().expect("quadratic"),
        };
        let end = mesh.nodes_on(brick::X_MAX);
        let scene = Scene::new(mesh, uniform(YOUNG, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::Z_MAX, [1e6, 2e6, -3e6]))
            .with_boxes([2, 1, 2]);
        let way = [3e-5, 0.0, -4e-5];
        let support = Support::partial(end.clone(), Directions::Vectors(vec![normal])).with_motion(way, ramp());
        let expected = solved(scene.clone().with_support(support), tight(), "support");
        // however large the coefficients are
        let on_plane = |(k, node): (usize, u32)| {
            let size = [1e-150, 1e3, 1e160][k % 3];
            Equation::new([(node, normal.map(|c| size * c))]).with_value(size * 5e-5, ramp())
        };
        let equations = end.into_iter().enumerate().map(on_plane);
        let found = solved(equations.fold(scene, Scene::with_equation), tight(), "equations");
        assert_close(
            &found.one.displacement,
            &expected.one.displacement,
            1e-8,
            "displacement",
        );
        let support = expected.reactions.supports[1].resultant.force;
        assert_close(&total(&found.reactions.equations), &support, 1e-7, "force");
        let [own, other] = [&found, &expected].map(|f| f.one.report.counters.products);
        assert!(own <= other + 3, "{own} products, supported {other}");
    }
}

/// Equations of a unit cell: opposite sides differ by the displacement of the point of their direction.
pub(crate) fn periodic(mesh: &TetMesh) -> Vec<Equation> {
    let sides = [
        (brick::X_MIN, brick::X_MAX),
        (brick::Y_MIN, brick::Y_MAX),
        (brick::Z_MIN, brick::Z_MAX),
    ];
    let mut out = Vec::new();
    for (way, (low, high)) in sides.into_iter().enumerate() {
        let opposite = by_place(mesh, mesh.nodes_on(low));
        for (mut place, node) in by_place(mesh, mesh.nodes_on(high)) {
            place[way] = 0;
            let other = opposite[&place];
            out.extend(
                alike(node, other)
                    .zip(AXES)
                    .map(|(equation, e)| equation.with_point(way, minus(e))),
            );
        }
    }
    out
}

/// A cell whose points are guided along their own direction, one node of which is held; `held` are their strains that
/// are not free.
pub(crate) fn cell(mesh: TetMesh, materials: Materials, held: [Option<f64>; 3]) -> Scene {
    let middle = mesh
        .points()
        .iter()
        .position(|p| p.iter().all(|c| (c - 0.5).abs() < 1e-9));
    let middle = middle.expect("a node in the middle") as u32;
    let equations = periodic(&mesh);
    let mut scene = Scene::new(mesh, materials).with_support(Support::fixed([middle]));
    for (way, strain) in held.into_iter().enumerate() {
        // wherever they are
        let mut on = [true; 6];
        on[way] = strain.is_some();
        let mut motion = [0.0; 6];
        motion[way] = strain.unwrap_or(0.0);
        let point = Coupling::point([1e7, way as f64, -3.0]).with_held(on);
        scene = scene.with_coupling(point.with_motion(motion, ramp()));
    }
    equations.into_iter().fold(scene, Scene::with_equation)
}

#[test]
fn a_uniform_cell_has_the_modulus_of_its_material() {
    let (stress, poisson) = (2e8, 0.3);
    let mesh = Brick::new([1.0; 3], [2; 3]).build().expect("brick");
    for mesh in [mesh.clone(), mesh.raise_order().expect("quadratic")] {
        for boxes in [[1, 1, 1], [2, 2, 2], [2, 1, 1]] {
            let scene = cell(mesh.clone(), uniform(YOUNG, poisson), [None; 3]).with_boxes(boxes);
            let loaded = scene.with_load(Load::on_coupling(0, [stress, 0.0, 0.0], [0.0; 3]));
            let plan = Plan::new(&loaded, &Settings::default()).expect("plan");
            // at edges one equation of four, at the corner five of twelve
            assert!(plan.equation_rows < loaded.equations().len());
            let found = solved(loaded, tight(), "cell");
            let strain = stress / YOUNG;
            let points = [strain, -poisson * strain, -poisson * strain];
            for (way, expected) in points.into_iter().enumerate() {
                let own = found.points[way][way];
                assert!((own - expected).abs() < 1e-9 * strain, "{boxes:?}, {way}: {own:e}");
            }
            // held in its own direction the point takes the stress
            let scene = cell(mesh.clone(), uniform(YOUNG, poisson), [Some(strain), None, None]).with_boxes(boxes);
            let found = solved(scene, tight(), "held cell");
            let force = found.reactions.couplings[0].force;
            assert!((force[0] / stress - 1.0).abs() < 1e-9, "{force:?}");
        }
    }
}

/// A small cell whose points have strains for displacements: units of their own, and forces to these.
#[test]
fn points_may_have_units_of_their_own() {
    let (length, strain, stress) = (1e-6, 1e-3, 2e8);
    let mesh = Brick::new([1.0; 3], [2; 3]).build().expect("brick");
    for boxes in [[1, 1, 1], [2, 2, 2]] {
        let plain = cell(mesh.clone(), uniform(YOUNG, 0.3), [Some(strain), None, None]);
        let small = mesh.clone().map_points(|p| p.map(|c| c * length)).expect("small");
        let scene = Scene::new(small, uniform(YOUNG, 0.3)).with_support(plain.supports()[0].clone());
        let scene = plain.couplings().iter().cloned().fold(scene, Scene::with_coupling);
        let strained = |e: &Equation| {
            let own = Equation::new(e.terms().to_vec());
            e.points()
                .iter()
                .fold(own, |own, (k, v)| own.with_point(*k, v.map(|c| c * length)))
        };
        let scene = plain.equations().iter().map(strained).fold(scene, Scene::with_equation);
        let work = stress * length.powi(3);
        let scene = scene.with_load(Load::on_coupling(1, [0.0, work, 0.0], [0.0; 3]));
        let found = solved(scene.with_boxes(boxes), tight(), "strains");
        let across = (stress - 0.3 * found.reactions.couplings[0].force[0] / length.powi(3)) / YOUNG;
        assert!((found.points[1][1] / across - 1.0).abs() < 1e-8, "{:?}", found.points);
        assert!((found.points[0][0] / strain - 1.0).abs() < 1e-9, "{:?}", found.points);
        let force = found.reactions.couplings[0].force[0] / length.powi(3);
        assert!(
            (force / (YOUNG * strain + 0.3 * stress) - 1.0).abs() < 1e-8,
            "{force:e}"
        );
    }
}

/// A bar whose end follows a point, which follows another one, loaded or moved, in whatever units; a third one is in no
/// equation, and stays.
#[test]
fn points_that_follow_points_may_have_units_of_their_own() {
    let mesh = block([4.0, 1.0, 1.0], [4, 2, 2]);
    let [x, _, _] = AXES;
    let (young, force) = (2e11, 1e4);
    for c in [1e-10, 1e-4, 1.0, 1e4, 1e10] {
        for moved in [false, true] {
            let first = Coupling::point([5.0, 0.0, 0.0]);
            let second = Coupling::point([6.0, 0.0, 0.0]);
            let second = if moved {
                second
                    .with_held([true, false, false, false, false, false])
                    .with_motion([2e-7 / c, 0.0, 0.0, 0.0, 0.0, 0.0], ramp())
            } else {
                second
            };
            let end = mesh.nodes_on(brick::X_MAX);
            let alike = end.into_iter().map(|n| Equation::new([(n, x)]).with_point(0, minus(x)));
            let link = Equation::new([]).with_point(0, x).with_point(1, [-c, 0.0, 0.0]);
            let scene = Scene::new(mesh.clone(), uniform(young, 0.0))
                .with_support(Support::fixed(brick::X_MIN))
                .with_coupling(first)
                .with_coupling(second)
                .with_coupling(Coupling::point([9.0; 3]));
            let scene = alike.chain([link]).fold(scene, Scene::with_equation);
            let scene = if moved {
                scene
            } else {
                scene.with_load(Load::on_coupling(1, [force * c, 0.0, 0.0], [0.0; 3]))
            };
            let found = solved(scene, Settings::default(), &format!("unit {c:e}, moved {moved}"));
            let displacement = found.points[0][0];
            assert!(
                (displacement / 2e-7 - 1.0).abs() < 1e-7,
                "{c:e}, {moved}: {displacement:e}"
            );
            assert_eq!(found.points[2], [0.0; 3]);
        }
    }
}

/// A cell with a stiff core off its middle, displaced nodes and shear, on any number of subdomains.
#[test]
fn a_cell_with_a_core_knows_nothing_of_subdomains() {
    let mesh = Brick::new([1.0; 3], [4; 3]).build().expect("brick");
    let regions = (0..mesh.tets().len()).map(|t| {
        let points = mesh.tet_points(t);
        let centre = [0, 1, 2].map(|c| points.iter().map(|p| p[c]).sum::<f64>() / 4.0);
        u32::from(centre.iter().all(|c| (0.25..0.75).contains(c)) && centre[0] < 0.5)
    });
    let regions = regions.collect();
    let mesh = mesh.with_regions(regions).expect("regions");
    let law = |young: f64| Hooke::isotropic(young, 0.3).expect("Hooke");
    let materials = Materials::new(vec![(0, law(YOUNG)), (1, law(20.0 * YOUNG))]).expect("materials");
    let scene = |boxes: [usize; 3]| {
        cell(mesh.clone(), materials.clone(), [Some(1e-3), None, None])
            .with_load(Load::on_coupling(1, [0.0, -1e8, 0.0], [0.0; 3]))
            .with_boxes(boxes)
    };
    let whole = solved(scene([1, 1, 1]), tight(), "whole");
    for boxes in [[2, 1, 1], [2, 2, 2], [3, 1, 2]] {
        let found = solved(scene(boxes), tight(), "cut");
        assert_close(&found.one.displacement, &whole.one.displacement, 1e-8, "displacement");
        for (own, expected) in found.points.iter().zip(&whole.points) {
            assert_close(own, expected, 1e-8, "point");
        }
        let products = found.one.report.counters.products;
        assert!(products < 80, "{boxes:?}: {products} products");
    }
}

/// Two bars with plane ends, joined by a lever: force and displacements follow from statics.
#[test]
fn a_lever_joins_two_bars() {
    let bar = block([2.0, 1.0, 1.0], [4, 2, 2]);
    let mesh = with_second(&bar, &lifted(&bar, 3.0));
    let ends = [brick::X_MAX, second(brick::X_MAX)].map(|tag| mesh.nodes_on(tag));
    let along = AXES[0];
    let stiffness = YOUNG / 2.0;
    let (force, ratio) = (1e6, 2.0);
    for boxes in [[1, 1, 2], [3, 2, 4]] {
        let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.0))
            .with_support(Support::fixed(brick::X_MIN))
            .with_support(Support::fixed(second(brick::X_MIN)))
            .with_coupling(Coupling::point([3.0, 0.0, 0.0]))
            .with_coupling(Coupling::point([-50.0, 0.0, 7.0]))
            .with_equation(
                Equation::new([])
                    .with_point(0, along)
                    .with_point(1, along.map(|c| ratio * c)),
            )
            .with_load(Load::on_coupling(0, [force, 0.0, 0.0], [0.0; 3]))
            .with_boxes(boxes);
        let plane = |(k, nodes): (usize, &Vec<u32>)| {
            let own = nodes
                .iter()
                .map(|node| Equation::new([(*node, along)]).with_point(k, minus(along)));
            own.collect::<Vec<_>>()
        };
        let planes = ends.iter().enumerate().flat_map(plane);
        let found = solved(planes.fold(scene, Scene::with_equation), tight(), "lever");
        let first = force / (stiffness + stiffness / ratio.powi(2));
        let [a, b] = [found.points[0][0], found.points[1][0]];
        assert!(
            (a / first - 1.0).abs() < 1e-8 && (b * ratio / first + 1.0).abs() < 1e-8,
            "{a:e} {b:e}"
        );
        let pushed = -stiffness * first / ratio.powi(2);
        let lever = found.reactions.equations[0].multiplier;
        assert!((lever / pushed - 1.0).abs() < 1e-8, "{lever:e}, not {pushed:e}");
        let support = found.reactions.supports[1].resultant.force[0];
        assert!(
            (support / (stiffness * first / ratio) - 1.0).abs() < 1e-7,
            "{support:e}"
        );
    }
}

/// A mean of many nodes that is held, across subdomains: their forces are alike.
#[test]
fn the_mean_of_a_side_can_be_held() {
    let mesh = Brick::new([2.0, 1.0, 1.0], [6, 3, 3])
        .perturbed(0.1, 3)
        .build()
        .expect("brick");
    let nodes = mesh.nodes_on(brick::X_MAX);
    let share = 1.0 / nodes.len() as f64;
    let scene = |boxes: [usize; 3]| {
        let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::body([0.0, 0.0, -3e6]))
            .with_boxes(boxes);
        let mean = |e: [f64; 3]| Equation::new(nodes.iter().map(|node| (*node, e.map(|c| share * c))));
        AXES.into_iter().map(mean).fold(scene, Scene::with_equation)
    };
    let whole = solved(scene([1, 1, 1]), tight(), "whole");
    for boxes in [[2, 2, 2], [3, 1, 3]] {
        let found = solved(scene(boxes), tight(), "cut");
        assert_close(&found.one.displacement, &whole.one.displacement, 1e-8, "displacement");
        let at = |n: u32| 3 * n as usize + 2;
        let sag: f64 = nodes.iter().map(|n| found.one.displacement[at(*n)]).sum();
        let most = found.one.displacement.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        assert!(sag.abs() < 1e-7 * most);
        let forces = found.reactions.equations[2].resultant.force;
        let multiplier = found.reactions.equations[2].multiplier;
        assert!((forces[2] / multiplier - 1.0).abs() < 1e-9 && multiplier > 0.0);
    }
}
