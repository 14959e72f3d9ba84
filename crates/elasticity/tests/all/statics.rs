//! Where loaded bodies come to rest, and what is refused.

use nalgebra::Vector3;
use stationary_calculus::{
    ConjugateGradient, Curvature, DiagonalMetric, Newton, NewtonFailure, Ordering, Unsolvable,
    assert_derivatives,
};
use stationary_elasticity::problems::{Beam, SheetFamily};
use stationary_elasticity::{
    AtRest, DeadLoad, ElasticityError, Elements, Freedoms, Held, Lame, Linear, LinearTetrahedron,
    LinearTriangle, Material, NeoHookean, SaintVenantKirchhoff, Solid, Solves, Statics,
    averaged_stress, lumped_mass,
};
use stationary_mesh::{Diagonals, Mesh, cuboid, rectangle};

fn lame() -> Lame<3> {
    Lame::from_young_poisson(2e4, 0.3).unwrap()
}

/// A bar of cells along x, its left end held, with the boundary of its right end.
struct Clamped {
    mesh: Mesh<3, 4>,
    freedoms: Freedoms<3>,
}

fn clamped(cells: usize) -> Clamped {
    let mesh = cuboid([2.0, 1.0, 1.0], [2 * cells, cells, cells]).unwrap();
    let held: Vec<Held> = (0..mesh.count())
        .filter(|&vertex| mesh.vertices()[vertex].x == 0.0)
        .flat_map(|vertex| {
            let x = mesh.vertices()[vertex];
            // Free to thin, but neither to shift nor to turn.
            let all = [true, x.y == 0.0, x.z == 0.0];
            (0..3).filter(move |&c| all[c]).map(move |component| Held {
                vertex,
                component,
                place: x[component],
            })
        })
        .collect();
    let freedoms = Freedoms::new(mesh.count(), &held).unwrap();
    Clamped { mesh, freedoms }
}

fn end_face(mesh: &Mesh<3, 4>) -> Mesh<3, 3> {
    let facets = mesh.boundary_facets();
    let at_end = |facet: &[usize; 3]| facet.iter().all(|&v| mesh.vertices()[v].x == 2.0);
    Mesh::new(mesh.vertices().to_vec(), facets.into_iter().filter(at_end).collect()).unwrap()
}

#[test]
fn a_pulled_bar_stretches_uniformly_and_its_support_pulls_back() {
    let Clamped { mesh, freedoms } = clamped(2);
    let pull = 3e3;
    let load = DeadLoad::traction(LinearTriangle, &end_face(&mesh), 1.0, &freedoms, |_, n| {
        assert_eq!(*n, [1.0, 0.0, 0.0]);
        n.map(|n| pull * n)
    })
    .unwrap();
    let metric = lumped_mass(LinearTetrahedron, &mesh, [1e3, 1.0], &freedoms).unwrap();
    let rubber = SaintVenantKirchhoff::new(lame());
    let mut solid = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
    let mut q = freedoms.gathered(&mesh.nodes()).unwrap();
    let statics = Statics { steps: 3, ..Statics::default() };
    let places = freedoms.places().to_vec();
    let rest = statics.solve(&mut solid, &load, &metric, &places, &mut q).unwrap();
    let positions = freedoms.positions(&q).unwrap();
    // Uniaxial: E s (s^2 - 1)/2 = pull per area at rest.
    let stretch = positions.iter().map(|x| x[0]).fold(0.0, f64::max) / 2.0;
    let force = 2e4 * stretch * 0.5 * (stretch * stretch - 1.0);
    assert!((force / pull - 1.0).abs() < 1e-12, "{stretch}");
    let thinned = positions.iter().map(|x| x[1]).fold(0.0, f64::max);
    let expected = (1.0 - 0.3 * (stretch * stretch - 1.0)).sqrt();
    assert!((thinned - expected).abs() < 1e-12);
    let along: f64 = freedoms
        .held()
        .iter()
        .zip(&rest.reactions)
        .filter(|((_, component), _)| *component == 0)
        .map(|(_, force)| force)
        .sum();
    assert!((along + pull).abs() < 1e-8, "{along}");
    // Stress: the pull over the area that is left.
    let stress = averaged_stress(LinearTetrahedron, &mesh, &rubber, &positions).unwrap();
    for sigma in stress {
        assert!((sigma[0][0] * thinned * thinned / pull - 1.0).abs() < 1e-11);
        assert!(sigma[1][1].abs() < 1e-8 && sigma[0][1].abs() < 1e-8);
    }
    assert!(rest.iterations() < 20 && rest.steps.len() == 3);
}

