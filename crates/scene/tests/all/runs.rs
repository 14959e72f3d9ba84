//! What a run does and keeps: its samples, its invariants, its failures, its files.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use stationary_integrators::Method;
use stationary_measure::loglog_slope;
use stationary_scene::problems::{self, OUTER_SOLAR_SYSTEM, SPRING_NET, spring_net_scene};
use stationary_scene::{Adaptive, AssemblyError, Fault, Motion, Run, RunError, Scene, Stepping};

fn planets() -> Scene {
    Scene::parse("outer-solar-system.toml", OUTER_SOLAR_SYSTEM).unwrap()
}

fn net() -> Scene {
    Scene::parse("spring-net.toml", SPRING_NET).unwrap()
}

/// A bob on a spring; its spring may be as stiff as the caller wants.
fn pendulum(step: f64, stiffness: f64) -> Scene {
    let text = format!(
        r#"
        title = "A bob on a spring"
        dimension = 2
        integrator = "stormer-verlet"
        step = {step}
        horizon = 3
        sample_every = 4
        observables = ["energy", {{ position = "bob" }}, {{ distance = ["hook", "bob"] }}]
        uniform_gravity = {{ acceleration = [0, -9.81] }}
        springs = [{{ between = ["bob", "hook"], stiffness = {stiffness} }}]

        [[particles]]
        name = "hook"
        position = [0.5, 1]
        pinned = true

        [[particles]]
        name = "bob"
        position = [1.5, 1]
        mass = 0.2
        "#
    );
    Scene::parse("pendulum.toml", &text).unwrap()
}

#[test]
fn two_runs_have_the_same_bits() {
    for scene in [planets().with_horizon(20_000.0).unwrap(), net(), pendulum(0.01, 50.0)] {
        let (one, two) = (scene.run().unwrap(), scene.run().unwrap());
        assert_eq!(one, two);
        assert_eq!(one.picture(), two.picture());
    }
}

#[test]
fn the_planets_keep_their_energy_and_momenta_for_550_years() {
    let run = planets().run().unwrap();
    let energies = run.energies();
    let drift = energies.iter().map(|e| (e / energies[0] - 1.0).abs()).fold(0.0, f64::max);
    assert!(drift < 1e-5, "{drift}");
    let (first, last) = (run.linear_momenta()[0], run.linear_momenta()[run.times().len() - 1]);
    for c in 0..3 {
        assert!((first[c] - last[c]).abs() < 1e-11 * 6e-6);
    }
    let (first, last) = (run.angular_momenta()[0], run.angular_momenta()[run.times().len() - 1]);
    for c in 0..3 {
        assert!((first[c] - last[c]).abs() < 1e-11 * 6e-5);
    }
}

/// The mean year of a planet in days: the time of its whole turns about the sun, seen along the
/// third axis, over their number. A sample every 100 days leaves that much over the number in doubt.
fn year(run: &Run, planet: usize) -> f64 {
    let angle = |sample: usize| {
        let x = run.positions(sample);
        (x[3 * planet + 1] - x[1]).atan2(x[3 * planet] - x[0])
    };
    let (mut turned, mut turns, mut year) = (0.0, 0.0, f64::NAN);
    for sample in 1..run.times().len() {
        turned += (angle(sample) - angle(sample - 1)).rem_euclid(TAU);
        if turned >= TAU * (turns + 1.0) {
            turns += 1.0;
            year = run.times()[sample] / turns;
        }
    }
    year
}

#[test]
fn the_planets_years_are_those_of_the_almanac() {
    let run = planets().run().unwrap();
    // Sidereal periods in days from NASA's planetary fact sheets.
    let almanac = [4332.589, 10759.22, 30685.4, 60189.0, 90560.0];
    for (planet, days) in (1..).zip(almanac) {
        let measured = year(&run, planet);
        assert!((measured / days - 1.0).abs() < 2e-3, "{planet}: {measured} days, not {days}");
    }
}

