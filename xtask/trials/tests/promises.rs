//! As many random cases of each kind as fit into a minute for all, and all that were ever found wrong.

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use stationary_trials::{Draw, Kind, Plan, Verdict};

/// The seed of the tests' cases.
const SEED: u64 = 20_261_122;

#[test]
fn no_kind_has_a_wrong_case() {
    let mut wrong = Vec::new();
    for kind in Kind::all() {
        assert!(kind.in_tests >= 50, "{} runs {} cases", kind.name, kind.in_tests);
        let plan = Plan { seed: SEED, cases: kind.in_tests, shard: (0, 1), limit: Duration::MAX };
        let tally = plan.run(kind);
        assert_eq!(tally.tried, kind.in_tests);
        wrong.extend(tally.faults.into_iter().map(|fault| (kind.name, fault)));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Each line of `found/*.tsv`: the kind, the case's seed, what was wrong before it was mended, and
/// `refused` where it is an error now instead of an answer.
#[test]
fn what_trials_have_found_is_mended() {
    let mut wrong = Vec::new();
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("found")).unwrap() {
        let path = entry.unwrap().path();
        // A crate whose trials are not compiled here has none.
        if !Kind::all().any(|kind| path.file_stem().is_some_and(|krate| krate == kind.krate)) {
            continue;
        }
        let text = fs::read_to_string(path).unwrap();
        for line in text.lines().filter(|line| !line.starts_with('#')) {
            let mut cells = line.split('\t');
            let (name, case) = (cells.next().unwrap(), cells.next().unwrap());
            let Some(kind) = Kind::all().find(|kind| kind.name == name) else {
                panic!("no kind `{name}`");
            };
            let verdict = (kind.trial)(&mut Draw::new(case.parse().unwrap()));
            let may_refuse = cells.nth(1) == Some("refused");
            let is_mended = match verdict {
                Verdict::Right { .. } | Verdict::NotJudged { .. } | Verdict::Apart { .. } => true,
                Verdict::Refused { .. } => may_refuse,
                Verdict::Wrong { .. } => false,
            };
            if !is_mended {
                wrong.push((line.to_owned(), verdict));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// As in `stationary-trials --list | head -1`.
#[cfg(unix)]
#[test]
fn a_reader_that_leaves_ends_the_program_without_a_word() {
    let program = env!("CARGO_BIN_EXE_stationary-trials");
    let mut child = Command::new(program)
        .arg("--list")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    let status = child.wait().unwrap();
    assert!(said.is_empty() && status.code() != Some(101), "{status}: {said}");
}

#[test]
fn a_crates_name_stands_for_all_of_its_kinds() {
    let listed = |name: &str| {
        let trials = env!("CARGO_BIN_EXE_stationary-trials");
        Command::new(trials).args(["--list", "--only", name]).output().unwrap()
    };
    let text = String::from_utf8(listed("calculus").stdout).unwrap();
    let crates: Vec<&str> =
        text.lines().filter_map(|kind| kind.split_whitespace().nth(1)).collect();
    assert!(crates.len() > 1 && crates.iter().all(|name| *name == "calculus"), "{text}");
    assert!(!listed("nothing").status.success());
}
