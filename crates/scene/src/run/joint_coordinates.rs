//! Steps of bodies in the coordinates of their joints: as many numbers as there are freedoms.
//!
//! ```text
//! joint-coordinates      -D1 L(q, q') = p,  p' = D2 L(q, q')        equal steps, order 2
//! dormand-prince-853     v. = M(q)^-1 (f - C(q, v))                 steps chosen to a tolerance
//! dormand-prince-54      the same
//! W = h/2 (F u + F' u')                                             of what acts, in an equal step
//! ```
//! `q v p` coordinates, speeds and momenta of joints, `f` what potentials and all else give them: the forces
//! `F` on the bodies, whose velocities are `u`, along the joints. No joint can come apart.

use std::cell::RefCell;

use stationary_calculus::{Covector, Force, Vector};
use stationary_integrators::{
    AdaptiveMethod, DormandPrince54, DormandPrince853, Integrator, Moment, Saved, State,
    StepControl, StepError, StepReport, Tolerance,
};
use stationary_rigid::tree::{TreeError, TreeField, TreeForces, TreeMotion, TreeVariational};

use crate::assemble::acting::Acting;
use crate::assemble::body_system::BodySystem;
use crate::assemble::error::AssemblyError;
use crate::assemble::joint_tree::JointTree;
use crate::model::scene::Scene;
use crate::model::stepping::{Adaptive, Stepping};
use crate::run::adaptive::read_off;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::error::StepFailure;
use crate::run::stepper::{Stepped, Stepper};

/// What steps the bodies of a scene in the coordinates of their joints.
pub(crate) fn stepper<'a>(
    scene: &Scene,
    system: &'a dyn BodySystem,
) -> Result<Box<dyn Stepper + 'a>, AssemblyError> {
    let joints = scene.joint_tree()?;
    let [q, v] = joints.start(scene)?;
    let acting = Acting::of(scene);
    match scene.stepping {
        Stepping::Adaptive { method, tolerance } => {
            let scales = joints.scales(scene.scale(), scene.timing.horizon(), &v)?;
            let allowed = scales.into_iter().map(|scale| scale * tolerance).collect();
            let control = StepControl::from(Tolerance::componentwise(tolerance, allowed)?);
            let start = Moment::new(0.0, [q, v].concat());
            let none = TreeForces::none(&joints.tree);
            let drive = Forces::new(&joints, system, acting.clone()).drive();
            let field = TreeField::driven(joints.tree.clone(), none, drive)?;
            let method: Box<dyn AdaptiveMethod<Vec<f64>>> = match method {
                Adaptive::DormandPrince54 => Box::new(DormandPrince54::new(field, control, start)?),
                _ => Box::new(DormandPrince853::new(field, control, start)?),
            };
            let mut motion = TreeMotion::new(joints.tree.clone());
            let read = move |y: &[f64], state: &mut State<Vec<f64>>| {
                let (q, v) = y.split_at(joints.tree.coordinates());
                // What is no motion is no number either, which the sample refuses.
                if motion.place(q, v).and_then(|()| joints.read(&motion, state)).is_err() {
                    state.q.fill(f64::NAN);
                }
            };
            Ok(read_off(scene, system.initial(), method, Box::new(read), acting))
        }
        _ => {
            let h = scene.timing.stepping().step();
            let acting = acting.map(|acting| acting.with_width(h));
            let gravity = scene.steady_gravity().unwrap_or_default().into();
            let tree = joints.tree.clone();
            let bare = acting.is_none() && scene.links.is_empty();
            let (integrator, state): (Box<dyn Integrator<Vec<f64>> + 'a>, _) =
                if bare && scene.joints.iter().all(|joint| joint.stiffness == 0.0) {
                    let mut steps = TreeVariational::new(tree, gravity)?;
                    let state = steps.state(&q, &v)?;
                    (Box::new(steps), state)
                } else {
                    let drive = Forces::new(&joints, system, acting.clone()).drive();
                    let mut steps = TreeVariational::driven(tree, Default::default(), drive)?;
                    let state = steps.state(&q, &v)?;
                    (Box::new(steps), state)
                };
            let motion = TreeMotion::new(joints.tree.clone());
            let u = vec![0.0; system.initial().p.components().len()];
            let before = system.initial().clone();
            Ok(Box::new(EqualSteps {
                integrator,
                state,
                joints,
                motion,
                speeds: v,
                acting,
                before,
                u,
            }))
        }
    }
}

/// The forces of potentials and of what else acts, along the joints.
struct Forces<'a> {
    joints: JointTree,
    system: &'a dyn BodySystem,
    acting: Option<Acting>,
    room: RefCell<Room>,
}

