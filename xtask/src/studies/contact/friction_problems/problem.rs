//! Friction problems as such: rows of one moment, to be solved without a step around them.
//!
//! ```text
//! v = v_f + M^-1 J^T x,   u = J v - w,   K_i contains x_i,  K_i* contains u_i + mu_i |u_t| n,  x_i.(u_i + mu_i |u_t| n) = 0
//! ```
//! `v_f` velocities before any impulse, `M` masses and moments, `J` the rows, three of a contact (normal, two
//! tangents), `w` what they ask for, `x` impulses, `u` rates, `mu` friction, `K` Coulomb's cone, of joints and their
//! friction all that their laws admit. The kinds are those of the FCLIB collection (Acary, Bremond, Koziara, Perignon
//! 2014): blocks, chains, columns, dense packings, joints with contacts; where bodies touch at corners of faces rows
//! depend on each other.
//!
//! A problem is saved as text, one record a line, numbers in full:
//! ```text
//! friction-problem 1 NAME
//! mass M1 M2 ..                 one number a freedom, kg or kg m^2
//! free V1 V2 ..                 m/s or rad/s
//! equality ; W F:C F:C ..       what a row asks for and its entries, freedom:coefficient
//! limit ; W F:C ..
//! bounded B ; W F:C ..
//! contact MU ; W F:C .. ; W F:C .. ; W F:C ..        rows of normal and tangents
//! ```

use std::ops::Range;

use nalgebra::Vector3;
use stationary_calculus::{DiagonalMetric, Vector};
use stationary_constraints::{RowLaw, VelocityRows};
use stationary_contact::problems::landing_chain;
use stationary_contact::{
    Collider, ContactError, ContactRows, Detector, InverseMass, RowsReport, RowsSolver, Shape,
    gap_rows,
};
use stationary_measure::SplitMix64;
use stationary_rigid::{Body, BodyMetric, BodyMotion, LieGroup, Poses, RigidMotion, Rotation};

/// Gravity in the time over which contact is to hold, m/s.
const PULL: f64 = 0.0981;
/// The most records of a file, and numbers in one.
const MOST: usize = 1_000_000;
/// Masses of jointed boxes are within so many powers of ten of 1 kg.
const SPREAD: f64 = 1.5;

/// Rows of one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionProblem {
    /// Its name.
    pub name: String,
    mass: Vec<f64>,
    free: Vec<f64>,
    rows: VelocityRows,
}

/// Why a text is no problem: the line, counted from 1, and what is wrong.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {what}")]
pub struct ReadError {
    line: usize,
    what: &'static str,
}

impl FrictionProblem {
    /// Its contacts, joints and limits.
    pub fn blocks(&self) -> usize {
        self.rows.blocks().count()
    }

    /// Its text.
    pub fn write(&self) -> String {
        let numbers = |x: &[f64]| x.iter().map(|x| format!(" {x:?}")).collect::<String>();
        let mut text = format!("friction-problem 1 {}\n", self.name);
        text += &format!("mass{}\nfree{}\n", numbers(&self.mass), numbers(&self.free));
        for (law, rows) in self.rows.blocks() {
            text += &match law {
                RowLaw::Equality => "equality".to_owned(),
                RowLaw::Limit => "limit".to_owned(),
                RowLaw::Bounded(bound) => format!("bounded {bound:?}"),
                RowLaw::Cone(friction) => format!("contact {friction:?}"),
            };
            for row in rows {
                text += &format!(" ; {:?}", self.rows.asked(row));
                self.rows.row(row).for_each(|(f, c)| text += &format!(" {f}:{c:?}"));
            }
            text.push('\n');
        }
        text
    }

