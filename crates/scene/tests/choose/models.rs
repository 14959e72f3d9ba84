//! What can be made of a scene, and what of it is chosen.

use stationary_choose::{At, MeasuredRuns, answer};
use stationary_scene::choose::{Model, Question, Simplification, emitted};
use stationary_scene::{Run, Scene};

use super::{LONG, asked, bounded_runs, ladder};

/// A beam of rubber in flight.
const BEAM: &str = r#"
dimension = 2
integrator = "stormer-verlet"
step = 0.0005
horizon = 0.5
observables = [{ position = "beam.end" }]
uniform_gravity = { acceleration = [0, -9.81] }

[[solids]]
name = "beam"
shape = { kind = "rectangle", size = [1, 0.2], cells = [8, 2] }
thickness = 0.1
density = 1000
material = "neo-hookean"
young = 1e6
poisson = 0.3
velocity = [1, 3]
marks = { end = [1, 0.2] }
"#;

const PLATE: &str = r#"
dimension = 2
integrator = "implicit-euler"
step = 0.01
horizon = 0.2

[heat]
name = "plate"
shape = { kind = "rectangle", size = [1, 0.5], cells = [16, 8] }
diffusivity = 1
held = [{ part = "left", temperature = 0 }, { part = "right", temperature = 20 }]
marks = { middle = [0.5, 0.25] }
"#;

/// A ball between two walls.
const BALL: &str = r#"
dimension = 1
integrator = "stormer-verlet"
step = 0.01
horizon = 3
observables = ["energy"]
particles = [{ name = "ball", mass = 2, radius = 0.5, position = [1.75], velocity = [1] }]

[contact]
restitution = 1
walls = [{ normal = [1], at = [0] }, { normal = [-1], at = [3] }]
"#;

/// A box above a floor, which moves upwards and along it.
fn thrown(height: f64, up: f64) -> String {
    format!(
        r#"
dimension = 3
integrator = "variational-rotation"
step = 0.01
horizon = 1
uniform_gravity = {{ acceleration = [0, 0, -9.81] }}

[[bodies]]
name = "box"
mass = 2
box = [0.4, 0.3, 0.2]
position = [0, 0, {height:?}]
velocity = [0.5, 0, {up:?}]

[contact]
friction = 0.3
restitution = 0.5
walls = [{{ normal = [0, 0, 1], at = [0, 0, 0] }}]
"#
    )
}

#[test]
fn impacts_at_their_instant_are_a_model_unless_something_rests_or_slides_from_the_start() {
    let is_model = |height: f64, up: f64| {
        let runs = bounded_runs(&thrown(height, up), "position=box");
        runs.ladder().families.iter().any(|family| family.name.starts_with("event-driven"))
    };
    assert!(!is_model(0.1, 0.0));
    // It leaves the floor, or comes to it later.
    assert!(is_model(0.1, 2.0) && is_model(0.5, 0.0) && is_model(0.11, -1.0));
}

#[test]
fn contact_in_steps_chosen_by_error_is_a_family_of_tolerances() {
    // It slides from the start, and falls.
    for (height, up) in [(0.1, 0.0), (0.5, 0.0)] {
        let mut runs = bounded_runs(&thrown(height, up), "position=box");
        let named = |family: &stationary_choose::Family| family.name == "error-controlled";
        let family = runs.ladder().families.iter().position(named).unwrap();
        let works = [1, 3, 4].map(|rung| {
            let run = runs.measure(At { family, rung });
            assert!(run.whole().is_some(), "{:?}", run.end);
            run.work
        });
        assert!(works.is_sorted() && works[0] < works[2], "{works:?}");
    }
}

fn models(text: &str) -> Vec<Model> {
    Model::all("a.toml", text, &Scene::parse("a.toml", text).unwrap())
}

fn words(text: &str) -> Vec<String> {
    models(text).into_iter().map(|model| model.words).collect()
}

fn model(text: &str, simplification: Simplification) -> Model {
    models(text).into_iter().find(|model| model.simplification == simplification).unwrap()
}

#[test]
fn a_body_is_seen_as_elements_ever_coarser_as_rigid_and_as_a_point() {
    let simpler = ["with 4 x 1 quadratic cells", "as a rigid body", "as a point mass"];
    assert_eq!(words(BEAM), [["", "with 4 x 1 cells"].as_slice(), &simpler].concat());
    let pieces: Vec<u64> = models(BEAM).iter().map(|model| model.pieces).collect();
    // A triangle with six nodes and three points counts as 4.1 of those with three and one.
    assert_eq!(pieces, [32, 8, 33, 1, 1]);
    let runs = bounded_runs(BEAM, "position=beam.end");
    for name in ["linear-modes", "linear-modes with 4 x 1 cells", "runge-kutta-4 as a rigid body"] {
        assert!(runs.ladder().families.iter().any(|family| family.name == name), "{name}");
    }
}

