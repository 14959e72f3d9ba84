//! Every value of every shipped scene replaced by one of the wrong kind: what is said speaks of the file,
//! at a place in it, and never of how it is read.

use std::fs;
use std::path::{Path, PathBuf};

use stationary_scene::{Scene, SceneError};
use toml::Value;

/// What no shipped scene says.
const MORE: [&str; 5] = [
    r#"
        dimension = 2
        integrator = "dormand-prince-853"
        tolerance = 1e-6
        step = 0.1
        horizon = 1
        units = { length = "cm", time = "ms", mass = "g" }
        drag = { coefficient = 0.1 }
        frame = { angular_velocity = 0.1 }
        newtonian_gravity = { constant = 1 }
        observables = [{ distance = ["a", "b"] }, { velocity = "a" }, "linear-momentum"]
        particles = [
            { name = "a", mass = 1, position = [0, 0], momentum = [0, 1] },
            { name = "b", mass = 1, position = [1, 0], velocity = [0, 1] },
        ]
    "#,
    r#"
        dimension = 2
        integrator = "linear-modes"
        modes = 2
        step = 0.1
        horizon = 1
        nets = [{ name = "n", rows = 3, columns = 3, spacing = 0.1, origin = [0, 0], across = [1, 0],
                  down = [0, -1], particle_mass = 1, stiffness = 9, strain = "green", pinned = ["top"] }]
    "#,
    r#"
        dimension = 2
        integrator = "rattle"
        step = 0.01
        horizon = 0.1
        observables = [{ tension = ["a", "b"] }]
        particles = [
            { name = "a", position = [0, 0], pinned = true },
            { name = "b", mass = 1, position = [1, 0], radius = 0.1 },
        ]
        rods = [{ between = ["a", "b"], strength = 1000 }]
    "#,
    r#"
        dimension = 2
        integrator = "stormer-verlet"
        step = 0.01
        horizon = 0.1
        observables = [{ angular_velocity = "b" }]
        bodies = [
            { name = "a", mass = 1, moments = 0.1, position = [0, 0], points = [[0.1, 0]], rotation = 0.2 },
            { name = "b", mass = 1, ball = 0.1, position = [1, 0], velocity = [0, 0], angular_velocity = 0 },
        ]
        joints = [{ kind = "pin", between = ["a", "b"], at = [0.5, 0] }]
    "#,
    r#"
        dimension = 3
        integrator = "variational-rotation"
        step = 0.01
        horizon = 0.1
        bodies = [
            { name = "a", mass = 1, capsule = { length = 1, radius = 0.1 }, position = [0, 0, 0] },
            { name = "b", mass = 1, cylinder = { length = 1, radius = 0.1 }, position = [1, 0, 0] },
            { name = "c", mass = 1, cone = { height = 1, radius = 0.1 }, position = [2, 0, 0] },
            { name = "d", mass = 1, ellipsoid = [0.1, 0.2, 0.3], position = [3, 0, 0] },
            { name = "e", mass = 1, hull = [[4, 0, 0], [5, 0, 0], [4, 1, 0], [4, 0, 1]] },
            { name = "f", parts = [{ mass = 1, ball = 0.1, at = [6, 0, 0] },
                                   { mass = 1, box = [1, 1, 1], at = [7, 0, 0], rotation = [0, 0, 1] }] },
        ]
        joints = [{ kind = "slider", between = ["a", "b"], at = [0.5, 0, 0], axis = [1, 0, 0],
                    limits = [-0.1, 0.2], friction = 1 }]
    "#,
];

/// Every shipped scene and some more, each with its file.
fn texts() -> Vec<(PathBuf, String)> {
    let read = |file: PathBuf| (file.clone(), fs::read_to_string(file).unwrap());
    let more = MORE.iter().enumerate();
    let more = more.map(|(k, text)| (PathBuf::from(format!("more-{k}.toml")), (*text).to_owned()));
    scenes().into_iter().map(read).chain(more).collect()
}

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    files
}

/// A key or a place in a list.
#[derive(Clone, Debug)]
enum Step {
    Key(String),
    Place(usize),
}

