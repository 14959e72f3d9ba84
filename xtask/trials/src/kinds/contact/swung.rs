//! A block on a table, which a force that swings drags or lifts or which is shaken, under steps chosen by their error.
//!
//! ```text
//! u. = F sin(w t)/m - sign(u) mu g        dragged, where it slips; else u = 0
//! u. = F sin(w t)/m - g                   lifted, where it flies; else u = 0
//! u. = sign(V sin(w t) - u) mu g          shaken, where it slips; else u = V sin(w t)
//! ```
//! The referee takes half a million steps of these numbers, in which slip and flight begin and end.

use nalgebra::Vector2;
use stationary_calculus::{Covector, DiagonalMetric, Force, System, Vector};
use stationary_contact::{
    ContactError, ErrorControlled, PlanarCollider, PlanarDetector, PlanarShape, PlanarWorld,
    StepForces,
};
use stationary_integrators::State;
use stationary_rigid::PlanarWeight;

use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "swung-blocks",
    krate: "contact",
    rule: "a block on a table that a swinging force drags or lifts, or whose table is shaken: its place off by more \
           than five times the accuracy that was asked for, which bounds what single steps add, and what the referee \
           may be off, at any of ten times in two seconds",
    in_tests: 50,
    trial,
};

const TIME: f64 = 2.0;
const PIECES: usize = 10;
const STEPS: usize = 50_000;
/// What the referee may be off, in parts of the block's size.
const REFEREE: f64 = 5e-6;

#[derive(Clone, Copy, Debug, PartialEq)]
enum How {
    Dragged,
    Lifted,
    Shaken,
}

/// What swings: a force on the block, or the speed of the table.
#[derive(Clone, Copy, Debug)]
struct Swing {
    how: How,
    size: f64,
    omega: f64,
    /// Over the step.
    from: f64,
    h: f64,
}

impl Swing {
    fn at(&self, t: f64) -> f64 {
        self.size * (self.omega * t).sin()
    }

    /// The integral over a time.
    fn sum(&self, from: f64, h: f64) -> f64 {
        self.size / self.omega * ((self.omega * from).cos() - (self.omega * (from + h)).cos())
    }
}

impl Force for Swing {
    fn dim(&self) -> usize {
        6
    }

    fn add_force(&self, _: f64, _: &[f64], _: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        let mean = self.sum(self.from, self.h) / self.h;
        match self.how {
            How::Dragged => f.0[0] += mean,
            How::Lifted => f.0[1] += mean,
            How::Shaken => {}
        }
    }
}

impl StepForces for Swing {
    fn prepare(&mut self, state: &mut State<Vec<f64>>, h: f64) {
        (self.from, self.h) = (state.t, h);
        if self.how == How::Shaken {
            state.q[3] = self.sum(0.0, state.t);
            state.p.0[3] = self.sum(state.t, h) / h;
        }
    }

    fn add_works(&self, _: [&State<Vec<f64>>; 2], _: Vector<&[f64]>, _: &mut [f64]) {}

    fn add_swings(&self, _: &State<Vec<f64>>, swings: &mut [f64]) {
        // A force changes no faster than this, nor does the table's acceleration.
        let change = (self.size * self.omega * self.h).min(2.0 * self.size);
        match self.how {
            How::Dragged => swings[0] += change,
            How::Lifted => swings[1] += change,
            How::Shaken => swings[3] += self.omega * change,
        }
    }

    fn next_corner(&self, _: f64) -> Option<f64> {
        None
    }
}

struct Block {
    mass: f64,
    size: f64,
    friction: f64,
    gravity: f64,
}

