//! Particles that touch: Stormer-Verlet with impulses where gaps close.

use stationary_calculus::DiagonalMetric;
use stationary_contact::{Balls, GapImpulses, Impacting, Inequality};
use stationary_integrators::State;

use crate::assemble::error::AssemblyError;
use crate::assemble::system::{ScenePotential, SceneProblem};
use crate::assemble::vertices::Vertices;
use crate::model::built::Built;
use crate::model::contact_side::ContactSide;
use crate::model::items::SceneContact;
use crate::model::scene::Scene;
use crate::run::contact_impulses::Push;
use crate::run::error::StepFailure;
use crate::run::stepper::{Stepped, Stepper};

/// What steps particles whose gaps impulses keep open.
pub(crate) fn stepper<'s, const D: usize>(
    scene: &'s Scene,
    contact: &SceneContact,
    all: &'s Inequality<Balls<D>>,
    problem: &'s SceneProblem,
) -> Result<Box<dyn Stepper + 's>, AssemblyError> {
    let SceneContact { restitution, law, when, .. } = *contact;
    let gaps = all.gaps(0.0, &problem.initial.q).len();
    let impacting = Impacting::new(&problem.system, all, restitution, law, when)?;
    let between = Sides::new(scene, contact);
    Ok(Box::new(Impulses { impacting, gaps, all, between, pushes: Vec::new() }))
}

type Masses = DiagonalMetric<Vec<f64>>;

/// Steps with impulses.
struct Impulses<'s, const D: usize> {
    impacting: Impacting<'s, Masses, ScenePotential, Balls<D>>,
    gaps: usize,
    all: &'s Inequality<Balls<D>>,
    between: Sides<'s>,
    /// Those of the last step.
    pushes: Vec<Push>,
}

/// What each gap is between. Gaps are numbered as [`Scene::gaps`] makes them: those of all free
/// particles to walls, then to fixed balls and pins, then to each other.
struct Sides<'s> {
    scene: &'s Scene,
    vertices: Vertices,
    walls: usize,
    fixed: Vec<ContactSide>,
}

impl<'s> Sides<'s> {
    fn new(scene: &'s Scene, contact: &SceneContact) -> Self {
        let pins = scene.round_pins().map(ContactSide::Pin);
        let fixed = (0..contact.balls.len()).map(ContactSide::Ball).chain(pins).collect();
        Sides { scene, vertices: Vertices::new(scene), walls: contact.walls.len(), fixed }
    }

    /// What does not move at a gap, where there is such a thing.
    fn fixed(&self, gap: usize) -> Option<ContactSide> {
        let free = self.vertices.free;
        match gap.checked_sub(free * self.walls) {
            None => Some(ContactSide::Wall(gap % self.walls)),
            Some(gap) if gap < free * self.fixed.len() => Some(self.fixed[gap % self.fixed.len()]),
            Some(_) => None,
        }
    }

    /// An impulse at a gap, from the entries of its differential: those of the particle that it
    /// pushes along the normal stand last.
    fn push<const D: usize>(
        &self,
        (gap, impulse): (usize, f64),
        row: &[(usize, f64)],
        given: &GapImpulses<'_>,
    ) -> Option<Push> {
        let (first, second) = row.split_at_checked(row.len().checked_sub(D)?)?;
        let particle = |entries: &[(usize, f64)]| {
            entries.first().map(|&(freedom, _)| self.vertices.particles[freedom / D])
        };
        let pushed = particle(second)?;
        let other = match particle(first) {
            Some(particle) => ContactSide::Particle(particle),
            None => self.fixed(gap)?,
        };
        let (mut point, mut normal) = ([0.0; 3], [0.0; 3]);
        let radius = self.scene.particles()[pushed].radius;
        for (c, &(freedom, n)) in second.iter().enumerate() {
            normal[c] = n;
            point[c] = given.q[freedom] - radius * n;
        }
        let between = [other, ContactSide::Particle(pushed)];
        let impulse = normal.map(|n| impulse * n);
        Some(Push { between, time: given.time, point, normal, impulse })
    }
}

impl<const D: usize> Stepper for Impulses<'_, D> {
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        _: f64,
    ) -> Result<Stepped, StepFailure> {
        let Impulses { impacting, all, between, pushes, .. } = self;
        pushes.clear();
        let met = impacting.step_seen(state, h, &mut |given| {
            let rows = all.rows(given.time, given.q, given.gaps);
            for (place, (&gap, &impulse)) in given.gaps.iter().zip(given.impulses).enumerate() {
                let row: Vec<_> = rows.row(place).collect();
                pushes.extend(between.push::<D>((gap, impulse), &row, &given));
            }
        })?;
        Ok(Stepped::met(met.impacts, met.last_impact))
    }

    fn pushes(&self, _: f64, see: &mut dyn FnMut(Push)) {
        self.pushes.iter().copied().for_each(see);
    }

    fn built(&self) -> Built {
        Built { gaps: self.gaps as u64, ..Built::default() }
    }
}