#[test]
fn supports_that_move_carry_the_body_along() {
    let Clamped { mesh, freedoms } = clamped(1);
    let metric = lumped_mass(LinearTetrahedron, &mesh, [1e3, 1.0], &freedoms).unwrap();
    let rubber = NeoHookean::new(lame()).unwrap();
    let mut solid = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
    let none = DeadLoad::new(&freedoms, vec![[0.0; 3]; mesh.count()]).unwrap();
    let mut q = freedoms.gathered(&mesh.nodes()).unwrap();
    let moved: Vec<f64> = freedoms.places().iter().map(|place| place + 0.25).collect();
    let statics = Statics { steps: 2, ..Statics::default() };
    let rest = statics.solve(&mut solid, &none, &metric, &moved, &mut q).unwrap();
    for (x, rest) in solid.freedoms().positions(&q).unwrap().iter().zip(mesh.nodes()) {
        assert!((0..3).all(|c| (x[c] - rest[c] - 0.25).abs() < 1e-12));
    }
    assert!(rest.reactions.iter().all(|f| f.abs() < 1e-8));
}

#[test]
fn a_weight_is_borne_by_the_supports() {
    let Clamped { mesh, freedoms } = clamped(2);
    let metric = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
    let mut solid =
        Solid::new(LinearTetrahedron, &mesh, 1.0, Linear::new(lame()), freedoms.clone()).unwrap();
    let weight =
        DeadLoad::body(LinearTetrahedron, &mesh, 1.0, &freedoms, |_| [0.0, 0.0, -9.81]).unwrap();
    let mut q = freedoms.gathered(&mesh.nodes()).unwrap();
    let before = q.clone();
    let places = freedoms.places().to_vec();
    let rest = Statics::default().solve(&mut solid, &weight, &metric, &places, &mut q).unwrap();
    let up: f64 = freedoms
        .held()
        .iter()
        .zip(&rest.reactions)
        .filter(|((_, c), _)| *c == 2)
        .map(|(_, f)| f)
        .sum();
    assert!((up - 2.0 * 9.81).abs() < 1e-9, "{up}");
    assert_ne!(q, before);
    let double = weight.plus(&weight).unwrap();
    assert_eq!(double, weight.scaled(2.0).unwrap());
    assert_derivatives(&(&solid, &weight), &q);
}

#[test]
fn bodies_that_may_move_as_a_whole_are_refused_by_name() {
    let mesh = cuboid([1.0, 1.0, 1.0], [1, 1, 1]).unwrap();
    let hold = |held: &[(usize, usize)]| {
        let held: Vec<Held> = held
            .iter()
            .map(|&(vertex, component)| Held {
                vertex,
                component,
                place: mesh.vertices()[vertex][component],
            })
            .collect();
        let freedoms = Freedoms::<3>::new(mesh.count(), &held).unwrap();
        let metric = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
        let rubber = SaintVenantKirchhoff::new(lame());
        let mut solid =
            Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
        let none = DeadLoad::new(&freedoms, vec![[0.0; 3]; mesh.count()]).unwrap();
        let mut q = freedoms.gathered(&mesh.nodes()).unwrap();
        let places = freedoms.places().to_vec();
        Statics::default().solve(&mut solid, &none, &metric, &places, &mut q).unwrap_err()
    };
    let ElasticityError::RigidMotions { count, names, .. } = hold(&[]) else { panic!() };
    assert_eq!((count, names.split(", ").count()), (6, 6));
    let corner = (0..8).find(|&v| mesh.vertices()[v] == Vector3::zeros()).unwrap();
    let along = (0..8).find(|&v| mesh.vertices()[v] == Vector3::x()).unwrap();
    let pinned = [(corner, 0), (corner, 1), (corner, 2), (along, 1), (along, 2)];
    let error = hold(&pinned);
    // It still turns about the edge along x, which is no axis through the middle.
    assert_eq!(error.to_string(), "1 rigid motions are free: others that are not along an axis");
    let floor: Vec<(usize, usize)> =
        (0..8).filter(|&v| mesh.vertices()[v].z == 0.0).map(|v| (v, 2)).collect();
    let error = hold(&floor).to_string();
    assert_eq!(error, "3 rigid motions are free: translation x, translation y, rotation about z");
}

