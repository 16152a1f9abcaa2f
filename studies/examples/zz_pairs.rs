use signorini::prelude::*;

fn second(tag: FacetTag) -> FacetTag {
    FacetTag(tag.0 + 100)
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let n: usize = args[1].parse().unwrap();
    let boxes: usize = args[2].parse().unwrap();
    for (lo, up) in [
        (n, n),
        (n, n * 3),
        (n, 2 * n),
        (n, 3 * n / 2),
        (n, n + 1),
        (n + 1, n),
        (3 * n / 2, n),
        (2 * n, n),
        (3 * n, n),
    ] {
        for stiff in [1.0, 1e3, 1e-3] {
            if stiff != 1.0 && args.len() < 4 {
                continue;
            }
            let below = Brick::new([1.0; 3], [lo, lo, lo]).build().unwrap();
            let above = Brick::new([1.0; 3], [up, up, up])
                .build()
                .unwrap()
                .map_points(|[x, y, z]| [x, y, z + 1.0])
                .unwrap()
                .map_tags(second);
            let nb = below.tets().len();
            let mesh = below.append(&above).unwrap();
            let regions = (0..mesh.tets().len()).map(|t| u32::from(t >= nb)).collect();
            let mesh = mesh.with_regions(regions).unwrap();
            let mats = Materials::new(vec![
                (0, Hooke::isotropic(1e9, 0.3).unwrap()),
                (1, Hooke::isotropic(1e9 * stiff, 0.3).unwrap()),
            ]);
            let mats = mats.unwrap();
            let scene = Scene::new(mesh, mats)
                .with_support(Support::fixed(brick::Z_MIN))
                .with_load(Load::traction(second(brick::Z_MAX), [1e5, 0.0, -1e6]))
                .with_contact(
                    Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(Friction::coulomb(0.2)),
                )
                .with_boxes([boxes, boxes, 2 * boxes]);
            let t = std::time::Instant::now();
            let mut s = match Simulation::new(scene, Settings::default()) {
                Ok(s) => s,
                Err(e) => {
                    println!("{lo} {up} {e}");
                    continue;
                }
            };
            let setup = t.elapsed().as_secs_f64();
            let t = std::time::Instant::now();
            let r = s.step().unwrap();
            println!(
                "{:?} lower {lo} upper {up} stiff {stiff:e}: rows {} products {} status {:?} cert {:.1e} stick {} slip {} N {:.6e} T {:.6e} set-up {setup:.2} step {:.2}",
                r.report().counters,
                r.points().len(),
                r.report().counters.products,
                r.report().status,
                r.certificate().largest(),
                r.summary().stick,
                r.summary().slip,
                r.summary().normal_force,
                r.summary().resultant[0],
                t.elapsed().as_secs_f64()
            );
        }
    }
}
