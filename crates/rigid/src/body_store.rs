//! Many free bodies, laid out for throughput: eight of them turn in one pass.
//!
//! ```text
//! each quantity a column over all bodies:   x y z,   P,   w x y z,   m1 m2 m3,   1/I
//! P <- P + h/2 m g,   t <- t + h P/m,   (R, m) <- turns about the axes,   P <- P + h/2 m g
//! ```
//! The map is that of [`AxisRotations`](crate::AxisRotations), turn for turn, and so are its
//! promises: order 2, explicit, symmetric, symplectic, spatial angular momentum to rounding. Bodies
//! feel a uniform gravity at their centres, which this step follows exactly, and nothing else: for
//! potentials and joints there are the integrators on systems.
//!
//! Columns go through the processor in groups of eight with no branch between them, so that the
//! compiler turns them into vector instructions. For that every body's axes are renamed in turn, so
//! that the first is that of its smallest moment; whoever looks at a body sees its own axes. A group
//! in which some turn is long goes through the library's sine instead.

use nalgebra::Vector3;
use stationary_calculus::{SizeError, array, first_non_finite};
use stationary_integrators::StepError;

use crate::axis_rotations::first_axis;
use crate::error::check_finite;
use crate::stumpff::{SMALL_BELOW, sine_cosine, small};
use crate::{Body, BodyMotion, BodySpace, Poses, RigidError, RigidMotion, Rotation};

/// Bodies in a group.
const LANES: usize = 8;

/// One number of each body of a group.
type Lanes = [f64; LANES];

/// Eight bodies, a quantity a row.
#[derive(Clone, Debug)]
struct Group {
    centre: [Lanes; 3],
    velocity: [Lanes; 3],
    /// w x y z, of axes renamed.
    quaternion: [Lanes; 4],
    /// Angular momentum, axes renamed.
    momentum: [Lanes; 3],
    inverse_moments: [Lanes; 3],
}

/// Many free bodies under a uniform gravity.
#[derive(Clone, Debug)]
pub struct BodyStore {
    groups: Vec<Group>,
    bodies: Vec<Body>,
    /// Which of a body's own axes is the store's first.
    first_axis: Vec<usize>,
    gravity: Vector3<f64>,
    time: f64,
}

#[inline]
fn each(f: impl Fn(usize) -> f64) -> Lanes {
    array(f)
}

impl Group {
    /// Nobody: unit moments at rest, so that what fills a group up does no harm.
    fn empty() -> Self {
        let mut quaternion = [[0.0; LANES]; 4];
        quaternion[0] = [1.0; LANES];
        Group {
            centre: [[0.0; LANES]; 3],
            velocity: [[0.0; LANES]; 3],
            quaternion,
            momentum: [[0.0; LANES]; 3],
            inverse_moments: [[1.0; LANES]; 3],
        }
    }

    /// Turns all bodies about their axis `A` for a time.
    #[inline]
    fn turn<const A: usize>(&mut self, h: f64) {
        let (b, c) = ((A + 1) % 3, (A + 2) % 3);
        let half = each(|k| 0.5 * h * self.inverse_moments[A][k] * self.momentum[A][k]);
        let square = each(|k| half[k] * half[k]);
        let (sine, cosine) = if square.iter().fold(0.0, |a: f64, &s| a.max(s)) < SMALL_BELOW {
            let both: [[f64; 2]; LANES] = square.map(small);
            (each(|k| half[k] * both[k][1]), each(|k| both[k][0]))
        } else {
            let both = half.map(sine_cosine);
            (each(|k| both[k].0), each(|k| both[k].1))
        };
        let turn = each(|k| 2.0 * sine[k] * cosine[k]);
        let versine = each(|k| 2.0 * sine[k] * sine[k]);
        let (mb, mc) = (self.momentum[b], self.momentum[c]);
        self.momentum[b] = each(|k| mb[k] + (turn[k] * mc[k] - versine[k] * mb[k]));
        self.momentum[c] = each(|k| mc[k] - (turn[k] * mb[k] + versine[k] * mc[k]));
        let [w, x] = [self.quaternion[0], self.quaternion[1 + A]];
        let [y, z] = [self.quaternion[1 + b], self.quaternion[1 + c]];
        self.quaternion[0] = each(|k| cosine[k] * w[k] - sine[k] * x[k]);
        self.quaternion[1 + A] = each(|k| cosine[k] * x[k] + sine[k] * w[k]);
        self.quaternion[1 + b] = each(|k| cosine[k] * y[k] + sine[k] * z[k]);
        self.quaternion[1 + c] = each(|k| cosine[k] * z[k] - sine[k] * y[k]);
    }

