//! The boundary-value problem: the motion between two given configurations, and what kind of
//! stationary point of the action it is.
//!
//! ```text
//! dS/dq_i = 0,  0 < i < K,    q_0 and q_K given              by Newton's method           (5.1, 5.4)
//! d2S = tridiagonal in N x N blocks:  A_i on the diagonal, B_i beside it
//! D_1 = A_1,   D_i+1 = A_i+1 - B_i^T D_i^-1 B_i              elimination, block by block
//! index = negative eigenvalues of d2S = sum of those of the D_i
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
        Ok(StationaryPath { path, momentum, index, iterations })
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
        let mut elimination = Elimination::default();
        for i in 1..=interior {
            let arriving = self.block(i - 1, (End::Last, End::Last));
            let leaving = self.block(i, (End::First, End::First));
            let beside = self.block(i, (End::First, End::Last));
            elimination.push(arriving + leaving, beside, i == interior)?;
        }
        Ok(elimination)
    }
}

impl<L: DiscreteLagrangian<N>, const N: usize> Equation for Problem<'_, L, N> {
    fn residual(&mut self, x: &[f64], f: &mut [f64]) {
        self.visit(x);
        // The path has as many points as were checked: there is a differential.
        if let Ok(differential) = self.action.differential(&self.path) {
            for (f, covector) in f.chunks_exact_mut(N).zip(differential) {
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

/// The eliminated blocks of a symmetric block-tridiagonal matrix: D_i by eigenvectors, and B_i.
#[derive(Default)]
struct Elimination {
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
    }

    /// `D_i^-1 f`.
    fn apply_inverse(&self, i: usize, f: &[f64]) -> DVector<f64> {
        let SymmetricEigen { eigenvectors, eigenvalues } = &self.pivots[i];
        let along = eigenvectors.tr_mul(&DVectorView::from_slice(f, f.len()));
        eigenvectors * along.component_div(eigenvalues)
    }
}
