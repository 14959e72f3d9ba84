//! How long bodies in flight stay apart: the instant of the next contact, proved chord by chord.
//!
//! ```text
//! distance of the chords > e + s/4 on them   =>   distance in flight > s/4
//! ```
//! `s` the skin at which things touch (m), `e` how far flights are off their chords (`flight.rs`). A chord
//! that is not free ends where it was proved to be, and the next ones are four times shorter, until `e` is
//! below the skin: the distance there is between zero and the skin. What touches where a flight starts must
//! be seen to leave along a whole chord, which is shortened until it does.
//! Source: `rigid_time_of_impact.rs`.

use stationary_calculus::Potential;
use stationary_integrators::State;
use stationary_rigid::LieGroup;

use crate::order::flight::{Flies, Flight, chord};
use crate::order::flight_forces::FlightForces;
use crate::when::rigid_time_of_impact::{MeetRoom, Queries, Swept, leaves, meet};
use crate::{BodiesIn, Closeness, ContactError, DetectorIn, Dimension, RigidPathIn};

/// Chords of a flight after which what is left counts as not free.
const CHORDS: usize = 10_000;
/// Intervals of a chord after which what is left of it counts as not free.
const INTERVALS: usize = 1_000;

/// How far a flight is free, and where that ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FreeTime {
    /// Seconds.
    pub(crate) time: f64,
    /// Whether something touches then.
    pub(crate) touches: bool,
    /// Pairs of chords looked at.
    pub(crate) queries: usize,
}

/// Room for the search.
#[derive(Debug)]
pub(crate) struct FreeTimeSearch<G: Dimension> {
    pairs: Vec<(usize, usize)>,
    radii: Vec<f64>,
    room: MeetRoom<G>,
    from: State<Vec<f64>>,
    to: State<Vec<f64>>,
}

impl<G: Flies> Default for FreeTimeSearch<G> {
    fn default() -> Self {
        let (from, to) = Default::default();
        FreeTimeSearch { pairs: Vec::new(), radii: Vec::new(), room: MeetRoom::default(), from, to }
    }
}

impl<G: Flies> FreeTimeSearch<G> {
    /// How long a state flies freely, `most` seconds at most; `end` is the state after all of them.
    pub(crate) fn free_time<P: Potential>(
        &mut self,
        flight: &mut Flight,
        system: &BodiesIn<G, P>,
        detector: &mut DetectorIn<G>,
        [start, end]: [&State<Vec<f64>>; 2],
        forces: &mut impl FlightForces,
        skin: f64,
    ) -> Result<FreeTime, ContactError> {
        let most = end.t - start.t;
        flight.find_bounds::<G, P>(system, [start, end], forces);
        self.find_pairs(flight, detector, [start, end], most, skin)?;
        let mut free = FreeTime { time: 0.0, touches: false, queries: 0 };
        if self.pairs.is_empty() {
            return Ok(FreeTime { time: most, ..free });
        }
        self.from.clone_from(start);
        let longest = flight.longest_chord();
        let mut length = longest.min(most);
        for _ in 0..CHORDS {
            let last = length >= most - free.time;
            let d = if last { most - free.time } else { length };
            if last {
                self.to.clone_from(end);
            } else {
                flight.fly::<G, P>(system, start, free.time + d, forces, &mut self.to)?;
            }
            let (part, off) = self.free_part(flight, detector, d, skin, &mut free.queries)?;
            match part {
                None if last => return Ok(FreeTime { time: most, ..free }),
                None => {
                    free.time += d;
                    std::mem::swap(&mut self.from, &mut self.to);
                    length = (4.0 * d).min(longest);
                    continue;
                }
                Some(part) => {
                    free.time += part * d;
                    if off <= 0.25 * skin || free.time + 0.25 * d <= free.time {
                        return Ok(FreeTime { touches: true, ..free });
                    }
                    if part > 0.0 {
                        flight.fly::<G, P>(system, start, free.time, forces, &mut self.from)?;
                    }
                    length = 0.25 * d;
                }
            }
        }
        Ok(FreeTime { touches: true, ..free })
    }

    /// The pairs of colliders that may meet in the flight.
    fn find_pairs(
        &mut self,
        flight: &Flight,
        detector: &mut DetectorIn<G>,
        [start, end]: [&State<Vec<f64>>; 2],
        most: f64,
        skin: f64,
    ) -> Result<(), ContactError> {
        self.radii.clear();
        self.radii.extend((0..detector.bodies()).map(|body| detector.reach_of(body)));
        let radii = &self.radii;
        let reach = |body: Option<usize>| {
            body.map_or(skin, |body| {
                let [from, to] = [start, end].map(|state| G::translation(&G::pose(&state.q, body)));
                let way = to - from;
                let straight = G::dot(&way, &way).sqrt();
                // A box about a body that turns holds the ball about its centre.
                let turns = flight.longest_chord().is_finite();
                let ball = if turns { 2.0 * radii[body] } else { 0.0 };
                straight + flight.off_chord(body, 0.0, most) + ball + skin
            })
        };
        detector.find_candidates(&start.q, reach)?;
        self.pairs.clear();
        self.pairs.extend_from_slice(detector.candidates());
        Ok(())
    }

    /// The part of the chords that is proved free where it is not all of them, and how far flights are
    /// off them.
    fn free_part(
        &mut self,
        flight: &Flight,
        detector: &DetectorIn<G>,
        d: f64,
        skin: f64,
        queries: &mut usize,
    ) -> Result<(Option<f64>, f64), ContactError> {
        let (mut first, mut worst): (Option<f64>, f64) = (None, 0.0);
        for &(a, b) in &self.pairs {
            *queries += 1;
            let colliders = [a, b].map(|i| &detector.colliders()[i]);
            let path = |body: Option<usize>| match body {
                Some(body) => chord::<G>(&self.from.q, &self.to.q, body),
                None => RigidPathIn::still(G::Motion::identity()),
            };
            let paths = [path(colliders[0].body())?, path(colliders[1].body())?];
            let bodies = [0, 1]
                .map(|k| Swept::<G>::new(&colliders[k].shape, &colliders[k].place, &paths[k]));
            let off = |body: usize| flight.off_chord(body, detector.reach_of(body), d);
            let off: f64 = colliders.iter().filter_map(|c| c.body()).map(off).sum();
            let close = Closeness { thickness: off + 0.25 * skin, tolerance: off.max(0.5 * skin) };
            let touching = |parts: &[u32; 2], queries: &mut Queries<G>| {
                leaves(&bodies, *parts, skin, 4.0 * off, queries)
            };
            if let Some(hit) = meet(&bodies, close, INTERVALS, &mut self.room, touching)
                && first.is_none_or(|part| hit.time < part || (hit.time == part && off > worst))
            {
                (first, worst) = (Some(hit.time), off);
            }
        }
        Ok((first, worst))
    }
}