    #[inline]
    fn step(&mut self, h: f64, gravity: &Vector3<f64>) {
        for c in 0..3 {
            let (x, v, kick) = (self.centre[c], self.velocity[c], 0.5 * h * gravity[c]);
            self.centre[c] = each(|k| x[k] + h * (v[k] + kick));
            self.velocity[c] = each(|k| v[k] + 2.0 * kick);
        }
        self.turn::<0>(0.5 * h);
        self.turn::<1>(0.5 * h);
        self.turn::<2>(h);
        self.turn::<1>(0.5 * h);
        self.turn::<0>(0.5 * h);
        let q = self.quaternion;
        let scale = each(|k| {
            let square =
                q[0][k] * q[0][k] + q[1][k] * q[1][k] + q[2][k] * q[2][k] + q[3][k] * q[3][k];
            square.sqrt().recip()
        });
        for (quaternion, q) in self.quaternion.iter_mut().zip(q) {
            *quaternion = each(|k| q[k] * scale[k]);
        }
    }
}

impl BodyStore {
    /// Bodies with their motions, under a gravity in m/s^2.
    ///
    /// # Errors
    /// As many motions as bodies, and numbers that are not finite.
    pub fn new(
        bodies: Vec<Body>,
        motions: &[BodyMotion],
        gravity: Vector3<f64>,
    ) -> Result<Self, RigidError> {
        SizeError::check("the bodies' motions", bodies.len(), motions.len())?;
        check_finite("the gravity", gravity.as_slice())?;
        let mut store = BodyStore {
            groups: vec![Group::empty(); bodies.len().div_ceil(LANES)],
            first_axis: Vec::with_capacity(bodies.len()),
            bodies,
            gravity,
            time: 0.0,
        };
        for (index, motion) in motions.iter().enumerate() {
            store.put(index, motion)?;
        }
        Ok(store)
    }

    fn put(&mut self, index: usize, motion: &BodyMotion) -> Result<(), RigidError> {
        let body = self.bodies[index];
        let pose = &motion.pose;
        let q = pose.rotation.quaternion();
        Poses::check(&[pose.translation.as_slice(), &q].concat()).map_err(|error| match error {
            RigidError::Pose { length, .. } => RigidError::Pose { body: index, length },
            other => other,
        })?;
        check_finite("the velocity", motion.velocity.as_slice())?;
        let m = body.angular_momentum(&motion.angular_velocity);
        check_finite("the momentum", m.as_slice())?;
        let first = first_axis(&body.inverse_moments());
        self.first_axis.push(first);
        let (group, k) = (&mut self.groups[index / LANES], index % LANES);
        group.quaternion[0][k] = q[0];
        for c in 0..3 {
            let own = (first + c) % 3;
            group.centre[c][k] = pose.translation[c];
            group.velocity[c][k] = motion.velocity[c];
            group.quaternion[1 + c][k] = q[1 + own];
            group.momentum[c][k] = m[own];
            group.inverse_moments[c][k] = body.inverse_moments()[own];
        }
        Ok(())
    }

    /// The number of bodies.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// True where there is no body.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// The time, seconds.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Moves every body forward by `h` seconds.
    ///
    /// # Errors
    /// A step that is not positive and finite; the bodies are then as they were. What overflows on
    /// the way is found by [`BodyStore::check`], not here: looking would cost as much as moving.
    pub fn step(&mut self, h: f64) -> Result<(), StepError> {
        if !(h > 0.0 && h.is_finite()) {
            return Err(StepError::Step(h));
        }
        let gravity = self.gravity;
        self.groups.iter_mut().for_each(|group| group.step(h, &gravity));
        self.time += h;
        Ok(())
    }

    /// How a body moves now; `None` where there is no such body.
    pub fn motion(&self, index: usize) -> Option<BodyMotion> {
        let (&body, &first) = (self.bodies.get(index)?, self.first_axis.get(index)?);
        let (group, k) = (&self.groups[index / LANES], index % LANES);
        let vector = |columns: &[Lanes; 3]| Vector3::from_fn(|c, _| columns[c][k]);
        let (mut q, mut m) = ([group.quaternion[0][k], 0.0, 0.0, 0.0], Vector3::zeros());
        for c in 0..3 {
            let own = (first + c) % 3;
            q[1 + own] = group.quaternion[1 + c][k];
            m[own] = group.momentum[c][k];
        }
        let pose =
            RigidMotion { translation: vector(&group.centre), rotation: Rotation::unchecked(q) };
        let angular_velocity = body.angular_velocity(&m);
        Some(BodyMotion { pose, velocity: vector(&group.velocity), angular_velocity })
    }

