//! A net of springs as one potential: its energy, its forces, and what it does not feel.
//!
//! `cargo run --example hanging_net -p stationary-elasticity`

use stationary_calculus::{Covector, Potential, Stencils};
use stationary_elasticity::{Net, Strain, net};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let size = Net { rows: 4, columns: 5, spacing: 0.1, stiffness: 50.0, strain: Strain::Cauchy };
    let springs = net(size)?;
    println!("{} springs between {} vertices", springs.len(), size.rows * size.columns);
    let free = size.rows * size.columns;
    let net = Stencils::<_, 2, 2>::new(free, Vec::new(), springs)?;
    let place = |stretch: f64, turn: f64| -> Vec<f64> {
        (0..free)
            .flat_map(|vertex| {
                let (x, y) = ((vertex % 5) as f64 * 0.1 * stretch, (vertex / 5) as f64 * 0.1);
                [turn.cos() * x - turn.sin() * y, turn.sin() * x + turn.cos() * y]
            })
            .collect()
    };
    for (what, q) in [
        ("at rest", place(1.0, 0.0)),
        ("turned by a radian", place(1.0, 1.0)),
        ("stretched by a tenth", place(1.1, 0.0)),
        ("stretched and turned", place(1.1, 1.0)),
    ] {
        let mut dv = Covector(vec![0.0; net.dim()]);
        net.add_differential(&q, dv.view_mut());
        let largest = dv.components().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        println!("{what:22} energy {:.6} J, largest force {largest:.6} N", net.energy(&q));
    }
    Ok(())
}
