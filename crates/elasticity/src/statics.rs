//! Where a loaded body comes to rest.
//!
//! ```text
//! dV(q) = t f,   held coordinates at (1 - t) start + t end,      t = 1/n, 2/n, ..., 1
//! reaction = dV at the held coordinates - the load there
//! ```
//! `f` a dead load (N), `t` the fraction of it: each step starts where the one before came to rest,
//! so that Newton's method has a good guess. The line search lowers the energy; where the Hessian
//! is not positive definite it is shifted by the mass (the ladder of calculus). What is found is a
//! minimum of the energy where the last report's rung is Cholesky's, not of all minima the lowest. A projected
//! Hessian only leads the search: how far the rest is and what kind of place it is the exact one says. Where the
//! equations are solved by iteration a solve for a random right-hand side tells the kind.
//!
//! ```text
//! residual  |dV - t f|, in the metric: (r . M^-1 r)^(1/2), kg^1/2 m/s^2
//! rounding  4 eps |H| max|x|           what rounding of the places alone makes of dV
//! ```
//! Newton's method may end where nothing falls any more, by rounding, or give up below the second line. Such a
//! place is at rest if it is also known to a thousandth of the displacement (`settle`), and if the forces that
//! hold it are the load's to a fiftieth. Where it is not known it is corrected; where that does not help it is an
//! error that says how far off it is. A load that leads by less than the places' digits leaves the body where it
//! is; the reactions are then rounding.
//!
//! A body that may shift as a whole is refused before any solve: its Hessian has no inverse. One that
//! may turn, on a hinge, two pins or an edge, hangs where its load is lowest; it is turned there before
//! the solve, and refused where the load does not hold it (`rigid_motions`). A rest in which elements
//! are inside out is refused, with their numbers. Source: notes 4.4; load stepping after Bonet and
//! Wood (2008).

use stationary_calculus::{
    ConjugateGradient, Covector, Curvature, DiagonalMetric, Equilibrium, EquilibriumReport,
    HessianSolver, IterativeSolver, Metric, Newton, NewtonEnd, NewtonError, NewtonFailure,
    Ordering, Potential, ProductSink, Rung, SparseSolver, Stationary, Unsolvable, Vector,
};
use stationary_mesh::Places;

use crate::rigid_motions::{check_hung, hang};
use crate::settle::{Displacement, NOTICED, RowSizes, Settle, Settled, difference, largest};
use crate::{DeadLoad, ElasticityError, Material, Solid};

/// How each of Newton's steps is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solves {
    /// By a factor, whose order of elimination is found this way.
    Factor(Ordering),
    /// By conjugate gradients, for bodies whose factor is too large or too slow. Where the Hessian is
    /// not positive definite it gives up, and the error says so: project it ([`Solid::with_curvature`]).
    Iterate(ConjugateGradient),
}

/// How a load is put on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statics {
    /// In how many equal steps.
    pub steps: usize,
    /// When Newton's method stops, in kg^1/2 m/s^2: see [`Equilibrium`].
    pub newton: Newton,
    /// How its linear equations are solved.
    pub solves: Solves,
}

impl Default for Statics {
    /// In one step, to rounding, by a factor. A hanging cloth takes more than a hundred iterations, of
    /// which most find out where it folds.
    fn default() -> Self {
        let solves = Solves::Factor(Ordering::default());
        Statics { steps: 1, newton: Newton { iterations: 300, ..Newton::default() }, solves }
    }
}

/// A body at rest under its load.
#[derive(Clone, Debug, PartialEq)]
pub struct AtRest {
    /// What Newton's method did in each load step.
    pub steps: Vec<EquilibriumReport>,
    /// The forces that hold the held coordinates, in their order, newtons.
    pub reactions: Vec<f64>,
    /// The elements that are inside out: of a law of small displacements, to which that means nothing,
    /// though to a reader of its answer it means that displacements are not small. Empty for every
    /// other law, whose rest would be refused.
    pub inverted: Vec<usize>,
}

