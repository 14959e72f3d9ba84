//! Rows: what is asked of a velocity along some directions, and which impulses may bring it about.
//!
//! ```text
//! u_i = J_i v - w_i       what a velocity v (n) lacks of what row i asks for
//!
//! law          impulses                     what goes with them
//! equality     lambda                       u = 0
//! limit        lambda >= 0                  u >= 0,  lambda u = 0
//! bounded      |lambda| <= b                u = 0 inside, u opposes lambda at the bound
//! cone         |lambda_t| <= mu lambda_n    u_n >= 0,  lambda_n u_n = 0,  u_t opposes lambda_t at the bound
//! ```
//! `J_i` a covector with a few entries, `w_i` in m/s or rad/s, impulses in N s or N m s; they act as
//! `p += J^T lambda`. A block is one row, and for a cone its normal row and then the tangential ones.
//! A limit is what a gap of `g` becomes in a step of h, `w = -g/h`; a bound that of friction in a
//! joint or of a motor, whose `w` is its speed; a cone that of a contact.
//!
//! Who makes rows does not know who solves them: any [`Constraint`] is a list of equalities. Equalities
//! alone are [`SparseDiagonal`](crate::SparseDiagonal)'s; whoever solves the others measures by
//! [`RowLaw::nearest`] how far impulses are from admissible. Source: Moreau (1988), Unilateral contact
//! and dry friction, for the laws as projections.

use stationary_calculus::{Covector, SizeError, Vector};

use crate::{Constraint, ConstraintError, Rows};

/// Which impulses a block of rows may give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RowLaw {
    /// Any impulse.
    Equality,
    /// It pushes and never pulls.
    Limit,
    /// At most this much, either way, N s.
    Bounded(f64),
    /// It pushes along the normal, and along the tangents at most this friction coefficient times as
    /// much.
    Cone(f64),
}

impl RowLaw {
    /// Moves the impulses of a block to the nearest admissible ones.
    pub fn nearest(self, lambda: &mut [f64]) {
        match self {
            RowLaw::Equality => {}
            RowLaw::Limit => lambda.iter_mut().for_each(|lambda| *lambda = lambda.max(0.0)),
            RowLaw::Bounded(b) => {
                lambda.iter_mut().for_each(|lambda| *lambda = lambda.max(-b).min(b))
            }
            RowLaw::Cone(friction) => {
                let [normal, tangents @ ..] = lambda else { return };
                let tangential = tangents.iter().fold(0.0_f64, |sum, t| sum.hypot(*t));
                if *normal >= 0.0 && tangential <= friction * *normal {
                    return;
                }
                // On the cone's side, or at its tip where the polar cone is nearer.
                // In units of the longer of 1 and the coefficient: its square may be too large for a number.
                let unit = friction.max(1.0);
                let (height, slope) = (unit.recip(), friction / unit);
                let along = (*normal * height + slope * tangential).max(0.0)
                    / (height * height + slope * slope);
                *normal = height * along;
                // What pulls straight away has no tangents to shorten.
                let share = if tangential > 0.0 { slope * along / tangential } else { 0.0 };
                tangents.iter_mut().for_each(|t| *t *= share);
            }
        }
    }

    fn check(self, block: usize, rows: usize) -> Result<(), ConstraintError> {
        let (what, value) = match self {
            RowLaw::Equality | RowLaw::Limit if rows == 1 => return Ok(()),
            RowLaw::Bounded(bound) if rows == 1 => ("bound of an impulse", bound),
            RowLaw::Cone(friction) if (1..=3).contains(&rows) => ("friction coefficient", friction),
            _ => return Err(ConstraintError::Block { block, rows }),
        };
        if value >= 0.0 && value.is_finite() {
            return Ok(());
        }
        Err(ConstraintError::Parameter { what, value, range: "at least zero and finite" })
    }
}

/// Blocks of rows, one after another.
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityRows {
    laws: Vec<RowLaw>,
    /// Where the rows of each block start, and the entries of each row.
    blocks: Vec<usize>,
    starts: Vec<usize>,
    entries: Vec<(usize, f64)>,
    asked: Vec<f64>,
}

