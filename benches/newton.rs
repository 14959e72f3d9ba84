//! An implicit step of 52,728 tetrahedra: what a Newton iteration costs beside its factor and
//! solve.
//!
//! `cargo bench -p stationary-benches --bench newton` takes steps of implicit Euler, 10 ms each, of
//! a bar of rubber that was bent and let go, and in turn with each of them factors and solves the
//! matrix of the step's start. A step's time over its iterations holds the element Hessians, the
//! scatter, the residuals and the line search besides.

use std::time::Instant;

use stationary_calculus::{
    Covector, Curvature, Metric, Ordering, Potential, SparseCholesky, SparseSolver,
    SymmetricMatrix, System,
};
use stationary_elasticity::{
    Elements, Freedoms, Lame, LinearTetrahedron, NeoHookean, Solid, lumped_mass,
};
use stationary_integrators::{ImplicitEuler, Integrator, State};
use stationary_mesh::cuboid;

const H: f64 = 0.01;
const STEPS: usize = 5;

fn seconds(run: impl FnOnce()) -> f64 {
    let start = Instant::now();
    run();
    start.elapsed().as_secs_f64()
}

fn main() {
    let mesh = cuboid([4.0, 1.0, 1.0], [52, 13, 13]).expect("a bar");
    let freedoms = Freedoms::<3>::held_where(&mesh.nodes(), |x, _| x[0] == 0.0).expect("a clamp");
    let mass = lumped_mass(LinearTetrahedron, &mesh, [1e3, 1.0], &freedoms).expect("a mass");
    let lame = Lame::<3>::from_young_poisson(1e6, 0.3).expect("rubber");
    let rubber = NeoHookean::new(lame).expect("rubber");
    let bent: Vec<[f64; 3]> =
        mesh.nodes().iter().map(|&[x, y, z]| [x, y, z + 0.02 * x * x]).collect();
    let q = freedoms.gathered(&bent).expect("one place a vertex");
    let solid = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms).expect("a solid");
    let solid = solid.with_curvature(Curvature::Semidefinite);
    let system = System::new(mass, solid).expect("one size");
    let (mass, solid) = (system.metric(), system.potential());

    let order = Ordering::NestedDissection;
    let mut matrix = SymmetricMatrix::analyse(q.len(), |sink| {
        mass.add_matrix(sink);
        solid.add_hessian(&q, sink);
    })
    .expect("a pattern");
    let mut factor = SparseCholesky::analyse_by(&matrix, order).expect("an order");
    let solver = SparseSolver::by_ordering(mass, solid, &q, order).expect("a solver");
    let mut method = ImplicitEuler::with_solver(&system, solver).expect("one size");

    println!("{} elements, {} freedoms", mesh.simplices().len(), q.len());
    println!("iterations   step [s]   factor and solve [s]   an iteration over it");
    let mut ratios = Vec::new();
    let mut state = State::new(q, Covector(vec![0.0; mass.dim()]));
    for _ in 0..STEPS {
        let filled = matrix.refill(|sink| {
            mass.add_matrix(sink.weighted(1.0));
            solid.add_hessian(&state.q, sink.weighted(H * H));
        });
        filled.expect("the same blocks");
        let mut r = state.q.clone();
        let mut iterations = 0;
        let step = seconds(|| {
            iterations = method.step(&mut state, H).expect("a step").hessians;
        });
        let alone = seconds(|| {
            factor.factor(&matrix).expect("a definite matrix");
            factor.solve(&mut r);
        });
        let ratio = step / f64::from(iterations) / alone;
        println!("{iterations:10} {step:10.3} {alone:22.3} {ratio:22.2}");
        ratios.push(ratio);
    }
    ratios.sort_by(f64::total_cmp);
    println!("the median of {STEPS} steps: {:.2}", ratios[STEPS / 2]);
}
