//! A sheet of no thickness is shot at, up to a million of its cells a second, and nothing passes.
//!
//! `cargo run --example thin_sheet -p stationary-contact`

use stationary_calculus::Vector;
use stationary_contact::MeshFilter;

/// Cells along a side of a square metre.
const SIDE: usize = 10;
const STEP: f64 = 1e-2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let at = |i: usize, j: usize| i * (SIDE + 1) + j;
    let (mut q, mut pinned, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for (i, j) in (0..=SIDE).flat_map(|i| (0..=SIDE).map(move |j| (i, j))) {
        q.extend([i as f64 / SIDE as f64, j as f64 / SIDE as f64, 0.0]);
        pinned.push(i % SIDE == 0 || j % SIDE == 0);
        if i < SIDE && j < SIDE {
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    // A grain of 10 g, a vertex of its own, above a sheet of 100 g.
    let (grain, cells) = (pinned.len(), (SIDE * SIDE) as f64);
    q.extend([0.52, 0.47, 0.1]);
    pinned.push(false);
    let mut masses = vec![0.1 / cells; grain];
    masses.push(0.01);
    let filter = MeshFilter::new(masses, pinned, triangles, 1e-9)?;
    println!(
        "{:>14} {:>18} {:>10} {:>8}",
        "arrives [m/s]", "goes on at [m/s]", "contacts", "zoned"
    );
    for speed in [1.0, 1e2, 1e3, 1e5] {
        let mut v = vec![0.0; q.len()];
        v[3 * grain + 2] = -speed;
        let report = filter.filter(&q, STEP, Vector(&mut v))?;
        let after = v[3 * grain + 2];
        println!("{speed:14e} {after:18.6e} {:10} {:8}", report.contacts, report.zoned);
    }
    Ok(())
}
