//! How far it is along a surface, from how heat spreads in a short time, with the error that makes.
//!
//! ```text
//! (M + t W) u_s = delta_s,   u = max_s u_s / u_s(s)       a little heat from each source s
//! X = -grad u / |grad u|                                  points away from the nearest source
//! W phi = int grad(.) . X                                 the function with that gradient
//! estimate = |phi - d|                                    d the shortest paths' length
//! ```
//! `u phi` functions on vertices, `t` the heat time (m^2), `phi d` metres. Each source is heated by
//! itself and measured against its own height, so that none is nearer for having a smaller cell. Heat
//! flows on the same surface with Delaunay edges and split obtuse boundary sides, so that it keeps its
//! sign; the answer is on the given vertices. In each piece `phi` is measured from the mean of the
//! sources there; where a piece has none, no path leads and the distance is infinite.
//!
//! What heat makes of a distance is smooth, costs two solves a source once the surface is factored,
//! and is off by a good part of an edge, or of the whole where the surface is a few edges wide. No
//! comparison of two heat times knows that error, so it is measured: by [`ShortestPaths`], whose
//! distances are exact on the triangles. Who wants those takes them from there; who wants heat's for
//! many sources, and no error, takes [`GeodesicDistance::unmeasured`].
//!
//! `u` falls like `exp(-distance / sqrt t)`: farther than about 690 `sqrt t` from all sources it is no
//! number any more, which is an error that says how long it takes. The square of the mean edge is
//! advised, longer on very long surfaces. Boundaries are insulated. Source: Crane, Weischedel and
//! Wardetzky 2013.

use stationary_calculus::SparseCholesky;
use stationary_mesh::{IntrinsicSurface, IntrinsicTriangle};

use crate::error::positive;
use crate::heat::Pencil;
use crate::poisson::Grounded;
use crate::{Domain, Elements, LaplacianError, ShortestPaths, heat_time};

/// Distances from sources on one surface, everything factored.
#[derive(Debug)]
pub struct GeodesicDistance {
    paths: ShortestPaths,
    domain: Domain<3>,
    shapes: Vec<Triangle>,
    /// For each vertex the first one of its piece.
    pieces: Vec<usize>,
    time: f64,
    heat: SparseCholesky,
    poisson: Grounded,
}

/// Distances and what they are worth.
#[derive(Clone, Debug, PartialEq)]
pub struct Distances {
    /// The distance of each vertex to the nearest source, metres; infinite where no path leads.
    pub distance: Vec<f64>,
    /// How far it is from the length of the shortest path along the triangles, metres.
    pub estimate: Vec<f64>,
}

/// Heat below this part of its height at the source may be rounding.
const FAINTEST: f64 = 1e-298;

/// Sources whose heat is solved for together: the factor is read once for all of them.
const AT_ONCE: usize = 16;

/// Rounding of the shortest paths, relative to the farthest.
const ROUNDING: f64 = 1e-12;

impl GeodesicDistance {
    /// The heat time that suits a surface: the square of its mean edge length, or longer where it is
    /// so many edges long that no heat would arrive.
    pub fn advised_time(surface: &IntrinsicSurface) -> f64 {
        heat_time::advised(surface)
    }

    /// Factors heat and Poisson's problem on a surface, for a heat time in m^2.
    ///
    /// # Errors
    /// Those of [`Elements::of_surface`], [`LaplacianError::Parameter`] and
    /// [`LaplacianError::Sparse`].
    pub fn new(surface: &IntrinsicSurface, time: f64) -> Result<Self, LaplacianError> {
        positive("the heat time", time)?;
        let paths = ShortestPaths::new(surface);
        let surface = refined(surface);
        let domain = Domain::free(Elements::of_surface(&surface)?)?;
        let metric = domain.lumped()?;
        let heat = Pencil::new(&metric, domain.dirichlet())?.factored(1.0, time)?;
        let poisson = Grounded::new(&domain)?;
        let shape = |(t, corners): (usize, &[usize; 3])| {
            let freedoms = corners.map(|vertex| domain.freedom(vertex).unwrap_or_default());
            Triangle::new(freedoms, surface.shape(t))
        };
        let shapes = surface.triangles().iter().enumerate().map(shape).collect();
        let pieces = domain.pieces();
        Ok(GeodesicDistance { paths, domain, shapes, pieces, time, heat, poisson })
    }

