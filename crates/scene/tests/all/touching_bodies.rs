//! Rigid bodies of scenes that touch, and bodies of other shapes than boxes.

use stationary_scene::{BodyShape, Run, Scene};

fn shipped(name: &str) -> Scene {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/");
    Scene::read(format!("{scenes}{name}.toml")).unwrap_or_else(|error| panic!("{error}"))
}

fn place(run: &Run, sample: usize, name: &str) -> Vec<f64> {
    let d = run.scene().dimension();
    let index = run.scene().particles().iter().position(|p| p.name == name).unwrap();
    run.positions(sample)[d * index..d * (index + 1)].to_vec()
}

#[test]
fn the_block_slides_down_the_slope_as_coulomb_says() {
    let run = shipped("block-on-incline").run().unwrap();
    let (sin, cos) = (0.5, 0.75_f64.sqrt());
    let way = |sample: usize| {
        let (x, start) = (place(&run, sample, "block"), place(&run, 0, "block"));
        -((x[0] - start[0]) * cos + (x[2] - start[2]) * sin)
    };
    let acceleration = 9.81 * (sin - 0.4 * cos);
    let h = run.scene().timing().step();
    for (sample, t) in run.times().iter().enumerate() {
        // Kick and drift: the sum of v over the steps.
        let expected = 0.5 * acceleration * t * (t + h);
        assert!((way(sample) - expected).abs() < 1e-6, "{t}: {} and {expected}", way(sample));
    }
}

#[test]
fn the_block_stays_where_friction_is_larger_than_the_slope() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/block-on-incline.toml");
    let text = std::fs::read_to_string(path).unwrap().replace("friction = 0.4", "friction = 0.6");
    let run = Scene::parse("slope.toml", &text).unwrap().run().unwrap();
    let (start, end) = (place(&run, 0, "block"), place(&run, run.times().len() - 1, "block"));
    assert!((0..3).all(|c| (start[c] - end[c]).abs() < 1e-9), "{start:?} {end:?}");
}

#[test]
fn what_rests_in_a_stack_stays_until_something_falls_onto_it() {
    let scene = shipped("box-stack").with_horizon(0.3).unwrap();
    let run = scene.run().unwrap_or_else(|error| panic!("{error}"));
    for name in ["box1", "box4", "box8"] {
        let (start, end) = (place(&run, 0, name), place(&run, run.times().len() - 1, name));
        assert!((0..3).all(|c| (start[c] - end[c]).abs() < 1e-8), "{name}: {start:?} {end:?}");
    }
}

/// What all but rests is pushed about by less than a kick is rounded to, for as long as nobody says
/// that this is rest.
#[test]
fn a_stack_that_was_hit_comes_to_rest_at_other_steps_as_well() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/box-stack.toml");
    let text = std::fs::read_to_string(path).unwrap();
    for step in ["step = 0.005", "step = 0.01"] {
        let scene = Scene::parse("stack.toml", &text.replace("step = 0.005", step)).unwrap();
        let run = scene.run().unwrap_or_else(|error| panic!("{step}: {error}"));
        let [before, end] = [1, 2].map(|back| place(&run, run.times().len() - back, "falling"));
        let moved = (0..3).map(|c| (end[c] - before[c]).abs()).fold(0.0, f64::max);
        assert!(moved < 1e-6, "{step}: {moved}");
    }
}

#[test]
fn the_wrench_flies_a_parabola_and_keeps_its_spin() {
    let run = shipped("tumbling-wrench").run().unwrap();
    let t = run.times()[run.times().len() - 1];
    let end = place(&run, run.times().len() - 1, "wrench");
    assert!((end[0] - 0.9 * t).abs() < 1e-12, "{end:?}");
    assert!((end[1] - (3.0 * t - 0.5 * 9.81 * t * t)).abs() < 1e-11, "{end:?}");
    let BodyShape::Polygon(corners) = &run.scene().bodies()[0].shape else { panic!("a polygon") };
    // Its corners are about the centre of mass: the outline's first moments vanish.
    let next = |i: usize| corners[(i + 1) % corners.len()];
    let (mut area, mut first) = (0.0, [0.0; 2]);
    for (i, a) in corners.iter().enumerate() {
        let b = next(i);
        let cross = a[0] * b[1] - a[1] * b[0];
        area += 0.5 * cross;
        (0..2).for_each(|c| first[c] += cross * (a[c] + b[c]) / 6.0);
    }
    assert!(area > 0.0 && first.iter().all(|m| (m / area).abs() < 1e-15), "{first:?}");
}

