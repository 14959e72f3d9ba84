//! Bodies, walls and fixed balls that touch in a way of their own, or pass through each other.

use stationary_scene::{Run, Scene, SceneError};

const HEAD: &str = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.01\nhorizon = 0.5\n\
                    [uniform_gravity]\nacceleration = [0, -9.81]\n";

fn parsed(text: &str) -> Result<Scene, SceneError> {
    Scene::parse("pairs.toml", text)
}

fn run(text: &str) -> Run {
    let scene = parsed(text).unwrap_or_else(|error| panic!("{error}"));
    scene.run().unwrap_or_else(|error| panic!("{error}"))
}

fn body(name: &str, at: [f64; 2], velocity: [f64; 2]) -> String {
    format!(
        "[[bodies]]\nname = \"{name}\"\nmass = 1\nbox = [1, 0.2]\nposition = {at:?}\nvelocity = {velocity:?}\n"
    )
}

fn floor(pairs: &str) -> String {
    format!(
        "[contact]\nfriction = 0.5\nwalls = [{{ name = \"floor\", normal = [0, 1], at = [0, 0] }}]\n\
         pairs = [{pairs}]\n"
    )
}

/// Place and velocity of a body at the end.
fn end(run: &Run, name: &str) -> ([f64; 2], [f64; 2]) {
    let index = run.scene().bodies().iter().position(|body| body.name == name).unwrap();
    let last = run.times().len() - 1;
    let place = &run.positions(last)[2 * index..];
    let velocity = run.velocities(last)[index];
    ([place[0], place[1]], [velocity[0], velocity[1]])
}

#[test]
fn a_slippery_pair_keeps_its_speed_where_all_others_are_braked() {
    let two = body("sledge", [0.0, 0.1], [4.0, 0.0]) + &body("crate", [-3.0, 0.1], [4.0, 0.0]);
    let run =
        run(&(HEAD.to_owned() + &two + &floor("{ of = [\"floor\", \"sledge\"], friction = 0 }")));
    let (place, velocity) = end(&run, "sledge");
    assert!((velocity[0] - 4.0).abs() < 1e-12 && (place[0] - 2.0).abs() < 1e-12, "{place:?}");
    let (_, braked) = end(&run, "crate");
    assert!((braked[0] - (4.0 - 0.5 * 9.81 * 0.5)).abs() < 1e-9, "{braked:?}");
}

#[test]
fn a_pair_gives_back_as_much_as_its_own_restitution_says() {
    let two = body("soft", [0.0, 0.1], [0.0, -2.0]) + &body("hard", [3.0, 0.1], [0.0, -2.0]);
    let pairs = "{ of = [\"hard\", \"floor\"], restitution = 0.75 }";
    let text = HEAD.replace("horizon = 0.5", "horizon = 0.01").replace("-9.81", "0");
    let run = run(&(text + &two + &floor(pairs)));
    let [(_, soft), (_, hard)] = ["soft", "hard"].map(|name| end(&run, name));
    assert!(soft[1].abs() < 1e-12 && (hard[1] - 1.5).abs() < 1e-12, "{soft:?} {hard:?}");
}

/// v^2 = v0^2 - 2 a x with a = g rolling / (R (1 + c)), c = I / (m R^2): the ball rolls without slip.
#[test]
fn a_disc_comes_to_rest_by_rolling_friction_alone() {
    let disc = "[[bodies]]\nname = \"disc\"\nmass = 1\nball = 0.5\nposition = [0, 0.5]\n\
                velocity = [1, 0]\nangular_velocity = -2\n";
    let pairs = "{ of = [\"disc\", \"floor\"], friction = 0.5, rolling = 0.02 }";
    let run = run(&(HEAD.to_owned() + disc + &floor(pairs)));
    let braking = 9.81 * 0.02 / (0.5 * 1.5);
    let (_, velocity) = end(&run, "disc");
    assert!((velocity[0] - (1.0 - 0.5 * braking)).abs() < 1e-6, "{velocity:?} {braking}");
}

#[test]
fn what_does_not_meet_passes_through_and_may_start_inside() {
    let two = body("left", [0.0, 5.0], [3.0, 0.0]) + &body("right", [0.4, 5.05], [-3.0, 0.0]);
    let text = HEAD.replace("-9.81", "0") + &two;
    let run = run(&(text.clone() + &floor("{ of = [\"left\", \"right\"], meet = false }")));
    let [(left, _), (right, _)] = ["left", "right"].map(|name| end(&run, name));
    assert!((left[0] - 1.5).abs() < 1e-12 && (right[0] + 1.1).abs() < 1e-12, "{left:?} {right:?}");
    let meeting = parsed(&(text + &floor(""))).unwrap();
    assert!(meeting.run().is_err(), "they overlap at the start");
}

