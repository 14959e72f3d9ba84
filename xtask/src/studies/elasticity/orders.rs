//! Errors of elements against the size of the mesh, where the answer is known.

use stationary_chart::{Axis, Lines, Series};
use stationary_elasticity::problems::{Errors, PlaneWaves, manufactured_errors};
use stationary_elasticity::{
    Lame, LinearSegment, LinearTetrahedron, LinearTriangle, QuadraticSegment, QuadraticTetrahedron,
    QuadraticTriangle,
};
use stationary_measure::{Column, Table, loglog_slope};
use stationary_mesh::{
    Diagonals, QuadraticSegments, QuadraticTetrahedra, QuadraticTriangles, bar, cuboid, rectangle,
};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Orders of convergence in one, two and three dimensions.
pub const STUDY: Entry<'static> = Entry {
    id: "element-orders",
    krate: "elasticity",
    chapter: "13.2",
    kind: Kind::Convergence,
    title: "Elements in one, two and three dimensions: error against the size of cells",
    tested: Tested::ByReport,
    run: &study,
};

const LINE: PlaneWaves<1> = PlaneWaves { amplitude: 0.1, waves: [[5.0]] };
const PLANE: PlaneWaves<2> = PlaneWaves { amplitude: 0.1, waves: [[3.0, 2.0], [-1.5, 2.5]] };
const SPACE: PlaneWaves<3> =
    PlaneWaves { amplitude: 0.1, waves: [[3.0, 2.0, 1.0], [-1.5, 2.5, 1.0], [1.0, -2.0, 2.0]] };

/// A family on meshes of some numbers of cells a side.
struct Family {
    name: &'static str,
    cells: &'static [usize],
    errors: fn(usize) -> Result<Errors, StudyError>,
    /// The order of the displacement; the strain has one less.
    order: f64,
}

fn lame() -> Result<Lame<3>, StudyError> {
    Lame::from_young_poisson(1.0, 0.3).map_err(StudyError::at("the material"))
}

const FAMILIES: [Family; 6] = [
    Family {
        name: "linear segments",
        cells: &[8, 16, 32, 64],
        errors: |n| {
            let mesh = bar(1.0, n).map_err(StudyError::at("a line"))?;
            let lame = lame()?.uniaxial_stress();
            manufactured_errors(LinearSegment, &mesh, lame, &LINE)
                .map_err(StudyError::at("linear segments"))
        },
        order: 2.0,
    },
    Family {
        name: "quadratic segments",
        cells: &[8, 16, 32, 64],
        errors: |n| {
            let mesh = QuadraticSegments::straight(&bar(1.0, n).map_err(StudyError::at("a line"))?);
            let lame = lame()?.uniaxial_stress();
            manufactured_errors(QuadraticSegment, &mesh, lame, &LINE)
                .map_err(StudyError::at("quadratic segments"))
        },
        order: 3.0,
    },
    Family {
        name: "linear triangles",
        cells: &[8, 16, 32, 48],
        errors: |n| {
            let mesh = rectangle([1.0, 1.0], [n, n], Diagonals::Alternating)
                .map_err(StudyError::at("a square"))?;
            manufactured_errors(LinearTriangle, &mesh, lame()?.plane_stress(), &PLANE)
                .map_err(StudyError::at("linear triangles"))
        },
        order: 2.0,
    },
    Family {
        name: "quadratic triangles",
        cells: &[4, 8, 16, 24],
        errors: |n| {
            let mesh = rectangle([1.0, 1.0], [n, n], Diagonals::Alternating)
                .map_err(StudyError::at("a square"))?;
            let mesh = QuadraticTriangles::straight(&mesh);
            manufactured_errors(QuadraticTriangle, &mesh, lame()?.plane_stress(), &PLANE)
                .map_err(StudyError::at("quadratic triangles"))
        },
        order: 3.0,
    },
    Family {
        name: "linear tetrahedra",
        cells: &[4, 6, 9, 12],
        errors: |n| {
            let mesh = cuboid([1.0; 3], [n; 3]).map_err(StudyError::at("a cube"))?;
            manufactured_errors(LinearTetrahedron, &mesh, lame()?, &SPACE)
                .map_err(StudyError::at("linear tetrahedra"))
        },
        order: 2.0,
    },
    Family {
        name: "quadratic tetrahedra",
        cells: &[2, 3, 4, 6],
        errors: |n| {
            let mesh = cuboid([1.0; 3], [n; 3]).map_err(StudyError::at("a cube"))?;
            let mesh = QuadraticTetrahedra::straight(&mesh);
            manufactured_errors(QuadraticTetrahedron, &mesh, lame()?, &SPACE)
                .map_err(StudyError::at("quadratic tetrahedra"))
        },
        order: 3.0,
    },
];

fn study(_: Size) -> Result<Study, StudyError> {
    let mut table = Table::new([
        Column::exact("element"),
        Column::exact("cells a side"),
        Column::exact("freedoms"),
        Column::rounded("displacement", 3, 1e-13),
        Column::rounded("strain", 3, 1e-13),
    ]);
    let axes = |what: &str| {
        let error = Axis::log(&format!("relative error of the {what}"), "");
        Lines::new(what, Axis::log("size of a cell", ""), error)
    };
    let (mut displacements, mut strains) = (axes("displacement"), axes("strain"));
    let mut claims = Vec::new();
    for family in FAMILIES {
        let mut points = [Vec::new(), Vec::new()];
        for &n in family.cells {
            let errors = (family.errors)(n)?;
            table.push([
                family.name.into(),
                (n as u64).into(),
                (errors.freedoms as u64).into(),
                errors.displacement.into(),
                errors.energy.into(),
            ]);
            points[0].push((1.0 / n as f64, errors.displacement));
            points[1].push((1.0 / n as f64, errors.energy));
        }
        // The coarsest meshes see less than a wave.
        let order = |points: &[(f64, f64)]| loglog_slope(&points[1..]).unwrap_or(f64::NAN);
        for (what, measured, order, band) in [
            ("displacement", order(&points[0]), family.order, 0.25),
            ("strain", order(&points[1]), family.order - 1.0, 0.15),
        ] {
            claims.push(Claim::number(
                format!("{}: the order of the {what}", family.name),
                format!("{order}"),
                measured,
                (order - band, order + band),
            ));
        }
        let [displacement, strain] = points;
        displacements = displacements.with(Series::new(family.name, displacement));
        strains = strains.with(Series::new(family.name, strain));
    }
    Ok(Study {
        conclusion: "A displacement in waves is chosen, the load that makes it the answer follows, and \
                     elements look for it. Halving the cells of linear elements divides the error of the \
                     displacement by four and that of the strain by two; of quadratic ones by eight and \
                     four. The notes' \"order one\" counts triangles, which in the plane is the square of \
                     the size."
            .into(),
        table,
        charts: vec![
            displacements.slope(2.0, (0.05, 2e-2)).slope(3.0, (0.05, 2e-4)).into(),
            strains.slope(1.0, (0.05, 0.2)).slope(2.0, (0.05, 4e-3)).into(),
        ],
        claims,
        ..STUDY.heading()
    })
}
