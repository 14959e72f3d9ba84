//! Every field that a run leaves is what an independent computation says.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use stationary_scene::{Run, Scene, Simplices};

use crate::output::array;

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("fields").join(name);
    fs::remove_dir_all(&folder).ok();
    folder
}

fn shipped(name: &str) -> Scene {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    Scene::read(scenes.join(format!("{name}.toml"))).unwrap()
}

fn scene(text: &str) -> Scene {
    Scene::parse("fields.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

/// A table of a run: its headings, and its rows of words.
struct Sheet {
    headings: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Sheet {
    fn read(folder: &Path, name: &str) -> Sheet {
        let text = fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect());
        let headings: Vec<String> = lines.next().unwrap();
        let rows: Vec<Vec<String>> = lines.collect();
        assert!(rows.iter().all(|row| row.len() == headings.len()), "{name}");
        Sheet { headings, rows }
    }

    fn numbers(&self, row: usize, columns: std::ops::Range<usize>) -> Vec<f64> {
        self.rows[row][columns].iter().map(|cell| cell.parse().unwrap()).collect()
    }
}

/// The run of a scene, written with everything.
fn written(scene: &Scene, name: &str) -> (Run, PathBuf) {
    let (run, out) = (scene.run().unwrap(), folder(name));
    run.write(&out).unwrap();
    run.write_vtk(&out).unwrap();
    (run, out)
}

fn vtu(out: &Path, sample: usize) -> String {
    fs::read_to_string(out.join(format!("trajectory/{sample:06}.vtu"))).unwrap()
}

fn files(out: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(out)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".csv"))
        .collect();
    names.sort();
    names
}

fn close(a: &[f64], b: &[f64], tolerance: f64) {
    assert_eq!(a.len(), b.len());
    let off = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off <= tolerance, "{off:e} > {tolerance:e}: {a:?} {b:?}");
}

const PLATE: &str = r#"
    dimension = 2
    integrator = "crank-nicolson"
    step = 0.01
    horizon = 5
    sample_every = 100
    observables = [{ temperature = "plate.middle" }]
    [heat]
    name = "plate"
    shape = { kind = "rectangle", size = [1, 0.5], cells = [10, 4] }
    diffusivity = 1
    held = [{ part = "left", temperature = 0 }, { part = "right", temperature = 20 }]
    marks = { middle = [0.5, 0.25] }
"#;

#[test]
fn the_answer_of_a_heat_run_stands_in_files() {
    let (run, out) = written(&scene(PLATE), "plate");
    let sheet = Sheet::read(&out, "temperature.csv");
    assert_eq!(sheet.headings, ["time [s]", "vertex", "temperature"]);
    let vertices = run.scene().particles();
    assert_eq!(sheet.rows.len(), run.times().len() * vertices.len());
    let last = sheet.rows.len() - vertices.len();
    for (row, vertex) in (last..).zip(vertices) {
        assert_eq!((&sheet.rows[row][0][..], &sheet.rows[row][1]), ("5.0", &vertex.name));
        // In the end the line between the two temperatures.
        close(&sheet.numbers(row, 2..3), &[20.0 * vertex.position[0]], 1e-9);
        if vertex.name == "plate.middle" {
            assert_eq!(sheet.numbers(row, 2..3), run.observed(run.times().len() - 1));
        }
    }
    let text = vtu(&out, run.times().len() - 1);
    let in_csv: Vec<f64> = (last..sheet.rows.len()).flat_map(|r| sheet.numbers(r, 2..3)).collect();
    assert_eq!(array(&text, "temperature"), in_csv);
    // 80 triangles are cells.
    assert_eq!(array(&text, "kind").iter().filter(|&&kind| kind == 5.0).count(), 80);
    assert_eq!(files(&out), ["observables.csv", "temperature.csv", "trajectory.csv"]);
}

