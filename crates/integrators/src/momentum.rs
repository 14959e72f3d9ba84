//! Linear and angular momentum of particles.
//!
//! ```text
//! P = sum_i p_i                  kg m/s
//! L = sum_i q_i x p_i            kg m^2/s, about the origin
//! ```
//! A drift is judged against the sums of the magnitudes, `sum |p_i|` and `sum |q_i| |p_i|`: that is
//! what rounding scales with. Source: notes 4.5.

use crate::State;

/// The linear momentum of particles in D dimensions.
pub fn linear_momentum<const D: usize>(state: &State<impl AsRef<[f64]>>) -> [f64; D] {
    let mut sum = [0.0; D];
    for p in state.p.components().as_chunks::<D>().0 {
        for (sum, p) in sum.iter_mut().zip(p) {
            *sum += p;
        }
    }
    sum
}

/// The sum of the particles' `|p_i|`, against which a drift of linear momentum is judged.
pub fn linear_momentum_scale<const D: usize>(state: &State<impl AsRef<[f64]>>) -> f64 {
    state.p.components().as_chunks::<D>().0.iter().map(norm).sum()
}

/// The angular momentum about the origin of particles in D = 1, 2 or 3 dimensions, as a vector in
/// space: along the third axis in the plane, zero on a line.
pub fn angular_momentum<const D: usize>(state: &State<impl AsRef<[f64]>>) -> [f64; 3] {
    let in_space =
        |x: &[f64; D]| -> [f64; 3] { std::array::from_fn(|c| x.get(c).copied().unwrap_or(0.0)) };
    let mut sum = [0.0; 3];
    let (q, p) = (state.q.as_ref().as_chunks::<D>().0, state.p.components().as_chunks::<D>().0);
    for (q, p) in q.iter().zip(p) {
        let (q, p) = (in_space(q), in_space(p));
        for (c, sum) in sum.iter_mut().enumerate() {
            let (a, b) = ((c + 1) % 3, (c + 2) % 3);
            *sum += q[a] * p[b] - q[b] * p[a];
        }
    }
    sum
}

/// The sum of `|q_i| |p_i|`, against which a drift of angular momentum is judged.
pub fn angular_momentum_scale<const D: usize>(state: &State<impl AsRef<[f64]>>) -> f64 {
    let (q, p) = (state.q.as_ref().as_chunks::<D>().0, state.p.components().as_chunks::<D>().0);
    q.iter().zip(p).map(|(q, p)| norm(q) * norm(p)).sum()
}

fn norm<const D: usize>(x: &[f64; D]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}
