//! Elevation along a path, from a list or a file.
//!
//! h(s) by monotone cubic interpolation, sin θ = dh/ds        s along the path
//!
//! Source: Fritsch and Carlson, "Monotone piecewise cubic interpolation", SIAM J. Numer. Anal. 17 (1980), 238-246.
//! Slope has no steps and no hill is made between two points. Positions count along the path, not on the map. Beyond
//! its ends the ground goes on straight; the path itself ends there. Leaves out turns.

use crate::curve::Curve;
use crate::file;
use headland_plugin::{Card, Place, Plugin, Refusal, Terrain, parameter};
use serde::Deserialize;
use std::path::Path;

/// A path whose elevation is known at some positions.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    heading_rad: f64,
    #[serde(default)]
    points: Vec<Point>,
    #[serde(default)]
    file: Option<String>,
    #[serde(skip)]
    curve: Curve,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Point {
    position_m: f64,
    elevation_m: f64,
}

impl Plugin for Profile {
    const CARD: Card = Card {
        name: "Profile",
        about: "elevation along a straight path, from a list or from a file",
        equation: "sin θ = dh/ds, h(s) by monotone cubic interpolation",
        source: "Fritsch and Carlson, Monotone piecewise cubic interpolation, SIAM J. Numer. Anal. 17 (1980), 238-246",
        validity: "between the first and the last point; leaves out turns and roughness shorter than the points",
        parameters: &[
            parameter("heading_rad", "rad", "direction of travel, clockwise from north")
                .usually(-std::f64::consts::TAU, std::f64::consts::TAU),
            parameter(
                "points",
                "[(position_m, elevation_m)]",
                "two or more, in the order of the path; or `file`",
            ),
            parameter(
                "file",
                "path",
                "CSV with the columns position_m and elevation_m, relative to the scenario; or `points`",
            ),
        ],
    };

    fn settle(&mut self, folder: &Path) -> Result<(), Refusal> {
        let (parameter, points) = match (&self.file, self.points.as_slice()) {
            (Some(file), []) => ("file", file::read(folder, file)?),
            (None, points) => ("points", points.iter().map(|p| (p.position_m, p.elevation_m)).collect()),
            (Some(_), _) => return Err(refuse("points", "given beside `file`", "one of the two")),
        };
        check(parameter, &points)?;
        self.curve = Curve::through(&points);
        if let Some((position, slope)) = self.curve.steepest().filter(|(_, slope)| slope.abs() >= 1.0) {
            let found = format!("rising {slope:.3} m per metre of path at {position} m");
            return Err(refuse(parameter, &found, "less than 1: positions count along the path"));
        }
        Ok(())
    }
}

fn refuse(parameter: &str, found: &str, expected: &str) -> Refusal {
    Refusal { parameter: parameter.to_owned(), found: found.to_owned(), expected: expected.to_owned() }
}

fn check(parameter: &str, points: &[(f64, f64)]) -> Result<(), Refusal> {
    if points.len() < 2 {
        return Err(refuse(parameter, &format!("{} points", points.len()), "two or more"));
    }
    if let Some((x, y)) = points.iter().find(|(x, y)| !x.is_finite() || !y.is_finite()) {
        return Err(refuse(parameter, &format!("({x}, {y})"), "finite numbers"));
    }
    match points.windows(2).find(|pair| pair[1].0 <= pair[0].0) {
        Some(pair) => {
            let found = format!("at {} m after {} m", pair[1].0, pair[0].0);
            Err(refuse(parameter, &found, "positions that increase"))
        }
        None => Ok(()),
    }
}

impl Terrain for Profile {
    fn at(&self, position_m: f64) -> Place {
        let point = self.curve.at(position_m);
        let (sin, cos) = self.heading_rad.sin_cos();
        Place {
            elevation_m: point.value,
            sin_slope: point.slope,
            heading_rad: self.heading_rad,
            sin_roll: 0.0,
            curvature_per_m: 0.0,
            east_m: point.horizontal * sin,
            north_m: point.horizontal * cos,
        }
    }

    fn extent_m(&self) -> Option<(f64, f64)> {
        self.curve.extent()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn profile(points: &str) -> Result<Profile, String> {
        let mut profile: Profile =
            ron::from_str(&format!("(heading_rad: 0.0, {points})")).map_err(|error| error.to_string())?;
        profile.settle(Path::new(".")).map_err(|refusal| refusal.to_string())?;
        Ok(profile)
    }

    /// Two points make a straight slope: 100 m of path that rise 6 m go √(100² − 6²) = 99.82 m ahead.
    #[test]
    fn two_points_are_a_straight_slope() {
        let ground =
            profile("points: [(position_m: 0.0, elevation_m: 1.0), (position_m: 100.0, elevation_m: 7.0)]")
                .unwrap();
        let place = ground.at(50.0);
        assert!((place.elevation_m - 4.0).abs() < 1e-12 && (place.sin_slope - 0.06).abs() < 1e-12);
        assert!((ground.at(100.0).north_m - 99.82).abs() < 1e-2);
        assert_eq!(ground.extent_m(), Some((0.0, 100.0)));
    }

    #[test]
    fn a_file_gives_the_same_ground_as_a_list() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("hill.csv"), "position_m,elevation_m\n0,0\n40,1\n90,1.5\n").unwrap();
        let mut from_file: Profile = ron::from_str("(heading_rad: 0.0, file: Some(\"hill.csv\"))").unwrap();
        from_file.settle(folder.path()).unwrap();
        let list = "points: [(position_m: 0.0, elevation_m: 0.0), (position_m: 40.0, elevation_m: 1.0), \
                    (position_m: 90.0, elevation_m: 1.5)]";
        let from_list = profile(list).unwrap();
        for x in [-5.0, 3.0, 40.0, 77.0, 120.0] {
            assert_eq!(from_file.at(x), from_list.at(x));
        }
    }

    #[test]
    fn positions_that_do_not_increase_are_refused() {
        let twice = "points: [(position_m: 3.0, elevation_m: 0.0), (position_m: 3.0, elevation_m: 0.1)]";
        assert_eq!(
            profile(twice).unwrap_err(),
            "`points` is at 3 m after 3 m, expected positions that increase"
        );
    }

    #[test]
    fn a_wall_is_refused() {
        let wall = "points: [(position_m: 0.0, elevation_m: 0.0), (position_m: 1.0, elevation_m: 1.0)]";
        assert!(profile(wall).unwrap_err().contains("positions count along the path"));
    }

    #[test]
    fn too_few_points_both_sources_or_none_are_refused() {
        assert!(profile("points: [(position_m: 0.0, elevation_m: 0.0)]").unwrap_err().contains("1 points"));
        assert!(profile("").unwrap_err().contains("0 points"));
        let both = "file: Some(\"x.csv\"), points: [(position_m: 0.0, elevation_m: 0.0)]";
        assert!(profile(both).unwrap_err().contains("given beside `file`"));
    }
}