impl AtRest {
    /// Newton steps in all, each one factorization.
    pub fn iterations(&self) -> u32 {
        self.steps.iter().map(|step| step.newton.iterations).sum()
    }
}

impl Statics {
    /// Moves `q` to where the body rests under the load, with its held coordinates moved to
    /// `places` along the way. On failure both are left as they were.
    ///
    /// # Errors
    /// [`ElasticityError::NoSteps`] and [`ElasticityError::Tolerance`] for settings that cannot be;
    /// [`ElasticityError::Freedoms`], [`ElasticityError::Position`], [`ElasticityError::HeldPlaces`],
    /// [`ElasticityError::Held`] and [`ElasticityError::OtherSupports`] for what does not fit the body;
    /// [`ElasticityError::RigidMotions`] where it may still move as a whole;
    /// [`ElasticityError::Statics`] where a load step finds no rest,
    /// [`ElasticityError::Unsettled`] and [`ElasticityError::Unbalanced`] where rounding leaves open where it
    /// is or what holds it, and
    /// [`ElasticityError::InsideOut`] where it is one of elements inside out.
    pub fn solve<M, const N: usize, const D: usize, const R: usize, const Q: usize>(
        &self,
        solid: &mut Solid<M, N, D, R, Q>,
        load: &DeadLoad<D>,
        metric: &DiagonalMetric<Vec<f64>>,
        places: &[f64],
        q: &mut [f64],
    ) -> Result<AtRest, ElasticityError>
    where
        M: Material<D, R>,
    {
        self.check(solid, load, metric, q)?;
        let before = solid.freedoms().places().to_vec();
        let mut x = q.to_vec();
        hang(solid, load, &mut x)?;
        let solved = self.climb(solid, load, metric, (&before, places), &mut x);
        let rest = solved.and_then(|steps| at_rest(solid, load, steps, &x));
        match rest {
            Ok(rest) => {
                q.copy_from_slice(&x);
                Ok(rest)
            }
            Err(error) => {
                solid.hold_at(&before)?;
                Err(error)
            }
        }
    }

    /// Whether the settings can be, and what is given fits the body.
    fn check<M, const N: usize, const D: usize, const R: usize, const Q: usize>(
        &self,
        solid: &Solid<M, N, D, R, Q>,
        load: &DeadLoad<D>,
        metric: &DiagonalMetric<Vec<f64>>,
        q: &[f64],
    ) -> Result<(), ElasticityError>
    where
        M: Material<D, R>,
    {
        if self.steps == 0 {
            return Err(ElasticityError::NoSteps);
        }
        if self.newton.tolerance.is_nan() || self.newton.tolerance < 0.0 {
            return Err(ElasticityError::Tolerance(self.newton.tolerance));
        }
        let freedoms = solid.freedoms();
        freedoms.check(q.len())?;
        freedoms.check(metric.dim())?;
        if !load.freedoms().is_numbered_as(freedoms) {
            return Err(ElasticityError::OtherSupports);
        }
        let positions = freedoms.positions(q)?;
        match positions.iter().position(|x| x.iter().any(|x| !x.is_finite())) {
            Some(vertex) => Err(ElasticityError::Position { vertex }),
            None => Ok(()),
        }
    }

    fn climb<M, const N: usize, const D: usize, const R: usize, const Q: usize>(
        &self,
        solid: &mut Solid<M, N, D, R, Q>,
        load: &DeadLoad<D>,
        metric: &DiagonalMetric<Vec<f64>>,
        (start, end): (&[f64], &[f64]),
        x: &mut [f64],
    ) -> Result<Vec<EquilibriumReport>, ElasticityError>
    where
        M: Material<D, R>,
    {
        solid.hold_at(end)?;
        match self.solves {
            Solves::Factor(ordering) => {
                let solver = SparseSolver::by_ordering(metric, &*solid, x, ordering)?;
                self.climb_by(solver, solid, load, metric, (start, end), x)
            }
            Solves::Iterate(method) => {
                let solver = IterativeSolver::new(method, metric, &*solid, x)?;
                self.climb_by(solver, solid, load, metric, (start, end), x)
            }
        }
    }

