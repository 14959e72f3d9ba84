//! Rows of all laws that answer to one another, solved together: sweeps over them, and semismooth
//! Newton to rounding.
//!
//! ```text
//! u = W x + o                                            W = J M^-1 J^T, o = J v - w
//! equality    u = 0
//! limit       x <= u/d  open, x = 0            x > u/d   pushes, u = 0
//! bounded     |x - u/d| <= b  holds, u = 0     else      x = b sign(x - u/d)
//! cone        its normal as a limit; where it pushes, with z = x_t - u_t/d
//!             |z| <= mu x_n  sticks, u_t = 0   else      slides, x_t = mu x_n z/|z|
//! left = max_i |x_i - nearest(x_i - u_i/d_i)| d_i                                      m/s
//! ```
//! `x` impulses (N s), `u` what velocities lack (m/s), `d` the diagonal of `W` (1/kg), across a cone the
//! largest eigenvalue of its tangents' block. Each of Newton's steps solves the equations of the sets
//! that it finds, linearized, by a dense factor of unknowns that are scaled to a unit diagonal. Redundant
//! rows make `W` singular: a small compliance keeps their impulses where they are, and as what is left
//! is measured without it, it has no say in what comes out. Sets are judged where equalities keep what they
//! ask for; where those of the guess lead nowhere, pivots find others (`lemke.rs`). Coulomb's law has no
//! energy that all of this would lower, so that nothing is taken on trust: only impulses that leave less
//! than those before are kept. Source: Alart and Curnier 1991; Kaufman, Sueda, James and Pai 2008 (the
//! sweeps).

use std::ops::Range;

use stationary_constraints::RowLaw;

use crate::coupled::lemke::Lemke;
use crate::coupled::reduced_rows::ReducedRows;

/// The most steps of Newton's method. Sets that change still after these go in circles.
const NEWTONS: usize = 12;
/// Steps that leave more than half of what those before have left, after which what is enough is rounding.
const STAYS: usize = 2;
/// Tries of Newton's method. The compliance that is added to each row, relative to its own: at first far
/// above the rounding of a factor, so that redundant rows have one, and so small that few steps take off
/// what it leaves; then less, where masses differ much. And how much of a rate counts as an impulse where
/// it is judged what pushes, and what rubs, relative to one over the row's own compliance.
const TRIES: [[f64; 3]; 3] = [[1e-10, 1.0, 1.0], [1e-13, 1.0, 1.0], [1e-15, 0.1, 0.1]];
/// The same of a refinement: as little compliance as leaves redundant rows a factor.
const REFINING: [f64; 3] = [1e-13, 1.0, 1.0];
/// The same where pivots have found what pushes, and no more than that is to push.
const HELD: [f64; 3] = [1e-13, 0.0, 1.0];
/// What is left relative to the fastest rate before any impulse that is rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// The most rows for which Lemke's pivots are tried: their work grows with the cube as well, and there
/// are many of them.
const PIVOTED: usize = 150;
/// The most pyramids in the place of cones: the friction that one finds turns the next.
const PYRAMIDS: usize = 6;
/// Pivots below this are none.
const PIVOT: f64 = 1e-30;
/// Sweeps that find the sets before each try of Newton's method, the first and the last: each try
/// begins with twice as many.
const FIRST_SWEEPS: usize = 16;
const LAST_SWEEPS: usize = 1024;

/// Rows in blocks, the compliance between each two, and the memory of solving them.
#[derive(Debug, Default)]
pub(crate) struct CoupledRows {
    laws: Vec<RowLaw>,
    /// Where the rows of each block start, and the end of all.
    starts: Vec<usize>,
    /// The compliance between each two rows, 1/kg, and the rates before any impulse, m/s.
    compliance: Vec<f64>,
    free: Vec<f64>,
    /// The own compliance of each row, of tangents the largest of their block, and what makes an
    /// impulse one of a unit compliance.
    own: Vec<f64>,
    scale: Vec<f64>,
    rates: Vec<f64>,
    /// Newton's equations by rows, and their right side.
    matrix: Vec<f64>,
    right: Vec<f64>,
    /// The impulses that left the least so far, and those that are tried.
    best: Vec<f64>,
    tried: Vec<f64>,
    found: Vec<f64>,
    lemke: Lemke,
    reduced: ReducedRows,
    /// The rows of equalities.
    equal: Vec<usize>,
}

