//! Every public function of the crate with bad numbers, wrong sizes and what was made for something
//! else.

use stationary_calculus::{
    Covector, Curvature, DiagonalMetric, Force, Metric, Newton, Potential, Stencil, Vector,
};
use stationary_elasticity::problems::{
    Beam, BeamTheory, Ends, SheetFamily, bar_frequencies, elliptic_membrane_stress,
    sliding_block_frequencies,
};
use stationary_elasticity::{
    AutomaticMaterial, Damper, Dampers, DeadLoad, Density, Elements, FixedCorotated, Freedoms,
    FullTangent, Held, Hinge, Lame, Linear, LinearSegment, LinearTetrahedron, LinearTriangle,
    Material, Measure, NeoHookean, Net, Orthotropic, QuadraticSegment, QuadraticTriangle, Rayleigh,
    SaintVenantKirchhoff, Solid, Spring, Statics, Strain, StrainRate, Weave, averaged_stress,
    cauchy, curved_boundary, galerkin_mass, hinges, lumped_mass, net, straight_boundary,
};
use stationary_mesh::{Diagonals, Mesh, QuadraticTriangles, cuboid, rectangle};

use crate::{Draw, Verdict};

pub fn trial(draw: &mut Draw) -> Verdict {
    type Check = fn(&mut Draw) -> Verdict;
    let checks: [(&str, Check); 20] = [
        ("pairs of moduli", lame),
        ("springs", springs),
        ("nets", nets),
        ("dampers", dampers),
        ("weaves", weaves),
        ("hinges", hinge),
        ("sheets of hinges", sheet_of_hinges),
        ("freedoms", freedoms),
        ("loads", loads),
        ("densities of loads", densities),
        ("solids", solids),
        ("masses", masses),
        ("statics of bad numbers", statics),
        ("statics of other supports", other_supports),
        ("stresses", stresses),
        ("damping", damping),
        ("measures", measures),
        ("materials", materials),
        ("parameters", parameters),
        ("problems", problems),
    ];
    let (name, check) = draw.one_of(&checks);
    draw.note(name);
    check(draw)
}

/// Ok must hold finite numbers.
fn finite(what: &str, numbers: &[f64]) -> Verdict {
    match numbers.iter().all(|x| x.is_finite()) {
        true => Verdict::due(),
        false => Verdict::wrong(format!("Ok with {what} of {numbers:?}")),
    }
}

fn lame(draw: &mut Draw) -> Verdict {
    fn of<const D: usize>(draw: &mut Draw) -> Verdict {
        let (a, b) = (draw.any_f64(), draw.any_f64());
        draw.note(format!("{a:e} {b:e} in {D} dimensions"));
        let made = match draw.below(3) {
            0 => Lame::<D>::new(a, b),
            1 => Lame::<D>::from_young_poisson(a, b),
            _ => Lame::<D>::from_bulk_shear(a, b),
        };
        match made {
            Ok(pair) => {
                let numbers = [pair.lambda(), pair.mu(), pair.bulk(), pair.poisson(), pair.young()];
                let positive = pair.mu() > 0.0 && pair.bulk() > 0.0 && pair.young() > 0.0;
                let verdict = finite("moduli", &numbers);
                if positive { verdict } else { Verdict::wrong(format!("Ok with {numbers:?}")) }
            }
            Err(_) => Verdict::due(),
        }
    }
    let (a, b) = (draw.any_f64(), draw.any_f64());
    let thin = match Lame::<3>::new(a, b) {
        Ok(pair) => {
            let (sheet, bar, slice) =
                (pair.plane_stress(), pair.uniaxial_stress(), pair.plane_strain());
            let numbers = [
                sheet.lambda(),
                sheet.young(),
                bar.lambda(),
                bar.young(),
                slice.lambda(),
                slice.young(),
            ];
            draw.note(format!("thinner than {a:e} {b:e}"));
            finite("thinner moduli", &numbers)
        }
        Err(_) => Verdict::due(),
    };
    thin.and(of::<1>(draw)).and(of::<2>(draw)).and(of::<3>(draw))
}

