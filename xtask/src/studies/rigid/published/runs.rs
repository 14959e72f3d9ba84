//! Runs of a published mechanism: in full coordinates at an order, and in few coordinates.

use std::ops::ControlFlow;

use nalgebra::Vector3;
use stationary_constraints::problems::{Pendulum, pendulum};
use stationary_constraints::{
    Composed, ConstrainedIntegrator, ConstraintError, Forced, Rattle, Redundancy, SparseDiagonal,
};
use stationary_integrators::{
    AdaptiveMethod, DormandPrince853, Moment, Scheme, State, Tolerance, VectorField, integrate,
};
use stationary_rigid::problems::Mechanism;
use stationary_rigid::tree::{TreeField, TreeForces, TreeMotion};
use stationary_rigid::{BodyForces, ConstantVelocity, FreeBodies, Poses};

use crate::study::StudyError;

const GRAVITY: f64 = 9.81;
/// Times on the way at which places are compared.
const MOMENTS: u32 = 8;

/// Places on the way, and the joints that were solved for.
#[derive(Clone, Debug, Default)]
pub(super) struct Run {
    places: Vec<Vector3<f64>>,
    pub(super) work: u64,
}

impl Run {
    /// The largest distance of a place from the true one, metres.
    pub(super) fn error(&self, truth: &Run) -> f64 {
        let apart = self.places.iter().zip(&truth.places).map(|(a, b)| (a - b).norm());
        apart.fold(1e-16, f64::max)
    }
}

/// What moves by equal steps with multipliers: how many joints it has, and where a point of it is.
struct Walk<'a> {
    joints: usize,
    time: f64,
    see: &'a dyn Fn(&[f64]) -> Vector3<f64>,
}

impl Walk<'_> {
    fn run<C: AsRef<[f64]>>(
        &self,
        mut method: impl ConstrainedIntegrator<C>,
        mut state: State<C>,
        (steps, parts): (u32, u64),
    ) -> Result<Run, ConstraintError> {
        let mut run = Run::default();
        for step in 1..=steps {
            let report = method.step(&mut state, self.time / f64::from(steps))?;
            run.work += (u64::from(report.iterations) + parts) * self.joints as u64;
            if step % (steps / MOMENTS) == 0 {
                run.places.push((self.see)(state.q.as_ref()));
            }
        }
        Ok(run)
    }
}

fn parts(scheme: Scheme) -> u64 {
    scheme.steps().map_or(1, |steps| steps.len() as u64)
}

/// A mechanism for a time, of which the centre of one body is looked for.
pub(super) struct Seen<'a> {
    mechanism: &'a Mechanism,
    forces: BodyForces<Poses>,
    body: usize,
    pub(super) time: f64,
}

impl<'a> Seen<'a> {
    pub(super) fn new(
        mechanism: &'a Mechanism,
        (body, time): (usize, f64),
    ) -> Result<Self, StudyError> {
        let forces = mechanism.forces().map_err(StudyError::at("the forces"))?;
        Ok(Seen { mechanism, forces, body, time })
    }

    /// In full coordinates, by so many steps of an order.
    pub(super) fn full(&self, scheme: Option<Scheme>, steps: u32) -> Result<Run, ConstraintError> {
        let Mechanism { system, joints, initial, .. } = self.mechanism;
        let see = |q: &[f64]| Vector3::from_column_slice(&q[7 * self.body..][..3]);
        let walk = Walk { joints: joints.len(), time: self.time, see: &see };
        let motion = Forced::new(FreeBodies(ConstantVelocity), self.forces.clone());
        let equations = SparseDiagonal(Redundancy::LeastNorm);
        let rattle = Rattle::along(motion, system, joints, initial, equations)?;
        match scheme {
            None => walk.run(rattle, initial.clone(), (steps, 1)),
            Some(scheme) => {
                let composed = Composed::new(rattle, scheme, initial)?;
                walk.run(composed, initial.clone(), (steps, parts(scheme)))
            }
        }
    }

    /// As a tree whose loops are closed, to a tolerance.
    pub(super) fn tree(&self, tolerance: f64) -> Result<Run, StudyError> {
        let at = || StudyError::at("the tree");
        let &Seen { mechanism, body, time, .. } = self;
        let tree = mechanism.tree().map_err(at())?;
        let gravity = mechanism.system.potential().gravity;
        let weight = TreeForces::weight(&tree, gravity).map_err(at())?;
        let drive = |_: f64, motion: &TreeMotion, forces: &mut TreeForces| {
            if mechanism.act(motion, forces).is_err() {
                forces.joints_mut().fill(f64::NAN);
            }
        };
        let loops = mechanism.loops(&tree).map_err(at())?;
        let field = TreeField::driven(tree.clone(), weight, drive).map_err(at())?.closed(loops);
        let (mut motion, coordinates) = (TreeMotion::new(tree.clone()), tree.coordinates());
        let see = move |y: &[f64]| {
            let (q, v) = y.split_at(coordinates);
            let pose = motion.place(q, v).and_then(|()| motion.pose(body));
            pose.map_or(Vector3::repeat(f64::NAN), |pose| pose.translation)
        };
        let start = mechanism.start.concat();
        adaptive(field, (&start, time, tolerance), (tree.bodies() as u64, see))
    }
}

