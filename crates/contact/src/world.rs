//! A world of the plane or of space: bodies, their shapes, and what happens where they touch.
//!
//! ```text
//! v~ = v + h M^-1 (F - dV)                   the velocity increment, F forces beside the potential's
//! v  <- impact where g + h dg v~ < 0         restitution, on the velocity before the increment
//! dg v + max(g, 0)/h >= 0,  friction         staggered projections, contact after contact
//! (t, R, m) <- moved freely with v           translation straight, rotation keeps R m
//! q  <- lifted where g < 0                   positions alone, a fifth of each overlap
//! ```
//! `v` velocities of bodies (m/s in world axes, rad/s in body axes). Gaps are linear over the step:
//! what slides or rests keeps its gap to rounding; corners that turn overlap by order `h^2`.
//! Overlap is corrected by moving positions, never by a velocity: no kinetic energy comes of it,
//! and what is lifted is reported. A gap `g/h` below the tolerance is closed. Approach below the
//! step's own velocity increment is rest: no restitution. A moving obstacle has infinite mass:
//! contacts do not change its velocity, and the work that it does is reported. On an error the
//! state is as it was.
//!
//! Which points are looked at is judged pair by pair, by how far both bodies move in the step; where an impulse makes
//! a body faster than that, and it closes a gap that nobody looked at, the step is solved again from the impulses
//! that were found (see `reach.rs`). What turns far onto points that nobody looked at is named (see `turning.rs`).
//! Impulses start from those of the last step, and each island of bodies that hang together is looked at on its own.
//! Where those impulses still meet the conditions nothing is solved (see `resting.rs`), and where they change no
//! velocity none changes: what stands does not move at all, and a step of a world in which nothing moves costs no
//! more than to see that (see `standing.rs`). Small islands without friction so far are projected exactly; else
//! sweeps and sparse systems by turns settle them, and those of few contacts are then solved to rounding (see
//! `polish.rs`), unless they are of a pile. These take no memory once as many contacts have been met. Contact points
//! of bodies that hardly move against each other are kept (see `contact_cache.rs`).
//!
//! One tolerance says how far contact conditions are settled, m/s. By default it is a small part of what the forces
//! change of velocities in the step, so that it is as fine for what is slow as for what is fast; what moves in a
//! pile, a world of more than a hundred contacts, is settled to a quarter of that, or to 3e-4 of the fastest body of
//! its island. A step whose conditions are not met so far says so ([`WorldReport::settled`]), and is an error only
//! beyond the limit that is asked for. Source: notes 11.4, 11.5.1; Stewart and Trinkle 1996, Anitescu and Potra 1997
//! for contact by velocities.

pub(crate) mod report;
mod memory;
mod reach;
mod impacts;
mod tolerances;
mod islands;
mod accounts;
pub(crate) mod lifting;
mod turning;
pub(crate) mod warm_start;
pub(crate) mod clearance;
pub(crate) mod contact_cache;
pub(crate) mod resting;
mod rolling;
pub(crate) mod painleve;
mod standing;
pub(crate) mod push_apart;
mod end_of_arm;
pub(crate) mod joints;
pub(crate) mod jointed;
#[cfg(feature = "2d")]
pub(crate) mod masonry;

use stationary_calculus::{Force, Metric, Potential, SizeError, Space, System, Vector};
use stationary_constraints::VelocityRows;
use stationary_integrators::{Saved, State, StepError};

use crate::error::{check_finite, check_time};
use crate::solve::body_state::BodyState;
use crate::world::contact_cache::{ContactCache, MOVED, MOVED_IN_PILE};
use crate::world::jointed::Closed;
use crate::world::memory::Memory;
use crate::world::standing::Standing;
use crate::world::tolerances::LARGE;
use crate::world::warm_start::WarmStart;
use crate::{
    ContactError, ContactIn, DetectorIn, Dimension, ImpactLaw, InverseMass, JointRows, WorldReport,
};

/// Bodies under a potential, in the plane or in space.
pub type BodiesIn<G, P> = System<<G as Dimension>::Metric, P, <G as Dimension>::Space>;