/// How far the laws are from being met, m/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Left {
    /// Along equalities, limits and normals.
    pub(crate) normal: f64,
    /// Of friction, in joints and across normals.
    pub(crate) friction: f64,
}

impl Left {
    pub(crate) fn worst(self) -> f64 {
        // A rate that is no number is as far off as can be.
        match self.normal.is_nan() || self.friction.is_nan() {
            true => f64::INFINITY,
            false => self.normal.max(self.friction),
        }
    }
}

impl CoupledRows {
    /// Forgets all rows.
    pub(crate) fn clear(&mut self) {
        self.laws.clear();
        self.starts.clear();
        self.starts.push(0);
        self.free.clear();
    }

    /// Appends a block, by the rates of its rows before any impulse.
    pub(crate) fn push(&mut self, law: RowLaw, free: impl IntoIterator<Item = f64>) {
        self.laws.push(law);
        self.free.extend(free);
        self.starts.push(self.free.len());
    }

    /// How many rows there are.
    pub(crate) fn rows(&self) -> usize {
        self.free.len()
    }

    /// Takes the compliance between each two rows, row after row, of which the first is the smaller.
    pub(crate) fn couple(&mut self, mut between: impl FnMut(usize, usize) -> f64) {
        let n = self.rows();
        self.compliance.clear();
        self.compliance.resize(n * n, 0.0);
        for i in 0..n {
            for j in i..n {
                let product = between(i, j);
                self.compliance[n * i + j] = product;
                self.compliance[n * j + i] = product;
            }
        }
        self.own.clear();
        self.own.extend((0..n).map(|i| self.compliance[n * i + i]));
        for (law, rows) in self.laws.iter().zip(self.starts.windows(2)) {
            let (first, end) = (rows[0] + 1, rows[1]);
            if let (RowLaw::Cone(_), true) = (law, first < end) {
                let [xx, yy] = [self.own[first], self.own[end - 1]];
                let xy = if end - first > 1 { self.compliance[n * first + end - 1] } else { 0.0 };
                let half = 0.5 * (xx - yy);
                self.own[first..end].fill(0.5 * (xx + yy) + half.hypot(xy));
            }
        }
        self.scale.clear();
        self.scale.extend(self.own.iter().map(|d| if *d > 0.0 { d.sqrt().recip() } else { 1.0 }));
    }

    /// Solves the rows from a guess of their impulses until no more than `enough` (m/s) is left, or as
    /// far as they let themselves; says what is left, and how many systems were solved.
    pub(crate) fn solve(&mut self, x: &mut [f64], enough: f64) -> (Left, usize) {
        let mut solved = self.solve_by_sets(x, enough);
        let (mut left, mut sweeps) = (self.left(x), FIRST_SWEEPS);
        let mut swept = std::mem::take(&mut self.found);
        while left.worst() > enough && sweeps <= LAST_SWEEPS {
            swept.clear();
            swept.extend_from_slice(x);
            self.sweep(&mut swept, sweeps);
            solved += self.newton(&mut swept, enough);
            let now = self.left(&swept);
            if now.worst() < left.worst() {
                left = now;
                x.copy_from_slice(&swept);
            }
            sweeps *= 2;
        }
        self.found = swept;
        (left, solved)
    }

    /// Gives equalities the impulses by which they keep what they ask for beside those of the others: sets are
    /// judged by rates.
    fn hold(&mut self, x: &mut [f64]) {
        let CoupledRows { laws, starts, equal, .. } = self;
        let blocks = laws.iter().zip(&*starts);
        equal.clear();
        equal.extend(blocks.filter(|(law, _)| **law == RowLaw::Equality).map(|(_, row)| row));
        if equal.is_empty() {
            return;
        }
        self.find_rates(x);
        let CoupledRows { compliance, scale, rates, matrix, right, equal, .. } = self;
        let n = x.len();
        matrix.clear();
        right.clear();
        for (own, &row) in equal.iter().enumerate() {
            let line = matrix.len();
            matrix
                .extend(equal.iter().map(|of| compliance[n * row + of] * scale[row] * scale[*of]));
            matrix[line + own] += TRIES[0][0];
            right.push(-rates[row] * scale[row]);
        }
        if self.eliminate() && self.right.iter().all(|step| step.is_finite()) {
            for (&row, step) in self.equal.iter().zip(&self.right) {
                x[row] += self.scale[row] * step;
            }
        }
    }

