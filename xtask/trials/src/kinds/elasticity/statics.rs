//! Where loaded bodies come to rest: against closed forms, beam theory and the trials' own bodies.
//!
//! ```text
//! patch     the hull held at F X + t            the inside follows
//! pulled    a traction on one face              P_11 = t, P_22 = P_33 = 0: a Newton of the trial's
//! chain     a bar in pieces with loads          each piece bears the sum of what is beyond it
//! beam      L/h from 4 to 300                   Euler, Bernoulli, Timoshenko
//! any       random loads and supports           one more Newton step, dense, moves nothing
//! crushed   one face moved through the other    refused
//! ```
//! Sizes of 1e-6 to 1e6 m, Young's moduli of 1 to 1e12 Pa, strains of 1e-9 to 0.15.

use nalgebra::SVector;
use stationary_elasticity::{
    DeadLoad, ElasticityError, Elements, FixedCorotated, Freedoms, Held, Lame, Linear,
    LinearSegment, LinearTetrahedron, LinearTriangle, Material, NeoHookean, QuadraticSegment,
    QuadraticTriangle, Reference, SaintVenantKirchhoff, Solid, Statics, curved_boundary,
    lumped_mass,
};
use stationary_mesh::{Diagonals, Mesh, QuadraticTriangles, bar, cuboid, rectangle};

use super::body::{Body, moduli};
use super::law::{Law, Moduli, density, derivatives, unit};
use super::shapes::rotation;
use crate::{Draw, Verdict};

const EPS: f64 = f64::EPSILON;

pub fn trial(draw: &mut Draw) -> Verdict {
    match draw.below(8) {
        0 => patch(draw),
        1 | 2 => pulled(draw),
        3 => chain(draw),
        4 => beam(draw),
        5 | 6 => any(draw),
        _ => crushed(draw),
    }
}

/// Where a body came to rest, and what holds it.
pub struct Rest<const D: usize> {
    pub positions: Vec<[f64; D]>,
    pub reactions: Vec<f64>,
}

/// What is solved.
pub struct Problem<'a, const D: usize> {
    pub held: &'a [Held],
    /// Where the held coordinates go.
    pub ends: &'a [f64],
    pub density: f64,
    pub section: f64,
    pub steps: usize,
}

/// Makes a load for given supports.
pub type Loads<'a, const D: usize> =
    &'a dyn Fn(&Freedoms<D>) -> Result<DeadLoad<D>, ElasticityError>;

impl<const D: usize> Problem<'_, D> {
    pub fn solve<F, M, const N: usize, const R: usize, const Q: usize>(
        &self,
        family: F,
        mesh: &impl Elements<D, N>,
        material: M,
        start: &[[f64; D]],
        load: Loads<'_, D>,
    ) -> Result<Rest<D>, ElasticityError>
    where
        F: Reference<N, R, Q> + Copy,
        M: Material<D, R>,
    {
        let freedoms = Freedoms::<D>::new(mesh.count(), self.held)?;
        let metric = lumped_mass(family, mesh, [self.density, self.section], &freedoms)?;
        let load = load(&freedoms)?;
        let mut solid = Solid::new(family, mesh, self.section, material, freedoms.clone())?;
        let mut q = freedoms.gathered(start)?;
        let statics = Statics { steps: self.steps, ..Statics::default() };
        let rest = statics.solve(&mut solid, &load, &metric, self.ends, &mut q)?;
        Ok(Rest { positions: solid.freedoms().positions(&q)?, reactions: rest.reactions })
    }
}

/// Runs what follows with the material of a law.
macro_rules! with_material {
    ($law:expr, $lame:expr, $d:literal, $material:ident => $body:expr) => {
        match $law {
            Law::Linear => {
                let $material = Linear::<$d>::new($lame);
                $body
            }
            Law::Quadratic => {
                let $material = SaintVenantKirchhoff::<$d>::new($lame);
                $body
            }
            Law::NeoHookean => match NeoHookean::<$d>::new($lame) {
                Ok($material) => $body,
                Err(error) => return Verdict::refused(error),
            },
            Law::Corotated => match FixedCorotated::<$d>::new($lame) {
                Ok($material) => $body,
                Err(error) => return Verdict::refused(error),
            },
        }
    };
}
pub(crate) use with_material;

