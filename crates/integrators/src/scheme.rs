//! Coefficients of compositions: the times of their kicks and drifts, in units of the step.
//!
//! ```text
//! kick b1, drift a1, kick b2, ..., drift a1, kick b1        or the same with drifts first
//! S(g1 h) S(g2 h) ... S(g1 h),   S Stormer-Verlet:   b = g1/2, (g1 + g2)/2, ...,  a = g1, g2, ...
//! ```
//! Every set is a palindrome, written down up to its middle, and its times add up to 1 for the
//! kicks and 1 for the drifts; the entry in the middle follows from that. A set of order k makes
//! the product of exponentials `e^(b1 B) e^(a1 A) ...` agree with `e^(A + B)` up to products of k
//! factors, for any A and B (`the_order_conditions_hold_to_rounding`); those named Nystrom do so
//! only where `[B, [B, [B, A]]] = 0`, which is so when the kinetic energy is quadratic in p and the
//! kicks come from a potential of q alone. There they need fewer stages for the same error.
//!
//! Sources: Suzuki 1990 (fractal), Yoshida 1990 (triple jump, orders 6 and 8), Kahan and Li 1997
//! (s9odr6a, s17odr8a), Blanes and Moan 2002, tables 2 and 3 (S6, S10, SRKN6b, SRKN11b).

use crate::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Stability, Symplecticity,
};

/// A set of coefficients for a [`Composition`](crate::Composition).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scheme {
    /// Three Stormer-Verlet steps, the middle one backward: order 4.
    TripleJump4,
    /// Five Stormer-Verlet steps, the middle one backward: order 4, with a far smaller error.
    Suzuki4,
    /// Six stages for any splitting: order 4.
    BlanesMoan4,
    /// Six stages for kicks and drifts: order 4.
    BlanesMoanNystrom4,
    /// Seven Stormer-Verlet steps: order 6.
    Yoshida6,
    /// Nine Stormer-Verlet steps: order 6.
    KahanLi6,
    /// Ten stages for any splitting: order 6.
    BlanesMoan6,
    /// Eleven stages for kicks and drifts: order 6.
    BlanesMoanNystrom6,
    /// Fifteen Stormer-Verlet steps: order 8.
    Yoshida8,
    /// Seventeen Stormer-Verlet steps: order 8.
    KahanLi8,
}

/// Which flow a sequence begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum First {
    Kick,
    Drift,
}

/// The first half of a palindrome, without what follows from the sum.
enum Half {
    /// Steps of Stormer-Verlet.
    Verlets(&'static [f64]),
    /// Kicks and drifts in turn, the kick first.
    Kicks { kicks: &'static [f64], drifts: &'static [f64] },
    /// Kicks and drifts in turn, the drift first.
    Drifts { kicks: &'static [f64], drifts: &'static [f64] },
}

/// `1/(2 - 2^(1/3))`.
const TRIPLE_JUMP: f64 = 1.351_207_191_959_657_7;
/// `1/(4 - 4^(1/3))`.
const SUZUKI: f64 = 0.414_490_771_794_375_7;

impl Scheme {
    /// Every scheme, low orders first.
    pub const ALL: [Scheme; 10] = [
        Scheme::TripleJump4,
        Scheme::Suzuki4,
        Scheme::BlanesMoan4,
        Scheme::BlanesMoanNystrom4,
        Scheme::Yoshida6,
        Scheme::KahanLi6,
        Scheme::BlanesMoan6,
        Scheme::BlanesMoanNystrom6,
        Scheme::Yoshida8,
        Scheme::KahanLi8,
    ];

    /// What is known of the composition. Its stability limit is where the first band of growth on
    /// an oscillator begins; some bands near `h omega = pi` are narrow, with stable steps beyond.
    pub const fn facts(self) -> Facts {
        match self {
            Scheme::TripleJump4 => facts("triple-jump-4", 4, 3, 1.573_401_947_434_539_8),
            Scheme::Suzuki4 => facts("suzuki-4", 4, 5, 2.720_974_538_560_15),
            Scheme::BlanesMoan4 => facts("blanes-moan-4", 4, 6, 3.132_823_398_390_886),
            Scheme::BlanesMoanNystrom4 => {
                facts("blanes-moan-nystrom-4", 4, 6, 3.163_465_066_558_248)
            }
            Scheme::Yoshida6 => facts("yoshida-6", 6, 7, 2.269_057_996_397_66),
            Scheme::KahanLi6 => facts("kahan-li-6", 6, 9, 2.532_627_388_334_296_5),
            Scheme::BlanesMoan6 => facts("blanes-moan-6", 6, 10, 3.134_247_522_089_02),
            Scheme::BlanesMoanNystrom6 => {
                facts("blanes-moan-nystrom-6", 6, 11, 3.141_431_087_753_336_5)
            }
            Scheme::Yoshida8 => facts("yoshida-8", 8, 15, 3.393_234_268_464_149),
            Scheme::KahanLi8 => facts("kahan-li-8", 8, 17, 3.096_438_680_000_733_5),
        }
    }

