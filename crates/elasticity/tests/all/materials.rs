//! What every material must obey: rest, invariance, isotropy, and linear elasticity close to rest.

use nalgebra::{Matrix2, Matrix3, Rotation2, Rotation3, Vector3};
use proptest::prelude::*;
use stationary_elasticity::{
    FixedCorotated, Lame, Linear, Material, NeoHookean, Orthotropic, SaintVenantKirchhoff, Weave,
};

type Space = [[f64; 3]; 3];
type Plane = [[f64; 2]; 2];

fn lame(poisson: f64) -> Lame<3> {
    Lame::from_young_poisson(3.0, poisson).unwrap()
}

fn columns3(m: Matrix3<f64>) -> Space {
    m.into()
}

fn columns2(m: Matrix2<f64>) -> Plane {
    m.into()
}

fn rotation(axis: [f64; 3]) -> Matrix3<f64> {
    Rotation3::new(Vector3::from(axis)).into_inner()
}

/// F with rotations before and after it.
fn turned(f: Space, before: [f64; 3], after: [f64; 3]) -> Space {
    columns3(rotation(after) * Matrix3::from(f) * rotation(before))
}

fn space(material: impl Material<3, 3>, f: Space) -> f64 {
    material.energy(&f)
}

fn near_rest() -> impl Strategy<Value = Space> {
    prop::array::uniform3(prop::array::uniform3(-0.6..0.6_f64)).prop_map(|mut f| {
        (0..3).for_each(|k| f[k][k] += 1.0);
        f
    })
}

fn axis() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-2.0..2.0_f64)
}

const REST: Space = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Energies of the isotropic materials that are invariant; a corotated body has no negative ratio.
fn energies(poisson: f64, f: Space) -> [f64; 3] {
    [
        space(SaintVenantKirchhoff::new(lame(poisson)), f),
        space(NeoHookean::new(lame(poisson)).unwrap(), f),
        space(FixedCorotated::new(lame(poisson.max(0.0))).unwrap(), f),
    ]
}

fn stresses(poisson: f64, f: Space) -> [Space; 3] {
    [
        SaintVenantKirchhoff::new(lame(poisson)).stress(&f),
        NeoHookean::new(lame(poisson)).unwrap().stress(&f),
        FixedCorotated::new(lame(poisson.max(0.0))).unwrap().stress(&f),
    ]
}

proptest! {
    #[test]
    fn turning_the_body_costs_nothing_and_turning_its_stuff_neither(
        f in near_rest(), before in axis(), after in axis(), poisson in -0.5..0.49,
    ) {
        let (plain, turned) = (energies(poisson, f), energies(poisson, turned(f, before, after)));
        for (a, b) in plain.iter().zip(turned) {
            prop_assert!((a - b).abs() < 1e-12 * (1.0 + a.abs()), "{a} {b}");
        }
    }

    #[test]
    fn rotations_have_neither_energy_nor_stress(turn in axis(), poisson in -0.5..0.49) {
        let f = columns3(rotation(turn));
        for energy in energies(poisson, f) {
            prop_assert!(energy.abs() < 1e-13, "{energy}");
        }
        for stress in stresses(poisson, f) {
            prop_assert!(stress.as_flattened().iter().all(|p| p.abs() < 1e-12));
        }
    }

    #[test]
    fn no_strain_gives_energy_away(f in near_rest(), poisson in -0.5..0.49) {
        for energy in energies(poisson, f) {
            prop_assert!(energy > -1e-14);
        }
        prop_assert!(space(Linear::new(lame(poisson)), f) >= 0.0);
    }

    #[test]
    fn inside_out_energies_are_finite_and_rest_is_below_them(f in near_rest(), nu in -0.5..0.49) {
        let mirrored = [f[0].map(|x| -x), f[1], f[2]];
        for (energy, stress) in energies(nu, mirrored).iter().zip(stresses(nu, mirrored)) {
            prop_assert!(energy.is_finite() && *energy >= -1e-14);
            prop_assert!(stress.as_flattened().iter().all(|p| p.is_finite()));
        }
    }

    #[test]
    fn a_weave_notices_its_direction_and_a_uniform_one_does_not(
        f in near_rest(), angle in -3.0..3.0_f64, turn in -3.0..3.0_f64,
    ) {
        let membrane = |material: Orthotropic, f: Space| -> f64 {
            Material::<3, 2>::energy(&material, &[f[0], f[1]])
        };
        let weave = |warp, weft, shear, angle| {
            Orthotropic::new(Weave { warp, weft, poisson: 0.2, shear, angle }).unwrap()
        };
        let uniform = weave(3.0, 3.0, 3.0 / 2.4, angle);
        let isotropic = SaintVenantKirchhoff::new(lame(0.2).plane_stress());
        let expected = Material::<3, 2>::energy(&isotropic, &[f[0], f[1]]);
        prop_assert!((membrane(uniform, f) - expected).abs() < 1e-13 * (1.0 + expected));
        // Turning cloth and threads together changes nothing but the description.
        let spun = rotation([0.0, 0.0, turn]);
        let turned = columns3(Matrix3::from(f) * spun.transpose());
        let (a, b) = (weave(5.0, 1.0, 0.3, angle), weave(5.0, 1.0, 0.3, angle + turn));
        let energy = membrane(a, f);
        prop_assert!((membrane(b, turned) - energy).abs() < 1e-12 * (1.0 + energy));
        prop_assert!(energy >= 0.0);
    }
}

