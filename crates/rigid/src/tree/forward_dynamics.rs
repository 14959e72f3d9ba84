//! Forward dynamics: the articulated-body algorithm, freedom by freedom.
//!
//! ```text
//! I  = own + sum of the children's I, shifted                        inward, configuration only
//!      U = I s,  D = s^T U,   I <- I - U U^T / D                      each freedom s gives way
//! b  = own + sum of the children's b + I c, shifted                   inward
//!      u = tau - s^T b,       b <- b + U u / D
//! A  = X A_p + c,   v. = (u - U^T A) / D,   A <- A + s v.            outward
//! ```
//! `I` the inertia of a branch whose joints give way, `b` the force that it takes to keep its root
//! from accelerating, `c` the bias. A joint of several freedoms gives way by one after the other, so
//! that no small matrix is ever factored: `D` are the pivots of the mass matrix, eliminated from the
//! leaves. Time and memory in proportion to the bodies. Source: Featherstone 2008, 7; Rodriguez 1987.

use super::error::TreeError;
use super::forces::TreeForces;
use super::inertia::{Inertia, Symmetric};
use super::motion::{Moving, TreeMotion};
use super::spatial::{SpatialForce, Twist};

/// A pivot this small, against the inertia that it is left of, is rounding.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl TreeMotion {
    /// Writes the acceleration of each speed, m/s^2 or rad/s^2, under these forces.
    ///
    /// # Errors
    /// [`TreeError::Singular`] where a joint moves bodies without mass in a way that moves no mass;
    /// sizes that do not fit, numbers that are not finite.
    pub fn forward_dynamics(
        &mut self,
        forces: &TreeForces,
        acceleration: &mut [f64],
    ) -> Result<(), TreeError> {
        forces.check(&self.tree)?;
        self.check_result("the acceleration", acceleration)?;
        for (body, link) in self.tree.links.iter().enumerate() {
            let own = Symmetric::turned(&link.moments, &self.placed[body].matrix);
            self.inertias[body] = Inertia::of_body(link.mass, own);
            let SpatialForce { force, torque } = forces.bodies[body];
            let w = self.moving[body].twist.angular;
            self.forces[body] = SpatialForce {
                force: -(forces.gravity * link.mass + force),
                torque: w.cross(&own.times(&w)) - torque,
            };
        }
        // Both at once: what waits for the one is done within the other.
        for body in (0..self.placed.len()).rev() {
            self.factor_branch(body)?;
            self.sum_inward(body, &forces.joints, |moving| moving.bias);
        }
        self.give_outward(|moving| moving.bias, acceleration);
        self.tree.check_speeds("the acceleration", acceleration)
    }

    /// Writes the speeds with these momenta of the joints: the inverse of the mass matrix, applied.
    ///
    /// # Errors
    /// Those of [`TreeMotion::forward_dynamics`].
    pub fn speeds_of(&mut self, momenta: &[f64], speeds: &mut [f64]) -> Result<(), TreeError> {
        self.tree.check_speeds("the momenta", momenta)?;
        self.check_result("the speeds", speeds)?;
        self.factor()?;
        self.forces.fill(SpatialForce::zero());
        self.solve(momenta, |_| Twist::zero(), speeds);
        self.tree.check_speeds("the speeds", speeds)
    }

    pub(super) fn check_result(
        &self,
        what: &'static str,
        numbers: &[f64],
    ) -> Result<(), TreeError> {
        Ok(stationary_calculus::SizeError::check(what, self.columns.len(), numbers.len())?)
    }

    /// Each body's own inertia.
    pub(super) fn set_inertias(&mut self) {
        for (body, link) in self.tree.links.iter().enumerate() {
            let own = Symmetric::turned(&link.moments, &self.placed[body].matrix);
            self.inertias[body] = Inertia::of_body(link.mass, own);
        }
    }

    /// The inertias of all branches, their freedoms given way.
    pub(super) fn factor(&mut self) -> Result<(), TreeError> {
        self.set_inertias();
        (0..self.placed.len()).rev().try_for_each(|body| self.factor_branch(body))
    }

    /// The inertia of a body's branch, of its own and those of its children, its freedoms given way.
    #[inline]
    fn factor_branch(&mut self, body: usize) -> Result<(), TreeError> {
        let TreeMotion { tree, placed, columns, inertias, levers, inverses, held, .. } = self;
        let link = &tree.links[body];
        let (before, rest) = inertias.split_at_mut(body);
        let inertia = &mut rest[0];
        let traces = inertia.traces();
        for k in link.speeds.clone().rev() {
            let s = &columns[k];
            let lever = inertia.times(s);
            let pivot = lever.along(s);
            levers[k] = lever;
            if !held.is_empty() && held.contains(&k) {
                inverses[k] = 0.0;
                continue;
            }
            if pivot.is_nan() || pivot <= ROUNDING * Inertia::bound(traces, s) {
                let freedom = k - link.speeds.start;
                let joining = tree.joining(body);
                return Err(TreeError::Singular { joining, freedom, inertia: pivot });
            }
            let inverse = 1.0 / pivot;
            inverses[k] = inverse;
            inertia.give_way(&lever, inverse);
        }
        if let Some(parent) = link.parent {
            before[parent].add_inward(inertia, &placed[body].offset());
        }
        Ok(())
    }

    /// Solves for the accelerations under the bodies' bias forces, which it sums, joint forces and
    /// biases of acceleration. In the place of a speed that is held stands the force that holds it.
    pub(super) fn solve(
        &mut self,
        joint_forces: &[f64],
        bias: impl Fn(&Moving) -> Twist,
        acceleration: &mut [f64],
    ) {
        for body in (0..self.placed.len()).rev() {
            self.sum_inward(body, joint_forces, &bias);
        }
        self.give_outward(bias, acceleration);
    }

    /// What the joints of a body leave of the forces on its branch, for its parent.
    #[inline]
    fn sum_inward(&mut self, body: usize, joint_forces: &[f64], bias: impl Fn(&Moving) -> Twist) {
        let TreeMotion {
            tree,
            placed,
            moving,
            columns,
            inertias,
            forces,
            levers,
            inverses,
            rest,
            ..
        } = self;
        let link = &tree.links[body];
        let mut b = forces[body];
        for k in link.speeds.clone().rev() {
            rest[k] = joint_forces[k] - b.along(&columns[k]);
            b += levers[k] * (rest[k] * inverses[k]);
        }
        if let Some(parent) = link.parent {
            b += inertias[body].times(&bias(&moving[body]));
            forces[parent] += b.inward(&placed[body].offset());
        }
    }

    /// The accelerations, outward, of what was summed inward.
    fn give_outward(&mut self, bias: impl Fn(&Moving) -> Twist, acceleration: &mut [f64]) {
        let TreeMotion {
            tree, placed, moving, columns, levers, inverses, rest, accelerations, ..
        } = self;
        for (body, link) in tree.links.iter().enumerate() {
            let mut a = match link.parent {
                Some(parent) => accelerations[parent].outward(&placed[body].offset()),
                None => Twist::zero(),
            } + bias(&moving[body]);
            for k in link.speeds.clone() {
                let free = rest[k] - levers[k].along(&a);
                if inverses[k] == 0.0 {
                    acceleration[k] = -free;
                    continue;
                }
                acceleration[k] = free * inverses[k];
                a += columns[k] * acceleration[k];
            }
            accelerations[body] = a;
        }
    }
}
