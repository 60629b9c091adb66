//! Axes, scales, ticks, curves, bands and labels, as SVG.

use std::fmt::Write;

/// What a mark is drawn as: black, orange, sky blue, green, blue, vermilion, purple and grey, of M. Okabe
/// and K. Ito's palette, which the colour-blind can tell apart.
pub(crate) const COLOURS: [&str; 8] =
    ["#000000", "#e69f00", "#56b4e9", "#009e73", "#0072b2", "#d55e00", "#cc79a7", "#777777"];

/// Dashes, none first.
pub(crate) const DASHES: [&str; 5] = ["", "7 3", "2 2.5", "9 3 2 3", "14 4"];

/// Colour, dash, shape of marks (all by number), and width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Style {
    pub(crate) colour: usize,
    pub(crate) dash: usize,
    pub(crate) mark: usize,
    pub(crate) width: f64,
}

/// By number, of usual width.
pub(crate) const fn style(colour: usize, dash: usize, mark: usize) -> Style {
    Style { colour, dash, mark, width: 1.6 }
}

/// A logarithmic axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scale {
    /// Decades: log10 of the ends.
    low: f64,
    high: f64,
    /// Pixels of the ends.
    from: f64,
    to: f64,
}

impl Scale {
    /// Around all of these values, with some room (in decades) at either end.
    pub(crate) fn around(values: impl IntoIterator<Item = f64>, room: [f64; 2]) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.into_iter().filter(|v| *v > 0.0 && v.is_finite()) {
            (low, high) = (low.min(value.log10()), high.max(value.log10()));
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        Self { low: low - room[0], high: high + room[1], from: 0.0, to: 1.0 }
    }

    pub(crate) fn at(&self, value: f64) -> f64 {
        let t = (value.log10() - self.low) / (self.high - self.low);
        self.from + t * (self.to - self.from)
    }

    pub(crate) fn has(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value.log10())
    }

    pub(crate) fn ends(&self) -> [f64; 2] {
        [10f64.powf(self.low), 10f64.powf(self.high)]
    }

    /// Pixels for a decade.
    pub(crate) fn decade(&self) -> f64 {
        (self.to - self.from) / (self.high - self.low)
    }

    /// Values with a label, and values with a tick only.
    #[allow(clippy::cast_possible_truncation)] // Decades.
    fn ticks(&self) -> (Vec<f64>, Vec<f64>) {
        let span = self.high - self.low;
        let (first, last) = (self.low.floor() as i32, self.high.ceil() as i32);
        // Room for labels.
        let step = if self.decade().abs() < 17.0 {
            4
        } else if self.decade().abs() < 34.0 {
            2
        } else {
            1
        };
        let decades = (first..=last).filter(|d| d.rem_euclid(step) == 0);
        let within: Vec<i32> = (first..=last).collect();
        let multiples = |of: &[f64]| -> Vec<f64> {
            let all = within.iter().flat_map(|d| of.iter().map(move |m| m * 10f64.powi(*d)));
            all.filter(|v| self.has(*v)).collect()
        };
        if span < 1.8 {
            return (multiples(&[1.0, 2.0, 5.0]), multiples(&[3.0, 4.0, 6.0, 7.0, 8.0, 9.0]));
        }
        let minor = if span < 6.0 {
            multiples(&[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0])
        } else {
            Vec::new()
        };
        (decades.map(|d| 10f64.powi(d)).filter(|v| self.has(*v)).collect(), minor)
    }
}

/// A picture with a rectangle in it where data are shown.
pub(crate) struct Picture {
    width: f64,
    height: f64,
    /// Left, top, right, bottom.
    pub(crate) frame: [f64; 4],
    pub(crate) x: Scale,
    pub(crate) y: Scale,
    body: String,
    clip: String,
}

impl Picture {
    /// `margins` are left, top, right, bottom; `name` is its own on the page.
    pub(crate) fn new(
        name: &str,
        [width, height]: [f64; 2],
        margins: [f64; 4],
        x: Scale,
        y: Scale,
    ) -> Self {
        let frame = [margins[0], margins[1], width - margins[2], height - margins[3]];
        let x = Scale { from: frame[0], to: frame[2], ..x };
        let y = Scale { from: frame[3], to: frame[1], ..y };
        let clip = format!("clip-{name}");
        let [left, top, right, bottom] = frame;
        let body = format!(
            "<clipPath id='{clip}'><rect x='{left}' y='{top}' width='{:.1}' height='{:.1}'/></clipPath>\n",
            right - left,
            bottom - top
        );
        Self { width, height, frame, x, y, body, clip }
    }

