//! Linkages of one freedom that turn through a position from which they may go on in two ways, and where they go.
//!
//! ```text
//! <M (q(x_k+1) - 2 q(x_k) + q(x_k-1)), q'(x_k)> = 0        first: <M (q(x_1) - q(x_0) - h v_0), q'(x_0)> = 0
//! ```
//! `q(x)` the places (9) of the three bodies on the way that goes on, `x` the crank's angle: RATTLE's equations along
//! that way, which know no other. Source: notes 6.3, 10.1.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_constraints::{
    ConstrainedIntegrator, ConstraintError, Rattle, Redundancy, SparseDiagonal,
};
use stationary_integrators::State;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, ConstantVelocity, Free, FreeBodies, Joint, JointEnd, JointKind,
    LieGroup, PlanarEnd, PlanarJoint, PlanarJointKind, Poses, RigidMotion, Rotation,
};

/// What is linked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    /// Crank, coupler as long as the ground, and a second crank: flat at 0 and at half a turn.
    Parallelogram { ground: f64 },
    /// Crank, coupler as long as it, and a piston, which at a quarter of a turn stands on the crank's pivot.
    SliderCrank,
}

/// Metres, kilograms, radians a second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linkage {
    pub shape: Shape,
    pub crank: f64,
    pub masses: [f64; 3],
    pub speed: f64,
}

/// The crank's and the coupler's angles after each step, or the error and its step.
pub(super) type Turned = Result<Vec<[f64; 2]>, (usize, ConstraintError)>;

/// Centre and angle of each body, or their rates.
type Places = [(Vector2<f64>, f64); 3];

fn less(one: &Places, other: &Places) -> Places {
    [0, 1, 2].map(|k| (one[k].0 - other[k].0, one[k].1 - other[k].1))
}

impl Linkage {
    /// Where it may go on in two ways.
    pub(super) fn singular(&self) -> [f64; 2] {
        match self.shape {
            Shape::Parallelogram { .. } => [0.0, PI],
            Shape::SliderCrank => [FRAC_PI_2, -FRAC_PI_2],
        }
    }

    fn lengths(&self) -> [f64; 3] {
        match self.shape {
            Shape::Parallelogram { ground } => [self.crank, ground, self.crank],
            Shape::SliderCrank => [self.crank, self.crank, 0.5 * self.crank],
        }
    }

    /// Moments about z, kg m^2.
    fn moments(&self) -> [f64; 3] {
        let lengths = self.lengths();
        [0, 1, 2].map(|k| self.masses[k] * (lengths[k] * lengths[k] + WIDTH * WIDTH) / 12.0)
    }

    fn places(&self, angle: f64) -> Places {
        let (s, c) = angle.sin_cos();
        let (a, u) = (self.crank, Vector2::new(c, s));
        match self.shape {
            Shape::Parallelogram { ground } => {
                let d = Vector2::new(ground, 0.0);
                [(u * 0.5 * a, angle), (u * a + 0.5 * d, 0.0), (u * 0.5 * a + d, angle)]
            }
            Shape::SliderCrank => [
                (u * 0.5 * a, angle),
                (Vector2::new(1.5 * c, 0.5 * s) * a, -angle),
                (Vector2::new(2.0 * a * c, 0.0), 0.0),
            ],
        }
    }

    /// Their derivative along the crank's angle.
    fn rates(&self, angle: f64) -> Places {
        let (s, c) = angle.sin_cos();
        let (a, w) = (self.crank, Vector2::new(-s, c));
        match self.shape {
            Shape::Parallelogram { .. } => [(w * 0.5 * a, 1.0), (w * a, 0.0), (w * 0.5 * a, 1.0)],
            Shape::SliderCrank => [
                (w * 0.5 * a, 1.0),
                (Vector2::new(-1.5 * s, 0.5 * c) * a, -1.0),
                (Vector2::new(-2.0 * a * s, 0.0), 0.0),
            ],
        }
    }

    /// The product of two sets of rates by masses.
    fn metric(&self, one: &Places, other: &Places) -> f64 {
        let moments = self.moments();
        let of = |k: usize| {
            self.masses[k] * one[k].0.dot(&other[k].0) + moments[k] * one[k].1 * other[k].1
        };
        (0..3).map(of).sum()
    }

    /// The crank's speed from which a step leads from an angle to another.
    pub(super) fn speed_between(&self, from: f64, to: f64, h: f64) -> f64 {
        let (here, way) = (self.places(from), self.rates(from));
        self.metric(&less(&self.places(to), &here), &way) / (h * self.metric(&way, &way))
    }

    /// The crank's angles after each step along the way that goes on.
    pub(super) fn along(&self, start: f64, h: f64, steps: usize) -> Option<Vec<f64>> {
        let (mut x, mut turn) = (start, h * self.speed);
        let mut step = self.rates(x).map(|(v, w)| (v * turn, w * turn));
        let mut found = Vec::with_capacity(steps);
        for _ in 0..steps {
            let (here, way) = (self.places(x), self.rates(x));
            let mut next = x + turn;
            let mut settled = false;
            for _ in 0..50 {
                let off = less(&less(&self.places(next), &here), &step);
                let change = self.metric(&off, &way) / self.metric(&self.rates(next), &way);
                next -= change;
                settled = change.abs() <= 1e-15 * (1.0 + next.abs());
                if settled {
                    break;
                }
            }
            if !settled {
                return None;
            }
            step = less(&self.places(next), &here);
            (turn, x) = (next - x, next);
            found.push(x);
        }
        Some(found)
    }