    fn climb_by<L, M, const N: usize, const D: usize, const R: usize, const Q: usize>(
        &self,
        mut solver: L,
        solid: &mut Solid<M, N, D, R, Q>,
        load: &DeadLoad<D>,
        metric: &DiagonalMetric<Vec<f64>>,
        (start, end): (&[f64], &[f64]),
        x: &mut [f64],
    ) -> Result<Vec<EquilibriumReport>, ElasticityError>
    where
        L: HessianSolver,
        M: Material<D, R>,
    {
        let steps = self.steps;
        let mut reports = Vec::with_capacity(steps);
        let began = x.to_vec();
        for step in 1..=steps {
            let t = step as f64 / steps as f64;
            let between: Vec<f64> =
                start.iter().zip(end).map(|(a, b)| (1.0 - t) * a + t * b).collect();
            solid.hold_at(&between)?;
            let load = load.scaled(t)?;
            let potential = (&*solid, &load);
            let mut search = Equilibrium::new(metric, &potential, &mut solver, self.newton)?;
            let found = search.find(x);
            let history = search.history().to_vec();
            let held = [difference(&between, start), largest(&between)];
            let of = Displacement { start: &began, held, load: load.at_free() };
            let place = Place { step, statics: self, load: &load, metric };
            // A projected Hessian is too stiff to tell how far the rest is, and what kind of place it is.
            let curvature = solid.curvature;
            let is_factored = matches!(self.solves, Solves::Factor(_));
            let exact = (curvature != Curvature::Exact || !is_factored).then(|| {
                solid.curvature = Curvature::Exact;
                place.kind(&*solid, &mut solver, x)
            });
            if !matches!(&exact, Some(Ok((_, Rung::Cholesky)))) {
                solid.curvature = curvature;
            }
            let found_at = x.to_vec();
            let report = place.judged(&*solid, &mut solver, (found, &history), &of, x);
            solid.curvature = Curvature::Exact;
            let is_corrected = report.is_ok() && *x != found_at[..];
            let exact =
                if is_corrected { Some(place.kind(&*solid, &mut solver, x)) } else { exact };
            solid.curvature = curvature;
            let report = report?;
            reports.push(match exact.transpose()? {
                Some((kind, rung)) => EquilibriumReport { kind, rung, ..report },
                None => report,
            });
        }
        Ok(reports)
    }
}

/// Where a load step's search ended, with what it is judged by.
struct Place<'a, const D: usize> {
    step: usize,
    statics: &'a Statics,
    load: &'a DeadLoad<D>,
    metric: &'a DiagonalMetric<Vec<f64>>,
}