fn springs(draw: &mut Draw) -> Verdict {
    let vertices = [draw.below(3), draw.below(3)];
    let (length, stiffness) = (draw.any_f64(), draw.any_f64());
    let strain = draw.one_of(&[Strain::Cauchy, Strain::Green]);
    draw.note(format!("{vertices:?} {length:e} {stiffness:e} {strain:?}"));
    match Spring::new(vertices, length, stiffness, strain) {
        Ok(spring) => {
            let good = spring.stiffness() > 0.0 && spring.rest_length() >= 0.0;
            let x: [[f64; 3]; 2] = [[0.0; 3], [draw.any_f64(), draw.any_f64(), draw.any_f64()]];
            let _ = (
                spring.energy(&x),
                spring.differential(&x),
                spring.hessian(&x, Curvature::Semidefinite),
            );
            if good {
                finite("a spring", &[spring.stiffness(), spring.rest_length()])
            } else {
                Verdict::wrong("a spring that cannot be")
            }
        }
        Err(_) => Verdict::due(),
    }
}

/// A count: small, none, or beyond all memory.
fn count(draw: &mut Draw) -> usize {
    match draw.below(4) {
        0 => draw.between(0, 6),
        1 => 1 << draw.between(40, 63),
        2 => usize::MAX - draw.below(3),
        _ => draw.between(0, 40),
    }
}

fn nets(draw: &mut Draw) -> Verdict {
    let size = Net {
        rows: count(draw),
        columns: count(draw),
        spacing: draw.any_f64(),
        stiffness: draw.any_f64(),
        strain: draw.one_of(&[Strain::Cauchy, Strain::Green]),
    };
    draw.note(format!("{size:?}"));
    match net(size) {
        Ok(springs) => {
            let lengths: Vec<f64> = springs.iter().map(Spring::rest_length).collect();
            finite("rest lengths", &lengths)
        }
        Err(_) => Verdict::due(),
    }
}

fn dampers(draw: &mut Draw) -> Verdict {
    let viscosity = draw.any_f64();
    let vertices = [draw.below(4), count(draw)];
    let free = count(draw);
    draw.note(format!("{vertices:?} {viscosity:e}, {free} free"));
    let Ok(damper) = Damper::new(vertices, viscosity) else { return Verdict::due() };
    if !(viscosity >= 0.0 && viscosity.is_finite()) {
        return Verdict::wrong("a viscosity that cannot be");
    }
    match Dampers::<3>::new(free, vec![[0.0; 3]; draw.below(3)], vec![damper]) {
        Ok(dampers) if free < 100 => {
            let q: Vec<f64> = (0..3 * free).map(|k| k as f64).collect();
            let mut f = vec![0.0; 3 * free];
            dampers.add_force(0.0, &q, Vector(&q), Covector(&mut f));
            Verdict::due()
        }
        Ok(_) => Verdict::due(),
        Err(_) => Verdict::due(),
    }
}

fn weaves(draw: &mut Draw) -> Verdict {
    let mut number = |moderate: f64| if draw.chance(0.5) { draw.any_f64() } else { moderate };
    let weave = Weave {
        warp: number(1e6),
        weft: number(1e5),
        poisson: number(0.3),
        shear: number(1e4),
        angle: number(0.5),
    };
    draw.note(format!("{weave:?}"));
    match Orthotropic::new(weave) {
        Ok(material) => {
            let p = material.stress(&[[1.01, 0.0], [0.0, 0.99]]);
            finite("stress", p.as_flattened())
        }
        Err(_) => Verdict::due(),
    }
}

/// Four places, of which some are the same, in a row, or nowhere.
fn fold(draw: &mut Draw) -> [[f64; 3]; 4] {
    let mut x: [[f64; 3]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| draw.symmetric()));
    let scale = draw.log_uniform(1e-6, 1e6);
    x = x.map(|x| x.map(|x| scale * x));
    match draw.below(5) {
        0 => {}
        1 => x[draw.below(4)] = x[draw.below(4)],
        2 => {
            // In a row with two others.
            let t = draw.uniform(-2.0, 2.0);
            let (a, b, c) = (draw.below(4), draw.below(4), draw.below(4));
            x[a] = std::array::from_fn(|i| x[b][i] + t * (x[c][i] - x[b][i]));
        }
        3 => x[draw.below(4)][draw.below(3)] = draw.any_f64(),
        _ => {
            for x in &mut x {
                x[2] = 0.0;
            }
        }
    }
    x
}

