//! The equations of the sets at some impulses, linearized: what is held, stops and slides.
//!
//! ```text
//! held      s = 0 or the bound less y              its step is known
//! stops     sum_j W_ij s_j + c s_i = -u_i
//! slides    s_t - mu a s_n - A (s_t - sum_j W_tj s_j) = mu y_n a - y_t       a = z/|z|, A = mu y_n (1 - a a^T)/|z|
//! ```
//! `y`, `s` impulses and their steps, `u`, `W` rates and compliances, all scaled to a unit diagonal of `W`, `z` as in
//! `row_laws.rs`, `c` a small compliance. Only rows that are not held are unknowns of the dense system, and sets that
//! stay are factored once.
//! Source: Alart and Curnier 1991.

use std::ops::Range;

use crate::coupled::dense_factor::DenseFactor;
use crate::coupled::row_laws::{BlockLaw, RowLaws, size};

/// How far directions and turns of sliding may have moved since they were factored: each step with the old factor
/// leaves about this part.
const NEAR: f64 = 1e-4;

/// How the sets are judged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Judging {
    /// The compliance that is added to each row, relative to its own.
    pub(crate) softness: f64,
    /// How much of a rate counts as an impulse where it is judged what pushes, and what rubs, relative to
    /// one over the row's own compliance.
    pub(crate) pushing: f64,
    pub(crate) rubbing: f64,
}

/// What a block of rows does.
#[derive(Clone, Copy, Debug)]
enum Set {
    /// Its impulses are known.
    Held,
    /// Each of its rows is to stop.
    Stops,
    /// Its normal is to stop, and nothing rubs.
    Presses,
    /// Its normal is to stop, if it has one, and friction is along `along`, `mu` times what pushes along the row
    /// `normal`; it turns with rates by `turn`.
    Slides { normal: usize, along: [f64; 2], mu: f64, turn: f64 },
}

impl Set {
    /// Whether its equations are as good as those of the other.
    fn is_near(&self, other: &Set) -> bool {
        match (self, other) {
            (Set::Held, Set::Held) | (Set::Stops, Set::Stops) | (Set::Presses, Set::Presses) => {
                true
            }
            (
                Set::Slides { along: [a, b], turn, .. },
                Set::Slides { along: [c, d], turn: other, .. },
            ) => (a - c).abs().max((b - d).abs()).max((turn - other).abs()) <= NEAR,
            _ => false,
        }
    }
}

/// The sets, and the memory of their equations.
#[derive(Debug, Default)]
pub(crate) struct SetEquations {
    sets: Vec<Set>,
    /// The rows that are unknowns.
    unknown: Vec<usize>,
    /// The known steps that are not 0, of scaled impulses.
    known: Vec<(usize, f64)>,
    right: Vec<f64>,
    factor: DenseFactor,
    /// The sets of the factor, and the compliance and the part of rates that it was made with, if there is one.
    factored: Vec<Set>,
    made_with: Option<[f64; 2]>,
}

impl SetEquations {
    /// Forgets what was factored: other rows.
    pub(crate) fn forget(&mut self) {
        self.made_with = None;
    }

    /// Takes impulses a step on, by the sets that are judged by them and by the rates at hand; says whether it could.
    pub(crate) fn step(&mut self, rows: &RowLaws, x: &mut [f64], by: Judging) -> bool {
        self.judge(rows, x, by);
        let with = Some([by.softness, by.rubbing]);
        let near = |(set, factored): (&Set, &Set)| set.is_near(factored);
        if self.made_with != with || !self.sets.iter().zip(&self.factored).all(near) {
            self.made_with = None;
            self.write(rows, by);
            if !self.factor.factorize() {
                return false;
            }
            self.made_with = with;
            self.factored.clone_from(&self.sets);
        }
        self.write_right(rows, x, by);
        self.take(rows, x)
    }

    /// Gives some rows the impulses that stop them beside those of the others.
    pub(crate) fn stop(&mut self, rows: &RowLaws, which: &[usize], softness: f64, x: &mut [f64]) {
        self.made_with = None;
        self.known.clear();
        self.unknown.clear();
        self.unknown.extend_from_slice(which);
        self.factor.clear(which.len());
        which.iter().enumerate().for_each(|(own, &row)| self.write_stop(rows, row, own, softness));
        self.right.clear();
        self.right.extend(which.iter().map(|&row| -rows.rates[row] * rows.scale[row]));
        if self.factor.factorize() {
            self.take(rows, x);
        }
    }

    /// Solves the equations, and changes impulses by them.
    fn take(&mut self, rows: &RowLaws, x: &mut [f64]) -> bool {
        self.factor.solve(&mut self.right);
        let found = self.unknown.iter().zip(&self.right);
        let steps = found.map(|(&row, &step)| (row, step)).chain(self.known.iter().copied());
        if !steps.clone().all(|(row, step)| (x[row] + rows.scale[row] * step).is_finite()) {
            return false;
        }
        steps.for_each(|(row, step)| x[row] += rows.scale[row] * step);
        true
    }

