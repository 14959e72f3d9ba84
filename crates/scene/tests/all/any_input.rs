//! Whatever a file says, the reader answers: no panic, no end of waiting, bounded memory.
//!
//! Texts without sense, shipped scenes with a piece changed, and tables of the vocabulary with any
//! values. With `PROPTEST_CASES=250000` it is asked a million times, and `fuzz/` asks for as long as
//! somebody wishes.

use proptest::prelude::*;
use serde_json::Value;
use stationary_measure::SplitMix64;
use stationary_scene::{Scene, limits, vocabulary};

/// All shipped scenes.
fn scenes() -> Vec<String> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");
    let mut files: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    files.iter().map(|file| std::fs::read_to_string(file).unwrap()).collect()
}

/// Every key and word that stands in a shipped scene, and some that could.
fn words() -> Vec<String> {
    let all = scenes().concat();
    let letters = |c: char| !(c.is_alphanumeric() || c == '_' || c == '-');
    let mut words: Vec<String> =
        all.split(letters).filter(|word| !word.is_empty()).map(str::to_owned).collect();
    words.extend(["tolerance", "drag", "nan", "-inf", "1e308", "1e-320", "-1"].map(str::to_owned));
    words.sort();
    words.dedup();
    words
}

/// The reader's answer, which must be a scene within bounds or an error with words.
fn answers(text: &str) -> Result<(), TestCaseError> {
    match Scene::parse("any.toml", text) {
        Ok(scene) => {
            prop_assert!(scene.particles().len() as u64 <= limits::PARTICLES);
            prop_assert!(scene.timing().steps() <= limits::STEPS);
            let finite = |x: &f64| x.is_finite();
            prop_assert!(scene.particles().iter().all(|p| p.position.iter().all(finite)));
        }
        Err(error) => {
            let words = error.to_string();
            prop_assert!(!words.is_empty() && words.len() < 20_000, "{} bytes", words.len());
        }
    }
    Ok(())
}

/// A value of any kind, with numbers that are small more often than not.
fn value() -> impl Strategy<Value = String> {
    let number = prop_oneof![
        (-20..20_i64).prop_map(|n| n.to_string()),
        (-2.0..2.0_f64).prop_map(|x| format!("{x:?}")),
        any::<f64>().prop_map(|x| format!("{x:e}").replace("NaN", "nan")),
        Just("inf".to_owned()),
        Just("9223372036854775807".to_owned()),
    ];
    let vector =
        prop::collection::vec(number.clone(), 0..5).prop_map(|x| format!("[{}]", x.join(",")));
    let word = prop::sample::select(words()).prop_map(|word| format!("\"{word}\""));
    let pair = prop::collection::vec(word.clone(), 0..4).prop_map(|x| format!("[{}]", x.join(",")));
    prop_oneof![4 => number, 4 => vector, 3 => word, 2 => pair, 1 => Just("true".to_owned()), 1 => Just("{}".to_owned())]
}

/// A text that keeps to a schema in most places: each table of the vocabulary with some of its keys.
struct Maker {
    random: SplitMix64,
    schema: Value,
}

impl Maker {
    fn new(seed: u64) -> Self {
        let schema = serde_json::from_str(&vocabulary::schema()).expect("the schema is JSON");
        Maker { random: SplitMix64::new(seed), schema }
    }

    fn below(&mut self, count: usize) -> usize {
        (self.random.bits() % count as u64) as usize
    }

    /// The keys of a table, those that must be there nearly always.
    fn keys(&mut self, table: &Value, depth: usize) -> Vec<(String, String)> {
        let required: Vec<&str> =
            table["required"].as_array().into_iter().flatten().flat_map(Value::as_str).collect();
        let mut keys = Vec::new();
        for (key, schema) in table["properties"].as_object().into_iter().flatten() {
            let odds = if required.contains(&key.as_str()) { 40 } else { 3 + depth };
            let drawn = self.below(odds) == 0;
            if drawn != required.contains(&key.as_str()) {
                keys.push((key.clone(), self.value(schema, depth + 1)));
            }
        }
        keys
    }

