//! Ways to be wrong: each is a typed error that names the place. Nothing panics.

use signorini::contact::Part;
use signorini::fem_mesh::brick::BrickError;
use signorini::fem_mesh::{
    DecompositionError, Facet, HistoryError, HookeError, LoadError, MaterialError, MeshError, SurfaceError,
};
use signorini::prelude::*;
use signorini::qp::{ActiveSetSettings, QpError, SmalseSettings};
use signorini::tfeti::TfetiError;

type Checked = Result<(), Error>;

fn mesh() -> TetMesh {
    Brick::new([3.0, 1.0, 1.0], [3, 1, 1]).build().expect("brick")
}

fn steel() -> Materials {
    Materials::uniform(Hooke::isotropic(211.9e9, 0.277).expect("Hooke"))
}

/// A good scene, to be spoiled.
fn good() -> Scene {
    touching(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
}

/// The same with another contact.
fn touching(contact: Contact) -> Scene {
    Scene::new(mesh(), steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e6]))
        .with_contact(contact)
}

/// A body on a floor, with nothing else to hold it.
fn standing(contact: Contact) -> Scene {
    Scene::new(mesh(), steel())
        .with_load(Load::body([0.0, 0.0, -1e3]))
        .with_contact(contact)
}

/// Sets the scene up and solves its first level.
fn attempt(scene: Scene) -> Checked {
    attempt_with(scene, Settings::default())
}

fn attempt_with(scene: Scene, settings: Settings) -> Checked {
    let plan = Plan::new(&scene, &settings).map(|_| ());
    let set_up = Simulation::new(scene, settings);
    // a plan says the same, but for what only a set-up can know
    match &set_up {
        Err(ContactError::NotHeld { .. } | ContactError::NotDetermined { .. }) => {
            plan.expect("nothing that a plan sees");
        }
        Err(error) => assert_eq!(plan.expect_err("refused by the plan").to_string(), error.to_string()),
        Ok(_) => plan.expect("accepted by the plan"),
    }
    set_up?.step()?;
    Ok(())
}

fn quasistatic(times: &[f64], formula: DifferenceFormula) -> Scene {
    good().with_analysis(Analysis::Quasistatic {
        times: times.to_vec(),
        formula,
    })
}

fn given(bound: SlipBound) -> Scene {
    touching(Contact::rigid(brick::Z_MIN).with_friction(Friction::Tresca(bound)))
}

fn coulomb(coefficient: Coefficient) -> Scene {
    touching(Contact::rigid(brick::Z_MIN).with_friction(Friction::Coulomb(coefficient)))
}

/// Name, result, the variant it must be, and what the message must contain.
struct Case {
    name: &'static str,
    result: Checked,
    is: fn(&Error) -> bool,
    says: &'static [&'static str],
}

fn check(cases: Vec<Case>) -> usize {
    for case in &cases {
        match &case.result {
            Ok(()) => panic!("{}: accepted", case.name),
            Err(error) => {
                assert!((case.is)(error), "{}: another error: {error:?}", case.name);
                let message = error.to_string();
                // what a main that returns the error prints
                assert_eq!(format!("{error:?}"), message, "{}", case.name);
                for part in case.says {
                    assert!(message.contains(part), "{}: '{message}' lacks '{part}'", case.name);
                }
            }
        }
    }
    cases.len()
}

/// One line a case.
macro_rules! cases {
    ($($name:literal: $result:expr => $pattern:pat, $($says:literal),+;)+) => {
        vec![$(Case {
            name: $name,
            result: $result,
            is: |error| matches!(error, $pattern),
            says: &[$($says),+],
        }),+]
    };
}

fn built(points: &[[f64; 3]], tets: &[[u32; 4]], facets: &[Facet]) -> Checked {
    TetMesh::new(points.to_vec(), tets.to_vec(), facets.to_vec())?;
    Ok(())
}

fn made<T, E: Into<Error>>(value: Result<T, E>) -> Checked {
    value.map(|_| ()).map_err(Into::into)
}