#[test]
fn velocities_are_the_differences_of_positions() {
    let text = r#"
        dimension = 2
        integrator = "stormer-verlet"
        step = 0.0001
        horizon = 0.1
        uniform_gravity = { acceleration = [0, -9.81] }
        particles = [
            { name = "hook", position = [0, 0], pinned = true },
            { name = "bob", position = [1, 0], mass = 0.2, velocity = [0, 2] },
        ]
        springs = [{ between = ["hook", "bob"], stiffness = 50 }]
    "#;
    let (run, out) = written(&scene(text), "velocity");
    let sheet = Sheet::read(&out, "velocity.csv");
    assert_eq!(sheet.headings, ["time [s]", "particle", "velocity x [m/s]", "velocity y [m/s]"]);
    let n = run.times().len();
    for sample in 1..n - 1 {
        let (before, after) = (run.positions(sample - 1), run.positions(sample + 1));
        let slope: Vec<f64> = before.iter().zip(after).map(|(a, b)| (b - a) / 2e-4).collect();
        let row = 2 * sample;
        let both = [sheet.numbers(row, 2..4), sheet.numbers(row + 1, 2..4)].concat();
        // h^2/6 of the third derivative, some omega^3 v.
        close(&both, &slope, 1e-4);
        assert_eq!(sheet.rows[row][1], "hook");
    }
    let in_vtk = array(&vtu(&out, n - 1), "velocity");
    close(&in_vtk[3..5], &sheet.numbers(2 * n - 1, 2..4), 0.0);
    assert_eq!(files(&out), ["observables.csv", "trajectory.csv", "velocity.csv"]);
}

