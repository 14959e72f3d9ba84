//! A system near an equilibrium: its stiffness and its mass, and how they are counted.
//!
//! ```text
//! V(q0 + d) = V(q0) + 1/2 d^T H d + o(|d|^2),    M d'' = -H d              (notes 14.1, 14.2)
//! number of lambda < mu  =  number of negative eigenvalues of H - mu M
//! ```
//! `q0` the equilibrium (n), `d` a displacement, `H` the Hessian there and `M` the mass matrix,
//! both sparse and n x n, `lambda mu` in 1/s^2. Works on flat spaces.

use stationary_calculus::{
    Covector, Metric, Ordering, Potential, SizeError, SparseCholesky, SparseError, SymmetricMatrix,
    Vector,
};

use crate::{ModalError, dense};

/// The stiffness and the mass of a system at an equilibrium.
#[derive(Clone, Debug)]
pub struct Linearized<'a, M, P> {
    metric: &'a M,
    potential: &'a P,
    q: Vec<f64>,
    stiffness: SymmetricMatrix,
    mass: SymmetricMatrix,
    /// `m M + a H`, refilled for each pair of weights.
    pencil: SymmetricMatrix,
    cholesky: SparseCholesky,
    scale: f64,
    factorizations: u64,
}

impl<'a, M: Metric, P: Potential> Linearized<'a, M, P> {
    /// The system at `q`, where the size `|M^-1 dV|` may be at most `tolerance` (kg^1/2 m/s^2).
    ///
    /// # Errors
    /// [`ModalError::NoEquilibrium`] with the size that it has; [`ModalError::Mass`] where the
    /// metric is not positive definite; [`ModalError::Parameter`] where nothing is stiff, or a
    /// stiffness is not finite; [`ModalError::Size`] and those of the sparse matrices.
    pub fn at(
        metric: &'a M,
        potential: &'a P,
        q: &[f64],
        tolerance: f64,
    ) -> Result<Self, ModalError> {
        let n = metric.dim();
        SizeError::check("the potential's freedoms", n, potential.dim())?;
        SizeError::check("the configuration's numbers", n, q.len())?;
        check_equilibrium(metric, potential, q, tolerance)?;
        let mass = SymmetricMatrix::mass(metric)?;
        check_mass(&mass)?;
        let mut pencil = SymmetricMatrix::analyse(n, |sink| {
            metric.add_matrix(sink);
            potential.add_hessian(q, sink);
        })?;
        fill(&mut pencil, (0.0, metric), (1.0, potential, q))?;
        let stiffness = pencil.clone();
        let scale = scale(&stiffness, &mass);
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(ModalError::Parameter { what: "the largest stiffness", value: scale });
        }
        // Many solves follow: a smaller factor is worth its search.
        let cholesky = SparseCholesky::analyse_by(&pencil, Ordering::Smaller)?;
        let q = q.to_vec();
        Ok(Linearized {
            metric,
            potential,
            q,
            stiffness,
            mass,
            pencil,
            cholesky,
            scale,
            factorizations: 0,
        })
    }

    /// The number of freedoms n.
    pub fn dim(&self) -> usize {
        self.q.len()
    }

    pub(crate) fn metric(&self) -> &M {
        self.metric
    }

    pub(crate) fn potential(&self) -> &'a P {
        self.potential
    }

    pub(crate) fn equilibrium(&self) -> &[f64] {
        &self.q
    }

    /// The Hessian H.
    pub fn stiffness(&self) -> &SymmetricMatrix {
        &self.stiffness
    }

    /// The mass matrix M.
    pub fn mass(&self) -> &SymmetricMatrix {
        &self.mass
    }

    /// An upper estimate of the largest |lambda|, 1/s^2: the largest row sum of `M^-1/2 |H| M^-1/2`
    /// with the diagonal of M. What is far smaller than this is rounding.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Refills the pencil with `m M + a H`.
    fn fill(&mut self, m: f64, a: f64) -> Result<(), ModalError> {
        fill(&mut self.pencil, (m, self.metric), (a, self.potential, &self.q))
    }

    /// Refills a copy of the stiffness with the Hessian at another configuration.
    pub(crate) fn hessian_at(
        &self,
        q: &[f64],
        hessian: &mut SymmetricMatrix,
    ) -> Result<(), ModalError> {
        fill(hessian, (0.0, self.metric), (1.0, self.potential, q))
    }

    /// Factors `H + delta M`; the inner error says why it is not positive definite.
    pub(crate) fn factor(&mut self, delta: f64) -> Result<Result<(), SparseError>, ModalError> {
        self.fill(delta, 1.0)?;
        self.factorizations += 1;
        Ok(self.cholesky.factor(&self.pencil))
    }

    /// How many matrices were factored so far.
    pub(crate) fn factorizations(&self) -> u64 {
        self.factorizations
    }

    /// The factor made last, and the mass.
    pub(crate) fn factored(&mut self) -> (&mut SparseCholesky, &SymmetricMatrix) {
        (&mut self.cholesky, &self.mass)
    }

    /// The stiffness, and the factor made last.
    pub(crate) fn stiffness_and_factor(&mut self) -> (&SymmetricMatrix, &mut SparseCholesky) {
        (&self.stiffness, &mut self.cholesky)
    }

    /// How many eigenvalues are smaller than `mu`, certified by an inertia that was checked.
    ///
    /// # Errors
    /// Where `mu` is so close to an eigenvalue that the count cannot be trusted.
    pub fn count_below(&mut self, mu: f64) -> Result<usize, ModalError> {
        self.fill(-mu, 1.0)?;
        self.factorizations += 1;
        Ok(self.cholesky.inertia(&self.pencil)?.negative)
    }
}

