//! The variational step of a tree: order 2, symplectic, every momentum that it has kept.
//!
//! ```text
//! L(q, q') = sum 1/2 m |x' - x|^2 / h + 1/2 <theta, I theta> / h - h/2 (V(q) + V(q'))
//! theta = log(R^T R')
//! -D1 L(q, q') = p           solved for q' by Newton's method
//!   D2 L(q, q') = p'
//! P = (m (x' - x)/h, R T(-theta)^-T I theta/h)                            of a body, all along the step
//! S^T X^T (P - h/2 m g) = p,      p' = S'^T X'^T (P + h/2 m g)          summed inward
//! ```
//! `x R` the pose of a body at coordinates `q`, `I` its moments and `m` its mass, `V` its weight under
//! `g`, `T` the right Jacobian, `p` the momenta of the joints, `h` the step in seconds. It is the discrete
//! Lagrangian of 9.5 with the potential shared by both ends, on the configurations that the joints
//! allow: the same principle as RATTLE along [`FreeBodies`] of [`ConstantVelocity`] in full
//! coordinates, and so the same motion to rounding, with no multiplier and no constraint to drift.
//!
//! Each Newton iteration is one pass inward and one outward: its matrix
//! `d(-D1 L)/dq' = S^T X^T H X' S'` couples forces at the start of the step with motions at its end,
//! and gives way freedom by freedom as an articulated inertia does (the file `bilinear`). The last
//! correction is added to `P` itself, not only to the coordinates, where rounding would swallow it: so
//! momenta are kept to their own rounding, not to that of places over `h`. The condition of the mass
//! matrix multiplies that rounding. The first guess continues the displacements of the last five steps; where there
//! are none, it is a step of half the momentum's change.
//!
//! Beside the weight, [`TreeVariational::driven`] takes what acts at a time and a motion, as a kick at
//! either end of the step (the file `driven`), [`TreeVariational::prescribed`] joints that follow schedules and
//! [`TreeVariational::closed`] loops, by impulses at either end (the file `held`): what RATTLE does with a
//! [`Drive`](crate::Drive) and with joints. A body must turn by less than half a turn in a step, and
//! the step must resolve the fastest mode: below `2 / omega`.
//! Source: notes 5.5, 6.5, 9.5; Marsden and West 2001; Lee, Liu, Park and Srinivasa 2018, who solve
//! the equations of the group SE(3) with an approximate matrix.
//!
//! [`FreeBodies`]: crate::FreeBodies
//! [`ConstantVelocity`]: crate::ConstantVelocity

mod guesses;
mod held;
mod newton;
mod turn;

use std::fmt;

use nalgebra::Vector3;
use stationary_calculus::{Covector, NewtonError, NewtonFailure, SizeError, first_non_finite};
use stationary_integrators::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Integrator, Saved,
    Stability, State, StepError, StepReport, Symplecticity,
};

use super::builder::{Link, Tree};
use super::driven::Kicks;
use super::error::{TreeError, check_numbers};
use super::field::Idle;
use super::forces::TreeForces;
use super::motion::TreeMotion;
use super::spatial::SpatialForce;
use guesses::Guesses;
use held::Held;
use newton::Equations;

/// The variational step, bound to a tree under its weight and what drives it.
#[derive(Clone)]
pub struct TreeVariational<D = Idle> {
    drive: Option<D>,
    kicks: Kicks,
    gravity: Vector3<f64>,
    before: TreeMotion,
    after: TreeMotion,
    equations: Equations,
    change: Vec<f64>,
    speeds: Vec<f64>,
    next: State<Vec<f64>>,
    /// The coordinates at which `after` is placed, if it is.
    arrived: Vec<f64>,
    guesses: Guesses,
    held: Held,
    /// Momenta with the impulses that hold what is held.
    pushed: Vec<f64>,
    /// Where quaternions stand among the coordinates.
    quaternions: Vec<usize>,
}

