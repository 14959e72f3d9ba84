//! What the last iterations showed of a system's true differential, where the one they use is far off.
//!
//! ```text
//! x_k+1 = x_k + d + S^-1 (g_k + G)     d, G a combination of earlier moves and of what they changed,
//!                                      such that |g_k + G| is least
//! ```
//! `S` the approximate differential, `x` multipliers (m), `g` values in reference scales (m). Where S errs in a few
//! directions only, as many moves teach them. A move that makes values grow is taken back in part.
//! Source: Anderson (1965); Walker and Ni (2011).

/// Moves that are remembered; then the memory starts again from the last.
const MEMORY: usize = 4;
/// A change with less than this part that is new says nothing new.
const NEW: f64 = 1e-3;

/// A few moves, made orthonormal in what they changed.
#[derive(Clone, Debug)]
pub(crate) struct Secants<N> {
    changes: [N; MEMORY],
    moves: [N; MEMORY],
    known: usize,
    /// The values from which the last move went, in reference scales.
    given: N,
    /// The last move.
    pub(crate) last: N,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(to: &mut [f64], scale: f64, what: &[f64]) {
    to.iter_mut().zip(what).for_each(|(to, what)| *to += scale * what);
}

impl<N: AsRef<[f64]> + AsMut<[f64]> + Clone> Secants<N> {
    pub(crate) fn new(numbers: &N) -> Self {
        let several = || std::array::from_fn(|_| numbers.clone());
        let (given, last) = (numbers.clone(), numbers.clone());
        Secants { changes: several(), moves: several(), known: 0, given, last }
    }

    pub(crate) fn forget(&mut self) {
        self.known = 0;
    }

    /// Learns from the last move, which led to these values.
    pub(crate) fn learn(&mut self, values: &[f64]) {
        if self.known == MEMORY {
            self.known = 0;
        }
        let Secants { changes, moves, known, given, last } = self;
        let write = |change: &mut [f64], own: &mut [f64]| {
            change.copy_from_slice(values);
            add(change, -1.0, given.as_ref());
            own.copy_from_slice(last.as_ref());
        };
        let (before, rest) = changes.split_at_mut(*known);
        let (earlier, others) = moves.split_at_mut(*known);
        let (change, own) = (rest[0].as_mut(), others[0].as_mut());
        write(change, own);
        let whole = dot(change, change);
        for (direction, moved) in before.iter().zip(earlier.iter()) {
            let part = dot(change, direction.as_ref());
            add(change, -part, direction.as_ref());
            add(own, -part, moved.as_ref());
        }
        let mut square = dot(change, change);
        let mut place = *known;
        if square < NEW * NEW * whole {
            place = 0;
            write(changes[0].as_mut(), moves[0].as_mut());
            square = whole;
        }
        *known = place;
        if square > 0.0 && square.is_finite() {
            let scale = square.sqrt().recip();
            for numbers in [changes[place].as_mut(), moves[place].as_mut()] {
                numbers.iter_mut().for_each(|x| *x *= scale);
            }
            *known = place + 1;
        }
    }

    /// Takes from values in reference scales what the moves that are known can change, and makes these
    /// moves the last one.
    pub(crate) fn reduce(&mut self, values: &mut [f64]) {
        let Secants { changes, moves, known, given, last } = self;
        given.as_mut().copy_from_slice(values);
        last.as_mut().fill(0.0);
        for (direction, own) in changes.iter().zip(moves.iter()).take(*known) {
            let part = dot(values, direction.as_ref());
            add(values, -part, direction.as_ref());
            add(last.as_mut(), -part, own.as_ref());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values `K x - b` where the approximate differential is one, wrong in two directions of three.
    #[test]
    fn two_wrong_directions_are_learned_in_a_few_moves() {
        let k = [[-3.0, 0.5, 0.0], [0.5, 4.0, 0.0], [0.0, 0.0, 1.0]];
        let b = [1.0, -2.0, 0.5];
        let values = |x: &[f64; 3]| -> [f64; 3] {
            std::array::from_fn(|i| b[i] - (0..3).map(|j| k[i][j] * x[j]).sum::<f64>())
        };
        let mut secants = Secants::new(&[0.0; 3]);
        let mut x = [0.0; 3];
        for iteration in 0..5 {
            let mut g = values(&x);
            if iteration > 0 {
                secants.learn(&g);
            }
            secants.reduce(&mut g);
            add(&mut secants.last, 1.0, &g);
            add(&mut x, 1.0, &secants.last);
        }
        assert!(values(&x).iter().all(|g| g.abs() < 1e-12), "{x:?}");
    }
}
