//! Velocities at the start that the text does not give: those that joints determine.
//!
//! ```text
//! v_b = v_a + w_a x (p - x_a) - w_b x (p - x_b)       from joint to joint, angular velocities given or zero
//! A u = -b                                            where that leaves joints torn: all of what is not given
//! ```
//! `u` the velocities and angular velocities that are not given, `A` what they do at each joint to what it
//! forbids, `b` what it has of that already. The second is taken where it has one answer, and it closes every
//! joint: a mechanism of which one body's motion is given.

use std::collections::VecDeque;

use nalgebra::{DMatrix, DVector, Vector3};

use crate::model::items::{JointKind, RigidBody, SceneJoint};
use crate::words::draft::DeclaredBody;

/// What ends may move against each other, relative to their speed: rounding of what a file says.
pub(crate) const VELOCITY: f64 = 1e-9;

/// Velocities that are solved for together, at most: the matrix is full.
const UNKNOWNS: usize = 300;

/// What is left of a column beside those before it, below this part of the largest, is nothing.
const RANK: f64 = 1e-10;

/// Gives bodies the velocities that their joints determine, where the text does not give them.
pub(crate) fn complete(dimension: usize, bodies: &mut [DeclaredBody], joints: &[SceneJoint]) {
    carry_velocities(bodies, joints);
    let (allowed, turning) = (VELOCITY * fastest(bodies, joints), fastest_turn(bodies));
    let torn = |joint: &SceneJoint| {
        forbidden_shift(bodies, joint).norm() > allowed
            || forbidden_turn(bodies, joint, turning).is_some()
    };
    if joints.iter().any(torn) {
        solve_all(dimension, bodies, joints);
    }
}

/// A number that is not given: of a body, the rate of a freedom.
#[derive(Clone, Copy)]
enum Unknown {
    Shift(usize, usize),
    Turn(usize, usize),
}

impl Unknown {
    fn all(dimension: usize, bodies: &[DeclaredBody]) -> Vec<Self> {
        let turns = if dimension == 3 { 0..3 } else { 2..3 };
        let of_body = |(body, declared): (usize, &DeclaredBody)| {
            let shifts = if declared.has_velocity { 0..0 } else { 0..dimension };
            let turns = if declared.has_spin { 0..0 } else { turns.clone() };
            let shifts = shifts.map(move |c| Unknown::Shift(body, c));
            shifts.chain(turns.map(move |c| Unknown::Turn(body, c))).collect::<Vec<_>>()
        };
        bodies.iter().enumerate().flat_map(of_body).collect()
    }

    fn add(self, bodies: &mut [DeclaredBody], rate: f64) {
        match self {
            Unknown::Shift(body, c) => bodies[body].body.velocity[c] += rate,
            Unknown::Turn(body, c) => {
                let body = &mut bodies[body].body;
                let mut turning = spin(body);
                turning[c] += rate;
                body.angular_velocity = body.turned().rotate_back(&turning).into();
            }
        }
    }
}

/// Solves for all that is not given, where that has one answer that closes every joint.
fn solve_all(dimension: usize, bodies: &mut [DeclaredBody], joints: &[SceneJoint]) {
    let mut tried = bodies.to_vec();
    let unknowns = Unknown::all(dimension, bodies);
    if unknowns.is_empty() || unknowns.len() > UNKNOWNS {
        return;
    }
    for unknown in &unknowns {
        match *unknown {
            Unknown::Shift(body, c) => tried[body].body.velocity[c] = 0.0,
            Unknown::Turn(body, _) => tried[body].body.angular_velocity = [0.0; 3],
        }
    }
    let forbidden = |bodies: &[DeclaredBody]| -> DVector<f64> {
        let of_joint = |joint: &SceneJoint| {
            let [shift, turn] = [forbidden_shift(bodies, joint), forbidden_turning(bodies, joint)];
            [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z]
        };
        DVector::from_vec(joints.iter().flat_map(of_joint).collect())
    };
    let start = forbidden(&tried);
    let columns: Vec<DVector<f64>> = unknowns
        .iter()
        .map(|unknown| {
            let mut moved = tried.clone();
            unknown.add(&mut moved, 1.0);
            forbidden(&moved) - &start
        })
        .collect();
    let Some(rates) = least_squares(DMatrix::from_columns(&columns), -start) else { return };
    for (unknown, rate) in unknowns.into_iter().zip(rates.iter()) {
        unknown.add(&mut tried, *rate);
    }
    // What is not closed now is contradicted by what is given, and told as such.
    bodies.clone_from_slice(&tried);
}

