//! The outer planets for 550 years, with three methods: which of them keeps the energy?
//!
//! ```text
//! cargo run --release -p stationary-scene --example planets
//! ```
//! Explicit Euler lets the planets spiral outward, the classical Runge-Kutta method loses a little
//! energy for ever, and Stormer-Verlet neither gains nor loses.

use stationary_integrators::Method;
use stationary_measure::{Column, Table};
use stationary_scene::{Scene, problems::OUTER_SOLAR_SYSTEM};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::parse("outer-solar-system.toml", OUTER_SOLAR_SYSTEM)?;
    println!("{}", scene.run()?.summary());

    let mut table = Table::new([
        Column::exact("method"),
        Column::exact("differentials"),
        Column::rounded("energy change at the end", 2, 1e-14),
        Column::rounded("Jupiter from the sun [au]", 3, 0.0),
    ]);
    // Steps for the same work: the Runge-Kutta method evaluates four differentials in each.
    let choices =
        [(Method::ExplicitEuler, 10.0), (Method::RungeKutta4, 40.0), (Method::StormerVerlet, 10.0)];
    for (method, step) in choices {
        let run = scene.clone().with_method(method)?.with_step(step)?.run()?;
        let energies = run.energies();
        let (start, end) = (energies[0], energies[energies.len() - 1]);
        let last = run.positions(run.times().len() - 1);
        let (sun, jupiter) = (&last[..3], &last[3..6]);
        let apart = sun.iter().zip(jupiter).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        table.push([
            method.to_string().into(),
            run.cost().differentials.into(),
            ((end - start) / start.abs()).into(),
            apart.into(),
        ]);
    }
    println!("{table}");
    Ok(())
}
