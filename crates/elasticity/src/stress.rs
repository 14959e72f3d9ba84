//! Stress, where a person wants to read it: at the nodes, or one for each element.
//!
//! ```text
//! sigma = P F^T / J                     Cauchy's stress, D x D, Pa
//! sigma = P                             of a law of small displacements, which knows no F^T and no J
//! sigma_e = sum_q w_q sigma_q / sum_q w_q              of an element: the mean over its points
//! sigma_e(X_a) = sum_q w_q(a) sigma_q   the linear function nearest to the values at the points
//! sigma_a = sum_e |e| sigma_e(X_a) / sum_e |e|         over the elements e at node a
//! ```
//! Named extrapolated and averaged: stress is taken at the quadrature points, where it is most
//! accurate, continued linearly to the nodes, and averaged with the elements' sizes. On linear
//! elements, whose stress is constant, it is of first order at boundaries. Across an interface
//! between two materials stress may jump, and is averaged all the same. A bar or a sheet has J of its
//! own dimensions, the stretch of a length or an area: its stress is per section at rest. Source:
//! Zienkiewicz and Taylor, The Finite Element Method (2005); Barlow (1976).

use nalgebra::DMatrix;
use stationary_calculus::array;

use crate::lanes::LANES;
use crate::shape::visit_points;
use crate::singular::square_determinant;
use crate::tensor::dot;
use crate::{ElasticityError, Elements, Lanes, Material, Real, Reference, Solid, group};

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
        if weight > 0.0 { array(|j| array(|i| sum[j][i] / weight)) } else { sum }
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
    let middle: [f64; D] = array(|i| points.iter().map(|l| l[i]).sum::<f64>() / Q as f64);
    // An average, and slopes that least squares take from where the points are.
    let apart = DMatrix::from_fn(Q, D, |q, i| points[q][i] - middle[i]);
    let spread = apart.amax();
    let slopes = apart.pseudo_inverse(SPREAD * spread).unwrap_or_else(|_| DMatrix::zeros(D, Q));
    array(|a| {
        array(|q| {
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
    array(|k| array(|i| (1..N).map(|a| (nodes[a][i] - nodes[0][i]) * gradients[a][k]).sum()))
}

/// Cauchy's stress of a material at F, by columns, Pa. Not finite where F is singular, unless the law
/// is one of small displacements.
pub fn cauchy<M: Material<D, D>, const D: usize>(material: &M, f: &[[f64; D]; D]) -> [[f64; D]; D] {
    pushed_forward::<M, D, D>(&material.stress(f), f)
}

/// Cauchy's stress from P and F, by columns.
fn pushed_forward<M: Material<D, R>, const D: usize, const R: usize>(
    p: &[[f64; D]; R],
    f: &[[f64; D]; R],
) -> [[f64; D]; D] {
    if M::SMALL_DISPLACEMENTS && D == R {
        return array(|j| p[j]);
    }
    let volume = stretch(f);
    array(|j| array(|i| (0..R).map(|k| p[k][i] * f[k][j]).sum::<f64>() / volume))
}

/// J: the determinant of F where it is square, else what a length or an area is stretched by.
fn stretch<const D: usize, const R: usize>(f: &[[f64; D]; R]) -> f64 {
    let along = |a: usize, b: usize| dot(&f[a], &f[b]);
    match R {
        _ if D == R => square_determinant(f),
        1 => along(0, 0).sqrt(),
        _ => (along(0, 0) * along(1, 1) - along(0, 1) * along(0, 1)).max(0.0).sqrt(),
    }
}

impl<M: Material<D, R>, const N: usize, const D: usize, const R: usize, const Q: usize>
    Solid<M, N, D, R, Q>
{
    /// Cauchy's stress of every element, by columns, Pa, in the order of the mesh. That of an element
    /// which is flat now is not finite.
    ///
    /// # Errors
    /// [`ElasticityError::Freedoms`] unless `q` has a number for each freedom.
    pub fn stresses(&self, q: &[f64]) -> Result<Vec<[[f64; D]; D]>, ElasticityError> {
        self.freedoms().check(q.len())?;
        let mut all = Vec::with_capacity(self.elements());
        for group in &self.groups {
            let x = group.corners(self.freedoms(), q);
            let mut sums = [([[0.0; D]; D], 0.0); LANES];
            for (gradients, weight) in group.gradients.iter().zip(&group.weights) {
                let f = group::deformation(&x, gradients);
                let p = self.material().stress(&f);
                for (lane, (sum, weights)) in sums.iter_mut().enumerate().take(group.filled) {
                    let of_lane =
                        |lanes: &[[Lanes; D]; R]| array(|k| array(|i| lanes[k][i].lane(lane)));
                    let stress = pushed_forward::<M, D, R>(&of_lane(&p), &of_lane(&f));
                    let weight = weight.lane(lane);
                    *weights += weight;
                    for j in 0..D {
                        for i in 0..D {
                            sum[j][i] += weight * stress[j][i];
                        }
                    }
                }
            }
            let mean =
                |(sum, weights): &([[f64; D]; D], f64)| array(|j| array(|i| sum[j][i] / weights));
            all.extend(sums[..group.filled].iter().map(mean));
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::SVector;
    use stationary_mesh::Mesh;

    use super::*;
    use crate::{
        Freedoms, Lame, Linear, LinearSegment, LinearTetrahedron, LinearTriangle, NeoHookean,
        QuadraticTetrahedron, SaintVenantKirchhoff,
    };

    const YOUNG: f64 = 200.0;
    const POISSON: f64 = 0.3;

    fn lame() -> Lame<3> {
        Lame::from_young_poisson(YOUNG, POISSON).unwrap()
    }

    fn tetrahedron() -> Mesh<3, 4> {
        let corners = [[0.1, 0.0, 0.0], [1.0, 0.2, 0.0], [0.0, 1.1, 0.1], [0.3, 0.2, 0.9]];
        Mesh::new(corners.map(SVector::from).to_vec(), vec![[0, 1, 2, 3]]).unwrap()
    }

    fn moved<const D: usize>(nodes: &[[f64; D]], f: [[f64; D]; D]) -> Vec<f64> {
        let place = |x: &[f64; D]| -> [f64; D] {
            std::array::from_fn(|i| 0.7 + (0..D).map(|k| f[k][i] * x[k]).sum::<f64>())
        };
        nodes.iter().flat_map(place).collect()
    }

    fn assert_close<const D: usize>(a: &[[f64; D]; D], b: &[[f64; D]; D]) {
        for (a, b) in a.as_flattened().iter().zip(b.as_flattened()) {
            assert!((a - b).abs() < 1e-11 * YOUNG, "{a} {b}");
        }
    }

    #[test]
    fn the_stress_of_an_element_is_that_of_its_material_at_its_deformation() {
        let f = [[1.1, 0.2, 0.0], [-0.1, 0.9, 0.1], [0.05, 0.0, 1.2]];
        let (mesh, law) = (tetrahedron(), NeoHookean::new(lame()).unwrap());
        let free = || Freedoms::<3>::new(4, &[]).unwrap();
        let q = moved(&mesh.nodes(), f);
        let solid = Solid::new(LinearTetrahedron, &mesh, 1.0, law, free()).unwrap();
        assert_close(&solid.stresses(&q).unwrap()[0], &cauchy(&law, &f));
        let curved = stationary_mesh::Quadratic::<3, 4, 10>::straight(&mesh);
        let free = Freedoms::<3>::new(10, &[]).unwrap();
        let solid = Solid::new(QuadraticTetrahedron, &curved, 1.0, law, free).unwrap();
        let q = moved(&curved.nodes().iter().map(|&x| x.into()).collect::<Vec<_>>(), f);
        assert_close(&solid.stresses(&q).unwrap()[0], &cauchy(&law, &f));
        assert!(solid.stresses(&q[1..]).is_err());
    }

    #[test]
    fn a_block_that_is_drawn_out_and_free_to_thin_bears_young_times_strain_along_it_alone() {
        let strain = 1e-3;
        let thin = 1.0 - POISSON * strain;
        let f = [[1.0 + strain, 0.0, 0.0], [0.0, thin, 0.0], [0.0, 0.0, thin]];
        let (mesh, law) = (tetrahedron(), Linear::new(lame()));
        let free = Freedoms::<3>::new(4, &[]).unwrap();
        let solid = Solid::new(LinearTetrahedron, &mesh, 1.0, law, free).unwrap();
        let stress = solid.stresses(&moved(&mesh.nodes(), f)).unwrap();
        let mut exact = [[0.0; 3]; 3];
        exact[0][0] = YOUNG * strain;
        assert_close(&stress[0], &exact);
    }

    #[test]
    fn bars_and_sheets_are_stressed_along_themselves_wherever_they_point() {
        // A bar of length 1, drawn out to 1.2 along (0.6, 0, 0.8).
        let ends = [[0.0; 3], [1.0, 0.0, 0.0]].map(SVector::from);
        let mesh = Mesh::<3, 2>::new(ends.to_vec(), vec![[0, 1]]).unwrap();
        let law = SaintVenantKirchhoff::new(lame().uniaxial_stress());
        let free = Freedoms::<3>::new(2, &[]).unwrap();
        let bar = Solid::new(LinearSegment, &mesh, 0.01, law, free).unwrap();
        let along = [0.6, 0.0, 0.8];
        let q = [0.0, 0.0, 0.0, 1.2 * along[0], 0.0, 1.2 * along[2]];
        // Force over section at rest: lambda E (lambda^2 - 1)/2.
        let force = 1.2 * YOUNG * (1.44 - 1.0) / 2.0;
        let exact = along.map(|a| along.map(|b| force * a * b));
        assert_close(&bar.stresses(&q).unwrap()[0], &exact);

        // A triangle that is drawn out by 1.2 in its plane along x is one of plane stress.
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]].map(SVector::from);
        let mesh = Mesh::<3, 3>::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
        let law = SaintVenantKirchhoff::new(lame().plane_stress());
        let free = Freedoms::<3>::new(3, &[]).unwrap();
        let sheet = Solid::new(LinearTriangle, &mesh, 0.01, law, free).unwrap();
        let q = [0.0, 0.0, 0.0, 1.2, 0.0, 0.0, 0.0, 0.0, 1.0];
        let s = YOUNG / (1.0 - POISSON * POISSON) * 0.22;
        let mut exact = [[0.0; 3]; 3];
        (exact[0][0], exact[2][2]) = (1.44 * s / 1.2, POISSON * s / 1.2);
        assert_close(&sheet.stresses(&q).unwrap()[0], &exact);
    }
}
