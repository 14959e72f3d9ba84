//! Particles that touch: Stormer-Verlet with impulses where gaps close.

use stationary_calculus::DiagonalMetric;
use stationary_contact::{Balls, Impacting, Inequality};
use stationary_integrators::State;

use crate::error::StepFailure;
use crate::steps::{Chosen, Stepped, Steps, Way};
use crate::system::{ScenePotential, SceneProblem};
use crate::{AssemblyError, Built, Scene, SceneContact};

/// The gaps that impulses keep open.
struct Gaps<const D: usize> {
    gaps: Inequality<Balls<D>>,
    contact: SceneContact,
}

/// This way, where things touch and no springs push them apart.
pub(crate) fn way<const D: usize>(scene: &Scene, _: &SceneProblem<D>) -> Chosen<D> {
    let Some(contact) = scene.contact().filter(|contact| contact.stiffness.is_none()) else {
        return Ok(None);
    };
    let way = |gaps| -> Box<dyn Way<D>> { Box::new(Gaps { gaps, contact: contact.clone() }) };
    Ok(scene.gaps()?.map(way))
}

impl<const D: usize> Way<D> for Gaps<D> {
    fn steps<'s>(
        &'s self,
        _: &'s Scene,
        problem: &'s SceneProblem<D>,
    ) -> Result<Box<dyn Steps + 's>, AssemblyError> {
        let SceneContact { restitution, law, when, .. } = self.contact;
        let gaps = self.gaps.gaps(0.0, &problem.initial.q).len();
        let impacting = Impacting::new(&problem.system, &self.gaps, restitution, law, when)?;
        Ok(Box::new(Impulses { impacting, gaps }))
    }
}

type Masses = DiagonalMetric<Vec<f64>>;

/// Steps with impulses.
struct Impulses<'s, const D: usize> {
    impacting: Impacting<'s, Masses, ScenePotential<D>, Balls<D>>,
    gaps: usize,
}

impl<const D: usize> Steps for Impulses<'_, D> {
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        _: f64,
    ) -> Result<Stepped, StepFailure> {
        let met = self.impacting.step(state, h)?;
        Ok(Stepped::met(met.impacts, met.last_impact))
    }

    fn built(&self) -> Built {
        Built { gaps: self.gaps as u64, ..Built::default() }
    }
}
