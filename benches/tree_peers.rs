//! Forward dynamics of a tree of thirty hinges beside Pinocchio's `aba` and MuJoCo's `mj_forward`.
//!
//! `pip install -r benches/peers/requirements.txt`, then `cargo bench -p stationary-benches --bench tree_peers`.
//! `PYTHON` names another interpreter.
//!
//! The tree and many states of it are written once, as plain numbers, to a folder of the build. Ours and each peer's
//! accelerations are compared first. Each turn then times ours here and each peer in a process of its own, over all
//! states in one call, by the time that the thread had of a processor; the least of the turns is shown, in
//! microseconds a state. MuJoCo has no contacts to look for, and repeats one state.

use std::fs;
use std::io;
use std::path::Path;
use std::process::Command;

use nalgebra::Vector3;
use rustix::time::{ClockId, clock_gettime};
use stationary_measure::SplitMix64;
use stationary_rigid::tree::{Tree, TreeBuilder, TreeForces, TreeMotion};
use stationary_rigid::{Body, JointKind, LieGroup, RigidMotion, Rotation};

const HINGES: usize = 30;
const STATES: usize = 2_000;
const TURNS: usize = 7;
const GRAVITY: f64 = -9.81;

/// The tree, and its numbers for others: of each body its parent (-1 is the world), axis, place of the joint on the
/// parent and on itself from the centres, mass and moments.
fn tree(random: &mut SplitMix64) -> (Tree, Vec<f64>) {
    let (mut builder, mut numbers) = (TreeBuilder::default(), Vec::new());
    for body in 0..HINGES {
        // Branches of some length: one in four forks further back.
        let back = if random.symmetric() > 0.5 { 3 } else { 1 };
        let parent = body.checked_sub(back).or(body.checked_sub(1));
        let mut vector = |size: f64| Vector3::from_fn(|_, _| size * random.symmetric());
        let (axis, foot, own, half) =
            (vector(1.0).normalize(), vector(0.3), vector(0.3), vector(0.1).map(|c| 0.1 + c.abs()));
        let solid = Body::solid_box(1.0 + half.x, half.into()).expect("a box");
        let at = |translation| RigidMotion { translation, rotation: Rotation::identity() };
        builder.hang(parent, JointKind::Hinge { axis }, [at(foot), at(own)], solid);
        numbers.push(parent.map_or(-1.0, |parent| parent as f64));
        [axis, foot, own].iter().for_each(|v| numbers.extend_from_slice(v.as_slice()));
        numbers.push(solid.mass());
        numbers.extend_from_slice(solid.moments().as_slice());
    }
    (builder.build().expect("a tree"), numbers)
}

/// The seconds that this thread has had of a processor.
fn on_processor() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// Writes the accelerations of all states; the seconds that they took.
fn ours(motion: &mut TreeMotion, weight: &TreeForces, states: &[f64], found: &mut [f64]) -> f64 {
    let start = on_processor();
    for (state, found) in states.chunks_exact(2 * HINGES).zip(found.chunks_exact_mut(HINGES)) {
        let (q, v) = state.split_at(HINGES);
        motion.place(q, v).expect("a state");
        motion.forward_dynamics(weight, found).expect("accelerations");
    }
    on_processor() - start
}

/// Seconds a state of a peer, and accelerations of the first states, or why there are none.
fn peer(folder: &Path, name: &str) -> Result<(f64, Vec<f64>), String> {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/peers/tree_peers.py");
    let one_thread = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"];
    let output = Command::new(python)
        .envs(one_thread.map(|name| (name, "1")))
        .args([script.as_ref(), folder.as_os_str(), name.as_ref()])
        .output()
        .map_err(|error| error.to_string())?;
    let said = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<f64> = said.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match numbers.split_first() {
        Some((&seconds, found)) if output.status.success() => Ok((seconds, found.to_vec())),
        _ => {
            let error = String::from_utf8_lossy(&output.stderr);
            Err(error.lines().last().unwrap_or("it says nothing").to_owned())
        }
    }
}

fn main() -> io::Result<()> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("tree_peers");
    fs::create_dir_all(&folder)?;
    let mut random = SplitMix64::new(30);
    let (tree, numbers) = tree(&mut random);
    let states: Vec<f64> = (0..2 * HINGES * STATES).map(|_| 2.0 * random.symmetric()).collect();
    for (name, numbers) in [("tree", &numbers), ("states", &states)] {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_ne_bytes()).collect();
        fs::write(folder.join(name), bytes)?;
    }
    let weight = TreeForces::weight(&tree, Vector3::z() * GRAVITY).expect("a weight");
    let (mut motion, mut found) = (TreeMotion::new(tree), vec![0.0; HINGES * STATES]);
    let mut least = ours(&mut motion, &weight, &states, &mut found);
    println!("a tree of {HINGES} hinges, forward dynamics of {STATES} states");
    for name in ["pinocchio", "mujoco"] {
        let mut best = f64::INFINITY;
        for _ in 0..TURNS {
            least = least.min(ours(&mut motion, &weight, &states, &mut found));
            let theirs = match peer(&folder, name) {
                Ok((seconds, theirs)) => {
                    best = best.min(seconds);
                    theirs
                }
                Err(error) => {
                    println!("    {name:10} is not here: {error}");
                    break;
                }
            };
            let size = found[..theirs.len()].iter().fold(0.0_f64, |size, a| size.max(a.abs()));
            let pairs = found.iter().zip(&theirs);
            let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size;
            assert!(!theirs.is_empty() && off < 1e-9, "{name} has other accelerations: {off:e}");
        }
        if best.is_finite() {
            let own = least / STATES as f64;
            println!(
                "    {name:10} {:7.2} us a state, ours {:.2} us, {:.3} of it",
                1e6 * best,
                1e6 * own,
                own / best
            );
        }
    }
    Ok(())
}