/// A contact of the last step, and the impulses that it took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch<G: Dimension> {
    /// What faced each other when the step started.
    pub contact: ContactIn<G>,
    /// The impulse of impacts along the normal, N s; zero where nothing hit.
    pub impact: f64,
    /// The impulse of resting contact along the normal, N s.
    pub normal: f64,
    /// The impulse of friction on the second body, in impacts and in resting contact, N s, world
    /// axes.
    pub friction: G::Vector,
    /// The moment of rolling and of torsional friction on the second body, N m s, world axes.
    pub moment: G::Spin,
}

/// How often a step is solved at most.
const ROUNDS: usize = 6;
/// The name under which impulses and contacts are saved.
const NAME: &str = "world";

/// Bodies, their shapes and what happens where they touch.
#[derive(Debug)]
pub struct World<G: Dimension, P> {
    system: BodiesIn<G, P>,
    detector: DetectorIn<G>,
    mass: InverseMass,
    obstacles: Vec<usize>,
    law: ImpactLaw,
    tolerance: Option<f64>,
    limit: f64,
    last: WarmStart<G>,
    kept: ContactCache<G>,
    standing: Standing,
    memory: Memory<G>,
}

/// A world of the plane.
#[cfg(feature = "2d")]
pub type PlanarWorld<P> = World<crate::Planar, P>;
/// A world of space.
#[cfg(feature = "3d")]
pub type SpatialWorld<P> = World<crate::Spatial, P>;

impl<G: Dimension, P: Potential> World<G, P> {
    /// A system of bodies with these colliders; impacts by generalized reflections.
    ///
    /// # Errors
    /// [`ContactError::Size`] where system and detector have different bodies;
    /// [`ContactError::Mass`] where the metric is not positive definite.
    pub fn new(system: BodiesIn<G, P>, detector: DetectorIn<G>) -> Result<Self, ContactError> {
        let n = system.dim();
        SizeError::check("the detector's bodies", n / G::FREEDOMS, detector.bodies())?;
        let mass = InverseMass::of(system.metric())?;
        let memory = Memory::new(n, G::scales(system.metric()));
        Ok(World {
            system,
            detector,
            mass,
            obstacles: Vec::new(),
            law: ImpactLaw::GeneralizedReflections,
            tolerance: None,
            limit: f64::INFINITY,
            last: WarmStart::default(),
            kept: ContactCache::default(),
            standing: Standing::default(),
            memory,
        })
    }

    /// The same with these bodies as moving obstacles, which nothing slows down.
    ///
    /// # Errors
    /// [`ContactError::Size`] where an obstacle is no body.
    pub fn with_obstacles(mut self, obstacles: Vec<usize>) -> Result<Self, ContactError> {
        let (bodies, f) = (self.detector.bodies(), G::FREEDOMS);
        if let Some(&got) = obstacles.iter().find(|&&body| body >= bodies) {
            return Err(SizeError { what: "an obstacle", expected: bodies, got }.into());
        }
        self.mass = self.mass.holding(obstacles.iter().flat_map(|&body| f * body..f * body + f));
        obstacles.iter().for_each(|&body| self.memory.scales[body] = G::Velocity::default());
        self.obstacles = obstacles;
        self.standing.forget();
        Ok(self)
    }

    /// The same with another impact law.
    pub fn with_law(self, law: ImpactLaw) -> Self {
        World { law, standing: Standing::default(), ..self }
    }

    /// The same with contact conditions met to this tolerance, m/s.
    ///
    /// # Errors
    /// [`ContactError::Settling`] where it is negative or not finite.
    pub fn with_tolerance(self, tolerance: f64) -> Result<Self, ContactError> {
        match tolerance >= 0.0 && tolerance.is_finite() {
            true => {
                let (tolerance, standing) = (Some(tolerance), Standing::default());
                Ok(World { tolerance, standing, ..self })
            }
            false => Err(ContactError::Settling(tolerance)),
        }
    }

    /// The same where a step whose residual exceeds a limit (m/s) is an error.
    ///
    /// # Errors
    /// [`ContactError::Settling`] where it is negative or no number.
    pub fn with_residual_limit(self, limit: f64) -> Result<Self, ContactError> {
        match limit >= 0.0 {
            true => Ok(World { limit, standing: Standing::default(), ..self }),
            false => Err(ContactError::Settling(limit)),
        }
    }

    /// The system.
    pub fn system(&self) -> &BodiesIn<G, P> {
        &self.system
    }

