//! Heat: `df/dt = alpha Lap f`, by three methods that share one line, factored once.
//!
//! ```text
//! (M + theta alpha h W) d = -alpha h dV(f),     f <- f + d
//! theta = 0 explicit Euler,  1/2 Crank-Nicolson,  1 implicit Euler
//! explicit: stable for h < 2 / (alpha |lambda|max)
//! ```
//! `f` (n) the free vertices' values, `W` the Hessian of the Dirichlet energy V, `M` the mass,
//! `alpha` m^2/s, `h` s. Written for the change d, a function that is at rest stays so to the
//! last bit; the matrix is read along its edges, and the factor once for all functions of a step.
//! Crank-Nicolson is of order 2 and keeps no sign: a spike rings. Implicit Euler with
//! lumped mass keeps the maximum principle where no weight is negative. Source: notes 15.2-15.3;
//! errata chapter 15.

use stationary_calculus::{
    Covector, Metric, Potential, SizeError, SparseCholesky, SymmetricMatrix, Vector,
};

use crate::LaplacianError;
use crate::differences::Differences;
use crate::error::{check_finite, positive};

/// How heat is stepped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeatMethod {
    /// Order 1; stable up to a border that falls with the square of the mesh size.
    ExplicitEuler,
    /// Order 1, stable at any step.
    ImplicitEuler,
    /// Order 2, stable at any step; fast modes alternate in sign.
    CrankNicolson,
}

impl HeatMethod {
    /// All of them.
    pub const ALL: [HeatMethod; 3] =
        [HeatMethod::ExplicitEuler, HeatMethod::ImplicitEuler, HeatMethod::CrankNicolson];

    /// Its name in kebab-case.
    pub fn name(self) -> &'static str {
        match self {
            HeatMethod::ExplicitEuler => "explicit-euler",
            HeatMethod::ImplicitEuler => "implicit-euler",
            HeatMethod::CrankNicolson => "crank-nicolson",
        }
    }

    fn theta(self) -> f64 {
        match self {
            HeatMethod::ExplicitEuler => 0.0,
            HeatMethod::CrankNicolson => 0.5,
            HeatMethod::ImplicitEuler => 1.0,
        }
    }

    /// What a step of `alpha h` does to a mode of `lambda = -|lambda|`: its factor.
    pub fn amplification(self, alpha_h_lambda: f64) -> f64 {
        let (z, theta) = (alpha_h_lambda, self.theta());
        1.0 + z / (1.0 - theta * z)
    }
}

/// Steps of heat of one size.
#[derive(Debug)]
pub struct Heat<'a, M> {
    metric: &'a M,
    differences: Differences,
    rate: f64,
    factor: Option<SparseCholesky>,
    covector: Covector<Vec<f64>>,
    change: Vector<Vec<f64>>,
}

impl<'a, M: Metric> Heat<'a, M> {
    /// Prepares steps of `h` seconds at a diffusivity of `alpha` m^2/s: all factoring is done here.
    ///
    /// # Errors
    /// [`LaplacianError::NothingFree`], [`LaplacianError::Parameter`], [`LaplacianError::Size`],
    /// [`LaplacianError::Sparse`].
    pub fn new(
        metric: &'a M,
        dirichlet: &impl Potential,
        method: HeatMethod,
        alpha: f64,
        h: f64,
    ) -> Result<Self, LaplacianError> {
        let n = metric.dim();
        SizeError::check("the energy's freedoms", n, dirichlet.dim())?;
        if n == 0 {
            return Err(LaplacianError::NothingFree);
        }
        let rate = positive("the diffusivity", alpha)? * positive("the step", h)?;
        positive("the diffusivity times the step", rate)?;
        let mut pencil = Pencil::new(metric, dirichlet)?;
        let implicit = method.theta() > 0.0;
        let factor = implicit.then(|| pencil.factored(1.0, method.theta() * rate)).transpose()?;
        let differences = Differences::new(dirichlet, pencil.filled(0.0, 1.0)?);
        let (covector, change) = (Covector(vec![0.0; n]), Vector(vec![0.0; n]));
        Ok(Heat { metric, differences, rate, factor, covector, change })
    }

