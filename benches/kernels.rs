//! The hot kernels of every crate: nanoseconds of each, the least of many runs.
//!
//! `cargo bench --bench kernels` times them as this workspace tunes its benches, and `cargo bench
//! --profile defaults --bench kernels` as Cargo's own release profile builds what depends on the
//! crates. `cargo xtask kernels` runs both in turn and prints one table.

use std::hint::black_box;
use std::time::Instant;

use nalgebra::Vector3;
use stationary_calculus::{Covector, Potential, SymmetricMatrix};
use stationary_constraints::problems::writhing_chain;
use stationary_constraints::{ConstrainedIntegrator, Rattle, SparseDiagonal};
use stationary_contact::SpatialWorld;
use stationary_contact::problems::falling_boxes;
use stationary_elasticity::{
    Elements as _, FixedCorotated, Freedoms, Lame, LinearTetrahedron, Material, NeoHookean,
    SaintVenantKirchhoff, Solid,
};
use stationary_integrators::problems::{kepler, van_der_pol};
use stationary_integrators::{
    AdaptiveMethod, DormandPrince853, Integrator, RadauIia5, RungeKutta4, StepControl,
    StormerVerlet, Tolerance,
};
use stationary_laplacian::{Domain, Elements};
use stationary_measure::SplitMix64;
use stationary_mesh::{cuboid, torus};
use stationary_rigid::{
    Body, BodyMethod, BodyMetric, BodyMotion, Free, LieGroup, Poses, RigidMotion, Rotation,
    right_jacobian,
};

/// Runs of each kernel, of about this many seconds at least.
const RUNS: usize = 41;
const SECONDS: f64 = 2e-3;

/// Prints the least time of a run over `units`, as `cargo xtask kernels` reads it.
fn kernel(name: &str, units: usize, mut run: impl FnMut()) {
    let mut time = |repeats: usize| {
        let start = Instant::now();
        (0..repeats).for_each(|_| run());
        start.elapsed().as_secs_f64() / repeats as f64
    };
    let repeats = (SECONDS / time(1).max(1e-9)).ceil() as usize;
    let least = (0..RUNS).map(|_| time(repeats)).fold(f64::INFINITY, f64::min);
    println!("{name}\t{:.2}", 1e9 * least / units as f64);
}

fn elements(name: &str, material: impl Material<3, 3>) {
    let mesh = cuboid([4.0, 1.0, 1.0], [24, 6, 6]).expect("a bar");
    let count = mesh.simplices().len();
    let freedoms = Freedoms::<3>::free(mesh.vertices().len()).expect("few vertices");
    let solid = Solid::new(LinearTetrahedron, &mesh, 1.0, material, freedoms).expect("a solid");
    let bent = |[x, y, z]: [f64; 3]| [x * 1.05 + 0.02 * (3.0 * y).sin(), y + 0.05 * x.sin(), z];
    let q: Vec<f64> = mesh.nodes().into_iter().flat_map(bent).collect();
    let mut dv = vec![0.0; q.len()];
    let matrix = SymmetricMatrix::analyse(q.len(), |sink| solid.add_hessian(&q, sink));
    let mut matrix = matrix.expect("a pattern");
    kernel(&format!("{name}: energy, an element"), count, || {
        black_box(solid.energy(black_box(&q)));
    });
    kernel(&format!("{name}: differential, an element"), count, || {
        dv.fill(0.0);
        solid.add_differential(black_box(&q), Covector(&mut dv));
        black_box(&dv);
    });
    kernel(&format!("{name}: Hessian, an element"), count, || {
        let filled = matrix.refill(|sink| solid.add_hessian(black_box(&q), sink));
        filled.expect("the same blocks");
        black_box(matrix.values());
    });
}

fn rotations() {
    const TURNS: usize = 1_000;
    let mut random = SplitMix64::new(1);
    let mut number = || random.symmetric();
    let turns: Vec<_> = (0..TURNS).map(|_| Vector3::new(number(), number(), number())).collect();
    let rotations: Vec<_> = turns.iter().map(|&turn| Rotation::exp(turn)).collect();
    kernel("exp of a turn", TURNS, || {
        turns.iter().for_each(|&turn| _ = black_box(Rotation::exp(turn)));
    });
    kernel("log of a rotation", TURNS, || {
        rotations.iter().for_each(|rotation| _ = black_box(rotation.log()));
    });
    kernel("right Jacobian of a turn", TURNS, || {
        turns.iter().for_each(|turn| _ = black_box(right_jacobian(turn)));
    });
}

