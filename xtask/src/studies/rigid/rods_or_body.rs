//! One polygon as triangulated rods and as a rigid body: what its rigidity costs.

use nalgebra::Vector2;
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_chart::{Axis, Lines, Series};
use stationary_constraints::{
    ConstrainedIntegrator, Penalty, Rattle, Redundancy, Rod, Rods, SparseDiagonal,
};
use stationary_integrators::{Integrator, State, StormerVerlet, UniformGravity};
use stationary_measure::{Cell, Column, Table, loglog_slope};
use stationary_rigid::{LieGroup, PlanarMass, PlanarRotation, PlanarWeight};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Error against work of the three models.
pub const RODS_OR_BODY: Entry<'static> = Entry {
    id: "rods-or-rigid-body",
    krate: "rigid",
    chapter: "7",
    kind: Kind::Ladder,
    title: "Thrown polygon: triangulated rods against a rigid body",
    tested: Tested::Claims,
    run: &study,
};

/// The corners of the polygon, metres: an arrow head, which is not convex.
const CORNERS: [[f64; 2]; 4] = [[0.0, 0.0], [0.4, -0.3], [0.0, 0.6], [-0.4, -0.3]];
/// Its sides and the diagonal that triangulates it.
const RODS: [[usize; 2]; 5] = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]];
/// A mass at every corner, kg.
const MASS: f64 = 0.5;
/// How it is thrown: the velocity of its centre, m/s, and its rate of turn, rad/s.
const THROWN: [f64; 2] = [1.5, 4.0];
const RATE: f64 = 7.0;
const GRAVITY: f64 = 9.81;
/// How long it flies, seconds.
const TIME: f64 = 0.8;

type Points = [f64; 8];

/// The polygon's shape: its corners from its centre, and its inertia about it.
struct Shape {
    mass: PlanarMass,
    arms: [Vector2<f64>; 4],
}

impl Shape {
    fn new() -> Result<Self, StudyError> {
        let corner = |at: [f64; 2]| PlanarMass { mass: MASS, centre: at.into(), inertia: 0.0 };
        let mass = PlanarMass::composite(&CORNERS.map(corner))
            .map_err(StudyError::at("the polygon's mass"))?;
        Ok(Shape { arms: CORNERS.map(|at| Vector2::from(at) - mass.centre), mass })
    }

    /// Corners where the centre and the angle are known.
    fn corners(&self, centre: Vector2<f64>, angle: f64) -> Points {
        let turn = PlanarRotation::exp(angle);
        let places = self.arms.map(|arm| centre + turn.rotate(&arm));
        std::array::from_fn(|i| places[i / 2][i % 2])
    }

    /// Where the corners are after the flight.
    fn landed(&self) -> Points {
        let fall = Vector2::y() * (0.5 * GRAVITY * TIME * TIME);
        self.corners(self.mass.centre + Vector2::from(THROWN) * TIME - fall, RATE * TIME)
    }

    fn error(&self, q: &[f64]) -> f64 {
        let off = q.iter().zip(self.landed()).map(|(a, b)| (a - b).abs());
        off.fold(0.0, f64::max)
    }

    /// The corners' state when they are thrown.
    fn thrown(&self) -> State<Points> {
        let velocity =
            |arm: Vector2<f64>| Vector2::from(THROWN) + Vector2::new(-arm.y, arm.x) * RATE;
        let p = self.arms.map(velocity);
        let q = std::array::from_fn(|i| CORNERS[i / 2][i % 2]);
        State { t: 0.0, q, p: Covector(std::array::from_fn(|i| MASS * p[i / 2][i % 2])) }
    }
}

fn rods() -> Result<Rods<2>, StudyError> {
    let length =
        |[a, b]: [usize; 2]| (Vector2::from(CORNERS[a]) - Vector2::from(CORNERS[b])).norm();
    let rods = RODS.map(|ends| Rod::new(ends, length(ends))).to_vec();
    Rods::new(4, Vec::new(), rods).map_err(StudyError::at("the rods"))
}

fn gravity() -> UniformGravity<2> {
    UniformGravity { acceleration: [0.0, -GRAVITY], masses: vec![MASS; 4] }
}

fn metric() -> Result<DiagonalMetric<Points>, StudyError> {
    DiagonalMetric::new([MASS; 8]).map_err(StudyError::at("the corners' masses"))
}

/// Rods held by multipliers.
fn by_rattle(shape: &Shape, steps: u32) -> Result<f64, StudyError> {
    let system = System::new(metric()?, gravity()).map_err(StudyError::at("the corners"))?;
    let (mut state, few) = (shape.thrown(), SparseDiagonal(Redundancy::Refuse));
    let mut rattle =
        Rattle::new(&system, rods()?, &state, few).map_err(StudyError::at("the rods"))?;
    for _ in 0..steps {
        rattle.step(&mut state, TIME / f64::from(steps)).map_err(StudyError::at("a step"))?;
    }
    Ok(shape.error(&state.q))
}