/// A disc on a slope, and a box with a corner down on the floor: where they touch in closed form.
#[test]
fn what_touches_at_the_start_is_moved_straight_until_it_does() {
    let scene = parsed(
        "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.01\nhorizon = 0.01\n\
         [[bodies]]\nname = \"wheel\"\nmass = 1\nball = 0.3\nposition = [1, 7]\n\
         [[bodies]]\nname = \"die\"\nmass = 1\nbox = [1, 1]\nposition = [-40, 0.1]\n\
         rotation = 0.7853981633974483\n\
         [[bodies]]\nname = \"lid\"\nmass = 1\nbox = [1, 0.2]\nposition = [-20, 9]\n\
         [[bodies]]\nname = \"base\"\nmass = 1\nbox = [1, 0.2]\nposition = [-20, 2]\n\
         [contact]\nwalls = [{ name = \"slope\", normal = [-0.6, 0.8], at = [0, 0] },\n\
         { name = \"floor\", normal = [0, 1], at = [0, -20] }]\n\
         touching = [[\"wheel\", \"slope\"], [\"die\", \"floor\"], [\"lid\", \"base\"]]\n",
    )
    .unwrap_or_else(|error| panic!("{error}"));
    let at = |k: usize| scene.bodies()[k].position;
    // 0.3 above the slope, on the normal through where it stood: n.x was 5.
    let [x, y, _] = at(0);
    assert!((0.8 * y - 0.6 * x - 0.3).abs() < 1e-15 && (x - (1.0 + 0.6 * 4.7)).abs() < 1e-14);
    assert!((at(1)[0] + 40.0).abs() < 1e-15 && (at(1)[1] + 20.0 - 0.5_f64.sqrt()).abs() < 1e-14);
    assert!((at(2)[0] + 20.0).abs() < 1e-15 && (at(2)[1] - 2.2).abs() < 1e-14);
    // Its points went with it.
    let corner = scene.particles().iter().find(|particle| particle.name == "lid.0").unwrap();
    assert!((corner.position[1] - 2.2).abs() < 0.1 + 1e-14, "{corner:?}");
    assert!(scene.run().is_ok());
}

#[test]
fn impulses_call_a_wall_by_its_name() {
    let run = run(&(HEAD.to_owned() + &body("crate", [0.0, 0.1], [0.0, 0.0]) + &floor("")));
    let rows = run.contact_impulses();
    assert!(!rows.is_empty());
    assert!(rows.iter().all(|row| row.between[0].name(run.scene()) == "floor"));
}

#[test]
fn a_pair_that_cannot_be_is_refused_where_it_says_so() {
    let two = body("sledge", [0.0, 0.1], [0.0, 0.0]) + &body("crate", [3.0, 0.1], [0.0, 0.0]);
    let refused = |pairs: &str, message: &str| {
        let Err(SceneError::Invalid(diagnostic)) =
            parsed(&(HEAD.to_owned() + &two + &floor(pairs)))
        else {
            panic!("{pairs} is right")
        };
        assert_eq!(diagnostic.fault.to_string(), message, "{pairs}");
        assert!(diagnostic.place.is_some(), "{pairs}");
    };
    let never = "these two never touch: a pair has two different things, and one of them moves";
    for (pairs, message) in [
        ("{ of = [\"floor\", \"sled\"], friction = 0 }", "unknown body, wall or ball `sled`"),
        ("{ of = [\"floor\", \"floor\"], friction = 0 }", never),
        ("{ of = [\"crate\", \"crate\"], friction = 0 }", never),
        (
            "{ of = [\"floor\"], friction = 0 }",
            "a pair is two bodies, or a body and a wall or ball that has a name, not 1",
        ),
        (
            "{ of = [\"floor\", \"crate\"] }",
            "a pair has a `restitution`, `friction`, `rolling` or `torsion` of its own, or `meet = false`",
        ),
        (
            "{ of = [\"floor\", \"crate\"], friction = -1 }",
            "the friction is -1; it must not be negative",
        ),
        (
            "{ of = [\"floor\", \"crate\"], restitution = 1.5 }",
            "the restitution is 1.5; it must be between 0 and 1",
        ),
        (
            "{ of = [\"floor\", \"crate\"], meet = false, friction = 1 }",
            "what passes through each other has no restitution and no friction",
        ),
        (
            "{ of = [\"floor\", \"crate\"], friction = 1 }, { of = [\"crate\", \"floor\"], friction = 2 }",
            "there is already a pair of these two",
        ),
    ] {
        refused(pairs, message);
    }
    let fixed = floor("") + "touching = [[\"floor\", \"crate\"]]\n";
    let Err(error) = parsed(&(HEAD.to_owned() + &two + &fixed)) else { panic!("the floor moved") };
    assert!(error.to_string().contains("the first of the two is moved until they touch"));
    let twice = floor("").replace("\"floor\"", "\"crate\"");
    let Err(error) = parsed(&(HEAD.to_owned() + &two + &twice)) else { panic!("two crates") };
    assert!(error.to_string().contains("there is already a body, a wall or a ball called `crate`"));
}
