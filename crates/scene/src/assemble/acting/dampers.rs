//! Drag and dampers all at once: what they give to momenta does not depend on their order.
//!
//! ```text
//! p' = p - y p^ + J^T l,    l = -x (J M^-1 p^ + r_0)       x = h c,  y = h c/m of the drag,  h the time that they act
//! p^ = p' at the start of a step,    p^ = p at its end: one is the other backward
//! (1 + s Y s) w = s r,   l = -s w,   Y = J N J^T,   r = J N p + r_0,   s = sqrt(x),   N = 1/(m (1 + y))   at the start
//! W_k = l_k (r_k + r_k')/2                                 of what moves, without r_0; of drag alike
//! ```
//! Dampers that share what they hold back are solved together by conjugate gradients, scaled by the diagonal; their
//! matrix is no less than one. Where these do not converge, where impulses cancel on what is light (`e` above
//! [`CANCELS`]), or `h < 0`, a matrix is factored (see `dampers/direct.rs`). One after another, stiff ones of unlike
//! masses would throw what they hold faster with every step.
//!
//! ```text
//! e = eps max_k |J_k| N |J^T| |l| / max_k |r_k|
//! ```

mod direct;

use std::collections::BTreeMap;

use super::rate::{Rate, RateNow};
use super::{Act, End, What, shifts};
use crate::text::limits::FULL_MATRIX_FREEDOMS;

/// The rounding to which rates are solved, and the most iterations a damper, and beside.
const ROUNDING: f64 = 1e-16;
const MOST: [usize; 2] = [10, 100];
/// The largest error of a rate, over the largest rate, that cancelling impulses may leave.
const CANCELS: f64 = 1e-10;

/// The drag and the dampers of a scene, in the order of what acts.
#[derive(Clone, Debug)]
pub(super) struct Dampers {
    /// Which act the drag is, and the force of it over the velocity of each freedom.
    drag: Option<(usize, Vec<f64>)>,
    all: Vec<Held>,
    /// Those that share freedoms.
    groups: Vec<Vec<usize>>,
    /// Impulses of dampers on freedoms.
    pulls: Vec<f64>,
    /// One over the masses that dampers feel under the drag.
    felt: Vec<f64>,
    /// The unknowns of a group that was not solved.
    unsolved: Option<usize>,
}

/// A damper and what holds back its rate now.
#[derive(Clone, Debug)]
pub(super) struct Held {
    act: usize,
    viscosity: f64,
    rate: Rate,
    now: RateNow,
    impulse: f64,
    /// The part of the rate that momenta make, and all of it.
    own: f64,
    whole: f64,
    /// What a unit impulse changes of it.
    yields: f64,
    root: f64,
    /// What is left of the equation, the way on, and the matrix along it.
    left: f64,
    way: f64,
    along: f64,
    /// What it gives to freedoms beside, so that the impulses of all are exact together.
    beside: Vec<(usize, f64)>,
}

impl Dampers {
    pub(super) fn of(acts: &[Act], freedoms: usize, (each, dimension): (usize, usize)) -> Self {
        let drag = acts.iter().position(|act| matches!(act.what, What::Drag(_)));
        let drag = drag.map(|act| {
            let mut all = vec![0.0; freedoms];
            if let What::Drag(c) = acts[act].what {
                shifts(freedoms, each, dimension).for_each(|freedom| all[freedom] = c);
            }
            (act, all)
        });
        let mut of_things: Vec<usize> = (0..freedoms / each).collect();
        let mut all: Vec<Held> = Vec::new();
        for (act, Act { what, .. }) in acts.iter().enumerate() {
            let What::Damper(viscosity, rate) = what else { continue };
            let things = rate.things(each);
            for pair in things.windows(2) {
                let [a, b] = [pair[0], pair[1]].map(|thing| first_of(&of_things, thing));
                of_things[a.max(b)] = a.min(b);
            }
            all.push(Held::new(act, *viscosity, rate.clone()));
        }
        let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (k, held) in all.iter().enumerate() {
            if let Some(&thing) = held.rate.things(each).first() {
                groups.entry(first_of(&of_things, thing)).or_default().push(k);
            }
        }
        let (groups, pulls) = (groups.into_values().collect(), vec![0.0; freedoms]);
        Dampers { drag, all, groups, felt: pulls.clone(), pulls, unsolved: None }
    }

