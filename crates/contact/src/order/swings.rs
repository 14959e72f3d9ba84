//! What a step leaves out where it takes forces by their means.
//!
//! ```text
//! a h^2/8                      of what moves freely or slides        a = D/m, D by how much forces leave their means
//! T h (a - A)                  of what might part or slip            A = a M/D
//! ```
//! `h` the step (s), `m` masses, `M` by how much forces may grow before a pair parts or slips (N), `T` for how long an
//! error of velocity goes on (s). Forces on one body reach others through what touches, so that the least `M` of all
//! and the sum of all `D` count; an obstacle may take along all that moves.

use stationary_calculus::{Covector, Metric, Potential, Vector};
use stationary_integrators::State;

use crate::order::step_forces::StepForces;
use crate::solve::body_state::speed;
use crate::{Dimension, World};

/// By how much forces leave their means within a step.
#[derive(Clone, Debug)]
pub(super) struct Swings {
    /// Of each freedom, N or N m, and what that gives it, m/s^2 or rad/s^2.
    forces: Covector<Vec<f64>>,
    gains: Vector<Vec<f64>>,
    /// The sum of the forces at the ends of arms, N, and the most that a body gains, m/s^2.
    sum: f64,
    most: f64,
}

impl Swings {
    pub(super) fn new(freedoms: usize) -> Self {
        let (forces, gains) = (Covector(vec![0.0; freedoms]), Vector(vec![0.0; freedoms]));
        Swings { forces, gains, sum: 0.0, most: 0.0 }
    }

    /// Asks the forces of a step that starts here.
    pub(super) fn find<G: Dimension, P: Potential>(
        &mut self,
        world: &mut World<G, P>,
        start: &State<Vec<f64>>,
        forces: &impl StepForces,
    ) {
        (self.sum, self.most) = (0.0, 0.0);
        self.forces.clear();
        forces.add_swings(start, &mut self.forces.0);
        if self.forces.0.iter().all(|force| *force == 0.0) {
            return;
        }
        let all = world.mass_that_moves();
        world.system().metric().sharp(self.forces.view(), self.gains.view_mut());
        let bodies = self.forces.0.chunks_exact(G::FREEDOMS);
        for (body, (forces, gains)) in
            bodies.zip(self.gains.0.chunks_exact(G::FREEDOMS)).enumerate()
        {
            let radius = world.detector().radius_of(body);
            self.most = self.most.max(speed::<G>(gains, radius));
            if world.is_obstacle(body) {
                self.sum += all * speed::<G>(gains, radius);
                continue;
            }
            let (shifts, turns) = forces.split_at(G::TRANSLATION);
            let [shifts, turns] = [shifts, turns].map(|f| f.iter().sum::<f64>());
            // A torque on what has no shape may reach others by any arm.
            self.sum += if turns > 0.0 { shifts + turns / radius } else { shifts };
        }
    }

    /// How far what is left out may lead at most, m.
    pub(super) fn off(&self, margin: f64, h: f64, horizon: f64) -> f64 {
        if self.most == 0.0 {
            return 0.0;
        }
        let beyond = if margin < self.sum { 1.0 - margin / self.sum } else { 0.0 };
        self.most * h * (h / 8.0 + horizon * beyond)
    }
}
