//! Given numbers, replayed.

use super::{PointSource, PointsExhausted};
use crate::error::ArgumentError;

/// Canonical numbers that are given: those of a printed table, of another generator, or those
/// that reproduce a fault.
///
/// ```
/// use mis::{Estimator, MultiSample, points::Replay, technique::Uniform};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let p = Uniform::new(0.0, 2.0)?;
/// let xi = Replay::new([vec![0.25, 0.75]])?;
/// let estimate = MultiSample::new(&[(&p, 2)])?.estimate_from(&|x: &f64| x * x, &xi)?;
/// assert_eq!(estimate.value(), 2.5); // 2 · (0.5² + 1.5²) / 2
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Replay {
    streams: Vec<Vec<f64>>,
}

impl Replay {
    /// One stream of numbers a technique, the coordinates of a sample side by side.
    ///
    /// # Errors
    ///
    /// Every number must be in \[0, 1\].
    pub fn new(streams: impl IntoIterator<Item = Vec<f64>>) -> Result<Self, ArgumentError> {
        let streams: Vec<_> = streams.into_iter().collect();
        for (s, stream) in streams.iter().enumerate() {
            for (t, u) in stream.iter().enumerate() {
                if !(0.0..=1.0).contains(u) {
                    let argument = format!("streams[{s}][{t}]");
                    return Err(ArgumentError::new("Replay", argument, u, "it must be in [0, 1]"));
                }
            }
        }
        Ok(Self { streams })
    }
}

impl PointSource for Replay {
    fn fill(
        &self,
        stream: usize,
        first: u64,
        dimension: usize,
        xi: &mut [f64],
    ) -> Result<(), PointsExhausted> {
        let numbers = self.streams.get(stream).map_or(&[][..], Vec::as_slice);
        let start = usize::try_from(first).unwrap_or(usize::MAX).saturating_mul(dimension);
        let given = numbers.get(start..).unwrap_or(&[]);
        match given.get(..xi.len()) {
            Some(given) => {
                xi.copy_from_slice(given);
                Ok(())
            }
            None => Err(PointsExhausted {
                stream,
                sample: first.saturating_add((given.len() / dimension.max(1)) as u64),
                dimension,
                available: numbers.len(),
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{PointSource, Replay};

    #[test]
    fn rows_are_replayed_from_any_sample() {
        let replay = Replay::new([vec![], vec![0.1, 0.2, 0.3, 0.4, 0.5]]).unwrap();
        let mut xi = [0.0; 2];
        replay.fill(1, 1, 2, &mut xi).unwrap();
        assert_eq!(xi, [0.3, 0.4]);
    }

    #[test]
    fn running_out_names_stream_and_sample() {
        let replay = Replay::new([vec![0.1, 0.2, 0.3]]).unwrap();
        let error = replay.fill(0, 0, 2, &mut [0.0; 4]).unwrap_err();
        assert_eq!((error.stream, error.sample, error.available), (0, 1, 3));
        assert!(replay.fill(1, 0, 1, &mut [0.0]).is_err());
        assert!(replay.fill(0, u64::MAX, 2, &mut [0.0; 2]).is_err());
    }

    #[test]
    fn a_number_outside_the_unit_interval_is_refused() {
        for bad in [-0.1, 1.5, f64::NAN] {
            let error = Replay::new([vec![0.5], vec![0.5, bad]]).unwrap_err();
            assert_eq!(error.argument(), "streams[1][1]");
        }
    }
}