    /// What each block does at these impulses, which rows are unknown, and the steps of the others.
    fn judge(&mut self, rows: &RowLaws, x: &[f64], by: Judging) {
        let RowLaws { own, scale, rates, .. } = rows;
        let SetEquations { sets, unknown, known, .. } = self;
        sets.clear();
        unknown.clear();
        known.clear();
        let y = |row: usize| x[row] / scale[row];
        let wanted = |row: usize, part: f64| y(row) - part * rates[row] * scale[row];
        let rubs = |(normal, part): (usize, f64), across: Range<usize>| {
            // Friction in scaled impulses.
            let mu = part * scale[normal] / scale[across.start];
            let mut along = [0.0; 2];
            along.iter_mut().zip(across).for_each(|(to, row)| *to = wanted(row, by.rubbing));
            let (length, radius) = (size(along), mu * y(normal));
            let along = along.map(|along| along / length);
            match length > radius {
                true => Set::Slides { normal, along, mu, turn: radius / length },
                false => Set::Stops,
            }
        };
        for (law, block) in rows.blocks() {
            let (first, across) = (block.start, block.start + law.normals()..block.end);
            let mut held = 0.0;
            let set = match law {
                BlockLaw::Equality => Set::Stops,
                BlockLaw::Bounded(bound) => {
                    let (wanted, bound) = (wanted(first, by.rubbing), bound / scale[first]);
                    held = wanted.clamp(-bound, bound);
                    if wanted.abs() > bound || own[first] <= 0.0 { Set::Held } else { Set::Stops }
                }
                BlockLaw::Limit | BlockLaw::Cone(_) if wanted(first, by.pushing) <= 0.0 => {
                    Set::Held
                }
                BlockLaw::Disc { normal, .. } if wanted(normal, by.pushing) <= 0.0 => Set::Held,
                BlockLaw::Limit => Set::Stops,
                BlockLaw::Cone(_) if across.is_empty() => Set::Stops,
                BlockLaw::Cone(0.0) => Set::Presses,
                BlockLaw::Cone(part) => rubs((first, part), across),
                BlockLaw::Disc { normal, part } => rubs((normal, part), across),
            };
            let moves = match set {
                Set::Held => 0,
                Set::Presses => 1,
                Set::Stops | Set::Slides { .. } => block.len(),
            };
            unknown.extend(block.clone().take(moves));
            known
                .extend(block.skip(moves).map(|row| (row, held - y(row))).filter(|of| of.1 != 0.0));
            sets.push(set);
        }
    }

    /// The equations of the sets.
    fn write(&mut self, rows: &RowLaws, by: Judging) {
        self.factor.clear(self.unknown.len());
        let mut own = 0;
        for block in 0..self.sets.len() {
            let (first, end) = (rows.starts[block], rows.starts[block + 1]);
            let stops = match self.sets[block] {
                Set::Held => continue,
                Set::Stops => first..end,
                Set::Presses | Set::Slides { .. } => first..first + rows.laws[block].normals(),
            };
            let slides = stops.end..end;
            for row in stops {
                self.write_stop(rows, row, own, by.softness);
                own += 1;
            }
            let Set::Slides { normal, along, mu, turn } = self.sets[block] else { continue };
            // What presses stops, and is unknown.
            let Ok(normal) = self.unknown.binary_search(&normal) else { continue };
            let start = own;
            for across in 0..slides.len() {
                let line = self.factor.line(own);
                line[normal] -= mu * along[across];
                line[own] += 1.0;
                for (other, row) in slides.clone().enumerate() {
                    let turn = turned(along, turn, across, other);
                    if turn != 0.0 {
                        line[start + other] -= turn;
                        for (to, &column) in line.iter_mut().zip(&self.unknown) {
                            *to += turn * by.rubbing * rows.scaled(row, column);
                        }
                    }
                }
                own += 1;
            }
        }
    }

    /// The equation of a row that is to stop.
    fn write_stop(&mut self, rows: &RowLaws, row: usize, own: usize, softness: f64) {
        let line = self.factor.line(own);
        for (to, &column) in line.iter_mut().zip(&self.unknown) {
            *to = rows.scaled(row, column);
        }
        line[own] += softness;
    }

    /// The right side of the equations of the sets.
    fn write_right(&mut self, rows: &RowLaws, x: &[f64], by: Judging) {
        let SetEquations { sets, known, right, .. } = self;
        // What the known steps change.
        let changed = |row: usize| -> f64 {
            known.iter().map(|(of, step)| rows.scaled(row, *of) * step).sum()
        };
        let y = |row: usize| x[row] / rows.scale[row];
        right.clear();
        for (set, (law, block)) in sets.iter().zip(rows.blocks()) {
            let first = block.start;
            let stops = match set {
                Set::Held => continue,
                Set::Stops => block.clone(),
                Set::Presses | Set::Slides { .. } => first..first + law.normals(),
            };
            let slides = stops.end..block.end;
            right.extend(stops.map(|row| -rows.rates[row] * rows.scale[row] - changed(row)));
            let Set::Slides { normal, along, mu, turn } = *set else { continue };
            right.extend(slides.clone().enumerate().map(|(across, row)| {
                let turns = slides.clone().enumerate().map(|(other, row)| {
                    turned(along, turn, across, other) * by.rubbing * changed(row)
                });
                mu * y(normal) * along[across] - y(row) - turns.sum::<f64>()
            }));
        }
    }
}

/// How the direction of sliding turns with the rates: `A` of the equations.
fn turned(along: [f64; 2], turn: f64, row: usize, column: usize) -> f64 {
    turn * (f64::from(u8::from(row == column)) - along[row] * along[column])
}
