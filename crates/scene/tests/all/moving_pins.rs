//! Pins that move as they are told: what springs, dampers and rods join to them, by closed forms and by other solvers.

use std::f64::consts::TAU;

use stationary_measure::SplitMix64;
use stationary_scene::{Run, Scene};

use crate::driven::{defect, last, mass_on_a_spring, scene};

#[test]
fn a_mass_on_a_moving_pin_answers_as_the_closed_form_says() {
    // x'' + W^2 x = W^2 sin w t
    let (w, free) = (TAU * 0.4, TAU);
    let exact = 1.0
        + free * free * ((w * 1.5).sin() - w / free * (free * 1.5).sin()) / (free * free - w * w);
    let run = |method: &str, step: f64| {
        let motion =
            "motions = [{ of = \"wall\", shift = [1], strength = { sine = 1, frequency = 0.4 } }]";
        let text = mass_on_a_spring(method, step, motion);
        scene(&text).run().unwrap()
    };
    let error = |step: f64| (last(&run("\"stormer-verlet\"", step))[1] - exact).abs();
    let slope = (error(0.005) / error(0.0025)).log2();
    assert!((slope - 2.0).abs() < 0.1, "{slope}");
    let of = |step: f64| defect(&run("\"stormer-verlet\"", step));
    assert!(
        of(0.0025) < 1e-4 && (of(0.005) / of(0.0025)).log2() > 1.8,
        "{} {}",
        of(0.005),
        of(0.0025)
    );
    let fine = run("\"dormand-prince-853\"\ntolerance = 1e-10", 0.5);
    assert!((last(&fine)[1] - exact).abs() < 1e-7, "{}", last(&fine)[1] - exact);
    assert!(defect(&fine) < 1e-6, "{}", defect(&fine));
    // The pin itself is where it is told to be.
    assert!((last(&fine)[0] - (w * 1.5).sin()).abs() < 1e-15);
}

#[test]
fn a_mass_on_a_damped_spring_to_a_moving_pin_answers_as_the_closed_form_says() {
    // m x'' + c (x' - y') + k (x - y) = 0,  y = sin w t,  from rest: x = Im X e^(iwt) + what dies out
    let [m, c, k, w, t]: [f64; 5] = [0.5, 0.9, 0.5 * TAU * TAU, TAU * 0.4, 1.5];
    // X = (k + i w c)/(k - m w^2 + i w c)
    let (stiff, lag) = (k - m * w * w, w * c);
    let size = stiff * stiff + lag * lag;
    let [re, im] = [(k * stiff + lag * lag) / size, (lag * stiff - k * lag) / size];
    let (rate, turning) = (0.5 * c / m, (k / m - 0.25 * c * c / (m * m)).sqrt());
    let [a, b] = [-im, (-w * re - rate * im) / turning];
    let steady = re * (w * t).sin() + im * (w * t).cos();
    let rest = (-rate * t).exp() * (a * (turning * t).cos() + b * (turning * t).sin());
    let exact = 1.0 + steady + rest;
    let run = |method: &str, step: f64| {
        let text = format!(
            "dimension = 1\nintegrator = {method}\nstep = {step}\nhorizon = {t}\n\
             particles = [{{ name = \"wall\", position = [0], pinned = true }},\n\
             {{ name = \"mass\", position = [1], mass = {m} }}]\n\
             springs = [{{ between = [\"wall\", \"mass\"], stiffness = {k}, damping = {c} }}]\n\
             motions = [{{ of = \"wall\", shift = [1], strength = {{ sine = 1, frequency = 0.4 }} }}]\n"
        );
        scene(&text).run().unwrap()
    };
    let error = |step: f64| (last(&run("\"stormer-verlet\"", step))[1] - exact).abs();
    let slope = (error(0.005) / error(0.0025)).log2();
    assert!((slope - 2.0).abs() < 0.1, "{slope} {}", error(0.0025));
    let fine = run("\"dormand-prince-853\"\ntolerance = 1e-10", 0.5);
    assert!((last(&fine)[1] - exact).abs() < 1e-7, "{}", last(&fine)[1] - exact);
    assert!(defect(&fine) < 1e-6, "{}", defect(&fine));
    let of = |step: f64| defect(&run("\"stormer-verlet\"", step));
    assert!((of(0.005) / of(0.0025)).log2() > 1.8, "{} {}", of(0.005), of(0.0025));
}

