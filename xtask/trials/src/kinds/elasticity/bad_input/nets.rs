//! Springs, nets, dampers and weaves of bad numbers.

use stationary_calculus::{Covector, Curvature, Force, Stencil, Vector};
use stationary_elasticity::{
    Damper, Dampers, Material, Net, Orthotropic, Spring, Strain, Weave, net,
};

use super::{count, finite};
use crate::{Draw, Verdict};

pub fn springs(draw: &mut Draw) -> Verdict {
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

pub fn nets(draw: &mut Draw) -> Verdict {
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

pub fn dampers(draw: &mut Draw) -> Verdict {
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

pub fn weaves(draw: &mut Draw) -> Verdict {
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
