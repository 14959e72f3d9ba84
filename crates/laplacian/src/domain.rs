//! A domain: elements, of which some vertices are held. Its Dirichlet energy and its two masses.
//!
//! ```text
//! held vertices keep their value; the others are free, and where nothing is held df/dn = 0
//! lumped      M_aa = sum |s| / K            Galerkin   M_s = |s| (1 + delta_ij) / (K (K + 1))
//! Lap f = -M^-1 dV(f),     <f, Lap f> = -2 V       where nothing is held
//! ```
//! `K` corners of a simplex s, `|s|` its size, `n` free vertices, `f` (n) in their order. The
//! condition of no flux is what the sum over elements gives by itself; no ghost node stands in
//! for it. Both masses have the same total. Source: notes 15.2-15.3; errata chapter 15.

use stationary_calculus::{
    Covector, DiagonalMetric, FIXED, Metric, Potential, SizeError, SparseMetric, Stencils,
    SymmetricMatrix, UnknownVertex, Vector,
};

use stationary_mesh::{MeshError, Places};

use crate::error::check_finite;
use crate::{Element, Elements, LaplacianError};

/// Dirichlet energy as a potential: one freedom for each free vertex.
pub type Dirichlet<const K: usize> = Stencils<Element<K>, K, 1>;

/// Elements with held vertices.
#[derive(Clone, Debug)]
pub struct Domain<const K: usize> {
    dirichlet: Dirichlet<K>,
    /// The freedom of each vertex, or the place of its value after all freedoms.
    places: Vec<usize>,
    /// The vertex of each freedom, and after them that of each held value.
    order: Vec<usize>,
    held: Vec<f64>,
}

impl<const K: usize> Domain<K> {
    /// Nothing is held: no flux through any boundary (Neumann).
    ///
    /// # Errors
    /// None for elements of a mesh.
    pub fn free(elements: Elements<K>) -> Result<Self, LaplacianError> {
        Domain::held(elements, &[])
    }

    /// Some vertices are held at values (Dirichlet), on whatever boundary is left there is no flux. A
    /// vertex that no element names has no mass to flow into: it has no freedom, and the value zero
    /// unless it is held at another.
    ///
    /// # Errors
    /// [`LaplacianError::NoSuchVertex`], [`LaplacianError::HeldTwice`],
    /// [`LaplacianError::NothingFree`] and [`LaplacianError::Parameter`] for values that are not
    /// finite.
    pub fn held(elements: Elements<K>, values: &[(usize, f64)]) -> Result<Self, LaplacianError> {
        let vertices = elements.vertices();
        let mut is_held = vec![false; vertices];
        for &(vertex, value) in values {
            match is_held.get_mut(vertex) {
                None => return Err(LaplacianError::NoSuchVertex { vertex, vertices }),
                Some(true) => return Err(LaplacianError::HeldTwice(vertex)),
                Some(held) => *held = true,
            }
            if !value.is_finite() {
                return Err(LaplacianError::Parameter { what: "a held value", value });
            }
        }
        let mut values = values.to_vec();
        values.extend(elements.unnamed().into_iter().filter(|&v| !is_held[v]).map(|v| (v, 0.0)));
        let mut places = vec![FIXED; vertices];
        for (k, &(vertex, _)) in values.iter().enumerate() {
            places[vertex] = vertices - values.len() + k;
        }
        let mut order: Vec<usize> = (0..vertices).filter(|&v| places[v] == FIXED).collect();
        if order.is_empty() {
            return Err(LaplacianError::NothingFree);
        }
        for (freedom, &vertex) in order.iter().enumerate() {
            places[vertex] = freedom;
        }
        let free = order.len();
        order.extend(values.iter().map(|&(vertex, _)| vertex));
        let mut stencils = elements.elements;
        for element in &mut stencils {
            element.vertices = element.vertices.map(|vertex| places[vertex]);
        }
        let held: Vec<f64> = values.iter().map(|&(_, value)| value).collect();
        let fixed = held.iter().map(|&value| [value]).collect();
        let dirichlet = Stencils::new(free, fixed, stencils).map_err(
            |UnknownVertex { vertex, vertices, .. }| LaplacianError::NoSuchVertex {
                vertex,
                vertices,
            },
        )?;
        Ok(Domain { dirichlet, places, order, held })
    }

