//! Elastic bodies: the order of their elements, published answers, and where methods give way.

mod compression;
mod dispersion;
mod orders;
mod sheets;
mod slinky;

pub use compression::STUDY as COMPRESSION;
pub use dispersion::STUDY as DISPERSION;
pub use orders::STUDY as ORDERS;
pub use sheets::{CANTILEVER, LOCKING, MEMBRANE};
pub use slinky::STUDY as SLINKY;
