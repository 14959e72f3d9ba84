//! Pins that have a size and move as they are told, where bodies touch: obstacles that nothing slows down.
//!
//! ```text
//! x(t) = x_0 + s(t) d,    v = (x(t + h) - x(t))/h in a step of h        bodies after those of the scene
//! ```
//! To whoever steps they are balls of infinite mass behind the bodies; the scene itself does not know them.

use stationary_calculus::array;
use stationary_integrators::State;

use crate::model::body_shape::BodyShape;
use crate::model::drives::PinMotion;
use crate::model::items::RigidBody;
use crate::model::scene::Scene;
use crate::model::strength::Strength;

/// The obstacles of a scene, whose bodies have so many stored numbers and freedoms.
#[derive(Clone, Debug, Default)]
pub(crate) struct Obstacles {
    pins: Vec<(PinMotion, [f64; 3])>,
    in_space: bool,
    own: [usize; 2],
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
        let in_space = scene.dimension == 3;
        let each = if in_space { [7, 6] } else { [3, 3] };
        Obstacles {
            pins: scene.obstacles().filter_map(pin).collect(),
            in_space,
            own: each.map(|each| each * scene.bodies.len()),
        }
    }

    pub(crate) fn freedoms(&self) -> usize {
        self.pins.len() * if self.in_space { 6 } else { 3 }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.pins.is_empty()
    }

    /// Writes them behind the scene's bodies, as they move through a step of `h`.
    pub(crate) fn place(&self, state: &mut State<Vec<f64>>, h: f64) {
        if self.pins.is_empty() {
            return;
        }
        self.leave_out(state);
        for (motion, start) in &self.pins {
            let from = motion.place(*start, state.t);
            let to = motion.place(*start, state.t + h);
            let [u, v, w] = array(|c| (to[c] - from[c]) / h);
            let [x, y, z] = from;
            if self.in_space {
                state.q.extend([x, y, z, 1.0, 0.0, 0.0, 0.0]);
                state.p.0.extend([u, v, w, 0.0, 0.0, 0.0]);
            } else {
                state.q.extend([x, y, 0.0]);
                state.p.0.extend([u, v, 0.0]);
            }
        }
    }

    /// Writes them where they are, with their velocity at that time.
    pub(crate) fn place_now(&self, state: &mut State<Vec<f64>>) {
        self.place(state, 1.0);
        let each = if self.in_space { 6 } else { 3 };
        let State { t, p, .. } = state;
        let Some(own) = p.0.get_mut(self.own[1]..) else { return };
        for (p, (motion, _)) in own.chunks_exact_mut(each).zip(&self.pins) {
            let shifts = if self.in_space { 3 } else { 2 };
            p.iter_mut().zip(motion.velocity(*t)).take(shifts).for_each(|(p, v)| *p = v);
        }
    }

    /// Adds to bounds of forces what moves them between two times: their masses are one.
    pub(crate) fn add_bounds(&self, (from, to): (f64, f64), bounds: &mut [f64]) {
        self.add_along(bounds, |strength| strength.fastest(from, to)[1]);
    }

    /// Adds by how much the forces that move them leave their means between two times.
    pub(crate) fn add_swings(&self, (from, to): (f64, f64), swings: &mut [f64]) {
        self.add_along(swings, |strength| strength.swing_of_curvature(from, to));
    }

    /// Adds a number of each motion along its shift.
    fn add_along(&self, sums: &mut [f64], of: impl Fn(&Strength) -> f64) {
        let each = if self.in_space { 6 } else { 3 };
        let Some(own) = sums.get_mut(self.own[1]..) else { return };
        for (sums, (motion, _)) in own.chunks_exact_mut(each).zip(&self.pins) {
            let most = of(&motion.strength);
            let shifts = if self.in_space { 3 } else { 2 };
            let all = sums.iter_mut().zip(motion.shift).take(shifts);
            all.for_each(|(sum, shift)| *sum += most * shift.abs());
        }
    }

    /// Leaves of a state what is the scene's.
    pub(crate) fn leave_out(&self, state: &mut State<Vec<f64>>) {
        if self.pins.is_empty() {
            return;
        }
        let [stored, freedoms] = self.own;
        state.q.truncate(stored);
        state.p.0.truncate(freedoms);
    }
}
