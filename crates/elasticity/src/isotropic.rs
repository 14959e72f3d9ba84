//! Isotropic materials by their principal stretches: the eigenvalues of the second derivative.
//!
//! ```text
//! F = U diag(s) V^T,  W = w(s_1 ... s_R)           s signed: negative where F turns inside out
//! scaling   u_i v_i^T                              w_ij, an R x R matrix
//! twist     (u_i v_j^T - u_j v_i^T)/sqrt 2         (w_i + w_j)/(s_i + s_j)
//! flip      (u_i v_j^T + u_j v_i^T)/sqrt 2         (w_i - w_j)/(s_i - s_j)
//! normal    n v_i^T                                w_i/s_i, n at right angles to a sheet or bar
//! K(a, b) = U K^ U^T + (I - U U^T) sum_k normal_k a_k b_k          a, b in the frame of V
//! ```
//! `u v` the columns of U (D x R) and V (R x R), `w_i w_ij` derivatives by the stretches, Pa. These
//! directions are orthonormal, so that A and its nearest positive semidefinite neighbour are both
//! sums over them: what is left to iteration are the stretches and the eigenvalues of an R x R
//! matrix. Each material gives the quotients with the division carried out, so that equal stretches
//! cost no digits. Source: Smith, de Goes and Kim, Analytic Eigensystems for Isotropic Distortion
//! Energies (2019).

use crate::eigen::{spectral, symmetric_eigen};
use crate::singular::{Singular, singular};
use crate::tensor::is_positive;
use crate::{Real, Tangent};
use stationary_calculus::array;

/// A material whose energy depends on the stretches only, not on their directions.
pub(crate) trait Isotropic<const R: usize> {
    /// The second derivative at these principal stretches.
    fn curvature<T: Real>(&self, s: &[T; R]) -> PrincipalCurvature<T, R>;
}

/// The second derivative in the frame of the principal stretches, Pa. Twist and flip are symmetric
/// in their indices; their diagonals are not read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PrincipalCurvature<T, const R: usize> {
    pub(crate) scaling: [[T; R]; R],
    pub(crate) twist: [[T; R]; R],
    pub(crate) flip: [[T; R]; R],
    pub(crate) normal: [T; R],
}

/// A symmetric table of what a function says of each pair.
#[inline(always)]
pub(crate) fn pairs<T: Real, const R: usize>(of: impl Fn(usize, usize) -> T) -> [[T; R]; R] {
    let mut table = [[T::splat(0.0); R]; R];
    for i in 0..R {
        for j in 0..=i {
            table[i][j] = of(i, j);
            table[j][i] = table[i][j];
        }
    }
    table
}

/// The product of the stretches but for two, or one where both are the same.
#[inline(always)]
pub(crate) fn others<T: Real, const R: usize>(s: &[T; R], left_out: [usize; 2]) -> T {
    let mut product = T::splat(1.0);
    for k in 0..R {
        if k != left_out[0] && k != left_out[1] {
            product = product * s[k];
        }
    }
    product
}

impl<T: Real, const R: usize> PrincipalCurvature<T, R> {
    /// The nearest positive semidefinite one.
    #[inline(always)]
    pub(crate) fn projected(&self) -> Self {
        let floor = |row: [T; R]| row.map(T::positive_part);
        let scaling = if is_positive(&self.scaling) {
            self.scaling
        } else {
            let (values, vectors) = symmetric_eigen(&self.scaling);
            spectral(&vectors, &floor(values))
        };
        PrincipalCurvature {
            scaling,
            twist: self.twist.map(floor),
            flip: self.flip.map(floor),
            normal: floor(self.normal),
        }
    }
}

/// A second derivative by its principal directions, times a weight.
#[derive(Clone, Copy, Debug)]
pub struct PrincipalTangent<T, const D: usize, const R: usize> {
    left: [[T; D]; R],
    right: [[T; R]; R],
    scaling: [[T; R]; R],
    /// Half the sum and half the difference of flip and twist.
    along: [[T; R]; R],
    across: [[T; R]; R],
    normal: [T; R],
}

impl<T: Real, const D: usize, const R: usize> PrincipalTangent<T, D, R> {
    /// The second derivative itself.
    #[inline(always)]
    pub(crate) fn exact(material: &impl Isotropic<R>, f: &[[T; D]; R], weight: T) -> Self {
        let frame = singular(f);
        PrincipalTangent::new(&frame, &material.curvature(&frame.values), weight)
    }

