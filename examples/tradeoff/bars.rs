//! Efficiencies as bars.

use crate::entries::Points;
use crate::measure::{Results, Series};
use crate::plot::{COLOURS, Picture, Scale};

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
    let margins = [292.0, 28.0, 66.0, 54.0];
    let mut picture = Picture::new(id, [590.0, height], margins, x, x);
    picture.title("c", "Efficiency 1 / (variance · time), relative to the best");
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