/// Runs a first-order system by the adaptive method, and looks for a point in its states.
fn adaptive<F: VectorField>(
    field: F,
    (start, time, tolerance): (&[f64], f64, f64),
    (bodies, mut see): (u64, impl FnMut(&[f64]) -> Vector3<f64>),
) -> Result<Run, StudyError> {
    let tolerance = Tolerance::new(tolerance, tolerance).map_err(StudyError::at("a tolerance"))?;
    let moment = Moment::new(0.0, start.to_vec());
    let mut method = DormandPrince853::new(field, tolerance.into(), moment)
        .map_err(StudyError::at("the method"))?;
    let mut run = Run::default();
    for k in 1..=MOMENTS {
        let t = time * f64::from(k) / f64::from(MOMENTS);
        integrate(&mut method, t, |_| ControlFlow::Continue(()))
            .map_err(StudyError::at("a reduced run"))?;
        run.places.push(see(&method.moment().y));
    }
    run.work = method.work().evaluations * bodies;
    Ok(run)
}

/// An angle under `angle.. = c sin angle`, counted from upright: what N four-bars and a pendulum are.
struct Swing(f64);

impl VectorField for Swing {
    fn dim(&self) -> usize {
        2
    }

    fn evaluate(&self, _: f64, y: &[f64], f: &mut [f64]) {
        (f[0], f[1]) = (y[1], self.0 * y[0].sin());
    }
}

/// The four-bars by their one angle, with the thickness that the bars have.
pub(super) fn four_bars_by_angle(n: usize, time: f64, tolerance: f64) -> Result<Run, StudyError> {
    let (cranks, couplers) = (n as f64 + 1.0, n as f64);
    let about = (0.5_f64.powi(2) + 1e-6) / 3.0 + 0.25;
    let inertia = cranks * about + couplers;
    let torque = GRAVITY * (0.5 * cranks + couplers);
    let see = |y: &[f64]| Vector3::new(0.5 * y[0].sin(), 0.5 * y[0].cos(), 0.0);
    adaptive(Swing(torque / inertia), (&[0.0, 1.0], time, tolerance), (1, see))
}

/// The pendulum of a point, level and at rest at the start: in units of its length, 1 m, and of
/// `sqrt(length / gravity)`.
pub(super) struct Point {
    pendulum: Pendulum,
    time: f64,
}

impl Point {
    /// For so many seconds.
    pub(super) fn new(seconds: f64) -> Result<Self, StudyError> {
        let pendulum = pendulum(2.0_f64.sqrt()).map_err(StudyError::at("the pendulum"))?;
        Ok(Point { pendulum, time: seconds * GRAVITY.sqrt() })
    }

    pub(super) fn full(&self, scheme: Option<Scheme>, steps: u32) -> Result<Run, ConstraintError> {
        let problem = &self.pendulum.problem;
        let level = self.pendulum.state(0.25 * self.pendulum.period);
        let start = State::new(level.q, level.p);
        let see = |q: &[f64]| Vector3::new(q[0], q[1], 0.0);
        let walk = Walk { joints: 1, time: self.time, see: &see };
        let rattle =
            Rattle::new(&problem.system, &problem.rods, &start, SparseDiagonal::default())?;
        match scheme {
            None => walk.run(rattle, start, (steps, 1)),
            Some(scheme) => {
                let composed = Composed::new(rattle, scheme, &start)?;
                walk.run(composed, start, (steps, parts(scheme)))
            }
        }
    }

    pub(super) fn by_angle(&self, tolerance: f64) -> Result<Run, StudyError> {
        let see = |y: &[f64]| Vector3::new(y[0].sin(), y[0].cos(), 0.0);
        let start = [std::f64::consts::FRAC_PI_2, 0.0];
        adaptive(Swing(1.0), (&start, self.time, tolerance), (1, see))
    }

    /// By Jacobi's elliptic functions.
    pub(super) fn truth(&self) -> Run {
        let place = |k: u32| {
            let t = self.time * f64::from(k) / f64::from(MOMENTS);
            let [x, y] = self.pendulum.place(0.25 * self.pendulum.period + t);
            Vector3::new(x, y, 0.0)
        };
        Run { places: (1..=MOMENTS).map(place).collect(), work: 0 }
    }
}
