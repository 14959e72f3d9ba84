//! Random points and rods in the plane, with what must hold of them computed afresh.
//!
//! ```text
//! g = |d| - L,     rate = d.(v_j - v_i)/L,     v <- v - M^-1 J^T (J M^-1 J^T)^+ J v
//! ```

use nalgebra::{DMatrix, DVector};

use crate::Draw;

/// Points and the rods between them; vertices from `masses.len()` on are hooks.
#[derive(Clone, Debug)]
pub(super) struct Net {
    pub(super) shape: Shape,
    pub(super) masses: Vec<f64>,
    pub(super) hooks: Vec<[f64; 2]>,
    pub(super) q: Vec<f64>,
    pub(super) rods: Vec<([usize; 2], f64)>,
}

/// How the points are joined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    HungChain,
    FreeChain,
    Polygon,
    FourBar,
    /// All points joined to all.
    Braced,
}

/// Masses that differ by up to a million.
fn masses(draw: &mut Draw, n: usize) -> Vec<f64> {
    let ratio = draw.one_of(&[1.0, 1.0, 1e1, 1e3, 1e6]);
    let size = draw.one_of(&[1.0, 1.0, 1e-6, 1e6]);
    (0..n).map(|_| size * draw.log_uniform(1.0, f64::max(ratio, 1.0 + 1e-9))).collect()
}

