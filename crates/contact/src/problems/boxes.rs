//! Boxes that stand in columns or fall into a pile: what touching bodies are judged by.
//!
//! | problem | what meets | what is known |
//! | --- | --- | --- |
//! | [`columns_of_boxes`] | cubes of 1 m and 1 kg stand on each other | nothing moves |
//! | [`leaning_tower`] | one column of them, each off its middle | it stands where [`Boxes::margin`] is positive |
//! | [`falling_boxes`] | cubes let go in a loose grid, each turned a little | they come to rest |
//!
//! All with friction, under gravity, on the floor `z = 0`.
//!
//! ```text
//! m = min_k (1/2 - |mean(x_k, .., x_n) - x_j|),   j = k - 1, k          each axis, places x across, m
//! ```

use nalgebra::Vector3;
use stationary_integrators::State;
use stationary_measure::SplitMix64;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

use crate::{BodiesIn, Collider, ContactError, Detector, Shape, Spatial};

/// Acceleration of gravity, m/s^2.
pub const GRAVITY: f64 = 9.81;
/// Friction of boxes and floor.
pub const FRICTION: f64 = 0.5;
/// Half the side of a box, m.
const HALF: f64 = 0.5;

/// Boxes and a floor, before the first step.
#[derive(Debug)]
pub struct Boxes {
    /// Where each starts, at rest.
    pub starts: Vec<RigidMotion>,
    /// The bodies under gravity.
    pub system: BodiesIn<Spatial, Weight<Poses>>,
    /// Their state.
    pub state: State<Vec<f64>>,
}

impl Boxes {
    /// A detector of their contacts.
    ///
    /// # Errors
    /// None: cubes, floor and friction are in their ranges.
    pub fn detector(&self) -> Result<Detector, ContactError> {
        let cube = Shape::cuboid([HALF; 3])?;
        let on_body = |body| Collider::on_body(body, cube.clone()).with_friction(FRICTION);
        let mut colliders: Vec<_> = (0..self.starts.len()).map(on_body).collect();
        let floor = Collider::fixed(RigidMotion::identity(), Shape::half_space(Vector3::z())?);
        colliders.push(floor.with_friction(FRICTION));
        Detector::new(colliders, self.starts.len())
    }

    /// The kinetic and the potential energy of a state, J.
    pub fn energy(&self, state: &State<Vec<f64>>) -> f64 {
        self.system.energy(&state.q, state.p.view())
    }

    /// By how much the middle of what is above a joint of a tower is inside of what the two boxes share, m, at the
    /// joint where that is least: above zero statics lets it stand, below it falls.
    pub fn margin(&self) -> f64 {
        let mut least = f64::INFINITY;
        for k in 1..self.starts.len() {
            let above = &self.starts[k..];
            for axis in 0..2 {
                let place = |pose: &RigidMotion| pose.translation[axis];
                let middle = above.iter().map(place).sum::<f64>() / above.len() as f64;
                for pose in &self.starts[k - 1..=k] {
                    least = least.min(HALF - (middle - place(pose)).abs());
                }
            }
        }
        least
    }

    fn starting(starts: Vec<RigidMotion>) -> Result<Self, ContactError> {
        let still = Vector3::zeros();
        let motion = |&pose| BodyMotion { pose, velocity: still, angular_velocity: still };
        let cube = Body::solid_box(1.0, [HALF; 3])?;
        let metric = BodyMetric::new(vec![cube; starts.len()]);
        let state = metric.state(&starts.iter().map(motion).collect::<Vec<_>>())?;
        let masses = vec![PointMass { mass: cube.mass(), point: still }; starts.len()];
        let weight = Weight { gravity: -Vector3::z() * GRAVITY, masses, space: Poses };
        Ok(Boxes { starts, system: metric.under(weight)?, state })
    }
}

/// Columns of boxes, a box's side apart from each other.
///
/// # Errors
/// None: the boxes are bodies, and their starts are poses.
pub fn columns_of_boxes(columns: usize, high: usize) -> Result<Boxes, ContactError> {
    let wide = (columns as f64).sqrt().ceil() as usize;
    let one = |k: usize| {
        let column = k / high;
        let [x, y] = [column % wide, column / wide].map(|c| 2.0 * c as f64);
        let translation = Vector3::new(x, y, HALF + (k % high) as f64);
        RigidMotion { translation, rotation: Rotation::identity() }
    };
    Boxes::starting((0..columns * high).map(one).collect())
}

/// A tower whose boxes are off from its middle by as much as `off` (m), at random.
///
/// # Errors
/// Where an offset is not finite.
pub fn leaning_tower(
    high: usize,
    off: f64,
    random: &mut SplitMix64,
) -> Result<Boxes, ContactError> {
    let mut poses = columns_of_boxes(1, high)?.starts;
    for pose in &mut poses {
        pose.translation.x += off * random.symmetric();
        pose.translation.y += off * random.symmetric();
    }
    Boxes::starting(poses)
}

/// Boxes in a loose grid above the floor, as high as it is wide, each pushed and turned a little.
///
/// # Errors
/// None: the boxes are bodies, and their starts are poses.
pub fn falling_boxes(count: usize) -> Result<Boxes, ContactError> {
    let mut random = SplitMix64::new(7);
    let wide = (count as f64).cbrt().ceil() as usize;
    let one = |k: usize| {
        let cell = [k % wide, k / wide % wide, k / (wide * wide)];
        let grid = Vector3::from(cell.map(|c| 1.2 * c as f64)) + Vector3::z() * 0.9;
        let translation = grid + Vector3::from_fn(|_, _| 0.05 * random.symmetric());
        let turn = Vector3::from_fn(|_, _| 0.1 * random.symmetric());
        RigidMotion { translation, rotation: Rotation::exp(turn) }
    };
    Boxes::starting((0..count).map(one).collect())
}
