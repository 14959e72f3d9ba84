//! Joints, rods, motors and pins that push in steps chosen by their error: closed forms, other solvers, budgets,
//! resuming.

use std::f64::consts::TAU;

use stationary_measure::SplitMix64;
use stationary_scene::{Run, Scene};

use crate::checkpoints::assert_resumes;
use crate::moving_pins::{off_the_swung_pendulum, swung_beside_a_body};

pub(crate) fn run(text: &str) -> Run {
    Scene::parse("a.toml", text)
        .unwrap_or_else(|error| panic!("{error}"))
        .run()
        .unwrap_or_else(|error| panic!("{error}"))
}

/// What the energy's change and the works differ by, J.
pub(crate) fn left(run: &Run) -> f64 {
    let energies = run.energies();
    let works: f64 = run.works().iter().map(|(_, work)| work).sum();
    (energies[energies.len() - 1] - energies[0] - works).abs()
}

fn work(run: &Run, name: &str) -> f64 {
    let all = run.works();
    all.iter().find(|(other, _)| other == name).unwrap_or_else(|| panic!("{name}: {all:?}")).1
}

/// The largest difference of what two runs that are sampled alike observe.
fn apart(a: &Run, b: &Run) -> f64 {
    assert_eq!(a.times().len(), b.times().len());
    let at = |k: usize| {
        let pairs = a.observed(k).iter().zip(b.observed(k));
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    (0..a.times().len()).map(at).fold(0.0, f64::max)
}

fn chosen(tolerance: f64) -> String {
    format!("\"error-controlled\"\ntolerance = {tolerance:e}")
}

/// A chain of boxes on pins in the plane or on hinges and balls in space, and a floor below it if there is contact.
fn chain(random: &mut SplitMix64, dimension: usize, method: &str, contact: &str) -> String {
    let vector = |x: [f64; 3]| format!("{:?}", &x[..dimension]);
    let sides = if dimension == 2 { "[0.4, 0.1]" } else { "[0.4, 0.1, 0.15]" };
    let gravity = if dimension == 2 { [0.0, -9.81, 0.0] } else { [0.0, 0.0, -9.81] };
    let spin = 1.0 + random.symmetric();
    let mut text = format!(
        "dimension = {dimension}\nintegrator = {method}\nstep = 0.02\nhorizon = 0.8\n\
         uniform_gravity = {{ acceleration = {} }}\n\
         observables = [{{ position = \"link-2\" }}, {{ position = \"link-1\" }}]\n",
        vector(gravity)
    );
    for link in 0..3 {
        let mass = 1.5 + random.symmetric();
        text += &format!(
            "[[bodies]]\nname = \"link-{link}\"\nmass = {mass}\nbox = {sides}\nposition = {}\n",
            vector([0.2 + 0.4 * f64::from(link), 0.0, 0.0])
        );
        let kind = match (dimension, link) {
            (2, _) => "kind = \"pin\"".to_owned(),
            (_, 1) => format!("kind = \"hinge\"\naxis = [{}, 1, 0]", 0.3 * random.symmetric()),
            _ => "kind = \"ball\"".to_owned(),
        };
        let before = if link == 0 { "world".to_owned() } else { format!("link-{}", link - 1) };
        text += &format!(
            "[[joints]]\n{kind}\nbetween = [\"{before}\", \"link-{link}\"]\nat = {}\n",
            vector([0.4 * f64::from(link), 0.0, 0.0])
        );
    }
    // A load that swings turns the last of it out of the plane.
    let force = if dimension == 2 { [spin, 0.0, 0.0] } else { [spin, 2.0, 0.0] };
    text += &format!(
        "[[loads]]\non = \"link-2\"\nforce = {}\nstrength = {{ sine = 1, frequency = 1.3 }}\n",
        vector(force)
    );
    text + contact
}

#[test]
fn chains_swing_as_in_the_coordinates_of_their_joints_to_the_accuracy_that_is_asked_for() {
    for (dimension, seed) in [(2, 1), (3, 2), (2, 3), (3, 4)] {
        let text = |method: &str, contact: &str| {
            chain(&mut SplitMix64::new(seed), dimension, method, contact)
        };
        let normal = if dimension == 2 { "[0, 1]" } else { "[0, 0, 1]" };
        let at = if dimension == 2 { "[0, -9]" } else { "[0, 0, -9]" };
        let floor = format!("[contact]\nwalls = [{{ normal = {normal}, at = {at} }}]\n");
        let truth = run(&text("\"dormand-prince-853\"\ntolerance = 1e-11", ""));
        let (mut before, mut steps) = ([f64::INFINITY; 2], Vec::new());
        for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
            let run = run(&text(&chosen(tolerance), &floor));
            let (off, open) = (apart(&run, &truth), left(&run));
            assert!(off < 20.0 * tolerance && off < 0.7 * before[0], "{seed} {tolerance}: {off}");
            assert!(open < 30.0 * tolerance && open < before[1], "{seed} {tolerance}: {open}");
            assert!(work(&run, "joints").abs() < 30.0 * tolerance, "{:?}", run.works());
            before = [off, open];
            steps.push(run.chosen_steps().accepted);
            assert_eq!(run.unsettled().steps, 0);
        }
        // Of order 2: a hundredth of the error for ten times the steps.
        assert!(steps[3] < 20 * steps[1], "{steps:?}");
    }
}

