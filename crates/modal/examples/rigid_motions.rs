//! A free truss: three motions cost no energy, and pinning a vertex takes two of them away.
//!
//! `cargo run -p stationary-modal --example rigid_motions`

use stationary_calculus::{DiagonalMetric, Stencils};
use stationary_elasticity::{Spring, Strain};
use stationary_modal::{Linearized, RigidMotions};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let bars = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]];
    for (pinned, name) in [(0, "free"), (1, "pinned at a corner"), (2, "pinned at two")] {
        // Pinned vertices are numbered after the free ones: here the last corners.
        let free = corners.len() - pinned;
        let springs: Result<Vec<_>, _> = bars
            .iter()
            .map(|&[a, b]| {
                let [dx, dy] = [0, 1].map(|c: usize| corners[b][c] - corners[a][c]);
                Spring::new([a, b], f64::hypot(dx, dy), 10.0, Strain::Green)
            })
            .collect();
        let truss = Stencils::<_, 2, 2>::new(free, corners[free..].to_vec(), springs?)?;
        let metric = DiagonalMetric::particles::<2>(&vec![1.0; free])?;
        let q = corners[..free].as_flattened();
        let mut near_rest = Linearized::at(&metric, &truss, q, 1e-9)?;
        let rigid = RigidMotions::of_points::<2>(&near_rest, q.as_chunks().0)?;
        let kind = near_rest.kind(&rigid)?;
        let lowest = near_rest.lowest(1, &rigid)?.frequencies().next().unwrap_or(f64::NAN);
        println!("{name}: {} rigid motions, {kind:?}, then {lowest:.3} rad/s", rigid.len());
    }
    Ok(())
}
