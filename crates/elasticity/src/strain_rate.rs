//! Damping: what a body resists because it is being deformed, and not because it is.
//!
//! ```text
//! S' = 1/2 (F^T F' + F'^T F)                       rate of Green's strain, 1/s        (10.1.1)
//! D = int eta tr S'^2 + zeta/2 (tr S')^2 >= 0      watts; the force -dD/dv takes 2 D of power
//! Rayleigh   F = -(alpha M + beta d2V(q)) v        alpha 1/s, beta s
//! ```
//! `eta zeta` viscosities (Pa s) in the places of mu and lambda, with the same bounds; `F F'` the
//! deformation and its rate. Strain-rate damping does not feel rigid motion, however fast: it slows
//! vibration and leaves flight and spin alone. Rayleigh's does: alpha is a drag on all motion, and
//! beta is blind to rotation only near rest. Its Hessian ought to be positive semidefinite, or it
//! would drive what it should damp; give it a body [`with_curvature`](Solid::with_curvature)
//! projected. The damping's own matrix is exact; its change with q is left to the next Newton step.
//! Held coordinates count as resting. Source: notes 10.1.1; Rayleigh (1877).

use stationary_calculus::{
    Covector, Force, Metric, Potential, ProductSink, Scaled, Sink, Vector, array,
};

use crate::group::deformation;
use crate::lane_hessian::{Accumulation, begin, complete};
use crate::material::TakesTangent;
use crate::material::hookean_block;
use crate::tensor::{apply, dot, outer_gram, product, scaled, shifted, trace};
use crate::{
    ElasticityError, Freedoms, Lame, Lanes, Material, Real, SaintVenantKirchhoff, Solid, Tangent,
};

type Body<const N: usize, const D: usize, const R: usize, const Q: usize> =
    Solid<SaintVenantKirchhoff<R>, N, D, R, Q>;

/// Viscosity of the elements of a body.
#[derive(Clone, Debug)]
pub struct StrainRate<const N: usize, const D: usize, const R: usize, const Q: usize> {
    body: Body<N, D, R, Q>,
    /// The same numbering with every held velocity zero.
    resting: Freedoms<D>,
}

impl<const N: usize, const D: usize, const R: usize, const Q: usize> StrainRate<N, D, R, Q> {
    /// The viscosity of a body of the same elements: `zeta` and `eta` of [`Lame`]'s pair, Pa s.
    ///
    /// # Errors
    /// None: every pair damps every body.
    pub fn new<M: Material<D, R>>(
        body: &Solid<M, N, D, R, Q>,
        viscosity: Lame<R>,
    ) -> Result<Self, ElasticityError> {
        let resting = body.freedoms().resting();
        Ok(StrainRate { body: body.of_material(SaintVenantKirchhoff::new(viscosity)), resting })
    }

    /// Moves the held coordinates, all of them, in their order.
    ///
    /// # Errors
    /// Those of [`Freedoms::hold_at`]; the viscosity is then as it was.
    pub fn hold_at(&mut self, places: &[f64]) -> Result<(), ElasticityError> {
        self.body.hold_at(places)
    }

    fn pair(&self) -> Lame<R> {
        self.body.material().lame()
    }
}

impl<const N: usize, const D: usize, const R: usize, const Q: usize> Force
    for StrainRate<N, D, R, Q>
{
    fn dim(&self) -> usize {
        self.body.freedoms().dim()
    }

    /// NaN in every component where any of the three is too short.
    fn add_force(&self, _t: f64, q: &[f64], v: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        let n = self.dim();
        if q.len().min(v.0.len()).min(f.0.len()) < n {
            return f.0.fill(f64::NAN);
        }
        let (q, v, f) = (&q[..n], &v.0[..n], &mut f.0[..n]);
        for group in &self.body.groups {
            let x = group.corners(self.body.freedoms(), q);
            let u = group.corners(&self.resting, v);
            let mut forces = [[Lanes::default(); D]; N];
            for (gradients, &weight) in group.gradients.iter().zip(&group.weights) {
                let stress = self.stress(&x, &u, gradients, weight);
                for a in 1..N {
                    let force = apply(&stress, &gradients[a]);
                    for c in 0..D {
                        forces[a][c] = forces[a][c] - force[c];
                        forces[0][c] += force[c];
                    }
                }
            }
            for (lane, nodes) in group.nodes.iter().enumerate().take(group.filled) {
                for (&node, force) in nodes.iter().zip(&forces) {
                    self.resting.add(node, &force.map(|component| component.lane(lane)), f);
                }
            }
        }
    }

    fn add_damping(&self, _t: f64, q: &[f64], _v: Vector<&[f64]>, damping: &mut impl Sink) {
        let Some(q) = q.get(..self.dim()) else {
            return damping.add_symmetric(&[0], &[f64::NAN]);
        };
        let mut lanes = [[[[Lanes::default(); D]; D]; N]; N];
        for group in &self.body.groups {
            let x = group.corners(self.body.freedoms(), q);
            begin::<N, D, Q>(&mut lanes);
            for (gradients, &weight) in group.gradients.iter().zip(&group.weights) {
                let f = deformation(&x, gradients);
                let pair = [weight * self.pair().lambda(), weight * self.pair().mu()];
                let viscosity = Viscosity { spread: outer_gram(&f), f, pair };
                let hessian = &mut lanes;
                Accumulation::<'_, N, D, R, Q> { hessian, gradients }.take(&viscosity);
            }
            complete(&mut lanes);
            self.body.scatter(group, &lanes, damping);
        }
    }
}

