//! Every integrator of bodies against every fact that it claims, on heavy tops and tethered bodies.

use std::f64::consts::TAU;

use nalgebra::{SMatrix, SVector, Vector3};
use stationary_calculus::{Covector, Potential};
use stationary_integrators::{
    Conservation, EnergyBehavior, ErrorGrowth, Evaluation, Integrator, Stability, State,
    Symplecticity,
};
use stationary_rigid::problems::{BodyProblem, kovalevskaya_top, nodding_top, tumbling_box};
use stationary_rigid::{
    Attachment, Body, BodyMethod, BodyMetric, BodyMotion, BodySpace, BodySpring, LieGroup,
    Orientations, Poses, RigidMotion, Rotation, right_jacobian, spatial_angular_momentum,
};

fn run<P: Potential, S: BodySpace>(
    problem: &BodyProblem<P, S>,
    method: BodyMethod,
    duration: f64,
    steps: u32,
    mut see: impl FnMut(&State<Vec<f64>>),
) -> State<Vec<f64>> {
    let mut state = problem.initial.clone();
    let mut integrator = method.integrator(&problem.system).unwrap();
    for _ in 0..steps {
        integrator.step(&mut state, duration / f64::from(steps)).unwrap();
        see(&state);
    }
    state
}

#[test]
fn the_error_on_a_heavy_top_has_the_claimed_order() {
    let problem = nodding_top().unwrap();
    // Against twice Munthe-Kaas at steps that leave errors below 1e-11.
    let path = |method, steps: u32, every: u32| {
        let (mut path, mut count) = (Vec::new(), 0);
        run(&problem, method, 0.5, steps, |state| {
            count += 1;
            if count % every == 0 {
                path.push(Orientations::pose_at(&state.q, 0).rotation);
            }
        });
        path
    };
    let exact = path(BodyMethod::MuntheKaas4, 64_000, 640);
    for &method in BodyMethod::ALL {
        let order = f64::from(method.facts().order);
        let steps = match method.facts().order {
            1 => 64_000,
            2 => 4_000,
            _ => 2_000,
        };
        let error = |steps: u32| {
            let path = path(method, steps, steps / 100);
            path.iter().zip(&exact).map(|(a, b)| a.direction_to(b).norm()).fold(0.0, f64::max)
        };
        let measured = (error(steps) / error(2 * steps)).log2();
        assert!((measured - order).abs() < 0.1, "{method}: {measured}");
    }
}

#[test]
fn only_the_variational_rotation_solves_equations() {
    let problem = nodding_top().unwrap();
    for &method in BodyMethod::ALL {
        let mut state = problem.initial.clone();
        let mut integrator = method.integrator(&problem.system).unwrap();
        let report = integrator.step(&mut state, 0.001).unwrap();
        let implicit = method.facts().evaluation == Evaluation::Implicit;
        assert_eq!(report.hessians > 0, implicit, "{method}");
        assert!(!report.suspects_the_hessian());
        let again = integrator.step(&mut state, 0.001).unwrap();
        assert_eq!(again.differentials, method.facts().stages, "{method}");
    }
}

#[test]
fn symmetric_methods_return_when_the_momentum_is_reversed() {
    let problem = kovalevskaya_top().unwrap();
    for &method in BodyMethod::ALL {
        let mut integrator = method.integrator(&problem.system).unwrap();
        let mut state = problem.initial.clone();
        let reverse = |state: &mut State<Vec<f64>>| state.p.0.iter_mut().for_each(|p| *p = -*p);
        integrator.step(&mut state, 0.03).unwrap();
        reverse(&mut state);
        integrator.step(&mut state, 0.03).unwrap();
        reverse(&mut state);
        let turn = |s: &State<Vec<f64>>| Orientations::pose_at(&s.q, 0).rotation;
        let miss = turn(&problem.initial).direction_to(&turn(&state)).norm()
            + (Vector3::from_column_slice(&state.p.0)
                - Vector3::from_column_slice(&problem.initial.p.0))
            .norm();
        assert_eq!(miss < 1e-14, method.facts().symmetric, "{method} misses by {miss:e}");
    }
}

