//! Rigid motions: directions in which a body moves without effort.
//!
//! ```text
//! translations   r_i = e_c                         one for each axis
//! rotations      r_i = e_b x_c - e_c x_b           one for each pair of axes
//! G = R^T H R,   R^T M R = I                       effortless where G is zero to rounding:
//! |r^T H r| <= 1e-13 |r|^T |H| |r| + |r|^T |W dV|        H r = W dV for a turn r = W x
//! ```
//! `x_i` the vertices at the equilibrium, D coordinates each, `H` the Hessian, `M` the mass. At an
//! equilibrium of a potential that rotations leave alone they are in the kernel of H, whether the body
//! is under stress or not: 1 on a line, 3 in the plane, 6 in space, fewer where all vertices are on one
//! line, where pins or single held components stop them, or where a load breaks the symmetry. So they are
//! not counted on but found: candidates that are no motion, or that cost energy, are left out. What an
//! energy may be off zero is the rounding of the terms that it is the sum of, not a share of the largest
//! lambda: a body on soft springs moves as a whole, but not for free. Forces `dV` that are left at the
//! equilibrium turn with the body, which costs what they do along the turn. To first order only: points in
//! a row of which some are held may all move sideways, and that passes for a rigid motion.
//! Source: notes 14.1, whose remark on rotations is wrong: errata 14.1.

use nalgebra::DMatrix;
use stationary_calculus::{Covector, FIXED, Metric, Potential, SizeError, SymmetricMatrix, array};

use crate::{Linearized, ModalError, dense};

/// Rounding of a motion's energy, relative to the sum of its terms without their signs.
const ROUNDING: f64 = 1e-13;

/// How far products of rigid motions in the mass may be from one and zero.
const ORTHONORMAL: f64 = 1e-8;

/// A candidate that is left with less than this share of its length is a combination of others.
const INDEPENDENT: f64 = 1e-8;

