//! Active, sticking and sliding sets, found by Lemke's pivots.
//!
//! ```text
//! w - Q z - e z_0 = q,    w, z, z_0 >= 0,   w.z = 0         from z_0 large to z_0 = 0
//! limit     z = x,                  w = u
//! bounded   z = (y, s),             w = (u + s, 2 b - y)                     x = y - b
//! cone      z = (x_n, b_1.., s),    w = (u_n, e_k.u_t + s, mu x_n - sum b_k)   x_t = sum b_k e_k
//! disc      z = (b_1.., s),         w as of a cone, x_n of another block
//! ```
//! `x` scaled impulses, `u` scaled rates, `e_k` directions across the normal and against each other, `s`
//! the speed of sliding: in the plane that is Coulomb's law itself, in space a pyramid in the place of
//! its cone, from which Newton's method finds the cone's impulses. Each pivot takes a variable into the
//! basis whose partner has just left it, so that no set comes twice; with masses that are positive it ends
//! at an answer, or along a ray where there is none, as when something is crushed. Source: Lemke 1965;
//! Stewart and Trinkle 1996, Anitescu and Potra 1997 (contact with friction).

use crate::coupled::reduced_rows::ReducedRows;
use crate::coupled::row_laws::BlockLaw;

/// Pivots, as multiples of the variables, after which it is given up.
const PIVOTS: usize = 10;
/// Entries of a unit problem that are no pivots, and ratios that are the same.
const PIVOT: f64 = 1e-11;
const SAME: f64 = 1e-13;
/// What may be left of the additional variable, of a right side of 1.
const NEARLY: f64 = 1e-10;
/// The golden ratio less one: its multiples keep apart.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// What the additional variable takes part with in each row, `e`: 1 to 2, and nowhere twice the same. Of corners that
/// lie on one plane many would block together else, and rounding would choose among them.
fn cover(place: usize) -> f64 {
    1.0 + (GOLDEN * (place + 1) as f64).fract()
}

/// What a variable is.
#[derive(Clone, Copy, Debug)]
enum Variable {
    /// A part of a row's impulse, with its sign.
    Impulse(usize, f64),
    /// Of a cone or a bound, the speed of sliding.
    Sliding,
}

/// The memory of the pivots.
#[derive(Debug, Default)]
pub(crate) struct Lemke {
    variables: Vec<Variable>,
    /// A row of each variable in the basis: a column of each of those outside, which are `outside`, and the right side.
    tableau: Vec<f64>,
    pivot: Vec<f64>,
    /// Variables by number: m of z, as many of w, z_0.
    basis: Vec<usize>,
    outside: Vec<usize>,
}

impl Lemke {
    /// Writes impulses that meet the laws; says whether there were any.
    pub(crate) fn pivot(&mut self, rows: &mut ReducedRows) -> bool {
        self.list(rows);
        let largest = self.start(rows);
        let ReducedRows { laws, starts, free, scale, x, .. } = rows;
        x.clear();
        x.resize(free.len(), 0.0);
        let m = self.variables.len();
        if largest > 0.0 && !self.run(m) {
            return false;
        }
        let width = m + 2;
        for (place, &variable) in self.basis.iter().enumerate() {
            if let Some(&Variable::Impulse(row, sign)) = self.variables.get(variable) {
                x[row] += sign * largest * self.tableau[width * place + width - 1] * scale[row];
            }
        }
        for (law, starts) in laws.iter().zip(starts.windows(2)) {
            if let BlockLaw::Bounded(bound) = law {
                x[starts[0]] -= bound;
            }
        }
        x.iter().all(|x| x.is_finite())
    }

    /// The variables of each block, the speed last.
    fn list(&mut self, rows: &ReducedRows) {
        self.variables.clear();
        for (law, starts) in rows.laws.iter().zip(rows.starts.windows(2)) {
            let (first, end) = (starts[0], starts[1]);
            if law.normals() > 0 {
                self.variables.push(Variable::Impulse(first, 1.0));
            }
            match law {
                // What does not rub has no friction to choose.
                BlockLaw::Limit | BlockLaw::Equality | BlockLaw::Cone(0.0) => {}
                BlockLaw::Bounded(_) => self.variables.push(Variable::Sliding),
                BlockLaw::Cone(_) | BlockLaw::Disc { .. } => {
                    for row in first + law.normals()..end {
                        self.variables.push(Variable::Impulse(row, 1.0));
                        self.variables.push(Variable::Impulse(row, -1.0));
                    }
                    self.variables.push(Variable::Sliding);
                }
            }
        }
    }