    /// Its nearest positive semidefinite neighbour.
    #[inline(always)]
    pub(crate) fn semidefinite(material: &impl Isotropic<R>, f: &[[T; D]; R], weight: T) -> Self {
        let frame = singular(f);
        PrincipalTangent::new(&frame, &material.curvature(&frame.values).projected(), weight)
    }

    #[inline(always)]
    pub(crate) fn new(frame: &Singular<T, D, R>, c: &PrincipalCurvature<T, R>, weight: T) -> Self {
        let half = |sign: f64| pairs(|i, j| (c.flip[i][j] + c.twist[i][j] * sign) * 0.5);
        let tangent = PrincipalTangent {
            left: frame.left,
            right: frame.right,
            scaling: c.scaling,
            along: half(1.0),
            across: half(-1.0),
            normal: c.normal,
        };
        tangent.weighted(weight)
    }

    #[inline(always)]
    fn weighted(mut self, weight: T) -> Self {
        for k in 0..R {
            for l in 0..R {
                self.scaling[k][l] = self.scaling[k][l] * weight;
                self.along[k][l] = self.along[k][l] * weight;
                self.across[k][l] = self.across[k][l] * weight;
            }
            self.normal[k] = self.normal[k] * weight;
        }
        self
    }

    /// The block in the frame of the stretches, by columns.
    #[inline(always)]
    fn in_frame(&self, a: &[T; R], b: &[T; R]) -> [[T; R]; R] {
        let mut block = [[T::splat(0.0); R]; R];
        for j in 0..R {
            for i in 0..R {
                if i == j {
                    block[j][i] = self.scaling[i][i] * (a[i] * b[i]);
                    for k in (0..R).filter(|&k| k != i) {
                        block[j][i] += self.along[i][k] * (a[k] * b[k]);
                    }
                } else {
                    let flipped = self.across[i][j] * (a[j] * b[i]);
                    block[j][i] = self.scaling[i][j].multiply_add(a[i] * b[j], flipped);
                }
            }
        }
        block
    }
}

impl<T: Real, const D: usize, const R: usize> Tangent<T, D, R> for PrincipalTangent<T, D, R> {
    /// The gradient in the frame of V.
    type Node = [T; R];

    #[inline(always)]
    fn node(&self, gradient: &[T; R]) -> [T; R] {
        array(|k| crate::tensor::dot(&self.right[k], gradient))
    }

    #[inline(always)]
    fn block(&self, a: &[T; R], b: &[T; R]) -> [[T; D]; D] {
        let mut inner = self.in_frame(a, b);
        let mut block = [[T::splat(0.0); D]; D];
        if D > R {
            // (I - U U^T) n = n I + U (-n I) U^T
            let mut normal = T::splat(0.0);
            for k in 0..R {
                normal = (self.normal[k] * a[k]).multiply_add(b[k], normal);
            }
            for (d, column) in block.iter_mut().enumerate() {
                column[d] = normal;
            }
            for (k, column) in inner.iter_mut().enumerate() {
                column[k] = column[k] - normal;
            }
        }
        for (m, column) in inner.iter().enumerate() {
            let turned = crate::tensor::apply(&self.left, column);
            for (j, out) in block.iter_mut().enumerate() {
                for (out, turned) in out.iter_mut().zip(turned) {
                    *out = turned.multiply_add(self.left[m][j], *out);
                }
            }
        }
        block
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        FixedCorotated, FullTangent, Lame, Lanes, Material, NeoHookean, SaintVenantKirchhoff,
        TakesTangent,
    };
    use proptest::prelude::*;

    fn lanes<const D: usize, const R: usize>(f: &[[f64; D]; R]) -> [[Lanes; D]; R] {
        // A lane at rest, one turned inside out, and two on the way.
        f.map(|column| column.map(|x| Lanes::from([x, 0.3 * x, -x, 1.7 * x])))
    }

