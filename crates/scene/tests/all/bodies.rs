//! Scenes of rigid bodies: what they do, against closed forms.

use std::f64::consts::PI;

use nalgebra::Vector3;
use stationary_rigid::{Body, BodyMethod, FreeTop, LieGroup, Rotation};
use stationary_scene::problems::{HEAVY_TOP, THROWN_RACKET};
use stationary_scene::{AssemblyError, Fault, Observable, Run, RunError, Scene};

fn scene(text: &str) -> Scene {
    Scene::parse("scene.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

/// The largest drift of the energy, relative to its start.
fn drift(run: &Run) -> f64 {
    let energies = run.energies();
    energies.iter().map(|e| (e / energies[0] - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn the_shipped_racket_turns_over_when_the_closed_form_says() {
    let run = scene(THROWN_RACKET).run().unwrap();
    assert!(drift(&run) < 1e-5);
    let (body, w) = (&run.scene().bodies()[0], Vector3::new(0.001, 10.0, 0.0));
    let top = Body::new(body.mass, body.moments).unwrap();
    let top = FreeTop::new(top, Rotation::identity(), w).unwrap();
    let columns = run.headings();
    let second = columns.iter().position(|h| h == "angular velocity of racket y [rad/s]").unwrap();
    let middle = |sample: usize| run.observed(sample)[second];
    let mut flips = Vec::new();
    for sample in 1..run.times().len() {
        if middle(sample - 1) * middle(sample) < 0.0 {
            flips.push(run.times()[sample]);
        }
    }
    let period = top.period().unwrap();
    let expected: Vec<f64> = [0.25, 0.75].iter().map(|f| f * period).filter(|&t| t < 4.0).collect();
    assert_eq!(flips.len(), expected.len(), "{flips:?} {expected:?}");
    assert!(
        flips.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 0.02),
        "{flips:?} {expected:?}"
    );
    // A followed point is where the closed form turns it, carried along with the centre.
    let last = run.times().len() - 1;
    let t = run.times()[last];
    let point = Vector3::from(body.points[0]);
    let place = top.orientation(t).unwrap().rotate(&point) + Vector3::x() * (0.3 * t);
    let shown = Vector3::from_column_slice(&run.positions(last)[3..6]);
    assert!((place - shown).norm() < 2e-3, "{place} {shown}");
}

#[test]
fn the_shipped_top_nods_between_its_bounds_and_keeps_its_moment_about_the_vertical() {
    let scene = scene(HEAVY_TOP);
    let body = scene.bodies()[0].clone();
    // The velocity that the file leaves out is the one with which the tip stays.
    let spin = Rotation::exp(body.rotation.into()).rotate(&body.angular_velocity.into());
    let carried = spin.cross(&Vector3::from(body.position));
    assert!((Vector3::from(body.velocity) - carried).norm() < 1e-15);
    let run = scene.run().unwrap();
    assert!(drift(&run) < 1e-6, "{}", drift(&run));
    let vertical = |m: &[f64; 3]| m[2];
    let momenta = run.angular_momenta();
    assert!(momenta.iter().all(|m| (vertical(m) - vertical(&momenta[0])).abs() < 1e-13));
    let top = stationary_rigid::SymmetricTop {
        across: body.moments[0] + body.mass * 0.05 * 0.05,
        along: body.moments[2],
        weight_moment: body.mass * 9.81 * 0.05,
    };
    let rotation = Rotation::exp(body.rotation.into());
    let m = rotation.rotate_back(&Vector3::from(momenta[0]));
    let [low, high] = top.nutation(&rotation, &m);
    let tilts: Vec<f64> = (0..run.times().len())
        .map(|sample| {
            let centre = Vector3::from_column_slice(&run.positions(sample)[..3]);
            let tip = Vector3::from_column_slice(&run.positions(sample)[3..6]);
            assert!(tip.norm() < 1e-12, "the tip stays: {tip}");
            centre.x.hypot(centre.y).atan2(centre.z)
        })
        .collect();
    let least = tilts.iter().copied().fold(f64::INFINITY, f64::min);
    let most = tilts.iter().copied().fold(0.0, f64::max);
    assert!(
        (least - low).abs() < 1e-4 && (most - high).abs() < 1e-4,
        "{least} {most} {low} {high}"
    );
    assert!(high - low > 0.05);
}

/// A plate in the plane, pinned at a corner of its upper side and let go.
fn plate(step: f64) -> Scene {
    scene(&format!(
        r#"
        dimension = 2
        integrator = "stormer-verlet"
        step = {step}
        horizon = 1
        observables = [{{ angular_velocity = "plate" }}, {{ position = "plate" }}]
        uniform_gravity = {{ acceleration = [0, -9.81] }}
        bodies = [{{ name = "plate", mass = 2, box = [1e-6, 1], position = [0.5, 0], rotation = {} }}]
        joints = [{{ kind = "pin", between = ["world", "plate"], at = [0, 0] }}]
        "#,
        0.5 * PI
    ))
}

#[test]
fn a_pinned_plate_falls_as_a_physical_pendulum_with_order_two() {
    // At the level theta.^2 = 3 g/L sin(fall); over a quarter period the centre comes to hang.
    let speed = |run: &Run| -> Vec<f64> {
        (0..run.times().len())
            .map(|k| {
                let observed = run.observed(k);
                let fall = -observed[2];
                (observed[0] * observed[0] - 3.0 * 9.81 * fall / 0.5).abs()
            })
            .collect()
    };
    let worst = |step: f64| speed(&plate(step).run().unwrap()).into_iter().fold(0.0, f64::max);
    let (coarse, fine) = (worst(2e-3), worst(1e-3));
    assert!((coarse / fine).log2() > 1.9 && fine < 1e-3, "{coarse:e} {fine:e}");
}

const FOUR_BAR: &str = r#"
dimension = 3
integrator = "axis-rotations"
step = 0.001
horizon = 2
[[bodies]]
name = "crank"
mass = 1
box = [0.4, 0.05, 0.05]
position = [0.2, 0, 0]
rotation = [0, 0, 0]
angular_velocity = [0, 0, 5]
[[bodies]]
name = "coupler"
mass = 1
box = [0.6, 0.05, 0.05]
position = [0.7, 0, 0]
angular_velocity = [0, 0, -3.3333333333333335]
[[bodies]]
name = "pendant"
mass = 1
box = [0.05, 0.3, 0.05]
position = [1, -0.15, 0]
[[joints]]
kind = "hinge"
axis = [0, 0, 2]
between = ["world", "crank"]
at = [0, 0, 0]
[[joints]]
kind = "hinge"
axis = [0, 0, 1]
between = ["coupler", "crank"]
at = [0.4, 0, 0]
[[joints]]
kind = "fixed"
between = ["pendant", "coupler"]
at = [1, 0, 0]
"#;

#[test]
fn a_chain_of_hinges_starts_with_velocities_that_fit_and_stays_together() {
    // The pendant turns with the coupler, to which it is fixed.
    let text = FOUR_BAR.replace(
        "position = [1, -0.15, 0]",
        "position = [1, -0.15, 0]\nangular_velocity = [0, 0, -3.3333333333333335]",
    );
    let scene = scene(&text);
    let [crank, coupler, pendant] = [0, 1, 2].map(|k| scene.bodies()[k].velocity);
    assert!((crank[1] - 1.0).abs() < 1e-15 && (coupler[1] - 1.0).abs() < 1e-12);
    assert!(pendant[1].abs() < 1e-12 && (pendant[0] + 0.5).abs() < 1e-12, "{pendant:?}");
    let run = scene.run().unwrap();
    assert!(drift(&run) < 1e-4);
    let names: Vec<&str> = run.scene().particles().iter().map(|p| p.name.as_str()).collect();
    let at = |sample: usize, name: &str| {
        let k = names.iter().position(|n| *n == name).unwrap();
        Vector3::from_column_slice(&run.positions(sample)[3 * k..][..3])
    };
    // Corner 1 of a box is at +x; its edge's middle along y and z is the hinge.
    let end = |sample: usize, body: &str, side: usize| {
        let corners = [0, 2, 4, 6].map(|c| at(sample, &format!("{body}.{}", c + side)));
        corners.iter().sum::<Vector3<f64>>() / 4.0
    };
    for sample in (0..run.times().len()).step_by(100) {
        assert!((end(sample, "crank", 1) - end(sample, "coupler", 0)).norm() < 1e-11);
        assert!(end(sample, "crank", 0).norm() < 1e-11);
    }
}

#[test]
fn long_chains_and_closed_loops_are_held_too() {
    // Ten links hang level from the world by ball joints: thirty equations.
    let link = |k: usize| {
        let x = 0.2 * k as f64;
        let before = if k == 0 { "world".to_owned() } else { format!("link{}", k - 1) };
        format!(
            "[[bodies]]\nname = \"link{k}\"\nmass = 0.1\nbox = [0.2, 0.02, 0.03]\n\
             position = [{}, 0, 0]\n[[joints]]\nkind = \"ball\"\n\
             between = [\"{before}\", \"link{k}\"]\nat = [{x}, 0, 0]\n",
            x + 0.1
        )
    };
    let head = "dimension = 3\nintegrator = \"variational-rotation\"\nstep = 0.001\nhorizon = 0.5\n\
                [uniform_gravity]\nacceleration = [0, 0, -9.81]\n";
    let chain: String = (0..10).map(link).collect();
    let run = scene(&format!("{head}{chain}")).run().unwrap();
    let energies = run.energies();
    let most = run.kinetic_energies().iter().copied().fold(0.0, f64::max);
    assert!(most > 0.5 && energies.iter().all(|e| (e - energies[0]).abs() < 1e-4 * most));
    // A square of bars on four parallel hinges, of whose equations three are redundant.
    let bar = |name: &str, x: f64, y: f64, turn: f64, spin: f64| {
        format!(
            "[[bodies]]\nname = \"{name}\"\nmass = 1\nbox = [1, 0.1, 0.1]\n\
             position = [{x}, {y}, 0]\nrotation = [0, 0, {turn}]\n\
             angular_velocity = [0, 0, {spin}]\n"
        )
    };
    let hinge = |a: &str, b: &str, x: f64, y: f64| {
        format!(
            "[[joints]]\nkind = \"hinge\"\naxis = [0, 0, 1]\nbetween = [\"{a}\", \"{b}\"]\n\
             at = [{x}, {y}, 0]\n"
        )
    };
    let square = [
        bar("left", 0.0, 0.5, 0.5 * PI, 2.0),
        bar("top", 0.5, 1.0, 0.0, 0.0),
        bar("right", 1.0, 0.5, 0.5 * PI, 2.0),
        hinge("world", "left", 0.0, 0.0),
        hinge("left", "top", 0.0, 1.0),
        hinge("top", "right", 1.0, 1.0),
        hinge("right", "world", 1.0, 0.0),
    ];
    let head = "dimension = 3\nintegrator = \"axis-rotations\"\nstep = 0.002\nhorizon = 0.5\n\
                observables = [{ angular_velocity = \"top\" }, { angular_velocity = \"left\" }]\n";
    let run = scene(&format!("{head}{}", square.concat())).run().unwrap();
    // A parallelogram's top does not turn, and without weight its sides turn evenly.
    for sample in 0..run.times().len() {
        let observed = run.observed(sample);
        assert!(observed[..3].iter().all(|w| w.abs() < 1e-9), "{observed:?}");
        assert!((observed[5] - 2.0).abs() < 1e-4, "{observed:?}");
    }
}

#[test]
fn free_boxes_in_the_plane_and_in_space_fly_straight_and_turn_evenly() {
    for (dimension, method, turn) in
        [(2, "stormer-verlet", "3"), (3, "exact-rotation", "[0, 0, 3]")]
    {
        let zero = if dimension == 2 { "" } else { ", 0" };
        let third = if dimension == 2 { "" } else { ", 0.3" };
        let run = scene(&format!(
            "dimension = {dimension}\nintegrator = \"{method}\"\nstep = 0.01\nhorizon = 1\n\
             observables = [\"linear-momentum\", {{ velocity = \"card.0\" }}]\n\
             [[bodies]]\nname = \"card\"\nmass = 2\nbox = [0.4, 0.2{third}]\n\
             position = [0, 0{zero}]\nvelocity = [1, -2{zero}]\nangular_velocity = {turn}\n"
        ))
        .run()
        .unwrap();
        let last = run.times().len() - 1;
        let x = &run.positions(last)[..2];
        assert!((x[0] - 1.0).abs() < 1e-13 && (x[1] + 2.0).abs() < 1e-13);
        assert!((run.linear_momenta()[last][1] + 4.0).abs() < 1e-13);
        let inertia = 2.0 / 12.0 * (0.16 + 0.04);
        let spin = run.angular_momenta()[0][2];
        assert!((spin - 3.0 * inertia).abs() < 1e-14, "{spin}");
        let (s, c) = 3.0_f64.sin_cos();
        let corner = [x[0] - 0.2 * c + 0.1 * s, x[1] - 0.2 * s - 0.1 * c];
        let d = run.scene().dimension();
        let shown = &run.positions(last)[d..];
        assert!((shown[0] - corner[0]).abs() < 1e-12 && (shown[1] - corner[1]).abs() < 1e-12);
        assert_eq!(run.scene().freedoms(), if d == 2 { 3 } else { 6 });
        assert!(run.picture().contains(">bodies<"));
    }
}

#[test]
fn two_runs_of_bodies_have_the_same_bits_and_write_every_point() {
    let scene = scene(HEAVY_TOP).with_horizon(0.1).unwrap();
    let (one, two) = (scene.run().unwrap(), scene.run().unwrap());
    assert_eq!(one, two);
    let out = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("heavy-top");
    one.write(&out).unwrap();
    let trajectory = std::fs::read_to_string(out.join("trajectory.csv")).unwrap();
    assert!(trajectory.lines().any(|line| line.contains(",top.5,")));
}

#[test]
fn a_scene_of_bodies_makes_no_problem_of_particles_and_takes_methods_of_bodies() {
    let top = scene(HEAVY_TOP);
    assert!(matches!(top.problem(), Err(AssemblyError::Bodies)));
    let exact = top.clone().with_method(BodyMethod::ExactRotation).unwrap();
    assert_eq!(exact.stepping().to_string(), "exact-rotation");
    let game = top.clone().with_method(BodyMethod::RenormalizedEuler);
    assert!(matches!(game, Err(Fault::MethodOfJoints(_))));
    let flat = top.clone().with_method(stationary_integrators::Method::StormerVerlet);
    assert!(matches!(flat, Err(Fault::MethodOfAnother(_))));
    assert!(matches!(top.observables()[2], Observable::Position(2)));
}

#[test]
fn a_step_that_is_too_long_for_a_joint_stops_the_run_and_keeps_what_was_computed() {
    let top = scene(HEAVY_TOP).with_step(0.1).unwrap();
    let error = top.run().unwrap_err();
    let RunError::Stopped(stop) = &error else { panic!("{error}") };
    assert_eq!(stop.step, 1);
    assert_eq!(error.partial().unwrap().times(), [0.0]);
    assert!(error.to_string().starts_with("step 1, from t = 0 s: "), "{error}");
}
