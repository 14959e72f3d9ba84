//! Tables for other programs: numbers with every digit that tells them from their neighbours.
//!
//! ```text
//! trajectory.csv     time, particle, x, y, z      a row for each sample and particle
//! observables.csv    time, then the columns of each observable, a row for each sample
//! events.csv         time, the ends of a rod that broke, the tension that broke it;
//!                    or time, how often the law of impact was applied in that step
//! ```

use std::fs::File;
use std::io;
use std::io::{BufWriter, Write};
use std::path::Path;

use crate::model::scene::COORDINATES;
use crate::run::samples::{Impacts, Run};
use crate::text::file_error::WriteError;

/// Writes a file, all of it or an error.
pub(crate) fn write_file(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), WriteError> {
    let written = File::create(path).and_then(|file| {
        let mut out = BufWriter::new(file);
        content(&mut out)?;
        out.flush()
    });
    written.map_err(|source| WriteError { path: path.to_owned(), source })
}

/// Where every particle is at every sample.
pub(crate) fn trajectory(run: &Run, out: &mut impl Write) -> io::Result<()> {
    let (scene, units) = (run.scene(), run.scene().units());
    let d = scene.dimension();
    write!(out, "{},particle", quoted(&format!("time [{}]", units.time)))?;
    for axis in &COORDINATES[..d] {
        write!(out, ",{}", quoted(&format!("{axis} [{}]", units.length)))?;
    }
    writeln!(out)?;
    for (sample, time) in run.times().iter().enumerate() {
        let positions = run.positions(sample).chunks_exact(d);
        for (particle, position) in scene.particles().iter().zip(positions) {
            write!(out, "{time:?},{}", particle.name)?;
            for x in position {
                write!(out, ",{x:?}")?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

/// The observables at every sample.
pub(crate) fn observables(run: &Run, out: &mut impl Write) -> io::Result<()> {
    write!(out, "{}", quoted(&format!("time [{}]", run.scene().units().time)))?;
    for heading in run.headings() {
        write!(out, ",{}", quoted(&heading))?;
    }
    writeln!(out)?;
    for (sample, time) in run.times().iter().enumerate() {
        write!(out, "{time:?}")?;
        for x in run.observed(sample) {
            write!(out, ",{x:?}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Every rod that broke.
pub(crate) fn broken_rods(run: &Run, out: &mut impl Write) -> io::Result<()> {
    let (scene, units) = (run.scene(), run.scene().units());
    let headings = [format!("time [{}]", units.time), format!("tension [{}]", units.force())];
    let [time, tension] = headings.map(|heading| quoted(&heading));
    writeln!(out, "{time},broken from,broken to,{tension}")?;
    for broken in run.broken() {
        let [a, b] = scene.rods()[broken.rod].ends.map(|end| &scene.particles()[end].name);
        writeln!(out, "{:?},{a},{b},{:?}", broken.time, broken.tension)?;
    }
    Ok(())
}

/// Every step in which things met.
pub(crate) fn impacts(run: &Run, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "{},impacts", quoted(&format!("time [{}]", run.scene().units().time)))?;
    for Impacts { time, count } in run.impacts() {
        writeln!(out, "{time:?},{count}")?;
    }
    Ok(())
}

/// The text, in quotes where it would not stand alone in a cell.
pub(crate) fn quoted(text: &str) -> String {
    if text.contains([',', '"']) {
        return format!("\"{}\"", text.replace('"', "\"\""));
    }
    text.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_with_a_comma_is_one_cell() {
        assert_eq!(quoted("x [m]"), "x [m]");
        assert_eq!(quoted("x [a, \"b\"]"), "\"x [a, \"\"b\"\"]\"");
    }
}
