//! Statics: where a potential is lowest, the differential vanishes.
//!
//! ```text
//! dV(q) = 0        found by lowering V(q)
//! ```
//! `q` a configuration of a flat space (n), `V` in joules. Newton's method with a line search on the
//! energy, which may rise for three steps if it is lower after them. Where the Hessian is not positive definite it is shifted by a multiple of the mass, so that
//! each step descends, and the way also leads along the direction of the lowest curvature, so that it
//! leaves a ridge. Where there is no Hessian it leads along the force, in growing steps. The shift only
//! changes the way, not the minimum. The size of a residual is `|M^-1 dV|` in the metric, in
//! kg^1/2 m/s^2: an acceleration times the root of a mass.
//!
//! A search ends with a [`Stationary`] place: a minimum, a flat one, or a saddle with a direction that
//! leads down; or with a failure: the energy falls without end, no step lowers it, or the bound on the
//! iterations is reached. It has converged where the residual is within the tolerance, or is what
//! rounding makes of the terms it is the sum of, `|dV_i| <= 64 eps sum_j |H_ij| |q_j|`; once it stands still, where
//! q_j is close to zero, also what rounding of the largest component of q and of the largest force leaves.
//! Source: notes 4.4 and 14.2. Finds minima; a saddle only if it starts there, and says so.

mod asked;
mod curvature;
mod descent;
mod terms;

use crate::{
    HessianSolver, Metric, Newton, NewtonError, NewtonReport, Potential, Rung, SizeError, Vector,
};
use asked::Landscape;
use descent::Descent;

/// The search for a minimum of a potential.
#[derive(Clone, Debug)]
pub struct Equilibrium<'a, M, P, L> {
    landscape: Landscape<'a, M, P, L>,
    newton: Newton,
    history: Vec<f64>,
}

/// What kind of place it is where no force acts.
#[derive(Clone, Debug, PartialEq)]
pub enum Stationary {
    /// The Hessian is positive definite: a strict minimum. Of a solver that iterates it is so on trust: see
    /// [`HessianSolver::negative_curvature`]. After a dozen steps it is definite some roundings of q away too.
    Minimum,
    /// In some direction the energy does not bend, to rounding: a rigid motion of a free body, or a
    /// place where higher derivatives decide.
    Flat,
    /// In some direction the energy falls: this is no minimum.
    Saddle {
        /// A direction in which it falls, of length 1 in the metric; its opposite is another one.
        down: Vector<Vec<f64>>,
        /// The second derivative of the energy in that direction, negative, 1/s^2.
        curvature: f64,
    },
}

/// A place at rest that was found, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct EquilibriumReport {
    /// What Newton's method did.
    pub newton: NewtonReport,
    /// What kind of place it is.
    pub kind: Stationary,
    /// The highest rung of the solver's ladder on the way.
    pub highest_rung: Rung,
    /// The rung at the equilibrium itself: [`Rung::Cholesky`] proves that it is a strict minimum; any
    /// other says that it is flat, to rounding, or no minimum at all: see `kind`.
    pub rung: Rung,
}

impl<'a, M: Metric, P: Potential, L: HessianSolver> Equilibrium<'a, M, P, L> {
    /// A search with the caller's solver.
    ///
    /// # Errors
    /// Where metric, potential and solver are not of one size.
    pub fn new(
        metric: &'a M,
        potential: &'a P,
        solver: L,
        newton: Newton,
    ) -> Result<Self, SizeError> {
        let landscape = Landscape::new(metric, potential, solver)?;
        Ok(Equilibrium { landscape, newton, history: Vec::new() })
    }

    /// Moves `q` to where no force acts: see the report for what kind of place it is. On failure q
    /// holds the last iterate, of no more energy than the guess.
    ///
    /// # Errors
    /// [`NewtonFailure`](crate::NewtonFailure): `Unbounded` where the energy falls without end,
    /// `Stalled` where no step lowers it though a force acts (a kink, or a differential that is not that
    /// of the energy), `NotConverged` at the bound on the iterations; numbers that are not finite, a q
    /// of another size, a tolerance that is negative or none.
    pub fn find(&mut self, q: &mut [f64]) -> Result<EquilibriumReport, NewtonError> {
        self.history.clear();
        let search = Descent::new(&mut self.landscape, self.newton);
        search
            .run(q, &mut self.history)
            .map_err(|failure| NewtonError { failure, history: self.history.clone() })
    }