/// A step in the chart `R = exp(theta)`, with the momentum of the chart, `T(theta)^T m`.
fn in_the_chart(
    integrator: &mut dyn Integrator<Vec<f64>>,
    y: &SVector<f64, 6>,
    h: f64,
) -> SVector<f64, 6> {
    let theta: Vector3<f64> = y.fixed_rows::<3>(0).into();
    let p: Vector3<f64> = y.fixed_rows::<3>(3).into();
    let m = right_jacobian(&theta).transpose().lu().solve(&p).unwrap();
    let q = Rotation::exp(theta).quaternion().to_vec();
    let mut state = State::new(q, Covector(m.as_slice().to_vec()));
    integrator.step(&mut state, h).unwrap();
    let theta = Orientations::pose_at(&state.q, 0).rotation.log();
    let p = right_jacobian(&theta).transpose() * Vector3::from_column_slice(&state.p.0);
    SVector::from_iterator(theta.iter().chain(p.iter()).copied())
}

#[test]
fn symplectic_methods_preserve_the_symplectic_form_and_no_others_do() {
    let problem = kovalevskaya_top().unwrap();
    let m = Vector3::from_column_slice(&problem.initial.p.0);
    let theta = problem.motion.pose.rotation.log();
    let p = right_jacobian(&theta).transpose() * m;
    let at = SVector::<f64, 6>::from_iterator(theta.iter().chain(p.iter()).copied());
    let mut form = SMatrix::<f64, 6, 6>::zeros();
    for i in 0..3 {
        form[(i, i + 3)] = 1.0;
        form[(i + 3, i)] = -1.0;
    }
    for &method in BodyMethod::ALL {
        let mut integrator = method.integrator(&problem.system).unwrap();
        let mut d = SMatrix::<f64, 6, 6>::zeros();
        for j in 0..6 {
            // Momenta are some hundred times smaller than angles here.
            let e = if j < 3 { 2e-3 } else { 2e-5 };
            let mut moved = |by: f64| {
                let mut y = at;
                y[j] += by;
                in_the_chart(&mut *integrator, &y, 0.1)
            };
            let (near, far) = (moved(e) - moved(-e), moved(2.0 * e) - moved(-2.0 * e));
            d.set_column(j, &((near * 8.0 - far) / (12.0 * e)));
        }
        let defect = (d.transpose() * form * d - form).amax();
        let symplectic = method.facts().symplecticity == Symplecticity::Symplectic;
        assert_eq!(defect < 1e-7, symplectic, "{method}: {defect:e}");
        assert!(symplectic || defect > 1e-5, "{method}: {defect:e} shows nothing");
    }
}

/// Two boxes tied to each other by a spring between points off their centres.
fn tethered() -> BodyProblem<BodySpring<Poses>, Poses> {
    let bodies = vec![
        Body::solid_box(1.0, [0.1, 0.2, 0.3]).unwrap(),
        Body::solid_box(0.5, [0.2, 0.1, 0.1]).unwrap(),
    ];
    let at = |x: f64, velocity, w| BodyMotion {
        pose: RigidMotion {
            translation: Vector3::new(x, 0.3, 0.0),
            rotation: Rotation::exp(Vector3::new(0.3, x, -0.8)),
        },
        velocity,
        angular_velocity: w,
    };
    let motions = [
        at(1.0, Vector3::new(0.0, 0.5, 0.2), Vector3::new(1.0, 2.0, 3.0)),
        at(-0.5, Vector3::new(0.1, -0.5, 0.3), Vector3::new(-2.0, 0.5, 1.0)),
    ];
    let ends = [
        Attachment::Body(0, Vector3::new(0.1, 0.2, 0.3)),
        Attachment::Body(1, Vector3::new(-0.2, 0.1, 0.1)),
    ];
    let potential = BodySpring::new(Poses, 2, 20.0, ends).unwrap();
    let metric = BodyMetric::new(bodies);
    let initial = metric.state(&motions).unwrap();
    let system = metric.under(potential).unwrap();
    BodyProblem { name: "tethered", system, initial, motion: motions[0], horizon: 10.0 }
}