const NAME: &str = "tree-variational";
/// How far the square of a quaternion's length may be from 1, as everywhere in the crate.
const UNIT: f64 = 2e-9;

impl<D> fmt::Debug for TreeVariational<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TreeVariational").field("tree", self.tree()).finish_non_exhaustive()
    }
}

impl TreeVariational {
    /// The step of a tree under an acceleration of gravity, m/s^2.
    ///
    /// # Errors
    /// A gravity that is not finite.
    pub fn new(tree: Tree, gravity: Vector3<f64>) -> Result<Self, TreeError> {
        Self::with(tree, gravity, None)
    }
}

impl<D: Fn(f64, &TreeMotion, &mut TreeForces)> TreeVariational<D> {
    /// The same step where `drive` adds forces at each time (s) and motion: motors, dampers, springs,
    /// loads.
    ///
    /// # Errors
    /// A gravity that is not finite.
    pub fn driven(tree: Tree, gravity: Vector3<f64>, drive: D) -> Result<Self, TreeError> {
        Self::with(tree, gravity, Some(drive))
    }
}

impl<D> TreeVariational<D> {
    fn with(tree: Tree, gravity: Vector3<f64>, drive: Option<D>) -> Result<Self, TreeError> {
        check_numbers("the gravity", 3, gravity.as_slice())?;
        let (coordinates, freedoms) = (tree.coordinates(), tree.speeds());
        let quaternion =
            |link: &Link| link.joint.quaternion().map(|first| link.coordinates.start + first);
        let quaternions = tree.links.iter().filter_map(quaternion).collect();
        let next = State::new(tree.rest(), Covector(vec![0.0; freedoms]));
        let motion = TreeMotion::new(tree);
        Ok(TreeVariational {
            drive,
            kicks: Kicks::new(&motion),
            gravity,
            after: motion.clone(),
            equations: Equations::new(&motion),
            before: motion,
            change: vec![0.0; freedoms],
            speeds: vec![0.0; freedoms],
            next,
            arrived: Vec::with_capacity(coordinates),
            guesses: Guesses::new(freedoms),
            held: Held::new(freedoms),
            pushed: vec![0.0; freedoms],
            quaternions,
        })
    }

    /// The work of what drives the tree, in the last step, joules.
    pub fn work(&self) -> f64 {
        self.kicks.work
    }

    /// The tree.
    pub fn tree(&self) -> &Tree {
        &self.before.tree
    }

    /// The state of the tree at these coordinates and speeds, at time zero. What follows a schedule is where that
    /// is.
    ///
    /// # Errors
    /// Those of [`TreeMotion::place`].
    pub fn state(&mut self, q: &[f64], v: &[f64]) -> Result<State<Vec<f64>>, TreeError> {
        let (mut q, mut v) = (q.to_vec(), v.to_vec());
        self.tree().check_coordinates(&q)?;
        self.tree().check_speeds("the speeds", &v)?;
        for drive in &self.held.drives {
            [q[drive.coordinate], v[drive.speed], _] = drive.motion(0.0);
        }
        self.before.place(&q, &v)?;
        let mut p = vec![0.0; v.len()];
        self.before.momenta(&mut p)?;
        Ok(State::new(q, Covector(p)))
    }

    /// The tree in the motion of a state.
    ///
    /// # Errors
    /// Those of [`TreeMotion::place`] and [`TreeMotion::speeds_of`].
    pub fn motion(&mut self, state: &State<Vec<f64>>) -> Result<&TreeMotion, TreeError> {
        self.before.tree.check_coordinates(&state.q)?;
        self.before.put(&state.q);
        self.before.speeds_of(state.p.components(), &mut self.speeds)?;
        self.before.set_moving(&state.q, &self.speeds);
        Ok(&self.before)
    }

    /// The energy of a state, joules.
    ///
    /// # Errors
    /// Those of [`TreeVariational::motion`].
    pub fn energy(&mut self, state: &State<Vec<f64>>) -> Result<f64, TreeError> {
        let gravity = self.gravity;
        let motion = self.motion(state)?;
        Ok(motion.kinetic_energy() + motion.potential_energy(&gravity))
    }