    /// The distance of every vertex to the nearest of these, and how far each is off.
    ///
    /// # Errors
    /// Those of [`GeodesicDistance::unmeasured`].
    pub fn from(&mut self, sources: &[usize]) -> Result<Distances, LaplacianError> {
        let distance = self.unmeasured(sources)?;
        let exact = self.paths.from(sources)?.distance;
        let finite = exact.iter().copied().filter(|d| d.is_finite());
        let rounding = ROUNDING * finite.fold(0.0, f64::max);
        let off = |(a, b): (&f64, &f64)| if a == b { rounding } else { (a - b).abs() + rounding };
        let estimate = distance.iter().zip(&exact).map(off).collect();
        Ok(Distances { distance, estimate })
    }

    /// The distance of every vertex to the nearest of these as heat has it: for the cost of two
    /// solves a source, and without a word on its error.
    ///
    /// # Errors
    /// [`LaplacianError::NoSources`], [`LaplacianError::NoSuchVertex`],
    /// [`LaplacianError::Underflow`], [`LaplacianError::LostSign`] and
    /// [`LaplacianError::NonFinite`].
    pub fn unmeasured(&mut self, sources: &[usize]) -> Result<Vec<f64>, LaplacianError> {
        let vertices = self.paths.vertices();
        if sources.is_empty() {
            return Err(LaplacianError::NoSources);
        }
        if let Some(&vertex) = sources.iter().find(|&&vertex| vertex >= vertices) {
            return Err(LaplacianError::NoSuchVertex { vertex, vertices });
        }
        // Sources of each piece, by its first vertex: their sum of phi and their number.
        let mut zeros = vec![(0.0, 0_usize); self.pieces.len()];
        sources.iter().for_each(|&source| zeros[self.pieces[source]].1 += 1);
        let u = self.warmth(sources, &zeros)?;
        let mut phi = vec![0.0; u.len()];
        self.shapes.iter().for_each(|shape| shape.add_flux(&u, &mut phi));
        self.poisson.solve(&mut phi);
        crate::error::check_finite(&phi)?;
        for &source in sources {
            if let Some(freedom) = self.domain.freedom(source) {
                zeros[self.pieces[source]].0 += phi[freedom];
            }
        }
        let from_sources = |vertex: usize| match zeros[self.pieces[vertex]] {
            (_, 0) => f64::INFINITY,
            (sum, count) => {
                let here = self.domain.freedom(vertex).map_or(0.0, |freedom| phi[freedom]);
                (here - sum / count as f64).max(0.0)
            }
        };
        let mut distance: Vec<f64> = (0..vertices).map(from_sources).collect();
        sources.iter().for_each(|&source| distance[source] = 0.0);
        Ok(distance)
    }

    /// Heat from each source, one at its own, on the freedoms.
    fn warmth(
        &mut self,
        sources: &[usize],
        zeros: &[(f64, usize)],
    ) -> Result<Vec<f64>, LaplacianError> {
        let n = self.domain.dim();
        let mut warmest = vec![0.0_f64; n];
        let places: Vec<usize> = sources.iter().filter_map(|&s| self.domain.freedom(s)).collect();
        for together in places.chunks(AT_ONCE) {
            let mut heats = vec![0.0; n * together.len()];
            for (u, &source) in heats.chunks_exact_mut(n).zip(together) {
                u[source] = 1.0;
            }
            self.heat.solve(&mut heats);
            for (u, &source) in heats.chunks_exact(n).zip(together) {
                for (warmest, value) in warmest.iter_mut().zip(u) {
                    *warmest = warmest.max(value / u[source]);
                }
            }
        }
        places.iter().for_each(|&source| warmest[source] = 1.0);
        let is_cold = |&(freedom, vertex): &(usize, &usize)| {
            let u = warmest[freedom];
            zeros[self.pieces[*vertex]].1 > 0 && (u.is_nan() || u < FAINTEST)
        };
        let free = self.domain.free_vertices().iter().enumerate();
        let cold: Vec<usize> = free.filter(is_cold).map(|(_, &vertex)| vertex).collect();
        match cold.first() {
            None => Ok(warmest),
            Some(&vertex) => Err(self.why_cold(sources, vertex, cold.len())),
        }
    }

