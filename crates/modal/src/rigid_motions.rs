//! Rigid motions: directions in which a body moves without effort.
//!
//! ```text
//! translations   r_i = e_c                         one for each axis
//! rotations      r_i = e_b x_c - e_c x_b           one for each pair of axes
//! G = R^T H R,   R^T M R = I                       effortless where G is zero
//! ```
//! `x_i` the vertices at the equilibrium, D coordinates each, `H` the Hessian, `M` the mass. At an
//! equilibrium of a potential that rotations leave alone they are in the kernel of H, whether the body
//! is under stress or not: 1 on a line, 3 in the plane, 6 in space, fewer where all vertices are on one
//! line, where pins hold them, or where a load breaks the symmetry. So they are not counted on but
//! found: candidates that are no motion, or that cost energy, are left out.
//! Source: notes 14.1, whose remark on rotations is wrong: errata 14.1.

use nalgebra::{DMatrix, SymmetricEigen};
use stationary_calculus::{Metric, Potential};

use crate::{Linearized, ModalError, dense};

/// A motion counts as effortless where its `lambda` is below this share of the scale.
const EFFORTLESS: f64 = 1e-9;

/// A candidate that is left with less than this share of its length is a combination of others.
const INDEPENDENT: f64 = 1e-8;

/// Rigid motions, orthonormal in the mass.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RigidMotions {
    pub(crate) columns: Vec<f64>,
    pub(crate) count: usize,
}

impl RigidMotions {
    /// None: the system has no vertices in space, or every mode is wanted as it comes.
    pub fn none() -> Self {
        RigidMotions::default()
    }

    /// The effortless motions of vertices in D = 1, 2 or 3 dimensions, D freedoms each.
    pub fn of_points<const D: usize>(
        system: &Linearized<'_, impl Metric, impl Potential>,
        q: &[f64],
    ) -> Result<Self, ModalError> {
        let n = system.dim();
        stationary_calculus::SizeError::check("the configuration's numbers", n, q.len())?;
        let candidates = candidates::<D>(q);
        let columns = dense::orthonormal(system.mass(), &candidates, INDEPENDENT);
        let k = columns.len() / n.max(1);
        // Combinations in which some cost nothing: the eigenvectors of their small stiffness.
        let mut moved = vec![0.0; columns.len()];
        for (x, y) in columns.chunks_exact(n).zip(moved.chunks_exact_mut(n)) {
            system.stiffness().add_product(1.0, x, y)?;
        }
        let effort = DMatrix::from_fn(k, k, |i, j| {
            dense::dot(&columns[i * n..(i + 1) * n], &moved[j * n..(j + 1) * n])
        });
        let symmetric = (&effort + effort.transpose()) * 0.5;
        let pairs = SymmetricEigen::new(symmetric);
        let mut kept = Vec::new();
        for (j, lambda) in pairs.eigenvalues.iter().enumerate() {
            if lambda.abs() > EFFORTLESS * system.scale() {
                continue;
            }
            let mut motion = vec![0.0; n];
            for (i, column) in columns.chunks_exact(n).enumerate() {
                dense::add_scaled(&mut motion, pairs.eigenvectors[(i, j)], column);
            }
            kept.extend(motion);
        }
        Ok(RigidMotions { count: kept.len() / n.max(1), columns: kept })
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.count
    }

    /// True where there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }
}

fn candidates<const D: usize>(q: &[f64]) -> Vec<f64> {
    let points = q.as_chunks::<D>().0;
    let middle: [f64; D] = std::array::from_fn(|c| {
        points.iter().map(|x| x[c]).sum::<f64>() / points.len().max(1) as f64
    });
    let mut columns = Vec::new();
    for c in 0..D {
        columns.extend(
            points
                .iter()
                .flat_map(|_| std::array::from_fn::<f64, D, _>(|d| if d == c { 1.0 } else { 0.0 })),
        );
    }
    for (b, c) in (0..D).flat_map(|b| (b + 1..D).map(move |c| (b, c))) {
        columns.extend(points.iter().flat_map(|x| {
            let mut r = [0.0; D];
            r[b] = x[c] - middle[c];
            r[c] = middle[b] - x[b];
            r
        }));
    }
    columns
}
