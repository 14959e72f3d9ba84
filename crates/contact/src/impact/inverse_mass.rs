//! Inverse mass, block by block: what an impulse does to the freedoms that it touches.
//!
//! ```text
//! M = diag(B_1, B_2, ...),     M^-1 dg^T = the blocks that dg touches, solved             (11.4.2)
//! ```
//! The blocks are found by asking the metric for its matrix. A held freedom has infinite mass:
//! impulses leave its velocity, and whatever drives it does the work. Source: notes 10.2, 11.4.2.

use nalgebra::{Cholesky, DMatrix};
use stationary_calculus::{FIXED, Metric, Sink};

use crate::ContactError;

/// The inverse of a block-diagonal mass matrix.
#[derive(Clone, Debug)]
pub struct InverseMass {
    /// The block of each freedom and its place there.
    place: Vec<(usize, usize)>,
    blocks: Vec<Block>,
    held: Vec<bool>,
}

#[derive(Clone, Debug)]
struct Block {
    freedoms: Vec<usize>,
    inverse: DMatrix<f64>,
}

/// Blocks as they come from the metric.
#[derive(Default)]
struct Collected(Vec<(Vec<usize>, Vec<f64>)>);

impl Sink for Collected {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        self.0.push((freedoms.to_vec(), block.to_vec()));
    }
}

impl InverseMass {
    /// The inverse of a metric.
    ///
    /// # Errors
    /// [`ContactError::Mass`] where a block of the metric is not positive definite.
    pub fn of(metric: &impl Metric) -> Result<Self, ContactError> {
        let n = metric.dim();
        let mut collected = Collected::default();
        metric.add_matrix(&mut collected);
        let mut groups = Groups::new(n);
        for (freedoms, _) in &collected.0 {
            let mut free = freedoms.iter().copied().filter(|&f| f != FIXED);
            if let Some(first) = free.next() {
                free.for_each(|other| groups.join(first, other));
            }
        }
        let (place, members) = groups.collect();
        let mut matrices: Vec<_> =
            members.iter().map(|m| DMatrix::<f64>::zeros(m.len(), m.len())).collect();
        for (freedoms, block) in &collected.0 {
            let k = freedoms.len();
            for (entry, value) in block.iter().enumerate() {
                let (row, column) = (freedoms[entry % k], freedoms[entry / k]);
                if row != FIXED && column != FIXED {
                    let (group, i) = place[row];
                    matrices[group][(i, place[column].1)] += value;
                }
            }
        }
        let mut blocks = Vec::with_capacity(members.len());
        for (freedoms, matrix) in members.into_iter().zip(matrices) {
            let error = ContactError::Mass { freedom: freedoms[0] };
            blocks.push(Block { inverse: inverse(matrix).ok_or(error)?, freedoms });
        }
        Ok(InverseMass { place, blocks, held: vec![false; n] })
    }

    /// The same mass with these freedoms held: no impulse moves them.
    pub fn holding(mut self, freedoms: impl IntoIterator<Item = usize>) -> Self {
        for freedom in freedoms {
            if let Some(held) = self.held.get_mut(freedom) {
                *held = true;
            }
        }
        self
    }

    /// The number of freedoms.
    pub fn dim(&self) -> usize {
        self.held.len()
    }

    /// Whether a freedom is held.
    pub fn is_held(&self, freedom: usize) -> bool {
        self.held[freedom]
    }

    /// Writes one over the mass of each freedom, zero of those that are held; says no where freedoms are coupled.
    pub(crate) fn write_diagonal(&self, inverse: &mut Vec<f64>) -> bool {
        inverse.clear();
        for (&(block, _), held) in self.place.iter().zip(&self.held) {
            let [own] = self.blocks[block].inverse.as_slice() else { return false };
            inverse.push(if *held { 0.0 } else { *own });
        }
        true
    }

