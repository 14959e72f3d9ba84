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
//! Which points are looked at is judged pair by pair, by how far both bodies move in the step; where
//! an impulse makes a body much faster than that, the step is solved again with the points that it
//! then reaches. Impulses start from those of the last step, and each island of bodies that hang
//! together is looked at on its own. Where those impulses still meet the conditions nothing is
//! solved (see `resting.rs`), and where they change no velocity none changes: what stands does not
//! move at all. Small islands without friction so far are projected exactly; else sweeps and sparse
//! systems by turns settle them, and those of few contacts are then solved to rounding (see
//! `polish.rs`). These take no memory once as many contacts have been met. Contact points of bodies that hardly move against each other are kept (see `contact_cache.rs`).
//!
//! One tolerance says how far contact conditions are settled, m/s. By default it is a small part of
//! what the forces change of velocities in the step, so that it is as fine for what is slow as for
//! what is fast. A step whose conditions are not met so far says so ([`WorldReport::settled`]), and
//! is an error only beyond the limit that is asked for. Source: notes 11.4, 11.5.1; Stewart and
//! Trinkle 1996, Anitescu and Potra 1997 for contact by velocities.

pub(crate) mod report;
pub(crate) mod warm_start;
pub(crate) mod clearance;
pub(crate) mod contact_cache;
pub(crate) mod resting;
pub(crate) mod painleve;
pub(crate) mod push_apart;
pub(crate) mod joints;
pub(crate) mod jointed;
#[cfg(feature = "2d")]
pub(crate) mod masonry;

use stationary_calculus::{Covector, Force, Metric, Potential, SizeError, Space, System, Vector};
use stationary_constraints::VelocityRows;
use stationary_integrators::{Saved, State, StepError};

use crate::error::{check_finite, check_time};
use crate::impact::rounds::ImpactRounds;
use crate::solve::body_state::{BodyState, speed};
use crate::solve::exact_projection::FreeMotion;
use crate::solve::island_solver::{Conditions, SolvesIslands};
use crate::solve::islands::Islands;
use crate::solve::rolling::{ContactMoments, TURNS};
use crate::solve::sweeps::AMPLIFICATION;
use crate::world::clearance::{StepMotion, has_contacts};
use crate::world::contact_cache::ContactCache;
use crate::world::jointed::links;
use crate::world::painleve::{Painleve, painleve};
use crate::world::resting::{Guessed, Resting};
use crate::world::warm_start::WarmStart;
use crate::{
    ContactError, ContactIn, ContactRows, DetectorIn, Dimension, ImpactLaw, InverseMass, JointRows,
    WorldReport, gap_rows,
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
}

/// The part of an overlap by which a step lifts: all of it at once would overshoot where gaps are
/// not linear.
const PENETRATION_CORRECTION: f64 = 0.2;
/// Gaps up to this part of a body's radius are looked at even where nothing moves.
const SPECULATIVE_MARGIN: f64 = 1e-6;
/// Changes of velocities relative to the fastest that are rounding.
const ROUNDING: f64 = 1e-12;
/// Gaps relative to the farthest contact point's distance from the origin that are rounding, and so are none: what moves no more
/// rests.
const GAP_ROUNDING: f64 = 2.0 * f64::EPSILON;
/// What nearly rests, and is no faster than a step's velocity increment, is settled to this part of
/// what counts as settled, so that it may rest.
const REST_TOLERANCE: f64 = 1.0 / 256.0;
/// Tolerances where none is asked for, as parts of the largest velocity increment, so of the weight
/// of what rests: of small islands, and of large ones. A small island that takes too much work is
/// left at the second, and the step is then not settled.
const FINE_TOLERANCE: f64 = 1e-8;
const TOLERANCE: f64 = 1e-2;
/// Islands of more contacts are large.
const LARGE: usize = 100;
/// A body that an impulse takes this part of its radius farther than was looked at may have missed
/// a contact: the step is solved again.
const MISSED: f64 = 0.05;
/// Pairs that move less than this part of the smaller radius against each other have gaps that are
/// nearly linear over the step.
const FAR: f64 = 0.1;
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
    memory: Memory<G>,
}

/// A world of the plane.
#[cfg(feature = "2d")]
pub type PlanarWorld<P> = World<crate::Planar, P>;
/// A world of space.
#[cfg(feature = "3d")]
pub type SpatialWorld<P> = World<crate::Spatial, P>;

