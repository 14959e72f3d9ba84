//! Trigonometric methods: what is exact, what is kept, and where each filter resonates.

use nalgebra::{DMatrix, dmatrix};
use stationary_calculus::{
    BilinearForm, Covector, DiagonalMetric, Potential, Sink, SizeError, System,
};
use stationary_integrators::problems::{Linear, PendulumPotential};
use stationary_integrators::{
    Conservation, Filter, Gautschi, Integrator, NewtonianGravity, State, StiffnessError,
    Symplecticity, angular_momentum, linear_momentum,
};

const FILTERS: [Filter; 4] = [Filter::Impulse, Filter::Mollified, Filter::Gautschi, Filter::Long];

/// Freedoms that nothing pulls.
struct Free(usize);

impl Potential for Free {
    fn dim(&self) -> usize {
        self.0
    }

    fn energy(&self, _: &[f64]) -> f64 {
        0.0
    }

    fn add_differential(&self, _: &[f64], _: Covector<&mut [f64]>) {}

    fn add_hessian(&self, _: &[f64], _: &mut impl Sink) {}
}

/// Two angles that feel each other: 1 - cos(q0 - q1).
struct Coupled;

impl Potential for Coupled {
    fn dim(&self) -> usize {
        2
    }

    fn energy(&self, q: &[f64]) -> f64 {
        1.0 - (q[0] - q[1]).cos()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let pull = (q[0] - q[1]).sin();
        dv.0[0] += pull;
        dv.0[1] -= pull;
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let k = (q[0] - q[1]).cos();
        hessian.add_symmetric(&[0, 1], &[k, -k, -k, k]);
    }
}

#[test]
fn without_a_soft_force_every_step_is_exact() {
    // Masses 1 and 4 on a spring of stiffness 3, which leaves their centre free.
    let system = System::new(DiagonalMetric::new([1.0, 4.0]).unwrap(), Free(2)).unwrap();
    let stiffness = BilinearForm(dmatrix![3.0, -3.0; -3.0, 3.0]);
    let w = (3.0_f64 * 1.25).sqrt();
    for filter in FILTERS {
        for h in [0.01, 1.0, 1e3] {
            let mut method = Gautschi::new(&system, &stiffness, filter).unwrap();
            let mut state = State::new([1.0, 0.0], Covector([0.5, 1.0]));
            method.step(&mut state, h).unwrap();
            // The centre moves at 0.3, the extension q0 - q1 turns with 1 and 0.25.
            let centre = 0.2 + 0.3 * h;
            let extension = (w * h).cos() + 0.25 / w * (w * h).sin();
            let exact = [centre + 0.8 * extension, centre - 0.2 * extension];
            for (q, exact) in state.q.iter().zip(exact) {
                assert!((q - exact).abs() < 1e-12 * h.max(1.0), "{filter:?} {h}: {q} {exact}");
            }
        }
    }
}

/// The state after the time 1 in equal steps, on a stiff pair of pendulums.
fn after(filter: Filter, start: &State<[f64; 2]>, h: f64, steps: u32) -> State<[f64; 2]> {
    let system = System::new(DiagonalMetric::new([1.0, 2.0]).unwrap(), Coupled).unwrap();
    let stiffness = BilinearForm(dmatrix![2.0, -1.0; -1.0, 4.0]);
    let mut method = Gautschi::new(&system, &stiffness, filter).unwrap();
    let mut state = start.clone();
    for step in 0..steps {
        let report = method.step(&mut state, h).unwrap();
        assert_eq!(report.differentials, if step == 0 { 2 } else { 1 });
    }
    state
}

