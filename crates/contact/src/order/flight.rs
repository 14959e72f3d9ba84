//! Flight of rigid bodies without contact, of order 2 or 4 at any length.
//!
//! ```text
//! F2(s) = kick s/2, drift s, kick s/2        p += s/2 (F - dV), drift: centres straight, free rotation in closed form
//! F4(s) = F2(a s) F2(a s) F2((1 - 4a) s) F2(a s) F2(a s),   a = 1/(4 - 4^(1/3))
//! ```
//! `s` seconds, `dV` the differential of the potential, `F` other forces (see `flight_forces.rs`). Both are explicit
//! and symmetric, without `F` symplectic, and exact without forces, energy included; a flight is the same function of
//! `s` for its end and for any moment on the way. Where forces are uniform and make no torque `F2` is exact too.
//!
//! Between two moments a body is followed along the chord, the straight path with one rotation between both
//! poses ([`RigidPathIn`]). With `A` and `B` bounds on the acceleration of the centre (m/s^2) and on that of
//! the rotation (rad/s^2), a point at most `rho` from the centre is off the chord over `d` seconds by at most
//! ```text
//! e = d^2/8 (A + rho B),   doubled: the bounds are measured where the flight starts and ends
//! ```
//! while it turns by at most a radian. A force that varies more than twofold with the place or the velocity inside of a
//! flight is not bounded by that; what varies in time is bounded over all of it. Source: notes 9.5; Suzuki 1990 (the
//! five stages); Celledoni et al. 2008 (free rotation).

use stationary_calculus::{Covector, Metric, Potential, Vector};
use stationary_integrators::State;

use crate::error::check_finite;
use crate::order::flight_forces::{FlightForces, StageEnd};
use crate::{BodiesIn, ContactError, Dimension, InverseMass, RigidPathIn};

/// The order of a flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FlightOrder {
    /// One kick, drift and kick.
    Second,
    /// Five of them.
    Fourth,
}

impl FlightOrder {
    /// The order as a number.
    pub fn order(self) -> u32 {
        match self {
            FlightOrder::Second => 2,
            FlightOrder::Fourth => 4,
        }
    }

    /// The parts of a flight's length that its stages take.
    fn stages(self) -> &'static [f64] {
        /// `1/(4 - 4^(1/3))`.
        const A: f64 = 0.414_490_771_794_375_7;
        match self {
            FlightOrder::Second => &[1.0],
            FlightOrder::Fourth => &[A, A, 1.0 - 4.0 * A, A, A],
        }
    }
}

/// What flight knows of the plane and of space.
pub trait Flies: Dimension {
    /// Moves bodies as if no force acted, exactly.
    ///
    /// # Errors
    /// In space [`ContactError::Step`] where the closed form of a turn fails.
    fn drift(
        metric: &Self::Metric,
        q: &mut [f64],
        p: &mut [f64],
        v: &mut [f64],
        h: f64,
    ) -> Result<(), ContactError>;

    /// The turn from one pose of a body to another, radians, body axes.
    fn turn_between(from: &[f64], to: &[f64], body: usize) -> Self::Spin;

    /// Writes where a body is after a part of its chord, or beyond it.
    ///
    /// # Errors
    /// Poses that are not finite.
    fn place_on_chord(
        [from, to]: [&[f64]; 2],
        body: usize,
        part: f64,
        q: &mut [f64],
    ) -> Result<(), ContactError> {
        let pose = chord::<Self>(from, to, body)?.at(part);
        q[Self::STORED * body..][..Self::STORED].copy_from_slice(Self::numbers(&pose).as_ref());
        Ok(())
    }

    /// A bound on the rate at which the angular velocity of a body changes without torque, rad/s^2.
    fn gyroscopic(metric: &Self::Metric, p: &[f64], body: usize) -> f64;
}

#[cfg(feature = "2d")]
impl Flies for crate::Planar {
    fn drift(
        metric: &Self::Metric,
        q: &mut [f64],
        p: &mut [f64],
        v: &mut [f64],
        h: f64,
    ) -> Result<(), ContactError> {
        metric.sharp(Covector(&*p), Vector(&mut *v));
        q.iter_mut().zip(v).for_each(|(q, v)| *q += h * *v);
        Ok(())
    }

    fn turn_between(from: &[f64], to: &[f64], body: usize) -> f64 {
        to[3 * body + 2] - from[3 * body + 2]
    }

