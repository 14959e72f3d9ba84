//! Elements of a solid: energy, differential and Hessian of 52,728 linear tetrahedra.
//!
//! `cargo bench -p stationary-benches --bench solid` prints nanoseconds an element on one thread,
//! the least of many runs, on the mesh and the configuration of a reference in C++ with Eigen that
//! was run beside it: a bar of 52 x 13 x 13 cells of six tetrahedra, bent and stretched. The
//! Hessian goes into the fixed pattern of its sparse lower triangle. Then ratios of runs taken in
//! turn: materials, the projection to positive semidefinite where the bar is bent (part of each
//! section is pressed), swollen (nothing is) and crushed (elements of a random shape, some inside
//! out), two threads, the work that two parts do more than one, and what the machine itself gives
//! two threads: a loop of arithmetic that neither waits for memory nor shares any.

mod in_turn;

use std::hint::black_box;
use std::time::Instant;

use stationary_calculus::{Covector, Curvature, Potential, Sink, SymmetricMatrix, side_by_side};
use stationary_elasticity::{
    Elements, FixedCorotated, Freedoms, Lame, LinearTetrahedron, Material, NeoHookean,
    SaintVenantKirchhoff, Solid,
};
use stationary_mesh::{Mesh, cuboid};

const RUNS: usize = 61;

/// Nanoseconds an element: the least of the runs.
fn least(elements: usize, mut run: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    1e9 * (0..RUNS).map(time).fold(f64::INFINITY, f64::min) / elements as f64
}

/// Takes blocks and adds up what they hold.
struct Nowhere(f64);

impl Sink for Nowhere {
    fn add_symmetric(&mut self, _freedoms: &[usize], block: &[f64]) {
        self.0 += block.iter().sum::<f64>();
    }

    #[inline(always)]
    fn add_lower<const V: usize, const D: usize>(
        &mut self,
        _freedoms: &[[usize; D]; V],
        column: impl Fn(usize, usize, usize) -> [f64; D],
    ) {
        for b in 0..V {
            for d in 0..D {
                for a in b..V {
                    self.0 += column(b, d, a).iter().sum::<f64>();
                }
            }
        }
    }
}

type Body<M> = Solid<M, 4, 3, 3, 1>;

/// What is timed: a body, a configuration, and where its derivatives go.
struct Bench<M> {
    solid: Body<M>,
    q: Vec<f64>,
    dv: Vec<f64>,
    matrix: SymmetricMatrix,
}

impl<M: Material<3, 3>> Bench<M> {
    fn new(mesh: &Mesh<3, 4>, material: M, parts: usize) -> Self {
        let freedoms = Freedoms::<3>::free(mesh.vertices().len()).expect("few vertices");
        let solid = Solid::new(LinearTetrahedron, mesh, 1.0, material, freedoms);
        let solid = solid.expect("a mesh without flaws").in_parts(parts);
        let place = |[x, y, z]: [f64; 3]| {
            [x * 1.05 + 0.02 * (3.0 * y).sin(), y + 0.05 * (2.0 * x).sin(), z * 0.98 + 0.03 * x * y]
        };
        let q: Vec<f64> = mesh.nodes().into_iter().flat_map(place).collect();
        let matrix = SymmetricMatrix::analyse(q.len(), |sink| solid.add_hessian(&q, sink));
        Bench { solid, dv: vec![0.0; q.len()], q, matrix: matrix.expect("a pattern") }
    }

    fn projected(self) -> Self {
        Bench { solid: self.solid.with_curvature(Curvature::Semidefinite), ..self }
    }

    fn swollen(mut self) -> Self {
        self.q.iter_mut().for_each(|q| *q *= 1.1);
        self
    }

    /// Every vertex is shifted by up to four tenths of a cell.
    fn crushed(mut self) -> Self {
        let noise = |k: usize| (12.9898 * k as f64).sin() * 43758.5453;
        for (k, q) in self.q.iter_mut().enumerate() {
            *q = 0.8 * *q + (noise(k).rem_euclid(1.0) - 0.5) * 0.8 / 13.0;
        }
        self
    }

    fn energy(&mut self) {
        black_box(self.solid.energy(black_box(&self.q)));
    }

    fn differential(&mut self) {
        self.dv.fill(0.0);
        self.solid.add_differential(black_box(&self.q), Covector(&mut self.dv));
        black_box(&self.dv);
    }

