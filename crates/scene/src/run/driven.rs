//! Steps under what no potential gives: kicks before and after the method's own step, and the works.

use std::cell::RefCell;
use std::rc::Rc;

use stationary_calculus::Covector;
#[cfg(feature = "constraints")]
use stationary_calculus::{Metric, Vector};
#[cfg(feature = "constraints")]
use stationary_constraints::FreeMotion;
#[cfg(feature = "constraints")]
use stationary_integrators::StepError;
use stationary_integrators::{Saved, State, StepReport};

use crate::assemble::acting::{Acting, End};
use crate::assemble::error::AssemblyError;
use crate::model::built::Built;
use crate::model::scene::Scene;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::contact_impulses::Push;
use crate::run::error::StepFailure;
use crate::run::stepper::{Stepped, Stepper};

/// What acts, shared by who steps and who tells of it.
#[derive(Clone, Debug)]
pub(crate) struct Shared(Rc<RefCell<Acting>>);

impl From<Acting> for Shared {
    fn from(acting: Acting) -> Self {
        Shared(Rc::new(RefCell::new(acting)))
    }
}

/// What acts on a scene, where anything does.
pub(crate) fn shared(scene: &Scene) -> Option<Shared> {
    Acting::of(scene).map(Shared::from)
}

/// The same steps with kicks of what acts on the scene, where anything does.
pub(crate) fn kicked<'s>(scene: &Scene, inner: Box<dyn Stepper + 's>) -> Box<dyn Stepper + 's> {
    match shared(scene) {
        Some(acting) => Driven::new(inner, acting, Application::Kicks),
        None => inner,
    }
}

/// How the forces come into the steps of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Application {
    /// By kicks before and after each step.
    Kicks,
    /// Within the step, which tells their works.
    Within,
    /// The method takes forces itself; works are those of the mean force along the displacement.
    Taken,
}

/// A method under what acts.
pub(crate) struct Driven<'s> {
    inner: Box<dyn Stepper + 's>,
    acting: Shared,
    application: Application,
    before: State<Vec<f64>>,
    moved: Vec<f64>,
    works: Vec<f64>,
}

impl<'s> Driven<'s> {
    /// The method with what acts on the scene.
    pub(crate) fn new(
        inner: Box<dyn Stepper + 's>,
        acting: impl Into<Shared>,
        application: Application,
    ) -> Box<Self> {
        let acting = acting.into();
        let works = acting.0.borrow().works().to_vec();
        let before = State::new(Vec::new(), Covector(Vec::new()));
        Box::new(Driven { inner, acting, application, before, moved: Vec::new(), works })
    }
}

impl Stepper for Driven<'_> {
    fn start(&mut self, state: &mut State<Vec<f64>>) -> Result<(), AssemblyError> {
        self.inner.start(state)
    }

    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        to: f64,
    ) -> Result<Stepped, StepFailure> {
        let t = to - h;
        self.before.clone_from(state);
        if self.application == Application::Kicks {
            let mut acting = self.acting.0.borrow_mut();
            acting.kick(End::Start, (t, h), &state.q, state.p.components_mut());
        }
        let stepped = self.inner.step(state, h, to).and_then(|stepped| {
            StepFailure::of_dampers(self.acting.0.borrow_mut().take_unsolved()).map(|()| stepped)
        });
        let stepped = match stepped {
            Ok(stepped) => stepped,
            Err(failure) => {
                state.clone_from(&self.before);
                return Err(failure);
            }
        };
        let mut acting = self.acting.0.borrow_mut();
        match self.application {
            Application::Kicks => {
                acting.kick(End::Finish, (t, h), &state.q, state.p.components_mut())
            }
            Application::Within => {}
            Application::Taken => {
                let Driven { before, moved, .. } = self;
                moved.clear();
                moved.extend(state.q.iter().zip(&before.q).map(|(after, before)| after - before));
                acting.begin();
                for (now, State { q, p, .. }) in [(t, &*before), (to, &*state)] {
                    acting.add_half_works((t, to), (now, q, p.components()), moved);
                }
            }
        }
        self.works.copy_from_slice(acting.works());
        Ok(stepped)
    }

    fn reads_off(&self) -> bool {
        self.inner.reads_off()
    }

    fn takes_parts(&self) -> bool {
        self.inner.takes_parts()
    }

    fn own_ends(&self) -> &[f64] {
        self.inner.own_ends()
    }

    fn multipliers(&self) -> &[f64] {
        self.inner.multipliers()
    }

    fn pushes(&self, time: f64, see: &mut dyn FnMut(Push)) {
        self.inner.pushes(time, see);
    }

    fn works(&self) -> &[f64] {
        &self.works
    }

    fn driven_work(&self) -> f64 {
        self.inner.driven_work()
    }

    fn save(&mut self) -> Saved {
        self.inner.save()
    }

    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        self.inner.load(before)
    }

    fn prepared(&self) -> StepReport {
        self.inner.prepared()
    }

    fn built(&self) -> Built {
        self.inner.built()
    }
}

/// A free motion between the two kicks, for what holds constraints; nothing acts where it is none.
#[cfg(feature = "constraints")]
#[derive(Clone, Debug)]
pub(crate) struct Kicked<G> {
    pub(crate) motion: G,
    pub(crate) acting: Option<Shared>,
}

#[cfg(feature = "constraints")]
impl<M: Metric, S, G: FreeMotion<M, S>> FreeMotion<M, S> for Kicked<G> {
    fn advance(
        &mut self,
        metric: &M,
        space: &S,
        interval: (f64, f64),
        q: &mut [f64],
        mut p: Covector<&mut [f64]>,
        room: Vector<&mut [f64]>,
    ) -> Result<(), StepError> {
        if let Some(acting) = &self.acting {
            acting.0.borrow_mut().kick(End::Start, interval, q, p.0);
        }
        self.motion.advance(metric, space, interval, q, p.view_mut(), room)?;
        if let Some(acting) = &self.acting {
            acting.0.borrow_mut().kick(End::Finish, interval, q, p.0);
        }
        Ok(())
    }
}
