//! Mutant schemata: one text that holds all mutants of a file, each behind a switch.
//!
//! `a + b` becomes `(if crate::mutant_switch::on(17) {((a) - (b))} else {(a + b)})`, so that one
//! compilation serves them all. Source: Untch, Offutt and Harrold 1993, "Mutation analysis using
//! mutant schemata".

use std::ops::Range;

use crate::draw::Drawn;
use crate::operators::Form;

/// The switch, for the end of `lib.rs`. It reads the number of the mutant from a file, because reading
/// an environment variable allocates, and some tests count allocations.
pub const SWITCH: &str = r#"
mod mutant_switch {
    use std::io::Read;
    static NUMBER: std::sync::LazyLock<u32> = std::sync::LazyLock::new(|| {
        let mut digits = [0; 8];
        let read = std::fs::File::open(concat!(env!("CARGO_MANIFEST_DIR"), "/mutant"))
            .and_then(|mut file| file.read(&mut digits));
        let digits = &digits[..read.unwrap_or(0)];
        std::str::from_utf8(digits).unwrap_or("").parse().unwrap_or(0)
    });
    #[inline]
    pub fn on(number: u32) -> bool {
        *NUMBER == number
    }
}
"#;

/// Where a mutant stands in the written text.
pub struct Placed {
    /// Its number.
    pub number: u32,
    /// The bytes of the mutated text.
    pub mutated: Range<usize>,
    /// The bytes of switch, mutated and original text.
    pub whole: Range<usize>,
}

/// The text with all its mutants, and where they stand.
pub fn write(text: &str, mutants: &[&Drawn]) -> (String, Vec<Placed>) {
    let mut sorted = mutants.to_vec();
    sorted.sort_by_key(|drawn| (drawn.mutant.range.start, usize::MAX - drawn.mutant.range.end));
    let mut writer = Writer { text, out: String::new(), placed: Vec::new() };
    writer.write(0..text.len(), &sorted);
    (writer.out, writer.placed)
}

struct Writer<'a> {
    text: &'a str,
    out: String,
    placed: Vec<Placed>,
}

impl Writer<'_> {
    /// Writes a range of the text with the mutants that lie in it: the outer before the inner ones.
    fn write(&mut self, range: Range<usize>, mutants: &[&Drawn]) {
        let mut done = range.start;
        let mut rest = mutants;
        while let Some(first) = rest.first() {
            let whole = first.mutant.range.clone();
            let same = rest.iter().take_while(|next| next.mutant.range == whole).count();
            let inside = rest.iter().take_while(|next| next.mutant.range.start < whole.end).count();
            let inside = inside.max(same);
            self.out.push_str(&self.text[done..whole.start]);
            self.switch(whole.clone(), &rest[..same], &rest[same..inside]);
            done = whole.end;
            rest = &rest[inside..];
        }
        self.out.push_str(&self.text[done..range.end]);
    }

    /// Writes the mutants of one range, and its original text with those inside.
    fn switch(&mut self, range: Range<usize>, same: &[&Drawn], inside: &[&Drawn]) {
        let begin = self.out.len();
        let form = same[0].mutant.form;
        if form == Form::Expression {
            self.out.push('(');
        }
        let first = self.placed.len();
        for (place, Drawn { number, mutant }) in same.iter().enumerate() {
            let before = if place > 0 && form != Form::Entry { " else " } else { "" };
            self.out.push_str(&format!("{before}if crate::mutant_switch::on({number}) {{"));
            let at = self.out.len();
            self.out.push_str(&match form {
                Form::Expression => format!("({})", mutant.mutated),
                Form::Statement => mutant.mutated.clone(),
                Form::Entry => format!("return {};", mutant.mutated),
            });
            self.placed.push(Placed { number: *number, mutated: at..self.out.len(), whole: 0..0 });
            self.out.push('}');
        }
        let last = self.placed.len();
        match form {
            Form::Expression => self.out.push_str(" else {("),
            Form::Statement => self.out.push_str(" else {"),
            Form::Entry => {}
        }
        self.write(range, inside);
        match form {
            Form::Expression => self.out.push_str(")})"),
            Form::Statement => self.out.push('}'),
            Form::Entry => {}
        }
        for placed in &mut self.placed[first..last] {
            placed.whole = begin..self.out.len();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::operators::mutants;
    use crate::sources::Source;

    /// What is written for all mutants of a text that `keep` names.
    fn written(text: &str, keep: &[&str]) -> String {
        let tree = syn::parse_file(text).unwrap();
        let source = Source { path: PathBuf::new(), text: text.into(), tree };
        let all = mutants(0, &source).into_iter();
        let kept = all.filter(|mutant| keep.contains(&mutant.change.as_str()));
        let drawn: Vec<Drawn> =
            (1..).zip(kept).map(|(number, mutant)| Drawn { number, mutant }).collect();
        let (out, placed) = write(text, &drawn.iter().collect::<Vec<_>>());
        assert_eq!(placed.len(), keep.len(), "{out}");
        syn::parse_file(&out).unwrap();
        out.replace("crate::mutant_switch::", "")
    }

    #[test]
    fn the_inner_of_two_mutants_stands_in_the_original_of_the_outer() {
        let out =
            written("fn f() -> f64 { a + b * 2.0 }", &["a + b * 2.0 -> -", "2.0 -> 2.0 + 1.0"]);
        let inner = "(if on(2) {(2.0 + 1.0)} else {(2.0)})";
        let outer = format!("(if on(1) {{((a) - (b * 2.0))}} else {{(a + b * {inner})}})");
        assert_eq!(out, format!("fn f() -> f64 {{ {outer} }}"));
    }

    #[test]
    fn statements_are_left_out_and_results_returned_where_a_body_begins() {
        let out = written("fn f() -> bool { g.h(); x }", &["g.h(); dropped", "fn f -> true"]);
        let entry = "if on(1) {return true;}";
        assert_eq!(out, format!("fn f() -> bool {{{entry} if on(2) {{}} else {{g.h();}} x }}"));
    }

    #[test]
    fn constants_patterns_types_and_tests_have_no_mutants() {
        let text = "const A: f64 = 1.0 + 2.0; const fn f() -> u32 { 1 + 2 } \
            #[cfg(test)] mod tests { fn g() -> u32 { 1 + 2 } } \
            fn h(x: [f64; 3]) { match x { [0.0, ..] => {} _ => {} } }";
        assert_eq!(written(text, &[]), text);
        let tree = syn::parse_file(text).unwrap();
        let source = Source { path: PathBuf::new(), text: text.into(), tree };
        assert!(mutants(0, &source).is_empty());
    }
}
