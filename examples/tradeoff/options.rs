//! The command line.

use std::path::PathBuf;

use crate::measure::CHUNK;
use crate::problems;

pub(crate) const USAGE: &str = "\
options:
  --seeds N      estimates at each number of samples, 8 to 10000 (default 48)
  --samples N    the most samples of an estimate, rounded to a power of 2 for each technique,
                 2048 to 2^24 (default 32768)
  --quick        as --seeds 16 --samples 8192: a few seconds
  --clock        plans with measured costs, which change with every run, not with declared ones
  --out DIR      where to write index.html (default: target/tradeoff)
  --help         this text";

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Options {
    pub(crate) seeds: u64,
    pub(crate) samples: u64,
    pub(crate) clock: bool,
    pub(crate) out: PathBuf,
}

impl Options {
    /// `None` if help was asked for.
    pub(crate) fn of_command_line(
        mut arguments: impl Iterator<Item = String>,
    ) -> Result<Option<Self>, String> {
        let mut options = Self { seeds: 48, samples: 1 << 15, clock: false, out: default_folder() };
        while let Some(name) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{name} needs a value"));
            match name.as_str() {
                "--help" | "-h" => return Ok(None),
                "--quick" => (options.seeds, options.samples) = (16, 8192),
                "--clock" => options.clock = true,
                "--seeds" => options.seeds = whole(&name, &value()?, 8, 10_000)?,
                "--samples" => options.samples = whole(&name, &value()?, 2048, 1 << 24)?,
                "--out" => options.out = value()?.into(),
                _ => return Err(format!("there is no option {name}")),
            }
        }
        Ok(Some(options))
    }

    /// What the progress bar counts: samples of one entry, of all problems.
    pub(crate) fn work(&self) -> u64 {
        let chunks = self.seeds.div_ceil(CHUNK) * CHUNK;
        problems::TECHNIQUES.map(|k| chunks * self.sizes(k).iter().sum::<u64>()).iter().sum()
    }

    /// Numbers of samples: a power of 2 for each of `k` techniques.
    pub(crate) fn sizes(&self, k: u64) -> Vec<u64> {
        let most = (self.samples / k).max(1).ilog2();
        (6..=most.max(8)).map(|exponent| k << exponent).filter(|n| *n >= 256).collect()
    }
}

/// In the target folder of this crate.
fn default_folder() -> PathBuf {
    let target = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target");
    if target.is_dir() { target.join("tradeoff") } else { "tradeoff".into() }
}

fn whole(name: &str, text: &str, least: u64, most: u64) -> Result<u64, String> {
    let number = text.parse().ok().filter(|number| (least..=most).contains(number));
    number.ok_or_else(|| {
        format!("{name} is {text}, but must be a whole number from {least} to {most}")
    })
}
