//! Particles beside bodies, and springs, dampers and rods between them: closed forms, orders and momenta.

use stationary_scene::{Run, Scene};

fn run(text: &str) -> Run {
    let scene = Scene::parse("mixed.toml", text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let run = scene.run().unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(run.unsettled().steps, 0, "{}", run.summary());
    run
}

fn head(dimension: usize, step: f64, horizon: f64) -> String {
    let method = if dimension == 3 { "variational-rotation" } else { "stormer-verlet" };
    format!(
        "dimension = {dimension}\nintegrator = \"{method}\"\nstep = {step}\nhorizon = {horizon}\n"
    )
}

fn vector(dimension: usize, x: f64, y: f64) -> String {
    if dimension == 3 { format!("[{x}, {y}, 0]") } else { format!("[{x}, {y}]") }
}

fn sides(dimension: usize) -> &'static str {
    if dimension == 3 { "[0.4, 0.2, 0.3]" } else { "[0.4, 0.2]" }
}

/// What the energy's change and the works differ by, over the largest kinetic energy.
fn defect(run: &Run) -> f64 {
    let energies = run.energies();
    let change = energies[energies.len() - 1] - energies[0];
    let works: f64 = run.works().iter().map(|(_, work)| work).sum();
    let kinetic = run.kinetic_energies().iter().copied().fold(0.0, f64::max);
    (change - works).abs() / kinetic
}

/// The place of what has this name at a sample.
fn place(run: &Run, name: &str, sample: usize) -> Vec<f64> {
    let d = run.scene().dimension();
    let index = run.scene().particles().iter().position(|p| p.name == name).unwrap();
    run.positions(sample)[d * index..][..d].to_vec()
}

/// A box and a particle on a spring along the line of their centres: x = A cos(w t) about the mean,
/// w^2 = k (1/m + 1/M). With contact the steps are of order 1, without of order 2.
#[test]
fn a_particle_on_a_spring_to_a_body_swings_with_the_reduced_mass() {
    let (k, m, big) = (40.0, 0.5, 2.0);
    let w = f64::sqrt(k * (1.0 / m + 1.0 / big));
    for dimension in [2, 3] {
        for (contact, order) in [("", 2.0), ("contact = { restitution = 0 }\n", 1.0)] {
            let error = |step: f64| {
                let text = format!(
                    "{}bodies = [{{ name = \"box\", mass = {big}, box = {}, position = {} }}]\n\
                     particles = [{{ name = \"bead\", mass = {m}, position = {}, radius = 0.05 }}]\n\
                     springs = [{{ between = [\"box\", \"bead\"], stiffness = {k}, rest_length = 0.8 }}]\n\
                     observables = [\"energy\", \"linear-momentum\"]\n{contact}",
                    head(dimension, step, 1.0),
                    sides(dimension),
                    vector(dimension, 0.0, 0.0),
                    vector(dimension, 1.0, 0.0)
                );
                let run = run(&text);
                let mut worst = 0.0_f64;
                for (sample, &t) in run.times().iter().enumerate() {
                    let apart = place(&run, "bead", sample)[0] - place(&run, "box", sample)[0];
                    worst = worst.max((apart - 0.8 - 0.2 * (w * t).cos()).abs());
                    let momentum = &run.observed(sample)[1..];
                    assert!(momentum.iter().all(|p| p.abs() < 1e-12), "{momentum:?}");
                }
                worst
            };
            let (coarse, fine) = (error(2e-3), error(1e-3));
            let slope = (coarse / fine).log2();
            assert!((slope - order).abs() < 0.2, "{dimension} {contact}: {slope}, {coarse} {fine}");
        }
    }
}

