//! Random lines, surfaces and solids of a few dozen vertices.

use nalgebra::{Matrix3, Rotation3, Vector3};
use stationary_mesh::{Mesh, MeshError};

use crate::Draw;

/// Vertices in space and the simplices that name them.
#[derive(Clone, Debug, Default)]
pub struct Shape<const K: usize> {
    pub vertices: Vec<Vector3<f64>>,
    pub simplices: Vec<[usize; K]>,
}

impl<const K: usize> Shape<K> {
    pub fn mesh(&self) -> Result<Mesh<3, K>, MeshError> {
        const { assert!(2 <= K && K <= 4) };
        Mesh::new(self.vertices.clone(), self.simplices.clone())
    }

    /// Numbers the other's vertices after these.
    pub fn add(&mut self, other: &Self) {
        let offset = self.vertices.len();
        self.vertices.extend(&other.vertices);
        self.simplices.extend(other.simplices.iter().map(|s| s.map(|vertex| vertex + offset)));
    }

    /// For each vertex the first vertex of its piece.
    pub fn pieces(&self) -> Vec<usize> {
        let mut firsts: Vec<usize> = (0..self.vertices.len()).collect();
        loop {
            let before = firsts.clone();
            for simplex in &self.simplices {
                let first = simplex.iter().map(|&v| firsts[v]).min().unwrap_or(0);
                simplex.iter().for_each(|&v| firsts[v] = first);
            }
            if before == firsts {
                return firsts;
            }
        }
    }

    /// Stretched, sheared, turned and scaled.
    pub fn placed(mut self, draw: &mut Draw) -> Self {
        let stretch = if draw.chance(0.3) { draw.log_uniform(1.0, 300.0) } else { 1.0 };
        let shear = if draw.chance(0.3) { 3.0 * draw.symmetric() } else { 0.0 };
        let scale = if draw.chance(0.3) { draw.log_uniform(1e-6, 1e6) } else { 1.0 };
        let turn = Rotation3::new(Vector3::from_vec(draw.vector(3)));
        let map = Matrix3::new(stretch, shear, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        draw.note(format!("stretched {stretch:.3e}, sheared {shear:.2}, scaled {scale:.1e}"));
        for x in &mut self.vertices {
            *x = turn * (map * *x) * scale;
        }
        self
    }
}

/// One to three pieces of one kind.
pub fn in_pieces<const K: usize>(draw: &mut Draw, piece: fn(&mut Draw) -> Shape<K>) -> Shape<K> {
    let mut shape = piece(draw);
    let others = if draw.chance(0.4) { draw.between(1, 2) } else { 0 };
    for k in 0..others {
        let mut other = piece(draw);
        let aside = Vector3::new(0.0, 0.0, 3.0 * (k + 1) as f64);
        other.vertices.iter_mut().for_each(|x| *x += aside);
        shape.add(&other);
    }
    draw.note(format!(
        "{} pieces, {} vertices, {} simplices",
        others + 1,
        shape.vertices.len(),
        shape.simplices.len()
    ));
    shape
}

/// A path or a ring of segments of very unequal lengths.
pub fn line(draw: &mut Draw) -> Shape<2> {
    let n = draw.between(1, 12);
    let ring = n >= 3 && draw.chance(0.3);
    let mut x = Vector3::zeros();
    let mut vertices = vec![x];
    for _ in 0..n {
        let mut way = Vector3::from_vec(draw.vector(3));
        way += Vector3::new(1.5, 0.0, 0.0);
        x += way.normalize() * draw.log_uniform(0.01, 1.0);
        vertices.push(x);
    }
    let mut simplices: Vec<[usize; 2]> = (0..n).map(|k| [k, k + 1]).collect();
    if ring {
        simplices.push([n, 0]);
    }
    Shape { vertices, simplices }
}

/// A bent grid with random diagonals, some of whose cells may be missing, or a closed surface.
pub fn surface(draw: &mut Draw) -> Shape<3> {
    match draw.below(3) {
        0 => bent_grid(draw),
        1 => ring_grid(draw),
        _ => bumpy_ball(draw),
    }
}

/// The two triangles of a cell whose corners are given around it.
pub fn halves([a, b, c, d]: [usize; 4], other_diagonal: bool) -> [[usize; 3]; 2] {
    if other_diagonal { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] }
}

