//! Elements with a node in the middle of each edge, which may be curved.
//!
//! ```text
//! x(l) = sum_i N_i(l) x_i          N = l_i (2 l_i - 1) at corners,  4 l_i l_j between i and j
//! int f = int_reference f |J|      J = dx, columns x_,i - x_,0
//! ```
//! `l` barycentric coordinates, `x_i` nodes (m), corners first, then the edges in the order of
//! [`Simplex::EDGES`]. Where the element has the dimension of its space its measure and moments
//! are integrals of polynomials, and exact; a surface in space has an area under a root, for
//! which the rule is accurate but not exact. What a closed surface encloses is exact again.
//! Source: any text on isoparametric elements.

use nalgebra::{SVector, Vector3};

use crate::measure::{in_space, measure};
use crate::mesh::{Mesh, check_corners, check_vertices};
use crate::moments::{Moments, middle};
use crate::quadrature::simplex_quadrature;
use crate::simplex::Simplex;
use crate::{MeshError, Places};

/// Elements of `K` corners and `N` nodes in `D` dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Quadratic<const D: usize, const K: usize, const N: usize> {
    nodes: Vec<SVector<f64, D>>,
    elements: Vec<[usize; N]>,
}

/// Segments of three nodes.
pub type QuadraticSegments<const D: usize> = Quadratic<D, 2, 3>;
/// Triangles of six nodes.
pub type QuadraticTriangles<const D: usize> = Quadratic<D, 3, 6>;
/// Tetrahedra of ten nodes.
pub type QuadraticTetrahedra<const D: usize> = Quadratic<D, 4, 10>;

