//! What acts on a scene and no potential gives: loads, motors, gravity in time, pins that move, drag.
//!
//! ```text
//! p <- p + h/2 s F(t, q),    the method's own step,    p <- p + h/2 s F(t + h, q')
//! s = 1/h int_t^(t+h) strength,       drag   p <- p/(1 + x) before,   p <- (1 - x) p after,   x = h c/2m
//! damper  F = -c r along a rate r = J v, alike, all at once (see `dampers.rs`)
//! W_k = sum of <J_k, M^-1 (p + J_k/2)>,   J_k = h/2 s F_k         the kinetic energy that each brings
//! W   = sum of <dV/dx, dx>/2                                      of pins that move by dx in the step
//! ```
//! `F` forces (n), `p` momenta, `M` masses, `c` drag, `V` what depends on pins that move (see `by_pins.rs`). The
//! second kick is the first one backward: order 2 along with any method of that order. Strengths are means
//! over the step, so that no pulse is missed. Methods that take forces themselves ask for [`Force`].

#[cfg(feature = "contact")]
mod bounds;
#[cfg(feature = "elasticity")]
mod by_pins;
mod dampers;
mod frame;
mod impulses;
mod of_scene;
mod rate;

#[cfg(feature = "elasticity")]
use crate::assemble::acting::by_pins::{ByPins, MovingPin};
use crate::assemble::acting::dampers::{Dampers, Held};
use crate::assemble::acting::frame::Frame;
use crate::assemble::acting::rate::Rate;
use crate::assemble::anchor::wrench;
use crate::model::scene::Scene;
use crate::model::strength::Strength;
use stationary_calculus::{Covector, Force, Sink, Vector};
#[cfg(feature = "contact")]
use stationary_integrators::State;

pub(crate) use impulses::Impulses;

/// What acts on a scene, and the works of the last step.
#[derive(Clone, Debug)]
pub(crate) struct Acting {
    acts: Vec<Act>,
    dampers: Dampers,
    /// One over the mass of each freedom.
    inverse: Vec<f64>,
    /// Freedoms of a particle or a body, of which the first are shifts along the dimensions.
    each: usize,
    dimension: usize,
    works: Vec<f64>,
    /// The time over which a force takes the mean of a strength.
    width: f64,
}

#[derive(Clone, Debug)]
struct Act {
    name: String,
    strength: Strength,
    what: What,
}

#[derive(Clone, Debug)]
enum What {
    /// The force over the velocity of every particle, and of the centre of every body.
    Drag(f64),
    /// A frame that turns, in which all is seen.
    Frame(Frame),
    /// An acceleration of every freedom, which repeats.
    Weight(Vec<f64>),
    /// Forces on freedoms.
    Freedoms(Vec<(usize, f64)>),
    /// A force and a torque at a point of a body.
    Point { body: usize, point: [f64; 3], force: [f64; 3], torque: [f64; 3] },
    /// What holds back a coordinate: the force over its rate.
    Damper(f64, Rate),
    /// An energy that depends on pins that move.
    #[cfg(feature = "elasticity")]
    ByPins(ByPins),
}

/// At which end of a step a kick is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Start,
    Finish,
}

impl Acting {
    /// What acts on a scene, where anything does.
    pub(crate) fn of(scene: &Scene) -> Option<Self> {
        let mut acts = Vec::new();
        if let Some(drag) = scene.drag {
            let strength = Strength::constant(1.0);
            acts.push(Act { name: "drag".to_owned(), strength, what: What::Drag(drag) });
        }
        if let Some(turning) = scene.frame {
            let (each, dimension) = (scene.freedoms_of_each(), scene.dimension);
            let what = What::Frame(Frame { turning, each, dimension });
            let strength = Strength::constant(1.0);
            acts.push(Act { name: "frame".to_owned(), strength, what });
        }
        if let (Some(strength), Some(g)) = (&scene.drives.gravity, scene.gravity.acceleration) {
            let (strength, what) = (strength.clone(), What::Weight(scene.repeated(g)));
            acts.push(Act { name: "gravity".to_owned(), strength, what });
        }
        acts.extend(scene.loads());
        acts.extend(scene.motors());
        acts.extend(scene.dampers());
        acts.extend(scene.by_pins());
        if acts.is_empty() {
            return None;
        }
        let works = vec![0.0; acts.len()];
        let (inverse, each) = (scene.inverse_masses(), scene.freedoms_of_each());
        let dimension = scene.dimension;
        let dampers = Dampers::of(&acts, inverse.len(), (each, dimension));
        Some(Acting { acts, dampers, inverse, each, dimension, works, width: 0.0 })
    }

