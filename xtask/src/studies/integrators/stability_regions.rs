//! Where in the complex plane a method keeps decay bounded: measured, over the borders of theory.
//!
//! ```text
//! y' = lambda y,      y_(n+1) = R(h lambda) y_n,      survives where |R| <= 1
//! ```
//! The measured runs take steps of y' = lambda y in two real components. The borders are closed
//! forms for Radau and root loci for the multistep formulas; that of the explicit method comes from
//! its Taylor polynomial to order 8 and the growth of a single step.

use nalgebra::Complex;
use stationary_chart::{Axis, Map};
use stationary_integrators::{
    AdaptiveError, AdaptiveMethod, BackwardDifferences, DormandPrince853, Jacobian, Moment,
    RadauIia5, StepControl, Tolerance, VectorField,
};
use stationary_measure::{Column, Table};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// The methods for first-order systems.
pub const REGIONS: Entry<'static> = Entry {
    id: "stability-regions",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::StabilityMap,
    title: "Linear equations: for which products of step and eigenvalue a method stays bounded",
    tested: Tested::Claims,
    run: &run,
};

const SURVIVES: &str = "stays bounded";
const BLOWS_UP: &str = "blows up";

/// Steps taken: enough for a growth of 5 % a step to show.
const STEPS: i32 = 100;
/// Steps before those, in which a multistep method finds its order.
const START: i32 = 25;
/// A motion that has grown by this factor has blown up.
const GROWN: f64 = 10.0;

/// y' = lambda y as two real components.
struct Spiral(Complex<f64>);

impl VectorField for Spiral {
    fn dim(&self) -> usize {
        2
    }

    fn evaluate(&self, _t: f64, y: &[f64], f: &mut [f64]) {
        let Complex { re, im } = self.0;
        f.copy_from_slice(&[re * y[0] - im * y[1], im * y[0] + re * y[1]]);
    }

    fn jacobian(&self, _t: f64, _y: &[f64], df: &mut [f64]) -> Jacobian {
        let Complex { re, im } = self.0;
        df.copy_from_slice(&[re, im, -im, re]);
        Jacobian::Written
    }
}

/// A method whose region is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drawn {
    DormandPrince,
    Radau,
    Bdf(usize),
}

impl Drawn {
    fn on(self, field: &Spiral) -> Result<Box<dyn AdaptiveMethod<[f64; 2]> + '_>, AdaptiveError> {
        // Stages of linear problems are solved in an iteration or two at any tolerance.
        let control = Tolerance::new(1e-8, 1e-12).map(StepControl::from);
        let control = control.and_then(|control| control.constant_step(1.0));
        let control = control.map_err(|_| AdaptiveError::Saved("no step of 1"))?;
        let start = Moment::new(0.0, [1.0, 0.0]);
        Ok(match self {
            Drawn::DormandPrince => Box::new(DormandPrince853::new(field, control, start)?),
            Drawn::Radau => Box::new(RadauIia5::new(field, control, start)?),
            Drawn::Bdf(highest) => {
                Box::new(BackwardDifferences::of_order_at_most(highest, field, control, start)?)
            }
        })
    }

    /// The part of the plane that is drawn: real and imaginary parts from, to.
    fn frame(self) -> [(f64, f64); 2] {
        match self {
            Drawn::DormandPrince => [(-7.0, 2.0), (0.0, 7.5)],
            Drawn::Radau => [(-4.0, 12.0), (0.0, 10.0)],
            Drawn::Bdf(2) => [(-3.0, 6.0), (0.0, 5.0)],
            Drawn::Bdf(_) => [(-8.0, 16.0), (0.0, 14.0)],
        }
    }

    /// The factor by which a step multiplies the motion in the long run.
    fn growth(self, z: Complex<f64>) -> f64 {
        match self {
            Drawn::DormandPrince => dormand_prince_growth(z),
            Drawn::Radau => {
                let numerator = z * (z / 20.0 + 0.4) + 1.0;
                let denominator = z * (z * (-z / 60.0 + 0.15) - 0.6) + 1.0;
                (numerator / denominator).norm()
            }
            Drawn::Bdf(k) => largest_root(k, z),
        }
    }
}

