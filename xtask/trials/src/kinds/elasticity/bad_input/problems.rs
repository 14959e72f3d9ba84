//! The problems with known answers, of bad sizes.

use stationary_elasticity::problems::{
    Beam, BeamTheory, Ends, SheetFamily, bar_frequencies, elliptic_membrane_stress,
    sliding_block_frequencies,
};
use stationary_elasticity::{
    Lame, LinearSegment, QuadraticSegment, QuadraticTriangle, curved_boundary, straight_boundary,
};
use stationary_mesh::{Diagonals, QuadraticTriangles, rectangle};

use super::finite;
use crate::{Draw, Verdict};

pub fn problems(draw: &mut Draw) -> Verdict {
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
