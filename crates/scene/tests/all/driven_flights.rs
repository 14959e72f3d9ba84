//! Flight between impacts under what acts: other solvers, orders, budgets, pins that push, resuming.

use std::f64::consts::TAU;

use stationary_scene::{Run, Scene};

use crate::checkpoints::assert_resumes;
use crate::chosen_joints::{left, run};

const WORDS: [(&str, f64); 2] = [("event-driven-2", 2.0), ("event-driven-4", 4.0)];

/// Steps of order 4 of `y' = f(t, y)` until `gap(y)` is none, where the velocity along it is turned back by `hit`; the
/// answer at multiples of a step. No step passes a corner.
fn bounced<const N: usize>(
    rate: impl Fn(f64, [f64; N]) -> [f64; N],
    gap: impl Fn([f64; N]) -> f64,
    hit: impl Fn(f64, &mut [f64; N]),
    (start, step, count): ([f64; N], f64, usize),
    corners: &[f64],
) -> Vec<[f64; N]> {
    let flown = |t: f64, y: [f64; N], h: f64| {
        // Just inside of a corner.
        let inside = |part: f64| t + h * part.clamp(1e-12, 1.0 - 1e-12);
        let at = |part: f64, r: [f64; N]| std::array::from_fn(|i| y[i] + part * h * r[i]);
        let a = rate(inside(0.0), y);
        let b = rate(inside(0.5), at(0.5, a));
        let c = rate(inside(0.5), at(0.5, b));
        let d = rate(inside(1.0), at(1.0, c));
        std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
    };
    const CUTS: usize = 200;
    let (mut y, mut all) = (start, vec![start]);
    for sample in 0..count {
        let mut cuts: Vec<f64> =
            (0..=CUTS).map(|k| step * (sample as f64 + k as f64 / CUTS as f64)).collect();
        let (from, to) = (cuts[0], cuts[CUTS]);
        cuts.extend(corners.iter().filter(|c| **c > from && **c < to));
        cuts.sort_by(f64::total_cmp);
        for pair in cuts.windows(2) {
            let (mut t, end) = (pair[0], pair[1]);
            while t < end {
                let next = flown(t, y, end - t);
                if gap(next) >= 0.0 {
                    (t, y) = (end, next);
                    continue;
                }
                let (mut low, mut high) = (0.0, end - t);
                for _ in 0..80 {
                    let middle = 0.5 * (low + high);
                    if gap(flown(t, y, middle)) < 0.0 { high = middle } else { low = middle }
                }
                y = flown(t, y, low);
                t += low;
                hit(t, &mut y);
            }
        }
        all.push(y);
    }
    all
}

/// A ball that bounces in air while gravity grows and a load swings at it, from a corner on.
fn in_air(dimension: usize, method: &str, step: f64) -> String {
    let vector = |x: f64, z: f64| match dimension {
        2 => format!("[{x}, {z}]"),
        _ => format!("[{x}, 0, {z}]"),
    };
    format!(
        "dimension = {dimension}\nintegrator = \"{method}\"\nstep = {step}\nhorizon = 1.6\n\
         drag = {{ coefficient = 0.8 }}\n\
         uniform_gravity = {{ acceleration = {}, strength = {{ ramp = [1, 1.5], from = 0.25, to = 0.9 }} }}\n\
         observables = [{{ position = \"ball\" }}, {{ velocity = \"ball\" }}]\n\
         bodies = [{{ name = \"ball\", mass = 2, ball = 0.1, position = {}, velocity = {} }}]\n\
         loads = [{{ on = \"ball\", force = {}, strength = {{ sine = 1, frequency = 1.7, phase = 0.4 }} }}]\n\
         [contact]\nrestitution = 0.7\nwalls = [{{ normal = {}, at = {} }}]\n",
        vector(0.0, -10.0),
        vector(0.0, 1.1),
        vector(0.3, 0.0),
        vector(3.0, 6.0),
        vector(0.0, 1.0),
        vector(0.0, 0.0),
    )
}

