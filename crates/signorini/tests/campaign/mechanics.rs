//! Linear and quadratic tetrahedra and loads, computed anew: no formula, table or rule is the library's.

mod element;

use crate::recipe::{Density, Poly, Recipe};
use crate::vec3::{Vec3, add, at, cross, dot, norm, scale, sub, unit};
use element::{matrix, quadratic, shape};
use signorini::contact::StepResult;
use signorini::fem_mesh::FacetTag;
use std::collections::HashMap;

/// A tetrahedron of four or ten nodes: the gradients of its functions at points, with volumes, that integrate its
/// stiffness, exactly where edges are straight.
struct Element {
    nodes: Vec<u32>,
    gradients: Vec<(f64, Vec<Vec3>)>,
    volume: f64,
    law: usize,
    region: u32,
}

/// A facet with a tag, outward.
pub(crate) struct Side {
    pub(crate) tag: FacetTag,
    pub(crate) nodes: [u32; 3],
    /// The nodes that take a third of a constant stress each: the corners, or the mid-nodes of a quadratic facet.
    pub(crate) loaded: [u32; 3],
    /// Mid-nodes of a quadratic facet, on the edges 01, 12, 20.
    mids: Option<[u32; 3]>,
    /// Outward, of the length of its area.
    pub(crate) vector: Vec3,
}

/// A point of a side that stands for an area, m², and what the functions of the nodes are there.
struct Sample {
    place: Vec3,
    area: f64,
    /// Outward, of length one.
    normal: Vec3,
    shares: Vec<(u32, f64)>,
}

/// The elastic bodies of a recipe.
pub(crate) struct Mechanics {
    pub(crate) points: Vec<Vec3>,
    elements: Vec<Element>,
    laws: Vec<[[f64; 6]; 6]>,
    pub(crate) sides: Vec<Side>,
    /// Nodal forces of each load for a factor of one.
    pub(crate) loads: Vec<Vec<f64>>,
    /// Mean diagonal stiffness of each node, N/m.
    pub(crate) stiffness: Vec<f64>,
    /// Body of each node.
    pub(crate) body: Vec<usize>,
}

impl Mechanics {
    pub(crate) fn new(recipe: &Recipe) -> Self {
        let mesh = &recipe.mesh;
        let points = mesh.points().to_vec();
        let one = recipe.elastic.len() == 1;
        let cells = mesh.tets().iter().zip(mesh.regions()).enumerate();
        let elements: Vec<Element> = cells
            .map(|(k, (nodes, region))| {
                let (linear, volume) = shape(nodes.map(|n| points[n as usize]));
                let mids = mesh.mids().get(k);
                let nodes: Vec<u32> = nodes.iter().chain(mids.into_iter().flatten()).copied().collect();
                let places: Vec<Vec3> = nodes.iter().map(|n| points[*n as usize]).collect();
                Element {
                    nodes,
                    gradients: match mids {
                        None => vec![(volume, linear.to_vec())],
                        Some(_) => (0..4).map(|corner| quadratic(&places, corner)).collect(),
                    },
                    volume,
                    law: if one { 0 } else { *region as usize },
                    region: *region,
                }
            })
            .collect();
        let mut mechanics = Self {
            laws: recipe.elastic.iter().map(matrix).collect(),
            sides: sides(recipe, &points),
            body: bodies(&elements, points.len()),
            stiffness: vec![0.0; points.len()],
            loads: Vec::new(),
            points,
            elements,
        };
        mechanics.stiffness = mechanics.diagonal();
        let densities = recipe.pushes.iter().map(|p| &p.density);
        mechanics.loads = densities.map(|d| mechanics.load(d)).collect();
        mechanics
    }

