//! Rigid subdomains: their rows measure motions, products know nothing of their stiffness, and what is refused.

use crate::common::{self, dot, noise};
use signorini_fem_mesh::decomposition::Rigid;
use signorini_fem_mesh::vec3::{add, cross, sub};
use signorini_fem_mesh::{Hooke, Materials, SurfaceFrame, brick};
use signorini_qp::SymmetricOperator;
use signorini_tfeti::internal::RIGID;
use signorini_tfeti::{ContactConstraint, NodeSupport, RigidSupport, Side, Tfeti, TfetiBuilder, TfetiError};

const POINT: [f64; 3] = [4.0, -0.3, 0.7];

/// A brick held at one end with a rigid subdomain at the other, of which all motions about a point are held.
fn system(held: &[RigidSupport]) -> Result<Tfeti, TfetiError> {
    touching(held, &[])
}

/// The same with contact.
fn touching(held: &[RigidSupport], contact: &[ContactConstraint]) -> Result<Tfeti, TfetiError> {
    let b = common::Brick::new(1, 2);
    let cut = b.decomposition.clone();
    let cut = cut
        .with_rigid(vec![Rigid::Nodes(b.mesh.nodes_on(brick::X_MAX))])
        .expect("nodes of the mesh");
    let materials = Materials::uniform(Hooke::isotropic(2e11, 0.3).expect("steel"));
    let supports = [NodeSupport::fixed(b.mesh.nodes_on(brick::X_MIN))];
    let builder = TfetiBuilder::new(&b.mesh, &cut, &materials).with_supports(&supports);
    builder.with_rigid_supports(held).with_contact(contact).build()
}

fn held(component: usize) -> RigidSupport {
    let number = common::Brick::new(1, 2).decomposition.subdomains().len() as u32;
    RigidSupport {
        subdomain: number,
        point: POINT,
        direction: [0, 1].map(|part| [0, 1, 2].map(|c| f64::from(u8::from(3 * part + c == component)))),
        values: vec![(1, 2.0 + component as f64)],
    }
}

#[test]
fn rows_measure_rigid_motions() {
    let all: Vec<RigidSupport> = (0..6).map(held).collect();
    let tfeti = system(&all).expect("a system");
    let (gluing, mesh) = (tfeti.gluing(), common::Brick::new(1, 2).mesh);
    let rows = gluing.ranges().rigid.clone();
    assert!(rows.len() == 6 && rows.start == gluing.ranges().tied.end && rows.end == gluing.ranges().dirichlet.start);
    let nodes = mesh.nodes_on(brick::X_MAX);
    let rigid = tfeti.subdomains() - 1;
    for motion in noise(60, 5).as_chunks::<6>().0 {
        let [x, y, z, a, b, c] = *motion;
        let mut u = vec![0.0; tfeti.torn_dim()];
        for (node, u) in nodes.iter().zip(u[tfeti.torn_range(rigid)].as_chunks_mut().0) {
            let arm = sub(mesh.points()[*node as usize], POINT);
            *u = add([x, y, z], cross([a, b, c], arm));
        }
        let mut out = vec![0.0; tfeti.dual_dim()];
        tfeti.rows_times(&u, &mut out);
        for (k, row) in rows.clone().enumerate() {
            let entries = gluing.row(row);
            let length: f64 = entries.iter().map(|e| e.2 * e.2).sum();
            let prescribed = gluing
                .prescribed(1)
                .iter()
                .find(|p| p.0 as usize == row)
                .expect("moves");
            let scale = prescribed.1 / (2.0 + k as f64);
            assert!((length - RIGID).abs() < 1e-12 * RIGID && (gluing.length(row) - RIGID.sqrt()).abs() < 1e-12);
            assert!((out[row] - scale * motion[k]).abs() < 1e-12 * scale.max(1.0));
        }
        let [displacement, rotation] = tfeti.rigid_motion(rigid, &u, POINT);
        let found = [displacement, rotation].concat();
        assert!(
            found.iter().zip(motion).all(|(a, b)| (a - b).abs() < 1e-12),
            "{found:?} {motion:?}"
        );
    }
}

