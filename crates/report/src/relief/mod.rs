//! A picture of a piece of ground with a path over it: heights as colour, shade and contours, and the profile below.
//!
//! It is an SVG that stands alone, as wide as a page.

mod contour;
mod profile;
mod shade;

use crate::html::escape;
use crate::number::{number, quantity};
use std::fmt::Write;

/// What is drawn.
#[derive(Clone, Debug, Default)]
pub struct Relief {
    /// What stands above it.
    pub title: String,
    /// The ground, where it is known beside the path.
    pub ground: Option<Ground>,
    /// Points of the path, near each other: east and north [m].
    pub path_m: Vec<[f64; 2]>,
    /// Distance along the path and height [m] of the same points.
    pub profile_m: Vec<[f64; 2]>,
    /// Names and places of marks [m].
    pub marks: Vec<(String, [f64; 2])>,
}

/// Heights over a rectangle.
#[derive(Clone, Debug, Default)]
pub struct Ground {
    /// East and north of the sample in the south-west [m].
    pub corner_m: [f64; 2],
    /// How far samples are apart [m].
    pub cell_m: [f64; 2],
    /// How many there are in a row.
    pub columns: usize,
    /// Rows from south to north; NaN where nothing is known.
    pub heights_m: Vec<f64>,
}

impl Ground {
    pub(crate) fn rows(&self) -> usize {
        self.heights_m.len().checked_div(self.columns).unwrap_or(0)
    }

    fn range_m(&self) -> (f64, f64) {
        ends(self.heights_m.iter().copied().filter(|height| !height.is_nan()))
    }
}

/// Widths in the units of the picture.
const WIDTH: f64 = 860.0;
const LEFT: f64 = 62.0;
const TOP: f64 = 46.0;
const MAP_WIDTH: f64 = 770.0;
const MAP_HEIGHT: f64 = 520.0;
const PROFILE_HEIGHT: f64 = 130.0;
const GAP: f64 = 72.0;
/// Between two arrows along the path.
const ARROW_EVERY: f64 = 90.0;

const INK: &str = "#22303c";
const FAINT: &str = "#8a949c";
const PATH: &str = "#a3123f";

/// Least and greatest; (0, 0) of nothing.
pub(crate) fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

/// Steps of 1, 2 or 5 that cut a range into about `pieces`.
pub(crate) fn step(range: f64, pieces: f64) -> f64 {
    let raw = (range / pieces).max(f64::MIN_POSITIVE);
    let power = 10f64.powf(raw.log10().floor());
    let lead = raw / power;
    power
        * if lead < 1.5 {
            1.0
        } else if lead < 3.5 {
            2.0
        } else if lead < 7.5 {
            5.0
        } else {
            10.0
        }
}

/// Multiples of a step within a range.
pub(crate) fn multiples((low, high): (f64, f64), step: f64) -> Vec<f64> {
    let mut all = Vec::new();
    let mut count = (low / step).ceil();
    while count * step <= high + 1e-9 * step {
        all.push(count * step);
        count += 1.0;
    }
    all
}

/// From metres to the picture.
struct Frame {
    east_m: (f64, f64),
    north_m: (f64, f64),
    scale: f64,
}

impl Frame {
    /// All of it, on one scale for both axes.
    fn around(relief: &Relief) -> Self {
        let path = |axis: usize| ends(relief.path_m.iter().map(|point| point[axis]));
        let (east_m, north_m) = if let Some(ground) = &relief.ground {
            let end = |axis: usize, count: usize| {
                ground.corner_m[axis] + ground.cell_m[axis] * count.saturating_sub(1) as f64
            };
            ((ground.corner_m[0], end(0, ground.columns)), (ground.corner_m[1], end(1, ground.rows())))
        } else {
            let margin = |(low, high): (f64, f64), least: f64| {
                let more = 0.04 * (high - low) + least;
                (low - more, high + more)
            };
            let (east, north) = (path(0), path(1));
            let least = 0.02 * (east.1 - east.0).max(north.1 - north.0).max(1.0);
            (margin(east, least), margin(north, least))
        };
        let (wide, high) = ((east_m.1 - east_m.0).max(1e-9), (north_m.1 - north_m.0).max(1e-9));
        Self { east_m, north_m, scale: (MAP_WIDTH / wide).min(MAP_HEIGHT / high) }
    }

    fn width(&self) -> f64 {
        self.scale * (self.east_m.1 - self.east_m.0)
    }

    fn height(&self) -> f64 {
        self.scale * (self.north_m.1 - self.north_m.0)
    }

    fn x(&self, east_m: f64) -> f64 {
        LEFT + self.scale * (east_m - self.east_m.0)
    }

    fn y(&self, north_m: f64) -> f64 {
        TOP + self.scale * (self.north_m.1 - north_m)
    }

