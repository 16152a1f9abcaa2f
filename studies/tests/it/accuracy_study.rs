//! The example `accuracy` in its short form.

use crate::accuracy::{AccuracyOptions, Curve, Study, execute};
use crate::{folder, options, read};

fn curve<'a>(curves: &'a [Curve], study: Study, name: &str) -> &'a Curve {
    let found = curves.iter().find(|c| c.study == study && c.name.starts_with(name));
    found.unwrap_or_else(|| panic!("no curve {name} of {study:?}"))
}

#[test]
fn short_run_writes_all_files_and_errors_fall() {
    let folder = folder("accuracy");
    let line = format!("accuracy --short --out {}", folder.display());
    let options: AccuracyOptions = options(&line);
    let mut text = Vec::new();
    let curves = execute(&options, &mut text).expect("a run");
    let text = String::from_utf8(text).expect("UTF-8");
    assert!(!text.contains("NOT CONVERGED"), "{text}");

    // tolerance: errors fall, and the library's own estimate is of their size
    for name in ["active-set", "paper", "one-loop"] {
        let c = curve(&curves, Study::Tolerance, name);
        for pair in c.samples.windows(2) {
            assert!(pair[1].errors.u < pair[0].errors.u, "{name}: {text}");
        }
        for sample in &c.samples {
            let index = sample.estimate.expect("an estimate") / sample.errors.u;
            assert!((0.3..10.0).contains(&index), "{name}, {index}: {text}");
        }
    }
    // mesh: both ways to refine see the same errors, and balanced ones do not lose accuracy
    let fixed = curve(&curves, Study::Mesh, "H/h = 2, 1e-6");
    let other = curve(&curves, Study::Mesh, "H = 1 m");
    let balanced = curve(&curves, Study::Mesh, "H/h = 2, balanced");
    for ((a, b), c) in fixed.samples.iter().zip(&other.samples).zip(&balanced.samples) {
        assert!((a.errors.u / b.errors.u - 1.0).abs() < 0.1, "{text}");
        assert!((c.errors.u / a.errors.u - 1.0).abs() < 0.05, "{text}");
        assert!(c.products <= a.products + a.products / 4, "{text}");
    }
    assert!(fixed.orders.u > 0.4, "{text}");
    // time: smaller steps, smaller errors
    for name in ["backward Euler", "3/2"] {
        let c = curve(&curves, Study::Time, name);
        assert!(c.samples[1].errors.u < c.samples[0].errors.u, "{text}");
    }
    // effects: leaving all out is worse than leaving out the least
    let error = |name| curve(&curves, Study::Effects, name).samples[0].errors.u;
    assert!(error("elastic") > error("contact") && error("contact") > error("Coulomb"));
    assert!(error("rate") < 1e-5);

    for study in ["tolerance", "mesh", "time", "method", "effects"] {
        let picture = read(folder.join(format!("accuracy-{study}.svg")));
        assert!(picture.starts_with("<svg") && picture.len() > 2000);
    }
    let csv = read(folder.join("accuracy.csv"));
    let samples: usize = curves.iter().map(|c| c.samples.len()).sum();
    assert_eq!(csv.lines().count(), samples + 1);
    for file in ["accuracy.json", "discretisation-error.vtu"] {
        assert!(folder.join(file).exists(), "{file}");
    }
}
