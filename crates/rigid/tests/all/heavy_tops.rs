//! Heavy tops against what is known of them in closed form.

use nalgebra::Vector3;
use stationary_rigid::problems::{
    KOVALEVSKAYA, TOP, kovalevskaya_top, nodding_top, precessing_top,
};
use stationary_rigid::{BodyMethod, BodySpace, Orientations, tilt};

const KEEPING: [BodyMethod; 3] =
    [BodyMethod::VariationalRotation, BodyMethod::AxisRotations, BodyMethod::ExactRotation];

#[test]
fn a_precessing_top_keeps_its_tilt_and_its_rate() {
    let problem = precessing_top().unwrap();
    let [slow, _] = TOP.steady_precession(0.5, 60.0).unwrap();
    for method in KEEPING {
        let mut state = problem.initial.clone();
        let mut integrator = method.integrator(&problem.system).unwrap();
        let (h, mut turned, mut azimuth) = (1e-4, 0.0, f64::NAN);
        for _ in 0..10_000 {
            integrator.step(&mut state, h).unwrap();
            let r = Orientations::pose_at(&state.q, 0).rotation;
            assert!((tilt(&r) - 0.5).abs() < 2e-5, "{method}: {}", tilt(&r));
            let axis = r.rotate(&Vector3::z());
            let now = axis.y.atan2(axis.x);
            if azimuth.is_finite() {
                turned += (now - azimuth + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
                    - std::f64::consts::PI;
            }
            azimuth = now;
        }
        let rate = turned / (9_999.0 * h);
        assert!((rate / slow - 1.0).abs() < 1e-4, "{method}: {rate} against {slow}");
    }
}

#[test]
fn a_nodding_top_stays_between_its_bounds_and_reaches_both() {
    let problem = nodding_top().unwrap();
    let m = Vector3::from_column_slice(problem.initial.p.components());
    let [low, high] = TOP.nutation(&problem.motion.pose.rotation, &m);
    assert!((low - 0.5).abs() < 1e-7 && high > 0.55, "{low} {high}");
    for method in KEEPING {
        let reach = |h: f64, steps: u32| {
            let mut state = problem.initial.clone();
            let mut integrator = method.integrator(&problem.system).unwrap();
            let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
            for _ in 0..steps {
                integrator.step(&mut state, h).unwrap();
                let angle = tilt(&Orientations::pose_at(&state.q, 0).rotation);
                (least, most) = (least.min(angle), most.max(angle));
            }
            (least - low, most - high)
        };
        let coarse = reach(1e-3, 5_000);
        assert!(coarse.0.abs() < 5e-4 && coarse.1.abs() < 5e-4, "{method}: {coarse:?}");
        let fine = reach(2.5e-4, 20_000);
        assert!(fine.1.abs() < 0.1 * coarse.1.abs() + 1e-6, "{method}: {coarse:?} {fine:?}");
    }
}

#[test]
fn kovalevskayas_integral_is_kept_to_the_order_and_without_trend() {
    let problem = kovalevskaya_top().unwrap();
    let integral = |state: &stationary_integrators::State<Vec<f64>>| {
        let m = Vector3::from_column_slice(state.p.components());
        let w = problem.body().angular_velocity(&m);
        KOVALEVSKAYA.integral(&Orientations::pose_at(&state.q, 0).rotation, &w)
    };
    let start = integral(&problem.initial);
    let worst = |method: BodyMethod, duration: f64, steps: u32| {
        let mut state = problem.initial.clone();
        let mut integrator = method.integrator(&problem.system).unwrap();
        let mut worst = 0.0_f64;
        for _ in 0..steps {
            integrator.step(&mut state, duration / f64::from(steps)).unwrap();
            worst = worst.max((integral(&state) / start - 1.0).abs());
        }
        worst
    };
    for &method in BodyMethod::ALL {
        let steps = match method.facts().order {
            1 => 64_000,
            2 => 8_000,
            _ => 500,
        };
        let (coarse, fine) = (worst(method, 4.0, steps), worst(method, 4.0, 2 * steps));
        let order = (coarse / fine).log2();
        // RK4's loss of an invariant is of an odd power, one above its order or less.
        let expected = f64::from(method.facts().order);
        assert!(order > expected - 0.15 && order < expected + 1.15, "{method}: {order}");
    }
    for method in KEEPING {
        let (short, long) = (worst(method, 20.0, 8_000), worst(method, 200.0, 80_000));
        assert!(long < 2.0 * short, "{method}: {short:e} {long:e}");
    }
}
