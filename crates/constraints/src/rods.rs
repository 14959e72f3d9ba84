//! Rigid rods: distances between points that stay as they are.
//!
//! ```text
//! g = |x_j - x_i|^2 - L^2,    dg = (-2 d, 2 d),    d = x_j - x_i               (6)
//! T = 2 L lambda              tension, newtons: positive where the rod pulls
//! ```
//! `x` points in D dimensions, `L` the length in metres, `lambda` the multiplier in N/m. The square
//! form is a polynomial: its derivatives need no roots, and dg does not vanish where g does, as
//! that of `(|d| - L)^2` would. Vertices from `free` on are hooks, which stay or move as they are told: then
//! `dg/dt = 2 <d, dx_hook/dt>` or its negative. A rod may have a strength,
//! the tension or thrust in newtons beyond which it breaks (notes 6.5). Source: notes 6; errata 6.5
//! (tension of the square form).

use stationary_calculus::{Flat, Sink, SizeError, array};

use crate::{
    Constraint, ConstraintError, ConstraintOn, Rows, Scale, check_multipliers, check_read,
    check_values,
};

/// A rod between two vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rod {
    ends: [usize; 2],
    length: f64,
    strength: f64,
}

impl Rod {
    /// A rod of a length in metres that never breaks.
    pub fn new(ends: [usize; 2], length: f64) -> Self {
        Rod { ends, length, strength: f64::INFINITY }
    }

    /// The same rod, which breaks when pulled or pushed harder than `strength` newtons.
    pub fn with_strength(self, strength: f64) -> Self {
        Rod { strength, ..self }
    }

    /// The vertices that it joins.
    pub fn ends(&self) -> [usize; 2] {
        self.ends
    }

    /// Its length, metres.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The tension or thrust beyond which it breaks, newtons.
    pub fn strength(&self) -> f64 {
        self.strength
    }

    /// Its tension at a multiplier, newtons: positive where it pulls.
    pub fn tension(&self, lambda: f64) -> f64 {
        2.0 * self.length * lambda
    }
}

/// Where hooks are.
pub trait Hooks<const D: usize> {
    /// How many there are.
    fn count(&self) -> usize;

    /// The place of one at a time (s).
    fn place(&self, hook: usize, t: f64) -> [f64; D];

    /// How fast it moves then.
    fn velocity(&self, hook: usize, t: f64) -> [f64; D];
}

/// Hooks that stay where they are.
impl<const D: usize> Hooks<D> for Vec<[f64; D]> {
    fn count(&self) -> usize {
        self.len()
    }

    #[inline]
    fn place(&self, hook: usize, _: f64) -> [f64; D] {
        self[hook]
    }

    fn velocity(&self, _: usize, _: f64) -> [f64; D] {
        [0.0; D]
    }
}

/// Rods between free points and hooks in D dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Rods<const D: usize, H = Vec<[f64; D]>> {
    free: usize,
    hooks: H,
    rods: Vec<Rod>,
}

impl<const D: usize> Rods<D> {
    /// Rods between `free` points and hooks that stay, which are the vertices from `free` on.
    ///
    /// # Errors
    /// Those of [`on`](Rods::on).
    pub fn new(free: usize, fixed: Vec<[f64; D]>, rods: Vec<Rod>) -> Result<Self, ConstraintError> {
        Rods::on(free, fixed, rods)
    }
}

impl<const D: usize, H: Hooks<D>> Rods<D, H> {
    /// Rods between `free` points and hooks, which are the vertices from `free` on.
    ///
    /// # Errors
    /// A rod without a length, or with a strength that is not positive; the same vertices twice;
    /// both ends on one vertex or on hooks; a vertex that is not there; a hook that starts at a place that
    /// is not finite.
    pub fn on(free: usize, hooks: H, rods: Vec<Rod>) -> Result<Self, ConstraintError> {
        let vertices = free + hooks.count();
        for (index, rod) in rods.iter().enumerate() {
            check(index, rod, free, vertices)?;
        }
        let is_lost = |&hook: &usize| hooks.place(hook, 0.0).iter().any(|x| !x.is_finite());
        if let Some(hook) = (0..hooks.count()).find(is_lost) {
            return Err(ConstraintError::Hook { vertex: free + hook });
        }
        let mut pairs: Vec<_> = rods
            .iter()
            .enumerate()
            .map(|(index, rod)| (rod.ends[0].min(rod.ends[1]), rod.ends[0].max(rod.ends[1]), index))
            .collect();
        pairs.sort_unstable();
        if let Some(two) = pairs.windows(2).find(|two| two[0].0 == two[1].0 && two[0].1 == two[1].1)
        {
            return Err(ConstraintError::RepeatedRod { rod: two[1].2, earlier: two[0].2 });
        }
        Ok(Rods { free, hooks, rods })
    }

    /// The rods, in the order of their equations.
    pub fn rods(&self) -> &[Rod] {
        &self.rods
    }

