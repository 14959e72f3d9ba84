//! The lowest modes of a system, with the proof that none was missed.
//!
//! ```text
//! H v_i = lambda_i M v_i,    v_i^T M v_j = 1 where i = j, else 0             (notes 14.2)
//! |lambda_i - true| <= |H v_i - lambda_i M v_i|, measured by M^-1
//! ```
//! `H` the Hessian at an equilibrium and `M` the mass (n x n, sparse), `lambda` in 1/s^2, angular
//! frequency `sqrt(lambda)` in rad/s. Found by block Lanczos on a shifted stiffness; an inertia
//! count above the last one then tells whether any was missed, and the search goes on until none
//! is.

use nalgebra::{DMatrix, SymmetricEigen};
use stationary_calculus::{
    Covector, Metric, Potential, SizeError, SparseCholesky, SparseError, SymmetricMatrix, Vector,
};

use crate::krylov::Krylov;
use crate::{Linearized, ModalError, RigidMotions, dense};

/// Eigenpairs of a stiffness and a mass, lowest first.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    n: usize,
    values: Vec<f64>,
    columns: Vec<f64>,
    residuals: Vec<f64>,
    complete_below: f64,
    factorizations: u64,
    solves: u64,
}

/// Shifts that are tried before the stiffness is given up.
const SHIFTS: i32 = 12;
/// The smallest of them, relative to the scale, and the factor to the next.
const SMALLEST: f64 = 1e-7;
const GROWTH: f64 = 8.0;
/// Searches for modes that the count says are missing.
const SEARCHES: usize = 4;
/// How far above the last mode the first count is, relative to it; and places tried above that.
const ABOVE: f64 = 1e-7;
const PLACES: i32 = 6;

impl<M: Metric, P: Potential> Linearized<'_, M, P> {
    /// The lowest `count` modes besides the rigid motions.
    ///
    /// # Errors
    /// Where there are not so many, or the search does not find them within its bound.
    pub fn lowest(&mut self, count: usize, rigid: &RigidMotions) -> Result<Modes, ModalError> {
        let there = self.dim() - rigid.len();
        if count == 0 || count > there {
            return Err(ModalError::Count { asked: count, there });
        }
        let (mut searched, mut solves) = (count, 0);
        let before = self.factorizations();
        for _ in 0..SEARCHES {
            self.shift()?;
            let (cholesky, mass) = self.factored();
            let mut krylov = Krylov::new(cholesky, mass, &rigid.columns);
            let basis = krylov.largest(searched)?;
            solves += krylov.solves();
            let mut modes = self.rayleigh_ritz(&basis)?;
            let there_below = self.certify(&mut modes, rigid)?;
            if there_below <= modes.len() {
                modes.truncate(count);
                modes.factorizations = self.factorizations() - before;
                modes.solves = solves;
                return Ok(modes);
            }
            searched = there_below.min(there);
        }
        Err(ModalError::NotConverged { converged: searched, asked: count, restarts: SEARCHES })
    }

    /// Factors `H + delta M` for the smallest tried delta at which it is positive definite.
    fn shift(&mut self) -> Result<(), ModalError> {
        let smallest = SMALLEST * self.scale();
        let mut refused = self.factor(0.0)?;
        for tried in 0..SHIFTS {
            if refused.is_ok() {
                return Ok(());
            }
            refused = self.factor(smallest * GROWTH.powi(tried))?;
        }
        let mass = self.mass().clone();
        SparseCholesky::analyse(&mass)?.factor(&mass).map_err(ModalError::Mass)?;
        refused.map_err(ModalError::Stiffness)
    }

    /// The best approximations to modes among the combinations of orthonormal vectors.
    fn rayleigh_ritz(&self, basis: &[f64]) -> Result<Modes, ModalError> {
        let n = self.dim();
        let k = basis.len() / n;
        let mut moved = vec![0.0; basis.len()];
        for (x, y) in basis.chunks_exact(n).zip(moved.chunks_exact_mut(n)) {
            self.stiffness().add_product(1.0, x, y)?;
        }
        let small = DMatrix::from_vec(k, k, dense::transpose_times(n, basis, &moved));
        let pairs = SymmetricEigen::new((&small + small.transpose()) * 0.5);
        let mut order: Vec<usize> = (0..k).collect();
        order.sort_by(|&i, &j| pairs.eigenvalues[i].total_cmp(&pairs.eigenvalues[j]));
        let weights = pairs.eigenvectors.select_columns(&order);
        let mut columns = vec![0.0; basis.len()];
        dense::add_product(n, &mut columns, 1.0, basis, weights.as_slice());
        columns.chunks_exact_mut(n).for_each(orient);
        let values = order.iter().map(|&i| pairs.eigenvalues[i]).collect();
        let mut modes = Modes {
            n,
            values,
            columns,
            residuals: vec![0.0; k],
            complete_below: f64::NAN,
            factorizations: 0,
            solves: 0,
        };
        for i in 0..k {
            modes.residuals[i] = self.residual(modes.values[i], modes.column(i))?;
        }
        Ok(modes)
    }

    /// The size of `H v - lambda M v`, measured by `M^-1`.
    fn residual(&self, lambda: f64, v: &[f64]) -> Result<f64, ModalError> {
        let mut r = Covector(vec![0.0; v.len()]);
        self.stiffness().add_product(1.0, v, &mut r.0)?;
        self.mass().add_product(-lambda, v, &mut r.0)?;
        let mut a = Vector(vec![0.0; v.len()]);
        self.metric().sharp(r.view(), a.view_mut());
        Ok(r.apply(&a).max(0.0).sqrt())
    }

    /// Counts what is below a little more than the last mode, rigid motions left out.
    fn certify(&mut self, modes: &mut Modes, rigid: &RigidMotions) -> Result<usize, ModalError> {
        let last = modes.values.last().copied().unwrap_or(0.0);
        let mut error = ModalError::Sparse(SparseError::Singular);
        for place in 0..PLACES {
            let above = ABOVE * 4.0_f64.powi(place) * last.abs().max(SMALLEST * self.scale());
            let mu = last + above;
            match self.count_below(mu) {
                Ok(count) => {
                    modes.complete_below = mu;
                    return Ok(count - if mu > 0.0 { rigid.len().min(count) } else { 0 });
                }
                Err(refused) => error = refused,
            }
        }
        Err(error)
    }
}