#[test]
fn chains_that_fall_on_a_floor_do_as_many_fixed_steps_do() {
    for seed in 0..3 {
        let floor = "[contact]\nrestitution = 0.3\nfriction = 0.4\nwalls = [{ normal = [0, 1], at = [0, -0.7] }]\n";
        let text = |method: &str| chain(&mut SplitMix64::new(seed), 2, method, floor);
        let fixed =
            text("\"stormer-verlet\"").replace("step = 0.02", "step = 2e-5\nsample_every = 1000");
        let fixed = run(&fixed);
        let mut before = f64::INFINITY;
        for tolerance in [1e-3, 1e-4, 1e-5] {
            let run = run(&text(&chosen(tolerance)));
            assert!(!run.impacts().is_empty() && work(&run, "impacts") < -0.1, "{:?}", run.works());
            let off = apart(&run, &fixed);
            assert!(off < 2.0 * tolerance + 1e-4 && off <= before, "{seed} {tolerance}: {off}");
            // Corners that turn on the floor close it with the root of the tolerance.
            let open = left(&run);
            assert!(open < 1.5 * tolerance.sqrt(), "{seed} {tolerance}: {open}");
            before = off;
        }
        let scene = Scene::parse("a.toml", &text(&chosen(1e-3))).unwrap();
        assert_resumes(&scene, &[2, 17, 39], &format!("chosen-chain-{seed}"));
    }
}

#[test]
fn a_rod_from_a_swung_pin_has_its_place_its_tension_and_its_work() {
    for dimension in [2, 3] {
        let contact = "contact = { restitution = 0.5 }\n";
        let mut before = f64::INFINITY;
        for tolerance in [1e-4, 1e-5, 1e-6] {
            // Its size is that of the distance to what is far.
            let method = chosen(tolerance / 20.0);
            let run = run(&swung_beside_a_body(dimension, &method, contact, 0.05));
            let [off, tension] = off_the_swung_pendulum(&run, dimension);
            assert!(off < 20.0 * tolerance && off < before, "{dimension} {tolerance}: {off}");
            assert!(tension < 40.0 * tolerance.sqrt(), "{dimension} {tolerance}: {tension}");
            before = off;
            assert!(left(&run) < 50.0 * tolerance, "{dimension} {tolerance}: {}", left(&run));
            assert!(work(&run, "joints and pins that move rods").abs() > 0.1, "{:?}", run.works());
        }
        let text = swung_beside_a_body(dimension, &chosen(1e-5), contact, 0.01);
        let scene = Scene::parse("a.toml", &text).unwrap();
        assert_resumes(&scene, &[2, 70, 149], &format!("chosen-rod-{dimension}"));
    }
}

/// An arm on a pin, with no weight: what else holds it is told.
fn arm(tolerance: f64, velocities: &str, joint: &str, beside: &str) -> String {
    format!(
        "dimension = 2\nintegrator = \"error-controlled\"\ntolerance = {tolerance:e}\nstep = 0.05\nhorizon = 2\n\
         observables = [{{ angular_velocity = \"arm\" }}, {{ position = \"arm\" }}]\n\
         [[bodies]]\nname = \"arm\"\nmass = 3\nbox = [1, 0.2]\nposition = [0.5, 0]\n{velocities}\n\
         [[joints]]\nkind = \"pin\"\nbetween = [\"world\", \"arm\"]\nat = [0, 0]\n{joint}\n{beside}\n\
         [contact]\nwalls = [{{ normal = [0, 1], at = [0, -9] }}]\n"
    )
}

