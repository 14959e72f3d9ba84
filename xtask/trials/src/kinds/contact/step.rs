//! What every step keeps, from states, impulses and the report alone.
//!
//! ```text
//! p+ - p- = h m g + sum J,   l+ - l- = sum arm x J + tau          each body, N s, N s m
//! E+ - E- <= lifting + work + r sum lambda + r_t sum |beta|        J, of no size of step
//! lambda >= 0,   |beta| <= mu lambda                               of impacts and rest together
//! |min(W lambda, u + g/h)| <= r,   |beta - disc(beta - u_t/d)| d <= r_t           m/s
//! depth+ <= depth- + turn + h s sum h w + h r                      on the whole way of the step
//! turn = max(sum R (h w)^2,  1/2 (R_1 + R_2) |h w_2 - h w_1|^2)
//! ```
//! The energy has no term of the method: with contacts off by nothing,
//! `E+ - E- = (impacts) - |v+ - v|_M^2/2 + lambda.u + beta.u_t` where `v` is the velocity after impacts
//! and the last two oppose what moves. `r r_t` are the residuals that are reported, `R` the radii of
//! the bodies, `w` their spins, `s` their speed against each other: a gap that is linear over a step errs
//! by what turns, and by what slides along a face that turns. The second of `turn` is an edge that rocks on a
//! ball: at a height `c` below the centre about which it turns, it comes closer by `(R + c)(1 - cos(h w))`.

mod moments;

use nalgebra::{Matrix2, Vector3};
use stationary_contact::WorldReport;

use super::case::{Case, Form, Thing};
use super::engine::{Body, Motion, Seen};
use super::hull::{Pose, depth};
use crate::Verdict;

/// Sums are kept to this part of their terms.
const ROUNDING: f64 = 1e-9;
/// A step with more contacts is one of a pile.
const PILE: usize = 100;
/// Bodies are through each other, or the ground, where they are deeper by this part of the thinner one than is
/// allowed.
const DEEPER: f64 = 1e-5;
/// Lifting some may push others into each other, by this part of the deepest overlap.
const LIFTED: f64 = 0.5;
/// Turns in a step beyond this may be refused, rad.
const MANY_TURNS: f64 = 1e4;
/// Samples of a way at most.
const SAMPLES: f64 = 200.0;

/// Judges step after step of one scene.
pub(super) struct Referee<'a> {
    case: &'a Case,
    bodies: Vec<Body>,
    /// How much deeper than allowed each pair is, and each body in each ground.
    excess: Vec<f64>,
}

/// What the step's terms have in common.
struct Step<'a> {
    before: &'a [Motion],
    /// Angular momenta between impulses and moving.
    turning: Vec<Vector3<f64>>,
    after: &'a [Motion],
    touches: &'a [Seen],
    report: &'a WorldReport,
    h: f64,
}

impl Step<'_> {
    /// The farthest coordinate, m.
    fn farthest(&self) -> f64 {
        let motions = self.before.iter().chain(self.after);
        motions.map(|m| m.pose.x.amax()).fold(0.0, f64::max)
    }
}

impl Seen {
    /// The whole impulse on the second body.
    fn impulse(&self) -> Vector3<f64> {
        self.normal * (self.impact + self.rest) + self.rubbed
    }

    /// Each body with the sign of the impulse on it, and where from its centre.
    fn sides(&self) -> impl Iterator<Item = (usize, f64, Vector3<f64>)> {
        let side = move |(k, sign): (usize, f64)| Some((self.bodies[k]?, sign, self.arms[k]));
        [(0, -1.0), (1, 1.0)].into_iter().filter_map(side).collect::<Vec<_>>().into_iter()
    }
}

impl<'a> Referee<'a> {
    pub(super) fn new(case: &'a Case) -> Self {
        let bodies = Body::all(case);
        let count = bodies.len() * (bodies.len() + case.grounds.len());
        Referee { case, bodies, excess: vec![0.0; count] }
    }

    /// Whether the energy of a scene would let a body turn so far in a step that to refuse it is right.
    pub(super) fn may_turn_far(&self, before: &[Motion]) -> bool {
        let h = self.case.step;
        let energy = |(body, m): (&Body, &Motion)| {
            let falls = self.case.gravity * h;
            body.kinetic(&m.pose.r, &m.p, &m.l) + 0.5 * body.mass * falls * falls
        };
        let energy: f64 = self.bodies.iter().zip(before).map(energy).sum();
        let moments = self.bodies.iter().flat_map(|body| body.moments.into_iter().flatten());
        let least = moments.fold(f64::INFINITY, f64::min);
        h * (2.0 * energy / least).sqrt() > MANY_TURNS
    }

