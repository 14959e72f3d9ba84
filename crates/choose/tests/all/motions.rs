//! Motions of potentials of one's own.

use std::f64::consts::TAU;
use std::time::{Duration, Instant};

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System};
use stationary_choose::{
    At, Experiment, Judgement, Kind, MeasuredRuns, Moments, Motion, QuestionError, Verdict, answer,
    charted, exhaustive, preferred, refer, way_error,
};
use stationary_integrators::State;
use stationary_integrators::problems::{kepler, oscillator, pendulum};

const LONG: Duration = Duration::from_secs(600);

/// Two wells: `V(q) = a (q^4 / 4 - q^2 / 2)`.
struct Wells(f64);

impl Potential for Wells {
    fn dim(&self) -> usize {
        1
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.0 * (0.25 * q[0].powi(4) - 0.5 * q[0] * q[0])
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        dv.0[0] += self.0 * (q[0].powi(3) - q[0]);
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        hessian.add_symmetric(&[0], &[self.0 * (3.0 * q[0] * q[0] - 1.0)]);
    }
}

fn wells(depth: f64) -> System<DiagonalMetric<[f64; 1]>, Wells> {
    System::new(DiagonalMetric::new([1.0]).unwrap(), Wells(depth)).unwrap()
}

fn at_rest(q: &[f64]) -> State<Vec<f64>> {
    State::new(q.to_vec(), Covector(vec![0.0; q.len()]))
}

#[test]
fn nineteen_in_twenty_choices_are_within_a_tenth_of_the_cheapest_that_exhaustive_search_finds() {
    let (mut asked, mut far) = (0, 0);
    for (depth, start) in
        [(0.2, 2.5), (1.0, 0.1), (1.0, 1.6), (2.0, 0.3), (5.0, 1.9), (10.0, 0.7), (30.0, 1.2)]
    {
        let system = wells(depth);
        let place = |state: &State<Vec<f64>>| vec![state.q[0]];
        let motion = Motion::new(&system, at_rest(&[start]), 12.0, place).unwrap();
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-5] {
            let mut runs = MeasuredRuns::new(&motion, LONG).unwrap();
            let answer = answer(&mut runs, tolerance).unwrap();
            let Verdict::Chosen(chosen) = answer.verdict else { panic!("{answer}") };
            let work = answer.choice().unwrap().work;
            runs.forget();
            let families = preferred(&runs, 1e-3 * tolerance);
            let truth = refer(&mut runs, &families, 1e-3 * tolerance).unwrap();
            let error = way_error(&mut runs, &truth, chosen, tolerance).unwrap();
            assert!(error <= tolerance, "{error:e}\n{answer}");
            // What errs by almost the tolerance may not be told from what errs by more.
            let all: Vec<usize> = (0..motion.ladder().families.len()).collect();
            let best = exhaustive(&mut runs, &all, &truth, 0.9 * tolerance, work);
            let least = best.map_or(work, |best| best.work);
            far += usize::from(work as f64 > 1.1 * least as f64);
            asked += 1;
        }
    }
    assert!(20 * far <= asked, "{far} of {asked}");
}

#[test]
fn the_choice_on_an_ellipse_keeps_to_the_closed_form() {
    let planet = kepler(0.6).unwrap();
    let start = State::new(planet.initial.q.to_vec(), Covector(planet.initial.p.0.to_vec()));
    let horizon = 2.5 * planet.period;
    let place = |state: &State<Vec<f64>>| state.q.clone();
    let motion = Motion::new(&planet.system, start, horizon, place).unwrap();
    for tolerance in [1e-2, 1e-4, 1e-6, 1e-9] {
        let mut runs = MeasuredRuns::new(&motion, LONG).unwrap();
        let answer = answer(&mut runs, tolerance).unwrap();
        let at = answer.choice().unwrap_or_else(|| panic!("{answer}")).at;
        let (run, scale) = (runs.measure(at), answer.reference.as_ref().unwrap().course.scale);
        for (moment, q) in run.whole().unwrap().values.iter().enumerate().skip(1) {
            let t = horizon * moment as f64 / 20.0;
            let off = planet.error(t, &[q[0], q[1]]).unwrap();
            assert!(off <= tolerance * scale, "{off:e} at {t}\n{answer}");
        }
        // Few steps of a high order are what many digits ask for.
        let order = runs.family(at.family).order;
        assert!(tolerance > 1e-5 || order >= 6, "{answer}");
    }
}

