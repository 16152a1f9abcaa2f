//! Stiffness and generalised inverse of the torn body: class by class, some members of a class at a time, each rank on
//! its subdomains.

use crate::dual::inverses::ClassInverse;
use crate::linalg::block_rows::BlockRows;
use crate::linalg::sparse::SolveMemory;
use crate::system::tfeti::Tfeti;
use crate::tolerances::{PANEL, SHARED};
use rayon::prelude::*;

impl Tfeti {
    /// `y = K x` for torn vectors; zero on rigid subdomains.
    pub fn stiffness_times(&self, x: &[f64], y: &mut [f64]) {
        let rigid = |_, y: &mut [f64]| y.fill(0.0);
        self.stiffness_product(x, y, rigid, |product, _| product);
        self.complete_torn(y);
    }

    /// `y = K x - y` on the subdomains of this process, the others' are left alone. Of forces `y` on a rigid subdomain
    /// that is what moves it: it takes all others.
    pub(super) fn stiffness_less(&self, x: &[f64], y: &mut [f64]) {
        let rigid = |s, y: &mut [f64]| {
            let kernel = self.kernel(s);
            let moving = kernel.transpose_times(y);
            y.fill(0.0);
            kernel.add_motion(-1.0, &moving, y);
        };
        self.stiffness_product(x, y, rigid, |product, y| product - y);
    }

    /// `y = new(K x, y)`, entry by entry, likewise; `rigid` does it on rigid subdomains.
    fn stiffness_product(
        &self,
        x: &[f64],
        y: &mut [f64],
        rigid: impl Fn(usize, &mut [f64]) + Sync,
        new: impl Fn(f64, f64) -> f64 + Sync,
    ) {
        let dual = &self.dual;
        self.by_class(y, |class, members, columns| {
            let Some(base) = dual.subdomains.held(class) else {
                let each = members.iter().zip(columns);
                return each.for_each(|(&s, y)| rigid(s as usize, y));
            };
            if dual.subdomains.classes.classes()[class].members.len() < SHARED {
                for (&s, y) in members.iter().zip(columns) {
                    let x = &x[self.torn_range(s as usize)];
                    for (j, target) in y.iter_mut().enumerate() {
                        // Symmetric: column j is row j.
                        let (rows, values) = base.stiffness.column(j);
                        *target = new(rows.iter().zip(values).map(|(&i, v)| v * x[i]).sum(), *target);
                    }
                }
                return;
            }
            let blocks = base.blocks.get_or_init(|| BlockRows::new(&base.stiffness));
            let (dim, count) = (base.stiffness.dim, members.len());
            let mut panel = vec![0.0; dim * count];
            let mut product = vec![0.0; dim * count];
            for (m, &s) in members.iter().enumerate() {
                let x = &x[self.torn_range(s as usize)];
                x.iter().enumerate().for_each(|(i, v)| panel[i * count + m] = *v);
            }
            blocks.apply(&panel, &mut product, count);
            for (m, y) in columns.into_iter().enumerate() {
                let values = product.iter().skip(m).step_by(count);
                y.iter_mut().zip(values).for_each(|(y, v)| *y = new(*v, *y));
            }
        });
    }

    /// `u = K+ f` for torn vectors.
    pub fn generalised_inverse(&self, f: &[f64], u: &mut [f64]) {
        self.displacement(f, None, u);
        self.complete_torn(u);
    }

    /// `u = K+ f`, and `R alpha` if that is told, on the subdomains of this process, the others' are left alone.
    pub(super) fn displacement(&self, f: &[f64], alpha: Option<&[f64]>, u: &mut [f64]) {
        let dual = &self.dual;
        self.by_class(u, |class, members, columns| {
            let base = &dual.subdomains.bases[class];
            let add_motion = |s: u32, target: &mut [f64]| {
                if let Some(alpha) = alpha {
                    let own = &alpha[6 * s as usize..][..6];
                    self.kernel(s as usize).add_motion(1.0, own, target);
                }
            };
            let Some(ClassInverse { full: inverse, .. }) = &dual.inverses[class] else {
                // rigid
                for (&s, target) in members.iter().zip(columns) {
                    target.fill(0.0);
                    add_motion(s, target);
                }
                return;
            };
            let (dim, count) = (base.diagonal.len(), members.len());
            let mut memory = SolveMemory::new(inverse.need(count));
            let mut x = vec![0.0; dim * count];
            for (&s, column) in members.iter().zip(x.chunks_exact_mut(dim)) {
                column.copy_from_slice(&f[self.torn_range(s as usize)]);
            }
            inverse.apply(&base.kernel, &mut x, count, &mut memory);
            for ((&s, column), target) in members.iter().zip(x.chunks_exact(dim)).zip(columns) {
                target.copy_from_slice(column);
                add_motion(s, target);
            }
        });
    }

    /// Hands some members of a class at a time to `work`, with their parts of the torn vector `out`: those that this
    /// process works on.
    fn by_class(&self, out: &mut [f64], work: impl Fn(usize, &[u32], Vec<&mut [f64]>) + Sync) {
        let mut targets: Vec<Option<&mut [f64]>> = Vec::with_capacity(self.subdomains());
        let mut rest = &mut *out;
        for s in 0..self.subdomains() {
            let (own, tail) = std::mem::take(&mut rest).split_at_mut(self.torn_range(s).len());
            targets.push(Some(own));
            rest = tail;
        }
        let mut list = Vec::new();
        for (class, own) in self.classes().classes().iter().enumerate() {
            for members in own
                .members
                .chunks(PANEL)
                .filter(|members| self.is_here(members[0] as usize))
            {
                let columns: Vec<&mut [f64]> = members.iter().filter_map(|&s| targets[s as usize].take()).collect();
                list.push((class, members, columns));
            }
        }
        list.into_par_iter()
            .for_each(|(class, members, columns)| work(class, members, columns));
    }
}