/// Of the arm about its pin.
const INERTIA: f64 = 3.0 * (1.0 + 0.04) / 12.0 + 3.0 * 0.25;

fn turned(run: &Run, k: usize) -> f64 {
    let x = run.observed(k);
    x[2].atan2(x[1])
}

#[test]
fn dry_friction_of_a_joint_brings_it_to_rest_and_a_limit_stops_it() {
    let moving = "velocity = [0, 0.75]\nangular_velocity = 1.5";
    for tolerance in [1e-3, 1e-4, 1e-5] {
        // It turns by w^2 I/2 f.
        let rubbed = run(&arm(tolerance, moving, "friction = 1.2", ""));
        let slow = 1.2 / INERTIA;
        let angle = |t: f64| {
            let t = t.min(1.5 / slow);
            1.5 * t - 0.5 * slow * t * t
        };
        for (k, &t) in rubbed.times().iter().enumerate() {
            let off = (turned(&rubbed, k) - angle(t)).abs();
            assert!(off < 4.0 * tolerance, "{tolerance}: {t}: {off}");
        }
        let energy = 0.5 * INERTIA * 1.5 * 1.5;
        assert!((work(&rubbed, "friction of joints") + energy).abs() < 20.0 * tolerance);
        assert!(left(&rubbed) < 20.0 * tolerance, "{}", left(&rubbed));
        let stopped = run(&arm(tolerance, moving, "limits = [-1, 0.9]", ""));
        for (k, &t) in stopped.times().iter().enumerate() {
            let off = (turned(&stopped, k) - (1.5 * t).min(0.9)).abs();
            assert!(off < 4.0 * tolerance, "{tolerance}: {t}: {off}");
        }
        let told = work(&stopped, "joints and their limits");
        assert!((told + energy).abs() < 20.0 * tolerance, "{told} {energy}");
        assert!(left(&stopped) < 20.0 * tolerance, "{}", left(&stopped));
    }
}

/// A motor that starts, swings and whose speed jumps: its turn is the integral of its speed.
#[test]
fn a_motor_with_a_speed_turns_as_it_is_told_and_its_work_is_that_of_the_arm() {
    let swing = "[[motors]]\nbetween = [\"world\", \"arm\"]\nspeed = { sine = 2, frequency = 0.6 }";
    let jump = "[[motors]]\nbetween = [\"world\", \"arm\"]\nspeed = { step = [0, 1.5], at = 0.63 }";
    let (w, swung): (f64, f64) = (TAU * 0.6, TAU * 0.6 * 2.0);
    for tolerance in [1e-3, 1e-4] {
        for (motor, exact) in [
            (
                swing,
                Box::new(move |t: f64| 2.0 / w * (1.0 - (w * t).cos())) as Box<dyn Fn(f64) -> f64>,
            ),
            (jump, Box::new(|t: f64| 1.5 * (t - 0.63).max(0.0))),
        ] {
            let run = run(&arm(tolerance, "", "", motor));
            for (k, &t) in run.times().iter().enumerate() {
                let off = (turned(&run, k) - exact(t)).sin().abs();
                assert!(off < 4.0 * tolerance, "{tolerance}: {t}: {off}");
            }
            let end = if motor == swing { 2.0 * swung.sin() } else { 1.5 };
            let energy = 0.5 * INERTIA * end * end;
            let told = work(&run, "joints and motors with a speed");
            assert!(
                (told - energy).abs() < 100.0 * tolerance,
                "{motor} {tolerance}: {told} {energy}"
            );
            assert!(left(&run) < 100.0 * tolerance, "{motor} {tolerance}: {}", left(&run));
        }
    }
    let scene = Scene::parse("a.toml", &arm(1e-3, "", "", jump)).unwrap();
    assert_resumes(&scene, &[2, 13, 39], "chosen-motor");
}

