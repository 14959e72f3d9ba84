//! Surfaces, networks and solids as they come from files: with fins, pinches, doubles and vertices
//! that nothing uses. The operator is a sum over simplices: it is defined wherever each of them has
//! a size, and there it must be given.

use nalgebra::{DMatrix, DVector, Vector3};
use stationary_laplacian::{Domain, Elements, Heat, HeatMethod, laplacian};
use stationary_mesh::{IntrinsicSurface, Mesh, Simplex};

use super::matrices::{Matrices, part};
use super::shapes::{self, Shape};
use crate::{Draw, Kind, Verdict};

pub const KIND: Kind = Kind {
    name: "surfaces",
    krate: "laplacian",
    rule: "a refusal where every simplex has a size, an Ok where one has none or there is none, a \
           matrix or a mass that is not the referee's sum, a freedom for a vertex that nothing uses",
    in_tests: 400,
    trial,
};

fn trial(draw: &mut Draw) -> Verdict {
    match draw.below(4) {
        0 => {
            let mut shape = shapes::in_pieces(draw, shapes::line);
            let damage = damaged(draw, &mut shape);
            judge(draw, &shape, &damage)
        }
        1 => {
            let mut shape = shapes::in_pieces(draw, shapes::solid);
            let damage = damaged(draw, &mut shape);
            judge(draw, &shape, &damage)
        }
        _ => {
            let mut shape = shapes::in_pieces(draw, shapes::surface);
            let damage = damaged(draw, &mut shape);
            let verdict = judge(draw, &shape, &damage);
            let gluable = !(damage.branched || damage.turned || damage.flat);
            match shape.mesh() {
                Ok(mesh) if gluable && !damage.empty => verdict.and(by_lengths(&mesh, &shape)),
                _ => verdict,
            }
        }
    }
}

/// What was done to a shape.
#[derive(Default)]
struct Damage {
    branched: bool,
    turned: bool,
    flat: bool,
    empty: bool,
}

fn damaged<const K: usize>(draw: &mut Draw, shape: &mut Shape<K>) -> Damage {
    let mut damage = Damage::default();
    for _ in 0..draw.between(0, 3) {
        let n = shape.vertices.len();
        let any = draw.below(shape.simplices.len());
        match draw.below(7) {
            0 => {
                draw.note("a fin at a facet");
                let mut fin = shape.simplices[any];
                fin[draw.below(K)] = n;
                let middle = fin
                    .iter()
                    .filter(|&&v| v != n)
                    .map(|&v| shape.vertices[v])
                    .sum::<Vector3<f64>>();
                shape.vertices.push(middle / (K - 1) as f64 + Vector3::from_vec(draw.vector(3)));
                shape.simplices.push(fin);
                damage.branched = true;
            }
            1 => {
                draw.note("two vertices made one");
                let [u, v] = [draw.below(n), draw.below(n)];
                let together = shape.simplices.iter().any(|s| s.contains(&u) && s.contains(&v));
                if u != v && !together {
                    shape.simplices.as_flattened_mut().iter_mut().for_each(|w| {
                        if *w == v {
                            *w = u;
                        }
                    });
                    damage.branched = true;
                }
            }
            2 => {
                draw.note("vertices that nothing uses");
                for _ in 0..draw.between(1, 3) {
                    let place = draw.between(0, shape.vertices.len());
                    shape.vertices.insert(place, Vector3::from_vec(draw.vector(3)));
                    shape.simplices.as_flattened_mut().iter_mut().for_each(|w| {
                        if *w >= place {
                            *w += 1;
                        }
                    });
                }
            }
            3 => {
                draw.note("a simplex turned over");
                shape.simplices[any].swap(0, 1);
                damage.turned = true;
            }
            4 => {
                draw.note("a simplex twice");
                shape.simplices.push(shape.simplices[any]);
                damage.branched = true;
            }
            5 if draw.chance(0.3) => {
                draw.note("a simplex of no size");
                let simplex = shape.simplices[any];
                let corner = shape.vertices[simplex[0]];
                shape.vertices[simplex[1]] = corner;
                damage.flat = true;
            }
            6 if draw.chance(0.1) => {
                draw.note("no simplices");
                shape.simplices.clear();
                damage.empty = true;
                return damage;
            }
            _ => {}
        }
    }
    damage
}

