//! The statements of an OBJ text: lines without comments, joined where one goes on in the next.
//!
//! A `#` begins a comment anywhere. A backslash at the end of a line joins the next one to it; at the
//! end of a name it does so only where it stands alone, because names may be paths. Each word knows
//! its line and its column.

use std::io::{BufRead, Take};

use super::ObjError;

/// The longest file that is read.
const LONGEST: u64 = 256 << 20;

/// Characters that an error shows of what it found.
const SHOWN: usize = 40;

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The statements of a text, one at a time.
pub(super) struct Statements<R> {
    text: Take<R>,
    bytes: Vec<u8>,
    /// The statement, its lines separated by blanks.
    statement: String,
    /// Where each of its lines begins: in the statement, and in the text.
    pieces: Vec<Piece>,
    /// The number of the line that was read last, from 1.
    line: usize,
}

#[derive(Clone, Copy)]
struct Piece {
    start: usize,
    line: usize,
}

impl<R: BufRead> Statements<R> {
    pub(super) fn new(text: R) -> Self {
        let (bytes, statement, pieces) = (Vec::new(), String::new(), Vec::new());
        Statements { text: text.take(LONGEST), bytes, statement, pieces, line: 0 }
    }

    /// The next statement that has words; `None` at the end of the text.
    pub(super) fn next(
        &mut self,
        is_name: impl Fn(&str) -> bool,
    ) -> Result<Option<Words<'_>>, ObjError> {
        loop {
            self.statement.clear();
            self.pieces.clear();
            let mut goes_on = true;
            while goes_on {
                if !self.read()? {
                    if self.pieces.is_empty() {
                        return Ok(None);
                    }
                    break;
                }
                goes_on = self.joined(&is_name);
            }
            if !self.statement.trim_ascii().is_empty() {
                let (statement, pieces) = (self.statement.as_str(), self.pieces.as_slice());
                return Ok(Some(Words { statement, pieces, place: 0 }));
            }
        }
    }

    /// Appends a line; whether the next one belongs to it.
    fn joined(&mut self, is_name: impl Fn(&str) -> bool) -> bool {
        let comment = self.bytes.iter().position(|&byte| byte == b'#').unwrap_or(self.bytes.len());
        let line = self.bytes[..comment].trim_ascii_end();
        self.pieces.push(Piece { start: self.statement.len(), line: self.line });
        let kept = if comment == self.bytes.len() { line.strip_suffix(b"\\") } else { None };
        let start = self.statement.len();
        self.statement.push_str(&String::from_utf8_lossy(kept.unwrap_or(line)));
        self.statement.push(' ');
        let Some(kept) = kept else { return false };
        let stands_alone = kept.last().is_none_or(u8::is_ascii_whitespace);
        let keyword = self.statement.split_ascii_whitespace().next().unwrap_or("");
        let goes_on = stands_alone || !is_name(keyword);
        if !goes_on {
            self.statement.truncate(start);
            self.statement.push_str(&String::from_utf8_lossy(line));
            self.statement.push(' ');
        }
        goes_on
    }

    /// Reads a line; whether there was one.
    fn read(&mut self) -> Result<bool, ObjError> {
        self.bytes.clear();
        self.line += 1;
        let line = self.line;
        let read = self.text.read_until(b'\n', &mut self.bytes);
        let read = read.map_err(|source| ObjError::Read { line, source })?;
        if self.text.limit() == 0 {
            return Err(ObjError::TooLong { limit: LONGEST });
        }
        if line == 1 && self.bytes.starts_with(BYTE_ORDER_MARK) {
            self.bytes.drain(..BYTE_ORDER_MARK.len());
        }
        Ok(read > 0)
    }
}

/// The words of a statement, one after another.
pub(super) struct Words<'a> {
    statement: &'a str,
    pieces: &'a [Piece],
    place: usize,
}

/// A word with its place in the text, both from 1.
#[derive(Clone, Copy)]
pub(super) struct Word<'a> {
    pub(super) text: &'a str,
    pub(super) line: usize,
    pub(super) column: usize,
}

impl<'a> Words<'a> {
    pub(super) fn next(&mut self) -> Option<Word<'a>> {
        let rest = &self.statement[self.place..];
        let begin = rest.find(|c: char| !c.is_ascii_whitespace())?;
        let rest = &rest[begin..];
        let text = &rest[..rest.find(|c: char| c.is_ascii_whitespace()).unwrap_or(rest.len())];
        let start = self.place + begin;
        self.place = start + text.len();
        Some(self.placed(text, start))
    }

    /// The next word, which must be there.
    pub(super) fn required(&mut self, expected: &'static str) -> Result<Word<'a>, ObjError> {
        self.next().ok_or_else(|| {
            let Word { line, column, .. } = self.placed("", self.statement.trim_ascii_end().len());
            let found = "the end of the line".to_owned();
            ObjError::Unexpected { line, column, expected, found }
        })
    }

    fn placed(&self, text: &'a str, start: usize) -> Word<'a> {
        let piece = self.pieces.partition_point(|piece| piece.start <= start);
        let Piece { start: begin, line } = self.pieces[piece.saturating_sub(1)];
        Word { text, line, column: 1 + self.statement[begin..start].chars().count() }
    }
}

impl Word<'_> {
    pub(super) fn unexpected(&self, expected: &'static str) -> ObjError {
        let shown: String = self.text.chars().take(SHOWN).collect();
        let more = if shown.len() < self.text.len() { "..." } else { "" };
        let found = format!("`{shown}{more}`");
        ObjError::Unexpected { line: self.line, column: self.column, expected, found }
    }
}