    /// What RATTLE does with bodies of the plane.
    pub(super) fn in_the_plane(&self, angle: f64, h: f64, steps: usize) -> Turned {
        let lengths = self.lengths();
        let end = |body: usize, side: f64| {
            PlanarEnd::on(body, Vector2::new(0.5 * side * lengths[body], 0.0))
        };
        let world = |x: f64| PlanarEnd::world(Vector2::new(x, 0.0));
        let pin = PlanarJointKind::Pin;
        let mut joints =
            vec![(pin, [world(0.0), end(0, -1.0)]), (pin, [end(0, 1.0), end(1, -1.0)])];
        match self.shape {
            Shape::Parallelogram { ground } => {
                joints.push((pin, [end(1, 1.0), end(2, 1.0)]));
                joints.push((pin, [end(2, -1.0), world(ground)]));
            }
            Shape::SliderCrank => {
                joints.push((pin, [end(1, 1.0), end(2, 0.0)]));
                joints.push((
                    PlanarJointKind::Slider { axis: Vector2::x() },
                    [world(0.0), end(2, 0.0)],
                ));
            }
        }
        let joint = |(kind, ends)| PlanarJoint::new(3, kind, ends).expect("a joint");
        let joints: Vec<PlanarJoint> = joints.into_iter().map(joint).collect();
        let flat = |of: &Places| -> Vec<f64> {
            of.iter().flat_map(|(x, angle)| [x.x, x.y, *angle]).collect()
        };
        let moments = self.moments();
        let masses: Vec<f64> =
            (0..3).flat_map(|k| [self.masses[k], self.masses[k], moments[k]]).collect();
        let rates = flat(&self.rates(angle));
        let p = rates.iter().zip(&masses).map(|(v, m)| v * self.speed * m).collect();
        let mut state = State::new(flat(&self.places(angle)), Covector(p));
        let metric = DiagonalMetric::new(masses).expect("masses");
        let system = System::new(metric, Free { freedoms: 9 }).expect("sizes that agree");
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
    pub(super) fn in_space(&self, angle: f64, h: f64, steps: usize) -> Turned {
        let (x, z) = (Vector3::x(), Vector3::z());
        let lengths = self.lengths();
        let end = |body: usize, side: f64| JointEnd::on(body, x * 0.5 * side * lengths[body]);
        let hinge = JointKind::Hinge { axis: z };
        let mut joints = vec![
            (hinge, [JointEnd::world(Vector3::zeros()), end(0, -1.0)]),
            (hinge, [end(0, 1.0), end(1, -1.0)]),
        ];
        match self.shape {
            Shape::Parallelogram { ground } => {
                joints.push((hinge, [end(1, 1.0), end(2, 1.0)]));
                joints.push((hinge, [end(2, -1.0), JointEnd::world(x * ground)]));
            }
            Shape::SliderCrank => {
                joints.push((hinge, [end(1, 1.0), end(2, 0.0)]));
                let ends = [JointEnd::world(Vector3::zeros()), end(2, 0.0)];
                joints.push((JointKind::Slider { axis: x }, ends));
            }
        }
        let joint = |(kind, ends)| Joint::new(Poses, 3, kind, ends).expect("a joint");
        let joints: Vec<Joint<Poses>> = joints.into_iter().map(joint).collect();
        let thin = |k: usize| {
            let half = [0.5 * lengths[k], 0.5 * WIDTH, 0.5 * WIDTH];
            Body::solid_box(self.masses[k], half).expect("a box")
        };
        let metric = BodyMetric::<Poses>::new((0..3).map(thin).collect());
        let (places, rates) = (self.places(angle), self.rates(angle));
        let motions = [0, 1, 2].map(|k| BodyMotion {
            pose: RigidMotion {
                translation: places[k].0.push(0.0),
                rotation: Rotation::exp(z * places[k].1),
            },
            velocity: rates[k].0.push(0.0) * self.speed,
            angular_velocity: z * rates[k].1 * self.speed,
        });
        let mut state = metric.state(&motions).expect("three bodies");
        let system = metric.under(Free { freedoms: 18 }).expect("sizes that agree");
        let sparse = SparseDiagonal(Redundancy::LeastNorm);
        let free = FreeBodies(ConstantVelocity);
        let mut rattle =
            Rattle::along(free, &system, joints, &state, sparse).map_err(|error| (0, error))?;
        let one = |step| {
            rattle.step(&mut state, h).map_err(|error| (step, error))?;
            Ok([0, 1].map(|body| 2.0 * state.q[7 * body + 6].atan2(state.q[7 * body + 3])))
        };
        (1..=steps).map(one).collect()
    }

    /// How far angles are from those with the crank at an angle, whole turns aside.
    pub(super) fn off(&self, crank: f64, found: [f64; 2]) -> f64 {
        let right = [crank, self.places(crank)[1].1];
        let one = |k: usize| {
            let apart = found[k] - right[k];
            (apart - (apart / (2.0 * PI)).round() * 2.0 * PI).abs()
        };
        one(0).max(one(1))
    }
}

/// How wide a bar is, metres.
const WIDTH: f64 = 0.05;
