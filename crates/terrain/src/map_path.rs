//! Ways over a map: which line is driven, before the ground gives it height.

use crate::ab_lines::UpAndDown;
use crate::gpx::{self, Asked};
use crate::laid::{Line, Pattern};
use crate::marks::Marks;
use crate::plane::{PlanePath, Pose};
use crate::route::{follow, smooth};
use crate::spiral::Around;
use crate::spline::Spline;
use headland_plugin::{Place, Refusal};
use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeOwned, Deserializer, EnumAccess, MapAccess, VariantAccess, Visitor};
use std::marker::PhantomData;
use std::path::Path;

/// A way over a map as scenarios write it.
#[derive(Clone, Debug)]
pub(crate) enum MapPath {
    Straight(Straight),
    AbLines(UpAndDown),
    Spiral(Around),
    Points(Points),
    Route(Track),
}

/// Straight on.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Straight {
    heading_rad: f64,
    length_m: f64,
}

/// A smooth line through points of the map.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Points {
    points: Vec<Corner>,
}

/// A point of the map.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub(crate) struct Corner {
    pub east_m: f64,
    pub north_m: f64,
}

/// A track from a GPX file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Route")]
pub(crate) struct Track {
    file: String,
    spacing_m: f64,
    /// Of the map's origin.
    #[serde(default)]
    latitude_deg: Option<f64>,
    #[serde(default)]
    longitude_deg: Option<f64>,
}

/// Which way it is.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(variant_identifier)]
enum Way {
    Straight,
    AbLines,
    Spiral,
    Points,
    Route,
}

const NAMES: &[&str] = &["Straight", "AbLines", "Spiral", "Points", "Route"];

/// Fields of each way, in the order of the names: what `deserialize_struct` would ask for.
const FIELDS: [&[&str]; 5] = [
    &["heading_rad", "length_m"],
    &[
        "heading_rad",
        "length_m",
        "spacing_m",
        "lanes",
        "side",
        "turn_radius_m",
        "turn_ramp_m",
        "grade",
        "uphill_rad",
    ],
    &[
        "heading_rad",
        "length_m",
        "breadth_m",
        "spacing_m",
        "rounds",
        "clockwise",
        "turn_radius_m",
        "turn_ramp_m",
        "grade",
        "uphill_rad",
    ],
    &["points"],
    &["file", "spacing_m", "latitude_deg", "longitude_deg"],
];

/// Written as `AbLines(heading_rad: ...)`, with the parameters of the terrain of that name.
impl<'de> Deserialize<'de> for MapPath {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Ways;
        impl<'de> Visitor<'de> for Ways {
            type Value = MapPath;

            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                write!(f, "one of {}", NAMES.join(", "))
            }

            fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<MapPath, A::Error> {
                let (way, own) = data.variant::<Way>()?;
                let of = FIELDS[way as usize];
                match way {
                    Way::Straight => fields(own, of).map(MapPath::Straight),
                    Way::AbLines => fields(own, of).map(MapPath::AbLines),
                    Way::Spiral => fields(own, of).map(MapPath::Spiral),
                    Way::Points => fields(own, of).map(MapPath::Points),
                    Way::Route => fields(own, of).map(MapPath::Route),
                }
            }
        }
        deserializer.deserialize_enum("path", NAMES, Ways)
    }
}

/// The parameters of a way, between its parentheses.
fn fields<'de, A: VariantAccess<'de>, T: DeserializeOwned>(
    way: A,
    names: &'static [&'static str],
) -> Result<T, A::Error> {
    struct Fields<T>(PhantomData<T>);
    impl<'de, T: DeserializeOwned> Visitor<'de> for Fields<T> {
        type Value = T;

        fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
            f.write_str("the parameters of a path")
        }

        fn visit_map<M: MapAccess<'de>>(self, map: M) -> Result<T, M::Error> {
            T::deserialize(MapAccessDeserializer::new(map))
        }
    }
    way.struct_variant(names, Fields(PhantomData))
}

/// A line on the map.
#[derive(Clone, Debug)]
pub(crate) enum MapLine {
    /// From a start.
    Plane(PlanePath, Corner),
    Spline(Spline),
}

impl MapLine {
    /// Its length on the map [m].
    pub fn length_m(&self) -> f64 {
        match self {
            Self::Plane(path, _) => path.length_m(),
            Self::Spline(path) => path.length_m(),
        }
    }

    /// Where it is at a distance along it on the map [m].
    pub fn at(&self, along_m: f64) -> Pose {
        match self {
            Self::Plane(path, start) => {
                let pose = path.at(along_m);
                Pose { east_m: pose.east_m + start.east_m, north_m: pose.north_m + start.north_m, ..pose }
            }
            Self::Spline(path) => path.at(along_m),
        }
    }
}

impl MapPath {
    /// The line and its marks, both counted along the map; `origin` is the map's own latitude and longitude [°].
    ///
    /// # Errors
    /// [`Refusal`] names the parameter, from the terrain on.
    pub fn line(
        &self,
        start: Option<Corner>,
        origin: Option<(f64, f64)>,
        folder: &Path,
    ) -> Result<(MapLine, Marks), Refusal> {
        let from = |line: Line| {
            let start =
                start.ok_or_else(|| refuse("start", "not given", "where on the map the path begins"))?;
            if !(start.east_m.is_finite() && start.north_m.is_finite()) {
                return Err(refuse(
                    "start",
                    &format!("({}, {})", start.east_m, start.north_m),
                    "finite numbers",
                ));
            }
            Ok((MapLine::Plane(line.path, start), line.marks))
        };
        if start.is_some() && matches!(self, Self::Points(_) | Self::Route(_)) {
            return Err(refuse("start", "given", "nothing: the path's own points say where it begins"));
        }
        match self {
            Self::Straight(straight) => from(straight.line()?),
            Self::AbLines(pattern) => from(patterned(pattern)?),
            Self::Spiral(pattern) => from(patterned(pattern)?),
            Self::Points(points) => points.line(),
            Self::Route(track) => track.line(origin, folder),
        }
    }
}

