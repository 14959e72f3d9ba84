//! A world: bodies of the plane or of space under a potential, their shapes, and what happens where
//! they touch.
//!
//! ```text
//! v~ = v - h M^-1 dV                         the kick
//! v  <- impact where g + h dg v~ < 0         restitution, on the velocity before the kick
//! dg v + g/h >= 0,  friction                 the staggered projections
//! q  <- moved freely with v                  centres straight, turns keep their spin
//! ```
//! `g` gaps (m) with differentials `dg`, `v` velocities, `M` the metric, `V` the potential, `h` the
//! step. Everything goes by rows and one over the mass, so that the plane and space are the same
//! here, and each step's conditions are solved exactly: made for scenes of up to some hundred
//! contacts. A step returns what it took, and keeps every [`Touch`] with its impulses.
//!
//! Gaps are linear over the step: what slides or rests keeps its gap to rounding; corners that turn
//! overlap by order `h^2`, and a fifth of that is given back each step. Who can meet is judged by
//! the speeds before impacts: what a hit makes faster than twice those may overlap for a step.
//! Approach of the order of a kick is rest and has no restitution. What an impact brings to
//! approach takes part in it: impacts are solved again with those contacts too, until none is left.
//! A moving obstacle has infinite mass: contacts do not change its velocity, and the work that it
//! does is reported. On an error the state is as it was. Source: notes 11.4, 11.5.1; Stewart and
//! Trinkle 1996, Anitescu and Potra 1997 for contact by velocities.

use stationary_calculus::{Covector, Metric, Potential, SizeError, System, Vector};
use stationary_integrators::{Saved, State, StepError};

use crate::error::{check_finite, check_time};
use crate::impact_rounds::ImpactRounds;
use crate::last_impulses::LastImpulses;
use crate::projection::{all, project_with};
use crate::row_friction::{RowFriction, SETTLED};
use crate::{
    ContactError, ContactIn, ContactRows, DetectorIn, Dimension, Impact, ImpactLaw, ImpactReport,
    InverseMass, gap_rows,
};

/// Bodies under a potential, in the plane or in space.
pub type BodiesIn<G, P> = System<<G as Dimension>::Metric, P, <G as Dimension>::Space>;

/// What a step of a world took and left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WorldReport {
    /// Contact points within reach of the step.
    pub contacts: usize,
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

/// A contact of the last step, and the impulses that it took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch<G: Dimension> {
    /// What faced each other when the step started.
    pub contact: ContactIn<G>,
    /// The impulse of impacts along the normal, N s; zero where nothing hit.
    pub impact: f64,
    /// The impulse of resting contact along the normal, N s.
    pub normal: f64,
    /// The impulse of friction on the second body, N s, world axes.
    pub friction: G::Vector,
}

/// The part of an overlap that a step gives back.
const GIVEN_BACK: f64 = 0.2;
/// Gaps up to this part of a body's size are looked at even where nothing moves.
const REACH: f64 = 1e-6;

/// Bodies, their shapes and what happens where they touch.
#[derive(Debug)]
pub struct World<G: Dimension, P> {
    system: BodiesIn<G, P>,
    detector: DetectorIn<G>,
    mass: InverseMass,
    obstacles: Vec<usize>,
    law: ImpactLaw,
    touches: Vec<Touch<G>>,
    last: LastImpulses<G>,
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
        SizeError::check("the detector's bodies", system.dim() / G::FREEDOMS, detector.bodies())?;
        let mass = InverseMass::of(system.metric())?;
        Ok(World {
            system,
            detector,
            mass,
            obstacles: Vec::new(),
            law: ImpactLaw::GeneralizedReflections,
            touches: Vec::new(),
            last: LastImpulses::default(),
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
        self.obstacles = obstacles;
        Ok(self)
    }

    /// The same with another impact law.
    pub fn with_law(self, law: ImpactLaw) -> Self {
        World { law, ..self }
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
    pub fn touches(&self) -> &[Touch<G>] {
        &self.touches
    }

    /// Everything on which the next steps depend beside the state: the impulses of the last.
    pub fn save(&self) -> Saved {
        self.last.save()
    }

    /// Takes over what the same world had saved, and goes on from its state to the same bits; what
    /// touched is known after the next step only.
    ///
    /// # Errors
    /// Numbers that no world leaves behind; the world is then as it was.
    pub fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        self.last = LastImpulses::load(saved)?;
        self.touches.clear();
        Ok(())
    }

    /// Moves a state by `h` seconds.
    ///
    /// # Errors
    /// [`ContactError::Step`] for `h`, and in space for a turn whose equation is not solved; those
    /// of [`DetectorIn::detect`]; [`ContactError::Size`] and [`ContactError::NonFinite`] for the
    /// momentum and for what comes out; [`ContactError::Immovable`] for a contact of two that
    /// nothing moves; [`ContactError::NotConverged`]. The state is then as it was.
    pub fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
    ) -> Result<WorldReport, ContactError> {
        if !(h > 0.0 && h.is_finite()) {
            return Err(StepError::Step(h).into());
        }
        let n = self.system.dim();
        SizeError::check("the momentum's components", n, state.p.components().len())?;
        SizeError::check("the poses' numbers", G::STORED * self.detector.bodies(), state.q.len())?;
        check_finite("the momentum", state.p.components())?;
        let mut before = self.velocity(&state.p);
        let kick = self.kick(state, h);
        let reach = self.reach(&before, &kick, h);
        self.detector.detect(&state.q, reach)?;
        let contacts = self.detector.take_contacts();
        let mut report = WorldReport { contacts: contacts.len(), ..Default::default() };
        report.overlap = contacts.iter().map(|c| -c.gap).fold(0.0, f64::max);
        let solved = self.solve(&contacts, &state.q, &kick, h, &mut before, &mut report);
        self.detector.put_back(contacts);
        let touches = solved?;
        let next = self.moved(state, &before, h)?;
        let whole = |t: &Touch<G>| (t.contact.id, t.contact.normal * t.normal + t.friction);
        self.last.keep(h, touches.iter().map(whole));
        self.touches = touches;
        *state = next;
        Ok(report)
    }

