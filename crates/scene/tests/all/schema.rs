//! The published schema says what the reader says: the same tables, the same keys, the same words.
//!
//! A table of the vocabulary is one `table!` in `src/words`; schema, page and reader are made from it.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use serde_json::{Map, Value};
use stationary_integrators::Method;
use stationary_rigid::BodyMethod;
use stationary_scene::{Fault, Scene, SceneError, vocabulary};

fn schema() -> Value {
    serde_json::from_str(include_str!("../../scene.schema.json")).unwrap()
}

/// A file of the vocabulary, and what it has to hold. With `UPDATE_VOCABULARY` set it is written.
pub(crate) fn check_file(path: &str, made: &str) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path);
    if std::env::var_os("UPDATE_VOCABULARY").is_some() {
        fs::write(&path, made).unwrap();
    }
    let held = fs::read_to_string(&path).unwrap();
    assert!(held == made, "{} is old: set UPDATE_VOCABULARY and run this test", path.display());
}

#[test]
fn the_schema_is_made_from_the_tables_of_the_reader() {
    check_file("scene.schema.json", &vocabulary::schema());
}

#[test]
fn the_page_of_the_vocabulary_is_made_from_the_tables_of_the_reader() {
    check_file("../../docs/src/vocabulary.md", &vocabulary::page());
}

#[test]
fn to_add_a_word_is_to_touch_its_file_and_the_registry() {
    let source = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src");
    let registry = fs::read_to_string(source.join("words.rs")).unwrap();
    // The declaration of a table is named by its own file, and by the registry where it is a word.
    let tables = registry.lines().filter_map(|line| {
        let (_, name) = line.split_once("Kind::")?.1.rsplit_once('&')?;
        name.split_once("::TABLE").map(|(name, _)| name.to_owned())
    });
    let mut words = 0;
    for table in tables {
        let mut files = Vec::new();
        for entry in walk(&source) {
            let text = fs::read_to_string(&entry).unwrap();
            let word = |c: char| c.is_alphanumeric() || c == '_';
            if text.match_indices(&table).any(|(at, _)| !text[..at].ends_with(word)) {
                files.push(entry.strip_prefix(&source).unwrap().to_owned());
            }
        }
        assert_eq!(files.len(), 2, "{table}: {files:?}");
        words += 1;
    }
    assert!(words >= 10, "{words}");
}

