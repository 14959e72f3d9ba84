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

use nalgebra::Vector3;
use stationary_calculus::{Potential, System};
use stationary_integrators::State;

use crate::{
    Body, BodyMetric, BodyMotion, BodySpace, Free, KovalevskayaTop, LieGroup, Orientations,
    PointMass, RigidError, RigidMotion, Rotation, SymmetricTop, Weight,
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
pub fn tumbling_box() -> Result<BodyProblem<Free, crate::Poses>, RigidError> {
    let body = Body::solid_box(1.0, [0.1, 0.2, 0.3])?;
    let motion = spinning(Rotation::identity(), Vector3::new(1.0, 2.0, 3.0));
    BodyProblem::new("tumbling-box", body, Free { freedoms: 6 }, motion, 5.0)
}

/// A racket's moments (in the ratio 1 : 6 : 7), spun at 10 rad/s about the middle axis, off by a
/// thousandth; free, for 5 s.
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
pub fn nodding_top() -> Result<BodyProblem<Weight<Orientations>, Orientations>, RigidError> {
    top("nodding-top", 0.0)
}

/// The same top with the slow rate of steady precession: its axis keeps its tilt.
pub fn precessing_top() -> Result<BodyProblem<Weight<Orientations>, Orientations>, RigidError> {
    let rates = TOP.steady_precession(TILT, SPIN);
    top("precessing-top", rates.map_or(f64::NAN, |[slow, _]| slow))
}

/// Kovalevskaya's top of [`kovalevskaya_top`].
pub const KOVALEVSKAYA: KovalevskayaTop = KovalevskayaTop { along: 0.01, weight_moment: 0.1 };

/// Kovalevskaya's top, thrown so that it tumbles.
pub fn kovalevskaya_top() -> Result<BodyProblem<Weight<Orientations>, Orientations>, RigidError> {
    let rotation = Rotation::exp(Vector3::new(0.4, 1.1, -0.3));
    let motion = spinning(rotation, Vector3::new(2.0, -1.0, 4.0));
    let potential = heavy(KOVALEVSKAYA.weight_moment, Vector3::x());
    BodyProblem::new("kovalevskaya-top", KOVALEVSKAYA.body()?, potential, motion, 20.0)
}
