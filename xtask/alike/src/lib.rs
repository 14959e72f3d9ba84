//! Asks of packages from outside what the whole workspace asks of them, and does nothing else.
//!
//! Cargo compiles a package once for each set of features. What is built beside this one, such as a scene with one
//! of its features, finds nalgebra, faer and parry as the tests have them, compiled.
