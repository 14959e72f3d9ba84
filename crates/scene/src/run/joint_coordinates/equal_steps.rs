//! Equal steps of the variational method.

use stationary_integrators::{Integrator, Saved, State, StepError, StepReport};
use stationary_rigid::tree::{TreeError, TreeForces, TreeMotion, TreeVariational};

use super::forces::Forces;
use crate::assemble::acting::Acting;
use crate::assemble::body_system::BodySystem;
use crate::assemble::error::AssemblyError;
use crate::assemble::joint_tree::JointTree;
use crate::model::scene::Scene;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::error::StepFailure;
use crate::run::stepper::{Stepped, Stepper};

/// Steps of a tree, and what holds it in the last one.
trait HoldingSteps: Integrator<Vec<f64>> {
    /// The forces along the rows of loops.
    fn loop_forces(&self) -> &[f64];

    /// The work of prescribed motions.
    fn drive_work(&self) -> f64;
}

impl<D: Fn(f64, &TreeMotion, &mut TreeForces)> HoldingSteps for TreeVariational<D> {
    fn loop_forces(&self) -> &[f64] {
        self.loop_forces()
    }

    fn drive_work(&self) -> f64 {
        self.drive_work()
    }
}

/// Steps, and the state in which they start.
type Started<'a> = (Box<dyn HoldingSteps + 'a>, State<Vec<f64>>);

/// The steps with what is held.
fn holding<'a, D: Fn(f64, &TreeMotion, &mut TreeForces) + 'a>(
    steps: TreeVariational<D>,
    joints: &JointTree,
    [q, v]: [&[f64]; 2],
) -> Result<Started<'a>, TreeError> {
    let mut steps = steps.prescribed(joints.drives.clone())?;
    if joints.loops.rows() > 0 {
        steps = steps.closed(joints.loops.clone())?;
    }
    let state = steps.state(q, v)?;
    Ok((Box::new(steps), state))
}

/// Equal steps of a scene's bodies.
pub(super) struct EqualSteps<'a> {
    integrator: Box<dyn HoldingSteps + 'a>,
    /// Of the joints.
    state: State<Vec<f64>>,
    joints: JointTree,
    motion: TreeMotion,
    speeds: Vec<f64>,
    acting: Option<Acting>,
    /// The bodies before the step, and room for a velocity.
    before: State<Vec<f64>>,
    u: Vec<f64>,
    /// As full coordinates have them.
    multipliers: Vec<f64>,
}

impl<'a> EqualSteps<'a> {
    pub(super) fn new(
        scene: &Scene,
        system: &'a dyn BodySystem,
        joints: JointTree,
        start: [&[f64]; 2],
    ) -> Result<Self, AssemblyError> {
        let h = scene.timing.stepping().step();
        let acting = Acting::of(scene).map(|acting| acting.with_width(h));
        let tree = joints.tree.clone();
        let bare = acting.is_none() && scene.links.is_empty();
        let (integrator, state) = if bare && scene.joints.iter().all(|joint| joint.stiffness == 0.0)
        {
            let gravity = scene.steady_gravity().unwrap_or_default().into();
            holding(TreeVariational::new(tree, gravity)?, &joints, start)?
        } else {
            let drive = Forces::new(&joints, system, acting.clone()).drive();
            let steps = TreeVariational::driven(tree, Default::default(), drive)?;
            holding(steps, &joints, start)?
        };
        Ok(EqualSteps {
            state,
            motion: TreeMotion::new(joints.tree.clone()),
            speeds: start[1].to_vec(),
            before: system.initial().clone(),
            u: vec![0.0; system.initial().p.components().len()],
            multipliers: Vec::new(),
            integrator,
            joints,
            acting,
        })
    }

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
        let EqualSteps { integrator, joints, multipliers, .. } = self;
        joints.write_tensions(integrator.loop_forces(), multipliers);
        // An iteration goes through the tree inward and outward, as a differential does.
        let report = StepReport { differentials: 1 + iterations, ..StepReport::default() };
        Ok(Stepped::done(report))
    }

    fn works(&self) -> &[f64] {
        self.acting.as_ref().map_or(&[], Acting::works)
    }

    fn driven_work(&self) -> f64 {
        self.integrator.drive_work()
    }

    fn multipliers(&self) -> &[f64] {
        &self.multipliers
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
