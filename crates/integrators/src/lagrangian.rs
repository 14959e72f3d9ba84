//! Continuous Lagrangians: one function of configuration and velocity, and the motion it implies.
//!
//! ```text
//! L(q, v)                               kinetic less potential energy, joules            (5.1)
//! p = dL/dv,    E = <p, v> - L          momentum and energy
//! d/dt (dL/dv) = dL/dq                  the Euler-Lagrange equations                     (5.3)
//! d2L/dv2 a = dL/dq - d2L/dvdq v        solved for the acceleration a
//! ```
//! `q` configuration (N), `v` velocity vector (N), `p` momentum covector (N), `a` the derivative of
//! v (N). L is written once over any [`Number`] and differentiated automatically, so that a kinetic
//! energy may depend on q in any way: angles of linkages, polar coordinates, rotating frames.
//!
//! Acceleration and velocity are defined where d2L/dv2 is invertible; where it is not, they are a
//! [`LagrangianError`]. An acceleration costs some N^2/2 evaluations: right for a few freedoms. L
//! does not depend on time. Source: notes 5.1 to 5.3.

use stationary_calculus::{
    Covector, DenseLu, FunctionEquation, Newton, NewtonError, Number, SizeError, Unsolvable,
    Vector, array, directional_derivative, first_non_finite, second_differential,
};

use crate::integrator::newton_memory;

/// A Lagrangian of N freedoms, written once over any [`Number`].
pub trait Lagrangian<const N: usize> {
    /// L(q, v), joules.
    fn value<R: Number>(&self, q: [R; N], v: [R; N]) -> R;

    /// The momentum `dL/dv`.
    fn momentum(&self, q: [f64; N], v: Vector<[f64; N]>) -> Covector<[f64; N]> {
        Covector(array(|i| {
            let along = |[s]: [_; 1]| self.value(constant(q), moved(v.0, i, s));
            directional_derivative(along, [0.0], ALONG)
        }))
    }

    /// The differential `dL/dq` at a fixed velocity.
    fn differential(&self, q: [f64; N], v: Vector<[f64; N]>) -> Covector<[f64; N]> {
        Covector(array(|i| {
            let along = |[s]: [_; 1]| self.value(moved(q, i, s), constant(v.0));
            directional_derivative(along, [0.0], ALONG)
        }))
    }

    /// The energy `<p, v> - L`, joules.
    fn energy(&self, q: [f64; N], v: Vector<[f64; N]>) -> f64 {
        self.momentum(q, v).apply(&v) - self.value(q, v.0)
    }
}

impl<L: Lagrangian<N>, const N: usize> Lagrangian<N> for &L {
    fn value<R: Number>(&self, q: [R; N], v: [R; N]) -> R {
        L::value(self, q, v)
    }
}

/// The direction of a function of one number, and the two of a function of two.
pub(crate) const ALONG: Vector<[f64; 1]> = Vector([1.0]);
pub(crate) const FIRST: Vector<[f64; 2]> = Vector([1.0, 0.0]);
pub(crate) const SECOND: Vector<[f64; 2]> = Vector([0.0, 1.0]);

/// A configuration or velocity that does not move.
fn constant<R: Number, const N: usize>(x: [f64; N]) -> [R; N] {
    x.map(R::from)
}

/// A configuration or velocity that is moved by `s` along its freedom `i`.
fn moved<R: Number, const N: usize>(x: [f64; N], i: usize, s: R) -> [R; N] {
    let mut x = constant(x);
    x[i] += s;
    x
}

/// What a Lagrangian does not determine.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LagrangianError {
    /// The second differential of the Lagrangian by the velocity is singular or not finite.
    #[error("the Lagrangian determines no acceleration here: {0}")]
    Acceleration(Unsolvable),
    /// The acceleration is not finite.
    #[error("the acceleration is not finite, first at freedom {freedom}")]
    NonFiniteAcceleration {
        /// The first such freedom.
        freedom: usize,
    },
    /// The storage does not have the Lagrangian's size.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// No velocity was found that has the momentum.
    #[error("no velocity has this momentum: {0}")]
    Velocity(#[from] NewtonError),
    /// The momentum or the configuration is not finite.
    #[error("the {what} is not finite, first at freedom {freedom}")]
    NonFinite {
        /// Which of them.
        what: &'static str,
        /// The first such freedom.
        freedom: usize,
    },
}