    /// The problem of a text.
    ///
    /// # Errors
    /// [`ReadError`] for a record that is none, for numbers that are not finite, masses that are not
    /// positive, negative friction, and freedoms that are not there.
    pub fn read(text: &str) -> Result<Self, ReadError> {
        let mut lines = text.lines().enumerate().take(MOST);
        let head = lines.next().and_then(|(_, line)| line.strip_prefix("friction-problem 1 "));
        let name = head.ok_or(ReadError { line: 1, what: "no friction problem" })?.to_owned();
        let (mass, free, rows) = (Vec::new(), Vec::new(), VelocityRows::default());
        let mut problem = FrictionProblem { name, mass, free, rows };
        for (number, line) in lines {
            let fault = |what| ReadError { line: number + 1, what };
            let finite = |word: &str| {
                let number: Option<f64> = word.parse().ok();
                number.filter(|x| x.is_finite()).ok_or(fault("a number is none"))
            };
            let mut parts = line.split(';');
            let mut words = parts.next().unwrap_or_default().split_whitespace().take(MOST);
            let record = words.next();
            let numbers: Vec<f64> = words.map(finite).collect::<Result<_, _>>()?;
            let law = match (record, &numbers[..]) {
                (Some("mass"), _) => {
                    problem.mass = numbers;
                    continue;
                }
                (Some("free"), _) => {
                    problem.free = numbers;
                    continue;
                }
                (Some("equality"), []) => RowLaw::Equality,
                (Some("limit"), []) => RowLaw::Limit,
                (Some("bounded"), [bound]) => RowLaw::Bounded(*bound),
                (Some("contact"), [friction]) => RowLaw::Cone(*friction),
                _ => return Err(fault("an unknown record")),
            };
            let entry = |word: &str| {
                let (freedom, value) =
                    word.split_once(':').ok_or(fault("an entry has no colon"))?;
                let freedom: usize =
                    freedom.parse().map_err(|_| fault("a freedom is no number"))?;
                if freedom >= problem.free.len() {
                    return Err(fault("a freedom is not there"));
                }
                Ok((freedom, finite(value)?))
            };
            let row = |words: &str| {
                let mut words = words.split_whitespace();
                let asked = finite(words.next().unwrap_or_default())?;
                Ok((words.map(entry).collect::<Result<Vec<_>, _>>()?, asked))
            };
            let block: Vec<_> = parts.map(row).collect::<Result<_, _>>()?;
            let block: Vec<_> =
                block.iter().map(|(entries, asked)| (&entries[..], *asked)).collect();
            problem.rows.push(law, &block).map_err(|_| {
                fault("a law has another number of rows, or a negative bound or friction")
            })?;
        }
        let positive = problem.mass.iter().all(|mass| *mass > 0.0);
        if !positive || problem.mass.len() != problem.free.len() {
            return Err(ReadError { line: 2, what: "a positive mass for each freedom is needed" });
        }
        Ok(problem)
    }

    /// Impulses by the solver of coupled rows, and its report.
    ///
    /// # Errors
    /// Those of [`RowsSolver::solve`].
    pub fn solve(&self, tolerance: f64) -> Result<(Vec<f64>, RowsReport), ContactError> {
        let metric = DiagonalMetric::new(self.mass.clone())?;
        let mut mass = InverseMass::of(&metric)?;
        let mut v = Vector(self.free.clone());
        let mut x = vec![0.0; self.rows.rows()];
        let mut solver = RowsSolver::default();
        let report = solver.solve(&self.rows, &mut mass, tolerance, &mut x, v.view_mut())?;
        Ok((x, report))
    }

    /// Impulses by nonsmooth Gauss-Seidel, block after block, until the residual is below a tolerance
    /// (m/s), and the sweeps that took.
    pub fn gauss_seidel(&self, tolerance: f64, most: usize) -> (Vec<f64>, usize) {
        let mut x = vec![0.0; self.rows.rows()];
        let mut v = self.free.clone();
        let blocks: Vec<_> =
            self.rows.blocks().map(|(law, rows)| (law, self.scale(&rows), rows)).collect();
        for sweep in 0..most {
            for (law, scale, rows) in &blocks {
                // The block on its own, by fixed-point steps in its cone.
                for _ in 0..20 {
                    let wanted = self.step(*law, rows, *scale, &x, &v);
                    let mut moved = 0.0_f64;
                    for (row, wanted) in rows.clone().zip(wanted) {
                        let change = wanted - x[row];
                        self.rows.row(row).for_each(|(f, c)| v[f] += c * change / self.mass[f]);
                        x[row] = wanted;
                        moved = moved.max(change.abs() * scale);
                    }
                    if moved < 0.01 * tolerance || rows.len() == 1 {
                        break;
                    }
                }
            }
            if sweep % 10 == 9 && self.residual(&x) <= tolerance {
                return (x, sweep + 1);
            }
        }
        (x, most)
    }

