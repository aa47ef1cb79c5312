//! `headland cvt-map`: the map of a `MappedCvt` from a recording.

use crate::arguments::CvtMapOptions;
use crate::failure::Failure;
use crate::held::read_recording;
use crate::output::write_whole;
use crate::page::short;
use crate::say::Say;
use headland_calibrate::cvt_map::{CvtMap, Misfit, Sample, cvt_map};
use headland_recording::{RecordedRun, Recording};
use serde::Serialize;
use std::fmt::Write;

/// What is told.
#[derive(Debug, Serialize)]
struct Told {
    schema: &'static str,
    recording: String,
    speed: &'static str,
    force: String,
    speeds_m_s: Vec<f64>,
    forces_n: Vec<f64>,
    engine_speeds_rad_s: Vec<Vec<Option<f64>>>,
    samples_near: Vec<Vec<usize>>,
    covered_share: f64,
    fitted: Fit,
    held_out: Option<Fit>,
    /// Minutes that were left out by turns, where no run is held out.
    checked: Option<Fit>,
}

/// How far the map is from some samples.
#[derive(Debug, Serialize)]
struct Fit {
    samples: usize,
    known_share: f64,
    rmse_rad_s: f64,
}

impl From<Misfit> for Fit {
    fn from(misfit: Misfit) -> Self {
        Self {
            samples: misfit.samples,
            known_share: misfit.known as f64 / misfit.samples as f64,
            rmse_rad_s: misfit.rmse_rad_s,
        }
    }
}

/// Every other of these is left out of the map that is checked [s].
const BLOCK_S: f64 = 60.0;
/// J1939: torques as shares of a reference torque, friction included in the first.
const TORQUE_SHARES: [&str; 2] = ["actual_torque", "friction_torque"];

/// Runs the command.
pub fn run(options: &CvtMapOptions, say: Say) -> Result<(), Failure> {
    if !(options.efficiency > 0.0 && options.efficiency <= 1.0) {
        let found = options.efficiency;
        return Err(Failure::Input(format!("--efficiency is {found}, expected more than 0 and at most 1")));
    }
    let recording = read_recording(&options.recording, say)?;
    let speed = channel_of(&recording, &["wheel_speed_m_s", "speed_m_s"])?;
    channel_of(&recording, &["engine_speed_rad_s"])?;
    let force = Force::of(&recording, options)?;
    let (mut fitted, mut held_out, mut halves) = (Vec::new(), Vec::new(), [Vec::new(), Vec::new()]);
    for run in &recording.runs {
        for (time_s, sample) in samples(run, speed, &force, options) {
            if run.held_out {
                held_out.push(sample);
            } else {
                fitted.push(sample);
                let odd = (time_s / BLOCK_S).floor().rem_euclid(2.0) == 1.0;
                halves[usize::from(odd)].push(sample);
            }
        }
    }
    let make = |samples: &[Sample]| {
        cvt_map(samples, (options.speeds, options.forces), options.least_samples).map_err(|error| {
            Failure::Input(format!("{}: no map can be made of {error}", options.recording.display()))
        })
    };
    let map = make(&fitted)?;
    if map.covered_share() == 0.0 {
        return Err(Failure::Input(format!(
            "{}: no node of the grid has {} samples near it; ask for fewer nodes or fewer samples",
            options.recording.display(),
            options.least_samples
        )));
    }
    let checked = if held_out.is_empty() {
        make(&halves[0]).ok().map(|map| Fit::from(map.misfit(&halves[1])))
    } else {
        None
    };
    let told = Told {
        schema: "headland.cvt_map/1",
        recording: recording.about.clone(),
        speed,
        force: force.in_words(options),
        covered_share: map.covered_share(),
        fitted: map.misfit(&fitted).into(),
        held_out: (!held_out.is_empty()).then(|| map.misfit(&held_out).into()),
        checked,
        samples_near: map.samples.clone(),
        engine_speeds_rad_s: map.engine_rad_s.clone(),
        speeds_m_s: map.speeds_m_s.clone(),
        forces_n: map.forces_n.clone(),
    };
    let path = &options.out;
    write_whole(path, &ron(&map, &told))?;
    say.result(&in_words(&told, &map, options), &told)
}

