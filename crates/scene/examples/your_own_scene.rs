//! A scene of your own: write it down, make a mistake, and be told where.
//!
//! ```text
//! cargo run --release -p stationary-scene --example your_own_scene
//! ```
//! Change the text below, or put it into a file and read it with `Scene::read`.

use stationary_scene::Scene;

/// Two balls on one spring, thrown into the air: the spring swings, their middle flies a parabola.
const SCENE: &str = r#"
title = "Two balls on a spring, thrown"
dimension = 2
integrator = "implicit-midpoint"
step = 0.002
horizon = 1
observables = ["energy", { distance = ["left", "right"] }]

[uniform_gravity]
acceleration = [0, -9.81]

[[particles]]
name = "left"
mass = 1
position = [0, 0]
velocity = [3, 4]

[[particles]]
name = "right"
mass = 1
position = [0.5, 0]
velocity = [3, 6]

[[springs]]
between = ["left", "right"]
stiffness = 200
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let run = Scene::parse("thrown.toml", SCENE)?.run()?;
    println!("{}", run.summary());

    // The middle of two equal masses moves as if the spring were not there.
    let last = run.positions(run.times().len() - 1);
    let middle = [0.5 * (last[0] + last[2]), 0.5 * (last[1] + last[3])];
    println!("the middle ends at ({:.6}, {:.6})", middle[0], middle[1]);
    println!("the parabola ends at ({:.6}, {:.6})\n", 0.25 + 3.0, 5.0 - 0.5 * 9.81);

    // A slip of the pen.
    let wrong = SCENE.replace("\"right\"]\nstiffness", "\"rihgt\"]\nstiffness");
    if let Err(error) = Scene::parse("thrown.toml", &wrong) {
        println!("{error}");
    }
    Ok(())
}
