//! What a variational step holds: loops that stay closed, and joints that follow schedules.
//!
//! ```text
//! -D1 L(q, q') = p + J^T a,     g(t + h, q') = 0           solved for a by Newton's method
//! J' M'^-1 (p' + J'^T b) = -dg/dt,                         p' <- p' + J'^T b
//! f = (a + b)/h,     W = -<a, dg/dt (t)> - <b, dg/dt (t + h)>
//! ```
//! `g` the gaps of loops, whose ends in the world may move, then `q_k - s(t)` of the driven coordinates `k`, `J` their
//! slopes along the joints, `a b` impulses (N s, N m s). With what drives the tree the kicks come after `a` and before
//! `b`: the step is its own inverse. It is what RATTLE does in full coordinates.

use stationary_calculus::{DenseLu, NewtonError, NewtonFailure};
use stationary_integrators::StepError;

use super::super::error::TreeError;
use super::super::loops::{LoopRow, Rank, TreeLoops};
use super::super::motion::TreeMotion;
use super::super::prescribed::TreeDrive;
use super::super::spatial::{SpatialForce, Twist};
use super::TreeVariational;

/// Most corrections of the impulses: it takes two or three.
pub(super) const ITERATIONS: usize = 50;
/// A gap that is left is rounding, against the size of what is measured.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// So is one that corrections no longer halve.
const STALLED: f64 = 1e-9;

/// Loops, schedules, and the impulses that hold them.
#[derive(Clone)]
pub(super) struct Held {
    /// Of loops that a tree is closed by, whose rows are the first.
    loops: Option<TreeLoops>,
    pub(super) drives: Vec<TreeDrive>,
    /// `J^T`, row after row, and `M^-1 J^T`, where the tree was placed last.
    levers: Vec<f64>,
    responses: Vec<f64>,
    matrix: DenseLu,
    rank: Rank,
    unit: Vec<f64>,
    change: Vec<f64>,
    /// At the start of the step, and at its end.
    pub(super) impulses: [Vec<f64>; 2],
    /// The speed along each row that time asks for: -dg/dt, at the start of the step and at its end.
    rates: [Vec<f64>; 2],
    /// The mean force of each row in the last step, and the work of schedules and of ends that move.
    forces: Vec<f64>,
    work: f64,
}

impl Held {
    pub(super) fn new(freedoms: usize) -> Self {
        Held {
            loops: None,
            drives: Vec::new(),
            levers: Vec::new(),
            responses: Vec::new(),
            matrix: DenseLu::new(0),
            rank: Rank::default(),
            unit: vec![0.0; freedoms],
            change: Vec::new(),
            impulses: [Vec::new(), Vec::new()],
            rates: [Vec::new(), Vec::new()],
            forces: Vec::new(),
            work: 0.0,
        }
    }

    fn resize(&mut self) {
        let (m, n) = (self.rows(), self.unit.len());
        self.levers = vec![0.0; m * n];
        self.responses = vec![0.0; m * n];
        self.matrix = DenseLu::new(m);
        self.rank.resize(m);
        self.change = vec![0.0; m];
        self.impulses = [vec![0.0; m], vec![0.0; m]];
        self.rates = [vec![0.0; m], vec![0.0; m]];
        self.forces = vec![0.0; m];
    }

    fn loop_rows(&self) -> &[LoopRow] {
        self.loops.as_ref().map_or(&[], |loops| &loops.rows)
    }

    /// How many rows there are.
    pub(super) fn rows(&self) -> usize {
        self.loop_rows().len() + self.drives.len()
    }

    /// Writes the slopes of all rows where the motion is placed at one end of a step, how the tree answers to them and
    /// which speeds they ask for there.
    pub(super) fn place(
        &mut self,
        motion: &mut TreeMotion,
        end: usize,
        t: f64,
    ) -> Result<(), StepError> {
        self.set_time(t);
        motion.factor().map_err(|_| StepError::SingularLegendreTransform)?;
        let n = self.unit.len();
        let Held { loops, drives, levers, responses, unit, rates, .. } = self;
        let loops = loops.as_ref().map_or(&[][..], |loops| &loops.rows);
        let rows = loops.iter().map(Ok).chain(drives.iter().map(Err));
        for (r, row) in rows.enumerate() {
            let (lever, response) = (&mut levers[n * r..][..n], &mut responses[n * r..][..n]);
            match row {
                Ok(row) => {
                    rates[end][r] = -row.led(motion);
                    row.push(motion);
                    motion.gather(lever);
                    lever.iter_mut().for_each(|lever| *lever = -*lever);
                    row.push(motion);
                    motion.solve(unit, |_| Twist::zero(), response);
                }
                Err(drive) => {
                    rates[end][r] = drive.motion(t)[1];
                    lever.fill(0.0);
                    lever[drive.speed] = 1.0;
                    motion.forces.fill(SpatialForce::zero());
                    motion.solve(lever, |_| Twist::zero(), response);
                }
            }
        }
        Ok(())
    }