#[test]
fn moments_at_whole_and_half_periods_hide_no_phase() {
    let (mass_on_a_spring, omega) = (oscillator(TAU).unwrap(), TAU);
    let potential = |state: &State<Vec<f64>>| vec![0.5 * (omega * state.q[0]).powi(2)];
    for periods in [10.0, 20.0] {
        let system = &mass_on_a_spring.system;
        let motion = Motion::new(system, at_rest(&[1.0]), periods, potential).unwrap();
        for tolerance in (116..122).map(|k| 10_f64.powf(-0.05 * f64::from(k))) {
            let mut runs = MeasuredRuns::new(&motion, LONG).unwrap();
            let answer = answer(&mut runs, tolerance).unwrap();
            let at = answer.choice().unwrap_or_else(|| panic!("{answer}")).at;
            let halvings = match runs.family(at.family).kind {
                Kind::EqualSteps => at.rung as u32,
                _ => 5,
            };
            let moments = Moments::closely(halvings, periods);
            let own = motion.look(at, &moments, Instant::now() + LONG).unwrap();
            let promised = tolerance * answer.reference.as_ref().unwrap().course.scale;
            for (t, value) in moments.times.iter().zip(&own.values[1..]) {
                let off = (value[0] - 0.5 * (omega * (omega * t).cos()).powi(2)).abs();
                assert!(off <= promised, "{off:e} of {promised:e} at {t}\n{answer}");
            }
        }
    }
}

#[test]
fn an_energy_is_judged_by_the_kinetic_energy_or_said_hardly_to_move() {
    let swing = pendulum(2.0).unwrap();
    let system = &swing.system;
    let start = State::new(swing.initial.q.to_vec(), Covector(swing.initial.p.0.to_vec()));
    let energy = |state: &State<Vec<f64>>| vec![system.energy(&state.q, state.p.view())];
    let motion = Motion::new(system, start, 10.0, energy).unwrap();
    let still = answer(&mut MeasuredRuns::new(&motion, LONG).unwrap(), 1e-3).unwrap();
    assert_eq!(still.verdict, Verdict::Still, "{still}");
    let motion = motion.relative_to_kinetic_energy().named("a pendulum", "energy");
    let chosen = answer(&mut MeasuredRuns::new(&motion, LONG).unwrap(), 1e-3).unwrap();
    assert!(matches!(chosen.verdict, Verdict::Chosen(_)), "{chosen}");
    assert!(chosen.heading.starts_with("a pendulum: energy, relative to the largest kinetic"));
}

#[test]
fn all_families_can_be_charted() {
    let system = wells(1.0);
    let motion = Motion::new(&system, at_rest(&[0.5]), 5.0, |s| vec![s.q[0]]).unwrap();
    let mut runs = MeasuredRuns::new(&motion, LONG).unwrap();
    let answer = answer(&mut runs, 1e-3).unwrap();
    let all = charted(&mut runs, answer);
    for family in &motion.ladder().families {
        assert!(all.rows.iter().any(|row| row.method == family.name), "{}", family.name);
    }
    assert!(stationary_choose::picture(&all).unwrap().starts_with("<svg"));
}

#[test]
fn what_cannot_be_asked_is_refused_by_its_name() {
    let system = wells(1.0);
    let ask = |start: State<Vec<f64>>, horizon: f64, value: f64| {
        Motion::new(&system, start, horizon, move |_| vec![value]).map(|_| ()).unwrap_err()
    };
    assert!(matches!(ask(at_rest(&[0.0, 1.0]), 1.0, 0.0), QuestionError::Size(_)));
    let what = "the configuration";
    assert_eq!(ask(at_rest(&[f64::NAN]), 1.0, 0.0), QuestionError::NotFinite { what, place: 0 });
    let what = "the observable";
    assert_eq!(
        ask(at_rest(&[0.5]), 1.0, f64::INFINITY),
        QuestionError::NotFinite { what, place: 0 }
    );
    for horizon in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(ask(at_rest(&[0.5]), horizon, 0.0), QuestionError::Horizon(_)));
    }
    let nothing = Motion::new(&system, at_rest(&[0.5]), 1.0, |_| Vec::new());
    assert_eq!(nothing.map(|_| ()).unwrap_err(), QuestionError::NothingObserved);
    let motion = Motion::new(&system, at_rest(&[0.5]), 1.0, |s| vec![s.q[0]]).unwrap();
    assert_eq!(
        MeasuredRuns::new(&motion, Duration::ZERO).map(|_| ()).unwrap_err(),
        QuestionError::Budget(Duration::ZERO)
    );
    let mut runs = MeasuredRuns::new(&motion, LONG).unwrap();
    for tolerance in [0.0, -1.0, 1.0, f64::NAN, 1e-13] {
        assert!(matches!(answer(&mut runs, tolerance), Err(QuestionError::Tolerance(_))));
    }
}

