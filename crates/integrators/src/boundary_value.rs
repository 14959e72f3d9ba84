//! The boundary-value problem: the motion between two given configurations, and what kind of
//! stationary point of the action it is.
//!
//! ```text
//! dS/dq_i = 0,  0 < i < K,    q_0 and q_K given              by Newton's method           (5.1, 5.4)
//! d2S = tridiagonal in N x N blocks:  A_i on the diagonal, B_i beside it
//! D_1 = A_1,   D_i+1 = A_i+1 - B_i^T D_i^-1 B_i              elimination, block by block
//! index = negative eigenvalues of d2S = sum of those of the D_i
//! S d2S S,   S_k = 1/sqrt(largest entry of row k)            before it is eliminated: the same index
//! ```
//! `A_i = h_i-1 d22 L_d + h_i d11 L_d`, `B_i = h_i d12 L_d`. The index is Morse's: the number of
//! independent ways to lower the action. It is zero, and the motion a minimum, over short times;
//! every time that the motion passes a point conjugate to its start adds one, and the motion is a
//! saddle: an oscillator's after half a period. "Least action" is a misnomer.
//!
//! Solutions need not exist or be unique: Newton's method finds one that is stationary near the
//! path it is given, or says why not. At a conjugate point itself d2S is singular: an error.
//! Source: notes 5.1 to 5.4 (5.1's example of a spring is wrong: errata 5.1); Milnor (1963).

use nalgebra::{DMatrix, DVector, DVectorView, DVectorViewMut, Dyn, SymmetricEigen};
use stationary_calculus::{Covector, Equation, Newton, Unsolvable, first_non_finite};

use crate::discrete_lagrangian::{End, add_second_differential};
use crate::integrator::newton_memory;
use crate::{Action, ActionError, DiscreteLagrangian};

/// A path on which the action is stationary.
#[derive(Clone, Debug, PartialEq)]
pub struct StationaryPath<const N: usize> {
    /// The configurations, both ends included.
    pub path: Vec<[f64; N]>,
    /// The momentum with which it starts.
    pub momentum: Covector<[f64; N]>,
    /// Morse's index: negative eigenvalues of the action's second differential.
    pub index: usize,
    /// Iterations that Newton's method took.
    pub iterations: u32,
    /// What is left of the differential of the action: the largest component of a jump of momentum, relative to
    /// the largest momentum of that freedom along the path.
    pub residual: f64,
}

/// What kind of stationary point a path is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stationary {
    /// Every small change raises the action.
    Minimum,
    /// Some raise it, and some lower it.
    Saddle,
    /// Every small change lowers it: only where steps are as long as the motion's own time.
    Maximum,
}

impl<const N: usize> StationaryPath<N> {
    /// What kind of stationary point it is.
    pub fn kind(&self) -> Stationary {
        let freedoms = N * (self.path.len() - 2);
        match self.index {
            0 => Stationary::Minimum,
            index if index == freedoms => Stationary::Maximum,
            _ => Stationary::Saddle,
        }
    }
}

impl<L> Action<L> {
    /// The path between the ends of `guess` on which the action is stationary, looked for from
    /// there.
    ///
    /// # Errors
    /// Where the guess has another number of points or a number that is not finite, where Newton's
    /// method finds no such path, and where the ends are conjugate.
    pub fn stationary_path<const N: usize>(
        &self,
        guess: Vec<[f64; N]>,
    ) -> Result<StationaryPath<N>, ActionError>
    where
        L: DiscreteLagrangian<N>,
    {
        self.check(&guess)?;
        if let Some(number) = first_non_finite(guess.as_flattened()) {
            return Err(ActionError::NonFinite { point: number / N, freedom: number % N });
        }
        let interior = guess.len() - 2;
        let newton = Newton::default();
        let mut memory = newton_memory::<Vec<f64>>(N * interior, newton)?;
        let mut unknowns = guess[1..=interior].as_flattened().to_vec();
        let mut problem = Problem { action: self, path: guess };
        let iterations = newton.solve(&mut problem, &mut unknowns, &mut memory)?.iterations;
        let index = problem.eliminate(&unknowns).map_err(ActionError::Conjugate)?.index();
        let path = problem.path;
        let momentum = self.lagrangian.momentum_before(path[0], path[1], self.steps[0]);
        let residual = self.largest_jump(&path);
        Ok(StationaryPath { path, momentum, index, iterations, residual })
    }

    /// The largest jump of momentum relative to the largest momentum of its freedom.
    fn largest_jump<const N: usize>(&self, path: &[[f64; N]]) -> f64
    where
        L: DiscreteLagrangian<N>,
    {
        let (mut jumps, mut momenta) = ([0.0_f64; N], [0.0_f64; N]);
        for (points, steps) in path.windows(3).zip(self.steps.windows(2)) {
            let arriving = self.lagrangian.momentum_after(points[0], points[1], steps[0]);
            let leaving = self.lagrangian.momentum_before(points[1], points[2], steps[1]);
            for (k, (a, b)) in arriving.0.into_iter().zip(leaving.0).enumerate() {
                jumps[k] = jumps[k].max((a - b).abs());
                momenta[k] = momenta[k].max(a.abs()).max(b.abs());
            }
        }
        let parts = jumps.into_iter().zip(momenta).filter(|(jump, _)| *jump > 0.0);
        parts.fold(0.0, |largest: f64, (jump, momentum)| largest.max(jump / momentum))
    }
}

