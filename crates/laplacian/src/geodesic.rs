//! How far it is along a surface, from how heat spreads in a short time.
//!
//! ```text
//! (M + t W) u_s = delta_s,   u = max_s u_s / u_s(s)       a little heat from each source s
//! X = -grad u / |grad u|                                  points away from the nearest source
//! W phi = int grad(.) . X                                 the function with that gradient
//! estimate = 2 |phi(t) - phi(4 t)| + 2 max |phi - l|       l the edges at the sources
//! ```
//! `u phi` functions on vertices, `t` the heat time (m^2), `phi` metres. Each source is heated by
//! itself and measured against its own height, so that none is nearer for having a smaller cell.
//! `u` falls like `exp(-distance / sqrt t)`: farther than about 690 `sqrt t` from all sources it
//! is no number any more, which is an error that says so and not a distance. The error has two
//! parts: what a longer time changes, and what is wrong next to the sources, where edges are
//! straight lines of known length; twice their sum is the estimate. A short time shows the mesh,
//! a long one smooths; the square of the mean edge is advised, longer on very long surfaces, and
//! edges that are Delaunay.
//! Boundaries are insulated. Source: Crane, Weischedel and Wardetzky 2013.

use stationary_calculus::SparseCholesky;
use stationary_mesh::{IntrinsicSurface, IntrinsicTriangle};

use crate::error::positive;
use crate::heat::Pencil;
use crate::poisson::Grounded;
use crate::{Domain, Elements, LaplacianError, heat_time};

/// Distances from sources on one surface, everything factored.
#[derive(Debug)]
pub struct GeodesicDistance {
    domain: Domain<3>,
    shapes: Vec<Triangle>,
    time: f64,
    /// Heat at t and at 4 t.
    heat: [SparseCholesky; 2],
    poisson: Grounded,
}

/// Distances and what they are worth.
#[derive(Clone, Debug, PartialEq)]
pub struct Distances {
    /// The distance of each vertex to the nearest source, metres.
    pub distance: Vec<f64>,
    /// How far it may be off, metres: an estimate, no bound.
    pub estimate: Vec<f64>,
}

/// Heat below this part of its height at the source may be rounding.
const FAINTEST: f64 = 1e-298;

