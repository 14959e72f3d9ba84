//! The lowest modes of a system, with the proof that none was missed.
//!
//! ```text
//! H v_i = lambda_i M v_i,    v_i^T M v_j = 1 where i = j, else 0             (notes 14.2)
//! |lambda_i - true| <= |H v_i - lambda_i M v_i|, measured by M^-1
//! ```
//! `H` the Hessian at an equilibrium and `M` the mass (n x n, sparse), `lambda` in 1/s^2, angular
//! frequency `sqrt(lambda)` in rad/s. Found by block Lanczos on a shifted stiffness, or whole where n
//! is small; an inertia count above the last one then tells whether any was missed, and the search
//! goes on until none is.

use nalgebra::{DMatrix, SymmetricEigen};
use stationary_calculus::{
    Covector, Metric, Potential, SizeError, SparseCholesky, SparseError, SymmetricMatrix, Vector,
};

use crate::krylov::Krylov;
use crate::{Linearized, ModalError, RigidMotions, dense, small};

/// What a search found.
pub(crate) struct Found {
    /// Vectors, orthonormal in the mass, that span the modes.
    pub(crate) vectors: Vec<f64>,
    /// About the next lambda, or above it; `None` where there is none.
    pub(crate) next: Option<f64>,
    /// How many right sides were solved for.
    pub(crate) solves: u64,
}

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

/// Systems of so few freedoms are solved whole, by dense matrices.
const SMALL: usize = 48;
/// Where rigid motions are put while others are searched for there, relative to the scale.
const ABOVE_ALL: f64 = 4.0;
/// Shifts that are tried before the stiffness is given up.
const SHIFTS: i32 = 12;
/// The smallest of them, relative to the scale, and the factor to the next.
const SMALLEST: f64 = 1e-7;
const GROWTH: f64 = 8.0;
/// Searches for modes that the count says are missing.
const SEARCHES: usize = 4;
/// How far above the last mode the first count is: this part of the way to the next one, but not
/// less than this relative to the last; and places tried above that.
const PART_OF_GAP: f64 = 0.25;
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
            let found = self.search(searched, rigid)?;
            solves += found.solves;
            let mut modes = self.rayleigh_ritz(&found.vectors)?;
            let there_below = self.certify(&mut modes, found.next, rigid)?;
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

    /// Vectors that span the lowest modes.
    fn search(&mut self, count: usize, rigid: &RigidMotions) -> Result<Found, ModalError> {
        if self.dim() <= SMALL {
            self.check_mass()?;
            let raised = ABOVE_ALL * self.scale();
            return small::lowest(self.stiffness(), self.mass(), rigid, raised, count);
        }
        let delta = self.shift()?;
        let (cholesky, mass) = self.factored();
        Krylov::new(cholesky, mass, delta, &rigid.columns).lowest(count)
    }

    /// Factors the mass alone.
    fn check_mass(&self) -> Result<(), ModalError> {
        SparseCholesky::analyse(self.mass())?.factor(self.mass()).map_err(ModalError::Mass)
    }

    /// Factors `H + delta M` for the smallest tried delta at which it is positive definite.
    fn shift(&mut self) -> Result<f64, ModalError> {
        let smallest = SMALLEST * self.scale();
        let mut delta = 0.0;
        let mut refused = self.factor(delta)?;
        for tried in 0..SHIFTS {
            if refused.is_ok() {
                return Ok(delta);
            }
            delta = smallest * GROWTH.powi(tried);
            refused = self.factor(delta)?;
        }
        self.check_mass()?;
        refused.map_err(ModalError::Stiffness).map(|()| delta)
    }

    /// The best approximations to modes among the combinations of orthonormal vectors.
    fn rayleigh_ritz(&self, basis: &[f64]) -> Result<Modes, ModalError> {
        let n = self.dim();
        let k = basis.len() / n;
        let moved = dense::times(self.stiffness(), basis);
        let small = DMatrix::from_vec(k, k, dense::transpose_times(n, basis, &moved));
        let pairs = SymmetricEigen::new((&small + small.transpose()) * 0.5);
        let mut order: Vec<usize> = (0..k).collect();
        order.sort_by(|&i, &j| pairs.eigenvalues[i].total_cmp(&pairs.eigenvalues[j]));
        let weights = pairs.eigenvectors.select_columns(&order);
        let mut columns = vec![0.0; basis.len()];
        dense::add_product(n, &mut columns, 1.0, basis, weights.as_slice());
        columns.chunks_exact_mut(n).for_each(orient);
        let values: Vec<f64> = order.iter().map(|&i| pairs.eigenvalues[i]).collect();
        let residuals = self.residuals(&values, &columns);
        let (complete_below, factorizations, solves) = (f64::NAN, 0, 0);
        Ok(Modes { n, values, columns, residuals, complete_below, factorizations, solves })
    }

    /// The sizes of `H v - lambda M v`, measured by `M^-1`.
    fn residuals(&self, values: &[f64], columns: &[f64]) -> Vec<f64> {
        let n = self.dim();
        let mut r = dense::times(self.stiffness(), columns);
        let moved = dense::times(self.mass(), columns);
        let each = r.chunks_exact_mut(n).zip(moved.chunks_exact(n)).zip(values);
        each.for_each(|((r, moved), lambda)| dense::add_scaled(r, -lambda, moved));
        let mut a = vec![0.0; r.len()];
        self.metric().sharp_each(Covector(&r), Vector(&mut a));
        let pairs = r.chunks_exact(n).zip(a.chunks_exact(n));
        pairs.map(|(r, a)| dense::dot(r, a).max(0.0).sqrt()).collect()
    }

    /// Counts what is below a little more than the last mode, rigid motions left out. `next` is about
    /// the lambda that comes after it.
    fn certify(
        &mut self,
        modes: &mut Modes,
        next: Option<f64>,
        rigid: &RigidMotions,
    ) -> Result<usize, ModalError> {
        let last = modes.values.last().copied().unwrap_or(0.0);
        let gap = next.map_or(0.0, |next| PART_OF_GAP * (next - last));
        let first = gap.max(ABOVE * last.abs().max(SMALLEST * self.scale()));
        let mut error = ModalError::Sparse(SparseError::Singular);
        for place in 0..PLACES {
            let mu = last + first * 4.0_f64.powi(place);
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
        let moved = dense::times(mass, &self.columns);
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