/// The angle and its rate at a time of a pendulum of length `L` whose pivot moves by `0.3 sin(w t)` along the
/// first axis and by half of that along the second: `L a'' = -(g + y'') sin a - x'' cos a`, by steps of order 4.
fn on_a_moving_pivot(l: f64, w: f64, start: [f64; 2], time: f64) -> [f64; 2] {
    let rate = |t: f64, [a, b]: [f64; 2]| {
        let x = -0.3 * w * w * (w * t).sin();
        [b, (-(9.81 + 0.5 * x) * a.sin() - x * a.cos()) / l]
    };
    let (steps, mut y) = (4000, start);
    let h = time / f64::from(steps);
    for n in 0..steps {
        let t = f64::from(n) * h;
        let to = |k: [f64; 2], part: f64| [y[0] + part * h * k[0], y[1] + part * h * k[1]];
        let first = rate(t, y);
        let second = rate(t + 0.5 * h, to(first, 0.5));
        let third = rate(t + 0.5 * h, to(second, 0.5));
        let last = rate(t + h, to(third, 1.0));
        let sum = |c: usize| first[c] + 2.0 * (second[c] + third[c]) + last[c];
        y = [y[0] + h / 6.0 * sum(0), y[1] + h / 6.0 * sum(1)];
    }
    y
}

#[test]
fn a_pendulum_on_a_rod_follows_a_pin_that_moves() {
    let [l, w, time]: [f64; 3] = [0.8, TAU * 0.7, 2.0];
    // Where it starts to the side, it starts along with the pin, as its rod asks.
    let (angle, along) = (0.4_f64, [0.3 * w, 0.15 * w]);
    let place = [l * angle.sin(), -l * angle.cos()];
    let run = |step: f64| {
        scene(&format!(
            "dimension = 2\nintegrator = \"rattle\"\nstep = {step}\nhorizon = {time}\n\
             uniform_gravity = {{ acceleration = [0, -9.81] }}\n\
             particles = [{{ name = \"hook\", position = [0, 0], pinned = true }},\n\
             {{ name = \"bob\", position = {place:?}, mass = 0.4, velocity = {along:?} }}]\n\
             rods = [{{ between = [\"hook\", \"bob\"] }}]\n\
             motions = [{{ of = \"hook\", shift = [0.3, 0.15], strength = {{ sine = 1, frequency = 0.7 }} }}]\n"
        ))
        .run()
        .unwrap()
    };
    let [end, _] = on_a_moving_pivot(l, w, [angle, 0.0], time);
    let hook = 0.3 * (w * time).sin();
    let exact = [hook + l * end.sin(), 0.5 * hook - l * end.cos()];
    let error = |step: f64| {
        let run = run(step);
        let x = last(&run);
        (x[2] - exact[0]).hypot(x[3] - exact[1])
    };
    let errors = [error(0.004), error(0.002)];
    let slope = (errors[0] / errors[1]).log2();
    assert!((slope - 2.0).abs() < 0.1, "{slope}: {errors:?}");
    // The pin's work through its rod is told, and the budget is closed but for the steps' own defect.
    let [coarse, fine] = [0.004, 0.002].map(run);
    let works = fine.works();
    assert_eq!(works[0].0, "pins that move rods");
    assert!(works[0].1.abs() > 0.1, "{works:?}");
    assert!(
        (defect(&coarse) / defect(&fine)).log2() > 1.8,
        "{} {}",
        defect(&coarse),
        defect(&fine)
    );
    assert!(defect(&fine) < 1e-4, "{}", defect(&fine));
}

