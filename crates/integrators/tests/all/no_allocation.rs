//! A step takes no memory: counted by an allocator.

use allocation_counter::measure;
use stationary_calculus::Covector;
use stationary_integrators::problems::DoublePendulum;
use stationary_integrators::{
    Drag, Integrator, Load, Quadrature, Sampled, State, Variational, bump,
};

#[test]
fn a_variational_step_takes_no_memory() {
    let load = Load { direction: Covector([1.0, 0.5]), strength: bump(0.0, 1.0).unwrap() };
    let forces = (Drag::new([0.1, 0.2]).unwrap(), load);
    let lagrangian = Sampled { lagrangian: DoublePendulum, quadrature: Quadrature::Middle };
    let mut integrator = Variational::forced(lagrangian, forces).unwrap();
    let mut state = State::new([0.9, -0.4], Covector([0.1, 0.0]));
    let used = measure(|| {
        for _ in 0..100 {
            integrator.step(&mut state, 0.01).unwrap();
        }
    });
    assert_eq!(used.count_total, 0);
}
