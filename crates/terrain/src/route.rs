//! A road from a GPX track.
//!
//! A smooth path through the points of the track; height along it by monotone cubic interpolation.
//!
//! Source: GPX 1.1 schema, Topografix; de Boor, *A Practical Guide to Splines* (1978), chapter IV; Fritsch and Carlson, SIAM
//! J. Numer. Anal. 17 (1980), 238-246.
//! Points nearer to the last one than `spacing_m` are left out, since noise of a receiver would make curves and slopes of
//! them. Positions count along the road, its slopes included; the map shows it foreshortened. Waypoints with a name are marks at the point of the path that is
//! nearest to them.

use crate::curve::Curve;
use crate::gpx::{self, Asked};
use crate::marks::Marks;
use crate::spline::Spline;
use headland_plugin::{Bound, Card, Place, Plugin, Refusal, Terrain, parameter};
use serde::Deserialize;
use std::path::Path;

/// A path along a recorded track.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Route {
    file: String,
    spacing_m: f64,
    #[serde(skip)]
    path: Spline,
    #[serde(skip)]
    height: Curve,
    /// Metres of the map for each horizontal metre of the curve of heights, which rounds the corners of the chords.
    #[serde(skip)]
    map_share: f64,
    #[serde(skip)]
    marks: Marks,
}

impl Plugin for Route {
    const CARD: Card = Card {
        name: "Route",
        about: "a road from a GPX track, smooth through its points; named waypoints are marks",
        equation: "x(u), y(u) natural cubic splines over the chord, s = ∫ √(x′² + y′²) du; dh/ds by monotone cubics",
        source: "GPX 1.1 schema, Topografix; de Boor, A Practical Guide to Splines (1978), chapter IV; Fritsch and Carlson, \
                 SIAM J. Numer. Anal. 17 (1980), 238-246",
        validity: "within some 10 km; as good as the track, whose heights have to be there",
        parameters: &[
            parameter("file", "path", "GPX file with a track or a route, relative to the scenario"),
            parameter("spacing_m", "m", "points nearer to the last one are left out")
                .must_be(Bound::Positive)
                .usually(1.0, 200.0),
        ],
    };

    fn settle(&mut self, folder: &Path) -> Result<(), Refusal> {
        let track = gpx::read(folder, &self.file, Asked::Road)?;
        let points = follow(&self.file, &track.points, self.spacing_m)?;
        self.path = smooth(&points);
        let (mut heights, mut road_m, mut before): (Vec<(f64, f64)>, f64, _) = (Vec::new(), 0.0, None);
        for (map_m, point) in self.path.knots_m().zip(&points) {
            let step =
                before.map_or(0.0, |(last_m, height): (f64, f64)| (map_m - last_m).hypot(point[2] - height));
            road_m += step;
            before = Some((map_m, point[2]));
            heights.push((road_m, point[2]));
        }
        self.height = Curve::through(&heights);
        self.map_share = self.path.length_m() / self.height.at(road_m).horizontal;
        if let Some((at_m, slope)) = self.height.steepest().filter(|(_, slope)| slope.abs() >= 1.0) {
            return Err(refuse(
                &self.file,
                &format!("rising {slope:.2} m per metre at {at_m:.0} m"),
                "less than 1",
            ));
        }
        let marks = waypoints(&self.file, &self.path, track.waypoints)?;
        self.marks = Marks::default();
        for (at_m, name) in marks {
            // What the map shows shorter is as long on the road as the whole of it, which is near enough for a mark.
            self.marks.set(&name, at_m * road_m / self.path.length_m());
        }
        Ok(())
    }
}

fn refuse(file: &str, found: &str, expected: &str) -> Refusal {
    Refusal {
        parameter: "file".to_owned(),
        found: format!("`{file}` {found}"),
        expected: expected.to_owned(),
    }
}

/// The points of a track that are far enough apart.
pub(crate) fn follow(file: &str, track: &[[f64; 3]], spacing_m: f64) -> Result<Vec<[f64; 3]>, Refusal> {
    let mut points: Vec<[f64; 3]> = Vec::new();
    for point in track {
        let far = |last: &[f64; 3]| (point[0] - last[0]).hypot(point[1] - last[1]) >= spacing_m;
        if points.last().is_none_or(far) {
            points.push(*point);
        }
    }
    if points.len() < 2 {
        let found = format!("with {} points that are {spacing_m} m apart", points.len());
        return Err(refuse(file, &found, "two or more"));
    }
    Ok(points)
}

/// The smooth line through points of a track on the map.
pub(crate) fn smooth(points: &[[f64; 3]]) -> Spline {
    let flat: Vec<[f64; 2]> = points.iter().map(|point| [point[0], point[1]]).collect();
    Spline::through(&flat)
}

