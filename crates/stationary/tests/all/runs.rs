//! A run that is asked to end can go on, and leaves what a run leaves that was not asked.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use stationary::program::{Ending, Job, Progress, RunSceneError, Series, Start, run_job};
use stationary_scene::CheckpointError;

fn scene(name: &str) -> PathBuf {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scene/scenes");
    scenes.join(format!("{name}.toml"))
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("runs").join(name);
    if folder.exists() {
        fs::remove_dir_all(&folder).unwrap();
    }
    folder
}

fn run(file: &Path, out: &Path, start: Start, asked: bool) -> Result<Ending, RunSceneError> {
    let stop = AtomicBool::new(asked);
    let (series, progress) = (Series::None, Progress::Hidden);
    let parameters = &stationary_scene::Parameters::new();
    run_job(&Job { file, parameters, out, start, series, progress, stop: &stop })
}

#[test]
fn a_run_that_is_asked_to_end_goes_on_from_its_checkpoint_to_the_same_files() {
    let (file, whole, parts) = (scene("heavy-top"), folder("whole"), folder("parts"));
    run(&file, &whole, Start::Fresh, false).unwrap();
    let ending = run(&file, &parts, Start::Fresh, true).unwrap();
    assert_eq!(ending.stopped, Some(2));
    assert!(ending.summary.to_string().contains("2 of 4000 steps"));
    let checkpoint = parts.join("checkpoint");
    assert!(checkpoint.exists() && !whole.join("checkpoint").exists());

    let again = run(&file, &parts, Start::Resumed, true).unwrap();
    assert_eq!(again.stopped, Some(4));
    let ending = run(&file, &parts, Start::Resumed, false).unwrap();
    assert_eq!(ending.stopped, None);
    assert!(!checkpoint.exists());
    for entry in fs::read_dir(&whole).unwrap() {
        let name = entry.unwrap().file_name();
        let [one, other] = [&whole, &parts].map(|folder| fs::read(folder.join(&name)).unwrap());
        assert!(one == other, "{name:?}");
    }
}

#[test]
fn a_run_without_a_checkpoint_is_resumed_at_its_start() {
    let out = folder("nothing");
    let ending = run(&scene("thrown-racket"), &out, Start::Resumed, false).unwrap();
    assert_eq!(ending.stopped, None);
    assert!(out.join("player.html").exists());
}

#[test]
fn a_checkpoint_that_does_not_fit_is_named_and_left_where_it_is() {
    let out = folder("foreign");
    run(&scene("heavy-top"), &out, Start::Fresh, true).unwrap();
    let error = run(&scene("thrown-racket"), &out, Start::Resumed, false).unwrap_err();
    let RunSceneError::Checkpoint { path, source } = error else { panic!("{error}") };
    assert!(matches!(*source, CheckpointError::Foreign), "{source}");
    assert_eq!(path, out.join("checkpoint"));
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let error = run(&scene("heavy-top"), &out, Start::Resumed, false).unwrap_err();
    assert!(error.to_string().contains("the checkpoint is damaged"), "{error}");
    assert!(path.exists());
}

/// What the program says of a scene on standard output, on standard error, and its status.
fn said(text: &str, out: &Path, options: &[&str]) -> (String, String, Option<i32>) {
    fs::create_dir_all(out).unwrap();
    let file = out.join("scene.toml");
    fs::write(&file, text).unwrap();
    let ran = std::process::Command::new(env!("CARGO_BIN_EXE_stationary"))
        .args(["run", file.to_str().unwrap(), "--out", out.to_str().unwrap()])
        .args(options)
        .output()
        .unwrap();
    let [said, told] = [ran.stdout, ran.stderr].map(|all| String::from_utf8(all).unwrap());
    (said, told, ran.status.code())
}

#[test]
fn a_quiet_run_hides_its_summary_and_neither_a_warning_nor_that_it_starts_anew() {
    // omega = 10, so that the longest stable step is 0.2.
    let spring = |step: f64| {
        format!(
            "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = {step}\nhorizon = {}\n\
             particles = [{{ name = \"hook\", position = [0], pinned = true }},\n\
             {{ name = \"bob\", position = [1], mass = 1, velocity = [0.1] }}]\n\
             springs = [{{ between = [\"hook\", \"bob\"], stiffness = 100 }}]\n",
            4.0 * step
        )
    };
    let out = folder("quiet");
    let warning = "warning: the step";
    let (shown, told, code) = said(&spring(0.21), &out, &["--quiet"]);
    assert!(shown.is_empty() && code == Some(0), "{shown}{told}");
    assert!(told.starts_with(warning) && told.contains("0.2"), "{told}");
    assert_eq!(told.matches(warning).count(), 1, "{told}");
    let (shown, told, _) = said(&spring(0.19), &out, &["--quiet", "--resume"]);
    assert!(shown.is_empty() && !told.contains(warning), "{shown}{told}");
    assert_eq!(told, format!("no checkpoint in {}: the run starts anew\n", out.display()));
    let (shown, told, _) = said(&spring(0.21), &out, &[]);
    assert!(!shown.is_empty() && told.contains(warning), "{shown}{told}");
}

#[test]
fn a_scene_whose_claim_does_not_hold_ends_with_status_1_and_says_so() {
    let out = folder("claims");
    for (within, code) in [("1e-9", Some(0)), ("0", Some(1))] {
        let text = format!(
            "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n\
             observables = [{{ position = \"stone\" }}]\n\
             particles = [{{ name = \"stone\", mass = 1, position = [0], velocity = [2] }}]\n\
             claims = [{{ of = {{ position = \"stone\" }}, what = \"drift\", within = 3, source = \"v t\" }},\n\
             {{ of = {{ position = \"stone\" }}, is = 2.0000000001, within = {within}, source = \"v t\" }}]\n"
        );
        let (said, told, status) = said(&text, &out, &[]);
        assert_eq!(status, code, "{said}{told}");
        assert_eq!(said.contains("does not hold"), code == Some(1), "{said}");
        assert_eq!(told.contains("a claim of the scene does not hold"), code == Some(1), "{told}");
    }
}
