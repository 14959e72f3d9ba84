//! The lowest modes of a system, with the proof that none was missed.
//!
//! ```text
//! H v_i = lambda_i M v_i,    v_i^T M v_j = 1 where i = j, else 0             (notes 14.2)
//! |lambda_i - true| <= |H v_i - lambda_i M v_i|, measured by M^-1
//! ```
//! `H` the Hessian at an equilibrium and `M` the mass (n x n, sparse), `lambda` in 1/s^2, angular
//! frequency `sqrt(lambda)` in rad/s. Found by block Lanczos on a shifted stiffness, or whole where n
//! is small. A count of what lies below a limit then tells whether any was missed: above the last mode,
//! or, where that cuts a cluster, in the gap below it. The search goes on beside the modes at hand until
//! none is missing. The count is compared with vectors whose products were checked: a vector that is
//! there twice cannot stand for one that is missing.

use nalgebra::DMatrix;
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
    /// Those beside which they were found, as long as they are not among them.
    rigid: RigidMotions,
    complete_below: f64,
    factorizations: u64,
    solves: u64,
}

/// What a count says of the modes.
enum Count {
    /// None is missing below this limit.
    Complete(f64),
    /// So many are.
    Missing(usize),
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
/// How far above the last mode the first count is: this part of the way to the next one, but not
/// less than this relative to the last; and places tried above that.
const PART_OF_GAP: f64 = 0.25;
const ABOVE: f64 = 1e-7;
const PLACES: i32 = 6;
/// The least gap below a mode in which a count is tried, relative to the scale.
const GAP: f64 = 1e-11;
/// Products in the mass that are farther from one and zero than this are made right, once.
const SKEW: f64 = 1e-11;
/// Columns that are left with less than this share of their length are combinations of others.
const INDEPENDENT: f64 = 1e-6;
/// What is below this is zero, relative to the scale.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// A mode is given away only with a residual below this, relative to the scale.
const ACCURATE: f64 = 1e-9;
/// Where the search fails, systems of so few freedoms are solved whole all the same.
const WHOLE: usize = 600;

impl<M: Metric, P: Potential> Linearized<'_, M, P> {
    /// The lowest `count` modes besides the rigid motions.
    ///
    /// # Errors
    /// [`ModalError::Count`] where there are not so many, [`ModalError::NotRigid`] and others for rigid
    /// motions of another system; [`ModalError::NotConverged`], [`ModalError::Inaccurate`] and those of
    /// the sparse matrices where the modes cannot be found, or not be counted.
    pub fn lowest(&mut self, count: usize, rigid: &RigidMotions) -> Result<Modes, ModalError> {
        rigid.check(self)?;
        let there = self.dim().saturating_sub(rigid.len());
        if count == 0 || count > there {
            return Err(ModalError::Count { asked: count, there });
        }
        let before = self.factorizations();
        let mut modes = if self.dim() <= SMALL {
            self.whole(count, rigid)?
        } else {
            match self.searched(count, rigid) {
                Err(_) if self.dim() <= WHOLE => self.whole(count, rigid)?,
                searched => searched?,
            }
        };
        modes.factorizations = self.factorizations() - before;
        Ok(modes)
    }

    /// By dense matrices.
    fn whole(&mut self, count: usize, rigid: &RigidMotions) -> Result<Modes, ModalError> {
        self.check_mass()?;
        let raised = ABOVE_ALL * self.scale();
        let found = small::lowest(self.stiffness(), self.mass(), rigid, raised, count)?;
        let modes = self.rayleigh_ritz(found.vectors, rigid)?;
        match self.count(&modes, count, found.next)? {
            Count::Complete(limit) => self.checked(modes, count, limit),
            Count::Missing(_) => {
                Err(ModalError::NotConverged { converged: modes.len(), asked: count, restarts: 0 })
            }
        }
    }

    /// By iteration, again beside what was found while some are missing.
    fn searched(&mut self, count: usize, rigid: &RigidMotions) -> Result<Modes, ModalError> {
        let mut found = self.search(count, &rigid.columns)?;
        let mut vectors = std::mem::take(&mut found.vectors);
        let (mut solves, mut searches, mut least) = (found.solves, 1, usize::MAX);
        loop {
            let mut modes = self.rayleigh_ritz(vectors, rigid)?;
            let next = modes.values.get(count).copied().or(found.next);
            modes.truncate(count);
            let missing = match self.count(&modes, count, next)? {
                Count::Complete(limit) => {
                    let mut modes = self.checked(modes, count, limit)?;
                    modes.solves = solves;
                    return Ok(modes);
                }
                Count::Missing(missing) => missing,
            };
            let room = self.dim() - rigid.len() - modes.len();
            if missing >= least || room == 0 {
                let converged = count.saturating_sub(missing);
                return Err(ModalError::NotConverged {
                    converged,
                    asked: count,
                    restarts: searches,
                });
            }
            (least, searches) = (missing, searches + 1);
            let known = [&rigid.columns[..], &modes.columns[..]].concat();
            found = self.search(missing.min(count).min(room), &known)?;
            solves += found.solves;
            vectors = [&modes.columns[..], &found.vectors[..]].concat();
        }
    }