/// The Euler-Lagrange equations of a Lagrangian, solved for what they determine.
#[derive(Clone, Debug)]
pub struct EulerLagrange<L, const N: usize> {
    lagrangian: L,
    lu: DenseLu,
}

impl<L: Lagrangian<N>, const N: usize> EulerLagrange<L, N> {
    /// The equations of a Lagrangian.
    pub fn new(lagrangian: L) -> Self {
        EulerLagrange { lagrangian, lu: DenseLu::new(N) }
    }

    /// The Lagrangian.
    pub fn lagrangian(&self) -> &L {
        &self.lagrangian
    }

    /// The acceleration, in the units of the velocity per second.
    ///
    /// # Errors
    /// Where d2L/dv2 is singular, or a number is not finite.
    pub fn acceleration(
        &mut self,
        q: [f64; N],
        v: Vector<[f64; N]>,
    ) -> Result<Vector<[f64; N]>, LagrangianError> {
        let Covector(mut a) = self.lagrangian.differential(q, v);
        for (i, a) in a.iter_mut().enumerate() {
            *a -= self.momentum_along_the_motion(q, v, i);
        }
        mass(&self.lagrangian, q, v, self.lu.matrix());
        self.lu.factor().map_err(LagrangianError::Acceleration)?;
        self.lu.solve(&mut a);
        match first_non_finite(&a) {
            Some(freedom) => Err(LagrangianError::NonFiniteAcceleration { freedom }),
            None => Ok(Vector(a)),
        }
    }

    /// Row i of `d2L/dvdq v`: how the momentum changes where q moves along v and v stays.
    fn momentum_along_the_motion(&self, q: [f64; N], v: Vector<[f64; N]>, i: usize) -> f64 {
        let both = |[s, t]: [_; 2]| {
            let q = array(|k| t * v.0[k] + q[k]);
            self.lagrangian.value(q, moved(v.0, i, s))
        };
        second_differential(both, [0.0; 2], FIRST, SECOND)
    }

    /// The velocity whose momentum is `p`: the inverse Legendre transform. Takes memory; not for
    /// the inside of a step.
    ///
    /// # Errors
    /// Where Newton's method finds none, or a number is not finite.
    pub fn velocity(
        &self,
        q: [f64; N],
        p: Covector<[f64; N]>,
    ) -> Result<Vector<[f64; N]>, LagrangianError> {
        for (what, numbers) in [("configuration", &q), ("momentum", &p.0)] {
            if let Some(freedom) = first_non_finite(numbers) {
                return Err(LagrangianError::NonFinite { what, freedom });
            }
        }
        let newton = Newton::default();
        let mut memory = newton_memory::<[f64; N]>(N, newton)?;
        let at = |v: &[f64]| Vector(array(|i| v[i]));
        let residual = |v: &[f64], f: &mut [f64]| {
            let momentum = self.lagrangian.momentum(q, at(v));
            (0..N).for_each(|i| f[i] = momentum.0[i] - p.0[i]);
        };
        let jacobian = |v: &[f64], m: &mut [f64]| mass(&self.lagrangian, q, at(v), m);
        let mut v = [0.0; N];
        newton.solve(&mut FunctionEquation::new(N, residual, jacobian), &mut v, &mut memory)?;
        Ok(Vector(v))
    }
}

