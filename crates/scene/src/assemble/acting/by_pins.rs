//! Energies that depend on where pins are that move: of springs, of elements, of attraction.
//!
//! ```text
//! V(q, X(t)),    F = -dV/dq,    W = <dV/dX, dX>,    K = d2V/dq2        X places of pins
//! V = -sum_i G m_i M/|x_i - X|                         of a pin that attracts with the mass M
//! ```

use stationary_calculus::{
    Covector, Curvature, FIXED, Potential, Sink, Stencil, StencilHessian, array,
};
use stationary_elasticity::Spring;
use stationary_integrators::CentralGravity;

use crate::assemble::anchor::Anchor;
use crate::assemble::elastic::ElasticBodies;
use crate::model::drives::PinMotion;

/// A pin that moves, and where it starts.
#[derive(Clone, Debug)]
pub(super) struct MovingPin {
    pub(super) motion: PinMotion,
    pub(super) start: [f64; 3],
}

/// Places of a pin at which a pull is looked at, beside the nearest.
#[cfg(feature = "contact")]
const LOOKS: u8 = 8;

impl MovingPin {
    pub(super) fn place(&self, t: f64) -> [f64; 3] {
        self.motion.place(self.start, t)
    }

    /// Places on its way between two times, both ends and the nearest to another place among them.
    #[cfg(feature = "contact")]
    fn way(&self, (from, to): (f64, f64), other: [f64; 3]) -> impl Iterator<Item = [f64; 3]> {
        let (start, shift) = (self.start, self.motion.shift);
        let [low, high] = self.motion.strength.range(from, to);
        let square: f64 = shift.iter().map(|x| x * x).sum();
        let along: f64 = (0..3).map(|c| (other[c] - start[c]) * shift[c]).sum();
        let nearest = if square > 0.0 { (along / square).clamp(low, high) } else { low };
        let looks = (0..=LOOKS).map(move |k| low + (high - low) * f64::from(k) / f64::from(LOOKS));
        let at = move |s: f64| array(|c| start[c] + s * shift[c]);
        looks.chain([nearest]).map(at)
    }
}

/// What a pin attracts: a centre, up to a radius from which its attraction is that of a point.
#[derive(Clone, Debug)]
pub(super) struct Attracted {
    pub(super) at: Anchor,
    pub(super) number: usize,
    pub(super) strength: f64,
    pub(super) radius: f64,
}

/// An energy that depends on pins that move.
#[derive(Clone, Debug)]
pub(super) enum ByPins {
    Spring {
        spring: Spring,
        pulled: Anchor,
        pin: MovingPin,
    },
    /// Elements that have moving vertices, which are numbered behind those that are free.
    Elements {
        elastic: ElasticBodies,
        pins: Vec<MovingPin>,
        dimension: usize,
    },
    Attraction {
        pin: MovingPin,
        all: Vec<Attracted>,
    },
}

impl ByPins {
    pub(super) fn energy(&self, now: (f64, &[f64]), each: usize) -> f64 {
        match self {
            ByPins::Spring { spring, pulled, pin } => {
                let ends = [pin.place(now.0), pulled.place(now.1, each)];
                Stencil::<2, 3>::energy(spring, &ends)
            }
            ByPins::Elements { elastic, pins, dimension } => {
                elastic.energy(&with_pins(now, pins, *dimension))
            }
            ByPins::Attraction { pin, all } => {
                let of = |one: &Attracted| one.law().energy(&one.way(pin, now, each));
                all.iter().map(of).sum()
            }
        }
    }

    /// Tells the forces on freedoms.
    pub(super) fn forces(&self, now: (f64, &[f64]), each: usize, tell: &mut dyn FnMut(usize, f64)) {
        match self {
            ByPins::Spring { pulled, .. } => {
                let [_, pull] = self.pull(now, each);
                pulled.pull(now.1, each, &pull.map(|pull| -pull), tell);
            }
            ByPins::Elements { .. } => {
                let dv = self.differential(now);
                let felt = dv.iter().enumerate().take(now.1.len()).filter(|(_, dv)| **dv != 0.0);
                felt.for_each(|(freedom, dv)| tell(freedom, -dv));
            }
            ByPins::Attraction { pin, all } => {
                for one in all {
                    let pull = one.pull(pin, now, each).map(|pull| -pull);
                    one.at.pull(now.1, each, &pull, tell);
                }
            }
        }
    }

