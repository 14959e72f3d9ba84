//! Cauchy's stress at the nodes of uniformly strained bodies, and the sheet that is free to thin.
//!
//! ```text
//! sigma = P F^T / J          of the linear law  2 mu e + lambda tr e I, which knows no F^T and no J
//! sheet  min over F_33 of W of the solid = W of the sheet in plane stress
//! ```
//! The families of elements are the crate's and two of the trial's own, with points where the crate
//! has none.

use stationary_elasticity::{
    Elements, FixedCorotated, FreeToThin, Lame, Linear, LinearTetrahedron, LinearTriangle,
    Material, NeoHookean, QuadraticTriangle, Reference, SaintVenantKirchhoff, averaged_stress,
};
use stationary_mesh::{Diagonals, QuadraticTriangles, cuboid, rectangle};

use super::field::{Field, Hyper, Pair};
use super::law::{Columns, Law, Moduli, density, determinant, stress, with_material};
use super::materials::moduli;
use super::shapes::rotation;
use crate::{Draw, Verdict};

/// A linear triangle with points of the trial's choice: no reason to have one at each corner.
macro_rules! own_triangle {
    ($name:ident, $count:literal, $points:expr) => {
        #[derive(Clone, Copy)]
        struct $name;

        impl Reference<3, 2, $count> for $name {
            const POINTS: [([f64; 2], f64); $count] = $points;
            const NODES: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
            const DEGREE: usize = 1;

            fn functions(l: &[f64; 2]) -> [f64; 3] {
                [1.0 - l[0] - l[1], l[0], l[1]]
            }

            fn gradients(_: &[f64; 2]) -> [[f64; 2]; 3] {
                [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]
            }

            fn rule(degree: usize) -> Vec<([f64; 2], f64)> {
                <LinearTriangle as Reference<3, 2, 1>>::rule(degree)
            }
        }
    };
}

const THIRD: f64 = 1.0 / 3.0;
own_triangle!(TwoPoints, 2, [([0.25, 0.25], 0.25), ([0.5, 0.25], 0.25)]);
own_triangle!(
    MidEdges,
    3,
    [([0.5, 0.0], THIRD / 2.0), ([0.5, 0.5], THIRD / 2.0), ([0.0, 0.5], THIRD / 2.0)]
);
own_triangle!(
    FourPoints,
    4,
    [
        ([THIRD, THIRD], -0.281_25),
        ([0.2, 0.2], 0.260_416_666_666_666_7),
        ([0.6, 0.2], 0.260_416_666_666_666_7),
        ([0.2, 0.6], 0.260_416_666_666_666_7)
    ]
);

pub fn trial(draw: &mut Draw) -> Verdict {
    if draw.chance(0.3) {
        return thinning(draw);
    }
    let law = draw.one_of(&Law::ALL);
    let (young, poisson) = moduli(draw, 0.0);
    let size = draw.log_uniform(1e-6, 1e6);
    let strain = draw.log_uniform(1e-9, 0.4);
    draw.note(format!("{law:?}, E = {young:e}, nu = {poisson}, {size:e} m, strain {strain:e}"));
    if draw.chance(0.4) {
        let Ok(lame) = Lame::<3>::from_young_poisson(young, poisson) else {
            return Verdict::refused("moduli");
        };
        let Ok(mesh) = cuboid([size, 0.7 * size, 0.4 * size], [draw.between(1, 2), 1, 1]) else {
            return Verdict::not_judged("no mesh");
        };
        return with_material!(law, lame, 3, m => uniform(draw, (law, lame), LinearTetrahedron, &mesh, &m, strain));
    }
    let Ok(lame) = Lame::<2>::from_young_poisson(young, poisson) else {
        return Verdict::refused("moduli");
    };
    let Ok(mesh) =
        rectangle([size, 0.6 * size], [draw.between(1, 3), draw.between(1, 2)], Diagonals::Same)
    else {
        return Verdict::not_judged("no mesh");
    };
    let quadratic = QuadraticTriangles::straight(&mesh);
    let family = draw.below(5);
    draw.note(format!("family {family}"));
    with_material!(law, lame, 2, m => match family {
        0 => uniform(draw, (law, lame), LinearTriangle, &mesh, &m, strain),
        1 => uniform(draw, (law, lame), QuadraticTriangle, &quadratic, &m, strain),
        2 => uniform(draw, (law, lame), TwoPoints, &mesh, &m, strain),
        3 => uniform(draw, (law, lame), MidEdges, &mesh, &m, strain),
        _ => uniform(draw, (law, lame), FourPoints, &mesh, &m, strain),
    })
}

