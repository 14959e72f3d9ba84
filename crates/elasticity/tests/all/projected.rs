//! What a body whose Hessian is projected is told of the place where it comes to rest.

use stationary_calculus::{ConjugateGradient, Curvature, Rung, Stationary};
use stationary_elasticity::{
    DeadLoad, Elements, Freedoms, Lame, LinearTriangle, NeoHookean, Solid, Solves, Statics,
    lumped_mass,
};
use stationary_mesh::{Diagonals, rectangle};

/// A straight column of one metre, clamped at its foot, under a part of the load that buckles it.
fn pressed(part: f64, curvature: Curvature, solves: Solves) -> (Stationary, Rung) {
    let column = rectangle([1.0, 0.1], [10, 1], Diagonals::Crossed).unwrap();
    let places = column.nodes();
    let freedoms = Freedoms::held_where(&places, |x, _| x[0] == 0.0).unwrap();
    let pair = Lame::<2>::from_young_poisson(1.0, 0.3).unwrap();
    let metric = lumped_mass(LinearTriangle, &column, [1.0, 1.0], &freedoms).unwrap();
    let body =
        Solid::new(LinearTriangle, &column, 1.0, NeoHookean::new(pair).unwrap(), freedoms.clone());
    let mut body = body.unwrap().with_curvature(curvature);
    // Euler's load of a column that is free at its top, for a width of a tenth.
    let buckling = std::f64::consts::PI.powi(2) / 4.0 * 1e-3 / 12.0;
    let force = |x: &[f64; 2]| if x[0] == 1.0 { [-0.5 * part * buckling, 0.0] } else { [0.0; 2] };
    let load = DeadLoad::new(&freedoms, places.iter().map(force).collect()).unwrap();
    let mut q = freedoms.gathered(&places).unwrap();
    let statics = Statics { solves, ..Statics::default() };
    let rest = statics.solve(&mut body, &load, &metric, freedoms.places(), &mut q);
    let last = rest.unwrap().steps.pop().unwrap();
    (last.kind, last.rung)
}

#[test]
fn a_column_that_is_pressed_straight_is_told_to_be_on_a_saddle() {
    let iterate = Solves::Iterate(ConjugateGradient { tolerance: 1e-12, iterations: 1000 });
    let factor = Statics::default().solves;
    for solves in [factor, iterate] {
        for part in [2.0, 3.0] {
            let (kind, rung) = pressed(part, Curvature::Semidefinite, solves);
            let is_saddle = matches!(kind, Stationary::Saddle { curvature, .. } if curvature < 0.0);
            assert!(is_saddle && rung != Rung::Cholesky, "{part} {kind:?} {rung:?}");
        }
        let below = pressed(0.9, Curvature::Semidefinite, solves);
        assert_eq!(below, (Stationary::Minimum, Rung::Cholesky));
    }
    let led_off = pressed(3.0, Curvature::Exact, factor);
    assert_eq!(led_off, (Stationary::Minimum, Rung::Cholesky));
}
