//! A run that was interrupted and resumed is the run that was not, to the last bit.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use stationary_integrators::Method;
use stationary_rigid::BodyMethod;
use stationary_scene::{
    Checkpoint, CheckpointError, Control, Observer, Progress, Run, RunError, Scene, Stepping,
};

/// Asks for a checkpoint of a step, and ends the run there.
struct StopsAfter {
    step: u64,
    kept: Option<Checkpoint>,
}

impl Observer for StopsAfter {
    fn stepped(&mut self, now: Progress<'_>) -> Control {
        match (now.step + 1 >= self.step, &self.kept) {
            (true, Some(_)) => Control::Stop,
            (true, None) => Control::Checkpoint,
            (false, _) => Control::Continue,
        }
    }

    fn keep(&mut self, checkpoint: &Checkpoint) {
        self.kept = Some(checkpoint.clone());
    }
}

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("checkpoints").join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The checkpoint of a step, written to a file and read back.
fn interrupted(scene: &Scene, step: u64, name: &str) -> Checkpoint {
    let mut watcher = StopsAfter { step, kept: None };
    scene.run_from(None, &mut watcher).unwrap();
    let (kept, path) = (watcher.kept.unwrap(), folder(name).join("checkpoint"));
    assert_eq!(kept.step(), step);
    kept.write(&path).unwrap();
    let read = Checkpoint::read(&path).unwrap();
    assert_eq!(read, kept);
    read
}

/// Goes on to the horizon.
struct Patient;

impl Observer for Patient {
    fn stepped(&mut self, _: Progress<'_>) -> Control {
        Control::Continue
    }

    fn keep(&mut self, _: &Checkpoint) {}
}

/// Every file of two runs has the same bytes.
fn assert_same_files(whole: &Run, resumed: &Run, name: &str) {
    let [one, other] = ["whole", "resumed"].map(|part| folder(&format!("{name}-{part}")));
    whole.write(&one).unwrap();
    resumed.write(&other).unwrap();
    let mut files = 0;
    for entry in fs::read_dir(&one).unwrap() {
        let file = entry.unwrap().file_name();
        assert!(
            fs::read(one.join(&file)).unwrap() == fs::read(other.join(&file)).unwrap(),
            "{name}: {file:?}"
        );
        files += 1;
    }
    assert!(files >= 6, "{files}");
}

/// Resumes the scene from a checkpoint of every one of these steps.
pub(crate) fn assert_resumes(scene: &Scene, steps: &[u64], name: &str) {
    let whole = scene.run().unwrap();
    for &step in steps {
        let checkpoint = interrupted(scene, step, name);
        let resumed = scene.run_from(Some(checkpoint), &mut Patient).unwrap();
        assert!(whole == resumed, "{name} from step {step}");
        assert_same_files(&whole, &resumed, name);
    }
}

const FALL: &str = r#"
    dimension = 2
    integrator = "stormer-verlet"
    step = 0.01
    horizon = 0.5
    sample_every = 3
    uniform_gravity = { acceleration = [0, -9.81] }
    particles = [
        { name = "hook", position = [0, 0], pinned = true },
        { name = "a", position = [1, 0], mass = 0.2, velocity = [0, 1] },
        { name = "b", position = [2, 0.3], mass = 0.3 },
    ]
    springs = [
        { between = ["hook", "a"], stiffness = 50 },
        { between = ["a", "b"], stiffness = 80, strain = "green" },
    ]
"#;

#[test]
fn every_method_of_equal_steps_resumes_to_the_same_bits() {
    let scene = Scene::parse("fall", FALL).unwrap();
    for &method in Method::ALL {
        let scene = scene.clone().with_method(method).unwrap();
        assert_resumes(&scene, &[2, 25, 50], &format!("equal-{method}"));
    }
}