/// A wheel on a damped spring to a place of the world: x = e^(-g t) (cos(w t) + g/w sin(w t)) A.
#[test]
fn a_body_on_a_damped_spring_comes_to_rest_as_the_closed_form_says() {
    let (k, c, m): (f64, f64, f64) = (90.0, 4.0, 1.5);
    let g = 0.5 * c / m;
    let w = (k / m - g * g).sqrt();
    let exact = |t: f64| 0.3 * (-g * t).exp() * ((w * t).cos() + g / w * (w * t).sin());
    for dimension in [2, 3] {
        for (contact, order) in [("", 2.0), ("contact = { restitution = 0 }\n", 1.0)] {
            let of = |step: f64| {
                let text = format!(
                    "{}bodies = [{{ name = \"hub\", mass = {m}, ball = 0.1, position = {} }}]\n\
                     particles = [{{ name = \"frame\", position = {}, pinned = true }}]\n\
                     springs = [{{ between = [\"frame\", \"hub\"], stiffness = {k}, damping = {c}, \
                     rest_length = 1 }}]\n{contact}",
                    head(dimension, step, 1.0),
                    vector(dimension, 1.3, 0.0),
                    vector(dimension, 0.0, 0.0)
                );
                let run = run(&text);
                let off = run
                    .times()
                    .iter()
                    .enumerate()
                    .map(|(sample, &t)| (place(&run, "hub", sample)[0] - 1.0 - exact(t)).abs());
                let damper = run
                    .works()
                    .into_iter()
                    .find(|(name, _)| name == "damper between frame and hub");
                assert!(damper.unwrap().1 < -0.1, "{:?}", run.works());
                (off.fold(0.0, f64::max), defect(&run))
            };
            let ((coarse, _), (fine, left)) = (of(2e-3), of(1e-3));
            let slope = (coarse / fine).log2();
            assert!((slope - order).abs() < 0.2, "{dimension} {contact}: {slope}, {coarse} {fine}");
            assert!(left < 1e-2, "{dimension} {contact}: {left}");
        }
    }
}

/// Damped springs between particles alone, by every kind of method that takes forces.
#[test]
fn a_damped_spring_of_particles_follows_its_closed_form_by_every_method() {
    let (k, c, m): (f64, f64, f64) = (90.0, 4.0, 1.5);
    let g = 0.5 * c / m;
    let w = (k / m - g * g).sqrt();
    let exact = 1.0 + 0.3 * (-g).exp() * (w.cos() + g / w * w.sin());
    for method in [
        "\"stormer-verlet\"",
        "\"newmark\"",
        "\"generalized-alpha\"",
        "\"implicit-midpoint\"",
        "\"dormand-prince-853\"\ntolerance = 1e-10",
        "\"radau-iia-5\"\ntolerance = 1e-8",
    ] {
        let text = format!(
            "dimension = 1\nintegrator = {method}\nstep = 0.002\nhorizon = 1\n\
             particles = [{{ name = \"wall\", position = [0], pinned = true }},\n\
             {{ name = \"mass\", position = [1.3], mass = {m} }}]\n\
             springs = [{{ between = [\"wall\", \"mass\"], stiffness = {k}, damping = {c}, rest_length = 1 }}]\n"
        );
        let run = run(&text);
        let x = place(&run, "mass", run.times().len() - 1)[0];
        assert!((x - exact).abs() < 2e-5, "{method}: {}", x - exact);
        assert!(defect(&run) < 1e-3, "{method}: {}", defect(&run));
    }
}

/// A particle hits the middle of a box: v' = v (m - M)/(m + M), and 2 m v/(m + M) of the box.
#[test]
fn a_particle_that_hits_a_body_rebounds_as_two_masses_do() {
    let (m, big, v): (f64, f64, f64) = (0.5, 2.0, 3.0);
    for dimension in [2, 3] {
        let text = format!(
            "{}bodies = [{{ name = \"box\", mass = {big}, box = {}, position = {} }}]\n\
             particles = [{{ name = \"bead\", mass = {m}, position = {}, velocity = {}, radius = 0.05 }},\n\
             {{ name = \"post\", position = {}, pinned = true, radius = 0.1 }}]\n\
             observables = [{{ velocity = \"bead\" }}, {{ velocity = \"box\" }}]\n\
             contact = {{ restitution = 1, friction = 0.9 }}\n",
            head(dimension, 1e-3, 0.5),
            sides(dimension),
            vector(dimension, 0.0, 0.0),
            vector(dimension, -0.5, 0.0),
            vector(dimension, v, 0.0),
            vector(dimension, 9.0, 0.0)
        );
        let run = run(&text);
        let last = run.observed(run.times().len() - 1);
        assert!((last[0] - v * (m - big) / (m + big)).abs() < 1e-9, "{last:?}");
        assert!((last[dimension] - 2.0 * m * v / (m + big)).abs() < 1e-9, "{last:?}");
        let between = run.contact_impulses()[0].between.map(|side| side.name(run.scene()));
        assert_eq!(between, ["box", "bead"]);
    }
}