    /// Takes ends that move to where they are at a time.
    fn set_time(&mut self, t: f64) {
        self.loops.iter_mut().for_each(|loops| loops.set_time(t));
    }

    /// Sets the matrix of what all rows feel of each, by their slopes where the motion is placed.
    fn couple(&mut self) {
        let (m, n) = (self.rows(), self.unit.len());
        let Held { levers, responses, matrix, .. } = self;
        for (entry, k) in matrix.matrix().iter_mut().zip(0..) {
            let (lever, response) = (&levers[n * (k % m)..][..n], &responses[n * (k / m)..][..n]);
            *entry = lever.iter().zip(response).map(|(lever, response)| lever * response).sum();
        }
    }

    /// An error unless each row holds what no other does, and the tree does not.
    fn check_rank(&mut self, motion: &TreeMotion) -> Result<(), StepError> {
        let mut alone = true;
        let Held { loops, rank, matrix, .. } = self;
        let loops = loops.as_ref().map_or(&[][..], |loops| &loops.rows);
        rank.examine(motion, loops, matrix.matrix(), |_| alone = false);
        if alone { Ok(()) } else { Err(StepError::SingularLegendreTransform) }
    }

    /// Solves for the change of impulses that takes away what is in `change`.
    fn solve(&mut self) -> Result<(), StepError> {
        self.factor()?;
        self.matrix.solve(&mut self.change);
        Ok(())
    }

    fn factor(&mut self) -> Result<(), StepError> {
        self.matrix.factor().map_err(|_| StepError::SingularLegendreTransform)
    }

    /// Adds rows by their numbers in `change`.
    fn add(of: &[f64], change: &[f64], scale: f64, to: &mut [f64]) {
        for (row, change) in of.chunks_exact(to.len().max(1)).zip(change) {
            to.iter_mut().zip(row).for_each(|(to, row)| *to += scale * change * row);
        }
    }

    /// Adds the impulses at the start of the step.
    pub(super) fn push(&self, p: &mut [f64]) {
        Self::add(&self.levers, &self.impulses[0], 1.0, p);
    }

    /// Writes minus the gaps into `change`; the largest part of its size.
    fn open(&mut self, motion: &TreeMotion, t: f64, q: &[f64]) -> f64 {
        let Held { loops, drives, change, .. } = self;
        let loops = loops.as_ref().map_or(&[][..], |loops| &loops.rows);
        let extent = motion.extent();
        let gaps = loops.iter().map(|row| [row.gap(motion), row.size(motion, extent)]);
        let driven = drives.iter().map(|drive| {
            let place = drive.motion(t)[0];
            [q[drive.coordinate] - place, drive.size(place)]
        });
        let mut largest = 0.0_f64;
        for (change, [gap, size]) in change.iter_mut().zip(gaps.chain(driven)) {
            *change = -gap;
            largest = if gap.is_nan() { f64::NAN } else { largest.max(gap.abs() / size) };
        }
        largest
    }

