//! What thin triangles do to the error and to the condition of the equations.

use stationary_calculus::{Potential, SparseCholesky, SymmetricMatrix};
use stationary_chart::{Axis, Lines, Series};
use stationary_elasticity::{
    DeadLoad, ElasticityError, Elements, Freedoms, Held, Lame, Linear, LinearTriangle, Solid,
    Statics, lumped_mass,
};
use stationary_measure::{Column, SplitMix64, Table};
use stationary_mesh::{Mesh, MeshError, Quality};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Error and condition against how thin the triangles are.
pub const STUDY: Entry<'static> = Entry {
    id: "slivers",
    krate: "elasticity",
    chapter: "13.2",
    kind: Kind::Limit,
    title: "Narrow and flat triangles: error and condition against the angle",
    tested: Tested::Claims,
    run: &study,
};

/// Triangles along a side of the unit square.
const ACROSS: usize = 12;

/// Which thin triangles.
#[derive(Clone, Copy, PartialEq)]
enum Thin {
    /// With a right angle: one small angle, none large.
    Narrow,
    /// With the apex above the middle of the base: one angle close to 180 degrees.
    Flat,
}

/// The unit square in rows of triangles, `thinness` times as many of them as fit regular ones.
fn square(thin: Thin, thinness: usize) -> Result<Mesh<2, 3>, MeshError> {
    let rows = ACROSS * thinness;
    let (mut vertices, mut triangles, mut starts) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..=rows {
        let y = row as f64 / rows as f64;
        let shifted = thin == Thin::Flat && row % 2 == 1;
        starts.push(vertices.len());
        let mut places: Vec<f64> = (0..=ACROSS).map(|i| i as f64 / ACROSS as f64).collect();
        if shifted {
            let half = 0.5 / ACROSS as f64;
            places = places[..ACROSS].iter().map(|x| x + half).collect();
            places.insert(0, 0.0);
            places.push(1.0);
        }
        vertices.extend(places.into_iter().map(|x| nalgebra::vector![x, y]));
    }
    starts.push(vertices.len());
    for row in 0..rows {
        // Two rows, from left to right: the lower or the upper one goes on, whichever is behind.
        let (mut low, mut high) = (starts[row], starts[row + 1]);
        let (low_end, high_end) = (starts[row + 1] - 1, starts[row + 2] - 1);
        while low < low_end || high < high_end {
            let next = |at: usize, end: usize| {
                if at < end { vertices[at + 1].x } else { f64::INFINITY }
            };
            if next(low, low_end) <= next(high, high_end) {
                triangles.push([low, low + 1, high]);
                low += 1;
            } else {
                triangles.push([low, high + 1, high]);
                high += 1;
            }
        }
    }
    Mesh::new(vertices, triangles)
}

/// What was measured on one mesh.
struct Measured {
    smallest: f64,
    largest: f64,
    error: f64,
    condition: f64,
}

/// The square, its rim held where u = (x^2, 0) puts it, under the load that goes with it.
fn measured(mesh: &Mesh<2, 3>, lame: Lame<2>) -> Result<Measured, ElasticityError> {
    let rim = |x: f64| x == 0.0 || x == 1.0;
    let mut held = Vec::new();
    for (vertex, x) in mesh.vertices().iter().enumerate().filter(|(_, x)| rim(x.x) || rim(x.y)) {
        held.push(Held { vertex, component: 0, place: x.x + x.x * x.x });
        held.push(Held { vertex, component: 1, place: x.y });
    }
    let freedoms = Freedoms::<2>::new(mesh.vertices().len(), &held)?;
    let metric = lumped_mass(LinearTriangle, mesh, [1.0, 1.0], &freedoms)?;
    let mut solid = Solid::new(LinearTriangle, mesh, 1.0, Linear::new(lame), freedoms.clone())?;
    // div sigma = 2 (lambda + 2 mu) along x.
    let push = -2.0 * (lame.lambda() + 2.0 * lame.mu());
    let load = DeadLoad::body(LinearTriangle, mesh, 1.0, &freedoms, |_| [push, 0.0])?;
    let mut q = freedoms.gathered(&mesh.nodes())?;
    Statics::default().solve(&mut solid, &load, &metric, freedoms.places(), &mut q)?;
    let angles = |quality: Quality| {
        let of = |nodes: &[usize; 3]| quality.of(&nodes.map(|node| mesh.vertices()[node]));
        mesh.simplices().iter().map(of).collect::<Vec<f64>>()
    };
    Ok(Measured {
        smallest: angles(Quality::SmallestAngle).into_iter().fold(f64::INFINITY, f64::min),
        largest: angles(Quality::LargestAngle).into_iter().fold(0.0, f64::max),
        error: gradient_error(mesh, &freedoms.positions(&q)?),
        condition: condition(&solid, &q)?,
    })
}