/// The same pendulum beside a body.
pub(crate) fn swung_beside_a_body(
    dimension: usize,
    method: &str,
    contact: &str,
    step: f64,
) -> String {
    let [l, w]: [f64; 2] = [0.8, TAU * 0.7];
    let (angle, along) = (0.4_f64, [0.3 * w, 0.15 * w]);
    let at = |x: f64, y: f64| match dimension {
        3 => format!("[{x}, {y}, 0]"),
        _ => format!("[{x}, {y}]"),
    };
    let side = if dimension == 3 { "[1, 1, 1]" } else { "[1, 1]" };
    format!(
        "dimension = {dimension}\nintegrator = {method}\nstep = {step}\nhorizon = 1.5\n\
         uniform_gravity = {{ acceleration = {} }}\n{contact}\
         observables = [{{ position = \"bob\" }}, {{ velocity = \"bob\" }}, \
         {{ tension = [\"hook\", \"bob\"] }}]\n\
         bodies = [{{ name = \"far\", mass = 1, box = {side}, position = {} }}]\n\
         particles = [{{ name = \"hook\", position = {}, pinned = true }},\n\
         {{ name = \"bob\", position = {}, mass = 0.4, velocity = {} }}]\n\
         rods = [{{ between = [\"hook\", \"bob\"] }}]\n\
         motions = [{{ of = \"hook\", shift = {}, strength = {{ sine = 1, frequency = 0.7 }} }}]\n",
        at(0.0, -9.81),
        at(30.0, 0.0),
        at(0.0, 0.0),
        at(l * angle.sin(), -l * angle.cos()),
        at(along[0], along[1]),
        at(0.3, 0.15),
    )
}

/// Where rods are joints: alone of order 2, solved together with contacts of order 1.
#[test]
fn a_rod_beside_bodies_follows_a_pin_that_moves() {
    let [l, w, time]: [f64; 3] = [0.8, TAU * 0.7, 1.5];
    let [end, rate] = on_a_moving_pivot(l, w, [0.4, 0.0], time);
    let hook = 0.3 * (w * time).sin();
    let exact = [hook + l * end.sin(), 0.5 * hook - l * end.cos()];
    let moved = 0.3 * w * (w * time).cos();
    let speed = (moved + l * rate * end.cos()).hypot(0.5 * moved + l * rate * end.sin());
    for (dimension, method) in [(2, "stormer-verlet"), (3, "variational-rotation")] {
        for (contact, order) in [("", 2.0), ("contact = { restitution = 0.5 }\n", 1.0)] {
            let run = |step: f64| {
                let method = format!("\"{method}\"");
                scene(&swung_beside_a_body(dimension, &method, contact, step)).run().unwrap()
            };
            let runs = [0.002, 0.001].map(run);
            let off = runs.each_ref().map(|run| {
                let x = run.observed(run.times().len() - 1);
                (x[0] - exact[0]).hypot(x[1] - exact[1])
            });
            let slope = (off[0] / off[1]).log2();
            assert!((slope - order).abs() < 0.2, "{dimension} {contact}: {slope} {off:?}");
            assert!(off[1] < if order == 2.0 { 1e-4 } else { 2e-2 }, "{off:?}");
            let x = runs[1].observed(runs[1].times().len() - 1);
            let found = x[dimension].hypot(x[dimension + 1]);
            assert!((found - speed).abs() < 2e-2, "{found} {speed}");
            // What the pin gives through its rod is told, and closes the budget but for the steps' own defect.
            let [coarse, fine] = runs.each_ref().map(defect);
            assert!(fine < 0.7 * coarse && fine < 1e-2, "{dimension} {contact}: {coarse} {fine}");
            let works = runs[1].works();
            let told = works.iter().find(|(name, _)| name.contains("pins that move rods"));
            assert!(told.is_some_and(|(_, work)| work.abs() > 0.1), "{works:?}");
        }
    }
}

