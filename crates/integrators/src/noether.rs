//! Noether's theorem: a symmetry's momentum map is constant, and how far a system is from having it.
//!
//! ```text
//! q -> phi_s(q),   xi(q) = d/ds phi_s(q) at s = 0           a symmetry and its generator     (8.3)
//! J = <p, xi(q)>                                            its momentum map
//! J = <dL/dv, xi(q)>,   J = <-h d1 L_d, xi(q0)>             of a Lagrangian, continuous or discrete
//! dJ/dt = <dL/dq, xi> + <p, dxi v>                          zero where L is invariant
//! J1 - J0 = h <d1 L_d, xi(q0)> + h <d2 L_d, xi(q1)>         zero where L_d is invariant
//! ```
//! `q` configuration (n), `v` velocity vector (n), `p` momentum covector (n), `xi` a vector at q (n),
//! per unit of the symmetry's parameter: a metre, a radian; `J` in units of momentum times xi's.
//!
//! What a [`Symmetry`] gives is all that anyone needs who conserves a momentum: its generator, and
//! what it does to a velocity. On flat spaces that is `dxi v`, how the generator changes along v; where
//! velocities are told in axes that turn with q, it is the rate of their components. [`Asymmetry`] measures both sides of the theorem at one place:
//! the rate of J, and that rate relative to its terms, which is 1 where they do not cancel and
//! rounding where the symmetry holds. It is measured where it is asked for, not everywhere: ask at
//! more than one place.
//! Energy belongs to the symmetry in time, which a fixed step breaks (errata 8.3). Forces that no
//! potential gives are left out. Source: notes 8.3; errata 8.3 (d1 L phi' printed there is -J/h).

use stationary_calculus::{Covector, Metric, Potential, SizeError, Space, System, Vector};

use crate::{DiscreteLagrangian, Lagrangian};

/// A smooth family of maps of configurations, known by its infinitesimal generator.
pub trait Symmetry {
    /// Writes xi(q).
    fn generator(&self, q: &[f64], xi: Vector<&mut [f64]>);

    /// Writes `dxi(q) v`, the rate at which the symmetry changes a velocity's components: on flat
    /// spaces, how the generator changes as q moves along v.
    fn generator_along(&self, q: &[f64], v: Vector<&[f64]>, dxi: Vector<&mut [f64]>);

    /// The momentum map `<p, xi(q)>`. Takes memory, unless the symmetry knows better.
    fn momentum(&self, q: &[f64], p: Covector<&[f64]>) -> f64 {
        let mut xi = Vector(vec![0.0; p.0.len()]);
        self.generator(q, xi.view_mut());
        p.apply(&xi)
    }
}

impl<S: Symmetry + ?Sized> Symmetry for &S {
    fn generator(&self, q: &[f64], xi: Vector<&mut [f64]>) {
        S::generator(self, q, xi);
    }

    fn generator_along(&self, q: &[f64], v: Vector<&[f64]>, dxi: Vector<&mut [f64]>) {
        S::generator_along(self, q, v, dxi);
    }

    fn momentum(&self, q: &[f64], p: Covector<&[f64]>) -> f64 {
        S::momentum(self, q, p)
    }
}

/// The momentum map of a Lagrangian at a configuration and a velocity.
pub fn momentum_map<const N: usize>(
    lagrangian: &impl Lagrangian<N>,
    symmetry: &impl Symmetry,
    q: [f64; N],
    v: Vector<[f64; N]>,
) -> f64 {
    symmetry.momentum(&q, lagrangian.momentum(q, v).view())
}

/// The momentum map of a discrete Lagrangian over a step of `h` seconds from `q0` to `q1`.
pub fn discrete_momentum_map<const N: usize>(
    lagrangian: &impl DiscreteLagrangian<N>,
    symmetry: &impl Symmetry,
    [q0, q1]: [[f64; N]; 2],
    h: f64,
) -> f64 {
    symmetry.momentum(&q0, lagrangian.momentum_before(q0, q1, h).view())
}

/// How a momentum map changes where a symmetry does not hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Asymmetry {
    /// The rate of J at a moment, per second; over a step, its change.
    pub change: f64,
    /// The size that the change would have if nothing in it cancelled.
    pub scale: f64,
}