    /// The detector, to look at contacts.
    pub fn detector(&mut self) -> &mut DetectorIn<G> {
        self.standing.forget();
        &mut self.detector
    }

    /// Both, to look at the contacts of bodies in flight.
    pub(crate) fn system_and_detector(&mut self) -> (&BodiesIn<G, P>, &mut DetectorIn<G>) {
        (&self.system, &mut self.detector)
    }

    /// What touched in the last step that was taken, in the order of the identifiers.
    pub fn touches(&self) -> impl Iterator<Item = Touch<G>> {
        let Memory { impulses, hits, .. } = &self.memory;
        let impulses = impulses.iter().zip(hits).zip(self.memory.moments.of_each());
        self.kept.found().iter().zip(impulses).map(|(&contact, ((impulse, hit), moment))| {
            let along = |impulse| G::dot(impulse, &contact.normal);
            let (normal, impact) = (along(impulse), along(hit));
            let friction = *impulse + *hit - contact.normal * (normal + impact);
            Touch { contact, impact, normal, friction, moment }
        })
    }

    /// The impulses of the rows of joints in the last step, in their order: N s of what asks for a speed, N m s
    /// of what asks for a rate of turn. Over the step they are the forces that hold joints.
    pub fn joint_impulses(&self) -> &[f64] {
        &self.memory.joint_impulses
    }

    /// The rows of joints of the last step and their impulses.
    pub(crate) fn joint_rows(&self) -> (&VelocityRows, &[f64]) {
        (&self.memory.joints, &self.memory.joint_impulses)
    }

    /// The arm (m) by which the impulse of a row of joints acts where it is a torque's, and 1 where it is a force's.
    pub(crate) fn joint_arm(&self, row: usize) -> f64 {
        end_of_arm::measure::<G>(&self.memory.joints, row, self.memory.jointed.arm)
    }

    /// The mass of all that impulses move, kg.
    pub(crate) fn mass_that_moves(&self) -> f64 {
        let roots = self.memory.scales.iter().map(|scale| scale.as_ref()[0]);
        roots.filter(|root| *root > 0.0).map(|root| 1.0 / (root * root)).sum()
    }

    /// Whether nothing slows a body down.
    pub(crate) fn is_obstacle(&self, body: usize) -> bool {
        self.obstacles.contains(&body)
    }

    /// The velocities between which the forces of the last step did their work: after its impacts, and at its
    /// end. The work of an impulse is what it does along the mean of the two.
    pub fn velocities(&self) -> [Vector<&[f64]>; 2] {
        [self.memory.before.view(), self.memory.v.view()]
    }

    /// Everything on which the next steps depend beside the state: the impulses of the last, and
    /// from where its contact points are kept.
    pub fn save(&self) -> Saved {
        let mut saved = Saved::default();
        self.save_into(&mut saved);
        saved
    }

    /// The same into room that is kept.
    pub(crate) fn save_into(&self, saved: &mut Saved) {
        NAME.clone_into(&mut saved.method);
        saved.numbers.clear();
        // Behind their count.
        saved.numbers.push(0.0);
        saved.numbers.extend(self.last.save());
        saved.numbers[0] = (saved.numbers.len() - 1) as f64;
        saved.numbers.extend(self.kept.save());
    }

