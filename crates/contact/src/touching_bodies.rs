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
//! fifth of that is given back each step. A gap that is worth no change of velocity is none: one
//! with `|g|/h` within what counts as settled, a fifth of it where bodies overlap. Approach of the
//! order of a kick is rest and has no restitution. A moving obstacle has infinite mass: contacts do
//! not change its velocity, and the work that it does is reported. On an error the state is as it
//! was.
//!
//! Impulses start from those of the last step, and each island of bodies that hang together is
//! looked at on its own. Where those impulses still meet the conditions nothing is solved (see
//! `resting.rs`), and where they change no velocity none changes: what stands does not move at all.
//! Small islands without friction so far are projected exactly; else sweeps and sparse systems by
//! turns settle them, and take no memory once as many contacts have been met. Contact points of
//! bodies that hardly move against each other are kept (see `kept_contacts.rs`). How far the
//! contact conditions are settled is a choice ([`Settling`]); what is left of them is reported.
//! Source: notes 11.4, 11.5.1; Stewart and Trinkle 1996, Anitescu and Potra 1997 for contact by
//! velocities.

use nalgebra::Vector3;
use stationary_calculus::{Covector, Metric, Potential, SizeError, System, Vector};
use stationary_integrators::{Saved, State, StepError};
use stationary_rigid::{BodyMetric, BodySpace, ConstantVelocity, FreeRotation, Poses, Rotation};

use crate::error::{check_finite, check_time};
use crate::exact_normals::Unpushed;
use crate::impact_rounds::ImpactRounds;
use crate::island_solver::{Conditions, IslandSolver};
use crate::islands::Islands;
use crate::kept_contacts::KeptContacts;
use crate::last_impulses::LastImpulses;
use crate::resting::{Guessed, Resting};
use crate::rigid_contact::{Placed, Six, scale, speed};
use crate::{
    ContactError, ContactPoint, Detector, ImpactLaw, InverseMass, Settling, Spatial, Touch,
    TouchingReport, gap_rows,
};

/// Bodies under a potential.
pub type Bodies<P> = System<BodyMetric<Poses>, P, Poses>;

/// The part of an overlap that a step gives back.
const GIVEN_BACK: f64 = 0.2;
/// Gaps up to this part of a body's size are looked at even where nothing moves.
const REACH: f64 = 1e-6;
/// Changes of velocities relative to the fastest that are rounding.
const ROUNDING: f64 = 1e-12;
/// Gaps relative to the farthest coordinate that are rounding, and so are none: what moves no more
/// rests.
const GAPS: f64 = 2.0 * f64::EPSILON;
/// What nearly rests, and is no faster than a step's kick, is settled to this part of what counts as
/// settled, so that it may rest.
const FINE: f64 = 1.0 / 256.0;
/// The name under which impulses and contacts are saved.
const NAME: &str = "touching-bodies";

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
    kept: KeptContacts,
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
    bias: Vec<f64>,
    /// The impulse of each contact on its second body, world axes, N s.
    pushes: Vec<Vector3<f64>>,
    /// The impulse of impacts along the normal of each contact, N s.
    hits: Vec<f64>,
    islands: Islands,
    resting: Resting,
    solver: IslandSolver,
    next: State<Vec<f64>>,
}

