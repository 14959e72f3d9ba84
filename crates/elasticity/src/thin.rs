//! A sheet in its plane that is free to thin: plane stress at large strain.
//!
//! ```text
//! F3 = [F 0; 0 s],    s from  P_33(F3) = 0                 the stretch across, no stress on the faces
//! W = W3(F3),    P = P3(F3) without its third row and column
//! A_ikjl = A3_ikjl - A3_ik33 A3_33jl / A3_3333             as s follows
//! ```
//! `F` 2 x 2, `W3` the energy density of the solid (J/m^3), the section of the body is the thickness
//! at rest (m). Right for every solid and every strain at which such an `s` is found, positive, from s = 1
//! by Newton's method on one number: for [`NeoHookean`](crate::NeoHookean), whose energy is convex in s,
//! where det F > 0; NaN where none is found. Where det F <= 0 it has none: such a sheet has been turned
//! over, or is flat.
//!
//! The two-dimensional laws of [`Lame::plane_stress`](crate::Lame::plane_stress) need no such search,
//! and are the same sheet to first order of the strain only, but for the linear one and Saint
//! Venant-Kirchhoff's, which ends where `nu/(1 - nu) tr E >= 1/2`: such a solid has thinned to nothing, E
//! Green's strain in the plane. Costs a few times the solid's stress. Source: notes 13.1, errata 13; Bonet and Wood
//! (2008), section 6.6.

use crate::{FullTangent, Material, Real, Tangent};

/// The sheet of a solid material, in its plane, with free faces.
///
/// ```
/// use stationary_elasticity::{FreeToThin, Lame, Material, NeoHookean};
/// let rubber = NeoHookean::new(Lame::<3>::from_young_poisson(1e6, 0.49)?)?;
/// let sheet = FreeToThin(rubber);
/// // Stretched by a half along both directions, it thins so that its volume stays about the same.
/// let thin = sheet.stretch_across(&[[1.5, 0.0], [0.0, 1.5]]);
/// assert!((1.5 * 1.5 * thin - 1.0_f64).abs() < 0.03, "{thin}");
/// assert!(sheet.stress(&[[1.5, 0.0], [0.0, 1.5]])[0][0] > 0.0_f64);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeToThin<M>(pub M);

/// Newton's steps for the stretch across.
const ITERATIONS: usize = 60;
/// Steps of this part of the stretch, or of 1 where that is more, are rounding if so many come in a row: the
/// stress across is known to rounding of its terms, not of the stretch.
const NEARLY: f64 = 1e-9;
/// But not steps of so much of the stretch: those lead to a sheet of no thickness.
const VANISHES: f64 = 1e-3;
const IN_A_ROW: usize = 4;

impl<M: Material<3, 3>> FreeToThin<M> {
    /// The stretch across the sheet, at which its faces bear no stress; NaN where none is found.
    pub fn stretch_across<T: Real>(&self, f: &[[T; 2]; 2]) -> T {
        let mut across = T::splat(1.0);
        let mut nearly = 0;
        for _ in 0..ITERATIONS {
            let solid = spread(f, across);
            let stress = self.0.stress(&solid)[2][2];
            let tangent = self.0.tangent(&solid, T::splat(1.0));
            let along = tangent.node(&[T::splat(0.0), T::splat(0.0), T::splat(1.0)]);
            let step = stress * tangent.block(&along, &along)[2][2].reciprocal();
            across = across - step;
            let settled = step.magnitude() - across.magnitude() * (4.0 * f64::EPSILON);
            if settled.all(|x| x <= 0.0) && across.all(|x| x > 0.0) {
                return across;
            }
            let close = step.magnitude() - T::larger(across, T::splat(1.0)) * NEARLY;
            let remains = step.magnitude() - across * VANISHES;
            let is_close = close.all(|x| x <= 0.0) && remains.all(|x| x <= 0.0);
            nearly = if is_close { nearly + 1 } else { 0 };
            if nearly == IN_A_ROW && across.all(|x| x > 0.0) {
                return across;
            }
        }
        T::splat(f64::NAN)
    }

    /// F of the solid.
    fn spread<T: Real>(&self, f: &[[T; 2]; 2]) -> [[T; 3]; 3] {
        spread(f, self.stretch_across(f))
    }
}

fn spread<T: Real>(f: &[[T; 2]; 2], across: T) -> [[T; 3]; 3] {
    let zero = T::splat(0.0);
    [[f[0][0], f[0][1], zero], [f[1][0], f[1][1], zero], [zero, zero, across]]
}

