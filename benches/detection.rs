//! Broad and narrow phase alone, on a falling pile of boxes, against parry's through rapier3d-f64 at
//! the same poses, in the same run.
//!
//! `cargo bench --bench detection --features peers -- [boxes]` (1,000 by default) lets boxes fall,
//! and after every step of ours puts rapier's boxes where ours are. Then both look for contacts
//! within the same distance, ours afresh, rapier's from the contacts of the step before and with
//! all that it does about bodies that were moved. Printed are the ratio of the times, ours over
//! rapier's, and how many contact points each found on average, in flight (the first second) and
//! afterwards. One thread each.

mod rapier_boxes;

use std::time::Instant;

use rapier3d_f64::prelude::{Pose, Rotation, Vector};
use stationary_contact::SpatialWorld;
use stationary_contact::problems::falling_boxes;

use self::rapier_boxes::{STEP, rapier};

/// How long the pile falls, and until when it is in flight, seconds.
const TIME: f64 = 2.0;
const FLIGHT: f64 = 1.0;

fn main() {
    let boxes = std::env::args().find_map(|a| a.parse().ok()).unwrap_or(1_000);
    let pile = falling_boxes(boxes).expect("a pile");
    let detector = || pile.detector().expect("colliders of these bodies");
    let mut bodies = SpatialWorld::new(pile.system.clone(), detector()).expect("bodies");
    let (mut state, mut ours) = (pile.state.clone(), detector());
    let (mut world, handles) = rapier(&pile.starts, false);
    let margin = world.integration_parameters.prediction_distance();
    let steps = (TIME / STEP) as usize;
    let (mut times, mut found) = ([[0.0; 2]; 2], [[0; 2]; 2]);
    for step in 0..steps {
        bodies.step(&mut state, STEP).expect("a step");
        for (handle, q) in handles.iter().zip(state.q.chunks_exact(7)) {
            let turn = Rotation::from_xyzw(q[4], q[5], q[6], q[3]);
            let pose = Pose::from_parts(Vector::new(q[0], q[1], q[2]), turn);
            world.bodies[*handle].set_position(pose, false);
        }
        let phase = usize::from(step as f64 * STEP >= FLIGHT);
        let start = Instant::now();
        let points = ours.detect(&state.q, margin).expect("detection").len();
        times[phase][0] += start.elapsed().as_secs_f64();
        let start = Instant::now();
        world.detect_collisions(&(), &());
        times[phase][1] += start.elapsed().as_secs_f64();
        let manifolds = world.contact_pairs().flat_map(|pair| pair.manifolds());
        found[phase][0] += points;
        found[phase][1] += manifolds.map(|manifold| manifold.points.len()).sum::<usize>();
    }
    for (phase, name) in ["in flight", "afterwards"].into_iter().enumerate() {
        let [ours, theirs] = times[phase];
        let [points, their_points] = found[phase].map(|points| 2 * points / steps);
        println!(
            "{boxes} boxes {name}: {:.2} of rapier's time, {points} contact points to its {their_points}",
            ours / theirs
        );
    }
}