/// Rigid motions, orthonormal in the mass.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RigidMotions {
    pub(crate) columns: Vec<f64>,
    pub(crate) count: usize,
    /// How far the lambda of each may be off zero: the sizes of `H r`, measured by `M^-1`.
    pub(crate) residuals: Vec<f64>,
    /// What forces that are left at the equilibrium make of the energy of each.
    unrest: Vec<f64>,
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
        let mut dv = Covector(vec![0.0; n]);
        system.potential().add_differential(system.equilibrium(), dv.view_mut());
        let (motions, turned) = candidates(places, freedoms, &dv.0);
        RigidMotions::among(system, &motions, &turned)
    }

    /// The effortless ones among these motions (n numbers each, one after the other) and their
    /// combinations: translations and turns of parts, or constants of a field's pieces.
    ///
    /// # Errors
    /// [`ModalError::Size`] where the numbers are no whole motions, [`ModalError::Parameter`] for one that
    /// is not finite.
    pub fn of_motions(
        system: &Linearized<'_, impl Metric, impl Potential>,
        motions: &[f64],
    ) -> Result<Self, ModalError> {
        let n = system.dim().max(1);
        SizeError::check("the motions' numbers", motions.len().div_ceil(n) * n, motions.len())?;
        if let Some(&value) = motions.iter().find(|x| !x.is_finite()) {
            return Err(ModalError::Parameter { what: "a component of a motion", value });
        }
        RigidMotions::among(system, motions, &vec![0.0; motions.len()])
    }

    /// The effortless combinations of motions, of which each turns the forces by `turned`.
    fn among(
        system: &Linearized<'_, impl Metric, impl Potential>,
        motions: &[f64],
        turned: &[f64],
    ) -> Result<Self, ModalError> {
        let n = system.dim();
        let (columns, turned) = orthonormal(system.mass(), motions, turned);
        let k = columns.len() / n;
        // Combinations in which some cost nothing: the eigenvectors of their small stiffness.
        let moved = dense::times(system.stiffness(), &columns);
        let effort = DMatrix::from_vec(k, k, dense::transpose_times(n, &columns, &moved));
        let pairs = dense::eigenpairs((&effort + effort.transpose()) * 0.5)?;
        let combined = |columns: &[f64], j: usize| {
            let mut sum = vec![0.0; n];
            for (i, column) in columns.chunks_exact(n).enumerate() {
                dense::add_scaled(&mut sum, pairs.eigenvectors[(i, j)], column);
            }
            sum
        };
        let (mut kept, mut unrest) = (Vec::new(), Vec::new());
        for (j, lambda) in pairs.eigenvalues.iter().enumerate() {
            let (motion, turned) = (combined(&columns, j), combined(&turned, j));
            let by_forces = motion.iter().zip(&turned).map(|(r, f)| (r * f).abs()).sum::<f64>();
            if lambda.abs() <= rounding(system.stiffness(), &motion) + by_forces {
                kept.extend(motion);
                unrest.push(by_forces);
            }
        }
        let count = unrest.len();
        let residuals = system.residuals(&vec![0.0; count], &kept);
        Ok(RigidMotions { columns: kept, count, residuals, unrest })
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
        let moved = dense::times(system.stiffness(), &self.columns);
        let pairs = self.columns.chunks_exact(n).zip(moved.chunks_exact(n));
        for (motion, ((x, y), unrest)) in pairs.zip(&self.unrest).enumerate() {
            let lambda = dense::dot(x, y);
            let allowed = 2.0 * (rounding(system.stiffness(), x) + unrest);
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

/// What rounding may leave of a motion's energy: a share of `|r|^T |H| |r|`.
fn rounding(stiffness: &SymmetricMatrix, motion: &[f64]) -> f64 {
    ROUNDING * dense::sum_of_sizes(stiffness, motion)
}

/// Motions made orthonormal in the mass, and in the same combinations what they make of the forces.
fn orthonormal(mass: &SymmetricMatrix, motions: &[f64], turned: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let n = mass.dim().max(1);
    let mut basis = dense::Basis::with_room(n, motions.len() / n);
    let mut images: Vec<f64> = Vec::new();
    for (motion, turned) in motions.chunks_exact(n).zip(turned.chunks_exact(n)) {
        let (shares, after) = basis.push_independent(mass, motion, INDEPENDENT);
        let Some(after) = after else { continue };
        let mut image = turned.to_vec();
        for (share, known) in shares.iter().zip(images.chunks_exact(n)) {
            dense::add_scaled(&mut image, -share, known);
        }
        images.extend(image.iter().map(|f| f / after));
    }
    (basis.vectors().to_vec(), images)
}

/// Translations and rotations about the middle, in what is free of them; and the forces as each turns
/// them.
fn candidates<const D: usize>(
    places: &[[f64; D]],
    freedoms: &[[usize; D]],
    forces: &[f64],
) -> (Vec<f64>, Vec<f64>) {
    let n = forces.len();
    let middle: [f64; D] =
        array(|c| places.iter().map(|x| x[c]).sum::<f64>() / places.len().max(1) as f64);
    let (mut columns, mut turned) = (Vec::new(), Vec::new());
    let add = |columns: &mut Vec<f64>, motion: &dyn Fn(usize) -> [f64; D]| {
        let start = columns.len();
        columns.resize(start + n, 0.0);
        for (v, freedoms) in freedoms.iter().enumerate() {
            for (r, &freedom) in motion(v).iter().zip(freedoms) {
                if freedom != FIXED {
                    columns[start + freedom] = *r;
                }
            }
        }
    };
    for c in 0..D {
        add(&mut columns, &|_| array(|d| if d == c { 1.0 } else { 0.0 }));
        add(&mut turned, &|_| [0.0; D]);
    }
    for (b, c) in (0..D).flat_map(|b| (b + 1..D).map(move |c| (b, c))) {
        let turn = |x: [f64; D]| {
            let mut r = [0.0; D];
            (r[b], r[c]) = (x[c], -x[b]);
            r
        };
        let force = |freedom: usize| forces.get(freedom).copied().unwrap_or(0.0);
        add(&mut columns, &|v| turn(array(|d| places[v][d] - middle[d])));
        add(&mut turned, &|v| turn(freedoms[v].map(force)));
    }
    (columns, turned)
}
