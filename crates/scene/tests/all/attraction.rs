//! Balls that attract each other as points at their centres do: orbits, no torque, refusals where the law is another.

use std::f64::consts::TAU;

use stationary_scene::{Run, RunError, Scene, StepFailure};

use crate::body_diagnostics::refused;
use crate::driven::defect;

fn run(text: &str) -> Run {
    let scene = Scene::parse("orbits.toml", text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    scene.run().unwrap_or_else(|error| panic!("{error}"))
}

fn head(method: &str, step: f64, horizon: f64) -> String {
    format!(
        "dimension = 3\nintegrator = {method}\nstep = {step}\nhorizon = {horizon}\n\
         newtonian_gravity = {{ constant = 2 }}\n"
    )
}

fn place(run: &Run, name: &str) -> [f64; 3] {
    let index = run.scene().particles().iter().position(|p| p.name == name).unwrap();
    std::array::from_fn(|c| run.positions(run.times().len() - 1)[3 * index + c])
}

/// Each thing as a particle, and some of them as balls that spin.
fn three(balls: bool) -> String {
    let kind = |spin: &str| match balls {
        true => format!("ball = 0.3, angular_velocity = {spin}, "),
        false => String::new(),
    };
    format!(
        "{} = [{{ name = \"sun\", mass = 5, {}position = [0, 0, 0], velocity = [0, -0.2, 0] }},\n\
         {{ name = \"planet\", mass = 0.5, {}position = [2, 0, 0.1], velocity = [0, 2, 0] }}]\n",
        if balls { "bodies" } else { "planets" },
        kind("[0, 0, 3]"),
        kind("[1, 2, 0]"),
    )
}

#[test]
fn balls_move_on_the_orbits_of_points_and_keep_their_spin() {
    let others = "{ name = \"moon\", mass = 0.1, position = [0, 3.5, 0], velocity = [-1.5, 0, 0.3] },\n\
                  { name = \"far\", mass = 2, pinned = true, position = [-6, 0, 0] }]\n";
    let end = |method: &str, balls: bool| {
        let text = match balls {
            true => format!("{}particles = [{others}", three(true)),
            false => {
                let all = three(false).replace("planets", "particles");
                format!("{}{others}", all.replace("}]\n", "},\n"))
            }
        };
        run(&format!("{}{text}", head(method, 1e-3, 3.0)))
    };
    let points = end("\"stormer-verlet\"", false);
    for method in ["\"variational-rotation\"", "\"axis-rotations\""] {
        let balls = end(method, true);
        for name in ["sun", "planet", "moon"] {
            let [a, b] = [&points, &balls].map(|run| place(run, name));
            let off = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9, "{method}: {name} is off by {off}");
        }
        let spins = balls.bodies(balls.times().len() - 1);
        // Steps may turn the axis of a ball in its own axes, but nothing spins it up.
        for (body, spin) in [(0, 3.0), (1, 5.0_f64.sqrt())] {
            let found = spins[body].angular_velocity;
            let found = found.iter().map(|w| w * w).sum::<f64>().sqrt();
            assert!((found - spin).abs() < 1e-9, "{method}: {found}");
        }
    }
}

/// Two balls `a` apart on circles about their centre of mass: `w^2 a^3 = G (m + M)`.
#[test]
fn two_balls_come_back_after_keplers_period() {
    let [m, big, a, g]: [f64; 4] = [1.0, 3.0, 2.0, 2.0];
    let w = (g * (m + big) / a.powi(3)).sqrt();
    let period = TAU / w;
    let [r, s] = [a * big / (m + big), a * m / (m + big)];
    let text = format!(
        "bodies = [{{ name = \"light\", mass = {m}, ball = 0.4, position = [{r}, 0, 0], velocity = [0, {}, 0] }},\n\
         {{ name = \"heavy\", mass = {big}, ball = 0.5, position = [{}, 0, 0], velocity = [0, {}, 0] }}]\n",
        w * r,
        -s,
        -w * s,
    );
    let adaptive = "\"dormand-prince-853\"\ntolerance = 1e-10";
    let fine = run(&format!("{}{text}", head(adaptive, period / 16.0, period)));
    let off = |run: &Run| {
        let [x, y, z] = place(run, "light");
        (x - r).hypot(y).hypot(z)
    };
    assert!(off(&fine) < 1e-7, "{}", off(&fine));
    let errors = [500.0, 1000.0].map(|steps| {
        off(&run(&format!("{}{text}", head("\"exact-rotation\"", period / steps, period))))
    });
    let slope = (errors[0] / errors[1]).log2();
    assert!((slope - 2.0).abs() < 0.1, "{slope} {errors:?}");
}

