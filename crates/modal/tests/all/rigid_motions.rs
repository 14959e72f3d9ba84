//! How many motions cost nothing: under stress, on pins, under loads, and with a mass that is none.

use stationary_calculus::{
    Covector, DiagonalMetric, Metric, Potential, Sink, SparseError, Stencils, Vector,
};
use stationary_elasticity::{Spring, Strain};
use stationary_modal::problems::fixed_chain;
use stationary_modal::{Linearized, ModalError, RigidMotions};

/// The place where a function of one number has its zero, which it passes from below.
fn zero(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

fn spring(ends: [usize; 2], rest: f64, stiffness: f64) -> Spring {
    Spring::new(ends, rest, stiffness, Strain::Green).unwrap()
}

/// Corners of a cube of D dimensions with sides that are too long and diagonals that are too short,
/// at the size where they are at rest against each other; and how hard its first corner is pulled
/// by its sides alone.
fn stressed<const D: usize>() -> (Stencils<Spring, 2, D>, Vec<f64>) {
    let corners = 1_usize << D;
    let place = |v: usize, c: usize| (v >> c & 1) as f64;
    let mut springs = Vec::new();
    for (a, b) in (0..corners).flat_map(|b| (0..b).map(move |a| (a, b))) {
        let axes = (a ^ b).count_ones();
        let rest = f64::from(axes).sqrt() * if axes == 1 { 1.2 } else { 0.9 };
        springs.push(spring([a, b], rest, 1.0));
    }
    let cube = Stencils::<_, 2, D>::new(corners, Vec::new(), springs).unwrap();
    let sized = |s: f64| -> Vec<f64> {
        (0..corners).flat_map(|v| (0..D).map(move |c| s * (place(v, c) - 0.5))).collect()
    };
    let outward = |s: f64| {
        let mut dv = Covector(vec![0.0; corners * D]);
        cube.add_differential(&sized(s), dv.view_mut());
        // The last corner is the one whose coordinates are all positive.
        dv.0[corners * D - 1]
    };
    let q = sized(zero(outward, 0.5, 2.0));
    (cube, q)
}

#[test]
fn a_body_under_stress_of_its_own_still_turns_for_free() {
    let (square, q) = stressed::<2>();
    let metric = DiagonalMetric::new(vec![1.0; q.len()]).unwrap();
    let near_rest = Linearized::at(&metric, &square, &q, 1e-12).unwrap();
    assert_eq!(RigidMotions::of_points::<2>(&near_rest, q.as_chunks().0).unwrap().len(), 3);
    let (cube, q) = stressed::<3>();
    let metric = DiagonalMetric::new(vec![1.0; q.len()]).unwrap();
    let near_rest = Linearized::at(&metric, &cube, &q, 1e-12).unwrap();
    assert_eq!(RigidMotions::of_points::<3>(&near_rest, q.as_chunks().0).unwrap().len(), 6);
    // The stress is there: without the diagonals the sides would push.
    let force = 1.2 - (q[3] - q[0]).abs();
    assert!(force > 0.05, "{force}");
}

/// Springs and a weight on every second freedom, N.
struct Weighed(Stencils<Spring, 2, 2>, f64);

impl Potential for Weighed {
    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.0.energy(q) + self.1 * q.iter().skip(1).step_by(2).sum::<f64>()
    }

    fn add_differential(&self, q: &[f64], mut dv: Covector<&mut [f64]>) {
        self.0.add_differential(q, dv.view_mut());
        dv.0.iter_mut().skip(1).step_by(2).for_each(|f| *f += self.1);
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        self.0.add_hessian(q, hessian);
    }
}

#[test]
fn a_pin_leaves_the_turn_about_it_and_a_weight_takes_that_too() {
    let hanging = |weight: f64| {
        let pinned = spring([0, 1], 1.0, 3.0);
        let body = Stencils::<_, 2, 2>::new(1, vec![[0.0, 0.0]], vec![pinned]).unwrap();
        let body = Weighed(body, weight);
        let up = |y: f64| {
            let mut dv = Covector(vec![0.0; 2]);
            body.add_differential(&[0.0, y], dv.view_mut());
            dv.0[1]
        };
        let q = [0.0, zero(up, -3.0, -0.9)];
        let metric = DiagonalMetric::new(vec![2.0; 2]).unwrap();
        let near_rest = Linearized::at(&metric, &body, &q, 1e-12).unwrap();
        RigidMotions::of_points::<2>(&near_rest, q.as_chunks().0).unwrap().len()
    };
    assert_eq!((hanging(0.0), hanging(0.5)), (1, 0));
}

/// `1/2 v^2` on all freedoms, but with this much between the first two: definite below 1.
struct Coupled(usize, f64);

impl Metric for Coupled {
    fn dim(&self) -> usize {
        self.0
    }

    fn flat(&self, v: Vector<&[f64]>, p: Covector<&mut [f64]>) {
        p.0.copy_from_slice(v.0);
        p.0[0] += self.1 * v.0[1];
        p.0[1] += self.1 * v.0[0];
    }

    fn sharp(&self, p: Covector<&[f64]>, v: Vector<&mut [f64]>) {
        v.0.copy_from_slice(p.0);
        let determinant = 1.0 - self.1 * self.1;
        v.0[0] = (p.0[0] - self.1 * p.0[1]) / determinant;
        v.0[1] = (p.0[1] - self.1 * p.0[0]) / determinant;
    }

    fn add_matrix(&self, sink: &mut impl Sink) {
        sink.add_symmetric(&[0, 1], &[1.0, self.1, self.1, 1.0]);
        (2..self.0).for_each(|freedom| sink.add_symmetric(&[freedom], &[1.0]));
    }
}

#[test]
fn a_mass_that_is_not_positive_definite_is_an_error_that_names_a_freedom() {
    let problem = fixed_chain(5).unwrap();
    let at = |coupling: f64| {
        let metric = Coupled(5, coupling);
        Linearized::at(&metric, &problem.potential, &problem.q, 1e-12).map(|_| ())
    };
    assert_eq!(at(0.5), Ok(()));
    let refused = at(2.0);
    let freedom = |error: &ModalError| match error {
        ModalError::Mass(SparseError::NotPositiveDefinite { freedom }) => Some(*freedom),
        _ => None,
    };
    assert!(refused.as_ref().is_err_and(|e| freedom(e).is_some_and(|f| f < 2)), "{refused:?}");
}
