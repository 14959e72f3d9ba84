//! The chooser where it was once wrong: each is the sample of a kind that trials draw at random.

use std::f64::consts::{PI, TAU};

use stationary_choose::{At, Kind, MeshError, Purpose, Verdict, way_error};

use super::asked;

/// Burrau's problem: masses 3, 4 and 5 fall from rest at the corners of that triangle.
const PYTHAGOREAN: &str = r#"
dimension = 2
integrator = "stormer-verlet"
step = 0.01
horizon = 10
newtonian_gravity = { constant = 1 }
particles = [
    { name = "a", mass = 3, position = [1, 3] },
    { name = "b", mass = 4, position = [-2, -1] },
    { name = "c", mass = 5, position = [1, -1] },
]
"#;

#[test]
fn two_coarse_runs_that_agree_on_another_motion_make_no_reference() {
    let (answer, mut runs) = asked(PYTHAGOREAN, "position=a", 1e-1);
    let reference = answer.reference.clone().unwrap();
    if let Verdict::Chosen(at) = answer.verdict {
        assert!(reference.is_confirmed);
        let family = runs.family(at.family);
        assert!(family.kind == Kind::Adaptive || family.rungs[at.rung].setting < 0.01, "{answer}");
        // The energy is kept where the choice is looked at, as it was not by the coarse runs.
        assert!(answer.seen.unwrap().energy.unwrap() < 0.1, "{answer}");
        let error = way_error(&mut runs, &reference, at, 1e-1).unwrap();
        assert!(error <= 1e-1, "{error:e}");
    } else {
        // Nothing is called wrong physics against what is not confirmed.
        assert!(!answer.to_string().contains("wrong physics"), "{answer}");
    }
}

/// A bead on a spring whose period is a twentieth of the horizon.
fn resonant() -> String {
    format!(
        "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = 0.01\nhorizon = {:?}\n\
         particles = [{{ name = \"pin\", pinned = true, position = [0] }}, \
         {{ name = \"bead\", mass = 1, position = [1.5] }}]\n\
         springs = [{{ between = [\"pin\", \"bead\"], stiffness = 1, rest_length = 1 }}]",
        (20.0 * TAU / 0.01_f64).round() * 0.01
    )
}

#[test]
fn a_period_equal_to_the_spacing_of_the_moments_hides_nothing() {
    for observable in ["kinetic-energy", "position=bead"] {
        let (answer, runs) = asked(&resonant(), observable, 1e-2);
        let at = answer.choice().unwrap_or_else(|| panic!("{answer}")).at;
        let family = runs.family(at.family);
        // More than one step a period, as many as its stages ask for.
        let steps = 20.0 * TAU / family.rungs[at.rung].setting;
        assert!(family.kind == Kind::Adaptive || steps > 39.0, "{answer}");
        assert!(answer.seen.unwrap().places.unwrap() < 0.1, "{answer}");
    }
    // The midpoint rule keeps this energy at any step, and another motion with it.
    let (answer, _) = asked(&resonant(), "energy", 1e-2);
    assert!(answer.seen.unwrap().places.unwrap() > 0.5, "{answer}");
}

#[test]
fn what_hardly_moves_is_said_to() {
    let text = resonant().replace("[1.5]", "[1.0]");
    let (answer, _) = asked(&text, "position=bead", 1e-3);
    assert_eq!(answer.verdict, Verdict::Still);
    assert!(answer.to_string().contains("hardly moves"), "{answer}");
}

#[test]
fn beside_a_momentum_that_is_kept_for_free_stands_what_is_off() {
    let text = r#"
dimension = 2
integrator = "stormer-verlet"
step = 0.01
horizon = 12
newtonian_gravity = { constant = 1 }
particles = [
    { name = "sun", mass = 1, position = [0, 0] },
    { name = "planet", mass = 1e-6, position = [0.4, 0], velocity = [0, 2] },
]
"#;
    let (answer, _) = asked(text, "angular-momentum", 1e-3);
    let seen = answer.seen.unwrap();
    assert!(seen.places.unwrap() > 1e-3, "{answer}");
    assert!(answer.to_string().contains("besides what was asked it is off: the energy by"));
}