/// Inside of a ball its attraction is another one: the run stops there, unless the balls touch.
#[test]
fn balls_that_fall_into_each_other_stop_the_run_or_rebound() {
    let text = "bodies = [{ name = \"a\", mass = 1, ball = 0.4, position = [-1, 0, 0] },\n\
                { name = \"b\", mass = 1, ball = 0.4, position = [1, 0, 0] }]\n";
    let fall =
        |beside: &str| format!("{}{beside}{text}", head("\"variational-rotation\"", 1e-3, 2.5));
    let error = Scene::parse("a.toml", &fall("")).unwrap().run().unwrap_err();
    let RunError::Stopped(stop) = &error else { panic!("{error}") };
    assert!(matches!(stop.source, StepFailure::Inside { .. }), "{error}");
    assert!(error.to_string().contains("`a` and `b` are 7.9"), "{error}");
    assert!(stop.run.times().len() > 100);
    let run = run(&fall("contact = { restitution = 1 }\n"));
    let least = (0..run.times().len())
        .map(|k| run.positions(k)[3] - run.positions(k)[0])
        .fold(f64::INFINITY, f64::min);
    assert!(run.impacts().len() == 1 && least > 0.799, "{least}");
    // V = -2/r falls from -1 to -2.5: the speed that closes the gap, and then opens it.
    let kinetic = run.kinetic_energies().iter().copied().fold(0.0, f64::max);
    assert!((kinetic - 1.5).abs() < 0.02, "{kinetic}");
}

/// Particles on a rod that touch are moved as bodies, and attract all the same.
#[test]
fn particles_on_rods_beside_contact_attract() {
    let text = "particles = [{ name = \"sun\", mass = 5, pinned = true, position = [0, 0, 0] },\n\
                { name = \"a\", mass = 1, position = [2, 0, 0], velocity = [0, 2, 0] },\n\
                { name = \"b\", mass = 1, position = [2.5, 0, 0], velocity = [0, 2, 0] }]\n\
                rods = [{ between = [\"a\", \"b\"] }]\n";
    let alone = run(&format!("{}{text}", head("\"rattle\"", 1e-3, 1.0)));
    let off = [1e-3, 5e-4].map(|step| {
        let contact = "contact = { restitution = 0.5 }\n";
        let beside =
            run(&format!("{}{contact}{text}", head("\"variational-rotation\"", step, 1.0)));
        let [x, y] = [&alone, &beside].map(|run| place(run, "b"));
        x.iter().zip(y).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    });
    assert!(off[0] < 1e-2 && off[1] < 0.6 * off[0], "{off:?}");
}

#[test]
fn what_does_not_attract_as_a_point_is_refused() {
    let law = |name: &str| {
        format!(
            "`{name}` does not attract as a point: `newtonian_gravity` is between particles and, in space, balls; \
             the attraction of other bodies, such as a disc in the plane, depends on how their mass is distributed"
        )
    };
    let space = head("\"variational-rotation\"", 0.1, 1.0).replace("= 2 }", "= <<2>> }");
    let of = |shape: &str| {
        format!("bodies = [{{ name = \"rock\", mass = 1, {shape}, position = [0, 0, 0] }}]\n")
    };
    for shape in ["box = [1, 1, 1]", "moments = [1, 1, 1]", "capsule = { length = 1, radius = 1 }"]
    {
        refused(&format!("{space}{}", of(shape)), &law("rock"));
    }
    let plane = space
        .replace("dimension = 3", "dimension = 2")
        .replace("variational-rotation", "stormer-verlet");
    let disc = of("ball = 1").replace("[0, 0, 0]", "[0, 0]");
    refused(&format!("{plane}{disc}"), &law("rock"));
    // Two centres are not at one place; marks of two balls may be.
    let marks = "bodies = [{ name = \"a\", mass = 1, ball = 1, position = [-1, 0, 0], points = [[1, 0, 0]] },\n\
                 { name = \"b\", mass = 1, ball = 1, position = [1, 0, 0], points = [[-1, 0, 0]] }]\n";
    assert!(
        Scene::parse("a.toml", &format!("{}{marks}", head("\"variational-rotation\"", 0.1, 1.0)))
            .is_ok()
    );
}

