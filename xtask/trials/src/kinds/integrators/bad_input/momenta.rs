//! Momenta and what changes them.

use stationary_calculus::Vector;
use stationary_integrators::{
    Asymmetry, Rotation, angular_momentum, angular_momentum_scale, linear_momentum,
    linear_momentum_scale,
};

use super::{number, planet, state};
use crate::{Draw, Verdict};

pub(super) fn momenta(draw: &mut Draw) -> Verdict {
    let now = state(draw, 3);
    draw.note(format!("{now:?}"));
    let _ = linear_momentum::<1>(&now);
    let _ = linear_momentum::<2>(&now);
    let _ = linear_momentum::<3>(&now);
    let _ = angular_momentum::<1>(&now);
    let _ = angular_momentum::<2>(&now);
    let _ = angular_momentum::<3>(&now);
    let _ = linear_momentum_scale::<2>(&now) + angular_momentum_scale::<3>(&now);
    let system = planet();
    let symmetry = Rotation::<2> { axis: [0.0, 0.0, number(draw)] };
    let (q, v) = (&now.q, Vector(now.p.components()));
    let answer = Asymmetry::of_system(&system, &symmetry, q, v);
    let _ = answer.map(|asymmetry| asymmetry.relative());
    Verdict::due()
}