/// Rods as stiff springs, at a step of half the border of stability; the steps, and the error.
fn by_springs(shape: &Shape, stiffness: f64) -> Result<(u32, f64), StudyError> {
    let penalty = Penalty::new(rods()?, stiffness, 0.0).map_err(StudyError::at("the springs"))?;
    let (mut state, metric) = (shape.thrown(), metric()?);
    let facts = stationary_integrators::Method::StormerVerlet.facts();
    let limit =
        penalty.stable_step(facts, &metric, &state.q).map_err(StudyError::at("the stable step"))?;
    let steps = (TIME / (0.5 * limit)).ceil() as u32;
    let system = System::new(metric, (gravity(), penalty)).map_err(StudyError::at("springs"))?;
    let mut verlet = StormerVerlet::new(&system).map_err(StudyError::at("springs"))?;
    for _ in 0..steps {
        verlet.step(&mut state, TIME / f64::from(steps)).map_err(StudyError::at("a step"))?;
    }
    Ok((steps, shape.error(&state.q)))
}

/// One body of three freedoms.
fn as_a_body(shape: &Shape, steps: u32) -> Result<f64, StudyError> {
    let weight = PlanarWeight { gravity: -Vector2::y() * GRAVITY, masses: vec![shape.mass.mass] };
    let metric = shape.mass.metric().map_err(StudyError::at("the body"))?;
    let system = System::new(metric, weight).map_err(StudyError::at("the body"))?;
    let (mass, centre) = (shape.mass.mass, shape.mass.centre);
    let p = [mass * THROWN[0], mass * THROWN[1], shape.mass.inertia * RATE];
    let mut state = State::new([centre.x, centre.y, 0.0], Covector(p));
    let mut verlet = StormerVerlet::new(&system).map_err(StudyError::at("the body"))?;
    for _ in 0..steps {
        verlet.step(&mut state, TIME / f64::from(steps)).map_err(StudyError::at("a step"))?;
    }
    let [x, y, angle] = state.q;
    Ok(shape.error(&shape.corners(Vector2::new(x, y), angle)))
}

fn study(size: Size) -> Result<Study, StudyError> {
    let powers = match size {
        Size::Default => 8,
        Size::Full => 12,
    };
    let shape = Shape::new()?;
    let mut table = Table::new([
        Column::exact("model"),
        Column::exact("freedoms"),
        Column::exact("steps"),
        Column::rounded("error [m]", 2, 1e-12),
    ]);
    let (mut springs, mut rattle, mut body) = (Vec::new(), Vec::new(), Vec::new());
    for power in 0..powers {
        let (steps, error) = by_springs(&shape, 1e3 * 4.0_f64.powi(power))?;
        springs.push((steps, error));
        let steps = 50_u32 << power;
        rattle.push((steps, by_rattle(&shape, steps)?));
        body.push((1 << power, as_a_body(&shape, 1 << power)?));
    }
    let models =
        [("stiff springs", 8, springs), ("rigid rods", 8, rattle), ("rigid body", 3, body)];
    let mut chart = Lines::new("Corners", Axis::log("steps", ""), Axis::log("error", "m"));
    let mut claims = Vec::new();
    for (name, freedoms, runs) in models {
        let mut points = Vec::new();
        for (steps, error) in runs {
            let cells: [Cell; 4] =
                [name.into(), freedoms.into(), u64::from(steps).into(), error.into()];
            table.push(cells);
            points.push((f64::from(steps), error.max(1e-16)));
        }
        let worst = points.iter().fold(0.0_f64, |worst, p| worst.max(p.1));
        claims.push(match name {
            "rigid body" => {
                let text = "rigid body: the error at any number of steps, metres";
                Claim::number(text, "rounding", worst, (0.0, 1e-13))
            }
            _ => {
                let order = -loglog_slope(&points).unwrap_or(f64::NAN);
                let text = format!("{name}: the power of the steps with which the error falls");
                Claim::number(text, "2", order, (1.7, 2.3))
            }
        });
        chart = chart.with(Series::new(name, points));
    }
    Ok(Study {
        conclusion: format!(
            "Four masses at the corners of an arrow head, thrown with a spin of {RATE} rad/s, fly for \
             {TIME} s. Stiff springs stretch under the spin by one over their stiffness, and their \
             step must shrink with its root; rods held by multipliers are rigid at any step, but turn \
             by chords. As a rigid body the polygon has three freedoms instead of eight, and all of \
             its flight is known: what chapter 7 is for."
        ),
        table,
        charts: vec![chart.into()],
        claims,
        ..RODS_OR_BODY.heading()
    })
}
