//! Temperatures and coefficients of expansion: eigenstrains.

use signorini_contact::{Settings, Simulation};
use signorini_fem_mesh::Brick;

use crate::write::{cube, mesh, read};

const PLANES: &str = "*BOUNDARY\nN1, 1\nN3, 2\nN5, 3\n";

/// A cube on three planes of symmetry at 20 degrees; `more` belongs to its material and the model.
fn on_planes(more: &str, steps: &str) -> String {
    let all = "*NSET, NSET=EVERY, GENERATE\n1, 27\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nEVERY, 20.\n";
    cube(&format!("{more}{all}{PLANES}{steps}"))
}

/// Displacements of the far corner at the end of each increment.
fn corner(deck: &str) -> Vec<[f64; 3]> {
    let scene = read(deck).expect("deck").scene().expect("scene");
    let mut simulation = Simulation::new(scene, Settings::default()).expect("simulation");
    let mut out = Vec::new();
    while !simulation.is_finished() {
        out.push(simulation.step().expect("step").displacement()[26]);
    }
    out
}

/// Straight to the temperature of the step, which stays, and with OP=NEW straight back to the initial one.
#[test]
fn what_is_warmer_than_at_first_grows() {
    let step = |cards: &str| format!("*STEP\n*STATIC\n0.5, 1.\n{cards}*END STEP\n");
    let steps = step("*TEMPERATURE\nEVERY, 100.\n") + &step("") + &step("*TEMPERATURE, OP=NEW\n");
    for (law, coefficients) in [
        ("*EXPANSION, ZERO=20.\n12e-6\n", [12e-6; 3]),
        ("*EXPANSION, TYPE=ORTHO\n1e-6, 2e-6, 3e-6, 300.\n", [1e-6, 2e-6, 3e-6]),
    ] {
        let found = corner(&on_planes(law, &steps));
        for (u, rise) in found.iter().zip([40.0, 80.0, 80.0, 80.0, 40.0, 0.0]) {
            (0..3).for_each(|c| assert!((u[c] - coefficients[c] * rise).abs() < 1e-13, "{found:?}"));
        }
    }
}

/// A section that expands beside one that does not, in a row between two planes: half of the suppressed stress.
#[test]
fn each_section_has_its_coefficient() {
    let brick = Brick::new([2.0, 1.0, 1.0], [2, 1, 1]).build().expect("a brick");
    let left = |tet: &usize| brick.tet_points(*tet).iter().map(|x| x[0]).sum::<f64>() < 4.0;
    let (one, other): (Vec<_>, Vec<_>) = (0..brick.tets().len()).partition(left);
    let set = |name: &str, tets: &[usize]| {
        let list: String = tets.iter().map(|tet| format!("{},\n", tet + 1)).collect();
        format!("*ELSET, ELSET={name}\n{list}")
    };
    let young = "*ELASTIC\n2e5, 0.3\n";
    let deck = format!(
        "{}{}{}*MATERIAL, NAME=A\n{young}*EXPANSION\n1e-5\n*MATERIAL, NAME=B\n{young}*SOLID SECTION, ELSET=L, MATERIAL=A\n\
         *SOLID SECTION, ELSET=R, MATERIAL=B\n{PLANES}N2, 1\n*STEP\n*STATIC\n*TEMPERATURE\nN1, 100.\nN2, 100.\nN5, 100.\n\
         N6, 100.\n*END STEP\n",
        mesh(&brick),
        set("L", &one),
        set("R", &other),
    );
    let scene = read(&deck).expect("deck").scene().expect("scene");
    assert_eq!(scene.loads().len(), 1);
    let mut simulation = Simulation::new(scene, Settings::default()).expect("simulation");
    let result = simulation.step().expect("step");
    let work: f64 = result.stress().iter().map(|s| s[0]).sum::<f64>() / result.stress().len() as f64;
    assert!((work + 100.0).abs() < 5.0, "{work}");
    let reaction = result.reactions().supports;
    let push = reaction.iter().map(|r| r.resultant.force[0]).fold(0.0, f64::max);
    assert!((push - 100.0).abs() < 5.0, "{push}");
}