fn hinge(draw: &mut Draw) -> Verdict {
    let x = fold(draw);
    let stiffness = if draw.chance(0.3) { draw.any_f64() } else { 1.0 };
    let vertices = if draw.chance(0.2) { [0, 1, 2, draw.below(4)] } else { [0, 1, 2, 3] };
    draw.note(format!("{vertices:?} at {x:?}, {stiffness:e} J"));
    match Hinge::new(vertices, &x, stiffness) {
        Ok(hinge) => {
            let mut repeated = vertices.to_vec();
            repeated.sort_unstable();
            repeated.dedup();
            if repeated.len() < 4 {
                return Verdict::wrong("a hinge with a vertex twice");
            }
            let gradient = hinge.differential(&x);
            let hessian = hinge.hessian(&x, Curvature::Exact);
            let hessian = hessian.as_flattened().as_flattened().as_flattened();
            finite("energy at rest", &[hinge.energy(&x)])
                .and(finite("force at rest", gradient.as_flattened()))
                .and(finite("Hessian at rest", hessian))
        }
        Err(_) => Verdict::due(),
    }
}

fn sheet_of_hinges(draw: &mut Draw) -> Verdict {
    let Ok(flat) = rectangle([1.0, 1.0], [2, 2], Diagonals::Same) else {
        return Verdict::not_judged("mesh");
    };
    let mut vertices: Vec<nalgebra::Vector3<f64>> = flat
        .vertices()
        .iter()
        .map(|x| nalgebra::Vector3::new(x[0], x[1], 0.1 * draw.symmetric()))
        .collect();
    let flattened = draw.chance(0.5);
    if flattened {
        // A triangle becomes a line.
        let [a, b, c] = flat.simplices()[draw.below(8)];
        vertices[a] = 0.5 * (vertices[b] + vertices[c]);
    }
    draw.note(format!("a triangle is flat: {flattened}"));
    let Ok(sheet) = Mesh::<3, 3>::new(vertices, flat.simplices().to_vec()) else {
        return Verdict::due();
    };
    match hinges(&sheet, if draw.chance(0.2) { draw.any_f64() } else { 1.0 }) {
        Ok(hinges) => hinges.iter().fold(Verdict::due(), |verdict, hinge| {
            let x = hinge.vertices().map(|v| sheet.vertices()[v].into());
            verdict.and(finite("force at rest", hinge.differential(&x).as_flattened()))
        }),
        Err(_) => Verdict::due(),
    }
}

fn freedoms(draw: &mut Draw) -> Verdict {
    let vertices = count(draw);
    let held: Vec<Held> = (0..draw.below(5))
        .map(|_| Held {
            vertex: draw.below(5),
            component: draw.below(4),
            place: if draw.chance(0.3) { draw.any_f64() } else { 1.0 },
        })
        .collect();
    draw.note(format!("{vertices} vertices, {held:?}"));
    let Ok(mut freedoms) = Freedoms::<3>::new(vertices, &held) else { return Verdict::due() };
    let places = vec![draw.any_f64(); draw.below(6)];
    let moved = freedoms.hold_at(&places);
    let q = vec![0.0; draw.below(130)];
    let (n, positions) = (freedoms.dim(), freedoms.positions(&q));
    let gathered = freedoms.gathered(&vec![[0.0; 3]; draw.below(50)]);
    let verdict = finite("places", freedoms.places());
    if moved.is_ok() && places.len() != held.len() || positions.is_ok() && q.len() != n {
        return Verdict::wrong("wrong sizes are accepted");
    }
    match gathered {
        Ok(gathered) if gathered.len() != n => Verdict::wrong("wrong sizes are accepted"),
        _ => verdict,
    }
}

fn small_block() -> Mesh<3, 4> {
    cuboid([1.0; 3], [1; 3]).expect("a cube")
}

fn clamped(mesh: &Mesh<3, 4>) -> Freedoms<3> {
    let places: Vec<[f64; 3]> = mesh.nodes();
    Freedoms::held_where(&places, |x, _| x[0] == 0.0).expect("places")
}

