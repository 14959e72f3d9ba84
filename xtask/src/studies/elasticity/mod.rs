//! Elastic bodies: the order of their elements, published answers, and where methods give way.

mod compression;
mod dispersion;
mod explicit_limit;
mod factor_or_iterate;
mod orders;
mod sheets;
mod slinky;
mod slivers;

pub use compression::STUDY as COMPRESSION;
pub use dispersion::STUDY as DISPERSION;
pub use explicit_limit::STUDY as EXPLICIT_LIMIT;
pub use factor_or_iterate::STUDY as FACTOR_OR_ITERATE;
pub use orders::STUDY as ORDERS;
pub use sheets::{CANTILEVER, LOCKING, MEMBRANE};
pub use slinky::STUDY as SLINKY;
pub use slivers::STUDY as SLIVERS;
