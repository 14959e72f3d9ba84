//! What a step writes before it is known to succeed: a step takes no memory once as many contacts have
//! been met.

use stationary_calculus::{Covector, Vector};
use stationary_constraints::VelocityRows;
use stationary_integrators::State;

use crate::impact::touching::Touching;
use crate::solve::body_state::BodyState;
use crate::solve::islands::Islands;
use crate::solve::rolling::ContactMoments;
use crate::solve::rolling_rows::RollingRows;
use crate::when::rigid_time_of_impact::MeetRoom;
use crate::world::jointed::JointedMemory;
use crate::world::resting::Resting;
use crate::world::warm_start::WarmStart;
use crate::{ContactIn, Dimension};

/// What a step writes before it is known to succeed.
#[derive(Debug)]
pub(crate) struct Memory<G: Dimension> {
    /// At the step's start, and between impacts and the velocity increment.
    pub(super) start: Vector<Vec<f64>>,
    pub(super) before: Vector<Vec<f64>>,
    pub(super) v: Vector<Vec<f64>>,
    pub(super) increment: Vector<Vec<f64>>,
    pub(super) lift: Vector<Vec<f64>>,
    /// Rows of joints over the step and their impulses, and the movable bodies that they name.
    pub(super) joints: VelocityRows,
    pub(super) joint_impulses: Vec<f64>,
    pub(super) linked: Vec<[usize; 2]>,
    pub(super) jointed: JointedMemory,
    /// The numbers of the contacts that are solved with joints.
    pub(super) with_joints: Vec<usize>,
    pub(super) dv: Covector<Vec<f64>>,
    /// How far each body moves in the step, m.
    pub(super) reach: Vec<f64>,
    /// Contacts of colliders that pass each other with clearance, and colliders that do not although
    /// they seemed to.
    pub(super) passing: Vec<ContactIn<G>>,
    pub(super) meeting: Vec<[usize; 2]>,
    pub(super) room: MeetRoom<G>,
    /// What comes within reach of bodies that are faster than was foreseen.
    pub(super) unseen: Vec<ContactIn<G>>,
    /// Which bodies go farther than was looked at.
    pub(super) widened: Vec<bool>,
    /// What contacts pushed in the round before.
    pub(super) again: WarmStart<G>,
    pub(super) scales: Vec<G::Velocity>,
    pub(super) states: Vec<BodyState<G>>,
    /// Velocities of bodies in world axes: after the step, and the mean with those before.
    pub(super) after: Vec<(G::Vector, G::Spin)>,
    /// Those after the step with what lifts bodies out of overlap.
    pub(super) lifted: Vec<(G::Vector, G::Spin)>,
    pub(super) mean: Vec<(G::Vector, G::Spin)>,
    pub(super) bias: Vec<f64>,
    pub(super) lift_bias: Vec<f64>,
    pub(super) lift_least: Vec<f64>,
    /// The impulse of each contact on its second body, world axes, N s.
    pub(super) impulses: Vec<G::Vector>,
    /// What impacts read of the contacts.
    pub(super) touching: Touching<G>,
    /// The impulse of impacts on the second body of each contact, world axes, N s.
    pub(super) hits: Vec<G::Vector>,
    pub(super) islands: Islands,
    pub(super) resting: Resting<G>,
    pub(super) moments: ContactMoments<G>,
    pub(super) rolling: RollingRows<G>,
    /// Velocities before any impulse, and their increment, without moments.
    pub(super) free: Vector<Vec<f64>>,
    pub(super) weight: Vector<Vec<f64>>,
    pub(super) solver: G::Solver,
    pub(super) next: State<Vec<f64>>,
}

impl<G: Dimension> Memory<G> {
    /// Of so many freedoms, and bodies of these scales.
    pub(super) fn new(n: usize, scales: Vec<G::Velocity>) -> Self {
        let zeros = || Vector(vec![0.0; n]);
        Memory {
            start: zeros(),
            before: zeros(),
            v: zeros(),
            increment: zeros(),
            lift: zeros(),
            joints: VelocityRows::default(),
            joint_impulses: Vec::new(),
            linked: Vec::new(),
            jointed: JointedMemory::default(),
            with_joints: Vec::new(),
            dv: Covector(vec![0.0; n]),
            reach: Vec::new(),
            passing: Vec::new(),
            meeting: Vec::new(),
            room: MeetRoom::default(),
            unseen: Vec::new(),
            widened: Vec::new(),
            again: WarmStart::default(),
            scales,
            states: Vec::new(),
            after: Vec::new(),
            lifted: Vec::new(),
            mean: Vec::new(),
            bias: Vec::new(),
            lift_bias: Vec::new(),
            lift_least: Vec::new(),
            impulses: Vec::new(),
            touching: Touching::default(),
            hits: Vec::new(),
            islands: Islands::default(),
            resting: Resting::default(),
            moments: ContactMoments::default(),
            rolling: RollingRows::default(),
            free: zeros(),
            weight: zeros(),
            solver: G::Solver::default(),
            next: State::default(),
        }
    }
}