    /// Finds the impulses of dampers over a time `h` at an end of a step, and what all give to freedoms.
    pub(super) fn find(
        &mut self,
        (t, h): (f64, f64),
        (q, each): (&[f64], usize),
        (p, inverse): (&[f64], &[f64]),
        end: End,
    ) -> (&[Held], &[f64]) {
        let Dampers { drag, all, groups, pulls, felt, unsolved } = self;
        if all.is_empty() {
            return (all, pulls);
        }
        felt.copy_from_slice(inverse);
        if let Some((_, drag)) = drag.as_ref().filter(|_| end == End::Start) {
            felt.iter_mut().zip(drag).for_each(|(felt, drag)| *felt /= 1.0 + h * drag * *felt);
        }
        for held in all.iter_mut() {
            held.rate.read((t, q, each), &mut held.now);
            [held.own, ..] = held.now.of_momenta(p, inverse);
            [_, held.whole, held.yields] = held.now.of_momenta(p, felt);
            let x = h * held.viscosity;
            let after = if end == End::Start { 1.0 + x * held.yields } else { 1.0 };
            held.impulse = -x * held.whole / after;
            held.root = x.abs().sqrt();
            held.beside.clear();
        }
        if end == End::Start {
            let shared = groups.iter().filter(|group| group.len() > 1);
            for group in shared {
                *unsolved = together(all, group, (pulls, felt), h).err().or(*unsolved);
            }
        }
        pulls.fill(0.0);
        all.iter().flat_map(Held::gives).for_each(|(freedom, impulse)| pulls[freedom] += impulse);
        (all, pulls)
    }

    /// The unknowns of a group that was not solved since this was asked last: it is too large to be factored.
    pub(super) fn take_unsolved(&mut self) -> Option<usize> {
        self.unsolved.take()
    }

    /// Holds back for a time `h`, and adds the works.
    pub(super) fn hold_back(
        &mut self,
        (t, h): (f64, f64),
        at: (&[f64], usize),
        (p, inverse): (&mut [f64], &[f64]),
        end: End,
        works: &mut [f64],
    ) {
        self.find((t, h), at, (p, inverse), end);
        for (freedom, (p, pull)) in p.iter_mut().zip(&self.pulls).enumerate() {
            let Some((act, drag)) = &self.drag else {
                *p += pull;
                continue;
            };
            let y = h * drag[freedom] * inverse[freedom];
            let after = match end {
                End::Start => (*p + pull) / (1.0 + y),
                End::Finish => *p * (1.0 - y) + pull,
            };
            works[*act] += 0.5 * inverse[freedom] * (after - *p - pull) * (after + *p);
            *p = after;
        }
        for Held { act, now, impulse, own, .. } in &self.all {
            works[*act] += 0.5 * impulse * (own + now.of_momenta(p, inverse)[0]);
        }
    }
}

impl Held {
    fn new(act: usize, viscosity: f64, rate: Rate) -> Self {
        let [impulse, own, whole, yields, root, left, way, along] = [0.0; 8];
        let now = RateNow::default();
        let beside = Vec::new();
        Held {
            act,
            viscosity,
            rate,
            now,
            impulse,
            own,
            whole,
            yields,
            root,
            left,
            way,
            along,
            beside,
        }
    }

    /// What its impulse is on freedoms.
    pub(super) fn gives(&self) -> impl Iterator<Item = (usize, f64)> {
        let by_impulse =
            self.now.entries.iter().map(|&(freedom, part)| (freedom, self.impulse * part));
        by_impulse.chain(self.beside.iter().copied())
    }
}

/// The first thing that is joined with one.
fn first_of(of_things: &[usize], mut thing: usize) -> usize {
    while of_things[thing] != thing {
        thing = of_things[thing];
    }
    thing
}

/// The impulses of dampers that share freedoms; else how many unknowns they have.
fn together(
    all: &mut [Held],
    group: &[usize],
    (pulls, inverse): (&mut [f64], &[f64]),
    h: f64,
) -> Result<(), usize> {
    // What is no number is told by whoever looks at the state.
    if !group.iter().all(|&k| all[k].whole.is_finite()) {
        return Ok(());
    }
    let direction = h.signum();
    if by_gradients(all, group, (pulls, inverse), direction)
        && error(all, group, pulls, inverse) <= CANCELS
    {
        return Ok(());
    }
    let freedoms = direct::freedoms(all, group);
    let unknowns = freedoms.len() + group.len();
    let small = unknowns <= FULL_MATRIX_FREEDOMS;
    if small && direct::solve(all, (group, &freedoms), inverse, direction) {
        Ok(())
    } else {
        Err(unknowns)
    }
}

