//! A body in several parts is the same body, to the last bit, and takes no memory in a step.

use allocation_counter::measure;
use stationary_calculus::{
    Covector, Curvature, Force, Potential, ProductSink, SparseError, SymmetricMatrix, Vector,
};
use stationary_elasticity::{
    Elements, Freedoms, Held, Lame, LinearTetrahedron, Material, NeoHookean, QuadraticTriangle,
    Rayleigh, Reference, SaintVenantKirchhoff, Solid, lumped_mass,
};
use stationary_mesh::{Mesh, QuadraticTriangles, cuboid, disc};

fn lame() -> Lame<3> {
    Lame::from_young_poisson(1e3, 0.3).unwrap()
}

/// A bar whose end is held, and one more vertex in part, bent.
fn bent_bar(cells: [usize; 3]) -> (Mesh<3, 4>, Freedoms<3>, Vec<f64>) {
    let mesh = cuboid([4.0, 1.0, 1.0], cells).unwrap();
    let end = (0..mesh.count()).filter(|&v| mesh.vertices()[v].x == 0.0);
    let mut held: Vec<(usize, usize)> = end.flat_map(|v| (0..3).map(move |c| (v, c))).collect();
    // One vertex amid the others slides.
    let middle = mesh.count() / 2 + 1;
    assert!(mesh.vertices()[middle].x > 0.0);
    held.push((middle, 1));
    let place = |&(vertex, component): &(usize, usize)| Held {
        vertex,
        component,
        place: mesh.vertices()[vertex][component],
    };
    let held: Vec<Held> = held.iter().map(place).collect();
    let freedoms = Freedoms::new(mesh.count(), &held).unwrap();
    let bent: Vec<[f64; 3]> = mesh
        .vertices()
        .iter()
        .map(|x| {
            [0.9 * x.x + 0.02 * (3.0 * x.y).sin(), x.y + 0.1 * x.x.sin(), x.z + 0.03 * x.x * x.y]
        })
        .collect();
    let q = freedoms.gathered(&bent).unwrap();
    (mesh, freedoms, q)
}

/// Energy, differential, Hessian and its product with a vector.
fn all_of(body: &impl Potential, q: &[f64]) -> (f64, Vec<f64>, Vec<f64>, Vec<f64>) {
    let n = q.len();
    let mut dv = vec![0.0; n];
    body.add_differential(q, Covector(&mut dv));
    let matrix = SymmetricMatrix::hessian(body, q).unwrap();
    let (x, mut y) = ((0..n).map(|i| (i as f64).sin()).collect::<Vec<_>>(), vec![0.0; n]);
    body.add_hessian(q, &mut ProductSink::new(1.0, &x, &mut y).unwrap());
    (body.energy(q), dv, matrix.values().to_vec(), y)
}

fn assert_same_bits<M, const N: usize, const D: usize, const Q: usize>(
    body: Solid<M, N, D, D, Q>,
    q: &[f64],
) where
    M: Material<D, D>,
{
    let body = body.with_curvature(Curvature::Semidefinite);
    let alone = all_of(&body, q);
    assert!(alone.0 > 0.0 && alone.2.iter().all(|entry| entry.is_finite()));
    for parts in [2, 3, 4, 7, 64] {
        assert!(all_of(&body.clone().in_parts(parts), q) == alone, "{parts} parts");
    }
}

#[test]
fn any_number_of_parts_gives_the_same_bits() {
    let (mesh, freedoms, q) = bent_bar([20, 5, 5]);
    let rubber = SaintVenantKirchhoff::new(lame());
    let body = |freedoms| Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms).unwrap();
    assert_same_bits(body(freedoms), &q);
    let round = QuadraticTriangles::straight(&disc(1.0, 6).unwrap());
    let free = Freedoms::<2>::free(round.count()).unwrap();
    let soft = NeoHookean::new(lame().plane_strain()).unwrap();
    let q: Vec<f64> = round.nodes().iter().flat_map(|x| [0.8 * x[0], x[1] + 0.2 * x[0]]).collect();
    assert_same_bits(Solid::new(QuadraticTriangle, &round, 1.0, soft, free).unwrap(), &q);
}

