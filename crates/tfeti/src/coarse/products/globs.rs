//! Rigid motions on the interface, glob by glob.
//!
//! On the nodes of a glob a rigid motion is `t + omega x q` with the arms `q` from their mean. The blocks of a run
//! combine the subdomains with the same coefficients, so a run takes one combined motion and gives one wrench; only
//! these are shifted to the centres of the subdomains. Globs of one shape share their arms.

use crate::dual::boundary::{over_tasks, shares};
use crate::rows::gluing::Gluing;
use crate::subdomain::kernel::{Kernel, add_wrench, displacement};
use crate::tolerances::{GLOB_TASK, PARTS};
use pulp::{Arch, Simd, WithSimd};
use signorini_fem_mesh::internal::Lists;
use signorini_fem_mesh::vec3::add;
use std::collections::HashMap;
use std::hint::black_box;
use std::ops::Range;

/// The globs and their *sides*: the pairs of a glob and a subdomain that shares it.
#[derive(Debug, Default)]
pub(crate) struct GlobTables {
    globs: Vec<Piece>,
    /// Subdomain of each side.
    subdomains: Vec<u32>,
    /// From the centre of the subdomain to the mean of the nodes.
    levers: Vec<[f64; 3]>,
    /// Arms of each shape: for each chunk `q_(c+2)` for each component `c` of each node, then `-q_(c+1)`.
    arms: Vec<Arms>,
    /// The same for each node.
    node_arms: Vec<NodeArms>,
    /// For each run one for each side.
    coefficients: Vec<f64>,
    /// Consecutive globs with about equal work.
    tasks: Vec<Range<usize>>,
    /// Sides of each subdomain.
    sides: Lists<u32>,
}

/// A glob and where its data stand.
#[derive(Debug, Clone, Copy)]
struct Piece {
    blocks: u32,
    nodes: u32,
    runs: u32,
    side: u32,
    count: u32,
    arms: u32,
    node_arms: u32,
    coefficients: u32,
}

impl GlobTables {
    pub(crate) fn new<'k>(gluing: &Gluing, subdomains: usize, kernel: impl Fn(u32) -> (usize, &'k Kernel)) -> Self {
        let mut out = Self::default();
        let mut shapes: HashMap<(usize, Vec<u32>), [u32; 2]> = HashMap::new();
        let mut rules: Vec<Range<usize>> = Vec::new();
        for glob in &gluing.globs {
            let sides = gluing.copies(glob, 0);
            let locals = |side: usize| (0..glob.nodes as usize).map(move |n| gluing.copies(glob, n)[side].local);
            let first = out.subdomains.len();
            for (k, side) in sides.iter().enumerate() {
                let (_, kernel) = kernel(side.subdomain);
                let sum = locals(k).fold([0.0; 3], |sum, local| add(sum, arm(kernel, local)));
                out.subdomains.push(side.subdomain);
                out.levers.push(sum.map(|v| v / f64::from(glob.nodes)));
            }
            let (class, own) = kernel(sides[0].subdomain);
            let locals = locals(0).collect();
            let [arms, node_arms] = *shapes.entry((class, locals)).or_insert_with_key(|key| {
                let start = [out.arms.len() as u32, out.node_arms.len() as u32];
                out.push_arms(own, &key.1, &out.levers[first].clone());
                start
            });
            let start = out.coefficients.len();
            for run in 0..glob.runs as usize {
                // a run combines the first sides
                let entries = gluing.block(glob.block(run, 0)).iter().map(|e| e.coefficient);
                let others = std::iter::repeat(0.0);
                out.coefficients.extend(entries.chain(others).take(sides.len()));
            }
            let (old, new) = out.coefficients.split_at(start);
            let coefficients = match rules.iter().find(|r| old[(*r).clone()] == *new) {
                Some(same) => {
                    out.coefficients.truncate(start);
                    same.start
                }
                None => {
                    rules.push(start..out.coefficients.len());
                    start
                }
            };
            out.globs.push(Piece {
                blocks: glob.first_block,
                nodes: glob.nodes,
                runs: glob.runs,
                side: first as u32,
                count: sides.len() as u32,
                arms,
                node_arms,
                coefficients: coefficients as u32,
            });
        }
        let work = |p: &Piece| u64::from(p.runs * (p.nodes + 4 * p.count) + 8);
        let work: Vec<u64> = out.globs.iter().map(work).collect();
        out.tasks = shares(&work, GLOB_TASK, PARTS);
        out.sides = Lists::by_key(subdomains, &out.subdomains);
        out
    }

    fn push_arms(&mut self, kernel: &Kernel, locals: &[u32], mean: &[f64; 3]) {
        for locals in locals.chunks(CHUNK / 3) {
            let mut arms = Arms::default();
            for (k, &local) in locals.iter().enumerate() {
                let arm = arm(kernel, local);
                let [x, y, z] = [0, 1, 2].map(|c| arm[c] - mean[c]);
                arms.next[3 * k..][..3].copy_from_slice(&[z, x, y]);
                arms.last[3 * k..][..3].copy_from_slice(&[-y, -z, -x]);
                self.node_arms.push(NodeArms {
                    next: [z, x, y, 0.0],
                    last: [-y, -z, -x, 0.0],
                });
            }
            self.arms.push(arms);
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.subdomains.len()
    }

    pub(crate) fn sides_of(&self, subdomain: usize) -> &[u32] {
        self.sides.of(subdomain)
    }

    /// Wrench on a subdomain, about its centre, from those on its sides.
    #[inline]
    pub(crate) fn wrench(&self, subdomain: usize, sides: &[Wrench]) -> [f64; 6] {
        let mut sum = [0.0; 6];
        for &side in self.sides_of(subdomain) {
            let side = side as usize;
            let [[fx, fy, fz, _], [mx, my, mz, _]] = sides[side];
            add_wrench(&mut sum, &self.levers[side], [fx, fy, fz]);
            sum[3] += mx;
            sum[4] += my;
            sum[5] += mz;
        }
        sum
    }

    /// Wrenches of the interface rows `x` on each side, about the mean of its nodes.
    pub(crate) fn wrenches(&self, x: &[f64], out: &mut [Wrench], parallel: bool) {
        let offset = |task: &Range<usize>| self.globs[task.start].side as usize;
        over_tasks(&self.tasks, out, &offset, parallel, &|task, out| {
            Arch::new().dispatch(Wrenches {
                tables: self,
                globs: &self.globs[task.clone()],
                x,
                out,
            });
        });
    }

    /// Hands each interface row to `each` with the displacement that the motions of the subdomains give it.
    pub(crate) fn motions(
        &self,
        motions: &[[f64; 6]],
        x: &mut [f64],
        parallel: bool,
        each: &(impl Fn(&mut f64, f64) + Sync),
    ) {
        let offset = |task: &Range<usize>| 3 * self.globs[task.start].blocks as usize;
        over_tasks(&self.tasks, x, &offset, parallel, &|task, x| {
            Arch::new().dispatch(Motions {
                tables: self,
                globs: &self.globs[task.clone()],
                motions,
                x,
                each,
            });
        });
    }
}

