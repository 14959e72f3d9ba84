//! A slender beam, L/h from 4 to 300, against Euler, Bernoulli and Timoshenko.

use stationary_elasticity::{
    DeadLoad, Freedoms, Lame, Linear, NeoHookean, QuadraticSegment, QuadraticTriangle,
    curved_boundary,
};
use stationary_mesh::{Diagonals, QuadraticTriangles, rectangle};

use super::EPS;
use super::problem::{Problem, clamp};
use crate::{Draw, Verdict};

/// A slender beam of quadratic triangles.
pub fn beam(draw: &mut Draw) -> Verdict {
    let slender = draw.log_uniform(4.0, 300.0);
    let length = draw.log_uniform(1e-6, 1e6);
    let height = length / slender;
    let young = draw.log_uniform(1.0, 1e12);
    let tilt = draw.log_uniform(1e-8, 1e-3);
    let cells = [draw.between(8, 24), draw.between(1, 3)];
    let rubber = draw.chance(0.5);
    let density = draw.log_uniform(1e-3, 1e4);
    // nu = 0: the clamp does not hold what would thin.
    let push = tilt * 3.0 * young * (height / length).powi(3) / 12.0 * height.min(length) / height;
    draw.note(format!("beam of {length:e} x {height:e} m in {cells:?}, E = {young:e}, deflected by {tilt:e} of its length, rubber: {rubber}"));
    let force = push * length;
    let Ok(mesh) = rectangle([length, height], cells, Diagonals::Alternating) else {
        return Verdict::not_judged("no mesh");
    };
    let mesh = QuadraticTriangles::straight(&mesh);
    let Ok(lame) = Lame::<2>::from_young_poisson(young, 0.0) else {
        return Verdict::refused("moduli");
    };
    let places = mesh.nodes().iter().map(|x| [x[0], x[1]]).collect::<Vec<_>>();
    let at_wall = |&vertex: &usize| places[vertex][0] <= 1e-9 * length;
    let held = clamp((0..places.len()).filter(at_wall), &places);
    let ends: Vec<f64> = held.iter().map(|h| h.place).collect();
    let problem = Problem { held: &held, ends: &ends, density, section: 1.0, steps: 1 };
    let Ok(rim) = curved_boundary(&mesh) else { return Verdict::not_judged("no rim") };
    let load = |freedoms: &Freedoms<2>| {
        DeadLoad::traction(QuadraticSegment, &rim, 1.0, freedoms, |x, _| {
            [0.0, if x[0] >= (1.0 - 1e-9) * length { force / height } else { 0.0 }]
        })
    };
    let solved = if rubber {
        match NeoHookean::<2>::new(lame) {
            Ok(rubber) => problem.solve(QuadraticTriangle, &mesh, rubber, &places, &load),
            Err(error) => Err(error),
        }
    } else {
        problem.solve(QuadraticTriangle, &mesh, Linear::<2>::new(lame), &places, &load)
    };
    let rest = match solved {
        Ok(rest) => rest,
        Err(error) => return Verdict::refused(error),
    };
    let inertia = height.powi(3) / 12.0;
    let shear = 1.2 * force * length / (0.5 * young * height);
    let expected = force * length.powi(3) / (3.0 * young * inertia) + shear;
    let tip = rest.positions.iter().zip(&places).filter(|(_, x)| x[0] >= (1.0 - 1e-9) * length);
    let tip: Vec<f64> = tip.map(|(got, x)| got[1] - x[1]).collect();
    let got = tip.iter().sum::<f64>() / tip.len() as f64;
    // Coarse cells are too stiff by some percent; large deflections by the square of the tilt.
    // Rounding of the places bends the beam by itself.
    let noise = 10.0 * EPS * length * slender.powi(2);
    let verdict = Verdict::of((got - expected).abs(), 0.03 * expected.abs() + noise, "deflection");
    let up = held.iter().zip(&rest.reactions).filter(|(h, _)| h.component == 1);
    let sum: f64 = up.map(|(_, f)| f).sum();
    let promised = 1e-6 * force + 100.0 * EPS * young * height * slender;
    verdict.and(Verdict::of((sum + force).abs(), promised, "reaction"))
}
