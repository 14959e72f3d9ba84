//! Modes, Laplacians and heat beside SciPy, CHOLMOD, PARDISO and libigl, in turn in one run.
//!
//! `pip install -r benches/peers/requirements.txt` (what does not build is left out), then
//! `cargo bench -p stationary-benches --bench python_peers`. `PYTHON` names another interpreter.
//!
//! What both sides work on is written once, as plain numbers, to a folder of the build. Each turn then
//! times ours here and each peer in a process of its own, whose clock runs around the call alone; the
//! least of the turns is shown, and what both answer. All have one thread, and the clocks count the
//! time that it had: neighbours on the machine do not show, nor does a second core.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use rustix::time::{ClockId, clock_gettime};
use stationary_calculus::{SparseMetric, SymmetricMatrix};
use stationary_elasticity::{Freedoms, Lame, Linear, LinearTetrahedron, Solid, galerkin_mass};
use stationary_laplacian::{Dirichlet, Domain, Elements, Heat, HeatMethod};
use stationary_mesh::{Mesh, cuboid, torus};
use stationary_modal::{Linearized, RigidMotions};

const TURNS: usize = 7;
/// Cells of the cantilever along and across it.
const CELLS: [usize; 3] = [82, 10, 10];
const MODES: usize = 20;
const FUNCTIONS: usize = 100;
/// Heat's step, s, at a diffusivity of 1 m^2/s.
const STEP: f64 = 1e-3;

type Body = Solid<Linear<3>, 4, 3, 3, 1>;

/// Seconds, and a number that a peer must find as well.
type Run<'a> = (&'static str, &'static [&'static str], Box<dyn Fn() -> (f64, f64) + 'a>);

fn cantilever() -> (Body, SparseMetric, Vec<f64>) {
    let mesh = cuboid([8.2, 1.0, 1.0], CELLS).expect("a block");
    let nodes: Vec<[f64; 3]> = mesh.vertices().iter().map(|x| (*x).into()).collect();
    let freedoms = Freedoms::held_where(&nodes, |x, _| x[0] == 0.0).expect("freedoms");
    let steel = Linear::new(Lame::from_young_poisson(1.0, 0.3).expect("a material"));
    let mass = galerkin_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).expect("a mass");
    let q = freedoms.gathered(&nodes).expect("as many");
    (Solid::new(LinearTetrahedron, &mesh, 1.0, steel, freedoms).expect("a body"), mass, q)
}

fn seconds<T>(run: impl FnOnce() -> T) -> (f64, T) {
    let start = on_processor();
    let value = run();
    (on_processor() - start, value)
}

/// The seconds that this thread has had of a processor.
fn on_processor() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

fn modes((solid, mass, q): &(Body, SparseMetric, Vec<f64>)) -> (f64, f64) {
    seconds(|| {
        let mut body = Linearized::at(mass, solid, q, 1e-9).expect("at rest");
        let modes = body.lowest(MODES, &RigidMotions::none()).expect("modes");
        modes.values()[MODES - 1]
    })
}

/// The Laplacian of a surface and its mass, from the mesh.
fn assembled(mesh: &Mesh<3, 3>) -> (f64, f64) {
    seconds(|| {
        let domain = Domain::free(Elements::of(mesh).expect("elements")).expect("a domain");
        let mass = domain.lumped().expect("a mass");
        let anywhere = vec![0.0; domain.dim()];
        let matrix = SymmetricMatrix::hessian(domain.dirichlet(), &anywhere).expect("a matrix");
        matrix.values()[0] + mass.masses()[0]
    })
}

fn refilled(domain: &Domain<3>) -> (f64, f64) {
    let anywhere = vec![0.0; domain.dim()];
    let dirichlet: &Dirichlet<3> = domain.dirichlet();
    let mut matrix = SymmetricMatrix::hessian(dirichlet, &anywhere).expect("a matrix");
    let (seconds, ()) = seconds(|| {
        use stationary_calculus::Potential;
        matrix.refill(|sink| dirichlet.add_hessian(&anywhere, sink)).expect("the same pattern");
    });
    let mass = domain.lumped().expect("a mass");
    (seconds, matrix.values()[0] + mass.masses()[0])
}

fn heat(domain: &Domain<3>) -> (f64, f64) {
    let (n, mass) = (domain.dim(), domain.lumped().expect("a mass"));
    let mut functions = vec![0.0; FUNCTIONS * n];
    (0..FUNCTIONS).for_each(|k| functions[k * n + k] = 1.0);
    seconds(|| {
        let method = HeatMethod::ImplicitEuler;
        let mut heat = Heat::new(&mass, domain.dirichlet(), method, 1.0, STEP).expect("a factor");
        heat.step(&mut functions).expect("a step");
        functions[0]
    })
}

