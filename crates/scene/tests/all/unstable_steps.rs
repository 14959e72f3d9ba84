//! A step beyond what a method is stable at is told with the one that is stable.

use std::fs;
use std::path::Path;

use stationary_integrators::Method;
use stationary_scene::{RunError, Scene};

const SPRING: &str = r#"
    dimension = 1
    integrator = "stormer-verlet"
    step = 0.001
    horizon = 100
    particles = [
        { name = "hook", position = [0], pinned = true },
        { name = "bob", position = [1], mass = 0.2, velocity = [0.1] },
    ]
    springs = [{ between = ["hook", "bob"], stiffness = 50 }]
"#;

fn scene(text: &str) -> Scene {
    Scene::parse("a.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn the_stable_step_of_a_spring_is_two_over_its_frequency() {
    let omega = (50.0_f64 / 0.2).sqrt();
    let stable = |method: Method| scene(SPRING).with_method(method).unwrap().stable_step().unwrap();
    for method in [Method::StormerVerlet, Method::SymplecticEulerKickDrift] {
        let step = stable(method).unwrap();
        assert!((step * omega / 2.0 - 1.0).abs() < 1e-12, "{step}");
    }
    assert_eq!(stable(Method::ExplicitEuler), Some(0.0));
    assert_eq!(stable(Method::ImplicitMidpoint), None);
    let fourth = stable(Method::RungeKutta4).unwrap();
    assert!((fourth * omega / 8.0_f64.sqrt() - 1.0).abs() < 1e-3, "{fourth}");
}

#[test]
fn a_chain_is_unstable_just_beyond_the_step_that_is_told_and_stable_just_below() {
    let chain = r#"
        dimension = 1
        integrator = "stormer-verlet"
        step = 1e-4
        horizon = 1
        [[solids]]
        name = "bar"
        shape = { kind = "bar", size = [1], cells = [20] }
        section = 0.01
        density = 1000
        material = "saint-venant-kirchhoff"
        young = 1e6
        poisson = 0.3
        velocity = [0]
        struck = { at = [0], radius = 0.01, velocity = [1e-9] }
        pinned = ["right"]
    "#;
    let stable = scene(chain).stable_step().unwrap().unwrap();
    let size = |factor: f64| {
        let step = factor * stable;
        let text = chain.replace("step = 1e-4", &format!("step = {step:e}"));
        let run =
            scene(&text.replace("horizon = 1\n", &format!("horizon = {:e}\n", 600.0 * step))).run();
        let Ok(run) = run else { return f64::INFINITY };
        let (last, n) = (run.times().len() - 1, run.positions(0).len());
        (0..n).map(|k| (run.positions(last)[k] - run.positions(0)[k]).abs()).fold(0.0, f64::max)
    };
    assert!(size(0.99) < 1e-9 && size(1.01) > 1e-4, "{:e} {:e}", size(0.99), size(1.01));
}

#[test]
fn a_run_that_explodes_says_which_step_is_stable() {
    let plate = r#"
        dimension = 2
        integrator = "explicit-euler"
        step = 0.01
        horizon = 20
        [heat]
        name = "plate"
        shape = { kind = "rectangle", size = [1, 0.5], cells = [10, 4] }
        diffusivity = 1
        held = [{ part = "left", temperature = 0 }, { part = "right", temperature = 20 }]
    "#;
    let heated = scene(plate);
    let error = heated.run().unwrap_err();
    let RunError::Stopped(stop) = &error else { panic!("{error}") };
    let stable = stop.unstable.unwrap().stable;
    let told = error.to_string();
    assert!(told.contains("the step 0.01 is unstable: `explicit-euler` is stable up to"), "{told}");
    // The step that is told is one at which it runs.
    let word = told.split("up to a step of ").nth(1).unwrap().split(' ').next().unwrap();
    let taken: f64 = word.parse().unwrap();
    assert!(taken <= stable && taken > 0.9 * stable, "{taken} {stable}");
    let steps = (2.0 / taken).floor();
    let text = plate.replace("step = 0.01", &format!("step = {word}"));
    let text = text.replace("horizon = 20", &format!("horizon = {:e}", steps * taken));
    assert!(scene(&text).run().is_ok());

    let elastic =
        SPRING.replace("step = 0.001", "step = 0.5").replace("horizon = 100", "horizon = 5000");
    let elastic = elastic.replace("particles = [", "[[solids]]\nname = \"bar\"\nshape = { kind = \"bar\", \
        size = [1], cells = [4] }\nsection = 1\ndensity = 1\nyoung = 100\npoisson = 0.3\nvelocity = [0.1]\n\
        pinned = [\"left\"]\nmarks = {}\n#");
    let elastic = elastic.split('#').next().unwrap().to_owned();
    let told = scene(&elastic).run().unwrap_err().to_string();
    assert!(told.contains("the step 0.5 is unstable: `stormer-verlet` is stable up to"), "{told}");
}

#[test]
fn no_shipped_scene_has_an_unstable_step() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut known = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        if file.extension().is_some_and(|extension| extension == "toml") {
            let scene = Scene::read(&file).unwrap();
            assert_eq!(scene.unstable_step(), None, "{}", file.display());
            known += usize::from(scene.stable_step().unwrap().is_some());
        }
    }
    assert!(known >= 4, "{known}");
}