/// A block or a sheet: its mesh, its size, its law.
struct Block<const D: usize, const K: usize> {
    mesh: Mesh<D, K>,
    size: [f64; D],
    cells: [usize; D],
    law: Law,
    lame: Lame<D>,
    density: f64,
    steps: usize,
}

impl<const D: usize, const K: usize> Block<D, K> {
    fn new(
        draw: &mut Draw,
        most: usize,
        make: impl Fn([f64; D], [usize; D]) -> Option<Mesh<D, K>>,
    ) -> Option<Self> {
        let length = draw.log_uniform(1e-6, 1e6);
        let mut size = [length; D];
        for side in &mut size[1..] {
            *side *= if draw.chance(0.5) { draw.log_uniform(0.05, 1.0) } else { 1.0 };
        }
        let mut cells = [1; D];
        for count in &mut cells {
            *count = draw.between(1, most);
        }
        let law = draw.one_of(&Law::ALL);
        let [young, poisson] = moduli(draw);
        let lame = Lame::<D>::from_young_poisson(young, poisson).ok()?;
        let (density, steps) = (draw.log_uniform(1e-3, 1e4), draw.between(1, 3));
        draw.note(format!(
            "{law:?}, {size:?} m in {cells:?} cells, E = {young:e}, nu = {poisson}, {steps} steps"
        ));
        Some(Block { mesh: make(size, cells)?, size, cells, law, lame, density, steps })
    }

    fn pair(&self) -> Moduli {
        Moduli { lambda: self.lame.lambda(), mu: self.lame.mu() }
    }

    fn places(&self) -> Vec<[f64; D]> {
        self.mesh.vertices().iter().map(|x| (*x).into()).collect()
    }

    fn body(&self) -> Body {
        let rest: Vec<Vec<f64>> = self.places().iter().map(|x| x.to_vec()).collect();
        let elements = self.mesh.simplices().iter().map(|nodes| nodes.to_vec());
        Body::new((self.law, self.pair()), &rest, elements, 1.0)
    }

    /// Whether the vertex is on the hull.
    fn is_outer(&self, x: &SVector<f64, D>) -> bool {
        (0..D).any(|c| x[c] <= 1e-9 * self.size[c] || x[c] >= (1.0 - 1e-9) * self.size[c])
    }
}

fn sheet(size: [f64; 2], cells: [usize; 2]) -> Option<Mesh<2, 3>> {
    rectangle(size, cells, Diagonals::Alternating).ok()
}

fn block(size: [f64; 3], cells: [usize; 3]) -> Option<Mesh<3, 4>> {
    cuboid(size, cells).ok()
}

macro_rules! in_plane_or_space {
    ($draw:ident, $most:literal, $of:ident) => {
        if $draw.chance(0.5) {
            match Block::<3, 4>::new($draw, $most, block) {
                Some(block) => {
                    let material = &block;
                    with_material!(material.law, material.lame, 3, m => $of($draw, &block, LinearTetrahedron, m))
                }
                None => Verdict::not_judged("no such block"),
            }
        } else {
            match Block::<2, 3>::new($draw, $most, sheet) {
                Some(sheet) => {
                    let material = &sheet;
                    with_material!(material.law, material.lame, 2, m => $of($draw, &sheet, LinearTriangle, m))
                }
                None => Verdict::not_judged("no such sheet"),
            }
        }
    };
}

