//! Statics: where a potential is lowest, the differential vanishes.
//!
//! ```text
//! dV(q) = 0        found by lowering V(q) at every step
//! ```
//! `q` a configuration of a flat space (n), `V` in joules. Newton's method with a line search on the
//! energy: where the Hessian is not positive definite, the solver's ladder shifts it by the mass, so
//! that each step descends, and the shift only changes the way, not the minimum. The size of a residual
//! is `|M^-1 dV|` in the metric, in kg^1/2 m/s^2: an acceleration times the root of a mass.
//! Source: notes 4.4 and 14.2. Finds minima; a maximum or a saddle only if it starts there.

use crate::{
    Covector, Equation, HessianSolver, Merit, Metric, Newton, NewtonError, NewtonMemory,
    NewtonReport, Potential, Rung, SizeError, Unsolvable, Vector,
};

/// The search for a minimum of a potential.
#[derive(Clone, Debug)]
pub struct Equilibrium<'a, M, P, L> {
    energy: PotentialEnergy<'a, M, P, L>,
    newton: Newton,
    memory: NewtonMemory<Vec<f64>>,
}

/// A minimum that was found, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EquilibriumReport {
    /// What Newton's method did.
    pub newton: NewtonReport,
    /// The highest rung of the solver's ladder on the way.
    pub highest_rung: Rung,
    /// The rung at the equilibrium itself: [`Rung::Cholesky`] proves that it is a strict minimum; any
    /// other says that it is flat, to rounding, or no minimum at all.
    pub rung: Rung,
}

impl<'a, M: Metric, P: Potential, L: HessianSolver> Equilibrium<'a, M, P, L> {
    /// A search with the caller's solver.
    pub fn new(
        metric: &'a M,
        potential: &'a P,
        solver: L,
        newton: Newton,
    ) -> Result<Self, SizeError> {
        let n = metric.dim();
        SizeError::check("the potential's freedoms", n, potential.dim())?;
        let zeros = vec![0.0; n];
        let memory = NewtonMemory::new(n, newton.iterations);
        let size = SizeError { what: "the freedoms", expected: n, got: n };
        Ok(Equilibrium {
            energy: PotentialEnergy {
                metric,
                potential,
                solver,
                highest_rung: Rung::Cholesky,
                acceleration: Vector(zeros),
            },
            newton,
            memory: memory.ok_or(size)?,
        })
    }

    /// Moves `q` to a minimum. On failure q holds the last iterate, of less energy than the guess.
    pub fn find(&mut self, q: &mut [f64]) -> Result<EquilibriumReport, NewtonError> {
        self.energy.highest_rung = Rung::Cholesky;
        let newton = self.newton.solve(&mut self.energy, q, &mut self.memory)?;
        let highest_rung = self.energy.highest_rung;
        let rung = self.energy.factor(q).unwrap_or(Rung::Indefinite);
        Ok(EquilibriumReport { newton, highest_rung, rung })
    }

    /// The residual's size at the guess and after each step of the last search.
    pub fn history(&self) -> &[f64] {
        self.memory.history()
    }
}

/// The equation dV(q) = 0.
#[derive(Clone, Debug)]
struct PotentialEnergy<'a, M, P, L> {
    metric: &'a M,
    potential: &'a P,
    solver: L,
    highest_rung: Rung,
    acceleration: Vector<Vec<f64>>,
}

impl<M: Metric, P: Potential, L: HessianSolver> PotentialEnergy<'_, M, P, L> {
    fn factor(&mut self, q: &[f64]) -> Result<Rung, Unsolvable> {
        self.solver.factor_weighted(0.0, self.metric, 1.0, self.potential, q)
    }
}

