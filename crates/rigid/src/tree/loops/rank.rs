//! Rows that push alone: against what the tree holds, and against each other.

use super::super::motion::TreeMotion;
use super::row::LoopRow;
use crate::Wrench;

/// What a row moves that is this part of what it would move of all bodies as one, is held by the tree.
const HELD: f64 = 1e-11;
/// So is what is rounding of the motion of the lightest.
const ROUNDED: f64 = 256.0 * f64::EPSILON;
/// The square of the sine of the angle between rows, masses counted, below which they hold the same.
const DEPENDENT: f64 = 1e-11;

/// The memory to examine the rank of `J M^-1 J^T`: a copy of it, and the roots of its diagonal.
#[derive(Clone, Debug, Default)]
pub(in crate::tree) struct Rank {
    scaled: Vec<f64>,
    sizes: Vec<f64>,
}

impl Rank {
    pub(in crate::tree) fn resize(&mut self, rows: usize) {
        self.scaled.resize(rows * rows, 0.0);
        self.sizes.resize(rows, 0.0);
    }

    /// The largest of multipliers, each by what its row alone moves.
    pub(in crate::tree) fn largest(&self, multipliers: &[f64]) -> f64 {
        let sizes = multipliers.iter().zip(&self.sizes);
        sizes.fold(0.0, |largest, (lambda, size)| largest.max(lambda.abs() * size))
    }

    /// Finds the rows that the tree or earlier rows hold already: what such a row meets is rounding, and a number
    /// divided by it would be none. The first rows are those of loops, the others are held by no tree.
    pub(in crate::tree) fn examine(
        &mut self,
        motion: &TreeMotion,
        rows: &[LoopRow],
        matrix: &[f64],
        mut dependent: impl FnMut(usize),
    ) {
        let Rank { scaled, sizes } = self;
        let m = sizes.len();
        let [together, lightest] = Lump::of(motion);
        scaled.copy_from_slice(matrix);
        for (r, size) in sizes.iter_mut().enumerate() {
            let rounding = rows.get(r).map_or(0.0, |row| {
                let unit = row.differential(motion);
                HELD * together.response(&unit) + ROUNDED * lightest.response(&unit)
            });
            let response = scaled[(m + 1) * r];
            let moves = response > rounding;
            *size = if moves { response.sqrt() } else { f64::INFINITY };
        }
        // Cholesky's pivots, of rows that alone meet 1.
        for k in 0..m {
            let mut pivot = 0.0;
            for i in k..m {
                let taken: f64 = (0..k).map(|j| scaled[m * j + i] * scaled[m * j + k]).sum();
                let entry = scaled[m * k + i] / (sizes[i] * sizes[k]) - taken;
                if i == k {
                    if entry > DEPENDENT {
                        pivot = entry.sqrt();
                    } else {
                        dependent(k);
                    }
                    scaled[m * k + i] = pivot;
                } else {
                    scaled[m * k + i] = if pivot > 0.0 { entry / pivot } else { 0.0 };
                }
            }
        }
    }
}

/// A mass and an inertia that a row could push, kg and kg m^2.
pub(super) struct Lump {
    mass: f64,
    inertia: f64,
}

impl Lump {
    /// All bodies as one, and the lightest of each.
    pub(super) fn of(motion: &TreeMotion) -> [Lump; 2] {
        let mut all = Lump { mass: 0.0, inertia: 0.0 };
        let mut least = Lump { mass: f64::INFINITY, inertia: f64::INFINITY };
        let origin = motion.placed[0].centre;
        for (link, placed) in motion.tree.links.iter().zip(&motion.placed) {
            if link.mass > 0.0 {
                all.mass += link.mass;
                all.inertia += link.moments.sum();
                all.inertia += link.mass * (placed.centre - origin).norm_squared();
                least.mass = least.mass.min(link.mass);
                least.inertia = least.inertia.min(link.moments.min());
            }
        }
        [all, least]
    }

    /// How a unit of a row's force moves it along the row.
    pub(super) fn response(&self, unit: &[Wrench; 2]) -> f64 {
        let force = unit.iter().map(|wrench| wrench.force.norm_squared()).sum::<f64>();
        let torque = unit.iter().map(|wrench| wrench.torque.norm_squared()).sum::<f64>();
        force / self.mass + torque / self.inertia
    }
}
