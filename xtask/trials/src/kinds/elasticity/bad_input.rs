//! Every public function of the crate with bad numbers, wrong sizes and what was made for something
//! else.

mod folds;
mod laws;
mod loads;
mod nets;
mod problems;
mod rest;
mod solids;

use stationary_elasticity::{Elements, Freedoms, Lame, SaintVenantKirchhoff};
use stationary_mesh::{Mesh, cuboid};

use crate::{Draw, Verdict};

/// One check of bad input.
type Check = fn(&mut Draw) -> Verdict;

pub fn trial(draw: &mut Draw) -> Verdict {
    let checks: [(&str, Check); 20] = [
        ("pairs of moduli", laws::lame),
        ("springs", nets::springs),
        ("nets", nets::nets),
        ("dampers", nets::dampers),
        ("weaves", nets::weaves),
        ("hinges", folds::hinge),
        ("sheets of hinges", folds::sheet_of_hinges),
        ("freedoms", loads::freedoms),
        ("loads", loads::loads),
        ("densities of loads", loads::densities),
        ("solids", solids::solids),
        ("masses", solids::masses),
        ("statics of bad numbers", rest::statics),
        ("statics of other supports", rest::other_supports),
        ("stresses", solids::stresses),
        ("damping", solids::damping),
        ("measures", laws::measures),
        ("materials", laws::materials),
        ("parameters", solids::parameters),
        ("problems", problems::problems),
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

/// A count: small, none, or beyond all memory.
fn count(draw: &mut Draw) -> usize {
    match draw.below(4) {
        0 => draw.between(0, 6),
        1 => 1 << draw.between(40, 63),
        2 => usize::MAX - draw.below(3),
        _ => draw.between(0, 40),
    }
}

fn small_block() -> Mesh<3, 4> {
    cuboid([1.0; 3], [1; 3]).expect("a cube")
}

fn clamped(mesh: &Mesh<3, 4>) -> Freedoms<3> {
    let places: Vec<[f64; 3]> = mesh.nodes();
    Freedoms::held_where(&places, |x, _| x[0] == 0.0).expect("places")
}

fn rubber() -> SaintVenantKirchhoff<3> {
    SaintVenantKirchhoff::new(Lame::from_young_poisson(1e4, 0.3).expect("rubber"))
}