/// Refills a matrix of the pencil's pattern with `m M + a H(q)`.
fn fill(
    matrix: &mut SymmetricMatrix,
    (m, metric): (f64, &impl Metric),
    (a, potential, q): (f64, &impl Potential, &[f64]),
) -> Result<(), ModalError> {
    matrix.refill(|sink| {
        metric.add_matrix(sink.weighted(m));
        potential.add_hessian(q, sink.weighted(a));
    })?;
    Ok(())
}

fn check_equilibrium(
    metric: &impl Metric,
    potential: &impl Potential,
    q: &[f64],
    tolerance: f64,
) -> Result<(), ModalError> {
    if !(tolerance >= 0.0 && tolerance.is_finite()) {
        return Err(ModalError::Parameter { what: "the tolerance", value: tolerance });
    }
    let (mut dv, mut a) = (Covector(vec![0.0; q.len()]), Vector(vec![0.0; q.len()]));
    potential.add_differential(q, dv.view_mut());
    metric.sharp(dv.view(), a.view_mut());
    let residual = dv.apply(&a).sqrt();
    if residual <= tolerance {
        return Ok(());
    }
    let share = |i: &usize| (dv.0[*i] * a.0[*i]).abs();
    let freedom = (0..q.len()).max_by(|i, j| share(i).total_cmp(&share(j))).unwrap_or(0);
    Err(ModalError::NoEquilibrium { residual, freedom, tolerance })
}

/// Masses that are not positive, and pairs of freedoms whose products outweigh their squares: what
/// no positive definite matrix has. The rest shows when the stiffness is shifted.
fn check_mass(mass: &SymmetricMatrix) -> Result<(), ModalError> {
    let starts = mass.column_starts();
    let diagonal = |freedom: usize| mass.values()[starts[freedom] as usize];
    for (j, ends) in starts.windows(2).enumerate() {
        let below = ends[0] as usize + 1..ends[1] as usize;
        let outweighed = |k: usize| {
            let root = diagonal(j).sqrt() * diagonal(mass.rows()[k] as usize).sqrt();
            mass.values()[k].abs() < root
        };
        if !(diagonal(j) > 0.0 && below.into_iter().all(outweighed)) {
            return Err(ModalError::Mass(SparseError::NotPositiveDefinite { freedom: j }));
        }
    }
    Ok(())
}

fn scale(stiffness: &SymmetricMatrix, mass: &SymmetricMatrix) -> f64 {
    let diagonal: Vec<f64> =
        mass.column_starts()[..mass.dim()].iter().map(|&k| mass.values()[k as usize]).collect();
    let mut sums = vec![0.0; stiffness.dim()];
    for (j, ends) in stiffness.column_starts().windows(2).enumerate() {
        for k in ends[0] as usize..ends[1] as usize {
            let i = stiffness.rows()[k] as usize;
            let entry = stiffness.values()[k].abs() / diagonal[i].sqrt() / diagonal[j].sqrt();
            sums[i] += entry;
            if i != j {
                sums[j] += entry;
            }
        }
    }
    dense::largest(sums.into_iter())
}