    /// How far impulses are from their laws, m/s: of the natural map.
    pub fn residual(&self, x: &[f64]) -> f64 {
        let mut v = self.free.clone();
        for (row, x) in x.iter().enumerate() {
            self.rows.row(row).for_each(|(f, c)| v[f] += c * x / self.mass[f]);
        }
        let off = |(law, rows): (RowLaw, Range<usize>)| {
            let scale = self.scale(&rows);
            let to = self.step(law, &rows, scale, x, &v);
            rows.zip(to).map(|(row, to)| (to - x[row]).powi(2)).sum::<f64>().sqrt() * scale
        };
        self.rows.blocks().map(off).fold(0.0, f64::max)
    }

    /// What a law admits that is nearest to `x - (u + mu |u_t| n)/scale`.
    fn step(&self, law: RowLaw, rows: &Range<usize>, scale: f64, x: &[f64], v: &[f64]) -> [f64; 3] {
        let [mut u, mut to] = [[0.0; 3]; 2];
        u.iter_mut().zip(rows.clone()).for_each(|(u, row)| *u = self.rows.lack(row, Vector(v)));
        if let RowLaw::Cone(friction) = law {
            u[0] += friction * u[1].hypot(u[2]);
        }
        to.iter_mut().zip(&x[rows.clone()]).zip(u).for_each(|((to, x), u)| *to = x - u / scale);
        law.nearest(&mut to[..rows.len()]);
        to
    }

    /// The largest eigenvalue of a block's own matrix is no more: the trace, 1/kg.
    fn scale(&self, rows: &Range<usize>) -> f64 {
        rows.clone().flat_map(|row| self.rows.row(row)).map(|(f, c)| c * c / self.mass[f]).sum()
    }

    /// Boxes on joints that land on a floor, with masses of `10^-spread` to `10^spread` kg.
    ///
    /// # Errors
    /// None: rows are finite.
    pub fn of_joints(
        name: String,
        bodies: usize,
        spread: f64,
        random: &mut SplitMix64,
    ) -> Result<Self, ContactError> {
        let chain = landing_chain(bodies, spread, random)?;
        Ok(FrictionProblem { name, mass: chain.masses, free: chain.velocity, rows: chain.rows })
    }

    /// Bodies that touch at these poses, pushed at random.
    fn of_bodies(
        name: String,
        bodies: Vec<Body>,
        poses: &[RigidMotion],
        shape: &Shape,
        push: f64,
        random: &mut SplitMix64,
    ) -> Result<Self, ContactError> {
        let friction = 0.2 + 0.6 * random.symmetric().abs();
        let still = Vector3::zeros();
        let motion = |&pose| BodyMotion { pose, velocity: still, angular_velocity: still };
        let metric = BodyMetric::<Poses>::new(bodies.clone());
        let q = metric.state(&poses.iter().map(motion).collect::<Vec<_>>())?.q;
        let on = |body| Collider::on_body(body, shape.clone()).with_friction(friction);
        let mut colliders: Vec<_> = (0..poses.len()).map(on).collect();
        let floor = Collider::fixed(RigidMotion::identity(), Shape::half_space(Vector3::z())?);
        colliders.push(floor.with_friction(friction));
        let mut detector = Detector::new(colliders, poses.len())?;
        let contacts = detector.detect(&q, 1e-6)?.to_vec();
        let normals = gap_rows(&contacts, &q);
        let mut across = ContactRows::new();
        contacts.iter().for_each(|contact| contact.push_tangents(&q, &mut across));
        let mut rows = VelocityRows::default();
        for (i, contact) in contacts.iter().enumerate() {
            let own = [normals.row(i), across.row(2 * i), across.row(2 * i + 1)];
            let own = own.map(|row| row.collect::<Vec<_>>());
            rows.push(RowLaw::Cone(contact.friction), &own.each_ref().map(|row| (&row[..], 0.0)))?;
        }
        let of = |body: &Body| {
            let (m, moments) = (body.mass(), body.moments());
            [m, m, m, moments.x, moments.y, moments.z]
        };
        let mut pushed = |k: usize| push * random.symmetric() - if k % 6 == 2 { PULL } else { 0.0 };
        Ok(FrictionProblem {
            name,
            mass: bodies.iter().flat_map(of).collect(),
            free: (0..6 * poses.len()).map(&mut pushed).collect(),
            rows,
        })
    }
}

