//! Contact beside rapier, Box2D, Box3D, MuJoCo and drake: five problems, detection alone, and error against time of
//! five scenes in one run, steps in turn.
//!
//! `cargo run --manifest-path benches/contact/Cargo.toml`; with `PYTHON` the name of an interpreter
//! that has `mujoco` and `drake`, those too. Processor time of one thread each. What is left is measured from each
//! engine's own states by our detector, over a step, for ours as for theirs: how fast bodies still
//! close once their gaps are used up, what of the momentum no impulses in Coulomb's cones explain, and
//! how deep bodies overlap. Peers keep their defaults.

mod box2d;
mod box3d;
mod cenic;
mod chains;
mod detection;
mod mujoco;
mod quality;
mod space;
mod wall;

use rustix::time::{ClockId, clock_gettime};

/// The step, s.
pub const STEP: f64 = 1e-3;
/// Substeps that Box2D and Box3D make of it.
pub const SUBSTEPS: i32 = 4;
/// Steps between two looks.
pub const LOOKS: usize = 50;

/// What an engine took and left in a problem.
#[derive(Clone, Debug, Default)]
pub struct Row {
    pub name: String,
    /// Processor time, s.
    pub time: f64,
    pub left: quality::Left,
    /// How far the farthest is from where it started, m.
    pub drift: f64,
}

impl Row {
    pub fn named(name: &str) -> Self {
        Row { name: name.to_owned(), ..Row::default() }
    }

    /// Counts what a piece of code takes.
    pub fn timed<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let start = on_processor();
        let made = work();
        self.time += on_processor() - start;
        made
    }
}

/// The seconds that this thread has had of a processor.
pub fn on_processor() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// A table of a problem: times over that of the first peer.
fn print(problem: &str, rows: &[Row]) {
    println!("\n{problem}");
    println!(
        "| engine | time, s | over the second | closes, m/s | unexplained, m/s | overlap, m | drift, m |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for Row { name, time, left, drift } in rows {
        println!(
            "| {name} | {time:.2} | {:.3} | {:.1e} | {:.1e} | {:.1e} | {drift:.1e} |",
            time / rows[1].time,
            left.closes,
            left.unexplained,
            left.overlap
        );
    }
}

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let asked = |name: &str| wanted.is_empty() || wanted.iter().any(|wanted| wanted == name);
    if asked("falling") {
        print("1,000 boxes that fall, 3 s", &space::falling(1_000, 3.0));
    }
    if asked("columns") {
        print("100 columns of ten boxes, 1 s, after 2 s", &space::columns(100, 10, 2.0, 1.0));
    }
    if asked("wall") {
        print("a wall of 1,000 bricks in the plane, struck, 2 s", &wall::struck(40, 25, 2.0));
    }
    if asked("chains") {
        chains::print(100, 5, 2.0);
    }
    if asked("detection") {
        detection::print(1_000);
    }
    if asked("tower") {
        let mut rows = space::tower(100, 10.0);
        rows.extend(mujoco::tower(100, 10.0));
        print("a tower of 100 boxes with offsets of 1e-3, 10 s", &rows);
    }
    if asked("cenic") {
        cenic::print();
    }
}
