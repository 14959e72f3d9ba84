//! Parallelograms of random bars that turn through where they lie flat, and may go on in two ways there.
//!
//! ```text
//! angle_k = angle_0 + k turn,   coupler's angle = 0       without weight, by inertia alone
//! ```
//! The turn of a step is that of one step where the linkage is regular.

use std::f64::consts::PI;

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{DiagonalMetric, System};
use stationary_constraints::{
    ConstrainedIntegrator, ConstraintError, Rattle, Redundancy, SparseDiagonal,
};
use stationary_integrators::State;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, ConstantVelocity, Free, FreeBodies, Joint, JointEnd, JointKind,
    LieGroup, PlanarEnd, PlanarJoint, PlanarJointKind, Poses, RigidMotion, Rotation,
};

use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "singular-positions",
    krate: "rigid",
    rule: "a parallelogram that turns through its flat position, in steps that end before, at and beyond it, \
           leaves the motion of constant speed by more than 1e-6 rad, or an error is none that names a \
           singular position and its joints; where steps end more than 0.2 of a step from it, in steps \
           that turn less than 0.1 rad, it must pass",
    in_tests: 60,
    trial,
};

/// Crank and ground, metres; masses; radians a second.
struct Linkage {
    crank: f64,
    ground: f64,
    masses: [f64; 3],
    speed: f64,
}

/// How far steps from an angle, in time h, lead the crank: or the error and its step.
type Turned = Result<Vec<[f64; 2]>, (usize, ConstraintError)>;

impl Linkage {
    fn lengths(&self) -> [f64; 3] {
        [self.crank, self.ground, self.crank]
    }

    /// The crank's and the coupler's angles after each step, of bodies of the plane.
    fn in_the_plane(&self, angle: f64, h: f64, steps: usize) -> Turned {
        let [a, d] = [self.crank, self.ground];
        let half = |length: f64| Vector2::new(0.5 * length, 0.0);
        let end = PlanarEnd::on;
        let ends = [
            [PlanarEnd::world(Vector2::zeros()), end(0, -half(a))],
            [end(0, half(a)), end(1, -half(d))],
            [end(1, half(d)), end(2, half(a))],
            [end(2, -half(a)), PlanarEnd::world(Vector2::new(d, 0.0))],
        ];
        let pin = |ends| PlanarJoint::new(3, PlanarJointKind::Pin, ends).expect("a pin");
        let joints: Vec<PlanarJoint> = ends.map(pin).to_vec();
        let mut masses = Vec::new();
        for (mass, length) in self.masses.iter().zip(self.lengths()) {
            masses.extend([*mass, *mass, mass * length * length / 12.0]);
        }
        let (s, c) = angle.sin_cos();
        let (u, w) = (Vector2::new(c, s), Vector2::new(-s, c) * self.speed);
        let q =
            [(u * 0.5 * a, angle), (u * a + half(d), 0.0), (u * 0.5 * a + half(d) * 2.0, angle)];
        let v = [(w * 0.5 * a, self.speed), (w * a, 0.0), (w * 0.5 * a, self.speed)];
        let flat = |of: &[(Vector2<f64>, f64)]| -> Vec<f64> {
            of.iter().flat_map(|(x, angle)| [x.x, x.y, *angle]).collect()
        };
        let p: Vec<f64> = flat(&v).iter().zip(&masses).map(|(v, m)| v * m).collect();
        let metric = DiagonalMetric::new(masses).expect("masses");
        let system = System::new(metric, Free { freedoms: 9 }).expect("sizes that agree");
        let mut state = State::new(flat(&q), stationary_calculus::Covector(p));
        let sparse = SparseDiagonal(Redundancy::Refuse);
        let mut rattle =
            Rattle::new(&system, joints, &state, sparse).map_err(|error| (0, error))?;
        let one = |step| {
            rattle.step(&mut state, h).map_err(|error| (step, error))?;
            Ok([state.q[2], state.q[5]])
        };
        (1..=steps).map(one).collect()
    }

