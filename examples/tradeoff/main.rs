//! The trade, measured: every estimator, weighting, point source and allocation on a set of problems.
//!
//! For each problem, an ensemble of estimates with fixed seeds gives the error against the exact value, over
//! a grid of numbers of samples, and the time. One HTML page shows error against samples, error against
//! time, efficiencies, and the variances that a pilot predicted beside those that came out; a table says
//! who wins, and by how much. It opens in any browser, without a network.
//!
//! `cargo run --release --example tradeoff`, or with options:
//! `... --example tradeoff -- --seeds 200 --samples 262144 --out /tmp/page`

mod entries;
mod measure;
mod options;
mod problems;

use std::error::Error;
use std::io::{IsTerminal, stderr};
use std::process::ExitCode;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use measure::Runner;
use options::{Options, USAGE};

fn main() -> ExitCode {
    let options = match Options::of_command_line(std::env::args().skip(1)) {
        Ok(Some(options)) => options,
        Ok(None) => {
            println!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        Err(message) => {
            eprintln!("tradeoff: {message}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match run(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("tradeoff: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let bar = bar(options)?;
    let mut runner = Runner { options, bar: &bar, results: Vec::new() };
    problems::visit_all(&mut runner)?;
    let results = runner.results;
    bar.finish_and_clear();
    for r in &results {
        println!("{} {} planning {}", r.name, r.exact, r.planning);
        for s in &r.series {
            let p = s.entry.predicted;
            println!("  {:<45} err {:.3e} var {:.4e} ± {:.0e} pred {:.4e} {:?} z {:.2} ns {:.1} eff {:.3e} {}", s.entry.name, s.error(), s.variance.0, s.variance.1 / s.variance.0,
                p.map_or(f64::NAN, |p| p.variance), p.and_then(|p| p.caution), s.z, s.nanoseconds(), s.efficiency().0, if s.entry.plan { "PLAN" } else { "" });
        }
    }
    println!("{:.1} s", start.elapsed().as_secs_f64());
    Ok(())
}

/// A bar on stderr; it draws nothing if that is no terminal.
fn bar(options: &Options) -> Result<ProgressBar, Box<dyn Error>> {
    let target = if stderr().is_terminal() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    };
    let style = ProgressStyle::with_template("[{bar:30}] {percent:>3} % {elapsed} {msg}")?;
    let bar = ProgressBar::with_draw_target(Some(options.work()), target);
    Ok(bar.with_style(style.progress_chars("=> ")))
}