    /// As numbers, so that angles go on counting whole turns.
    fn place_on_chord(
        [from, to]: [&[f64]; 2],
        body: usize,
        part: f64,
        q: &mut [f64],
    ) -> Result<(), ContactError> {
        for k in 3 * body..3 * body + 3 {
            q[k] = from[k] + part * (to[k] - from[k]);
        }
        Ok(())
    }

    fn gyroscopic(_: &Self::Metric, _: &[f64], _: usize) -> f64 {
        0.0
    }
}

#[cfg(feature = "3d")]
impl Flies for crate::Spatial {
    fn drift(
        metric: &Self::Metric,
        q: &mut [f64],
        p: &mut [f64],
        v: &mut [f64],
        h: f64,
    ) -> Result<(), ContactError> {
        use stationary_constraints::FreeMotion;
        use stationary_rigid::{ExactRotation, FreeBodies, Poses};
        let mut bodies = FreeBodies(ExactRotation);
        Ok(bodies.advance(metric, &Poses, (0.0, h), q, Covector(p), Vector(v))?)
    }

    fn turn_between(from: &[f64], to: &[f64], body: usize) -> nalgebra::Vector3<f64> {
        use stationary_rigid::LieGroup;
        let [from, to] = [from, to].map(|q| Self::pose(q, body).rotation);
        from.inverse().compose(&to).log()
    }

    fn gyroscopic(metric: &Self::Metric, p: &[f64], body: usize) -> f64 {
        // |I^-1 (m x I^-1 m)|: of I^-1 only what differs from a multiple of 1 counts in the bracket.
        let moments = metric.bodies()[body].moments();
        let spread = 0.5 * (moments.min().recip() - moments.max().recip());
        let squared: f64 = p[6 * body + 3..6 * body + 6].iter().map(|m| m * m).sum();
        squared * spread / moments.min()
    }
}

/// Turns in which the chord of a flight holds its bound, rad.
const TURN: f64 = 1.0;
/// By how much a force may exceed the larger of its values where a flight starts and ends.
const GROWTH: f64 = 2.0;

/// Flies states, and knows how far from its chords a flight comes.
#[derive(Debug)]
pub(crate) struct Flight {
    order: FlightOrder,
    dv: Covector<Vec<f64>>,
    rates: Vector<Vec<f64>>,
    /// Of each body: acceleration of the centre, of the rotation, and how fast it turns.
    bounds: Vec<[f64; 3]>,
    /// The first two of forces beside the potential's.
    of_forces: Vec<[f64; 2]>,
    /// Differentials of the potential so far.
    pub(crate) evaluations: usize,
}

impl Flight {
    pub(crate) fn new(order: FlightOrder, freedoms: usize, bodies: usize) -> Self {
        Flight {
            order,
            dv: Covector(vec![0.0; freedoms]),
            rates: Vector(vec![0.0; freedoms]),
            bounds: vec![[0.0; 3]; bodies],
            of_forces: vec![[0.0; 2]; bodies],
            evaluations: 0,
        }
    }

    /// Writes the state `s` seconds later.
    pub(crate) fn fly<G: Flies, P: Potential>(
        &mut self,
        system: &BodiesIn<G, P>,
        from: &State<Vec<f64>>,
        s: f64,
        forces: &mut impl FlightForces,
        to: &mut State<Vec<f64>>,
    ) -> Result<(), ContactError> {
        to.clone_from(from);
        forces.begin_flight();
        if s == 0.0 {
            return Ok(());
        }
        let mut flown = 0.0;
        for part in self.order.stages() {
            let (t, h) = (from.t + flown * s, part * s);
            flown += part;
            to.t = t;
            self.kick::<G, P>(system, 0.5 * h, to);
            forces.kick(StageEnd::Start, (t, h), to);
            G::drift(system.metric(), &mut to.q, &mut to.p.0, &mut self.rates.0, h)?;
            to.t = t + h;
            forces.kick(StageEnd::Finish, (t, h), to);
            self.kick::<G, P>(system, 0.5 * h, to);
        }
        to.t = from.t + s;
        forces.place(to);
        check_finite("the configuration in flight", &to.q)?;
        check_finite("the momentum in flight", &to.p.0)
    }

    fn kick<G: Flies, P: Potential>(
        &mut self,
        system: &BodiesIn<G, P>,
        h: f64,
        state: &mut State<Vec<f64>>,
    ) {
        self.find_differential::<G, P>(system, &state.q);
        state.p.add_scaled(-h, self.dv.view());
    }