#[test]
fn a_load_without_an_equilibrium_is_an_error_that_changes_nothing() {
    let Clamped { mesh, freedoms } = clamped(1);
    let metric = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
    let rubber = SaintVenantKirchhoff::new(lame());
    let mut solid = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
    let load =
        DeadLoad::body(LinearTetrahedron, &mesh, 1.0, &freedoms, |_| [1e9, 0.0, 0.0]).unwrap();
    let mut q = freedoms.gathered(&mesh.nodes()).unwrap();
    let (before, places) = (q.clone(), freedoms.places().to_vec());
    let moved: Vec<f64> = places.iter().map(|p| p + 1.0).collect();
    let newton = Newton { iterations: 2, tolerance: 0.0 };
    let hasty = Statics { newton, ..Statics::default() };
    let error = hasty.solve(&mut solid, &load, &metric, &moved, &mut q).unwrap_err();
    assert!(matches!(error, ElasticityError::Statics { step: 1, steps: 1, .. }), "{error}");
    assert_eq!((q, solid.freedoms().places().to_vec()), (before, places.clone()));
    let none = Statics { steps: 0, ..hasty };
    let mut q = freedoms.gathered(&mesh.nodes()).unwrap();
    let error = none.solve(&mut solid, &load, &metric, &places, &mut q).unwrap_err();
    assert_eq!(error, ElasticityError::NoSteps);
}

#[test]
fn every_piece_of_a_body_needs_its_own_supports() {
    let one = cuboid([1.0; 3], [1; 3]).unwrap();
    let apart: Vec<_> = one.vertices().iter().map(|x| x + Vector3::x() * 3.0).collect();
    let vertices = [one.vertices(), &apart].concat();
    let second = one.simplices().iter().map(|nodes| nodes.map(|node| node + 8));
    let both = one.simplices().iter().copied().chain(second).collect();
    let mesh = Mesh::new(vertices, both).unwrap();
    let clamp = |vertices: std::ops::Range<usize>, components: usize| -> Vec<Held> {
        let all = vertices.flat_map(|v| (0..components).map(move |c| (v, c)));
        let place =
            |(v, c): (usize, usize)| Held { vertex: v, component: c, place: mesh.vertices()[v][c] };
        all.map(place).collect()
    };
    let solve = |held: &[Held]| {
        let freedoms = Freedoms::<3>::new(mesh.count(), held).unwrap();
        let metric = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
        let rubber = SaintVenantKirchhoff::new(lame());
        let mut solid =
            Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
        let none = DeadLoad::new(&freedoms, vec![[0.0; 3]; mesh.count()]).unwrap();
        let (mut q, places) = (freedoms.gathered(&mesh.nodes()).unwrap(), freedoms.places());
        Statics::default().solve(&mut solid, &none, &metric, places, &mut q)
    };
    // One piece held twice over does nothing for the other.
    let error = solve(&clamp(0..8, 3)).unwrap_err().to_string();
    assert!(error.starts_with("6 rigid motions are free: translation x, "), "{error}");
    assert!(error.ends_with("; piece 2 of 2, that of vertex 8"), "{error}");
    let error = solve(&[clamp(0..4, 3), clamp(8..16, 1)].concat()).unwrap_err().to_string();
    let names = "3 rigid motions are free: translation y, translation z, rotation about x";
    assert_eq!(error, format!("{names}; piece 2 of 2, that of vertex 8"));
    solve(&[clamp(0..4, 3), clamp(8..12, 3)].concat()).unwrap();
}

