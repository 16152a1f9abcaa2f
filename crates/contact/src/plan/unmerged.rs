//! Bodies whose nodes coincide where nothing acts between them: parts that were meshed together, but not merged.

use crate::discrete::{DiscreteScene, Extents};
use crate::report::Warning;
use crate::scene::{Contact, Scene};
use signorini_fem_mesh::FacetTag;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// The first two bodies, in the order of their numbers, of which all corners of a facet coincide with nodes of the
/// other while neither contacts, equations nor couplings act between them. Corners on sides of contacts or in equations
/// do not count, nor those that supports or couplings hold on both bodies, at whatever step.
pub(super) fn unmerged(scene: &Scene, discrete: &DiscreteScene) -> Option<Warning> {
    let mesh = &scene.mesh;
    // a body has a subdomain at least
    if discrete.decomposition.subdomains().len() < 2 {
        return None;
    }
    let extents = Extents::new(mesh, &discrete.decomposition);
    if extents.bodies() < 2 {
        return None;
    }
    let facets = mesh.boundary_facets();
    let mut free = vec![false; mesh.points().len()];
    facets
        .iter()
        .flat_map(|f| f.nodes)
        .for_each(|n| free[n as usize] = true);
    let tags: HashSet<FacetTag> = scene.contacts.iter().flat_map(Contact::side_tags).collect();
    let sides = || mesh.facets().iter().filter(|f| tags.contains(&f.tag));
    sides().flat_map(|f| f.nodes).for_each(|n| free[n as usize] = false);
    let terms = scene.equations.iter().flat_map(|e| &e.terms);
    terms.for_each(|(n, _)| free[*n as usize] = false);
    let nodes: Vec<u32> = (0..).zip(&free).filter(|(_, free)| **free).map(|(n, _)| n).collect();
    let mut pairs = mesh.coincident(&nodes);
    if pairs.is_empty() {
        return None;
    }
    let body = |node: u32| extents.body(node as usize);
    let held = held(scene);
    pairs.retain(|[a, b]| body(*a) != body(*b) && !(held.contains(a) && held.contains(b)));
    let mut met: BTreeMap<[usize; 2], Vec<[u32; 2]>> = BTreeMap::new();
    for [a, b] in pairs {
        let [a, b] = if body(a) < body(b) { [a, b] } else { [b, a] };
        met.entry([body(a), body(b)]).or_default().push([a, b]);
    }
    let mut of_tag: HashMap<FacetTag, BTreeSet<usize>> = HashMap::new();
    for facet in sides() {
        of_tag.entry(facet.tag).or_default().insert(body(facet.nodes[0]));
    }
    met.retain(|bodies, _| !act_between(scene, &of_tag, body, *bodies));
    let (_, pairs) = met.into_iter().find(|(_, pairs)| {
        let own: HashSet<u32> = pairs.iter().map(|p| p[0]).collect();
        facets.iter().any(|f| f.nodes.iter().all(|n| own.contains(n)))
    })?;
    let [node, partner] = *pairs.first()?;
    Some(Warning::Unmerged {
        node,
        partner,
        place: mesh.points()[node as usize],
        nodes: pairs.len(),
    })
}

/// The nodes that supports or couplings hold at some step.
fn held(scene: &Scene) -> HashSet<u32> {
    let supports = scene.supports.iter().map(|s| &s.place);
    let couplings = scene.couplings.iter().filter_map(|c| c.place());
    supports
        .chain(couplings)
        .flat_map(|place| place.nodes(&scene.mesh))
        .collect()
}

/// Whether a contact, an equation or a coupling acts between two bodies at some step.
fn act_between(
    scene: &Scene,
    of_tag: &HashMap<FacetTag, BTreeSet<usize>>,
    body: impl Fn(u32) -> usize,
    [a, b]: [usize; 2],
) -> bool {
    let on = |tags: &[FacetTag], which: usize| tags.iter().any(|t| of_tag.get(t).is_some_and(|of| of.contains(&which)));
    let pairs = scene.contacts.iter().filter(|c| !c.partner.is_empty());
    let mut touch = pairs.map(|c| {
        let [own, other] = [&c.tags, &c.partner];
        on(own, a) && on(other, b) || on(own, b) && on(other, a)
    });
    let both = |nodes: &mut dyn Iterator<Item = u32>| {
        let found: BTreeSet<usize> = nodes.map(&body).collect();
        found.contains(&a) && found.contains(&b)
    };
    let mut equations = scene.equations.iter();
    let mut places = scene.couplings.iter().filter_map(|c| c.place());
    // equations of one point join what they name
    let mut points = (0..scene.couplings.len()).map(|k| {
        let of_point = scene
            .equations
            .iter()
            .filter(move |e| e.points.iter().any(|p| p.0 == k));
        of_point.flat_map(|e| &e.terms).map(|t| t.0)
    });
    touch.any(|touch| touch)
        || equations.any(|e| both(&mut e.terms.iter().map(|t| t.0)))
        || places.any(|place| both(&mut place.nodes(&scene.mesh).into_iter()))
        || points.any(|mut nodes| both(&mut nodes))
}