    fn check(&self, state: &State<Vec<f64>>, h: f64) -> Result<(), StepError> {
        if !(h > 0.0 && h.is_finite()) {
            return Err(StepError::Step(h));
        }
        let tree = self.tree();
        SizeError::check("the configuration's numbers", tree.coordinates(), state.q.len())?;
        SizeError::check("the momentum's components", tree.speeds(), state.p.components().len())?;
        if !(state.t + h).is_finite() {
            return Err(StepError::Time(state.t + h));
        }
        if let Some(freedom) = first_non_finite(&state.q) {
            return Err(StepError::NonFiniteConfiguration { freedom });
        }
        if let Some(freedom) = first_non_finite(state.p.components()) {
            return Err(StepError::NonFiniteMomentum { freedom });
        }
        for drive in &self.held.drives {
            let (number, [place, ..]) = (drive.coordinate, drive.motion(state.t));
            let off = (state.q[number] - place).abs();
            if off.is_nan() || off > UNIT * drive.size(place) {
                return Err(StepError::Configuration { number });
            }
        }
        for &number in &self.quaternions {
            let square = state.q[number..][..4].iter().map(|c| c * c).sum::<f64>();
            if square.is_nan() || (square - 1.0).abs() > UNIT {
                return Err(StepError::Configuration { number });
            }
        }
        Ok(())
    }

    /// Places the tree where a step starts: most often where the last one ended.
    fn start(&mut self, q: &[f64]) {
        if self.arrived == q {
            std::mem::swap(&mut self.before, &mut self.after);
        } else {
            self.before.put(q);
        }
        self.arrived.clear();
    }

    /// A first guess: the displacement that the last steps lead to expect if they are to be heard, or speeds of the
    /// momentum half a step on; whether the former.
    fn guess(&mut self, q: &[f64], interval: (f64, f64), warm: bool) -> Result<bool, StepError> {
        let expected = warm && self.guesses.expect(interval);
        if !expected {
            self.start_slowly(interval.1)?;
        }
        let TreeVariational { before, next, guesses, .. } = self;
        next.q.copy_from_slice(q);
        before.tree.move_along(&mut next.q, &guesses.displacement);
        Ok(expected)
    }

    /// The displacement by the speeds of the momentum half a step on.
    fn start_slowly(&mut self, h: f64) -> Result<(), StepError> {
        let TreeVariational { before, change, gravity, kicks, guesses, .. } = self;
        for (f, link) in before.forces.iter_mut().zip(&before.tree.links) {
            *f = SpatialForce { force: *gravity * link.mass, torque: Vector3::zeros() };
        }
        before.gather(change);
        let pushed = change.iter_mut().zip(&kicks.momenta);
        pushed.for_each(|(change, p)| *change = p + 0.5 * h * *change);
        match before.speeds_of(change, &mut guesses.displacement) {
            Err(TreeError::Singular { .. }) => Err(StepError::SingularLegendreTransform),
            Err(_) => Err(StepError::NonFiniteMomentum {
                freedom: first_non_finite(change).unwrap_or_default(),
            }),
            Ok(()) => {
                guesses.displacement.iter_mut().for_each(|v| *v *= h);
                Ok(())
            }
        }
    }
}

impl<D: Fn(f64, &TreeMotion, &mut TreeForces)> TreeVariational<D> {
    /// The momenta at the start of a step with the impulses of what is held, and with the kick of what acts.
    fn kick(&mut self, state: &State<Vec<f64>>, h: f64) -> Result<(), StepError> {
        let TreeVariational { drive, kicks, before, held, pushed, .. } = self;
        pushed.copy_from_slice(state.p.components());
        held.push(pushed);
        match drive {
            None => kicks.momenta.copy_from_slice(pushed),
            Some(drive) => {
                kicks.before(before, drive, (state.t, h), (state.q.as_slice(), pushed))?
            }
        }
        Ok(())
    }