impl Default for VelocityRows {
    fn default() -> Self {
        let (laws, entries, asked) = (Vec::new(), Vec::new(), Vec::new());
        VelocityRows { laws, blocks: vec![0], starts: vec![0], entries, asked }
    }
}

impl VelocityRows {
    /// Forgets all rows and keeps the memory.
    pub fn clear(&mut self) {
        self.laws.clear();
        self.blocks.truncate(1);
        self.starts.truncate(1);
        self.entries.clear();
        self.asked.clear();
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.asked.len()
    }

    /// The blocks: the law of each and its rows.
    pub fn blocks(&self) -> impl Iterator<Item = (RowLaw, std::ops::Range<usize>)> + '_ {
        self.laws.iter().zip(self.blocks.windows(2)).map(|(law, rows)| (*law, rows[0]..rows[1]))
    }

    /// Appends a block: of each row its entries (freedom, coefficient) and the velocity it asks for.
    ///
    /// # Errors
    /// [`ConstraintError::Block`] for a number of rows that the law does not have;
    /// [`ConstraintError::Parameter`] for a bound or a friction coefficient that is negative or not
    /// finite; [`ConstraintError::NonFinite`] names a row whose numbers are not finite. The rows are then
    /// as they were.
    pub fn push(
        &mut self,
        law: RowLaw,
        block: &[(&[(usize, f64)], f64)],
    ) -> Result<(), ConstraintError> {
        law.check(self.laws.len(), block.len())?;
        for (index, (entries, asked)) in block.iter().enumerate() {
            if !asked.is_finite() || entries.iter().any(|entry| !entry.1.is_finite()) {
                let index = self.rows() + index;
                return Err(ConstraintError::NonFinite { what: "row", index });
            }
        }
        for (entries, asked) in block {
            self.entries.extend_from_slice(entries);
            self.starts.push(self.entries.len());
            self.asked.push(*asked);
        }
        self.laws.push(law);
        self.blocks.push(self.rows());
        Ok(())
    }

    /// Appends what a constraint asks of a velocity at `(t, q)`, `J v = -dg/dt`, as equalities.
    ///
    /// # Errors
    /// A configuration with fewer numbers than the constraint reads;
    /// [`ConstraintError::PatternChanged`] for one that does not bring its entries row after row;
    /// [`ConstraintError::NonFinite`] for numbers that are not finite. The rows are then as they were.
    pub fn push_constraint(
        &mut self,
        constraint: &impl Constraint,
        t: f64,
        q: &[f64],
    ) -> Result<(), ConstraintError> {
        self.push_equalities(constraint, t, q, Constraint::rate)
    }

    /// Appends what closes a constraint that is open at `(t, q)`, `J d = -g`, as equalities of a motion.
    ///
    /// # Errors
    /// Those of [`VelocityRows::push_constraint`].
    pub fn push_closing(
        &mut self,
        constraint: &impl Constraint,
        t: f64,
        q: &[f64],
    ) -> Result<(), ConstraintError> {
        self.push_equalities(constraint, t, q, Constraint::value)
    }

    /// Appends the blocks of other rows, with what they ask for.
    pub fn extend(&mut self, more: &VelocityRows) {
        self.extend_in_units(more, |_| 1.0);
    }

    /// Appends the blocks of other rows, those of a block multiplied by what is said of its first row, finite and
    /// above zero: `s u` and `s w`, with the impulse and its bound divided by `s`.
    pub fn extend_in_units(&mut self, more: &VelocityRows, scale: impl Fn(usize) -> f64) {
        let (rows, entries) = (self.rows(), self.entries.len());
        self.blocks.extend(more.blocks[1..].iter().map(|end| rows + end));
        self.starts.extend(more.starts[1..].iter().map(|end| entries + end));
        for (law, block) in more.blocks() {
            let scale = scale(block.start);
            self.laws.push(match law {
                RowLaw::Bounded(bound) => RowLaw::Bounded(bound / scale),
                _ => law,
            });
            for row in block {
                self.entries.extend(more.row(row).map(|(freedom, value)| (freedom, scale * value)));
                self.asked.push(scale * more.asked(row));
            }
        }
    }

    /// Appends the rows of a constraint, which ask for these numbers with their signs turned.
    fn push_equalities<K: Constraint>(
        &mut self,
        constraint: &K,
        t: f64,
        q: &[f64],
        numbers: Numbers<K>,
    ) -> Result<(), ConstraintError> {
        let (before, entries) = (self.rows(), self.entries.len());
        let pushed = self.append(constraint, t, q, numbers);
        if pushed.is_err() {
            self.asked.truncate(before);
            self.starts.truncate(before + 1);
            self.entries.truncate(entries);
        }
        pushed
    }

    fn append<K: Constraint>(
        &mut self,
        constraint: &K,
        t: f64,
        q: &[f64],
        numbers: Numbers<K>,
    ) -> Result<(), ConstraintError> {
        let (before, count) = (self.rows(), constraint.count());
        self.asked.resize(before + count, 0.0);
        numbers(constraint, t, q, &mut self.asked[before..])?;
        self.asked[before..].iter_mut().for_each(|w| *w = -*w);
        let mut append = Append { rows: self, before, disorder: None };
        constraint.differential(t, q, &mut append)?;
        if let Some(entry) = append.disorder {
            return Err(ConstraintError::PatternChanged { entry });
        }
        self.starts.resize(before + count + 1, self.entries.len());
        let finite =
            |row: &usize| self.asked[*row].is_finite() && self.row(*row).all(|e| e.1.is_finite());
        if let Some(index) = (before..before + count).find(|row| !finite(row)) {
            return Err(ConstraintError::NonFinite { what: "row", index });
        }
        self.laws.resize(self.laws.len() + count, RowLaw::Equality);
        self.blocks.extend(before + 1..=before + count);
        Ok(())
    }

    /// The entries of a row.
    #[inline]
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.entries[self.starts[row]..self.starts[row + 1]].iter().copied()
    }

    /// The velocity that a row asks for.
    pub fn asked(&self, row: usize) -> f64 {
        self.asked[row]
    }

    /// What a velocity lacks of what a row asks for: `J_i v - w_i`.
    #[inline]
    pub fn lack(&self, row: usize, v: Vector<&[f64]>) -> f64 {
        self.row(row).map(|(freedom, value)| value * v.0[freedom]).sum::<f64>() - self.asked[row]
    }

    /// Adds the impulse of a row to a momentum: `p += lambda J_i`.
    #[inline]
    pub fn add_impulse(&self, row: usize, lambda: f64, p: Covector<&mut [f64]>) {
        self.row(row).for_each(|(freedom, value)| p.0[freedom] += lambda * value);
    }

    /// An error unless every row names freedoms of a system that has so many.
    ///
    /// # Errors
    /// The first freedom that there is not.
    pub fn check(&self, freedoms: usize) -> Result<(), ConstraintError> {
        let needed =
            self.entries.iter().map(|entry| entry.0).max().map_or(0, |f| f.saturating_add(1));
        if needed <= freedoms {
            Ok(())
        } else {
            Err(ConstraintError::Freedoms { needed, freedoms })
        }
    }
}