    /// Nodal forces that strain a tetrahedron to the displacements of its nodes, N.
    pub(crate) fn strain(&self, element: usize, u: &[Vec3]) -> Vec<Vec3> {
        let e = &self.elements[element];
        let mut out = vec![[0.0; 3]; u.len()];
        for (part, gradients) in &e.gradients {
            let stress = self.stress(e.law, gradients, u);
            for (force, g) in out.iter_mut().zip(gradients) {
                *force = add(*force, stress.map(|row| *part * dot(row, *g)));
            }
        }
        out
    }

    fn stress(&self, law: usize, gradients: &[Vec3], u: &[Vec3]) -> [Vec3; 3] {
        let mut strain = [0.0; 6];
        for (g, u) in gradients.iter().zip(u) {
            let part = [
                g[0] * u[0],
                g[1] * u[1],
                g[2] * u[2],
                g[1] * u[2] + g[2] * u[1],
                g[0] * u[2] + g[2] * u[0],
                g[0] * u[1] + g[1] * u[0],
            ];
            (0..6).for_each(|k| strain[k] += part[k]);
        }
        self.stressed(law, &strain)
    }

    fn stressed(&self, law: usize, strain: &[f64; 6]) -> [Vec3; 3] {
        let c = &self.laws[law];
        let s: [f64; 6] = std::array::from_fn(|i| (0..6).map(|j| c[i][j] * strain[j]).sum());
        [[s[0], s[5], s[4]], [s[5], s[1], s[3]], [s[4], s[3], s[2]]]
    }

    /// Nodal forces of the strained tetrahedra: at the nodes, and their squares summed over the copies of each node.
    pub(crate) fn torn(&self, frame: &StepResult) -> (Vec<f64>, Vec<f64>) {
        let nodes = self.points.len();
        let (mut whole, mut squares) = (vec![0.0; 3 * nodes], vec![0.0; nodes]);
        let mut start = 0;
        for subdomain in frame.decomposition().subdomains() {
            let own = &frame.torn_displacement()[start..start + 3 * subdomain.nodes.len()];
            let mut force = vec![0.0; own.len()];
            let quadratic = subdomain.quadratic_tets();
            for (k, &element) in subdomain.elements.iter().enumerate() {
                let tet: &[u32] = quadratic.get(k).map_or(&subdomain.tets[k], |tet| tet);
                let u: Vec<Vec3> = tet.iter().map(|n| at(own, *n)).collect();
                for (n, f) in tet.iter().zip(self.strain(element as usize, &u)) {
                    (0..3).for_each(|c| force[3 * *n as usize + c] += f[c]);
                }
            }
            for (local, &node) in (0..).zip(&subdomain.nodes) {
                let f = at(&force, local);
                squares[node as usize] += dot(f, f);
                (0..3).for_each(|c| whole[3 * node as usize + c] += f[c]);
            }
            start += own.len();
        }
        (whole, squares)
    }

