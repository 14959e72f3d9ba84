//! NAFEMS LE1: a quarter of an elliptic membrane under pressure.
//!
//! ```text
//! semi-axes 2 and 1 m inside, 3.25 and 2.75 m outside, 0.1 m thick, plane stress
//! E = 210 GPa, nu = 0.3,  10 MPa outward on the outer edge, symmetry on both axes
//! sigma_yy = 92.7 MPa at the end of the inner long axis, (2, 0)
//! ```
//! The target is given to three digits. Quadratic triangles approach it from below, and what three
//! of their meshes extrapolate to agrees with it. Source: NAFEMS, The Standard NAFEMS Benchmarks
//! (1990), test LE1.

use stationary_mesh::{curved_elliptic_membrane, elliptic_membrane};

use crate::problems::cantilever::{Sheet, SheetFamily};
use crate::{
    DeadLoad, ElasticityError, Elements, Freedoms, Lame, Linear, LinearSegment, LinearTriangle,
    QuadraticSegment, QuadraticTriangle, Reference, Solid, Statics, averaged_stress,
    curved_boundary, lumped_mass, straight_boundary,
};

/// The stress that NAFEMS gives, Pa.
pub const LE1_STRESS: f64 = 92.7e6;

const PRESSURE: f64 = 10e6;
const THICKNESS: f64 = 0.1;

/// Freedoms, and the stress sigma_yy (Pa) at (2, 0), of cells outward and around.
///
/// # Errors
/// [`ElasticityError::Mesh`] for cells that make no sheet; [`ElasticityError::Statics`] where no
/// rest is found.
pub fn elliptic_membrane_stress(
    family: SheetFamily,
    cells: [usize; 2],
) -> Result<Sheet, ElasticityError> {
    match family {
        SheetFamily::Linear => {
            let mesh = elliptic_membrane(cells)?;
            let rim = straight_boundary(&mesh)?;
            stress((LinearTriangle, &mesh), (LinearSegment, &rim))
        }
        SheetFamily::Quadratic => {
            let mesh = curved_elliptic_membrane(cells)?;
            let rim = curved_boundary(&mesh)?;
            stress((QuadraticTriangle, &mesh), (QuadraticSegment, &rim))
        }
    }
}

fn stress<F, S, const N: usize, const Q: usize, const B: usize, const P: usize>(
    (family, mesh): (F, &impl Elements<2, N>),
    (edge, rim): (S, &impl Elements<2, B>),
) -> Result<Sheet, ElasticityError>
where
    F: Reference<N, 2, Q> + Copy,
    S: Reference<B, 1, P>,
{
    let nodes = mesh.nodes();
    // Nodes on an axis may slide along it only.
    let freedoms = Freedoms::held_where(&nodes, |x, component| x[component] == 0.0)?;
    let material = Linear::new(Lame::<3>::from_young_poisson(210e9, 0.3)?.plane_stress());
    let mut solid = Solid::new(family, mesh, THICKNESS, material, freedoms.clone())?;
    let load = DeadLoad::traction(edge, rim, THICKNESS, &freedoms, |x, normal| {
        let outside = (x[0] / 3.25).powi(2) + (x[1] / 2.75).powi(2) > 0.9;
        let on_axis = normal[0] < -0.999 || normal[1] < -0.999;
        let pressure = if outside && !on_axis { PRESSURE } else { 0.0 };
        normal.map(|n| pressure * n)
    })?;
    let metric = lumped_mass(family, mesh, [7.8e3, THICKNESS], &freedoms)?;
    let mut q = freedoms.gathered(&nodes)?;
    let places = freedoms.places().to_vec();
    Statics::default().solve(&mut solid, &load, &metric, &places, &mut q)?;
    let stresses = averaged_stress(family, mesh, &material, &freedoms.positions(&q)?)?;
    let corner = nodes.iter().position(|x| *x == [2.0, 0.0]).unwrap_or(0);
    Ok(Sheet { freedoms: freedoms.dim(), value: stresses[corner][1][1] })
}
