//! Error against samples, and against time.

use crate::entries::{EQUAL, Points};
use crate::measure::{Point, ROUNDING, Results, Series};
use crate::plot::{COLOURS, Picture, Scale, Style, mark, style};

/// A curve: what it shows, and how.
type Curve<'a> = (&'a Series, String, Style);

/// Of the recommended plan.
const PLAN: Style = Style { colour: 0, dash: 0, mark: 2, width: 2.6 };

/// Weightings and estimators from random points, with equal shares if not said otherwise.
pub(crate) fn weightings(results: &Results) -> Vec<Curve<'_>> {
    let mut curves = Vec::new();
    if let Some(single) = results.least_single().filter(|single| !single.entry.plan) {
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
        let short = name.replace(" (cross-fit)", "");
        curves.extend(results.named(name).map(|series| (series, short, style)));
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
        if ["balance, Sobol’", "optimal MIS, Sobol’", "plan, Sobol’"].contains(&name.as_str())
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
pub(crate) fn chart(
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
    let lines: Vec<Vec<[f64; 4]>> = curves.iter().map(|(series, ..)| shown(series)).collect();
    let traced = traced(&picture, &lines);
    guides(&mut picture, against, &traced, bottom);
    if let Against::Time(planning) = against
        && picture.x.has(planning)
    {
        let [low, high] = picture.y.ends();
        picture.segment([planning, low], [planning, high], "guide");
        let at = [picture.x.at(planning) - 4.0, picture.frame[1] + 12.0];
        picture.text(at, "note halo", "end", "pilot and plan");
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

/// Slopes to compare with: three short lines from one point, where the curves (pixels) leave most room.
fn guides(picture: &mut Picture, against: Against, curves: &[[f64; 2]], bottom: f64) {
    let variable = if against == Against::Samples { "N" } else { "t" };
    let [left, top, right, _] = picture.frame;
    let (w, h) = (right - left, bottom - top);
    // Pixels down for each pixel to the right, of slope -1.
    let slope = picture.y.decade().abs() / picture.x.decade().abs();
    let lines = [(0.5, "−1/2"), (1.0, "−1"), (1.5, "−3/2")];
    let ends = lines.map(|(power, _)| {
        let length = (0.22 * w).min(0.3 * h / (power * slope));
        [length, power * slope * length]
    });
    let mut labels = ends.map(|[_, y]| y + 4.0);
    for k in 1..labels.len() {
        labels[k] = labels[k].max(labels[k - 1] + 13.0);
    }
    let size = [0.22 * w + 32.0, labels[2] + 4.0];
    // How many points of curves are within, and how far the others are at least.
    let crowd = |[x, y]: [f64; 2]| {
        let outside = |at: f64, low: f64, size: f64| (low - at).max(at - low - size).max(0.0);
        let to_curve = |p: &[f64; 2]| outside(p[0], x, size[0]).hypot(outside(p[1], y, size[1]));
        let distances = || curves.iter().map(to_curve);
        (distances().filter(|d| *d == 0.0).count(), distances().fold(f64::INFINITY, f64::min))
    };
    let spread = |low: f64, room: f64| (0..24).map(move |k| low + room * f64::from(k) / 23.0);
    let places = spread(left + 8.0, w - size[0] - 16.0)
        .flat_map(|x| spread(top + 14.0, h - size[1] - 22.0).map(move |y| [x, y]));
    let crowds = places.map(|place| (place, crowd(place)));
    let freest = crowds.min_by(|(_, a), (_, b)| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
    let Some(([x, y], _)) = freest else { return };
    for (((_, label), [dx, dy]), label_y) in lines.iter().zip(ends).zip(labels) {
        let (to_x, to_y) = (x + dx, y + dy);
        picture.draw(&format!("<path class='guide' d='M{x:.1} {y:.1}L{to_x:.1} {to_y:.1}'/>"));
        let text = format!("{variable}<tspan class='exponent' dy='-4'>{label}</tspan>");
        picture.text([to_x + 4.0, y + label_y], "note halo", "start", &text);
    }
}

/// Points along the curves, in pixels, a few pixels apart.
fn traced(picture: &Picture, lines: &[Vec<[f64; 4]>]) -> Vec<[f64; 2]> {
    let mut traced = Vec::new();
    for line in lines {
        let pixels: Vec<[f64; 2]> =
            line.iter().map(|p| [picture.x.at(p[0]), picture.y.at(p[1])]).collect();
        for pair in pixels.windows(2) {
            let between = |t: f64| [0, 1].map(|k| pair[0][k] + t * (pair[1][k] - pair[0][k]));
            traced.extend((0..=16).map(|k| between(f64::from(k) / 16.0)));
        }
    }
    traced
}