/// A tolerance that is a part of such a number is zero, or infinite.
#[test]
fn tiny_numbers_at_the_start_and_a_tiny_horizon_are_no_reason_to_refuse_a_question() {
    let system = wells(1.0);
    let tiny = 5e-324;
    let place = |state: &State<Vec<f64>>| vec![state.q[0]];
    let pushed = State::new(vec![0.5], Covector(vec![tiny]));
    for (start, horizon) in [(pushed, 5.0), (at_rest(&[tiny]), 5.0), (at_rest(&[0.5]), 1e-310)] {
        Motion::new(&system, start, horizon, place).unwrap();
    }
    let pushed = State::new(vec![0.5], Covector(vec![tiny]));
    let motion = Motion::new(&system, pushed, 5.0, place).unwrap();
    let answer = answer(&mut MeasuredRuns::new(&motion, LONG).unwrap(), 1e-3).unwrap();
    assert!(answer.choice().is_some(), "{answer}");
}

#[test]
fn an_observable_that_stops_being_a_number_is_a_failure_and_not_a_choice() {
    let system = wells(1.0);
    let root = |state: &State<Vec<f64>>| vec![(state.q[0] - 0.4).sqrt()];
    let motion = Motion::new(&system, at_rest(&[1.6]), 6.0, root).unwrap();
    let mut runs = MeasuredRuns::new(&motion, LONG).unwrap();
    let answer = answer(&mut runs, 1e-2).unwrap();
    assert!(answer.choice().is_none(), "{answer}");
}

#[test]
fn a_bounded_search_ends_and_names_nothing_that_was_not_run() {
    let system = wells(1.0);
    let motion = Motion::new(&system, at_rest(&[0.1]), 200.0, |s| vec![s.q[0]]).unwrap();
    for most in [0, 10, 1_000, 100_000] {
        let mut runs = MeasuredRuns::new(&motion, LONG).unwrap().bounded(most);
        let answer = answer(&mut runs, 1e-6).unwrap();
        if let Some(row) = answer.choice() {
            assert!(runs.used().any(|(at, run)| at == row.at && run.whole().is_some()));
            assert!(matches!(row.judgement, Some(Judgement::Meets(_))));
        }
    }
}

#[test]
fn a_rung_runs_the_same_twice_and_as_it_is_looked_at() {
    let system = wells(1.0);
    let motion = Motion::new(&system, at_rest(&[0.3]), 7.0, |s| vec![s.q[0]]).unwrap();
    for (family, own) in motion.ladder().families.iter().enumerate() {
        let at = At { family, rung: if own.kind == Kind::EqualSteps { 3 } else { 2 } };
        let (mut one, mut two) =
            (MeasuredRuns::new(&motion, LONG).unwrap(), MeasuredRuns::new(&motion, LONG).unwrap());
        let (a, b) = (one.measure(at).clone(), two.measure(at).clone());
        assert_eq!(a.course, b.course, "{}", own.name);
        assert_eq!(a.work, b.work, "{}", own.name);
        let Some(course) = a.whole() else { continue };
        let moments = stationary_choose::Moments::equal(0, 7.0);
        let look = motion.look(at, &moments, std::time::Instant::now() + LONG).unwrap();
        // Six moments a twentieth: five within it, and its end.
        for (moment, value) in course.values.iter().enumerate() {
            let off = (look.values[6 * moment][0] - value[0]).abs();
            assert!(off <= 1e-12, "{} {moment}: {off:e}", own.name);
        }
    }
}