    /// The word on one step.
    pub(super) fn judge(
        &mut self,
        before: &[Motion],
        after: &[Motion],
        touches: &[Seen],
        report: &WorldReport,
    ) -> Verdict {
        let finite = |m: &Motion| m.pose.x.sum() + m.p.sum() + m.l.sum() + m.pose.r.sum();
        let WorldReport { residual, coulomb, overlap, work, .. } = report;
        let WorldReport { impact_energy, friction_energy, lifting_energy, .. } = report;
        let said = residual + coulomb + overlap + work;
        let said = said + impact_energy + friction_energy + lifting_energy;
        if !after.iter().map(finite).sum::<f64>().is_finite() || !said.is_finite() {
            return Verdict::wrong("a number that is not finite");
        }
        let turning = self.turning(before, after, touches, report);
        let step = Step { before, turning, after, touches, report, h: self.case.step };
        let verdicts = [
            self.balance(&step),
            self.energy(&step),
            self.cone(&step),
            self.residuals(&step),
            self.overlap(&step),
            self.through(&step),
        ];
        verdicts.into_iter().fold(Verdict::due(), Verdict::and)
    }

    /// Angular momenta after impulses. Lifting turns a body with its momentum, so that its energy stays:
    /// then they are those that the impulses give.
    fn turning(
        &self,
        before: &[Motion],
        after: &[Motion],
        touches: &[Seen],
        report: &WorldReport,
    ) -> Vec<Vector3<f64>> {
        // In the plane a turn leaves the momentum as it is.
        let turns = report.overlap > 0.0 && !self.case.flat;
        let motions = if turns { before } else { after };
        let mut turning: Vec<_> = motions.iter().map(|m| m.l).collect();
        for touch in touches.iter().filter(|_| turns) {
            for (k, sign, arm) in touch.sides().filter(|side| !self.bodies[side.0].pushed) {
                turning[k] += arm.cross(&(touch.impulse() * sign)) + touch.moment * sign;
            }
        }
        turning
    }

    /// How far the step's islands are settled, m/s, where nothing else is asked for.
    fn fine(&self, step: &Step) -> f64 {
        let part = if step.touches.len() > PILE { 1e-2 } else { 1e-8 };
        self.case.tolerance.unwrap_or(part * self.case.gravity * step.h)
    }

    /// Momentum of each body.
    fn balance(&self, step: &Step) -> Verdict {
        let off = step.report.residual.max(step.report.coulomb);
        let mut verdict = Verdict::due();
        for (k, body) in self.bodies.iter().enumerate() {
            let (from, to) = (&step.before[k], &step.after[k]);
            let weight = if body.pushed { 0.0 } else { step.h * body.mass * self.case.gravity };
            let mut p = from.p - self.case.up() * weight;
            let mut l = from.l;
            let (mut pushed, mut rolled) = (0.0, 0.0);
            for touch in step.touches.iter().filter(|_| !body.pushed) {
                for (_, sign, arm) in touch.sides().filter(|side| side.0 == k) {
                    let impulse = touch.impulse() * sign;
                    p += impulse;
                    l += arm.cross(&impulse) + touch.moment * sign;
                    pushed += impulse.norm();
                    rolled += touch.moment.norm();
                }
            }
            let radius = body.hull.radius;
            let moves = from.p.norm() + to.p.norm() + weight + pushed;
            let promised = ROUNDING * moves + body.mass * 4.0 * off;
            let momentum = Verdict::of((to.p - p).norm(), promised, "momentum of a body");
            let turns = from.l.norm() + to.l.norm() + pushed * radius + rolled;
            let promised = ROUNDING * turns + body.mass * radius * 4.0 * off;
            let lifted = step.report.overlap > 0.0;
            let error = if lifted { (to.l.norm() - l.norm()).abs() } else { (to.l - l).norm() };
            let spin = Verdict::of(error, promised, "angular momentum of a body");
            verdict = verdict.and(momentum).and(spin);
        }
        verdict
    }