    /// Vectors that span the lowest modes beside those that are known.
    fn search(&mut self, count: usize, known: &[f64]) -> Result<Found, ModalError> {
        let delta = self.shift()?;
        let (cholesky, mass) = self.factored();
        Krylov::new(cholesky, mass, delta, known).lowest(count)
    }

    /// The lowest of these modes, where they are what they seem.
    fn checked(&self, mut modes: Modes, count: usize, limit: f64) -> Result<Modes, ModalError> {
        modes.complete_below = limit;
        modes.truncate(count);
        let allowed = self.width();
        let is_bad = |residual: &f64| dense::exceeds(*residual, allowed);
        let bad = modes.residuals.iter().position(is_bad);
        match bad {
            Some(mode) => {
                let residual = modes.residuals[mode];
                Err(ModalError::Inaccurate { mode, residual, allowed })
            }
            None => Ok(modes),
        }
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

    /// The best approximations to modes among the combinations of these vectors, which are made
    /// orthonormal where they are not.
    fn rayleigh_ritz(&self, basis: Vec<f64>, rigid: &RigidMotions) -> Result<Modes, ModalError> {
        let mut modes = self.ritz(&basis, rigid)?;
        let mut off = dense::skewness(self.mass(), &modes.columns);
        if dense::exceeds(off, SKEW) {
            let basis = dense::orthonormal(self.mass(), &modes.columns, INDEPENDENT);
            modes = self.ritz(&basis, rigid)?;
            off = dense::skewness(self.mass(), &modes.columns);
        }
        if dense::exceeds(off, SKEW) {
            return Err(ModalError::NotOrthonormal { what: "the modes", off, allowed: SKEW });
        }
        Ok(modes)
    }

    fn ritz(&self, basis: &[f64], rigid: &RigidMotions) -> Result<Modes, ModalError> {
        let n = self.dim();
        let k = basis.len() / n;
        let moved = dense::times(self.stiffness(), basis);
        let small = DMatrix::from_vec(k, k, dense::transpose_times(n, basis, &moved));
        let pairs = dense::eigenpairs((&small + small.transpose()) * 0.5)?;
        let mut columns = vec![0.0; basis.len()];
        dense::add_product(n, &mut columns, 1.0, basis, pairs.eigenvectors.as_slice());
        columns.chunks_exact_mut(n).for_each(orient);
        let mut values = pairs.eigenvalues.as_slice().to_vec();
        let mut residuals = self.residuals(&values, &columns);
        // A zero that rounding made negative would grow without bounds.
        for (value, residual) in values.iter_mut().zip(&mut residuals) {
            if value.abs() <= ROUNDING * self.scale() {
                *residual += value.abs();
                *value = 0.0;
            }
        }
        let rigid = rigid.clone();
        let (complete_below, factorizations, solves) = (f64::NAN, 0, 0);
        Ok(Modes { n, values, columns, residuals, rigid, complete_below, factorizations, solves })
    }

    /// The sizes of `H v - lambda M v`, measured by `M^-1`.
    pub(crate) fn residuals(&self, values: &[f64], columns: &[f64]) -> Vec<f64> {
        let n = self.dim().max(1);
        let mut r = dense::times(self.stiffness(), columns);
        let moved = dense::times(self.mass(), columns);
        let each = r.chunks_exact_mut(n).zip(moved.chunks_exact(n)).zip(values);
        each.for_each(|((r, moved), lambda)| dense::add_scaled(r, -lambda, moved));
        let mut a = vec![0.0; r.len()];
        self.metric().sharp_each(Covector(&r), Vector(&mut a));
        let pairs = r.chunks_exact(n).zip(a.chunks_exact(n));
        let size = |(r, a): (&[f64], &[f64])| {
            let square = dense::dot(r, a);
            // What is not a number stays so.
            if square < 0.0 { 0.0 } else { square.sqrt() }
        };
        pairs.map(size).collect()
    }

    /// Whether the lowest `count` are all: by what is below a little more than the last of them, or in
    /// a gap before it. `next` is about the lambda that comes after it.
    fn count(
        &mut self,
        modes: &Modes,
        count: usize,
        next: Option<f64>,
    ) -> Result<Count, ModalError> {
        let values = &modes.values[..count.min(modes.len())];
        let last = values.last().copied().unwrap_or(0.0);
        let gap = next.map_or(0.0, |next| PART_OF_GAP * (next - last));
        let least = ABOVE * last.abs().max(SMALLEST * self.scale());
        let above = |place: i32| last + gap.max(least) * 4.0_f64.powi(place);
        let mut answer = Err(ModalError::Sparse(SparseError::Singular));
        for mu in (0..PLACES).map(above) {
            answer = self.missing_below(modes, mu);
            if answer.is_ok() {
                break;
            }
        }
        if let Ok(Count::Complete(_)) = answer {
            return answer;
        }
        // Closely below the last ones, so that none can hide between the limit and them.
        let cluster = (0..values.len()).rev().take_while(|&j| last - values[j] <= self.width());
        let before = |j: usize| if j == 0 { f64::NEG_INFINITY } else { values[j - 1] };
        let steps = [1e-4, 1e-3, 1e-2, 1e-1, 1.0];
        let mut limits = Vec::new();
        for j in cluster.filter(|&j| values[j] - before(j) > GAP * self.scale()) {
            let least = 4.0 * modes.residuals[j];
            let step =
                |part: f64| (part * self.width()).max(least).min(0.5 * (values[j] - before(j)));
            limits.extend(steps.map(|part| values[j] - step(part)));
        }
        // The highest limit at which a count is to be had decides.
        for mu in limits {
            let lower = self.missing_below(modes, mu);
            if lower.is_ok() {
                return lower;
            }
        }
        answer
    }

    /// Values closer than this are not told apart.
    fn width(&self) -> f64 {
        ACCURATE * self.scale()
    }

    /// How many modes are missing below a limit.
    fn missing_below(&mut self, modes: &Modes, mu: f64) -> Result<Count, ModalError> {
        let there = self.count_below(mu)?;
        let rigid = if mu > 0.0 { modes.rigid.len() } else { 0 };
        let known = rigid + modes.values.partition_point(|value| *value < mu);
        match there.checked_sub(known) {
            Some(0) => Ok(Count::Complete(mu)),
            Some(missing) => Ok(Count::Missing(missing)),
            // More than there are: a value is farther off than the gap is wide.
            None => Err(ModalError::Sparse(SparseError::Singular)),
        }
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

    /// The eigenvalues lambda, 1/s^2, ascending; rigid motions, and what rounding cannot tell from them,
    /// have exactly zero.
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

    /// For each mode how far its lambda may be off, 1/s^2, rounding aside.
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

    /// No mode with a lambda below this number is missing, rigid motions aside. It lies above the last
    /// mode where there is a gap; where the count of modes cuts a cluster it lies below the cluster's
    /// first.
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

    /// The same modes after the rigid motions, as modes of lambda zero, with the residuals that zero has.
    ///
    /// # Errors
    /// [`ModalError::OtherMotions`] where the modes were found beside other motions than these, or have
    /// them already.
    pub fn with_rigid(mut self, rigid: &RigidMotions) -> Result<Self, ModalError> {
        if self.rigid != *rigid {
            return Err(ModalError::OtherMotions { found: self.rigid.len(), given: rigid.len() });
        }
        self.rigid = RigidMotions::none();
        let first_elastic = self.values.partition_point(|&lambda| lambda < 0.0);
        self.values.splice(first_elastic..first_elastic, vec![0.0; rigid.len()]);
        self.residuals.splice(first_elastic..first_elastic, rigid.residuals.iter().copied());
        let place = first_elastic * self.n;
        self.columns.splice(place..place, rigid.columns.iter().copied());
        Ok(self)
    }

    /// The lowest `count` of them. What is left out is missing: [`Modes::complete_below`] comes down
    /// to the least that its first can be.
    pub fn truncate(&mut self, count: usize) {
        if let Some(first) = self.values.get(count) {
            let off = dense::dot(&self.residuals, &self.residuals).sqrt();
            self.complete_below = self.complete_below.min(first - off);
        }
        self.values.truncate(count);
        self.residuals.truncate(count);
        self.columns.truncate(count.saturating_mul(self.n));
    }

    /// All modes, one after the other.
    pub(crate) fn columns(&self) -> &[f64] {
        &self.columns
    }

    pub(crate) fn column(&self, i: usize) -> &[f64] {
        &self.columns[i * self.n..(i + 1) * self.n]
    }
}
