//! Dampers between vertices: what a spring resists because its length changes.
//!
//! ```text
//! l' = u . (v_1 - v_0)                       the rate of the length, m/s             (10.1.1)
//! D = 1/2 c l'^2,   F_1 = -c l' u = -F_0     watts, half of what is dissipated; newtons
//! -dF/dv = c u u^T (x) [1 -1; -1 1]          positive semidefinite
//! ```
//! `u` the unit vector from end 0 to end 1, `v` the ends' velocities, `c` in N s/m. Moving and turning
//! as a whole changes no length and is not felt, so that momentum and spin are kept. Vertices past the
//! free ones are fixed, as those of [`Stencils`](stationary_calculus::Stencils).
//!
//! Where the ends meet, the line between them has no direction, and the force has no limit that holds
//! for every way there. The ends are then taken to lie along their own relative velocity, as a moment
//! before and after on their way through each other:
//!
//! ```text
//! F_1 = -c (v_1 - v_0) = -F_0,    -dF/dv = c 1 (x) [1 -1; -1 1]      where the ends meet
//! ```
//! which on a line is what it is everywhere else. Source: notes 10.1.1.

use stationary_calculus::{Covector, FIXED, Force, Sink, UnknownVertex, Vector, array};

use crate::{ElasticityError, SpringError};

/// A damper between two vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damper {
    vertices: [usize; 2],
    viscosity: f64,
}

impl Damper {
    /// A damper of viscosity c, N s/m.
    ///
    /// # Errors
    /// [`ElasticityError::Spring`] where both ends are one vertex; [`ElasticityError::Damping`] for
    /// a viscosity that is negative or not finite.
    pub fn new(vertices: [usize; 2], viscosity: f64) -> Result<Self, ElasticityError> {
        if vertices[0] == vertices[1] {
            return Err(SpringError::Loop(vertices[0]).into());
        }
        if !(viscosity >= 0.0 && viscosity.is_finite()) {
            return Err(ElasticityError::Damping(viscosity));
        }
        Ok(Damper { vertices, viscosity })
    }
}

/// Dampers over the same vertices: a [`Force`].
#[derive(Clone, Debug, PartialEq)]
pub struct Dampers<const D: usize> {
    free: usize,
    fixed: Vec<[f64; D]>,
    dampers: Vec<Damper>,
}

impl<const D: usize> Dampers<D> {
    /// Dampers over `free` moving vertices, numbered from 0, and the fixed ones after them.
    ///
    /// # Errors
    /// [`UnknownVertex`] for the first damper that names a vertex which is neither free nor fixed.
    pub fn new(
        free: usize,
        fixed: Vec<[f64; D]>,
        dampers: Vec<Damper>,
    ) -> Result<Self, UnknownVertex> {
        let vertices = free.saturating_add(fixed.len());
        for (stencil, damper) in dampers.iter().enumerate() {
            if let Some(&vertex) = damper.vertices.iter().find(|&&vertex| vertex >= vertices) {
                return Err(UnknownVertex { stencil, vertex, vertices });
            }
        }
        Ok(Dampers { free, fixed, dampers })
    }

    /// The unit vector from one end to the other, unless they meet.
    fn direction(&self, damper: &Damper, q: &[[f64; D]]) -> Option<[f64; D]> {
        let [from, to] =
            damper.vertices.map(|v| if v < self.free { q[v] } else { self.fixed[v - self.free] });
        let apart: [f64; D] = array(|c| to[c] - from[c]);
        let square = apart.iter().map(|x| x * x).sum::<f64>();
        if !(SMALLEST_SQUARE..f64::INFINITY).contains(&square) {
            return far_from_one(apart);
        }
        let length = square.sqrt();
        Some(apart.map(|x| x / length))
    }
}

/// Below this the square of a length loses digits.
const SMALLEST_SQUARE: f64 = 1e-280;

