//! A dense matrix by its factors, `P A = L U`, in memory that is kept.

use std::ops::Range;

/// Pivots below this are none.
const PIVOT: f64 = 1e-30;

/// The factors of a matrix, row after row: those of `L` below the diagonal, where its own are 1.
#[derive(Debug, Default)]
pub(crate) struct DenseFactor {
    n: usize,
    entries: Vec<f64>,
    /// The row that each row was exchanged with, in turn.
    exchanged: Vec<usize>,
    /// Where the entries of each row begin and end that are not 0: things that touch their neighbours alone make bands.
    extents: Vec<Range<usize>>,
}

impl DenseFactor {
    /// A matrix of zeros, whose lines are to be written.
    pub(crate) fn clear(&mut self, n: usize) {
        self.n = n;
        self.entries.clear();
        self.entries.resize(n * n, 0.0);
    }

    /// A line of the matrix.
    pub(crate) fn line(&mut self, row: usize) -> &mut [f64] {
        &mut self.entries[self.n * row..][..self.n]
    }

    /// Factors what was written, by elimination with pivots of columns; says whether each had one.
    pub(crate) fn factorize(&mut self) -> bool {
        let DenseFactor { n, entries, exchanged, extents } = self;
        let n = *n;
        exchanged.clear();
        extents.clear();
        for column in 0..n {
            let size = |row: usize| entries[row * n + column].abs();
            let pivot = (column..n).max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(column);
            if !(size(pivot) > PIVOT && size(pivot).is_finite()) {
                return false;
            }
            exchanged.push(pivot);
            let (above, below) = entries.split_at_mut((column + 1) * n);
            let from = &mut above[column * n..];
            if pivot != column {
                from.swap_with_slice(&mut below[(pivot - column - 1) * n..][..n]);
            }
            let filled = |entry: &f64| *entry != 0.0;
            let begin = from.iter().position(filled).unwrap_or(column).min(column);
            let end = from.iter().rposition(filled).map_or(n, |last| last + 1);
            extents.push(begin..end);
            let (whole, from) = (from[column], &from[column + 1..end]);
            for to in below.chunks_exact_mut(n) {
                let part = to[column] / whole;
                to[column] = part;
                if part != 0.0 {
                    let to = &mut to[column + 1..end];
                    to.iter_mut().zip(from).for_each(|(to, from)| *to -= part * from);
                }
            }
        }
        true
    }

    /// Solves for a right side, in its place.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        for (row, &with) in self.exchanged.iter().enumerate() {
            x.swap(row, with);
        }
        let rows = || self.entries.chunks_exact(self.n.max(1)).zip(&self.extents).enumerate();
        for (row, (line, extent)) in rows() {
            let known = extent.start..row;
            x[row] -= dot(&line[known.clone()], &x[known]);
        }
        for (row, (line, extent)) in rows().rev() {
            let known = row + 1..extent.end;
            x[row] = (x[row] - dot(&line[known.clone()], &x[known])) / line[row];
        }
    }
}

/// The product of two lists, in four sums that do not wait for one another.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (of_a, of_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let last: f64 = of_a.remainder().iter().zip(of_b.remainder()).map(|(a, b)| a * b).sum();
    let mut sums = [0.0; 4];
    for (a, b) in of_a.zip(of_b) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + last
}

#[cfg(test)]
mod tests {
    use stationary_measure::SplitMix64;

    use super::*;

    /// A factor of lines, and a right side solved by it.
    fn solved(lines: &[Vec<f64>], right: &[f64]) -> Option<Vec<f64>> {
        let mut factor = DenseFactor::default();
        factor.clear(lines.len());
        for (row, line) in lines.iter().enumerate() {
            factor.line(row).copy_from_slice(line);
        }
        let mut x = right.to_vec();
        factor.factorize().then(|| {
            factor.solve(&mut x);
            x
        })
    }

    #[test]
    fn solves_matrices_with_bands_and_without_a_first_pivot() {
        let mut random = SplitMix64::new(20290903);
        for case in 0..200 {
            let n = 1 + case % 40;
            let band = 1 + case % 7;
            let mut lines: Vec<Vec<f64>> = (0..n)
                .map(|i: usize| {
                    let entry = |j: usize| if i.abs_diff(j) <= band { 1.0 } else { 0.0 };
                    (0..n).map(entry).collect()
                })
                .collect();
            lines.iter_mut().flatten().for_each(|entry| *entry *= random.symmetric());
            lines[0][0] = if n > 1 { 0.0 } else { 1.0 };
            let wanted: Vec<f64> = (0..n).map(|_| random.symmetric()).collect();
            let product = |line: &Vec<f64>| line.iter().zip(&wanted).map(|(a, x)| a * x).sum();
            let right: Vec<f64> = lines.iter().map(product).collect();
            let Some(x) = solved(&lines, &right) else { continue };
            for (line, right) in lines.iter().zip(&right) {
                let left: f64 = line.iter().zip(&x).map(|(a, x)| a * x).sum::<f64>() - right;
                let size: f64 = line.iter().zip(&x).map(|(a, x)| (a * x).abs()).sum::<f64>();
                assert!(left.abs() <= 1e-12 * (size + right.abs()), "{n} {band}: {left:e}");
            }
        }
    }

    #[test]
    fn a_singular_matrix_and_what_is_no_number_have_no_factor() {
        assert_eq!(solved(&[vec![1.0, 2.0], vec![2.0, 4.0]], &[1.0, 1.0]), None);
        assert_eq!(solved(&[vec![f64::NAN]], &[1.0]), None);
        assert_eq!(solved(&[], &[]), Some(vec![]));
    }
}
