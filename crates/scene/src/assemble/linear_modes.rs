//! Motion near rest in closed form: a few modes instead of all freedoms, and no steps.
//!
//! ```text
//! dV(q0) = 0,    H v_i = lambda_i M v_i,    q(t) = q0 + sum_i v_i alpha_i(t)           (14.1, 14.2)
//! ```
//! `q0` is where the scene comes to rest from its start, `alpha` begins with what the start has of
//! each mode. Rigid motions that cost nothing are added to the number that was asked for. The
//! energy that a run writes down is that of the scene itself at q(t): where it is not constant, the
//! motion is too large for its modes.

use stationary_calculus::{Metric, SymmetricMatrix, Vector};
use stationary_integrators::StepReport;
use stationary_modal::{Linearized, Modes, RigidMotions};

use crate::assemble::error::AssemblyError;
use crate::assemble::rest;
use crate::assemble::rest::Rest;
use crate::assemble::system::SceneProblem;
use crate::model::built::Built;

/// The modes of a scene and its start among them.
pub(crate) struct LinearModes {
    pub(crate) rest: Vec<f64>,
    pub(crate) modes: Modes,
    pub(crate) mass: SymmetricMatrix,
    pub(crate) displacement: Vector<Vec<f64>>,
    pub(crate) velocity: Vector<Vec<f64>>,
    pub(crate) prepared: StepReport,
    pub(crate) built: Built,
}

impl LinearModes {
    /// So many modes of a problem, besides rigid motions.
    pub(crate) fn of<const D: usize>(
        problem: &SceneProblem,
        count: usize,
    ) -> Result<Self, AssemblyError> {
        let (system, initial) = (&problem.system, &problem.initial);
        let (metric, potential) = (system.metric(), system.potential());
        let Rest { q: rest, tolerance, newton, built } =
            rest::rest::<D>(metric, potential, &initial.q, problem.scale)?;
        // The factor is for a tolerance that differs in its last digit.
        let mut near_rest = Linearized::at(metric, potential, &rest, 2.0 * tolerance)?;
        let rigid = RigidMotions::of_points::<D>(&near_rest, rest.as_chunks().0)?;
        let modes = near_rest.lowest(count, &rigid)?.with_rigid(&rigid)?;
        let displacement = initial.q.iter().zip(&rest).map(|(q, rest)| q - rest).collect();
        let mut velocity = Vector(vec![0.0; rest.len()]);
        metric.sharp(initial.p.view(), velocity.view_mut());
        let mass = near_rest.mass().clone();
        let prepared = StepReport {
            differentials: newton.residuals + modes.solves() as u32,
            hessians: newton.iterations + modes.factorizations() as u32,
            energies: newton.energies,
            ..StepReport::default()
        };
        let displacement = Vector(displacement);
        let made = Built { modes: modes.len() as u64, sparse_solvers: 1, ..Built::default() };
        let built = built + made;
        Ok(LinearModes { rest, modes, mass, displacement, velocity, prepared, built })
    }
}
