//! The contacts that push, and the Cholesky factor of what couples them.
//!
//! ```text
//! A_PP = L L^T,   A = dg M^-1 dg^T,   P the contacts with lambda > 0
//! append j:   l = L^-1 A_Pj,  pivot^2 = A_jj - |l|^2
//! remove j:   drop the row, rotate the others back to a triangle
//! ```
//! A contact whose row depends on those in P (pivot zero to rounding) is not taken in; how it
//! depends is said instead, `dg_j = sum c_k dg_k`. So the factor exists however redundant the
//! contacts are. Source: Lawson and Hanson 1974, chapters 23 and 24, for the idea; Golub and Van
//! Loan 6.5.4 for the rotations.

use crate::Impact;

/// Contacts in the order in which they were taken in, and the factor of their coupling.
#[derive(Debug, Default)]
pub(crate) struct ActiveSet {
    members: Vec<usize>,
    /// Row i, of i + 1 numbers, after the rows before it.
    factor: Vec<f64>,
    /// The row that is taken in, or how it depends on the others.
    row: Vec<f64>,
}

/// A squared pivot relative to the diagonal below which a row depends on the others: the rounding
/// of a few hundred of them.
const DEPENDENT: f64 = 1e-13;

impl ActiveSet {
    pub(crate) fn members(&self) -> &[usize] {
        &self.members
    }

    /// Lets all go, and keeps their room.
    pub(crate) fn clear(&mut self) {
        self.members.clear();
        self.factor.clear();
    }

    /// Takes a contact in; or says by which coefficients its row depends on the members'.
    pub(crate) fn append(
        &mut self,
        impact: &Impact,
        contact: usize,
        scratch: &mut [f64],
    ) -> Result<(), &[f64]> {
        let ActiveSet { members, factor, row } = self;
        row.clear();
        impact.couple(contact, members, scratch, row);
        forward(factor, row);
        let diagonal = impact.compliance(contact);
        let pivot = diagonal - row.iter().map(|x| x * x).sum::<f64>();
        if pivot <= DEPENDENT * diagonal {
            backward(factor, row);
            return Err(row);
        }
        factor.extend_from_slice(row);
        factor.push(pivot.sqrt());
        members.push(contact);
        Ok(())
    }

    /// Lets the member at a place go.
    pub(crate) fn remove(&mut self, place: usize) {
        self.members.remove(place);
        let count = self.members.len();
        let factor = &mut self.factor;
        // Row k + 1 is to be row k, one longer than a triangle allows: rotate columns k and k + 1.
        for k in place..count {
            let (a, b) = (factor[start(k + 1) + k], factor[start(k + 1) + k + 1]);
            let r = a.hypot(b);
            let (c, s) = (a / r, b / r);
            for row in (k + 1..=count).map(start) {
                let (x, y) = (factor[row + k], factor[row + k + 1]);
                factor[row + k] = c * x + s * y;
                factor[row + k + 1] = c * y - s * x;
            }
        }
        for k in place..count {
            factor.copy_within(start(k + 1)..start(k + 1) + k + 1, start(k));
        }
        factor.truncate(start(count));
    }

    /// Solves `A_PP z = b` in place.
    pub(crate) fn solve(&self, b: &mut [f64]) {
        forward(&self.factor, b);
        backward(&self.factor, b);
    }
}

/// Where a row of a packed triangle starts.
fn start(row: usize) -> usize {
    row * (row + 1) / 2
}

fn backward(factor: &[f64], b: &mut [f64]) {
    for k in (0..b.len()).rev() {
        let row = &factor[start(k)..=start(k) + k];
        b[k] /= row[k];
        let x = b[k];
        for (b, l) in b[..k].iter_mut().zip(row) {
            *b -= l * x;
        }
    }
}

fn forward(factor: &[f64], b: &mut [f64]) {
    for k in 0..b.len() {
        let row = &factor[start(k)..=start(k) + k];
        let (done, rest) = b.split_at_mut(k);
        let dot: f64 = row.iter().zip(done.iter()).map(|(l, x)| l * x).sum();
        rest[0] = (rest[0] - dot) / row[k];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ContactRows, InverseMass};
    use stationary_calculus::{DiagonalMetric, Vector};
    use stationary_measure::SplitMix64;

    fn random_impact(contacts: usize, freedoms: usize) -> Impact {
        let mut random = SplitMix64::new(11);
        let masses = (0..freedoms).map(|_| 1.5 + random.symmetric()).collect::<Vec<_>>();
        let mass = InverseMass::of(&DiagonalMetric::new(masses).unwrap()).unwrap();
        let mut rows = ContactRows::new();
        for _ in 0..contacts {
            rows.push((0..freedoms).map(|f| (f, random.symmetric())));
        }
        Impact::new(rows, &mass, vec![0.0; contacts]).unwrap()
    }

    #[test]
    fn members_that_come_and_go_leave_the_factor_of_those_that_stay() {
        let impact = random_impact(8, 20);
        let (mut set, mut scratch) = (ActiveSet::default(), vec![0.0; 20]);
        for contact in 0..8 {
            set.append(&impact, contact, &mut scratch).unwrap();
        }
        for place in [3, 0, 4] {
            set.remove(place);
        }
        assert_eq!(set.members(), [1, 2, 4, 5, 7]);
        let b = [1.0, -2.0, 0.5, 3.0, 1.5];
        let mut z = b;
        set.solve(&mut z);
        let mut v = Vector(vec![0.0; 20]);
        for (&contact, &z) in set.members().iter().zip(&z) {
            impact.push(contact, z, v.view_mut());
        }
        for (&contact, b) in set.members().iter().zip(b) {
            assert!((impact.relative_velocity(contact, v.view()) - b).abs() < 1e-12);
        }
    }

    #[test]
    fn a_row_that_depends_on_the_others_is_not_taken_in_and_says_how() {
        let impact = random_impact(5, 3);
        let (mut set, mut scratch) = (ActiveSet::default(), vec![0.0; 3]);
        (0..3).for_each(|contact| set.append(&impact, contact, &mut scratch).unwrap());
        for contact in [3, 4] {
            let depends = set.append(&impact, contact, &mut scratch).unwrap_err().to_vec();
            let v = Vector([0.3, -0.7, 0.2]);
            let rate = |contact| impact.relative_velocity(contact, v.view());
            let sum: f64 = (0..3).map(|k| depends[k] * rate(k)).sum();
            assert!((sum - rate(contact)).abs() < 1e-12);
        }
        assert_eq!(set.members(), [0, 1, 2]);
    }
}
