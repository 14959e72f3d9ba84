//! How fast short waves travel through a mesh, with either mass.

use stationary_calculus::{Metric, Potential, ProductSink, Vector};
use stationary_chart::{Axis, Lines, Series};
use stationary_elasticity::{
    ElasticityError, Freedoms, Held, Lame, LinearSegment, SaintVenantKirchhoff, Solid,
    galerkin_mass, lumped_mass,
};
use stationary_measure::{Column, Table};
use stationary_mesh::bar;

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Speed of waves against their length.
pub const STUDY: Entry<'static> = Entry {
    id: "dispersion",
    krate: "elasticity",
    chapter: "12.2",
    kind: Kind::Convergence,
    title: "Waves on a bar of linear elements: speed against wave number",
    tested: Tested::Claims,
    run: &study,
};

const CELLS: usize = 100;

fn study(_: Size) -> Result<Study, StudyError> {
    let failed = || StudyError::at::<ElasticityError>("the bar");
    let mesh = bar(CELLS as f64, CELLS).map_err(StudyError::at("a line"))?;
    let place = |vertex: usize| Held { vertex, component: 0, place: vertex as f64 };
    let freedoms = Freedoms::<1>::new(CELLS + 1, &[place(0), place(CELLS)]).map_err(failed())?;
    // Young's modulus and density one: long waves travel at one cell a second.
    let lame = Lame::<1>::from_young_poisson(1.0, 0.0).map_err(failed())?;
    let rubber = SaintVenantKirchhoff::new(lame);
    let solid = Solid::new(LinearSegment, &mesh, 1.0, rubber, freedoms.clone()).map_err(failed())?;
    let galerkin = galerkin_mass(LinearSegment, &mesh, [1.0, 1.0], &freedoms).map_err(failed())?;
    let lumped = lumped_mass(LinearSegment, &mesh, [1.0, 1.0], &freedoms).map_err(failed())?;
    let q: Vec<f64> = (1..CELLS).map(|i| i as f64).collect();
    let mut table = Table::new([
        Column::rounded("cells a wave", 3, 0.0),
        Column::rounded("lumped", 6, 0.0),
        Column::rounded("Galerkin", 6, 0.0),
    ]);
    let (mut slow, mut fast) = (Vec::new(), Vec::new());
    let mut worst = 0.0_f64;
    for mode in 1..CELLS {
        let k = std::f64::consts::PI * mode as f64 / CELLS as f64;
        // Sines are modes of the discrete bar too: the quotient is exact.
        let v: Vec<f64> = (1..CELLS).map(|i| (k * i as f64).sin()).collect();
        let mut stiffness = vec![0.0; v.len()];
        if let Some(mut sink) = ProductSink::new(1.0, &v, &mut stiffness) {
            solid.add_hessian(&q, &mut sink);
        }
        let energy: f64 = stiffness.iter().zip(&v).map(|(f, v)| f * v).sum();
        let speed = |mass: f64| (energy / mass).sqrt() / k;
        let speeds = [
            speed(lumped.inner(Vector(&v), Vector(&v))),
            speed(galerkin.inner(Vector(&v), Vector(&v))),
        ];
        let (half, c) = ((0.5 * k).sin() * 2.0 / k, k.cos());
        for (speed, exact) in speeds.iter().zip([half, half * (3.0 / (2.0 + c)).sqrt()]) {
            worst = worst.max((speed / exact - 1.0).abs());
        }
        let cells = 2.0 * std::f64::consts::PI / k;
        if [5, 10, 20, 50, 99].contains(&mode) {
            table.push([cells.into(), speeds[0].into(), speeds[1].into()]);
        }
        slow.push((k / std::f64::consts::PI, speeds[0]));
        fast.push((k / std::f64::consts::PI, speeds[1]));
    }
    let tenth = CELLS / 5 - 1;
    let (lag, lead) = (1.0 - slow[tenth].1, fast[tenth].1 - 1.0);
    let chart = Lines::new(
        "",
        Axis::linear("wave number / that of two cells", ""),
        Axis::linear("speed / speed of long waves", ""),
    );
    Ok(Study {
        conclusion: format!(
            "Waves on a bar of linear elements. With lumped mass they fall behind, with Galerkin's they \
             run ahead, by the same to leading order: at ten cells a wave {:.2} % and {:.2} %. The shortest \
             wave is 36 % too slow with one and 10 % too fast with the other, which is also why \
             Galerkin's mass takes smaller explicit steps, by a factor of sqrt 3.",
            100.0 * lag,
            100.0 * lead
        ),
        table,
        charts: vec![
            chart
                .with(Series::new("lumped", slow.clone()))
                .with(Series::new("Galerkin", fast.clone()))
                .into(),
        ],
        claims: vec![
            Claim::number(
                "the largest gap to the closed forms 2 sin(k/2)/k and that times sqrt(3/(2 + cos k))",
                "rounding",
                worst,
                (0.0, 1e-11),
            ),
            Claim::number("lag of the one over lead of the other", "1", lag / lead, (0.9, 1.1)),
            Claim::number(
                "the highest frequencies, Galerkin over lumped",
                "sqrt 3 = 1.732",
                fast[CELLS - 2].1 / slow[CELLS - 2].1,
                (1.72, 1.74),
            ),
        ],
        ..STUDY.heading()
    })
}
