//! The last step of DOP853, as far as the polynomial within it needs that.
//!
//! ```text
//! y(t + x h) = y + x (d1 + (1-x) (d2 + x (d3 + (1-x) (d4 + x (d5 + (1-x) (d6 + x d7))))))
//! ```
//! `x` from 0 to 1, `d` seven combinations of sixteen stages (n each). Three of the stages are computed
//! when a moment within the step is first asked for. Now and then the ends of a long step are right by
//! luck, and its polynomial is off by hundreds of tolerances: `d7` is then large, and each half of the
//! step becomes a polynomial of its own, 250 times as exact. Source: Hairer, Norsett, Wanner, Solving
//! Ordinary Differential Equations I (1993), II.6.

use stationary_calculus::Storage;

use super::coefficients::*;
use super::stages::{combine, evaluate_stages};
use crate::VectorField;
use crate::first_order::error_scale::ErrorScale;

/// The largest of x^4 (1-x)^3, by which d7 counts.
const LAST_TERM: f64 = 0.0084;
/// A last term of so many tolerances is that of a polynomial off by ten: one of a hundred is usual.
const ROUGH: f64 = 50.0;

/// The last step.
#[derive(Clone, Debug)]
pub(super) struct LastStep<S> {
    pub(super) begin: Option<f64>,
    pub(super) h: f64,
    /// What the polynomial covers, once there is one.
    pub(super) piece: Option<Piece>,
    /// Stages 1 to 13; once the polynomial is known, stages 2 to 4 hold 14 to 16.
    pub(super) k: [S; 13],
    pub(super) y: S,
    /// The state in the middle, where the step was taken by halves.
    middle: S,
    dense: [S; 7],
}

/// A part of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Piece {
    Whole,
    FirstHalf,
    SecondHalf,
}

impl<S: Storage> LastStep<S> {
    /// No step yet, of states as large as this one.
    pub(super) fn new(zero: &S) -> Self {
        LastStep {
            begin: None,
            h: 0.0,
            piece: None,
            k: std::array::from_fn(|_| zero.clone()),
            y: zero.clone(),
            middle: zero.clone(),
            dense: std::array::from_fn(|_| zero.clone()),
        }
    }

    /// Computes the polynomial at a part `x` of the step from `begin` to the state `next`, where it is
    /// not known, and returns how often f was evaluated; `f` is that of the end. Without a scale no
    /// polynomial is rough.
    #[expect(clippy::too_many_arguments, reason = "what the method knows of its last step")]
    pub(super) fn complete(
        &mut self,
        field: &impl VectorField,
        begin: f64,
        next: &[f64],
        f: &[f64],
        x: f64,
        scale: Option<&ErrorScale<S>>,
        stage: &mut [f64],
    ) -> u64 {
        let mut evaluations = 0;
        if self.piece.is_none() {
            fit(
                field,
                (begin, self.h),
                (self.y.as_ref(), next),
                &mut self.k,
                &mut self.dense,
                stage,
            );
            self.piece = Some(Piece::Whole);
            evaluations += 3;
            if !scale.is_some_and(|scale| self.is_rough(scale, next)) {
                return evaluations;
            }
        } else if self.piece == Some(Piece::Whole) {
            return 0;
        }
        let half = if x < 0.5 { Piece::FirstHalf } else { Piece::SecondHalf };
        if self.piece == Some(half) {
            return evaluations;
        }
        evaluations + self.halve(field, begin, next, f, half, stage)
    }

    fn is_rough(&self, scale: &ErrorScale<S>, next: &[f64]) -> bool {
        let terms = self.dense[6].as_ref().iter().zip(scale.absolute.as_ref());
        terms.zip(next).any(|((d, absolute), next)| {
            LAST_TERM * d.abs() > ROUGH * (absolute + scale.relative * next.abs())
        })
    }

