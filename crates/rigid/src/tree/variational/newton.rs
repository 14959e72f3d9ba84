//! Newton's method for the end of a variational step: one pass inward and one outward in an iteration.
//!
//! ```text
//! r = p - S^T X^T P(q')                    what is left of the equation, summed inward
//! S^T X^T H X' S' dq' = r,  q' <- q' dq'   solved outward, where each body is placed anew on the way
//! ```
//! The matrix of the first guess serves again, with the columns that belong to it, as long as each correction is a
//! small part of the one before. So the last correction solves its linear equation to rounding, whatever the age of
//! the matrix, and is added to `P` with the same matrix: momenta are kept to their own rounding.

use nalgebra::{Matrix3, Vector3};
use stationary_calculus::NewtonFailure;
use stationary_integrators::StepError;

use super::super::bilinear::Bilinear;
use super::super::builder::{Link, Tree};
use super::super::motion::{Placed, TreeMotion};
use super::super::spatial::{SpatialForce, Twist};
use super::turn::Turn;
use super::{TreeVariational, failed};

/// Most iterations: steps that resolve their motion take three, and one or two once some were made.
const ITERATIONS: usize = 30;
/// The first correction is small enough below this part of the tree: the next would be its square.
const SMALL: f64 = 1e-9;
/// A later one is where the next, as much smaller again, would be rounding of the tree.
const NEXT: f64 = 4.0 * f64::EPSILON;
/// A correction this small against the distance from the origin is rounding, which grows with the root of the
/// turns that follow each other along a branch.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// A matrix serves again while corrections shrink by this factor.
const SHRINKING: f64 = 0.05;
/// A turn in one step, radians, beyond which its logarithm may have taken the other way.
const LONGEST_TURN: f64 = 3.1;

/// The linear equations of an iteration, and the memory of its passes.
#[derive(Clone)]
pub(super) struct Equations {
    /// Where the tree is placed to which the matrix belongs.
    at: TreeMotion,
    /// Of each body the sum of its branches, then what is left of it.
    forms: Vec<Bilinear>,
    forces: Vec<SpatialForce>,
    /// Bodies on which several branches meet.
    forks: Vec<usize>,
    /// `H s+` of each freedom, and `H^T s-`.
    levers: Vec<[SpatialForce; 2]>,
    inverses: Vec<f64>,
    rest: Vec<f64>,
    /// What each body carries along the step, half its weight's impulse less.
    pub(super) carried: Vec<SpatialForce>,
    /// How its angular part changes with turns at the step's end.
    pub(super) slopes: Vec<Matrix3<f64>>,
    /// The last displacement of each body at the step's end.
    pub(super) moved: Vec<Twist>,
    change: Vec<f64>,
    /// The sizes of the tree and of its distance from the origin, kg^1/2 m.
    size: f64,
    reach: f64,
    /// The root of the number of joints on the longest branch.
    branches: f64,
}

/// What a body carries, of its places at both ends of a step under a gravity; the step and one over it.
#[inline]
fn carried(
    turn: &Turn,
    [before, after]: [&Placed; 2],
    mass: f64,
    (gravity, [h, rate]): (&Vector3<f64>, [f64; 2]),
) -> SpatialForce {
    let step = (after.centre - before.centre) * rate;
    SpatialForce {
        force: (step - gravity * (0.5 * h)) * mass,
        torque: before.matrix * (turn.momentum() * rate),
    }
}

impl Equations {
    pub(super) fn new(motion: &TreeMotion) -> Self {
        let (bodies, freedoms) = (motion.tree.bodies(), motion.tree.speeds());
        Equations {
            forms: vec![Bilinear::zero(); bodies],
            forces: vec![SpatialForce::zero(); bodies],
            forks: motion.tree.forks(),
            levers: vec![[SpatialForce::zero(); 2]; freedoms],
            inverses: vec![0.0; freedoms],
            rest: vec![0.0; freedoms],
            carried: vec![SpatialForce::zero(); bodies],
            slopes: vec![Matrix3::zeros(); bodies],
            moved: vec![Twist::zero(); bodies],
            change: vec![0.0; freedoms],
            size: 0.0,
            reach: 0.0,
            branches: (motion.tree.depth() as f64).sqrt(),
            at: motion.clone(),
        }
    }

