//! Multipliers of many equations under masses that do not couple freedoms.
//!
//! ```text
//! S = J M^-1 J^T = sum over freedoms f of  J_f J_f^T / m_f        m x m, sparse, definite
//! ```
//! `J_f` the column of a freedom, `m_f` its mass. Two equations meet in S where they share a
//! freedom: for a chain S has three diagonals, and elimination in the order that is found once
//! leaves it so, hence the work grows with the number of links. Columns of freedoms that the same
//! equations touch (the coordinates of a point) are summed before they go to S.
//!
//! A row of J that vanishes, and a pivot that rounding cannot tell from zero, are errors: that is a
//! ratio of singular values of about 1e-7, the square root of rounding. What is independent by less
//! than that [`Few`](crate::Few) can tell. Where redundant equations are to share their force
//! ([`Redundancy::LeastNorm`]) S is factored with a shift instead, and solved by iteration:
//!
//! ```text
//! T = S + e D^2,   lambda <- lambda + T^-1 S T^-1 (b - S lambda),   e = 1e-8 of a normal row
//! ```
//! `D` the slopes of the equations, and a normal row one of the mechanism that an equation belongs to:
//! those that share no freedom are judged apart. S in the middle takes out what no force feels, so that the least
//! norm in reference scales is reached, to `eps s` of the multipliers: `s` the largest entry of S over e,
//! 1e8 where masses are alike, and more by their ratio. Iterations end where what they take from the
//! residual is its rounding, `eps s` of it: of a right-hand side that contradicts itself, as rounding
//! does, the part that no force feels stays. What is independent by less than a root of e comes slowly,
//! and not at all within the bound is an error.

use stationary_calculus::{
    Covector, Metric, Sink, SparseCholesky, SparseError, SymmetricMatrix, Vector,
};

use crate::entries::Entries;
use crate::multipliers::{DEPENDENT, Diagonal, Normal, check_solve};
use crate::rows::check_entries;
use crate::{Constraint, ConstraintError, Multipliers, Redundancy, Solver};

/// The choice of [`SchurMultipliers`]: many equations, a diagonal metric.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Many(pub Redundancy);

/// Freedoms that the same equations touch.
#[derive(Clone, Copy, Debug)]
struct Group {
    freedoms: usize,
    equations: usize,
}

/// Which entries make S, and in which order.
#[derive(Clone, Debug)]
struct Columns {
    groups: Vec<Group>,
    /// Of each group its equations.
    equations: Vec<usize>,
    /// Of each freedom of each group one over its mass.
    inverse_mass: Vec<f64>,
    /// Of each freedom of each group the entries of its column.
    entries: Vec<u32>,
    block: Vec<f64>,
}

/// Multipliers of many equations, by Cholesky's method.
#[derive(Clone, Debug)]
pub struct SchurMultipliers {
    count: usize,
    prepared: bool,
    entries: Entries,
    columns: Columns,
    /// The smallest diagonal entry of S that is not taken for zero.
    smallest: Vec<f64>,
    matrix: SymmetricMatrix,
    cholesky: SparseCholesky,
    sharing: Option<Sharing>,
}

/// What the iteration for shared forces needs.
#[derive(Clone, Debug)]
struct Sharing {
    /// e D^2.
    shift: Vec<f64>,
    residual: Vec<f64>,
    change: Vec<f64>,
    image: Vec<f64>,
}

impl<C> Solver<C> for Many {
    type Multipliers = SchurMultipliers;