    /// The same, where a force takes the means of strengths over this time.
    pub(crate) fn with_width(self, width: f64) -> Self {
        Acting { width, ..self }
    }

    /// The freedoms on which it acts.
    #[cfg(feature = "contact")]
    pub(crate) fn freedoms(&self) -> usize {
        self.inverse.len()
    }

    /// The works of what acts in the last step.
    pub(crate) fn works(&self) -> &[f64] {
        &self.works
    }

    /// The energies that depend on pins that move.
    pub(crate) fn energy(&self, t: f64, q: &[f64]) -> f64 {
        self.acts.iter().map(|act| act.what.energy((t, q), self.each)).sum()
    }

    /// The first time after `t` at which a strength is not smooth.
    pub(crate) fn next_corner(&self, t: f64) -> Option<f64> {
        let of_acts = self.acts.iter().filter_map(|act| act.strength.next_corner(t));
        let of_pins = self.acts.iter().filter_map(|act| act.what.next_corner(t));
        of_acts.chain(of_pins).min_by(f64::total_cmp)
    }

    /// The first ball inside of which a pin is that attracts it: their numbers, their distance and its radius.
    #[cfg(feature = "rigid")]
    pub(crate) fn inside(&self, t: f64, q: &[f64]) -> Option<([usize; 2], [f64; 2])> {
        #[cfg(feature = "elasticity")]
        for act in &self.acts {
            if let What::ByPins(led) = &act.what
                && let Some(inside) = led.inside((t, q), self.each)
            {
                return Some(inside);
            }
        }
        let _ = (t, q);
        None
    }

    /// Adds the impulses of half a step.
    pub(crate) fn kick(&mut self, end: End, (t, h): (f64, f64), q: &[f64], p: &mut [f64]) {
        if end == End::Start {
            self.works.fill(0.0);
        } else {
            self.hold_back(end, (t + h, h), q, p);
        }
        let now = if end == End::Start { t } else { t + h };
        let Acting { acts, inverse, each, works, .. } = self;
        for (act, work) in acts.iter().zip(works) {
            let scale = 0.5 * h * act.strength.mean(t, t + h);
            let mut brought = 0.0;
            act.what.forces((now, q), inverse, *each, &mut |freedom, force| {
                let impulse = scale * force;
                brought += impulse * inverse[freedom] * (p[freedom] + 0.5 * impulse);
                p[freedom] += impulse;
            });
            *work += match act.what.work_of_pins((now, q), (t, t + h), *each) {
                Some(pulled) => 0.5 * pulled,
                None => brought,
            };
        }
        if end == End::Start {
            self.hold_back(end, (t, h), q, p);
        }
    }

    /// Drag and dampers, and a frame, for half a step: at its end in the other order, and backward.
    fn hold_back(&mut self, end: End, (now, h): (f64, f64), q: &[f64], p: &mut [f64]) {
        let Acting { acts, dampers, inverse, each, works, .. } = self;
        if end == End::Start {
            dampers.hold_back((now, 0.5 * h), (q, *each), (p, inverse), end, works);
        }
        for act in acts.iter() {
            let What::Frame(frame) = act.what else { continue };
            let things = p.chunks_exact_mut(*each).zip(inverse.chunks_exact(*each));
            for (seen, (p, inverse)) in frame.seen(q).zip(things) {
                frame.turn(0.5 * h, &seen, p, inverse);
            }
        }
        if end == End::Finish {
            dampers.hold_back((now, 0.5 * h), (q, *each), (p, inverse), end, works);
        }
    }

