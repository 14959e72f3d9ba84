//! Impacts with known answers or known invariants: one definition each for tests, studies, benches.
//!
//! | problem | what meets | what is known |
//! | --- | --- | --- |
//! | [`newtons_cradle`] | balls in a row, touching, k of them moving | k leave at the far end |
//! | [`three_balls`] | the case of 11.5: both ends run into the middle | the ends swap velocities |
//! | [`bernoulli_wedge`] | a ball falls between two equal balls | closed form, symmetric |
//! | [`nine_ball_break`] | a ball hits a rack of nine head-on | symmetric about its line |
//! | [`ball_in_corner`] | a ball flies into a right corner | each component turns back by c |
//! | [`box_on_plane`] | a box lands on a hundred points at once | it stops, forces not unique |
//! | [`listed_twice`] | a ball hits a wall that is listed twice | the wall counts once |
//! | [`landing_pile`] | discs stacked in a triangle land, all at once | symmetric |
//! | [`columns_of_boxes`], [`falling_boxes`] | boxes that stand or fall into a pile | they rest |
//! | [`leaning_tower`] | boxes on each other, each off the middle | it stands or falls by statics |
//! | [`landing_chain`] | boxes on joints, with all of their corners on a floor | laws of joints, dry friction and corners |

#[cfg(feature = "3d")]
mod boxes;
mod chains;

use stationary_calculus::{DiagonalMetric, SizeError};

#[cfg(feature = "3d")]
pub use boxes::{Boxes, FRICTION, GRAVITY, columns_of_boxes, falling_boxes, leaning_tower};
pub use chains::{LandingChain, landing_chain};

use crate::{ContactError, ContactRows, Impact, InverseMass};

/// Contacts about to be given impulses, and the velocity before.
#[derive(Clone, Debug)]
pub struct ImpactProblem {
    /// Its name, with lower-case letters and hyphens.
    pub name: &'static str,
    /// The mass of each freedom, kg or kg m^2.
    pub masses: Vec<f64>,
    /// The differentials of the gaps.
    pub rows: ContactRows,
    /// The restitution of each contact.
    pub restitution: Vec<f64>,
    /// The velocity before.
    pub velocity: Vec<f64>,
    /// A symmetry of the impact: where each freedom goes, and with which sign.
    pub mirror: Vec<(usize, f64)>,
    /// The total momentum in each direction is the sum over these freedoms; none where walls take
    /// part.
    pub momentum: Vec<Vec<usize>>,
}

impl ImpactProblem {
    /// The impact, its contacts in the order listed.
    ///
    /// # Errors
    /// Those of [`ImpactProblem::impact_in_order`].
    pub fn impact(&self) -> Result<Impact, ContactError> {
        let order: Vec<usize> = (0..self.rows.len()).collect();
        self.impact_in_order(&order)
    }

    /// The impact with its contacts listed in another order.
    ///
    /// # Errors
    /// [`ContactError::Size`] for a contact that is not there, or a restitution too many or too few;
    /// [`ContactError::Mass`] where a mass is not positive and finite; those of [`Impact::new`].
    pub fn impact_in_order(&self, order: &[usize]) -> Result<Impact, ContactError> {
        let count = self.rows.len();
        SizeError::check("the restitutions", count, self.restitution.len())?;
        if let Some(&got) = order.iter().find(|&&contact| contact >= count) {
            return Err(SizeError { what: "a contact", expected: count, got }.into());
        }
        let metric = DiagonalMetric::new(self.masses.clone())?;
        let restitution = order.iter().map(|&contact| self.restitution[contact]).collect();
        Impact::new(self.rows.reordered(order), &InverseMass::of(&metric)?, restitution)
    }

    /// The kinetic energy of a velocity, J.
    pub fn kinetic_energy(&self, v: &[f64]) -> f64 {
        0.5 * self.masses.iter().zip(v).map(|(m, v)| m * v * v).sum::<f64>()
    }

    /// The momentum in each direction in which it is kept.
    pub fn total_momentum(&self, v: &[f64]) -> Vec<f64> {
        let sum = |freedoms: &Vec<usize>| freedoms.iter().map(|&f| self.masses[f] * v[f]).sum();
        self.momentum.iter().map(sum).collect()
    }

