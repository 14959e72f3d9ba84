//! What acts on bodies that touch, as impulses over the steps of a world, and what moves among them as it is told.
//!
//! ```text
//! F_k = J_k/h,    W_k = <J_k, u>         u the mean of the velocities after impacts and at the step's end
//! W   = (<f, dx> + <f', dx>)/2           of a pin that moves by dx and pulls with f before, f' after
//! ```

use stationary_calculus::{Covector, Force, Vector};
use stationary_contact::{FlightForces, StageEnd, StepForces};
use stationary_integrators::State;

use crate::assemble::acting::{Acting, End, Impulses};
use crate::assemble::obstacles::Obstacles;
use crate::model::drives::MotorDrive;
use crate::model::scene::Scene;
use crate::model::strength::Strength;
use crate::run::error::StepFailure;

/// What acts on a scene, its impulses over a step, and its obstacles.
#[derive(Debug)]
pub(crate) struct Given {
    acting: Option<Acting>,
    obstacles: Obstacles,
    /// Of motors with a speed the speeds, of pins that move the places.
    speeds: Vec<Strength>,
    places: Vec<Strength>,
    impulses: Impulses,
    h: f64,
    /// The works of a flight.
    flown: Vec<f64>,
}

impl Given {
    pub(crate) fn of(scene: &Scene) -> Self {
        let motors = &scene.drives.motors;
        let speeds = motors.iter().filter(|motor| motor.drive == MotorDrive::Speed);
        Given {
            acting: Acting::of(scene),
            obstacles: Obstacles::of(scene),
            speeds: speeds.map(|motor| motor.strength.clone()).collect(),
            places: scene.drives.motions.iter().map(|motion| motion.strength.clone()).collect(),
            impulses: Impulses::default(),
            h: 0.0,
            flown: Vec::new(),
        }
    }

    /// The obstacles.
    pub(crate) fn obstacles(&self) -> &Obstacles {
        &self.obstacles
    }

    /// An error where dampers were not solved since this was asked last.
    pub(crate) fn check_solved(&mut self) -> Result<(), StepFailure> {
        StepFailure::of_dampers(self.acting.as_mut().and_then(Acting::take_unsolved))
    }
}

impl Force for Given {
    /// None where nothing acts; else those of the obstacles as well, on which nothing does.
    fn dim(&self) -> usize {
        match self.impulses.dim() {
            0 => 0,
            own => own + self.obstacles.freedoms(),
        }
    }

    fn add_force(&self, _: f64, _: &[f64], _: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        for &(freedom, impulse) in self.impulses.entries() {
            f.0[freedom] += impulse / self.h;
        }
    }

    fn works(&self) -> usize {
        self.acting.as_ref().map_or(0, |acting| acting.works().len())
    }
}

impl StepForces for Given {
    fn prepare(&mut self, state: &mut State<Vec<f64>>, h: f64) {
        self.obstacles.place(state, h);
        self.impulses.clear();
        self.h = h;
        if let Some(acting) = &mut self.acting {
            acting.give((state.t, h), &state.q, state.p.components(), &mut self.impulses);
        }
    }

    fn add_works(&self, ends: [&State<Vec<f64>>; 2], u: Vector<&[f64]>, works: &mut [f64]) {
        if let Some(acting) = &self.acting {
            acting.add_given_works(&self.impulses, ends, u.0, works);
        }
    }

    fn add_swings(&self, start: &State<Vec<f64>>, swings: &mut [f64]) {
        if let Some(acting) = &self.acting {
            acting.add_swings((start.t, self.h), &start.q, swings);
        }
        self.obstacles.add_swings((start.t, start.t + self.h), swings);
    }

    fn next_corner(&self, t: f64) -> Option<f64> {
        let told = self.speeds.iter().chain(&self.places).filter_map(|told| told.next_corner(t));
        let acting = self.acting.as_ref().and_then(|acting| acting.next_corner(t));
        told.chain(acting).min_by(f64::total_cmp)
    }

    fn jumps(&self, t: f64) -> bool {
        self.speeds.iter().any(|speed| speed.jump(t) != 0.0)
            || self.places.iter().any(|place| place.jump_of_rate(t) != 0.0)
    }
}

impl FlightForces for Given {
    fn kick(&mut self, end: StageEnd, stage: (f64, f64), state: &mut State<Vec<f64>>) {
        if end == StageEnd::Start {
            self.obstacles.place(state, stage.1);
        }
        let Some(acting) = &mut self.acting else { return };
        let State { q, p, .. } = state;
        let p = &mut p.components_mut()[..acting.freedoms()];
        match end {
            StageEnd::Start => acting.kick(End::Start, stage, q, p),
            StageEnd::Finish => {
                acting.kick(End::Finish, stage, q, p);
                self.flown.iter_mut().zip(acting.works()).for_each(|(sum, work)| *sum += work);
            }
        }
    }

    fn begin_flight(&mut self) {
        self.flown.clear();
        self.flown.resize(self.works(), 0.0);
    }

    fn add_flown_works(&self, works: &mut [f64]) {
        works.iter_mut().zip(&self.flown).for_each(|(sum, work)| *sum += work);
    }

    fn place(&self, state: &mut State<Vec<f64>>) {
        self.obstacles.place_now(state);
    }

    fn add_bounds(&self, between: (f64, f64), state: &State<Vec<f64>>, bounds: &mut [f64]) {
        if let Some(acting) = &self.acting {
            acting.add_bounds(between, (state.t, &state.q, state.p.components()), bounds);
        }
        self.obstacles.add_bounds(between, bounds);
    }
}