#[test]
fn iteration_brings_a_body_to_rest_where_the_factor_does() {
    let Clamped { mesh, freedoms } = clamped(3);
    let metric = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
    let rubber = NeoHookean::new(lame()).unwrap();
    let load =
        DeadLoad::body(LinearTetrahedron, &mesh, 1.0, &freedoms, |_| [0.0, 0.0, -150.0]).unwrap();
    let method = ConjugateGradient { tolerance: 1e-10, iterations: 2000 };
    let orders = [Ordering::MinimumDegree, Ordering::NestedDissection].map(Solves::Factor);
    let rests = [orders[0], orders[1], Solves::Iterate(method)].map(|solves| {
        let body = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
        let mut body = body.with_curvature(Curvature::Semidefinite);
        let (mut q, places) = (freedoms.gathered(&mesh.nodes()).unwrap(), freedoms.places());
        let statics = Statics { solves, ..Statics::default() };
        let rest = statics.solve(&mut body, &load, &metric, places, &mut q).unwrap();
        assert!(rest.iterations() < 25, "{}", rest.iterations());
        q
    });
    let still = freedoms.gathered(&mesh.nodes()).unwrap();
    assert!(rests[0].iter().zip(&still).any(|(a, b)| (a - b).abs() > 0.1), "it moves");
    for (a, b) in rests[0].iter().zip(&rests[2]).chain(rests[0].iter().zip(&rests[1])) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
}

/// A block of one cell with these vertices held, under equal forces at all its vertices.
fn block_under(
    held: impl Fn(Vector3<f64>) -> bool,
    force: [f64; 3],
) -> Result<(Vec<[f64; 3]>, AtRest, Freedoms<3>), ElasticityError> {
    let mesh = cuboid([1.0, 1.0, 1.0], [1, 1, 1]).unwrap();
    let places: Vec<[f64; 3]> = mesh.nodes();
    let freedoms = Freedoms::held_where(&places, |&x, _| held(x.into())).unwrap();
    let metric = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
    let rubber = SaintVenantKirchhoff::new(lame());
    let mut solid = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
    let load = DeadLoad::new(&freedoms, vec![force; 8]).unwrap();
    let mut q = freedoms.gathered(&places).unwrap();
    let rest = Statics::default().solve(&mut solid, &load, &metric, freedoms.places(), &mut q)?;
    Ok((freedoms.positions(&q).unwrap(), rest, freedoms))
}

#[test]
fn a_block_on_a_hinge_hangs_below_it() {
    let on_hinge = |x: Vector3<f64>| x.x == 0.0 && x.z == 0.0;
    let (positions, rest, freedoms) = block_under(on_hinge, [0.0, 0.0, -1.0]).unwrap();
    let middle = |c: usize| positions.iter().map(|x| x[c]).sum::<f64>() / 8.0;
    // The moment about the hinge is that of the weight alone: its middle hangs below.
    assert!(middle(0).abs() < 1e-12 && middle(2) < -0.7, "{} {}", middle(0), middle(2));
    let up: f64 = freedoms
        .held()
        .iter()
        .zip(&rest.reactions)
        .filter_map(|((_, c), f)| (*c == 2).then_some(f))
        .sum();
    assert!((up - 8.0).abs() < 1e-9, "{up}");
}

#[test]
fn a_turn_that_the_load_does_not_resist_is_refused() {
    let on_hinge = |x: Vector3<f64>| x.x == 0.0 && x.z == 0.0;
    for (held, force) in [
        // No load, one along the hinge, and a body on one point that turns below it.
        (&on_hinge as &dyn Fn(Vector3<f64>) -> bool, [0.0; 3]),
        (&on_hinge, [0.0, 1.0, 0.0]),
        (&|x: Vector3<f64>| x == Vector3::zeros(), [0.0, 0.0, -1.0]),
    ] {
        let error = block_under(held, force).unwrap_err();
        assert!(matches!(error, ElasticityError::RigidMotions { .. }), "{error}");
    }
}

