//! Energy, stress and second derivative of each law, from tiny strains to huge ones.
//!
//! ```text
//! F = I + G,  |G| = 1e-12 ... 1e2;    pressure = M |J - 1|,  s = 1 + 1/(sum of the two least stretches)
//! |dW| <= C eps (W + |P| |G| + pressure (|G| + |G|^3))
//! |dP| <= C eps (|P| + M |G| (1 + |G|)^4 s),       |dK| <= C eps M (1 + |G|)^4 s^2
//! ```
//! `C = 40`: what a few roundings of G make of them, near rest as well as turned and torn. The
//! referee takes derivatives of textbook formulas with 32 digits.

use stationary_elasticity::{
    AutomaticMaterial, Density, FixedCorotated, FullTangent, Lame, Lanes, Linear, Material,
    NeoHookean, Orthotropic, Real, SaintVenantKirchhoff, Spring, Strain, Weave,
};

use super::field::{Field, Hyper, Pair};
use super::law::{
    Columns, Law, Moduli, density, derivatives, determinant, growth, stress, twice_green,
};
use super::shapes::rotation;
use crate::{Draw, Verdict};

const EPS: f64 = f64::EPSILON;
/// Roundings that are forgiven.
const ROUNDINGS: f64 = 40.0;

pub fn trial(draw: &mut Draw) -> Verdict {
    match draw.below(8) {
        0..=3 => isotropic(draw),
        4 => bar_or_membrane(draw),
        5 => woven(draw),
        6 => spring(draw),
        _ => own(draw),
    }
}

/// A pair of moduli, from nearly incompressible to auxetic.
pub fn moduli(draw: &mut Draw, lowest: f64) -> (f64, f64) {
    let young = draw.log_uniform(1.0, 1e12);
    let poisson = match draw.below(4) {
        0 => 0.3,
        1 => draw.uniform(0.0, 0.49),
        2 => 0.5 - draw.log_uniform(1e-6, 1e-1),
        _ => draw.uniform(lowest, 0.0),
    };
    (young, poisson)
}

/// A displacement gradient, D x R by columns, and F, of which every entry is a double.
fn deformation(draw: &mut Draw, d: usize, r: usize) -> Columns<f64> {
    let size = draw.log_uniform(1e-12, 1e2);
    let mut g: Columns<f64> = (0..r).map(|_| draw.vector(d)).collect();
    match draw.below(6) {
        0 => {}
        1 => {
            for k in 0..r {
                for l in 0..k {
                    g[k][l] = g[l][k];
                }
            }
        }
        // A turn to first order.
        2 => {
            for k in 0..r {
                for l in 0..=k {
                    g[k][l] = if k == l { 0.0 } else { -g[l][k] };
                }
            }
        }
        3 => {
            let growth = g[0][0];
            for (k, column) in g.iter_mut().enumerate() {
                column.fill(0.0);
                column[k] = growth;
            }
        }
        4 => {
            let (k, i) = (draw.below(r), draw.below(d));
            let entry = g[k][i];
            g.iter_mut().for_each(|column| column.fill(0.0));
            g[k][i] = entry;
        }
        // Stretches of one volume.
        _ => {
            for (k, column) in g.iter_mut().enumerate() {
                let entry = column[k];
                column.fill(0.0);
                column[k] = entry;
            }
            if r > 1 {
                g[1][1] = -g[0][0] / (1.0 + size * g[0][0]);
            }
        }
    }
    let mut f: Columns<f64> =
        g.into_iter().map(|c| c.into_iter().map(|x| size * x).collect()).collect();
    for (k, column) in f.iter_mut().enumerate() {
        column[k] += 1.0;
    }
    if draw.chance(0.3) {
        let turn = rotation(draw, d);
        for column in &mut f {
            *column = (0..d).map(|i| (0..d).map(|j| turn[j][i] * column[j]).sum()).collect();
        }
    }
    draw.note(format!("gradient of size {size:.2e}, F by columns {f:?}"));
    f
}