    /// Adds the second differential by the freedoms of particles.
    pub(super) fn add_hessian(&self, now: (f64, &[f64]), each: usize, hessian: &mut impl Sink) {
        match self {
            ByPins::Spring { spring, pulled, pin } => {
                let ends = [pin.place(now.0), pulled.place(now.1, each)];
                let block = Stencil::<2, 3>::hessian(spring, &ends, Curvature::Exact);
                let own = array(|d| block[1][d][1]);
                pulled.add_symmetric(each, own, hessian);
            }
            ByPins::Elements { elastic, pins, dimension } => {
                let free = now.1.len();
                let q = with_pins(now, pins, *dimension);
                elastic.add_hessian(&q, &mut FreeFreedoms { free, hessian });
            }
            ByPins::Attraction { pin, all } => {
                for one in all {
                    let mut own = [[0.0; 3]; 3];
                    let mut sink = Block(&mut own);
                    one.law().add_hessian(&one.way(pin, now, each), &mut sink);
                    one.at.add_symmetric(each, own, hessian);
                }
            }
        }
    }

    /// The differential by the place of each pin.
    pub(super) fn by_places(&self, now: (f64, &[f64]), each: usize) -> Vec<(&MovingPin, [f64; 3])> {
        match self {
            ByPins::Spring { pin, .. } => vec![(pin, self.pull(now, each)[0])],
            ByPins::Elements { pins, dimension, .. } => {
                let dv = self.differential(now);
                let of_pins = dv[now.1.len()..].chunks_exact(*dimension);
                let in_space = |dv: &[f64]| array(|c| dv.get(c).copied().unwrap_or(0.0));
                pins.iter().zip(of_pins.map(in_space)).collect()
            }
            ByPins::Attraction { pin, all } => {
                let mut sum = [0.0; 3];
                for one in all {
                    let pull = one.pull(pin, now, each);
                    sum.iter_mut().zip(pull).for_each(|(sum, pull)| *sum -= pull);
                }
                vec![(pin, sum)]
            }
        }
    }

    /// Tells each body's anchor and no less than the pull there, wherever on its way between two times the pin is.
    #[cfg(feature = "contact")]
    pub(super) fn largest_pulls(
        &self,
        between: (f64, f64),
        now: (f64, &[f64]),
        each: usize,
        tell: &mut dyn FnMut(&Anchor, f64),
    ) {
        let size = |x: [f64; 3]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        match self {
            ByPins::Spring { spring, pulled, pin } => {
                let at = pulled.place(now.1, each);
                let pull = |pin| size(Stencil::<2, 3>::differential(spring, &[pin, at])[1]);
                tell(pulled, pin.way(between, at).map(pull).fold(0.0, f64::max));
            }
            ByPins::Attraction { pin, all } => {
                for one in all {
                    let at = one.at.place(now.1, each);
                    let pull = |pin: [f64; 3]| {
                        let mut dv = [0.0; 3];
                        let way: [f64; 3] = array(|c| at[c] - pin[c]);
                        one.law().add_differential(&way, Covector(&mut dv));
                        size(dv)
                    };
                    tell(&one.at, pin.way(between, at).map(pull).fold(0.0, f64::max));
                }
            }
            // Bodies have no elements.
            ByPins::Elements { .. } => {}
        }
    }

    /// The first time after `t` at which a pin does not move smoothly.
    pub(super) fn next_corner(&self, t: f64) -> Option<f64> {
        let pins = match self {
            ByPins::Spring { pin, .. } | ByPins::Attraction { pin, .. } => {
                std::slice::from_ref(pin)
            }
            ByPins::Elements { pins, .. } => pins,
        };
        let corners = pins.iter().filter_map(|pin| pin.motion.strength.next_corner(t));
        corners.min_by(f64::total_cmp)
    }

