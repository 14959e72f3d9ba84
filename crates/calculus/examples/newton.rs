//! Newton's method on a root, a double root, and no root at all, with the residual of every iterate.
//!
//! ```text
//! cargo run -p stationary-calculus --example newton
//! ```
//! Near a simple root the number of right digits doubles at every step; near a double root the
//! error halves; where there is no root, the search ends and says why.

use stationary_calculus::{FunctionEquation, Newton, NewtonMemory};
use stationary_calculus::{newton_against_initial_guesses, newton_against_wrong_derivatives};

fn search(what: &str, guess: f64, f: fn(f64) -> f64, df: fn(f64) -> f64) {
    let newton = Newton { tolerance: 1e-15, iterations: 40 };
    let mut equation = FunctionEquation::new(
        1,
        |x: &[f64], value: &mut [f64]| value[0] = f(x[0]),
        |x: &[f64], value: &mut [f64]| value[0] = df(x[0]),
    );
    let Some(mut memory) = NewtonMemory::<[f64; 1]>::new(1, newton.iterations) else { return };
    let mut x = [guess];
    let result = newton.solve(&mut equation, &mut x, &mut memory);

    println!("{what}, from x = {guess}");
    match result {
        Ok(report) => println!("  x = {:.15} after {} steps", x[0], report.iterations),
        Err(error) => println!("  {}, at x = {:.6}", error.failure, x[0]),
    }
    let sizes: Vec<String> = memory.history().iter().map(|size| format!("{size:.1e}")).collect();
    for (row, sizes) in sizes.chunks(8).enumerate() {
        println!("  {} {}", if row == 0 { "|f| =" } else { "     " }, sizes.join("  "));
    }
    println!();
}

fn main() {
    search("x^2 = 2", 1.0, |x| x * x - 2.0, |x| 2.0 * x);
    search("(x^2 - 2)^2 = 0", 1.0, |x| (x * x - 2.0).powi(2), |x| 4.0 * x * (x * x - 2.0));
    search("atan x = 0", 10.0, f64::atan, |x| (1.0 + x * x).recip());
    search("x^2 = -1", 1.5, |x| x * x + 1.0, |x| 2.0 * x);
    search("x^3 = 8 with the wrong sign", 1.0, |x| x.powi(3) - 8.0, |x| -3.0 * x * x);

    println!("A step of implicit Euler of a pendulum, with a derivative that is wrong:");
    println!("{}", newton_against_wrong_derivatives());
    println!("and with a guess that is far away:");
    println!("{}", newton_against_initial_guesses());
}
