//! The trajectory for ParaView: a file a sample in VTK's XML, and an index that names their times.
//!
//! ```text
//! trajectory.pvd               <DataSet timestep="t" file="trajectory/000017.vtu"/>
//! trajectory/000017.vtu        points, cells, and what is known of both
//! ```
//! Cells have a number `kind`: 0 a particle, 1 a spring, 2 a rod that is left, 3 an edge of a body, 4
//! a face of one, 5 an element of a solid or of heat, in whose scenes there are no edges and faces of
//! bodies; and where there are solids the `stress`, six components xx, yy, zz, xy, yz, xz, zero but in
//! elements. Points have a number `particle`, their place in the scene, and `pinned`; and what the
//! scene has of `velocity`, `temperature`, `displacement`, `contact_impulse` since the sample before
//! (that of a body at its centre), and of the body of each point `orientation` (a quaternion, scalar
//! first) and `angular_velocity` in body axes. Points of the surface of what is round come after the
//! scene's, with the `particle` at their body's centre. Numbers are text with every digit. Of more samples than
//! [`FILES`] so many are written, evenly chosen; an impulse is still that since the sample before.
//! Format: VTK file formats, XML, unstructured grids, version 0.1.

use std::io::Write;
use std::path::Path;
use std::{fs, io};

use stationary_mesh::Simplex;

use crate::model::particle::Motion;
use crate::model::scene::Scene;
use crate::model::simplices::{Middles, Simplices, with_middles};
use crate::run::fields::{BodyField, StressField};
use crate::run::samples::Run;
use crate::show::body_surface::BodySurface;
use crate::show::csv::write_file;
use crate::show::drawing::thinned;
use crate::text::file_error::WriteError;

/// Samples that are written: so many files a folder still bears.
const FILES: usize = 2_000;

const POINT: u8 = 1;
const LINE: u8 = 3;
const TRIANGLE: u8 = 5;
const TETRAHEDRON: u8 = 10;
const QUADRATIC_LINE: u8 = 21;
const QUADRATIC_TRIANGLE: u8 = 22;
const QUADRATIC_TETRAHEDRON: u8 = 24;

/// Cells of a sample: their points one after the other, where each ends, what it is.
#[derive(Clone, Default)]
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

    /// The elements of solids, in their order, or of heat.
    fn elements(scene: &Scene) -> Self {
        let mut cells = Cells::default();
        for solid in &scene.solids {
            cells.add_simplices(&solid.simplices, &solid.middles);
        }
        if let Some(heat) = &scene.heat {
            cells.add_simplices(&heat.simplices, &Middles::new());
        }
        cells
    }

    fn add_simplices(&mut self, simplices: &Simplices, middles: &Middles) {
        match (simplices, middles.is_empty()) {
            (Simplices::Segments(all), true) => self.add_all(LINE, all),
            (Simplices::Triangles(all), true) => self.add_all(TRIANGLE, all),
            (Simplices::Tetrahedra(all), true) => self.add_all(TETRAHEDRON, all),
            (Simplices::Segments(all), false) => {
                self.add_curved::<2, 3>(QUADRATIC_LINE, all, middles);
            }
            (Simplices::Triangles(all), false) => {
                self.add_curved::<3, 6>(QUADRATIC_TRIANGLE, all, middles);
            }
            (Simplices::Tetrahedra(all), false) => {
                self.add_curved::<4, 10>(QUADRATIC_TETRAHEDRON, all, middles);
            }
        }
    }

    /// Elements with nodes in the middle of their edges, which VTK numbers alike.
    fn add_curved<const K: usize, const N: usize>(
        &mut self,
        shape: u8,
        simplices: &[[usize; K]],
        middles: &Middles,
    ) where
        [usize; K]: Simplex,
    {
        self.add_all::<N>(shape, &with_middles(simplices, middles));
    }

    fn add_all<const N: usize>(&mut self, shape: u8, elements: &[[usize; N]]) {
        elements.iter().for_each(|nodes| self.add(shape, ELEMENT, nodes));
    }

    fn append(&mut self, others: &Cells) {
        let before = self.connectivity.len();
        self.connectivity.extend(&others.connectivity);
        self.offsets.extend(others.offsets.iter().map(|offset| before + offset));
        self.types.extend(&others.types);
        self.kinds.extend(&others.kinds);
    }

    /// All cells of a sample, the elements last.
    fn of(run: &Run, sample: usize, surfaces: &Surfaces, elements: &Cells) -> Self {
        let (scene, mut cells) = (&run.scene, Cells::default());
        (0..scene.particles.len()).for_each(|particle| cells.add(POINT, 0, &[particle]));
        scene.links.iter().for_each(|link| cells.add(LINE, 1, &link.ends));
        run.rods_at(sample).for_each(|ends| cells.add(LINE, 2, &ends));
        let faces = if elements.types.is_empty() {
            scene.edges.iter().for_each(|ends| cells.add(LINE, 3, ends));
            scene.surface()
        } else {
            scene.cells()
        };
        faces.iter().for_each(|face| cells.add(TRIANGLE, 4, &face.corners));
        let mut first = scene.particles.len();
        for BodySurface { points, triangles, lines } in surfaces.0.iter().map(|(.., s)| s) {
            let on = |corner: usize| first + corner;
            lines.iter().for_each(|ends| cells.add(LINE, 3, &ends.map(on)));
            triangles.iter().for_each(|corners| cells.add(TRIANGLE, 4, &corners.map(on)));
            first += points.len();
        }
        cells.append(elements);
        cells
    }
}

