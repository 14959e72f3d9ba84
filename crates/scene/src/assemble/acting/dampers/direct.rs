//! Dampers that share what they hold back, by a factorization: where masses are far apart, or steps go backward.
//!
//! ```text
//! a + N J^T s w = 0,    d s J a - w = -d s r       a = N J^T l  the change of velocities,   l = -s w,   d = sign of h
//! ```
//! Of a light mass between heavy ones impulses cancel, so that its velocity is an unknown of its own. Rows are scaled
//! to one; two refinements make the error that of what is read.

use nalgebra::{DMatrix, DVector};

use super::Held;

/// How often what is left of the equations is solved for.
const REFINEMENTS: usize = 2;

/// The freedoms that a group of dampers holds back, each once.
pub(super) fn freedoms(all: &[Held], group: &[usize]) -> Vec<usize> {
    let entries = group.iter().flat_map(|&k| &all[k].now.entries);
    let mut freedoms: Vec<usize> = entries.map(|&(freedom, _)| freedom).collect();
    freedoms.sort_unstable();
    freedoms.dedup();
    freedoms
}

/// The impulses of a group, and what is to be added to what they are together on a freedom; whether there are any.
pub(super) fn solve(
    all: &mut [Held],
    (group, freedoms): (&[usize], &[usize]),
    inverse: &[f64],
    direction: f64,
) -> bool {
    let moved = freedoms.len();
    let size = moved + group.len();
    let place = |freedom| freedoms.binary_search(&freedom).ok();
    let (mut matrix, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
    for k in 0..moved {
        matrix[(k, k)] = 1.0;
    }
    for (row, held) in (moved..).zip(group.iter().map(|&k| &all[k])) {
        matrix[(row, row)] = -1.0;
        right[row] = -direction * held.root * held.whole;
        for &(freedom, part) in &held.now.entries {
            let Some(column) = place(freedom) else { continue };
            matrix[(column, row)] += inverse[freedom] * part * held.root;
            matrix[(row, column)] += direction * held.root * part;
        }
    }
    let scales: Vec<f64> = matrix.row_iter().map(|row| row.amax()).collect();
    let divide =
        |v: &mut DVector<f64>| v.iter_mut().zip(&scales).for_each(|(x, scale)| *x /= scale);
    let mut scaled = matrix.clone();
    scaled.column_iter_mut().for_each(|mut column| {
        column.iter_mut().zip(&scales).for_each(|(x, scale)| *x /= scale);
    });
    let factored = scaled.lu();
    let mut found: DVector<f64> = DVector::zeros(size);
    for _ in 0..=REFINEMENTS {
        let mut left = &right - &matrix * &found;
        divide(&mut left);
        if !factored.solve_mut(&mut left) {
            return false;
        }
        found += left;
    }
    if !found.iter().all(|x| x.is_finite()) {
        return false;
    }
    for (row, &k) in (moved..).zip(group) {
        all[k].impulse = -all[k].root * found[row];
    }
    let mut sums = vec![0.0; moved];
    for (freedom, impulse) in group.iter().flat_map(|&k| all[k].gives()) {
        place(freedom).into_iter().for_each(|k| sums[k] += impulse);
    }
    if let Some(&last) = group.last() {
        let each = freedoms
            .iter()
            .zip(&found)
            .zip(sums)
            .filter(|((freedom, _), _)| inverse[**freedom] > 0.0);
        all[last].beside = each.map(|((&f, change), sum)| (f, change / inverse[f] - sum)).collect();
    }
    true
}