fn loads(draw: &mut Draw) -> Verdict {
    let mesh = small_block();
    let freedoms = clamped(&mesh);
    let count = draw.between(0, 10);
    let mut forces = vec![[1.0, 2.0, 3.0]; count];
    let bad = draw.chance(0.5) && count > 0;
    if bad {
        forces[draw.below(count)][draw.below(3)] = draw.any_f64();
    }
    let factor = draw.any_f64();
    draw.note(format!("{forces:?} times {factor:e}"));
    let Ok(load) = DeadLoad::new(&freedoms, forces) else { return Verdict::due() };
    if count != 8 {
        return Verdict::wrong("forces of another mesh");
    }
    let scaled = scaled(&load, factor);
    let verdict = finite("a load", load.forces().as_flattened());
    let verdict = match scaled {
        Some(scaled) => verdict.and(finite("a scaled load", scaled.forces().as_flattened())),
        None => verdict,
    };
    match load.plus(&load) {
        Ok(sum) => verdict.and(finite("a sum of loads", sum.forces().as_flattened())),
        Err(_) => verdict,
    }
}

/// The load times a factor, or `None` where that is refused.
fn scaled(load: &DeadLoad<3>, factor: f64) -> Option<DeadLoad<3>> {
    load.scaled(factor).ok()
}

fn densities(draw: &mut Draw) -> Verdict {
    let mesh = small_block();
    let freedoms =
        if draw.chance(0.3) { Freedoms::free(draw.below(9)) } else { Ok(clamped(&mesh)) };
    let Ok(freedoms) = freedoms else { return Verdict::due() };
    let (section, force) = (draw.any_f64(), draw.any_f64());
    draw.note(format!("section {section:e}, force {force:e}, {} vertices", freedoms.vertices()));
    let body = DeadLoad::body(LinearTetrahedron, &mesh, section, &freedoms, |_| [force; 3]);
    let Ok(rim) = Mesh::<3, 3>::new(mesh.vertices().to_vec(), mesh.boundary_facets()) else {
        return Verdict::not_judged("no rim");
    };
    let traction =
        DeadLoad::traction(LinearTriangle, &rim, section, &freedoms, |_, n| n.map(|n| force * n));
    [body, traction].into_iter().flatten().fold(Verdict::due(), |verdict, load| {
        verdict.and(finite("a load", load.forces().as_flattened()))
    })
}

/// A block of which some elements are flat, inside out or far away.
fn damaged(draw: &mut Draw) -> Option<Mesh<3, 4>> {
    let mesh = small_block();
    let mut vertices = mesh.vertices().to_vec();
    match draw.below(4) {
        0 => {}
        1 => vertices[draw.below(8)] = vertices[draw.below(8)],
        2 => vertices[draw.below(8)] *= draw.any_f64(),
        _ => vertices.iter_mut().for_each(|x| x[2] = 0.0),
    }
    draw.note(format!("vertices {vertices:?}"));
    Mesh::new(vertices, mesh.simplices().to_vec()).ok()
}

fn rubber() -> SaintVenantKirchhoff<3> {
    SaintVenantKirchhoff::new(Lame::from_young_poisson(1e4, 0.3).expect("rubber"))
}

fn solids(draw: &mut Draw) -> Verdict {
    let Some(mesh) = damaged(draw) else { return Verdict::due() };
    let section = if draw.chance(0.3) { draw.any_f64() } else { 1.0 };
    let vertices = if draw.chance(0.2) { draw.below(12) } else { 8 };
    let parts = count(draw);
    draw.note(format!("section {section:e}, {vertices} vertices, {parts} parts"));
    let Ok(freedoms) = Freedoms::<3>::free(vertices) else { return Verdict::due() };
    let Ok(solid) = Solid::new(LinearTetrahedron, &mesh, section, rubber(), freedoms) else {
        return Verdict::due();
    };
    let solid = solid.in_parts(parts);
    let q: Vec<f64> = mesh.nodes().into_iter().flatten().collect();
    let mut dv = vec![0.0; q.len()];
    solid.add_differential(&q, Covector(&mut dv));
    let short = vec![0.0; draw.below(30)];
    let _ = (solid.held_differential(&short), solid.inverted(&short));
    if short.len() < q.len() && !solid.energy(&short).is_nan() {
        return Verdict::wrong("the energy of half a configuration");
    }
    let large = mesh.vertices().iter().any(|x| x.amax() > 1e9) || section > 1e9;
    if large {
        Verdict::due()
    } else {
        finite("energy", &[solid.energy(&q)]).and(finite("force", &dv))
    }
}

