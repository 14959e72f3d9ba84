//! What digits cost where one part of a system oscillates much faster than the rest.

use stationary_integrators::problems::{fermi_pasta_ulam, spring_chain};
use stationary_integrators::{Evaluation, Method, Nodes, Scheme};

use super::reference::{Samples, with_reference};
use super::work_precision::{self, Contest};
use crate::studies::cheapest::Asked;
use crate::study::{Entry, Kind, StudyError, Tested};

/// Work on the chain of Fermi, Pasta, Ulam and Tsingou.
pub const FERMI_PASTA_ULAM: Entry<'static> = Entry {
    id: "fermi-pasta-ulam-work-precision",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::WorkPrecision,
    title: "Springs stiff and soft in turn: error against cost",
    tested: Tested::ByReport,
    run: &|_| {
        let mut problem = fermi_pasta_ulam(50.0).map_err(StudyError::at("the springs in turn"))?;
        problem.horizon = 10.0;
        let at = Samples { count: 100, coarsest: 256 };
        let problem = with_reference(problem, at)?;
        let contest = Contest {
            methods: CONTENDERS,
            cheapest: [
                (1e-2, "blanes-moan-nystrom-6"),
                (1e-4, "blanes-moan-nystrom-6"),
                (1e-8, "blanes-moan-nystrom-6"),
            ],
            motion: "ten seconds of six masses on springs that are stiff, of frequency 50, and \
                     soft in turn",
            asked: Some(Asked {
                question: "Stiff springs whose oscillation matters, to 1e-4",
                error: 1e-4,
                cost: "evaluations",
                rival: "stormer-verlet",
            }),
        };
        work_precision::study(FERMI_PASTA_ULAM, &problem, |m| steps(m, at.count), &contest)
    },
};

/// Work on a stiff chain that moves slowly, with a ripple on it.
pub const SPRING_CHAIN: Entry<'static> = Entry {
    id: "spring-chain-work-precision",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::WorkPrecision,
    title: "Stiff chain of springs: error against cost",
    tested: Tested::ByReport,
    run: &|_| {
        let problem = spring_chain(16, 1e4).map_err(StudyError::at("the chain"))?;
        let contest = Contest {
            methods: CONTENDERS,
            cheapest: [
                (1e-2, "stormer-verlet"),
                (1e-4, "blanes-moan-nystrom-6"),
                (1e-6, "blanes-moan-nystrom-6"),
            ],
            motion: "one slow turn of a chain of 16 masses on stiff springs, with a ripple of its \
                     fastest mode",
            asked: None,
        };
        work_precision::study(SPRING_CHAIN, &problem, |m| steps(m, 1), &contest)
    },
};

const CONTENDERS: &[Method] = &[
    Method::StormerVerlet,
    Method::RungeKutta4,
    Method::ImplicitMidpoint,
    Method::Composition(Scheme::BlanesMoanNystrom4),
    Method::Composition(Scheme::BlanesMoanNystrom6),
    Method::Composition(Scheme::KahanLi8),
    Method::GaussLegendre(Nodes::Three),
    Method::GeneralizedAlpha,
];

/// Powers of two times the samples, up to a number of evaluations.
fn steps(method: Method, samples: u64) -> Vec<u64> {
    let facts = method.facts();
    let most = if facts.evaluation == Evaluation::Implicit { 1 << 13 } else { 1 << 16 };
    let within = |n: &u64| *n * u64::from(facts.stages) <= most;
    (0..=20).map(|k| samples << k).filter(|n| *n >= 16).take_while(within).collect()
}
