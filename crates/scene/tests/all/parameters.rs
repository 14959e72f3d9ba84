//! One scene is a family: parameters, arithmetic, and values from outside.

use stationary_scene::{Fault, Motion, Parameters, Scene, SceneError};

const FAMILY: &str = "\
title = '= not arithmetic'
dimension = 2
integrator = \"stormer-verlet\"
step = \"= T/100\"
horizon = \"= T\"
sample_every = \"= 2*n\"
particles = [
    { name = \"a\", mass = \"= 2*L\", position = [\"= L*cos(pi/3)\", \"= -height\"] },
]

[parameters]
L = 0.3
T = 2
n = 5
height = \"= L + 2*L\"
";

fn particle(scene: &Scene) -> (f64, [f64; 3]) {
    let Motion::Free { mass, .. } = scene.particles()[0].motion else { panic!("it is free") };
    (mass, scene.particles()[0].position)
}

#[test]
fn an_expression_is_the_number_that_it_comes_to() {
    let scene = Scene::parse("a.toml", FAMILY).unwrap();
    let (mass, [x, y, _]) = particle(&scene);
    assert_eq!(scene.title(), "= not arithmetic");
    assert_eq!((mass, y), (0.6, -(0.3 + 2.0 * 0.3)));
    assert_eq!(x, 0.3 * (std::f64::consts::PI / 3.0).cos());
    assert_eq!((scene.timing().steps(), scene.timing().sample_every()), (100, 10));
}

#[test]
fn a_value_from_outside_is_as_if_the_file_said_it() {
    for length in [0.4, 1e-7, 12.0] {
        let given = Parameters::new().with("L", length);
        let set = Scene::parse_with("a.toml", FAMILY, &given).unwrap();
        let said = FAMILY.replace("L = 0.3", &format!("L = {length:?}"));
        assert_eq!(set, Scene::parse("a.toml", &said).unwrap());
        assert_eq!(particle(&set).0, 2.0 * length);
    }
}

#[test]
fn what_comes_to_no_number_is_answered_at_its_place() {
    for (from, to, words) in [
        ("= 2*L", "= 2*mass_of_moon", "unknown parameter `mass_of_moon`"),
        ("= 2*L", "= 2*hieght", "unknown parameter `hieght`; did you mean `height`?"),
        ("= 2*L", "= 2*", "the expression ends where a number is expected"),
        ("= 2*L", "= 1/0", "the expression comes to inf; it must be finite"),
        ("= 2*L", "= ln(-1)", "the expression comes to NaN; it must be finite"),
    ] {
        let text = FAMILY.replacen(from, to, 1);
        let Err(SceneError::Invalid(error)) = Scene::parse("a.toml", &text) else {
            panic!("{to} is an expression")
        };
        assert_eq!(error.fault, Fault::Expression(words.to_owned()));
        let place = error.place.as_ref().expect("a place");
        assert!(text.lines().nth(place.line - 1).unwrap().contains(to), "{to}: {place:?}");
    }
    let text = FAMILY.replace("= L + 2*L", "= L + height");
    let error = Scene::parse("a.toml", &text).unwrap_err().to_string();
    assert!(error.contains("the parameter `height` depends on itself"), "{error}");
    let text = FAMILY.replace("L = 0.3", "L = \"long\"");
    let error = Scene::parse("a.toml", &text).unwrap_err().to_string();
    assert!(error.contains("a parameter is a number, or an expression"), "{error}");
}

#[test]
fn a_number_in_the_wrong_place_is_answered_as_if_it_were_written_out() {
    for (from, to) in [("= 2*L", "= -1"), ("= 2*n", "= 2.5")] {
        let expression = Scene::parse("a.toml", &FAMILY.replace(from, to)).unwrap_err().to_string();
        let written = FAMILY.replace(&format!("\"{from}\""), &to[2..]);
        let written = Scene::parse("a.toml", &written).unwrap_err().to_string();
        let first = |text: &str| text.lines().next().unwrap_or_default().to_owned();
        assert_eq!(first(&expression), first(&written));
    }
}

#[test]
fn a_value_for_a_parameter_that_is_not_there_is_refused() {
    let given = Parameters::new().with("heigth", 1.0);
    let error = Scene::parse_with("a.toml", FAMILY, &given).unwrap_err().to_string();
    assert!(error.starts_with("error: unknown parameter `heigth`"), "{error}");
    assert!(error.contains("height"), "{error}");
}