/// `dS = 0` in the interior points.
struct Problem<'a, L, const N: usize> {
    action: &'a Action<L>,
    path: Vec<[f64; N]>,
}

impl<L: DiscreteLagrangian<N>, const N: usize> Problem<'_, L, N> {
    fn visit(&mut self, unknowns: &[f64]) {
        let interior = self.path.len() - 2;
        self.path[1..=interior].as_flattened_mut().copy_from_slice(unknowns);
    }

    /// h times a second differential of L_d over the step i, as a block.
    fn block(&self, i: usize, ends: (End, End)) -> DMatrix<f64> {
        let mut block = DMatrix::zeros(N, N);
        let Action { lagrangian, steps } = self.action;
        let between = [self.path[i], self.path[i + 1]];
        add_second_differential(lagrangian, between, steps[i], ends, block.as_mut_slice());
        block
    }

    fn eliminate(&mut self, unknowns: &[f64]) -> Result<Elimination, Unsolvable> {
        self.visit(unknowns);
        let interior = self.path.len() - 2;
        let blocks = |i: usize| {
            let arriving = self.block(i - 1, (End::Last, End::Last));
            let leaving = self.block(i, (End::First, End::First));
            (arriving + leaving, self.block(i, (End::First, End::Last)))
        };
        let blocks: Vec<_> = (1..=interior).map(blocks).collect();
        let scales = scales(&blocks);
        let mut elimination = Elimination::default();
        for (i, (mut pivot, mut beside)) in blocks.into_iter().enumerate() {
            let next = scales.get(i + 1).unwrap_or(&scales[i]);
            scale(&mut pivot, &scales[i], &scales[i]);
            scale(&mut beside, &scales[i], next);
            elimination.push(pivot, beside, i + 1 == interior)?;
        }
        elimination.scales = scales.concat();
        Ok(elimination)
    }
}

impl<L: DiscreteLagrangian<N>, const N: usize> Equation for Problem<'_, L, N> {
    fn residual(&mut self, x: &[f64], f: &mut [f64]) {
        self.visit(x);
        // The path has as many points as were checked: there is a differential.
        if let Ok(differential) = self.action.differential(&self.path) {
            for (f, covector) in f.chunks_exact_mut(N.max(1)).zip(differential) {
                f.copy_from_slice(covector.components());
            }
        }
    }

    fn solve(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), Unsolvable> {
        self.eliminate(x)?.solve(f);
        Ok(())
    }

    fn norm(&mut self, f: &[f64]) -> f64 {
        f.iter().map(|f| f * f).sum::<f64>().sqrt()
    }

    fn energy(&mut self, _: &[f64]) -> Option<f64> {
        None
    }
}

/// Powers of two, one for each row of the blocks A_i and B_i, that bring its largest entry near to 1 if
/// rows and columns are multiplied by them: unlike masses are no small pivots.
fn scales(blocks: &[(DMatrix<f64>, DMatrix<f64>)]) -> Vec<Vec<f64>> {
    let largest = |entries: &mut dyn Iterator<Item = &f64>| {
        entries.fold(0.0, |largest: f64, entry| largest.max(entry.abs()))
    };
    let of_row = |i: usize, k: usize| {
        let (pivot, beside) = &blocks[i];
        let mut size = largest(&mut pivot.row(k).iter());
        if i + 1 < blocks.len() {
            size = size.max(largest(&mut beside.row(k).iter()));
        }
        if i > 0 {
            size = size.max(largest(&mut blocks[i - 1].1.column(k).iter()));
        }
        let known = size > 0.0 && size.is_finite();
        if known { 2.0_f64.powi(-(0.5 * size.log2()).round() as i32) } else { 1.0 }
    };
    let of_block = |i: usize| (0..blocks[i].0.nrows()).map(|k| of_row(i, k)).collect();
    (0..blocks.len()).map(of_block).collect()
}

/// Multiplies each row and each column of a block by its scale.
fn scale(block: &mut DMatrix<f64>, rows: &[f64], columns: &[f64]) {
    for (mut column, c) in block.column_iter_mut().zip(columns) {
        for (entry, r) in column.iter_mut().zip(rows) {
            *entry *= r * c;
        }
    }
}

/// The eliminated blocks of a symmetric block-tridiagonal matrix with scaled rows and columns: D_i by
/// eigenvectors, and B_i.
#[derive(Default)]
struct Elimination {
    scales: Vec<f64>,
    pivots: Vec<SymmetricEigen<f64, Dyn>>,
    beside: Vec<DMatrix<f64>>,
}

