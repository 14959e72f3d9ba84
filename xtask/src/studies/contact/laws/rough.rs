//! Impacts with friction, of one body on a floor: energy, the cone, and closed forms.
//!
//! ```text
//! lambda = (1 + c) v,   beta = -s/(1 + m r^2/I) where |beta| <= mu lambda, else mu lambda against s
//! ```
//! A disc of radius `r` (m), mass `m` (kg) and moment `I` (kg m^2) that falls at `v` and slides at `s`
//! (m/s) where it touches; a box that lands flat turns nowhere, and slides. Source: Garwin 1969.

use nalgebra::Vector2;
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_contact::{
    ContactError, ImpactLaw, PlanarCollider, PlanarDetector, PlanarShape, World,
};
use stationary_integrators::State;
use stationary_measure::Cell;
use stationary_rigid::{LieGroup, PlanarMotion, PlanarWeight};

use crate::study::Claim;

/// Friction of the columns; the first stands in the column of all impacts.
const FRICTIONS: [f64; 3] = [0.0, 0.2, 0.5];
/// Restitution.
const RESTITUTION: f64 = 0.6;
/// The step, s: there is no force, and all of it is the impact.
const STEP: f64 = 1e-6;

/// A body of 1 kg that touches the floor: how it lies and moves.
struct Thrown {
    name: &'static str,
    shape: Result<PlanarShape, ContactError>,
    inertia: f64,
    q: [f64; 3],
    v: [f64; 3],
    /// The velocity after, where it is known.
    expected: fn(&Thrown, f64) -> Option<[f64; 3]>,
}

/// What a law did to a thrown body.
pub(super) struct RoughScore {
    name: &'static str,
    gained: [f64; 3],
    passes: usize,
    outside: f64,
    off: Option<f64>,
}

fn thrown() -> [Thrown; 4] {
    let rod = [1.0_f64, 0.05];
    let (s, c) = 0.8_f64.sin_cos();
    let disc = |name, v| Thrown {
        name,
        shape: PlanarShape::disc(0.5),
        inertia: 0.125,
        q: [0.0, 0.5, 0.0],
        v,
        expected: disc_after,
    };
    [
        disc("disc that slides", [3.0, -2.0, 0.0]),
        disc("disc that grips", [0.2, -2.0, 1.0]),
        Thrown {
            name: "box thrown flat",
            shape: PlanarShape::cuboid([0.5; 2]),
            inertia: 1.0 / 6.0,
            q: [0.0, 0.5, 0.0],
            v: [5.0, -3.0, 0.0],
            expected: |thrown, mu| {
                let pushed = -(1.0 + RESTITUTION) * thrown.v[1];
                Some([thrown.v[0] - mu * pushed, -RESTITUTION * thrown.v[1], 0.0])
            },
        },
        Thrown {
            name: "rod on its end",
            shape: PlanarShape::cuboid(rod),
            inertia: (rod[0] * rod[0] + rod[1] * rod[1]) / 3.0,
            q: [0.0, rod[0] * s + rod[1] * c, -0.8],
            v: [2.0, -3.0, 1.0],
            expected: |_, _| None,
        },
    ]
}

fn disc_after(thrown: &Thrown, mu: f64) -> Option<[f64; 3]> {
    let ([vx, vy, spin], r) = (thrown.v, thrown.q[1]);
    let (pushed, slip) = (-(1.0 + RESTITUTION) * vy, vx + r * spin);
    let grip = -slip / (1.0 + r * r / thrown.inertia);
    let rubbed = grip.clamp(-mu * pushed, mu * pushed);
    Some([vx + rubbed, -RESTITUTION * vy, spin + r * rubbed / thrown.inertia])
}

