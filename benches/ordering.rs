//! Factor times of two orders of elimination, on bodies in space and on a sheet.
//!
//! `cargo bench -p stationary-benches --bench ordering`

mod in_turn;

use std::time::Instant;

use stationary_calculus::{Ordering, SparseCholesky, SymmetricMatrix};

/// A block of cubes, each cut into six tetrahedra: three freedoms a node, an edge along each sum of
/// axes.
fn block([nx, ny, nz]: [usize; 3]) -> SymmetricMatrix {
    let node = |x: usize, y: usize, z: usize| x + nx * (y + ny * z);
    let edge: Vec<f64> = (0..36)
        .map(|entry| match (entry / 6, entry % 6) {
            (i, j) if i == j => 3.0,
            (i, j) if i % 3 == j % 3 => -2.5,
            _ => 0.1,
        })
        .collect();
    let along = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1], [1, 1, 1]];
    let mut blocks = Vec::new();
    for (v, [dx, dy, dz]) in (0..nx * ny * nz).flat_map(|v| along.map(|a| (v, a))) {
        let (x, y, z) = (v % nx + dx, v / nx % ny + dy, v / nx / ny + dz);
        if x < nx && y < ny && z < nz {
            let ends = [v, node(x, y, z)];
            let freedoms: Vec<usize> =
                ends.iter().flat_map(|end| (0..3).map(move |c| 3 * end + c)).collect();
            blocks.push((freedoms, edge.clone()));
        }
    }
    SymmetricMatrix::from_blocks(3 * nx * ny * nz, &blocks).expect("a block")
}

fn main() {
    println!("{:55} factor by nested dissection / by minimum degree", "body");
    for (name, sides) in [
        ("cube, 27,783 freedoms", [21, 21, 21]),
        ("bar, 30,420 freedoms", [60, 13, 13]),
        ("sheet, 30,000 freedoms", [100, 100, 1]),
    ] {
        let matrix = block(sides);
        let [mut dissected, mut usual] =
            [Ordering::NestedDissection, Ordering::MinimumDegree].map(|ordering| {
                let start = Instant::now();
                let cholesky = SparseCholesky::analyse_by(&matrix, ordering).expect("an order");
                let seconds = start.elapsed().as_secs_f64();
                println!(
                    "{name}, {ordering:?}: analysed in {seconds:.3} s, {} numbers",
                    cholesky.factor_len()
                );
                cholesky
            });
        in_turn::ratio(
            name,
            || dissected.factor(&matrix).expect("a definite matrix"),
            || usual.factor(&matrix).expect("a definite matrix"),
        );
    }
}
