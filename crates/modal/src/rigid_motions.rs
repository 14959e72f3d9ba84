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
//! line, where pins or single held components stop them, or where a load breaks the symmetry. So they are not counted on but
//! found: candidates that are no motion, or that cost energy, are left out. To first order only: points in
//! a row of which some are held may all move sideways, and that passes for a rigid motion.
//! Source: notes 14.1, whose remark on rotations is wrong: errata 14.1.

use nalgebra::DMatrix;
use stationary_calculus::{FIXED, Metric, Potential, SizeError, array};

use crate::{Linearized, ModalError, dense};

/// A motion counts as effortless where its `lambda` is below this share of the scale.
const EFFORTLESS: f64 = 1e-9;

/// How far products of rigid motions in the mass may be from one and zero.
const ORTHONORMAL: f64 = 1e-8;

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

    /// The effortless motions of vertices in D = 1, 2 or 3 dimensions, each with all of its D
    /// components free: freedom `D v + c` is component c of vertex v. Vertices that are held are left
    /// out; where single components are, see [`RigidMotions::of_freedoms`].
    ///
    /// # Errors
    /// [`ModalError::Size`] where the freedoms are not D for each vertex, [`ModalError::Parameter`] for
    /// a place that is not finite.
    pub fn of_points<const D: usize>(
        system: &Linearized<'_, impl Metric, impl Potential>,
        places: &[[f64; D]],
    ) -> Result<Self, ModalError> {
        SizeError::check("the vertices' components", system.dim(), places.len() * D)?;
        let freedoms: Vec<[usize; D]> = (0..places.len()).map(|v| array(|c| v * D + c)).collect();
        RigidMotions::of_freedoms(system, places, &freedoms)
    }

    /// The effortless motions of vertices of which any components are held. `freedoms` has for each
    /// component of each vertex its freedom, or [`FIXED`].
    ///
    /// # Errors
    /// [`ModalError::Size`] where there are not as many freedoms as the system has, each once;
    /// [`ModalError::Parameter`] for a place that is not finite.
    pub fn of_freedoms<const D: usize>(
        system: &Linearized<'_, impl Metric, impl Potential>,
        places: &[[f64; D]],
        freedoms: &[[usize; D]],
    ) -> Result<Self, ModalError> {
        let n = system.dim();
        check_freedoms(n, places, freedoms)?;
        let candidates = candidates(n, places, freedoms);
        let columns = dense::orthonormal(system.mass(), &candidates, INDEPENDENT);
        let k = columns.len() / n;
        // Combinations in which some cost nothing: the eigenvectors of their small stiffness.
        let moved = dense::times(system.stiffness(), &columns);
        let effort = DMatrix::from_vec(k, k, dense::transpose_times(n, &columns, &moved));
        let pairs = dense::eigenpairs((&effort + effort.transpose()) * 0.5)?;
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
        Ok(RigidMotions { count: kept.len() / n, columns: kept })
    }

    /// An error where these are the motions of another system.
    pub(crate) fn check(
        &self,
        system: &Linearized<'_, impl Metric, impl Potential>,
    ) -> Result<(), ModalError> {
        let n = system.dim();
        SizeError::check("the rigid motions' numbers", self.count * n, self.columns.len())?;
        let off = dense::skewness(system.mass(), &self.columns);
        if dense::exceeds(off, ORTHONORMAL) {
            let (what, allowed) = ("the rigid motions", ORTHONORMAL);
            return Err(ModalError::NotOrthonormal { what, off, allowed });
        }
        let allowed = 2.0 * EFFORTLESS * system.scale();
        let moved = dense::times(system.stiffness(), &self.columns);
        let pairs = self.columns.chunks_exact(n).zip(moved.chunks_exact(n));
        for (motion, (x, y)) in pairs.enumerate() {
            let lambda = dense::dot(x, y);
            if dense::exceeds(lambda.abs(), allowed) {
                return Err(ModalError::NotRigid { motion, lambda, allowed });
            }
        }
        Ok(())
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

fn check_freedoms<const D: usize>(
    n: usize,
    places: &[[f64; D]],
    freedoms: &[[usize; D]],
) -> Result<(), ModalError> {
    SizeError::check("the vertices with freedoms", places.len(), freedoms.len())?;
    if let Some(&value) = places.as_flattened().iter().find(|x| !x.is_finite()) {
        return Err(ModalError::Parameter { what: "a vertex's coordinate", value });
    }
    let mut named = vec![false; n];
    let mut count = 0;
    for &freedom in freedoms.as_flattened().iter().filter(|freedom| **freedom != FIXED) {
        // One that is named twice, or that there is not, leaves the count wrong.
        count += match named.get_mut(freedom) {
            Some(named) => usize::from(!std::mem::replace(named, true)),
            None => n + 1,
        };
    }
    let all = freedoms.as_flattened().iter().filter(|freedom| **freedom != FIXED).count();
    SizeError::check("the components that are free", n, all)?;
    Ok(SizeError::check("the freedoms that are named once", n, count)?)
}

/// Translations and rotations about the middle, in what is free of them.
fn candidates<const D: usize>(n: usize, places: &[[f64; D]], freedoms: &[[usize; D]]) -> Vec<f64> {
    let middle: [f64; D] =
        array(|c| places.iter().map(|x| x[c]).sum::<f64>() / places.len().max(1) as f64);
    let mut columns = Vec::new();
    let mut add = |motion: &dyn Fn(&[f64; D]) -> [f64; D]| {
        let start = columns.len();
        columns.resize(start + n, 0.0);
        for (x, freedoms) in places.iter().zip(freedoms) {
            for (r, &freedom) in motion(x).iter().zip(freedoms) {
                if freedom != FIXED {
                    columns[start + freedom] = *r;
                }
            }
        }
    };
    for c in 0..D {
        add(&|_| array(|d| if d == c { 1.0 } else { 0.0 }));
    }
    for (b, c) in (0..D).flat_map(|b| (b + 1..D).map(move |c| (b, c))) {
        add(&|x| {
            let mut r = [0.0; D];
            r[b] = x[c] - middle[c];
            r[c] = middle[b] - x[b];
            r
        });
    }
    columns
}