/// A pin of radius 0.1 that moves at 2 m/s hits what is at rest 0.5 m ahead: `(1 + e)` times its speed is given.
#[test]
fn a_pin_that_moves_and_has_a_radius_pushes_what_it_meets() {
    let (speed, mass): (f64, f64) = (2.0, 0.4);
    for (dimension, method, side) in
        [(2, "stormer-verlet", "[0.2, 0.2]"), (3, "variational-rotation", "[0.2, 0.2, 0.2]")]
    {
        let at = |x: f64, y: f64| match dimension {
            3 => format!("[{x}, {y}, 0]"),
            _ => format!("[{x}, {y}]"),
        };
        let bead = format!(
            "{{ name = \"it\", mass = {mass}, radius = 0.1, position = {} }},",
            at(0.6, 0.0)
        );
        let block = format!(
            "bodies = [{{ name = \"it\", mass = {mass}, box = {side}, position = {} }}]\n",
            at(0.6, 0.0)
        );
        for (bodies, bead) in [("", bead.as_str()), (block.as_str(), "")] {
            for restitution in [1.0, 0.5, 0.0] {
                let text = format!(
                    "dimension = {dimension}\nintegrator = \"{method}\"\nstep = 0.001\nhorizon = 0.5\n\
                     observables = [{{ position = \"it\" }}, {{ velocity = \"it\" }}]\n{bodies}\
                     particles = [{bead} {{ name = \"pusher\", radius = 0.1, pinned = true, position = {} }}]\n\
                     contact = {{ restitution = {restitution} }}\n\
                     motions = [{{ of = \"pusher\", shift = {}, strength = {{ ramp = [0, 1], to = 1 }} }}]\n",
                    at(0.0, 0.0),
                    at(speed, 0.0),
                );
                let run = scene(&text).run().unwrap();
                let end = run.observed(run.times().len() - 1);
                let given = (1.0 + restitution) * speed;
                assert!((end[dimension] - given).abs() < 1e-9, "{text}{end:?}");
                // It is hit 0.4 m further, at 0.2 s, within two steps.
                let exact = 0.6 + given * 0.3;
                assert!((end[0] - exact).abs() < 2.0 * given * 1e-3, "{} {exact}", end[0]);
                let energy = 0.5 * mass * given * given;
                assert!(defect(&run) * energy < 1e-9, "{:?}", run.works());
                let rows = run.contact_impulses();
                let names = rows[0].between.map(|side| side.name(run.scene()));
                assert_eq!(names, ["pusher", "it"]);
                let pushed: f64 = rows.iter().map(|row| row.impulse[0]).sum();
                assert!((pushed - mass * given).abs() < 1e-9 && rows[0].normal[0] > 0.0);
            }
        }
    }
}

#[test]
fn a_load_goes_on_while_a_pin_pushes_under_every_way_to_touch() {
    for (dimension, side) in [(2, "[0.2, 0.2]"), (3, "[0.2, 0.2, 0.2]")] {
        let at = |x: f64, y: f64| format!("{:?}", &[x, y, 0.0][..dimension]);
        let fixed = if dimension == 2 { "'stormer-verlet'" } else { "'variational-rotation'" };
        for method in [fixed, "'event-driven-2'", "'error-controlled'\ntolerance = 1e-3"] {
            let text = format!(
                "dimension = {dimension}\nintegrator = {method}\nstep = 0.001\nhorizon = 0.5\n\
                 observables = [{{ velocity = \"it\" }}]\n\
                 bodies = [{{ name = \"it\", mass = 2, box = {side}, position = {} }}]\n\
                 loads = [{{ on = \"it\", force = {} }}]\n\
                 particles = [{{ name = \"pusher\", radius = 0.1, pinned = true, position = {} }}]\n\
                 contact = {{ restitution = 0.5 }}\n\
                 motions = [{{ of = \"pusher\", shift = {}, strength = {{ ramp = [0, 1], to = 1 }} }}]\n",
                at(0.6, 0.0),
                at(0.0, 0.4),
                at(0.0, 0.0),
                at(2.0, 0.0),
            );
            let run = scene(&text).run().unwrap();
            let end = run.observed(run.times().len() - 1);
            // It is hit from the side, 8 mm beside its middle, while 0.2 m/s^2 lead it across.
            assert!((end[0] - 3.0).abs() < 0.02 && (end[1] - 0.1).abs() < 1e-9, "{text}{end:?}");
        }
    }
}

