//! Scenes of the plane and of space, judged at every step.

use stationary_contact::ContactError;

use super::case::{Case, drawn};
use super::engine::Engine;
use super::refined::compared;
use super::step::Referee;
use super::{planar, spatial};
use crate::{Draw, Kind, Verdict};

const RULE: &str = "a body's momentum off the impulses told, or what the report says of energies, by \
                    1e-9; energy above lifting, obstacles and what the residuals reported allow, by \
                    1e-9; an impulse that pulls or is out of its cone; conditions off by more than \
                    reported, or settled beyond what was asked; a body deeper in another on its way, \
                    by 1e-5 of it, than turning and the residual allow; every twentieth: off \
                    the one of steps a hundred times smaller by more than 20 h V, times how starts \
                    grow apart. A step that is not settled is refused; \
                    one in which the energy allows turns of 1e4 rad may be";

pub(super) const PLANAR: Kind = Kind {
    name: "planar-contact",
    krate: "contact",
    rule: RULE,
    in_tests: 100,
    trial: |draw| trial(draw, |draw| drawn(draw, true)),
};

pub(super) const SPATIAL: Kind = Kind {
    name: "spatial-contact",
    krate: "contact",
    rule: RULE,
    in_tests: 60,
    trial: |draw| trial(draw, |draw| drawn(draw, false)),
};

pub(super) const ROLLING: Kind = Kind {
    name: "rolling-contact",
    krate: "contact",
    rule: "scenes of the plane and of space whose pairs have rolling and torsional friction, by the \
           rules of planar-contact and spatial-contact; a moment beyond its length times the normal \
           impulse, by more than the residual reported",
    in_tests: 60,
    trial: |draw| {
        trial(draw, |draw| {
            let flat = draw.chance(0.5);
            drawn(draw, flat).rolling(draw)
        })
    },
};

pub(super) const LANDING: Kind = Kind {
    name: "flat-landings",
    krate: "contact",
    rule: "boxes of the plane and of space that land nearly flat, by the rules of planar-contact and \
           spatial-contact: what one corner hits takes another along",
    in_tests: 100,
    trial: |draw| {
        trial(draw, |draw| {
            let flat = draw.chance(0.5);
            drawn(draw, flat).landing(draw)
        })
    },
};

fn made(case: &Case) -> Result<Box<dyn Engine>, ContactError> {
    Ok(match case.flat {
        true => Box::new(planar::Scene::new(case)?),
        false => Box::new(spatial::Scene::new(case)?),
    })
}

fn trial(draw: &mut Draw, drawn: fn(&mut Draw) -> Case) -> Verdict {
    let refined = draw.chance(0.05);
    let case = drawn(draw);
    let mut engine = match made(&case) {
        Ok(engine) => engine,
        Err(error) => return Verdict::refused(error),
    };
    let mut verdict = Verdict::due();
    if refined {
        verdict = compared(made, &case).unwrap_or(verdict);
    }
    let mut referee = Referee::new(&case);
    let mut before = engine.motions();
    for step in 0..case.steps {
        let report = match engine.step(case.step) {
            Ok(report) => report,
            Err(ContactError::Turn { .. }) if referee.may_turn_far(&before) => return verdict,
            Err(error) => return verdict.and(Verdict::refused(error)),
        };
        let after = engine.motions();
        let word = referee.judge(&before, &after, &engine.touches(), &report);
        if let Verdict::Wrong { ratio, what } = word {
            return Verdict::Wrong { ratio, what: format!("step {step}: {what}") };
        }
        verdict = verdict.and(word);
        if !report.settled {
            verdict = verdict.and(Verdict::refused("not settled"));
        }
        if let Err(error) = engine.reload() {
            return Verdict::Wrong { ratio: f64::INFINITY, what: format!("step {step}: {error}") };
        }
        before = after;
    }
    verdict
}
