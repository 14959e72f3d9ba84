//! What a body's energy and force answer to the parameters of its material.

use stationary_calculus::{Covector, Potential, Vector};
use stationary_elasticity::{
    Fitted, Freedoms, Held, Lame, Linear, LinearTetrahedron, Material, NeoHookean,
    SaintVenantKirchhoff, Solid,
};
use stationary_measure::SplitMix64;

/// A body of some material, deformed, and a displacement.
fn deformed<M: Material<3, 3>>(material: M) -> (Solid<M, 4, 3, 3, 1>, [Vec<f64>; 2]) {
    let mesh = stationary_mesh::cuboid([1.0; 3], [2; 3]).unwrap();
    let held = [0, 1].map(|component| Held { vertex: 5, component, place: 0.3 });
    let freedoms = Freedoms::<3>::new(mesh.vertices().len(), &held).unwrap();
    let solid = Solid::new(LinearTetrahedron, &mesh, 1.0, material, freedoms).unwrap();
    let mut random = SplitMix64::new(7);
    let moved: Vec<[f64; 3]> = (mesh.vertices().iter())
        .map(|x| std::array::from_fn(|c| 1.1 * x[c] + 0.1 * random.symmetric()))
        .collect();
    let q = solid.freedoms().gathered(&moved).unwrap();
    let v = q.iter().map(|_| random.symmetric()).collect();
    (solid, [q, v])
}

/// Both derivatives by Lame's pair against differences of bodies of neighbouring pairs.
fn fits<M: Fitted<3, 3, 2>>(of_pair: impl Fn(f64, f64) -> M) {
    let pair = [3.0, 2.0];
    let at = |k: usize, h: f64| {
        let mut p = pair;
        p[k] += h;
        let (solid, [q, v]) = deformed(of_pair(p[0], p[1]));
        let mut dv = vec![0.0; q.len()];
        solid.add_differential(&q, Covector(&mut dv));
        (solid.energy(&q), Covector(dv).apply(&Vector(v)))
    };
    let (solid, [q, v]) = deformed(of_pair(pair[0], pair[1]));
    assert_eq!(solid.material().parameters(), pair);
    let energy: [f64; 2] = solid.energy_by_parameters(&q).unwrap();
    let along: [f64; 2] = solid.differential_by_parameters(&q, &v).unwrap();
    for k in 0..2 {
        // Every one of these energies is linear in its pair: any difference is exact.
        let (more, less) = (at(k, 0.5), at(k, -0.5));
        assert!((energy[k] / (more.0 - less.0) - 1.0).abs() < 1e-12);
        assert!((along[k] - (more.1 - less.1)).abs() < 1e-12 * along[k].abs().max(1.0));
    }
    let sum = energy[0] * pair[0] + energy[1] * pair[1];
    assert!((sum / solid.energy(&q) - 1.0).abs() < 1e-13);
    assert!(solid.energy_by_parameters::<2>(&q[1..]).is_err());
}

#[test]
fn energies_and_forces_answer_to_their_parameters_as_differences_say() {
    let lame = |lambda: f64, mu: f64| Lame::<3>::new(lambda, mu).unwrap();
    fits(|lambda, mu| SaintVenantKirchhoff::new(lame(lambda, mu)));
    fits(|lambda, mu| Linear::new(lame(lambda, mu)));
    fits(|lambda, mu| NeoHookean::new(lame(lambda, mu)).unwrap());
}
