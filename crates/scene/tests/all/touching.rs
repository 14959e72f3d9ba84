//! Contact in scenes: particles of a size, walls, fixed balls, and the law of impact.

use stationary_scene::{Impacts, Run, Scene};

fn shipped(name: &str) -> Scene {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/");
    Scene::read(format!("{scenes}{name}.toml")).unwrap_or_else(|error| panic!("{error}"))
}

fn drift(run: &Run) -> f64 {
    let energies = run.energies();
    energies.iter().map(|e| (e - energies[0]).abs()).fold(0.0, f64::max) / energies[0].abs()
}

fn ball(contact: &str, step: f64) -> Scene {
    let text = format!(
        "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = {step}\nhorizon = 1\n\
         uniform_gravity = {{ acceleration = [-10] }}\n\
         particles = [{{ name = \"ball\", mass = 2, radius = 0.5, position = [1.75] }}]\n\
         [contact]\n{contact}\nwalls = [{{ normal = [1], at = [0] }}]\n"
    );
    Scene::parse("ball.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_ball_rebounds_to_the_square_of_the_restitution() {
    // It falls 1.25 m in 0.5 s and rises for c 0.5 s: at c = 1/2 it is highest after 0.75 s.
    let run = ball("restitution = 0.5", 0.01).run().unwrap();
    let at = |time: f64| run.times().iter().position(|t| (t - time).abs() < 1e-9).unwrap();
    let height = run.positions(at(0.75))[0] - 0.5;
    assert!((height - 0.25 * 1.25).abs() < 1e-12, "{height}");
    let Impacts { time, count } = run.impacts()[0];
    assert!((time - 0.5).abs() < 1e-9 && count == 1, "{time} {count}");
}

#[test]
fn every_moment_of_impact_keeps_the_ball_out_or_nearly() {
    for (when, deepest) in
        [("at-the-instant", 1e-12), ("velocity-filter", 1e-12), ("after-overlap", 0.06)]
    {
        let run = ball(&format!("restitution = 0.9\nwhen = \"{when}\""), 0.01).run().unwrap();
        let lowest = (0..run.times().len()).map(|i| run.positions(i)[0]).fold(1.0, f64::min);
        assert!(lowest >= 0.5 - deepest, "{when}: {lowest}");
    }
}

#[test]
fn two_balls_of_the_cradle_come_in_and_two_go_out() {
    let run = shipped("newtons-cradle").run().unwrap();
    // What Stormer-Verlet leaves of the springs, (w h)^2/4, and nothing of the balls that rest.
    assert!(drift(&run) < 1e-4, "{:e}", drift(&run));
    let start = |name: &str| run.scene().particles().iter().position(|p| p.name == name).unwrap();
    let x = |sample: usize, name: &str| run.positions(sample)[2 * start(name)];
    // Half a period after the swing began, the two on the right are where the two on the left were.
    let period = 2.0 * std::f64::consts::PI / (1.962_f64 / 0.2).sqrt();
    let half = (0.5 * period / 0.01).round() as usize;
    for (name, expected) in
        [("ball1", -0.2), ("ball2", -0.1), ("ball3", 0.0), ("ball4", 0.4), ("ball5", 0.5)]
    {
        assert!((x(half, name) - expected).abs() < 2e-3, "{name}: {}", x(half, name));
    }
}

#[test]
fn the_break_keeps_energy_momentum_and_its_symmetry() {
    let run = shipped("nine-ball-break").run().unwrap();
    assert!(drift(&run) < 1e-14 && run.impacts().len() == 1, "{:e}", drift(&run));
    let (first, last) = (run.linear_momenta()[0], run.linear_momenta()[run.times().len() - 1]);
    assert!((0..2).all(|c| (first[c] - last[c]).abs() < 1e-11), "{first:?} {last:?}");
    let place = |name: &str| {
        let index = run.scene().particles().iter().position(|p| p.name == name).unwrap();
        let end = run.positions(run.times().len() - 1);
        [end[2 * index], end[2 * index + 1]]
    };
    for (left, right) in [("ball2", "ball3"), ("ball4", "ball6"), ("ball7", "ball8")] {
        let ([x, y], [mirrored, other]) = (place(left), place(right));
        assert!((x - mirrored).abs() < 1e-9 && (y + other).abs() < 1e-9, "{left} {right}");
    }
}

#[test]
fn the_cloth_stays_outside_of_the_ball() {
    let run = shipped("cloth-on-a-ball").with_horizon(0.3).unwrap().run().unwrap();
    for sample in 0..run.times().len() {
        for x in run.positions(sample).chunks_exact(3) {
            let distance = x.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!(distance >= 0.25 - 1e-12, "{distance}");
        }
    }
    let energies = run.energies();
    assert!(energies.windows(2).all(|pair| pair[1] < pair[0] + 1e-4), "nothing gains energy");
    assert!(run.impacts().len() > 10);
}

#[test]
fn contact_that_cannot_be_is_refused_where_it_says_so() {
    let refused = |contact: &str, message: &str| {
        let text = format!(
            "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n\
             particles = [{{ name = \"ball\", mass = 2, radius = 0.5, position = [1.75] }}]\n\
             [contact]\n{contact}\n"
        );
        let error = Scene::parse("a.toml", &text).expect_err(contact).to_string();
        assert!(error.contains(message), "{error}\n\nexpected: {message}");
    };
    refused("restitution = 1.5", "the restitution is 1.5");
    refused("friction = 0.5", "particles have no friction");
    refused("law = \"jacoby\"", "did you mean `jacobi`?");
    refused("when = \"after\"", "did you mean `after-overlap`?");
    refused("walls = [{ normal = [0], at = [0] }]", "the normal has no direction");
    refused("balls = [{ at = [0], radius = 0 }]", "the radius is 0");
    refused("balls = [{ at = [0], radius = 1.5 }]", "`ball` overlaps an obstacle by");
    let text = "dimension = 1\nintegrator = \"runge-kutta-4\"\nstep = 0.1\nhorizon = 1\n[contact]\n\
                [[particles]]\nname = \"a\"\nmass = 1\nposition = [0]\n";
    let error = Scene::parse("a.toml", text).unwrap_err().to_string();
    assert!(error.contains("cannot step what touches: name `stormer-verlet`"), "{error}");
}

#[test]
fn impacts_are_written_down_with_their_time() {
    let folder = std::env::temp_dir().join(format!("stationary-impacts-{}", std::process::id()));
    let run = ball("restitution = 0.5", 0.01).run().unwrap();
    run.write(&folder).unwrap();
    let events = std::fs::read_to_string(folder.join("events.csv")).unwrap();
    let mut lines = events.lines();
    assert_eq!(lines.next(), Some("time [s],impacts"));
    assert_eq!(lines.count(), run.impacts().len());
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn more_pairs_than_can_be_looked_at_are_refused_before_they_are_listed() {
    let mut text = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n\
                    [contact]\nrestitution = 1\n"
        .to_owned();
    for k in 0..3000 {
        text += &format!(
            "[[particles]]\nname = \"p{k}\"\nmass = 1\nradius = 0.1\nposition = [{k}, 0]\n"
        );
    }
    let error = Scene::parse("a.toml", &text).unwrap_err().to_string();
    assert!(error.contains("pairs that may touch"), "{error}");
}

#[test]
fn a_ball_on_a_stiff_spring_rebounds_like_a_ball_that_gets_impulses() {
    let height = |contact: &str| {
        let run = ball(contact, 1e-5).run().unwrap();
        assert!(drift(&run) < 1e-2, "{contact}: {:e}", drift(&run));
        run.positions(run.times().len() - 1)[0]
    };
    let impulse = height("restitution = 1");
    let off = |stiffness: &str| (height(&format!("stiffness = {stiffness}")) - impulse).abs();
    // It is late by the time of touch, pi sqrt(m/k), and at its highest where it should be: g/2 of
    // that time squared is missing, a tenth at ten times the stiffness.
    let [soft, stiff] = [off("2e4"), off("2e5")];
    assert!((soft / 4.9e-3 - 1.0).abs() < 0.1, "{soft:e}");
    assert!(soft > 7.0 * stiff && soft < 14.0 * stiff, "{soft:e} {stiff:e}");
}

#[test]
fn springs_of_touch_have_nothing_of_impulses() {
    let refused = |contact: &str, said: &str| {
        let text = format!(
            "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n\
             particles = [{{ name = \"ball\", mass = 2, radius = 0.5, position = [1.75] }}]\n\
             [contact]\n{contact}\nwalls = [{{ normal = [1], at = [0] }}]\n"
        );
        let error = Scene::parse("ball.toml", &text).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    };
    refused("stiffness = 1\nlaw = \"jacobi\"", "`law` cannot be combined");
    refused("stiffness = 1\nwhen = \"at-the-instant\"", "`when` cannot be combined");
    refused("restitution = 1\nstiffness = 1", "`restitution` cannot be combined");
    refused("stiffness = 0", "the stiffness is 0");
}
