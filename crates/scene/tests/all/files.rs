//! Files are not trusted: whatever stands where a scene should, the answer is an error that says so.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use stationary_scene::{Scene, SceneError, limits};

/// A fresh folder for one test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("scene-files").join(name);
    fs::remove_dir_all(&folder).ok();
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn written(name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder(name).join("scene.toml");
    fs::write(&path, bytes).unwrap();
    path
}

const BALL: &str = "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = 1\nhorizon = 2\n\
                    particles = [{ name = \"ball\", mass = 1, position = [0], velocity = [1] }]\n";

#[test]
fn a_good_file_is_a_scene_named_after_it() {
    let path = written("good", BALL.as_bytes());
    let scene = Scene::read(&path).unwrap();
    assert_eq!(scene.title(), path.display().to_string());
    assert_eq!(scene, Scene::parse(&path.display().to_string(), BALL).unwrap());
}

#[test]
fn a_gigabyte_of_zeros_is_refused_without_being_read() {
    let path = folder("gigabyte").join("zeros.toml");
    File::create(&path).unwrap().set_len(1 << 30).unwrap();
    let error = Scene::read(&path).unwrap_err();
    assert!(matches!(error, SceneError::TooLarge { bytes: 1_073_741_824, .. }), "{error}");
    assert!(
        error
            .to_string()
            .ends_with("zeros.toml: has 1073741824 bytes; a scene has at most 4194304")
    );
}

#[test]
fn a_text_is_bounded_like_a_file() {
    let bytes = limits::FILE_BYTES as usize;
    let error = Scene::parse("text", &"\n".repeat(bytes + 1)).unwrap_err();
    assert!(matches!(error, SceneError::TooLarge { .. }));
    // The largest file that is read: blank lines, then nothing.
    let path = written("blank", "\n".repeat(bytes).as_bytes());
    let error = Scene::read(&path).unwrap_err().to_string();
    assert!(error.starts_with("error: missing field `dimension`"), "{error}");
}

#[test]
fn zeros_are_no_scene() {
    let path = written("zeros", &[0; 1000]);
    let error = Scene::read(&path).unwrap_err();
    assert!(matches!(error, SceneError::Invalid(_)));
    assert!(error.to_string().contains("scene.toml:1:"), "{error}");
}

#[test]
fn a_folder_is_not_a_file() {
    let error = Scene::read(folder("folder")).unwrap_err();
    assert!(matches!(error, SceneError::NotAFile { .. }));
    assert!(error.to_string().ends_with("folder: is not a file"));
}

#[cfg(unix)]
#[test]
fn a_device_without_end_is_not_a_file() {
    assert!(matches!(Scene::read("/dev/zero"), Err(SceneError::NotAFile { .. })));
}

#[test]
fn a_missing_file_is_named() {
    let error = Scene::read(folder("missing").join("nowhere.toml")).unwrap_err();
    assert!(matches!(error, SceneError::Read { .. }));
    assert!(error.to_string().contains("nowhere.toml: cannot be read: "), "{error}");
}

#[test]
fn bytes_that_are_no_text_are_found() {
    let path = written("latin", b"title = \"a\"\nname = \"\xc3\xbc \xfc\"\n");
    let error = Scene::read(&path).unwrap_err();
    assert!(matches!(error, SceneError::NotUtf8 { line: 2, column: 11, .. }), "{error:?}");
    assert!(error.to_string().ends_with("scene.toml:2:11: the bytes here are not UTF-8 text"));
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let run = Scene::parse("ball", BALL).unwrap().run().unwrap();
    let file = written("unwritable", b"a file, not a folder");
    let error = run.write(&file).unwrap_err();
    assert_eq!(error.path, file);
    assert!(error.to_string().contains("scene.toml: cannot be written: "), "{error}");
    assert!(run.write(file.join("below")).is_err());

    let taken = folder("taken");
    fs::create_dir(taken.join("observables.csv")).unwrap();
    let error = run.write(&taken).unwrap_err();
    assert_eq!(error.path, taken.join("observables.csv"));
}

#[test]
fn a_run_is_written_into_a_folder_that_it_makes() {
    let run = Scene::parse("ball", BALL).unwrap().run().unwrap();
    let out = folder("out").join("a").join("b");
    run.write(&out).unwrap();
    let read = |name: &str| fs::read_to_string(out.join(name)).unwrap();
    let trajectory = "time [s],particle,x [m]\n0.0,ball,0.0\n1.0,ball,1.0\n2.0,ball,2.0\n";
    assert_eq!(read("trajectory.csv"), trajectory);
    assert_eq!(
        read("observables.csv"),
        "time [s],energy [kg m^2/s^2],linear momentum x [kg m/s]\n\
         0.0,0.5,1.0\n1.0,0.5,1.0\n2.0,0.5,1.0\n"
    );
    assert_eq!(read("picture.svg"), run.picture());
}