impl<M: Material<3, 3>> Material<2, 2> for FreeToThin<M> {
    type Tangent<T: Real> = FullTangent<T, 2, 2>;
    type Semidefinite<T: Real> = FullTangent<T, 2, 2>;

    fn energy<T: Real>(&self, f: &[[T; 2]; 2]) -> T {
        self.0.energy(&self.spread(f))
    }

    fn stress<T: Real>(&self, f: &[[T; 2]; 2]) -> [[T; 2]; 2] {
        let stress = self.0.stress(&self.spread(f));
        [[stress[0][0], stress[0][1]], [stress[1][0], stress[1][1]]]
    }

    fn tangent<T: Real>(&self, f: &[[T; 2]; 2], weight: T) -> FullTangent<T, 2, 2> {
        let solid = FullTangent::of(&self.0.tangent(&self.spread(f), weight)).0;
        let inverse = solid[2][2][2][2].reciprocal();
        let mut sheet = [[[[T::splat(0.0); 2]; 2]; 2]; 2];
        for l in 0..2 {
            for j in 0..2 {
                let follows = solid[l][j][2][2] * inverse;
                for k in 0..2 {
                    for i in 0..2 {
                        sheet[l][j][k][i] = solid[l][j][k][i] - solid[2][2][k][i] * follows;
                    }
                }
            }
        }
        FullTangent(sheet)
    }

    fn semidefinite<T: Real>(&self, f: &[[T; 2]; 2], weight: T) -> FullTangent<T, 2, 2> {
        self.tangent(f, weight).projected()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FixedCorotated, Lame, Linear, NeoHookean, SaintVenantKirchhoff};
    use proptest::prelude::*;

    fn solid() -> Lame<3> {
        Lame::from_young_poisson(1.0, 0.3).unwrap()
    }

    /// The stress of both laws, the sheet's own over that of the solid that is free to thin.
    fn ratio(own: &impl Material<2, 2>, thin: &impl Material<2, 2>, f: [[f64; 2]; 2]) -> f64 {
        own.stress(&f)[0][0] / thin.stress(&f)[0][0]
    }

    #[test]
    fn the_plane_law_of_a_neo_hookean_sheet_is_forty_percent_too_stiff_at_a_stretch_of_1_2() {
        let (lame, sheet) = (solid(), solid().plane_stress());
        let both = |s: f64| [[s, 0.0], [0.0, s]];
        let one = |s: f64| [[s, 0.0], [0.0, 1.0]];
        let (own, thin) =
            (NeoHookean::new(sheet).unwrap(), FreeToThin(NeoHookean::new(lame).unwrap()));
        assert!((ratio(&own, &thin, both(1.2)) - 1.404).abs() < 1e-3);
        assert!((ratio(&own, &thin, one(1.2)) - 1.127).abs() < 1e-3);
        assert!((ratio(&own, &thin, both(1.01)) - 1.016).abs() < 1e-3);
        let (own, thin) =
            (FixedCorotated::new(sheet).unwrap(), FreeToThin(FixedCorotated::new(lame).unwrap()));
        assert!((ratio(&own, &thin, both(1.2)) - 1.307).abs() < 1e-3);
        assert!((ratio(&own, &thin, one(1.2)) - 1.075).abs() < 1e-3);
    }

    #[test]
    fn a_quadratic_solid_has_thinned_to_nothing_at_a_strain_that_is_known() {
        let thin = FreeToThin(SaintVenantKirchhoff::new(solid()));
        // tr E = s^2 - 1, and at nu = 0.3 its end is 7/6.
        let across = |trace: f64| -> f64 {
            let s = (1.0 + trace).sqrt();
            thin.stretch_across(&[[s, 0.0], [0.0, s]])
        };
        let before = across(1.16);
        assert!((before * before - (1.0 - 2.0 * 3.0 / 7.0 * 1.16)).abs() < 1e-12, "{before}");
        assert!(across(1.17).is_nan() && across(2.0).is_nan());
    }

    #[test]
    fn a_neo_hookean_sheet_has_a_stretch_across_at_every_stretch() {
        for poisson in [-0.3, 0.0, 0.3, 0.45, 0.499_999] {
            let lame = Lame::from_young_poisson(1.0, poisson).unwrap();
            let rubber = NeoHookean::new(lame).unwrap();
            let (sheet, size) = (FreeToThin(rubber), lame.lambda() + lame.mu());
            for k in 0..600 {
                let along = 0.02 * f64::from(k + 1);
                for beside in [along, 1.0, 0.3] {
                    let f = [[along, 0.0], [0.0, beside]];
                    let s: f64 = sheet.stretch_across(&f);
                    assert!(s > 0.0, "{poisson}: {along} {beside} {s}");
                    let stress = rubber.stress(&spread(&f, s))[2][2];
                    let terms = size * (1.0 + along * beside) * (1.0 + s);
                    assert!(stress.abs() < 1e-13 * terms, "{poisson}: {f:?} {s} {stress:e}");
                }
            }
        }
    }