/// The hull follows a uniform deformation; so does the inside.
fn patch(draw: &mut Draw) -> Verdict {
    fn of<F, M, const D: usize, const K: usize>(
        draw: &mut Draw,
        block: &Block<D, K>,
        family: F,
        material: M,
    ) -> Verdict
    where
        F: Reference<K, D, 1> + Copy,
        M: Material<D, D>,
    {
        let strain = draw.log_uniform(1e-9, 0.15);
        let gradient: Vec<Vec<f64>> =
            (0..D).map(|_| draw.vector(D).into_iter().map(|x| strain * x).collect()).collect();
        draw.note(format!("patch of displacement gradient {gradient:?}"));
        let shift: Vec<f64> = draw.vector(D);
        let moved = |x: &[f64; D]| -> [f64; D] {
            std::array::from_fn(|i| {
                let along: f64 = (0..D).map(|k| gradient[k][i] * x[k]).sum();
                x[i] + along + strain * block.size[0] * shift[i]
            })
        };
        let mut held = Vec::new();
        for (vertex, x) in block.mesh.vertices().iter().enumerate() {
            if block.is_outer(x) {
                held.extend((0..D).map(|component| Held {
                    vertex,
                    component,
                    place: x[component],
                }));
            }
        }
        let places = block.places();
        let ends: Vec<f64> = held.iter().map(|h| moved(&places[h.vertex])[h.component]).collect();
        let problem = Problem {
            held: &held,
            ends: &ends,
            density: block.density,
            section: 1.0,
            steps: block.steps,
        };
        let none = |freedoms: &Freedoms<D>| DeadLoad::new(freedoms, vec![[0.0; D]; places.len()]);
        let rest = match problem.solve(family, &block.mesh, material, &places, &none) {
            Ok(rest) => rest,
            Err(error) => return Verdict::refused(error),
        };
        let length = block.size[0];
        let error = rest.positions.iter().zip(&places).flat_map(|(got, x)| {
            let expected = moved(x);
            (0..D).map(move |i| (got[i] - expected[i]).abs())
        });
        let thin = length / block.size.iter().copied().fold(f64::INFINITY, f64::min);
        let promised = 1e-7 * strain * length + 1e3 * EPS * length * thin;
        let verdict = Verdict::of(error.fold(0.0, f64::max), promised, "place of an inner vertex");
        // No load: the supports push against one another.
        let volume: f64 = block.size.iter().product();
        let scale = block.pair().size() * volume / (length / thin);
        (0..D).fold(verdict, |verdict, c| {
            let along = held.iter().zip(&rest.reactions).filter(|(h, _)| h.component == c);
            let sum: f64 = along.map(|(_, f)| f).sum();
            let promised = (1e-9 * strain + 1e4 * EPS) * scale;
            verdict.and(Verdict::of(sum.abs(), promised, "sum of the reactions"))
        })
    }
    in_plane_or_space!(draw, 3, of)
}

/// The stretches at which a law has the stress `t` along the first direction and none across.
fn uniaxial(law: Law, pair: Moduli, d: usize, t: f64, guess: [f64; 2]) -> Option<[f64; 2]> {
    let [mut along, mut across] = guess;
    let mut last = f64::INFINITY;
    for _ in 0..60 {
        let f: Vec<Vec<f64>> = (0..d)
            .map(|k| {
                (0..d)
                    .map(|i| {
                        if i != k {
                            0.0
                        } else if k == 0 {
                            along
                        } else {
                            across
                        }
                    })
                    .collect()
            })
            .collect();
        let first = unit(&f, (0, 0));
        let mut others = unit(&f, (1, 1));
        if d == 3 {
            others[2][2] = 1.0;
        }
        let of = |a: &[Vec<f64>], b: &[Vec<f64>]| {
            derivatives::<f64>(&f, [a, b], |f| density(law, pair, f))
        };
        let (aa, ab, bb) = (of(&first, &first), of(&first, &others), of(&others, &others));
        let (r, s) = (aa.first - t, bb.first);
        let det = aa.both * bb.both - ab.both * ab.both;
        let step = [(bb.both * r - ab.both * s) / det, (aa.both * s - ab.both * r) / det];
        along -= step[0];
        across -= step[1];
        let size = step[0].abs().max(step[1].abs());
        if size >= last && size < 1e-14 {
            let stable = aa.both > 0.0 && det > 0.0;
            return (stable && along > 0.0 && across > 0.0).then_some([along, across]);
        }
        last = size;
    }
    None
}

