//! Rigid bodies that touch: kick, impacts, resting contact with friction, free motion.
//!
//! ```text
//! v~ = v - h M^-1 dV                         the kick
//! v  <- impact where g + h dg v~ < 0         restitution, on the velocity before the kick
//! dg v + g/h >= 0,  friction                 staggered projections, contact after contact
//! (t, R, m) <- moved freely with v           translation straight, rotation keeps R m
//! ```
//! `v` velocities of bodies (m/s in world axes, rad/s in body axes). Gaps are linear over the step:
//! what slides or rests keeps its gap to rounding; corners that turn overlap by order `h^2`, and a
//! fifth of that is given back each step. Approach of the order of a kick is rest and has no
//! restitution. A moving obstacle has infinite mass: contacts do not change its velocity, and the
//! work that it does is reported. On an error the state is as it was.
//!
//! Impulses start from those of the last step, and each island of bodies that hang together is
//! solved on its own, so that what rests is only looked at. Small islands without friction so far
//! are projected exactly; else sweeps and sparse systems by turns settle them, and take no memory
//! once as many contacts have been met. How far the contact conditions are settled is a choice
//! ([`Settling`]); what is left of them is reported. Source: notes 11.4, 11.5.1; Stewart and
//! Trinkle 1996, Anitescu and Potra 1997 for contact by velocities.

use nalgebra::Vector3;
use stationary_calculus::{Covector, Metric, Potential, SizeError, System, Vector};
use stationary_integrators::{Saved, State, StepError};
use stationary_rigid::{BodyMetric, BodySpace, ConstantVelocity, FreeRotation, Poses, Rotation};

use crate::error::check_finite;
use crate::exact_normals::Unpushed;
use crate::impact_rounds::ImpactRounds;
use crate::islands::Islands;
use crate::last_impulses::LastImpulses;
use crate::rigid_contact::{Placed, RigidContact, Six, scale};
use crate::sweeps::{Island, Sweeps};
use crate::{ContactError, ContactPoint, Detector, ImpactLaw, InverseMass, Spatial, gap_rows};

/// Bodies under a potential.
pub type Bodies<P> = System<BodyMetric<Poses>, P, Poses>;

/// What a step of touching bodies took and left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TouchingReport {
    /// Contact points within reach of the step.
    pub contacts: usize,
    /// Islands of bodies that hang together by them.
    pub islands: usize,
    /// Islands solved by the exact projection without friction.
    pub projected: usize,
    /// Contacts relaxed, over all sweeps; none where everything rests as it did.
    pub relaxed: usize,
    /// Sparse systems solved between sweeps.
    pub solved: usize,
    /// Passes of the impact law.
    pub impacts: usize,
    /// How far the normal conditions are from being met, m/s.
    pub residual: f64,
    /// How far Coulomb's law is from being met, m/s.
    pub coulomb: f64,
    /// The deepest overlap that the step started with, m.
    pub overlap: f64,
    /// The work that obstacles did on the other bodies, J.
    pub work: f64,
}

/// How far the contact conditions of a step are settled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settling {
    /// Sweeps end where no contact changes a velocity by more than this, m/s; rounding ends them
    /// in any case.
    pub change: f64,
    /// The most sweeps over an island in a step.
    pub sweeps: usize,
}

impl Default for Settling {
    fn default() -> Self {
        Settling { change: 0.0, sweeps: 200 }
    }
}

/// The part of an overlap that a step gives back.
const GIVEN_BACK: f64 = 0.2;
/// Gaps up to this part of a body's size are looked at even where nothing moves.
const REACH: f64 = 1e-6;
/// Changes of velocities relative to the fastest that are rounding.
const ROUNDING: f64 = 1e-12;
/// Gaps relative to the farthest coordinate that are rounding: what moves no more rests.
const GAPS: f64 = 2.0 * f64::EPSILON;

/// Steps of bodies that touch.
#[derive(Debug)]
pub struct TouchingBodies<'s, P> {
    system: &'s Bodies<P>,
    detector: Detector,
    mass: InverseMass,
    obstacles: Vec<usize>,
    law: ImpactLaw,
    settling: Settling,
    last: LastImpulses<Spatial>,
    memory: Memory,
}