    fn find_differential<G: Flies, P: Potential>(&mut self, system: &BodiesIn<G, P>, q: &[f64]) {
        self.dv.0.fill(0.0);
        system.potential().add_differential(q, self.dv.view_mut());
        self.evaluations += 1;
    }

    /// Writes the velocity that the potential and forces at a velocity give in `h` seconds; none of what is held.
    pub(crate) fn find_increment<G: Flies, P: Potential>(
        &mut self,
        system: &BodiesIn<G, P>,
        (state, v): (&State<Vec<f64>>, &Vector<Vec<f64>>),
        h: f64,
        (forces, mass): (&impl FlightForces, &InverseMass),
        increment: &mut Vector<Vec<f64>>,
    ) {
        self.find_differential::<G, P>(system, &state.q);
        self.dv.0.iter_mut().for_each(|dv| *dv = -*dv);
        forces.add_force(state.t, &state.q, v.view(), self.dv.view_mut());
        for (freedom, force) in self.dv.0.iter_mut().enumerate() {
            *force *= if mass.is_held(freedom) { 0.0 } else { h };
        }
        system.metric().sharp(self.dv.view(), increment.view_mut());
    }

    /// Bounds what bodies do between two states of a flight.
    pub(crate) fn find_bounds<G: Flies, P: Potential>(
        &mut self,
        system: &BodiesIn<G, P>,
        ends: [&State<Vec<f64>>; 2],
        forces: &impl FlightForces,
    ) {
        let length = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let parts = |rates: &[f64], body: usize| {
            let (linear, turning) =
                rates[G::FREEDOMS * body..][..G::FREEDOMS].split_at(G::TRANSLATION);
            [length(linear), length(turning)]
        };
        let between = (ends[0].t, ends[1].t);
        self.bounds.fill([0.0; 3]);
        self.of_forces.fill([0.0; 2]);
        for end in ends {
            self.find_differential::<G, P>(system, &end.q);
            system.metric().sharp(self.dv.view(), self.rates.view_mut());
            for (body, bounds) in self.bounds.iter_mut().enumerate() {
                let [linear, turning] = parts(&self.rates.0, body);
                let gyroscopic = G::gyroscopic(system.metric(), &end.p.0, body);
                bounds[0] = bounds[0].max(GROWTH * linear);
                bounds[1] = bounds[1].max(GROWTH * (turning + gyroscopic));
            }
            system.metric().sharp(end.p.view(), self.rates.view_mut());
            for (body, bounds) in self.bounds.iter_mut().enumerate() {
                bounds[2] = bounds[2].max(parts(&self.rates.0, body)[1]);
            }
            self.dv.0.fill(0.0);
            forces.add_bounds(between, end, &mut self.dv.0);
            system.metric().sharp(self.dv.view(), self.rates.view_mut());
            for (body, bounds) in self.of_forces.iter_mut().enumerate() {
                let own = parts(&self.rates.0, body);
                bounds.iter_mut().zip(own).for_each(|(b, own)| *b = b.max(GROWTH * own));
            }
        }
        for (bounds, [linear, turning]) in self.bounds.iter_mut().zip(&self.of_forces) {
            bounds[0] += linear;
            bounds[1] += turning;
        }
    }

    /// How long the chords of a flight may be, s.
    pub(crate) fn longest_chord(&self) -> f64 {
        let fastest = |&[_, turning, spin]: &[f64; 3]| {
            // spin d + turning d^2/2 <= TURN
            if turning == 0.0 && spin == 0.0 {
                return f64::INFINITY;
            }
            2.0 * TURN / (spin + (spin * spin + 2.0 * turning * TURN).sqrt())
        };
        self.bounds.iter().map(fastest).fold(f64::INFINITY, f64::min)
    }

    /// How far a body's points within a radius are off its chord over `d` seconds, m.
    pub(crate) fn off_chord(&self, body: usize, radius: f64, d: f64) -> f64 {
        let [linear, turning, _] = self.bounds[body];
        d * d / 8.0 * (linear + radius * turning)
    }
}

/// The chord of a body between two configurations.
pub(crate) fn chord<G: Flies>(
    from: &[f64],
    to: &[f64],
    body: usize,
) -> Result<RigidPathIn<G>, ContactError> {
    let [start, end] = [from, to].map(|q| G::pose(q, body));
    let way = G::translation(&end) - G::translation(&start);
    RigidPathIn::straight(start, way, G::turn_between(from, to, body))
}