/// Writes a number for each equation of a constraint.
type Numbers<K> = fn(&K, f64, &[f64], &mut [f64]) -> Result<(), SizeError>;

/// Takes a constraint's differential behind the rows that there are.
struct Append<'a> {
    rows: &'a mut VelocityRows,
    before: usize,
    disorder: Option<usize>,
}

impl Rows for Append<'_> {
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        let VelocityRows { starts, entries, asked, .. } = &mut *self.rows;
        let row = self.before + row;
        if row + 1 < starts.len() || row >= asked.len() {
            self.disorder.get_or_insert(entries.len());
            return;
        }
        starts.resize(row + 1, entries.len());
        entries.push((freedom, value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FixedPoint, Rod, Rods};

    #[test]
    fn the_nearest_impulses_are_admissible_and_no_admissible_ones_are_nearer() {
        let laws = [RowLaw::Equality, RowLaw::Limit, RowLaw::Bounded(0.7), RowLaw::Cone(0.5)];
        let mut noise = stationary_measure::SplitMix64::new(5);
        for law in laws {
            let rows = if matches!(law, RowLaw::Cone(_)) { 3 } else { 1 };
            for _ in 0..300 {
                let mut draw = || (0..rows).map(|_| 2.0 * noise.symmetric()).collect::<Vec<f64>>();
                let (given, mut other) = (draw(), draw());
                let mut nearest = given.clone();
                law.nearest(&mut nearest);
                law.nearest(&mut other);
                let mut again = nearest.clone();
                law.nearest(&mut again);
                let apart = |a: &[f64], b: &[f64]| -> f64 {
                    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
                };
                assert!(apart(&again, &nearest) < 1e-30, "{law:?} {nearest:?}");
                // The set is convex: nothing of it lies on the side of what was given.
                let inner: f64 =
                    (0..rows).map(|i| (given[i] - nearest[i]) * (other[i] - nearest[i])).sum();
                assert!(inner < 1e-14, "{law:?} {given:?} {other:?}");
            }
        }
    }

    #[test]
    fn what_pulls_straight_away_from_a_cone_is_moved_to_its_tip() {
        for friction in [0.0, 0.5] {
            for rows in 1..=3 {
                let mut lambda = vec![0.0; rows];
                lambda[0] = -1.0;
                RowLaw::Cone(friction).nearest(&mut lambda);
                assert_eq!(lambda, vec![0.0; rows], "{friction}");
            }
        }
    }

    #[test]
    fn a_cone_of_any_friction_coefficient_has_a_nearest_impulse() {
        for friction in [1e100, 1e160, f64::MAX] {
            // All but straight along the tangents, whatever pulls.
            let mut lambda = [-3.0, 4.0, -3.0];
            RowLaw::Cone(friction).nearest(&mut lambda);
            let [normal, tangents @ ..] = lambda;
            assert!((normal * friction / 5.0 - 1.0).abs() < 1e-14, "{friction:e}: {lambda:?}");
            assert!((tangents[0] - 4.0).abs() < 1e-14 && (tangents[1] + 3.0).abs() < 1e-14);
        }
    }

    #[test]
    fn rows_behind_others_stay_what_they_are() {
        let mut first = VelocityRows::default();
        first.push(RowLaw::Limit, &[(&[(3, 2.0)], -0.5)]).unwrap();
        let rods = Rods::new(2, Vec::<[f64; 2]>::new(), vec![Rod::new([0, 1], 1.0)]).unwrap();
        let q = [0.0, 0.0, 3.0, 4.0];
        first.push_closing(&rods, 0.0, &q).unwrap();
        let mut value = [0.0];
        rods.value(0.0, &q, &mut value).unwrap();
        assert_eq!(first.asked(1), -value[0]);
        assert!(first.push_closing(&rods, 0.0, &[0.0, f64::NAN, 3.0, 4.0]).is_err());
        let mut both = VelocityRows::default();
        both.push(RowLaw::Cone(0.5), &[(&[(0, 1.0)], 0.1), (&[(1, 1.0), (2, -1.0)], 0.0)]).unwrap();
        let before = both.clone();
        both.extend(&first);
        assert_eq!((both.rows(), both.blocks().count()), (4, 3));
        for row in 0..2 {
            assert!(both.row(row).eq(before.row(row)) && both.asked(row) == before.asked(row));
            assert!(
                both.row(2 + row).eq(first.row(row)) && both.asked(2 + row) == first.asked(row)
            );
        }
        let laws: Vec<_> = both.blocks().collect();
        assert_eq!(laws[1..], [(RowLaw::Limit, 2..3), (RowLaw::Equality, 3..4)]);
    }

    #[test]
    fn a_bound_is_that_of_the_impulse_in_the_units_of_its_row() {
        let mut rows = VelocityRows::default();
        rows.push(RowLaw::Bounded(3.0), &[(&[(0, 1.0)], 0.5)]).unwrap();
        rows.push(RowLaw::Cone(0.5), &[(&[(1, 1.0)], 0.1), (&[(2, -1.0)], 0.0)]).unwrap();
        let mut doubled = VelocityRows::default();
        doubled.extend_in_units(&rows, |row| if row == 0 { 2.0 } else { 4.0 });
        let mut expected = VelocityRows::default();
        expected.push(RowLaw::Bounded(1.5), &[(&[(0, 2.0)], 1.0)]).unwrap();
        expected.push(RowLaw::Cone(0.5), &[(&[(1, 4.0)], 0.4), (&[(2, -4.0)], 0.0)]).unwrap();
        assert_eq!(doubled, expected);
    }

    #[test]
    fn a_constraint_is_a_list_of_equalities() {
        let rods = vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 2.0)];
        let rods = Rods::new(2, vec![[0.0; 2]], rods).unwrap();
        let set = (rods, FixedPoint::<2>::new(1, [0.3, 0.4]).unwrap());
        let (q, v) = ([0.6, -0.8, 1.6, 0.7], [0.2, -0.1, 0.5, 0.9]);
        let mut rows = VelocityRows::default();
        rows.push(RowLaw::Limit, &[(&[(3, 2.0)], -0.5)]).unwrap();
        rows.push_constraint(&set, 0.0, &q).unwrap();
        assert_eq!((rows.rows(), rows.blocks().count()), (5, 5));
        assert!(
            rows.blocks().skip(1).all(|(law, rows)| law == RowLaw::Equality && rows.len() == 1)
        );
        assert_eq!(rows.lack(0, Vector(&v)), 2.0 * 0.9 + 0.5);
        // The rate of each value by differences along the velocity.
        let value = |s: f64| {
            let moved: Vec<f64> = q.iter().zip(&v).map(|(q, v)| q + s * v).collect();
            let mut g = [0.0; 4];
            set.value(0.0, &moved, &mut g).unwrap();
            g
        };
        let (ahead, back) = (value(1e-5), value(-1e-5));
        for row in 0..4 {
            let rate = (ahead[row] - back[row]) / 2e-5;
            assert!((rows.lack(row + 1, Vector(&v)) - rate).abs() < 1e-9);
        }
        // What is short of numbers leaves the rows as they were.
        let copy = rows.clone();
        assert!(rows.push_constraint(&set, 0.0, &q[..3]).is_err());
        assert_eq!(rows, copy);
        assert!(rows.push_constraint(&set, 0.0, &[f64::NAN; 4]).is_err());
        assert_eq!(rows, copy);
        assert!(rows.check(4).is_ok() && rows.check(3).is_err());
    }

    #[test]
    fn blocks_that_are_none_are_refused() {
        let mut rows = VelocityRows::default();
        let one: (&[(usize, f64)], f64) = (&[(0, 1.0)], 0.0);
        for law in [RowLaw::Bounded(f64::NAN), RowLaw::Cone(-0.1), RowLaw::Bounded(f64::INFINITY)] {
            assert!(matches!(rows.push(law, &[one]), Err(ConstraintError::Parameter { .. })));
        }
        for (law, block) in [(RowLaw::Limit, &[one, one][..]), (RowLaw::Cone(0.5), &[])] {
            assert!(matches!(rows.push(law, block), Err(ConstraintError::Block { block: 0, .. })));
        }
        let bad: (&[(usize, f64)], f64) = (&[(0, f64::NAN)], 0.0);
        assert!(matches!(rows.push(RowLaw::Limit, &[bad]), Err(ConstraintError::NonFinite { .. })));
        assert_eq!(rows, VelocityRows::default());
    }
}
