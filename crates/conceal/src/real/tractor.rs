//! Tractor at field work: slip, from passes whose speed over ground is given, in passes where it is withheld.

use super::pose::{diagnose, write};
use super::signal::{median, onto, short};
use super::table::Table;
use super::{Figure, Options, Row};
use crate::error::ConcealError;
use std::fmt::Write;
use std::ops::Range;

const SET: &str = "tractor_t7165";

/// A pass, as rows of the log.
struct Pass {
    name: String,
    rows: Range<usize>,
    calibration: bool,
}

pub fn rows(options: &Options) -> Result<Vec<Row>, ConcealError> {
    let folder = options.recordings.join(SET);
    let given = folder.join("given/first_half.csv.gz");
    let log = Table::read(&given)?;
    let wheel_m_s: Vec<f64> =
        log.need(&given, "CAN1.CCVS1.WheelBasedVehicleSpeed")?.iter().map(|speed| speed / 3.6).collect();
    let heading = log.need(&given, "CAN2.gnss_attitude.Heading")?;
    let torque = log.need(&given, "CAN1.EEC1.ActualEnginePercentTorque")?;
    let engine = log.need(&given, "CAN1.EEC1.EngineSpeed")?;
    let passes = passes(&wheel_m_s, &heading);
    // Calibration passes are given with their speed over ground, the one channel of `truth/` that is handed over.
    let path = folder.join("truth/first_half.csv.gz");
    let ground_m_s = Table::read(&path)?.need(&path, "CAN2.gnss_speed.Speed")?;
    let mut runs = String::new();
    let mut calibration_runs = String::new();
    for pass in &passes {
        let over_ground = if pass.calibration { ",speed_m_s" } else { "" };
        let mut text = format!("time_s,wheel_speed_m_s,engine_speed_rad_s,engine_torque_n_m{over_ground}\n");
        for row in pass.rows.clone() {
            // Rated torque: 140 kW at 2200 rpm and its rise, SAE J1939 reference torque unknown.
            let (speed, moment) = (engine[row] * std::f64::consts::TAU / 60.0, 7.3 * torque[row]);
            let _ = write!(text, "{},{:.4},{speed:.3},{moment:.1}", row - pass.rows.start, wheel_m_s[row]);
            let _ = if pass.calibration { writeln!(text, ",{:.4}", ground_m_s[row]) } else { writeln!(text) };
        }
        let file = format!("{}.csv", pass.name);
        write(options, SET, &file, &text)?;
        let line = format!("(id: {:?}, file: {file:?}),\n", pass.name);
        runs.push_str(&line);
        if pass.calibration {
            calibration_runs.push_str(&line);
        }
    }
    let scenario = write(options, SET, "scenario.ron", include_str!("poses/tractor.ron"))?;
    let told = |runs: &str| format!("(about: \"passes of a tractor at field work\", runs: [{runs}])");
    let recording = write(options, SET, "recording.ron", &told(&runs))?;
    let mut said = diagnose(options, SET, &scenario, &recording, &[])?;
    let refused = said.diagnosis.is_none().then(|| said.answer.clone());
    if refused.is_some() {
        let recording = write(options, SET, "recording.ron", &told(&calibration_runs))?;
        said = diagnose(options, SET, &scenario, &recording, &[])?;
    }
    let mut row = said
        .row(SET, "wheel slip: speed over ground is given for every second pass and withheld in the others");
    let named = said.found_or_first("wheel_slip");
    row.figures.push(Figure::goal(
        "wheel slip is named",
        if named { "yes" } else { "no" }.to_owned(),
        "yes",
        named,
    ));
    let (mut errors, mut ratios) = (Vec::new(), Vec::new());
    for pass in passes.iter().filter(|pass| !pass.calibration) {
        let rows: Vec<usize> = pass.rows.clone().filter(|row| wheel_m_s[*row] > 0.5).collect();
        let ratio = median(&rows.iter().map(|row| ground_m_s[*row] / wheel_m_s[*row]).collect::<Vec<f64>>());
        ratios.push(ratio);
        if let Some((time_s, slip)) = said.series(&pass.name, &["wheel_slip_m_s"]) {
            let times: Vec<f64> = rows.iter().map(|row| (row - pass.rows.start) as f64).collect();
            let slip = onto(&time_s, &slip, &times);
            let told: Vec<f64> =
                rows.iter().zip(&slip).map(|(row, slip)| 1.0 - slip.abs() / wheel_m_s[*row]).collect();
            errors.push(median(&told) - ratio);
        }
    }
    row.figures.push(Figure::told(
        "measured: median ratio of ground to wheel speed, withheld passes",
        short(median(&ratios)),
    ));
    let error = median(&errors.iter().map(|error| error.abs()).collect::<Vec<f64>>());
    row.figures.push(Figure::goal(
        &format!("median error of the ratio in {} withheld passes", ratios.len()),
        if errors.is_empty() { "not told".to_owned() } else { short(error) },
        "≤ 0.02",
        error <= 0.02,
    ));
    if let Some(refused) = refused {
        row.details = format!(
            "With the withheld passes in the recording: {refused} It was posed with the calibration passes alone.\n"
        );
    }
    Ok(vec![row])
}

/// Stretches at working speed without a turn, at least 30 s long; every second one calibrates.
fn passes(wheel_m_s: &[f64], heading_deg: &[f64]) -> Vec<Pass> {
    const SHORTEST: usize = 30;
    const WORKING_M_S: f64 = 1.0;
    const STRAIGHT_DEG: f64 = 10.0;
    let mut passes: Vec<Pass> = Vec::new();
    let mut from = 0;
    for row in 0..=wheel_m_s.len() {
        let goes_on = row < wheel_m_s.len()
            && wheel_m_s[row] > WORKING_M_S
            && ((heading_deg[row] - heading_deg[from] + 540.0).rem_euclid(360.0) - 180.0).abs()
                < STRAIGHT_DEG;
        if goes_on {
            continue;
        }
        if row - from >= SHORTEST {
            let number = passes.len() + 1;
            passes.push(Pass {
                name: format!("pass_{number:02}"),
                rows: from..row,
                calibration: number % 2 == 1,
            });
        }
        from = (row + 1).min(wheel_m_s.len().saturating_sub(1));
    }
    passes
}
