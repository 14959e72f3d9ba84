//! A bar in pieces with loads: each piece bears the sum of what is beyond it.

use stationary_elasticity::{
    DeadLoad, Elements, Freedoms, Held, Lame, LinearSegment, SaintVenantKirchhoff,
};
use stationary_mesh::bar;

use super::EPS;
use super::problem::Problem;
use crate::{Draw, Verdict};

/// A bar on a line, loaded at every vertex: the force in each piece is what is put on beyond it.
pub fn chain(draw: &mut Draw) -> Verdict {
    let (cells, length) = (draw.between(1, 12), draw.log_uniform(1e-6, 1e6));
    let (young, section) = (draw.log_uniform(1.0, 1e12), draw.log_uniform(1e-9, 1.0));
    let strain = draw.log_uniform(1e-9, 0.1);
    let density = draw.log_uniform(1e-3, 1e4);
    draw.note(format!("chain of {cells}, {length:e} m, E = {young:e}, section {section:e}, strains up to {strain:e}"));
    let Ok(mesh) = bar(length, cells) else { return Verdict::not_judged("no bar") };
    let Ok(lame) = Lame::<3>::from_young_poisson(young, 0.3) else {
        return Verdict::refused("moduli");
    };
    let largest = strain * young * section / cells as f64;
    let forces: Vec<f64> = draw.vector(cells + 1).into_iter().map(|f| largest * f).collect();
    let held = [Held { vertex: 0, component: 0, place: 0.0 }];
    let problem =
        Problem { held: &held, ends: &[0.0], density, section, steps: draw.between(1, 3) };
    let places = mesh.nodes();
    let load =
        |freedoms: &Freedoms<1>| DeadLoad::new(freedoms, forces.iter().map(|&f| [f]).collect());
    let material = SaintVenantKirchhoff::new(lame.uniaxial_stress());
    let rest = match problem.solve(LinearSegment, &mesh, material, &places, &load) {
        Ok(rest) => rest,
        Err(error) => return Verdict::refused(error),
    };
    let (mut place, mut worst) = (0.0, 0.0_f64);
    for cell in 0..cells {
        let pull: f64 = forces[cell + 1..].iter().sum::<f64>() / (young * section);
        // e: (1 + e) (e + e^2/2) = pull, e the strain of Cauchy.
        let mut e = pull;
        for _ in 0..50 {
            e -= ((1.0 + e) * (e + 0.5 * e * e) - pull) / (1.0 + 3.0 * e + 1.5 * e * e);
        }
        place += length / cells as f64 * e;
        worst = worst.max((rest.positions[cell + 1][0] - places[cell + 1][0] - place).abs());
    }
    let promised = 1e-6 * strain * length + 100.0 * EPS * length * (cells * cells) as f64;
    let total: f64 = forces.iter().sum();
    Verdict::of(worst, promised, "place of a vertex").and(Verdict::of(
        (rest.reactions[0] + total).abs(),
        1e-9 * largest * cells as f64 + 100.0 * EPS * young * section * cells as f64,
        "reaction",
    ))
}