    /// The number of free points.
    pub fn free(&self) -> usize {
        self.free
    }

    /// Keeps the rods whose places among all are to be kept, in their order.
    pub fn retain(&mut self, mut keep: impl FnMut(usize) -> bool) {
        let mut places = 0..;
        self.rods.retain(|_| places.next().is_some_and(&mut keep));
    }

    /// Takes a rod away; those after it move up.
    pub(crate) fn remove(&mut self, rod: usize) -> Rod {
        self.rods.remove(rod)
    }

    #[inline]
    fn place(&self, t: f64, points: &[[f64; D]], vertex: usize) -> [f64; D] {
        match vertex.checked_sub(self.free) {
            None => points[vertex],
            Some(hook) => self.hooks.place(hook, t),
        }
    }

    /// From the first end to the second.
    #[inline]
    fn along(&self, t: f64, points: &[[f64; D]], rod: &Rod) -> [f64; D] {
        let [x, y] = rod.ends.map(|end| self.place(t, points, end));
        array(|c| y[c] - x[c])
    }

    /// The free points, and those after them.
    #[inline]
    fn points<'a>(&self, q: &'a [f64]) -> Result<&'a [[f64; D]], SizeError> {
        check_read(D * self.free, q)?;
        Ok(q.as_chunks::<D>().0)
    }
}

fn check(index: usize, rod: &Rod, free: usize, vertices: usize) -> Result<(), ConstraintError> {
    if !(rod.length > 0.0 && rod.length.is_finite()) {
        return Err(ConstraintError::RodLength { rod: index, length: rod.length });
    }
    if rod.strength.is_nan() || rod.strength <= 0.0 {
        return Err(ConstraintError::RodStrength { rod: index, strength: rod.strength });
    }
    if let Some(vertex) = rod.ends.into_iter().find(|&vertex| vertex >= vertices) {
        return Err(ConstraintError::UnknownVertex { index, vertex, vertices });
    }
    if rod.ends[0] == rod.ends[1] {
        return Err(ConstraintError::RodLoop { rod: index, vertex: rod.ends[0] });
    }
    if rod.ends.into_iter().all(|vertex| vertex >= free) {
        return Err(ConstraintError::RodBetweenHooks { rod: index });
    }
    Ok(())
}

impl<const D: usize, H: Hooks<D>> ConstraintOn<Flat> for Rods<D, H> {}

impl<const D: usize, H: Hooks<D>> Constraint for Rods<D, H> {
    fn dim(&self) -> usize {
        D * self.free
    }

    fn count(&self) -> usize {
        self.rods.len()
    }

    #[inline]
    fn value(&self, t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        check_values(self.rods.len(), g)?;
        let points = self.points(q)?;
        for (g, rod) in g.iter_mut().zip(&self.rods) {
            let d = self.along(t, points, rod);
            *g = d.iter().map(|d| d * d).sum::<f64>() - rod.length * rod.length;
        }
        Ok(())
    }

    #[inline]
    fn differential(&self, t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        let points = self.points(q)?;
        for (row, rod) in self.rods.iter().enumerate() {
            let d = self.along(t, points, rod);
            for (vertex, sign) in rod.ends.into_iter().zip([-2.0, 2.0]) {
                if vertex < self.free {
                    for (c, d) in d.iter().enumerate() {
                        rows.add(row, D * vertex + c, sign * d);
                    }
                }
            }
        }
        Ok(())
    }

    fn add_hessian(
        &self,
        _: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        check_multipliers(self.rods.len(), lambda)?;
        check_read(D * self.free, q)?;
        for (rod, lambda) in self.rods.iter().zip(lambda) {
            let [i, j] = rod.ends;
            let l = 2.0 * lambda;
            for c in 0..D {
                match (i < self.free, j < self.free) {
                    (true, true) => {
                        hessian.add_symmetric(&[D * i + c, D * j + c], &[l, -l, -l, l]);
                    }
                    (true, false) => hessian.add_symmetric(&[D * i + c], &[l]),
                    (false, _) => hessian.add_symmetric(&[D * j + c], &[l]),
                }
            }
        }
        Ok(())
    }

    fn rate(&self, t: f64, q: &[f64], rate: &mut [f64]) -> Result<(), SizeError> {
        check_values(self.rods.len(), rate)?;
        let points = self.points(q)?;
        for (rate, rod) in rate.iter_mut().zip(&self.rods) {
            let d = self.along(t, points, rod);
            *rate = 0.0;
            for (vertex, sign) in rod.ends.into_iter().zip([-2.0, 2.0]) {
                if let Some(hook) = vertex.checked_sub(self.free) {
                    let v = self.hooks.velocity(hook, t);
                    *rate += sign * d.iter().zip(v).map(|(d, v)| d * v).sum::<f64>();
                }
            }
        }
        Ok(())
    }