    fn largest_gap<const D: usize, const R: usize>(
        a: &FullTangent<Lanes, D, R>,
        b: &FullTangent<Lanes, D, R>,
    ) -> f64 {
        let flat = |t: &FullTangent<Lanes, D, R>| -> Vec<f64> {
            let entries = t.0.as_flattened().as_flattened().as_flattened();
            entries.iter().flat_map(|entry| (0..4).map(|lane| entry.lane(lane))).collect()
        };
        flat(a).iter().zip(flat(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    /// The sum of what is handed over.
    struct Handed<const D: usize, const R: usize>(FullTangent<Lanes, D, R>);

    impl<const D: usize, const R: usize> TakesTangent<Lanes, D, R> for Handed<D, R> {
        fn take(&mut self, tangent: &impl Tangent<Lanes, D, R>) {
            self.0 = FullTangent::of(tangent);
        }

        fn add(&mut self, tangent: &impl Tangent<Lanes, D, R>) {
            let part = FullTangent::of(tangent);
            let sums = self.0.0.as_flattened_mut().as_flattened_mut().as_flattened_mut();
            let parts = part.0.as_flattened().as_flattened().as_flattened();
            sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += *part);
        }
    }

    /// The principal form is the closed one, and its projection the one found by iteration, however
    /// it is put together.
    fn agree<M, const D: usize, const R: usize>(material: &M, f: &[[f64; D]; R])
    where
        M: Isotropic<R> + Material<D, R>,
    {
        let (f, weight) = (lanes(f), Lanes::from([0.5, 1.0, 2.0, 3.0]));
        let closed = FullTangent::of(&material.tangent(&f, weight));
        let principal = FullTangent::of(&PrincipalTangent::exact(material, &f, weight));
        assert!(largest_gap(&closed, &principal) < 1e-11, "{f:?}");
        let projected = FullTangent::of(&material.semidefinite(&f, weight));
        assert!(largest_gap(&closed.projected(), &projected) < 1e-11, "{f:?}");
        let mut handed = Handed(closed);
        material.hand_semidefinite(&f, weight, &mut handed);
        assert!(largest_gap(&handed.0, &projected) < 1e-11, "{f:?}");
        if material.is_semidefinite(&f) {
            assert!(largest_gap(&closed, &projected) < 1e-11, "{f:?}");
        }
    }

    /// The same with all lanes close to F, each a bit further.
    fn agree_near_rest<M: Isotropic<3> + Material<3, 3>>(material: &M, f: &[[f64; 3]; 3]) {
        let grown = |x: f64| Lanes::from([x, 0.98 * x, 1.02 * x, 1.05 * x]);
        let (f, weight) = (f.map(|column| column.map(grown)), Lanes::from([0.5, 1.0, 2.0, 3.0]));
        let closed = FullTangent::of(&material.tangent(&f, weight));
        let mut handed = Handed(closed);
        material.hand_semidefinite(&f, weight, &mut handed);
        assert!(largest_gap(&closed.projected(), &handed.0) < 1e-13, "{f:?}");
    }

    proptest! {
        #[test]
        fn principal_directions_give_the_closed_form_and_its_projection(
            f in prop::array::uniform3(prop::array::uniform3(-1.5..1.5_f64)),
            poisson in -0.4..0.45,
        ) {
            let space = Lame::<3>::from_young_poisson(1.0, poisson).unwrap();
            let plane = space.plane_strain();
            let membrane = SaintVenantKirchhoff::new(space.plane_stress());
            let square = [[f[0][0], f[0][1]], [f[1][0], f[1][1]]];
            agree(&SaintVenantKirchhoff::new(space), &f);
            agree(&SaintVenantKirchhoff::new(plane), &square);
            agree::<_, 3, 2>(&membrane, &[f[0], f[1]]);
            agree::<_, 3, 1>(&SaintVenantKirchhoff::new(space.uniaxial_stress()), &[f[2]]);
            agree(&NeoHookean::new(space).unwrap(), &f);
            agree(&NeoHookean::new(plane).unwrap(), &square);
        }

        /// From rest to the strains at which only some directions are negative.
        #[test]
        fn a_body_near_rest_loses_its_negative_twists_only(
            f in prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64)),
            strain in -12.0..-0.5_f64,
            poisson in 0.0..0.45,
        ) {
            let space = Lame::<3>::from_young_poisson(1.0, poisson).unwrap();
            let size = 10.0_f64.powf(strain);
            let near = crate::tensor::shifted(crate::tensor::scaled(&f, size), 1.0);
            agree_near_rest(&SaintVenantKirchhoff::new(space), &near);
            agree_near_rest(&NeoHookean::new(space).unwrap(), &near);
        }

        #[test]
        fn degenerate_elements_are_projected_too(
            f in prop::array::uniform3(prop::array::uniform3(-1.5..1.5_f64)),
            flat in -300.0..0.0_f64,
        ) {
            let space = Lame::<3>::from_young_poisson(1.0, 0.3).unwrap();
            let small = 10.0_f64.powf(flat);
            for f in [
                [f[0], f[1], f[2].map(|x| small * x)],
                [f[0], f[0].map(|x| (1.0 + small) * x), f[1]],
                [f[0], f[1], [0.0; 3]],
                [f[0], [0.0; 3], [0.0; 3]],
                [[0.0; 3]; 3],
            ] {
                agree(&SaintVenantKirchhoff::new(space), &f);
                agree(&NeoHookean::new(space).unwrap(), &f);
            }
        }

        #[test]
        fn stretched_bodies_need_no_projection(
            s in prop::array::uniform3(1.0..2.0_f64), angle in -3.0..3.0_f64,
        ) {
            let space = Lame::<3>::from_young_poisson(1.0, 0.3).unwrap();
            let (c, d) = (angle.cos(), angle.sin());
            let f = [[c * s[0], d * s[0], 0.0], [-d * s[1], c * s[1], 0.0], [0.0, 0.0, s[2]]];
            prop_assert!(SaintVenantKirchhoff::new(space).is_semidefinite(&f));
            let pressed = f.map(|column| column.map(|x| 0.4 * x));
            prop_assert!(!SaintVenantKirchhoff::new(space).is_semidefinite(&pressed));
        }
    }