impl<const D: usize> Place<'_, D> {
    /// Whether it is a rest: corrects x until it is known.
    fn judged<L, M, const N: usize, const R: usize, const Q: usize>(
        &self,
        solid: &Solid<M, N, D, R, Q>,
        solver: &mut L,
        (found, history): (Result<EquilibriumReport, NewtonError>, &[f64]),
        of: &Displacement<'_>,
        x: &mut [f64],
    ) -> Result<EquilibriumReport, ElasticityError>
    where
        L: HessianSolver,
        M: Material<D, R>,
    {
        let Place { step, statics: &Statics { steps, .. }, load, metric } = *self;
        let found = match found {
            Ok(report) if report.newton.end == NewtonEnd::Tolerance => return Ok(report),
            Err(source) if !is_rounding(history, rounding(solid, metric, x)) => {
                return Err(ElasticityError::Statics { step, steps, source });
            }
            found => found,
        };
        let settled =
            Settle { solver: &mut *solver, metric, potential: &(solid, load) }.settle(x, of);
        let moved = of.held[0] > 0.0;
        if matches!(settled, Settled::Known) {
            check_balance(solid, load, moved, x)?;
        }
        match (settled, found) {
            (Settled::Known | Settled::Still, Ok(mut report)) => {
                // That of the place to which it was corrected.
                report.newton.residual = self.residual(solid, x);
                Ok(report)
            }
            (Settled::Known | Settled::Still, Err(source)) => {
                let mut report = self.ended(solid, solver, x)?;
                report.newton.iterations = source.history.len() as u32 - 1;
                report.newton.end = NewtonEnd::Rounding;
                Ok(report)
            }
            (Settled::Off([left, displacement]), _) => {
                Err(ElasticityError::Unsettled { step, steps, left, displacement })
            }
            (Settled::Unsolved, Err(source)) => {
                Err(ElasticityError::Statics { step, steps, source })
            }
            (Settled::Unsolved, Ok(report)) => {
                let first = history.first().copied().unwrap_or(0.0);
                let most = size(metric, load.at_free()).max(first);
                let is_loaded = largest(load.at_free()) > 0.0 || moved;
                if is_loaded && report.newton.residual > NOTICED * most {
                    let failure = NewtonFailure::NotConverged;
                    let source = NewtonError { failure, history: history.to_vec() };
                    return Err(ElasticityError::Statics { step, steps, source });
                }
                Ok(report)
            }
        }
    }

    /// What kind of place it is. Conjugate gradients find a direction in which the energy falls, or that there is
    /// none; where they find neither, it cannot be told from a flat one.
    fn kind<L, M, const N: usize, const R: usize, const Q: usize>(
        &self,
        solid: &Solid<M, N, D, R, Q>,
        solver: &mut L,
        x: &mut [f64],
    ) -> Result<(Stationary, Rung), ElasticityError>
    where
        L: HessianSolver,
        M: Material<D, R>,
    {
        if let Solves::Factor(_) = self.statics.solves {
            let report = self.ended(solid, solver, x)?;
            return Ok((report.kind, report.rung));
        }
        let found = match solver.factor_weighted(0.0, self.metric, 1.0, solid, x) {
            Ok(_) | Err(Unsolvable::Singular) => solver.negative_curvature(),
            Err(error) => Err(error),
        };
        let Ok(found) = found else { return Ok((Stationary::Flat, Rung::Indefinite)) };
        let Some(mut down) = found else { return Ok((Stationary::Minimum, Rung::Cholesky)) };
        let length = self.metric.inner(Vector(&down), Vector(&down)).sqrt();
        down.iter_mut().for_each(|d| *d /= length);
        let mut product = vec![0.0; down.len()];
        if let Some(mut sink) = ProductSink::new(1.0, &down, &mut product) {
            solid.add_hessian(x, &mut sink);
        }
        let curvature = product.iter().zip(&down).map(|(y, d)| y * d).sum();
        Ok((Stationary::Saddle { down: Vector(down), curvature }, Rung::Indefinite))
    }

    /// The size of the force that is left, in the metric.
    fn residual<M, const N: usize, const R: usize, const Q: usize>(
        &self,
        solid: &Solid<M, N, D, R, Q>,
        x: &[f64],
    ) -> f64
    where
        M: Material<D, R>,
    {
        let mut force = vec![0.0; x.len()];
        (solid, self.load).add_differential(x, Covector(&mut force[..]));
        size(self.metric, &force)
    }

    /// A search that ends where it begins: all that is left to find out is what kind of place it is.
    fn ended<L, M, const N: usize, const R: usize, const Q: usize>(
        &self,
        solid: &Solid<M, N, D, R, Q>,
        solver: &mut L,
        x: &mut [f64],
    ) -> Result<EquilibriumReport, ElasticityError>
    where
        L: HessianSolver,
        M: Material<D, R>,
    {
        let Place { step, statics: &Statics { steps, newton, .. }, load, metric } = *self;
        let newton = Newton { tolerance: f64::MAX, ..newton };
        let potential = (solid, load);
        let mut search = Equilibrium::new(metric, &potential, solver, newton)?;
        search.find(x).map_err(|source| ElasticityError::Statics { step, steps, source })
    }
}

