//! Colours.

use crate::error::ArgumentError;
use crate::integrand::Value;

/// A grey value or one of `K` colour channels: `f64` or `[f64; K]`.
pub trait Spectrum: Value<Each<f64> = Self> + Copy + Send + Sync {
    /// The product, channel by channel, times `factor`.
    #[must_use]
    fn scaled_product(&self, other: &Self, factor: f64) -> Self {
        Self::each(|channel| self.times(channel, other.times(channel, factor)))
    }

    /// The sum, channel by channel.
    #[must_use]
    fn plus(&self, other: &Self) -> Self {
        Self::each(|channel| self.times(channel, 1.0) + other.times(channel, 1.0))
    }

    /// The sum of the channels.
    #[must_use]
    fn total(&self) -> f64 {
        (0..Self::COMPONENTS).map(|channel| self.times(channel, 1.0)).sum()
    }

    /// Every channel times `factor`.
    #[must_use]
    fn scaled(&self, factor: f64) -> Self {
        Self::each(|channel| self.times(channel, factor))
    }
}

impl<V: Value<Each<f64> = V> + Copy + Send + Sync> Spectrum for V {}

/// Checks every channel of `value` against `lower..=upper`.
pub(super) fn check_channels<V: Spectrum>(
    owner: &'static str,
    argument: &'static str,
    value: &V,
    upper: f64,
    rule: &'static str,
) -> Result<(), ArgumentError> {
    let valid =
        (0..V::COMPONENTS).all(|channel| (0.0..=upper).contains(&value.times(channel, 1.0)));
    if valid { Ok(()) } else { Err(ArgumentError::new(owner, argument, value, rule)) }
}
