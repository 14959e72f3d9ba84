//! Hinges of triangles that are flat, beyond range or at one place.

use stationary_calculus::{Curvature, Stencil};
use stationary_elasticity::{Hinge, hinges};
use stationary_mesh::{Diagonals, Mesh, rectangle};

use super::finite;
use crate::{Draw, Verdict};

/// Four places, of which some are the same, in a row, or nowhere.
fn fold(draw: &mut Draw) -> [[f64; 3]; 4] {
    let mut x: [[f64; 3]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| draw.symmetric()));
    let scale = draw.log_uniform(1e-6, 1e6);
    x = x.map(|x| x.map(|x| scale * x));
    match draw.below(5) {
        0 => {}
        1 => x[draw.below(4)] = x[draw.below(4)],
        2 => {
            // In a row with two others.
            let t = draw.uniform(-2.0, 2.0);
            let (a, b, c) = (draw.below(4), draw.below(4), draw.below(4));
            x[a] = std::array::from_fn(|i| x[b][i] + t * (x[c][i] - x[b][i]));
        }
        3 => x[draw.below(4)][draw.below(3)] = draw.any_f64(),
        _ => {
            for x in &mut x {
                x[2] = 0.0;
            }
        }
    }
    x
}

pub fn hinge(draw: &mut Draw) -> Verdict {
    let x = fold(draw);
    let stiffness = if draw.chance(0.3) { draw.any_f64() } else { 1.0 };
    let vertices = if draw.chance(0.2) { [0, 1, 2, draw.below(4)] } else { [0, 1, 2, 3] };
    draw.note(format!("{vertices:?} at {x:?}, {stiffness:e} J"));
    match Hinge::new(vertices, &x, stiffness) {
        Ok(hinge) => {
            let mut repeated = vertices.to_vec();
            repeated.sort_unstable();
            repeated.dedup();
            if repeated.len() < 4 {
                return Verdict::wrong("a hinge with a vertex twice");
            }
            let gradient = hinge.differential(&x);
            let hessian = hinge.hessian(&x, Curvature::Exact);
            let hessian = hessian.as_flattened().as_flattened().as_flattened();
            finite("energy at rest", &[hinge.energy(&x)])
                .and(finite("force at rest", gradient.as_flattened()))
                .and(finite("Hessian at rest", hessian))
        }
        Err(_) => Verdict::due(),
    }
}

pub fn sheet_of_hinges(draw: &mut Draw) -> Verdict {
    let Ok(flat) = rectangle([1.0, 1.0], [2, 2], Diagonals::Same) else {
        return Verdict::not_judged("mesh");
    };
    let mut vertices: Vec<nalgebra::Vector3<f64>> = flat
        .vertices()
        .iter()
        .map(|x| nalgebra::Vector3::new(x[0], x[1], 0.1 * draw.symmetric()))
        .collect();
    let flattened = draw.chance(0.5);
    if flattened {
        // A triangle becomes a line.
        let [a, b, c] = flat.simplices()[draw.below(8)];
        vertices[a] = 0.5 * (vertices[b] + vertices[c]);
    }
    draw.note(format!("a triangle is flat: {flattened}"));
    let Ok(sheet) = Mesh::<3, 3>::new(vertices, flat.simplices().to_vec()) else {
        return Verdict::due();
    };
    match hinges(&sheet, if draw.chance(0.2) { draw.any_f64() } else { 1.0 }) {
        Ok(hinges) => hinges.iter().fold(Verdict::due(), |verdict, hinge| {
            let x = hinge.vertices().map(|v| sheet.vertices()[v].into());
            verdict.and(finite("force at rest", hinge.differential(&x).as_flattened()))
        }),
        Err(_) => Verdict::due(),
    }
}