/// An amplitude multiplies the temperature, and what is above the initial one expands; without an amplitude, or where
/// the temperature is removed, it goes there along a line.
#[test]
fn an_amplitude_multiplies_the_temperature() {
    let law = "*EXPANSION\n12e-6\n*AMPLITUDE, NAME=A\n0., 0.2, 0.5, 1., 1., 0.4\n";
    let step = |heat: &str| format!("*STEP\n*STATIC\n0.25, 1.\n{heat}*END STEP\n");
    let steps = step("*TEMPERATURE, AMPLITUDE=A\nEVERY, 100.\n")
        + &step("")
        + &step("*TEMPERATURE\nEVERY, 60.\n")
        + &step("*TEMPERATURE, OP=NEW\n");
    let found = corner(&on_planes(law, &steps));
    let temperatures = [
        [60.0, 100.0, 70.0, 40.0],
        [40.0; 4],
        [45.0, 50.0, 55.0, 60.0],
        [50.0, 40.0, 30.0, 20.0],
    ];
    assert_eq!(found.len(), 16);
    for (u, temperature) in found.iter().zip(temperatures.as_flattened()) {
        (0..3).for_each(|c| assert!((u[c] - 12e-6 * (temperature - 20.0)).abs() < 1e-13, "{found:?}"));
    }
}

/// Temperatures that differ from node to node, and not in proportion, are a few loads; at each time they strain as a
/// deck does that says the rises of that time, without amplitudes and initial temperatures.
#[test]
fn fields_are_a_few_loads() {
    let law = "*EXPANSION\n12e-6\n*AMPLITUDE, NAME=A\n0., 0.2, 0.5, 1., 1., 0.4\n";
    let lines = |of: &dyn Fn(f64) -> f64| -> String {
        let nodes = 1..=27;
        nodes.map(|n| format!("{n}, {:?}\n", of(f64::from(n)))).collect()
    };
    let step = |heat: &str, lines: &str| format!("*STEP\n*STATIC\n0.5, 1.\n{heat}\n{lines}*END STEP\n");
    let deck = |first: &str, steps: &str| {
        let first = format!("*INITIAL CONDITIONS, TYPE=TEMPERATURE\n{first}");
        cube(&format!("{law}{first}{PLANES}{steps}"))
    };
    let (first, hot, cool) = (|n| 20.0 + 0.5 * n, |n| 100.0 + n, |n| 40.0 + 0.1 * n * n);
    let (heat, amplitude) = ("*TEMPERATURE", "*TEMPERATURE, AMPLITUDE=A");
    type Factors = &'static [[f64; 3]];
    // factors of the initial, the first and the second temperatures in the rises at the end of each increment
    let by_amplitude: Factors = &[[-1.0, 1.0, 0.0], [-1.0, 0.4, 0.0]];
    let two_steps: Factors = &[[-0.5, 0.5, 0.0], [-1.0, 1.0, 0.0], [-1.0, 0.5, 0.5], [-1.0, 0.0, 1.0]];
    let then: Factors = &[[-1.0, 1.0, 0.0], [-1.0, 0.4, 0.0], [-1.0, 0.2, 0.5], [-1.0, 0.0, 1.0]];
    let back: Factors = &[[-1.0, 1.0, 0.0], [-1.0, 0.4, 0.0], [-0.5, 0.2, 0.0], [0.0; 3]];
    for (steps, factors, loads) in [
        (step(amplitude, &lines(&hot)), by_amplitude, 2),
        (step(heat, &lines(&hot)) + &step(heat, &lines(&cool)), two_steps, 2),
        (step(amplitude, &lines(&hot)) + &step(heat, &lines(&cool)), then, 3),
        (
            step(amplitude, &lines(&hot)) + &step("*TEMPERATURE, OP=NEW", ""),
            back,
            2,
        ),
    ] {
        let deck_of_all = deck(&lines(&first), &steps);
        let scene = read(&deck_of_all).expect("deck").scene().expect("scene");
        assert_eq!(scene.loads().len(), loads);
        let found = corner(&deck_of_all);
        assert_eq!(found.len(), factors.len());
        for (u, [a, b, c]) in found.iter().zip(factors) {
            let rise = lines(&|n| a * first(n) + b * hot(n) + c * cool(n));
            let alone = corner(
                &deck("EVERY, 0.\n", &step(heat, &rise))
                    .replace("*INITIAL", "*NSET, NSET=EVERY, GENERATE\n1, 27\n*INITIAL"),
            );
            let exact = alone.last().expect("an increment");
            // the solution is in single steps of a linear system, displacements are some 1e-3
            (0..3).for_each(|i| assert!((u[i] - exact[i]).abs() < 1e-12, "{u:?} {exact:?}"));
        }
    }
}

