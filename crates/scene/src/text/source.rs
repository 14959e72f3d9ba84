//! The text of a scene: read from a file without trust, and parsed into declarations.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::{fs, io};

use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue, Deserializer};
use toml::value::Datetime;

use crate::text::diagnostic::{Checked, Diagnostic, Located, Place};
use crate::text::fault::Fault;
use crate::text::file_error::SceneError;
use crate::text::parameters::{Parameters, has_expressions};
use crate::text::parser_words::in_words;
use crate::text::suggestion::{nearest, shortened};
use crate::text::{limits, parameters};

/// The text of the file: at most [`limits::FILE_BYTES`] of UTF-8.
pub(crate) fn read(path: &Path) -> Result<String, SceneError> {
    let failed = |source: io::Error| SceneError::Read { path: path.to_owned(), source };
    let too_large = |bytes| SceneError::TooLarge { name: path.display().to_string(), bytes };
    // Asked before opening: to open a pipe would wait for whoever writes into it.
    let metadata = fs::metadata(path).map_err(failed)?;
    if !metadata.is_file() {
        return Err(SceneError::NotAFile { path: path.to_owned() });
    }
    if metadata.len() > limits::FILE_BYTES {
        return Err(too_large(metadata.len()));
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(failed)?;
    file.take(limits::FILE_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > limits::FILE_BYTES {
        return Err(too_large(bytes.len() as u64));
    }
    String::from_utf8(bytes).map_err(|error| {
        let text = String::from_utf8_lossy(&error.as_bytes()[..error.utf8_error().valid_up_to()]);
        let place = Place::of(&text, text.len()..text.len());
        SceneError::NotUtf8 { path: path.to_owned(), line: place.line, column: place.column }
    })
}

/// What the text declares, with these values for its parameters, or where it does not.
pub(crate) fn parse<T: DeserializeOwned>(text: &str, given: &Parameters) -> Checked<T> {
    let failed = |error: toml::de::Error| {
        let value = error.span().and_then(|span| text.get(span)).unwrap_or_default();
        let fault = date_fault(value).unwrap_or_else(|| fault_of(error.message()));
        Box::new(Located { span: error.span(), fault })
    };
    if given.is_empty() && !has_expressions(text) {
        return toml::from_str(text).map_err(failed);
    }
    let values = parameters::values(DeTable::parse(text).map_err(failed)?.get_mut(), given)?;
    let mut table = DeTable::parse(text).map_err(failed)?;
    let mut left = values.iter();
    parameters::for_each(table.get_mut(), &mut |said| {
        // As many as there are expressions, and each is a number.
        let number = left.next().and_then(|number| DeValue::parse(number).ok());
        if let Some(number) = number {
            *said.get_mut() = number.into_inner();
        }
    });
    T::deserialize(Deserializer::from(table)).map_err(failed)
}

/// A fault, with the text to which it belongs.
pub(crate) fn diagnose(name: &str, text: &str, located: Located) -> SceneError {
    let place = located.span.map(|span| Place::of(text, span));
    SceneError::Invalid(Box::new(Diagnostic { file: name.to_owned(), fault: located.fault, place }))
}

/// The fault of a date: the parser hands it over as a table with a private key, and says so.
fn date_fault(value: &str) -> Option<Fault> {
    value.parse::<Datetime>().ok()?;
    let message = format!(
        "`{value}` is a date or a time, and a scene has none; a number has no dashes or colons, a text stands in \
         quotes"
    );
    Some(Fault::Syntax { message })
}

/// Characters of the parser's message that are shown: it may quote the whole file.
const MESSAGE: usize = 300;

/// The fault in the parser's words. Those on a field that does not exist are
/// "unknown field `a`, expected `b`" or "... expected one of `b`, `c`".
fn fault_of(message: &str) -> Fault {
    let mut quoted = message.split('`').skip(1).step_by(2);
    if let (true, Some(word)) = (message.starts_with("unknown field `"), quoted.next()) {
        let allowed: Vec<String> = quoted.map(str::to_owned).collect();
        let nearest = nearest(word, allowed.iter().map(String::as_str)).map(str::to_owned);
        return Fault::UnknownWord { kind: "field", word: shortened(word), nearest, allowed };
    }
    let one_line = in_words(&message.lines().collect::<Vec<_>>().join(", "));
    Fault::Syntax { message: one_line.chars().take(MESSAGE).collect() }
}