    fn scale(&self, row: usize) -> Scale {
        let Some(&Rod { length, .. }) = self.rods.get(row) else { return Scale::default() };
        Scale { slope: 2.0 * length, length, ..Scale::default() }
    }

    fn describe(&self, row: usize) -> Option<String> {
        let [one, other] = self.rods.get(row)?.ends;
        let name = |vertex: usize| match vertex.checked_sub(self.free) {
            Some(hook) => format!("hook {hook}"),
            None => format!("vertex {vertex}"),
        };
        Some(format!("rod between {} and {}", name(one), name(other)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pairing;
    use stationary_calculus::assert_derivatives;

    fn rods() -> Vec<Rod> {
        vec![Rod::new([3, 0], 1.0), Rod::new([0, 1], 0.5), Rod::new([2, 1], 2.0)]
    }

    #[test]
    fn the_differentials_are_right_in_the_plane_and_in_space() {
        let plane = Rods::new(3, vec![[0.0, 1.0]], rods()).unwrap();
        let pairing = Pairing::new(&plane, vec![0.7, -1.3, 2.0], 0.0).unwrap();
        assert_derivatives(&pairing, &[0.5, 0.1, -0.4, 0.9, 1.5, -1.0]);
        let space = Rods::new(3, vec![[0.0, 1.0, 0.3]], rods()).unwrap();
        let pairing = Pairing::new(&space, vec![0.7, -1.3, 2.0], 0.0).unwrap();
        assert_derivatives(&pairing, &[0.5, 0.1, -0.4, 0.9, 1.5, -1.0, 0.2, 0.3, 0.4]);
    }

    /// A hook that swings.
    struct Swinging;

    impl Hooks<2> for Swinging {
        fn count(&self) -> usize {
            1
        }

        fn place(&self, _: usize, t: f64) -> [f64; 2] {
            [t.sin(), 1.0 + 0.3 * t]
        }

        fn velocity(&self, _: usize, t: f64) -> [f64; 2] {
            [t.cos(), 0.3]
        }
    }

    #[test]
    fn the_rate_of_a_hook_that_moves_is_the_slope_of_the_value_in_time() {
        let rods = Rods::on(3, Swinging, rods()).unwrap();
        let (q, t) = ([0.5, 0.1, -0.4, 0.9, 1.5, -1.0], 0.7);
        let value = |t: f64| {
            let mut g = [0.0; 3];
            rods.value(t, &q, &mut g).unwrap();
            g
        };
        let mut rate = [f64::NAN; 3];
        rods.rate(t, &q, &mut rate).unwrap();
        assert_eq!(rate[1..], [0.0; 2]);
        for h in [1e-2, 1e-3, 1e-4] {
            let slope = (value(t + h)[0] - value(t - h)[0]) / (2.0 * h);
            assert!((slope - rate[0]).abs() < h * h + 1e-11, "{h}: {slope} {}", rate[0]);
        }
    }

    #[test]
    fn bad_rods_are_refused_by_number() {
        let made = |rods: Vec<Rod>| Rods::<2>::new(3, vec![[0.0; 2]; 2], rods).unwrap_err();
        let with = |rod: Rod| made(vec![Rod::new([0, 1], 1.0), rod]);
        for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = with(Rod::new([1, 2], length));
            assert!(matches!(error, ConstraintError::RodLength { rod: 1, .. }), "{error}");
        }
        for strength in [0.0, -1.0, f64::NAN] {
            let error = with(Rod::new([1, 2], 1.0).with_strength(strength));
            assert!(matches!(error, ConstraintError::RodStrength { rod: 1, .. }), "{error}");
        }
        let error = with(Rod::new([1, 5], 1.0));
        assert_eq!(error, ConstraintError::UnknownVertex { index: 1, vertex: 5, vertices: 5 });
        let error = with(Rod::new([2, 2], 1.0));
        assert_eq!(error, ConstraintError::RodLoop { rod: 1, vertex: 2 });
        let error = with(Rod::new([3, 4], 1.0));
        assert_eq!(error, ConstraintError::RodBetweenHooks { rod: 1 });
        let error = with(Rod::new([1, 0], 2.0));
        assert_eq!(error, ConstraintError::RepeatedRod { rod: 1, earlier: 0 });
        let error = Rods::<2>::new(1, vec![[f64::NAN, 0.0]], Vec::new()).unwrap_err();
        assert_eq!(error, ConstraintError::Hook { vertex: 1 });
    }

    #[test]
    fn the_rods_that_are_kept_stay_in_their_order() {
        let mut kept = Rods::<2>::new(3, vec![[0.0, 1.0]], rods()).unwrap();
        let mut seen = Vec::new();
        kept.retain(|place| {
            seen.push(place);
            place != 1
        });
        assert_eq!(seen, [0, 1, 2]);
        assert_eq!(kept.rods(), [rods()[0], rods()[2]]);
        assert_eq!(kept.count(), 2);
    }
}
