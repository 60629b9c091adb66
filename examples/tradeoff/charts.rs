//! The charts of a problem.

use mis::plan::{Caution, Method};

use crate::entries::{EQUAL, Entry, Points, Way};
use crate::measure::{Point, ROUNDING, Results, Series};
use crate::plot::{COLOURS, Picture, Scale, Style, mark};

/// A curve: what it shows, and how.
type Curve<'a> = (&'a Series, String, Style);

const fn style(colour: usize, dash: usize, mark: usize) -> Style {
    Style { colour, dash, mark, width: 1.6 }
}

/// Of the recommended plan.
const PLAN: Style = Style { colour: 0, dash: 0, mark: 2, width: 2.6 };

/// Weightings and estimators from random points, with equal shares if not said otherwise.
pub(crate) fn weightings(results: &Results) -> Vec<Curve<'_>> {
    let mut curves = Vec::new();
    if let Some(single) = results.best_single().filter(|single| !single.entry.plan) {
        curves.push((single, single.entry.name.clone(), style(7, 2, 3)));
    }
    for (name, style) in [
        (EQUAL, style(1, 1, 1)),
        ("power 2", style(2, 3, 4)),
        ("maximum", style(6, 2, 1)),
        ("one-sample", style(7, 4, 0)),
        ("balance", style(4, 0, 0)),
        ("balance, adaptive shares", style(3, 1, 3)),
        ("optimal MIS (progressive)", style(5, 2, 4)),
        ("optimal MIS (cross-fit)", style(5, 0, 1)),
    ] {
        curves.extend(results.named(name).map(|series| (series, series.entry.name.clone(), style)));
    }
    curves.extend(plan(results));
    curves
}

fn plan(results: &Results) -> Option<Curve<'_>> {
    results.plan().map(|plan| (plan, "recommended plan".to_string(), PLAN))
}

/// Other points, under a few weightings.
pub(crate) fn points(results: &Results) -> Vec<Curve<'_>> {
    let mut curves = Vec::new();
    for (name, style) in [
        ("balance", style(4, 0, 0)),
        ("balance, antithetic", style(4, 2, 3)),
        ("balance, strata", style(4, 1, 1)),
        ("balance, Sobol’", style(4, 3, 4)),
        ("maximum, Sobol’", style(6, 3, 4)),
        ("constant, equal, Sobol’", style(1, 3, 4)),
        ("optimal MIS (cross-fit), Sobol’", style(5, 3, 4)),
    ] {
        curves.extend(results.named(name).map(|series| (series, series.entry.name.clone(), style)));
    }
    curves.extend(plan(results));
    let sobol = results.find(|entry| entry.plan && entry.points == Points::Sobol);
    if let Some(series) = sobol {
        curves.push((series, "plan, Sobol’".into(), Style { dash: 3, mark: 4, ..PLAN }));
    }
    curves
}

/// Curves of error against time: a few of both charts.
pub(crate) fn fast(results: &Results) -> Vec<Curve<'_>> {
    let mut curves = weightings(results);
    curves.retain(|(_, name, _)| {
        !["one-sample", "maximum", "optimal MIS (progressive)"].contains(&name.as_str())
    });
    for (series, name, style) in points(results) {
        if ["balance, Sobol’", "optimal MIS (cross-fit), Sobol’", "plan, Sobol’"]
            .contains(&name.as_str())
        {
            curves.push((series, name, style));
        }
    }
    curves
}

/// What a chart of errors has below.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Against {
    Samples,
    /// Seconds of one core, and those that planning takes.
    Time(f64),
}