/// The surfaces of bodies that none of their points show, each with its body and the particle at its centre:
/// their points come after the scene's.
struct Surfaces(Vec<(usize, usize, BodySurface)>);

impl Surfaces {
    fn of(run: &Run) -> Self {
        let joined = |(body, centre, all)| (body, centre, BodySurface::joined(all));
        Surfaces(run.surfaces().map(joined).collect())
    }

    /// The body, its centre and the place in its axes of each point.
    fn points(&self) -> impl Iterator<Item = (usize, usize, [f64; 3])> + '_ {
        self.0.iter().flat_map(|(body, centre, surface)| {
            surface.points.iter().map(move |&point| (*body, *centre, point))
        })
    }
}

/// The kind of a cell that is an element.
const ELEMENT: u8 = 5;

/// Writes `trajectory.pvd` and the folder `trajectory`, which must not be there yet or be one of
/// these.
pub(crate) fn write(run: &Run, folder: &Path) -> Result<(), WriteError> {
    let series = folder.join("trajectory");
    fs::create_dir_all(&series).map_err(|source| WriteError { path: series.clone(), source })?;
    let samples = thinned(run.times().len(), FILES);
    let name = |sample: usize| format!("{sample:06}.vtu");
    let (surfaces, elements) = (Surfaces::of(run), Cells::elements(&run.scene));
    let stress = match run.scene.solids.is_empty() {
        true => None,
        false => Some(run.stress_to(&series)?),
    };
    for &sample in &samples {
        let cells = Cells::of(run, sample, &surfaces, &elements);
        let write = |out: &mut _| grid(run, sample, (&surfaces, &cells), stress.as_ref(), out);
        write_file(&series.join(name(sample)), write)?;
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

fn grid(
    run: &Run,
    sample: usize,
    (surfaces, cells): (&Surfaces, &Cells),
    stress: Option<&StressField>,
    out: &mut impl Write,
) -> io::Result<()> {
    let particles = run.scene.particles.len();
    let count = particles + surfaces.points().count();
    let pinned = run.scene.particles.iter().map(|p| u8::from(p.motion == Motion::Pinned));
    let pinned = pinned.chain(surfaces.points().map(|_| 0));
    let fields = run.bodies(sample);
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    let kind = "type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"";
    writeln!(out, "<VTKFile {kind}>\n<UnstructuredGrid>")?;
    let size = cells.offsets.len();
    writeln!(out, "<Piece NumberOfPoints=\"{count}\" NumberOfCells=\"{size}\">")?;
    let places = (0..particles).flat_map(|particle| run.position(sample, particle));
    let places = places.chain(
        surfaces
            .points()
            .flat_map(|(body, centre, point)| run.placed(sample, centre, &fields[body], point)),
    );
    writeln!(out, "<Points>")?;
    array(out, "Float64", "points", 3, places.map(|x| format!("{x:?}")))?;
    writeln!(out, "</Points>\n<Cells>")?;
    array(out, "Int64", "connectivity", 1, cells.connectivity.iter())?;
    array(out, "Int64", "offsets", 1, cells.offsets.iter())?;
    array(out, "UInt8", "types", 1, cells.types.iter())?;
    writeln!(out, "</Cells>\n<PointData>")?;
    let of = (0..particles).chain(surfaces.points().map(|(_, centre, _)| centre));
    array(out, "Int64", "particle", 1, of)?;
    array(out, "UInt8", "pinned", 1, pinned)?;
    point_fields(run, sample, surfaces, out)?;
    writeln!(out, "</PointData>\n<CellData>")?;
    array(out, "UInt8", "kind", 1, cells.kinds.iter())?;
    if let Some(stress) = stress {
        let all = stress(run.positions(sample));
        let none = std::iter::repeat_n([0.0; 6], size - all.len().min(size));
        numbers(out, "stress", none.chain(all))?;
    }
    writeln!(out, "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")
}

/// What the scene has of each point besides its place.
fn point_fields(
    run: &Run,
    sample: usize,
    surfaces: &Surfaces,
    out: &mut impl Write,
) -> io::Result<()> {
    let scene = &run.scene;
    if scene.heat.is_some() {
        let temperatures = run.temperatures(sample).iter().map(|&temperature| [temperature]);
        return numbers(out, "temperature", temperatures);
    }
    let bodies = run.bodies(sample);
    let beside = surfaces.points().map(|(body, _, point)| bodies[body].velocity_of(point));
    numbers(out, "velocity", run.velocities(sample).into_iter().chain(beside))?;
    if !scene.solids.is_empty() {
        numbers(out, "displacement", run.displacements(sample))?;
    }
    if !bodies.is_empty() {
        let carried = || {
            let particles = scene.particles.iter().map(|particle| match particle.motion {
                Motion::Carried { body, .. } => bodies[body],
                _ => BodyField::AT_REST,
            });
            particles.chain(surfaces.points().map(|(body, ..)| bodies[body]))
        };
        numbers(out, "orientation", carried().map(|body| body.orientation))?;
        numbers(out, "angular_velocity", carried().map(|body| body.angular_velocity))?;
    }
    if scene.has_impulses() {
        let none = surfaces.points().map(|_| [0.0; 3]);
        numbers(out, "contact_impulse", run.impulses_on(sample).into_iter().chain(none))?;
    }
    Ok(())
}

/// An array of vectors with every digit.
fn numbers<const N: usize>(
    out: &mut impl Write,
    name: &str,
    vectors: impl IntoIterator<Item = [f64; N]>,
) -> io::Result<()> {
    array(out, "Float64", name, N, vectors.into_iter().flatten().map(|x| format!("{x:?}")))
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
