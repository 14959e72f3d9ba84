//! What the program does.

mod choose;
mod new;
mod runs;
mod words;
