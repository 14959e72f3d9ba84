//! Pins that have a size and move as they are told, where bodies touch: obstacles that nothing slows down.
//!
//! ```text
//! x(t) = x_0 + s(t) d,    v = (x(t + h) - x(t))/h in a step of h        bodies after those of the scene
//! ```
//! To whoever steps they are balls of infinite mass behind the bodies; the scene itself does not know them.

use stationary_integrators::State;

use crate::model::body_shape::BodyShape;
use crate::model::drives::PinMotion;
use crate::model::items::RigidBody;
use crate::model::scene::Scene;

/// The obstacles of a scene, and room for the state of its bodies with theirs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Obstacles {
    pins: Vec<(PinMotion, [f64; 3])>,
    in_space: bool,
    with: State<Vec<f64>>,
}

impl Scene {
    /// Pinned particles that have a size and move, where things touch.
    pub(crate) fn obstacles(&self) -> impl Iterator<Item = usize> {
        let moving = self.drives.motions.iter().map(|motion| motion.particle);
        moving.filter(|&pin| self.contact.is_some() && self.particles[pin].radius > 0.0)
    }

    /// The scene with its obstacles as bodies behind its own; nothing where it has none.
    pub(crate) fn with_obstacles(&self) -> Option<Scene> {
        self.obstacles().next()?;
        let mut scene = self.clone();
        for pin in self.obstacles() {
            let particle = &mut scene.particles[pin];
            // Any mass and moments: they count as infinite.
            scene.bodies.push(RigidBody {
                name: particle.name.clone(),
                mass: 1.0,
                shape: BodyShape::Ball(particle.radius),
                moments: if self.dimension == 3 { [1.0; 3] } else { [0.0, 0.0, 1.0] },
                position: particle.position,
                rotation: [0.0; 3],
                velocity: [0.0; 3],
                angular_velocity: [0.0; 3],
                points: Vec::new(),
                point_mass: false,
            });
            particle.radius = 0.0;
        }
        Some(scene)
    }
}

impl Obstacles {
    pub(crate) fn of(scene: &Scene) -> Self {
        let pin = |pin: usize| {
            let motion = scene.drives.motion_of(pin)?;
            Some((motion.clone(), scene.particles[pin].position))
        };
        Obstacles {
            pins: scene.obstacles().filter_map(pin).collect(),
            in_space: scene.dimension == 3,
            with: State::default(),
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.pins.is_empty()
    }

    /// A state of the scene's bodies with theirs, as they move through a step of `h`.
    pub(crate) fn with(&mut self, state: &State<Vec<f64>>, h: f64) -> &mut State<Vec<f64>> {
        let Obstacles { pins, in_space, with } = self;
        with.clone_from(state);
        for (motion, start) in pins.iter() {
            let from = motion.place(*start, state.t);
            let to = motion.place(*start, state.t + h);
            let [u, v, w] = std::array::from_fn(|c| (to[c] - from[c]) / h);
            let [x, y, z] = from;
            if *in_space {
                with.q.extend([x, y, z, 1.0, 0.0, 0.0, 0.0]);
                with.p.0.extend([u, v, w, 0.0, 0.0, 0.0]);
            } else {
                with.q.extend([x, y, 0.0]);
                with.p.0.extend([u, v, 0.0]);
            }
        }
        with
    }

    /// What of that state is the scene's.
    pub(crate) fn without(&self, state: &mut State<Vec<f64>>) {
        let (q, p) = (state.q.len(), state.p.0.len());
        state.q.copy_from_slice(&self.with.q[..q]);
        state.p.0.copy_from_slice(&self.with.p.0[..p]);
        state.t = self.with.t;
    }
}
