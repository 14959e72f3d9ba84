//! Scenes of heat: what is kept, what falls, and what their file may not say.

use stationary_scene::Scene;

const PLATE: &str = r#"
dimension = 2
integrator = "implicit-euler"
step = 0.01
horizon = 5
sample_every = 10
observables = ["heat", { temperature = "plate.middle" }]

[heat]
name = "plate"
shape = { kind = "rectangle", size = [1, 0.5], cells = [10, 4] }
diffusivity = 1
held = [{ part = "left", temperature = 0 }, { part = "right", temperature = 20 }]
marks = { middle = [0.5, 0.25] }
"#;

fn scene(text: &str) -> Scene {
    Scene::parse("heat.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_plate_between_two_temperatures_comes_to_the_line_between_them() {
    for method in ["implicit-euler", "crank-nicolson"] {
        let run = scene(&PLATE.replace("implicit-euler", method)).run().unwrap();
        let last = run.times().len() - 1;
        for (particle, f) in run.scene().particles().iter().zip(run.temperatures(last)) {
            assert!((f - 20.0 * particle.position[0]).abs() < 1e-9, "{method}: {f}");
        }
        assert!((run.observed(last)[1] - 10.0).abs() < 1e-9);
    }
}

#[test]
fn heat_on_a_closed_surface_stays_and_its_extremes_draw_together() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/warm-sphere.toml");
    let run = Scene::read(path).unwrap().with_horizon(0.3).unwrap().run().unwrap();
    let heat = |sample: usize| run.observed(sample)[0];
    let extremes = |sample: usize| {
        let f = run.temperatures(sample);
        (f.iter().copied().fold(f64::MAX, f64::min), f.iter().copied().fold(f64::MIN, f64::max))
    };
    for sample in 1..run.times().len() {
        assert!((heat(sample) / heat(0) - 1.0).abs() < 1e-12);
        assert!(
            run.observed(sample)[1] < run.observed(sample - 1)[1],
            "the Dirichlet energy falls"
        );
        let (before, now) = (extremes(sample - 1), extremes(sample));
        assert!(now.0 >= before.0 - 1e-14 && now.1 <= before.1 + 1e-14, "the maximum principle");
    }
}

#[test]
fn explicit_heat_beyond_its_border_is_an_error_that_keeps_what_there_was() {
    let text =
        PLATE.replace("implicit-euler", "explicit-euler").replace("horizon = 5", "horizon = 20");
    let error = scene(&text).run().expect_err("it explodes");
    assert!(error.partial().is_some_and(|run| run.times().len() > 1), "{error}");
    assert!(error.to_string().contains("step"), "{error}");
}

#[test]
fn heat_that_cannot_be_is_refused_where_it_says_so() {
    let refused = |from: &str, to: &str, message: &str| {
        let error = Scene::parse("a.toml", &PLATE.replace(from, to)).expect_err(to).to_string();
        assert!(error.contains(message), "{error}\n\nexpected: {message}");
    };
    refused("diffusivity = 1", "diffusivity = 0", "the diffusivity is 0");
    refused("\"implicit-euler\"", "\"stormer-verlet\"", "unknown integrator");
    refused("\"heat\"", "\"energy\"", "this observable is not available in heat scenes");
    refused("part = \"left\"", "part = \"all\"", "the temperature of every vertex is held");
    refused(
        "[heat]",
        "[[particles]]\nname = \"a\"\nmass = 1\nposition = [0, 0]\n[heat]",
        "cannot be combined",
    );
    refused(
        "held = ",
        "warm = [{ at = [9, 9], radius = 1, temperature = 1 }]\nheld = ",
        "no vertex of the shape is within",
    );
    refused(
        "temperature = \"plate.middle\"",
        "position = \"plate.middle\"",
        "not available in heat scenes",
    );
}

#[test]
fn the_modes_of_a_plate_are_what_small_steps_come_to() {
    let coarse = PLATE.replace("[10, 4]", "[6, 3]").replace("horizon = 5", "horizon = 0.2");
    let steps = coarse.replace("implicit-euler", "crank-nicolson").replace("0.01", "0.0001");
    let truth = scene(&steps.replace("sample_every = 10", "sample_every = 1000")).run().unwrap();
    let by_modes = |count: usize| {
        let method = format!("\"linear-modes\"\nmodes = {count}");
        let run = scene(&coarse.replace("\"implicit-euler\"", &method)).run().unwrap();
        assert!(run.cost().hessians > 0, "the search for modes is counted");
        let [f, g] = [run.temperatures(2), truth.temperatures(2)];
        let off = f.iter().zip(g).map(|(f, g)| (f - g).abs()).fold(0.0, f64::max);
        assert_eq!((run.times()[2], f.len()), (0.2, g.len()));
        off
    };
    // 7 x 4 vertices, 8 of them held.
    assert!(by_modes(20) < 1e-5, "{:e}", by_modes(20));
    assert!(by_modes(1) > 10.0 * by_modes(20) && by_modes(1) < 0.5, "{:e}", by_modes(1));
}

#[test]
fn a_plate_has_no_more_modes_than_freedoms() {
    let text = PLATE.replace("\"implicit-euler\"", "\"linear-modes\"\nmodes = 200");
    let error = scene(&text).run().expect_err("200 modes").to_string();
    assert!(error.contains("200"), "{error}");
}