/// The root of the mean square of the gradient's error, over that of the gradient itself.
fn gradient_error(mesh: &Mesh<2, 3>, positions: &[[f64; 2]]) -> f64 {
    let (mut error, mut size) = (0.0, 0.0);
    for nodes in mesh.simplices() {
        let [a, b, c] = nodes.map(|node| mesh.vertices()[node]);
        let u = nodes.map(|node| positions[node][0] - mesh.vertices()[node].x);
        let v = nodes.map(|node| positions[node][1] - mesh.vertices()[node].y);
        let (p, r) = (b - a, c - a);
        let area = p.x * r.y - p.y * r.x;
        let slope = |w: [f64; 3]| {
            let (s, t) = (w[1] - w[0], w[2] - w[0]);
            [(s * r.y - t * p.y) / area, (t * p.x - s * r.x) / area]
        };
        let (of_u, of_v) = (slope(u), slope(v));
        // The middles of the edges integrate squares of linear functions exactly.
        for x in [a.x + b.x, b.x + c.x, c.x + a.x] {
            let off = (of_u[0] - x).powi(2) + of_u[1].powi(2) + of_v[0].powi(2) + of_v[1].powi(2);
            error += area / 6.0 * off;
            size += area / 6.0 * x * x;
        }
    }
    (error / size).sqrt()
}

/// The largest eigenvalue of the Hessian over its smallest, by power iteration on both it and its
/// inverse.
fn condition(solid: &impl Potential, q: &[f64]) -> Result<f64, ElasticityError> {
    let hessian = SymmetricMatrix::hessian(solid, q)?;
    let mut factor = SparseCholesky::analyse(&hessian)?;
    factor.factor(&hessian)?;
    let largest = growth(q.len(), |x| {
        let mut y = vec![0.0; x.len()];
        hessian.add_product(1.0, x, &mut y)?;
        Ok(y)
    })?;
    let inverse = growth(q.len(), |x| {
        let mut y = x.to_vec();
        factor.solve(&mut y);
        Ok(y)
    })?;
    Ok(largest * inverse)
}

/// By how much a linear map of n freedoms makes a vector longer, in the end.
fn growth<F>(n: usize, mut map: F) -> Result<f64, ElasticityError>
where
    F: FnMut(&[f64]) -> Result<Vec<f64>, ElasticityError>,
{
    let mut random = SplitMix64::new(3);
    let mut x: Vec<f64> = (0..n).map(|_| random.symmetric()).collect();
    let mut growth = 0.0;
    for _ in 0..80 {
        let y = map(&x)?;
        growth = y.iter().map(|y| y * y).sum::<f64>().sqrt();
        x = y.into_iter().map(|y| y / growth).collect();
    }
    Ok(growth)
}

fn study(size: Size) -> Result<Study, StudyError> {
    let finest = if size == Size::Full { 64 } else { 16 };
    let lame = Lame::<3>::from_young_poisson(1.0, 0.3)
        .map_err(StudyError::at("the material"))?
        .plane_strain();
    let mut table = Table::new([
        Column::exact("triangles"),
        Column::rounded("smallest angle [deg]", 3, 0.0),
        Column::rounded("largest angle [deg]", 4, 0.0),
        Column::rounded("error of the gradient", 3, 1e-12),
        Column::rounded("condition", 2, 0.0),
    ]);
    let thin = || Axis::log("base over height of the triangles", "");
    let mut errors = Lines::new("Error", thin(), Axis::log("relative error of the gradient", ""));
    let mut conditions = Lines::new("Condition", thin(), Axis::log("condition", ""));
    let mut ends = Vec::new();
    for (name, thin) in [("narrow: a right angle", Thin::Narrow), ("flat", Thin::Flat)] {
        let (mut error, mut condition) = (Vec::new(), Vec::new());
        let mut k = 1;
        while k <= finest {
            let mesh = square(thin, k).map_err(StudyError::at("a square"))?;
            let m = measured(&mesh, lame).map_err(StudyError::at("the square"))?;
            table.push([
                name.into(),
                m.smallest.to_degrees().into(),
                m.largest.to_degrees().into(),
                m.error.into(),
                m.condition.into(),
            ]);
            error.push((k as f64, m.error));
            condition.push((k as f64, m.condition));
            k *= 2;
        }
        let (first, last) = (error[0], error[error.len() - 1]);
        let growth = condition[condition.len() - 1].1 / condition[condition.len() - 3].1;
        ends.push((last.1 / first.1, growth.log2() / 2.0));
        errors = errors.with(Series::new(name, error));
        conditions = conditions.with(Series::new(name, condition));
    }
    let [narrow, flat] = [ends[0], ends[1]];
    Ok(Study {
        conclusion: format!(
            "A square of linear triangles, {ACROSS} along its lower side and ever more rows of \
             ever thinner ones. Narrow triangles, which keep a right angle, lose nothing: the \
             error changes by a factor of {:.2} while the triangles get {finest} times thinner. \
             Flat ones, whose largest angle goes to 180 degrees, get {:.0} times worse though \
             they are as many and as small: the strain across them is a difference over a \
             vanishing height. The condition of the equations, and with it the cost of iteration \
             and the digits that are left, suffers from both alike. Hence two warnings for a \
             mesh: its smallest angle for the solver, its largest for the answer.",
            narrow.0, flat.0
        ),
        table,
        charts: vec![errors.into(), conditions.slope(2.0, (4.0, 4e3)).into()],
        claims: vec![
            Claim::number(
                "narrow triangles: the error of the thinnest over that of the first",
                "about 1",
                narrow.0,
                (0.5, 1.1),
            ),
            Claim::number(
                "flat triangles: the error of the thinnest over that of the first",
                "more than 3",
                flat.0,
                (3.0, 100.0),
            ),
            Claim::number(
                "narrow triangles: order by which the condition grows",
                "2",
                narrow.1,
                (1.6, 2.2),
            ),
            Claim::number(
                "flat triangles: order by which the condition grows",
                "2",
                flat.1,
                (1.6, 2.2),
            ),
        ],
        ..STUDY.heading()
    })
}
