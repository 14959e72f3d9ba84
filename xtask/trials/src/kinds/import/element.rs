//! Elements of XML, written in any order.

use std::fmt::Write as _;

use crate::Draw;

/// An element.
#[derive(Clone, Debug, Default)]
pub(super) struct Element {
    pub(super) tag: &'static str,
    pub(super) said: Vec<(&'static str, String)>,
    pub(super) inside: Vec<Element>,
}

impl Element {
    pub(super) fn new(tag: &'static str) -> Self {
        Element { tag, ..Element::default() }
    }

    pub(super) fn says(mut self, word: &'static str, value: impl Into<String>) -> Self {
        self.said.push((word, value.into()));
        self
    }

    pub(super) fn with(mut self, inside: Element) -> Self {
        self.inside.push(inside);
        self
    }

    pub(super) fn with_some(mut self, inside: Option<Element>) -> Self {
        self.inside.extend(inside);
        self
    }

    /// Its text, what it says in another order; `ordered` are the elements whose insides keep theirs.
    pub(super) fn write(&self, draw: &mut Draw, ordered: &[&str], out: &mut String) {
        let mut said: Vec<_> = self.said.iter().collect();
        shuffle(draw, &mut said);
        let _ = write!(out, "<{}", self.tag);
        for (word, value) in said {
            let quote = draw.one_of(&["\"", "'"]);
            let _ = write!(out, " {word}={quote}{value}{quote}");
        }
        if self.inside.is_empty() {
            out.push_str("/>\n");
            return;
        }
        out.push_str(">\n");
        let mut inside: Vec<_> = self.inside.iter().collect();
        if !ordered.contains(&self.tag) {
            shuffle(draw, &mut inside);
        }
        inside.iter().for_each(|element| element.write(draw, ordered, out));
        let _ = writeln!(out, "</{}>", self.tag);
    }
}

pub(super) fn shuffle<T>(draw: &mut Draw, list: &mut [T]) {
    for k in (1..list.len()).rev() {
        list.swap(k, draw.below(k + 1));
    }
}