    pub(crate) fn draw(&mut self, svg: &str) {
        self.body.push_str(svg);
        self.body.push('\n');
    }

    /// Cut off at the frame.
    fn draw_inside(&mut self, svg: &str) {
        let _ = writeln!(self.body, "<g clip-path='url(#{})'>{svg}</g>", self.clip);
    }

    pub(crate) fn text(&mut self, [x, y]: [f64; 2], class: &str, anchor: &str, text: &str) {
        let _ = writeln!(
            self.body,
            "<text x='{x:.1}' y='{y:.1}' class='{class}' text-anchor='{anchor}'>{text}</text>"
        );
    }

    pub(crate) fn title(&mut self, letter: &str, title: &str) {
        let text = format!("<tspan class='letter'>({letter})</tspan> {title}");
        self.text([4.0, 16.0], "title", "start", &text);
    }

    /// Grid and labels of both axes, and the frame.
    pub(crate) fn axes(&mut self, x_label: &str, y_label: &str) {
        self.x_axis(x_label);
        self.y_axis(y_label);
        self.border();
    }

    pub(crate) fn x_axis(&mut self, label: &str) {
        let [left, top, right, bottom] = self.frame;
        let (major, minor) = self.x.ticks();
        for (values, class) in [(&minor, "minor"), (&major, "grid")] {
            for value in values {
                let at = self.x.at(*value);
                self.draw(&format!("<path class='{class}' d='M{at:.1} {top:.1}V{bottom:.1}'/>"));
            }
        }
        for value in major {
            self.text([self.x.at(value), bottom + 17.0], "tick", "middle", &power(value));
        }
        self.text([0.5 * (left + right), bottom + 38.0], "label", "middle", label);
    }

    pub(crate) fn y_axis(&mut self, label: &str) {
        let [left, top, right, bottom] = self.frame;
        let (major, minor) = self.y.ticks();
        for (values, class) in [(&minor, "minor"), (&major, "grid")] {
            for value in values {
                let at = self.y.at(*value);
                self.draw(&format!("<path class='{class}' d='M{left:.1} {at:.1}H{right:.1}'/>"));
            }
        }
        for value in major {
            self.text([left - 6.0, self.y.at(value) + 4.0], "tick", "end", &power(value));
        }
        let middle = 0.5 * (top + bottom);
        self.draw(&format!(
            "<text class='label' text-anchor='middle' transform='translate(14 {middle:.1}) \
             rotate(-90)'>{label}</text>"
        ));
    }

    pub(crate) fn border(&mut self) {
        let [left, top, right, bottom] = self.frame;
        let (w, h) = (right - left, bottom - top);
        self.draw(&format!(
            "<rect class='frame' x='{left:.1}' y='{top:.1}' width='{w:.1}' height='{h:.1}'/>"
        ));
    }

    /// A line through points, with a mark at each.
    pub(crate) fn curve(&mut self, points: &[[f64; 2]], style: Style) {
        let mut path = String::new();
        let mut marks = String::new();
        for (k, [x, y]) in points.iter().enumerate() {
            let (x, y) = (self.x.at(*x), self.y.at(*y));
            let _ = write!(path, "{}{x:.1} {y:.1}", if k == 0 { 'M' } else { 'L' });
            marks.push_str(&mark([x, y], style, 3.0, true));
        }
        let colour = COLOURS[style.colour];
        self.draw_inside(&format!(
            "<path d='{path}' fill='none' stroke='{colour}' stroke-width='{}' \
             stroke-dasharray='{}' stroke-linejoin='round'/>{marks}",
            style.width, DASHES[style.dash]
        ));
    }

    /// The region between lows and highs: x, low, high.
    pub(crate) fn band(&mut self, points: &[[f64; 3]], colour: &str, opacity: f64) {
        let up = points.iter().map(|[x, _, high]| [*x, *high]);
        let down = points.iter().rev().map(|[x, low, _]| [*x, *low]);
        let path: Vec<String> = up
            .chain(down)
            .map(|[x, y]| format!("{:.1} {:.1}", self.x.at(x), self.y.at(y)))
            .collect();
        self.draw_inside(&format!(
            "<path d='M{}Z' fill='{colour}' fill-opacity='{opacity}'/>",
            path.join("L")
        ));
    }