/// W at I + h G against linear elasticity: the gap falls like h^3, for every Poisson's ratio.
#[test]
fn close_to_rest_every_material_is_the_linear_one() {
    let gradient: Space = [[0.3, -0.2, 0.5], [0.1, -0.4, 0.2], [-0.6, 0.35, 0.25]];
    let at = |h: f64| -> Space {
        std::array::from_fn(|k| std::array::from_fn(|i| REST[k][i] + h * gradient[k][i]))
    };
    let flat = |f: Space| -> Plane { [[f[0][0], f[0][1]], [f[1][0], f[1][1]]] };
    for poisson in [-0.5, 0.0, 0.3, 0.49] {
        let solid = lame(poisson);
        let plane = solid.plane_strain();
        let gaps = |h: f64| -> Vec<f64> {
            let f = at(h);
            let linear = space(Linear::new(solid), f);
            let linear_plane: f64 = Linear::new(plane).energy(&flat(f));
            let mut gaps: Vec<f64> = energies(poisson, f).map(|w| w - linear).to_vec();
            gaps.push(SaintVenantKirchhoff::new(plane).energy(&flat(f)) - linear_plane);
            gaps.push(NeoHookean::new(plane).unwrap().energy(&flat(f)) - linear_plane);
            if poisson >= 0.0 {
                gaps.push(FixedCorotated::new(plane).unwrap().energy(&flat(f)) - linear_plane);
            } else {
                gaps.remove(2); // There is no corotated body with a negative ratio.
            }
            gaps
        };
        for (material, (coarse, fine)) in gaps(2e-3).iter().zip(gaps(1e-3)).enumerate() {
            let order = (coarse / fine).log2();
            assert!((order - 3.0).abs() < 0.1, "material {material}, nu = {poisson}: {order}");
        }
    }
}

#[test]
fn linear_elasticity_takes_a_turn_for_a_strain() {
    let turn: Plane = columns2(Rotation2::new(0.5).into_inner());
    let energy: f64 = Linear::new(lame(0.3).plane_strain()).energy(&turn);
    let pressed = 0.5_f64.cos() - 1.0;
    let plane = lame(0.3).plane_strain();
    let expected = (2.0 * plane.mu() + 2.0 * plane.lambda()) * pressed * pressed;
    assert!((energy - expected).abs() < 1e-15, "{energy} {expected}");
}

/// The force of a bar of stretch s turns where its derivative by s vanishes.
#[test]
fn saint_venant_kirchhoff_turns_at_the_stretch_of_one_over_root_three() {
    let bar = SaintVenantKirchhoff::new(lame(0.3).uniaxial_stress());
    let force = |s: f64| Material::<1, 1>::stress(&bar, &[[s]])[0][0];
    let critical = 1.0 / 3.0_f64.sqrt();
    assert!(force(critical) < force(critical + 1e-3) && force(critical) < force(critical - 1e-3));
    assert_eq!(force(0.0), 0.0);
    let corotated = FixedCorotated::new(lame(0.3)).unwrap();
    let pressed =
        |s: f64| corotated.stress(&[[s, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])[0][0];
    assert!((1..40).all(|k| pressed(0.025 * f64::from(k)) < pressed(0.025 * f64::from(k + 1))));
}

#[test]
fn at_a_point_a_neo_hookean_body_does_not_rest() {
    for poisson in [-0.5, 0.0, 0.3, 0.49] {
        let rubber = NeoHookean::new(lame(poisson)).unwrap();
        let small = |s: f64| space(rubber, REST.map(|column| column.map(|x| s * x)));
        assert!(small(0.0) > 0.0 && small(1e-2) > small(0.0) - 1e-4);
        // Its second derivative there is not positive: a body that shrank to a point swells again.
        let stress = rubber.stress(&[[0.0; 3]; 3]);
        assert!(stress.as_flattened().iter().all(|p: &f64| p.abs() < 1e-12));
    }
}

#[test]
fn a_sheet_too_auxetic_for_the_neo_hookean_energy_is_refused() {
    let sheet = |poisson: f64| NeoHookean::new(lame(poisson).plane_stress());
    assert!(sheet(-0.49).is_ok() && sheet(0.3).is_ok());
    let error = sheet(-0.51).unwrap_err().to_string();
    assert!(error.contains("above -1/2"), "{error}");
    assert!(FixedCorotated::new(lame(-0.1)).is_err());
}

#[test]
fn weaves_that_give_energy_away_are_refused() {
    let good = Weave { warp: 5.0, weft: 1.0, poisson: 0.3, shear: 0.2, angle: 0.0 };
    assert!(Orthotropic::new(good).is_ok());
    for bad in [
        Weave { warp: 0.0, ..good },
        Weave { weft: -1.0, ..good },
        Weave { shear: f64::NAN, ..good },
        Weave { poisson: 2.3, ..good },
        Weave { angle: f64::INFINITY, ..good },
    ] {
        assert!(Orthotropic::new(bad).is_err(), "{bad:?}");
    }
}