/// One face is pulled, the opposite one slides on its plane.
fn pulled(draw: &mut Draw) -> Verdict {
    fn of<F, M, const D: usize, const K: usize>(
        draw: &mut Draw,
        block: &Block<D, K>,
        family: F,
        material: M,
    ) -> Verdict
    where
        F: Reference<K, D, 1> + Copy,
        M: Material<D, D>,
    {
        let strain = draw.log_uniform(1e-9, 0.15) * if draw.chance(0.3) { -1.0 } else { 1.0 };
        let traction = strain * block.lame.young();
        draw.note(format!("pulled with {traction:e} N/m^2, strain of {strain:e}"));
        let guess = [1.0 + strain, 1.0 - block.lame.poisson() * strain];
        let Some([along, across]) = uniaxial(block.law, block.pair(), D, traction, guess) else {
            return Verdict::not_judged("no stretch bears this load");
        };
        let mut held = Vec::new();
        for (vertex, x) in block.mesh.vertices().iter().enumerate() {
            let on_planes = (0..D).filter(|&c| x[c] <= 1e-9 * block.size[c]);
            held.extend(on_planes.map(|component| Held { vertex, component, place: x[component] }));
        }
        let ends: Vec<f64> = held.iter().map(|h| h.place).collect();
        let problem = Problem {
            held: &held,
            ends: &ends,
            density: block.density,
            section: 1.0,
            steps: block.steps,
        };
        let places = block.places();
        // Each facet of the far face hands an equal share of its load to its corners.
        let facets = facets_at_end(block);
        let area: f64 = block.size[1..].iter().product();
        let load = |freedoms: &Freedoms<D>| {
            let mut forces = vec![[0.0; D]; places.len()];
            for facet in &facets {
                for &vertex in facet {
                    forces[vertex][0] += traction * area / (facets.len() * D) as f64;
                }
            }
            DeadLoad::new(freedoms, forces)
        };
        let rest = match problem.solve(family, &block.mesh, material, &places, &load) {
            Ok(rest) => rest,
            Err(error) => return Verdict::refused(error),
        };
        let length = block.size[0];
        let error = rest.positions.iter().zip(&places).flat_map(|(got, x)| {
            (0..D).map(move |i| (got[i] - x[i] * if i == 0 { along } else { across }).abs())
        });
        let thin = length / block.size.iter().copied().fold(f64::INFINITY, f64::min);
        let promised = 1e-6 * strain.abs() * length + 1e3 * EPS * length * thin * thin;
        let verdict = Verdict::of(error.fold(0.0, f64::max), promised, "place of a vertex");
        let along = held.iter().zip(&rest.reactions).filter(|(h, _)| h.component == 0);
        let sum: f64 = along.map(|(_, f)| f).sum();
        let promised = 1e-7 * traction.abs() * area + 1e3 * EPS * block.pair().size() * area * thin;
        verdict.and(Verdict::of((sum + traction * area).abs(), promised, "reaction"))
    }
    in_plane_or_space!(draw, 3, of)
}

/// The facets of the face at the far end of the first direction, by their corners.
fn facets_at_end<const D: usize, const K: usize>(block: &Block<D, K>) -> Vec<Vec<usize>> {
    let at_end = |v: &&usize| block.mesh.vertices()[**v][0] >= (1.0 - 1e-9) * block.size[0];
    let facets = block.mesh.simplices().iter().filter_map(|nodes| {
        let facet: Vec<usize> = nodes.iter().filter(at_end).copied().collect();
        (facet.len() == D).then_some(facet)
    });
    let facets: Vec<_> = facets.collect();
    debug_assert!(facets.len() >= block.cells[1]);
    facets
}

