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
