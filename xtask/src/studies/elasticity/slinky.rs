//! A band that is let go at the top: its lower end stays until the wave arrives.

use stationary_calculus::{Covector, Newton, System};
use stationary_chart::{Axis, Lines, Series};
use stationary_elasticity::{
    DeadLoad, ElasticityError, Freedoms, Held, Lame, LinearSegment, SaintVenantKirchhoff, Solid,
    Statics, lumped_mass,
};
use stationary_integrators::{Integrator, State, StormerVerlet};
use stationary_measure::{Column, Table};
use stationary_mesh::{Mesh, bar};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Fall of both ends against time, and the time at which the lower one starts.
pub const STUDY: Entry<'static> = Entry {
    id: "slinky",
    krate: "elasticity",
    chapter: "12.3",
    kind: Kind::Convergence,
    title: "Band and slinky that are let go: height of both ends against time",
    tested: Tested::Claims,
    run: &study,
};

const GRAVITY: f64 = 9.81;
/// The lower end has started once it has fallen this far, m.
const STARTED: f64 = 1e-4;

fn failed() -> impl FnOnce(ElasticityError) -> StudyError {
    StudyError::at("the band")
}

/// A band of one metre and one kilogram with stiffness c2 (N), x pointing down.
struct Band {
    mesh: Mesh<1, 2>,
    material: SaintVenantKirchhoff<1>,
    stiffness: f64,
}

/// What became of a band: times, places of its ends, and when the lower one started.
struct Fall {
    top: Vec<(f64, f64)>,
    bottom: Vec<(f64, f64)>,
    stretch: f64,
    predicted: f64,
    measured: f64,
}

impl Band {
    fn new(stiffness: f64, cells: usize) -> Result<Self, StudyError> {
        let lame = Lame::<1>::from_young_poisson(stiffness, 0.0).map_err(failed())?;
        Ok(Band {
            mesh: bar(1.0, cells).map_err(StudyError::at("a line"))?,
            material: SaintVenantKirchhoff::new(lame),
            stiffness,
        })
    }

    fn nodes(&self) -> Vec<[f64; 1]> {
        self.mesh.vertices().iter().map(|&x| x.into()).collect()
    }

    /// Where it hangs from its top.
    fn hung(&self) -> Result<Vec<f64>, StudyError> {
        let nodes = self.nodes();
        let top = [Held { vertex: 0, component: 0, place: 0.0 }];
        let freedoms = Freedoms::<1>::new(nodes.len(), &top).map_err(failed())?;
        let load = DeadLoad::body(LinearSegment, &self.mesh, 1.0, &freedoms, |_| [GRAVITY])
            .map_err(failed())?;
        let mass =
            lumped_mass(LinearSegment, &self.mesh, [1.0, 1.0], &freedoms).map_err(failed())?;
        let mut solid = Solid::new(LinearSegment, &self.mesh, 1.0, self.material, freedoms.clone())
            .map_err(failed())?;
        let mut q = freedoms.gathered(&nodes).map_err(failed())?;
        let statics = Statics {
            steps: 4,
            newton: Newton { iterations: 100, ..Newton::default() },
            ..Statics::default()
        };
        statics.solve(&mut solid, &load, &mass, &[0.0], &mut q).map_err(failed())?;
        let positions = freedoms.positions(&q).map_err(failed())?;
        Ok(positions.iter().map(|x| x[0]).collect())
    }

    fn fall(&self) -> Result<Fall, StudyError> {
        let cells = self.mesh.simplices().len();
        let hung = self.hung()?;
        let freedoms = Freedoms::<1>::free(cells + 1).map_err(failed())?;
        let solid = Solid::new(LinearSegment, &self.mesh, 1.0, self.material, freedoms.clone())
            .map_err(failed())?;
        let load = DeadLoad::body(LinearSegment, &self.mesh, 1.0, &freedoms, |_| [GRAVITY])
            .map_err(failed())?;
        let mass =
            lumped_mass(LinearSegment, &self.mesh, [1.0, 1.0], &freedoms).map_err(failed())?;
        let system = System::new(mass, (solid, load)).map_err(StudyError::at("the system"))?;
        let size = 1.0 / cells as f64;
        let stretches = hung.windows(2).map(|ends| (ends[1] - ends[0]) / size);
        let speed = |s: f64| (self.stiffness * (3.0 * s * s - 1.0) / 2.0).sqrt();
        let predicted: f64 = stretches.map(|s| size / speed(s)).sum();
        let stretch = (hung[1] - hung[0]) / size;
        let step = 0.4 * size / speed(stretch);
        let mut method = StormerVerlet::new(&system).map_err(StudyError::at("Stormer-Verlet"))?;
        let rest = hung[cells];
        let mut state = State::new(hung, Covector(vec![0.0; cells + 1]));
        let mut fall = Fall { top: vec![], bottom: vec![], stretch, predicted, measured: f64::NAN };
        let steps = (1.4 * predicted / step) as usize;
        for k in 0..=steps {
            let t = k as f64 * step;
            if k % (steps / 100).max(1) == 0 {
                fall.top.push((t, -state.q[0]));
                fall.bottom.push((t, -state.q[cells]));
            }
            if fall.measured.is_nan() && (state.q[cells] - rest).abs() > STARTED {
                fall.measured = t;
            }
            method.step(&mut state, step).map_err(StudyError::at("a step"))?;
        }
        Ok(fall)
    }
}

fn study(size: Size) -> Result<Study, StudyError> {
    let cells = match size {
        Size::Default => 1000,
        Size::Full => 4000,
    };
    let mut table = Table::new([
        Column::exact("band"),
        Column::rounded("stretch at the top", 3, 0.0),
        Column::rounded("predicted [s]", 4, 0.0),
        Column::rounded("measured [s]", 3, 0.0),
    ]);
    let axes = |name: &str| {
        Lines::new(name, Axis::linear("time", "s"), Axis::linear("height above the hand", "m"))
    };
    let (mut charts, mut claims) = (Vec::new(), Vec::new());
    for (name, stiffness) in [("Rubber band", 20.0), ("Slinky", 1.0)] {
        let fall = Band::new(stiffness, cells)?.fall()?;
        table.push([name.into(), fall.stretch.into(), fall.predicted.into(), fall.measured.into()]);
        claims.push(Claim::number(
            format!("{name}: the lower end starts, over the time that the wave takes"),
            "1",
            fall.measured / fall.predicted,
            (0.97, 1.03),
        ));
        let chart = axes(name)
            .with(Series::new("upper end", fall.top))
            .with(Series::new("lower end", fall.bottom));
        charts.push(chart.into());
    }
    Ok(Study {
        conclusion: "A band hangs from a hand and is let go. The upper end falls at once; the lower one \
                     does not know yet, and hovers until a wave has run down the band. At a stretch s \
                     the wave runs at sqrt(c2 (3 s^2 - 1)/(2 rho)) per rest length, and the band's own sag \
                     says how long that takes; with half of c2, as the notes print it, it would take \
                     1.4 times as long. The lower end counts as started when it has fallen a tenth of a \
                     millimetre. On a line nothing stops the slinky's upper end from falling through \
                     the lower one: its coils would."
            .into(),
        table,
        charts,
        claims,
        ..STUDY.heading()
    })
}