    /// Ticks along both sides, in metres.
    fn axes(&self, svg: &mut String) {
        let every = step(self.east_m.1 - self.east_m.0, 7.0).max(step(self.north_m.1 - self.north_m.0, 7.0));
        let (left, bottom) = (LEFT, TOP + self.height());
        for at in multiples(self.east_m, every) {
            let x = self.x(at);
            let _ = write!(svg, "<path d=\"M{x:.1} {bottom:.1}v5\" stroke=\"{INK}\"/>");
            text(svg, x, bottom + 19.0, "middle", &tick(at, every));
        }
        for at in multiples(self.north_m, every) {
            let y = self.y(at);
            let _ = write!(svg, "<path d=\"M{left:.1} {y:.1}h-5\" stroke=\"{INK}\"/>");
            text(svg, left - 9.0, y + 4.0, "end", &tick(at, every));
        }
        let _ = write!(
            svg,
            "<rect x=\"{left:.1}\" y=\"{TOP:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"{INK}\"/>",
            self.width(),
            self.height()
        );
    }
}

pub(crate) fn text(svg: &mut String, x: f64, y: f64, anchor: &str, words: &str) {
    let _ = write!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>", escape(words));
}

/// A line through points of the picture.
pub(crate) fn polyline(points: impl Iterator<Item = [f64; 2]>) -> String {
    let mut d = String::new();
    for [x, y] in points {
        let _ = write!(d, "{}{x:.1} {y:.1}", if d.is_empty() { "M" } else { "L" });
    }
    d
}

impl Relief {
    /// The picture.
    pub fn svg(&self) -> String {
        let frame = Frame::around(self);
        let below = TOP + frame.height() + GAP;
        let height = below + PROFILE_HEIGHT + 48.0;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.0}\" width=\"{WIDTH}\" \
             height=\"{height:.0}\" font-family=\"system-ui, sans-serif\" font-size=\"12\" fill=\"{INK}\">\n\
             <title>{title}</title>\n<rect width=\"{WIDTH}\" height=\"{height:.0}\" fill=\"#fff\"/>\n\
             <text x=\"{LEFT}\" y=\"27\" font-size=\"15\" font-weight=\"600\">{title}</text>\n",
            title = escape(&self.title)
        );
        if let Some(ground) = &self.ground {
            draw_ground(&mut svg, &frame, ground);
        }
        self.draw_path(&mut svg, &frame);
        frame.axes(&mut svg);
        text(&mut svg, LEFT, TOP + frame.height() + 36.0, "start", &self.legend());
        profile::draw(&mut svg, &self.profile_m, below);
        svg.push_str("\n</svg>\n");
        svg
    }

    /// What the colours and the axes are.
    fn legend(&self) -> String {
        let mut legend = "metres east; up is north".to_owned();
        if let Some(range) = self.ground.as_ref().map(Ground::range_m) {
            let every = contour_step(range);
            let _ = if every.is_finite() {
                let (low, high) = (number(range.0), number(range.1));
                write!(legend, "; ground {low} to {high} m high, contours every {}", quantity(every, "m"))
            } else {
                write!(legend, "; the ground is level")
            };
        }
        legend
    }

    fn draw_path(&self, svg: &mut String, frame: &Frame) {
        let points = thinned(self.path_m.iter().map(|point| [frame.x(point[0]), frame.y(point[1])]));
        let d = polyline(points.iter().copied());
        let _ = writeln!(
            svg,
            "<path d=\"{d}\" fill=\"none\" stroke=\"#fff\" stroke-opacity=\".7\" stroke-width=\"4.5\"/>\n\
             <path d=\"{d}\" fill=\"none\" stroke=\"{PATH}\" stroke-width=\"2\" stroke-linejoin=\"round\"/>"
        );
        for ([x, y], [dx, dy]) in arrows(&points) {
            let angle = dy.atan2(dx).to_degrees();
            let _ = write!(
                svg,
                "<path d=\"M-5-4L5 0L-5 4z\" fill=\"{PATH}\" transform=\"translate({x:.1} {y:.1}) rotate({angle:.0})\"/>"
            );
        }
        if let (Some([x, y]), Some([ex, ey])) = (points.first(), points.last()) {
            let _ = write!(
                svg,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" fill=\"#fff\" stroke=\"{PATH}\" stroke-width=\"2\"/>\
                 <rect x=\"{:.1}\" y=\"{:.1}\" width=\"9\" height=\"9\" fill=\"{PATH}\"/>",
                ex - 4.5,
                ey - 4.5
            );
        }
        for (name, place) in &self.marks {
            let (x, y) = (frame.x(place[0]), frame.y(place[1]));
            let _ = write!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{INK}\"/>");
            // A name that stands there often says nothing of the place.
            if self.marks.iter().filter(|(other, _)| other == name).count() == 1 {
                text(svg, x + 7.0, y - 6.0, "start", name);
            }
        }
        svg.push('\n');
    }
}

