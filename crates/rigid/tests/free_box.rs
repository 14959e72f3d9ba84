//! probe
use nalgebra::Vector3;
use stationary_calculus::Metric;
use stationary_rigid::*;

#[test]
fn probe() {
    let body = Body::solid_box(1.0, [0.1, 0.2, 0.3]).unwrap();
    let system = BodyMetric::<Poses>::new(vec![body]).under(Free { freedoms: 6 }).unwrap();
    let motion = BodyMotion {
        pose: RigidMotion::identity(),
        velocity: Vector3::zeros(),
        angular_velocity: Vector3::new(1.0, 2.0, 3.0),
    };
    let initial = system.metric().state(&[motion]).unwrap();
    let e0 = system.metric().kinetic_energy(initial.p.view());
    let l0 = spatial_angular_momentum::<Poses>(&initial);
    for &method in BodyMethod::ALL {
        for h in [0.02, 0.01, 0.005, 0.0025] {
            let mut state = initial.clone();
            let mut integrator = method.integrator(&system).unwrap();
            let (mut e, mut l, mut its) = (0.0_f64, 0.0_f64, 0);
            let n = (5.0 / h) as usize;
            for _ in 0..n {
                let r = integrator.step(&mut state, h).unwrap();
                its = its.max(r.hessians);
                e = e.max((system.metric().kinetic_energy(state.p.view()) / e0 - 1.0).abs());
                l = l.max((spatial_angular_momentum::<Poses>(&state) - l0).norm() / l0.norm());
            }
            println!("{method} {h} energy {e:e} L {l:e} its {its}");
        }
        if method != BodyMethod::RenormalizedEuler {
            for steps in [1000] {
                let mut state = initial.clone();
                let mut integrator = method.integrator(&system).unwrap();
                let (mut e, mut l) = (0.0_f64, 0.0_f64);
                for _ in 0..steps {
                    integrator.step(&mut state, 0.01).unwrap();
                    e = e.max((system.metric().kinetic_energy(state.p.view()) / e0 - 1.0).abs());
                    l = l.max((spatial_angular_momentum::<Poses>(&state) - l0).norm() / l0.norm());
                }
                println!("{method} long {steps} energy {e:e} L {l:e}");
            }
        }
    }
}
