//! Elastic bodies in scenes: their mass, their rest, how they swing, and what their file may not
//! say.

use stationary_calculus::{Covector, Potential};
use stationary_scene::{Motion, Run, Scene, Stepping};

const HEAD: &str = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.0001\nhorizon = 0.1\n";

const BEAM: &str = r#"
[[solids]]
name = "beam"
shape = { kind = "rectangle", size = [1, 0.2], cells = [10, 2] }
thickness = 0.1
density = 1000
material = "neo-hookean"
young = 1e6
poisson = 0.3
pinned = ["left"]
marks = { tip = [1, 0.1] }
"#;

fn scene(text: &str) -> Scene {
    Scene::parse("solid.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

fn drift(run: &Run) -> f64 {
    let energies = run.energies();
    let kinetic = run.kinetic_energies().iter().copied().fold(0.0, f64::max);
    energies.iter().map(|e| (e - energies[0]).abs()).fold(0.0, f64::max) / kinetic
}

#[test]
fn a_solid_weighs_its_density_times_its_volume_and_is_at_rest_where_it_is_laid() {
    for (dimension, shape, measure) in [
        (1, "kind = \"bar\", size = [2], cells = [7]", 2.0 * 0.1),
        (2, "kind = \"bar\", size = [2], cells = [7], across = [3, 4]", 2.0 * 0.1),
        (2, "kind = \"rectangle\", size = [2, 1], cells = [3, 4], origin = [5, 6]", 2.0 * 0.1),
        (3, "kind = \"rectangle\", size = [2, 1], cells = [3, 4], up = [0, 0, 1]", 2.0 * 0.1),
        (
            3,
            "kind = \"box\", size = [2, 1, 0.5], cells = [3, 2, 1], across = [0, 1, 0], up = [0, 0, 1]",
            1.0,
        ),
    ] {
        let section = match (dimension, shape.contains("bar"), shape.contains("box")) {
            (_, true, _) => "section = 0.1",
            (_, _, true) => "",
            _ => "thickness = 0.1",
        };
        let text = format!(
            "dimension = {dimension}\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n\
             [[solids]]\nname = \"it\"\nshape = {{ {shape} }}\n{section}\ndensity = 3\nyoung = 100\n\
             poisson = 0.25\n"
        );
        let scene = scene(&text);
        let (mass, force) = match dimension {
            1 => mass_and_force::<1>(&scene),
            2 => mass_and_force::<2>(&scene),
            _ => mass_and_force::<3>(&scene),
        };
        assert!((mass / (3.0 * measure) - 1.0).abs() < 1e-13, "{shape}: {mass}");
        assert!(force < 1e-12, "{shape}: {force}");
    }
}

fn mass_and_force<const D: usize>(scene: &Scene) -> (f64, f64) {
    let problem = scene.problem().unwrap();
    let mut dv = Covector(vec![0.0; problem.system.dim()]);
    problem.system.potential().add_differential(&problem.initial.q, dv.view_mut());
    let mass: f64 = problem.system.metric().masses().iter().sum();
    (mass / D as f64, dv.0.iter().fold(0.0, |largest, x| largest.max(x.abs())))
}

#[test]
fn stretched_elements_of_every_shape_have_the_energy_of_their_strain() {
    // Green strain s along the first axis alone: W = (lambda + 2 mu)/2 s^2, with lambda = 0 at nu = 0.
    let strain = 0.5 * (1.1 * 1.1 - 1.0);
    for (dimension, shape, section) in [
        (1, "kind = \"bar\", size = [2], cells = [7]", "section = 0.1"),
        (2, "kind = \"rectangle\", size = [2, 1], cells = [3, 4]", "thickness = 0.1"),
        (3, "kind = \"disc\", size = [1], cells = [4]", "thickness = 0.1\nbending = 1"),
        (3, "kind = \"box\", size = [2, 1, 0.1], cells = [3, 2, 1]", ""),
    ] {
        let text = format!(
            "dimension = {dimension}\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n\
             [[solids]]\nname = \"it\"\nshape = {{ {shape} }}\n{section}\ndensity = 1\nyoung = 100\n"
        );
        let scene = scene(&text);
        let (energy, volume) = match dimension {
            1 => stretched::<1>(&scene),
            2 => stretched::<2>(&scene),
            _ => stretched::<3>(&scene),
        };
        let expected = 0.5 * 100.0 * strain * strain * volume;
        assert!((energy / expected - 1.0).abs() < 1e-12, "{shape}: {energy} and {expected}");
    }
}

/// The energy when drawn out by a tenth along the first axis, and the volume (the mass at density
/// 1).
fn stretched<const D: usize>(scene: &Scene) -> (f64, f64) {
    let problem = scene.problem().unwrap();
    let stretch = |(i, x): (usize, &f64)| if i % D == 0 { 1.1 * x } else { *x };
    let q: Vec<f64> = problem.initial.q.iter().enumerate().map(stretch).collect();
    let mass: f64 = problem.system.metric().masses().iter().sum();
    (problem.system.potential().energy(&q), mass / D as f64)
}

#[test]
fn a_beam_let_go_keeps_its_energy_and_sags() {
    let text = format!("uniform_gravity = {{ acceleration = [0, -9.81] }}\n{BEAM}");
    let run = scene(&format!("{HEAD}{text}")).run().unwrap();
    assert!(drift(&run) < 1e-3, "{:e}", drift(&run));
    let tip = run.scene().particles().iter().position(|p| p.name == "beam.tip").unwrap();
    let last = run.times().len() - 1;
    assert!(run.positions(last)[2 * tip + 1] < 0.1 - 0.01, "it falls at its tip");
}

#[test]
fn a_hanging_bar_starts_where_its_weight_draws_it() {
    // E A (s^3 - s)/2 = rho A g (L - X): cubic in the stretch s, and the end is its integral.
    let text = "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = 0.0001\nhorizon = 0.001\n\
         uniform_gravity = { acceleration = [-10] }\n\
         [[solids]]\nname = \"bar\"\nsection = 0.01\ndensity = 100\nyoung = 2000\nhung = [\"left\"]\n\
         shape = { kind = \"bar\", size = [1], cells = [400], across = [-1] }\n\
         marks = { end = [-1] }\n";
    let scene = scene(text);
    let problem = scene.problem().unwrap();
    let stretch = |x: f64| -> f64 {
        let target = 2.0 * 100.0 * 10.0 * (1.0 - x) / 2000.0;
        let mut s: f64 = 1.0;
        for _ in 0..50 {
            s -= (s * s * s - s - target) / (3.0 * s * s - 1.0);
        }
        s
    };
    let middles = (0..10_000).map(|i| (f64::from(i) + 0.5) / 10_000.0);
    let expected: f64 = middles.map(stretch).sum::<f64>() / 10_000.0;
    let end = scene.particles().iter().position(|p| p.name == "bar.end").unwrap();
    let error = (problem.initial.q[end] + expected).abs();
    assert!(error < 2e-6, "{error:e}: of the square of the cells");
    assert!(problem.initial.p.0.iter().all(|p| *p == 0.0));
}

#[test]
fn the_news_reach_the_lower_end_of_a_slinky_when_its_stretch_says() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/slinky-release.toml");
    let scene = Scene::read(path).unwrap();
    let (length, young, density, gravity) = (0.1, 1.0, 500.0, 9.81);
    let arrival: f64 = (0..10_000)
        .map(|i| {
            let x = length * (f64::from(i) + 0.5) / 10_000.0;
            let target = 2.0 * density * gravity * (length - x) / young;
            let mut s: f64 = target.cbrt().max(1.0);
            for _ in 0..60 {
                s -= (s * s * s - s - target) / (3.0 * s * s - 1.0);
            }
            length / 10_000.0 / (young * (3.0 * s * s - 1.0) / (2.0 * density)).sqrt()
        })
        .sum();
    let horizon = scene.timing().horizon();
    assert!(horizon < arrival, "the run ends at {horizon}, before the wave arrives at {arrival}");
    let run = scene.run().unwrap();
    let bottom = run.scene().particles().iter().position(|p| p.name == "slinky.bottom").unwrap();
    let top = run.scene().particles().iter().position(|p| p.name == "slinky.top").unwrap();
    let last = run.times().len() - 1;
    let fall = |particle: usize| run.positions(0)[particle] - run.positions(last)[particle];
    assert!(fall(top) > 0.2, "{}", fall(top));
    assert!(fall(bottom).abs() < 1e-4 * fall(top), "{:e}", fall(bottom));
}

#[test]
fn a_few_modes_move_a_beam_that_swings_little_as_all_its_freedoms_do() {
    let text = |method: &str, gravity: f64| {
        format!(
            "dimension = 2\n{method}\nhorizon = 0.4\nstep = 0.0001\nsample_every = 100\n\
             observables = [{{ position = \"beam.tip\" }}, \"energy\"]\n\
             uniform_gravity = {{ acceleration = [0, -{gravity}] }}\n{BEAM}"
        )
    };
    let farthest = |gravity: f64| {
        let whole = scene(&text("integrator = \"stormer-verlet\"", gravity)).run().unwrap();
        let few = text("integrator = \"linear-modes\"\nmodes = 6", gravity);
        let few = scene(&few).run().unwrap();
        let swing = (0..whole.times().len()).map(|i| (whole.observed(i)[1] - 0.1).abs());
        let apart = |i: usize| (whole.observed(i)[1] - few.observed(i)[1]).abs();
        let apart = (0..whole.times().len()).map(apart).fold(0.0, f64::max);
        apart / swing.fold(0.0, f64::max)
    };
    let (little, far) = (farthest(0.01), farthest(10.0));
    assert!(little < 2e-3, "{little:e}");
    assert!(far > 10.0 * little, "{far:e}: modes do not know large motion");
}

#[test]
fn modes_cost_a_search_and_no_steps() {
    let beam = scene(&format!(
        "{}{BEAM}",
        HEAD.replace("\"stormer-verlet\"", "\"linear-modes\"\nmodes = 3")
    ));
    assert_eq!(beam.stepping(), Stepping::LinearModes { count: 3 });
    // Twice the time costs no more: what is counted are factors and solves with them.
    let cost = beam.run().unwrap().cost();
    let longer = beam.clone().with_horizon(2.0 * beam.timing().horizon()).unwrap();
    assert!(cost.hessians >= 2 && cost.differentials > 10, "{cost:?}");
    assert_eq!(longer.run().unwrap().cost().differentials, cost.differentials);
}

#[test]
fn a_struck_bell_rings_and_its_modes_keep_energy() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/struck-bell.toml");
    let run = Scene::read(path).unwrap().with_horizon(0.002).unwrap().run().unwrap();
    assert!(drift(&run) < 1e-2, "{:e}", drift(&run));
    assert!(!run.scene().faces().is_empty());
}