/// What a step writes before it is known to succeed.
#[derive(Debug, Default)]
struct Memory {
    v: Vector<Vec<f64>>,
    kick: Vector<Vec<f64>>,
    dv: Covector<Vec<f64>>,
    scales: Vec<Six>,
    placed: Vec<Placed>,
    contacts: Vec<RigidContact>,
    bias: Vec<f64>,
    islands: Islands,
    x: Vec<[f64; 3]>,
    sweeps: Sweeps,
    next: State<Vec<f64>>,
}

impl<'s, P: Potential> TouchingBodies<'s, P> {
    /// Bodies with these colliders.
    pub fn new(system: &'s Bodies<P>, detector: Detector) -> Result<Self, ContactError> {
        let n = system.dim();
        let zeros = || Vector(vec![0.0; n]);
        let memory = Memory {
            v: zeros(),
            kick: zeros(),
            dv: Covector(vec![0.0; n]),
            scales: system.metric().bodies().iter().map(scale).collect(),
            ..Memory::default()
        };
        Ok(TouchingBodies {
            system,
            detector,
            mass: InverseMass::of(system.metric())?,
            obstacles: Vec::new(),
            law: ImpactLaw::GeneralizedReflections,
            settling: Settling::default(),
            last: LastImpulses::default(),
            memory,
        })
    }

    /// The same with these bodies as moving obstacles, which nothing slows down.
    pub fn with_obstacles(mut self, obstacles: Vec<usize>) -> Result<Self, ContactError> {
        let bodies = self.system.metric().bodies().len();
        if let Some(&got) = obstacles.iter().find(|&&body| body >= bodies) {
            return Err(SizeError { what: "an obstacle", expected: bodies, got }.into());
        }
        self.mass = self.mass.holding(obstacles.iter().flat_map(|&body| 6 * body..6 * body + 6));
        obstacles.iter().for_each(|&body| self.memory.scales[body] = [0.0; 6]);
        self.obstacles = obstacles;
        Ok(self)
    }

    /// The same with another impact law.
    pub fn with_law(self, law: ImpactLaw) -> Self {
        TouchingBodies { law, ..self }
    }

    /// The same with contact conditions settled so far.
    pub fn with_settling(self, settling: Settling) -> Self {
        TouchingBodies { settling, ..self }
    }

    /// The detector, to look at contacts.
    pub fn detector(&mut self) -> &mut Detector {
        &mut self.detector
    }

    /// Everything on which the next steps depend beside the state: the impulses of the last.
    pub fn save(&self) -> Saved {
        self.last.save()
    }

