//! Scenarios that the program brings along.

use crate::failure::Failure;
use crate::output::Output;
use std::path::PathBuf;

/// Files of a scenario, each with its path below the folder of scenarios; the first is the scenario.
pub type Files = [(&'static str, &'static str)];

const XERION: (&str, &str) =
    ("vehicles/xerion_3800.ron", include_str!("../../../scenarios/vehicles/xerion_3800.ron"));
const MOIST_SAND: (&str, &str) =
    ("grounds/moist_sand.ron", include_str!("../../../scenarios/grounds/moist_sand.ron"));
const TEN_COAST_DOWNS: (&str, &str) =
    ("runs/ten_coast_downs.ron", include_str!("../../../scenarios/runs/ten_coast_downs.ron"));

/// Ten coast-downs of the Xerion 3800.
pub const COAST_DOWN_STUDY: [(&str, &str); 4] = [
    ("coast_down_study.ron", include_str!("../../../scenarios/coast_down_study.ron")),
    XERION,
    MOIST_SAND,
    TEN_COAST_DOWNS,
];

/// The same in a wind that blows along the lane as well.
pub const COAST_DOWN_IN_WIND: [(&str, &str); 4] = [
    ("coast_down_in_wind.ron", include_str!("../../../scenarios/coast_down_in_wind.ron")),
    XERION,
    MOIST_SAND,
    TEN_COAST_DOWNS,
];

/// The same by someone who knows nothing of the wind.
pub const COAST_DOWN_CALM: [(&str, &str); 3] = [
    ("coast_down_calm.ron", include_str!("../../../scenarios/coast_down_calm.ron")),
    XERION,
    TEN_COAST_DOWNS,
];

/// Three drivelines of the Xerion 3800 at work.
pub const THREE_DRIVELINES: [(&str, &str); 13] = [
    ("comparisons/three_drivelines.ron", include_str!("../../../scenarios/comparisons/three_drivelines.ron")),
    ("comparisons/cycles/ploughing.ron", include_str!("../../../scenarios/comparisons/cycles/ploughing.ron")),
    ("comparisons/cycles/transport.ron", include_str!("../../../scenarios/comparisons/cycles/transport.ron")),
    ("comparisons/cycles/mixed_day.ron", include_str!("../../../scenarios/comparisons/cycles/mixed_day.ron")),
    ("vehicles/xerion_3800_cvt.ron", include_str!("../../../scenarios/vehicles/xerion_3800_cvt.ron")),
    (
        "vehicles/xerion_3800_parallel.ron",
        include_str!("../../../scenarios/vehicles/xerion_3800_parallel.ron"),
    ),
    ("vehicles/xerion_3800_series.ron", include_str!("../../../scenarios/vehicles/xerion_3800_series.ron")),
    ("parts/engine_254_kw.ron", include_str!("../../../scenarios/parts/engine_254_kw.ron")),
    ("parts/transmission_50_km_h.ron", include_str!("../../../scenarios/parts/transmission_50_km_h.ron")),
    ("parts/motor_100_kw.ron", include_str!("../../../scenarios/parts/motor_100_kw.ron")),
    ("parts/motor_250_kw.ron", include_str!("../../../scenarios/parts/motor_250_kw.ron")),
    ("parts/battery_18_kwh.ron", include_str!("../../../scenarios/parts/battery_18_kwh.ron")),
    ("parts/battery_58_kwh.ron", include_str!("../../../scenarios/parts/battery_58_kwh.ron")),
];

/// Writes the files into `scenarios`; gives the path of the first.
pub fn write(files: &Files, output: &mut Output) -> Result<PathBuf, Failure> {
    let mut first = None;
    for (name, text) in files {
        let path = PathBuf::from("scenarios").join(name);
        if let Some(folder) = path.parent() {
            output.folder(folder)?;
        }
        let written = output.text(&path.to_string_lossy(), text)?;
        first.get_or_insert(written);
    }
    first.ok_or_else(|| Failure::Machine("an example without files".to_owned()))
}
