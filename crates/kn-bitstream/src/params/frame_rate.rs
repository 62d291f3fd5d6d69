//! Frames per second as a fraction.

use std::fmt;
use std::str::FromStr;

/// Frames per second, `numerator` / `denominator`, both at least 1 (`header.rate.range`).
///
/// Text forms are `30`, `29.97` and `30000/1001`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRate {
    /// Frames in `denominator` seconds.
    pub numerator: u32,
    /// Seconds that `numerator` frames take.
    pub denominator: u32,
}

impl FrameRate {
    /// A rate from its two numbers.
    pub const fn new(numerator: u32, denominator: u32) -> Self {
        Self { numerator, denominator }
    }

    /// Frames per second as a number.
    pub fn per_second(self) -> f64 {
        f64::from(self.numerator) / f64::from(self.denominator)
    }
}

impl Default for FrameRate {
    /// 30 frames a second.
    fn default() -> Self {
        Self::new(30, 1)
    }
}

impl fmt::Display for FrameRate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.denominator {
            1 => write!(f, "{}", self.numerator),
            denominator => write!(f, "{}/{denominator}", self.numerator),
        }
    }
}

impl FromStr for FrameRate {
    type Err = FrameRateError;

    fn from_str(text: &str) -> Result<Self, FrameRateError> {
        let (numerator, denominator) = match (text.split_once('/'), text.split_once('.')) {
            (Some((over, under)), _) => (over.parse().ok(), under.parse().ok()),
            (None, Some((whole, decimals))) if decimals.len() <= 4 => {
                let digits = format!("{whole}{decimals}").parse().ok();
                (digits, Some(10_u32.pow(decimals.len() as u32)))
            }
            _ => (text.parse().ok(), Some(1)),
        };
        match (numerator, denominator) {
            (Some(numerator @ 1..), Some(denominator @ 1..)) => Ok(Self { numerator, denominator }),
            _ => Err(FrameRateError),
        }
    }
}

/// The error for a text that is not a frame rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRateError;

impl fmt::Display for FrameRateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a frame rate is a positive number such as 30, 29.97 or 30000/1001")
    }
}

impl std::error::Error for FrameRateError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_rates_are_exact() {
        let rate = |text: &str| text.parse::<FrameRate>();
        assert_eq!(rate("30"), Ok(FrameRate::new(30, 1)));
        assert_eq!(rate("29.97"), Ok(FrameRate::new(2997, 100)));
        assert_eq!(rate("30000/1001"), Ok(FrameRate::new(30000, 1001)));
        for bad in ["", "0", "-1", "1/0", "0/1", "x", "1e3", "1.23456", "9999999999"] {
            assert!(rate(bad).is_err(), "{bad}");
        }
        assert_eq!(FrameRate::new(30000, 1001).to_string().parse(), rate("30000/1001"));
    }
}