    /// Adds the power of each thing that acts along a velocity `u`, times `scale`, to the works.
    pub(crate) fn add_powers(&mut self, scale: f64, t: f64, q: &[f64], p: &[f64], u: &[f64]) {
        self.add_along(scale, (t, q, p), u, |what, each| what.power_of_pins((t, q), each));
    }

    /// Adds half of the works that forces of one moment do in a step in which all moves by `u`, and pins as they do.
    pub(crate) fn add_half_works(
        &mut self,
        (from, to): (f64, f64),
        (t, q, p): (f64, &[f64], &[f64]),
        u: &[f64],
    ) {
        let of_pins = |what: &What, each| what.work_of_pins((t, q), (from, to), each);
        self.add_along(0.5, (t, q, p), u, of_pins);
    }

    /// Adds what each thing that acts does along `u`, times `scale`, to the works; what pins do is told.
    fn add_along(
        &mut self,
        scale: f64,
        (t, q, p): (f64, &[f64], &[f64]),
        u: &[f64],
        of_pins: impl Fn(&What, usize) -> Option<f64>,
    ) {
        let half = 0.5 * self.width;
        let Acting { acts, inverse, each, dimension, works, .. } = self;
        for (act, work) in acts.iter().zip(works) {
            let strength = act.strength.mean(t - half, t + half);
            let power = match act.what {
                What::Drag(c) => {
                    let along = |freedom: usize| p[freedom] * inverse[freedom] * u[freedom];
                    -c * shifts(u.len(), *each, *dimension).map(along).sum::<f64>()
                }
                What::Damper(c, ref rate) => {
                    let rate = rate.now(t, q, *each);
                    -c * rate.of_momenta(p, inverse)[1] * rate.along(u)
                }
                _ => match of_pins(&act.what, *each) {
                    Some(power) => power,
                    None => {
                        let mut power = 0.0;
                        act.what.forces((t, q), inverse, *each, &mut |freedom, force| {
                            power += strength * force * u[freedom];
                        });
                        power
                    }
                },
            };
            *work += scale * power;
        }
    }

    /// Writes the velocity of a momentum.
    pub(crate) fn velocity(&self, p: &[f64], v: &mut [f64]) {
        v.iter_mut().zip(p).zip(&self.inverse).for_each(|((v, p), inverse)| *v = p * inverse);
    }

    /// Adds the impulses of a whole step, taken at its start, of a state with or without bodies that nothing acts on
    /// behind the scene's; drag and all dampers together end where they would
    /// by implicit Euler, and a frame turns momenta as by itself.
    pub(crate) fn give(&mut self, (t, h): (f64, f64), q: &[f64], p: &[f64], given: &mut Impulses) {
        given.dim = self.inverse.len();
        let p = &p[..given.dim];
        let at = (q, self.each);
        let (found, pulls) = self.dampers.find((t, h), at, (p, &self.inverse), End::Start);
        let mut found = found.iter();
        for act in &self.acts {
            let scale = h * act.strength.mean(t, t + h);
            match act.what {
                What::Drag(c) => {
                    for freedom in shifts(p.len(), self.each, self.dimension) {
                        let x = h * c * self.inverse[freedom];
                        given
                            .entries
                            .push((freedom, -(p[freedom] + pulls[freedom]) * x / (1.0 + x)));
                    }
                }
                What::Damper(..) => {
                    given.entries.extend(found.next().into_iter().flat_map(Held::gives))
                }
                _ => act.what.forces((t, q), &self.inverse, self.each, &mut |freedom, force| {
                    given.entries.push((freedom, scale * force));
                }),
            }
            if let What::Frame(frame) = act.what {
                for (k, seen) in frame.seen(q).enumerate().take(p.len() / self.each) {
                    let own = self.each * k..self.each * (k + 1);
                    let mut turned = [0.0; 6];
                    let turned = &mut turned[..self.each];
                    turned.copy_from_slice(&p[own.clone()]);
                    frame.turn(h, &seen, turned, &self.inverse[own.clone()]);
                    let given_by = turned.iter().zip(&p[own.clone()]).map(|(after, p)| after - p);
                    given.entries.extend(own.zip(given_by));
                }
            }
            given.ends.push(given.entries.len());
        }
    }