/// Every value, of a list no more than the first and the last.
fn paths(value: &Value, here: &[Step], all: &mut Vec<Vec<Step>>) {
    if !here.is_empty() {
        all.push(here.to_vec());
    }
    let mut go = |step: Step, value: &Value| paths(value, &[here, &[step]].concat(), all);
    match value {
        Value::Table(table) => {
            table.iter().for_each(|(key, value)| go(Step::Key(key.clone()), value));
        }
        Value::Array(list) if !list.is_empty() => {
            go(Step::Place(0), &list[0]);
            if list.len() > 1 {
                go(Step::Place(list.len() - 1), &list[list.len() - 1]);
            }
        }
        _ => {}
    }
}

fn at<'a>(mut value: &'a mut Value, path: &[Step]) -> &'a mut Value {
    for step in path {
        value = match step {
            Step::Key(key) => value.get_mut(key).unwrap(),
            Step::Place(place) => value.get_mut(place).unwrap(),
        };
    }
    value
}

/// What a reader of a scene's file need not know.
const INTERNAL: [&str; 24] = [
    "map",
    "i128",
    "u128",
    "i64",
    "u64",
    "f64",
    "usize",
    "struct",
    "enum",
    "variant",
    "sequence",
    "tuple",
    "visitor",
    "serde",
    "toml_private",
    "deserialize",
    "invalid type",
    "invalid value",
    "integer",
    "floating point",
    "boolean",
    "string",
    "Option",
    "NaN()",
];

/// The words of the error, and that they are for whoever wrote the file.
fn check(file: &Path, text: &str, what: &str) -> bool {
    let Err(error) = Scene::parse_at(file, text) else { return true };
    let words = error.to_string();
    let SceneError::Invalid(diagnostic) = &error else { panic!("{what}: {words}") };
    assert!(diagnostic.place.is_some(), "{what}: no place\n{words}");
    // The lines below quote the file.
    let said = words.lines().next().unwrap_or_default();
    for internal in INTERNAL {
        let letters = |c: char| !c.is_alphanumeric() && c != '_';
        let mut found = said.split(letters).any(|word| word == internal);
        found |= internal.contains(' ') && said.contains(internal);
        assert!(!found, "{what}: `{internal}` in\n{words}");
    }
    assert_eq!(words.matches("error:").count(), 1, "{what}\n{words}");
    false
}

#[test]
fn no_wrong_value_is_answered_in_the_words_of_the_parser() {
    /// Stands for a value that no table of values holds.
    const MARK: &str = "a value stands here";
    let wrong = [
        "\"word\"",
        "\"\"",
        "{ a = 1 }",
        "{}",
        "[]",
        "[[1]]",
        "[{}]",
        "[\"a\", \"b\", \"c\"]",
        "123456789012345678901234567890",
        "-170141183460469231731687303715884105729",
        "99999999999999999999999999999999999999999999",
        "9223372036854775807",
        "-1",
        "0",
        "nan",
        "-inf",
        "1e300",
        "true",
        "1979-05-27",
    ];
    let (mut refused, mut taken) = (0, 0);
    for (file, text) in texts() {
        Scene::parse_at(&file, &text).unwrap_or_else(|error| panic!("{error}"));
        let whole: Value = toml::from_str::<toml::Table>(&text).map(Value::Table).unwrap();
        let mut all = Vec::new();
        paths(&whole, &[], &mut all);
        for path in &all {
            let mut changed = whole.clone();
            *at(&mut changed, path) = Value::String(MARK.to_owned());
            let marked = toml::to_string(&changed).unwrap();
            for value in wrong {
                let text = marked.replace(&format!("\"{MARK}\""), value);
                let what = format!("{}: {path:?} = {value}", file.display());
                if check(&file, &text, &what) { taken += 1 } else { refused += 1 }
            }
        }
    }
    assert!(refused > 10 * taken && refused > 5_000, "{refused} refused, {taken} taken");
}

#[test]
fn a_date_is_told_as_a_date() {
    let text = |step: &str, gravity: &str, horizon: &str| {
        format!(
            "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = {step}\nhorizon = {horizon}\n\
             uniform_gravity = {gravity}\nparticles = [{{ name = \"a\", mass = 1, position = [0, 0] }}]\n"
        )
    };
    let gravity = "{ acceleration = [0, -1] }";
    for horizon in ["1", "\"= 1\""] {
        for date in ["1979-05-27", "07:32:00", "1979-05-27T07:32:00Z", "1979-05-27 07:32:00.5"] {
            let check = |text: &str, place: &str| {
                let said = Scene::parse("a.toml", text).unwrap_err().to_string();
                assert!(
                    said.starts_with(&format!("error: `{date}` is a date or a time")),
                    "{said}"
                );
                assert!(said.contains(&format!("\n --> a.toml:{place}\n")), "{said}");
            };
            check(&text(date, gravity, horizon), "3:8");
            check(&text("0.1", date, horizon), "5:19");
            check(&text("0.1", &format!("{{ acceleration = {date} }}"), horizon), "5:36");
        }
    }
}

