//! What this process has taken of the processors: on a busy machine a clock on the wall would end
//! trials early and call slow cases hanging.

use std::fs;
use std::time::{Duration, Instant};

/// Linux counts in hundredths of a second, whatever its kernel's own tick is.
const TICK: Duration = Duration::from_millis(10);
/// The place of the process's own ticks after its name, and behind it that of the system's for it.
const TICKS: usize = 11;

/// A clock that stands still while others have the processors.
#[derive(Clone, Copy, Debug)]
pub struct ProcessorTime {
    begun: Instant,
    before: Duration,
}

impl ProcessorTime {
    /// A clock at zero.
    pub fn begin() -> Self {
        ProcessorTime { begun: Instant::now(), before: taken().unwrap_or_default() }
    }

    /// What was taken since; where the system does not say, what has passed.
    pub fn passed(&self) -> Duration {
        taken().map_or_else(|| self.begun.elapsed(), |taken| taken.saturating_sub(self.before))
    }
}

/// What all threads of the process have taken so far.
fn taken() -> Option<Duration> {
    let stat = fs::read_to_string("/proc/self/stat").ok()?;
    let (_, after_name) = stat.rsplit_once(')')?;
    let mut ticks = after_name.split_whitespace().skip(TICKS).map(str::parse::<u32>);
    Some(TICK * (ticks.next()?.ok()? + ticks.next()?.ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::hint::black_box;

    #[test]
    fn the_clock_goes_on_while_the_process_computes() {
        let clock = ProcessorTime::begin();
        let mut sum = 0.0;
        while clock.passed() < 2 * TICK {
            sum += (0..100_000).map(f64::from).sum::<f64>();
        }
        assert!(black_box(sum) > 0.0);
    }
}
