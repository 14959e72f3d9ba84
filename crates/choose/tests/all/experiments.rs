//! Experiments of one's own, good and bad.

use std::time::{Duration, Instant};

use stationary_choose::{
    At, Experiment, Failure, Family, Kind, Ladder, Look, MeasuredRuns, Moments, QuestionError,
    Record, Samples, Scale, Verdict, Watch, answer, equal_steps,
};
use stationary_integrators::Evaluation;

const LONG: Duration = Duration::from_secs(60);

/// `x' = -x` by methods of made-up errors: `x(t) = exp(-t) + c h^k sin t`.
struct Made {
    ladder: Ladder,
    constants: Vec<f64>,
    /// Errors rung by rung instead, where there are any.
    told: Vec<f64>,
    fault: Fault,
}

#[derive(Clone, Copy, PartialEq)]
enum Fault {
    None,
    /// Rows stop half way.
    Short,
    /// It says nothing at moments.
    Silent,
    /// No number.
    NotFinite,
    /// Looks have too few moments.
    Blind,
}

fn family(name: &str, order: u32, stages: u64) -> Family {
    Family {
        name: name.to_owned(),
        model: 0,
        simplicity: 0,
        on_mesh: false,
        kind: Kind::EqualSteps,
        order,
        evaluation: Evaluation::Explicit,
        holds_constraints: false,
        is_closed: false,
        rungs: equal_steps(2.0, 0, stages).collect(),
    }
}

fn made(fault: Fault) -> Made {
    let families = vec![family("first", 1, 1), family("second", 2, 2), family("fourth", 4, 6)];
    Made {
        ladder: Ladder {
            title: "a decay".to_owned(),
            observable: "x".to_owned(),
            scale: Scale::Largest,
            horizon: 2.0,
            time: "s".to_owned(),
            keeps_energy: false,
            is_smooth: true,
            is_joined: false,
            placed: Vec::new(),
            is_constrained: false,
            asks: None,
            families,
            finer: Vec::new(),
        },
        constants: vec![0.3, -0.2, 0.4],
        told: Vec::new(),
        fault,
    }
}

impl Made {
    fn x(&self, at: At, t: f64) -> f64 {
        let family = &self.ladder.families[at.family];
        let error = family.rungs[at.rung].setting.powi(family.order as i32);
        let error = self.constants[at.family] * error;
        (-t).exp() + self.told.get(at.rung).copied().unwrap_or(error) * t.sin()
    }
}

impl Experiment for Made {
    fn ladder(&self) -> &Ladder {
        &self.ladder
    }

    fn run(&self, at: At, _: Option<usize>, watch: &mut Watch<'_>) -> Record {
        let mut samples = Samples::default();
        samples.push(&[self.x(at, 0.0)], None, &[]);
        let work = self.ladder.families[at.family].rungs[at.rung].least_work;
        for moment in 1..=20_u64 {
            let t = 0.1 * moment as f64;
            let x = if self.fault == Fault::NotFinite { f64::NAN } else { self.x(at, t) };
            samples.push(&[x], None, &[]);
            if self.fault == Fault::Short && moment == 10 {
                break;
            }
            let silent = self.fault == Fault::Silent;
            if !silent && watch.moment(&[x], work * moment / 20).is_break() {
                break;
            }
        }
        Record { samples, each: 1, work, ..Record::default() }
    }

    fn look(&self, at: At, moments: &Moments, _: Instant) -> Option<Look> {
        let mut samples = Samples::default();
        let times = [0.0].into_iter().chain(moments.times.iter().copied());
        times.for_each(|t| samples.push(&[self.x(at, t)], None, &[]));
        let work = self.ladder.families[at.family].rungs[at.rung].least_work;
        let mut look = Look::of(&samples, work);
        if self.fault == Fault::Blind {
            look.values.pop();
        }
        Some(look)
    }
}

