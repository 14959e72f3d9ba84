//! Numbers to bytes and back, and the hash of bytes.

use std::io;
use std::io::Write;

use stationary_calculus::Covector;
use stationary_integrators::State;

/// The hash FNV-1a of Fowler, Noll and Vo with 64 bits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Fnv(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    pub(super) fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    pub(super) fn value(&self) -> u64 {
        self.0
    }
}

impl Write for Fnv {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.add(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Writes numbers, and their hash at the end.
pub(super) struct Writer<W> {
    out: W,
    hash: Fnv,
}

impl<W: Write> Writer<W> {
    pub(super) fn new(out: W) -> Self {
        Writer { out, hash: Fnv::default() }
    }

    pub(super) fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hash.add(bytes);
        self.out.write_all(bytes)
    }

    pub(super) fn count(&mut self, count: u64) -> io::Result<()> {
        self.put(&count.to_le_bytes())
    }

    pub(super) fn number(&mut self, number: f64) -> io::Result<()> {
        self.put(&number.to_le_bytes())
    }

    pub(super) fn bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.count(bytes.len() as u64)?;
        self.put(bytes)
    }

    pub(super) fn numbers(&mut self, numbers: &[f64]) -> io::Result<()> {
        self.count(numbers.len() as u64)?;
        numbers.iter().try_for_each(|&number| self.number(number))
    }

    pub(super) fn state(&mut self, state: &State<Vec<f64>>) -> io::Result<()> {
        self.number(state.t)?;
        self.numbers(&state.q)?;
        self.numbers(&state.p.0)
    }

    /// Writes the hash, and hands back where everything went.
    pub(super) fn finish(mut self) -> io::Result<W> {
        let sum = self.hash.value().to_le_bytes();
        self.out.write_all(&sum)?;
        Ok(self.out)
    }
}

/// Bytes that are left to read. Nothing is made before its bytes are known to be there.
pub(super) struct Reader<'a>(pub(super) &'a [u8]);

impl<'a> Reader<'a> {
    fn word(&mut self) -> Option<[u8; 8]> {
        let (word, rest) = self.0.split_first_chunk::<8>()?;
        self.0 = rest;
        Some(*word)
    }

    pub(super) fn count(&mut self) -> Option<u64> {
        self.word().map(u64::from_le_bytes)
    }

    pub(super) fn number(&mut self) -> Option<f64> {
        self.word().map(f64::from_le_bytes)
    }

    /// The length of a list whose entries have at least `size` bytes each.
    pub(super) fn length(&mut self, size: usize) -> Option<usize> {
        let length = usize::try_from(self.count()?).ok()?;
        (length <= self.0.len() / size).then_some(length)
    }

    pub(super) fn bytes(&mut self) -> Option<&'a [u8]> {
        let length = self.length(1)?;
        let (bytes, rest) = self.0.split_at(length);
        self.0 = rest;
        Some(bytes)
    }

    pub(super) fn numbers(&mut self) -> Option<Vec<f64>> {
        (0..self.length(8)?).map(|_| self.number()).collect()
    }

    pub(super) fn state(&mut self) -> Option<State<Vec<f64>>> {
        let (t, q, p) = (self.number()?, self.numbers()?, self.numbers()?);
        Some(State { t, q, p: Covector(p) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the table in RFC 9923 and the authors' own test suite.
    #[test]
    fn the_hash_is_that_of_its_authors() {
        let hash = |text: &str| {
            let mut hash = Fnv::default();
            hash.add(text.as_bytes());
            hash.value()
        };
        assert_eq!(hash(""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(hash("a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(hash("foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn lists_longer_than_their_bytes_are_not_made() {
        let mut bytes = u64::MAX.to_le_bytes().to_vec();
        bytes.extend([0; 16]);
        assert_eq!(Reader(&bytes).numbers(), None);
        assert_eq!(Reader(&bytes).bytes(), None);
        assert_eq!(Reader(&bytes[..3]).count(), None);
    }
}
