//! `headland terrain`: the ground of a scenario and the path over it, in numbers and as a picture.

use crate::arguments::TerrainOptions;
use crate::failure::Failure;
use crate::say::Say;
use headland_plugin::{Bounds, Place, Registry, Surface, Terrain};
use headland_report::{Ground, Relief, quantity};
use headland_scenario::Scenario;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// What is told.
#[derive(Debug, Serialize)]
struct Told {
    schema: &'static str,
    about: String,
    /// Where the path begins and ends [m]; none where it never ends.
    extent_m: Option<(f64, f64)>,
    /// What the map of heights covers [m]; none where it never ends or is not known beside the path.
    east_m: Option<[f64; 2]>,
    north_m: Option<[f64; 2]>,
    lowest_m: f64,
    highest_m: f64,
    climbed_m: f64,
    steepest_up: f64,
    steepest_down: f64,
    tightest_radius_m: Option<f64>,
    marks: Vec<Mark>,
}

/// A mark of the path.
#[derive(Debug, Serialize)]
struct Mark {
    name: String,
    position_m: f64,
}

/// Where a path never ends, so much of it is looked at [m].
const ENDLESS_M: f64 = 500.0;
/// Places along the path at which it is looked at.
const PLACES: u32 = 4000;
/// Samples of the ground along the longer side of the picture.
const SAMPLES: u32 = 160;
/// Most marks of one name; more are a mistake of the terrain and not to be listed.
const MOST_MARKS: usize = 100_000;

/// Runs the command.
pub fn terrain(registry: &Registry, options: &TerrainOptions, say: Say) -> Result<(), Failure> {
    if let Some(path) = &options.picture
        && path.extension().is_none_or(|end| !end.eq_ignore_ascii_case("svg"))
    {
        return Err(Failure::Input(format!("--picture {} does not end in .svg", path.display())));
    }
    let scenario = Scenario::read(&options.scenario, registry)?;
    let model = scenario.model(registry)?;
    let (from_m, to_m) = model.terrain.extent_m().unwrap_or((0.0, ENDLESS_M));
    let positions: Vec<f64> =
        (0..=PLACES).map(|i| from_m + (to_m - from_m) * f64::from(i) / f64::from(PLACES)).collect();
    let places: Vec<Place> = positions.iter().map(|position_m| model.terrain.at(*position_m)).collect();
    let told = told(&scenario.about, &*model.terrain, &places);
    if let Some(path) = &options.picture {
        let relief = Relief {
            title: scenario.about.clone(),
            ground: model.terrain.surface().map(|surface| sampled(surface, &places)),
            path_m: places.iter().map(|place| [place.east_m, place.north_m]).collect(),
            profile_m: positions.iter().zip(&places).map(|(at, place)| [*at, place.elevation_m]).collect(),
            marks: (told.marks.iter())
                .map(|mark| {
                    let place = model.terrain.at(mark.position_m);
                    (mark.name.clone(), [place.east_m, place.north_m])
                })
                .collect(),
        };
        write(path, &relief.svg())?;
    }
    say.result(&in_words(&told, options.picture.as_deref()), &told)
}

fn write(path: &Path, svg: &str) -> Result<(), Failure> {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|error| Failure::unwritable(folder, &error))?;
    }
    std::fs::write(path, svg).map_err(|error| Failure::unwritable(path, &error))
}

fn told(about: &str, terrain: &dyn Terrain, places: &[Place]) -> Told {
    let ends = |value: fn(&Place) -> f64| {
        places
            .iter()
            .map(value)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
    };
    let (lowest_m, highest_m) = ends(|place| place.elevation_m);
    let (steepest_down, steepest_up) = ends(Place::grade);
    let (_, bend) = ends(|place| place.curvature_per_m.abs());
    let climbed_m =
        places.array_windows().map(|[one, two]| (two.elevation_m - one.elevation_m).max(0.0)).sum();
    let bounds = terrain.surface().and_then(Surface::bounds);
    Told {
        schema: "headland.terrain/1",
        about: about.to_owned(),
        extent_m: terrain.extent_m(),
        east_m: bounds.map(|bounds| bounds.east_m),
        north_m: bounds.map(|bounds| bounds.north_m),
        lowest_m,
        highest_m,
        climbed_m,
        steepest_up,
        steepest_down,
        tightest_radius_m: (bend > 0.0).then(|| 1.0 / bend),
        marks: marks(terrain),
    }
}