    fn hessian(&mut self) {
        let filled = self.matrix.refill(|sink| self.solid.add_hessian(black_box(&self.q), sink));
        filled.expect("the same blocks");
        black_box(self.matrix.values());
    }

    /// The elements' Hessians without the matrix that they belong into.
    fn blocks(&mut self) {
        let mut sink = Nowhere(0.0);
        self.solid.add_hessian(black_box(&self.q), &mut sink);
        black_box(sink.0);
    }

    fn report(&mut self, name: &str) {
        let n = self.solid.elements();
        let numbers = [
            least(n, || self.energy()),
            least(n, || self.differential()),
            least(n, || self.hessian()),
            least(n, || self.blocks()),
        ];
        let [energy, differential, hessian, blocks] = numbers;
        println!("{name:24} {energy:8.1} {differential:12.1} {hessian:8.1} {blocks:12.1}");
    }
}

fn main() {
    let mesh = cuboid([4.0, 1.0, 1.0], [52, 13, 13]).expect("a bar");
    let lame = Lame::<3>::from_young_poisson(1e6, 0.3).expect("rubber");
    let (quadratic, rubber) = (SaintVenantKirchhoff::new(lame), NeoHookean::new(lame));
    let (rubber, corotated) = (rubber.expect("rubber"), FixedCorotated::new(lame).expect("rubber"));
    println!("{} elements, ns an element", mesh.simplices().len());
    println!("material                   energy differential  Hessian   its blocks");
    let mut one = Bench::new(&mesh, quadratic, 1);
    one.report("Saint Venant-Kirchhoff");
    Bench::new(&mesh, rubber, 1).report("neo-Hookean");
    Bench::new(&mesh, corotated, 1).report("fixed corotated");

    println!("\nratios, median of pairs (quartiles)");
    let mut other = Bench::new(&mesh, rubber, 1);
    in_turn::ratio("energy, neo-Hookean / quadratic", || other.energy(), || one.energy());
    in_turn::ratio("differential", || other.differential(), || one.differential());
    in_turn::ratio("Hessian", || other.hessian(), || one.hessian());
    projection("Saint Venant-Kirchhoff", || Bench::new(&mesh, quadratic, 1));
    projection("neo-Hookean", || Bench::new(&mesh, rubber, 1));
    // From within the pool, as a program would that calls many times: entering it costs a wake-up.
    let on = |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    // Numbered along its length: few elements belong to both parts.
    let mesh = cuboid([1.0, 1.0, 4.0], [13, 13, 52]).expect("a bar");
    let [mut one, mut two] = [1, 2].map(|parts| Bench::new(&mesh, quadratic, parts));
    on(1).expect("a thread").install(|| {
        let name = "differential, two parts / one, one thread";
        in_turn::ratio(name, || two.differential(), || one.differential());
        in_turn::ratio("Hessian", || two.hessian(), || one.hessian());
    });
    on(2).expect("two threads").install(|| {
        in_turn::ratio("energy, one part / two on two threads", || one.energy(), || two.energy());
        in_turn::ratio("differential", || one.differential(), || two.differential());
        in_turn::ratio("Hessian", || one.hessian(), || two.hessian());
        for (name, steps) in [("arithmetic of 1 ms", 1 << 19), ("arithmetic of 8 ms", 1 << 22)] {
            in_turn::ratio(
                name,
                || {
                    black_box([arithmetic(steps / 2), arithmetic(steps / 2)]);
                },
                || {
                    let half = || {
                        black_box(arithmetic(steps / 2));
                    };
                    side_by_side(&mut { half }, &mut { half });
                },
            );
        }
    });
}

/// The elements' Hessians, projected over exact, in three shapes.
fn projection<M: Material<3, 3>>(name: &str, bar: impl Fn() -> Bench<M>) {
    let ratio = |shape: &str, mut exact: Bench<M>, projected: Bench<M>| {
        let mut projected = projected.projected();
        let name = format!("{name}, blocks, projected / exact, {shape}");
        in_turn::ratio(&name, || projected.blocks(), || exact.blocks());
    };
    ratio("bent", bar(), bar());
    ratio("swollen", bar().swollen(), bar().swollen());
    ratio("crushed", bar().crushed(), bar().crushed());
}

/// A loop that two threads share nothing of: four chains of products, no memory.
fn arithmetic(steps: usize) -> f64 {
    let mut chains = black_box([1.0, 1.1, 1.2, 1.3]);
    for _ in 0..steps {
        chains = chains.map(|x: f64| x * 0.999_999 + 1e-6);
    }
    chains.iter().sum()
}
