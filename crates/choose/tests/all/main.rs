//! The search on problems of one's own: no scene, no file.

mod experiments;
mod flows;
mod motions;