/// `F` is symmetric and positive semidefinite; multipliers of what holds the rigid subdomain move nothing.
#[test]
fn products_are_those_of_the_elastic_subdomains() {
    let tfeti = system(&[held(0), held(4)]).expect("a system");
    let (f, n) = (tfeti.dual(), tfeti.dual_dim());
    let mut scratch = f.scratch();
    let [x, y] = [7, 8].map(|seed| noise(n, seed));
    let mut times = |x: &[f64]| {
        let mut out = vec![f64::NAN; n];
        f.apply(x, &mut out, &mut scratch);
        out
    };
    let (fx, fy) = (times(&x), times(&y));
    assert!((dot(&x, &fy) - dot(&y, &fx)).abs() < 1e-12 * dot(&x, &fx) && dot(&x, &fx) > 0.0);
    let mut only = vec![0.0; n];
    only[tfeti.gluing().ranges().rigid.clone()].fill(1.0);
    assert!(times(&only).iter().all(|v| *v == 0.0));
    assert!(tfeti.coarse_factor().expect("a factor").free_motions().is_empty());
}

#[test]
fn subdomains_without_nodes_are_refused() {
    let b = common::Brick::new(1, 2);
    let cut = b
        .decomposition
        .clone()
        .with_rigid(vec![Rigid::Nodes(vec![])])
        .expect("no unknown node");
    let materials = Materials::uniform(Hooke::isotropic(2e11, 0.3).expect("steel"));
    let built = TfetiBuilder::new(&b.mesh, &cut, &materials).build();
    let subdomain = b.decomposition.subdomains().len();
    assert_eq!(built.map(|_| ()), Err(TfetiError::Collinear { subdomain }));
}

#[test]
fn what_is_refused() {
    let refused = |support: RigidSupport| system(&[support]).map(|_| ()).expect_err("refused");
    let elastic = RigidSupport {
        subdomain: 0,
        ..held(0)
    };
    assert_eq!(refused(elastic), TfetiError::RigidSupport { subdomain: 0 });
    let none = RigidSupport {
        subdomain: 99,
        ..held(0)
    };
    assert_eq!(refused(none), TfetiError::RigidSupport { subdomain: 99 });
    let subdomain = held(0).subdomain as usize;
    let nowhere = RigidSupport {
        point: [f64::INFINITY, 0.0, 0.0],
        ..held(1)
    };
    let values = vec![(0, f64::NAN)];
    for bad in [held(6), nowhere, RigidSupport { values, ..held(0) }] {
        assert_eq!(refused(bad), TfetiError::RigidSupport { subdomain });
    }
    let [x, long] = [1.0, 2.0].map(|v| [v, 0.0, 0.0]);
    for direction in [[long, [0.0; 3]], [x, x], [[f64::NAN, 0.0, 0.0], x]] {
        let bad = RigidSupport { direction, ..held(0) };
        assert_eq!(refused(bad), TfetiError::RigidSupport { subdomain });
    }
    let values = vec![(u32::MAX, 1.0)];
    let late = RigidSupport { values, ..held(0) };
    assert_eq!(refused(late), TfetiError::RigidSupport { subdomain });
}

/// However little of a contact row is elastic, the weights of all others stay what they are.
#[test]
fn rows_of_little_but_rigid_sides_hide_no_others() {
    let b = common::Brick::new(1, 2);
    let [held, ends] = [brick::X_MIN, brick::X_MAX].map(|tag| b.mesh.nodes_on(tag));
    let floor = b.mesh.nodes_on(brick::Z_MIN);
    let free = floor.iter().find(|node| !held.contains(node) && !ends.contains(node));
    let rigid = ends.iter().find(|node| floor.contains(node));
    let (free, rigid) = (*free.expect("a node"), *rigid.expect("a node"));
    let frame = SurfaceFrame::from_normal([0.0, 0.0, -1.0]).expect("a normal");
    let weights = |elastic: f64| {
        let side = Side::new(vec![(rigid, 1.0 - elastic), (free, elastic)]);
        let tfeti = touching(&[], &[ContactConstraint::new(side, frame)]).expect("a system");
        let contact = tfeti.gluing().ranges().contact();
        let mut weights = tfeti.row_weights().expect("copies differ");
        let own: f64 = weights.drain(contact).sum();
        (own, weights)
    };
    let (_, half) = weights(0.5);
    for elastic in [1e-2, 1e-4, 1e-6] {
        let (own, others) = weights(elastic);
        let most = others.iter().fold(0.0_f64, |most, w| most.max(*w));
        assert!(own <= 2.0 * (1.0 + 1e-9) * most, "{elastic:e}: {own:e} beside {most:e}");
        let near = |(a, b): (&f64, &f64)| (0.4..2.5).contains(&(a / b));
        assert!(others.iter().zip(&half).all(near), "{elastic:e}");
    }
}