#[test]
fn meshes_and_materials() {
    let p = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let t = [[0, 1, 2, 3]];
    let facet = |nodes| Facet {
        nodes,
        tag: FacetTag(1),
    };
    let nan = [p[0], p[1], p[2], [0.0, f64::NAN, 1.0]];
    let flat = [p[0], p[1], p[2], [0.5, 0.5, 0.0]];
    let extra = [p[0], p[1], p[2], p[3], [9.0; 3]];
    let lame = Hooke::isotropic(1.0, 0.3).expect("Hooke");
    let mut skew = *lame.voigt();
    skew[0][3] = 0.1;
    let mut soft = *lame.voigt();
    soft[5][5] = -1.0;
    let two_regions = || {
        let mut regions = vec![0; mesh().tets().len()];
        regions[2] = 7;
        mesh().with_regions(regions).expect("regions")
    };
    let count = check(cases! {
        "no nodes": built(&[], &[], &[]) => Error::Mesh(MeshError::Empty { .. }), "no nodes";
        "a coordinate that is NaN": built(&nan, &t, &[]) => Error::Mesh(MeshError::NotFinite { node: 3, .. }), "node 3";
        "an inverted element": built(&p, &[[0, 2, 1, 3]], &[]) => Error::Mesh(MeshError::InvertedTet { tet: 0, .. }), "tetrahedron 0", "swap";
        "a flat element": built(&flat, &t, &[]) => Error::Mesh(MeshError::DegenerateTet { tet: 0, .. }), "tetrahedron 0", "flat";
        "numbers from one": built(&p, &[[1, 2, 3, 4]], &[]) => Error::Mesh(MeshError::NodeOutOfRange { .. }), "node 4", "numbered from";
        "a node twice": built(&p, &[[0, 1, 2, 2]], &[]) => Error::Mesh(MeshError::RepeatedNode { node: 2, .. }), "node 2";
        "an unused node": built(&extra, &t, &[]) => Error::Mesh(MeshError::DanglingNode { node: 4, .. }), "node 4";
        "a facet that is no face": built(&p, &t, &[facet([0, 1, 9])]) => Error::Mesh(MeshError::FacetNodeOutOfRange { facet: 0, .. }), "facet 0";
        "a facet twice": built(&p, &t, &[facet([0, 1, 2]), facet([1, 2, 0])]) => Error::Mesh(MeshError::FacetRepeated { .. }), "facets 0 and 1";
        "regions for other elements": made(mesh().with_regions(vec![0; 2])) => Error::Mesh(MeshError::RegionCount { given: 2, .. }), "2 region";
        "a brick without cells": made(Brick::new([1.0; 3], [2, 0, 2]).build()) => Error::Brick(BrickError::OutOfRange { field: "cells", .. }), "cells along y";
        "a brick of negative length": made(Brick::new([1.0, 1.0, -1.0], [1; 3]).build()) => Error::Brick(BrickError::OutOfRange { .. }), "lengths along z";
        "too much perturbation": made(Brick::new([1.0; 3], [2; 3]).perturbed(0.5, 0).build()) => Error::Brick(BrickError::OutOfRange { .. }), "perturbation";
        "a mirrored mesh": made(mesh().map_points(|x| [-x[0], x[1], x[2]])) => Error::Mesh(MeshError::InvertedTet { .. }), "inverted";
        "Young's modulus zero": made(Hooke::isotropic(0.0, 0.3)) => Error::Hooke(HookeError::Young(_)), "Young";
        "an incompressible body": made(Hooke::isotropic(1.0, 0.5)) => Error::Hooke(HookeError::Poisson(_)), "Poisson", "0.5";
        "an unsymmetric law": made(Hooke::from_voigt(&skew)) => Error::Hooke(HookeError::NotSymmetric { .. }), "2.8";
        "a law that is not elliptic": made(Hooke::from_voigt(&soft)) => Error::Hooke(HookeError::NotElliptic { .. }), "elliptic";
        "a region with two materials": made(Materials::new(vec![(1, lame), (1, lame)])) => Error::Material(MaterialError::Repeated { region: 1 }), "region 1";
        "a region without a material": attempt(
            Scene::new(two_regions(), Materials::new(vec![(0, lame)]).expect("materials")).with_support(Support::fixed(brick::X_MIN))
        ) => Error::Material(MaterialError::Unknown { .. }), "region 7", "[0]";
    });
    assert_eq!(count, 20);
}

