//! A table as CSV (RFC 4180), with every digit and every column.

use stationary_measure::{Cell, Table};

/// The table, its column names first.
pub(crate) fn csv(table: &Table) -> String {
    let names = table.columns().iter().map(|column| quoted(&column.name)).collect::<Vec<_>>();
    let mut text = names.join(",") + "\r\n";
    for row in table.rows() {
        let cells: Vec<String> = row.iter().map(cell_text).collect();
        text += &cells.join(",");
        text += "\r\n";
    }
    text
}

fn cell_text(cell: &Cell) -> String {
    match cell {
        // Debug is the shortest form that reads back as the same number.
        Cell::Number(x) => format!("{x:?}"),
        Cell::Count(count) => count.to_string(),
        Cell::Text(text) => quoted(text),
    }
}

fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) || text.trim() != text {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use stationary_measure::Column;

    use super::*;

    #[test]
    fn only_text_that_needs_quotes_is_quoted() {
        let mut table = Table::new([Column::exact("method"), Column::volatile("wall, median [s]")]);
        table.push(["plain".into(), 0.1.into()]);
        table.push(["said \"no\", twice\nover".into(), f64::NAN.into()]);
        table.push(["".into(), 1e-300.into()]);
        let expected = "method,\"wall, median [s]\"\r\nplain,0.1\r\n\
                        \"said \"\"no\"\", twice\nover\",NaN\r\n,1e-300\r\n";
        assert_eq!(csv(&table), expected);
    }
}