    /// Takes over what the same bodies had saved, and goes on from their state to the same bits.
    ///
    /// # Errors
    /// Numbers that no bodies leave behind; the impulses are then as they were.
    pub fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        self.last = LastImpulses::load(saved)?;
        Ok(())
    }

    /// Moves a state by `h` seconds.
    pub fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
    ) -> Result<TouchingReport, ContactError> {
        if !(h > 0.0 && h.is_finite()) {
            return Err(StepError::Step(h).into());
        }
        let n = self.system.dim();
        SizeError::check("the momentum's components", n, state.p.components().len())?;
        check_finite("the momentum", state.p.components())?;
        self.system.metric().sharp(state.p.view(), self.memory.v.view_mut());
        self.kick(state, h);
        let reach = self.reach(h);
        self.detector.detect(&state.q, reach)?;
        let contacts = self.detector.take_contacts();
        let stepped = self.step_with(&contacts, state, h);
        self.detector.put_back(contacts);
        let report = stepped?;
        std::mem::swap(state, &mut self.memory.next);
        Ok(report)
    }

    /// Solves the contacts and moves the next state.
    fn step_with(
        &mut self,
        contacts: &[ContactPoint],
        state: &State<Vec<f64>>,
        h: f64,
    ) -> Result<TouchingReport, ContactError> {
        let mut report = TouchingReport { contacts: contacts.len(), ..Default::default() };
        report.overlap = contacts.iter().map(|c| -c.gap).fold(0.0, f64::max);
        if contacts.iter().any(|contact| contact.restitution > 0.0) {
            self.impacts(contacts, &state.q, h, &mut report)?;
        }
        let Memory { v, kick, .. } = &mut self.memory;
        v.add_scaled(1.0, kick.view());
        if !contacts.is_empty() {
            self.rest(contacts, &state.q, h, &mut report)?;
        }
        self.move_freely(state, h)?;
        let whole = |(contact, x): (&ContactPoint, &[f64; 3])| (contact.id, impulse(contact, x));
        self.last.keep(h, contacts.iter().zip(&self.memory.x).map(whole));
        Ok(report)
    }

    /// Impacts of what would close its gap in this step.
    fn impacts(
        &mut self,
        contacts: &[ContactPoint],
        q: &[f64],
        h: f64,
        report: &mut TouchingReport,
    ) -> Result<(), ContactError> {
        let Memory { v, kick, .. } = &mut self.memory;
        let rows = gap_rows(contacts, q);
        let rounds = ImpactRounds { rows: &rows, mass: &self.mass, law: self.law, kick, h };
        let (gap, restitution) = (|i: usize| contacts[i].gap, |i: usize| contacts[i].restitution);
        rounds.apply(gap, restitution, v, |_, _, done, _| report.impacts += done.passes)
    }

    /// Resting contact and friction.
    fn rest(
        &mut self,
        contacts: &[ContactPoint],
        q: &[f64],
        h: f64,
        report: &mut TouchingReport,
    ) -> Result<(), ContactError> {
        let memory = &mut self.memory;
        let bodies = memory.scales.len();
        let v = &memory.v.0;
        let placed = |(body, &scale): (usize, &Six)| Placed::new(body, scale, q, v);
        memory.placed.clear();
        memory.placed.extend(memory.scales.iter().enumerate().map(placed));
        memory.contacts.clear();
        memory.bias.clear();
        let mut fastest = 0.0_f64;
        for (number, contact) in contacts.iter().enumerate() {
            let share = if contact.gap < 0.0 { GIVEN_BACK } else { 1.0 };
            let bias = share * contact.gap / h;
            let packed = RigidContact::new(number, contact, bias, &memory.placed)?;
            let [normal, first, second] = packed.offset;
            let speed = (normal - bias).abs().max(first.abs()).max(second.abs());
            fastest = fastest.max(speed);
            memory.contacts.push(packed);
            memory.bias.push(bias);
        }
        memory.x.clear();
        let guesses = contacts.iter().zip(self.last.guess(contacts.iter(), h));
        memory.x.extend(guesses.map(|(contact, impulse)| along(contact, impulse)));
        let packed = &memory.contacts;
        memory.islands.find(bodies, |i| packed[i].bodies, packed.len());
        memory.sweeps.start(bodies, packed, &memory.x);
        let farthest = q.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let rounding = (ROUNDING * fastest).max(GAPS * farthest / h);
        let settled = self.settling.change.max(rounding);
        let (v, bias) = (&memory.v.0, &memory.bias);
        let unpushed = Unpushed { points: contacts, q, v, mass: &self.mass, bias };
        for (members, of) in memory.islands.iter() {
            let island = Island { contacts: members, bodies: of };
            let (x, sweeps) = (&mut memory.x, &mut memory.sweeps);
            let met = |left: &[f64; 2]| left.iter().all(|left| *left <= settled);
            let smooth = |&i: &usize| packed[i].speed(&[0.0, x[i][1], x[i][2]]) <= settled;
            let smooth = members.iter().all(smooth);
            let mut left = sweeps.residuals(island, packed, x);
            if !met(&left) && smooth && unpushed.project(island, packed, x, sweeps)? {
                report.projected += 1;
                left = sweeps.residuals(island, packed, x);
            }
            if !met(&left) {
                let [taken, solved] =
                    sweeps.settle(island, packed, x, settled, self.settling.sweeps);
                report.relaxed += taken * members.len();
                report.solved += solved;
                left = sweeps.residuals(island, packed, x);
            }
            report.islands += 1;
            report.residual = report.residual.max(left[0]);
            report.coulomb = report.coulomb.max(left[1]);
        }
        for body in memory.islands.iter().flat_map(|(_, of)| of) {
            let after = memory.placed[*body].after(&memory.sweeps.w[*body]);
            memory.v.0[6 * body..][..6].copy_from_slice(&after);
        }
        report.work = self.work(contacts);
        Ok(())
    }

    /// The work that obstacles do by the impulses.
    fn work(&self, contacts: &[ContactPoint]) -> f64 {
        let of = |(contact, x): (&ContactPoint, &[f64; 3])| -> f64 {
            let on_second = impulse(contact, x);
            let side = |k: usize, sign: f64| match contact.bodies[k] {
                Some(body) if self.mass.is_held(6 * body) => {
                    let velocity = self.memory.placed[body].velocity_at(&contact.arms[k]);
                    -sign * on_second.dot(&velocity)
                }
                _ => 0.0,
            };
            side(0, -1.0) + side(1, 1.0)
        };
        match self.obstacles.is_empty() {
            true => 0.0,
            false => contacts.iter().zip(&self.memory.x).map(of).sum(),
        }
    }

    /// The velocity that the potential gives in a step; none to obstacles.
    fn kick(&mut self, state: &State<Vec<f64>>, h: f64) {
        let Memory { dv, kick, .. } = &mut self.memory;
        dv.0.fill(0.0);
        self.system.potential().add_differential(&state.q, dv.view_mut());
        for (freedom, dv) in dv.0.iter_mut().enumerate() {
            *dv *= if self.mass.is_held(freedom) { 0.0 } else { -h };
        }
        self.system.metric().sharp(dv.view(), kick.view_mut());
    }

    /// How far apart two bodies may be and still meet in a step.
    fn reach(&self, h: f64) -> f64 {
        let fastest = |(body, (v, kick)): (usize, (&[f64], &[f64]))| {
            let length = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
            let radius = self.detector.radius(body);
            let speed = |v: &[f64]| length(&v[..3]) + radius * length(&v[3..]);
            h * (speed(v) + speed(kick)) + REACH * radius
        };
        let Memory { v, kick, .. } = &self.memory;
        let bodies = v.0.chunks_exact(6).zip(kick.0.chunks_exact(6)).enumerate();
        2.0 * bodies.map(fastest).fold(0.0, f64::max)
    }

    /// Writes the state a step later: centres straight, rotations free.
    fn move_freely(&mut self, state: &State<Vec<f64>>, h: f64) -> Result<(), ContactError> {
        let Memory { v, next, .. } = &mut self.memory;
        next.clone_from(state);
        self.system.metric().flat(v.view(), next.p.view_mut());
        for (i, body) in self.system.metric().bodies().iter().enumerate() {
            let rotation: Rotation = Poses::pose(&state.q, i).rotation;
            let (q, p) = (&mut next.q[7 * i..][..7], &mut next.p.0[6 * i..][..6]);
            let momentum = Vector3::new(p[3], p[4], p[5]);
            let turned = ConstantVelocity::turn(body, rotation, momentum, h)?;
            q.iter_mut().zip(&v.0[6 * i..][..3]).for_each(|(q, v)| *q += h * v);
            q[3..].copy_from_slice(&turned.rotation.quaternion());
            p[3..].copy_from_slice(turned.momentum.as_slice());
        }
        check_finite("the configuration", &next.q)?;
        check_finite("the momentum", next.p.components())?;
        next.t = state.t + h;
        Ok(())
    }
}

/// The impulse on the second body of a contact, world axes, N s.
fn impulse(contact: &ContactPoint, [n, s, t]: &[f64; 3]) -> Vector3<f64> {
    let [first, second] = contact.tangents();
    contact.normal * *n + first * *s + second * *t
}

/// An impulse along the normal and the tangents of a contact; zeros for none.
fn along(contact: &ContactPoint, impulse: Option<Vector3<f64>>) -> [f64; 3] {
    let Some(impulse) = impulse else { return [0.0; 3] };
    let [first, second] = contact.tangents();
    [contact.normal, first, second].map(|direction| impulse.dot(&direction))
}