    #[cfg(feature = "rigid")]
    /// The first ball inside of which a pin is that attracts it: their numbers, their distance and its radius.
    pub(super) fn inside(&self, now: (f64, &[f64]), each: usize) -> Option<([usize; 2], [f64; 2])> {
        let ByPins::Attraction { pin, all } = self else { return None };
        let apart =
            |one: &Attracted| one.way(pin, now, each).iter().map(|x| x * x).sum::<f64>().sqrt();
        let pairs =
            all.iter().map(|one| ([one.number, pin.motion.particle], [apart(one), one.radius]));
        pairs.into_iter().find(|(_, [apart, radius])| apart < radius)
    }

    /// The differential of the energy of a spring, by the places of the pin and of what it pulls.
    fn pull(&self, (t, q): (f64, &[f64]), each: usize) -> [[f64; 3]; 2] {
        let ByPins::Spring { spring, pulled, pin } = self else { return [[0.0; 3]; 2] };
        Stencil::<2, 3>::differential(spring, &[pin.place(t), pulled.place(q, each)])
    }

    /// The differential of the energy of elements, by the free coordinates and those of the pins.
    fn differential(&self, now: (f64, &[f64])) -> Vec<f64> {
        let ByPins::Elements { elastic, pins, dimension } = self else { return Vec::new() };
        let q = with_pins(now, pins, *dimension);
        let mut dv = vec![0.0; q.len()];
        elastic.add_differential(&q, Covector(&mut dv));
        dv
    }
}

impl Attracted {
    fn law(&self) -> CentralGravity<3> {
        CentralGravity { strength: self.strength }
    }

    /// From the pin to it.
    fn way(&self, pin: &MovingPin, (t, q): (f64, &[f64]), each: usize) -> [f64; 3] {
        let (from, to) = (pin.place(t), self.at.place(q, each));
        array(|c| to[c] - from[c])
    }

    /// The differential of the energy by its place.
    fn pull(&self, pin: &MovingPin, now: (f64, &[f64]), each: usize) -> [f64; 3] {
        let mut dv = [0.0; 3];
        self.law().add_differential(&self.way(pin, now, each), Covector(&mut dv));
        dv
    }
}

/// Passes on what free freedoms feel: those of pins come after them.
struct FreeFreedoms<'a, S> {
    free: usize,
    hessian: &'a mut S,
}

impl<S> FreeFreedoms<'_, S> {
    fn seen(&self, freedom: usize) -> usize {
        if freedom < self.free { freedom } else { FIXED }
    }
}

impl<S: Sink> Sink for FreeFreedoms<'_, S> {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        let seen: Vec<usize> = freedoms.iter().map(|&freedom| self.seen(freedom)).collect();
        self.hessian.add_symmetric(&seen, block);
    }

    fn add_vertices<const V: usize, const D: usize>(
        &mut self,
        freedoms: &[[usize; D]; V],
        block: &StencilHessian<V, D>,
    ) {
        let seen = freedoms.map(|vertex| vertex.map(|freedom| self.seen(freedom)));
        self.hessian.add_vertices(&seen, block);
    }
}

/// A matrix of three by three.
struct Block<'a>(&'a mut [[f64; 3]; 3]);

impl Sink for Block<'_> {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        for (&j, column) in freedoms.iter().zip(block.chunks_exact(freedoms.len().max(1))) {
            freedoms.iter().zip(column).for_each(|(&i, entry)| self.0[j][i] += entry);
        }
    }
}

/// The free coordinates, then those of the pins.
fn with_pins((t, q): (f64, &[f64]), pins: &[MovingPin], dimension: usize) -> Vec<f64> {
    let places = pins.iter().flat_map(|pin| pin.place(t).into_iter().take(dimension));
    q.iter().copied().chain(places).collect()
}
