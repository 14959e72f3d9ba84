//! Rows of all laws, joints' and contacts', between things that answer to impulses.

pub(crate) mod response;
pub(crate) mod row_laws;
pub(crate) mod row_sweeps;
pub(crate) mod dense_factor;
pub(crate) mod set_equations;
pub(crate) mod interior_point;
pub(crate) mod reduced_rows;
pub(crate) mod lemke;
pub(crate) mod coupled_rows;
pub(crate) mod equalities;
pub(crate) mod rows_solver;

#[cfg(test)]
mod tests;
