//! A displacement chosen beforehand, and the load that makes it the answer.
//!
//! ```text
//! u_i = A sin(k_i.x + i)                             on the unit line, square or cube, metres
//! b_j = -(mu laplace u_j + (lambda + mu) d_j div u)  N/m^3
//! ```
//! `k_i` wave vectors (1/m), D of them. Nodes on the boundary are held at u; the errors are those
//! of the solution inside. Source: notes 13.2, on consistency and order; Roache (2002).

use crate::shape::point;
use crate::{
    DeadLoad, ElasticityError, Elements, Freedoms, Held, Lame, Linear, Material, Reference, Solid,
    Statics, lumped_mass,
};
use stationary_calculus::array;

/// Displacement in plane waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneWaves<const D: usize> {
    /// The amplitude A, m.
    pub amplitude: f64,
    /// A wave vector for each component, 1/m.
    pub waves: [[f64; D]; D],
}

impl<const D: usize> PlaneWaves<D> {
    fn phase(&self, i: usize, x: &[f64; D]) -> f64 {
        i as f64 + (0..D).map(|c| self.waves[i][c] * x[c]).sum::<f64>()
    }

    /// The displacement, m.
    pub fn displacement(&self, x: &[f64; D]) -> [f64; D] {
        array(|i| self.amplitude * self.phase(i, x).sin())
    }

    /// The deformation gradient, by columns.
    pub fn gradient(&self, x: &[f64; D]) -> [[f64; D]; D] {
        array(|k| {
            array(|i| {
                let slope = self.amplitude * self.waves[i][k] * self.phase(i, x).cos();
                slope + if i == k { 1.0 } else { 0.0 }
            })
        })
    }

    /// The force per volume that goes with it, N/m^3.
    pub fn force(&self, lame: &Lame<D>, x: &[f64; D]) -> [f64; D] {
        array(|j| {
            let square: f64 = self.waves[j].iter().map(|k| k * k).sum();
            let u = self.displacement(x);
            let spread: f64 = (0..D).map(|i| self.waves[i][i] * self.waves[i][j] * u[i]).sum();
            lame.mu() * square * u[j] + (lame.lambda() + lame.mu()) * spread
        })
    }
}

/// Relative errors of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// The freedoms that were solved for.
    pub freedoms: usize,
    /// Of the displacement, in the root of its mean square.
    pub displacement: f64,
    /// Of the strain, in the norm of its energy.
    pub energy: f64,
}

/// The errors of elements on a mesh of the unit line, square or cube.
///
/// # Errors
/// Those of [`Freedoms::new`], [`Solid::new`], [`DeadLoad::body`], [`lumped_mass`] and
/// [`Statics::solve`]; [`ElasticityError::Integral`] where an integral is not finite, and where the
/// displacement or its strain is zero, so that no error is relative to it.
pub fn manufactured_errors<F, const N: usize, const D: usize, const Q: usize>(
    family: F,
    mesh: &impl Elements<D, N>,
    lame: Lame<D>,
    waves: &PlaneWaves<D>,
) -> Result<Errors, ElasticityError>
where
    F: Reference<N, D, Q> + Copy,
{
    let exact = |x: &[f64; D]| -> [f64; D] {
        let u = waves.displacement(x);
        array(|c| x[c] + u[c])
    };
    let nodes = mesh.nodes();
    let on_boundary = |x: &[f64; D]| x.iter().any(|&x| x == 0.0 || x == 1.0);
    let held = nodes.iter().enumerate().filter(|(_, x)| on_boundary(x)).flat_map(|(vertex, x)| {
        let place = exact(x);
        (0..D).map(move |component| Held { vertex, component, place: place[component] })
    });
    let freedoms = Freedoms::new(nodes.len(), &held.collect::<Vec<_>>())?;
    let material = Linear::new(lame);
    let mut solid = Solid::new(family, mesh, 1.0, material, freedoms.clone())?;
    let load = DeadLoad::body(family, mesh, 1.0, &freedoms, |x| waves.force(&lame, x))?;
    let metric = lumped_mass(family, mesh, [1.0, 1.0], &freedoms)?;
    let mut q = freedoms.gathered(&nodes)?;
    let places = freedoms.places().to_vec();
    Statics::default().solve(&mut solid, &load, &metric, &places, &mut q)?;
    let positions = freedoms.positions(&q)?;
    let squares = integrated(family, mesh, &positions, &material, waves)?;
    let relative = |k: usize| (squares[k][0] / squares[k][1]).sqrt();
    Ok(Errors { freedoms: freedoms.dim(), displacement: relative(0), energy: relative(1) })
}

/// Of displacement and strain: the square of the error and of the solution, integrated.
fn integrated<F, const N: usize, const D: usize, const Q: usize>(
    _family: F,
    mesh: &impl Elements<D, N>,
    positions: &[[f64; D]],
    material: &Linear<D>,
    waves: &PlaneWaves<D>,
) -> Result<[[f64; 2]; 2], ElasticityError>
where
    F: Reference<N, D, Q>,
{
    let rule = F::rule(2 * F::DEGREE + 4);
    let mut squares = [[0.0; 2]; 2];
    let rest: [[f64; D]; D] = array(|k| array(|i| if i == k { 1.0 } else { 0.0 }));
    for element in mesh.elements() {
        let corners = mesh.corners(element);
        for (l, weight) in &rule {
            let functions = F::functions(l);
            let at = point::<F, N, D, Q, D>(&corners, l);
            let sum = |of: &dyn Fn(usize) -> f64| (0..N).map(of).sum::<f64>();
            let x: [f64; D] = array(|c| sum(&|a| functions[a] * corners[a][c]));
            let u = waves.displacement(&x);
            let gradient = waves.gradient(&x);
            let mut error = rest;
            for c in 0..D {
                let found = sum(&|a| functions[a] * positions[element[a]][c]) - x[c];
                squares[0][0] += weight * at.size * (found - u[c]).powi(2);
                squares[0][1] += weight * at.size * u[c] * u[c];
                for k in 0..D {
                    let f = sum(&|a| at.gradients[a][k] * positions[element[a]][c]);
                    error[k][c] += f - gradient[k][c];
                }
            }
            squares[1][0] += weight * at.size * material.energy::<f64>(&error);
            squares[1][1] += weight * at.size * material.energy::<f64>(&gradient);
        }
    }
    for ([error, known], [error_name, known_name]) in squares.into_iter().zip(INTEGRALS) {
        for (value, what, least) in [(known, known_name, LEAST), (error, error_name, 0.0)] {
            if !(value >= least && value.is_finite()) {
                return Err(ElasticityError::Integral { what, value });
            }
        }
    }
    Ok(squares)
}

/// The names of what is integrated.
const INTEGRALS: [[&str; 2]; 2] =
    [["error of the displacement", "known displacement"], ["error of the strain", "known strain"]];

/// Of a smaller square an error of 1e-10 would have none.
const LEAST: f64 = 1e-200;
