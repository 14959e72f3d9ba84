//! Trigonometric methods: the stiff linear part exactly, the rest by filtered kicks.
//!
//! ```text
//! M q'' = -K q - dU(q)
//! p~ = p - h/2 M psi(h W) M^-1 dU(phi(h W) q)
//! q^ = cos(h W) q + W^-1 sin(h W) M^-1 p~,    p^ = M (cos(h W) M^-1 p~ - W sin(h W) q)
//! p' = p^ - h/2 M psi(h W) M^-1 dU(phi(h W) q^)
//! ```
//! `K` symmetric positive semidefinite (n x n, N/m), `W^2 = M^-1 K`, `U` the system's potential,
//! which is soft, `h` step in seconds. Functions of W are taken on the eigenvectors V of
//! `K v = w^2 M v`, found when the method is made: `f(W) = V f(w) V^T M`. Dense: a step costs a few
//! products with V.
//!
//! Exact where U is constant; order 2, symmetric, explicit; symplectic where psi = phi. Which of
//! the resonances `h w = k pi` are felt is the [`Filter`]'s matter: on a linear soft force a motion
//! grows near every one, near the odd ones, or near none (`each_filter_resonates_where_it_says`).
//! Momenta are kept as far as K has the symmetry, linear momentum by every filter, angular momentum
//! by the symplectic ones. Source: Hairer, Lubich and Wanner, Geometric Numerical Integration,
//! XIII.2 (their psi is our `sinc psi`); Gautschi 1961, Deuflhard 1979, Garcia-Archilla, Sanz-Serna
//! and Skeel 1999.

use stationary_calculus::{
    BilinearForm, Covector, DenseSink, EigenError, Metric, Potential, Readable, SizeError, Storage,
    System, Vector,
};

use crate::integrator::{check_step, zeros};
use crate::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Integrator, Stability,
    State, StepError, StepReport, Symplecticity,
};

/// How the soft force is smoothed over the fast oscillation, with x = h w and sinc x = sin x/x.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Filter {
    /// `phi = psi = 1`: kicks without a filter, the impulse method. Symplectic. Resonates at every
    /// `h w = k pi`, and where the sum with a coupled soft frequency is a multiple of `2 pi/h`.
    Impulse,
    /// `phi = psi = sinc x`: the mollified impulse method. Symplectic, since the kick is that of
    /// the potential `U(phi q)`. The kick vanishes at `h w = k pi`, and resonance with it. Narrow
    /// bands of growth remain where the sum with a coupled soft frequency is a multiple of
    /// `2 pi/h`.
    Mollified,
    /// `phi = 1, psi = tan(x/2)/(x/2)`: Gautschi's own. Exact for a constant force; not symplectic;
    /// psi is unbounded, and resonates, at odd k.
    Gautschi,
    /// `phi = 1, psi = sinc x`: keeps energy over long times away from `h w = k pi`. Not
    /// symplectic.
    Long,
}

impl Filter {
    /// phi and psi at x.
    fn at(self, x: f64) -> (f64, f64) {
        match self {
            Filter::Impulse => (1.0, 1.0),
            Filter::Mollified => (sinc(x), sinc(x)),
            Filter::Gautschi => (1.0, sinc(0.5 * x) / (0.5 * x).cos()),
            Filter::Long => (1.0, sinc(x)),
        }
    }
}

/// `sin x/x`, 1 at zero.
fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

/// What stiffness matrices are refused for.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StiffnessError {
    /// The stiffness or the metric has no real eigenvalues, or another size.
    #[error(transparent)]
    Eigen(#[from] EigenError),
    /// The storage does not have the system's size.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// Trigonometric functions are of oscillations.
    #[error(
        "the stiffness is not positive semidefinite: it has the eigenvalue {eigenvalue} 1/s^2",
        eigenvalue = Readable(eigenvalue)
    )]
    Negative {
        /// The eigenvalue, 1/s^2.
        eigenvalue: f64,
    },
}

/// The functions of a mode that a step needs.
#[derive(Clone, Copy, Debug)]
struct Turn {
    phi: f64,
    psi: f64,
    cosine: f64,
    /// `sin(h w)/w`, seconds.
    sine_over: f64,
    /// `w sin(h w)`, 1/s.
    sine_times: f64,
}