/// Error against samples or time, with bands of one standard error.
pub(crate) fn errors(
    id: &str,
    [letter, title]: [&str; 2],
    curves: &[Curve<'_>],
    against: Against,
) -> String {
    let x_of = |point: &Point| match against {
        Against::Samples => point.samples as f64,
        Against::Time(_) => point.seconds,
    };
    let shown = |series: &Series| -> Vec<[f64; 4]> {
        let all = series.points.iter().filter(|point| point.rmse() > ROUNDING);
        let shown = all.map(|point| {
            let [low, high] = point.band();
            [x_of(point), point.rmse(), low, high]
        });
        if series.is_exact() { Vec::new() } else { shown.collect() }
    };
    let all: Vec<[f64; 4]> = curves.iter().flat_map(|(series, ..)| shown(series)).collect();
    let every_x = curves.iter().flat_map(|(series, ..)| series.points.iter().map(&x_of));
    let x = Scale::around(every_x, [0.06, 0.06]);
    let exact = curves.iter().filter(|(series, ..)| series.is_exact()).count();
    let range = Scale::around(all.iter().flat_map(|p| [p[2], p[3]]), [0.1, 0.15]);
    // Room below for the names of what is exact, and above for the guides.
    let [low, high] = range.ends();
    let room = (high / low).log10() * 0.052 * exact as f64;
    let y = Scale::around([low, high], [room, 0.0]);
    let mut picture = Picture::new(id, [590.0, 410.0], [62.0, 28.0, 200.0, 50.0], x, y);
    picture.title(letter, title);
    let x_label = match against {
        Against::Samples => "samples N",
        Against::Time(_) => "time t / s, one core",
    };
    picture.axes(x_label, "relative error (RMS)");
    let bottom = picture.frame[3] - 16.0 * exact as f64;
    guides(&mut picture, against, bottom);
    if let Against::Time(planning) = against {
        if picture.x.has(planning) {
            let [low, high] = picture.y.ends();
            picture.segment([planning, low], [planning, high], "guide");
            let at = [picture.x.at(planning) - 4.0, picture.frame[1] + 12.0];
            picture.text(at, "note", "end", "pilot and plan");
        }
    }
    for (series, _, style) in curves {
        let band: Vec<[f64; 3]> =
            shown(series).into_iter().map(|[x, _, low, high]| [x, low, high]).collect();
        if band.len() > 1 {
            picture.band(&band, COLOURS[style.colour], 0.13);
        }
    }
    let mut names = Vec::new();
    let mut bottom = picture.frame[3] - 7.0;
    for (series, name, style) in curves {
        let line: Vec<[f64; 2]> = shown(series).iter().map(|[x, y, ..]| [*x, *y]).collect();
        picture.curve(&line, *style);
        if let Some([x, y]) = line.last() {
            names.push((picture.x.at(*x), picture.y.at(*y), name.clone(), *style));
        } else {
            let at = [picture.frame[0] + 14.0, bottom - 4.0];
            picture.draw(&mark(at, *style, 3.0, true));
            let text =
                format!("{name}: exact, below 10<tspan class='exponent' dy='-4'>−12</tspan>");
            picture.text([at[0] + 9.0, bottom], "name", "start", &text);
            bottom -= 16.0;
        }
    }
    picture.names(names);
    picture.svg()
}

/// Slopes to compare with: three short lines from one point, where curves that fall leave room.
fn guides(picture: &mut Picture, against: Against, bottom: f64) {
    let variable = if against == Against::Samples { "N" } else { "t" };
    let [left, top, right, _] = picture.frame;
    let from = [left + 12.0, bottom - 0.36 * (bottom - top)];
    // Pixels down for each pixel to the right, of slope -1.
    let slope = picture.y.decade().abs() / picture.x.decade().abs();
    for (power, label) in [(0.5, "−1/2"), (1.0, "−1"), (1.5, "−3/2")] {
        let room = bottom - 8.0 - from[1];
        let width = (0.24 * (right - left)).min(room / (power * slope));
        let to = [from[0] + width, from[1] + power * slope * width];
        picture.draw(&format!(
            "<path class='guide' d='M{:.1} {:.1}L{:.1} {:.1}'/>",
            from[0], from[1], to[0], to[1]
        ));
        let text = format!("{variable}<tspan class='exponent' dy='-4'>{label}</tspan>");
        picture.text([to[0] + 3.0, to[1] + 4.0], "note halo", "start", &text);
    }
}

fn colour_of(points: Points) -> &'static str {
    match points {
        Points::Random => COLOURS[4],
        Points::Antithetic => COLOURS[6],
        Points::Stratified => COLOURS[1],
        Points::Sobol => COLOURS[3],
    }
}

