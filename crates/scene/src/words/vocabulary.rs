//! The vocabulary for others: the schema that editors read, and a page of the documentation. Both are
//! made of the tables that the reader is made of.

use serde_json::{Map, Value, json};

use crate::words::Declaration;
use crate::words::observables::{self, ObservableTable};
use crate::words::strength::StrengthTable;
use crate::words::table::{Key, Kind, Table};

/// Every table, the scene itself first.
fn tables() -> Vec<&'static Table> {
    let mut all: Vec<&Table> = vec![&Declaration::TABLE];
    let mut next = 0;
    while let Some(table) = all.get(next) {
        for inner in table.keys.iter().filter_map(|key| key.kind.table()) {
            if all.iter().all(|known| known.name != inner.name) {
                all.push(inner);
            }
        }
        next += 1;
    }
    all
}

impl Kind {
    /// The table that it takes, or several of.
    fn table(&self) -> Option<&'static Table> {
        match self {
            Kind::Table(table) => Some(table),
            Kind::List(each) => each.table(),
            Kind::Observable => Some(&ObservableTable::TABLE),
            Kind::Strength => Some(&StrengthTable::TABLE),
            _ => None,
        }
    }

    /// What it takes, as a schema: where a number may stand, an expression may.
    fn schema(&self) -> Value {
        let number = self.number();
        if number.is_null() { self.other() } else { json!({ "anyOf": [number, expression()] }) }
    }

    fn number(&self) -> Value {
        match self {
            Kind::Number => json!({ "type": "number" }),
            Kind::Positive => json!({ "type": "number", "exclusiveMinimum": 0 }),
            Kind::NotNegative => json!({ "type": "number", "minimum": 0 }),
            Kind::Share => json!({ "type": "number", "minimum": 0, "maximum": 1 }),
            Kind::Tolerance => {
                json!({ "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1 })
            }
            Kind::Dimension => json!({ "type": "integer", "enum": [1, 2, 3] }),
            Kind::Count(least) => json!({ "type": "integer", "minimum": least }),
            _ => Value::Null,
        }
    }

    fn other(&self) -> Value {
        let vector = || json!({ "$ref": "#/$defs/Vector" });
        match self {
            Kind::Numbers => {
                json!({ "type": "object", "additionalProperties": Kind::Number.schema() })
            }
            Kind::Flag => json!({ "type": "boolean" }),
            Kind::Text | Kind::Name => json!({ "type": "string", "minLength": 1 }),
            Kind::Pair => {
                let name = Kind::Name.schema();
                json!({ "type": "array", "items": name, "minItems": 2, "maxItems": 2 })
            }
            Kind::Vector => vector(),
            Kind::Turn => json!({ "anyOf": [{ "type": "number" }, expression(), vector()] }),
            Kind::Marks => json!({ "type": "object", "additionalProperties": vector() }),
            Kind::OneOf(words) => json!({ "type": "string", "enum": words }),
            Kind::Observable => {
                let words =
                    json!({ "type": "string", "enum": observables::words().collect::<Vec<_>>() });
                let table = Kind::Table(&ObservableTable::TABLE).schema();
                json!({ "anyOf": [words, table] })
            }
            Kind::Strength => {
                let table = Kind::Table(&StrengthTable::TABLE).schema();
                json!({ "anyOf": [{ "type": "number" }, expression(), table] })
            }
            Kind::Table(table) => json!({ "$ref": format!("#/$defs/{}", table.name) }),
            Kind::List(each) => json!({ "type": "array", "items": each.schema() }),
            _ => Value::Null,
        }
    }

    /// What it takes, in words.
    fn words(&self) -> String {
        match self {
            Kind::Number => "a number".to_owned(),
            Kind::Numbers => "numbers by name".to_owned(),
            Kind::Positive => "a number above 0".to_owned(),
            Kind::NotNegative => "a number, at least 0".to_owned(),
            Kind::Share => "a number from 0 to 1".to_owned(),
            Kind::Tolerance => "a number above 0 and below 1".to_owned(),
            Kind::Dimension => "1, 2 or 3".to_owned(),
            Kind::Count(least) => format!("a whole number, at least {least}"),
            Kind::Flag => "`true` or `false`".to_owned(),
            Kind::Text => "a text".to_owned(),
            Kind::Name => "a name".to_owned(),
            Kind::Pair => "two names".to_owned(),
            Kind::Vector => "a vector".to_owned(),
            Kind::Turn => "a number in the plane, a vector in space".to_owned(),
            Kind::Marks => "places by name".to_owned(),
            Kind::OneOf(words) => {
                words.iter().map(|word| format!("`\"{word}\"`")).collect::<Vec<_>>().join(", ")
            }
            Kind::Observable => {
                let words = observables::words().map(|word| format!("`\"{word}\"`"));
                let words = words.collect::<Vec<_>>().join(", ");
                format!("{words}, or {}", link(&ObservableTable::TABLE))
            }
            Kind::Strength => format!("a number, or {}", link(&StrengthTable::TABLE)),
            Kind::Table(table) => link(table),
            Kind::List(each) => format!("a list: {}", each.words()),
        }
    }
}

/// A text that is arithmetic.
fn expression() -> Value {
    json!({ "type": "string", "pattern": "^=" })
}

/// A table's name in the page, as prose has it.
fn title(table: &Table) -> String {
    let name = table.name.trim_end_matches("Declaration").trim_end_matches("Table");
    if name.is_empty() { "Scene".to_owned() } else { name.to_owned() }
}

fn link(table: &Table) -> String {
    let title = title(table);
    format!("[{title}](#{})", title.to_lowercase())
}

fn sentence(says: &[&str]) -> String {
    says.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ")
}

fn properties(table: &Table) -> Value {
    let property = |key: &Key| {
        let described = json!({ "description": sentence(key.says) });
        let mut described = described.as_object().cloned().unwrap_or_default();
        described.extend(key.kind.schema().as_object().cloned().unwrap_or_default());
        (key.name.to_owned(), Value::Object(described))
    };
    let required: Vec<&str> =
        table.keys.iter().filter(|key| key.required).map(|key| key.name).collect();
    let mut schema = json!({
        "description": sentence(table.says),
        "type": "object",
        "required": required,
        "additionalProperties": false,
        "properties": table.keys.iter().map(property).collect::<Map<_, _>>(),
    });
    if table.name == ObservableTable::TABLE.name {
        schema["minProperties"] = json!(1);
        schema["maxProperties"] = json!(1);
    }
    schema
}

/// The JSON Schema of scenes, as the file `scene.schema.json` holds it.
pub fn schema() -> String {
    let all = tables();
    let mut definitions: Map<String, Value> =
        all[1..].iter().map(|table| (table.name.to_owned(), properties(table))).collect();
    let number = Kind::Number.schema();
    let vector = json!({ "type": "array", "items": number, "minItems": 1, "maxItems": 3 });
    definitions.insert("Vector".to_owned(), vector);
    let mut schema = properties(all[0]);
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("Scene of Stationary");
    schema["$defs"] = Value::Object(definitions);
    format!("{schema:#}\n")
}

/// The page of the documentation that lists every table and key, as `docs/src/vocabulary.md` holds it.
pub fn page() -> String {
    let mut page =
        "# The vocabulary of scenes\n\nMade from the tables of the reader, as is the schema for \
                    editors. A key in bold must be there.\n"
            .to_owned();
    for table in tables() {
        page += &format!("\n## {}\n\n{}\n\n", title(table), sentence(table.says));
        page += "| key | takes | |\n| --- | --- | --- |\n";
        for key in table.keys {
            let name = match key.required {
                true => format!("**`{}`**", key.name),
                false => format!("`{}`", key.name),
            };
            page += &format!("| {name} | {} | {} |\n", key.kind.words(), sentence(key.says));
        }
    }
    page += "\n## Cargo features\n\nA word is compiled with its feature, and without it answered by an error \
             that names the feature.\n\n| word | feature |\n| --- | --- |\n";
    for (word, feature) in Declaration::features() {
        let feature = feature.map_or("none".to_owned(), |feature| format!("`{}`", feature.name));
        page += &format!("| `{word}` | {feature} |\n");
    }
    page
}