/// The direction of a vector whose square is out of range, unless it is zero.
#[cold]
fn far_from_one<const D: usize>(apart: [f64; D]) -> Option<[f64; D]> {
    if apart.iter().all(|&x| x == 0.0) {
        return None;
    }
    let largest = apart.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let scaled = apart.map(|x| x / largest);
    let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
    Some(scaled.map(|x| x / length))
}

impl<const D: usize> Force for Dampers<D> {
    fn dim(&self) -> usize {
        D.saturating_mul(self.free)
    }

    /// NaN in every component where any of the three is too short.
    fn add_force(&self, _t: f64, q: &[f64], v: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        if q.len().min(v.0.len()).min(f.0.len()) < self.dim() {
            return f.0.fill(f64::NAN);
        }
        let (q, v) = (q.as_chunks::<D>().0, v.0.as_chunks::<D>().0);
        let f = f.0.as_chunks_mut::<D>().0;
        for damper in &self.dampers {
            let u = self.direction(damper, q);
            let [from, to] = damper.vertices.map(|a| if a < self.free { v[a] } else { [0.0; D] });
            let apart: [f64; D] = array(|c| to[c] - from[c]);
            let along = match u {
                Some(u) => {
                    let rate: f64 = u.iter().zip(&apart).map(|(u, v)| u * v).sum();
                    u.map(|u| rate * u)
                }
                None => apart,
            };
            for (&vertex, sign) in damper.vertices.iter().zip([1.0, -1.0]) {
                if vertex < self.free {
                    for c in 0..D {
                        f[vertex][c] += sign * damper.viscosity * along[c];
                    }
                }
            }
        }
    }