/// Writes numbers as the machine has them.
fn write<T: Copy, const B: usize>(
    path: PathBuf,
    numbers: &[T],
    bytes: impl Fn(T) -> [u8; B],
) -> io::Result<()> {
    let all: Vec<u8> = numbers.iter().flat_map(|&number| bytes(number)).collect();
    fs::write(path, all)
}

/// The lower triangle by columns: starts, rows, values.
fn write_matrix(folder: &Path, name: &str, matrix: &SymmetricMatrix) -> io::Result<()> {
    let file = |part: &str| folder.join(format!("{name}.{part}"));
    write(file("starts"), matrix.column_starts(), u32::to_ne_bytes)?;
    write(file("rows"), matrix.rows(), u32::to_ne_bytes)?;
    write(file("values"), matrix.values(), f64::to_ne_bytes)
}

fn write_mesh(folder: &Path, mesh: &Mesh<3, 3>) -> io::Result<()> {
    let vertices: Vec<f64> = mesh.vertices().iter().flat_map(|x| [x.x, x.y, x.z]).collect();
    let triangles: Vec<u64> =
        mesh.simplices().iter().flatten().map(|&vertex| vertex as u64).collect();
    write(folder.join("mesh.vertices"), &vertices, f64::to_ne_bytes)?;
    write(folder.join("mesh.triangles"), &triangles, u64::to_ne_bytes)
}

/// Seconds and answer of a peer, or why there are none.
fn peer(folder: &Path, task: &str, name: &str) -> Result<(f64, f64), String> {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/peers/sparse_peers.py");
    let one_thread = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"];
    let output = Command::new(python)
        .envs(one_thread.map(|name| (name, "1")))
        .args([script.as_ref(), folder.as_os_str(), task.as_ref(), name.as_ref()])
        .output()
        .map_err(|error| error.to_string())?;
    let said = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<f64> = said.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match numbers[..] {
        [seconds, answer] if output.status.success() => Ok((seconds, answer)),
        _ => {
            let error = String::from_utf8_lossy(&output.stderr);
            Err(error.lines().last().unwrap_or("it says nothing").to_owned())
        }
    }
}

/// The least seconds of some turns, ours first, and what each answers.
fn in_turn(folder: &Path, (task, peers, ours): &Run<'_>) {
    let mut best: Vec<Result<(f64, f64), String>> = vec![Ok((f64::INFINITY, 0.0)); peers.len() + 1];
    for _ in 0..TURNS {
        for (place, best) in best.iter_mut().enumerate() {
            let run = match place {
                0 => Ok(ours()),
                _ => peer(folder, task, peers[place - 1]),
            };
            *best = match (best.clone(), run) {
                (Ok((least, _)), Ok((seconds, answer))) => Ok((least.min(seconds), answer)),
                (_, failed) => failed,
            };
        }
    }
    let Ok((least, answer)) = best[0] else { return };
    println!("{task}: ours {:.1} ms, answer {answer:.12e}", 1e3 * least);
    for (name, best) in peers.iter().zip(&best[1..]) {
        match best {
            Ok((seconds, answer)) => println!(
                "    {name:20} {:9.1} ms, ours is {:.3} of it, answer {answer:.12e}",
                1e3 * seconds,
                least / seconds
            ),
            Err(error) => println!("    {name:20} is not here: {error}"),
        }
    }
}

fn main() -> io::Result<()> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("python_peers");
    fs::create_dir_all(&folder)?;
    let body = cantilever();
    let stiffness = SymmetricMatrix::hessian(&body.0, &body.2).expect("a stiffness");
    write_matrix(&folder, "stiffness", &stiffness)?;
    write_matrix(&folder, "mass", &SymmetricMatrix::mass(&body.1).expect("a mass"))?;
    let mesh = torus([2.0, 0.7], [400, 250]).expect("a torus");
    write_mesh(&folder, &mesh)?;
    let domain = Domain::free(Elements::of(&mesh).expect("elements")).expect("a domain");
    let anywhere = vec![0.0; domain.dim()];
    let weights = SymmetricMatrix::hessian(domain.dirichlet(), &anywhere).expect("a matrix");
    write_matrix(&folder, "weights", &weights)?;
    write(folder.join("areas"), domain.lumped().expect("a mass").masses(), f64::to_ne_bytes)?;
    println!("{} freedoms, {} triangles", body.2.len(), mesh.simplices().len());
    let solvers = &["cholmod", "pardiso", "superlu"];
    // SuperLU takes minutes for a solid of this size.
    let quick = &["cholmod", "pardiso"];
    let runs: [Run<'_>; 4] = [
        ("assembly", &["libigl"], Box::new(|| assembled(&mesh))),
        ("refill", &["libigl"], Box::new(|| refilled(&domain))),
        ("heat", solvers, Box::new(|| heat(&domain))),
        ("modes", quick, Box::new(|| modes(&body))),
    ];
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    for run in &runs {
        if wanted.is_empty() || wanted.iter().any(|task| task == run.0) {
            in_turn(&folder, run);
        }
    }
    Ok(())
}
