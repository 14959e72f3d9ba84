//! The draw: mutants in an order that a seed decides.
//!
//! Each mutant is ranked by a hash of its own words and the seed, so that a change elsewhere in the
//! crate leaves its rank against the others as it is.

use std::collections::HashMap;

use crate::operators::Mutant;
use crate::sources::Source;

/// A mutant with its number.
pub struct Drawn {
    /// Its place in the order, from 1.
    pub number: u32,
    /// What it does.
    pub mutant: Mutant,
}

/// All mutants in the order of the seed.
pub fn order(seed: u64, sources: &[Source], mutants: Vec<Mutant>) -> Vec<Drawn> {
    let mut seen: HashMap<String, u32> = HashMap::new();
    let mut ranked: Vec<(u64, Mutant)> = mutants
        .into_iter()
        .map(|mutant| {
            let source = &sources[mutant.file];
            let original = &source.text[mutant.range.clone()];
            let words = format!(
                "{}\n{original}\n{}\n{}",
                source.path.display(),
                mutant.mutated,
                mutant.change
            );
            let twin = seen.entry(words.clone()).or_default();
            *twin += 1;
            (hash(seed, &format!("{words}\n{twin}")), mutant)
        })
        .collect();
    ranked.sort_by_key(|&(rank, _)| rank);
    let numbers = 1..;
    numbers.zip(ranked).map(|(number, (_, mutant))| Drawn { number, mutant }).collect()
}

/// Fowler, Noll and Vo's hash (FNV-1a), mixed as SplitMix64 does.
fn hash(seed: u64, words: &str) -> u64 {
    let begin = 0xcbf2_9ce4_8422_2325 ^ seed;
    let mut z = words
        .bytes()
        .fold(begin, |z, byte| (z ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