#[test]
fn a_solid_that_cannot_be_is_refused_where_it_says_so() {
    let refused = |from: &str, to: &str, message: &str| {
        let text = format!("{HEAD}{BEAM}").replace(from, to);
        let error = Scene::parse("a.toml", &text).expect_err(to).to_string();
        assert!(error.contains(message), "{error}\n\nexpected: {message}");
    };
    refused("young = 1e6", "young = -1", "Young's modulus is -1");
    refused("poisson = 0.3", "poisson = 0.5", "Poisson's ratio");
    refused("\"neo-hookean\"", "\"neohookean\"", "did you mean `neo-hookean`?");
    refused("kind = \"rectangle\"", "kind = \"box\"", "does not fit into a scene of dimension 2");
    refused("size = [1, 0.2]", "size = [1]", "needs 2, for its two sides");
    refused("cells = [10, 2]", "cells = [10, 0]", "cells up");
    refused("cells = [10, 2]", "cells = [100000, 100000]", "particles; there may be at most");
    refused("thickness = 0.1", "section = 0.1", "this solid needs a `thickness`");
    refused("thickness = 0.1", "thickness = 0.1\nbending = 1", "only a sheet in space");
    refused("[\"left\"]", "[\"front\"]", "has no side `front`");
    refused("[\"left\"]", "[\"lef\"]", "did you mean `left`?");
    refused("[\"left\"]", "[\"all\"]", "every particle is pinned");
    refused("[1, 0.1] }", "[1, 0.1, 0] }", "has 3 components");
    refused("density = 1000", "density = 0", "the density is 0");
    refused(
        "kind = \"rectangle\", size = [1, 0.2], cells = [10, 2]",
        "file = \"a.obj\"",
        "dimension 2",
    );
    refused(
        "pinned = [\"left\"]",
        "struck = { at = [9, 9], radius = 1, velocity = [0, 1] }",
        "no vertex within the strike radius",
    );
    let twice = format!("{HEAD}{BEAM}{BEAM}");
    let error = Scene::parse("a.toml", &twice).unwrap_err().to_string();
    assert!(error.contains("there is already a solid called `beam`"), "{error}");
}

