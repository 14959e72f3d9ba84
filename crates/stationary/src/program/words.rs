//! `stationary words QUERY`: the words of a scene file, searched, as its schema has them.

use std::fmt;
use std::process::ExitCode;

use serde_json::Value;
use stationary_scene::shipped::SCHEMA;

/// Finds the words of a scene file: what they mean, and what they may be.
#[derive(Debug, clap::Args)]
pub struct Words {
    /// What to look for, such as `friction` or `shape ball`; the words of a whole file without it.
    query: Vec<String>,
}

/// A word of a scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Word {
    /// Where it stands: `contact.friction`, `bodies[].mass`.
    pub place: String,
    /// What it means.
    pub meaning: String,
    /// The words that it may be, where it is one of some.
    pub values: Vec<String>,
}

impl fmt::Display for Word {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\n    {}", self.place, self.meaning)?;
        if !self.values.is_empty() {
            write!(f, "\n    one of: {}", self.values.join(", "))?;
        }
        Ok(())
    }
}

/// The words in whose place, meaning or values every part of the query occurs, of whatever case; those at
/// the top of a file where nothing is asked.
pub fn words(query: &[String]) -> Vec<Word> {
    let Ok(schema) = serde_json::from_str::<Value>(SCHEMA) else { return Vec::new() };
    let mut all = Vec::new();
    collect(&schema, &schema, "", &mut all);
    let parts: Vec<String> = query
        .iter()
        .flat_map(|part| part.split_whitespace())
        .map(|part| part.to_lowercase())
        .collect();
    all.retain(|word| {
        let text = word.to_string().to_lowercase();
        match parts.is_empty() {
            true => !word.place.contains(['.', '[']),
            false => parts.iter().all(|part| text.contains(part.as_str())),
        }
    });
    all
}

/// Goes down into the properties; each table that is named in `$defs` stands in few places.
fn collect(schema: &Value, node: &Value, place: &str, all: &mut Vec<Word>) {
    let Some(properties) = node.get("properties").and_then(Value::as_object) else { return };
    for (name, property) in properties {
        let place = if place.is_empty() { name.clone() } else { format!("{place}.{name}") };
        let meaning = property.get("description").and_then(Value::as_str).unwrap_or_default();
        let values = property.get("enum").and_then(Value::as_array);
        let values = values.into_iter().flatten().filter_map(Value::as_str).map(str::to_owned);
        let word =
            Word { place: place.clone(), meaning: meaning.to_owned(), values: values.collect() };
        all.push(word);
        for (node, suffix) in tables(property) {
            let node = resolved(schema, node);
            collect(schema, node, &format!("{place}{suffix}"), all);
        }
    }
}

/// The tables that a property may be or hold: itself, each of its items, each of its choices.
fn tables(property: &Value) -> Vec<(&Value, &'static str)> {
    let mut found = vec![(property, "")];
    found.extend(property.get("items").map(|items| (items, "[]")));
    for choice in ["oneOf", "anyOf", "allOf"] {
        for choice in property.get(choice).and_then(Value::as_array).into_iter().flatten() {
            found.extend(tables(choice));
        }
    }
    if let Some(items) = property.get("items") {
        found.extend(tables(items).into_iter().skip(1).map(|(node, _)| (node, "[]")));
    }
    found
}

/// What a reference `#/$defs/Name` stands for.
fn resolved<'a>(schema: &'a Value, node: &'a Value) -> &'a Value {
    let name = node.get("$ref").and_then(Value::as_str).and_then(|path| path.rsplit('/').next());
    name.and_then(|name| schema.get("$defs")?.get(name)).unwrap_or(node)
}

impl Words {
    pub(super) fn run(&self) -> ExitCode {
        let found = words(&self.query);
        for word in &found {
            println!("{word}");
        }
        match found.is_empty() {
            true => super::failed(&format!("no word has to do with `{}`", self.query.join(" "))),
            false => ExitCode::SUCCESS,
        }
    }
}