#[test]
fn the_net_keeps_its_energy_and_its_pins() {
    let run = net().run().unwrap();
    let energies = run.energies();
    let kinetic = run.kinetic_energies().iter().copied().fold(0.0, f64::max);
    let drift = energies.iter().map(|e| (e - energies[0]).abs()).fold(0.0, f64::max);
    assert!(drift < 1e-4 * kinetic, "{}", drift / kinetic);

    let scene = run.scene();
    let pinned: Vec<usize> =
        (0..400).filter(|&p| scene.particles()[p].motion == Motion::Pinned).collect();
    assert_eq!(pinned, [0, 19]);
    for sample in 0..run.times().len() {
        let x = run.positions(sample);
        assert_eq!(x[..3], [0.0, 0.0, 0.0]);
        assert_eq!(x[57..60], [19.0 * 0.05, 0.0, 0.0]);
    }
    assert_eq!(scene.particles()[19].name, "net.0.19");
}

#[test]
fn the_net_falls_like_its_mirror_image() {
    // Until its folds have magnified rounding, what the left side does the right side does.
    let run = net().with_horizon(0.4).unwrap().run().unwrap();
    let x = run.positions(run.times().len() - 1);
    for row in 0..20 {
        for column in 0..10 {
            let at = |column: usize| &x[3 * (20 * row + column)..][..3];
            let (left, right) = (at(column), at(19 - column));
            assert!((left[0] + right[0] - 0.95).abs() < 1e-11);
            assert!((left[1] - right[1]).abs() < 1e-11 && (left[2] - right[2]).abs() < 1e-11);
        }
    }
}

#[test]
fn half_the_step_has_a_quarter_of_the_error() {
    let end = |step: f64| {
        let scene = planets().with_horizon(20_000.0).unwrap().with_step(step).unwrap();
        let run = scene.run().unwrap();
        run.positions(run.times().len() - 1).to_vec()
    };
    let truth = end(1.25);
    let error = |step| end(step).iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // The reference has 1/64 and 1/16 of the errors, hence the band.
    let ratio = error(10.0) / error(5.0);
    assert!((ratio - 63.0 / 15.0).abs() < 0.1, "{ratio}");
}

#[test]
fn samples_are_the_start_every_so_many_steps_and_the_end() {
    let run = pendulum(0.5, 1.0).run().unwrap();
    assert_eq!(run.times(), [0.0, 2.0, 3.0]);
    assert_eq!(run.positions(0), [0.5, 1.0, 1.5, 1.0]);
    assert_eq!(run.positions(3), [0.0; 0]);
    assert_eq!(run.observed(1).len(), run.headings().len());
    assert_eq!(run.observed(3), [0.0; 0]);
    assert_eq!(
        run.headings(),
        [
            "energy [kg m^2/s^2]",
            "position of bob x [m]",
            "position of bob y [m]",
            "distance hook to bob [m]",
        ]
    );
    assert_eq!(run.cost().steps, 6);
}