#[test]
fn decompositions_supports_and_loads() {
    let tets = mesh().tets().len();
    let ends: Vec<u32> = (0..tets).map(|t| u32::from((5..10).contains(&t))).collect();
    let nan = f64::NAN;
    let count = check(cases! {
        "no boxes": attempt(good().with_boxes([3, 0, 1])) => Error::Decomposition(DecompositionError::NoBoxes { axis: "y", .. }), "along y";
        "parts for other elements": attempt(good().with_parts(vec![0; tets - 1])) => Error::Decomposition(DecompositionError::PartCount { .. }), "part numbers";
        "a part number left out": attempt(good().with_parts_as_given(vec![1; tets])) => Error::Decomposition(DecompositionError::EmptyPart { part: 0, .. }), "part 0";
        "a part in two pieces": attempt(good().with_parts_as_given(ends)) => Error::Decomposition(DecompositionError::DisconnectedPart { part: 0, .. }), "part 0", "2 pieces";
        "a support on an unknown tag": attempt(good().with_support(Support::fixed(FacetTag(99)))) => Error::Contact(ContactError::UnknownTag { tag: 99, .. }), "support 1", "99", "the tags 1, 2, 3";
        "a support at an unknown node": attempt(good().with_support(Support::fixed(vec![5, 1000]))) => Error::Contact(ContactError::UnknownNode { node: 1000, .. }), "support 1", "1000", "from 0";
        "a support without nodes": attempt(good().with_support(Support::fixed(Vec::new()))) => Error::Tfeti(TfetiError::EmptySupport { support: 1, .. }), "support 1";
        "a support without directions": attempt(good().with_support(Support::components(brick::X_MAX, [false; 3]))) => Error::Tfeti(TfetiError::EmptySupport { .. }), "directions";
        "a direction of length zero": attempt(good().with_support(Support::partial(brick::X_MAX, Directions::Vectors(vec![[0.0; 3]])))) => Error::Tfeti(TfetiError::BadDirection { support: 1, .. }), "support 1";
        "contradictory supports": attempt(
            good().with_support(Support::fixed(brick::X_MIN).with_motion([1e-3, 0.0, 0.0], History::constant(1.0)))
        ) => Error::Tfeti(TfetiError::ContradictorySupports { first: 0, second: 1, .. }), "supports 0 and 1", "node";
        "displacements for other nodes": attempt(
            good().with_support(Support::fixed(brick::X_MAX).with_motions(vec![[0.0; 3]; 3], History::constant(1.0)))
        ) => Error::Contact(ContactError::ValueCount { values: 3, .. }), "support 1", "3 displacements";
        "a displacement that is NaN": attempt(
            good().with_support(Support::fixed(brick::X_MAX).with_motion([nan, 0.0, 0.0], History::constant(1.0)))
        ) => Error::Tfeti(TfetiError::BadMotion { support: 1, .. }), "support 1";
        "a support history that is infinite": attempt(
            good().with_support(Support::fixed(brick::X_MAX).with_motion([1.0; 3], History::function(|_| f64::INFINITY)))
        ) => Error::Contact(ContactError::HistoryValue { part: Part::Support(1), .. }), "support 1";
        "a load on an unknown tag": attempt(good().with_load(Load::pressure(FacetTag(42), 1.0))) => Error::Contact(ContactError::Load { index: 1, source: LoadError::UnknownTag { .. } }), "load 1", "42", "the tags 1, 2, 3";
        "a load that is NaN": attempt(good().with_load(Load::body([0.0, nan, 0.0]))) => Error::Contact(ContactError::Load { index: 1, source: LoadError::NotFinite { .. } }), "load 1", "finite";
        "a load field that is infinite": attempt(
            good().with_load(Load::new(LoadDensity::body_field(|x| [1.0 / (x[0] - x[0]), 0.0, 0.0])))
        ) => Error::Contact(ContactError::Load { index: 1, .. }), "load 1";
        "a force at an unknown node": attempt(
            good().with_load(Load::new(LoadDensity::NodalForces(vec![(77, [1.0; 3])])))
        ) => Error::Contact(ContactError::Load { index: 1, source: LoadError::UnknownNode { node: 77, .. } }), "node 77";
        "a load history that is NaN": attempt(
            good().with_load(Load::body([1.0; 3]).with_history(History::function(|t| (t - 2.0).sqrt())))
        ) => Error::Contact(ContactError::HistoryValue { part: Part::Load(1), .. }), "load 1", "time 1";
        "a history without points": made(History::table(Vec::new())) => Error::History(HistoryError::Empty), "no points";
        "a history that goes back": made(History::table(vec![(0.0, 0.0), (1.0, 1.0), (0.5, 2.0)])) => Error::History(HistoryError::NotIncreasing { index: 2, .. }), "point 2";
        "a ramp of no duration": made(History::ramp(0.0, 1.0)) => Error::History(HistoryError::NotIncreasing { .. }), "point 1";
    });
    assert_eq!(count, 21);
}