    #[test]
    fn a_pulled_body_is_seen_to_need_no_projection_even_if_it_is_pressed_a_little_sideways() {
        let pulled = [[1.1, 0.0, 0.0], [0.0, 0.96, 0.0], [0.0, 0.0, 0.975]];
        for poisson in [0.0, 0.3, 0.45] {
            let space = Lame::<3>::from_young_poisson(1.0, poisson).unwrap();
            let body = SaintVenantKirchhoff::new(space);
            let exact = FullTangent::of(&body.tangent(&lanes(&pulled), Lanes::from([1.0; 4])));
            let needed = largest_gap(&exact, &exact.projected()) > 1e-3;
            assert!(needed, "a lane of the four is inside out");
            let seen = body.is_semidefinite(&pulled);
            let alone =
                FullTangent::of(&body.tangent(
                    &pulled.map(|c| c.map(|x| Lanes::from([x; 4]))),
                    Lanes::from([1.0; 4]),
                ));
            assert_eq!(seen, largest_gap(&alone, &alone.projected()) == 0.0, "{poisson}");
        }
    }

    #[test]
    fn a_swollen_rubber_is_seen_to_need_no_projection_and_a_pressed_one_to_need_it() {
        let space = Lame::<3>::from_young_poisson(1.0, 0.3).unwrap();
        let rubber = NeoHookean::new(space).unwrap();
        let stretched = |s: [f64; 3]| [[s[0], 0.0, 0.0], [0.0, 0.0, s[1]], [0.0, -s[2], 0.0]];
        for s in [[1.01, 1.01, 1.01], [1.1, 1.05, 1.1], [1.2, 1.2, 1.25], [1.3, 1.1, 1.2]] {
            assert!(rubber.is_semidefinite(&stretched(s)), "{s:?}");
        }
        for s in [[0.99, 1.0, 1.0], [0.9, 0.9, 0.9], [1.0, 0.5, 1.0], [-1.1, 1.1, 1.1]] {
            let f = stretched(s);
            assert!(!rubber.is_semidefinite(&f), "{s:?}");
            let exact = FullTangent::of(&rubber.tangent(&lanes(&f), Lanes::from([1.0; 4])));
            assert!(largest_gap(&exact, &exact.projected()) > 1e-3, "{s:?}");
        }
    }

    #[test]
    fn a_corotated_body_at_rest_is_a_linear_one() {
        let space = Lame::<3>::from_young_poisson(1.0, 0.3).unwrap();
        let rest = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let tangent = FullTangent::of(&FixedCorotated::new(space).unwrap().tangent(&rest, 1.0));
        let linear = FullTangent::of(&crate::Linear::new(space).tangent(&rest, 1.0));
        let entries = |t: &FullTangent<f64, 3, 3>| t.0.as_flattened().as_flattened().concat();
        for (a, b) in entries(&tangent).iter().zip(entries(&linear)) {
            assert!((a - b).abs() < 1e-15);
        }
    }
}
