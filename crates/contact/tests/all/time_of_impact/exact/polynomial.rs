//! Polynomials with integer coefficients, their roots in [0, 1], and signs at such roots.
//!
//! ```text
//! p, p', -rem(p, p'), ...    Sturm's sequence: sign changes at a less those at b = roots in (a, b]
//! ```
//! Remainders are multiplied by positive integers only, and divided by their content.

use num_bigint::{BigInt, Sign};
use num_traits::{One, Signed, Zero};

/// Coefficients from the constant up, the last one not zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial(Vec<BigInt>);

/// A fraction `numerator / 2^power`.
#[derive(Clone, Debug)]
struct Dyadic {
    numerator: BigInt,
    power: u32,
}

impl Dyadic {
    fn middle(a: &Dyadic, b: &Dyadic) -> Dyadic {
        let power = a.power.max(b.power);
        let scaled = |x: &Dyadic| &x.numerator << (power - x.power);
        Dyadic { numerator: scaled(a) + scaled(b), power: power + 1 }
    }
}

/// A real root of a polynomial.
#[derive(Clone, Debug)]
pub struct Root {
    low: Dyadic,
    high: Dyadic,
    /// Square-free, with this root alone between the ends and none on them; nothing where the root
    /// is the lower end.
    of: Option<Polynomial>,
}

fn sign(x: &BigInt) -> i32 {
    match x.sign() {
        Sign::Minus => -1,
        Sign::NoSign => 0,
        Sign::Plus => 1,
    }
}

impl Polynomial {
    fn trimmed(mut coefficients: Vec<BigInt>) -> Self {
        while coefficients.last().is_some_and(Zero::is_zero) {
            coefficients.pop();
        }
        Polynomial(coefficients)
    }

    pub fn linear(constant: i64, slope: i64) -> Self {
        Polynomial::trimmed(vec![constant.into(), slope.into()])
    }

    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    fn combined(&self, other: &Self, sign: i32) -> Self {
        let n = self.0.len().max(other.0.len());
        let at = |p: &Self, k: usize| p.0.get(k).cloned().unwrap_or_default();
        Polynomial::trimmed((0..n).map(|k| at(self, k) + at(other, k) * sign).collect())
    }

    pub fn plus(&self, other: &Self) -> Self {
        self.combined(other, 1)
    }

    pub fn minus(&self, other: &Self) -> Self {
        self.combined(other, -1)
    }

    pub fn times(&self, other: &Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Polynomial(Vec::new());
        }
        let mut product = vec![BigInt::zero(); self.0.len() + other.0.len() - 1];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in other.0.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        Polynomial(product)
    }

    fn derivative(&self) -> Self {
        let terms = self.0.iter().enumerate().skip(1);
        Polynomial::trimmed(terms.map(|(k, c)| c * BigInt::from(k)).collect())
    }

    fn sign_at(&self, x: &Dyadic) -> i32 {
        let mut sum = BigInt::zero();
        for (k, coefficient) in self.0.iter().rev().enumerate() {
            sum = sum * &x.numerator + (coefficient << (x.power as usize * k));
        }
        sign(&sum)
    }

    /// Divided by the greatest common divisor of its coefficients.
    fn primitive(mut self) -> Self {
        let mut content = BigInt::zero();
        for c in &self.0 {
            content = greatest_common_divisor(content, c.abs());
            if content.is_one() {
                return self;
            }
        }
        self.0.iter_mut().for_each(|c| *c /= &content);
        self
    }

    /// Quotient and remainder of `k self` by `other`, for some integer `k > 0`.
    fn divided(&self, other: &Self) -> (Self, Self) {
        let lead = other.0.last().expect("a divisor that is not zero");
        let (size, flip) = (lead.abs(), sign(lead));
        let (mut rest, mut quotient) = (self.clone(), Vec::new());
        if self.0.len() >= other.0.len() {
            quotient.resize(self.0.len() - other.0.len() + 1, BigInt::zero());
        }
        while rest.0.len() >= other.0.len() {
            let shift = rest.0.len() - other.0.len();
            let factor = rest.0.last().expect("not zero") * flip;
            rest.0.iter_mut().for_each(|c| *c *= &size);
            quotient.iter_mut().for_each(|c: &mut BigInt| *c *= &size);
            quotient[shift] += &factor;
            for (k, c) in other.0.iter().enumerate() {
                rest.0[shift + k] -= &factor * c;
            }
            rest = Polynomial::trimmed(rest.0);
        }
        (Polynomial::trimmed(quotient), rest)
    }

    fn sturm_sequence(&self) -> Vec<Polynomial> {
        let mut sequence = vec![self.clone().primitive(), self.derivative().primitive()];
        while let [.., a, b] = sequence.as_slice()
            && !b.is_zero()
        {
            let rest = a.divided(b).1;
            sequence.push(Polynomial(rest.0.into_iter().map(|c| -c).collect()).primitive());
        }
        sequence.retain(|p| !p.is_zero());
        sequence
    }

    /// The common divisor of highest degree.
    fn common(&self, other: &Self) -> Self {
        let (mut a, mut b) = (self.clone().primitive(), other.clone().primitive());
        while !b.is_zero() {
            (a, b) = (b.clone(), a.divided(&b).1.primitive());
        }
        a
    }

    fn square_free(&self) -> Self {
        let common = self.common(&self.derivative());
        if common.0.len() <= 1 { self.clone() } else { self.divided(&common).0.primitive() }
    }

    /// Its different real roots from 0 to 1, both included.
    pub fn roots_in_unit_interval(&self) -> Vec<Root> {
        let mut roots = Vec::new();
        // No change of sign among the coefficients: no positive root.
        let signs: Vec<_> = self.0.iter().map(sign).filter(|&s| s != 0).collect();
        let no_positive = signs.windows(2).all(|pair| pair[0] == pair[1]);
        if self.0.len() <= 1 || (no_positive && !self.0[0].is_zero()) {
            return roots;
        }
        let mut p = self.square_free();
        let unit = |x: i32| Dyadic { numerator: x.into(), power: 0 };
        let mut cells = vec![(unit(0), unit(1))];
        let mut exact = vec![unit(0), unit(1)];
        'again: loop {
            for x in &exact {
                if p.sign_at(x) == 0 {
                    roots.push(Root { low: x.clone(), high: x.clone(), of: None });
                    let one = BigInt::one() << x.power;
                    p = p.divided(&Polynomial(vec![-x.numerator.clone(), one])).0.primitive();
                }
            }
            if p.0.len() <= 1 {
                return roots;
            }
            let sequence = p.sturm_sequence();
            let mut kept = Vec::new();
            while let Some((low, high)) = cells.pop() {
                match changes(&sequence, &low) - changes(&sequence, &high) {
                    0 => {}
                    1 => kept.push((low, high)),
                    _ => {
                        let middle = Dyadic::middle(&low, &high);
                        cells.push((low, middle.clone()));
                        cells.push((middle.clone(), high));
                        if p.sign_at(&middle) == 0 {
                            cells.append(&mut kept);
                            exact = vec![middle];
                            continue 'again;
                        }
                    }
                }
            }
            roots.extend(kept.into_iter().map(|(low, high)| Root {
                low,
                high,
                of: Some(p.clone()),
            }));
            return roots;
        }
    }

    /// Different roots between two places that are none.
    fn roots_between(&self, low: &Dyadic, high: &Dyadic) -> i32 {
        if self.0.len() <= 1 {
            return 0;
        }
        let sequence = self.sturm_sequence();
        changes(&sequence, low) - changes(&sequence, high)
    }
}

