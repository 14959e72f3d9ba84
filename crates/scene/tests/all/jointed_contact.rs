//! Joints and contact in one scene: closed forms, the energy's budget, momenta and the order of the steps.

use std::f64::consts::PI;

use stationary_scene::{Run, Scene};

fn scene(text: &str) -> Scene {
    Scene::parse("jointed.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

fn run(text: &str) -> Run {
    let run = scene(text).run().unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(run.unsettled().steps, 0, "{}", run.summary());
    run
}

/// What the energy's change and the works differ by, over the largest kinetic energy.
fn defect(run: &Run) -> f64 {
    let energies = run.energies();
    let change = energies[energies.len() - 1] - energies[0];
    let works: f64 = run.works().iter().map(|(_, work)| work).sum();
    let kinetic = run.kinetic_energies().iter().copied().fold(0.0, f64::max);
    (change - works).abs() / kinetic
}

fn work(run: &Run, name: &str) -> f64 {
    run.works().iter().find(|(of, _)| of == name).unwrap_or_else(|| panic!("{:?}", run.works())).1
}

/// The heads of a scene in the plane and of one in space, with what is the same in both.
fn head(dimension: usize, step: f64, horizon: f64) -> String {
    let method = if dimension == 3 { "variational-rotation" } else { "stormer-verlet" };
    format!(
        "dimension = {dimension}\nintegrator = \"{method}\"\nstep = {step}\nhorizon = {horizon}\n"
    )
}

/// A vector of the plane as one of the scene.
fn vector(dimension: usize, x: f64, y: f64) -> String {
    if dimension == 3 { format!("[{x}, {y}, 0]") } else { format!("[{x}, {y}]") }
}

/// A turn about the third axis.
fn turn(dimension: usize, angle: f64) -> String {
    if dimension == 3 { format!("[0, 0, {angle}]") } else { format!("{angle}") }
}

/// A ball of a pendulum without weight's rod: its centre is 1 below the pivot, its moment m 2/5 r^2 or m r^2/2.
fn pendulum(dimension: usize, restitution: f64, step: f64, horizon: f64) -> String {
    pendulum_from(0.5, dimension, restitution, step, horizon)
}

fn pendulum_from(
    angle: f64,
    dimension: usize,
    restitution: f64,
    step: f64,
    horizon: f64,
) -> String {
    let (joint, axis) = if dimension == 3 { ("hinge", "axis = [0, 0, 1], ") } else { ("pin", "") };
    let [hook, at, normal, wall, g] = [
        vector(dimension, 0.0, 0.0),
        vector(dimension, -angle.sin(), -angle.cos()),
        vector(dimension, -1.0, 0.0),
        vector(dimension, 0.1, 0.0),
        vector(dimension, 0.0, -9.81),
    ];
    format!(
        "{}observables = [\"energy\", {{ velocity = \"bob\" }}]\n\
         uniform_gravity = {{ acceleration = {g} }}\n\
         bodies = [{{ name = \"bob\", mass = 2, ball = 0.1, position = {at} }}]\n\
         joints = [{{ kind = \"{joint}\", {axis}between = [\"world\", \"bob\"], at = {hook} }}]\n\
         contact = {{ restitution = {restitution}, walls = [{{ normal = {normal}, at = {wall} }}] }}\n",
        head(dimension, step, horizon)
    )
}

/// m L^2 + I at the pivot: a ball in space, a disc in the plane.
fn moment(dimension: usize) -> f64 {
    let share = if dimension == 3 { 0.4 } else { 0.5 };
    2.0 * (1.0 + share * 0.01)
}

/// The ball touches the wall where it hangs straight down, with the speed that its fall gave it.
#[test]
fn a_pendulum_that_meets_a_wall_rebounds_by_the_restitution() {
    for dimension in [2, 3] {
        let fallen = 2.0 * 9.81 * (1.0 - 0.5_f64.cos());
        let speed = (2.0 * fallen / moment(dimension)).sqrt();
        for restitution in [0.0, 0.6, 1.0] {
            let run = run(&pendulum(dimension, restitution, 2e-4, 0.7));
            let fastest = |sign: f64| {
                let all = (0..run.times().len()).map(|k| sign * run.observed(k)[1]);
                all.fold(0.0, f64::max)
            };
            let [towards, back] = [fastest(1.0), fastest(-1.0)];
            assert!((towards / speed - 1.0).abs() < 1e-3, "{dimension} {towards} {speed}");
            let rebound = restitution * speed;
            assert!((back - rebound).abs() < 2e-3 * speed, "{dimension}: {back} {rebound}");
            // The impact took (1 - e^2) of the kinetic energy, by an impulse or as resting contact.
            let taken = -work(&run, "impacts");
            let lost = (1.0 - restitution * restitution) * fallen;
            assert!(
                (taken - lost).abs() < 3e-3 * fallen,
                "{dimension} {restitution}: {taken} {lost}"
            );
            assert!(defect(&run) < 3e-3, "{}", run.summary());
        }
    }
}

/// A door of 1 m by 0.1 m on a hinge meets a stop at 0.8 m from it: the impulse of the stop is
/// (1 + e) I w/r, and the hinge takes what is left of the door's momentum.
#[test]
fn a_door_that_meets_a_stop_gives_it_the_impulse_of_its_angular_momentum() {
    let (e, w, r) = (0.5, 2.0, 0.8);
    let moment = 6.0 * (1.0 + 0.01) / 12.0 + 6.0 * 0.25;
    for dimension in [2, 3] {
        let (joint, axis, side) = match dimension {
            3 => ("hinge", "axis = [0, 0, 1], ", "[1, 0.1, 0.5]"),
            _ => ("pin", "", "[1, 0.1]"),
        };
        let [origin, centre, stop] =
            [vector(dimension, 0.0, 0.0), vector(dimension, 0.5, 0.0), vector(dimension, r, 0.2)];
        let text = format!(
            "{}bodies = [{{ name = \"door\", mass = 6, box = {side}, position = {centre}, \
             angular_velocity = {} }}]\n\
             joints = [{{ kind = \"{joint}\", {axis}between = [\"world\", \"door\"], at = {origin} }}]\n\
             contact = {{ restitution = {e}, balls = [{{ name = \"stop\", at = {stop}, radius = 0.1 }}] }}\n\
             observables = [\"energy\", \"linear-momentum\", {{ angular_velocity = \"door\" }}]\n",
            head(dimension, 1e-4, 0.1),
            turn(dimension, w)
        );
        let run = run(&text);
        let last = run.observed(run.times().len() - 1);
        let spin = last[last.len() - 1];
        assert!((spin + e * w).abs() < 2e-3 * w, "{dimension}: {spin}");
        let [hit] = run.contact_impulses() else { panic!("{:?}", run.contact_impulses()) };
        // Along the face: the stop's centre is half a door and its own radius from the middle line.
        let arm = (r * r + 0.04 - 0.15 * 0.15_f64).sqrt();
        let (impulse, exact) = (hit.magnitude, (1.0 + e) * moment * w / arm);
        assert!((impulse / exact - 1.0).abs() < 1e-3, "{dimension}: {impulse} {exact}");
    }
}

/// Eight links over a drum: what hangs on both sides keeps the chain where it is, and friction holds it.
#[test]
fn a_chain_draped_over_a_cylinder_comes_to_rest_with_its_pins_closed() {
    let (links, length) = (8, 0.2);
    let mut bodies = String::new();
    let mut joints = String::new();
    for k in 0..links {
        let x = length * (k as f64 - 0.5 * (links as f64 - 1.0));
        bodies += &format!(
            "[[bodies]]\nname = \"l{k}\"\nmass = 0.5\nbox = [0.2, 0.04]\nposition = [{x}, 0.33]\n"
        );
        if k > 0 {
            joints += &format!(
                "[[joints]]\nkind = \"pin\"\nbetween = [\"l{}\", \"l{k}\"]\nat = [{}, 0.33]\n",
                k - 1,
                x - 0.5 * length
            );
        }
    }
    let text = format!(
        "{}sample_every = 50\ndrag = {{ coefficient = 2 }}\n\
         observables = [\"energy\", \"kinetic-energy\"]\n\
         uniform_gravity = {{ acceleration = [0, -9.81] }}\n\
         contact = {{ friction = 0.8, balls = [{{ name = \"drum\", at = [0, 0], radius = 0.3 }}] }}\n{bodies}{joints}",
        head(2, 1e-3, 6.0)
    );
    let run = scene(&text).run().unwrap();
    let last = run.times().len() - 1;
    assert!(run.observed(last)[1] < 1e-4, "{}", run.summary());
    // Pins: the ends of neighbouring links, from places and angles.
    let fields = run.bodies(last);
    let end = |k: usize, side: f64| {
        let (x, angle) = (&run.positions(last)[2 * k..], fields[k].angle);
        [x[0] + side * 0.1 * angle.cos(), x[1] + side * 0.1 * angle.sin()]
    };
    for k in 1..links {
        let (a, b) = (end(k - 1, 1.0), end(k, -1.0));
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-6, "{k}: {a:?} {b:?}");
    }
    // At rest the drum bears the weight of all.
    let weight: f64 = run
        .contact_impulses()
        .iter()
        .filter(|row| row.sample == last)
        .map(|row| row.impulse[1])
        .sum();
    let whole = 8.0 * 0.5 * 9.81 * 0.05;
    assert!((weight / whole - 1.0).abs() < 1e-2, "{weight} {whole}");
    assert!(defect(&run) < 0.05, "{}", run.summary());
}

/// Two links on a pin are struck by a ball: no force from outside, both momenta stay.
#[test]
fn what_is_free_keeps_both_momenta_when_it_is_struck() {
    for (dimension, joint) in
        [(2, "pin"), (3, "ball"), (2, "slider"), (2, "weld"), (3, "hinge"), (3, "fixed")]
    {
        let side = if dimension == 3 { "[1, 0.2, 0.3]" } else { "[1, 0.2]" };
        let axis = match joint {
            "slider" => "axis = [1, 0], ",
            "hinge" => "axis = [0, 0, 1], ",
            _ => "",
        };
        let place = |x: f64, y: f64| vector(dimension, x, y);
        let text = format!(
            "{}bodies = [\
             {{ name = \"a\", mass = 2, box = {side}, position = {} }},\
             {{ name = \"b\", mass = 3, box = {side}, position = {} }},\
             {{ name = \"shot\", mass = 1, ball = 0.1, position = {}, velocity = {} }}]\n\
             joints = [{{ kind = \"{joint}\", {axis}between = [\"a\", \"b\"], at = {} }}]\n\
             contact = {{ restitution = 0.7, friction = 0.4 }}\n\
             observables = [\"energy\", \"linear-momentum\", \"angular-momentum\"]\n",
            head(dimension, 1e-3, 1.0),
            place(-0.5, 0.0),
            place(0.5, 0.0),
            place(0.8, 0.7),
            place(0.5, -2.0),
            place(0.0, 0.0)
        );
        let run = run(&text);
        let (first, last) = (run.observed(0), run.observed(run.times().len() - 1));
        assert!(!run.contact_impulses().is_empty(), "{dimension} {joint}: nothing was struck");
        for k in 1..=dimension {
            assert!(
                (first[k] - last[k]).abs() < 1e-10,
                "{dimension} {joint} {k}: {first:?} {last:?}"
            );
        }
        // Joints are closed by moving bodies, which turns the momentum about their common centre by order
        // h^2 a step; what they hold rigidly needs no closing.
        for k in dimension + 1..first.len() {
            assert!(
                (first[k] - last[k]).abs() < 3e-3,
                "{dimension} {joint} {k}: {first:?} {last:?}"
            );
        }
        assert!(last[0] < first[0] * (1.0 + 1e-9), "{dimension} {joint}");
    }
}

/// The largest error along the trajectory, of pendulums that meet the wall in different parts of a step,
/// halves with the step: through an impact and after it.
#[test]
fn the_steps_of_joints_and_contact_are_of_order_one_along_the_trajectory_in_the_plane() {
    order_one_along_the_trajectory(2);
}

#[test]
fn the_steps_of_joints_and_contact_are_of_order_one_along_the_trajectory_in_space() {
    order_one_along_the_trajectory(3);
}

fn order_one_along_the_trajectory(dimension: usize) {
    let at = |angle: f64, step: f64| {
        let run = run(&pendulum_from(angle, dimension, 0.6, step, 0.96));
        let every = (0.032 / step).round() as usize;
        let samples = (0..run.times().len()).step_by(every);
        samples.flat_map(|sample| run.positions(sample)[..2].to_vec()).collect::<Vec<f64>>()
    };
    let steps = [3.2e-3, 1.6e-3, 8e-4, 4e-4, 2e-4];
    let mut errors = [0.0_f64; 5];
    for angle in [0.4, 0.46, 0.52] {
        let exact = at(angle, 4e-5);
        for (error, &step) in errors.iter_mut().zip(&steps) {
            let run = at(angle, step);
            let off = run.iter().zip(&exact).map(|(a, b)| (a - b).abs());
            *error = off.fold(*error, f64::max);
        }
    }
    let order = (errors[0] / errors[4]).log2() / 4.0;
    assert!((0.8..1.3).contains(&order), "{order} of {errors:?}");
    let summary = run(&pendulum(dimension, 0.6, 1e-3, 1.0)).summary().to_string();
    assert!(summary.contains("of order 1"), "{summary}");
}

/// The momentum about the common centre that closing joints turns is of order one.
#[test]
fn the_angular_momentum_of_free_jointed_bodies_drifts_at_order_one() {
    let drift = |step: f64| {
        let text = format!(
            "{}bodies = [\
             {{ name = \"a\", mass = 2, box = [1, 0.2], position = [-0.5, 0], angular_velocity = 1 }},\
             {{ name = \"b\", mass = 3, box = [1, 0.2], position = [0.5, 0], velocity = [0, -1], \
             angular_velocity = -3 }}]\n\
             joints = [{{ kind = \"pin\", between = [\"a\", \"b\"], at = [0, 0] }}]\n\
             contact = {{ restitution = 0 }}\n\
             observables = [\"angular-momentum\"]\n",
            head(2, step, 1.0)
        );
        let text = text.replace("velocity = [0, -1]", "velocity = [0, -1.0]");
        let run = run(&text);
        let first = run.observed(0)[0];
        (0..run.times().len()).map(|k| (run.observed(k)[0] - first).abs()).fold(0.0, f64::max)
    };
    let drifts = [4e-3, 2e-3, 1e-3].map(drift);
    let order = (drifts[0] / drifts[2]).log2() / 2.0;
    assert!(drifts[2] < 1e-2 && (0.7..2.5).contains(&order), "{order} of {drifts:?}");
}

/// A motor turns a crank; its rod pushes a slider against a wall, which stops it: torque over arm.
#[test]
fn motors_loads_and_drag_act_where_bodies_touch_and_their_works_close_the_budget() {
    for drive in ["torque = 2", "speed = { ramp = [0, -3], to = 0.5 }"] {
        let text = format!(
            "{}bodies = [\
             {{ name = \"crank\", mass = 1, box = [0.2, 0.04], position = [0, 0.1], rotation = {} }},\
             {{ name = \"ball\", mass = 0.5, ball = 0.1, position = [0.6, 0.2] }}]\n\
             joints = [{{ kind = \"pin\", between = [\"world\", \"crank\"], at = [0, 0] }}]\n\
             motors = [{{ between = [\"world\", \"crank\"], {drive} }}]\n\
             loads = [{{ on = \"ball\", force = [-3, 0], strength = {{ ramp = [0, 1], to = 0.3 }} }}]\n\
             drag = {{ coefficient = 0.2 }}\n\
             contact = {{ restitution = 0.5, friction = 0.3 }}\n",
            head(2, 2e-4, 1.0),
            0.5 * PI
        );
        let run = scene(&text).run().unwrap();
        assert!(!run.contact_impulses().is_empty(), "{drive}");
        assert!(defect(&run) < 5e-3, "{}", run.summary());
        assert!(work(&run, "drag") < 0.0 && work(&run, "load on ball").abs() > 1e-2);
        let motor = match drive.starts_with("torque") {
            true => "motor between world and crank",
            false => "joints and motors with a speed",
        };
        assert!(work(&run, motor).abs() > 1e-2, "{:?}", run.works());
    }
}

/// A block pressed against the floor by a load: F mu holds it, and more than that slides it.
#[test]
fn a_load_that_presses_on_contact_is_no_impact() {
    let text = |push: f64| {
        format!(
            "{}bodies = [{{ name = \"block\", mass = 2, box = [1, 0.2], position = [0, 0.1] }}]\n\
             loads = [{{ on = \"block\", force = [{push}, -10] }}]\n\
             contact = {{ restitution = 0.9, friction = 0.5, walls = [{{ normal = [0, 1], at = [0, 0] }}] }}\n",
            head(2, 0.01, 1.0)
        )
    };
    let held = run(&text(4.9));
    assert_eq!(held.impacts().len(), 0);
    assert!(held.positions(100)[0].abs() < 1e-12, "{:?}", &held.positions(100)[..2]);
    let slides = run(&text(7.0));
    // a = (7 - 5)/2; semi-implicit steps are h/2 ahead.
    let x = slides.positions(100)[0];
    assert!((x - 0.5 * (1.0 + 0.01)).abs() < 1e-9, "{x}");
}

/// A slider-crank of which the crank's turn alone is given, by the angle from the dead centre: the rod's turn and
/// the slider's velocity are those of the closed form.
#[test]
fn a_mechanism_takes_the_velocities_that_its_crank_determines() {
    let (r, length, w) = (0.1_f64, 0.25_f64, 10.0);
    for angle in [0.0_f64, 0.4, 1.5, 2.9] {
        let (sin, cos) = angle.sin_cos();
        let lean = (r / length * sin).asin();
        let end = r * cos + length * lean.cos();
        let text = format!(
            "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.0001\nhorizon = 0.001\n\
             bodies = [\n\
             {{ name = \"crank\", mass = 0.2, box = [{r}, 0.01], position = [{}, {}], rotation = {angle}, \
             angular_velocity = {w} }},\n\
             {{ name = \"rod\", mass = 0.3, box = [{length}, 0.01], position = [{}, {}], rotation = {} }},\n\
             {{ name = \"slider\", mass = 0.5, box = [0.06, 0.04], position = [{end}, 0] }}]\n\
             joints = [\n\
             {{ kind = \"pin\", between = [\"world\", \"crank\"], at = [0, 0] }},\n\
             {{ kind = \"pin\", between = [\"crank\", \"rod\"], at = [{}, {}] }},\n\
             {{ kind = \"pin\", between = [\"rod\", \"slider\"], at = [{end}, 0] }},\n\
             {{ kind = \"slider\", between = [\"slider\", \"world\"], at = [{end}, 0], axis = [1, 0] }}]\n",
            0.5 * r * cos,
            0.5 * r * sin,
            r * cos + 0.5 * length * lean.cos(),
            0.5 * r * sin,
            -lean,
            r * cos,
            r * sin,
        );
        let scene = Scene::parse("crank.toml", &text).unwrap_or_else(|error| panic!("{error}"));
        let turning = -w * r * cos / (length * lean.cos());
        let speed = -w * r * sin + length * lean.sin() * turning;
        let [rod, slider] = [1, 2].map(|body| &scene.bodies()[body]);
        assert!((rod.angular_velocity[2] - turning).abs() < 1e-12, "{rod:?} {turning}");
        assert!((slider.velocity[0] - speed).abs() < 1e-12, "{slider:?} {speed}");
        assert!(slider.velocity[1].abs() < 1e-12 && slider.angular_velocity[2].abs() < 1e-12);
        scene.run().unwrap_or_else(|error| panic!("{error}"));
    }
}

/// At a dead centre the rod's end stands still as the sum of two velocities that cancel but for rounding.
#[test]
fn a_slider_crank_may_start_at_its_dead_centre() {
    for (r, length, w) in [(0.1, 0.25, 10.0), (0.3, 0.7, 7.0), (0.017, 0.11, 333.0)] {
        let text = format!(
            "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.0001\nhorizon = 0.001\n\
             bodies = [\n\
             {{ name = \"crank\", mass = 0.2, box = [{r}, 0.01], position = [{}, 0], angular_velocity = {w} }},\n\
             {{ name = \"rod\", mass = 0.3, box = [{length}, 0.01], position = [{}, 0], angular_velocity = {} }},\n\
             {{ name = \"slider\", mass = 0.5, box = [0.06, 0.04], position = [{end}, 0] }}]\n\
             joints = [\n\
             {{ kind = \"pin\", between = [\"world\", \"crank\"], at = [0, 0] }},\n\
             {{ kind = \"pin\", between = [\"crank\", \"rod\"], at = [{r}, 0] }},\n\
             {{ kind = \"pin\", between = [\"rod\", \"slider\"], at = [{end}, 0] }},\n\
             {{ kind = \"slider\", between = [\"slider\", \"world\"], at = [{end}, 0], axis = [1, 0] }}]\n",
            0.5 * r,
            r + 0.5 * length,
            -w * r / length,
            end = r + length,
        );
        let scene = Scene::parse("dead.toml", &text).unwrap_or_else(|error| panic!("{error}"));
        scene.run().unwrap_or_else(|error| panic!("{r} {length} {w}: {error}"));
    }
}