/// What a mass makes of velocities of one.
fn momentum(mass: &impl Metric) -> Vec<f64> {
    let (v, mut p) = (vec![1.0; mass.dim()], vec![0.0; mass.dim()]);
    mass.flat(Vector(&v), Covector(&mut p));
    p
}

fn masses(draw: &mut Draw) -> Verdict {
    let Some(mesh) = damaged(draw) else { return Verdict::due() };
    let mut number = || if draw.chance(0.5) { draw.any_f64() } else { 1.0 };
    let numbers = [number(), number()];
    let vertices = if draw.chance(0.2) { draw.below(12) } else { 8 };
    draw.note(format!("density and section {numbers:?}, {vertices} vertices"));
    let Ok(freedoms) = Freedoms::<3>::free(vertices) else { return Verdict::due() };
    let verdict = match lumped_mass(LinearTetrahedron, &mesh, numbers, &freedoms) {
        Ok(mass) => finite("lumped mass", &momentum(&mass)),
        Err(_) => Verdict::due(),
    };
    verdict.and(match galerkin_mass(LinearTetrahedron, &mesh, numbers, &freedoms) {
        Ok(mass) => finite("Galerkin's mass", &momentum(&mass)),
        Err(_) => Verdict::due(),
    })
}

fn statics(draw: &mut Draw) -> Verdict {
    let mesh = small_block();
    let freedoms = clamped(&mesh);
    let Ok(mut solid) = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber(), freedoms.clone())
    else {
        return Verdict::not_judged("no solid");
    };
    let Ok(load) = DeadLoad::new(&freedoms, vec![[0.0, 0.0, 1.0]; 8]) else {
        return Verdict::not_judged("no load");
    };
    let n = freedoms.dim();
    let masses = vec![1.0; if draw.chance(0.2) { draw.between(1, 2 * n) } else { n }];
    let Ok(metric) = DiagonalMetric::new(masses.clone()) else {
        return Verdict::not_judged("no mass");
    };
    let Ok(mut q) = freedoms.gathered(&mesh.nodes()) else {
        return Verdict::not_judged("no places");
    };
    if draw.chance(0.3) {
        q.resize(draw.below(2 * n), 0.0);
    }
    if draw.chance(0.3) && !q.is_empty() {
        let k = draw.below(q.len());
        q[k] = draw.any_f64();
    }
    let mut places = freedoms.places().to_vec();
    if draw.chance(0.3) {
        places.resize(draw.below(20), 0.0);
    }
    if draw.chance(0.3) && !places.is_empty() {
        let k = draw.below(places.len());
        places[k] = draw.any_f64();
    }
    let tolerance = if draw.chance(0.2) { draw.any_f64() } else { 0.0 };
    let newton = Newton { tolerance, iterations: draw.between(0, 50) };
    let statics = Statics { steps: draw.between(0, 2), newton, ..Statics::default() };
    draw.note(format!("{statics:?}, {} masses, q {q:?}, places {places:?}", masses.len()));
    let before = q.clone();
    match statics.solve(&mut solid, &load, &metric, &places, &mut q) {
        Ok(rest) => {
            if masses.len() != n || tolerance.is_nan() || tolerance < 0.0 {
                return Verdict::wrong("what does not fit is accepted");
            }
            finite("rest", &q).and(finite("reactions", &rest.reactions))
        }
        Err(_) if before.iter().map(|x| x.to_bits()).eq(q.iter().map(|x| x.to_bits())) => {
            Verdict::due()
        }
        Err(_) => Verdict::wrong("a failure that moves the body"),
    }
}