/// A ball on a rod from a pin that moves, which another pushes: a run that is resumed is the one that was not.
#[test]
fn a_run_with_pins_that_lead_and_push_resumes_to_the_same_bits() {
    let text = "dimension = 3\nintegrator = \"variational-rotation\"\nstep = 0.005\nhorizon = 1\n\
                uniform_gravity = { acceleration = [0, 0, -10] }\n\
                bodies = [{ name = \"far\", mass = 1, box = [1, 1, 1], position = [9, 0, 0] }]\n\
                particles = [{ name = \"hook\", pinned = true, position = [0, 0, 1] },\n\
                { name = \"bob\", mass = 1, radius = 0.1, position = [0, 0, 0] },\n\
                { name = \"pusher\", pinned = true, radius = 0.2, position = [-0.6, 0, 0.05] }]\n\
                rods = [{ between = [\"hook\", \"bob\"] }]\n\
                contact = { restitution = 0.5, friction = 0.3 }\n\
                motions = [{ of = \"hook\", shift = [0, 0.2, 0], strength = { ramp = [0, 1], from = 0.1, to = 0.6 } },\n\
                { of = \"pusher\", shift = [0.7, 0, 0], strength = { ramp = [0, 1], to = 0.8 } }]\n";
    let scene = scene(text);
    assert!(!scene.run().unwrap().impacts().is_empty());
    crate::checkpoints::assert_resumes(&scene, &[2, 90, 150], "pins-that-push");
}

