//! Where each method is stable, and what it does to fast motions.

use stationary_calculus::{Covector, Metric, Potential, System};
use stationary_integrators::problems::oscillator;
use stationary_integrators::{Damping, Integrator, Method, Nodes, Stability, State};

fn on<'s, M: Metric, P: Potential, const N: usize>(
    method: Method,
    system: &'s System<M, P>,
) -> Box<dyn Integrator<[f64; N]> + 's> {
    method.integrator(system).unwrap()
}

/// The matrix of one step on an oscillator of angular frequency 1, by rows.
///
/// What a method remembers of its last step is not in it: each column starts anew.
fn amplification(method: Method, h: f64) -> [[f64; 2]; 2] {
    let problem = oscillator(1.0).unwrap();
    let column = |q: f64, p: f64| {
        let mut state = State::new([q], Covector([p]));
        on(method, &problem.system).step(&mut state, h).unwrap();
        [state.q[0], state.p.0[0]]
    };
    let (q, p) = (column(1.0, 0.0), column(0.0, 1.0));
    [[q[0], p[0]], [q[1], p[1]]]
}

/// The largest size of an eigenvalue of the step's matrix.
fn spectral_radius(method: Method, h: f64) -> f64 {
    let [[a, b], [c, d]] = amplification(method, h);
    let (trace, determinant) = (a + d, a * d - b * c);
    let discriminant = 0.25 * trace * trace - determinant;
    match discriminant > 0.0 {
        true => 0.5 * trace.abs() + discriminant.sqrt(),
        false => determinant.sqrt(),
    }
}

#[test]
fn the_first_band_of_growth_begins_where_the_facts_say() {
    for &method in Method::ALL {
        let Stability::Below(limit) = method.facts().stability else { continue };
        // Where the trace touches 2, rounding of its last bit is half the digits of an eigenvalue.
        for part in 1..1000 {
            let radius = spectral_radius(method, 0.001 * f64::from(part) * limit);
            assert!(radius < 1.0 + 1e-6, "{method} at {part}/1000 of its limit: {radius}");
        }
        assert!(spectral_radius(method, 0.9999 * limit) < 1.0 + 1e-6, "{method} below its limit");
        let above = spectral_radius(method, 1.0001 * limit);
        assert!(above > 1.0 + 1e-4, "{method} above its limit: {above}");
    }
}

#[test]
fn methods_without_a_limit_are_stable_at_every_step_or_at_none() {
    for &method in Method::ALL {
        match method.facts().stability {
            Stability::Below(_) => {}
            Stability::Always => {
                for h in [0.1, 1.0, 10.0, 100.0, 1e3] {
                    // The midpoint rule's q is bounded by the energy of (q, p) alone.
                    let largest = amplitude(method, h);
                    assert!(largest < 1.2, "{method} at h omega = {h}: {largest}");
                }
            }
            Stability::Never => {
                for h in [0.1, 1.0] {
                    assert!(amplitude(method, h) > 100.0, "{method} at h omega = {h}");
                }
            }
        }
    }
}

/// What is left of a fast oscillation, and of a fast decay, is the same limit of one rational
/// function for the methods that have one: at infinity all directions meet.
#[test]
fn fast_motions_blow_up_stay_or_die_out_as_the_facts_say() {
    for &method in Method::ALL {
        let problem = oscillator(1.0).unwrap();
        let mut state = State::new([1.0], Covector([0.5]));
        let mut integrator = on(method, &problem.system);
        integrator.step(&mut state, 1e6).unwrap();
        let (q, p) = (state.q[0].abs(), state.p.0[0].abs());
        match method.facts().damping {
            Damping::Conditional => assert!(q > 1e3, "{method}: {q}"),
            Damping::AStable => assert!(q > 0.1 && q < 3.0, "{method}: {q}"),
            Damping::LStable => assert!(q < 1e-5 && p < 1e-5, "{method}: {q} {p}"),
        }
    }
}

/// The force of an inverted spring, +q: one motion decays as exp(-t), the other grows.
struct Inverted;

impl Potential for Inverted {
    fn dim(&self) -> usize {
        1
    }

    fn energy(&self, q: &[f64]) -> f64 {
        -0.5 * q[0] * q[0]
    }

    fn add_differential(&self, q: &[f64], dv: stationary_calculus::Covector<&mut [f64]>) {
        dv.0[0] -= q[0];
    }