impl<M: Metric, P: Potential, L: HessianSolver> Equation for PotentialEnergy<'_, M, P, L> {
    fn residual(&mut self, q: &[f64], f: &mut [f64]) {
        f.fill(0.0);
        self.potential.add_differential(q, Covector(f));
    }

    fn solve(&mut self, q: &[f64], f: &mut [f64]) -> Result<(), Unsolvable> {
        let rung = self.factor(q)?;
        self.highest_rung = self.highest_rung.max(rung);
        self.solver.solve(f);
        Ok(())
    }

    fn norm(&mut self, f: &[f64]) -> f64 {
        let f = Covector(f);
        self.metric.sharp(f.view(), self.acceleration.view_mut());
        f.apply(&self.acceleration).sqrt()
    }

    fn energy(&mut self, q: &[f64]) -> Option<f64> {
        Some(self.potential.energy(q))
    }

    fn merit(&self) -> Merit {
        Merit::Energy
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DenseSolver, DiagonalMetric, NewtonEnd, Sink};
    use std::cell::RefCell;

    /// An energy of two freedoms with its derivatives, which remembers every energy that it gave.
    struct Landscape {
        energy: fn(f64, f64) -> f64,
        differential: fn(f64, f64) -> [f64; 2],
        hessian: fn(f64, f64) -> [f64; 3],
        hessians_at: RefCell<Vec<f64>>,
    }

    impl Potential for Landscape {
        fn dim(&self) -> usize {
            2
        }

        fn energy(&self, q: &[f64]) -> f64 {
            (self.energy)(q[0], q[1])
        }

        fn add_differential(&self, q: &[f64], mut dv: Covector<&mut [f64]>) {
            dv.add_scaled(1.0, Covector(&(self.differential)(q[0], q[1])));
        }

        fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
            self.hessians_at.borrow_mut().push(self.energy(q));
            let [xx, xy, yy] = (self.hessian)(q[0], q[1]);
            hessian.add_symmetric(&[0, 1], &[xx, xy, xy, yy]);
        }
    }

    fn rosenbrock() -> Landscape {
        Landscape {
            energy: |x, y| (1.0 - x).powi(2) + 100.0 * (y - x * x).powi(2),
            differential: |x, y| [-2.0 * (1.0 - x) - 400.0 * x * (y - x * x), 200.0 * (y - x * x)],
            hessian: |x, y| [2.0 - 400.0 * (y - 3.0 * x * x), -400.0 * x, 200.0],
            hessians_at: RefCell::default(),
        }
    }

    fn saddle() -> Landscape {
        // Two wells at x = -1 and x = 1, with a saddle between them.
        Landscape {
            energy: |x, y| 0.25 * (x * x - 1.0).powi(2) + y * y,
            differential: |x, y| [x * (x * x - 1.0), 2.0 * y],
            hessian: |x, _| [3.0 * x * x - 1.0, 0.0, 2.0],
            hessians_at: RefCell::default(),
        }
    }

    fn find(landscape: &Landscape, q: &mut [f64; 2]) -> Result<EquilibriumReport, NewtonError> {
        let metric = DiagonalMetric::new([1.0, 3.0]).unwrap();
        let solver = DenseSolver::<[f64; 2]>::new(2).unwrap();
        Equilibrium::new(&metric, landscape, solver, Newton::default()).unwrap().find(q)
    }

    #[test]
    fn the_energy_falls_at_every_step_to_the_minimum() {
        for guess in [[-1.2, 1.0], [10.0, -10.0], [0.0, 5.0], [-3.0, 9.0]] {
            let landscape = rosenbrock();
            let mut q = guess;
            let report = find(&landscape, &mut q).unwrap();
            assert!((q[0] - 1.0).abs() < 1e-12 && (q[1] - 1.0).abs() < 1e-12, "{q:?}");
            assert_eq!(report.rung, Rung::Cholesky);
            assert!(report.newton.iterations < 50);
            let mut energies = landscape.hessians_at.into_inner();
            energies.dedup();
            assert!(energies.windows(2).all(|pair| pair[1] < pair[0]), "{energies:?}");
        }
    }

    #[test]
    fn from_beside_a_saddle_the_search_descends_to_a_well() {
        let mut q = [1e-3, 0.5];
        let report = find(&saddle(), &mut q).unwrap();
        assert!((q[0] - 1.0).abs() < 1e-15 && q[1].abs() < 1e-15, "{q:?}");
        assert!(matches!(report.highest_rung, Rung::Shifted { .. }));
        assert_eq!(report.rung, Rung::Cholesky);
    }

    #[test]
    fn on_a_saddle_the_search_stays_and_says_that_it_is_no_minimum() {
        let mut q = [0.0, 0.0];
        let report = find(&saddle(), &mut q).unwrap();
        assert_eq!((q, report.newton.iterations), ([0.0; 2], 0));
        assert_eq!(report.newton.end, NewtonEnd::Tolerance);
        assert!(matches!(report.rung, Rung::Shifted { .. }));
    }

    #[test]
    fn a_free_spring_is_found_at_rest_and_flat() {
        // Two points on a line with a spring of length 1 between them; both may drift.
        let spring = Landscape {
            energy: |x, y| 0.5 * (y - x - 1.0).powi(2),
            differential: |x, y| [-(y - x - 1.0), y - x - 1.0],
            hessian: |_, _| [1.0, -1.0, 1.0],
            hessians_at: RefCell::default(),
        };
        let mut q = [0.3, 4.0];
        let report = find(&spring, &mut q).unwrap();
        assert!((q[1] - q[0] - 1.0).abs() < 1e-14);
        // No force acts on the centre of mass.
        assert!((q[0] + 3.0 * q[1] - 12.3).abs() < 1e-12);
        assert!(matches!(report.rung, Rung::Shifted { .. }));
    }

    #[test]
    fn a_landscape_without_a_minimum_ends_in_a_failure() {
        let slope = Landscape {
            energy: |x, y| (-x).exp() + y * y,
            differential: |x, y| [-(-x).exp(), 2.0 * y],
            hessian: |x, _| [(-x).exp(), 0.0, 2.0],
            hessians_at: RefCell::default(),
        };
        let error = find(&slope, &mut [0.0, 1.0]).unwrap_err();
        assert_eq!(error.failure, crate::NewtonFailure::NotConverged);
        assert_eq!(error.history.len(), 51);
    }

    #[cfg(feature = "sparse")]
    #[test]
    fn a_hanging_row_of_masses_stretches_as_the_closed_form_says() {
        // Springs of energy 1/4 s^4 in a row from the ceiling, masses of weight 1 between them: the i-th
        // spring carries n - i masses and stretches by the cube root of that.
        struct Row(usize);
        impl Row {
            fn stretches<'q>(&self, q: &'q [f64]) -> impl Iterator<Item = f64> + 'q {
                (0..self.0).map(move |i| q[i] - if i == 0 { 0.0 } else { q[i - 1] })
            }
        }
        impl Potential for Row {
            fn dim(&self) -> usize {
                self.0
            }
            fn energy(&self, q: &[f64]) -> f64 {
                self.stretches(q).map(|s| 0.25 * s.powi(4)).sum::<f64>() - q.iter().sum::<f64>()
            }
            fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
                for (i, s) in self.stretches(q).enumerate() {
                    dv.0[i] += s.powi(3) - 1.0;
                    if i > 0 {
                        dv.0[i - 1] -= s.powi(3);
                    }
                }
            }
            fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
                for (i, s) in self.stretches(q).enumerate() {
                    let k = 3.0 * s * s;
                    let before = i.checked_sub(1).unwrap_or(crate::FIXED);
                    hessian.add_symmetric(&[before, i], &[k, -k, -k, k]);
                }
            }
        }
        let (n, row) = (200, Row(200));
        let metric = DiagonalMetric::new(vec![1.0; n]).unwrap();
        let mut q: Vec<f64> = (1..=n).map(|i| i as f64).collect();
        let solver = crate::SparseSolver::new(&metric, &row, &q).unwrap();
        let mut search = Equilibrium::new(&metric, &row, solver, Newton::default()).unwrap();
        let report = search.find(&mut q).unwrap();
        assert_eq!((report.rung, report.highest_rung), (Rung::Cholesky, Rung::Cholesky));
        for (i, s) in row.stretches(&q).enumerate() {
            assert!((s - ((n - i) as f64).cbrt()).abs() < 1e-10, "{i}: {s}");
        }
    }
}
