//! A chain of hinged links: as a tree in joint coordinates, and as bodies held by RATTLE.

use std::hint::black_box;
use std::ops::ControlFlow;

use nalgebra::Vector3;
use stationary_chart::{Axis, Chart, Lines, Series};
use stationary_constraints::{ConstrainedIntegrator, Rattle, SparseDiagonal};
use stationary_integrators::{
    AdaptiveMethod, DormandPrince853, Integrator, Moment, Tolerance, integrate,
};
use stationary_measure::{Cell, Column, Table, loglog_slope};
use stationary_rigid::tree::{
    Tree, TreeBuilder, TreeField, TreeForces, TreeMotion, TreeVariational,
};
use stationary_rigid::{
    Body, BodyMetric, BodySpace, ConstantVelocity, FreeBodies, Joint, JointEnd, JointKind,
    LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

use crate::studies::cheapest::{Asked, cost_at};
use crate::study::{Answer, Claim, Entry, Kind, Size, Study, StudyError, Tested};
use crate::timing::median_wall;

/// Error against work and time, in joint coordinates and in full ones.
pub const JOINT_COORDINATES: Entry<'static> = Entry {
    id: "joint-coordinates",
    krate: "rigid",
    chapter: "6.5",
    kind: Kind::WorkPrecision,
    title: "Chain of 1 to 100 links: error against cost in joint coordinates and in full ones",
    tested: Tested::ByReport,
    run: &study,
};

/// The length of the chain (m), its mass (kg), the angle from hanging at which it is let go (rad),
/// and the time after which its links are looked for (s).
const LENGTH: f64 = 1.0;
const MASS: f64 = 1.0;
const ANGLE: f64 = 0.8;
const TIME: f64 = 0.5;
const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

const ADAPTIVE: &str = "dormand-prince-853, joint coordinates";
const FIXED: &str = "variational step, joint coordinates";
const FULL: &str = "RATTLE, full coordinates";

/// A chain, told both ways.
struct Chain {
    tree: Tree,
    bodies: Vec<Body>,
    joints: Vec<Joint<Poses>>,
}

/// Where the centres are at the end, and the links solved for on the way.
struct End {
    centres: Vec<Vector3<f64>>,
    work: u64,
}

fn at(z: f64) -> RigidMotion {
    RigidMotion { translation: Vector3::z() * z, rotation: Rotation::identity() }
}

impl Chain {
    fn new(links: usize) -> Result<Self, StudyError> {
        let half = 0.5 * LENGTH / links as f64;
        let body = Body::solid_box(MASS / links as f64, [0.01, 0.015, half])
            .map_err(StudyError::at("a link"))?;
        let mut builder = TreeBuilder::default();
        let mut joints = Vec::new();
        for k in 0..links {
            let parent = k.checked_sub(1);
            let foot = if k == 0 { 0.0 } else { -half };
            let hinge = JointKind::Hinge { axis: Vector3::y() };
            builder.hang(parent, hinge, [at(foot), at(half)], body);
            let foot = Vector3::z() * foot;
            let up = parent.map_or(JointEnd::world(foot), |p| JointEnd::on(p, foot));
            let ends = [up, JointEnd::on(k, Vector3::z() * half)];
            joints.push(Joint::new(Poses, links, hinge, ends).map_err(StudyError::at("a hinge"))?);
        }
        let tree = builder.build().map_err(StudyError::at("the tree"))?;
        Ok(Chain { tree, bodies: vec![body; links], joints })
    }

    fn links(&self) -> u64 {
        self.bodies.len() as u64
    }

    /// Coordinates and speeds at the start: straight, and at rest.
    fn start(&self) -> (Vec<f64>, Vec<f64>) {
        let mut q = self.tree.rest();
        q[0] = ANGLE;
        (q, vec![0.0; self.tree.speeds()])
    }

    fn centres(&self, q: &[f64]) -> Result<Vec<Vector3<f64>>, StudyError> {
        let at = || StudyError::at("the end");
        let mut motion = TreeMotion::new(self.tree.clone());
        motion.place(q, &vec![0.0; self.tree.speeds()]).map_err(at())?;
        let centre = |body| Ok(motion.pose(body).map_err(at())?.translation);
        (0..self.bodies.len()).map(centre).collect()
    }

    fn adaptive(&self, tolerance: f64) -> Result<End, StudyError> {
        let (q, v) = self.start();
        let weight =
            TreeForces::weight(&self.tree, GRAVITY).map_err(StudyError::at("the weight"))?;
        let field =
            TreeField::new(self.tree.clone(), weight).map_err(StudyError::at("the field"))?;
        let tolerance =
            Tolerance::new(tolerance, tolerance).map_err(StudyError::at("a tolerance"))?;
        let start = Moment::new(0.0, [q, v].concat());
        let mut method = DormandPrince853::new(field, tolerance.into(), start)
            .map_err(StudyError::at("the method"))?;
        integrate(&mut method, TIME, |_| ControlFlow::Continue(()))
            .map_err(StudyError::at("a run"))?;
        let centres = self.centres(&method.moment().y[..self.tree.coordinates()])?;
        Ok(End { centres, work: method.work().evaluations * self.links() })
    }

