//! Loads, motors, pins that move, gravity and heat in time: closed forms, orders, and the energy's budget.

use std::f64::consts::TAU;

use stationary_scene::{DriveFault, Fault, Run, Scene, SceneError};

pub(crate) fn scene(text: &str) -> Scene {
    Scene::parse("driven.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

fn fault(text: &str) -> Fault {
    match Scene::parse("driven.toml", text) {
        Err(SceneError::Invalid(error)) => error.fault,
        other => panic!("{other:?}"),
    }
}

/// What the energy's change and the works differ by, over the largest kinetic energy.
pub(crate) fn defect(run: &Run) -> f64 {
    let energies = run.energies();
    let change = energies[energies.len() - 1] - energies[0];
    let works: f64 = run.works().iter().map(|(_, work)| work).sum();
    let kinetic = run.kinetic_energies().iter().copied().fold(0.0, f64::max);
    (change - works).abs() / kinetic
}

pub(crate) fn last(run: &Run) -> &[f64] {
    run.positions(run.times().len() - 1)
}

/// A mass on a spring, swinging once a second beside a wall that is a pin; and whatever else is there.
pub(crate) fn mass_on_a_spring(method: &str, step: f64, beside: &str) -> String {
    format!(
        "dimension = 1\nintegrator = {method}\nstep = {step}\nhorizon = 1.5\n\
         particles = [{{ name = \"wall\", position = [0], pinned = true }},\n\
         {{ name = \"mass\", position = [1], mass = 0.5 }}]\n\
         springs = [{{ between = [\"wall\", \"mass\"], stiffness = {} }}]\n{beside}\n",
        0.5 * TAU * TAU
    )
}

/// `x'' + 4 pi^2 x = strength(t)` of a mass on a spring from rest.
fn oscillator(method: &str, step: f64, strength: &str) -> Scene {
    let load = format!("loads = [{{ on = \"mass\", force = [0.5], strength = {strength} }}]");
    scene(&mass_on_a_spring(method, step, &load))
}

/// Its answer to a strength that is 3 from 0.1 to 0.7.
fn after_pulse(t: f64) -> f64 {
    let of_step = |since: f64| 3.0 * (1.0 - (TAU * since).cos()) / (TAU * TAU);
    1.0 + of_step(t - 0.1) - of_step(t - 0.7)
}

#[test]
fn a_load_that_swings_is_followed_at_the_order_of_each_method() {
    // x = (sin w t - w/W sin W t)/(W^2 - w^2), w = 2 pi 0.4, W = 2 pi
    let (w, free) = (TAU * 0.4, TAU);
    let exact = 1.0 + ((w * 1.5).sin() - w / free * (free * 1.5).sin()) / (free * free - w * w);
    let sine = "{ sine = 1, frequency = 0.4 }";
    for (method, order) in [
        ("\"stormer-verlet\"", 2.0),
        ("\"implicit-midpoint\"", 2.0),
        ("\"trapezoid\"", 2.0),
        ("\"newmark\"", 2.0),
        ("\"generalized-alpha\"", 2.0),
    ] {
        let error = |step: f64| {
            let run = oscillator(method, step, sine).run().unwrap();
            (last(&run)[1] - exact).abs()
        };
        let slope = (error(0.005) / error(0.0025)).log2();
        assert!((slope - order).abs() < 0.2, "{method}: {slope}");
    }
    for method in ["dormand-prince-853", "radau-iia-5", "bdf-5"] {
        let declared = format!("\"{method}\"\ntolerance = 1e-9");
        let run = oscillator(&declared, 0.5, sine).run().unwrap();
        assert!((last(&run)[1] - exact).abs() < 1e-6, "{method}: {}", last(&run)[1] - exact);
        assert!(defect(&run) < 1e-6, "{method}: {}", defect(&run));
    }
}

#[test]
fn a_pulse_that_begins_and_ends_within_steps_costs_no_order() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    std::fs::write(folder.join("pulse.csv"), "t,s\n0.1,0\n0.1,3\n0.7,3\n0.7,0\n").unwrap();
    let beside = folder.join("a.toml");
    let run = |method: &str, step: f64| {
        let load =
            "loads = [{ on = \"mass\", force = [0.5], strength = { table = \"pulse.csv\" } }]";
        let text = mass_on_a_spring(method, step, load);
        Scene::parse_at(&beside, &text).unwrap_or_else(|error| panic!("{error}")).run().unwrap()
    };
    // No step of 1.5/n ends at 0.1 and 0.7 together.
    for method in ["\"stormer-verlet\"", "\"newmark\""] {
        let error = |n: f64| (last(&run(method, 1.5 / n))[1] - after_pulse(1.5)).abs();
        let (coarse, fine) = (error(97.0), error(776.0));
        assert!(coarse < 2e-3 && fine < coarse / 40.0, "{method}: {coarse} {fine}");
    }
    // A method that would take one step over it is stopped at its corners.
    let run = run("\"dormand-prince-853\"\ntolerance = 1e-10", 1.5);
    assert!((last(&run)[1] - after_pulse(1.5)).abs() < 1e-7, "{}", last(&run)[1]);
}

#[test]
fn the_works_close_the_budget_to_the_order_of_the_method() {
    let sine = "{ sine = 5, frequency = 1.3, phase = 0.7 }";
    for (method, least) in
        [("\"stormer-verlet\"", 1.8), ("\"implicit-midpoint\"", 1.8), ("\"newmark\"", 1.8)]
    {
        let of = |step: f64| defect(&oscillator(method, step, sine).run().unwrap());
        let (coarse, fine) = (of(0.01), of(0.005));
        assert!(fine < 1e-3, "{method}: {fine}");
        assert!(fine < 1e-10 || (coarse / fine).log2() > least, "{method}: {coarse} {fine}");
    }
    let run = oscillator("\"stormer-verlet\"", 0.005, sine).run().unwrap();
    let works = run.works();
    assert_eq!(works[0].0, "load on mass");
    assert!(works[0].1.abs() > 0.1, "{works:?}");
}

#[test]
fn what_falls_in_gravity_that_changes_falls_alike_as_particle_and_body() {
    // x = -g/w^2 (w t - sin w t) with the strength sin w t.
    let w = TAU * 0.5;
    let exact = |t: f64| -9.81 / (w * w) * (w * t - (w * t).sin());
    let gravity = |g: &str| {
        format!(
            "uniform_gravity = {{ acceleration = {g}, strength = {{ sine = 1, frequency = 0.5 }} }}"
        )
    };
    for (dimension, method, thing, g) in [
        (
            2,
            "stormer-verlet",
            "particles = [{ name = \"a\", position = [0, 0], mass = 2 }]",
            "[0, -9.81]",
        ),
        (
            2,
            "stormer-verlet",
            "bodies = [{ name = \"a\", box = [1, 2], position = [0, 0], mass = 2 }]",
            "[0, -9.81]",
        ),
        (
            3,
            "variational-rotation",
            "bodies = [{ name = \"a\", box = [1, 2, 3], position = [0, 0, 0], mass = 2, angular_velocity = [1, 2, 3] }]",
            "[0, -9.81, 0]",
        ),
    ] {
        let text = format!(
            "dimension = {dimension}\nintegrator = \"{method}\"\nstep = 0.001\nhorizon = 1.2\n{}\n{thing}\n",
            gravity(g)
        );
        let run = scene(&text).run().unwrap();
        assert!(
            (last(&run)[1] - exact(1.2)).abs() < 2e-6,
            "{thing}: {}",
            last(&run)[1] - exact(1.2)
        );
        assert!(defect(&run) < 1e-4, "{thing}: {}", defect(&run));
    }
}

#[test]
fn a_force_at_a_point_of_a_body_changes_both_momenta_by_its_impulse() {
    let text = |strength: &str| {
        format!(
            "dimension = 3\nintegrator = \"axis-rotations\"\nstep = 0.001\nhorizon = 1\n\
         bodies = [{{ name = \"a\", box = [1, 2, 3], points = [[0.3, 0.2, -0.4]], position = [0, 0, 0], \
         mass = 2, angular_velocity = [0.4, 0.5, 3] }}]\n\
         observables = [\"linear-momentum\", \"angular-momentum\", {{ position = \"a.8\" }}]\n\
         loads = [{{ on = \"a.8\", force = [1, -2, 0.5], strength = {strength} }}]\n"
        )
    };
    let run = scene(&text("{ ramp = [0, 3], to = 1 }")).run().unwrap();
    let n = run.times().len();
    // Trapezoids of x cross F along the run; the impulse of a force is exact.
    let (mut spin, f) = ([0.0; 3], [1.0, -2.0, 0.5]);
    let moment = |sample: usize| {
        let row = run.observed(sample);
        let (x, s) = (&row[6..9], 3.0 * run.times()[sample]);
        let cross = |a: usize, b: usize| s * (x[a] * f[b] - x[b] * f[a]);
        [cross(1, 2), cross(2, 0), cross(0, 1)]
    };
    for sample in 1..n {
        let (a, b) = (moment(sample - 1), moment(sample));
        (0..3).for_each(|c| spin[c] += 0.0005 * (a[c] + b[c]));
    }
    let (first, end) = (run.observed(0), run.observed(n - 1));
    for c in 0..3 {
        assert!((end[c] - first[c] - 1.5 * f[c]).abs() < 1e-12, "{c}: {}", end[c]);
        assert!(
            (end[3 + c] - first[3 + c] - spin[c]).abs() < 1e-5,
            "{c}: {} {}",
            end[3 + c],
            spin[c]
        );
    }
    assert!(defect(&run) < 1e-5, "{}", defect(&run));
}

/// A box on a pin or a hinge at the origin with a motor.
fn motored(dimension: usize, motor: &str, step: f64) -> Scene {
    let (method, side, place, joint) = match dimension {
        3 => (
            "variational-rotation",
            "[1, 0.2, 0.4]",
            "[0.5, 0, 0]",
            "kind = \"hinge\", axis = [0, 0, 2], at = [0, 0, 0]",
        ),
        _ => ("stormer-verlet", "[1, 0.2]", "[0.5, 0]", "kind = \"pin\", at = [0, 0]"),
    };
    scene(&format!(
        "dimension = {dimension}\nintegrator = \"{method}\"\nstep = {step}\nhorizon = 1\n\
         bodies = [{{ name = \"arm\", mass = 3, box = {side}, position = {place} }}]\n\
         joints = [{{ {joint}, between = [\"world\", \"arm\"] }}]\n\
         motors = [{{ between = [\"world\", \"arm\"], {motor} }}]\n\
         observables = [\"energy\", {{ angular_velocity = \"arm\" }}]\n"
    ))
}

/// The moment of the box about the joint.
const MOMENT: f64 = 3.0 / 12.0 * (1.0 + 0.04) + 3.0 * 0.25;

#[test]
fn a_motor_of_given_torque_turns_its_arm_as_the_moment_has_it() {
    for dimension in [2, 3] {
        let run = motored(dimension, "torque = { ramp = [0, 2], to = 0.5 }", 0.001).run().unwrap();
        // The integral of the torque: 0.5 up to 0.5, then 1.
        let (exact, end) = (1.5 / MOMENT, run.observed(run.times().len() - 1));
        let speed = end[end.len() - 1];
        assert!((speed - exact).abs() < 1e-9, "{dimension}: {speed} {exact}");
        assert_eq!(run.works()[0].0, "motor between world and arm");
        assert!((run.works()[0].1 - end[0]).abs() < 1e-5, "{:?} {}", run.works(), end[0]);
    }
}

#[test]
fn a_motor_of_given_speed_is_where_its_speed_leads_and_pays_the_energy() {
    for dimension in [2, 3] {
        let run = motored(dimension, "speed = { ramp = [0, 4], to = 0.8 }", 0.0005).run().unwrap();
        // The turn: 1.6 up to 0.8, then 0.8.
        let end = last(&run);
        let place = [0.5 * 2.4_f64.cos(), 0.5 * 2.4_f64.sin()];
        for c in 0..2 {
            assert!((end[c] - place[c]).abs() < 1e-9, "{dimension}: {} {}", end[c], place[c]);
        }
        let energy = 0.5 * MOMENT * 16.0;
        let works = run.works();
        assert_eq!(works.len(), 1);
        assert!((works[0].1 - energy).abs() < 1e-2 * energy, "{dimension}: {works:?} {energy}");
        assert!(defect(&run) < 1e-2, "{}", defect(&run));
    }
}

#[test]
fn a_driven_pendulum_on_a_rod_keeps_its_rod_and_its_budget() {
    let run = |step: f64| {
        scene(&format!(
            "dimension = 2\nintegrator = \"rattle\"\nstep = {step}\nhorizon = 2\n\
             uniform_gravity = {{ acceleration = [0, -9.81] }}\ndrag = {{ coefficient = 0.1 }}\n\
             particles = [{{ name = \"hook\", position = [0, 0], pinned = true }},\n\
             {{ name = \"bob\", position = [0.6, -0.8], mass = 0.4 }}]\n\
             rods = [{{ between = [\"hook\", \"bob\"] }}]\n\
             loads = [{{ on = \"bob\", force = [2, 0], strength = {{ sine = 1, frequency = 0.7 }} }}]\n"
        ))
        .run()
        .unwrap()
    };
    let (coarse, fine) = (run(0.01), run(0.005));
    for sample in 0..fine.times().len() {
        let x = fine.positions(sample);
        assert!((x[2].hypot(x[3]) - 1.0).abs() < 1e-12);
    }
    let slope = (defect(&coarse) / defect(&fine)).log2();
    assert!(defect(&fine) < 1e-3 && slope > 1.7, "{} {}", defect(&coarse), defect(&fine));
    let names: Vec<String> = fine.works().into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["drag", "load on bob"]);
    assert!(fine.works()[0].1 < 0.0);
}