#[test]
fn contact_and_friction() {
    let nan = f64::NAN;
    let count = check(cases! {
        "contact on an unknown tag": attempt(touching(Contact::rigid(FacetTag(9)))) => Error::Contact(ContactError::UnknownTag { tag: 9, .. }), "contact 0", "tag 9";
        "a crease of no angle": attempt(touching(Contact::rigid(brick::Z_MIN).with_crease(0.0))) => Error::Contact(ContactError::ContactValue { contact: 0, name: "crease", .. }), "crease", "(0, 180]";
        "a contact tag twice": attempt(touching(Contact::rigid(brick::Z_MIN).with_tag(brick::Z_MIN))) => Error::Surface(SurfaceError::RepeatedTag { .. }), "twice";
        "a normal of length zero": attempt(touching(Contact::rigid(brick::Z_MIN).with_normal([0.0; 3]))) => Error::Contact(ContactError::ObstacleNormal { .. }), "normal", "not zero";
        "a half-space without a direction": attempt(touching(Contact::half_space(brick::Z_MIN, [0.0; 3], [0.0; 3]))) => Error::Contact(ContactError::ObstacleNormal { .. }), "normal", "0.0";
        "a gap that is NaN": attempt(touching(Contact::rigid(brick::Z_MIN).with_gap(nan))) => Error::Contact(ContactError::Gap { .. }), "node", "gap";
        "a gap field that is infinite": attempt(touching(Contact::rigid(brick::Z_MIN).with_gap_field(|x| 1.0 / x[2]))) => Error::Contact(ContactError::Gap { .. }), "contact 0", "node 0", "node 0, (0, 0, 0)", "inf";
        "a negative coefficient": attempt(coulomb(Coefficient::Constant(-0.3))) => Error::Contact(ContactError::Coefficient { .. }), "contact 0", "coefficient", "-0.3";
        "a negative coefficient of the second surface": attempt(good().with_contact(Contact::rigid(brick::Y_MIN).with_friction(Friction::coulomb(-0.3)))) => Error::Contact(ContactError::Coefficient { .. }), "contact 1";
        "a coefficient that is NaN": attempt(coulomb(Coefficient::Constant(nan))) => Error::Contact(ContactError::Coefficient { .. }), "coefficient", "NaN";
        "a field of negative coefficients": attempt(coulomb(Coefficient::field(|x| 1.0 - x[0]))) => Error::Contact(ContactError::CoefficientAt { .. }), "contact 0 at node", "coefficient";
        "a law that is NaN": attempt(coulomb(Coefficient::rate_field(|_, _| f64::NAN))) => Error::Contact(ContactError::CoefficientAt { .. }), "node", "slip rate";
        "a decay rate of zero": attempt(coulomb(Coefficient::Exponential { fixed: 0.3, kinetic: 0.1, decay: 0.0 })) => Error::Contact(ContactError::Coefficient { .. }), "decay rate";
        "a negative kinetic coefficient": attempt(coulomb(Coefficient::Exponential { fixed: 0.3, kinetic: -0.1, decay: 1.0 })) => Error::Contact(ContactError::Coefficient { .. }), "kinetic";
        "an empty table": attempt(coulomb(Coefficient::Table(Vec::new()))) => Error::Contact(ContactError::EmptyTable { .. }), "contact 0", "table", "at least one";
        "a table out of order": attempt(coulomb(Coefficient::Table(vec![(1.0, 0.3), (0.0, 0.2)]))) => Error::Contact(ContactError::TableRate { entry: 1, .. }), "order";
        "a negative slip bound": attempt(given(SlipBound::Stress(-1.0))) => Error::Contact(ContactError::SlipBound { .. }), "contact 0 at node", "slip bound";
        "a slip bound that is NaN": attempt(given(SlipBound::field(|x| (x[0] - 1.5).sqrt()))) => Error::Contact(ContactError::SlipBound { .. }), "node";
        "a free body": attempt(
            Scene::new(mesh(), steel()).with_load(Load::body([0.0, 0.0, -1e3]))
        ) => Error::Contact(ContactError::NotHeld { step: 0, body: 0, .. }), "step 0", "body 0", "translation";
        "a body pushed along a smooth floor": attempt(
            standing(Contact::rigid(brick::Z_MIN)).with_load(Load::traction(brick::X_MAX, [1e3, 0.0, 0.0]))
        ) => Error::Contact(ContactError::NotHeld { .. }), "body 0", "held neither by supports nor by contact";
        "a body that may turn about its only support": attempt(
            Scene::new(mesh(), steel()).with_support(Support::fixed(vec![0])).with_load(Load::traction(brick::X_MAX, [0.0, 0.0, 1.0]))
        ) => Error::Contact(ContactError::NotHeld { .. }), "rotation";
        "a body that is pushed later": attempt(
            standing(Contact::rigid(brick::Z_MIN))
                .with_load(Load::body([1e3, 0.0, 0.0]).with_history(History::table(vec![(0.5, 0.0), (1.0, 1.0)]).expect("table")))
                .with_analysis(Analysis::quasistatic(1.0, 4))
        ) => Error::Contact(ContactError::NotHeld { step: 2, .. }), "step 2";
    });
    assert_eq!(count, 22);
}