/// What a step writes before it is known to succeed.
#[derive(Debug)]
struct Memory<G: Dimension> {
    /// At the step's start, and between impacts and the velocity increment.
    start: Vector<Vec<f64>>,
    before: Vector<Vec<f64>>,
    v: Vector<Vec<f64>>,
    increment: Vector<Vec<f64>>,
    lift: Vector<Vec<f64>>,
    /// Rows of joints over the step, the movable bodies that they name, and what is left of the gaps of
    /// the contacts that are solved with them.
    joints: VelocityRows,
    linked: Vec<[usize; 2]>,
    left: VelocityRows,
    dv: Covector<Vec<f64>>,
    /// How far each body moves in the step, m.
    reach: Vec<f64>,
    /// Contacts of colliders that pass each other with clearance, and colliders that do not although
    /// they seemed to.
    passing: Vec<ContactIn<G>>,
    meeting: Vec<[usize; 2]>,
    parts: [Vec<u32>; 2],
    scales: Vec<G::Velocity>,
    states: Vec<BodyState<G>>,
    /// Velocities of bodies in world axes: after the step, and the mean with those before.
    after: Vec<(G::Vector, G::Spin)>,
    mean: Vec<(G::Vector, G::Spin)>,
    bias: Vec<f64>,
    lift_bias: Vec<f64>,
    lift_least: Vec<f64>,
    /// The impulse of each contact on its second body, world axes, N s.
    impulses: Vec<G::Vector>,
    /// The impulse of impacts on the second body of each contact, world axes, N s.
    hits: Vec<G::Vector>,
    islands: Islands,
    resting: Resting<G>,
    moments: ContactMoments<G>,
    /// Velocities before any impulse, and their increment, without moments.
    free: Vector<Vec<f64>>,
    weight: Vector<Vec<f64>>,
    solver: G::Solver,
    next: State<Vec<f64>>,
}

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
        let zeros = || Vector(vec![0.0; n]);
        let memory = Memory {
            start: zeros(),
            before: zeros(),
            v: zeros(),
            increment: zeros(),
            lift: zeros(),
            joints: VelocityRows::default(),
            linked: Vec::new(),
            left: VelocityRows::default(),
            dv: Covector(vec![0.0; n]),
            reach: Vec::new(),
            passing: Vec::new(),
            meeting: Vec::new(),
            parts: Default::default(),
            scales: G::scales(system.metric()),
            states: Vec::new(),
            after: Vec::new(),
            mean: Vec::new(),
            bias: Vec::new(),
            lift_bias: Vec::new(),
            lift_least: Vec::new(),
            impulses: Vec::new(),
            hits: Vec::new(),
            islands: Islands::default(),
            resting: Resting::default(),
            moments: ContactMoments::default(),
            free: zeros(),
            weight: zeros(),
            solver: G::Solver::default(),
            next: State::default(),
        };
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
        Ok(self)
    }

    /// The same with another impact law.
    pub fn with_law(self, law: ImpactLaw) -> Self {
        World { law, ..self }
    }

    /// The same with contact conditions met to this tolerance, m/s.
    ///
    /// # Errors
    /// [`ContactError::Settling`] where it is negative or not finite.
    pub fn with_tolerance(self, tolerance: f64) -> Result<Self, ContactError> {
        match tolerance >= 0.0 && tolerance.is_finite() {
            true => Ok(World { tolerance: Some(tolerance), ..self }),
            false => Err(ContactError::Settling(tolerance)),
        }
    }

    /// The same where a step whose residual exceeds a limit (m/s) is an error.
    ///
    /// # Errors
    /// [`ContactError::Settling`] where it is negative or no number.
    pub fn with_residual_limit(self, limit: f64) -> Result<Self, ContactError> {
        match limit >= 0.0 {
            true => Ok(World { limit, ..self }),
            false => Err(ContactError::Settling(limit)),
        }
    }

    /// The system.
    pub fn system(&self) -> &BodiesIn<G, P> {
        &self.system
    }

    /// The detector, to look at contacts.
    pub fn detector(&mut self) -> &mut DetectorIn<G> {
        &mut self.detector
    }

    /// What touched in the last step that was taken, in the order of the identifiers.
    pub fn touches(&self) -> impl Iterator<Item = Touch<G>> {
        let Memory { impulses, hits, .. } = &self.memory;
        let impulses = impulses.iter().zip(hits);
        self.kept.found().iter().zip(impulses).map(|(&contact, (impulse, hit))| {
            let along = |impulse| G::dot(impulse, &contact.normal);
            let (normal, impact) = (along(impulse), along(hit));
            let friction = *impulse + *hit - contact.normal * (normal + impact);
            Touch { contact, impact, normal, friction }
        })
    }

    /// The velocities between which the forces of the last step did their work: after its impacts, and at its
    /// end. The work of an impulse is what it does along the mean of the two.
    pub fn velocities(&self) -> [Vector<&[f64]>; 2] {
        [self.memory.before.view(), self.memory.v.view()]
    }

    /// Everything on which the next steps depend beside the state: the impulses of the last, and
    /// from where its contact points are kept.
    pub fn save(&self) -> Saved {
        let last = self.last.save();
        let mut numbers = vec![last.len() as f64];
        numbers.extend(last);
        numbers.extend(self.kept.save());
        Saved { method: NAME.to_owned(), numbers }
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
    /// where more than [`crate::COUPLED_ROWS`] rows answer to one another.
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
    /// Those of [`World::step_with`]; [`ContactError::NonFinite`] where a force leads to what is not finite.
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
        self.system.metric().sharp(state.p.view(), self.memory.start.view_mut());
        self.find_increment(state, h, forces);
        self.find_joints(state, h, joints)?;
        self.find_reach(h);
        self.memory.meeting.clear();
        let mut round = 1;
        let mut report = loop {
            let mut report = self.solve_round(state, h, round)?;
            let missed = self.widen_reach(h) | self.find_meeting(&state.q, h);
            if round == ROUNDS || !missed {
                report.settled &= !missed;
                break report;
            }
            round += 1;
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
        report.lifting_energy = self.advance(state, h, joints)?;
        let contacts = self.kept.found().iter().map(|contact| contact.id);
        self.last.keep(h, contacts.zip(self.memory.impulses.iter().copied()));
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
        let solved = self.solve(&contacts, &state.q, h);
        self.kept.put_back(contacts);
        solved
    }

    /// Drops the contacts of pairs that move far in the step and pass each other with clearance.
    fn drop_passing(&mut self, contacts: &mut Vec<ContactIn<G>>, q: &[f64], h: f64) {
        let Memory { start, increment, passing, meeting, parts, reach, .. } = &mut self.memory;
        let velocity = |freedom: usize| start.0[freedom] + increment.0[freedom];
        let detector = &self.detector;
        let motion = StepMotion { detector, contacts, q, velocity: &velocity, h };
        for of_pair in contacts.chunk_by(ContactIn::same_pair) {
            let pair = of_pair[0].id.pair();
            let bodies = || of_pair[0].bodies.into_iter().flatten();
            let far = bodies().map(|body| FAR * self.detector.radius_of(body));
            let far = far.fold(f64::INFINITY, f64::min);
            let clear = bodies().map(|body| reach[body]).sum::<f64>() > far
                && motion.closing(pair) > far
                && !meeting.contains(&pair)
                && of_pair.iter().all(|contact| contact.gap > 0.0)
                && !motion.meets(of_pair, parts);
            if clear {
                passing.extend_from_slice(of_pair);
            }
        }
        if !passing.is_empty() {
            contacts.retain(|contact| !has_contacts(passing, contact.id.pair()));
        }
    }

    /// Finds pairs that seemed to pass each other and meet with the velocities of now; says whether
    /// there are any.
    fn find_meeting(&mut self, q: &[f64], h: f64) -> bool {
        let Memory { v, passing, meeting, parts, .. } = &mut self.memory;
        let velocity = |freedom: usize| v.0[freedom];
        let (detector, contacts) = (&self.detector, self.kept.found());
        let motion = StepMotion { detector, contacts, q, velocity: &velocity, h };
        let before = meeting.len();
        for of_pair in passing.chunk_by(ContactIn::same_pair) {
            if motion.meets(of_pair, parts) {
                meeting.push(of_pair[0].id.pair());
            }
        }
        meeting.len() > before
    }

    /// Turns the velocity before a step into that over it.
    fn solve(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        h: f64,
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
        let Memory { v, before, increment, lift, impulses, .. } = &mut self.memory;
        before.copy_from(v.view());
        v.add_scaled(1.0, increment.view());
        lift.0.fill(0.0);
        impulses.clear();
        impulses.extend(self.last.guess(contacts.iter(), h).map(Option::unwrap_or_default));
        if !contacts.is_empty() || self.memory.joints.rows() > 0 {
            let [_, settled] = self.rest_rolling(contacts, q, h, &mut report)?;
            self.account(contacts, h, &mut report);
            report.painleve = self.painleve(contacts);
            self.lift(contacts, q, settled, h)?;
        }
        Ok(report)
    }

    /// Impacts of what would close its gap in this step.
    fn impacts(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        h: f64,
        report: &mut WorldReport,
    ) -> Result<(), ContactError> {
        let Memory { v, increment, hits, joints, .. } = &mut self.memory;
        let (rows, mut across) = (gap_rows(contacts, q), ContactRows::new());
        let of = |read: fn(&ContactIn<G>) -> f64| contacts.iter().map(read).collect::<Vec<_>>();
        let friction = of(|contact| contact.friction);
        if friction.iter().any(|&friction| friction > 0.0) {
            contacts.iter().for_each(|contact| contact.push_tangents(q, &mut across));
        }
        let rounds = ImpactRounds {
            rows: &rows,
            across: &across,
            gap: &of(|contact| contact.gap),
            restitution: &of(|contact| contact.restitution),
            friction: &friction,
            mass: &self.mass,
            joints,
            law: self.law,
            kick: increment,
            h,
        };
        let given = rounds.apply(v)?;
        report.impacts = given.passes;
        report.settled &= given.converged;
        let mut across = given.friction.iter();
        for ((contact, hit), normal) in contacts.iter().zip(hits).zip(given.normal) {
            *hit = contact.normal * normal;
            for (tangent, &impulse) in contact.tangents().zip(&mut across) {
                *hit = *hit + tangent * impulse;
            }
        }
        Ok(())
    }

    /// Resting contact and friction by turns with moments, where any pair has them.
    fn rest_rolling(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        h: f64,
        report: &mut WorldReport,
    ) -> Result<[f64; 2], ContactError> {
        if !self.memory.moments.start(contacts, &self.detector) {
            return self.rest(contacts, q, h, report);
        }
        let Memory { v, increment, free, weight, .. } = &mut self.memory;
        free.copy_from(v.view());
        weight.copy_from(increment.view());
        let start = *report;
        let mut turn = 0;
        loop {
            let Memory { v, increment, free, weight, moments, states, .. } = &mut self.memory;
            v.copy_from(free.view());
            increment.copy_from(weight.view());
            moments.add(contacts, states, &mut v.0);
            moments.add(contacts, states, &mut increment.0);
            let (relaxed, solved) = (report.relaxed, report.solved);
            *report = WorldReport { relaxed, solved, ..start };
            let [finest, enough] = self.rest(contacts, q, h, report)?;
            let Memory { v, before, increment, weight, moments, states, impulses, .. } =
                &mut self.memory;
            let settled = if contacts.len() > LARGE { enough } else { finest };
            let off = moments.find_next(turn, contacts, impulses, states, &v.0);
            let taken = moments.energy(contacts, states, [&before.0, &v.0]);
            let fits = off <= AMPLIFICATION * settled;
            // Where the last turn would give energy, one without moments follows, which does not.
            if turn > TURNS || (!taken.gains && (fits || turn == TURNS)) {
                increment.copy_from(weight.view());
                report.settled &= fits;
                report.coulomb = report.coulomb.max(off);
                report.friction_energy += taken.friction;
                report.work += taken.work;
                return Ok([finest, enough]);
            }
            turn += 1;
            if turn <= TURNS { moments.take_next() } else { moments.drop_all() }
        }
    }

    /// Resting contact and friction; says what counts as settled, m/s.
    fn rest(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        h: f64,
        report: &mut WorldReport,
    ) -> Result<[f64; 2], ContactError> {
        let [finest, enough, still] = self.settled(contacts, h);
        let f = G::FREEDOMS;
        let Memory {
            v, increment, states, bias, impulses, islands, resting, solver, linked, ..
        } = &mut self.memory;
        for (state, v) in states.iter_mut().zip(v.0.chunks_exact(f)) {
            state.velocity.as_mut().copy_from_slice(v);
        }
        islands.find(
            states.len(),
            contacts
                .iter()
                .map(|contact| {
                    let moves = |&body: &usize| states[body].moves();
                    contact.bodies.map(|body| body.filter(moves).unwrap_or(states.len()))
                })
                .chain(linked.iter().copied()),
        );
        let radius = |body: usize| self.detector.radius_of(body);
        bias.clear();
        // What is not worth a change of velocity is closed; what overlaps is lifted afterwards.
        bias.extend(contacts.iter().map(|contact| {
            let bias = contact.gap.max(0.0) / h;
            if bias <= finest { 0.0 } else { bias }
        }));
        let guessed = Guessed { points: contacts, impulses, bias };
        resting.start(states, radius, &increment.0, guessed);
        solver.start(states.len());
        let mut jointed: Vec<usize> = Vec::new();
        for (members, bodies) in islands.iter() {
            if has_joints(members, contacts.len()) {
                jointed.extend(members.iter().filter(|&&i| i < contacts.len()));
                continue;
            }
            let guessed = Guessed { points: contacts, impulses, bias };
            let settled = if members.len() > LARGE { enough } else { finest };
            let mut reached = AMPLIFICATION * settled;
            let off = match resting.off(members, guessed, settled) {
                Some(off) => {
                    let stands =
                        bodies.iter().all(|&body| resting.stands(body, settled.min(still)));
                    for &body in bodies {
                        let velocity =
                            if stands { resting.before(body) } else { resting.after(body) };
                        v.0[f * body..][..f].copy_from_slice(velocity.as_ref());
                    }
                    off
                }
                None => {
                    let free = FreeMotion { points: contacts, q, v: &v.0, mass: &self.mass, bias };
                    let gains =
                        |body: usize| speed::<G>(&increment.0[f * body..][..f], radius(body));
                    let slow = |&body: &usize| {
                        speed::<G>(resting.before(body).as_ref(), radius(body)) <= gains(body)
                    };
                    let fine = bodies.iter().all(slow).then_some((REST_TOLERANCE * settled).max(
                        ROUNDING * bodies.iter().map(|&body| gains(body)).fold(0.0, f64::max),
                    ));
                    let large = self.tolerance.is_none() && members.len() > LARGE;
                    let fine = fine.filter(|_| !large);
                    let conditions = Conditions { free, states, settled, enough, fine };
                    let off = solver.solve([members, bodies], conditions, impulses, report)?;
                    if self.tolerance.is_none() {
                        // What impulses cancel in velocities leaves their rounding.
                        reached = reached.max(solver.rounding().min(AMPLIFICATION * enough));
                    }
                    for &body in bodies {
                        let (state, change) = (&states[body], solver.change(body));
                        for (k, v) in v.0[f * body..][..f].iter_mut().enumerate() {
                            *v = state.velocity.as_ref()[k]
                                + state.scale.as_ref()[k] * change.as_ref()[k];
                        }
                    }
                    off
                }
            };
            report.islands += 1;
            report.settled &= off[0].max(off[1]) <= reached;
            report.residual = report.residual.max(off[0]);
            report.coulomb = report.coulomb.max(off[1]);
        }
        if self.memory.joints.rows() > 0 {
            self.rest_jointed(contacts, q, &jointed, finest, report)?;
        }
        Ok([finest, enough])
    }

    /// The change of velocity that counts as settled in small islands and in large ones, m/s: such
    /// changes leave a residual within the tolerance. And that by which what stands may be off from
    /// rest: a part of the velocity increment, however loose the tolerance, or weight would be lost.
    fn settled(&self, contacts: &[ContactIn<G>], h: f64) -> [f64; 3] {
        let Memory { v, increment, .. } = &self.memory;
        let fastest = |v: &[f64]| {
            let bodies = v.chunks_exact(G::FREEDOMS).enumerate();
            bodies.map(|(i, v)| speed::<G>(v, self.detector.radius_of(i))).fold(0.0, f64::max)
        };
        let points = contacts.iter().flat_map(|contact| contact.points);
        let farthest = points.fold(0.0_f64, |m, point| m.max(G::dot(&point, &point))).sqrt();
        let rounding = (ROUNDING * fastest(&v.0)).max(GAP_ROUNDING * farthest / h);
        let gain = fastest(&increment.0);
        let within = |asked: f64| rounding.max(asked / AMPLIFICATION);
        let or_asked = |part: f64| within(self.tolerance.unwrap_or(part * gain));
        [or_asked(FINE_TOLERANCE), or_asked(TOLERANCE), within(TOLERANCE * gain)]
    }

    /// Energies, and what is left of each gap at the end of the step.
    fn account(&mut self, contacts: &[ContactIn<G>], h: f64, report: &mut WorldReport) {
        let Memory { v, before, states, after, mean, impulses, hits, lift_bias, .. } =
            &mut self.memory;
        let of = |v: &[f64], body: usize| {
            let mut velocity = G::Velocity::default();
            velocity.as_mut().copy_from_slice(&v[G::FREEDOMS * body..][..G::FREEDOMS]);
            G::split(&states[body].frame, &velocity)
        };
        after.clear();
        after.extend((0..states.len()).map(|body| of(&v.0, body)));
        mean.clear();
        mean.extend(after.iter().enumerate().map(|(body, &(x, w))| {
            let (x0, w0) = of(&before.0, body);
            ((x + x0) * 0.5, (w + w0) * 0.5)
        }));
        let at = |of: &[(G::Vector, G::Spin)], contact: &ContactIn<G>, side: usize| {
            contact.bodies[side].map_or_else(G::Vector::default, |body| {
                let (x, w) = of[body];
                x + G::swing(&w, &(contact.points[side] - states[body].centre))
            })
        };
        lift_bias.clear();
        for ((contact, impulse), hit) in contacts.iter().zip(impulses.iter()).zip(hits.iter()) {
            let rate = at(after, contact, 1) - at(after, contact, 0);
            let part = if contact.gap < 0.0 { PENETRATION_CORRECTION } else { 1.0 };
            lift_bias.push(G::dot(&rate, &contact.normal) + part * contact.gap / h);
            let whole = *impulse + *hit;
            if whole == G::Vector::default() {
                continue;
            }
            let pushed = G::dot(impulse, &contact.normal);
            let rate = at(mean, contact, 1) - at(mean, contact, 0);
            report.impact_energy -= pushed * G::dot(&rate, &contact.normal);
            report.friction_energy -= G::dot(&(*impulse - contact.normal * pushed), &rate);
            for (side, sign) in [(0, 1.0), (1, -1.0)] {
                if contact.bodies[side].is_some_and(|body| !states[body].moves()) {
                    let velocity = at(after, contact, side) * sign;
                    report.work += G::dot(&whole, &velocity);
                    report.impact_energy += G::dot(hit, &velocity);
                }
            }
        }
    }

    /// The contact that slides in Painleve's paradox, if one does.
    fn painleve(&self, contacts: &[ContactIn<G>]) -> Option<Painleve> {
        let Memory { states, impulses, hits, start, .. } = &self.memory;
        let along = |i: usize| G::dot(&(impulses[i] + hits[i]), &contacts[i].normal);
        let radius = |body: usize| self.detector.radius_of(body);
        painleve(contacts, |i| along(i) > 0.0, states, radius, &start.0)
    }

    /// Velocities of positions that lift what overlaps.
    fn lift(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        settled: f64,
        h: f64,
    ) -> Result<(), ContactError> {
        let Memory { states, lift_bias, lift_least, islands, solver, lift, .. } = &mut self.memory;
        let f = G::FREEDOMS;
        // No gap ends below what it was, nor below zero.
        lift_least.clear();
        lift_least.extend(contacts.iter().map(|c| PENETRATION_CORRECTION * c.gap.min(0.0) / h));
        let mut jointed: Vec<usize> = Vec::new();
        for (members, bodies) in islands.iter() {
            if has_joints(members, contacts.len()) {
                jointed.extend(members.iter().filter(|&&i| i < contacts.len()));
                continue;
            }
            let worst = members.iter().map(|&i| -lift_bias[i]).fold(0.0, f64::max);
            let overlaps = |&i: &usize| contacts[i].gap < 0.0 && lift_bias[i] < -settled;
            if !members.iter().any(overlaps) {
                continue;
            }
            let goal = settled.max(LIFT_TOLERANCE * worst);
            solver.lift([members, bodies], contacts, lift_bias, lift_least, states, goal)?;
            for &body in bodies {
                let (scale, change) = (states[body].scale.as_ref(), solver.change(body).as_ref());
                let own = &mut lift.0[f * body..][..f];
                own.iter_mut().zip(scale.iter().zip(change)).for_each(|(own, (a, b))| *own = a * b);
            }
            let part = lifted_part(&self.detector, bodies.iter().copied(), &lift.0, h);
            for &body in bodies {
                lift.0[f * body..][..f].iter_mut().for_each(|lift| *lift *= part);
            }
        }
        if self.memory.joints.rows() > 0 {
            self.lift_jointed(contacts, q, &jointed, settled, h)?;
        }
        Ok(())
    }

    /// The kinetic energy of what impulses move, J.
    fn kinetic_energy(&self) -> f64 {
        let Memory { v, scales, .. } = &self.memory;
        let scales = scales.iter().flat_map(|scale| scale.as_ref());
        let moving = v.0.iter().zip(scales).filter(|(_, scale)| **scale > 0.0);
        moving.map(|(v, scale)| 0.5 * (v / scale) * (v / scale)).sum()
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

    /// The rows of joints over a step.
    fn find_joints(
        &mut self,
        state: &State<Vec<f64>>,
        h: f64,
        from: &impl JointRows,
    ) -> Result<(), ContactError> {
        let Memory { joints, linked, left, scales, .. } = &mut self.memory;
        joints.clear();
        left.clear();
        from.velocity_rows(state.t, &state.q, h, joints)?;
        joints.check(self.mass.dim())?;
        let moves = |body: usize| scales[body].as_ref()[0] > 0.0;
        *linked = links(joints, G::FREEDOMS, scales.len(), moves);
        Ok(())
    }

    /// How far each body moves in a step.
    fn find_reach(&mut self, h: f64) {
        let Memory { start, increment, reach, .. } = &mut self.memory;
        let f = G::FREEDOMS;
        let bodies = start.0.chunks_exact(f).zip(increment.0.chunks_exact(f)).enumerate();
        reach.clear();
        reach.extend(bodies.map(|(body, (v, increment))| {
            let radius = self.detector.radius_of(body);
            let speeds = speed::<G>(v, radius) + speed::<G>(increment, radius);
            h * speeds + SPECULATIVE_MARGIN * radius
        }));
    }

    /// Widens the reach of what has become much faster; says whether there is any.
    fn widen_reach(&mut self, h: f64) -> bool {
        let Memory { v, reach, .. } = &mut self.memory;
        let mut widened = false;
        for (body, (v, reach)) in v.0.chunks_exact(G::FREEDOMS).zip(reach).enumerate() {
            let radius = self.detector.radius_of(body);
            let way = h * speed::<G>(v, radius);
            if way > *reach + MISSED * radius {
                *reach = 1.5 * way;
                widened = true;
            }
        }
        widened
    }

    /// Writes the state a step later: centres straight, rotations free, then lifted, and joints closed;
    /// says what potential energy that gave.
    fn advance(
        &mut self,
        state: &State<Vec<f64>>,
        h: f64,
        joints: &impl JointRows,
    ) -> Result<f64, ContactError> {
        let Memory { v, lift, next, joints: rows, .. } = &mut self.memory;
        next.clone_from(state);
        self.system.metric().flat(v.view(), next.p.view_mut());
        G::advance(self.system.metric(), &mut next.q, &v.0, &mut next.p.0, h)?;
        next.t = state.t + h;
        let jointed = rows.rows() > 0;
        let mut lifted = 0.0;
        if jointed || lift.0.iter().any(|&lift| lift != 0.0) {
            lifted -= self.system.potential().energy(&next.q);
            self.system.space().advance(&mut next.q, h, lift.view());
            if jointed {
                self.close(joints)?;
            }
            lifted += self.system.potential().energy(&self.memory.next.q);
        }
        let next = &self.memory.next;
        check_finite("the configuration", &next.q)?;
        check_finite("the momentum", next.p.components())?;
        check_time(next.t)?;
        Ok(lifted)
    }
}

/// The part of the worst approach to which lifting is settled.
const LIFT_TOLERANCE: f64 = 1e-2;

/// Whether links of joints are among the members of an island, which come in ascending order.
fn has_joints(members: &[usize], contacts: usize) -> bool {
    members.last().is_some_and(|&last| last >= contacts)
}

/// The part of a lift that takes none of these bodies far: what is squeezed would go where gaps are not
/// linear and nobody has looked.
pub(crate) fn lifted_part<G: Dimension>(
    detector: &DetectorIn<G>,
    bodies: impl Iterator<Item = usize>,
    lift: &[f64],
    h: f64,
) -> f64 {
    let part = |body: usize| {
        let radius = detector.radius_of(body);
        let way = h * speed::<G>(&lift[G::FREEDOMS * body..][..G::FREEDOMS], radius);
        if way > MISSED * radius { MISSED * radius / way } else { 1.0 }
    };
    bodies.map(part).fold(1.0, f64::min)
}