    /// The same by sets alone: those of the guess, else those that pivots find.
    pub(crate) fn solve_by_sets(&mut self, x: &mut [f64], enough: f64) -> usize {
        self.hold(x);
        let (mut least, mut solved) = self.newton_by(TRIES[0], x, enough, 0);
        if least > enough {
            (least, solved) = self.pivot(x, enough, solved);
        }
        for by in &TRIES[1..] {
            if least > enough {
                (least, solved) = self.newton_by(*by, x, enough, solved);
            }
        }
        solved
    }

    /// The same by sets that Lemke's pivots find, again and again: the first edges of each pyramid are along the
    /// friction that the one before has found. Says what is left.
    fn pivot(&mut self, x: &mut [f64], enough: f64, before: usize) -> (f64, usize) {
        let (mut least, mut solved) = (self.left(x).worst(), before);
        let others = self.rows() - self.equal.len();
        if others == 0 || others > PIVOTED {
            return (least, solved);
        }
        let mut found = std::mem::take(&mut self.found);
        found.clear();
        found.extend_from_slice(x);
        for _ in 0..PYRAMIDS {
            self.find_rates(&found);
            let CoupledRows { laws, starts, compliance, free, scale, rates, reduced, .. } = self;
            reduced.find(laws, starts, compliance, free, scale);
            reduced.turn(&found, rates);
            if !self.lemke.pivot(reduced) {
                break;
            }
            reduced.put_back(&mut found);
            admit(laws, starts, &mut found);
            self.hold(&mut found);
            let mut left;
            (left, solved) = self.newton_by(HELD, &mut found, enough, solved);
            if left > enough {
                solved += self.newton(&mut found, enough);
                left = self.left(&found).worst();
            }
            let last = left <= enough || left > 0.5 * least;
            if left < least {
                least = left;
                x.copy_from_slice(&found);
            }
            if last {
                break;
            }
        }
        self.found = found;
        (least, solved)
    }

    /// How far these impulses are from meeting the laws.
    pub(crate) fn left(&mut self, x: &[f64]) -> Left {
        self.find_rates(x);
        let mut left = Left::default();
        for (&law, rows) in self.laws.iter().zip(self.starts.windows(2)) {
            let rows = rows[0]..rows[1];
            let [u, own] = [&self.rates, &self.own].map(|list| &list[rows.clone()]);
            let x = &x[rows];
            let wanted = |k: usize| if own[k] > 0.0 { x[k] - u[k] / own[k] } else { x[k] };
            match law {
                RowLaw::Equality => left.normal = worse(left.normal, u[0]),
                RowLaw::Limit => left.normal = worse(left.normal, u[0].min(own[0] * x[0])),
                RowLaw::Bounded(bound) => {
                    let off = (x[0] - wanted(0).clamp(-bound, bound)) * own[0];
                    left.friction = worse(left.friction, off);
                }
                RowLaw::Cone(friction) => {
                    left.normal = worse(left.normal, u[0].min(own[0] * x[0]));
                    let length = (1..x.len()).map(wanted).fold(0.0_f64, f64::hypot);
                    let radius = friction * x[0];
                    let part = if length > radius { radius / length } else { 1.0 };
                    let off = (1..x.len()).map(|k| (x[k] - part * wanted(k)) * own[k]);
                    left.friction = worse(left.friction, off.fold(0.0_f64, f64::hypot));
                }
            }
        }
        left
    }

    fn find_rates(&mut self, x: &[f64]) {
        self.rates.clear();
        self.rates.extend_from_slice(&self.free);
        for (rate, row) in self.rates.iter_mut().zip(self.compliance.chunks_exact(x.len().max(1))) {
            *rate += row.iter().zip(x).map(|(w, x)| w * x).sum::<f64>();
        }
    }

    /// Relaxes each block in turn, so many times: normals first, then friction within what they allow.
    fn sweep(&mut self, x: &mut [f64], sweeps: usize) {
        self.find_rates(x);
        for _ in 0..sweeps {
            for block in 0..self.laws.len() {
                let rows = self.starts[block]..self.starts[block + 1];
                let law = self.laws[block];
                let first = rows.start;
                if self.own[first] > 0.0 {
                    let wanted = x[first] - self.rates[first] / self.own[first];
                    let wanted = match law {
                        RowLaw::Equality => wanted,
                        RowLaw::Limit | RowLaw::Cone(_) => wanted.max(0.0),
                        RowLaw::Bounded(bound) => wanted.clamp(-bound, bound),
                    };
                    self.change(x, first, wanted);
                }
                if let RowLaw::Cone(friction) = law {
                    self.rub(x, first + 1..rows.end, friction * x[first]);
                }
            }
        }
    }

