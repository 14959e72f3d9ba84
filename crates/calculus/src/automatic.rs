//! Potentials by automatic differentiation: the energy written once, its derivatives exact.
//!
//! ```text
//! V(q + eps_1 v + eps_2 w) = V + eps_1 dV(v) + eps_2 dV(w) + eps_1 eps_2 d2V(v, w)
//!                            with eps_1^2 = eps_2^2 = 0
//! ```
//! An energy is written over any [`Number`]; evaluated at numbers that carry infinitesimal parts it
//! gives dV and d2V exact to rounding, on the stack. [`Automatic`] makes a [`Potential`] of an energy
//! of N freedoms, [`AutomaticStencil`] a [`Stencil`] of an energy of V vertices.
//!
//! A differential costs N evaluations at numbers of two parts, a Hessian N (N + 1)/2 at numbers of
//! four, tens of times the closed form of a tetrahedron: right for cold terms and as the oracle of
//! what is written by hand, wrong inside a loop over many elements. Where an energy branches, the
//! derivative is that of the branch taken.
//! Source: notes 2.4; hyper-dual numbers after Fike and Alonso (2011).

use num_dual::{Dual64, HyperDual64};

use crate::{
    Covector, Curvature, Number, Potential, Sink, Stencil, StencilHessian, array,
    project_semidefinite,
};

/// An energy of N freedoms, written once over any [`Number`].
pub trait Energy<const N: usize> {
    /// The energy at `q`, in joules.
    fn energy<R: Number>(&self, q: [R; N]) -> R;
}

/// The potential of an [`Energy`] of N freedoms.
///
/// ```
/// use stationary_calculus::{Automatic, Energy, Number, assert_derivatives};
/// /// A pendulum: V = -m g L cos(theta), theta from hanging.
/// struct Pendulum {
///     weight: f64,
///     length: f64,
/// }
/// impl Energy<1> for Pendulum {
///     fn energy<R: Number>(&self, [theta]: [R; 1]) -> R {
///         -theta.cos() * self.weight * self.length
///     }
/// }
/// let potential = Automatic(Pendulum { weight: 9.81, length: 0.5 });
/// assert_derivatives(&potential, &[0.3]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Automatic<E, const N: usize>(pub E);

impl<E: Energy<N>, const N: usize> Potential for Automatic<E, N> {
    fn dim(&self) -> usize {
        N
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        self.0.energy::<f64>(coordinates(q))
    }

    #[inline]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let q = coordinates::<N>(q).map(Dual64::from_re);
        for (i, sum) in dv.0.iter_mut().enumerate().take(N) {
            let mut q = q;
            q[i].eps = 1.0;
            *sum += self.0.energy(q).eps;
        }
    }

    #[inline]
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let q = coordinates::<N>(q).map(HyperDual64::from_re);
        let mut block = [[0.0; N]; N];
        for (i, j) in pairs(N) {
            let mut q = q;
            (q[i].eps1, q[j].eps2) = (1.0, 1.0);
            let entry = self.0.energy(q).eps1eps2;
            (block[i][j], block[j][i]) = (entry, entry);
        }
        hessian.add_symmetric(&array::<usize, N>(|i| i), block.as_flattened());
    }
}

/// The pairs i <= j of freedoms below n.
fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(|j| (0..=j).map(move |i| (i, j)))
}

fn coordinates<const N: usize>(q: &[f64]) -> [f64; N] {
    array(|i| q[i])
}

/// An energy of V vertices in D dimensions, written once over any [`Number`].
pub trait StencilEnergy<const V: usize, const D: usize> {
    /// The vertices it joins.
    fn vertices(&self) -> [usize; V];

    /// Its energy, in joules, at the vertices' positions.
    fn energy<R: Number>(&self, x: [[R; D]; V]) -> R;
}

/// The stencil of a [`StencilEnergy`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AutomaticStencil<E>(pub E);

impl<E: StencilEnergy<V, D>, const V: usize, const D: usize> Stencil<V, D> for AutomaticStencil<E> {
    fn vertices(&self) -> [usize; V] {
        self.0.vertices()
    }

    #[inline]
    fn energy(&self, x: &[[f64; D]; V]) -> f64 {
        self.0.energy::<f64>(*x)
    }

    #[inline]
    fn differential(&self, x: &[[f64; D]; V]) -> [[f64; D]; V] {
        let x = x.map(|point| point.map(Dual64::from_re));
        let along = |a: usize, c: usize| {
            let mut x = x;
            x[a][c].eps = 1.0;
            self.0.energy(x).eps
        };
        array(|a| array(|c| along(a, c)))
    }