    /// The same of bodies in space on hinges, three of whose equations are redundant.
    fn in_space(&self, angle: f64, h: f64, steps: usize) -> Turned {
        let (x, z) = (Vector3::x(), Vector3::z());
        let [a, d] = [self.crank, self.ground];
        let on = JointEnd::on;
        let ends = [
            [JointEnd::world(Vector3::zeros()), on(0, -x * 0.5 * a)],
            [on(0, x * 0.5 * a), on(1, -x * 0.5 * d)],
            [on(1, x * 0.5 * d), on(2, x * 0.5 * a)],
            [on(2, -x * 0.5 * a), JointEnd::world(x * d)],
        ];
        let hinge =
            |ends| Joint::new(Poses, 3, JointKind::Hinge { axis: z }, ends).expect("a hinge");
        let joints: Vec<Joint<Poses>> = ends.map(hinge).to_vec();
        let thin =
            |mass: f64, length: f64| Body::solid_box(mass, [length, 0.05, 0.03]).expect("a box");
        let bodies: Vec<Body> =
            self.masses.iter().zip(self.lengths()).map(|(m, length)| thin(*m, length)).collect();
        let turned = Rotation::exp(z * angle);
        let (u, spin) = (turned.rotate(&x), z * self.speed);
        let motion = |translation: Vector3<f64>, rotation, velocity, angular_velocity| BodyMotion {
            pose: RigidMotion { translation, rotation },
            velocity,
            angular_velocity,
        };
        let moving = spin.cross(&u);
        let motions = [
            motion(u * 0.5 * a, turned, moving * 0.5 * a, spin),
            motion(u * a + x * 0.5 * d, Rotation::identity(), moving * a, Vector3::zeros()),
            motion(u * 0.5 * a + x * d, turned, moving * 0.5 * a, spin),
        ];
        let metric = BodyMetric::<Poses>::new(bodies);
        let mut state = metric.state(&motions).expect("three bodies");
        let system = metric.under(Free { freedoms: 18 }).expect("sizes that agree");
        let sparse = SparseDiagonal(Redundancy::LeastNorm);
        let free = FreeBodies(ConstantVelocity);
        let mut rattle =
            Rattle::along(free, &system, joints, &state, sparse).map_err(|error| (0, error))?;
        let mut before = angle;
        let one = |step| {
            rattle.step(&mut state, h).map_err(|error| (step, error))?;
            let angle = |body: usize| 2.0 * state.q[7 * body + 6].atan2(state.q[7 * body + 3]);
            let near = angle(0) - before;
            before += near - (near / (2.0 * PI)).round() * 2.0 * PI;
            let coupler = angle(1);
            Ok([before, coupler - (coupler / (2.0 * PI)).round() * 2.0 * PI])
        };
        (1..=steps).map(one).collect()
    }
}

fn trial(draw: &mut Draw) -> Verdict {
    let ratio = draw.one_of(&[1.0 + 1e-9, 1e1, 1e3]);
    let linkage = Linkage {
        crank: draw.log_uniform(0.3, 3.0),
        ground: draw.log_uniform(0.3, 3.0),
        masses: [0; 3].map(|_| draw.log_uniform(1.0, ratio)),
        speed: draw.log_uniform(0.3, 3.0) * draw.one_of(&[1.0, -1.0]),
    };
    let h = draw.log_uniform(1e-4, 0.1) / linkage.speed.abs();
    let part = match draw.below(3) {
        0 => draw.uniform(-0.5, 0.5),
        1 => draw.log_uniform(1e-10, 0.5),
        _ => 0.0,
    };
    let before = draw.between(1, 6);
    let flat = draw.one_of(&[0.0, PI]);
    let plane = draw.chance(0.5);
    let Linkage { crank, ground, masses, speed } = &linkage;
    draw.note(format!(
        "crank {crank}, ground {ground}, masses {masses:?}, speed {speed}, h {h}, lands {part} of a \
         step beside {flat} after {before}, in the plane {plane}"
    ));
    let run = |angle: f64, steps: usize| match plane {
        true => linkage.in_the_plane(angle, h, steps),
        false => linkage.in_space(angle, h, steps),
    };
    let turn = match run(1.0, 1) {
        Ok(angles) => angles[0][0] - 1.0,
        Err((_, error)) => return Verdict::refused(error),
    };
    let start = flat + (part - before as f64) * turn;
    match run(start, before + 6) {
        Ok(angles) => {
            let off = |(k, [crank, coupler]): (usize, &[f64; 2])| {
                (crank - start - (k + 1) as f64 * turn).abs().max(coupler.abs())
            };
            let off = angles.iter().enumerate().map(off).fold(0.0, f64::max);
            Verdict::of(off, 1e-6, "angles of crank and coupler")
        }
        Err((step, ConstraintError::SingularPosition { names, rows, .. })) => {
            let named = names.contains("between body") || names.contains("between the world");
            let here = step.abs_diff(before) <= 1;
            if part.abs() > 0.2 && turn.abs() < 0.1 {
                Verdict::refused(format!("a step {part} from the position, at {step}"))
            } else if named && here && !rows.is_empty() {
                Verdict::due()
            } else {
                Verdict::wrong(format!("{names} at step {step}"))
            }
        }
        Err((0, error @ ConstraintError::Singular { .. })) => Verdict::wrong(error),
        Err((step, error)) => Verdict::wrong(format!("{error} at step {step}")),
    }
}