impl Net {
    /// A random net whose rods have the lengths that they have where it starts.
    pub(super) fn draw(draw: &mut Draw) -> Self {
        let shape = draw.one_of(&[
            Shape::HungChain,
            Shape::HungChain,
            Shape::FreeChain,
            Shape::Polygon,
            Shape::FourBar,
            Shape::Braced,
        ]);
        let size = draw.one_of(&[1.0, 1.0, 1e-6, 1e6]);
        let n = match shape {
            Shape::HungChain => draw.between(1, 8),
            Shape::FreeChain => draw.between(2, 8),
            Shape::Polygon => draw.between(3, 6),
            Shape::FourBar => 2,
            Shape::Braced => draw.between(4, 5),
        };
        let masses = masses(draw, n);
        let mut at = [0.0; 2];
        // Straight, folded or as it comes.
        let bend = draw.one_of(&[1.0, 1.0, 1.0, 0.0, 1e-3, 1e-7]);
        let mut q = Vec::new();
        for _ in 0..n {
            let length = size * draw.log_uniform(0.3, 3.0);
            let angle = bend * std::f64::consts::PI * draw.symmetric();
            let back = if bend < 1.0 && draw.chance(0.3) { -1.0 } else { 1.0 };
            at = [at[0] + back * length * angle.sin(), at[1] - back * length * angle.cos()];
            q.extend(at);
        }
        let hooks = match shape {
            Shape::HungChain => vec![[0.0; 2]],
            Shape::FourBar => {
                let off = bend * std::f64::consts::PI * draw.symmetric();
                let length = size * draw.log_uniform(0.3, 3.0);
                vec![[0.0; 2], [at[0] + length * off.sin(), at[1] - length * off.cos()]]
            }
            _ => Vec::new(),
        };
        let mut pairs: Vec<[usize; 2]> = (1..n).map(|i| [i - 1, i]).collect();
        match shape {
            Shape::HungChain => pairs.insert(0, [n, 0]),
            Shape::FreeChain => {}
            Shape::Polygon => pairs.push([n - 1, 0]),
            Shape::FourBar => pairs.extend([[n, 0], [n + 1, 1]]),
            Shape::Braced => {
                pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j])).collect();
            }
        }
        let mut net = Net { shape, masses, hooks, q, rods: Vec::new() };
        net.rods = pairs.iter().map(|&ends| (ends, net.along(&net.q, ends).norm())).collect();
        net
    }

    /// Whether a rod is too short to be one.
    pub(super) fn is_degenerate(&self) -> bool {
        let longest = self.rods.iter().fold(0.0_f64, |a, rod| a.max(rod.1));
        self.rods.iter().any(|rod| rod.1 < 1e-3 * longest)
    }

    pub(super) fn size(&self) -> f64 {
        self.rods.iter().fold(0.0_f64, |a, rod| a.max(rod.1))
    }

    fn place(&self, q: &[f64], vertex: usize) -> DVector<f64> {
        let n = self.masses.len();
        let x =
            if vertex < n { [q[2 * vertex], q[2 * vertex + 1]] } else { self.hooks[vertex - n] };
        DVector::from_row_slice(&x)
    }

    fn along(&self, q: &[f64], [i, j]: [usize; 2]) -> DVector<f64> {
        self.place(q, j) - self.place(q, i)
    }

    /// `|d| - L` of every rod.
    pub(super) fn stretches(&self, q: &[f64]) -> DVector<f64> {
        DVector::from_iterator(
            self.rods.len(),
            self.rods.iter().map(|&(ends, length)| {
                let d = self.along(q, ends);
                (d.dot(&d) - length * length) / (d.norm() + length)
            }),
        )
    }

    /// The differential of the lengths.
    pub(super) fn differential(&self, q: &[f64]) -> DMatrix<f64> {
        let n = self.masses.len();
        let mut j = DMatrix::zeros(self.rods.len(), 2 * n);
        for (row, &(ends, _)) in self.rods.iter().enumerate() {
            let d = self.along(q, ends).normalize();
            for (vertex, sign) in ends.into_iter().zip([-1.0, 1.0]) {
                if vertex < n {
                    (0..2).for_each(|c| j[(row, 2 * vertex + c)] = sign * d[c]);
                }
            }
        }
        j
    }

    pub(super) fn mass(&self, freedom: usize) -> f64 {
        self.masses[freedom / 2]
    }

    /// `J M^-1 J^T`'s pseudoinverse, between two places.
    pub(super) fn step_matrix(&self, q: &[f64], j0: &DMatrix<f64>) -> DMatrix<f64> {
        let mut weighted = j0.transpose();
        for (freedom, mut row) in weighted.row_iter_mut().enumerate() {
            row /= self.mass(freedom);
        }
        self.differential(q) * weighted
    }

    /// The smallest over the largest singular value that is not zero of the differential in reference
    /// scales, masses left aside.
    pub(super) fn regularity(&self, q: &[f64]) -> f64 {
        let sigma = self.differential(q).svd(false, false).singular_values;
        self.smallest(sigma.as_slice()) / sigma[0]
    }

    /// The smallest of the singular values that is not zero.
    fn smallest(&self, sigma: &[f64]) -> f64 {
        let rank = match self.shape {
            Shape::Braced => 2 * self.masses.len() - 3,
            _ => self.rods.len(),
        };
        if rank > sigma.len() { 0.0 } else { sigma[rank - 1] }
    }

    /// Takes the part out of a velocity that would stretch rods.
    pub(super) fn project_velocity(&self, v: &mut DVector<f64>) {
        let j = self.differential(&self.q);
        let n = v.len();
        let root = DMatrix::from_fn(j.nrows(), n, |i, f| j[(i, f)] / self.mass(f).sqrt());
        let svd = root.svd(true, true);
        let (Some(_), Some(rows)) = (&svd.u, &svd.v_t) else { return };
        let largest = svd.singular_values.max();
        for _ in 0..3 {
            let mut scaled = DVector::from_fn(n, |f, _| v[f] * self.mass(f).sqrt());
            for (k, row) in rows.row_iter().enumerate() {
                if svd.singular_values[k] > 1e-10 * largest {
                    let along = row.transpose();
                    let part = along.dot(&scaled);
                    scaled.axpy(-part, &along, 1.0);
                }
            }
            *v = DVector::from_fn(n, |f, _| scaled[f] / self.mass(f).sqrt());
        }
    }

    /// The fastest turn of a rod at a velocity, rad/s.
    pub(super) fn fastest_turn(&self, v: &DVector<f64>) -> f64 {
        let n = self.masses.len();
        let velocity = |vertex: usize| match vertex < n {
            true => [v[2 * vertex], v[2 * vertex + 1]],
            false => [0.0; 2],
        };
        let turn = |&([i, j], length): &([usize; 2], f64)| {
            let (a, b) = (velocity(i), velocity(j));
            (b[0] - a[0]).hypot(b[1] - a[1]) / length
        };
        self.rods.iter().map(turn).fold(0.0, f64::max)
    }

    /// The largest mass over the smallest.
    pub(super) fn mass_ratio(&self) -> f64 {
        let largest = self.masses.iter().fold(0.0_f64, |a, &m| a.max(m));
        self.masses.iter().fold(0.0_f64, |a, &m| a.max(largest / m))
    }

    /// Whether a step of RATTLE's configuration has a solution that a full, damped Newton finds.
    pub(super) fn step_has_a_solution(&self, q0: &[f64], p: &[f64], h: f64) -> bool {
        let j0 = self.differential(q0);
        let m = self.rods.len();
        let reach = |impulse: &DVector<f64>| -> Vec<f64> {
            let pull = j0.transpose() * impulse;
            (0..q0.len()).map(|f| q0[f] + h * (p[f] - pull[f]) / self.mass(f)).collect()
        };
        let mut impulse = DVector::zeros(m);
        let mut best = self.stretches(&reach(&impulse)).norm();
        let enough = 1e-11 * self.size();
        for _ in 0..300 {
            if best <= enough {
                return true;
            }
            let q = reach(&impulse);
            let matrix = self.step_matrix(&q, &j0) * h;
            let Ok(inverse) = matrix.pseudo_inverse(1e-13) else { return false };
            let change = inverse * self.stretches(&q);
            let mut part = 1.0;
            loop {
                let next = &impulse + &change * part;
                let left = self.stretches(&reach(&next)).norm();
                if left < best * (1.0 - 0.1 * part) {
                    (impulse, best) = (next, left);
                    break;
                }
                part *= 0.5;
                if part < 1e-8 {
                    return false;
                }
            }
        }
        false
    }
}