    /// Adds the works of what was given over a step between two states, along its mean velocity `u`; of a pin that
    /// moves that of its own motion.
    #[cfg(feature = "contact")]
    pub(crate) fn add_given_works(
        &self,
        given: &Impulses,
        [before, after]: [&State<Vec<f64>>; 2],
        u: &[f64],
        works: &mut [f64],
    ) {
        let brought = given.works(|freedom| u[freedom]);
        for ((act, brought), work) in self.acts.iter().zip(brought).zip(works) {
            let pulled = |now: &State<Vec<f64>>| {
                act.what.work_of_pins((now.t, &now.q), (before.t, after.t), self.each)
            };
            *work += match (pulled(before), pulled(after)) {
                (Some(first), Some(last)) => 0.5 * (first + last),
                _ => brought,
            };
        }
    }

    /// The velocities and impulses of dampers that share bodies and were not solved, since this was asked last.
    pub(crate) fn take_unsolved(&mut self) -> Option<usize> {
        self.dampers.take_unsolved()
    }

    /// Forgets the works of the last step.
    pub(crate) fn begin(&mut self) {
        self.works.fill(0.0);
    }
}

/// The freedoms that are shifts, where each particle or body has so many.
fn shifts(freedoms: usize, each: usize, dimension: usize) -> impl Iterator<Item = usize> {
    (0..freedoms).filter(move |freedom| freedom % each < dimension)
}

impl What {
    /// Tells the forces at a time and a configuration, freedom by freedom.
    fn forces(
        &self,
        now: (f64, &[f64]),
        inverse: &[f64],
        each: usize,
        tell: &mut dyn FnMut(usize, f64),
    ) {
        match self {
            What::Drag(_) | What::Damper(..) => {}
            // The part that does work; the other turns momenta.
            What::Frame(frame) => {
                for (k, seen) in frame.seen(now.1).enumerate().take(inverse.len() / each) {
                    let outward = frame.outward(&seen, &inverse[each * k..]);
                    (each * k..).zip(outward).take(each).for_each(|(freedom, f)| tell(freedom, f));
                }
            }
            What::Weight(acceleration) => {
                for (freedom, inverse) in inverse.iter().enumerate() {
                    let a = acceleration[freedom % each];
                    if a != 0.0 {
                        tell(freedom, a / inverse);
                    }
                }
            }
            What::Freedoms(all) => all.iter().for_each(|&(freedom, force)| tell(freedom, force)),
            What::Point { body, point, force, torque } => {
                let wrench = wrench(now.1, *body, each, point, force, torque);
                for (c, part) in wrench.into_iter().enumerate().take(each) {
                    tell(each * body + c, part);
                }
            }
            #[cfg(feature = "elasticity")]
            What::ByPins(led) => led.forces(now, each, tell),
        }
    }

    /// Whether it depends on pins that move.
    #[cfg(feature = "contact")]
    fn follows_pins(&self) -> bool {
        #[cfg(feature = "elasticity")]
        if let What::ByPins(_) = self {
            return true;
        }
        false
    }

    /// The energy that depends on pins that move.
    fn energy(&self, now: (f64, &[f64]), each: usize) -> f64 {
        #[cfg(feature = "elasticity")]
        if let What::ByPins(led) = self {
            return led.energy(now, each);
        }
        let _ = (now, each);
        0.0
    }