    /// Whether heat had too little time, or took both signs.
    fn why_cold(&self, sources: &[usize], vertex: usize, count: usize) -> LaplacianError {
        let distance = match self.paths.from(sources) {
            Ok(found) => found.distance,
            Err(error) => return error,
        };
        let finite = distance.into_iter().filter(|d| d.is_finite());
        let enough = heat_time::reaching(finite.fold(0.0, f64::max));
        if enough > self.time {
            LaplacianError::Underflow { vertex, count, time: self.time, enough }
        } else {
            LaplacianError::LostSign { vertex, count }
        }
    }
}

/// The same surface with edges on which heat keeps its sign, as far as they are found.
fn refined(surface: &IntrinsicSurface) -> IntrinsicSurface {
    let mut refined = surface.clone();
    // Where not all is mended, heat takes both signs at worst, and says so.
    let done = refined.split_obtuse_boundary().is_ok() || refined.flip_to_delaunay().is_ok();
    // On a surface of few triangles one of them may come to name a vertex twice.
    let is_simple = |&[a, b, c]: &[usize; 3]| a != b && b != c && c != a;
    if done && refined.triangles().iter().all(is_simple) { refined } else { surface.clone() }
}

/// A triangle in a plane of its own: the gradients of its corners' hats, and its area.
#[derive(Clone, Copy, Debug)]
struct Triangle {
    corners: [usize; 3],
    gradients: [[f64; 2]; 3],
    area: f64,
}

impl Triangle {
    fn new(corners: [usize; 3], shape: IntrinsicTriangle) -> Self {
        let ([a, b, c], area) = (shape.lengths(), shape.area());
        // Corner 0 at the origin, corner 1 on the first axis.
        let along = (a + (c - b) * ((c + b) / a)) / 2.0;
        let height = 2.0 * area / a;
        let gradients = [
            [-1.0 / a, (along - a) / (a * height)],
            [1.0 / a, -along / (a * height)],
            [0.0, 1.0 / height],
        ];
        Triangle { corners, gradients, area }
    }

