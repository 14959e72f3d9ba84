//! What answers to an impulse: how the velocities of a thing change by an impulse along a row.
//!
//! ```text
//! dv = A^-1 J_i^T          kg^-1 times the row's own units, for an impulse of 1 N s
//! ```
//! `A` symmetric and positive definite: the mass of bodies and particles ([`InverseMass`], block by
//! block), or what an implicit step of a material makes of it, such as `M + h^2 K`, whose factor is
//! handed in by whoever knows the material. Contact knows nothing of it. Of things side by side, such as
//! rigid bodies and a sheet, the freedoms follow one another ([`SideBySide`]).

use crate::InverseMass;

/// Answers to impulses.
pub trait Response {
    /// The number of freedoms.
    fn freedoms(&self) -> usize;

    /// Appends the change of velocity by a unit impulse along a row, freedom by freedom; a freedom may
    /// come more than once. The row's freedoms are below [`Response::freedoms`].
    fn respond(&mut self, row: &[(usize, f64)], change: &mut Vec<(usize, f64)>);

    /// Writes one over the mass of each freedom, zero of what no impulse moves; says no where freedoms are
    /// coupled, or it is not known whether they are.
    fn inverse_masses(&self, _inverse: &mut Vec<f64>) -> bool {
        false
    }
}

impl Response for InverseMass {
    fn freedoms(&self) -> usize {
        self.dim()
    }

    fn respond(&mut self, row: &[(usize, f64)], change: &mut Vec<(usize, f64)>) {
        (&*self).respond(row, change);
    }

    fn inverse_masses(&self, inverse: &mut Vec<f64>) -> bool {
        self.write_diagonal(inverse)
    }
}

impl Response for &InverseMass {
    fn freedoms(&self) -> usize {
        self.dim()
    }

    fn respond(&mut self, row: &[(usize, f64)], change: &mut Vec<(usize, f64)>) {
        self.lift(row.iter().copied(), |freedom, value| change.push((freedom, value)));
    }

    fn inverse_masses(&self, inverse: &mut Vec<f64>) -> bool {
        self.write_diagonal(inverse)
    }
}

/// A factor of a symmetric matrix that solves `A x = b` in the place of `b` (n numbers), and the memory
/// for it.
#[derive(Clone, Debug)]
pub struct FactorResponse<S> {
    solve: S,
    load: Vec<f64>,
}

impl<S: FnMut(&mut [f64])> FactorResponse<S> {
    /// Of a matrix of so many freedoms, by what solves with it.
    pub fn new(freedoms: usize, solve: S) -> Self {
        FactorResponse { solve, load: vec![0.0; freedoms] }
    }
}

impl<S: FnMut(&mut [f64])> Response for FactorResponse<S> {
    fn freedoms(&self) -> usize {
        self.load.len()
    }

    fn respond(&mut self, row: &[(usize, f64)], change: &mut Vec<(usize, f64)>) {
        self.load.fill(0.0);
        row.iter().for_each(|&(freedom, value)| self.load[freedom] += value);
        (self.solve)(&mut self.load);
        change.extend(self.load.iter().copied().enumerate().filter(|(_, value)| *value != 0.0));
    }
}

/// Two things, the freedoms of the second behind those of the first.
#[derive(Clone, Debug)]
pub struct SideBySide<A, B> {
    /// The first.
    pub first: A,
    /// The second.
    pub second: B,
}

impl<A: Response, B: Response> Response for SideBySide<A, B> {
    fn freedoms(&self) -> usize {
        self.first.freedoms() + self.second.freedoms()
    }

    fn respond(&mut self, row: &[(usize, f64)], change: &mut Vec<(usize, f64)>) {
        let border = self.first.freedoms();
        let (first, mut second): (Vec<_>, Vec<_>) = row.iter().partition(|entry| entry.0 < border);
        if !first.is_empty() {
            self.first.respond(&first, change);
        }
        if !second.is_empty() {
            second.iter_mut().for_each(|(freedom, _)| *freedom -= border);
            let begins = change.len();
            self.second.respond(&second, change);
            change[begins..].iter_mut().for_each(|(freedom, _)| *freedom += border);
        }
    }

    fn inverse_masses(&self, inverse: &mut Vec<f64>) -> bool {
        let mut second = Vec::new();
        let diagonal =
            self.first.inverse_masses(inverse) && self.second.inverse_masses(&mut second);
        inverse.append(&mut second);
        diagonal
    }
}
