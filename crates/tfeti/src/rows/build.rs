//! Building the rows: contact rows, interface blocks glob by glob, support rows.

use super::gluing::{
    BlockEntry, ContactRows, CopyEntry, EquationRow, Glob, Gluing, NodeGroups, SpringRow, TangentialRows, TiedRows,
};
use crate::error::TfetiError;
use crate::rows::contact::{AllRows, ContactRow, PointRows, contact_rows};
use crate::rows::dependencies::{are_independent, not_alone};
use crate::rows::equations::{FreeEquation, NodalEquation};
use crate::rows::rigid::RigidRow;
use crate::rows::side::ContactConstraint;
use crate::rows::supports::{MergedSupports, NodalSpring, check_node};
use crate::subdomain::copy_stiffness::CopyStiffness;
use crate::tolerances::{SAME, SOFTEST, UNIT};
use signorini_fem_mesh::Decomposition;
use signorini_fem_mesh::decomposition::NodeCopy;
use signorini_fem_mesh::vec3::{dot, norm};

impl Gluing {
    /// Builds the rows. `stiffness` weighs the copies of a node in contact and support rows. Those that hold rigid
    /// subdomains come as they stand; equations are independent, with their positions. The rows of springs to the
    /// ground are the last of the support rows; with them comes the stiffness of all copies, with which they are
    /// compared: the row of a soft one is as much smaller as it is softer.
    ///
    /// # Errors
    /// [`TfetiError`] for bad contact points or springs.
    pub(crate) fn new(
        decomposition: &Decomposition,
        (supports, rigid): (&MergedSupports, &[RigidRow]),
        (contact, equations): (&[ContactConstraint], &[(usize, &NodalEquation)]),
        stiffness: &CopyStiffness,
        springs: (&[NodalSpring], &CopyStiffness),
    ) -> Result<Self, TfetiError> {
        let nodes = decomposition.nodes();
        let squares = |node: u32| stiffness.squares(decomposition.copies(node as usize));
        let found = contact_rows(contact, supports, squares)?;
        let equations = equations.iter().map(|e| FreeEquation::new(*e, decomposition, supports));
        let equations: Vec<FreeEquation> = equations.collect::<Result<_, _>>()?;
        let values = rigid.iter().flat_map(|row| &row.values);
        let cases = values
            .chain(equations.iter().flat_map(|e| &e.values))
            .map(|v| v.0 as usize + 1);
        let mut gluing = Self {
            prescribed: vec![Vec::new(); cases.fold(supports.cases, usize::max)],
            is_aligned: stiffness.is_plain() && rigid.is_empty() && equations.is_empty(),
            ..Self::default()
        };
        let mut builder = Builder {
            decomposition,
            stiffness,
            shares: Vec::new(),
            entries: Vec::new(),
            gluing: &mut gluing,
        };
        builder.contact(contact, &found.rows);
        builder.dependent(contact, &found, (supports, &equations));
        builder.interface(nodes);
        builder.tied(contact, &found.tied)?;
        builder.equations(&equations);
        builder.rigid(rigid);
        builder.dirichlet(supports);
        builder.springs(springs)?;
        let torn = decomposition.torn_dofs();
        let of_contact = contact.iter().map(|p| if p.friction || p.tied { 3 } else { 1 });
        gluing.paper_rows = torn.saturating_sub(3 * nodes) + 3 * supports.nodes.len() + of_contact.sum::<usize>();
        let count = gluing.blocks.items().len().max(gluing.nodal.items().len());
        if count.max(gluing.ranges.total()).max(torn) >= u32::MAX as usize {
            let what = "entries of B";
            return Err(TfetiError::TooLarge { what, count });
        }
        Ok(gluing)
    }
}

/// Whether the rows of a point are of unit length, and its sides of nodes that no other point needs to have.
fn is_aligned(constraint: &ContactConstraint, point: &PointRows) -> bool {
    let unit = |r: &ContactRow| {
        let length: f64 = r.parts.iter().map(|&v| dot(v, v)).sum();
        (length - 1.0).abs() <= SAME
    };
    !constraint.is_long() && unit(&point.normal) && point.tangential.iter().all(unit)
}

