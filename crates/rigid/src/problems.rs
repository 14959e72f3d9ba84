//! Problems with known answers or known invariants: one definition each for tests, studies,
//! benches.
//!
//! | problem | system | what is known |
//! | --- | --- | --- |
//! | [`tumbling_box`] | the box of MuJoCo's test of free bodies | all: [`FreeTop`](crate::FreeTop) |
//! | [`thrown_racket`] | a body spinning about its middle axis, nearly | the time between flips |
//! | [`nodding_top`] | a heavy symmetric top let go | how far it nods |
//! | [`precessing_top`] | the same top in steady precession | its rate |
//! | [`kovalevskaya_top`] | Kovalevskaya's top | her fourth integral |
//! | [`held_at_a_point`] | any body on a ball joint | its motion about the point; support's force |
//! | [`top_on_its_tip`] | the top of above on a ball joint | the same as of above |
//! | [`thrown_boxes`] | three boxes on a ball joint and a hinge, free | energy and momenta |
//! | [`four_bars`], [`bricard`], [`governor`] | benchmarks of the IFToMM library | their reduced equations |
//! | [`squeezer`] | Andrews' squeezing mechanism | its published end, [`SQUEEZED`] |
//!
//! [`REFERENCES`] and [`LOGARITHMS`] hold exp, log and the Jacobians of rotations to the last digit.

mod mechanisms;
mod references;

use nalgebra::Vector3;
use stationary_calculus::{Potential, PotentialOn, System};
use stationary_integrators::State;

pub use mechanisms::{Mechanism, SQUEEZED, Strut, bricard, four_bars, governor, squeezer};
pub use references::{LOGARITHMS, Logarithm, REFERENCES, Reference};

use crate::error::check_finite;
use crate::{
    Body, BodyMetric, BodyMotion, BodySpace, Free, Joint, JointEnd, JointKind, KovalevskayaTop,
    LieGroup, Orientations, PointMass, Poses, RigidError, RigidMotion, Rotation, SymmetricTop,
    Weight,
};

/// A system of bodies with initial data.
#[derive(Clone, Debug)]
pub struct BodyProblem<P, S> {
    /// Its name, with lower-case letters and hyphens.
    pub name: &'static str,
    /// Its metric, potential and space.
    pub system: System<BodyMetric<S>, P, S>,
    /// Where it starts.
    pub initial: State<Vec<f64>>,
    /// The motion that it starts with.
    pub motion: BodyMotion,
    /// The time over which it is asked for, seconds.
    pub horizon: f64,
}

impl<P: Potential, S: BodySpace> BodyProblem<P, S> {
    /// The energy of a state, joules.
    pub fn energy(&self, state: &State<Vec<f64>>) -> f64 {
        self.system.energy(&state.q, state.p.view())
    }

    /// The only body.
    pub fn body(&self) -> &Body {
        &self.system.metric().bodies()[0]
    }
}

impl<P: PotentialOn<S>, S: BodySpace> BodyProblem<P, S> {
    fn new(
        name: &'static str,
        body: Body,
        potential: P,
        motion: BodyMotion,
        horizon: f64,
    ) -> Result<Self, RigidError> {
        let metric = BodyMetric::new(vec![body]);
        let initial = metric.state(&[motion])?;
        Ok(BodyProblem { name, system: metric.under(potential)?, initial, motion, horizon })
    }
}

fn spinning(rotation: Rotation, angular_velocity: Vector3<f64>) -> BodyMotion {
    let pose = RigidMotion { translation: Vector3::zeros(), rotation };
    BodyMotion { pose, velocity: Vector3::zeros(), angular_velocity }
}

/// A box of half sizes 0.1, 0.2 and 0.3 m and 1 kg that turns at (1, 2, 3) rad/s, free, for 5 s.
///
/// # Errors
/// None: its numbers are given.
pub fn tumbling_box() -> Result<BodyProblem<Free, Poses>, RigidError> {
    let body = Body::solid_box(1.0, [0.1, 0.2, 0.3])?;
    let motion = spinning(Rotation::identity(), Vector3::new(1.0, 2.0, 3.0));
    BodyProblem::new("tumbling-box", body, Free { freedoms: 6 }, motion, 5.0)
}

