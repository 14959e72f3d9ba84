//! Friction problems as such: contacts of one moment, to be solved without a step around them.
//!
//! ```text
//! v = v_f + M^-1 J^T x,   u = J v,   K_i contains x_i,  K_i* contains u_i + mu_i |u_t| n,  x_i.(u_i + mu_i |u_t| n) = 0
//! ```
//! `v_f` velocities before any impulse, `M` masses and moments, `J` the rows of contacts, three each (normal,
//! two tangents), `x` impulses, `u` rates, `mu` friction, `K` Coulomb's cone. The kinds are those of the FCLIB
//! collection (Acary, Bremond, Koziara, Perignon 2014): blocks, chains, columns, dense packings; where bodies
//! touch at corners of faces rows depend on each other.
//!
//! A problem is saved as text, one record a line, numbers in full:
//! ```text
//! friction-problem 1 NAME
//! mass M1 M2 ..                 one number a freedom, kg or kg m^2
//! free V1 V2 ..                 m/s or rad/s
//! contact MU F:C F:C .. ; F:C .. ; F:C ..        rows of normal and tangents, freedom:coefficient
//! ```

use nalgebra::Vector3;
use stationary_calculus::{DiagonalMetric, Vector};
use stationary_constraints::{RowLaw, VelocityRows};
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

/// Contacts of one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionProblem {
    /// Its name.
    pub name: String,
    mass: Vec<f64>,
    free: Vec<f64>,
    friction: Vec<f64>,
    /// Normal and tangents of each contact.
    rows: Vec<[Vec<(usize, f64)>; 3]>,
}

/// Why a text is no problem: the line, counted from 1, and what is wrong.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {what}")]
pub struct ReadError {
    line: usize,
    what: &'static str,
}

impl FrictionProblem {
    /// Contacts.
    pub fn contacts(&self) -> usize {
        self.friction.len()
    }