#[test]
fn times_and_settings() {
    let euler = DifferenceFormula::BACKWARD_EULER;
    let three = DifferenceFormula::PAPER;
    let with = |settings| attempt_with(good(), settings);
    let smalse = |f: fn(SmalseSettings) -> SmalseSettings| {
        let smalse = f(SmalseSettings::default());
        with(Settings::default().with_method(Method::OneLoop { smalse }))
    };
    let count = check(cases! {
        "no step": attempt(quasistatic(&[], euler)) => Error::Contact(ContactError::NoSteps), "no step";
        "a first level at zero": attempt(quasistatic(&[0.0, 1.0], euler)) => Error::Contact(ContactError::Time { step: 0, .. }), "step 0";
        "times that go back": attempt(quasistatic(&[0.5, 0.25], euler)) => Error::Contact(ContactError::Time { step: 1, .. }), "step 1";
        "a time that is NaN": attempt(quasistatic(&[0.5, f64::NAN], euler)) => Error::Contact(ContactError::Time { step: 1, .. }), "step 1";
        "a static time that is infinite": attempt(good().with_analysis(Analysis::Static { time: f64::INFINITY })) => Error::Contact(ContactError::Time { .. }), "step 0";
        "unequal steps with three levels": attempt(quasistatic(&[0.25, 0.5, 1.0], three)) => Error::Contact(ContactError::UnequalSteps { step: 2, .. }), "step 2", "backward Euler";
        "no steps": attempt(good().with_analysis(Analysis::quasistatic(1.0, 0))) => Error::Contact(ContactError::NoSteps), "no step";
        "a negative duration": attempt(good().with_analysis(Analysis::quasistatic(-1.0, 2))) => Error::Contact(ContactError::Time { step: 0, .. }), "step 0";
        "an inconsistent formula": made(DifferenceFormula::new(1.0, -1.0, 0.5)) => Error::Contact(ContactError::Formula { .. }), "sum";
        "a formula of another rate": made(DifferenceFormula::new(2.0, -2.0, 0.0)) => Error::Contact(ContactError::Formula { .. }), "must be 1";
        "a tolerance of zero": with(Settings::default().with_tolerance(0.0)) => Error::Contact(ContactError::Setting { name: "tolerance", .. }), "tolerance";
        "a tolerance that is NaN": with(Settings::default().with_tolerance(f64::NAN)) => Error::Contact(ContactError::Setting { .. }), "tolerance", "NaN";
        "a forcing term of one": with(Settings::default().with_method(Method::ActiveSet(ActiveSetSettings::default().with_forcing(1.0)))) => Error::Qp(QpError::Setting { .. }), "forcing";
        "no faces": with(Settings::default().with_method(Method::ActiveSet(ActiveSetSettings::default().with_max_active_sets(0)))) => Error::Qp(QpError::Setting { .. }), "max_active_sets";
        "a negative penalty": smalse(|s| s.with_penalty(-1.0)) => Error::Qp(QpError::Setting { .. }), "penalty";
        "no outer steps": smalse(|s| s.with_max_outer(0)) => Error::Qp(QpError::Setting { .. }), "max_outer";
    });
    assert_eq!(count, 16);
}

