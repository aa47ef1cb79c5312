//! `docs/validation.md`, made from the recordings: no figure in it is typed in.

mod beside;
mod buggy;
mod car;
mod drive;
mod fuelled;
mod study;
mod table;
mod tractor;
mod vehicle;

use crate::failure::Failure;
use crate::say::Say;
use headland_plugin::Registry;
use std::path::{Path, PathBuf};

/// The whole page; `scenarios` is the folder of the scenarios, `recordings` below it that of the descriptions. Pages `beside`
/// stand at its end, which is to be the file `out`.
pub fn page(
    registry: &Registry,
    scenarios: &Path,
    (beside, out): (&[PathBuf], &Path),
    seed: u64,
    say: Say,
) -> Result<String, Failure> {
    // First what takes no time to refuse.
    let beside = beside.iter().map(|page| beside::part(page, out)).collect::<Result<Vec<_>, _>>()?;
    let mut parts = vec![
        car::part(registry, scenarios, say)?,
        fuelled::truck(registry, scenarios, say)?,
        fuelled::camry(registry, scenarios, say)?,
        tractor::part(scenarios, say)?,
        study::part(registry, scenarios, seed, say)?,
        drive::part(registry, scenarios)?,
        buggy::part(scenarios, seed, say)?,
    ];
    parts.extend(beside);
    Ok(format!("{}\n{}", INTRODUCTION, parts.join("\n")))
}

const INTRODUCTION: &str = "# Validation\n\n\
Made by `headland validate` from recordings that other people published (`HEADLAND_RECORDINGS` names their folder); every \
figure below was computed by that command. *Before* is the scenario as it stands, from general knowledge of the vehicle; \
*after* is the same scenario with its free parameters fitted by least squares, priors included. Runs marked *held out* were \
never fitted. Errors are modelled minus measured. A total passes where it is within 5 %.\n";