    fn fixed(&self, steps: u32) -> Result<End, StudyError> {
        let (q, v) = self.start();
        let mut method = TreeVariational::new(self.tree.clone(), GRAVITY)
            .map_err(StudyError::at("the method"))?;
        let mut state = method.state(&q, &v).map_err(StudyError::at("the start"))?;
        let mut solves = 0;
        for _ in 0..steps {
            let report = method
                .step(&mut state, TIME / f64::from(steps))
                .map_err(StudyError::at("a step"))?;
            // The guess solves once, too.
            solves += u64::from(report.hessians) + 1;
        }
        Ok(End { centres: self.centres(&state.q)?, work: solves * self.links() })
    }

    fn full(&self, steps: u32) -> Result<End, StudyError> {
        let (q, v) = self.start();
        let mut motion = TreeMotion::new(self.tree.clone());
        motion.place(&q, &v).map_err(StudyError::at("the start"))?;
        let motions = (0..self.bodies.len())
            .map(|body| motion.body(body))
            .collect::<Result<Vec<_>, _>>()
            .map_err(StudyError::at("the start"))?;
        let metric = BodyMetric::<Poses>::new(self.bodies.clone());
        let mut state = metric.state(&motions).map_err(StudyError::at("the start"))?;
        let load = |body: &Body| PointMass { mass: body.mass(), point: Vector3::zeros() };
        let masses = self.bodies.iter().map(load).collect();
        let weight = Weight { gravity: GRAVITY, masses, space: Poses };
        let system = metric.under(weight).map_err(StudyError::at("the bodies"))?;
        let free = FreeBodies(ConstantVelocity);
        let mut rattle =
            Rattle::along(free, &system, &self.joints, &state, SparseDiagonal::default())
                .map_err(StudyError::at("the joints"))?;
        let mut solves = 0;
        for _ in 0..steps {
            let report = rattle
                .step(&mut state, TIME / f64::from(steps))
                .map_err(StudyError::at("a step"))?;
            // The velocities are solved for once.
            solves += u64::from(report.iterations) + 1;
        }
        let centre = |body| Poses::pose_at(&state.q, body).translation;
        let centres = (0..self.bodies.len()).map(centre).collect();
        Ok(End { centres, work: solves * self.links() })
    }
}

