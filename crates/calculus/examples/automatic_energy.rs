//! Energies written once; their differentials and Hessians follow, exact to rounding.
//!
//! `cargo run -p stationary-calculus --example automatic_energy`

use nalgebra::{Matrix2, dmatrix};
use stationary_calculus::{
    Automatic, AutomaticStencil, BilinearForm, Covector, Curvature, DenseSink, EigenError, Energy,
    Number, Potential, Stencil, StencilEnergy, assert_derivatives,
};

/// Two masses of 1 kg on two massless rods of 1 m, one below the other: angles from hanging.
struct DoublePendulum;

impl Energy<2> for DoublePendulum {
    fn energy<R: Number>(&self, [a, b]: [R; 2]) -> R {
        let first = -a.cos();
        let second = first - b.cos();
        (first + second) * 9.81
    }
}

/// A spring of stiffness 100 N/m and length 1 m between two points of the plane.
struct Spring;

impl StencilEnergy<2, 2> for Spring {
    fn vertices(&self) -> [usize; 2] {
        [0, 1]
    }

    fn energy<R: Number>(&self, [p, q]: [[R; 2]; 2]) -> R {
        let (x, y) = (q[0] - p[0], q[1] - p[1]);
        let stretch = (x * x + y * y).sqrt() - 1.0;
        stretch * stretch * 50.0
    }
}

fn main() -> Result<(), EigenError> {
    let pendulum = Automatic(DoublePendulum);
    let q = [0.3, -0.2];
    assert_derivatives(&pendulum, &q);
    let mut dv = Covector([0.0; 2]);
    pendulum.add_differential(&q, dv.view_mut());
    println!("A double pendulum at {q:?} rad");
    println!("  energy        {:.6} J", pendulum.energy(&q));
    println!("  differential  [{:.6}, {:.6}] J/rad", dv.0[0], dv.0[1]);

    let mut hessian = [0.0; 4];
    if let Some(mut sink) = DenseSink::new(1.0, 2, &mut hessian) {
        pendulum.add_hessian(&[0.0, 0.0], &mut sink);
    }
    let stiffness = BilinearForm(dmatrix![hessian[0], hessian[2]; hessian[1], hessian[3]]);
    let mass = BilinearForm(dmatrix![2.0, 1.0; 1.0, 1.0]);
    println!("Hanging, it swings at sqrt(g (2 -+ sqrt 2)) rad/s");
    let expected = [2.0 - 2_f64.sqrt(), 2.0 + 2_f64.sqrt()].map(|x| (9.81 * x).sqrt());
    for (lambda, expected) in stiffness.eigenpairs(&mass)?.values.iter().zip(expected) {
        println!("  {:.6} (expected {expected:.6})", lambda.sqrt());
    }

    let spring = AutomaticStencil(Spring);
    let x = [[0.0, 0.0], [0.5, 0.0]];
    println!("A spring squeezed to half its length: stiffness felt by one end, N/m");
    for curvature in [Curvature::Exact, Curvature::Semidefinite] {
        let h = spring.hessian(&x, curvature);
        let end = Matrix2::from_fn(|i, j| h[1][j][1][i]);
        println!("  {curvature:?}: along {:.1}, across {:.1}", end[(0, 0)], end[(1, 1)]);
    }
    Ok(())
}
