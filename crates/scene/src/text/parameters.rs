//! Parameters of a scene's file: numbers with names, which make one scene a family.
//!
//! ```text
//! [parameters]                       a string that begins with `=` is the number that it comes to,
//! L = 0.3                            wherever a number may stand, and in other parameters
//! height = "= 2*L"
//! ```
//! A value that is given from outside takes the place of the file's. Titles, units and names stay as they are.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::text::diagnostic::{Checked, at};
use crate::text::expression;
use crate::text::fault::Fault;
use crate::text::suggestion::{nearest, shortened};

/// Values for the parameters of a scene, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters(BTreeMap<String, f64>);

impl Parameters {
    /// No values: those of the file hold.
    pub fn new() -> Self {
        Parameters::default()
    }

    /// The same with a value for a parameter.
    pub fn with(mut self, name: &str, value: f64) -> Self {
        self.0.insert(name.to_owned(), value);
        self
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// An expression of a file, and where it stands.
type Said = (Range<usize>, String);

/// Whether a text may have expressions in it.
pub(crate) fn has_expressions(text: &str) -> bool {
    text.contains("\"=") || text.contains("'=")
}

/// The numbers that the expressions of a file come to, as a file writes them, in the order of
/// [`for_each`].
pub(crate) fn values(root: &mut DeTable<'_>, given: &Parameters) -> Checked<Vec<String>> {
    let own = own(root)?;
    if let Some(name) = given.0.keys().find(|name| !own.contains_key(*name)) {
        let names = own.keys().map(String::as_str);
        let fault = Fault::UnknownWord {
            kind: "parameter",
            word: shortened(name),
            nearest: nearest(name, names.clone()).map(str::to_owned),
            allowed: names.map(str::to_owned).collect(),
        };
        return Err(at(0..0, fault));
    }
    let known = Known { own, given, open: RefCell::default() };
    let mut said: Vec<Said> = Vec::new();
    for_each(root, &mut |value| {
        let span = value.span();
        if let DeValue::String(text) = value.get_ref() {
            said.push((span, text[1..].to_owned()));
        }
    });
    let number = |(span, text): Said| {
        let value = expression::value(&text, &mut |name| known.value(name)).and_then(finite);
        let value = value.map_err(|words| at(span, Fault::Expression(words)))?;
        Ok(match value.fract() == 0.0 && value.abs() < 1e15 {
            true => format!("{value:.0}"),
            false => format!("{value:?}"),
        })
    };
    said.into_iter().map(number).collect()
}

fn finite(value: f64) -> Result<f64, String> {
    match value.is_finite() {
        true => Ok(value),
        false => Err(format!("the expression comes to {value}; it must be finite")),
    }
}

/// Visits every expression, tables and lists in their order.
pub(crate) fn for_each<'t>(root: &mut DeTable<'t>, see: &mut dyn FnMut(&mut Spanned<DeValue<'t>>)) {
    for (key, value) in root.iter_mut() {
        // Their texts may be anything; of names only those are allowed that are none.
        if !matches!(key.get_ref().as_ref(), "title" | "units" | "name") {
            visit(value, see);
        }
    }
}

fn visit<'t>(value: &mut Spanned<DeValue<'t>>, see: &mut dyn FnMut(&mut Spanned<DeValue<'t>>)) {
    match value.get_mut() {
        DeValue::String(text) if text.starts_with('=') => see(value),
        DeValue::Array(all) => all.iter_mut().for_each(|one| visit(one, see)),
        DeValue::Table(table) => for_each(table, see),
        _ => {}
    }
}

/// A parameter as the file has it.
enum Own {
    Number(f64),
    Expression(String),
}

const NO_PARAMETER: &str = "a parameter is a number, or an expression such as \"= 2*L\"";

/// The parameters of a file.
fn own(root: &DeTable<'_>) -> Checked<BTreeMap<String, Own>> {
    let mut own = BTreeMap::new();
    let Some(DeValue::Table(table)) = root.get("parameters").map(Spanned::get_ref) else {
        return Ok(own);
    };
    for (name, value) in table.iter() {
        let parsed = match value.get_ref() {
            DeValue::Integer(n) => {
                i64::from_str_radix(n.as_str(), n.radix()).ok().map(|n| n as f64)
            }
            DeValue::Float(x) => x.as_str().parse().ok(),
            _ => None,
        };
        let parsed = match (parsed, value.get_ref()) {
            (Some(number), _) => Own::Number(number),
            (None, DeValue::String(text)) if text.starts_with('=') => {
                Own::Expression(text[1..].to_owned())
            }
            (_, other) => {
                let mut words = NO_PARAMETER.to_owned();
                if matches!(other, DeValue::Array(_) | DeValue::Table(_)) {
                    let name = shortened(name.get_ref());
                    words += &format!(
                        "; `{name}` stands below the header [parameters] and so belongs to it: move it above"
                    );
                }
                return Err(at(value.span(), Fault::Expression(words)));
            }
        };
        own.insert(name.get_ref().as_ref().to_owned(), parsed);
    }
    Ok(own)
}

struct Known<'a> {
    own: BTreeMap<String, Own>,
    given: &'a Parameters,
    /// Those whose values are being computed.
    open: RefCell<Vec<String>>,
}

impl Known<'_> {
    fn value(&self, name: &str) -> Result<f64, String> {
        if let Some(&value) = self.given.0.get(name) {
            return Ok(value);
        }
        match self.own.get(name) {
            Some(Own::Number(value)) => Ok(*value),
            Some(Own::Expression(text)) => {
                if self.open.borrow().iter().any(|open| open == name) {
                    return Err(format!("the parameter `{name}` depends on itself"));
                }
                self.open.borrow_mut().push(name.to_owned());
                let value = expression::value(text, &mut |name| self.value(name));
                self.open.borrow_mut().pop();
                value
            }
            None => {
                let allowed = self.own.keys().map(String::as_str);
                let hint = nearest(name, allowed)
                    .map_or(String::new(), |near| format!("; did you mean `{near}`?"));
                Err(format!("unknown parameter `{}`{hint}", shortened(name)))
            }
        }
    }
}