/// What cancelling impulses leave of the rates of a group, over the largest of them.
fn error(all: &[Held], group: &[usize], pulls: &mut [f64], inverse: &[f64]) -> f64 {
    let held = || group.iter().map(|&k| &all[k]);
    held().flat_map(|held| &held.now.entries).for_each(|&(freedom, _)| pulls[freedom] = 0.0);
    held().flat_map(Held::gives).for_each(|(freedom, impulse)| pulls[freedom] += impulse.abs());
    let of = |held: &Held| {
        let parts = held.now.entries.iter();
        parts.map(|&(freedom, part)| part.abs() * inverse[freedom] * pulls[freedom]).sum::<f64>()
    };
    let largest = held().map(|held| held.whole.abs()).fold(f64::MIN_POSITIVE, f64::max);
    f64::EPSILON * held().map(of).fold(0.0, f64::max) / largest
}

/// The impulses of a group by conjugate gradients; whether these converged.
fn by_gradients(
    all: &mut [Held],
    group: &[usize],
    (pulls, inverse): (&mut [f64], &[f64]),
    direction: f64,
) -> bool {
    let diagonal = move |held: &Held| 1.0 + direction * held.root * held.yields * held.root;
    let scaled = move |held: &Held| held.left / diagonal(held);
    let size = group.iter().map(|&k| (all[k].root * all[k].whole).abs()).fold(0.0, f64::max);
    if size == 0.0 {
        return true;
    }
    if group.iter().any(|&k| diagonal(&all[k]) <= 0.0) {
        return false;
    }
    for &k in group {
        let held = &mut all[k];
        held.left = held.root * held.whole / size;
        (held.way, held.impulse) = (scaled(held), 0.0);
    }
    let squares = |all: &[Held]| group.iter().map(|&k| all[k].left * scaled(&all[k])).sum::<f64>();
    let first = squares(all);
    let mut square = first;
    for _ in 0..MOST[0] * group.len() + MOST[1] {
        if square <= ROUNDING * ROUNDING * first {
            return true;
        }
        multiply(all, group, (pulls, inverse), direction);
        let step = square / group.iter().map(|&k| all[k].way * all[k].along).sum::<f64>();
        for &k in group {
            let held = &mut all[k];
            held.impulse -= direction * step * size * held.root * held.way;
            held.left -= step * held.along;
        }
        let next = squares(all);
        for &k in group {
            all[k].way = scaled(&all[k]) + next / square * all[k].way;
        }
        square = next;
    }
    false
}

