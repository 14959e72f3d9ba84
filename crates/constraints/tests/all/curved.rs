//! A constraint where configurations do not add: a body with a place and a unit quaternion, hung
//! from a ball joint.

use stationary_calculus::{
    Covector, Curved, DiagonalMetric, Metric, Potential, PotentialOn, Sink, SizeError, Space,
    System, Vector, assert_derivatives_on,
};
use stationary_constraints::problems::pendulum;
use stationary_constraints::{
    ConstrainedIntegrator, Constraint, ConstraintError, ConstraintOn, Dense, FreeMotion, Pairing,
    Projection, Rattle, Redundancy, Rows, Scale,
};
use stationary_integrators::{State, StepError};
use stationary_measure::loglog_slope;

/// Poses: a place in the world (3), a quaternion, scalar first (4); velocities (3), and turning
/// rates in body axes (3).
#[derive(Clone, Copy, Debug)]
struct Poses;

fn product(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

fn quaternion(q: &[f64]) -> [f64; 4] {
    [q[3], q[4], q[5], q[6]]
}

/// The vector `r` of the body, in the world.
fn turned(q: &[f64], r: [f64; 3]) -> [f64; 3] {
    let k = quaternion(q);
    let [_, x, y, z] = product(product(k, [0.0, r[0], r[1], r[2]]), [k[0], -k[1], -k[2], -k[3]]);
    [x, y, z]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl Curved for Poses {}

/// The free motion of bodies whose moments are equal about all axes: their momenta do not turn.
#[derive(Clone, Copy, Debug)]
struct EqualMoments;

impl FreeMotion<DiagonalMetric<Vec<f64>>, Poses> for EqualMoments {
    fn advance(
        &mut self,
        metric: &DiagonalMetric<Vec<f64>>,
        space: &Poses,
        (_, h): (f64, f64),
        q: &mut [f64],
        p: Covector<&mut [f64]>,
        mut room: Vector<&mut [f64]>,
    ) -> Result<(), StepError> {
        metric.drift(h, p.view(), room.view_mut());
        space.advance(q, 1.0, room.view());
        Ok(())
    }
}

impl Space for Poses {
    fn stored(&self, freedoms: usize) -> usize {
        freedoms / 6 * 7
    }

    fn advance(&self, q: &mut [f64], h: f64, v: Vector<&[f64]>) {
        q.iter_mut().zip(&v.0[..3]).for_each(|(x, v)| *x += h * v);
        let w = [v.0[3], v.0[4], v.0[5]];
        let angle = h * w[0].hypot(w[1]).hypot(w[2]);
        let half = if angle == 0.0 { 0.5 * h } else { h * (0.5 * angle).sin() / angle };
        let turn = [(0.5 * angle).cos(), half * w[0], half * w[1], half * w[2]];
        let next = product(quaternion(q), turn);
        let length = next.iter().map(|x| x * x).sum::<f64>().sqrt();
        q[3..7].copy_from_slice(&next.map(|x| x / length));
    }
}

const MASS: f64 = 2.0;
const INERTIA: f64 = 0.3;
const ARM: f64 = 0.8;
const GRAVITY: f64 = 9.81;
/// From the centre to the joint, in body axes.
const JOINT: [f64; 3] = [0.0, 0.0, ARM];

/// The point of the body at the joint stays at the origin.
#[derive(Clone, Copy, Debug)]
struct BallJoint;

impl ConstraintOn<Poses> for BallJoint {}

impl Constraint for BallJoint {
    fn dim(&self) -> usize {
        6
    }

    fn count(&self) -> usize {
        3
    }

    fn value(&self, _: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        let r = turned(q, JOINT);
        for c in 0..3 {
            g[c] = q[c] + r[c];
        }
        Ok(())
    }

    fn differential(&self, _: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        // Column by column: R (e_c x r).
        let columns: [[f64; 3]; 3] = std::array::from_fn(|c| {
            let mut e = [0.0; 3];
            e[c] = 1.0;
            turned(q, cross(e, JOINT))
        });
        for row in 0..3 {
            rows.add(row, row, 1.0);
            for (c, column) in columns.iter().enumerate() {
                rows.add(row, 3 + c, column[row]);
            }
        }
        Ok(())
    }

    fn add_hessian(
        &self,
        _: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        // <lambda, R (w x (w x r))> = (l . w)(r . w) - (l . r)(w . w) with l = R^T lambda.
        let k = quaternion(q);
        let back = [q[0], q[1], q[2], k[0], -k[1], -k[2], -k[3]];
        let (l, r) = (turned(&back, [lambda[0], lambda[1], lambda[2]]), JOINT);
        let dot: f64 = (0..3).map(|c| l[c] * r[c]).sum();
        let mut block = [0.0; 9];
        for (k, entry) in block.iter_mut().enumerate() {
            let (i, j) = (k % 3, k / 3);
            *entry = 0.5 * (l[i] * r[j] + l[j] * r[i]) - if i == j { dot } else { 0.0 };
        }
        hessian.add_symmetric(&[3, 4, 5], &block);
        Ok(())
    }

    fn scale(&self, _: usize) -> Scale {
        Scale { length: ARM, ..Scale::default() }
    }
}

/// The body's weight.
#[derive(Clone, Copy, Debug)]
struct Weight;

impl PotentialOn<Poses> for Weight {}

impl Potential for Weight {
    fn dim(&self) -> usize {
        6
    }

    fn energy(&self, q: &[f64]) -> f64 {
        MASS * GRAVITY * q[2]
    }

    fn add_differential(&self, _: &[f64], dv: Covector<&mut [f64]>) {
        dv.0[2] += MASS * GRAVITY;
    }

    fn add_hessian(&self, _: &[f64], _: &mut impl Sink) {}
}

fn system() -> System<DiagonalMetric<Vec<f64>>, Weight, Poses> {
    let mass = vec![MASS, MASS, MASS, INERTIA, INERTIA, INERTIA];
    System::on(Poses, DiagonalMetric::new(mass).unwrap(), Weight).unwrap()
}

/// Hanging, and turning about the y axis at a rate; with a spin about its own axis.
fn hanging(rate: f64, spin: f64) -> State<Vec<f64>> {
    let q = vec![0.0, 0.0, -ARM, 1.0, 0.0, 0.0, 0.0];
    // The centre moves with w x (centre - joint).
    let v = cross([0.0, rate, 0.0], [0.0, 0.0, -ARM]);
    let p = [MASS * v[0], MASS * v[1], MASS * v[2], 0.0, INERTIA * rate, INERTIA * spin];
    State { t: 0.0, q, p: Covector(p.to_vec()) }
}

#[test]
fn the_differentials_are_taken_along_the_motions_of_the_space() {
    let mut q = hanging(0.0, 0.0).q;
    Poses.advance(&mut q, 1.0, Vector(&[0.3, -0.2, 0.5, 0.7, -1.1, 0.4]));
    let pairing = Pairing::new(BallJoint, vec![0.7, -1.3, 2.0], 0.0).unwrap();
    assert_derivatives_on(&Poses, &pairing, &q);
}

#[test]
fn a_body_on_a_ball_joint_swings_as_a_physical_pendulum_with_order_two() {
    // theta'' = -omega^2 sin theta with omega^2 = m g l/(I + m l^2), for the same inertia about all
    // axes; so its angle is the unit pendulum's at the time omega t.
    let omega = (MASS * GRAVITY * ARM / (INERTIA + MASS * ARM * ARM)).sqrt();
    let exact = pendulum(1.5).unwrap();
    let system = system();
    let initial = hanging(-1.5 * omega, 0.0);
    let mut points = Vec::new();
    for steps in [200_u32, 400, 800] {
        let h = exact.period / omega / f64::from(steps);
        let choice = Dense::<3>(Redundancy::Refuse);
        let mut rattle = Rattle::along(EqualMoments, &system, BallJoint, &initial, choice).unwrap();
        let mut state = initial.clone();
        let mut worst = 0.0_f64;
        for _ in 0..steps {
            let report = rattle.step(&mut state, h).unwrap();
            assert!(report.violation <= 1e-12 + 8.0 * f64::EPSILON / ARM);
            let [x, y] = exact.place(omega * state.t);
            worst = worst.max((state.q[0] - ARM * x).hypot(state.q[2] - ARM * y));
            assert!(state.q[1].abs() < 1e-12);
        }
        points.push((h, worst));
    }
    let order = loglog_slope(&points).unwrap();
    assert!((order - 2.0).abs() < 0.1, "{order}: {points:?}");
}

#[test]
fn angular_momentum_about_the_vertical_is_kept_to_rounding() {
    let system = system();
    let initial = hanging(2.0, 3.0);
    let mut state = initial.clone();
    let choice = Dense::<3>(Redundancy::Refuse);
    let mut rattle = Rattle::along(EqualMoments, &system, BallJoint, &initial, choice).unwrap();
    let about_vertical = |state: &State<Vec<f64>>| {
        let (q, p) = (&state.q, &state.p.0);
        q[0] * p[1] - q[1] * p[0] + turned(q, [p[3], p[4], p[5]])[2]
    };
    let start = about_vertical(&state);
    let mut worst = 0.0_f64;
    for _ in 0..5000 {
        rattle.step(&mut state, 0.002).unwrap();
        worst = worst.max((about_vertical(&state) - start).abs());
    }
    assert!(worst < 1e-12, "{worst:e}");
}

#[test]
fn a_pose_is_projected_along_the_motions_of_the_space() {
    let system = system();
    let mut state = hanging(1.0, 0.0);
    Poses.advance(&mut state.q, 1.0, Vector(&[0.05, -0.02, 0.04, 0.1, -0.2, 0.1]));
    let choice = Dense::<3>(Redundancy::Refuse);
    let error = Rattle::along(EqualMoments, &system, BallJoint, &state, choice).unwrap_err();
    assert!(matches!(error, ConstraintError::Infeasible { .. }), "{error}");
    let mut projection = Projection::new(&system, BallJoint, &state, choice).unwrap();
    let report = projection.project(&mut state).unwrap();
    assert!(report.violation < 1e-14, "{report:?}");
    let length: f64 = state.q[3..].iter().map(|x| x * x).sum();
    assert!((length - 1.0).abs() < 1e-14);
    Rattle::along(EqualMoments, &system, BallJoint, &state, choice).unwrap();
}
