//! What two levels will store and cost, from counts alone.
//!
//! No matrix is known yet. Blocks of two subdomains are taken for equal if the subdomains are translates, stand to each
//! other in the same way, and have the same neighbours and as many support nodes. That tells more blocks apart than
//! numbers do, so that the count is an upper bound.

use crate::coarse::clusters::members;
use crate::projector::levels::two_levels_pay;
use crate::projector::split::order::grid_of;
use crate::projector::split::shared::{EntryBits, share};
use crate::projector::split::tree::{CoarseTree, cheapest_tree};
use crate::subdomain::forecast::{CoarseForecast, Forecast, coarse_graph};
use crate::subdomain::kernel::mean;
use crate::tolerances::LAYER;
use signorini_fem_mesh::internal::DisjointSets;
use signorini_fem_mesh::vec3::sub;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Forecast for two levels, or, if the method does not follow `active_sets`, for one in which equal regions are stored
/// once; `None` where neither is used. `touching` are the nodes with contact rows, `supported` those with support rows,
/// each once; `rows` is the number of rows of `B`.
pub fn forecast_levels(
    forecast: &Forecast<'_>,
    touching: impl Iterator<Item = u32>,
    supported: impl Iterator<Item = u32>,
    rows: usize,
    active_sets: bool,
) -> Option<CoarseForecast> {
    let decomposition = forecast.decomposition;
    let count = decomposition.subdomains().len();
    let copies = |node: u32| decomposition.copies(node as usize).iter().map(|c| c.subdomain as usize);
    let mut contact = vec![0_u32; count];
    touching.flat_map(copies).for_each(|s| contact[s] += 1);
    let changing: Vec<bool> = contact.iter().map(|nodes| *nodes > 0).collect();
    let follows = active_sets && changing.contains(&true);
    if !two_levels_pay(&changing, rows) || active_sets && !follows {
        return None;
    }
    // rows that do not change are like those of supports
    let mut supports = if follows { vec![0; count] } else { contact };
    supported.flat_map(copies).for_each(|s| supports[s] += 1);
    let graph = coarse_graph(decomposition);
    let points = forecast.mesh.points();
    let centre = |nodes: &[u32]| mean(nodes.iter().map(|&n| points[n as usize]));
    let centres: Vec<[f64; 3]> = decomposition.subdomains().iter().map(|s| centre(&s.nodes)).collect();

    // numbers that stand for the blocks
    let class: Vec<usize> = (0..count).map(|s| forecast.found.place(s).0).collect();
    let size = centres.iter().flatten().fold(0.0_f64, |most, v| most.max(v.abs()));
    let offset = |a: u32, b: u32| {
        let between = sub(centres[b as usize], centres[a as usize]);
        between.map(|d| (d / (LAYER * size).max(f64::MIN_POSITIVE)).round() as i64)
    };
    let own = |a: usize| {
        let mut around: Vec<_> = graph[a]
            .iter()
            .map(|&b| (offset(a as u32, b), class[b as usize]))
            .collect();
        around.sort_unstable();
        hash(&(class[a], supports[a], around))
    };
    let own: Vec<u64> = (0..count).map(own).collect();
    let block = |a: u32, b: u32| hash(&(own[a as usize], own[b as usize], offset(a, b)));

    let grid = grid_of(&centres);
    let mut fixed = CoarseTree::new(&graph, &centres, &vec![false; count], 0, grid.as_deref()).ok()?;
    let (numbers, flops) = count_tree(&mut fixed, &graph, &|a, b, key| key.push(block(a, b)));
    let counted = |numbers: usize, flops: f64| CoarseForecast {
        bytes: 8 * numbers as u64,
        flops,
    };
    if !follows {
        return Some(counted(numbers, flops));
    }

    let mut bodies = DisjointSets::new(count);
    for (a, list) in graph.iter().enumerate() {
        list.iter().for_each(|&b| bodies.join(a, b as usize));
    }
    let members = members(&bodies.numbers(), &centres, grid.as_deref());
    let (mut of, mut place) = (vec![0; count], vec![0; count]);
    for (k, list) in members.iter().enumerate() {
        for (i, &s) in list.iter().enumerate() {
            (of[s as usize], place[s as usize]) = (k as u32, i);
        }
    }
    let mut links: HashMap<(u32, u32), u64> = HashMap::new();
    for a in 0..count as u32 {
        for &b in graph[a as usize].iter().chain([&a]) {
            let sum = links.entry((of[a as usize], of[b as usize])).or_default();
            *sum = hash(&(*sum, place[a as usize], place[b as usize], block(a, b)));
        }
    }
    let mut graph: Vec<Vec<u32>> = vec![Vec::new(); members.len()];
    links
        .keys()
        .filter(|(p, q)| p != q)
        .for_each(|&(p, q)| graph[p as usize].push(q));
    graph.iter_mut().for_each(|list| list.sort_unstable());
    let middle = |list: &Vec<u32>| mean(list.iter().map(|&s| centres[s as usize]));
    let centres: Vec<[f64; 3]> = members.iter().map(middle).collect();
    let marks: Vec<bool> = members
        .iter()
        .map(|list| list.iter().any(|&s| changing[s as usize]))
        .collect();
    let grid = grid_of(&centres);
    let mut tree = cheapest_tree(&graph, &centres, &marks, grid.as_deref())?;
    let clusters = count_tree(&mut tree, &graph, &|a, b, key| key.push(links[&(a, b)]));
    Some(counted(numbers + clusters.0, flops + clusters.1))
}

/// Numbers and operations of a factor.
fn count_tree(tree: &mut CoarseTree, graph: &[Vec<u32>], write: &EntryBits<'_>) -> (usize, f64) {
    let first = share(tree, graph, write);
    let own = || first.iter().enumerate().map(|(r, &equal)| r == equal);
    (tree.stored(own()), tree.operations(own()))
}

fn hash(value: &impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    value.hash(&mut hasher);
    hasher.finish()
}
