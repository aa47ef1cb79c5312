//! Height along the path, below the map.

use super::line::{polyline, text, thinned};
use super::scale::{ends, multiples, step, tick};
use super::{FAINT, INK, LEFT, MAP_WIDTH, PATH, PROFILE_HEIGHT};
use std::fmt::Write;

/// Draws it from `top` on.
pub(crate) fn draw(svg: &mut String, profile_m: &[[f64; 2]], top: f64) {
    let along = ends(profile_m.iter().map(|point| point[0]));
    let mut height = ends(profile_m.iter().map(|point| point[1]));
    // Level ground is a line in the middle and not a picture of rounding.
    if height.1 - height.0 < 1e-6 {
        height = (height.0 - 1.0, height.1 + 1.0);
    }
    let x = |at: f64| LEFT + MAP_WIDTH * (at - along.0) / (along.1 - along.0).max(1e-9);
    let y = |at: f64| top + PROFILE_HEIGHT * (height.1 - at) / (height.1 - height.0);
    let every = step(height.1 - height.0, 4.0);
    for at in multiples(height, every) {
        let _ = write!(
            svg,
            "<path d=\"M{LEFT:.1} {:.1}h{MAP_WIDTH:.1}\" stroke=\"{FAINT}\" stroke-opacity=\".4\"/>",
            y(at)
        );
        text(svg, LEFT - 9.0, y(at) + 4.0, "end", &tick(at, every));
    }
    let bottom = top + PROFILE_HEIGHT;
    let every = step(along.1 - along.0, 8.0);
    for at in multiples(along, every) {
        let _ = write!(svg, "<path d=\"M{:.1} {bottom:.1}v5\" stroke=\"{INK}\"/>", x(at));
        text(svg, x(at), bottom + 19.0, "middle", &tick(at, every));
    }
    let d = polyline(thinned(profile_m.iter().map(|point| [x(point[0]), y(point[1])])).into_iter());
    let _ = write!(
        svg,
        "<path d=\"{d}\" fill=\"none\" stroke=\"{PATH}\" stroke-width=\"1.6\" stroke-linejoin=\"round\"/>"
    );
    text(svg, LEFT + MAP_WIDTH, bottom + 36.0, "end", "metres along the path");
    text(svg, LEFT, top - 8.0, "start", "height, m");
}
