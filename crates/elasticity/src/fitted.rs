//! How the energy of a body answers to the numbers of its material: for those who fit them.
//!
//! ```text
//! dV/dp_k            = sum w dW/dp_k(F)                 J per unit of p_k
//! d/dp_k {dV(q)}(v)  = sum w d2W/dp_k dF : grad v       what the force along v does
//! ```
//! `p` the parameters of a material (K of them), `v` a displacement (n). Exact, by forward automatic
//! differentiation of the energy density in p and along v. With an equilibrium dV(q) = f, the position
//! answers by `dq/dp_k = -H^-1 d(dV)/dp_k`: a solve with the Hessian, or, for one measured number g(q),
//! the second formula along `v = -H^-1 dg`, which costs one solve for all parameters. One element at a
//! time: not for the inside of a step. Source: notes 2.1-2.4; the adjoint method after Lions (1971).

use num_dual::{Dual64, HyperDual64};
use stationary_calculus::{Number, array};

use crate::group::deformation;
use crate::{ElasticityError, Lanes, Material, Real, SaintVenantKirchhoff, Solid};
use crate::{Linear, NeoHookean};

/// A material known by `K` numbers.
pub trait Fitted<const D: usize, const R: usize, const K: usize>: Material<D, R> {
    /// The numbers.
    fn parameters(&self) -> [f64; K];

    /// The energy density at F, by columns, of the material of these numbers.
    fn density<N: Number>(parameters: &[N; K], f: &[[N; D]; R]) -> N;
}

impl<M, const N: usize, const D: usize, const R: usize, const Q: usize> Solid<M, N, D, R, Q> {
    /// The derivative of the energy by each parameter of the material.
    ///
    /// # Errors
    /// [`ElasticityError::Freedoms`] unless `q` has a number for each freedom.
    pub fn energy_by_parameters<const K: usize>(
        &self,
        q: &[f64],
    ) -> Result<[f64; K], ElasticityError>
    where
        M: Fitted<D, R, K>,
    {
        self.freedoms().check(q.len())?;
        let parameters = self.material().parameters();
        let mut sums = [0.0; K];
        self.visit_points(q, q, |f, _, weight| {
            for (k, sum) in sums.iter_mut().enumerate() {
                let mut p = parameters.map(Dual64::from_re);
                p[k].eps = 1.0;
                let f = f.map(|column| column.map(Dual64::from_re));
                *sum += weight * M::density(&p, &f).eps;
            }
        });
        Ok(sums)
    }

    /// The derivative by each parameter of the differential along a displacement `v`, of which held
    /// coordinates have none.
    ///
    /// # Errors
    /// [`ElasticityError::Freedoms`] unless `q` and `v` have a number for each freedom.
    pub fn differential_by_parameters<const K: usize>(
        &self,
        q: &[f64],
        v: &[f64],
    ) -> Result<[f64; K], ElasticityError>
    where
        M: Fitted<D, R, K>,
    {
        self.freedoms().check(q.len())?;
        self.freedoms().check(v.len())?;
        let parameters = self.material().parameters();
        let mut sums = [0.0; K];
        self.visit_points(q, v, |f, rate, weight| {
            for (k, sum) in sums.iter_mut().enumerate() {
                let mut p = parameters.map(HyperDual64::from_re);
                p[k].eps1 = 1.0;
                let mut along = f.map(|column| column.map(HyperDual64::from_re));
                for (entries, rates) in along.iter_mut().zip(rate) {
                    for (entry, rate) in entries.iter_mut().zip(rates) {
                        entry.eps2 = *rate;
                    }
                }
                *sum += weight * M::density(&p, &along).eps1eps2;
            }
        });
        Ok(sums)
    }

    /// F, its rate along v, and the weight, at each point of each element.
    fn visit_points(
        &self,
        q: &[f64],
        v: &[f64],
        mut see: impl FnMut(&[[f64; D]; R], &[[f64; D]; R], f64),
    ) where
        M: Material<D, R>,
    {
        let resting = self.freedoms().resting();
        for group in &self.groups {
            let x = group.corners(self.freedoms(), q);
            let u = group.corners(&resting, v);
            for (gradients, weight) in group.gradients.iter().zip(&group.weights) {
                let (f, rate) = (deformation(&x, gradients), deformation(&u, gradients));
                for lane in 0..group.filled {
                    let of = |tensor: &[[Lanes; D]; R]| {
                        tensor.map(|column| column.map(|entry| entry.lane(lane)))
                    };
                    see(&of(&f), &of(&rate), weight.lane(lane));
                }
            }
        }
    }
}