    /// One step of a function, or of several one after the other, whose solves then read the
    /// factor once for all. After an error they are as they were.
    ///
    /// # Errors
    /// [`LaplacianError::Size`] and [`LaplacianError::NonFinite`].
    pub fn step(&mut self, f: &mut [f64]) -> Result<(), LaplacianError> {
        let n = self.metric.dim();
        let functions = f.len().div_ceil(n).max(1);
        SizeError::check("the functions' values", functions * n, f.len())?;
        self.change.0.resize(f.len(), 0.0);
        for (f, change) in f.chunks_exact(n).zip(self.change.0.chunks_exact_mut(n)) {
            match self.factor {
                Some(_) => self.differences.differential(f, change),
                None => {
                    self.differences.differential(f, &mut self.covector.0);
                    self.metric.sharp(self.covector.view(), Vector(change));
                }
            }
        }
        if let Some(factor) = &mut self.factor {
            factor.solve(&mut self.change.0);
        }
        for (change, &value) in self.change.0.iter_mut().zip(&*f) {
            *change = value - self.rate * *change;
        }
        check_finite(&self.change.0)?;
        f.copy_from_slice(&self.change.0);
        Ok(())
    }
}

/// Weighted sums of a mass and of an energy's Hessian, on one pattern.
pub(crate) struct Pencil<'a, M, P> {
    metric: &'a M,
    energy: &'a P,
    matrix: SymmetricMatrix,
}

impl<'a, M: Metric, P: Potential> Pencil<'a, M, P> {
    pub(crate) fn new(metric: &'a M, energy: &'a P) -> Result<Self, LaplacianError> {
        // The energy is a quadratic form: its Hessian is the same everywhere.
        let anywhere = vec![0.0; energy.dim()];
        let matrix = SymmetricMatrix::analyse(metric.dim(), |sink| {
            metric.add_matrix(sink);
            energy.add_hessian(&anywhere, sink);
        })?;
        Ok(Pencil { metric, energy, matrix })
    }

    /// `m M + a W`.
    pub(crate) fn filled(mut self, m: f64, a: f64) -> Result<SymmetricMatrix, LaplacianError> {
        self.fill(m, a)?;
        Ok(self.matrix)
    }

    /// Its factor.
    pub(crate) fn factored(&mut self, m: f64, a: f64) -> Result<SparseCholesky, LaplacianError> {
        self.fill(m, a)?;
        let mut factor = SparseCholesky::analyse(&self.matrix)?;
        factor.factor(&self.matrix)?;
        Ok(factor)
    }