/// The reactions at a rest that was found, which must be one.
fn at_rest<M, const N: usize, const D: usize, const R: usize, const Q: usize>(
    solid: &Solid<M, N, D, R, Q>,
    load: &DeadLoad<D>,
    steps: Vec<EquilibriumReport>,
    q: &[f64],
) -> Result<AtRest, ElasticityError>
where
    M: Material<D, R>,
{
    check_hung(solid, load, q)?;
    let inverted = solid.inverted(q)?;
    if !inverted.is_empty() && !M::SMALL_DISPLACEMENTS {
        return Err(ElasticityError::InsideOut(Places(inverted)));
    }
    let differential = solid.held_differential(q)?;
    let reactions = differential.iter().zip(load.at_held()).map(|(dv, f)| dv - f).collect();
    Ok(AtRest { steps, reactions, inverted })
}

/// A force of this part of the load is noticed where it is missing.
const MISSING: f64 = 0.02;

/// Whether the supports bear the load.
fn check_balance<M, const N: usize, const D: usize, const R: usize, const Q: usize>(
    solid: &Solid<M, N, D, R, Q>,
    load: &DeadLoad<D>,
    moved: bool,
    q: &[f64],
) -> Result<(), ElasticityError>
where
    M: Material<D, R>,
{
    let mut size: f64 = load.forces().as_flattened().iter().map(|f| f.abs()).sum();
    if size == 0.0 {
        return Ok(());
    }
    let borne = solid.held_differential(q)?;
    let held = load.at_held();
    if moved {
        // What supports do to each other may be more than the load.
        size += borne.iter().map(|f| f.abs()).sum::<f64>();
    }
    let mut sums = [0.0; D];
    for force in load.forces() {
        sums.iter_mut().zip(force).for_each(|(sum, f)| *sum += f);
    }
    for ((&(_, component), borne), f) in solid.freedoms().held().iter().zip(&borne).zip(held) {
        sums[component] += borne - f;
    }
    let missing = largest(&sums);
    if missing <= MISSING * size {
        Ok(())
    } else {
        Err(ElasticityError::Unbalanced { missing, load: size })
    }
}

/// How much of the residual rounding may be, in the metric: `4 eps |H| max|x|`.
fn rounding<M, const N: usize, const D: usize, const R: usize, const Q: usize>(
    solid: &Solid<M, N, D, R, Q>,
    metric: &DiagonalMetric<Vec<f64>>,
    q: &[f64],
) -> f64
where
    M: Material<D, R>,
{
    let places = q.iter().chain(solid.freedoms().places());
    let farthest = places.fold(0.0, |most: f64, x| most.max(x.abs()));
    let mut sink = RowSizes { rows: vec![0.0; q.len()] };
    solid.add_hessian(q, &mut sink);
    let noise: Vec<f64> = sink.rows.iter().map(|row| 4.0 * f64::EPSILON * farthest * row).collect();
    size(metric, &noise)
}

/// The size of a covector, in the metric.
fn size(metric: &DiagonalMetric<Vec<f64>>, covector: &[f64]) -> f64 {
    let mut acceleration = vec![0.0; covector.len()];
    metric.sharp(Covector(covector), Vector(&mut acceleration));
    covector.iter().zip(&acceleration).map(|(f, a)| f * a).sum::<f64>().sqrt()
}

/// Whether the last residual may be rounding.
fn is_rounding(history: &[f64], rounding: f64) -> bool {
    history.last().is_some_and(|&last| last <= rounding)
}
