//! The tower in MuJoCo: a process of Python's, which says what it took and writes its states.

use std::process::Command;

use crate::space::{drift, leaning, seen};
use crate::{Row, STEP};

/// Nothing where there is no interpreter that has `mujoco`.
pub fn tower(high: usize, time: f64) -> Option<Row> {
    let python = std::env::var("PYTHON").ok()?;
    let boxes = leaning(high);
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tower.py");
    let offsets = boxes.state.q.chunks_exact(7).map(|pose| format!("{:e},{:e}", pose[0], pose[1]));
    let steps = (time / STEP).round() as usize;
    let run = Command::new(python)
        .arg(script)
        .args([steps.to_string(), STEP.to_string()])
        .args(offsets)
        .output()
        .ok()?;
    let said = String::from_utf8(run.stdout).ok()?;
    let mut lines = said.lines();
    let mut row = Row::named("MuJoCo");
    row.time = lines.next()?.parse().ok()?;
    let mut numbers = || -> Option<Vec<f64>> {
        lines.next()?.split(' ').map(|number| number.parse().ok()).collect()
    };
    let (q, before, after) = (numbers()?, numbers()?, numbers()?);
    row.left = seen(&mut boxes.detector().ok()?, &q, &before, &after);
    row.drift = drift(&q, &boxes.state.q);
    Some(row)
}
