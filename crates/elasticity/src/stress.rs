//! Stress, where a person wants to read it: at the nodes.
//!
//! ```text
//! sigma = P F^T / J                     Cauchy's stress, D x D, Pa
//! sigma_a = sum_e |e| sigma_e(X_a) / sum_e |e|         over the elements e at node a
//! ```
//! Named averaged nodal stress: each element's stress where the node is, averaged with the elements'
//! sizes. On linear elements, whose stress is constant, it is of first order at boundaries; on quadratic
//! ones of second. Across an interface between two materials stress may jump, and is averaged all the
//! same. Source: Zienkiewicz and Taylor, The Finite Element Method (2005), section 14.2.

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
        let size: f64 =
            F::POINTS.iter().map(|(l, w)| w * point::<F, N, D, Q, D>(&rest, l).size).sum();
        for (&node, l) in element.iter().zip(&F::NODES) {
            let gradients = point::<F, N, D, Q, D>(&rest, l).gradients;
            let stress = cauchy(material, &deformation(&moved, &gradients));
            let (sum, weight) = &mut sums[node];
            for j in 0..D {
                for i in 0..D {
                    sum[j][i] += size * stress[j][i];
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