fn in_air_exactly(step: f64, count: usize) -> Vec<[f64; 4]> {
    let rate = |t: f64, [_, _, u, w]: [f64; 4]| {
        let g = 10.0 * (1.0 + 0.5 * ((t - 0.25) / 0.65).clamp(0.0, 1.0));
        let s = (TAU * 1.7 * t + 0.4).sin();
        [u, w, 1.5 * s - 0.4 * u, 3.0 * s - g - 0.4 * w]
    };
    let hit = |_: f64, y: &mut [f64; 4]| y[3] *= -0.7;
    let start = [0.0, 1.1, 0.3, 0.0];
    bounced(rate, |y| y[1] - 0.1, hit, (start, step, count), &[0.25, 0.9])
}

/// The largest distance from exact places at the samples, of which each step of the exact answer has `every`.
fn off(run: &Run, exact: &[[f64; 4]], every: usize, places: [usize; 2]) -> f64 {
    let at = |k: usize| {
        let x = run.observed(k);
        let y = exact[k / every];
        (x[places[0]] - y[0]).hypot(x[places[1]] - y[1])
    };
    (0..run.times().len()).step_by(every).map(at).fold(0.0, f64::max)
}

#[test]
fn a_ball_bounces_in_air_under_loads_at_the_order_of_its_flights() {
    let exact = in_air_exactly(0.1, 16);
    for dimension in [2, 3] {
        for (method, order) in WORDS {
            let runs = [2, 4, 8].map(|every| {
                let run = run(&in_air(dimension, method, 0.1 / f64::from(every)));
                let places = [0, dimension - 1];
                (off(&run, &exact, every as usize, places), left(&run), run)
            });
            for pair in runs.windows(2) {
                let slope = (pair[0].0 / pair[1].0).log2();
                assert!(slope > order - 0.5, "{dimension} {method}: {slope} {}", pair[1].0);
            }
            let last = &runs[2];
            assert!(last.0 < if order == 2.0 { 1e-3 } else { 1e-6 }, "{method}: {}", last.0);
            // No energy but that of motion: kicks tell all of it.
            assert!(runs.iter().all(|run| run.1 < 1e-12), "{method}: {}", last.1);
            let names: Vec<String> = last.2.works().into_iter().map(|(name, _)| name).collect();
            assert_eq!(names[..3], ["drag", "gravity", "load on ball"]);
            assert!(
                last.2.impacts().len() >= 2 && last.2.works().iter().take(3).all(|w| w.1 != 0.0)
            );
            let scene = Scene::parse("a.toml", &in_air(dimension, method, 0.05)).unwrap();
            assert_resumes(&scene, &[2, 9, 31], &format!("in-air-{dimension}-{method}"));
        }
    }
}

/// A ball on a damped spring to a pin that swings hits a wall.
#[test]
fn a_ball_on_a_damped_spring_to_a_swung_pin_bounces_at_the_order_of_its_flights() {
    let text = |method: &str, step: f64| {
        format!(
            "dimension = 2\nintegrator = \"{method}\"\nstep = {step}\nhorizon = 2\n\
             observables = [{{ position = \"ball\" }}, {{ velocity = \"ball\" }}]\n\
             bodies = [{{ name = \"ball\", mass = 0.5, ball = 0.1, position = [0, 0] }}]\n\
             particles = [{{ name = \"pin\", pinned = true, position = [-1, 0] }}]\n\
             springs = [{{ between = [\"pin\", \"ball\"], stiffness = 12, damping = 0.3 }}]\n\
             motions = [{{ of = \"pin\", shift = [0.4, 0], strength = {{ sine = 1, frequency = 0.8 }} }}]\n\
             [contact]\nrestitution = 0.6\nwalls = [{{ normal = [-1, 0], at = [0.25, 0] }}]\n"
        )
    };
    let w = TAU * 0.8;
    let rate = |t: f64, [x, _, u, _]: [f64; 4]| {
        let (pin, moves) = (-1.0 + 0.4 * (w * t).sin(), 0.4 * w * (w * t).cos());
        let pull = 12.0 * (x - pin - 1.0) + 0.3 * (u - moves);
        [u, 0.0, -pull / 0.5, 0.0]
    };
    let hit = |_: f64, y: &mut [f64; 4]| y[2] *= -0.6;
    let exact = bounced(rate, |y| 0.15 - y[0], hit, ([0.0; 4], 0.1, 20), &[]);
    for (method, order) in WORDS {
        let runs = [4, 8].map(|every| {
            let run = run(&text(method, 0.1 / f64::from(every)));
            (off(&run, &exact, every as usize, [0, 1]), left(&run), run)
        });
        let slope = (runs[0].0 / runs[1].0).log2();
        assert!(slope > order - 0.6, "{method}: {slope} {}", runs[1].0);
        let open = [runs[0].1, runs[1].1];
        assert!((open[0] / open[1]).log2() > order - 0.8, "{method}: {open:?}");
        assert!(runs[1].1 < if order == 2.0 { 1e-2 } else { 1e-5 }, "{method}: {}", runs[1].1);
        assert!(!runs[1].2.impacts().is_empty());
    }
}

