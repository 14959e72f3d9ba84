//! Stacks of very different masses: what stands stays where it is, what does not settle says so, and
//! energy never grows, in the plane and in space.
//!
//! ```text
//! E+ - E- <= lifting + r sum lambda + rounding of m g z          a step, J
//! |lambda - m_above g h| <= part of it                           what the lowest contacts carry, N s
//! ```

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, DiagonalMetric, Metric, System};
use stationary_contact::{
    Collider, ContactError, Detector, PlanarCollider, PlanarDetector, PlanarShape, PlanarWorld,
    Shape, SpatialWorld, WorldReport,
};
use stationary_integrators::State;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PlanarMotion, PlanarWeight, PointMass, Poses,
    RigidMotion, Rotation, Weight,
};

const GRAVITY: f64 = 9.81;
const FRICTION: f64 = 0.5;
const STEP: f64 = 1e-2;
/// Half a second, in which what does not stand has fallen by a metre.
const STEPS: usize = 50;

/// A stack of boxes of 1 m, and how its numbers are read.
struct Stack<'a> {
    masses: &'a [f64],
    /// Numbers of a pose, and which of them is the height.
    stored: usize,
    up: usize,
}

/// What a run left.
#[derive(Debug, Default)]
struct Outcome {
    /// Steps that say of themselves that they are not settled.
    unsettled: usize,
    refused: Option<ContactError>,
    /// The farthest that a box has moved, m.
    moved: f64,
    /// The energy that steps gained beyond what their reports and rounding allow, J.
    gained: f64,
    /// The energy above that of the start and of what lifting gave since, relative to the weights' at the start.
    above: f64,
    /// How far the impulses on the floor are from the weight, relative to it, at the end.
    carried: f64,
}

impl Stack<'_> {
    fn run(
        &self,
        state: &mut State<Vec<f64>>,
        kinetic: impl Fn(&State<Vec<f64>>) -> f64,
        mut step: impl FnMut(&mut State<Vec<f64>>) -> Result<(WorldReport, f64, f64), ContactError>,
    ) -> Outcome {
        let mut outcome = Outcome::default();
        let start = state.q.clone();
        let whole = self.masses.iter().sum::<f64>() * GRAVITY;
        let energy = |state: &State<Vec<f64>>| {
            let heights = state.q.chunks(self.stored).zip(self.masses);
            let weight: f64 = heights.map(|(q, m)| m * GRAVITY * q[self.up]).sum();
            (kinetic(state) + weight, weight.abs())
        };
        let (first, whole_scale) = energy(state);
        let mut lifted = 0.0;
        for _ in 0..STEPS {
            let (before, scale) = energy(state);
            let (report, floor, pushed) = match step(state) {
                Ok(taken) => taken,
                Err(error) => {
                    outcome.refused = Some(error);
                    break;
                }
            };
            let (after, _) = energy(state);
            let allowed = report.lifting_energy.max(0.0)
                + report.residual.max(report.coulomb) * pushed
                + 16.0 * f64::EPSILON * scale;
            lifted += report.lifting_energy.max(0.0);
            outcome.above = outcome.above.max((after - first - lifted) / whole_scale);
            outcome.gained = outcome.gained.max(after - before - allowed);
            outcome.unsettled += usize::from(!report.settled);
            outcome.carried = (floor / (whole * STEP) - 1.0).abs();
            let apart = start.iter().zip(&state.q).map(|(a, b)| (a - b).abs());
            outcome.moved = apart.fold(outcome.moved, f64::max);
        }
        outcome
    }
}

