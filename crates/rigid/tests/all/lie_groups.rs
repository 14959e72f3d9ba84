//! Every group against the laws of a Lie group.

use std::fmt::Debug;

use nalgebra::{DMatrix, Matrix3, SVector, Vector3, Vector6};
use proptest::prelude::*;
use stationary_rigid::{
    EulerAngles, LieGroup, PlanarMotion, PlanarRotation, RigidError, RigidMotion, Rotation,
    Translation, matrix_exponential, matrix_logarithm,
};

/// A group with its algebra as a list of coordinates and its matrices as nalgebra's.
trait Tested: LieGroup + Debug {
    const DIM: usize;
    fn direction(c: &[f64]) -> Self::Algebra;
    fn coordinates(v: Self::Algebra) -> Vec<f64>;
    fn dense(m: Self::Matrix) -> DMatrix<f64>;
}

macro_rules! tested {
    ($group:ty, $dim:literal, $direction:expr, $coordinates:expr) => {
        impl Tested for $group {
            const DIM: usize = $dim;
            fn direction(c: &[f64]) -> Self::Algebra {
                ($direction)(c)
            }
            fn coordinates(v: Self::Algebra) -> Vec<f64> {
                ($coordinates)(v)
            }
            fn dense(m: Self::Matrix) -> DMatrix<f64> {
                DMatrix::from_column_slice(m.nrows(), m.ncols(), m.as_slice())
            }
        }
    };
}
tested!(PlanarRotation, 1, |c: &[f64]| c[0], |v: f64| vec![v]);
tested!(PlanarMotion, 3, Vector3::from_column_slice, |v: Vector3<f64>| v.as_slice().to_vec());
tested!(Rotation, 3, Vector3::from_column_slice, |v: Vector3<f64>| v.as_slice().to_vec());
tested!(RigidMotion, 6, Vector6::from_column_slice, |v: Vector6<f64>| v.as_slice().to_vec());
tested!(Translation<2>, 2, SVector::from_column_slice, |v: SVector<f64, 2>| v.as_slice().to_vec());

fn close(a: &DMatrix<f64>, b: &DMatrix<f64>, tolerance: f64) -> bool {
    (a - b).amax() <= tolerance
}