    fn add_damping(&self, _t: f64, q: &[f64], _v: Vector<&[f64]>, damping: &mut impl Sink) {
        if q.len() < self.dim() {
            return damping.add_symmetric(&[0], &[f64::NAN]);
        }
        let q = q.as_chunks::<D>().0;
        for damper in &self.dampers {
            let u = self.direction(damper, q);
            let freedoms = damper.vertices.map(|vertex| {
                array::<usize, D>(|c| if vertex < self.free { D * vertex + c } else { FIXED })
            });
            let mut block = [[[[0.0; D]; 2]; D]; 2];
            for (b, columns) in block.iter_mut().enumerate() {
                for (d, column) in columns.iter_mut().enumerate() {
                    for (a, rows) in column.iter_mut().enumerate() {
                        let c = if a == b { damper.viscosity } else { -damper.viscosity };
                        *rows = match u {
                            Some(u) => u.map(|entry| c * entry * u[d]),
                            None => array(|row| if row == d { c } else { 0.0 }),
                        };
                    }
                }
            }
            damping.add_vertices(&freedoms, &block);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use stationary_calculus::ProductSink;

    /// Three vertices, the last one fixed, joined in a triangle.
    fn triangle() -> Dampers<2> {
        let damper = |a, b, c| Damper::new([a, b], c).unwrap();
        let dampers = vec![damper(0, 1, 2.0), damper(1, 2, 3.0), damper(2, 0, 0.5)];
        Dampers::new(2, vec![[2.0, 0.5]], dampers).unwrap()
    }

    fn force(dampers: &Dampers<2>, q: &[f64], v: &[f64]) -> Vec<f64> {
        let mut f = vec![0.0; q.len()];
        dampers.add_force(0.0, q, Vector(v), Covector(&mut f));
        f
    }

    proptest! {
        #[test]
        fn dampers_take_power_and_their_matrix_is_minus_the_forces_slope(
            q in prop::array::uniform4(-1.0..1.0_f64), v in prop::array::uniform4(-1.0..1.0_f64),
        ) {
            let dampers = triangle();
            let f = force(&dampers, &q, &v);
            let power: f64 = f.iter().zip(&v).map(|(f, v)| f * v).sum();
            prop_assert!(power <= 1e-15);
            // The force is linear in the velocity: F = -C v.
            let mut product = vec![0.0; 4];
            let mut sink = ProductSink::new(1.0, &v, &mut product).unwrap();
            dampers.add_damping(0.0, &q, Vector(&v), &mut sink);
            for (f, product) in f.iter().zip(&product) {
                prop_assert!((f + product).abs() < 1e-14);
            }
        }

        #[test]
        fn motion_as_a_whole_is_not_damped(
            q in prop::array::uniform4(-1.0..1.0_f64), [x, y, spin] in prop::array::uniform3(-1.0..1.0_f64),
        ) {
            let alone = Dampers::<2>::new(2, vec![], vec![Damper::new([0, 1], 2.0).unwrap()]).unwrap();
            let v = [x - spin * q[1], y + spin * q[0], x - spin * q[3], y + spin * q[2]];
            prop_assert!(force(&alone, &q, &v).iter().all(|f| f.abs() < 1e-15));
            let f = force(&alone, &q, &[1.0, -0.3, 0.2, 0.4]);
            prop_assert_eq!([f[0], f[1]], [-f[2], -f[3]]);
        }
    }

    #[test]
    fn dampers_that_cannot_be_are_refused() {
        assert_eq!(Damper::new([3, 3], 1.0), Err(SpringError::Loop(3).into()));
        assert_eq!(Damper::new([0, 1], -1.0), Err(ElasticityError::Damping(-1.0)));
        assert!(Damper::new([0, 1], f64::NAN).is_err());
        let stray = Damper::new([0, 2], 1.0).unwrap();
        let error = Dampers::<3>::new(1, vec![[0.0; 3]], vec![stray]).unwrap_err();
        assert_eq!(error, UnknownVertex { stencil: 0, vertex: 2, vertices: 2 });
    }

    #[test]
    fn ends_that_meet_feel_their_whole_relative_velocity_and_no_force_is_nan() {
        let pair = Dampers::<2>::new(2, vec![], vec![Damper::new([0, 1], 2.0).unwrap()]).unwrap();
        let v = [0.5, -1.0, 1.5, 3.0];
        let met = force(&pair, &[0.3, 0.7, 0.3, 0.7], &v);
        assert_eq!(met, [2.0, 8.0, -2.0, -8.0]);
        // A moment before and after, on their way through each other.
        for t in [-1e-3, 1e-3] {
            let q = [0.3 + t * v[0], 0.7 + t * v[1], 0.3 + t * v[2], 0.7 + t * v[3]];
            let near = force(&pair, &q, &v);
            assert!(near.iter().zip(&met).all(|(a, b)| (a - b).abs() < 1e-12), "{near:?}");
        }
        let mut product = [0.0; 4];
        let mut sink = ProductSink::new(1.0, &v, &mut product).unwrap();
        pair.add_damping(0.0, &[0.3, 0.7, 0.3, 0.7], Vector(&v), &mut sink);
        assert_eq!(product, [-2.0, -8.0, 2.0, 8.0]);
    }

    #[test]
    fn the_direction_is_right_at_every_length() {
        let pair = Dampers::<2>::new(2, vec![], vec![Damper::new([0, 1], 2.0).unwrap()]).unwrap();
        for size in [1e-323, 1e-310, 1e-200, 1e-150, 1.0, 1e150, 1e200, 3e307] {
            let f = force(&pair, &[0.0, 0.0, size, 0.0], &[0.0, 0.0, 1.0, 1.0]);
            let off = [2.0, 0.0, -2.0, 0.0].iter().zip(&f).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-15, "{size:e}: {f:?}");
            let f = force(&pair, &[0.0, 0.0, 3.0 * size, 4.0 * size], &[0.0, 0.0, 1.0, 1.0]);
            let off = [1.68, 2.24].iter().zip(&f).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-14, "{size:e}: {f:?}");
        }
    }
}