fn walk(folder: &std::path::Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries
        .flat_map(|path| if path.is_dir() { walk(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect();
    files.sort();
    files
}

#[test]
fn the_schema_has_every_integrator_of_the_reader_and_no_other() {
    let schema = schema();
    let words: BTreeSet<&str> = schema["properties"]["integrator"]["enum"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(Value::as_str)
        .collect();
    let named = Method::ALL.iter().map(|method| method.facts().name);
    let named: Vec<&str> = named.chain(BodyMethod::ALL.iter().map(|m| m.facts().name)).collect();
    for method in &named {
        assert!(words.contains(method), "{method}");
    }
    // A word that no scene knows is called unknown by every one.
    let particles = "dimension = 2\nstep = 1\nhorizon = 1\n\
                     particles = [{ name = \"a\", mass = 1, position = [0, 0] }]\n";
    let bodies = "dimension = 3\nstep = 1\nhorizon = 1\n\
                  bodies = [{ name = \"a\", mass = 1, box = [1, 1, 1], position = [0, 0, 0] }]\n";
    let heat = "dimension = 1\nstep = 1\nhorizon = 1\n[heat]\nname = \"a\"\ndiffusivity = 1\n\
                shape = { kind = \"bar\", size = [1], cells = [4] }\n";
    let knows = |scene: &str, word: &str| {
        let text = format!("integrator = \"{word}\"\n{scene}");
        match Scene::parse("a.toml", &text) {
            Err(SceneError::Invalid(error)) => !matches!(error.fault, Fault::UnknownWord { .. }),
            other => other.is_ok(),
        }
    };
    assert!(!knows(particles, "velvet"));
    for word in words {
        assert!([particles, bodies, heat].iter().any(|scene| knows(scene, word)), "{word}");
    }
}

/// What a document has that the schema does not allow, in the part of JSON Schema that ours uses.
fn complaints(root: &Value, schema: &Value, document: &Value, place: &str) -> Vec<String> {
    let mut found = Vec::new();
    let empty = Map::new();
    let below = |schema: &Value, document: &Value, place: String| {
        complaints(root, schema, document, &place)
    };
    for (keyword, rule) in schema.as_object().unwrap_or(&empty) {
        let bound = || rule.as_f64().unwrap();
        let (number, length) = (document.as_f64(), document.as_array().map(Vec::len));
        let size = |size: Option<usize>| size.map(|size| size as f64);
        let holds = match keyword.as_str() {
            "$schema" | "title" | "description" | "$defs" => true,
            "$ref" => {
                let name = rule.as_str().unwrap().strip_prefix("#/$defs/").unwrap();
                found.extend(below(&root["$defs"][name], document, place.to_owned()));
                root["$defs"].get(name).is_some()
            }
            "type" => match rule.as_str().unwrap() {
                "object" => document.is_object(),
                "array" => document.is_array(),
                "string" => document.is_string(),
                "boolean" => document.is_boolean(),
                "integer" => document.is_i64() || document.is_u64(),
                "number" => document.is_number(),
                other => panic!("the type {other}"),
            },
            "enum" => rule.as_array().unwrap().contains(document),
            "anyOf" => rule
                .as_array()
                .unwrap()
                .iter()
                .any(|one| below(one, document, place.to_owned()).is_empty()),
            "items" => {
                for (k, item) in document.as_array().into_iter().flatten().enumerate() {
                    found.extend(below(rule, item, format!("{place}[{k}]")));
                }
                true
            }
            "properties" => {
                for (key, value) in document.as_object().into_iter().flatten() {
                    match rule.get(key) {
                        Some(rule) => found.extend(below(rule, value, format!("{place}.{key}"))),
                        None => found.push(format!("{place} has no `{key}`")),
                    }
                }
                true
            }
            // With `properties`, above.
            "additionalProperties" if rule.is_object() => {
                for (key, value) in document.as_object().into_iter().flatten() {
                    found.extend(below(rule, value, format!("{place}.{key}")));
                }
                true
            }
            "additionalProperties" => *rule == Value::Bool(false),
            "required" => rule
                .as_array()
                .unwrap()
                .iter()
                .all(|key| document.get(key.as_str().unwrap()).is_some()),
            "minimum" => number.is_none_or(|x| x >= bound()),
            "maximum" => number.is_none_or(|x| x <= bound()),
            "exclusiveMinimum" => number.is_none_or(|x| x > bound()),
            "exclusiveMaximum" => number.is_none_or(|x| x < bound()),
            "minItems" => size(length).is_none_or(|n| n >= bound()),
            "maxItems" => size(length).is_none_or(|n| n <= bound()),
            // The only one says how an expression begins.
            "pattern" => document.as_str().is_none_or(|text| text.starts_with('=')),
            "minLength" => document.as_str().is_none_or(|text| text.len() as f64 >= bound()),
            "minProperties" => document.as_object().is_none_or(|o| o.len() as f64 >= bound()),
            "maxProperties" => document.as_object().is_none_or(|o| o.len() as f64 <= bound()),
            other => panic!("the keyword {other}"),
        };
        if !holds {
            found.push(format!("{place}: {keyword} {rule}"));
        }
    }
    found
}

fn complaints_about(text: &str) -> Vec<String> {
    let document: toml::Value = toml::from_str(text).unwrap();
    let schema = schema();
    complaints(&schema, &schema, &serde_json::to_value(document).unwrap(), "scene")
}

#[test]
fn every_shipped_scene_names_the_schema_and_keeps_to_it() {
    let scenes = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut count = 0;
    for entry in fs::read_dir(&scenes).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let first = text.lines().next().unwrap().strip_prefix("#:schema ");
        let named = first.map(|name| scenes.join(name).canonicalize().unwrap());
        let own = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scene.schema.json");
        assert_eq!(named, Some(own.canonicalize().unwrap()), "{}", path.display());
        assert_eq!(complaints_about(&text), [""; 0], "{}", path.display());
        count += 1;
    }
    assert!(count >= 6);
}

#[test]
fn the_schema_objects_to_what_the_reader_refuses() {
    let scene = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n";
    assert_eq!(complaints_about(scene), [""; 0]);
    for (wrong, complaint) in [
        ("tolerence = 1e-3", "scene has no `tolerence`"),
        ("springs = [{ between = [\"a\"], stiffness = 1 }]", "minItems"),
        ("springs = [{ between = [\"a\", \"b\"] }]", "required"),
        ("observables = [\"enrgy\"]", "anyOf"),
        ("observables = [{ position = \"a\", velocity = \"a\" }]", "anyOf"),
        ("view = [1, 2, 3, 4]", "maxItems"),
        ("tolerance = 1", "anyOf"),
        ("uniform_gravity = { acceleration = \"down\" }", "type"),
    ] {
        let found = complaints_about(&format!("{scene}{wrong}"));
        assert!(found.iter().any(|text| text.contains(complaint)), "{wrong}: {found:?}");
        assert!(Scene::parse("a.toml", &format!("{scene}{wrong}")).is_err(), "{wrong}");
    }
}
