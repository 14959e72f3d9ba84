//! The size by which a coordinate's rounding is measured: its own, and that of what it is coupled with.
//!
//! ```text
//! s_i = sum_j |A_ij| z_j / |A_ii|,    A = M + a d2V(q)
//! ```
//! `z` the sizes of the coordinates (n), `M` the metric, `V` the potential, `a` a number in s^2; `|A|` sums
//! the sizes of the blocks that A is the sum of. A rounding error in z_j moves the i-th equation by `A_ij`
//! times it, and the i-th unknown by about that over `A_ii`. What is far away but acts on nothing leaves the
//! sizes of the others alone.

use stationary_calculus::{FIXED, Metric, Potential, Sink, System};

/// Writes s for the sizes z at a configuration; `diagonal` is scratch, n numbers as well.
pub(crate) fn write_sizes(
    system: &System<impl Metric, impl Potential>,
    (q, a): (&[f64], f64),
    sizes: &[f64],
    diagonal: &mut [f64],
    coupled: &mut [f64],
) {
    diagonal.fill(0.0);
    coupled.fill(0.0);
    let mut sink = Coupled { scale: 1.0, sizes, diagonal, coupled };
    system.metric().add_matrix(&mut sink);
    sink.scale = a.abs();
    system.potential().add_hessian(q, &mut sink);
    let Coupled { diagonal, coupled, .. } = sink;
    for (coupled, diagonal) in coupled.iter_mut().zip(diagonal) {
        *coupled /= *diagonal;
    }
}

/// Adds `scale |B| z` of each block, and `scale |B_ii|`.
struct Coupled<'a> {
    scale: f64,
    sizes: &'a [f64],
    diagonal: &'a mut [f64],
    coupled: &'a mut [f64],
}

impl Sink for Coupled<'_> {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        for (&j, column) in freedoms.iter().zip(block.chunks_exact(freedoms.len().max(1))) {
            for (&i, entry) in freedoms.iter().zip(column) {
                if i == FIXED || j == FIXED {
                    continue;
                }
                let size = self.scale * entry.abs();
                self.coupled[i] += size * self.sizes[j];
                if i == j {
                    self.diagonal[i] += size;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stationary_calculus::{Automatic, DiagonalMetric, Energy, Number};

    struct Pair;

    impl Energy<3> for Pair {
        fn energy<R: Number>(&self, [x, y, far]: [R; 3]) -> R {
            (x - y) * (x - y) * 8.0 + far * 0.0
        }
    }

    #[test]
    fn a_coordinate_takes_the_size_of_what_it_is_coupled_with_and_of_nothing_else() {
        let metric = DiagonalMetric::new([1.0; 3]).unwrap();
        let system = System::new(metric, Automatic::<_, 3>(Pair)).unwrap();
        let mut sizes = [0.0; 3];
        let at = (&[0.0; 3][..], 1.0);
        write_sizes(&system, at, &[17.0, 0.0, 1e12], &mut [0.0; 3], &mut sizes);
        assert_eq!(sizes, [17.0, 16.0, 1e12]);
    }
}