    /// The residual's size at the guess and after each step of the last search.
    pub fn history(&self) -> &[f64] {
        &self.history
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Covector, DenseSolver, DiagonalMetric, NewtonEnd, Sink};
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
    fn the_energy_falls_over_every_four_steps_to_the_minimum() {
        for guess in [[-1.2, 1.0], [10.0, -10.0], [0.0, 5.0], [-3.0, 9.0]] {
            let landscape = rosenbrock();
            let mut q = guess;
            let report = find(&landscape, &mut q).unwrap();
            assert!((q[0] - 1.0).abs() < 1e-11 && (q[1] - 1.0).abs() < 1e-11, "{q:?}");
            assert_eq!(report.rung, Rung::Cholesky);
            assert!(report.newton.iterations < 50);
            let mut energies = landscape.hessians_at.into_inner();
            energies.dedup();
            assert!(energies.windows(5).all(|e| e[4] < e[0]), "{energies:?}");
        }
    }

    #[test]
    fn from_beside_a_saddle_the_search_descends_to_a_well() {
        let mut q = [1e-3, 0.5];
        let report = find(&saddle(), &mut q).unwrap();
        assert!((q[0] - 1.0).abs() < 1e-15 && q[1].abs() < 1e-15, "{q:?}");
        assert_eq!(report.kind, Stationary::Minimum);
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
        // The energy falls along x: V = 1/4 - x^2/2 there, of length 1 where the mass is 1.
        let Stationary::Saddle { down, curvature } = report.kind else { panic!("{report:?}") };
        assert!((down.0[0].abs() - 1.0).abs() < 1e-6 && down.0[1].abs() < 1e-6, "{down:?}");
        assert!((curvature + 1.0).abs() < 1e-6);
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
        assert!((q[0] + 3.0 * q[1] - 12.3).abs() < 1e-3);
        assert!(matches!(report.rung, Rung::Shifted { .. }));
        assert_eq!(report.kind, Stationary::Flat);
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

    fn landscape(
        energy: fn(f64, f64) -> f64,
        differential: fn(f64, f64) -> [f64; 2],
        hessian: fn(f64, f64) -> [f64; 3],
    ) -> Landscape {
        Landscape { energy, differential, hessian, hessians_at: RefCell::default() }
    }

    #[test]
    fn from_the_ridge_itself_the_search_comes_down_to_a_well() {
        for y in [0.5, -3.0, 1e3] {
            let mut q = [0.0, y];
            let report = find(&saddle(), &mut q).unwrap();
            assert!((q[0].abs() - 1.0).abs() < 1e-12 && q[1].abs() < 1e-12, "{q:?}");
            assert_eq!(report.kind, Stationary::Minimum);
        }
    }

    #[test]
    fn a_ball_above_a_soft_ground_falls_and_sinks_in_by_its_weight_over_the_stiffness() {
        // V = 3 y + 50 min(y, 0)^2 and a spring along x; no curvature in y above the ground.
        let ground = || {
            landscape(
                |x, y| 3.0 * y + 50.0 * y.min(0.0).powi(2) + 0.5 * x * x,
                |x, y| [x, 3.0 + 100.0 * y.min(0.0)],
                |_, y| [1.0, 0.0, if y < 0.0 { 100.0 } else { 0.0 }],
            )
        };
        for height in [1e-6, 0.2, 40.0, 1e5] {
            let mut q = [0.7, height];
            let report = find(&ground(), &mut q).unwrap();
            assert!((q[1] + 0.03).abs() < 1e-14 && q[0].abs() < 1e-12, "{height}: {q:?}");
            assert_eq!(report.kind, Stationary::Minimum);
        }
    }

    #[test]
    fn an_energy_that_falls_without_end_is_called_unbounded() {
        let tilt =
            landscape(|x, y| -2.0 * x + y * y, |_, y| [-2.0, 2.0 * y], |_, _| [0.0, 0.0, 2.0]);
        let hill =
            landscape(|x, y| -0.5 * x * x + y * y, |x, y| [-x, 2.0 * y], |_, _| [-1.0, 0.0, 2.0]);
        for (unbounded, start) in [(tilt, [0.0, 1.0]), (hill, [1e-3, 5.0])] {
            let mut q = start;
            let error = find(&unbounded, &mut q).unwrap_err();
            assert_eq!(error.failure, crate::NewtonFailure::Unbounded, "{error}");
            assert!(q.iter().all(|q| q.is_finite()));
        }
    }

    #[test]
    fn at_a_kink_no_step_makes_progress_and_nothing_is_called_singular() {
        let kink = landscape(
            |x, y| (x - 0.3).abs() + y * y,
            |x, y| [if x > 0.3 { 1.0 } else { -1.0 }, 2.0 * y],
            |_, _| [0.0, 0.0, 2.0],
        );
        // So stiff, and beside a coordinate so large, that its rounding would move the kink by more than the force.
        let beside = landscape(
            |x, y| 0.1 * x.abs() + 2e7 * x * x + (y - 2e5).powi(2),
            |x, y| [if x > 0.0 { 0.1 } else { -0.1 } + 4e7 * x, 2.0 * (y - 2e5)],
            |_, _| [4e7, 0.0, 2.0],
        );
        let progress = [crate::NewtonFailure::Stalled, crate::NewtonFailure::NotConverged];
        for (kink, mut q) in [(kink, [1.0, 1.0]), (beside, [0.3, 0.6])] {
            let error = find(&kink, &mut q).unwrap_err();
            assert!(progress.contains(&error.failure), "{error}");
        }
    }

    #[test]
    fn a_search_knows_nothing_of_how_far_the_last_one_began() {
        // A slope without any curvature down to a corner of soft walls.
        let corner = landscape(
            |x, y| 3.0 * (x + y) + 50.0 * (x.min(0.0).powi(2) + y.min(0.0).powi(2)),
            |x, y| [x, y].map(|q| 3.0 + 100.0 * q.min(0.0)),
            |x, y| {
                let [xx, yy] = [x, y].map(|q| if q < 0.0 { 100.0 } else { 0.0 });
                [xx, 0.0, yy]
            },
        );
        let metric = DiagonalMetric::new([1.0; 2]).unwrap();
        let solver = DenseSolver::<[f64; 2]>::new(2).unwrap();
        let mut search = Equilibrium::new(&metric, &corner, solver, Newton::default()).unwrap();
        for start in [1e-12, 1e5] {
            let mut q = [start; 2];
            search.find(&mut q).unwrap();
            assert!(q.iter().all(|q| (q + 0.03).abs() < 1e-14), "{start}: {q:?}");
        }
    }

    #[test]
    fn an_inflection_is_flat_and_no_minimum_however_far_from_the_origin() {
        for (at, cubic) in [
            (
                1.0,
                landscape(
                    |x, y| (x - 1.0).powi(3) + y * y,
                    |x, y| [3.0 * (x - 1.0).powi(2), 2.0 * y],
                    |x, _| [6.0 * (x - 1.0), 0.0, 2.0],
                ),
            ),
            (
                1e6,
                landscape(
                    |x, y| (x - 1e6).powi(3) + y * y,
                    |x, y| [3.0 * (x - 1e6).powi(2), 2.0 * y],
                    |x, _| [6.0 * (x - 1e6), 0.0, 2.0],
                ),
            ),
        ] {
            let mut q = [at + 1.0, 0.0];
            let report = find(&cubic, &mut q).unwrap();
            assert!((q[0] - at).abs() < 1e-13 * at, "{q:?}");
            assert_eq!(report.kind, Stationary::Flat, "{at}: {report:?}");
        }
    }

    #[test]
    fn where_nothing_bends_the_first_push_is_small_beside_q() {
        // Waves a millionth long; at u = 0 the sine has no curvature.
        let waves = landscape(
            |x, y| (1e6 * x - 1.0).sin() + (1e6 * y - 1.0).sin(),
            |x, y| [1e6 * (1e6 * x - 1.0).cos(), 1e6 * (1e6 * y - 1.0).cos()],
            |x, y| [-1e12 * (1e6 * x - 1.0).sin(), 0.0, -1e12 * (1e6 * y - 1.0).sin()],
        );
        let mut q = [1e-6; 2];
        assert_eq!((waves.hessian)(q[0], q[1]), [0.0; 3]);
        find(&waves, &mut q).unwrap();
        let nearest = 1e-6 * (1.0 - std::f64::consts::FRAC_PI_2);
        assert!(q.iter().all(|q| (q - nearest).abs() < 1e-15), "{q:?}");
    }

    #[test]
    fn from_a_ridge_the_way_down_is_as_long_as_the_energy_falls() {
        // A hill of curvature -1e-3 whose foot, a wall, is a million times farther than the start.
        let hill = landscape(
            |x, y| -5e-4 * x * x + 0.5 * (x.abs() - 1e3).max(0.0).powi(2) + y * y,
            |x, y| [-1e-3 * x + (x.abs() - 1e3).max(0.0) * x.signum(), 2.0 * y],
            |x, _| [-1e-3 + if x.abs() > 1e3 { 1.0 } else { 0.0 }, 0.0, 2.0],
        );
        let mut q = [1e-3, 0.5];
        let report = find(&hill, &mut q).unwrap();
        assert!((q[0].abs() - 1e3 / 0.999).abs() < 1e-9, "{q:?}");
        assert!(report.newton.iterations < 8, "{report:?}");
    }

    /// A spring of stiffness 1e9 that a soft one bends: a valley far narrower than it is bent.
    #[test]
    fn along_a_narrow_bent_valley_a_few_steps_are_enough() {
        let valley = landscape(
            |x, y| 5e8 * (x.hypot(y) - 1.0).powi(2) + 1e-2 * y,
            |x, y| {
                let r = x.hypot(y);
                let f = 1e9 * (r - 1.0) / r;
                [f * x, f * y + 1e-2]
            },
            |x, y| {
                let r = x.hypot(y);
                let (along, across) = (1e9, 1e9 * (1.0 - 1.0 / r));
                let (u, v) = (x / r, y / r);
                let mixed = (along - across) * u * v;
                [along * u * u + across * v * v, mixed, along * v * v + across * u * u]
            },
        );
        let mut q = [0.6, -0.8];
        let report = find(&valley, &mut q).unwrap();
        assert!(q[0].abs() < 1e-6 && (q[1] + 1.0).abs() < 1e-9, "{q:?}");
        assert!(report.newton.iterations < 25, "{report:?}");
    }

    #[test]
    fn sizes_and_tolerances_that_do_not_fit_are_refused() {
        let metric = DiagonalMetric::new([1.0, 3.0]).unwrap();
        let potential = saddle();
        let search = |n: usize, tolerance: f64, q: &mut [f64]| {
            let solver = DenseSolver::<Vec<f64>>::new(n).unwrap();
            let newton = Newton { tolerance, ..Newton::default() };
            let mut search = Equilibrium::new(&metric, &potential, solver, newton).ok()?;
            Some(search.find(q).map_err(|error| error.failure))
        };
        assert!(search(3, 0.0, &mut [0.0; 2]).is_none());
        for k in [0, 1, 3] {
            let refused = search(2, 0.0, &mut vec![0.0; k]).unwrap().unwrap_err();
            assert!(matches!(refused, crate::NewtonFailure::Size(_)), "{refused}");
        }
        for bad in [f64::NAN, -1.0] {
            let refused = search(2, bad, &mut [0.1, 0.0]).unwrap().unwrap_err();
            assert!(matches!(refused, crate::NewtonFailure::Tolerance(_)), "{refused}");
        }
    }

    #[test]
    fn a_search_ends_alike_at_every_scale_of_the_energy() {
        struct Scaled(f64);
        impl Potential for Scaled {
            fn dim(&self) -> usize {
                2
            }
            fn energy(&self, q: &[f64]) -> f64 {
                self.0 * (q[0] - 2.0).powi(2) + self.0 * q[1].powi(2)
            }
            fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
                dv.0[0] += 2.0 * self.0 * (q[0] - 2.0);
                dv.0[1] += 2.0 * self.0 * q[1];
            }
            fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
                hessian.add_symmetric(&[0], &[2.0 * self.0]);
                hessian.add_symmetric(&[1], &[2.0 * self.0]);
            }
        }
        let metric = DiagonalMetric::new([1.0, 3.0]).unwrap();
        for scale in [1e-250, 1e-170, 1.0, 1e170, 1e250] {
            let solver = DenseSolver::<[f64; 2]>::new(2).unwrap();
            let potential = Scaled(scale);
            let mut search =
                Equilibrium::new(&metric, &potential, solver, Newton::default()).unwrap();
            let mut q = [5.0, 1.0];
            search.find(&mut q).unwrap();
            assert!((q[0] - 2.0).abs() < 1e-14 && q[1].abs() < 1e-14, "{scale}: {q:?}");
        }
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
