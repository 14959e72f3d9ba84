//! Poisson's problem and harmonic functions, against a dense solve of the referee's own matrices.

use nalgebra::{DMatrix, DVector};
use stationary_calculus::{Covector, Metric};
use stationary_laplacian::{Domain, Elements, LaplacianError, Poisson, harmonic};
use stationary_mesh::Simplex;

use super::matrices::{Matrices, part, solve};
use super::shapes::{self, Shape};
use crate::{Draw, Kind, Verdict};

pub const KIND: Kind = Kind {
    name: "poisson",
    krate: "laplacian",
    rule: "a value off by more than the condition number times rounding (1e-13, and 1e-14 \
           for each time that a simplex is longer than high); on a piece held \
           nowhere a mean that is not zero, or an Ok for a source that does not balance",
    in_tests: 300,
    trial,
};

fn trial(draw: &mut Draw) -> Verdict {
    match draw.below(3) {
        0 => {
            let shape = shapes::in_pieces(draw, shapes::line).placed(draw);
            rest(draw, &shape)
        }
        1 => {
            let shape = shapes::in_pieces(draw, shapes::surface).placed(draw);
            rest(draw, &shape)
        }
        _ => {
            let shape = shapes::in_pieces(draw, shapes::solid).placed(draw);
            rest(draw, &shape)
        }
    }
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().map(f64::abs).fold(0.0, f64::max)
}

fn rest<const K: usize>(draw: &mut Draw, shape: &Shape<K>) -> Verdict
where
    [usize; K]: Simplex,
{
    let matrices = Matrices::of(shape);
    if matrices.shape.is_nan() || matrices.shape < 1e-9 {
        return Verdict::not_judged("a simplex of hardly any size");
    }
    let n = shape.vertices.len();
    let pieces = shape.pieces();
    // Each piece is held nowhere, at one vertex or at many, but not all of them.
    let mut held = Vec::new();
    let mut all: Vec<usize> = (0..n).collect();
    for &root in pieces.iter().enumerate().filter(|(v, p)| v == *p).map(|(_, p)| p) {
        let share = draw.one_of(&[0.0, 0.0, 0.3, 0.9]);
        let one = draw.chance(0.3);
        for v in (0..n).filter(|&v| pieces[v] == root) {
            if (one && v == root) || draw.chance(share) {
                held.push((v, 3.0 * draw.symmetric()));
                all.retain(|&other| other != v);
            }
        }
    }
    let mesh = match shape.mesh() {
        Ok(mesh) => mesh,
        Err(error) => return Verdict::refused(error),
    };
    let domain = match Elements::of(&mesh).and_then(|e| Domain::held(e, &held)) {
        Ok(domain) => domain,
        Err(LaplacianError::NothingFree) if all.is_empty() => return Verdict::due(),
        Err(error) => return Verdict::refused(error),
    };
    let lumped = draw.chance(0.5);
    draw.note(format!("{} held, {} mass", held.len(), if lumped { "lumped" } else { "exact" }));
    let mass = part(if lumped { &matrices.lumped } else { &matrices.galerkin }, &all, &all);
    let case = Case {
        stiffness: &matrices.stiffness,
        mass,
        held: &held,
        free: &all,
        pieces: &pieces,
        rounding: 1e-13 + 1e-14 / matrices.shape,
    };
    if lumped {
        match domain.lumped() {
            Ok(metric) => case.judge(draw, &domain, &metric),
            Err(error) => Verdict::refused(error),
        }
    } else {
        match domain.galerkin() {
            Ok(metric) => case.judge(draw, &domain, &metric),
            Err(error) => Verdict::refused(error),
        }
    }
}

struct Case<'a> {
    stiffness: &'a DMatrix<f64>,
    mass: DMatrix<f64>,
    held: &'a [(usize, f64)],
    free: &'a [usize],
    pieces: &'a [usize],
    /// Of a matrix of simplices of such a shape.
    rounding: f64,
}