/// As many held coordinates, but others.
fn other_supports(draw: &mut Draw) -> Verdict {
    let mesh = small_block();
    let places: Vec<[f64; 3]> = mesh.nodes();
    let side = draw.below(3);
    let (first, other) = (side, (side + draw.between(0, 2)) % 3);
    let reordered = draw.chance(0.3);
    let hold = |axis: usize, backwards: bool| {
        let mut held: Vec<Held> = Vec::new();
        for (vertex, x) in places.iter().enumerate().filter(|(_, x)| x[axis] == 0.0) {
            held.extend((0..3).map(|component| Held { vertex, component, place: x[component] }));
        }
        if backwards {
            held.reverse();
        }
        Freedoms::<3>::new(8, &held)
    };
    draw.note(format!(
        "held on side {first}, loaded for side {other}, in another order: {reordered}"
    ));
    let (Ok(mine), Ok(theirs)) = (hold(first, false), hold(other, reordered)) else {
        return Verdict::not_judged("no supports");
    };
    let forces: Vec<[f64; 3]> = (0..8).map(|_| std::array::from_fn(|_| draw.symmetric())).collect();
    let Ok(load) = DeadLoad::new(&theirs, forces) else { return Verdict::not_judged("no load") };
    let Ok(mut solid) = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber(), mine.clone()) else {
        return Verdict::not_judged("no solid");
    };
    let Ok(metric) = DiagonalMetric::new(vec![1.0; mine.dim()]) else {
        return Verdict::not_judged("no mass");
    };
    let Ok(mut q) = mine.gathered(&places) else { return Verdict::not_judged("no places") };
    let solved = Statics::default().solve(&mut solid, &load, &metric, mine.places(), &mut q);
    match (solved, first == other && !reordered) {
        (Ok(_), true) | (Err(_), false) => Verdict::due(),
        (Err(error), true) => Verdict::refused(error),
        (Ok(_), false) => Verdict::wrong("a load of other supports is accepted"),
    }
}

fn stresses(draw: &mut Draw) -> Verdict {
    let Some(mesh) = damaged(draw) else { return Verdict::due() };
    let mut positions: Vec<[f64; 3]> = small_block().nodes();
    if draw.chance(0.3) {
        positions.resize(draw.below(12), [0.0; 3]);
    }
    if draw.chance(0.5) && !positions.is_empty() {
        let k = draw.below(positions.len());
        positions[k][draw.below(3)] = draw.any_f64();
    }
    draw.note(format!("positions {positions:?}"));
    match averaged_stress(LinearTetrahedron, &mesh, &rubber(), &positions) {
        Ok(stress) => finite("stress", stress.as_flattened().as_flattened()),
        Err(_) => Verdict::due(),
    }
}

fn damping(draw: &mut Draw) -> Verdict {
    let mesh = small_block();
    let freedoms = clamped(&mesh);
    let Ok(solid) = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber(), freedoms.clone()) else {
        return Verdict::not_judged("no solid");
    };
    let (alpha, beta) = (draw.any_f64(), draw.any_f64());
    let n = if draw.chance(0.5) { freedoms.dim() } else { draw.between(1, 30) };
    draw.note(format!("alpha {alpha:e}, beta {beta:e}, {n} masses"));
    let Ok(metric) = DiagonalMetric::new(vec![1.0; n]) else { return Verdict::due() };
    let verdict = match Rayleigh::new([alpha, beta], metric, &solid) {
        Ok(_) if !(alpha >= 0.0 && beta >= 0.0 && alpha.is_finite() && beta.is_finite()) => {
            Verdict::wrong("a damping that gives energy")
        }
        _ => Verdict::due(),
    };
    let Ok(pair) = Lame::<3>::from_young_poisson(draw.any_f64(), 0.3) else { return verdict };
    let rate = StrainRate::new(&solid, pair);
    let mut rate = match rate {
        Ok(rate) => rate,
        Err(_) => return verdict,
    };
    let _ = rate.hold_at(&vec![draw.any_f64(); draw.below(20)]);
    verdict
}

