//! The forces of potentials and of what else acts, along the joints.

use std::cell::RefCell;

use stationary_calculus::{Covector, Force, Vector};
use stationary_integrators::State;
use stationary_rigid::tree::{TreeError, TreeForces, TreeMotion};

use crate::assemble::acting::Acting;
use crate::assemble::body_system::BodySystem;
use crate::assemble::joint_tree::JointTree;

/// The forces of potentials and of what else acts, along the joints.
pub(super) struct Forces<'a> {
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
    pub(super) fn new(
        joints: &JointTree,
        system: &'a dyn BodySystem,
        acting: Option<Acting>,
    ) -> Self {
        let freedoms = system.initial().p.components().len();
        let (u, f) = (vec![0.0; freedoms], Covector(vec![0.0; freedoms]));
        let room = RefCell::new(Room { state: system.initial().clone(), u, f });
        Forces { joints: joints.clone(), system, acting, room }
    }

    /// What adds them. A force that is none becomes one that is not a number, which every method refuses.
    pub(super) fn drive(self) -> impl Fn(f64, &TreeMotion, &mut TreeForces) + 'a {
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
