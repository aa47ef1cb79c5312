use super::*;
use crate::AbLines;
use std::fmt::Write;

/// An ASCII grid of 41 by 31 samples, 5 m apart, of `function`, the sample in the south-west on the origin.
fn grid(function: impl Fn(f64, f64) -> f64) -> String {
    let mut text =
        "ncols 41\nnrows 31\nxllcenter 0\nyllcenter 0\ncellsize 5\nNODATA_value -1000\n".to_owned();
    for row in (0..31).rev() {
        for column in 0..41 {
            let _ = write!(text, "{} ", function(5.0 * f64::from(column), 5.0 * f64::from(row)));
        }
        text.push('\n');
    }
    text
}

fn read(grid: &str, parameters: &str) -> Result<Heightmap, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("map.asc"), grid).unwrap();
    let mut map: Heightmap = ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_str(&format!("(file: \"map.asc\", {parameters})"))
        .map_err(|error| error.to_string())?;
    map.settle(folder.path()).map_err(|refusal| refusal.to_string())?;
    Ok(map)
}

const LANES: &str =
    "heading_rad: 0.4, length_m: 60, spacing_m: 9, lanes: 4, side: Right, turn_radius_m: 6, turn_ramp_m: 3";

#[test]
fn a_plane_map_is_the_inclined_field_of_the_same_lanes() {
    let plane = |x: f64, y: f64| 0.05 * x - 0.12 * y + 7.0;
    let map =
        read(&grid(plane), &format!("start: (east_m: 50, north_m: 40), path: AbLines({LANES})")).unwrap();
    let flat: AbLines = ron::from_str(&format!("({LANES})")).unwrap();
    let mut flat = flat;
    flat.settle(Path::new(".")).unwrap();
    let end = map.extent_m().unwrap().1;
    assert!(end > flat.length_m() && end < 1.01 * flat.length_m());
    let mut mark = 0.0;
    let mut on_flat = 0.0;
    for _ in 0..3 {
        mark = map.next_mark_m("turn", mark).unwrap();
        on_flat = flat.next_mark_m("turn", on_flat).unwrap();
        let (over, below) = (map.at(mark), flat.at(on_flat));
        assert!((over.east_m - 50.0 - below.east_m).abs() < 1e-6);
        assert!((over.north_m - 40.0 - below.north_m).abs() < 1e-6);
        assert!((over.elevation_m - plane(over.east_m, over.north_m)).abs() < 1e-9);
        let (sin, cos) = over.heading_rad.sin_cos();
        assert!((over.grade() - (0.05 * sin - 0.12 * cos)).abs() < 1e-9);
    }
}

#[test]
fn a_path_over_hills_lies_on_the_surface_and_climbs_what_its_slopes_say() {
    let hills = |x: f64, y: f64| 3.0 * (0.06 * x).sin() * (0.05 * y).cos();
    let map = read(&grid(hills), "start: (east_m: 20, north_m: 20), path: Spiral(heading_rad: 0, length_m: 100, \
                    breadth_m: 120, spacing_m: 10, rounds: 3, clockwise: true, turn_radius_m: 8, turn_ramp_m: 4)").unwrap();
    let surface = map.surface().unwrap();
    let (steps, end) = (20_000, map.extent_m().unwrap().1);
    let step = end / f64::from(steps);
    let mut climbed = 0.0;
    for i in 0..steps {
        let place = map.at((f64::from(i) + 0.5) * step);
        climbed += place.sin_slope * step;
        let spot = surface.spot(place.east_m, place.north_m).unwrap();
        assert!((spot.height_m - place.elevation_m).abs() < 1e-12);
        // Keys' surface is as near to the hills as (0.06 · 5 m)³ of their height.
        assert!((place.elevation_m - hills(place.east_m, place.north_m)).abs() < 3.0 * 0.3_f64.powi(3));
    }
    let rise = map.at(end).elevation_m - map.at(0.0).elevation_m;
    assert!((climbed - rise).abs() < 1e-3, "{climbed} {rise}");
}

#[test]
fn a_path_off_the_map_is_refused_with_its_place() {
    let refusal = read(
        &grid(|_, _| 0.0),
        "start: (east_m: 100, north_m: 10), path: Straight(heading_rad: 0, length_m: 300)",
    )
    .unwrap_err();
    assert!(refusal.contains("100.0 m east, 15") && refusal.contains("off the map"), "{refusal}");
    assert!(refusal.contains("0 to 200 m east and 0 to 150 m north"), "{refusal}");
    let hole = grid(|x, y| if x == 100.0 && y == 100.0 { -1000.0 } else { 1.0 });
    let refusal =
        read(&hole, "start: (east_m: 98, north_m: 10), path: Straight(heading_rad: 0, length_m: 120)")
            .unwrap_err();
    assert!(refusal.contains("knows no height"), "{refusal}");
}

