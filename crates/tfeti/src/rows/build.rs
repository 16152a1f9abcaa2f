//! Building the rows: contact rows, interface blocks glob by glob, support rows.

use super::gluing::{BlockEntry, ContactRows, CopyEntry, Glob, Gluing, TangentialRows};
use crate::rows::contact::{ContactConstraints, ContactRow, PointRows};
use crate::rows::supports::{MergedSupports, dot};
use crate::subdomain::copy_stiffness::CopyStiffness;
use signorini_fem_mesh::{Decomposition, NodeCopy};

pub(super) struct Builder<'a> {
    pub(super) decomposition: &'a Decomposition,
    pub(super) stiffness: &'a CopyStiffness,
    /// Shares of the copies of a node.
    pub(super) shares: Vec<f64>,
    pub(super) gluing: Gluing,
}

impl Builder<'_> {
    /// Spreads a vector that multiplies the mean displacement of a node over its copies.
    fn spread(&mut self, node: u32, vector: [f64; 3]) {
        if vector == [0.0; 3] {
            return;
        }
        let copies = self.decomposition.copies(node as usize);
        self.stiffness.unit_shares(copies, &mut self.shares);
        let entries = copies.iter().zip(&self.shares).map(|(c, share)| CopyEntry {
            subdomain: c.subdomain,
            local: c.local,
            vector: vector.map(|v| v * share),
        });
        self.gluing.row_entries.extend(entries);
    }

    fn close(&mut self, node: u32) -> usize {
        self.gluing
            .row_pointers
            .push(self.gluing.row_entries.len() as u32);
        self.gluing.row_nodes.push(node);
        self.gluing.row_pointers.len() - 2
    }

    fn contact_row(
        &mut self,
        node: u32,
        partner: Option<u32>,
        row: &ContactRow,
        prescribed: &[(u32, [f64; 3])],
    ) -> usize {
        self.spread(node, row.node);
        if let Some(partner) = partner {
            self.spread(partner, row.partner);
        }
        let number = self.close(node);
        for (case, moved) in prescribed {
            let along: f64 = (0..3).map(|c| row.direction[c] * moved[c]).sum();
            if along != 0.0 {
                self.gluing.prescribed[*case as usize].push((number as u32, -row.scale * along));
            }
        }
        number
    }

    pub(super) fn contact(&mut self, contact: &ContactConstraints, points: &[PointRows]) {
        let place = |p: &PointRows| {
            (
                contact.points[p.point].node,
                contact.points[p.point].partner,
            )
        };
        for p in points {
            let (node, partner) = place(p);
            let row = self.contact_row(node, partner, &p.normal, &p.prescribed);
            self.gluing.contact.push(ContactRows {
                point: p.point,
                node,
                partner,
                frame: contact.points[p.point].frame,
                row,
                scale: p.normal.scale,
                tangential: TangentialRows::None,
            });
            let skew = |r: &ContactRow| {
                let length: f64 = (0..3)
                    .map(|c| r.node[c] * r.node[c] + r.partner[c] * r.partner[c])
                    .sum();
                (length - 1.0).abs() > 1e-12
            };
            if skew(&p.normal) || p.tangential.iter().any(skew) {
                (self.gluing.orthonormal, self.gluing.aligned) = (false, false);
            }
        }
        self.dependent(contact, points);
        let normal = self.gluing.nodal_rows();
        for (k, p) in points
            .iter()
            .enumerate()
            .filter(|(_, p)| p.tangential.len() == 2)
        {
            let (node, partner) = place(p);
            let row = self.contact_row(node, partner, &p.tangential[0], &p.prescribed);
            self.contact_row(node, partner, &p.tangential[1], &p.prescribed);
            self.gluing.contact[k].tangential = TangentialRows::Disc {
                row,
                scale: p.tangential[0].scale,
            };
        }
        let discs = self.gluing.nodal_rows();
        for (k, p) in points
            .iter()
            .enumerate()
            .filter(|(_, p)| p.tangential.len() == 1)
        {
            let (node, partner) = place(p);
            let tangent = &p.tangential[0];
            let row = self.contact_row(node, partner, tangent, &p.prescribed);
            let (direction, scale) = (tangent.direction, tangent.scale);
            self.gluing.contact[k].tangential = TangentialRows::Interval {
                row,
                direction,
                scale,
            };
        }
        let end = self.gluing.nodal_rows();
        let ranges = &mut self.gluing.ranges;
        (ranges.normal, ranges.discs, ranges.intervals) = (0..normal, normal..discs, discs..end);
        ranges.interface = end..end;
    }

    /// Notes the nodes whose rows may depend on one another.
    fn dependent(&mut self, contact: &ContactConstraints, points: &[PointRows]) {
        let of = |k: &usize| &contact.points[points[*k].point];
        let groups = self.gluing.node_groups();
        let mut order: Vec<usize> = (0..points.len()).collect();
        let group = |k: &usize| groups.of(of(k).node);
        order.sort_by_key(group);
        for same in order.chunk_by(|a, b| group(a) == group(b)) {
            let dragged = same.iter().any(|&k| points[k].dragged);
            if same.len() > 1 || dragged {
                let nodes = same.iter().map(of);
                let nodes = nodes.flat_map(|p| std::iter::once(p.node).chain(p.partner));
                self.gluing.dependent.extend(nodes);
                let pairs = same.iter().any(|k| of(k).partner.is_some());
                self.gluing.orthonormal &= !dragged && !pairs && separate(points, same);
            }
        }
        self.gluing.dependent.sort_unstable();
        self.gluing.dependent.dedup();
    }

    pub(super) fn interface(&mut self, nodes: usize) {
        let decomposition = self.decomposition;
        let copies = |node: u32| decomposition.copies(node as usize);
        let sharers = |node: u32| copies(node).iter().map(|c| c.subdomain);
        // number of copies and the first two subdomains, which tell most globs apart
        let mut shared: Vec<([u32; 3], u32)> = (0..nodes as u32)
            .filter_map(|node| match copies(node) {
                all @ [a, b, ..] => Some(([all.len() as u32, a.subdomain, b.subdomain], node)),
                _ => None,
            })
            .collect();
        shared.sort_unstable_by(|&(i, a), &(j, b)| {
            let by_list = || sharers(a).cmp(sharers(b));
            i.cmp(&j).then_with(by_list).then(a.cmp(&b))
        });
        let shared: Vec<u32> = shared.into_iter().map(|(_, node)| node).collect();
        for glob in shared.chunk_by(|&a, &b| sharers(a).eq(sharers(b))) {
            let runs = copies(glob[0]).len() - 1;
            self.gluing.globs.push(Glob {
                first_block: self.gluing.block_nodes.len() as u32,
                nodes: glob.len() as u32,
                runs: runs as u32,
            });
            for run in 1..=runs {
                for &node in glob {
                    self.interface_block(node, copies(node), run);
                }
            }
        }
    }

    /// Row `j` of a node's Helmert matrix.
    fn interface_block(&mut self, node: u32, copies: &[NodeCopy], j: usize) {
        let entry = |k: usize, coefficient: f64| BlockEntry {
            subdomain: copies[k].subdomain,
            local: copies[k].local,
            coefficient,
        };
        let entries = &mut self.gluing.block_entries;
        let scale = 1.0 / ((j * (j + 1)) as f64).sqrt();
        entries.extend((0..j).map(|k| entry(k, scale)));
        entries.push(entry(j, -(j as f64) * scale));
        self.gluing.block_pointers.push(entries.len() as u32);
        self.gluing.block_nodes.push(node);
    }

    pub(super) fn dirichlet(&mut self, merged: &MergedSupports) {
        for fixed in &merged.nodes {
            let copies = self.decomposition.copies(fixed.node as usize);
            let scale = self.stiffness.squares(copies).sqrt().recip();
            for direction in &fixed.directions {
                self.spread(fixed.node, direction.direction);
                let number = self.close(fixed.node);
                for &(case, value) in &direction.values {
                    self.gluing.prescribed[case as usize].push((number as u32, scale * value));
                }
            }
        }
    }
}

/// Whether the rows of different points of one node are orthogonal.
fn separate(points: &[PointRows], same: &[usize]) -> bool {
    let rows = |k: usize| std::iter::once(&points[k].normal).chain(&points[k].tangential);
    let orthogonal =
        |a: usize, b: usize| rows(a).all(|x| rows(b).all(|y| dot(&x.node, &y.node).abs() <= 1e-12));
    (1..same.len()).all(|i| (0..i).all(|j| orthogonal(same[i], same[j])))
}