    fn fill(&mut self, m: f64, a: f64) -> Result<(), LaplacianError> {
        let anywhere = vec![0.0; self.energy.dim()];
        let Pencil { metric, energy, matrix } = self;
        matrix.refill(|sink| {
            metric.add_matrix(sink.weighted(m));
            energy.add_hessian(&anywhere, sink.weighted(a));
        })?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::interval;
    use crate::{Domain, Elements, largest_eigenvalue};
    use stationary_measure::loglog_slope;
    use stationary_mesh::{Diagonals, bar, rectangle};
    use std::f64::consts::PI;

    fn rod(n: usize) -> Domain<2> {
        Domain::free(Elements::of(&bar(1.0, n).unwrap()).unwrap()).unwrap()
    }

    /// `cos(pi x)` on the interval is a mode of the discrete Laplacian.
    fn wave(n: usize) -> Vec<f64> {
        (0..=n).map(|k| (PI * k as f64 / n as f64).cos()).collect()
    }

    #[test]
    fn a_mode_decays_by_the_factor_of_its_method_at_each_step() {
        let n = 16;
        let (domain, h) = (rod(n), 1e-3);
        let metric = domain.lumped().unwrap();
        let lambda = -4.0 * (n * n) as f64 * (0.5 * PI / n as f64).sin().powi(2);
        for method in HeatMethod::ALL {
            let mut f = wave(n);
            let mut heat = Heat::new(&metric, domain.dirichlet(), method, 0.7, h).unwrap();
            for _ in 0..10 {
                heat.step(&mut f).unwrap();
            }
            let factor = method.amplification(0.7 * h * lambda).powi(10);
            assert!(
                f.iter().zip(wave(n)).all(|(f, w)| (f - factor * w).abs() < 1e-13),
                "{method:?}"
            );
        }
    }

    #[test]
    fn each_method_converges_at_its_order_in_time() {
        let n = 8;
        let domain = rod(n);
        let metric = domain.lumped().unwrap();
        let lambda = -4.0 * (n * n) as f64 * (0.5 * PI / n as f64).sin().powi(2);
        for (method, order) in HeatMethod::ALL.into_iter().zip([1.0, 1.0, 2.0]) {
            let error = |steps: usize| {
                let h = 0.1 / steps as f64;
                let mut f = wave(n);
                let mut heat = Heat::new(&metric, domain.dirichlet(), method, 1.0, h).unwrap();
                (0..steps).for_each(|_| heat.step(&mut f).unwrap());
                (h, (f[0] - (0.1 * lambda).exp()).abs())
            };
            let slope = loglog_slope(&[error(80), error(160), error(320)]).unwrap();
            assert!((slope - order).abs() < 0.05, "{method:?}: {slope}");
        }
    }

    #[test]
    fn explicit_heat_is_stable_just_below_its_border_and_not_just_above() {
        let problem = interval(32).unwrap();
        let (metric, dirichlet) = (problem.domain.lumped().unwrap(), problem.domain.dirichlet());
        let border = 2.0 / (0.5 * largest_eigenvalue(&metric, dirichlet).unwrap());
        assert!((border / (1.0 / (2.0 * 0.5 * 32.0 * 32.0)) - 1.0).abs() < 1e-10, "errata 15.3");
        let grows = |part: f64| {
            let method = HeatMethod::ExplicitEuler;
            let mut heat = Heat::new(&metric, dirichlet, method, 0.5, part * border).unwrap();
            let mut f: Vec<f64> = (0..33).map(|k| ((k * k) as f64).sin()).collect();
            for _ in 0..2000 {
                if heat.step(&mut f).is_err() {
                    return true;
                }
            }
            f.iter().any(|x| x.abs() > 1.0)
        };
        assert!(!grows(0.99) && grows(1.01));
    }

    #[test]
    fn heat_keeps_its_amount_and_rests_at_a_harmonic_function_to_the_last_bit() {
        let mesh = rectangle([1.0, 1.0], [6, 6], Diagonals::Crossed).unwrap();
        let domain = Domain::free(Elements::of(&mesh).unwrap()).unwrap();
        let metric = domain.galerkin().unwrap();
        let ones = vec![1.0; domain.dim()];
        let mut f: Vec<f64> = (0..domain.dim()).map(|k| (k as f64).sin()).collect();
        let amount = |f: &[f64]| metric.inner(Vector(&ones), Vector(f));
        let before = amount(&f);
        for method in [HeatMethod::ImplicitEuler, HeatMethod::CrankNicolson] {
            let mut heat = Heat::new(&metric, domain.dirichlet(), method, 1.0, 0.1).unwrap();
            (0..20).for_each(|_| heat.step(&mut f).unwrap());
            assert!((amount(&f) - before).abs() < 1e-12);
            let mut flat = ones.clone();
            heat.step(&mut flat).unwrap();
            assert_eq!(flat, ones);
        }
    }

    #[test]
    fn several_functions_flow_as_each_does_alone() {
        let domain = rod(12);
        let metric = domain.galerkin().unwrap();
        for method in HeatMethod::ALL {
            let heat = || Heat::new(&metric, domain.dirichlet(), method, 1.0, 1e-3).unwrap();
            let one = wave(12);
            let other: Vec<f64> = (0..13).map(|k| (k as f64).sin()).collect();
            let mut both = [one.clone(), other.clone()].concat();
            heat().step(&mut both).unwrap();
            let mut alone = [one, other];
            alone.iter_mut().for_each(|f| heat().step(f).unwrap());
            assert!(both.iter().zip(alone.concat()).all(|(a, b)| (a - b).abs() < 1e-14));
        }
    }

    #[test]
    fn a_bad_step_is_refused_and_leaves_the_function() {
        let domain = rod(4);
        let metric = domain.lumped().unwrap();
        let new = |h| Heat::new(&metric, domain.dirichlet(), HeatMethod::ImplicitEuler, 1.0, h);
        assert!(matches!(new(0.0), Err(LaplacianError::Parameter { what: "the step", .. })));
        assert!(new(f64::NAN).is_err());
        let mut heat = new(1.0).unwrap();
        let mut f = vec![0.0, f64::INFINITY, 1.0, 2.0, 3.0];
        let before = f.clone();
        assert!(matches!(heat.step(&mut f), Err(LaplacianError::NonFinite { .. })));
        assert_eq!(f, before);
        assert!(matches!(heat.step(&mut f[..3]), Err(LaplacianError::Size(_))));
    }
}
