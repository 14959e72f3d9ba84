//! The boundary of curved elements: where loads are put and supports are found.
//!
//! ```text
//! edge (a, b) of a triangle, node m in its middle   ->   segment (a, b, m), surface on its left
//! ```
//! Nodes keep their numbers, so that boundary and body share one numbering of freedoms.

use stationary_mesh::{Mesh, QuadraticSegments, QuadraticTriangles};

use crate::ElasticityError;

/// The boundary of a curved sheet, counterclockwise around it, over the nodes of the sheet.
///
/// # Errors
/// None of a valid sheet; [`ElasticityError::Mesh`] would say what is wrong with it.
pub fn curved_boundary<const D: usize>(
    sheet: &QuadraticTriangles<D>,
) -> Result<QuadraticSegments<D>, ElasticityError> {
    let corners = sheet.elements().iter().map(|e| [e[0], e[1], e[2]]).collect();
    let straight = Mesh::new(sheet.nodes().to_vec(), corners)?;
    let mut middles: Vec<([usize; 2], usize)> = Vec::with_capacity(3 * sheet.elements().len());
    for e in sheet.elements() {
        middles.extend([([e[0], e[1]], e[3]), ([e[1], e[2]], e[4]), ([e[2], e[0]], e[5])]);
    }
    middles.sort_unstable();
    let curved = straight.boundary_facets().into_iter().filter_map(|ends| {
        let place = middles.binary_search_by_key(&ends, |middle| middle.0).ok()?;
        Some([ends[0], ends[1], middles[place].1])
    });
    Ok(QuadraticSegments::new(sheet.nodes().to_vec(), curved.collect())?)
}

/// The straight boundary of a sheet, counterclockwise around it, over the vertices of the sheet.
///
/// # Errors
/// None of a valid mesh: its edges name vertices that are there, each once.
pub fn straight_boundary<const D: usize>(
    sheet: &Mesh<D, 3>,
) -> Result<Mesh<D, 2>, ElasticityError> {
    Ok(Mesh::new(sheet.vertices().to_vec(), sheet.boundary_facets())?)
}