fn free_bodies() {
    const BODIES: usize = 500;
    let body = Body::solid_box(1.0, [0.1, 0.2, 0.3]).expect("a box");
    let metric = BodyMetric::<Poses>::new(vec![body; BODIES]);
    let motion = BodyMotion {
        pose: RigidMotion::identity(),
        velocity: Vector3::new(0.1, 0.2, 0.3),
        angular_velocity: Vector3::new(1.0, 2.0, 3.0),
    };
    let initial = metric.state(&vec![motion; BODIES]).expect("finite motions");
    let system = metric.under(Free { freedoms: 6 * BODIES }).expect("as many freedoms");
    for &method in BodyMethod::ALL {
        let mut integrator = method.integrator(&system).expect("a method of bodies");
        let mut state = initial.clone();
        kernel(&format!("{method}: a body and step"), BODIES, || {
            integrator.step(&mut state, 1e-3).expect("a step of a millisecond");
        });
    }
}

fn planet() {
    let planet = kepler(0.6).expect("a planet");
    let mut state = planet.initial.clone();
    let mut verlet = StormerVerlet::new(&planet.system).expect("two freedoms");
    kernel("stormer-verlet: a step of a planet", 1, || {
        verlet.step(&mut state, 1e-3).expect("a step");
    });
    let mut state = planet.initial.clone();
    let mut classical = RungeKutta4::new(&planet.system).expect("two freedoms");
    kernel("runge-kutta-4: a step of a planet", 1, || {
        classical.step(&mut state, 1e-3).expect("a step");
    });
}

fn adaptive_steps() {
    let problem = van_der_pol(1000.0).expect("an oscillator");
    let control = StepControl::from(Tolerance::new(1e-6, 1e-6).expect("a tolerance"));
    let mut explicit =
        DormandPrince853::new(&problem.field, control.clone(), problem.initial.clone())
            .expect("a method");
    kernel("dormand-prince-853: a step", 1, || {
        if explicit.step(problem.end).is_err() || explicit.moment().t >= problem.end {
            explicit.restart(&problem.initial).expect("a start");
        }
    });
    let mut implicit =
        RadauIia5::new(&problem.field, control, problem.initial.clone()).expect("a method");
    kernel("radau-iia-5: a step", 1, || {
        if implicit.step(problem.end).is_err() || implicit.moment().t >= problem.end {
            implicit.restart(&problem.initial).expect("a start");
        }
    });
}

fn chain() {
    const LINKS: usize = 300;
    let chain = writhing_chain(LINKS, 100.0).expect("a chain");
    let mut state = chain.initial.clone();
    let rattle = Rattle::new(&chain.system, chain.rods, &chain.initial, SparseDiagonal::default());
    let mut rattle = rattle.expect("a feasible state");
    let mut count = 0_u32;
    kernel("rattle: a link and step", LINKS, || {
        // To and fro, so that the motion stays as lively as it is.
        count += 1;
        if count.is_multiple_of(4) {
            state.p.0.iter_mut().for_each(|p| *p = -*p);
        }
        rattle.step(&mut state, 1e-4).expect("a step");
    });
}

fn pile() {
    const BOXES: usize = 64;
    let pile = falling_boxes(BOXES).expect("a pile");
    let mut detector = pile.detector().expect("colliders of these bodies");
    let bodies = SpatialWorld::new(pile.system.clone(), pile.detector().expect("colliders"));
    let mut bodies = bodies.expect("bodies").with_tolerance(0.03).expect("a tolerance");
    let mut state = pile.state.clone();
    (0..2_000).for_each(|_| _ = bodies.step(&mut state, 1e-3).expect("a step"));
    kernel("detection: a box of a pile", BOXES, || {
        black_box(detector.detect(&state.q, 1e-3).expect("detection"));
    });
    kernel("touching bodies: a box of a pile and step", BOXES, || {
        bodies.step(&mut state, 1e-3).expect("a step");
    });
}

fn surface() {
    let mesh = torus([2.0, 0.7], [80, 50]).expect("a torus");
    let count = mesh.simplices().len();
    let domain = Domain::free(Elements::of(&mesh).expect("elements")).expect("a domain");
    let anywhere = vec![0.0; domain.dim()];
    let dirichlet = domain.dirichlet();
    let mut matrix = SymmetricMatrix::hessian(dirichlet, &anywhere).expect("a matrix");
    kernel("Laplacian: weights of a triangle", count, || {
        black_box(Elements::of(&mesh).expect("elements"));
    });
    kernel("Laplacian: matrix, a triangle", count, || {
        matrix.refill(|sink| dirichlet.add_hessian(&anywhere, sink)).expect("the same pattern");
    });
}

fn main() {
    let lame = Lame::<3>::from_young_poisson(1e6, 0.3).expect("rubber");
    elements("Saint Venant-Kirchhoff", SaintVenantKirchhoff::new(lame));
    elements("neo-Hookean", NeoHookean::new(lame).expect("rubber"));
    elements("fixed corotated", FixedCorotated::new(lame).expect("rubber"));
    rotations();
    free_bodies();
    planet();
    adaptive_steps();
    chain();
    pile();
    surface();
}
