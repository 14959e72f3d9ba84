//! A rectangular net of springs: a square lattice with both diagonals in every cell.
//!
//! ```text
//! vertex (row, column) = columns * row + column
//! sides of rest length s and stiffness k, diagonals of rest length s sqrt 2 and stiffness k
//! ```
//! `s` the spacing in metres, `k` in N/m. Without the diagonals the net would shear without effort.

use std::f64::consts::SQRT_2;

use crate::{Spring, SpringError, Strain};

/// The size and the springs of a net.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Net {
    /// Vertices down, at least two.
    pub rows: usize,
    /// Vertices across, at least two.
    pub columns: usize,
    /// Rest length of the sides, metres.
    pub spacing: f64,
    /// Stiffness of every spring, N/m.
    pub stiffness: f64,
    /// The springs' measure of stretch.
    pub strain: Strain,
}

/// The springs of a net, row by row.
///
/// # Errors
/// [`SpringError::NetSize`], [`SpringError::TooMany`], and what a [`Spring`] refuses.
pub fn net(size: Net) -> Result<Vec<Spring>, SpringError> {
    let Net { rows, columns, spacing, stiffness, strain } = size;
    if rows < 2 || columns < 2 {
        return Err(SpringError::NetSize { rows, columns });
    }
    if rows.checked_mul(columns).is_none_or(|vertices| vertices > u32::MAX as usize) {
        return Err(SpringError::TooMany { rows, columns });
    }
    // A spring that cannot be is known before there is room for all of them.
    Spring::new([0, 1], spacing, stiffness, strain)?;
    Spring::new([0, 1], spacing * SQRT_2, stiffness, strain)?;
    let mut springs = Vec::with_capacity(4 * rows * columns);
    let mut join = |a: usize, b: usize, length: f64| {
        springs.push(Spring::new([a, b], length, stiffness, strain)?);
        Ok(())
    };
    for row in 0..rows {
        for column in 0..columns {
            let here = columns * row + column;
            let (right, below) = (column + 1 < columns, row + 1 < rows);
            if right {
                join(here, here + 1, spacing)?;
            }
            if below {
                join(here, here + columns, spacing)?;
            }
            if right && below {
                join(here, here + columns + 1, spacing * SQRT_2)?;
                join(here + 1, here + columns, spacing * SQRT_2)?;
            }
        }
    }
    Ok(springs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_net_has_its_sides_and_both_diagonals_of_every_cell() {
        let size =
            Net { rows: 20, columns: 20, spacing: 0.1, stiffness: 5.0, strain: Strain::Cauchy };
        assert_eq!(net(size).unwrap().len(), 2 * 20 * 19 + 2 * 19 * 19);
        let thin = Net { rows: 1, ..size };
        assert_eq!(net(thin), Err(SpringError::NetSize { rows: 1, columns: 20 }));
        let slack = Net { stiffness: 0.0, ..size };
        assert_eq!(net(slack), Err(SpringError::Stiffness(0.0)));
        let vast = Net { rows: 1 << 40, ..size };
        assert_eq!(net(vast), Err(SpringError::TooMany { rows: 1 << 40, columns: 20 }));
    }
}
