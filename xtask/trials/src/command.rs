//! `cargo xtask trials`: which kinds to run, and what is printed of them.

use std::fs;
use std::io;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use crate::run::{explain, judge};
use crate::{Draw, Fault, Kind, Plan, Tally, Verdict};

/// Which trials to run.
#[derive(Args, Clone, Debug)]
pub struct Arguments {
    /// Runs this kind only, or all of this crate; may be given again.
    #[arg(long, value_name = "KIND")]
    only: Vec<String>,
    /// How many cases a kind.
    #[arg(long, value_name = "N", default_value_t = 1000)]
    cases: u64,
    /// Other seeds, other cases.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Runs a share of the cases, such as 3/8.
    #[arg(long, value_name = "I/N", value_parser = parse_shard)]
    shard: Option<(u64, u64)>,
    /// Writes the counts of each kind.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Begins no case of a kind after so many minutes of processor time.
    #[arg(long, value_name = "M")]
    minutes: Option<u64>,
    /// Runs one case by its own seed, as a wrong one is told.
    #[arg(long, value_name = "SEED", conflicts_with_all = ["cases", "seed", "shard"])]
    case: Option<u64>,
    /// Names the kinds with what each counts as wrong, and runs none.
    #[arg(long)]
    list: bool,
}

/// Why trials cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// There is no such kind.
    #[error("no kind of trial is called `{name}`; `--list` names them all")]
    UnknownKind {
        /// The name that was given.
        name: String,
    },
    /// The counts cannot be written.
    #[error("{}: {source}", path.display())]
    File {
        /// Where.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

fn parse_shard(words: &str) -> Result<(u64, u64), String> {
    let number = |word: &str| word.parse::<u64>().ok();
    let share = words.split_once('/').and_then(|(i, n)| Some((number(i)?, number(n)?)));
    match share {
        Some((i, n)) if 1 <= i && i <= n => Ok((i - 1, n)),
        _ => Err("a share is I/N with 1 <= I <= N, such as 3/8".to_owned()),
    }
}

impl Arguments {
    /// Runs the trials and prints what came of them; whether none was wrong.
    ///
    /// # Errors
    /// [`CommandError::UnknownKind`] and [`CommandError::File`].
    pub fn run(&self) -> Result<bool, CommandError> {
        self.run_with(&[])
    }

    /// The same with further kinds, of what stands above this crate.
    ///
    /// # Errors
    /// Those of [`Arguments::run`].
    pub fn run_with(&self, further: &'static [Kind]) -> Result<bool, CommandError> {
        self.run_kinds(self.kinds(further)?)
    }

    fn run_kinds(&self, kinds: Vec<&'static Kind>) -> Result<bool, CommandError> {
        if self.list {
            for kind in kinds {
                println!("{:<24} {:<12} {}", kind.name, kind.krate, kind.rule);
            }
            return Ok(true);
        }
        if let Some(case) = self.case {
            return Ok(kinds.into_iter().map(|kind| is_right(kind, case)).fold(true, |a, b| a & b));
        }
        let plan = Plan {
            seed: self.seed,
            cases: self.cases,
            shard: self.shard.unwrap_or((0, 1)),
            limit: self.minutes.map_or(Duration::MAX, |m| Duration::from_secs(60 * m)),
        };
        println!(
            "kind                     tried    right  refused  unjudged   wrong  worst ratio  seconds"
        );
        let tallies: Vec<Tally> = kinds
            .into_iter()
            .map(|kind| {
                let tally = plan.run(kind);
                print(&tally);
                tally
            })
            .collect();
        if let Some(path) = &self.json {
            let text = serde_json::to_string_pretty(&tallies).map_err(io::Error::other);
            text.and_then(|text| fs::write(path, text + "\n"))
                .map_err(|source| CommandError::File { path: path.clone(), source })?;
        }
        Ok(tallies.iter().all(|tally| tally.wrong == 0))
    }

    fn kinds(&self, further: &'static [Kind]) -> Result<Vec<&'static Kind>, CommandError> {
        let all = || Kind::all().chain(further);
        if self.only.is_empty() {
            return Ok(all().collect());
        }
        let mut kinds = Vec::new();
        for name in &self.only {
            let before = kinds.len();
            kinds.extend(all().filter(|kind| kind.name == name || kind.krate == name));
            if kinds.len() == before {
                return Err(CommandError::UnknownKind { name: name.clone() });
            }
        }
        Ok(kinds)
    }
}

fn print(tally: &Tally) {
    println!(
        "{:<22} {:>7} {:>8} {:>8} {:>9} {:>7} {:>12.3e} {:>8.1}",
        tally.kind,
        tally.tried,
        tally.right,
        tally.refused,
        tally.not_judged,
        tally.wrong,
        tally.worst,
        tally.seconds
    );
    for fault in &tally.faults {
        print_fault(tally.kind, fault);
    }
    if tally.apart > 0 {
        println!("    {} apart, neither right nor wrong:", tally.apart);
        for (case, what) in &tally.listed {
            println!("        --case {case}: {what}");
        }
    }
    if tally.is_shy() {
        println!("    more than a tenth had no answer:");
        let mut reasons: Vec<_> = tally.reasons.iter().collect();
        reasons.sort_by_key(|&(_, &count)| std::cmp::Reverse(count));
        for (why, count) in reasons.into_iter().take(6) {
            println!("    {count:>7} {why}");
        }
    }
}

fn print_fault(kind: &str, fault: &Fault) {
    println!("    wrong: {}", fault.what);
    println!("        --only {kind} --case {}", fault.case);
    if let Some((notes, what)) = &fault.shrunk {
        for note in notes {
            println!("        {note}");
        }
        println!("        shrunk: {what}");
    }
}

fn is_right(kind: &Kind, case: u64) -> bool {
    let mut draw = Draw::new(case);
    let verdict = judge(kind, &mut draw);
    for note in draw.into_parts().1 {
        println!("    {note}");
    }
    println!("{}: {verdict:?}", kind.name);
    if let Verdict::Wrong { what, .. } = verdict {
        print_fault(kind.name, &explain(kind, case, what));
        return false;
    }
    true
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Words {
        #[command(flatten)]
        arguments: Arguments,
    }

    const KIND: Kind = Kind {
        name: "made-up",
        krate: "none",
        rule: "",
        in_tests: 0,
        trial: |draw| Verdict::of(draw.uniform(0.0, 1.0), 2.0, "x"),
    };
    static RIGHT: Kind = KIND;
    static WRONG: Kind =
        Kind { trial: |draw| Verdict::of(draw.uniform(0.0, 1.0), 0.999, "x"), ..KIND };

    #[test]
    fn one_wrong_case_fails_the_command_and_stands_in_its_file() {
        let file = std::env::temp_dir().join(format!("trials-{}.json", std::process::id()));
        let words = ["trials", "--cases", "9999", "--seed", "7", "--json"];
        let words = words.map(str::to_owned).into_iter().chain([file.display().to_string()]);
        let arguments = Words::try_parse_from(words).unwrap().arguments;
        for (kind, held) in [(&RIGHT, true), (&WRONG, false)] {
            assert_eq!(arguments.run_kinds(vec![kind]).unwrap(), held);
            let text = fs::read_to_string(&file).unwrap();
            let counts: Vec<serde_json::Value> = serde_json::from_str(&text).unwrap();
            let count = |name: &str| counts[0][name].as_u64().unwrap();
            assert_eq!((counts[0]["kind"].as_str(), count("seed")), (Some("made-up"), 7));
            assert_eq!((count("tried"), count("right") + count("wrong")), (9999, 9999));
            assert_eq!((count("refused"), count("not_judged")), (0, 0));
            assert_eq!(count("wrong") == 0, held);
            assert_eq!(counts[0]["worst"].as_f64().unwrap() > 1.0, !held);
        }
        fs::remove_file(&file).unwrap();
    }
}