    /// Turns the velocity before a step into that over it.
    fn solve(
        &self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        kick: &Vector<Vec<f64>>,
        h: f64,
        v: &mut Vector<Vec<f64>>,
        report: &mut WorldReport,
    ) -> Result<Vec<Touch<G>>, ContactError> {
        if contacts.is_empty() {
            v.add_scaled(1.0, kick.view());
            return Ok(Vec::new());
        }
        let nothing = contacts[0].normal * 0.0;
        let touch = |&contact| Touch { contact, impact: 0.0, normal: 0.0, friction: nothing };
        let mut touches: Vec<_> = contacts.iter().map(touch).collect();
        let rows = gap_rows(contacts, q);
        self.impacts(&rows, kick, h, v, &mut touches, report)?;
        v.add_scaled(1.0, kick.view());
        self.rest(rows, q, h, v, &mut touches, report)?;
        Ok(touches)
    }

    /// Impacts of what would close its gap in this step.
    fn impacts(
        &self,
        rows: &ContactRows,
        kick: &Vector<Vec<f64>>,
        h: f64,
        v: &mut Vector<Vec<f64>>,
        touches: &mut [Touch<G>],
        report: &mut WorldReport,
    ) -> Result<(), ContactError> {
        let rounds = ImpactRounds { rows, mass: &self.mass, law: self.law, kick, h };
        let surfaces: Vec<[f64; 2]> =
            touches.iter().map(|t| [t.contact.gap, t.contact.restitution]).collect();
        let seen =
            |impact: &Impact, closing: &[usize], done: &ImpactReport, v: &Vector<Vec<f64>>| {
                report.impacts += done.passes;
                for (&i, impulse) in closing.iter().zip(&done.impulses) {
                    touches[i].impact += impulse;
                }
                report.work += self.work(impact, &done.impulses, v);
            };
        rounds.apply(|i| surfaces[i][0], |i| surfaces[i][1], v, seen)
    }

    /// Resting contact and friction.
    fn rest(
        &self,
        rows: ContactRows,
        q: &[f64],
        h: f64,
        v: &mut Vector<Vec<f64>>,
        touches: &mut [Touch<G>],
        report: &mut WorldReport,
    ) -> Result<(), ContactError> {
        let count = touches.len();
        let contacts = || touches.iter().map(|touch| &touch.contact);
        let share = |gap: f64| if gap < 0.0 { GIVEN_BACK * gap } else { gap };
        let bias: Vec<f64> = contacts().map(|c| share(c.gap) / h).collect();
        let normal = Impact::new(rows, &self.mass, vec![0.0; count])?;
        let start = v.clone();
        let (pushed, rubbed) = self.guess(contacts(), h);
        let done = project_with(&normal, &all(count), &bias, &pushed, v.view_mut())?;
        let mut pushes = done.impulses;
        report.residual = done.residual;
        // What does not slide needs no friction.
        let rubs = |c: &&ContactIn<G>| c.friction > 0.0;
        let slip = contacts().filter(rubs).map(|c| c.sliding(q, v.view())).fold(0.0, f64::max);
        report.coulomb = slip;
        if slip > SETTLED * normal.approach(start.view()) {
            let friction: Vec<f64> = contacts().map(|c| c.friction).collect();
            let mut sliding = ContactRows::new();
            contacts().for_each(|contact| contact.push_tangents(q, &mut sliding));
            let none = vec![0.0; sliding.len()];
            let tangent = Impact::new(sliding, &self.mass, none)?;
            let friction = RowFriction {
                normal: &normal,
                tangent: &tangent,
                bias: &bias,
                friction: &friction,
            };
            v.copy_from(start.view());
            let done = friction.stagger(pushed, rubbed, v.view_mut())?;
            (report.residual, report.coulomb) = (done.residual, done.coulomb);
            report.work += self.work(&tangent, &done.friction, v);
            pushes = done.normal;
            let mut rubbed = done.friction.into_iter();
            for touch in touches.iter_mut() {
                for tangent in touch.contact.tangents() {
                    touch.friction = touch.friction + tangent * rubbed.next().unwrap_or(0.0);
                }
            }
        }
        report.work += self.work(&normal, &pushes, v);
        touches.iter_mut().zip(pushes).for_each(|(touch, pushed)| touch.normal = pushed);
        Ok(())
    }

