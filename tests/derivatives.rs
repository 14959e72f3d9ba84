//! Every potential of the workspace against finite differences of itself, in one line each.

use stationary_calculus::{Stencils, assert_derivatives};
use stationary_elasticity::{Net, Spring, Strain, net};
use stationary_integrators::problems::{PendulumPotential, TetherPotential};
use stationary_integrators::{CentralGravity, NewtonianGravity, UniformGravity};

#[test]
fn gravity_in_all_its_forms() {
    let masses = vec![1.0, 0.3, 2.0];
    let q = [0.1, -0.2, 0.3, 1.1, 0.4, -0.6, -0.9, 1.2, 0.5];
    let acceleration = [0.0, 0.0, -9.81];
    assert_derivatives(&UniformGravity { acceleration, masses: masses.clone() }, &q);
    assert_derivatives(&NewtonianGravity::<3> { constant: 0.7, masses, fixed: Vec::new() }, &q);
    assert_derivatives(&CentralGravity::<2> { strength: 1.3 }, &[0.8, -0.5]);
    assert_derivatives(&CentralGravity::<3> { strength: 1.3 }, &[0.8, -0.5, 0.2]);
}

#[test]
fn springs_with_either_strain_stretched_and_compressed() {
    for strain in [Strain::Cauchy, Strain::Green] {
        for end in [0.4, 1.7] {
            let spring = Spring::new([0, 1], 1.0, 3.0, strain).unwrap();
            let pair = Stencils::<_, 2, 2>::new(2, Vec::new(), vec![spring]).unwrap();
            assert_derivatives(&pair, &[0.1, 0.2, end, 0.5]);
            let tether = Stencils::<_, 2, 3>::new(1, vec![[0.0; 3]], vec![spring]).unwrap();
            assert_derivatives(&tether, &[end, 0.3, -0.2]);
        }
    }
}

#[test]
fn a_net_of_hundreds_of_springs() {
    let size = Net { rows: 8, columns: 9, spacing: 0.1, stiffness: 40.0, strain: Strain::Cauchy };
    let net = Stencils::<_, 2, 3>::new(72, Vec::new(), net(size).unwrap()).unwrap();
    let q: Vec<f64> = (0..216)
        .map(|i| {
            let (row, column) = (i / 3 / 9, i / 3 % 9);
            let flat = [0.11 * column as f64, 0.1 * row as f64, 0.0][i % 3];
            flat + 0.01 * (i as f64 * 1.7).sin()
        })
        .collect();
    assert_derivatives(&net, &q);
}

#[test]
fn the_problems_of_the_integrators() {
    assert_derivatives(&PendulumPotential, &[2.0]);
    assert_derivatives(&TetherPotential { stiffness: 1e4 }, &[0.9, -0.3]);
}