#[test]
fn momenta_are_kept_where_the_facts_say_so_and_nowhere_else() {
    let problem = tethered();
    let linear = |s: &State<Vec<f64>>| {
        Vector3::from_column_slice(&s.p.0[..3]) + Vector3::from_column_slice(&s.p.0[6..9])
    };
    let (p, l) =
        (linear(&problem.initial), spatial_angular_momentum::<Poses>(&problem.initial).unwrap());
    for &method in BodyMethod::ALL {
        let mut drift = (0.0_f64, 0.0_f64);
        run(&problem, method, 1.0, 200, |state| {
            drift.0 = drift.0.max((linear(state) - p).norm());
            drift.1 = drift.1.max((spatial_angular_momentum::<Poses>(state).unwrap() - l).norm());
        });
        assert_eq!(method.facts().linear_momentum, Conservation::Exact);
        assert!(drift.0 < 1e-13, "{method}: {:e}", drift.0);
        let exact = method.facts().angular_momentum == Conservation::Exact;
        assert_eq!(drift.1 < 1e-13, exact, "{method}: {:e}", drift.1);
    }
}

#[test]
fn a_heavy_top_keeps_its_angular_momentum_about_the_vertical() {
    for problem in [nodding_top().unwrap(), kovalevskaya_top().unwrap()] {
        let vertical = |s: &State<Vec<f64>>| spatial_angular_momentum::<Orientations>(s).unwrap().z;
        let start = vertical(&problem.initial);
        for &method in BodyMethod::ALL {
            let mut drift = 0.0_f64;
            run(&problem, method, 1.0, 500, |s| drift = drift.max((vertical(s) - start).abs()));
            let exact = method.facts().angular_momentum == Conservation::Exact;
            assert_eq!(drift < 1e-13, exact, "{method} on {}: {drift:e}", problem.name);
        }
    }
}

#[test]
fn energy_behaves_as_the_facts_say() {
    let problem = tumbling_box().unwrap();
    let start = problem.energy(&problem.initial);
    for &method in BodyMethod::ALL {
        let left = problem.energy(&run(&problem, method, 10.0, 200, |_| {})) / start;
        let holds = match method.facts().energy {
            EnergyBehavior::Bounded => (left - 1.0).abs() < 2e-3,
            EnergyBehavior::Grows => left > 1.2,
            EnergyBehavior::Decays => left < 1.0 - 1e-8,
        };
        assert!(holds, "{method}: {left}");
    }
}

#[test]
fn energy_under_a_potential_stays_within_a_bound_that_falls_with_the_square_of_the_step() {
    for &method in BodyMethod::ALL.iter().filter(|m| m.facts().energy == EnergyBehavior::Bounded) {
        let problem = kovalevskaya_top().unwrap();
        let start = problem.energy(&problem.initial);
        let worst = |steps: u32, duration: f64| {
            let mut worst = 0.0_f64;
            run(&problem, method, duration, steps, |s| {
                worst = worst.max((problem.energy(s) - start).abs());
            });
            worst
        };
        let ratio = worst(4_000, 20.0) / worst(8_000, 20.0);
        assert!((ratio - 4.0).abs() < 0.2, "{method}: {ratio}");
        let growth = worst(40_000, 200.0) / worst(4_000, 20.0);
        assert!(growth < 1.5, "{method}: {growth}");
    }
}

/// A body on a spring to the origin, omega = 1, that starts at 1 with velocity 0.5.
fn sprung() -> BodyProblem<BodySpring<Poses>, Poses> {
    let metric = BodyMetric::<Poses>::new(vec![Body::solid_box(1.0, [0.1, 0.2, 0.3]).unwrap()]);
    let motion = BodyMotion {
        pose: RigidMotion { translation: Vector3::x(), rotation: Rotation::identity() },
        velocity: Vector3::x() * 0.5,
        angular_velocity: Vector3::zeros(),
    };
    let initial = metric.state(&[motion]).unwrap();
    let ends = [Attachment::World(Vector3::zeros()), Attachment::Body(0, Vector3::zeros())];
    let spring = BodySpring::new(Poses, 1, 1.0, ends).unwrap();
    let system = metric.under(spring).unwrap();
    BodyProblem { name: "sprung", system, initial, motion, horizon: 1.0 }
}

