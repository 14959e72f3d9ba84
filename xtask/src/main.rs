//! `cargo xtask <task>`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use stationary::program::{end_with_the_reader, failed, time};
use stationary_scene::Scene;
use stationary_scene::choose::Question;
use xtask::check_page::check_pages;
use xtask::choosing;
use xtask::cost::{Build, Cost, cost, table};
use xtask::kernels::kernels;
use xtask::layers::{Metadata, check, check_tree};
use xtask::licenses::unlicensed;
use xtask::mentions::mentions;
use xtask::readme::readmes;
use xtask::report::{
    Outcome, Plan, Progress, Shard, catalogue, merge, report, select, shard, summary,
};
use xtask::studies::{METHODS, STUDIES, scene};
use xtask::study::{Entry, Size};
use xtask::sweep;

/// The project's tools.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Runs the studies and writes the page, the numbers and the charts.
    Report(Report),
    /// Runs a scene for many values of its parameters, and leaves one table and one chart.
    Sweep(Sweep),
    /// Joins the shares of a report or of a sweep that were run with `--shard`.
    Merge {
        /// The folders of all shares.
        #[arg(required = true)]
        dirs: Vec<PathBuf>,
        /// Where to write.
        #[arg(long, value_name = "DIR", default_value = "target/report")]
        out: PathBuf,
        /// Says nothing but what failed.
        #[arg(long)]
        quiet: bool,
    },
    /// Runs, chooses how to run, finds the words of, and begins scene files, as the program `stationary` does.
    #[command(flatten)]
    Stationary(stationary::program::Command),
    /// Tests promises on random problems, each with a referee that knows the truth by another way.
    Trials(stationary_trials::Arguments),
    /// Checks that every dependency may be used under the licences of the crates.
    Licenses,
    /// Checks which crate depends on what, and that the docs name what exists.
    Layers,
    /// Writes the README of each crate from the front page of its source, and its studies onto its page.
    Readmes,
    /// Counts the packages that each crate pulls in, and times its clean release build.
    Cost {
        /// Counts only.
        #[arg(long)]
        no_build: bool,
    },
    /// Times the hot kernels as this workspace tunes its benches and as Cargo's own profile builds them.
    Kernels,
    /// Opens pages in headless Chromium and complains about what a reader would.
    CheckPage {
        /// Pages, or folders with index.html.
        #[arg(value_name = "PAGE", default_value = "target/report")]
        pages: Vec<PathBuf>,
    },
}

#[derive(clap::Args)]
struct Report {
    /// Where to write.
    #[arg(long, value_name = "DIR", default_value = "target/report")]
    out: PathBuf,
    /// Names the studies and runs none.
    #[arg(long)]
    list: bool,
    /// Runs this study only; may be given again.
    #[arg(long, value_name = "ID")]
    only: Vec<String>,
    /// Studies this scene, a TOML file, and nothing else.
    #[arg(long, value_name = "FILE")]
    problem: Option<PathBuf>,
    /// What to ask of that scene, as `choose` does; the first observable of its file by default.
    #[arg(long, value_name = "NAME", requires = "problem")]
    observable: Option<String>,
    /// The error that may be made there, relative to the observable's scale.
    #[arg(long, value_name = "ERROR", default_value_t = 1e-3)]
    tolerance: f64,
    /// The time that the search may take there.
    #[arg(long, value_name = "TIME", default_value = "60s")]
    budget: String,
    /// Runs full horizons; may take an hour.
    #[arg(long)]
    full: bool,
    /// Runs a share of the studies, such as 3/8, for `merge` to join.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Says nothing but what failed.
    #[arg(long)]
    quiet: bool,
}

#[derive(clap::Args)]
struct Sweep {
    /// The scene, a TOML file with `[parameters]`.
    file: PathBuf,
    /// The values of a parameter, such as L=0.1:1.0:10 for ten of them, or L=0.4; may be given for
    /// several. The chart is against the first.
    #[arg(long, value_name = "NAME=FROM:TO:COUNT", required = true)]
    set: Vec<sweep::Range>,
    /// What to read off, as `choose` calls it: energy, position=bob; the first observable of the
    /// file by default.
    #[arg(long, value_name = "NAME")]
    observable: Option<String>,
    /// Runs a share of the family, such as 3/8, for `merge` to join.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Where to write.
    #[arg(long, value_name = "DIR", default_value = "target/sweep")]
    out: PathBuf,
    /// Says nothing but what failed.
    #[arg(long)]
    quiet: bool,
}

type Failure = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    let task = Arguments::parse().task;
    // A browser that ends is an error of the check, not the end of it.
    if !matches!(task, Task::CheckPage { .. })
        && let Err(error) = end_with_the_reader()
    {
        return failed(&error.to_string());
    }
    let done = match task {
        Task::Report(arguments) => run_report(&arguments),
        Task::Sweep(arguments) => run_sweep(&arguments),
        Task::Merge { dirs, out, quiet } => run_merge(&dirs, &out, quiet),
        Task::Stationary(command) => command.run(),
        Task::Trials(arguments) => run_trials(&arguments),
        Task::Licenses => run_licenses(),
        Task::Layers => run_layers(),
        Task::Readmes => run_readmes(),
        Task::Cost { no_build } => run_cost(if no_build { Build::Skipped } else { Build::Timed }),
        Task::Kernels => kernels()
            .map(|kernels| {
                print!("{}", kernels.table());
                ExitCode::SUCCESS
            })
            .map_err(Failure::from),
        Task::CheckPage { pages } => run_check_pages(&pages),
    };
    done.unwrap_or_else(|error| failed(&error.to_string()))
}