    /// The elements as they were given.
    pub fn elements(&self) -> Elements<K> {
        let given = |element: &Element<K>| {
            let vertices = element.vertices.map(|place| self.order[place]);
            Element { vertices, ..*element }
        };
        let elements = self.dirichlet.stencils().iter().map(given).collect();
        Elements { vertices: self.places.len(), elements }
    }

    /// The Dirichlet energy V of the free vertices' values.
    pub fn dirichlet(&self) -> &Dirichlet<K> {
        &self.dirichlet
    }

    /// How many vertices are free.
    pub fn dim(&self) -> usize {
        self.order.len() - self.held.len()
    }

    /// The vertex of each freedom.
    pub fn free_vertices(&self) -> &[usize] {
        &self.order[..self.dim()]
    }

    /// The freedom of a vertex; `None` where it is held, or does not exist.
    pub fn freedom(&self, vertex: usize) -> Option<usize> {
        self.places.get(vertex).copied().filter(|&place| place < self.dim())
    }

    /// The mass with each simplex shared out to its corners.
    ///
    /// # Errors
    /// None for elements of a mesh; [`MeshError::RepeatedVertex`] for elements of a surface that name a
    /// vertex twice.
    pub fn lumped(&self) -> Result<DiagonalMetric<Vec<f64>>, LaplacianError> {
        self.check_corners()?;
        let mut mass = vec![0.0; self.dim()];
        for element in self.dirichlet.stencils() {
            for &place in &element.vertices {
                if place < mass.len() {
                    mass[place] += element.measure / K as f64;
                }
            }
        }
        Ok(DiagonalMetric::new(mass)?)
    }

    /// The mass that integrates products of piecewise linear functions exactly.
    ///
    /// # Errors
    /// [`MeshError::RepeatedVertex`] as of [`Domain::lumped`], and [`LaplacianError::Sparse`] where it is too
    /// large for 32-bit places.
    pub fn galerkin(&self) -> Result<SparseMetric, LaplacianError> {
        self.check_corners()?;
        let n = self.dim();
        let blocks: Vec<([usize; K], Vec<f64>)> = self
            .dirichlet
            .stencils()
            .iter()
            .map(|element| {
                let freedoms = element.vertices.map(|place| if place < n { place } else { FIXED });
                let unit = element.measure / (K * (K + 1)) as f64;
                let entry = |k: usize| if k / K == k % K { 2.0 * unit } else { unit };
                (freedoms, (0..K * K).map(entry).collect())
            })
            .collect();
        Ok(SparseMetric::new(SymmetricMatrix::from_blocks(n, &blocks)?)?)
    }

    /// An error that lists the elements that name a vertex twice: neither mass is for them, as no sparse
    /// matrix takes them.
    fn check_corners(&self) -> Result<(), LaplacianError> {
        let repeats = |e: &Element<K>| (1..K).any(|k| e.vertices[..k].contains(&e.vertices[k]));
        let numbered = self.dirichlet.stencils().iter().enumerate();
        let bad: Vec<usize> =
            numbered.filter(|(_, e)| repeats(e)).map(|(number, _)| number).collect();
        if bad.is_empty() { Ok(()) } else { Err(MeshError::RepeatedVertex(Places(bad)).into()) }
    }

    /// A function on all vertices: the free ones from `f`, the held ones as they are held, those that
    /// no element names zero.
    ///
    /// # Errors
    /// [`LaplacianError::Size`].
    pub fn on_vertices(&self, f: &[f64]) -> Result<Vec<f64>, LaplacianError> {
        SizeError::check("the function's values", self.dim(), f.len())?;
        let value =
            |&place: &usize| f.get(place).copied().unwrap_or_else(|| self.held[place - f.len()]);
        Ok(self.places.iter().map(value).collect())
    }

    /// The free vertices' part of a function on all vertices.
    ///
    /// # Errors
    /// [`LaplacianError::Size`].
    pub fn on_freedoms(&self, f: &[f64]) -> Result<Vec<f64>, LaplacianError> {
        SizeError::check("the function's values", self.places.len(), f.len())?;
        Ok(self.free_vertices().iter().map(|&vertex| f[vertex]).collect())
    }

