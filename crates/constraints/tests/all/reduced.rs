//! Reduced coordinates: against the explicit angle, against closed forms, against multipliers.

use stationary_calculus::{Covector, DiagonalMetric, Energy, Metric, Number, System, Vector};
use stationary_constraints::problems::{RodProblem, pendulum};
use stationary_constraints::{
    ArcsinePendulum, ConstrainedIntegrator, ConstraintError, Dense, Embedding, Links, Rattle,
    Reduced, Redundancy, Rod, Rods, Sampling, Weight,
};
use stationary_integrators::problems::DoublePendulum;
use stationary_integrators::{
    Integrator, Quadrature, Sampled, State, StepError, UniformGravity, Variational,
};
use stationary_measure::loglog_slope;

fn single(sampling: Sampling) -> Reduced<Links<1>, Weight<1>, 1, 2> {
    let weight = Weight { masses: [2.0], gravity: 9.81 };
    Reduced::new(Links::new([0.5]), [2.0; 2], weight, sampling).unwrap()
}

fn double(sampling: Sampling) -> Reduced<Links<2>, Weight<2>, 2, 4> {
    let weight = Weight { masses: [1.0; 2], gravity: 1.0 };
    Reduced::new(Links::new([1.0; 2]), [1.0; 4], weight, sampling).unwrap()
}

#[test]
fn the_explicit_angle_is_the_variational_integrator_of_the_chord() {
    let explicit = ArcsinePendulum::new(2.0, 0.5, 9.81).unwrap();
    let mut variational = Variational::new(single(Sampling::Later)).unwrap();
    let mut a = State::new([1.2], Covector([0.3]));
    let mut b = a.clone();
    for _ in 0..1000 {
        explicit.step(&mut a, 0.01).unwrap();
        variational.step(&mut b, 0.01).unwrap();
        assert!((a.q[0] - b.q[0]).abs() < 1e-11 && (a.p.0[0] - b.p.0[0]).abs() < 1e-11);
    }
}

#[test]
fn metric_and_momentum_are_pulled_back() {
    let reduced = double(Sampling::Both);
    let (s, rate) = ([0.7_f64, -1.9], Vector([0.4, 1.3]));
    // M_s = [2, cos(a - b); cos(a - b), 1] for unit masses and rods.
    let c = (s[0] - s[1]).cos();
    let p = reduced.momentum(s, rate).0;
    assert!((p[0] - (2.0 * 0.4 + c * 1.3)).abs() < 1e-14);
    assert!((p[1] - (c * 0.4 + 1.3)).abs() < 1e-14);
    let metric = reduced.metric(s).unwrap();
    let mut q = Covector([0.0; 2]);
    metric.flat(rate.view(), q.view_mut());
    assert!(q.0.iter().zip(&p).all(|(a, b)| (a - b).abs() < 1e-14));
    let kinetic = 0.5 * (p[0] * 0.4 + p[1] * 1.3);
    let height = -2.0 * s[0].cos() - s[1].cos();
    assert!((reduced.total_energy(s, rate) - kinetic - height).abs() < 1e-14);
}

#[test]
fn the_mean_of_both_ends_has_order_two_and_the_later_end_order_one() {
    let exact = pendulum(1.9).unwrap();
    for (sampling, expected) in [(Sampling::Later, 1.0), (Sampling::Both, 2.0)] {
        let weight = Weight { masses: [1.0], gravity: 1.0 };
        let reduced =
            Reduced::<_, _, 1, 2>::new(Links::new([1.0]), [1.0; 2], weight, sampling).unwrap();
        let mut points = Vec::new();
        for steps in [200_u32, 400, 800, 1600] {
            let h = exact.period / f64::from(steps);
            let mut method = Variational::new(reduced.clone()).unwrap();
            let mut state = State::new([exact.angle(0.7)], Covector([exact.rate(0.7)]));
            state.t = 0.7;
            let mut worst = 0.0_f64;
            for _ in 0..steps {
                method.step(&mut state, h).unwrap();
                worst = worst.max((state.q[0] - exact.angle(state.t)).abs());
            }
            points.push((h, worst));
        }
        let order = loglog_slope(&points).unwrap();
        assert!((order - expected).abs() < 0.1, "{sampling:?}: {order}");
    }
}

