//! Rates that dampers hold back: of the distance of two points, or of a turn.
//!
//! ```text
//! r = J v + r_0,    J M^-1 J^T        what a unit impulse along it changes of it
//! ```
//! `r_0` the rate that a pin gives which moves as it is told.

use crate::assemble::anchor::Anchor;
use crate::model::drives::PinMotion;
use stationary_calculus::array;

/// A rate that a damper holds back.
#[derive(Clone, Debug)]
pub(super) enum Rate {
    /// Of the distance of two points.
    Distance([End; 2]),
    /// A sum of the rates of freedoms.
    Freedoms(Vec<(usize, f64)>),
}

/// An end of a damped spring.
#[derive(Clone, Debug)]
pub(super) enum End {
    /// It is held by freedoms, or by the world.
    Held(Anchor),
    /// A pin that moves, and where it starts.
    Moved(PinMotion, [f64; 3]),
}

/// A rate at a moment.
#[derive(Clone, Debug, Default)]
pub(super) struct RateNow {
    /// How it depends on the rates of freedoms; on none where two points meet.
    pub(super) entries: Vec<(usize, f64)>,
    /// What it is where these are zero.
    told: f64,
}

#[cfg(feature = "contact")]
impl Rate {
    /// The ends that move, of a rate of a distance.
    pub(super) fn anchors(&self) -> impl Iterator<Item = &Anchor> {
        let ends = match self {
            Rate::Distance(ends) => ends.as_slice(),
            Rate::Freedoms(_) => &[],
        };
        ends.iter().filter_map(|end| match end {
            End::Held(anchor) => Some(anchor),
            End::Moved(..) => None,
        })
    }

    /// No less than what pins make of it between two times.
    pub(super) fn fastest_told(&self, (from, to): (f64, f64)) -> f64 {
        let Rate::Distance(ends) = self else { return 0.0 };
        let speed = |end: &End| match end {
            End::Held(_) => 0.0,
            End::Moved(pin, _) => {
                let length = pin.shift.iter().map(|x| x * x).sum::<f64>().sqrt();
                pin.strength.fastest(from, to)[0] * length
            }
        };
        ends.iter().map(speed).sum()
    }
}

impl Rate {
    pub(super) fn now(&self, t: f64, q: &[f64], each: usize) -> RateNow {
        let mut now = RateNow::default();
        self.read((t, q, each), &mut now);
        now
    }

    /// Writes what it is now into the room of another moment.
    pub(super) fn read(&self, (t, q, each): (f64, &[f64], usize), now: &mut RateNow) {
        let RateNow { entries, told } = now;
        entries.clear();
        *told = 0.0;
        let ends = match self {
            Rate::Freedoms(all) => return entries.extend_from_slice(all),
            Rate::Distance(ends) => ends,
        };
        let [a, b] = ends.each_ref().map(|end| match end {
            End::Held(anchor) => anchor.place(q, each),
            End::Moved(pin, start) => pin.place(*start, t),
        });
        let way: [f64; 3] = array(|c| b[c] - a[c]);
        let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 0.0 {
            for (end, sign) in ends.iter().zip([-1.0, 1.0]) {
                let along = way.map(|x| sign * x / length);
                match end {
                    End::Held(anchor) => anchor
                        .pull(q, each, &along, &mut |freedom, part| entries.push((freedom, part))),
                    End::Moved(pin, _) => {
                        *told += along.iter().zip(pin.velocity(t)).map(|(x, v)| x * v).sum::<f64>();
                    }
                }
            }
        }
    }

    /// The particles or bodies of `each` freedoms on which it depends.
    pub(super) fn things(&self, each: usize) -> Vec<usize> {
        let thing = |end: &End| match end {
            End::Held(Anchor::Particle(first)) => Some(first / each),
            End::Held(Anchor::Body(body, _)) => Some(*body),
            End::Held(Anchor::World(_)) | End::Moved(..) => None,
        };
        match self {
            Rate::Distance(ends) => ends.iter().filter_map(thing).collect(),
            Rate::Freedoms(all) => all.iter().map(|&(freedom, _)| freedom / each).collect(),
        }
    }
}

impl RateNow {
    /// The rate at velocities.
    pub(super) fn at(&self, v: &[f64]) -> f64 {
        self.told + self.along(v)
    }

    /// The part of it that velocities make.
    pub(super) fn along(&self, v: &[f64]) -> f64 {
        self.entries.iter().map(|&(freedom, part)| part * v[freedom]).sum()
    }

    /// The same where momenta are `p`, the whole rate, and what a unit impulse along it changes of it.
    pub(super) fn of_momenta(&self, p: &[f64], inverse: &[f64]) -> [f64; 3] {
        let [mut own, mut yields] = [0.0; 2];
        for &(freedom, part) in &self.entries {
            own += part * inverse[freedom] * p[freedom];
            yields += part * inverse[freedom] * part;
        }
        [own, own + self.told, yields]
    }
}
