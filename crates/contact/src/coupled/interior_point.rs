//! Impulses that nearly meet the laws, from the inside of what is admissible.
//!
//! ```text
//! limit      y = x,            z = u
//! cone       y = (m x_n, x_t), z = (u_n/m + |u_t|, u_t)          both in the cone y_0 >= |y_1..|
//! moment     another y_1.. and z beside the same y_0:  the shares z_0 of one normal add up, and so do |u_t| and |u_r|
//! bounded    y = x,            z - z' = u,  z (b + y) = z' (b - y) = mu
//! W y + o + |u_t| e = z,       y o z = mu 1                      from mu large to mu = 0
//!
//! (W + D + H) dy = mu y^-1 - (W y + o + |u_t| e),    dz = mu y^-1 - z - H dy,    H y = z
//! ```
//! `m` the friction coefficient, `u_r` the rates of a moment, `D` the differential of `|u_t|`, or nothing where a step
//! by it leaves the cones at once, `H` the scaling of Nesterov and Todd. Coulomb's law is the complementarity of these
//! cones. No set is chosen on the way, so that none can go in circles: where many corners rub at their reach, what
//! comes is in the middle of all answers, and near enough for Newton's method. Source: De Saxce and Feng 1998 (the
//! cones); Nesterov and Todd 1998; Acary, Cadoux, Lemarechal and Malick 2011 (friction).

use std::ops::Range;

use crate::coupled::dense_factor::DenseFactor;
use crate::coupled::row_laws::{BlockLaw, RowLaws, size};

/// The most steps.
const STEPS: usize = 100;
/// How far towards the edge of what is admissible a step goes.
const INSIDE: f64 = 0.99;
/// The least part of `mu` that a step aims at, so that what is near an edge comes off it.
const LEAST_PART: f64 = 0.1;
/// Where a step can be taken no farther, relative to one, `|u_t|` stays as it is in the next; and where a step is none.
const SHORT: f64 = 0.1;
const SHORTEST: f64 = 1e-8;
/// What equalities and bounded rows give way by, relative to their own compliance, so that redundant ones have a factor.
const SOFTNESS: f64 = 1e-13;

/// The impulses and rates of a row, their steps, and those of the upper bound of a bounded one, or of the share of a
/// moment in the rates of its normal.
#[derive(Clone, Copy, Debug, Default)]
struct Pair {
    y: f64,
    z: f64,
    upper: f64,
    dy: f64,
    dz: f64,
    d_upper: f64,
}

/// What a block of rows is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Free,
    HalfLine,
    Circle,
    /// A circle about an impulse of another block, of this row.
    Beside(usize),
    Between(f64),
}

impl Form {
    /// The row of a circle's middle, and those across.
    fn around(self, block: &Range<usize>) -> Option<(usize, Range<usize>)> {
        match self {
            Form::Circle => Some((block.start, block.start + 1..block.end)),
            Form::Beside(normal) => Some((normal, block.clone())),
            Form::Free | Form::HalfLine | Form::Between(_) => None,
        }
    }
}

/// Rows in their variables, and the memory of the steps.
#[derive(Debug, Default)]
pub(crate) struct InteriorPoint {
    blocks: Vec<(Form, Range<usize>)>,
    /// What makes a variable an impulse, row by row; zero where none is given.
    scale: Vec<f64>,
    pairs: Vec<Pair>,
    /// `W y + o + |u_t| e`, the change of `W y + |u_t| e` over a step, and the right side and the solution of one.
    rates: Vec<f64>,
    change: Vec<f64>,
    right: Vec<f64>,
    /// `d|u_t|/du_t`, row by row.
    turning: Vec<f64>,
    factor: DenseFactor,
    /// What `y z` is at first.
    first: f64,
    steps: usize,
}