    /// Takes the step again by halves, and makes a polynomial of one of them.
    fn halve(
        &mut self,
        field: &impl VectorField,
        begin: f64,
        next: &[f64],
        f: &[f64],
        half: Piece,
        stage: &mut [f64],
    ) -> u64 {
        let LastStep { h, k, y, middle, dense, piece, .. } = self;
        let (h, y) = (0.5 * *h, y.as_ref());
        field.evaluate(begin, y, k[0].as_mut());
        evaluate_stages(field, begin, y, h, k, stage);
        let slopes = [1, 6, 7, 8, 9, 10, 11, 12].map(|s: usize| k[s - 1].as_ref());
        for (i, (middle, y)) in middle.as_mut().iter_mut().zip(y).enumerate() {
            *middle = y + h * B.iter().zip(slopes).map(|(b, k)| b * k[i]).sum::<f64>();
        }
        let middle = middle.as_ref();
        if middle.iter().any(|x| !x.is_finite()) {
            // f has no value there: the polynomial of the whole is what there is.
            *piece = Some(Piece::Whole);
            return 12;
        }
        field.evaluate(begin + h, middle, k[12].as_mut());
        *piece = Some(half);
        if half == Piece::FirstHalf {
            fit(field, (begin, h), (y, middle), k, dense, stage);
            return 16;
        }
        k.swap(0, 12);
        evaluate_stages(field, begin + h, middle, h, k, stage);
        k[12].as_mut().copy_from_slice(f);
        fit(field, (begin + h, h), (middle, next), k, dense, stage);
        27
    }

    /// Writes the state at a part `x` of the step.
    pub(super) fn at(&self, x: f64, y: &mut [f64]) {
        let (x, start) = match self.piece {
            Some(Piece::FirstHalf) => (2.0 * x, &self.y),
            Some(Piece::SecondHalf) => (2.0 * x - 1.0, &self.middle),
            Some(Piece::Whole) | None => (x, &self.y),
        };
        let rest = 1.0 - x;
        let d = self.dense.each_ref().map(S::as_ref);
        for (i, (y, start)) in y.iter_mut().zip(start.as_ref()).enumerate() {
            let inner = d[4][i] + rest * (d[5][i] + x * d[6][i]);
            let middle = d[2][i] + rest * (d[3][i] + x * inner);
            *y = start + x * (d[0][i] + rest * (d[1][i] + x * middle));
        }
    }
}

/// Computes the polynomial of the step of `h` from y at t to `next` out of its stages 1 to 13.
fn fit<S: Storage>(
    field: &impl VectorField,
    (t, h): (f64, f64),
    (y, next): (&[f64], &[f64]),
    k: &mut [S; 13],
    dense: &mut [S; 7],
    stage: &mut [f64],
) {
    macro_rules! stages {
        ($($s:literal into $place:literal $row:ident $at:expr;)+) => {$(
            combine(stage, y, h, &$row, k, $at);
            field.evaluate(t + C[$s - 1] * h, stage, k[$place - 1].as_mut());
        )+};
    }
    stages! {
        14 into 2 A14 [1, 7, 8, 9, 10, 11, 12, 13];
        15 into 3 A15 [1, 6, 7, 8, 11, 12, 13, 2];
        16 into 4 A16 [1, 6, 7, 8, 9, 13, 2, 3];
    }
    for (i, (y, next)) in y.iter().zip(next).enumerate() {
        let step = next - y;
        let bend = h * k[0].as_ref()[i] - step;
        dense[0].as_mut()[i] = step;
        dense[1].as_mut()[i] = bend;
        dense[2].as_mut()[i] = step - h * k[12].as_ref()[i] - bend;
    }
    let at = [1, 6, 7, 8, 9, 10, 11, 12, 13, 2, 3, 4];
    for (dense, row) in dense[3..].iter_mut().zip([&D4, &D5, &D6, &D7]) {
        dense.as_mut().fill(0.0);
        for (d, s) in row.iter().zip(at) {
            for (dense, k) in dense.as_mut().iter_mut().zip(k[s - 1].as_ref()) {
                *dense += h * d * k;
            }
        }
    }
}