/// A pin of radius 0.1 that moves at 2 m/s hits what is at rest 0.5 m ahead: `(1 + e)` times its speed is given.
#[test]
fn a_round_pin_that_moves_gives_what_it_hits_its_speed() {
    let mass = 0.4;
    for (dimension, side) in [(2, "[0.2, 0.2]"), (3, "[0.2, 0.2, 0.2]")] {
        let at = |x: f64| format!("{:?}", &[x, 0.0, 0.0][..dimension]);
        for restitution in [1.0, 0.5, 0.0] {
            let text = format!(
                "dimension = {dimension}\nintegrator = {}\nstep = 0.01\nhorizon = 0.5\n\
                 observables = [{{ position = \"it\" }}, {{ velocity = \"it\" }}]\n\
                 bodies = [{{ name = \"it\", mass = {mass}, box = {side}, position = {} }}]\n\
                 particles = [{{ name = \"pusher\", radius = 0.1, pinned = true, position = {} }}]\n\
                 contact = {{ restitution = {restitution} }}\n\
                 motions = [{{ of = \"pusher\", shift = {}, strength = {{ ramp = [0, 1], to = 1 }} }}]\n",
                chosen(1e-5),
                at(0.6),
                at(0.0),
                at(2.0),
            );
            let run = run(&text);
            let given = (1.0 + restitution) * 2.0;
            for (k, &t) in run.times().iter().enumerate() {
                let exact = 0.6 + given * (t - 0.2).max(0.0);
                let off = (run.observed(k)[0] - exact).abs();
                assert!(off < 1e-4, "{restitution} {t}: {off}");
            }
            let energy = 0.5 * mass * given * given;
            // The pin gives its speed times the impulse, of which an impact without bounce keeps half.
            let told = work(&run, "pins that move and touch");
            assert!((told - mass * given * 2.0).abs() < 1e-6, "{told}");
            assert!(left(&run) < 1e-6 * energy, "{:?}", run.works());
            let pushed: f64 = run.contact_impulses().iter().map(|row| row.impulse[0]).sum();
            assert!((pushed - mass * given).abs() < 1e-9, "{pushed}");
        }
    }
}

/// A pin that swings to and fro pushes a block over a rough floor, which stays behind when the pin turns back.
fn pushed(method: &str, step: &str) -> String {
    format!(
        "dimension = 2\nintegrator = {method}\nstep = {step}\nhorizon = 1\n\
         uniform_gravity = {{ acceleration = [0, -10] }}\n\
         observables = [{{ position = \"block\" }}]\n\
         bodies = [{{ name = \"block\", mass = 2, box = [0.4, 0.4], position = [0.32, 0.2] }}]\n\
         particles = [{{ name = \"pusher\", radius = 0.1, pinned = true, position = [0, 0.2] }}]\n\
         motions = [{{ of = \"pusher\", shift = [0.3, 0], strength = {{ sine = 1, frequency = 0.5 }} }}]\n\
         [contact]\nfriction = 0.4\nwalls = [{{ normal = [0, 1], at = [0, 0] }}]\n"
    )
}

#[test]
fn a_swinging_pin_pushes_a_block_along_and_leaves_it_where_it_turns_back() {
    // It is hit after 0.02 m without a bounce; the pin brakes by less than the floor would.
    let exact = |t: f64| 0.3 + (0.3 * (0.5 * TAU * t.min(0.5)).sin()).max(0.02);
    let hit = (0.02_f64 / 0.3).asin() / (0.5 * TAU);
    let speed = 0.3 * 0.5 * TAU * (0.5 * TAU * hit).cos();
    // The pin gives its speed times the impulse, half of which is lost, and then what the floor takes, but for what it
    // gets back of the block's speed.
    let told = 2.0 * speed * speed + 2.0 * 10.0 * 0.4 * 0.28 - 0.5 * 2.0 * speed * speed;
    for tolerance in [1e-3, 1e-4, 1e-5] {
        let run = run(&pushed(&chosen(tolerance), "0.01"));
        for (k, &t) in run.times().iter().enumerate() {
            let off = (run.observed(k)[0] - exact(t)).abs();
            assert!(off < 10.0 * tolerance, "{tolerance}: {t}: {off}");
        }
        assert!(left(&run) < 100.0 * tolerance, "{tolerance}: {} {:?}", left(&run), run.works());
        let work = work(&run, "pins that move and touch");
        // Friction at the pin presses it on the floor for a moment when it is hit.
        assert!((work - told).abs() < 0.03, "{tolerance}: {work} {told}");
    }
    let scene = Scene::parse("a.toml", &pushed(&chosen(1e-3), "0.01")).unwrap();
    assert_resumes(&scene, &[2, 31, 99], "chosen-pusher");
}