impl Block {
    fn chosen(
        &self,
        accuracy: f64,
    ) -> Result<ErrorControlled<stationary_contact::Planar, PlanarWeight>, ContactError> {
        let body = |body, half: [f64; 2]| {
            let shape = PlanarShape::cuboid(half.map(|half| half * self.size))?;
            Ok(PlanarCollider::on_body(body, shape).with_friction(self.friction))
        };
        let colliders: Result<Vec<_>, ContactError> =
            [body(0, [0.5, 0.05]), body(1, [50.0, 1.0])].into_iter().collect();
        let moment = 0.1 * self.mass * self.size * self.size;
        let metric = DiagonalMetric::new(vec![self.mass, self.mass, moment, 1.0, 1.0, 1.0])?;
        let gravity = Vector2::y() * -self.gravity;
        let weight = PlanarWeight { gravity, masses: vec![self.mass, 1.0] };
        let world =
            PlanarWorld::new(System::new(metric, weight)?, PlanarDetector::new(colliders?, 2)?)?;
        ErrorControlled::new(world.with_obstacles(vec![1])?, accuracy)?.with_horizon(TIME)
    }

    /// A step of the referee, of place and velocity; whether it lands while it is lifted: a landing without restitution
    /// is shared between two steps, and what it leaves of a speed then has no order in them.
    fn go(&self, swing: &Swing, x: &mut [f64; 2], t: f64, h: f64) -> bool {
        let (grip, before) = (h * self.friction * self.gravity, x[1]);
        match swing.how {
            How::Dragged => {
                let free = x[1] + swing.sum(t, h) / self.mass;
                x[1] = free.signum() * (free.abs() - grip).max(0.0);
            }
            How::Lifted => x[1] += swing.sum(t, h) / self.mass - h * self.gravity,
            How::Shaken => {
                let slip = swing.at(t + h) - x[1];
                x[1] += slip.signum() * slip.abs().min(grip);
            }
        }
        x[0] += 0.5 * h * (before + x[1]);
        let lands = swing.how == How::Lifted && x[0] <= 0.0;
        let falls = x[1] < 0.0;
        if lands {
            *x = [0.0, x[1].max(0.0)];
        }
        lands && falls && swing.at(t) > self.mass * self.gravity
    }
}

fn trial(draw: &mut Draw) -> Verdict {
    let size = draw.log_uniform(1e-3, 1e3);
    let block = Block {
        mass: draw.log_uniform(1e-3, 1e3),
        size,
        friction: draw.uniform(0.1, 0.9),
        gravity: size * draw.log_uniform(3.0, 30.0),
    };
    let how = draw.one_of(&[How::Dragged, How::Lifted, How::Shaken]);
    let omega = draw.log_uniform(2.0, 60.0);
    let holds = match how {
        How::Dragged => block.friction * block.mass * block.gravity,
        How::Lifted => block.mass * block.gravity,
        How::Shaken => block.friction * block.gravity / omega,
    };
    let mut swing =
        Swing { how, size: holds * draw.log_uniform(0.8, 4.0), omega, from: 0.0, h: 1.0 };
    let accuracy = size * draw.log_uniform(1e-5, 1e-2);
    draw.note(format!(
        "{how:?} a block of {} kg and {size} m, friction {}, gravity {}, by {} of what holds it, {omega} /s, \
         to {accuracy} m",
        block.mass,
        block.friction,
        block.gravity,
        swing.size / holds
    ));
    let mut chosen = match block.chosen(accuracy) {
        Ok(chosen) => chosen,
        Err(error) => return Verdict::refused(error),
    };
    let rest = [0.0, 0.05 * size, 0.0, 0.0, -size, 0.0];
    let mut state = State::new(rest.to_vec(), Covector(vec![0.0; 6]));
    let (axis, mut x) = (usize::from(how == How::Lifted), [0.0; 2]);
    let piece = TIME / PIECES as f64;
    let mut verdict = Verdict::due();
    for k in 0..PIECES {
        if let Err(error) = chosen.advance_under(&mut state, piece, &mut swing) {
            return verdict.and(Verdict::refused(error));
        }
        let h = piece / STEPS as f64;
        let start = piece * k as f64;
        if (0..STEPS).any(|step| block.go(&swing, &mut x, start + h * step as f64, h)) {
            return verdict.and(Verdict::not_judged("it lands while it is lifted"));
        }
        let off = (state.q[axis] - rest[axis] - x[0]).abs();
        verdict =
            verdict.and(Verdict::of(off, 5.0 * accuracy + REFEREE * size, "the block's place"));
    }
    verdict
}