impl InteriorPoint {
    /// Begins in the middle; says whether there is something to find.
    pub(crate) fn start(&mut self, rows: &RowLaws) -> bool {
        let InteriorPoint { blocks, scale, pairs, .. } = self;
        blocks.clear();
        scale.clear();
        scale.resize(rows.rows(), 0.0);
        for (law, block) in rows.blocks() {
            let first = block.start;
            let mut form = Form::HalfLine;
            match law {
                BlockLaw::Equality => form = Form::Free,
                BlockLaw::Bounded(0.0) => continue,
                BlockLaw::Bounded(bound) => form = Form::Between(bound / rows.scale[first]),
                BlockLaw::Cone(m) if block.len() > 1 && m > 0.0 => form = Form::Circle,
                BlockLaw::Disc { part: 0.0, .. } => continue,
                BlockLaw::Disc { normal, .. } => form = Form::Beside(normal),
                BlockLaw::Limit | BlockLaw::Cone(_) => {}
            }
            let around = matches!(form, Form::Circle | Form::Beside(_));
            let block = if around { block } else { first..first + 1 };
            scale[block.clone()].copy_from_slice(&rows.scale[block.clone()]);
            match law {
                BlockLaw::Cone(m) if around => scale[first] = rows.scale[first + 1] / m,
                BlockLaw::Disc { normal, part } => {
                    let own = part * scale[normal];
                    scale[block.clone()].fill(own);
                }
                _ => {}
            }
            blocks.push((form, block));
        }
        let start = rows.free.iter().zip(&*scale).map(|(o, s)| (o * s).abs()).fold(0.0, f64::max);
        pairs.clear();
        pairs.resize(rows.rows(), Pair::default());
        for (form, block) in &*blocks {
            let pair = &mut pairs[block.start];
            match form {
                Form::Free => {}
                Form::HalfLine | Form::Circle => (pair.y, pair.z) = (start, start),
                Form::Beside(_) => pair.upper = start,
                Form::Between(_) => (pair.z, pair.upper) = (start, start),
            }
        }
        self.first = start * start;
        self.steps = 0;
        start > 0.0 && start.is_finite()
    }

    /// Goes on to this part of where it began, and writes impulses; says how many systems were solved, and whether it
    /// got there.
    pub(crate) fn go_on(&mut self, rows: &RowLaws, part: f64, x: &mut [f64]) -> (usize, bool) {
        let before = self.steps;
        let there = loop {
            let mu = self.mean();
            self.find_rates(rows);
            if mu <= part * self.first {
                break true;
            }
            if self.steps >= STEPS {
                break false;
            }
            self.find_turning();
            let mut go = self.aim(rows, mu);
            if go < SHORT {
                self.turning.fill(0.0);
                go = self.aim(rows, mu);
            }
            let steps = self.pairs.iter().flat_map(|pair| [pair.dy, pair.dz, pair.d_upper]);
            if !(go > SHORTEST && steps.map(|d| go * d).all(f64::is_finite)) {
                break false;
            }
            for pair in &mut self.pairs {
                pair.y += go * pair.dy;
                pair.z += go * pair.dz;
                pair.upper += go * pair.d_upper;
            }
        };
        let impulses = self.pairs.iter().zip(&self.scale).map(|(pair, scale)| pair.y * scale);
        x.iter_mut().zip(impulses).for_each(|(x, of)| *x = of);
        rows.admit(x);
        (self.steps - before, there)
    }

    /// Finds a step; says how far it can be taken.
    fn aim(&mut self, rows: &RowLaws, mu: f64) -> f64 {
        self.steps += 1;
        self.write(rows);
        if !self.factor.factorize() {
            return 0.0;
        }
        // Straight to the end, to see how far that would go, then with as much in the middle as that asks for.
        self.step(rows, 0.0);
        let part = (1.0 - self.reach().min(1.0)).powi(3).max(LEAST_PART);
        self.step(rows, part * mu);
        (INSIDE * self.reach()).min(1.0)
    }

    /// The mean of `y z` over all edges.
    fn mean(&self) -> f64 {
        let (mut sum, mut edges) = (0.0, 0.0);
        for (form, block) in &self.blocks {
            let pairs = &self.pairs[block.clone()];
            match *form {
                Form::Free => {}
                Form::HalfLine | Form::Circle => {
                    sum += pairs.iter().map(|pair| pair.y * pair.z).sum::<f64>();
                    edges += 1.0;
                }
                Form::Beside(normal) => {
                    let across = pairs.iter().map(|pair| pair.y * pair.z).sum::<f64>();
                    sum += self.pairs[normal].y * pairs[0].upper + across;
                    edges += 1.0;
                }
                Form::Between(bound) => {
                    let Pair { y, z, upper, .. } = pairs[0];
                    sum += (bound + y) * z + (bound - y) * upper;
                    edges += 2.0;
                }
            }
        }
        sum / f64::max(edges, 1.0)
    }

    /// The rates that impulses lead to.
    fn find_rates(&mut self, rows: &RowLaws) {
        let InteriorPoint { blocks, scale, pairs, rates, .. } = self;
        rates.clear();
        rates.extend_from_slice(&rows.free);
        add_answers(rows, scale, pairs.iter().map(|pair| pair.y), rates);
        rates.iter_mut().zip(&*scale).for_each(|(rate, scale)| *rate *= scale);
        for (form, block) in &*blocks {
            if let Some((normal, across)) = form.around(block) {
                rates[normal] += size(rates[across].iter().copied());
            }
        }
    }

    /// `d|u_t|/du_t` of each cone.
    fn find_turning(&mut self) {
        self.turning.clear();
        self.turning.resize(self.rates.len(), 0.0);
        for (_, across) in self.blocks.iter().filter_map(|(form, block)| form.around(block)) {
            let length = size(self.rates[across.clone()].iter().copied());
            for row in across.filter(|_| length > 0.0) {
                self.turning[row] = self.rates[row] / length;
            }
        }
    }