/// A thing on a circle about a pin that moves evenly: after half a turn it is across, seen from the pin.
#[test]
fn a_pin_that_moves_attracts_from_where_it_is_and_its_work_closes_the_budget() {
    // G M = 8 at a distance of 2: two a second, and half a turn takes pi.
    let (turn, v) = (0.5 * TAU, [0.5, 0.3, -0.2]);
    let text = |method: &str, step: f64, balls: bool, more: &str| {
        let shift = v.map(|v| v * turn);
        let planet =
            format!("position = [2, 0, 0], velocity = [{}, {}, {}]", v[0], v[1] + 2.0, v[2]);
        let planet = match balls {
            true => format!(
                "bodies = [{{ name = \"planet\", mass = 0.5, ball = 0.3, {planet} }}]\nparticles = ["
            ),
            false => format!("particles = [{{ name = \"planet\", mass = 0.5, {planet} }},"),
        };
        format!(
            "{}{planet}{{ name = \"sun\", mass = 4, pinned = true, position = [0, 0, 0] }}]\n\
             motions = [{{ of = \"sun\", shift = {shift:?}, strength = {{ ramp = [0, 1], to = {turn} }} }}]\n{more}",
            head(method, step, turn)
        )
    };
    let off = |run: &Run| {
        let end = place(run, "planet");
        let seen: [f64; 3] = std::array::from_fn(|c| end[c] - v[c] * turn);
        (seen[0] + 2.0).hypot(seen[1]).hypot(seen[2])
    };
    let contact = "contact = { walls = [{ normal = [0, 0, 1], at = [0, 0, -99] }] }\n";
    let fine = "\"dormand-prince-853\"\ntolerance = 1e-11";
    for (method, balls, more, orders) in [
        ("\"stormer-verlet\"", false, "", 2.0),
        ("\"variational-rotation\"", true, "", 2.0),
        ("\"variational-rotation\"", true, contact, 1.0),
    ] {
        let of = |part: f64| run(&text(method, turn / part, balls, more));
        let [coarse, finer] = [of(1000.0), of(2000.0)];
        let slope = (off(&coarse) / off(&finer)).log2();
        assert!(slope > orders - 0.2, "{method}: {slope} {}", off(&finer));
        let slope = (defect(&coarse) / defect(&finer)).log2();
        assert!(slope > orders - 0.2 || defect(&finer) < 1e-9, "{method}: {slope}");
    }
    for balls in [false, true] {
        let run = run(&text(fine, turn / 8.0, balls, ""));
        assert!(off(&run) < 1e-7 && defect(&run) < 1e-7, "{} {}", off(&run), defect(&run));
        let (name, work) = &run.works()[0];
        assert!(name == "motion of sun", "{name}");
        // The kinetic energy seen from rest: m v (u' - u), as the velocity about the pin turns back.
        assert!((work + 0.5 * 0.3 * 4.0).abs() < 1e-6, "{work}");
    }
    let scene =
        Scene::parse("a.toml", &text("\"stormer-verlet\"", turn / 200.0, false, "")).unwrap();
    crate::checkpoints::assert_resumes(&scene, &[2, 77, 199], "moving-sun");
}

/// A pin that is led into a ball stops the run, as one that stays does.
#[test]
fn a_pin_that_moves_into_a_ball_which_it_attracts_stops_the_run() {
    let text = format!(
        "{}bodies = [{{ name = \"ball\", mass = 5, ball = 0.3, position = [0, 0, 0] }}]\n\
         particles = [{{ name = \"other\", pinned = true, mass = 1, position = [9, 9, 0] }},\n\
         {{ name = \"pin\", pinned = true, mass = 1e-6, position = [2, 0, 0] }}]\n\
         motions = [{{ of = \"pin\", shift = [-2, 0, 0], strength = {{ ramp = [0, 1], to = 1 }} }}]\n",
        head("\"variational-rotation\"", 1e-3, 2.0)
    );
    let error = Scene::parse("a.toml", &text).unwrap().run().unwrap_err();
    let RunError::Stopped(stop) = error else { panic!("{error}") };
    match stop.source {
        StepFailure::Inside { first, second, .. } => assert_eq!([first, second], ["ball", "pin"]),
        other => panic!("{other}"),
    }
    assert!((stop.time - 0.85).abs() < 0.01, "{}", stop.time);
}