/// In a frame that turns all moves as in the one that does not, and walls turn along.
#[test]
fn a_disc_in_a_frame_that_turns_bounces_as_seen_from_one_that_does_not() {
    let turning = 1.3_f64;
    let text = |method: &str, step: f64| {
        format!(
            "dimension = 2\nintegrator = \"{method}\"\nstep = {step}\nhorizon = 1\n\
             frame = {{ angular_velocity = {turning} }}\n\
             observables = [{{ position = \"disc\" }}, {{ velocity = \"disc\" }}]\n\
             bodies = [{{ name = \"disc\", mass = 2, ball = 0.1, position = [0.2, 0.1], velocity = [1.5, 0.4] }}]\n\
             [contact]\nrestitution = 0.8\nwalls = [{{ normal = [-1, 0], at = [0.7, 0] }}]\n"
        )
    };
    let rate = |_: f64, [x, y, u, v]: [f64; 4]| {
        let (out, aside) = (turning * turning, 2.0 * turning);
        [u, v, out * x + aside * v, out * y - aside * u]
    };
    let hit = |_: f64, y: &mut [f64; 4]| y[2] *= -0.8;
    let start = [0.2, 0.1, 1.5, 0.4];
    let exact = bounced(rate, |y| 0.6 - y[0], hit, (start, 0.1, 10), &[]);
    // Until it hits it moves straight.
    let (sin, cos) = (turning * 0.1).sin_cos();
    let still = [0.2 + 0.1 * (1.5 - turning * 0.1), 0.1 + 0.1 * (0.4 + turning * 0.2)];
    assert!((exact[1][0] - cos * still[0] - sin * still[1]).abs() < 1e-9);
    for (method, order) in WORDS {
        let runs = [2, 4].map(|every| {
            let run = run(&text(method, 0.1 / f64::from(every)));
            (off(&run, &exact, every as usize, [0, 1]), left(&run), run)
        });
        let slope = (runs[0].0 / runs[1].0).log2();
        assert!(slope > order - 0.6, "{method}: {slope} {}", runs[1].0);
        assert!(runs[1].1 < if order == 2.0 { 1e-2 } else { 1e-5 }, "{method}: {}", runs[1].1);
        assert!(!runs[1].2.impacts().is_empty());
    }
}

/// A pin that is back where it started at the end of the step hits a ball on its way, and is not missed.
#[test]
fn a_swung_pin_hits_a_ball_at_its_instant_within_one_step() {
    for (dimension, side) in [(2, "[0.2, 0.2]"), (3, "[0.2, 0.2, 0.2]")] {
        let at = |x: f64| format!("{:?}", &[x, 0.0, 0.0][..dimension]);
        for (method, _) in WORDS {
            for shape in ["ball = 0.1", &format!("box = {side}")] {
                let text = format!(
                    "dimension = {dimension}\nintegrator = \"{method}\"\nstep = 0.5\nhorizon = 1\n\
                     observables = [{{ position = \"it\" }}, {{ velocity = \"it\" }}]\n\
                     bodies = [{{ name = \"it\", mass = 0.4, {shape}, position = {} }}]\n\
                     particles = [{{ name = \"pusher\", radius = 0.1, pinned = true, position = {} }}]\n\
                     contact = {{ restitution = 0.5 }}\n\
                     motions = [{{ of = \"pusher\", shift = {}, strength = {{ sine = 1, frequency = 2 }} }}]\n",
                    at(0.5),
                    at(0.0),
                    at(0.6),
                );
                let run = run(&text);
                // 0.6 sin w t = 0.3
                let w = TAU * 2.0;
                let (time, given) = (0.5_f64.asin() / w, 1.5 * 0.6 * w * 0.75_f64.sqrt());
                let impact = run.impacts()[0];
                assert!(
                    (impact.time - time).abs() < 1e-8 && impact.count == 1,
                    "{impact:?} {time}"
                );
                let x = run.observed(1);
                assert!((x[dimension] - given).abs() < 1e-7, "{method}: {} {given}", x[dimension]);
                let place = 0.5 + given * (0.5 - time);
                assert!((x[0] - place).abs() < 1e-7, "{method}: {} {place}", x[0]);
                let energy = 0.5 * 0.4 * given * given;
                assert!(left(&run) < 1e-8 * energy, "{:?}", run.works());
                let told =
                    run.works().into_iter().find(|(name, _)| name == "pins that move and touch");
                let pushed = 0.4 * given * (given / 1.5);
                assert!((told.unwrap().1 - pushed).abs() < 1e-6 * pushed, "{:?}", run.works());
                let scene =
                    Scene::parse("a.toml", &text.replace("step = 0.5", "step = 0.02")).unwrap();
                assert_resumes(&scene, &[2, 3, 30], &format!("swung-{dimension}-{method}"));
            }
        }
    }
}

