//! Friction on one contact, where the answer is known.

use stationary_calculus::{DiagonalMetric, Vector};
use stationary_contact::{ContactError, ContactRows, Frictional, Impact, InverseMass, project};

/// A particle of 1 kg on the plane z = 0.
fn particle(rows: &[[f64; 3]]) -> Impact {
    let mass = InverseMass::of(&DiagonalMetric::new([1.0; 3]).unwrap()).unwrap();
    let mut all = ContactRows::new();
    rows.iter().for_each(|row| all.push((0..3).map(|k| (k, row[k]))));
    Impact::new(all, &mass, vec![0.0; rows.len()]).unwrap()
}

fn rub(mu: f64, v: [f64; 3]) -> ([f64; 3], f64) {
    let normal = particle(&[[0.0, 0.0, 1.0]]);
    let tangent = particle(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let frictional =
        Frictional { normal: &normal, tangent: &tangent, bias: &[0.0], friction: &[mu] };
    let mut v = Vector(v);
    let done = frictional.stagger(&[0.0], v.view_mut()).unwrap();
    assert!(done.residual < 1e-14);
    (v.0, done.coulomb)
}

#[test]
fn friction_takes_mu_times_the_normal_impulse_from_what_slides_and_all_from_what_sticks() {
    let (v, off) = rub(0.5, [3.0, 4.0, -2.0]);
    // The normal impulse is 2, friction 1 of the speed 5.
    for (v, expected) in v.iter().zip([2.4, 3.2, 0.0]) {
        assert!((v - expected).abs() < 1e-14);
    }
    assert!(off < 1e-13, "{off}");
    let (v, off) = rub(0.5, [0.3, 0.4, -2.0]);
    assert!(v.iter().all(|v| v.abs() < 1e-9) && off < 1e-9, "{v:?} {off}");
}

/// The impulses (-mu, 1) lambda of one side of the cone stop approach across it: the rows of the cone's
/// sides, projected on at once, throw what slides upward at mu (s - mu w)/(1 + mu^2).
#[test]
fn a_single_projection_onto_the_cone_lifts_what_slides_and_staggered_projections_do_not() {
    let (mu, s, w) = (0.5, 3.0, 0.1);
    let cone = particle(&[[-mu, 0.0, 1.0], [mu, 0.0, 1.0]]);
    let mut lifted = Vector([s, 0.0, -w]);
    project(&cone, lifted.view_mut()).unwrap();
    let expected = mu * (s - mu * w) / (1.0 + mu * mu);
    assert!((lifted.0[2] - expected).abs() < 1e-14 && expected > 1.0);
    let (kept, _) = rub(mu, [s, 0.0, -w]);
    assert!(kept[2].abs() < 1e-15 && (kept[0] - (s - mu * w)).abs() < 1e-14);
}

#[test]
fn a_negative_friction_is_refused_by_name() {
    let normal = particle(&[[0.0, 0.0, 1.0]]);
    let tangent = particle(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let friction = &[-0.5];
    let frictional = Frictional { normal: &normal, tangent: &tangent, bias: &[0.0], friction };
    let mut v = Vector([1.0, 0.0, -1.0]);
    let error = frictional.stagger(&[0.0], v.view_mut()).unwrap_err();
    assert_eq!(error, ContactError::Friction { contact: 0, value: -0.5 });
    assert_eq!(v.0, [1.0, 0.0, -1.0]);
}
