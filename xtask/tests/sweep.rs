//! The family of a pendulum.

use std::fs;
use std::path::{Path, PathBuf};

use xtask::report::{Progress, Shard};
use xtask::sweep::{Family, MOST_RUNS, Range, SweepError, failures, merge, shard, sweep};

/// A rod of length L, let go at the angle `a`; a quarter of the period of L = 1 or less of it passes.
const PENDULUM: &str = r#"
title = "A pendulum"
dimension = 2
integrator = "rattle"
step = 0.001
horizon = 0.4
uniform_gravity = { acceleration = [0, "= -g"] }
observables = [{ position = "bob" }]
particles = [
    { name = "hook", position = [0, 0], pinned = true },
    { name = "bob", position = ["= L*sin(a)", "= -L*cos(a)"], mass = "= m" },
]
rods = [{ between = ["hook", "bob"] }]

[parameters]
g = 9.81
L = 1
a = 0.001
m = 1
"#;

fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("sweep-{name}"));
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

fn scene(folder: &Path) -> PathBuf {
    let file = folder.join("pendulum.toml");
    fs::write(&file, PENDULUM).unwrap();
    file
}

fn ranges(texts: &[&str]) -> Vec<Range> {
    texts.iter().map(|text| text.parse().unwrap()).collect()
}

fn cells(table: &str) -> Vec<Vec<&str>> {
    table.lines().map(|line| line.split(',').collect()).collect()
}

#[test]
fn the_period_of_a_pendulum_is_read_off_the_table() {
    let root = folder("period");
    let family = Family::read(&scene(&root), &ranges(&["L=0.25:1.0:4"]), None).unwrap();
    sweep(&family, &root, Progress::Hidden).unwrap();
    let table = fs::read_to_string(root.join("sweep.csv")).unwrap();
    // The headings have commas and quotes; the rows have none.
    let rows = cells(&table);
    assert_eq!(rows.len(), 5);
    for row in &rows[1..] {
        let [length, end, largest]: [f64; 3] =
            [row[0], row[1], row[2]].map(|cell| cell.parse().unwrap());
        // x(t) = x(0) cos(2 pi t / T) and T = 2 pi sqrt(L/g), both to a^2.
        let period = std::f64::consts::TAU * 0.4 / (end / largest).acos();
        let known = std::f64::consts::TAU * (length / 9.81).sqrt();
        assert!((period / known - 1.0).abs() < 5e-6, "L = {length}: {period} for {known}");
    }
}

#[test]
fn shares_join_into_the_files_of_the_whole_bit_for_bit() {
    let root = folder("shares");
    // At L = 0 the rod has no length, and without a mass nothing moves: both fail.
    let set = ranges(&["L=0:1:3", "m=0:2:3", "a=0.3"]);
    let family = Family::read(&scene(&root), &set, Some("energy")).unwrap();
    let whole = sweep(&family, &root.join("whole"), Progress::Hidden).unwrap();
    assert_eq!(failures(&whole).len(), 5);
    let folders: Vec<PathBuf> = (1..=4)
        .map(|share| {
            let out = root.join(share.to_string());
            shard(&family, Shard { share, of: 4 }, &out, Progress::Hidden).unwrap();
            out
        })
        .collect();
    let joined = merge(&folders, &root.join("joined")).unwrap();
    assert_eq!(whole, joined);
    for file in ["sweep.csv", "sweep.svg"] {
        let [whole, joined] =
            ["whole", "joined"].map(|folder| fs::read(root.join(folder).join(file)).unwrap());
        assert!(whole == joined, "{file}");
    }
    // What failed is named in the table and on the chart.
    let table = fs::read_to_string(root.join("whole/sweep.csv")).unwrap();
    let failed = cells(&table)[1].last().unwrap().to_owned();
    assert!(!failed.is_empty(), "{table}");
    let chart = fs::read_to_string(root.join("whole/sweep.svg")).unwrap();
    assert!(chart.contains("failed\nL: 0\n"), "{chart}");

    let missing = merge(&folders[..3], &root.join("out")).unwrap_err().to_string();
    assert_eq!(missing, "no share has run 4: shares are missing");
    let twice = [folders.clone(), folders[..1].to_vec()].concat();
    assert!(merge(&twice, &root.join("out")).unwrap_err().to_string().starts_with("share 1/4"));
    let text = fs::read_to_string(folders[3].join("sweep.toml")).unwrap();
    for (sound, broken) in
        [("run = 3\n", "run = 4\n"), ("of = 4", "of = 0"), ("run = 7\n", "run = 3\n")]
    {
        assert!(text.contains(sound), "{sound}: {text}");
        fs::write(folders[3].join("sweep.toml"), text.replace(sound, broken)).unwrap();
        let said = merge(&folders[3..], &root.join("out")).unwrap_err().to_string();
        assert!(said.contains("no share of this kind"), "{broken}: {said}");
    }
    let other = Family::read(&root.join("pendulum.toml"), &set, None).unwrap();
    shard(&other, Shard { share: 4, of: 4 }, &folders[3], Progress::Hidden).unwrap();
    let different = merge(&folders, &root.join("out")).unwrap_err().to_string();
    assert!(different.contains("another scene, observable or values"), "{different}");
    assert!(!root.join("out").exists());
}

#[test]
fn what_is_no_sweep_is_refused_before_anything_runs() {
    let root = folder("refused");
    let file = scene(&root);
    let refused = |set: &[&str], observable| {
        Family::read(&file, &ranges(set), observable).unwrap_err().to_string()
    };
    let said = refused(&["L=0.1:1:3", "M=1:2:3"], None);
    assert!(said.starts_with("the scene has no parameter `M`; did you mean `"), "{said}");
    assert!(said.ends_with("`?\n  --set M=1:2:3\n        ^"), "{said}");
    assert!(refused(&["L=1", "L=2:3:4"], None).starts_with("`L` is given twice\n  --set L=2:3:4"));
    assert!(refused(&["L=1"], Some("enrgy")).contains("energy"));
    let lost = refused(&["L=1"], Some("position=bib"));
    assert!(lost.contains("bob"), "{lost}");
    assert!(matches!(Family::read(&file, &[], None), Err(SweepError::Nothing)));
    let most = format!("L=0:1:{}", MOST_RUNS + 1);
    assert_eq!(refused(&[&most], None), "the sweep has 100001 runs; it may have 100000");
    let huge = format!("L=0:1:{}", usize::MAX);
    let said = refused(&[&huge, "m=1:2:3"], None);
    assert!(said.ends_with("x 3 runs; it may have 100000"), "{said}");
    let none = Family::read(&root.join("none.toml"), &ranges(&["L=1"]), None).unwrap_err();
    assert!(none.to_string().contains("none.toml"));
}
