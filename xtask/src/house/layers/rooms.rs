//! The order of the rooms of a crate: folders of `src` that import only from those before them.
//!
//! A crate says it in its manifest, `[package.metadata.layer] rooms = ["text", "model"]`, and a file
//! beside them counts as a room of its own. Of a crate that says nothing, nothing is asked. What is
//! imported is read from the source: paths that begin with `crate::`, where a name at the root is what
//! `lib.rs` exports from a room, and paths to siblings that begin with `super::`. What only tests
//! import is not read. Files of a room, with the folders of their own name, may not import each other
//! in a circle.

use std::collections::{BTreeMap, BTreeSet};

use super::Violation;

/// Imports of files: who names whom.
type Imports = BTreeMap<String, BTreeSet<String>>;

/// The rules on rooms that the files of a crate break: each with its path in `src`, and its text.
pub(super) fn check(krate: &str, rooms: &[String], files: &[(String, String)]) -> Vec<Violation> {
    let place = |room: &str| rooms.iter().position(|one| one == room);
    let root = files.iter().find(|(path, _)| path == "lib.rs");
    let exports = root.map(|(_, text)| exports(&code(text))).unwrap_or_default();
    let mut violations = Vec::new();
    let mut imports = Imports::new();
    for (path, text) in files.iter().filter(|(path, _)| path != "lib.rs") {
        let parts: Vec<&str> = path.trim_end_matches(".rs").split('/').collect();
        let Some(own) = place(parts[0]) else {
            let (krate, file) = (krate.to_owned(), path.clone());
            violations.push(Violation::NoRoom { krate, file });
            continue;
        };
        let text = code(text);
        let mut named = BTreeSet::new();
        for import in paths(&text, "crate::") {
            let exported = exports.get(&import[0]).cloned().unwrap_or_default();
            let whole: Vec<String> = exported.into_iter().chain(import).collect();
            let upward = place(&whole[0]).is_none_or(|room| room > own);
            if upward {
                let (krate, file) = (krate.to_owned(), path.clone());
                violations.push(Violation::UpperRoom { krate, file, import: whole.join("::") });
            }
            named.insert(unit(whole.iter().map(String::as_str)));
        }
        if parts.len() == 2 {
            let siblings = paths(&text, "super::");
            named.extend(siblings.iter().map(|path| format!("{}/{}", parts[0], path[0])));
        }
        let own = unit(parts.iter().copied());
        named.remove(&own);
        imports.entry(own).or_default().extend(named);
    }
    let circle = |files: Vec<String>| Violation::Circle { krate: krate.to_owned(), files };
    violations.extend(circles(&imports).into_iter().map(circle));
    violations
}

/// The file that a path leads to: its room, and what is in it.
fn unit<'a>(path: impl Iterator<Item = &'a str>) -> String {
    let module = |part: &&str| part.starts_with(|c: char| c.is_lowercase() || c == '_');
    path.take(2).filter(module).collect::<Vec<_>>().join("/")
}

/// The text without comments, strings and what is compiled for tests alone.
fn code(text: &str) -> String {
    let mut kept = String::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if c == '"' {
            string(rest)
        } else if rest.starts_with("'\"'") {
            3
        } else {
            kept.push(c);
            rest = &rest[c.len_utf8()..];
            continue;
        };
        rest = &rest[skipped..];
    }
    // Tests stand at the end of a file.
    let tests =
        ["#[cfg(test)]\nmod ", "#[cfg(all(test"].iter().filter_map(|mark| kept.find(mark)).min();
    kept.truncate(tests.unwrap_or(kept.len()));
    kept
}

