//! What can be wrong with a spring or a net.

/// A spring or a net that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SpringError {
    /// Both ends are the same vertex.
    #[error("both ends of the spring are vertex {0}")]
    Loop(usize),
    /// A stiffness must be positive and finite.
    #[error("the stiffness is {0} N/m; it must be positive and finite")]
    Stiffness(f64),
    /// A rest length must be finite, and positive or, for Cauchy strain, zero.
    #[error("the rest length is {0} m; it must be finite and positive, or zero with Cauchy strain")]
    RestLength(f64),
    /// A net needs two rows and two columns.
    #[error("a net of {rows} x {columns} vertices has no cells; each side needs at least two")]
    NetSize {
        /// Vertices down.
        rows: usize,
        /// Vertices across.
        columns: usize,
    },
}
