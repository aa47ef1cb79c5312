//! Where the ground lies in the picture, with its axes.

use super::line::text;
use super::scale::{ends, multiples, step, tick};
use super::{INK, LEFT, MAP_HEIGHT, MAP_WIDTH, Relief, TOP};
use std::fmt::Write;

/// From metres to the picture.
pub(super) struct Frame {
    east_m: (f64, f64),
    north_m: (f64, f64),
    scale: f64,
}

impl Frame {
    /// All of it, on one scale for both axes.
    pub(super) fn around(relief: &Relief) -> Self {
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

    pub(super) fn width(&self) -> f64 {
        self.scale * (self.east_m.1 - self.east_m.0)
    }

    pub(super) fn height(&self) -> f64 {
        self.scale * (self.north_m.1 - self.north_m.0)
    }

    pub(super) fn x(&self, east_m: f64) -> f64 {
        LEFT + self.scale * (east_m - self.east_m.0)
    }

    pub(super) fn y(&self, north_m: f64) -> f64 {
        TOP + self.scale * (self.north_m.1 - north_m)
    }

    /// Ticks along both sides, in metres.
    pub(super) fn axes(&self, svg: &mut String) {
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
