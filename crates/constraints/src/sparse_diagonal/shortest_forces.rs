//! The shortest multipliers with the same force, where equations depend on each other.
//!
//! ```text
//! lambda' = lambda - N y,   S N = 0,   min over y of |D (lambda - N y)|,    N = [ S_II^-1 S_ID ]
//!                                                                               [     -1       ]
//! D^-1 S D^-1 z' = D^-1 S D^-1 z,   z' across every dependence                    z = D lambda
//! ```
//! `I` the independent equations, `D` the dependent ones, and the norm's `D` the slopes. N is never formed:
//! conjugate gradients take as many products with it as it has different singular values, one for one redundant
//! equation. Where the factor knows dependences badly, conjugate gradients of the last line follow, which need none.
//! Source: Paige and Saunders, ACM TOMS 8 (1982) 43 (least squares by conjugate gradients).

use crate::ConstraintError;
use crate::sparse_diagonal::DiagonalMultipliers;

/// Forces are the same where what the equations feel of them differs by less than this part.
const SAME_FORCE: f64 = 1e-12;
/// The most that conjugate gradients of S, which know no dependences, are trusted with: the square of the ratio of
/// the largest to the smallest singular value.
const CONDITION: f64 = 1e8;
/// Shared forces are the shortest where an iteration changes them by less than the first part, or by
/// less than the second and no longer falls: rounding in the products is all that is left.
const SETTLED: f64 = 1e-13;
const SHORTEST: f64 = 1e-9;
/// The same where the independent equations are nearly singular, and their rounding is larger.
const NEAR_SINGULAR: f64 = 1e-6;

/// How well the shortest multipliers are known: to [`SHORTEST`] or to [`NEAR_SINGULAR`].
enum Settled {
    Sharply,
    Roughly,
}

impl DiagonalMultipliers {
    /// Writes `D N y` for y in reference scales: a combination of dependences.
    fn along_dependences(&mut self, y: &[f64], image: &mut [f64]) {
        let mut x = std::mem::take(&mut self.right);
        x.fill(0.0);
        for dependent in &self.factor.dependent {
            let equation = dependent.equation as usize;
            x[equation] = y[equation] / self.slopes[equation];
        }
        self.product(&x, image);
        self.factor.solve(image);
        // The force is then none but for rounding, of which a second solve removes the larger part.
        x.iter_mut().zip(&*image).for_each(|(x, u)| *x -= u);
        let mut left = std::mem::take(&mut self.left);
        self.product(&x, &mut left);
        self.factor.solve(&mut left);
        x.iter_mut().zip(&left).for_each(|(x, u)| *x -= u);
        self.left = left;
        for (image, (x, slope)) in image.iter_mut().zip(x.iter().zip(&self.slopes)) {
            *image = -slope * x;
        }
        self.right = x;
    }

    /// Writes `(D N)^T z`, in the places of the dependent equations.
    fn across_dependences(&mut self, z: &[f64], image: &mut [f64]) {
        let mut x = std::mem::take(&mut self.right);
        for (x, (z, slope)) in x.iter_mut().zip(z.iter().zip(&self.slopes)) {
            *x = slope * z;
        }
        let mut left = std::mem::take(&mut self.left);
        left.copy_from_slice(&x);
        self.factor.solve(&mut x);
        self.product(&x, image);
        left.iter_mut().zip(&*image).for_each(|(left, image)| *left -= image);
        self.factor.solve(&mut left);
        x.iter_mut().zip(&left).for_each(|(x, part)| *x += part);
        self.left = left;
        self.product(&x, image);
        for (equation, image) in image.iter_mut().enumerate() {
            let dependent = self.factor.is_dependent(equation);
            *image = if dependent { *image / self.slopes[equation] - z[equation] } else { 0.0 };
        }
        self.right = x;
    }

    /// Replaces multipliers in reference scales by the shortest with the same force.
    pub(super) fn shorten(&mut self, z: &mut [f64]) -> Result<(), ConstraintError> {
        let mut given = std::mem::take(&mut self.given);
        given.copy_from_slice(z);
        let shortened = match self.shorten_by_dependences(z) {
            Ok(Settled::Sharply) => Ok(()),
            shortened => {
                let mut found = std::mem::take(&mut self.found);
                found.copy_from_slice(z);
                let across = self.shorten_across(&given, z);
                if !across {
                    z.copy_from_slice(&found);
                }
                self.found = found;
                if across { Ok(()) } else { shortened.map(|_| ()) }
            }
        };
        self.given = given;
        shortened
    }