#[test]
fn a_mesh_without_the_observed_place_is_no_model() {
    // Halved once more there is no vertex in the middle of the end, but a node of an edge.
    let text = BEAM.replace("end = [1, 0.2]", "end = [1, 0.1]");
    let simpler = ["with 4 x 1 quadratic cells", "as a rigid body", "as a point mass"];
    assert_eq!(words(&text), [[""].as_slice(), &simpler].concat());
}

#[test]
fn a_body_of_quadratic_elements_is_seen_as_one_of_linear_ones_too() {
    let text = BEAM.replace("thickness = 0.1", "thickness = 0.1\nelement = \"quadratic\"");
    let expected = ["", "with 4 x 1 cells", "with 8 x 2 linear cells", "with 4 x 1 linear cells"];
    assert_eq!(words(&text)[..4], expected);
    let pieces: Vec<u64> = models(&text).iter().map(|model| model.pieces).collect();
    assert_eq!(pieces, [131, 33, 32, 8, 1, 1]);
    // A sheet that bends has no other elements.
    let sheet = BEAM
        .replace("dimension = 2", "dimension = 3")
        .replace("thickness = 0.1", "thickness = 0.1\nbending = 1\nelement = \"linear\"")
        .replace("neo-hookean", "saint-venant-kirchhoff")
        .replace("[0, -9.81]", "[0, -9.81, 0]")
        .replace("[1, 3]", "[1, 3, 0]")
        .replace("[1, 0.2] }", "[1, 0.2, 0] }");
    let words = words(&sheet);
    assert!(words.iter().all(|words| !words.contains("quadratic")), "{words:?}");
    assert!(words.contains(&"with 4 x 1 cells".to_owned()), "{words:?}");
}

#[test]
fn a_struck_beam_has_the_momenta_of_its_rigid_body() {
    let strike = "struck = { at = [1, 0], radius = 0.05, velocity = [0, 40] }";
    let text = BEAM.replace("velocity = [1, 3]", strike);
    let start = |run: Run| (run.linear_momenta()[0], run.angular_momenta()[0]);
    let elastic = start(Scene::parse("a.toml", &text).unwrap().run().unwrap());
    let rigid = start(model(&text, Simplification::Rigid).scene.run().unwrap());
    assert!(elastic.0[1] > 1.0);
    for (a, b) in elastic.0.iter().chain(&elastic.1).zip(rigid.0.iter().chain(&rigid.1)) {
        assert!((a - b).abs() < 1e-12 * elastic.0[1], "{elastic:?} {rigid:?}");
    }
}

#[test]
fn a_block_in_space_has_the_momenta_of_its_rigid_body() {
    let text = r#"
dimension = 3
integrator = "stormer-verlet"
step = 0.001
horizon = 0.002
[[solids]]
name = "block"
shape = { kind = "box", size = [1, 0.2, 0.4], cells = [4, 2, 2], across = [0.6, 0.8, 0] }
density = 1000
young = 1e6
struck = { at = [0.6, 0.8, 0], radius = 0.3, velocity = [0, 1, 5] }
"#;
    let start = |run: Run| [run.linear_momenta()[0], run.angular_momenta()[0]].concat();
    let elastic = start(Scene::parse("a.toml", text).unwrap().run().unwrap());
    let rigid = start(model(text, Simplification::Rigid).scene.run().unwrap());
    let size = elastic.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    for (a, b) in elastic.iter().zip(&rigid) {
        assert!((a - b).abs() < 1e-12 * size, "{elastic:?} {rigid:?}");
    }
}

#[test]
fn a_beam_that_only_falls_is_chosen_to_be_a_point_mass() {
    let ladder = ladder(BEAM, &Question::new("position=beam.end"));
    let answer = answer(&mut MeasuredRuns::new(ladder, LONG).unwrap(), 1e-2).unwrap();
    let row = answer.choice().unwrap_or_else(|| panic!("{answer}"));
    assert!(row.method.ends_with(" as a point mass"), "{answer}");
    let emitted = emitted("a.toml", BEAM, &answer, ladder).unwrap().unwrap();
    assert!(
        emitted.contains("# Chosen by measurement") && !emitted.contains("solids"),
        "{emitted}"
    );
    let run = Scene::parse("b.toml", &emitted).unwrap().run().unwrap();
    let [x, y] = run.observed(run.times().len() - 1).try_into().unwrap();
    assert!((x - 1.5_f64).abs() < 1e-9 && (y - (0.2 + 1.5 - 9.81 * 0.125)).abs() < 1e-9);
}

#[test]
fn a_body_held_at_its_end_is_no_point_mass() {
    let text = BEAM.replace("velocity = [1, 3]", "pinned = [\"left\"]");
    let simpler = ["with 4 x 1 cells", "with 4 x 1 quadratic cells", "as a rigid body"];
    assert_eq!(words(&text), [[""].as_slice(), &simpler].concat());
    // What is clamped and rigid stays.
    let run = model(&text, Simplification::Rigid).scene.run().unwrap();
    let way = run.observed(run.times().len() - 1).iter().zip(run.observed(0));
    assert!(way.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-12);
}