    /// Calls `add` with the entries of `M^-1 dg^T`, each freedom once for every entry of the row
    /// that reaches it.
    pub(crate) fn lift(
        &self,
        row: impl Iterator<Item = (usize, f64)>,
        mut add: impl FnMut(usize, f64),
    ) {
        for (freedom, value) in row.filter(|&(f, value)| !self.held[f] && value != 0.0) {
            let (block, column) = self.place[freedom];
            let block = &self.blocks[block];
            if let [inverse] = block.inverse.as_slice() {
                add(freedom, inverse * value);
                continue;
            }
            for (i, &reached) in block.freedoms.iter().enumerate() {
                if !self.held[reached] {
                    add(reached, block.inverse[(i, column)] * value);
                }
            }
        }
    }
}

/// The inverse of a positive definite block; of a single mass without the rounding of a square
/// root.
fn inverse(block: DMatrix<f64>) -> Option<DMatrix<f64>> {
    match block.as_slice() {
        &[mass] => (mass > 0.0).then(|| DMatrix::from_element(1, 1, mass.recip())),
        _ => Some(Cholesky::new(block)?.inverse()),
    }
}

/// Sets of things that belong together, joined pair by pair.
#[derive(Debug, Default)]
pub(crate) struct Groups {
    parent: Vec<usize>,
}

impl Groups {
    pub(crate) fn new(n: usize) -> Self {
        Groups { parent: (0..n).collect() }
    }

    /// Parts everything again, in the same memory.
    pub(crate) fn reset(&mut self, n: usize) {
        self.parent.clear();
        self.parent.extend(0..n);
    }

    /// The representative of a thing's group, the smallest of its members.
    pub(crate) fn find(&mut self, mut thing: usize) -> usize {
        while self.parent[thing] != thing {
            self.parent[thing] = self.parent[self.parent[thing]];
            thing = self.parent[thing];
        }
        thing
    }

    pub(crate) fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b)] = a.min(b);
    }

    /// Where each thing is (group, place), and the members of each group.
    pub(crate) fn collect(mut self) -> (Vec<(usize, usize)>, Vec<Vec<usize>>) {
        let mut members: Vec<Vec<usize>> = Vec::new();
        let mut place = vec![(0, 0); self.parent.len()];
        for thing in 0..self.parent.len() {
            let root = self.find(thing);
            let group = if root == thing {
                members.push(Vec::new());
                members.len() - 1
            } else {
                place[root].0
            };
            place[thing] = (group, members[group].len());
            members[group].push(thing);
        }
        (place, members)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;
    use stationary_calculus::{DenseMetric, DiagonalMetric};
    use stationary_measure::SplitMix64;

    #[test]
    fn a_lifted_row_times_the_mass_is_the_row() {
        let n = 5;
        let mut random = SplitMix64::new(7);
        let root = DMatrix::from_fn(n, n, |_, _| random.symmetric());
        let matrix = &root * root.transpose() + DMatrix::identity(n, n);
        let mass = InverseMass::of(&DenseMetric::new(matrix.clone()).unwrap()).unwrap();
        let mut lifted = DVector::zeros(n);
        mass.lift([(1, 2.0), (4, -0.5)].into_iter(), |f, x| lifted[f] += x);
        let back = matrix * lifted;
        let row = DVector::from_vec(vec![0.0, 2.0, 0.0, 0.0, -0.5]);
        assert!((back - row).amax() < 1e-14);
    }

    #[test]
    fn a_held_freedom_does_not_move() {
        let metric = DiagonalMetric::new([2.0, 4.0]).unwrap();
        let mass = InverseMass::of(&metric).unwrap().holding([1]);
        let mut lifted = [0.0; 2];
        mass.lift([(0, 1.0), (1, 1.0)].into_iter(), |f, x| lifted[f] += x);
        assert_eq!(lifted, [0.5, 0.0]);
        assert!(mass.is_held(1) && !mass.is_held(0));
    }

    #[test]
    fn a_freedom_without_mass_has_no_inverse() {
        let of = |mass: f64| inverse(DMatrix::from_element(1, 1, mass));
        for bad in [0.0, -0.0, -1.0, f64::NAN] {
            assert!(of(bad).is_none(), "{bad}");
        }
        assert_eq!(of(4.0), Some(DMatrix::from_element(1, 1, 0.25)));
        assert!(inverse(DMatrix::zeros(2, 2)).is_none());
    }
}
