//! The page: table, figures and what they mean, in one file.

use std::fmt::Write;

use crate::bars::bars;
use crate::entries::PILOT;
use crate::errors::{self, Against};
use crate::measure::Results;
use crate::options::Options;
use crate::predictions;
use crate::winners::{HEAD, Row};

pub(crate) fn html(results: &[Results], rows: &[Row], options: &Options, machine: &str) -> String {
    let mut out = String::from(TOP);
    let _ = write!(
        out,
        "<p>{} problems, each integrated in every way that makes sense: every weighting, estimator, \
         allocation of samples and source of points. Errors are against the exact value.</p>\n\
         <h2>Who wins, and by how much</h2>\n",
        results.len()
    );
    table(&mut out, rows);
    let seeds = options.seeds;
    let costs = if options.clock {
        "measured costs"
    } else {
        "declared costs, so that all but the times is the same in every run"
    };
    let _ = write!(
        out,
        "<p class='caption'><b>Table 1.</b> At equal samples: the least root mean square error at the most \
         samples, and how many times lower its variance is than that of the balance heuristic with \
         equal samples and random points. At equal time: the highest efficiency, 1 / (variance · time), \
         over that of balance with random points, and over that of the technique that is best alone \
         (with random points). “exact”: errors below 10<sup>−12</sup> of the value. The largest of \
         many noisy efficiencies is a little too large.</p>\n\
         <h2>Method</h2>\n<p>Every point is an ensemble of {seeds} estimates with fixed seeds; its error \
         is √(mean of (F − μ)²) / |μ| with the exact μ, and bands and whiskers are one standard error. N \
         counts the samples of all techniques together. Times are wall-clock seconds of one core, the \
         first decile of the ensemble, two threads at work ({machine}). Variances “realised” \
         are means of N (F − μ)² / μ² over all estimates with N ≥ 1024. A pilot of {PILOT} \
         samples of each technique predicts every variance, optimises shares (“opt. shares”) and recommends \
         a plan (▸), with {costs}; pilots are not part of N or of times. “(pilot)”: the control \
         coefficients of optimal MIS are the pilot’s; otherwise they are made of the estimate’s own \
         samples (direct: all of them, which is slightly biased; cross-fit: of other folds; \
         progressive: of earlier batches). Shares become whole numbers of samples: coefficients of a pilot \
         then fit a little less well, which is all the error that is left in problems D and E; and \
         Sobol’ points, which are best in powers of 2, lose some of their evenness.</p>\n\
         <h2>Predictions of all problems</h2>\n<figure>{}<figcaption><b>Figure 1.</b> What a pilot of {PILOT} \
         samples of each technique predicts, against what comes out. Each mark is a method; \
         hollow marks are flagged as uncertain by the pilot itself. Grey: within \
         20 %.</figcaption></figure>\n",
        predictions::ratios(results)
    );
    for (k, results) in results.iter().enumerate() {
        problem(&mut out, k, results);
    }
    out.push_str("</main>\n</body>\n</html>\n");
    out
}

