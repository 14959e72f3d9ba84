//! `stationary run FILE --out DIR`: a scene file to a trajectory, with a bar while it runs.
//!
//! The folder is made and tried before the run, and a step that is not stable is told. A run keeps a
//! checkpoint in its folder, a fresh one every few seconds and one when it is asked to
//! end, and takes it away when it reaches the horizon. Checkpoints take at most a twentieth of the
//! time.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::program::failed;
use indicatif::{ProgressBar, ProgressStyle};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use stationary_scene::{
    Checkpoint, CheckpointError, Control, Observer, Parameters, Progress as Step, Run as SceneRun,
    RunError, Scene, SceneError, Summary, WriteError, make_folder,
};

/// Runs a scene file and writes its trajectory, observables and picture.
#[derive(Debug, clap::Args)]
pub struct Run {
    /// The scene, a TOML file.
    file: PathBuf,
    /// Where to write.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Writes a file a sample for ParaView as well.
    #[arg(long)]
    vtk: bool,
    /// Another value for a parameter of the scene; may be given for several.
    #[arg(long, value_name = "NAME=VALUE", value_parser = parameter)]
    set: Vec<(String, f64)>,
    /// Goes on from the checkpoint that an interrupted run has left in DIR; starts anew where there is
    /// none.
    #[arg(long)]
    resume: bool,
    /// Shows no bar and no summary: only warnings and what failed.
    #[arg(long)]
    quiet: bool,
}

/// What `--set` says.
fn parameter(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE, such as L=0.4")?;
    let number: f64 = value.trim().parse().map_err(|_| format!("`{value}` is not a number"))?;
    match number.is_finite() {
        true => Ok((name.trim().to_owned(), number)),
        false => Err(format!("the value is {number}; it must be finite")),
    }
}

/// What a shell says of a program that control-C has ended.
const INTERRUPTED: u8 = 130;

impl Run {
    fn parameters(&self) -> Parameters {
        self.set.iter().fold(Parameters::new(), |all, (name, value)| all.with(name, *value))
    }

    /// Runs the scene until its horizon, or until the program is asked to end.
    pub(super) fn run(&self) -> Result<ExitCode, Box<dyn std::error::Error>> {
        let stop = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            // Who asks twice does not want to wait.
            flag::register_conditional_shutdown(signal, INTERRUPTED.into(), Arc::clone(&stop))?;
            flag::register(signal, Arc::clone(&stop))?;
        }
        let ending = run_job(&Job {
            file: &self.file,
            parameters: &self.parameters(),
            out: &self.out,
            start: if self.resume { Start::Resumed } else { Start::Fresh },
            series: if self.vtk { Series::Vtk } else { Series::None },
            progress: if self.quiet { Progress::Hidden } else { Progress::Shown },
            stop: &stop,
        })?;
        if !self.quiet {
            println!("{}\n{}\n{}", ending.summary, ending.summary.built, self.out.display());
        }
        let Some(step) = ending.stopped else {
            return Ok(match ending.summary.broken_claims {
                0 => ExitCode::SUCCESS,
                1 => failed("a claim of the scene does not hold; the summary says which"),
                n => {
                    failed(&format!("{n} claims of the scene do not hold; the summary says which"))
                }
            });
        };
        eprintln!("stopped after step {step}; the same command with --resume goes on");
        Ok(ExitCode::from(INTERRUPTED))
    }
}

/// Whether there is a bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// There is.
    Shown,
    /// There is not.
    Hidden,
}

/// A scene that was not run to its end, or whose results were not written.
#[derive(Debug, thiserror::Error)]
pub enum RunSceneError {
    /// The file is no scene.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// The run stopped early. What it had computed is in the folder.
    #[error("{0}")]
    Run(#[from] RunError),
    /// The checkpoint in the folder cannot be used.
    #[error("{}: {source}", path.display())]
    Checkpoint {
        /// The file.
        path: PathBuf,
        /// Why.
        source: Box<CheckpointError>,
    },
    /// The folder cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
}

/// Where a run begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// At the scene's start.
    Fresh,
    /// At the checkpoint in the folder, or at the scene's start where there is none.
    Resumed,
}

/// What is written besides the tables, the pictures and the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Series {
    /// Nothing.
    None,
    /// A file a sample, for ParaView.
    Vtk,
}

/// A scene to be run.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// The scene's file.
    pub file: &'a Path,
    /// Other values for its parameters.
    pub parameters: &'a Parameters,
    /// Where to write.
    pub out: &'a Path,
    /// Where to begin.
    pub start: Start,
    /// What else to write.
    pub series: Series,
    /// Whether there is a bar.
    pub progress: Progress,
    /// Becomes true when the run is to end.
    pub stop: &'a AtomicBool,
}

/// How a run ended that met no error.
#[derive(Clone, Debug, PartialEq)]
pub struct Ending {
    /// What it came to.
    pub summary: Summary,
    /// Where it was asked to end, before the horizon: after this step. The checkpoint is there.
    pub stopped: Option<u64>,
}

/// How many times the bar moves over a run: redrawing costs more than a step.
const MOVES: u64 = 200;

/// Time from one checkpoint to the next, and how much longer than writing one that is at least.
const EVERY: Duration = Duration::from_secs(5);
const PART: u32 = 20;

/// The name of the checkpoint in the folder.
const CHECKPOINT: &str = "checkpoint";