/// The growth in one step of the explicit method, beyond what its order fixes.
pub(super) fn dormand_prince_growth(z: Complex<f64>) -> f64 {
    let field = Spiral(z);
    let Ok(mut method) = Drawn::DormandPrince.on(&field) else { return f64::NAN };
    match method.step(1.0) {
        Ok(()) => method.moment().y[0].hypot(method.moment().y[1]),
        Err(_) => f64::NAN,
    }
}

/// sum_{m=1..k} 1/m (1 - w)^m as coefficients of w, lowest first.
fn formula(k: usize) -> Vec<f64> {
    let (mut sum, mut power) = (vec![0.0; k + 1], vec![1.0]);
    for m in 1..=k {
        let mut next = vec![0.0; m + 1];
        for (i, c) in power.iter().enumerate() {
            next[i] += c;
            next[i + 1] -= c;
        }
        power = next;
        for (sum, c) in sum.iter_mut().zip(&power) {
            *sum += c / m as f64;
        }
    }
    sum
}

/// The largest root zeta of the formula with w = 1/zeta, by simultaneous iteration.
fn largest_root(k: usize, z: Complex<f64>) -> f64 {
    let coefficients = formula(k);
    let leading = Complex::from(coefficients[0]) - z;
    let value = |zeta: Complex<f64>| {
        let tail = coefficients[1..].iter();
        tail.fold(Complex::from(1.0), |value, c| value * zeta + *c / leading)
    };
    let mut roots: Vec<Complex<f64>> =
        (0..k).map(|i| Complex::new(0.4, 0.9).powi(i as i32)).collect();
    for _ in 0..200 {
        for i in 0..k {
            let others = (0..k).filter(|&j| j != i).map(|j| roots[i] - roots[j]);
            let product = others.fold(Complex::from(1.0), |product, d| product * d);
            let change = value(roots[i]) / product;
            roots[i] -= change;
        }
    }
    roots.iter().map(|root| root.norm()).fold(0.0, f64::max)
}

/// The border: a root locus where there is one, else the first change of stability along rays.
fn border(drawn: Drawn) -> Vec<(f64, f64)> {
    let [(left, right), (_, top)] = drawn.frame();
    let angles = (0..=180).map(|degree| f64::from(degree).to_radians());
    let points: Vec<(f64, f64)> = match drawn {
        Drawn::Bdf(k) => {
            let locus = |angle: f64| {
                let w = Complex::from_polar(1.0, -angle);
                let z = formula(k).iter().rev().fold(Complex::from(0.0), |z, c| z * w + *c);
                (z.re, z.im)
            };
            angles.map(locus).collect()
        }
        Drawn::DormandPrince => angles.filter_map(|a| along_ray(drawn, -2.5, a)).collect(),
        Drawn::Radau => angles.filter_map(|a| along_ray(drawn, 4.5, a)).collect(),
    };
    let inside = |&(x, y): &(f64, f64)| x >= left && x <= right && y >= 0.0 && y <= top;
    points.into_iter().filter(inside).collect()
}

/// The first point on a ray from the real axis where stability changes.
fn along_ray(drawn: Drawn, from: f64, angle: f64) -> Option<(f64, f64)> {
    let at = |r: f64| Complex::from(from) + Complex::from_polar(r, angle);
    let stable = |r: f64| drawn.growth(at(r)) <= 1.0;
    let (start, mut r) = (stable(0.01), 0.01);
    while stable(r) == start {
        r += 0.05;
        if r > 20.0 {
            return None;
        }
    }
    let (mut low, mut high) = (r - 0.05, r);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if stable(middle) == start { low = middle } else { high = middle }
    }
    Some((at(high).re, at(high).im))
}