impl<const N: usize, const D: usize, const R: usize, const Q: usize> StrainRate<N, D, R, Q> {
    /// `F (2 eta S' + zeta tr S' I)`, times a weight.
    #[inline(always)]
    fn stress(
        &self,
        x: &[[Lanes; D]; N],
        u: &[[Lanes; D]; N],
        gradients: &[[Lanes; R]; N],
        weight: Lanes,
    ) -> [[Lanes; D]; R] {
        let f = deformation(x, gradients);
        let rate = deformation(u, gradients);
        let strain: [[Lanes; R]; R] =
            array(|k| array(|l| (dot(&f[k], &rate[l]) + dot(&f[l], &rate[k])) * 0.5));
        let pressure = trace(&strain) * weight * self.pair().lambda();
        let stress = scaled(&strain, weight * (2.0 * self.pair().mu()));
        product(&f, &shifted(stress, pressure))
    }
}

/// The second derivative of half the dissipated power by the velocities.
struct Viscosity<const D: usize, const R: usize> {
    f: [[Lanes; D]; R],
    spread: [[Lanes; D]; D],
    pair: [Lanes; 2],
}

impl<const D: usize, const R: usize> Tangent<Lanes, D, R> for Viscosity<D, R> {
    type Node = ([Lanes; R], [Lanes; D]);

    #[inline(always)]
    fn node(&self, gradient: &[Lanes; R]) -> Self::Node {
        (*gradient, apply(&self.f, gradient))
    }

    #[inline(always)]
    fn block(&self, a: &Self::Node, b: &Self::Node) -> [[Lanes; D]; D] {
        let shear = (self.pair[1] * dot(&a.0, &b.0), &self.spread);
        hookean_block(self.pair, &a.1, &b.1, shear, Lanes::splat(0.0))
    }
}

/// Damping in proportion to mass and to stiffness.
#[derive(Clone, Debug)]
pub struct Rayleigh<M, P> {
    alpha: f64,
    beta: f64,
    metric: M,
    stiffness: P,
}

impl<M: Metric, P: Potential> Rayleigh<M, P> {
    /// `alpha` in 1/s times the mass, `beta` in s times the Hessian of a potential.
    ///
    /// # Errors
    /// [`ElasticityError::Damping`] for a part that is negative or not finite;
    /// [`ElasticityError::Freedoms`] unless metric and potential have the same number.
    pub fn new([alpha, beta]: [f64; 2], metric: M, stiffness: P) -> Result<Self, ElasticityError> {
        for damping in [alpha, beta] {
            if !(damping >= 0.0 && damping.is_finite()) {
                return Err(ElasticityError::Damping(damping));
            }
        }
        let (expected, got) = (metric.dim(), stiffness.dim());
        if expected != got {
            return Err(ElasticityError::Freedoms { expected, got });
        }
        Ok(Rayleigh { alpha, beta, metric, stiffness })
    }
}

impl<M: Metric, P: Potential> Force for Rayleigh<M, P> {
    fn dim(&self) -> usize {
        self.metric.dim()
    }

    /// NaN in every component where any of the three is too short.
    fn add_force(&self, _t: f64, q: &[f64], v: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        let n = self.dim();
        if q.len().min(v.0.len()).min(f.0.len()) < n {
            return f.0.fill(f64::NAN);
        }
        let (v, f) = (Vector(&v.0[..n]), Covector(&mut f.0[..n]));
        if let Some(mut sink) = ProductSink::new(-self.alpha, v.0, &mut *f.0) {
            self.metric.add_matrix(&mut sink);
        }
        if let Some(mut sink) = ProductSink::new(-self.beta, v.0, f.0) {
            self.stiffness.add_hessian(q, &mut sink);
        }
    }

    fn add_damping(&self, _t: f64, q: &[f64], _v: Vector<&[f64]>, damping: &mut impl Sink) {
        self.metric.add_matrix(&mut Scaled::new(self.alpha, damping));
        self.stiffness.add_hessian(q, &mut Scaled::new(self.beta, damping));
    }
}
