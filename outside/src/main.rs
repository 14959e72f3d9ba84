//! How should a ball be run that rolls in a track of two wells, for its place to a thousandth?

use std::{error::Error, time::Duration};

use stationary::calculus::{Covector, DiagonalMetric, Potential, Sink, System};
use stationary::choose::{MeasuredRuns, Motion, answer, picture};
use stationary::integrators::State;

struct Track; // V(q) = q^4 / 4 - q^2 / 2, joules

impl Potential for Track {
    #[rustfmt::skip]
    fn dim(&self) -> usize { 1 }
    #[rustfmt::skip]
    fn energy(&self, q: &[f64]) -> f64 { 0.25 * q[0].powi(4) - 0.5 * q[0] * q[0] }
    #[rustfmt::skip]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) { dv.0[0] += q[0].powi(3) - q[0]; }
    #[rustfmt::skip]
    fn add_hessian(&self, q: &[f64], h: &mut impl Sink) { h.add_symmetric(&[0], &[3.0 * q[0] * q[0] - 1.0]); }
}

fn main() -> Result<(), Box<dyn Error>> {
    let system = System::new(DiagonalMetric::new([1.0])?, Track)?;
    let start = State::new(vec![0.1], Covector(vec![0.0]));
    let motion = Motion::new(&system, start, 20.0, |state| vec![state.q[0]])?;
    let mut runs = MeasuredRuns::new(&motion, Duration::from_secs(60))?;
    let answer = answer(&mut runs, 1e-3)?;
    println!("{answer}");
    std::fs::write("choice.svg", picture(&answer)?)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use stationary::choose::{Experiment, Verdict, exhaustive, preferred, refer, way_error};

    use super::*;

    #[test]
    fn the_choice_is_true_and_no_setting_is_cheaper_by_more_than_a_tenth() {
        let system = System::new(DiagonalMetric::new([1.0]).unwrap(), Track).unwrap();
        let start = State::new(vec![0.1], Covector(vec![0.0]));
        let motion = Motion::new(&system, start, 20.0, |state| vec![state.q[0]]).unwrap();
        for tolerance in [1e-2, 1e-3, 1e-4] {
            let mut runs = MeasuredRuns::new(&motion, Duration::from_secs(600)).unwrap();
            let answer = answer(&mut runs, tolerance).unwrap();
            let Verdict::Chosen(chosen) = answer.verdict else { panic!("{answer}") };
            let work = answer.choice().unwrap().work;
            runs.forget();
            let families = preferred(&runs, 1e-3 * tolerance);
            let truth = refer(&mut runs, &families, 1e-3 * tolerance).unwrap();
            assert!(way_error(&mut runs, &truth, chosen, tolerance).unwrap() <= tolerance);
            let all: Vec<usize> = (0..motion.ladder().families.len()).collect();
            let best = exhaustive(&mut runs, &all, &truth, 0.9 * tolerance, work);
            assert!(best.is_none_or(|best| work as f64 <= 1.1 * best.work as f64), "{answer}");
        }
    }
}
