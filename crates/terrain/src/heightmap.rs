//! Ground from a map of heights, and a path over it.
//!
//! h(x, y) by cubic convolution through the samples; s = ∫ √(1 + p²) du, p = h_x sin θ + h_y cos θ
//!
//! Source: Keys, "Cubic convolution interpolation for digital image processing", IEEE Transactions on Acoustics, Speech, and
//! Signal Processing 29 (1981), 1153-1160; for the files *ArcGIS* documentation of ASCII grids, OGC GeoTIFF Standard 1.1 and
//! the PNG specification.
//! Slopes have no steps; waves shorter than two cells are not in the map. Positions count along the ground, the map shows
//! them foreshortened; the heading is that of the map. A path has to stay where heights are known.

use crate::draped::{Draped, OffMap};
use crate::map_path::{Corner, MapPath};
use crate::marks::Marks;
use headland_plugin::{Bound, Bounds, Card, Place, Plugin, Refusal, Spot, Surface, Terrain, parameter};
use headland_raster::{Picture, Smoothed};
use serde::Deserialize;
use std::path::Path;

/// A map of heights, and a path over it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Heightmap {
    file: String,
    #[serde(default)]
    cell_m: Option<f64>,
    #[serde(default)]
    lowest_m: Option<f64>,
    #[serde(default)]
    highest_m: Option<f64>,
    #[serde(default)]
    origin: Option<Corner>,
    #[serde(default)]
    start: Option<Corner>,
    path: MapPath,
    #[serde(skip)]
    ground: Option<Ground>,
    #[serde(skip)]
    marks: Marks,
}

/// What is settled.
#[derive(Clone, Debug)]
struct Ground {
    relief: Relief,
    path: Draped,
}

/// The surface through the samples.
#[derive(Clone, Debug)]
struct Relief(Smoothed);

impl Surface for Relief {
    fn spot(&self, east_m: f64, north_m: f64) -> Option<Spot> {
        let smooth = self.0.at(east_m, north_m)?;
        Some(Spot { height_m: smooth.value, rise_east: smooth.rise_east, rise_north: smooth.rise_north })
    }

    fn bounds(&self) -> Option<Bounds> {
        Some(self.0.bounds())
    }
}

/// Knots of the path for each cell of the map: the slope bends within a cell.
const KNOTS_A_CELL: f64 = 4.0;

impl Plugin for Heightmap {
    const CARD: Card = Card {
        name: "Heightmap",
        about: "ground from a map of heights, and a path over it: straight, lanes, rounds, points or a track",
        equation: "h(x, y) = Σ h_ij w(x − i) w(y − j), w of cubic convolution; s = ∫ √(1 + p²) du, p = h_x sin θ + h_y cos θ",
        source: "Keys, Cubic convolution interpolation for digital image processing, IEEE Trans. ASSP 29 (1981), 1153-1160",
        validity: "where the map knows heights; leaves out what is shorter than two of its cells",
        parameters: &[
            parameter(
                "file",
                "path",
                "relative to the scenario: an ASCII grid (.asc), a GeoTIFF (.tif) in metres or degrees, or a grey picture \
                 of 16 bits (.png)",
            ),
            parameter("cell_m", "m", "how far pixels are apart; with a picture, and only with one")
                .must_be(Bound::Positive)
                .usually(0.05, 100.0),
            parameter("lowest_m", "m", "height of black; with a picture").usually(-500.0, 9000.0),
            parameter("highest_m", "m", "height of white; with a picture").usually(-500.0, 9000.0),
            parameter(
                "origin",
                "(east_m, north_m)",
                "the point of the file's own coordinates that is 0, 0 here; left out: theirs, the pixel in the south-west \
                 of a picture or of a map in degrees",
            ),
            parameter("start", "(east_m, north_m)", "where Straight, AbLines and Spiral begin"),
            parameter(
                "path",
                "Straight | AbLines | Spiral | Points | Route",
                "`Straight(heading_rad, length_m)`; `AbLines(...)` and `Spiral(...)` with the parameters of those terrains, \
                 without their grade; `Points(points: [(east_m, north_m)])`, smooth through them; `Route(file, spacing_m, \
                 latitude_deg, longitude_deg)`, a GPX track and the place of the map's origin, where the map itself does \
                 not know it",
            ),
        ],
    };

