//! Stress, where a person wants to read it: at the nodes.
//!
//! ```text
//! sigma = P F^T / J                     Cauchy's stress, D x D, Pa
//! sigma_e(X_a) = sum_q w_q(a) sigma_q   the linear function through its values at the points
//! sigma_a = sum_e |e| sigma_e(X_a) / sum_e |e|         over the elements e at node a
//! ```
//! Named extrapolated and averaged: stress is taken at the quadrature points, where it is most accurate,
//! continued linearly to the nodes, and averaged with the elements' sizes. On linear elements, whose
//! stress is constant, it is of first order at boundaries. Across an interface between two materials
//! stress may jump, and is averaged all the same.
//! Source: Zienkiewicz and Taylor, The Finite Element Method (2005), section 14.2; Barlow (1976).

use crate::shape::point;
use crate::tensor::determinant;
use crate::{ElasticityError, Elements, Material, Reference};

/// Cauchy's stress at every node, by columns, Pa; zero at nodes that no element names.
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
    let (expected, got) = (mesh.count(), positions.len());
    if expected != got {
        return Err(ElasticityError::Vertices { expected, got });
    }
    let mut sums = vec![([[0.0; D]; D], 0.0); mesh.count()];
    for element in mesh.elements() {
        let rest = mesh.corners(element);
        let moved = element.map(|node| positions[node]);
        let points = F::POINTS.map(|(l, weight)| (point::<F, N, D, Q, D>(&rest, &l), weight));
        let size: f64 = points.iter().map(|(point, weight)| weight * point.size).sum();
        let stresses =
            points.map(|(point, _)| cauchy(material, &deformation(&moved, &point.gradients)));
        for (&node, l) in element.iter().zip(&F::NODES) {
            let (sum, weight) = &mut sums[node];
            for (stress, share) in stresses.iter().zip(shares::<F, N, D, Q>(l)) {
                for j in 0..D {
                    for i in 0..D {
                        sum[j][i] += size * share * stress[j][i];
                    }
                }
            }
            *weight += size;
        }
    }
    let average = |(sum, weight): ([[f64; D]; D], f64)| {
        if weight > 0.0 { sum.map(|column| column.map(|entry| entry / weight)) } else { sum }
    };
    Ok(sums.into_iter().map(average).collect())
}

/// The linear functions that are one at their own quadrature point and zero at the others. Point q is
/// the one close to corner q.
fn shares<F, const N: usize, const D: usize, const Q: usize>(l: &[f64; D]) -> [f64; Q]
where
    F: Reference<N, D, Q>,
{
    if Q == 1 {
        return [1.0; Q];
    }
    let coordinate = |l: &[f64; D], corner: usize| match corner {
        0 => 1.0 - l.iter().sum::<f64>(),
        corner => l[corner - 1],
    };
    let (near, far) = (coordinate(&F::POINTS[0].0, 0), coordinate(&F::POINTS[1].0, 0));
    std::array::from_fn(|q| (coordinate(l, q) - far) / (near - far))
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

/// Cauchy's stress of a material at F, by columns, Pa. Not finite where F is singular.
pub fn cauchy<const D: usize>(material: &impl Material<D, D>, f: &[[f64; D]; D]) -> [[f64; D]; D] {
    let (stress, volume) = (material.stress(f), determinant(f));
    std::array::from_fn(|j| {
        std::array::from_fn(|i| (0..D).map(|k| stress[k][i] * f[k][j]).sum::<f64>() / volume)
    })
}