/// A state of the bodies, their velocity and the forces on them.
struct Room {
    state: State<Vec<f64>>,
    u: Vec<f64>,
    f: Covector<Vec<f64>>,
}

impl<'a> Forces<'a> {
    fn new(joints: &JointTree, system: &'a dyn BodySystem, acting: Option<Acting>) -> Self {
        let freedoms = system.initial().p.components().len();
        let (u, f) = (vec![0.0; freedoms], Covector(vec![0.0; freedoms]));
        let room = RefCell::new(Room { state: system.initial().clone(), u, f });
        Forces { joints: joints.clone(), system, acting, room }
    }

    /// What adds them. A force that is none becomes one that is not a number, which every method refuses.
    fn drive(self) -> impl Fn(f64, &TreeMotion, &mut TreeForces) + 'a {
        move |t, motion, forces| {
            if self.add(t, motion, forces).is_err() {
                forces.joints_mut().fill(f64::NAN);
            }
        }
    }

    fn add(&self, t: f64, motion: &TreeMotion, forces: &mut TreeForces) -> Result<(), TreeError> {
        let Room { state, u, f } = &mut *self.room.borrow_mut();
        self.joints.read(motion, state)?;
        f.0.fill(0.0);
        self.system.add_differential(&state.q, f.view_mut());
        f.0.iter_mut().for_each(|f| *f = -*f);
        if let Some(acting) = &self.acting {
            acting.velocity(state.p.components(), u);
            acting.add_force(t, &state.q, Vector(u.as_slice()), f.view_mut());
        }
        self.joints.add_forces(motion, f, forces)
    }
}

/// Equal steps of the variational method.
struct EqualSteps<'a> {
    integrator: Box<dyn Integrator<Vec<f64>> + 'a>,
    /// Of the joints.
    state: State<Vec<f64>>,
    joints: JointTree,
    motion: TreeMotion,
    speeds: Vec<f64>,
    acting: Option<Acting>,
    /// The bodies before the step, and room for a velocity.
    before: State<Vec<f64>>,
    u: Vec<f64>,
}

impl EqualSteps<'_> {
    /// Writes what the joints' state means to the bodies.
    fn read(&mut self, state: &mut State<Vec<f64>>) -> Result<(), TreeError> {
        let EqualSteps { state: of_joints, joints, motion, speeds, .. } = self;
        speeds.fill(0.0);
        motion.place(&of_joints.q, speeds)?;
        motion.speeds_of(of_joints.p.components(), speeds)?;
        motion.place(&of_joints.q, speeds)?;
        joints.read(motion, state)
    }

    fn count_works(&mut self, h: f64, state: &State<Vec<f64>>) {
        let EqualSteps { acting: Some(acting), before, u, .. } = self else { return };
        acting.begin();
        for state in [&*before, state] {
            let (q, p) = (&state.q, state.p.components());
            acting.velocity(p, u);
            acting.add_powers(0.5 * h, state.t, q, p, u);
        }
    }
}

impl Stepper for EqualSteps<'_> {
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        to: f64,
    ) -> Result<Stepped, StepFailure> {
        self.before.clone_from(state);
        let iterations = self.integrator.step(&mut self.state, h)?.hessians;
        if self.read(state).is_err() {
            return Err(StepError::SingularLegendreTransform.into());
        }
        state.t = to;
        self.count_works(h, state);
        // An iteration goes through the tree inward and outward, as a differential does.
        let report = StepReport { differentials: 1 + iterations, ..StepReport::default() };
        Ok(Stepped::done(report))
    }

    fn works(&self) -> &[f64] {
        self.acting.as_ref().map_or(&[], Acting::works)
    }

    fn save(&mut self) -> Saved {
        let mut saved = self.integrator.save();
        let State { t, q, p } = &self.state;
        saved.numbers.extend(q.iter().chain(p.components()).chain([t]));
        saved
    }

    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        let mut memory = before.memory.clone();
        let (q, p) = (self.state.q.len(), self.state.p.components().len());
        let Some(own) = memory.numbers.len().checked_sub(q + p + 1) else {
            return Err(StepError::Saved("it holds fewer numbers").into());
        };
        let numbers = memory.numbers.split_off(own);
        self.integrator.load(&memory)?;
        self.state.q.copy_from_slice(&numbers[..q]);
        self.state.p.components_mut().copy_from_slice(&numbers[q..q + p]);
        self.state.t = numbers[q + p];
        Ok(())
    }
}
