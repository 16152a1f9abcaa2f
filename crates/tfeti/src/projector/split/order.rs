//! Order of elimination of the coarse unknowns: nested dissection by the centres of the subdomains.
//!
//! The blocks whose matrix changes with the active set are wanted late, yet not all at the very end, where they
//! would form one large dense matrix. The first cuts divide all blocks; each piece that they leave then
//! eliminates its steady blocks before the changing ones.

use crate::linalg::sparse::{FactorError, minimum_degree};
use crate::tolerances::{CUT, LAYER, PERIOD};
use std::ops::Range;

/// Blocks in the order of elimination and the regions of the cuts.
#[derive(Debug)]
pub(crate) struct Dissection {
    pub(crate) blocks: Vec<u32>,
    /// Each region after the regions within it; the whole comes last.
    pub(crate) regions: Vec<Region>,
}

/// Blocks eliminated one after another, after those of the regions within.
#[derive(Debug, Clone)]
pub(crate) struct Region {
    /// Position of the first block of the first region within.
    pub(crate) start: usize,
    /// Own blocks.
    pub(crate) own: Range<usize>,
    /// The regions on both sides of the cut.
    pub(crate) children: Option<[usize; 2]>,
}

impl Dissection {
    /// For the `graph` of the blocks (neighbours of each, without itself) at `centres`; `cuts` levels of cuts go
    /// through the blocks that are `changing`. In a `grid` the pieces are alike.
    pub(crate) fn new(
        graph: &[Vec<u32>],
        centres: &[[f64; 3]],
        changing: &[bool],
        cuts: usize,
        grid: Option<&[[u32; 3]]>,
    ) -> Result<Self, FactorError> {
        let mut out = Self {
            blocks: Vec::with_capacity(graph.len()),
            regions: Vec::new(),
        };
        let work = &mut Cutter {
            graph,
            centres,
            changing,
            grid,
            mark: vec![ELSEWHERE; graph.len()],
        };
        out.region(work, (0..graph.len() as u32).collect(), cuts)?;
        Ok(out)
    }

    /// Orders `blocks` and returns the number of their region.
    fn region(&mut self, work: &mut Cutter<'_>, blocks: Vec<u32>, cuts: usize) -> Result<usize, FactorError> {
        let start = self.blocks.len();
        let (mut children, mut inner, mut last) = (None, blocks, Vec::new());
        let mut cut = if cuts > 0 { work.cut(&inner) } else { None };
        if cut.is_none() {
            (last, inner) = (inner.into_iter()).partition(|&b| work.changing[b as usize]);
            cut = work.cut(&inner);
        }
        if let Some([left, middle, right]) = cut {
            let left = self.region(work, left, cuts.saturating_sub(1))?;
            let right = self.region(work, right, cuts.saturating_sub(1))?;
            (children, inner) = (Some([left, right]), middle);
        } else {
            inner = order_part(work.graph, &inner)?;
        }
        let first = self.blocks.len();
        self.blocks.extend(inner.into_iter().chain(last));
        self.regions.push(Region {
            start,
            own: first..self.blocks.len(),
            children,
        });
        Ok(self.regions.len() - 1)
    }
}

struct Cutter<'a> {
    graph: &'a [Vec<u32>],
    centres: &'a [[f64; 3]],
    changing: &'a [bool],
    /// Layers of the blocks in a grid, if they stand in one.
    grid: Option<&'a [[u32; 3]]>,
    /// Sides of the blocks of a cut.
    mark: Vec<u8>,
}

const ELSEWHERE: u8 = 3;