impl<const D: usize, const K: usize, const N: usize> Quadratic<D, K, N>
where
    [usize; K]: Simplex,
{
    /// Elements of these nodes.
    ///
    /// # Errors
    /// Those of [`Mesh::new`].
    pub fn new(nodes: Vec<SVector<f64, D>>, elements: Vec<[usize; N]>) -> Result<Self, MeshError> {
        const { assert!(1 <= D && D <= 3 && K <= D + 1, "no such elements") };
        const { assert!(N == K + K * (K - 1) / 2, "one node a corner and one an edge") };
        check_vertices(&nodes)?;
        check_corners(&elements, nodes.len())?;
        Ok(Quadratic { nodes, elements })
    }

    /// The elements of a mesh with a node halfway along each edge. Node `V + e` belongs to edge
    /// `e` of [`Mesh::edges`], `V` the number of vertices.
    pub fn straight(mesh: &Mesh<D, K>) -> Self {
        const { assert!(N == K + K * (K - 1) / 2, "one node a corner and one an edge") };
        let (edges, corners) = (mesh.edges(), mesh.vertices());
        let halfway = |&[a, b]: &[usize; 2]| corners[a] + (corners[b] - corners[a]) * 0.5;
        let nodes = corners.iter().copied().chain(edges.ends.iter().map(halfway)).collect();
        let numbered = mesh.simplices().iter().zip(&edges.of_simplices);
        let element = |(simplex, edges): (&[usize; K], &<[usize; K] as Simplex>::Edges)| {
            let middle = |edge: usize| corners.len() + edges.as_ref()[edge];
            std::array::from_fn(|k| if k < K { simplex[k] } else { middle(k - K) })
        };
        Quadratic { nodes, elements: numbered.map(element).collect() }
    }

    /// The elements of a mesh whose edges pass through points of one's choice: the function gets
    /// the ends of an edge, the smaller number first, and the point halfway between them.
    ///
    /// # Errors
    /// [`MeshError::NonFinite`] and [`MeshError::TooFar`].
    pub fn curved(
        mesh: &Mesh<D, K>,
        mut place: impl FnMut([usize; 2], SVector<f64, D>) -> SVector<f64, D>,
    ) -> Result<Self, MeshError> {
        let mut elements = Self::straight(mesh);
        let middles = &mut elements.nodes[mesh.vertices().len()..];
        for (node, ends) in middles.iter_mut().zip(mesh.edges().ends) {
            *node = place(ends, *node);
        }
        check_vertices(&elements.nodes)?;
        Ok(elements)
    }

    /// The elements with every node moved by a map: curved where the map is.
    ///
    /// # Errors
    /// [`MeshError::NonFinite`] and [`MeshError::TooFar`].
    pub fn mapped<const E: usize>(
        &self,
        map: impl FnMut(&SVector<f64, D>) -> SVector<f64, E>,
    ) -> Result<Quadratic<E, K, N>, MeshError> {
        Quadratic::new(self.nodes.iter().map(map).collect(), self.elements.clone())
    }

    /// The nodes.
    pub fn nodes(&self) -> &[SVector<f64, D>] {
        &self.nodes
    }

    /// The elements, each by the numbers of its nodes.
    pub fn elements(&self) -> &[[usize; N]] {
        &self.elements
    }

    /// The straight mesh of the corners; nodes that are no corner of any element are left out.
    pub fn corners(&self) -> Mesh<D, K> {
        let simplices: Vec<[usize; K]> =
            self.elements.iter().map(|element| std::array::from_fn(|k| element[k])).collect();
        crate::mesh::part(&self.nodes, &simplices).mesh
    }

    /// The point of an element of these with these barycentric coordinates.
    ///
    /// # Panics
    /// For an element of others that names a node that these have not: it is an index.
    pub fn point(&self, element: &[usize; N], l: &[f64; K]) -> SVector<f64, D> {
        self.nodes[element[0]] + offset(&self.seen(element), l)
    }

    /// The nodes of an element as seen from its first, so that places far away cost no digits.
    fn seen(&self, element: &[usize; N]) -> [SVector<f64, D>; N] {
        element.map(|node| self.nodes[node] - self.nodes[element[0]])
    }

    /// An error that lists the elements whose Jacobian is not positive at some node. Between
    /// nodes it may still fail, which no list of points can tell. For elements that fill their
    /// space.
    ///
    /// # Errors
    /// [`MeshError::Inverted`].
    pub fn check_positive(&self) -> Result<(), MeshError> {
        let at_nodes = node_coordinates::<K, N>();
        let bad = |element: &[usize; N]| {
            let seen = self.seen(element);
            K == D + 1 && at_nodes.iter().any(|l| measure(&tangents(&seen, l)) <= 0.0)
        };
        let numbered = self.elements.iter().enumerate();
        let inverted = numbered.filter(|(_, element)| bad(element)).map(|(number, _)| number);
        Places::refuse(inverted.collect(), MeshError::Inverted)
    }

    /// Length, area or volume of the whole.
    pub fn measure(&self) -> f64 {
        self.moments().measure
    }

    /// The moments of all elements, about the middle of the extent of their nodes.
    pub fn moments(&self) -> Moments<D> {
        let mut moments = Moments::zero(self.middle());
        let rule = simplex_quadrature::<K>(if K == D + 1 { K + 3 } else { 12 });
        for element in &self.elements {
            let (seen, first) = (self.seen(element), self.nodes[element[0]] - moments.about);
            for (l, weight) in &rule {
                let size = weight * measure(&tangents(&seen, l));
                let x = first + offset(&seen, l);
                moments.measure += size;
                moments.first += x * size;
                moments.second += x * x.transpose() * size;
            }
        }
        moments
    }

    fn middle(&self) -> SVector<f64, D> {
        let nodes = self.elements.iter().flatten().map(|&node| self.nodes[node]);
        middle(nodes).unwrap_or_else(SVector::zeros)
    }
}

impl QuadraticTriangles<3> {
    /// The moments of what closed curved triangles enclose, exact by the divergence theorem.
    /// Whether they are closed is the question of [`Quadratic::corners`] and their mesh.
    pub fn enclosed_moments(&self) -> Moments<3> {
        let mut moments = Moments::zero(self.middle());
        for element in &self.elements {
            let (seen, first) = (self.seen(element), self.nodes[element[0]] - moments.about);
            for (l, weight) in simplex_quadrature::<3>(8) {
                let [_, u, v] = tangents(&seen, &l).map(|t| in_space(&t));
                let x: Vector3<f64> = first + offset(&seen, &l);
                // A cone over the surface point: int t^2, t^3, t^4 from 0 to 1; half the cross
                // product is the reference triangle's share.
                let flux = weight * x.dot(&u.cross(&v)) / 2.0;
                moments.measure += flux / 3.0;
                moments.first += x * (flux / 4.0);
                moments.second += x * x.transpose() * (flux / 5.0);
            }
        }
        moments
    }
}

