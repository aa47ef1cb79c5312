//! A picture of a piece of ground with a path over it: heights as colour, shade and contours, and the profile below.
//!
//! It is an SVG that stands alone, as wide as a page.

mod contour;
mod frame;
mod line;
mod profile;
mod scale;
mod shade;

use crate::html::escape;
use crate::number::{number, quantity};
use frame::Frame;
use line::{arrows, polyline, text, thinned};
use scale::{contour_step, ends, multiples};
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

const INK: &str = "#22303c";
const FAINT: &str = "#8a949c";
const PATH: &str = "#a3123f";

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
}
