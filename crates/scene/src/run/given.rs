//! What acts on bodies that touch, as impulses over the steps of a world.
//!
//! ```text
//! F_k = J_k/h,    W_k = <J_k, u>         u the mean of the velocities after impacts and at the step's end
//! W   = (<f, dx> + <f', dx>)/2           of a pin that moves by dx and pulls with f before, f' after
//! ```

use stationary_calculus::{Covector, Force, Vector};
use stationary_contact::StepForces;
use stationary_integrators::State;

use crate::assemble::acting::{Acting, Impulses};
use crate::model::scene::Scene;

/// What acts on a scene, and its impulses over a step.
#[derive(Debug)]
pub(crate) struct Given {
    acting: Option<Acting>,
    impulses: Impulses,
    h: f64,
}

impl Given {
    pub(crate) fn of(scene: &Scene) -> Self {
        Given { acting: Acting::of(scene), impulses: Impulses::default(), h: 0.0 }
    }
}

impl Force for Given {
    fn dim(&self) -> usize {
        self.impulses.dim()
    }

    fn add_force(&self, _: f64, _: &[f64], _: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        for &(freedom, impulse) in self.impulses.entries() {
            f.0[freedom] += impulse / self.h;
        }
    }

    fn works(&self) -> usize {
        self.acting.as_ref().map_or(0, |acting| acting.works().len())
    }
}

impl StepForces for Given {
    fn prepare(&mut self, state: &State<Vec<f64>>, h: f64) {
        self.impulses.clear();
        self.h = h;
        if let Some(acting) = &self.acting {
            acting.give((state.t, h), &state.q, state.p.components(), &mut self.impulses);
        }
    }

    fn add_works(&self, ends: [&State<Vec<f64>>; 2], u: Vector<&[f64]>, works: &mut [f64]) {
        if let Some(acting) = &self.acting {
            acting.add_given_works(&self.impulses, ends, u.0, works);
        }
    }

    fn next_corner(&self, t: f64) -> Option<f64> {
        self.acting.as_ref()?.next_corner(t)
    }
}