/// The Hamilton product.
fn product(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

#[test]
fn a_body_turns_as_its_angular_velocity_says() {
    let racket = shipped("thrown-racket").with_step(2.5e-4).unwrap().with_horizon(0.5).unwrap();
    let (run, out) = written(&racket, "racket");
    let sheet = Sheet::read(&out, "bodies.csv");
    assert_eq!(sheet.headings.len(), 15);
    assert_eq!(sheet.headings[5], "quaternion w");
    assert_eq!(sheet.headings[12], "angular velocity in body axes x [rad/s]");
    let n = run.times().len();
    let dt = run.times()[2] - run.times()[0];
    let quaternion = |row: usize| -> [f64; 4] { sheet.numbers(row, 5..9).try_into().unwrap() };
    for sample in 1..n - 1 {
        let (q, w) = (quaternion(sample), sheet.numbers(sample, 12..15));
        close(&[q.iter().map(|x| x * x).sum()], &[1.0], 1e-14);
        let [mut a, mut b] = [quaternion(sample - 1), quaternion(sample + 1)];
        // The same turn has two quaternions.
        for other in [&mut a, &mut b] {
            if other.iter().zip(&q).map(|(a, b)| a * b).sum::<f64>() < 0.0 {
                *other = other.map(|x| -x);
            }
        }
        let rate: Vec<f64> = (0..4).map(|k| (b[k] - a[k]) / dt).collect();
        let exact = product(q, [0.0, w[0], w[1], w[2]]).map(|x| 0.5 * x);
        close(&rate, &exact, 2e-3);
        close(&sheet.numbers(sample, 2..5), &run.positions(sample)[..3], 0.0);
    }
    // Points of the body move as the series says.
    let sample = n / 2;
    let (before, after) = (run.positions(sample - 1), run.positions(sample + 1));
    let slope: Vec<f64> = before.iter().zip(after).map(|(a, b)| (b - a) / dt).collect();
    let text = vtu(&out, sample);
    close(&array(&text, "velocity"), &slope, 2e-3);
    close(&array(&text, "orientation")[..4], &quaternion(sample), 0.0);
    close(&array(&text, "angular_velocity")[3..6], &sheet.numbers(sample, 12..15), 0.0);
}

#[test]
fn a_body_in_the_plane_has_an_angle_that_counts_whole_turns() {
    let (run, out) = written(&shipped("tumbling-wrench").with_horizon(0.4).unwrap(), "wrench");
    let sheet = Sheet::read(&out, "bodies.csv");
    let expected = [
        "time [s]",
        "body",
        "x [m]",
        "y [m]",
        "angle [rad]",
        "velocity x [m/s]",
        "velocity y [m/s]",
        "angular velocity [rad/s]",
    ];
    assert_eq!(sheet.headings, expected);
    let last = sheet.numbers(sheet.rows.len() - 1, 2..8);
    // Nothing turns it: omega = 8, and it falls.
    close(&last[2..], &[8.0 * 0.4, 0.9, 3.0 - 9.81 * 0.4, 8.0], 1e-10);
    let text = vtu(&out, run.times().len() - 1);
    close(&array(&text, "orientation")[..4], &[1.6_f64.cos(), 0.0, 0.0, 1.6_f64.sin()], 1e-10);
}

/// The changes of momentum that contact impulses say, by the name of what changes, of each sample.
fn given(run: &Run, out: &Path) -> BTreeMap<(String, String), Vec<f64>> {
    let (sheet, d) = (Sheet::read(out, "contacts.csv"), run.scene().dimension());
    assert_eq!(sheet.headings[1..4], ["last moment [s]", "first", "second"]);
    assert_eq!(sheet.headings[4 + 2 * d], "impulse on the second x [kg m/s]");
    let mut given: BTreeMap<(String, String), Vec<f64>> = BTreeMap::new();
    for row in 0..sheet.rows.len() {
        let impulse = sheet.numbers(row, 4 + 2 * d..4 + 3 * d);
        let normal = sheet.numbers(row, 4 + d..4 + 2 * d);
        close(&[normal.iter().map(|n| n * n).sum()], &[1.0], 1e-12);
        let along: f64 = normal.iter().zip(&impulse).map(|(n, j)| n * j).sum();
        assert!(along > 0.0, "things push each other apart: {:?}", sheet.rows[row]);
        for (side, sign) in [(2, -1.0), (3, 1.0)] {
            let key = (sheet.rows[row][0].clone(), sheet.rows[row][side].clone());
            let sum = given.entry(key).or_insert_with(|| vec![0.0; d]);
            sum.iter_mut().zip(&impulse).for_each(|(sum, j)| *sum += sign * j);
        }
    }
    given
}

/// Contact and weight are all that changes the momenta of these masses; `velocity` is that of one of
/// them at a sample.
fn assert_momenta(
    run: &Run,
    out: &Path,
    masses: &[(String, f64)],
    velocity: impl Fn(usize, usize) -> [f64; 3],
    gravity: [f64; 3],
) {
    let (d, given) = (run.scene().dimension(), given(run, out));
    assert!(given.len() > 2, "{given:?}");
    let largest = (0..masses.len())
        .flat_map(|k| (0..run.times().len()).map(move |sample| (k, sample)))
        .map(|(k, sample)| velocity(sample, k).iter().fold(0.0_f64, |m, v| m.max(v.abs())))
        .fold(1.0, f64::max);
    for sample in 1..run.times().len() {
        let dt = run.times()[sample] - run.times()[sample - 1];
        for (k, (name, mass)) in masses.iter().enumerate() {
            let (before, after) = (velocity(sample - 1, k), velocity(sample, k));
            let change: Vec<f64> =
                (0..d).map(|c| mass * (after[c] - before[c] - dt * gravity[c])).collect();
            let key = (format!("{:?}", run.times()[sample]), name.clone());
            let none = vec![0.0; d];
            close(&change, given.get(&key).unwrap_or(&none), 1e-9 * mass * largest);
        }
    }
}

#[test]
fn contact_impulses_of_bodies_are_what_their_momenta_change_by() {
    let bounce = r#"
        dimension = 2
        integrator = "stormer-verlet"
        step = 0.005
        horizon = 1
        sample_every = 3
        uniform_gravity = { acceleration = [0, -9.81] }
        bodies = [
            { name = "a", mass = 2, box = [0.4, 0.2], position = [0, 0.3], rotation = 0.3, velocity = [1, 0] },
            { name = "b", mass = 1, ball = 0.1, position = [0.1, 0.9] },
        ]
        contact = { restitution = 0.5, friction = 0.4, walls = [{ normal = [0, 1], at = [0, 0] }], balls = [{ at = [0.9, 0], radius = 0.2 }] }
    "#;
    for (scene, name) in [
        (shipped("box-stack").with_horizon(1.2).unwrap(), "stack"),
        (shipped("masonry-arch").with_horizon(0.2).unwrap(), "arch"),
        (scene(bounce).with_horizon(0.99).unwrap(), "bounce"),
    ] {
        let (run, out) = written(&scene, name);
        let masses: Vec<_> = scene.bodies().iter().map(|b| (b.name.clone(), b.mass)).collect();
        let gravity = scene.gravity().acceleration.unwrap();
        assert_momenta(&run, &out, &masses, |sample, k| run.bodies(sample)[k].velocity, gravity);
        // What the wall gives, seen in the series: at the centre of the body that it is given.
        let given = given(&run, &out);
        let wall: f64 = given
            .iter()
            .filter(|(k, _)| k.1 == "wall 1")
            .map(|(_, j)| j[scene.dimension() - 1])
            .sum();
        assert!(wall < 0.0, "{wall}");
        let sample = run.times().len() - 1;
        let series = array(&vtu(&out, sample), "contact_impulse");
        for (k, (body, _)) in masses.iter().enumerate() {
            let key = (format!("{:?}", run.times()[sample]), body.clone());
            let none = vec![0.0; scene.dimension()];
            let expected = given.get(&key).unwrap_or(&none);
            close(&series[3 * k..3 * k + scene.dimension()], expected, 1e-12);
        }
    }
}

#[test]
fn contact_impulses_of_particles_are_what_their_momenta_change_by() {
    let drop = r#"
        dimension = 2
        integrator = "stormer-verlet"
        step = 0.004
        horizon = 1.2
        sample_every = 5
        uniform_gravity = { acceleration = [0, -9.81] }
        particles = [
            { name = "pin", position = [0.55, 0.3], pinned = true, radius = 0.1 },
            { name = "a", position = [0, 0.5], mass = 0.2, radius = 0.1, velocity = [1, 0] },
            { name = "b", position = [0.02, 0.8], mass = 0.3, radius = 0.1 },
            { name = "c", position = [0.8, 0.31], mass = 0.1, velocity = [-2, 0] },
        ]
        contact = { restitution = 0.6, when = "at-the-instant", walls = [{ normal = [0, 1], at = [0, 0] }], balls = [{ at = [-0.5, 0], radius = 0.3 }] }
    "#;
    let mut scenes =
        vec![(shipped("nine-ball-break").with_horizon(0.2).unwrap(), "break".to_owned())];
    for when in ["at-the-instant", "after-overlap", "velocity-filter"] {
        scenes.push((scene(&drop.replace("at-the-instant", when)), format!("drop-{when}")));
    }
    for (scene, name) in scenes {
        let (run, out) = written(&scene, &name);
        let free = scene.particles().iter().enumerate().filter_map(|(k, p)| match p.motion {
            stationary_scene::Motion::Free { mass, .. } => Some((k, p.name.clone(), mass)),
            _ => None,
        });
        let free: Vec<_> = free.collect();
        let masses: Vec<_> = free.iter().map(|(_, name, mass)| (name.clone(), *mass)).collect();
        let velocity = |sample: usize, k: usize| run.velocities(sample)[free[k].0];
        let gravity = scene.gravity().acceleration.unwrap_or_default();
        assert_momenta(&run, &out, &masses, velocity, gravity);
    }
}

#[test]
fn a_hanging_bar_bears_at_each_height_the_weight_below() {
    let text = r#"
        dimension = 1
        integrator = "stormer-verlet"
        step = 0.0001
        horizon = 0.0002
        uniform_gravity = { acceleration = [10] }
        [[solids]]
        name = "bar"
        shape = { kind = "bar", size = [2], cells = [8] }
        section = 0.01
        density = 1000
        young = 1e6
        poisson = 0.3
        hung = ["left"]
    "#;
    let (run, out) = written(&scene(text), "hanging");
    let sheet = Sheet::read(&out, "stress.csv");
    assert_eq!(sheet.headings, ["time [s]", "solid", "element", "stress xx [kg/(m s^2)]"]);
    for element in 0..8 {
        let middle = (element as f64 + 0.5) * 0.25;
        // rho g (L - x), whatever the material.
        close(&sheet.numbers(element, 3..4), &[1e4 * (2.0 - middle)], 1e-3);
        assert_eq!(sheet.rows[element][1..3], ["bar".to_owned(), element.to_string()]);
    }
    let moved = Sheet::read(&out, "displacement.csv");
    assert_eq!(moved.headings, ["time [s]", "vertex", "displacement x [m]"]);
    // To the first order rho g (L x - x^2/2)/E, and the strain is up to 2 %.
    close(&moved.numbers(8, 2..3), &[1e4 * 2.0 / 1e6], 1e-3);
    let first: f64 = run.positions(0)[8] - 2.0;
    assert_eq!(moved.numbers(8, 2..3), [first]);
    let text = vtu(&out, 0);
    let (stress, kinds) = (array(&text, "stress"), array(&text, "kind"));
    assert_eq!(stress.len(), 6 * kinds.len());
    let of_elements: Vec<f64> =
        (0..kinds.len()).filter(|&cell| kinds[cell] == 5.0).map(|cell| stress[6 * cell]).collect();
    close(&of_elements, &(0..8).map(|row| sheet.numbers(row, 3..4)[0]).collect::<Vec<_>>(), 0.0);
    assert_eq!(array(&text, "displacement")[24], first);
}

type Square = [[f64; 2]; 2];

fn times(a: Square, b: Square) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

fn transposed(a: Square) -> Square {
    [[a[0][0], a[1][0]], [a[0][1], a[1][1]]]
}

fn determinant(a: Square) -> f64 {
    a[0][0] * a[1][1] - a[0][1] * a[1][0]
}

fn inverse(a: Square) -> Square {
    let d = determinant(a);
    [[a[1][1] / d, -a[0][1] / d], [-a[1][0] / d, a[0][0] / d]]
}

#[test]
fn the_stress_of_a_swinging_sheet_is_that_of_its_triangles() {
    let text = r#"
        dimension = 2
        integrator = "stormer-verlet"
        step = 0.0005
        horizon = 0.2
        sample_every = 100
        uniform_gravity = { acceleration = [0, -9.81] }
        [[solids]]
        name = "beam"
        shape = { kind = "rectangle", size = [1, 0.2], cells = [8, 2] }
        thickness = 0.1
        density = 1000
        young = 1e6
        poisson = 0.25
        pinned = ["left"]
    "#;
    let (run, out) = written(&scene(text), "sheet");
    let sheet = Sheet::read(&out, "stress.csv");
    assert_eq!(sheet.headings[3..].len(), 3);
    let solid = &run.scene().solids()[0];
    let Simplices::Triangles(triangles) = &solid.simplices else { panic!("triangles") };
    let last = run.times().len() - 1;
    let series = vtu(&out, last);
    let (stress, kinds) = (array(&series, "stress"), array(&series, "kind"));
    let first_cell = kinds.iter().position(|&kind| kind == 5.0).unwrap();
    let mut largest = 0.0_f64;
    for (element, corners) in triangles.iter().enumerate() {
        let sides = |place: &dyn Fn(usize) -> [f64; 2]| -> Square {
            let [a, b, c] = corners.map(place);
            [[b[0] - a[0], c[0] - a[0]], [b[1] - a[1], c[1] - a[1]]]
        };
        let rest = |p: usize| [solid.rest[p - solid.first][0], solid.rest[p - solid.first][1]];
        let now = |p: usize| [run.positions(last)[2 * p], run.positions(last)[2 * p + 1]];
        let f = times(sides(&now), inverse(sides(&rest)));
        let c = times(transposed(f), f);
        let strain: Square =
            [[0.5 * (c[0][0] - 1.0), 0.5 * c[0][1]], [0.5 * c[1][0], 0.5 * (c[1][1] - 1.0)]];
        // Plane stress: E/(1 - nu^2) ((1 - nu) e + nu tr e).
        let (factor, nu) = (1e6 / (1.0 - 0.0625), 0.25);
        let trace = strain[0][0] + strain[1][1];
        let s: Square = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let spread = if i == j { nu * trace } else { 0.0 };
                factor * ((1.0 - nu) * strain[i][j] + spread)
            })
        });
        let sigma = times(times(f, s), transposed(f));
        let sigma = [sigma[0][0], sigma[1][1], sigma[0][1]].map(|x| x / determinant(f));
        let row = last * triangles.len() + element;
        close(&sheet.numbers(row, 3..6), &sigma, 1e-4);
        let cell = 6 * (first_cell + element);
        close(&[stress[cell], stress[cell + 1], stress[cell + 3]], &sheet.numbers(row, 3..6), 0.0);
        largest = largest.max(sigma[0].abs());
    }
    assert!(largest > 1e4, "{largest}: the beam bends");
}