#[test]
fn every_filter_has_order_2_and_returns_when_the_momentum_is_reversed() {
    let start = State::new([1.0, -0.4], Covector([0.3, 0.9]));
    for filter in FILTERS {
        let ends = [40, 80, 160].map(|n| after(filter, &start, 1.0 / f64::from(n), n).q[0]);
        let order = ((ends[0] - ends[1]) / (ends[1] - ends[2])).log2();
        assert!((order - 2.0).abs() < 0.05, "{filter:?}: {order}");
        let mut there = after(filter, &start, 0.3, 5);
        there.p.0 = there.p.0.map(|p| -p);
        let back = after(filter, &there, 0.3, 5);
        assert!((back.q[0] - 1.0).abs() + (back.p.0[1] + 0.9).abs() < 1e-13, "{filter:?}");
    }
}

#[test]
fn the_symplectic_filters_preserve_the_symplectic_form_and_the_others_do_not() {
    let metric = DiagonalMetric::new([1.0, 2.0]).unwrap();
    let system = System::new(metric, Coupled).unwrap();
    let stiffness = BilinearForm(dmatrix![2.0, -1.0; -1.0, 4.0]);
    for filter in FILTERS {
        let map = |y: [f64; 4]| {
            let state = after(filter, &State::new([y[0], y[1]], Covector([y[2], y[3]])), 0.8, 1);
            [state.q[0], state.q[1], state.p.0[0], state.p.0[1]]
        };
        let column = |j: usize| {
            let moved = |by: f64| {
                let mut y = [1.0, -0.4, 0.3, 0.9];
                y[j] += by;
                map(y)
            };
            let (a, b) = (moved(1e-4), moved(-1e-4));
            std::array::from_fn::<f64, 4, _>(|i| (a[i] - b[i]) / 2e-4)
        };
        let d = [0, 1, 2, 3].map(column);
        let form =
            |x: &[f64; 4], y: &[f64; 4]| x[0] * y[2] + x[1] * y[3] - x[2] * y[0] - x[3] * y[1];
        let off =
            (form(&d[0], &d[2]) - 1.0).abs() + form(&d[0], &d[1]).abs() + form(&d[0], &d[3]).abs();
        let method = Gautschi::<_, _, [f64; 2]>::new(&system, &stiffness, filter).unwrap();
        let claimed = method.facts().symplecticity == Symplecticity::Symplectic;
        assert_eq!(off < 1e-6, claimed, "{filter:?}: {off:e}");
    }
}

/// Whether a soft spring of stiffness 1 beside a stiff one of angular frequency `w` makes a step of
/// `h` grow: the trace of the step's matrix beyond 2.
fn grows(filter: Filter, w: f64, h: f64) -> bool {
    let metric = DiagonalMetric::new([1.0]).unwrap();
    let system = System::new(metric, Linear::<1> { stiffness: 1.0 }).unwrap();
    let stiffness = BilinearForm(dmatrix![w * w]);
    let mut method = Gautschi::new(&system, &stiffness, filter).unwrap();
    let mut column = |q: f64, p: f64| {
        let mut state = State::new([q], Covector([p]));
        method.step(&mut state, h).unwrap();
        (state.q[0], state.p.0[0])
    };
    (column(1.0, 0.0).0 + column(0.0, 1.0).1).abs() > 2.0 + 1e-9
}

#[test]
fn each_filter_resonates_where_it_says() {
    use std::f64::consts::PI;
    let h = 0.5;
    for (filter, resonant) in [
        (Filter::Impulse, vec![1, 2, 3, 4]),
        (Filter::Gautschi, vec![1, 3]),
        (Filter::Mollified, vec![]),
        (Filter::Long, vec![]),
    ] {
        let mut seen = Vec::new();
        for i in 100..1400 {
            let x = 0.01 * f64::from(i);
            if grows(filter, x / h, h) {
                let k = (x / PI).round() as i32;
                assert!((x - PI * f64::from(k)).abs() < 0.4, "{filter:?} grows at h w = {x}");
                seen.push(k);
            }
        }
        seen.dedup();
        assert_eq!(seen, resonant, "{filter:?}");
    }
}