    /// Holds the speeds at the end of the step, where the motion is placed: the impulses there.
    pub(super) fn settle(
        &mut self,
        motion: &mut TreeMotion,
        (t, h): (f64, f64),
        p: &mut [f64],
    ) -> Result<(), StepError> {
        self.place(motion, 1, t + h)?;
        self.couple();
        self.check_rank(motion)?;
        self.factor()?;
        let n = self.unit.len();
        self.impulses[1].fill(0.0);
        // Twice, as the matrix squares the angle between rows.
        for _ in 0..2 {
            let Held { responses, rates: [_, asked], change, impulses: [_, end], matrix, .. } =
                self;
            // J M^-1 p is <M^-1 J^T, p>.
            let answers = responses.chunks_exact(n.max(1)).zip(&*asked);
            for (change, (response, asked)) in change.iter_mut().zip(answers) {
                let has = response.iter().zip(&*p).map(|(response, p)| response * p).sum::<f64>();
                *change = asked - has;
            }
            matrix.solve(change);
            end.iter_mut().zip(&*change).for_each(|(end, change)| *end += change);
            Self::add(&self.levers, &self.change, 1.0, p);
        }
        if let Some(loops) = &self.loops {
            loops.check_aside(motion).map_err(|error| match error {
                TreeError::NotClosed { gap } => unclosed(&[gap]),
                _ => StepError::SingularLegendreTransform,
            })?;
        }
        let Held { rates, impulses: [start, end], forces, work, .. } = self;
        for ((force, a), b) in forces.iter_mut().zip(&*start).zip(&*end) {
            *force = (a + b) / h;
        }
        *work = 0.0;
        for (rates, impulses) in rates.iter().zip([&*start, &*end]) {
            *work += rates.iter().zip(impulses).map(|(rate, impulse)| rate * impulse).sum::<f64>();
        }
        Ok(())
    }
}

#[cold]
pub(super) fn unclosed(gaps: &[f64]) -> StepError {
    NewtonError { failure: NewtonFailure::NotConverged, history: gaps.to_vec() }.into()
}

impl<D> TreeVariational<D> {
    /// The same step where joints follow schedules, whatever force it takes.
    ///
    /// # Errors
    /// Drives of another tree, or two of one speed: [`TreeError::DrivenTwice`].
    pub fn prescribed(mut self, drives: Vec<TreeDrive>) -> Result<Self, TreeError> {
        TreeDrive::check_all(&drives, self.tree())?;
        self.held.drives = drives;
        self.held.resize();
        Ok(self)
    }

    /// The same step with loops held closed, beside joints that follow schedules. A step from where the loops depend on
    /// each other, or on the tree, is refused.
    ///
    /// # Errors
    /// Loops of another tree.
    pub fn closed(mut self, loops: TreeLoops) -> Result<Self, TreeError> {
        loops.check_tree(self.tree())?;
        self.held.loops = Some(loops);
        self.held.resize();
        Ok(self)
    }

    /// The mean force of each prescribed motion in the last step: N, or N m.
    pub fn drive_forces(&self) -> &[f64] {
        &self.held.forces[self.held.loop_rows().len()..]
    }

    /// The mean force along each row of the loops in the last step, as [`TreeLoops::multipliers`] has it.
    pub fn loop_forces(&self) -> &[f64] {
        &self.held.forces[..self.held.loop_rows().len()]
    }

    /// The work of the prescribed motions and of ends of loops that move in the last step, joules.
    pub fn drive_work(&self) -> f64 {
        self.held.work
    }

    /// Whether the end of the step, as it was found, holds what is held; else the correction of the impulses and of
    /// the end.
    pub(super) fn correct_impulses(
        &mut self,
        (t, h): (f64, f64),
        last: &mut f64,
    ) -> Result<bool, StepError> {
        let TreeVariational { after, held, next, guesses, .. } = self;
        held.set_time(t + h);
        let gap = held.open(after, t + h, &next.q);
        if gap <= ROUNDING || (gap >= 0.5 * *last && gap <= STALLED) {
            return Ok(true);
        }
        if !gap.is_finite() {
            return Err(unclosed(&[gap]));
        }
        *last = gap;
        // What the rows at the end feel of impulses at the start.
        let (m, n) = (held.rows(), held.unit.len());
        let first = m - held.drives.len();
        for c in 0..m {
            let response = &held.responses[n * c..][..n];
            after.set_moving(&next.q, response);
            let rows = held.loops.as_ref().map_or(&[][..], |loops| &loops.rows);
            let column = &mut held.matrix.matrix()[m * c..][..m];
            for (entry, row) in column.iter_mut().zip(rows) {
                *entry = h * row.slope(after);
            }
            for (entry, drive) in column[first..].iter_mut().zip(&held.drives) {
                *entry = h * response[drive.speed];
            }
        }
        held.solve()?;
        let Held { impulses: [start, _], change, responses, .. } = held;
        start.iter_mut().zip(&*change).for_each(|(a, change)| *a += change);
        let moved = &mut held.unit;
        Held::add(responses, change, h, moved);
        after.tree.move_along(&mut next.q, moved);
        guesses.displacement.iter_mut().zip(&*moved).for_each(|(d, moved)| *d += moved);
        moved.fill(0.0);
        Ok(false)
    }
}
