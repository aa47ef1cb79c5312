//! Simulated runs written as a recording: sampled, with the noise of a sensor.
//!
//! Noise of speed: GPS speed of 0.1 km/h resolution has a standard deviation of about 0.03 m/s.

use crate::failure::Failure;
use crate::output::Output;
use headland_calibrate::statistics::Draws;
use headland_scenario::Scenario;
use headland_sim::Outcome;
use headland_trace::Trace;
use std::fmt::Write;
use std::path::PathBuf;

/// Standard deviation of a sample of speed [m/s].
pub const NOISE_M_S: f64 = 0.03;
/// Time between samples [s].
const PERIOD_S: f64 = 0.1;
const FOLDER: &str = "recording";

/// Writes a log for each run and their description; gives the path of the description.
pub fn write(
    scenario: &Scenario,
    runs: &[(String, Outcome)],
    seed: u64,
    output: &mut Output,
) -> Result<PathBuf, Failure> {
    output.folder(FOLDER.as_ref())?;
    let number = |path: &str| scenario.document().number(path).unwrap_or(0.0);
    // Where the scenario knows of no wind, nobody measured one.
    let wind = scenario
        .document()
        .number("air.wind.speed_m_s")
        .map(|speed_m_s| (speed_m_s, number("air.wind.from_rad").to_degrees()));
    let measured = wind.map_or("", |_| {
        "        (column: \"wind [m/s]\", is: \"wind_speed_m_s\"),\n        \
         (column: \"wind from [deg]\", is: \"wind_direction_rad\"),\n"
    });
    let mut described = String::new();
    for (index, (id, outcome)) in runs.iter().enumerate() {
        let mut draws = Draws::new(seed, index as u64);
        output.text(&format!("{FOLDER}/{id}.csv"), &log(&outcome.trace, wind, &mut draws))?;
        let (from_s, to_s) = coasting(&outcome.trace);
        let heading = outcome.trace.get("heading_rad").and_then(|all| all.first()).copied().unwrap_or(0.0);
        let back = if heading.cos() < 0.0 { ", reversed: true" } else { "" };
        let _ = writeln!(
            described,
            "        (id: \"{id}\", file: \"{id}.csv\", path: \"lane\"{back}, segments: [(from_s: {from_s:?}, to_s: {to_s:?})]),"
        );
    }
    let known = ["mass_kg", "rotating_mass_kg", "drag_area_m2"].map(|name| {
        format!("        (name: \"{name}\", value: {:?}),\n", number(&format!("vehicle.{name}")))
    });
    let text = format!(
        "// Made from a simulation; seed {seed}.\n(\n    about: \"{}: logged with noise\",\n    runs: [\n{described}    ],\n    \
         format: csv(delimiter: \";\"),\n    channels: [\n        \
         (column: \"speed [km/h]\", is: \"speed_m_s\", sensor: (noise: {:?})),\n        \
         (column: \"heading [deg]\", is: \"heading_rad\"),\n{measured}    ],\n    known: [\n{}        \
         (name: \"air_density_kg_m3\", value: {:?}),\n    ],\n)\n",
        scenario.about,
        NOISE_M_S,
        known.concat(),
        number("air.density_kg_m3"),
    );
    output.text(&format!("{FOLDER}/recording.ron"), &text)
}

/// From when to when the vehicle rolls [s].
fn coasting(trace: &Trace) -> (f64, f64) {
    let coasting = trace.get("coasting").unwrap_or(&[]);
    let first = coasting.iter().position(|value| *value >= 0.5).unwrap_or(0);
    let time = |index: usize| trace.time_s().get(index).copied().unwrap_or(0.0);
    (time(first), trace.time_s().last().copied().unwrap_or(0.0))
}

/// One run; `wind` is its speed [m/s] and where it blows from [°].
fn log(trace: &Trace, wind: Option<(f64, f64)>, draws: &mut Draws) -> String {
    let columns = wind.map_or("", |_| "wind [m/s];wind from [deg];");
    let mut text = format!("time [s];speed [km/h];heading [deg];{columns}coasting\n");
    let blows = wind.map_or(String::new(), |(speed_m_s, from_deg)| format!("{speed_m_s:.1};{from_deg:.0};"));
    let (first, last) = (trace.time_s().first().copied().unwrap_or(0.0), trace.duration_s());
    let at = |name: &str, time_s: f64| trace.at(name, time_s).unwrap_or(f64::NAN);
    let mut sample = 0_u32;
    loop {
        let time_s = first + PERIOD_S * f64::from(sample);
        if time_s > first + last {
            return text;
        }
        // A receiver does not know the sign of a speed.
        let speed_km_h = (3.6 * (at("speed_m_s", time_s) + NOISE_M_S * draws.normal())).abs();
        let heading_deg = at("heading_rad", time_s).to_degrees();
        let coasting = u8::from(at("coasting", time_s) >= 0.5);
        let _ = writeln!(text, "{time_s:.1};{speed_km_h:.2};{heading_deg:.1};{blows}{coasting}");
        sample += 1;
    }
}