impl Turn {
    fn new(filter: Filter, w: f64, h: f64) -> Self {
        let x = h * w;
        let (phi, psi) = filter.at(x);
        Turn { phi, psi, cosine: x.cos(), sine_over: h * sinc(x), sine_times: w * x.sin() }
    }
}

/// A trigonometric method.
#[derive(Clone, Debug)]
pub struct Gautschi<'s, M, P, C> {
    system: &'s System<M, P>,
    filter: Filter,
    /// Columns of V, with `V^T M V = I`.
    modes: Vec<C>,
    frequencies: Vec<f64>,
    /// What a step of `turn_step` seconds does to each mode.
    turns: Vec<Turn>,
    turn_step: f64,
    amplitudes: Vec<(f64, f64)>,
    filtered: C,
    /// dU at the filtered configuration of the last state, and the step that led there: zero for
    /// none.
    differential: Covector<C>,
    left: C,
    left_step: f64,
    flat: Covector<C>,
    next: State<C>,
}

/// Eigenvalues this small relative to the largest are rounding of zero, if they are so of their own terms as
/// well: their modes move freely.
const ROUNDING: f64 = 1e-13;

/// The eigenvalue `<v, K v>` of a mode, zero where it is rounding of the terms of that sum: beside a stiff mode
/// to which it is not coupled, a soft one is soft and not free.
fn by_its_terms(stiffness: &BilinearForm, mode: &[f64]) -> f64 {
    let (mut sum, mut terms) = (0.0, 0.0);
    for (column, v) in stiffness.0.column_iter().zip(mode) {
        for (entry, w) in column.iter().zip(mode) {
            let term = v * entry * w;
            sum += term;
            terms += term.abs();
        }
    }
    if sum.abs() > ROUNDING * terms { sum } else { 0.0 }
}

impl<'s, M: Metric, P: Potential, C: Storage> Gautschi<'s, M, P, C> {
    /// The method on a system whose own potential is soft, beside the stiffness K (N/m).
    ///
    /// # Errors
    /// [`StiffnessError::Size`] for a storage or a stiffness of another size than the system's;
    /// [`StiffnessError::Eigen`] for a stiffness that is not finite or not symmetric, and for modes
    /// that were not found; [`StiffnessError::Negative`].
    pub fn new(
        system: &'s System<M, P>,
        stiffness: &BilinearForm,
        filter: Filter,
    ) -> Result<Self, StiffnessError> {
        let n = system.dim();
        let zero: C = zeros(n)?;
        let mut mass = stiffness.clone();
        mass.0.fill(0.0);
        SizeError::check("the stiffness's rows", n, mass.0.nrows())?;
        SizeError::check("the stiffness's columns", n, mass.0.ncols())?;
        if let Some(mut sink) = DenseSink::new(1.0, n, mass.0.as_mut_slice()) {
            system.metric().add_matrix(&mut sink);
        }
        let pairs = stiffness.eigenpairs(&mass)?;
        let zero_below = ROUNDING * pairs.values.amax();
        let mut values = pairs.values.clone();
        for (value, mode) in values.iter_mut().zip(pairs.vectors.column_iter()) {
            if value.abs() <= zero_below {
                *value = by_its_terms(stiffness, mode.as_slice());
            }
        }
        if let Some(&eigenvalue) = values.iter().find(|value| **value < 0.0) {
            return Err(StiffnessError::Negative { eigenvalue });
        }
        let column = |j: usize| {
            let mut mode = zero.clone();
            mode.as_mut().copy_from_slice(&pairs.vectors.as_slice()[j * n..][..n]);
            mode
        };
        Ok(Gautschi {
            system,
            filter,
            modes: (0..n).map(column).collect(),
            frequencies: values.iter().map(|value| value.sqrt()).collect(),
            turns: Vec::with_capacity(n),
            turn_step: 0.0,
            amplitudes: vec![(0.0, 0.0); n],
            filtered: zero.clone(),
            differential: Covector(zero.clone()),
            left: zero.clone(),
            left_step: 0.0,
            flat: Covector(zero.clone()),
            next: State::new(zero.clone(), Covector(zero)),
        })
    }