    fn analyse<M: Metric, K: Constraint>(
        &self,
        metric: &M,
        constraint: &K,
        t: f64,
        q: &[f64],
    ) -> Result<SchurMultipliers, ConstraintError> {
        check_entries(constraint, metric.dim(), t, q)?;
        let count = constraint.count();
        let masses = Diagonal::of(metric);
        if let Some(freedom) = masses.coupled {
            return Err(ConstraintError::Coupled { freedom });
        }
        let entries = Entries::find(constraint, t, q)?;
        let mut columns = Columns::of(&entries, &masses.mass);
        let normal = columns.largest_among_linked(Normal::squares(metric, constraint, t, q)?);
        let squares = |part: f64| -> Vec<f64> {
            let square = |row: usize| normal[row] * (part * constraint.scale(row).slope).powi(2);
            (0..count).map(square).collect()
        };
        let sharing = (self.0 == Redundancy::LeastNorm).then(|| Sharing {
            shift: squares(SHIFT),
            residual: vec![0.0; count],
            change: vec![0.0; count],
            image: vec![0.0; count],
        });
        let matrix = SymmetricMatrix::analyse(count, |sink| {
            columns.visit(&entries, sink);
            shift(sharing.as_ref(), sink);
        })?;
        Ok(SchurMultipliers {
            count,
            prepared: false,
            smallest: squares(DEPENDENT),
            sharing,
            cholesky: SparseCholesky::analyse(&matrix)?,
            matrix,
            entries,
            columns,
        })
    }
}

/// The root of e, the part of a normal row that is added where forces are shared.
const SHIFT: f64 = 1e-4;
/// More iterations than this are equations that are independent by too little to tell: at the root of e
/// each leaves three quarters, and 72 a part in 1e9.
const ITERATIONS: u32 = 120;
/// What an iteration takes from the residual is rounding below the first part of the whole, and too
/// much to end with above the second.
const SETTLED: f64 = 1e-15;
const UNSETTLED: f64 = 1e-9;
/// What an iteration takes from a rest that no force feels: so many roundings of it, times the largest
/// entry over the shift.
const NOISE: f64 = 40.0;

/// Adds the shift to the diagonal.
fn shift(sharing: Option<&Sharing>, sink: &mut impl Sink) {
    for (row, shift) in sharing.iter().flat_map(|sharing| &sharing.shift).enumerate() {
        sink.add_symmetric(&[row], &[*shift]);
    }
}

impl Sharing {
    /// Replaces `lambda`, the right-hand side, by the solution of least norm. The factor is that of
    /// the shifted matrix.
    fn solve(
        &mut self,
        matrix: &SymmetricMatrix,
        cholesky: &mut SparseCholesky,
        lambda: &mut [f64],
    ) -> Result<(), ConstraintError> {
        let Sharing { shift, residual, change, image } = self;
        residual.copy_from_slice(lambda);
        lambda.fill(0.0);
        // In reference scales, of which the shift is the square.
        let length = |x: &[f64]| x.iter().zip(&*shift).map(|(x, s)| x * x / s).sum::<f64>().sqrt();
        let whole = length(residual);
        let diagonal = matrix.column_starts().iter().map(|&start| matrix.values()[start as usize]);
        let stiffest =
            diagonal.zip(&*shift).map(|(entry, shift)| entry / shift).fold(0.0, f64::max);
        let noise = NOISE * f64::EPSILON * stiffest;
        let mut before = f64::INFINITY;
        for _ in 0..ITERATIONS {
            image.copy_from_slice(residual);
            cholesky.solve(image);
            unshifted(matrix, shift, image, change)?;
            cholesky.solve(change);
            lambda.iter_mut().zip(&*change).for_each(|(x, z)| *x += z);
            unshifted(matrix, shift, change, image)?;
            residual.iter_mut().zip(&*image).for_each(|(r, y)| *r -= y);
            // What no force feels stays in the residual, and its rounding in every change after.
            let now = length(image);
            let unfelt = now <= UNSETTLED * whole || now <= noise * length(residual);
            if now <= SETTLED * whole || (now > 0.5 * before && unfelt) {
                return Ok(());
            }
            before = now;
        }
        Err(ConstraintError::Dependent { row: None })
    }
}

/// Writes `S x`, given the shifted matrix.
fn unshifted(
    matrix: &SymmetricMatrix,
    shift: &[f64],
    x: &[f64],
    product: &mut [f64],
) -> Result<(), ConstraintError> {
    for ((y, x), shift) in product.iter_mut().zip(x).zip(shift) {
        *y = -shift * x;
    }
    Ok(matrix.add_product(1.0, x, product)?)
}