#[test]
fn the_cheapest_of_methods_with_known_errors_is_found() {
    let made = made(Fault::None);
    for tolerance in [1e-1, 1e-2, 1e-4, 1e-6, 1e-8] {
        let answer = answer(&mut MeasuredRuns::new(&made, LONG).unwrap(), tolerance).unwrap();
        let Verdict::Chosen(at) = answer.verdict else { panic!("{answer}") };
        let error = |at: At| {
            let setting = made.ladder.families[at.family].rungs[at.rung].setting;
            let order = made.ladder.families[at.family].order as i32;
            made.constants[at.family].abs() * setting.powi(order)
        };
        assert!(error(at) <= tolerance, "{answer}");
        let all = (0..3).flat_map(|family| (0..20).map(move |rung| At { family, rung }));
        let work = |at: &At| made.ladder.families[at.family].rungs[at.rung].least_work;
        // A twentieth is kept for what lies between moments.
        let least = all.filter(|at| 1.1 * error(*at) <= tolerance).map(|at| work(&at)).min();
        assert!(work(&at) as f64 <= 1.1 * least.unwrap() as f64, "{answer}");
    }
}

#[test]
fn runs_with_impacts_that_come_near_each_other_by_luck_are_no_reference_where_no_other_method_is() {
    let mut made = made(Fault::None);
    made.ladder.families.truncate(1);
    made.ladder.families[0].order = 2;
    made.ladder.is_smooth = false;
    // Errors of a sheet that bounces off a ball: halved with the step, but for one pair.
    made.told = vec![0.17, 0.09, 0.047, 0.0212, 0.0202, 0.01];
    made.told.extend((0..14).map(|k| 0.0046 * 0.5_f64.powi(k)));
    let answer = answer(&mut MeasuredRuns::new(&made, LONG).unwrap(), 1e-2).unwrap();
    let Verdict::Chosen(at) = answer.verdict else { panic!("{answer}") };
    assert!(made.told[at.rung] <= 1e-2, "{answer}");
}

#[test]
fn an_experiment_that_does_not_do_what_it_should_chooses_nothing() {
    for fault in [Fault::Short, Fault::Silent, Fault::NotFinite, Fault::Blind] {
        let made = made(fault);
        let answer = answer(&mut MeasuredRuns::new(&made, LONG).unwrap(), 1e-3).unwrap();
        assert!(answer.choice().is_none(), "{answer}");
    }
}

#[test]
fn a_run_that_says_why_it_failed_is_told_with_it() {
    struct Failing(Made);
    impl Experiment for Failing {
        fn ladder(&self) -> &Ladder {
            self.0.ladder()
        }
        fn run(&self, at: At, finer: Option<usize>, watch: &mut Watch<'_>) -> Record {
            let failure = Some(Failure::NotConverged("the wind is too strong".to_owned()));
            match at.family {
                0 => Record { failure, ..Record::default() },
                _ => self.0.run(at, finer, watch),
            }
        }
        fn look(&self, at: At, moments: &Moments, deadline: Instant) -> Option<Look> {
            self.0.look(at, moments, deadline)
        }
    }
    let failing = Failing(made(Fault::None));
    let answer = answer(&mut MeasuredRuns::new(&failing, LONG).unwrap(), 1e-1).unwrap();
    assert!(answer.choice().is_some(), "{answer}");
    assert!(answer.to_string().contains("not converged: the wind is too strong"), "{answer}");
}

#[test]
fn a_ladder_that_cannot_be_searched_is_refused() {
    let ask = |change: fn(&mut Ladder)| {
        let mut made = made(Fault::None);
        change(&mut made.ladder);
        MeasuredRuns::new(&made, LONG).map(|_| ()).unwrap_err()
    };
    assert_eq!(ask(|ladder| ladder.families.clear()), QuestionError::NoFamily);
    assert_eq!(
        ask(|ladder| ladder.families.iter_mut().for_each(|family| family.model = 1)),
        QuestionError::NoFamily
    );
    assert!(matches!(ask(|ladder| ladder.horizon = f64::NAN), QuestionError::Horizon(_)));
    assert_eq!(
        ask(|ladder| ladder.families[1].rungs.clear()),
        QuestionError::NoSetting("second".to_owned())
    );
    let order = |rung| QuestionError::Order { family: "second".to_owned(), rung };
    assert_eq!(ask(|ladder| ladder.families[1].rungs[3].setting = 9.0), order(3));
    assert_eq!(ask(|ladder| ladder.families[1].rungs[2].least_work = 0), order(2));
}
