//! Rigid bodies that touch: kick, impacts, resting contact with friction, free motion.
//!
//! ```text
//! v~ = v - h M^-1 dV                         the kick
//! v  <- impact where g + h dg v~ < 0         restitution, on the velocity before the kick
//! dg v + g/h >= 0,  friction                 the staggered projections
//! (t, R, m) <- moved freely with v           translation straight, rotation keeps R m
//! ```
//! `v` velocities of bodies (m/s in world axes, rad/s in body axes). Gaps are linear over the step:
//! what slides or rests keeps its gap to rounding; corners that turn overlap by order `h^2`, and a
//! fifth of that is given back each step. Approach of the order of a kick is rest and has no
//! restitution. A moving obstacle has infinite mass: contacts do not change its velocity, and the work
//! that it does is reported. On an error the state is as it was. Source: notes 11.4, 11.5.1; Stewart
//! and Trinkle 1996, Anitescu and Potra 1997 for contact by velocities.

use stationary_calculus::{Covector, Metric, Potential, SizeError, System, Vector};
use stationary_integrators::{State, StepError};
use stationary_rigid::{BodyMetric, BodySpace, ConstantVelocity, FreeRotation, Poses, Rotation};

use crate::error::check_finite;
use crate::friction::SETTLED;
use crate::projection::{all, project_with};
use crate::{
    ContactError, ContactId, ContactPoint, ContactRows, Detector, Frictional, Impact, ImpactLaw,
    InverseMass, gap_rows,
};

/// Bodies under a potential.
pub type Bodies<P> = System<BodyMetric<Poses>, P, Poses>;

/// What a step of touching bodies took and left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TouchingReport {
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

/// The part of an overlap that a step gives back.
const GIVEN_BACK: f64 = 0.2;
/// Gaps up to this part of a body's size are looked at even where nothing moves.
const REACH: f64 = 1e-6;

/// Steps of bodies that touch.
#[derive(Debug)]
pub struct TouchingBodies<'s, P> {
    system: &'s Bodies<P>,
    detector: Detector,
    mass: InverseMass,
    obstacles: Vec<usize>,
    law: ImpactLaw,
    last: Vec<(ContactId, f64)>,
}

impl<'s, P: Potential> TouchingBodies<'s, P> {
    /// Bodies with these colliders.
    pub fn new(system: &'s Bodies<P>, detector: Detector) -> Result<Self, ContactError> {
        let mass = InverseMass::of(system.metric())?;
        Ok(TouchingBodies {
            system,
            detector,
            mass,
            obstacles: Vec::new(),
            law: ImpactLaw::GeneralizedReflections,
            last: Vec::new(),
        })
    }

    /// The same with these bodies as moving obstacles, which nothing slows down.
    pub fn with_obstacles(mut self, obstacles: Vec<usize>) -> Result<Self, ContactError> {
        let bodies = self.system.metric().bodies().len();
        if let Some(&got) = obstacles.iter().find(|&&body| body >= bodies) {
            return Err(SizeError { what: "an obstacle", expected: bodies, got }.into());
        }
        self.mass = self.mass.holding(obstacles.iter().flat_map(|&body| 6 * body..6 * body + 6));
        self.obstacles = obstacles;
        Ok(self)
    }

    /// The same with another impact law.
    pub fn with_law(self, law: ImpactLaw) -> Self {
        TouchingBodies { law, ..self }
    }

    /// The detector, to look at contacts.
    pub fn detector(&mut self) -> &mut Detector {
        &mut self.detector
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
        let mut before = self.velocity(&state.p);
        let kick = self.kick(state, h);
        let reach = self.reach(&before, &kick, h);
        self.detector.detect(&state.q, reach)?;
        let contacts = self.detector.take_contacts();
        let mut report = TouchingReport { contacts: contacts.len(), ..Default::default() };
        report.overlap = contacts.iter().map(|c| -c.gap).fold(0.0, f64::max);
        let solved = self.solve(&contacts, &state.q, &kick, h, &mut before, &mut report);
        self.detector.put_back(contacts);
        let lambda = solved?;
        let next = self.moved(state, &before, h)?;
        self.last = lambda;
        *state = next;
        Ok(report)
    }

    /// Turns the velocity before a step into that over it; the normal impulses by contact.
    fn solve(
        &self,
        contacts: &[ContactPoint],
        q: &[f64],
        kick: &Vector<Vec<f64>>,
        h: f64,
        v: &mut Vector<Vec<f64>>,
        report: &mut TouchingReport,
    ) -> Result<Vec<(ContactId, f64)>, ContactError> {
        if contacts.is_empty() {
            v.add_scaled(1.0, kick.view());
            return Ok(Vec::new());
        }
        let rows = gap_rows(contacts, q);
        self.impacts(contacts, &rows, kick, h, v, report)?;
        v.add_scaled(1.0, kick.view());
        self.rest(contacts, rows, q, h, v, report)
    }