impl<'s, P: Potential> TouchingBodies<'s, P> {
    /// Bodies with these colliders.
    ///
    /// # Errors
    /// [`ContactError::Size`] where system and detector have different bodies.
    pub fn new(system: &'s Bodies<P>, detector: Detector) -> Result<Self, ContactError> {
        let (n, bodies) = (system.dim(), system.metric().bodies().len());
        SizeError::check("the detector's bodies", bodies, detector.bodies())?;
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
            kept: KeptContacts::default(),
            memory,
        })
    }

    /// The same with these bodies as moving obstacles, which nothing slows down.
    ///
    /// # Errors
    /// [`ContactError::Size`] where an obstacle is no body.
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

    /// What touched in the last step that was taken, in the order of the identifiers.
    pub fn touches(&self) -> impl Iterator<Item = Touch<Spatial>> {
        let Memory { pushes, hits, .. } = &self.memory;
        let impulses = pushes.iter().zip(hits);
        self.kept.found().iter().zip(impulses).map(|(&contact, (push, &impact))| {
            let normal = push.dot(&contact.normal);
            Touch { contact, impact, normal, friction: push - contact.normal * normal }
        })
    }

    /// Everything on which the next steps depend beside the state: the impulses of the last, and
    /// from where its contact points are kept.
    pub fn save(&self) -> Saved {
        let last = self.last.save().numbers;
        let mut numbers = vec![last.len() as f64];
        numbers.extend(last);
        numbers.extend(self.kept.save());
        Saved { method: NAME.to_owned(), numbers }
    }

    /// Takes over what the same bodies had saved, and goes on from their state to the same bits.
    ///
    /// # Errors
    /// Numbers that no bodies leave behind; what is remembered is then as it was.
    pub fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        if saved.method != NAME {
            return Err(StepError::Saved("it is another method's"));
        }
        let short = || StepError::Saved("it has fewer numbers than it says");
        let (&count, rest) = saved.numbers.split_first().ok_or_else(short)?;
        let (last, kept) = rest.split_at_checked(count as usize).ok_or_else(short)?;
        let last = LastImpulses::read(last)?;
        self.kept = KeptContacts::load(kept, &mut self.detector)?;
        self.last = last;
        Ok(())
    }

    /// Moves a state by `h` seconds.
    ///
    /// # Errors
    /// [`ContactError::Step`] for `h`, and for a turn whose equation is not solved; those of
    /// [`Detector::detect`]; [`ContactError::Size`] and [`ContactError::NonFinite`] for the
    /// momentum and for what comes out; [`ContactError::Immovable`] for a contact of two that
    /// nothing moves; [`ContactError::NotConverged`] of impacts. The state is then as it was.
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
        SizeError::check("the poses' numbers", 7 * self.memory.scales.len(), state.q.len())?;
        self.system.metric().sharp(state.p.view(), self.memory.v.view_mut());
        self.kick(state, h);
        let reach = self.reach(h);
        let Memory { v, scales, placed, .. } = &mut self.memory;
        let place = |(body, &scale): (usize, &Six)| Placed::new(body, scale, &state.q, &v.0);
        placed.clear();
        placed.extend(scales.iter().enumerate().map(place));
        self.kept.detect(&mut self.detector, placed, &state.q, reach)?;
        let contacts = self.kept.take_found();
        let stepped = self.step_with(&contacts, state, h);
        self.kept.put_back(contacts);
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
        self.memory.hits.clear();
        self.memory.hits.resize(contacts.len(), 0.0);
        if contacts.iter().any(|contact| contact.restitution > 0.0) {
            self.impacts(contacts, &state.q, h, &mut report)?;
        }
        let Memory { v, kick, pushes, .. } = &mut self.memory;
        v.add_scaled(1.0, kick.view());
        pushes.clear();
        let guesses = self.last.guess(contacts.iter(), h);
        pushes.extend(guesses.map(Option::unwrap_or_default));
        if !contacts.is_empty() {
            self.rest(contacts, &state.q, h, &mut report)?;
        }
        self.move_freely(state, h)?;
        let pushes = self.memory.pushes.iter().copied();
        self.last.keep(h, contacts.iter().map(|contact| contact.id).zip(pushes));
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
        let Memory { v, kick, hits, .. } = &mut self.memory;
        let rows = gap_rows(contacts, q);
        let rounds = ImpactRounds { rows: &rows, mass: &self.mass, law: self.law, kick, h };
        let (gap, restitution) = (|i: usize| contacts[i].gap, |i: usize| contacts[i].restitution);
        rounds.apply(gap, restitution, v, |_, closing, done, _| {
            report.impacts += done.passes;
            closing.iter().zip(&done.impulses).for_each(|(&i, impulse)| hits[i] += impulse);
        })
    }

    /// Resting contact and friction.
    fn rest(
        &mut self,
        contacts: &[ContactPoint],
        q: &[f64],
        h: f64,
        report: &mut TouchingReport,
    ) -> Result<(), ContactError> {
        let Memory { v, kick, placed, bias, pushes, islands, resting, solver, .. } =
            &mut self.memory;
        for (placed, v) in placed.iter_mut().zip(v.0.chunks_exact(6)) {
            placed.velocity.copy_from_slice(v);
        }
        find(islands, placed, contacts)?;
        let radius = |body: usize| self.detector.radius(body);
        let pushed = |&body: &usize| speed(&placed[body].velocity, radius(body));
        let fastest = islands.iter().flat_map(|(_, of)| of).map(pushed).fold(0.0, f64::max);
        let farthest = q.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let settled = self.settling.change.max(ROUNDING * fastest).max(GAPS * farthest / h);
        let fine = (FINE * settled).max(ROUNDING * fastest);
        bias.clear();
        // What is not worth a change of velocity is none.
        bias.extend(contacts.iter().map(|contact| {
            let share = if contact.gap < 0.0 { GIVEN_BACK } else { 1.0 };
            let bias = share * contact.gap / h;
            if bias.abs() <= settled { 0.0 } else { bias }
        }));
        resting.start(placed, radius, &kick.0, Guessed { points: contacts, pushes, bias });
        solver.start(placed.len());
        for (members, bodies) in islands.iter() {
            let guessed = Guessed { points: contacts, pushes, bias };
            let off = match resting.off(members, guessed, settled) {
                Some(off) => {
                    let stands = bodies.iter().all(|&body| resting.stands(body, settled));
                    for &body in bodies {
                        let velocity =
                            if stands { resting.before(body) } else { resting.after(body) };
                        v.0[6 * body..][..6].copy_from_slice(velocity);
                    }
                    off
                }
                None => {
                    let (v_f, mass, sweeps) = (&v.0, &self.mass, self.settling.sweeps);
                    let unpushed = Unpushed { points: contacts, q, v: v_f, mass, bias };
                    let kick = |body: usize| speed(&kick.0[6 * body..][..6], radius(body));
                    let slow =
                        |&body: &usize| speed(resting.before(body), radius(body)) <= kick(body);
                    let fine = bodies.iter().all(slow).then_some(fine);
                    let conditions = Conditions { unpushed, placed, settled, fine, sweeps };
                    let off = solver.solve([members, bodies], conditions, pushes, report)?;
                    for &body in bodies {
                        let after = placed[body].after(solver.change(body));
                        v.0[6 * body..][..6].copy_from_slice(&after);
                    }
                    off
                }
            };
            report.islands += 1;
            report.residual = report.residual.max(off[0]);
            report.coulomb = report.coulomb.max(off[1]);
        }
        report.work = self.work(contacts);
        Ok(())
    }

    /// The work that obstacles do by the impulses.
    fn work(&self, contacts: &[ContactPoint]) -> f64 {
        let of = |(contact, on_second): (&ContactPoint, &Vector3<f64>)| -> f64 {
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
            false => contacts.iter().zip(&self.memory.pushes).map(of).sum(),
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
            let radius = self.detector.radius(body);
            h * (speed(v, radius) + speed(kick, radius)) + REACH * radius
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
            let rotation: Rotation = Poses::pose_at(&state.q, i).rotation;
            let (q, p) = (&mut next.q[7 * i..][..7], &mut next.p.0[6 * i..][..6]);
            let momentum = Vector3::new(p[3], p[4], p[5]);
            let turned = ConstantVelocity::turn(body, rotation, momentum, h)?;
            q.iter_mut().zip(&v.0[6 * i..][..3]).for_each(|(q, v)| *q += h * v);
            q[3..].copy_from_slice(&turned.rotation.quaternion());
            p[3..].copy_from_slice(turned.momentum.as_slice());
        }
        check_finite("the configuration", &next.q)?;
        check_finite("the momentum", next.p.components())?;
        check_time(state.t + h)?;
        next.t = state.t + h;
        Ok(())
    }
}

/// The islands of bodies that impulses move; an error where a contact is between none.
fn find(
    islands: &mut Islands,
    placed: &[Placed],
    contacts: &[ContactPoint],
) -> Result<(), ContactError> {
    let moving = |contact: &ContactPoint| {
        let moves = |&body: &usize| placed[body].moves();
        contact.bodies.map(|body| body.filter(moves).unwrap_or(placed.len()))
    };
    if let Some(contact) = contacts.iter().position(|c| moving(c) == [placed.len(); 2]) {
        return Err(ContactError::Immovable { contact });
    }
    islands.find(placed.len(), contacts.iter().map(moving));
    Ok(())
}