fn draw_ground(svg: &mut String, frame: &Frame, ground: &Ground) {
    let range = ground.range_m();
    let _ = writeln!(
        svg,
        "<image x=\"{LEFT:.1}\" y=\"{TOP:.1}\" width=\"{:.1}\" height=\"{:.1}\" preserveAspectRatio=\"none\" \
         href=\"data:image/png;base64,{}\"/>",
        frame.width(),
        frame.height(),
        shade::picture(ground, range)
    );
    let mut d = String::new();
    for level in multiples(range, contour_step(range)) {
        contour::draw(&mut d, ground, level, |east_m, north_m| [frame.x(east_m), frame.y(north_m)]);
    }
    let _ = writeln!(
        svg,
        "<path d=\"{d}\" fill=\"none\" stroke=\"#5b4a35\" stroke-opacity=\".5\" stroke-width=\".8\"/>"
    );
}

/// Between two contours; level ground has none.
fn contour_step(range: (f64, f64)) -> f64 {
    if range.1 - range.0 > 1e-6 { step(range.1 - range.0, 10.0) } else { f64::INFINITY }
}

/// A number at a tick, with as many digits as the step between ticks needs.
pub(crate) fn tick(at: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).clamp(0.0, 9.0);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 9")]
    let text = format!("{:.*}", decimals as usize, at + 0.0);
    text.replace('-', "\u{2212}")
}

/// Leaves out points that cannot be told from the last one in the picture.
pub(crate) fn thinned(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    const APART: f64 = 1.0;
    let mut kept: Vec<[f64; 2]> = Vec::new();
    let mut end = None;
    for point in points {
        let far = |last: &[f64; 2]| (point[0] - last[0]).hypot(point[1] - last[1]) >= APART;
        end = Some(point);
        if kept.last().is_none_or(far) {
            kept.push(point);
            end = None;
        }
    }
    kept.extend(end);
    kept
}

/// Where arrows stand, and where they point.
fn arrows(points: &[[f64; 2]]) -> Vec<([f64; 2], [f64; 2])> {
    let mut all = Vec::new();
    let mut since = 0.5 * ARROW_EVERY;
    for [one, two] in points.array_windows() {
        let way = [two[0] - one[0], two[1] - one[1]];
        since += way[0].hypot(way[1]);
        if since >= ARROW_EVERY {
            since = 0.0;
            all.push((*two, way));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn relief() -> Relief {
        Relief {
            title: "a <hill>".to_owned(),
            ground: Some(Ground {
                corner_m: [0.0, 0.0],
                cell_m: [10.0, 10.0],
                columns: 3,
                heights_m: vec![0.0, 1.0, 0.0, 0.0, 2.0, 0.0],
            }),
            path_m: vec![[0.0, 0.0], [20.0, 10.0]],
            profile_m: vec![[0.0, 0.0], [22.4, 0.0]],
            marks: vec![("gate".to_owned(), [10.0, 5.0])],
        }
    }

    #[test]
    fn the_picture_holds_ground_path_marks_and_profile_on_one_scale() {
        let svg = relief().svg();
        for held in
            ["a &lt;hill&gt;", "data:image/png;base64,", "contours every 0.2", ">gate<", "along the path"]
        {
            assert!(svg.contains(held), "{held}: {svg}");
        }
        // 20 m by 10 m on 770 by 520: 38.5 a metre, so 385 high.
        assert!(svg.contains("width=\"770.0\" height=\"385.0\""), "{svg}");
        assert!(svg.contains(&format!("M{LEFT:.1} {:.1}L832.0 {TOP:.1}", TOP + 385.0)), "{svg}");
    }

    #[test]
    fn without_ground_the_path_stands_alone() {
        let svg = Relief { ground: None, ..relief() }.svg();
        assert!(!svg.contains("<image") && svg.contains("metres east"));
    }

    #[test]
    fn points_on_top_of_each_other_are_drawn_once_and_the_last_one_always() {
        let points = [[0.0, 0.0], [0.2, 0.0], [1.5, 0.0], [1.6, 0.0]];
        assert_eq!(thinned(points.into_iter()), [[0.0, 0.0], [1.5, 0.0], [1.6, 0.0]]);
    }

    #[test]
    fn steps_are_round() {
        for (range, wanted) in [(10.0, 1.0), (16.0, 2.0), (44.0, 5.0), (0.9, 0.1), (80.0, 10.0)] {
            assert!((step(range, 10.0) / wanted - 1.0).abs() < 1e-12, "{range}");
        }
        assert_eq!(multiples((0.3, 1.0), 0.25), [0.5, 0.75, 1.0]);
        assert_eq!(tick(-0.0, 20.0), "0");
        assert_eq!((tick(306.31, 0.02), tick(-40.0, 20.0)), ("306.31".to_owned(), "\u{2212}40".to_owned()));
    }
}