/// A particle without a radius is a point: it rebounds where it is at the surface of a wall and of a body, and passes
/// through another point, as it does where there are particles alone.
#[test]
fn a_point_enters_nothing_that_has_a_size_and_passes_through_points() {
    let (m, big, v): (f64, f64, f64) = (0.5, 2.0, 3.0);
    for dimension in [2, 3] {
        let text = format!(
            "{}bodies = [{{ name = \"box\", mass = {big}, box = {}, position = {} }}]\n\
             particles = [{{ name = \"one\", mass = {m}, position = {}, velocity = {} }},\n\
             {{ name = \"left\", mass = 1, position = {}, velocity = {} }},\n\
             {{ name = \"right\", mass = 1, position = {}, velocity = {} }},\n\
             {{ name = \"low\", mass = 1, position = {}, velocity = {} }}]\n\
             observables = [{{ velocity = \"one\" }}, {{ velocity = \"box\" }}]\n\
             contact = {{ restitution = 1, walls = [{{ normal = {}, at = {} }}] }}\n",
            head(dimension, 1e-3, 0.5),
            sides(dimension),
            vector(dimension, 0.0, 0.0),
            vector(dimension, -0.5, 0.0),
            vector(dimension, v, 0.0),
            vector(dimension, 4.0, 1.0),
            vector(dimension, 1.0, 0.0),
            vector(dimension, 4.25, 1.0),
            vector(dimension, -1.0, 0.0),
            vector(dimension, 8.0, -1.0),
            vector(dimension, 0.0, -4.0),
            vector(dimension, 0.0, 1.0),
            vector(dimension, 0.0, -2.0),
        );
        let run = run(&text);
        let last = run.times().len() - 1;
        let observed = run.observed(last);
        assert!((observed[0] - v * (m - big) / (m + big)).abs() < 1e-9, "{observed:?}");
        assert!((observed[dimension] - 2.0 * m * v / (m + big)).abs() < 1e-9, "{observed:?}");
        assert!((place(&run, "left", last)[0] - 4.5).abs() < 1e-9);
        assert!((place(&run, "right", last)[0] - 3.75).abs() < 1e-9);
        // It turns back at the wall, within two steps.
        let back = place(&run, "low", last)[1] + 1.0;
        assert!(back.abs() < 4.0 * 4.0 * 1e-3, "{back}");
        let lowest = (0..=last).map(|k| place(&run, "low", k)[1]).fold(0.0, f64::min);
        assert!((-2.0 - 1e-8..-1.99).contains(&lowest), "{lowest}");
    }
}

/// A chain of points falls on a floor beside a body and lies on it, as long as it was.
#[test]
fn a_chain_of_points_comes_to_lie_on_a_floor() {
    for dimension in [2, 3] {
        let bodies = format!(
            "bodies = [{{ name = \"far\", mass = 1, box = {}, position = {} }}]\n",
            sides(dimension),
            vector(dimension, 9.0, 5.0)
        );
        for bodies in [bodies.as_str(), ""] {
            let text = format!(
                "{}uniform_gravity = {{ acceleration = {} }}\n{bodies}\
                 particles = [{{ name = \"a\", mass = 0.1, position = {}, radius = 0.05 }},\n\
                 {{ name = \"b\", mass = 0.1, position = {} }}]\n\
                 chains = [{{ name = \"chain\", between = [\"a\", \"b\"], links = 5, particle_mass = 0.1 }}]\n\
                 contact = {{ walls = [{{ normal = {}, at = {} }}] }}\n",
                head(dimension, 1e-3, 0.5),
                vector(dimension, 0.0, -10.0),
                vector(dimension, 0.0, 0.4),
                vector(dimension, 1.0, 0.5),
                vector(dimension, 0.0, 1.0),
                vector(dimension, 0.0, 0.0),
            );
            let run = run(&text);
            let last = run.times().len() - 1;
            for link in 1..5 {
                let height = place(&run, &format!("chain.{link}"), last)[1];
                assert!((-1e-6..0.05).contains(&height), "{link}: {height}");
            }
            for rod in run.scene().rods() {
                let [a, b] = rod.ends.map(|end| run.scene().particles()[end].name.clone());
                let (a, b) = (place(&run, &a, last), place(&run, &b, last));
                let length = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
                assert!((length / rod.length - 1.0).abs() < 1e-6, "{length}");
            }
        }
    }
}