    fn value(&mut self, schema: &Value, depth: usize) -> String {
        if let Some(name) = schema["$ref"].as_str().and_then(|path| path.rsplit('/').next()) {
            let definition = self.schema["$defs"][name].clone();
            return self.value(&definition, depth);
        }
        if let Some(any) = schema["anyOf"].as_array() {
            // The first mostly: the others are expressions.
            let one = if self.below(4) == 0 { self.below(any.len()) } else { 0 };
            return self.value(&any[one].clone(), depth);
        }
        if let Some(words) = schema["enum"].as_array() {
            return words[self.below(words.len())].to_string();
        }
        match schema["type"].as_str() {
            Some("number") => ["1", "0.5", "2.0", "-1", "0", "1e9"][self.below(6)].to_owned(),
            Some("integer") => ["1", "2", "3", "5", "0", "64"][self.below(6)].to_owned(),
            Some("boolean") => ["true", "false"][self.below(2)].to_owned(),
            Some("string") if schema["pattern"].is_string() => {
                ["\"= 1 + 1\"", "\"= L/2\"", "\"= (\"", "\"= 1/0\""][self.below(4)].to_owned()
            }
            Some("string") => {
                ["\"a\"", "\"b\"", "\"c\"", "\"world\"", "\"left\""][self.below(5)].to_owned()
            }
            Some("array") => {
                let least = schema["minItems"].as_u64().unwrap_or(0) as usize;
                let count = if least == 0 { self.below(4) } else { least + self.below(2) };
                let items = schema["items"].clone();
                let all: Vec<String> = (0..count).map(|_| self.value(&items, depth + 1)).collect();
                format!("[{}]", all.join(", "))
            }
            Some("object") if schema["properties"].is_object() => {
                let keys = self.keys(schema, depth);
                let keys: Vec<String> = keys.iter().map(|(k, v)| format!("{k} = {v}")).collect();
                format!("{{ {} }}", keys.join(", "))
            }
            _ => "{ L = [1, 2] }".to_owned(),
        }
    }

    fn scene(&mut self) -> String {
        let root = self.schema.clone();
        let keys = self.keys(&root, 0);
        keys.iter().map(|(key, value)| format!("{key} = {value}\n")).collect()
    }
}

#[test]
fn the_maker_of_scenes_says_every_word_of_the_registry() {
    let texts: String = (0..900).map(|seed| Maker::new(seed).scene()).collect();
    let schema: Value = serde_json::from_str(&vocabulary::schema()).unwrap();
    let tables = schema["$defs"].as_object().unwrap().values().chain([&schema]);
    let keys = tables.filter_map(|table| table["properties"].as_object()).flatten();
    for (key, _) in keys {
        assert!(texts.contains(&format!("{key} = ")), "{key}");
    }
}

proptest! {
    #[test]
    fn a_scene_made_of_the_registry_is_answered(seed in any::<u64>()) {
        answers(&Maker::new(seed).scene())?;
    }

    #[test]
    fn a_text_without_sense_is_answered(text in "\\PC{0,300}") {
        answers(&text)?;
    }

    #[test]
    fn brackets_and_dots_without_end_are_answered(
        piece in prop::sample::select(vec!["[", "{a=", "a.", "[[", "\"", "'''", "\\u", "#", "=", "1e9"]),
        count in 1..3000_usize,
    ) {
        answers(&piece.repeat(count))?;
        answers(&format!("particles = {}", piece.repeat(count)))?;
    }

    #[test]
    fn a_shipped_scene_with_a_piece_changed_is_answered(
        scene in prop::sample::select(scenes()),
        place in any::<prop::sample::Index>(),
        length in 0..40_usize,
        piece in prop_oneof![
            value(),
            prop::sample::select(words()),
            "\\PC{0,10}",
            "[0-9.eE+-]{0,4}",
        ],
    ) {
        let places: Vec<usize> = scene.char_indices().map(|(index, _)| index).collect();
        let start = place.index(places.len());
        let end = (start + length).min(places.len() - 1);
        let changed = [&scene[..places[start]], piece.as_str(), &scene[places[end]..]].concat();
        answers(&changed)?;
    }

    #[test]
    fn tables_of_the_vocabulary_with_any_values_are_answered(
        dimension in 0..5_u32,
        lines in prop::collection::vec((prop::sample::select(words()), value()), 0..8),
        tables in prop::collection::vec(
            (
                prop::sample::select(vec![
                    "[[particles]]", "[[springs]]", "[[rods]]", "[[nets]]", "[[bodies]]",
                    "[[joints]]", "[[solids]]", "[contact]", "[heat]", "[drag]",
                ]),
                prop::collection::vec((prop::sample::select(words()), value()), 0..8),
            ),
            0..5,
        ),
    ) {
        let mut text = format!("dimension = {dimension}\n");
        let line = |(key, value): &(String, String)| format!("{key} = {value}\n");
        text.extend(lines.iter().map(line));
        for (table, lines) in &tables {
            text += &format!("{table}\n");
            text.extend(lines.iter().map(line));
        }
        answers(&text)?;
    }
}