/// Where along the map each waypoint stands, in the order of the path.
pub(crate) fn waypoints(
    file: &str,
    path: &Spline,
    waypoints: Vec<(String, [f64; 2])>,
) -> Result<Vec<(f64, String)>, Refusal> {
    let mut marks = Vec::new();
    for (name, place) in waypoints {
        let (at_m, away_m) = nearest(path, place);
        if away_m > FARTHEST_MARK_M {
            let found = format!("with the waypoint `{name}`, {away_m:.0} m from its track");
            return Err(refuse(file, &found, "waypoints within 50 m of it"));
        }
        marks.push((at_m, name));
    }
    marks.sort_by(|one, two| one.0.total_cmp(&two.0));
    Ok(marks)
}

/// A waypoint that lies farther from the track belongs to another one.
const FARTHEST_MARK_M: f64 = 50.0;

/// Steps in which the nearest point is looked for [m]; waypoints are not known better.
const LOOK_M: f64 = 0.5;

/// Where a path is nearest to a place, and how far that is [m].
fn nearest(path: &Spline, place: [f64; 2]) -> (f64, f64) {
    let mut best = (0.0, f64::INFINITY);
    let mut s = 0.0;
    while s <= path.length_m() {
        let pose = path.at(s);
        let away = (pose.east_m - place[0]).hypot(pose.north_m - place[1]);
        if away < best.1 {
            best = (s, away);
        }
        s += LOOK_M;
    }
    best
}

impl Terrain for Route {
    fn at(&self, position_m: f64) -> Place {
        let height = self.height.at(position_m);
        let pose = self.path.at(height.horizontal * self.map_share);
        Place {
            elevation_m: height.value,
            sin_slope: height.slope,
            sin_roll: 0.0,
            heading_rad: pose.heading_rad,
            curvature_per_m: pose.curvature,
            east_m: pose.east_m,
            north_m: pose.north_m,
        }
    }

    fn extent_m(&self) -> Option<(f64, f64)> {
        self.height.extent()
    }

    fn marks(&self) -> Vec<&str> {
        self.marks.names()
    }

    fn next_mark_m(&self, name: &str, position_m: f64) -> Option<f64> {
        self.marks.next_m(name, position_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn route(points: &[(f64, f64, f64)], waypoint: (f64, f64)) -> Result<Route, String> {
        let folder = tempfile::tempdir().unwrap();
        let point = |(lat, lon, ele): &(f64, f64, f64)| {
            format!("<trkpt lat=\"{lat}\" lon=\"{lon}\"><ele>{ele}</ele></trkpt>")
        };
        let track = points.iter().map(point).collect::<Vec<_>>().concat();
        let (lat, lon) = waypoint;
        let text = format!(
            "<gpx><wpt lat=\"{lat}\" lon=\"{lon}\"><name>gate</name></wpt><trk><trkseg>{track}</trkseg></trk></gpx>"
        );
        std::fs::write(folder.path().join("x.gpx"), text).unwrap();
        let mut route: Route = ron::from_str("(file: \"x.gpx\", spacing_m: 5)").unwrap();
        route.settle(folder.path()).map_err(|refusal| refusal.to_string())?;
        Ok(route)
    }

    const STRAIGHT: [(f64, f64, f64); 4] =
        [(45.0, 7.0, 100.0), (45.0, 7.000_001, 100.0), (45.001, 7.0, 105.0), (45.002, 7.0, 105.0)];

    /// 0.002° northward are 222.27 m; the second point lies 0.08 m beside the first and is left out.
    #[test]
    fn a_straight_road_has_its_length_its_heights_and_its_gate() {
        let road = route(&STRAIGHT, (45.0005, 7.0001)).unwrap();
        let (_, end) = road.extent_m().unwrap();
        // 111.13 m that rise 5 m are 111.25 m of road.
        assert!((end - 222.38).abs() < 0.02, "{end}");
        assert!((road.at(111.25).elevation_m - 105.0).abs() < 1e-3);
        assert!((road.at(end).north_m - 222.27).abs() < 0.02);
        assert_eq!(road.at(30.0).curvature_per_m, 0.0);
        assert!((road.next_mark_m("gate", 0.0).unwrap() - 55.5).abs() < 0.6);
        let rise = road.at(30.1).elevation_m - road.at(30.0).elevation_m;
        let place = road.at(30.05);
        assert!((rise / 0.1 - place.sin_slope).abs() < 1e-6, "{}", place.sin_slope);
    }

    #[test]
    fn a_waypoint_of_another_road_and_a_track_that_stands_still_are_refused() {
        assert!(route(&STRAIGHT, (45.0005, 7.01)).unwrap_err().contains("the waypoint `gate`"));
        assert!(route(&STRAIGHT[..2], (45.0, 7.0)).unwrap_err().contains("1 points"));
    }
}
