//! What the numbers of a state refer to: nodes, subdomains, rows, points, times. A state is refused where they mean
//! something else.
//!
//! Only what gives stored numbers their meaning counts. Loads, materials, gaps and laws of friction may change between
//! two steps, and so may settings: the state is then where the changed scene goes on from.

use crate::hash::{hash, mix, number};
use crate::model::{ConstrainedPoint, Model, PointRow};
use crate::scene::{Analysis, DifferenceFormula};
use crate::settings::Settings;
use signorini_tfeti::Side;
use std::collections::BTreeMap;

/// Hashes of the parts. They depend on the bits of numbers only, not on threads, processor or byte order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Fingerprint {
    points: u64,
    tets: u64,
    parts: u64,
    supports: u64,
    contact: u64,
    formula: u64,
    /// Times of the steps solved.
    times: u64,
}

impl Fingerprint {
    pub(crate) fn new(model: &Model) -> Self {
        let mesh = &model.scene.mesh;
        let coordinates = mesh.points().iter().flatten();
        let tets = mesh.tets().iter().flatten().chain(mesh.mids().iter().flatten());
        let decomposition = &model.discrete.decomposition;
        let rigid = decomposition.subdomains().iter().filter(|s| s.is_rigid());
        let rigid = rigid.flat_map(|s| {
            let kind = [u32::from(s.is_relative), s.nodes.len() as u32];
            kind.into_iter().chain(s.nodes.iter().copied())
        });
        let parts = decomposition.parts().iter().copied().chain(rigid);
        Self {
            points: hash(coordinates.map(|x| number(*x))),
            tets: hash(tets.map(|n| u64::from(*n))),
            parts: hash(parts.map(u64::from)),
            supports: supports(model),
            contact: hash(model.points.iter().flat_map(point)),
            formula: model.scene.analysis.formula().map_or(0, formula),
            times: 0,
        }
    }

    /// The fingerprint after a further step at this time, rounded: equal steps of a longer analysis end a bit elsewhere.
    pub(crate) fn pass(&mut self, time: f64) {
        let time = f64::from(time as f32);
        self.times = mix(self.times ^ number(time)).wrapping_add(1);
    }

    /// The fingerprint after the first steps of an analysis.
    pub(crate) fn after(mut self, analysis: &Analysis, steps: usize) -> Self {
        self.times = 0;
        let times = (0..steps).filter_map(|step| analysis.time(step));
        times.for_each(|time| self.pass(time));
        self
    }

    /// The first part in which two differ, in words.
    pub(crate) fn difference(&self, other: &Self) -> Option<&'static str> {
        let parts = |f: &Self| {
            [
                (f.points, "coordinates of the mesh"),
                (f.tets, "tetrahedra"),
                (f.parts, "subdomains"),
                (f.supports, "nodes or directions of supports, or equations"),
                (f.contact, "contact points (nodes, normals or areas)"),
                (f.formula, "weights of the difference formula"),
                (f.times, "times of the steps solved so far"),
            ]
        };
        let pairs = parts(self).into_iter().zip(parts(other));
        let mut different = pairs.filter(|(a, b)| a.0 != b.0);
        different.next().map(|(a, _)| a.1)
    }
}

/// What tells a product `F lambda` that was stored from any other: the operator, and the bits of both vectors. Sums in
/// lanes: it is taken at every step.
pub(crate) fn seal(operator: u64, lambda: &[f64], f_lambda: &[f64]) -> u64 {
    let mut lanes = [operator; 8];
    for part in [lambda, f_lambda] {
        for chunk in part.chunks(lanes.len()) {
            for (lane, x) in lanes.iter_mut().zip(chunk) {
                // an odd factor: a bijection of the lane for each word
                *lane = (*lane ^ x.to_bits())
                    .wrapping_mul(0x9e37_79b9_7f4a_7c15)
                    .rotate_left(29);
            }
        }
    }
    let lengths = [lambda.len() as u64, f_lambda.len() as u64];
    hash(lanes.into_iter().chain(lengths))
}

fn point(point: &ConstrainedPoint) -> impl Iterator<Item = u64> {
    let frame = point.frame();
    let [a, b] = frame.tangents;
    let numbers = [frame.normal, a, b].into_iter().flatten();
    let nodes = point.contact.sides.nodes();
    let turns = point.contact.sides.partner.iter().flat_map(Side::turn);
    nodes
        .flat_map(|(node, weight)| [u64::from(node), number(weight)])
        .chain(numbers.chain([point.area()]).map(number))
        .chain([point.along().count() as u64])
        .chain(turns.flatten().flatten().copied().map(number))
}