#[test]
fn sparse_implicit_methods_and_drag_resume_to_the_same_bits() {
    let net = r#"
        dimension = 3
        integrator = "generalized-alpha"
        step = 0.004
        horizon = 0.2
        sample_every = 7
        uniform_gravity = { acceleration = [0, 0, -9.81] }
        nets = [{ name = "net", rows = 5, columns = 6, spacing = 0.1, origin = [0, 0, 0],
                  particle_mass = 0.01, stiffness = 100, pinned = ["top"] }]
    "#;
    let plain = Scene::parse("net", net).unwrap();
    assert_resumes(&plain, &[20], "net");
    let midpoint = plain.with_method(Method::ImplicitMidpoint).unwrap();
    assert_resumes(&midpoint, &[20], "net-midpoint");
    let drag = Scene::parse("drag", &format!("drag = {{ coefficient = 0.02 }}\n{net}")).unwrap();
    assert_resumes(&drag, &[20], "net-drag");
}

#[test]
fn methods_that_choose_their_steps_resume_to_the_same_bits() {
    for method in ["dormand-prince-853", "radau-iia-5", "bdf-5"] {
        for drag in ["", "drag = { coefficient = 0.1 }\n"] {
            let text = FALL.replace("stormer-verlet\"", &format!("{method}\"\ntolerance = 1e-7"));
            let scene = Scene::parse(method, &(drag.to_owned() + &text)).unwrap();
            assert_resumes(&scene, &[2, 25, 49], method);
        }
    }
}

#[test]
fn every_way_to_hold_rods_resumes_to_the_same_bits() {
    let text = FALL.replace("springs = [", "rods = [{ between = [\"a\", \"b\"] }]\nsprings = [");
    let text =
        text.replace("{ between = [\"a\", \"b\"], stiffness = 80, strain = \"green\" },", "");
    for method in ["rattle", "constrained-hamilton", "stormer-verlet", "generalized-alpha"] {
        let text = text.replace("velocity = [0, 1]", "velocity = [0, 0]");
        let scene = Scene::parse(method, &text.replace("stormer-verlet", method)).unwrap();
        assert_resumes(&scene, &[2, 25, 50], &format!("rods-{method}"));
    }
}

fn shipped(name: &str) -> Scene {
    let scenes = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes");
    Scene::read(scenes.join(format!("{name}.toml"))).unwrap()
}

#[test]
fn a_bridge_resumes_before_at_and_after_the_steps_in_which_it_breaks() {
    let bridge = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/breaking-bridge.toml");
    let weak = fs::read_to_string(bridge).unwrap().replace("strength = 4000", "strength = 2500");
    let scene = Scene::parse("weak", &weak.replace("horizon = 2", "horizon = 1")).unwrap();
    let whole = scene.run().unwrap();
    let breaks: Vec<u64> = whole.broken().iter().map(|b| (b.time / 0.001).round() as u64).collect();
    assert!(breaks.len() >= 2, "{breaks:?}");
    let steps: BTreeSet<u64> =
        breaks.iter().take(2).flat_map(|&step| [step - 1, step, step + 1]).collect();
    assert_resumes(&scene, &Vec::from_iter(steps), "bridge");
}