impl Cutter<'_> {
    /// Two halves that do not touch and the layer between them, the thinnest of three directions; `None` if no cut is
    /// worth it.
    fn cut(&mut self, blocks: &[u32]) -> Option<[Vec<u32>; 3]> {
        if blocks.len() < CUT {
            return None;
        }
        let mut best: Option<[Vec<u32>; 3]> = None;
        for axis in 0..3 {
            let sides = match self.grid {
                Some(grid) => match self.layer(blocks, grid, axis) {
                    Some(sides) => sides,
                    None => continue,
                },
                None => self.halves(blocks, axis),
            };
            let balanced = sides[0].len().min(sides[2].len()) * 5 >= blocks.len();
            let thinner = best.as_ref().is_none_or(|b| sides[1].len() < b[1].len());
            if balanced && thinner {
                best = Some(sides);
            }
        }
        best
    }

    /// Left, layer and right of the layer of a grid that divides most evenly, among those with the largest power of
    /// two.
    fn layer(&self, blocks: &[u32], grid: &[[u32; 3]], axis: usize) -> Option<[Vec<u32>; 3]> {
        let at = |b: u32| grid[b as usize][axis];
        let all = blocks.iter().map(|&b| at(b));
        let (first, last) = (all.clone().min()?, all.max()?);
        let even = |&c: &u32| 3 * (c - first).min(last - c) > last - first;
        let layers = (first..last).filter(|c| (c + 1).is_multiple_of(PERIOD)).filter(even);
        let cut = layers.max_by_key(|c| ((c + 1).trailing_zeros(), (c - first).min(last - c)))?;
        let side = |keep: fn(&u32, &u32) -> bool| blocks.iter().copied().filter(|&b| keep(&at(b), &cut)).collect();
        let sides: [Vec<u32>; 3] = [side(u32::lt), side(u32::eq), side(u32::gt)];
        let crosses = |b: &u32| self.graph[*b as usize].iter().any(|&n| at(n) > cut && at(n) <= last);
        (!sides[0].iter().any(crosses)).then_some(sides)
    }

    /// Left, layer and right of the median along an axis.
    fn halves(&mut self, blocks: &[u32], axis: usize) -> [Vec<u32>; 3] {
        let at = |b: u32| self.centres[b as usize][axis];
        let mut values: Vec<f64> = blocks.iter().map(|&b| at(b)).collect();
        values.sort_by(f64::total_cmp);
        let extent = values[values.len() - 1] - values[0];
        let limit = values[values.len() / 2] - LAYER * extent;
        for &b in blocks {
            self.mark[b as usize] = if at(b) < limit { 0 } else { 2 };
        }
        for &b in blocks {
            let touches = |n: &u32| self.mark[*n as usize] == 0;
            if self.mark[b as usize] == 2 && self.graph[b as usize].iter().any(touches) {
                self.mark[b as usize] = 1;
            }
        }
        let side = |k: u8| {
            let all = blocks.iter().copied();
            all.filter(|&b| self.mark[b as usize] == k).collect::<Vec<u32>>()
        };
        let sides = [side(0), side(1), side(2)];
        for &b in blocks {
            self.mark[b as usize] = ELSEWHERE;
        }
        sides
    }
}

/// The layers of points that stand in a grid, along each axis; `None` if most places of the grid are empty.
pub(crate) fn grid_of(points: &[[f64; 3]]) -> Option<Vec<[u32; 3]>> {
    let mut out = vec![[0; 3]; points.len()];
    let mut places = 1_usize;
    for axis in 0..3 {
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|&a, &b| points[a][axis].total_cmp(&points[b][axis]));
        let (first, last) = (*order.first()?, *order.last()?);
        let gap = LAYER * (points[last][axis] - points[first][axis]);
        let (mut layer, mut before) = (0, points[first][axis]);
        for k in order {
            layer += u32::from(points[k][axis] - before > gap);
            before = points[k][axis];
            out[k][axis] = layer;
        }
        places = places.saturating_mul(layer as usize + 1);
    }
    (places <= 2 * points.len()).then_some(out)
}

