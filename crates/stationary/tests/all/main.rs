//! What the program does.

mod new;
mod runs;
mod words;
