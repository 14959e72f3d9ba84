//! The order of a small piece: faer's approximate minimum degree.

use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::graph::Graph;
use crate::sparse::SparseError;
use crate::sparse::cholesky::analysis_error;
use crate::sparse::scratch::Scratch;

/// The nodes of a graph in an order of elimination.
pub(super) fn minimum_degree(graph: &Graph) -> Result<Vec<u32>, SparseError> {
    let n = graph.len();
    let mut rows = graph.ends.clone();
    for ends in graph.starts.windows(2) {
        rows[ends[0] as usize..ends[1] as usize].sort_unstable();
    }
    let columns = SymbolicSparseColMatRef::new_checked(n, n, &graph.starts, None, &rows);
    let mut scratch = Scratch::new(n, &[amd::order_scratch::<u32>(n, rows.len())])?;
    let (mut order, mut places) = (vec![0; n], vec![0; n]);
    amd::order(&mut order, &mut places, columns, amd::Control::default(), scratch.stack())
        .map_err(|error| analysis_error(n, error))?;
    Ok(order)
}