    /// Energy, and what the report says of it.
    fn energy(&self, step: &Step) -> Verdict {
        let (h, up) = (step.h, self.case.up());
        let (mut gained, mut scale, mut lifted, mut kicked) = (0.0, 0.0, 0.0, 0.0);
        let (mut kinetic, mut heavy) = (0.0, 0.0);
        // What is pushed stays where it goes; its potential energy is in the sums that are told all the same.
        let pushed_up = |(k, body): (usize, &Body)| {
            let heights = [step.before, step.after].map(|m| m[k].pose.x.norm());
            let weight = body.mass * self.case.gravity;
            if body.pushed { weight * (heights[0] + heights[1]) } else { 0.0 }
        };
        let rounding =
            4.0 * f64::EPSILON * self.bodies.iter().enumerate().map(pushed_up).sum::<f64>();
        let impacts = self.impacts(step);
        for (k, body) in self.bodies.iter().enumerate().filter(|(_, body)| !body.pushed) {
            let (from, to) = (&step.before[k], &step.after[k]);
            let weight = body.mass * self.case.gravity;
            let moving = [(&from.p, &from.l), (&to.p, &step.turning[k])];
            let t = moving.map(|(p, l)| body.kinetic(&from.pose.r, p, l));
            let rise = (to.pose.x - from.pose.x).dot(&up);
            let lift = weight * (rise - h * to.p.dot(&up) / body.mass);
            let kick = -h * weight * (impacts[k].0 + to.p).dot(&up) / (2.0 * body.mass);
            kinetic += t[1] - t[0];
            gained += t[1] - t[0] + weight * rise;
            lifted += lift;
            kicked += kick;
            let heights = weight * (from.pose.x.norm() + to.pose.x.norm());
            scale += t[0] + t[1] + kick.abs() + lift.abs() + 1e-3 * heights;
            let turns = from.l.norm() + to.l.norm();
            heavy += from.p.norm() + to.p.norm() + turns / body.hull.radius;
        }
        let work = self.work(step);
        let impulses: f64 = step.touches.iter().map(|t| t.impulse().norm()).sum();
        let pushed: f64 = step.touches.iter().map(|t| (t.impact + t.rest).abs()).sum();
        let rubbed: f64 = step.touches.iter().map(|t| t.rubbed.norm()).sum();
        let report = step.report;
        let scale = scale + work.abs() + report.impact_energy.abs() + report.friction_energy.abs();
        let left = report.residual * pushed + report.coulomb * rubbed;
        let over = (gained - lifted - work).max(0.0);
        let mut verdict = Verdict::of(over, ROUNDING * scale + 1.01 * left, "energy gained");
        let off = 4.0 * report.residual.max(report.coulomb) * (impulses + heavy);
        let promised = ROUNDING * scale + off;
        let of = |error: f64, what| Verdict::of(error.abs(), promised, what);
        let lifting = (report.lifting_energy - lifted).abs();
        let what = "the energy of lifting reported";
        verdict = verdict.and(Verdict::of(lifting, promised + rounding, what));
        verdict = verdict.and(of(report.work - work, "the work of obstacles reported"));
        // Where impacts rub, what was between them and the rest is not told.
        let told = step.touches.iter().all(|t| t.impact == 0.0 || t.rubbed == Vector3::zeros());
        if told {
            let taken = report.impact_energy + report.friction_energy;
            let budget = kinetic - kicked + taken - report.work;
            verdict = verdict.and(of(budget, "the energies reported"));
        }
        verdict
    }

    /// Momenta, and angular ones, after impacts without friction.
    fn impacts(&self, step: &Step) -> Vec<(Vector3<f64>, Vector3<f64>)> {
        let mut momenta: Vec<_> = step.before.iter().map(|m| (m.p, m.l)).collect();
        for touch in step.touches {
            for (body, sign, arm) in touch.sides() {
                let impulse = touch.normal * (sign * touch.impact);
                momenta[body].0 += impulse;
                momenta[body].1 += arm.cross(&impulse);
            }
        }
        momenta
    }

    /// The work of what is pushed on the others.
    fn work(&self, step: &Step) -> f64 {
        let mut work = 0.0;
        for touch in step.touches {
            for (body, sign, arm) in touch.sides().filter(|side| self.bodies[side.0].pushed) {
                work -= sign * touch.impulse().dot(&self.velocity(step, body, &arm));
                work -= sign * touch.moment.dot(&self.spin(step, body));
            }
        }
        work
    }

