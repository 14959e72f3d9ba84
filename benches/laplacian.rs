//! Laplacian, mass and heat on a torus of 200,000 triangles.
//!
//! `cargo bench -p stationary-benches --bench laplacian`

use std::hint::black_box;
use std::time::Instant;

use stationary_calculus::{Potential, SymmetricMatrix};
use stationary_laplacian::{Domain, Elements, Heat, HeatMethod};
use stationary_mesh::{IntrinsicSurface, torus};

/// The median of five runs, printed.
fn time<T>(what: &str, triangles: usize, mut run: impl FnMut() -> T) {
    let mut seconds: Vec<f64> = (0..5)
        .map(|_| {
            let start = Instant::now();
            black_box(run());
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    let [low, median, high] = [seconds[0], seconds[2], seconds[4]].map(|s| s * 1e3);
    let each = median * 1e6 / triangles as f64;
    println!("{what:50} {median:9.2} ms ({low:.2} to {high:.2}), {each:8.1} ns a triangle");
}

fn main() {
    let mesh = torus([2.0, 0.7], [400, 250]).expect("a torus");
    let count = mesh.simplices().len();
    time("checks: a manifold", count, || mesh.check_manifold().expect("a manifold"));
    time("checks and weights", count, || Elements::of(&mesh).expect("elements"));
    let elements = Elements::of(&mesh).expect("elements");
    let domain = Domain::free(elements).expect("a domain");
    let anywhere = vec![0.0; domain.dim()];
    let dirichlet = domain.dirichlet();
    time("lumped mass", count, || domain.lumped().expect("a mass"));
    time("matrix, first", count, || SymmetricMatrix::hessian(dirichlet, &anywhere).expect("one"));
    let mut matrix = SymmetricMatrix::hessian(dirichlet, &anywhere).expect("a matrix");
    time("matrix, refilled", count, || {
        matrix.refill(|sink| dirichlet.add_hessian(&anywhere, sink)).expect("the same pattern");
    });
    let mass = domain.lumped().expect("a mass");
    time("heat: one factorization and 100 steps", count, || {
        let method = HeatMethod::ImplicitEuler;
        let mut heat = Heat::new(&mass, dirichlet, method, 1.0, 1e-3).expect("a factor");
        let mut f = anywhere.clone();
        f[0] = 1.0;
        (0..100).for_each(|_| heat.step(&mut f).expect("a step"));
        f
    });
    time("heat: one factorization, a step of 100 functions", count, || {
        let method = HeatMethod::ImplicitEuler;
        let mut heat = Heat::new(&mass, dirichlet, method, 1.0, 1e-3).expect("a factor");
        let n = domain.dim();
        let mut functions = vec![0.0; 100 * n];
        (0..100).for_each(|k| functions[k * n + k] = 1.0);
        heat.step(&mut functions).expect("a step");
        functions
    });
    let skewed = mesh.mapped(|x| nalgebra::Vector3::new(x.x, x.y, x.z + x.y)).expect("a mesh");
    time("intrinsic surface, made Delaunay", count, || {
        let mut surface = IntrinsicSurface::of(&skewed).expect("a surface");
        surface.flip_to_delaunay().expect("flips that end");
        surface
    });
}