fn measures(draw: &mut Draw) -> Verdict {
    let (a, b) = (draw.one_of(&Measure::ALL), draw.one_of(&Measure::ALL));
    let x = draw.any_f64();
    let f: [[f64; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| draw.any_f64()));
    draw.note(format!("{a:?} {b:?} at {x:e}, {f:?}"));
    let _ = (a.strain(x), a.stretch(x), a.converted([x, draw.any_f64(), 1.0], b));
    let _ = (
        a.tensor(&f),
        a.tensor(&[f[0], f[1]]),
        a.tensor(&[[f[0][0], f[0][1]], [f[1][0], f[1][1]]]),
    );
    // Down to no strain at all.
    let rest = a.tensor(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    finite("strain of the body at rest", rest.as_flattened())
}

#[derive(Clone, Copy)]
struct Own;

impl Density<3, 3> for Own {
    fn density<N: stationary_calculus::Number>(&self, f: [[N; 3]; 3]) -> N {
        f.iter().flatten().fold(N::from(0.0), |sum, &x| sum + x * x)
    }
}

fn materials(draw: &mut Draw) -> Verdict {
    fn of<M: Material<3, 3>>(material: &M, f: &[[f64; 3]; 3]) {
        let _ = (
            material.energy(f),
            material.stress(f),
            material.is_semidefinite(f),
            cauchy(material, f),
        );
        let tangent = FullTangent::of(&material.tangent(f, 1.0));
        let _ = (tangent.projected(), FullTangent::of(&material.semidefinite(f, 1.0)));
    }
    let moderate = draw.chance(0.3);
    let f: [[f64; 3]; 3] = std::array::from_fn(|_| {
        std::array::from_fn(|_| if moderate { draw.symmetric() } else { draw.any_f64() })
    });
    draw.note(format!("F {f:?}"));
    let Ok(lame) = Lame::<3>::from_young_poisson(1e4, 0.3) else {
        return Verdict::not_judged("moduli");
    };
    match draw.below(5) {
        0 => of(&Linear::new(lame), &f),
        1 => of(&rubber(), &f),
        2 => match NeoHookean::new(lame) {
            Ok(material) => of(&material, &f),
            Err(error) => return Verdict::refused(error),
        },
        3 => match FixedCorotated::new(lame) {
            Ok(material) => of(&material, &f),
            Err(error) => return Verdict::refused(error),
        },
        _ => of(&AutomaticMaterial(Own), &f),
    }
    Verdict::due()
}

fn parameters(draw: &mut Draw) -> Verdict {
    let mesh = small_block();
    let freedoms = clamped(&mesh);
    let Ok(solid) = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber(), freedoms) else {
        return Verdict::not_judged("no solid");
    };
    let (q, v) = (vec![draw.symmetric(); draw.below(40)], vec![draw.symmetric(); draw.below(40)]);
    draw.note(format!("{} and {} numbers", q.len(), v.len()));
    let fits = q.len() == solid.dim();
    let energy = solid.energy_by_parameters::<2>(&q);
    let force = solid.differential_by_parameters::<2>(&q, &v);
    if energy.is_ok() != fits || force.is_ok() != (fits && v.len() == solid.dim()) {
        return Verdict::wrong("wrong sizes are accepted");
    }
    Verdict::due()
}

fn problems(draw: &mut Draw) -> Verdict {
    let family = draw.one_of(&[SheetFamily::Linear, SheetFamily::Quadratic]);
    let cells = [draw.between(0, 3), draw.between(0, 3)];
    let size = [draw.any_f64(), draw.any_f64()];
    draw.note(format!("{family:?} in {cells:?}, size {size:?}"));
    match draw.below(4) {
        0 => match elliptic_membrane_stress(family, cells) {
            Ok(sheet) => finite("stress", &[sheet.value]),
            Err(_) => Verdict::due(),
        },
        1 => {
            let Ok(lame) = Lame::<2>::from_young_poisson(1.0, 0.3) else {
                return Verdict::not_judged("moduli");
            };
            let push = if draw.chance(0.5) { draw.any_f64() } else { 1e-6 };
            let size = if draw.chance(0.5) { size } else { [2.0, 1.0] };
            let beam = Beam { size, lame, push, diagonals: Diagonals::Same };
            match beam.solved(family, cells) {
                Ok(sheet) => finite("deflection", &[sheet.value]),
                Err(_) => Verdict::due(),
            }
        }
        2 => {
            let theory = draw.one_of(&[BeamTheory::EulerBernoulli, BeamTheory::Timoshenko]);
            let ends = draw.one_of(&[Ends::Clamped, Ends::Free]);
            let found = theory.frequencies(ends, size, draw.below(3));
            finite("frequencies", &found)
        }
        _ => {
            let _ = bar_frequencies(size[0], cells[0], cells[1]);
            let sizes = [size[0], size[1], 1.0];
            let _ = sliding_block_frequencies(sizes, draw.below(4));
            let Ok(mesh) = rectangle([1.0, 1.0], [2, 2], Diagonals::Same) else {
                return Verdict::due();
            };
            let quadratic = QuadraticTriangles::straight(&mesh);
            let _ = (straight_boundary(&mesh), curved_boundary(&quadratic));
            let _ = (QuadraticTriangle, QuadraticSegment, LinearSegment);
            Verdict::due()
        }
    }
}