/// Arm of a node in metres.
fn arm(kernel: &Kernel, local: u32) -> [f64; 3] {
    kernel.arm(local as usize).map(|a| a * kernel.radius())
}

/// Numbers worked on at a time: whole nodes and whole vector registers.
const CHUNK: usize = 12;
/// Sides of a glob whose shifted motions are kept.
const KEPT: usize = 8;

/// Arms of some nodes, zero behind the last.
#[derive(Debug, Clone, Copy, Default)]
struct Arms {
    next: [f64; CHUNK],
    last: [f64; CHUNK],
}

/// Arms of one node.
#[derive(Debug, Clone, Copy)]
struct NodeArms {
    next: [f64; 4],
    last: [f64; 4],
}

/// Force and moment, each with one unused number.
pub(crate) type Wrench = [[f64; 4]; 2];

/// The arguments of [`GlobTables::wrenches`] for some globs, for the dispatcher to vector instructions.
struct Wrenches<'a> {
    tables: &'a GlobTables,
    globs: &'a [Piece],
    x: &'a [f64],
    out: &'a mut [Wrench],
}

impl WithSimd for Wrenches<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let tables = self.tables;
        let mut rest = self.out;
        for piece in self.globs {
            let count = piece.count as usize;
            let (out, tail) = std::mem::take(&mut rest).split_at_mut(count);
            rest = tail;
            let length = 3 * piece.nodes as usize;
            let arms = &tables.node_arms[piece.node_arms as usize..][..piece.nodes as usize];
            let coefficients = &tables.coefficients[piece.coefficients as usize..];
            let x = &self.x[3 * piece.blocks as usize..];
            for run in 0..piece.runs as usize {
                let wrench = run_wrench(&x[run * length..][..length], arms);
                let coefficients = &coefficients[run * count..][..count];
                for (&coefficient, out) in coefficients.iter().zip(&mut *out) {
                    // loaded for itself: vectorised over the sides, the loop took a quarter longer
                    let coefficient = black_box(coefficient);
                    for (out, wrench) in out.iter_mut().zip(&wrench) {
                        let old = if run == 0 { [0.0; 4] } else { *out };
                        *out = std::array::from_fn(|c| old[c] + coefficient * wrench[c]);
                    }
                }
            }
        }
    }
}