    /// The matrix of a step.
    fn write(&mut self, rows: &RowLaws) {
        let n = rows.rows();
        self.factor.clear(n);
        for row in 0..n {
            let line = self.factor.line(row);
            if self.scale[row] == 0.0 {
                line[row] = 1.0;
                continue;
            }
            let compliance = rows.compliance[n * row..].iter().zip(&self.scale);
            for (to, (w, scale)) in line.iter_mut().zip(compliance) {
                *to = w * self.scale[row] * scale;
            }
        }
        for (form, block) in &self.blocks {
            let first = block.start;
            let Pair { y, z, upper, .. } = self.pairs[first];
            match *form {
                Form::Free => self.factor.line(first)[first] += SOFTNESS,
                Form::HalfLine => self.factor.line(first)[first] += z / y,
                Form::Between(bound) => {
                    self.factor.line(first)[first] +=
                        SOFTNESS + z / (bound + y) + upper / (bound - y);
                }
                Form::Circle | Form::Beside(_) => {
                    let Some((normal, across)) = form.around(block) else { continue };
                    for row in across.clone() {
                        let compliance = rows.compliance[n * row..].iter().zip(&self.scale);
                        let part = self.turning[row] * self.scale[row];
                        let line = self.factor.line(normal).iter_mut();
                        line.zip(compliance).for_each(|(to, (w, scale))| *to += part * w * scale);
                    }
                    let h = scaling(circle(&self.pairs, *form, block));
                    let places = || std::iter::once(normal).chain(across.clone());
                    for (row, h) in places().zip(h) {
                        let line = self.factor.line(row);
                        places().zip(h).for_each(|(column, h)| line[column] += h);
                    }
                }
            }
        }
    }

    /// Solves for the step that aims at `mu`.
    fn step(&mut self, rows: &RowLaws, mu: f64) {
        self.right.clear();
        let held = self.rates.iter().zip(&self.scale);
        self.right.extend(held.map(|(rate, scale)| if *scale == 0.0 { 0.0 } else { -rate }));
        for (form, block) in &self.blocks {
            let first = block.start;
            let y = self.pairs[first].y;
            match *form {
                Form::Free => {}
                Form::HalfLine => self.right[first] += mu / y,
                Form::Between(bound) => self.right[first] += mu / (bound + y) - mu / (bound - y),
                Form::Circle | Form::Beside(_) => {
                    let Some((normal, across)) = form.around(block) else { continue };
                    let part = mu / inside(circle(&self.pairs, *form, block).map(|pair| pair.y));
                    self.right[normal] += part * self.pairs[normal].y;
                    across.for_each(|row| self.right[row] -= part * self.pairs[row].y);
                }
            }
        }
        self.factor.solve(&mut self.right);
        self.pairs.iter_mut().zip(&self.right).for_each(|(pair, step)| pair.dy = *step);
        self.change.clear();
        self.change.resize(self.right.len(), 0.0);
        add_answers(rows, &self.scale, self.right.iter().copied(), &mut self.change);
        self.change.iter_mut().zip(&self.scale).for_each(|(change, scale)| *change *= scale);
        for (normal, across) in self.blocks.iter().filter_map(|(form, block)| form.around(block)) {
            let turned = across.map(|row| self.turning[row] * self.change[row]);
            self.change[normal] += turned.sum::<f64>();
        }
        for index in 0..self.blocks.len() {
            let (form, block) = self.blocks[index].clone();
            match form {
                Form::Free => {}
                Form::Beside(normal) => {
                    let circle = circle(&self.pairs, form, &block);
                    let h = scaling(circle.clone())[0];
                    let aim = mu * self.pairs[normal].y / inside(circle.clone().map(|pair| pair.y));
                    let pulled: f64 = circle.zip(h).map(|(pair, h)| h * pair.dy).sum();
                    let upper = self.pairs[block.start].upper;
                    self.pairs[block.start].d_upper = aim - upper - pulled;
                    self.pairs[normal].dz -= aim - pulled;
                    for row in block {
                        self.pairs[row].dz = self.rates[row] + self.change[row] - self.pairs[row].z;
                    }
                }
                Form::Between(bound) => {
                    let Pair { y, z, upper, dy, .. } = self.pairs[block.start];
                    let pair = &mut self.pairs[block.start];
                    pair.dz = (mu - z * dy) / (bound + y) - z;
                    pair.d_upper = (mu + upper * dy) / (bound - y) - upper;
                }
                Form::HalfLine | Form::Circle => {
                    // As exact as the equations were solved.
                    for row in block {
                        self.pairs[row].dz = self.rates[row] + self.change[row] - self.pairs[row].z;
                    }
                }
            }
        }
    }