#[test]
fn one_thread_or_several_give_the_same_bits() {
    let (mesh, freedoms, q) = bent_bar([20, 5, 5]);
    let rubber = SaintVenantKirchhoff::new(lame());
    let body = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms).unwrap().in_parts(5);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| all_of(&body, &q))
    };
    assert!(on(1) == on(3));
}

#[test]
fn a_matrix_of_other_parts_is_refused_and_a_scaled_one_is_filled() {
    let (mesh, freedoms, q) = bent_bar([8, 3, 3]);
    let rubber = SaintVenantKirchhoff::new(lame());
    let metric = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
    let body = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms).unwrap();
    let halves = body.clone().in_parts(2);
    let mut matrix = SymmetricMatrix::hessian(&halves, &q).unwrap();
    let thirds = body.clone().in_parts(3);
    let error = matrix.refill(|sink| thirds.add_hessian(&q, sink)).unwrap_err();
    assert_eq!(error, SparseError::PatternChanged { block: 0 });
    // Rayleigh's damping passes a multiple of the same blocks on.
    let v = vec![0.0; q.len()];
    for body in [body, halves] {
        let damping = Rayleigh::new([0.0, 0.25], metric.clone(), &body).unwrap();
        let direct = SymmetricMatrix::hessian(&body, &q).unwrap();
        let mut matrix = SymmetricMatrix::analyse(q.len(), |sink| {
            damping.add_damping(0.0, &q, Vector(&v), sink);
        })
        .unwrap();
        matrix.refill(|sink| damping.add_damping(0.0, &q, Vector(&v), sink)).unwrap();
        assert!(matrix.values().iter().zip(direct.values()).all(|(a, b)| *a == 0.25 * b));
    }
}

#[test]
fn the_hessians_places_take_less_than_a_third_of_what_it_takes_itself() {
    let (mesh, _, _) = bent_bar([20, 10, 10]);
    let freedoms = Freedoms::<3>::free(mesh.count()).unwrap();
    let q = freedoms.gathered(&mesh.nodes()).unwrap();
    let rubber = SaintVenantKirchhoff::new(lame());
    let body = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms).unwrap();
    for body in [body.clone(), body.in_parts(2)] {
        let matrix = SymmetricMatrix::hessian(&body, &q).unwrap();
        let entries = matrix.rows().len() * (size_of::<f64>() + size_of::<u32>());
        let itself = entries + size_of_val(matrix.column_starts());
        let ratio = matrix.bytes() as f64 / itself as f64;
        assert!(1.2 < ratio && ratio < 1.3, "{ratio}");
    }
}

#[test]
fn a_step_takes_no_memory() {
    fn check<F, const N: usize>(family: F, mesh: &impl Elements<3, N>, freedoms: Freedoms<3>)
    where
        F: Reference<N, 3, 1>,
    {
        let q = freedoms.gathered(&mesh.nodes()).unwrap();
        let rubber = SaintVenantKirchhoff::new(lame());
        let body = Solid::new(family, mesh, 1.0, rubber, freedoms).unwrap();
        let mut dv = vec![0.0; q.len()];
        for parts in [1, 2] {
            let body = body.clone().in_parts(parts);
            let mut matrix = SymmetricMatrix::hessian(&body, &q).unwrap();
            // Inside the pool: what enters from outside queues up, and a queue takes memory.
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            let counted = pool.install(|| {
                measure(|| {
                    std::hint::black_box(body.energy(&q));
                    body.add_differential(&q, Covector(&mut dv));
                    matrix.refill(|sink| body.add_hessian(&q, sink)).unwrap();
                })
            });
            assert_eq!(counted.count_total, 0, "{parts} parts");
        }
    }
    let (mesh, freedoms, _) = bent_bar([30, 6, 6]);
    check(LinearTetrahedron, &mesh, freedoms);
}
