//! Rods of bodies to pins that move as they are told.
//!
//! ```text
//! g(t, q) = g_0(q - s(t) d),    dg/dt = -s'(t) J d        g_0 the rod to the pin where it starts
//! ```
//! `d` the pin's shift, `s` its strength, taken from the place of the body at the other end: a rod asks how far its
//! ends are apart.

use std::cell::RefCell;

#[cfg(feature = "constraints")]
use stationary_calculus::{Sink, SizeError};
#[cfg(feature = "constraints")]
use stationary_constraints::{Constraint, ConstraintOn, Rows, Scale, check_values};

use crate::model::drives::PinMotion;

/// What holds bodies; a rod among them whose pin moves is led by it.
#[derive(Clone, Debug)]
pub(crate) struct Led<J> {
    held: J,
    by: Option<Leader>,
}

/// A pin that moves, and the body at the other end of its rod.
#[derive(Clone, Debug)]
struct Leader {
    pin: PinMotion,
    /// Where its place stands among the stored numbers and among the freedoms, so many of each.
    stored: usize,
    first: usize,
    dimension: usize,
    room: RefCell<Vec<f64>>,
}

impl<J> Led<J> {
    /// What no pin leads.
    pub(crate) fn by_none(held: J) -> Self {
        Led { held, by: None }
    }

    /// A rod to a pin from a body, each of which has so many stored numbers and freedoms.
    pub(crate) fn by_pin(held: J, pin: PinMotion, body: usize, each: [usize; 2]) -> Self {
        let [stored, first] = each.map(|each| each * body);
        let dimension = if each[1] == 6 { 3 } else { 2 };
        let room = RefCell::default();
        Led { held, by: Some(Leader { pin, stored, first, dimension, room }) }
    }
}

impl Leader {
    /// Shows the configuration as it is seen from the pin.
    fn seen<T>(&self, t: f64, q: &[f64], see: impl FnOnce(&[f64]) -> T) -> T {
        let mut room = self.room.borrow_mut();
        room.clear();
        room.extend_from_slice(q);
        let strength = self.pin.strength.at(t);
        let place = room.iter_mut().skip(self.stored).take(self.dimension);
        place.zip(self.pin.shift).for_each(|(x, shift)| *x -= strength * shift);
        see(&room)
    }
}

/// What the rows of a differential give along a velocity of the pin.
#[cfg(feature = "constraints")]
struct Against<'a> {
    first: usize,
    velocity: &'a [f64],
    rate: &'a mut [f64],
}

#[cfg(feature = "constraints")]
impl Rows for Against<'_> {
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        let own = freedom.checked_sub(self.first).and_then(|c| self.velocity.get(c));
        if let (Some(velocity), Some(rate)) = (own, self.rate.get_mut(row)) {
            *rate -= value * velocity;
        }
    }
}

#[cfg(feature = "constraints")]
impl<S, J: ConstraintOn<S>> ConstraintOn<S> for Led<J> {}

#[cfg(feature = "constraints")]
impl<J: Constraint> Constraint for Led<J> {
    fn dim(&self) -> usize {
        self.held.dim()
    }

    fn count(&self) -> usize {
        self.held.count()
    }

    fn value(&self, t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        match &self.by {
            None => self.held.value(t, q, g),
            Some(pin) => pin.seen(t, q, |q| self.held.value(t, q, g)),
        }
    }

    fn differential(&self, t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        match &self.by {
            None => self.held.differential(t, q, rows),
            Some(pin) => pin.seen(t, q, |q| self.held.differential(t, q, rows)),
        }
    }

    fn add_hessian(
        &self,
        t: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        match &self.by {
            None => self.held.add_hessian(t, q, lambda, hessian),
            Some(pin) => pin.seen(t, q, |q| self.held.add_hessian(t, q, lambda, hessian)),
        }
    }

    fn rate(&self, t: f64, q: &[f64], rate: &mut [f64]) -> Result<(), SizeError> {
        let Some(pin) = &self.by else { return self.held.rate(t, q, rate) };
        check_values(self.count(), rate)?;
        rate.fill(0.0);
        let velocity = &pin.pin.velocity(t)[..pin.dimension];
        let mut against = Against { first: pin.first, velocity, rate };
        pin.seen(t, q, |q| self.held.differential(t, q, &mut against))
    }

    fn scale(&self, row: usize) -> Scale {
        self.held.scale(row)
    }

    fn describe(&self, row: usize) -> Option<String> {
        self.held.describe(row)
    }
}