    /// The nearest friction to what would stop sliding.
    fn rub(&mut self, x: &mut [f64], rows: Range<usize>, radius: f64) {
        let mut wanted = [0.0; 2];
        for (wanted, row) in wanted.iter_mut().zip(rows.clone()) {
            *wanted = x[row];
            if self.own[row] > 0.0 {
                *wanted -= self.rates[row] / self.own[row];
            }
        }
        let length = wanted[0].hypot(wanted[1]);
        let part = if length > radius { radius / length } else { 1.0 };
        for (row, wanted) in rows.zip(wanted) {
            self.change(x, row, part * wanted);
        }
    }

    fn change(&mut self, x: &mut [f64], row: usize, to: f64) {
        let change = to - x[row];
        x[row] = to;
        let n = self.rows();
        let column = &self.compliance[n * row..n * (row + 1)];
        self.rates.iter_mut().zip(column).for_each(|(rate, w)| *rate += change * w);
    }

    /// Changes impulses until no more than rounding is left, if it can, and by other sets where the
    /// first lead to more than `enough` (m/s); says how many systems it solved.
    pub(crate) fn newton(&mut self, x: &mut [f64], enough: f64) -> usize {
        let mut solved = 0;
        for by in TRIES {
            let left;
            (left, solved) = self.newton_by(by, x, enough, solved);
            if left <= enough {
                break;
            }
        }
        solved
    }

    fn newton_by(
        &mut self,
        by: [f64; 3],
        x: &mut [f64],
        enough: f64,
        before: usize,
    ) -> (f64, usize) {
        let settled = ROUNDING * self.free.iter().fold(0.0_f64, |most, rate| most.max(rate.abs()));
        let mut least = self.left(x).worst();
        self.best.clear();
        self.best.extend_from_slice(x);
        self.tried.clear();
        self.tried.extend_from_slice(x);
        let (mut solved, mut stays) = (before, 0);
        while solved < before + NEWTONS && least > settled {
            self.assemble(by);
            solved += 1;
            if !self.eliminate() {
                break;
            }
            for (x, (step, scale)) in self.tried.iter_mut().zip(self.right.iter().zip(&self.scale))
            {
                *x += scale * step;
            }
            admit(&self.laws, &self.starts, &mut self.tried);
            if self.tried.iter().any(|x| !x.is_finite()) {
                break;
            }
            let tried = std::mem::take(&mut self.tried);
            let left = self.left(&tried).worst();
            self.tried = tried;
            stays = if least <= enough && left > 0.5 * least { stays + 1 } else { 0 };
            if left < least {
                least = left;
                self.best.copy_from_slice(&self.tried);
            }
            // Without joints all of the steps are taken: what stops comes to rest.
            if stays == STAYS && !self.equal.is_empty() {
                break;
            }
        }
        x.copy_from_slice(&self.best);
        (least, solved)
    }

    /// One of Newton's steps from rates that are known better than by the compliance; says whether it was taken.
    pub(crate) fn refine(&mut self, x: &mut [f64], rates: impl Iterator<Item = f64>) -> bool {
        self.rates.clear();
        self.rates.extend(rates);
        self.tried.clear();
        self.tried.extend_from_slice(x);
        self.assemble(REFINING);
        if !self.eliminate() {
            return false;
        }
        for (x, (step, scale)) in self.tried.iter_mut().zip(self.right.iter().zip(&self.scale)) {
            *x += scale * step;
        }
        admit(&self.laws, &self.starts, &mut self.tried);
        let finite = self.tried.iter().all(|x| x.is_finite());
        if finite {
            x.copy_from_slice(&self.tried);
        }
        finite
    }

