//! A weight scheme with its parameter.

use crate::params::WeightScheme;
use std::fmt;
use std::str::FromStr;

/// A weight scheme and its parameter σ, which only [`WeightScheme::Gaussian`] has. The header
/// carries the scheme, the key nodes carry σ.
///
/// Text forms are `inverse-square`, `sumner` and `gaussian:SIGMA`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Weights {
    scheme: WeightScheme,
    sigma: Option<u32>,
}

impl Weights {
    /// Weights by [`WeightScheme::InverseSquare`].
    pub const INVERSE_SQUARE: Self = Self { scheme: WeightScheme::InverseSquare, sigma: None };
    /// Weights by [`WeightScheme::Sumner`].
    pub const SUMNER: Self = Self { scheme: WeightScheme::Sumner, sigma: None };

    /// Weights by [`WeightScheme::Gaussian`]; `sigma` is in grid steps. A stream holds 1 to 2^20 −
    /// 1.
    pub const fn gaussian(sigma: u32) -> Self {
        Self { scheme: WeightScheme::Gaussian, sigma: Some(sigma) }
    }

    /// The weights of a stream: the header's scheme and the σ of the key nodes, which is present
    /// with the Gaussian scheme only (`nodes.sigma.range`). `None` where they disagree.
    pub fn of_stream(scheme: WeightScheme, sigma: Option<u32>) -> Option<Self> {
        let has_sigma = scheme == WeightScheme::Gaussian;
        (has_sigma == sigma.is_some()).then_some(Self { scheme, sigma })
    }

    /// The scheme.
    pub const fn scheme(self) -> WeightScheme {
        self.scheme
    }

    /// σ in grid steps, with the Gaussian scheme.
    pub const fn sigma(self) -> Option<u32> {
        self.sigma
    }
}

impl fmt::Display for Weights {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.sigma {
            Some(sigma) => write!(f, "{}:{sigma}", self.scheme),
            None => write!(f, "{}", self.scheme),
        }
    }
}

impl FromStr for Weights {
    type Err = WeightsError;

    fn from_str(text: &str) -> Result<Self, WeightsError> {
        let (scheme, sigma) = match text.split_once(':') {
            Some((scheme, sigma)) => (scheme, Some(sigma.parse().map_err(|_| WeightsError)?)),
            None => (text, None),
        };
        let scheme = scheme.parse().map_err(|_| WeightsError)?;
        Self::of_stream(scheme, sigma).filter(|_| sigma != Some(0)).ok_or(WeightsError)
    }
}

/// The error for a text that is not a form of [`Weights`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WeightsError;

impl fmt::Display for WeightsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("weights are inverse-square, sumner or gaussian:SIGMA, SIGMA in grid steps")
    }
}

impl std::error::Error for WeightsError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_read_back_from_their_text() {
        for weights in [Weights::INVERSE_SQUARE, Weights::SUMNER, Weights::gaussian(40)] {
            assert_eq!(weights.to_string().parse(), Ok(weights));
        }
        for bad in ["", "gaussian", "gaussian:0", "gaussian:-1", "sumner:3", "gaussian:"] {
            assert_eq!(bad.parse::<Weights>(), Err(WeightsError), "{bad}");
        }
    }

    #[test]
    fn sigma_belongs_to_the_gaussian_scheme() {
        assert_eq!(Weights::of_stream(WeightScheme::Sumner, Some(3)), None);
        assert_eq!(Weights::of_stream(WeightScheme::Gaussian, None), None);
        let gaussian = Weights::of_stream(WeightScheme::Gaussian, Some(3));
        assert_eq!(gaussian, Some(Weights::gaussian(3)));
    }
}