    /// The normal and the friction impulses that the last step ended with.
    fn guess<'a>(
        &'a self,
        contacts: impl Iterator<Item = &'a ContactIn<G>> + Clone,
        h: f64,
    ) -> (Vec<f64>, Vec<f64>) {
        let (mut pushed, mut rubbed) = (Vec::new(), Vec::new());
        for (contact, impulse) in contacts.clone().zip(self.last.guess(contacts, h)) {
            let along = |direction| impulse.map_or(0.0, |impulse| G::dot(&impulse, &direction));
            pushed.push(along(contact.normal));
            rubbed.extend(contact.tangents().into_iter().map(along));
        }
        (pushed, rubbed)
    }

    /// The work that obstacles do by these impulses.
    fn work(&self, impact: &Impact, impulses: &[f64], v: &Vector<Vec<f64>>) -> f64 {
        if self.obstacles.is_empty() {
            return 0.0;
        }
        let power = |contact: usize| {
            let held = impact.rows().row(contact).filter(|&(f, _)| self.mass.is_held(f));
            held.map(|(freedom, value)| value * v.0[freedom]).sum::<f64>()
        };
        impulses.iter().enumerate().map(|(i, impulse)| -impulse * power(i)).sum()
    }

    fn velocity(&self, p: &Covector<Vec<f64>>) -> Vector<Vec<f64>> {
        let mut v = Vector(vec![0.0; self.system.dim()]);
        self.system.metric().sharp(p.view(), v.view_mut());
        v
    }

    /// The velocity that the potential gives in a step; none to obstacles.
    fn kick(&self, state: &State<Vec<f64>>, h: f64) -> Vector<Vec<f64>> {
        let mut dv = Covector(vec![0.0; self.system.dim()]);
        self.system.potential().add_differential(&state.q, dv.view_mut());
        for (freedom, dv) in dv.0.iter_mut().enumerate() {
            *dv *= if self.mass.is_held(freedom) { 0.0 } else { -h };
        }
        self.velocity(&dv)
    }

    /// How far apart two bodies may be and still meet in a step.
    fn reach(&self, v: &Vector<Vec<f64>>, kick: &Vector<Vec<f64>>, h: f64) -> f64 {
        let fastest = |(body, (v, kick)): (usize, (&[f64], &[f64]))| {
            let length = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
            let radius = self.detector.radius(body);
            let (t, f) = (G::TRANSLATION, G::FREEDOMS);
            let speed = |v: &[f64]| length(&v[..t]) + radius * length(&v[t..f]);
            h * (speed(v) + speed(kick)) + REACH * radius
        };
        let both = v.0.chunks_exact(G::FREEDOMS).zip(kick.0.chunks_exact(G::FREEDOMS));
        let bodies = both.enumerate();
        2.0 * bodies.map(fastest).fold(0.0, f64::max)
    }

    /// The state a step later: centres straight, rotations free.
    fn moved(
        &self,
        state: &State<Vec<f64>>,
        v: &Vector<Vec<f64>>,
        h: f64,
    ) -> Result<State<Vec<f64>>, ContactError> {
        let mut next = state.clone();
        self.system.metric().flat(v.view(), next.p.view_mut());
        G::advance(self.system.metric(), &mut next.q, &v.0, &mut next.p.0, h)?;
        check_finite("the configuration", &next.q)?;
        check_finite("the momentum", next.p.components())?;
        check_time(state.t + h)?;
        next.t = state.t + h;
        Ok(next)
    }
}