struct Builder<'a> {
    decomposition: &'a Decomposition,
    stiffness: &'a CopyStiffness,
    /// Shares of the copies of a node.
    shares: Vec<f64>,
    /// Of the row that is being made.
    entries: Vec<CopyEntry>,
    gluing: &'a mut Gluing,
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
        self.entries.extend(entries);
    }

    /// Number of the next row.
    fn next(&self) -> usize {
        self.gluing.nodal_row(self.gluing.nodal_rows())
    }

    fn close(&mut self, node: u32) -> usize {
        let row = self.next();
        self.gluing.nodal.push(self.entries.drain(..));
        self.gluing.row_nodes.push(node);
        row
    }

    fn contact_row(&mut self, point: &ContactConstraint, row: &ContactRow, prescribed: &[(u32, [f64; 3])]) -> usize {
        for ((node, _), part) in point.nodes().zip(&row.parts) {
            self.spread(node, *part);
        }
        let number = self.close(point.side.first());
        for &(case, moved) in prescribed {
            let along = dot(row.direction, moved);
            if along != 0.0 {
                self.gluing.prescribed[case as usize].push((number as u32, -row.scale * along));
            }
        }
        number
    }

    /// Normal rows, then pairs of tangential rows, then single ones.
    fn contact(&mut self, contact: &[ContactConstraint], points: &[PointRows]) {
        let of = |p: &PointRows| &contact[p.point];
        for p in points {
            let row = self.contact_row(of(p), &p.normal, &p.prescribed);
            self.gluing.contact.push(ContactRows {
                point: p.point,
                row,
                scale: p.normal.scale,
                tangential: TangentialRows::None,
            });
            self.gluing.is_aligned &= is_aligned(of(p), p);
        }
        let normal = self.gluing.nodal_rows();
        let mut ends = [normal; 2];
        for (end, count) in ends.iter_mut().zip([2, 1]) {
            let with = points.iter().enumerate().filter(|(_, p)| p.tangential.len() == count);
            for (k, p) in with {
                let rows = p.tangential.iter().map(|t| self.contact_row(of(p), t, &p.prescribed));
                let row = rows.min().unwrap_or_default();
                let (direction, scale) = (p.tangential[0].direction, p.tangential[0].scale);
                self.gluing.contact[k].tangential = match count {
                    2 => TangentialRows::Disc { row, scale },
                    _ => TangentialRows::Interval { row, direction, scale },
                };
            }
            *end = self.gluing.nodal_rows();
        }
        self.compliance(contact, points);
        let ([discs, end], ranges) = (ends, &mut self.gluing.ranges);
        (ranges.normal, ranges.discs, ranges.intervals) = (0..normal, normal..discs, discs..end);
        ranges.interface = end..end;
    }

    /// A force of one newton is `1 / scale` as a multiplier, and a metre `scale` as the value of a row.
    fn compliance(&mut self, contact: &[ContactConstraint], points: &[PointRows]) {
        if points.iter().all(|p| contact[p.point].compliance == [0.0; 2]) {
            return;
        }
        let mut out = vec![0.0; self.gluing.nodal_rows()];
        for (p, rows) in points.iter().zip(&self.gluing.contact) {
            let [normal, along] = contact[p.point].compliance;
            out[rows.row] = normal * p.normal.scale.powi(2);
            let first = match rows.tangential {
                TangentialRows::None => continue,
                TangentialRows::Interval { row, .. } | TangentialRows::Disc { row, .. } => row,
            };
            for (k, row) in p.tangential.iter().enumerate() {
                out[first + k] = along * row.scale.powi(2);
            }
        }
        self.gluing.contact_compliance = out;
    }

    fn tied(&mut self, contact: &[ContactConstraint], tied: &[PointRows]) -> Result<(), TfetiError> {
        for p in tied {
            let of = &contact[p.point];
            let first = self.next();
            let mut directions = Vec::with_capacity(3);
            for row in std::iter::once(&p.normal).chain(&p.tangential) {
                self.relative(p.point, of, row)?;
                self.contact_row(of, row, &p.prescribed);
                directions.push((row.direction, row.scale));
            }
            self.gluing.tied.push(TiedRows {
                point: p.point,
                rows: first..self.next(),
                directions,
            });
            self.gluing.is_aligned &= is_aligned(of, p);
        }
        self.gluing.ranges.tied = self.gluing.ranges.interface.end..self.next();
        Ok(())
    }

    /// Rows of length one, but for places, whose displacement is the mean of their nodes.
    fn equations(&mut self, equations: &[FreeEquation]) {
        for own in equations {
            let copies = |node: u32| self.decomposition.copies(node as usize);
            let square = |node: u32| self.stiffness.squares(copies(node));
            let terms = own.terms.iter().map(|(node, v)| dot(*v, *v) * square(*node));
            let places = own.places.iter().map(|(_, v)| dot(*v, *v));
            let scale = terms.chain(places).sum::<f64>().sqrt().recip();
            for &(node, vector) in &own.terms {
                let factor = scale * square(node).sqrt();
                self.spread(node, vector.map(|v| factor * v));
            }
            let mut first = own.terms.first().map(|t| t.0);
            for &(subdomain, vector) in &own.places {
                let nodes = &self.decomposition.subdomains()[subdomain as usize].nodes;
                let vector = vector.map(|v| scale * v / nodes.len() as f64);
                let entry = |local: u32| CopyEntry {
                    subdomain,
                    local,
                    vector,
                };
                self.entries.extend((0..nodes.len() as u32).map(entry));
                first = first.or(nodes.first().copied());
            }
            let row = self.close(first.unwrap_or(0));
            for &(case, value) in &own.values {
                self.gluing.prescribed[case as usize].push((row as u32, scale * value));
            }
            self.gluing.equations.push(EquationRow {
                equation: own.equation,
                row,
                scale: scale * own.factor,
            });
        }
        self.gluing.ranges.equations = self.gluing.ranges.tied.end..self.next();
    }

    /// What a tied row does to the motion that its side has beside that of the partner.
    fn relative(&mut self, point: usize, tied: &ContactConstraint, row: &ContactRow) -> Result<(), TfetiError> {
        let Some((subdomain, factor)) = tied.relative else {
            return Ok(());
        };
        let own = self.decomposition.subdomains().get(subdomain as usize);
        let own = own.filter(|own| own.is_relative);
        let factor = -factor * row.scale;
        for (node, vector) in tied.on_side(row.direction) {
            let what = "the subdomain of its relative motion does not have its nodes";
            let local = own.and_then(|own| own.local(node));
            let local = local.ok_or(TfetiError::BadSide { point, what })? as u32;
            let vector = vector.map(|c| factor * c);
            self.entries.push(CopyEntry {
                subdomain,
                local,
                vector,
            });
        }
        Ok(())
    }

    /// Notes which nodes belong together, and those whose rows may depend on one another.
    fn dependent(
        &mut self,
        contact: &[ContactConstraint],
        found: &AllRows,
        (supports, equations): (&MergedSupports, &[FreeEquation]),
    ) {
        let points: Vec<&PointRows> = found.rows.iter().chain(&found.tied).collect();
        let of = |k: &usize| &contact[points[*k].point];
        let joined = equations.iter().map(|e| e.terms.iter().map(|t| t.0).collect());
        self.gluing.groups = NodeGroups::new(points.iter().map(|p| &contact[p.point]), joined);
        let left = not_alone(contact, &points, supports);
        let groups = NodeGroups::new(left.iter().map(of), std::iter::empty());
        let group = |k: &usize| groups.of(of(k).side.first());
        let mut order = left;
        order.sort_by_key(group);
        for same in order.chunk_by(|a, b| group(a) == group(b)) {
            let dragged = same.iter().any(|&k| points[k].dragged);
            let long = same.iter().any(|k| of(k).is_long());
            if dragged || same.len() > 1 && !(long && are_independent(same.iter().map(|k| (of(k), points[*k])))) {
                let nodes = same.iter().flat_map(|k| of(k).nodes());
                self.gluing.dependent.extend(nodes.map(|n| n.0));
            }
        }
        self.gluing.dependent.sort_unstable();
        self.gluing.dependent.dedup();
        self.gluing.exchanging = groups;
    }

    fn interface(&mut self, nodes: usize) {
        let decomposition = self.decomposition;
        let copies = |node: u32| decomposition.copies(node as usize);
        let sharers = |node: u32| copies(node).iter().map(|c| c.subdomain);
        // by the first subdomain, so that ranks share few rows; with the number of copies and the second one most globs
        // are told apart
        let mut shared: Vec<([u32; 3], u32)> = (0..nodes as u32)
            .filter_map(|node| match copies(node) {
                all @ [a, b, ..] => Some(([a.subdomain, all.len() as u32, b.subdomain], node)),
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
        self.gluing.ranges.interface.end += 3 * self.gluing.blocks();
    }

    /// Row `j` of a node's Helmert matrix.
    fn interface_block(&mut self, node: u32, copies: &[NodeCopy], j: usize) {
        let entry = |k: usize, coefficient: f64| BlockEntry {
            subdomain: copies[k].subdomain,
            local: copies[k].local,
            coefficient,
        };
        let scale = 1.0 / ((j * (j + 1)) as f64).sqrt();
        let first = (0..j).map(|k| entry(k, scale));
        self.gluing.blocks.push(first.chain([entry(j, -(j as f64) * scale)]));
        self.gluing.block_nodes.push(node);
    }

    /// A spring is a support that gives way. With a row of length one its compliance is `c`, and that of the body
    /// about the inverse of the stiffness `k` of the copies; the row is scaled by the root of `1 / (1 + c k)`, so that
    /// both together are `1 / k` as for other rows.
    fn springs(&mut self, (springs, all): (&[NodalSpring], &CopyStiffness)) -> Result<(), TfetiError> {
        for (k, spring) in springs.iter().enumerate() {
            let (node, stiffness) = (spring.node, spring.stiffness);
            check_node(node, self.decomposition.nodes(), || format!("spring {k}"))?;
            let copies = self.decomposition.copies(node as usize);
            let compliance = 1.0 / (self.stiffness.squares(copies) * stiffness);
            let turned = (norm(spring.direction) - 1.0).abs();
            if !(compliance.is_finite() && compliance > 0.0 && turned <= UNIT) {
                return Err(TfetiError::Spring { node, stiffness });
            }
            self.stiffness.unit_shares(copies, &mut self.shares);
            let shares = copies.iter().zip(&self.shares);
            let own: f64 = shares.map(|(copy, share)| share * share * all.of(copy)).sum();
            let wanted = (1.0 + compliance * own).sqrt().recip();
            let scale = wanted.max(SOFTEST);
            self.spread(node, spring.direction.map(|c| scale * c));
            let row = self.close(node);
            let length = scale / self.stiffness.squares(copies).sqrt();
            for &(case, value) in &spring.rest {
                let of_case = self.gluing.prescribed.get_mut(case as usize);
                let of_case = of_case.filter(|_| value.is_finite());
                let of_case = of_case.ok_or(TfetiError::SpringRest { node, case, value })?;
                of_case.push((row as u32, length * value));
            }
            self.gluing.springs.push(SpringRow {
                compliance: scale * scale * compliance,
                scale,
                factor: wanted / (scale * scale),
            });
        }
        self.gluing.ranges.dirichlet = self.gluing.ranges.rigid.end..self.next();
        Ok(())
    }

    fn rigid(&mut self, rows: &[RigidRow]) {
        for row in rows {
            self.entries.extend(&row.entries);
            let number = self.close(row.node);
            for &(case, value) in &row.values {
                self.gluing.prescribed[case as usize].push((number as u32, row.scale * value));
            }
        }
        self.gluing.ranges.rigid = self.gluing.ranges.equations.end..self.next();
    }

    fn dirichlet(&mut self, supports: &MergedSupports) {
        for fixed in &supports.nodes {
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