#[test]
fn no_missing_and_no_superfluous_key_is_answered_in_the_words_of_the_parser() {
    for (file, text) in texts() {
        let whole: Value = toml::from_str::<toml::Table>(&text).map(Value::Table).unwrap();
        let mut all = Vec::new();
        paths(&whole, &[], &mut all);
        for path in &all {
            let [before @ .., Step::Key(key)] = path.as_slice() else { continue };
            let mut changed = whole.clone();
            let table = at(&mut changed, before).as_table_mut().unwrap();
            let value = table.remove(key).unwrap();
            let what = format!("{}: {path:?}", file.display());
            check(&file, &toml::to_string(&changed).unwrap(), &what);
            let table = at(&mut changed, before).as_table_mut().unwrap();
            table.insert(format!("{key}s"), value);
            check(&file, &toml::to_string(&changed).unwrap(), &what);
        }
    }
}

/// Neither is told that its ends are in one place, nor without a place in the file.
#[test]
fn places_whose_squares_overflow_are_told_where_they_are_measured() {
    let head = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.01\nhorizon = 0.1\n";
    let spring = "particles = [{ name = \"a\", mass = 1, position = [0, 0] },\n\
        { name = \"b\", mass = 1, position = [1e160, 0] }]\n\
        springs = [{ between = [\"a\", \"b\"], stiffness = 1 }]\n";
    let joint = "bodies = [{ name = \"b\", mass = 1, ball = 1, position = [0, 0] }]\n\n\
        joints = [{ kind = \"pin\", between = [\"world\", \"b\"], at = [1e160, 0] }]\n";
    for (text, expected) in [
        (spring, "the square of the spring's length is inf; it must be finite\n --> a.toml:7:24"),
        (
            joint,
            "the square of the distance from the joint to its body is inf; it must be finite\n --> a.toml:7:58",
        ),
    ] {
        let said = Scene::parse("a.toml", &(head.to_owned() + text)).unwrap_err().to_string();
        assert!(said.contains(expected), "{said}");
    }
}

/// However many digits it has: 64 bits with a sign, without, and more.
#[test]
fn a_whole_number_is_a_number_of_any_size() {
    let text = |y: &str, count: &str| {
        format!(
            "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.01\nhorizon = 0.1\nsample_every = {count}\n\
             particles = [{{ name = \"a\", mass = 1, position = [0, {y}] }}]\n"
        )
    };
    for y in [
        "9223372036854775807",
        "9223372036854775808",
        "0xFFFFFFFFFFFFFFFF",
        "1_0000000000_0000000000",
    ] {
        let scene = Scene::parse("a.toml", &text(y, "1")).unwrap_or_else(|error| panic!("{error}"));
        assert!(scene.particles()[0].position[1] > 9e18, "{y}");
    }
    for (y, count, expected) in [
        (
            "0",
            "9223372036854775808",
            "expected a whole number up to 9223372036854775807, got 9223372036854775808",
        ),
        ("0x", "1", "a whole number without digits or with too many"),
    ] {
        let said = Scene::parse("a.toml", &text(y, count)).unwrap_err().to_string();
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn a_number_far_from_one_is_told_in_few_digits() {
    let text = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.01\nhorizon = 0.1\n\
        particles = [{ name = \"a\", mass = 1, position = [0, 0] }]\n";
    for (from, to, expected) in [
        ("mass = 1", "mass = 5e-324", "the mass is 5e-324; it must be positive and finite"),
        ("mass = 1", "mass = -1e300", "the mass is -1e300; it must be positive and finite"),
        ("mass = 1", "mass = 0", "the mass is 0; it must be positive and finite"),
        ("horizon = 0.1", "horizon = 1e-300", "the horizon is 1e-298 steps of 0.01; it must be"),
    ] {
        let said = Scene::parse("a.toml", &text.replace(from, to)).unwrap_err().to_string();
        assert!(said.contains(expected), "{said}");
    }
}