/// `F - I`.
fn displacement_gradient<N: Number, const D: usize, const R: usize>(
    f: &[[N; D]; R],
) -> [[N; D]; R] {
    let mut g = *f;
    for (k, column) in g.iter_mut().enumerate() {
        column[k] -= 1.0;
    }
    g
}

/// `F^T F - I = G + G^T + G^T G`, without cancellation near rest.
fn twice_green<N: Number, const D: usize, const R: usize>(f: &[[N; D]; R]) -> [[N; R]; R] {
    let g = displacement_gradient(f);
    array(|k| array(|l| (0..D).fold(g[k][l] + g[l][k], |sum, i| sum + g[k][i] * g[l][i])))
}

/// `mu tr S^2 + lambda/2 (tr S)^2`.
fn quadratic<N: Number, const R: usize>([lambda, mu]: &[N; 2], strain: &[[N; R]; R]) -> N {
    let (mut square, mut trace) = (N::from(0.0), N::from(0.0));
    for k in 0..R {
        trace += strain[k][k];
        for l in 0..R {
            square += strain[k][l] * strain[k][l];
        }
    }
    *mu * square + *lambda * trace * trace * 0.5
}

/// Lame's pair: lambda and mu, Pa.
impl<const D: usize, const R: usize> Fitted<D, R, 2> for SaintVenantKirchhoff<R> {
    fn parameters(&self) -> [f64; 2] {
        [self.lame().lambda(), self.lame().mu()]
    }

    fn density<N: Number>(parameters: &[N; 2], f: &[[N; D]; R]) -> N {
        let half = twice_green(f).map(|column| column.map(|entry| entry * 0.5));
        quadratic(parameters, &half)
    }
}

/// Lame's pair: lambda and mu, Pa.
impl<const D: usize> Fitted<D, D, 2> for Linear<D> {
    fn parameters(&self) -> [f64; 2] {
        [self.lame().lambda(), self.lame().mu()]
    }

    fn density<N: Number>(parameters: &[N; 2], f: &[[N; D]; D]) -> N {
        let strain: [[N; D]; D] =
            array(|k| array(|l| (f[k][l] + f[l][k]) * 0.5 - if k == l { 1.0 } else { 0.0 }));
        quadratic(parameters, &strain)
    }
}

/// Lame's pair: lambda and mu, Pa.
impl<const D: usize> Fitted<D, D, 2> for NeoHookean<D> {
    fn parameters(&self) -> [f64; 2] {
        [self.lame().lambda(), self.lame().mu()]
    }

    fn density<N: Number>([lambda, mu]: &[N; 2], f: &[[N; D]; D]) -> N {
        let d = D as f64;
        let g = displacement_gradient(f);
        let (mut plain, mut square) = (N::from(0.0), N::from(0.0));
        for k in 0..D {
            plain += g[k][k];
            for i in 0..D {
                square += g[k][i] * g[k][i];
            }
        }
        // J - 1 = tr G + beyond, I - d = 2 tr G + |G|^2: the traces cancel.
        let beyond = growth_beyond_trace(&g);
        let growth = plain + beyond;
        let volume = *lambda + *mu * (1.0 - 2.0 / (d * (d + 1.0)));
        let softened = excess_over_log((plain * 2.0 + square) / (d + 1.0));
        *mu * (square * 0.5 - beyond + softened * (0.5 * (d + 1.0) / d))
            + volume * growth * growth * 0.5
    }
}

/// `II(G) + det G` in space, `det G` in the plane.
fn growth_beyond_trace<N: Number, const D: usize>(g: &[[N; D]; D]) -> N {
    let minor = |i: usize, j: usize| g[i][i] * g[j][j] - g[i][j] * g[j][i];
    if D == 2 { minor(0, 1) } else { minor(0, 1) + minor(1, 2) + minor(2, 0) + determinant(g) }
}

/// `y - log(1 + y)`: near zero by the series of `atanh r`, `r = y/(2 + y)`.
fn excess_over_log<N: Number>(y: N) -> N {
    if y.re().abs() > 0.3 {
        return y - y.ln_1p();
    }
    let r = y / (y + 2.0);
    let t = r * r;
    // r < 0.18: the terms from the twelfth on are below rounding.
    let sum =
        (1..12).rev().fold(N::from(0.0), |sum, k| (sum + 1.0 / (2.0 * f64::from(k) + 1.0)) * t);
    r * (y - sum * 2.0)
}

/// In space.
fn determinant<N: Number, const D: usize>(f: &[[N; D]; D]) -> N {
    (0..D).fold(N::from(0.0), |sum, i| {
        let (j, k) = ((i + 1) % D, (i + 2) % D);
        sum + f[0][i] * (f[1][j] * f[2][k] - f[1][k] * f[2][j])
    })
}
