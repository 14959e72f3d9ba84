//! Whatever is compiled, a scene of it runs, and a word of anything else is answered by its feature.
//!
//! Holds under every choice of features:
//! ```text
//! cargo test -p stationary-scene --no-default-features --features rigid --test features
//! ```

use stationary_scene::{Built, Fault, Scene, SceneError, problems::OUTER_SOLAR_SYSTEM};

/// A word, the feature that it needs, whether that is on, and a scene that says it.
struct Case {
    word: &'static str,
    feature: &'static str,
    on: bool,
    text: String,
}

fn case(word: &'static str, feature: &'static str, on: bool, lines: &str) -> Case {
    let text = format!("step = 0.01\nhorizon = 0.02\n{lines}");
    Case { word, feature, on, text }
}

const TWO: &str = "dimension = 2\nparticles = [\n\
                   { name = \"a\", mass = 1, position = [0, 0], radius = 0.1 },\n\
                   { name = \"b\", mass = 1, position = [1, 0], radius = 0.1 },\n]\n";

fn two(lines: &str) -> String {
    format!("integrator = \"stormer-verlet\"\n{TWO}{lines}")
}

fn sheet(lines: &str) -> String {
    format!(
        "dimension = 2\n{lines}\n\
         shape = {{ kind = \"rectangle\", size = [1, 1], cells = [2, 2] }}\n"
    )
}

fn cases() -> Vec<Case> {
    let elasticity = cfg!(feature = "elasticity");
    let (constraints, rigid) = (cfg!(feature = "constraints"), cfg!(feature = "rigid"));
    let (modal, laplacian) = (cfg!(feature = "modal"), cfg!(feature = "laplacian"));
    let contact = cfg!(feature = "contact");
    let solid = sheet(
        "integrator = \"stormer-verlet\"\n[[solids]]\nname = \"s\"\nthickness = 1\ndensity = 1\n\
         young = 10",
    );
    let heat = sheet(
        "integrator = \"implicit-euler\"\n[heat]\nname = \"h\"\ndiffusivity = 1\n\
         warm = [{ at = [0, 0], radius = 0.1, temperature = 1 }]",
    );
    let body = "dimension = 2\nintegrator = \"stormer-verlet\"\n\
                bodies = [{ name = \"a\", mass = 1, box = [1, 1], position = [0, 2] }]\n";
    let spring = two("springs = [{ between = [\"a\", \"b\"], stiffness = 1 }]\n");
    let net = two("nets = [{ name = \"n\", rows = 2, columns = 2, spacing = 1, origin = [0, 3],\n\
         particle_mass = 1, stiffness = 1 }]\n");
    let modes = format!("{TWO}integrator = \"linear-modes\"\nmodes = 1\n")
        + "springs = [{ between = [\"a\", \"b\"], stiffness = 1 }]\n";
    let mut all = vec![
        case("springs", "elasticity", elasticity, &spring),
        case("nets", "elasticity", elasticity, &net),
        case("solids", "elasticity", elasticity, &solid),
        case("rods", "constraints", constraints, &two("rods = [{ between = [\"a\", \"b\"] }]\n")),
        case("bodies", "rigid", rigid, body),
        case("contact", "contact", contact, &two("[contact]\nrestitution = 1\n")),
        case("heat", "laplacian", laplacian, &heat),
    ];
    if elasticity {
        all.push(case("linear-modes", "modal", modal, &modes));
        all.push(case("hung", "modal", modal, &(solid + "hung = [\"left\"]\n")));
    }
    if rigid {
        let joint = "joints = [{ kind = \"pin\", between = [\"world\", \"a\"], at = [0, 0] }]\n";
        all.push(case("joints", "constraints", constraints, &format!("{body}{joint}")));
        if constraints {
            let bound = |word: &str| {
                let said = format!("at = [0, 0], {word} }}]");
                format!("{body}{}", joint.replace("at = [0, 0] }]", &said))
            };
            let limits = bound("limits = [-1, 1]");
            all.push(case("limits", "contact", contact, &limits));
            all.push(case("friction", "contact", contact, &bound("friction = 1")));
        }
    }
    all
}

