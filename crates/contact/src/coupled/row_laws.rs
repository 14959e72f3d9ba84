//! Rows of all laws that answer to one another, and how far impulses are from meeting them.
//!
//! ```text
//! u = W x + o                                            W = J M^-1 J^T, o = J v - w
//! equality    u = 0
//! limit       x <= u/d  open, x = 0            x > u/d   pushes, u = 0
//! bounded     |x - u/d| <= b  holds, u = 0     else      x = b sign(x - u/d)
//! cone        its normal as a limit; where it pushes, with z = x_t - u_t/d
//!             |z| <= mu x_n  sticks, u_t = 0   else      slides, x_t = mu x_n z/|z|
//! moment      of a cone, as its tangents: |z| <= r x_n, z = x - u/d
//! left = max_i |x_i - nearest(x_i - u_i/d_i)| d_i                                      m/s
//! ```
//! `x` impulses (N s), `u` what velocities lack (m/s), `d` the diagonal of `W` (1/kg), across a cone and of a moment
//! the largest eigenvalue of their block; moments and spins as forces and speeds at the end of a length.

use std::ops::Range;

use stationary_constraints::RowLaw;

/// Which impulses a block of rows may give: the laws of rows, and a disc that grows with the impulse of another block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum BlockLaw {
    Equality,
    Limit,
    Bounded(f64),
    Cone(f64),
    /// In the disc whose radius is so many times the impulse of a row: the normal of a cone.
    #[cfg_attr(not(any(feature = "2d", feature = "3d")), expect(dead_code))]
    Disc {
        normal: usize,
        part: f64,
    },
}

impl From<RowLaw> for BlockLaw {
    fn from(law: RowLaw) -> Self {
        match law {
            RowLaw::Equality => BlockLaw::Equality,
            RowLaw::Limit => BlockLaw::Limit,
            RowLaw::Bounded(bound) => BlockLaw::Bounded(bound),
            RowLaw::Cone(friction) => BlockLaw::Cone(friction),
        }
    }
}

impl BlockLaw {
    /// How many of its rows are no friction.
    pub(crate) fn normals(self) -> usize {
        usize::from(!matches!(self, BlockLaw::Disc { .. }))
    }

    /// How far the friction of a block that begins with a row may go.
    pub(crate) fn radius(self, x: &[f64], first: usize) -> f64 {
        match self {
            BlockLaw::Cone(friction) => friction * x[first],
            BlockLaw::Disc { normal, part } => part * x[normal],
            _ => 0.0,
        }
    }
}

/// Rows in blocks, and the compliance between each two.
#[derive(Debug, Default)]
pub(crate) struct RowLaws {
    pub(crate) laws: Vec<BlockLaw>,
    /// Where the rows of each block start, and the end of all.
    pub(crate) starts: Vec<usize>,
    /// The compliance between each two rows, 1/kg, and the rates before any impulse, m/s.
    pub(crate) compliance: Vec<f64>,
    pub(crate) free: Vec<f64>,
    /// The own compliance of each row, of tangents the largest of their block, and what makes an
    /// impulse one of a unit compliance.
    pub(crate) own: Vec<f64>,
    pub(crate) scale: Vec<f64>,
    /// The rates of the impulses that were looked at last.
    pub(crate) rates: Vec<f64>,
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

impl RowLaws {
    /// Forgets all rows.
    pub(crate) fn clear(&mut self) {
        self.laws.clear();
        self.starts.clear();
        self.starts.push(0);
        self.free.clear();
    }

    /// Appends a block, by the rates of its rows before any impulse.
    pub(crate) fn push(&mut self, law: BlockLaw, free: impl IntoIterator<Item = f64>) {
        self.laws.push(law);
        self.free.extend(free);
        self.starts.push(self.free.len());
    }

    /// How many rows there are.
    pub(crate) fn rows(&self) -> usize {
        self.free.len()
    }

    /// Each block, and its rows.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = (BlockLaw, Range<usize>)> {
        self.laws.iter().zip(self.starts.windows(2)).map(|(&law, ends)| (law, ends[0]..ends[1]))
    }