    #[test]
    fn each_of_four_sheets_finds_its_own_stretch() {
        use crate::Lanes;
        let sheet = FreeToThin(NeoHookean::new(solid()).unwrap());
        let along = [0.32, 1.0, 3.26, 9.0];
        let four = Lanes::from(along);
        let zero = Lanes::splat(0.0);
        let found = sheet.stretch_across(&[[four, zero], [zero, four]]);
        for (lane, along) in along.into_iter().enumerate() {
            let alone: f64 = sheet.stretch_across(&[[along, 0.0], [0.0, along]]);
            assert!((found.lane(lane) - alone).abs() < 1e-13, "{along}");
        }
    }

    #[test]
    fn a_sheet_that_is_turned_over_or_flat_has_no_stretch_across() {
        let sheet = FreeToThin(NeoHookean::new(solid()).unwrap());
        for f in [[[-1.0, 0.0], [0.0, 1.0]], [[1.0, 0.0], [0.0, 0.0]]] {
            let s: f64 = sheet.stretch_across(&f);
            assert!(s.is_nan(), "{s}");
        }
    }

    proptest! {
        #[test]
        fn quadratic_sheets_in_plane_stress_are_free_to_thin(
            g in prop::array::uniform2(prop::array::uniform2(-0.2..0.2_f64)),
        ) {
            let f = [[1.0 + g[0][0], g[0][1]], [g[1][0], 1.0 + g[1][1]]];
            let own = SaintVenantKirchhoff::new(solid().plane_stress());
            let thin = FreeToThin(SaintVenantKirchhoff::new(solid()));
            let (one, other): (f64, f64) = (Material::<2, 2>::energy(&own, &f), thin.energy(&f));
            prop_assert!((one - other).abs() < 1e-13 * (1e-2 + one));
            let (a, b) = (own.tangent(&f, 1.0), thin.tangent(&f, 1.0).0);
            let a = FullTangent::<f64, 2, 2>::of(&a).0;
            let pairs = a.as_flattened().as_flattened().iter().zip(b.as_flattened().as_flattened());
            for (a, b) in pairs {
                prop_assert!((a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-12);
            }
            let linear = (Linear::new(solid().plane_stress()), FreeToThin(Linear::new(solid())));
            let (one, other): (f64, f64) = (linear.0.energy(&f), linear.1.energy(&f));
            prop_assert!((one - other).abs() < 1e-13 * (1e-2 + one));
        }

        #[test]
        fn the_stress_and_second_derivative_of_a_thinning_sheet_are_derivatives(
            g in prop::array::uniform2(prop::array::uniform2(-0.4..0.4_f64)),
            v in prop::array::uniform2(prop::array::uniform2(-1.0..1.0_f64)),
        ) {
            let f = [[1.2 + g[0][0], g[0][1]], [g[1][0], 1.2 + g[1][1]]];
            let sheet = FreeToThin(NeoHookean::new(solid()).unwrap());
            let h = 1e-5;
            let at = |t: f64| -> [[f64; 2]; 2] {
                std::array::from_fn(|k| std::array::from_fn(|i| f[k][i] + t * v[k][i]))
            };
            let along = |p: [[f64; 2]; 2]| -> f64 {
                p.as_flattened().iter().zip(v.as_flattened()).map(|(p, v)| p * v).sum()
            };
            let slope = (sheet.energy(&at(h)) - sheet.energy(&at(-h))) / (2.0 * h);
            prop_assert!((along(sheet.stress(&f)) - slope).abs() < 1e-8);
            let curvature = (along(sheet.stress(&at(h))) - along(sheet.stress(&at(-h)))) / (2.0 * h);
            let tangent = sheet.tangent(&f, 1.0).0;
            let mut sum = 0.0;
            for (l, j, k, i) in (0..16).map(|n| (n & 1, n >> 1 & 1, n >> 2 & 1, n >> 3)) {
                sum += v[k][i] * tangent[l][j][k][i] * v[l][j];
            }
            prop_assert!((sum - curvature).abs() < 1e-7);
        }
    }
}
