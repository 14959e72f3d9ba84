//! Limits and dry friction of joints, and rods beside bodies that break: against closed forms.
//!
//! ```text
//! I phi'' = -b sign phi'          stops after I w/b, having turned by I w^2/(2 b)
//! m x'' = -f sign x'              stops after m v/f, at m v^2/(2 f)
//! T = m (g + v^2/l)               a rod on which a weight swings
//! ```

use stationary_scene::{BodyFault, DriveFault, Fault, Run, Scene, SceneError};

fn run(text: &str) -> Run {
    let scene = Scene::parse("bounds.toml", text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    scene.run().unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn work(run: &Run, name: &str) -> f64 {
    let works = run.works();
    let found = works.iter().find(|(other, _)| other == name);
    found.unwrap_or_else(|| panic!("{name} in {works:?}")).1
}

/// The energy's change less all works, relative to the largest kinetic energy.
fn left(run: &Run) -> f64 {
    let energies = run.energies();
    let change = energies[energies.len() - 1] - energies[0];
    let works: f64 = run.works().iter().map(|(_, work)| work).sum();
    let kinetic = run.kinetic_energies().iter().copied().fold(0.0, f64::max);
    (change - works).abs() / kinetic
}

/// A wheel of moment 2 on an axle, that turns at 3 a second.
fn wheel(dimension: usize, words: &str) -> String {
    let (method, moments, at, spin, joint) = match dimension {
        3 => ("variational-rotation", "[2, 2, 2]", "[0, 0, 0]", "[0, 0, 3]", "hinge"),
        _ => ("stormer-verlet", "2", "[0, 0]", "3", "pin"),
    };
    let axis = if dimension == 3 { "axis = [0, 0, 1], " } else { "" };
    format!(
        "dimension = {dimension}\nintegrator = \"{method}\"\nstep = 0.001\nhorizon = 3\n\
         bodies = [{{ name = \"wheel\", mass = 1, moments = {moments}, position = {at}, \
         angular_velocity = {spin} }}]\n\
         joints = [{{ kind = \"{joint}\", between = [\"world\", \"wheel\"], at = {at}, {axis}{words} }}]\n"
    )
}

fn turned(run: &Run, sample: usize) -> f64 {
    let field = run.bodies(sample)[0];
    let [w, .., z] = field.orientation;
    if run.scene().dimension() == 3 { 2.0 * z.atan2(w) } else { field.angle }
}

#[test]
fn a_wheel_with_dry_friction_stops_after_the_turn_that_its_energy_pays() {
    // It stops after 2 * 3/4 = 1.5 s and 2 * 9/8 = 2.25 radians, and then stays.
    for dimension in [2, 3] {
        let run = run(&wheel(dimension, "friction = 4"));
        let last = run.times().len() - 1;
        assert!((turned(&run, last) - 2.25).abs() < 3e-3, "{}", turned(&run, last));
        assert!((turned(&run, last) - turned(&run, 1600)).abs() < 1e-12);
        assert!(run.bodies(1400)[0].angular_velocity[2] > 0.1);
        assert!((work(&run, "friction of joints") + 9.0).abs() < 1e-9, "{:?}", run.works());
        assert!(work(&run, "joints").abs() < 1e-12 && left(&run) < 1e-12, "{:?}", run.works());
        assert!(run.summary().to_string().contains("friction of joints"));
    }
}

#[test]
fn a_wheel_stops_at_its_limit_and_the_limit_takes_its_energy() {
    for dimension in [2, 3] {
        let run = run(&wheel(dimension, "limits = [-1, 1.2]"));
        let at = |time: f64| turned(&run, (time * 1000.0_f64).round() as usize);
        assert!((at(0.3) - 0.9).abs() < 1e-9, "{}", at(0.3));
        for time in [0.41, 1.0, 3.0] {
            assert!((at(time) - 1.2).abs() < 1e-9, "{time}: {}", at(time));
        }
        let taken = work(&run, "joints and their limits");
        assert!((taken + 9.0).abs() < 1e-9, "{:?}", run.works());
    }
}

#[test]
fn a_slider_of_space_stops_by_its_friction_or_at_its_limit() {
    let scene = |words: &str| {
        format!(
            "dimension = 3\nintegrator = \"variational-rotation\"\nstep = 0.001\nhorizon = 2\n\
             bodies = [{{ name = \"sledge\", mass = 2, box = [1, 1, 1], position = [0, 0, 0], \
             velocity = [0, 3, 0] }}]\n\
             joints = [{{ kind = \"slider\", between = [\"world\", \"sledge\"], at = [0, 0, 0], \
             axis = [0, 1, 0], {words} }}]\n"
        )
    };
    let place = |run: &Run| run.positions(run.times().len() - 1)[1];
    let rubbed = run(&scene("friction = 8"));
    assert!((place(&rubbed) - 2.0 * 9.0 / 16.0).abs() < 3e-3, "{}", place(&rubbed));
    let stopped = run(&scene("friction = 8, limits = [-0.1, 0.5]"));
    assert!((place(&stopped) - 0.5).abs() < 1e-9, "{}", place(&stopped));
    let rubbed = work(&stopped, "friction of joints");
    assert!((rubbed + 8.0 * 0.5).abs() < 0.03, "{rubbed}");
    assert!((rubbed + work(&stopped, "joints and their limits") + 9.0).abs() < 1e-9);
}

#[test]
fn limits_of_any_number_of_turns_hold_in_the_plane() {
    let run = run(&wheel(2, "limits = [0, 7]"));
    let last = run.times().len() - 1;
    assert!((turned(&run, last) - 7.0).abs() < 1e-9, "{}", turned(&run, last));
}

#[test]
fn a_limit_holds_beside_contact() {
    // A flap that falls onto a stop before it would reach the floor.
    let text = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.001\nhorizon = 1.5\n\
                uniform_gravity = { acceleration = [0, -9.81] }\n\
                bodies = [{ name = \"flap\", mass = 1, box = [1, 0.02], position = [0.5, 1] }, \
                { name = \"ball\", mass = 0.1, ball = 0.05, position = [0.8, 1.5] }]\n\
                joints = [{ kind = \"pin\", between = [\"world\", \"flap\"], at = [0, 1], \
                limits = [-0.4, 0] }]\n\
                [contact]\nfriction = 0.2\nwalls = [{ normal = [0, 1], at = [0, 0] }]\n";
    let run = run(text);
    let last = run.times().len() - 1;
    let lowest = (0..=last).map(|sample| run.bodies(sample)[0].angle).fold(f64::INFINITY, f64::min);
    assert!((lowest + 0.4).abs() < 1e-6, "{lowest}");
    assert!((run.bodies(last)[0].angle + 0.4).abs() < 1e-6);
    // The ball fell onto it, rolled off its end, and lies on the floor or falls there.
    assert!(run.positions(last)[3] < 0.8, "{:?}", &run.positions(last)[..4]);
    assert!(left(&run) < 2e-2, "{}", left(&run));
}

#[test]
fn a_rod_beside_contact_bears_the_weight_that_swings_on_it() {
    // From level: three times the weight at the lowest, which it passes after the quarter period K(1/2)/w0.
    let text = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.0005\nhorizon = 0.7\n\
                uniform_gravity = { acceleration = [0, -9.81] }\n\
                observables = [{ tension = [\"hook\", \"weight\"] }]\n\
                particles = [{ name = \"hook\", position = [0, 0], pinned = true }]\n\
                bodies = [{ name = \"weight\", mass = 2, ball = 0.1, position = [1, 0] }]\n\
                rods = [{ between = [\"hook\", \"weight\"] }]\n\
                [contact]\nwalls = [{ normal = [0, 1], at = [0, -3] }]\n";
    let run = run(text);
    let most = (0..run.times().len()).map(|i| run.observed(i)[0]).fold(0.0, f64::max);
    assert!((most / (3.0 * 2.0 * 9.81) - 1.0).abs() < 3e-3, "{most}");
}

/// A weight of 2 on a rod of strength 50, pulled by a load of 40 a second: it breaks at (50 - 2 g)/40.
fn pulled(contact: &str) -> String {
    format!(
        "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.001\nhorizon = 1.2\n\
         uniform_gravity = {{ acceleration = [0, -9.81] }}\n\
         observables = [{{ tension = [\"hook\", \"weight\"] }}, {{ position = \"weight\" }}]\n\
         particles = [{{ name = \"hook\", position = [0, 0], pinned = true }}]\n\
         bodies = [{{ name = \"weight\", mass = 2, ball = 0.1, position = [0, -1] }}]\n\
         rods = [{{ between = [\"hook\", \"weight\"], strength = 50 }}]\n\
         loads = [{{ on = \"weight\", force = [0, -1], strength = {{ ramp = [0, 80], from = 0, to = 2 }} }}]\n\
         {contact}"
    )
}

#[test]
fn a_rod_breaks_beside_bodies_at_the_load_of_its_strength() {
    for contact in ["", "[contact]\nwalls = [{ normal = [0, 1], at = [0, -2] }]\n"] {
        let run = run(&pulled(contact));
        let [broken] = run.broken() else { panic!("{:?}", run.broken()) };
        let expected = (50.0 - 2.0 * 9.81) / 40.0;
        assert!((broken.time - expected).abs() < 2.5e-3, "{broken:?} {expected}");
        assert!((broken.tension - 50.0).abs() < 0.1, "{broken:?}");
        let last = run.times().len() - 1;
        let (held, free) = (run.observed(500), run.observed(last));
        assert!((held[0] - (2.0 * 9.81 + 20.0)).abs() < 0.1, "{held:?}");
        assert_eq!(free[0], 0.0);
        // It falls, onto the floor where there is one.
        let bottom = if contact.is_empty() { -2.0 } else { -1.9 + 1e-6 };
        assert!(free[2] < bottom && (contact.is_empty() || free[2] > -1.9 - 1e-6), "{free:?}");
    }
}

/// A block on a tilted rail that turns with a wheel of moment 2, or is fixed.
fn on_a_rail(words: &str, velocity: &str) -> String {
    format!(
        "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.001\nhorizon = 3\n\
         observables = [{{ distance = [\"block\", \"mark\"] }}]\n\
         particles = [{{ name = \"mark\", position = [-3, -4], pinned = true }}]\n\
         bodies = [{{ name = \"block\", mass = 2, box = [1, 1], position = [0, 0], velocity = {velocity} }}]\n\
         joints = [{{ kind = \"slider\", between = [\"world\", \"block\"], at = [0, 0], axis = [3, 4], {words} }}]\n"
    )
}

#[test]
fn a_slider_of_the_plane_stops_at_its_limits_and_by_its_friction() {
    // At 2.5 m/s it is at the limit, 1 m away, after 0.4 s, and stays there: an impact without restitution.
    let stopped = run(&on_a_rail("limits = [-0.5, 1]", "[1.5, 2]"));
    for sample in [200, 300, 399, 500, 3000] {
        let shift = (2.5 * stopped.times()[sample]).min(1.0);
        let found = stopped.observed(sample)[0] - 5.0;
        assert!((found - shift).abs() < 3e-3, "{sample}: {found} {shift}");
    }
    // The other way to the other one, by the order of its ends.
    let back = on_a_rail("limits = [-1, 0.5]", "[1.5, 2]");
    let back = run(&back.replace("[\"world\", \"block\"]", "[\"block\", \"world\"]"));
    assert!((back.observed(3000)[0] - 6.0).abs() < 3e-3, "{:?}", back.observed(3000));
    // m v/f = 1 s and m v^2/(2 f) = 1.25 m.
    let rubbed = run(&on_a_rail("friction = 5", "[1.5, 2]"));
    for (sample, shift) in [(500, 1.25 - 0.25 * 1.25), (1000, 1.25), (3000, 1.25)] {
        let found = rubbed.observed(sample)[0] - 5.0;
        assert!((found - shift).abs() < 3e-3, "{sample}: {found} {shift}");
    }
    assert!(left(&rubbed) < 1e-2, "{}", left(&rubbed));
}

#[test]
fn limits_and_friction_that_cannot_be_are_refused() {
    let fault = |text: &str| match Scene::parse("bad.toml", text) {
        Err(SceneError::Invalid(diagnostic)) => diagnostic.fault.clone(),
        other => panic!("{other:?}"),
    };
    let of = |dimension, words: &str| fault(&wheel(dimension, words));
    for (low, high) in [(1.0, -1.0), (0.5, 1.0), (-1.0, -0.5), (0.0, 0.0)] {
        let found = of(2, &format!("limits = [{low}, {high}]"));
        assert_eq!(found, Fault::Bodies(BodyFault::LimitsBesideTheStart { low, high }));
    }
    assert_eq!(
        of(2, "limits = [1]"),
        Fault::Drives(DriveFault::TwoValues { key: "`limits`", got: 1 })
    );
    assert!(matches!(of(2, "limits = [-inf, 1]"), Fault::NotFinite { what: "the limit", .. }));
    assert_eq!(of(3, "limits = [-1, 4]"), Fault::Bodies(BodyFault::BeyondHalfATurn(4.0)));
    assert!(matches!(of(2, "friction = -1"), Fault::Negative { what: "the friction", .. }));
    assert!(matches!(of(2, "friction = nan"), Fault::NotFinite { what: "the friction", .. }));
    let weld = |word: &str| {
        wheel(2, word).replace("\"pin\"", "\"weld\"").replace("velocity = 3", "velocity = 0")
    };
    assert_eq!(fault(&weld("friction = 1")), Fault::Bodies(BodyFault::BoundsWithoutCoordinate));
    assert_eq!(fault(&weld("limits = [-1, 1]")), Fault::Bodies(BodyFault::BoundsWithoutCoordinate));
    let other = wheel(3, "friction = 1").replace("variational-rotation", "axis-rotations");
    let Fault::MethodCannot { what, .. } = fault(&other) else { panic!("a method") };
    assert!(what.starts_with("limits and friction"), "{what}");
}
