//! The trajectory for ParaView: a file a sample in VTK's XML, and an index that names their times.
//!
//! ```text
//! trajectory.pvd               <DataSet timestep="t" file="trajectory/000017.vtu"/>
//! trajectory/000017.vtu        points, and cells: vertex 1, line 3, triangle 5
//! ```
//! Cells have a number `kind`: 0 a particle, 1 a spring, 2 a rod that is left, 3 an edge of a body, 4
//! a face of one; points have a number `particle`, their place in the scene, and `pinned`. Numbers
//! are text with every digit. Of more samples than [`FILES`] so many are written, evenly chosen.
//! Format: VTK file formats, XML, unstructured grids, version 0.1.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use crate::csv::write_file;
use crate::drawing::thinned;
use crate::{Motion, Run, WriteError};

/// Samples that are written: so many files a folder still bears.
const FILES: usize = 2_000;

const POINT: u8 = 1;
const LINE: u8 = 3;
const TRIANGLE: u8 = 5;

/// Cells of a sample: their points one after the other, where each ends, what it is.
#[derive(Default)]
struct Cells {
    connectivity: Vec<usize>,
    offsets: Vec<usize>,
    types: Vec<u8>,
    kinds: Vec<u8>,
}

impl Cells {
    fn add(&mut self, shape: u8, kind: u8, corners: &[usize]) {
        self.connectivity.extend(corners);
        self.offsets.push(self.connectivity.len());
        self.types.push(shape);
        self.kinds.push(kind);
    }

    fn of(run: &Run, sample: usize) -> Self {
        let (scene, mut cells) = (&run.scene, Cells::default());
        (0..scene.particles.len()).for_each(|particle| cells.add(POINT, 0, &[particle]));
        scene.links.iter().for_each(|link| cells.add(LINE, 1, &link.ends));
        run.rods_at(sample).for_each(|ends| cells.add(LINE, 2, &ends));
        scene.edges.iter().for_each(|ends| cells.add(LINE, 3, ends));
        scene.surface().iter().for_each(|face| cells.add(TRIANGLE, 4, &face.corners));
        cells
    }
}

/// Writes `trajectory.pvd` and the folder `trajectory`, which must not be there yet or be one of
/// these.
pub(crate) fn write(run: &Run, folder: &Path) -> Result<(), WriteError> {
    let series = folder.join("trajectory");
    fs::create_dir_all(&series).map_err(|source| WriteError { path: series.clone(), source })?;
    let samples = thinned(run.times().len(), FILES);
    let name = |sample: usize| format!("{sample:06}.vtu");
    for &sample in &samples {
        write_file(&series.join(name(sample)), |out| grid(run, sample, out))?;
    }
    write_file(&folder.join("trajectory.pvd"), |out| {
        writeln!(out, "<?xml version=\"1.0\"?>")?;
        writeln!(out, "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">")?;
        writeln!(out, "<Collection>")?;
        for &sample in &samples {
            let (time, file) = (run.times()[sample], name(sample));
            writeln!(
                out,
                "<DataSet timestep=\"{time:?}\" part=\"0\" file=\"trajectory/{file}\"/>"
            )?;
        }
        writeln!(out, "</Collection>\n</VTKFile>")
    })
}

fn grid(run: &Run, sample: usize, out: &mut impl Write) -> io::Result<()> {
    let (count, cells) = (run.scene.particles.len(), Cells::of(run, sample));
    let pinned = run.scene.particles.iter().map(|p| u8::from(p.motion == Motion::Pinned));
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    let kind = "type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"";
    writeln!(out, "<VTKFile {kind}>\n<UnstructuredGrid>")?;
    let size = cells.offsets.len();
    writeln!(out, "<Piece NumberOfPoints=\"{count}\" NumberOfCells=\"{size}\">")?;
    let places = (0..count).flat_map(|particle| run.position(sample, particle));
    writeln!(out, "<Points>")?;
    array(out, "Float64", "points", 3, places.map(|x| format!("{x:?}")))?;
    writeln!(out, "</Points>\n<Cells>")?;
    array(out, "Int64", "connectivity", 1, cells.connectivity.iter())?;
    array(out, "Int64", "offsets", 1, cells.offsets.iter())?;
    array(out, "UInt8", "types", 1, cells.types.iter())?;
    writeln!(out, "</Cells>\n<PointData>")?;
    array(out, "Int64", "particle", 1, 0..count)?;
    array(out, "UInt8", "pinned", 1, pinned)?;
    writeln!(out, "</PointData>\n<CellData>")?;
    array(out, "UInt8", "kind", 1, cells.kinds.iter())?;
    writeln!(out, "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")
}

/// An array of numbers, as text in lines.
fn array(
    out: &mut impl Write,
    kind: &str,
    name: &str,
    components: usize,
    numbers: impl Iterator<Item = impl std::fmt::Display>,
) -> io::Result<()> {
    /// Numbers in a line.
    const LINE: usize = 12;
    let shape = format!("NumberOfComponents=\"{components}\" format=\"ascii\"");
    write!(out, "<DataArray type=\"{kind}\" Name=\"{name}\" {shape}>")?;
    for (k, number) in numbers.enumerate() {
        let before = if k % LINE == 0 { '\n' } else { ' ' };
        write!(out, "{before}{number}")?;
    }
    writeln!(out, "\n</DataArray>")
}