    /// Whether a correction, after one of the size `before` with the same matrix, is the last.
    fn is_last(&self, size: f64, before: f64) -> bool {
        let small = if before.is_finite() {
            size / before * size <= NEXT * self.size
        } else {
            size <= SMALL * self.size
        };
        small || size <= ROUNDING * self.branches * self.reach
    }
}

impl<D> TreeVariational<D> {
    /// The matrix and what is left of the equations where the guess has the tree; the longest turn.
    fn factor(&mut self, h: f64) -> Result<f64, StepError> {
        let TreeVariational { before, equations, kicks, gravity, .. } = self;
        let Equations { at, forms, forces, forks, levers, inverses, .. } = equations;
        let Equations { rest, carried: carries, slopes, size, reach, .. } = equations;
        for &fork in &*forks {
            (forms[fork], forces[fork]) = (Bilinear::zero(), SpatialForce::zero());
        }
        let (mut longest, mut sizes, mut reaches) = (0.0_f64, 0.0, 0.0);
        let mut branch: Option<SpatialForce> = None;
        let links = &before.tree.links;
        let rate = 1.0 / h;
        for (body, link) in links.iter().enumerate().rev() {
            let (start, end) = (&before.placed[body], &at.placed[body]);
            let Link { mass, moments, .. } = link;
            let turn = Turn::between(start, end, moments);
            longest = longest.max(turn.theta.norm_squared());
            let mut f = carried(&turn, [start, end], *mass, (gravity, [h, rate]));
            carries[body] = f;
            let slope = start.matrix * (turn.slope(moments) * rate) * end.matrix.transpose();
            slopes[body] = slope;
            let (back, ahead) = (start.offset(), end.offset());
            let arm = if link.parent.is_some() { &back } else { &start.arm };
            sizes += mass * arm.norm_squared() + moments.sum();
            reaches += mass * start.centre.norm_squared();
            let (before_it, rest_of_it) = forms.split_at_mut(body);
            let form = &mut rest_of_it[0];
            if let Some(force) = branch.take() {
                f += force;
            } else if !link.forks {
                *form = Bilinear::zero();
            }
            form.add_body(mass * rate, &slope);
            if link.forks {
                f += forces[body];
            }
            for k in link.speeds.clone().rev() {
                let (minus, plus) = (&before.columns[k], &at.columns[k]);
                let own = [form.times(plus), form.transposed_times(minus)];
                let pivot = own[0].along(minus);
                if pivot.is_nan() || pivot <= 0.0 {
                    return Err(StepError::SingularLegendreTransform);
                }
                let inverse = 1.0 / pivot;
                rest[k] = kicks.momenta[k] - f.along(minus);
                form.give_way(&own[0], &own[1], inverse);
                f += own[0] * (rest[k] * inverse);
                (levers[k], inverses[k]) = (own, inverse);
            }
            let Some(parent) = link.parent else { continue };
            let f = f.inward(&back);
            if parent + 1 == body {
                branch = Some(f);
            } else {
                forces[parent] += f;
            }
            let moved = form.inward(&back, &ahead);
            if links[parent].forks {
                before_it[parent].add(&moved);
            } else {
                before_it[parent] = moved;
            }
        }
        (*size, *reach) = (sizes.sqrt(), reaches.sqrt());
        Ok(longest.sqrt())
    }