/// A cloth of a metre in the x-y plane, held where told, under its weight along z.
fn cloth(held: impl Fn(&[f64; 3]) -> bool) -> (Vec<[f64; 3]>, f64) {
    let flat = rectangle([1.0, 1.0], [4, 4], Diagonals::Alternating).unwrap();
    let bump = |x: f64, y: f64| 0.01 * (5.0 * x).sin() * y;
    let places = flat.vertices().iter().map(|x| Vector3::new(x.x, x.y, bump(x.x, x.y)));
    let mesh = Mesh::new(places.collect(), flat.simplices().to_vec()).unwrap();
    let nodes: Vec<[f64; 3]> = mesh.nodes();
    let freedoms = Freedoms::held_where(&nodes, |x, _| held(x)).unwrap();
    let metric = lumped_mass(LinearTriangle, &mesh, [1.0, 1e-3], &freedoms).unwrap();
    let linen =
        SaintVenantKirchhoff::new(Lame::<3>::from_young_poisson(1e6, 0.3).unwrap().plane_stress());
    let mut solid: Solid<_, 3, 3, 2, 1> =
        Solid::new(LinearTriangle, &mesh, 1e-3, linen, freedoms.clone()).unwrap();
    let load = DeadLoad::new(&freedoms, vec![[0.0, 0.0, -0.2]; nodes.len()]).unwrap();
    let mut q = freedoms.gathered(&nodes).unwrap();
    let statics = Statics::default();
    let rest = statics.solve(&mut solid, &load, &metric, freedoms.places(), &mut q).unwrap();
    let up = freedoms.held().iter().zip(&rest.reactions).filter(|((_, c), _)| *c == 2);
    (freedoms.positions(&q).unwrap(), up.map(|(_, f)| f).sum())
}

#[test]
fn a_flag_on_an_edge_and_a_cloth_on_two_pins_come_to_rest() {
    let corners = |x: &[f64; 3]| x[1] == 0.0 && (x[0] == 0.0 || x[0] == 1.0);
    for (positions, up) in [cloth(|x| x[1] == 0.0), cloth(corners)] {
        assert!((up - 25.0 * 0.2).abs() < 1e-6, "{up}");
        let lowest = positions.iter().map(|x| x[2]).fold(0.0, f64::min);
        assert!((-1.2..-0.9).contains(&lowest), "{lowest}");
    }
}

#[test]
fn a_rest_with_elements_inside_out_is_refused_and_told_of_the_linear_law() {
    fn pushed<M: Material<3, 3>>(law: M) -> Result<AtRest, ElasticityError> {
        let Clamped { mesh, .. } = clamped(1);
        let ends = |x: &[f64; 3]| x[0] == 0.0 || x[0] == 2.0;
        let freedoms = Freedoms::held_where(&mesh.nodes(), |x, _| ends(x)).unwrap();
        let metric = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
        let mut solid = Solid::new(LinearTetrahedron, &mesh, 1.0, law, freedoms.clone()).unwrap();
        let none = DeadLoad::new(&freedoms, vec![[0.0; 3]; mesh.count()]).unwrap();
        let mut q = freedoms.gathered(&mesh.nodes()).unwrap();
        // The far face goes through the near one.
        let through = |((_, c), x): (&(usize, usize), &f64)| {
            if *c == 0 && *x == 2.0 { -0.5 } else { *x }
        };
        let places: Vec<f64> = freedoms.held().iter().zip(freedoms.places()).map(through).collect();
        Statics::default().solve(&mut solid, &none, &metric, &places, &mut q)
    }
    let error = pushed(SaintVenantKirchhoff::new(lame())).unwrap_err();
    assert!(matches!(error, ElasticityError::InsideOut(_)), "{error}");
    let linear = pushed(Linear::new(lame())).unwrap();
    assert!(!linear.inverted.is_empty());
}