    /// An error that names the first body, as six freedoms each, whose motion is not finite.
    ///
    /// # Errors
    /// [`StepError::NonFiniteConfiguration`] and [`StepError::NonFiniteMomentum`] with the freedom.
    pub fn check(&self) -> Result<(), StepError> {
        for index in 0..self.len() {
            let Some(motion) = self.motion(index) else { continue };
            let q = motion.pose.rotation.quaternion();
            let place = first_non_finite(motion.pose.translation.as_slice())
                .or(first_non_finite(&q).map(|c| 3 + c.saturating_sub(1)));
            if let Some(c) = place {
                return Err(StepError::NonFiniteConfiguration { freedom: 6 * index + c });
            }
            let fast = first_non_finite(motion.velocity.as_slice())
                .or(first_non_finite(motion.angular_velocity.as_slice()).map(|c| 3 + c));
            if let Some(c) = fast {
                return Err(StepError::NonFiniteMomentum { freedom: 6 * index + c });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BodyMethod, BodyMetric, LieGroup, PointMass, Weight};

    /// Nineteen bodies: two groups and a part of one, with smallest moments about every axis, or about two or all.
    fn crowd(fast: f64) -> (Vec<Body>, Vec<BodyMotion>) {
        let boxes = [
            [0.1, 0.2, 0.3],
            [0.3, 0.1, 0.2],
            [0.2, 0.3, 0.1],
            [0.2, 0.1, 0.1],
            [0.2, 0.2, 0.2],
            [0.2, 0.1, 0.2],
            [0.2, 0.2, 0.1],
            [0.1, 0.2, 0.2],
        ];
        let body = |k: usize| Body::solid_box(1.0 + 0.1 * k as f64, boxes[k % 8]).unwrap();
        let motion = |k: usize| {
            let x = Vector3::new((k as f64).sin(), (2.0 * k as f64).cos(), (3.0 * k as f64).sin());
            let pose = RigidMotion { translation: x, rotation: Rotation::exp(x * 2.0) };
            BodyMotion { pose, velocity: -x, angular_velocity: (x + Vector3::z()) * fast }
        };
        ((0..19).map(body).collect(), (0..19).map(motion).collect())
    }

    #[test]
    fn a_store_moves_its_bodies_as_the_integrator_does() {
        // Turns that stay short, and turns that do not.
        for (fast, h) in [(3.0, 1e-3), (40.0, 5e-3)] {
            let (bodies, motions) = crowd(fast);
            let gravity = Vector3::new(0.3, -0.1, -9.8);
            let mut store = BodyStore::new(bodies.clone(), &motions, gravity).unwrap();
            let metric = BodyMetric::<Poses>::new(bodies.clone());
            let mut state = metric.state(&motions).unwrap();
            let load = |body: &Body| PointMass { mass: body.mass(), point: Vector3::zeros() };
            let masses = bodies.iter().map(load).collect();
            let system = metric.under(Weight { gravity, masses, space: Poses }).unwrap();
            let mut integrator = BodyMethod::AxisRotations.integrator(&system).unwrap();
            for _ in 0..500 {
                store.step(h).unwrap();
                integrator.step(&mut state, h).unwrap();
            }
            store.check().unwrap();
            for (k, body) in bodies.iter().enumerate() {
                let (ours, pose) = (store.motion(k).unwrap(), Poses::pose_at(&state.q, k));
                assert!((ours.pose.translation - pose.translation).norm() < 1e-12);
                let off = ours.pose.rotation.direction_to(&pose.rotation).norm();
                assert!(off < 1e-11, "body {k}: {off:e}");
                let m = Vector3::from_column_slice(&state.p.0[6 * k + 3..][..3]);
                let w = body.angular_velocity(&m);
                assert!((ours.angular_velocity - w).norm() < 1e-11 * fast);
            }
            assert!((store.time() - 500.0 * h).abs() < 1e-12);
        }
    }

    #[test]
    fn free_bodies_keep_their_spatial_angular_momentum_to_rounding() {
        let (bodies, motions) = crowd(3.0);
        let mut store = BodyStore::new(bodies.clone(), &motions, Vector3::zeros()).unwrap();
        (0..10_000).for_each(|_| store.step(1e-2).unwrap());
        for (k, (body, start)) in bodies.iter().zip(&motions).enumerate() {
            let spin = |m: &BodyMotion| {
                m.pose.rotation.rotate(&body.angular_momentum(&m.angular_velocity))
            };
            let (now, before) = (spin(&store.motion(k).unwrap()), spin(start));
            assert!((now - before).norm() < 1e-12 * before.norm());
        }
        assert!(store.motion(19).is_none() && !store.is_empty());
    }

    #[test]
    fn what_is_no_motion_or_no_step_is_refused() {
        let (bodies, mut motions) = crowd(1.0);
        let few = BodyStore::new(bodies.clone(), &motions[..3], Vector3::zeros());
        assert!(matches!(few, Err(RigidError::Size(_))));
        let mut store = BodyStore::new(bodies.clone(), &motions, Vector3::zeros()).unwrap();
        for h in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(store.step(h), Err(StepError::Step(_))));
        }
        motions[7].velocity.y = f64::NAN;
        let nan = BodyStore::new(bodies.clone(), &motions, Vector3::zeros());
        assert!(matches!(nan, Err(RigidError::NonFinite { .. })));
        motions[7].velocity.y = 1e308;
        let mut store = BodyStore::new(bodies, &motions, Vector3::zeros()).unwrap();
        store.step(1e3).unwrap();
        let lost = store.check();
        let freedom = 6 * 7 + 1;
        assert_eq!(lost, Err(StepError::NonFiniteConfiguration { freedom }));
    }
}