    /// The equations of the sets at the impulses that are tried, in scaled impulses and rates.
    fn assemble(&mut self, [softness, pushing, firmness]: [f64; 3]) {
        let CoupledRows {
            laws, starts, compliance, own, scale, rates, matrix, right, tried, ..
        } = self;
        let n = tried.len();
        matrix.clear();
        matrix.resize(n * n, 0.0);
        right.clear();
        right.resize(n, 0.0);
        let y = |row: usize| tried[row] / scale[row];
        let u = |row: usize| rates[row] * scale[row];
        for (&law, rows) in laws.iter().zip(starts.windows(2)) {
            let (first, end) = (rows[0], rows[1]);
            let mut fix = |row: usize, to: f64| {
                matrix[n * row + row] = 1.0;
                right[row] = to - y(row);
            };
            let along = if matches!(law, RowLaw::Bounded(_)) { firmness } else { pushing };
            let wanted = y(first) - along * u(first);
            let mut stops = first..end;
            match law {
                RowLaw::Equality => {}
                RowLaw::Limit if wanted <= 0.0 => {
                    fix(first, 0.0);
                    continue;
                }
                RowLaw::Limit => {}
                RowLaw::Bounded(bound) => {
                    let bound = bound / scale[first];
                    if wanted.abs() > bound || own[first] <= 0.0 {
                        fix(first, wanted.clamp(-bound, bound));
                        continue;
                    }
                }
                RowLaw::Cone(_) if wanted <= 0.0 => {
                    (first..end).for_each(|row| fix(row, 0.0));
                    continue;
                }
                RowLaw::Cone(friction) if end > first + 1 => {
                    let wanted = |row: usize| y(row) - firmness * u(row);
                    let length = (first + 1..end).map(wanted).fold(0.0_f64, f64::hypot);
                    // Friction in scaled impulses.
                    let mu = friction * scale[first] / scale[first + 1];
                    let radius = mu * y(first);
                    if length > radius || friction == 0.0 {
                        stops.end = first + 1;
                        let along = |row| if length > 0.0 { wanted(row) / length } else { 0.0 };
                        let part = if length > 0.0 { radius / length } else { 0.0 };
                        for row in first + 1..end {
                            let own = n * row;
                            matrix[own + row] += 1.0;
                            matrix[own + first] -= mu * along(row);
                            // The direction of sliding turns with the rates.
                            for of in first + 1..end {
                                let same = f64::from(u8::from(row == of));
                                let turn = part * (same - along(row) * along(of));
                                matrix[own + of] -= turn;
                                for column in 0..n {
                                    let w = compliance[n * of + column];
                                    matrix[own + column] +=
                                        turn * firmness * w * scale[of] * scale[column];
                                }
                            }
                            right[row] = radius * along(row) - y(row);
                        }
                    }
                }
                RowLaw::Cone(_) => {}
            }
            for row in stops {
                for column in 0..n {
                    let w = compliance[n * row + column];
                    matrix[n * row + column] = w * scale[row] * scale[column];
                }
                matrix[n * row + row] += softness;
                right[row] = -u(row);
            }
        }
    }

    /// Solves by elimination with pivots of columns, the solution in the place of the right side;
    /// says whether there was one.
    fn eliminate(&mut self) -> bool {
        let n = self.right.len();
        let (matrix, right) = (&mut self.matrix, &mut self.right);
        for column in 0..n {
            let size = |row: usize| matrix[row * n + column].abs();
            let pivot = (column..n).max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(column);
            if !(size(pivot) > PIVOT && size(pivot).is_finite()) {
                return false;
            }
            if pivot != column {
                (0..n).for_each(|k| matrix.swap(pivot * n + k, column * n + k));
                right.swap(pivot, column);
            }
            let (above, below) = matrix.split_at_mut((column + 1) * n);
            let from = &above[column * n + column..];
            for (row, to) in below.chunks_exact_mut(n).enumerate() {
                let part = to[column] / from[0];
                if part != 0.0 {
                    to[column..].iter_mut().zip(from).for_each(|(to, from)| *to -= part * from);
                    right[column + 1 + row] -= part * right[column];
                }
            }
        }
        for row in (0..n).rev() {
            let known: f64 = (row + 1..n).map(|k| matrix[row * n + k] * right[k]).sum();
            right[row] = (right[row] - known) / matrix[row * n + row];
        }
        true
    }
}

/// Takes impulses to admissible ones: friction within what pushes.
fn admit(laws: &[RowLaw], starts: &[usize], x: &mut [f64]) {
    for (&law, rows) in laws.iter().zip(starts.windows(2)) {
        let x = &mut x[rows[0]..rows[1]];
        let RowLaw::Cone(friction) = law else {
            law.nearest(x);
            continue;
        };
        let [normal, across @ ..] = x else { continue };
        *normal = normal.max(0.0);
        let radius = friction * *normal;
        let length = across.iter().fold(0.0_f64, |sum, x| sum.hypot(*x));
        if length > radius {
            across.iter_mut().for_each(|x| *x *= radius / length);
        }
    }
}

/// The larger of two sizes; what is no number stays so.
fn worse(worst: f64, off: f64) -> f64 {
    let off = off.abs();
    if off.is_nan() || off > worst { off } else { worst }
}