/// Sources whose heat is solved for together: the factor is read once for all of them.
const AT_ONCE: usize = 16;

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
        let domain = Domain::free(Elements::of_surface(surface)?)?;
        let metric = domain.lumped()?;
        let mut pencil = Pencil::new(&metric, domain.dirichlet())?;
        let near = pencil.factored(1.0, time)?;
        let far = pencil.factored_like(&near, 1.0, 4.0 * time)?;
        let poisson = Grounded::new(&domain)?;
        let numbered = surface.triangles().iter().enumerate();
        let shapes = numbered.map(|(t, &corners)| Triangle::new(corners, surface.shape(t)));
        let shapes = shapes.collect();
        Ok(GeodesicDistance { domain, shapes, time, heat: [near, far], poisson })
    }

    /// The distance of every vertex to the nearest of these.
    ///
    /// # Errors
    /// [`LaplacianError::NoSources`], [`LaplacianError::NoSuchVertex`] and
    /// [`LaplacianError::Underflow`].
    pub fn from(&mut self, sources: &[usize]) -> Result<Distances, LaplacianError> {
        let vertices = self.domain.dim();
        if sources.is_empty() {
            return Err(LaplacianError::NoSources);
        }
        if let Some(&vertex) = sources.iter().find(|&&vertex| vertex >= vertices) {
            return Err(LaplacianError::NoSuchVertex { vertex, vertices });
        }
        let distance = self.distance(0, sources)?;
        let other = self.distance(1, sources)?;
        let offset = self.error_at_sources(&distance, sources);
        let pairs = distance.iter().zip(&other);
        let estimate = pairs.map(|(a, b)| 2.0 * ((a - b).abs() + offset)).collect();
        Ok(Distances { distance, estimate })
    }

    /// By how much the distance along edges from the sources is wrong: those are straight lines of
    /// known lengths.
    fn error_at_sources(&self, distance: &[f64], sources: &[usize]) -> f64 {
        let mut worst = 0.0_f64;
        for shape in &self.shapes {
            for k in 0..3 {
                let ends = [shape.corners[k], shape.corners[(k + 1) % 3]];
                for [from, to] in [ends, [ends[1], ends[0]]] {
                    if sources.contains(&from) && !sources.contains(&to) {
                        worst = worst.max((distance[to] - shape.lengths[k]).abs());
                    }
                }
            }
        }
        worst
    }

    fn distance(&mut self, heat: usize, sources: &[usize]) -> Result<Vec<f64>, LaplacianError> {
        let u = self.warmth(heat, sources)?;
        let mut phi = vec![0.0; u.len()];
        self.shapes.iter().for_each(|shape| shape.add_flux(&u, &mut phi));
        self.poisson.solve(&mut phi);
        crate::error::check_finite(&phi)?;
        let at_sources = sources.iter().map(|&s| phi[s]).sum::<f64>() / sources.len() as f64;
        phi.iter_mut().for_each(|value| *value -= at_sources);
        Ok(phi)
    }

    /// Heat from each source, one at its own.
    fn warmth(&mut self, heat: usize, sources: &[usize]) -> Result<Vec<f64>, LaplacianError> {
        let n = self.domain.dim();
        let mut warmest = vec![0.0_f64; n];
        for together in sources.chunks(AT_ONCE) {
            let mut heats = vec![0.0; n * together.len()];
            for (u, &source) in heats.chunks_exact_mut(n).zip(together) {
                u[source] = 1.0;
            }
            self.heat[heat].solve(&mut heats);
            for (u, &source) in heats.chunks_exact(n).zip(together) {
                for (warmest, value) in warmest.iter_mut().zip(u) {
                    *warmest = warmest.max(value / u[source]);
                }
            }
        }
        let cold = |u: &f64| u.is_nan() || *u < FAINTEST;
        match warmest.iter().position(cold) {
            None => Ok(warmest),
            Some(vertex) => {
                let count = warmest.iter().filter(|u| cold(u)).count();
                let time = self.time * if heat == 0 { 1.0 } else { 4.0 };
                Err(LaplacianError::Underflow { vertex, count, time })
            }
        }
    }
}

/// A triangle in a plane of its own: the gradients of its corners' hats, and its area.
#[derive(Clone, Copy, Debug)]
struct Triangle {
    corners: [usize; 3],
    lengths: [f64; 3],
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
        Triangle { corners, lengths: [a, b, c], gradients, area }
    }

    /// Adds the integrals of the hats' gradients with the direction away from the heat.
    fn add_flux(&self, u: &[f64], flux: &mut [f64]) {
        let u = self.corners.map(|vertex| u[vertex]);
        // Only the direction counts: by its largest value, none of the products underflows.
        let largest = u.iter().copied().fold(0.0, f64::max);
        let gradient = [0, 1].map(|c| {
            let part = |k: usize| (u[k] / largest) * self.gradients[k][c];
            part(0) + part(1) + part(2)
        });
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
    use stationary_mesh::{Diagonals, disc, icosphere, rectangle};

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
                assert!(estimate > error && estimate < 4.0 * error, "{error} {estimate}");
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
        assert!(matches!(error, LaplacianError::Underflow { count, .. } if count > 100), "{error}");
        let mut enough = GeodesicDistance::new(&surface, 0.02).unwrap();
        let far = enough.from(&[0]).unwrap().distance[600];
        assert!((far / 60.0 - 1.0).abs() < 0.05, "{far}");
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
        let apart = ball.beside(&ball.mapped(|x| x + Vector3::repeat(9.0)).unwrap());
        let surface = IntrinsicSurface::of(&apart).unwrap();
        let error = GeodesicDistance::new(&surface, 0.1).unwrap().from(&[0]).unwrap_err();
        assert!(matches!(error, LaplacianError::Underflow { vertex: 42, count: 42, .. }));
    }
}