fn run_report(arguments: &Report) -> Result<ExitCode, Failure> {
    let Some(file) = &arguments.problem else { return run_studies(arguments, STUDIES) };
    Scene::read(file)?;
    let question = Question {
        observable: arguments.observable.clone().map_or_else(|| scene::observable(file), Ok)?,
        horizon: None,
    };
    let (tolerance, budget) = (arguments.tolerance, time(&arguments.budget)?);
    let work_precision = |_| scene::work_precision(file, &question, tolerance, budget);
    let long_run = |_| scene::long_run(file);
    run_studies(arguments, &scene::entries(&work_precision, &long_run))
}

fn run_studies(arguments: &Report, studies: &[Entry<'_>]) -> Result<ExitCode, Failure> {
    let entries = select(studies, &arguments.only)?;
    if arguments.list {
        print!("{}", catalogue(&entries));
        return Ok(ExitCode::SUCCESS);
    }
    let plan = Plan {
        entries,
        methods: METHODS.to_vec(),
        size: if arguments.full { Size::Full } else { Size::Default },
        out: arguments.out.clone(),
        progress: if arguments.quiet { Progress::Hidden } else { Progress::Shown },
    };
    let (outcomes, file) = match arguments.shard {
        Some(share) => (shard(&plan, share)?, "shard.toml"),
        None => (report(&plan)?, "index.html"),
    };
    Ok(reported(&outcomes, &plan.out.join(file), arguments.quiet))
}

fn run_merge(dirs: &[PathBuf], out: &Path, quiet: bool) -> Result<ExitCode, Failure> {
    let of_sweeps = dirs.iter().filter(|dir| sweep::is_share(dir)).count();
    if of_sweeps > 0 {
        let reports = dirs.iter().find(|dir| dir.join("shard.toml").is_file());
        if let Some(dir) = reports {
            let dir = dir.display();
            return Err(
                format!("{dir} has a share of a report, and others those of a sweep").into()
            );
        }
        return Ok(swept(&sweep::merge(dirs, out)?, &out.join("sweep.csv"), quiet));
    }
    let outcomes = merge(dirs, STUDIES, METHODS, out)?;
    Ok(reported(&outcomes, &out.join("index.html"), quiet))
}

fn run_sweep(arguments: &Sweep) -> Result<ExitCode, Failure> {
    let Sweep { file, set, observable, shard, out, quiet } = arguments;
    let family = sweep::Family::read(file, set, observable.as_deref())?;
    let progress = if *quiet { Progress::Hidden } else { Progress::Shown };
    let (rows, written) = match *shard {
        Some(shard) => (sweep::shard(&family, shard, out, progress)?, "sweep.toml"),
        None => (sweep::sweep(&family, out, progress)?, "sweep.csv"),
    };
    Ok(swept(&rows, &out.join(written), *quiet))
}

/// A run that failed is told, and no failure of the sweep unless all of them did.
fn swept(rows: &[sweep::Row], written: &Path, quiet: bool) -> ExitCode {
    let failures = sweep::failures(rows);
    if !quiet {
        println!("{} runs, {} failed\n{}", rows.len(), failures.len(), written.display());
    }
    let none_ran = !rows.is_empty() && failures.len() == rows.len();
    let verdict = verdict(failures.into_iter());
    if none_ran { verdict } else { ExitCode::SUCCESS }
}

fn reported(outcomes: &[Outcome<'_>], written: &Path, quiet: bool) -> ExitCode {
    if !quiet {
        print!("{}", summary(outcomes));
        println!("\n{}", written.display());
    }
    verdict(outcomes.iter().flat_map(|outcome| outcome.failures()))
}

fn run_trials(arguments: &stationary_trials::Arguments) -> Result<ExitCode, Failure> {
    Ok(if arguments.run_with(choosing::KINDS)? { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn run_licenses() -> Result<ExitCode, Failure> {
    Ok(verdict(unlicensed()?.iter().map(ToString::to_string)))
}

fn run_layers() -> Result<ExitCode, Failure> {
    let metadata = Metadata::read()?;
    let violations = check(&metadata).into_iter().chain(check_tree(&metadata)?);
    Ok(verdict(violations.map(|violation| violation.to_string())))
}

fn run_readmes() -> Result<ExitCode, Failure> {
    for readme in readmes()?.into_iter().chain(mentions()?) {
        std::fs::write(&readme.path, &readme.text)?;
    }
    Ok(ExitCode::SUCCESS)
}

fn run_cost(build: Build) -> Result<ExitCode, Failure> {
    let costs = cost(build)?;
    print!("{}", table(&costs));
    Ok(verdict(costs.iter().filter_map(Cost::complaint)))
}

fn run_check_pages(pages: &[PathBuf]) -> Result<ExitCode, Failure> {
    let complaints = check_pages(pages)?;
    let lines = pages.iter().zip(&complaints).flat_map(|(page, complaints)| {
        complaints.iter().map(move |complaint| format!("{}: {complaint}", page.display()))
    });
    Ok(verdict(lines))
}

/// Failure where there is anything to say, and says it.
fn verdict(lines: impl Iterator<Item = String>) -> ExitCode {
    let mut code = ExitCode::SUCCESS;
    for line in lines {
        eprintln!("{line}");
        code = ExitCode::FAILURE;
    }
    code
}