fn in_the_plane(masses: &[f64]) -> Outcome {
    let count = masses.len();
    let bodies = (0..count)
        .map(|body| PlanarCollider::on_body(body, PlanarShape::cuboid([0.5; 2]).unwrap()));
    let floor = PlanarShape::half_plane(Vector2::y()).unwrap();
    let floor = PlanarCollider::fixed(PlanarMotion::identity(), floor);
    let colliders = bodies.chain([floor]).map(|c| c.with_friction(FRICTION)).collect();
    let diagonal = masses.iter().flat_map(|&m| [m, m, m / 6.0]).collect::<Vec<_>>();
    let metric = DiagonalMetric::new(diagonal).unwrap();
    let weight = PlanarWeight { gravity: Vector2::y() * -GRAVITY, masses: masses.to_vec() };
    let detector = PlanarDetector::new(colliders, count).unwrap();
    let system = System::new(metric.clone(), weight).unwrap();
    let mut world = PlanarWorld::new(system, detector).unwrap();
    let q = (0..count).flat_map(|k| [0.0, 0.5 + k as f64, 0.0]).collect();
    let mut state = State::new(q, Covector(vec![0.0; 3 * count]));
    Stack { masses, stored: 3, up: 1 }.run(
        &mut state,
        |state| metric.kinetic_energy(state.p.view()),
        |state| {
            let report = world.step(state, STEP)?;
            let on_floor = world.touches().filter(|t| t.contact.bodies.contains(&None));
            let floor = on_floor.map(|t| t.normal).sum();
            Ok((report, floor, world.touches().map(|t| t.normal + t.friction.norm()).sum()))
        },
    )
}

fn in_space(masses: &[f64]) -> Outcome {
    let count = masses.len();
    let cube = Shape::cuboid([0.5; 3]).unwrap();
    let bodies = (0..count).map(|body| Collider::on_body(body, cube.clone()));
    let floor = Shape::half_space(Vector3::z()).unwrap();
    let floor = Collider::fixed(RigidMotion::identity(), floor);
    let colliders = bodies.chain([floor]).map(|c| c.with_friction(FRICTION)).collect();
    let solid = |&mass: &f64| Body::solid_box(mass, [0.5; 3]).unwrap();
    let metric = BodyMetric::<Poses>::new(masses.iter().map(solid).collect());
    let motion = |k: usize| BodyMotion {
        pose: RigidMotion {
            translation: Vector3::z() * (0.5 + k as f64),
            rotation: Rotation::identity(),
        },
        velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
    };
    let mut state = metric.state(&(0..count).map(motion).collect::<Vec<_>>()).unwrap();
    let point = |&mass: &f64| PointMass { mass, point: Vector3::zeros() };
    let weight = Weight {
        gravity: Vector3::z() * -GRAVITY,
        masses: masses.iter().map(point).collect(),
        space: Poses,
    };
    let detector = Detector::new(colliders, count).unwrap();
    let mut world = SpatialWorld::new(metric.clone().under(weight).unwrap(), detector).unwrap();
    Stack { masses, stored: 7, up: 2 }.run(
        &mut state,
        |state| metric.kinetic_energy(state.p.view()),
        |state| {
            let report = world.step(state, STEP)?;
            let on_floor = world.touches().filter(|t| t.contact.bodies.contains(&None));
            let floor = on_floor.map(|t| t.normal).sum();
            Ok((report, floor, world.touches().map(|t| t.normal + t.friction.norm()).sum()))
        },
    )
}

/// Runs a stack in both dimensions; energy never grows, and what claims to be settled stands.
fn stands(masses: &[f64]) -> [Outcome; 2] {
    let outcomes = [in_the_plane(masses), in_space(masses)];
    for outcome in &outcomes {
        println!("{masses:?}: {outcome:?}");
        assert!(outcome.gained <= 0.0 && outcome.above < 1e-9, "{masses:?}: {outcome:?}");
        if outcome.refused.is_none() && outcome.unsettled == 0 {
            assert!(outcome.moved < 1e-6, "{masses:?}: {outcome:?}");
            assert!(outcome.carried < 1e-6, "{masses:?}: {outcome:?}");
        }
    }
    outcomes
}

#[test]
fn two_boxes_of_a_mass_ratio_of_a_billion_stand_whichever_is_below() {
    for masses in [[1.0, 1e9], [1e9, 1.0]] {
        for outcome in stands(&masses) {
            assert!(outcome.refused.is_none() && outcome.unsettled == 0, "{outcome:?}");
        }
    }
}

#[test]
fn ten_boxes_each_ten_times_heavier_than_the_one_below_stand_or_say_that_they_do_not_settle() {
    let heavier: Vec<f64> = (0..10).map(|k| 10_f64.powi(k)).collect();
    let lighter: Vec<f64> = heavier.iter().rev().copied().collect();
    for masses in [heavier, lighter] {
        stands(&masses);
    }
}