#[test]
fn what_does_not_fit_the_body_is_refused() {
    let Clamped { mesh, freedoms } = clamped(1);
    let metric = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
    let rubber = SaintVenantKirchhoff::new(lame());
    let mut solid = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
    let none = |freedoms: &Freedoms<3>| DeadLoad::new(freedoms, vec![[0.0; 3]; 12]).unwrap();
    let mut held: Vec<Held> = freedoms
        .held()
        .iter()
        .zip(freedoms.places())
        .map(|(&(vertex, component), &place)| Held { vertex, component, place })
        .collect();
    let (start, places) = (freedoms.gathered(&mesh.nodes()).unwrap(), freedoms.places());
    let mut solve = |load: &DeadLoad<3>, metric: &_, mut q: Vec<f64>, newton| {
        let statics = Statics { newton, ..Statics::default() };
        statics.solve(&mut solid, load, metric, places, &mut q).map(|_| ())
    };
    let plain = Newton::default();
    // As many supports in another order, and at another vertex.
    held.swap(0, 1);
    let reordered = none(&Freedoms::new(12, &held).unwrap());
    let error = solve(&reordered, &metric, start.clone(), plain).unwrap_err();
    assert_eq!(error, ElasticityError::OtherSupports);
    // Equal ones that were numbered anew are as good.
    held.swap(0, 1);
    solve(&none(&Freedoms::new(12, &held).unwrap()), &metric, start.clone(), plain).unwrap();
    let last = held.len() - 1;
    held[last] = Held { vertex: 11, component: 2, place: 1.0 };
    let moved = none(&Freedoms::new(12, &held).unwrap());
    assert_eq!(solve(&moved, &metric, start.clone(), plain), Err(ElasticityError::OtherSupports));
    let load = none(&freedoms);
    let short = DiagonalMetric::new(vec![1.0; 3]).unwrap();
    assert!(solve(&load, &short, start.clone(), plain).is_err());
    let mut nowhere = start.clone();
    nowhere[4] = f64::NAN;
    let error = solve(&load, &metric, nowhere, plain).unwrap_err();
    assert!(matches!(error, ElasticityError::Position { .. }), "{error}");
    for tolerance in [f64::NAN, -1.0] {
        let error = solve(&load, &metric, start.clone(), Newton { tolerance, ..plain });
        assert!(matches!(error, Err(ElasticityError::Tolerance(_))));
    }
}