/// Friction does not turn a particle, which is a point: it slides down a slope as without friction.
#[test]
fn a_particle_has_no_friction_and_never_turns() {
    let text = format!(
        "{}uniform_gravity = {{ acceleration = [0, -9.81] }}\n\
         bodies = [{{ name = \"far\", mass = 1, box = [1, 1], position = [50, 50] }}]\n\
         particles = [{{ name = \"bead\", mass = 0.3, position = [0, 0.05], radius = 0.05 }}]\n\
         contact = {{ friction = 0.8, walls = [{{ normal = [0.6, 0.8], at = [0, 0] }}], \
         touching = [[\"bead\", \"slope\"]] }}\n",
        head(2, 1e-3, 1.0)
    )
    .replace("walls = [{ normal", "walls = [{ name = \"slope\", normal");
    let run = run(&text);
    let last = run.times().len() - 1;
    let (from, to) = (place(&run, "bead", 0), place(&run, "bead", last));
    let way = (to[0] - from[0]).hypot(to[1] - from[1]);
    // s = g sin(slope) t^2/2, semi-implicit.
    let exact = 0.5 * 9.81 * 0.6 * (1.0 + 1e-3);
    assert!((way - exact).abs() < 1e-6, "{way} {exact}");
    assert!(run.bodies(last)[1].angular_velocity[2].abs() < 1e-12);
}

/// A rod from a pin to a particle beside a body is the pendulum of the same rod alone.
#[test]
fn rods_beside_bodies_hold_as_rods_alone_do_with_the_same_tension() {
    let bob = "particles = [{ name = \"hook\", position = [0, 0], pinned = true },\n\
               { name = \"bob\", mass = 0.7, position = [1, 0] }]\n\
               rods = [{ between = [\"hook\", \"bob\"] }]\n\
               uniform_gravity = { acceleration = [0, -9.81] }\n\
               observables = [\"energy\", { tension = [\"hook\", \"bob\"] }]\n";
    let far = "bodies = [{ name = \"far\", mass = 1, box = [1, 1], position = [50, 50] }]\n";
    let head = "dimension = 2\nintegrator = \"METHOD\"\nstep = 0.001\nhorizon = 1\n";
    let alone = run(&(head.replace("METHOD", "rattle") + bob));
    let beside = run(&(head.replace("METHOD", "stormer-verlet") + bob + far));
    for sample in (0..alone.times().len()).step_by(50) {
        let [a, b] = [&alone, &beside].map(|run| place(run, "bob", sample));
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9, "{sample}: {a:?} {b:?}");
        let [a, b] = [&alone, &beside].map(|run| run.observed(sample)[1]);
        assert!((a - b).abs() < 1e-6 * (1.0 + a.abs()), "{sample}: {a} {b}");
    }
}