/// Two unit masses on unit rods, let go a radian from hanging: tame over a swing.
fn with_rods() -> RodProblem<[f64; 4]> {
    let metric = DiagonalMetric::new([1.0; 4]).unwrap();
    let gravity = UniformGravity { acceleration: [0.0, -1.0], masses: vec![1.0; 2] };
    let links = vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 1.0)];
    let rods = Rods::new(2, vec![[0.0; 2]], links).unwrap();
    let initial = State::new(double(Sampling::Both).places(ANGLES), Covector([0.0; 4]));
    RodProblem { system: System::new(metric, gravity).unwrap(), rods, initial }
}

const ANGLES: [f64; 2] = [1.0, 1.0];

/// How far RATTLE is from a double pendulum in angles after some time.
fn apart(angles: &mut impl Integrator<[f64; 2]>, time: f64, steps: u32) -> f64 {
    let RodProblem { system, rods, initial } = with_rods();
    let choice = Dense::<2>(Redundancy::Refuse);
    let mut rattle = Rattle::new(&system, rods, &initial, choice).unwrap();
    let h = time / f64::from(steps);
    let (mut a, mut b) = (initial, State::new(ANGLES, Covector([0.0; 2])));
    for _ in 0..steps {
        rattle.step(&mut a, h).unwrap();
        angles.step(&mut b, h).unwrap();
    }
    let places = double(Sampling::Both).places(b.q);
    a.q.iter().zip(&places).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn rattle_visits_the_configurations_of_the_chord_in_angles() {
    for steps in [100, 1000] {
        let mut angles = Variational::new(double(Sampling::Both)).unwrap();
        assert!(apart(&mut angles, 10.0, steps) < 1e-11);
    }
}

#[test]
fn the_double_pendulum_is_the_same_with_angles_and_with_multipliers() {
    // In angles by another rule: the exact kinetic energy, looked at midway.
    let angles = || {
        let (lagrangian, quadrature) = (DoublePendulum, Quadrature::Middle);
        Variational::new(Sampled { lagrangian, quadrature }).unwrap()
    };
    let points: Vec<_> = [200, 400, 800]
        .into_iter()
        .map(|steps| (2.0 / f64::from(steps), apart(&mut angles(), 2.0, steps)))
        .collect();
    let order = loglog_slope(&points).unwrap();
    assert!((order - 2.0).abs() < 0.1, "{order}: {points:?}");
    assert!(apart(&mut angles(), 2.0, 40_000) < 1e-8);
}

/// Latitude and longitude on the unit sphere.
#[derive(Clone, Copy, Debug)]
struct Globe;

impl Embedding<2, 3> for Globe {
    fn places<R: Number>(&self, [latitude, longitude]: [R; 2]) -> [R; 3] {
        let c = latitude.cos();
        [c * longitude.cos(), c * longitude.sin(), latitude.sin()]
    }
}

struct Free;

impl<const N: usize> Energy<N> for Free {
    fn energy<R: Number>(&self, _: [R; N]) -> R {
        R::from(0.0)
    }
}

#[test]
fn the_place_that_has_no_slope_is_named() {
    /// The second place is the root of the second coordinate.
    struct Root;
    impl Embedding<2, 2> for Root {
        fn places<R: Number>(&self, [x, y]: [R; 2]) -> [R; 2] {
            [x, y.sqrt()]
        }
    }
    let root = Reduced::new(Root, [1.0; 2], Free, Sampling::Both).unwrap();
    assert!(root.metric([0.0, 1.0]).is_ok());
    let error = root.metric([0.0, 0.0]).map(|_| ()).unwrap_err();
    let what = "embedding's differential";
    assert_eq!(error, ConstraintError::NonFinite { what, index: 1 });
}

#[test]
fn coordinates_are_refused_where_they_are_singular() {
    let globe = Reduced::new(Globe, [1.0; 3], Free, Sampling::Both).unwrap();
    assert!(globe.metric([0.3, 0.0]).is_ok());
    let pole = std::f64::consts::FRAC_PI_2;
    let error = globe.metric([pole, 0.0]).map(|_| ()).unwrap_err();
    let ConstraintError::SingularCoordinates { ratio } = error else { panic!("{error}") };
    assert!(ratio < 1e-15);
    let mut method = Variational::new(globe).unwrap();
    let mut state = State::new([pole, 0.0], Covector([0.0, 1.0]));
    let error = method.step(&mut state, 0.1).unwrap_err();
    let named = matches!(error, StepError::SingularLegendreTransform | StepError::Newton(_));
    assert!(named, "{error}");
    assert_eq!(state, State::new([pole, 0.0], Covector([0.0, 1.0])));
}