impl Columns {
    fn of(entries: &Entries, mass: &[f64]) -> Self {
        let mut columns: Vec<Vec<(usize, u32)>> = vec![Vec::new(); mass.len()];
        for (index, &(row, freedom)) in entries.places.iter().enumerate() {
            columns[freedom as usize].push((row as usize, index as u32));
        }
        let mut groups: Vec<Group> = Vec::new();
        let (mut equations, mut inverse_mass): (Vec<usize>, Vec<f64>) = (Vec::new(), Vec::new());
        let mut flat = Vec::new();
        for (column, mass) in columns.iter().zip(mass).filter(|(column, _)| !column.is_empty()) {
            let own = column.iter().map(|&(row, _)| row);
            let same = groups.last().is_some_and(|last: &Group| {
                equations[equations.len() - last.equations..].iter().copied().eq(own.clone())
            });
            match groups.last_mut() {
                Some(last) if same => last.freedoms += 1,
                _ => {
                    groups.push(Group { freedoms: 1, equations: column.len() });
                    equations.extend(own);
                }
            }
            inverse_mass.push(mass.recip());
            flat.extend(column.iter().map(|&(_, entry)| entry));
        }
        let most = groups.iter().map(|group| group.equations).max().unwrap_or(0);
        Columns { groups, equations, inverse_mass, entries: flat, block: vec![0.0; most * most] }
    }

    /// The largest of the numbers among all equations that an equation is linked to by freedoms, itself
    /// included. Mechanisms that have nothing to do with each other are judged by their own masses.
    fn largest_among_linked(&self, numbers: Vec<f64>) -> Vec<f64> {
        let mut first: Vec<usize> = (0..numbers.len()).collect();
        fn root(first: &mut [usize], mut row: usize) -> usize {
            while first[row] != row {
                first[row] = first[first[row]];
                row = first[row];
            }
            row
        }
        let mut rest = &self.equations[..];
        for group in &self.groups {
            let (own, others) = rest.split_at(group.equations);
            for &row in own {
                let (a, b) = (root(&mut first, own[0]), root(&mut first, row));
                first[a.max(b)] = a.min(b);
            }
            rest = others;
        }
        let mut largest = vec![0.0_f64; numbers.len()];
        for (row, number) in numbers.iter().enumerate() {
            let root = root(&mut first, row);
            largest[root] = largest[root].max(*number);
        }
        (0..numbers.len()).map(|row| largest[root(&mut first, row)]).collect()
    }

    /// Brings the blocks of S.
    #[inline]
    fn visit(&mut self, entries: &Entries, sink: &mut impl Sink) {
        let (mut equations, mut inverse_mass) = (&self.equations[..], &self.inverse_mass[..]);
        let mut rest = &self.entries[..];
        for &Group { freedoms, equations: k } in &self.groups {
            let block = &mut self.block[..k * k];
            block.fill(0.0);
            for &w in &inverse_mass[..freedoms] {
                let column = &rest[..k];
                for (b, &j) in column.iter().enumerate() {
                    let scaled = w * entries.values[j as usize];
                    for (a, &i) in column.iter().enumerate() {
                        block[a + k * b] += scaled * entries.values[i as usize];
                    }
                }
                rest = &rest[k..];
            }
            sink.add_symmetric(&equations[..k], block);
            (equations, inverse_mass) = (&equations[k..], &inverse_mass[freedoms..]);
        }
    }
}

impl SchurMultipliers {
    /// How many numbers the factor of S has.
    pub fn factor_len(&self) -> usize {
        self.cholesky.factor_len()
    }

    /// An error where an equation has lost its differential.
    fn check_rows(&self) -> Result<(), ConstraintError> {
        let starts = &self.matrix.column_starts()[..self.count];
        for (row, (&start, smallest)) in starts.iter().zip(&self.smallest).enumerate() {
            let shift = self.sharing.as_ref().map_or(0.0, |sharing| sharing.shift[row]);
            let diagonal = self.matrix.values()[start as usize] - shift;
            if diagonal < *smallest {
                let ratio = DEPENDENT * (diagonal / smallest).sqrt();
                return Err(ConstraintError::Singular { ratio, row });
            }
        }
        Ok(())
    }
}

impl Multipliers for SchurMultipliers {
    type Numbers = Vec<f64>;

    fn numbers(&self) -> Vec<f64> {
        vec![0.0; self.count]
    }

