//! Pinned vertices of solids that move as they are told: shapes that are carried, a bar by another solver, budgets.

use std::f64::consts::TAU;
use std::path::Path;

use stationary_measure::SplitMix64;
use stationary_scene::{Fault, Run, Scene, SceneError};

use crate::driven::{defect, last, scene};

/// Solids of every kind of element, their pinned side first, and how many vertices it has.
const SHAPES: [(usize, &str, usize); 8] = [
    (1, "shape = { kind = \"bar\", size = [2], cells = [5] }\nsection = 0.1", 1),
    (2, "shape = { kind = \"bar\", size = [2], cells = [5], across = [3, 4] }\nsection = 0.1", 1),
    (2, "shape = { kind = \"rectangle\", size = [1, 0.5], cells = [3, 2] }\nthickness = 0.1", 3),
    (
        2,
        "shape = { kind = \"rectangle\", size = [1, 0.5], cells = [2, 1] }\nthickness = 0.1\nelement = \"quadratic\"",
        3,
    ),
    (
        3,
        "shape = { kind = \"bar\", size = [2], cells = [5] }\nsection = 0.1\nelement = \"quadratic\"",
        1,
    ),
    (
        3,
        "shape = { kind = \"rectangle\", size = [1, 0.5], cells = [3, 2] }\nthickness = 0.1\nbending = 0.3",
        3,
    ),
    (3, "shape = { kind = \"box\", size = [1, 0.5, 0.5], cells = [2, 1, 1] }", 4),
    (
        3,
        "shape = { kind = \"box\", size = [1, 0.5, 0.5], cells = [1, 1, 1] }\nelement = \"quadratic\"",
        9,
    ),
];

fn vector(dimension: usize, x: [f64; 3]) -> String {
    format!("{:?}", &x[..dimension])
}

/// A solid whose left side is pinned, and its text so far; all of it starts with a velocity.
fn solid((dimension, shape): (usize, &str), velocity: [f64; 3]) -> String {
    format!(
        "dimension = {dimension}\nintegrator = \"stormer-verlet\"\nstep = 0.001\nhorizon = 0.2\n\
         [[solids]]\nname = \"it\"\n{shape}\ndensity = 3\nyoung = 1000\npoisson = 0.25\npinned = [\"left\"]\n\
         velocity = {}\n",
        vector(dimension, velocity)
    )
}

fn pinned(scene: &Scene) -> Vec<String> {
    let particles = scene.particles().iter();
    let pins = particles.filter(|p| p.motion == stationary_scene::Motion::Pinned);
    pins.map(|pin| pin.name.clone()).collect()
}

/// All pins of a solid with a motion.
fn moved(text: &str, dimension: usize, shift: [f64; 3], strength: &str) -> Scene {
    let motion = |pin: &String| {
        let shift = vector(dimension, shift);
        format!("[[motions]]\nof = \"{pin}\"\nshift = {shift}\nstrength = {strength}\n")
    };
    let motions: String = pinned(&scene(text)).iter().map(motion).collect();
    scene(&format!("{text}{motions}"))
}

/// Pins that keep the velocity of the rest carry it along, undeformed.
#[test]
fn a_solid_whose_pins_keep_its_velocity_is_carried_along() {
    let velocity = [0.7, -0.4, 1.1];
    for (dimension, shape, pins) in SHAPES {
        let text = solid((dimension, shape), velocity);
        assert_eq!(pinned(&scene(&text)).len(), pins, "{shape}");
        let shift = velocity.map(|v| v * 0.2);
        let run = moved(&text, dimension, shift, "{ ramp = [0, 1], to = 0.2 }").run().unwrap();
        let (start, end) = (run.positions(0).to_vec(), last(&run));
        for (k, (start, end)) in start.iter().zip(end).enumerate() {
            let way = end - start - shift[k % dimension];
            assert!(way.abs() < 1e-12, "{shape}: {k}: {way}");
        }
        let work: f64 = run.works().iter().map(|(_, work)| work.abs()).sum();
        assert!(
            run.works()[0].0 == "motion of vertices of it" && work < 1e-11,
            "{:?}",
            run.works()
        );
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("carried");
        run.write(&folder).unwrap();
        let stress = std::fs::read_to_string(folder.join("stress.csv")).unwrap();
        let largest = stress.lines().skip(1).flat_map(|row| row.split(',').skip(3));
        let largest = largest.map(|s| s.parse::<f64>().unwrap().abs()).fold(0.0, f64::max);
        assert!(largest < 1e-8, "{shape}: {largest}");
    }
}