#[test]
fn heat_that_flows_in_is_there() {
    for method in ["implicit-euler", "crank-nicolson", "explicit-euler"] {
        let text = format!(
            "dimension = 1\nintegrator = \"{method}\"\nstep = 0.001\nhorizon = 1\n\
             [heat]\nname = \"bar\"\ndiffusivity = 0.1\n\
             shape = {{ kind = \"bar\", size = [2], cells = [20] }}\n\
             sources = [{{ at = [0.5], radius = 0.05, rate = 6, strength = {{ step = [2, 0], at = 0.2503 }} }}]\n"
        );
        let run = scene(&text).run().unwrap();
        let heat = run.observed(run.times().len() - 1)[0];
        // One vertex with 0.1 of the length, twice 6 for 0.2503.
        let exact = 0.1 * 12.0 * 0.2503;
        assert!((heat - exact).abs() < 1e-12, "{method}: {heat} {exact}");
        assert!((run.works()[0].1 - exact).abs() < 1e-12, "{method}: {:?}", run.works());
    }
}

#[test]
fn a_driven_run_that_is_resumed_has_the_works_of_a_whole_one() {
    use stationary_scene::{Checkpoint, Control, Observer, Progress};
    struct Keep(Option<Checkpoint>);
    impl Observer for Keep {
        fn stepped(&mut self, now: Progress<'_>) -> Control {
            if now.step == 40 { Control::Checkpoint } else { Control::Continue }
        }
        fn keep(&mut self, checkpoint: &Checkpoint) {
            self.0 = Some(checkpoint.clone());
        }
    }
    for method in ["\"stormer-verlet\"", "\"newmark\"", "\"dormand-prince-853\"\ntolerance = 1e-6"]
    {
        let scene = oscillator(method, 0.015, "{ sine = 3, frequency = 2 }");
        let mut keep = Keep(None);
        let whole = scene.run_from(None, &mut keep).unwrap();
        let resumed = scene.run_from(keep.0, &mut Keep(None)).unwrap();
        assert_eq!(whole.works(), resumed.works(), "{method}");
        assert_eq!(whole, resumed, "{method}");
    }
}