/// Efficiencies over the best that is not exact.
pub(crate) fn bars(id: &str, results: &Results) -> String {
    let mut rows: Vec<&Series> = results.series.iter().collect();
    rows.sort_by(|a, b| b.worth().total_cmp(&a.worth()));
    let best = rows.iter().filter(|s| !s.is_exact()).map(|s| s.efficiency().0).fold(0.0, f64::max);
    let relative = |series: &Series| series.efficiency().0 / best;
    let values = rows.iter().filter(|s| !s.is_exact()).map(|s| relative(s));
    let x = Scale::around(values.chain([1.0]), [0.15, 0.25]);
    let height = 84.0 + 15.5 * rows.len() as f64;
    let margins = [276.0, 28.0, 58.0, 54.0];
    let mut picture = Picture::new(id, [590.0, height], margins, x, x);
    picture.title("d", "Efficiency 1 / (variance · time), relative to the best");
    picture.x_axis("relative efficiency");
    picture.border();
    let [left, top, right, _] = picture.frame;
    for (k, series) in rows.iter().enumerate() {
        let y = top + 8.0 + 15.5 * k as f64;
        let (_, error) = series.efficiency();
        let value = relative(series);
        let exact = series.is_exact();
        let end = if exact { right } else { picture.x.at(value) };
        let colour = colour_of(series.entry.points);
        let width = (end - left).max(1.0);
        picture.draw(&format!(
            "<rect x='{left:.1}' y='{:.1}' width='{width:.1}' height='10' fill='{colour}' \
             fill-opacity='{}'/>",
            y - 5.0,
            if exact { 0.35 } else { 0.85 }
        ));
        if !exact {
            let [low, high] = [value / (1.0 + error), value / (1.0 - error).max(0.2)];
            let low = low.max(picture.x.ends()[0]);
            picture.draw(&format!(
                "<path class='whisker' d='M{:.1} {y:.1}H{:.1}'/>",
                picture.x.at(low),
                picture.x.at(high).min(right)
            ));
        }
        let class = if series.entry.plan { "name plan" } else { "name" };
        let prefix = if series.entry.plan { "▸ " } else { "" };
        let name = format!("{prefix}{}", series.entry.name);
        picture.text([left - 6.0, y + 4.0], class, "end", &name);
        let text = if exact { "exact".into() } else { number(value) };
        picture.text([right + 5.0, y + 4.0], "name", "start", &text);
    }
    picture.svg()
}

/// A relative efficiency with two digits.
pub(crate) fn number(value: f64) -> String {
    if value >= 0.095 {
        format!("{value:.2}")
    } else if value >= 0.00095 {
        let digits = if value < 0.0095 { 4 } else { 3 };
        format!("{value:.digits$}")
    } else {
        let text = format!("{value:.1e}").replace('-', "−");
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{digits}·10<tspan class='exponent' dy='-4'>{exponent}</tspan>")
    }
}

/// Kinds of methods in the scatter: name, style, and which they are.
pub(crate) fn kind(entry: &Entry) -> (usize, &'static str, Style) {
    let Way::Planned(method) = &entry.way else { return (6, "optimal MIS", style(5, 0, 2)) };
    match method {
        Method::Single(_) => (0, "one technique alone", style(7, 0, 3)),
        Method::Constant(_) => (1, "constant weights", style(1, 0, 1)),
        Method::Balance => (2, "balance", style(4, 0, 0)),
        Method::OneSample => (4, "one-sample", style(0, 0, 4)),
        Method::VarianceAware(_) => (5, "variance-aware", style(3, 0, 1)),
        Method::Optimal(_) => (6, "optimal MIS", style(5, 0, 2)),
        _ => (3, "power, cutoff, maximum", style(2, 0, 4)),
    }
}

/// Whether a prediction can be compared with what came out: both are more than rounding.
pub(crate) fn comparable(series: &Series) -> Option<(f64, f64, Option<Caution>)> {
    let predicted = series.entry.predicted?;
    let real = predicted.variance > ROUNDING && series.variance.0 > ROUNDING;
    real.then_some((predicted.variance, predicted.uncertainty, predicted.caution))
}