#[test]
fn a_watcher_sees_every_step_and_may_end_the_run() {
    let mut seen = Vec::new();
    let run = pendulum(0.01, 50.0).run_watched(|progress| {
        seen.push(progress.step);
        assert_eq!((progress.steps, progress.q.len()), (300, 2));
        if progress.step == 7 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!(seen, [1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(run.unwrap().times(), [0.0, 0.04, 0.07]);
}

#[test]
fn a_run_that_flies_apart_says_where_and_keeps_what_it_has() {
    // w = sqrt(k/m) = 70.7 per second: the limit is h = 2/w = 0.028 seconds.
    assert!(pendulum(0.02, 1000.0).run().is_ok());
    let scene = pendulum(0.25, 1e9);
    let Err(RunError::Interrupted(failure)) = scene.with_horizon(75.0).unwrap().run() else {
        panic!("the step is far beyond the limit of stability");
    };
    assert_eq!(failure.particle, "bob");
    let text = failure.to_string();
    assert!(text.starts_with(&format!("step {}, from t = {} s: the ", failure.step, failure.time)));
    assert!(text.contains("of `bob` is not finite, first in "), "{text}");
    let run = &failure.run;
    assert_eq!(*run.times().last().unwrap(), failure.time);
    assert_eq!(run.cost().steps, failure.step - 1);
    let out = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("scene-interrupted");
    run.write(&out).unwrap();
    let rows = std::fs::read_to_string(out.join("observables.csv")).unwrap().lines().count();
    assert_eq!(rows, 1 + run.times().len());
}

#[test]
fn a_failed_newton_step_names_the_particle_of_the_largest_acceleration() {
    // Two bodies fall onto each other: there, the function that the step minimizes has no minimum.
    let text = r#"
        dimension = 1
        integrator = "implicit-midpoint"
        step = 0.1
        horizon = 2
        newtonian_gravity = { constant = 1 }
        particles = [
            { name = "heavy", position = [0], mass = 1 },
            { name = "light", position = [1], mass = 1e-3 },
        ]
    "#;
    let Err(RunError::Interrupted(failure)) = Scene::parse("fall.toml", text).unwrap().run() else {
        panic!("no step leads through the other body");
    };
    assert_eq!((failure.step, failure.time), (11, 1.0));
    assert_eq!((failure.particle.as_str(), failure.coordinate), ("light", 0));
    assert_eq!(failure.run.times().len(), 11);
    let text = failure.to_string();
    assert!(text.starts_with("step 11, from t = 1 s: the implicit step was not solved: Newton's"));
    assert!(text.ends_with("; the largest acceleration is that of `light` in x"), "{text}");
    assert!(text.len() < 250, "{text}");
}

#[test]
fn a_pinned_particle_that_has_a_mass_attracts_and_stays() {
    // A planet on an ellipse of eccentricity 0.2 about a sun that is held, a period and a half: at its far end.
    // A hook without mass, through which the way leads, does nothing.
    let text = |method: &str, step: f64| {
        let horizon = 3.0 * std::f64::consts::PI / 2_f64.sqrt();
        format!(
            "dimension = 2\nintegrator = {method}\nstep = {:?}\nhorizon = {horizon:?}\n\
             newtonian_gravity = {{ constant = 0.5 }}\n\
             particles = [{{ name = \"sun\", position = [0.3, -0.4], mass = 4, pinned = true }},\n\
             {{ name = \"hook\", position = [-0.9, -0.4], pinned = true }},\n\
             {{ name = \"planet\", position = [1.1, -0.4], mass = 3, velocity = [0, {:?}] }}]\n",
            horizon / step,
            3_f64.sqrt(),
        )
    };
    let off = |method: &str, steps: f64| {
        let scene = Scene::parse("sun.toml", &text(method, steps)).unwrap();
        let run = scene.run().unwrap();
        let end = run.positions(run.times().len() - 1);
        assert_eq!(end[..2], [0.3, -0.4]);
        (end[4] + 0.9).hypot(end[5] + 0.4)
    };
    let errors = [200.0, 400.0, 800.0].map(|steps| (1.0 / steps, off("\"stormer-verlet\"", steps)));
    let order = loglog_slope(&errors).unwrap();
    assert!((order - 2.0).abs() < 0.1, "{order}: {errors:?}");
    // By its Hessian too.
    assert!(off("\"gauss-legendre-6\"", 100.0) < 1e-5);
    assert!(off("\"dormand-prince-853\"\ntolerance = 1e-10", 10.0) < 1e-7);
}

#[test]
fn implicit_methods_solve_large_scenes_with_sparse_matrices() {
    // 36 particles less two pins are 102 freedoms; 3 x 3 less two are 21, which are solved densely.
    for size in [3, 6] {
        let scene = spring_net_scene(size, size).unwrap().with_horizon(0.08).unwrap();
        let explicit = scene.clone().with_step(1e-4).unwrap().run().unwrap();
        let implicit = scene.with_method(Method::ImplicitMidpoint).unwrap().run().unwrap();
        let end = |run: &Run| run.positions(run.times().len() - 1).to_vec();
        for (a, b) in end(&explicit).iter().zip(&end(&implicit)) {
            assert!((a - b).abs() < 1e-4, "{a} and {b}");
        }
        assert!(implicit.cost().hessians >= implicit.cost().steps);
    }
}

#[test]
fn every_method_runs_every_dimension() {
    for &method in Method::ALL {
        for (position, velocity) in
            [("[0]", "[1]"), ("[0, 0]", "[1, 0]"), ("[0, 0, 0]", "[1, 0, 0]")]
        {
            let dimension = velocity.matches(char::is_numeric).count();
            let text = format!(
                "dimension = {dimension}\nintegrator = \"{method}\"\nstep = 0.5\nhorizon = 2\n\
                 particles = [{{ name = \"a\", mass = 2, position = {position}, velocity = {velocity} }}]"
            );
            let run = Scene::parse("free", &text).unwrap().run().unwrap();
            let end = run.positions(run.times().len() - 1);
            assert!((end[0] - 2.0).abs() < 1e-12, "{method}: {end:?}");
            assert!(run.picture().ends_with("</svg>\n"));
        }
    }
}

#[test]
fn a_momentum_is_a_mass_times_a_velocity() {
    let with = |motion: &str| {
        let text = format!(
            "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = 1\nhorizon = 1\n\
             particles = [{{ name = \"a\", mass = 4, position = [0], {motion} }}]"
        );
        Scene::parse("a", &text).unwrap()
    };
    assert_eq!(with("velocity = [0.5]"), with("momentum = [2]"));
}

#[test]
fn another_step_is_sampled_at_the_same_times() {
    let scene = net();
    let finer = scene.clone().with_step(0.0004).unwrap();
    assert_eq!((scene.timing().sample_every(), finer.timing().sample_every()), (5, 10));
    assert_eq!(scene.timing().samples(), finer.timing().samples());
    assert!(matches!(net().with_step(0.3), Err(Fault::NotWhole { .. })));
    for step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(net().with_step(step), Err(Fault::NotPositive { .. })));
        assert!(matches!(net().with_horizon(step), Err(Fault::NotPositive { .. })));
    }
    assert!(matches!(net().with_step(8e-12), Err(Fault::TooMany { .. })));
}

#[test]
fn a_scene_is_a_problem_of_its_own_dimension() {
    let problem = planets().problem().unwrap();
    assert_eq!((problem.system.dim(), problem.horizon), (18, 200_000.0));
    assert_eq!(problem.initial.q[3..6], [-3.5023653, -3.8169847, -1.5507963]);
    let error = planets().constraint::<2>().unwrap_err();
    assert_eq!(error, AssemblyError::Dimension { scene: 3, asked: 2 });
}

#[test]
fn the_shipped_problems_have_names_and_periods() {
    let planets = problems::outer_solar_system().unwrap();
    assert_eq!((planets.name, planets.initial.q.len()), ("outer-solar-system", 18));
    assert!((planets.solution)(1.0).is_none());
    let net = problems::spring_net(20, 20).unwrap();
    assert_eq!((net.name, net.system.dim()), ("spring-net", 3 * 398));
    assert!((net.period - (0.0025_f64 / (8.0 * 400.0)).sqrt()).abs() < 1e-15);
    assert_eq!(problems::spring_net(2, 3).unwrap().system.dim(), 12);
    assert!(problems::spring_net(1, 3).is_err());
    assert_eq!(problems::spring_net(500, 400).unwrap().system.dim(), 3 * 199_998);
}

#[test]
fn the_net_is_unstable_above_the_step_that_its_comment_says() {
    // No frequency exceeds sqrt(8 k/m), so that 2/w is safe at rest; twice that is not.
    let limit = 2.0 * problems::spring_net(20, 20).unwrap().period;
    let steps = |h: f64| (0.8 / h).ceil();
    let with = |h: f64| net().with_step(0.8 / steps(h)).unwrap().run();
    assert!(with(0.7 * limit).is_ok());
    assert!(matches!(with(2.0 * limit), Err(RunError::Interrupted(_) | RunError::Stopped(_))));
}

#[test]
fn csv_files_have_a_heading_and_a_row_for_each_sample() {
    let out = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("scene-csv");
    let run = planets().with_horizon(1000.0).unwrap().run().unwrap();
    run.write(&out).unwrap();
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let trajectory = read("trajectory.csv");
    assert!(
        trajectory.starts_with("time [day],particle,x [au],y [au],z [au]\n0.0,sun,0.0,0.0,0.0\n")
    );
    assert_eq!(trajectory.lines().count(), 1 + 11 * 6);
    let observables = read("observables.csv");
    let columns = |line: &str| line.split(',').count();
    assert_eq!(observables.lines().count(), 1 + 11);
    assert!(observables.lines().all(|line| columns(line) == 1 + 1 + 3 + 3 + 2));
    assert!(observables.starts_with("time [day],energy [solar mass au^2/day^2],linear momentum x"));
    // Every number comes back with all its bits.
    let last: Vec<f64> =
        observables.lines().last().unwrap().split(',').map(|x| x.parse().unwrap()).collect();
    assert_eq!(last[1..], *run.observed(10));
}

#[test]
fn a_picture_shows_paths_names_springs_and_a_scale() {
    let picture = planets().with_horizon(10_000.0).unwrap().run().unwrap().picture();
    for part in [
        "<title>The outer solar system</title>",
        ">jupiter</text>",
        " au</text>",
        "prefers-color-scheme:dark",
    ] {
        assert!(picture.contains(part), "{part}");
    }
    assert!(!picture.contains("NaN") && !picture.contains("inf"));
    let picture = net().run().unwrap().picture();
    let springs = |tone: &str| format!("<path class=\"{tone} pen\" stroke-width=\"0.9\"");
    assert!(picture.contains(&springs("faint")) && picture.contains(&springs("strong")));
    assert_eq!(picture.matches("class=\"ref fill\"").count(), 3, "two pins and the legend's");
    assert!(!picture.contains("http://") || picture.matches("http").count() == 1, "no network");
}

#[test]
fn a_scene_too_large_to_draw_is_said_to_be() {
    let text = "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = 1\nhorizon = 1\nparticles = [\
                { name = \"a\", mass = 1, position = [1.7e308] },\
                { name = \"b\", mass = 1, position = [-1.7e308] }]";
    let picture = Scene::parse("far", text).unwrap().run().unwrap().picture();
    assert!(picture.contains("too large to draw") && !picture.contains("NaN"));
}

#[test]
fn a_test_of_a_scene_is_one_line() {
    insta::assert_snapshot!(pendulum(0.01, 50.0).run().unwrap().summary(), @r"
    A bob on a spring
    stormer-verlet, 300 of 300 steps of 0.01 s, to 3 s

    particles  pinned  springs  rods  elements  freedoms  differentials  hessians
    2          1       1        0     0         2         301            0

    invariant                    at the start  at the end  largest drift  relative to
    energy [kg m^2/s^2]          1.9620e0      1.9616e0    3.2e-4         the largest kinetic energy
    linear momentum [kg m/s]     0             7.9283e-1                  changed by gravity and the pins
    angular momentum [kg m^2/s]  0             4.6714e-1                  changed by gravity and the pins

    observable                at the start  at the end  least      largest
    energy [kg m^2/s^2]       1.962e0       1.962e0     1.961e0    1.962e0
    position of bob x [m]     1.500e0       1.092e0     -5.067e-1  1.507e0
    position of bob y [m]     1.000e0       7.443e-2    -1.163e-1  1.000e0
    distance hook to bob [m]  1.000e0       1.099e0     9.918e-1   1.117e0
    ");
}

#[test]
fn a_run_whose_energy_exceeds_the_range_of_doubles_is_an_error_that_says_so() {
    let heavy = Scene::parse(
        "heavy.toml",
        "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = 1\nhorizon = 4\n\
         particles = [{ name = \"a\", position = [0], mass = 1e304, velocity = [1e3] }]\n",
    );
    let error = heavy.unwrap().run().unwrap_err();
    let expected = "step 0, from t = 0 s: kinetic energy is not finite (got inf); where the \
                    motion grows without bound take a smaller step, else units in which it is \
                    smaller than 1e308";
    assert_eq!(error.to_string(), expected);
}

#[test]
fn a_point_of_a_body_that_leaves_the_range_of_doubles_is_an_error_that_names_it() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/thrown-racket.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let far = text.replace("[0.22, 0.12, 0]", "[1.7e308, 0, 1.7e308]");
    let error = Scene::parse(path, &far).unwrap().run().unwrap_err().to_string();
    assert!(error.contains("the position of `") && error.contains("is not finite"), "{error}");
}

#[test]
fn a_method_whose_number_is_out_of_range_and_rods_of_another_dimension_are_refused() {
    let scene = Scene::parse(
        "falling.toml",
        "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 1\nhorizon = 4\n\
         particles = [{ name = \"a\", position = [0, 0], mass = 1 }]\n",
    );
    let scene = scene.unwrap();
    for tolerance in [f64::NAN, 0.0, 1.0] {
        let adaptive = Stepping::Adaptive { method: Adaptive::DormandPrince853, tolerance };
        let refused = scene.clone().with_method(adaptive);
        assert!(matches!(refused, Err(Fault::Tolerance { .. })), "{tolerance}");
    }
    let none = scene.clone().with_method(Stepping::LinearModes { count: 0 });
    assert!(matches!(none, Err(Fault::NumberOfModes { modes: 0 })));
    assert!(matches!(scene.constraint::<3>(), Err(AssemblyError::Dimension { .. })));
}

#[test]
fn a_rod_bears_its_load_from_the_first_sample_on() {
    let beside = "bodies = [{ name = \"far\", mass = 1, box = [0.1, 0.1], position = [50, 0] }]";
    let floor = "contact = { walls = [{ normal = [0, 1], at = [0, -900] }] }";
    let cases = [
        ("rattle", String::new()),
        ("constrained-hamilton", String::new()),
        ("runge-kutta-4", String::new()),
        ("stormer-verlet", beside.to_owned()),
        ("stormer-verlet", format!("{beside}\n{floor}")),
        ("joint-coordinates", beside.to_owned()),
        ("dormand-prince-853", format!("tolerance = 1e-10\n{beside}")),
        ("error-controlled", format!("tolerance = 1e-6\n{beside}\n{floor}")),
    ];
    for (method, extra) in cases {
        // Let go at an angle of 1, and moving through the lowest place at 3 m/s.
        for (place, velocity, tension) in [
            ([1_f64.sin(), -1_f64.cos()], [0.0, 0.0], 20.0 * 1_f64.cos()),
            ([0.0, -1.0], [3.0, 0.0], 20.0 + 2.0 * 9.0),
        ] {
            let text = format!(
                "dimension = 2\nintegrator = \"{method}\"\nstep = 0.01\nhorizon = 0.05\n{extra}\n\
                 uniform_gravity = {{ acceleration = [0, -10] }}\n\
                 observables = [{{ tension = [\"hook\", \"bob\"] }}, {{ position = \"bob\" }}]\n\
                 particles = [{{ name = \"hook\", pinned = true, position = [0, 0] }}, \
                 {{ name = \"bob\", mass = 2, position = {place:?}, velocity = {velocity:?} }}]\n\
                 rods = [{{ between = [\"hook\", \"bob\"] }}]"
            );
            let run = Scene::parse("a.toml", &text).unwrap().run().unwrap();
            let first = run.observed(0);
            assert!((first[0] / tension - 1.0).abs() < 2e-3, "{method}: {first:?}, not {tension}");
            // The step that was taken for it is taken back.
            let moved = (0..2).any(|c| first[1 + c] != place[c]);
            assert!(!moved, "{method}: {first:?}, not {place:?}");
        }
    }
}