    /// The velocity after the step of a point where it was before, from the body's centre.
    fn velocity(&self, step: &Step, k: usize, arm: &Vector3<f64>) -> Vector3<f64> {
        step.after[k].p / self.bodies[k].mass + self.spin(step, k).cross(arm)
    }

    fn spin(&self, step: &Step, k: usize) -> Vector3<f64> {
        self.bodies[k].spin(&step.before[k].pose.r, &step.turning[k])
    }

    /// Impulses push, and rub and roll within what they push.
    fn cone(&self, step: &Step) -> Verdict {
        let mut verdict = Verdict::due();
        for touch in step.touches {
            let pushed = touch.impact + touch.rest;
            let rounding = ROUNDING * pushed.abs() * (1.0 + touch.friction);
            let over = (touch.rubbed.norm() - touch.friction * pushed).max(0.0);
            verdict = verdict.and(Verdict::of(over, rounding, "outside of the cone"));
            verdict = verdict.and(self.moments_within(step, touch));
            let pulls = (-touch.impact).max(-touch.rest).max(0.0);
            verdict =
                verdict.and(Verdict::of(pulls, 1e-12 * pushed.abs(), "an impulse that pulls"));
        }
        verdict
    }

    /// The conditions of rest are met as far as reported, and settled is what is asked for.
    fn residuals(&self, step: &Step) -> Verdict {
        let (h, report) = (step.h, step.report);
        let gain = self.case.gravity * h;
        let impacts = self.impacts(step);
        let speed = |(k, body): (usize, &Body)| {
            let (from, to) = (&step.before[k], &step.after[k]);
            let between = &impacts[k];
            let speed = |(p, l): (&Vector3<f64>, &Vector3<f64>)| {
                p.norm() / body.mass + body.hull.radius * body.spin(&from.pose.r, l).norm()
            };
            let all = [(&from.p, &from.l), (&between.0, &between.1), (&to.p, &to.l)].map(speed);
            all.into_iter().fold(0.0, f64::max)
        };
        let fastest = self.bodies.iter().enumerate().map(speed).fold(gain, f64::max);
        // Gaps are of points that are farther than centres.
        let radius = self.bodies.iter().map(|body| body.hull.radius).fold(0.0, f64::max);
        let rounding = 1e-10 * fastest + 20.0 * f64::EPSILON * (step.farthest() + radius) / h;
        // Of what moves in a pile a quarter of what weight changes may be left, and 3e-4 of the fastest.
        let pile = step.touches.len() > PILE;
        let of_piles = (0.25 * gain).max(3e-4 * (fastest + gain));
        let asked = self.case.tolerance.unwrap_or(if pile { of_piles } else { 1e-2 * gain });
        let slop = 0.1 * self.fine(step) + rounding;
        let mut verdict = Verdict::due();
        if report.settled {
            let left = (report.residual.max(report.coulomb) - 1.01 * asked).max(0.0);
            verdict = verdict.and(Verdict::of(left, rounding, "settled beyond what was asked for"));
        }
        // Velocities have the rounding of the impulses that cancel in them.
        let mut rounded = vec![0.0; self.bodies.len()];
        for touch in step.touches {
            for (k, ..) in touch.sides() {
                let body = &self.bodies[k];
                let turns =
                    body.moments.iter().flatten().fold(f64::INFINITY, |m: f64, i| m.min(*i));
                let light = 1.0 / body.mass + body.hull.radius.powi(2) / turns;
                rounded[k] += 20.0 * f64::EPSILON * touch.impulse().norm() * light;
            }
        }
        for touch in step.touches {
            let unit = (touch.normal.norm() - 1.0).abs();
            verdict = verdict.and(Verdict::of(unit, 1e-12, "the length of a normal"));
            for (side, body) in touch.bodies.into_iter().enumerate() {
                let Some(body) = body else { continue };
                let off = step.before[body].pose.x + touch.arms[side] - touch.points[side];
                let rounding = 1e-14 * (step.farthest() + touch.arms[side].norm());
                verdict = verdict.and(Verdict::of(off.norm(), rounding, "the place of a point"));
            }
            let slop = slop + touch.sides().map(|(k, ..)| rounded[k]).sum::<f64>();
            let mut rate = Vector3::zeros();
            for (body, sign, arm) in touch.sides() {
                rate += self.velocity(step, body, &arm) * sign;
            }
            let gives = |a: &Vector3<f64>, b: &Vector3<f64>| -> f64 {
                let side = |(body, _, arm): (usize, f64, Vector3<f64>)| {
                    self.bodies[body].gives(&step.before[body].pose.r, &arm, [a, b])
                };
                touch.sides().map(side).sum()
            };
            let n = &touch.normal;
            let u = rate.dot(n);
            let off = (gives(n, n) * touch.rest).min(u + touch.gap.max(0.0) / h).abs();
            let promised = 1.01 * report.residual + slop;
            verdict = verdict.and(Verdict::of(off, promised, "the residual reported"));
            let off = self.moment_off(step, touch);
            // What is rounded of a spin is rounded of its moment as well.
            let promised = 1.01 * report.coulomb + 2.0 * slop;
            verdict = verdict.and(Verdict::of(off, promised, "the residual of moments"));
            if touch.impact != 0.0 || touch.friction == 0.0 {
                continue;
            }
            let [s, t] = across(n, self.case.flat);
            let d = match self.case.flat {
                true => gives(&s, &s),
                false => {
                    let (ss, st, tt) = (gives(&s, &s), gives(&s, &t), gives(&t, &t));
                    Matrix2::new(ss, st, st, tt).symmetric_eigenvalues().max()
                }
            };
            let wanted = touch.rubbed - (rate - n * u) / d;
            let (radius, length) = (touch.friction * touch.rest, wanted.norm());
            let nearest = if length > radius { wanted * (radius / length) } else { wanted };
            let off = (touch.rubbed - nearest).norm() * d;
            let promised = 1.01 * report.coulomb + slop;
            verdict = verdict.and(Verdict::of(off, promised, "Coulomb's residual reported"));
        }
        verdict
    }

