//! Mass matrices: each equation has a unit of its own, which is no business of the method.

use std::ops::ControlFlow;

use stationary_integrators::{
    AdaptiveMethod, BackwardDifferences, Moment, RadauIia5, StepControl, Tolerance, VectorField,
    integrate,
};

use crate::first_order_methods::control;

/// `y_0' = cos t + y_1 - y_0,  0 = y_0 - y_1`, each in a unit of its own: y is sin t twice.
struct Led {
    units: [f64; 2],
    mass: [f64; 4],
}

impl VectorField for Led {
    fn dim(&self) -> usize {
        2
    }

    fn mass(&self) -> Option<&[f64]> {
        Some(&self.mass)
    }

    fn evaluate(&self, t: f64, y: &[f64], f: &mut [f64]) {
        let [a, b] = self.units;
        f.copy_from_slice(&[a * (t.cos() + y[1] - y[0]), b * (y[0] - y[1])]);
    }
}

#[test]
fn the_units_of_equations_with_a_mass_matrix_change_no_step() {
    let start = Moment::new(0.0, [0.0; 2]);
    let mut runs = [vec![], vec![]];
    for powers in [[0, 0], [30, 30], [-60, -60], [30, -30], [-30, 30]] {
        let units = powers.map(|power| 2.0_f64.powi(power));
        let field = Led { units, mass: [units[0], 0.0, 0.0, 0.0] };
        let control = control(1e-7);
        let methods: [Box<dyn AdaptiveMethod<[f64; 2]>>; 2] = [
            Box::new(RadauIia5::new(&field, control.clone(), start.clone()).unwrap()),
            Box::new(BackwardDifferences::new(&field, control, start.clone()).unwrap()),
        ];
        for (mut method, runs) in methods.into_iter().zip(&mut runs) {
            integrate(&mut *method, 3.0, |_| ControlFlow::Continue(())).unwrap();
            let y = method.moment().y;
            assert!(y.iter().all(|y| (y - 3.0_f64.sin()).abs() < 1e-5), "{powers:?}: {y:?}");
            runs.push((method.work().steps, method.work().rejected));
        }
    }
    for runs in runs {
        assert!(runs.iter().all(|run| *run == runs[0]), "{runs:?}");
    }
}

/// The same two equations, their sum and their difference, in unknowns that have units of their own.
struct Mixed {
    units: [f64; 2],
    mass: [f64; 4],
}

impl VectorField for Mixed {
    fn dim(&self) -> usize {
        2
    }

    fn mass(&self) -> Option<&[f64]> {
        Some(&self.mass)
    }

    fn evaluate(&self, t: f64, y: &[f64], f: &mut [f64]) {
        let [a, b] = [y[0] / self.units[0], y[1] / self.units[1]];
        let (led, held) = (t.cos() + b - a, a - b);
        f.copy_from_slice(&[led + held, led - held]);
    }
}

#[test]
fn the_units_of_unknowns_with_a_mass_matrix_change_no_step() {
    let mut runs = [vec![], vec![]];
    for powers in [[0, 0], [40, 40], [40, -40], [-40, 40]] {
        let units = powers.map(|power| 2.0_f64.powi(power));
        let field = Mixed { units, mass: [1.0 / units[0], 1.0 / units[0], 0.0, 0.0] };
        let tolerated = units.map(|unit| 1e-7 * unit).to_vec();
        let control: StepControl = Tolerance::componentwise(1e-7, tolerated).unwrap().into();
        let start = Moment::new(0.0, [0.0; 2]);
        let methods: [Box<dyn AdaptiveMethod<[f64; 2]>>; 2] = [
            Box::new(RadauIia5::new(&field, control.clone(), start.clone()).unwrap()),
            Box::new(BackwardDifferences::new(&field, control, start).unwrap()),
        ];
        for (mut method, runs) in methods.into_iter().zip(&mut runs) {
            integrate(&mut *method, 3.0, |_| ControlFlow::Continue(())).unwrap();
            runs.push((method.work().steps, method.work().rejected));
        }
    }
    for runs in runs {
        assert!(runs.iter().all(|run| *run == runs[0]), "{runs:?}");
    }
}
