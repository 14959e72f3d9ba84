//! Whatever the bytes, the reader of MSH files answers with a mesh or an error with words.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Err(error) = stationary_mesh::parse_msh(bytes) {
        assert!(!error.to_string().is_empty());
    }
});
