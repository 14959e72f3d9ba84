//! Accelerations at an instant where constraints change in time: drives however fast, and rates that change with place.

use nalgebra::Vector3;
use stationary_calculus::{Sink, SizeError};
use stationary_constraints::{Constraint, Rows};
use stationary_rigid::{Along, BodyForces, Drive, JointEnd, JointKind, Poses, Schedule, instant};

use crate::mechanisms::{bodies, joint};

/// A shift that swings at a rate, or turns back at 0.4 s at once.
#[derive(Clone, Copy, Debug)]
enum Shift {
    Swings(f64),
    TurnsBack,
}

impl Schedule for Shift {
    fn at<R: stationary_calculus::Number>(&self, t: R) -> R {
        match self {
            Shift::Swings(rate) => (t * *rate).sin() * 0.1,
            Shift::TurnsBack => ((t - 0.4) * (t - 0.4)).sqrt(),
        }
    }
}

#[test]
fn a_drive_has_the_acceleration_of_its_schedule_at_an_instant_however_fast_it_swings() {
    let system = bodies(1);
    let (t, ends) = (0.4, [JointEnd::world(Vector3::zeros()), JointEnd::on(0, Vector3::zeros())]);
    let slider = joint(1, JointKind::Slider { axis: Vector3::x() }, ends);
    let along = |schedule, x: f64, speed: f64| {
        let drive = Drive::new(Poses, 1, Along::Shift, Vector3::x(), ends, schedule).unwrap();
        let (q, v) = ([x, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], [speed, 0.0, 0.0, 0.0, 0.0, 0.0]);
        instant(&system, &(&slider, drive), &None::<BodyForces<Poses>>, (t, &q, &v))
    };
    for rate in [0.0, 1e-3, 1.0, 30.0, 1e3, 6e3, 1e5] {
        let (sine, cosine) = (rate * t).sin_cos();
        let found = along(Shift::Swings(rate), 0.1 * sine, 0.1 * rate * cosine).unwrap();
        let off = (found.accelerations[0] + 0.1 * rate * rate * sine).abs();
        assert!(off <= 1e-10 * rate * rate, "{rate}: {off:e}");
    }
    let error = along(Shift::TurnsBack, 0.0, 1.0).unwrap_err().to_string();
    assert!(error.contains("shifting drive") && error.contains("jumps at 0.4 s"), "{error}");
}

/// What keeps a body's centre on a plane through the third axis that turns at a rate.
#[derive(Debug)]
struct TurningPlane(f64);

impl TurningPlane {
    /// Its normal, and how that changes.
    fn normal(&self, t: f64) -> [[f64; 2]; 2] {
        let (sine, cosine) = (self.0 * t).sin_cos();
        [[-sine, cosine], [-cosine * self.0, -sine * self.0]]
    }
}

impl Constraint for TurningPlane {
    fn dim(&self) -> usize {
        6
    }

    fn count(&self) -> usize {
        1
    }

    fn value(&self, t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        let [[x, y], _] = self.normal(t);
        g[0] = x * q[0] + y * q[1];
        Ok(())
    }

    fn differential(&self, t: f64, _: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        let [normal, _] = self.normal(t);
        (0..2).for_each(|c| rows.add(0, c, normal[c]));
        Ok(())
    }

    fn add_hessian(
        &self,
        _: f64,
        _: &[f64],
        _: &[f64],
        _: &mut impl Sink,
    ) -> Result<(), SizeError> {
        Ok(())
    }

    fn rate(&self, t: f64, q: &[f64], rate: &mut [f64]) -> Result<(), SizeError> {
        let [_, [x, y]] = self.normal(t);
        rate[0] = x * q[0] + y * q[1];
        Ok(())
    }
}

#[test]
fn what_slides_outward_on_a_turning_plane_is_pushed_on_with_twice_its_speed_times_the_rate() {
    let (t, turn, outward, away) = (0.3_f64, 1.7, 0.8, 2.0);
    let (sine, cosine) = (turn * t).sin_cos();
    let (along, across) = ([cosine, sine, 0.0], [-sine, cosine, 0.0]);
    let q = [away * cosine, away * sine, 0.0, 1.0, 0.0, 0.0, 0.0];
    let mut v = [0.0; 6];
    (0..3).for_each(|c| v[c] = outward * along[c] + turn * away * across[c]);
    let (system, nothing) = (bodies(1), None::<BodyForces<Poses>>);
    let found = instant(&system, &TurningPlane(turn), &nothing, (t, &q, &v)).unwrap();
    for (found, across) in found.accelerations.iter().zip(across).take(2) {
        let off = found - 2.0 * outward * turn * across;
        assert!(off.abs() < 1e-10, "{off:e}");
    }
}
