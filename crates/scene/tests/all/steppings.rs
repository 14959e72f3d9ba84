//! The ways to step a scene: methods that choose their own steps, drag, and rods.

use stationary_scene::{Fault, RunError, Scene, SceneError, StepFailure};

/// A bob that hangs on a rod of length 1 and is pushed.
fn rod_pendulum(integrator: &str, step: f64, speed: f64, strength: &str) -> Scene {
    let text = format!(
        r#"
        dimension = 2
        integrator = "{integrator}"
        step = {step}
        horizon = 2
        observables = ["energy", {{ position = "bob" }}, {{ tension = ["bob", "hook"] }}]
        uniform_gravity = {{ acceleration = [0, -9.81] }}
        particles = [
            {{ name = "hook", position = [0, 0], pinned = true }},
            {{ name = "bob", position = [0, -1], mass = 0.5, velocity = [{speed}, 0] }},
        ]
        rods = [{{ between = ["hook", "bob"]{strength} }}]
        "#
    );
    Scene::parse("pendulum.toml", &text).unwrap()
}

/// A ball thrown through air that holds it back, `m v. = m g - c v`.
fn thrown(integrator: &str, extra: &str, step: f64) -> Scene {
    let text = format!(
        r#"
        dimension = 2
        integrator = "{integrator}"
        {extra}
        step = {step}
        horizon = 2
        observables = [{{ position = "ball" }}]
        uniform_gravity = {{ acceleration = [0, -9.81] }}
        drag = {{ coefficient = 0.3 }}
        particles = [{{ name = "ball", position = [0, 0], mass = 0.5, velocity = [4, 7] }}]
        "#
    );
    Scene::parse("ball.toml", &text).unwrap()
}

/// Where the ball is at a time: `v = u + (v0 - u) exp(-c t/m)` about the final velocity u.
fn ball(t: f64) -> [f64; 2] {
    let (rate, fall): (f64, f64) = (0.3 / 0.5, -9.81 * 0.5 / 0.3);
    let fade = -(-rate * t).exp_m1() / rate;
    [4.0 * fade, fall * t + (7.0 - fall) * fade]
}

fn largest_error(scene: &Scene) -> f64 {
    let run = scene.run().unwrap();
    let error = |(sample, &t): (usize, &f64)| {
        let (x, truth) = (run.observed(sample), ball(t));
        (x[0] - truth[0]).hypot(x[1] - truth[1])
    };
    run.times().iter().enumerate().map(error).fold(0.0, f64::max)
}

#[test]
fn methods_that_choose_their_steps_need_no_drag() {
    for integrator in ["dormand-prince-853", "radau-iia-5", "bdf-5"] {
        let text = format!(
            "dimension = 1\nintegrator = \"{integrator}\"\ntolerance = 1e-9\nstep = 0.1\nhorizon = 2\n\
             uniform_gravity = {{ acceleration = [-9.81] }}\n\
             particles = [{{ name = \"a\", mass = 2, position = [0], velocity = [3] }}]"
        );
        let run = Scene::parse("fall", &text).unwrap().run().unwrap();
        let x = run.positions(20)[0];
        assert!((x - (3.0 * 2.0 - 0.5 * 9.81 * 4.0)).abs() < 1e-6, "{integrator}: {x}");
    }
}

#[test]
fn drag_slows_the_ball_as_the_closed_form_says() {
    for integrator in ["newmark", "generalized-alpha"] {
        let errors = [0.04, 0.02].map(|step| largest_error(&thrown(integrator, "", step)));
        let order = (errors[0] / errors[1]).log2();
        assert!((order - 2.0).abs() < 0.1, "{integrator}: {order} of {errors:?}");
    }
}

#[test]
fn a_method_that_chooses_its_steps_answers_at_every_moment_asked_for() {
    for integrator in ["dormand-prince-853", "radau-iia-5", "bdf-5"] {
        let at = |tolerance| {
            largest_error(&thrown(integrator, &format!("tolerance = {tolerance}"), 0.01))
        };
        let (coarse, fine) = (at("1e-4"), at("1e-9"));
        assert!(coarse < 1e-2 && fine < 1e-6, "{integrator}: {coarse:e}, {fine:e}");
    }
    let scene = thrown("dormand-prince-853", "tolerance = 1e-9", 0.01);
    let run = scene.run().unwrap();
    assert_eq!(run.times().len(), 201);
    assert!(run.cost().differentials < 200, "it steps where it must, not where it is read off");
}

#[test]
fn a_hanging_bob_pulls_with_its_weight_and_a_turning_one_with_more() {
    let hanging = rod_pendulum("rattle", 0.01, 0.0, "").run().unwrap();
    assert!((hanging.observed(1)[3] - 0.5 * 9.81).abs() < 1e-12);
    let turning = rod_pendulum("rattle", 0.001, 7.0, "").run().unwrap();
    // The mean over the first step: at the bottom m (g + v^2/L), falling from there.
    assert!((turning.observed(1)[3] - 0.5 * (9.81 + 49.0)).abs() < 1e-2);
}