fn norm(a: &[Vec<f64>]) -> f64 {
    a.iter().flatten().map(|x| x * x).sum::<f64>().sqrt()
}

/// What is promised.
struct Bounds {
    modulus: f64,
    beyond: f64,
    /// One over the sum of the two least stretches, for laws that turn along with the body.
    turning: f64,
    pressure: f64,
}

impl Bounds {
    fn new(f: &[Vec<f64>], modulus: f64, pressure: f64, turning: f64) -> Self {
        let mut g = f.to_vec();
        for (k, column) in g.iter_mut().enumerate() {
            column[k] -= 1.0;
        }
        Bounds { modulus, beyond: norm(&g), turning, pressure }
    }

    fn energy(&self, energy: f64, stress: f64) -> f64 {
        let x = self.beyond;
        // A strain that is rounding has an energy that is its square.
        let rounding = 4.0 * self.modulus * EPS * EPS * (1.0 + x).powi(4);
        ROUNDINGS * EPS * (energy + stress * x + self.pressure * (x + x * x * x)) + rounding
    }

    fn stress(&self, stress: f64) -> f64 {
        let x = self.beyond;
        ROUNDINGS * EPS * (stress + self.modulus * x * (1.0 + x).powi(4) * (1.0 + self.turning))
    }

    fn tangent(&self) -> f64 {
        let turning = (1.0 + self.turning).powi(2);
        ROUNDINGS * EPS * self.modulus * (1.0 + self.beyond).powi(4) * turning
    }
}

/// F in a lane among others.
fn lanes<const D: usize, const R: usize>(
    draw: &mut Draw,
    f: &[[f64; D]; R],
) -> ([[Lanes; D]; R], usize) {
    let place = draw.below(4);
    let others = draw.log_uniform(1e-9, 10.0);
    let other: Vec<f64> = draw.vector(D * R);
    let lanes = std::array::from_fn(|k| {
        std::array::from_fn(|i| {
            let rest = if k == i { 1.0 } else { 0.0 };
            let mut numbers = [rest, rest + others * other[D * k + i], 2.0 * rest, rest];
            numbers[place] = f[k][i];
            Lanes::from(numbers)
        })
    });
    (lanes, place)
}

/// Judges a material against its density.
fn judge<M, const D: usize, const R: usize>(
    draw: &mut Draw,
    material: &M,
    f: &Columns<f64>,
    bounds: &Bounds,
    of: impl Fn(&Columns<Hyper<Pair>>) -> Hyper<Pair>,
) -> Verdict
where
    M: Material<D, R>,
{
    let columns: [[f64; D]; R] = std::array::from_fn(|k| std::array::from_fn(|i| f[k][i]));
    let (wide, place) = lanes(draw, &columns);
    let directions: [Columns<f64>; 2] = [(); 2].map(|()| (0..R).map(|_| draw.vector(D)).collect());
    let exact = derivatives::<Pair>(f, [&directions[0], &directions[1]], &of);
    let exact_stress = stress::<Pair>(f, &of);
    let size = norm(&exact_stress);

    let energy = exact.value.near();
    let mut verdict = Verdict::due();
    for got in [material.energy::<Lanes>(&wide).lane(place), material.energy(&columns)] {
        let promised = bounds.energy(energy, size);
        verdict = verdict.and(Verdict::of((got - energy).abs(), promised, "energy"));
    }
    for got in [material.stress(&wide).map(|c| c.map(|x| x.lane(place))), material.stress(&columns)]
    {
        let got: Columns<f64> = got.iter().map(|column| column.to_vec()).collect();
        let error = got.iter().flatten().zip(exact_stress.iter().flatten());
        let error = error.map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        verdict = verdict.and(Verdict::of(error, bounds.stress(size), "stress"));
    }
    let tangent = FullTangent::of(&material.tangent(&columns, 1.0));
    let mut product = 0.0;
    for (l, entries) in tangent.0.iter().enumerate() {
        for (j, entries) in entries.iter().enumerate() {
            for (k, entries) in entries.iter().enumerate() {
                for (i, entry) in entries.iter().enumerate() {
                    product += directions[0][k][i] * entry * directions[1][l][j];
                }
            }
        }
    }
    let error = (product - exact.both.near()).abs();
    let scale = norm(&directions[0]) * norm(&directions[1]);
    verdict.and(Verdict::of(error, scale * bounds.tangent(), "second derivative"))
}