    /// The overlap reported is that of the shapes; of convex solids in space it is only estimated.
    fn overlap(&self, step: &Step) -> Verdict {
        let estimated = |thing: &Thing| !self.case.flat && thing.form == Form::Simplex;
        if self.case.things.iter().any(estimated) {
            return Verdict::due();
        }
        let mut own = 0.0_f64;
        let mut thin = f64::INFINITY;
        for (k, body) in self.bodies.iter().enumerate() {
            thin = thin.min(body.hull.thin);
            let pose = &step.before[k].pose;
            // Two that no impulse moves are not looked at.
            for normal in self.case.grounds.iter().filter(|_| !body.pushed) {
                own = own.max(body.hull.below(pose, normal));
            }
            let others = self.bodies[..k].iter().zip(step.before);
            for (other, from) in others.filter(|(other, _)| !(other.pushed && body.pushed)) {
                own = own.max(depth([&other.hull, &body.hull], [&from.pose, pose]));
            }
        }
        let said = step.report.overlap;
        let promised = 0.5 * own.max(said) + 1e-5 * thin + 1e-14 * step.farthest();
        Verdict::of((own - said).abs(), promised, "the overlap reported")
    }

    /// Nothing gets deeper into anything than what turns, the residual and lifting allow. A step that says of
    /// itself that it is not settled promises no place: what an obstacle crushes against the ground has none.
    fn through(&mut self, step: &Step) -> Verdict {
        let (h, report, count) = (step.h, step.report, self.bodies.len());
        if !report.settled {
            self.excess.fill(0.0);
            return Verdict::due();
        }
        let spins: Vec<_> = (0..count).map(|k| self.spin(step, k) * h).collect();
        let turns = |k: usize| self.bodies[k].hull.radius * spins[k].norm_squared();
        let deepest = |bodies: [Option<usize>; 2]| {
            let same = step
                .touches
                .iter()
                .filter(|t| t.bodies == bodies || t.bodies == [bodies[1], bodies[0]]);
            same.map(|t| -t.gap).fold(0.0, f64::max)
        };
        let common = 1.01 * h * report.residual + LIFTED * report.overlap + 1e-14 * step.farthest();
        let mut verdict = Verdict::due();
        for k in 0..count {
            let hull = &self.bodies[k].hull;
            let ends = [&step.before[k].pose, &step.after[k].pose];
            // Nothing keeps what no impulse moves out of the ground.
            let grounds = self.case.grounds.iter().filter(|_| !self.bodies[k].pushed);
            for (ground, normal) in grounds.enumerate() {
                let [was, is] = ends.map(|pose| hull.below(pose, normal).max(0.0));
                let allowed = was.max(deepest([Some(k), None])) + turns(k) + common;
                let excess = &mut self.excess[count * count + self.case.grounds.len() * k + ground];
                *excess = if is == 0.0 { 0.0 } else { *excess + (is - allowed).max(0.0) };
                let what = "deeper in the ground";
                verdict = verdict.and(Verdict::of(*excess, DEEPER * hull.thin, what));
            }
            for other in 0..k {
                let hulls = [&self.bodies[other].hull, hull];
                let thin = hulls[0].thin.min(hulls[1].thin);
                let moved = [other, k].map(|k| step.after[k].p * (h / self.bodies[k].mass));
                let slides = (moved[1] - moved[0]).norm();
                let seen_turn = (spins[k] - spins[other]).norm_squared();
                let curved = 0.5 * (hulls[0].radius + hulls[1].radius) * seen_turn;
                let turn = (turns(other) + turns(k)).max(curved);
                let turn = turn + slides * (spins[other].norm() + spins[k].norm());
                if self.bodies[other].pushed && self.bodies[k].pushed || turn + common > thin {
                    continue;
                }
                let poses = [other, k];
                let was = depth(hulls, poses.map(|k| &step.before[k].pose)).max(0.0);
                let is = depth(hulls, poses.map(|k| &step.after[k].pose)).max(0.0);
                let most = is.max(self.deepest_on_the_way(step, [other, k], &spins));
                let allowed = was.max(deepest([Some(other), Some(k)])) + turn + common;
                let excess = &mut self.excess[count * k + other];
                *excess += (most - allowed).max(0.0);
                verdict = verdict.and(Verdict::of(*excess, DEEPER * thin, "through each other"));
                if is == 0.0 {
                    *excess = 0.0;
                }
            }
        }
        verdict
    }

