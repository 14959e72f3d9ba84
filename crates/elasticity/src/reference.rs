//! Reference elements: shape functions, and the points at which elements are integrated.
//!
//! ```text
//! x(l) = sum_a N_a(l) x_a                     l = (l_1 ... l_R) with l_0 = 1 - l_1 - ... - l_R
//! linear      N_a = l_a
//! quadratic   N_a = l_a (2 l_a - 1) at corners,  4 l_a l_b between a and b
//! int f = sum_q w_q f(l_q)                    sum of w = 1, 1/2, 1/6: the reference simplex
//! ```
//! Edge nodes follow the corners: 01 on a segment, 01 12 20 on a triangle, 01 12 20 03 13 23 on a
//! tetrahedron. The rules have one point for linear elements, whose gradients are constant, and for
//! quadratic ones 2, 3 and 4, exact to degree 3, 2 and 2: enough for the full order of convergence
//! and for a stiffness without false zero modes, as 3 x 3 = 12 - 3 and 4 x 6 = 30 - 6 strains tell.
//! The energy of a quadratic element has degree 4 and more, and is sampled. Source: notes 13.2
//! (linear); Ciarlet (1978), section 4.1; Hammer and Stroud (1956).

use stationary_calculus::array;
use stationary_mesh::simplex_quadrature;

/// A family of elements with `N` nodes, of `R` dimensions, integrated at `Q` points.
pub trait Reference<const N: usize, const R: usize, const Q: usize> {
    /// The points and weights at which energies are integrated.
    const POINTS: [([f64; R], f64); Q];
    /// Where the nodes are.
    const NODES: [[f64; R]; N];
    /// The degree of the shape functions.
    const DEGREE: usize;

    /// The shape functions.
    fn functions(l: &[f64; R]) -> [f64; N];

    /// Their gradients.
    fn gradients(l: &[f64; R]) -> [[f64; R]; N];

    /// A rule that is exact to any degree: for masses, loads and errors.
    fn rule(degree: usize) -> Vec<([f64; R], f64)>;
}

/// Straight pieces of two nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinearSegment;
/// Pieces of three nodes, which may be curved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct QuadraticSegment;
/// Triangles of three nodes, of constant strain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinearTriangle;
/// Triangles of six nodes, which may be curved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct QuadraticTriangle;
/// Tetrahedra of four nodes, of constant strain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinearTetrahedron;
/// Tetrahedra of ten nodes, which may be curved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct QuadraticTetrahedron;

const SEGMENT: [[usize; 2]; 1] = [[0, 1]];
const TRIANGLE: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];
const TETRAHEDRON: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// The barycentric coordinate of a corner.
fn barycentric<const R: usize>(l: &[f64; R], corner: usize) -> f64 {
    match corner {
        0 => 1.0 - l.iter().sum::<f64>(),
        k => l[k - 1],
    }
}

/// Its derivative by the k-th coordinate.
fn slope(corner: usize, k: usize) -> f64 {
    match corner {
        0 => -1.0,
        corner if corner == k + 1 => 1.0,
        _ => 0.0,
    }
}

fn linear_functions<const N: usize, const R: usize>(l: &[f64; R]) -> [f64; N] {
    array(|a| barycentric(l, a))
}

fn linear_gradients<const N: usize, const R: usize>() -> [[f64; R]; N] {
    array(|a| array(|k| slope(a, k)))
}

fn quadratic_functions<const N: usize, const R: usize>(
    edges: &[[usize; 2]],
    l: &[f64; R],
) -> [f64; N] {
    array(|node| match node.checked_sub(R + 1) {
        None => barycentric(l, node) * (2.0 * barycentric(l, node) - 1.0),
        Some(edge) => 4.0 * barycentric(l, edges[edge][0]) * barycentric(l, edges[edge][1]),
    })
}

fn quadratic_gradients<const N: usize, const R: usize>(
    edges: &[[usize; 2]],
    l: &[f64; R],
) -> [[f64; R]; N] {
    array(|node| {
        array(|k| match node.checked_sub(R + 1) {
            None => (4.0 * barycentric(l, node) - 1.0) * slope(node, k),
            Some(edge) => {
                let [a, b] = edges[edge];
                4.0 * (barycentric(l, a) * slope(b, k) + barycentric(l, b) * slope(a, k))
            }
        })
    })
}

/// The rule of a simplex of K = R + 1 corners, by the coordinates of the corners after the first.
fn rule<const K: usize, const R: usize>(degree: usize) -> Vec<([f64; R], f64)> {
    let size = [1.0, 0.5, 1.0 / 6.0][R - 1];
    let points = simplex_quadrature::<K>(degree).into_iter();
    points.map(|(l, weight)| (array(|k| l[k + 1]), weight * size)).collect()
}