/// While it slides steps are of order 1, under loads as well.
#[test]
fn a_block_that_is_pushed_over_a_floor_slides_as_coulomb_says() {
    let text = |method: &str, step: f64| {
        format!(
            "dimension = 2\nintegrator = \"{method}\"\nstep = {step}\nhorizon = 1\n\
             uniform_gravity = {{ acceleration = [0, -10] }}\nobservables = [{{ position = \"block\" }}]\n\
             bodies = [{{ name = \"block\", mass = 2, box = [0.6, 0.8], position = [0, 0.4] }}]\n\
             loads = [{{ on = \"block\", force = [13, 0], strength = {{ step = [0, 1], at = 0.33 }} }}]\n\
             [contact]\nfriction = 0.25\nwalls = [{{ normal = [0, 1], at = [0, 0] }}]\n"
        )
    };
    for (method, _) in WORDS {
        let of = |step: f64| {
            let run = run(&text(method, step));
            let x = run.observed(run.times().len() - 1)[0];
            // 6.5 - 2.5 m/s^2 from 0.33 s on.
            ((x - 2.0 * 0.67 * 0.67).abs(), left(&run), run)
        };
        let (coarse, fine) = (of(0.1), of(0.025));
        assert!(fine.0 < 1e-3 && fine.0 < 0.4 * coarse.0, "{} {}", coarse.0, fine.0);
        assert!(fine.1 < 1e-2 && fine.1 < 0.4 * coarse.1.max(1e-9), "{} {}", coarse.1, fine.1);
        assert!(fine.2.works()[0].1 > 10.0, "{:?}", fine.2.works());
    }
}

#[test]
fn three_balls_on_dampers_between_them_fly_at_the_order_of_their_flights() {
    let ends = |method: &str, step: f64| {
        let ball = |name: &str, place: &str, velocity: &str| {
            format!(
                "{{ name = \"{name}\", mass = 1, ball = 0.1, position = {place}, velocity = {velocity} }}"
            )
        };
        let damper = |a: &str, b: &str, damping: f64| {
            format!("{{ between = [\"{a}\", \"{b}\"], stiffness = 2, damping = {damping} }}")
        };
        let text = format!(
            "dimension = 2\nintegrator = \"{method}\"\nstep = {step}\nhorizon = 0.8\n\
             observables = [{{ position = \"a\" }}]\ncontact = {{ restitution = 1 }}\n\
             bodies = [{}, {}, {}]\nsprings = [{}, {}, {}]\n",
            ball("a", "[0, 0]", "[1, 0.5]"),
            ball("b", "[1, 0.3]", "[-0.3, 1]"),
            ball("c", "[0.2, 1.4]", "[0, -0.5]"),
            damper("a", "b", 0.5),
            damper("b", "c", 0.7),
            damper("c", "a", 0.4),
        );
        let run = run(&text);
        run.positions(run.times().len() - 1)[..2].to_vec()
    };
    for (method, order) in WORDS {
        let exact = ends(method, 0.00625);
        let off = |step: f64| {
            let found = ends(method, step);
            (found[0] - exact[0]).hypot(found[1] - exact[1])
        };
        let [coarse, fine] = [0.1, 0.05].map(off);
        let fell = (coarse / fine).log2();
        assert!((fell - order).abs() < 0.3, "{method}: {coarse:e}, {fine:e}, order {fell}");
    }
}
