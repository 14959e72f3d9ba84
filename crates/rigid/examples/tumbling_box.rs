//! A box tumbling in space, half a minute in steps of 10 ms: what each integrator does to what
//! stays.
//!
//! `cargo run --example tumbling_box -p stationary-rigid`

use stationary_rigid::problems::tumbling_box;
use stationary_rigid::{BodyMethod, BodySpace, FreeTop, LieGroup, Poses, spatial_angular_momentum};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let tumbling = tumbling_box()?;
    let momentum = spatial_angular_momentum::<Poses>(&tumbling.initial)?;
    let energy = tumbling.energy(&tumbling.initial);
    let start = &tumbling.motion;
    let truth = FreeTop::new(*tumbling.body(), start.pose.rotation, start.angular_velocity)?;
    println!(
        "{:22} {:>10} {:>18} {:>14}",
        "method", "energy", "angular momentum", "attitude [rad]"
    );
    for &method in BodyMethod::ALL {
        let mut integrator = method.integrator(&tumbling.system)?;
        let mut state = tumbling.initial.clone();
        for _ in 0..3_000 {
            integrator.step(&mut state, 0.01)?;
        }
        let exact = truth.orientation(30.0)?;
        let attitude = Poses::pose_at(&state.q, 0).rotation.direction_to(&exact);
        let moved = spatial_angular_momentum::<Poses>(&state)? - momentum;
        println!(
            "{:22} {:10.1e} {:18.1e} {:14.1e}",
            method.to_string(),
            (tumbling.energy(&state) / energy - 1.0).abs(),
            moved.norm() / momentum.norm(),
            attitude.norm()
        );
    }
    Ok(())
}