    /// How far the step can be taken.
    fn reach(&self) -> f64 {
        let mut reach = f64::INFINITY;
        for (form, block) in &self.blocks {
            let pairs = &self.pairs[block.clone()];
            let Pair { y, z, upper, dy, dz, d_upper } = pairs[0];
            reach = match *form {
                Form::Free => reach,
                Form::HalfLine => reach.min(to_zero(y, dy)).min(to_zero(z, dz)),
                Form::Between(bound) => reach
                    .min(to_zero(bound + y, dy))
                    .min(to_zero(bound - y, -dy))
                    .min(to_zero(z, dz))
                    .min(to_zero(upper, d_upper)),
                Form::Circle | Form::Beside(_) => {
                    let circle = circle(&self.pairs, *form, block);
                    reach
                        .min(to_edge(circle.clone().map(|pair| [pair.y, pair.dy])))
                        .min(to_edge(circle.map(|pair| [pair.z, pair.dz])))
                }
            };
        }
        reach
    }
}

/// The pairs of a circle, its middle first: of a moment that of its normal, with its own share of the rates.
fn circle<'a>(
    pairs: &'a [Pair],
    form: Form,
    block: &Range<usize>,
) -> impl Iterator<Item = Pair> + Clone + use<'a> {
    let (normal, across) = form.around(block).unwrap_or((block.start, block.clone()));
    let mut middle = pairs[normal];
    if let Form::Beside(_) = form {
        (middle.z, middle.dz) = (pairs[block.start].upper, pairs[block.start].d_upper);
    }
    std::iter::once(middle).chain(pairs[across].iter().copied())
}

/// Adds what impulses change of the rates of all rows.
fn add_answers(rows: &RowLaws, scale: &[f64], y: impl Iterator<Item = f64>, rates: &mut [f64]) {
    let columns = rows.compliance.chunks_exact(rates.len().max(1)).zip(y.zip(scale));
    for (column, (y, scale)) in columns.filter(|(_, (y, scale))| y * **scale != 0.0) {
        rates.iter_mut().zip(column).for_each(|(rate, w)| *rate += w * y * scale);
    }
}

/// `y_0^2 - |y_1..|^2`.
fn inside(y: impl Iterator<Item = f64> + Clone) -> f64 {
    let across = size(y.clone().skip(1));
    let first = y.take(1).sum::<f64>();
    (first - across) * (first + across)
}

/// The symmetric matrix `H` of two points in the cone with `H y = z`: `|z|/|y| (2 w w^T - J)`.
fn scaling(pairs: impl Iterator<Item = Pair> + Clone) -> [[f64; 3]; 3] {
    let of_y = inside(pairs.clone().map(|pair| pair.y)).sqrt();
    let of_z = inside(pairs.clone().map(|pair| pair.z)).sqrt();
    let product: f64 = pairs.clone().map(|pair| pair.y / of_y * (pair.z / of_z)).sum();
    let length = (2.0 * (1.0 + product)).sqrt();
    let mut w = [0.0; 3];
    for (k, (w, pair)) in w.iter_mut().zip(pairs).enumerate() {
        let sign = if k == 0 { 1.0 } else { -1.0 };
        *w = (pair.z / of_z + sign * pair.y / of_y) / length;
    }
    let mut h = [[0.0; 3]; 3];
    for (a, line) in h.iter_mut().enumerate() {
        for (b, h) in line.iter_mut().enumerate() {
            let j = if a != b {
                0.0
            } else if a == 0 {
                1.0
            } else {
                -1.0
            };
            *h = of_z / of_y * (2.0 * w[a] * w[b] - j);
        }
    }
    h
}

/// How far what is positive can change.
fn to_zero(value: f64, change: f64) -> f64 {
    if change < 0.0 { -value / change } else { f64::INFINITY }
}

/// How far a point of the cone can change, by its entries and theirs: a root of `a t^2 + 2 b t + c`.
fn to_edge(entries: impl Iterator<Item = [f64; 2]> + Clone) -> f64 {
    let (mut a, mut b, mut head) = (0.0, 0.0, f64::INFINITY);
    for (k, [y, dy]) in entries.clone().enumerate() {
        if k == 0 {
            head = to_zero(y, dy);
        }
        let sign = if k == 0 { 1.0 } else { -1.0 };
        a += sign * dy * dy;
        b += sign * y * dy;
    }
    let c = inside(entries.map(|[y, _]| y));
    let root = (b * b - a * c).sqrt();
    let positive = |t: f64| if t > 0.0 { t } else { f64::INFINITY };
    // No root is no edge: `NaN` is not positive.
    head.min(positive(c / (root - b))).min(positive(c / (-root - b)))
}