/// The x (n) of the least |a x - b|, where the m x n matrix `a` has independent columns.
fn least_squares(a: DMatrix<f64>, b: DVector<f64>) -> Option<DVector<f64>> {
    let n = a.ncols();
    if a.nrows() < n {
        return None;
    }
    let qr = a.col_piv_qr();
    let r = qr.r();
    if r[(n - 1, n - 1)].abs() <= RANK * r[(0, 0)].abs() {
        return None;
    }
    let mut x = r.solve_upper_triangular(&qr.q().tr_mul(&b))?;
    qr.p().inv_permute_rows(&mut x);
    Some(x)
}

fn spin(body: &RigidBody) -> Vector3<f64> {
    body.turned().rotate(&body.angular_velocity.into())
}

fn velocity_at(bodies: &[DeclaredBody], end: Option<usize>, place: [f64; 3]) -> Vector3<f64> {
    let Some(index) = end else { return Vector3::zeros() };
    let body = &bodies[index].body;
    let arm = Vector3::from(place) - Vector3::from(body.position);
    Vector3::from(body.velocity) + spin(body).cross(&arm)
}

/// The largest of what adds up to velocities at joints: what rounding scales with in all of a mechanism, of
/// which some part may stand still.
pub(crate) fn fastest(bodies: &[DeclaredBody], joints: &[SceneJoint]) -> f64 {
    let of_end = |(index, place): (usize, [f64; 3])| {
        let body = &bodies[index].body;
        let arm = Vector3::from(place) - Vector3::from(body.position);
        Vector3::from(body.velocity).norm() + spin(body).norm() * arm.norm()
    };
    let ends = joints
        .iter()
        .flat_map(|joint| joint.between.into_iter().flatten().map(|body| (body, joint.place)));
    ends.map(of_end).fold(0.0, f64::max)
}

/// Gives a velocity to bodies that have none, from joint to joint, the world's joints first.
fn carry_velocities(bodies: &mut [DeclaredBody], joints: &[SceneJoint]) {
    let mut touching: Vec<Vec<usize>> = vec![Vec::new(); bodies.len()];
    for (index, joint) in joints.iter().enumerate() {
        joint.between.into_iter().flatten().for_each(|body| touching[body].push(index));
    }
    let mut known: Vec<bool> = bodies.iter().map(|declared| declared.has_velocity).collect();
    let fixed = joints.iter().enumerate().filter(|(_, joint)| joint.between.contains(&None));
    let mut next: VecDeque<usize> = fixed.map(|(index, _)| index).collect();
    next.extend((0..bodies.len()).filter(|&body| known[body]).flat_map(|b| touching[b].clone()));
    while let Some(index) = next.pop_front() {
        let [a, b] = joints[index].between;
        for (from, to) in [(a, b), (b, a)] {
            let Some(body) = to.filter(|&body| !known[body]) else { continue };
            if from.is_none_or(|from| known[from]) {
                let place = joints[index].place;
                let gap = velocity_at(bodies, from, place) - velocity_at(bodies, to, place);
                bodies[body].body.velocity = gap.into();
                known[body] = true;
                next.extend(&touching[body]);
            }
        }
    }
}

/// What of the velocities at a joint it forbids.
pub(crate) fn forbidden_shift(bodies: &[DeclaredBody], joint: &SceneJoint) -> Vector3<f64> {
    let [a, b] = joint.between.map(|end| velocity_at(bodies, end, joint.place));
    let (torn, axis) = (a - b, Vector3::from(joint.axis));
    if joint.kind == JointKind::Slider { torn - axis * torn.dot(&axis) } else { torn }
}

/// What of the angular velocities it forbids.
fn forbidden_turning(bodies: &[DeclaredBody], joint: &SceneJoint) -> Vector3<f64> {
    let [a, b] = joint.between.map(|end| end.map_or(Vector3::zeros(), |i| spin(&bodies[i].body)));
    let (turn, axis) = (a - b, Vector3::from(joint.axis));
    match joint.kind {
        JointKind::Ball => Vector3::zeros(),
        JointKind::Hinge => turn - axis * turn.dot(&axis),
        JointKind::Fixed | JointKind::Slider => turn,
    }
}

/// The rate of a turn that the joint does not allow, where there is one among bodies that turn so fast at most.
pub(crate) fn forbidden_turn(
    bodies: &[DeclaredBody],
    joint: &SceneJoint,
    fastest: f64,
) -> Option<f64> {
    let forbidden = forbidden_turning(bodies, joint).norm();
    (forbidden > VELOCITY * fastest).then_some(forbidden)
}

/// The largest rate of a turn.
pub(crate) fn fastest_turn(bodies: &[DeclaredBody]) -> f64 {
    bodies.iter().map(|declared| spin(&declared.body).norm()).fold(0.0, f64::max)
}
