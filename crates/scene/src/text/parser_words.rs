//! What the parser says, in the words of a scene's file: texts, lists and tables instead of types.
//!
//! ```text
//! invalid type: map, expected a number          expected a number, got a table
//! invalid value: integer `-2`, expected ...     expected ..., got -2
//! integer number overflowed                     a whole number without digits or with too many; ...
//! ```

/// The message with its types put into words; others are left as they are.
pub(crate) fn in_words(message: &str) -> String {
    if message.starts_with("integer number overflowed") {
        // Of `0x` the parser says the same.
        return "a whole number without digits or with too many; write it with an exponent, such as 1e39"
            .to_owned();
    }
    let told = ["invalid type: ", "invalid value: "].iter().find_map(|kind| {
        let (got, expected) = message.strip_prefix(kind)?.rsplit_once(", expected ")?;
        // Who writes a name for a number has an expression in mind.
        let text = got.strip_prefix("string ").map(|text| text.trim_matches('"'));
        let named = text.is_some_and(|text| text.parse::<f64>().is_err());
        let hint = match named && expected == "a number" {
            true => "; an expression is a text that begins with `=`, such as \"= 2*L\"",
            false => "",
        };
        Some(format!("expected {}, got {}{hint}", wanted(expected), found(got)))
    });
    told.unwrap_or_else(|| message.to_owned())
}

/// What should have been there.
fn wanted(expected: &str) -> &str {
    match expected {
        "a string" => "a text in quotes",
        "a boolean" => "`true` or `false`",
        "a sequence" => "a list in brackets",
        "a map" => "a table",
        _ => expected,
    }
}

/// What is there.
fn found(got: &str) -> String {
    // A whole number that does not fit is told with the type that holds it.
    let quoted = || got.split_once('`').and_then(|(_, rest)| rest.split_once('`'));
    let kind = got.split(' ').next().unwrap_or_default();
    match (kind, quoted()) {
        ("integer" | "floating", Some((number, _))) => number.to_owned(),
        ("boolean", Some((value, _))) => format!("`{value}`"),
        ("string", _) => format!("the text {}", got.trim_start_matches("string ")),
        ("sequence", _) => "a list".to_owned(),
        ("map", _) => "a table".to_owned(),
        _ => got.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_are_told_as_what_stands_in_the_file() {
        for (message, words) in [
            ("invalid type: map, expected a number", "expected a number, got a table"),
            (
                "invalid type: string \"a, expected b\", expected a sequence",
                "expected a list in brackets, got the text \"a, expected b\"",
            ),
            (
                "invalid type: integer `99999999999999999999` as i128, expected a string",
                "expected a text in quotes, got 99999999999999999999",
            ),
            ("invalid value: integer `-2`, expected a spring", "expected a spring, got -2"),
            ("invalid type: floating point `2.5`, expected a rod", "expected a rod, got 2.5"),
            ("invalid type: boolean `true`, expected a map", "expected a table, got `true`"),
            (
                "invalid type: string \"2*L\", expected a number",
                "expected a number, got the text \"2*L\"; an expression is a text that begins with `=`, such as \
                 \"= 2*L\"",
            ),
            ("missing field `mass`", "missing field `mass`"),
        ] {
            assert_eq!(in_words(message), words);
        }
    }
}