    fn half(self) -> Half {
        match self {
            Scheme::TripleJump4 => Half::Verlets(&[TRIPLE_JUMP]),
            Scheme::Suzuki4 => Half::Verlets(&[SUZUKI, SUZUKI]),
            Scheme::BlanesMoan4 => Half::Drifts {
                drifts: &[0.079_203_696_431_195_7, 0.353_172_906_049_774, -0.042_065_080_357_719_5],
                kicks: &[0.209_515_106_613_362, -0.143_851_773_179_818],
            },
            Scheme::BlanesMoanNystrom4 => Half::Kicks {
                kicks: &[0.082_984_406_417_405_2, 0.396_309_801_498_368, -0.039_056_304_922_348_6],
                drifts: &[0.245_298_957_184_271, 0.604_872_665_711_080],
            },
            Scheme::Yoshida6 => Half::Verlets(&[
                0.784_513_610_477_557_3,
                0.235_573_213_359_358_13,
                -1.177_679_984_178_871,
            ]),
            Scheme::KahanLi6 => Half::Verlets(&[
                0.392_161_444_007_314_1,
                0.332_599_136_789_359_44,
                -0.706_246_172_557_639_4,
                0.082_213_596_293_550_8,
            ]),
            Scheme::BlanesMoan6 => Half::Drifts {
                drifts: &[
                    0.050_262_764_400_392_2,
                    0.413_514_300_428_344,
                    0.045_079_889_794_397_7,
                    -0.188_054_853_819_569,
                    0.541_960_678_450_780,
                ],
                kicks: &[
                    0.148_816_447_901_042,
                    -0.132_385_865_767_784,
                    0.067_307_604_692_185,
                    0.432_666_402_578_175,
                ],
            },
            Scheme::BlanesMoanNystrom6 => Half::Kicks {
                kicks: &[
                    0.041_464_998_518_262_4,
                    0.198_128_671_918_067,
                    -0.040_006_192_104_153_3,
                    0.075_253_984_301_580_7,
                    -0.011_511_387_420_687_9,
                ],
                drifts: &[
                    0.123_229_775_946_271,
                    0.290_553_797_799_558,
                    -0.127_049_212_625_417,
                    -0.246_331_761_062_075,
                    0.357_208_872_795_928,
                ],
            },
            Scheme::Yoshida8 => Half::Verlets(&[
                0.741_670_364_350_613,
                -0.409_100_825_800_031_6,
                0.190_754_710_296_238_4,
                -0.573_862_471_116_082_3,
                0.299_064_181_303_655_9,
                0.334_624_918_245_298_2,
                0.315_293_092_396_766_6,
            ]),
            Scheme::KahanLi8 => Half::Verlets(&[
                0.130_202_483_088_890_08,
                0.561_162_981_775_108_4,
                -0.389_474_962_644_847_3,
                0.158_841_906_555_155_6,
                -0.395_903_894_133_237_6,
                0.184_539_640_978_315_7,
                0.258_374_387_686_322_04,
                0.295_011_723_609_310_3,
            ]),
        }
    }

    /// The steps, as parts of the whole, of a symmetric method of order 2 that this scheme composes; none
    /// of a scheme of kicks and drifts.
    pub fn steps(self) -> Option<Vec<f64>> {
        match self.half() {
            Half::Verlets(half) => Some(whole(half)),
            Half::Kicks { .. } | Half::Drifts { .. } => None,
        }
    }

