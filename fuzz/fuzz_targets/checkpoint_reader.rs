//! Whatever the bytes, the reader of checkpoints answers with a checkpoint or an error with words.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stationary_scene::Checkpoint;

fuzz_target!(|bytes: &[u8]| {
    if let Err(error) = Checkpoint::parse(bytes) {
        assert!(!error.to_string().is_empty());
    }
});