    /// Adds the integrals of the hats' gradients with the direction away from the heat.
    fn add_flux(&self, u: &[f64], flux: &mut [f64]) {
        let u = self.corners.map(|vertex| u[vertex]);
        // Only the direction counts: by its largest value, none of the products underflows. By
        // differences, values that are equal have no direction, where their sum has that of rounding.
        let largest = u.iter().copied().fold(0.0, f64::max);
        let rise = [1, 2].map(|k| (u[k] - u[0]) / largest);
        let gradient =
            [0, 1].map(|c| rise[0] * self.gradients[1][c] + rise[1] * self.gradients[2][c]);
        let size = gradient[0].hypot(gradient[1]);
        if size > 0.0 {
            for (&vertex, hat) in self.corners.iter().zip(&self.gradients) {
                let along = hat[0] * gradient[0] + hat[1] * gradient[1];
                flux[vertex] -= self.area * along / size;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Vector2, Vector3};
    use stationary_mesh::{Diagonals, Mesh, disc, icosphere, rectangle};

    fn measure(surface: &IntrinsicSurface, sources: &[usize]) -> Distances {
        let time = GeodesicDistance::advised_time(surface);
        GeodesicDistance::new(surface, time).unwrap().from(sources).unwrap()
    }

    /// Largest error over the largest distance, and the same for the estimate.
    fn errors(got: &Distances, exact: &[f64]) -> (f64, f64) {
        let farthest = exact.iter().copied().fold(0.0, f64::max);
        let off = got.distance.iter().zip(exact).map(|(d, e)| (d - e).abs()).fold(0.0, f64::max);
        let estimate = got.estimate.iter().copied().fold(0.0, f64::max);
        (off / farthest, estimate / farthest)
    }

    /// The error on a plane disc, a sphere and a flat torus of some fineness, and the estimate.
    fn three_surfaces(fine: u32) -> [(f64, f64); 3] {
        let flat = disc(1.0, 8 << fine).unwrap();
        let exact: Vec<f64> = flat.vertices().iter().map(|x| x.norm()).collect();
        let on_disc = errors(&measure(&IntrinsicSurface::of(&flat).unwrap(), &[0]), &exact);
        let ball = icosphere(1.0, 2 + fine as usize).unwrap();
        let pole = ball.vertices()[0];
        let exact: Vec<f64> = ball.vertices().iter().map(|x| x.angle(&pole)).collect();
        let on_ball = errors(&measure(&IntrinsicSurface::of(&ball).unwrap(), &[0]), &exact);
        let n = 12 << fine;
        let torus = IntrinsicSurface::flat_torus([1.0, 1.0], [n, n]).unwrap();
        let around = |k: usize| (k as f64 / n as f64).min(1.0 - k as f64 / n as f64);
        let exact: Vec<f64> = (0..n * n).map(|v| around(v % n).hypot(around(v / n))).collect();
        [on_disc, on_ball, errors(&measure(&torus, &[0]), &exact)]
    }

    #[test]
    fn distances_approach_the_exact_ones_with_the_mesh_size_and_the_estimate_says_how_far_they_are()
    {
        let (coarse, fine) = (three_surfaces(1), three_surfaces(2));
        for (surface, (coarse, fine)) in coarse.into_iter().zip(fine).enumerate() {
            let order = (coarse.0 / fine.0).log2();
            assert!(order > 0.5, "surface {surface}: order {order}");
            assert!(fine.0 < 0.05, "surface {surface}: {}", fine.0);
            for (error, estimate) in [coarse, fine] {
                // What a sphere of triangles is off the round one is no part of the estimate.
                assert!(estimate > 0.8 * error && estimate < 1.2 * error, "{error} {estimate}");
            }
        }
    }

    #[test]
    fn several_sources_of_unequal_cells_are_met_without_bias() {
        // Vertices crowd towards the left: a source there has a far smaller cell.
        let mesh = rectangle([1.0, 1.0], [40, 24], Diagonals::Crossed).unwrap();
        let mesh = mesh.mapped(|x| Vector2::new(x.x * (0.3 + 0.7 * x.x), x.y)).unwrap();
        let nearest = |x: f64, y: f64| {
            let off = |k: &usize| (mesh.vertices()[*k] - Vector2::new(x, y)).norm();
            (0..mesh.vertices().len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap()
        };
        let sources = [nearest(0.05, 0.5), nearest(0.95, 0.5)];
        let mut surface = IntrinsicSurface::of(&mesh).unwrap();
        surface.flip_to_delaunay().unwrap();
        let got = measure(&surface, &sources);
        assert!(sources.iter().all(|&s| got.distance[s].abs() < 0.02));
        let places = sources.map(|s| mesh.vertices()[s]);
        for (x, d) in mesh.vertices().iter().zip(&got.distance) {
            let exact = (x - places[0]).norm().min((x - places[1]).norm());
            assert!((d - exact).abs() < 0.05, "{x:?}: {d} {exact}");
        }
    }

    #[test]
    fn a_time_too_short_to_arrive_is_an_error_and_a_longer_one_is_not() {
        let strip = rectangle([60.0, 0.2], [600, 2], Diagonals::Alternating).unwrap();
        let surface = IntrinsicSurface::of(&strip).unwrap();
        let mut short = GeodesicDistance::new(&surface, 1e-6).unwrap();
        let error = short.from(&[0]).unwrap_err();
        let LaplacianError::Underflow { count, enough, .. } = error else { panic!("{error}") };
        assert!(count > 100);
        for time in [enough, 0.02] {
            let mut long = GeodesicDistance::new(&surface, time).unwrap();
            let far = long.from(&[0]).unwrap().distance[600];
            assert!((far / 60.0 - 1.0).abs() < 0.05, "{far}");
        }
    }

    #[test]
    fn sources_in_two_pieces_are_each_measured_in_their_own() {
        let one = rectangle([1.0, 1.0], [10, 10], Diagonals::Alternating).unwrap();
        let other = rectangle([3.0, 1.0], [7, 5], Diagonals::Same).unwrap();
        let both = one.beside(&other.mapped(|x| x.add_scalar(5.0)).unwrap());
        let (n, sources) = (one.vertices().len(), [60, 140]);
        let alone = |mesh: &Mesh<2, 3>, source: usize| {
            let surface = IntrinsicSurface::of(mesh).unwrap();
            GeodesicDistance::new(&surface, 0.02).unwrap().from(&[source]).unwrap().distance
        };
        let expected = [alone(&one, sources[0]), alone(&other, sources[1] - n)].concat();
        let surface = IntrinsicSurface::of(&both).unwrap();
        let found = GeodesicDistance::new(&surface, 0.02).unwrap().from(&sources).unwrap().distance;
        assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn a_piece_without_a_source_is_infinitely_far() {
        let ball = icosphere(1.0, 1).unwrap();
        let apart = ball.beside(&ball.mapped(|x| x + Vector3::repeat(9.0)).unwrap());
        let surface = IntrinsicSurface::of(&apart).unwrap();
        let found = GeodesicDistance::new(&surface, 0.1).unwrap().from(&[0]).unwrap();
        assert!(found.distance[..42].iter().all(|d| d.is_finite()));
        assert!(found.distance[42..].iter().all(|d| *d == f64::INFINITY));
        assert!(found.estimate.iter().all(|e| e.is_finite()));
    }

    #[test]
    fn sources_that_fill_an_area_are_at_no_distance_and_leave_the_others_theirs() {
        let mesh = rectangle([4.0, 1.0], [40, 10], Diagonals::Alternating).unwrap();
        let sources: Vec<usize> =
            (0..mesh.vertices().len()).filter(|&v| mesh.vertices()[v].x < 1.0 + 1e-9).collect();
        let found = measure(&IntrinsicSurface::of(&mesh).unwrap(), &sources);
        assert!(sources.iter().all(|&s| found.distance[s] == 0.0));
        for (x, d) in mesh.vertices().iter().zip(&found.distance) {
            assert!((d - (x.x - 1.0).max(0.0)).abs() < 0.06, "{x:?}: {d}");
        }
        let all: Vec<usize> = (0..mesh.vertices().len()).collect();
        let found = measure(&IntrinsicSurface::of(&mesh).unwrap(), &all);
        assert!(found.distance.iter().chain(&found.estimate).all(|d| *d == 0.0));
    }

    #[test]
    fn a_sheared_square_has_distances_with_their_error() {
        let square = rectangle([1.0, 1.0], [12, 12], Diagonals::Same).unwrap();
        let sheared = square.mapped(|x| Vector2::new(x.x - 3.0 * x.y, x.y)).unwrap();
        let found = measure(&IntrinsicSurface::of(&sheared).unwrap(), &[0]);
        for (x, (d, e)) in sheared.vertices().iter().zip(found.distance.iter().zip(&found.estimate))
        {
            assert!(((d - x.norm()).abs() - e).abs() < 1e-9, "{x:?}: {d} {e}");
        }
    }

    #[test]
    fn on_thin_rectangles_the_stated_error_of_each_vertex_is_its_true_one() {
        for stretch in [10.0, 100.0, 1000.0] {
            let mesh = rectangle([stretch, 1.0], [30, 4], Diagonals::Alternating).unwrap();
            let found = measure(&IntrinsicSurface::of(&mesh).unwrap(), &[0]);
            let pairs = found.distance.iter().zip(&found.estimate);
            for (x, (d, estimate)) in mesh.vertices().iter().zip(pairs) {
                assert!(((d - x.norm()).abs() - estimate).abs() < 1e-9 * stretch);
            }
        }
    }

    #[test]
    fn bad_sources_are_named() {
        let ball = icosphere(1.0, 1).unwrap();
        let surface = IntrinsicSurface::of(&ball).unwrap();
        let mut distance = GeodesicDistance::new(&surface, 0.1).unwrap();
        assert_eq!(distance.from(&[]), Err(LaplacianError::NoSources));
        let error = LaplacianError::NoSuchVertex { vertex: 42, vertices: 42 };
        assert_eq!(distance.from(&[0, 42]), Err(error));
        assert!(GeodesicDistance::new(&surface, -1.0).is_err());
    }
}
