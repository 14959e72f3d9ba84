//! From the reference element to the body at rest: gradients of shape functions, and sizes.
//!
//! ```text
//! J = sum_a X_a (x) dN_a/dl       G x R, columns the images of the reference directions
//! G = R     gradient of N_a = J^-T dN_a/dl,    size det J > 0
//! G > R     J = E T,  E an orthonormal frame of the element, its first vector along l_1,
//!           gradient of N_a = T^-T dN_a/dl,    size det T
//! ```
//! `X_a` the nodes at rest in `G` dimensions (m), gradients in 1/m. A sheet laid out in the plane
//! has G = R = 2; one whose rest shape is curved in space has G = 3, and its gradients refer to a
//! frame of each element's own: right for isotropic materials, and for woven ones only if laid out
//! in the plane. Source: notes 13.2, with the Jacobian of either shape (errata 13.2).

use stationary_calculus::array;
use stationary_mesh::{Mesh, MeshError, Places, Quadratic};

use crate::tensor::{apply, cofactor, determinant, dot};
use crate::{ElasticityError, Reference};

/// Nodes in `G` dimensions and elements of `N` of them: straight or curved.
pub trait Elements<const G: usize, const N: usize> {
    /// The number of nodes.
    fn count(&self) -> usize;

    /// Where a node is at rest, m.
    fn node(&self, node: usize) -> [f64; G];

    /// The elements, each by the numbers of its nodes.
    fn elements(&self) -> &[[usize; N]];

    /// The nodes of an element.
    fn corners(&self, element: &[usize; N]) -> [[f64; G]; N] {
        array(|a| self.node(element[a]))
    }

    /// All nodes.
    fn nodes(&self) -> Vec<[f64; G]> {
        (0..self.count()).map(|node| self.node(node)).collect()
    }
}

impl<const G: usize, const K: usize> Elements<G, K> for Mesh<G, K> {
    fn count(&self) -> usize {
        self.vertices().len()
    }

    fn node(&self, node: usize) -> [f64; G] {
        self.vertices()[node].into()
    }

    fn elements(&self) -> &[[usize; K]] {
        self.simplices()
    }
}

impl<const G: usize, const K: usize, const N: usize> Elements<G, N> for Quadratic<G, K, N>
where
    [usize; K]: stationary_mesh::Simplex,
{
    fn count(&self) -> usize {
        Quadratic::nodes(self).len()
    }

    fn node(&self, node: usize) -> [f64; G] {
        Quadratic::nodes(self)[node].into()
    }

    fn elements(&self) -> &[[usize; N]] {
        Quadratic::elements(self)
    }
}

/// Where an element is integrated: gradients of its shape functions, 1/m, and its size there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point<const N: usize, const R: usize> {
    pub(crate) gradients: [[f64; R]; N],
    /// Length, area or volume, per that of the reference element.
    pub(crate) size: f64,
}

/// Sizes relative to the product of the edges below this are rounding.
const FLAT: f64 = 1e-14;

/// The gradients and the size at a reference point; the size is zero or negative, and the gradients
/// are not to be used, where the element is flat or inside out.
pub(crate) fn point<F, const N: usize, const R: usize, const Q: usize, const G: usize>(
    nodes: &[[f64; G]; N],
    l: &[f64; R],
) -> Point<N, R>
where
    F: Reference<N, R, Q>,
{
    let slopes = F::gradients(l);
    let columns = jacobian(nodes, &slopes);
    let map = if G == R { square(&columns) } else { in_own_frame(&columns) };
    let size = determinant(&map);
    let longest: f64 = map.iter().map(|column| dot(column, column).sqrt()).product();
    let size = if size.abs() <= FLAT * longest { 0.0 } else { size };
    let cofactor = cofactor(&map);
    let gradients = slopes.map(|slope| {
        let gradient = apply(&cofactor, &slope);
        array(|k| gradient[k] / size)
    });
    // So small that its gradients leave the range of numbers: flat.
    let is_finite = gradients.as_flattened().iter().all(|entry| entry.is_finite());
    Point { gradients, size: if is_finite { size } else { 0.0 } }
}

/// `J`, by columns; from differences, so that places far away cost no digits.
pub(crate) fn jacobian<const N: usize, const R: usize, const G: usize>(
    nodes: &[[f64; G]; N],
    slopes: &[[f64; R]; N],
) -> [[f64; G]; R] {
    array(|k| array(|i| (1..N).map(|a| (nodes[a][i] - nodes[0][i]) * slopes[a][k]).sum()))
}

fn square<const G: usize, const R: usize>(columns: &[[f64; G]; R]) -> [[f64; R]; R] {
    array(|k| array(|i| columns[k][i]))
}

/// The triangular factor of Gram and Schmidt: the columns by components along a frame of their own.
fn in_own_frame<const G: usize, const R: usize>(columns: &[[f64; G]; R]) -> [[f64; R]; R] {
    let mut frame = *columns;
    let mut map = [[0.0; R]; R];
    for k in 0..R {
        for m in 0..k {
            map[k][m] = dot(&frame[m], &frame[k]);
            for i in 0..G {
                frame[k][i] -= map[k][m] * frame[m][i];
            }
        }
        map[k][k] = dot(&frame[k], &frame[k]).sqrt();
        if map[k][k] > 0.0 {
            frame[k] = frame[k].map(|x| x / map[k][k]);
        }
    }
    map
}

/// Shows the points of each element, by its number; an error lists the elements that are flat or
/// inside out, of which nothing may come. One element's points are kept at a time: a rule may have
/// dozens.
pub(crate) fn visit_points<F, const N: usize, const R: usize, const Q: usize, const G: usize>(
    mesh: &impl Elements<G, N>,
    rule: &[([f64; R], f64)],
    mut see: impl FnMut(usize, &[Point<N, R>]),
) -> Result<(), ElasticityError>
where
    F: Reference<N, R, Q>,
{
    let (mut flat, mut inverted) = (Vec::new(), Vec::new());
    let mut points = Vec::with_capacity(rule.len());
    for (number, element) in mesh.elements().iter().enumerate() {
        let nodes = mesh.corners(element);
        points.clear();
        let (mut negative, mut positive) = (false, true);
        points.extend(rule.iter().map(|(l, weight)| {
            let Point { gradients, size } = point::<F, N, R, Q, G>(&nodes, l);
            negative |= size < 0.0;
            // A NaN is flat as well: nothing may come of it.
            positive &= size > 0.0;
            Point { gradients, size: size * weight }
        }));
        if negative {
            inverted.push(number);
        } else if !positive {
            flat.push(number);
        }
        see(number, &points);
    }
    if !inverted.is_empty() {
        return Err(MeshError::Inverted(Places(inverted)).into());
    }
    if !flat.is_empty() {
        return Err(MeshError::Degenerate(Places(flat)).into());
    }
    Ok(())
}