#[test]
fn what_cannot_be_driven_is_refused_with_the_reason() {
    let base = "dimension = 2\nstep = 0.01\nhorizon = 1\nintegrator = \"stormer-verlet\"\n\
        particles = [{ name = \"a\", position = [0, 0], pinned = true }, { name = \"b\", position = [1, 0], mass = 1 }]\n";
    let load = |load: &str| fault(&format!("{base}loads = [{{ {load} }}]\n"));
    assert_eq!(
        load("on = \"a\", force = [1, 0]"),
        Fault::Drives(DriveFault::LoadOnPin("a".to_owned()))
    );
    assert_eq!(load("on = \"b\""), Fault::Drives(DriveFault::NoLoad));
    assert_eq!(
        load("on = \"b\", torque = 1"),
        Fault::Drives(DriveFault::TorqueOnParticle("b".to_owned()))
    );
    let strength =
        |strength: &str| load(&format!("on = \"b\", force = [1, 0], strength = {strength}"));
    assert_eq!(strength("{}"), Fault::Drives(DriveFault::NotOneStrength));
    assert_eq!(strength("{ step = [0, 1], sine = 1 }"), Fault::Drives(DriveFault::NotOneStrength));
    assert_eq!(
        strength("{ step = [0, 1, 2] }"),
        Fault::Drives(DriveFault::TwoValues { key: "`step`", got: 3 })
    );
    assert_eq!(strength("{ ramp = [0, 1] }"), Fault::Drives(DriveFault::StrengthKey("ramp", "to")));
    assert_eq!(
        strength("{ ramp = [0, 1], from = 2, to = 1 }"),
        Fault::Drives(DriveFault::Backwards { from: 2.0, to: 1.0 })
    );
    assert_eq!(
        strength("{ sine = 1 }"),
        Fault::Drives(DriveFault::StrengthKey("sine", "frequency"))
    );
    let of = Fault::Drives(DriveFault::KeyOfAnother { key: "at", of: "step", kind: "sine" });
    assert_eq!(strength("{ sine = 1, frequency = 1, at = 2 }"), of);
    assert!(matches!(strength("{ table = \"../load.csv\" }"), Fault::OutsideFolder(_)));
    let motion = |motion: &str| fault(&format!("{base}motions = [{{ {motion} }}]\n"));
    assert_eq!(
        motion("of = \"b\", shift = [1, 0], strength = 0"),
        Fault::Drives(DriveFault::MotionOfFree("b".to_owned()))
    );
    assert_eq!(
        motion("of = \"a\", shift = [1, 0], strength = 1"),
        Fault::Drives(DriveFault::MotionFromElsewhere(1.0))
    );
    let high =
        base.replace("stormer-verlet", "yoshida-6") + "loads = [{ on = \"b\", force = [1, 0] }]\n";
    assert!(matches!(fault(&high), Fault::MethodCannot { .. }));
}

