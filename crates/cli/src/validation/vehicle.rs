//! A vehicle before and after calibration: what the car and the truck have in common.

use super::table::{change, percent, table};
use crate::command::calibrate::{fit, hold_out};
use crate::command::compare::notes;
use crate::failure::Failure;
use crate::fitted::{Calibration, errors};
use crate::held::{self, Pair};
use crate::page::short;
use crate::say::Say;
use headland_compare::Total;
use headland_plugin::Registry;
use headland_recording::Recording;
use headland_scenario::Scenario;
use std::fmt::Write;
use std::path::Path;

/// Everything that is told of a vehicle.
pub struct Told {
    /// The scenario.
    pub scenario: Scenario,
    /// The recording.
    pub recording: Recording,
    /// Every run before.
    pub before: Vec<Pair>,
    /// Every run after.
    pub after: Vec<Pair>,
    /// The calibration.
    pub calibration: Calibration,
}

/// Fits a scenario to a recording.
pub fn calibrated(registry: &Registry, scenario: &Path, recording: &Path, say: Say) -> Result<Told, Failure> {
    let files = crate::arguments::HeldOptions {
        scenario: scenario.to_owned(),
        recording: recording.to_owned(),
        out: None,
    };
    let scenario = Scenario::read(scenario, registry)?;
    let recording = held::read_recording(recording, say)?;
    let (before, after, calibration) = {
        let mut study = held::study(&scenario, &recording, registry)?;
        hold_out(&mut study);
        let fit = fit(&study, say)?;
        let before = held::drive(&study, &study.start(), "replaying before", say)?;
        let after = held::drive(&study, &fit.values(), "replaying after", say)?;
        let mut calibration = Calibration::new(&files, &study, &fit, &before, &after);
        calibration.notes = notes(&study.notes, &after);
        (before, after, calibration)
    };
    Ok(Told { scenario, recording, before, after, calibration })
}

/// One more column of a table of runs: its name and its cells.
pub type More<'a> = (&'a str, &'a dyn Fn(&Pair) -> String);

impl Told {
    /// The fitted value of a parameter, by the end of its path.
    pub fn value(&self, name: &str) -> f64 {
        let found = self.calibration.estimates.iter().find(|estimate| estimate.name == name);
        found.map_or(f64::NAN, |estimate| estimate.value)
    }

    /// Parameters before and after.
    pub fn parameters(&self) -> String {
        let row = |estimate: &crate::fitted::Estimate| {
            let interval = if estimate.at_bound {
                "at its bound".to_owned()
            } else {
                format!("{} to {}", short(estimate.ci95[0]), short(estimate.ci95[1]))
            };
            let unit = if estimate.unit == "1" { "" } else { &estimate.unit };
            vec![
                format!("`{}` {unit}", estimate.name),
                short(estimate.prior),
                short(estimate.value),
                interval,
            ]
        };
        let rows: Vec<Vec<String>> = self.calibration.estimates.iter().map(row).collect();
        let mut text = table(&["free parameter", "before", "after", "95 % interval"], &rows);
        let bound: Vec<String> = self
            .calibration
            .estimates
            .iter()
            .filter(|estimate| estimate.at_bound)
            .map(|estimate| format!("`{}`", estimate.name))
            .collect();
        if !bound.is_empty() {
            let _ = writeln!(
                text,
                "\nAt its bound: {}. That is no value of the vehicle: the fit would go further, to what no such vehicle has, because the \
                 parameter makes up for what the log or the model lacks.",
                bound.join(", ")
            );
        }
        text
    }

    /// Error of each signal over all runs.
    pub fn signals(&self) -> String {
        let mut rows = Vec::new();
        for signal in &self.calibration.signals {
            for (what, part) in [("fitted", &signal.fitted), ("held out", &signal.held_out)] {
                if !part.runs.is_empty() {
                    let gain = percent(Some(part.rmse_after / part.rmse_before - 1.0));
                    rows.push(vec![
                        format!("`{}` {}", signal.channel, signal.unit),
                        format!("{} {what}", part.runs.len()),
                        short(part.rmse_before),
                        short(part.rmse_after),
                        gain,
                    ]);
                }
            }
        }
        table(&["signal", "runs", "RMSE before", "RMSE after", "change %"], &rows)
    }

    /// One row a run: the RMSE of each signal and the error of a total.
    pub fn runs(&self, of: &str, more: &[More]) -> String {
        let signals: Vec<&str> =
            self.calibration.signals.iter().map(|signal| signal.channel.as_str()).collect();
        let unit = |signal: &crate::fitted::Signal| format!("RMSE `{}` {}", signal.channel, signal.unit);
        let mut columns = vec!["run".to_owned()];
        columns.extend(self.calibration.signals.iter().map(unit));
        columns.extend([format!("total of `{of}`, % before → after"), "within 5 %".to_owned()]);
        columns.extend(more.iter().map(|(name, _)| (*name).to_owned()));
        let rows: Vec<Vec<String>> = self
            .before
            .iter()
            .zip(&self.after)
            .map(|(before, after)| {
                let mark = if before.held_out { " (held out)" } else { "" };
                let mut row = vec![format!("{}{mark}", before.comparison.run)];
                for signal in &signals {
                    let rmse = |pair| errors(pair, signal).map_or(f64::NAN, |(rmse, ..)| rmse);
                    row.push(change(rmse(before), rmse(after)));
                }
                let total = |pair: &Pair| pair.comparison.total(of).and_then(|total| total.relative_error);
                row.push(format!("{} → {}", percent(total(before)), percent(total(after))));
                let passed = after.comparison.total(of).and_then(|total| total.within_criterion);
                row.push(passed.map_or("–", |passed| if passed { "yes" } else { "no" }).to_owned());
                row.extend(more.iter().map(|(_, cell)| cell(after)));
                row
            })
            .collect();
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        table(&columns, &rows)
    }

    /// How many runs have their total within 5 %, and the total of all.
    pub fn totals(&self, of: &str) -> String {
        let passed = |pairs: &[Pair]| {
            let all: Vec<&Total> = pairs.iter().filter_map(|pair| pair.comparison.total(of)).collect();
            let defined = all.iter().filter(|total| total.within_criterion.is_some()).count();
            let within = all.iter().filter(|total| total.within_criterion == Some(true)).count();
            let sum = |value: fn(&Total) -> f64| all.iter().map(|total| value(total)).sum::<f64>();
            let error = sum(|total| total.modelled) / sum(|total| total.measured) - 1.0;
            (within, defined, error)
        };
        let ((before, defined, error_before), (after, _, error_after)) =
            (passed(&self.before), passed(&self.after));
        format!(
            "Total of `{of}`: {before} of {defined} runs within 5 % before, {after} after; over all runs {} % before, {} % \
             after.\n",
            percent(Some(error_before)),
            percent(Some(error_after))
        )
    }

    /// What was decided, and what the recording says of itself.
    pub fn remarks(&self) -> String {
        let mut text = String::new();
        for note in self.calibration.notes.iter().chain(&self.calibration.null_space) {
            let _ = writeln!(text, "- {note}");
        }
        for notice in self.recording.notices.iter().filter(|notice| notice.run.is_empty()) {
            let _ = writeln!(text, "- {}", notice.text);
        }
        text
    }
}