/// A bar between a cold and a warm end.
const BAR: &str = r#"
dimension = 1
integrator = "implicit-euler"
step = 0.005
horizon = 0.5

[heat]
name = "bar"
shape = { kind = "bar", size = [1], cells = [8] }
diffusivity = 1
held = [{ part = "left", temperature = 0 }, { part = "right", temperature = 20 }]
marks = { middle = [0.5] }
"#;

/// `u = 20 x + sum_n 40 (-1)^n / (n pi) sin(n pi x) exp(-n^2 pi^2 t)` in the middle.
fn warmth(t: f64) -> f64 {
    let term = |n: i32| {
        let rate = f64::from(n) * PI;
        40.0 * (-1.0_f64).powi(n) / rate * (0.5 * rate).sin() * (-rate * rate * t).exp()
    };
    10.0 + (1..200).map(term).sum::<f64>()
}

#[test]
fn the_error_of_a_mesh_is_that_by_the_equation_itself() {
    for cells in [4, 8, 16] {
        let text = BAR.replace("cells = [8]", &format!("cells = [{cells}]"));
        let (answer, mut runs) = asked(&text, "temperature=bar.middle", 1e-4);
        let Some(MeshError::Measured(mesh)) = &answer.mesh else { panic!("{answer}") };
        let reference = answer.reference.as_ref().unwrap();
        let exact = At { family: reference.family, rung: reference.finest };
        let course = runs.measure(exact).whole().unwrap();
        let moments = course.values.iter().enumerate();
        let off = moments.map(|(k, x)| (x[0] - warmth(0.025 * k as f64)).abs());
        let off = off.skip(1).fold(0.0, f64::max) / course.scale;
        assert!((0.5 * off..2.0 * off).contains(&mesh.error), "{:e} for {off:e}", mesh.error);
        assert!(mesh.halved < 0.5 * mesh.error && mesh.work > 1.0, "{mesh:?}");
    }
}

#[test]
fn a_block_that_friction_holds_is_said_not_to_move() {
    let text = r#"
dimension = 3
integrator = "variational-rotation"
step = 0.00459
horizon = 0.459
uniform_gravity = { acceleration = [0, 0, -9.81] }
[[bodies]]
name = "block"
mass = 2
box = [0.4, 0.3, 0.2]
position = [1.9961745283516354, 0, 0.15901966029433567]
rotation = [0, -0.029535932039603616, 0]
[contact]
friction = 0.686
walls = [{ normal = [-0.029531637843767528, 0, 0.9995638460680061], at = [0, 0, 0] }]
"#;
    let (answer, _) = asked(text, "velocity=block", 2.7e-4);
    assert_eq!(answer.verdict, Verdict::Still, "{answer}");
}

#[test]
fn coarse_runs_confirm_rods_where_those_that_agree_by_themselves_are_dear() {
    let text = r#"
dimension = 2
integrator = "rattle"
step = 0.01
horizon = 1
uniform_gravity = { acceleration = [0, -9.81] }
particles = [
    { name = "hook", pinned = true, position = [0, 0] },
    { name = "bob0", mass = 1, position = [0.8, 0.6] },
    { name = "bob1", mass = 2, position = [0.8, 1.4] },
]
rods = [{ between = ["hook", "bob0"] }, { between = ["bob0", "bob1"] }]
"#;
    let (answer, _) = asked(text, "position=bob1", 1e-4);
    let work = answer.choice().unwrap().work;
    assert!(matches!(answer.verdict, Verdict::Chosen(_)), "{answer}");
    // By a run of order 1 that agrees by itself it would be some hundreds.
    assert!(answer.spent.on(Purpose::Confirmation) <= 40 * work, "{answer}");
}