/// Predicted against realised variance.
pub(crate) fn scatter(id: &str, results: &Results) -> String {
    let rows: Vec<(&Series, f64, f64, Option<Caution>)> = results
        .series
        .iter()
        .filter_map(|s| comparable(s).map(|(v, u, caution)| (s, v, u, caution)))
        .collect();
    let values = rows.iter().flat_map(|(s, v, ..)| [*v, s.variance.0]);
    let scale = Scale::around(values, [0.15, 0.15]);
    let margins = [62.0, 28.0, 200.0, 50.0];
    let mut picture = Picture::new(id, [590.0, 410.0], margins, scale, scale);
    picture.title("e", "Predicted and realised variance of one sample");
    picture.axes("predicted N·V / μ²", "realised N·V / μ²");
    let [low, high] = scale.ends();
    picture.band(&[[low, 0.8 * low, 1.2 * low], [high, 0.8 * high, 1.2 * high]], "#888888", 0.22);
    picture.segment([low, low], [high, high], "diagonal");
    let mut kinds: Vec<(usize, &str, Style)> = Vec::new();
    for (series, predicted, uncertainty, caution) in rows {
        let (order, name, style) = kind(&series.entry);
        if kinds.iter().all(|(other, ..)| *other != order) {
            kinds.push((order, name, style));
        }
        let (value, error) = series.variance;
        let colour = COLOURS[style.colour];
        let [x, y] = [picture.x.at(predicted), picture.y.at(value)];
        let [y1, y2] = [value - error, value + error].map(|v| picture.y.at(v.max(0.1 * value)));
        let u = uncertainty.min(0.9);
        let [x1, x2] = [1.0 - u, 1.0 + u].map(|f| picture.x.at(predicted * f));
        picture.draw(&format!(
            "<path d='M{x1:.1} {y:.1}H{x2:.1}M{x:.1} {y1:.1}V{y2:.1}' stroke='{colour}' fill='none'/>{}",
            mark([x, y], style, 4.0, caution.is_none())
        ));
    }
    kinds.sort_by_key(|(order, ..)| *order);
    let [_, top, right, _] = picture.frame;
    let mut y = top + 10.0;
    for (_, name, style) in kinds {
        picture.draw(&mark([right + 18.0, y - 4.0], style, 4.0, true));
        picture.text([right + 30.0, y], "name", "start", name);
        y += 17.0;
    }
    let hollow = Style { colour: 7, ..style(7, 0, 0) };
    picture.draw(&mark([right + 18.0, y - 4.0], hollow, 4.0, false));
    picture.text([right + 30.0, y], "name", "start", "hollow: flagged by the pilot");
    y += 17.0;
    picture.draw(&format!(
        "<rect x='{:.1}' y='{:.1}' width='16' height='10' fill='#888888' fill-opacity='0.22'/>",
        right + 10.0,
        y - 9.0
    ));
    picture.text([right + 30.0, y], "name", "start", "within 20 %");
    picture.svg()
}

/// Realised over predicted variance, of all problems.
pub(crate) fn ratios(all: &[Results]) -> String {
    let columns = all.len() as f64;
    // A column for each: its place is a decade.
    let column = |k: f64| 10f64.powf(k);
    let x = Scale::around([column(-0.5), column(columns - 0.5)], [0.0, 0.0]);
    let y = Scale::around([0.4, 2.5], [0.0, 0.0]);
    let mut picture = Picture::new("ratios", [1190.0, 356.0], [62.0, 32.0, 16.0, 52.0], x, y);
    picture.y_axis("realised / predicted variance");
    let [low, high] = picture.x.ends();
    picture.band(&[[low, 0.8, 1.2], [high, 0.8, 1.2]], "#888888", 0.22);
    picture.segment([low, 1.0], [high, 1.0], "diagonal");
    let mut kinds: Vec<(usize, &str, Style)> = Vec::new();
    for (k, results) in all.iter().enumerate() {
        let mut rows: Vec<_> =
            results.series.iter().filter_map(|s| comparable(s).map(|p| (s, p))).collect();
        rows.sort_by_key(|(series, _)| kind(&series.entry).0);
        let count = rows.len() as f64;
        for (j, (series, (predicted, uncertainty, caution))) in rows.into_iter().enumerate() {
            let (order, name, style) = kind(&series.entry);
            if kinds.iter().all(|(other, ..)| *other != order) {
                kinds.push((order, name, style));
            }
            let x = column(k as f64 + 0.84 * ((j as f64 + 0.5) / count - 0.5));
            let (value, error) = series.variance;
            let ratio = value / predicted;
            let spread = (error / value).hypot(uncertainty).min(0.9);
            let [y1, y2] = [1.0 - spread, 1.0 + spread].map(|f| ratio * f);
            picture.segment([x, y1], [x, y2], "whisker");
            let at = [picture.x.at(x), picture.y.at(ratio)];
            picture.draw(&mark(at, style, 3.4, caution.is_none()));
        }
        let at = picture.x.at(column(k as f64));
        picture.text([at, picture.frame[3] + 18.0], "name", "middle", results.name);
        if k > 0 {
            let edge = column(k as f64 - 0.5);
            let [low, high] = picture.y.ends();
            picture.segment([edge, low], [edge, high], "guide");
        }
    }
    picture.border();
    kinds.sort_by_key(|(order, ..)| *order);
    for (k, (_, name, style)) in kinds.into_iter().enumerate() {
        let x = picture.frame[0] + 10.0 + 158.0 * k as f64;
        picture.draw(&mark([x, 15.0], style, 4.0, true));
        picture.text([x + 10.0, 19.0], "name", "start", name);
    }
    let at = [0.5 * (picture.frame[0] + picture.frame[2]), picture.frame[3] + 40.0];
    picture.text(
        at,
        "label",
        "middle",
        "a mark for every method, with equal and with optimised shares",
    );
    picture.svg()
}
