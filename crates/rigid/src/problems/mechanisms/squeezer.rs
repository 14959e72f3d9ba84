//! Andrews' squeezing mechanism: seven bodies in a plane, driven by a motor, around one point.
//!
//! ```text
//! K1 hangs from O, K2 from K1;   K3 from B;   K5 from A, K4 from K5;   K7 from A, K6 from K7
//! K2, K3, K4 and K6 meet in P;   a spring leads from D on K3 to C;   a torque acts on K1
//! ```
//! Bodies are numbered in the order in which they hang, K1 K2 K3 K5 K4 K7 K6, so that the tree's coordinates are the
//! published angles beta, theta, gamma, delta, phi, epsilon, omega.

use nalgebra::Vector3;

use super::{Mechanism, Parts, Strut, still, turned};
use crate::{Attachment, Body, JointEnd, JointKind, RigidError, RigidMotion};

/// The published angles after 0.03 s, computed there with tolerances of 1e-14: beta, theta, gamma, delta, phi,
/// epsilon, omega.
pub const SQUEEZED: [f64; 7] = [
    15.810_771_196_299_04,
    -15.756_371_059_842_98,
    0.040_822_240_130_731_01,
    0.524_409_965_880_530_4,
    -0.534_730_116_322_694_8,
    1.048_080_741_042_263,
    0.534_730_116_322_694_8,
];

/// The same at the start.
const ANGLES: [f64; 7] = [
    -0.061_713_890_014_276_45,
    0.0,
    0.455_279_819_163_070_4,
    0.487_364_979_543_842_55,
    0.222_668_390_165_885_9,
    1.230_547_444_549_821_2,
    -0.222_668_390_165_885_9,
];

/// Masses (kg) and inertias (kg m^2) about the centres.
const MASSES: [f64; 7] = [0.04325, 0.00365, 0.02373, 0.07050, 0.00706, 0.05498, 0.00706];
const INERTIAS: [f64; 7] = [2.194e-6, 4.410e-7, 5.255e-6, 1.169e-5, 5.667e-7, 1.912e-5, 5.667e-7];
/// The torque on K1, N m.
const TORQUE: f64 = 0.033;

fn at(x: f64, y: f64) -> Vector3<f64> {
    Vector3::new(x, y, 0.0)
}

/// Andrews' squeezer, from rest, for 0.03 s. There is no weight.
///
/// # Errors
/// None: its numbers are given.
pub fn squeezer() -> Result<Mechanism, RigidError> {
    let z = Vector3::z();
    let (a, b, c) = (at(-0.06934, -0.00227), at(-0.03635, 0.03273), at(0.014, 0.072));
    // What it hangs from, where on that (or in the world), and where on itself the joint is and the point P.
    let hung: [(Option<usize>, Vector3<f64>, Vector3<f64>); 7] = [
        (None, Vector3::zeros(), at(-0.00092, 0.0)),
        (Some(0), at(0.007 - 0.00092, 0.0), at(0.0115, 0.0)),
        (None, b, at(-0.01043, 0.01874)),
        (None, a, at(-0.02308, -0.00916)),
        (Some(3), at(0.04 - 0.02308, -0.00916), at(0.0, 0.02 - 0.01421)),
        (None, a, at(0.00449, 0.01228)),
        (Some(5), at(0.00449, 0.01228 - 0.04), at(0.01421 - 0.02, 0.0)),
    ];
    let meeting = [
        (1, at(0.0115 - 0.028, 0.0)),
        (2, at(-0.01043, 0.01874 - 0.035)),
        (4, at(0.0, -0.01421)),
        (6, at(0.01421, 0.0)),
    ];
    let mut bodies = Vec::new();
    let mut poses: Vec<RigidMotion> = Vec::new();
    let (mut joints, mut turns) = (Vec::new(), Vec::new());
    for (k, &(parent, foot, own)) in hung.iter().enumerate() {
        // Flat bodies, which turn about z only.
        bodies.push(Body::new(MASSES[k], [0.5 * INERTIAS[k], 0.5 * INERTIAS[k], INERTIAS[k]])?);
        let (place, turn) = match parent {
            None => (foot, ANGLES[k]),
            Some(parent) => (poses[parent].apply(&foot), turns[parent] + ANGLES[k]),
        };
        turns.push(turn);
        let rotation = turned(z, turn);
        poses.push(RigidMotion { translation: place - rotation.rotate(&own), rotation });
        let end = parent.map_or(JointEnd::world(foot), |parent| JointEnd::on(parent, foot));
        joints.push((JointKind::Hinge { axis: z }, [end, JointEnd::on(k, own)]));
    }
    let [first, others @ ..] = meeting.map(|(body, point)| JointEnd::on(body, point));
    joints.extend(others.map(|other| (JointKind::Hinge { axis: z }, [first, other])));
    let closing = others.map(|other| (JointKind::OnLine { axis: z }, [first, other])).to_vec();
    let d = at(0.02 - 0.01043, 0.01874 - 0.018);
    let spring = Strut {
        ends: [Attachment::World(c), Attachment::Body(2, d)],
        stiffness: 4530.0,
        damping: 0.0,
        rest: 0.07785,
    };
    let parts = Parts {
        joints,
        closing,
        struts: vec![spring],
        torques: vec![(0, z * TORQUE)],
        start: [ANGLES.to_vec(), vec![0.0; 7]],
    };
    let motions: Vec<_> = poses.into_iter().map(still).collect();
    Mechanism::new(("andrews-squeezer", 0.03), bodies, &motions, Vector3::zeros(), parts)
}