    /// Sets the modes' functions up for steps of h seconds.
    fn turn(&mut self, h: f64) {
        if self.turn_step != h {
            self.turns.clear();
            self.turns.extend(self.frequencies.iter().map(|&w| Turn::new(self.filter, w, h)));
            self.turn_step = h;
        }
    }

    /// Writes the amplitudes of q and p in each mode: `V^T M q` and `V^T p`.
    fn analyse(&mut self) {
        let metric = self.system.metric();
        metric.flat(Vector(self.next.q.as_ref()), self.flat.view_mut());
        for (mode, amplitude) in self.modes.iter().zip(&mut self.amplitudes) {
            let mode = Vector(mode.as_ref());
            *amplitude = (self.flat.apply(&mode), self.next.p.apply(&mode));
        }
    }

    /// Evaluates dU where the amplitudes of q, filtered, put the system.
    fn evaluate(&mut self) {
        self.filtered.as_mut().fill(0.0);
        for ((mode, turn), (q, _)) in self.modes.iter().zip(&self.turns).zip(&self.amplitudes) {
            Vector(self.filtered.as_mut()).add_scaled(turn.phi * q, Vector(mode.as_ref()));
        }
        self.differential.clear();
        let dv = self.differential.view_mut();
        self.system.potential().add_differential(self.filtered.as_ref(), dv);
    }

    /// Kicks the amplitudes of p with the differential evaluated last, filtered.
    fn kick(&mut self, h: f64) {
        for ((mode, turn), (_, p)) in self.modes.iter().zip(&self.turns).zip(&mut self.amplitudes) {
            *p -= h * turn.psi * self.differential.apply(&Vector(mode.as_ref()));
        }
    }

    /// The exact motion without the soft potential.
    fn rotate(&mut self) {
        for (turn, (q, p)) in self.turns.iter().zip(&mut self.amplitudes) {
            let Turn { cosine, sine_over, sine_times, .. } = turn;
            (*q, *p) = (cosine * *q + sine_over * *p, cosine * *p - sine_times * *q);
        }
    }

    /// Writes q and p from their amplitudes: `V a` and `M V b`.
    fn synthesise(&mut self) {
        let State { q, p, .. } = &mut self.next;
        q.as_mut().fill(0.0);
        self.filtered.as_mut().fill(0.0);
        for (mode, (a, b)) in self.modes.iter().zip(&self.amplitudes) {
            Vector(q.as_mut()).add_scaled(*a, Vector(mode.as_ref()));
            Vector(self.filtered.as_mut()).add_scaled(*b, Vector(mode.as_ref()));
        }
        self.system.metric().flat(Vector(self.filtered.as_ref()), p.view_mut());
    }
}

impl<M: Metric, P: Potential, C: Storage> Integrator<C> for Gautschi<'_, M, P, C> {
    fn facts(&self) -> Facts {
        let symplectic = matches!(self.filter, Filter::Impulse | Filter::Mollified);
        Facts {
            name: match self.filter {
                Filter::Impulse => "impulse",
                Filter::Mollified => "mollified-impulse",
                Filter::Gautschi => "gautschi",
                Filter::Long => "hairer-lubich",
            },
            order: 2,
            stages: 1,
            evaluation: Evaluation::Explicit,
            symmetric: true,
            symplecticity: if symplectic { Symplecticity::Symplectic } else { Symplecticity::No },
            energy: EnergyBehavior::Bounded,
            linear_momentum: Conservation::Exact,
            angular_momentum: match symplectic {
                true => Conservation::Exact,
                false => Conservation::ToOrder,
            },
            stability: Stability::Always,
            damping: Damping::Conditional,
            error_growth: ErrorGrowth::Linear,
        }
    }

    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        check_step(state, self.system.dim(), h)?;
        self.next.clone_from(state);
        self.turn(h);
        self.analyse();
        let mut differentials = 1;
        if self.left_step != h || self.left != state.q {
            self.evaluate();
            differentials += 1;
        }
        self.kick(0.5 * h);
        self.rotate();
        self.left_step = 0.0;
        self.evaluate();
        self.kick(0.5 * h);
        self.synthesise();
        state.accept(&mut self.next, h)?;
        self.left.clone_from(&state.q);
        self.left_step = h;
        Ok(StepReport { differentials, ..StepReport::default() })
    }
}