/// A bar on a line, loaded at every vertex: the force in each piece is what is put on beyond it.
fn chain(draw: &mut Draw) -> Verdict {
    let (cells, length) = (draw.between(1, 12), draw.log_uniform(1e-6, 1e6));
    let (young, section) = (draw.log_uniform(1.0, 1e12), draw.log_uniform(1e-9, 1.0));
    let strain = draw.log_uniform(1e-9, 0.1);
    let density = draw.log_uniform(1e-3, 1e4);
    draw.note(format!("chain of {cells}, {length:e} m, E = {young:e}, section {section:e}, strains up to {strain:e}"));
    let Ok(mesh) = bar(length, cells) else { return Verdict::not_judged("no bar") };
    let Ok(lame) = Lame::<3>::from_young_poisson(young, 0.3) else {
        return Verdict::refused("moduli");
    };
    let largest = strain * young * section / cells as f64;
    let forces: Vec<f64> = draw.vector(cells + 1).into_iter().map(|f| largest * f).collect();
    let held = [Held { vertex: 0, component: 0, place: 0.0 }];
    let problem =
        Problem { held: &held, ends: &[0.0], density, section, steps: draw.between(1, 3) };
    let places = mesh.nodes();
    let load =
        |freedoms: &Freedoms<1>| DeadLoad::new(freedoms, forces.iter().map(|&f| [f]).collect());
    let material = SaintVenantKirchhoff::new(lame.uniaxial_stress());
    let rest = match problem.solve(LinearSegment, &mesh, material, &places, &load) {
        Ok(rest) => rest,
        Err(error) => return Verdict::refused(error),
    };
    let (mut place, mut worst) = (0.0, 0.0_f64);
    for cell in 0..cells {
        let pull: f64 = forces[cell + 1..].iter().sum::<f64>() / (young * section);
        // e: (1 + e) (e + e^2/2) = pull, e the strain of Cauchy.
        let mut e = pull;
        for _ in 0..50 {
            e -= ((1.0 + e) * (e + 0.5 * e * e) - pull) / (1.0 + 3.0 * e + 1.5 * e * e);
        }
        place += length / cells as f64 * e;
        worst = worst.max((rest.positions[cell + 1][0] - places[cell + 1][0] - place).abs());
    }
    let promised = 1e-6 * strain * length + 100.0 * EPS * length * (cells * cells) as f64;
    let total: f64 = forces.iter().sum();
    Verdict::of(worst, promised, "place of a vertex").and(Verdict::of(
        (rest.reactions[0] + total).abs(),
        1e-9 * largest * cells as f64 + 100.0 * EPS * young * section * cells as f64,
        "reaction",
    ))
}

