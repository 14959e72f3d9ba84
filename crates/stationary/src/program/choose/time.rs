//! A length of time as people write it.

use std::time::Duration;

use stationary_choose::QuestionError;

/// What is not a length of time.
#[derive(Debug, thiserror::Error)]
pub enum TimeError {
    /// It is not written as one.
    #[error("`{0}` is no time; write `60s`, `500ms` or `2min`")]
    Word(String),
    /// It is none.
    #[error(transparent)]
    Nothing(#[from] QuestionError),
}

/// `500ms`, `60s`, `2min` or `1h`.
///
/// # Errors
/// [`TimeError`] for anything else, and for nothing at all.
pub fn time(text: &str) -> Result<Duration, TimeError> {
    let text = text.trim();
    let unknown = || TimeError::Word(text.to_owned());
    let digits = text.find(|c: char| c.is_ascii_alphabetic()).ok_or_else(unknown)?;
    let (number, unit) = text.split_at(digits);
    let seconds = match unit {
        "ms" => 1e-3,
        "s" => 1.0,
        "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(unknown()),
    };
    let number: f64 = number.trim().parse().map_err(|_| unknown())?;
    let time = Duration::try_from_secs_f64(number * seconds).map_err(|_| unknown())?;
    if time.is_zero() { Err(QuestionError::Budget(time).into()) } else { Ok(time) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_has_a_number_and_a_unit() {
        assert_eq!(time("60s").unwrap(), Duration::from_secs(60));
        assert_eq!(time(" 1.5 min").unwrap(), Duration::from_secs(90));
        assert_eq!(time("500ms").unwrap(), Duration::from_millis(500));
        for wrong in ["60", "", "s", "-1s", "NaNs", "1 fortnight", "1e300h"] {
            assert!(matches!(time(wrong), Err(TimeError::Word(_))), "{wrong}");
        }
    }

    #[test]
    fn no_time_is_no_budget() {
        assert!(matches!(time("0s"), Err(TimeError::Nothing(_))));
    }
}