/// The matrix along the way.
fn multiply(
    all: &mut [Held],
    group: &[usize],
    (pulls, inverse): (&mut [f64], &[f64]),
    direction: f64,
) {
    for &k in group {
        all[k].now.entries.iter().for_each(|&(freedom, _)| pulls[freedom] = 0.0);
    }
    for Held { now, root, way, .. } in group.iter().map(|&k| &all[k]) {
        now.entries.iter().for_each(|&(freedom, part)| pulls[freedom] += part * root * way);
    }
    for &k in group {
        let [brought, ..] = all[k].now.of_momenta(pulls, inverse);
        all[k].along = all[k].way + direction * all[k].root * brought;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::strength::Strength;
    use proptest::prelude::*;

    fn damper(viscosity: f64, rate: Vec<(usize, f64)>) -> Act {
        let what = What::Damper(viscosity, Rate::Freedoms(rate));
        Act { name: String::new(), strength: Strength::constant(1.0), what }
    }

    type Drawn = (f64, usize, f64, usize, f64);

    proptest! {
        #[test]
        fn all_are_solved_at_once_and_their_works_are_the_change_of_energy(
            masses in prop::array::uniform8(-3.0..3.0_f64), p in prop::array::uniform8(-1.0..1.0_f64),
            drag in 0.0..10.0_f64,
            drawn in prop::collection::vec(
                (-3.0..6.0_f64, 0..8_usize, -1.0..1.0_f64, 1..8_usize, -1.0..1.0_f64), 1..12,
            ),
        ) {
            let act = |&(c, a, x, b, y): &Drawn| damper(10.0_f64.powf(c), vec![(a, x), ((a + b) % 8, y)]);
            let mut acts: Vec<Act> = drawn.iter().map(act).collect();
            acts.insert(0, Act { what: What::Drag(drag), ..acts[0].clone() });
            let inverse = masses.map(|mass| 10.0_f64.powf(mass));
            let energy = |p: &[f64]| p.iter().zip(&inverse).map(|(p, i)| 0.5 * p * p * i).sum::<f64>();
            let (mut after, mut works) = (p, vec![0.0; acts.len()]);
            let mut dampers = Dampers::of(&acts, 8, (1, 1));
            dampers.hold_back((0.0, 1.0), (&[], 1), (&mut after, &inverse), End::Start, &mut works);
            let brought: f64 = works.iter().sum();
            prop_assert!((energy(&after) - energy(&p) - brought).abs() <= 1e-12 * energy(&p));
            let largest = dampers.all.iter().map(|held| (held.root * held.whole).abs()).fold(0.0, f64::max);
            for held in &dampers.all {
                let [rate, ..] = held.now.of_momenta(&after, &inverse);
                prop_assert!((held.root * rate + held.impulse / held.root).abs() <= 1e-10 * largest);
            }
            // Backward it is undone.
            dampers.hold_back((0.0, -1.0), (&[], 1), (&mut after, &inverse), End::Finish, &mut works);
            let off = after.iter().zip(&p).zip(&inverse).map(|((a, b), i)| (a - b).abs() * i.sqrt());
            prop_assert!(off.fold(0.0, f64::max) <= 1e-6 * energy(&p).sqrt());
        }
    }

    /// A line of masses up to 1e18 apart, with dampers up to 1e12 apart between neighbours, and their momenta.
    fn unlike_line(n: i32) -> (Vec<Act>, Vec<f64>, Vec<f64>) {
        let masses: Vec<f64> = (0..n).map(|k| 10.0_f64.powi(7 * k % 19 - 9)).collect();
        let act = |k: usize| {
            damper(10.0_f64.powi((5 * k as i32) % 13 - 6), vec![(k, -1.0), (k + 1, 1.0)])
        };
        let p = masses.iter().enumerate().map(|(k, m)| m * (1.0 + (3 * k % 7) as f64)).collect();
        ((0..masses.len() - 1).map(act).collect(), masses, p)
    }

    #[test]
    fn a_light_mass_between_heavy_ones_has_the_velocity_of_elimination_without_subtraction() {
        let (acts, masses, p) = unlike_line(80);
        let inverse: Vec<f64> = masses.iter().map(|m| 1.0 / m).collect();
        let (mut after, mut works) = (p.clone(), vec![0.0; acts.len()]);
        let mut dampers = Dampers::of(&acts, 80, (1, 1));
        dampers.hold_back((0.0, 1.0), (&[], 1), (&mut after, &inverse), End::Start, &mut works);
        // (m + x) v - x v' = b from the left, where nothing is subtracted; then back.
        let (mut m, mut b) = (masses.clone(), p);
        let x = |k: usize| 10.0_f64.powi((5 * k as i32) % 13 - 6);
        for k in 0..79 {
            m[k + 1] += m[k] / (m[k] + x(k)) * x(k);
            b[k + 1] += b[k] / (m[k] + x(k)) * x(k);
        }
        let mut v = b[79] / m[79];
        for k in (0..80).rev() {
            v = if k == 79 { v } else { (b[k] + x(k) * v) / (m[k] + x(k)) };
            let off = after[k] * inverse[k] - v;
            assert!(off.abs() <= 1e-13 * v, "mass {k}: {v} is {off:e} off");
        }
    }

    #[test]
    fn a_group_that_is_too_large_to_be_factored_is_told_once() {
        let (acts, masses, mut p) = unlike_line(600);
        let inverse: Vec<f64> = masses.iter().map(|m| 1.0 / m).collect();
        let mut dampers = Dampers::of(&acts, 600, (1, 1));
        dampers.find((0.0, 1.0), (&[], 1), (&p, &inverse), End::Start);
        assert_eq!(dampers.take_unsolved(), Some(600 + 599));
        for nothing in [0.0, f64::NAN] {
            p.fill(nothing);
            dampers.find((0.0, 1.0), (&[], 1), (&p, &inverse), End::Start);
            assert_eq!(dampers.take_unsolved(), None);
        }
    }

    #[test]
    fn a_step_back_is_undone_by_its_end_where_dampers_share_a_mass() {
        let acts = [[0, 1], [1, 2], [0, 2]].map(|[a, b]| damper(0.5, vec![(a, -1.0), (b, 1.0)]));
        let (p, inverse) = ([3.0, -1.0, 2.0], [1.0, 0.2, 0.5]);
        let (mut after, mut works) = (p, vec![0.0; 3]);
        let mut dampers = Dampers::of(&acts, 3, (1, 1));
        dampers.hold_back((0.0, -0.4), (&[], 1), (&mut after, &inverse), End::Start, &mut works);
        dampers.hold_back((0.0, 0.4), (&[], 1), (&mut after, &inverse), End::Finish, &mut works);
        let off = after.iter().zip(p).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off <= 1e-14, "{off:e}");
    }
}