/// A motion that goes nowhere changes nothing, whatever elements are told apart for it.
#[test]
fn a_solid_whose_pins_are_told_to_stay_moves_as_one_whose_pins_stay() {
    for (dimension, shape, _) in SHAPES {
        let text = solid((dimension, shape), [0.7, -0.4, 1.1]);
        let still = scene(&text).run().unwrap();
        let told = moved(&text, dimension, [0.0; 3], "{ ramp = [0, 1], to = 0.2 }").run().unwrap();
        let apart = last(&still).iter().zip(last(&told)).map(|(a, b)| (a - b).abs());
        let apart = apart.fold(0.0, f64::max);
        assert!(apart < 1e-10, "{shape}: {apart}");
        let [a, b] = [&still, &told].map(|run| run.energies()[run.times().len() - 1]);
        assert!((a - b).abs() < 1e-10 * a.abs(), "{shape}: {a} {b}");
        assert!(told.scene().stable_step().unwrap() == still.scene().stable_step().unwrap());
    }
}

const CELLS: usize = 4;
const STIFFNESS: f64 = 0.1 * 50.0;
const MASS: f64 = 0.1 * 2.0 * 0.5;

/// A bar of four cells of half a metre whose left end swings by `0.2 sin 2 pi t`.
fn bar(method: &str, step: f64) -> String {
    format!(
        "dimension = 1\nintegrator = {method}\nstep = {step}\nhorizon = 1.5\n\
         [[solids]]\nname = \"bar\"\nshape = {{ kind = \"bar\", size = [2], cells = [{CELLS}] }}\nsection = 0.1\n\
         density = 2\nyoung = 50\npoisson = 0\npinned = [\"left\"]\n\
         [[motions]]\nof = \"bar.0\"\nshift = [0.2]\nstrength = {{ sine = 1, frequency = 1 }}\n"
    )
}