    /// Takes the compliance between each row and those from it on, written in the place of zeros.
    pub(crate) fn couple(&mut self, mut write: impl FnMut(usize, &mut [f64])) {
        let n = self.rows();
        self.compliance.clear();
        self.compliance.resize(n * n, 0.0);
        for i in 0..n {
            write(i, &mut self.compliance[n * i + i..n * (i + 1)]);
            for j in i + 1..n {
                self.compliance[n * j + i] = self.compliance[n * i + j];
            }
        }
        self.own.clear();
        self.own.extend((0..n).map(|i| self.compliance[n * i + i]));
        for (law, rows) in self.laws.iter().zip(self.starts.windows(2)) {
            let (first, end) = (rows[0] + law.normals(), rows[1]);
            if let (BlockLaw::Cone(_) | BlockLaw::Disc { .. }, true) = (law, first < end) {
                let [xx, yy] = [self.own[first], self.own[end - 1]];
                let xy = if end - first > 1 { self.compliance[n * first + end - 1] } else { 0.0 };
                let half = 0.5 * (xx - yy);
                self.own[first..end].fill(0.5 * (xx + yy) + half.hypot(xy));
            }
        }
        self.scale.clear();
        self.scale.extend(self.own.iter().map(|d| if *d > 0.0 { d.sqrt().recip() } else { 1.0 }));
    }

    /// Multiplications that a factor takes: as many as dense rows would, less what is before the first of each row.
    pub(crate) fn work(&self) -> usize {
        let n = self.rows();
        let filled = |row: usize| {
            let before = self.compliance[n * row..][..row].iter().position(|w| *w != 0.0);
            row - before.unwrap_or(row)
        };
        (0..n).map(|row| filled(row).pow(2)).sum()
    }

    /// The rates that impulses lead to.
    pub(crate) fn find_rates(&mut self, x: &[f64]) {
        self.rates.clear();
        self.rates.extend_from_slice(&self.free);
        // By columns, which are rows as well.
        let columns = self.compliance.chunks_exact(x.len().max(1)).zip(x);
        for (column, x) in columns.filter(|(_, x)| **x != 0.0) {
            self.rates.iter_mut().zip(column).for_each(|(rate, w)| *rate += w * x);
        }
    }

    /// The compliance between two rows whose own are scaled to 1.
    pub(crate) fn scaled(&self, row: usize, column: usize) -> f64 {
        self.compliance[self.rows() * row + column] * self.scale[row] * self.scale[column]
    }

    /// How far these impulses are from meeting the laws.
    pub(crate) fn left(&mut self, x: &[f64]) -> Left {
        self.find_rates(x);
        self.left_at_rates(x)
    }

    /// The same by the rates at hand.
    pub(crate) fn left_at_rates(&self, x: &[f64]) -> Left {
        let mut left = Left::default();
        for (law, rows) in self.blocks() {
            let [u, own] = [&self.rates, &self.own].map(|list| &list[rows.clone()]);
            let radius = law.radius(x, rows.start);
            let x = &x[rows];
            let wanted = |k: usize| if own[k] > 0.0 { x[k] - u[k] / own[k] } else { x[k] };
            match law {
                BlockLaw::Equality => left.normal = worse(left.normal, u[0]),
                BlockLaw::Limit => left.normal = worse(left.normal, u[0].min(own[0] * x[0])),
                BlockLaw::Bounded(bound) => {
                    let off = (x[0] - wanted(0).clamp(-bound, bound)) * own[0];
                    left.friction = worse(left.friction, off);
                }
                BlockLaw::Cone(_) | BlockLaw::Disc { .. } => {
                    let first = law.normals();
                    if first > 0 {
                        left.normal = worse(left.normal, u[0].min(own[0] * x[0]));
                    }
                    let length = size((first..x.len()).map(wanted));
                    let part = if length > radius { radius / length } else { 1.0 };
                    let off = (first..x.len()).map(|k| (x[k] - part * wanted(k)) * own[k]);
                    left.friction = worse(left.friction, size(off));
                }
            }
        }
        left
    }

    /// Takes impulses to admissible ones: friction within what pushes.
    pub(crate) fn admit(&self, x: &mut [f64]) {
        for (law, rows) in self.blocks() {
            let first = rows.start;
            match law {
                BlockLaw::Equality => continue,
                BlockLaw::Bounded(bound) => x[first] = x[first].max(-bound).min(bound),
                BlockLaw::Limit | BlockLaw::Cone(_) => x[first] = x[first].max(0.0),
                BlockLaw::Disc { .. } => {}
            }
            let radius = law.radius(x, first);
            let across = &mut x[first + law.normals()..rows.end];
            let length = size(across.iter().copied());
            if length > radius {
                across.iter_mut().for_each(|x| *x *= radius / length);
            }
        }
    }
}

/// The length of a vector.
pub(crate) fn size(of: impl IntoIterator<Item = f64>) -> f64 {
    of.into_iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The larger of two sizes; what is no number stays so.
fn worse(worst: f64, off: f64) -> f64 {
    let off = off.abs();
    if off.is_nan() || off > worst { off } else { worst }
}