/// One over the sum of the two least stretches.
fn turning(f: &Columns<f64>) -> f64 {
    let (d, r) = (f[0].len(), f.len());
    let matrix = nalgebra::DMatrix::from_fn(d, r, |i, k| f[k][i]);
    let mut s: Vec<f64> = matrix.singular_values().iter().copied().collect();
    s.sort_by(f64::total_cmp);
    if determinant(f) < 0.0 {
        s[0] = -s[0];
    }
    1.0 / (s[0] + s[1]).abs()
}

fn isotropic(draw: &mut Draw) -> Verdict {
    let law = draw.one_of(&Law::ALL);
    let d = draw.between(2, 3);
    let (young, poisson) = moduli(draw, -0.9);
    let f = deformation(draw, d, d);
    draw.note(format!("{law:?} in {d} dimensions, E = {young:e}, nu = {poisson}"));
    if d == 2 {
        isotropic_of::<2>(draw, law, [young, poisson], &f)
    } else {
        isotropic_of::<3>(draw, law, [young, poisson], &f)
    }
}

fn isotropic_of<const D: usize>(
    draw: &mut Draw,
    law: Law,
    [young, poisson]: [f64; 2],
    f: &Columns<f64>,
) -> Verdict {
    let lame = match Lame::<D>::from_young_poisson(young, poisson) {
        Ok(lame) => lame,
        Err(error) => return Verdict::refused(error),
    };
    let pair = Moduli { lambda: lame.lambda(), mu: lame.mu() };
    let grown =
        growth::<Pair>(&f.iter().map(|c| c.iter().map(|&x| Pair::of(x)).collect()).collect());
    let pressure = match law {
        Law::NeoHookean | Law::Corotated => pair.size() * grown.near().abs(),
        _ => 0.0,
    };
    let turns = if law == Law::Corotated { turning(f) } else { 0.0 };
    let bounds = Bounds::new(f, pair.size(), pressure, turns);
    let of = |f: &Columns<Hyper<Pair>>| density(law, pair, f);
    match law {
        Law::Linear => judge(draw, &Linear::<D>::new(lame), f, &bounds, of),
        Law::Quadratic => judge::<_, D, D>(draw, &SaintVenantKirchhoff::new(lame), f, &bounds, of),
        Law::NeoHookean => match NeoHookean::<D>::new(lame) {
            Ok(material) => judge(draw, &material, f, &bounds, of),
            // No lower bound: lambda + mu <= 2 mu/(d (d + 1)).
            Err(_)
                if pair.lambda + pair.mu * (1.0 - 2.0 / (D as f64 * (D as f64 + 1.0))) <= 0.0 =>
            {
                Verdict::due()
            }
            Err(error) => Verdict::refused(error),
        },
        Law::Corotated => match FixedCorotated::<D>::new(lame) {
            Ok(_) if D == 3 && determinant(f) <= 0.0 => {
                Verdict::due() // the referee's iteration finds a reflection
            }
            Ok(material) => judge(draw, &material, f, &bounds, of),
            Err(_) if pair.lambda < 0.0 => Verdict::due(),
            Err(error) => Verdict::refused(error),
        },
    }
}