#[test]
fn a_stiff_beam_that_hangs_through_a_little_is_moved_by_a_few_modes() {
    let text = BEAM.replace("velocity = [1, 3]", "pinned = [\"left\"]").replace("1e6", "1e8");
    let (answer, _) = asked(&text, "position=beam.end", 5e-2);
    let row = answer.choice().unwrap_or_else(|| panic!("{answer}"));
    assert!(row.method.starts_with("linear-modes"), "{answer}");
    assert!(row.setting.starts_with("modes = "), "{answer}");
}

#[test]
fn heat_is_stepped_or_summed_on_meshes_ever_coarser() {
    let (answer, runs) = asked(PLATE, "temperature=plate.middle", 1e-2);
    let names: Vec<&str> = runs.ladder().families.iter().map(|f| f.name.as_str()).collect();
    for name in ["explicit-euler", "implicit-euler", "crank-nicolson", "linear-modes"] {
        for model in ["", " with 8 x 4 cells", " with 2 x 1 cells"] {
            // The coarsest has no vertex in the middle.
            let there = !model.contains("2 x 1");
            assert_eq!(names.contains(&format!("{name}{model}").as_str()), there, "{names:?}");
        }
    }
    assert!(answer.choice().is_some(), "{answer}");
    assert!(answer.choice().unwrap().method.contains("cells"), "{answer}");
}

#[test]
fn what_touches_is_tried_at_other_moments_by_other_laws_and_by_springs() {
    let words = words(BALL);
    for word in ["by `after-overlap`", "by `velocity-filter`", "by `jacobi`", "by `inelastic`"] {
        assert!(words.iter().any(|own| own == word), "{words:?}");
    }
    assert_eq!(words.iter().filter(|word| word.starts_with("by springs")).count(), 3);
    let (answer, _) = asked(BALL, "position=ball", 1e-3);
    assert!(answer.choice().is_some(), "{answer}");
}

#[test]
fn joints_are_the_coordinates_where_that_is_cheaper() {
    let text = r#"
        dimension = 3
        integrator = "variational-rotation"
        step = 0.01
        horizon = 2
        uniform_gravity = { acceleration = [0, 0, -9.81] }
        bodies = [
            { name = "upper", mass = 1, moments = [0.1, 0.1, 0.01], position = [0.5, 0, 0], points = [[0.5, 0, 0]] },
            { name = "lower", mass = 1, moments = [0.1, 0.1, 0.01], position = [1, 0, -0.5] },
        ]
        joints = [
            { kind = "hinge", between = ["world", "upper"], at = [0, 0, 0], axis = [0, 1, 0] },
            { kind = "ball", between = ["upper", "lower"], at = [1, 0, 0] },
        ]
    "#;
    for tolerance in [1e-2, 1e-6] {
        let (answer, _) = asked(text, "position=lower", tolerance);
        let row = answer.choice().unwrap_or_else(|| panic!("{answer}"));
        assert!(row.method.starts_with("dormand-prince"), "{answer}");
        let held = answer.rows.iter().filter(|other| other.method.ends_with("rotation"));
        let whole = held.filter(|other| other.moment == row.moment).map(|other| other.work);
        assert!(whole.min().is_none_or(|work| work > 5 * row.work), "{answer}");
    }
    // Beside what touches bodies keep their own.
    let touching =
        format!("contact = {{}}\n{}", text.replace("moments = [0.1, 0.1, 0.01]", "ball = 0.1"));
    let runs = bounded_runs(&touching, "position=lower");
    let names: Vec<&str> =
        runs.ladder().families.iter().map(|family| family.name.as_str()).collect();
    assert!(!names.contains(&"joint-coordinates"), "{names:?}");
}

#[test]
fn a_stiff_spring_that_does_not_swing_may_be_a_rod() {
    let pendulum = |at: &str, stiffness: f64| {
        format!(
            r#"
            dimension = 2
            integrator = "stormer-verlet"
            step = 1e-4
            horizon = 5
            uniform_gravity = {{ acceleration = [0, -9.81] }}
            particles = [
                {{ name = "nail", position = [0, 0], pinned = true }},
                {{ name = "bob", position = {at}, mass = 1 }},
            ]
            springs = [{{ between = ["nail", "bob"], stiffness = {stiffness}, rest_length = 1 }}]
            "#
        )
    };
    let (answer, runs) = asked(&pendulum("[1, 0]", 1e7), "position=bob", 1e-2);
    let row = answer.choice().unwrap_or_else(|| panic!("{answer}"));
    assert!(row.method.ends_with(" with a rod for a spring"), "{answer}");
    assert!(
        runs.ladder().families.iter().any(|family| family.name == "rattle with a rod for a spring")
    );
    // One that starts stretched swings, and one that is soft is no rod.
    for text in [pendulum("[1.01, 0]", 1e7), pendulum("[1, 0]", 100.0)] {
        let runs = bounded_runs(&text, "position=bob");
        assert!(runs.ladder().families.iter().all(|family| !family.name.contains("rod")));
    }
}