fn apart(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// The runs of one way of telling a chain: work, time and error of each.
#[derive(Default)]
struct Runs {
    by_work: Vec<(f64, f64)>,
    by_time: Vec<(f64, f64)>,
}

/// The table, and what one chain adds to the page.
struct Page {
    table: Table,
    charts: Vec<Chart>,
    claims: Vec<Claim>,
    answers: Vec<Answer>,
    /// The time of RATTLE over that of the same steps in joint coordinates, chain by chain.
    slower: Vec<(usize, f64)>,
}

/// The links of each chain, and the fewest steps: a step that does not resolve the fastest mode is
/// unstable, in joint coordinates and in full ones, and that mode is the faster the more links there are.
const COARSEST: [(usize, u32); 5] = [(1, 40), (3, 40), (10, 60), (30, 100), (100, 240)];

const TOLERANCES: [f64; 3] = [1e-4, 1e-7, 1e-10];

impl Page {
    /// Runs one chain in every way.
    fn measure(&mut self, links: usize, steps: &[u32]) -> Result<(), StudyError> {
        let chain = Chain::new(links)?;
        let exact = chain.adaptive(1e-13)?.centres;
        let [mut adaptive, mut fixed, mut full] =
            [Runs::default(), Runs::default(), Runs::default()];
        for tolerance in TOLERANCES {
            let run = || chain.adaptive(tolerance);
            self.one((links, ADAPTIVE), format!("{tolerance:.0e}"), run, &exact, &mut adaptive)?;
        }
        let mut same = 0.0_f64;
        for &steps in steps {
            let setting = || format!("{steps} steps");
            let reduced =
                self.one((links, FIXED), setting(), || chain.fixed(steps), &exact, &mut fixed)?;
            let held =
                self.one((links, FULL), setting(), || chain.full(steps), &exact, &mut full)?;
            same = same.max(apart(&reduced.centres, &held.centres));
        }
        let text =
            format!("links: {links}; how far the variational step and RATTLE are apart at most, m");
        self.claims.push(Claim::number(text, "rounding", same, (0.0, 1e-10)));
        let against_steps: Vec<_> = fixed
            .by_work
            .iter()
            .zip(steps)
            .map(|(&(_, error), &steps)| (TIME / f64::from(steps), error))
            .collect();
        let order = loglog_slope(&against_steps).unwrap_or(f64::NAN);
        let text = format!("links: {links}; order of the variational step");
        self.claims.push(Claim::number(text, "2", order, (1.8, 2.2)));
        if let (Some(least), Some(more)) = (
            cost_at(FINE, &adaptive.by_work),
            fixed.by_work.last().map(|&(work, error)| work * (error / FINE).sqrt()),
        ) {
            let text = format!(
                "links: {links}; to {FINE:.0e} m, work of the variational step, by its order, over \
                 that of the adaptive method"
            );
            self.claims.push(Claim::number(
                text,
                "more than 1",
                more / least,
                (1.0, f64::INFINITY),
            ));
        }
        if let (Some((reduced, _)), Some((held, _))) = (fixed.by_time.last(), full.by_time.last()) {
            self.slower.push((links, held / reduced));
        }
        let heading = |by: &str| match links {
            1 => format!("1 link, by {by}"),
            _ => format!("{links} links, by {by}"),
        };
        let error = || Axis::log("error of a centre at the end", "m");
        let work = Axis::log("links solved for", "");
        let mut counted = Lines::new(&heading("work"), work, error()).mark_front();
        let mut timed = Lines::new(&heading("time"), Axis::log("time", "s"), error()).mark_front();
        for (name, runs) in [(ADAPTIVE, adaptive), (FIXED, fixed), (FULL, full)] {
            counted = counted.with(Series::new(name, runs.by_work));
            timed = timed.with(Series::new(name, runs.by_time));
        }
        if links == 30 {
            let question = "Chain of 30 hinged links for half a second, to 1e-4 m";
            let asked = Asked { question, error: 1e-4, cost: "solves", rival: FULL };
            self.answers.extend(asked.of(&counted));
        }
        self.charts.push(counted.into());
        self.charts.push(timed.into());
        Ok(())
    }

    fn one(
        &mut self,
        (links, way): (usize, &'static str),
        setting: String,
        run: impl Fn() -> Result<End, StudyError>,
        exact: &[Vector3<f64>],
        runs: &mut Runs,
    ) -> Result<End, StudyError> {
        let mut last = None;
        let wall = median_wall(|| last = Some(black_box(run())));
        let end = match last {
            Some(end) => end?,
            None => run()?,
        };
        let error = apart(&end.centres, exact).max(1e-16);
        let cells: [Cell; 6] = [
            (links as u64).into(),
            way.into(),
            setting.into(),
            end.work.into(),
            error.into(),
            wall.median.into(),
        ];
        self.table.push(cells);
        runs.by_work.push((end.work as f64, error));
        runs.by_time.push((wall.median, error));
        Ok(end)
    }
}

/// The error, metres, at which the adaptive method and the fixed step are compared by their work.
const FINE: f64 = 1e-7;

fn study(size: Size) -> Result<Study, StudyError> {
    let halvings = match size {
        Size::Default => 3,
        Size::Full => 6,
    };
    let columns = [
        Column::exact("links"),
        Column::exact("way"),
        Column::exact("setting"),
        Column::rounded("links solved for", 2, 0.0),
        Column::rounded("error [m]", 1, 1e-10),
        Column::volatile("time [s]"),
    ];
    let mut page = Page {
        table: Table::new(columns),
        charts: Vec::new(),
        claims: Vec::new(),
        answers: Vec::new(),
        slower: Vec::new(),
    };
    for (links, coarsest) in COARSEST {
        // The longest takes as long as all the others.
        let halvings = if links < 100 { halvings } else { halvings - 1 };
        let steps: Vec<u32> = (0..halvings).map(|halving| coarsest << halving).collect();
        page.measure(links, &steps)?;
    }
    let Page { table, charts, claims, answers, slower } = page;
    let ratios: Vec<String> = slower.iter().map(|(_, ratio)| format!("{ratio:.1}")).collect();
    let lengths: Vec<String> = slower.iter().map(|(links, _)| links.to_string()).collect();
    let from = slower.iter().find(|(_, ratio)| *ratio > 1.0);
    let verdict = match from {
        Some((links, _)) => format!("so that joint coordinates are cheaper from {links} on"),
        None => "so that joint coordinates are nowhere cheaper".to_owned(),
    };
    Ok(Study {
        conclusion: format!(
            "A chain of {LENGTH} m, straight at {ANGLE} rad from hanging, is let go for {TIME} s. In joint \
             coordinates each link is one number, in full coordinates seven, with five equations. The \
             variational step and RATTLE have the same discrete principle, and so at equal steps the \
             same motion, with the same error. With {} links RATTLE took {} times as long, {verdict}. \
             The adaptive method is of order 8, and its lead grows with the digits asked for; it is not \
             symplectic. All three must resolve the chain's fastest mode.",
            lengths.join(", "),
            ratios.join(", ")
        ),
        table,
        charts,
        claims,
        answers,
        ..JOINT_COORDINATES.heading()
    })
}
