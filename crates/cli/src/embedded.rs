//! Scenarios that the program brings along.

use crate::failure::Failure;
use crate::output::Output;
use std::path::PathBuf;

/// Files of a scenario, each with its path below the folder of scenarios; the first is the scenario.
pub type Files = [(&'static str, &'static str)];

/// Ten coast-downs of the Xerion 3800.
pub const COAST_DOWN_STUDY: [(&str, &str); 3] = [
    ("coast_down_study.ron", include_str!("../../../scenarios/coast_down_study.ron")),
    ("vehicles/xerion_3800.ron", include_str!("../../../scenarios/vehicles/xerion_3800.ron")),
    ("grounds/moist_sand.ron", include_str!("../../../scenarios/grounds/moist_sand.ron")),
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
