//! Elements of a solid: energy, differential and Hessian of 52,728 linear tetrahedra.
//!
//! `cargo bench --bench solid` prints nanoseconds an element on one thread, the median of many runs, on
//! the mesh and the configuration of a reference in C++ with Eigen that was run beside it: a bar of 52 x
//! 13 x 13 cells of six tetrahedra, bent and stretched. The Hessian goes into the fixed pattern of its
//! sparse lower triangle.

use std::hint::black_box;
use std::time::Instant;

use stationary_calculus::{Covector, Curvature, Potential, Sink, SymmetricMatrix};
use stationary_elasticity::{
    FixedCorotated, Freedoms, Lame, LinearTetrahedron, Material, NeoHookean, SaintVenantKirchhoff,
    Solid,
};
use stationary_mesh::{Mesh, cuboid};

const RUNS: usize = 31;

/// Nanoseconds an element: the median of the runs.
fn median(elements: usize, mut run: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    1e9 * times[RUNS / 2] / elements as f64
}

/// Takes blocks and does next to nothing with them.
struct Nowhere(f64);

impl Sink for Nowhere {
    #[inline(always)]
    fn add_symmetric(&mut self, _freedoms: &[usize], block: &[f64]) {
        self.0 += block[0] + block[79];
    }
}

fn report(name: &str, mesh: &Mesh<3, 4>, material: impl Material<3, 3>) {
    let freedoms = Freedoms::<3>::free(mesh.vertices().len()).expect("few vertices");
    let solid =
        Solid::new(LinearTetrahedron, mesh, 1.0, material, freedoms).expect("a mesh without flaws");
    let q: Vec<f64> = mesh
        .vertices()
        .iter()
        .flat_map(|x| {
            [
                x.x * 1.05 + 0.02 * (3.0 * x.y).sin(),
                x.y + 0.05 * (2.0 * x.x).sin(),
                x.z * 0.98 + 0.03 * x.x * x.y,
            ]
        })
        .collect();
    let mut dv = vec![0.0; q.len()];
    let n = mesh.simplices().len();
    let energy = median(n, || {
        black_box(solid.energy(black_box(&q)));
    });
    let differential = median(n, || {
        dv.fill(0.0);
        solid.add_differential(black_box(&q), Covector(&mut dv));
        black_box(&dv);
    });
    let mut matrix =
        SymmetricMatrix::analyse(q.len(), |sink| solid.add_hessian(&q, sink)).expect("a pattern");
    let hessian = median(n, || {
        matrix.refill(|sink| solid.add_hessian(black_box(&q), sink)).expect("the same blocks");
        black_box(matrix.values());
    });
    let blocks = |solid: &Solid<_, 4, 3, 3, 1>| {
        median(n, || {
            let mut sink = Nowhere(0.0);
            solid.add_hessian(black_box(&q), &mut sink);
            black_box(sink.0);
        })
    };
    let alone = blocks(&solid);
    let projected = blocks(&solid.clone().with_curvature(Curvature::Semidefinite));
    println!(
        "{name:24} {energy:8.1} {differential:12.1} {hessian:8.1} {alone:10.1} {projected:12.1}"
    );
}

fn main() {
    let mesh = cuboid([4.0, 1.0, 1.0], [52, 13, 13]).expect("a bar");
    let lame = Lame::<3>::from_young_poisson(1e6, 0.3).expect("rubber");
    println!("{} elements, ns an element", mesh.simplices().len());
    println!("material                   energy differential  Hessian   its blocks   projected");
    report("Saint Venant-Kirchhoff", &mesh, SaintVenantKirchhoff::new(lame));
    report("neo-Hookean", &mesh, NeoHookean::new(lame).expect("rubber"));
    report("fixed corotated", &mesh, FixedCorotated::new(lame).expect("rubber"));
}
