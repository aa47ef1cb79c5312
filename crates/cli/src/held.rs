//! A scenario held against a recording: read, driven, compared.

use crate::failure::{Failure, interrupted};
use crate::say::Say;
use headland_calibrate::study::{Measured, Study, drive_name};
use headland_compare::{RunComparison, Summary, compare_traces, summarise};
use headland_plugin::Registry;
use headland_recording::{Notice, Recording};
use headland_scenario::Scenario;
use headland_sim::Outcome;
use headland_trace::{Origin, Run, Trace};
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;

/// A run, measured and modelled.
#[derive(Debug)]
pub struct Pair {
    /// What was measured, with what follows from it; NaN where it is not compared.
    pub measured: Trace,
    /// What the model made of it.
    pub outcome: Outcome,
    /// What they have in common.
    pub comparison: RunComparison,
    /// Channels by which the model is judged.
    pub signals: Vec<String>,
    /// What drove the model.
    pub drive: &'static str,
    /// Samples that are not compared, because brakes may have acted that were not recorded.
    pub left_out: usize,
    /// Samples that are not compared, because something drove that was not recorded: the model follows the motion there.
    pub followed: usize,
    /// Samples that are not compared, because what the model is driven by lacks values for longer than can be bridged.
    pub unknown: usize,
    /// Whether the run is never fitted.
    pub held_out: bool,
}

/// Reads a recording, telling about it.
pub fn read_recording(path: &Path, say: Say) -> Result<Recording, Failure> {
    say.progress(&format!("reading {}", path.display()));
    let recording = headland_recording::load(path)?;
    let samples: usize = recording.runs.iter().map(|run| run.trace.len()).sum();
    say.progress(&format!("  {} runs, {samples} samples", recording.runs.len()));
    Ok(recording)
}

/// Brings a scenario and a recording together.
pub fn study<'a>(
    scenario: &'a Scenario,
    recording: &Recording,
    registry: &'a Registry,
) -> Result<Study<'a>, Failure> {
    let mut study = Study::new(scenario, recording, registry)
        .map_err(|error| at(Failure::from(error), &recording.path))?;
    study.stop = interrupted;
    Ok(study)
}

/// A failure with the file that it is about.
fn at(failure: Failure, path: &Path) -> Failure {
    match failure {
        Failure::Input(text) if !text.contains(".ron") => {
            Failure::Input(format!("{text}\n  {}", path.display()))
        }
        other => other,
    }
}

/// Drives the model with every run and compares, in parallel; the order is that of the recording.
pub fn drive(study: &Study, values: &[f64], what: &str, say: Say) -> Result<Vec<Pair>, Failure> {
    drive_each(study, values, what, say).into_iter().collect()
}

/// As [`drive`], and where the user interrupts, the runs that were finished.
pub fn drive_finished(study: &Study, values: &[f64], what: &str, say: Say) -> Result<Vec<Pair>, Failure> {
    finished(drive_each(study, values, what, say))
}

/// What was finished before an interruption; the interruption itself where nothing was.
pub fn finished<T>(all: Vec<Result<T, Failure>>) -> Result<Vec<T>, Failure> {
    let mut kept = Vec::new();
    for one in all {
        match one {
            Ok(one) => kept.push(one),
            Err(Failure::Interrupted) => {}
            Err(other) => return Err(other),
        }
    }
    if kept.is_empty() && interrupted() { Err(Failure::Interrupted) } else { Ok(kept) }
}

fn drive_each(study: &Study, values: &[f64], what: &str, say: Say) -> Vec<Result<Pair, Failure>> {
    let bar = say.bar(what, study.runs.len());
    let one = |run: &Measured| {
        let pair = pair(run, study.replay(run, values)?, study.straight);
        bar.inc(1);
        pair
    };
    let pairs = study.runs.par_iter().map(one).collect();
    bar.finish_and_clear();
    pairs
}

/// A run beside what the model made of it, along a path that is `straight` or not.
fn pair(run: &Measured, outcome: Outcome, straight: bool) -> Result<Pair, Failure> {
    let measured = masked(run, &outcome.trace)?;
    let mut comparison = compare_traces(&run.id, &measured, &outcome.trace)?;
    // A scenario without a map knows how far a run came, and not where.
    comparison.channels.retain(|one| !(straight && ["east_m", "north_m"].contains(&one.channel.as_str())));
    // A total counts every sample, braked or not: energy does not care who stopped the vehicle.
    comparison.totals = compare_traces(&run.id, &run.trace, &outcome.trace)?.totals;
    let follows = run.how.followed(&run.trace);
    let followed = follows.iter().filter(|followed| **followed).count();
    let is_followed = |sample: usize| follows.get(sample).copied().unwrap_or(false);
    let unknown =
        run.unknown.iter().enumerate().filter(|(sample, unknown)| **unknown && !is_followed(*sample));
    let unknown = unknown.count();
    Ok(Pair {
        // What is followed is not compared either, nor is what nobody knows the drive of.
        left_out: run.compared.iter().filter(|compared| !**compared).count() - followed - unknown,
        followed,
        unknown,
        signals: run.signals.clone(),
        drive: drive_name(run.how.drive),
        held_out: run.held_out,
        measured,
        outcome,
        comparison,
    })
}