/// Every law at three random directions, each coordinate below 1.
fn laws<G: Tested>(c: &[f64; 18]) {
    let [v, w, u] = [0, 6, 12].map(|start| G::direction(&c[start..start + G::DIM]));
    let [g, k, l] = [v, w, u].map(G::exp);
    let mat = |g: &G| G::dense(g.matrix());
    let hat = |v: G::Algebra| G::dense(G::hat(v));
    let id = mat(&G::identity());

    assert!(close(&mat(&g.compose(&g.inverse())), &id, 1e-14));
    assert!(close(&mat(&g.compose(&G::identity())), &mat(&g), 0.0));
    assert!(close(&mat(&g.compose(&k)), &(mat(&g) * mat(&k)), 1e-14));
    assert!(close(&mat(&g.compose(&k).compose(&l)), &mat(&g.compose(&k.compose(&l))), 1e-13));

    assert!(close(&mat(&g), &matrix_exponential(&hat(v)).unwrap(), 1e-13), "exp is the matrix's");
    assert!(close(&hat(g.log()), &hat(v), 1e-13), "log undoes exp");
    assert!(close(&matrix_logarithm(&mat(&g)).unwrap(), &hat(v), 1e-12), "log is the matrix's");

    assert!(close(&hat(g.adjoint(w)), &(mat(&g) * hat(w) * mat(&g.inverse())), 1e-13));
    assert!(close(&hat(G::bracket(v, w)), &(hat(v) * hat(w) - hat(w) * hat(v)), 1e-13));
    let jacobi = |a, b, c| hat(G::bracket(a, G::bracket(b, c)));
    assert!((jacobi(v, w, u) + jacobi(w, u, v) + jacobi(u, v, w)).amax() < 1e-13);
    let first = (hat(G::exp(v * 1e-5).adjoint(w)) - hat(G::exp(v * -1e-5).adjoint(w))) / 2e-5;
    assert!(close(&first, &hat(G::bracket(v, w)), 1e-8), "the bracket is Ad's derivative");

    let tangent = G::dense(g.tangent(w));
    let moved = (mat(&g.walk(w * 1e-5)) - mat(&g.walk(w * -1e-5))) / 2e-5;
    assert!(close(&moved, &tangent, 1e-8), "a walk leaves along its tangent");
    let carried = G::dense(g.transport(&k, g.tangent(w)));
    assert!(close(&carried, &G::dense(k.tangent(w)), 1e-13), "transport keeps the body direction");

    assert!(close(&mat(&g.interpolate(&k, 0.0)), &mat(&g), 1e-13));
    assert!(close(&mat(&g.interpolate(&k, 1.0)), &mat(&k), 1e-13));
    let middle = g.interpolate(&k, 0.5);
    let (there, back) = (g.direction_to(&middle), middle.direction_to(&k));
    assert!(close(&hat(there), &hat(back), 1e-13), "a straight path has one direction");
    // The notes' form, with the step from the left: exp(s log(k g^-1)) g.
    let left = G::exp(k.compose(&g.inverse()).log() * 0.3).compose(&g);
    assert!(close(&mat(&g.interpolate(&k, 0.3)), &mat(&left), 1e-12));
    assert_eq!(G::coordinates(G::direction(&c[..G::DIM])), c[..G::DIM]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn every_group_obeys_the_laws(c in prop::array::uniform18(-1.0..1.0)) {
        laws::<Translation<2>>(&c);
        laws::<PlanarRotation>(&c);
        laws::<PlanarMotion>(&c);
        laws::<Rotation>(&c);
        laws::<RigidMotion>(&c);
    }

    #[test]
    fn a_rotation_survives_its_matrix_and_its_axis_and_angle(
        theta in prop::array::uniform3(-1.8..1.8),
    ) {
        let r = Rotation::exp(Vector3::from(theta));
        let same = |other: &Rotation| r.direction_to(other).norm() < 1e-15 * 4.0;
        prop_assert!(same(&Rotation::from_matrix(&r.matrix()).unwrap()));
        let (axis, angle) = r.axis_angle();
        prop_assert!(same(&Rotation::about(7.0 * axis, angle).unwrap()));
        let v = Vector3::new(0.3, 0.9, -0.2);
        prop_assert!((r.matrix() * v - r.rotate(&v)).amax() < 4e-15);
        prop_assert!((r.rotate_back(&r.rotate(&v)) - v).amax() < 4e-15);
    }

    #[test]
    fn euler_angles_describe_the_rotation_away_from_gimbal_lock(
        roll in -3.1..3.1, pitch in -1.5..1.5, yaw in -3.1..3.1,
    ) {
        let angles = EulerAngles { roll, pitch, yaw };
        let read = EulerAngles::of(&angles.rotation().unwrap()).unwrap();
        let off = [(read.roll, roll), (read.pitch, pitch), (read.yaw, yaw)];
        prop_assert!(off.iter().all(|(a, b)| (a - b).abs() < 1e-13), "{read:?}");
    }
}

#[test]
fn gimbal_lock_is_reported_with_the_turn_that_is_left() {
    use std::f64::consts::FRAC_PI_2;
    for (pitch, sign) in [(FRAC_PI_2, -1.0), (-FRAC_PI_2, 1.0)] {
        let locked = EulerAngles { roll: 0.3, pitch, yaw: 0.8 }.rotation().unwrap();
        let Err(RigidError::GimbalLock { pitch: at, turn }) = EulerAngles::of(&locked) else {
            panic!("no lock at {pitch}");
        };
        assert!((at - pitch).abs() < 1e-15);
        assert!((turn - (0.8 + sign * 0.3)).abs() < 1e-14, "{turn}");
    }
}

#[test]
fn half_a_turn_and_reflections_have_no_matrix_logarithm() {
    for diagonal in [[-1.0, -1.0, 1.0], [1.0, 1.0, -1.0], [0.0, 1.0, 1.0]] {
        let m =
            DMatrix::from_diagonal(&SVector::<f64, 3>::from(diagonal).as_slice().to_vec().into());
        let error = matrix_logarithm(&m).unwrap_err();
        assert!(matches!(error, RigidError::NoLogarithm { .. }), "{diagonal:?}: {error}");
    }
    assert!(matches!(matrix_logarithm(&DMatrix::zeros(2, 3)), Err(RigidError::Size(_))));
    assert!(matches!(
        matrix_exponential(&DMatrix::from_element(2, 2, f64::NAN)),
        Err(RigidError::NonFinite { .. })
    ));
}

#[test]
fn a_matrix_far_from_one_has_a_matrix_logarithm() {
    for (one, other) in
        [(90.0, 0.0), (-90.0, 1.0), (300.0, -300.0), (-600.0, -600.0), (690.0, 680.0)]
    {
        // A turn, and stretches by e^one and e^other.
        let log = DMatrix::from_row_slice(
            4,
            4,
            &[one, -1.5, 0.0, 0.0, 1.5, one, 0.0, 0.0, 0.0, 0.0, other, 0.7, 0.0, 0.0, 0.0, other],
        );
        let found = matrix_logarithm(&matrix_exponential(&log).unwrap()).unwrap();
        assert!(close(&found, &log, 1e-11), "{one} {other}: {found}");
    }
}

#[test]
fn the_notes_series_for_the_logarithm_stops_converging_at_sixty_degrees() {
    let series = |degrees: f64| {
        let m = Rotation::exp(Vector3::z() * degrees.to_radians()).matrix();
        let (mut power, mut sum) = (Matrix3::identity(), Matrix3::zeros());
        for i in 1..2000 {
            power *= m - Matrix3::identity();
            sum += power * (if i % 2 == 1 { 1.0 } else { -1.0 } / f64::from(i));
        }
        (sum - Rotation::hat(Vector3::z() * degrees.to_radians())).amax()
    };
    assert!(series(58.0) < 1e-12 && series(62.0) > 1e3, "{:e} {:e}", series(58.0), series(62.0));
}

#[test]
fn the_exponentials_of_o_n_never_reflect() {
    // O(n) has two components, and exp reaches the identity's only: det exp(A) = exp(tr A) = 1.
    for n in 2..6 {
        let a = DMatrix::from_fn(n, n, |i, j| ((i * 7 + j * 3) % 5) as f64 - 2.0);
        let skew = &a - a.transpose();
        let m = matrix_exponential(&skew).unwrap();
        assert!((m.transpose() * &m - DMatrix::identity(n, n)).amax() < 1e-13);
        assert!((m.determinant() - 1.0).abs() < 1e-13);
    }
}

#[test]
fn what_is_no_rotation_is_refused_by_name() {
    let refused = |q| Rotation::from_quaternion(q).unwrap_err();
    assert!(matches!(refused([1.0, 0.1, 0.0, 0.0]), RigidError::NotUnit { .. }));
    assert!(matches!(refused([0.0; 4]), RigidError::NotUnit { length } if length == 0.0));
    let nan = refused([1.0, 0.0, f64::NAN, 0.0]);
    assert!(matches!(nan, RigidError::NonFinite { index: 2, .. }), "{nan}");
    let stretched = Rotation::from_matrix(&(Matrix3::identity() * 1.1)).unwrap_err();
    assert!(matches!(stretched, RigidError::NotOrthogonal { .. }));
    let mirror = Rotation::from_matrix(&Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0)));
    assert!(matches!(mirror, Err(RigidError::Reflection { .. })));
    let nowhere = Rotation::about(Vector3::zeros(), 1.0);
    assert_eq!(nowhere, Err(RigidError::NoAxis([0.0; 3])));
    assert!(Rotation::about(Vector3::new(1e-300, 0.0, 0.0), 1.0).is_ok());
}