fn table(out: &mut String, rows: &[Row]) {
    out.push_str("<table>\n<thead><tr>");
    for head in HEAD {
        let _ = write!(out, "<th>{head}</th>");
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for row in rows {
        out.push_str("<tr>");
        for cell in &row.cells {
            // A superscript of a picture is none in a page.
            let cell = cell
                .replace("<tspan class='exponent' dy='-4'>", "<sup>")
                .replace("</tspan>", "</sup>");
            let _ = write!(out, "<td>{cell}</td>");
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody>\n</table>\n");
}

fn problem(out: &mut String, k: usize, results: &Results) {
    let id = |letter: char| format!("p{k}{letter}");
    let weightings = errors::weightings(results);
    let points = errors::points(results);
    let fast = errors::fast(results);
    let a = errors::chart(
        &id('a'),
        ["a", "Error against samples: weightings, random points"],
        &weightings,
        Against::Samples,
    );
    let b = errors::chart(
        &id('b'),
        ["b", "Error against samples: sources of points"],
        &points,
        Against::Samples,
    );
    let d = errors::chart(
        &id('d'),
        ["d", "Error against time"],
        &fast,
        Against::Time(results.planning),
    );
    let c = bars(&id('c'), results);
    let e = predictions::scatter(&id('e'), results);
    let best = results
        .least_single()
        .map_or(String::new(), |single| format!(" Best technique: {}.", single.entry.name));
    let _ = write!(
        out,
        "<section>\n<h2>{}. {}</h2>\n<p>{}. μ = {:.6}. Techniques: {}.{best}</p>\n\
         <figure class='grid2'>\n<div>{a}</div>\n<div>{b}</div>\n<div>{c}</div>\n\
         <div>{d}\n{e}</div>\n<figcaption><b>Figure {}.</b> {}. (a, b) Relative error against samples; \
         dotted: slopes. (c) All ways by efficiency at the most samples: random points \
         <i class='k random'></i>, antithetic <i class='k antithetic'></i>, strata \
         <i class='k strata'></i>, Sobol’ <i class='k sobol'></i>; ▸ what the plan recommends. (d) Against \
         time, without the pilot; pilot and plan take {:.0} ms. (e) \
         Variances that one pilot predicts for all ways with random points, and those that come \
         out.</figcaption>\n</figure>\n</section>\n",
        k + 1,
        results.name,
        results.about,
        results.exact,
        results.techniques.join(", "),
        k + 2,
        results.name,
        1e3 * results.planning
    );
}

const TOP: &str = "\
<!DOCTYPE html>
<html lang='en'>
<head>
<meta charset='utf-8'/>
<meta name='viewport' content='width=device-width'/>
<title>Multiple importance sampling: accuracy against time</title>
<style>
body { margin: 0; background: #fff; color: #111; font: 15px/1.45 Georgia, 'DejaVu Serif', serif }
main { width: 1200px; margin: 0 auto; padding: 24px 0 60px }
h1 { font-size: 27px; margin: 0 0 6px }
h2 { font-size: 20px; margin: 30px 0 6px }
p { margin: 6px 0 10px }
section { border-top: 1px solid #bbb; margin-top: 34px }
figure { margin: 10px 0 }
.grid2 { display: grid; grid-template-columns: 595px 595px; column-gap: 10px; align-items: start }
.grid2 figcaption { grid-column: 1 / 3 }
figcaption, .caption { font-size: 13.5px; color: #333; line-height: 1.4 }
table { border-collapse: collapse; width: 100%; font: 13px/1.3 Helvetica, Arial, 'DejaVu Sans', sans-serif;
  border-top: 1.5px solid #111; border-bottom: 1.5px solid #111 }
th { text-align: left; font-weight: 600; border-bottom: 1px solid #111; vertical-align: bottom }
th, td { padding: 4px 9px 4px 0 }
td { vertical-align: top; border-bottom: 1px solid #e4e4e4 }
td:first-child { white-space: nowrap; font-weight: 600 }
sup { font-size: 75%; line-height: 0 }
svg { display: block; font-family: Helvetica, Arial, 'DejaVu Sans', sans-serif; font-size: 12px }
.title { font-size: 13.5px; font-weight: 600 }
.letter { font-weight: 700 }
.label { font-size: 13px }
.tick, .name { font-size: 11.5px; fill: #222 }
.plan { font-weight: 700 }
.note { font-size: 11px; fill: #555 }
.halo { paint-order: stroke; stroke: #fff; stroke-width: 3px }
.exponent { font-size: 8.5px }
.grid { stroke: #d4d4d4; fill: none }
.minor { stroke: #efefef; fill: none }
.frame { fill: none; stroke: #222 }
.guide { stroke: #777; stroke-dasharray: 1.5 3; fill: none }
.diagonal { stroke: #444; fill: none }
.leader { stroke: #bbb; fill: none }
.whisker { stroke: #222; fill: none }
.k { display: inline-block; width: 11px; height: 10px }
.random { background: #0072b2 } .antithetic { background: #cc79a7 }
.strata { background: #e69f00 } .sobol { background: #009e73 }
@media print { section { break-before: page } }
</style>
</head>
<body>
<main>
<h1>Multiple importance sampling: accuracy against time</h1>
";