/// The measured channels without the samples that are not compared: of all that the model answers with, and not of where it was.
fn masked(run: &Measured, modelled: &Trace) -> Result<Trace, Failure> {
    let answered = |name: &str| {
        let of_model = modelled.channels().iter().find(|channel| channel.name == name);
        name != "position_m" && of_model.is_some_and(|channel| channel.origin == Origin::Predicted)
    };
    let mut masked = Trace::new(run.trace.time_s().to_vec())?;
    for channel in run.trace.channels() {
        let mut values = channel.values.clone();
        if run.signals.contains(&channel.name) || answered(&channel.name) {
            for (value, compared) in values.iter_mut().zip(&run.compared) {
                if !compared {
                    *value = f64::NAN;
                }
            }
        }
        masked.push(channel.name.clone(), values, channel.origin)?;
    }
    Ok(masked)
}

/// All runs at a glance.
pub fn summary(pairs: &[Pair]) -> Summary {
    let runs: Vec<RunComparison> = pairs.iter().map(|pair| pair.comparison.clone()).collect();
    summarise(&runs)
}

/// The modelled runs, each with what was measured of it under `measured_…`.
pub fn traces(pairs: &[Pair]) -> Result<Vec<Run>, Failure> {
    let run = |pair: &Pair| {
        let mut trace = pair.outcome.trace.clone();
        for name in pair.signals.iter().map(String::as_str).chain(["speed_m_s"]) {
            let twin = format!("measured_{name}");
            if let Some(values) = pair.measured.get(name)
                && trace.channel(&twin).is_none()
            {
                trace.push(twin, values.to_vec(), Origin::Measured)?;
            }
        }
        Ok(Run { id: pair.comparison.run.clone(), trace })
    };
    pairs.iter().map(run).collect()
}

/// A notice as it stands in JSON.
#[derive(Clone, Debug, Serialize)]
pub struct ToldNotice {
    run: String,
    channel: Option<String>,
    kind: &'static str,
    text: String,
    count: usize,
    first_s: Option<f64>,
}

/// Notices as they stand in JSON.
pub fn told_notices(notices: &[Notice]) -> Vec<ToldNotice> {
    let told = |notice: &Notice| ToldNotice {
        run: notice.run.clone(),
        channel: notice.channel.clone(),
        kind: notice.kind.name(),
        text: notice.text.clone(),
        count: notice.count,
        first_s: notice.first_s,
    };
    notices.iter().map(told).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_sim::{Drive, Replay};

    /// Current and voltage are answers as much as the power that is made of them; what was told, and the place, stay whole.
    #[test]
    fn samples_that_are_not_compared_are_left_out_of_every_answer() {
        let trace = |voltage: Origin| {
            let mut trace = Trace::new(vec![0.0, 1.0, 2.0]).unwrap();
            for (name, origin) in [
                ("speed_m_s", Origin::Predicted),
                ("battery_voltage_v", voltage),
                ("position_m", Origin::Predicted),
                ("grade", Origin::Driven),
            ] {
                trace.push(name, vec![1.0, 2.0, 3.0], origin).unwrap();
            }
            trace
        };
        let run = Measured {
            id: "r1".to_owned(),
            trace: trace(Origin::Measured),
            how: Replay {
                drive: Drive::Torque,
                also: Vec::new(),
                window_s: None,
                smoothing_s: 1.0,
                step_s: 1.0,
                reversed_from_m: None,
                passes_before: 0,
                follows_brakes: true,
            },
            signals: vec!["speed_m_s".to_owned()],
            held_out: false,
            known: Vec::new(),
            compared: vec![true, false, true],
            unknown: Vec::new(),
        };
        let left = |name: &str, voltage: Origin| {
            let masked = masked(&run, &trace(voltage)).unwrap();
            masked.get(name).unwrap()[1].is_nan()
        };
        assert!(left("speed_m_s", Origin::Predicted) && left("battery_voltage_v", Origin::Predicted));
        assert!(!left("battery_voltage_v", Origin::Driven));
        assert!(!left("position_m", Origin::Predicted) && !left("grade", Origin::Predicted));
    }
}