/// Every mark, in the order of the path.
fn marks(terrain: &dyn Terrain) -> Vec<Mark> {
    let begin = terrain.extent_m().map_or(0.0, |(from_m, _)| from_m);
    let mut all = Vec::new();
    for name in terrain.marks() {
        // A mark at the very beginning is one too.
        let mut after_m = begin - 1.0;
        for _ in 0..MOST_MARKS {
            let Some(position_m) = terrain.next_mark_m(name, after_m) else { break };
            all.push(Mark { name: name.to_owned(), position_m });
            after_m = position_m;
        }
    }
    all.sort_by(|one, two| one.position_m.total_cmp(&two.position_m));
    all
}

/// Heights over the map, or over the path and a margin where the map never ends.
fn sampled(surface: &dyn Surface, places: &[Place]) -> Ground {
    let around = |value: fn(&Place) -> f64, margin: f64| {
        let low = places.iter().map(value).fold(f64::INFINITY, f64::min);
        let high = places.iter().map(value).fold(f64::NEG_INFINITY, f64::max);
        [low - margin, high + margin]
    };
    let Bounds { east_m, north_m } = surface.bounds().unwrap_or_else(|| {
        let (east, north) = (around(|place| place.east_m, 0.0), around(|place| place.north_m, 0.0));
        let margin = 0.06 * (east[1] - east[0]).max(north[1] - north[0]).max(1.0);
        Bounds {
            east_m: around(|place| place.east_m, margin),
            north_m: around(|place| place.north_m, margin),
        }
    });
    let (wide, high) = (east_m[1] - east_m[0], north_m[1] - north_m[0]);
    let cell = wide.max(high) / f64::from(SAMPLES);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most as many as samples")]
    let count = |side: f64| (side / cell).round().max(1.0) as u32;
    let (columns, rows) = (count(wide), count(high));
    let heights_m = (0..=rows)
        .flat_map(|row| (0..=columns).map(move |column| (column, row)))
        .map(|(column, row)| {
            let east = east_m[0] + wide * f64::from(column) / f64::from(columns);
            let north = north_m[0] + high * f64::from(row) / f64::from(rows);
            surface.spot(east, north).map_or(f64::NAN, |spot| spot.height_m)
        })
        .collect();
    Ground {
        corner_m: [east_m[0], north_m[0]],
        cell_m: [wide / f64::from(columns), high / f64::from(rows)],
        columns: columns as usize + 1,
        heights_m,
    }
}

/// Heights below this are rounding [m].
const ROUNDING_M: f64 = 1e-6;

/// A height for people.
fn height(height_m: f64) -> String {
    quantity(if height_m.abs() < ROUNDING_M { 0.0 } else { height_m }, "m")
}

fn in_words(told: &Told, picture: Option<&Path>) -> String {
    let mut text = format!("{}\n", told.about);
    let _ = match told.extent_m {
        Some((from_m, to_m)) => writeln!(text, "  path     {}", quantity(to_m - from_m, "m")),
        None => writeln!(text, "  path     without an end; its first {} are told", quantity(ENDLESS_M, "m")),
    };
    if let (Some([west, east]), Some([south, north])) = (told.east_m, told.north_m) {
        let _ = writeln!(text, "  map      {west} to {east} m east, {south} to {north} m north");
    }
    let _ = writeln!(
        text,
        "  height   {} to {}, {} climbed",
        height(told.lowest_m),
        height(told.highest_m),
        height(told.climbed_m)
    );
    let _ = writeln!(
        text,
        "  grade    at most {:.1} % up, {:.1} % down",
        100.0 * told.steepest_up.max(0.0),
        100.0 * (0.0 - told.steepest_down).max(0.0)
    );
    if let Some(radius_m) = told.tightest_radius_m {
        let _ = writeln!(text, "  bends    down to {}", quantity(radius_m, "m"));
    }
    let mut names: Vec<(&str, usize)> = Vec::new();
    for mark in &told.marks {
        match names.iter_mut().find(|(name, _)| *name == mark.name) {
            Some((_, count)) => *count += 1,
            None => names.push((&mark.name, 1)),
        }
    }
    if !names.is_empty() {
        let listed: Vec<String> = names
            .iter()
            .map(|(name, count)| if *count == 1 { (*name).to_owned() } else { format!("{name} × {count}") })
            .collect();
        let _ = writeln!(text, "  marks    {}", listed.join(", "));
    }
    if let Some(picture) = picture {
        let _ = writeln!(text, "  written  {}", picture.display());
    }
    text
}
