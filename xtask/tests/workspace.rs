//! The real workspace keeps its own rules.

use xtask::layers::{Metadata, check, check_tree};

#[test]
fn the_workspace_breaks_no_rule() {
    let metadata = Metadata::read().unwrap();
    let violations: Vec<String> = check(&metadata)
        .iter()
        .chain(&check_tree(&metadata).unwrap())
        .map(ToString::to_string)
        .collect();
    assert!(violations.is_empty(), "\n{}", violations.join("\n"));
}