#[test]
fn every_way_to_hold_a_rod_holds_it() {
    for integrator in ["rattle", "constrained-hamilton", "stormer-verlet", "runge-kutta-4"] {
        let run = rod_pendulum(integrator, 0.002, 3.0, "").run().unwrap();
        for sample in 0..run.times().len() {
            let x = run.observed(sample);
            assert!((x[1].hypot(x[2]) - 1.0).abs() < 1e-12, "{integrator} at {sample}");
        }
    }
}

#[test]
fn a_rod_breaks_at_its_strength_and_the_bob_flies_on() {
    let run = rod_pendulum("rattle", 0.001, 4.0, ", strength = 12").run().unwrap();
    let [broken] = run.broken() else { panic!("{:?}", run.broken()) };
    assert_eq!((broken.rod, broken.time), (0, 0.001));
    let whole = rod_pendulum("rattle", 0.001, 4.0, ", strength = 13").run().unwrap();
    assert!(whole.broken().is_empty(), "at most m (g + v^2/L) = 12.9 N are carried");
    let end = run.observed(run.times().len() - 1);
    assert!((end[1] - 4.0 * 2.0).abs() < 1e-2 && end[3] == 0.0, "{end:?}");
}

#[test]
fn a_start_that_moves_against_its_rod_is_refused_before_the_first_step() {
    let text = r#"
        dimension = 2
        integrator = "rattle"
        step = 0.01
        horizon = 1
        particles = [
            { name = "hook", position = [0, 0], pinned = true },
            { name = "bob", position = [0, -1], mass = 0.5, velocity = [0, 1] },
        ]
        rods = [{ between = ["hook", "bob"] }]
    "#;
    let error = Scene::parse("a.toml", text).unwrap().run().unwrap_err();
    assert!(matches!(error, RunError::Assembly(_)), "{error}");
    assert!(error.to_string().contains("against the rod from `hook` to `bob`"), "{error}");
}

#[test]
fn a_rod_that_cannot_be_held_is_named() {
    let error = rod_pendulum("rattle", 1.0, 7.0, "").run().unwrap_err();
    let RunError::Interrupted(interruption) = error else { panic!("{error}") };
    assert!(matches!(interruption.source, StepFailure::Constraint(_)));
    let words = interruption.to_string();
    assert!(words.contains("the rod from `hook` to `bob` cannot be held"), "{words}");
}

#[test]
fn a_method_put_in_later_is_asked_as_well() {
    let scene = thrown("newmark", "", 0.01);
    // Kicks are of order 2.
    let error = scene.with_method(stationary_integrators::Method::RungeKutta4).unwrap_err();
    assert!(error.to_string().starts_with("`runge-kutta-4` cannot step drag"));
}

#[test]
fn combinations_that_nothing_can_step_are_faults() {
    let fault = |integrator: &str, rest: &str| {
        let text = format!(
            "dimension = 2\nintegrator = \"{integrator}\"\nstep = 0.1\nhorizon = 1\n{rest}\n\
             particles = [{{ name = \"a\", position = [0, 0], mass = 1 }}, \
             {{ name = \"b\", position = [1, 0], mass = 1 }}]\n"
        );
        match Scene::parse("a.toml", &text) {
            Err(SceneError::Invalid(diagnostic)) => diagnostic.fault.clone(),
            other => panic!("{other:?}"),
        }
    };
    let cannot = |integrator: &str, rest: &str| {
        assert!(matches!(fault(integrator, rest), Fault::MethodCannot { .. }), "{integrator}");
    };
    const ROD: &str = "rods = [{ between = [\"a\", \"b\"] }]";
    const STRONG: &str = "rods = [{ between = [\"a\", \"b\"], strength = 3 }]";
    const DRAG: &str = "drag = { coefficient = 1 }";
    cannot("runge-kutta-4", DRAG);
    cannot("rattle", "");
    cannot("dormand-prince-853", &format!("tolerance = 1e-6\n{ROD}"));
    cannot("newmark", &format!("{DRAG}\n{ROD}"));
    cannot("stormer-verlet", STRONG);
    assert_eq!(fault("radau-iia-5", ""), Fault::NoTolerance);
    assert_eq!(fault("rattle", &format!("tolerance = 1e-6\n{ROD}")), Fault::EqualSteps);
    for value in ["0", "nan", "-1", "1", "1e-15"] {
        let fault = fault("radau-iia-5", &format!("tolerance = {value}"));
        assert!(matches!(fault, Fault::Tolerance { .. }), "{fault}");
    }
    let rods = |rods: &str| fault("rattle", &format!("rods = [{rods}]"));
    assert_eq!(rods("{ between = [\"a\", \"a\"] }"), Fault::RodLoop("a".to_owned()));
    assert!(matches!(
        rods("{ between = [\"a\", \"b\"] }, { between = [\"b\", \"a\"] }"),
        Fault::RepeatedRod { .. }
    ));
    let strength = rods("{ between = [\"a\", \"b\"], strength = 0 }");
    assert!(matches!(strength, Fault::NotPositive { .. }), "{strength}");
    let tension =
        fault("rattle", &format!("{ROD}\nobservables = [{{ tension = [\"a\", \"a\"] }}]"));
    assert_eq!(tension, Fault::NoRod);
    let drag = fault("newmark", "drag = { coefficient = -1 }");
    assert!(matches!(drag, Fault::NotPositive { .. }), "{drag}");
}