/// Springs that are damped little and very much, in all orders: all are solved at once.
#[test]
fn the_order_of_dampers_does_not_show() {
    let end = |first: usize| {
        let mut springs = [("a", "b", 1.0), ("b", "c", 0.5), ("c", "a", 3e5), ("c", "pin", 40.0)]
            .map(|(a, b, damping)| {
                format!(
                    "{{ between = [\"{a}\", \"{b}\"], stiffness = 20, rest_length = 0.8, damping = {damping} }}"
                )
            });
        springs.rotate_left(first);
        springs[..2].reverse();
        let text = format!(
            "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.02\nhorizon = 1\n\
             drag = {{ coefficient = 0.1 }}\n\
             particles = [{{ name = \"a\", mass = 1, position = [0, 0] }},\n\
             {{ name = \"b\", mass = 1, position = [1, 0] }}, {{ name = \"c\", mass = 0.1, position = [1, 1] }},\n\
             {{ name = \"pin\", pinned = true, position = [3, 1] }}]\nsprings = [{}]\n",
            springs.join(", ")
        );
        last(&scene(&text).run().unwrap()).to_vec()
    };
    let one = end(0);
    for other in [1, 2, 3].map(end) {
        let apart = one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-11, "{apart:e}: {one:?} {other:?}");
    }
}

/// Each by itself would take all of the rate, three times what there is: the block went 9e-3 off.
#[test]
fn stiff_dampers_of_one_body_under_contact_let_it_stand() {
    let text = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.01\nhorizon = 0.2\n\
        particles = [{ name = \"post\", pinned = true, position = [3, 0.5] }]\n\
        bodies = [{ name = \"block\", mass = 1, box = [1, 1], position = [0, 0.5], velocity = [1, 0], \
        points = [[0, 0], [0, 0.1], [0, -0.1]] }]\n\
        springs = [{ between = [\"block.1\", \"post\"], stiffness = 1, damping = 1e5 },\n\
        { between = [\"block.2\", \"post\"], stiffness = 1, damping = 1e5 },\n\
        { between = [\"block.3\", \"post\"], stiffness = 1, damping = 1e5 }]\n\
        contact = { restitution = 0, walls = [{ normal = [0, 1], at = [0, 0] }] }\n";
    let run = scene(text).run().unwrap();
    let moved = (last(&run)[0]).abs();
    assert!(moved < 1e-4, "{moved}");
}
