//! Arithmetic in a scene's file: `"= 2*L + 0.1"` is a number like any other.
//!
//! ```text
//! sum = product (("+" | "-") product)*       product = sign (("*" | "/") sign)*
//! sign = "-" sign | power                    power = atom ("^" sign)?
//! atom = number | name | name "(" sum ")" | "(" sum ")"
//! ```
//! Names are parameters and `pi`; functions are `sqrt`, `sin`, `cos`, `tan`, `exp`, `ln` and `abs`.
//! Angles are in radians.

/// Parentheses, signs and powers that an expression may nest.
const DEPTH: usize = 64;

/// The value of an expression; `parameter` knows names.
///
/// An error says what is wrong in words.
pub(crate) fn value(
    text: &str,
    parameter: &mut dyn FnMut(&str) -> Result<f64, String>,
) -> Result<f64, String> {
    let mut reader = Reader { rest: text, depth: 0, parameter };
    let value = reader.sum()?;
    match reader.peek() {
        None => Ok(value),
        Some(c) => Err(format!("`{c}` is not expected here")),
    }
}

struct Reader<'a, 'p> {
    rest: &'a str,
    depth: usize,
    parameter: &'p mut dyn FnMut(&str) -> Result<f64, String>,
}

impl<'a> Reader<'a, '_> {
    fn peek(&mut self) -> Option<char> {
        self.rest = self.rest.trim_start();
        self.rest.chars().next()
    }

    /// Whether this comes next, which is then passed.
    fn next_is(&mut self, c: char) -> bool {
        let next = self.peek() == Some(c);
        if next {
            self.rest = &self.rest[c.len_utf8()..];
        }
        next
    }

    fn sum(&mut self) -> Result<f64, String> {
        let mut sum = self.product()?;
        loop {
            if self.next_is('+') {
                sum += self.product()?;
            } else if self.next_is('-') {
                sum -= self.product()?;
            } else {
                return Ok(sum);
            }
        }
    }

    fn product(&mut self) -> Result<f64, String> {
        let mut product = self.sign()?;
        loop {
            if self.next_is('*') {
                product *= self.sign()?;
            } else if self.next_is('/') {
                product /= self.sign()?;
            } else {
                return Ok(product);
            }
        }
    }

    fn sign(&mut self) -> Result<f64, String> {
        self.depth += 1;
        if self.depth > DEPTH {
            return Err(format!("the expression nests more than {DEPTH} deep"));
        }
        let value = if self.next_is('-') { -self.sign()? } else { self.power()? };
        self.depth -= 1;
        Ok(value)
    }

    fn power(&mut self) -> Result<f64, String> {
        let base = self.atom()?;
        match self.next_is('^') {
            true => Ok(base.powf(self.sign()?)),
            false => Ok(base),
        }
    }

    fn atom(&mut self) -> Result<f64, String> {
        match self.peek() {
            None => Err("the expression ends where a number is expected".to_owned()),
            Some('(') => self.parenthesis(),
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => {
                let name = self.take(|c| c.is_alphanumeric() || c == '_');
                if self.peek() == Some('(') {
                    let function = function(name)?;
                    return Ok(function(self.parenthesis()?));
                }
                match name {
                    "pi" => Ok(std::f64::consts::PI),
                    _ => (self.parameter)(name),
                }
            }
            Some(c) => Err(format!("`{c}` is not expected here")),
        }
    }

    fn parenthesis(&mut self) -> Result<f64, String> {
        self.next_is('(');
        let inner = self.sum()?;
        match self.next_is(')') {
            true => Ok(inner),
            false => Err("a `)` is missing".to_owned()),
        }
    }

    fn number(&mut self) -> Result<f64, String> {
        let start = self.rest;
        self.take(|c| c.is_ascii_digit() || c == '.');
        if let Some(power) = self.rest.strip_prefix(['e', 'E']) {
            let digits = power.strip_prefix(['+', '-']).unwrap_or(power);
            if digits.starts_with(|c: char| c.is_ascii_digit()) {
                self.rest = digits;
                self.take(|c| c.is_ascii_digit());
            }
        }
        let number = &start[..start.len() - self.rest.len()];
        number.parse().map_err(|_| format!("`{number}` is not a number"))
    }

    fn take(&mut self, of: impl Fn(char) -> bool) -> &'a str {
        let end = self.rest.find(|c| !of(c)).unwrap_or(self.rest.len());
        let (taken, rest) = self.rest.split_at(end);
        self.rest = rest;
        taken
    }
}

fn function(name: &str) -> Result<fn(f64) -> f64, String> {
    Ok(match name {
        "sqrt" => f64::sqrt,
        "sin" => f64::sin,
        "cos" => f64::cos,
        "tan" => f64::tan,
        "exp" => f64::exp,
        "ln" => f64::ln,
        "abs" => f64::abs,
        _ => return Err(format!("unknown function `{name}`")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<f64, String> {
        value(text, &mut |name| match name {
            "L" => Ok(0.5),
            other => Err(format!("unknown parameter `{other}`")),
        })
    }

    #[test]
    fn arithmetic_is_that_of_the_blackboard() {
        for (text, expected) in [
            ("2*L + 0.1", 2.0 * 0.5 + 0.1),
            ("1 - 2 - 3", -4.0),
            ("8/4/2", 1.0),
            ("-L^2", -0.25),
            ("2^3^2", 512.0),
            ("2^-1", 0.5),
            ("(1 + 2) * -3", -9.0),
            ("1.5e-3 * 2", 3e-3),
            ("2*cos(pi/3)", 2.0 * (std::f64::consts::PI / 3.0).cos()),
            ("sqrt(abs(-4)) + exp(0) + ln(1) + sin(0) + tan(0)", 3.0),
        ] {
            assert_eq!(of(text), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_is_no_expression_is_answered_in_words() {
        for (text, words) in [
            ("", "the expression ends where a number is expected"),
            ("1 +", "the expression ends where a number is expected"),
            ("(1", "a `)` is missing"),
            ("1 2", "`2` is not expected here"),
            ("1.2.3", "`1.2.3` is not a number"),
            ("M", "unknown parameter `M`"),
            ("root(2)", "unknown function `root`"),
            ("2 % 3", "`%` is not expected here"),
        ] {
            assert_eq!(of(text), Err(words.to_owned()), "{text}");
        }
        for nested in ["(", "-", "2^"] {
            let error = of(&nested.repeat(100_000)).unwrap_err();
            assert_eq!(error, "the expression nests more than 64 deep");
        }
    }
}