/// An eigenvalue of a pivot below this part of its matrix is lifted to it: what a conjugate point
/// within the path costs in digits, Newton's next step makes good.
const SMALL: f64 = 1e-8;
/// An eigenvalue of the last pivot below this part is zero: the whole matrix is singular.
const ZERO: f64 = 1e-12;

impl Elimination {
    fn push(
        &mut self,
        mut pivot: DMatrix<f64>,
        beside: DMatrix<f64>,
        last: bool,
    ) -> Result<(), Unsolvable> {
        let scale = pivot.amax();
        if let (Some(before), Some(b)) = (self.pivots.last(), self.beside.last()) {
            let mut eliminated = before.eigenvectors.tr_mul(b);
            let signed = eliminated.clone();
            for (mut row, lambda) in eliminated.row_iter_mut().zip(before.eigenvalues.iter()) {
                row /= *lambda;
            }
            pivot -= signed.tr_mul(&eliminated);
        }
        if first_non_finite(pivot.as_slice()).is_some() {
            return Err(Unsolvable::NonFinite);
        }
        let n = pivot.nrows();
        let symmetric = (&pivot + pivot.transpose()) * 0.5;
        let mut eigen = SymmetricEigen::try_new(symmetric, f64::EPSILON, 100 * n)
            .ok_or(Unsolvable::NonFinite)?;
        if last && eigen.eigenvalues.iter().any(|lambda| lambda.abs() <= ZERO * scale) {
            return Err(Unsolvable::Singular);
        }
        let least = if last { 0.0 } else { SMALL * scale };
        eigen.eigenvalues.apply(|lambda| *lambda = lambda.abs().max(least).copysign(*lambda));
        self.pivots.push(eigen);
        self.beside.push(beside);
        Ok(())
    }

    fn index(&self) -> usize {
        let eigenvalues = self.pivots.iter().flat_map(|pivot| pivot.eigenvalues.iter());
        eigenvalues.filter(|lambda| **lambda < 0.0).count()
    }

    /// Replaces the right-hand side by the solution: forward to the last block, and back.
    fn solve(&self, f: &mut [f64]) {
        let Some(n) = self.beside.first().map(|block| block.nrows()) else { return };
        f.iter_mut().zip(&self.scales).for_each(|(f, scale)| *f *= scale);
        let last = self.pivots.len() - 1;
        for i in 0..last {
            let (done, rest) = f.split_at_mut(n * (i + 1));
            let solved = self.apply_inverse(i, &done[n * i..]);
            let mut next = DVectorViewMut::from_slice(&mut rest[..n], n);
            next.gemv_tr(-1.0, &self.beside[i], &solved, 1.0);
        }
        for i in (0..=last).rev() {
            let (head, rest) = f.split_at_mut(n * (i + 1));
            if i < last {
                let mut here = DVectorViewMut::from_slice(&mut head[n * i..], n);
                let next = DVectorView::from_slice(&rest[..n], n);
                here.gemv(-1.0, &self.beside[i], &next, 1.0);
            }
            let solved = self.apply_inverse(i, &head[n * i..]);
            head[n * i..].copy_from_slice(solved.as_slice());
        }
        f.iter_mut().zip(&self.scales).for_each(|(f, scale)| *f *= scale);
    }

    /// `D_i^-1 f`.
    fn apply_inverse(&self, i: usize, f: &[f64]) -> DVector<f64> {
        let SymmetricEigen { eigenvectors, eigenvalues } = &self.pivots[i];
        let along = eigenvectors.tr_mul(&DVectorView::from_slice(f, f.len()));
        eigenvectors * along.component_div(eigenvalues)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mechanical, Quadrature, Sampled};
    use stationary_calculus::{Energy, Number};

    struct Nothing;

    impl Energy<2> for Nothing {
        fn energy<R: Number>(&self, [x, y]: [R; 2]) -> R {
            x * 0.0 + y * 0.0
        }
    }

    #[test]
    fn free_particles_of_unlike_masses_move_on_straight_lines() {
        for heavy in [1.0, 1e8, 1e12, 1e16, 1e-12] {
            let lagrangian = Mechanical::new([1.0, heavy], Nothing).unwrap();
            let sampled = Sampled { lagrangian, quadrature: Quadrature::Ends };
            let action = Action::new(sampled, vec![0.1; 10]).unwrap();
            let mut guess = vec![[0.3, -0.2]; 11];
            (guess[0], guess[10]) = ([0.0, 1.0], [1.0, 3.0]);
            let found = action.stationary_path(guess).unwrap();
            for (i, [x, y]) in found.path.iter().enumerate() {
                let part = 0.1 * i as f64;
                let off = (x - part).abs().max((y - 1.0 - 2.0 * part).abs());
                assert!(off < 1e-13, "{heavy}: {off} at point {i}");
            }
            assert_eq!(found.kind(), Stationary::Minimum);
            assert!(found.residual < 1e-13, "{heavy}: {}", found.residual);
        }
    }
}
