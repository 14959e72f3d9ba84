//! What is left of the force where a body comes to rest, and what is said of it.

use stationary_calculus::{Covector, Potential};
use stationary_elasticity::{
    DeadLoad, Freedoms, Held, Lame, LinearSegment, SaintVenantKirchhoff, Solid, Statics,
    lumped_mass,
};
use stationary_mesh::Mesh;

#[test]
fn a_corrected_rest_has_the_residual_that_is_told_and_it_is_rounding() {
    // A bar that hangs from one end, the other of which slides in a plane, under next to nothing: soft across.
    let ends = [[-1.2, -1.5, -0.8], [0.0, 0.5, 0.0]];
    let bar = Mesh::new(ends.map(Into::into).to_vec(), vec![[1, 0]]).unwrap();
    let hold = |(vertex, component): (usize, usize)| {
        let place = ends[vertex][component];
        Held { vertex, component, place }
    };
    let freedoms = Freedoms::<3>::new(2, &[(0, 0), (1, 0), (1, 1), (1, 2)].map(hold)).unwrap();
    let mass = lumped_mass(LinearSegment, &bar, [1.0, 1.0], &freedoms).unwrap();
    let steel = SaintVenantKirchhoff::new(Lame::<1>::new(0.0, 0.5).unwrap());
    for power in 16..40 {
        let weight = 2.0_f64.powi(-power);
        let load = DeadLoad::new(&freedoms, vec![[0.0, -0.37 * weight, -0.15 * weight], [0.0; 3]])
            .unwrap();
        let mut body = Solid::new(LinearSegment, &bar, 1.0, steel, freedoms.clone()).unwrap();
        let mut q = ends[0][1..].to_vec();
        let rest = Statics::default().solve(&mut body, &load, &mass, freedoms.places(), &mut q);
        let rest = rest.unwrap();
        let mut force = [0.0; 2];
        (&body, &load).add_differential(&q, Covector(&mut force[..]));
        let left = force[0].hypot(force[1]) / mass.masses()[0].sqrt();
        let told = rest.steps[0].newton.residual;
        assert!((told - left).abs() <= 1e-6 * left && left < 1e-15, "{power}: {told:e} {left:e}");
    }
}