fn greatest_common_divisor(mut a: BigInt, mut b: BigInt) -> BigInt {
    while !b.is_zero() {
        (a, b) = (b.clone(), a % b);
    }
    a
}

fn changes(sequence: &[Polynomial], x: &Dyadic) -> i32 {
    let signs: Vec<i32> = sequence.iter().map(|p| p.sign_at(x)).filter(|&sign| sign != 0).collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count() as i32
}

impl Root {
    pub fn rational(x: i64) -> Self {
        let x = Dyadic { numerator: x.into(), power: 0 };
        Root { low: x.clone(), high: x, of: None }
    }

    /// The sign of another polynomial at this root.
    pub fn sign_of(&mut self, w: &Polynomial) -> i32 {
        if w.is_zero() {
            return 0;
        }
        let Some(own) = self.of.clone() else { return w.sign_at(&self.low) };
        let common = own.common(w);
        // The common divisor's roots are roots of `own`, none of which is an end.
        if common.roots_between(&self.low, &self.high) > 0 {
            return 0;
        }
        loop {
            let ends = [w.sign_at(&self.low), w.sign_at(&self.high)];
            if ends[0] * ends[1] > 0 && w.roots_between(&self.low, &self.high) == 0 {
                return ends[0];
            }
            let middle = Dyadic::middle(&self.low, &self.high);
            match own.sign_at(&middle) {
                0 => {
                    *self = Root { low: middle.clone(), high: middle, of: None };
                    return w.sign_at(&self.low);
                }
                sign if sign == own.sign_at(&self.low) => self.low = middle,
                _ => self.high = middle,
            }
        }
    }
}

#[test]
fn roots_of_a_product_are_found_and_signs_at_them_are_exact() {
    // (8 t - 3)^2 (t^2 + t - 1): 3/8 twice, and the golden ratio's 0.618.
    let golden = Polynomial(vec![(-1).into(), 1.into(), 1.into()]);
    let line = Polynomial::linear(-3, 8);
    let product = line.times(&line).times(&golden);
    let mut roots = product.roots_in_unit_interval();
    assert_eq!(roots.len(), 2);
    let mut signs: Vec<[i32; 3]> = roots
        .iter_mut()
        .map(|root| {
            [&golden, &line, &Polynomial::linear(-618_034, 1_000_000)].map(|w| root.sign_of(w))
        })
        .collect();
    signs.sort_unstable();
    // 0.618033988... is below 0.618034.
    assert_eq!(signs, [[-1, 0, -1], [0, 1, -1]]);
}