/// Makes the largest component positive, the first of those that are equal up to a millionth.
fn orient(v: &mut [f64]) {
    let largest = v.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let first = v.iter().find(|x| x.abs() >= (1.0 - 1e-6) * largest);
    if first.is_some_and(|x| *x < 0.0) {
        v.iter_mut().for_each(|x| *x = -*x);
    }
}

impl Modes {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// True where there is none.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The number of freedoms n.
    pub fn dim(&self) -> usize {
        self.n
    }

    /// The eigenvalues lambda, 1/s^2, ascending; rigid motions have exactly zero.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The angular frequencies `sqrt(lambda)`, rad/s; NaN where lambda is negative.
    pub fn frequencies(&self) -> impl Iterator<Item = f64> {
        self.values.iter().map(|lambda| lambda.sqrt())
    }

    /// The i-th mode, of length 1 in the mass; `None` where there are not so many.
    pub fn vector(&self, i: usize) -> Option<Vector<&[f64]>> {
        (i < self.len()).then(|| Vector(self.column(i)))
    }

    /// For each mode how far its lambda may be off, 1/s^2.
    pub fn residuals(&self) -> &[f64] {
        &self.residuals
    }

    /// For each mode how far its products with all of them in the mass are from one and zero.
    ///
    /// # Errors
    /// [`ModalError::Size`].
    pub fn orthogonality(&self, mass: &SymmetricMatrix) -> Result<Vec<f64>, ModalError> {
        SizeError::check("the mass matrix's size", self.n, mass.dim())?;
        let moved = dense::mass_times(mass, &self.columns);
        let products = dense::transpose_times(self.n.max(1), &self.columns, &moved);
        let off = |i: usize, j: usize| {
            let exact = if i == j { 1.0 } else { 0.0 };
            (products[i * self.len() + j] - exact).abs()
        };
        let of_mode = |i: usize| (0..self.len()).map(|j| off(i, j)).fold(0.0, f64::max);
        Ok((0..self.len()).map(of_mode).collect())
    }

    /// No mode with a lambda below this number is missing, rigid motions aside; NaN where that was
    /// not examined.
    pub fn complete_below(&self) -> f64 {
        self.complete_below
    }

    /// How many matrices were factored to find them.
    pub fn factorizations(&self) -> u64 {
        self.factorizations
    }

    /// How many right sides were solved for with the factors.
    pub fn solves(&self) -> u64 {
        self.solves
    }

    /// The same modes after the rigid motions, as modes of lambda zero.
    pub fn with_rigid(mut self, rigid: &RigidMotions) -> Result<Self, ModalError> {
        SizeError::check("the rigid motions' numbers", self.n * rigid.len(), rigid.columns.len())?;
        let first_elastic = self.values.partition_point(|&lambda| lambda < 0.0);
        let zeros = vec![0.0; rigid.len()];
        self.values.splice(first_elastic..first_elastic, zeros.iter().copied());
        self.residuals.splice(first_elastic..first_elastic, zeros);
        let place = first_elastic * self.n;
        self.columns.splice(place..place, rigid.columns.iter().copied());
        Ok(self)
    }

    /// The lowest `count` of them.
    pub fn truncate(&mut self, count: usize) {
        self.values.truncate(count);
        self.residuals.truncate(count);
        self.columns.truncate(count * self.n);
    }

    /// All modes, one after the other.
    pub(crate) fn columns(&self) -> &[f64] {
        &self.columns
    }

    pub(crate) fn column(&self, i: usize) -> &[f64] {
        &self.columns[i * self.n..(i + 1) * self.n]
    }
}