#[test]
fn checkpoints_and_the_end() {
    let scene = |cells| {
        let mesh = Brick::new([3.0, 1.0, 1.0], [cells, 1, 1]).build().expect("brick");
        Scene::new(mesh, steel())
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e6]))
            .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
            .with_analysis(Analysis::quasistatic(1.0, 3))
    };
    let set_up = |cells| Simulation::new(scene(cells), Settings::default()).expect("set-up");
    let mut first = set_up(3);
    let report = first.run(&mut Silent).expect("run");
    assert!(report.converged());
    let state = first.state().clone();
    let mut short = Simulation::new(
        scene(3).with_analysis(Analysis::quasistatic(1.0, 2)),
        Settings::default(),
    )
    .expect("set-up");
    let step_after_the_end = made(first.step().map(|_| ()));
    let count = check(cases! {
        "a checkpoint of another scene": made(set_up(4).resume(state.clone())) => Error::Contact(ContactError::Checkpoint { .. }), "another scene";
        "a checkpoint of a longer scene": made(short.resume(state)) => Error::Contact(ContactError::Checkpoint { .. }), "more steps";
        "a step after the last": step_after_the_end => Error::Contact(ContactError::Finished { steps: 3 }), "3 steps";
    });
    assert_eq!(count, 3);
}

#[cfg(feature = "checkpoint")]
#[test]
fn damaged_checkpoints() {
    let scene = good().with_analysis(Analysis::quasistatic(1.0, 3));
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    simulation.step().expect("step");
    let bytes = simulation.state().to_bytes().expect("encode");
    let mut unknown = bytes.clone();
    unknown[0] ^= 1;
    let count = check(cases! {
        "a cut checkpoint": made(State::from_bytes(&bytes[..bytes.len() / 2])) => Error::Contact(ContactError::UnreadableCheckpoint { .. }), "checkpoint", "damaged";
        "an empty checkpoint": made(State::from_bytes(&[])) => Error::Contact(ContactError::UnreadableCheckpoint { .. }), "damaged";
        "another format": made(State::from_bytes(&unknown)) => Error::Contact(ContactError::UnreadableCheckpoint { .. }), "format";
    });
    assert_eq!(count, 3);
}

/// A damaged checkpoint is refused. With a checksum that was made to fit it may continue as some state; it never
/// panics.
#[cfg(feature = "checkpoint")]
#[test]
fn flipped_bits_of_a_checkpoint_do_not_panic() {
    let scene = good().with_analysis(Analysis::quasistatic(1.0, 3));
    let mut simulation = Simulation::new(scene.clone(), Settings::default()).expect("set-up");
    simulation.step().expect("step");
    let bytes = simulation.state().to_bytes().expect("encode");
    for at in (0..bytes.len()).step_by(37) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x80;
        assert!(State::from_bytes(&damaged).is_err(), "byte {at}");
        // the format and the checksum stand in the first 12 bytes; FNV-1a
        let sum = damaged[12..].iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
        damaged[4..12].copy_from_slice(&sum.to_le_bytes());
        let Ok(state) = State::from_bytes(&damaged) else {
            continue;
        };
        let mut other = Simulation::new(scene.clone(), Settings::default()).expect("set-up");
        if other.resume(state).is_ok()
            && !other.is_finished()
            && let Ok(frame) = other.step()
        {
            let honest = !frame.report().status.converged() || frame.certificate().largest() <= 1e-6;
            assert!(honest, "byte {at}");
        }
    }
}

/// A contact surface that is fixed entirely has nothing to decide: it is left out, not an error.
#[test]
fn a_contact_surface_that_is_fixed_is_left_out() {
    let scene = touching(Contact::rigid(brick::X_MIN).with_friction(Friction::coulomb(0.3)));
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    assert!(simulation.constrained_points().is_empty());
    let gluing = simulation.tfeti().gluing();
    assert_eq!(gluing.rows_as_paper() - gluing.ranges().total(), 3 * 4);
    let frame = simulation.step().expect("step");
    assert!(frame.report().status.converged() && frame.certificate().largest() <= 1e-6);
    assert_eq!(frame.report().counters.inequality_solves, 0);
}
