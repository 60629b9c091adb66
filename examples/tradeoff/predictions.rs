//! Predicted variances and those that came out.

use mis::plan::{Caution, Method};

use crate::entries::{Entry, Way};
use crate::measure::{ROUNDING, Results, Series};
use crate::plot::{COLOURS, Picture, Scale, Style, mark, style};

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
    let flagged = rows.iter().any(|(.., caution)| caution.is_some());
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
    if flagged {
        picture.draw(&mark([right + 18.0, y - 4.0], style(7, 0, 0), 4.0, false));
        picture.text([right + 30.0, y], "name", "start", "hollow: flagged by the pilot");
        y += 17.0;
    }
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
    let mut x = picture.frame[0] + 8.0;
    for (_, name, style) in kinds {
        picture.draw(&mark([x, 15.0], style, 4.0, true));
        picture.text([x + 10.0, 19.0], "name", "start", name);
        x += 40.0 + 6.5 * name.len() as f64;
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