/// Order of a part: minimum degree among the part and the blocks around it, which come later and are then all coupled.
fn order_part(graph: &[Vec<u32>], part: &[u32]) -> Result<Vec<u32>, FactorError> {
    const OUTSIDE: u32 = u32::MAX;
    let mut place = vec![OUTSIDE; graph.len()];
    for (k, &b) in part.iter().enumerate() {
        place[b as usize] = k as u32;
    }
    let mut around: Vec<u32> = Vec::new();
    for &b in part {
        for &n in &graph[b as usize] {
            if place[n as usize] == OUTSIDE {
                place[n as usize] = (part.len() + around.len()) as u32;
                around.push(n);
            }
        }
    }
    let count = part.len() + around.len();
    let mut lists: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (k, &b) in part.iter().enumerate() {
        lists[k].push(k);
        for &n in &graph[b as usize] {
            let n = place[n as usize] as usize;
            lists[k].push(n);
            if n >= part.len() {
                lists[n].push(k);
            }
        }
    }
    for k in part.len()..count {
        lists[k].extend(part.len()..count);
    }
    let (mut pointers, mut rows) = (vec![0], Vec::new());
    for mut list in lists {
        list.sort_unstable();
        rows.extend(list);
        pointers.push(rows.len());
    }
    let order = minimum_degree(&pointers, &rows)?;
    let inside = order.into_iter().filter(|&k| k < part.len());
    Ok(inside.map(|k| part[k]).collect())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A grid of blocks with neighbours across faces, edges and corners, and its centres.
    pub(crate) fn grid([nx, ny, nz]: [usize; 3]) -> (Vec<Vec<u32>>, Vec<[f64; 3]>) {
        let mut centres = Vec::new();
        for (i, j) in (0..nx).flat_map(|i| (0..ny).map(move |j| (i, j))) {
            centres.extend((0..nz).map(|k| [i as f64, j as f64, k as f64]));
        }
        let near = |a: &[f64; 3], b: &[f64; 3]| (0..3).all(|c| (a[c] - b[c]).abs() < 1.5);
        let graph = (centres.iter())
            .map(|a| {
                let others = (0..centres.len()).filter(|&b| near(a, &centres[b]));
                let others = others.filter(|&b| centres[b] != *a);
                others.map(|b| b as u32).collect()
            })
            .collect();
        (graph, centres)
    }

    #[test]
    fn regions_cover_all_and_halves_do_not_touch() {
        let (graph, centres) = grid([20, 4, 3]);
        let bottom: Vec<bool> = centres.iter().map(|c| c[2] == 0.0).collect();
        for (changing, cuts) in [(vec![false; 240], 0), (bottom.clone(), 0), (bottom, 2)] {
            let d = Dissection::new(&graph, &centres, &changing, cuts, None).unwrap();
            let mut sorted = d.blocks.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..240), "a permutation");
            assert_eq!(d.regions.last().map(|r| r.own.end), Some(240));
            for region in &d.regions {
                let Some([left, right]) = region.children else {
                    assert_eq!(region.start, region.own.start);
                    continue;
                };
                let (left, right) = (&d.regions[left], &d.regions[right]);
                assert_eq!((region.start, left.own.end), (left.start, right.start));
                assert_eq!(right.own.end, region.own.start);
                for &a in &d.blocks[left.start..left.own.end] {
                    let other = &d.blocks[right.start..right.own.end];
                    assert!(other.iter().all(|b| !graph[a as usize].contains(b)));
                }
            }
            let root = d.regions.last().unwrap();
            let own = &d.blocks[root.own.clone()];
            let floor = own.iter().filter(|&&b| changing[b as usize]).count();
            let expected = if cuts == 0 { 80 } else { 4 };
            assert!(floor == expected || changing == [false; 240], "{floor}");
        }
    }

    #[test]
    fn blocks_at_one_point_are_one_region() {
        let graph: Vec<Vec<u32>> = (0..50).map(|a| if a > 0 { vec![a - 1] } else { vec![] }).collect();
        let d = Dissection::new(&graph, &[[1.0; 3]; 50], &[true; 50], 3, None).unwrap();
        assert_eq!((d.regions.len(), d.blocks.len()), (1, 50));
    }
}