fn bar_or_membrane(draw: &mut Draw) -> Verdict {
    let (young, poisson) = moduli(draw, -0.9);
    let lame = match Lame::<3>::from_young_poisson(young, poisson) {
        Ok(lame) => lame,
        Err(error) => return Verdict::refused(error),
    };
    fn of<const D: usize, const R: usize>(draw: &mut Draw, lame: Lame<R>) -> Verdict {
        let f = deformation(draw, D, R);
        draw.note(format!("quadratic, {R} dimensions in {D}, {lame:?}"));
        let pair = Moduli { lambda: lame.lambda(), mu: lame.mu() };
        let bounds = Bounds::new(&f, pair.size(), 0.0, 0.0);
        let material = SaintVenantKirchhoff::new(lame);
        judge::<_, D, R>(draw, &material, &f, &bounds, |f| density(Law::Quadratic, pair, f))
    }
    match draw.below(4) {
        0 => of::<3, 2>(draw, lame.plane_stress()),
        1 => of::<3, 1>(draw, lame.uniaxial_stress()),
        2 => of::<2, 1>(draw, lame.uniaxial_stress()),
        _ => of::<1, 1>(draw, lame.uniaxial_stress()),
    }
}

fn woven(draw: &mut Draw) -> Verdict {
    let (warp, weft) = (draw.log_uniform(1.0, 1e9), draw.log_uniform(1.0, 1e9));
    let poisson = draw.symmetric() * (warp / weft).sqrt() * 0.99;
    let angle = draw.uniform(-4.0, 4.0);
    let weave = Weave { warp, weft, poisson, shear: draw.log_uniform(1.0, 1e9), angle };
    draw.note(format!("{weave:?}"));
    let material = match Orthotropic::new(weave) {
        Ok(material) => material,
        Err(error) => return Verdict::refused(error),
    };
    let one =
        Pair::of(1.0) - Pair::of(poisson) * Pair::of(poisson) * Pair::of(weft) / Pair::of(warp);
    let (c11, c22) = (Pair::of(warp) / one, Pair::of(weft) / one);
    let c12 = Pair::of(poisson) * c22;
    // The angle's cosine and sine are doubles there; their squares add up to one but for rounding.
    let of = move |f: &Columns<Hyper<Pair>>| {
        let c = twice_green(f);
        let half = Hyper::<Pair>::of(0.5);
        let (x, y) = (Hyper::of(angle.cos()), Hyper::of(angle.sin()));
        let twice = Hyper::of(2.0);
        let s11 = half * (x * x * c[0][0] + twice * x * y * c[0][1] + y * y * c[1][1]);
        let s22 = half * (y * y * c[0][0] - twice * x * y * c[0][1] + x * x * c[1][1]);
        let s12 = half * ((x * x - y * y) * c[0][1] + x * y * (c[1][1] - c[0][0]));
        let [c11, c12, c22] = [c11, c12, c22].map(Hyper::constant);
        half * (c11 * s11 * s11 + twice * c12 * s11 * s22 + c22 * s22 * s22)
            + twice * Hyper::of(weave.shear) * s12 * s12
    };
    let size = c11.near().max(c22.near()).max(weave.shear);
    let mut of_space = |flat: bool| {
        let f = deformation(draw, if flat { 2 } else { 3 }, 2);
        let bounds = Bounds::new(&f, size, 0.0, 0.0);
        // Strains of one thread have the roundings of the other's modulus.
        let bounds = Bounds { pressure: size * norm_of_strain(&f), ..bounds };
        if flat {
            judge::<_, 2, 2>(draw, &material, &f, &bounds, of)
        } else {
            judge::<_, 3, 2>(draw, &material, &f, &bounds, of)
        }
    };
    let verdict = of_space(true);
    verdict.and(of_space(false))
}

fn norm_of_strain(f: &Columns<f64>) -> f64 {
    let f: Columns<Pair> = f.iter().map(|c| c.iter().map(|&x| Pair::of(x)).collect()).collect();
    let c = twice_green(&f);
    norm(&c.iter().map(|c| c.iter().map(|x| x.near()).collect()).collect::<Vec<_>>())
}

