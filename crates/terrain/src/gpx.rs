//! Tracks and waypoints of a GPX file, on a plane about the first point.
//!
//! x = R_N cos φ₀ (λ − λ₀),  y = R_M (φ − φ₀)        R_N, R_M radii of curvature of the ellipsoid at φ₀
//!
//! Source: GPX 1.1 schema, Topografix; Snyder, *Map Projections: A Working Manual*, USGS Professional Paper 1395 (1987),
//! page 24, for the radii; the ellipsoid is that of WGS 84.
//! Good to some parts in ten thousand within 10 km.

use headland_plugin::Refusal;
use std::path::Path;

/// What a file holds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gpx {
    /// East, north and height of each point [m]; all tracks and their segments, one after the other.
    pub points: Vec<[f64; 3]>,
    /// Name, east and north of each waypoint [m].
    pub waypoints: Vec<(String, [f64; 2])>,
}

/// Half of the great axis of the ellipsoid [m], WGS 84.
const SEMI_MAJOR_M: f64 = 6_378_137.0;
/// Its flattening, WGS 84.
const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// Reads `folder/file`.
///
/// # Errors
/// [`Refusal`] of `file` says what was found, with its line.
pub(crate) fn read(folder: &Path, file: &str) -> Result<Gpx, Refusal> {
    let refuse = |found: String, expected: &str| Refusal {
        parameter: "file".to_owned(),
        found,
        expected: expected.to_owned(),
    };
    let text = std::fs::read_to_string(folder.join(file)).map_err(|error| {
        refuse(format!("`{file}`, which cannot be read: {error}"), "a GPX file beside the scenario")
    })?;
    let document = roxmltree::Document::parse(&text)
        .map_err(|error| refuse(format!("`{file}`, which is no XML: {error}"), "a GPX file"))?;
    if document.root_element().tag_name().name() != "gpx" {
        let found = format!("`{file}`, whose root is `{}`", document.root_element().tag_name().name());
        return Err(refuse(found, "`gpx`"));
    }
    let line = |node: roxmltree::Node| document.text_pos_at(node.range().start).row;
    let number = |node: roxmltree::Node, name: &str, text: Option<&str>, most: f64| {
        let value = text.and_then(|text| text.trim().parse::<f64>().ok());
        value.filter(|value| value.is_finite() && value.abs() <= most).ok_or_else(|| {
            let found = text.map_or("nothing".to_owned(), |text| format!("`{text}`"));
            refuse(format!("`{file}` with {found} as {name} in line {}", line(node)), "a number in its range")
        })
    };
    let place = |node: roxmltree::Node| {
        Ok((
            number(node, "lat", node.attribute("lat"), 89.0)?,
            number(node, "lon", node.attribute("lon"), 360.0)?,
        ))
    };
    let tagged = |name: &'static str| {
        document.descendants().filter(move |node| node.has_tag_name(name) || node.tag_name().name() == name)
    };
    let child = |node: roxmltree::Node, name: &str| {
        node.children()
            .find(|child| child.tag_name().name() == name)
            .and_then(|child| child.text())
            .map(str::to_owned)
    };
    let mut gpx = Gpx::default();
    let mut origin: Option<(f64, f64)> = None;
    let kind = if tagged("trkpt").next().is_some() { "trkpt" } else { "rtept" };
    for node in tagged(kind) {
        let (latitude, longitude) = place(node)?;
        let [east, north] = plane(*origin.get_or_insert((latitude, longitude)), (latitude, longitude));
        let height = child(node, "ele");
        let height = number(node, "ele", height.as_deref(), 12_000.0)?;
        gpx.points.push([east, north, height]);
    }
    let Some(origin) = origin else {
        return Err(refuse(
            format!("`{file}` without a point of a track or of a route"),
            "`trkpt` or `rtept`",
        ));
    };
    for node in tagged("wpt") {
        let Some(name) = child(node, "name") else { continue };
        gpx.waypoints.push((name.trim().to_owned(), plane(origin, place(node)?)));
    }
    Ok(gpx)
}

/// East and north of a place [°] from an origin [m].
fn plane(origin: (f64, f64), place: (f64, f64)) -> [f64; 2] {
    let (sin, cos) = origin.0.to_radians().sin_cos();
    let e2 = FLATTENING * (2.0 - FLATTENING);
    let w = (1.0 - e2 * sin * sin).sqrt();
    let (across, along) = (SEMI_MAJOR_M / w, SEMI_MAJOR_M * (1.0 - e2) / (w * w * w));
    [across * cos * (place.1 - origin.1).to_radians(), along * (place.0 - origin.0).to_radians()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<Gpx, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("x.gpx"), text).unwrap();
        read(folder.path(), "x.gpx").map_err(|refusal| refusal.to_string())
    }

    const GOOD: &str = "<?xml version=\"1.0\"?>\n<gpx xmlns=\"http://www.topografix.com/GPX/1/1\" version=\"1.1\">\n\
        <wpt lat=\"45.001\" lon=\"7\"><name> yard </name></wpt>\n<trk><trkseg>\n\
        <trkpt lat=\"45\" lon=\"7\"><ele>230</ele></trkpt>\n<trkpt lat=\"45.001\" lon=\"7.001\"><ele>232.5</ele></trkpt>\n\
        </trkseg></trk></gpx>";

    /// At 45° a minute of latitude is 1852.2 m, so 0.001° are 111.13 m; 0.001° of longitude are 78.85 m.
    #[test]
    fn degrees_become_metres_of_the_ellipsoid() {
        let gpx = read_text(GOOD).unwrap();
        assert_eq!(gpx.points[0], [0.0, 0.0, 230.0]);
        let [east, north, height] = gpx.points[1];
        assert!((east - 78.85).abs() < 0.01 && (north - 111.13).abs() < 0.01, "{east} {north}");
        assert_eq!(height, 232.5);
        assert_eq!(gpx.waypoints[0].0, "yard");
    }

    #[test]
    fn what_is_no_track_is_refused_with_its_line() {
        let told = |from: &str, to: &str| read_text(&GOOD.replace(from, to)).unwrap_err();
        assert!(told("lat=\"45\"", "lat=\"north\"").contains("`north` as lat in line 5"));
        assert!(told("<ele>232.5</ele>", "").contains("nothing as ele in line 6"));
        assert!(told("</trkseg>", "").contains("no XML"));
        assert!(read_text("<kml/>").unwrap_err().contains("whose root is `kml`"));
        assert!(read_text("<gpx/>").unwrap_err().contains("without a point"));
    }
}
