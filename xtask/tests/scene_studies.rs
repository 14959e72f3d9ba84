//! The report on a user's own scene, as a library.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use stationary::program::ladder_of;
use stationary_choose::{MeasuredRuns, answer};
use stationary_integrators::{Conservation, Method};
use stationary_scene::Scene;
use stationary_scene::choose::Question;
use xtask::studies::scene::{long_run, observable, work_precision};

const BUDGET: Duration = Duration::from_secs(600);

const TWO_MASSES: &str = r#"
title = "Two masses on a spring"
dimension = 2
integrator = "stormer-verlet"
step = 0.05
horizon = 4
observables = [{ distance = ["left", "right"] }, "energy"]

[[particles]]
name = "left"
mass = 1
position = [-1, 0]
velocity = [0, -0.5]

[[particles]]
name = "right"
mass = 2
position = [1, 0]
velocity = [0, 0.25]

[[springs]]
between = ["left", "right"]
rest_length = 1.5
stiffness = 10
"#;

/// A file of a scene, gone with the test.
struct File(PathBuf);

impl File {
    fn of(name: &str, text: &str) -> Self {
        let path = std::env::temp_dir().join(format!("stationary-{}-{name}", std::process::id()));
        fs::write(&path, text).unwrap();
        File(path)
    }
}

impl Drop for File {
    fn drop(&mut self) {
        fs::remove_file(&self.0).ok();
    }
}

#[test]
fn a_scene_is_told_which_method_and_step_to_write_into_its_file() {
    let file = File::of("two.toml", TWO_MASSES);
    let asked = Question::new("position=left");
    let study = work_precision(&file.0, &asked, 1e-4, BUDGET).unwrap();
    assert!(study.claims.iter().all(xtask::study::Claim::holds), "{:?}", study.claims);
    // It is the answer of `choose`, with every method beside it.
    let ladder = ladder_of(&file.0, &asked).unwrap();
    let answer = answer(&mut MeasuredRuns::new(&ladder, BUDGET).unwrap(), 1e-4).unwrap();
    let choice = answer.choice().unwrap();
    let said = format!("the cheapest is {} with {}", choice.method, choice.setting);
    assert!(study.conclusion.contains(&said), "{}", study.conclusion);
    let table = study.table.to_string();
    for method in Method::ALL {
        let name = method.facts().name;
        let rows = table.lines().filter(|line| line.split(' ').next() == Some(name));
        assert!(rows.count() >= 1, "{name}\n{table}");
    }
    // What it advises can be done, and does what it says.
    let (_, advice) = study.conclusion.split_once("for 1e-2: ").unwrap();
    let (line, _) = advice.split_once("; ").unwrap();
    let lines: Vec<&str> = line.split(" and ").collect();
    let method = lines[0].split('"').nth(1).unwrap();
    let step: f64 = lines[1].split(' ').next_back().unwrap().parse().unwrap();
    let method: Method = method.parse().unwrap();
    let scene = Scene::read(&file.0).unwrap();
    let run = |step: f64| {
        scene.clone().with_method(method).unwrap().with_step(step).unwrap().run().unwrap()
    };
    let last = |run: &stationary_scene::Run| run.positions(run.times().len() - 1)[..2].to_vec();
    let (advised, far_finer) = (last(&run(step)), last(&run(step / 64.0)));
    let off: f64 = advised.iter().zip(far_finer).map(|(a, b)| (a - b) * (a - b)).sum();
    assert!(off.sqrt() < 2e-2, "{off}");
}

#[test]
fn what_is_asked_is_what_the_file_observes_first() {
    let file = File::of("first.toml", TWO_MASSES);
    assert_eq!(observable(&file.0).unwrap(), "distance=left,right");
    let none = TWO_MASSES.replace("observables", "# observables");
    let file = File::of("none.toml", &none);
    assert_eq!(observable(&file.0).unwrap(), "position=left");
}

#[test]
fn momenta_of_a_free_scene_are_kept_by_the_methods_that_promise_it() {
    let file = File::of("free.toml", TWO_MASSES);
    let table = long_run(&file.0).unwrap().table.to_string();
    for method in Method::ALL {
        let facts = method.facts();
        let row = table.lines().find(|line| line.split(' ').next() == Some(facts.name)).unwrap();
        let [.., linear, angular, _] = row.split_whitespace().collect::<Vec<_>>()[..] else {
            panic!("{row}")
        };
        assert_eq!(linear, "<1e-12", "{row}");
        let exact = facts.angular_momentum == Conservation::Exact;
        assert_eq!(angular == "<1e-12", exact, "{row}");
    }
}

/// What methods of particles alone were once compared on.
#[test]
fn drag_rods_contact_bodies_and_heat_are_charted_like_anything_else() {
    let drag =
        TWO_MASSES.replace("\"stormer-verlet\"", "\"newmark\"") + "[drag]\ncoefficient = 0.1\n";
    let touching = TWO_MASSES.replace("velocity = [0, -0.5]", "velocity = [0, -0.5]\nradius = 0.1")
        + "[contact]\nwalls = [{ normal = [0, 1], at = [0, -1] }]\n";
    let rods = TWO_MASSES.replace("stormer-verlet", "rattle").replace("[[springs]]", "[[rods]]");
    let rods = rods.replace("rest_length = 1.5\nstiffness = 10\n", "");
    let body = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.01\nhorizon = 1\n\
                uniform_gravity = { acceleration = [0, -9.81] }\n\
                bodies = [{ name = \"box\", mass = 1, box = [1, 0.5], position = [0, 0], \
                velocity = [1, 1], angular_velocity = 2, points = [[0.5, 0.25]] }]\n";
    let heat = "dimension = 1\nintegrator = \"crank-nicolson\"\nstep = 0.01\nhorizon = 0.2\n\
                [heat]\nname = \"bar\"\nshape = { kind = \"bar\", size = [1], cells = [8] }\n\
                diffusivity = 1\nheld = [{ part = \"left\", temperature = 0 }, \
                { part = \"right\", temperature = 20 }]\n";
    for (name, text) in [
        ("drag", drag.as_str()),
        ("touching", &touching),
        ("rods", &rods),
        ("body", body),
        ("heat", heat),
    ] {
        let file = File::of(&format!("{name}.toml"), text);
        let asked = Question::new(&observable(&file.0).unwrap());
        let study = work_precision(&file.0, &asked, 1e-2, BUDGET)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(study.conclusion.contains("the cheapest is"), "{name}: {}", study.conclusion);
        assert!(!long_run(&file.0).unwrap().table.to_string().is_empty());
    }
}