/// Three balls on rods: the first swings in, and the last swings out as high.
#[test]
fn particles_on_rods_that_touch_pass_on_a_blow() {
    for dimension in [2, 3] {
        let mut particles = String::new();
        let mut rods = String::new();
        for k in 0..3 {
            let x = 0.1 * k as f64;
            let (bx, by) = if k == 0 { (x - 0.5_f64.sin(), -(0.5_f64.cos())) } else { (x, -1.0) };
            particles += &format!(
                "[[particles]]\nname = \"hook{k}\"\npinned = true\nposition = {}\n\
                 [[particles]]\nname = \"ball{k}\"\nmass = 0.2\nradius = 0.05\nposition = {}\n",
                vector(dimension, x, 0.0),
                vector(dimension, bx, by)
            );
            rods += &format!("[[rods]]\nbetween = [\"hook{k}\", \"ball{k}\"]\n");
        }
        let text = format!(
            "{}uniform_gravity = {{ acceleration = {} }}\nobservables = [\"energy\", {{ position = \"ball2\" }}]\n\
             contact = {{ restitution = 1, law = \"gauss-seidel\" }}\n{particles}{rods}",
            head(dimension, 2e-4, 1.1),
            vector(dimension, 0.0, -9.81)
        );
        let run = run(&text);
        let highest =
            (0..run.times().len()).map(|k| run.observed(k)[2]).fold(f64::NEG_INFINITY, f64::max);
        assert!(
            (highest + 0.5_f64.cos()).abs() < 2e-3,
            "{dimension}: {highest} {}",
            -0.5_f64.cos()
        );
    }
}

/// A disc on a hinge with a spring: w^2 = k/I; damped it decays as e^(-c t/2I).
#[test]
fn a_spring_and_a_damper_at_a_joint_turn_a_disc_as_the_closed_form_says() {
    let (k, c, moment): (f64, f64, f64) = (3.0, 0.05, 2.0 * 0.25 * 0.5);
    let g = 0.5 * c / moment;
    let w = (k / moment - g * g).sqrt();
    // Turned from its rest by -0.4, from rest.
    let exact = |t: f64| -0.4 * (-g * t).exp() * ((w * t).cos() + g / w * (w * t).sin());
    for dimension in [2, 3] {
        let (joint, shape, turn) = match dimension {
            3 => ("kind = \"hinge\", axis = [0, 0, 1], ", "moments = [0.2, 0.2, 0.25]", 2),
            _ => ("kind = \"pin\", ", "ball = 0.5", 0),
        };
        for (contact, order) in [("", 2.0), ("contact = { restitution = 0 }\n", 1.0)] {
            // What touches has a shape.
            let shape = if dimension == 3 && !contact.is_empty() {
                "ball = 0.5590169943749475"
            } else {
                shape
            };
            let error = |step: f64| {
                let text = format!(
                    "{}bodies = [{{ name = \"disc\", mass = 2, {shape}, position = {} }}]\n\
                     joints = [{{ {joint}between = [\"world\", \"disc\"], at = {}, stiffness = {k}, \
                     damping = {c}, rest = 0.4 }}]\n\
                     observables = [{{ angular_velocity = \"disc\" }}]\n{contact}",
                    head(dimension, step, 1.0),
                    vector(dimension, 0.0, 0.0),
                    vector(dimension, 0.0, 0.0)
                );
                let run = run(&text);
                let n = run.times().len();
                // Trapezoids of the angular velocity.
                let mut angle = -0.4;
                let mut worst = 0.0_f64;
                for sample in 1..n {
                    let [a, b] = [sample - 1, sample].map(|s| run.observed(s)[turn]);
                    angle += 0.5 * step * (a + b);
                    worst = worst.max((angle - exact(run.times()[sample])).abs());
                }
                worst
            };
            let (coarse, fine) = (error(4e-3), error(2e-3));
            let slope = (coarse / fine).log2();
            assert!((slope - order).abs() < 0.3, "{dimension} {contact}: {slope} {coarse} {fine}");
        }
    }
}

#[test]
fn a_particle_beside_a_body_has_its_velocity_in_a_table_and_points_of_the_body_have_not() {
    let text = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.5\nhorizon = 1\n\
                particles = [{ name = \"p\", mass = 1, position = [0, 0], velocity = [1, 2] }]\n\
                bodies = [{ name = \"b\", mass = 1, box = [1, 1], position = [5, 0] }]";
    let run = Scene::parse("a.toml", text).unwrap().run().unwrap();
    let out = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("beside");
    run.write(&out).unwrap();
    let table = std::fs::read_to_string(out.join("velocity.csv")).unwrap();
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert_eq!(rows, ["0.0,p,1.0,2.0", "0.5,p,1.0,2.0", "1.0,p,1.0,2.0"]);
}