    /// The nodes of all tetrahedra with a facet that has one of the tags, ascending.
    pub(crate) fn behind(&self, tags: &[FacetTag]) -> Vec<u32> {
        let sides: Vec<[u32; 3]> = (self.sides.iter().filter(|s| tags.contains(&s.tag)))
            .map(|s| s.nodes)
            .collect();
        let has = |e: &&Element| sides.iter().any(|s| s.iter().all(|n| e.nodes[..4].contains(n)));
        let mut nodes: Vec<u32> = self.elements.iter().filter(has).flat_map(|e| e.nodes.clone()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Nodal forces of all loads.
    pub(crate) fn load_at(&self, recipe: &Recipe, time: f64) -> Vec<f64> {
        let mut sum = vec![0.0; 3 * self.points.len()];
        for (push, load) in recipe.pushes.iter().zip(&self.loads) {
            let factor = push.course.value(time);
            sum.iter_mut().zip(load).for_each(|(s, l)| *s += factor * l);
        }
        sum
    }

    fn diagonal(&self) -> Vec<f64> {
        let mut out = vec![0.0; self.points.len()];
        for (k, element) in self.elements.iter().enumerate() {
            for a in 0..element.nodes.len() {
                for c in 0..3 {
                    let mut u = vec![[0.0; 3]; element.nodes.len()];
                    u[a][c] = 1.0;
                    out[element.nodes[a] as usize] += self.strain(k, &u)[a][c] / 3.0;
                }
            }
        }
        out
    }

    /// Consistent nodal forces of a density.
    fn load(&self, density: &Density) -> Vec<f64> {
        let mut out = vec![0.0; 3 * self.points.len()];
        let mut put = |node: u32, force: Vec3| {
            (0..3).for_each(|c| out[3 * node as usize + c] += force[c]);
        };
        match density {
            Density::Body(value) => {
                for e in &self.elements {
                    // of quadratic functions those of mid-nodes have a fifth of the volume each
                    let shares = if e.nodes.len() == 4 { [0.25, 0.0] } else { [-0.05, 0.2] };
                    for (k, n) in e.nodes.iter().enumerate() {
                        put(*n, scale(e.volume * shares[usize::from(k > 3)], *value));
                    }
                }
            }
            Density::BodyField(field) => {
                for e in &self.elements {
                    let corners = [0, 1, 2, 3].map(|k| e.nodes[k]);
                    for (node, force) in self.spread(corners, 6.0 * e.volume, |x| eval(field, x)) {
                        put(node, force);
                    }
                }
            }
            Density::Eigenstrain(strain, region, factors) => {
                for e in self.elements.iter().filter(|e| region.is_none_or(|r| r == e.region)) {
                    let corners = [0, 1, 2, 3].map(|k| factors[e.nodes[k] as usize]);
                    let mean = corners.iter().sum::<f64>() / 4.0;
                    for (corner, (part, gradients)) in e.gradients.iter().enumerate() {
                        // the point is nearer to its corner by the root of a fifth
                        let near = if e.nodes.len() == 4 { 0.0 } else { 0.2_f64.sqrt() };
                        let factor = mean + near * (corners[corner] - mean);
                        let stress = self.stressed(e.law, &strain.map(|s| factor * s));
                        for (n, g) in e.nodes.iter().zip(gradients) {
                            put(*n, stress.map(|row| *part * dot(row, *g)));
                        }
                    }
                }
            }
            Density::Force(tag, value) => {
                let sides = self.sides.iter().filter(|s| s.tag == *tag);
                let shares: Vec<(u32, f64)> = sides.flat_map(|s| self.shares(s)).collect();
                let area: f64 = shares.iter().map(|s| s.1).sum();
                shares
                    .into_iter()
                    .for_each(|(node, share)| put(node, scale(share / area, *value)));
            }
            Density::Moment(tag, value) => {
                let sides = self.sides.iter().filter(|s| s.tag == *tag);
                let samples: Vec<Sample> = sides.flat_map(|s| self.samples(s)).collect();
                let area: f64 = samples.iter().map(|s| s.area).sum();
                let centre = samples
                    .iter()
                    .fold([0.0; 3], |c, s| add(c, scale(s.area / area, s.place)));
                // rows of the moments that spins of one about the axes cause
                let mut second = [[0.0; 3]; 3];
                for sample in &samples {
                    let arm = sub(sample.place, centre);
                    for (c, row) in second.iter_mut().enumerate() {
                        row[c] += sample.area * dot(arm, arm);
                        *row = sub(*row, scale(sample.area * arm[c], arm));
                    }
                }
                let [a, b, c] = second;
                let spin = [cross(b, c), cross(c, a), cross(a, b)].map(|v| scale(1.0 / dot(a, cross(b, c)), v));
                let spin = (0..3).fold([0.0; 3], |w, k| add(w, scale(value[k], spin[k])));
                for sample in &samples {
                    let traction = cross(spin, sub(sample.place, centre));
                    for (node, share) in &sample.shares {
                        put(*node, scale(sample.area * share, traction));
                    }
                }
            }
            Density::Nodes(forces) => forces.iter().for_each(|(node, force)| put(*node, *force)),
            Density::Traction(tag, value) => {
                for side in self.sides.iter().filter(|s| s.tag == *tag) {
                    for (node, share) in self.shares(side) {
                        put(node, scale(share, *value));
                    }
                }
            }
            Density::Pressure(tag, value) => {
                for side in self.sides.iter().filter(|s| s.tag == *tag) {
                    if side.mids.is_none() {
                        let share = scale(-value / 3.0, side.vector);
                        side.loaded.iter().for_each(|n| put(*n, share));
                        continue;
                    }
                    for sample in self.samples(side) {
                        let force = scale(-value * sample.area, sample.normal);
                        for (node, share) in sample.shares {
                            put(node, scale(share, force));
                        }
                    }
                }
            }
            Density::TractionField(tag, field, pull) => {
                for side in self.sides.iter().filter(|s| s.tag == *tag) {
                    let area = norm(side.vector);
                    let normal = scale(1.0 / area, side.vector);
                    let value = |x| add(eval(field, x), scale(pull.value(x), normal));
                    for (node, force) in self.spread(side.nodes, 2.0 * area, value) {
                        put(node, force);
                    }
                }
            }
        }
        out
    }

    /// Areas that the functions of a side have, m²: a third each of straight ones.
    fn shares(&self, side: &Side) -> Vec<(u32, f64)> {
        if side.mids.is_none() {
            return side.nodes.iter().map(|n| (*n, norm(side.vector) / 3.0)).collect();
        }
        let mut out: Vec<(u32, f64)> = Vec::new();
        for sample in self.samples(side) {
            out.extend(
                sample
                    .shares
                    .into_iter()
                    .map(|(node, share)| (node, share * sample.area)),
            );
        }
        out
    }

    /// Points that integrate over a side.
    fn samples(&self, side: &Side) -> Vec<Sample> {
        let corners = side.nodes.map(|n| self.points[n as usize]);
        let mut out = Vec::new();
        for (x, v) in GAUSS {
            for (y, w) in GAUSS {
                let l = [1.0 - x, x * (1.0 - y), x * y];
                let Some(mids) = side.mids else {
                    out.push(Sample {
                        place: (0..3).fold([0.0; 3], |p, a| add(p, scale(l[a], corners[a]))),
                        area: 2.0 * v * w * x * norm(side.vector),
                        normal: unit(side.vector),
                        shares: (0..3).map(|a| (side.nodes[a], l[a])).collect(),
                    });
                    continue;
                };
                let nodes: Vec<u32> = side.nodes.into_iter().chain(mids).collect();
                let places: Vec<Vec3> = nodes.iter().map(|n| self.points[*n as usize]).collect();
                // derivatives of the place along the three coordinates
                let mut tangents = [[0.0; 3]; 3];
                for a in 0..3 {
                    tangents[a] = add(tangents[a], scale(4.0 * l[a] - 1.0, places[a]));
                    let b = (a + 1) % 3;
                    tangents[a] = add(tangents[a], scale(4.0 * l[b], places[3 + a]));
                    tangents[b] = add(tangents[b], scale(4.0 * l[a], places[3 + a]));
                }
                let [u, t] = [1, 2].map(|k| sub(tangents[k], tangents[0]));
                let at_corners = (0..3).map(|a| l[a] * (2.0 * l[a] - 1.0));
                let functions: Vec<f64> = at_corners.chain((0..3).map(|a| 4.0 * l[a] * l[(a + 1) % 3])).collect();
                out.push(Sample {
                    place: (0..6).fold([0.0; 3], |p, a| add(p, scale(functions[a], places[a]))),
                    area: v * w * x * norm(cross(u, t)),
                    normal: scale(dot(cross(u, t), side.vector).signum(), unit(cross(u, t))),
                    shares: nodes.into_iter().zip(functions).collect(),
                });
            }
        }
        out
    }

    /// Integral of a density times the linear functions of a simplex: a square or a cube of Gauss points is collapsed
    /// onto it. `measure` is that of the whole square or cube.
    fn spread<const N: usize>(
        &self,
        nodes: [u32; N],
        measure: f64,
        density: impl Fn(Vec3) -> Vec3,
    ) -> Vec<(u32, Vec3)> {
        let corners = nodes.map(|n| self.points[n as usize]);
        let mut out: Vec<(u32, Vec3)> = nodes.iter().map(|n| (*n, [0.0; 3])).collect();
        for k in 0..GAUSS.len().pow(N as u32 - 1) {
            // the first coordinate cuts off the first corner, the second what is left of the second, ...
            let (mut left, mut weight, mut shares) = (1.0, measure, [0.0; N]);
            let mut digits = k;
            for c in 0..N - 1 {
                let (x, w) = GAUSS[digits % GAUSS.len()];
                digits /= GAUSS.len();
                weight *= w * left;
                shares[c] = left * (1.0 - x);
                left *= x;
            }
            shares[N - 1] = left;
            let place = (0..N).fold([0.0; 3], |p, a| add(p, scale(shares[a], corners[a])));
            let value = density(place);
            for a in 0..N {
                out[a].1 = add(out[a].1, scale(weight * shares[a], value));
            }
        }
        out
    }
}

/// Gauss points on [0, 1], exact to degree 7.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

fn eval(field: &[Poly; 3], x: Vec3) -> Vec3 {
    [0, 1, 2].map(|c| field[c].value(x))
}

/// Facets with tags, turned outward by the corner of their tetrahedron that is not on them.
fn sides(recipe: &Recipe, points: &[Vec3]) -> Vec<Side> {
    let sorted = |mut n: [u32; 3]| {
        n.sort_unstable();
        n
    };
    let mut inner: HashMap<[u32; 3], u32> = HashMap::new();
    for t in recipe.mesh.tets() {
        for a in 0..4 {
            let face = [1, 2, 3].map(|k| t[(a + k) % 4]);
            inner.insert(sorted(face), t[a]);
        }
    }
    let side = |(k, facet): (usize, &signorini::fem_mesh::Facet)| {
        let [a, b, c] = facet.nodes.map(|n| points[n as usize]);
        let vector = scale(0.5, cross(sub(b, a), sub(c, a)));
        let inside = points[inner[&sorted(facet.nodes)] as usize];
        let sign = if dot(vector, sub(inside, a)) > 0.0 { -1.0 } else { 1.0 };
        Side {
            tag: facet.tag,
            nodes: facet.nodes,
            loaded: recipe.mesh.facet_mids(k).unwrap_or(facet.nodes),
            mids: recipe.mesh.facet_mids(k),
            vector: scale(sign, vector),
        }
    };
    recipe.mesh.facets().iter().enumerate().map(side).collect()
}

/// What hangs together through tetrahedra.
fn bodies(elements: &[Element], nodes: usize) -> Vec<usize> {
    let pairs = elements
        .iter()
        .flat_map(|e| e.nodes[1..].iter().map(|n| (e.nodes[0], *n)));
    groups(nodes, pairs)
}

/// The smallest node of the group of each node, where pairs belong together.
pub(crate) fn groups(nodes: usize, pairs: impl Iterator<Item = (u32, u32)>) -> Vec<usize> {
    let mut of: Vec<usize> = (0..nodes).collect();
    fn root(of: &mut [usize], mut k: usize) -> usize {
        while of[k] != k {
            of[k] = of[of[k]];
            k = of[k];
        }
        k
    }
    for (a, b) in pairs {
        let (a, b) = (root(&mut of, a as usize), root(&mut of, b as usize));
        of[a.max(b)] = a.min(b);
    }
    (0..nodes).map(|k| root(&mut of, k)).collect()
}