/// A racket's moments (in the ratio 1 : 6 : 7), spun at 10 rad/s about the middle axis, off by a
/// thousandth; free, for 5 s.
///
/// # Errors
/// None: its numbers are given.
pub fn thrown_racket() -> Result<BodyProblem<Free, Orientations>, RigidError> {
    let body = Body::new(0.3, [0.002, 0.012, 0.014])?;
    let motion = spinning(Rotation::identity(), Vector3::new(0.01, 10.0, 0.0));
    BodyProblem::new("thrown-racket", body, Free { freedoms: 3 }, motion, 5.0)
}

/// The top of [`nodding_top`] and [`precessing_top`].
pub const TOP: SymmetricTop = SymmetricTop { across: 0.02, along: 0.005, weight_moment: 0.5 };

/// Its tilt at the start, radians.
const TILT: f64 = 0.5;
/// Its spin, rad/s.
const SPIN: f64 = 60.0;

fn heavy(weight_moment: f64, centre: Vector3<f64>) -> Weight<Orientations> {
    // A mass of 1 kg at 1 m under the gravity that gives this moment.
    let load = PointMass { mass: 1.0, point: centre };
    Weight { gravity: Vector3::z() * -weight_moment, masses: vec![load], space: Orientations }
}

fn top(
    name: &'static str,
    rate: f64,
) -> Result<BodyProblem<Weight<Orientations>, Orientations>, RigidError> {
    let rotation = Rotation::exp(Vector3::x() * TILT);
    let own = Vector3::z() * (SPIN - rate * TILT.cos());
    let w = rotation.rotate_back(&(Vector3::z() * rate)) + own;
    let potential = heavy(TOP.weight_moment, Vector3::z());
    BodyProblem::new(name, TOP.body()?, potential, spinning(rotation, w), 5.0)
}

/// A spinning top let go at a tilt of 0.5 rad: its axis falls, and comes back.
///
/// # Errors
/// None: its numbers are given.
pub fn nodding_top() -> Result<BodyProblem<Weight<Orientations>, Orientations>, RigidError> {
    top("nodding-top", 0.0)
}

/// The same top with the slow rate of steady precession: its axis keeps its tilt.
///
/// # Errors
/// None: its numbers are given.
pub fn precessing_top() -> Result<BodyProblem<Weight<Orientations>, Orientations>, RigidError> {
    let rates = TOP.steady_precession(TILT, SPIN);
    top("precessing-top", rates.map_or(f64::NAN, |[slow, _]| slow))
}

/// Kovalevskaya's top of [`kovalevskaya_top`].
pub const KOVALEVSKAYA: KovalevskayaTop = KovalevskayaTop { along: 0.01, weight_moment: 0.1 };

/// Kovalevskaya's top, thrown so that it tumbles.
///
/// # Errors
/// None: its numbers are given.
pub fn kovalevskaya_top() -> Result<BodyProblem<Weight<Orientations>, Orientations>, RigidError> {
    let rotation = Rotation::exp(Vector3::new(0.4, 1.1, -0.3));
    let motion = spinning(rotation, Vector3::new(2.0, -1.0, 4.0));
    let potential = heavy(KOVALEVSKAYA.weight_moment, Vector3::x());
    BodyProblem::new("kovalevskaya-top", KOVALEVSKAYA.body()?, potential, motion, 20.0)
}

/// Bodies with joints and initial data that satisfy them.
#[derive(Clone, Debug)]
pub struct JointedProblem<P> {
    /// Its name, with lower-case letters and hyphens.
    pub name: &'static str,
    /// Its metric and potential.
    pub system: System<BodyMetric<Poses>, P, Poses>,
    /// Its joints.
    pub joints: Vec<Joint<Poses>>,
    /// Where it starts.
    pub initial: State<Vec<f64>>,
    /// The time over which it is asked for, seconds.
    pub horizon: f64,
}

impl<P: Potential> JointedProblem<P> {
    /// The energy of a state, joules.
    pub fn energy(&self, state: &State<Vec<f64>>) -> f64 {
        self.system.energy(&state.q, state.p.view())
    }
}