impl Asymmetry {
    /// Of a system at a configuration and a velocity: whether metric and potential are invariant.
    ///
    /// # Errors
    /// Where the configuration or the velocity has another size than the system.
    pub fn of_system<M: Metric, P: Potential, S: Space>(
        system: &System<M, P, S>,
        symmetry: &impl Symmetry,
        q: &[f64],
        v: Vector<&[f64]>,
    ) -> Result<Self, SizeError> {
        let n = system.dim();
        SizeError::check("the configuration's numbers", system.space().stored(n), q.len())?;
        SizeError::check("the velocity's components", n, v.0.len())?;
        let mut xi = Vector(vec![0.0; n]);
        let (mut force, mut p) = (Covector(xi.0.clone()), Covector(xi.0.clone()));
        system.potential().add_differential(q, force.view_mut());
        force.0.iter_mut().for_each(|f| *f = -*f);
        symmetry.generator(q, xi.view_mut());
        let potential = Asymmetry::of_products(force.view(), xi.view());
        system.metric().flat(v, p.view_mut());
        symmetry.generator_along(q, v, xi.view_mut());
        Ok(potential.and(Asymmetry::of_products(p.view(), xi.view())))
    }

    /// Of a Lagrangian at a configuration and a velocity.
    pub fn of_lagrangian<const N: usize>(
        lagrangian: &impl Lagrangian<N>,
        symmetry: &impl Symmetry,
        q: [f64; N],
        v: Vector<[f64; N]>,
    ) -> Self {
        let (mut xi, mut dxi) = (Vector([0.0; N]), Vector([0.0; N]));
        symmetry.generator(&q, xi.view_mut());
        symmetry.generator_along(&q, v.view(), dxi.view_mut());
        let place = Asymmetry::of_products(lagrangian.differential(q, v).view(), xi.view());
        place.and(Asymmetry::of_products(lagrangian.momentum(q, v).view(), dxi.view()))
    }

    /// Of a discrete Lagrangian over a step of `h` seconds from `q0` to `q1`, on the motion or off.
    pub fn of_step<const N: usize>(
        lagrangian: &impl DiscreteLagrangian<N>,
        symmetry: &impl Symmetry,
        [q0, q1]: [[f64; N]; 2],
        h: f64,
    ) -> Self {
        let generator = |q: [f64; N]| {
            let mut xi = Vector([0.0; N]);
            symmetry.generator(&q, xi.view_mut());
            xi
        };
        let before = lagrangian.momentum_before(q0, q1, h).0.map(|p| -p);
        let after = lagrangian.momentum_after(q0, q1, h);
        let lost = Asymmetry::of_products(Covector(before).view(), generator(q0).view());
        lost.and(Asymmetry::of_products(after.view(), generator(q1).view()))
    }

    /// The change relative to its scale: 0 where the symmetry holds, at most 1.
    pub fn relative(&self) -> f64 {
        if self.scale > 0.0 { self.change.abs() / self.scale } else { 0.0 }
    }

    fn of_products(covector: Covector<&[f64]>, vector: Vector<&[f64]>) -> Self {
        let products = || covector.0.iter().zip(vector.0).map(|(a, b)| a * b);
        Asymmetry { change: products().sum(), scale: products().map(f64::abs).sum() }
    }