#[test]
fn linear_momentum_is_kept_by_every_filter_and_angular_by_the_symplectic_ones() {
    // Three bodies that attract each other, two of them on a spring without rest length.
    let masses = vec![1.0, 0.5, 0.8];
    let metric = DiagonalMetric::particles::<2>(&masses).unwrap();
    let system =
        System::new(metric, NewtonianGravity::<2> { constant: 1.0, masses, fixed: Vec::new() })
            .unwrap();
    let mut stiffness = DMatrix::zeros(6, 6);
    for c in 0..2 {
        for (i, j, k) in [(c, c, 9.0), (c, c + 2, -9.0), (c + 2, c, -9.0), (c + 2, c + 2, 9.0)] {
            stiffness[(i, j)] = k;
        }
    }
    let stiffness = BilinearForm(stiffness);
    for filter in FILTERS {
        let mut method = Gautschi::new(&system, &stiffness, filter).unwrap();
        let q = vec![0.5, 0.1, -0.6, 0.0, 0.2, 3.0];
        let mut state = State::new(q, Covector(vec![0.1, 0.8, 0.0, -0.4, -0.7, 0.2]));
        let (linear, angular) = (linear_momentum::<2>(&state), angular_momentum::<2>(&state)[2]);
        for _ in 0..1000 {
            method.step(&mut state, 0.05).unwrap();
        }
        let end = linear_momentum::<2>(&state);
        assert!((end[0] - linear[0]).hypot(end[1] - linear[1]) < 1e-12, "{filter:?}");
        let drift = (angular_momentum::<2>(&state)[2] - angular).abs();
        let exact = method.facts().angular_momentum == Conservation::Exact;
        assert_eq!(drift < 1e-11, exact, "{filter:?}: {drift:e}");
    }
}

#[test]
fn a_stiffness_that_is_none_is_refused_by_name() {
    let system = System::new(DiagonalMetric::new([1.0]).unwrap(), PendulumPotential).unwrap();
    let refused = |k| {
        Gautschi::<_, _, [f64; 1]>::new(&system, &BilinearForm(k), Filter::Impulse).unwrap_err()
    };
    assert!(matches!(refused(dmatrix![-1.0]), StiffnessError::Negative { eigenvalue: -1.0 }));
    assert!(matches!(refused(dmatrix![f64::NAN]), StiffnessError::Eigen(_)));
    let error = refused(dmatrix![1.0, 0.0; 0.0, 1.0]);
    assert!(
        matches!(error, StiffnessError::Size(SizeError { expected: 1, got: 2, .. })),
        "{error}"
    );
}

#[test]
fn a_soft_spring_stays_one_beside_a_stiff_one_that_does_not_touch_it() {
    let system = System::new(DiagonalMetric::new([1.0; 3]).unwrap(), Free(3)).unwrap();
    for stiff in [1.0, 1e10, 1e14, 1e18] {
        let stiffness =
            BilinearForm(dmatrix![stiff, -stiff, 0.0; -stiff, stiff, 0.0; 0.0, 0.0, 1.0]);
        let mut method = Gautschi::new(&system, &stiffness, Filter::Long).unwrap();
        let mut state = State::new([0.0, 0.0, 1.0], Covector([1.0, 1.0, 0.0]));
        for _ in 0..10 {
            method.step(&mut state, 0.5).unwrap();
        }
        let (free, soft) = (state.q[0], state.q[2]);
        assert!((free - 5.0).abs() < 1e-12, "{stiff}: {free}");
        assert!((soft - 5.0_f64.cos()).abs() < 1e-12, "{stiff}: {soft}");
    }
    let falling = BilinearForm(DMatrix::from_diagonal(&[1e14, -1.0, 0.0].to_vec().into()));
    let refused =
        Gautschi::new(&system, &falling, Filter::Long).map(|_: Gautschi<'_, _, _, [f64; 3]>| ());
    assert_eq!(refused, Err(StiffnessError::Negative { eigenvalue: -1.0 }));
}