    /// What is left of the equations where the last correction has led, for the same matrix; the longest turn.
    fn reduce(&mut self, h: f64) -> f64 {
        let TreeVariational { before, after, equations, kicks, gravity, .. } = self;
        let Equations { forces, forks, levers, inverses, rest, carried: carries, .. } = equations;
        for &fork in &*forks {
            forces[fork] = SpatialForce::zero();
        }
        let (mut longest, rate) = (0.0_f64, 1.0 / h);
        let mut branch: Option<SpatialForce> = None;
        for (body, link) in before.tree.links.iter().enumerate().rev() {
            let (start, end) = (&before.placed[body], &after.placed[body]);
            let turn = Turn::between(start, end, &link.moments);
            longest = longest.max(turn.theta.norm_squared());
            let mut f = carried(&turn, [start, end], link.mass, (gravity, [h, rate]));
            carries[body] = f;
            if let Some(force) = branch.take() {
                f += force;
            }
            if link.forks {
                f += forces[body];
            }
            for k in link.speeds.clone().rev() {
                rest[k] = kicks.momenta[k] - f.along(&before.columns[k]);
                f += levers[k][0] * (rest[k] * inverses[k]);
            }
            let Some(parent) = link.parent else { continue };
            let f = f.inward(&start.offset());
            if parent + 1 == body {
                branch = Some(f);
            } else {
                forces[parent] += f;
            }
        }
        longest.sqrt()
    }

    /// Solves for the correction, and places the tree where it leads; its size, kg^1/2 m.
    fn correct(&mut self) -> f64 {
        let TreeVariational { after, equations, guesses, next, .. } = self;
        let Equations { at, levers, inverses, rest, moved, change, .. } = equations;
        let Tree { links, .. } = &at.tree;
        let mut size = 0.0;
        for (body, link) in links.iter().enumerate() {
            let placed = &at.placed[body];
            let mut own = match link.parent {
                Some(parent) => moved[parent].outward(&placed.offset()),
                None => Twist::zero(),
            };
            for k in link.speeds.clone() {
                let felt = levers[k][1].along(&own);
                change[k] = (rest[k] - felt) * inverses[k];
                guesses.displacement[k] += change[k];
                own += at.columns[k] * change[k];
            }
            moved[body] = own;
            let turned = placed.matrix.tr_mul(&own.angular);
            size += link.mass * own.linear.norm_squared()
                + link.moments.component_mul(&turned).dot(&turned);
            let q = &mut next.q[link.coordinates.clone()];
            link.joint.advance(q, &change[link.speeds.clone()]);
            after.put_body(body, q);
        }
        size.sqrt()
    }

    /// Newton's method from the guess in `next`, after which the tree is placed at its end; the iterations, and the
    /// size of the last correction.
    pub(super) fn find(&mut self, h: f64) -> Result<(u32, f64), StepError> {
        self.equations.at.put(&self.next.q);
        let mut turn = self.factor(h)?;
        let mut before = f64::INFINITY;
        let mut history = [0.0; ITERATIONS];
        for iteration in 0..ITERATIONS {
            let size = self.correct();
            history[iteration] = size;
            if !size.is_finite() {
                return Err(failed(NewtonFailure::NonFinite(0), &history[..=iteration]));
            }
            if self.equations.is_last(size, before) {
                if turn > LONGEST_TURN {
                    return Err(failed(NewtonFailure::NotConverged, &history[..=iteration]));
                }
                return Ok((iteration as u32 + 1, size));
            }
            if size <= SHRINKING * before.min(self.equations.size) {
                turn = self.reduce(h);
                before = size;
            } else {
                std::mem::swap(&mut self.equations.at, &mut self.after);
                turn = self.factor(h)?;
                before = f64::INFINITY;
            }
        }
        Err(failed(NewtonFailure::NotConverged, &history))
    }

    /// The momenta at the end of the step, of what the bodies carry after the last correction.
    pub(super) fn finish(&mut self, h: f64) {
        let TreeVariational { after, equations, gravity, next, .. } = self;
        let Equations { carried, slopes, moved, .. } = equations;
        let rate = 1.0 / h;
        for (body, link) in after.tree.links.iter().enumerate() {
            let (carried, moved) = (&carried[body], &moved[body]);
            let corrected = moved.linear * rate + *gravity * h;
            after.forces[body] = SpatialForce {
                force: carried.force + corrected * link.mass,
                torque: carried.torque + slopes[body] * moved.angular,
            };
        }
        after.gather(next.p.components_mut());
    }
}