/// A slender beam of quadratic triangles.
fn beam(draw: &mut Draw) -> Verdict {
    let slender = draw.log_uniform(4.0, 300.0);
    let length = draw.log_uniform(1e-6, 1e6);
    let height = length / slender;
    let young = draw.log_uniform(1.0, 1e12);
    let tilt = draw.log_uniform(1e-8, 1e-3);
    let cells = [draw.between(8, 24), draw.between(1, 3)];
    let rubber = draw.chance(0.5);
    let density = draw.log_uniform(1e-3, 1e4);
    // nu = 0: the clamp does not hold what would thin.
    let push = tilt * 3.0 * young * (height / length).powi(3) / 12.0 * height.min(length) / height;
    draw.note(format!("beam of {length:e} x {height:e} m in {cells:?}, E = {young:e}, deflected by {tilt:e} of its length, rubber: {rubber}"));
    let force = push * length;
    let Ok(mesh) = rectangle([length, height], cells, Diagonals::Alternating) else {
        return Verdict::not_judged("no mesh");
    };
    let mesh = QuadraticTriangles::straight(&mesh);
    let Ok(lame) = Lame::<2>::from_young_poisson(young, 0.0) else {
        return Verdict::refused("moduli");
    };
    let places = mesh.nodes().iter().map(|x| [x[0], x[1]]).collect::<Vec<_>>();
    let mut held = Vec::new();
    for (vertex, x) in places.iter().enumerate().filter(|(_, x)| x[0] <= 1e-9 * length) {
        held.extend((0..2).map(|component| Held { vertex, component, place: x[component] }));
    }
    let ends: Vec<f64> = held.iter().map(|h| h.place).collect();
    let problem = Problem { held: &held, ends: &ends, density, section: 1.0, steps: 1 };
    let Ok(rim) = curved_boundary(&mesh) else { return Verdict::not_judged("no rim") };
    let load = |freedoms: &Freedoms<2>| {
        DeadLoad::traction(QuadraticSegment, &rim, 1.0, freedoms, |x, _| {
            [0.0, if x[0] >= (1.0 - 1e-9) * length { force / height } else { 0.0 }]
        })
    };
    let solved = if rubber {
        match NeoHookean::<2>::new(lame) {
            Ok(rubber) => problem.solve(QuadraticTriangle, &mesh, rubber, &places, &load),
            Err(error) => Err(error),
        }
    } else {
        problem.solve(QuadraticTriangle, &mesh, Linear::<2>::new(lame), &places, &load)
    };
    let rest = match solved {
        Ok(rest) => rest,
        Err(error) => return Verdict::refused(error),
    };
    let inertia = height.powi(3) / 12.0;
    let shear = 1.2 * force * length / (0.5 * young * height);
    let expected = force * length.powi(3) / (3.0 * young * inertia) + shear;
    let tip = rest.positions.iter().zip(&places).filter(|(_, x)| x[0] >= (1.0 - 1e-9) * length);
    let tip: Vec<f64> = tip.map(|(got, x)| got[1] - x[1]).collect();
    let got = tip.iter().sum::<f64>() / tip.len() as f64;
    // Coarse cells are too stiff by some percent; large deflections by the square of the tilt.
    // Rounding of the places bends the beam by itself.
    let noise = 10.0 * EPS * length * slender.powi(2);
    let verdict = Verdict::of((got - expected).abs(), 0.03 * expected.abs() + noise, "deflection");
    let up = held.iter().zip(&rest.reactions).filter(|(h, _)| h.component == 1);
    let sum: f64 = up.map(|(_, f)| f).sum();
    let promised = 1e-6 * force + 100.0 * EPS * young * height * slender;
    verdict.and(Verdict::of((sum + force).abs(), promised, "reaction"))
}

/// Random loads and supports: what is found is at rest, and stays there.
fn any(draw: &mut Draw) -> Verdict {
    fn of<F, M, const D: usize, const K: usize>(
        draw: &mut Draw,
        block: &Block<D, K>,
        family: F,
        material: M,
    ) -> Verdict
    where
        F: Reference<K, D, 1> + Copy,
        M: Material<D, D>,
    {
        let strain = draw.log_uniform(1e-9, 0.05);
        let places = block.places();
        let mut held = Vec::new();
        for (vertex, x) in places.iter().enumerate() {
            let clamped = x[0] <= 1e-9 * block.size[0];
            let also = draw.chance(0.1);
            for component in 0..D {
                if clamped || (also && draw.chance(0.5)) {
                    held.push(Held { vertex, component, place: x[component] });
                }
            }
        }
        let area: f64 = block.size[1..].iter().product();
        let thin = block.size.iter().copied().fold(f64::INFINITY, f64::min) / block.size[0];
        let force = strain * block.lame.young() * area * thin / places.len() as f64;
        let forces: Vec<[f64; D]> = places
            .iter()
            .map(|_| {
                let f = draw.vector(D);
                std::array::from_fn(|i| force * f[i])
            })
            .collect();
        draw.note(format!("{} coordinates held, forces of {force:e} N", held.len()));
        let ends: Vec<f64> = held.iter().map(|h| h.place).collect();
        let problem = Problem {
            held: &held,
            ends: &ends,
            density: block.density,
            section: 1.0,
            steps: block.steps,
        };
        let load = |freedoms: &Freedoms<D>| DeadLoad::new(freedoms, forces.clone());
        let rest = match problem.solve(family, &block.mesh, material, &places, &load) {
            Ok(rest) => rest,
            Err(error) => return Verdict::refused(error),
        };
        let free: Vec<usize> = (0..D * places.len())
            .filter(|k| !held.iter().any(|h| D * h.vertex + h.component == *k))
            .collect();
        let body = block.body();
        let x: Vec<Vec<f64>> = rest.positions.iter().map(|x| x.to_vec()).collect();
        let f: Vec<Vec<f64>> = forces.iter().map(|f| f.to_vec()).collect();
        judge_rest(&body, &x, &f, &free, &places.iter().map(|x| x.to_vec()).collect::<Vec<_>>())
    }
    in_plane_or_space!(draw, 2, of)
}