    pub(crate) fn segment(&mut self, from: [f64; 2], to: [f64; 2], class: &str) {
        let [x1, y1] = [self.x.at(from[0]), self.y.at(from[1])];
        let [x2, y2] = [self.x.at(to[0]), self.y.at(to[1])];
        self.draw_inside(&format!("<path class='{class}' d='M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}'/>"));
    }

    /// Names beside the right ends of curves (given in pixels of y), moved apart where they would overlap.
    pub(crate) fn names(&mut self, mut names: Vec<(f64, f64, String, Style)>) {
        const APART: f64 = 14.5;
        names.sort_by(|a, b| a.1.total_cmp(&b.1));
        let [_, top, right, bottom] = self.frame;
        let mut places: Vec<f64> = Vec::new();
        for (_, y, ..) in &names {
            places.push(places.last().map_or(top + 5.0, |last| last + APART).max(*y));
        }
        let mut limit = bottom;
        for place in places.iter_mut().rev() {
            *place = place.min(limit);
            limit = *place - APART;
        }
        for ((x, y, name, style), place) in names.into_iter().zip(places) {
            let colour = COLOURS[style.colour];
            let (from, to, end) = (x + 5.0, right + 8.0, right + 34.0);
            self.draw(&format!(
                "<path class='leader' d='M{from:.1} {y:.1}L{to:.1} {place:.1}'/>\
                 <path d='M{to:.1} {place:.1}H{end:.1}' stroke='{colour}' stroke-width='{}' \
                 stroke-dasharray='{}'/>{}",
                style.width,
                DASHES[style.dash],
                mark([0.5 * (to + end), place], style, 3.0, true)
            ));
            self.text([end + 5.0, place + 4.0], "name", "start", &name);
        }
    }

    pub(crate) fn svg(&self) -> String {
        let (w, h) = (self.width, self.height);
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {w} {h}' width='{w}' height='{h}' \
             role='img'>\n{}</svg>\n",
            self.body
        )
    }
}

/// A mark at pixels.
pub(crate) fn mark([x, y]: [f64; 2], style: Style, r: f64, filled: bool) -> String {
    let colour = COLOURS[style.colour];
    let fill = if filled { colour } else { "#ffffff" };
    let paint = format!("fill='{fill}' stroke='{colour}' stroke-width='1.2'");
    let (d, wide) = (1.3 * r, 1.25 * r);
    match style.mark % 5 {
        0 => format!("<circle cx='{x:.1}' cy='{y:.1}' r='{r}' {paint}/>"),
        1 => {
            let (x, y, side) = (x - 0.9 * r, y - 0.9 * r, 1.8 * r);
            format!("<rect x='{x:.1}' y='{y:.1}' width='{side:.1}' height='{side:.1}' {paint}/>")
        }
        2 => format!(
            "<path d='M{x:.1} {:.1}l{d:.1} {d:.1}l-{d:.1} {d:.1}l-{d:.1}-{d:.1}Z' {paint}/>",
            y - d
        ),
        3 => format!(
            "<path d='M{x:.1} {:.1}l{wide:.1} {:.1}h-{:.1}Z' {paint}/>",
            y - wide,
            2.0 * r,
            2.0 * wide
        ),
        _ => format!(
            "<path d='M{x:.1} {:.1}l{wide:.1}-{:.1}h-{:.1}Z' {paint}/>",
            y + wide,
            2.0 * r,
            2.0 * wide
        ),
    }
}

/// 10^k with a superscript; 2·10^k; plain from 0.1 to 100.
#[allow(clippy::cast_possible_truncation)] // Decades.
pub(crate) fn power(value: f64) -> String {
    let decade = (value.log10() + 1e-9).floor() as i32;
    let digit = (value / 10f64.powi(decade)).round();
    if (-1..=1).contains(&decade) {
        return format!("{}", (digit * 10f64.powi(decade) * 10.0).round() / 10.0);
    }
    let times = if digit == 1.0 { String::new() } else { format!("{digit}·") };
    let exponent = decade.to_string().replace('-', "−");
    format!("{times}10<tspan class='exponent' dy='-5'>{exponent}</tspan>")
}