    /// For each vertex the first vertex of its connected piece.
    pub(crate) fn pieces(&self) -> Vec<usize> {
        let mut roots: Vec<usize> = (0..self.places.len()).collect();
        fn root(roots: &mut [usize], mut vertex: usize) -> usize {
            while roots[vertex] != vertex {
                roots[vertex] = roots[roots[vertex]];
                vertex = roots[vertex];
            }
            vertex
        }
        for element in self.dirichlet.stencils() {
            let [first, rest @ ..] = element.vertices.as_slice() else { continue };
            for place in rest {
                let ends = [self.order[*first], self.order[*place]];
                let [a, b] = ends.map(|vertex| root(&mut roots, vertex));
                roots[a.max(b)] = a.min(b);
            }
        }
        (0..roots.len()).map(|vertex| root(&mut roots, vertex)).collect()
    }

    /// The functions of the freedoms that are one on a piece of which nothing is held and zero elsewhere,
    /// one after the other; `most` of them at most.
    pub(crate) fn constants(&self, most: usize) -> Vec<f64> {
        let pieces = self.pieces();
        let mut is_free: Vec<bool> = pieces.iter().enumerate().map(|(v, &p)| v == p).collect();
        (0..pieces.len()).filter(|&v| self.is_held(v)).for_each(|v| is_free[pieces[v]] = false);
        let roots = (0..pieces.len()).filter(|&root| is_free[root]).take(most);
        let one = |root: usize, v: usize| if pieces[v] == root { 1.0 } else { 0.0 };
        roots.flat_map(|root| self.free_vertices().iter().map(move |&v| one(root, v))).collect()
    }

    pub(crate) fn is_held(&self, vertex: usize) -> bool {
        self.places[vertex] >= self.dim()
    }
}