/// Writes `d2L/dv2`, N x N by columns: the mass, where L is quadratic in the velocity.
fn mass<L: Lagrangian<N>, const N: usize>(
    lagrangian: &L,
    q: [f64; N],
    v: Vector<[f64; N]>,
    matrix: &mut [f64],
) {
    for j in 0..N {
        for i in 0..=j {
            let both = |[s, t]: [_; 2]| {
                let mut v = moved(v.0, i, s);
                v[j] += t;
                lagrangian.value(constant(q), v)
            };
            let entry = second_differential(both, [0.0; 2], FIRST, SECOND);
            (matrix[i + N * j], matrix[j + N * i]) = (entry, entry);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A free particle of mass 2 in polar coordinates: L = r'^2 + r^2 theta'^2.
    struct Polar;

    impl Lagrangian<2> for Polar {
        fn value<R: Number>(&self, [r, _]: [R; 2], [radial, turning]: [R; 2]) -> R {
            radial * radial + r * r * turning * turning
        }
    }

    #[test]
    fn a_free_particle_has_the_accelerations_of_polar_coordinates() {
        let (q, v) = ([1.7, 0.4], Vector([-0.6, 0.9]));
        let a = EulerLagrange::new(Polar).acceleration(q, v).unwrap();
        assert!((a.0[0] - q[0] * v.0[1] * v.0[1]).abs() < 1e-14);
        assert!((a.0[1] + 2.0 * v.0[0] * v.0[1] / q[0]).abs() < 1e-14);
    }

    #[test]
    fn momentum_and_energy_are_those_of_the_closed_form() {
        let (q, v) = ([1.7, 0.4], Vector([-0.6, 0.9]));
        let p = Polar.momentum(q, v);
        assert!((p.0[0] - 2.0 * v.0[0]).abs() < 1e-15);
        assert!((p.0[1] - 2.0 * q[0] * q[0] * v.0[1]).abs() < 1e-15);
        assert!((Polar.energy(q, v) - Polar.value(q, v.0)).abs() < 1e-14);
    }

    #[test]
    fn the_velocity_of_a_momentum_has_that_momentum() {
        let (q, v) = ([1.7, 0.4], Vector([-0.6, 0.9]));
        let found = EulerLagrange::new(Polar).velocity(q, Polar.momentum(q, v)).unwrap();
        assert!((0..2).all(|i| (found.0[i] - v.0[i]).abs() < 1e-15));
    }

    /// A particle at nearly the speed of light 1: L = -sqrt(1 - v^2), not quadratic in v.
    struct Relativistic;

    impl Lagrangian<1> for Relativistic {
        fn value<R: Number>(&self, _: [R; 1], [v]: [R; 1]) -> R {
            -(-v * v + 1.0).sqrt()
        }
    }

    #[test]
    fn the_velocity_is_found_where_the_momentum_is_not_linear_in_it() {
        let equations = EulerLagrange::new(Relativistic);
        let v = equations.velocity([0.0], Covector([2.0])).unwrap();
        // p = v / sqrt(1 - v^2)
        assert!((v.0[0] - 2.0 / 5.0_f64.sqrt()).abs() < 1e-15);
    }

    /// Only the sum of the velocities has energy.
    struct Degenerate;

    impl Lagrangian<2> for Degenerate {
        fn value<R: Number>(&self, [x, y]: [R; 2], [u, v]: [R; 2]) -> R {
            (u + v) * (u + v) - x * x - y * y
        }
    }

    #[test]
    fn a_lagrangian_without_a_mass_determines_no_acceleration() {
        let mut equations = EulerLagrange::new(Degenerate);
        let error = equations.acceleration([0.3, 0.1], Vector([0.5, 0.2])).unwrap_err();
        assert_eq!(error, LagrangianError::Acceleration(Unsolvable::Singular));
        let error = equations.velocity([0.3, 0.1], Covector([1.0, 0.0])).unwrap_err();
        assert!(matches!(error, LagrangianError::Velocity(_)), "{error}");
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused_by_name() {
        let mut equations = EulerLagrange::new(Polar);
        let error = equations.acceleration([f64::NAN, 0.0], Vector([0.0; 2])).unwrap_err();
        assert_eq!(error, LagrangianError::Acceleration(Unsolvable::NonFinite));
        let error = equations.velocity([1.0, 0.0], Covector([0.0, f64::NAN])).unwrap_err();
        assert_eq!(error, LagrangianError::NonFinite { what: "momentum", freedom: 1 });
    }
}