/// Right where one more dense step of Newton's method moves nothing and the Hessian is definite.
pub fn judge_rest(
    body: &Body,
    x: &[Vec<f64>],
    forces: &[Vec<f64>],
    free: &[usize],
    before: &[Vec<f64>],
) -> Verdict {
    let Some(correction) = body.correction(x, forces, free) else {
        return Verdict::not_judged("eigenvalues");
    };
    let moved = x.iter().flatten().zip(before.iter().flatten());
    let moved = moved.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let size = before.iter().flatten().map(|x| x.abs()).fold(0.0, f64::max);
    let promised = 1e-6 * moved + 20.0 * correction.rounding + 20.0 * EPS * size;
    let verdict = Verdict::of(correction.length, promised, "distance from rest");
    if correction.least < -1e-9 {
        return Verdict::wrong(format!(
            "a saddle: the least eigenvalue is {:e} of the largest",
            correction.least
        ));
    }
    verdict
}

/// One face is moved through the opposite one: no answer, as elements turn inside out.
fn crushed(draw: &mut Draw) -> Verdict {
    fn of<F, M, const D: usize, const K: usize>(
        draw: &mut Draw,
        block: &Block<D, K>,
        family: F,
        material: M,
    ) -> Verdict
    where
        F: Reference<K, D, 1> + Copy,
        M: Material<D, D>,
    {
        let places = block.places();
        let mut held = Vec::new();
        for (vertex, x) in places.iter().enumerate() {
            if x[0] <= 1e-9 * block.size[0] || x[0] >= (1.0 - 1e-9) * block.size[0] {
                held.extend((0..D).map(|component| Held {
                    vertex,
                    component,
                    place: x[component],
                }));
            }
        }
        let way = draw.uniform(1.05, 2.0);
        let turned = rotation(draw, D);
        let turn = draw.chance(0.3);
        draw.note(format!("crushed: one face goes {way} of the length, turned: {turn}"));
        let ends: Vec<f64> = held
            .iter()
            .map(|h| {
                let x = places[h.vertex];
                if x[0] <= 1e-9 * block.size[0] {
                    return h.place;
                }
                let mut x = x;
                x[0] -= way * block.size[0];
                if turn {
                    let y: [f64; D] =
                        std::array::from_fn(|i| (0..D).map(|j| turned[j][i] * x[j]).sum());
                    x = y;
                }
                x[h.component]
            })
            .collect();
        let problem = Problem {
            held: &held,
            ends: &ends,
            density: block.density,
            section: 1.0,
            steps: block.steps,
        };
        let none = |freedoms: &Freedoms<D>| DeadLoad::new(freedoms, vec![[0.0; D]; places.len()]);
        match problem.solve(family, &block.mesh, material, &places, &none) {
            Ok(rest) => {
                let x: Vec<Vec<f64>> = rest.positions.iter().map(|x| x.to_vec()).collect();
                let least = block.body().least_volume(&x);
                // The linear law knows of no volume: its answer is the linear one.
                if least > 0.0 || block.law == Law::Linear {
                    Verdict::due()
                } else {
                    Verdict::wrong(format!("Ok with an element of {least:e} times its volume"))
                }
            }
            Err(_) => Verdict::due(),
        }
    }
    in_plane_or_space!(draw, 2, of)
}