    /// Its text.
    pub fn write(&self) -> String {
        let numbers = |x: &[f64]| x.iter().map(|x| format!(" {x:?}")).collect::<String>();
        let mut text = format!("friction-problem 1 {}\n", self.name);
        text += &format!("mass{}\nfree{}\n", numbers(&self.mass), numbers(&self.free));
        for (friction, rows) in self.friction.iter().zip(&self.rows) {
            let row = |row: &Vec<(usize, f64)>| {
                row.iter().map(|(f, c)| format!("{f}:{c:?}")).collect::<Vec<_>>().join(" ")
            };
            text += &format!("contact {friction:?} {}\n", rows.each_ref().map(row).join(" ; "));
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
        let mut problem = FrictionProblem {
            name,
            mass: Vec::new(),
            free: Vec::new(),
            friction: Vec::new(),
            rows: Vec::new(),
        };
        for (number, line) in lines {
            let fault = |what| ReadError { line: number + 1, what };
            let finite = |word: &str| {
                let number: Option<f64> = word.parse().ok();
                number.filter(|x| x.is_finite()).ok_or(fault("a number is none"))
            };
            let numbers = |words: &str| -> Result<Vec<f64>, ReadError> {
                words.split_whitespace().take(MOST).map(finite).collect()
            };
            match line.split_once(' ') {
                Some(("mass", words)) => problem.mass = numbers(words)?,
                Some(("free", words)) => problem.free = numbers(words)?,
                Some(("contact", words)) => {
                    let (friction, rows) =
                        words.split_once(' ').ok_or(fault("a contact has no rows"))?;
                    let friction = finite(friction)?;
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
                    let row = |words: &str| words.split_whitespace().map(entry).collect();
                    let rows: Vec<Vec<_>> = rows.split(';').map(row).collect::<Result<_, _>>()?;
                    let rows = rows.try_into().map_err(|_| fault("a contact has three rows"))?;
                    if friction < 0.0 {
                        return Err(fault("friction is negative"));
                    }
                    problem.friction.push(friction);
                    problem.rows.push(rows);
                }
                _ => return Err(fault("an unknown record")),
            }
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
    pub fn solve(&self, tolerance: f64) -> Result<(Vec<[f64; 3]>, RowsReport), ContactError> {
        let mut rows = VelocityRows::default();
        for (&friction, own) in self.friction.iter().zip(&self.rows) {
            let block = own.each_ref().map(|row| (&row[..], 0.0));
            rows.push(RowLaw::Cone(friction), &block)?;
        }
        let metric = DiagonalMetric::new(self.mass.clone())
            .map_err(|_| ContactError::Mass { freedom: 0 })?;
        let mut mass = InverseMass::of(&metric)?;
        let mut v = Vector(self.free.clone());
        let mut x = vec![0.0; rows.rows()];
        let mut solver = RowsSolver::default();
        let report = solver.solve(&rows, &mut mass, tolerance, &mut x, v.view_mut())?;
        Ok((x.as_chunks::<3>().0.to_vec(), report))
    }

    /// Impulses by nonsmooth Gauss-Seidel, contact after contact, until the residual is below a tolerance
    /// (m/s), and the sweeps that took.
    pub fn gauss_seidel(&self, tolerance: f64, most: usize) -> (Vec<[f64; 3]>, usize) {
        let mut x = vec![[0.0; 3]; self.contacts()];
        let mut v = self.free.clone();
        let scales: Vec<f64> = (0..self.contacts()).map(|i| self.scale(i)).collect();
        for sweep in 0..most {
            for i in 0..x.len() {
                // The contact on its own, by fixed-point steps in its cone.
                for _ in 0..20 {
                    let wanted = self.step(i, &x[i], &v, scales[i]);
                    let change = [0, 1, 2].map(|k| wanted[k] - x[i][k]);
                    for (k, row) in self.rows[i].iter().enumerate() {
                        row.iter().for_each(|&(f, c)| v[f] += c * change[k] / self.mass[f]);
                    }
                    x[i] = wanted;
                    if change.iter().all(|c| c.abs() * scales[i] < 0.01 * tolerance) {
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

    /// How far impulses are from Coulomb's law, m/s: of the natural map of the cone.
    pub fn residual(&self, x: &[[f64; 3]]) -> f64 {
        let mut v = self.free.clone();
        for (own, x) in self.rows.iter().zip(x) {
            for (row, x) in own.iter().zip(x) {
                row.iter().for_each(|&(f, c)| v[f] += c * x / self.mass[f]);
            }
        }
        let off = |(i, x): (usize, &[f64; 3])| {
            let scale = self.scale(i);
            let to = self.step(i, x, &v, scale);
            [0, 1, 2].map(|k| (to[k] - x[k]).powi(2)).iter().sum::<f64>().sqrt() * scale
        };
        x.iter().enumerate().map(off).fold(0.0, f64::max)
    }

    /// The nearest point of the cone to `x - (u + mu |u_t| n)/scale`.
    fn step(&self, i: usize, x: &[f64; 3], v: &[f64], scale: f64) -> [f64; 3] {
        let mu = self.friction[i];
        let u = self.rows[i].each_ref().map(|row| row.iter().map(|&(f, c)| c * v[f]).sum::<f64>());
        let slip = u[1].hypot(u[2]);
        let z = [x[0] - (u[0] + mu * slip) / scale, x[1] - u[1] / scale, x[2] - u[2] / scale];
        let across = z[1].hypot(z[2]);
        if across <= mu * z[0] {
            return z;
        }
        if mu * across <= -z[0] {
            return [0.0; 3];
        }
        let normal = (z[0] + mu * across) / (1.0 + mu * mu);
        let part = mu * normal / across;
        [normal, part * z[1], part * z[2]]
    }

    /// The largest eigenvalue of a contact's own block is no more: the trace, 1/kg.
    fn scale(&self, i: usize) -> f64 {
        self.rows[i].iter().flatten().map(|&(f, c)| c * c / self.mass[f]).sum()
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
        let rows = |i: usize| {
            [normals.row(i).collect(), across.row(2 * i).collect(), across.row(2 * i + 1).collect()]
        };
        let of = |body: &Body| {
            let (m, moments) = (body.mass(), body.moments());
            [m, m, m, moments.x, moments.y, moments.z]
        };
        let mut pushed = |k: usize| push * random.symmetric() - if k % 6 == 2 { PULL } else { 0.0 };
        Ok(FrictionProblem {
            name,
            mass: bodies.iter().flat_map(of).collect(),
            free: (0..6 * poses.len()).map(&mut pushed).collect(),
            friction: contacts.iter().map(|contact| contact.friction).collect(),
            rows: (0..contacts.len()).map(rows).collect(),
        })
    }
}

/// Problems of the four kinds by turns.
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
            let (name, body, poses, shape): (_, _, Vec<_>, _) = match k % 4 {
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
        for problem in friction_problems(8, 3).unwrap() {
            let text = problem.write();
            assert_eq!(FrictionProblem::read(&text).unwrap(), problem);
            let cut: String =
                text.lines().take(3).chain(["contact x 0:1"]).map(|l| format!("{l}\n")).collect();
            assert_eq!(FrictionProblem::read(&cut).unwrap_err().line, 4);
        }
        assert_eq!(FrictionProblem::read("").unwrap_err().line, 1);
    }
}