/// The point with these barycentric coordinates, of nodes and as seen from the first of them.
fn offset<const D: usize, const K: usize, const N: usize>(
    seen: &[SVector<f64, D>; N],
    l: &[f64; K],
) -> SVector<f64, D>
where
    [usize; K]: Simplex,
{
    seen.iter().zip(shape::<K, N>(l)).map(|(node, n)| node * n).sum()
}

/// The derivatives of [`offset`] by the coordinates of the corners 1 to K - 1, at the cost of that
/// of corner 0: the columns of J, as points of a simplex whose first corner is zero.
fn tangents<const D: usize, const K: usize, const N: usize>(
    seen: &[SVector<f64, D>; N],
    l: &[f64; K],
) -> [SVector<f64, D>; K]
where
    [usize; K]: Simplex,
{
    let mut by_coordinate = [SVector::<f64, D>::zeros(); K];
    for (k, derivative) in by_coordinate.iter_mut().enumerate() {
        *derivative += seen[k] * (4.0 * l[k] - 1.0);
    }
    for (edge, &[i, j]) in <[usize; K]>::EDGES.iter().enumerate() {
        let node = seen[K + edge];
        by_coordinate[i] += node * (4.0 * l[j]);
        by_coordinate[j] += node * (4.0 * l[i]);
    }
    by_coordinate.map(|derivative| derivative - by_coordinate[0])
}

/// The shape functions at barycentric coordinates.
fn shape<const K: usize, const N: usize>(l: &[f64; K]) -> [f64; N]
where
    [usize; K]: Simplex,
{
    std::array::from_fn(|k| match k.checked_sub(K) {
        None => l[k] * (2.0 * l[k] - 1.0),
        Some(edge) => {
            let [i, j] = <[usize; K]>::EDGES[edge];
            4.0 * l[i] * l[j]
        }
    })
}

