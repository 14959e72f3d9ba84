//! Broad and narrow phase alone, on a falling pile of boxes, against parry's through rapier3d-f64 at the same poses.
//!
//! Boxes fall, and after every step of ours rapier's boxes are put where ours are. Then both look for contacts
//! within the same distance, ours afresh, rapier's from the contacts of the step before and with all that it does
//! about bodies that were moved.

use rapier3d_f64::prelude::{Pose, Rotation, Vector};
use stationary_contact::SpatialWorld;
use stationary_contact::problems::falling_boxes;

use crate::space::rapier;
use crate::{Row, STEP};

/// How long the pile falls, and until when it is in flight, s.
const TIME: f64 = 2.0;
const FLIGHT: f64 = 1.0;

/// Prints the ratio of the times, ours over rapier's, and how many contact points each found on average, in flight
/// and afterwards.
pub fn print(count: usize) {
    let pile = falling_boxes(count).expect("a pile");
    let detector = || pile.detector().expect("colliders of these bodies");
    let mut bodies = SpatialWorld::new(pile.system.clone(), detector()).expect("bodies");
    let (mut state, mut ours) = (pile.state.clone(), detector());
    let (mut world, handles) = rapier(&pile.starts, false);
    let margin = world.integration_parameters.prediction_distance();
    let steps = (TIME / STEP) as usize;
    let mut rows = [(); 2].map(|()| [(); 2].map(|()| Row::default()));
    let mut found = [[0; 2]; 2];
    for step in 0..steps {
        bodies.step(&mut state, STEP).expect("a step");
        for (handle, q) in handles.iter().zip(state.q.chunks_exact(7)) {
            let turn = Rotation::from_xyzw(q[4], q[5], q[6], q[3]);
            let pose = Pose::from_parts(Vector::new(q[0], q[1], q[2]), turn);
            world.bodies[*handle].set_position(pose, false);
        }
        let phase = usize::from(step as f64 * STEP >= FLIGHT);
        let [own, theirs] = &mut rows[phase];
        let points = own.timed(|| ours.detect(&state.q, margin).expect("detection").len());
        theirs.timed(|| world.detect_collisions(&(), &()));
        let manifolds = world.contact_pairs().flat_map(|pair| pair.manifolds());
        found[phase][0] += points;
        found[phase][1] += manifolds.map(|manifold| manifold.points.len()).sum::<usize>();
    }
    println!("\ndetection alone of {count} boxes that fall, 2 s");
    println!("| phase | time over rapier's | contact points | of rapier |");
    println!("| --- | --- | --- | --- |");
    for (phase, name) in ["in flight", "afterwards"].into_iter().enumerate() {
        let [points, their_points] = found[phase].map(|points| 2 * points / steps);
        let ratio = rows[phase][0].time / rows[phase][1].time;
        println!("| {name} | {ratio:.2} | {points} | {their_points} |");
    }
}