macro_rules! family {
    ($name:ident, $n:literal, $r:literal, $q:literal, linear, $points:expr, $nodes:expr) => {
        impl Reference<$n, $r, $q> for $name {
            const POINTS: [([f64; $r], f64); $q] = $points;
            const NODES: [[f64; $r]; $n] = $nodes;
            const DEGREE: usize = 1;

            fn functions(l: &[f64; $r]) -> [f64; $n] {
                linear_functions(l)
            }

            fn gradients(_l: &[f64; $r]) -> [[f64; $r]; $n] {
                linear_gradients()
            }

            fn rule(degree: usize) -> Vec<([f64; $r], f64)> {
                rule::<{ $r + 1 }, $r>(degree)
            }
        }
    };
    ($name:ident, $n:literal, $r:literal, $q:literal, $edges:ident, $points:expr, $nodes:expr) => {
        impl Reference<$n, $r, $q> for $name {
            const POINTS: [([f64; $r], f64); $q] = $points;
            const NODES: [[f64; $r]; $n] = $nodes;
            const DEGREE: usize = 2;

            fn functions(l: &[f64; $r]) -> [f64; $n] {
                quadratic_functions(&$edges, l)
            }

            fn gradients(l: &[f64; $r]) -> [[f64; $r]; $n] {
                quadratic_gradients(&$edges, l)
            }

            fn rule(degree: usize) -> Vec<([f64; $r], f64)> {
                rule::<{ $r + 1 }, $r>(degree)
            }
        }
    };
}

/// Gauss's points on a segment: `1/2 (1 -+ 1/sqrt 3)`.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_13, 0.788_675_134_594_812_9];
/// A tetrahedron's four points are at `(5 - sqrt 5)/20` and once at `(5 + 3 sqrt 5)/20`.
const NEAR: f64 = 0.585_410_196_624_968_5;
const FAR: f64 = 0.138_196_601_125_010_5;
const THIRD: f64 = 1.0 / 3.0;
const SIXTH: f64 = 1.0 / 6.0;

family!(LinearSegment, 2, 1, 1, linear, [([0.5], 1.0)], [[0.0], [1.0]]);
family!(
    QuadraticSegment,
    3,
    1,
    2,
    SEGMENT,
    [([GAUSS[0]], 0.5), ([GAUSS[1]], 0.5)],
    [[0.0], [1.0], [0.5]]
);
family!(
    LinearTriangle,
    3,
    2,
    1,
    linear,
    [([THIRD, THIRD], 0.5)],
    [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
);
family!(
    QuadraticTriangle,
    6,
    2,
    3,
    TRIANGLE,
    [([SIXTH, SIXTH], SIXTH), ([2.0 * THIRD, SIXTH], SIXTH), ([SIXTH, 2.0 * THIRD], SIXTH)],
    [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]]
);
family!(
    LinearTetrahedron,
    4,
    3,
    1,
    linear,
    [([0.25, 0.25, 0.25], SIXTH)],
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
);
family!(
    QuadraticTetrahedron,
    10,
    3,
    4,
    TETRAHEDRON,
    [
        ([FAR, FAR, FAR], 0.25 * SIXTH),
        ([NEAR, FAR, FAR], 0.25 * SIXTH),
        ([FAR, NEAR, FAR], 0.25 * SIXTH),
        ([FAR, FAR, NEAR], 0.25 * SIXTH)
    ],
    [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.5, 0.0, 0.0],
        [0.5, 0.5, 0.0],
        [0.0, 0.5, 0.0],
        [0.0, 0.0, 0.5],
        [0.5, 0.0, 0.5],
        [0.0, 0.5, 0.5]
    ]
);

#[cfg(test)]
mod tests {
    use super::*;
    use stationary_calculus::assert_jacobian;

    fn check<F: Reference<N, R, Q>, const N: usize, const R: usize, const Q: usize>(exact: usize) {
        for (node, l) in F::NODES.iter().enumerate() {
            let functions = F::functions(l);
            assert!((0..N).all(|a| functions[a] == if a == node { 1.0 } else { 0.0 }));
        }
        let l = std::array::from_fn(|k| 0.2 + 0.05 * k as f64);
        assert!((F::functions(&l).iter().sum::<f64>() - 1.0).abs() < 1e-15);
        assert_jacobian(
            |l| F::functions(&std::array::from_fn(|k| l[k])).to_vec(),
            |l| {
                let gradients = F::gradients(&std::array::from_fn(|k| l[k]));
                nalgebra::DMatrix::from_fn(N, R, |a, k| gradients[a][k])
            },
            &l,
        );
        // Monomials in the last coordinate: int l^p over the simplex is R! p!/(p + R)! of its size.
        let monomial = |points: &[([f64; R], f64)], p: usize| -> f64 {
            points.iter().map(|(l, w)| w * l[R - 1].powi(p as i32)).sum()
        };
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        for p in 0..=exact {
            let exact = factorial(p) / factorial(p + R);
            assert!((monomial(&F::POINTS, p) - exact).abs() < 1e-16, "degree {p}");
            assert!((monomial(&F::rule(p), p) - exact).abs() < 1e-15);
        }
        let missed = exact + 1;
        let exact = factorial(missed) / factorial(missed + R);
        assert!((monomial(&F::POINTS, missed) - exact).abs() > 1e-4, "more than promised");
    }

    #[test]
    fn shape_functions_are_one_at_their_node_and_rules_are_exact_as_promised() {
        check::<LinearSegment, 2, 1, 1>(1);
        check::<QuadraticSegment, 3, 1, 2>(3);
        check::<LinearTriangle, 3, 2, 1>(1);
        check::<QuadraticTriangle, 6, 2, 3>(2);
        check::<LinearTetrahedron, 4, 3, 1>(1);
        check::<QuadraticTetrahedron, 10, 3, 4>(2);
    }
}