/// The barycentric coordinates of the nodes.
fn node_coordinates<const K: usize, const N: usize>() -> [[f64; K]; N]
where
    [usize; K]: Simplex,
{
    std::array::from_fn(|node| match node.checked_sub(K) {
        None => std::array::from_fn(|k| if k == node { 1.0 } else { 0.0 }),
        Some(edge) => {
            let ends = <[usize; K]>::EDGES[edge];
            std::array::from_fn(|k| if ends.contains(&k) { 0.5 } else { 0.0 })
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Diagonals, cuboid, curved_sphere, rectangle};
    use nalgebra::{Vector1, Vector2};
    use std::f64::consts::PI;

    #[test]
    fn shape_functions_are_one_at_their_node_and_zero_at_the_others() {
        for (node, l) in node_coordinates::<4, 10>().iter().enumerate() {
            let shape = shape::<4, 10>(l);
            let is_one = |k: usize| if k == node { 1.0 } else { 0.0 };
            assert!((0..10).all(|k| shape[k] == is_one(k)));
        }
    }

    #[test]
    fn straight_elements_have_the_moments_of_their_simplices() {
        let mesh = cuboid([1.0, 2.0, 3.0], [1, 2, 2]).unwrap();
        let (linear, quadratic) = (mesh.moments(), QuadraticTetrahedra::straight(&mesh).moments());
        assert!((linear.measure - quadratic.measure).abs() < 1e-13);
        assert!((linear.first - quadratic.first).amax() < 1e-13);
        assert!((linear.second - quadratic.second).amax() < 1e-13);
        assert_eq!(QuadraticTetrahedra::straight(&mesh).corners(), mesh);
    }

    #[test]
    fn what_is_far_away_has_the_size_and_the_moments_that_it_has_here() {
        let thin = cuboid([1.0, 2.0, 1.0 / 1024.0], [1, 1, 1]).unwrap();
        let here = QuadraticTetrahedra::straight(&thin);
        for away in [2.0_f64.powi(20), 2.0_f64.powi(30), 2.0_f64.powi(40)] {
            let there = here.mapped(|x| x.add_scalar(away)).unwrap();
            let (near, far) = (here.moments(), there.moments());
            assert!((far.measure / near.measure - 1.0).abs() < 1e-14, "{away}");
            assert!((far.second - near.second).amax() < 1e-14 * near.second.amax());
            assert_eq!(there.check_positive(), Ok(()));
            let skin = QuadraticTriangles::straight(&thin.boundary().mesh);
            let enclosed = skin.mapped(|x| x.add_scalar(away)).unwrap().enclosed_moments();
            assert!((enclosed.measure / near.measure - 1.0).abs() < 1e-13, "{away}");
        }
    }

    #[test]
    fn a_quadratic_map_of_a_square_is_met_exactly() {
        // x = u + u v/2, y = v - u^2/4 has det (1 + v/2) + u^2/4: over the unit square 1 + 1/4 +
        // 1/12.
        let square = rectangle([1.0, 1.0], [3, 2], Diagonals::Alternating).unwrap();
        let bent = QuadraticTriangles::straight(&square)
            .mapped(|x| Vector2::new(x.x + x.x * x.y / 2.0, x.y - x.x * x.x / 4.0))
            .unwrap();
        assert!((bent.measure() - (1.0 + 0.25 + 1.0 / 12.0)).abs() < 1e-15);
        bent.check_positive().unwrap();
    }

    #[test]
    fn an_edge_pulled_too_far_inverts_its_element() {
        let triangle = Mesh::new(
            vec![Vector2::new(0.0, 0.0), Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0)],
            vec![[0, 1, 2]],
        );
        let triangle = triangle.unwrap();
        let pulled = |depth: f64| {
            QuadraticTriangles::curved(&triangle, |ends, middle| {
                if ends == [0, 1] { middle + Vector2::new(0.0, depth) } else { middle }
            })
        };
        // The Jacobian at the corners is 1 - 4 d times the reference's: it vanishes at d = 1/4.
        assert_eq!(pulled(0.249).unwrap().check_positive(), Ok(()));
        let error = pulled(0.251).unwrap().check_positive();
        assert_eq!(error, Err(MeshError::Inverted(Places(vec![0]))));
    }

    #[test]
    fn a_curved_sphere_encloses_what_its_area_bounds() {
        let sphere = curved_sphere(1.0, 3).unwrap();
        assert!((sphere.measure() / (4.0 * PI) - 1.0).abs() < 1e-5);
        let enclosed = sphere.enclosed_moments();
        assert!((enclosed.measure / (4.0 * PI / 3.0) - 1.0).abs() < 1e-5);
        assert!((enclosed.polar() / (4.0 * PI / 5.0) - 1.0).abs() < 1e-4);
        assert!(enclosed.first.amax() < 1e-14);
        let flat = crate::icosphere(1.0, 2).unwrap();
        let straight = QuadraticTriangles::straight(&flat).enclosed_moments();
        let enclosed = crate::ClosedSurface::new(flat).unwrap().moments();
        assert!((straight.measure - enclosed.measure).abs() < 1e-13);
    }

    #[test]
    fn bad_elements_are_named() {
        let nodes = vec![Vector1::new(0.0), Vector1::new(1.0), Vector1::new(0.5)];
        let error = QuadraticSegments::new(nodes.clone(), vec![[0, 1, 3]]).unwrap_err();
        assert_eq!(error, MeshError::NoSuchVertex { simplex: 0, vertex: 3, vertices: 3 });
        let error = QuadraticSegments::new(nodes.clone(), vec![[0, 1, 2], [0, 1, 1]]).unwrap_err();
        assert_eq!(error, MeshError::RepeatedVertex(Places(vec![1])));
        let parabola = QuadraticSegments::new(nodes, vec![[0, 1, 2]]).unwrap();
        assert!((parabola.measure() - 1.0).abs() < 1e-15);
        assert_eq!(parabola.point(&[0, 1, 2], &[0.25, 0.75]), Vector1::new(0.75));
    }
}
