//! Three reactions whose rates differ by nine powers of ten: when is half of the first species
//! gone, and what is left after an hour, a year, three thousand years?
//!
//! `cargo run --example chemistry -p stationary-integrators`

use std::ops::ControlFlow;

use stationary_integrators::problems::robertson;
use stationary_integrators::{
    AdaptiveMethod, Direction, Event, OutputTimes, RadauIia5, Tolerance, integrate,
    integrate_to_event,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let reactions = robertson();
    // The second species never exceeds 4e-5, and ends below 1e-13: each has a tolerance of its own.
    let absolute = reactions.scale.iter().map(|scale| 1e-8 * scale).collect();
    let control = Tolerance::componentwise(1e-8, absolute)?.into();
    let mut method = RadauIia5::new(&reactions.field, control, reactions.initial.clone())?;

    let start = method.moment().clone();
    let mut half = Event::new(Direction::Falling, &start, |_t, y: &[f64]| y[0] - 0.5);
    integrate_to_event(&mut method, reactions.end, &mut half, |_| {})?;
    let moment = method.moment();
    println!("half of a is gone after {:.6} s, b is {:.6e} then\n", moment.t, moment.y[1]);

    let times = [3.6e3, 3.156e7, 1e11];
    let mut output = OutputTimes::new(3, &times)?;
    println!("{:>10} {:>14} {:>14} {:>14}", "t [s]", "a", "b", "c");
    let mut failure = None;
    integrate(&mut method, reactions.end, |mut step| {
        let written = output.within(&mut step, |t, y| {
            println!("{t:10.3e} {:14.6e} {:14.6e} {:14.6e}", y[0], y[1], y[2]);
        });
        failure = written.err();
        if failure.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    if let Some(error) = failure {
        return Err(error.into());
    }
    let work = method.work();
    let error = reactions.error(&method.moment().y).unwrap_or(f64::NAN);
    println!("\n{} steps, {} evaluations, error {error:.1e}", work.steps, work.evaluations);
    Ok(())
}