    /// The end of a step that holds what is held; iterations, and the size of the last correction.
    fn seek(&mut self, state: &State<Vec<f64>>, h: f64) -> Result<(u32, f64), StepError> {
        let holds = self.held.rows() > 0;
        if holds {
            self.held.place(&mut self.before, 0, state.t)?;
        }
        self.kick(state, h)?;
        let expected = self.guess(&state.q, (state.t, h), true)?;
        let mut found = match self.find(h) {
            Err(_) if expected => {
                self.guess(&state.q, (state.t, h), false)?;
                self.find(h)
            }
            found => found,
        }?;
        let mut gap = f64::INFINITY;
        for _ in 0..if holds { held::ITERATIONS } else { 0 } {
            if self.correct_impulses((state.t, h), &mut gap)? {
                return Ok(found);
            }
            self.kick(state, h)?;
            let (more, residual) = self.find(h)?;
            found = (found.0 + more, residual);
        }
        if holds { Err(held::unclosed(&[gap])) } else { Ok(found) }
    }
}

impl<D: Fn(f64, &TreeMotion, &mut TreeForces)> Integrator<Vec<f64>> for TreeVariational<D> {
    fn facts(&self) -> Facts {
        Facts {
            name: NAME,
            order: 2,
            stages: 1,
            evaluation: Evaluation::Implicit,
            symmetric: true,
            symplecticity: match self.drive {
                None => Symplecticity::Symplectic,
                Some(_) => Symplecticity::No,
            },
            energy: EnergyBehavior::Bounded,
            linear_momentum: Conservation::Exact,
            angular_momentum: Conservation::Exact,
            stability: Stability::Below(2.0),
            damping: Damping::Conditional,
            error_growth: ErrorGrowth::Linear,
        }
    }

    fn step(&mut self, state: &mut State<Vec<f64>>, h: f64) -> Result<StepReport, StepError> {
        self.check(state, h)?;
        self.start(&state.q);
        if !self.guesses.go_on_from(state.t) {
            self.held.impulses[0].fill(0.0);
        }
        let found = self.seek(state, h);
        if found.is_err() {
            self.held.impulses[0].fill(0.0);
        }
        let (hessians, residual) = found?;
        self.finish(h);
        let TreeVariational { drive, kicks, after, held, next, .. } = self;
        if let Some(drive) = drive {
            let there = (next.q.as_slice(), next.p.components_mut());
            kicks.after(after, drive, (state.t, h), there)?;
        }
        if held.rows() > 0 {
            held.settle(after, (state.t, h), next.p.components_mut())?;
        }
        if let Some(freedom) = first_non_finite(&self.next.q) {
            return Err(StepError::NonFiniteConfiguration { freedom });
        }
        if let Some(freedom) = first_non_finite(self.next.p.components()) {
            return Err(StepError::NonFiniteMomentum { freedom });
        }
        self.kicks.work = self.kicks.tried;
        self.arrived.extend_from_slice(&self.next.q);
        self.guesses.remember((state.t, h));
        self.next.t = state.t + h;
        std::mem::swap(state, &mut self.next);
        Ok(StepReport { hessians, residual, ..StepReport::default() })
    }

    fn save(&self) -> Saved {
        let impulses = self.held.impulses[0].iter().copied();
        let numbers = impulses.chain(self.guesses.save()).collect();
        Saved { method: NAME.to_owned(), numbers }
    }

    fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        if saved.method != NAME {
            return Err(StepError::Saved("it is another method's"));
        }
        let impulses = &mut self.held.impulses[0];
        let Some((own, guesses)) = saved.numbers.split_at_checked(impulses.len()) else {
            return Err(StepError::Saved("it holds fewer numbers"));
        };
        self.guesses.load(guesses)?;
        impulses.copy_from_slice(own);
        Ok(())
    }
}

#[cold]
fn failed(failure: NewtonFailure, history: &[f64]) -> StepError {
    NewtonError { failure, history: history.to_vec() }.into()
}
