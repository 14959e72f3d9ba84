//! Shares of a report that were run apart join into the report of one run.

use std::fs;
use std::path::Path;

use xtask::report::{Plan, Progress, Shard, merge, report, select, shard};
use xtask::studies::STUDIES;
use xtask::study::Size;

#[test]
fn shares_of_studies_that_time_differ_in_wall_times_only() {
    let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join("shares");
    let _ = fs::remove_dir_all(&root);
    let only = ["derivative-check", "one-step", "newton-initial-guesses"].map(str::to_owned);
    let plan = |out: &str| Plan {
        entries: select(STUDIES, &only).unwrap(),
        methods: Vec::new(),
        size: Size::Default,
        out: root.join(out),
        progress: Progress::Hidden,
    };
    let whole = report(&plan("whole")).unwrap();
    let folders = [1, 2].map(|share| {
        let part = plan(&share.to_string());
        shard(&part, Shard { share, of: 2 }).unwrap();
        part.out
    });
    let joined = merge(&folders, STUDIES, &[], &root.join("joined")).unwrap();
    assert_eq!(whole.len(), joined.len());
    for (whole, joined) in whole.iter().zip(&joined) {
        let (whole, joined) = (whole.result.as_ref().unwrap(), joined.result.as_ref().unwrap());
        assert_eq!(whole.table.to_string(), joined.table.to_string());
        assert_eq!(whole.conclusion, joined.conclusion);
    }
}