#[test]
fn what_is_compiled_runs_and_any_other_word_is_told_its_feature() {
    for Case { word, feature, on, text } in cases() {
        match (on, Scene::parse("a.toml", &text)) {
            (true, Ok(scene)) => assert_eq!(scene.run().unwrap().times().len(), 3, "{word}"),
            (false, Err(SceneError::Invalid(error))) => {
                assert_eq!(error.fault, Fault::NotCompiled { word, feature });
                let line = error.place.as_ref().expect("a place").line;
                let said = text.lines().nth(line - 1).unwrap();
                let above = text.lines().nth(line - 2).unwrap();
                assert!(said.contains(word) || above.contains(word), "{word}: {said}");
            }
            (_, other) => panic!("{word}: {other:?}"),
        }
    }
}

#[test]
fn the_answer_names_the_word_the_place_and_the_feature() {
    let text = "dimension = 3\nintegrator = \"linear-modes\"\nmodes = 1\nstep = 1\nhorizon = 1\n\
                particles = [{ name = \"a\", mass = 1, position = [0, 0, 0] }]\n";
    if cfg!(feature = "modal") {
        return;
    }
    let expected = "\
error: `linear-modes` needs the cargo feature `modal` of stationary-scene, which is not compiled
 --> a.toml:2:14
  |
2 | integrator = \"linear-modes\"
  |              ^^^^^^^^^^^^^^";
    assert_eq!(Scene::parse("a.toml", text).unwrap_err().to_string(), expected);
}

#[test]
fn the_planets_need_no_feature_and_have_the_same_digits_with_all_of_them() {
    let scene = Scene::parse("planets", OUTER_SOLAR_SYSTEM).unwrap();
    let run = scene.with_horizon(2_000.0).unwrap().run().unwrap();
    assert_eq!(run.built(), Built::default());
    insta::assert_snapshot!(run.summary(), @r"
    The outer solar system
    stormer-verlet, 200 of 200 steps of 10 day, to 2000 day

    particles  pinned  springs  rods  elements  freedoms  differentials  hessians
    6          0       0        0     0         18        201            0

    invariant                               at the start  at the end  largest drift  relative to
    energy [solar mass au^2/day^2]          -3.2155e-8    -3.2155e-8  7.6e-6         the largest kinetic energy
    linear momentum [solar mass au/day]     6.7592e-6     6.7592e-6   <1e-11         sum |p|
    angular momentum [solar mass au^2/day]  6.0783e-5     6.0783e-5   <1e-11         sum |q| |p|

    observable                                at the start  at the end  least      largest
    energy [solar mass au^2/day^2]            -3.215e-8     -3.215e-8   -3.215e-8  -3.215e-8
    linear momentum x [solar mass au/day]     6.184e-6      6.184e-6    6.184e-6   6.184e-6
    linear momentum y [solar mass au/day]     -2.438e-6     -2.438e-6   -2.438e-6  -2.438e-6
    linear momentum z [solar mass au/day]     -1.225e-6     -1.225e-6   -1.225e-6  -1.225e-6
    angular momentum x [solar mass au^2/day]  1.596e-6      1.596e-6    1.596e-6   1.596e-6
    angular momentum y [solar mass au^2/day]  -2.370e-5     -2.370e-5   -2.370e-5  -2.370e-5
    angular momentum z [solar mass au^2/day]  5.595e-5      5.595e-5    5.595e-5   5.595e-5
    distance sun to jupiter [au]              5.407e0       4.974e0     4.951e0    5.407e0
    distance sun to pluto [au]                2.980e1       3.024e1     2.980e1    3.024e1

    claim                                                     said      within  measured  verdict      source
    relative drift of energy [solar mass au^2/day^2]          0.0000e0  8.0e-6            not reached  nothing takes energy: it is conserved, and the method keeps it to its order, here (h w)^2 of Jupiter
    relative drift of linear momentum [solar mass au/day]     0.0000e0  1.0e-9            not reached  Newton's third law
    relative drift of angular momentum [solar mass au^2/day]  0.0000e0  1.0e-9            not reached  central forces; the method keeps it exactly
    least distance sun to jupiter [au]                        4.9503e0  2.0e-2            not reached  Kepler: a (1 - e) of the almanac, but for Saturn's pull
    largest distance sun to jupiter [au]                      5.4549e0  2.0e-2            not reached  Kepler: a (1 + e) of the almanac, but for Saturn's pull
    least distance sun to pluto [au]                          2.9657e1  1.5e-1            not reached  Kepler: a (1 - e) of the almanac
    largest distance sun to pluto [au]                        4.9303e1  1.5e-1            not reached  Kepler: a (1 + e) of the almanac
    ");
}