#[test]
fn a_slender_beam_at_rounding_is_an_answer() {
    // A hundred times as long as it is high, pushed so little that rounding of its places is most of
    // the residual.
    for size in [1e-6, 1.0, 1e6] {
        let mesh = rectangle([size, 0.01 * size], [60, 1], Diagonals::Alternating).unwrap();
        let freedoms = Freedoms::held_where(&mesh.nodes(), |x, _| x[0] == 0.0).unwrap();
        let metric = lumped_mass(LinearTriangle, &mesh, [1e3, 1.0], &freedoms).unwrap();
        let rubber = NeoHookean::new(Lame::<2>::from_young_poisson(1e9, 0.0).unwrap()).unwrap();
        let mut solid = Solid::new(LinearTriangle, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
        let mut forces = vec![[0.0; 2]; mesh.count()];
        forces[60] = [0.0, 1e-3 * size];
        let load = DeadLoad::new(&freedoms, forces).unwrap();
        let mut q = freedoms.gathered(&mesh.nodes()).unwrap();
        let rest = Statics::default().solve(&mut solid, &load, &metric, freedoms.places(), &mut q);
        let up: f64 = freedoms
            .held()
            .iter()
            .zip(&rest.unwrap().reactions)
            .filter_map(|((_, c), f)| (*c == 1).then_some(f))
            .sum();
        assert!((up / (1e-3 * size) + 1.0).abs() < 0.1, "{size}: {up}");
    }
}

/// A bar of ten cells along x, a thousand times as long as high, pulled by its weight along x: the end's way and
/// the sum of the reactions, both as parts of the exact ones.
fn pulled_bar(weight: f64, solves: Solves) -> Result<[f64; 2], ElasticityError> {
    let mesh = rectangle([1000.0, 1.0], [10, 1], Diagonals::Alternating).unwrap();
    let freedoms = Freedoms::held_where(&mesh.nodes(), |x, _| x[0] == 0.0)?;
    let law = Linear::new(Lame::<3>::from_young_poisson(1e9, 0.0)?.plane_stress());
    let mut solid = Solid::new(LinearTriangle, &mesh, 1.0, law, freedoms.clone())?;
    let load = DeadLoad::body(LinearTriangle, &mesh, 1.0, &freedoms, |_| [weight, 0.0])?;
    let metric = lumped_mass(LinearTriangle, &mesh, [1.0, 1.0], &freedoms)?;
    let mut q = freedoms.gathered(&mesh.nodes())?;
    let statics = Statics { solves, ..Statics::default() };
    let rest = statics.solve(&mut solid, &load, &metric, freedoms.places(), &mut q)?;
    // A second search from there finds nothing to do.
    statics.solve(&mut solid, &load, &metric, freedoms.places(), &mut q)?;
    let end = freedoms.positions(&q)?.iter().map(|x| x[0]).fold(0.0, f64::max) - 1000.0;
    let along = freedoms.held().iter().zip(&rest.reactions).filter(|((_, c), _)| *c == 0);
    let pull: f64 = along.map(|(_, f)| f).sum();
    Ok([end / (weight * 5e5 / 1e9), pull / (-1000.0 * weight)])
}

#[test]
fn iterations_that_are_too_few_find_no_rest() {
    let method = |iterations| Solves::Iterate(ConjugateGradient { tolerance: 1e-12, iterations });
    for weight in [1e-4, 1.0, 1e4] {
        let error = pulled_bar(weight, method(1)).unwrap_err();
        let ElasticityError::Statics { source, .. } = &error else { panic!("{weight}: {error}") };
        let NewtonFailure::Unsolvable(Unsolvable::NotConverged { iterations: 1, .. }) =
            source.failure
        else {
            panic!("{weight}: {error}")
        };
        let [end, pull] = pulled_bar(weight, Solves::Factor(Ordering::default())).unwrap();
        assert!((end - 1.0).abs() < 1e-3, "{weight}: {end}");
        assert!((pull - 1.0).abs() < 1e-3, "{weight}: {pull}");
    }
}

#[test]
fn the_deflection_of_a_beam_however_slender_is_right_or_refused() {
    let steel = Lame::<3>::from_young_poisson(2e11, 0.3).unwrap().plane_stress();
    let mut refused = 0;
    for unit in [1e-3, 1.0, 1e3] {
        for height in [1e-2, 1e-3, 3e-4, 1e-4] {
            for part in [1e-12, 1e-9, 0.05] {
                let size = [unit, unit * height];
                let beam = Beam { size, lame: steel, push: 1.0, diagonals: Diagonals::Alternating };
                let beam = Beam { push: part * unit / beam.deflection(), ..beam };
                match beam.solved(SheetFamily::Quadratic, [50, 1]) {
                    Ok(sheet) => {
                        // Of its fifty cells the clamp makes one a little stiffer than the theory.
                        let ratio = sheet.value / (part * unit);
                        assert!((ratio - 1.0).abs() < 4e-3, "{unit} {height} {part}: {ratio}");
                    }
                    Err(
                        ElasticityError::Statics { .. }
                        | ElasticityError::Unsettled { .. }
                        | ElasticityError::Unbalanced { .. },
                    ) => {
                        assert!(height < 3e-4 || part < 1e-4, "{unit} {height} {part}: refused");
                        refused += 1;
                    }
                    Err(error) => panic!("{error}"),
                }
            }
        }
    }
    assert!(refused > 0, "the trial goes far enough");
}

#[test]
fn a_load_that_leads_by_less_than_the_places_digits_leaves_a_block_where_it_is() {
    let floor = |x: Vector3<f64>| x.z == 0.0;
    let before = block_under(floor, [0.0; 3]).unwrap().0;
    for weight in [1e-150, 1e-20] {
        let (positions, ..) = block_under(floor, [0.0, 0.0, -weight]).unwrap();
        let moved = positions.as_flattened().iter().zip(before.as_flattened());
        assert!(moved.into_iter().all(|(x, before)| (x - before).abs() < 1e-14), "{weight:e}");
    }
}
