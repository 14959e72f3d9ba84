//! Linear and angular momentum of particles: the momentum maps of translations and rotations.
//!
//! ```text
//! translation   xi_i = d             J = sum_i <p_i, d>           kg m/s
//! rotation      xi_i = w x q_i       J = <w, sum_i q_i x p_i>     kg m^2/s, about the origin
//! P = sum_i p_i,    L = sum_i q_i x p_i
//! ```
//! `q_i p_i` positions and momenta of particles in D dimensions, `d` a direction, `w` an axis. P and
//! L are the momentum maps along and about the axes of space.
//!
//! A drift is judged against the sums of the magnitudes, `sum |p_i|` and `sum |q_i| |p_i|`: that is
//! what rounding scales with. Source: notes 4.5, 8.3.

use stationary_calculus::{Covector, Vector, array};

use crate::{State, Symmetry};

/// All particles move along a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Translation<const D: usize> {
    /// The direction, in metres per unit of the symmetry's parameter.
    pub direction: [f64; D],
}

impl<const D: usize> Symmetry for Translation<D> {
    fn generator(&self, _q: &[f64], xi: Vector<&mut [f64]>) {
        xi.0.as_chunks_mut::<D>().0.fill(self.direction);
    }

    fn generator_along(&self, _q: &[f64], _v: Vector<&[f64]>, dxi: Vector<&mut [f64]>) {
        dxi.0.fill(0.0);
    }

    fn momentum(&self, _q: &[f64], p: Covector<&[f64]>) -> f64 {
        let along =
            |p: &[f64; D]| -> f64 { p.iter().zip(self.direction).map(|(p, d)| p * d).sum() };
        p.0.as_chunks::<D>().0.iter().map(along).sum()
    }
}

/// All particles turn about an axis through the origin, in D = 1, 2 or 3 dimensions: the plane turns
/// about the third axis, a line does not turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation<const D: usize> {
    /// The axis, in radians per unit of the symmetry's parameter.
    pub axis: [f64; 3],
}

impl<const D: usize> Rotation<D> {
    /// `w x q`.
    fn turn(&self, q: &[f64; D]) -> [f64; D] {
        let (w, q) = (self.axis, in_space(q));
        array(|c| {
            let (a, b) = ((c + 1) % 3, (c + 2) % 3);
            w[a] * q[b] - w[b] * q[a]
        })
    }
}

impl<const D: usize> Symmetry for Rotation<D> {
    fn generator(&self, q: &[f64], xi: Vector<&mut [f64]>) {
        let particles = xi.0.as_chunks_mut::<D>().0.iter_mut().zip(q.as_chunks::<D>().0);
        particles.for_each(|(xi, q)| *xi = self.turn(q));
    }

    /// The generator is linear in q.
    fn generator_along(&self, _q: &[f64], v: Vector<&[f64]>, dxi: Vector<&mut [f64]>) {
        self.generator(v.0, dxi);
    }

    fn momentum(&self, q: &[f64], p: Covector<&[f64]>) -> f64 {
        let about = |(q, p): (&[f64; D], &[f64; D])| -> f64 {
            self.turn(q).iter().zip(p).map(|(xi, p)| xi * p).sum()
        };
        q.as_chunks::<D>().0.iter().zip(p.0.as_chunks::<D>().0).map(about).sum()
    }
}

fn in_space<const D: usize>(x: &[f64; D]) -> [f64; 3] {
    array(|c| x.get(c).copied().unwrap_or(0.0))
}

fn unit<const D: usize>(axis: usize) -> [f64; D] {
    array(|c| if c == axis { 1.0 } else { 0.0 })
}

/// The linear momentum of particles in D dimensions.
pub fn linear_momentum<const D: usize>(state: &State<impl AsRef<[f64]>>) -> [f64; D] {
    let along = |c| Translation::<D> { direction: unit(c) };
    array(|c| along(c).momentum(state.q.as_ref(), state.p.view()))
}

/// The sum of the particles' `|p_i|`, against which a drift of linear momentum is judged.
pub fn linear_momentum_scale<const D: usize>(state: &State<impl AsRef<[f64]>>) -> f64 {
    state.p.components().as_chunks::<D>().0.iter().map(norm).sum()
}

/// The angular momentum about the origin of particles in D = 1, 2 or 3 dimensions, as a vector in
/// space: along the third axis in the plane, zero on a line.
pub fn angular_momentum<const D: usize>(state: &State<impl AsRef<[f64]>>) -> [f64; 3] {
    let about = |c| Rotation::<D> { axis: unit(c) };
    array(|c| about(c).momentum(state.q.as_ref(), state.p.view()))
}

/// The sum of `|q_i| |p_i|`, against which a drift of angular momentum is judged.
pub fn angular_momentum_scale<const D: usize>(state: &State<impl AsRef<[f64]>>) -> f64 {
    let (q, p) = (state.q.as_ref().as_chunks::<D>().0, state.p.components().as_chunks::<D>().0);
    q.iter().zip(p).map(|(q, p)| norm(q) * norm(p)).sum()
}

fn norm<const D: usize>(x: &[f64; D]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The momentum map that the trait provides, from the generator alone.
    struct ByGenerator<S>(S);

    impl<S: Symmetry> Symmetry for ByGenerator<S> {
        fn generator(&self, q: &[f64], xi: Vector<&mut [f64]>) {
            self.0.generator(q, xi);
        }

        fn generator_along(&self, q: &[f64], v: Vector<&[f64]>, dxi: Vector<&mut [f64]>) {
            self.0.generator_along(q, v, dxi);
        }
    }

    proptest! {
        #[test]
        fn the_momentum_map_is_the_momentum_on_the_generator(
            q in prop::array::uniform6(-2.0..2.0), p in prop::array::uniform6(-2.0..2.0),
            w in prop::array::uniform3(-1.0..1.0),
        ) {
            let p = Covector(p);
            let close = |a: f64, b: f64| (a - b).abs() < 1e-13;
            let turn = Rotation::<3> { axis: w };
            let along = Translation::<3> { direction: w };
            let by_generator = ByGenerator(turn).momentum(&q, p.view());
            prop_assert!(close(turn.momentum(&q, p.view()), by_generator));
            let by_generator = ByGenerator(along).momentum(&q, p.view());
            prop_assert!(close(along.momentum(&q, p.view()), by_generator));
        }

        #[test]
        fn angular_momentum_is_the_sum_of_the_cross_products(
            q in prop::array::uniform6(-2.0..2.0), p in prop::array::uniform6(-2.0..2.0),
        ) {
            let of = |q: &[f64], p: &[f64], a: usize, b: usize| q[a] * p[b] - q[b] * p[a];
            let expected = [(1, 2), (2, 0), (0, 1)]
                .map(|(a, b)| of(&q[..3], &p[..3], a, b) + of(&q[3..], &p[3..], a, b));
            let measured = angular_momentum::<3>(&State::new(q, Covector(p)));
            prop_assert!((0..3).all(|c| (measured[c] - expected[c]).abs() < 1e-13));
            let flat = angular_momentum::<2>(&State::new(q, Covector(p)));
            let expected: f64 = [0, 2, 4].iter().map(|&i| of(&q[i..], &p[i..], 0, 1)).sum();
            prop_assert!(flat[0] == 0.0 && flat[1] == 0.0 && (flat[2] - expected).abs() < 1e-13);
        }
    }

    #[test]
    fn a_line_does_not_turn() {
        assert_eq!(angular_momentum::<1>(&State::new([1.0, 2.0], Covector([3.0, 4.0]))), [0.0; 3]);
    }
}