    fn prepare(
        &mut self,
        _: &impl Metric,
        constraint: &impl Constraint,
        t: f64,
        q: &[f64],
    ) -> Result<(), ConstraintError> {
        self.prepared = false;
        self.entries.write(constraint, t, q)?;
        let SchurMultipliers { entries, columns, matrix, sharing, .. } = self;
        matrix.refill(|sink| {
            columns.visit(entries, sink);
            shift(sharing.as_ref(), sink);
        })?;
        self.check_rows()?;
        self.cholesky.factor(&self.matrix).map_err(|error| match error {
            SparseError::NotPositiveDefinite { freedom } => {
                ConstraintError::Dependent { row: Some(freedom) }
            }
            other => other.into(),
        })?;
        self.prepared = true;
        Ok(())
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), ConstraintError> {
        check_solve(self.prepared, self.count, b)?;
        match &mut self.sharing {
            Some(sharing) => sharing.solve(&self.matrix, &mut self.cholesky, b),
            None => {
                self.cholesky.solve(b);
                Ok(())
            }
        }
    }

    fn add_pulled_back(&self, scale: f64, lambda: &[f64], p: Covector<&mut [f64]>) {
        self.entries.add_pulled_back(scale, lambda, p);
    }

    fn add_along(&self, v: Vector<&[f64]>, rates: &mut [f64]) {
        self.entries.add_along(v, rates);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Rod, Rods};
    use nalgebra::{DMatrix, DVector};
    use stationary_calculus::DiagonalMetric;

