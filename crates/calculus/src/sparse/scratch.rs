//! The memory that a factorization works in: taken once, lent at every call.

use std::fmt;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};

use crate::sparse::SparseError;

/// A stack of a fixed size.
pub(crate) struct Scratch {
    buffer: MemBuffer,
    size: StackReq,
}

impl Scratch {
    /// Room for the largest of the `sizes`, for the factorization of an n x n matrix.
    pub(crate) fn new(n: usize, sizes: &[StackReq]) -> Result<Self, SparseError> {
        let size = StackReq::any_of(sizes);
        let buffer = MemBuffer::try_new(size).map_err(|_| SparseError::OutOfMemory { size: n })?;
        Ok(Scratch { buffer, size })
    }

    /// Makes room for this size too.
    pub(crate) fn grow(&mut self, size: StackReq) -> Result<(), SparseError> {
        let needed = size.unaligned_bytes_required();
        if needed > self.size.unaligned_bytes_required() {
            self.buffer =
                MemBuffer::try_new(size).map_err(|_| SparseError::OutOfMemory { size: needed })?;
            self.size = size;
        }
        Ok(())
    }

    #[inline]
    pub(crate) fn stack(&mut self) -> &mut MemStack {
        MemStack::new(&mut self.buffer)
    }
}

impl Clone for Scratch {
    fn clone(&self) -> Self {
        Scratch { buffer: MemBuffer::new(self.size), size: self.size }
    }
}

impl fmt::Debug for Scratch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Scratch({} bytes)", self.size.unaligned_bytes_required())
    }
}
