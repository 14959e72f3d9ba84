//! A scene file, checked and run.