#[test]
fn meshes_are_looked_for_in_the_scenes_folder_and_nowhere_else() {
    let folder = std::env::temp_dir().join(format!("stationary-meshes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let text = |file: &str| {
        format!(
            "dimension = 3\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n[[solids]]\n\
             name = \"it\"\nthickness = 0.1\ndensity = 1\nyoung = 1\nshape = {{ file = \"{file}\" }}\n"
        )
    };
    let read = |file: &str| {
        let path = folder.join("scene.toml");
        std::fs::write(&path, text(file)).unwrap();
        Scene::read(&path).map_err(|error| error.to_string())
    };
    std::fs::write(folder.join("one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    std::fs::write(folder.join("flat.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").unwrap();
    std::fs::write(folder.join("none.obj"), "hello\nf 1 2 9\n").unwrap();
    assert_eq!(read("one.obj").unwrap().particles().len(), 3);
    assert_eq!(read("./one.obj").unwrap().particles().len(), 3);
    for (file, message) in [
        ("../one.obj", "not in the folder"),
        ("/etc/passwd", "not in the folder"),
        ("", "not in the folder"),
        ("two.obj", "`two.obj`: "),
        ("flat.obj", "`flat.obj`: "),
        ("none.obj", "`none.obj`: "),
    ] {
        let error = read(file).expect_err(file);
        assert!(error.contains(message), "{error}");
    }
    let error = Scene::parse("a.toml", &text("one.obj")).unwrap_err().to_string();
    assert!(error.contains("not in the folder"), "{error}");
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_mesh_of_gmshs_is_a_block_in_space_or_a_sheet_in_the_plane() {
    let folder = std::env::temp_dir().join(format!("stationary-gmsh-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let msh = |elements: &str| {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 9 9 9\n2 0 0 0\n3 1 0 0\n4 0 1 0\n\
             5 0 0 1\n$EndNodes\n$Elements\n{elements}\n$EndElements\n"
        )
    };
    // With a triangle on its surface and a point that belongs to neither.
    let block = msh("3\n1 15 0 1\n2 2 0 2 3 4\n3 4 0 2 3 4 5");
    std::fs::write(folder.join("block.msh"), &block).unwrap();
    std::fs::write(folder.join("sheet.MSH"), msh("1\n1 2 2 0 1 2 3 4")).unwrap();
    std::fs::write(folder.join("upright.msh"), msh("1\n1 2 2 0 1 2 3 5")).unwrap();
    std::fs::write(folder.join("turned.msh"), msh("1\n1 2 2 0 1 2 4 3")).unwrap();
    std::fs::write(folder.join("curved.msh"), msh("1\n1 8 0 2 3 4")).unwrap();
    std::fs::write(folder.join("hexahedra.msh"), block.replace("3 4 0", "3 5 0")).unwrap();
    let read = |dimension: usize, file: &str| {
        let section = if file == "block.msh" { "" } else { "thickness = 0.1\n" };
        let text = format!(
            "dimension = {dimension}\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n\
             [[solids]]\nname = \"it\"\n{section}density = 12\nyoung = 1\n\
             shape = {{ file = \"{file}\" }}\n"
        );
        let path = folder.join("scene.toml");
        std::fs::write(&path, text).unwrap();
        Scene::read(&path).map_err(|error| error.to_string())
    };
    let block = read(3, "block.msh").unwrap();
    let masses = block.particles().iter().map(|particle| match particle.motion {
        Motion::Free { mass, .. } => mass,
        _ => f64::NAN,
    });
    assert!((masses.sum::<f64>() - 2.0).abs() < 1e-15);
    assert_eq!(block.faces().len(), 4);
    assert_eq!(read(2, "sheet.MSH").unwrap().particles().len(), 3);
    assert_eq!(read(3, "upright.msh").unwrap().particles().len(), 3);
    for (dimension, file, message) in [
        (1, "sheet.MSH", "does not fit into a scene of dimension 1"),
        (2, "block.msh", "its tetrahedra do not fit into the plane"),
        (2, "upright.msh", "its triangles are not in the plane z = 0"),
        (2, "turned.msh", "simplices turned inside out: 0"),
        (3, "curved.msh", "there are no simplices"),
        (3, "hexahedra.msh", "line 16: elements of type 5 are not read"),
        (3, "none.msh", "`none.msh`: "),
    ] {
        let error = read(dimension, file).expect_err(file);
        assert!(error.contains(message), "{error}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_free_solid_that_tumbles_and_rings_keeps_its_momenta() {
    for (dimension, shape) in [(2, "rectangle"), (3, "box")] {
        let (size, cells) =
            if dimension == 2 { ("[1, 0.3]", "[6, 2]") } else { ("[1, 0.3, 0.2]", "[6, 2, 2]") };
        let vector =
            |x: &str| if dimension == 2 { format!("[{x}]") } else { format!("[{x}, 0.3]") };
        let section = if dimension == 2 { "thickness = 0.1" } else { "" };
        let text = format!(
            "dimension = {dimension}\nintegrator = \"stormer-verlet\"\nstep = 0.0002\nhorizon = 0.5\n\
             sample_every = 50\n[[solids]]\nname = \"it\"\n{section}\ndensity = 1000\nyoung = 1e6\n\
             poisson = 0.3\nmaterial = \"fixed-corotated\"\n\
             shape = {{ kind = \"{shape}\", size = {size}, cells = {cells}, origin = {} }}\n\
             velocity = {}\nstruck = {{ at = {}, radius = 0.4, velocity = {} }}\n",
            vector("2, 1"),
            vector("1, 0.5"),
            vector("3, 1.3"),
            vector("0, 4"),
        );
        let run = scene(&text).run().unwrap();
        let strayed = |of: &[[f64; 3]]| {
            let far = |p: &[f64; 3]| (0..3).map(|c| (p[c] - of[0][c]).abs()).fold(0.0, f64::max);
            of.iter().map(far).fold(0.0, f64::max)
        };
        let [linear, angular] = run.momentum_scales();
        assert!(strayed(run.linear_momenta()) < 1e-12 * linear, "{shape}");
        assert!(strayed(run.angular_momenta()) < 1e-12 * angular, "{shape}");
        assert!(drift(&run) < 1e-2, "{shape}: {:e}", drift(&run));
    }
}

#[test]
fn modes_that_would_not_fit_into_memory_are_refused_before_they_are_sought() {
    let text = format!("{HEAD}{BEAM}")
        .replace("\"stormer-verlet\"", "\"linear-modes\"\nmodes = 1000")
        .replace("cells = [10, 2]", "cells = [700, 700]");
    let error = Scene::parse("a.toml", &text).unwrap_err().to_string();
    assert!(error.contains("numbers of modes"), "{error}");
}
