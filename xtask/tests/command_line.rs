//! What the command line says: once, in words, and to whoever still listens.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn xtask(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    command.args(arguments).current_dir(env!("CARGO_TARGET_TMPDIR"));
    command
}

fn ran(arguments: &[&str]) -> Output {
    xtask(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("command-line").join(name);
    fs::remove_dir_all(&folder).ok();
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn scene(name: &str) -> String {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/scene/scenes");
    scenes.join(format!("{name}.toml")).display().to_string()
}

const LONG: &str = "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = 1e-9\nhorizon = 10\n\
    sample_every = 1_000_000_000\nparticles = [{ name = \"a\", mass = 1, position = [0] }]\n";

/// A run of hours.
fn long(folder: &Path) -> String {
    let file = folder.join("long.toml");
    fs::write(&file, LONG).unwrap();
    file.display().to_string()
}

#[cfg(unix)]
#[test]
fn a_program_whose_output_nobody_reads_ends_without_a_word() {
    use std::os::unix::process::ExitStatusExt;

    let here = folder("pipe");
    let out = here.join("out").display().to_string();
    let run = ["run", &scene("thrown-racket"), "--out", &out];
    for arguments in [&["report", "--list"][..], &["trials", "--list"], &run] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let child = xtask(arguments).stdout(writer).stderr(Stdio::piped()).spawn().unwrap();
        let output = child.wait_with_output().unwrap();
        assert_eq!(said(&output), "", "{arguments:?}");
        // SIGPIPE, as of `ls | head -0`.
        assert_eq!(output.status.signal(), Some(13), "{arguments:?}: {:?}", output.status);
    }
    assert!(here.join("out/trajectory.csv").exists());
}

#[test]
fn a_folder_that_cannot_be_written_is_told_before_the_run() {
    let here = folder("out");
    let file = here.join("a-file");
    fs::write(&file, "").unwrap();
    let taken = here.join("taken");
    fs::create_dir_all(taken.join("trajectory.csv")).unwrap();
    fs::write(taken.join("trajectory"), "").unwrap();
    let series = here.join("series");
    fs::create_dir_all(&series).unwrap();
    fs::write(series.join("trajectory"), "").unwrap();
    for (out, more, place) in [
        (file.clone(), None, "a-file"),
        (file.join("below"), None, "below"),
        (taken, None, "trajectory.csv"),
        (series, Some("--vtk"), "trajectory"),
        (PathBuf::from("/proc/nowhere"), None, "/proc/nowhere"),
    ] {
        let (long, out) = (long(&here), out.display().to_string());
        let arguments: Vec<&str> = ["run", &long, "--out", &out].into_iter().chain(more).collect();
        let output = ran(&arguments);
        let words = said(&output);
        assert_eq!(output.status.code(), Some(1), "{words}");
        assert!(words.contains("cannot be written") && words.contains(place), "{words}");
        assert_eq!(words.matches("error:").count(), 1, "{words}");
    }
}

#[test]
fn a_run_that_is_resumed_without_a_checkpoint_says_that_it_starts_anew() {
    let out = folder("anew").display().to_string();
    let arguments = ["run", &scene("thrown-racket"), "--out", &out, "--resume", "--quiet"];
    let output = ran(&arguments);
    assert!(output.status.success());
    assert_eq!(said(&output), format!("no checkpoint in {out}: the run starts anew\n"));
    assert_eq!(said(&ran(&["run", &scene("thrown-racket"), "--out", &out, "--quiet"])), "");
}

#[test]
fn an_unstable_step_is_told_before_the_run() {
    let here = folder("unstable");
    let file = here.join("spring.toml");
    let text = "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = 0.2\nhorizon = 2\n\
        particles = [{ name = \"a\", pinned = true, position = [0] }, \
        { name = \"b\", mass = 0.2, position = [1] }]\n\
        springs = [{ between = [\"a\", \"b\"], stiffness = 50 }]\n";
    fs::write(&file, text).unwrap();
    let [file, out] = [file, here.join("out")].map(|path| path.display().to_string());
    let words = said(&ran(&["run", &file, "--out", &out]));
    let expected =
        "warning: the step 0.2 is unstable: `stormer-verlet` is stable up to a step of 1.2e-1";
    assert!(words.starts_with(expected), "{words}");
}

#[test]
fn every_wrong_command_says_error_once() {
    let here = folder("wrong");
    let wrong = here.join("wrong.toml");
    fs::write(&wrong, LONG.replace("mass = 1", "mass = {}")).unwrap();
    let bytes = here.join("bytes.toml");
    fs::write(&bytes, [0xff, 0xfe]).unwrap();
    let late = here.join("late.toml");
    let text = LONG.replace("1e-9", "1").replace("1_000_000_000", "1");
    let rods = "integrator = \"rattle\"\nparticles = [{ name = \"a\", mass = 1, position = [0] }, \
        { name = \"b\", mass = 1, position = [1], velocity = [1] }]\nrods = [{ between = [\"a\", \"b\"] }]\n";
    let text = text.replace("integrator = \"stormer-verlet\"\n", "");
    fs::write(&late, text.split("particles").next().unwrap().to_owned() + rods).unwrap();
    let [wrong, bytes, late, here] =
        [wrong, bytes, late, here].map(|path| path.display().to_string());
    let (net, missing) = (scene("spring-net"), format!("{here}/missing.toml"));
    let out = format!("{here}/out");
    let mut commands: Vec<Vec<&str>> = vec![
        vec![],
        vec!["frobnicate"],
        vec!["run"],
        vec!["run", &wrong],
        vec!["run", &wrong, "--out"],
        vec!["report", "--only", "nothing"],
        vec!["report", "--shard", "9/2"],
        vec!["merge", &here],
        vec!["trials", "--only", "nothing"],
        vec!["trials", "--shard", "0/0"],
        vec!["check-page", &missing],
        vec!["choose", &net],
        vec!["choose", &net, "--observable", "nothing", "--tolerance", "1e-3"],
        vec!["choose", &net, "--observable", "energy", "--tolerance", "none"],
        vec!["choose", &net, "--observable", "energy", "--tolerance", "1e-3", "--budget", "long"],
        vec!["choose", &net, "--observable", "energy", "--tolerance", "-1"],
    ];
    for file in [&wrong, &bytes, &missing, &here, &late] {
        commands.push(vec!["run", file, "--out", &out]);
        commands.push(vec!["report", "--problem", file, "--out", &out]);
        commands.push(vec!["choose", file, "--observable", "energy", "--tolerance", "1e-3"]);
    }
    for arguments in commands {
        let output = ran(&arguments);
        let words = said(&output);
        assert!(!output.status.success(), "{arguments:?}");
        assert!(words.matches("error:").count() <= 1, "{arguments:?}\n{words}");
        assert!(!words.contains("panicked"), "{arguments:?}\n{words}");
        assert!(!words.is_empty() || !output.stdout.is_empty(), "{arguments:?}");
        for internal in ["i128", "Err(", "Some(", " map,"] {
            assert!(!words.contains(internal), "{arguments:?}\n{words}");
        }
    }
}
