//! Moduli, measures of strain and materials of bad numbers.

use stationary_elasticity::{
    AutomaticMaterial, Density, FixedCorotated, FullTangent, Lame, Linear, Material, Measure,
    NeoHookean, cauchy,
};

use super::{finite, rubber};
use crate::{Draw, Verdict};

pub fn lame(draw: &mut Draw) -> Verdict {
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

pub fn measures(draw: &mut Draw) -> Verdict {
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

pub fn materials(draw: &mut Draw) -> Verdict {
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
