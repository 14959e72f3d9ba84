//! Random rotations, meshes and the places of their vertices.

use crate::Draw;

/// A rotation of two or three dimensions, by columns: Gram and Schmidt on random vectors.
pub fn rotation(draw: &mut Draw, d: usize) -> Vec<Vec<f64>> {
    if d == 1 {
        return vec![vec![1.0]];
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut frame: Vec<Vec<f64>> = Vec::new();
    for k in 0..d {
        let mut x = draw.vector(d);
        x[k] += 1e-3;
        for _ in 0..2 {
            for other in &frame {
                let along = dot(&x, other);
                x.iter_mut().zip(other).for_each(|(x, o)| *x -= along * o);
            }
            let length = dot(&x, &x).sqrt();
            if length < 1e-9 {
                x = (0..d).map(|i| f64::from(i == k)).collect();
            } else {
                x.iter_mut().for_each(|x| *x /= length);
            }
        }
        frame.push(x);
    }
    let positive = super::law::determinant(&frame) > 0.0;
    if !positive {
        frame[0].iter_mut().for_each(|x| *x = -*x);
    }
    frame
}