fn judge<const K: usize>(draw: &mut Draw, shape: &Shape<K>, damage: &Damage) -> Verdict
where
    [usize; K]: Simplex,
{
    let mesh = match shape.mesh() {
        Ok(mesh) => mesh,
        Err(error) => return Verdict::refused(error),
    };
    let matrices = Matrices::of(shape);
    let undefined = damage.empty || matrices.shape < 1e-15;
    if !undefined && matrices.shape < 1e-9 {
        return Verdict::not_judged("a simplex of hardly any size");
    }
    let elements = match Elements::of(&mesh) {
        Err(_) if undefined => return Verdict::due(),
        Err(error) => return Verdict::wrong(format!("refused though it is defined: {error}")),
        Ok(_) if undefined => return Verdict::wrong("Ok where nothing is defined"),
        Ok(elements) => elements,
    };
    let slack = 1e-13 / matrices.shape.powi(2);
    let verdict = compare(&elements, &matrices, slack);
    let used: Vec<usize> = (0..shape.vertices.len())
        .filter(|v| shape.simplices.iter().any(|s| s.contains(v)))
        .collect();
    let domain = match Domain::free(elements) {
        Ok(domain) => domain,
        Err(error) => return Verdict::wrong(format!("no domain though it is defined: {error}")),
    };
    if domain.free_vertices() != used {
        return Verdict::wrong("the freedoms are not the vertices that are used");
    }
    let metric = match domain.lumped() {
        Ok(metric) => metric,
        Err(error) => return Verdict::wrong(format!("no mass though it is defined: {error}")),
    };
    let f = draw.vector(used.len());
    let mut expected = part(&matrices.stiffness, &used, &used) * DVector::from_column_slice(&f);
    for (k, &v) in used.iter().enumerate() {
        expected[k] /= -matrices.lumped[(v, v)];
    }
    let found = match laplacian(&metric, domain.dirichlet(), &f) {
        Ok(found) => found,
        Err(error) => return Verdict::wrong(format!("no Laplacian though it is defined: {error}")),
    };
    let scale = used
        .iter()
        .map(|&v| matrices.stiffness.row(v).amax() / matrices.lumped[(v, v)])
        .fold(0.0, f64::max);
    let error = found.iter().zip(expected.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let verdict =
        verdict.and(Verdict::of(error, slack * scale * 10.0, "the Laplacian of a function"));
    let mut all = match domain.on_vertices(&f) {
        Ok(all) => all,
        Err(error) => return Verdict::wrong(error),
    };
    if all.iter().any(|x| !x.is_finite()) || used.iter().zip(&f).any(|(&v, f)| all[v] != *f) {
        return Verdict::wrong("values on the vertices are not those of the freedoms");
    }
    all.clone_from(&f);
    let heat = Heat::new(&metric, domain.dirichlet(), HeatMethod::ImplicitEuler, 1.0, 1.0 / scale)
        .and_then(|mut heat| heat.step(&mut all));
    match heat {
        Ok(()) if all.iter().all(|x| x.is_finite()) => verdict,
        Ok(()) => Verdict::wrong("heat is not finite"),
        Err(error) => Verdict::wrong(format!("no heat though it is defined: {error}")),
    }
}

/// The sum over the elements that were given.
fn compare<const K: usize>(elements: &Elements<K>, matrices: &Matrices, slack: f64) -> Verdict {
    let n = elements.vertices();
    let (mut stiffness, mut lumped) = (DMatrix::zeros(n, n), DMatrix::<f64>::zeros(n, n));
    for element in elements.elements() {
        let corners = element.corners();
        for (i, &u) in corners.iter().enumerate() {
            lumped[(u, u)] += element.measure() / K as f64;
            for (j, &v) in corners.iter().enumerate() {
                stiffness[(u, v)] += element.weights()[i][j];
            }
        }
    }
    let scale = matrices.stiffness.amax();
    let stiff = Verdict::of((stiffness - &matrices.stiffness).amax(), slack * scale, "the matrix");
    let mass = matrices.lumped.amax();
    stiff.and(Verdict::of((lumped - &matrices.lumped).amax(), slack * mass, "the mass"))
}

/// The same surface by its edge lengths.
fn by_lengths(mesh: &Mesh<3, 3>, shape: &Shape<3>) -> Verdict {
    let surface = match IntrinsicSurface::of(mesh) {
        Ok(surface) => surface,
        Err(error) => return Verdict::wrong(format!("refused though it can be glued: {error}")),
    };
    let matrices = Matrices::of(shape);
    if matrices.shape < 1e-5 {
        return Verdict::not_judged("too flat for lengths alone");
    }
    match Elements::of_surface(&surface) {
        Ok(elements) => compare(&elements, &matrices, 1e-13 / matrices.shape.powi(3)),
        Err(error) => Verdict::wrong(format!("refused by lengths though it is defined: {error}")),
    }
}
