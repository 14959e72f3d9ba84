//! The lines of a text with their numbers, and the words of a line.
//!
//! Lines without words are nothing. Bytes that are no text are shown as such where they are
//! refused, and pass where nobody reads them.

use std::io::{BufRead, Take};
use std::str::{FromStr, SplitAsciiWhitespace};

use super::MshError;

/// The longest file that is read.
const LONGEST: u64 = 256 << 20;

/// Characters that an error shows of what it found.
const SHOWN: usize = 40;

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The lines of a text, one at a time.
pub(super) struct Lines<R> {
    text: Take<R>,
    bytes: Vec<u8>,
    /// The line without what is around its words.
    line: String,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    pub(super) fn new(text: R) -> Self {
        let text = text.take(LONGEST);
        Lines { text, bytes: Vec::new(), line: String::new(), number: 0 }
    }

    /// The next line that has words; `None` at the end of the text.
    pub(super) fn next(&mut self) -> Result<Option<Words<'_>>, MshError> {
        loop {
            self.bytes.clear();
            self.number += 1;
            let line = self.number;
            let read = self.text.read_until(b'\n', &mut self.bytes);
            let read = read.map_err(|source| MshError::Read { line, source })?;
            if line == 1 && self.bytes.starts_with(BYTE_ORDER_MARK) {
                self.bytes.drain(..BYTE_ORDER_MARK.len());
            }
            if self.text.limit() == 0 {
                return Err(MshError::TooLong { limit: LONGEST });
            }
            if read == 0 {
                return Ok(None);
            }
            let bytes = self.bytes.trim_ascii();
            if !bytes.is_empty() {
                self.line.clear();
                self.line.push_str(&String::from_utf8_lossy(bytes));
                return Ok(Some(self.current()));
            }
        }
    }

    /// The next line, which must be there.
    pub(super) fn required(&mut self, expected: &'static str) -> Result<Words<'_>, MshError> {
        if self.next()?.is_none() {
            let found = "the end of the file".to_owned();
            return Err(MshError::Unexpected { line: self.number, expected, found });
        }
        Ok(self.current())
    }

    /// The next line, which must be this one.
    pub(super) fn required_line(&mut self, line: &'static str) -> Result<(), MshError> {
        let words = self.required(line)?;
        if words.line == line { Ok(()) } else { Err(words.unexpected(line, words.line)) }
    }

    /// The line that was read last, from its first word.
    pub(super) fn current(&self) -> Words<'_> {
        let line = self.line.as_str();
        Words { line, number: self.number, rest: line.split_ascii_whitespace() }
    }
}

/// The words of a line, one after another.
pub(super) struct Words<'a> {
    /// The whole line.
    pub(super) line: &'a str,
    /// The number of the line, from 1.
    pub(super) number: usize,
    rest: SplitAsciiWhitespace<'a>,
}

impl<'a> Words<'a> {
    pub(super) fn word(&mut self, expected: &'static str) -> Result<&'a str, MshError> {
        self.rest.next().ok_or_else(|| MshError::Unexpected {
            line: self.number,
            expected,
            found: "the end of the line".to_owned(),
        })
    }

    /// The next word as a number.
    pub(super) fn number<T: FromStr>(&mut self, expected: &'static str) -> Result<T, MshError> {
        let word = self.word(expected)?;
        word.parse().map_err(|_| self.unexpected(expected, word))
    }

    /// The next word as a finite number.
    pub(super) fn coordinate(&mut self) -> Result<f64, MshError> {
        let expected = "a coordinate";
        let word = self.word(expected)?;
        let number = word.parse().ok().filter(|x: &f64| x.is_finite());
        number.ok_or_else(|| self.unexpected(expected, word))
    }

    /// Nothing more may stand in the line.
    pub(super) fn end(&mut self) -> Result<(), MshError> {
        match self.rest.next() {
            None => Ok(()),
            Some(word) => Err(self.unexpected("the end of the line", word)),
        }
    }

    pub(super) fn unexpected(&self, expected: &'static str, found: &str) -> MshError {
        MshError::Unexpected { line: self.number, expected, found: shown(found) }
    }
}

/// Words of a file as an error shows them.
pub(super) fn shown(found: &str) -> String {
    let shown: String = found.chars().take(SHOWN).collect();
    let more = if shown.len() < found.len() { "..." } else { "" };
    format!("`{shown}{more}`")
}
