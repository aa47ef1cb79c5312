//! Words, and lines through points of the picture.

use crate::html::escape;
use std::fmt::Write;

/// Between two arrows along the path.
const ARROW_EVERY: f64 = 90.0;

/// Words at a place of the picture.
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
pub(super) fn arrows(points: &[[f64; 2]]) -> Vec<([f64; 2], [f64; 2])> {
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

    #[test]
    fn points_on_top_of_each_other_are_drawn_once_and_the_last_one_always() {
        let points = [[0.0, 0.0], [0.2, 0.0], [1.5, 0.0], [1.6, 0.0]];
        assert_eq!(thinned(points.into_iter()), [[0.0, 0.0], [1.5, 0.0], [1.6, 0.0]]);
    }
}
