//! A body that may move far, in a few directions only: its whole energy on a subspace.
//!
//! ```text
//! q = q0 + U a,   V_r(a) = V(q0 + U a),   dV_r = U^T dV,   d2V_r = U^T d2V U,   U^T M U = I
//! H theta_ij = -(dH/dv_i) v_j                 how mode j changes its shape as mode i is deflected
//! ```
//! `U` (n x r) columns orthonormal in the mass, `a` (r) in kg^1/2 m, `v_i` modes, `theta_ij` their
//! modal derivatives, symmetric in i and j. A deflected beam's tip comes back along a parabola; modes
//! are straight lines, and in their span alone the beam must stretch instead: too stiff by far. The
//! derivatives are the parabolas' curvature, and with them the subspace follows until turns are no
//! longer small. The subspace is a potential with the unit metric, so that every integrator steps it.
//!
//! An evaluation costs one of the whole body and its products with U: what is saved are factors of
//! size n and the fast modes that would bound the step. Beyond the notes. Source: Idelsohn and
//! Cardona, "A reduction method for nonlinear structural dynamic analysis" (Comput. Methods Appl.
//! Mech. Eng. 49, 1985); Barbic and James (SIGGRAPH 2005).

use stationary_calculus::{Covector, FIXED, Metric, Potential, Sink, SizeError};

use crate::{Linearized, ModalError, Modes, dense};

/// A column that is left with less than this share of its length by those before is left out.
const INDEPENDENT: f64 = 1e-8;

/// A potential on a few directions from an equilibrium.
#[derive(Clone, Debug)]
pub struct Subspace<'a, P> {
    potential: &'a P,
    q0: Vec<f64>,
    /// U by rows, r numbers each.
    rows: Vec<f64>,
    r: usize,
}

impl<'a, M: Metric, P: Potential> Linearized<'a, M, P> {
    /// The body in the span of the modes.
    ///
    /// # Errors
    /// [`ModalError::Size`], and [`ModalError::Count`] for no modes.
    pub fn subspace(&self, modes: &Modes) -> Result<Subspace<'a, P>, ModalError> {
        self.check_modes(modes)?;
        Ok(self.spanned(modes.columns()))
    }

    /// The body in the span of the N modes and of all their N(N + 1)/2 derivatives, which are taken
    /// by differences over a change of coordinates of at most `reach`, in their unit: a thousandth of
    /// the body will do, and on an energy of degree four any.
    ///
    /// # Errors
    /// Those of [`Linearized::subspace`], [`ModalError::Parameter`], and [`ModalError::Stiffness`] where the body is
    /// not held or not at a minimum: derivatives there have a part that nothing determines.
    pub fn subspace_with_derivatives(
        &mut self,
        modes: &Modes,
        reach: f64,
    ) -> Result<Subspace<'a, P>, ModalError> {
        self.check_modes(modes)?;
        if !(reach > 0.0 && reach.is_finite()) {
            return Err(ModalError::Parameter {
                what: "the reach of the differences",
                value: reach,
            });
        }
        let mut columns = modes.columns().to_vec();
        let mut derivatives = self.bent_forces(modes, reach)?;
        self.factor(0.0)?.map_err(ModalError::Stiffness)?;
        self.factored().0.solve(&mut derivatives);
        columns.extend(derivatives);
        Ok(self.spanned(&columns))
    }

    fn check_modes(&self, modes: &Modes) -> Result<(), ModalError> {
        SizeError::check("the modes' freedoms", self.dim(), modes.dim())?;
        if modes.is_empty() {
            return Err(ModalError::Count { asked: 0, there: self.dim() });
        }
        Ok(())
    }

    /// `-(dH/dv_i) v_j` for i <= j, one after the other.
    fn bent_forces(&self, modes: &Modes, reach: f64) -> Result<Vec<f64>, ModalError> {
        let n = self.dim();
        let mut hessian = self.stiffness().clone();
        let mut forces = Vec::with_capacity(n * modes.len() * (modes.len() + 1) / 2);
        for i in 0..modes.len() {
            let v = modes.column(i);
            let longest = v.iter().fold(0.0_f64, |longest, x| longest.max(x.abs()));
            let step = reach / longest;
            let start = forces.len();
            forces.resize(start + n * (modes.len() - i), 0.0);
            for sign in [1.0, -1.0] {
                let mut q = self.equilibrium().to_vec();
                dense::add_scaled(&mut q, sign * step, v);
                self.hessian_at(&q, &mut hessian)?;
                for (j, force) in forces[start..].chunks_exact_mut(n).enumerate() {
                    hessian.add_product(-0.5 * sign / step, modes.column(i + j), force)?;
                }
            }
        }
        Ok(forces)
    }

    fn spanned(&self, columns: &[f64]) -> Subspace<'a, P> {
        let n = self.dim();
        let columns = dense::orthonormal(self.mass(), columns, INDEPENDENT);
        let r = columns.len() / n.max(1);
        let rows = (0..n * r).map(|k| columns[k / r + n * (k % r)]).collect();
        Subspace { potential: self.potential(), q0: self.equilibrium().to_vec(), rows, r }
    }
}

