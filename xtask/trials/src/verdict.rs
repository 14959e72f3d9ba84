//! What is said of one case.

/// The referee's word on one case.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// The answer keeps its promise, or a refusal was due.
    Right {
        /// The error over what was promised: at most 1, 0 where a refusal was due.
        ratio: f64,
    },
    /// A typed error, or Ok with a plain sign, on a case that has an answer.
    Refused {
        /// What it said.
        why: String,
    },
    /// The referee does not know the truth well enough.
    NotJudged {
        /// Why not.
        why: String,
    },
    /// Neither right nor wrong here: what is wrong, or cannot be, is another promise's. It is listed.
    Apart {
        /// What it is.
        what: String,
    },
    /// Ok without a sign, and wrong; a panic, a hang, a NaN.
    Wrong {
        /// The error over what was promised; infinite for a panic, a hang and a NaN.
        ratio: f64,
        /// What is wrong.
        what: String,
    },
}

impl Verdict {
    /// Right where `error <= promised`, else wrong. What is not a number is wrong.
    pub fn of(error: f64, promised: f64, what: &str) -> Self {
        let ratio = if error == 0.0 { 0.0 } else { error / promised };
        if ratio <= 1.0 {
            return Verdict::Right { ratio };
        }
        let what = format!("{what}: off by {error:.3e}, promised {promised:.3e}");
        Verdict::Wrong { ratio: if ratio.is_nan() { f64::INFINITY } else { ratio }, what }
    }

    /// A refusal, or an answer to what has no answer, that was due.
    pub fn due() -> Self {
        Verdict::Right { ratio: 0.0 }
    }

    /// A refusal of a case that has an answer.
    pub fn refused(why: impl ToString) -> Self {
        Verdict::Refused { why: why.to_string() }
    }

    /// A case that the referee cannot judge.
    pub fn not_judged(why: impl ToString) -> Self {
        Verdict::NotJudged { why: why.to_string() }
    }

    /// A case that is another promise's.
    pub fn apart(what: impl ToString) -> Self {
        Verdict::Apart { what: what.to_string() }
    }

    /// Wrong without a measure.
    pub fn wrong(what: impl ToString) -> Self {
        Verdict::Wrong { ratio: f64::INFINITY, what: what.to_string() }
    }

    /// The worse of two verdicts on one case: wrong, then refused, then apart, then not judged, then the
    /// larger ratio.
    pub fn and(self, other: Self) -> Self {
        if self.rank() >= other.rank() { self } else { other }
    }

    fn rank(&self) -> (u8, f64) {
        match self {
            Verdict::Right { ratio } => (0, *ratio),
            Verdict::NotJudged { .. } => (1, 0.0),
            Verdict::Apart { .. } => (2, 0.0),
            Verdict::Refused { .. } => (3, 0.0),
            Verdict::Wrong { ratio, .. } => (4, *ratio),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_a_number_is_wrong() {
        for (error, promised) in [(f64::NAN, 1.0), (1.0, f64::NAN), (1.0, 0.0), (2.0, 1.0)] {
            assert!(matches!(Verdict::of(error, promised, "x"), Verdict::Wrong { .. }));
        }
        assert_eq!(Verdict::of(0.0, 0.0, "x"), Verdict::Right { ratio: 0.0 });
        assert_eq!(Verdict::of(0.5, 1.0, "x"), Verdict::Right { ratio: 0.5 });
    }

    #[test]
    fn the_worse_of_two_verdicts_is_kept() {
        let right = Verdict::of(0.5, 1.0, "x");
        let refused = Verdict::refused("singular");
        let wrong = Verdict::of(3.0, 1.0, "x");
        assert_eq!(right.clone().and(refused.clone()), refused);
        assert_eq!(wrong.clone().and(refused), wrong);
        assert_eq!(Verdict::due().and(right.clone()), right);
    }
}
