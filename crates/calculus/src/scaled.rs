//! A multiple of what is given: passes blocks on to another sink, times a factor.
//!
//! ```text
//! A += s B
//! ```

use crate::{Parts, Sink, StencilHessian};

/// Passes blocks on, multiplied.
#[derive(Debug)]
pub struct Scaled<'a, S> {
    scale: f64,
    scratch: Vec<f64>,
    sink: &'a mut S,
}

impl<'a, S: Sink> Scaled<'a, S> {
    /// Passes `scale` times what comes to a sink.
    pub fn new(scale: f64, sink: &'a mut S) -> Self {
        Scaled { scale, scratch: Vec::new(), sink }
    }

    /// The same, with memory for blocks that are not of whole vertices.
    pub fn with_scratch(self, scratch: Vec<f64>) -> Self {
        Scaled { scratch, ..self }
    }

    /// Gives the memory back.
    pub fn into_scratch(self) -> Vec<f64> {
        self.scratch
    }
}

impl<S: Sink> Sink for Scaled<'_, S> {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        self.scratch.clear();
        self.scratch.extend(block.iter().map(|entry| self.scale * entry));
        self.sink.add_symmetric(freedoms, &self.scratch);
    }

    #[inline]
    fn add_vertices<const V: usize, const D: usize>(
        &mut self,
        freedoms: &[[usize; D]; V],
        block: &StencilHessian<V, D>,
    ) {
        let mut scaled = *block;
        for entry in scaled.as_flattened_mut().as_flattened_mut().as_flattened_mut() {
            *entry *= self.scale;
        }
        self.sink.add_vertices(freedoms, &scaled);
    }

    #[inline]
    fn add_lower<const V: usize, const D: usize>(
        &mut self,
        freedoms: &[[usize; D]; V],
        column: impl Fn(usize, usize, usize) -> [f64; D],
    ) {
        let scale = self.scale;
        self.sink.add_lower(freedoms, |b, d, a| column(b, d, a).map(|entry| scale * entry));
    }

    fn add_parts(&mut self, parts: &impl Parts) {
        self.sink.add_parts(&ScaledParts { scale: self.scale, parts });
    }
}

struct ScaledParts<'a, P> {
    scale: f64,
    parts: &'a P,
}

impl<P: Parts> Parts for ScaledParts<'_, P> {
    fn bounds(&self) -> &[usize] {
        self.parts.bounds()
    }

    fn visit(&self, part: usize, sink: &mut impl Sink) {
        self.parts.visit(part, &mut Scaled::new(self.scale, sink));
    }

    fn visit_all(&self, sink: &mut impl Sink) {
        self.parts.visit_all(&mut Scaled::new(self.scale, sink));
    }
}
