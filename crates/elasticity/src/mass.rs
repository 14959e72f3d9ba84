//! The mass of a body: every point moves as the shape functions say, or each node carries its
//! share.
//!
//! ```text
//! Galerkin  M_ab = int rho N_a N_b                        kg, the same for each coordinate  (12.2)
//! lumped    m_a = m int N_a^2 / sum_b int N_b^2           for each element of mass m
//! ```
//! `rho` density (kg/m^3), the integral over the body at rest times its section. On linear elements
//! lumping gives each node an equal share of its elements: the row sums of the Galerkin mass. On
//! quadratic ones row sums would give corners zero or less; shares in proportion to the diagonal
//! are positive (Hinton, Rock and Zienkiewicz 1976). Both have the total mass exactly, and the
//! centre of mass of straight elements.
//!
//! A linear triangle has rho A (1 + delta_ij)/12, a tetrahedron rho V (1 + delta_ij)/20 (errata
//! 13.2.1). Held coordinates have no row: their motion is prescribed, and what it drags along is
//! not here.

use stationary_calculus::{DiagonalMetric, FIXED, Sink, SparseMetric, SymmetricMatrix};
use stationary_mesh::{MeshError, Places};

use crate::shape::{Point, visit_points};
use crate::{ElasticityError, Elements, Freedoms, Reference};

/// The consistent mass: sparse.
///
/// # Errors
/// [`ElasticityError::Vertices`] for a numbering of another mesh; [`ElasticityError::Density`] and
/// [`ElasticityError::Section`] unless they are positive and finite; [`ElasticityError::Massless`];
/// [`ElasticityError::Mesh`] for elements that are flat, inside out or name a node twice;
/// [`ElasticityError::Sparse`] for a matrix that cannot be factored.
pub fn galerkin_mass<
    F,
    const N: usize,
    const D: usize,
    const R: usize,
    const Q: usize,
    const G: usize,
>(
    family: F,
    mesh: &impl Elements<G, N>,
    [density, section]: [f64; 2],
    freedoms: &Freedoms<D>,
) -> Result<SparseMetric, ElasticityError>
where
    F: Reference<N, R, Q>,
{
    let masses = element_masses(family, mesh, [density, section], freedoms)?;
    let matrix_of = |sink: &mut dyn FnMut(&[usize], &[f64])| {
        for (element, mass) in mesh.elements().iter().zip(&masses) {
            for component in 0..D {
                let freedoms = element.map(|node| freedoms.of(node)[component]);
                if freedoms.iter().any(|&freedom| freedom != FIXED) {
                    sink(&freedoms, mass.as_flattened());
                }
            }
        }
    };
    let mut matrix = SymmetricMatrix::analyse(freedoms.dim(), |sink| {
        matrix_of(&mut |freedoms, block| sink.add_symmetric(freedoms, block));
    })?;
    matrix.refill(|sink| matrix_of(&mut |freedoms, block| sink.add_symmetric(freedoms, block)))?;
    Ok(SparseMetric::new(matrix)?)
}

/// The lumped mass: a number for each coordinate.
///
/// # Errors
/// [`ElasticityError::Vertices`] for a numbering of another mesh; [`ElasticityError::Density`] and
/// [`ElasticityError::Section`] unless they are positive and finite; [`ElasticityError::Massless`];
/// [`ElasticityError::Mesh`] for elements that are flat, inside out or name a node twice;
/// [`ElasticityError::Metric`] where a lumped mass overflows or vanishes.
pub fn lumped_mass<
    F,
    const N: usize,
    const D: usize,
    const R: usize,
    const Q: usize,
    const G: usize,
>(
    family: F,
    mesh: &impl Elements<G, N>,
    [density, section]: [f64; 2],
    freedoms: &Freedoms<D>,
) -> Result<DiagonalMetric<Vec<f64>>, ElasticityError>
where
    F: Reference<N, R, Q>,
{
    let masses = element_masses(family, mesh, [density, section], freedoms)?;
    let mut lumped = vec![0.0; mesh.count()];
    for (element, mass) in mesh.elements().iter().zip(&masses) {
        let total: f64 = mass.as_flattened().iter().sum();
        let diagonal: f64 = (0..N).map(|a| mass[a][a]).sum();
        for (a, &node) in element.iter().enumerate() {
            lumped[node] += total * mass[a][a] / diagonal;
        }
    }
    let mut of_freedoms = vec![0.0; freedoms.dim()];
    for (node, mass) in lumped.into_iter().enumerate() {
        for freedom in freedoms.of(node).into_iter().filter(|&freedom| freedom != FIXED) {
            of_freedoms[freedom] = mass;
        }
    }
    Ok(DiagonalMetric::new(of_freedoms)?)
}

/// The Galerkin mass of each element, for one coordinate.
fn element_masses<
    F,
    const N: usize,
    const D: usize,
    const R: usize,
    const Q: usize,
    const G: usize,
>(
    _family: F,
    mesh: &impl Elements<G, N>,
    [density, section]: [f64; 2],
    freedoms: &Freedoms<D>,
) -> Result<Vec<[[f64; N]; N]>, ElasticityError>
where
    F: Reference<N, R, Q>,
{
    freedoms.check_vertices(mesh.count())?;
    if !(density > 0.0 && density.is_finite()) {
        return Err(ElasticityError::Density(density));
    }
    if !(section > 0.0 && section.is_finite()) {
        return Err(ElasticityError::Section(section));
    }
    let repeats = |e: &[usize; N]| (1..N).any(|k| e[..k].contains(&e[k]));
    let numbered = mesh.elements().iter().enumerate();
    let repeated: Vec<usize> = numbered.filter(|(_, e)| repeats(e)).map(|(e, _)| e).collect();
    if !repeated.is_empty() {
        return Err(MeshError::RepeatedVertex(Places(repeated)).into());
    }
    let mut named = vec![false; mesh.count()];
    mesh.elements().iter().flatten().for_each(|&node| named[node] = true);
    let massless: Vec<usize> = (0..mesh.count()).filter(|&node| !named[node]).collect();
    if !massless.is_empty() {
        return Err(ElasticityError::Massless(Places(massless)));
    }
    // Curved elements have a Jacobian of degree R (degree - 1) more.
    let rule = F::rule(2 * F::DEGREE + R * (F::DEGREE - 1));
    let functions: Vec<[f64; N]> = rule.iter().map(|(l, _)| F::functions(l)).collect();
    let of_element = |points: &[Point<N, R>]| {
        let mut mass = [[0.0; N]; N];
        for (n, point) in functions.iter().zip(points) {
            let weight = density * section * point.size;
            for a in 0..N {
                for b in 0..=a {
                    mass[a][b] += weight * n[a] * n[b];
                }
            }
        }
        for a in 0..N {
            for b in a + 1..N {
                mass[a][b] = mass[b][a];
            }
        }
        mass
    };
    let mut masses = Vec::with_capacity(mesh.elements().len());
    visit_points::<F, N, R, Q, G>(mesh, &rule, |_, points| masses.push(of_element(points)))?;
    Ok(masses)
}