/// By how much the motion grows in many steps of y' = z y, once the start is forgotten.
fn measured(drawn: Drawn, z: Complex<f64>) -> Result<f64, StudyError> {
    let field = Spiral(z);
    let mut method = drawn.on(&field).map_err(StudyError::at("y' = lambda y"))?;
    let (mut start, mut size) = (0.0, 1.0);
    for step in 0..START + STEPS {
        if step == START {
            start = size;
        }
        if size > 1e6 || method.step(f64::from(START + STEPS)).is_err() {
            return Ok(f64::INFINITY);
        }
        let [x, y] = method.moment().y;
        size = x.hypot(y);
    }
    // What has died out, to the last bit perhaps, does not grow.
    Ok(if size < f64::MIN_POSITIVE { 0.0 } else { size / start })
}

fn run(size: Size) -> Result<Study, StudyError> {
    let count = match size {
        Size::Default => 30,
        Size::Full => 80,
    };
    let mut table = Table::new([
        Column::exact("method"),
        Column::rounded("Re h lambda", 3, 1e-9),
        Column::rounded("Im h lambda", 3, 1e-9),
        Column::exact("outcome"),
    ]);
    let (mut charts, mut claims) = (Vec::new(), Vec::new());
    for drawn in [Drawn::DormandPrince, Drawn::Radau, Drawn::Bdf(2), Drawn::Bdf(5)] {
        let field = Spiral(Complex::new(-1.0, 0.0));
        let facts = drawn.on(&field).map_err(StudyError::at("y' = lambda y"))?.facts();
        let axes = (Axis::linear("Re h λ", ""), Axis::linear("Im h λ", ""));
        let mut map = Map::new(facts.name, axes.0, axes.1, [SURVIVES, BLOWS_UP]);
        let (mut agree, mut cells, mut lost) = (0_u32, 0_u32, 0_u32);
        let [(left, right), (bottom, top)] = drawn.frame();
        for row in 0..count {
            let im = bottom + (top - bottom) * (f64::from(row) + 0.5) / f64::from(count);
            for column in 0..count {
                let re = left + (right - left) * (f64::from(column) + 0.5) / f64::from(count);
                let z = Complex::new(re, im);
                let outcome = if measured(drawn, z)? < GROWN { SURVIVES } else { BLOWS_UP };
                map.cell(re, im, outcome);
                table.push([facts.name.into(), re.into(), im.into(), outcome.into()]);
                let growth = drawn.growth(z);
                // Nearer to 1 the growth does not show, or the start does.
                if (growth - 1.0).abs() > 0.05 {
                    cells += 1;
                    agree += u32::from((growth < 1.0) == (outcome == SURVIVES));
                }
                let angle = im.atan2(-re).to_degrees();
                lost += u32::from(angle < facts.sector && outcome == BLOWS_UP);
            }
        }
        claims.push(Claim::number(
            format!("part of the map on which {} does as predicted", facts.name),
            "1",
            f64::from(agree) / f64::from(cells),
            (1.0, 1.0),
        ));
        claims.push(Claim::number(
            format!("cells that {} loses within {}° of decay", facts.name, facts.sector),
            "none",
            f64::from(lost),
            (0.0, 0.0),
        ));
        charts.push(map.border("|R| = 1", border(drawn)).into());
    }
    Ok(Study {
        conclusion: format!(
            "y' = λ y, {STEPS} steps of h, the upper half of the plane of h λ (the lower is its mirror \
             image). The explicit method keeps bounded what decays at a rate of up to about six a \
             step; beyond, its step is bounded by stability. Radau IIA and BDF of order 2 keep all of \
             the left half plane, and much of the right one, where the truth grows and they decay: a \
             large step hides an instability. BDF of order 5 loses a lens along the imaginary axis, \
             which is why motion that oscillates wants order 2 or Radau."
        ),
        table,
        charts,
        claims,
        ..REGIONS.heading()
    })
}
