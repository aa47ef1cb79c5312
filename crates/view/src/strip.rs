//! The ground as a surface.

use crate::Ground;
use crate::colour::Colour;
use crate::mesh::{Mesh, Point};
use crate::path::{Path, Pose};
use crate::thin::spread;

const LIGHT: Colour = [122, 104, 78];
const DARK: Colour = [98, 82, 60];
/// The most pieces that a strip is made of, and the most points along a side of a grid.
const PIECES: f64 = 2000.0;
const SIDE: usize = 400;

/// A strip of ground along a path.
#[derive(Debug)]
pub(crate) struct Strip {
    pub mesh: Mesh,
    /// Length of each of its light and dark pieces [m].
    pub stripe_m: f64,
    /// Places on the right edge of the strip, and how far along the path they are [m].
    pub marks: Vec<(Point, f64)>,
}

/// The least of 1, 2, 5, 10, 20, 50, ... that is `least` or more.
pub(crate) fn round_up(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .map(|digit| digit * power)
        .into_iter()
        .find(|round| *round >= least * (1.0 - 1e-9))
        .unwrap_or(least)
}

/// The strip that is `width_m` wide and goes on by `margin_m` at both ends.
pub(crate) fn strip(path: &Path, width_m: f64, margin_m: f64) -> Strip {
    let line = Line::along(&path.poses, margin_m);
    let stripe_m = round_up((line.length_m() / PIECES * 4.0).max(10.0));
    let step_m = stripe_m / 4.0;
    let mut mesh = Mesh::default();
    let edges = |from_start_m: f64| {
        let (at, [east, north]) = line.at(from_start_m);
        let half = width_m / 2.0;
        [
            [at[0] + north * half, at[1] - east * half, at[2]],
            [at[0] - north * half, at[1] + east * half, at[2]],
        ]
    };
    let mut from = -margin_m;
    while from < line.length_m() - margin_m {
        let next = ((from / step_m + 1e-9).floor() + 1.0) * step_m;
        let to = next.min(line.length_m() - margin_m);
        let light = (from / stripe_m + 1e-9).floor().rem_euclid(2.0) == 0.0;
        let ([right, left], [next_right, next_left]) = (edges(from + margin_m), edges(to + margin_m));
        mesh.face(&[right, next_right, next_left, left], if light { LIGHT } else { DARK });
        from = to;
    }
    let inner_m = line.length_m() - 2.0 * margin_m;
    let spacing_m = round_up((inner_m / 12.0).max(10.0));
    let mut marks = Vec::new();
    let mut mark = 0.0;
    while mark <= inner_m {
        marks.push((edges(mark + margin_m)[0], mark));
        mark += spacing_m;
    }
    Strip { mesh, stripe_m, marks }
}

/// A grid as a surface, moved by `shift`, in squares of two shades.
pub(crate) fn surface(ground: &Ground, shift: Point) -> Option<Mesh> {
    let Ground::Grid { east_m, north_m, spacing_m, columns, height_m } = ground else { return None };
    let (across, along) = (spread(*columns, SIDE), spread(height_m.len() / columns, SIDE));
    let at = |row: usize, column: usize| -> Point {
        [
            east_m + column as f64 * spacing_m + shift[0],
            north_m + row as f64 * spacing_m + shift[1],
            height_m[row * columns + column] + shift[2],
        ]
    };
    let mut mesh = Mesh::default();
    for (row, rows) in along.windows(2).enumerate() {
        for (column, sides) in across.windows(2).enumerate() {
            let colour = if (row + column) % 2 == 0 { LIGHT } else { DARK };
            let corners =
                [at(rows[0], sides[0]), at(rows[0], sides[1]), at(rows[1], sides[1]), at(rows[1], sides[0])];
            mesh.face(&[corners[0], corners[1], corners[2]], colour);
            mesh.face(&[corners[0], corners[2], corners[3]], colour);
        }
    }
    Some(mesh)
}

/// Points that do not coincide, the first and last of them beyond the ends of the path.
struct Line {
    points: Vec<Point>,
    from_start_m: Vec<f64>,
}

impl Line {
    fn along(poses: &[Pose], margin_m: f64) -> Self {
        let beyond = |pose: &Pose, by: f64| {
            let (sine, cosine) = pose.heading_rad.sin_cos();
            [pose.at[0] + by * sine, pose.at[1] + by * cosine, pose.at[2]]
        };
        let mut line = Self { points: Vec::new(), from_start_m: Vec::new() };
        let ends = poses.first().zip(poses.last());
        let ends = ends.map(|(first, last)| (beyond(first, -margin_m), beyond(last, margin_m)));
        let inner = poses.iter().map(|pose| pose.at);
        let points = ends.iter().map(|ends| ends.0).chain(inner).chain(ends.iter().map(|ends| ends.1));
        for point in points {
            let step =
                line.points.last().map_or(0.0, |last: &Point| (point[0] - last[0]).hypot(point[1] - last[1]));
            if line.points.is_empty() || step > 1e-3 {
                line.from_start_m.push(line.length_m() + step);
                line.points.push(point);
            }
        }
        line
    }

    fn length_m(&self) -> f64 {
        self.from_start_m.last().copied().unwrap_or(0.0)
    }

    /// Place, and direction in the plane.
    fn at(&self, from_start_m: f64) -> (Point, [f64; 2]) {
        let last = self.points.len() - 1;
        let right = self.from_start_m.partition_point(|at| *at <= from_start_m).clamp(1, last);
        let (one, other) = (self.points[right - 1], self.points[right]);
        let length = self.from_start_m[right] - self.from_start_m[right - 1];
        let share = (from_start_m - self.from_start_m[right - 1]) / length;
        let at = [0, 1, 2].map(|axis| one[axis] + share * (other[axis] - one[axis]));
        (at, [(other[0] - one[0]) / length, (other[1] - one[1]) / length])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight(length_m: f64) -> Path {
        let pose = |travelled_m: f64| Pose {
            time_s: travelled_m,
            travelled_m,
            at: [travelled_m, 0.0, 2.0],
            heading_rad: std::f64::consts::FRAC_PI_2,
            ..Pose::default()
        };
        Path { poses: vec![pose(0.0), pose(0.0), pose(length_m)], located: false }
    }

    #[test]
    fn scales_are_round() {
        assert_eq!([0.3, 1.0, 1.1, 4.0, 5.1, 30_000.0].map(round_up), [0.5, 1.0, 2.0, 5.0, 10.0, 50_000.0]);
    }

    /// Stripes begin at the start of the path; the area is that of the rectangle.
    #[test]
    fn a_strip_covers_the_path_and_its_margins() {
        let strip = strip(&straight(95.0), 8.0, 12.0);
        assert_eq!(strip.stripe_m, 10.0);
        let area: f64 = strip
            .mesh
            .triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| strip.mesh.positions[corner as usize].map(f64::from));
                ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
            })
            .sum();
        assert!((area - 8.0 * (95.0 + 24.0)).abs() < 1e-2, "{area}");
        assert!(
            strip
                .mesh
                .positions
                .iter()
                .zip(&strip.mesh.colours)
                .all(|(at, colour)| { !(at[0] > 0.1 && at[0] < 9.9) || *colour == LIGHT })
        );
        assert_eq!(
            strip.marks.iter().map(|mark| mark.1).collect::<Vec<_>>(),
            (0..10).map(|mark| f64::from(mark) * 10.0).collect::<Vec<_>>()
        );
    }

    #[test]
    fn a_vehicle_that_never_moves_stands_on_a_strip() {
        assert!(!strip(&straight(0.0), 8.0, 12.0).mesh.triangles.is_empty());
    }
}