/// The velocity after, how many passes, and how far an impulse is outside of its cone.
fn hit(law: ImpactLaw, thrown: &Thrown, mu: f64) -> Result<([f64; 3], usize, f64), ContactError> {
    let masses = [1.0, 1.0, thrown.inertia];
    let metric = DiagonalMetric::new(masses.to_vec())?;
    let weight = PlanarWeight { gravity: Vector2::zeros(), masses: vec![1.0] };
    let floor = PlanarShape::half_plane(Vector2::y())?;
    let body = PlanarCollider::on_body(0, thrown.shape.clone()?).with_restitution(RESTITUTION);
    let floor = PlanarCollider::fixed(PlanarMotion::identity(), floor).with_friction(mu);
    let detector = PlanarDetector::new(vec![body.with_friction(mu), floor], 1)?;
    let mut world = World::new(System::new(metric, weight)?, detector)?.with_law(law);
    let p = [0, 1, 2].map(|k| masses[k] * thrown.v[k]);
    let mut state = State::new(thrown.q.to_vec(), Covector(p.to_vec()));
    let report = world.step(&mut state, STEP)?;
    let outside = |touch: stationary_contact::Touch<stationary_contact::Planar>| {
        let pushed = touch.impact + touch.normal;
        (touch.friction.norm() - mu * pushed) / pushed.max(f64::MIN_POSITIVE)
    };
    let outside = world.touches().map(outside).fold(0.0, f64::max);
    Ok(([0, 1, 2].map(|k| state.p.0[k] / masses[k]), report.impacts, outside))
}

/// A law on each thrown body.
pub(super) fn scored(law: ImpactLaw) -> Result<Vec<RoughScore>, ContactError> {
    let score = |thrown: &Thrown| {
        let kinetic = |v: [f64; 3]| v[0] * v[0] + v[1] * v[1] + thrown.inertia * v[2] * v[2];
        let mut score =
            RoughScore { name: thrown.name, gained: [0.0; 3], passes: 0, outside: 0.0, off: None };
        for (gained, mu) in score.gained.iter_mut().zip(FRICTIONS) {
            let (v, passes, outside) = hit(law, thrown, mu)?;
            *gained = kinetic(v) / kinetic(thrown.v) - 1.0;
            score.passes = score.passes.max(passes);
            score.outside = score.outside.max(outside);
            let expected = (thrown.expected)(thrown, mu).filter(|_| law != ImpactLaw::Inelastic);
            if let Some(expected) = expected {
                let off = (0..3).map(|k| (v[k] - expected[k]).abs()).fold(0.0, f64::max);
                score.off = Some(score.off.map_or(off, |most| off.max(most)));
            }
        }
        Ok(score)
    };
    thrown().iter().map(score).collect()
}

impl RoughScore {
    /// The row of the table.
    pub(super) fn cells(&self, law: ImpactLaw) -> Vec<Cell> {
        let dash = || Cell::from("-");
        let [smooth, some, more] = self.gained.map(Cell::from);
        let off = self.off.map_or_else(dash, Cell::from);
        vec![
            law.facts().name.into(),
            self.name.into(),
            smooth,
            dash(),
            dash(),
            dash(),
            (self.passes as u64).into(),
            dash(),
            some,
            more,
            self.outside.into(),
            off,
        ]
    }
}

/// What a law promises with friction.
pub(super) fn claims(law: ImpactLaw, scores: &[RoughScore]) -> Vec<Claim> {
    let name = law.facts().name;
    let most = |of: fn(&RoughScore) -> f64| scores.iter().map(of).fold(0.0, f64::max);
    let gained = most(|score| score.gained.into_iter().fold(f64::NEG_INFINITY, f64::max));
    let small = |text: &str, value: f64| {
        Claim::number(format!("{name} with friction: {text}"), "below 1e-9", value, (0.0, 1e-9))
    };
    let mut claims = vec![
        small("energy gained", gained),
        small("outside of the cone, part", most(|score| score.outside)),
    ];
    if law == ImpactLaw::GeneralizedReflections {
        let off = most(|score| score.off.unwrap_or(0.0));
        claims.push(small("off the closed forms, m/s", off));
    }
    claims
}