#[test]
fn discs_and_balls_have_the_moments_of_their_kind() {
    let moment = |dimension: usize, place: &str, integrator: &str| {
        let text = format!(
            "dimension = {dimension}\nintegrator = \"{integrator}\"\nstep = 0.1\nhorizon = 1\n\
             bodies = [{{ name = \"it\", mass = 5, ball = 2, position = {place} }}]\n"
        );
        Scene::parse("ball.toml", &text).unwrap().bodies()[0].moments
    };
    assert_eq!(moment(2, "[0, 0]", "stormer-verlet"), [0.0, 0.0, 10.0]);
    assert_eq!(moment(3, "[0, 0, 0]", "exact-rotation"), [8.0; 3]);
}

#[test]
fn bodies_that_cannot_touch_or_have_no_shape_are_refused() {
    let refused = |body: &str, contact: &str, message: &str| {
        let text = format!(
            "dimension = 3\nintegrator = \"exact-rotation\"\nstep = 0.1\nhorizon = 1\n\
             bodies = [{{ name = \"it\", mass = 5, {body}, position = [0, 0, 0] }}]\n{contact}"
        );
        let error = Scene::parse("a.toml", &text).expect_err(body).to_string();
        assert!(error.contains(message), "{error}\n\nexpected: {message}");
    };
    refused("ball = 0", "", "the radius is 0");
    refused("ball = 1, box = [1, 1, 1]", "", "needs one of");
    refused("polygon = [[0, 0], [1, 0], [0, 1]]", "", "a polygon needs a scene of dimension 2");
    refused("moments = [1, 1, 1]", "[contact]\n", "`it` has no shape that could touch");
    refused("ball = 1", "[contact]\n", "name `variational-rotation`");
    let flat = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n\
                bodies = [{ name = \"it\", mass = 5, position = [0, 0], polygon = CORNERS }]\n";
    for corners in
        ["[[0, 0], [1, 0]]", "[[0, 0], [1, 0], [2, 0]]", "[[0, 0], [1, 1], [1, 0], [0, 1]]"]
    {
        let error = Scene::parse("a.toml", &flat.replace("CORNERS", corners)).expect_err(corners);
        assert!(error.to_string().contains("not a simple polygon"), "{error}");
    }
}

#[test]
fn the_arch_settles_once_and_stands_with_friction_and_falls_with_less() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/masonry-arch.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let height = |friction: &str| {
        let scene = Scene::parse("arch.toml", &text.replace("friction = 0.6", friction)).unwrap();
        let run = scene.run().unwrap_or_else(|error| panic!("{error}"));
        let last = run.times().len() - 1;
        [0, last / 2, last].map(|sample| place(&run, sample, "stone8")[1])
    };
    let [start, middle, end] = height("friction = 0.6");
    assert!((start - middle).abs() < 1e-4, "it settles by {:e}", start - middle);
    assert!((middle - end).abs() < 1e-8, "and then stands: {:e}", middle - end);
    let [start, _, end] = height("friction = 0.25");
    assert!(start - end > 0.1, "{}", start - end);
}

#[test]
fn a_polygon_stays_where_it_is_drawn_and_nothing_else_goes_without_a_position() {
    let text = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n\
                bodies = [{ name = \"it\", mass = 5, polygon = [[1, 1], [4, 1], [1, 4]] }]\n";
    let scene = Scene::parse("a.toml", text).unwrap();
    assert_eq!(scene.bodies()[0].position, [2.0, 2.0, 0.0]);
    let box_text = text.replace("polygon = [[1, 1], [4, 1], [1, 4]]", "box = [1, 1]");
    let error = Scene::parse("a.toml", &box_text).unwrap_err().to_string();
    assert!(error.contains("`it` needs a `position`"), "{error}");
}

#[test]
fn the_falling_box_lands_and_everything_comes_to_rest() {
    let run = shipped("box-stack").run().unwrap_or_else(|error| panic!("{error}"));
    let kinetic = run.kinetic_energies();
    assert!(kinetic.iter().any(|energy| *energy > 5.0), "it falls");
    assert!(kinetic[kinetic.len() - 1] < 1e-9, "{:e}", kinetic[kinetic.len() - 1]);
    assert!(run.energies().windows(2).all(|pair| pair[1] < pair[0] + 1e-2), "nothing gains energy");
}

#[test]
fn a_polygon_has_the_moment_of_its_parts() {
    let moment = |corners: &str| {
        let text = format!(
            "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n\
             bodies = [{{ name = \"it\", mass = 6, polygon = {corners} }}]\n"
        );
        Scene::parse("polygon.toml", &text).unwrap().bodies()[0].moments[2]
    };
    // A rectangle of 3 x 2 is a box of m/12 (9 + 4), whichever way round it is drawn.
    for corners in ["[[1, 1], [4, 1], [4, 3], [1, 3]]", "[[1, 3], [4, 3], [4, 1], [1, 1]]"] {
        assert!((moment(corners) - 6.5).abs() < 1e-13, "{}", moment(corners));
    }
    // An L of a 2 x 1 and a 1 x 1 rectangle, 2 kg a square: centres (1, 1/2) and (1/2, 3/2), the whole's
    // (5/6, 5/6); each by the parallel-axis rule.
    let part = |mass: f64, sides: [f64; 2], centre: [f64; 2]| {
        let off = (centre[0] - 5.0 / 6.0).powi(2) + (centre[1] - 5.0 / 6.0).powi(2);
        mass * ((sides[0] * sides[0] + sides[1] * sides[1]) / 12.0 + off)
    };
    let expected = part(4.0, [2.0, 1.0], [1.0, 0.5]) + part(2.0, [1.0, 1.0], [0.5, 1.5]);
    let l = moment("[[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]");
    assert!((l - expected).abs() < 1e-13, "{l} and {expected}");
}

/// A block that slides on the floor and stops within a step: it goes v^2/(2 mu g) but for v h/2 of a method of
/// order 1, which are known to the last step, and then stays where it is to rounding.
#[test]
fn a_block_that_stops_within_a_step_goes_as_far_as_coulomb_says() {
    for dimension in [2, 3] {
        for (speed, friction, step) in [
            (1.3, 0.37, 0.01),
            (1.3, 0.37, 0.005),
            (0.2, 0.9, 0.01),
            (0.05, 0.8, 0.01),
            (3.0, 0.11, 0.0025),
        ] {
            let of =
                |plane: &str, space: &str| if dimension == 3 { space } else { plane }.to_owned();
            let method = of("stormer-verlet", "variational-rotation");
            let text = format!(
                "dimension = {dimension}\nintegrator = \"{method}\"\nstep = {step}\nhorizon = 4\n\
                 uniform_gravity = {{ acceleration = {} }}\n\
                 bodies = [{{ name = \"block\", mass = 2, box = {}, position = {}, velocity = [{speed}, 0{}] }}]\n\
                 contact = {{ friction = {friction}, walls = [{{ normal = {}, at = {} }}] }}\n",
                of("[0, -9.81]", "[0, 0, -9.81]"),
                of("[1, 0.2]", "[1, 0.6, 0.2]"),
                of("[0, 0.1]", "[0, 0, 0.1]"),
                of("", ", 0"),
                of("[0, 1]", "[0, 0, 1]"),
                of("[0, 0]", "[0, 0, 0]"),
            );
            let run =
                Scene::parse("block.toml", &text).unwrap_or_else(|e| panic!("{e}")).run().unwrap();
            let x = |sample: usize| run.positions(sample)[0];
            let last = run.times().len() - 1;
            let (a, v): (f64, f64) = (friction * 9.81, speed);
            // Whole steps at v - k a h, k = 1..n, and none in the step in which it stops.
            let n = (v / (a * step)).floor();
            let stepped = step * (n * v - a * step * n * (n + 1.0) / 2.0);
            let exact = v * v / (2.0 * a);
            assert!((x(last) - stepped).abs() < 1e-9, "{dimension}: {} {stepped}", x(last));
            assert!((x(last) - exact).abs() <= 0.5 * v * step + 1e-9, "{} {exact}", x(last));
            let stopped = (v / (a * step)).ceil() as usize + 1;
            assert!((x(stopped) - x(last)).abs() < 1e-15, "{dimension}");
        }
    }
}

#[test]
fn a_landing_without_restitution_is_shared_between_two_steps() {
    let place = |restitution: f64, step: f64| {
        let text = format!(
            "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = {step}\nhorizon = 0.3\n\
             uniform_gravity = {{ acceleration = [0, -9.81] }}\n\
             bodies = [{{ name = \"b\", mass = 3.8858, box = [0.8, 0.2], position = [2.2, 0.5],\n\
             velocity = [0.5922, -0.8927], angular_velocity = 1.668 }}]\n\
             [contact]\nfriction = 0.5\nrestitution = {restitution}\n\
             walls = [{{ normal = [0, 1], at = [0, 0] }}]\n"
        );
        let run = Scene::parse("landing.toml", &text).unwrap().run().unwrap();
        run.positions(run.times().len() - 1)[0]
    };
    let spread = |restitution: f64| {
        let places = [1e-3, 3e-4, 2e-4, 1e-4].map(|step| place(restitution, step));
        let [least, most] = [f64::min, f64::max].map(|by| places.into_iter().fold(places[0], by));
        most - least
    };
    // Friction turns around in the landing: what each of the two steps takes of it decides.
    assert!(spread(0.0) > 2e-3, "{}", spread(0.0));
    assert!(spread(0.01) < 1e-3, "{}", spread(0.01));
}
