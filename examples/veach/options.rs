//! The command line.

use std::path::PathBuf;
use std::thread;

use crate::strategies::{STRATEGIES, Strategy};

pub(crate) const USAGE: &str = "\
options:
  --size WxH           pixels of a picture, 16 to 4096 each (default 360x240)
  --rays N             camera rays for each pixel, 4 to 65536 (default 16)
  --samples N          samples for each ray, an even number from 2 to 1000 (default 10)
  --reference-rays N   those of the reference, 16 to 1048576 (default 128)
  --strategy NAME      light, bsdf, constant, balance, power, maximum, one-sample or optimal;
                       may be given several times (default: all)
  --seed N             of the random numbers; the reference has the next one (default 1)
  --threads N          1 to 1024 (default: as many as there are processors)
  --out DIR            where to write the pictures (default: target/veach)
  --quick              as --size 192x128 --rays 8 --reference-rays 64: a few seconds
  --help               this text";

#[derive(Debug, Clone)]
pub(crate) struct Options {
    pub(crate) size: [u32; 2],
    pub(crate) rays: u64,
    pub(crate) samples: u64,
    pub(crate) reference_rays: u64,
    pub(crate) strategies: Vec<&'static Strategy>,
    pub(crate) seed: u64,
    pub(crate) threads: usize,
    pub(crate) out: PathBuf,
}

impl Options {
    /// `None` if help was asked for.
    pub(crate) fn of_command_line(
        mut arguments: impl Iterator<Item = String>,
    ) -> Result<Option<Self>, String> {
        let mut options = Self {
            size: [360, 240],
            rays: 16,
            samples: 10,
            reference_rays: 128,
            strategies: Vec::new(),
            seed: 1,
            threads: thread::available_parallelism().map_or(1, usize::from),
            out: default_folder(),
        };
        while let Some(name) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{name} needs a value"));
            match name.as_str() {
                "--help" | "-h" => return Ok(None),
                "--quick" => {
                    (options.size, options.rays, options.reference_rays) = ([192, 128], 8, 64);
                }
                "--size" => options.size = size(&name, &value()?)?,
                "--rays" => options.rays = whole(&name, &value()?, 4, 1 << 16)?,
                "--samples" => options.samples = even(&name, &value()?)?,
                "--reference-rays" => {
                    options.reference_rays = whole(&name, &value()?, 16, 1 << 20)?;
                }
                "--strategy" => options.strategies.push(strategy(&name, &value()?)?),
                "--seed" => options.seed = whole(&name, &value()?, 0, u64::MAX - 1)?,
                "--threads" => {
                    let threads = whole(&name, &value()?, 1, 1024)?;
                    options.threads = usize::try_from(threads).unwrap_or(1);
                }
                "--out" => options.out = value()?.into(),
                _ => return Err(format!("there is no option {name}")),
            }
        }
        // Each once, in the order of the tables.
        let named = |strategy: &&'static Strategy| {
            options.strategies.is_empty()
                || options.strategies.iter().any(|s| s.name == strategy.name)
        };
        options.strategies = STRATEGIES.iter().filter(named).collect();
        Ok(Some(options))
    }
}

/// In the target folder of this crate.
fn default_folder() -> PathBuf {
    let target = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target");
    if target.is_dir() { target.join("veach") } else { "veach".into() }
}

fn size(name: &str, text: &str) -> Result<[u32; 2], String> {
    let side = |text: &str| text.parse().ok().filter(|side| (16..=4096).contains(side));
    let sides = text.split_once('x').and_then(|(w, h)| Some([side(w)?, side(h)?]));
    let rule = "a width and a height from 16 to 4096, such as 360x240";
    sides.ok_or_else(|| format!("{name} is {text}, but must be {rule}"))
}

fn strategy(name: &str, text: &str) -> Result<&'static Strategy, String> {
    STRATEGIES.iter().find(|strategy| strategy.name == text).ok_or_else(|| {
        let names = STRATEGIES.map(|strategy| strategy.name).join(", ");
        format!("{name} is {text}, but must be one of {names}")
    })
}

fn even(name: &str, text: &str) -> Result<u64, String> {
    let number = text.parse().ok().filter(|number| (2..=1000).contains(number) && number % 2 == 0);
    number.ok_or_else(|| format!("{name} is {text}, but must be an even number from 2 to 1000"))
}

fn whole(name: &str, text: &str, least: u64, most: u64) -> Result<u64, String> {
    let number = text.parse().ok().filter(|number| (least..=most).contains(number));
    number.ok_or_else(|| {
        format!("{name} is {text}, but must be a whole number from {least} to {most}")
    })
}