#[test]
fn what_a_temperature_cannot_say() {
    let heat = "*STEP\n*STATIC\n*TEMPERATURE\nEVERY, 100.\n*END STEP\n";
    let deck = read(&on_planes("", heat)).expect("deck");
    let ignored = deck.ignored().first().expect("ignored").to_string();
    assert!(
        ignored.contains("EVERY: ignored: no material of a section has *EXPANSION"),
        "{ignored}"
    );
    let refused = |more: &str, steps: &str| read(&on_planes(more, steps)).expect_err("refused").to_string();
    let law = "*EXPANSION\n12e-6\n";
    let error = refused("*EXPANSION\n12e-6, 0.\n13e-6, 100.\n", heat);
    assert!(
        error.contains("laws that depend on temperature are not read"),
        "{error}"
    );
    let error = refused("*EXPANSION, TYPE=ANISO\n12e-6\n", heat);
    assert!(error.contains("TYPE=ISO or ORTHO"), "{error}");
    let error = refused(&format!("{law}{law}"), heat);
    assert!(error.contains("keep one of them"), "{error}");
    let error = refused(law, &heat.replace("100.", "warm"));
    assert!(error.contains("a node or node set, and a temperature"), "{error}");
    let error = refused("*INITIAL CONDITIONS, TYPE=STRESS\nALL, 1.\n", heat);
    assert!(error.contains("TYPE=TEMPERATURE alone is read"), "{error}");
}

/// Temperatures of nodes on edges that the elements do not take are told, once; linear fields are not.
#[test]
fn bent_temperatures_are_told() {
    let quadratic = Brick::new([1.0; 3], [1; 3])
        .build()
        .expect("cube")
        .raise_order()
        .expect("quadratic");
    let deck = |temperature: &dyn Fn(&[f64; 3]) -> f64| {
        let nodes = quadratic.points().iter().enumerate();
        let lines: String = nodes
            .map(|(n, p)| format!("{}, {:e}\n", n + 1, temperature(p)))
            .collect();
        let law = "*MATERIAL, NAME=STEEL\n*ELASTIC\n2e5, 0.3\n*EXPANSION\n12e-6\n\
            *SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n";
        let steps = format!("*BOUNDARY\nN1, 1, 3\n*STEP\n*STATIC\n*TEMPERATURE\n{lines}*END STEP\n");
        read(&format!("{}{law}{steps}", mesh(&quadratic))).expect("deck")
    };
    let told = |deck: signorini_deck::Deck| {
        deck.ignored()
            .iter()
            .filter(|i| i.to_string().contains("C3D10T"))
            .count()
    };
    assert_eq!(told(deck(&|p| 100.0 * p[0] * p[0])), 1);
    assert_eq!(told(deck(&|p| 100.0 * p[0] - 30.0 * p[2])), 0);
}