impl<P> Subspace<'_, P> {
    /// Writes the configuration `q0 + U a` of the whole body.
    ///
    /// # Errors
    /// [`ModalError::Size`].
    pub fn configuration(&self, a: &[f64], q: &mut [f64]) -> Result<(), ModalError> {
        SizeError::check("the reduced coordinates", self.r, a.len())?;
        SizeError::check("the configuration's numbers", self.q0.len(), q.len())?;
        self.expand(a, q);
        Ok(())
    }

    /// `U^T p`: what a force or a momentum of the whole body is on the subspace.
    ///
    /// # Errors
    /// [`ModalError::Size`].
    pub fn pulled_back(&self, p: Covector<&[f64]>) -> Result<Covector<Vec<f64>>, ModalError> {
        SizeError::check("the covector's components", self.q0.len(), p.0.len())?;
        let mut reduced = vec![0.0; self.r];
        self.add_pulled_back(p.0, &mut reduced);
        Ok(Covector(reduced))
    }

    fn expand(&self, a: &[f64], q: &mut [f64]) {
        let rows = self.rows.chunks_exact(self.r);
        for ((q, q0), row) in q.iter_mut().zip(&self.q0).zip(rows) {
            *q = q0 + dense::dot(row, a);
        }
    }

    fn add_pulled_back(&self, p: &[f64], reduced: &mut [f64]) {
        for (p, row) in p.iter().zip(self.rows.chunks_exact(self.r)) {
            dense::add_scaled(reduced, *p, row);
        }
    }

    fn whole(&self, a: &[f64]) -> Vec<f64> {
        let mut q = vec![0.0; self.q0.len()];
        self.expand(a, &mut q);
        q
    }
}

impl<P: Potential> Potential for Subspace<'_, P> {
    fn dim(&self) -> usize {
        self.r
    }

    fn energy(&self, a: &[f64]) -> f64 {
        self.potential.energy(&self.whole(a))
    }

    fn add_differential(&self, a: &[f64], dv: Covector<&mut [f64]>) {
        let mut whole = Covector(vec![0.0; self.q0.len()]);
        self.potential.add_differential(&self.whole(a), whole.view_mut());
        self.add_pulled_back(&whole.0, dv.0);
    }

    fn add_hessian(&self, a: &[f64], hessian: &mut impl Sink) {
        let mut projected = ProjectedSink {
            rows: &self.rows,
            r: self.r,
            sum: vec![0.0; self.r * self.r],
            column: vec![0.0; self.r],
        };
        self.potential.add_hessian(&self.whole(a), &mut projected);
        let freedoms: Vec<usize> = (0..self.r).collect();
        hessian.add_symmetric(&freedoms, &projected.sum);
    }
}

/// Adds up `U^T B U` block by block: the whole Hessian is never stored.
struct ProjectedSink<'a> {
    rows: &'a [f64],
    r: usize,
    sum: Vec<f64>,
    /// One column of B U_block, transposed: B's column times the rows of its freedoms.
    column: Vec<f64>,
}

impl Sink for ProjectedSink<'_> {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        let r = self.r;
        let row = |freedom: usize| &self.rows[freedom * r..(freedom + 1) * r];
        for (&j, entries) in freedoms.iter().zip(block.chunks_exact(freedoms.len())) {
            if j == FIXED {
                continue;
            }
            self.column.fill(0.0);
            for (&i, entry) in freedoms.iter().zip(entries) {
                if i != FIXED {
                    dense::add_scaled(&mut self.column, *entry, row(i));
                }
            }
            for (sum, weight) in self.sum.chunks_exact_mut(r).zip(row(j)) {
                dense::add_scaled(sum, *weight, &self.column);
            }
        }
    }
}