    /// The same by conjugate gradients of `D^-1 S D^-1 z' = D^-1 S D^-1 z` from nothing, which never leave what is
    /// across every dependence: for dependences that the factor knows badly. Says whether the force is the same.
    fn shorten_across(&mut self, given: &[f64], z: &mut [f64]) -> bool {
        let [mut left, mut direction, mut image] =
            [&mut self.gradient, &mut self.direction, &mut self.image].map(std::mem::take);
        let inner = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        self.scaled_product(given, &mut left);
        z.fill(0.0);
        direction.copy_from_slice(&left);
        let mut square = inner(&left, &left);
        let whole = square;
        // Steps are between one over the largest and one over the smallest eigenvalue that matters.
        let [mut shortest, mut longest] = [f64::INFINITY, 0.0_f64];
        for _ in 0..4 * self.count + 40 {
            if square <= SETTLED * SETTLED * whole {
                break;
            }
            self.scaled_product(&direction, &mut image);
            let step = square / inner(&direction, &image);
            (shortest, longest) = (shortest.min(step), longest.max(step));
            z.iter_mut().zip(&direction).for_each(|(z, d)| *z += step * d);
            left.iter_mut().zip(&image).for_each(|(r, image)| *r -= step * image);
            let ratio = inner(&left, &left) / square;
            square *= ratio;
            direction.iter_mut().zip(&left).for_each(|(d, r)| *d = r + ratio * *d);
        }
        // Measured again: what the iterations took off gathers their rounding.
        direction.iter_mut().zip(given.iter().zip(&*z)).for_each(|(d, (a, b))| *d = a - b);
        self.scaled_product(&direction, &mut left);
        let same = longest <= CONDITION * shortest
            && inner(&left, &left) <= SAME_FORCE * SAME_FORCE * whole;
        [self.gradient, self.direction, self.image] = [left, direction, image];
        same
    }

    /// Writes `D^-1 S D^-1 z`.
    fn scaled_product(&mut self, z: &[f64], image: &mut [f64]) {
        let mut x = std::mem::take(&mut self.right);
        x.iter_mut().zip(z.iter().zip(&self.slopes)).for_each(|(x, (z, slope))| *x = z / slope);
        self.product(&x, image);
        image.iter_mut().zip(&self.slopes).for_each(|(image, slope)| *image /= slope);
        self.right = x;
    }

    /// The same by least squares in the combinations of dependences that the factor knows.
    fn shorten_by_dependences(&mut self, z: &mut [f64]) -> Result<Settled, ConstraintError> {
        let (mut gradient, mut direction) =
            (std::mem::take(&mut self.gradient), std::mem::take(&mut self.direction));
        let mut image = std::mem::take(&mut self.image);
        let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
        // As many as there are dependences would do but for rounding.
        let bound = 4 * self.dependent() + 40;
        self.across_dependences(z, &mut gradient);
        direction.copy_from_slice(&gradient);
        let mut slope = square(&gradient);
        let mut iterations = 0;
        // The square of what an iteration takes off, relative to what is left.
        let mut change = f64::INFINITY;
        let mut settled = slope == 0.0;
        while !settled && iterations < bound {
            self.along_dependences(&direction, &mut image);
            let step = slope / square(&image);
            z.iter_mut().zip(&image).for_each(|(z, image)| *z -= step * image);
            let before = std::mem::replace(&mut change, step * slope / square(z));
            self.across_dependences(z, &mut gradient);
            let ratio = square(&gradient) / slope;
            slope *= ratio;
            direction.iter_mut().zip(&gradient).for_each(|(d, g)| *d = g + ratio * *d);
            iterations += 1;
            // More iterations than dependences are rounding's.
            let allowed = if iterations > self.dependent() { NEAR_SINGULAR } else { SHORTEST };
            let rounding = change <= allowed * allowed && change > 0.25 * before;
            settled = rounding || change <= SETTLED * SETTLED || slope == 0.0;
        }
        (self.gradient, self.direction, self.image) = (gradient, direction, image);
        match settled {
            true if slope == 0.0 || change <= SHORTEST * SHORTEST => Ok(Settled::Sharply),
            true => Ok(Settled::Roughly),
            false => Err(ConstraintError::NotShared { iterations }),
        }
    }
}
