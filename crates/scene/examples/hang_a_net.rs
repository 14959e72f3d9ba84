//! A net falls, and the run leaves its tables and its picture in a folder.
//!
//! ```text
//! cargo run --release -p stationary-scene --example hang_a_net
//! ```
//! Then the same net is run with a step beyond the limit of stability: it ends with an error that
//! says which particle flew off and when, and what was computed until then is there all the same.

use std::path::Path;

use stationary_scene::{RunError, Scene, problems::SPRING_NET};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::parse("spring-net.toml", SPRING_NET)?;
    let run = scene.run()?;
    println!("{}", run.summary());

    let folder = Path::new("target/hang-a-net");
    run.write(folder)?;
    println!("trajectory.csv, observables.csv and picture.svg are in {}\n", folder.display());

    match scene.with_step(0.004)?.run() {
        Ok(_) => println!("The long step was stable after all."),
        Err(RunError::Interrupted(failure)) => {
            println!("With a step of 0.004 s: {failure}");
            println!("{} samples were taken before.", failure.run.times().len());
        }
        Err(other) => return Err(other.into()),
    }
    Ok(())
}