#[test]
fn bodies_resume_to_the_same_bits_with_every_method_with_and_without_joints() {
    let racket = shipped("thrown-racket").with_horizon(0.1).unwrap();
    for &method in BodyMethod::ALL {
        let scene = racket.clone().with_method(method).unwrap();
        assert_resumes(&scene, &[2, 50], &format!("racket-{method:?}"));
    }
    let top = shipped("heavy-top").with_horizon(0.05).unwrap();
    for method in
        [BodyMethod::VariationalRotation, BodyMethod::AxisRotations, BodyMethod::ExactRotation]
    {
        let scene = top.clone().with_method(method).unwrap();
        assert_resumes(&scene, &[2, 50, 100], &format!("top-{method:?}"));
    }
    let plane = r#"
        dimension = 2
        integrator = "stormer-verlet"
        step = 0.01
        horizon = 0.5
        uniform_gravity = { acceleration = [0, -9.81] }
        bodies = [
            { name = "a", mass = 1, box = [1, 0.1], position = [0.5, 0] },
            { name = "b", mass = 1, box = [1, 0.1], position = [1.5, 0] },
        ]
    "#;
    let free = Scene::parse("plane", plane).unwrap();
    for method in [Method::StormerVerlet, Method::GeneralizedAlpha] {
        let scene = free.clone().with_method(method).unwrap();
        assert_resumes(&scene, &[25], &format!("plane-{method}"));
    }
    let joints = "joints = [
        { kind = \"pin\", between = [\"world\", \"a\"], at = [0, 0] },
        { kind = \"pin\", between = [\"a\", \"b\"], at = [1, 0] },
    ]";
    let held = Scene::parse("held", &format!("{plane}\n{joints}")).unwrap();
    assert_resumes(&held, &[2, 25], "plane-held");
}

#[test]
fn solids_modes_impacts_and_heat_resume_to_the_same_bits() {
    for (name, horizon) in [
        ("cantilever", 20.0),
        ("struck-bell", 20.0),
        ("newtons-cradle", 400.0),
        ("nine-ball-break", 400.0),
        ("warm-sphere", 20.0),
    ] {
        let scene = shipped(name);
        let scene = scene.clone().with_horizon(horizon * scene.timing().step()).unwrap();
        let last = scene.timing().steps();
        assert_resumes(&scene, &[2, last / 2, last], name);
    }
}

#[test]
fn bodies_that_touch_in_space_and_in_the_plane_resume_to_the_same_bits() {
    for name in ["box-stack", "block-on-incline", "masonry-arch"] {
        let scene = shipped(name);
        let scene = scene.clone().with_horizon(160.0 * scene.timing().step()).unwrap();
        assert_resumes(&scene, &[2, 90, 160], name);
    }
}

#[test]
fn a_checkpoint_of_a_run_that_was_resumed_is_as_good() {
    let scene = shipped("heavy-top").with_horizon(0.05).unwrap();
    let whole = scene.run().unwrap();
    let first = interrupted(&scene, 30, "twice");
    let mut watcher = StopsAfter { step: 70, kept: None };
    scene.run_from(Some(first), &mut watcher).unwrap();
    let resumed = scene.run_from(watcher.kept, &mut Patient).unwrap();
    assert!(whole == resumed);
}

#[test]
fn a_checkpoint_that_cannot_be_written_leaves_the_file_of_its_name_and_none_beside_it() {
    let mut watcher = StopsAfter { step: 2, kept: None };
    shipped("outer-solar-system").run_from(None, &mut watcher).unwrap();
    let (kept, folder) = (watcher.kept.unwrap(), folder("unwritable"));
    // Two that differ in what follows the last dot, and one called as the unfinished are.
    for name in ["run.1", "run.2", "run.new"] {
        kept.write(folder.join(name)).unwrap();
        assert_eq!(Checkpoint::read(folder.join(name)).unwrap(), kept);
    }
    // A folder cannot be replaced by a file.
    let taken = folder.join("taken");
    fs::create_dir_all(taken.join("in it")).unwrap();
    kept.write(&taken).unwrap_err();
    assert!(taken.is_dir() && !folder.join("taken.new").exists());
}

#[test]
fn a_checkpoint_that_was_cut_or_changed_is_refused() {
    let scene = Scene::parse("fall", FALL).unwrap();
    interrupted(&scene, 10, "damaged");
    let bytes = fs::read(folder("damaged").join("checkpoint")).unwrap();
    assert!(Checkpoint::parse(&bytes).is_ok());
    for length in (0..bytes.len()).step_by(7) {
        assert!(Checkpoint::parse(&bytes[..length]).is_err(), "cut to {length}");
    }
    for place in (0..bytes.len()).step_by(5) {
        let mut changed = bytes.clone();
        changed[place] ^= 4;
        assert!(Checkpoint::parse(&changed).is_err(), "changed at {place}");
    }
    let longer = [bytes.as_slice(), &[0; 8]].concat();
    assert!(matches!(Checkpoint::parse(&longer), Err(CheckpointError::Damaged(_))));
    assert!(matches!(Checkpoint::parse(b"a scene"), Err(CheckpointError::NoCheckpoint)));
    let older = b"stationary checkpoint 0.0.1\n";
    assert!(matches!(Checkpoint::parse(older), Err(CheckpointError::Version { .. })));
    assert!(matches!(
        Checkpoint::read(folder("damaged").join("nothing")),
        Err(CheckpointError::Read { .. })
    ));
}

#[test]
fn a_checkpoint_of_another_scene_step_or_method_is_refused() {
    let scene = Scene::parse("fall", FALL).unwrap();
    let checkpoint = interrupted(&scene, 10, "foreign");
    let refuse = |other: Scene| {
        let error = other.run_from(Some(checkpoint.clone()), &mut Patient).unwrap_err();
        assert!(matches!(error, RunError::Checkpoint(CheckpointError::Foreign)), "{error}");
        assert!(error.partial().is_none());
    };
    refuse(scene.clone().with_step(0.005).unwrap());
    refuse(scene.clone().with_method(Stepping::Equal(Method::RungeKutta4)).unwrap());
    refuse(scene.clone().with_horizon(1.0).unwrap());
    refuse(Scene::parse("fall", &FALL.replace("0.3]", "0.30000000000000004]")).unwrap());
    // A comment changes nothing.
    let commented = Scene::parse("fall", &format!("# A fall.\n{FALL}")).unwrap();
    assert!(commented.run_from(Some(checkpoint.clone()), &mut Patient).is_ok());
}

#[test]
fn a_machine_that_computes_other_bits_is_found_out() {
    let scene = Scene::parse("fall", FALL).unwrap();
    interrupted(&scene, 10, "bits");
    let mut bytes = fs::read(folder("bits").join("checkpoint")).unwrap();
    // The position of `a` at the start of the step, behind the first line, two counts, a time and a
    // length; with a checksum that fits.
    let first_line = bytes.iter().position(|&byte| byte == b'\n').unwrap() + 1;
    bytes[first_line + 8 * 4] ^= 1;
    let end = bytes.len() - 8;
    let sum = bytes[..end].iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    bytes[end..].copy_from_slice(&sum.to_le_bytes());
    let error = scene.run_from(Some(Checkpoint::parse(&bytes).unwrap()), &mut Patient).unwrap_err();
    assert!(
        matches!(error, RunError::Checkpoint(CheckpointError::OtherBits { step: 10 })),
        "{error}"
    );
}

#[test]
fn a_rod_beside_bodies_that_breaks_resumes_before_at_and_after_that_step() {
    let text = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.001\nhorizon = 0.5\n\
                uniform_gravity = { acceleration = [0, -9.81] }\n\
                observables = [{ tension = [\"hook\", \"weight\"] }]\n\
                particles = [{ name = \"hook\", position = [0, 0], pinned = true }]\n\
                bodies = [{ name = \"weight\", mass = 2, ball = 0.1, position = [0.8, -0.6] },\n\
                { name = \"other\", mass = 1, ball = 0.1, position = [0.8, -1.2] }]\n\
                rods = [{ between = [\"hook\", \"weight\"], strength = 40 },\n\
                { between = [\"weight\", \"other\"] }]\n\
                [contact]\nwalls = [{ normal = [0, 1], at = [0, -2] }]\n";
    let scene = Scene::parse("break", text).unwrap();
    let whole = scene.run().unwrap();
    let [broken] = whole.broken() else { panic!("{:?}", whole.broken()) };
    let step = (broken.time / 0.001).round() as u64;
    assert_resumes(&scene, &[step - 1, step, step + 1, step + 20], "rod");
}