    /// How deep two bodies are in each other at most on their way, which starts apart.
    fn deepest_on_the_way(&self, step: &Step, [i, k]: [usize; 2], spins: &[Vector3<f64>]) -> f64 {
        let hulls = [i, k].map(|k| &self.bodies[k].hull);
        let moved = [i, k].map(|k| step.after[k].p * (step.h / self.bodies[k].mass));
        let from = step.before[k].pose.x - step.before[i].pose.x;
        let way = moved[1] - moved[0];
        let reach = hulls[0].radius + hulls[1].radius;
        // |from + t way| = reach.
        let (a, b, c) = (way.norm_squared(), from.dot(&way), from.norm_squared() - reach * reach);
        let root = b * b - a * c;
        if root <= 0.0 || a == 0.0 {
            return 0.0;
        }
        let [start, end] = [-1.0, 1.0].map(|sign| ((-b + sign * root.sqrt()) / a).clamp(0.0, 1.0));
        let thin = hulls[0].thin.min(hulls[1].thin);
        let turned = spins[i].norm() * hulls[0].radius + spins[k].norm() * hulls[1].radius;
        let travel = (end - start) * (way.norm() + turned);
        let samples = (4.0 * travel / thin).ceil().min(SAMPLES);
        let mut deepest = 0.0_f64;
        for sample in 0..=samples as usize {
            let t = start + (end - start) * sample as f64 / samples.max(1.0);
            let pose = |side: usize, body: usize| {
                let pose = &step.before[body].pose;
                let turn = nalgebra::Rotation3::from_scaled_axis(spins[body] * t).into_inner();
                Pose { x: pose.x + moved[side] * t, r: turn * pose.r }
            };
            deepest = deepest.max(depth(hulls, [&pose(0, i), &pose(1, k)]));
        }
        deepest
    }
}

/// Directions across a normal; in the plane the first is in it.
fn across(n: &Vector3<f64>, flat: bool) -> [Vector3<f64>; 2] {
    let axis = match flat {
        true => Vector3::z(),
        false if n.x.abs() < 0.6 => Vector3::x(),
        false => Vector3::y(),
    };
    let s = axis.cross(n).normalize();
    [s, n.cross(&s)]
}