/// A spring from its rest length to a hundred times that.
fn spring(draw: &mut Draw) -> Verdict {
    use stationary_calculus::{Curvature, Stencil};
    let (length, stiffness) = (draw.log_uniform(1e-6, 1e6), draw.log_uniform(1.0, 1e12));
    let strain = draw.one_of(&[Strain::Cauchy, Strain::Green]);
    let mut stretch = draw.log_uniform(1e-12, 1e2);
    if draw.chance(0.5) && stretch < 1.0 {
        stretch = -stretch;
    }
    let direction = rotation(draw, 3)[0].clone();
    let slanted = draw.chance(0.5);
    let x: [f64; 3] = std::array::from_fn(|i| {
        let along = if slanted { direction[i] } else { f64::from(i == 0) };
        length * (1.0 + stretch) * along
    });
    draw.note(format!("{strain:?} spring of {length:e} m, {stiffness:e} N/m, ends {x:?} apart"));
    let spring = match Spring::new([0, 1], length, stiffness, strain) {
        Ok(spring) => spring,
        Err(error) => return Verdict::refused(error),
    };
    let of = |x: &Columns<Hyper<Pair>>| {
        let square = x[0].iter().fold(Hyper::<Pair>::of(0.0), |sum, &x| sum + x * x);
        let (l, k, half) = (Hyper::of(length), Hyper::of(stiffness), Hyper::of(0.5));
        match strain {
            Strain::Cauchy => {
                let beyond = square.root() - l;
                half * k * beyond * beyond
            }
            Strain::Green => {
                let eps = half * (square - l * l) / (l * l);
                half * k * l * l * eps * eps
            }
        }
    };
    let f = vec![x.to_vec()];
    let directions = [draw.vector(3), draw.vector(3)].map(|v| vec![v]);
    let exact = derivatives::<Pair>(&f, [&directions[0], &directions[1]], of);
    let tension = norm(&stress::<Pair>(&f, of));
    let ends = [[0.0; 3], x];
    let now = norm(&f);
    // A few roundings of the places.
    let energy = exact.value.near();
    let promised = 20.0 * EPS * (energy + tension * now + EPS * stiffness * now * now);
    let verdict = Verdict::of((spring.energy(&ends) - energy).abs(), promised, "energy");
    let curvature = stiffness * (1.0 + length / now + (now / length).powi(2));
    let got = spring.differential(&ends)[1];
    let got: f64 = got.iter().zip(&directions[0][0]).map(|(a, b)| a * b).sum();
    let promised = 20.0 * EPS * (tension + curvature * now);
    let verdict = verdict.and(Verdict::of((got - exact.first.near()).abs(), promised, "force"));
    let block = spring.hessian(&ends, Curvature::Exact)[1];
    let mut product = 0.0;
    for (d, column) in block.iter().enumerate() {
        for (c, entry) in column[1].iter().enumerate() {
            product += directions[0][0][c] * entry * directions[1][0][d];
        }
    }
    let error = (product - exact.both.near()).abs();
    verdict.and(Verdict::of(error, 60.0 * EPS * curvature, "second derivative"))
}

/// A density of one's own, which grows linearly in Green's strain: no cancellation is to be had.
#[derive(Clone, Copy)]
struct Swelling {
    modulus: f64,
}

impl Density<3, 3> for Swelling {
    fn density<N: stationary_calculus::Number>(&self, f: [[N; 3]; 3]) -> N {
        let mut sum = N::from(0.0);
        for entry in f.iter().flatten() {
            sum += *entry * *entry;
        }
        (sum * sum + 1.0).sqrt() * self.modulus
    }
}

fn own(draw: &mut Draw) -> Verdict {
    let material = AutomaticMaterial(Swelling { modulus: draw.log_uniform(1.0, 1e12) });
    let f = deformation(draw, 3, 3);
    let modulus = material.0.modulus;
    let bounds = Bounds::new(&f, modulus, 0.0, 0.0);
    let bounds = Bounds { beyond: bounds.beyond + 1.0, ..bounds };
    judge(draw, &material, &f, &bounds, |f| {
        let sum = f.iter().flatten().fold(Hyper::<Pair>::of(0.0), |sum, &x| sum + x * x);
        (sum * sum + Hyper::of(1.0)).root() * Hyper::of(modulus)
    })
}
