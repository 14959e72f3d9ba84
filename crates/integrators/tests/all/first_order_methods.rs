//! The methods that choose their own steps, made alike.

use stationary_calculus::Storage;
use stationary_integrators::{
    AdaptiveMethod, BackwardDifferences, DormandPrince54, DormandPrince853, Moment, RadauIia5,
    StepControl, Tolerance, VectorField,
};

/// The same tolerance, absolute and relative.
pub fn control(tolerance: f64) -> StepControl {
    Tolerance::new(tolerance, tolerance).unwrap().into()
}

/// DOP853, Radau, BDF and DOPRI5 on a field, from the same moment.
pub fn all<'f, F: VectorField, C: Storage + 'f>(
    field: &'f F,
    control: &StepControl,
    start: &Moment<C>,
) -> [Box<dyn AdaptiveMethod<C> + 'f>; 4] {
    let (control, start) = (|| control.clone(), || start.clone());
    [
        Box::new(DormandPrince853::new(field, control(), start()).unwrap()),
        Box::new(RadauIia5::new(field, control(), start()).unwrap()),
        Box::new(BackwardDifferences::new(field, control(), start()).unwrap()),
        Box::new(DormandPrince54::new(field, control(), start()).unwrap()),
    ]
}
