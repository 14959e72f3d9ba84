//! A table whose text is the same on every processor: what snapshot tests compare.
//!
//! A column says how many of its digits can be reproduced. Numbers are rounded to that many
//! significant digits, numbers at the level of rounding noise print as `<floor`, and volatile
//! columns (wall times) are kept for charts but left out of the text.
//!
//! ```
//! use stationary_measure::{Column, Table};
//! let mut table = Table::new([Column::exact("steps"), Column::rounded("error", 3, 1e-14)]);
//! table.push([100_u64.into(), 1.23456e-3.into()]);
//! table.push([200_u64.into(), 3e-17.into()]);
//! assert_eq!(table.to_string(), "steps  error\n100    1.23e-3\n200    <1e-14\n");
//! ```

use std::fmt;

/// One entry of a [`Table`].
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A measured or computed number.
    Number(f64),
    /// A counted number: steps, evaluations, iterations.
    Count(u64),
    /// A word: the name of a method, or the reason why there is no number.
    Text(String),
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Cell::Number(number)
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Cell::Count(count)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Cell::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Cell::Text(text)
    }
}

/// What of a column's numbers another processor reproduces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Precision {
    /// Words and counts: every character.
    Exact,
    /// This many significant digits; magnitudes below `floor` are rounding noise.
    Rounded {
        /// Significant digits printed, at least one.
        digits: usize,
        /// Magnitudes below it print as `<floor`.
        floor: f64,
    },
    /// Nothing: a wall time. Never printed.
    Volatile,
}

/// A column: its name (with the unit, where it has one) and what of it can be reproduced.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// The heading, with the unit in brackets where there is one.
    pub name: String,
    /// What of the numbers is printed.
    pub precision: Precision,
}

impl Column {
    /// A column of words or counts.
    pub fn exact(name: &str) -> Self {
        Column { name: name.to_owned(), precision: Precision::Exact }
    }

    /// A column of numbers with `digits` reproducible digits above `floor`.
    pub fn rounded(name: &str, digits: usize, floor: f64) -> Self {
        Column { name: name.to_owned(), precision: Precision::Rounded { digits, floor } }
    }

    /// A column of wall times: charted, never printed.
    pub fn volatile(name: &str) -> Self {
        Column { name: name.to_owned(), precision: Precision::Volatile }
    }

    fn text(&self, cell: &Cell) -> String {
        match (cell, self.precision) {
            (Cell::Text(text), _) => text.clone(),
            (Cell::Count(count), _) => count.to_string(),
            (Cell::Number(x), Precision::Rounded { floor, .. }) if x.abs() < floor => {
                format!("<{floor:e}")
            }
            (Cell::Number(x), Precision::Rounded { digits, .. }) => {
                // More digits than text can be asked for are more than a number has.
                format!("{x:.*e}", (digits.max(1) - 1).min(usize::from(u16::MAX) - 1))
            }
            (Cell::Number(x), _) => format!("{x}"),
        }
    }
}

/// Columns and rows; [`fmt::Display`] prints what is reproducible, aligned.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    columns: Vec<Column>,
    rows: Vec<Vec<Cell>>,
}

impl Table {
    /// An empty table with these columns.
    pub fn new(columns: impl IntoIterator<Item = Column>) -> Self {
        Table { columns: columns.into_iter().collect(), rows: Vec::new() }
    }

    /// Appends a row. Cells beyond the last column are dropped, missing ones are empty words.
    pub fn push(&mut self, cells: impl IntoIterator<Item = Cell>) {
        let mut row: Vec<Cell> = cells.into_iter().collect();
        row.resize(self.columns.len(), Cell::Text(String::new()));
        self.rows.push(row);
    }

    /// The columns, in order.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// The rows, each as long as [`Table::columns`].
    pub fn rows(&self) -> &[Vec<Cell>] {
        &self.rows
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let printed: Vec<usize> = (0..self.columns.len())
            .filter(|&j| self.columns[j].precision != Precision::Volatile)
            .collect();
        let mut lines = vec![printed.iter().map(|&j| self.columns[j].name.clone()).collect()];
        for row in &self.rows {
            lines.push(printed.iter().map(|&j| self.columns[j].text(&row[j])).collect::<Vec<_>>());
        }
        let widths: Vec<usize> = (0..printed.len())
            .map(|k| lines.iter().map(|line| line[k].chars().count()).max().unwrap_or(0))
            .collect();
        for line in &lines {
            let padded: Vec<String> =
                line.iter().zip(&widths).map(|(text, &w)| padded_to(w, text)).collect();
            writeln!(f, "{}", padded.join("  ").trim_end())?;
        }
        Ok(())
    }
}

/// The text and spaces up to a width, which may be more than a format can be asked for.
fn padded_to(width: usize, text: &str) -> String {
    text.to_owned() + &" ".repeat(width.saturating_sub(text.chars().count()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_any_length_and_numbers_of_any_number_of_digits_have_a_text() {
        let long = "x".repeat(70_000);
        let mut table = Table::new([Column::exact("word"), Column::rounded("error", 70_000, 0.0)]);
        table.push([long.as_str().into(), 1.5.into()]);
        table.push(["short".into(), "none".into()]);
        let text = table.to_string();
        let [head, wide, narrow] = text.lines().collect::<Vec<_>>()[..] else { panic!() };
        assert!(wide.starts_with(&format!("{long}  1.5000")) && wide.ends_with("000e0"));
        assert!(head.find("error") == Some(70_002) && narrow.find("none") == Some(70_002));
    }

    #[test]
    fn text_holds_only_what_another_processor_reproduces() {
        let mut table = Table::new([
            Column::exact("method"),
            Column::volatile("wall [s]"),
            Column::rounded("error", 2, 1e-12),
        ]);
        table.push(["verlet".into(), 0.123.into(), 0.0123456.into()]);
        table.push(["rk4".into(), 0.5.into(), 1e-15.into()]);
        table.push(["euler".into(), 0.5.into(), "diverged at t = 3".into()]);
        let text = table.to_string();
        assert_eq!(
            text,
            "method  error\nverlet  1.2e-2\nrk4     <1e-12\neuler   diverged at t = 3\n"
        );
    }
}