    fn and(self, other: Self) -> Self {
        Asymmetry { change: self.change + other.change, scale: self.scale + other.scale }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::{DoublePendulum, three_bodies};
    use crate::{
        CentralGravity, Mechanical, Quadrature, Rotation, Sampled, Translation, UniformGravity,
    };
    use stationary_calculus::{DiagonalMetric, Energy, Number};

    const TURN: Rotation<2> = Rotation { axis: [0.0, 0.0, 1.0] };
    const SHIFT: Translation<2> = Translation { direction: [0.6, -0.8] };

    #[test]
    fn gravity_between_particles_has_translations_and_rotations() {
        let problem = three_bodies().unwrap();
        let v = Vector([0.3, -0.1, 0.0, 0.9, -0.1, -0.6]);
        let q = &problem.initial.q;
        let turned = Asymmetry::of_system(&problem.system, &TURN, q, v.view()).unwrap();
        let shifted = Asymmetry::of_system(&problem.system, &SHIFT, q, v.view()).unwrap();
        assert!(turned.scale > 0.0 && shifted.scale > 0.0);
        assert!(turned.relative() < 1e-15 && shifted.relative() < 1e-15);
    }

    #[test]
    fn a_symmetry_that_a_system_does_not_have_is_measured_as_the_torque_or_force_that_breaks_it() {
        let metric = DiagonalMetric::new([1.0; 2]).unwrap();
        let planet = System::new(metric, CentralGravity::<2> { strength: 2.0 }).unwrap();
        let (q, v) = ([0.3, -0.4], Vector([1.0, 0.5]));
        let asymmetry = Asymmetry::of_system(&planet, &SHIFT, &q, v.view()).unwrap();
        // The force -mu q/r^3 along the direction.
        let force = -2.0 * (q[0] * 0.6 + q[1] * -0.8) / 0.125;
        assert!((asymmetry.change - force).abs() < 1e-13 && asymmetry.relative() > 0.9);

        let metric = DiagonalMetric::new([3.0; 2]).unwrap();
        let stone = UniformGravity { acceleration: [0.0, -10.0], masses: vec![3.0] };
        let system = System::new(metric, stone).unwrap();
        let asymmetry = Asymmetry::of_system(&system, &TURN, &q, v.view()).unwrap();
        assert!((asymmetry.change - q[0] * -30.0).abs() < 1e-13, "the torque of its weight");
        assert!(asymmetry.relative() > 0.5);
    }

    #[test]
    fn a_particle_whose_mass_depends_on_the_direction_has_no_rotation() {
        // Errata 8.3: M must be a multiple of the identity for each particle.
        let v = Vector([1.0, 0.5]);
        for (mass, symmetric) in [([2.0, 2.0], true), ([1.0, 2.0], false)] {
            let metric = DiagonalMetric::new(mass).unwrap();
            let planet = System::new(metric, CentralGravity::<2> { strength: 1.0 }).unwrap();
            let off = Asymmetry::of_system(&planet, &TURN, &[0.3, -0.4], v.view()).unwrap();
            assert_eq!(off.relative() < 1e-15, symmetric, "{mass:?}: {off:?}");
        }
    }

    /// A planet about a sun at the origin, with a field along x of a given strength.
    #[derive(Debug)]
    struct Planet {
        field: f64,
    }

    impl Energy<2> for Planet {
        fn energy<R: Number>(&self, [x, y]: [R; 2]) -> R {
            -(x * x + y * y).sqrt().recip() + x * self.field
        }
    }

    #[test]
    fn a_discrete_lagrangian_inherits_the_symmetry_of_its_lagrangian() {
        let (path, h) = ([[0.3, -0.4], [0.5, 0.1]], 0.3);
        for quadrature in Quadrature::ALL {
            for (field, symmetric) in [(0.0, true), (1.0, false)] {
                let lagrangian = Mechanical::new([2.0; 2], Planet { field }).unwrap();
                let (q, v) = (path[0], Vector([0.4, 0.9]));
                let continuous = Asymmetry::of_lagrangian(&lagrangian, &TURN, q, v);
                let discrete = Sampled { lagrangian, quadrature };
                let step = Asymmetry::of_step(&discrete, &TURN, path, h);
                assert_eq!(continuous.relative() < 1e-15, symmetric, "{continuous:?}");
                assert_eq!(step.relative() < 1e-15, symmetric, "{quadrature:?}: {step:?}");
            }
        }
    }

    #[test]
    fn the_momentum_map_of_a_rotation_is_the_angular_momentum() {
        let lagrangian = Mechanical::new([2.0; 2], Planet { field: 0.0 }).unwrap();
        let (q, v) = ([0.3, -0.4], Vector([0.4, 0.9]));
        let expected = 2.0 * (q[0] * v.0[1] - q[1] * v.0[0]);
        assert!((momentum_map(&lagrangian, &TURN, q, v) - expected).abs() < 1e-15);
        // Of a step that starts here and ends where v leads, with V looked at in the end: M v x q.
        let discrete = Sampled { lagrangian, quadrature: Quadrature::End };
        let q1 = [q[0] + 0.1 * v.0[0], q[1] + 0.1 * v.0[1]];
        let measured = discrete_momentum_map(&discrete, &TURN, [q, q1], 0.1);
        assert!((measured - expected).abs() < 1e-14);
    }

    #[test]
    fn a_double_pendulum_turns_freely_without_its_weight_only() {
        // Both angles grow alike: J = dL/da' + dL/db'. The weight's torque is what changes it.
        let both = Translation::<1> { direction: [1.0] };
        let (q, v) = ([0.7, -0.2], Vector([0.4, 0.9]));
        let off = Asymmetry::of_lagrangian(&DoublePendulum, &both, q, v);
        let torque = -2.0 * q[0].sin() - q[1].sin();
        assert!((off.change - torque).abs() < 1e-15 && off.relative() > 0.1);
    }

    #[test]
    fn sizes_that_do_not_fit_are_refused() {
        let problem = three_bodies().unwrap();
        let v = Vector([0.0; 6]);
        assert!(Asymmetry::of_system(&problem.system, &TURN, &[0.0; 4], v.view()).is_err());
        let v = Vector([0.0; 4]);
        assert!(Asymmetry::of_system(&problem.system, &TURN, &[0.0; 6], v.view()).is_err());
    }
}