    /// The tableau before any pivot; says what its right side was divided by.
    fn start(&mut self, rows: &ReducedRows) -> f64 {
        let (m, n) = (self.variables.len(), rows.free.len());
        let width = m + 2;
        self.tableau.clear();
        self.tableau.resize(m * width, 0.0);
        self.basis.clear();
        self.basis.extend(m..2 * m);
        self.outside.clear();
        self.outside.extend((0..m).chain([2 * m]));
        // What bounds, pushed all the way, takes from the rates.
        let shift = |row: usize| -> f64 {
            let bounded = rows.laws.iter().zip(&rows.starts).map(|(law, &of)| match law {
                BlockLaw::Bounded(bound) => rows.compliance[n * row + of] * bound,
                _ => 0.0,
            });
            bounded.sum()
        };
        let mut place = 0;
        for (law, starts) in rows.laws.iter().zip(rows.starts.windows(2)) {
            let begins = place;
            while let Some(&Variable::Impulse(row, sign)) = self.variables.get(place) {
                if row >= starts[1] {
                    break;
                }
                let line = &mut self.tableau[width * place..][..width];
                for (entry, &of) in line.iter_mut().zip(&self.variables) {
                    if let Variable::Impulse(column, other) = of {
                        let w = rows.compliance[n * row + column];
                        *entry = -sign * other * w * rows.scale[row] * rows.scale[column];
                    }
                }
                line[width - 1] = sign * (rows.free[row] - shift(row)) * rows.scale[row];
                place += 1;
            }
            match law {
                BlockLaw::Limit | BlockLaw::Equality | BlockLaw::Cone(0.0) => {}
                BlockLaw::Bounded(bound) => {
                    self.tableau[width * begins + place] = -1.0;
                    self.tableau[width * place + begins] = 1.0;
                    self.tableau[width * place + width - 1] = 2.0 * bound / rows.scale[starts[0]];
                    place += 1;
                }
                BlockLaw::Cone(part) | BlockLaw::Disc { part, .. } => {
                    let mut normal = (starts[0], begins);
                    if let BlockLaw::Disc { normal: row, .. } = *law {
                        let is_it =
                            |of: &Variable| matches!(of, Variable::Impulse(r, _) if *r == row);
                        let Some(place) = self.variables.iter().position(is_it) else { continue };
                        normal = (row, place);
                    }
                    let scale = rows.scale[normal.0];
                    let across = rows.scale.get(starts[0] + law.normals()).copied();
                    let across = across.unwrap_or(scale);
                    self.tableau[width * place + normal.1] = -part * scale / across;
                    for tangent in begins + law.normals()..place {
                        self.tableau[width * tangent + place] = -1.0;
                        self.tableau[width * place + tangent] = 1.0;
                    }
                    place += 1;
                }
            }
        }
        let right = |place: usize| self.tableau[width * place + width - 1];
        let largest = (0..m).map(|place| right(place).abs()).fold(0.0, f64::max);
        for place in 0..m {
            let line = &mut self.tableau[width * place..][..width];
            line[m] = -cover(place);
            if largest > 0.0 {
                line[width - 1] /= largest;
            }
        }
        largest
    }

    /// Pivots until the additional variable has left; says whether it did.
    fn run(&mut self, m: usize) -> bool {
        let (width, additional) = (m + 2, 2 * m);
        let right = |tableau: &[f64], place: usize| tableau[width * place + width - 1];
        let covered = |place: usize| right(&self.tableau, place) / cover(place);
        let lowest = |a: &usize, b: &usize| covered(*a).total_cmp(&covered(*b));
        let Some(mut leaving) = (0..m).min_by(lowest) else { return true };
        if right(&self.tableau, leaving) >= 0.0 {
            return true;
        }
        let mut entering = m;
        for _ in 0..PIVOTS * m {
            self.exchange(leaving, entering, width);
            let left = self.outside[entering];
            if left == additional {
                return true;
            }
            let partner = if left < m { left + m } else { left - m };
            let Some(column) = self.outside.iter().position(|of| *of == partner) else { break };
            entering = column;
            let entry = |place: usize| self.tableau[width * place + entering];
            let ratio = |place: usize| right(&self.tableau, place) / entry(place);
            let open = |place: &usize| entry(*place) > PIVOT;
            let least = (0..m).filter(open).map(ratio).fold(f64::INFINITY, f64::min);
            // Of those that block together the additional variable, else the largest pivot.
            let blocks = (0..m).filter(open).filter(|&place| ratio(place) <= least + SAME);
            let weight = |place: &usize| match self.basis[*place] == additional {
                true => f64::INFINITY,
                false => entry(*place),
            };
            match blocks.max_by(|a, b| weight(a).total_cmp(&weight(b))) {
                Some(place) => leaving = place,
                // What is left may be the rounding of ties.
                None => {
                    let last = self.basis.iter().position(|&variable| variable == additional);
                    return last.is_none_or(|place| right(&self.tableau, place) <= NEARLY);
                }
            }
        }
        false
    }

    /// Takes the variable of a column into the basis, in the place of that of a row.
    fn exchange(&mut self, leaving: usize, entering: usize, width: usize) {
        std::mem::swap(&mut self.basis[leaving], &mut self.outside[entering]);
        let line = &mut self.tableau[width * leaving..][..width];
        let pivot = std::mem::replace(&mut line[entering], 1.0);
        line.iter_mut().for_each(|entry| *entry /= pivot);
        self.pivot.clear();
        self.pivot.extend_from_slice(line);
        for (place, line) in self.tableau.chunks_exact_mut(width).enumerate() {
            let part = line[entering];
            if place != leaving && part != 0.0 {
                line[entering] = 0.0;
                line.iter_mut().zip(&self.pivot).for_each(|(entry, pivot)| *entry -= part * pivot);
            }
        }
    }
}