    /// The work of pins that move through an interval, with the forces of one moment; none without pins.
    fn work_of_pins(&self, now: (f64, &[f64]), (from, to): (f64, f64), each: usize) -> Option<f64> {
        #[cfg(feature = "elasticity")]
        if let What::ByPins(led) = self {
            let work = |(pin, push): (&MovingPin, [f64; 3])| {
                let [a, b] = [from, to].map(|t| pin.place(t));
                (0..3).map(|c| push[c] * (b[c] - a[c])).sum::<f64>()
            };
            return Some(led.by_places(now, each).into_iter().map(work).sum());
        }
        let _ = (now, from, to, each);
        None
    }

    /// Their power.
    fn power_of_pins(&self, now: (f64, &[f64]), each: usize) -> Option<f64> {
        #[cfg(feature = "elasticity")]
        if let What::ByPins(led) = self {
            let power = |(pin, push): (&MovingPin, [f64; 3])| {
                push.iter().zip(pin.motion.velocity(now.0)).map(|(f, v)| f * v).sum::<f64>()
            };
            return Some(led.by_places(now, each).into_iter().map(power).sum());
        }
        let _ = (now, each);
        None
    }

    /// The first time after `t` at which pins do not move smoothly.
    fn next_corner(&self, t: f64) -> Option<f64> {
        #[cfg(feature = "elasticity")]
        if let What::ByPins(led) = self {
            return led.next_corner(t);
        }
        let _ = t;
        None
    }
}

impl Force for Acting {
    fn dim(&self) -> usize {
        self.inverse.len()
    }

    fn add_force(&self, t: f64, q: &[f64], v: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        let half = 0.5 * self.width;
        for act in &self.acts {
            if let What::Drag(c) = act.what {
                for freedom in shifts(v.0.len(), self.each, self.dimension) {
                    f.0[freedom] -= c * v.0[freedom];
                }
                continue;
            }
            if let What::Damper(c, rate) = &act.what {
                let rate = rate.now(t, q, self.each);
                let now = rate.at(v.0);
                rate.entries.iter().for_each(|&(freedom, part)| f.0[freedom] -= c * now * part);
                continue;
            }
            if let What::Frame(frame) = act.what {
                let each = self.each;
                for (k, (seen, v)) in frame.seen(q).zip(v.0.chunks_exact(each)).enumerate() {
                    let aside = frame.aside(&seen, v, &self.inverse[each * k..]);
                    let own = f.0[each * k..].iter_mut().zip(aside).take(each);
                    own.for_each(|(f, a)| *f += a);
                }
            }
            let strength = act.strength.mean(t - half, t + half);
            act.what.forces((t, q), &self.inverse, self.each, &mut |freedom, force| {
                f.0[freedom] += strength * force;
            });
        }
    }

    /// That of energies that depend on pins; what else changes with the place does so slowly.
    fn add_stiffness(&self, t: f64, q: &[f64], stiffness: &mut impl Sink) {
        #[cfg(feature = "elasticity")]
        for act in &self.acts {
            if let What::ByPins(led) = &act.what {
                led.add_hessian((t, q), self.each, stiffness);
            }
        }
        let _ = (t, q, stiffness);
    }

    fn add_damping(&self, t: f64, q: &[f64], _: Vector<&[f64]>, damping: &mut impl Sink) {
        for act in &self.acts {
            if let What::Damper(c, rate) = &act.what {
                let entries = rate.now(t, q, self.each).entries;
                let freedoms: Vec<usize> = entries.iter().map(|&(freedom, _)| freedom).collect();
                let rows = entries.iter().map(|&(_, part)| c * part);
                let block: Vec<f64> =
                    rows.flat_map(|row| entries.iter().map(move |&(_, part)| row * part)).collect();
                damping.add_symmetric(&freedoms, &block);
                continue;
            }
            let What::Drag(c) = act.what else { continue };
            for freedom in shifts(self.inverse.len(), self.each, self.dimension) {
                damping.add_symmetric(&[freedom], &[c]);
            }
        }
    }
}