/// What products with F depend on, in one number: two models that share it have the same F, bit for bit. Beside what
/// gives the numbers of a state their meaning these are materials, the rows of B as they stand, and how K+ is made,
/// which changes F on forces that are not in balance.
pub(crate) fn operator_hash(origin: &Fingerprint, model: &Model, settings: &Settings) -> u64 {
    let (mesh, gluing) = (&model.scene.mesh, model.tfeti.gluing());
    let body = [origin.points, origin.tets, origin.parts, origin.contact];
    let laws = mesh.distinct_regions().into_iter().flat_map(|region| {
        let law = model.scene.materials.get(region).ok();
        law.into_iter().flat_map(|law| law.voigt()).flatten()
    });
    let rows = gluing.ranges().interface.end..gluing.ranges().total();
    let entries = rows.flat_map(|row| gluing.row(row));
    let entries = entries.flat_map(|(subdomain, dof, coefficient)| [subdomain as u64, dof as u64, number(coefficient)]);
    let scales = model.points.iter().flat_map(|point| {
        let rows = point.rows();
        rows.flat_map(|PointRow { direction, row, scale }| {
            let numbers = direction.into_iter().chain([scale]).map(number);
            std::iter::once(row as u64).chain(numbers)
        })
    });
    // K+ is made with what is held at zero
    let held = model.discrete.supports.merged.at_zero();
    let held = held.into_iter().flat_map(|(node, direction)| {
        let direction = direction.map(number);
        std::iter::once(u64::from(node)).chain(direction)
    });
    let how = format!("{:?}", (settings.share_translates, settings.inverse));
    let words = body.into_iter().chain(laws.map(|x| number(*x)));
    let words = words.chain(mesh.regions().iter().map(|r| u64::from(*r)));
    let springs = gluing.springs().iter().map(|s| s.compliance);
    let compliance = springs.chain(gluing.contact_compliance().iter().copied()).map(number);
    let words = words.chain(entries).chain(compliance).chain(scales).chain(held);
    hash(words.chain(how.bytes().map(u64::from)))
}

fn formula(formula: DifferenceFormula) -> u64 {
    hash(formula.weights().into_iter().map(number))
}

/// The fixed directions of each node, as the projector on them, rounded: neither the order of supports nor the scale of
/// their rows counts.
fn supports(model: &Model) -> u64 {
    let gluing = model.tfeti.gluing();
    let mut nodes: BTreeMap<u32, [f64; 6]> = BTreeMap::new();
    for row in gluing.ranges().dirichlet.clone() {
        let d = gluing.direction(row);
        let square = d.iter().map(|v| v * v).sum::<f64>();
        let Some(node) = gluing.node(row).filter(|_| square > 0.0) else {
            continue;
        };
        let pairs = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];
        let products = pairs.map(|(a, b)| d[a] * d[b]);
        let projector = nodes.entry(node).or_default();
        for (sum, product) in projector.iter_mut().zip(products) {
            *sum += product / square;
        }
    }
    let nodes = nodes.into_iter().flat_map(|(node, projector)| {
        let rounded = projector.map(|v| number((v * 1e7).round()));
        std::iter::once(u64::from(node)).chain(rounded)
    });
    let couplings = model.discrete.couplings.supports.iter().flat_map(|s| {
        let what = s.direction.iter().flatten().chain(&s.point);
        std::iter::once(u64::from(s.subdomain)).chain(what.map(|v| number(*v)))
    });
    // what is locked later was measured along its axes
    let frames = model.scene.couplings.iter().flat_map(|c| {
        let axis = c.axis().unwrap_or_default();
        axis.into_iter().chain(c.reference()).map(number)
    });
    let equations = model.discrete.equations.iter().flat_map(|e| {
        let terms = e.terms.iter().chain(&e.places);
        let terms = terms.flat_map(|(at, vector)| std::iter::once(u64::from(*at)).chain(vector.map(number)));
        [e.terms.len() as u64, e.places.len() as u64].into_iter().chain(terms)
    });
    hash(nodes.chain(couplings).chain(frames).chain(equations))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mixer_is_that_of_splitmix64() {
        // published first output for seed 0
        assert_eq!(mix(0x9e37_79b9_7f4a_7c15), 0xe220_a839_7b1d_cdaf);
    }

    #[test]
    fn one_bit_of_a_product_breaks_its_seal() {
        let (x, y): (Vec<f64>, Vec<f64>) = ((0..19).map(f64::from).collect(), vec![0.5; 19]);
        let base = seal(1, &x, &y);
        assert_ne!(base, seal(2, &x, &y));
        assert_ne!(base, seal(1, &y, &x));
        for k in 0..19 {
            for bit in [0, 31, 63] {
                let mut other = y.clone();
                other[k] = f64::from_bits(other[k].to_bits() ^ 1 << bit);
                assert_ne!(base, seal(1, &x, &other), "{k} {bit}");
            }
        }
        assert_ne!(seal(1, &[], &x), seal(1, &x, &[]));
    }

    #[test]
    fn one_bit_zeros_lengths_and_order_count() {
        let of = |words: &[f64]| hash(words.iter().map(|x| number(*x)));
        let base = of(&[1.0, 2.0, 0.0]);
        assert_eq!(base, of(&[1.0, 2.0, -0.0]));
        for other in [
            &[2.0, 1.0, 0.0][..],
            &[1.0, 2.0],
            &[1.0, 2.0, 0.0, 0.0],
            &[1.0, 2.0, 5e-324],
            &[1.0_f64.next_up(), 2.0, 0.0],
        ] {
            assert_ne!(base, of(other), "{other:?}");
        }
    }
}
