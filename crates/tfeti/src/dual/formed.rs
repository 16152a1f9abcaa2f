//! `F` as a matrix: each subdomain answers for the rows that touch it, so a column costs what its subdomains do.

use std::borrow::Cow;

use crate::dual::operator::DualOperator;

/// Coefficients of rows at one subdomain, by row: its place, unknown of the boundary, coefficient.
type Rows = Vec<(usize, usize, f64)>;

impl DualOperator {
    /// `F` by columns, lower triangle, zeros above; row `first` comes first, those before it last. The same on all ranks.
    pub(crate) fn formed(&self, first: usize) -> Vec<f64> {
        let rows = self.gluing.ranges().total();
        let row_at = |place: usize| (place + first) % rows.max(1);
        let mut matrix = vec![0.0; rows * rows];
        let mut touching: Vec<Rows> = vec![Vec::new(); self.subdomains.count()];
        for place in 0..rows {
            for (subdomain, unknown, coefficient) in self.gluing.row(row_at(place)) {
                touching[subdomain].push((place, unknown, coefficient));
            }
        }
        for (class, own) in self.subdomains.classes.classes().iter().enumerate() {
            if own.is_rigid {
                continue;
            }
            let inverse = self.boundary_inverse(class);
            for &member in &own.members {
                self.add_member(class, &inverse, &mut touching[member as usize], &mut matrix);
            }
        }
        for (row, compliance) in self.gluing.compliance() {
            let place = (row + rows - first) % rows;
            matrix[place * (rows + 1)] += compliance;
        }
        matrix
    }

    /// The inverse of a class on its boundary, from a rank that holds it.
    fn boundary_inverse(&self, class: usize) -> Cow<'_, [f64]> {
        let (nodes, ownership) = (&self.map.classes[class].nodes, &self.subdomains.ownership);
        let size = (3 * nodes.len()).pow(2);
        let (from, exchange) = (ownership.rank_of(class, 0), &ownership.exchange);
        let mut matrix = match &self.inverses[class] {
            Some(own) if from == exchange.rank() => match &own.boundary {
                Some(matrix) => Cow::from(matrix),
                None => Cow::from(own.full.boundary_block(&self.subdomains.bases[class].kernel, nodes)),
            },
            _ => Cow::from(vec![0.0; size]),
        };
        if exchange.ranks() > 1 {
            exchange.complete(matrix.to_mut(), &[(from, 0..size)]);
        }
        matrix
    }

    /// Adds `B A B^T` of a subdomain, whose rows are left in unknowns of the boundary.
    fn add_member(&self, class: usize, inverse: &[f64], rows: &mut Rows, out: &mut [f64]) {
        let nodes = &self.map.classes[class].nodes;
        let (size, height) = (3 * nodes.len(), self.gluing.ranges().total());
        for (_, unknown, _) in &mut *rows {
            let node = nodes.partition_point(|node| (*node as usize) < *unknown / 3);
            *unknown = 3 * node + *unknown % 3;
        }
        let mut answer = vec![0.0; size];
        for row in rows.chunk_by(|a, b| a.0 == b.0) {
            answer.fill(0.0);
            for (_, unknown, coefficient) in row {
                let column = &inverse[unknown * size..(unknown + 1) * size];
                answer.iter_mut().zip(column).for_each(|(y, a)| *y += coefficient * a);
            }
            let column = &mut out[row[0].0 * height..(row[0].0 + 1) * height];
            let from = rows.partition_point(|other| other.0 < row[0].0);
            for (place, unknown, coefficient) in &rows[from..] {
                column[*place] += coefficient * answer[*unknown];
            }
        }
    }
}