    /// How far a velocity is from its mirror image, m/s.
    pub fn asymmetry(&self, v: &[f64]) -> f64 {
        let off = |(f, &(to, sign)): (usize, &(usize, f64))| (v[f] - sign * v[to]).abs();
        self.mirror.iter().enumerate().map(off).fold(0.0, f64::max)
    }

    /// The same with this restitution everywhere.
    pub fn with_restitution(mut self, c: f64) -> Self {
        self.restitution.fill(c);
        self
    }
}

/// `of` equal balls in a row that touch, the first `moving` of them at 1 m/s.
pub fn newtons_cradle(of: usize, moving: usize) -> ImpactProblem {
    let velocity: Vec<f64> = (0..of).map(|ball| if ball < moving { 1.0 } else { 0.0 }).collect();
    ImpactProblem {
        name: "newtons-cradle",
        mirror: (0..of).map(|ball| (ball, 1.0)).collect(),
        ..row_of_balls(velocity)
    }
}

/// Three equal balls in a row: the ends run into the middle one at 1 m/s.
pub fn three_balls() -> ImpactProblem {
    ImpactProblem { name: "three-balls", ..row_of_balls(vec![1.0, 0.0, -1.0]) }
}

/// Equal balls of 1 kg in a row, mirrored about the middle.
fn row_of_balls(velocity: Vec<f64>) -> ImpactProblem {
    let balls = velocity.len();
    let contacts = balls.saturating_sub(1);
    let mut rows = ContactRows::new();
    (1..balls).for_each(|ball| rows.push([(ball - 1, -1.0), (ball, 1.0)]));
    ImpactProblem {
        name: "row-of-balls",
        masses: vec![1.0; balls],
        restitution: vec![1.0; contacts],
        rows,
        mirror: (0..balls).map(|ball| (balls - 1 - ball, -1.0)).collect(),
        momentum: vec![(0..balls).collect()],
        velocity,
    }
}

/// Equal balls of the plane at these centres with these velocities, in contact where they touch.
fn balls_of_the_plane(centres: &[[f64; 2]], radius: f64) -> (ContactRows, Vec<f64>) {
    let mut rows = ContactRows::new();
    for (b, second) in centres.iter().enumerate() {
        for (a, first) in centres[..b].iter().enumerate() {
            let d = [second[0] - first[0], second[1] - first[1]];
            let distance = d[0].hypot(d[1]);
            if distance < 2.0 * radius * (1.0 + 1e-9) {
                let n = d.map(|x| x / distance);
                let along = |ball: usize, sign: f64| [0, 1].map(|k| (2 * ball + k, sign * n[k]));
                rows.push(along(a, -1.0).into_iter().chain(along(b, 1.0)));
            }
        }
    }
    let masses = vec![1.0; 2 * centres.len()];
    (rows, masses)
}

/// A ball falls at 1 m/s between two equal balls that rest `2 sin(angle)` diameters apart: the
/// contact normals lean by `angle` (radians, at least a sixth of a half turn) from the vertical.
pub fn bernoulli_wedge(angle: f64) -> ImpactProblem {
    let (s, c) = angle.sin_cos();
    let (rows, masses) = balls_of_the_plane(&[[0.0, c], [-s, 0.0], [s, 0.0]], 0.5);
    ImpactProblem {
        name: "bernoulli-wedge",
        masses,
        restitution: vec![1.0; rows.len()],
        rows,
        velocity: vec![0.0, -1.0, 0.0, 0.0, 0.0, 0.0],
        mirror: vec![(0, -1.0), (1, 1.0), (4, -1.0), (5, 1.0), (2, -1.0), (3, 1.0)],
        momentum: vec![vec![0, 2, 4], vec![1, 3, 5]],
    }
}