/// The first of these channels that every run has.
fn channel_of(recording: &Recording, names: &[&'static str]) -> Result<&'static str, Failure> {
    let has = |name: &&&str| recording.runs.iter().all(|run| run.trace.get(name).is_some());
    names.iter().find(has).copied().ok_or_else(|| {
        Failure::Input(format!(
            "{}: a map needs the channel `{}` in every run",
            recording.path.display(),
            names.join("` or `")
        ))
    })
}

/// Where the force at the wheels comes from.
enum Force {
    Measured,
    Torque,
    /// Shares of a reference torque [N m].
    Shares(f64),
}

impl Force {
    fn of(recording: &Recording, options: &CvtMapOptions) -> Result<Self, Failure> {
        if let Some(reference) = options.reference_torque {
            if !(reference.is_finite() && reference > 0.0) {
                return Err(Failure::Input(format!(
                    "--reference-torque is {reference}, expected more than 0"
                )));
            }
            for name in TORQUE_SHARES {
                channel_of(recording, &[name])?;
            }
            return Ok(Self::Shares(reference));
        }
        match channel_of(recording, &["tractive_force_n", "engine_torque_n_m"]) {
            Ok("tractive_force_n") => Ok(Self::Measured),
            Ok(_) => Ok(Self::Torque),
            Err(failure) => Err(Failure::Input(format!(
                "{failure}, or `{}` with --reference-torque",
                TORQUE_SHARES.join("` and `")
            ))),
        }
    }

    fn in_words(&self, options: &CvtMapOptions) -> String {
        let lost =
            format!("an efficiency of {} and {} N m without load", options.efficiency, options.idle_torque);
        match self {
            Self::Measured => "`tractive_force_n`".to_owned(),
            Self::Torque => format!("`engine_torque_n_m` by {lost}"),
            Self::Shares(reference) => {
                format!("`{}` less `{}`, of {reference} N m, by {lost}", TORQUE_SHARES[0], TORQUE_SHARES[1])
            }
        }
    }
}

/// Instants of a run that drive: in motion, with everything there.
fn samples(run: &RecordedRun, speed: &str, force: &Force, options: &CvtMapOptions) -> Vec<(f64, Sample)> {
    let column = |name: &str| run.trace.get(name).unwrap_or(&[]);
    let (speeds, engines) = (column(speed), column("engine_speed_rad_s"));
    // What goes into the transmission comes out by its losses, as `MappedCvt` has them.
    let through = |torque: f64, at: usize| {
        let power = (torque - options.idle_torque) * engines[at];
        let eta = if power > 0.0 { options.efficiency } else { 1.0 / options.efficiency };
        power * eta / speeds[at]
    };
    (0..run.trace.len())
        .filter_map(|at| {
            let force_n = match force {
                Force::Measured => column("tractive_force_n")[at],
                Force::Torque => through(column("engine_torque_n_m")[at], at),
                Force::Shares(reference) => {
                    let share = column(TORQUE_SHARES[0])[at] - column(TORQUE_SHARES[1])[at];
                    through(share * reference, at)
                }
            };
            let sample = Sample { speed_m_s: speeds[at], force_n, engine_rad_s: engines[at] };
            let drives =
                sample.speed_m_s >= options.lowest_speed && sample.engine_rad_s > 0.0 && force_n.is_finite();
            drives.then(|| (run.trace.time_s()[at], sample))
        })
        .collect()
}

/// The map as scenarios include it.
fn ron(map: &CvtMap, told: &Told) -> String {
    let list = |values: &[f64], digits: usize| {
        values.iter().map(|value| format!("{value:.digits$}")).collect::<Vec<_>>().join(", ")
    };
    let mut text = format!(
        "// Engine speeds of a transmission, made by `headland cvt-map` from: {}.\n// Forces from {}.\n\
         // 0 stands where nothing was seen.\n(\n",
        told.recording, told.force
    );
    let _ = writeln!(text, "    speeds_m_s: [{}],", list(&map.speeds_m_s, 3));
    let _ = writeln!(text, "    forces_n: [{}],", list(&map.forces_n, 0));
    let _ = writeln!(text, "    engine_speeds_rad_s: [");
    for row in &map.engine_rad_s {
        let row: Vec<f64> = row.iter().map(|node| node.unwrap_or(0.0)).collect();
        let _ = writeln!(text, "        [{}],", list(&row, 2));
    }
    let _ = writeln!(text, "    ],\n    covered_share: {:.3},\n)", told.covered_share);
    text
}

fn in_words(told: &Told, map: &CvtMap, options: &CvtMapOptions) -> String {
    let fit = |fit: &Fit| {
        format!(
            "{} samples, {:.1} % of them on the map, error {} rad/s ({} rpm)",
            fit.samples,
            100.0 * fit.known_share,
            short(fit.rmse_rad_s),
            short(fit.rmse_rad_s * 60.0 / std::f64::consts::TAU)
        )
    };
    let mut text = format!("{}\n  speed     `{}`\n  force     {}\n", told.recording, told.speed, told.force);
    let _ = writeln!(
        text,
        "  nodes     {:.1} % of {} speeds by {} forces have {} samples or more near them",
        100.0 * told.covered_share,
        options.speeds,
        options.forces,
        options.least_samples
    );
    let _ = writeln!(text, "  fitted    {}", fit(&told.fitted));
    match (&told.held_out, &told.checked) {
        (Some(held_out), _) => drop(writeln!(text, "  held out  {}", fit(held_out))),
        (None, Some(checked)) => {
            let _ = writeln!(text, "  checked   a map of every other minute on the others: {}", fit(checked));
        }
        (None, None) => {}
    }
    text.push_str("  seen      m/s down, kN across; ● enough, · none or too few\n");
    let _ = write!(text, "            {:>8}", "");
    for force in &map.forces_n {
        let _ = write!(text, "{:>7.1}", force / 1e3);
    }
    text.push('\n');
    for (speed, row) in map.speeds_m_s.iter().zip(&map.engine_rad_s) {
        let cells: String =
            row.iter().map(|node| if node.is_some() { "      ●" } else { "      ·" }).collect();
        let _ = writeln!(text, "            {speed:>8.2}{cells}");
    }
    let _ = writeln!(text, "  written   {}", options.out.display());
    text
}