    /// Impacts of what would close its gap in this step.
    fn impacts(
        &self,
        contacts: &[ContactPoint],
        rows: &ContactRows,
        kick: &Vector<Vec<f64>>,
        h: f64,
        v: &mut Vector<Vec<f64>>,
        report: &mut TouchingReport,
    ) -> Result<(), ContactError> {
        let kicked = sum(v, kick);
        let bounces = |&i: &usize| {
            let by_kick = rows.along(i, kick.view()).abs();
            let closes = contacts[i].gap + h * rows.along(i, kicked.view()) < 0.0;
            closes && rows.along(i, v.view()) < -2.0 * by_kick && contacts[i].restitution > 0.0
        };
        if !(0..contacts.len()).any(|i| bounces(&i)) {
            return Ok(());
        }
        let closing: Vec<usize> = (0..contacts.len())
            .filter(|&i| contacts[i].gap + h * rows.along(i, kicked.view()) < 0.0)
            .collect();
        let own = closing.iter().map(|i| if bounces(i) { contacts[*i].restitution } else { 0.0 });
        let impact = Impact::new(rows.reordered(&closing), &self.mass, own.collect())?;
        report.impacts = self.law.apply(&impact, v.view_mut())?.passes;
        Ok(())
    }

    /// Resting contact and friction; the normal impulses by contact.
    fn rest(
        &self,
        contacts: &[ContactPoint],
        rows: ContactRows,
        q: &[f64],
        h: f64,
        v: &mut Vector<Vec<f64>>,
        report: &mut TouchingReport,
    ) -> Result<Vec<(ContactId, f64)>, ContactError> {
        let count = contacts.len();
        let share = |gap: f64| if gap < 0.0 { GIVEN_BACK * gap } else { gap };
        let bias: Vec<f64> = contacts.iter().map(|c| share(c.gap) / h).collect();
        let normal = Impact::new(rows, &self.mass, vec![0.0; count])?;
        let start = v.clone();
        let done = project_with(&normal, &all(count), &bias, &self.guess(contacts), v.view_mut())?;
        let mut pushes = done.impulses;
        report.residual = done.residual;
        // What does not slide needs no friction.
        let rubs = |c: &&ContactPoint| c.friction > 0.0;
        let slip = contacts.iter().filter(rubs).map(|c| c.sliding(q, v.view())).fold(0.0, f64::max);
        report.coulomb = slip;
        if slip > SETTLED * normal.approach(start.view()) {
            let friction: Vec<f64> = contacts.iter().map(|c| c.friction).collect();
            let mut sliding = ContactRows::new();
            contacts.iter().for_each(|contact| contact.push_tangents(q, &mut sliding));
            let tangent = Impact::new(sliding, &self.mass, vec![0.0; 2 * count])?;
            let frictional =
                Frictional { normal: &normal, tangent: &tangent, bias: &bias, friction: &friction };
            v.copy_from(start.view());
            let done = frictional.stagger(&pushes, v.view_mut())?;
            (report.residual, report.coulomb) = (done.residual, done.coulomb);
            report.work = self.work(&tangent, &done.friction, v);
            pushes = done.normal;
        }
        report.work += self.work(&normal, &pushes, v);
        Ok(contacts.iter().map(|contact| contact.id).zip(pushes).collect())
    }

    /// The normal impulses that the last step ended with. Both lists are sorted.
    fn guess(&self, contacts: &[ContactPoint]) -> Vec<f64> {
        let mut last = self.last.iter().peekable();
        let of = |contact: &ContactPoint| {
            while last.next_if(|(id, _)| *id < contact.id).is_some() {}
            last.next_if(|(id, _)| *id == contact.id).map_or(0.0, |(_, lambda)| *lambda)
        };
        contacts.iter().map(of).collect()
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
            let speed = |v: &[f64]| length(&v[..3]) + radius * length(&v[3..]);
            h * (speed(v) + speed(kick)) + REACH * radius
        };
        let bodies = v.0.chunks_exact(6).zip(kick.0.chunks_exact(6)).enumerate();
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
        for (i, body) in self.system.metric().bodies().iter().enumerate() {
            let rotation: Rotation = Poses::pose(&state.q, i).rotation;
            let (q, p) = (&mut next.q[7 * i..][..7], &mut next.p.0[6 * i..][..6]);
            let momentum = nalgebra::Vector3::new(p[3], p[4], p[5]);
            let turned = ConstantVelocity::turn(body, rotation, momentum, h)?;
            q.iter_mut().zip(&v.0[6 * i..][..3]).for_each(|(q, v)| *q += h * v);
            q[3..].copy_from_slice(&turned.rotation.quaternion());
            p[3..].copy_from_slice(turned.momentum.as_slice());
        }
        check_finite("the configuration", &next.q)?;
        check_finite("the momentum", next.p.components())?;
        next.t = state.t + h;
        Ok(next)
    }
}

fn sum(a: &Vector<Vec<f64>>, b: &Vector<Vec<f64>>) -> Vector<Vec<f64>> {
    let mut sum = a.clone();
    sum.add_scaled(1.0, b.view());
    sum
}