    fn settle(&mut self, folder: &Path) -> Result<(), Refusal> {
        let raster = headland_raster::read(folder, &self.file, self.picture()?.as_ref())?;
        let origin = raster.geographic().filter(|_| self.origin.is_none());
        let raster = match self.origin {
            Some(Corner { east_m, north_m }) => raster.from_origin(east_m, north_m),
            None => raster,
        };
        let [across, along] = raster.cell_m();
        let Some(smoothed) = raster.smoothed() else {
            let found = format!("`{}`, {} columns and {} rows", self.file, raster.columns(), raster.rows());
            return Err(refuse("file", found, "three of each or more"));
        };
        let relief = Relief(smoothed);
        let (line, marks) = self.path.line(self.start, origin, folder)?;
        let path = Draped::over(line, &relief, across.min(along) / KNOTS_A_CELL)
            .map_err(|off| off_map(&off, &relief.0.bounds()))?;
        self.marks = marks.moved(|along_map_m| path.along_ground_m(along_map_m));
        self.ground = Some(Ground { relief, path });
        Ok(())
    }
}

impl Heightmap {
    /// What a picture cannot say itself.
    fn picture(&self) -> Result<Option<Picture>, Refusal> {
        match (self.cell_m, self.lowest_m, self.highest_m) {
            (Some(cell_m), Some(lowest_m), Some(highest_m)) => {
                if lowest_m >= highest_m {
                    let expected = format!("less than `highest_m`, {highest_m}");
                    return Err(refuse("lowest_m", lowest_m.to_string(), &expected));
                }
                Ok(Some(Picture { cell_m, range: Some((lowest_m, highest_m)) }))
            }
            (None, None, None) => Ok(None),
            (cell_m, lowest_m, _) => {
                let missing = if cell_m.is_none() {
                    "cell_m"
                } else if lowest_m.is_none() {
                    "lowest_m"
                } else {
                    "highest_m"
                };
                Err(refuse(
                    missing,
                    "not given".to_owned(),
                    "`cell_m`, `lowest_m` and `highest_m` for a picture",
                ))
            }
        }
    }
}

fn refuse(parameter: &str, found: String, expected: &str) -> Refusal {
    Refusal { parameter: parameter.to_owned(), found, expected: expected.to_owned() }
}

fn off_map(off: &OffMap, bounds: &Bounds) -> Refusal {
    let OffMap { along, at: Corner { east_m, north_m } } = off;
    let ([west, east], [south, north]) = (bounds.east_m, bounds.north_m);
    let inside = (west..=east).contains(east_m) && (south..=north).contains(north_m);
    let why = if inside { "where the map knows no height" } else { "off the map" };
    refuse(
        "path",
        format!("{along:.1} m after its start at {east_m:.1} m east, {north_m:.1} m north, {why}"),
        &format!(
            "a path where heights are known, within {west} to {east} m east and {south} to {north} m north"
        ),
    )
}

impl Terrain for Heightmap {
    fn at(&self, position_m: f64) -> Place {
        self.ground.as_ref().map_or_else(Place::default, |ground| ground.path.at(&ground.relief, position_m))
    }

    fn extent_m(&self) -> Option<(f64, f64)> {
        self.ground.as_ref().map(|ground| (0.0, ground.path.length_m()))
    }

    fn marks(&self) -> Vec<&str> {
        self.marks.names()
    }

    fn next_mark_m(&self, name: &str, position_m: f64) -> Option<f64> {
        self.marks.next_m(name, position_m)
    }

    fn surface(&self) -> Option<&dyn Surface> {
        self.ground.as_ref().map(|ground| &ground.relief as &dyn Surface)
    }
}

#[cfg(test)]
#[path = "heightmap_tests.rs"]
mod tests;