    /// Which flow comes first, and the times of all flows in turn.
    pub(crate) fn times(self) -> (First, Vec<f64>) {
        match self.half() {
            Half::Verlets(steps) => (First::Kick, verlets(steps)),
            Half::Kicks { kicks, drifts } => (First::Kick, in_turn(kicks, drifts)),
            Half::Drifts { kicks, drifts } => (First::Drift, in_turn(drifts, kicks)),
        }
    }
}

const fn facts(name: &'static str, order: u32, stages: u32, limit: f64) -> Facts {
    Facts {
        name,
        order,
        stages,
        evaluation: Evaluation::Explicit,
        symmetric: true,
        symplecticity: Symplecticity::Symplectic,
        energy: EnergyBehavior::Bounded,
        linear_momentum: Conservation::Exact,
        angular_momentum: Conservation::Exact,
        stability: Stability::Below(limit),
        damping: Damping::Conditional,
        error_growth: ErrorGrowth::Linear,
    }
}

/// Half of the steps, the one in the middle, and their mirror image.
fn whole(half: &[f64]) -> Vec<f64> {
    mirrored(half.to_vec(), 1.0 - 2.0 * half.iter().sum::<f64>())
}

/// Steps of Stormer-Verlet, with the kicks between two of them made one.
fn verlets(half: &[f64]) -> Vec<f64> {
    let steps = whole(half);
    let mut times = vec![0.5 * steps[0]];
    for (i, &step) in steps.iter().enumerate() {
        let next = steps.get(i + 1).copied().unwrap_or(0.0);
        times.extend([step, 0.5 * (step + next)]);
    }
    times
}

/// Two flows in turn. The flow with more times has one more of its own before the middle; the last
/// time of each follows from its sum.
fn in_turn(first: &[f64], second: &[f64]) -> Vec<f64> {
    let rest = |times: &[f64], whole: f64| whole - times.iter().sum::<f64>();
    let mut half = Vec::new();
    for (i, &time) in first.iter().enumerate() {
        half.push(time);
        half.push(second.get(i).copied().unwrap_or_else(|| rest(second, 0.5)));
    }
    if first.len() > second.len() {
        mirrored(half, 1.0 - 2.0 * first.iter().sum::<f64>())
    } else {
        half.push(rest(first, 0.5));
        mirrored(half, 1.0 - 2.0 * second.iter().sum::<f64>())
    }
}

/// A palindrome from what comes before its middle.
fn mirrored(mut half: Vec<f64>, middle: f64) -> Vec<f64> {
    let mirror: Vec<f64> = half.iter().rev().copied().collect();
    half.push(middle);
    half.extend(mirror);
    half
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How far a product of exponentials is from `e^(A + B)`: for each number of factors up to
    /// `most`, the largest error of the coefficient of a word in A and B. A word of n letters has
    /// 2^n forms, kept as bits; its coefficient in `e^(A + B)` is 1/n!.
    fn defects(scheme: Scheme, most: usize) -> Vec<f64> {
        let (first, times) = scheme.times();
        let mut words: Vec<Vec<f64>> = (0..=most).map(|n| vec![0.0; 1 << n]).collect();
        words[0][0] = 1.0;
        for (i, time) in times.iter().enumerate() {
            let drift = (i % 2 == 0) == (first == First::Drift);
            for n in (0..=most).rev() {
                for word in 0..1_usize << n {
                    let (mut sum, mut factor) = (words[n][word], 1.0);
                    for taken in 1..=n {
                        // The last letters of the word come from this exponential, if they are its
                        // own.
                        if (word >> (taken - 1) & 1 == 1) != drift {
                            break;
                        }
                        factor *= time / taken as f64;
                        sum += factor * words[n - taken][word >> taken];
                    }
                    words[n][word] = sum;
                }
            }
        }
        let mut factorial = 1.0;
        let mut defects = Vec::new();
        for (n, words) in words.iter().enumerate().skip(1) {
            factorial *= n as f64;
            let off = words.iter().map(|word| (word - 1.0 / factorial).abs());
            defects.push(off.fold(0.0, f64::max));
        }
        defects
    }

    fn is_nystrom(scheme: Scheme) -> bool {
        matches!(scheme, Scheme::BlanesMoanNystrom4 | Scheme::BlanesMoanNystrom6)
    }

    #[test]
    fn the_order_conditions_hold_to_rounding() {
        for scheme in Scheme::ALL {
            let order = scheme.facts().order as usize;
            let defects = defects(scheme, order + 1);
            if !is_nystrom(scheme) {
                assert!(defects[..order].iter().all(|d| *d < 1e-15), "{scheme:?}: {defects:?}");
            }
            assert!(defects[order] > 1e-6, "{scheme:?} has a higher order: {defects:?}");
        }
    }

    #[test]
    fn the_nystrom_scheme_of_order_6_has_order_4_for_other_splittings() {
        let defects = defects(Scheme::BlanesMoanNystrom6, 5);
        assert!(defects[..4].iter().all(|d| *d < 1e-15) && defects[4] > 1e-6, "{defects:?}");
    }

    #[test]
    fn every_sequence_is_a_palindrome_of_alternating_flows_that_last_one_step() {
        for scheme in Scheme::ALL {
            let (first, times) = scheme.times();
            let mirror: Vec<f64> = times.iter().rev().copied().collect();
            assert_eq!(times, mirror, "{scheme:?}");
            for flow in 0..2 {
                let sum: f64 = times.iter().skip(flow).step_by(2).sum();
                assert!((sum - 1.0).abs() < 1e-15, "{scheme:?}: {sum}");
            }
            let kicks = match first {
                First::Kick => times.len() / 2,
                First::Drift => (times.len() - 1) / 2,
            };
            assert_eq!(kicks, scheme.facts().stages as usize, "{scheme:?}");
        }
    }

    #[test]
    fn the_closed_forms_are_what_they_say() {
        assert!((TRIPLE_JUMP - 1.0 / (2.0 - 2_f64.cbrt())).abs() < 4e-16);
        assert!((SUZUKI - 1.0 / (4.0 - 4_f64.cbrt())).abs() < 1e-16);
    }
}