#[test]
fn elements_of_every_shape_are_cells_with_their_own_nodes() {
    let block = |element: &str, shape: &str, rest: &str| {
        format!(
            "dimension = 3\nintegrator = \"stormer-verlet\"\nstep = 1e-5\nhorizon = 1e-5\n\
             [[solids]]\nname = \"s\"\nshape = {shape}\nelement = \"{element}\"\ndensity = 1000\n\
             young = 1e6\npoisson = 0.3\n{rest}"
        )
    };
    let cube = "{ kind = \"box\", size = [1, 1, 1], cells = [1, 1, 1] }";
    let sheet = "{ kind = \"rectangle\", size = [1, 1], cells = [1, 1] }";
    let bar = "{ kind = \"bar\", size = [1], cells = [2] }";
    for (name, text, shape, nodes) in [
        ("tetrahedra", block("linear", cube, ""), 10.0, 4),
        ("quadratic-tetrahedra", block("quadratic", cube, ""), 24.0, 10),
        ("triangles", block("linear", sheet, "thickness = 0.1"), 5.0, 3),
        ("quadratic-triangles", block("quadratic", sheet, "thickness = 0.1"), 22.0, 6),
        ("lines", block("linear", bar, "section = 0.1"), 3.0, 2),
        ("quadratic-lines", block("quadratic", bar, "section = 0.1"), 21.0, 3),
    ] {
        let (run, out) = written(&scene(&text), name);
        let series = vtu(&out, 1);
        let (kinds, types) = (array(&series, "kind"), array(&series, "types"));
        let elements: Vec<usize> = (0..kinds.len()).filter(|&c| kinds[c] == 5.0).collect();
        assert_eq!(elements.len(), run.scene().solids()[0].simplices.len(), "{name}");
        assert!(elements.iter().all(|&cell| types[cell] == shape), "{name}");
        let offsets = array(&series, "offsets");
        assert!(
            elements.iter().all(|&c| offsets[c] - offsets[c - 1] == f64::from(nodes)),
            "{name}"
        );
        // At rest without weight there is no stress, and each component stands there.
        let stress = Sheet::read(&out, "stress.csv");
        assert_eq!(stress.headings.len(), 9);
        close(&stress.numbers(stress.rows.len() - 1, 3..9), &[0.0; 6], 1e-6);
    }
}

#[test]
fn a_run_resumed_between_two_samples_has_the_contact_impulses_of_a_whole_one() {
    let scene = shipped("box-stack").with_horizon(0.7).unwrap();
    let text =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/box-stack.toml"));
    assert_eq!(scene.timing().sample_every(), 2);
    // The claims are of times at which there is no sample then.
    let text = text.unwrap().replace("sample_every = 2", "sample_every = 7");
    let text = text.split("[[claims]]").next().unwrap().to_owned();
    let scene = self::scene(&text).with_horizon(0.7).unwrap();
    crate::checkpoints::assert_resumes(&scene, &[10, 12, 13, 14, 15, 120], "stack-of-seven");
}
