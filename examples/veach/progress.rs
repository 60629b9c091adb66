//! The progress bar.

use std::error::Error;
use std::io::{IsTerminal, stderr};
use std::sync::atomic::{AtomicU64, Ordering};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar on stderr that counts rays; it draws nothing if that is no terminal.
pub(crate) struct Progress {
    bar: ProgressBar,
    /// The rays of what is finished.
    done: AtomicU64,
}

impl Progress {
    pub(crate) fn new(rays: u64) -> Result<Self, Box<dyn Error>> {
        let target = if stderr().is_terminal() {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let style = ProgressStyle::with_template("[{bar:30}] {percent:>3} % {elapsed} {msg}")?;
        let bar = ProgressBar::with_draw_target(Some(rays), target);
        Ok(Self { bar: bar.with_style(style.progress_chars("=> ")), done: AtomicU64::new(0) })
    }

    pub(crate) fn name(&self, name: &'static str) {
        self.bar.set_message(name);
    }

    /// Shows that a part, from 0 to 1, of so many rays is done.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // Counts, far below 2^53.
    pub(crate) fn part(&self, part: f64, rays: u64) {
        let position = self.done.load(Ordering::Relaxed) + (part * rays as f64) as u64;
        self.bar.set_position(position);
    }

    /// Counts so many rays as done.
    pub(crate) fn add(&self, rays: u64) {
        let before = self.done.fetch_add(rays, Ordering::Relaxed);
        self.bar.set_position(before + rays);
    }

    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