/// The length of the string at the start of a text.
fn string(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// What the root exports from rooms: each name with the path that leads to it.
fn exports(root: &str) -> BTreeMap<String, Vec<String>> {
    let mut exports = BTreeMap::new();
    for mut path in paths(root, "pub use ") {
        if let Some(name) = path.pop() {
            exports.insert(name, path);
        }
    }
    exports
}

/// Every path of the code that begins with a mark; a group in braces is a path each.
fn paths(code: &str, mark: &str) -> Vec<Vec<String>> {
    let word = |c: char| c.is_alphanumeric() || c == '_' || c == '$';
    let starts = code.match_indices(mark).filter(|(at, _)| !code[..*at].ends_with(word));
    starts.flat_map(|(at, _)| tree(&code[at + mark.len()..])).collect()
}

/// The paths at the start of a text.
fn tree(text: &str) -> Vec<Vec<String>> {
    let text = text.trim_start();
    if let Some(inside) = text.strip_prefix('{') {
        return group(inside).into_iter().flat_map(tree).collect();
    }
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    let (word, rest) = text.split_at(end);
    if word.is_empty() {
        return Vec::new();
    }
    let below = rest.strip_prefix("::").map(tree).unwrap_or_default();
    let first = || [word.to_owned()].into_iter();
    match below.is_empty() {
        true => vec![first().collect()],
        false => below.into_iter().map(|path| first().chain(path).collect()).collect(),
    }
}

/// The parts of a group, whose opening brace is passed.
fn group(text: &str) -> Vec<&str> {
    let (mut depth, mut start, mut parts) = (0, 0, Vec::new());
    for (at, c) in text.char_indices() {
        match c {
            '{' => depth += 1,
            '}' | ',' if depth == 0 => {
                parts.push(&text[start..at]);
                start = at + 1;
                if c == '}' {
                    break;
                }
            }
            '}' => depth -= 1,
            _ => {}
        }
    }
    parts
}

/// Every set of files that import each other in a circle.
fn circles(imports: &Imports) -> BTreeSet<Vec<String>> {
    let all: BTreeMap<&String, BTreeSet<&String>> =
        imports.keys().map(|file| (file, reached(imports, file))).collect();
    let returns = |a: &String, b: &String| {
        all[a].contains(b) && all.get(b).is_some_and(|reached| reached.contains(a))
    };
    let circle = |file: &String| -> Vec<String> {
        imports.keys().filter(|other| returns(file, other)).cloned().collect()
    };
    imports.keys().map(circle).filter(|circle| !circle.is_empty()).collect()
}

/// All that a file imports, and what that imports.
fn reached<'a>(imports: &'a Imports, from: &'a String) -> BTreeSet<&'a String> {
    let (mut seen, mut next) = (BTreeSet::new(), vec![from]);
    while let Some(file) = next.pop() {
        next.extend(imports.get(file).into_iter().flatten().filter(|to| seen.insert(*to)));
    }
    seen
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(files: &[(&str, &str)]) -> Vec<String> {
        let rooms = ["text", "model", "run"].map(str::to_owned);
        let owned = |&(path, text): &(&str, &str)| (path.to_owned(), text.to_owned());
        let files: Vec<_> = files.iter().map(owned).collect();
        check("stationary-scene", &rooms, &files).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn rooms_that_import_from_those_before_them_are_in_order() {
        let files = [
            ("lib.rs", "pub use model::scene::{Scene, Units};"),
            ("text/fault.rs", "//! Not `crate::run::march`.\nconst A: &str = \"crate::run::b\";"),
            ("model/scene.rs", "use crate::text::fault::{Fault, at};\nuse super::units::Units;"),
            ("model/units.rs", "use crate::text::fault;"),
            ("run/march.rs", "use crate::Scene;\nfn f() { crate::model::units::f() }"),
            ("model/odd.rs", "#[cfg(test)]\nmod tests { use crate::run::march; }"),
        ];
        assert_eq!(said(&files), [""; 0]);
    }

    #[test]
    fn an_import_from_a_later_room_is_named() {
        let up = "stationary-scene: src/text/fault.rs imports";
        for (import, path) in [
            ("use crate::run::march::Run;", "run::march::Run"),
            ("use crate::{model::scene, text::number};", "model::scene"),
            ("fn f() -> crate::Scene {}", "model::scene::Scene"),
        ] {
            let files = [("lib.rs", "pub use model::scene::Scene;"), ("text/fault.rs", import)];
            assert_eq!(said(&files), [format!("{up} {path}, which is in a later room")]);
        }
    }

    #[test]
    fn files_that_import_each_other_in_a_circle_are_named() {
        let files = [
            ("run/a.rs", "use crate::run::b::B;"),
            ("run/b.rs", "use super::c::C;"),
            ("run/c/deep.rs", "use crate::run::{a::{self, A}, d};"),
            ("run/d.rs", ""),
        ];
        let circle = "run/a, run/b, run/c import each other in a circle";
        assert_eq!(said(&files), [format!("stationary-scene: {circle}")]);
    }

    #[test]
    fn a_file_outside_of_the_rooms_is_named() {
        let said = said(&[("lib.rs", ""), ("attic.rs", "")]);
        assert_eq!(
            said,
            ["stationary-scene: src/attic.rs is in none of the rooms of the manifest"]
        );
    }
}