/// The Laplacian `-M^-1 dV(f)` of a function.
///
/// # Errors
/// [`LaplacianError::Size`], and [`LaplacianError::NonFinite`] for a function or a Laplacian beyond
/// the range of numbers.
pub fn laplacian(
    metric: &impl Metric,
    dirichlet: &impl Potential,
    f: &[f64],
) -> Result<Vec<f64>, LaplacianError> {
    SizeError::check("the energy's freedoms", metric.dim(), dirichlet.dim())?;
    SizeError::check("the function's values", metric.dim(), f.len())?;
    let (mut dv, mut laplacian) = (Covector(vec![0.0; f.len()]), Vector(vec![0.0; f.len()]));
    dirichlet.add_differential(f, dv.view_mut());
    metric.sharp(dv.view(), laplacian.view_mut());
    laplacian.0.iter_mut().for_each(|value| *value = -*value);
    check_finite(&laplacian.0)?;
    Ok(laplacian.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stationary_calculus::{Number, assert_derivatives, hessian};
    use stationary_mesh::{Diagonals, Mesh, ball, bar, rectangle};

    fn square() -> Mesh<2, 3> {
        rectangle([1.0, 1.0], [4, 3], Diagonals::Alternating).unwrap()
    }

    #[test]
    fn the_interval_has_the_matrix_of_the_notes_with_its_factor_upside_down() {
        let n = 5;
        let domain = Domain::free(Elements::of(&bar(1.0, n).unwrap()).unwrap()).unwrap();
        let f: Vec<f64> = (0..=n).map(|k| ((k * k * k) as f64).sin()).collect();
        let got = laplacian(&domain.lumped().unwrap(), domain.dirichlet(), &f).unwrap();
        let scale = (n * n) as f64;
        let at = |k: usize| match k {
            0 => 2.0 * f[1] - 2.0 * f[0],
            k if k == n => 2.0 * f[n - 1] - 2.0 * f[n],
            k => f[k - 1] - 2.0 * f[k] + f[k + 1],
        };
        assert!((0..=n).all(|k| (got[k] - scale * at(k)).abs() < 1e-12 * scale));
    }

    #[test]
    fn the_product_of_a_function_and_its_laplacian_is_minus_twice_the_energy() {
        let domain = Domain::free(Elements::of(&ball(1.0, 1).unwrap()).unwrap()).unwrap();
        let f: Vec<f64> = (0..domain.dim()).map(|k| ((k * k) as f64).cos()).collect();
        let energy = domain.dirichlet().energy(&f);
        let lumped = domain.lumped().unwrap();
        let galerkin = domain.galerkin().unwrap();
        let by_lumped = laplacian(&lumped, domain.dirichlet(), &f).unwrap();
        let by_galerkin = laplacian(&galerkin, domain.dirichlet(), &f).unwrap();
        let product = lumped.inner(Vector(&f), Vector(&by_lumped));
        assert!((product / (-2.0 * energy) - 1.0).abs() < 1e-13);
        let product = galerkin.inner(Vector(&f), Vector(&by_galerkin));
        assert!((product / (-2.0 * energy) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn both_masses_weigh_the_same_and_have_the_same_centre() {
        let mesh = square();
        let domain = Domain::free(Elements::of(&mesh).unwrap()).unwrap();
        let ones = vec![1.0; domain.dim()];
        let x: Vec<f64> = mesh.vertices().iter().map(|p| p.x).collect();
        let (lumped, galerkin) = (domain.lumped().unwrap(), domain.galerkin().unwrap());
        for (f, exact) in [(&ones, 1.0), (&x, 0.5)] {
            assert!((lumped.inner(Vector(&ones), Vector(f)) - exact).abs() < 1e-14);
            assert!((galerkin.inner(Vector(&ones), Vector(f)) - exact).abs() < 1e-14);
        }
    }

    #[test]
    fn the_energy_s_derivatives_are_right_with_and_without_held_vertices() {
        let elements = Elements::of(&square()).unwrap();
        let f: Vec<f64> = (0..20).map(|k| (k as f64).sin()).collect();
        assert_derivatives(Domain::free(elements.clone()).unwrap().dirichlet(), &f);
        let held = Domain::held(elements, &[(7, 2.0), (0, -1.0)]).unwrap();
        assert_derivatives(held.dirichlet(), &f[..18]);
        let all = held.on_vertices(&f[..18]).unwrap();
        assert_eq!((all[7], all[0], all[1]), (2.0, -1.0, f[0]));
        assert_eq!(held.on_freedoms(&all).unwrap(), f[..18]);
        assert_eq!((held.freedom(0), held.freedom(1), held.freedom(99)), (None, Some(0), None));
    }

    /// The energy of a rubber band of n pieces with Green strain: `c2/2 int ((l/L)^2 - 1)^2 / 4`.
    fn band<R: Number, const N: usize>(x: [R; N], c2: f64) -> R {
        let rest = 1.0 / (N - 1) as f64;
        let piece = |ends: &[R]| {
            let stretch = (ends[1] - ends[0]) / rest;
            let strain = (stretch * stretch - 1.0) * 0.5;
            strain * strain * (0.5 * c2 * rest)
        };
        x.windows(2).map(piece).reduce(|sum, part| sum + part).unwrap()
    }

    #[test]
    fn at_rest_a_rubber_band_s_hessian_over_c2_is_minus_the_laplacian_s_matrix() {
        let (n, c2) = (8, 3.7);
        let rest: [f64; 9] = std::array::from_fn(|k| k as f64 / n as f64);
        let band = hessian(|x| band(x, c2), rest);
        let domain = Domain::free(Elements::of(&bar(1.0, n).unwrap()).unwrap()).unwrap();
        let mut dense = vec![0.0; (n + 1) * (n + 1)];
        let mut sink = stationary_calculus::DenseSink::new(1.0, n + 1, &mut dense).unwrap();
        domain.dirichlet().add_hessian(&rest, &mut sink);
        let norm = dense.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (i, w) in dense.iter().enumerate() {
            assert!((band[(i % (n + 1), i / (n + 1))] / c2 - w).abs() < 1e-12 * norm);
        }
    }

    #[test]
    fn impossible_conditions_are_named() {
        let elements = || Elements::of(&bar(1.0, 2).unwrap()).unwrap();
        let held = |values: &[(usize, f64)]| Domain::held(elements(), values).unwrap_err();
        assert_eq!(held(&[(3, 0.0)]), LaplacianError::NoSuchVertex { vertex: 3, vertices: 3 });
        assert_eq!(held(&[(1, 0.0), (1, 0.0)]), LaplacianError::HeldTwice(1));
        assert_eq!(held(&[(0, 0.0), (1, 0.0), (2, 0.0)]), LaplacianError::NothingFree);
        assert!(matches!(held(&[(0, f64::NAN)]), LaplacianError::Parameter { .. }));
        let domain = Domain::free(elements()).unwrap();
        assert!(domain.on_vertices(&[1.0]).is_err());
        let short = laplacian(&domain.lumped().unwrap(), domain.dirichlet(), &[1.0]);
        assert!(matches!(short, Err(LaplacianError::Size(_))));
    }
}
