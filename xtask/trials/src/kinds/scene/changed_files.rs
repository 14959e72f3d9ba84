//! Shipped scenes with numbers and lines changed at random: read, built and stepped a few times.
//!
//! A file is not trusted, so any of them may be refused. What is not refused has finite numbers, and
//! whatever happens happens soon.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use stationary_scene::{Run, Scene};

use crate::{Draw, Kind, Verdict};

/// Changed scene files.
pub const KIND: Kind = Kind {
    name: "changed-scenes",
    krate: "scene",
    rule: "a panic, a hang, or a run that ends with Ok and a number that is not finite",
    in_tests: 100,
    trial,
};

/// Runs are broken off after so many samples.
const SAMPLES: usize = 4;

fn trial(draw: &mut Draw) -> Verdict {
    let (folder, mut lines) = scene(draw);
    for _ in 0..draw.between(1, 4) {
        change(draw, &mut lines);
    }
    let text = lines.join("\n");
    let Ok(scene) = Scene::parse(&folder, &text) else { return Verdict::due() };
    let mut samples = 0;
    let run = scene.run_watched(|_| {
        samples += 1;
        if samples < SAMPLES { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    match run {
        Ok(run) if is_finite(&run) => Verdict::of(0.0, 1.0, "numbers"),
        Ok(_) => Verdict::wrong("Ok with a number that is not finite"),
        Err(_) => Verdict::due(),
    }
}

fn is_finite(run: &Run) -> bool {
    let samples = 0..run.times().len();
    run.energies().iter().all(|energy| energy.is_finite())
        && samples.clone().all(|i| run.positions(i).iter().all(|x| x.is_finite()))
        && samples.clone().all(|i| run.temperatures(i).iter().all(|x| x.is_finite()))
        && samples.clone().all(|i| run.observed(i).iter().all(|x| x.is_finite()))
}

/// A shipped scene: the path that it is read under, and its lines.
fn scene(draw: &mut Draw) -> (String, Vec<String>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../crates/scene/scenes");
    let files = fs::read_dir(folder).expect("the shipped scenes");
    let mut paths: Vec<_> = files.map(|file| file.expect("a file").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.sort();
    let path = draw.one_of(&paths);
    let text = fs::read_to_string(&path).expect("a shipped scene");
    (path.display().to_string(), text.lines().map(str::to_owned).collect())
}

/// Changes one number, or leaves a line out, or says one twice.
fn change(draw: &mut Draw, lines: &mut Vec<String>) {
    let at = draw.below(lines.len());
    match draw.below(8) {
        6 if lines.len() > 1 => {
            draw.note(format!("without `{}`", lines.remove(at)));
        }
        7 => {
            draw.note(format!("twice `{}`", lines[at]));
            lines.insert(at, lines[at].clone());
        }
        _ => {
            let numbers = numbers(&lines[at]);
            if numbers.is_empty() {
                return;
            }
            let (begin, end) = draw.one_of(&numbers);
            let number = number(draw, &lines[at][begin..end]);
            lines[at].replace_range(begin..end, &number);
            draw.note(lines[at].clone());
        }
    }
}

/// Another number in the place of `old`: the same times a power of ten, whole, negative, or any.
fn number(draw: &mut Draw, old: &str) -> String {
    let old: f64 = old.parse().unwrap_or(1.0);
    match draw.below(5) {
        0 => format!("{:e}", old * draw.log_uniform(0.1, 10.0)),
        1 => format!("{:e}", old * draw.log_uniform(1e-12, 1e12)),
        2 => format!("{}", draw.between(0, 40)),
        3 => format!("{:e}", -old),
        _ => match draw.any_f64() {
            x if x.is_nan() => "nan".to_owned(),
            x if x.is_infinite() => "inf".to_owned(),
            x => format!("{x:e}"),
        },
    }
}

/// Where the numbers of a line stand, comments and names with digits left out.
fn numbers(line: &str) -> Vec<(usize, usize)> {
    let code = line.split('#').next().unwrap_or_default();
    let is_part = |c: char| c.is_ascii_alphanumeric() || "._-+\"".contains(c);
    let mut spans = Vec::new();
    let mut begin = 0;
    for word in code.split(|c: char| !is_part(c)) {
        if word.starts_with(|c: char| c.is_ascii_digit() || c == '-') && word.parse::<f64>().is_ok()
        {
            spans.push((begin, begin + word.len()));
        }
        // The separators are single bytes wherever the line has numbers.
        begin += word.len() + 1;
    }
    spans.retain(|&(begin, end)| code.is_char_boundary(begin) && code.is_char_boundary(end));
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_where_they_stand() {
        let line = "position = [0, -1.5], name = \"a.1\" # 7";
        let found: Vec<&str> = numbers(line).iter().map(|&(a, b)| &line[a..b]).collect();
        assert_eq!(found, ["0", "-1.5"]);
    }
}