fn bent_grid(draw: &mut Draw) -> Shape<3> {
    let [m, n] = [draw.between(1, 4), draw.between(1, 4)];
    let jitter = if draw.chance(0.5) { 0.4 } else { 0.0 };
    let bend = if draw.chance(0.5) { draw.unit() } else { 0.0 };
    let mut vertices = Vec::new();
    for (j, i) in (0..=n).flat_map(|j| (0..=m).map(move |i| (j, i))) {
        let off = Vector3::from_vec(draw.vector(3)) * jitter;
        let [x, y] = [i as f64 + off.x, j as f64 + off.y];
        vertices.push(Vector3::new(x / m as f64, y / n as f64, bend * off.z));
    }
    let at = |i: usize, j: usize| i + j * (m + 1);
    let mut simplices = Vec::new();
    for (j, i) in (0..n).flat_map(|j| (0..m).map(move |i| (j, i))) {
        let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        simplices.extend(halves(corners, draw.chance(0.5)));
    }
    Shape { vertices, simplices }
}

/// A tube, open or with its ends joined to a torus.
fn ring_grid(draw: &mut Draw) -> Shape<3> {
    let [m, n] = [draw.between(3, 6), draw.between(3, 5)];
    let closed = draw.chance(0.5);
    let mut vertices = Vec::new();
    for (j, i) in (0..n).flat_map(|j| (0..m).map(move |i| (j, i))) {
        let [u, v] = [i as f64 / m as f64, j as f64 / n as f64].map(|x| x * std::f64::consts::TAU);
        vertices.push(if closed {
            let r = 2.0 + u.cos();
            Vector3::new(r * v.cos(), r * v.sin(), u.sin())
        } else {
            Vector3::new(u.cos(), u.sin(), v)
        });
    }
    let at = |i: usize, j: usize| i % m + (j % n) * m;
    let mut simplices = Vec::new();
    for (j, i) in (0..if closed { n } else { n - 1 }).flat_map(|j| (0..m).map(move |i| (j, i))) {
        let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        simplices.extend(halves(corners, draw.chance(0.5)));
    }
    Shape { vertices, simplices }
}

/// A ball of latitudes with bumps.
pub fn bumpy_ball(draw: &mut Draw) -> Shape<3> {
    let [m, n] = [draw.between(3, 6), draw.between(1, 4)];
    let bumps = if draw.chance(0.5) { 0.7 * draw.unit() } else { 0.0 };
    let mut vertices = vec![Vector3::z()];
    for (j, i) in (1..=n).flat_map(|j| (0..m).map(move |i| (j, i))) {
        let theta = std::f64::consts::PI * j as f64 / (n + 1) as f64;
        let phi = std::f64::consts::TAU * i as f64 / m as f64;
        let x = Vector3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        vertices.push(x * (1.0 + bumps * draw.symmetric()));
    }
    vertices.push(-Vector3::z());
    let at = |i: usize, j: usize| 1 + i % m + (j - 1) * m;
    let south = vertices.len() - 1;
    let mut simplices = Vec::new();
    for i in 0..m {
        simplices.push([0, at(i, 1), at(i + 1, 1)]);
        for j in 1..n {
            let corners = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            simplices.extend(halves(corners, draw.chance(0.5)));
        }
        simplices.push([south, at(i + 1, n), at(i, n)]);
    }
    Shape { vertices, simplices }
}

/// A stack of boxes of six tetrahedra each, with jitter.
pub fn solid(draw: &mut Draw) -> Shape<4> {
    let layers = draw.between(1, 3);
    let mut vertices = Vec::new();
    for (k, j, i) in (0..=layers).flat_map(|k| (0..4).map(move |q| (k, q / 2, q % 2))) {
        let off = Vector3::from_vec(draw.vector(3)) * 0.2;
        vertices.push(Vector3::new(i as f64, j as f64, k as f64) + off);
    }
    let mut simplices = Vec::new();
    for k in 0..layers {
        for order in [[1, 2, 4], [1, 4, 2], [2, 1, 4], [2, 4, 1], [4, 1, 2], [4, 2, 1]] {
            let corner = |steps: usize| 4 * k + order[..steps].iter().sum::<usize>();
            simplices.push([corner(0), corner(1), corner(2), corner(3)]);
        }
    }
    Shape { vertices, simplices }
}