    /// Takes over what the same world had saved, and goes on from its state to the same bits.
    ///
    /// # Errors
    /// Numbers that no world leaves behind; what is remembered is then as it was.
    pub fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        if saved.method != NAME {
            return Err(StepError::Saved("it is another method's"));
        }
        let short = || StepError::Saved("it has fewer numbers than it says");
        let (&count, rest) = saved.numbers.split_first().ok_or_else(short)?;
        let (last, kept) = rest.split_at_checked(count as usize).ok_or_else(short)?;
        let last = WarmStart::load(last)?;
        self.kept = ContactCache::load(kept, &mut self.detector)?;
        self.standing.forget();
        self.last = last;
        Ok(())
    }

    /// Moves a state by `h` seconds.
    ///
    /// # Errors
    /// [`ContactError::Step`] for `h`, and in space for a turn whose equation is not solved; those
    /// of [`DetectorIn::detect`]; [`ContactError::Size`] and [`ContactError::NonFinite`] for the
    /// momentum and for what comes out; [`ContactError::NotConverged`] where a limit is asked for and the residual is
    /// beyond it. The state is then as it was.
    pub fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
    ) -> Result<WorldReport, ContactError> {
        self.step_with(state, h, &())
    }

    /// The same with joints, whose rows are solved together with the contacts that they answer to.
    ///
    /// # Errors
    /// Those of [`World::step`]; [`ContactError::Rows`] for rows that are none; [`ContactError::Size`]
    /// where more than [`crate::COUPLED_ROWS`] rows answer to one another, unless all are equalities.
    pub fn step_with(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        joints: &impl JointRows,
    ) -> Result<WorldReport, ContactError> {
        self.step_under(state, h, joints, &())
    }

    /// The same under forces beside those of the potential, at the time, place and velocity at which the
    /// step starts: they are part of the velocity increment.
    ///
    /// # Errors
    /// Those of [`World::step_with`]; [`ContactError::Size`] for forces of another number of freedoms;
    /// [`ContactError::NonFinite`] where a force leads to what is not finite.
    pub fn step_under(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        joints: &impl JointRows,
        forces: &impl Force,
    ) -> Result<WorldReport, ContactError> {
        if !(h > 0.0 && h.is_finite()) {
            return Err(StepError::Step(h).into());
        }
        let n = self.system.dim();
        SizeError::check("the momentum's components", n, state.p.components().len())?;
        SizeError::check("the poses' numbers", G::STORED * self.detector.bodies(), state.q.len())?;
        check_finite("the momentum", state.p.components())?;
        // The increment of the same state is another only by forces.
        let forced = check_forces(n, forces)?;
        self.find_joints(state, h, joints)?;
        if !forced && let Some(report) = self.stand(state, h, forced)? {
            return Ok(report);
        }
        self.system.metric().sharp(state.p.view(), self.memory.start.view_mut());
        self.find_increment(state, h, forces);
        if forced && let Some(report) = self.stand(state, h, forced)? {
            return Ok(report);
        }
        self.find_reach(h);
        self.memory.meeting.clear();
        let mut round = 1;
        let mut report = loop {
            let mut report = self.solve_round(state, h, round)?;
            let unseen = self.unseen(&state.q, h, report.residual)?;
            let missed = unseen > report.residual;
            let missed = self.find_meeting(&state.q, h) || missed;
            if round == ROUNDS || !missed {
                report.settled &= !missed;
                report.residual = report.residual.max(unseen);
                break report;
            }
            round += 1;
            let contacts = self.kept.found().iter().map(|contact| contact.id);
            let Memory { again, impulses, .. } = &mut self.memory;
            again.keep(h, contacts.zip(impulses.iter().copied()));
        };
        let off = report.residual.max(report.coulomb);
        if off > self.limit {
            return Err(ContactError::NotConverged {
                what: "the contact conditions of a step",
                iterations: report.relaxed,
                residual: off,
                velocity: self.memory.v.0.clone(),
            });
        }
        let closed;
        (report.lifting_energy, closed) = self.advance(state, h, joints)?;
        report.joint_violation = closed.open;
        report.settled &= closed.done && !self.turns_into(h, &report)?;
        let contacts = self.kept.found().iter().map(|contact| contact.id);
        let before = self.last.step();
        self.last.keep(h, contacts.zip(self.memory.impulses.iter().copied()));
        self.see_standing(state, [before, h], forced, &report);
        std::mem::swap(state, &mut self.memory.next);
        Ok(report)
    }

    /// Finds the contacts within reach, and solves them.
    fn solve_round(
        &mut self,
        state: &State<Vec<f64>>,
        h: f64,
        round: usize,
    ) -> Result<WorldReport, ContactError> {
        let Memory { start, v, scales, states, reach, .. } = &mut self.memory;
        v.copy_from(start.view());
        states.clear();
        let scales = scales.iter().enumerate();
        states.extend(scales.map(|(i, &scale)| BodyState::new(i, scale, &state.q, &v.0)));
        let pile = self.tolerance.is_none() && self.last.len() > LARGE;
        self.kept.moved = if pile { MOVED_IN_PILE } else { MOVED };
        self.kept.detect(&mut self.detector, states, &state.q, reach)?;
        let mut contacts = self.kept.take_found();
        // A moving obstacle and what is fixed feel no impulse of each other.
        contacts.retain(|contact| {
            contact.bodies.iter().flatten().any(|&body| self.memory.states[body].moves())
        });
        self.memory.passing.clear();
        // What is left to the last round is not dropped: nothing would tell whether it meets.
        if round < ROUNDS {
            self.drop_passing(&mut contacts, &state.q, h);
        }
        let solved = self.solve(&contacts, &state.q, (h, round));
        self.kept.put_back(contacts);
        solved
    }

    /// Turns the velocity before a step into that over it.
    fn solve(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        (h, round): (f64, usize),
    ) -> Result<WorldReport, ContactError> {
        let mut report =
            WorldReport { contacts: contacts.len(), settled: true, ..WorldReport::default() };
        report.overlap = contacts.iter().map(|c| -c.gap).fold(0.0, f64::max);
        self.memory.hits.clear();
        self.memory.hits.resize(contacts.len(), G::Vector::default());
        let kinetic = self.kinetic_energy();
        if contacts.iter().any(|contact| contact.restitution > 0.0) {
            self.impacts(contacts, q, h, &mut report)?;
            report.impact_energy = kinetic - self.kinetic_energy();
        }
        let Memory { v, before, increment, lift, impulses, again, .. } = &mut self.memory;
        before.copy_from(v.view());
        v.add_scaled(1.0, increment.view());
        lift.0.fill(0.0);
        impulses.clear();
        let last = if round > 1 { &*again } else { &self.last };
        impulses.extend(last.guess(contacts.iter(), h).map(Option::unwrap_or_default));
        if !contacts.is_empty() || self.memory.joints.rows() > 0 {
            let limits = self.rest_rolling(contacts, q, h, &mut report)?;
            self.account(contacts, h, &mut report);
            report.painleve = self.painleve(contacts);
            self.lift(contacts, q, limits, h)?;
        }
        Ok(report)
    }

    /// The velocity increment by the potential and by forces in a step; none of obstacles.
    fn find_increment(&mut self, state: &State<Vec<f64>>, h: f64, forces: &impl Force) {
        let Memory { start, dv, increment, .. } = &mut self.memory;
        dv.0.fill(0.0);
        self.system.potential().add_differential(&state.q, dv.view_mut());
        dv.0.iter_mut().for_each(|dv| *dv = -*dv);
        forces.add_force(state.t, &state.q, start.view(), dv.view_mut());
        for (freedom, force) in dv.0.iter_mut().enumerate() {
            *force *= if self.mass.is_held(freedom) { 0.0 } else { h };
        }
        self.system.metric().sharp(dv.view(), increment.view_mut());
    }

    /// Writes the state a step later: centres straight, rotations free, then lifted, and joints closed;
    /// says what potential energy that gave, J, and how far joints stay open.
    fn advance(
        &mut self,
        state: &State<Vec<f64>>,
        h: f64,
        joints: &impl JointRows,
    ) -> Result<(f64, Closed), ContactError> {
        let Memory { v, lift, next, joints: rows, .. } = &mut self.memory;
        next.clone_from(state);
        self.system.metric().flat(v.view(), next.p.view_mut());
        G::advance(self.system.metric(), &mut next.q, &v.0, &mut next.p.0, h)?;
        next.t = state.t + h;
        let jointed = rows.rows() > 0;
        let mut lifted = 0.0;
        let mut closed = Closed { open: 0.0, done: true };
        if jointed || lift.0.iter().any(|&lift| lift != 0.0) {
            lifted -= self.system.potential().energy(&next.q);
            self.system.space().advance(&mut next.q, h, lift.view());
            if jointed {
                closed = self.close(joints)?;
            }
            lifted += self.system.potential().energy(&self.memory.next.q);
        }
        let next = &self.memory.next;
        check_finite("the configuration", &next.q)?;
        check_finite("the momentum", next.p.components())?;
        check_time(next.t)?;
        Ok((lifted, closed))
    }
}

/// Whether there are forces; an error where they have another number of freedoms than the bodies.
pub(crate) fn check_forces(freedoms: usize, forces: &impl Force) -> Result<bool, SizeError> {
    let there = forces.dim() > 0;
    if there {
        SizeError::check("the forces' freedoms", freedoms, forces.dim())?;
    }
    Ok(there)
}
