//! Pinned vertices of solids that move as they are told: shapes that are carried, a bar by another solver, budgets.

use std::f64::consts::TAU;
use std::path::Path;

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

/// Newton's method has no slope of what moves in time: implicit steps are refused, and heat has no pins.
#[test]
fn what_has_no_place_for_vertices_that_move_is_refused() {
    for method in ["implicit-midpoint", "newmark", "trapezoid"] {
        let refused = Scene::parse("a.toml", &bar(&format!("\"{method}\""), 0.01));
        match refused {
            Err(SceneError::Invalid(error)) => {
                assert!(
                    matches!(error.fault, Fault::MethodCannot { what: "pins that move", .. }),
                    "{error}"
                );
            }
            other => panic!("{other:?}"),
        }
    }
}
