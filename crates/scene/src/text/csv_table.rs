//! Tables of two columns in CSV files beside a scene's: times and values.
//!
//! Lines that begin with `#`, empty lines and a line of headings at the top are passed over. Two rows of
//! one time are a jump.

use std::path::Path;

use stationary_calculus::Readable;
use toml::Spanned;

use crate::text::beside::{failed, found};
use crate::text::diagnostic::Checked;

/// Rows that a table may have.
const ROWS: usize = 1 << 20;

/// The rows of the table in a file of the scene's folder, in the order of time.
pub(crate) fn read(folder: Option<&Path>, file: &Spanned<String>) -> Checked<Vec<[f64; 2]>> {
    let path = found(folder, file)?;
    let text = std::fs::read_to_string(path).map_err(|error| failed(file, error.to_string()))?;
    rows(&text).map_err(|why| failed(file, why))
}

fn rows(text: &str) -> Result<Vec<[f64; 2]>, String> {
    let mut rows: Vec<[f64; 2]> = Vec::new();
    let mut headed = false;
    for (number, line) in text.lines().enumerate() {
        let (number, line) = (number + 1, line.trim());
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let values: Vec<Option<f64>> = cells.iter().map(|cell| cell.parse().ok()).collect();
        let row = match values[..] {
            [Some(t), Some(value)] => [t, value],
            [None, None] if rows.is_empty() && !headed => {
                headed = true;
                continue;
            }
            [_, _] => return Err(format!("line {number} is `{line}`, not a time and a value")),
            _ => return Err(format!("line {number} has {} columns, not 2", cells.len())),
        };
        if let Some(x) = row.iter().find(|x| !x.is_finite()) {
            return Err(format!("line {number} has the number {x}; it must be finite"));
        }
        if let Some(last) = rows.last().filter(|last| row[0] < last[0]) {
            let [time, before] = [&row[0], &last[0]].map(Readable);
            return Err(format!("line {number}: the time {time} is before {before}"));
        }
        if let [.., [first, _], [second, _]] = rows[..]
            && first == second
            && second == row[0]
        {
            return Err(format!(
                "line {number} is the third row of the time {second}; a jump has two"
            ));
        }
        if rows.len() == ROWS {
            return Err(format!("it has more than {ROWS} rows"));
        }
        rows.push(row);
    }
    if rows.is_empty() { Err("it has no rows".to_owned()) } else { Ok(rows) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_values_are_read_beside_headings_comments_and_jumps() {
        let text = "time [s],force [N]\n# by hand\n0, 1\n\n0.5,2e3\r\n0.5,-1\n";
        assert_eq!(rows(text), Ok(vec![[0.0, 1.0], [0.5, 2e3], [0.5, -1.0]]));
    }

    #[test]
    fn a_table_that_is_none_is_answered_with_its_line() {
        for (text, words) in [
            ("", "it has no rows"),
            ("t,f\n", "it has no rows"),
            ("0,1\n1\n", "line 2 has 1 columns, not 2"),
            ("0,1,2\n", "line 1 has 3 columns, not 2"),
            ("0,1\n1,x\n", "line 2 is `1,x`, not a time and a value"),
            ("0,1\nt,f\n", "line 2 is `t,f`, not a time and a value"),
            ("0,inf\n", "line 1 has the number inf; it must be finite"),
            ("1,0\n0,0\n", "line 2: the time 0 is before 1"),
            ("1,0\n1,1\n1,2\n", "line 3 is the third row of the time 1; a jump has two"),
        ] {
            assert_eq!(rows(text), Err(words.to_owned()), "{text}");
        }
    }
}