/// Its largest excursion over a thousand steps.
fn amplitude(method: BodyMethod, h: f64) -> f64 {
    let problem = sprung();
    let mut state = problem.initial.clone();
    let mut integrator = method.integrator(&problem.system).unwrap();
    let mut largest = 0.0_f64;
    for _ in 0..1000 {
        if integrator.step(&mut state, h).is_err() {
            return f64::INFINITY;
        }
        largest = largest.max(state.q[0].abs());
    }
    largest
}

#[test]
fn the_error_of_a_sprung_body_grows_as_the_facts_say() {
    let problem = sprung();
    for &method in BodyMethod::ALL {
        assert_eq!(method.facts().error_growth, ErrorGrowth::Linear);
        // Long enough for the drift to outgrow the bounded part of the error.
        let after = |periods: u32| {
            let (mut worst, mut step) = (0.0_f64, 0);
            let h = TAU / 100.0;
            run(&problem, method, TAU * f64::from(periods), 100 * periods, |state| {
                step += 1;
                let t = h * f64::from(step);
                worst = worst.max((state.q[0] - t.cos() - 0.5 * t.sin()).abs());
            });
            worst
        };
        let power = (after(400) / after(100)).log2() / 2.0;
        assert!((power - 1.0).abs() < 0.15, "{method}: t^{power}");
    }
}

#[test]
fn the_stability_limit_of_a_sprung_body_is_where_the_facts_say() {
    for &method in BodyMethod::ALL {
        let Stability::Below(limit) = method.facts().stability else {
            panic!("{method} has no limit");
        };
        assert!(amplitude(method, 0.999 * limit) < 100.0, "{method} below its limit");
        assert!(amplitude(method, 1.001 * limit) > 1e3, "{method} above its limit");
    }
}

#[test]
fn the_notes_update_visits_the_same_orientations_half_a_kick_apart() {
    // w_(i+1) from  T(-h w')^-T I w' = T(h w)^-T I w - h dV(theta_(i+1)):  kick by all of h, then
    // turn.
    let problem = nodding_top().unwrap();
    let h = 1e-3;
    let mut verlet = BodyMethod::VariationalRotation.integrator(&problem.system).unwrap();
    let mut state = problem.initial.clone();
    let body = *problem.body();
    let mut rotation = problem.motion.pose.rotation;
    let mut m = Vector3::from_column_slice(&problem.initial.p.0);
    let torque = |r: &Rotation| {
        let mut dv = Covector(vec![0.0; 3]);
        problem.system.potential().add_differential(&r.quaternion(), dv.view_mut());
        -Vector3::from_column_slice(&dv.0)
    };
    m += torque(&rotation) * (0.5 * h);
    for _ in 0..200 {
        verlet.step(&mut state, h).unwrap();
        // Newton's method on the notes' form, with the Jacobian by differences.
        let momentum = |w: &Vector3<f64>| {
            let t = right_jacobian(&(-w * h)).transpose();
            t.lu().solve(&body.angular_momentum(w)).unwrap()
        };
        let mut w = body.angular_velocity(&m);
        for _ in 0..20 {
            let off = momentum(&w) - m;
            w -= body.angular_velocity(&off);
        }
        rotation = rotation.walk(w * h);
        let after = right_jacobian(&(w * h)).transpose();
        m = after.lu().solve(&body.angular_momentum(&w)).unwrap() + torque(&rotation) * h;
        let seen = Orientations::pose_at(&state.q, 0).rotation;
        assert!(rotation.direction_to(&seen).norm() < 1e-12);
    }
}