fn refuse(parameter: &str, found: &str, expected: &str) -> Refusal {
    Refusal { parameter: parameter.to_owned(), found: found.to_owned(), expected: expected.to_owned() }
}

/// A pattern whose own plane is level: the map knows the slope.
fn patterned<P: Pattern>(pattern: &P) -> Result<Line, Refusal> {
    let plane = pattern.incline();
    if plane.grade != 0.0 || plane.uphill_rad != 0.0 {
        return Err(refuse("path.grade", &plane.grade.to_string(), "none: the map knows the slope"));
    }
    let within = |refusal: Refusal| Refusal { parameter: format!("path.{}", refusal.parameter), ..refusal };
    hold(pattern).and_then(|()| pattern.line()).map_err(within)
}

/// Holds the numbers of a pattern to what its card says.
fn hold<P: Pattern>(pattern: &P) -> Result<(), Refusal> {
    for (name, value) in pattern.numbers() {
        let card = P::CARD.parameters.iter().find(|parameter| parameter.name == name);
        if let Some(bound) = card.map(|card| card.bound).filter(|bound| !bound.holds(value)) {
            return Err(refuse(name, &value.to_string(), &bound.in_words()));
        }
    }
    Ok(())
}

impl Straight {
    fn line(&self) -> Result<Line, Refusal> {
        if !(self.length_m.is_finite() && self.length_m > 0.0) {
            return Err(refuse("path.length_m", &self.length_m.to_string(), "more than 0"));
        }
        let mut line = Line::heading(self.heading_rad);
        line.path.go(self.length_m, 0.0, 0.0);
        Ok(line)
    }
}

impl Points {
    fn line(&self) -> Result<(MapLine, Marks), Refusal> {
        let refuse = |found: String, expected: &str| refuse("path.points", &found, expected);
        if self.points.len() < 2 {
            return Err(refuse(format!("{} points", self.points.len()), "two or more"));
        }
        if let Some(odd) = self.points.iter().find(|point| !(point.east_m + point.north_m).is_finite()) {
            return Err(refuse(format!("({}, {})", odd.east_m, odd.north_m), "finite numbers"));
        }
        if let Some([twice, _]) = self.points.array_windows().find(|[one, two]| one == two) {
            let found = format!("({}, {}) twice in a row", twice.east_m, twice.north_m);
            return Err(refuse(found, "points that lie apart"));
        }
        let points: Vec<[f64; 2]> = self.points.iter().map(|point| [point.east_m, point.north_m]).collect();
        Ok((MapLine::Spline(Spline::through(&points)), Marks::default()))
    }
}

impl Track {
    fn line(&self, origin: Option<(f64, f64)>, folder: &Path) -> Result<(MapLine, Marks), Refusal> {
        let within =
            |refusal: Refusal| Refusal { parameter: format!("path.{}", refusal.parameter), ..refusal };
        let origin = match (origin, self.latitude_deg.zip(self.longitude_deg)) {
            (Some(own), None) => own,
            (None, Some(given)) => given,
            (Some(_), Some(_)) => {
                return Err(refuse("path.latitude_deg", "given", "none: the map knows where it lies"));
            }
            (None, None) => {
                let expected = "latitude and longitude of the map's origin";
                return Err(refuse("path.latitude_deg", "not given", expected));
            }
        };
        if !(origin.0.abs() <= 89.0 && origin.1.abs() <= 360.0) {
            let found = format!("{} with the longitude {}", origin.0, origin.1);
            return Err(refuse("path.latitude_deg", &found, "a place on the earth"));
        }
        let track = gpx::read(folder, &self.file, Asked::Map(origin.0, origin.1)).map_err(within)?;
        let points = follow(&self.file, &track.points, self.spacing_m).map_err(within)?;
        let path = smooth(&points);
        let marks = crate::route::waypoints(&self.file, &path, track.waypoints).map_err(within)?;
        let mut set = Marks::default();
        for (at_m, name) in marks {
            set.set(&name, at_m);
        }
        Ok((MapLine::Spline(path), set))
    }
}

/// A pose with the height and the slopes that the ground gives it, along its heading and to its right.
pub(crate) fn on_ground(pose: &Pose, height_m: f64, (rise, fall): (f64, f64)) -> Place {
    let cos_slope = 1.0 / rise.hypot(1.0);
    Place {
        elevation_m: height_m,
        sin_slope: rise * cos_slope,
        sin_roll: fall * cos_slope / rise.hypot(fall).hypot(1.0),
        heading_rad: pose.heading_rad,
        curvature_per_m: pose.curvature * cos_slope,
        east_m: pose.east_m,
        north_m: pose.north_m,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_plugin::{Form, form_of};

    #[test]
    fn each_way_asks_for_the_fields_that_it_has() {
        let own = [
            form_of::<Straight>(),
            form_of::<UpAndDown>(),
            form_of::<Around>(),
            form_of::<Points>(),
            form_of::<Track>(),
        ];
        let Form::Choice(ways) = form_of::<MapPath>() else { panic!("a choice") };
        for ((name, form), (own, known)) in ways.into_iter().zip(own.into_iter().zip(NAMES)) {
            assert_eq!((name.as_str(), form), (*known, Some(own)));
        }
    }
}
