//! The table and the chart of a sweep.

use stationary_chart::{Axis, Chart, Lines, Series};
use stationary_measure::{Cell, Column, Table};

use super::family::{Family, Row, Seen};
use crate::report::{Folder, ReportError, csv};

/// What is told of a column, and its name.
type Part = (&'static str, fn(&Seen) -> f64);

const PARTS: [Part; 3] = [
    ("at the end", |seen| seen.end),
    ("largest", |seen| seen.largest),
    ("smallest", |seen| seen.smallest),
];

/// Curves that are told from each other on a chart.
const MOST_NAMED: usize = 9;

/// Writes both.
pub(super) fn write(family: &Family, rows: &[Row], folder: &Folder) -> Result<(), ReportError> {
    let chart = chart(family, rows);
    let file = "sweep.svg";
    let svg = chart.file(&words(family, rows));
    let svg = svg.map_err(|source| ReportError::Chart { file: file.to_owned(), source })?;
    folder.write("sweep.csv", &csv(&table(family, rows)))?;
    folder.write(file, &svg)
}

/// A row a run: the parameters, each column of the observable, and why there is none.
fn table(family: &Family, rows: &[Row]) -> Table {
    let parameters = family.axes.iter().map(|axis| axis.name.clone());
    let observed = family
        .headings
        .iter()
        .flat_map(|heading| PARTS.iter().map(move |(part, _)| format!("{heading}, {part}")));
    let names = parameters.chain(observed).chain(["failure".to_owned()]);
    let mut table = Table::new(names.map(|name| Column::exact(&name)));
    let empty = || Cell::from("");
    for row in rows {
        let mut cells: Vec<Cell> = family.values(row.run).into_iter().map(Cell::from).collect();
        match &row.result {
            Ok(columns) => {
                let numbers = columns.iter().flat_map(|seen| PARTS.map(|(_, of)| of(seen)));
                cells.extend(numbers.map(Cell::from));
                cells.push(empty());
            }
            Err(reason) => {
                let blank = PARTS.len() * family.headings.len();
                cells.extend((0..blank).map(|_| empty()));
                cells.push(Cell::from(reason.as_str()));
            }
        }
        table.push(cells);
    }
    table
}

/// Against the first parameter. All three numbers of each column where it is the only parameter with
/// several values; else those at the end, a curve for each choice of the others.
fn chart(family: &Family, rows: &[Row]) -> Chart {
    let (title, unit) = title(&family.headings);
    let mut lines = Lines::new(
        &format!("{}: {title}", family.title),
        Axis::linear(&family.axes[0].name, ""),
        Axis::linear(&title, &unit),
    );
    // The others change fastest: a choice of them is each so many runs.
    let choices = family.runs() / family.axes[0].values.len();
    let parts = if choices == 1 { &PARTS[..] } else { &PARTS[..1] };
    let curves = choices * parts.len() * family.headings.len();
    for choice in 0..choices {
        let of_choice = others(family, choice);
        for (column, heading) in family.headings.iter().enumerate() {
            for (part, of) in parts {
                let component = component(heading, family.headings.len());
                let words = [component.as_str(), *part, of_choice.as_str()];
                let words: Vec<&str> = words.into_iter().filter(|word| !word.is_empty()).collect();
                let rows = rows.iter().filter(|row| row.run % choices == choice);
                let mut series = series(family, rows, &words.join(" "), |seen| of(&seen[column]));
                // A run that failed is one cross, not one on each of its curves.
                if column > 0 || *part != PARTS[0].0 {
                    series.failures.clear();
                }
                lines = lines.with(if curves > MOST_NAMED { series.as_rest() } else { series });
            }
        }
    }
    lines.into()
}

fn series<'r>(
    family: &Family,
    rows: impl Iterator<Item = &'r Row>,
    name: &str,
    of: impl Fn(&[Seen]) -> f64,
) -> Series {
    let mut series = Series::new(name, []);
    let mut points = Vec::new();
    for row in rows {
        let x = family.values(row.run)[0];
        match &row.result {
            Ok(seen) => points.push((x, of(seen))),
            Err(reason) => series = series.failed(x, reason.as_str()),
        }
    }
    Series { points: points.clone(), mark: Series::new(name, points).mark, ..series }
}

/// `M = 2, k = 3`
fn others(family: &Family, choice: usize) -> String {
    let values = family.values(choice).into_iter().zip(&family.axes).skip(1);
    let values = values.filter(|(_, axis)| axis.values.len() > 1);
    let words = values.map(|(value, axis)| format!("{} = {value}", axis.name));
    words.collect::<Vec<_>>().join(", ")
}

/// The observable and its unit: `position of bob` and `m` of `position of bob x [m]` and its others.
fn title(headings: &[String]) -> (String, String) {
    let (first, unit) = parts(&headings[0]);
    let title = match headings {
        [_] => first,
        _ => first.rsplit_once(' ').map_or(first, |(title, _)| title),
    };
    (title.to_owned(), unit.to_owned())
}

/// The component of a vector.
fn component(heading: &str, columns: usize) -> String {
    let (words, _) = parts(heading);
    let last = words.rsplit_once(' ').map_or(words, |(_, last)| last);
    if columns > 1 { last.to_owned() } else { String::new() }
}

fn parts(heading: &str) -> (&str, &str) {
    let unit = heading.strip_suffix(']').and_then(|heading| heading.rsplit_once(" ["));
    unit.unwrap_or((heading, ""))
}

/// What a reader who does not see the chart is told.
fn words(family: &Family, rows: &[Row]) -> String {
    let (title, _) = title(&family.headings);
    let failed = rows.iter().filter(|row| row.result.is_err()).count();
    let names: Vec<&str> = family.axes.iter().map(|axis| axis.name.as_str()).collect();
    let names = names.join(", ");
    format!("The {title} against {names} in {} runs, of which {failed} failed.", rows.len())
}