/// Places and velocities of its free ends and the work of the pin at 1.5 s: by steps of order 4 of
/// `m x_i.. = N_i+1 - N_i`, `N = E A e l/L`, `e = (l^2/L^2 - 1)/2`.
fn swung() -> ([f64; CELLS], f64) {
    let end = |t: f64| 0.2 * (TAU * t).sin();
    let rate = |t: f64, y: &[f64; 2 * CELLS + 1]| {
        let place = |k: usize| if k == 0 { end(t) } else { y[k - 1] };
        let force = |k: usize| {
            let stretch = (place(k + 1) - place(k)) / 0.5;
            STIFFNESS * 0.5 * (stretch * stretch - 1.0) * stretch
        };
        let mut rate = [0.0; 2 * CELLS + 1];
        for k in 0..CELLS {
            rate[k] = y[CELLS + k];
            let (mass, beyond) =
                if k + 1 == CELLS { (0.5 * MASS, 0.0) } else { (MASS, force(k + 1)) };
            rate[CELLS + k] = (beyond - force(k)) / mass;
        }
        rate[2 * CELLS] = -force(0) * 0.2 * TAU * (TAU * t).cos();
        rate
    };
    let (n, mut y) = (6000_u32, [0.0; 2 * CELLS + 1]);
    (0..CELLS).for_each(|k| y[k] = 0.5 * (k + 1) as f64);
    let h = 1.5 / f64::from(n);
    for k in 0..n {
        let t = h * f64::from(k);
        let at =
            |part: f64, r: &[f64; 2 * CELLS + 1]| std::array::from_fn(|i| y[i] + part * h * r[i]);
        let a = rate(t, &y);
        let b = rate(t + 0.5 * h, &at(0.5, &a));
        let c = rate(t + 0.5 * h, &at(0.5, &b));
        let d = rate(t + h, &at(1.0, &c));
        (0..y.len()).for_each(|i| y[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    (std::array::from_fn(|k| y[k]), y[2 * CELLS])
}

fn off(run: &Run) -> f64 {
    let (places, _) = swung();
    let apart = last(run)[1..].iter().zip(places).map(|(a, b)| (a - b).abs());
    apart.fold(0.0, f64::max)
}

#[test]
fn a_bar_whose_end_is_swung_moves_as_another_solver_says_and_its_budget_closes() {
    let run = |method: &str, step: f64| scene(&bar(method, step)).run().unwrap();
    let fine = run("\"dormand-prince-853\"\ntolerance = 1e-10", 0.5);
    assert!(off(&fine) < 1e-7, "{}", off(&fine));
    assert!((fine.works()[0].1 - swung().1).abs() < 1e-6, "{:?} {}", fine.works(), swung().1);
    assert!(swung().1.abs() > 0.01 && defect(&fine) < 1e-6, "{} {}", swung().1, defect(&fine));
    let of = |step: f64| run("\"stormer-verlet\"", step);
    let [coarse, finer] = [of(0.002), of(0.001)];
    let slope = (off(&coarse) / off(&finer)).log2();
    assert!((slope - 2.0).abs() < 0.1, "{slope} {}", off(&finer));
    let slope = (defect(&coarse) / defect(&finer)).log2();
    assert!(slope > 1.8 && defect(&finer) < 1e-3, "{slope} {}", defect(&finer));
    // The end is where it is told to be.
    assert!((last(&fine)[0] - 0.2 * (TAU * 1.5).sin()).abs() < 1e-15);
}

#[test]
fn a_run_with_vertices_that_move_resumes_to_the_same_bits() {
    crate::checkpoints::assert_resumes(
        &scene(&bar("\"stormer-verlet\"", 0.01)),
        &[2, 50, 149],
        "swung-bar",
    );
}

/// What hangs starts where it rests with its pins at their first places, springs to them included.
#[test]
fn what_is_hung_by_a_vertex_that_moves_starts_at_rest() {
    let text = |motion: &str| {
        bar("\"stormer-verlet\"", 0.01)
            .split("[[motions]]")
            .next()
            .unwrap()
            .replace("pinned", "hung = [\"right\"]\npinned")
            .replace("horizon", "uniform_gravity = { acceleration = [3] }\nhorizon")
            + motion
    };
    let still = scene(&text("")).problem().unwrap().initial.q;
    // The first cell bears more than the others.
    assert!(still[0] > 0.501, "{still:?}");
    let motion =
        "[[motions]]\nof = \"bar.0\"\nshift = [0.2]\nstrength = { sine = 1, frequency = 1 }\n";
    assert_eq!(scene(&text(motion)).problem().unwrap().initial.q, still);
}

/// The largest distance of two runs that are sampled alike.
fn apart(a: &Run, b: &Run) -> f64 {
    let at = |k: usize| {
        let pairs = a.positions(k).iter().zip(b.positions(k));
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    assert!(a.times().iter().zip(b.times()).all(|(a, b)| (a - b).abs() < 1e-12));
    assert_eq!(a.times().len(), b.times().len());
    (0..a.times().len()).map(at).fold(0.0, f64::max)
}

/// Methods that solve for the end of a step, and their orders.
const IMPLICIT: [(&str, f64); 5] = [
    ("implicit-midpoint", 2.0),
    ("newmark", 2.0),
    ("trapezoid", 2.0),
    ("generalized-alpha", 2.0),
    ("implicit-euler", 1.0),
];

#[test]
fn implicit_steps_of_a_solid_whose_pins_move_have_their_order_and_their_budget_closes() {
    let mut random = SplitMix64::new(29);
    for (dimension, shape, _) in SHAPES {
        let shift: [f64; 3] = std::array::from_fn(|_| 0.05 * random.symmetric());
        let frequency = 3.0 + random.symmetric();
        let strength = format!("{{ sine = 1, frequency = {frequency} }}");
        let of = |method: &str, step: f64| {
            let every = (0.02 / step).round();
            let text = solid((dimension, shape), [0.0; 3])
                .replace("\"stormer-verlet\"", method)
                .replace("young = 1000", "young = 40")
                .replace("step = 0.001", &format!("step = {step}\nsample_every = {every}"));
            moved(&text, dimension, shift, &strength).run().unwrap()
        };
        let explicit = of("\"stormer-verlet\"", 1e-4);
        let fine = of("\"dormand-prince-853\"\ntolerance = 1e-9", 0.02);
        assert!(apart(&explicit, &fine) < 1e-5, "{shape}: {}", apart(&explicit, &fine));
        for (method, order) in IMPLICIT {
            let runs = [0.002, 0.001].map(|step| of(&format!("\"{method}\""), step));
            let [coarse, finer] = runs.each_ref().map(|run| apart(run, &fine));
            let slope = (coarse / finer).log2();
            assert!((slope - order).abs() < 0.25, "{shape}: {method}: {slope} {finer}");
            let [coarse, finer] = runs.each_ref().map(defect);
            let slope = (coarse / finer).log2();
            // Where the defect swings about zero it may fall faster.
            assert!(
                slope > order - 0.4 && finer < 0.2 / order,
                "{shape}: {method}: {slope} {finer}"
            );
        }
        for method in ["radau-iia-5", "bdf-5"] {
            let run = of(&format!("\"{method}\"\ntolerance = 1e-8"), 0.02);
            assert!(apart(&run, &fine) < 1e-5, "{shape}: {method}: {}", apart(&run, &fine));
            assert!(defect(&run) < 1e-4, "{shape}: {method}: {}", defect(&run));
        }
    }
}

/// Newton's method without the stiffness of what moves would not converge at steps so long.
#[test]
fn implicit_steps_longer_than_the_fastest_vibration_carry_what_moving_pins_hold() {
    let stiff = |method: &str, hold: &str| {
        format!(
            "dimension = 2\nintegrator = \"{method}\"\nstep = 0.01\nhorizon = 1\n\
             particles = [{{ name = \"pin\", pinned = true, position = [0, 0] }},\n\
             {{ name = \"it\", position = [1, 0], mass = 1 }}]\n{hold}\n\
             motions = [{{ of = \"pin\", shift = [0.3, 0.1], strength = {{ ramp = [0, 1], to = 1 }} }}]\n"
        )
    };
    let spring = "springs = [{ between = [\"pin\", \"it\"], stiffness = 1e8 }]";
    for (method, _) in IMPLICIT {
        let run = scene(&stiff(method, spring)).run().unwrap();
        let end = last(&run);
        assert!(((end[2] - end[0]).hypot(end[3] - end[1]) - 1.0).abs() < 0.2, "{method}: {end:?}");
        // Of several hundred freedoms by a sparse matrix.
        let text = "dimension = 3\nintegrator = \"METHOD\"\nstep = 0.02\nhorizon = 0.2\n\
                    [[solids]]\nname = \"it\"\n\
                    shape = { kind = \"box\", size = [1, 0.5, 0.5], cells = [6, 4, 4] }\n\
                    density = 1\nyoung = 1e6\npoisson = 0.3\npinned = [\"left\"]\n";
        let text = text.replace("METHOD", method);
        let carried = moved(&text, 3, [0.0, 0.0, 0.1], "{ ramp = [0, 1], to = 0.2 }");
        let run = carried.run().unwrap();
        // All of it is dragged along by its end.
        let moved = last(&run).iter().zip(run.positions(0)).map(|(b, a)| (b - a).abs());
        assert!(moved.fold(0.0, f64::max) < 0.5, "{method}");
        assert!(run.built().sparse_solvers == 1, "{method}");
        crate::checkpoints::assert_resumes(&carried, &[3], &format!("carried-{method}"));
    }
}

#[test]
fn a_sum_of_modes_has_no_place_for_vertices_that_move() {
    let text = bar("\"linear-modes\"\nmodes = 2", 0.01);
    match Scene::parse("a.toml", &text) {
        Err(SceneError::Invalid(error)) => {
            let refused = matches!(error.fault, Fault::MethodCannot { what: "pins that move", .. });
            assert!(refused, "{error}");
        }
        other => panic!("{other:?}"),
    }
}
