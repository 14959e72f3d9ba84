//! A block of rubber under its weight without any factor, and the memory that it takes.
//!
//! `cargo run --release --example large_block -p stationary-elasticity -- 56` puts a million
//! tetrahedra to rest, 56 cells a side; without a number there are few. First one linear step by
//! products alone, which keep no matrix, then all of Newton's steps with a matrix that is kept.

use std::time::Instant;

use stationary_calculus::{ConjugateGradient, Covector, Curvature, Potential};
use stationary_elasticity::{
    DeadLoad, Elements, Freedoms, Lame, LinearTetrahedron, NeoHookean, Solid, Solves, Statics,
    lumped_mass,
};
use stationary_mesh::cuboid;

/// The most memory that the process has held so far, where the system tells.
fn peak() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    kilobytes.map_or("unknown".to_owned(), |kilobytes| format!("{:.2} GiB", kilobytes / 1048576.0))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cells = std::env::args().nth(1).map_or(Ok(8), |word| word.parse())?;
    let block = cuboid([1.0; 3], [cells; 3])?;
    let freedoms = Freedoms::held_where(&block.nodes(), |x, _| x[2] == 0.0)?;
    let metric = lumped_mass(LinearTetrahedron, &block, [1e3, 1.0], &freedoms)?;
    let rubber = NeoHookean::new(Lame::<3>::from_young_poisson(1e6, 0.3)?)?;
    let weight =
        DeadLoad::body(LinearTetrahedron, &block, 1.0, &freedoms, |_| [0.0, 0.0, -9810.0])?;
    let mut q = freedoms.gathered(&block.nodes())?;
    let places = freedoms.places().to_vec();
    let body = Solid::new(LinearTetrahedron, &block, 1.0, rubber, freedoms)?;
    let mut body = body.with_curvature(Curvature::Semidefinite);
    println!("{} tetrahedra, {} freedoms, peak {}", body.elements(), q.len(), peak());

    let method = ConjugateGradient { tolerance: 1e-8, iterations: 10_000 };
    let start = Instant::now();
    let (mut r, mut x) = (vec![0.0; q.len()], vec![0.0; q.len()]);
    weight.add_differential(&q, Covector(&mut r));
    let report = method.solve(0.0, &metric, 1.0, &body, &q, &r, &mut x)?;
    println!(
        "by products: {} iterations to a residual of {:.1e} in {:.0} s, peak {}",
        report.iterations,
        report.relative_residual,
        start.elapsed().as_secs_f64(),
        peak()
    );

    let start = Instant::now();
    let statics = Statics { solves: Solves::Iterate(method), ..Statics::default() };
    let rest = statics.solve(&mut body, &weight, &metric, &places, &mut q)?;
    let newton = rest.steps[0].newton;
    println!(
        "at rest: {} Newton steps to a residual of {:.1e} kg^1/2 m/s^2 in {:.0} s, peak {}",
        newton.iterations,
        newton.residual,
        start.elapsed().as_secs_f64(),
        peak()
    );
    let top = body.freedoms().positions(&q)?.iter().map(|x| x[2]).fold(0.0, f64::max);
    println!("the top is at {top:.6} m");
    Ok(())
}