/// A ball hits a rack of nine in a diamond head-on, at 1 m/s.
pub fn nine_ball_break() -> ImpactProblem {
    let mut centres = vec![[0.0, 0.0]];
    let step = 3.0_f64.sqrt() / 2.0;
    for (rank, balls) in [1, 2, 3, 2, 1].into_iter().enumerate() {
        for ball in 0..balls {
            let y = f64::from(ball) - 0.5 * f64::from(balls - 1);
            centres.push([1.0 + step * rank as f64, y]);
        }
    }
    let (rows, masses) = balls_of_the_plane(&centres, 0.5);
    let twin = |ball: usize| {
        let [x, y] = centres[ball];
        centres.iter().position(|c| (c[0] - x).abs() < 1e-9 && (c[1] + y).abs() < 1e-9)
    };
    let mirrored = |ball: usize| {
        let twin = twin(ball).unwrap_or(ball);
        [(2 * twin, 1.0), (2 * twin + 1, -1.0)]
    };
    let mut velocity = vec![0.0; 2 * centres.len()];
    velocity[0] = 1.0;
    let along = |k: usize| (0..centres.len()).map(|ball| 2 * ball + k).collect();
    ImpactProblem {
        name: "nine-ball-break",
        masses,
        restitution: vec![1.0; rows.len()],
        rows,
        velocity,
        mirror: (0..centres.len()).flat_map(mirrored).collect(),
        momentum: vec![along(0), along(1)],
    }
}

/// Discs that touch, stacked in a triangle `base` discs wide, land on the ground at 1 m/s without
/// restitution.
pub fn landing_pile(base: usize) -> ImpactProblem {
    let step = 3.0_f64.sqrt() / 2.0;
    let row = |r: usize| (0..base - r).map(move |k| [k as f64 + 0.5 * r as f64, step * r as f64]);
    let centres: Vec<[f64; 2]> = (0..base).flat_map(row).collect();
    let (mut rows, masses) = balls_of_the_plane(&centres, 0.5);
    (0..base).for_each(|disc| rows.push([(2 * disc + 1, 1.0)]));
    let twins = (0..base).flat_map(|r| {
        let first = r * base - r * r.saturating_sub(1) / 2;
        (0..base - r).map(move |k| first + base - r - 1 - k)
    });
    ImpactProblem {
        name: "landing-pile",
        restitution: vec![0.0; rows.len()],
        rows,
        velocity: centres.iter().flat_map(|_| [0.0, -1.0]).collect(),
        mirror: twins.flat_map(|twin| [(2 * twin, -1.0), (2 * twin + 1, 1.0)]).collect(),
        momentum: vec![(0..centres.len()).map(|disc| 2 * disc).collect()],
        masses,
    }
}

/// A ball flies into a right corner at (-1, -2) m/s.
pub fn ball_in_corner() -> ImpactProblem {
    let mut rows = ContactRows::new();
    rows.push([(0, 1.0)]);
    rows.push([(1, 1.0)]);
    ImpactProblem {
        name: "ball-in-corner",
        masses: vec![1.0; 2],
        restitution: vec![1.0; 2],
        rows,
        velocity: vec![-1.0, -2.0],
        mirror: vec![(0, 1.0), (1, 1.0)],
        momentum: vec![],
    }
}

/// A ball hits a wall at 1 m/s; the wall is listed twice.
pub fn listed_twice() -> ImpactProblem {
    let mut rows = ContactRows::new();
    rows.push([(0, 1.0)]);
    rows.push([(0, 1.0)]);
    ImpactProblem {
        name: "listed-twice",
        masses: vec![1.0],
        restitution: vec![1.0; 2],
        rows,
        velocity: vec![-1.0],
        mirror: vec![(0, 1.0)],
        momentum: vec![],
    }
}

/// A box (1 kg, half sizes 0.5 m) lands on a plane with ten by ten points of its face at once,
/// falling at 1 m/s and spinning a little. Freedoms (x, y, z, turns about x, y, z).
pub fn box_on_plane() -> ImpactProblem {
    let mut rows = ContactRows::new();
    let place = |k: usize| 0.5 * (k as f64 / 4.5 - 1.0);
    for (x, y) in (0..100).map(|k| (place(k % 10), place(k / 10))) {
        rows.push([(2, 1.0), (3, y), (4, -x)]);
    }
    ImpactProblem {
        name: "box-on-plane",
        masses: [1.0, 1.0, 1.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0].into(),
        restitution: vec![0.0; 100],
        rows,
        velocity: vec![0.1, 0.0, -1.0, 0.2, -0.3, 0.05],
        mirror: (0..6).map(|f| (f, 1.0)).collect(),
        momentum: vec![vec![0], vec![1]],
    }
}