    /// A square with both diagonals, of which one rod is too many, and double pendulums beside it.
    fn square_and_pendulums(pendulums: usize) -> (Rods<2>, Vec<f64>) {
        let free = 4 + 2 * pendulums;
        let mut q = vec![0.0, 0.0, 1.1, 0.1, 1.2, 0.9, -0.1, 1.0];
        let length = |q: &[f64], [a, b]: [usize; 2]| {
            (q[2 * b] - q[2 * a]).hypot(q[2 * b + 1] - q[2 * a + 1])
        };
        let pairs = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2], [1, 3]];
        let mut rods: Vec<Rod> = pairs.map(|ends| Rod::new(ends, length(&q, ends))).into();
        for k in 0..pendulums {
            let (first, angle) = (4 + 2 * k, 0.3 * k as f64);
            let (sine, cosine) = angle.sin_cos();
            q.extend([sine, -cosine, sine + 0.7 * cosine, -cosine + 0.7 * sine]);
            rods.extend([Rod::new([free, first], 1.0), Rod::new([first, first + 1], 0.7)]);
        }
        (Rods::new(free, vec![[0.0; 2]], rods).unwrap(), q)
    }

    /// J in reference scales, masses taken out: `D^-1 J M^-1/2`.
    fn scaled(rods: &Rods<2>, q: &[f64], mass: &[f64]) -> DMatrix<f64> {
        struct Full(DMatrix<f64>);
        impl crate::Rows for Full {
            fn add(&mut self, row: usize, freedom: usize, value: f64) {
                self.0[(row, freedom)] = value;
            }
        }
        let mut full = Full(DMatrix::zeros(rods.count(), q.len()));
        rods.differential(0.0, q, &mut full).unwrap();
        let scale = |i: usize, f: usize| rods.scale(i).slope * mass[f].sqrt();
        DMatrix::from_fn(rods.count(), q.len(), |i, f| full.0[(i, f)] / scale(i, f))
    }

    #[test]
    fn sharing_tells_independence_of_a_ten_thousandth_and_gives_up_before_it_takes_it_for_none() {
        let metric = DiagonalMetric::new(vec![1.0; 2]).unwrap();
        // Two lines that meet at an angle: the ratio of singular values is half of it.
        for (angle, told) in
            [(1e-3, Some(1e3)), (2.1e-4, Some(1.0 / 2.1e-4)), (2e-5, None), (1e-6, Some(0.0))]
        {
            let lines = crate::Linear::new(vec![
                (vec![(0, 1.0), (1, 0.0)], 0.0),
                (vec![(0, 1.0), (1, angle)], 0.0),
            ]);
            let (lines, q) = (lines.unwrap(), vec![0.0; 2]);
            let choice = Many(Redundancy::LeastNorm);
            let mut many = Solver::<Vec<f64>>::analyse(&choice, &metric, &lines, 0.0, &q).unwrap();
            many.prepare(&metric, &lines, 0.0, &q).unwrap();
            let mut lambda = [0.0, angle];
            let solved = many.solve(&mut lambda);
            assert_eq!(solved.is_ok(), told.is_some(), "{angle}: {solved:?}");
            if let Some(told) = told {
                // Against 1 / angle, which keeps both lines.
                let off = (lambda[1] - told).abs();
                assert!(off < 1e-3 * told + 1e-7 / angle, "{angle}: {lambda:?}");
            }
        }
    }

    #[test]
    fn a_heavy_pendulum_beside_light_rods_is_not_taken_for_dependent() {
        let (rods, q) = square_and_pendulums(10);
        let mass: Vec<f64> = (0..q.len()).map(|f| if f < 8 { 1e-6 } else { 1e6 }).collect();
        let metric = DiagonalMetric::new(mass.clone()).unwrap();
        let choice = Many(Redundancy::LeastNorm);
        let mut many = Solver::<Vec<f64>>::analyse(&choice, &metric, &rods, 0.0, &q).unwrap();
        many.prepare(&metric, &rods, 0.0, &q).unwrap();
        let push = DVector::from_fn(q.len(), |f, _| (1.0 + f as f64).sin());
        let b = scaled(&rods, &q, &mass) * push;
        let mut lambda: Vec<f64> = (0..b.len()).map(|i| b[i] * rods.scale(i).slope).collect();
        many.solve(&mut lambda).unwrap();
    }

    #[test]
    fn many_redundant_equations_share_by_least_norm_though_the_right_hand_side_contradicts_itself()
    {
        let (rods, q) = square_and_pendulums(10);
        let (n, m) = (q.len(), rods.count());
        assert!(m > 24);
        for (light, push, apart) in [
            (1.0, 1.0, 0.0),
            (1.0, 1.0, 1e-8),
            (1.0, 1.0, 1.0),
            (1.0, 0.0, 1.0),
            (1e-2, 1.0, 1.0),
            (1e-4, 1.0, 1.0),
            (1e-6, 1e-8, 1.0),
        ] {
            // One point of the square is light, and the first of each pendulum.
            let is_light = |point: usize| point == 0 || (point > 3 && point.is_multiple_of(2));
            let mass: Vec<f64> =
                (0..n).map(|f| if is_light(f / 2) { light } else { 1.0 }).collect();
            let j = scaled(&rods, &q, &mass);
            let svd = j.clone().svd(true, false);
            let (u, sigma) = (svd.u.unwrap(), svd.singular_values);
            let unfelt = sigma.imin();
            assert!(sigma[unfelt] < 1e-12 * sigma.max());
            let pushed = DVector::from_fn(n, |f, _| push * (1.0 + f as f64).sin());
            let b = &j * pushed + u.column(unfelt) * apart;
            let mut expected = DVector::zeros(m);
            for k in (0..m).filter(|&k| k != unfelt) {
                expected += u.column(k) * (u.column(k).dot(&b) / sigma[k].powi(2));
            }

            let metric = DiagonalMetric::new(mass).unwrap();
            let choice = Many(Redundancy::LeastNorm);
            let mut many = Solver::<Vec<f64>>::analyse(&choice, &metric, &rods, 0.0, &q).unwrap();
            many.prepare(&metric, &rods, 0.0, &q).unwrap();
            let slope = |row: usize| rods.scale(row).slope;
            let mut lambda: Vec<f64> = (0..m).map(|row| b[row] * slope(row)).collect();
            many.solve(&mut lambda).unwrap();

            let off = (0..m).map(|row| (lambda[row] * slope(row) - expected[row]).abs());
            let rounding = f64::EPSILON * 2.0 / (light * SHIFT * SHIFT);
            let allowed = rounding * (4.0 * expected.amax() + 10.0 * apart / (SHIFT * SHIFT));
            let off = off.fold(0.0, f64::max);
            assert!(off < allowed, "masses {light}, apart {apart}: {off:e} > {allowed:e}");
        }
    }
}