/// Wrench of the forces `x` about the mean of the nodes.
#[inline(always)]
fn run_wrench(x: &[f64], arms: &[NodeArms]) -> Wrench {
    if let &[a, b, c] = x {
        // a single node is its own mean
        return [[a, b, c, 0.0], [0.0; 4]];
    }
    let mut sums = [[[0.0; 4]; 3]; 2];
    // what follows a node's three numbers does not matter
    let mut nodes = arms.iter().zip(x.windows(4).step_by(3));
    while let Some((arms, x)) = nodes.next() {
        sums[0] = add_node(sums[0], x, arms);
        if let Some((arms, x)) = nodes.next() {
            sums[1] = add_node(sums[1], x, arms);
        }
    }
    if let (Some(&[a, b, c]), Some(arms)) = (x.last_chunk(), arms.last()) {
        sums[1] = add_node(sums[1], &[a, b, c, 0.0], arms);
    }
    let [f, a, b]: [[f64; 4]; 3] = std::array::from_fn(|k| std::array::from_fn(|l| sums[0][k][l] + sums[1][k][l]));
    let moment = [a[2] + b[1], a[0] + b[2], a[1] + b[0], 0.0];
    [f, moment]
}

#[inline(always)]
fn add_node([force, first, second]: [[f64; 4]; 3], x: &[f64], arms: &NodeArms) -> [[f64; 4]; 3] {
    let x: [f64; 4] = std::array::from_fn(|l| x[l]);
    [
        std::array::from_fn(|l| force[l] + x[l]),
        std::array::from_fn(|l| first[l] + x[l] * arms.next[l]),
        std::array::from_fn(|l| second[l] + x[l] * arms.last[l]),
    ]
}

/// The arguments of [`GlobTables::motions`] likewise.
struct Motions<'a, F> {
    tables: &'a GlobTables,
    globs: &'a [Piece],
    motions: &'a [[f64; 6]],
    x: &'a mut [f64],
    each: &'a F,
}

impl<F: Fn(&mut f64, f64)> WithSimd for Motions<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (tables, motions) = (self.tables, self.motions);
        let mut rest = self.x;
        let mut kept = [[0.0; 6]; KEPT];
        for piece in self.globs {
            let count = piece.count as usize;
            let sides = piece.side as usize..piece.side as usize + count;
            let (owners, levers) = (&tables.subdomains[sides.clone()], &tables.levers[sides]);
            let shifted = |k: usize| {
                let motion = &motions[owners[k] as usize];
                let [x, y, z] = displacement(motion, &levers[k]);
                [x, y, z, motion[3], motion[4], motion[5]]
            };
            for (k, kept) in kept.iter_mut().take(count).enumerate() {
                *kept = shifted(k);
            }
            let length = 3 * piece.nodes as usize;
            let arms = &tables.arms[piece.arms as usize..][..length.div_ceil(CHUNK)];
            let coefficients = &tables.coefficients[piece.coefficients as usize..];
            for run in 0..piece.runs as usize {
                let coefficients = &coefficients[run * count..][..count];
                let mut motion = [0.0; 6];
                for (side, &coefficient) in kept.iter().zip(coefficients) {
                    motion = std::array::from_fn(|c| motion[c] + coefficient * side[c]);
                }
                for (k, &coefficient) in coefficients.iter().enumerate().skip(KEPT) {
                    let side = shifted(k);
                    motion = std::array::from_fn(|c| motion[c] + coefficient * side[c]);
                }
                let (x, tail) = std::mem::take(&mut rest).split_at_mut(length);
                rest = tail;
                run_motion(&motion, arms, x, self.each);
            }
        }
    }
}

/// Hands the entries of `x` to `each` with the displacements of a motion about the mean of the nodes.
#[inline(always)]
fn run_motion(motion: &[f64; 6], arms: &[Arms], x: &mut [f64], each: &impl Fn(&mut f64, f64)) {
    if let [a, b, c] = x {
        each(a, motion[0]);
        each(b, motion[1]);
        each(c, motion[2]);
        return;
    }
    let shift: [f64; CHUNK] = std::array::from_fn(|l| motion[l % 3]);
    let first: [f64; CHUNK] = std::array::from_fn(|l| motion[3 + (l + 1) % 3]);
    let second: [f64; CHUNK] = std::array::from_fn(|l| motion[3 + (l + 2) % 3]);
    let values = |arms: &Arms| -> [f64; CHUNK] {
        std::array::from_fn(|l| shift[l] + first[l] * arms.next[l] + second[l] * arms.last[l])
    };
    let (chunks, rest) = x.as_chunks_mut::<CHUNK>();
    for (x, arms) in chunks.iter_mut().zip(arms) {
        let values = values(arms);
        for l in 0..CHUNK {
            each(&mut x[l], values[l]);
        }
    }
    if let ([_, ..], Some(arms)) = (&*rest, arms.last()) {
        for (x, value) in rest.iter_mut().zip(values(arms)) {
            each(x, value);
        }
    }
}