#[test]
fn a_pin_that_moves_and_touches_where_nothing_solves_it_is_refused() {
    let text = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.01\nhorizon = 1\n\
                particles = [{ name = \"it\", mass = 1, radius = 0.1, position = [1, 0] },\n\
                { name = \"pusher\", radius = 0.1, pinned = true, position = [0, 0] }]\n\
                contact = { stiffness = 100 }\n\
                motions = [{ of = <<\"pusher\">>, shift = [1, 0], strength = { ramp = [0, 1], to = 1 } }]\n";
    let message = "`pusher` has a `radius` and touches what is there, which a pin that moves does only where impulses \
                   move bodies in the plane or in space: leave out its `radius`, or the `stiffness` of contact";
    crate::body_diagnostics::refused(text, message);
}

/// The largest distance of the bob from where the independent solution has it, and of its tension from
/// `m (L a.^2 + g cos a + <p'', along the rod>)`, both along the whole run.
pub(crate) fn off_the_swung_pendulum(run: &Run, dimension: usize) -> [f64; 2] {
    let [l, w, mass]: [f64; 3] = [0.8, TAU * 0.7, 0.4];
    let mut off = [0.0_f64; 2];
    let every = (run.times().len() / 12).max(1);
    for sample in (every..run.times().len()).step_by(every) {
        let t = run.times()[sample];
        let [a, rate] = on_a_moving_pivot(l, w, [0.4, 0.0], t);
        let (hook, pulled) = (0.3 * (w * t).sin(), -0.3 * w * w * (w * t).sin());
        let x = run.observed(sample);
        let place = [hook + l * a.sin(), 0.5 * hook - l * a.cos()];
        off[0] = off[0].max((x[0] - place[0]).hypot(x[1] - place[1]));
        let up = (9.81 + 0.5 * pulled) * a.cos() - pulled * a.sin();
        let tension = mass * (l * rate * rate + up);
        off[1] = off[1].max((x[2 * dimension] - tension).abs());
    }
    off
}

#[test]
fn a_pin_that_moves_leads_its_rod_in_the_coordinates_of_joints() {
    for dimension in [2, 3] {
        let run = |method: &str, step: f64| {
            scene(&swung_beside_a_body(dimension, method, "", step)).run().unwrap()
        };
        let runs = [0.004, 0.002].map(|step| run("\"joint-coordinates\"", step));
        let [coarse, fine] = runs.each_ref().map(|run| off_the_swung_pendulum(run, dimension)[0]);
        let slope = (coarse / fine).log2();
        assert!((slope - 2.0).abs() < 0.2 && fine < 1e-3, "{dimension}: {slope} {fine}");
        let [coarse, fine] = runs.each_ref().map(defect);
        assert!((coarse / fine).log2() > 1.7 && fine < 1e-3, "{dimension}: {coarse} {fine}");
        for method in ["dormand-prince-853", "dormand-prince-54"] {
            let run = run(&format!("\"{method}\"\ntolerance = 1e-9"), 0.05);
            let off = off_the_swung_pendulum(&run, dimension);
            assert!(off[0] < 1e-6 && off[1] < 1e-4, "{dimension} {method}: {off:?}");
            assert!(defect(&run) < 1e-6, "{dimension} {method}: {}", defect(&run));
            let (name, work) = &run.works()[0];
            assert!(name == "pins that move rods" && work.abs() > 0.1, "{:?}", run.works());
        }
    }
}

/// Chains of two boxes that hang on a hinge and on a rod from their end to a swung pin, as they come.
fn chain_on_a_swung_pin(random: &mut SplitMix64, method: &str, step: f64) -> String {
    let mut vector = |size: f64| -> [f64; 3] { std::array::from_fn(|_| size * random.symmetric()) };
    let ([a, b, c], shift) = (vector(0.1), vector(0.2));
    let at = vector(0.2);
    let frequency = 0.6 + 0.3 * a.abs();
    format!(
        "dimension = 3\nintegrator = {method}\nstep = {step}\nhorizon = 0.8\n\
         uniform_gravity = {{ acceleration = [0, 0, -9.81] }}\n\
         observables = [{{ position = \"second\" }}, {{ velocity = \"second\" }}]\n\
         [[bodies]]\nname = \"first\"\nmass = {}\nbox = [0.5, 0.1, 0.2]\nposition = [0.25, 0, 0]\n\
         [[bodies]]\nname = \"second\"\nmass = {}\nbox = [0.4, 0.2, 0.1]\nposition = [0.7, 0, 0]\n\
         points = [[0.2, {b}, {c}]]\n\
         [[joints]]\nkind = \"ball\"\nbetween = [\"world\", \"first\"]\nat = [0, 0, 0]\n\
         [[joints]]\nkind = \"hinge\"\nbetween = [\"first\", \"second\"]\nat = [0.5, 0, 0]\naxis = [{a}, 1, 0]\n\
         [[particles]]\nname = \"hook\"\npinned = true\nposition = [{}, {}, {}]\n\
         [[rods]]\nbetween = [\"hook\", \"second.8\"]\n\
         [[motions]]\nof = \"hook\"\nshift = {shift:?}\n\
         strength = {{ sine = 1, frequency = {frequency}, phase = 1.5707963267948966, offset = -1 }}\n",
        1.0 + 5.0 * b.abs(),
        1.0 + 5.0 * c.abs(),
        1.1 + at[0],
        at[1],
        0.6 + at[2],
    )
}

/// Positions of all observed, the furthest apart of two runs that are sampled alike.
fn furthest(a: &Run, b: &Run, [every_a, every_b]: [usize; 2]) -> f64 {
    let samples = (a.times().len() - 1) / every_a;
    let at = |k: usize| {
        let [x, y] = [a.observed(k * every_a), b.observed(k * every_b)];
        assert!((a.times()[k * every_a] - b.times()[k * every_b]).abs() < 1e-9);
        (0..3).map(|c| (x[c] - y[c]).abs()).fold(0.0, f64::max)
    };
    (0..=samples).map(at).fold(0.0, f64::max)
}

#[test]
fn random_chains_on_a_swung_pin_move_alike_in_all_coordinates() {
    for seed in 0..4 {
        let run = |method: &str, step: f64| {
            let text = chain_on_a_swung_pin(&mut SplitMix64::new(seed), method, step);
            scene(&text).run().unwrap_or_else(|error| panic!("{seed} {method}: {error}"))
        };
        let full = run("\"variational-rotation\"", 0.002);
        let joints = run("\"joint-coordinates\"", 0.002);
        // The same principle on the same configurations.
        assert!(furthest(&full, &joints, [1, 1]) < 1e-8, "{seed}");
        let [a, b] = [&full, &joints].map(|run| run.works()[0].1);
        assert!((a - b).abs() < 1e-7 && a.abs() > 1e-3, "{seed}: {a} {b}");
        let fine = run("\"dormand-prince-853\"\ntolerance = 1e-10", 0.004);
        let coarser = run("\"joint-coordinates\"", 0.004);
        let off = [furthest(&coarser, &fine, [1, 1]), furthest(&joints, &fine, [2, 1])];
        let slope = (off[0] / off[1]).log2();
        assert!((slope - 2.0).abs() < 0.3, "{seed}: {slope} {off:?}");
        assert!(defect(&fine) < 1e-7, "{seed}: {}", defect(&fine));
    }
}

#[test]
fn a_run_with_a_rod_to_a_moving_pin_in_joint_coordinates_resumes_to_the_same_bits() {
    for (method, name) in [
        ("\"joint-coordinates\"", "led-joints"),
        ("\"dormand-prince-853\"\ntolerance = 1e-8", "led-adaptive"),
    ] {
        let text = chain_on_a_swung_pin(&mut SplitMix64::new(7), method, 0.01);
        crate::checkpoints::assert_resumes(&scene(&text), &[2, 41, 79], name);
    }
}

/// A pin that starts and stops at once along its rod gives half of `m u^2` and takes it back; across it nothing.
#[test]
fn a_pin_whose_velocity_jumps_gives_its_work_in_joint_coordinates() {
    let run = |shift: &str, place: &str, end: f64| {
        let text = format!(
            "dimension = 2\nintegrator = \"dormand-prince-853\"\ntolerance = 1e-10\nstep = 0.1\nhorizon = {end}\n\
             observables = [{{ position = \"bob\" }}, {{ velocity = \"bob\" }}]\n\
             bodies = [{{ name = \"far\", mass = 1, box = [1, 1], position = [30, 0] }}]\n\
             particles = [{{ name = \"hook\", position = [0, 0], pinned = true }},\n\
             {{ name = \"bob\", position = {place}, mass = 0.5 }}]\n\
             rods = [{{ between = [\"hook\", \"bob\"] }}]\n\
             motions = [{{ of = \"hook\", shift = {shift}, strength = {{ ramp = [0, 1], from = 0.25, to = 0.75 }} }}]\n"
        );
        scene(&text).run().unwrap()
    };
    let halfway = run("[0, 1]", "[0, -1]", 0.5);
    let x = halfway.observed(halfway.times().len() - 1);
    assert!((x[1] + 0.5).abs() < 1e-9 && (x[3] - 2.0).abs() < 1e-9, "{x:?}");
    assert!((halfway.works()[0].1 - 0.5 * 0.5 * 4.0).abs() < 1e-9, "{:?}", halfway.works());
    let all = run("[0, 1]", "[0, -1]", 1.0);
    let x = all.observed(all.times().len() - 1);
    assert!(x[1].abs() < 1e-9 && x[3].abs() < 1e-9 && all.works()[0].1.abs() < 1e-9, "{x:?}");
    // Seen from a pin that has started it turns evenly.
    let turning = run("[1, 0]", "[0, -1]", 0.7);
    let (x, way) = (turning.observed(turning.times().len() - 1), 0.9);
    assert!((x[0] - way + way.sin()).abs() < 1e-8 && (x[1] + way.cos()).abs() < 1e-8, "{x:?}");
    assert!(defect(&turning) < 1e-8, "{}", defect(&turning));
}

#[test]
fn what_a_rod_to_a_moving_pin_cannot_do_is_told() {
    let text = |method: &str, strength: &str| {
        format!(
            "dimension = 2\nintegrator = {method}\nstep = 0.01\nhorizon = 1\n\
             bodies = [{{ name = \"far\", mass = 1, box = [1, 1], position = [9, 0] }}]\n\
             particles = [{{ name = \"hook\", position = [0, 0], pinned = true }},\n\
             {{ name = \"bob\", position = [1, 0], mass = 1 }}]\n\
             rods = [{{ between = [\"hook\", \"bob\"] }}]\n\
             motions = [{{ of = \"hook\", shift = [1, 0], strength = {strength} }}]\n"
        )
    };
    let message = "`dormand-prince-853` cannot step pins that jump and hold rods or touch, which takes an infinite speed: \
                   make it a `ramp`";
    let jump = text("<<\"dormand-prince-853\">>", "{ step = [0, 1], at = 0.5 }");
    crate::body_diagnostics::refused(&format!("tolerance = 1e-6\n{jump}"), message);
    // The pin starts at once along the rod, and the bob does not.
    for method in ["\"joint-coordinates\"", "\"dormand-prince-853\"\ntolerance = 1e-6"] {
        let told = scene(&text(method, "{ sine = 1, frequency = 1 }")).run().unwrap_err();
        assert!(
            told.to_string().starts_with("the velocities at the start are against the rod"),
            "{told}"
        );
    }
}

/// Along its rod a dumbbell is moved by a pin as one particle of the mass of both, to rounding.
#[test]
fn a_pin_that_moves_pulls_at_what_hangs_on_rods_as_at_one_mass() {
    let of = |method: &str, particles: &str, rods: &str| {
        let text = format!(
            "dimension = 2\nintegrator = \"{method}\"\nstep = 0.01\nhorizon = 3\n\
             observables = [{{ position = \"p\" }}]\n\
             particles = [{{ name = \"hook\", pinned = true, position = [-1, 0] }}, {particles}]\n\
             springs = [{{ between = [\"hook\", \"p\"], stiffness = 5 }}]\n{rods}\
             motions = [{{ of = \"hook\", shift = [0.4, 0], strength = {{ ramp = [0, 1], to = 1.5 }} }}]\n"
        );
        Scene::parse("pin.toml", &text).unwrap_or_else(|error| panic!("{error}")).run().unwrap()
    };
    let one = of("stormer-verlet", "{ name = \"p\", mass = 3, position = [0, 0] }", "");
    let both = "{ name = \"p\", mass = 1, position = [0, 0] }, { name = \"q\", mass = 2, position = [1, 0] }";
    let two = of("rattle", both, "rods = [{ between = [\"p\", \"q\"] }]\n");
    for sample in 0..one.times().len() {
        let [a, b] = [&one, &two].map(|run| run.observed(sample)[0]);
        assert!((a - b).abs() < 1e-12, "{sample}: {a} {b}");
    }
    let [a, b] = [&one, &two].map(|run| run.works()[0].1);
    assert!((a - b).abs() < 1e-12 && a > 0.01, "{a} {b}");
}

#[test]
fn a_pin_whose_velocity_jumps_moves_its_rod_and_leaves_the_budget_open() {
    // From rest to rest a metre along the rod within a step: the rate that a jump is told with is that after it.
    let text = "dimension = 2\nintegrator = \"rattle\"\nstep = 0.01\nhorizon = 0.3\n\
                particles = [{ name = \"hook\", position = [0, 0], pinned = true },\n\
                { name = \"bob\", position = [0, -1], mass = 1 }]\n\
                rods = [{ between = [\"hook\", \"bob\"] }]\n\
                motions = [{ of = \"hook\", shift = [0, 1], \
                strength = { ramp = [0, 1], from = 0.1, to = 0.11 } }]\n";
    let run = scene(text).run().unwrap();
    assert!(last(&run).iter().zip([0.0, 1.0, 0.0, 0.0]).all(|(x, y)| (x - y).abs() < 1e-12));
    let kinetic = run.kinetic_energies();
    assert!(kinetic[kinetic.len() - 1] < 1e-20);
    assert!(run.works()[0].1 > 1e3, "{:?}", run.works());
}