/// A body held at its point `point` (body axes) by a ball joint at the origin, at an orientation
/// and an angular velocity (body axes), under a uniform gravity, for 5 s.
///
/// # Errors
/// [`RigidError::NonFinite`] for a point, an angular velocity or a gravity that is not finite.
pub fn held_at_a_point(
    body: Body,
    point: Vector3<f64>,
    rotation: Rotation,
    w: Vector3<f64>,
    gravity: Vector3<f64>,
) -> Result<JointedProblem<Weight<Poses>>, RigidError> {
    check_finite("the gravity", gravity.as_slice())?;
    check_finite("the point", point.as_slice())?;
    let metric = BodyMetric::new(vec![body]);
    let motion = BodyMotion {
        pose: RigidMotion { translation: -rotation.rotate(&point), rotation },
        velocity: -rotation.rotate(&w.cross(&point)),
        angular_velocity: w,
    };
    let ends = [JointEnd::world(Vector3::zeros()), JointEnd::on(0, point)];
    let joints = vec![Joint::new(Poses, 1, JointKind::Ball, ends)?];
    let masses = vec![PointMass { mass: body.mass(), point: Vector3::zeros() }];
    let initial = metric.state(&[motion])?;
    let system = metric.under(Weight { gravity, masses, space: Poses })?;
    Ok(JointedProblem { name: "held-at-a-point", system, joints, initial, horizon: 5.0 })
}

/// The top of [`nodding_top`] as a body of 1 kg with its tip on a ball joint, its axis let go with
/// the rate `rate` of precession, rad/s.
///
/// # Errors
/// [`RigidError::NonFinite`] for a rate that is not finite.
pub fn top_on_its_tip(rate: f64) -> Result<JointedProblem<Weight<Poses>>, RigidError> {
    const GRAVITY: f64 = 9.81;
    let (mass, tip) = (1.0, -Vector3::z() * (TOP.weight_moment / GRAVITY));
    // About its centre, by the parallel-axis rule.
    let across = TOP.across - mass * tip.norm_squared();
    let body = Body::new(mass, [across, across, TOP.along])?;
    let rotation = Rotation::exp(Vector3::x() * TILT);
    let own = Vector3::z() * (SPIN - rate * TILT.cos());
    let w = rotation.rotate_back(&(Vector3::z() * rate)) + own;
    let problem = held_at_a_point(body, tip, rotation, w, Vector3::z() * -GRAVITY)?;
    Ok(JointedProblem { name: "top-on-its-tip", ..problem })
}

/// Three boxes of unequal sides in a row, the first two on a ball joint and the last two on a hinge,
/// thrown so that they tumble and fold, their common centre at rest; free, for 10 s.
///
/// # Errors
/// None: its numbers are given.
pub fn thrown_boxes() -> Result<JointedProblem<Free>, RigidError> {
    let boxes = [[0.1, 0.2, 0.3], [0.2, 0.1, 0.15], [0.15, 0.25, 0.1]];
    let bodies = boxes.iter().zip([1.0, 0.7, 1.3]).map(|(&half, mass)| Body::solid_box(mass, half));
    let metric = BodyMetric::<Poses>::new(bodies.collect::<Result<_, _>>()?);
    let end = |body: usize, side: f64| Vector3::x() * (side * boxes[body][0]);
    let joint = |first: usize| {
        let (before, after) = (end(first, 1.0), end(first + 1, -1.0));
        [JointEnd::on(first, before), JointEnd::on(first + 1, after)]
    };
    let ball = Joint::new(Poses, 3, JointKind::Ball, joint(0))?;
    let hinge = Joint::new(Poses, 3, JointKind::Hinge { axis: Vector3::y() }, joint(1))?;
    // Each box turns with the one before it, and against it as its joint allows.
    let turns =
        [Vector3::new(1.0, 2.0, 3.0), Vector3::new(-2.0, 1.0, 0.5), Vector3::new(-2.0, 4.0, 0.5)];
    let mut motions: Vec<BodyMotion> = Vec::new();
    for (body, &w) in turns.iter().enumerate() {
        let (centre, velocity) = match motions.last() {
            None => (Vector3::zeros(), Vector3::zeros()),
            Some(before) => {
                let (out, back) = (end(body - 1, 1.0), end(body, -1.0));
                let turned = before.angular_velocity.cross(&out) - w.cross(&back);
                (before.pose.translation + out - back, before.velocity + turned)
            }
        };
        let pose = RigidMotion { translation: centre, rotation: Rotation::identity() };
        motions.push(BodyMotion { pose, velocity, angular_velocity: w });
    }
    let bodies = || metric.bodies().iter().zip(&motions);
    let mass: f64 = metric.bodies().iter().map(Body::mass).sum();
    let mean: Vector3<f64> = bodies().map(|(b, m)| m.velocity * (b.mass() / mass)).sum();
    motions.iter_mut().for_each(|motion| motion.velocity -= mean);
    let initial = metric.state(&motions)?;
    let system = metric.under(Free { freedoms: 18 })?;
    let joints = vec![ball, hinge];
    Ok(JointedProblem { name: "thrown-boxes", system, joints, initial, horizon: 10.0 })
}