/// Problems of the five kinds by turns.
///
/// # Errors
/// Those of shapes and of detection.
pub fn friction_problems(count: usize, seed: u64) -> Result<Vec<FrictionProblem>, ContactError> {
    let mut random = SplitMix64::new(seed);
    (0..count)
        .map(|k| {
            let size = 2 + (random.bits() % 5) as usize;
            let push = PULL * 10.0_f64.powf(0.7 * random.symmetric());
            let cube = Shape::cuboid([0.5; 3])?;
            let ball = Shape::ball(0.5)?;
            let upright = |x: f64, y: f64, z: f64| RigidMotion {
                translation: Vector3::new(x, y, z),
                rotation: Rotation::identity(),
            };
            let solid = Body::solid_box(1.0, [0.5; 3])?;
            let round = Body::new(1.0, [0.1; 3])?;
            let name = |kind: &str| format!("{kind}-{k}");
            if k % 5 == 4 {
                return FrictionProblem::of_joints(name("joints"), size, SPREAD, &mut random);
            }
            let (name, body, poses, shape): (_, _, Vec<_>, _) = match k % 5 {
                // Boxes beside each other: four corners each.
                0 => {
                    let at = |i: usize| upright(1.5 * i as f64, 0.0, 0.5);
                    (name("blocks"), solid, (0..size).map(at).collect(), cube)
                }
                // Balls in an arch-like row: one contact with each neighbour, full rank.
                1 => {
                    let lean = 0.3 * random.symmetric();
                    let at = |i: usize| {
                        let i = i as f64;
                        upright(i * lean.sin(), 0.0, 0.5 + i * lean.cos())
                    };
                    (name("chain"), round, (0..2 * size).map(at).collect(), ball)
                }
                // Boxes on each other.
                2 => {
                    let at = |i: usize| upright(0.0, 0.0, 0.5 + i as f64);
                    (name("column"), solid, (0..size).map(at).collect(), cube)
                }
                // Balls in a cubic packing.
                _ => {
                    let wide = 2 + size / 3;
                    let at = |i: usize| {
                        let [x, y, z] = [i % wide, i / wide % wide, i / (wide * wide)];
                        upright(x as f64, y as f64, 0.5 + z as f64)
                    };
                    (name("packing"), round, (0..wide * wide * 2).map(at).collect(), ball)
                }
            };
            let bodies = vec![body; poses.len()];
            FrictionProblem::of_bodies(name, bodies, &poses, &shape, push, &mut random)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_problem_that_is_written_is_read_as_it_was_and_a_text_that_is_none_names_its_line() {
        for problem in friction_problems(10, 3).unwrap() {
            let text = problem.write();
            assert_eq!(FrictionProblem::read(&text).unwrap(), problem);
            let cut: String = text
                .lines()
                .take(3)
                .chain(["contact x ; 0 0:1"])
                .map(|l| format!("{l}\n"))
                .collect();
            assert_eq!(FrictionProblem::read(&cut).unwrap_err().line, 4);
        }
        assert_eq!(FrictionProblem::read("").unwrap_err().line, 1);
    }
}
