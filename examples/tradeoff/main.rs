//! The trade, measured: every estimator, weighting, point source and allocation on a set of problems.
//!
//! For each problem, an ensemble of estimates with fixed seeds gives the error against the exact value, over
//! a grid of numbers of samples, and the time. One HTML page shows error against samples, error against
//! time, efficiencies, and the variances that a pilot predicted beside those that came out; a table says
//! who wins, and by how much. It opens in any browser, without a network.
//!
//! `cargo run --release --example tradeoff`, or with options:
//! `... --example tradeoff -- --seeds 200 --samples 262144 --out target/page`

mod bars;
mod checks;
mod entries;
mod errors;
mod measure;
mod options;
mod page;
mod plot;
mod predictions;
mod problems;
mod winners;

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

    let rows = winners::rows(&results);
    winners::print(&rows);
    std::fs::create_dir_all(&options.out)?;
    let path = options.out.join("index.html");
    std::fs::write(&path, page::html(&results, &rows, options, &machine()))?;
    println!("\n{}", checks::all(&results)?);
    println!("written to {}, after {:.1} s", path.display(), start.elapsed().as_secs_f64());
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

/// The processor, where it says what it is.
fn machine() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|line| line.strip_prefix("model name")?.split(": ").nth(1));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let model: String =
        model.unwrap_or(std::env::consts::ARCH).chars().filter(|c| !"<>&".contains(*c)).collect();
    format!("{model}, {cores} cores, {}", std::env::consts::OS)
}