impl Case<'_> {
    /// The free vertices of each piece that is held nowhere, by their place among the free.
    fn floating(&self) -> Vec<Vec<usize>> {
        let roots = (0..self.pieces.len()).filter(|&v| self.pieces[v] == v);
        let afloat = roots.filter(|&r| self.held.iter().all(|&(v, _)| self.pieces[v] != r));
        let of = |root: usize| {
            (0..self.free.len()).filter(|&k| self.pieces[self.free[k]] == root).collect()
        };
        afloat.map(of).collect()
    }

    fn judge<const K: usize>(
        &self,
        draw: &mut Draw,
        domain: &Domain<K>,
        metric: &impl Metric,
    ) -> Verdict {
        let n = self.free.len();
        let floating = self.floating();
        let is_harmonic = draw.chance(0.2);
        let size = if draw.chance(0.3) { draw.log_uniform(1e-12, 1e12) } else { 1.0 };
        let mut source = if is_harmonic { vec![0.0; n] } else { draw.vector(n) };
        source.iter_mut().for_each(|s| *s *= size);
        if is_harmonic {
            let found = harmonic(domain);
            return match found {
                Err(LaplacianError::NothingHeld(_)) if !floating.is_empty() => Verdict::due(),
                Err(error) => Verdict::refused(error),
                Ok(_) if !floating.is_empty() => Verdict::wrong("harmonic where nothing is held"),
                Ok(u) => {
                    let free: Vec<f64> = self.free.iter().map(|&v| u[v]).collect();
                    let kept = self.held.iter().all(|&(v, value)| u[v] == value);
                    let verdict = self.compare(&free, &DVector::zeros(n), &floating);
                    if kept { verdict } else { Verdict::wrong("a held value was changed") }
                }
            };
        }
        // Loads by their integrals or sources by their values; balanced, or one piece of them not.
        let by_load = draw.chance(0.3);
        let mut load = DVector::from_vec(source.clone());
        if !by_load {
            load = &self.mass * load;
        }
        let mut unbalanced = None;
        for piece in &floating {
            let total: f64 = piece.iter().map(|&k| load[k]).sum();
            let weight: f64 = piece.iter().map(|&k| load[k].abs()).sum();
            if draw.chance(0.85) {
                let measure: f64 = if by_load {
                    piece.len() as f64
                } else {
                    piece
                        .iter()
                        .map(|&i| piece.iter().map(|&j| self.mass[(i, j)]).sum::<f64>())
                        .sum()
                };
                piece.iter().for_each(|&k| source[k] -= total / measure);
            } else if total.abs() > 1e-8 * weight {
                unbalanced = Some(piece.clone());
            }
        }
        load = DVector::from_vec(source.clone());
        if !by_load {
            load = &self.mass * load;
        }
        draw.note(format!(
            "sources of size {size:.1e}, {} pieces afloat, unbalanced {unbalanced:?}",
            floating.len()
        ));
        let mut poisson = match Poisson::new(domain, metric) {
            Ok(poisson) => poisson,
            Err(error) => return Verdict::refused(error),
        };
        let found = if by_load {
            poisson.solve_load(Covector(source.clone()))
        } else {
            poisson.solve(&source)
        };
        match (found, unbalanced) {
            (Err(LaplacianError::Incompatible { .. }), Some(_)) => Verdict::due(),
            (Ok(_), Some(_)) => Verdict::wrong("an answer to a source that does not balance"),
            (Err(error), _) => Verdict::refused(error),
            (Ok(u), None) => self.compare(&u, &load, &floating),
        }
    }

    fn compare(&self, u: &[f64], load: &DVector<f64>, floating: &[Vec<usize>]) -> Verdict {
        let (places, values): (Vec<usize>, Vec<f64>) = self.held.iter().copied().unzip();
        let right =
            load - part(self.stiffness, self.free, &places) * DVector::from_vec(values.clone());
        let mut matrix = part(self.stiffness, self.free, self.free);
        // On a piece afloat the mean is pinned by one more square in the energy.
        for piece in floating {
            let mut weights = DVector::<f64>::zeros(u.len());
            for &i in piece {
                weights[i] = piece.iter().map(|&j| self.mass[(i, j)]).sum();
            }
            let strength =
                piece.iter().map(|&i| matrix[(i, i)]).fold(0.0, f64::max) / weights.norm_squared();
            matrix += &weights * weights.transpose() * strength;
        }
        let (expected, condition) = solve(&matrix, &right);
        if condition > 1e9 {
            return Verdict::not_judged("a matrix too close to singular for the referee");
        }
        let scale = largest(expected.iter().copied()).max(largest(values));
        // What does not balance may be taken from any vertex: where sources nearly cancel it is more than rounding.
        let unbalanced = floating.iter().map(|piece| {
            let sum: f64 = piece.iter().map(|&k| load[k]).sum();
            let most = largest(piece.iter().map(|&k| load[k]));
            if most > 0.0 { sum / most } else { 0.0 }
        });
        let promised = self.rounding.max(largest(unbalanced)) * condition * scale;
        let error = largest(u.iter().zip(expected.iter()).map(|(a, b)| a - b));
        Verdict::of(error, promised, "a value")
    }
}