    fn add_hessian(&self, _: &[f64], hessian: &mut impl stationary_calculus::Sink) {
        hessian.add_symmetric(&[0], &[-1.0]);
    }
}

#[test]
fn runge_kutta_methods_multiply_the_decaying_motion_by_their_stability_function() {
    // On the eigenvector (1, -1) a Runge-Kutta method gives R(-h), a partitioned one does not.
    let metric = stationary_calculus::DiagonalMetric::new([1.0]).unwrap();
    let system = System::new(metric, Inverted).unwrap();
    let z: f64 = 0.7;
    let square = z * z;
    let exact: [(Method, f64); 6] = [
        (Method::ExplicitEuler, 1.0 - z),
        (Method::ImplicitEuler, 1.0 / (1.0 + z)),
        (Method::Trapezoid, (1.0 - z / 2.0) / (1.0 + z / 2.0)),
        (Method::ImplicitMidpoint, (1.0 - z / 2.0) / (1.0 + z / 2.0)),
        (
            Method::GaussLegendre(Nodes::Two),
            (1.0 - z / 2.0 + square / 12.0) / (1.0 + z / 2.0 + square / 12.0),
        ),
        (Method::RungeKutta4, 1.0 - z + square / 2.0 - square * z / 6.0 + square * square / 24.0),
    ];
    for (method, factor) in exact {
        let mut state = State::new([1.0], Covector([-1.0]));
        on(method, &system).step(&mut state, z).unwrap();
        assert!((state.q[0] - factor).abs() < 1e-14, "{method}: {} {factor}", state.q[0]);
        assert!((state.p.0[0] + factor).abs() < 1e-14, "{method}: {} {factor}", state.p.0[0]);
    }
}

/// Largest size of an oscillator (omega = 1) over a thousand steps.
fn amplitude(method: Method, h: f64) -> f64 {
    let problem = oscillator(1.0).unwrap();
    let mut state = State::new([1.0], Covector([0.5]));
    let mut largest = 0.0_f64;
    let mut integrator = on(method, &problem.system);
    for _ in 0..1000 {
        if integrator.step(&mut state, h).is_err() {
            return f64::INFINITY;
        }
        largest = largest.max(state.q[0].abs());
    }
    largest
}

#[test]
fn explicit_symplectic_methods_are_unstable_above_two_over_omega() {
    for method in
        [Method::SymplecticEulerDriftKick, Method::SymplecticEulerKickDrift, Method::StormerVerlet]
    {
        assert_eq!(method.facts().stability, Stability::Below(2.0));
        // The eigenvalue of the step's matrix: 1 - x^2/2 -+ x sqrt(x^2/4 - 1) at h omega = x.
        let x: f64 = 2.1;
        let growth = x * x / 2.0 - 1.0 + x * (x * x / 4.0 - 1.0).sqrt();
        let ratio = (amplitude_after(method, x, 60) / amplitude_after(method, x, 50)).powf(0.1);
        assert!((ratio / growth - 1.0).abs() < 1e-6, "{method}: {ratio} against {growth}");
    }
}

fn amplitude_after(method: Method, h: f64, steps: usize) -> f64 {
    let problem = oscillator(1.0).unwrap();
    let mut state = State::new([1.0], Covector([0.5]));
    let mut integrator = on(method, &problem.system);
    for _ in 0..steps {
        integrator.step(&mut state, h).unwrap();
    }
    state.q[0].abs()
}

#[test]
fn runge_kutta_4_is_unstable_above_two_root_two_over_omega() {
    // The amplification of a step is |1 + iz + (iz)^2/2 + (iz)^3/6 + (iz)^4/24|.
    for (z, expected) in [(1.0, 0.9939), (2.8, 0.9307), (2.85, 1.0554)] {
        let pair = |n| {
            let problem = oscillator(1.0).unwrap();
            let mut state = State::new([1.0], Covector([0.0]));
            let mut integrator = on(Method::RungeKutta4, &problem.system);
            for _ in 0..n {
                integrator.step(&mut state, z).unwrap();
            }
            state.q[0].hypot(state.p.0[0])
        };
        assert!((pair(11) / pair(10) - expected).abs() < 1e-4, "{}", pair(11) / pair(10));
    }
}
