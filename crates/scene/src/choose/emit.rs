//! The scene with the choice filled in, and a comment that says why.

use std::fs;
use std::path::Path;

use stationary_choose::{Answer, Experiment, Kind, Row};

use super::ChooseError;
use super::declaration::{Change, changed, commented};
use super::ladder::SceneLadder;
use crate::model::scene::Scene;
use crate::text::file_error::WriteError;

/// The scene's own text with the choice filled in; nothing where nothing is recommended.
///
/// Equal steps are sampled as often in time as the scene was. A method that chooses its own steps,
/// or needs none, is read off where the scene was, which moves none of its steps. Rigid bodies and
/// point masses that stand for others are asked for what was asked, the only places that they have.
///
/// # Errors
/// [`ChooseError::Scene`] where the choice does not fit the scene's own horizon.
pub fn emitted(
    name: &str,
    text: &str,
    answer: &Answer,
    ladder: &SceneLadder,
) -> Result<Option<String>, ChooseError> {
    let Some(row) = answer.choice() else { return Ok(None) };
    let family = &ladder.ladder().families[row.at.family];
    // Where a scene is read off is its own affair.
    let kept = |key| match family.kind {
        Kind::EqualSteps => key == "sample_every",
        Kind::Adaptive | Kind::Modes => key == "step" || key == "sample_every",
    };
    let model = ladder.model(row.at);
    let seen = model.seen(text);
    let text = seen.as_deref().unwrap_or(&model.text);
    let mut changes: Vec<Change> =
        ladder.setting(row.at).changes.iter().filter(|change| !kept(change.key)).cloned().collect();
    if family.kind == Kind::EqualSteps {
        let own = Scene::parse_at(name, text)?.timing();
        let every = own.sample_every() as f64 * own.step() / family.rungs[row.at.rung].setting;
        changes.push(Change::to("sample_every", (every.round().max(1.0) as u64).to_string()));
    }
    let text = changed(text, &changes);
    let text = commented(&text, "integrator", &why(answer, row));
    Scene::parse_at(name, &text)?;
    Ok(Some(text))
}

fn why(answer: &Answer, row: &Row) -> String {
    let error = row.error().unwrap_or(f64::NAN);
    let mut lines = vec![
        format!("Chosen by measurement: the cheapest that was run within {:e}.", answer.tolerance),
        format!("What was asked: {}.", answer.heading),
        format!("Its error is {error:.1e}, its work {} differentials.", row.work),
        format!("Judged by {}.", answer.made),
    ];
    if let Some(second) = answer.runners_up().first() {
        let error = second.error().unwrap_or(f64::NAN);
        let (method, setting, work) = (&second.method, &second.setting, second.work);
        lines.push(format!("Next: {method}, {setting}, error {error:.1e}, work {work}."));
    }
    lines.iter().map(|line| wrapped(line)).collect::<Vec<_>>().join("\n")
}

/// Characters of a line of comment.
const WIDTH: usize = 96;

/// The words on lines of at most the width, where they are short enough for that.
fn wrapped(text: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= WIDTH => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}

/// Writes a text into a file.
///
/// # Errors
/// [`ChooseError::Write`].
pub fn emit(path: &Path, text: &str) -> Result<(), ChooseError> {
    let failed = |source| WriteError { path: path.to_owned(), source };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.map_or(Ok(()), fs::create_dir_all).map_err(failed)?;
    fs::write(path, text).map_err(failed)?;
    Ok(())
}