/// Runs the scene in `file` and writes its trajectory, observables, pictures and page into `out`.
///
/// # Errors
/// [`RunSceneError`]. Of a run that stopped early, what was computed is written all the same.
pub fn run_scene(file: &Path, out: &Path, progress: Progress) -> Result<Summary, RunSceneError> {
    let stop = AtomicBool::new(false);
    let parameters = &Parameters::new();
    let job = Job {
        file,
        parameters,
        out,
        start: Start::Fresh,
        series: Series::None,
        progress,
        stop: &stop,
    };
    run_job(&job).map(|ending| ending.summary)
}

/// Runs a scene, from its start or from a checkpoint.
///
/// # Errors
/// [`RunSceneError`], before the run where the folder cannot be written. Of a run that stopped early,
/// what was computed is written all the same.
pub fn run_job(job: &Job<'_>) -> Result<Ending, RunSceneError> {
    let scene = Scene::read_with(job.file, job.parameters)?;
    make_folder(job.out)?;
    if job.series == Series::Vtk {
        make_folder(job.out.join("trajectory"))?;
    }
    let path = job.out.join(CHECKPOINT);
    let checkpoint = found(&path, job.start)?;
    if job.start == Start::Resumed && checkpoint.is_none() {
        eprintln!("no checkpoint in {}: the run starts anew", job.out.display());
    }
    if let Some(unstable) = scene.unstable_step() {
        eprintln!("warning: {unstable}");
    }
    let mut keeper = Keeper::new(job, &scene, checkpoint.as_ref(), &path);
    let run = scene.run_from(checkpoint, &mut keeper);
    keeper.bar.finish_and_clear();
    let steps = scene.timing().steps();
    match run {
        Ok(run) => {
            write(&run, job)?;
            let stopped = (keeper.done < steps).then_some(keeper.done);
            if stopped.is_none() {
                // Of a short run there never was one.
                fs::remove_file(&path).ok();
            }
            Ok(Ending { summary: run.summary(), stopped })
        }
        Err(RunError::Checkpoint(source)) => {
            Err(RunSceneError::Checkpoint { path, source: Box::new(source) })
        }
        Err(error) => {
            if let Some(partial) = error.partial() {
                write(partial, job)?;
            }
            Err(error.into())
        }
    }
}

fn write(run: &SceneRun, job: &Job<'_>) -> Result<(), WriteError> {
    run.write(job.out)?;
    match job.series {
        Series::Vtk => run.write_vtk(job.out),
        Series::None => Ok(()),
    }
}

/// The checkpoint from which the run begins.
fn found(path: &Path, start: Start) -> Result<Option<Checkpoint>, RunSceneError> {
    let failed =
        |source| RunSceneError::Checkpoint { path: path.to_owned(), source: Box::new(source) };
    if start == Start::Fresh {
        return Ok(None);
    }
    match Checkpoint::read(path) {
        Err(CheckpointError::Read { source, .. }) if source.kind() == io::ErrorKind::NotFound => {
            Ok(None)
        }
        read => read.map(Some).map_err(failed),
    }
}

/// Moves the bar and keeps checkpoints.
struct Keeper<'a> {
    stop: &'a AtomicBool,
    path: &'a Path,
    bar: ProgressBar,
    move_every: u64,
    done: u64,
    last: Instant,
    wait: Duration,
    /// A checkpoint was made, or could not be, since the run was asked to end.
    kept: bool,
}

impl<'a> Keeper<'a> {
    fn new(job: &Job<'a>, scene: &Scene, checkpoint: Option<&Checkpoint>, path: &'a Path) -> Self {
        let (steps, done) = (scene.timing().steps(), checkpoint.map_or(0, Checkpoint::step));
        let bar = match job.progress {
            Progress::Shown => ProgressBar::new(steps),
            Progress::Hidden => ProgressBar::hidden(),
        };
        if let Ok(style) =
            ProgressStyle::with_template("{bar:40} {percent}% of {len} steps, {eta} left")
        {
            bar.set_style(style);
        }
        bar.set_position(done);
        bar.reset_eta();
        Keeper {
            stop: job.stop,
            path,
            bar,
            move_every: steps.div_ceil(MOVES).max(1),
            done,
            last: Instant::now(),
            wait: EVERY,
            kept: false,
        }
    }
}

/// Steps between two looks at the clock.
const LOOK: u64 = 64;

impl Observer for Keeper<'_> {
    fn stepped(&mut self, now: Step<'_>) -> Control {
        self.done = now.step;
        if now.step.is_multiple_of(self.move_every) {
            self.bar.set_position(now.step);
        }
        if self.stop.load(Ordering::Relaxed) {
            return if self.kept { Control::Stop } else { Control::Checkpoint };
        }
        match now.step.is_multiple_of(LOOK) && self.last.elapsed() > self.wait {
            true => Control::Checkpoint,
            false => Control::Continue,
        }
    }

    fn keep(&mut self, checkpoint: &Checkpoint) {
        let begun = Instant::now();
        let made = self.path.parent().map_or(Ok(()), fs::create_dir_all);
        let written = made.map_err(|error| error.to_string());
        let written =
            written.and_then(|()| checkpoint.write(self.path).map_err(|error| error.to_string()));
        // A run goes on without checkpoints rather than not at all.
        if let Err(error) = written {
            self.bar.suspend(|| eprintln!("no checkpoint: {error}"));
        }
        self.last = Instant::now();
        self.wait = EVERY.max(begun.elapsed() * PART);
        self.kept = self.stop.load(Ordering::Relaxed);
    }
}