#[test]
fn what_is_missing_or_given_twice_is_refused_by_name() {
    for (parameters, told) in [
        ("path: Straight(heading_rad: 0, length_m: 30)", "`start` is not given"),
        ("start: (east_m: 9, north_m: 9), path: Points(points: [])", "`start` is given"),
        ("path: Points(points: [(east_m: 9, north_m: 9)])", "1 points, expected two or more"),
        ("path: Points(points: [(east_m: 9, north_m: 9), (east_m: 9, north_m: 9)])", "twice in a row"),
        (
            "cell_m: 4, path: Points(points: [(east_m: 9, north_m: 9), (east_m: 9, north_m: 19)])",
            "`lowest_m` is not given",
        ),
        (
            "cell_m: 4, lowest_m: 0, highest_m: 9, path: Points(points: [(east_m: 9, north_m: 9), (east_m: 9, north_m: 19)])",
            "`cell_m` is given beside `map.asc`",
        ),
        (
            "start: (east_m: 9, north_m: 9), path: Straight(heading_rad: 0, length_m: -3)",
            "`path.length_m` is -3",
        ),
        ("path: Route(file: \"x.gpx\", spacing_m: 3)", "`path.latitude_deg` is not given"),
        ("path: Zigzag(length_m: 3)", "Zigzag"),
        ("path: Straight(heading_rad: 0, length_m: 3, width_m: 4)", "width_m"),
    ] {
        let refusal = read(&grid(|_, _| 0.0), parameters).unwrap_err();
        assert!(refusal.contains(told), "{refusal}");
    }
    let inclined = format!("start: (east_m: 50, north_m: 40), path: AbLines({LANES}, grade: 0.1)");
    assert!(read(&grid(|_, _| 0.0), &inclined).unwrap_err().contains("`path.grade` is 0.1"));
    let tight = format!(
        "start: (east_m: 50, north_m: 40), path: AbLines({})",
        LANES.replace("radius_m: 6", "radius_m: 0")
    );
    assert!(
        read(&grid(|_, _| 0.0), &tight)
            .unwrap_err()
            .contains("`path.turn_radius_m` is 0, expected more than 0")
    );
}

#[test]
fn points_are_passed_smoothly_and_a_track_lies_where_the_map_is() {
    let map = read(
        &grid(|x, _| 0.1 * x),
        "path: Points(points: [(east_m: 10, north_m: 10), (east_m: 60, north_m: 30), \
                   (east_m: 120, north_m: 20)])",
    )
    .unwrap();
    assert!((map.at(0.0).east_m - 10.0).abs() < 1e-9);
    let end = map.at(map.extent_m().unwrap().1);
    assert!((end.east_m - 120.0).abs() < 1e-6 && (end.elevation_m - 12.0).abs() < 1e-6, "{end:?}");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("map.asc"), grid(|x, _| 0.1 * x)).unwrap();
    // 0.001° of latitude and of longitude at 45°: 111.13 m and 78.85 m.
    let track = "<gpx><wpt lat=\"45.0005\" lon=\"7.001\"><name>gate</name></wpt><trk><trkseg>\
                 <trkpt lat=\"45.0001\" lon=\"7.001\"/><trkpt lat=\"45.001\" lon=\"7.001\"/></trkseg></trk></gpx>";
    std::fs::write(folder.path().join("road.gpx"), track).unwrap();
    let mut map: Heightmap = ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_str("(file: \"map.asc\", path: Route(file: \"road.gpx\", spacing_m: 5, latitude_deg: 45, longitude_deg: 7))")
        .unwrap();
    map.settle(folder.path()).unwrap();
    let gate = map.at(map.next_mark_m("gate", 0.0).unwrap());
    assert!((gate.east_m - 78.85).abs() < 0.01 && (gate.north_m - 55.57).abs() < 0.3, "{gate:?}");
    assert!((gate.elevation_m - 7.885).abs() < 0.001);
}

#[test]
fn an_origin_shifts_map_and_path_together() {
    let hills = |x: f64, y: f64| 0.001 * x * y;
    let plain = read(
        &grid(hills),
        "start: (east_m: 30, north_m: 40), path: Straight(heading_rad: 0.3, length_m: 50)",
    );
    let moved = read(
        &grid(hills),
        "origin: (east_m: 20, north_m: 30), start: (east_m: 10, north_m: 10), \
                     path: Straight(heading_rad: 0.3, length_m: 50)",
    );
    let (plain, moved) = (plain.unwrap().at(25.0), moved.unwrap().at(25.0));
    assert!((plain.elevation_m - moved.elevation_m).abs() < 1e-12);
    assert!((plain.east_m - moved.east_m - 20.0).abs() < 1e-9);
}