    #[inline]
    fn hessian(&self, x: &[[f64; D]; V], curvature: Curvature) -> StencilHessian<V, D> {
        let x = x.map(|point| point.map(HyperDual64::from_re));
        let mut hessian = [[[[0.0; D]; V]; D]; V];
        for (i, j) in pairs(V * D) {
            let ((a, c), (b, d)) = ((i / D, i % D), (j / D, j % D));
            let mut x = x;
            (x[a][c].eps1, x[b][d].eps2) = (1.0, 1.0);
            let entry = self.0.energy(x).eps1eps2;
            (hessian[a][c][b][d], hessian[b][d][a][c]) = (entry, entry);
        }
        match curvature {
            Curvature::Exact => hessian,
            Curvature::Semidefinite => project_semidefinite(&hessian),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ProductSink, Stencils, assert_derivatives};
    use stationary_measure::SplitMix64;

    /// 1/2 k (|x1 - x0| - L)^2 in D dimensions.
    struct Spring {
        stiffness: f64,
        rest_length: f64,
    }

    fn square<R: Number, const D: usize>(x: [R; D]) -> R {
        x.iter().fold(R::from(0.0), |sum, &x| sum + x * x)
    }

    fn apart<R: Number, const D: usize>(x: [[R; D]; 2]) -> [R; D] {
        std::array::from_fn(|c| x[1][c] - x[0][c])
    }

    impl<const D: usize> StencilEnergy<2, D> for Spring {
        fn vertices(&self) -> [usize; 2] {
            [0, 1]
        }

        fn energy<R: Number>(&self, x: [[R; D]; 2]) -> R {
            let stretch = square(apart(x)).sqrt() - self.rest_length;
            stretch * stretch * (0.5 * self.stiffness)
        }
    }

    /// A rigid rod as a constraint energy: 1/2 k (|x1 - x0|^2 - L^2)^2.
    struct Rod;

    impl StencilEnergy<2, 3> for Rod {
        fn vertices(&self) -> [usize; 2] {
            [0, 1]
        }

        fn energy<R: Number>(&self, x: [[R; 3]; 2]) -> R {
            let g = square(apart(x)) - 0.8 * 0.8;
            g * g * 50.0
        }
    }

    /// A linear tetrahedron with the vertices 0, e_1, e_2, e_3 at rest and Saint Venant-Kirchhoff
    /// energy: mu |E|^2 + lambda/2 (tr E)^2 over the volume 1/6, with E = (F^T F - I)/2.
    struct Tetrahedron {
        lambda: f64,
        mu: f64,
    }

    impl StencilEnergy<4, 3> for Tetrahedron {
        fn vertices(&self) -> [usize; 4] {
            [0, 1, 2, 3]
        }

        fn energy<R: Number>(&self, x: [[R; 3]; 4]) -> R {
            let f = [1, 2, 3].map(|a| apart([x[0], x[a]]));
            let mut squares = R::from(0.0);
            let mut trace = R::from(0.0);
            for i in 0..3 {
                for j in 0..3 {
                    let identity = if i == j { 1.0 } else { 0.0 };
                    let product = f[i][0] * f[j][0] + f[i][1] * f[j][1] + f[i][2] * f[j][2];
                    let e = (product - identity) * 0.5;
                    squares += e * e;
                    if i == j {
                        trace += e;
                    }
                }
            }
            (squares * self.mu + trace * trace * (0.5 * self.lambda)) / 6.0
        }
    }

    fn positions<const V: usize>(size: f64, seed: u64) -> [[f64; 3]; V] {
        let mut random = SplitMix64::new(seed);
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        std::array::from_fn(|a| corners[a].map(|x| x + size * random.symmetric()))
    }

    fn largest(entries: &[f64]) -> f64 {
        entries.iter().fold(0.0, |m, x| m.max(x.abs()))
    }

    fn flat<const V: usize, const D: usize>(hessian: &StencilHessian<V, D>) -> &[f64] {
        hessian.as_flattened().as_flattened().as_flattened()
    }

    fn close<const V: usize, const D: usize>(
        a: &StencilHessian<V, D>,
        b: &StencilHessian<V, D>,
    ) -> bool {
        let off: Vec<f64> = flat(a).iter().zip(flat(b)).map(|(a, b)| a - b).collect();
        largest(&off) <= 1e-13 * largest(flat(b))
    }

    /// k [u u^T + (1 - L/l)(I - u u^T)], with the opposite sign between the ends.
    #[test]
    fn a_spring_has_the_hessian_of_the_closed_form() {
        let (k, rest) = (7.0, 0.9);
        let spring = AutomaticStencil(Spring { stiffness: k, rest_length: rest });
        for seed in 0..20 {
            let x: [[f64; 3]; 2] = positions(0.3, seed);
            let d = apart(x);
            let l = square(d).sqrt();
            let by_hand: StencilHessian<2, 3> = std::array::from_fn(|b| {
                std::array::from_fn(|j| {
                    std::array::from_fn(|a| {
                        std::array::from_fn(|i| {
                            let (delta, uu) = (f64::from(u8::from(i == j)), d[i] * d[j] / (l * l));
                            let entry = k * (uu + (1.0 - rest / l) * (delta - uu));
                            if a == b { entry } else { -entry }
                        })
                    })
                })
            });
            assert!(close(&spring.hessian(&x, Curvature::Exact), &by_hand));
            let force = d.map(|d| k * (l - rest) * d / l);
            let differential = spring.differential(&x);
            for c in 0..3 {
                assert!((differential[1][c] - force[c]).abs() < 1e-13);
                assert!((differential[0][c] + force[c]).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn springs_rods_and_tetrahedra_have_right_derivatives() {
        fn checked<E: StencilEnergy<V, 3>, const V: usize>(energy: E) {
            let potential = Stencils::new(V, vec![], vec![AutomaticStencil(energy)]).unwrap();
            for (size, seed) in [(0.0, 0), (1e-9, 1), (0.1, 2), (0.3, 3)] {
                assert_derivatives(&potential, positions::<V>(size, seed).as_flattened());
            }
        }
        checked::<_, 2>(Spring { stiffness: 1e6, rest_length: 1.0 });
        checked::<_, 2>(Rod);
        checked::<_, 4>(Tetrahedron { lambda: 1.0, mu: 1.0 });
        checked::<_, 4>(Tetrahedron { lambda: 5e9, mu: 1e9 });
    }

    /// Unstrained, the Hessian is that of linear elasticity: stretching the edge e_1 costs
    /// (lambda + 2 mu)/6, and rigid motions cost nothing.
    #[test]
    fn an_unstrained_tetrahedron_has_the_stiffness_of_linear_elasticity() {
        let tetrahedron = AutomaticStencil(Tetrahedron { lambda: 2.0, mu: 3.0 });
        let hessian = tetrahedron.hessian(&positions(0.0, 0), Curvature::Exact);
        assert!((hessian[1][0][1][0] - (2.0 + 2.0 * 3.0) / 6.0).abs() < 1e-15);
        let x: [[f64; 3]; 4] = positions(0.0, 0);
        let motions = [x.map(|_| [1.0, 2.0, 3.0]), x.map(|[x, y, z]| [y - z, z - x, x - y])];
        for motion in &motions {
            let mut force = [0.0; 12];
            let mut sink = ProductSink::new(1.0, motion.as_flattened(), &mut force).unwrap();
            sink.add_symmetric(&std::array::from_fn::<usize, 12, _>(|i| i), flat(&hessian));
            assert!(largest(&force) < 1e-14);
        }
    }

    #[test]
    fn the_semidefinite_hessian_is_the_projection_of_the_exact_one() {
        let spring = AutomaticStencil(Spring { stiffness: 7.0, rest_length: 2.0 });
        let x: [[f64; 3]; 2] = positions(0.3, 1);
        let exact: StencilHessian<2, 3> = spring.hessian(&x, Curvature::Exact);
        let projected = spring.hessian(&x, Curvature::Semidefinite);
        assert_eq!(projected, project_semidefinite(&exact));
        // Compressed, a spring is unstable sideways: only k u u^T is left.
        let d = apart(x);
        let stiffness = 7.0 * d[0] * d[1] / square(d);
        assert!((projected[0][1][0][0] - stiffness).abs() < 1e-14);
    }

    /// Two masses on a line, a spring and a well, once by hand and once as an energy of two numbers.
    struct Pair;

    impl Energy<2> for Pair {
        fn energy<R: Number>(&self, [a, b]: [R; 2]) -> R {
            let stretch = b - a - 1.0;
            stretch * stretch * 2.0 - a.cos()
        }
    }

    #[test]
    fn a_potential_of_two_numbers_has_the_derivatives_of_the_closed_form() {
        let (potential, [a, b]) = (Automatic(Pair), [0.4, 1.9]);
        let mut dv = Covector([10.0, 20.0]);
        potential.add_differential(&[a, b], dv.view_mut());
        let force = 4.0 * (b - a - 1.0);
        assert!((dv.0[0] - (10.0 - force + a.sin())).abs() < 1e-14);
        assert!((dv.0[1] - (20.0 + force)).abs() < 1e-14);
        let mut y = [0.0; 2];
        potential.add_hessian(&[a, b], &mut ProductSink::new(1.0, &[1.0, 0.0], &mut y).unwrap());
        assert!((y[0] - (4.0 + a.cos())).abs() < 1e-14 && (y[1] + 4.0).abs() < 1e-14);
        assert_derivatives(&potential, &[a, b]);
        assert_derivatives(&potential, &[0.0, 1.0]);
    }

    #[test]
    fn both_wrappers_give_the_same_derivatives() {
        /// The rod as an energy of six numbers.
        struct Flattened;
        impl Energy<6> for Flattened {
            fn energy<R: Number>(&self, [a, b, c, d, e, f]: [R; 6]) -> R {
                Rod.energy([[a, b, c], [d, e, f]])
            }
        }
        let x: [[f64; 3]; 2] = positions(0.2, 4);
        let block = AutomaticStencil(Rod).hessian(&x, Curvature::Exact);
        for j in 0..6 {
            let (mut unit, mut y) = ([0.0; 6], [0.0; 6]);
            unit[j] = 1.0;
            let mut sink = ProductSink::new(1.0, &unit, &mut y).unwrap();
            Automatic(Flattened).add_hessian(x.as_flattened(), &mut sink);
            let column = &flat(&block)[6 * j..][..6];
            assert!(y.iter().zip(column).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }
}
