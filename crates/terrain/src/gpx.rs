//! Tracks and waypoints of a GPX file, on a plane about the first point or about one that is given.
//!
//! Source: GPX 1.1 schema, Topografix.

use headland_plugin::Refusal;
use headland_raster::plane;
use std::path::Path;

/// What a file holds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gpx {
    /// East, north and height of each point [m]; all tracks and their segments, one after the other. Heights that nobody
    /// asked for are NaN.
    pub points: Vec<[f64; 3]>,
    /// Name, east and north of each waypoint [m].
    pub waypoints: Vec<(String, [f64; 2])>,
}

/// What is asked of a file.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Asked {
    /// Its heights too; the plane lies about the first point.
    Road,
    /// The map alone, on a plane about this latitude and longitude [°].
    Map(f64, f64),
}

/// Reads `folder/file`.
///
/// # Errors
/// [`Refusal`] of `file` says what was found, with its line.
pub(crate) fn read(folder: &Path, file: &str, asked: Asked) -> Result<Gpx, Refusal> {
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
    let mut origin = match asked {
        Asked::Road => None,
        Asked::Map(latitude, longitude) => Some((latitude, longitude)),
    };
    let kind = if tagged("trkpt").next().is_some() { "trkpt" } else { "rtept" };
    for node in tagged(kind) {
        let (latitude, longitude) = place(node)?;
        let [east, north] = plane(*origin.get_or_insert((latitude, longitude)), (latitude, longitude));
        let height = match asked {
            Asked::Road => number(node, "ele", child(node, "ele").as_deref(), 12_000.0)?,
            Asked::Map(..) => f64::NAN,
        };
        gpx.points.push([east, north, height]);
    }
    let Some(origin) = origin.filter(|_| !gpx.points.is_empty()) else {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<Gpx, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("x.gpx"), text).unwrap();
        read(folder.path(), "x.gpx", Asked::Road).map_err(|refusal| refusal.to_string())
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
    fn a_map_has_its_own_origin_and_needs_no_heights() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("x.gpx"), GOOD.replace("<ele>232.5</ele>", "")).unwrap();
        let gpx = read(folder.path(), "x.gpx", Asked::Map(45.001, 7.0)).unwrap();
        assert!((gpx.points[0][1] + 111.13).abs() < 0.01 && gpx.points[1][1] == 0.0, "{:?}", gpx.points);
        assert_eq!(gpx.waypoints[0].1, [0.0, 0.0]);
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