fn uniform<F, M, const N: usize, const D: usize, const Q: usize>(
    draw: &mut Draw,
    (law, lame): (Law, Lame<D>),
    family: F,
    mesh: &impl Elements<D, N>,
    material: &M,
    strain: f64,
) -> Verdict
where
    F: Reference<N, D, Q>,
    M: Material<D, D>,
{
    let mut f: Columns<f64> =
        (0..D).map(|_| draw.vector(D).iter().map(|x| strain * x / 2.0).collect()).collect();
    for (k, column) in f.iter_mut().enumerate() {
        column[k] += 1.0;
    }
    if draw.chance(0.3) {
        let turn = rotation(draw, D);
        f = f
            .iter()
            .map(|c| (0..D).map(|i| (0..D).map(|j| turn[j][i] * c[j]).sum()).collect())
            .collect();
    }
    draw.note(format!("F by columns {f:?}"));
    let nodes = mesh.nodes();
    let positions: Vec<[f64; D]> = nodes
        .iter()
        .map(|x| std::array::from_fn(|i| (0..D).map(|k| f[k][i] * x[k]).sum()))
        .collect();
    let pair = Moduli { lambda: lame.lambda(), mu: lame.mu() };
    let p = stress::<Pair>(&f, |f: &Columns<Hyper<Pair>>| density(law, pair, f));
    let volume = determinant(&f);
    let expected = |j: usize, i: usize| match law {
        Law::Linear => p[j][i],
        _ => (0..D).map(|k| p[k][i] * f[k][j]).sum::<f64>() / volume,
    };
    let got = match averaged_stress(family, mesh, material, &positions) {
        Ok(got) => got,
        Err(error) => return Verdict::refused(error),
    };
    let mut worst = 0.0_f64;
    for sigma in &got {
        for j in 0..D {
            for i in 0..D {
                let error = (sigma[j][i] - expected(j, i)).abs();
                worst = if error.is_nan() { f64::NAN } else { worst.max(error) };
                if worst.is_nan() {
                    return Verdict::wrong("stress is not a number");
                }
            }
        }
    }
    let largest = p.iter().flatten().map(|x| x.abs()).fold(0.0, f64::max);
    Verdict::of(worst, 1e-10 * largest + 1e3 * f64::EPSILON * pair.size(), "stress at a node")
}

/// A sheet stretched in its plane, free to thin: the least energy of the solid over the stretch
/// across.
fn thinning(draw: &mut Draw) -> Verdict {
    let law = draw.one_of(&[Law::Quadratic, Law::NeoHookean]);
    let (young, poisson) = moduli(draw, 0.0);
    let strain = draw.log_uniform(1e-6, 0.5);
    let Ok(solid) = Lame::<3>::from_young_poisson(young, poisson) else {
        return Verdict::refused("moduli");
    };
    let mut f: Columns<f64> =
        (0..2).map(|_| draw.vector(2).iter().map(|x| strain * x).collect()).collect();
    f[0][0] += 1.0;
    f[1][1] += 1.0;
    draw.note(format!("{law:?} sheet, E = {young:e}, nu = {poisson}, F by columns {f:?}"));
    let pair = Moduli { lambda: solid.lambda(), mu: solid.mu() };
    let whole = |across: Hyper<Pair>| -> Hyper<Pair> {
        let entry = |k: usize, i: usize| Hyper::of(f[k][i]);
        let zero = Hyper::<Pair>::of(0.0);
        let f = vec![
            vec![entry(0, 0), entry(0, 1), zero],
            vec![entry(1, 0), entry(1, 1), zero],
            vec![zero, zero, across],
        ];
        density(law, pair, &f)
    };
    let at = |across: Pair| {
        let one = Pair::of(1.0);
        whole(Hyper { value: across, first: one, second: one, both: Pair::of(0.0) })
    };
    let mut across = Pair::of(1.0);
    for _ in 0..200 {
        let w = at(across);
        let step = if w.both.near() > 0.0 {
            w.first / w.both
        } else {
            Pair::of(0.1 * w.first.near().signum())
        };
        across = across - step;
    }
    let (expected, rest) = (at(across), across.near());
    // A quadratic solid that is strained far has its least energy at no thickness at all.
    if rest <= 1e-6
        || expected.first.near().abs() > 1e-20 * pair.size()
        || expected.both.near() <= 0.0
    {
        return Verdict::not_judged("no least thickness");
    }
    let columns: [[f64; 2]; 2] = [[f[0][0], f[0][1]], [f[1][0], f[1][1]]];
    let got = match law {
        Law::Quadratic => Material::<2, 2>::energy::<f64>(
            &SaintVenantKirchhoff::new(solid.plane_stress()),
            &columns,
        ),
        // In two dimensions with the pair of plane stress it is that sheet for small strains only.
        _ => match NeoHookean::<3>::new(solid) {
            Ok(material) => FreeToThin(material).energy(&columns),
            Err(error) => return Verdict::refused(error),
        },
    };
    let expected = expected.value.near();
    Verdict::of((got - expected).abs(), 1e-9 * expected, "energy of a sheet free to thin")
}
