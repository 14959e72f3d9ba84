//! Stress, where a person wants to read it: at the nodes.
//!
//! ```text
//! sigma = P F^T / J                     Cauchy's stress, D x D, Pa
//! sigma = P                             of a law of small displacements, which knows no F^T and no J
//! sigma_e(X_a) = sum_q w_q(a) sigma_q   the linear function nearest to the values at the points
//! sigma_a = sum_e |e| sigma_e(X_a) / sum_e |e|         over the elements e at node a
//! ```
//! Named extrapolated and averaged: stress is taken at the quadrature points, where it is most
//! accurate, continued linearly to the nodes, and averaged with the elements' sizes. On linear
//! elements, whose stress is constant, it is of first order at boundaries. Across an interface
//! between two materials stress may jump, and is averaged all the same. Source: Zienkiewicz and
//! Taylor, The Finite Element Method (2005); Barlow (1976).

use nalgebra::DMatrix;

use crate::shape::visit_points;
use crate::tensor::determinant;
use crate::{ElasticityError, Elements, Material, Reference};

/// Cauchy's stress at every node, by columns, Pa; zero at nodes that no element names.
///
/// # Errors
/// [`ElasticityError::Vertices`], [`ElasticityError::Position`] for positions that are not finite,
/// [`ElasticityError::Mesh`] for elements that are flat or inside out at rest, and
/// [`ElasticityError::Stress`] where an element is so flat now that its stress has no bound.
pub fn averaged_stress<F, M, const N: usize, const D: usize, const Q: usize>(
    _family: F,
    mesh: &impl Elements<D, N>,
    material: &M,
    positions: &[[f64; D]],
) -> Result<Vec<[[f64; D]; D]>, ElasticityError>
where
    F: Reference<N, D, Q>,
    M: Material<D, D>,
{
    const { assert!(1 <= Q, "stress is taken at quadrature points") };
    let (expected, got) = (mesh.count(), positions.len());
    if expected != got {
        return Err(ElasticityError::Vertices { expected, got });
    }
    if let Some(vertex) = positions.iter().position(|x| x.iter().any(|x| !x.is_finite())) {
        return Err(ElasticityError::Position { vertex });
    }
    let shares = shares(&F::POINTS.map(|(l, _)| l), &F::NODES);
    let mut sums = vec![([[0.0; D]; D], 0.0); mesh.count()];
    visit_points::<F, N, D, Q, D>(mesh, &F::POINTS, |number, points| {
        let element = &mesh.elements()[number];
        let moved = element.map(|node| positions[node]);
        let size: f64 = points.iter().map(|point| point.size).sum();
        for (&node, shares) in element.iter().zip(&shares) {
            let (sum, weight) = &mut sums[node];
            for (point, share) in points.iter().zip(shares) {
                let stress = cauchy(material, &deformation(&moved, &point.gradients));
                for j in 0..D {
                    for i in 0..D {
                        sum[j][i] += size * share * stress[j][i];
                    }
                }
            }
            *weight += size;
        }
    })?;
    let average = |(sum, weight): ([[f64; D]; D], f64)| {
        if weight > 0.0 { sum.map(|column| column.map(|entry| entry / weight)) } else { sum }
    };
    let stresses: Vec<[[f64; D]; D]> = sums.into_iter().map(average).collect();
    let is_bad = |stress: &[[f64; D]; D]| stress.as_flattened().iter().any(|x| !x.is_finite());
    match stresses.iter().position(is_bad) {
        Some(vertex) => Err(ElasticityError::Stress { vertex }),
        None => Ok(stresses),
    }
}

/// What each point's value counts for at each node: of the linear functions that are nearest to the
/// values at the points the one that is constant where the points say nothing.
fn shares<const N: usize, const D: usize, const Q: usize>(
    points: &[[f64; D]; Q],
    nodes: &[[f64; D]; N],
) -> [[f64; Q]; N] {
    /// Directions in which the points spread less than this part of the most are none.
    const SPREAD: f64 = 1e-9;
    let middle: [f64; D] =
        std::array::from_fn(|i| points.iter().map(|l| l[i]).sum::<f64>() / Q as f64);
    // An average, and slopes that least squares take from where the points are.
    let apart = DMatrix::from_fn(Q, D, |q, i| points[q][i] - middle[i]);
    let spread = apart.amax();
    let slopes = apart.pseudo_inverse(SPREAD * spread).unwrap_or_else(|_| DMatrix::zeros(D, Q));
    std::array::from_fn(|a| {
        std::array::from_fn(|q| {
            let slope: f64 = (0..D).map(|i| (nodes[a][i] - middle[i]) * slopes[(i, q)]).sum();
            1.0 / Q as f64 + slope
        })
    })
}

/// F from the gradients of the shape functions.
fn deformation<const N: usize, const D: usize>(
    nodes: &[[f64; D]; N],
    gradients: &[[f64; D]; N],
) -> [[f64; D]; D] {
    std::array::from_fn(|k| {
        std::array::from_fn(|i| (1..N).map(|a| (nodes[a][i] - nodes[0][i]) * gradients[a][k]).sum())
    })
}

/// Cauchy's stress of a material at F, by columns, Pa. Not finite where F is singular, unless the law
/// is one of small displacements.
pub fn cauchy<M: Material<D, D>, const D: usize>(material: &M, f: &[[f64; D]; D]) -> [[f64; D]; D] {
    let (stress, volume) = (material.stress(f), determinant(f));
    if M::SMALL_DISPLACEMENTS {
        return stress;
    }
    std::array::from_fn(|j| {
        std::array::from_fn(|i| (0..D).map(|k| stress[k][i] * f[k][j]).sum::<f64>() / volume)
    })
}
