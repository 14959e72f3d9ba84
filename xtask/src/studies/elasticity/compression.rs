//! Where Saint Venant-Kirchhoff gives way under pressure, beside materials that do not.

use stationary_calculus::{SparseCholesky, SymmetricMatrix};
use stationary_chart::{Axis, Lines, Series};
use stationary_elasticity::{
    ElasticityError, FixedCorotated, Freedoms, Held, Lame, LinearSegment, Material, NeoHookean,
    SaintVenantKirchhoff, Solid,
};
use stationary_measure::{Column, Table};
use stationary_mesh::bar;

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Stress against stretch, and the stretch at which a bar becomes unstable.
pub const STUDY: Entry<'static> = Entry {
    id: "compression",
    krate: "elasticity",
    chapter: "13.1",
    kind: Kind::Limit,
    title: "Pressed column: force against stretch, of three materials",
    tested: Tested::Claims,
    run: &study,
};

fn failed() -> impl FnOnce(ElasticityError) -> StudyError {
    StudyError::at("the bar")
}

/// Whether a bar of 20 elements, held at both ends and pressed evenly, is stable: its Hessian has a
/// Cholesky factor.
fn stable(lame: Lame<3>, stretch: f64) -> Result<bool, StudyError> {
    let mesh = bar(1.0, 20).map_err(StudyError::at("a line"))?;
    let ends =
        [(0, 0.0), (20, stretch)].map(|(vertex, place)| Held { vertex, component: 0, place });
    let freedoms = Freedoms::<1>::new(21, &ends).map_err(failed())?;
    let rubber = SaintVenantKirchhoff::new(lame.uniaxial_stress());
    let solid = Solid::new(LinearSegment, &mesh, 1.0, rubber, freedoms).map_err(failed())?;
    let q: Vec<f64> = (1..20).map(|i| stretch * f64::from(i) / 20.0).collect();
    let hessian = SymmetricMatrix::hessian(&solid, &q).map_err(StudyError::at("the Hessian"))?;
    let mut factor = SparseCholesky::analyse(&hessian).map_err(StudyError::at("the factor"))?;
    Ok(factor.factor(&hessian).is_ok())
}

/// The largest stretch below one at which the bar is not stable, by bisection.
fn critical(lame: Lame<3>) -> Result<f64, StudyError> {
    let (mut low, mut high) = (0.1, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if stable(lame, middle)? {
            high = middle;
        } else {
            low = middle;
        }
    }
    Ok(0.5 * (low + high))
}

fn study(_: Size) -> Result<Study, StudyError> {
    let lame = Lame::<3>::from_young_poisson(1.0, 0.3).map_err(failed())?;
    let corotated = FixedCorotated::new(lame).map_err(failed())?;
    let rubber = NeoHookean::new(lame).map_err(failed())?;
    let hookean = SaintVenantKirchhoff::new(lame);
    let column = |s: f64| [[s, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let stresses = |s: f64| {
        let f = column(s);
        [hookean.stress(&f)[0][0], rubber.stress(&f)[0][0], corotated.stress(&f)[0][0]]
    };
    let names = ["Saint Venant-Kirchhoff", "neo-Hookean", "fixed corotated"];
    let mut table = Table::new([
        Column::rounded("stretch", 3, 0.0),
        Column::rounded(names[0], 4, 1e-14),
        Column::rounded(names[1], 4, 1e-14),
        Column::rounded(names[2], 4, 1e-14),
    ]);
    let mut curves = [Vec::new(), Vec::new(), Vec::new()];
    let mut falling = [0_u32; 3];
    for k in 0..=60 {
        let s = 1.2 - 0.02 * f64::from(k);
        let (here, below) = (stresses(s), stresses(s - 0.02));
        for m in 0..3 {
            curves[m].push((s, here[m]));
            falling[m] += u32::from(below[m] > here[m]);
        }
        if k % 5 == 0 {
            table.push([s.into(), here[0].into(), here[1].into(), here[2].into()]);
        }
    }
    let mut chart = Lines::new(
        "",
        Axis::linear("stretch, sides held", ""),
        Axis::linear("nominal stress / Young's modulus", ""),
    );
    for (name, curve) in names.iter().zip(curves) {
        chart = chart.with(Series::new(name, curve));
    }
    let predicted = 1.0 / 3.0_f64.sqrt();
    let measured = critical(lame)?;
    Ok(Study {
        conclusion: format!(
            "The force on a column against its stretch. Saint Venant-Kirchhoff resists ever more up to \
             the stretch 1/sqrt 3 = 0.577 and ever less beyond: at stretch zero nothing resists, and an \
             element turns inside out for free. A bar of twenty elements loses its stability at {measured:.4}. \
             The other two push back all the way down and beyond."
        ),
        table,
        charts: vec![chart.into()],
        claims: vec![
            Claim::number(
                "the stretch at which a pressed bar is no longer stable",
                "1/sqrt 3 = 0.57735",
                measured,
                (predicted - 1e-6, predicted + 1e-6),
            ),
            Claim::words(
                "the pressure, as the column is shortened from 1.2 to 0 of its length",
                "falls in the end, never falls, never falls",
                falling
                    .map(|count| if count > 0 { "falls in the end" } else { "never falls" })
                    .join(", "),
            ),
        ],
        ..STUDY.heading()
    })
}
